//! Rules for volumes: materials without an index.

use super::state::Lint;
use crate::detector::properties::Owner;
use rayweave_error::Message;
use std::collections::{BTreeMap, BTreeSet};

/// The number of names that a message lists.
const LISTED: usize = 3;

impl Lint<'_> {
    /// All rules about volumes.
    pub(super) fn volumes(&mut self) {
        self.missing_indices();
        self.covered_skins();
        self.closed_volumes();
        self.sensors();
    }

    /// The number of the medium of a region, from 1.
    pub(super) fn medium(&self, region: u32) -> Option<usize> {
        let region = self.scene.regions.get((region as usize).checked_sub(1)?)?;
        Some(region.medium as usize)
    }

    pub(super) fn has_index(&self, medium: usize) -> bool {
        self.optics.materials.get(medium).is_some_and(|material| material.index.is_some())
    }

    pub(super) fn region_name(&self, region: u32) -> &str {
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
    ///
    /// A volume that detects light from one side, such as a chip behind a border surface with an efficiency, absorbs that from the others.
    fn missing_indices(&mut self) {
        let detecting = self.with_efficiency();
        let borders = self.table.list("border").filter(|row| detecting.contains(row.text("surface")));
        let detecting: BTreeSet<u32> =
            borders.flat_map(|row| self.optics.volumes.behind_border(row)).collect();
        let mut beside: BTreeMap<usize, BTreeSet<String>> = BTreeMap::new();
        for &(mother, daughter) in self.optics.volumes.nested.iter().chain(self.contacts.keys()) {
            let (Some(outer), Some(inner)) = (self.medium(mother), self.medium(daughter)) else { continue };
            let (clear, clear_region, opaque, opaque_region) =
                match (self.has_index(outer), self.has_index(inner)) {
                    (true, false) => (outer, mother, inner, daughter),
                    (false, true) => (inner, daughter, outer, mother),
                    _ => continue,
                };
            let is_joined = self.optics.boundaries.has_surface(clear_region, opaque_region);
            if clear != opaque && !is_joined && !detecting.contains(&opaque_region) {
                beside.entry(opaque).or_default().insert(self.region_name(clear_region).to_owned());
            }
        }
        for (medium, volumes) in beside {
            let Some(material) = self.optics.materials.get(medium) else { continue };
            let owner = Owner::new("material", &material.name);
            let listed = listed(volumes.iter().map(String::as_str));
            let problem = format!("{owner} has no `RINDEX`");
            let reason =
                format!("photons from {listed} end on reaching it, since no optical surface lies between");
            let advice = "Give it an index, or a surface if it reflects, absorbs or detects light.";
            self.find(&owner, "", Message::new(problem, reason).suggest(advice));
        }
    }
}

/// The first names in backquotes, and the number of the others.
pub(super) fn listed<'n>(names: impl ExactSizeIterator<Item = &'n str>) -> String {
    let more = match names.len().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let first: Vec<String> = names.take(LISTED).map(|name| format!("`{name}`")).collect();
    format!("{}{more}", first.join(", "))
}
