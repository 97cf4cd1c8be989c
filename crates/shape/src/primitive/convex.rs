//! A convex polyhedron: the points behind all of the given planes.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `planes` | 1 row or more of 4 numbers | none | finite and not all 0 |  | rows (a, b, c, d): outward normal, of any length, and the value of normal . p on the plane |
//!
//! Inside: `a x + b y + c z < d for all rows (a, b, c, d) of planes`.
//!
//! Faces: `face0..faceN-1`, in the order of the rows. Redundant rows are allowed; their faces are empty.
//!
//! The planes need not enclose a bounded solid: it may be unbounded, and it is empty if no point is behind all
//! planes. The first three numbers of a row must not all be 0. The bounds are the smallest ones for up to 64 planes
//! (they may be larger beyond that), and infinite where the solid is unbounded. An empty solid has empty bounds if
//! there are at most 64 planes, if they bound it in every direction, and if they miss a common point by more than
//! one part in 1e9.

use super::half_space::{check_plane, random_normal};
use super::shape::between;
use super::support::polyhedron_bounds;
use super::{
    Arguments, Facet, Lowered, Parameter, ParameterKind, ParameterUnit, Range, Shape, ShapeError, Value,
};
use crate::surface::{Plane, Surface};
use rayweave_math::Vec3;

/// A convex polyhedron from planes: [the manual page](self).
#[derive(Clone, Debug, PartialEq)]
pub struct Convex {
    planes: Vec<[f64; 4]>,
}

impl Convex {
    /// The points with a x + b y + c z < d for all rows (a, b, c, d).
    pub fn new(planes: Vec<[f64; 4]>) -> Result<Convex, ShapeError> {
        Convex { planes }.validated()
    }

    /// The rows (a, b, c, d), one for each face.
    pub fn planes(&self) -> &[[f64; 4]] {
        &self.planes
    }
}

fn split(row: &[f64; 4]) -> (Vec3, f64) {
    (Vec3::new(row[0], row[1], row[2]), row[3])
}

