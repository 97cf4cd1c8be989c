//! Compiled models along curves: the same answers as on rays, by the same rules.
//!
//! Every surface that the curve can meet is isolated ([`isolate`](crate::isolate)); from there on nothing differs from a
//! ray: leaves are conjunctions of facets, placed solids are leaves of the group around them, the flips run through
//! the boolean network of the group, and one weld along the curve joins the crossings between which the curve keeps within
//! delta of both surfaces. A placed solid is asked in its own frame, with the curve carried there by the composed map.
//! Surfaces that are one surface for the compiler are isolated once, so that equal surfaces give equal bits.
//!
//! *Cost*: each surface of each leaf whose box the curve passes is isolated over the whole window, so a trace costs the
//! number of such surfaces times what isolation says of the curve (a curve of many turns costs per turn). Leaves
//! that the curve misses cost a few comparisons of boxes each. For long curves through large models, cut the window.

mod boxes;
mod view;

use crate::curve::CurveError;
use crate::isolate::check_window;
use crate::{Curve, Point};
use boxes::Boxes;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::gate::NetworkState;
use rayweave_model::weld::{Flips, Trajectory, Weld};
use rayweave_model::{
    Crossing, Event, Face, LeafEvents, LeafId, LeafKind, Program, Prototype, PrototypeId, RegionId, Start,
    State, SurfaceId, Sweep, dress,
};
use rayweave_rootray::RootRay;
use rayweave_shape::Ray;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;
use view::View;

/// What a curve meets in a model.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveTrace {
    /// The region just after the beginning of the window; 0 is the world.
    pub start: RegionId,
    /// The crossings in order of time, strictly inside the window.
    pub crossings: Vec<Crossing>,
}

/// The crossings of a model by a curve strictly between `t0` and `t1`.
///
/// ```
/// use rayweave_model::{Program, RegionId, Solid};
/// use rayweave_shape::primitive::{Value, build};
/// use rayweave_space::curve::Helix;
/// use rayweave_space::{curve_point, trace_curve};
///
/// let ball = Solid::from(build("sphere", &[("radius", Value::Number(2.0))])?);
/// let program = Program::compile(&ball)?;
/// // a particle of gyro frequency 1 that starts in the middle, with a gyro radius of 1
/// let path = Helix::new([0.0; 3], [0.0, 1.0, 0.5], [0.0, 0.0, 1.0], 1.0)?;
/// let found = trace_curve(&program, &path, 0.0, 20.0)?;
/// assert_eq!((found.start, found.crossings.len()), (RegionId(1), 1));
/// let at = curve_point(&path, &found.crossings[0]);
/// assert!((at.iter().map(|x| x * x).sum::<f64>() - 4.0).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// A window that is not finite, not in order or beyond the curve's domain; a curve that breaks its promises, where that
/// is noticed (see [`CurveError`]).
pub fn trace_curve(
    program: &Program,
    curve: &dyn Curve<3>,
    t0: f64,
    t1: f64,
) -> Result<CurveTrace, CurveError> {
    trace_curve_from(program, curve, t0, t1, &mut Vec::new())
}

