//! Shadows of opaque scenes: shadow rays from the lights to the visible points.

use crate::columns::{Columns, vector};
use crate::shade::Shader;
use crate::{Light, LightKind};
use rayweave_model::weld::local_ray;
use rayweave_model::{Evaluator, PlacementId, Program, Window};
use rayweave_shape::Ray;
use rayweave_shape::surface::{coincides_along, delta};

/// Casts shadow rays from lights to surfaces.
///
/// A ray runs from the light, t = 0, to the surface, t = 1. Its first hit is the surface itself, or nothing
/// where rounding puts it beyond t = 1, unless something is between. Start lists are not needed, and the rays
/// of a light have one origin, so neighbouring rays hit the same leaves. A hit counts as the surface itself
/// within [`delta`] of the end, or on the same surface if the ray coincides with it from there to the end
/// ([`coincides_along`]): a grazing ray hits its surface earlier by more than `delta`.
#[derive(Default)]
pub(crate) struct Occlusion {
    rays: Columns,
    /// The camera ray of each shadow ray.
    of: Vec<u32>,
}

impl Occlusion {
    /// Clears the bits of `lit` for lights that are hidden or behind the surface. The normals of the visible
    /// surfaces at `points` have to face the eye.
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
            self.rays.trace(evaluator, window, false, scratch);
            for (k, &i) in self.of.iter().enumerate() {
                if self.is_hidden(program, sight, k, i as usize) {
                    lit[i as usize] &= !(1 << bit);
                }
            }
        }
    }

    /// Collects the rays from a light to the surfaces that face it, and clears its bit for all others.
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

    /// True if a shadow ray hits something before its target surface.
    fn is_hidden(&self, program: &Program, sight: &Columns, k: usize, i: usize) -> bool {
        let t = self.rays.hits.t[k];
        if t >= 1.0 {
            return false;
        }
        let ray = self.rays.ray(k);
        if (1.0 - t) * ray.direction.length() <= delta(0.0, &ray, 1.0) {
            return false;
        }
        let surface_of = |face: i32| program.facets()[face as usize].surface();
        let surface = surface_of(self.rays.hits.face[k]);
        let placement = self.rays.hits.placement[k];
        if surface != surface_of(sight.hits.face[i]) || placement != sight.hits.placement[i] {
            return true;
        }
        let (local, reach) = local_ray(program, &ray, PlacementId(placement));
        let entry = program.surface(surface);
        !coincides_along(&entry.surface, entry.magnitude + reach, &local, t, 1.0)
    }
}

/// The distance of the light in lengths of [`Light::towards`]; for a directional light, far enough to be
/// outside the model.
fn distance(light: &Light, program: &Program) -> f64 {
    match light.kind {
        LightKind::Position(_) => 1.0,
        LightKind::Direction(_) => 1.001 * program.bounds().size().length(),
    }
}

/// True if shadow rays from all lights are possible: directional lights need a bounded model.
pub(crate) fn is_possible<'l>(mut lights: impl Iterator<Item = &'l Light>, program: &Program) -> bool {
    let is_finite = program.bounds().is_finite();
    lights.all(|light| is_finite || matches!(light.kind, LightKind::Position(_)))
}
