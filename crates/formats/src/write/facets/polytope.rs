//! Convex polytopes: intersection of a box with half-spaces.

use crate::kernel::Body;
use rayweave_math::{Bounds, Vec3};
use rayweave_shape::primitive::Lowered;
use rayweave_shape::surface::Surface;

/// The planes of a shape with planar faces only, oriented so that the shape is the intersection of `normal . p < offset`.
pub(in crate::write) fn planes_of(lowered: &Lowered) -> Option<Vec<(Vec3, f64)>> {
    let plane = |facet: &rayweave_shape::primitive::Facet| match &facet.surface {
        Surface::Plane(plane) if facet.inside => Some((plane.normal, plane.offset)),
        Surface::Plane(plane) => Some((-plane.normal, -plane.offset)),
        _ => None,
    };
    lowered.facets.iter().map(plane).collect()
}

/// The intersection of the half-spaces and the box, or its complement in the box.
pub(super) fn body(planes: &[(Vec3, f64)], complement: bool, clip: &Bounds) -> Result<Option<Body>, String> {
    let cut = Body::hull(&hull_points(planes, clip))?;
    if !complement {
        return Ok(cut);
    }
    let whole = Body::cuboid(clip);
    match cut {
        Some(cut) => whole.difference(&cut),
        None => Ok(Some(whole)),
    }
}

/// Vertices of the intersection of half-spaces and the box; fewer than four if it is empty or flat.
fn hull_points(planes: &[(Vec3, f64)], clip: &Bounds) -> Vec<Vec3> {
    let corners = clip.corners();
    let side = |numbers: [usize; 4]| numbers.map(|k| corners[k]).to_vec();
    // bit b of the vertex index selects the upper coordinate along axis b
    let mut faces: Vec<Vec<Vec3>> =
        [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]]
            .map(side)
            .to_vec();
    for (normal, offset) in planes {
        faces = cut(faces, *normal, *offset);
    }
    let mut points: Vec<Vec3> = faces.into_iter().flatten().collect();
    points.sort_by(order);
    points.dedup();
    points
}

fn order(a: &Vec3, b: &Vec3) -> std::cmp::Ordering {
    let pairs = a.to_array().into_iter().zip(b.to_array());
    pairs.map(|(x, y)| x.total_cmp(&y)).find(|order| order.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
}

/// The faces on the inner side of a plane; the new face shares the vertices of its neighbours.
fn cut(faces: Vec<Vec<Vec3>>, normal: Vec3, offset: f64) -> Vec<Vec<Vec3>> {
    let height = |p: Vec3| normal.dot(p) - offset;
    let mut rim = Vec::new();
    let mut kept = Vec::new();
    for face in faces {
        let mut polygon = Vec::new();
        for (k, &a) in face.iter().enumerate() {
            let b = face[(k + 1) % face.len()];
            if height(a) <= 0.0 {
                polygon.push(a);
            }
            if (height(a) <= 0.0) != (height(b) <= 0.0) {
                let point = meeting(a, b, height);
                polygon.push(point);
                rim.push(point);
            }
        }
        if polygon.len() > 2 {
            kept.push(polygon);
        }
    }
    rim.sort_by(order);
    rim.dedup();
    kept.extend((rim.len() > 2).then(|| around(rim, normal)));
    kept
}

/// Intersection of an edge and a plane, the same for both faces of the edge.
fn meeting(a: Vec3, b: Vec3, height: impl Fn(Vec3) -> f64) -> Vec3 {
    let (a, b) = if order(&a, &b).is_lt() { (a, b) } else { (b, a) };
    let (h, k) = (height(a), height(b));
    a + (b - a) * (h / (h - k))
}

/// Vertices of a convex face in order.
fn around(mut rim: Vec<Vec3>, normal: Vec3) -> Vec<Vec3> {
    let middle = rim.iter().sum::<Vec3>() / rim.len() as f64;
    let x = rayweave_math::any_perpendicular(normal);
    let y = normal.cross(x);
    let angle = |p: &Vec3| libm::atan2((*p - middle).dot(y), (*p - middle).dot(x));
    rim.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    rim
}
