//! Cutting planes with two-dimensional coordinates.

use super::SectionError;
use rayweave_math::{Bounds, Vec3};

/// A plane with an origin and two orthonormal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cut {
    origin: Vec3,
    across: Vec3,
    up: Vec3,
}

impl Cut {
    /// The plane through a point with two axes: the first is normalised, the second is made orthogonal to it
    /// and normalised.
    ///
    /// # Errors
    /// [`SectionError::Axes`].
    pub fn new(origin: Vec3, across: Vec3, up: Vec3) -> Result<Cut, SectionError> {
        let first = across.normalize_or_zero();
        let second = (up - first * first.dot(up)).normalize_or_zero();
        let is_plane = origin.is_finite() && first != Vec3::ZERO && second != Vec3::ZERO;
        match is_plane && first.is_finite() && second.is_finite() {
            true => Ok(Cut { origin, across: first, up: second }),
            false => Err(SectionError::Axes { across, up }),
        }
    }

    /// The point of space at plane coordinates.
    pub fn point(&self, [u, v]: [f64; 2]) -> Vec3 {
        self.origin + self.across * u + self.up * v
    }

    /// The directions of the axes, to the right and up: unit vectors.
    pub fn axes(&self) -> [Vec3; 2] {
        [self.across, self.up]
    }

    /// The coordinates of the orthogonal projection of a point.
    pub fn place(&self, point: Vec3) -> [f64; 2] {
        [self.across, self.up].map(|axis| axis.dot(point - self.origin))
    }

    /// The unit normal: the cross product of the axes.
    pub fn normal(&self) -> Vec3 {
        self.across.cross(self.up)
    }

    /// The range of a coordinate (0 or 1), or of the height above the plane (2), over a box; infinite where
    /// the box is infinite, and empty (from inf to -inf) for an empty box.
    pub fn range(&self, bounds: &Bounds, coordinate: usize) -> [f64; 2] {
        if bounds.is_empty() {
            return [f64::INFINITY, f64::NEG_INFINITY];
        }
        let axis = [self.across, self.up, self.normal()][coordinate];
        let mut range = [-axis.dot(self.origin); 2];
        for k in 0..3 {
            // 0 times infinity counts as 0: the box may be infinite along an axis orthogonal to this one
            let ends =
                [bounds.lo[k], bounds.hi[k]].map(|end| if axis[k] == 0.0 { 0.0 } else { end * axis[k] });
            range[0] += ends[0].min(ends[1]);
            range[1] += ends[0].max(ends[1]);
        }
        range
    }
}
