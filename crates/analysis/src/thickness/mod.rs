//! Path lengths of rays through media, and radiographs.
//!
//! The path length of a ray through a medium is the total length of the ray inside it. An X-ray attenuated by
//! `mu` per length is transmitted with the factor `exp(-sum of mu l)` (Beer-Lambert law); scattering is
//! ignored.

mod attenuation;
mod map;

pub use crate::error::Cancelled;
pub use attenuation::check_attenuations;
pub use map::{FAINTEST, MAX_LENGTHS, ThicknessMap, transmitted};

use crate::error::AnalysisError;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::{BadRay, Evaluator, Query, RayAnswer, RayBatch, RegionId};
use rayweave_shape::Ray;
use std::num::NonZeroUsize;
use std::ops::Range;

/// Rays per task.
const RAYS_PER_TASK: usize = 4096;

/// The options of a run.
#[derive(Default)]
pub struct ThicknessRun<'a> {
    /// The number of threads; by default that of [`thread_count`]. Results do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Cancels the run.
    pub cancel: Cancel,
    /// Callback with the number of finished rays, on the calling thread.
    pub progress: Option<&'a mut dyn FnMut(usize)>,
}

/// The path lengths of rays through media.
#[derive(Clone, Debug, PartialEq)]
pub struct PathLengths {
    media: usize,
    values: Vec<f64>,
}

impl PathLengths {
    /// The number of media.
    pub fn media(&self) -> usize {
        self.media
    }

    /// The number of rays.
    pub fn len(&self) -> usize {
        self.values.len() / self.media
    }

    /// True if there is no ray.
    pub fn is_empty(&self) -> bool {
        self.values.is_empty()
    }

    /// The path lengths of a ray, medium by medium; for the world, number 0, between its first and its last
    /// crossing. `inf` in an unbounded medium.
    pub fn of(&self, ray: usize) -> &[f64] {
        &self.values[ray * self.media..(ray + 1) * self.media]
    }

    /// All path lengths, ray by ray.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

/// Computes the path lengths of `count` rays, as whole lines, through the first `media` media.
///
/// `ray` returns ray k. Lengths are in model units, independent of the lengths of directions.
///
/// # Errors
///
/// [`AnalysisError::Ray`] for the first ray that does not pass [`Program::check_rays`](rayweave_model::Program::check_rays);
/// [`AnalysisError::Cancelled`].
pub fn path_lengths<E: Evaluator>(
    evaluator: &E,
    media: usize,
    count: usize,
    ray: impl Fn(usize) -> Ray + Sync,
    run: &mut ThicknessRun<'_>,
) -> Result<PathLengths, AnalysisError> {
    let media = media.max(1);
    let mut values = Vec::with_capacity(count * media);
    let tasks = (0..count).step_by(RAYS_PER_TASK).map(|first| first..count.min(first + RAYS_PER_TASK));
    let scratch = || (evaluator.scratch(), RayBatch::default());
    let work = |(scratch, batch): &mut (E::Scratch, RayBatch), range: Range<usize>| {
        batch.clear();
        range.clone().for_each(|k| batch.push(ray(k)));
        let rays = batch.rays();
        evaluator.program().check_rays(rays).map_err(|bad| BadRay { ray: range.start + bad.ray, ..bad })?;
        let mut lengths = vec![0.0; batch.len() * media];
        let mut sink = |answer: RayAnswer<'_>| {
            let speed = rays.get(answer.ray).direction.length();
            let own = &mut lengths[answer.ray * media..(answer.ray + 1) * media];
            add(evaluator, &answer, speed, own);
        };
        evaluator.crossings(rays, &Query::default(), scratch, &mut sink);
        Ok(lengths)
    };
    let progress = &mut run.progress;
    let merge = |lengths: Result<Vec<f64>, BadRay>| {
        values.extend(lengths?);
        if let Some(progress) = progress {
            progress(values.len() / media);
        }
        Ok(())
    };
    drive(thread_count(run.threads), &run.cancel, tasks, scratch, work, merge).map_err(|stopped| {
        match stopped {
            Stopped::Cancelled => Cancelled.into(),
            Stopped::Failed(bad) => AnalysisError::Ray(bad),
        }
    })?;
    Ok(PathLengths { media, values })
}

