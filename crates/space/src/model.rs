//! Tracing of curves through compiled models, by the same rules as for rays.
//!
//! [`isolate`](crate::isolate()) finds the sign changes of every surface that the curve can cross.
//! The remaining steps are the same as for rays: leaves are intersections of facets, placed solids
//! are leaves of the enclosing group, boundary events run through the boolean network of the group,
//! and one weld along the curve merges crossings between which the curve stays within delta of both
//! surfaces. A placed solid is traced in its own frame, with the curve transformed by the composed
//! map. A surface shared by several leaves is isolated once, so that equal surfaces give equal
//! bits.
//!
//! *Cost*: each surface of each leaf whose box the curve may cross is isolated over the whole window; see
//! [`isolate`](crate::isolate) for the cost of one surface. Other leaves cost a few box tests each. For long curves through large
//! models, split the window.

mod boxes;
mod view;

use crate::curve::CurveError;
use crate::isolate::check_window;
use crate::{Curve, Point};
use boxes::Boxes;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::gate::NetworkState;
use rayweave_model::weld::{LeafStates, Trajectory, Weld};
use rayweave_model::{
    Crossing, Event, Face, LeafEvents, LeafId, LeafKind, Program, Prototype, PrototypeId, RegionId, Start,
    State, SurfaceId, Sweep, attributes,
};
use rayweave_rootray::RootRay;
use rayweave_shape::Ray;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::ops::Range;
use view::View;

/// The crossings of a curve with a model.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveTrace {
    /// The region just after `t0`; 0 is the world.
    pub start: RegionId,
    /// The crossings in order of time, strictly within the window.
    pub crossings: Vec<Crossing>,
}

/// Traces a curve through a model, strictly between `t0` and `t1`.
///
/// ```
/// use rayweave_model::{Program, RegionId, Solid};
/// use rayweave_shape::primitive::{Value, build};
/// use rayweave_space::curve::Helix;
/// use rayweave_space::{curve_point, trace_curve};
///
/// let ball = Solid::from(build("sphere", &[("radius", Value::Number(2.0))])?);
/// let program = Program::compile(&ball)?;
/// // a particle with gyrofrequency 1 and gyroradius 1 that starts at the centre
/// let path = Helix::new([0.0; 3], [0.0, 1.0, 0.5], [0.0, 0.0, 1.0], 1.0)?;
/// let found = trace_curve(&program, &path, 0.0, 20.0)?;
/// assert_eq!((found.start, found.crossings.len()), (RegionId(1), 1));
/// let at = curve_point(&path, &found.crossings[0]);
/// assert!((at.iter().map(|x| x * x).sum::<f64>() - 4.0).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// The window is not finite, not increasing or outside the curve's domain, or a violation of the curve's contract was detected (see
/// [`CurveError`]).
pub fn trace_curve(
    program: &Program,
    curve: &dyn Curve<3>,
    t0: f64,
    t1: f64,
) -> Result<CurveTrace, CurveError> {
    trace_curve_from(program, curve, t0, t1, &mut Vec::new())
}

/// Like [`trace_curve`], for a curve that begins on known surfaces. `sides` lists their sides just after `t0`, and is replaced by the sides
/// just before `t1` of all surfaces that the curve may have crossed, so that a trajectory can be traced piece by piece.
///
/// Light that leaves a face begins *on* it, and rounding would decide the side of the first point. A listed surface is not crossed as
/// long as the curve stays within delta of it from its beginning; a curve that leaves this zone on the side opposite to the listed
/// one crosses the surface at once. Listed sides of surfaces on which the curve does not begin are ignored.
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
/// As for [`trace_curve`]; `sides` is then unchanged.
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

/// The outward unit normal at a crossing: against the curve where it enters a region, along it where it leaves for the world. Equals
/// [`attributes::normal`] on the tangent of the curve.
pub fn curve_normal(program: &Program, curve: &dyn Curve<3>, crossing: &Crossing) -> Point<3> {
    let velocity = Vec3::from_array(curve.velocity(crossing.t));
    // a curve at rest has no tangent: the normal is that of the face
    let direction = if velocity == Vec3::ZERO { Vec3::X } else { velocity };
    let tangent = Ray::new(Vec3::from_array(curve.position(crossing.t)), direction);
    attributes::normal(program, &tangent, &Crossing { t: 0.0, ..*crossing }).to_array()
}

/// Traversal state of one group: the boundary events of its leaves so far.
struct Frame<'a> {
    program: &'a Program,
    prototype: &'a Prototype,
    view: View<'a>,
    /// The leaf of the enclosing group that this group represents.
    parent_leaf: u32,
    /// The box outside of which each leaf has no effect.
    matters: Vec<Bounds>,
    next: u32,
    /// The isolated sign changes, by surface.
    known: BTreeMap<u32, RootRay>,
    state: NetworkState,
    events: Vec<Event>,
    leaf_events: LeafEvents,
}

