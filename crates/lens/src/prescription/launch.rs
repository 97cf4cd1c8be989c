//! Rays from points of the field through the entrance pupil.

use super::{FieldKind, Prescription, PrescriptionError, Resolved};
use rayweave_math::{Vec3, sin_cos_degrees};
use rayweave_optics::{Beam, Light};
use rayweave_shape::Ray;

/// A point of the field and the entrance pupil through which its light goes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Launch {
    /// The place of the entrance pupil along z.
    pupil: f64,
    /// Its semi-diameter.
    semi_diameter: f64,
    /// Where the light comes from.
    origin: Origin,
}

#[derive(Clone, Copy, Debug)]
enum Origin {
    /// Collimated light of this direction; it starts on a wavefront so far in front of the pupil.
    Distant { direction: Vec3, before: f64 },
    /// A point.
    Point(Vec3),
}

impl Launch {
    /// The ray through a point of the pupil in units of its semi-diameter. Rays of a distant point start on one plane
    /// wavefront, so that optical paths can be compared.
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
    /// Rays of a field, by its number, through points of the entrance pupil in units of its semi-diameter. The pupil is the
    /// paraxial one at the primary wavelength, for all fields and wavelengths: rays are not aimed at the rim of the stop.
    ///
    /// # Errors
    /// [`PrescriptionError`] for a field that does not exist, an object that lies in the system, a pupil that is infinitely
    /// far.
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

    /// Rays of a field, by its number, aimed at points of the stop in units of its semi-diameter, the paraxial one at the
    /// primary wavelength: what a real stop lets through. Wide fields need it, where the entrance pupil is not where it is
    /// paraxially.
    ///
    /// # Errors
    /// As of [`Prescription::beam`], and [`PrescriptionError::Lost`] where no ray is found that leads there.
    pub fn beam_at_stop(
        &self,
        field: usize,
        wavelength_nm: f64,
        stop: &[[f64; 2]],
    ) -> Result<Beam, PrescriptionError> {
        let resolved = self.resolved()?;
        let launch = self.launch(&resolved, field)?;
        let semi_diameter = self.first_order_resolved(&resolved, self.primary_nm())?.stop_semi_diameter;
        let aim = Aim { lens: self, resolved: &resolved, launch, wavelength_nm, semi_diameter };
        let light = |&target: &[f64; 2]| {
            let ray = launch.ray(aim.pupil_of(target)?);
            Ok(Light { ray, ..Light::new([0.0; 3], [0.0; 3], wavelength_nm) })
        };
        stop.iter().map(light).collect()
    }

    /// How light of a field goes into the system.
    pub(crate) fn launch(&self, resolved: &Resolved, field: usize) -> Result<Launch, PrescriptionError> {
        let count = self.fields.len();
        let no_such = PrescriptionError::NoSuch { what: "field", number: field, count };
        let place = *self.fields.get(field).ok_or(no_such)?;
        let first_order = self.first_order_resolved(resolved, self.primary_nm())?;
        let pupil = first_order.entrance_pupil.position;
        let semi_diameter = 0.5 * first_order.entrance_pupil.diameter;
        if !(pupil.is_finite() && semi_diameter.is_finite()) {
            let why = "it is telecentric on the side of the object";
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

    /// Light that starts in front of everything.
    fn distant(&self, resolved: &Resolved, [x, y]: [f64; 2], semi_diameter: f64, pupil: f64) -> Origin {
        let direction = Vec3::new(x, y, 1.0).normalize();
        let [low, high] = resolved.vertices.iter().fold([0.0f64; 2], |[a, b], &z| [a.min(z), b.max(z)]);
        // far enough for the sags of the outer surfaces and for pupils behind the system
        let before = 2.0 * (high - low) + 4.0 * semi_diameter + (pupil - low).abs();
        Origin::Distant { direction, before }
    }
}

/// The search for rays that lead to points of the stop.
struct Aim<'a> {
    lens: &'a Prescription,
    resolved: &'a Resolved,
    launch: Launch,
    wavelength_nm: f64,
    semi_diameter: f64,
}

/// How near a ray has to come to its point of the stop, in units of the stop, and after how many steps it is given up.
const AIMED: f64 = 1e-11;
const STEPS: usize = 40;

impl Aim<'_> {
    /// The point of the entrance pupil through which light comes to a point of the stop, by Newton's method with differences
    /// for derivatives.
    fn pupil_of(&self, target: [f64; 2]) -> Result<[f64; 2], PrescriptionError> {
        let miss = |[x, y]: [f64; 2]| {
            let [a, b] = self.stop_of([x, y])?;
            Ok::<_, PrescriptionError>([a - target[0], b - target[1]])
        };
        let mut at = target;
        let mut off = miss(at)?;
        for _ in 0..STEPS {
            if libm::hypot(off[0], off[1]) <= AIMED {
                return Ok(at);
            }
            let h = 1e-5;
            let (by_x, by_y) = (miss([at[0] + h, at[1]])?, miss([at[0], at[1] + h])?);
            let [a, c] = [by_x[0] - off[0], by_x[1] - off[1]].map(|change| change / h);
            let [b, d] = [by_y[0] - off[0], by_y[1] - off[1]].map(|change| change / h);
            let determinant = a * d - b * c;
            at[0] -= (d * off[0] - b * off[1]) / determinant;
            at[1] -= (a * off[1] - c * off[0]) / determinant;
            off = miss(at)?;
        }
        Err(PrescriptionError::Lost { surface: self.lens.stop, why: "no ray leads to the point of the stop" })
    }

    /// Where light through a point of the entrance pupil crosses the stop.
    fn stop_of(&self, pupil: [f64; 2]) -> Result<[f64; 2], PrescriptionError> {
        let ray = self.launch.ray(pupil);
        let stop = self.lens.stop;
        let passes = self.lens.follow_part(self.resolved, &ray, self.wavelength_nm, stop)?;
        // the part has a point for every surface up to the stop
        let point = passes.last().map_or(ray.origin, |pass| pass.point);
        Ok([point.x / self.semi_diameter, point.y / self.semi_diameter])
    }
}
