//! The [`Evaluator`] trait, which computes the crossings of rays, with its queries and answers.

use crate::{
    BadPoint, BadRay, BoxCells, CrossingColumns, FirstHits, HitArrayRows, LeafId, Medium, PixelRays,
    PlacementId, Program, RayBatch, Rays, RegionId, SurfaceId, columns::ColumnSink,
};
use rayweave_error::{Classified, ErrorKind};
use rayweave_math::Vec3;
use rayweave_shape::{Ray, RayError};
use std::num::NonZeroUsize;
use std::ops::Range;

/// The open interval `t_min < t < t_max` of a ray that a query covers. Both ends may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    t_min: f64,
    t_max: f64,
}

/// The reason why a window is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WindowError {
    /// A bound is NaN.
    #[error("the window has a bound that is NaN: t_min and t_max must be numbers or infinite.")]
    NotANumber,
    /// `t_min` is not less than `t_max`.
    #[error("the window is empty or reversed: t_min must be less than t_max. Are its ends swapped?")]
    Empty,
}

impl Classified for WindowError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Value
    }
}

impl Window {
    /// The whole line.
    pub const ALL: Window = Window { t_min: f64::NEG_INFINITY, t_max: f64::INFINITY };

    /// The times with `t_min < t < t_max`.
    ///
    /// # Errors
    /// [`WindowError`] if a bound is NaN or `t_min >= t_max`.
    pub fn new(t_min: f64, t_max: f64) -> Result<Window, WindowError> {
        match () {
            () if t_min.is_nan() || t_max.is_nan() => Err(WindowError::NotANumber),
            () if t_min >= t_max => Err(WindowError::Empty),
            () => Ok(Window { t_min, t_max }),
        }
    }

    /// The lower end.
    pub fn t_min(&self) -> f64 {
        self.t_min
    }

    /// The upper end.
    pub fn t_max(&self) -> f64 {
        self.t_max
    }
}

impl Default for Window {
    fn default() -> Self {
        Window::ALL
    }
}

/// The number of crossings per ray that a query returns.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Limit {
    /// All crossings.
    #[default]
    All,
    /// The first crossing, if there is one. An evaluator may stop as soon as it is certain.
    First,
}

/// A surface on which a ray starts, and the side of the ray just after t = 0.
///
/// A ray that leaves a surface by reflection or refraction starts *on* it. The caller states the surface and the
/// side, and the evaluator divides one root at t = 0 out of the surface's equation. The ray therefore needs no
/// offset and does not hit the surface again at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The surface.
    pub surface: SurfaceId,
    /// The placement that the surface belongs to.
    pub placement: PlacementId,
    /// True if the surface's function f is negative on the ray just after its start.
    pub inside: bool,
}

/// The start lists of a batch: those of ray i are `entries[first[i]..first[i + 1]]`.
#[derive(Clone, Copy, Debug)]
pub struct StartLists<'a> {
    /// First entry of each ray's list; the last element is the length of `entries`.
    pub first: &'a [u32],
    /// The lists, one after the other.
    pub entries: &'a [Start],
}

impl<'a> StartLists<'a> {
    /// The start list of ray `i`.
    pub fn of(&self, i: usize) -> &'a [Start] {
        &self.entries[self.first[i] as usize..self.first[i + 1] as usize]
    }

    /// The start lists of a range of the rays.
    pub fn slice(&self, range: Range<usize>) -> StartLists<'a> {
        StartLists { first: &self.first[range.start..=range.end], entries: self.entries }
    }
}

/// A query, the same for every ray of a batch.
#[derive(Clone, Copy, Debug, Default)]
pub struct Query<'a> {
    /// The interval of the rays that the query covers.
    pub window: Window,
    /// Whether to return all crossings or only the first.
    pub limit: Limit,
    /// The surfaces that the rays start on. A ray whose start list is not empty is traced for t >= 0 only.
    pub starts: Option<StartLists<'a>>,
}

impl<'a> Query<'a> {
    /// The same query for a range of the rays of its batch.
    pub fn slice(&self, range: Range<usize>) -> Query<'a> {
        Query { starts: self.starts.map(|starts| starts.slice(range)), ..*self }
    }
}

impl Query<'_> {
    /// True if a boundary event at `t` comes before the window. Such an event is no crossing and only changes
    /// the region in which the ray starts.
    ///
    /// For a ray with a start list and `t_min <= 0`, the window includes t = 0: the ray crosses a listed surface
    /// there if the stated side contradicts the direction of the ray. To exclude this crossing, set `t_min` to
    /// `f64::MIN_POSITIVE`.
    pub fn is_past(&self, t: f64, has_starts: bool) -> bool {
        if has_starts && self.window.t_min <= 0.0 { t < 0.0 } else { t <= self.window.t_min }
    }

    /// The query for the first crossing after t = 0.
    pub fn nearest() -> Query<'static> {
        Query { window: Window { t_min: 0.0, t_max: f64::INFINITY }, limit: Limit::First, starts: None }
    }
}