impl Shape for Convex {
    const NAME: &'static str = "convex";
    const EQUATION: &'static str = "a x + b y + c z < d for all rows (a, b, c, d) of planes";
    const PARAMETERS: &'static [Parameter] = &[Parameter::new(
        "planes",
        ParameterKind::Planes,
        ParameterUnit::None,
        Range::Direction,
        "rows (a, b, c, d): outward normal, of any length, and the value of normal . p on the plane",
    )];
    const FACES: &'static [&'static str] = &["face0..faceN-1"];

    fn from_arguments(arguments: &Arguments) -> Result<Convex, ShapeError> {
        Convex::new(arguments.rows("planes"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("planes", self.planes.as_slice().into())]
    }

    fn consistent(&self) -> Result<(), ShapeError> {
        self.planes.iter().enumerate().try_for_each(|(i, row)| {
            let (normal, offset) = split(row);
            check_plane(Self::NAME, "planes", vec![i, 3], normal, offset)
        })
    }

    fn lower(&self) -> Lowered {
        let facet = |(i, row): (usize, &[f64; 4])| {
            let (normal, offset) = split(row);
            Facet::inside(format!("face{i}"), Surface::plane(normal, offset))
        };
        let unit = |row: &[f64; 4]| Plane::new(split(row).0, split(row).1);
        let planes: Vec<Plane> = self.planes.iter().map(unit).collect();
        Lowered::conjunction(self.planes.iter().enumerate().map(facet).collect(), polyhedron_bounds(&planes))
    }

    fn example() -> Convex {
        let signs = (0..8).map(|k: u32| [0, 1, 2].map(|bit| f64::from(1 - 2 * (k >> bit & 1) as i32)));
        Convex { planes: signs.map(|[x, y, z]| [x, y, z, 1.0]).collect() }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Convex {
        let count = 1 + (9.0 * rng()) as usize;
        let row = |_| {
            let normal = random_normal(rng);
            [normal.x, normal.y, normal.z, between(rng, 0.3, 1.0)]
        };
        Convex { planes: (0..count).map(row).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_touched, message, uniform};
    use super::*;
    use rayweave_math::{Affine, Bounds, sin_cos_degrees};

    fn bounds(planes: &[[f64; 4]]) -> Bounds {
        Convex::new(planes.to_vec()).unwrap().lower().bounds
    }

    /// The planes of a box, rotated and translated.
    fn turned_box(half: Vec3, map: &Affine) -> Vec<[f64; 4]> {
        let plane = |(axis, h): (Vec3, f64)| {
            let normal = map.vector(axis);
            [normal.x, normal.y, normal.z, h + normal.dot(map.translation)]
        };
        let sides = (0..3).flat_map(|k| [(Vec3::AXES[k], half[k]), (-Vec3::AXES[k], half[k])]);
        sides.map(plane).collect()
    }

    #[test]
    fn an_octahedron_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            let mut solid = Convex::example();
            solid.planes.iter_mut().for_each(|row| row[3] *= scale);
            check_inside(&solid, Vec3::splat(scale), |p| p.abs().element_sum() < scale);
            let axes = Vec3::AXES.map(|axis| scale * axis);
            check_touched(&solid, Vec3::ZERO, &[axes, axes.map(|p| -p)].concat());
        }
    }

    #[test]
    fn bounds_of_turned_boxes_are_those_of_their_corners() {
        let mut rng = uniform(5);
        for scale in [1e-8, 1.0, 1e8] {
            for _ in 0..100 {
                let half = scale * Vec3::new(0.1 + rng(), 0.1 + rng(), 0.1 + rng());
                let axis = Vec3::new(rng() - 0.5, rng() - 0.5, rng() - 0.5);
                let shift = scale * Vec3::new(rng(), rng(), rng());
                let map = Affine::rotation(axis, 360.0 * rng()).then(&Affine::translate(shift));
                let corners = Bounds::centred(Vec3::ZERO, half).corners();
                let direct = corners.iter().fold(Bounds::EMPTY, |bounds, &corner| {
                    let p = map.point(corner);
                    bounds.union(&Bounds::new(p, p))
                });
                let found = bounds(&turned_box(half, &map));
                let error = (found.lo - direct.lo).abs().max((found.hi - direct.hi).abs());
                assert!(error.max_element() < 2e-15 * scale * 3.0, "{found:?} {direct:?}");
            }
        }
    }

    #[test]
    fn a_box_is_exact() {
        let found = bounds(&turned_box(Vec3::new(1.0, 2.0, 3.0), &Affine::IDENTITY));
        assert_eq!(found, Bounds::centred(Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0)));
    }

    #[test]
    fn unbounded_ones_are_infinite_where_they_have_no_end() {
        let inf = f64::INFINITY;
        assert_eq!(bounds(&[[0.0, 0.0, 2.0, 1.0]]).hi, Vec3::new(inf, inf, 0.5));
        assert_eq!(bounds(&[[1.0, 1.0, 0.0, 1.0]]), Bounds::ALL);
        // an inverted pyramid without a lid
        let pyramid =
            [[1.0, 0.0, -1.0, 0.0], [-1.0, 0.0, -1.0, 0.0], [0.0, 1.0, -1.0, 0.0], [0.0, -1.0, -1.0, 0.0]];
        let open = bounds(&pyramid);
        assert_eq!((open.lo, open.hi), (Vec3::new(-inf, -inf, 0.0), Vec3::INFINITY));
        // a beam: four planes parallel to z, rotated
        let beam = bounds(&turned_box(Vec3::ONE, &Affine::rotation(Vec3::Z, 45.0))[..4]);
        assert!((beam.hi.x - 2f64.sqrt()).abs() < 1e-15 && beam.lo.z == -inf);
        // a slab and a plane across it, which together bound one side of another axis
        let gutter = bounds(&[[1.0, 0.0, 1.0, 1.0], [-1.0, 0.0, 1.0, 1.0], [0.0, 1.0, 0.0, 5.0]]);
        assert_eq!(gutter.hi, Vec3::new(inf, 5.0, 1.0));
    }

    /// Two planes that are parallel up to 1e-137 do not bound the direction along both.
    #[test]
    fn nearly_parallel_planes_bound_nothing_along_them() {
        let inf = f64::INFINITY;
        let floors = [[0.0, -1.0, 1e137, 0.0], [0.0, 0.0, 1.0, -0.5]];
        let found = bounds(&floors);
        assert_eq!((found.lo, found.hi.x, found.hi.y), (Vec3::NEG_INFINITY, inf, inf));
        let quadrant = bounds(&[floors[0], floors[1], [-1.0, 0.0, 0.0, 0.0]]);
        assert_eq!((quadrant.lo.x, quadrant.hi.x), (0.0, inf));
    }

    #[test]
    fn empty_ones_have_empty_bounds() {
        assert!(bounds(&[[1.0, 0.0, 0.0, 0.0], [-1.0, 0.0, 0.0, -1.0]]).is_empty());
        // a box and a plane that leaves nothing of it, but does not separate it along the coordinate axes
        let mut planes = turned_box(Vec3::ONE, &Affine::IDENTITY);
        planes.push([1.0, 1.0, 1.0, -3.1]);
        assert!(bounds(&planes).is_empty());
        planes[6] = [1.0, 1.0, 1.0, -2.9];
        assert!(!bounds(&planes).is_empty());
        // only a point is left: indistinguishable from a very small solid
        planes[6] = [1.0, 1.0, 1.0, -3.0];
        assert!(!bounds(&planes).is_empty());
    }

    /// Tangent planes of a ball: with many planes the bounds are close to those of the ball, and never inside them.
    #[test]
    fn many_planes() {
        let mut rng = uniform(6);
        for count in [40, 64, 300, 1000] {
            let normal = || Vec3::new(rng() - 0.5, rng() - 0.5, rng() - 0.5).normalize();
            let normals: Vec<Vec3> = std::iter::repeat_with(normal).take(count).collect();
            let found = bounds(&normals.iter().map(|n| [n.x, n.y, n.z, 1.0]).collect::<Vec<_>>());
            let reach = found.hi.max(-found.lo);
            assert!(reach.min_element() >= 1.0 && reach.max_element() < 1.6, "{count} {found:?}");
        }
    }

    /// The vertices of random polyhedra, from all triples of planes: an independent computation of the bounds.
    #[test]
    fn bounds_are_those_of_the_vertices() {
        let mut rng = uniform(7);
        for _ in 0..200 {
            let mut planes = turned_box(Vec3::splat(2.0), &Affine::IDENTITY);
            planes.extend((0..8).map(|_| {
                let n = Vec3::new(rng() - 0.5, rng() - 0.5, rng() - 0.5).normalize();
                [n.x, n.y, n.z, 0.2 + rng()]
            }));
            let (direct, found) = (vertex_bounds(&planes), bounds(&planes));
            let error = (found.lo - direct.lo).abs().max((found.hi - direct.hi).abs());
            assert!(error.max_element() < 1e-12, "{found:?} {direct:?}");
        }
    }

    /// The rings (radius, height) of a solid of revolution with the given number of sides, rotated by angles about z and x.
    fn ring_vertices(rings: &[[f64; 2]], sides: usize, [about_z, about_x]: [f64; 2]) -> Vec<Vec<Vec3>> {
        let turn = |p: Vec3| {
            let ((s, c), (t, d)) = (sin_cos_degrees(about_z), sin_cos_degrees(about_x));
            let p = Vec3::new(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
            Vec3::new(p.x, d * p.y - t * p.z, t * p.y + d * p.z)
        };
        let corner = |[radius, z]: [f64; 2], k: usize| {
            let (sin, cos) = sin_cos_degrees(360.0 * k as f64 / sides as f64);
            turn(Vec3::new(radius * cos, radius * sin, z))
        };
        rings.iter().map(|ring| (0..sides).map(|k| corner(*ring, k)).collect()).collect()
    }

    /// The plane through three points, oriented away from the origin.
    fn plane_through([a, b, c]: [Vec3; 3]) -> [f64; 4] {
        let n = (b - a).cross(c - a).normalize();
        let n = if n.dot(a) < 0.0 { -n } else { n };
        [n.x, n.y, n.z, n.dot(a)]
    }

    /// Opposite faces, and whole belts of faces parallel to one line, with normals that differ by roundings: their
    /// combinations give no valid bounds.
    #[test]
    fn bounds_of_symmetric_polyhedra_are_those_of_their_corners() {
        let shapes: [&[[f64; 2]]; 4] = [
            &[[0.0, -1.0], [1.0, 0.0], [0.0, 1.0]],
            &[[1.0, -1.0], [1.0, 1.0]],
            &[[0.5, -0.8], [1.0, 0.0], [0.5, 0.8]],
            &[[0.3, -0.9], [0.8, -0.5], [0.8, 0.5], [0.3, 0.9]],
        ];
        let angles = [[0.0, 0.0], [17.0, 0.0], [0.0, 90.0], [45.0, 0.0], [0.0, 45.0], [40.0, 30.0]];
        let sides = [3, 4, 5, 6, 8, 10, 12, 16, 20];
        for (shape, sides) in shapes.iter().flat_map(|shape| sides.map(|sides| (shape, sides))) {
            for (angles, scale) in
                angles.iter().flat_map(|angles| [0.1, 0.5, 3.0, 100.0].map(|s| (angles, s)))
            {
                let rings: Vec<[f64; 2]> = shape.iter().map(|ring| ring.map(|x| scale * x)).collect();
                let corners = ring_vertices(&rings, sides, *angles);
                let mut planes = Vec::new();
                for (low, high) in corners.iter().zip(&corners[1..]) {
                    planes.extend((0..sides).map(|k| match low[0] == low[1] {
                        true => plane_through([low[0], high[k], high[(k + 1) % sides]]),
                        false => plane_through([low[k], low[(k + 1) % sides], high[k]]),
                    }));
                }
                let caps =
                    [&corners[0], &corners[corners.len() - 1]].into_iter().filter(|cap| cap[0] != cap[1]);
                planes.extend(caps.map(|cap| plane_through([cap[0], cap[1], cap[2]])));
                let found = bounds(&planes);
                let all = corners.concat().into_iter();
                let truth = all.fold(Bounds::EMPTY, |bounds, p| bounds.union(&Bounds::new(p, p)));
                let error = (found.lo - truth.lo).abs().max((found.hi - truth.hi).abs());
                let what = format!("{sides} {angles:?} {scale} {found:?} {truth:?}");
                assert!(planes.len() > 64 || error.max_element() < 1e-12 * scale, "{what}");
                assert!(found.lo.cmple(truth.lo + 1e-12 * scale).all(), "{what}");
                assert!(found.hi.cmpge(truth.hi - 1e-12 * scale).all(), "{what}");
            }
        }
    }

    fn vertex_bounds(planes: &[[f64; 4]]) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        for i in 0..planes.len() {
            for j in 0..i {
                for k in 0..j {
                    let rows = [i, j, k].map(|i| split(&planes[i]));
                    let [a, b, c] = rows.map(|(normal, _)| normal);
                    let matrix = rayweave_math::Mat3::from_cols(a, b, c).transpose();
                    let p = matrix.inverse() * Vec3::from_array(rows.map(|(_, offset)| offset));
                    if planes.iter().all(|row| split(row).0.dot(p) <= row[3] + 1e-12) {
                        bounds = bounds.union(&Bounds::new(p, p));
                    }
                }
            }
        }
        bounds
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        assert_eq!(
            message(Convex::new(vec![])),
            "convex: planes is an empty list: planes must be 1 row or more of 4 numbers. Are there too few or too many numbers?"
        );
        assert_eq!(
            message(Convex::new(vec![[1.0, 0.0, 0.0, 1.0], [0.0, 0.0, 0.0, 1.0]])),
            "convex: planes[1] has length zero: a normal must have a direction. Did you mean [0, 0, 1]?"
        );
        assert_eq!(
            message(Convex::new(vec![[1.0, 0.0, f64::INFINITY, 1.0]])),
            "convex: planes[0][2] is inf: planes must be finite and not all 0."
        );
        assert_eq!(
            message(Convex::new(vec![[1e-100, 0.0, 0.0, 1.0]])),
            "convex: planes[0][3] is 1e100: only lengths from 1e-60 to 1e60 are supported. Is the unit right?"
        );
    }
}
