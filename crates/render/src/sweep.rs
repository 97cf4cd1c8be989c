//! Loops over columns, compiled for each instruction set: rays, points, normals and Lambert's law.
//!
//! They are written for one ray; the compiler vectorises them. Nothing is fused or reordered, so all
//! instruction sets give the same bits.

use crate::columns::Columns;
use crate::shade::Source;
use crate::{Camera, Size};
use fearless_simd::{Level, dispatch};
use rayweave_math::Vec3;

/// Computes the rays through pixel positions.
pub(crate) fn rays(level: Level, camera: &Camera, size: Size, places: &[[f64; 2]], columns: &mut Columns) {
    columns.resize(places.len());
    dispatch!(level, _simd => rays_in_lanes(camera, size, places, columns));
}

#[inline(always)]
fn rays_in_lanes(camera: &Camera, size: Size, places: &[[f64; 2]], columns: &mut Columns) {
    let n = places.len();
    let [ox, oy, oz] = columns.origins.each_mut().map(|column| &mut column[..n]);
    let [dx, dy, dz] = columns.directions.each_mut().map(|column| &mut column[..n]);
    for i in 0..n {
        let ray = camera.ray(size, places[i][0], places[i][1]);
        (ox[i], oy[i], oz[i]) = (ray.origin.x, ray.origin.y, ray.origin.z);
        (dx[i], dy[i], dz[i]) = (ray.direction.x, ray.direction.y, ray.direction.z);
    }
}

/// Orients the normals towards the camera and computes the visible points.
pub(crate) fn surfaces(level: Level, columns: &mut Columns, points: &mut [Vec<f64>; 3]) {
    points.iter_mut().for_each(|column| column.resize(columns.len(), 0.0));
    dispatch!(level, _simd => surfaces_in_lanes(columns, points));
}

#[inline(always)]
fn surfaces_in_lanes(columns: &mut Columns, points: &mut [Vec<f64>; 3]) {
    let n = columns.len();
    let [ox, oy, oz] = columns.origins.each_ref().map(|column| &column[..n]);
    let [dx, dy, dz] = columns.directions.each_ref().map(|column| &column[..n]);
    let [nx, ny, nz] = columns.hits.normal.each_mut().map(|column| &mut column[..n]);
    let [px, py, pz] = points.each_mut().map(|column| &mut column[..n]);
    let t = &columns.hits.t[..n];
    for i in 0..n {
        let direction = Vec3::new(dx[i], dy[i], dz[i]);
        let point = Vec3::new(ox[i], oy[i], oz[i]) + t[i] * direction;
        (px[i], py[i], pz[i]) = (point.x, point.y, point.z);
        let normal = Vec3::new(nx[i], ny[i], nz[i]);
        let away = normal.dot(direction) > 0.0;
        nx[i] = if away { -normal.x } else { normal.x };
        ny[i] = if away { -normal.y } else { normal.y };
        nz[i] = if away { -normal.z } else { normal.z };
    }
}

/// The surfaces that [`surfaces`] prepared.
pub(crate) struct Surfaces<'a> {
    pub points: &'a [Vec<f64>; 3],
    pub columns: &'a Columns,
    /// The lights that shine on each surface, one bit each.
    pub lit: &'a [u32],
}

/// The cosine of the angle between each normal and the light; 0 if the light is behind the surface or hidden.
/// `bit` is the bit of the light.
pub(crate) fn cosines(
    level: Level,
    source: &Source,
    bit: u32,
    surfaces: &Surfaces<'_>,
    cosines: &mut Vec<f32>,
) {
    cosines.resize(surfaces.columns.len(), 0.0);
    match *source {
        Source::Sun(towards) => {
            dispatch!(level, _simd => cosines_in_lanes(surfaces, bit, cosines, |_, _| towards));
        }
        Source::Point(position) => {
            let towards = |point: Vec3, _: Vec3| (position - point).normalize_or_zero();
            dispatch!(level, _simd => cosines_in_lanes(surfaces, bit, cosines, towards));
        }
        Source::Eye => {
            dispatch!(level, _simd => cosines_in_lanes(surfaces, bit, cosines, |_, sight: Vec3| -sight));
        }
    }
}

#[inline(always)]
fn cosines_in_lanes(
    surfaces: &Surfaces<'_>,
    bit: u32,
    cosines: &mut [f32],
    towards: impl Fn(Vec3, Vec3) -> Vec3,
) {
    let n = cosines.len();
    let [px, py, pz] = surfaces.points.each_ref().map(|column| &column[..n]);
    let [nx, ny, nz] = surfaces.columns.hits.normal.each_ref().map(|column| &column[..n]);
    let [dx, dy, dz] = surfaces.columns.directions.each_ref().map(|column| &column[..n]);
    let lit = &surfaces.lit[..n];
    for i in 0..n {
        let towards = towards(Vec3::new(px[i], py[i], pz[i]), Vec3::new(dx[i], dy[i], dz[i]));
        let cosine = Vec3::new(nx[i], ny[i], nz[i]).dot(towards) as f32;
        cosines[i] = if cosine > 0.0 && lit[i] & bit != 0 { cosine } else { 0.0 };
    }
}
