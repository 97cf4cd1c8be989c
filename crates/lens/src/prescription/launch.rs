//! Launch of rays from field points through the entrance pupil.

use super::{FieldKind, Prescription, PrescriptionError, Resolved};
use rayweave_math::{Vec3, sin_cos_degrees};
use rayweave_optics::{Beam, Light};
use rayweave_shape::Ray;

/// A field point and the entrance pupil.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Launch {
    /// The position of the entrance pupil along z.
    pupil: f64,
    /// Its semi-diameter.
    semi_diameter: f64,
    /// The origin of the light.
    origin: Origin,
}

#[derive(Clone, Copy, Debug)]
enum Origin {
    /// Collimated light of this direction, from a plane wavefront at the distance `before` in front of the
    /// pupil.
    Distant { direction: Vec3, before: f64 },
    /// A point source.
    Point(Vec3),
}

impl Launch {
    /// The ray through a pupil point, in units of the semi-diameter. Rays of a distant field point start on
    /// one plane wavefront, so their optical paths are comparable.
    pub fn ray(&self, [x, y]: [f64; 2]) -> Ray {
        let pupil = Vec3::Z * self.pupil;
        let target = pupil + self.semi_diameter * Vec3::new(x, y, 0.0);
        match self.origin {
            Origin::Distant { direction, before } => {
                let back = before + (target - pupil).dot(direction);
                Ray::new(target - back * direction, direction)
            }
            Origin::Point(point) if self.pupil < point.z => Ray::new(point, (point - target).normalize()),
            Origin::Point(point) => Ray::new(point, (target - point).normalize()),
        }
    }
}

impl Prescription {
    /// Rays of a field (counted from 0) through points of the entrance pupil, in units of its semi-diameter.
    /// The pupil is the paraxial one at the primary wavelength for all fields and wavelengths: rays are not
    /// aimed at the stop. [`Prescription::chief_ray_pupil_point`] returns how far off the real pupil is.
    ///
    /// # Errors
    /// [`PrescriptionError`] for a field that does not exist, an object inside the system, or an infinitely
    /// distant pupil.
    pub fn beam(
        &self,
        field: usize,
        wavelength_nm: f64,
        pupil: &[[f64; 2]],
    ) -> Result<Beam, PrescriptionError> {
        let launch = self.launch(&self.resolved()?, field)?;
        let light = |&point: &[f64; 2]| Light {
            ray: launch.ray(point),
            ..Light::new([0.0; 3], [0.0; 3], wavelength_nm)
        };
        Ok(pupil.iter().map(light).collect())
    }

    /// Ray aiming: rays of a field (counted from 0) through points of the stop, in units of its paraxial
    /// semi-diameter at the primary wavelength. Needed for wide fields, whose real entrance pupil differs
    /// from the paraxial one.
    ///
    /// # Errors
    /// As for [`Prescription::beam`], and [`PrescriptionError::Lost`] if no ray to a point of the stop is
    /// found.
    pub fn beam_at_stop(
        &self,
        field: usize,
        wavelength_nm: f64,
        stop: &[[f64; 2]],
    ) -> Result<Beam, PrescriptionError> {
        let resolved = self.resolved()?;
        let aim = self.aim(&resolved, field, wavelength_nm)?;
        let light = |&target: &[f64; 2]| {
            let ray = aim.ray(target)?;
            Ok(Light { ray, ..Light::new([0.0; 3], [0.0; 3], wavelength_nm) })
        };
        stop.iter().map(light).collect()
    }

    /// The point of the entrance pupil, in units of its semi-diameter, through which the chief (principal)
    /// ray of a field goes, the ray to the centre of the stop. Without pupil aberration it is the centre; in
    /// wide-angle lenses it can be outside the paraxial pupil.
    ///
    /// # Errors
    /// As for [`Prescription::beam_at_stop`].
    pub fn chief_ray_pupil_point(
        &self,
        field: usize,
        wavelength_nm: f64,
    ) -> Result<[f64; 2], PrescriptionError> {
        self.aim(&self.resolved()?, field, wavelength_nm)?.pupil_of([0.0; 2])
    }

