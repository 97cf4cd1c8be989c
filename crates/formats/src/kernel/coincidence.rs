//! Coincident planes of two bodies, made exactly coincident before a boolean.
//!
//! The kernel recognises coincident faces by equal coordinates, so it finds only faces that are perpendicular to an axis and free of
//! rounding errors. For others, a face of contact stays inside the union as two faces. Here a linear map makes up to three coincident
//! planes perpendicular to the axes, and coordinates that differ by rounding errors only become equal. The result is mapped back.
//! Booleans commute with linear maps.

use manifold_rust::linalg::Vec3 as KernelVec;
use manifold_rust::manifold::Manifold;
use rayweave_math::{Bounds, Mat3, Vec3, any_perpendicular};
use std::cmp::Ordering;
use std::collections::HashMap;

/// Coordinates that differ by less than this part of the largest coordinate become equal. This is the precision of the kernel, which
/// collapses shorter edges. The vertices of a plane are off by about 1e-15 of the size after a rotation and some booleans.
const PRECISION: f64 = 1e-12;

/// The width of the cells of unit normals and relative offsets in which planes are searched. It exceeds the rounding errors of the
/// normals of small triangles. Planes that share a cell and do not coincide cost time only.
const CELL: f64 = 1e-6;

/// The least determinant of three unit normals that become axes, so that the map amplifies rounding errors by little.
const LEAST_DETERMINANT: f64 = 0.02;

/// The map back from the frame of a boolean.
pub(super) struct Frame {
    /// The map into the axes of the model, and the coordinates of the operands there, sorted; `None` if the frame has these axes.
    back: Option<(Mat3, [Vec<f64>; 3])>,
    tolerance: f64,
}

/// Two bodies in a frame where their coincident planes have equal coordinates; `None` if no plane needs a change.
pub(super) fn aligned(first: &Manifold, second: &Manifold) -> Option<(Frame, [Manifold; 2])> {
    let both = [first, second];
    let points = both.map(points_of);
    let [a, b] = points.each_ref().map(|points| bounds_of(points));
    let tolerance = PRECISION
        * [a, b]
            .map(|bounds| bounds.lo.abs().max(bounds.hi.abs()).max_element())
            .iter()
            .fold(0.0, |x: f64, y| x.max(*y));
    let within = a.grown(tolerance).intersection(&b.grown(tolerance));
    if within.is_empty() {
        return None;
    }
    let cells = [0, 1].map(|k| planes_by_cell(both[k], &points[k], &within, tolerance / PRECISION));
    let planes = common(&cells);
    let axes = axes(&planes, tolerance)?;
    let is_turned = axes != Mat3::IDENTITY;
    let mapped = match is_turned {
        true => points.each_ref().map(|points| points.iter().map(|p| axes * *p).collect()),
        false => points.clone(),
    };
    let snapped = snapped(&mapped, tolerance);
    if !is_turned && snapped == points {
        return None;
    }
    let moved = [0, 1].map(|k| with_points(both[k], &snapped[k]));
    let back = is_turned.then(|| {
        let values = [0, 1, 2].map(|axis| sorted(points.iter().flatten().map(|p| p[axis])));
        (axes.inverse(), values)
    });
    Some((Frame { back, tolerance }, moved))
}

impl Frame {
    /// The result of a boolean in the axes of the model. Coordinates within rounding of one of the operands get its value.
    pub fn back(&self, result: Manifold) -> Manifold {
        let Some((inverse, values)) = &self.back else { return result };
        let restored = |p: Vec3| {
            let p = *inverse * p;
            Vec3::from_array([0, 1, 2].map(|axis| nearest(&values[axis], p[axis], self.tolerance)))
        };
        let points: Vec<Vec3> = points_of(&result).into_iter().map(restored).collect();
        with_points(&result, &points)
    }
}

fn points_of(body: &Manifold) -> Vec<Vec3> {
    body.as_impl().vert_pos.iter().map(|p| Vec3::new(p.x, p.y, p.z)).collect()
}

/// The body with its vertices moved, in their order.
fn with_points(body: &Manifold, points: &[Vec3]) -> Manifold {
    body.warp_batch(|all| {
        for (to, p) in all.iter_mut().zip(points) {
            *to = KernelVec { x: p.x, y: p.y, z: p.z };
        }
    })
}

fn bounds_of(points: &[Vec3]) -> Bounds {
    points.iter().fold(Bounds::EMPTY, |bounds, p| bounds.union(&Bounds { lo: *p, hi: *p }))
}

/// The triangles of a body, or of two, in one plane.
#[derive(Clone, Copy)]
struct Plane {
    /// The sum of the areas as a normal; its sign is of no account.
    normal: Vec3,
    bounds: Bounds,
}

impl Plane {
    fn with(self, other: &Plane) -> Plane {
        let sign = if self.normal.dot(other.normal) < 0.0 { -1.0 } else { 1.0 };
        Plane { normal: self.normal + sign * other.normal, bounds: self.bounds.union(&other.bounds) }
    }

    /// The unit normal, which is exact if it is along an axis within rounding.
    fn unit_normal(&self, tolerance: f64) -> Vec3 {
        let size = self.bounds.size();
        let axis = Vec3::AXES.into_iter().find(|axis| size.dot(*axis) <= tolerance);
        axis.unwrap_or_else(|| self.normal / self.normal.length())
    }
}

/// A normal and an offset in units of [`CELL`].
type Key = [i64; 4];

