//! The optical surface between two volumes: border surfaces first, then skin surfaces.

use super::gdml::{Placement, Volumes};
use super::properties::PropertyReader;
use crate::surface::OpticalSurface;
use rayweave_error::Message;
use rayweave_model::{Crossing, Program};
use rayweave_scene::{Datum, bare_name};
use std::collections::{HashMap, HashSet};

/// The surfaces of all boundaries.
#[derive(Debug, Default)]
pub(crate) struct SurfaceTable {
    /// Pairs of regions, in front of a boundary and behind it, with border surfaces or nested in each other.
    pairs: HashMap<(u32, u32), Pair>,
    /// The skin surface of each region, if it has one.
    skins: Vec<Option<usize>>,
}

/// A region in front of a boundary and one behind it.
#[derive(Debug, Default)]
struct Pair {
    borders: Vec<Border>,
    /// True if the region in front is the mother of the one behind.
    is_nested: bool,
}

/// A border surface between two placements.
#[derive(Debug)]
struct Border {
    surface: usize,
    /// Volume name and copy numbers that the path of the crossed faces must contain, for volumes with several copies.
    required: Vec<Placement>,
}

impl SurfaceTable {
    /// Reads the surfaces that are attached to volumes and to pairs of placements.
    pub fn new(
        table: &Datum,
        surfaces: &[OpticalSurface],
        volumes: &Volumes,
        properties: &mut PropertyReader,
    ) -> SurfaceTable {
        let nested = volumes.nested.iter().map(|&pair| (pair, Pair { is_nested: true, ..Pair::default() }));
        let mut found = SurfaceTable { pairs: nested.collect(), skins: Vec::new() };
        let mut attached = HashSet::new();
        let number = |row: &Datum| surfaces.iter().position(|surface| surface.name == row.text("surface"));
        for row in table.list("skin") {
            let Some(surface) = number(row) else { continue };
            attached.insert(surface);
            for volume in row.list("volume").filter_map(Datum::as_text) {
                // of several skins of a volume the first one counts
                for &region in volumes.regions.get(volume).into_iter().flatten() {
                    let region = region as usize;
                    found.skins.resize(found.skins.len().max(region + 1), None);
                    found.skins[region].get_or_insert(surface);
                }
            }
        }
        for row in table.list("border") {
            let Some(surface) = number(row) else { continue };
            attached.insert(surface);
            let names: Vec<&str> = row.list("placements").filter_map(Datum::as_text).collect();
            let [first, second] = names.as_slice() else {
                let problem =
                    format!("border surface `{}` names {} placements", row.text("name"), names.len());
                properties.problem(Message::new(problem, "a border lies between two"));
                continue;
            };
            found.add_border(surface, (first, second), volumes, (row.text("name"), properties));
        }
        for (_, surface) in surfaces.iter().enumerate().filter(|(number, _)| !attached.contains(number)) {
            properties
                .note(format!("optical surface `{}` is ignored: it is attached to no volume.", surface.name));
        }
        found
    }

    fn add_border(
        &mut self,
        surface: usize,
        (first, second): (&str, &str),
        volumes: &Volumes,
        (name, properties): (&str, &mut PropertyReader),
    ) {
        let mut placements = |placement: &str| match volumes.placements.get(placement) {
            Some(list) => list.clone(),
            None => {
                properties.note(format!(
                    "border surface `{name}` is ignored: there is no placement named `{placement}`."
                ));
                Vec::new()
            }
        };
        let (before, after) = (placements(first), placements(second));
        for before in &before {
            for after in &after {
                let is_one_of_several =
                    |placement: &&Placement| volumes.copies.get(&placement.volume).is_some_and(|&n| n > 1);
                let required: Vec<Placement> =
                    [before, after].into_iter().filter(is_one_of_several).cloned().collect();
                let regions = |placement: &Placement| {
                    volumes.regions.get(&placement.volume).cloned().unwrap_or_default()
                };
                for from in regions(before) {
                    for to in regions(after) {
                        let border = Border { surface, required: required.clone() };
                        self.pairs.entry((from, to)).or_default().borders.push(border);
                    }
                }
            }
        }
    }

    /// The number of the surface at a crossing (`G4LogicalBorderSurface`, then `G4LogicalSkinSurface`): a border
    /// surface from the volume in front to the one behind; else, if the photon enters a daughter, the skin of the daughter
    /// and then that of its mother; otherwise the skin of the volume in front, then of the one behind.
    pub fn find(&self, program: &Program, crossing: &Crossing) -> Option<usize> {
        let (before, after) = (crossing.before.0, crossing.after.0);
        let pair = self.pairs.get(&(before, after));
        let mut borders = pair.into_iter().flat_map(|pair| &pair.borders);
        if let Some(border) = borders.find(|border| border.is_at(program, crossing)) {
            return Some(border.surface);
        }
        let is_nested = pair.is_some_and(|pair| pair.is_nested);
        let order = if is_nested { [after, before] } else { [before, after] };
        order.iter().find_map(|&region| self.skins.get(region as usize).copied().flatten())
    }
}

impl Border {
    /// True if the faces of a crossing belong to the required copies.
    fn is_at(&self, program: &Program, crossing: &Crossing) -> bool {
        if self.required.is_empty() {
            return true;
        }
        let paths = [crossing.left, crossing.entered].map(|face| program.occurrence_path(face.occurrence()));
        let has = |placement: &Placement| {
            let mut steps = paths.iter().flat_map(|path| path.steps());
            steps.any(|step| {
                step.name == bare_name(&placement.volume)
                    && step.copy.is_some_and(|copy| placement.copies.contains(&copy))
            })
        };
        self.required.iter().all(has)
    }
}
