//! The benchmark: named exemplars, peers and the ceilings of the machine side by side in one run.
//!
//! ```sh
//! cargo run --release -p rayweave-bench -- --peers DIR --markdown docs/performance.md
//! ```
//!
//! The way of a run: `ceiling` measures what the machine can do at most; each `exemplar` sets contenders to the same
//! work, evaluators of this project, `peers` and kernels by `kernel` hand, and `contest` lets them run in turn;
//! `answer` compares what they answer, so that a ratio of times is one for the same work; `report` writes it down.
//!
//! Nothing in the tests is timed: they check that statistics, tables and kernels are right.

mod answer;
mod arguments;
mod batch;
mod ceiling;
mod clock;
mod contest;
mod exemplar;
mod instructions;
mod kernel;
mod level;
mod machine;
mod peers;
mod report;
mod run;
mod statistics;

pub use arguments::Arguments;
pub use run::run;
