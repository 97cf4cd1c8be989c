//! Prisms: solids with plane, named faces.
//!
//! Each is a polygon in the y-z plane, with light along +z, extruded along x. A slightly larger box
//! around it, named `hull`, gives evaluators a finite bound; no ray hits its faces.

use super::aperture::solid;
use super::error::{between, consistent, positive};
use super::{Aperture, ComponentError};
use rayweave_error::Message;
use rayweave_math::{Vec3, sin_cos_degrees};
use rayweave_model::Solid;
use rayweave_shape::primitive::{BoxFromCorners, Convex, HalfSpace, Primitive};

/// The name, the outward normal and a point of a face.
type Plane = (&'static str, Vec3, Vec3);

/// The points behind all planes.
fn polyhedron(planes: &[Plane]) -> Result<Solid, ComponentError> {
    let rows = planes.iter().map(|(_, n, p)| [n.x, n.y, n.z, n.dot(*p)]).collect();
    let bounds = Primitive::from(Convex::new(rows)?).lower().bounds;
    let margin = Vec3::splat((bounds.hi - bounds.lo).max_element() / 16.0);
    let hull = solid(BoxFromCorners::new(bounds.lo - margin, bounds.hi + margin)?).named("hull");
    let face = |&(name, normal, point): &Plane| -> Result<Solid, ComponentError> {
        Ok(solid(HalfSpace::new(normal, normal.dot(point))?).named(name))
    };
    let faces = planes.iter().map(face).collect::<Result<Vec<_>, _>>()?;
    Ok(Solid::intersection(faces.into_iter().chain([hull])))
}

/// A point of the y-z plane.
fn at(y: f64, z: f64) -> Vec3 {
    Vec3::new(0.0, y, z)
}

/// The planes x = -`width`/2 and x = `width`/2, named `left` and `right`.
fn ends(width: f64) -> [Plane; 2] {
    let half = Vec3::X * (0.5 * width);
    [("left", -Vec3::X, -half), ("right", Vec3::X, half)]
}

/// The prism over a polygon in the y-z plane given by normals and points.
fn extruded(faces: &[Plane], width: f64) -> Result<Solid, ComponentError> {
    polyhedron(&[faces, &ends(width)].concat())
}

/// A prism over an isosceles triangle: the faces `front.plane` and `back.plane` of length `side`,
/// which meet above (+y) at `apex_degrees`, and the `base.plane` below. The origin is in the middle
/// of its height.
///
/// Its least deviation is `2 asin(n sin(A/2)) - A`, with the apex angle A (Born & Wolf, *Principles
/// of Optics*, 4.7.2).
///
/// # Errors
/// Sizes that are not positive, an apex not between 0 and 180 degrees.
pub fn dispersing_prism(apex_degrees: f64, side: f64, width: f64) -> Result<Solid, ComponentError> {
    let part = "prism";
    let apex = between(part, "apex_degrees", apex_degrees, (0.0, 180.0))?;
    let (side, width) = (positive(part, "side", side)?, positive(part, "width", width)?);
    let (sin, cos) = sin_cos_degrees(0.5 * apex);
    let top = at(0.5 * side * cos, 0.0);
    extruded(&[("front", at(sin, -cos), top), ("back", at(sin, cos), top), ("base", -Vec3::Y, -top)], width)
}

/// The prism over an equilateral triangle: a [`dispersing_prism`] with an apex angle of 60 degrees.
///
/// # Errors
/// Sizes that are not positive.
pub fn equilateral_prism(side: f64, width: f64) -> Result<Solid, ComponentError> {
    dispersing_prism(60.0, side, width)
}

/// A right-angle prism: light along +z enters by `front.plane` (z = -`leg`/2), is reflected by
/// `hypotenuse.plane` and leaves along +y by `exit.plane` (y = `leg`/2). Its path in the glass is
/// `leg` long.
///
/// # Errors
/// Sizes that are not positive.
pub fn right_angle_prism(leg: f64, width: f64) -> Result<Solid, ComponentError> {
    let part = "right-angle prism";
    let half = 0.5 * positive(part, "leg", leg)?;
    let faces = [
        ("front", -Vec3::Z, at(0.0, -half)),
        ("exit", Vec3::Y, at(half, 0.0)),
        ("hypotenuse", at(-1.0, 1.0), Vec3::ZERO),
    ];
    extruded(&faces, positive(part, "width", width)?)
}

/// A penta prism: light along +z enters by `front.plane` (z = -`side`/2), is reflected by
/// `mirror1.plane` and `mirror2.plane`, which need a coating, and leaves along -y by `exit.plane`
/// (y = -`side`/2): deviated by 90 degrees, independent of the tilt of the prism, after a path of
/// (2 + sqrt(2)) `side`. The fifth face is `roof.plane`.
///
/// # Errors
/// Sizes that are not positive.
pub fn penta_prism(side: f64, width: f64) -> Result<Solid, ComponentError> {
    let part = "penta prism";
    let half = 0.5 * positive(part, "side", side)?;
    let (sin, cos) = sin_cos_degrees(22.5);
    let far = 2.0 * half * std::f64::consts::SQRT_2 - half;
    let faces = [
        ("front", -Vec3::Z, at(0.0, -half)),
        ("exit", -Vec3::Y, at(-half, 0.0)),
        ("mirror1", at(-sin, cos), at(-half, half)),
        ("mirror2", at(cos, -sin), at(half, -half)),
        ("roof", at(1.0, 1.0), at(half, far)),
    ];
    extruded(&faces, positive(part, "width", width)?)
}

/// A Dove prism: light along +z enters by `front.plane`, tilted by 45 degrees, is reflected by
/// `base.plane` below (y = -`height`/2), leaves by `back.plane` along +z, and the image is
/// inverted. `length` is that of the base; the other side, `top.plane`, is shorter by 2 `height`.
///
/// A beam that fills the height needs the [`dove_length`].
///
/// # Errors
/// Sizes that are not positive, a length that is not greater than 2 `height`.
pub fn dove_prism(height: f64, length: f64, width: f64) -> Result<Solid, ComponentError> {
    let part = "Dove prism";
    let (height, length) = (positive(part, "height", height)?, positive(part, "length", length)?);
    consistent(length > 2.0 * height, || {
        let problem = format!("length of the {part} is {length} and its height {height}");
        let reason = "both ends are cut at 45 degrees, so that the top is shorter than the base by 2 heights";
        Message::new(problem, reason).suggest(format!("Did you mean a length of {}?", 4.0 * height))
    })?;
    let (y, z) = (0.5 * height, 0.5 * length);
    let faces = [
        ("front", at(1.0, -1.0), at(-y, -z)),
        ("back", at(1.0, 1.0), at(-y, z)),
        ("base", -Vec3::Y, at(-y, 0.0)),
        ("top", Vec3::Y, at(y, 0.0)),
    ];
    extruded(&faces, positive(part, "width", width)?)
}

/// The base length with which a [`dove_prism`] of this height and refractive index transmits a beam
/// of full height: `2 height q / (q - 1)` with q = sqrt(2 n^2 - 1).
///
/// A ray travels down to the base at the angle d = 45 - asin(sin 45 / n) degrees. A ray that enters
/// at the height y above the base hits it y (1 + cot d) behind its end and leaves at the height y',
/// where y' (1 + cot d) is the rest of the length. Rays at all heights leave the prism, y' =
/// `height` - y, if the length is `height` (1 + cot d).
///
/// # Errors
/// A height that is not positive, an index that is not greater than 1.
pub fn dove_length(height: f64, index: f64) -> Result<f64, ComponentError> {
    let part = "Dove prism";
    let height = positive(part, "height", height)?;
    let index = between(part, "index", index, (1.0, f64::INFINITY))?;
    let q = (2.0 * index * index - 1.0).sqrt();
    Ok(2.0 * height * q / (q - 1.0))
}

/// An Amici roof prism: a right-angle prism whose hypotenuse is a roof, `roof1.plane` (x > 0) and
/// `roof2.plane` at right angles with the ridge x = 0, z = y. Light along +z in a beam of
/// `diameter` about the axis enters by `front.plane` (z = -sqrt(3)/2 `diameter`) and leaves along
/// +y by `exit.plane` (y = sqrt(3)/2 `diameter`), x exchanged with -x, after a path of sqrt(3)
/// `diameter`.
///
/// A ray at (x, y) hits one half of the roof at z = y - sqrt(2) |x| and the other at the height y +
/// sqrt(2) |x|; over the circle that is at most sqrt(3)/2 `diameter`, the distance of the front and
/// exit faces from the origin.
///
/// # Errors
/// A diameter that is not positive.
pub fn amici_prism(diameter: f64) -> Result<Solid, ComponentError> {
    let diameter = positive("Amici prism", "diameter", diameter)?;
    let reach = 0.75f64.sqrt() * diameter;
    let roof = |x: f64| Vec3::new(x * std::f64::consts::SQRT_2, -1.0, 1.0);
    let faces = [
        ("front", -Vec3::Z, at(0.0, -reach)),
        ("exit", Vec3::Y, at(reach, 0.0)),
        ("roof1", roof(1.0), Vec3::ZERO),
        ("roof2", roof(-1.0), Vec3::ZERO),
    ];
    extruded(&faces, diameter)
}

/// A corner cube: light along +z enters by the triangle `front.plane` in z = 0, is reflected by
/// three faces at right angles, `mirror1.plane` to `mirror3.plane`, that meet at (0, 0, `depth`),
/// and is retroreflected. The path in the glass is 2 `depth` long at normal incidence. A circle of
/// diameter sqrt(2) `depth` about the axis lies within the front.
///
/// # Errors
/// A depth that is not positive.
pub fn corner_cube(depth: f64) -> Result<Solid, ComponentError> {
    let depth = positive("corner cube", "depth", depth)?;
    let corner = at(0.0, depth);
    let mirror = |degrees: f64| {
        let (sin, cos) = sin_cos_degrees(degrees);
        // at right angles to each other: sqrt(2) across, 1 along the axis
        Vec3::new(cos, sin, std::f64::consts::FRAC_1_SQRT_2)
    };
    polyhedron(&[
        ("front", -Vec3::Z, Vec3::ZERO),
        ("mirror1", mirror(90.0), corner),
        ("mirror2", mirror(210.0), corner),
        ("mirror3", mirror(330.0), corner),
    ])
}

/// A wedge: a plate whose `back.plane` is tilted, so that it is thicker towards -y. `thickness` is
/// that on the axis, from `front.plane` at z = -`thickness`/2; the rim is `edge`.
///
/// A thin wedge deviates light by `(n - 1) wedge_degrees` towards its thick side.
///
/// # Errors
/// Sizes that are not positive, an angle not between 0 and 90 degrees, planes that meet inside the aperture.
pub fn wedge_prism(wedge_degrees: f64, thickness: f64, aperture: Aperture) -> Result<Solid, ComponentError> {
    let part = "wedge prism";
    let (sin, cos) = sin_cos_degrees(between(part, "wedge_degrees", wedge_degrees, (0.0, 90.0))?);
    let half = 0.5 * positive(part, "thickness", thickness)?;
    let reach = 0.5 * aperture.checked()?.size()[1];
    let (height, rise) = (thickness * cos / sin, reach * sin / cos);
    if height < reach * (1.0 - 1e-13) {
        let [first, second] = ["front", "back"].map(str::to_owned);
        return Err(ComponentError::SurfacesCross { part, first, second, height, reach });
    }
    let front = solid(HalfSpace::new(-Vec3::Z, half)?).named("front");
    let back = solid(HalfSpace::new(at(sin, cos), half * cos)?).named("back");
    let margin = 0.25 * thickness.max(reach);
    let edge = aperture.column([0.0; 2], [-half - margin, half + rise + margin])?.named("edge");
    Ok(Solid::intersection([front, back, edge]))
}

/// The two prisms of a beam-splitter cube about the origin, cemented at the face `split.plane` (z =
/// y), which is bitwise the same surface in both. Light along +z enters the first by `front.plane`;
/// reflected light leaves it along +y by `exit.plane`, transmitted light leaves the second by
/// `back.plane`. The fourth face is `bottom.plane` of the second.
///
/// # Errors
/// A side that is not positive.
pub fn beam_splitter_cube(side: f64) -> Result<[Solid; 2], ComponentError> {
    let half = 0.5 * positive("beam-splitter cube", "side", side)?;
    let first = [
        ("front", -Vec3::Z, at(0.0, -half)),
        ("exit", Vec3::Y, at(half, 0.0)),
        ("split", at(-1.0, 1.0), Vec3::ZERO),
    ];
    let second = [
        ("back", Vec3::Z, at(0.0, half)),
        ("bottom", -Vec3::Y, at(-half, 0.0)),
        ("split", at(1.0, -1.0), Vec3::ZERO),
    ];
    Ok([extruded(&first, side)?, extruded(&second, side)?])
}
