//! Numbers and vectors of eight photons, in memory and in SIMD lanes.

use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::Vec3;
use rayweave_shape::lanes::{LANES, Lanes, Vec3Lanes};

/// A number of each of eight photons.
pub(crate) type Row = [f64; LANES];

/// Sets the vector of a photon.
pub(crate) fn put(rows: &mut [Row; 3], lane: usize, vector: Vec3) {
    for k in 0..3 {
        rows[k][lane] = vector[k];
    }
}

/// The vector of a photon.
pub(crate) fn get(rows: &[Row; 3], lane: usize) -> Vec3 {
    Vec3::new(rows[0][lane], rows[1][lane], rows[2][lane])
}

#[inline(always)]
pub(crate) fn load<S: Simd>(simd: S, row: &Row) -> Lanes<S> {
    Lanes::load_array_ref(simd, row)
}

#[inline(always)]
pub(crate) fn vector<S: Simd>(simd: S, rows: &[Row; 3]) -> Vec3Lanes<S> {
    Vec3Lanes { x: load(simd, &rows[0]), y: load(simd, &rows[1]), z: load(simd, &rows[2]) }
}

#[inline(always)]
pub(crate) fn store<S: Simd>(vector: Vec3Lanes<S>, rows: &mut [Row; 3]) {
    vector.x.store_array(&mut rows[0]);
    vector.y.store_array(&mut rows[1]);
    vector.z.store_array(&mut rows[2]);
}

/// The vector in one lane.
#[inline(always)]
pub(crate) fn lane_of<S: Simd>(vector: &Vec3Lanes<S>, lane: usize) -> Vec3 {
    let at = |values: &Lanes<S>| values.as_slice()[lane % LANES];
    Vec3::new(at(&vector.x), at(&vector.y), at(&vector.z))
}

#[inline(always)]
pub(crate) fn minus<S: Simd>(a: Vec3Lanes<S>, b: Vec3Lanes<S>) -> Vec3Lanes<S> {
    Vec3Lanes { x: a.x - b.x, y: a.y - b.y, z: a.z - b.z }
}

#[inline(always)]
pub(crate) fn negative<S: Simd>(v: Vec3Lanes<S>) -> Vec3Lanes<S> {
    Vec3Lanes { x: -v.x, y: -v.y, z: -v.z }
}
