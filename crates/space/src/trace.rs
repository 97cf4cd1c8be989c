//! Tracing of lines and curves through solids in R^d.

use crate::curve::Line;
use crate::error::{SpaceError, check};
use crate::isolate::{check_window, coincides_along, isolate};
use crate::point::{dot, length, minus};
use crate::program::{FaceEntry, Program};
use crate::vector::{largest, times};
use crate::{Curve, Field, Point, Solid};
use rayweave_model::gate::{Network, NetworkState};
use rayweave_model::weld::{LeafStates, Trajectory, Weld};
use rayweave_model::{Crossing, Event, LeafId, PlacementId, RegionId, State, SurfaceId};
use rayweave_rootray::{Root, RootRay, Side};
use std::sync::{Arc, LazyLock};

/// The face that a root crosses, with point and normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face<const D: usize> {
    /// The index of the leaf in the order of declaration: see [`Program::leaf_name`].
    pub leaf: u32,
    /// The index of the face within the leaf, from 0: `lo`, then `hi` for a slab; those of its slabs for a box.
    pub face: u32,
    /// The point of the crossing.
    pub point: Point<D>,
    /// The outward unit normal of the traced solid: against the trajectory where it enters.
    pub normal: Point<D>,
}

/// The root-ray of the line through two points, with t = 0 at p and t = 1 at q, over all t.
///
/// For many lines through one solid, [`Tracer`] reuses memory.
///
/// ```
/// use rayweave_space::{Solid, trace};
///
/// // a ring in the plane, below the diagonal
/// let ring = Solid::<2>::ball(2.0)? - Solid::ball(1.0)?;
/// let half = ring - Solid::half_space_below([1.0, -1.0], 0.0)?;
/// let ray = trace([-3.0, 0.0], [-2.0, 0.0], &half)?;
/// assert_eq!(ray.to_string(), "outside [4, 5]");
/// let first = &ray.roots()[0].surface;
/// assert_eq!((first.leaf, first.point, first.normal), (1, [1.0, 0.0], [-1.0, 0.0]));
/// # Ok::<(), rayweave_space::SpaceError>(())
/// ```
///
/// # Errors
/// `SamePoint` if p and q are equal; `NotFinite` or `Extreme` for an invalid coordinate; and those of
/// [`Solid::compile`].
pub fn trace<const D: usize>(
    p: Point<D>,
    q: Point<D>,
    solid: &Solid<D>,
) -> Result<RootRay<Face<D>>, SpaceError> {
    Tracer::new(solid)?.trace(p, q)
}

/// The root-ray of a curve strictly between two times: see [`Tracer::trace_curve`].
///
/// # Errors
/// Those of [`Tracer::trace_curve`], and those of [`Solid::compile`].
pub fn trace_along<const D: usize>(
    curve: &impl Curve<D>,
    t0: f64,
    t1: f64,
    solid: &Solid<D>,
) -> Result<RootRay<Face<D>>, SpaceError> {
    Tracer::new(solid)?.trace_curve(curve, t0, t1)
}

/// Tracer of lines and curves through one solid, with reusable memory; use one per thread.
#[derive(Clone, Debug)]
pub struct Tracer<const D: usize> {
    program: Arc<Program<D>>,
    sweep: Sweep,
}

impl<const D: usize> Tracer<D> {
    /// A tracer for a solid.
    ///
    /// # Errors
    /// Those of [`Solid::compile`].
    pub fn new(solid: &Solid<D>) -> Result<Self, SpaceError> {
        let program = solid.compile()?;
        let sweep = Sweep {
            state: program.network.start(),
            events: Vec::new(),
            crossings: Vec::new(),
            values: Vec::new(),
        };
        Ok(Tracer { program, sweep })
    }

    /// The compiled solid.
    pub fn program(&self) -> &Arc<Program<D>> {
        &self.program
    }

    /// See [`Program::contains`].
    ///
    /// # Errors
    /// `NotFinite` or `Extreme` for an invalid coordinate.
    pub fn contains(&mut self, point: Point<D>) -> Result<bool, SpaceError> {
        self.program.contains_by(point, &mut self.sweep.values)
    }

    /// See [`trace`].
    ///
    /// # Errors
    /// Those of [`trace`].
    pub fn trace(&mut self, p: Point<D>, q: Point<D>) -> Result<RootRay<Face<D>>, SpaceError> {
        let line = line_through(p, q)?;
        let chord = self.program.chord(&line);
        let path = OnLine { faces: &self.program.faces, line: &line };
        self.sweep.begin();
        for (k, entry) in self.program.faces.iter().enumerate() {
            let crossings = entry.crossings(&line, chord);
            crossings.times().iter().for_each(|&t| self.sweep.push(t, k));
            self.sweep.set(&self.program.network, k, crossings.starts_negative());
        }
        let start = self.sweep.finish(&self.program, path);
        self.with_attributes(start, &line)
    }

    /// The root-ray along a curve strictly between two times; the start side is that just after `t0`.
    ///
    /// # Errors
    /// `Curve`: the window is not finite, not increasing or outside the curve's domain, or a violation of the contract of
    /// [`Curve`] was detected.
    pub fn trace_curve(
        &mut self,
        curve: &impl Curve<D>,
        t0: f64,
        t1: f64,
    ) -> Result<RootRay<Face<D>>, SpaceError> {
        // isolation checks it too, but is not called for a solid without faces
        check_window(curve, t0, t1)?;
        let events: Result<Vec<RootRay>, _> =
            self.program.faces.iter().map(|entry| isolate(entry, curve, t0, t1)).collect();
        self.sweep.begin();
        for (k, events) in events?.iter().enumerate() {
            events.times().for_each(|t| self.sweep.push(t, k));
            self.sweep.set(&self.program.network, k, events.start().is_inside());
        }
        let path = OnCurve { faces: &self.program.faces, curve };
        let start = self.sweep.finish(&self.program, path);
        self.with_attributes(start, curve)
    }

