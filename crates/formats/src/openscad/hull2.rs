//! Convex hull of discs and points in the plane.

use rayweave_polygon::Point;

/// Tangent points of the convex hull of discs, in order: the points where supporting lines touch the discs. The hull is the
/// union of the polygon of these points and the discs. A disc of radius 0 is a point.
///
/// Every line that touches two discs is compared with the other discs, usually only a few of them; `spend` counts the
/// comparisons and may end the search.
pub(super) fn touching_points<E>(
    discs: &[(Point, f64)],
    mut spend: impl FnMut(usize) -> Result<(), E>,
) -> Result<Vec<Point>, E> {
    spend(discs.len())?;
    let points: Vec<Point> = discs.iter().filter(|disc| disc.1 == 0.0).map(|disc| disc.0).collect();
    let points = corners(points);
    let round: Vec<(Point, f64)> = discs.iter().filter(|disc| disc.1 > 0.0).copied().collect();
    if round.is_empty() {
        return Ok(points);
    }
    let all: Vec<(Point, f64)> = points.into_iter().map(|p| (p, 0.0)).chain(round).collect();
    let size = all.iter().fold(0f64, |size, (p, r)| size.max(p[0].abs()).max(p[1].abs()).max(*r));
    let mut touched = Vec::new();
    for (i, a) in all.iter().enumerate() {
        for b in all.iter().skip(i + 1) {
            spend(1)?;
            for normal in normals(a, b) {
                let reach = |(p, r): &(Point, f64)| normal[0] * p[0] + normal[1] * p[1] + r;
                let (most, near) = (reach(a), 1e-9 * size);
                let beyond = all.iter().position(|disc| reach(disc) > most + near);
                spend(beyond.unwrap_or(all.len()))?;
                if beyond.is_none() {
                    let on_line = all.iter().filter(|disc| reach(disc) >= most - near);
                    touched.extend(on_line.map(|(p, r)| [p[0] + r * normal[0], p[1] + r * normal[1]]));
                }
            }
        }
    }
    Ok(corners(touched))
}

/// Unit normals of the two lines that touch two discs from the same side: n . (q - p) = r - s.
fn normals((p, r): &(Point, f64), (q, s): &(Point, f64)) -> Vec<Point> {
    let d = [q[0] - p[0], q[1] - p[1]];
    let length = libm::hypot(d[0], d[1]);
    let sine = (r - s) / length;
    if !sine.is_finite() || sine.abs() > 1.0 {
        return Vec::new();
    }
    let (u, cosine) = (d.map(|x| x / length), (1.0 - sine * sine).sqrt());
    [1.0, -1.0].map(|side| [sine * u[0] - side * cosine * u[1], sine * u[1] + side * cosine * u[0]]).to_vec()
}

/// Vertices of the convex hull of points, counter-clockwise (monotone chain, A. M. Andrew 1979).
pub(super) fn corners(mut points: Vec<Point>) -> Vec<Point> {
    points.sort_by(|a, b| a.partial_cmp(b).unwrap_or(std::cmp::Ordering::Equal));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let lower = chain(points.iter());
    let upper = chain(points.iter().rev());
    let (lower, upper) = (&lower[..lower.len() - 1], &upper[..upper.len() - 1]);
    [lower, upper].concat()
}

/// The chain with left turns only.
fn chain<'a>(points: impl Iterator<Item = &'a Point>) -> Vec<Point> {
    let mut kept: Vec<Point> = Vec::new();
    for p in points {
        while let [.., a, b] = kept[..]
            && turn(a, b, *p) <= 0.0
        {
            kept.pop();
        }
        kept.push(*p);
    }
    kept
}

/// Orientation of three points, positive for a left turn; the sign is exact.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    let [a, b, c] = [a, b, c].map(|p| robust::Coord { x: p[0], y: p[1] });
    robust::orient2d(a, b, c)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn touching_points(discs: &[(Point, f64)]) -> Vec<Point> {
        let Ok(points) = super::touching_points(discs, |_| Ok::<(), Infallible>(()));
        points
    }

    #[test]
    fn a_square_with_points_within_and_on_its_edges() {
        let points = (0..25).map(|k| [f64::from(k % 5), f64::from(k / 5)]).collect();
        assert_eq!(corners(points), [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]);
    }

    #[test]
    fn two_discs_and_a_point() {
        // equal discs: a rectangle between them
        let pill = touching_points(&[([0.0, 0.0], 1.0), ([4.0, 0.0], 1.0)]);
        assert_eq!(pill, [[0.0, -1.0], [4.0, -1.0], [4.0, 1.0], [0.0, 1.0]]);
        // tangents from a point at distance 2 touch a unit disc at 60 degrees
        let drop = touching_points(&[([0.0, 0.0], 1.0), ([2.0, 0.0], 0.0)]);
        assert_eq!(drop.len(), 3);
        let h = 0.75f64.sqrt();
        for expected in [[0.5, h], [0.5, -h], [2.0, 0.0]] {
            let near = |p: &Point| (p[0] - expected[0]).hypot(p[1] - expected[1]) < 1e-14;
            assert!(drop.iter().any(near), "{drop:?}");
        }
        // one disc inside the other
        assert_eq!(touching_points(&[([0.0, 0.0], 3.0), ([1.0, 0.0], 1.0)]), [[0.0; 2]; 0]);
    }
}
