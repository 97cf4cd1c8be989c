//! Optical materials and volumes in the `[gdml]` table of a document.

use super::former_names::FORMER_NAMES;
use super::properties::{Owner, Properties, PropertyReader};
use crate::material::{
    Compressibility, Mie, OpticalMaterial, ScintillationComponent, WATER_COMPRESSIBILITY, WATER_TEMPERATURE,
    WavelengthShifter, rayleigh_length,
};
use crate::property::group_velocity;
use rayweave_model::PathStep;
use rayweave_scene::{Datum, Scene, bare_name};
use std::collections::{HashMap, HashSet};

/// The optical materials by the number of the medium.
pub(super) fn materials(
    table: &Datum,
    media: &[&str],
    properties: &mut PropertyReader,
) -> Vec<OpticalMaterial> {
    let rows = || table.list("material");
    let by_medium: HashMap<&str, &Datum> =
        rows().filter_map(|row| Some((row.get("medium")?.as_text()?, row))).collect();
    let read = |name: &&str| match by_medium.get(name) {
        Some(row) => material(row, name, properties),
        None => OpticalMaterial { name: (*name).to_owned(), ..OpticalMaterial::default() },
    };
    media.iter().map(read).collect()
}

fn material(row: &Datum, medium: &str, properties: &mut PropertyReader) -> OpticalMaterial {
    let name = row.get("name").and_then(Datum::as_text).unwrap_or(medium);
    // the reader of GDML removes pointer suffixes in the names of media
    let is_water = medium == "Water";
    let mut properties = properties.of(Owner::new("material", name), row);
    // Geant4 derives the velocity whenever RINDEX is added, and replaces one that was there before
    if properties.is_before("GROUPVEL", "RINDEX") {
        properties.drop("GROUPVEL");
    }
    let index = properties.positive("RINDEX");
    let own_velocity = properties.positive("GROUPVEL");
    let group_velocity = own_velocity.or_else(|| index.as_ref().map(group_velocity));
    let stated = properties.length("RAYLEIGH");
    let compressibility = properties.constant("ISOTHERMAL_COMPRESSIBILITY");
    let scale = properties.constant("RS_SCALE_FACTOR").unwrap_or(1.0);
    let derived = || {
        let temperature = row.get("temperature").and_then(Datum::as_number).unwrap_or(293.15);
        let constants = match compressibility {
            Some(value) => Compressibility { value, temperature, scale },
            None if is_water => {
                Compressibility { value: WATER_COMPRESSIBILITY, temperature: WATER_TEMPERATURE, scale }
            }
            None => return None,
        };
        index.as_ref().map(|index| rayleigh_length(index, constants))
    };
    let rayleigh_length = stated.or_else(derived);
    let absorption_length = properties.length("ABSLENGTH");
    let mie = mie(&mut properties);
    let sets = [
        ["WLSABSLENGTH", "WLSCOMPONENT", "WLSTIMECONSTANT", "WLSMEANNUMBERPHOTONS"],
        ["WLSABSLENGTH2", "WLSCOMPONENT2", "WLSTIMECONSTANT2", "WLSMEANNUMBERPHOTONS2"],
    ];
    let shifters = sets.iter().filter_map(|names| shifter(&mut properties, names)).collect();
    let scintillation = scintillation(&mut properties);
    properties.finish();
    OpticalMaterial {
        name: name.to_owned(),
        index,
        group_velocity,
        absorption_length,
        rayleigh_length,
        mie,
        shifters,
        scintillation,
    }
}

fn mie(properties: &mut Properties<'_>) -> Option<Mie> {
    let length = properties.length("MIEHG");
    let mut constant = |name: &str| {
        let value = properties.constant(name);
        if let Some(value) = value.filter(|value| !(-1.0..=1.0).contains(value)) {
            properties.problem(name, &format!("it is {value}: it must be from -1 to 1"));
        }
        value.unwrap_or(0.0)
    };
    let [forward, backward] = ["MIEHG_FORWARD", "MIEHG_BACKWARD"].map(&mut constant);
    let forward_ratio = constant("MIEHG_FORWARD_RATIO");
    length.map(|length| Mie { length, forward, backward, forward_ratio })
}

