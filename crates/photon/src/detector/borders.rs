//! The optical surface between two volumes: border surfaces first, then skin surfaces.

use super::gdml::{Placement, Volumes};
use super::properties::{Owner, PropertyReader};
use crate::surface::OpticalSurface;
use rayweave_error::{Message, did_you_mean};
use rayweave_model::{Crossing, Program};
use rayweave_scene::{Datum, Span};
use std::collections::{HashMap, HashSet};

/// The surfaces of all boundaries.
#[derive(Debug, Default)]
pub(crate) struct SurfaceTable {
    /// Border surfaces by the regions in front of and behind them.
    borders: HashMap<(u32, u32), Vec<Border>>,
    /// The skin surface of each region, if it has one.
    skins: HashMap<u32, usize>,
    /// Pairs of a mother and its daughter.
    nested: HashSet<(u32, u32)>,
    /// For detectors of few regions, the answer for each region in front and each one behind.
    table: Vec<Pair>,
    /// The number of rows of the table, and of columns.
    regions: usize,
}

/// The surface between two regions.
#[derive(Clone, Copy, Debug)]
enum Pair {
    /// The same at every crossing.
    Same(Option<usize>),
    /// A question of the placements.
    Placed,
}

/// Largest number of regions, with the world, for which the surfaces of all pairs are tabulated.
const TABULATED: usize = 512;

/// A border surface between two placements.
#[derive(Debug)]
struct Border {
    surface: usize,
    /// The placements that the path of the crossed faces must contain, for volumes with several copies.
    required: Vec<Placement>,
    /// True for a border between two copies of one volume: the first of `required` is in front, the second one behind.
    is_between_copies: bool,
}

