//! Arcs in contours: runs of points on circles, for formats that have arcs.

type Point = [f64; 2];

/// A closed contour with arcs.
#[derive(Debug, PartialEq)]
pub(super) enum Shape {
    /// A whole circle.
    Circle { centre: Point, radius: f64 },
    /// Edges between corners, in the order of the contour.
    Outline(Vec<Corner>),
}

/// A corner, and the edge from it to the next one: the tangent of a quarter of the angle of an arc, positive if it is
/// counter-clockwise; 0 for a straight edge.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Corner {
    pub at: Point,
    pub bulge: f64,
}

/// The least number of points of an arc: three determine a circle, two more confirm it.
const LEAST: usize = 5;
/// The largest distance of points from their circle, and of the circle from the edges between them, in tolerances. Contours deviate
/// from the surfaces by at most the tolerance, so that the arcs of a polygon with few corners are too far from its edges.
const OFF: f64 = 0.02;
const HIGH: f64 = 2.0;
/// An arc of more than this angle, in radians, is divided into four: the tangent of its quarter stays moderate.
const WIDE: f64 = 3.0;

/// A circle and the direction of travel: 1 counter-clockwise, -1 clockwise.
#[derive(Clone, Copy)]
struct Turn {
    centre: Point,
    radius: f64,
    sign: f64,
}

impl Shape {
    /// The contour with the arcs that its points lie on.
    pub fn of(contour: &[Point], tolerance: f64) -> Shape {
        let count = contour.len();
        let at = |k: usize| contour[k % count];
        if let Some(turn) = arc(count, at, tolerance, count) {
            return Shape::Circle { centre: turn.centre, radius: turn.radius };
        }
        // begin where an arc begins, so that none is divided
        let is_arc = |k: usize| arc(LEAST - 1, |j| at(k + j), tolerance, 0).is_some();
        let begin = (0..count).find(|&k| is_arc(k) && !is_arc(k + count - 1));
        let (begin, mut corners, mut k) = (begin.unwrap_or(0), Vec::new(), 0);
        while k < count {
            let from = |j: usize| at(begin + k + j);
            let Some(steps) = longest(count - k, from, tolerance) else {
                corners.push(Corner { at: from(0), bulge: 0.0 });
                k += 1;
                continue;
            };
            corners.extend(edges(steps, from));
            k += steps;
        }
        Shape::Outline(corners)
    }
}

/// The largest number of steps, at most `most`, along which the points from the first one lie on an arc.
fn longest(most: usize, at: impl Fn(usize) -> Point, tolerance: f64) -> Option<usize> {
    let is_arc = |steps: usize| arc(steps, &at, tolerance, 0).is_some();
    let mut known = (most >= LEAST - 1 && is_arc(LEAST - 1)).then_some(LEAST - 1)?;
    // doubling and halving: an arc with fewer steps is an arc as well
    let mut step = known;
    while known + step <= most && is_arc(known + step) {
        known += step;
        step *= 2;
    }
    while step > 1 {
        step /= 2;
        if known + step <= most && is_arc(known + step) {
            known += step;
        }
    }
    Some(known)
}

/// The circle of the points 0 to `steps`, or of a closed contour of `closed` points; `None` if they do not lie on an arc.
fn arc(steps: usize, at: impl Fn(usize) -> Point, tolerance: f64, closed: usize) -> Option<Turn> {
    let last = if closed > 0 { 2 * steps / 3 } else { steps };
    if last < 2 || steps + 1 < LEAST {
        return None;
    }
    let turn = through(at(0), at(last / 2), at(last))?;
    let Turn { centre, radius, sign } = turn;
    let mut sweep = 0.0;
    for k in 0..steps {
        let [p, q] = [at(k), at(k + 1)].map(|p| [p[0] - centre[0], p[1] - centre[1]]);
        let angle = sign * libm::atan2(p[0] * q[1] - p[1] * q[0], p[0] * q[0] + p[1] * q[1]);
        let high = radius * (1.0 - libm::cos(0.5 * angle));
        let is_on = (libm::hypot(q[0], q[1]) - radius).abs() <= OFF * tolerance;
        if !is_on || angle <= 0.0 || high > HIGH * tolerance {
            return None;
        }
        sweep += angle;
    }
    // a closed contour goes around once, an arc less than once
    let is_once = (sweep - std::f64::consts::TAU).abs() < 1e-6;
    let is_open = closed == 0 && sweep < std::f64::consts::TAU - 1e-6;
    (is_open || (closed > 0 && is_once)).then_some(turn)
}

