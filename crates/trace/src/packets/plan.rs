//! What is done for every eight rays, laid out once for a small model.

use super::logic::{Logic, Tape, Wire};
use super::normal::Slope;
use rayweave_math::Vec3;
use rayweave_model::{
    Edge, Face, LeafFacet, LeafId, LeafKind, PlacementId, Program, Prototype, PrototypeId, SurfaceId,
};
use rayweave_shape::lanes::{Facet, Kernel, LaneLimits};
use rayweave_shape::surface::{Surface, delta_of};
use std::sync::Arc;

/// Stretches that a plan may have: each has two ends, which are told apart by six bits.
pub(super) const MOST: usize = 32;

/// Steps that each of its boolean functions may have.
pub(super) const STEPS: usize = 128;

/// Gates that the boolean skeleton may have: deep chains of operators over a few leaves are not worth it.
const GATES: usize = 512;

/// Models of more leaves than this are left to the weave: tables of faces and plans would take too much memory.
pub(super) const LARGE: usize = 1 << 16;

/// Beyond so many comparisons the solids of a union are asked one by one for first hits.
pub(super) const APART: usize = 16;

/// Beyond so many comparisons it is better to leave out the leaves that no ray comes near.
pub(super) const SMALL: usize = 64;

/// Winners are tabled for so many stretches.
const TABLED: usize = 8;

/// No stretch.
pub(super) const NONE: u32 = u32::MAX;

/// A small model, ready for lanes.
///
/// Along a ray a leaf is one stretch, less the stretches that some of its facets cut out of it (the bore of a tube). All
/// these stretches are numbered; the boolean skeleton is a function of whether a time is in each of them.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// What all plans of the model share.
    pub model: Arc<Common>,
    pub leaves: Vec<LeafPlan>,
    pub facets: Vec<Facet>,
    /// For each stretch: whether the winner changes if that alone does.
    pub differences: Vec<Difference>,
    /// What is inside, for each region.
    pub regions: Tape,
    /// The winner for every set of stretches, if there are few: a table is read faster than the tape.
    winners: Vec<u32>,
    /// The winner as t -> -inf, if it is the same for all rays.
    pub start: Option<u32>,
    /// True if inside is one region, and not of the medium of the world.
    pub is_plain: bool,
}

/// What holds for a model as a whole.
#[derive(Clone, Debug)]
pub(super) struct Common {
    pub limits: LaneLimits,
    /// The faces by their numbers.
    pub faces: Vec<Face>,
    /// How their normals are found.
    pub slopes: Vec<Slope>,
}

impl Common {
    /// For a model; `None` if it is too large or has no size.
    pub fn new(program: &Program) -> Option<Arc<Common>> {
        let group = program.prototype(PrototypeId(0));
        if group.leaves.len() > LARGE || program.facets().len() > 8 * LARGE || group.ball.radius <= 0.0 {
            return None;
        }
        Some(Arc::new(Common {
            limits: limits(program, group, group.leaves.clone().map(LeafId)),
            faces: faces(program),
            slopes: Slope::all(program),
        }))
    }
}

/// When a stretch matters.
#[derive(Clone, Debug)]
pub(super) enum Difference {
    /// If a time is in all of some stretches and in none of some others.
    Cube(Vec<Literal>),
    /// By any other function.
    Tape(Tape),
}

/// A stretch in which a time has to be, or not to be.
#[derive(Clone, Copy, Debug)]
pub(super) struct Literal {
    /// The number of the stretch.
    pub stretch: u32,
    /// True if the time has to be in it.
    pub inside: bool,
    /// True if it is this one's part to look whether both end at the same time.
    pub ties: bool,
}

impl Difference {
    fn new(logic: &Logic, outputs: &[Wire], own: usize) -> Difference {
        // in a copy: what one difference adds to the graph is nothing to the next
        let mut logic = logic.clone();
        let difference = logic.difference(outputs, own);
        let literal =
            |(stretch, inside): (u32, bool)| Literal { stretch, inside, ties: stretch as usize > own };
        match logic.cube(difference) {
            Some(cube) => Difference::Cube(cube.into_iter().map(literal).collect()),
            None => Difference::Tape(logic.tape(&[difference])),
        }
    }

    fn steps(&self) -> usize {
        match self {
            Difference::Cube(literals) => literals.len(),
            Difference::Tape(tape) => tape.steps.len(),
        }
    }
}

