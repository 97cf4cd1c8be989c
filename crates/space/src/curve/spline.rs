//! Cubic splines: curves through given points with continuous second derivative.
//!
//! The slopes at the knots solve a tridiagonal, diagonally dominant system, for which elimination without pivoting is stable (C. de Boor, *A Practical Guide to Splines*, revised ed. (2001), chapter IV): with
//! `h_k = t_{k+1} - t_k` and `m_k = (y_{k+1} - y_k) / h_k`, continuity of r'' at knot k reads
//!
//! `s_{k-1} / h_{k-1} + 2 s_k (1 / h_{k-1} + 1 / h_k) + s_{k+1} / h_k = 3 (m_{k-1} / h_{k-1} + m_k / h_k)`.

use crate::curve::CONTRACT_TOLERANCE;
use crate::curve::vector::finite;
use crate::point::{add_scaled, is_finite, length, minus};
use crate::{Curve, CurveError, Point};

/// Boundary conditions of a spline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SplineEnds<const D: usize> {
    /// r'' = 0 at both ends.
    Natural,
    /// Given velocities at both ends.
    Clamped {
        /// r' at the first knot.
        first: Point<D>,
        /// r' at the last knot.
        last: Point<D>,
    },
    /// A closed curve: r' and r'' agree at the first and last knot. The points there must be equal.
    Periodic,
}

/// A cubic spline, defined between its first and last knot.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline<const D: usize> {
    knots: Vec<f64>,
    /// The coefficients of each piece in powers of `t - t_k`.
    pieces: Vec<[Point<D>; 4]>,
}

impl<const D: usize> Spline<D> {
    /// The spline through `points[k]` at time `knots[k]`, for at least two strictly increasing knots.
    ///
    /// # Errors
    /// The lists differ in length, there are fewer than two knots, a knot or point is not finite, knots are not increasing, or the last
    /// point of a periodic spline is not its first.
    pub fn new(knots: &[f64], points: &[Point<D>], ends: SplineEnds<D>) -> Result<Spline<D>, CurveError> {
        check_knots(knots, points.len())?;
        if let Some(index) = points.iter().position(|point| !is_finite(point)) {
            return Err(CurveError::InvalidKnot { what: "points", index, why: NOT_FINITE });
        }
        match &ends {
            SplineEnds::Clamped { first, last } => finite("first", first).and(finite("last", last))?,
            SplineEnds::Periodic if points.first() != points.last() => {
                let why = "the last point of a periodic spline must be the first one";
                return Err(CurveError::InvalidKnot { what: "points", index: points.len() - 1, why });
            }
            _ => {}
        }
        let slopes = slopes(knots, points, &ends);
        let pieces: Vec<_> = (0..knots.len() - 1).map(|k| piece(knots, points, &slopes, k)).collect();
        if let Some(index) = pieces.iter().position(|piece| !piece.iter().all(is_finite)) {
            let why = "the spline overflows there, because two knots are too close";
            return Err(CurveError::InvalidKnot { what: "knots", index, why });
        }
        Ok(Spline { knots: knots.to_vec(), pieces })
    }

    /// The piecewise cubic `c[0] + c[1] s + c[2] s^2 + c[3] s^3` with `s = t - knots[k]` and `c = pieces[k]` between knots k and k + 1.
    /// Positions and velocities must be continuous at the knots; second derivatives may jump.
    ///
    /// # Errors
    /// The number of pieces is not one less than that of knots, a knot or piece is not finite, knots are not increasing, or the curve is
    /// not continuous.
    pub fn from_pieces(knots: &[f64], pieces: &[[Point<D>; 4]]) -> Result<Spline<D>, CurveError> {
        check_knots(knots, pieces.len() + 1)?;
        if let Some(index) = pieces.iter().position(|piece| !piece.iter().all(is_finite)) {
            return Err(CurveError::InvalidKnot { what: "pieces", index, why: NOT_FINITE });
        }
        let spline = Spline { knots: knots.to_vec(), pieces: pieces.to_vec() };
        match (1..pieces.len()).find(|&k| !spline.fits(k)) {
            None => Ok(spline),
            Some(index) => {
                let why = "its position or velocity at its first knot differs from that at the end of the previous piece";
                Err(CurveError::InvalidKnot { what: "pieces", index, why })
            }
        }
    }

    /// The times of the knots.
    pub fn knots(&self) -> &[f64] {
        &self.knots
    }

    /// The coefficients of each piece.
    pub fn pieces(&self) -> &[[Point<D>; 4]] {
        &self.pieces
    }

