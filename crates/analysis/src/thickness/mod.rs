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
use rayweave_error::Message;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::{BadRay, Evaluator, Program, Query, RayAnswer, RayBatch, RegionId, Window};
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
    /// The part of each ray that counts, in units of its direction; by default the whole line.
    pub window: Window,
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

/// Computes the path lengths of `count` rays through all media; `media` is their number, with the world:
/// `compiled.media.len()` for a scene.
///
/// `ray` returns ray k, of which the part in [`ThicknessRun::window`] counts. Lengths are in model units, independent of the lengths
/// of directions. With [`Compiled::by_region`](rayweave_scene::Compiled::by_region) each region is a medium of its own.
///
/// ```
/// use rayweave_analysis::thickness::{ThicknessRun, path_lengths};
/// use rayweave_math::Vec3;
/// use rayweave_model::Window;
/// use rayweave_scene::Compiled;
/// use rayweave_shape::Ray;
/// use rayweave_trace::Packets;
///
/// let (_, scene) = rayweave_scene::parse("rayweave = 1\n[solid.ball]\nsphere = { radius = 2 }")?;
/// let compiled = Compiled::new(&scene)?;
/// let packets = Packets::new(compiled.program.clone());
/// // from a source in the middle, half of the whole line
/// let ray = |_| Ray::new(Vec3::ZERO, Vec3::X);
/// let mut run = ThicknessRun { window: Window::new(0.0, f64::INFINITY)?, ..ThicknessRun::default() };
/// assert_eq!(path_lengths(&packets, compiled.media.len(), 1, ray, &mut run)?.of(0), [0.0, 2.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`AnalysisError::Value`] if a region has a medium of the number `media` or above, whose lengths would be lost;
/// [`AnalysisError::Ray`] for the first ray that does not pass [`Program::check_rays`](rayweave_model::Program::check_rays);
/// [`AnalysisError::Cancelled`].
pub fn path_lengths<E: Evaluator>(
    evaluator: &E,
    media: usize,
    count: usize,
    ray: impl Fn(usize) -> Ray + Sync,
    run: &mut ThicknessRun<'_>,
) -> Result<PathLengths, AnalysisError> {
    check_media(evaluator.program(), media)?;
    let (media, window) = (media.max(1), run.window);
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
            add(evaluator, &answer, (window, speed), own);
        };
        evaluator.crossings(rays, &Query { window, ..Query::default() }, scratch, &mut sink);
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

/// Rejects a number of media that leaves out the medium of a region.
fn check_media(program: &Program, media: usize) -> Result<(), AnalysisError> {
    let largest = program.regions().iter().max_by_key(|region| region.medium);
    match largest.filter(|region| region.medium as usize >= media.max(1)) {
        None => Ok(()),
        Some(region) => {
            let problem = format!("the number of media is {media}");
            let reason = format!("the region '{}' has the medium {}", region.name, region.medium);
            let message =
                Message::new(problem, reason).suggest(format!("Pass at least {}", region.medium + 1));
            Err(AnalysisError::Value(message))
        }
    }
}

fn add<E: Evaluator>(
    evaluator: &E,
    answer: &RayAnswer<'_>,
    (window, speed): (Window, f64),
    lengths: &mut [f64],
) {
    let program = evaluator.program();
    let mut piece = |region: RegionId, from: f64, to: f64| {
        let is_open = from == window.t_min() || to == window.t_max();
        let slot = lengths.get_mut(program.medium_of(region) as usize);
        if let Some(length) = slot.filter(|_| region != RegionId(0) || !is_open) {
            *length += (to - from) * speed;
        }
    };
    let (mut region, mut from) = (answer.start, window.t_min());
    for crossing in answer.crossings {
        piece(region, from, crossing.t);
        (region, from) = (crossing.after, crossing.t);
    }
    piece(region, from, window.t_max());
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
    }

    #[test]
    fn a_number_of_media_that_loses_some_is_an_error() {
        let ray = |_| Ray::new(Vec3::new(-10.0, 0.0, 0.0), Vec3::X);
        for media in [0, 2, 3] {
            let error = path_lengths(&tracer(), media, 1, ray, &mut ThicknessRun::default()).unwrap_err();
            let expected = format!(
                "the number of media is {media}: the region 'floor' has the medium 3. Pass at least 4."
            );
            assert_eq!(error.to_string(), expected);
        }
        let more = path_lengths(&tracer(), 6, 1, ray, &mut ThicknessRun::default()).unwrap();
        assert_eq!(more.of(0), [3.0, 3.0, 1.0, 0.0, 0.0, 0.0]);
    }

    /// From within the ball to within the second cube, with a direction of length 4: 0.25 of the ball, 0.5 of the cube around it, 3 of
    /// the world between them, 1.5 of the second cube. Outside of all, the world of a window counts only between crossings.
    #[test]
    fn windows_limit_the_rays() {
        let run =
            |from, to| ThicknessRun { window: Window::new(from, to).unwrap(), ..ThicknessRun::default() };
        let ray = |_| Ray::new(Vec3::new(0.25, 0.0, 0.0), Vec3::X * 4.0);
        let found = path_lengths(&tracer(), 4, 1, ray, &mut run(0.0, 5.25 / 4.0)).unwrap();
        for (own, expected) in found.of(0).iter().zip([3.0, 2.0, 0.25, 0.0]) {
            assert!((own - expected).abs() < 1e-12, "{found:?}");
        }
        let before = path_lengths(&tracer(), 4, 1, ray, &mut run(0.5, 0.75)).unwrap();
        assert_eq!(before.of(0), [0.0; 4]);
        // a window within one medium, without crossings
        let within = path_lengths(&tracer(), 4, 1, ray, &mut run(-0.125, 0.0625)).unwrap();
        assert_eq!(within.of(0), [0.0, 0.0, 0.75, 0.0]);
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
        let found = path_lengths(&tracer(), 4, n * n, ray, &mut run).unwrap();
        let alone = ThicknessRun { threads: NonZeroUsize::new(1), ..ThicknessRun::default() };
        assert_eq!(found, path_lengths(&tracer(), 4, n * n, ray, &mut { alone }).unwrap());
        assert_eq!(reported, n * n);
        let ball: f64 = (0..n * n).map(|k| found.of(k)[2]).sum::<f64>() * 4.0 / (n * n) as f64;
        assert!((ball - std::f64::consts::PI / 6.0).abs() < 1e-3, "{ball}");
        let cancel = Cancel::new();
        cancel.cancel();
        let stopped =
            path_lengths(&tracer(), 4, 9, ray, &mut ThicknessRun { cancel, ..ThicknessRun::default() });
        assert!(matches!(stopped, Err(AnalysisError::Cancelled(Cancelled))));
        // the second task begins at ray 4096
        let far = |k: usize| Ray::new(Vec3::new(if k == 5000 { 1e101 } else { 9.0 }, 0.0, 0.0), Vec3::NEG_X);
        let refused = path_lengths(&tracer(), 4, 9000, far, &mut ThicknessRun::default());
        assert!(matches!(refused, Err(AnalysisError::Ray(BadRay { ray: 5000, .. }))));
    }
}
