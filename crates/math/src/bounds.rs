//! Axis-aligned bounding boxes (AABB), possibly empty or unbounded.

use crate::{Affine, Vec3};

/// An axis-aligned bounding box. The empty box is (+inf, -inf); faces may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest coordinates.
    pub lo: Vec3,
    /// Largest coordinates.
    pub hi: Vec3,
}

impl Bounds {
    /// The empty box: the neutral element of `union`.
    pub const EMPTY: Bounds = Bounds { lo: Vec3::INFINITY, hi: Vec3::NEG_INFINITY };
    /// The whole space: the neutral element of `intersection`.
    pub const ALL: Bounds = Bounds { lo: Vec3::NEG_INFINITY, hi: Vec3::INFINITY };

    /// The box between two corners; empty if `lo` exceeds `hi` in a coordinate.
    pub fn new(lo: Vec3, hi: Vec3) -> Bounds {
        Bounds { lo, hi }.normalised()
    }

    /// The box centred at `centre` with the given half extents.
    pub fn centred(centre: Vec3, half: Vec3) -> Bounds {
        Bounds::new(centre - half, centre + half)
    }

    fn normalised(self) -> Bounds {
        if self.lo.cmple(self.hi).all() { self } else { Bounds::EMPTY }
    }

    /// True if no point is inside.
    pub fn is_empty(&self) -> bool {
        !self.lo.cmple(self.hi).all()
    }

    /// True if the box is not empty and all faces are finite.
    pub fn is_finite(&self) -> bool {
        !self.is_empty() && self.lo.is_finite() && self.hi.is_finite()
    }

    /// The smallest box that contains both.
    pub fn union(&self, other: &Bounds) -> Bounds {
        Bounds { lo: self.lo.min(other.lo), hi: self.hi.max(other.hi) }
    }

    /// The intersection of both boxes.
    pub fn intersection(&self, other: &Bounds) -> Bounds {
        Bounds { lo: self.lo.max(other.lo), hi: self.hi.min(other.hi) }.normalised()
    }

    /// The middle of a finite box.
    pub fn centre(&self) -> Vec3 {
        0.5 * self.lo + 0.5 * self.hi
    }

    /// The edge lengths `hi - lo`; components are negative or infinite if the box is empty or unbounded.
    pub fn size(&self) -> Vec3 {
        self.hi - self.lo
    }

    /// The box grown by `margin` on all sides; the empty box stays empty.
    pub fn grown(&self, margin: f64) -> Bounds {
        if self.is_empty() {
            return *self;
        }
        Bounds { lo: self.lo - Vec3::splat(margin), hi: self.hi + Vec3::splat(margin) }
    }

    /// True if `point` is in the box, its faces included.
    pub fn contains(&self, point: Vec3) -> bool {
        self.lo.cmple(point).all() && point.cmple(self.hi).all()
    }

    /// The eight corners of a finite box.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |k: usize, lo: f64, hi: f64| if i >> k & 1 == 0 { lo } else { hi };
            Vec3::new(
                pick(0, self.lo.x, self.hi.x),
                pick(1, self.lo.y, self.hi.y),
                pick(2, self.lo.z, self.hi.z),
            )
        })
    }

    /// The smallest box that contains the image of this box (J. Arvo, "Transforming Axis-Aligned Bounding Boxes", Graphics
    /// Gems, 1990). The image is infinite only along axes onto which the map projects an infinite face.
    pub fn transformed(&self, map: &Affine) -> Bounds {
        if self.is_empty() {
            return Bounds::EMPTY;
        }
        let mut image = Bounds { lo: map.translation, hi: map.translation };
        for (column, (lo, hi)) in
            map.linear.to_cols_array_2d().iter().zip(self.lo.to_array().into_iter().zip(self.hi.to_array()))
        {
            for row in 0..3 {
                let (a, b) = (product(column[row], lo), product(column[row], hi));
                image.lo[row] += a.min(b);
                image.hi[row] += a.max(b);
            }
        }
        image
    }
}

/// A product in which `0 * inf` is 0: the map does not project this face onto the axis.
fn product(factor: f64, face: f64) -> f64 {
    if factor == 0.0 { 0.0 } else { factor * face }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_and_all_are_neutral() {
        let unit = Bounds::centred(Vec3::ZERO, Vec3::ONE);
        assert_eq!(unit.union(&Bounds::EMPTY), unit);
        assert_eq!(unit.intersection(&Bounds::ALL), unit);
        assert!(unit.intersection(&Bounds::EMPTY).is_empty());
        assert!(Bounds::new(Vec3::ONE, Vec3::ZERO).is_empty());
    }

    #[test]
    fn transformed_contains_all_corners_and_keeps_infinite_faces_apart() {
        let map = Affine::rotation(Vec3::new(1.0, 2.0, 3.0), 40.0)
            .then(&Affine::translate(Vec3::new(5.0, 6.0, 7.0)));
        let unit = Bounds::new(Vec3::new(-1.0, -2.0, 0.0), Vec3::new(1.0, 0.5, 3.0));
        let image = unit.transformed(&map).grown(1e-14);
        assert!(unit.corners().iter().all(|&c| image.contains(map.point(c))));
        let pillar =
            Bounds::new(Vec3::new(-1.0, -1.0, f64::NEG_INFINITY), Vec3::new(1.0, 1.0, f64::INFINITY));
        let turned = pillar.transformed(&Affine::rotation(Vec3::Z, 90.0));
        assert_eq!(turned, pillar);
    }
}