/// [`trace_curve`] of a curve that is known to begin on surfaces: `sides` names them, with the side of each just after
/// `t0`, and holds afterwards the sides just before `t1` of all surfaces that the curve may have met, so that a trajectory
/// may be traced piece by piece.
///
/// Light that leaves a face begins *on* it, and rounding decides on which side of it the first point lies. A surface that
/// is listed is not crossed as long as the curve keeps within delta of it from its beginning on; a curve that comes out of
/// that zone on the other side than listed crosses the surface at once. Sides of surfaces that the curve does not begin on
/// are not looked at.
///
/// ```
/// use rayweave_model::{PlacementId, Program, Solid, Start, SurfaceId};
/// use rayweave_shape::primitive::{Value, build};
/// use rayweave_space::curve::Parabola;
/// use rayweave_space::trace_curve_from;
///
/// let ball = Solid::from(build("sphere", &[("radius", Value::Number(2.0))])?);
/// let program = Program::compile(&ball)?;
/// // thrown into the ball from its lowest point
/// let throw = Parabola::new([0.0, 0.0, -2.0], [0.0, 0.0, 4.0], [0.0, 0.0, -2.0]);
/// let mut sides = vec![Start { surface: SurfaceId(0), placement: PlacementId(0), inside: true }];
/// let found = trace_curve_from(&program, &throw, 0.0, 3.0, &mut sides)?;
/// assert_eq!((found.start.0, found.crossings.len()), (1, 0));
/// assert!(sides[0].inside);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`trace_curve`]; `sides` are as they were then.
pub fn trace_curve_from(
    program: &Program,
    curve: &dyn Curve<3>,
    t0: f64,
    t1: f64,
    sides: &mut Vec<Start>,
) -> Result<CurveTrace, CurveError> {
    check_window(curve, t0, t1)?;
    let window = (t0, t1);
    let boxes = Boxes::new(curve, t0, t1)?;
    let mut ends = Vec::new();
    let mut frame = Frame::new(program, PrototypeId(0), View::world(curve), u32::MAX);
    let mut outer = Vec::new();
    let trace = loop {
        if let Some(leaf) = frame.next_leaf(&boxes) {
            if let Some(inner) = frame.enter(leaf, window, sides)? {
                outer.push(std::mem::replace(&mut frame, inner));
            }
            continue;
        }
        frame.events.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.leaf.cmp(&b.leaf)));
        ends.extend(frame.ends());
        let Some(around) = outer.pop() else {
            break frame.into_trace(curve);
        };
        std::mem::replace(&mut frame, around).into_leaf(&mut frame);
    };
    *sides = ends;
    Ok(trace)
}

/// The point of a crossing.
pub fn curve_point(curve: &dyn Curve<3>, crossing: &Crossing) -> Point<3> {
    curve.position(crossing.t)
}

/// The unit normal of a crossing, outward of what is entered or left: against the curve where it enters a region, along
/// it where it leaves for the world. As [`dress::normal`] on the tangent of the curve there.
pub fn curve_normal(program: &Program, curve: &dyn Curve<3>, crossing: &Crossing) -> Point<3> {
    let velocity = Vec3::from_array(curve.velocity(crossing.t));
    // at rest a curve has no tangent: then the normal is that of the face
    let direction = if velocity == Vec3::ZERO { Vec3::X } else { velocity };
    let tangent = Ray::new(Vec3::from_array(curve.position(crossing.t)), direction);
    dress::normal(program, &tangent, &Crossing { t: 0.0, ..*crossing }).to_array()
}

/// One group on the way down: what is known of its leaves so far.
struct Frame<'a> {
    program: &'a Program,
    prototype: &'a Prototype,
    view: View<'a>,
    /// The leaf of the group around it that it stands for.
    stands_for: u32,
    /// Where each leaf can matter.
    matters: Vec<Bounds>,
    next: u32,
    /// What is isolated already, by surface.
    known: BTreeMap<u32, RootRay>,
    state: NetworkState,
    events: Vec<Event>,
    leaf_events: LeafEvents,
}

