//! Rules for volumes: materials without an index, sensors out of reach, copies that touch.

use super::state::Lint;
use crate::detector::properties::Owner;
use rayweave_error::Message;
use rayweave_scene::Datum;
use std::collections::{BTreeMap, BTreeSet};

/// The number of names that a message lists.
const LISTED: usize = 3;

impl Lint<'_> {
    /// All rules about volumes.
    pub(super) fn volumes(&mut self) {
        self.missing_indices();
        self.sensors();
        self.touching_copies();
    }

    /// The number of the medium of a region, from 1.
    pub(super) fn medium(&self, region: u32) -> Option<usize> {
        let region = self.scene.regions.get((region as usize).checked_sub(1)?)?;
        Some(region.medium as usize)
    }

    pub(super) fn has_index(&self, medium: usize) -> bool {
        self.optics.materials.get(medium).is_some_and(|material| material.index.is_some())
    }

    fn region_name(&self, region: u32) -> &str {
        let region = (region as usize).checked_sub(1).and_then(|region| self.scene.regions.get(region));
        region.map_or("", |region| region.name.as_str())
    }

    /// The smallest and the largest diagonal of the volumes of a material, in mm; for a material with an index.
    pub(super) fn sizes(&self, owner: &Owner) -> Option<[f64; 2]> {
        if owner.element != "material" {
            return None;
        }
        let medium = self.optics.materials.iter().position(|material| material.name == owner.name)?;
        let is_own = |region: &u32| self.medium(*region) == Some(medium);
        let regions: Vec<u32> = (1..=self.scene.regions.len() as u32).filter(is_own).collect();
        let diagonals = regions.iter().filter_map(|region| self.boxes.get(*region as usize - 1));
        let diagonals: Vec<f64> = diagonals
            .filter(|own| own.is_finite() && !own.is_empty())
            .map(|own| own.size().length())
            .collect();
        let least = diagonals.iter().copied().fold(f64::INFINITY, f64::min);
        let most = diagonals.iter().copied().fold(0.0, f64::max);
        (most > 0.0 && self.has_index(medium)).then_some([least, most])
    }

    /// Materials without an index next to optical ones, without a surface between them.
    fn missing_indices(&mut self) {
        let mut beside: BTreeMap<usize, BTreeSet<String>> = BTreeMap::new();
        for &(mother, daughter) in self.optics.volumes.nested.iter().chain(&self.contacts) {
            let (Some(outer), Some(inner)) = (self.medium(mother), self.medium(daughter)) else { continue };
            let (clear, clear_region, opaque, opaque_region) =
                match (self.has_index(outer), self.has_index(inner)) {
                    (true, false) => (outer, mother, inner, daughter),
                    (false, true) => (inner, daughter, outer, mother),
                    _ => continue,
                };
            if clear != opaque && !self.optics.boundaries.has_surface(clear_region, opaque_region) {
                beside.entry(opaque).or_default().insert(self.region_name(clear_region).to_owned());
            }
        }
        for (medium, volumes) in beside {
            let Some(material) = self.optics.materials.get(medium) else { continue };
            let owner = Owner::new("material", &material.name);
            let listed: Vec<String> = volumes.iter().take(LISTED).map(|name| format!("`{name}`")).collect();
            let more = match volumes.len().saturating_sub(LISTED) {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            let problem = format!("{owner} has no `RINDEX`");
            let reason = format!(
                "photons from {}{more} end on reaching it, since no optical surface lies between",
                listed.join(", ")
            );
            let advice = "Give it an index, or a surface if it reflects, absorbs or detects light.";
            self.find(&owner, "", Message::new(problem, reason).suggest(advice));
        }
    }

    /// Sensors that no photon enters.
    fn sensors(&mut self) {
        let mut found = Vec::new();
        for (region, sensor) in (0u32..).zip(&self.optics.sensors) {
            let (Some(sensor), Some(medium)) = (sensor, self.medium(region)) else { continue };
            let has_efficiency = || {
                let detecting = self.optics.surfaces.iter().filter(|surface| surface.efficiency.is_some());
                detecting.into_iter().any(|surface| self.regions_behind(&surface.name).contains(&region))
            };
            if !self.has_index(medium) && !has_efficiency() {
                let material = &self.optics.materials[medium];
                let owner = Owner::new("material", &material.name);
                let problem = format!(
                    "volume `{}` with the sensor `{sensor}` detects nothing",
                    self.region_name(region)
                );
                let reason = format!(
                    "its {owner} has no `RINDEX`, and no surface with an `EFFICIENCY` lies in front of it"
                );
                let advice = "Give the material an index, or the boundary a surface with an efficiency.";
                found.push((owner, Message::new(problem, reason).suggest(advice)));
            }
        }
        found.into_iter().for_each(|(owner, message)| self.find(&owner, "", message));
    }

    /// Copies of one volume with a skin whose boxes touch, in frames that are not rotated.
    fn touching_copies(&mut self) {
        let mut found = Vec::new();
        for row in self.table.list("skin") {
            for volume in row.list("volume").filter_map(Datum::as_text) {
                let Some(&[region]) = self.optics.volumes.regions.get(volume).map(Vec::as_slice) else {
                    continue;
                };
                let Some(own) = self.boxes.get(region as usize - 1).filter(|own| own.is_finite()) else {
                    continue;
                };
                let Some(positions) = self.positions(volume) else { continue };
                if let Some([a, b]) = touching(&positions, own.size().to_array()) {
                    let owner = Owner::new("skin", row.text("name"));
                    let problem = format!("copies of volume `{volume}` with {owner} touch");
                    let reason = format!(
                        "copies {a} and {b} (from 0) have a face in common; touching copies of one volume count as one, \
                         so that light passes between them"
                    );
                    let advice = "Leave a gap between them, or place two volumes in turn.";
                    found.push((owner, Message::new(problem, reason).suggest(advice)));
                }
            }
        }
        found.into_iter().for_each(|(owner, message)| self.find(&owner, "", message));
    }

    /// The positions of all copies of a volume that one mother has, if neither they nor the mothers are rotated or
    /// repeated.
    fn positions(&self, volume: &str) -> Option<Vec<[f64; 3]>> {
        let mut positions = self.maps(volume)?.1;
        let mut at = volume.to_owned();
        // the hierarchy of a file has no cycles
        while let Some((mother, maps)) = self.maps(&at) {
            if at != volume && maps.len() != 1 {
                return None;
            }
            at = mother;
        }
        let world = self.table.text("world");
        positions.truncate(MAX_COPIES);
        (at == world).then_some(positions)
    }

    /// The only mother of a volume and the translations of its copies there; `None` if it has several mothers, or other
    /// maps.
    fn maps(&self, volume: &str) -> Option<(String, Vec<[f64; 3]>)> {
        let (mut mother, mut maps) = (None, Vec::new());
        for row in self.table.list("volume") {
            for daughter in row.list("daughters").filter(|daughter| daughter.text("volume") == volume) {
                if mother.replace(row.text("name")).is_some_and(|other| other != row.text("name")) {
                    return None;
                }
                for map in daughter.list("maps") {
                    let numbers: Vec<f64> = map.items().filter_map(Datum::as_number).collect();
                    maps.push(<[f64; 3]>::try_from(numbers).ok()?);
                }
            }
        }
        Some((mother?.to_owned(), maps))
    }
}

/// The largest number of copies that are compared in pairs.
const MAX_COPIES: usize = 1000;

/// Two of several copies of a box at positions whose faces touch; `size` is that of the box around all of them.
fn touching(positions: &[[f64; 3]], size: [f64; 3]) -> Option<[usize; 2]> {
    let own = [0, 1, 2].map(|k| {
        let at = || positions.iter().map(|position| position[k]);
        size[k] - (at().fold(f64::NEG_INFINITY, f64::max) - at().fold(f64::INFINITY, f64::min))
    });
    let touch = |a: &[f64; 3], b: &[f64; 3]| {
        let gaps = [0, 1, 2].map(|k| ((a[k] - b[k]).abs() - own[k]) / size[k]);
        // a millionth of the size is a gap
        let is_close = gaps.iter().all(|gap| *gap <= 1e-6);
        is_close && gaps.iter().any(|gap| gap.abs() <= 1e-6)
    };
    let pairs =
        |a: usize| (a + 1..positions.len()).find(|&b| touch(&positions[a], &positions[b])).map(|b| [a, b]);
    (0..positions.len()).find_map(pairs)
}
