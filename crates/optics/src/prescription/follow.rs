//! One real ray from surface to surface, in the order of the prescription: what sizes lenses before they are solids.

use super::{Behind, Prescription, PrescriptionError, Resolved};
use crate::component::Asphere;
use crate::interface::{reflect, refract};
use rayweave_math::Vec3;
use rayweave_shape::Ray;

/// Where a ray meets a surface and how it goes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pass {
    /// The point, in the coordinates of the prescription.
    pub point: Vec3,
    /// The direction behind the surface, of unit length.
    pub direction: Vec3,
    /// The optical path from the start of the ray.
    pub path: f64,
}

impl Prescription {
    /// Follows a ray in the order of the surfaces, whatever their semi-diameters: a point for every surface and one for the
    /// image. Total reflection and missed surfaces end it.
    ///
    /// # Errors
    /// [`PrescriptionError`] for prescriptions that say nothing, and [`PrescriptionError::Lost`].
    pub fn follow(&self, ray: &Ray, wavelength_nm: f64) -> Result<Vec<Pass>, PrescriptionError> {
        self.follow_resolved(&self.resolved()?, ray, wavelength_nm)
    }

    pub(crate) fn follow_resolved(
        &self,
        resolved: &Resolved,
        ray: &Ray,
        wavelength_nm: f64,
    ) -> Result<Vec<Pass>, PrescriptionError> {
        self.follow_part(resolved, ray, wavelength_nm, resolved.vertices.len())
    }

    /// The same as far as a surface, counted from 1.
    pub(super) fn follow_part(
        &self,
        resolved: &Resolved,
        ray: &Ray,
        wavelength_nm: f64,
        last: usize,
    ) -> Result<Vec<Pass>, PrescriptionError> {
        let indices = resolved.indices(wavelength_nm)?;
        let mut pass = Pass { point: ray.origin, direction: ray.direction.normalize(), path: 0.0 };
        let mut passes = Vec::with_capacity(indices.len());
        for (k, &vertex) in resolved.vertices.iter().enumerate().take(last) {
            let lost = |why| PrescriptionError::Lost { surface: k + 1, why };
            let surface = self.surfaces.get(k);
            let image = Asphere::conic(self.image.radius, self.image.conic);
            let form = surface.map_or(image, |surface| surface.asphere());
            let conicoid = Conicoid { vertex, curvature: 1.0 / form.radius, conic: form.conic, form };
            let pose = resolved.poses.get(k);
            if let Some(pose) = pose {
                (pass.point, pass.direction) = pose.local(pass.point, pass.direction);
            }
            let length = conicoid.reach(pass.point, pass.direction).ok_or(lost("it misses"))?;
            pass.point += length * pass.direction;
            pass.path += indices[k].abs() * length;
            let normal = conicoid.normal(pass.point, pass.direction);
            let ratio = indices[k].abs() / indices.get(k + 1).map_or(1.0, |n| n.abs());
            pass.direction = match surface.map(|surface| &surface.behind) {
                None => pass.direction,
                Some(Behind::Mirror) => reflect(pass.direction, normal),
                Some(_) if ratio == 1.0 => pass.direction,
                Some(_) => refract(pass.direction, normal, ratio).ok_or(lost("total reflection"))?,
            };
            if let Some(pose) = pose {
                (pass.point, pass.direction) = pose.world(pass.point, pass.direction);
            }
            passes.push(pass);
        }
        Ok(passes)
    }
}

/// A conic of revolution about the axis, `c (x^2 + y^2 + (1 + k) z^2) = 2 z`.
struct Conicoid {
    vertex: f64,
    curvature: f64,
    conic: f64,
    /// The same with terms in powers of the distance from the axis.
    form: Asphere,
}

/// Steps of Newton's method to an asphere; the number of right digits doubles with each.
const STEPS: u32 = 40;

impl Conicoid {
    fn has_terms(&self) -> bool {
        self.form.has_terms()
    }

    /// How far a ray has to go to the surface: with terms, by Newton's method from the conic or, where it is missed, from the
    /// vertex plane (Welford, section 4.5).
    fn reach(&self, point: Vec3, d: Vec3) -> Option<f64> {
        if !self.has_terms() {
            return self.distance(point, d);
        }
        let mut length = self.distance(point, d).unwrap_or((self.vertex - point.z) / d.z);
        for _ in 0..STEPS {
            let at = point + length * d;
            let [sag, slope] = self.sag_and_slope(libm::hypot(at.x, at.y))?;
            let rate = d.z - slope * (at.x * d.x + at.y * d.y);
            let step = (at.z - self.vertex - sag) / rate;
            length -= step;
            if step.abs() <= 1e-15 * (length.abs() + at.length()) {
                return Some(length);
            }
        }
        None
    }

    /// The sag at a distance from the axis, and its derivative by that, divided by the distance.
    fn sag_and_slope(&self, r: f64) -> Option<[f64; 2]> {
        let (c, square) = (self.curvature, r * r);
        let root = (1.0 - (1.0 + self.conic) * c * c * square).sqrt();
        let Asphere { even, odd, .. } = &self.form;
        let even = (0..8).rev().fold(0.0, |sum, k| sum * square + (2 * k + 2) as f64 * even[k]);
        let odd = (0..8).rev().fold(0.0, |sum, k| sum * square + (2 * k + 1) as f64 * odd[k]);
        // at the tip of a cone there is no slope: 0
        let terms = even + if r > 0.0 { odd / r } else { 0.0 };
        let sag = self.form.sag(r)?;
        (root > 0.0).then_some([sag, c / root + terms])
    }

    /// How far a ray has to go to the root that tends to that of the vertex plane as the curvature tends to 0 (Welford,
    /// section 4.4).
    fn distance(&self, point: Vec3, d: Vec3) -> Option<f64> {
        let to_plane = (self.vertex - point.z) / d.z;
        let p = point + to_plane * d;
        let (c, turn) = (self.curvature, 1.0 + self.conic);
        let a = c * (d.x * d.x + d.y * d.y + turn * d.z * d.z);
        let b = d.z - c * (p.x * d.x + p.y * d.y);
        let constant = c * (p.x * p.x + p.y * p.y);
        let root = (b * b - a * constant).sqrt();
        let length = to_plane + constant / (b + root.copysign(d.z));
        length.is_finite().then_some(length)
    }

    /// The unit normal against a direction.
    fn normal(&self, point: Vec3, d: Vec3) -> Vec3 {
        let (c, z) = (self.curvature, point.z - self.vertex);
        let terms = self.has_terms().then(|| self.sag_and_slope(libm::hypot(point.x, point.y))).flatten();
        let gradient = match terms {
            Some([_, slope]) => Vec3::new(slope * point.x, slope * point.y, -1.0),
            None => Vec3::new(c * point.x, c * point.y, c * (1.0 + self.conic) * z - 1.0),
        };
        let gradient = gradient.normalize_or(Vec3::Z);
        if gradient.dot(d) > 0.0 { -gradient } else { gradient }
    }
}
