//! Numbers and vectors for one ray (`f64`) or for eight rays (SIMD lanes). A kernel that is generic over [`Real`]
//! compiles to both a scalar version and a lane version.
//!
//! Both versions give the same bits, because every operation here is correctly rounded and none is fused. All functions must be
//! inlined into a caller that is compiled for the instruction set ([`fearless_simd::dispatch`]).

use fearless_simd::prelude::*;
use fearless_simd::{Simd, f64x8, mask64x8};
use rayweave_math::Vec3;
use std::ops::{Add, BitAnd, Div, Mul, Neg, Sub};

/// One number per ray: a scalar, or a SIMD vector with one ray per lane.
pub trait Real:
    Copy
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Neg<Output = Self>
{
    /// One boolean per ray.
    type Mask: Copy + BitAnd<Output = Self::Mask>;

    /// `value` in every lane; of `self` only the type matters.
    fn splat(self, value: f64) -> Self;

    /// `value - self`, with the same `value` for all rays.
    fn taken_from(self, value: f64) -> Self;

    /// Absolute value.
    fn abs(self) -> Self;

    /// Square root, correctly rounded.
    fn sqrt(self) -> Self;

    /// True where `self < other`; false where either is NaN.
    fn is_below(self, other: Self) -> Self::Mask;

    /// True where `self <= other`; false where either is NaN.
    fn is_at_most(self, other: Self) -> Self::Mask;

    /// True where the number is 0 or -0.
    fn is_zero(self) -> Self::Mask;

    /// True if the mask is true for at least one ray.
    fn any(mask: Self::Mask) -> bool;

    /// `chosen` where the mask is true, else `other`.
    fn select(mask: Self::Mask, chosen: Self, other: Self) -> Self;
}

impl Real for f64 {
    type Mask = bool;

    #[inline(always)]
    fn splat(self, value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn taken_from(self, value: f64) -> f64 {
        value - self
    }

    #[inline(always)]
    fn abs(self) -> f64 {
        f64::abs(self)
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn is_below(self, other: f64) -> bool {
        self < other
    }

    #[inline(always)]
    fn is_at_most(self, other: f64) -> bool {
        self <= other
    }

    #[inline(always)]
    fn is_zero(self) -> bool {
        self == 0.0
    }

    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }

    #[inline(always)]
    fn select(mask: bool, chosen: f64, other: f64) -> f64 {
        if mask { chosen } else { other }
    }
}

impl<S: Simd> Real for f64x8<S> {
    type Mask = mask64x8<S>;

    #[inline(always)]
    fn splat(self, value: f64) -> Self {
        <Self as SimdBase<S>>::splat(self.simd, value)
    }

    #[inline(always)]
    fn taken_from(self, value: f64) -> Self {
        value - self
    }

    #[inline(always)]
    fn abs(self) -> Self {
        <Self as SimdBase<S>>::abs(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        <Self as SimdFloat<S>>::sqrt(self)
    }

    #[inline(always)]
    fn is_below(self, other: Self) -> mask64x8<S> {
        self.simd_lt(other)
    }

    #[inline(always)]
    fn is_at_most(self, other: Self) -> mask64x8<S> {
        self.simd_le(other)
    }

    #[inline(always)]
    fn is_zero(self) -> mask64x8<S> {
        self.simd_eq(0.0)
    }

    #[inline(always)]
    fn any(mask: mask64x8<S>) -> bool {
        mask.any_true()
    }

    #[inline(always)]
    fn select(mask: mask64x8<S>, chosen: Self, other: Self) -> Self {
        mask.select(chosen, other)
    }
}

/// One vector per ray.
#[derive(Clone, Copy, Debug)]
pub struct Vector<R> {
    /// The first components.
    pub x: R,
    /// The second components.
    pub y: R,
    /// The third components.
    pub z: R,
}

impl From<Vec3> for Vector<f64> {
    #[inline(always)]
    fn from(v: Vec3) -> Self {
        Vector { x: v.x, y: v.y, z: v.z }
    }
}

impl From<Vector<f64>> for Vec3 {
    #[inline(always)]
    fn from(v: Vector<f64>) -> Self {
        Vec3::new(v.x, v.y, v.z)
    }
}

impl<R: Real> Vector<R> {
    /// `factor v`: the same vector for all rays, one factor per ray.
    #[inline(always)]
    pub fn along(v: Vec3, factor: R) -> Self {
        Vector { x: factor * v.x, y: factor * v.y, z: factor * v.z }
    }

