//! Constructors of solids: one function per shape, with the names and parameters of model files and Python.
//!
//! Lengths are in an arbitrary unit, angles in degrees, axes right-handed. Parameters out of range are errors
//! that name the parameter, its range and, where possible, the likely intention. The manual page of each
//! shape, with its equation, faces and degenerate cases, is in [`crate::shape::primitive::MANUALS`].
//!
//! ```
//! use rayweave::shapes::{box_, sphere};
//!
//! let die = &box_([2.0, 2.0, 2.0])? & &sphere(1.4)?;
//! assert_eq!(die.to_string(), "box(size=[2.0, 2.0, 2.0]) & sphere(radius=1.4)");
//!
//! let error = sphere(-1.0).unwrap_err();
//! assert!(error.is_shape() && error.to_string().contains("radius"));
//! # Ok::<(), rayweave::Error>(())
//! ```

use crate::Error;
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_shape::primitive::{Value, build};
use std::sync::Arc;

/// A ball about the origin; `radius` > 0.
pub fn sphere(radius: f64) -> Result<Solid, Error> {
    make("sphere", &[("radius", radius.into())])
}

/// An ellipsoid about the origin with its axes along x, y and z; `radii` > 0.
pub fn ellipsoid(radii: impl Into<Vec3>) -> Result<Solid, Error> {
    make("ellipsoid", &[("radii", radii.into().into())])
}

/// A box about the origin with edges along x, y and z; lengths > 0. (`box` is a keyword, hence the name.)
pub fn box_(size: impl Into<Vec3>) -> Result<Solid, Error> {
    make("box", &[("size", size.into().into())])
}

/// The box between two corners; each component of `lo` is less than that of `hi`.
pub fn box_from_corners(lo: impl Into<Vec3>, hi: impl Into<Vec3>) -> Result<Solid, Error> {
    let corners = [("lo", lo.into().into()), ("hi", hi.into().into())];
    make("box_from_corners", &corners)
}

/// A cylinder along z about the origin; `radius` > 0, `height` > 0 or infinite.
pub fn cylinder(radius: f64, height: f64) -> Result<Solid, Error> {
    let sizes = [("radius", radius.into()), ("height", height.into())];
    make("cylinder", &sizes)
}

/// A cone or frustum along z about the origin: `radius1` at z = -height/2, `radius2` at z = height/2; either
/// may be 0.
pub fn cone(radius1: f64, radius2: f64, height: f64) -> Result<Solid, Error> {
    let sizes = [("radius1", radius1.into()), ("radius2", radius2.into()), ("height", height.into())];
    make("cone", &sizes)
}

/// The points with `normal . p < offset`; the normal need not be of unit length.
pub fn half_space(normal: impl Into<Vec3>, offset: f64) -> Result<Solid, Error> {
    let plane = [("normal", normal.into().into()), ("offset", offset.into())];
    make("half_space", &plane)
}

/// The points with `lo < normal . p < hi`; the normal need not be of unit length.
pub fn slab(normal: impl Into<Vec3>, lo: f64, hi: f64) -> Result<Solid, Error> {
    let planes = [("normal", normal.into().into()), ("lo", lo.into()), ("hi", hi.into())];
    make("slab", &planes)
}

/// A torus around z; `major` > 0 is the radius of the centre line, `minor` > 0 that of the tube.
pub fn torus(major: f64, minor: f64) -> Result<Solid, Error> {
    make("torus", &[("major", major.into()), ("minor", minor.into())])
}

/// The points with x^2 + y^2 < 4 `focal_length` z and z < `height`, which may be infinite.
pub fn paraboloid(focal_length: f64, height: f64) -> Result<Solid, Error> {
    let sizes = [("focal_length", focal_length.into()), ("height", height.into())];
    make("paraboloid", &sizes)
}

/// The points with `[x y z 1] Q [x y z 1]^T < 0` for a symmetric matrix Q, given by its rows.
pub fn quadric(matrix: [[f64; 4]; 4]) -> Result<Solid, Error> {
    make("quadric", &[("matrix", matrix.as_slice().into())])
}

/// A cylinder along z about the origin with a coaxial hole; `outer_radius` > `inner_radius` > 0.
pub fn tube(outer_radius: f64, inner_radius: f64, height: f64) -> Result<Solid, Error> {
    let sizes = [
        ("outer_radius", outer_radius.into()),
        ("inner_radius", inner_radius.into()),
        ("height", height.into()),
    ];
    make("tube", &sizes)
}

