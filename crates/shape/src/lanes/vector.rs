//! Vectors of eight rays in SIMD lanes, with the order of operations of the scalar ones.

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8, mask64x8};
use rayweave_math::Vec3;

/// Number of lanes: rays processed at a time.
pub const LANES: usize = 8;

/// One number per ray.
pub type Lanes<S> = f64x8<S>;

/// One boolean per ray.
pub type Mask<S> = mask64x8<S>;

/// The same number in every lane.
#[inline(always)]
pub fn splat<S: Simd>(simd: S, value: f64) -> Lanes<S> {
    Lanes::splat(simd, value)
}

/// One vector per ray.
#[derive(Clone, Copy, Debug)]
pub struct Vec3Lanes<S: Simd> {
    /// The first components.
    pub x: Lanes<S>,
    /// The second components.
    pub y: Lanes<S>,
    /// The third components.
    pub z: Lanes<S>,
}

impl<S: Simd> Vec3Lanes<S> {
    /// The same vector in every lane.
    #[inline(always)]
    pub fn splat(simd: S, v: Vec3) -> Self {
        Vec3Lanes { x: splat(simd, v.x), y: splat(simd, v.y), z: splat(simd, v.z) }
    }

    /// `(x x' + y y') + z z'`.
    #[inline(always)]
    pub fn dot(self, other: Self) -> Lanes<S> {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Dot product with the same vector in all lanes.
    #[inline(always)]
    pub fn dot_all(self, v: Vec3) -> Lanes<S> {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    /// Dot products with three vectors, the same in all lanes.
    #[inline(always)]
    pub fn dots(self, [x, y, z]: [Vec3; 3]) -> Self {
        Vec3Lanes { x: self.dot_all(x), y: self.dot_all(y), z: self.dot_all(z) }
    }

    /// The cross product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Vec3Lanes {
            x: self.y * other.z - other.y * self.z,
            y: self.z * other.x - other.z * self.x,
            z: self.x * other.y - other.x * self.y,
        }
    }

    /// Squared length.
    #[inline(always)]
    pub fn length_squared(self) -> Lanes<S> {
        self.dot(self)
    }

    /// Componentwise sum.
    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        Vec3Lanes { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }

    /// Sum with the same vector in all lanes.
    #[inline(always)]
    pub fn plus_all(self, v: Vec3) -> Self {
        Vec3Lanes { x: self.x + v.x, y: self.y + v.y, z: self.z + v.z }
    }

    /// Difference to the same vector in all lanes.
    #[inline(always)]
    pub fn minus_all(self, v: Vec3) -> Self {
        Vec3Lanes { x: self.x - v.x, y: self.y - v.y, z: self.z - v.z }
    }

    /// The same vector in all lanes minus this one.
    #[inline(always)]
    pub fn taken_from(self, v: Vec3) -> Self {
        Vec3Lanes { x: v.x - self.x, y: v.y - self.y, z: v.z - self.z }
    }

    /// Product with one number per lane.
    #[inline(always)]
    pub fn times(self, factor: Lanes<S>) -> Self {
        Vec3Lanes { x: factor * self.x, y: factor * self.y, z: factor * self.z }
    }

    /// Componentwise product with the same vector in all lanes.
    #[inline(always)]
    pub fn times_all(self, v: Vec3) -> Self {
        Vec3Lanes { x: self.x * v.x, y: self.y * v.y, z: self.z * v.z }
    }

    /// Minus the same vector in all lanes times one number per lane.
    #[inline(always)]
    pub fn without(self, along: Lanes<S>, axis: Vec3) -> Self {
        Vec3Lanes { x: self.x - along * axis.x, y: self.y - along * axis.y, z: self.z - along * axis.z }
    }

    /// `v - (v . axis) axis` for a unit axis.
    #[inline(always)]
    pub fn perpendicular(self, axis: Vec3) -> Self {
        self.without(self.dot_all(axis), axis)
    }

    /// Replaces the vector in the lanes of a mask.
    #[inline(always)]
    pub fn or_where(self, lanes: Mask<S>, other: Self) -> Self {
        Vec3Lanes {
            x: lanes.select(other.x, self.x),
            y: lanes.select(other.y, self.y),
            z: lanes.select(other.z, self.z),
        }
    }

    /// Absolute values of the components.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Vec3Lanes { x: self.x.abs(), y: self.y.abs(), z: self.z.abs() }
    }

    /// Sum of the magnitudes of the components: at least the length, at most sqrt(3) times it.
    #[inline(always)]
    pub fn taxicab(self) -> Lanes<S> {
        self.x.abs() + self.y.abs() + self.z.abs()
    }

    /// A component by its index.
    #[inline(always)]
    pub fn component(self, k: usize) -> Lanes<S> {
        match k {
            0 => self.x,
            1 => self.y,
            _ => self.z,
        }
    }
}
