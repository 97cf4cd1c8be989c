//! Affine maps (affine transformations) of space, `p -> linear p + translation`, acting on column vectors.

use crate::{Mat3, UNIT_ROUNDOFF, Vec3, sin_cos_degrees};

/// An affine map of space: `p -> linear * p + translation`.
///
/// Variables that hold a map are named after the frames that it joins, e.g. `world_from_local`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine {
    /// The linear part.
    pub linear: Mat3,
    /// The image of the origin.
    pub translation: Vec3,
}

/// Error: an affine map has no usable inverse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum SingularError {
    /// An entry is NaN or infinite.
    NotFinite,
    /// The linear part is singular, or so ill-conditioned that its inverse has too few correct digits.
    Singular,
}

impl std::fmt::Display for SingularError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            SingularError::NotFinite => {
                write!(f, "the transform has an entry that is NaN or infinite")
            }
            SingularError::Singular => {
                write!(f, "the transform is singular: it has no inverse. Check for a scale factor of 0.")
            }
        }
    }
}

impl std::error::Error for SingularError {}

impl Affine {
    /// The identity map.
    pub const IDENTITY: Affine = Affine { linear: Mat3::IDENTITY, translation: Vec3::ZERO };

    /// The translation by a vector.
    pub fn translate(by: Vec3) -> Affine {
        Affine { linear: Mat3::IDENTITY, translation: by }
    }

    /// Scaling about the origin by one factor per axis; negative factors mirror.
    pub fn scale(factors: Vec3) -> Affine {
        Affine { linear: Mat3::from_diagonal(factors), translation: Vec3::ZERO }
    }

    /// The map with this linear part and no translation.
    pub fn from_linear(linear: Mat3) -> Affine {
        Affine { linear, translation: Vec3::ZERO }
    }

    /// Right-handed rotation about an axis through the origin, which need not be of unit length, by an
    /// angle in degrees (Rodrigues' formula). Quarter turns about coordinate axes are exact. A zero axis gives NaN entries.
    pub fn rotation(axis: Vec3, degrees: f64) -> Affine {
        let (sin, cos) = sin_cos_degrees(degrees);
        let u = unit(axis);
        // exact for coordinate axes, where c + u^2 (1 - c) would not always round to 1
        let on = |a: f64| {
            if a * a == 1.0 { 1.0 } else { cos + a * a * (1.0 - cos) }
        };
        let (xy, yz, zx) = (u.x * u.y * (1.0 - cos), u.y * u.z * (1.0 - cos), u.z * u.x * (1.0 - cos));
        Affine::from_linear(Mat3::from_cols(
            Vec3::new(on(u.x), xy + u.z * sin, zx - u.y * sin),
            Vec3::new(xy - u.z * sin, on(u.y), yz + u.x * sin),
            Vec3::new(zx + u.y * sin, yz - u.x * sin, on(u.z)),
        ))
    }

    /// Reflection in the plane through the origin with the given normal, which need not be of unit length
    /// (Householder reflection). A zero normal gives NaN entries.
    pub fn mirror(normal: Vec3) -> Affine {
        let n = unit(normal);
        Affine::from_linear(Mat3::from_cols(
            Vec3::X - 2.0 * n.x * n,
            Vec3::Y - 2.0 * n.y * n,
            Vec3::Z - 2.0 * n.z * n,
        ))
    }

    /// Converts from the rows of a 4 x 4 matrix that acts on columns. `None` if the last row is not (0, 0, 0, 1).
    pub fn from_rows(rows: &[[f64; 4]; 4]) -> Option<Affine> {
        if rows[3] != [0.0, 0.0, 0.0, 1.0] {
            return None;
        }
        let column = |k: usize| Vec3::new(rows[0][k], rows[1][k], rows[2][k]);
        Some(Affine { linear: Mat3::from_cols(column(0), column(1), column(2)), translation: column(3) })
    }

    /// The rows of the 4 x 4 matrix that acts on columns.
    pub fn to_rows(&self) -> [[f64; 4]; 4] {
        let (x, y, z, t) = (self.linear.x_axis, self.linear.y_axis, self.linear.z_axis, self.translation);
        [[x.x, y.x, z.x, t.x], [x.y, y.y, z.y, t.y], [x.z, y.z, z.z, t.z], [0.0, 0.0, 0.0, 1.0]]
    }