/// The circle through three points in order; `None` if they are collinear.
fn through(a: Point, b: Point, c: Point) -> Option<Turn> {
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1]]);
    let twice = 2.0 * (u[0] * v[1] - u[1] * v[0]);
    let [uu, vv] = [u, v].map(|w| w[0] * w[0] + w[1] * w[1]);
    let offset = [(v[1] * uu - u[1] * vv) / twice, (u[0] * vv - v[0] * uu) / twice];
    let radius = libm::hypot(offset[0], offset[1]);
    let centre = [a[0] + offset[0], a[1] + offset[1]];
    radius.is_finite().then_some(Turn { centre, radius, sign: twice.signum() })
}

/// The arcs along some steps of points on a circle: one, or several if its angle is large.
fn edges(steps: usize, at: impl Fn(usize) -> Point) -> Vec<Corner> {
    let Some(Turn { centre, sign, .. }) = through(at(0), at(steps / 2), at(steps)) else { return Vec::new() };
    let angle = |k: usize| libm::atan2(at(k)[1] - centre[1], at(k)[0] - centre[0]);
    let between =
        |from: usize, to: usize| (sign * (angle(to) - angle(from))).rem_euclid(std::f64::consts::TAU);
    let parts = if between(0, steps) > WIDE { 4 } else { 1 };
    let ends: Vec<usize> = (0..=parts).map(|k| k * steps / parts).collect();
    let corner = |pair: &[usize]| Corner {
        at: at(pair[0]),
        bulge: sign * libm::tan(0.25 * between(pair[0], pair[1])),
    };
    ends.windows(2).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    /// Points of an arc with this many steps, without the last one.
    fn points(centre: Point, radius: f64, [from, to]: [f64; 2], steps: u32) -> Vec<Point> {
        let at = |k: u32| from + (to - from) * f64::from(k) / f64::from(steps);
        (0..steps).map(at).map(|a| [centre[0] + radius * a.cos(), centre[1] + radius * a.sin()]).collect()
    }

    #[test]
    fn circles_are_found_in_both_directions() {
        for [from, to] in [[0.3, 0.3 + 2.0 * PI], [1.0, 1.0 - 2.0 * PI]] {
            let Shape::Circle { centre, radius } = Shape::of(&points([3.0, -2.0], 5.0, [from, to], 90), 4e-3)
            else {
                panic!("no circle")
            };
            assert!((centre[0] - 3.0).abs() + (centre[1] + 2.0).abs() + (radius - 5.0).abs() < 1e-12);
        }
    }

    /// A slot: two straight edges and two half circles, wherever the contour begins.
    #[test]
    fn a_slot_has_arcs_and_straight_edges() {
        let right = points([4.0, 0.0], 1.0, [-FRAC_PI_2, FRAC_PI_2], 40);
        let left = points([0.0, 0.0], 1.0, [FRAC_PI_2, 3.0 * FRAC_PI_2], 40);
        let slot = [right, vec![[4.0, 1.0]], left, vec![[0.0, -1.0]]].concat();
        for begin in 0..slot.len() {
            let mut contour = slot.clone();
            contour.rotate_left(begin);
            let Shape::Outline(corners) = Shape::of(&contour, 1e-3) else { panic!("a circle") };
            let straight = corners.iter().filter(|corner| corner.bulge == 0.0).count();
            let sweep: f64 = corners.iter().map(|corner| 4.0 * corner.bulge.atan()).sum();
            assert!(
                (sweep - 2.0 * PI).abs() < 1e-12 && straight == 2 && corners.len() < 12,
                "{begin}: {corners:?}"
            );
        }
    }

    #[test]
    fn polygons_stay_polygons() {
        for count in [3, 6, 24] {
            let polygon = points([0.0; 2], 1.0, [0.0, 2.0 * PI], count);
            let Shape::Outline(corners) = Shape::of(&polygon, 1e-3) else { panic!("a circle") };
            assert_eq!(corners.iter().map(|corner| corner.at).collect::<Vec<_>>(), polygon);
            assert!(corners.iter().all(|corner| corner.bulge == 0.0));
        }
        let ellipse: Vec<Point> =
            points([0.0; 2], 1.0, [0.0, 2.0 * PI], 200).into_iter().map(|[x, y]| [2.0 * x, y]).collect();
        assert!(matches!(Shape::of(&ellipse, 1e-6), Shape::Outline(corners) if corners.len() == 200));
    }
}
