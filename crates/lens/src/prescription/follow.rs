//! Sequential ray tracing: one real ray from surface to surface, without solids. Layouts use it to size
//! their lenses.

use super::{Behind, Prescription, PrescriptionError, Resolved};
use rayweave_math::Vec3;
use rayweave_optics::component::SurfaceForm;
use rayweave_optics::interface::{reflect, refract};
use rayweave_shape::Ray;

/// The intersection of a ray with a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceIntersection {
    /// The point, in the coordinates of the prescription.
    pub point: Vec3,
    /// The direction behind the surface, of unit length.
    pub direction: Vec3,
    /// The optical path length from the start of the ray.
    pub path: f64,
}

impl Prescription {
    /// Traces a ray sequentially through all surfaces, without regard to semi-diameters. Returns a point for
    /// each surface and one for the image.
    ///
    /// # Errors
    /// [`PrescriptionError`] for invalid prescriptions; [`PrescriptionError::Lost`] for total reflection and
    /// missed surfaces.
    pub fn follow(
        &self,
        ray: &Ray,
        wavelength_nm: f64,
    ) -> Result<Vec<SurfaceIntersection>, PrescriptionError> {
        self.follow_resolved(&self.resolved()?, ray, wavelength_nm)
    }

    pub(crate) fn follow_resolved(
        &self,
        resolved: &Resolved,
        ray: &Ray,
        wavelength_nm: f64,
    ) -> Result<Vec<SurfaceIntersection>, PrescriptionError> {
        self.follow_part(resolved, ray, wavelength_nm, resolved.vertices.len())
    }

    /// Traces a ray as far as surface `last`, counted from 1.
    pub(super) fn follow_part(
        &self,
        resolved: &Resolved,
        ray: &Ray,
        wavelength_nm: f64,
        last: usize,
    ) -> Result<Vec<SurfaceIntersection>, PrescriptionError> {
        let indices = resolved.indices(wavelength_nm)?;
        let mut pass =
            SurfaceIntersection { point: ray.origin, direction: ray.direction.normalize(), path: 0.0 };
        let mut passes = Vec::with_capacity(indices.len());
        for (k, &vertex) in resolved.vertices.iter().enumerate().take(last) {
            let lost = |why| PrescriptionError::Lost { surface: k + 1, why };
            let surface = self.surfaces.get(k);
            let curved = Curved { vertex, form: &resolved.forms[k] };
            let pose = resolved.poses.get(k);
            if let Some(pose) = pose {
                (pass.point, pass.direction) = pose.local(pass.point, pass.direction);
            }
            let length = curved.reach(pass.point, pass.direction).ok_or(lost("no intersection"))?;
            pass.point += length * pass.direction;
            pass.path += indices[k].abs() * length;
            let normal = curved.normal(pass.point, pass.direction);
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

/// A surface about its vertex on the axis.
struct Curved<'a> {
    vertex: f64,
    form: &'a SurfaceForm,
}

/// Limit of the steps of Newton's method, which converges quadratically.
const STEPS: u32 = 40;

impl Curved<'_> {
    /// True for a conic of revolution about the axis, `c (x^2 + y^2 + (1 + k) z^2) = 2 z`.
    fn is_conic(&self) -> bool {
        self.form.is_round() && !self.form.asphere.has_terms()
    }

    /// The distance along a ray to the surface. Surfaces other than conics: Newton's method, from the
    /// intersection with the conic or, if the ray misses that, with the vertex plane (Welford, section 4.5).
    fn reach(&self, point: Vec3, d: Vec3) -> Option<f64> {
        if self.is_conic() {
            return self.distance(point, d);
        }
        let to_plane = (self.vertex - point.z) / d.z;
        let first = if self.form.is_round() { self.distance(point, d) } else { None };
        let mut length = first.unwrap_or(to_plane);
        for _ in 0..STEPS {
            let at = point + length * d;
            let [sag, by_x, by_y] = self.form.sag_and_slopes([at.x, at.y])?;
            let rate = d.z - (by_x * d.x + by_y * d.y);
            let step = (at.z - self.vertex - sag) / rate;
            length -= step;
            if step.abs() <= 1e-15 * (length.abs() + at.length()) {
                return Some(length);
            }
        }
        None
    }

    /// The distance to the conic: the root that tends to the vertex plane as the curvature tends to 0
    /// (Welford, section 4.4).
    fn distance(&self, point: Vec3, d: Vec3) -> Option<f64> {
        let to_plane = (self.vertex - point.z) / d.z;
        let p = point + to_plane * d;
        let (c, turn) = (1.0 / self.form.asphere.radius, 1.0 + self.form.asphere.conic);
        let a = c * (d.x * d.x + d.y * d.y + turn * d.z * d.z);
        let b = d.z - c * (p.x * d.x + p.y * d.y);
        let constant = c * (p.x * p.x + p.y * p.y);
        let root = (b * b - a * constant).sqrt();
        let length = to_plane + constant / (b + root.copysign(d.z));
        length.is_finite().then_some(length)
    }

    /// The unit normal, directed against the ray.
    fn normal(&self, point: Vec3, d: Vec3) -> Vec3 {
        let (c, turn) = (1.0 / self.form.asphere.radius, 1.0 + self.form.asphere.conic);
        let height = if self.is_conic() { None } else { self.form.sag_and_slopes([point.x, point.y]) };
        let gradient = match height {
            Some([_, by_x, by_y]) => Vec3::new(by_x, by_y, -1.0),
            None => Vec3::new(c * point.x, c * point.y, c * turn * (point.z - self.vertex) - 1.0),
        };
        let gradient = gradient.normalize_or(Vec3::Z);
        if gradient.dot(d) > 0.0 { -gradient } else { gradient }
    }
}