/// One leaf.
#[derive(Clone, Debug)]
pub(super) struct LeafPlan {
    pub facets: std::ops::Range<usize>,
    /// The number of its stretch.
    pub span: usize,
    /// True if nothing is inside where this leaf is not.
    pub is_needed: bool,
}

impl Plan {
    /// For all that is asked of a model; `None` if that is too large for lanes.
    pub fn new(program: &Program, model: &Arc<Common>) -> Option<Plan> {
        let group = program.prototype(PrototypeId(0));
        let is_plain = program.regions().len() == 1 && program.regions()[0].medium != 0;
        match group.leaves.len() {
            0..=MOST => Plan::of(program, model, group, group.expression.outputs(), is_plain),
            _ => None,
        }
    }

    /// For a part of a group; `None` if that is too large for lanes, or has placed solids or surfaces for which there is no
    /// kernel.
    pub fn of(
        program: &Program,
        model: &Arc<Common>,
        group: &Prototype,
        asked: &[Edge],
        is_plain: bool,
    ) -> Option<Plan> {
        let mut plan = Plan {
            model: model.clone(),
            leaves: Vec::new(),
            facets: Vec::new(),
            differences: Vec::new(),
            regions: Tape::default(),
            winners: Vec::new(),
            start: None,
            is_plain,
        };
        let (mut stretches, mut bounded) = (0, Vec::new());
        let mut logic = Logic::new();
        let outputs = logic.outputs(&group.expression, asked, GATES, |logic, leaf| {
            let id = LeafId(group.leaves.start + leaf.0);
            let LeafKind::Shape { facets } = program.leaf(id).kind() else { return None };
            let bounds = program.leaf_bounds(id);
            bounded.extend((bounds.is_finite() || bounds.is_empty()).then_some(stretches));
            plan.leaf(program, facets, logic, &mut stretches)
        })?;
        plan.differences = (0..stretches).map(|k| Difference::new(&logic, &outputs, k)).collect();
        plan.regions = logic.tape(&outputs);
        let steps = plan.differences.iter().map(Difference::steps).chain([plan.regions.steps.len()]);
        if steps.max() > Some(STEPS) {
            return None;
        }
        if stretches <= TABLED {
            plan.winners = (0..1 << stretches).map(|holds| plan.regions.winner(holds)).collect();
        }
        plan.start = winner_far_out(&mut logic, &outputs, &bounded);
        for leaf in &mut plan.leaves {
            // in a copy: what this adds to the graph is nothing to the next
            let without = logic.clone().with(&outputs, |k| (k == leaf.span).then_some(Wire::FALSE));
            leaf.is_needed = without.iter().all(|&wire| wire == Wire::FALSE);
        }
        // rays that miss one of these need not be asked about others
        plan.leaves.sort_by_key(|leaf| !leaf.is_needed);
        Some(plan)
    }

    /// The stretches of a leaf; whether a time is in the leaf.
    fn leaf(
        &mut self,
        program: &Program,
        facets: std::ops::Range<u32>,
        logic: &mut Logic,
        stretches: &mut usize,
    ) -> Option<Wire> {
        let (span, first) = (take(stretches)?, self.facets.len());
        let mut inside = logic.input(span);
        for _ in 0..leaf_facets(program, facets, &mut self.facets)? {
            let wire = logic.input(take(stretches)?);
            inside = logic.and(inside, wire.not());
        }
        self.leaves.push(LeafPlan { facets: first..self.facets.len(), span, is_needed: false });
        Some(inside)
    }

    /// Comparisons with other stretches for each group of rays, in pairs: what grows with the square of a model's size.
    pub fn comparisons(&self) -> usize {
        self.differences.iter().map(Difference::steps).sum()
    }

    /// The winner where some stretches hold, a bit each.
    pub fn winner(&self, holds: u64) -> u32 {
        self.winners.get(holds as usize).copied().unwrap_or_else(|| self.regions.winner(holds))
    }

    /// The number of stretches.
    pub fn stretches(&self) -> usize {
        self.differences.len()
    }
}

