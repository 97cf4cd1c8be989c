//! From the pieces in order of time to the crossings.

use crate::isolate::path::{Path, Piece, Sample};
use crate::{Curve, CurveError, Field};
use rayweave_rootray::{Root, RootRay, Side};

/// What is known up to the piece that comes next.
pub struct Walk<'a, const D: usize, F: ?Sized, C: ?Sized> {
    path: &'a Path<'a, D, F, C>,
    /// The side at the beginning of the window and now, once it is known.
    start: Option<bool>,
    now: Option<bool>,
    /// The stretch that hugs the surface up to now.
    hugging: Option<(Sample<D>, Sample<D>)>,
    roots: Vec<Root>,
    window: (f64, f64),
}

impl<'a, const D: usize, F: Field<D> + ?Sized, C: Curve<D> + ?Sized> Walk<'a, D, F, C> {
    pub fn new(path: &'a Path<'a, D, F, C>, window: (f64, f64)) -> Self {
        Walk { path, start: None, now: None, hugging: None, roots: Vec::new(), window }
    }

    /// The next piece hugs the surface.
    pub fn hug(&mut self, piece: &Piece<D>) {
        let from = self.hugging.map_or(piece.a, |stretch| stretch.0);
        self.hugging = Some((from, piece.b));
    }

    /// The next piece has these sides at its ends, and at most one crossing.
    pub fn go_on(&mut self, piece: &Piece<D>, before: bool, after: bool) -> Result<(), CurveError> {
        let hugging = self.hugging.take();
        match self.now {
            None => self.start = Some(before),
            Some(now) if now != before => {
                // without a stretch to look for it in, two pieces differ about a value that is lost in rounding
                let t = match hugging {
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

    /// The crossings, once there are no more pieces; `in_surface` gives the side of a curve that hugs all over.
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
        // finite, so there is nothing to refuse
        Ok(RootRay::from_flips(Side::from_inside(start), inner).unwrap_or_default())
    }

    fn cross(&mut self, t: f64) {
        self.roots.push(Root::new(t, ()));
    }

    /// Where the computed side changes between two samples, the first of which is on the side `inside`.
    ///
    /// Newton's steps, or the middle where they leave the bracket or hardly shorten it, and every eighth time; ends where
    /// a step is lost in the rounding of t, or no number is left between the ends.
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

/// Where the line through two values of opposite sign is 0.
fn secant<const D: usize>(a: &Sample<D>, b: &Sample<D>) -> Option<f64> {
    let t = a.t + (b.t - a.t) * (a.value / (a.value - b.value));
    (a.value * b.value < 0.0 && a.t < t && t < b.t).then_some(t)
}