fn add<E: Evaluator>(evaluator: &E, answer: &RayAnswer<'_>, speed: f64, lengths: &mut [f64]) {
    let program = evaluator.program();
    let mut piece = |region: RegionId, from: f64, to: f64| {
        let is_open = from == f64::NEG_INFINITY || to == f64::INFINITY;
        let slot = lengths.get_mut(program.medium_of(region) as usize);
        if let Some(length) = slot.filter(|_| region != RegionId(0) || !is_open) {
            *length += (to - from) * speed;
        }
    };
    let (mut region, mut from) = (answer.start, f64::NEG_INFINITY);
    for crossing in answer.crossings {
        piece(region, from, crossing.t);
        (region, from) = (crossing.after, crossing.t);
    }
    piece(region, from, f64::INFINITY);
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_math::Vec3;
    use rayweave_model::{Program, Region, Solid};
    use rayweave_shape::primitive::{CentredBox, HalfSpace, Primitive, Sphere};
    use rayweave_trace::Packets;
    use std::sync::Arc;

    fn tracer() -> Packets {
        let solid = |primitive: Primitive| Solid::from(primitive);
        let cube = solid(CentredBox::new(Vec3::splat(2.0)).unwrap().into());
        let ball = solid(Sphere::new(0.5).unwrap().into());
        let far = cube.translate(Vec3::new(5.0, 0.0, 0.0));
        let floor = solid(HalfSpace::new(Vec3::Z, -3.0).unwrap().into());
        let region = |name: &str, solid: Solid, medium: u32| Region { name: name.to_owned(), solid, medium };
        let regions = [region("cube", cube | far, 1), region("ball", ball, 2), region("floor", floor, 3)];
        Packets::new(Arc::new(Program::compile_regions(&regions).unwrap()))
    }

    /// Through both cubes and the ball; outside the ball; through nothing; down into the floor.
    #[test]
    fn chords() {
        let ray = |k: usize| match k {
            0 => Ray::new(Vec3::new(-10.0, 0.0, 0.0), Vec3::X * 0.25),
            1 => Ray::new(Vec3::new(0.0, 0.3, 7.0), Vec3::Y),
            2 => Ray::new(Vec3::new(0.3, 0.0, 0.9), Vec3::Y),
            _ => Ray::new(Vec3::new(0.0, 0.4, 0.0), Vec3::NEG_Z * 3.0),
        };
        let found = path_lengths(&tracer(), 4, 4, ray, &mut ThicknessRun::default()).unwrap();
        let expected = [[3.0, 3.0, 1.0, 0.0], [0.0; 4], [0.0, 2.0, 0.0, 0.0], [2.0, 1.4, 0.6, f64::INFINITY]];
        for (k, expected) in expected.iter().enumerate() {
            let is_near = |(a, b): (&f64, &f64)| a == b || (a - b).abs() < 1e-12;
            assert!(found.of(k).iter().zip(expected).all(is_near), "{k}: {:?}", found.of(k));
        }
        assert_eq!((found.len(), found.media(), found.is_empty()), (4, 4, false));
        // media beyond the requested number are omitted
        let fewer = path_lengths(&tracer(), 2, 4, ray, &mut ThicknessRun::default()).unwrap();
        assert_eq!(fewer.of(0), &found.of(0)[..2]);
    }

    /// For parallel lines, the mean chord of a convex body is its volume over the area of its projection.
    #[test]
    fn the_same_on_any_number_of_threads_with_progress() {
        let n = 200;
        let ray = |k: usize| {
            let place = |i: usize| (i as f64 + 0.5) / n as f64 * 2.0 - 1.0;
            Ray::new(Vec3::new(place(k % n), place(k / n), 9.0), Vec3::NEG_Z)
        };
        let mut reported = 0;
        let mut progress = |done| reported = done;
        let mut run = ThicknessRun {
            threads: NonZeroUsize::new(3),
            progress: Some(&mut progress),
            ..ThicknessRun::default()
        };
        let found = path_lengths(&tracer(), 3, n * n, ray, &mut run).unwrap();
        let alone = ThicknessRun { threads: NonZeroUsize::new(1), ..ThicknessRun::default() };
        assert_eq!(found, path_lengths(&tracer(), 3, n * n, ray, &mut { alone }).unwrap());
        assert_eq!(reported, n * n);
        let ball: f64 = (0..n * n).map(|k| found.of(k)[2]).sum::<f64>() * 4.0 / (n * n) as f64;
        assert!((ball - std::f64::consts::PI / 6.0).abs() < 1e-3, "{ball}");
        let cancel = Cancel::new();
        cancel.cancel();
        let stopped =
            path_lengths(&tracer(), 3, 9, ray, &mut ThicknessRun { cancel, ..ThicknessRun::default() });
        assert!(matches!(stopped, Err(AnalysisError::Cancelled(Cancelled))));
        // the second task begins at ray 4096
        let far = |k: usize| Ray::new(Vec3::new(if k == 5000 { 1e101 } else { 9.0 }, 0.0, 0.0), Vec3::NEG_X);
        let refused = path_lengths(&tracer(), 3, 9000, far, &mut ThicknessRun::default());
        assert!(matches!(refused, Err(AnalysisError::Ray(BadRay { ray: 5000, .. }))));
    }
}