    /// The image of a point.
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.linear * p + self.translation
    }

    /// The image of a vector (a difference of points).
    pub fn vector(&self, v: Vec3) -> Vec3 {
        self.linear * v
    }

    /// The composition `p -> outer(self(p))`: this map first, `outer` second.
    pub fn then(&self, outer: &Affine) -> Affine {
        Affine { linear: outer.linear * self.linear, translation: outer.point(self.translation) }
    }

    /// The inverse map.
    ///
    /// A linear part L counts as singular if its condition number `|L| |L^-1|` (Frobenius norms) exceeds 2^40: the inverse then
    /// has fewer than 13 correct bits. Scaling by 1e-11 along one axis is still accepted; uniform scales of any size are well
    /// conditioned.
    ///
    /// # Errors
    /// [`SingularError`]: an entry is not finite, or the linear part is singular.
    pub fn inverse(&self) -> Result<Affine, SingularError> {
        if !self.is_finite() {
            return Err(SingularError::NotFinite);
        }
        if self.has_identity_linear() {
            // the result of the general case, bit for bit
            return Ok(Affine { linear: self.linear, translation: -(self.linear * self.translation) });
        }
        self.general_inverse()
    }

    fn general_inverse(&self) -> Result<Affine, SingularError> {
        let size = frobenius(&self.linear);
        if size == 0.0 {
            return Err(SingularError::Singular);
        }
        // scaling first keeps the determinant of a tiny or huge map within range; a power of two changes no digit
        let scale = libm::ldexp(1.0, (-libm::ilogb(size)).min(1000));
        let inverse = (self.linear * scale).inverse() * scale;
        if !inverse.is_finite() || size * frobenius(&inverse) > 2f64.powi(40) {
            return Err(SingularError::Singular);
        }
        Ok(Affine { linear: inverse, translation: -(inverse * self.translation) })
    }

    /// True if the linear part has the bits of the identity: a negative zero is not one of them.
    pub(crate) fn has_identity_linear(&self) -> bool {
        let bits = |linear: &Mat3| linear.to_cols_array().map(f64::to_bits);
        bits(&self.linear) == bits(&Mat3::IDENTITY)
    }

    /// True if no entry is NaN or infinite.
    pub fn is_finite(&self) -> bool {
        self.linear.is_finite() && self.translation.is_finite()
    }

    /// The scale factor `s > 0` if the linear part is a similarity: `L^T L = s^2 I` within 64 unit roundoffs.
    ///
    /// Rotations computed from sines and cosines and composed a few times pass; a shear or a stretch by one part in 1e13 does
    /// not.
    pub fn similarity(&self) -> Option<f64> {
        let gram = self.linear.transpose() * self.linear;
        let square = (gram.x_axis.x + gram.y_axis.y + gram.z_axis.z) / 3.0;
        let off = gram - Mat3::from_diagonal(Vec3::splat(square));
        let worst = off.to_cols_array().iter().fold(0.0f64, |w, e| w.max(e.abs()));
        (square > 0.0 && worst <= 64.0 * UNIT_ROUNDOFF * square).then(|| {
            // snapping to a power of two keeps the bits of radii under rotations, and the digits under rotations with a
            // scale by a power of two
            let root = square.sqrt();
            let power = libm::ldexp(1.0, libm::ilogb(root * std::f64::consts::SQRT_2));
            if (root - power).abs() <= 8.0 * UNIT_ROUNDOFF * power { power } else { root }
        })
    }

    /// The scale factor `s > 0` if the map is a uniform scale and a translation without rotation. Directions then keep every
    /// bit.
    pub fn uniform_scale(&self) -> Option<f64> {
        let s = self.linear.x_axis.x;
        (s > 0.0 && self.linear == Mat3::from_diagonal(Vec3::splat(s))).then_some(s)
    }

    /// The Frobenius norm of the linear part: an upper bound of the factor by which it lengthens a vector.
    pub fn linear_norm(&self) -> f64 {
        frobenius(&self.linear)
    }
}

/// The unit vector along `v`, exact where `v` lies on a coordinate axis; NaN for a zero vector.
///
/// The vector is scaled by its largest component first, so that no square over- or underflows.
pub fn unit(v: Vec3) -> Vec3 {
    let scaled = v / v.abs().max_element();
    scaled / scaled.length()
}