impl SurfaceTable {
    /// Reads the surfaces that are attached to volumes and to pairs of placements.
    pub fn new(
        table: &Datum,
        surfaces: &[OpticalSurface],
        volumes: &Volumes,
        properties: &mut PropertyReader,
    ) -> SurfaceTable {
        let mut found = SurfaceTable { nested: volumes.nested.clone(), ..SurfaceTable::default() };
        let mut attached = HashSet::new();
        let number = |row: &Datum| surfaces.iter().position(|surface| surface.name == row.text("surface"));
        for row in table.list("skin") {
            let Some(surface) = number(row) else { continue };
            attached.insert(surface);
            for volume in row.list("volume").filter_map(Datum::as_text) {
                // of several skins of a volume the first one counts
                for &region in volumes.regions.get(volume).into_iter().flatten() {
                    found.skins.entry(region).or_insert(surface);
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
                let owner = Owner::new("border", row.text("name"));
                properties.problem(
                    owner,
                    Message::new(problem, "a border lies between two"),
                    Span::default(),
                );
                continue;
            };
            found.add_border(surface, (first, second), volumes, (row.text("name"), properties));
        }
        for (_, surface) in surfaces.iter().enumerate().filter(|(number, _)| !attached.contains(number)) {
            let owner = Owner::new("surface", &surface.name);
            let note = Message::new(format!("{owner} is ignored"), "it is attached to no volume");
            properties.note(owner, note);
        }
        found.tabulate(volumes);
        found
    }

    fn add_border(
        &mut self,
        surface: usize,
        (first, second): (&str, &str),
        volumes: &Volumes,
        (name, properties): (&str, &mut PropertyReader),
    ) {
        let mut placements = |placement: &str| {
            let note = match volumes.placements.get(placement) {
                Some(list) => repeated_placement(name, placement, list),
                None => Some(missing_placement(name, placement, volumes)),
            };
            note.into_iter().for_each(|note| properties.note(Owner::new("border", name), note));
            volumes.found_by_name(placement).cloned().collect::<Vec<Placement>>()
        };
        let (before, after) = (placements(first), placements(second));
        for before in &before {
            for after in &after {
                let is_one_of_several =
                    |placement: &&Placement| volumes.copies.get(&placement.volume).is_some_and(|&n| n > 1);
                let required: Vec<Placement> =
                    [before, after].into_iter().filter(is_one_of_several).cloned().collect();
                let is_between_copies = before.volume == after.volume && required.len() == 2;
                let regions = |placement: &Placement| {
                    volumes.regions.get(&placement.volume).cloned().unwrap_or_default()
                };
                for from in regions(before) {
                    for to in regions(after) {
                        let border = Border { surface, required: required.clone(), is_between_copies };
                        self.borders.entry((from, to)).or_default().push(border);
                    }
                }
            }
        }
    }

    /// True if light from one region to another meets a surface.
    pub fn has_surface(&self, before: u32, after: u32) -> bool {
        self.borders.contains_key(&(before, after))
            || [before, after].iter().any(|region| self.skins.contains_key(region))
    }

    /// Tabulates the surfaces of all pairs of regions.
    fn tabulate(&mut self, volumes: &Volumes) {
        let last = volumes.regions.values().flatten().max().copied().unwrap_or(0);
        self.regions = last as usize + 1;
        if self.regions > TABULATED {
            return;
        }
        let all = || 0..=last;
        let pair = |before, after| match self.borders.get(&(before, after)).map(|list| list.first()) {
            Some(Some(border)) if border.required.is_empty() => Pair::Same(Some(border.surface)),
            Some(Some(_)) => Pair::Placed,
            _ => Pair::Same(self.skin(before, after)),
        };
        self.table = all()
            .flat_map(|before| all().map(move |after| (before, after)))
            .map(|(a, b)| pair(a, b))
            .collect();
    }

    /// The number of the surface at a crossing (`G4LogicalBorderSurface`, then `G4LogicalSkinSurface`): a border
    /// surface from the volume in front to the one behind; else, if the photon enters a daughter, the skin of the daughter
    /// and then that of its mother; otherwise the skin of the volume in front, then of the one behind.
    pub fn find(&self, program: &Program, crossing: &Crossing) -> Option<usize> {
        let (before, after) = (crossing.before.0, crossing.after.0);
        if let Some(Pair::Same(surface)) = self.pair([before, after]) {
            return surface;
        }
        let borders = self.borders.get(&(before, after));
        if let Some(border) = borders.into_iter().flatten().find(|border| border.is_at(program, crossing)) {
            return Some(border.surface);
        }
        self.skin(before, after)
    }

    /// True if the surface at a crossing depends on the copies of the volumes.
    pub fn depends_on_copies(&self, crossing: &Crossing) -> bool {
        let regions = [crossing.before.0, crossing.after.0];
        match self.pair(regions) {
            Some(pair) => matches!(pair, Pair::Placed),
            None => self.borders.contains_key(&regions.into()),
        }
    }

    /// The number of regions, with the world, whose pairs are tabulated; 0 for detectors of many regions.
    pub fn tabulated(&self) -> usize {
        if self.table.is_empty() { 0 } else { self.regions }
    }

    /// The surface between two tabulated regions, if it is the same at every crossing.
    pub fn between(&self, regions: [u32; 2]) -> Option<Option<usize>> {
        match self.pair(regions)? {
            Pair::Same(surface) => Some(surface),
            Pair::Placed => None,
        }
    }

    /// The entry of two regions; `None` if they are not tabulated.
    fn pair(&self, [before, after]: [u32; 2]) -> Option<Pair> {
        // a region beyond the table has no surface, but its place may be that of a pair in the next row
        let is_tabulated = (after as usize) < self.regions;
        is_tabulated.then(|| self.table.get(before as usize * self.regions + after as usize).copied())?
    }

    /// The number of the skin surface between two regions.
    fn skin(&self, before: u32, after: u32) -> Option<usize> {
        let order = if self.nested.contains(&(before, after)) { [after, before] } else { [before, after] };
        order.iter().find_map(|region| self.skins.get(region).copied())
    }
}

/// The message about a border surface with a name of several placements, of which it acts on the first one.
fn repeated_placement(border: &str, name: &str, list: &[Placement]) -> Option<Message> {
    let first = list.first()?;
    let others = list.iter().filter(|placement| !placement.is_first).count();
    if others == 0 {
        return None;
    }
    let problem =
        format!("border surface `{border}` acts on one of {} placements named `{name}`", others + 1);
    let reason = format!(
        "it finds the first one in the file, that of volume `{}` in `{}`, as in Geant4",
        first.volume, first.mother
    );
    let advice = format!(
        "Give the placements different names and each a border surface, or make the surface the skin of `{}`.",
        first.volume
    );
    Some(Message::new(problem, reason).suggest(advice))
}

/// The message about a border surface with an unknown placement.
fn missing_placement(border: &str, placement: &str, volumes: &Volumes) -> Message {
    /// The number of placements that a message lists.
    const LISTED: usize = 8;
    let problem = format!("border surface `{border}` is ignored");
    let reason = format!("there is no placement named `{placement}`");
    let mut names: Vec<&str> =
        volumes.placements.keys().map(String::as_str).filter(|name| !name.is_empty()).collect();
    names.sort_unstable();
    let is_of = |name: &&&str| volumes.placements[**name].iter().any(|own| own.volume == placement);
    let list = |names: &[&str]| {
        let quoted: Vec<String> = names.iter().take(LISTED).map(|name| format!("`{name}`")).collect();
        let more = match names.len().saturating_sub(LISTED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        format!("{}{more}", quoted.join(", "))
    };
    let of_volume: Vec<&str> = names.iter().filter(is_of).copied().collect();
    let advice = match did_you_mean(placement, names.iter().copied()) {
        _ if !of_volume.is_empty() => {
            let placements = list(&of_volume);
            format!(
                "`{placement}` is a volume, and `physvolref` names a placement (`physvol`): those of the volume are {placements}."
            )
        }
        Some(near) => format!("Did you mean `{near}`?"),
        None if names.is_empty() => "Give the `physvol` elements names.".to_owned(),
        None => format!("`physvolref` names a `physvol`: the placements are {}.", list(&names)),
    };
    Message::new(problem, reason).suggest(advice)
}

impl Border {
    /// True if the faces of a crossing belong to the required copies.
    fn is_at(&self, program: &Program, crossing: &Crossing) -> bool {
        if self.required.is_empty() {
            return true;
        }
        let paths = [crossing.left, crossing.entered].map(|face| program.occurrence_path(face.occurrence()));
        let is_on = |placement: &Placement, face: usize| placement.is_on(paths[face].steps());
        match self.required.as_slice() {
            [front, behind] if self.is_between_copies => is_on(front, 0) && is_on(behind, 1),
            // a mother has no face of its own where its daughter begins
            all => all.iter().all(|placement| is_on(placement, 0) || is_on(placement, 1)),
        }
    }
}
