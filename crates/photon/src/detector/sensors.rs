//! Sensitive volumes: the auxiliary tag `SensDet`.

use super::gdml::{Volumes, region_numbers};
use crate::material::OpticalMaterial;
use crate::surface::OpticalSurface;
use rayweave_math::Bounds;
use rayweave_model::{PlacementId, Program};
use rayweave_scene::{Datum, Scene, bare_name};
use std::collections::{HashMap, HashSet};

/// The copy number of a volume whose placements have no numbers.
pub(crate) const NO_COPY: i64 = -1;

/// The tag of sensitive volumes in GDML files.
const SENSITIVE: &str = "SensDet";

/// The name of the sensor of each region, if it is sensitive; region 0 is the world.
pub(super) fn names(table: &Datum, scene: &Scene) -> Vec<Option<String>> {
    let numbers = region_numbers(scene);
    let mut sensors = vec![None; scene.regions.len() + 1];
    for row in table.list("volume") {
        let regions = numbers.get(row.text("region"));
        let is_sensitive = |tag: &&Datum| tag.text("type") == SENSITIVE;
        let name = row
            .list("auxiliary")
            .filter(is_sensitive)
            .find_map(|tag| tag.get("value")?.as_text().map(str::to_owned));
        if let (Some(regions), Some(name)) = (regions, name) {
            regions.iter().for_each(|&region| sensors[region as usize] = Some(name.clone()));
        }
    }
    sensors
}

/// The regions in which photons can be detected: sensitive ones, those behind a border with an efficiency, and those that light enters
/// through a skin with an efficiency.
///
/// The light at a skin comes from outside where a medium there has an index. From inside, towards the mother or a daughter, it comes if
/// the volume or one within it emits light, if the skin lets light in, or if no light arrives from outside. A source of photons
/// elsewhere may add other sensors to its hits.
pub(super) fn detecting_regions(
    table: &Datum,
    scene: &Scene,
    (surfaces, materials): (&[OpticalSurface], &[OpticalMaterial]),
    volumes: &Volumes,
    sensors: &[Option<String>],
) -> HashSet<u32> {
    let sensitive = (0u32..).zip(sensors).filter(|(_, sensor)| sensor.is_some());
    let mut regions: HashSet<u32> = sensitive.map(|(region, _)| region).collect();
    let detecting: HashMap<&str, &OpticalSurface> =
        surfaces.iter().filter(|own| own.detects()).map(|own| (own.name.as_str(), own)).collect();
    for row in table.list("border").filter(|row| detecting.contains_key(row.text("surface"))) {
        regions.extend(volumes.behind_border(row));
    }
    let neighbours = Neighbours::new(volumes);
    let material = |region: u32| {
        let own = (region as usize).checked_sub(1).and_then(|number| scene.regions.get(number));
        own.and_then(|region| materials.get(region.medium as usize))
    };
    let is_clear = |region: &u32| material(*region).is_some_and(|own| own.index.is_some());
    let emits = |region: u32| {
        material(region).is_some_and(|own| !own.scintillation.is_empty() || !own.shifters.is_empty())
    };
    for row in table.list("skin") {
        let Some(skin) = detecting.get(row.text("surface")) else { continue };
        let within = row.list("volume").filter_map(Datum::as_text);
        for &own in within.filter_map(|volume| volumes.regions.get(volume)).flatten() {
            let [mothers, daughters] =
                [&neighbours.mothers, &neighbours.daughters].map(|list| list.get(&own));
            let (mothers, daughters) = (mothers.into_iter().flatten(), daughters.into_iter().flatten());
            let beside = mothers.clone().filter_map(|mother| neighbours.daughters.get(mother)).flatten();
            let is_lit = mothers.clone().chain(beside.filter(|other| **other != own)).any(is_clear);
            if is_lit || daughters.clone().any(is_clear) {
                regions.insert(own);
            }
            // regions of a native model have neither mothers nor daughters: light comes from all sides
            if volumes.nested.is_empty() {
                regions.insert(own);
            }
            let is_source = !is_lit || !skin.is_opaque(false) || neighbours.any_within(own, emits);
            if is_clear(&own) && is_source {
                regions.extend(mothers.chain(daughters));
            }
        }
    }
    regions
}

/// The regions around each region and within it.
struct Neighbours {
    mothers: HashMap<u32, Vec<u32>>,
    daughters: HashMap<u32, Vec<u32>>,
}

