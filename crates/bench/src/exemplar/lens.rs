//! A lens of three leaves: two spheres and a cylinder.

use super::{Bench, Exemplar, question, text};
use crate::answer::{Agreement, first_lists, full_lists};
use crate::batch::lens_rays;
use crate::ceiling::Need;
use crate::interleaved::{Candidate, measure_in_turn};
use crate::report::Section;
use rayweave::model::{RayBatch, Rays};
use rayweave::shapes::{cylinder, sphere};
use rayweave::{AnyEvaluator, Error, Program, Reference, Solid};
use std::sync::Arc;

/// The lens is convex: at most two crossings.
const ROWS: usize = 2;

/// The number of rays whose results are compared.
const COMPARED: usize = 4096;

/// Minimum operations per ray: a square root and a division for each of three quadrics. Additions
/// and multiplications: 13 for each sphere about a point of the axis, 8 for the cylinder, 4 for the
/// roots of each, 6 to combine and select.
const OPERATIONS: Need = Need::Operations { simple: 52.0, divisions: 3.0, roots: 3.0, level: None };

/// A biconvex lens of radius 50 and aperture 20.
fn solid() -> Result<Solid, Error> {
    let front = sphere(50.0)?.translate([0.0, 0.0, 48.0]);
    let back = sphere(50.0)?.translate([0.0, 0.0, -48.0]);
    Ok(front & back & cylinder(10.0, f64::INFINITY)?)
}

/// One kind of query on `count` rays.
struct Lens {
    name: &'static str,
    about: &'static str,
    rays: usize,
    is_first: bool,
}

/// All queries on the lens.
pub fn all() -> Vec<Box<dyn Exemplar>> {
    let first = Lens {
        name: "lens/first",
        about: "The first crossing with a lens (two spheres and a cylinder), with its face and its normal, for 2^20 rays.",
        rays: 1 << 20,
        is_first: true,
    };
    let full = |name, rays| Lens {
        name,
        about: "Every crossing with the lens, with its face, like PyRayT's `intersect`.",
        rays,
        is_first: false,
    };
    vec![
        Box::new(first),
        Box::new(full("lens/full/1e5", 100_000)),
        Box::new(full("lens/full/1e6", 1_000_000)),
    ]
}

impl Exemplar for Lens {
    fn name(&self) -> &str {
        self.name
    }

    fn about(&self) -> &str {
        self.about
    }

    fn measure(&self, bench: &Bench) -> Result<Vec<Section>, String> {
        let program = Arc::new(Program::compile(&solid().map_err(text)?).map_err(text)?);
        let evaluator = AnyEvaluator::new(None, program.clone()).map_err(text)?;
        let batch = lens_rays(bench.effort.size(self.rays), 2);
        let (rays, file, task) = (batch.rays(), self.name.replace('/', "-"), self.task());
        bench.peers.give_rays(&file, rays).map_err(text)?;
        let mut candidates = self.ours(bench, &evaluator, rays)?;
        let whole = |candidate: Candidate<'static>| candidate.whole();
        candidates.extend(bench.peers.candidates(task, &file, rays.len()).into_iter().map(whole));
        let outcomes = measure_in_turn(candidates, &bench.effort);
        let mut section = Section::new(self.name, "ray", self.about);
        section.take(outcomes, |outcome| bench.floor(&self.needs(), outcome.threads));
        self.compare(&mut section, bench, &program, &batch, &file)?;
        Ok(vec![section])
    }
}

impl Lens {
    fn task(&self) -> &'static str {
        if self.is_first { "lens.first" } else { "lens.full" }
    }

    fn ours<'a>(
        &self,
        bench: &Bench,
        evaluator: &'a AnyEvaluator,
        rays: Rays<'a>,
    ) -> Result<Vec<Candidate<'a>>, String> {
        let name = "Rayweave";
        if self.is_first {
            let one = question::first_on_threads(name, evaluator, rays, 1)?;
            let all = question::first_on_threads(name, evaluator, rays, bench.threads)?;
            return Ok(if bench.threads > 1 { vec![one, all] } else { vec![one] });
        }
        Ok(bench.on_threads(|threads| question::full_on_threads(name, evaluator, rays, ROWS, threads)))
    }

    /// In addition to the operations, memory traffic: a ray read; a time, three ids, a face and a
    /// normal written, or two entries.
    fn needs(&self) -> [Need; 2] {
        let written = if self.is_first { 8 + 3 * 4 + 4 + 24 } else { ROWS * 12 };
        [OPERATIONS, Need::Bytes((48 + written) as f64)]
    }

    fn compare(
        &self,
        section: &mut Section,
        bench: &Bench,
        program: &Arc<Program>,
        batch: &RayBatch,
        file: &str,
    ) -> Result<(), String> {
        let few: RayBatch = (0..COMPARED.min(batch.rays().len())).map(|i| batch.rays().get(i)).collect();
        let reference = Reference::new(program.clone());
        let expected = match self.is_first {
            true => first_lists(&reference, few.rays()).map_err(text)?,
            false => full_lists(&reference, few.rays()),
        };
        for (name, answer) in bench.peers.answers(self.task(), file, few.rays().len()) {
            section.agree(&name, answer.map(|found| Agreement::of(&expected, &found)));
        }
        Ok(())
    }
}