fn frobenius(m: &Mat3) -> f64 {
    let largest = m.to_cols_array().iter().fold(0.0f64, |w, e| w.max(e.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    if largest < f64::MIN_POSITIVE {
        // 1 / largest may overflow
        let up = libm::ldexp(1.0, 200);
        return frobenius(&(*m * up)) / up;
    }
    let scaled = *m * (1.0 / largest);
    let squares =
        scaled.x_axis.length_squared() + scaled.y_axis.length_squared() + scaled.z_axis.length_squared();
    largest * squares.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_are_right_handed_and_quarter_turns_exact() {
        assert_eq!(Affine::rotation(Vec3::X, 90.0).point(Vec3::Y), Vec3::Z);
        assert_eq!(Affine::rotation(Vec3::Y, 90.0).point(Vec3::Z), Vec3::X);
        assert_eq!(Affine::rotation(Vec3::Z, 90.0).point(Vec3::X), Vec3::Y);
        assert_eq!(Affine::rotation(Vec3::Z, 33.0).linear.z_axis, Vec3::Z);
        let third = Affine::rotation(Vec3::ONE, 120.0).point(Vec3::X);
        assert!((third - Vec3::Y).length() < 4e-16);
    }

    #[test]
    fn mirror_and_rows() {
        assert_eq!(Affine::mirror(Vec3::new(0.0, 0.0, 2.0)).point(Vec3::ONE), Vec3::new(1.0, 1.0, -1.0));
        let map = Affine::rotation(Vec3::new(1.0, 2.0, 3.0), 77.0).then(&Affine::translate(Vec3::ONE));
        assert_eq!(Affine::from_rows(&map.to_rows()), Some(map));
        assert_eq!(Affine::from_rows(&[[0.0; 4]; 4]), None);
    }

    #[test]
    fn translations_have_the_inverse_of_the_general_case() {
        for x in [0.0, -0.0, 1.5, -3e-300] {
            for y in [0.0, -0.0, 7.0] {
                let map = Affine::translate(Vec3::new(x, y, -x));
                let bits = |map: Affine| map.to_rows().map(|row| row.map(f64::to_bits));
                assert_eq!(map.inverse().map(bits), map.general_inverse().map(bits));
            }
        }
    }

    #[test]
    fn inverse_undoes_the_map_and_rejects_singular_ones() {
        for size in [1e-100, 1e-8, 1.0, 1e8, 1e100] {
            let map = Affine::scale(Vec3::new(size, 2.0 * size, 3.0 * size))
                .then(&Affine::rotation(Vec3::new(3.0, 1.0, 2.0), 12.0))
                .then(&Affine::translate(Vec3::new(size, 0.0, 5.0 * size)));
            let there = map.inverse().unwrap();
            let p = Vec3::new(0.3, -0.7, 1.1);
            assert!((there.point(map.point(p)) - p).length() < 1e-14);
        }
        assert_eq!(Affine::scale(Vec3::new(1.0, 0.0, 1.0)).inverse(), Err(SingularError::Singular));
        assert_eq!(Affine::scale(Vec3::new(1.0, f64::NAN, 1.0)).inverse(), Err(SingularError::NotFinite));
        assert_eq!(Affine::scale(Vec3::ZERO).inverse(), Err(SingularError::Singular));
        // subnormal numbers, whose inverses overflow
        for tiny in [5e-324, 1e-310] {
            assert_eq!(Affine::scale(Vec3::splat(tiny)).inverse(), Err(SingularError::Singular));
            let length = Affine::scale(Vec3::new(tiny, 0.0, 0.0)).linear_norm();
            assert!((length - tiny).abs() <= 5e-324, "{length:e}");
        }
        assert_eq!(Affine::rotation(Vec3::ZERO, 10.0).inverse(), Err(SingularError::NotFinite));
    }

    #[test]
    fn scales_by_powers_of_two_are_exact() {
        let turn = Affine::rotation(Vec3::new(1.0, -2.0, 0.5), 12.3);
        for factor in [2f64.powi(-900), 2f64.powi(-30), 0.5, 1.0, 1024.0, 2f64.powi(400)] {
            let map = turn.then(&Affine::scale(Vec3::splat(factor)));
            let inverse = turn.inverse().unwrap().linear * (1.0 / factor);
            assert_eq!(map.inverse().unwrap().linear, inverse);
            if factor > 1e-150 {
                assert_eq!(map.similarity(), Some(factor));
            }
            let plain = Affine::scale(Vec3::splat(factor)).then(&Affine::translate(Vec3::ONE));
            assert_eq!((plain.uniform_scale(), map.uniform_scale()), (Some(factor), None));
        }
    }

    #[test]
    fn similarity_accepts_rotations_and_rejects_shears() {
        let turn = Affine::rotation(Vec3::new(1.0, -2.0, 0.5), 12.3);
        assert_eq!(turn.similarity(), Some(1.0));
        assert_eq!(Affine::scale(Vec3::splat(-2.0)).similarity(), Some(2.0));
        assert_eq!(Affine::scale(Vec3::new(1.0, 1.0, 1.0 + 1e-12)).similarity(), None);
        let shear = Affine::from_linear(Mat3::from_cols(Vec3::X, Vec3::new(1e-12, 1.0, 0.0), Vec3::Z));
        assert_eq!(shear.similarity(), None);
    }
}