    /// Ray aiming for a field.
    pub(crate) fn aim<'a>(
        &'a self,
        resolved: &'a Resolved,
        field: usize,
        wavelength_nm: f64,
    ) -> Result<Aim<'a>, PrescriptionError> {
        let place = self.place(field)?;
        let launch = self.launch_from(resolved, place)?;
        let semi_diameter = self.first_order_resolved(resolved, self.primary_nm())?.stop_semi_diameter;
        Ok(Aim { lens: self, resolved, place, launch, wavelength_nm, semi_diameter })
    }

    fn place(&self, field: usize) -> Result<[f64; 2], PrescriptionError> {
        let last = self.fields.len().saturating_sub(1);
        let no_such = PrescriptionError::NoSuch { what: "field", number: field, first: 0, last };
        self.fields.get(field).copied().ok_or(no_such)
    }

    /// The launch data of a field.
    pub(crate) fn launch(&self, resolved: &Resolved, field: usize) -> Result<Launch, PrescriptionError> {
        self.launch_from(resolved, self.place(field)?)
    }

    /// The launch data of a field at these coordinates.
    fn launch_from(&self, resolved: &Resolved, place: [f64; 2]) -> Result<Launch, PrescriptionError> {
        let first_order = self.first_order_resolved(resolved, self.primary_nm())?;
        let pupil = first_order.entrance_pupil.position;
        let semi_diameter = 0.5 * first_order.entrance_pupil.diameter;
        if !(pupil.is_finite() && semi_diameter.is_finite()) {
            let why = "it is telecentric in object space";
            return Err(PrescriptionError::Undefined { what: "entrance pupil at a finite distance", why });
        }
        let slope = |component: f64| {
            let (sin, cos) = sin_cos_degrees(component);
            sin / cos
        };
        let origin = match (self.field_kind, self.object_distance.is_finite()) {
            (FieldKind::Angle, false) => self.distant(resolved, place.map(slope), semi_diameter, pupil),
            (FieldKind::Angle, true) => {
                self.point(place.map(|angle| -slope(angle) * (pupil + self.object_distance)))
            }
            (FieldKind::ImageHeight, false) => {
                let slopes = place.map(|height| height / first_order.focal_length);
                self.distant(resolved, slopes, semi_diameter, pupil)
            }
            (FieldKind::ImageHeight, true) => {
                self.point(place.map(|height| height / first_order.magnification))
            }
            (FieldKind::ObjectHeight, _) => self.point(place),
        };
        Ok(Launch { pupil, semi_diameter, origin })
    }

    fn point(&self, [x, y]: [f64; 2]) -> Origin {
        Origin::Point(Vec3::new(x, y, -self.object_distance))
    }

    /// A distant origin, in front of the whole system.
    fn distant(&self, resolved: &Resolved, [x, y]: [f64; 2], semi_diameter: f64, pupil: f64) -> Origin {
        let direction = Vec3::new(x, y, 1.0).normalize();
        let [low, high] = resolved.vertices.iter().fold([0.0f64; 2], |[a, b], &z| [a.min(z), b.max(z)]);
        // a margin for the sags of the outer surfaces and for pupils behind the system
        let before = 2.0 * (high - low) + 4.0 * semi_diameter + (pupil - low).abs();
        // along z, light of steep fields advances by less
        let before = before / (2.0 * direction.z).min(1.0);
        Origin::Distant { direction, before }
    }
}

/// Ray aiming: the search for rays through points of the stop.
#[derive(Clone, Copy)]
pub(crate) struct Aim<'a> {
    lens: &'a Prescription,
    resolved: &'a Resolved,
    /// The coordinates of the field.
    place: [f64; 2],
    launch: Launch,
    wavelength_nm: f64,
    semi_diameter: f64,
}

/// Tolerance of aiming, in units of the stop's semi-diameter, and the limit of Newton steps.
const AIMED: f64 = 1e-11;
const STEPS: usize = 40;

/// The smallest fraction of a Newton step that is tried.
const MIN_STEP: f64 = 1e-3;

/// The smallest step from field to field, as a fraction of the field.
const MIN_STRIDE: f64 = 1.0 / 256.0;

