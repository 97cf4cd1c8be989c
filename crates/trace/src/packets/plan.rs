//! Plans: a small model, prepared for evaluation in SIMD lanes.

use super::logic::{Logic, Tape, Wire};
use super::normal::Slopes;
use super::remainder::{MOST_SPANS, NUMBER, Remainder};
use rayweave_math::Vec3;
use rayweave_model::{
    Edge, Face, LeafFacet, LeafId, LeafKind, PlacementId, Program, Prototype, PrototypeId, SurfaceId,
};
use rayweave_shape::lanes::{Kernel, LaneFacet, LaneLimits};
use rayweave_shape::surface::{Surface, delta_of};
use std::sync::Arc;

/// Largest number of spans of a plan: each has two ends, whose index fits six bits.
pub(super) const MAX_SPANS: usize = 32;

/// Largest number of instructions of each boolean function of a plan.
pub(super) const STEPS: usize = 128;

/// Largest number of gates of the boolean skeleton. Deep chains of operators over few leaves are not worth a
/// plan.
const GATES: usize = 512;

/// Number of leaves above which the weave traces the model: tables of faces and plans would take too much
/// memory.
pub(super) const LARGE: usize = 1 << 16;

/// Number of leaves of a model of one region, most of them placed solids, above which the weave traces it: copies share their
/// plans, and take much less memory.
const MANY: usize = 1 << 17;

/// Number of comparisons above which the solids of a union are intersected one by one for first hits.
pub(super) const APART: usize = 16;

/// Number of comparisons above which it pays to skip the leaves that no ray comes near.
pub(super) const SMALL: usize = 64;

/// Largest number of spans for which the owners are tabulated.
const TABLED: usize = 8;

/// No span.
pub(super) const NONE: u32 = u32::MAX;

/// A small model, prepared for evaluation in SIMD lanes.
///
/// Along a ray a leaf is one span, less the gaps that some of its facets cut out of it (the bore of a tube).
/// All these spans and gaps are numbered; the boolean skeleton is a function of whether t lies in each of
/// them. The leaves that contain the inside of the solid (all leaves of an intersection of convex solids, the
/// minuend of a difference) have a common span, the intersection of theirs.
#[derive(Clone, Debug)]
pub(super) struct Plan {
    /// Data shared by all plans of the model.
    pub model: Arc<Common>,
    /// The leaves with the common span come first.
    pub leaves: Vec<LeafPlan>,
    /// The number of leaves with the common span.
    pub common: usize,
    pub facets: Vec<LaneFacet>,
    /// For each span, the boolean difference of the owner with respect to it.
    pub differences: Vec<Difference>,
    /// A boolean function per region: true inside.
    pub regions: Tape,
    /// The owner for every set of spans, if there are few: a table lookup is faster than the tape.
    owners: Vec<u32>,
    /// The owner as t -> -inf, if it is the same for all rays.
    pub start: Option<u32>,
    /// True if the inside is one region whose medium is not that of the world.
    pub is_plain: bool,
    /// The spans, if the inside is the common span less the others.
    pub remainder: Option<Remainder>,
}

/// Data shared by all plans of a model.
#[derive(Clone, Debug)]
pub(super) struct Common {
    pub limits: LaneLimits,
    /// The faces by number.
    pub faces: Vec<Face>,
    /// The methods for their normals.
    pub slopes: Slopes,
}

impl Common {
    /// Tables of a model; `None` if it is too large or has no extent.
    pub fn new(program: &Program) -> Option<Arc<Common>> {
        let group = program.prototype(PrototypeId(0));
        if program.facets().len() > 8 * LARGE || group.ball.radius <= 0.0 {
            return None;
        }
        let is_shape = |&leaf: &u32| matches!(program.leaf(LeafId(leaf)).kind(), LeafKind::Shape { .. });
        if group.leaves.len() > LARGE
            && (group.leaves.len() > most_solids(program)
                || group.leaves.clone().filter(is_shape).count() > LARGE)
        {
            return None;
        }
        Some(Arc::new(Common {
            limits: limits(program, group, group.leaves.clone().map(LeafId)),
            faces: faces(program),
            slopes: Slopes::new(program),
        }))
    }
}

