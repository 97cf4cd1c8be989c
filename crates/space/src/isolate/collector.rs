//! Collector of crossings from classified pieces in order of time.

use crate::isolate::path::{Composition, Piece, Sample};
use crate::{Curve, CurveError, Field};
use rayweave_rootray::{Root, RootRay, Side};

/// Collector of crossings; holds the state before the next piece.
pub struct Collector<'a, const D: usize, F: ?Sized, C: ?Sized> {
    path: &'a Composition<'a, D, F, C>,
    /// The side at the beginning of the window and the current side, once known.
    start: Option<bool>,
    now: Option<bool>,
    /// The current run of pieces that coincide with the surface.
    coinciding: Option<(Sample<D>, Sample<D>)>,
    roots: Vec<Root>,
    window: (f64, f64),
}

impl<'a, const D: usize, F: Field<D> + ?Sized, C: Curve<D> + ?Sized> Collector<'a, D, F, C> {
    pub fn new(path: &'a Composition<'a, D, F, C>, window: (f64, f64)) -> Self {
        Collector { path, start: None, now: None, coinciding: None, roots: Vec::new(), window }
    }

    /// Adds a piece that coincides with the surface.
    pub fn add_coinciding(&mut self, piece: &Piece<D>) {
        let from = self.coinciding.map_or(piece.a, |run| run.0);
        self.coinciding = Some((from, piece.b));
    }

    /// Adds a piece with these sides at its ends and at most one crossing.
    pub fn add(&mut self, piece: &Piece<D>, before: bool, after: bool) -> Result<(), CurveError> {
        let coinciding = self.coinciding.take();
        match self.now {
            None => self.start = Some(before),
            Some(now) if now != before => {
                // without a run of coinciding pieces, two pieces disagree about a value below rounding
                let t = match coinciding {
                    Some((a, b)) => self.crossing(a, b, now)?,
                    None => piece.a.t,
                };
                self.cross(t);
            }
            Some(_) => {}
        }
        self.now = Some(after);
        if before != after {
            let t = self.crossing(piece.a, piece.b, before)?;
            self.cross(t);
        }
        Ok(())
    }

    /// The crossings after the last piece; `in_surface` returns the side of a curve that coincides over the whole window.
    pub fn finish(
        self,
        in_surface: impl FnOnce() -> Result<bool, CurveError>,
    ) -> Result<RootRay, CurveError> {
        let mut start = match self.start {
            Some(start) => start,
            None => in_surface()?,
        };
        let (t0, t1) = self.window;
        start ^= self.roots.iter().filter(|root| root.t <= t0).count() % 2 == 1;
        let inner = self.roots.into_iter().filter(|root| t0 < root.t && root.t < t1).collect();
        // never fails: the times are finite
        Ok(RootRay::from_events(Side::from_inside(start), inner).unwrap_or_default())
    }

    fn cross(&mut self, t: f64) {
        self.roots.push(Root::new(t, ()));
    }

    /// The time at which the computed side changes between two samples, the first of which is on the side `inside`.
    ///
    /// Newton's method safeguarded by bisection: a step that leaves the bracket or hardly shortens it, and every eighth step, is
    /// replaced by the middle. The search ends when a step is below the rounding of t, or no number is left between the ends.
    fn crossing(&self, a: Sample<D>, b: Sample<D>, inside: bool) -> Result<f64, CurveError> {
        let (mut lo, mut hi) = (a.t, b.t);
        let mut t = secant(&a, &b).unwrap_or(0.5 * lo + 0.5 * hi);
        let mut steps = 0;
        while lo < t && t < hi {
            steps += 1;
            let sample = self.path.sample(t)?;
            let step = sample.value / sample.slope;
            if sample.value == 0.0 || t - step == t {
                return Ok(t);
            }
            let width = hi - lo;
            if sample.inside() == inside {
                lo = t;
            } else {
                hi = t;
            }
            let next = t - step;
            let newton = lo < next && next < hi && step.abs() < 0.5 * width && steps % 8 != 0;
            t = if newton { next } else { 0.5 * lo + 0.5 * hi };
        }
        Ok(t)
    }
}

/// The root of the line through two values of opposite sign.
fn secant<const D: usize>(a: &Sample<D>, b: &Sample<D>) -> Option<f64> {
    let t = a.t + (b.t - a.t) * (a.value / (a.value - b.value));
    (a.value * b.value < 0.0 && a.t < t && t < b.t).then_some(t)
}
