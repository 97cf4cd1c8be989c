//! Light pipes and concentrators (CPC): solids that guide light along the axis from `front.plane`
//! (z = -length/2) to `back.plane` (z = length/2) by reflection at their sides.
//!
//! They are solid; subtract the pipe from a block for a hollow one.

use super::aperture::solid;
use super::error::{between, consistent, positive};
use super::{Aperture, ComponentError};
use rayweave_error::Message;
use rayweave_math::{Vec3, sin_cos_degrees};
use rayweave_model::Solid;
use rayweave_shape::primitive::{BoxFromCorners, Cone, HalfSpace};

/// A straight pipe; its sides are `edge.side` (circle, ellipse) or `edge.x-` to `edge.y+`.
///
/// # Errors
/// Sizes that are not positive.
pub fn light_pipe(length: f64, aperture: Aperture) -> Result<Solid, ComponentError> {
    positive("light pipe", "length", length)?;
    super::window(length, aperture)
}

/// A pipe whose outline changes linearly from `front` to `back`: between circles it is a frustum of
/// a cone (`edge.side`), between rectangles a frustum with four plane sides (`left.plane`,
/// `right.plane`, `bottom.plane`, `top.plane`).
///
/// # Errors
/// Sizes that are not positive, outlines of different kinds, ellipses.
pub fn tapered_light_pipe(length: f64, front: Aperture, back: Aperture) -> Result<Solid, ComponentError> {
    let part = "tapered light pipe";
    let length = positive(part, "length", length)?;
    match (front.checked()?, back.checked()?) {
        (Aperture::Circle { diameter: d1 }, Aperture::Circle { diameter: d2 }) => {
            let side = solid(Cone::new(0.5 * d1, 0.5 * d2, length)?).named("edge");
            Ok(side & caps(length)?)
        }
        (Aperture::Rectangle { .. }, Aperture::Rectangle { .. }) => {
            frustum(length, front.size(), back.size())
        }
        _ => Err(ComponentError::Inconsistent(Message::new(
            format!("ends of the {part} have different outlines or are ellipses"),
            "only two circles or two rectangles can be joined",
        ))),
    }
}

/// The faces at both ends, with their names.
fn caps(length: f64) -> Result<Solid, ComponentError> {
    let half = 0.5 * length;
    let front = solid(HalfSpace::new(-Vec3::Z, half)?).named("front");
    Ok(front & solid(HalfSpace::new(Vec3::Z, half)?).named("back"))
}

/// A frustum of a pyramid with the given sizes of its ends.
fn frustum(length: f64, front: [f64; 2], back: [f64; 2]) -> Result<Solid, ComponentError> {
    let side = |name: &str, axis: Vec3, k: usize| -> Result<Solid, ComponentError> {
        let (mean, slope) = (0.25 * (front[k] + back[k]), 0.5 * (back[k] - front[k]) / length);
        // axis . p < mean + slope z
        Ok(solid(HalfSpace::new(axis - slope * Vec3::Z, mean)?).named(name))
    };
    let [x, y] = [0, 1].map(|k| 0.5625 * front[k].max(back[k]));
    let corner = Vec3::new(x, y, 0.5625 * length);
    Ok(Solid::intersection([
        caps(length)?,
        side("left", -Vec3::X, 0)?,
        side("right", Vec3::X, 0)?,
        side("bottom", -Vec3::Y, 1)?,
        side("top", Vec3::Y, 1)?,
        solid(BoxFromCorners::new(-corner, corner)?).named("hull"),
    ]))
}

/// A compound parabolic concentrator of revolution, as a polyline of cones.
#[derive(Clone, Debug, PartialEq)]
pub struct Cpc {
    /// The radius of the entrance, `exit_radius` / sin(acceptance).
    pub entrance_radius: f64,
    /// The radius of the exit.
    pub exit_radius: f64,
    /// The length, (entrance_radius + exit_radius) / tan(acceptance).
    pub length: f64,
    /// Radius and height (r, z) of the joints of the polyline, from the exit (z = 0) to the
    /// entrance (z = `length`). They lie on the true profile.
    pub joints: Vec<[f64; 2]>,
    /// An upper bound of the distance between the polyline and the true profile, inside which it lies.
    pub error: f64,
}

/// The greatest number of cones of a concentrator.
const MAX_CONES: usize = 4096;