/// Largest number of solids of a model that is traced in lanes.
pub(super) fn most_solids(program: &Program) -> usize {
    if program.regions().len() == 1 { MANY } else { LARGE }
}

/// The boolean difference of the owner with respect to a span.
#[derive(Clone, Debug)]
pub(super) enum Difference {
    /// A conjunction: t lies in all of some spans and in none of some others.
    Cube(Vec<Literal>),
    /// Any other function.
    Tape(Tape),
}

/// A condition on one span.
#[derive(Clone, Copy, Debug)]
pub(super) struct Literal {
    /// The index of the span.
    pub span: u32,
    /// True if t must lie in the span, false if it must not.
    pub inside: bool,
    /// True if ties with this span are detected here; each pair of spans is checked once.
    pub ties: bool,
}

impl Difference {
    fn new(logic: &Logic, outputs: &[Wire], own: usize) -> Difference {
        // on a copy, so that the gates of one difference do not enlarge the graph of the next
        let mut logic = logic.clone();
        let difference = logic.difference(outputs, own);
        let literal = |(span, inside): (u32, bool)| Literal { span, inside, ties: span as usize > own };
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
    /// The index of its span.
    pub span: usize,
    /// The index of the span of its first gap, less 1.
    pub gaps: usize,
    /// True if the inside of the solid lies within this leaf.
    is_needed: bool,
}

impl Plan {
    /// The plan of a whole model; `None` if it is too large for lanes.
    pub fn new(program: &Program, model: &Arc<Common>) -> Option<Plan> {
        let group = program.prototype(PrototypeId(0));
        let is_plain = program.regions().len() == 1 && program.regions()[0].medium != 0;
        match group.leaves.len() {
            0..=MAX_SPANS => Plan::of(program, model, group, group.expression.outputs(), is_plain),
            _ => None,
        }
    }

    /// The plan of a part of a group; `None` if it is too large for lanes, or has placed solids or surfaces
    /// without a kernel.
    pub fn of(
        program: &Program,
        model: &Arc<Common>,
        group: &Prototype,
        outputs: &[Edge],
        is_plain: bool,
    ) -> Option<Plan> {
        let mut plan = Plan {
            model: model.clone(),
            leaves: Vec::new(),
            common: 0,
            facets: Vec::new(),
            differences: Vec::new(),
            regions: Tape::default(),
            owners: Vec::new(),
            start: None,
            is_plain,
            remainder: None,
        };
        let (mut span_count, mut bounded) = (0, Vec::new());
        let mut logic = Logic::new();
        let outputs = logic.outputs(&group.expression, outputs, GATES, |logic, leaf| {
            let id = LeafId(group.leaves.start + leaf.0);
            let LeafKind::Shape { facets } = program.leaf(id).kind() else { return None };
            let bounds = program.leaf_bounds(id);
            bounded.extend((bounds.is_finite() || bounds.is_empty()).then_some(span_count));
            plan.leaf(program, facets, logic, &mut span_count)
        })?;
        plan.start = owner_far_out(&mut logic, &outputs, &bounded);
        for leaf in &mut plan.leaves {
            // on a copy, so that the graph does not grow
            let without = logic.clone().with(&outputs, |k| (k == leaf.span).then_some(Wire::FALSE));
            leaf.is_needed = without.iter().all(|&wire| wire == Wire::FALSE);
        }
        let outputs = plan.share_span(&mut logic, outputs, &mut span_count);
        plan.differences = (0..span_count).map(|k| Difference::new(&logic, &outputs, k)).collect();
        plan.regions = logic.tape(&outputs);
        let steps = plan.differences.iter().map(Difference::steps).chain([plan.regions.steps.len()]);
        if steps.max() > Some(STEPS) {
            return None;
        }
        if span_count <= TABLED {
            plan.owners = (0..1 << span_count).map(|holds| plan.regions.owner(holds)).collect();
        }
        // rays that miss one of these need no other leaf
        plan.leaves.sort_by_key(|leaf| !leaf.is_needed);
        plan.common = plan.leaves.iter().filter(|leaf| leaf.is_needed).count();
        if is_plain && program.facets().len() < NUMBER as usize {
            plan.remainder = plan.common_less_others(&logic, &outputs);
        }
        Some(plan)
    }