    /// True if position and velocity are continuous between pieces k - 1 and k.
    fn fits(&self, k: usize) -> bool {
        let h = self.knots[k] - self.knots[k - 1];
        let [c0, c1, ..] = &self.pieces[k];
        let before = &self.pieces[k - 1];
        let (at, speed) = (value(before, h), slope(before, h));
        let size = terms(before, h);
        length(&minus(c0, &at)) <= CONTRACT_TOLERANCE * size
            && length(&minus(c1, &speed)) * h <= CONTRACT_TOLERANCE * size
    }

    /// The piece that contains a time (the first or last one beyond the ends), and the time since its knot.
    fn locate(&self, t: f64) -> (&[Point<D>; 4], f64) {
        let k = self.index(t);
        (&self.pieces[k], t - self.knots[k])
    }

    fn index(&self, t: f64) -> usize {
        self.knots.partition_point(|&knot| knot <= t).clamp(1, self.pieces.len()) - 1
    }
}

impl<const D: usize> Curve<D> for Spline<D> {
    fn position(&self, t: f64) -> Point<D> {
        let (piece, s) = self.locate(t);
        value(piece, s)
    }

    fn velocity(&self, t: f64) -> Point<D> {
        let (piece, s) = self.locate(t);
        slope(piece, s)
    }

    /// Exact up to rounding: r'' is linear between knots, so that its norm is largest at an end of a piece.
    fn acceleration_bound(&self, t0: f64, t1: f64) -> f64 {
        let at = |k: usize, t: f64| {
            let [.., c2, c3] = &self.pieces[k];
            2.0 * length(&add_scaled(c2, 3.0 * (t - self.knots[k]), c3))
        };
        let last = self.pieces.len() - 1;
        let pieces = (self.index(t0)..).take_while(|&k| k <= last && (self.knots[k] < t1 || k == 0));
        pieces.fold(0.0, |most, k| {
            let first = if k == 0 { t0 } else { t0.max(self.knots[k]) };
            let end = if k == last { t1 } else { t1.min(self.knots[k + 1]) };
            at(k, first).max(at(k, end)).max(most)
        })
    }

    fn domain(&self) -> (f64, f64) {
        (self.knots[0], self.knots[self.knots.len() - 1])
    }

    fn size(&self, t: f64) -> f64 {
        let (piece, s) = self.locate(t);
        terms(piece, s)
    }
}

const NOT_FINITE: &str = "it has a number that is NaN or infinite";

fn value<const D: usize>([c0, c1, c2, c3]: &[Point<D>; 4], s: f64) -> Point<D> {
    add_scaled(c0, s, &add_scaled(c1, s, &add_scaled(c2, s, c3)))
}

fn slope<const D: usize>([_, c1, c2, c3]: &[Point<D>; 4], s: f64) -> Point<D> {
    std::array::from_fn(|k| c1[k] + s * (2.0 * c2[k] + s * (3.0 * c3[k])))
}

/// The sum of the lengths of the terms of [`value`].
fn terms<const D: usize>(piece: &[Point<D>; 4], s: f64) -> f64 {
    piece.iter().rev().fold(0.0, |sum, c| sum * s.abs() + length(c))
}

fn check_knots(knots: &[f64], expected: usize) -> Result<(), CurveError> {
    if knots.len() < 2 {
        return Err(CurveError::InvalidArgument { what: "knots", why: "there must be at least two" });
    }
    if knots.len() != expected {
        let why = "one for each point, or one more than pieces, is required";
        return Err(CurveError::InvalidArgument { what: "knots", why });
    }
    for (index, knot) in knots.iter().enumerate() {
        if !knot.is_finite() {
            return Err(CurveError::InvalidKnot { what: "knots", index, why: NOT_FINITE });
        }
        if index > 0 && knots[index - 1] >= *knot {
            let why = "it must be greater than the previous one";
            return Err(CurveError::InvalidKnot { what: "knots", index, why });
        }
    }
    Ok(())
}

/// The cubic between knots k and k + 1 with the given values and slopes there.
fn piece<const D: usize>(knots: &[f64], points: &[Point<D>], slopes: &[Point<D>], k: usize) -> [Point<D>; 4] {
    let h = knots[k + 1] - knots[k];
    let chord = minus(&points[k + 1], &points[k]).map(|x| x / h);
    let (s0, s1) = (&slopes[k], &slopes[k + 1]);
    let c2 = std::array::from_fn(|i| (3.0 * chord[i] - 2.0 * s0[i] - s1[i]) / h);
    let c3 = std::array::from_fn(|i| (s0[i] + s1[i] - 2.0 * chord[i]) / h / h);
    [points[k], *s0, c2, c3]
}

