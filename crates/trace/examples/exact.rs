//! All evaluators against the exact oracle.
//!
//! `cargo run --release -p rayweave-trace --example exact -- transversal|planted|meshes|turned|points FROM TO`: the
//! models of the seeds FROM..TO, fifty rays each (0 200000 are 1e7 rays). A seed always gives the same model
//! and rays. Prints the counts and each wrong model, minimised; exits with 1 if there is one.

use rayweave_conformance::exact::{self, Count};
use rayweave_conformance::{Maker, maker};
use rayweave_trace::{Packets, Reference, SingleHit, Spans, Weave};
use std::ops::Range;
use std::process::ExitCode;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Number of seeds that a thread takes at a time.
const CHUNK: u64 = 100;

type Suite = fn(&[Maker], Range<u64>) -> Count;

fn evaluators() -> Vec<Maker> {
    vec![
        maker(Packets::new),
        maker(Weave::new),
        maker(Reference::new),
        maker(|program| SingleHit::new(program).expect("no model of the suite is too large")),
        maker(Spans::new),
    ]
}

fn run(suite: Suite, from: u64, to: u64) -> Count {
    let (next, sum) = (AtomicU64::new(from), Mutex::new(Count::default()));
    let work = || {
        let evaluators = evaluators();
        loop {
            let first = next.fetch_add(CHUNK, Ordering::Relaxed);
            if first >= to {
                return;
            }
            let count = suite(&evaluators, first..to.min(first + CHUNK));
            count.messages.iter().for_each(|(seed, what)| println!("seed {seed}: {what}\n---"));
            sum.lock().unwrap_or_else(PoisonError::into_inner).add(Count { messages: Vec::new(), ..count });
        }
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
    sum.into_inner().unwrap_or_else(PoisonError::into_inner)
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let (suite, from, to): (Suite, _, _) = match words[..] {
        [] => (exact::planted, "0", "20"),
        ["transversal", from, to] => (exact::transversal, from, to),
        ["planted", from, to] => (exact::planted, from, to),
        ["meshes", from, to] => (exact::meshes, from, to),
        ["turned", from, to] => (exact::turned, from, to),
        ["points", from, to] => (exact::points, from, to),
        _ => return usage(),
    };
    let (Ok(from), Ok(to)) = (from.parse(), to.parse()) else { return usage() };
    let count = run(suite, from, to);
    println!("{}, seeds {from}..{to}: {count:?}", words.first().unwrap_or(&"planted"));
    ExitCode::from(u8::from(count.wrong > 0))
}

fn usage() -> ExitCode {
    eprintln!("exact [transversal|planted|meshes|turned|points FROM TO]");
    ExitCode::from(2)
}
