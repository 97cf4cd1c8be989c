//! Affine maps (affine transformations) of R^d, `p -> linear * p + translation`, acting on column vectors.

use crate::Point;
use crate::error::{SpaceError, check};
use crate::point::{add_scaled, dot, is_finite, length};
use crate::vector::{axis_vector, largest, padded};
use rayweave_math::{SingularError, sin_cos_degrees};
use std::array::from_fn;

/// An invertible affine map of R^d.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Affine<const D: usize> {
    /// The rows of the linear part.
    linear: [Point<D>; D],
    /// The image of the origin.
    translation: Point<D>,
}

impl<const D: usize> Affine<D> {
    /// The identity map.
    pub fn identity() -> Self {
        Affine { linear: from_fn(axis_vector), translation: [0.0; D] }
    }

    /// The map with these rows of the matrix, which acts on columns, and this image of the origin.
    ///
    /// # Errors
    /// `NotFinite`, and `Map` if the matrix is singular or ill-conditioned: see [`Affine::inverse`].
    pub fn new(matrix: [Point<D>; D], translation: Point<D>) -> Result<Self, SpaceError> {
        for (i, row) in matrix.iter().enumerate() {
            row.iter().enumerate().try_for_each(|(j, &x)| check::finite("matrix", &[i, j], x))?;
        }
        check::point("translation", &translation)?;
        let map = Affine { linear: matrix, translation };
        map.inverse()?;
        Ok(map)
    }

    /// The translation by a vector.
    ///
    /// # Errors
    /// `NotFinite` or `Extreme` for the first invalid component.
    pub fn translation(by: Point<D>) -> Result<Self, SpaceError> {
        check::point("translation", &by)?;
        Ok(Affine { translation: by, ..Self::identity() })
    }

    /// Scaling about the origin by one factor per axis; negative factors mirror.
    ///
    /// # Errors
    /// `NotFinite`, and `Map` if a factor is 0 or they differ too much.
    pub fn scale(factors: Point<D>) -> Result<Self, SpaceError> {
        let row = |i: usize| from_fn(|j| if i == j { factors[i] } else { 0.0 });
        Affine::new(from_fn(row), [0.0; D])
    }

    /// Rotation in a coordinate plane by an angle in degrees, from axis `from` towards axis `to`; in space, the rotation from
    /// x to y is the one about z. Quarter turns are exact.
    ///
    /// # Errors
    /// `Axis` or `SameAxis`, `NotFinite` for the angle.
    pub fn rotation(from: usize, to: usize, degrees: f64) -> Result<Self, SpaceError> {
        check_axis::<D>(from)?;
        check_axis::<D>(to)?;
        check::finite("degrees", &[], degrees)?;
        if from == to {
            return Err(SpaceError::SameAxis { axis: from });
        }
        let (sin, cos) = sin_cos_degrees(degrees);
        let mut map = Self::identity();
        (map.linear[from][from], map.linear[to][to]) = (cos, cos);
        (map.linear[to][from], map.linear[from][to]) = (sin, -sin);
        Ok(map)
    }

    /// The rows of the linear part.
    pub fn matrix(&self) -> &[Point<D>; D] {
        &self.linear
    }

    /// The image of the origin.
    pub fn offset(&self) -> &Point<D> {
        &self.translation
    }

    /// The image of a point.
    pub fn point(&self, p: &Point<D>) -> Point<D> {
        from_fn(|i| dot(&self.linear[i], p) + self.translation[i])
    }

    /// The image of a vector (a difference of points).
    pub fn vector(&self, v: &Point<D>) -> Point<D> {
        from_fn(|i| dot(&self.linear[i], v))
    }

    /// The product of the transposed linear part and a vector. Gradients transform by this product of the *inverse* map.
    pub fn covector(&self, v: &Point<D>) -> Point<D> {
        from_fn(|j| (0..D).fold(0.0, |sum, i| sum + self.linear[i][j] * v[i]))
    }

    /// The map extended to a space of more dimensions; it keeps the additional coordinates.
    pub(crate) fn extruded<const N: usize>(&self) -> Affine<N> {
        let mut map = Affine::<N> { translation: padded(&self.translation), ..Affine::identity() };
        for (wide, row) in map.linear.iter_mut().zip(&self.linear) {
            *wide = padded(row);
        }
        map
    }

    /// The composition: this map first, `outer` second.
    pub fn then(&self, outer: &Self) -> Self {
        let entry = |i: usize, j: usize| (0..D).fold(0.0, |s, k| s + outer.linear[i][k] * self.linear[k][j]);
        Affine { linear: from_fn(|i| from_fn(|j| entry(i, j))), translation: outer.point(&self.translation) }
    }

    /// The scale factor `s > 0` if the map is a uniform scale and a translation.
    pub fn uniform_scale(&self) -> Option<f64> {
        let s = self.linear[0][0];
        let is_entry = |i: usize, j: usize| self.linear[i][j] == if i == j { s } else { 0.0 };
        (s > 0.0 && (0..D).all(|i| (0..D).all(|j| is_entry(i, j)))).then_some(s)
    }