/// Adds the facets of a leaf, and numbers the gaps that they may cut out of its stretch, from 1; how many these are, or
/// `None` if there is no kernel for some facet.
pub(super) fn leaf_facets(
    program: &Program,
    range: std::ops::Range<u32>,
    facets: &mut Vec<Facet>,
) -> Option<usize> {
    let (mut gaps, first) = (0, facets.len());
    let all = &program.facets()[range.start as usize..range.end as usize];
    for (number, facet) in range.zip(all) {
        let kernel = Kernel::of(&program.surface(facet.surface()).surface)?;
        let is_one_piece = facet.inside() && is_one_piece(program, all, &kernel);
        let SurfaceId(surface) = facet.surface();
        let mut facet = Facet {
            kernel,
            inside: facet.inside(),
            face: f64::from(number),
            surfaces: [f64::from(surface); 2],
            gap: NONE,
            is_one_piece,
        };
        if !facet.has_one_gap() {
            return None;
        }
        if facet.can_gap() && !is_one_piece {
            gaps += 1;
            facet.gap = gaps;
        }
        match facets[first..].last().and_then(|last| last.joined(&facet)) {
            Some(both) => *facets.last_mut()? = both,
            None => facets.push(facet),
        }
    }
    facets[first..].sort_by_key(|facet| facet.is_one_piece);
    Some(gaps as usize)
}

/// The winner where a time is in none of the bounded stretches, if the others do not matter then.
fn winner_far_out(logic: &mut Logic, outputs: &[Wire], bounded: &[usize]) -> Option<u32> {
    let far = logic.with(outputs, |k| bounded.contains(&k).then_some(Wire::FALSE));
    let is_constant = |wire: &Wire| *wire == Wire::FALSE || *wire == Wire::TRUE;
    let winner = far.iter().rposition(|&wire| wire == Wire::TRUE).map_or(0, |k| k as u32 + 1);
    far.iter().all(is_constant).then_some(winner)
}

fn take(stretches: &mut usize) -> Option<usize> {
    *stretches += 1;
    (*stretches <= MOST).then_some(*stretches - 1)
}

/// True if the planes of a leaf leave no room on both sides of the waist of a surface, as those of a frustum.
fn is_one_piece(program: &Program, facets: &[LeafFacet], kernel: &Kernel) -> bool {
    kernel.waist().is_some_and(|waist| facets.iter().any(|facet| is_beyond(program, facet, waist)))
}

/// True if the facet is a plane, and a point lies on it or beyond.
fn is_beyond(program: &Program, facet: &LeafFacet, point: Vec3) -> bool {
    let entry = program.surface(facet.surface());
    let Surface::Plane(plane) = &entry.surface else { return false };
    let (value, _) = plane.value_and_gradient(point);
    let beyond = if facet.inside() { value } else { -value };
    beyond >= -delta_of(entry.magnitude + point.length())
}

/// For rays that may meet some leaves of a group.
pub(super) fn limits(
    program: &Program,
    group: &Prototype,
    leaves: impl Iterator<Item = LeafId>,
) -> LaneLimits {
    let mut limits = LaneLimits {
        centre: group.ball.centre,
        radius: group.ball.radius,
        // leaves may reach farther than their surfaces, and the points of a chord are of that size, too
        magnitude: group.ball.centre.length() + group.ball.radius / 16.0,
        largest_radius: 0.0,
        bend: 0.0,
    };
    let facets = leaves.flat_map(|leaf| program.leaf(leaf).facets());
    for entry in facets.map(|facet| program.surface(facet.surface())) {
        limits.magnitude = limits.magnitude.max(entry.magnitude);
        match &entry.surface {
            Surface::Plane(_) => {}
            Surface::Sphere(s) => limits.largest_radius = limits.largest_radius.max(s.radius),
            Surface::Cylinder(s) => limits.largest_radius = limits.largest_radius.max(s.radius),
            Surface::Cone(s) => limits.bend = limits.bend.max(1.0 + s.slope * s.slope),
            Surface::Quadric(_) => limits.bend = limits.bend.max(1.0),
            Surface::Torus(_) | Surface::AffineTorus(_) | Surface::Object(_) => {}
        }
    }
    limits
}

fn faces(program: &Program) -> Vec<Face> {
    let mut faces = Vec::with_capacity(program.facets().len());
    for leaf in program.leaves() {
        faces.extend(leaf.facets().iter().zip(0..).map(|(side, facet)| Face {
            leaf: leaf.id(),
            facet,
            surface: side.surface(),
            placement: PlacementId(0),
        }));
    }
    faces
}