fn shifter(properties: &mut Properties<'_>, names: &[&str; 4]) -> Option<WavelengthShifter> {
    if !properties.has(names[0]) {
        return None;
    }
    let length = properties.length(names[0]);
    if !properties.has(names[1]) {
        properties.problem(names[0], &format!("there is no emission spectrum `{}`", names[1]));
    }
    let spectrum = properties.spectrum(names[1]);
    let time = properties.constant(names[2]).unwrap_or(0.0);
    let mean_photons = properties.constant(names[3]);
    Some(WavelengthShifter { length: length?, spectrum: spectrum?, time, mean_photons })
}

fn scintillation(properties: &mut Properties<'_>) -> Vec<ScintillationComponent> {
    for row in FORMER_NAMES.iter().filter(|row| row.is_read) {
        properties.former(row.former, row.name);
    }
    // the share of the fast component, before version 11
    let ratio = properties.ratio("YIELDRATIO");
    let component = |number: u32| {
        let spectrum = properties.spectrum(&format!("SCINTILLATIONCOMPONENT{number}"));
        let mut constant = |name: &str| properties.at_least_zero(&format!("SCINTILLATION{name}{number}"));
        let time = constant("TIMECONSTANT");
        let rise_time = constant("RISETIME").unwrap_or(0.0);
        let share = constant("YIELD").unwrap_or(match (number, ratio) {
            (1, Some(ratio)) => ratio,
            (2, Some(ratio)) => 1.0 - ratio,
            (1, None) => 1.0,
            _ => 0.0,
        });
        spectrum.map(|spectrum| ScintillationComponent { number, spectrum, time, rise_time, share })
    };
    (1..=3).filter_map(component).collect()
}

/// The logical volumes: their regions and what is placed in them.
#[derive(Debug, Default)]
pub(crate) struct Volumes {
    /// The regions (1 for the first) of each volume; several where a parameterised volume has several sizes, and
    /// where copies touch.
    pub regions: HashMap<String, Vec<u32>>,
    /// Pairs of regions: a mother and its daughter. Assemblies have no region; their daughters are those of the mother.
    pub nested: HashSet<(u32, u32)>,
    /// The placements by name.
    pub placements: HashMap<String, Vec<Placement>>,
    /// The number of copies of each volume in all mothers.
    pub copies: HashMap<String, usize>,
}

/// A physical volume.
#[derive(Clone, Debug)]
pub(crate) struct Placement {
    /// The volume that is placed.
    pub volume: String,
    /// The numbers of its copies, as in occurrence paths.
    pub copies: std::ops::Range<i64>,
    /// Those of these numbers that placements of the volume before it in the same mother have as well, with the numbers of these
    /// placements, as in occurrence paths.
    pub repeated: Vec<(i64, u32)>,
    /// The volume in which it is placed; empty in native models.
    pub mother: String,
    /// The steps of an occurrence path in front of the placement.
    pub within: Within,
    /// True for the placement that a border surface finds by the name: the first one in the file, as in Geant4. Copies with
    /// different solids of one replicated volume are one placement.
    pub is_first: bool,
}

/// The mother of a physical volume in occurrence paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Within {
    /// The volume that is placed nowhere: paths begin with its daughters.
    Top,
    /// A placed volume.
    Volume,
    /// An assembly, or the volumes of a native model: any path.
    Any,
}

impl Placement {
    /// True if an occurrence path leads through the placement.
    pub fn is_on(&self, steps: &[PathStep<'_>]) -> bool {
        steps.iter().enumerate().any(|(k, step)| self.is_step(step) && self.is_within(&steps[..k]))
    }

    /// True if the steps in front of the placement lead to its mother: volumes in several mothers have equal copies there.
    fn is_within(&self, outer: &[PathStep<'_>]) -> bool {
        let mother = outer.iter().rev().find(|step| step.is_placed);
        match self.within {
            Within::Any => true,
            Within::Top => mother.is_none(),
            Within::Volume => mother.is_some_and(|step| step.name == bare_name(&self.mother)),
        }
    }

    /// True for a step that may be the placement.
    fn is_step(&self, step: &PathStep<'_>) -> bool {
        // the only copy in a mother may have no number
        let copy = step.copy.unwrap_or(0);
        let before =
            self.repeated.iter().find(|(number, _)| *number == copy).map_or(0, |&(_, before)| before);
        step.is_placed
            && step.name == bare_name(&self.volume)
            && self.copies.contains(&copy)
            && step.ordinal == before
    }

    /// True if another placement of the same name and mother is a copy of the same replicated volume, with a solid of its own.
    fn is_replica_of(&self, other: &Placement) -> bool {
        let original = |placement: &'_ Placement| {
            let numbered = placement.volume.strip_suffix(']').and_then(|name| name.rsplit_once('['));
            bare_name(numbered.map_or(placement.volume.as_str(), |(name, _)| name)).to_owned()
        };
        let is_numbered = [self, other].iter().any(|placement| placement.volume.ends_with(']'));
        is_numbered && self.mother == other.mother && original(self) == original(other)
    }
}

impl Volumes {
    /// The regions behind a border of the table: those of its second placement.
    pub fn behind_border(&self, border: &Datum) -> impl Iterator<Item = u32> {
        let second = border.list("placements").filter_map(Datum::as_text).nth(1);
        let placements = second.into_iter().flat_map(|name| self.found_by_name(name));
        placements.filter_map(|placement| self.regions.get(&placement.volume)).flatten().copied()
    }

