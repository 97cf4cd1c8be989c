//! The trait between the two sides of the house: rays and questions in, crossings out.

use crate::{
    BadRay, CrossingColumns, FirstHits, HitRows, LeafId, Medium, PlacementId, Program, RayBatch, Rays,
    RegionId, SurfaceId, columns::ColumnSink,
};
use rayweave_error::{Classified, ErrorKind};
use rayweave_math::Vec3;
use rayweave_shape::{Ray, RayError};
use std::ops::Range;

/// The part of a ray that is asked about: strictly between `t_min` and `t_max`, which may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    t_min: f64,
    t_max: f64,
}

/// Why a window cannot be asked about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum WindowError {
    /// A bound is NaN.
    #[error("the window has a bound that is NaN: nothing lies before or after it.")]
    NotANumber,
    /// The window holds no time.
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

/// How many crossings of each ray are wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Limit {
    /// All of them.
    #[default]
    All,
    /// The first one, if there is one: an evaluator may stop as soon as it is certain.
    First,
}

/// A surface on which a ray starts, and its side there just after t = 0.
///
/// A ray that leaves a surface by reflection or refraction starts *on* it: one root at t = 0 is divided out
/// of the surface's equation, and the side is what the caller says, so that no offset is needed and nothing
/// is hit twice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The surface.
    pub surface: SurfaceId,
    /// The placement that it belongs to.
    pub placement: PlacementId,
    /// True if the ray is where f < 0 just after its start.
    pub inside: bool,
}

/// The start lists of a batch: those of ray i are `entries[first[i]..first[i + 1]]`.
#[derive(Clone, Copy, Debug)]
pub struct StartLists<'a> {
    /// Where each ray's list begins, and the length of `entries` at the end.
    pub first: &'a [u32],
    /// The lists, one after the other.
    pub entries: &'a [Start],
}

impl<'a> StartLists<'a> {
    /// The list of ray `i`.
    pub fn of(&self, i: usize) -> &'a [Start] {
        &self.entries[self.first[i] as usize..self.first[i + 1] as usize]
    }

    /// The lists of a range of the rays.
    pub fn slice(&self, range: Range<usize>) -> StartLists<'a> {
        StartLists { first: &self.first[range.start..=range.end], entries: self.entries }
    }
}

/// What is asked of every ray of a batch.
#[derive(Clone, Copy, Debug, Default)]
pub struct Query<'a> {
    /// The part of the rays that is asked about.
    pub window: Window,
    /// How many crossings are wanted.
    pub limit: Limit,
    /// Surfaces that the rays start on; such rays are asked about times t >= 0 only.
    pub starts: Option<StartLists<'a>>,
}

impl<'a> Query<'a> {
    /// The same query about a range of the rays of its batch.
    pub fn slice(&self, range: Range<usize>) -> Query<'a> {
        Query { starts: self.starts.map(|starts| starts.slice(range)), ..*self }
    }
}

impl Query<'_> {
    /// True if a flip at `t` has happened before the part of a ray that is asked about, so that it only
    /// moves the side at which the ray starts.
    ///
    /// A ray with a start list is asked about from t = 0 on, that time included: there a listed surface is
    /// crossed whose side and direction disagree. (To go on after it, ask for t_min = `f64::MIN_POSITIVE`.)
    pub fn is_past(&self, t: f64, has_starts: bool) -> bool {
        if has_starts && self.window.t_min <= 0.0 { t < 0.0 } else { t <= self.window.t_min }
    }

    /// The first crossing after t = 0.
    pub fn nearest() -> Query<'static> {
        Query { window: Window { t_min: 0.0, t_max: f64::INFINITY }, limit: Limit::First, starts: None }
    }
}

/// A face of a leaf, somewhere in a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Face {
    /// The leaf.
    pub leaf: LeafId,
    /// The face's number among those of its leaf.
    pub facet: u32,
    /// The surface that the face lies in.
    pub surface: SurfaceId,
    /// The placement of the leaf.
    pub placement: PlacementId,
}

/// A ray passes from one region into another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// When, in units of the ray's direction.
    pub t: f64,
    /// The face that the crossing belongs to.
    pub face: Face,
    /// The face of the region that is left; the same as `face` where one side is the world.
    pub left: Face,
    /// The face of the region that is entered; the same as `face` where one side is the world.
    pub entered: Face,
    /// The region before; 0 is the world.
    pub before: RegionId,
    /// The region after.
    pub after: RegionId,
}

impl Crossing {
    /// True if the ray enters a region, false if it leaves for the world.
    pub fn enters(&self) -> bool {
        self.after != RegionId(0)
    }

    /// True if the face of what is left or that of what is entered is another one than `face`.
    pub fn is_between(&self) -> bool {
        self.left != self.face || self.entered != self.face
    }
}

