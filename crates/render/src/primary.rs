//! Primary rays of opaque scenes: the first hit of each ray, in columns.

use crate::colour::{Linear, Premultiplied, premultiply};
use crate::columns::{Columns, vector};
use crate::occlusion::{self, Occlusion};
use crate::sample::{PicturePoints, Sample};
use crate::shade::{AMBIENT, Shader, ShadingPoint};
use crate::sweep::{self, Surfaces};
use crate::{Camera, Size, Style};
use fearless_simd::Level;
use rayweave_model::Evaluator;

/// The buffers of a thread that traces the primary rays of opaque scenes.
pub(crate) struct PrimaryRays<'a, E: Evaluator> {
    evaluator: &'a E,
    shader: &'a Shader,
    camera: &'a Camera,
    size: Size,
    scratch: E::Scratch,
    sight: Columns,
    occlusion: Occlusion,
    /// The visible points.
    points: [Vec<f64>; 3],
    /// The lights that shine on each visible point, one bit each.
    lit: Vec<u32>,
    cosines: Vec<f32>,
    /// The light arriving at each point.
    arriving: Vec<Linear>,
    level: Level,
}

impl<'a, E: Evaluator> PrimaryRays<'a, E> {
    /// `None` for translucent scenes, and for shadows of a directional light on an unbounded model.
    pub fn new(evaluator: &'a E, shader: &'a Shader, camera: &'a Camera, size: Size) -> Option<Self> {
        let can_cast =
            !shader.casts_shadows() || occlusion::is_possible(shader.lights(), evaluator.program());
        (can_cast && !shader.is_translucent()).then(|| PrimaryRays {
            evaluator,
            shader,
            camera,
            size,
            scratch: evaluator.scratch(),
            sight: Columns::default(),
            occlusion: Occlusion::default(),
            points: Default::default(),
            lit: Vec::new(),
            cosines: Vec::new(),
            arriving: Vec::new(),
            level: Level::new(),
        })
    }

    /// See [`crate::camera_rays::CameraRays::trace`].
    pub fn trace(&mut self, points: &PicturePoints, samples: &mut [Sample], colours: &mut [Premultiplied]) {
        sweep::rays(self.level, self.camera, self.size, &points.places, &mut self.sight);
        let pixels = points.rays(self.camera.pixel_camera(self.size));
        self.sight.trace_pixels(self.evaluator, &pixels, true, &mut self.scratch);
        sweep::surfaces(self.level, &mut self.sight, &mut self.points);
        self.lit.clear();
        self.lit.resize(self.sight.len(), u32::MAX);
        if self.shader.casts_shadows() {
            let (sight, scratch) = ((&self.sight, &self.points), &mut self.scratch);
            self.occlusion.cast(self.evaluator, self.shader, sight, &mut self.lit, scratch);
        }
        match self.shader.style() {
            Style::Headlight => self.lambert(colours),
            Style::Gooch | Style::Flat => self.shade(colours),
        }
        samples.iter_mut().enumerate().for_each(|(i, sample)| *sample = self.sample(i));
    }

    /// Shades according to Lambert's law, light by light.
    fn lambert(&mut self, colours: &mut [Premultiplied]) {
        self.arriving.clear();
        self.arriving.resize(self.sight.len(), [AMBIENT; 3]);
        for (k, lamp) in self.shader.lamps().iter().enumerate() {
            let surfaces = Surfaces { points: &self.points, columns: &self.sight, lit: &self.lit };
            sweep::cosines(self.level, &lamp.source, 1 << k, &surfaces, &mut self.cosines);
            for (arriving, cosine) in self.arriving.iter_mut().zip(&self.cosines) {
                let part = (1.0 - AMBIENT) * cosine;
                *arriving = std::array::from_fn(|c| arriving[c] + part * lamp.strength[c]);
            }
        }
        for (i, (colour, arriving)) in colours.iter_mut().zip(&self.arriving).enumerate() {
            let own = self.shader.colour(self.sight.seen(i));
            let light = std::array::from_fn(|c| own[c] * arriving[c]);
            *colour = if self.sight.is_hit(i) { premultiply(light, 1.0) } else { [0.0; 4] };
        }
    }

    /// Shades in any style, surface by surface.
    fn shade(&self, colours: &mut [Premultiplied]) {
        for (i, colour) in colours.iter_mut().enumerate() {
            *colour = [0.0; 4];
            if self.sight.is_hit(i) {
                let point = ShadingPoint {
                    point: vector(&self.points, i),
                    sight: self.sight.ray(i).direction,
                    normal: self.sight.normal(i),
                    region: self.sight.seen(i),
                    lit: self.lit[i],
                };
                *colour = premultiply(self.shader.shade(&point).0, 1.0);
            }
        }
    }

    /// The sample of a ray.
    fn sample(&self, i: usize) -> Sample {
        if !self.sight.is_hit(i) {
            return Sample::MISS;
        }
        Sample {
            t: self.sight.hits.t[i],
            normal: self.sight.normal(i).as_vec3().to_array(),
            face: self.sight.hits.face[i] as u32,
            placement: self.sight.hits.placement[i],
            region: self.sight.seen(i).0,
            lit: self.lit[i],
        }
    }
}