impl<'a> Frame<'a> {
    fn new(program: &'a Program, id: PrototypeId, view: View<'a>, stands_for: u32) -> Frame<'a> {
        let prototype = program.prototype(id);
        Frame {
            program,
            prototype,
            view,
            stands_for,
            matters: program.matters(prototype),
            next: 0,
            known: BTreeMap::new(),
            state: prototype.network.start(),
            events: Vec::new(),
            leaf_events: LeafEvents::default(),
        }
    }

    /// The next leaf that the curve can meet.
    fn next_leaf(&mut self, boxes: &Boxes) -> Option<u32> {
        let leaves = &self.prototype.leaves;
        while self.next < leaves.end - leaves.start {
            let leaf = self.next;
            self.next += 1;
            let condition = self.prototype.condition;
            if boxes.meet(&self.matters[leaf as usize], condition, &self.view) {
                return Some(leaf);
            }
        }
        None
    }

    /// Adds the flips of a leaf that is a shape; for a placed solid the frame that is to be gone through first.
    fn enter(
        &mut self,
        leaf: u32,
        window: (f64, f64),
        sides: &[Start],
    ) -> Result<Option<Frame<'a>>, CurveError> {
        let id = LeafId(self.prototype.leaves.start + leaf);
        let entry = self.program.leaf(id);
        match &entry.kind() {
            LeafKind::Shape { facets, .. } => self.shape(id, leaf, facets, (window, sides)).map(|()| None),
            LeafKind::Instance { prototype, placement } => {
                let view = self.view.placed(&entry.place(), *placement);
                Ok(Some(Frame::new(self.program, *prototype, view, leaf)))
            }
        }
    }

    fn shape(
        &mut self,
        id: LeafId,
        leaf: u32,
        facets: &Range<u32>,
        asked: ((f64, f64), &[Start]),
    ) -> Result<(), CurveError> {
        let table = &self.program.facets()[facets.start as usize..facets.end as usize];
        for facet in table {
            self.isolate(facet.surface(), asked)?;
        }
        let known = &self.known;
        self.leaf_events.conjunction(table.len(), |k, flip| {
            let ray = known.get(&table[k].surface().0);
            ray.into_iter().flat_map(RootRay::times).for_each(flip);
            ray.is_some_and(|ray| ray.start().is_inside()) == table[k].inside()
        });
        let placement = self.view.placement;
        self.events.extend(self.leaf_events.flips.iter().map(|&(t, facet)| {
            let surface = table[facet as usize].surface();
            Event { t, leaf, face: Face { leaf: id, facet, surface, placement } }
        }));
        self.start_at(leaf, self.leaf_events.starts_inside);
        Ok(())
    }

    /// Isolates a surface, unless another leaf has needed it before.
    fn isolate(
        &mut self,
        surface: SurfaceId,
        (window, sides): ((f64, f64), &[Start]),
    ) -> Result<(), CurveError> {
        if let Entry::Vacant(place) = self.known.entry(surface.0) {
            let (entry, placement) = (self.program.surface(surface), self.view.placement);
            let found = self.view.isolate(entry, window)?;
            let start = sides.iter().find(|s| s.surface == surface && s.placement == placement);
            place.insert(match start {
                Some(start) => self.view.departing(entry, window, found, start.inside)?,
                None => found,
            });
        }
        Ok(())
    }

    /// The sides of all isolated surfaces at the end of the window.
    fn ends(&self) -> impl Iterator<Item = Start> + '_ {
        let placement = self.view.placement;
        self.known.iter().map(move |(&surface, ray)| Start {
            surface: SurfaceId(surface),
            placement,
            inside: ray.end().is_inside(),
        })
    }

    fn start_at(&mut self, leaf: u32, inside: bool) {
        if inside {
            self.prototype.network.flip(&mut self.state, leaf);
        }
    }

    /// The placed solid as one leaf of the group around it.
    fn into_leaf(mut self, outer: &mut Frame<'a>) {
        let leaf = self.stands_for;
        let mut inside = self.state.output(0);
        outer.start_at(leaf, inside);
        let mut sweep = Sweep::new(&self.prototype.network, &mut self.state, &self.events, f64::INFINITY);
        let flips = std::iter::from_fn(|| sweep.next_flip(&mut inside));
        outer.events.extend(flips.map(|(t, face)| Event { t, leaf, face }));
    }

    /// The crossings of the model itself.
    fn into_trace(mut self, curve: &'a dyn Curve<3>) -> CurveTrace {
        let program = self.program;
        let state = |winner: u32| {
            let region = RegionId(winner);
            State { region, medium: program.medium_of(region) }
        };
        let mut sweep = Sweep::new(&self.prototype.network, &mut self.state, &self.events, f64::INFINITY);
        let mut now = state(sweep.flips.winner());
        let mut trace = CurveTrace { start: now.region, crossings: Vec::new() };
        let mut weld = Weld::new(program, Along(curve), &self.events);
        while let Some(change) = sweep.next_change(&mut now, state) {
            trace.crossings.extend(weld.change(change, &mut sweep.flips));
        }
        trace.crossings.extend(weld.finish(sweep.position(), &mut sweep.flips));
        trace
    }
}

/// A curve as the weld sees it.
struct Along<'a>(&'a dyn Curve<3>);

impl Trajectory for Along<'_> {
    fn hugs(&self, program: &Program, face: Face, a: f64, b: f64) -> bool {
        let steps = program.descend(face.placement);
        let view = steps.fold(View::world(self.0), |view, place| view.placed(&place, 0));
        // a curve that breaks its promises was found out in isolation; what is new here hugs nothing
        view.hugs(program.surface(face.surface), a, b).unwrap_or(false)
    }
}