impl Cpc {
    /// The concentrator that guides all meridional light within `acceptance_degrees` of the axis to
    /// an exit of this radius.
    ///
    /// Its profile is a parabola with the focal length f = r (1 + sin a), its axis tilted by the
    /// acceptance angle a and its focus on the opposite rim of the exit: in polar coordinates about
    /// the focus `radius = 2 f sin(p - a) / (1 - cos p) - r`, `z = 2 f cos(p - a) / (1 - cos p)`
    /// with p from 2 a to 90 degrees + a (W. T. Welford and R. Winston, *High Collection Nonimaging
    /// Optics*, 1989, section 4.3).
    ///
    /// The surface of revolution has degree 4 and is not a primitive, so it is approximated by
    /// cones through joints on the profile. The joints are equally spaced along the directrix: a
    /// chord of the parabola y = x^2 / (4 f) over a step d deviates from it by at most d^2 / (16
    /// f), which is at most `tolerance`. The direction of the surface deviates by at most d / (4
    /// f).
    ///
    /// # Errors
    /// A radius or tolerance that is not positive, an angle not between 0 and 90 degrees, a
    /// tolerance that would take more than 4096 cones.
    pub fn new(exit_radius: f64, acceptance_degrees: f64, tolerance: f64) -> Result<Cpc, ComponentError> {
        let part = "CPC";
        let exit_radius = positive(part, "exit_radius", exit_radius)?;
        let tolerance = positive(part, "tolerance", tolerance)?;
        let acceptance = between(part, "acceptance_degrees", acceptance_degrees, (0.0, 90.0))?;
        let (sin, cos) = sin_cos_degrees(acceptance);
        let focal_length = exit_radius * (1.0 + sin);
        // positions x = 2 f cot(p / 2) along the directrix, with the cotangents of half the end angles inserted
        let (from, to) = (2.0 * focal_length * cos / (1.0 + sin), 2.0 * focal_length * cos / sin);
        let cones = ((to - from) / (16.0 * focal_length * tolerance).sqrt()).ceil().max(1.0);
        consistent(cones <= MAX_CONES as f64, || {
            let least = tolerance * (cones / MAX_CONES as f64) * (cones / MAX_CONES as f64);
            let problem = format!("tolerance of the {part} is {tolerance}, which needs {cones} cones");
            Message::new(problem, format!("at most {MAX_CONES} are allowed"))
                .suggest(format!("Did you mean {least}?"))
        })?;
        let step = (to - from) / cones;
        let parabola = Parabola { focal_length, exit_radius, sin, cos };
        let joints = (0..=cones as usize).map(|k| parabola.point(from + step * k as f64)).collect();
        let entrance_radius = exit_radius / sin;
        let length = (entrance_radius + exit_radius) * cos / sin;
        let error = step * step / (16.0 * focal_length);
        Ok(Cpc { entrance_radius, exit_radius, length, joints, error })
    }

    /// The solid: the light enters by `front.plane`, the wide end, at z = -length/2 and leaves by
    /// `back.plane` at z = length/2. The profile is convex, so that the solid is the intersection
    /// of all cones, named `edge0`, `edge1`, ... from the exit on.
    ///
    /// # Errors
    /// Sizes out of the range of the primitives.
    pub fn solid(&self) -> Result<Solid, ComponentError> {
        let cone = |(k, ends): (usize, &[[f64; 2]])| -> Result<Solid, ComponentError> {
            let ([r1, z1], [r2, z2]) = (ends[0], ends[1]);
            let slope = (r2 - r1) / (z2 - z1);
            // the line through both joints, extended to the ends, is above the profile and therefore positive
            let (exit, entrance) = (r1 - slope * z1, r1 + slope * (self.length - z1));
            Ok(solid(Cone::new(entrance, exit.max(0.0), self.length)?).named(&format!("edge{k}")))
        };
        let cones = self.joints.windows(2).enumerate().map(cone).collect::<Result<Vec<_>, _>>()?;
        Ok(Solid::intersection([caps(self.length)?].into_iter().chain(cones)))
    }
}

/// The profile of a concentrator.
struct Parabola {
    focal_length: f64,
    exit_radius: f64,
    /// Sine and cosine of the acceptance angle.
    sin: f64,
    cos: f64,
}

impl Parabola {
    /// Radius and height above the exit at a position along the directrix: with t = x / (2 f) =
    /// cot(p / 2), sin p / (1 - cos p) = t and cos p / (1 - cos p) = (t^2 - 1) / 2.
    fn point(&self, x: f64) -> [f64; 2] {
        let size = 2.0 * self.focal_length;
        let t = x / size;
        let (across, along) = (size * t, 0.5 * size * (t - 1.0) * (t + 1.0));
        [across * self.cos - along * self.sin - self.exit_radius, along * self.cos + across * self.sin]
    }
}
