//! The command line program `rayweave-bench`.

use clap::Parser;
use mimalloc::MiMalloc;
use rayweave_bench::{Arguments, run};
use std::process::ExitCode;

#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// Measure exemplars, and compare them with peers and with the ceilings of the machine.
#[derive(Parser)]
#[command(name = "rayweave-bench", version, max_term_width = 100)]
struct Command {
    #[command(flatten)]
    arguments: Arguments,
}

fn main() -> ExitCode {
    match run(&Command::parse().arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(problem) => {
            eprintln!("rayweave-bench: {problem}");
            ExitCode::FAILURE
        }
    }
}