impl Aim<'_> {
    /// The ray through a point of the stop.
    pub(crate) fn ray(&self, target: [f64; 2]) -> Result<Ray, PrescriptionError> {
        Ok(self.launch.ray(self.pupil_of(target)?))
    }

    /// The pupil point whose ray goes through a point of the stop: by Newton's method from the paraxial pupil
    /// or, if that does not converge, step by step from the axis to the field.
    fn pupil_of(&self, target: [f64; 2]) -> Result<[f64; 2], PrescriptionError> {
        self.newton(target, target).or_else(|error| self.walk(target).ok_or(error))
    }

    /// Newton's method with difference quotients. A step is shortened if its end is worse or its ray
    /// does not reach the stop.
    fn newton(&self, target: [f64; 2], start: [f64; 2]) -> Result<[f64; 2], PrescriptionError> {
        let miss = |[x, y]: [f64; 2]| {
            let [a, b] = self.stop_of([x, y])?;
            Ok::<_, PrescriptionError>([a - target[0], b - target[1]])
        };
        let size = |[a, b]: [f64; 2]| libm::hypot(a, b);
        let mut at = start;
        let mut off = miss(at)?;
        for _ in 0..STEPS {
            if size(off) <= AIMED {
                return Ok(at);
            }
            let h = 1e-5;
            let (by_x, by_y) = (miss([at[0] + h, at[1]])?, miss([at[0], at[1] + h])?);
            let [a, c] = [by_x[0] - off[0], by_x[1] - off[1]].map(|change| change / h);
            let [b, d] = [by_y[0] - off[0], by_y[1] - off[1]].map(|change| change / h);
            let determinant = a * d - b * c;
            let step = [(d * off[0] - b * off[1]) / determinant, (a * off[1] - c * off[0]) / determinant];
            let shorter = std::iter::successors(Some(1.0), |part| Some(0.5 * part));
            let tried = shorter.take_while(|&part| part >= MIN_STEP).find_map(|part| {
                let next = [at[0] - part * step[0], at[1] - part * step[1]];
                miss(next).ok().filter(|&off_next| size(off_next) < size(off)).map(|off| (next, off))
            });
            (at, off) = tried.ok_or(self.nowhere())?;
        }
        Err(self.nowhere())
    }

    /// Continuation from the centre of the axial pupil to the target in the field; `None` if it is lost on
    /// the way.
    fn walk(&self, target: [f64; 2]) -> Option<[f64; 2]> {
        let (mut part, mut stride) = (0.0_f64, 0.125);
        let mut at = self.part_of_the_way(part)?.newton([0.0; 2], [0.0; 2]).ok()?;
        while part < 1.0 {
            let next = (part + stride).min(1.0);
            let there = self.part_of_the_way(next)?;
            match there.newton(target.map(|component| next * component), at) {
                Ok(found) => (at, part, stride) = (found, next, 2.0 * stride),
                Err(_) if stride > MIN_STRIDE => stride *= 0.5,
                Err(_) => return None,
            }
        }
        Some(at)
    }

    /// The same search for a field nearer to the axis.
    fn part_of_the_way(&self, part: f64) -> Option<Self> {
        let place = self.place.map(|coordinate| part * coordinate);
        let launch = self.lens.launch_from(self.resolved, place).ok()?;
        Some(Aim { place, launch, ..*self })
    }

    fn nowhere(&self) -> PrescriptionError {
        PrescriptionError::Lost { surface: self.lens.stop, why: "no ray leads to the point of the stop" }
    }

    /// The stop point of the ray through a pupil point, in the coordinates of the stop.
    fn stop_of(&self, pupil: [f64; 2]) -> Result<[f64; 2], PrescriptionError> {
        let ray = self.launch.ray(pupil);
        let stop = self.lens.stop;
        let passes = self.lens.follow_part(self.resolved, &ray, self.wavelength_nm, stop)?;
        // the last point is that on the stop
        let point = passes.last().map_or(ray.origin, |pass| pass.point);
        let local = self.resolved.local(stop - 1, point);
        Ok([local.x / self.semi_diameter, local.y / self.semi_diameter])
    }
}
