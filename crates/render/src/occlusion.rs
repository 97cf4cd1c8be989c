//! Which lights shine on what is seen, where nothing is translucent.

use crate::columns::{Columns, vector};
use crate::shade::Shader;
use crate::{Light, LightKind};
use rayweave_model::weld::local_ray;
use rayweave_model::{Evaluator, PlacementId, Program, Window};
use rayweave_shape::Ray;
use rayweave_shape::surface::{coincides_along, delta};

/// Casts rays from lights to surfaces.
///
/// A ray runs from the light, t = 0, to the surface, t = 1, and asks what it meets first. That is the surface itself, or
/// nothing where rounding puts it beyond t = 1, unless something is between. No start lists are needed, and the rays of a
/// light have one origin, so that neighbours meet the same things. What a ray meets is the surface itself if it is within
/// [`delta`] of the end, or if it belongs to the same surface and the ray keeps to that from there to the end ([`coincides_along`]): a ray
/// that grazes a surface meets it a little early, by more than `delta`.
#[derive(Default)]
pub(crate) struct Occlusion {
    rays: Columns,
    /// The ray of sight that each belongs to.
    of: Vec<u32>,
}

impl Occlusion {
    /// Separated the bits of the lights that something hides, or that are behind the surface; the normals of what is seen, at
    /// these points, are on the side of the eye.
    pub fn cast<E: Evaluator>(
        &mut self,
        evaluator: &E,
        shader: &Shader,
        (sight, points): (&Columns, &[Vec<f64>; 3]),
        lit: &mut [u32],
        scratch: &mut E::Scratch,
    ) {
        let program = evaluator.program();
        let window = Window::new(0.0, 1.0).unwrap_or_default();
        for (bit, light) in shader.lights().enumerate() {
            let far = distance(light, program);
            self.gather(light, far, 1 << bit, (sight, points), lit);
            self.rays.ask(evaluator, window, false, scratch);
            for (k, &i) in self.of.iter().enumerate() {
                if self.is_hidden(program, sight, k, i as usize) {
                    lit[i as usize] &= !(1 << bit);
                }
            }
        }
    }

    /// The rays from a light to the surfaces that face it; from the others its bit is taken.
    fn gather(
        &mut self,
        light: &Light,
        far: f64,
        bit: u32,
        (sight, points): (&Columns, &[Vec<f64>; 3]),
        lit: &mut [u32],
    ) {
        self.rays.clear();
        self.of.clear();
        for i in (0..sight.len()).filter(|&i| sight.is_hit(i)) {
            let point = vector(points, i);
            let towards = far * light.towards(point);
            if sight.normal(i).dot(towards) > 0.0 {
                let origin = match light.kind {
                    LightKind::Position(position) => position,
                    LightKind::Direction(_) => point + towards,
                };
                self.rays.push(Ray::new(origin, point - origin));
                self.of.push(i as u32);
            } else {
                lit[i] &= !bit;
            }
        }
    }

    /// True if a ray from a light meets something before the surface that it is cast to.
    fn is_hidden(&self, program: &Program, sight: &Columns, k: usize, i: usize) -> bool {
        let t = self.rays.t[k];
        if t >= 1.0 {
            return false;
        }
        let ray = self.rays.ray(k);
        if (1.0 - t) * ray.direction.length() <= delta(0.0, &ray, 1.0) {
            return false;
        }
        let surface_of = |face: i32| program.facets()[face as usize].surface();
        let surface = surface_of(self.rays.face[k]);
        let placement = self.rays.placement[k];
        if surface != surface_of(sight.face[i]) || placement != sight.placement[i] {
            return true;
        }
        let (local, reach) = local_ray(program, &ray, PlacementId(placement));
        let entry = program.surface(surface);
        !coincides_along(&entry.surface, entry.magnitude + reach, &local, t, 1.0)
    }
}

/// How far away the light is, in lengths of [`Light::towards`]: for a direction far enough to be outside of the model.
fn distance(light: &Light, program: &Program) -> f64 {
    match light.kind {
        LightKind::Position(_) => 1.0,
        LightKind::Direction(_) => 1.001 * program.bounds().size().length(),
    }
}

/// True if the light of every lamp can be followed from where it comes: from directions only if the model has an end.
pub(crate) fn is_possible<'l>(mut lights: impl Iterator<Item = &'l Light>, program: &Program) -> bool {
    let is_finite = program.bounds().is_finite();
    lights.all(|light| is_finite || matches!(light.kind, LightKind::Position(_)))
}