/// All that is found on one ray.
#[derive(Clone, Copy, Debug)]
pub struct RayAnswer<'a> {
    /// The number of the ray in its batch.
    pub ray: usize,
    /// The region just after `t_min`; 0 is the world.
    pub start: RegionId,
    /// The crossings in order of time.
    pub crossings: &'a [Crossing],
}

/// Takes the answers, ray by ray in the order of the batch.
pub trait Sink {
    /// Takes the answer for one ray.
    fn ray(&mut self, answer: RayAnswer<'_>);
}

impl<F: FnMut(RayAnswer<'_>)> Sink for F {
    fn ray(&mut self, answer: RayAnswer<'_>) {
        self(answer);
    }
}

/// Answers gathered in arrays: those of ray i are `crossings[offsets[i]..offsets[i + 1]]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Collected {
    /// The region of each ray just after `t_min`.
    pub starts: Vec<RegionId>,
    /// Where each ray's crossings begin, and their total at the end.
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

    /// True if no ray was answered.
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// Appends the answers for the rays that follow.
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

/// Answers questions about a compiled model along rays.
///
/// Every evaluator gives the same answer to the same question, bit for bit: they share the roots of the
/// leaves, exact algebra, and one weld. An evaluator has no state of its own that changes; what it needs
/// while it works is in a scratch, one per thread, that the caller owns.
pub trait Evaluator: Sync {
    /// The memory that a thread needs.
    type Scratch: Send;

    /// What the evaluator is called.
    fn name(&self) -> &'static str;

    /// The model.
    fn program(&self) -> &Program;

    /// Memory for one thread.
    fn scratch(&self) -> Self::Scratch;

    /// The crossings of every ray of a batch, into the sink.
    ///
    /// The rays are those that pass [`Rays::check`]: it is made once, where rays come in. One that does not may be
    /// answered by anything, a miss most often, but by no panic.
    fn crossings(&self, rays: Rays<'_>, query: &Query<'_>, scratch: &mut Self::Scratch, sink: &mut dyn Sink);

    /// The region that each point is in; 0 is the world. On a boundary: the side of a ray that lies in it.
    fn regions_at(&self, points: [&[f64]; 3], scratch: &mut Self::Scratch, out: &mut [RegionId]);

    /// Appends the crossings of every ray of a batch to columns: [`Evaluator::crossings`] without a call per ray. The rows are
    /// the same, to the bit, whatever the size of the batches; with columns that have grown already nothing is allocated.
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

    /// The hit array of a batch; the greatest number of entries that a ray has. If that is more than there are rows,
    /// the entries for which there is no row are left out: ask again with more rows.
    fn hits(
        &self,
        rays: Rays<'_>,
        window: Window,
        scratch: &mut Self::Scratch,
        rows: &mut HitRows<'_, '_>,
    ) -> usize {
        let (program, mut most) = (self.program(), 0);
        let mut sink = |answer: RayAnswer<'_>| most = most.max(rows.put(program, &answer));
        self.crossings(rays, &Query { window, ..Query::default() }, scratch, &mut sink);
        most
    }

    /// What every ray of a batch meets first in the window.
    fn nearest(&self, rays: Rays<'_>, window: Window, scratch: &mut Self::Scratch, hits: &mut FirstHits<'_>) {
        let query = Query { window, limit: Limit::First, starts: None };
        self.nearest_from(rays, &query, scratch, hits, &mut Vec::new());
    }

    /// What every ray of a batch meets first: [`Evaluator::nearest`] for rays that may start on surfaces, whatever the
    /// limit of the query. Crossings that belong to other faces on their two sides than `hits` names
    /// ([`Crossing::is_between`]) are appended to `between` as well, each with the number of its ray, in any order.
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

    /// The answers for a whole batch in arrays.
    ///
    /// # Errors
    /// [`BadRay`] for the first ray that does not pass [`Ray::check`].
    fn collect(&self, rays: Rays<'_>, query: &Query<'_>) -> Result<Collected, BadRay> {
        rays.check()?;
        let mut collected = Collected::default();
        self.crossings(rays, query, &mut self.scratch(), &mut collected);
        Ok(collected)
    }

    /// The crossings of one ray; for more than a few rays ask for batches.
    ///
    /// # Errors
    /// [`RayError`] if the ray does not pass [`Ray::check`].
    fn one(&self, ray: Ray, query: &Query<'_>) -> Result<Collected, RayError> {
        self.collect(RayBatch::from_iter([ray]).rays(), query).map_err(|bad| bad.problem)
    }

    /// True where the one point given is inside some region.
    fn contains(&self, point: Vec3) -> bool {
        let mut region = [RegionId(0)];
        self.regions_at([&[point.x], &[point.y], &[point.z]], &mut self.scratch(), &mut region);
        region[0] != RegionId(0)
    }
}

/// The state of a model between two crossings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    /// The region that wins.
    pub region: RegionId,
    /// Its medium.
    pub medium: Medium,
}
