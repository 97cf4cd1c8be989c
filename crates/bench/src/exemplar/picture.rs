//! Geometry buffers of a picture of the die: depth, normals and ids.

use super::{Bench, Exemplar, die, text};
use crate::batch::camera;
use crate::ceiling::Need;
use crate::interleaved::{Candidate, Role, measure_in_turn};
use crate::report::Section;
use rayweave::AnyEvaluator;
use rayweave::render::{Camera, IdKind, Run, Size, geometry};
use std::num::NonZeroUsize;
use std::sync::Arc;

/// The size of the picture.
const SIZE: [u32; 2] = [1280, 720];

/// Depth, normals and ids of every pixel.
pub struct Picture;

impl Exemplar for Picture {
    fn name(&self) -> &'static str {
        "picture"
    }

    fn about(&self) -> &'static str {
        "Depth, normals and ids of the die in 1280 x 720 pixels; the minimum traffic is 36 bytes written per pixel."
    }

    fn measure(&self, bench: &Bench) -> Result<Vec<Section>, String> {
        let program = Arc::new(die::program().map_err(text)?);
        let evaluator = AnyEvaluator::new(None, program).map_err(text)?;
        let camera = camera().map_err(text)?;
        let size = Size::new(SIZE[0], SIZE[1]).map_err(text)?;
        let candidates = bench.on_threads(|threads| {
            let (evaluator, camera) = (&evaluator, &camera);
            let draw = move || draw(evaluator, camera, size, threads);
            Candidate::here("Rayweave", Role::Ours, 1, draw).threads(threads)
        });
        let outcomes = measure_in_turn(candidates, &bench.effort);
        let mut section = Section::new(self.name(), "frame", self.about());
        let needs = [Need::Bytes(36.0 * f64::from(SIZE[0] * SIZE[1]))];
        section.take(outcomes, |outcome| bench.floor(&needs, outcome.threads));
        Ok(vec![section])
    }
}

fn draw(evaluator: &AnyEvaluator, camera: &Camera, size: Size, threads: usize) {
    let mut run = Run { threads: NonZeroUsize::new(threads), ..Run::default() };
    // cannot fail: the run is never cancelled
    let _ = geometry(evaluator, camera, size, IdKind::default(), &mut run);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_die_is_in_the_picture() {
        let program = Arc::new(die::program().unwrap());
        let evaluator = AnyEvaluator::new(None, program).unwrap();
        let size = Size::new(64, 36).unwrap();
        let camera = camera().unwrap();
        let all = geometry(&evaluator, &camera, size, IdKind::default(), &mut Run::default()).unwrap();
        let seen = all.depth.values().iter().filter(|t| t.is_finite()).count();
        assert!((300..1500).contains(&seen), "{seen} of {} pixels", 64 * 36);
    }
}
