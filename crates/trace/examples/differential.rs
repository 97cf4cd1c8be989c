//! Differential test: all evaluators against the reference on the same random rays, bit for bit.
//!
//! `cargo run --release -p rayweave-trace --example differential -- FROM TO`: the models of the seeds FROM..TO, a
//! thousand rays each (0 100000 are 1e8 rays). A seed always gives the same model and rays, so a run may be
//! split anywhere; every chunk prints a line of progress. Without numbers a few models are traced. Exits with
//! 1 if any answer differs.

use rayweave_conformance::differential::{Score, compare};
use rayweave_conformance::{Maker, maker};
use rayweave_trace::{Packets, Reference, SingleHit, Spans, Weave};
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// Number of seeds that a thread takes at a time.
const CHUNK: u64 = 100;

fn evaluators() -> Vec<Maker> {
    vec![
        maker(Packets::new),
        maker(Weave::new),
        maker(|program| SingleHit::new(program).expect("no model of the suite is too large")),
        maker(Spans::new),
    ]
}

fn report(what: &str, scores: &[Score], started: Instant) {
    let one = |s: &Score| {
        format!(
            "{}: {} rays, {} answers, {} crossings, {} wrong",
            s.name, s.rays, s.answers, s.crossings, s.wrong
        )
    };
    let all: Vec<String> = scores.iter().map(one).collect();
    println!("{what} ({:.0} s): {}", started.elapsed().as_secs_f64(), all.join("; "));
}

fn run(from: u64, to: u64) -> Vec<Score> {
    let (next, sums) = (AtomicU64::new(from), Mutex::new(Vec::new()));
    let started = Instant::now();
    let work = || {
        let (reference, others) = (maker(Reference::new), evaluators());
        loop {
            let first = next.fetch_add(CHUNK, Ordering::Relaxed);
            if first >= to {
                return;
            }
            let last = to.min(first + CHUNK);
            let scores = compare(&reference, &others, first..last);
            let mut sums = sums.lock().unwrap_or_else(PoisonError::into_inner);
            report(&format!("seeds {first}..{last}"), &scores, started);
            Score::add_all(&mut sums, scores);
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
    let sums = sums.into_inner().unwrap_or_else(PoisonError::into_inner);
    report(&format!("all seeds {from}..{to}"), &sums, started);
    sums
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Vec<Option<u64>> = arguments.iter().map(|a| a.parse().ok()).collect();
    let (from, to) = match numbers[..] {
        [] => (0, 8),
        [Some(from), Some(to)] => (from, to),
        _ => {
            eprintln!("differential [FROM TO]");
            return ExitCode::from(2);
        }
    };
    let scores = run(from, to);
    scores.iter().flat_map(|s| &s.messages).for_each(|message| println!("---\n{message}"));
    ExitCode::from(u8::from(scores.iter().any(|s| s.wrong > 0)))
}
