//! Ray patterns of sources: origins and directions in the frame of the source.

use super::error::{angle, positive};
use super::listed::ListedRays;
use super::random::Numbers;
use super::rays::LocalRay;
use super::sampling::Place;
use super::{Sampling, SourceError};
use crate::component::Aperture;
use rayweave_error::Message;
use rayweave_math::{Vec3, sin_cos_degrees};

/// Origins and directions of the rays in the frame of the source: about the origin and along +z.
///
/// The first five are those of PyRayT, whose x axis is z here.
#[derive(Clone, Debug, PartialEq)]
pub enum Pattern {
    /// Parallel rays in a row along y, evenly spaced from -`length`/2 to `length`/2.
    Line {
        /// The distance between the first ray and the last.
        length: f64,
        /// The number of rays.
        count: u64,
    },
    /// Parallel rays around a circle, evenly spaced from +x towards +y. (PyRayT's last ray
    /// coincides with its first.)
    Circle {
        /// The diameter of the circle.
        diameter: f64,
        /// The number of rays.
        count: u64,
    },
    /// Rays from the origin along the surface of a cone, evenly spaced from +x towards +y.
    Cone {
        /// The angle between every ray and the axis, in degrees.
        half_angle_degrees: f64,
        /// The number of rays.
        count: u64,
    },
    /// Rays from the origin in the y-z plane, at even angles from -`angle_degrees`/2 (towards -y)
    /// to `angle_degrees`/2.
    Wedge {
        /// The angle between the first ray and the last, in degrees.
        angle_degrees: f64,
        /// The number of rays.
        count: u64,
    },
    /// A Lambertian lamp like that of PyRayT: rays from random points of a rectangle into random
    /// directions, uniform in solid angle, whose power is proportional to the cosine of their angle
    /// to the axis.
    Lamp {
        /// The extent of the rectangle along x.
        width: f64,
        /// The extent of the rectangle along y.
        height: f64,
        /// The greatest angle to the axis, in degrees, at most 90.
        half_angle_degrees: f64,
        /// The number of rays.
        count: u64,
    },
    /// Parallel rays over an aperture.
    Beam {
        /// The outline of the beam.
        aperture: Aperture,
        /// The distribution of power across it.
        profile: BeamProfile,
        /// The sampling of the aperture.
        sampling: Sampling,
    },
    /// Rays from the origin into a cone, uniform in solid angle.
    Point {
        /// The greatest angle to the axis, in degrees; 180 for all directions.
        half_angle_degrees: f64,
        /// The sampling of the directions.
        sampling: Sampling,
    },
    /// Rays of equal power from random points of an aperture in the plane z = 0.
    Extended {
        /// The outline of the source.
        aperture: Aperture,
        /// The directions from each point.
        emission: Emission,
        /// The greatest angle to the axis, in degrees, at most 90.
        half_angle_degrees: f64,
        /// The number of rays.
        count: u64,
    },
    /// A list of rays.
    Rays(ListedRays),
}

/// The distribution of power across a beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BeamProfile {
    /// Uniform.
    TopHat,
    /// Proportional to `exp(-2 r^2 / radius^2)`, truncated by the aperture, with rays of equal
    /// power and varying density. Over an ellipse the profile is stretched like it; `radius` is
    /// then the radius along x.
    Gaussian {
        /// The distance from the axis at which the irradiance is 1/e^2 of that on the axis.
        radius: f64,
    },
}

/// The directions of rays from each point of an extended source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Emission {
    /// Lambert's cosine law: power per solid angle proportional to the cosine of the angle to the
    /// axis. The sines of the angles squared are uniform.
    Lambert,
    /// Uniform power per solid angle. The cosines of the angles are uniform.
    Isotropic,
}

impl Pattern {
    /// The number of rays.
    pub fn count(&self) -> u64 {
        match self {
            Pattern::Line { count, .. }
            | Pattern::Circle { count, .. }
            | Pattern::Cone { count, .. }
            | Pattern::Wedge { count, .. }
            | Pattern::Lamp { count, .. }
            | Pattern::Extended { count, .. } => *count,
            Pattern::Beam { sampling, .. } | Pattern::Point { sampling, .. } => sampling.count(),
            Pattern::Rays(listed) => listed.len() as u64,
        }
    }

