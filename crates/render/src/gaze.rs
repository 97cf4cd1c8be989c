//! What rays see where nothing is translucent: the first surface of each, column by column.

use crate::colour::{Linear, Premultiplied, premultiply};
use crate::columns::Columns;
use crate::occlusion::{self, Occlusion};
use crate::sample::{Sample, towards_eye};
use crate::shade::{Look, Shader};
use crate::{Camera, Size};
use rayweave_model::{Evaluator, Query};
use rayweave_shape::Ray;

/// The buffers of a thread that looks along rays of opaque scenes.
pub(crate) struct Gaze<'a, E: Evaluator> {
    evaluator: &'a E,
    shader: &'a Shader,
    camera: &'a Camera,
    size: Size,
    scratch: E::Scratch,
    sight: Columns,
    occlusion: Occlusion,
    /// The lights that shine on what each ray sees, a bit each.
    lit: Vec<u32>,
}

impl<'a, E: Evaluator> Gaze<'a, E> {
    /// None where something is translucent, or where a shadow comes from a light without a place and the model has no end.
    pub fn new(evaluator: &'a E, shader: &'a Shader, camera: &'a Camera, size: Size) -> Option<Self> {
        let can_cast =
            !shader.casts_shadows() || occlusion::is_possible(shader.lights(), evaluator.program());
        (can_cast && !shader.is_translucent()).then(|| Gaze {
            evaluator,
            shader,
            camera,
            size,
            scratch: evaluator.scratch(),
            sight: Columns::default(),
            occlusion: Occlusion::default(),
            lit: Vec::new(),
        })
    }

    /// See [`crate::sample::Eye::look`].
    pub fn look(&mut self, places: &[[f64; 2]], samples: &mut [Sample], colours: &mut [Premultiplied]) {
        self.sight.clear();
        places.iter().for_each(|&[x, y]| self.sight.push(self.camera.ray(self.size, x, y)));
        self.sight.ask(self.evaluator, Query::nearest().window, true, &mut self.scratch);
        self.lit.clear();
        self.lit.resize(self.sight.len(), u32::MAX);
        if self.shader.casts_shadows() {
            self.occlusion.cast(self.evaluator, self.shader, &self.sight, &mut self.lit, &mut self.scratch);
        }
        for (i, colour) in colours.iter_mut().enumerate() {
            *colour = self.light(i).map_or([0.0; 4], |light| premultiply(light, 1.0));
        }
        samples.iter_mut().enumerate().for_each(|(i, sample)| *sample = self.sample(i));
    }

    /// The light that comes along a ray from a surface; `None` if there is none.
    #[inline]
    fn light(&self, i: usize) -> Option<Linear> {
        if !self.sight.is_hit(i) {
            return None;
        }
        let ray: Ray = self.sight.ray(i);
        let look = Look {
            point: ray.at(self.sight.t[i]),
            sight: ray.direction,
            normal: towards_eye(self.sight.normal(i), &ray),
            region: self.sight.seen(i),
            lit: self.lit[i],
        };
        Some(self.shader.shade(&look).0)
    }

    /// What is seen along a ray.
    fn sample(&self, i: usize) -> Sample {
        if !self.sight.is_hit(i) {
            return Sample::MISS;
        }
        Sample {
            t: self.sight.t[i],
            normal: towards_eye(self.sight.normal(i), &self.sight.ray(i)).as_vec3().to_array(),
            face: self.sight.face[i] as u32,
            placement: self.sight.placement[i],
            region: self.sight.seen(i).0,
            lit: self.lit[i],
        }
    }
}
