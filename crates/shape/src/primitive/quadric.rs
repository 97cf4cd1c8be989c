//! The inside of a quadric, a surface of the second degree.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `matrix` | 4 rows of 4 numbers | none | finite |  | symmetric matrix Q of the equation |
//!
//! Inside: `[x y z 1] Q [x y z 1]^T < 0`.
//!
//! Face: `side`.
//!
//! With A the upper left 3 x 3 block, b the first three entries of the last column and c the last entry, a point p is
//! inside if p^T A p + 2 b . p + c < 0. A positive factor of Q has no effect; a negative one swaps inside and outside.
//! Q must be symmetric; asymmetry within rounding (64 units in the last place of its largest entry) is averaged.
//!
//! Degenerate matrices are allowed: pairs of planes (a slab or two wedges), cylinders over any conic, cones. If A is
//! 0 the solid is a half-space, and if b is 0 too, the universe (c < 0) or empty (c >= 0), without a face. Other
//! quadrics may also be empty.
//!
//! The bounds are the smallest ones: finite for ellipsoids, and along the axes along which cylinders, paraboloids and
//! slabs are bounded. An eigenvalue of A that is indistinguishable from 0 counts as 0.

use super::half_space::check_plane;
use super::shape::between;
use super::{
    Arguments, Facet, Lowered, Parameter, ParameterKind, ParameterUnit, Range, Shape, ShapeError, Value,
};
use crate::surface::Surface;
use rayweave_math::{UNIT_ROUNDOFF, Vec3};

/// The inside of a surface of the second degree: [the manual page](self).
#[derive(Clone, Debug, PartialEq)]
pub struct Quadric {
    // boxed, since each node of a tree of solids has room for the largest primitive
    matrix: Box<[[f64; 4]; 4]>,
}

impl Quadric {
    /// The points with `[x y z 1] matrix [x y z 1]^T < 0`.
    pub fn new(matrix: [[f64; 4]; 4]) -> Result<Quadric, ShapeError> {
        Quadric { matrix: Box::new(matrix) }.validated()
    }

    /// The exactly symmetric matrix, scaled if its entries are near the ends of the range of `f64`.
    fn symmetric(&self) -> [[f64; 4]; 4] {
        let (q, largest) = (&self.matrix, self.largest());
        let usual = largest == 0.0 || (1e-100..1e100).contains(&largest);
        let scale = if usual { 1.0 } else { largest };
        let entry = |i: usize, j: usize| 0.5 * (q[i][j] / scale) + 0.5 * (q[j][i] / scale);
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }

    fn largest(&self) -> f64 {
        let entries = self.matrix.iter().flatten();
        entries.fold(0.0, |size, entry| size.max(entry.abs()))
    }
}

/// The normal and the offset of `normal . p < offset`, if A is 0.
fn linear_part(q: &[[f64; 4]; 4]) -> Option<(Vec3, f64)> {
    let linear = q[..3].iter().all(|row| row[..3].iter().all(|&entry| entry == 0.0));
    linear.then(|| (2.0 * Vec3::new(q[0][3], q[1][3], q[2][3]), -q[3][3]))
}

