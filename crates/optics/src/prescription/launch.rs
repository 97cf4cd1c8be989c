//! Rays from points of the field through the entrance pupil.

use super::{FieldKind, Prescription, PrescriptionError, Resolved};
use crate::beam::{Beam, Light};
use rayweave_math::{Vec3, sin_cos_degrees};
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