    /// Numbers the span and the gaps of a leaf. Returns the function "t is in the leaf".
    fn leaf(
        &mut self,
        program: &Program,
        facets: std::ops::Range<u32>,
        logic: &mut Logic,
        span_count: &mut usize,
    ) -> Option<Wire> {
        let (span, first) = (take(span_count)?, self.facets.len());
        let mut inside = logic.input(span);
        for _ in 0..leaf_facets(program, facets, &mut self.facets)? {
            let wire = logic.input(take(span_count)?);
            inside = logic.and(inside, wire.not());
        }
        self.leaves.push(LeafPlan { facets: first..self.facets.len(), span, gaps: span, is_needed: false });
        Some(inside)
    }

    /// Gives the needed leaves a common span, with the number of the first of theirs, and renumbers all spans without holes.
    /// Returns the functions of the remaining spans and gaps: where the common span holds, the spans of all needed leaves do.
    fn share_span(&mut self, logic: &mut Logic, outputs: Vec<Wire>, span_count: &mut usize) -> Vec<Wire> {
        let mut needed = self.leaves.iter().filter(|leaf| leaf.is_needed).map(|leaf| leaf.span);
        let Some(common) = needed.next() else { return outputs };
        // ascending, as the leaves are in the order of their numbers
        let replaced: Vec<usize> = needed.collect();
        if replaced.is_empty() {
            return outputs;
        }
        let renumbered = |span: usize| span - replaced.partition_point(|&other| other < span);
        let inputs: Vec<Wire> = (0..*span_count)
            .map(|span| match replaced.binary_search(&span) {
                Ok(_) => Wire::TRUE,
                Err(_) => logic.input(renumbered(span)),
            })
            .collect();
        *span_count -= replaced.len();
        for leaf in &mut self.leaves {
            leaf.gaps = renumbered(leaf.gaps + 1) - 1;
            leaf.span = if leaf.is_needed { common } else { renumbered(leaf.span) };
        }
        logic.with(&outputs, |span| Some(inputs[span]))
    }

    /// The spans, if the inside is the common span less all others and these are few.
    fn common_less_others(&self, logic: &Logic, outputs: &[Wire]) -> Option<Remainder> {
        let (&[output], [first, ..], count) = (outputs, &self.leaves[..self.common], self.span_count())
        else {
            return None;
        };
        let literals =
            logic.cube(output).filter(|literals| literals.len() == count && count <= MOST_SPANS)?;
        let mut spans = [first.span; MOST_SPANS];
        let others = literals.iter().filter(|(_, inside)| !inside).map(|&(span, _)| span as usize);
        let found = spans[1..].iter_mut().zip(others).map(|(place, span)| *place = span).count();
        (found + 1 == count).then_some(Remainder { spans, count })
    }

    /// The facets of a leaf.
    pub fn facets_of(&self, leaf: &LeafPlan) -> &[LaneFacet] {
        &self.facets[leaf.facets.clone()]
    }

    /// True if the inside of the solid along a ray is the common span.
    pub fn is_single_span(&self) -> bool {
        self.common == self.leaves.len() && self.span_count() == 1
    }

