//! Support function of a polyhedron given by planes: linear programming in three variables.
//!
//! By duality the maximum of `c . p` subject to `n_i . p <= d_i` for all i is the minimum of `sum l_i d_i` over all
//! `l_i >= 0` with `sum l_i n_i = c`, and at most three planes attain it (Dantzig, *Linear Programming and Extensions*,
//! 1963, chapters 6 and 7). Every such combination is an upper bound of `c . p`, so omitting combinations can make the
//! result too large but never too small.

use crate::surface::Plane;
use rayweave_math::{Bounds, UNIT_ROUNDOFF, Vec3, unit};

/// Largest number of planes that are combined with each other for one direction. Up to this number the result is the least
/// bound; beyond it, planes are added where they cut off most, which nearly always finishes much earlier.
const LIMIT: usize = 64;

/// Relative rounding error of a solution with three planes that are not nearly parallel.
const ROUNDING: f64 = 32.0 * UNIT_ROUNDOFF;

/// Bounding box of the intersection of half-spaces. It is empty if the intersection is finite and empty by more than
/// rounding, and infinite where the intersection is unbounded.
pub(super) fn polyhedron_bounds(planes: &[Plane]) -> Bounds {
    let hi = Vec3::AXES.map(|axis| support(planes, axis));
    let lo = Vec3::AXES.map(|axis| -support(planes, -axis));
    let bounds = Bounds::new(Vec3::from_array(lo), Vec3::from_array(hi));
    let decidable = bounds.is_finite() && planes.len() <= LIMIT;
    match decidable && has_no_vertex(planes) {
        true => Bounds::EMPTY,
        false => bounds,
    }
}

/// An upper bound, and the intersection of the planes that attain it (the point nearest to the origin).
type Optimum = (f64, Vec3);

fn support(planes: &[Plane], direction: Vec3) -> f64 {
    let mut order: Vec<usize> = (0..planes.len()).collect();
    let slant = |i: &usize| -planes[*i].normal.dot(direction);
    order.sort_by(|i, j| slant(i).total_cmp(&slant(j)));
    let mut used: Vec<&Plane> = Vec::new();
    let mut best: Option<Optimum> = None;
    while used.len() < LIMIT && !order.is_empty() {
        if best.is_some_and(|(_, vertex)| holds_all(planes, vertex)) {
            break;
        }
        let at = best.map_or(0, |(_, vertex)| most_violated(planes, &order, vertex));
        let plane = &planes[order.remove(at)];
        best = least(best, combinations(direction, plane, &used));
        used.push(plane);
    }
    best.map_or(f64::INFINITY, |(bound, _)| bound)
}

/// True if a point satisfies all planes: a bound that it attains is the least one.
fn holds_all(planes: &[Plane], point: Vec3) -> bool {
    let holds = |plane: &Plane| plane.normal.dot(point) <= plane.offset;
    planes.iter().all(holds)
}

/// Index in `order` of the plane that a point violates most.
fn most_violated(planes: &[Plane], order: &[usize], vertex: Vec3) -> usize {
    let excess = |i: usize| planes[order[i]].normal.dot(vertex) - planes[order[i]].offset;
    let all = 0..order.len();
    all.max_by(|&i, &j| excess(i).total_cmp(&excess(j))).unwrap_or(0)
}

fn least(a: Option<Optimum>, others: impl Iterator<Item = Optimum>) -> Option<Optimum> {
    a.into_iter().chain(others).min_by(|a, b| a.0.total_cmp(&b.0))
}

/// Bounds from single planes, pairs and triples with a given plane.
fn combinations<'a>(
    direction: Vec3,
    plane: &'a Plane,
    used: &'a [&'a Plane],
) -> impl Iterator<Item = Optimum> + 'a {
    let pairs = used.iter().filter_map(move |b| of_two(direction, plane, b));
    let triples = (0..used.len())
        .flat_map(move |i| used[..i].iter().filter_map(move |b| of_three(direction, [plane, used[i], b])));
    of_one(direction, plane).into_iter().chain(pairs).chain(triples)
}

fn of_one(direction: Vec3, plane: &Plane) -> Option<Optimum> {
    let part = direction.dot(plane.normal);
    let rest = direction - part * plane.normal;
    (part > 0.0 && rest.length() <= ROUNDING).then(|| (part * plane.offset, plane.normal * plane.offset))
}

fn of_two(direction: Vec3, a: &Plane, b: &Plane) -> Option<Optimum> {
    let across = unit(a.normal.cross(b.normal));
    // the cross product of nearly parallel planes has an arbitrary direction, or is NaN
    let is_across = direction.dot(across).abs() <= ROUNDING;
    if !is_across {
        return None;
    }
    // a plane through the origin parallel to both normals completes a triple
    let third = Plane::new(across, 0.0);
    of_three(direction, [a, b, &third])
}

fn of_three(direction: Vec3, planes: [&Plane; 3]) -> Option<Optimum> {
    let [a, b, c] = planes.map(|plane| plane.normal);
    let dual = [b.cross(c), c.cross(a), a.cross(b)];
    let determinant = a.dot(dual[0]);
    let weights = dual.map(|column| direction.dot(column) / determinant);
    let size = weights.iter().map(|w| w.abs()).sum::<f64>();
    // false for nearly parallel planes, where the bound has lost its digits, and for parallel ones (NaN)
    let sound = size <= 1e8;
    if !sound || weights.iter().any(|&w| w < -ROUNDING * size) {
        return None;
    }
    // three planes parallel to one line have weights that are quotients of roundings: they do not add up to the direction
    let weights = weights.map(|w| w.max(0.0));
    let left = (direction - (weights[0] * a + weights[1] * b + weights[2] * c)).length();
    if left > ROUNDING * size.max(1.0) {
        return None;
    }
    let vertex = meeting(planes, dual, determinant);
    let bound: f64 = (0..3).map(|k| weights[k] * planes[k].offset).sum();
    Some((bound + left * vertex.length(), vertex))
}

/// Intersection of three planes.
fn meeting(planes: [&Plane; 3], dual: [Vec3; 3], determinant: f64) -> Vec3 {
    let parts = (0..3).map(|k| dual[k] * planes[k].offset);
    parts.fold(Vec3::ZERO, |sum, part| sum + part) / determinant
}

/// True if every intersection of three planes clearly violates another plane: a polyhedron with finite extents is then
/// empty.
fn has_no_vertex(planes: &[Plane]) -> bool {
    let n = planes.len();
    let triples = (0..n).flat_map(|i| (0..i).flat_map(move |j| (0..j).map(move |k| [i, j, k])));
    let scale = planes.iter().fold(0.0f64, |scale, plane| scale.max(plane.offset.abs()));
    triples.map(|triple| triple.map(|i| &planes[i])).all(|triple| !may_be_vertex(triple, planes, scale))
}

fn may_be_vertex(triple: [&Plane; 3], planes: &[Plane], scale: f64) -> bool {
    let [a, b, c] = triple.map(|plane| plane.normal);
    let dual = [b.cross(c), c.cross(a), a.cross(b)];
    let determinant = a.dot(dual[0]);
    if determinant.abs() < ROUNDING {
        return false;
    }
    let vertex = meeting(triple, dual, determinant);
    let slack = 1e-9 * (scale + vertex.length()) + ROUNDING * scale / determinant.abs();
    let holds = |plane: &Plane| plane.normal.dot(vertex) <= plane.offset + slack;
    planes.iter().all(holds)
}
