//! The exemplars: named workloads that candidates process.

mod array_csg;
pub mod die;
mod lens;
mod optics;
mod picture;
mod python;
mod question;
mod scale;

use crate::arguments::Arguments;
use crate::ceiling::{Ceilings, Floor, Need};
use crate::interleaved::{Candidate, Effort};
use crate::level;
use crate::peers::Peers;
use crate::report::Section;
use fearless_simd::Level;

/// A named workload.
pub trait Exemplar {
    /// Its name, a path with `/`.
    fn name(&self) -> &str;

    /// A description of the work in one or two sentences.
    fn about(&self) -> &str;

    /// Measures the candidates.
    ///
    /// # Errors The work cannot be set up.
    fn measure(&self, bench: &Bench) -> Result<Vec<Section>, String>;
}

/// Shared context of all exemplars.
pub struct Bench {
    /// The effort of the measurements.
    pub effort: Effort,
    /// Ceilings of the machine; `None` if nothing is timed.
    pub ceilings: Option<Ceilings>,
    /// Installed peers.
    pub peers: Peers,
    /// The SIMD levels of hand-written kernels.
    pub levels: Vec<Level>,
    /// The number of threads of multi-threaded candidates.
    pub threads: usize,
}

impl Bench {
    /// The context for the given options.
    pub fn new(arguments: &Arguments, ceilings: Option<Ceilings>, peers: Peers) -> Bench {
        let levels = level::available(arguments.level.as_deref());
        Bench { effort: arguments.effort(), ceilings, peers, levels, threads: arguments.thread_count() }
    }

    /// The minimum time of one item.
    fn floor(&self, needs: &[Need], threads: usize) -> Option<Floor> {
        self.ceilings.as_ref()?.floor(needs, threads)
    }

    /// The candidates on one thread and, if there are several, on all threads.
    fn on_threads<'a>(&self, candidate: impl Fn(usize) -> Candidate<'a>) -> Vec<Candidate<'a>> {
        match self.threads {
            1 => vec![candidate(1)],
            all => vec![candidate(1), candidate(all)],
        }
    }
}

/// All exemplars, with or without the large ones.
pub fn all(large: bool) -> Vec<Box<dyn Exemplar>> {
    let mut all = array_csg::all();
    all.extend(die::all());
    all.extend(lens::all());
    all.extend(optics::all());
    all.push(Box::new(picture::Picture));
    all.extend(python::all());
    all.extend(scale::all(large));
    all
}

/// An error as text.
fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique() {
        let exemplars = all(true);
        let mut names: Vec<&str> = exemplars.iter().map(|exemplar| exemplar.name()).collect();
        names.sort_unstable();
        let count = names.len();
        names.dedup();
        assert!(count > 10 && names.len() == count);
        assert!(exemplars.iter().all(|exemplar| exemplar.about().ends_with('.')));
    }
}