    /// Cost of a bundle: the number of comparisons with other spans, counted once for both ends of a span.
    /// Quadratic in the size of the model.
    pub fn comparisons(&self) -> usize {
        self.differences.iter().map(Difference::steps).sum()
    }

    /// The owner where the spans in a bit mask contain t.
    pub fn owner(&self, holds: u64) -> u32 {
        self.owners.get(holds as usize).copied().unwrap_or_else(|| self.regions.owner(holds))
    }

    /// The index of the common span of several leaves; that of no span if there is none.
    pub fn common_span(&self) -> usize {
        if self.common > 1 { self.leaves[0].span } else { usize::MAX }
    }

    /// The number of spans.
    pub fn span_count(&self) -> usize {
        self.differences.len()
    }
}

/// Appends the facets of a leaf, and numbers from 1 the gaps that they may cut out of its span. Returns the
/// number of gaps; `None` if a facet has no kernel.
pub(super) fn leaf_facets(
    program: &Program,
    range: std::ops::Range<u32>,
    facets: &mut Vec<LaneFacet>,
) -> Option<usize> {
    let (mut gaps, first) = (0, facets.len());
    let all = &program.facets()[range.start as usize..range.end as usize];
    for (number, facet) in range.zip(all) {
        let kernel = Kernel::of(&program.surface(facet.surface()).surface)?;
        let is_one_piece = facet.inside() && is_one_piece(program, all, &kernel);
        let SurfaceId(surface) = facet.surface();
        let mut facet = LaneFacet {
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

/// The owner where t is in none of the bounded spans, if it does not depend on the others there.
fn owner_far_out(logic: &mut Logic, outputs: &[Wire], bounded: &[usize]) -> Option<u32> {
    let far = logic.with(outputs, |k| bounded.contains(&k).then_some(Wire::FALSE));
    let is_constant = |wire: &Wire| *wire == Wire::FALSE || *wire == Wire::TRUE;
    let owner = far.iter().rposition(|&wire| wire == Wire::TRUE).map_or(0, |k| k as u32 + 1);
    far.iter().all(is_constant).then_some(owner)
}

fn take(span_count: &mut usize) -> Option<usize> {
    *span_count += 1;
    (*span_count <= MAX_SPANS).then_some(*span_count - 1)
}

/// True if the planes of a leaf exclude one side of the waist of a surface, as those of a frustum do.
fn is_one_piece(program: &Program, facets: &[LeafFacet], kernel: &Kernel) -> bool {
    kernel.waist().is_some_and(|waist| facets.iter().any(|facet| is_beyond(program, facet, waist)))
}

/// True if the facet is a plane, and the point lies on it or outside of it.
fn is_beyond(program: &Program, facet: &LeafFacet, point: Vec3) -> bool {
    let entry = program.surface(facet.surface());
    if !matches!(entry.surface, Surface::Plane(_)) {
        return false;
    }
    let (value, _) = entry.surface.value_and_gradient(point);
    let beyond = if facet.inside() { value } else { -value };
    beyond >= -delta_of(entry.magnitude + point.length())
}

/// Limits for rays that may touch some leaves of a group.
pub(super) fn limits(
    program: &Program,
    group: &Prototype,
    leaves: impl Iterator<Item = LeafId>,
) -> LaneLimits {
    let mut limits = LaneLimits {
        centre: group.ball.centre,
        radius: group.ball.radius,
        // leaves may extend beyond the magnitude of their surfaces, and the points of a chord are as large
        magnitude: group.ball.centre.length() + group.ball.radius / 16.0,
        largest_radius: 0.0,
        bend: 0.0,
        is_spherical: true,
    };
    let facets = leaves.flat_map(|leaf| program.leaf(leaf).facets());
    for entry in facets.map(|facet| program.surface(facet.surface())) {
        limits.magnitude = limits.magnitude.max(entry.magnitude);
        limits.is_spherical &= matches!(entry.surface, Surface::Plane(_) | Surface::Sphere(_));
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
