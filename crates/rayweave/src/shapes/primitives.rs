//! Constructors of primitives, generated from their registry: run `cargo xtask generated --accept` instead of editing.

use super::{indices, make};
use crate::Error;
use rayweave_math::Vec3;
use rayweave_model::Solid;

/// A ball centred at the origin.
///
/// - `radius`: distance of the surface from the centre; length, finite and greater than 0.
///
/// Inside: `x^2 + y^2 + z^2 < radius^2`. See [the manual page](crate::shape::primitive::sphere).
pub fn sphere(radius: f64) -> Result<Solid, Error> {
    make("sphere", &[("radius", radius.into())])
}

/// A ball stretched along the axes, centred at the origin.
///
/// - `radii`: half axes along x, y and z; length, finite and greater than 0.
///
/// Inside: `(x/radii[0])^2 + (y/radii[1])^2 + (z/radii[2])^2 < 1`. See [the manual page](crate::shape::primitive::ellipsoid).
pub fn ellipsoid(radii: impl Into<Vec3>) -> Result<Solid, Error> {
    make("ellipsoid", &[("radii", radii.into().into())])
}

/// A box centred at the origin, its sides along the axes.
///
/// - `size`: whole extents along x, y and z; length, finite and greater than 0.
///
/// Inside: `|x| < size[0]/2, |y| < size[1]/2, |z| < size[2]/2`. See [the manual page](crate::shape::primitive::centred_box).
pub fn box_(size: impl Into<Vec3>) -> Result<Solid, Error> {
    make("box", &[("size", size.into().into())])
}

/// A box between two corners, its sides along the axes.
///
/// - `lo`: the corner with the smallest coordinates; length, finite.
/// - `hi`: the corner with the greatest coordinates; length, finite.
///
/// Inside: `lo[k] < (x, y, z)[k] < hi[k] for k = 0, 1, 2`. See [the manual page](crate::shape::primitive::box_from_corners).
pub fn box_from_corners(lo: impl Into<Vec3>, hi: impl Into<Vec3>) -> Result<Solid, Error> {
    make("box_from_corners", &[("lo", lo.into().into()), ("hi", hi.into().into())])
}

/// A round cylinder along z, centred at the origin.
///
/// - `radius`: distance of the side from the axis; length, finite and greater than 0.
/// - `height`: whole extent along z; length, greater than 0, or inf.
///
/// Inside: `x^2 + y^2 < radius^2, |z| < height/2`. See [the manual page](crate::shape::primitive::cylinder).
pub fn cylinder(radius: f64, height: f64) -> Result<Solid, Error> {
    make("cylinder", &[("radius", radius.into()), ("height", height.into())])
}

/// A cone or a frustum along z, centred at the origin.
///
/// - `radius1`: radius at z = -height/2; length, finite and at least 0.
/// - `radius2`: radius at z = height/2; length, finite and at least 0.
/// - `height`: whole extent along z; length, finite and greater than 0.
///
/// Inside: `x^2 + y^2 < (radius1 + (radius2 - radius1) (z/height + 1/2))^2, |z| < height/2`. See [the manual page](crate::shape::primitive::cone).
pub fn cone(radius1: f64, radius2: f64, height: f64) -> Result<Solid, Error> {
    make("cone", &[("radius1", radius1.into()), ("radius2", radius2.into()), ("height", height.into())])
}

/// A half-space: all points on one side of a plane.
///
/// - `normal`: direction out of the solid, of any length; finite and not all 0.
/// - `offset`: value of normal . p on the plane: for a unit normal, its signed distance from the origin; length, finite.
///
/// Inside: `normal . (x, y, z) < offset`. See [the manual page](crate::shape::primitive::half_space).
pub fn half_space(normal: impl Into<Vec3>, offset: f64) -> Result<Solid, Error> {
    make("half_space", &[("normal", normal.into().into()), ("offset", offset.into())])
}

/// A slab: all points between two parallel planes.
///
/// - `normal`: direction across the slab, of any length; finite and not all 0.
/// - `lo`: value of normal . p on the first plane; length, finite.
/// - `hi`: value of normal . p on the second plane; length, finite.
///
/// Inside: `lo < normal . (x, y, z) < hi`. See [the manual page](crate::shape::primitive::slab).
pub fn slab(normal: impl Into<Vec3>, lo: f64, hi: f64) -> Result<Solid, Error> {
    make("slab", &[("normal", normal.into().into()), ("lo", lo.into()), ("hi", hi.into())])
}

