//! The weave: an event sweep along each ray, for models of any size.
//!
//! For each ray a BVH finds the leaves whose boxes it passes. Their boundary events are sorted by time and
//! applied, one by one, to the boolean network of the group, which yields the change of region. Afterwards
//! only the touched leaves are reset, so that the cost of a ray depends on the leaves that it touches and not
//! on the size of the model. A placed solid is one leaf of the group around it; its boundary events come from
//! a sweep of its own group in its own frame. For first crossings of models with many leaves, the leaves are
//! intersected in order along the ray (`nearest`).

mod list;
mod nearest;
mod points;
mod scratch;

pub(crate) use list::GroupQuery;
pub use scratch::WeaveScratch;

use crate::accel::Accel;
use rayweave_math::Vec3;
use rayweave_model::{
    Evaluator, GroupPoint, Limit, Program, PrototypeId, Query, RayAnswer, Rays, RegionId, Sink, State, Window,
};
pub(crate) use scratch::Level;
use std::sync::Arc;

/// The evaluator for models of any size.
#[derive(Clone, Debug)]
pub struct Weave {
    program: Arc<Program>,
    /// A BVH of the leaves of each group.
    accel: Vec<Accel>,
}

impl Weave {
    /// An evaluator of a compiled model.
    pub fn new(program: Arc<Program>) -> Weave {
        let accel = program.prototypes().iter().map(|group| Accel::new(&program, group)).collect();
        Weave { program, accel }
    }

    /// Memory of the BVHs of all groups, in bytes.
    pub fn hierarchy_bytes(&self) -> usize {
        self.accel.iter().map(Accel::bytes).sum()
    }

    fn state(&self, owner: u32) -> State {
        let region = RegionId(owner);
        State { region, medium: self.program.medium_of(region) }
    }
}

/// Largest number of leaves for which all touched leaves are intersected even for a first crossing:
/// for so few, front-to-back traversal costs more than it saves.
const FEW: usize = 12;

/// The query for a ray that starts on surfaces, limited to t >= 0. Before t = 0 a leaf with a start surface may have
/// either side, even outside of its box.
pub(crate) fn from_zero<'a>(query: &Query<'a>) -> Query<'a> {
    match Window::new(query.window.t_min().max(0.0), query.window.t_max()) {
        Ok(window) => Query { window, ..*query },
        Err(_) => *query,
    }
}

impl Evaluator for Weave {
    type Scratch = WeaveScratch;

    fn name(&self) -> &'static str {
        "weave"
    }

    fn program(&self) -> &Program {
        &self.program
    }

    fn scratch(&self) -> WeaveScratch {
        WeaveScratch::default()
    }

    fn crossings(&self, rays: Rays<'_>, query: &Query<'_>, scratch: &mut WeaveScratch, sink: &mut dyn Sink) {
        let few = self.program.prototype(PrototypeId(0)).leaves.len() <= FEW;
        for i in 0..rays.len() {
            let starts = query.starts.map_or(&[][..], |lists| lists.of(i));
            scratch.crossings.clear();
            let query = if starts.is_empty() { *query } else { from_zero(query) };
            let start = match query.limit {
                Limit::First if !few && (starts.is_empty() || query.window.t_max() > 0.0) => {
                    self.nearest(rays.get(i), &query, starts, scratch)
                }
                _ => self.list(rays.get(i), &query, starts, scratch),
            };
            sink.ray(RayAnswer { ray: i, start, crossings: &scratch.crossings });
        }
    }

    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut WeaveScratch, out: &mut [RegionId]) {
        for (i, region) in out.iter_mut().enumerate() {
            let point = Vec3::new(points[0][i], points[1][i], points[2][i]);
            *region = self.region_at(&GroupPoint::world(point), scratch);
        }
    }
}