    /// The inverse map, by Gauss-Jordan elimination with row pivoting (G. H. Golub, C. F. Van Loan, *Matrix Computations*, 4th ed.,
    /// 3.4). A linear part L counts as singular if its condition number `|L| |L^-1|` (Frobenius norms) exceeds 2^40, as for
    /// [`rayweave_math::Affine`]: the inverse would have fewer than 13 correct bits.
    ///
    /// # Errors
    /// [`SingularError`]: an entry is not finite, or the linear part is singular.
    pub fn inverse(&self) -> Result<Self, SingularError> {
        if !self.linear.iter().all(is_finite) || !is_finite(&self.translation) {
            return Err(SingularError::NotFinite);
        }
        let size = self.linear.iter().map(largest).fold(0.0, f64::max);
        if size == 0.0 {
            return Err(SingularError::Singular);
        }
        // scaling by a power of two keeps tiny and huge maps within range
        let scale = libm::ldexp(1.0, (-libm::ilogb(size)).clamp(-1000, 1000));
        let scaled = self.linear.map(|row| row.map(|x| x * scale));
        let inverse = eliminated(scaled).ok_or(SingularError::Singular)?;
        if frobenius(&scaled) * frobenius(&inverse) > 2f64.powi(40) {
            return Err(SingularError::Singular);
        }
        let linear = inverse.map(|row| row.map(|x| x * scale));
        let back = Affine { linear, translation: [0.0; D] };
        Ok(Affine { translation: back.vector(&self.translation).map(|x| -x), ..back })
    }
}

/// The inverse of a matrix; `None` if a pivot vanishes.
fn eliminated<const D: usize>(mut rows: [Point<D>; D]) -> Option<[Point<D>; D]> {
    let mut inverse = Affine::<D>::identity().linear;
    for k in 0..D {
        let pivot = (k..D).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs()))?;
        rows.swap(k, pivot);
        inverse.swap(k, pivot);
        let head = rows[k][k];
        if head == 0.0 {
            return None;
        }
        (rows[k], inverse[k]) = (rows[k].map(|x| x / head), inverse[k].map(|x| x / head));
        for i in (0..D).filter(|&i| i != k) {
            let factor = rows[i][k];
            if factor != 0.0 {
                rows[i] = add_scaled(&rows[i], -factor, &rows[k]);
                inverse[i] = add_scaled(&inverse[i], -factor, &inverse[k]);
            }
        }
    }
    inverse.iter().all(is_finite).then_some(inverse)
}

fn frobenius<const D: usize>(rows: &[Point<D>; D]) -> f64 {
    length(&rows.each_ref().map(length))
}

/// Checks the index of an axis of R^d, from 0.
pub(crate) fn check_axis<const D: usize>(axis: usize) -> Result<(), SpaceError> {
    if axis < D { Ok(()) } else { Err(SpaceError::Axis { axis, dimension: D }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_undoes_and_refuses() {
        for size in [1e-50, 1.0, 1e50] {
            let scaling = Affine::scale([size, 2.0 * size, -3.0 * size, 0.5 * size]).unwrap();
            let turn = Affine::rotation(3, 1, 33.0).unwrap();
            let map = scaling.then(&turn).then(&Affine::translation([size, 0.0, 5.0 * size, size]).unwrap());
            let p = [0.3, -0.7, 1.1, 2.0];
            let back = map.inverse().unwrap().point(&map.point(&p));
            assert!((0..4).all(|k| (back[k] - p[k]).abs() < 4e-15), "{back:?}");
        }
        let singular = |rows| Affine::<2>::new(rows, [0.0; 2]);
        assert_eq!(singular([[1.0, 2.0], [2.0, 4.0]]), Err(SpaceError::Map(SingularError::Singular)));
        assert_eq!(singular([[1.0, 0.0], [0.0, 1e-13]]), Err(SpaceError::Map(SingularError::Singular)));
        assert!(singular([[1.0, 0.0], [0.0, 1e-11]]).is_ok());
        assert!(matches!(
            singular([[1.0, f64::NAN], [0.0, 1.0]]),
            Err(SpaceError::NotFinite { what: "matrix", index, .. }) if index == [0, 1]
        ));
    }

    #[test]
    fn rotations_turn_the_first_axis_towards_the_second() {
        let turn = Affine::<4>::rotation(2, 0, 90.0).unwrap();
        assert_eq!(turn.point(&[0.0, 5.0, 1.0, 7.0]), [1.0, 5.0, 0.0, 7.0]);
        assert_eq!(Affine::<2>::rotation(0, 2, 1.0), Err(SpaceError::Axis { axis: 2, dimension: 2 }));
        assert_eq!(Affine::<2>::rotation(1, 1, 1.0), Err(SpaceError::SameAxis { axis: 1 }));
    }
}
