//! Light in media with a gradient, against closed forms.

mod laws;
mod picture;
mod profiles;

use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_optics::component::Sheet;
use rayweave_optics::gradient::Gradient;
use rayweave_optics::{Beam, Light, Medium, Segment, Settings, System, Trace, Tracer};
use rayweave_shape::primitive::{CentredBox, Cylinder, HalfSpace, Primitive, Sphere};
use rayweave_trace::Packets;

const D_NM: f64 = 587.5618;

fn solid(shape: impl Into<Primitive>) -> Solid {
    Solid::from(shape.into())
}

fn ball(radius: f64) -> Solid {
    solid(Sphere::new(radius).unwrap())
}

fn block(x: f64, y: f64, z: f64) -> Solid {
    solid(CentredBox::new(Vec3::new(x, y, z)).unwrap())
}

/// A rod along z from 0 to its length.
fn rod(radius: f64, length: f64) -> Solid {
    solid(Cylinder::new(radius, length).unwrap()).translate(Vec3::Z * (length / 2.0))
}

/// A sheet in the plane z, a square of a given size.
fn plane(z: f64, size: f64) -> Sheet {
    let surface = solid(HalfSpace::new(Vec3::Z, z).unwrap());
    let trim = block(size, size, size).translate(Vec3::Z * z);
    Sheet { surface, trim, frame: Affine::translate(Vec3::Z * z) }
}

fn graded(index: f64, gradient: Gradient) -> Medium {
    Medium::constant("graded", index, 0.0).unwrap().graded(gradient)
}

fn trace(system: &System, beam: &Beam, settings: &Settings) -> Trace {
    Tracer::new(system, Packets::new).trace(beam, settings).unwrap()
}

/// The rows of one ray.
fn one(system: &System, light: Light) -> Vec<Segment> {
    trace(system, &Beam::from_iter([light]), &Settings::default()).segments.iter().collect()
}

fn near(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
}

fn close(found: Vec3, expected: Vec3, tolerance: f64) {
    assert!((found - expected).length() <= tolerance, "{found} is not {expected}");
}

/// Directions all over the sphere (Fibonacci's lattice).
fn directions(count: usize) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / count as f64;
        let (s, c) = (2.399_963_229_728_653 * k as f64).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * c, r * s, z)
    })
}
