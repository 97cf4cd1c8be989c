//! The benchmark: named exemplars, peers and the ceilings of the machine side by side in one run.
//!
//! ```sh
//! cargo run --release -p rayweave-bench -- --peers DIR --markdown docs/performance.md
//! ```
//!
//! A run has these steps: `ceiling` measures the limits of the machine. Each `exemplar` gives the
//! same work to several candidates: evaluators of this project, `peers` and the hand-written
//! kernels of `kernel`. `interleaved` runs them in turn, and `answer` compares their results, so that a
//! ratio of times refers to the same work. `report` writes the results.
//!
//! The tests time nothing: they verify statistics, tables and kernels.

mod answer;
mod arguments;
mod batch;
mod ceiling;
mod clock;
mod exemplar;
mod instructions;
mod interleaved;
mod kernel;
mod level;
mod machine;
mod peers;
mod report;
mod run;
mod statistics;

pub use arguments::Arguments;
pub use run::run;