/// A torus around z, centred at the origin.
///
/// - `major`: radius of the circle in the middle of the tube; length, finite and greater than 0.
/// - `minor`: radius of the tube; length, finite and greater than 0.
///
/// Inside: `(sqrt(x^2 + y^2) - major)^2 + z^2 < minor^2`. See [the manual page](crate::shape::primitive::torus).
pub fn torus(major: f64, minor: f64) -> Result<Solid, Error> {
    make("torus", &[("major", major.into()), ("minor", minor.into())])
}

/// A paraboloid of revolution around z that opens upwards from the origin.
///
/// - `focal_length`: height of the focus above the vertex; length, finite and greater than 0.
/// - `height`: height of the end above the vertex; length, greater than 0, or inf.
///
/// Inside: `x^2 + y^2 < 4 focal_length z, z < height`. See [the manual page](crate::shape::primitive::paraboloid).
pub fn paraboloid(focal_length: f64, height: f64) -> Result<Solid, Error> {
    make("paraboloid", &[("focal_length", focal_length.into()), ("height", height.into())])
}

/// The inside of a quadric, a surface of the second degree.
///
/// - `matrix`: symmetric matrix Q of the equation; finite.
///
/// Inside: `[x y z 1] Q [x y z 1]^T < 0`. See [the manual page](crate::shape::primitive::quadric).
pub fn quadric(matrix: [[f64; 4]; 4]) -> Result<Solid, Error> {
    make("quadric", &[("matrix", matrix.as_slice().into())])
}

/// A cylinder along z, centred at the origin, with a coaxial hole.
///
/// - `outer_radius`: distance of the outer side from the axis; length, finite and greater than 0.
/// - `inner_radius`: distance of the wall of the hole from the axis; length, finite and at least 0.
/// - `height`: whole extent along z; length, greater than 0, or inf.
///
/// Inside: `inner_radius^2 < x^2 + y^2 < outer_radius^2, |z| < height/2`. See [the manual page](crate::shape::primitive::tube).
pub fn tube(outer_radius: f64, inner_radius: f64, height: f64) -> Result<Solid, Error> {
    make("tube", &[("outer_radius", outer_radius.into()), ("inner_radius", inner_radius.into()), ("height", height.into())])
}

/// A sector of space around the z axis, unbounded along it.
///
/// - `start_degrees`: angle of the first face, from +x towards +y; degrees, finite.
/// - `sweep_degrees`: angle from the first face to the second; degrees, greater than 0 and less than 360.
///
/// Inside: `start_degrees < atan2(y, x) < start_degrees + sweep_degrees (mod 360)`. See [the manual page](crate::shape::primitive::wedge).
pub fn wedge(start_degrees: f64, sweep_degrees: f64) -> Result<Solid, Error> {
    make("wedge", &[("start_degrees", start_degrees.into()), ("sweep_degrees", sweep_degrees.into())])
}

/// A prism over a regular polygon, along z, centred at the origin.
///
/// - `sides`: number of sides of the polygon; a whole number from 3 to 4096.
/// - `radius`: distance of its vertices from the axis; length, finite and greater than 0.
/// - `height`: whole extent along z; length, greater than 0, or inf.
///
/// Inside: `x cos a_k + y sin a_k < radius cos(180/sides) for all a_k = (2 k + 1) 180/sides, |z| < height/2`. See [the manual page](crate::shape::primitive::prism).
pub fn prism(sides: u32, radius: f64, height: f64) -> Result<Solid, Error> {
    make("prism", &[("sides", sides.into()), ("radius", radius.into()), ("height", height.into())])
}

/// A convex polyhedron: the points behind all of the given planes.
///
/// - `planes`: rows (a, b, c, d): outward normal, of any length, and the value of normal . p on the plane; finite and not all 0.
///
/// Inside: `a x + b y + c z < d for all rows (a, b, c, d) of planes`. See [the manual page](crate::shape::primitive::convex).
pub fn convex(planes: &[[f64; 4]]) -> Result<Solid, Error> {
    make("convex", &[("planes", planes.into())])
}