impl<'a> Frame<'a> {
    fn new(program: &'a Program, id: PrototypeId, view: View<'a>, parent_leaf: u32) -> Frame<'a> {
        let prototype = program.prototype(id);
        Frame {
            program,
            prototype,
            view,
            parent_leaf,
            matters: program.matters(prototype),
            next: 0,
            known: BTreeMap::new(),
            state: prototype.network.start(),
            events: Vec::new(),
            leaf_events: LeafEvents::default(),
        }
    }

    /// The next leaf that the curve may cross.
    fn next_leaf(&mut self, boxes: &Boxes) -> Option<u32> {
        let leaves = &self.prototype.leaves;
        while self.next < leaves.end - leaves.start {
            let leaf = self.next;
            self.next += 1;
            let condition = self.prototype.condition;
            if boxes.may_cross(&self.matters[leaf as usize], condition, &self.view) {
                return Some(leaf);
            }
        }
        None
    }

    /// Adds the boundary events of a shape; returns the frame of a placed solid, which is traversed first.
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
        query: ((f64, f64), &[Start]),
    ) -> Result<(), CurveError> {
        let table = &self.program.facets()[facets.start as usize..facets.end as usize];
        for facet in table {
            self.isolate(facet.surface(), query)?;
        }
        let known = &self.known;
        self.leaf_events.conjunction(table.len(), |k, emit| {
            let ray = known.get(&table[k].surface().0);
            ray.into_iter().flat_map(RootRay::times).for_each(emit);
            ray.is_some_and(|ray| ray.start().is_inside()) == table[k].inside()
        });
        let placement = self.view.placement;
        self.events.extend(self.leaf_events.list.iter().map(|&(t, facet)| {
            let surface = table[facet as usize].surface();
            Event { t, leaf, face: Face { leaf: id, facet, surface, placement } }
        }));
        self.start_at(leaf, self.leaf_events.starts_inside);
        Ok(())
    }

    /// Isolates a surface, unless another leaf has done so.
    fn isolate(
        &mut self,
        surface: SurfaceId,
        (window, sides): ((f64, f64), &[Start]),
    ) -> Result<(), CurveError> {
        if let Entry::Vacant(vacant) = self.known.entry(surface.0) {
            let (entry, placement) = (self.program.surface(surface), self.view.placement);
            let found = self.view.isolate(entry, window)?;
            let start = sides.iter().find(|s| s.surface == surface && s.placement == placement);
            vacant.insert(match start {
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
            self.prototype.network.toggle(&mut self.state, leaf);
        }
    }

    /// Adds the placed solid as a leaf to the enclosing group.
    fn into_leaf(mut self, outer: &mut Frame<'a>) {
        let leaf = self.parent_leaf;
        let mut inside = self.state.output(0);
        outer.start_at(leaf, inside);
        let mut sweep = Sweep::new(&self.prototype.network, &mut self.state, &self.events, f64::INFINITY);
        let events = std::iter::from_fn(|| sweep.next_event(&mut inside));
        outer.events.extend(events.map(|(t, face)| Event { t, leaf, face }));
    }

    /// The crossings of the model itself.
    fn into_trace(mut self, curve: &'a dyn Curve<3>) -> CurveTrace {
        let program = self.program;
        let state = |owner: u32| {
            let region = RegionId(owner);
            State { region, medium: program.medium_of(region) }
        };
        let mut sweep = Sweep::new(&self.prototype.network, &mut self.state, &self.events, f64::INFINITY);
        let mut now = state(sweep.leaves.owner());
        let mut trace = CurveTrace { start: now.region, crossings: Vec::new() };
        let mut weld = Weld::new(program, Along(curve), &self.events);
        while let Some(change) = sweep.next_change(&mut now, state) {
            trace.crossings.extend(weld.change(change, &mut sweep.leaves));
        }
        trace.crossings.extend(weld.finish(sweep.position(), &mut sweep.leaves));
        trace
    }
}

/// A curve, for the weld.
struct Along<'a>(&'a dyn Curve<3>);

impl Trajectory for Along<'_> {
    fn coincides_along(&self, program: &Program, face: Face, a: f64, b: f64) -> bool {
        let steps = program.descend(face.placement);
        let view = steps.fold(View::world(self.0), |view, place| view.placed(&place, 0));
        // isolation has rejected curves that violate their contract; a new violation counts as no coincidence
        view.coincides_along(program.surface(face.surface), a, b).unwrap_or(false)
    }
}
