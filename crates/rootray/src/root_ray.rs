//! Root-ray: the intervals of one trajectory that lie inside one solid, as a start side and sorted crossing times.

use std::fmt;

use crate::{Problem, RootRayError, Side, validate_times};

/// A time at which the trajectory crosses the boundary of the solid, and the surface that it crosses there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Root<S = ()> {
    /// The parameter of the trajectory at the crossing: finite.
    pub t: f64,
    /// The surface crossed, in the caller's own type; `()` if it is not needed.
    pub surface: S,
}

impl<S> Root<S> {
    /// A crossing of `surface` at time `t`.
    pub const fn new(t: f64, surface: S) -> Self {
        Self { t, surface }
    }
}

/// The side on which a trajectory starts (as t -> -inf) and the times at which it changes sides.
///
/// Times are finite and strictly increasing, so the side after k roots is the start side inverted k times, and an
/// infinity is never stored. A root at `-0.0` is stored as `0.0`: equal times have equal bits.
///
/// The boolean operations are *exact*: the state is a function on the open intervals between distinct times, all roots
/// with the same time toggle together, and a time is a crossing if the states on its two sides differ. So the laws of boolean
/// algebra hold bit for bit. No operation compares times with a tolerance; only the final [`weld`](Self::weld) does.
#[derive(Clone, Debug, PartialEq)]
pub struct RootRay<S = ()> {
    start: Side,
    roots: Vec<Root<S>>,
}

impl<S> RootRay<S> {
    /// The root-ray with these roots: finite, strictly increasing times.
    ///
    /// # Errors
    /// `Nan`, `Infinite` or `NotIncreasing` for the first bad root.
    pub fn new(start: Side, mut roots: Vec<Root<S>>) -> Result<Self, RootRayError> {
        let mut previous = f64::NEG_INFINITY;
        for (index, root) in roots.iter_mut().enumerate() {
            previous = checked(index, previous, root.t)?;
            root.t = previous;
        }
        Ok(Self { start, roots })
    }

    /// The root-ray that changes sides at every one of these times, given in any order: equal times cancel in pairs.
    ///
    /// Of an odd number of equal times the first one given is kept. O(n log n).
    ///
    /// # Errors
    /// `Nan` or `Infinite` for the first time that is not finite.
    pub fn from_events(start: Side, mut events: Vec<Root<S>>) -> Result<Self, RootRayError> {
        for (index, event) in events.iter_mut().enumerate() {
            event.t = finite(index, event.t)?;
        }
        events.sort_by(|a, b| a.t.total_cmp(&b.t));
        let keep: Vec<bool> = events.chunk_by(|a, b| a.t == b.t).flat_map(keep_first_of_odd).collect();
        let mut keep = keep.into_iter();
        events.retain(|_| keep.next() == Some(true));
        Ok(Self { start, roots: events })
    }

    /// A root-ray of roots that are already in order.
    pub(crate) fn from_ordered(start: Side, roots: Vec<Root<S>>) -> Self {
        debug_assert!(roots.windows(2).all(|pair| pair[0].t < pair[1].t));
        Self { start, roots }
    }

    /// The trajectory that is always outside: neutral for union, absorbing for intersection ("empty" in the publication).
    pub const fn empty() -> Self {
        Self { start: Side::Outside, roots: Vec::new() }
    }

    /// The trajectory that is always inside: neutral for intersection, absorbing for union ("universe" in the publication).
    pub const fn universe() -> Self {
        Self { start: Side::Inside, roots: Vec::new() }
    }

    /// The side as t -> -inf.
    pub const fn start(&self) -> Side {
        self.start
    }

    /// The side as t -> +inf.
    pub fn end(&self) -> Side {
        self.start.after(self.roots.len())
    }

    /// The crossings, in order of time.
    pub fn roots(&self) -> &[Root<S>] {
        &self.roots
    }