    /// The name in messages.
    fn name(&self) -> &'static str {
        match self {
            Pattern::Line { .. } => "line of rays",
            Pattern::Circle { .. } => "circle of rays",
            Pattern::Cone { .. } => "cone of rays",
            Pattern::Wedge { .. } => "wedge of rays",
            Pattern::Lamp { .. } => "lamp",
            Pattern::Beam { .. } => "beam",
            Pattern::Point { .. } => "point source",
            Pattern::Extended { .. } => "extended source",
            Pattern::Rays(_) => "rays",
        }
    }

    /// True if it needs random numbers.
    pub(super) fn is_random(&self) -> bool {
        match self {
            Pattern::Lamp { .. } | Pattern::Extended { .. } => true,
            Pattern::Beam { sampling, .. } | Pattern::Point { sampling, .. } => sampling.is_random(),
            _ => false,
        }
    }

    /// The mean weight of the rays: for a lamp, the mean of cosines distributed uniformly between
    /// the cosine of its angle and 1.
    pub(super) fn mean_weight(&self) -> f64 {
        match self {
            Pattern::Lamp { half_angle_degrees, .. } => 0.5 + 0.5 * sin_cos_degrees(*half_angle_degrees).1,
            Pattern::Rays(listed) => listed.mean_power(),
            _ => 1.0,
        }
    }

    /// The pattern, if all its settings are in range and consistent.
    fn checked(self) -> Result<Pattern, SourceError> {
        let (part, count) = (self.name(), self.count());
        if count == 0 || count > 1 << 53 {
            return Err(SourceError::Count { part, count });
        }
        match &self {
            Pattern::Line { length, .. } => {
                positive(part, "length", *length)?;
            }
            Pattern::Circle { diameter, .. } => {
                positive(part, "diameter", *diameter)?;
            }
            Pattern::Cone { half_angle_degrees, .. } | Pattern::Point { half_angle_degrees, .. } => {
                angle(part, "half_angle_degrees", *half_angle_degrees, 180.0)?;
            }
            Pattern::Wedge { angle_degrees, .. } => {
                angle(part, "angle_degrees", *angle_degrees, 360.0)?;
            }
            Pattern::Lamp { width, height, half_angle_degrees, .. } => {
                Aperture::rectangle(*width, *height).checked()?;
                angle(part, "half_angle_degrees", *half_angle_degrees, 90.0)?;
            }
            Pattern::Beam { aperture, profile, sampling } => check_beam(part, aperture, profile, sampling)?,
            Pattern::Extended { aperture, half_angle_degrees, .. } => {
                aperture.checked()?;
                angle(part, "half_angle_degrees", *half_angle_degrees, 90.0)?;
            }
            Pattern::Rays(_) => {}
        }
        Ok(self)
    }

    /// The greatest angle to the axis, in degrees.
    fn half_angle_degrees(&self) -> f64 {
        match self {
            Pattern::Cone { half_angle_degrees, .. }
            | Pattern::Lamp { half_angle_degrees, .. }
            | Pattern::Point { half_angle_degrees, .. }
            | Pattern::Extended { half_angle_degrees, .. } => *half_angle_degrees,
            _ => 0.0,
        }
    }

    /// The fraction of the power of a whole beam that its aperture transmits.
    fn passed(&self) -> f64 {
        match self {
            Pattern::Beam { aperture, profile, .. } => profile.within(0.5 * aperture.size()[0]),
            _ => 1.0,
        }
    }
}

/// A pattern with the values that all its rays share.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Prepared {
    pub pattern: Pattern,
    angle: Angle,
    passed: f64,
}

/// The greatest angle to the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Angle {
    sin: f64,
    cos: f64,
    /// 1 - cos, without cancellation for small angles.
    drop: f64,
}

impl Prepared {
    pub fn new(pattern: Pattern) -> Result<Prepared, SourceError> {
        let pattern = pattern.checked()?;
        let degrees = pattern.half_angle_degrees();
        let ((sin, cos), (sin_half, _)) = (sin_cos_degrees(degrees), sin_cos_degrees(0.5 * degrees));
        let angle = Angle { sin, cos, drop: 2.0 * sin_half * sin_half };
        Ok(Prepared { angle, passed: pattern.passed(), pattern })
    }

    /// Ray `k` from its random numbers, of which it may use the first four.
    pub fn ray(&self, k: u64, numbers: &Numbers) -> LocalRay {
        let angle = &self.angle;
        match &self.pattern {
            Pattern::Line { length, count } => along_z(Vec3::Y * (length * centred(k, *count)), 1.0),
            Pattern::Circle { diameter, count } => {
                along_z(0.5 * diameter * around(k as f64 / *count as f64), 1.0)
            }
            Pattern::Cone { count, .. } => {
                from_origin(tilted(angle.sin, angle.cos, k as f64 / *count as f64), 1.0)
            }
            Pattern::Wedge { angle_degrees, count } => {
                let (sin, cos) = sin_cos_degrees(angle_degrees * centred(k, *count));
                from_origin(Vec3::new(0.0, sin, cos), 1.0)
            }
            Pattern::Lamp { width, height, .. } => {
                let direction = angle.isotropic(numbers[2], numbers[3]);
                let origin = Vec3::new(width * (numbers[0] - 0.5), height * (numbers[1] - 0.5), 0.0);
                LocalRay { origin, direction, weight: direction.z }
            }
            Pattern::Beam { aperture, profile, sampling } => {
                beam(aperture, profile, sampling, self.passed, k, numbers)
            }
            Pattern::Point { sampling, .. } => {
                let Place { area, turn, weight } = sampling.in_disc(k, numbers);
                from_origin(angle.isotropic(area, turn), weight)
            }
            Pattern::Extended { aperture, emission, .. } => {
                let start = beam(aperture, &BeamProfile::TopHat, &ANYWHERE, 1.0, k, numbers);
                let direction = match emission {
                    Emission::Lambert => angle.lambert(numbers[2], numbers[3]),
                    Emission::Isotropic => angle.isotropic(numbers[2], numbers[3]),
                };
                LocalRay { direction, ..start }
            }
            Pattern::Rays(listed) => listed.ray(k as usize),
        }
    }
}

