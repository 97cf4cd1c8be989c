//! Models of many leaves: time per ray as the model grows.

use super::{Bench, Exemplar, question, text};
use crate::answer::{Agreement, first_lists, full_lists};
use crate::batch::incoherent;
use crate::ceiling::Need;
use crate::interleaved::{Candidate, Outcome, Role, measure_in_turn};
use crate::report::Section;
use crate::statistics::Statistics;
use rayweave::model::{RayBatch, Rays};
use rayweave::{AnyEvaluator, Evaluator, Program, Solid};
use rayweave_conformance::scale;
use std::sync::Arc;
use std::time::Instant;

/// Rays per batch of fast candidates.
const RAYS: usize = 1 << 14;

/// Rays of the trial run, and rays whose results are compared.
const FEW: usize = 64;

/// The time limit of the trial run of an evaluator, in seconds.
const PATIENCE: f64 = 2.0;

/// A family of models.
type Family = (&'static str, fn(usize) -> Solid);

const FAMILIES: [Family; 4] = [
    ("spheres", |n| scale::spheres(n, 1)),
    ("plate", scale::plate),
    ("sponge", scale::sponge),
    ("lattice", scale::lattice),
];

/// One model of a family.
struct Scale {
    name: String,
    about: String,
    make: fn(usize) -> Solid,
    leaves: usize,
}

/// The models: 10^3, 10^4 and 10^5 leaves, and 10^6 on request.
pub fn all(large: bool) -> Vec<Box<dyn Exemplar>> {
    let sizes = [("1e3", 1000), ("1e4", 10_000), ("1e5", 100_000), ("1e6", 1_000_000)];
    let count = if large { 4 } else { 3 };
    let one = |(family, make): Family, (size, leaves): (&str, usize)| -> Box<dyn Exemplar> {
        let what = match family {
            "spheres" => "a union of random spheres whose packing density does not depend on their number",
            "plate" => "a plate less round holes",
            "sponge" => "a sponge by nested differences",
            _ => "many placed copies of a die of five leaves",
        };
        let about = format!(
            "About {size} leaves: {what}. Measures compilation, all crossings and the first crossing."
        );
        Box::new(Scale { name: format!("scale/{family}/{size}"), about, make, leaves })
    };
    FAMILIES.iter().flat_map(|family| sizes[..count].iter().map(|size| one(*family, *size))).collect()
}

impl Exemplar for Scale {
    fn name(&self) -> &str {
        &self.name
    }

    fn about(&self) -> &str {
        &self.about
    }

    fn measure(&self, bench: &Bench) -> Result<Vec<Section>, String> {
        let solid = (self.make)(self.leaves);
        let started = Instant::now();
        let program = Arc::new(Program::compile(&solid).map_err(text)?);
        let compiling = self.compiling(bench, started.elapsed().as_secs_f64());
        let batch = incoherent(bench.effort.size(RAYS), 3);
        let mut full = Section::new(format!("{}/full", self.name), "ray", "Every crossing, with its face.");
        let mut first =
            Section::new(format!("{}/first", self.name), "ray", "The first crossing, with normal.");
        let (mut lists, mut firsts) = (Vec::new(), Vec::new());
        let evaluators = self.evaluators(&program, &mut full);
        for evaluator in &evaluators {
            match rows(evaluator, &batch) {
                Ok((rows, count)) => lists.push((evaluator, rows, count)),
                Err(problem) => full.failures.push((evaluator.name().to_owned(), problem)),
            }
            match patient_count(evaluator, &batch, |few| first_lists(evaluator, few).map(drop).map_err(text))
            {
                Ok(count) => firsts.push((evaluator, count)),
                Err(problem) => first.failures.push((evaluator.name().to_owned(), problem)),
            }
        }
        let batches: Vec<RayBatch> = lists.iter().map(|(_, _, count)| beginning(&batch, *count)).collect();
        let candidates = lists.iter().zip(&batches).map(|((evaluator, rows, _), batch)| {
            question::full(evaluator.name(), evaluator, batch.rays(), *rows)
        });
        take(&mut full, bench, candidates.collect());
        let batches: Vec<RayBatch> = firsts.iter().map(|(_, count)| beginning(&batch, *count)).collect();
        let candidates = firsts
            .iter()
            .zip(&batches)
            .map(|((evaluator, _), batch)| question::first(evaluator.name(), evaluator, batch.rays()));
        take(&mut first, bench, candidates.collect::<Result<_, _>>()?);
        compare(&mut full, &mut first, &evaluators, &beginning(&batch, FEW))?;
        Ok(vec![compiling, full, first])
    }
}

impl Scale {
    /// Compilation runs once: it takes long, and is not repeated in practice either.
    fn compiling(&self, bench: &Bench, seconds: f64) -> Section {
        let mut section = Section::new(format!("{}/compile", self.name), "leaf", &*self.about);
        let times = Statistics::of(&[1e9 * seconds / self.leaves as f64]).ok_or_else(String::new);
        let outcome = Outcome { name: "compile".to_owned(), role: Role::Ours, threads: bench.threads, times };
        section.take(vec![outcome], |_| None);
        section
    }

    /// The evaluators that support a model of this size.
    fn evaluators(&self, program: &Arc<Program>, section: &mut Section) -> Vec<AnyEvaluator> {
        let mut evaluators = Vec::new();
        for name in AnyEvaluator::NAMES {
            match AnyEvaluator::new(Some(name), program.clone()) {
                Ok(evaluator) => evaluators.push(evaluator),
                Err(error) => section.failures.push((name.to_owned(), text(error))),
            }
        }
        evaluators
    }
}

/// The number of rows of hits, and the number of rays that an evaluator can process in reasonable
/// time.
fn rows(evaluator: &AnyEvaluator, batch: &RayBatch) -> Result<(usize, usize), String> {
    let longest = |lists: Vec<Vec<f64>>| lists.iter().map(Vec::len).max().unwrap_or(0);
    let mut most = 0;
    let count = patient_count(evaluator, batch, |few| {
        most = longest(full_lists(evaluator, few));
        Ok(())
    })?;
    if count > FEW {
        most = longest(full_lists(evaluator, beginning(batch, count).rays()));
    }
    Ok((most.max(2).next_multiple_of(2), count))
}

/// The number of rays that take about a tenth of a second, extrapolated from a few rays; an error
/// if even these take too long.
fn patient_count(
    evaluator: &AnyEvaluator,
    batch: &RayBatch,
    run_query: impl FnOnce(Rays<'_>) -> Result<(), String>,
) -> Result<usize, String> {
    let few = beginning(batch, FEW);
    let started = Instant::now();
    run_query(few.rays())?;
    let seconds = started.elapsed().as_secs_f64();
    if seconds > PATIENCE {
        return Err(format!("left out: {} takes {seconds:.1} s for {FEW} rays.", evaluator.name()));
    }
    let count = (0.1 / seconds * FEW as f64) as usize;
    Ok(count.clamp(FEW, batch.rays().len()))
}

fn beginning(batch: &RayBatch, count: usize) -> RayBatch {
    (0..count.min(batch.rays().len())).map(|i| batch.rays().get(i)).collect()
}

/// The minimum cost is to read a ray and to write its hits; the rest depends on the model.
fn take(section: &mut Section, bench: &Bench, candidates: Vec<Candidate<'_>>) {
    let outcomes = measure_in_turn(candidates, &bench.effort);
    section.take(outcomes, |outcome| bench.floor(&[Need::Bytes(96.0)], outcome.threads));
}

/// Compares all measured evaluators with `reference` or, if that was too slow, with the first of
/// them.
fn compare(
    full: &mut Section,
    first: &mut Section,
    evaluators: &[AnyEvaluator],
    few: &RayBatch,
) -> Result<(), String> {
    let measured = |section: &Section, name: &str| section.figures.iter().any(|figure| figure.name == name);
    let able = |section: &Section| -> Vec<&AnyEvaluator> {
        evaluators.iter().filter(|evaluator| measured(section, evaluator.name())).collect()
    };
    let all = able(full);
    let Some(oracle) = all.iter().find(|evaluator| evaluator.name() == "reference").or(all.first()) else {
        return Ok(());
    };
    let expected = full_lists(*oracle, few.rays());
    for evaluator in &all {
        let found = full_lists(*evaluator, few.rays());
        full.agree(evaluator.name(), Ok(Agreement::of(&expected, &found)));
    }
    let expected = first_lists(*oracle, few.rays()).map_err(text)?;
    for evaluator in able(first) {
        let found = first_lists(evaluator, few.rays()).map_err(text)?;
        first.agree(evaluator.name(), Ok(Agreement::of(&expected, &found)));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::Clock;
    use crate::interleaved::Effort;

    #[test]
    fn a_small_model_of_each_family_is_measured() {
        let effort = Effort::Rounds { rounds: 2, seconds: 1e-6, shrink: 1000, clock: Clock::Wall };
        let bench =
            Bench { effort, ceilings: None, peers: Default::default(), levels: Vec::new(), threads: 1 };
        for (family, make) in FAMILIES {
            let exemplar = Scale { name: family.to_owned(), about: String::new(), make, leaves: 40 };
            let sections = exemplar.measure(&bench).unwrap();
            let names: Vec<&str> = sections.iter().map(|section| section.name.as_str()).collect();
            assert_eq!(names, ["compile", "full", "first"].map(|what| format!("{family}/{what}")));
            assert_eq!(sections[1].figures.len(), AnyEvaluator::NAMES.len());
            let agreements = sections[1..].iter().flat_map(|section| &section.figures).map(|f| f.agreement);
            assert!(agreements.into_iter().all(|agreement| agreement.is_some_and(|a| a.is_same())));
        }
    }
}