/// Solves for the velocities at the knots.
fn slopes<const D: usize>(knots: &[f64], points: &[Point<D>], ends: &SplineEnds<D>) -> Vec<Point<D>> {
    let inverse: Vec<f64> = knots.windows(2).map(|pair| 1.0 / (pair[1] - pair[0])).collect();
    let chord = |k: usize| minus(&points[k + 1], &points[k]).map(|x| x * inverse[k]);
    let inner = |k: usize| {
        let (a, b) = (chord(k - 1), chord(k));
        std::array::from_fn(|i| 3.0 * (a[i] * inverse[k - 1] + b[i] * inverse[k]))
    };
    let last = knots.len() - 1;
    let solve = |first: Row<D>, inner: &dyn Fn(usize) -> Point<D>, end: Row<D>| {
        let middle = (1..last).map(|k| Row {
            before: inverse[k - 1],
            here: 2.0 * (inverse[k - 1] + inverse[k]),
            after: inverse[k],
            right: inner(k),
        });
        tridiagonal([first].into_iter().chain(middle).chain([end]).collect())
    };
    match ends {
        SplineEnds::Natural => {
            let end = |before: f64, after: f64, k: usize| Row {
                before,
                here: 2.0,
                after,
                right: chord(k).map(|x| 3.0 * x),
            };
            solve(end(0.0, 1.0, 0), &inner, end(1.0, 0.0, last - 1))
        }
        SplineEnds::Clamped { first, last } => solve(Row::known(*first), &inner, Row::known(*last)),
        SplineEnds::Periodic => {
            // the slopes depend linearly on the slope at the ends, which the equation there determines
            let mut slopes = solve(Row::known([0.0; D]), &inner, Row::known([0.0; D]));
            let unit = solve(Row::known([1.0; D]), &|_| [0.0; D], Row::known([1.0; D]));
            let (a, b, m) = (inverse[last - 1], inverse[0], last - 1);
            let (ends, starts) = (chord(m), chord(0));
            for i in 0..D {
                let right = 3.0 * (ends[i] * a + starts[i] * b);
                let left = |s: &[Point<D>]| s[m][i] * a + 2.0 * s[0][i] * (a + b) + s[1][i] * b;
                let at_ends = (right - left(&slopes)) / left(&unit);
                slopes.iter_mut().zip(&unit).for_each(|(s, u)| s[i] += at_ends * u[i]);
            }
            slopes
        }
    }
}

/// A row of a tridiagonal system: `before x_{k-1} + here x_k + after x_{k+1} = right`.
struct Row<const D: usize> {
    before: f64,
    here: f64,
    after: f64,
    right: Point<D>,
}

impl<const D: usize> Row<D> {
    fn known(right: Point<D>) -> Row<D> {
        Row { before: 0.0, here: 1.0, after: 0.0, right }
    }
}

