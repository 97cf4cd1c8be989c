//! Shadows of translucent scenes: shadow rays from the visible points to the lights.

use crate::sample::{Layer, seen};
use crate::shade::Shader;
use rayweave_math::Vec3;
use rayweave_model::attributes;
use rayweave_model::{Evaluator, Limit, Query, RayAnswer, RayBatch, Rays, Start, StartLists, Window};
use rayweave_shape::Ray;

/// Casts shadow rays from surfaces to lights.
///
/// A shadow ray starts *on* the visible surface, on the side of the camera: the root at its start is divided
/// out ([`Start`]), so no surface shades itself and no offset (ray bias) is needed at any size of the model.
#[derive(Default)]
pub(crate) struct Shadows {
    rays: RayBatch,
    starts: Vec<Start>,
    first: Vec<u32>,
    /// The layer of each ray.
    layers: Vec<usize>,
}

impl Shadows {
    /// Clears the bits of `lit` for lights that are hidden by an opaque region or behind the surface.
    pub fn cast<E: Evaluator>(
        &mut self,
        evaluator: &E,
        shader: &Shader,
        sight: Rays<'_>,
        layers: &mut [Layer],
        scratch: &mut E::Scratch,
    ) {
        for (bit, light) in shader.lights().enumerate() {
            self.clear();
            for (index, layer) in layers.iter_mut().enumerate() {
                layer.lit &= !(1 << bit);
                let ray = sight.get(layer.ray);
                let point = ray.at(layer.t);
                let towards = light.towards(point);
                if layer.normal.dot(towards) > 0.0 {
                    self.push(evaluator, layer, index, &ray, Ray::new(point, towards));
                }
            }
            self.trace(evaluator, shader, light.distance(), 1 << bit, layers, scratch);
        }
    }

    fn clear(&mut self) {
        self.rays.clear();
        self.starts.clear();
        self.first.clear();
        self.first.push(0);
        self.layers.clear();
    }

    fn push<E: Evaluator>(&mut self, evaluator: &E, layer: &Layer, index: usize, sight: &Ray, shadow: Ray) {
        let gradient: Vec3 = attributes::world_gradient(evaluator.program(), sight, layer.face, layer.t);
        self.rays.push(shadow);
        self.starts.push(Start {
            surface: layer.face.surface,
            placement: layer.face.placement,
            // f grows along the normal or against it; the camera and the light are on the side of the normal
            inside: gradient.dot(layer.normal) < 0.0,
        });
        self.first.push(self.starts.len() as u32);
        self.layers.push(index);
    }

    fn trace<E: Evaluator>(
        &self,
        evaluator: &E,
        shader: &Shader,
        distance: f64,
        bit: u32,
        layers: &mut [Layer],
        scratch: &mut E::Scratch,
    ) {
        let Ok(window) = Window::new(0.0, distance) else {
            return;
        };
        let limit = if shader.is_translucent() { Limit::All } else { Limit::First };
        let starts = Some(StartLists { first: &self.first, entries: &self.starts });
        let query = Query { window, limit, starts };
        let mut take = |answer: RayAnswer<'_>| {
            let hidden = answer.crossings.iter().any(|c| shader.is_opaque(seen(c)));
            if !hidden {
                layers[self.layers[answer.ray]].lit |= bit;
            }
        };
        evaluator.crossings(self.rays.rays(), &query, scratch, &mut take);
    }
}
