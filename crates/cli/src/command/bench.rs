//! `rayweave bench`: benchmarks, compared with other programs and with the limits of the machine.

use crate::arguments::GlobalArguments;
use crate::failure::Failure;
use clap::Args;
use rayweave_bench::{Arguments, run};

/// Run benchmarks and compare them with other programs and with the limits of this machine
///
/// First the bandwidth and the arithmetic throughput of the machine are measured. Then the
/// evaluators, hand-written kernels and the other programs that are installed run each exemplar in
/// turn. Tables go to standard output.
#[derive(Args)]
#[command(after_help = "\
Examples:
  rayweave bench --list
  rayweave bench --only die
  rayweave bench --peers peers --markdown performance.md --json performance.json")]
pub struct Bench {
    #[command(flatten)]
    arguments: Arguments,
}

impl Bench {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let arguments = Arguments { threads: global.threads, ..self.arguments.clone() };
        run(&arguments).map_err(Failure::Run)
    }
}
