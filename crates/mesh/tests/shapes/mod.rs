//! Test meshes with closed-form shapes.
#![allow(dead_code)]

use rand::{RngExt, rngs::ChaCha8Rng};
use rayweave_math::Vec3;
use rayweave_mesh::{Mesh, Perturbation};

/// The perturbation directions of the engine.
pub const ASIDE: Perturbation =
    [Vec3::new(1.0, 0.754_877_666_246_692_7, 0.569_840_290_998_053_2), Vec3::X, Vec3::Y, Vec3::Z];

/// The box between two corners, oriented outward.
pub fn cuboid(lo: Vec3, hi: Vec3) -> Mesh {
    let corner = |k: usize| {
        let pick = |axis: usize| if k >> axis & 1 == 1 { hi[axis] } else { lo[axis] };
        Vec3::new(pick(0), pick(1), pick(2))
    };
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh::new((0..8).map(corner).collect(), triangles).unwrap()
}

/// A surface over a closed grid of `rows` x `columns` points.
fn grid(rows: u32, columns: u32, point: impl Fn(f64, f64) -> Vec3) -> Mesh {
    let cells = (0..rows).flat_map(|i| (0..columns).map(move |j| (i, j)));
    let at = |(i, j): (u32, u32)| point(f64::from(i) / f64::from(rows), f64::from(j) / f64::from(columns));
    let number = |i: u32, j: u32| (i % rows) * columns + j % columns;
    let triangles = cells.clone().flat_map(|(i, j)| {
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    Mesh::new(cells.clone().map(at).collect(), triangles.collect()).unwrap()
}

/// A torus about z with these radii.
pub fn torus(major: f64, minor: f64, rows: u32, columns: u32) -> Mesh {
    grid(rows, columns, |u, v| {
        let (u, v) = (u * std::f64::consts::TAU, v * std::f64::consts::TAU);
        let rho = major + minor * libm::cos(v);
        Vec3::new(rho * libm::cos(u), rho * libm::sin(u), minor * libm::sin(v))
    })
}

/// A regular icosahedron after a number of subdivisions into four; `radius` gives the distance of a corner by its direction.
pub fn ball(times: u32, radius: impl Fn(Vec3) -> f64) -> Mesh {
    let g = 0.5 * (1.0 + 5f64.sqrt());
    let mut vertices: Vec<Vec3> = (0..12)
        .map(|k| {
            let (a, b) = (if k & 1 == 0 { 1.0 } else { -1.0 }, if k & 2 == 0 { g } else { -g });
            [Vec3::new(0.0, a, b), Vec3::new(a, b, 0.0), Vec3::new(b, 0.0, a)][k >> 2]
        })
        .collect();
    let mut triangles = hull_of_icosahedron(&vertices);
    for _ in 0..times {
        let mut finer = Vec::new();
        let mut middles = std::collections::BTreeMap::new();
        let mut middle = |vertices: &mut Vec<Vec3>, a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                vertices.push(0.5 * (vertices[a as usize] + vertices[b as usize]));
                vertices.len() as u32 - 1
            })
        };
        for [a, b, c] in triangles {
            let (p, q, r) =
                (middle(&mut vertices, a, b), middle(&mut vertices, b, c), middle(&mut vertices, c, a));
            finer.extend([[a, p, r], [p, b, q], [r, q, c], [p, q, r]]);
        }
        triangles = finer;
    }
    let place = |v: Vec3| radius(v.normalize()) * v.normalize();
    Mesh::new(vertices.into_iter().map(place).collect(), triangles).unwrap()
}

/// The triangles between vertices at distance 2 from each other, oriented outward.
fn hull_of_icosahedron(vertices: &[Vec3]) -> Vec<[u32; 3]> {
    let is_edge =
        |a: u32, b: u32| ((vertices[a as usize] - vertices[b as usize]).length() - 2.0).abs() < 1e-9;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in (a + 1)..12 {
            for c in (b + 1)..12 {
                if is_edge(a, b) && is_edge(b, c) && is_edge(c, a) {
                    let [p, q, r] = [a, b, c].map(|k| vertices[k as usize]);
                    let outward = (q - p).cross(r - p).dot(p) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    triangles
}

/// A bumpy ball.
pub fn potato(times: u32) -> Mesh {
    ball(times, |d| 1.0 + 0.3 * libm::sin(5.0 * d.x + 2.0 * d.y) * libm::cos(4.0 * d.z))
}

/// The union of the triangles of two meshes.
pub fn both(a: &Mesh, b: &Mesh) -> Mesh {
    let shift = a.vertices().len() as u32;
    let vertices = a.vertices().iter().chain(b.vertices()).copied().collect();
    let moved = b.triangles().iter().map(|corners| corners.map(|vertex| vertex + shift));
    Mesh::new(vertices, a.triangles().iter().copied().chain(moved).collect()).unwrap()
}

/// The winding number of a mesh around a point: the sum of the solid angles of its triangles (A. Van Oosterom, J. Strackee, 1983)
/// over 4 pi.
pub fn winding(mesh: &Mesh, point: Vec3) -> f64 {
    let angle = |triangle: usize| {
        let [a, b, c] = mesh.corners(triangle).map(|corner| corner - point);
        let [x, y, z] = [a, b, c].map(|v| v.length());
        let below = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
        2.0 * libm::atan2(a.dot(b.cross(c)), below)
    };
    (0..mesh.triangles().len()).map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

pub fn vector(rng: &mut ChaCha8Rng) -> Vec3 {
    Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)))
}
