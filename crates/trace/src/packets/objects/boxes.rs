//! The cells that are boxes, for callers that move particles from face to face: see [`BoxCells`].

use super::super::places::unit_of_plane;
use super::cells::{Cell, NONE};
use super::{Method, Objects};
use rayweave_math::Vec3;
use rayweave_model::{AxisBox, BoxCell, BoxCells, PlacementId, Program, RegionId, SurfaceId};
use rayweave_shape::lanes::{AxisSlab, Kernel};
use rayweave_shape::surface::{Surface, delta_of};

/// The 1-norm of the shortest piece of a ray that no face coincides with, in tolerances, if its normal speed is at least
/// [`BoxCells::SLOW`]: 2 / SLOW, with a margin of a factor of 64.
const SEPARATE: f64 = 64.0 * 2.0 / BoxCells::SLOW;

/// The lengths that occur in tolerances, with a margin, in those of the model.
const LENGTHS: f64 = 4.0;

/// The largest ratio of these lengths to the radius of the model.
const FAR: f64 = 1e6;

impl Objects {
    /// The cells that are boxes, each with few others, in frames that are not turned; `None` without any.
    pub(super) fn find_box_cells(&self, program: &Program) -> Option<BoxCells> {
        let mut zeros = None;
        let mut numbers: Vec<Option<u32>> = vec![None; self.objects.len()];
        let (mut boxes, mut lengths) = (Vec::new(), 0.0f64);
        for k in 0..self.objects.len() {
            let Some((own, own_zeros)) = self.axis_box(program, k) else { continue };
            // all have the same: they are parts of the normals that callers compute with
            if *zeros.get_or_insert(own_zeros) != own_zeros {
                continue;
            }
            numbers[k] = Some(boxes.len() as u32);
            let offsets =
                own.low.iter().chain(&own.high).fold(0.0, |most: f64, offset| most.max(offset.abs()));
            lengths = lengths.max(3.0 * offsets + own.shift.abs().element_sum());
            boxes.push(own);
        }
        let limits = &self.model.limits;
        lengths += limits.centre.abs().element_sum() + 4.0 * limits.radius + limits.magnitude;
        if lengths > FAR * limits.radius {
            return None;
        }
        let mut cells = Vec::new();
        let mut of_cell = vec![None; self.cells.count()];
        for number in 0..self.cells.count() {
            let cell = self.cells.get(number as u32);
            if let Some(list) = self.listed_boxes(cell, &numbers).filter(|list| are_distinct(&boxes, list)) {
                of_cell[number] = Some(cells.len() as u32);
                boxes[list[0] as usize].cell = of_cell[number];
                cells.push(BoxCell { list, behind: RegionId(cell.base as u32) });
            }
        }
        for number in 0..self.cells.count() {
            let cell = self.cells.get(number as u32);
            let Some(own) = numbers[self.cells.list(cell)[0] as usize] else { continue };
            let around = (cell.mother != NONE).then(|| of_cell[cell.mother as usize]).flatten();
            boxes[own as usize].around = around.and_then(|around: u32| {
                let place = cells[around as usize].list.iter().position(|&other| other == own)?;
                (place > 0).then_some((around, place))
            });
        }
        let margin = self.cells.slack.max(SEPARATE * delta_of(LENGTHS * lengths));
        let [low, high] = zeros?.map(f64::from_bits);
        (!cells.is_empty()).then(|| BoxCells::new(boxes, cells, margin, [low, high]))
    }

    /// The boxes of the list of a cell, if it has only boxes, and few.
    fn listed_boxes(&self, cell: &Cell, numbers: &[Option<u32>]) -> Option<Vec<u32>> {
        let list = self.cells.list(cell);
        let is_short = cell.crowd == NONE && list.len() <= BoxCells::MOST;
        if is_short { list.iter().map(|&k| numbers[k as usize]).collect() } else { None }
    }

    /// A solid as a box without its cells, and the bits of the zeros of its unit normals, if it is a box across the axes.
    fn axis_box(&self, program: &Program, k: usize) -> Option<(AxisBox, [u64; 2])> {
        let object = &self.objects[k];
        let Method::Plan(plan) = &self.parts[object.part as usize].method else { return None };
        if !plan.is_single_span() || plan.leaves.len() != 1 || plan.facets.len() != 3 {
            return None;
        }
        let steps = self.steps(object);
        let shift = match steps {
            [] => Vec3::ZERO,
            [step] => step.translation_only()?,
            _ => return None,
        };
        let (mut low, mut high) = ([f64::NAN; 3], [f64::NAN; 3]);
        let (mut surfaces, mut zeros) = ([SurfaceId(0); 6], [None; 2]);
        for facet in &plan.facets {
            let &Kernel::AxisSlab(AxisSlab { axis, low: below, high: above, turned }) = &facet.kernel else {
                return None;
            };
            let axis = usize::from(axis);
            (low[axis], high[axis]) = (below.0, above.0);
            for side in 0..2 {
                let surface = SurfaceId(facet.surfaces[side] as u32);
                surfaces[axis + 3 * side] = surface;
                let Surface::Plane(plane) = &program.surface(surface).surface else { return None };
                // the outward normal; equal planes share an entry, with the normal of the first
                let unit = unit_of_plane(plane.normal, steps);
                let unit = if turned[side] { -unit } else { unit };
                let sign = if side == 0 { -1.0 } else { 1.0 };
                let own = [1, 2].map(|other| unit[(axis + other) % 3].to_bits());
                let is_zero = own[0] == own[1] && f64::from_bits(own[0]) == 0.0;
                if unit[axis] != sign || !is_zero || *zeros[side].get_or_insert(own[0]) != own[0] {
                    return None;
                }
            }
        }
        let is_complete = low.iter().chain(&high).all(|offset| offset.is_finite());
        let (region, placement) = (RegionId(object.region as u32), PlacementId(object.placement));
        let own = AxisBox { region, placement, shift, low, high, surfaces, cell: None, around: None };
        is_complete.then_some((own, [zeros[0]?, zeros[1]?]))
    }
}

/// True if no surface belongs to two boxes of a list.
fn are_distinct(boxes: &[AxisBox], list: &[u32]) -> bool {
    let surfaces = |k: &u32| {
        let own = &boxes[*k as usize];
        own.surfaces.map(|surface| (own.placement, surface))
    };
    let mut all: Vec<_> = list.iter().flat_map(surfaces).collect();
    all.sort_unstable();
    all.windows(2).all(|pair| pair[0] != pair[1])
}
