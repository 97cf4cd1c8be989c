//! The kinds of boundaries between two regions, as far as they follow from the regions alone.

use super::borders::SurfaceTable;
use crate::boundary::Reflection;
use crate::surface::OpticalSurface;

/// The kinds of boundaries between the regions of a detector.
#[derive(Clone, Debug, Default)]
pub(crate) struct Meetings {
    /// The number of rows of the table, and of columns: 0 for detectors of many regions.
    regions: usize,
    /// For each region in front, one entry for each region behind.
    table: Vec<Meeting>,
}

/// A kind of boundary between two regions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Meeting {
    /// A bare interface between two materials.
    Bare,
    /// The surface with this number, which reflects by one rule.
    Painted(u32, Reflection),
    /// Anything else.
    Other,
}

impl Meetings {
    pub fn new(boundaries: &SurfaceTable, surfaces: &[OpticalSurface], material_of: &[u32]) -> Meetings {
        let rules: Vec<Option<Reflection>> = surfaces.iter().map(Reflection::of).collect();
        let regions = boundaries.tabulated();
        let material = |region: u32| material_of.get(region as usize);
        let meeting = |before: u32, after: u32| match boundaries.between([before, after]) {
            Some(None) if material(before) != material(after) => Meeting::Bare,
            Some(Some(surface)) => match rules[surface] {
                Some(rule) => Meeting::Painted(surface as u32, rule),
                None => Meeting::Other,
            },
            _ => Meeting::Other,
        };
        let all = 0..regions as u32;
        let table = all.clone().flat_map(|before| all.clone().map(move |after| (before, after)));
        Meetings { regions, table: table.map(|(before, after)| meeting(before, after)).collect() }
    }

    /// The kind of the boundary from one region to another.
    #[inline]
    pub fn of(&self, [before, after]: [u32; 2]) -> Meeting {
        // a region beyond the table has no surface, but its number may be that of a pair in the next row
        if after as usize >= self.regions {
            return Meeting::Other;
        }
        let place = before as usize * self.regions + after as usize;
        self.table.get(place).copied().unwrap_or(Meeting::Other)
    }
}
