//! Where rays start and where they go, in the source's own coordinates.

use super::error::{angle, positive};
use super::listed::ListedRays;
use super::random::Numbers;
use super::sampling::Place;
use super::{Sampling, SourceError};
use crate::component::Aperture;
use rayweave_math::{Vec3, sin_cos_degrees};

/// Where rays start and where they go, in the source's own coordinates: about the origin and along +z.
///
/// The first five are those of PyRayT, whose x is our z.
#[derive(Clone, Debug, PartialEq)]
pub enum Pattern {
    /// Parallel rays in a row along y, evenly spaced from -`length`/2 to `length`/2.
    Line {
        /// The distance between the first ray and the last.
        length: f64,
        /// The number of rays.
        count: u64,
    },
    /// Parallel rays around a circle, evenly spaced from +x towards +y. (PyRayT's last ray coincides with its first.)
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
    /// Rays from the origin in the y-z plane, at even angles from -`angle_degrees`/2 (towards -y) to `angle_degrees`/2.
    Wedge {
        /// The angle between the first ray and the last, in degrees.
        angle_degrees: f64,
        /// The number of rays.
        count: u64,
    },
    /// A Lambertian lamp as PyRayT has it: rays from random points of a rectangle into random directions, uniform in solid
    /// angle, whose power is proportional to the cosine of their angle to the axis.
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
        /// How rays are spread over it.
        sampling: Sampling,
    },
    /// Rays from the origin into a cone, evenly in solid angle.
    Point {
        /// The greatest angle to the axis, in degrees; 180 for all directions.
        half_angle_degrees: f64,
        /// How rays are spread over the directions.
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
    /// Rays given one by one.
    Rays(ListedRays),
}

/// The distribution of power across a beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BeamProfile {
    /// The same everywhere.
    TopHat,
    /// Proportional to `exp(-2 r^2 / radius^2)`, cut off by the aperture, by rays of equal power that lie as much closer to
    /// each other. Over an ellipse it is as long and as wide as that; `radius` is then that along x.
    Gaussian {
        /// The distance from the axis at which the irradiance is 1/e^2 of that on the axis.
        radius: f64,
    },
}

/// The directions of rays from each point of an extended source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Emission {
    /// Lambert's law: power per solid angle proportional to the cosine of the angle to the axis. The sines of the angles
    /// squared are uniform.
    Lambert,
    /// The same power in every solid angle. The cosines of the angles are uniform.
    Isotropic,
}

/// A ray in the source's own coordinates.
pub(super) struct LocalRay {
    pub origin: Vec3,
    /// Of unit length, to rounding.
    pub direction: Vec3,
    /// What it counts for.
    pub weight: f64,
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

    /// What it is called in messages.
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

    /// The mean of the weights of its rays: of a lamp that of cosines uniform between that of its angle and 1.
    pub(super) fn mean_weight(&self) -> f64 {
        match self {
            Pattern::Lamp { half_angle_degrees, .. } => 0.5 + 0.5 * sin_cos_degrees(*half_angle_degrees).1,
            Pattern::Rays(listed) => listed.mean_power(),
            _ => 1.0,
        }
    }

    /// The pattern, if all its settings are in their ranges and fit together.
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

    /// The angle that its directions are made of, in degrees.
    fn half_angle_degrees(&self) -> f64 {
        match self {
            Pattern::Cone { half_angle_degrees, .. }
            | Pattern::Lamp { half_angle_degrees, .. }
            | Pattern::Point { half_angle_degrees, .. }
            | Pattern::Extended { half_angle_degrees, .. } => *half_angle_degrees,
            _ => 0.0,
        }
    }

    /// The part of the power of a whole beam that its aperture lets pass.
    fn passed(&self) -> f64 {
        match self {
            Pattern::Beam { aperture, profile, .. } => profile.within(0.5 * aperture.size()[0]),
            _ => 1.0,
        }
    }
}

/// A pattern with what all its rays have in common.
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
    /// 1 - cos, with all its digits where the angle is small.
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

    /// Ray `k` by its random numbers, of which the first four may be used.
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
    /// Cosines uniform between that of the greatest angle and 1 (Archimedes: a zone's area is proportional to its height).
    fn isotropic(&self, part: f64, turn: f64) -> Vec3 {
        let drop = self.drop * part;
        tilted((drop * (2.0 - drop)).max(0.0).sqrt(), 1.0 - drop, turn)
    }

    /// Squares of sines uniform: the disc below a hemisphere is covered evenly (Malley's method).
    fn lambert(&self, part: f64, turn: f64) -> Vec3 {
        let square = self.sin * self.sin * part;
        tilted(square.sqrt(), (1.0 - square).max(0.0).sqrt(), turn)
    }
}

/// Random places, however many.
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
        BeamProfile::Gaussian { .. } if is_rectangle => Err(SourceError::Unfit {
            part,
            problem: "a Gaussian profile over a rectangle (it is round) is an ellipse meant?",
        }),
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

/// From -1/2 for the first of so many to 1/2 for the last; 0 if there is one only.
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

/// The direction at an angle to the axis, by its sine and cosine.
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
    /// The part of the power within a distance from the axis; of a top hat, whose aperture is all there is, 1.
    fn within(&self, distance: f64) -> f64 {
        match *self {
            BeamProfile::TopHat => 1.0,
            BeamProfile::Gaussian { radius } => {
                -libm::expm1(-2.0 * (distance / radius) * (distance / radius))
            }
        }
    }

    /// The distance from the axis within which a part of the power lies, at most `limit`.
    fn radius(&self, part: f64, limit: f64) -> f64 {
        match *self {
            BeamProfile::TopHat => limit * part.sqrt(),
            BeamProfile::Gaussian { radius } => (radius * (-0.5 * libm::log1p(-part)).sqrt()).min(limit),
        }
    }
}