/// The planes of the triangles of a body that have points in a box, each with its position in the grid of cells.
fn planes_by_cell(
    body: &Manifold,
    points: &[Vec3],
    within: &Bounds,
    largest: f64,
) -> HashMap<Key, ([f64; 4], Plane)> {
    let mut found: HashMap<Key, ([f64; 4], Plane)> = HashMap::new();
    for edges in body.as_impl().halfedge.chunks_exact(3) {
        let corners = [0, 1, 2].map(|k| points[edges[k].start_vert as usize]);
        let bounds = bounds_of(&corners);
        let [a, b, c] = corners;
        let cross = (b - a).cross(c - a);
        let length = cross.length();
        if bounds.intersection(within).is_empty() || length == 0.0 {
            continue;
        }
        // of two opposite normals the one along a direction that few planes are parallel to
        let along = cross.dot(Vec3::new(1.0, 0.754_877_666_246_692_7, 0.569_840_290_998_053_2));
        let cross = if along < 0.0 { -cross } else { cross };
        let normal = cross / length;
        let at = [normal.x, normal.y, normal.z, normal.dot(a) / largest].map(|x| x / CELL);
        let plane = Plane { normal: cross, bounds };
        let key = at.map(|x| x.round() as i64);
        found.entry(key).and_modify(|(_, all)| *all = all.with(&plane)).or_insert((at, plane));
    }
    found
}

/// The planes with triangles of both bodies, the largest first.
fn common([first, second]: &[HashMap<Key, ([f64; 4], Plane)>; 2]) -> Vec<Plane> {
    let mut found: Vec<Plane> = Vec::new();
    for (at, plane) in second.values() {
        let others = neighbours(*at).into_iter().filter_map(|key| first.get(&key));
        let all = others.fold(None, |all: Option<Plane>, (_, other)| Some(all.unwrap_or(*plane).with(other)));
        found.extend(all);
    }
    // the order in a hash map is random
    found.sort_by(|a, b| {
        let area = |plane: &Plane| plane.normal.length_squared();
        area(b).total_cmp(&area(a)).then_with(|| order(a.normal, b.normal))
    });
    found
}

/// The cells within a hundredth of the width of a cell.
fn neighbours(at: [f64; 4]) -> Vec<Key> {
    let mut keys = vec![[0; 4]];
    for (k, x) in at.into_iter().enumerate() {
        let [lo, hi] = [(x - 0.01).round() as i64, (x + 0.01).round() as i64];
        keys.iter_mut().for_each(|key| key[k] = lo);
        if hi != lo {
            let others: Vec<Key> = keys
                .iter()
                .map(|key| {
                    let mut key = *key;
                    key[k] = hi;
                    key
                })
                .collect();
            keys.extend(others);
        }
    }
    keys
}

fn order(a: Vec3, b: Vec3) -> Ordering {
    let pairs = a.to_array().into_iter().zip(b.to_array());
    pairs.map(|(x, y)| x.total_cmp(&y)).find(|order| order.is_ne()).unwrap_or(Ordering::Equal)
}

/// Rows of a linear map without reflection that makes the largest planes perpendicular to axes; `None` without planes.
fn axes(planes: &[Plane], tolerance: f64) -> Option<Mat3> {
    let mut normals = planes.iter().map(|plane| plane.unit_normal(tolerance));
    let first = normals.next()?;
    let mut chosen = vec![first];
    for normal in normals {
        let volume = match chosen[..] {
            [a] => a.cross(normal).length(),
            [a, b] => a.cross(b).dot(normal).abs(),
            _ => break,
        };
        if volume > LEAST_DETERMINANT {
            chosen.push(normal);
        }
    }
    let is_axis = |normal: &Vec3| Vec3::AXES.contains(normal);
    if chosen.iter().all(is_axis) {
        return Some(Mat3::IDENTITY);
    }
    if let [a] = chosen[..] {
        chosen.push(any_perpendicular(a));
    }
    if let [a, b] = chosen[..] {
        let c = a.cross(b);
        chosen.push(c / c.length());
    }
    let rows = Mat3::from_cols(chosen[0], chosen[1], chosen[2]).transpose();
    Some(match rows.determinant() < 0.0 {
        true => Mat3::from_cols(chosen[1], chosen[0], chosen[2]).transpose(),
        false => rows,
    })
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    values.dedup();
    values
}

/// The points with coordinates that differ by rounding only made equal, along each axis.
fn snapped(points: &[Vec<Vec3>; 2], tolerance: f64) -> [Vec<Vec3>; 2] {
    let values = [0, 1, 2].map(|axis| representatives(points.iter().flatten().map(|p| p[axis]), tolerance));
    let to = |p: &Vec3| Vec3::from_array([0, 1, 2].map(|axis| nearest(&values[axis], p[axis], tolerance)));
    points.each_ref().map(|points| points.iter().map(to).collect())
}

/// One value for each run of values that differ by rounding only: the most frequent one, and of those the least.
fn representatives(values: impl Iterator<Item = f64>, tolerance: f64) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_unstable_by(f64::total_cmp);
    let mut found = Vec::new();
    let mut rest = &values[..];
    while let Some(&least) = rest.first() {
        let (run, others) = rest.split_at(rest.partition_point(|x| *x <= least + tolerance));
        let mut most: &[f64] = &[];
        for equal in run.chunk_by(|a, b| a == b) {
            most = if equal.len() > most.len() { equal } else { most };
        }
        found.extend(most.first());
        rest = others;
    }
    found
}

/// The nearest of sorted values within the tolerance, or else the value itself.
fn nearest(values: &[f64], x: f64, tolerance: f64) -> f64 {
    let at = values.partition_point(|value| *value < x);
    let around = values[at.saturating_sub(1)..values.len().min(at + 1)].iter().copied();
    let best = around.min_by(|a, b| (a - x).abs().total_cmp(&(b - x).abs()));
    best.filter(|value| (value - x).abs() <= tolerance).unwrap_or(x)
}