impl Shape for Quadric {
    const NAME: &'static str = "quadric";
    const EQUATION: &'static str = "[x y z 1] Q [x y z 1]^T < 0";
    const PARAMETERS: &'static [Parameter] = &[Parameter::new(
        "matrix",
        ParameterKind::Matrix4,
        ParameterUnit::None,
        Range::Finite,
        "symmetric matrix Q of the equation",
    )];
    const FACES: &'static [&'static str] = &["side"];

    fn from_arguments(arguments: &Arguments) -> Result<Quadric, ShapeError> {
        Quadric::new(arguments.matrix("matrix"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        vec![("matrix", self.matrix.as_slice().into())]
    }

    fn consistent(&self) -> Result<(), ShapeError> {
        let (q, noise) = (&self.matrix, 128.0 * UNIT_ROUNDOFF * self.largest());
        let pairs = (0..4).flat_map(|row| (row + 1..4).map(move |column| (row, column)));
        for (row, column) in pairs {
            let (value, mirrored) = (q[row][column], q[column][row]);
            if (value - mirrored).abs() > noise {
                return Err(ShapeError::NotSymmetric {
                    shape: Self::NAME,
                    parameter: "matrix",
                    row,
                    column,
                    value,
                    mirrored,
                });
            }
        }
        match linear_part(&self.symmetric()) {
            Some((normal, offset)) if normal != Vec3::ZERO => {
                check_plane(Self::NAME, "matrix", vec![3, 3], normal, offset)
            }
            _ => Ok(()),
        }
    }

    fn lower(&self) -> Lowered {
        let q = self.symmetric();
        match Surface::quadric(&q) {
            Some(surface) => {
                let bounds = surface.inside_bounds();
                Lowered::conjunction(vec![Facet::inside("side", surface)], bounds)
            }
            None if q[3][3] < 0.0 => Lowered::everything(),
            None => Lowered::nothing(),
        }
    }

    fn example() -> Quadric {
        // a hyperboloid of one sheet about z, like a cooling tower
        Quadric {
            matrix: Box::new([
                [1.0, 0.0, 0.0, 0.0],
                [0.0, 1.0, 0.0, 0.0],
                [0.0, 0.0, -0.5, 0.0],
                [0.0, 0.0, 0.0, -0.2],
            ]),
        }
    }

    fn random(rng: &mut dyn FnMut() -> f64) -> Quadric {
        let mut matrix = [[0.0; 4]; 4];
        for k in 0..3 {
            // probabilities out of ten: six positive, two negative, two zero
            matrix[k][k] = match (10.0 * rng()) as u32 {
                0..6 => between(rng, 0.4, 3.0),
                6..8 => -between(rng, 0.4, 3.0),
                _ => 0.0,
            };
        }
        for (i, j) in [(0, 1), (0, 2), (1, 2), (0, 3), (1, 3), (2, 3)] {
            if rng() < 0.4 {
                matrix[i][j] = between(rng, -0.3, 0.3);
                matrix[j][i] = matrix[i][j];
            }
        }
        matrix[3][3] = between(rng, -1.0, 0.1);
        Quadric { matrix: Box::new(matrix) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, message, uniform};
    use super::*;
    use rayweave_math::{Affine, Bounds, Mat3};

    const INF: f64 = f64::INFINITY;

    /// The matrix of the image of a quadric with diagonal form under a map.
    fn matrix(diagonal: [f64; 4], linear: Vec3, map: &Affine) -> [[f64; 4]; 4] {
        let inverse = map.inverse().unwrap();
        let (m, t) = (inverse.linear, inverse.translation);
        let a = Mat3::from_diagonal(Vec3::new(diagonal[0], diagonal[1], diagonal[2]));
        let block = m.transpose() * a * m;
        let b = m.transpose() * (a * t + linear);
        let c = t.dot(a * t) + 2.0 * linear.dot(t) + diagonal[3];
        let entry = |i: usize, j: usize| match (i, j) {
            (3, 3) => c,
            (3, j) => b[j],
            (i, 3) => b[i],
            _ => 0.5 * (block.col(j)[i] + block.col(i)[j]),
        };
        std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
    }

    fn bounds(diagonal: [f64; 4], linear: Vec3, map: &Affine) -> Bounds {
        let q = matrix(diagonal, linear, map);
        Quadric::new(q).unwrap().lower().bounds
    }

    #[test]
    fn the_form_decides() {
        let mut rng = uniform(8);
        for _ in 0..300 {
            let solid = Quadric::random(&mut rng);
            let q = &solid.matrix;
            let form = |p: Vec3| {
                let v = [p.x, p.y, p.z, 1.0];
                (0..16).map(|k| v[k / 4] * q[k / 4][k % 4] * v[k % 4]).sum::<f64>()
            };
            let lowered = solid.lower();
            for _ in 0..200 {
                let p = Vec3::new(rng(), rng(), rng()) * 8.0 - Vec3::splat(4.0);
                assert_eq!(lowered.contains(p), form(p) < 0.0, "{p} in {solid:?}");
            }
        }
    }

    #[test]
    fn every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            let map = Affine::scale(Vec3::splat(scale));
            let tower = Quadric::new(matrix([1.0, 1.0, -0.5, -0.2], Vec3::ZERO, &map)).unwrap();
            check_inside(&tower, Vec3::splat(scale), |p| {
                let p = p / scale;
                p.x * p.x + p.y * p.y - 0.5 * p.z * p.z < 0.2
            });
        }
    }

    /// The half extent of an ellipsoid along an axis is the length of that row of rotation times radii.
    #[test]
    fn bounds_of_turned_ellipsoids() {
        let mut rng = uniform(9);
        for _ in 0..200 {
            let radii = Vec3::new(0.2 + rng(), 0.2 + rng(), 0.2 + rng());
            let axis = Vec3::new(rng() - 0.5, rng() - 0.5, rng() - 0.5);
            let turn = Affine::rotation(axis, 360.0 * rng());
            let shift = Vec3::new(rng(), rng(), rng());
            let d = [radii.x.powi(-2), radii.y.powi(-2), radii.z.powi(-2), -1.0];
            let found = bounds(d, Vec3::ZERO, &turn.then(&Affine::translate(shift)));
            let rows = turn.linear.transpose();
            let half = Vec3::from_array([0, 1, 2].map(|k| (rows.col(k) * radii).length()));
            let error = (found.lo - (shift - half)).abs().max((found.hi - (shift + half)).abs());
            assert!(error.max_element() < 1e-13, "{found:?} {half}");
        }
    }

    #[test]
    fn bounds_of_cylinders_and_paraboloids_along_an_axis() {
        let shift = Affine::translate(Vec3::new(1.0, 2.0, 3.0));
        let pillar = bounds([1.0, 0.25, 0.0, -1.0], Vec3::ZERO, &shift);
        let inside = Bounds::new(Vec3::new(0.0, 0.0, -INF), Vec3::new(2.0, 4.0, INF));
        assert!((pillar.lo - inside.lo).truncate().length() < 1e-14 && pillar.lo.z == -INF);
        assert!((pillar.hi - inside.hi).truncate().length() < 1e-14 && pillar.hi.z == INF);
        let bowl = bounds([1.0, 1.0, 0.0, 0.0], Vec3::new(0.0, 0.0, -0.5), &Affine::IDENTITY);
        assert_eq!(bowl, Bounds::new(Vec3::new(-INF, -INF, 0.0), Vec3::INFINITY));
        // sheared: z > x^2 + y^2 becomes z > x^2 + y^2 + x, whose lowest point is at x = -1/2
        let mut q = matrix([1.0, 1.0, 0.0, 0.0], Vec3::new(0.0, 0.0, -0.5), &Affine::IDENTITY);
        (q[0][3], q[3][0]) = (0.5, 0.5);
        assert_eq!(Quadric::new(q).unwrap().lower().bounds.lo, Vec3::new(-INF, -INF, -0.25));
        // a slab, and a parabolic cylinder across two axes
        let slab = bounds([0.0, 4.0, 0.0, -1.0], Vec3::ZERO, &Affine::IDENTITY);
        assert_eq!((slab.lo.y, slab.hi.y, slab.hi.x), (-0.5, 0.5, INF));
        let gutter = bounds([1.0, 0.0, 0.0, 0.0], Vec3::new(0.0, -1.0, -1.0), &Affine::IDENTITY);
        assert_eq!(gutter, Bounds::ALL);
    }

    #[test]
    fn bounds_of_what_opens_on_all_sides() {
        let turn = Affine::rotation(Vec3::new(1.0, 2.0, 3.0), 50.0);
        for diagonal in
            [[1.0, 1.0, -1.0, -1.0], [1.0, 1.0, -1.0, 1.0], [-1.0, -1.0, -1.0, 1.0], [1.0, -1.0, 0.0, 0.0]]
        {
            assert_eq!(bounds(diagonal, Vec3::ZERO, &Affine::IDENTITY), Bounds::ALL);
            assert_eq!(bounds(diagonal, Vec3::ZERO, &turn), Bounds::ALL);
        }
        // a rotated cylinder: its eigenvalue 0 is indistinguishable from a small one
        assert_eq!(bounds([1.0, 1.0, 0.0, -1.0], Vec3::ZERO, &turn), Bounds::ALL);
    }

    #[test]
    fn nothing_everything_and_half_of_it() {
        let of = |entries: &[(usize, usize, f64)]| {
            let mut q = [[0.0; 4]; 4];
            entries.iter().for_each(|&(i, j, value)| (q[i][j], q[j][i]) = (value, value));
            Quadric::new(q).unwrap().lower()
        };
        assert_eq!(of(&[]), Lowered::nothing());
        assert!(!of(&[(3, 3, 1.0)]).contains(Vec3::ONE) && of(&[(3, 3, 1.0)]).bounds.is_empty());
        assert_eq!(of(&[(3, 3, -1.0)]), Lowered::everything());
        assert!(of(&[(3, 3, -1.0)]).contains(Vec3::ONE));
        let half = of(&[(0, 3, 0.5), (3, 3, -2.0)]);
        assert_eq!((half.facets.len(), half.bounds.hi.x), (1, 2.0));
        assert!(half.contains(Vec3::X * 1.9) && !half.contains(Vec3::X * 2.1));
        let nowhere = of(&[(0, 0, 1.0), (1, 1, 2.0), (2, 2, 1.0), (3, 3, 0.5)]);
        assert!(nowhere.bounds.is_empty() && !nowhere.contains(Vec3::ZERO));
        assert!(of(&[(0, 0, 1.0), (3, 3, 0.5)]).bounds.is_empty());
    }

    #[test]
    fn the_inside_of_a_negative_form_is_outside() {
        let lowered = Quadric::new(matrix([-1.0, -1.0, -1.0, 1.0], Vec3::ZERO, &Affine::IDENTITY));
        let lowered = lowered.unwrap().lower();
        assert!(lowered.contains(Vec3::X * 1.1) && !lowered.contains(Vec3::X * 0.9));
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        let mut q = *Quadric::example().matrix;
        q[1][2] = 0.5;
        assert_eq!(
            message(Quadric::new(q)),
            "quadric: matrix[1][2] is 0.5 but matrix[2][1] is 0: the matrix must be symmetric. Did you mean 0.25 in both places?"
        );
        q[1][2] = 1e-15;
        assert_eq!(message(Quadric::new(q)), "");
        q[2][2] = INF;
        assert_eq!(message(Quadric::new(q)), "quadric: matrix[2][2] is inf: matrix must be finite.");
    }
}