impl Angle {
    /// Uniform in solid angle: cosines uniform between the cosine of the greatest angle and 1
    /// (Archimedes: a zone's area is proportional to its height).
    fn isotropic(&self, part: f64, turn: f64) -> Vec3 {
        let drop = self.drop * part;
        tilted((drop * (2.0 - drop)).max(0.0).sqrt(), 1.0 - drop, turn)
    }

    /// Lambertian: squares of sines uniform, so that the disc below a hemisphere is covered
    /// uniformly (Malley's method).
    fn lambert(&self, part: f64, turn: f64) -> Vec3 {
        let square = self.sin * self.sin * part;
        tilted(square.sqrt(), (1.0 - square).max(0.0).sqrt(), turn)
    }
}

/// Random sampling, of any number of points.
const ANYWHERE: Sampling = Sampling::Random { count: 0 };

fn check_beam(
    part: &'static str,
    aperture: &Aperture,
    profile: &BeamProfile,
    sampling: &Sampling,
) -> Result<(), SourceError> {
    let is_rectangle = matches!(aperture.checked()?, Aperture::Rectangle { .. });
    if is_rectangle {
        sampling.checked_for_rectangle(part)?;
    }
    match profile {
        BeamProfile::Gaussian { .. } if is_rectangle => {
            let problem = format!("{part} has a Gaussian profile over a rectangle");
            let message = Message::new(problem, "the profile is round").suggest("Use an ellipse");
            Err(SourceError::Inconsistent(message))
        }
        BeamProfile::Gaussian { radius } => positive(part, "radius", *radius).map(drop),
        BeamProfile::TopHat => Ok(()),
    }
}

fn along_z(origin: Vec3, weight: f64) -> LocalRay {
    LocalRay { origin, direction: Vec3::Z, weight }
}

fn from_origin(direction: Vec3, weight: f64) -> LocalRay {
    LocalRay { origin: Vec3::ZERO, direction, weight }
}

/// From -1/2 for the first of `count` to 1/2 for the last; 0 for a single one.
fn centred(k: u64, count: u64) -> f64 {
    if count < 2 { 0.0 } else { k as f64 / (count - 1) as f64 - 0.5 }
}

/// The unit vector at an azimuth of 0 to 1 turns; exact at the quarters.
fn around(turn: f64) -> Vec3 {
    let quarter = (4.0 * turn + 0.5) as u32;
    let (sin, cos) = libm::sincos((turn - 0.25 * f64::from(quarter)) * std::f64::consts::TAU);
    let (x, y) = match quarter {
        1 => (-sin, cos),
        2 => (-cos, -sin),
        3 => (sin, -cos),
        _ => (cos, sin),
    };
    Vec3::new(x, y, 0.0)
}

/// The direction at an angle to the axis, given by its sine and cosine.
fn tilted(sin: f64, cos: f64, turn: f64) -> Vec3 {
    (sin * around(turn)).with_z(cos)
}

fn beam(
    aperture: &Aperture,
    profile: &BeamProfile,
    sampling: &Sampling,
    passed: f64,
    k: u64,
    numbers: &Numbers,
) -> LocalRay {
    let [width, height] = aperture.size();
    if let Aperture::Rectangle { .. } = aperture {
        let [u, v] = sampling.in_square(k, numbers);
        return along_z(Vec3::new(width * (u - 0.5), height * (v - 0.5), 0.0), 1.0);
    }
    let Place { area, turn, weight } = sampling.in_disc(k, numbers);
    let point = profile.radius(area * passed, 0.5 * width) * around(turn);
    // a factor of exactly 1 for a circle
    along_z(Vec3::new(point.x, point.y * (height / width), 0.0), weight)
}

impl BeamProfile {
    /// The fraction of the power within a distance from the axis; 1 for a top hat, which ends at
    /// the aperture.
    fn within(&self, distance: f64) -> f64 {
        match *self {
            BeamProfile::TopHat => 1.0,
            BeamProfile::Gaussian { radius } => {
                -libm::expm1(-2.0 * (distance / radius) * (distance / radius))
            }
        }
    }

    /// The distance from the axis within which a fraction of the power lies, at most `limit`.
    fn radius(&self, part: f64, limit: f64) -> f64 {
        match *self {
            BeamProfile::TopHat => limit * part.sqrt(),
            BeamProfile::Gaussian { radius } => (radius * (-0.5 * libm::log1p(-part)).sqrt()).min(limit),
        }
    }
}