/// A facet of a leaf, at one placement in the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Face {
    /// The leaf.
    pub leaf: LeafId,
    /// The facet's number within its leaf.
    pub facet: u32,
    /// The surface that contains the face.
    pub surface: SurfaceId,
    /// The placement of the leaf.
    pub placement: PlacementId,
}

/// A change of region along a ray, with a change of medium: where two regions of one medium touch, there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The time, in units of the length of the ray's direction.
    pub t: f64,
    /// The face that the crossing belongs to.
    pub face: Face,
    /// The face at which the ray leaves the region before; equal to `face` if the region on either side is the world.
    pub left: Face,
    /// The face at which the ray enters the region after; equal to `face` if the region on either side is the world.
    pub entered: Face,
    /// The region before; 0 is the world.
    pub before: RegionId,
    /// The region after.
    pub after: RegionId,
}

impl Crossing {
    /// True if the ray enters a region, false if it leaves into the world.
    pub fn enters(&self) -> bool {
        self.after != RegionId(0)
    }

    /// True if `left` or `entered` differs from `face`.
    pub fn is_between(&self) -> bool {
        self.left != self.face || self.entered != self.face
    }
}

/// The crossings of one ray within the window: all, or the first one, as the query's [`Limit`] states.
#[derive(Clone, Copy, Debug)]
pub struct RayAnswer<'a> {
    /// The number of the ray in its batch.
    pub ray: usize,
    /// The region just after `t_min`; 0 is the world.
    pub start: RegionId,
    /// The crossings in order of time.
    pub crossings: &'a [Crossing],
}

/// Receives the answers, ray by ray in the order of the batch.
pub trait Sink {
    /// Receives the answer for one ray.
    fn ray(&mut self, answer: RayAnswer<'_>);
}

impl<F: FnMut(RayAnswer<'_>)> Sink for F {
    fn ray(&mut self, answer: RayAnswer<'_>) {
        self(answer);
    }
}

/// The answers for a batch in arrays: the crossings of ray i are `crossings[offsets[i]..offsets[i + 1]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Collected {
    /// The region of each ray just after `t_min`.
    pub starts: Vec<RegionId>,
    /// The index of each ray's first crossing; the last element is the total number of crossings.
    pub offsets: Vec<usize>,
    /// The crossings, sorted by ray, then t.
    pub crossings: Vec<Crossing>,
}

impl Default for Collected {
    fn default() -> Self {
        Collected { starts: Vec::new(), offsets: vec![0], crossings: Vec::new() }
    }
}

impl Collected {
    /// The crossings of ray `i`.
    pub fn of(&self, i: usize) -> &[Crossing] {
        &self.crossings[self.offsets[i]..self.offsets[i + 1]]
    }

    /// The number of rays.
    pub fn len(&self) -> usize {
        self.starts.len()
    }

    /// True if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// Appends the answers for another batch.
    pub fn append(&mut self, other: &Collected) {
        let before = self.crossings.len();
        self.starts.extend_from_slice(&other.starts);
        self.crossings.extend_from_slice(&other.crossings);
        self.offsets.extend(other.offsets[1..].iter().map(|end| end + before));
    }
}

impl Sink for Collected {
    fn ray(&mut self, answer: RayAnswer<'_>) {
        self.starts.push(answer.start);
        self.crossings.extend_from_slice(answer.crossings);
        self.offsets.push(self.crossings.len());
    }
}

/// An algorithm that answers ray queries on a compiled model.
///
/// Every evaluator returns the same answer to the same query, bit for bit, because all evaluators share the code for
/// the roots of leaves and for welding crossings, and their boolean algebra is exact. An evaluator is immutable; its
/// working memory is a scratch, one per thread, which the caller owns.
pub trait Evaluator: Sync {
    /// The working memory of one thread.
    type Scratch: Send;

    /// The name of the evaluator.
    fn name(&self) -> &'static str;

    /// The model.
    fn program(&self) -> &Program;

    /// Creates working memory for one thread.
    fn scratch(&self) -> Self::Scratch;

    /// The number of rays per batch with which the evaluator is fastest; `None` if batches of a few hundred rays are, whose
    /// answers fit into a processor's cache. The number never affects the answers.
    fn preferred_batch(&self) -> Option<NonZeroUsize> {
        None
    }

    /// Passes the crossings of every ray of a batch to the sink.
    ///
    /// Rays must pass [`Program::check_rays`], which the caller runs once per batch. The answer for a ray that does not
    /// pass is arbitrary, usually a miss; the call does not panic.
    fn crossings(&self, rays: Rays<'_>, query: &Query<'_>, scratch: &mut Self::Scratch, sink: &mut dyn Sink);