    /// The placements that a border surface finds by a name: one, or the copies of a replicated volume. None for unknown names.
    pub fn found_by_name(&self, name: &str) -> impl Iterator<Item = &Placement> {
        self.placements.get(name).into_iter().flatten().filter(|placement| placement.is_first)
    }
}

/// The numbers of the regions by their names; the world outside has none. Copies that touch are regions with one name.
pub(super) fn region_numbers(scene: &Scene) -> HashMap<&str, Vec<u32>> {
    let mut numbers: HashMap<&str, Vec<u32>> = HashMap::new();
    for (region, number) in scene.regions.iter().zip(1..) {
        numbers.entry(&region.name).or_default().push(number);
    }
    numbers
}

/// Reads the volume graph.
pub(super) fn volumes(table: &Datum, scene: &Scene) -> Volumes {
    let numbers = region_numbers(scene);
    let rows: Vec<&Datum> = table.list("volume").collect();
    let mut volumes = Volumes::default();
    let by_name: HashMap<&str, &Datum> = rows.iter().map(|row| (row.text("name"), *row)).collect();
    let daughters = rows.iter().flat_map(|row| row.list("daughters"));
    let placed: HashSet<&str> = daughters.map(|daughter| daughter.text("volume")).collect();
    for row in &rows {
        let within = match (numbers.contains_key(row.text("region")), placed.contains(row.text("name"))) {
            (false, _) => Within::Any,
            (true, false) => Within::Top,
            (true, true) => Within::Volume,
        };
        let regions = numbers.get(row.text("region")).into_iter().flatten();
        volumes.regions.entry(row.text("name").to_owned()).or_default().extend(regions);
        // positions among the copies of the same volume number those without a copy number
        let mut counted: HashMap<String, i64> = HashMap::new();
        let mut seen: HashMap<&str, HashMap<i64, u32>> = HashMap::new();
        for daughter in row.list("daughters") {
            let volume = daughter.text("volume").to_owned();
            let count = daughter.list("maps").count() as i64;
            let next = counted.entry(volume.clone()).or_default();
            let first = daughter.get("copy").and_then(Datum::as_number).map_or(*next, |copy| copy as i64);
            *next += count;
            *volumes.copies.entry(volume.clone()).or_default() += count as usize;
            let (mother, copies) = (row.text("name").to_owned(), first..first.saturating_add(count));
            let seen = seen.entry(daughter.text("volume")).or_default();
            let repeated = copies.clone().filter_map(|copy| {
                let before = seen.entry(copy).or_default();
                *before += 1;
                (*before > 1).then_some((copy, *before - 1))
            });
            let repeated = repeated.collect();
            let mut placement = Placement { volume, copies, repeated, mother, within, is_first: true };
            let named = volumes.placements.entry(daughter.text("name").to_owned()).or_default();
            placement.is_first = named.first().is_none_or(|first| placement.is_replica_of(first));
            named.push(placement);
        }
    }
    for row in &rows {
        let Some(mothers) = numbers.get(row.text("region")) else { continue };
        // volumes without a region are transparent for the nesting
        let (mut waiting, mut seen) = (vec![*row], HashSet::new());
        while let Some(row) = waiting.pop() {
            for daughter in row.list("daughters") {
                let Some(inner) = by_name.get(daughter.text("volume")) else { continue };
                match numbers.get(inner.text("region")) {
                    Some(regions) => {
                        let pairs =
                            mothers.iter().flat_map(|&mother| regions.iter().map(move |&own| (mother, own)));
                        volumes.nested.extend(pairs);
                    }
                    None if seen.insert(inner.text("name")) => waiting.push(inner),
                    None => {}
                }
            }
        }
    }
    volumes
}