/// The points with azimuth between `start` and `start + sweep`, from +x towards +y, in degrees, where
/// 0 < `sweep` < 360. Unbounded along z and radially.
pub fn wedge(start_degrees: f64, sweep_degrees: f64) -> Result<Solid, Error> {
    let angles = [("start_degrees", start_degrees.into()), ("sweep_degrees", sweep_degrees.into())];
    make("wedge", &angles)
}

/// A regular prism along z about the origin; `radius` is that of the circumscribed circle, the first vertex
/// is on +x.
pub fn prism(sides: u32, radius: f64, height: f64) -> Result<Solid, Error> {
    let sizes = [("sides", sides.into()), ("radius", radius.into()), ("height", height.into())];
    make("prism", &sizes)
}

/// The points with `a x + b y + c z < d` for every row (a, b, c, d).
pub fn convex(planes: &[[f64; 4]]) -> Result<Solid, Error> {
    make("convex", &[("planes", planes.into())])
}

/// The solid inside a closed triangle mesh; `faces` holds three indices into `vertices` per triangle, from 0.
pub fn mesh(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Solid, Error> {
    let numbers: Vec<[f64; 3]> = faces.iter().map(|face| face.map(f64::from)).collect();
    make("mesh", &[("vertices", vertices.into()), ("faces", numbers.as_slice().into())])
}

/// The solid above an aspheric surface with its vertex at the origin, r < `aperture`, up to z = `height`,
/// which may be infinite: curvature and conic constant, coefficients of r^2, r^4, ... and of r, r^3, ...
pub fn asphere(
    aperture: f64,
    [curvature, conic]: [f64; 2],
    [even, odd]: [&[f64]; 2],
    height: f64,
) -> Result<Solid, Error> {
    let base = [("aperture", aperture.into()), ("curvature", curvature.into()), ("conic", conic.into())];
    let terms = [("even", even.into()), ("odd", odd.into()), ("height", height.into())];
    make("asphere", &[base, terms].concat())
}

/// The solid above a biconic surface with its vertex at the origin, r < `aperture`, up to z = `height`, which
/// may be infinite: curvatures and conic constants along x and y.
pub fn biconic(aperture: f64, curvatures: [f64; 2], conics: [f64; 2], height: f64) -> Result<Solid, Error> {
    let base = [("aperture", aperture.into()), ("height", height.into())];
    let x = [("curvature_x", curvatures[0].into()), ("conic_x", conics[0].into())];
    let y = [("curvature_y", curvatures[1].into()), ("conic_y", conics[1].into())];
    make("biconic", &[base, x, y].concat())
}

/// The solid above a freeform surface about the origin, r < `aperture`, up to z = `height`, which may be
/// infinite: curvature and conic constant of the base, coefficients of x, y, x^2, x y, ... and of Noll's
/// Zernike polynomials, both in coordinates divided by `norm_radius` (0 stands for the aperture).
pub fn freeform(
    aperture: f64,
    [curvature, conic]: [f64; 2],
    [xy, zernike]: [&[f64]; 2],
    norm_radius: f64,
    height: f64,
) -> Result<Solid, Error> {
    let base = [("aperture", aperture.into()), ("curvature", curvature.into()), ("conic", conic.into())];
    let terms = [("xy", xy.into()), ("zernike", zernike.into()), ("norm_radius", norm_radius.into())];
    make("freeform", &[&base[..], &terms, &[("height", height.into())]].concat())
}

/// The empty solid: the neutral element of union.
pub fn empty() -> Solid {
    Solid::empty()
}

/// The universe, all of space: the neutral element of intersection.
pub fn universe() -> Solid {
    Solid::universe()
}

/// The union of solids; the union of none is [`empty`].
pub fn union(solids: impl IntoIterator<Item = Solid>) -> Solid {
    Solid::union(solids)
}

/// The intersection of solids; the intersection of none is [`universe`].
pub fn intersection(solids: impl IntoIterator<Item = Solid>) -> Solid {
    Solid::intersection(solids)
}

/// The union of copies of a solid under the maps `world_from_local`. The solid is compiled once for all
/// copies.
pub fn place(solid: &Solid, transforms: impl Into<Arc<[Affine]>>) -> Solid {
    solid.place(transforms)
}

fn make(name: &str, arguments: &[(&str, Value)]) -> Result<Solid, Error> {
    Ok(build(name, arguments)?.into())
}
