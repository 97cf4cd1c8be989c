//! Results of checks.

use super::{Finding, FindingKind};
use rayweave_scene::Unit;

/// The result of a check.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CheckReport {
    /// The unit of all lengths.
    pub unit: Unit,
    /// All findings, sorted by their kind, then in the order of the regions.
    pub findings: Vec<Finding>,
    /// The extent of the check.
    pub scope: Scope,
}

/// The extent of a check: what was proved, sampled and left out.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Scope {
    /// The number of rays.
    pub rays: u64,
    /// The number of cells along an edge of the cross-sections of the model: that of the settings, or fewer where many shapes overlap.
    pub cells: u32,
    /// The number of cells along an edge of the cross-sections of the box of each region; 0 if so many shapes overlap that no rays go
    /// through single regions.
    pub cells_in_regions: u32,
    /// The mean number of shapes that a ray through the model reaches, by their boxes.
    pub reached: f64,
    /// The number of chords that rays through the whole model and through single regions have in the regions. Their walls were
    /// compared with [`wall`](Self::wall).
    pub chords: u64,
    /// The number of points on edges and at corners, found where rays hit different faces near each other, from which walls and gaps
    /// were searched. Edges that point out of a region are not counted.
    pub edges: u64,
    /// Faces, edges, pairs of them and narrow places beyond the limits, from which no walls and gaps were searched.
    pub edges_left_out: u64,
    /// Walls thinner than this are reported.
    pub wall: f64,
    /// Gaps narrower than this are reported.
    pub gap: f64,
    /// Overlaps no deeper than this count as rounding error.
    pub distance: f64,
    /// The number of parts: regions divided into the copies and operands of their unions.
    pub parts: u64,
    /// Pairs of parts of different regions with disjoint boxes: proved to have nothing in common.
    pub apart: u64,
    /// Pairs of parts sampled with rays.
    pub pairs: u64,
    /// Pairs of parts beyond the limit, not checked.
    pub left_out: u64,
    /// Operands sampled with rays.
    pub operands: u64,
    /// Operands beyond the limit, not checked.
    pub operands_left_out: u64,
    /// Regions whose separate pieces were not counted: that would need too many rays, there seem to be more than 200 pieces, or the model
    /// has more than 32 regions.
    pub pieces_left_out: u64,
    /// True if closed cavities were not searched to the end, for the same reasons.
    pub cavities_left_out: bool,
    /// True if the model has a hierarchy of mothers and daughters.
    pub has_hierarchy: bool,
}

impl CheckReport {
    /// The findings of a kind.
    pub fn of(&self, kind: FindingKind) -> impl Iterator<Item = &Finding> {
        self.findings.iter().filter(move |finding| finding.kind == kind)
    }
}

/// The progress of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CheckProgress {
    /// The number of rays so far, those of volumes and of other follow-up searches included.
    pub rays: u64,
    /// The finished work: for [`check`](super::check()), rays of planned searches; for
    /// [`check_share`](super::check_share), searches.
    pub done: u64,
    /// The planned work.
    pub total: u64,
}