/// The solid inside a closed triangle mesh.
///
/// - `vertices`: the points; length, finite.
/// - `faces`: triangles: the numbers of their three corners, from 0; a whole number from 0 to 268435455.
///
/// Inside: `a line from (x, y, z) to infinity crosses the triangles an odd number of times`. See [the manual page](crate::shape::primitive::mesh).
pub fn mesh(vertices: &[[f64; 3]], faces: &[[u32; 3]]) -> Result<Solid, Error> {
    make("mesh", &[("vertices", vertices.into()), ("faces", indices(faces).as_slice().into())])
}

/// A body bounded by an aspheric surface of revolution around z: above a conic with polynomial terms, within its aperture.
///
/// - `aperture`: radius of the aperture; length, finite and greater than 0.
/// - `curvature`: one over the radius of curvature at the vertex; positive if the surface bends towards +z; 1/length, finite.
/// - `conic`: conic constant: 0 for a sphere, -1 for a paraboloid; finite.
/// - `even`: coefficients of r^2, r^4, r^6, ...; finite.
/// - `odd`: coefficients of r, r^3, r^5, ...; finite.
/// - `height`: height of the flat end above the vertex; length, greater than 0, or inf.
///
/// Inside: `r < aperture, curvature r^2 / (1 + sqrt(1 - (1 + conic) curvature^2 r^2)) + sum of terms < z < height`. See [the manual page](crate::shape::primitive::asphere).
pub fn asphere(aperture: f64, curvature: f64, conic: f64, even: &[f64], odd: &[f64], height: f64) -> Result<Solid, Error> {
    make("asphere", &[("aperture", aperture.into()), ("curvature", curvature.into()), ("conic", conic.into()), ("even", even.into()), ("odd", odd.into()), ("height", height.into())])
}

/// A body bounded by a biconic surface: above conics of different curvature along x and y, within its aperture.
///
/// - `aperture`: radius of the aperture; length, finite and greater than 0.
/// - `curvature_x`: curvature at the vertex along x; positive if the surface bends towards +z; 1/length, finite.
/// - `curvature_y`: curvature at the vertex along y; 1/length, finite.
/// - `conic_x`: conic constant along x; finite.
/// - `conic_y`: conic constant along y; finite.
/// - `height`: height of the flat end above the vertex; length, greater than 0, or inf.
///
/// Inside: `x^2 + y^2 < aperture^2, (cx x^2 + cy y^2) / (1 + sqrt(1 - (1 + kx) cx^2 x^2 - (1 + ky) cy^2 y^2)) < z < height`. See [the manual page](crate::shape::primitive::biconic).
pub fn biconic(aperture: f64, curvature_x: f64, curvature_y: f64, conic_x: f64, conic_y: f64, height: f64) -> Result<Solid, Error> {
    make("biconic", &[("aperture", aperture.into()), ("curvature_x", curvature_x.into()), ("curvature_y", curvature_y.into()), ("conic_x", conic_x.into()), ("conic_y", conic_y.into()), ("height", height.into())])
}

/// A body bounded by a freeform surface: above a conic with terms in x and y or Zernike polynomials, within its aperture.
///
/// - `aperture`: radius of the aperture; length, finite and greater than 0.
/// - `curvature`: one over the radius of curvature of the base; positive if it bends towards +z; 1/length, finite.
/// - `conic`: conic constant of the base; finite.
/// - `xy`: coefficients of x, y, x^2, x y, y^2, x^3, x^2 y, ..., lengths; finite.
/// - `zernike`: coefficients of Noll's Z1, Z2, ..., lengths; finite.
/// - `norm_radius`: length by which x and y are divided; 0 for that of the aperture; length, finite and at least 0.
/// - `height`: height of the flat end above the origin; length, greater than 0, or inf.
///
/// Inside: `x^2 + y^2 < aperture^2, conic + sum of terms of x / norm_radius and y / norm_radius < z < height`. See [the manual page](crate::shape::primitive::freeform).
pub fn freeform(aperture: f64, curvature: f64, conic: f64, xy: &[f64], zernike: &[f64], norm_radius: f64, height: f64) -> Result<Solid, Error> {
    make("freeform", &[("aperture", aperture.into()), ("curvature", curvature.into()), ("conic", conic.into()), ("xy", xy.into()), ("zernike", zernike.into()), ("norm_radius", norm_radius.into()), ("height", height.into())])
}
