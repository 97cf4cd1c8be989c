//! Per-thread tracing of camera rays: colours and samples.

use crate::colour::{Premultiplied, over, premultiply};
use crate::primary::PrimaryRays;
use crate::sample::{Layer, PicturePoints, Sample, seen, towards_eye};
use crate::shade::{Shader, ShadingPoint};
use crate::shadow::Shadows;
use crate::{Camera, Size};
use rayweave_model::{Evaluator, Limit, Query, RayBatch, attributes};

/// Camera-ray tracer of one thread: in columns for opaque scenes, layer by layer otherwise.
pub(crate) enum CameraRays<'a, E: Evaluator> {
    Columns(Box<PrimaryRays<'a, E>>),
    Layers(Box<Layers<'a, E>>),
}

impl<'a, E: Evaluator> CameraRays<'a, E> {
    pub fn new(evaluator: &'a E, shader: &'a Shader, camera: &'a Camera, size: Size) -> Self {
        match PrimaryRays::new(evaluator, shader, camera, size) {
            Some(primary) => CameraRays::Columns(Box::new(primary)),
            None => CameraRays::Layers(Box::new(Layers::new(evaluator, shader, camera, size))),
        }
    }

    /// Traces the rays through points and writes a colour per ray, and as many samples per ray as
    /// the shader has levels, unless `samples` is empty.
    pub fn trace(&mut self, points: &PicturePoints, samples: &mut [Sample], colours: &mut [Premultiplied]) {
        match self {
            CameraRays::Columns(primary) => primary.trace(points, samples, colours),
            CameraRays::Layers(layers) => layers.trace(&points.places, samples, colours),
        }
    }
}

/// The buffers of a thread that traces camera rays layer by layer.
pub(crate) struct Layers<'a, E: Evaluator> {
    evaluator: &'a E,
    shader: &'a Shader,
    camera: &'a Camera,
    size: Size,
    scratch: E::Scratch,
    rays: RayBatch,
    layers: Vec<Layer>,
    shadows: Shadows,
}

impl<'a, E: Evaluator> Layers<'a, E> {
    fn new(evaluator: &'a E, shader: &'a Shader, camera: &'a Camera, size: Size) -> Self {
        Layers {
            evaluator,
            shader,
            camera,
            size,
            scratch: evaluator.scratch(),
            rays: RayBatch::default(),
            layers: Vec::new(),
            shadows: Shadows::default(),
        }
    }

    fn trace(&mut self, places: &[[f64; 2]], samples: &mut [Sample], colours: &mut [Premultiplied]) {
        self.rays.clear();
        places.iter().for_each(|&[x, y]| self.rays.push(self.camera.ray(self.size, x, y)));
        self.find_layers();
        if self.shader.casts_shadows() {
            self.shadows.cast(
                self.evaluator,
                self.shader,
                self.rays.rays(),
                &mut self.layers,
                &mut self.scratch,
            );
        }
        let levels = self.shader.levels();
        samples.fill(Sample::MISS);
        colours.fill([0.0; 4]);
        for layer in self.layers.iter().rev() {
            self.lay(layer, &mut colours[layer.ray]);
            if layer.level < levels && !samples.is_empty() {
                samples[layer.ray * levels + layer.level] = self.sample(layer);
            }
        }
    }

    fn find_layers(&mut self) {
        self.layers.clear();
        let (layers, rays, shader) = (&mut self.layers, self.rays.rays(), self.shader);
        let program = self.evaluator.program();
        let query = Query {
            limit: if shader.is_translucent() { Limit::All } else { Limit::First },
            ..Query::nearest()
        };
        let mut take = |answer: rayweave_model::RayAnswer<'_>| {
            let ray = rays.get(answer.ray);
            for (level, crossing) in answer.crossings.iter().enumerate() {
                let region = seen(crossing);
                layers.push(Layer {
                    ray: answer.ray,
                    level,
                    t: crossing.t,
                    normal: towards_eye(attributes::normal(program, &ray, crossing), &ray),
                    face: crossing.face,
                    region,
                    lit: u32::MAX,
                });
                if shader.is_opaque(region) {
                    break;
                }
            }
        };
        self.evaluator.crossings(rays, &query, &mut self.scratch, &mut take);
    }

    /// Composites a surface over the colours behind it.
    fn lay(&self, layer: &Layer, colour: &mut Premultiplied) {
        let ray = self.rays.rays().get(layer.ray);
        let point = ShadingPoint {
            point: ray.at(layer.t),
            sight: ray.direction,
            normal: layer.normal,
            region: layer.region,
            lit: layer.lit,
        };
        let (light, opacity) = self.shader.shade(&point);
        *colour = over(premultiply(light, opacity), *colour);
    }

    fn sample(&self, layer: &Layer) -> Sample {
        Sample {
            t: layer.t,
            normal: layer.normal.as_vec3().to_array(),
            face: self.evaluator.program().face_number(layer.face.leaf, layer.face.facet),
            placement: layer.face.placement.0,
            region: layer.region.0,
            lit: layer.lit,
        }
    }
}
