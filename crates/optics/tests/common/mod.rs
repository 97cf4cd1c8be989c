//! Shared parts of the tests of light: solids, sheets and sampling points.
#![allow(dead_code, reason = "every test uses a part of it")]

use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_optics::component::Sheet;
use rayweave_optics::{Beam, Light, Medium, System, Trace, TraceSettings, Tracer};
use rayweave_shape::primitive::{CentredBox, Cylinder, HalfSpace, Primitive, Sphere};
use rayweave_trace::Packets;

/// The d line of helium, in nanometres.
pub const D_NM: f64 = 587.5618;

pub fn solid(shape: impl Into<Primitive>) -> Solid {
    Solid::from(shape.into())
}

pub fn ball(radius: f64) -> Solid {
    solid(Sphere::new(radius).unwrap())
}

pub fn block(x: f64, y: f64, z: f64) -> Solid {
    solid(CentredBox::new(Vec3::new(x, y, z)).unwrap())
}

/// A rod along z about the origin.
pub fn rod(radius: f64, height: f64) -> Solid {
    solid(Cylinder::new(radius, height).unwrap())
}

pub fn below(z: f64) -> Solid {
    solid(HalfSpace::new(Vec3::Z, z).unwrap())
}

/// The plane z and a square of a given size in it.
pub fn flat(z: f64, size: f64) -> (Solid, Solid) {
    (below(z), block(size, size, size).translate(Vec3::Z * z))
}

/// The same as a sheet.
pub fn plane(z: f64, size: f64) -> Sheet {
    let (surface, trim) = flat(z, size);
    Sheet { surface, trim, frame: Affine::translate(Vec3::Z * z) }
}

pub fn glass(n: f64) -> Medium {
    Medium::constant(&format!("n = {n}"), n, 0.0).unwrap()
}

pub fn along_z(x: f64, y: f64) -> Light {
    Light::new(Vec3::new(x, y, -50.0), Vec3::Z, D_NM)
}

/// Points all over a disk (Vogel's spiral).
pub fn disk(count: usize, radius: f64) -> impl Iterator<Item = [f64; 2]> {
    (0..count).map(move |k| {
        let (r, angle) =
            (radius * ((k as f64 + 0.5) / count as f64).sqrt(), 2.399_963_229_728_653 * k as f64);
        [r * angle.cos(), r * angle.sin()]
    })
}

pub fn trace(system: &System, beam: &Beam, settings: &TraceSettings) -> Trace {
    Tracer::new(system, Packets::new).trace(beam, settings).unwrap()
}

pub fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
}