    /// The root-ray with points and normals.
    fn with_attributes(&self, start: Side, curve: &impl Curve<D>) -> Result<RootRay<Face<D>>, SpaceError> {
        let crossings = self.sweep.crossings.iter();
        let roots = crossings.map(|crossing| Root::new(crossing.t, self.face(crossing, curve)));
        Ok(RootRay::new(start, roots.collect())?)
    }

    fn face(&self, crossing: &Crossing, curve: &impl Curve<D>) -> Face<D> {
        let number = crossing.face.surface.index();
        let FaceEntry { surface, leaf, .. } = &self.program.faces[number];
        let point = curve.position(crossing.t);
        let normal = oriented(
            &surface.value_and_gradient(&point).1,
            &curve.velocity(crossing.t),
            crossing.before == RegionId(0),
        );
        let face = number as u32 - self.program.leaves[*leaf as usize].first_face;
        Face { leaf: *leaf, face, point, normal }
    }
}

/// The unit normal along a gradient, oriented against the velocity on entry, along it on exit. If the gradient is zero (at the apex of
/// a cone), the direction of the velocity, so that the normal is never NaN.
fn oriented<const D: usize>(gradient: &Point<D>, velocity: &Point<D>, enters: bool) -> Point<D> {
    let sign = if enters { -1.0 } else { 1.0 };
    let along = if length(gradient) > 0.0 { gradient } else { velocity };
    let (normal, _) = crate::vector::unit(along);
    let slope = dot(&normal, velocity);
    let oriented = if slope < 0.0 { -sign } else { sign };
    times(oriented, &normal)
}

/// The line through two points, with t = 0 at p and t = 1 at q.
fn line_through<const D: usize>(p: Point<D>, q: Point<D>) -> Result<Line<D>, SpaceError> {
    check::point("p", &p)?;
    check::point("q", &q)?;
    let direction = minus(&q, &p);
    if largest(&direction) > 0.0 { Ok(Line::new(p, direction)) } else { Err(SpaceError::SamePoint) }
}

/// A line with the faces of a program, for the weld.
struct OnLine<'a, const D: usize> {
    faces: &'a [FaceEntry<D>],
    line: &'a Line<D>,
}

impl<const D: usize> Trajectory for OnLine<'_, D> {
    fn coincides_along(
        &self,
        _: &rayweave_model::Program,
        face: rayweave_model::Face,
        a: f64,
        b: f64,
    ) -> bool {
        let entry = &self.faces[face.surface.index()];
        entry.surface.coincides_along(entry.magnitude, self.line, a, b)
    }
}

/// A curve with the faces of a program, for the weld.
struct OnCurve<'a, C, const D: usize> {
    faces: &'a [FaceEntry<D>],
    curve: &'a C,
}

impl<C: Curve<D>, const D: usize> Trajectory for OnCurve<'_, C, D> {
    fn coincides_along(
        &self,
        _: &rayweave_model::Program,
        face: rayweave_model::Face,
        a: f64,
        b: f64,
    ) -> bool {
        // a curve that violates its contract was rejected in isolation
        coincides_along(&self.faces[face.surface.index()], self.curve, a, b).unwrap_or(false)
    }
}

/// Sweep through the boundary events of all faces along a trajectory: the network processes them, and the weld merges crossings that
/// differ only by rounding.
#[derive(Clone, Debug)]
struct Sweep {
    /// All outside between sweeps.
    state: NetworkState,
    events: Vec<Event>,
    crossings: Vec<Crossing>,
    /// The values of all nodes, for point queries.
    values: Vec<bool>,
}

/// A model with one region and one medium. The weld only uses the media of a model.
static ONE_MEDIUM: LazyLock<rayweave_model::Program> = LazyLock::new(|| {
    rayweave_model::Program::compile(&rayweave_model::Solid::empty()).expect("empty compiles")
});

impl Sweep {
    fn begin(&mut self) {
        self.events.clear();
    }

    /// Adds a boundary event of a face at `t`.
    fn push(&mut self, t: f64, face: usize) {
        let named = rayweave_model::Face {
            leaf: LeafId::from(face),
            facet: 0,
            surface: SurfaceId::from(face),
            placement: PlacementId(0),
        };
        self.events.push(Event { t, leaf: face as u32, face: named });
    }

    /// Sets the start side of a face.
    fn set(&mut self, network: &Network, face: usize, inside: bool) {
        if inside {
            network.toggle(&mut self.state, face as u32);
        }
    }

    /// Computes the crossings from the boundary events; returns the start side.
    fn finish<const D: usize>(&mut self, program: &Program<D>, path: impl Trajectory) -> Side {
        let Sweep { state, events, crossings, .. } = self;
        crossings.clear();
        events.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.leaf.cmp(&b.leaf)));
        let state_of = |owner| State { region: RegionId(owner), medium: owner };
        let mut sweep = rayweave_model::Sweep::new(&program.network, state, events, f64::INFINITY);
        let mut weld = Weld::new(&ONE_MEDIUM, path, events);
        let mut now = state_of(sweep.leaves.owner());
        let start = Side::from_inside(now.region != RegionId(0));
        while let Some(change) = sweep.next_change(&mut now, state_of) {
            crossings.extend(weld.change(change, &mut sweep.leaves));
        }
        crossings.extend(weld.finish(sweep.position(), &mut sweep.leaves));
        sweep.restore(0..program.faces.len() as u32);
        start
    }
}