    /// The times of the crossings, in order.
    pub fn times(&self) -> impl ExactSizeIterator<Item = f64> + DoubleEndedIterator + '_ {
        self.roots.iter().map(|root| root.t)
    }

    /// The start side and the crossings, moved out.
    pub fn into_parts(self) -> (Side, Vec<Root<S>>) {
        (self.start, self.roots)
    }

    /// The crossings with the side that each leads to.
    pub fn crossings(&self) -> impl ExactSizeIterator<Item = (&Root<S>, Side)> + '_ {
        self.roots.iter().enumerate().map(|(k, root)| (root, self.start.after(k + 1)))
    }

    /// The side just after `t`, which may be infinite: the start side inverted once per root at or before `t`.
    ///
    /// # Errors
    /// `NanTime` if `t` is NaN.
    pub fn side_at(&self, t: f64) -> Result<Side, RootRayError> {
        if t.is_nan() {
            return Err(RootRayError::NanTime);
        }
        Ok(self.start.after(self.count_until(t)))
    }

    /// The number of roots at or before `t`.
    pub(crate) fn count_until(&self, t: f64) -> usize {
        self.roots.partition_point(|root| root.t <= t)
    }

    /// The open intervals `(a, b)` of times spent inside, in order; `a` may be -inf and `b` may be inf.
    pub fn spans(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let before = self.start.is_inside().then_some(f64::NEG_INFINITY);
        let after = self.end().is_inside().then_some(f64::INFINITY);
        let mut ends = before.into_iter().chain(self.times()).chain(after);
        std::iter::from_fn(move || Some((ends.next()?, ends.next()?)))
    }

    /// The same crossings with different names for the surfaces.
    pub fn map_surfaces<R>(self, mut rename: impl FnMut(S) -> R) -> RootRay<R> {
        let roots = self.roots.into_iter().map(|root| Root::new(root.t, rename(root.surface))).collect();
        RootRay { start: self.start, roots }
    }

    /// Questionable roots: neighbours closer than [`min_sep`](crate::min_sep). A root-ray holds finite increasing times only;
    /// for plain lists use [`validate_times`].
    pub fn validate(&self) -> Vec<Problem> {
        validate_times(self.times())
    }
}

impl RootRay<()> {
    /// The root-ray with these times, without surfaces.
    ///
    /// # Errors
    /// As [`RootRay::new`].
    pub fn from_times(start: Side, times: impl IntoIterator<Item = f64>) -> Result<Self, RootRayError> {
        Self::new(start, times.into_iter().map(|t| Root::new(t, ())).collect())
    }
}

impl<S> Default for RootRay<S> {
    fn default() -> Self {
        Self::empty()
    }
}

/// A short form for tests and messages: `outside [1, 4, 5, 10]`.
impl<S> fmt::Display for RootRay<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ", self.start)?;
        f.debug_list().entries(self.times().map(DisplayedTime)).finish()
    }
}

/// A time whose debug form is its shortest decimal form.
struct DisplayedTime(f64);

impl fmt::Debug for DisplayedTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// `t` with its zero made positive, if it may follow `previous` as root number `index`.
fn checked(index: usize, previous: f64, t: f64) -> Result<f64, RootRayError> {
    let t = finite(index, t)?;
    if t <= previous {
        return Err(RootRayError::NotIncreasing { index, previous, t });
    }
    Ok(t)
}

/// `t` with its zero made positive, if it is finite.
fn finite(index: usize, t: f64) -> Result<f64, RootRayError> {
    if t.is_nan() {
        return Err(RootRayError::Nan { index });
    }
    if t.is_infinite() {
        return Err(RootRayError::Infinite { index, t });
    }
    // IEEE 754: -0 + 0 = 0, and every other number is unchanged
    Ok(t + 0.0)
}

/// Keep flags of a group of equal times: the first stays if their number is odd, else none.
fn keep_first_of_odd<T>(group: &[T]) -> impl Iterator<Item = bool> + use<T> {
    let len = group.len();
    (0..len).map(move |k| k == 0 && len % 2 == 1)
}