    /// `v` in every lane; of `self` only the type matters.
    #[inline(always)]
    pub fn same(self, v: Vec3) -> Self {
        Vector { x: self.x.splat(v.x), y: self.x.splat(v.y), z: self.x.splat(v.z) }
    }

    /// Dot product, summed as `(x x' + y y') + z z'`.
    #[inline(always)]
    pub fn dot(self, other: Self) -> R {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Dot product with the same vector for all rays, summed in the order of [`Vector::dot`].
    #[inline(always)]
    pub fn dot_all(self, v: Vec3) -> R {
        self.x * v.x + self.y * v.y + self.z * v.z
    }

    /// Dot products with three vectors, the same for all rays.
    #[inline(always)]
    pub fn dots(self, [x, y, z]: [Vec3; 3]) -> Self {
        Vector { x: self.dot_all(x), y: self.dot_all(y), z: self.dot_all(z) }
    }

    /// The cross product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Vector {
            x: self.y * other.z - other.y * self.z,
            y: self.z * other.x - other.z * self.x,
            z: self.x * other.y - other.x * self.y,
        }
    }

    /// Squared length.
    #[inline(always)]
    pub fn length_squared(self) -> R {
        self.dot(self)
    }

    /// Componentwise sum.
    #[inline(always)]
    pub fn plus(self, other: Self) -> Self {
        Vector { x: self.x + other.x, y: self.y + other.y, z: self.z + other.z }
    }

    /// Sum with the same vector for all rays.
    #[inline(always)]
    pub fn plus_all(self, v: Vec3) -> Self {
        Vector { x: self.x + v.x, y: self.y + v.y, z: self.z + v.z }
    }

    /// Componentwise difference.
    #[inline(always)]
    pub fn minus(self, other: Self) -> Self {
        Vector { x: self.x - other.x, y: self.y - other.y, z: self.z - other.z }
    }

    /// `self - v`, with the same `v` for all rays.
    #[inline(always)]
    pub fn minus_all(self, v: Vec3) -> Self {
        Vector { x: self.x - v.x, y: self.y - v.y, z: self.z - v.z }
    }

    /// `v - self`, with the same `v` for all rays.
    #[inline(always)]
    pub fn taken_from(self, v: Vec3) -> Self {
        Vector { x: self.x.taken_from(v.x), y: self.y.taken_from(v.y), z: self.z.taken_from(v.z) }
    }

    /// Product with one factor per ray.
    #[inline(always)]
    pub fn times(self, factor: R) -> Self {
        Vector { x: factor * self.x, y: factor * self.y, z: factor * self.z }
    }

    /// Product with the same factor for all rays.
    #[inline(always)]
    pub fn times_number(self, factor: f64) -> Self {
        Vector { x: self.x * factor, y: self.y * factor, z: self.z * factor }
    }

    /// Componentwise product with the same vector for all rays.
    #[inline(always)]
    pub fn times_all(self, v: Vec3) -> Self {
        Vector { x: self.x * v.x, y: self.y * v.y, z: self.z * v.z }
    }

    /// Componentwise product.
    #[inline(always)]
    pub fn times_each(self, other: Self) -> Self {
        Vector { x: self.x * other.x, y: self.y * other.y, z: self.z * other.z }
    }

    /// The component perpendicular to a unit axis, one per ray: [`Vector::perpendicular`].
    #[inline(always)]
    pub fn perpendicular_to(self, axis: Self) -> Self {
        self.minus(axis.times(self.dot(axis)))
    }

    /// `self - along axis`: the same axis for all rays, one factor `along` per ray.
    #[inline(always)]
    pub fn without(self, along: R, axis: Vec3) -> Self {
        Vector { x: self.x - along * axis.x, y: self.y - along * axis.y, z: self.z - along * axis.z }
    }

    /// The component perpendicular to a unit axis: `self - (self . axis) axis`.
    #[inline(always)]
    pub fn perpendicular(self, axis: Vec3) -> Self {
        self.without(self.dot_all(axis), axis)
    }

    /// Absolute values of the components.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Vector { x: self.x.abs(), y: self.y.abs(), z: self.z.abs() }
    }

    /// Taxicab norm (1-norm), the sum of the magnitudes of the components: at least the length, at most sqrt(3) times it.
    #[inline(always)]
    pub fn taxicab(self) -> R {
        self.x.abs() + self.y.abs() + self.z.abs()
    }

    /// A component by its index: 0 is x, 1 is y, any other is z.
    #[inline(always)]
    pub fn component(self, k: usize) -> R {
        match k {
            0 => self.x,
            1 => self.y,
            _ => self.z,
        }
    }
}