impl Neighbours {
    fn new(volumes: &Volumes) -> Neighbours {
        let (mut mothers, mut daughters) = (HashMap::<_, Vec<u32>>::new(), HashMap::<_, Vec<u32>>::new());
        for &(mother, daughter) in &volumes.nested {
            mothers.entry(daughter).or_default().push(mother);
            daughters.entry(mother).or_default().push(daughter);
        }
        Neighbours { mothers, daughters }
    }

    /// True if a region or one within it is such.
    fn any_within(&self, region: u32, is_such: impl Fn(u32) -> bool) -> bool {
        let (mut waiting, mut seen) = (vec![region], HashSet::new());
        while let Some(region) = waiting.pop() {
            if is_such(region) {
                return true;
            }
            if seen.insert(region) {
                waiting.extend(self.daughters.get(&region).into_iter().flatten());
            }
        }
        false
    }
}

/// The largest number of occurrences of shapes among which sensors are numbered: some 100 MB of paths.
const MAX_OCCURRENCES: usize = 1 << 20;

/// The sensors in the order of their placements.
#[derive(Clone, Debug, Default)]
pub(super) struct SensorList {
    /// Paths and copy numbers; -1 without a number.
    pub paths: Vec<(String, i64)>,
    /// The boxes of their solids, `None` where there is none: of the world, and of volumes without a shape of their own.
    pub extents: Vec<Option<Bounds>>,
}

impl SensorList {
    /// The volumes of `regions`: those that are sensitive, and those behind a surface with an efficiency. None for a detector
    /// of too many copies.
    pub fn new(program: &Program, names: &[String], regions: &HashSet<u32>) -> SensorList {
        let wanted: HashSet<&str> =
            regions.iter().map(|&region| bare_name(&names[region as usize])).collect();
        let mut found = SensorList::default();
        let (mut numbers, mut placed) = (HashMap::new(), HashSet::new());
        if wanted.is_empty() || program.occurrences().nth(MAX_OCCURRENCES).is_some() {
            return found;
        }
        let bounds = program.region_bounds();
        let of_region = |region: &u32| (*region as usize).checked_sub(1).map(|place| bounds[place]);
        let region = |name: &str| {
            let own = regions.iter().filter(|region| bare_name(&names[**region as usize]) == name);
            own.filter_map(of_region).fold(Bounds::EMPTY, |all, own| all.union(&own))
        };
        for occurrence in program.occurrences() {
            let path = program.occurrence_path(occurrence).placed();
            let steps = path.steps();
            // as in hits: the innermost step of each name is the sensor
            for (last, step) in steps.iter().enumerate().filter(|(_, step)| wanted.contains(step.name)) {
                if steps[last + 1..].iter().any(|inner| inner.name == step.name) {
                    continue;
                }
                placed.insert(step.name);
                let name = steps[..=last].iter().map(ToString::to_string).collect::<Vec<_>>().join("/");
                let number = *numbers.entry(name).or_insert_with_key(|name| {
                    let copy = steps[..=last].iter().rev().find_map(|step| step.copy);
                    found.push(name.clone(), copy.unwrap_or(NO_COPY))
                });
                if last + 1 == steps.len() {
                    let own = match occurrence.placement {
                        // a volume with one copy is part of the model itself
                        PlacementId(0) => {
                            program.leaf_bounds(occurrence.leaf).intersection(&region(step.name))
                        }
                        placement => {
                            let (map, group) = program.placement(placement);
                            program.prototype(group).bounds.transformed(&map)
                        }
                    };
                    found.extend(number, own);
                }
            }
        }
        // volumes without a step of their own have their name as the path
        let mut sorted: Vec<u32> = regions.iter().copied().collect();
        sorted.sort_unstable();
        for region in sorted {
            let name = bare_name(&names[region as usize]);
            if placed.contains(name) {
                continue;
            }
            let number =
                *numbers.entry(name.to_owned()).or_insert_with(|| found.push(name.to_owned(), NO_COPY));
            // a region around all others is the world, of which light reaches a small part
            if let Some(own) = of_region(&region).filter(|own| *own != program.bounds()) {
                found.extend(number, own);
            }
        }
        found
    }

    fn push(&mut self, path: String, copy: i64) -> usize {
        self.paths.push((path, copy));
        self.extents.push(None);
        self.paths.len() - 1
    }

    /// Adds a box to the solid of a sensor.
    fn extend(&mut self, number: usize, bounds: Bounds) {
        if bounds.is_finite() {
            let own = &mut self.extents[number];
            *own = Some(own.map_or(bounds, |own| own.union(&bounds)));
        }
    }
}