    /// Computes the region that contains each point; 0 is the world. For a point on a boundary, the symbolic
    /// perturbation decides.
    ///
    /// Points must pass [`Program::check_points`], which the caller runs once per batch. The answer for a point that does not
    /// pass is arbitrary, usually the world; the call does not panic.
    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut Self::Scratch, out: &mut [RegionId]);

    /// Appends the crossings of every ray of a batch to columns: [`Evaluator::crossings`] without a call per
    /// ray. The rows do not depend on the size of the batches, bit for bit. No memory is allocated once the
    /// columns have grown.
    fn columns(
        &self,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut Self::Scratch,
        columns: &mut CrossingColumns,
    ) {
        let mut sink = ColumnSink { program: self.program(), columns };
        self.crossings(rays, query, scratch, &mut sink);
    }

    /// Fills the hit array of a batch and returns the greatest number of entries of any ray. If it exceeds
    /// the number of rows, the surplus entries are not written; call again with more rows.
    fn hits(
        &self,
        rays: Rays<'_>,
        window: Window,
        scratch: &mut Self::Scratch,
        rows: &mut HitArrayRows<'_, '_>,
    ) -> usize {
        let (program, mut most) = (self.program(), 0);
        let mut sink = |answer: RayAnswer<'_>| most = most.max(rows.put(program, &answer));
        self.crossings(rays, &Query { window, ..Query::default() }, scratch, &mut sink);
        most
    }

    /// Finds the first crossing of every ray of a batch in the window.
    fn nearest(&self, rays: Rays<'_>, window: Window, scratch: &mut Self::Scratch, hits: &mut FirstHits<'_>) {
        let query = Query { window, limit: Limit::First, starts: None };
        self.nearest_from(rays, &query, scratch, hits, &mut Vec::new());
    }

    /// Finds the first crossing of every ray through some pixels, like [`Evaluator::nearest`]. `rays` has the same rays as arrays,
    /// for evaluators that do not compute them.
    fn nearest_through(
        &self,
        (_, rays): (&PixelRays<'_>, Rays<'_>),
        window: Window,
        scratch: &mut Self::Scratch,
        hits: &mut FirstHits<'_>,
    ) {
        self.nearest(rays, window, scratch, hits);
    }

    /// Finds the first crossing of every ray of a batch, like [`Evaluator::nearest`], for rays that may start on
    /// surfaces; the limit of the query is ignored. Crossings with more than one face ([`Crossing::is_between`]) are
    /// also appended to `between`, each with the number of its ray, in any order.
    fn nearest_from(
        &self,
        rays: Rays<'_>,
        query: &Query<'_>,
        scratch: &mut Self::Scratch,
        hits: &mut FirstHits<'_>,
        between: &mut Vec<(usize, Crossing)>,
    ) {
        let program = self.program();
        let query = Query { limit: Limit::First, ..*query };
        self.crossings(rays, &query, scratch, &mut |answer: RayAnswer<'_>| {
            hits.put(program, &rays, &answer);
            let found = answer.crossings.first().filter(|crossing| crossing.is_between());
            between.extend(found.map(|crossing| (answer.ray, *crossing)));
        });
    }

    /// [`Evaluator::nearest_from`] for rays whose regions are probably known: `regions` has the number of the region in which
    /// each ray starts, or any other number, such as `u32::MAX`, where it is not known. The numbers save time and do not change
    /// the answers.
    fn nearest_in(
        &self,
        rays: Rays<'_>,
        (query, _regions): (&Query<'_>, &[u32]),
        scratch: &mut Self::Scratch,
        hits: &mut FirstHits<'_>,
        between: &mut Vec<(usize, Crossing)>,
    ) {
        self.nearest_from(rays, query, scratch, hits, between);
    }

    /// The cells of the model that are boxes, for callers that compute crossings in them; `None` if the evaluator does not know
    /// them.
    fn box_cells(&self) -> Option<&BoxCells> {
        None
    }

    /// The answers for a whole batch in arrays.
    ///
    /// # Errors
    /// [`BadRay`] for the first ray that does not pass [`Program::check_rays`].
    fn collect(&self, rays: Rays<'_>, query: &Query<'_>) -> Result<Collected, BadRay> {
        self.program().check_rays(rays)?;
        let mut collected = Collected::default();
        self.crossings(rays, query, &mut self.scratch(), &mut collected);
        Ok(collected)
    }

    /// The crossings of one ray. For more than a few rays, a batch is faster.
    ///
    /// # Errors
    /// [`RayError`] if the ray does not pass [`Program::check_ray`].
    fn one(&self, ray: Ray, query: &Query<'_>) -> Result<Collected, RayError> {
        self.collect(RayBatch::from_iter([ray]).rays(), query).map_err(|bad| bad.problem)
    }

    /// True if the point is inside any region: see [`Evaluator::regions_at`]. For more than a few points, a batch is faster.
    ///
    /// # Errors
    /// [`BadPoint`] if a coordinate is not finite.
    fn contains(&self, point: Vec3) -> Result<bool, BadPoint> {
        let (points, mut region) = ([[point.x], [point.y], [point.z]], [RegionId(0)]);
        let points = points.each_ref().map(|coordinate| &coordinate[..]);
        self.program().check_points(points)?;
        self.regions_at(points, &mut self.scratch(), &mut region);
        Ok(region[0] != RegionId(0))
    }
}

/// The state of a model between two crossings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    /// The region that owns the points of the span.
    pub region: RegionId,
    /// Its medium.
    pub medium: Medium,
}
