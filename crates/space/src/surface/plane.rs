//! Hyperplane `n . p = c`; the inside is `n . p < c`.

use crate::Point;
use crate::affine::Affine;
use crate::curve::Line;
use crate::point::{dot, dot_noise, dot_of_sizes, is_finite};
use crate::vector::{times, unit};
use rayweave_math::Interval;
use rayweave_math::roots::Crossings;

/// A hyperplane with unit normal; the inside is the half-space on the side opposite to the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plane<const D: usize> {
    /// The unit normal, which points outside.
    pub normal: Point<D>,
    /// The signed distance of the plane from the origin along the normal.
    pub offset: f64,
}

impl<const D: usize> Plane<D> {
    /// The plane `normal . p = offset`, scaled to a unit normal. The normal must be finite and nonzero.
    pub fn new(normal: &Point<D>, offset: f64) -> Self {
        let (normal, [size, length]) = unit(normal);
        Plane { normal, offset: offset / size / length }
    }

    /// The root `(c - n.o) / (n.d)`, with the same bits if normal and offset are negated. A line parallel to the plane up to rounding
    /// has no root and the side of its origin.
    pub(super) fn crossings(&self, line: &Line<D>) -> Crossings<2> {
        let height = self.offset - dot(&self.normal, &line.origin);
        let speed = match dot(&self.normal, &line.direction) {
            speed if speed.abs() <= dot_noise::<D>() * dot_of_sizes(&self.normal, &line.direction) => 0.0,
            speed => speed,
        };
        let t = height / speed;
        if t.is_finite() { Crossings::new(speed > 0.0, &[t]) } else { Crossings::constant(height > 0.0) }
    }

    pub(super) fn value_and_gradient(&self, point: &Point<D>) -> (f64, Point<D>) {
        (dot(&self.normal, point) - self.offset, self.normal)
    }

    pub(super) fn ranges(&self, cell: &[Interval; D]) -> (Interval, [Interval; D]) {
        let from = Interval::point(-self.offset);
        let value = self.normal.iter().zip(cell).filter(|(n, _)| **n != 0.0);
        (value.fold(from, |sum, (&n, &x)| sum + x * n), self.normal.map(Interval::point))
    }

    pub(super) fn anchor(&self) -> Point<D> {
        times(self.offset, &self.normal)
    }

    /// With p = L q + T, `n . q = c` becomes `(L^-T n) . p = c + (L^-T n) . T`.
    pub(super) fn transformed(&self, map: &Affine<D>, inverse: &Affine<D>) -> Self {
        if let Some(scale) = map.uniform_scale() {
            // normalising a unit normal again may change its last bit
            let offset = scale * self.offset + dot(&self.normal, map.offset());
            return Plane { normal: self.normal, offset };
        }
        let normal = inverse.covector(&self.normal);
        Plane::new(&normal, self.offset + dot(&normal, map.offset()))
    }

    pub(super) fn is_finite(&self) -> bool {
        is_finite(&self.normal) && self.offset.is_finite()
    }
}