/// Elimination without pivoting, for diagonally dominant systems.
fn tridiagonal<const D: usize>(mut rows: Vec<Row<D>>) -> Vec<Point<D>> {
    for k in 1..rows.len() {
        let factor = rows[k].before / rows[k - 1].here;
        rows[k].here -= factor * rows[k - 1].after;
        rows[k].right = add_scaled(&rows[k].right, -factor, &rows[k - 1].right);
    }
    let mut next = [0.0; D];
    let mut solution: Vec<Point<D>> = rows
        .iter()
        .rev()
        .map(|row| {
            let rest = add_scaled(&row.right, -row.after, &next);
            next = rest.map(|x| x / row.here);
            next
        })
        .collect();
    solution.reverse();
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOTS: [f64; 5] = [0.0, 1.0, 1.5, 3.0, 4.0];

    fn cubic(t: f64) -> Point<2> {
        [1.0 + t * (2.0 - t * (1.5 - 0.25 * t)), -t * t * t + 2.0]
    }

    fn cubic_slope(t: f64) -> Point<2> {
        [2.0 - 3.0 * t + 0.75 * t * t, -3.0 * t * t]
    }

    /// A clamped spline through points of a cubic is that cubic.
    #[test]
    fn clamped_reproduces_a_cubic() {
        let points = KNOTS.map(cubic);
        let ends = SplineEnds::Clamped { first: cubic_slope(0.0), last: cubic_slope(4.0) };
        let spline = Spline::new(&KNOTS, &points, ends).unwrap();
        for k in 0..=80 {
            let t = 0.05 * f64::from(k);
            let (at, speed) = (spline.position(t), spline.velocity(t));
            let (want, want_speed) = (cubic(t), cubic_slope(t));
            assert!((0..2).all(|i| (at[i] - want[i]).abs() < 1e-13), "{t}: {at:?} {want:?}");
            assert!((0..2).all(|i| (speed[i] - want_speed[i]).abs() < 1e-12), "{t}");
        }
    }

    /// For all boundary conditions: interpolation, continuous second derivatives, and the condition itself.
    #[test]
    fn smooth_through_the_points() {
        let points: Vec<Point<2>> = vec![[0.0, 1.0], [2.0, -1.0], [1.0, 0.5], [-3.0, 2.0], [0.0, 1.0]];
        let ends = [
            SplineEnds::Natural,
            SplineEnds::Periodic,
            SplineEnds::Clamped { first: [1.0, 0.0], last: [0.0, 2.0] },
        ];
        for end in ends {
            let spline = Spline::new(&KNOTS, &points, end).unwrap();
            let second = |k: usize, h: f64| {
                let [.., c2, c3] = spline.pieces()[k];
                add_scaled(&c2, 3.0 * h, &c3)
            };
            for k in 0..5 {
                assert!(length(&minus(&spline.position(KNOTS[k]), &points[k])) < 1e-14);
            }
            for k in 1..4 {
                assert!(spline.fits(k), "{end:?} {k}");
                let h = KNOTS[k] - KNOTS[k - 1];
                assert!(length(&minus(&second(k - 1, h), &second(k, 0.0))) < 1e-13, "{end:?} {k}");
            }
            let (first, last) = (second(0, 0.0), second(3, 1.0));
            match end {
                SplineEnds::Natural => assert!(length(&first) + length(&last) < 1e-13),
                SplineEnds::Periodic => {
                    assert!(length(&minus(&first, &last)) < 1e-13);
                    let speeds = minus(&spline.velocity(0.0), &spline.velocity(4.0));
                    assert!(length(&speeds) < 1e-13);
                }
                SplineEnds::Clamped { .. } => {
                    assert!(length(&minus(&spline.velocity(0.0), &[1.0, 0.0])) < 1e-15);
                    assert!(length(&minus(&spline.velocity(4.0), &[0.0, 2.0])) < 1e-14);
                }
            }
        }
    }

    #[test]
    fn the_bound_is_the_largest_second_derivative() {
        let points: Vec<Point<1>> = vec![[0.0], [3.0], [-1.0], [0.5], [0.0]];
        let spline = Spline::new(&KNOTS, &points, SplineEnds::Natural).unwrap();
        for (t0, t1) in [(0.0, 4.0), (0.3, 0.4), (0.9, 1.6), (1.5, 3.0), (3.2, 4.0)] {
            let step = 1e-4;
            let sampled =
                (0..=2000).map(|k| t0 + (t1 - t0) * f64::from(k) / 2000.0).fold(0.0f64, |most, t| {
                    let t = t.clamp(t0 + step, t1 - step);
                    let second = (spline.velocity(t + step)[0] - spline.velocity(t - step)[0]) / (2.0 * step);
                    most.max(second.abs())
                });
            let bound = spline.acceleration_bound(t0, t1);
            assert!(sampled <= bound * (1.0 + 1e-9) && bound <= sampled * 1.01, "{sampled} {bound}");
        }
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]];
        let of = |knots: &[f64]| Spline::new(knots, &points, SplineEnds::Natural).unwrap_err();
        assert!(matches!(of(&[0.0, 1.0]), CurveError::InvalidArgument { what: "knots", .. }));
        assert!(matches!(of(&[0.0, 1.0, 1.0]), CurveError::InvalidKnot { what: "knots", index: 2, .. }));
        assert!(matches!(of(&[0.0, f64::NAN, 1.0]), CurveError::InvalidKnot { what: "knots", index: 1, .. }));
        let open = Spline::new(&[0.0, 1.0, 2.0], &points, SplineEnds::Periodic).unwrap_err();
        assert!(matches!(open, CurveError::InvalidKnot { what: "points", index: 2, .. }));
        let apart = [[[0.0], [1.0], [0.0], [0.0]], [[1.0], [1.5], [0.0], [0.0]]];
        let kink = Spline::from_pieces(&[0.0, 1.0, 2.0], &apart).unwrap_err();
        assert!(matches!(kink, CurveError::InvalidKnot { what: "pieces", index: 1, .. }), "{kink}");
    }
}
