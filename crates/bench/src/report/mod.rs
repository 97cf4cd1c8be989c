//! Report of a benchmark, for people (Markdown, SVG) and programs (JSON).

mod json;
mod markdown;
mod plot;
mod text;

use crate::answer::Agreement;
use crate::ceiling::{Ceilings, Floor};
use crate::interleaved::{Outcome, Role};
use crate::peers::FROM_PYTHON;
use crate::statistics::Statistics;

pub use json::json;
pub use markdown::markdown;
pub use plot::plot;
pub use text::{ceilings, section};

/// All results of a run.
pub struct Report {
    /// The day, YYYY-MM-DD.
    pub date: String,
    /// The command line.
    pub command: String,
    /// Facts about the machine.
    pub machine: Vec<(&'static str, String)>,
    /// Ceilings of the machine.
    pub ceilings: Ceilings,
    /// The peers that were measured, with their versions.
    pub peers: Vec<(String, String)>,
    /// The missing peers, with the reasons.
    pub missing: Vec<(String, String)>,
    /// The results of the exemplars.
    pub sections: Vec<Section>,
}

/// The results of one kind of query of an exemplar.
#[derive(Default)]
pub struct Section {
    /// Its name, a path.
    pub name: String,
    /// A description of the work in one or two sentences.
    pub about: String,
    /// Unit of the work, usually rays.
    pub item: &'static str,
    /// Measurements.
    pub figures: Vec<Figure>,
    /// Candidates that failed, with the reasons.
    pub failures: Vec<(String, String)>,
}

/// Measurements of one candidate.
pub struct Figure {
    /// Its name.
    pub name: String,
    /// Its role.
    pub role: Role,
    /// The number of threads.
    pub threads: usize,
    /// Nanoseconds per item.
    pub time: Statistics,
    /// The minimum time, and the resource that limits it.
    pub floor: Option<Floor>,
    /// The agreement of its results with the reference.
    pub agreement: Option<Agreement>,
    /// Instructions per item.
    pub instructions: Option<f64>,
}

impl Section {
    /// Creates a section without figures.
    pub fn new(name: impl Into<String>, item: &'static str, about: impl Into<String>) -> Section {
        Section { name: name.into(), about: about.into(), item, ..Section::default() }
    }

    /// Adds the results of a measurement; `floor` returns the minimum time of a candidate.
    pub fn take(&mut self, outcomes: Vec<Outcome>, floor: impl Fn(&Outcome) -> Option<Floor>) {
        for outcome in outcomes {
            let floor = floor(&outcome);
            let Outcome { name, role, threads, times } = outcome;
            match times {
                Ok(time) => self.figures.push(Figure {
                    name,
                    role,
                    threads,
                    time,
                    floor,
                    agreement: None,
                    instructions: None,
                }),
                Err(problem) => self.failures.push((name, problem)),
            }
        }
    }

    /// Records the agreement of a candidate with the reference, or the reason why it is unknown.
    pub fn agree(&mut self, name: &str, agreement: Result<Agreement, String>) {
        match agreement {
            Ok(agreement) => {
                let figures = self.figures.iter_mut().filter(|figure| figure.name == name);
                figures.for_each(|figure| figure.agreement = Some(agreement));
            }
            Err(problem) => self.failures.push((name.to_owned(), problem)),
        }
    }

    /// The candidate of a role with the smallest median time.
    pub fn fastest(&self, role: Role) -> Option<&Figure> {
        let figures = self.figures.iter().filter(|figure| figure.role == role);
        figures.min_by(|a, b| a.time.median.total_cmp(&b.time.median))
    }

    /// The time of a call from Python relative to the same call from Rust, which is the first of
    /// this project's candidates with as many threads; `None` for others.
    pub fn over_rust(&self, figure: &Figure) -> Option<f64> {
        let is_python = |figure: &Figure| figure.name == FROM_PYTHON;
        let mut figures = self.figures.iter().filter(|other| other.threads == figure.threads);
        let rust = figures.find(|other| other.role == Role::Ours && !is_python(other));
        rust.filter(|_| is_python(figure)).map(|rust| figure.time.median / rust.time.median)
    }
}

impl Figure {
    /// Items per second.
    pub fn rate(&self) -> f64 {
        1e9 / self.time.median
    }

    /// The fraction of the limit that is achieved.
    pub fn fraction(&self) -> Option<f64> {
        Some(self.floor.as_ref()?.time / self.time.median)
    }
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::ceiling::Rates;
    use fearless_simd::Level;

    /// A report with an example of every part.
    pub fn example() -> Report {
        let statistics = |sample: &[f64]| Statistics::of(sample).unwrap();
        let outcome = |name: &str, role, times| Outcome { name: name.to_owned(), role, threads: 1, times };
        let mut section = Section::new("die/full", "ray", "Every crossing of a \"die\".");
        let outcomes = vec![
            outcome("weave", Role::Ours, Ok(statistics(&[9.0, 10.0, 12.0]))),
            outcome("VecGeom", Role::Peer, Ok(statistics(&[500.0]))),
            outcome("by hand", Role::Ceiling, Ok(statistics(&[5.0]))),
            outcome("Geant4", Role::Peer, Err("it broke".to_owned())),
        ];
        section.take(outcomes, |_| Some(Floor { what: "kernel by hand", time: 5.0 }));
        let same = Agreement { rays: 10, other_count: 0, other_time: 0, worst: 0.0 };
        section.agree("weave", Ok(same));
        let one = statistics(&[1.0]);
        let rates =
            Rates { level: Level::new(), fused: one, simple: one, extremes: one, divisions: one, roots: one };
        Report {
            date: "2026-01-02".to_owned(),
            command: "rayweave bench".to_owned(),
            machine: vec![("cores", "2".to_owned())],
            ceilings: Ceilings { copy: [one, one], levels: vec![rates], threads: 2 },
            peers: vec![("VecGeom".to_owned(), "1.2.1".to_owned())],
            missing: vec![("Raysect".to_owned(), "it is not there".to_owned())],
            sections: vec![section],
        }
    }

    #[test]
    fn python_is_compared_with_rust_on_as_many_threads() {
        let mut section = Section::new("python", "ray", "A call.");
        let times = |ns| Ok(Statistics::of(&[ns]).unwrap());
        let outcome = |name: &str, threads, ns| Outcome {
            name: name.to_owned(),
            role: Role::Ours,
            threads,
            times: times(ns),
        };
        let outcomes = [("Rust", 1, 8.0), ("Rust", 2, 4.0), (FROM_PYTHON, 1, 10.0), (FROM_PYTHON, 2, 6.0)];
        section.take(outcomes.map(|(name, threads, ns)| outcome(name, threads, ns)).into(), |_| None);
        let taxes: Vec<_> = section.figures.iter().map(|figure| section.over_rust(figure)).collect();
        assert_eq!(taxes, [None, None, Some(1.25), Some(1.5)]);
        assert!(text::section(&section).contains("| 1.25 x "));
    }

    #[test]
    fn figures_know_their_rate_and_fraction() {
        let report = example();
        let section = &report.sections[0];
        let ours = section.fastest(Role::Ours).unwrap();
        assert_eq!((ours.rate(), ours.fraction()), (1e8, Some(0.5)));
        assert!(ours.agreement.is_some_and(|agreement| agreement.is_same()));
        assert_eq!(section.failures, [("Geant4".to_owned(), "it broke".to_owned())]);
        assert_eq!(section.fastest(Role::Peer).unwrap().name, "VecGeom");
    }
}
