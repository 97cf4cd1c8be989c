//! Command-line options of a benchmark run.

use crate::clock::Clock;
use crate::interleaved::Effort;
use crate::level;
use clap::Args;
use rayweave::model::drive::thread_count;
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// The options of the benchmark.
#[derive(Args, Clone, Debug, Default)]
pub struct Arguments {
    /// Run only exemplars whose names begin with this text. May be repeated
    #[arg(long, value_name = "NAME")]
    pub only: Vec<String>,

    /// Print the names of the exemplars, and measure nothing
    #[arg(long)]
    pub list: bool,

    /// Run for a few seconds only: a smoke test without meaningful times
    #[arg(long)]
    pub quick: bool,

    /// Add the models of a million leaves
    #[arg(long)]
    pub large: bool,

    /// Write all figures as JSON
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,

    /// Write the page of results, with its plot in the same folder
    #[arg(long, value_name = "FILE")]
    pub markdown: Option<PathBuf>,

    /// Write the plot as SVG
    #[arg(long, value_name = "FILE.svg")]
    pub plot: Option<PathBuf>,

    /// Folder in which peers/install.sh has installed the peers
    #[arg(long, value_name = "DIR")]
    pub peers: Option<PathBuf>,

    /// The widest SIMD level of hand-written kernels and ceilings
    #[arg(long, value_name = "LEVEL", value_parser = level::NAMES)]
    pub level: Option<String>,

    /// Also count the instructions of candidates, with valgrind
    #[arg(long)]
    pub instructions: bool,

    /// Measure processor time instead of wall-clock time for work on one thread: for shared
    /// machines
    #[arg(long)]
    pub processor_time: bool,

    /// Run one candidate of the exemplar once, under a tool that counts instructions
    #[arg(long, value_name = "CANDIDATE", hide = true)]
    pub once: Option<String>,

    /// Threads of the candidates that use all cores
    #[arg(skip)]
    pub threads: Option<NonZeroUsize>,
}

impl Arguments {
    /// The effort of each measurement.
    pub(crate) fn effort(&self) -> Effort {
        match (&self.once, self.quick) {
            (Some(candidate), _) => Effort::Once { candidate: candidate.clone() },
            (None, true) => Effort::QUICK.by(self.clock()),
            (None, false) => Effort::FULL.by(self.clock()),
        }
    }

    /// The clock of the measurements.
    pub(crate) fn clock(&self) -> Clock {
        if self.processor_time { Clock::Processor } else { Clock::Wall }
    }

    /// True if the options select the exemplar of this name.
    pub(crate) fn wants(&self, name: &str) -> bool {
        self.only.is_empty() || self.only.iter().any(|start| name.starts_with(start.as_str()))
    }

    /// The number of threads of multi-threaded candidates.
    pub(crate) fn thread_count(&self) -> usize {
        thread_count(self.threads).get()
    }

    /// The path of the plot: the given one, or one in the folder of the page.
    pub(crate) fn plot(&self) -> Option<PathBuf> {
        let beside = || self.markdown.as_ref().map(|page| page.with_extension("svg"));
        self.plot.clone().or_else(beside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exemplars_are_chosen_by_their_beginning() {
        let arguments = Arguments { only: vec!["die/f".to_owned()], ..Arguments::default() };
        assert!(arguments.wants("die/full") && !arguments.wants("die/single"));
        assert!(Arguments::default().wants("anything"));
    }

    #[test]
    fn the_plot_lies_beside_the_page() {
        let arguments = Arguments { markdown: Some("docs/page.md".into()), ..Arguments::default() };
        assert_eq!(arguments.plot(), Some("docs/page.svg".into()));
        assert_eq!(Arguments::default().plot(), None);
    }
}
