//! Interleaved measurement: candidates do the same work in turn, round by round, so that changes of
//! the machine's speed affect all of them.

use crate::clock::Clock;
use crate::statistics::Statistics;
use std::hint::black_box;

/// The role of a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// This project.
    Ours,
    /// Another system.
    Peer,
    /// Ceilings of the machine.
    Ceiling,
}

impl Role {
    /// The name in results.
    pub fn name(self) -> &'static str {
        match self {
            Role::Ours => "ours",
            Role::Peer => "peer",
            Role::Ceiling => "ceiling",
        }
    }
}

/// The effort of a measurement.
#[derive(Clone, Debug, PartialEq)]
pub enum Effort {
    /// Rounds, in each of which every candidate runs for about `seconds` seconds.
    Rounds {
        /// Number of rounds.
        rounds: usize,
        /// The time of one run.
        seconds: f64,
        /// Models and batches are smaller by this factor.
        shrink: usize,
        /// The clock.
        clock: Clock,
    },
    /// One candidate runs once, for a tool that counts instructions: see [`counted`].
    Once {
        /// Its name.
        candidate: String,
    },
}

impl Effort {
    /// For published figures.
    pub const FULL: Effort = Effort::Rounds { rounds: 11, seconds: 0.1, shrink: 1, clock: Clock::Wall };
    /// For a smoke test.
    pub const QUICK: Effort = Effort::Rounds { rounds: 3, seconds: 0.005, shrink: 16, clock: Clock::Wall };

    /// The size of a batch that is `full` at full effort: a multiple of 64.
    pub fn size(&self, full: usize) -> usize {
        let shrink = match self {
            Effort::Rounds { shrink, .. } => *shrink,
            Effort::Once { .. } => 32,
        };
        (full / shrink / 64).max(1) * 64
    }

    /// The same effort with a different clock.
    pub fn by(self, clock: Clock) -> Effort {
        match self {
            Effort::Rounds { rounds, seconds, shrink, .. } => {
                Effort::Rounds { rounds, seconds, shrink, clock }
            }
            once => once,
        }
    }
}

/// A candidate: a repeatable piece of work.
pub struct Candidate<'a> {
    /// Name in tables.
    pub name: String,
    /// Its role.
    pub role: Role,
    /// The number of threads.
    pub threads: usize,
    /// The number of items, such as rays, in one run.
    items: f64,
    /// The minimum number of items in one run.
    least: f64,
    work: Work<'a>,
}

/// The work of a candidate.
enum Work<'a> {
    /// Runs and times the work in this process, `repeats` times in a row.
    Here { repeats: usize, run: Box<dyn FnMut() + 'a> },
    /// Runs elsewhere, and returns the seconds for a number of items.
    Elsewhere(Box<dyn FnMut(f64) -> Result<f64, String> + 'a>),
}

impl<'a> Candidate<'a> {
    /// A candidate whose work is a function of this process; `items` is the number of items of one
    /// call.
    pub fn here(name: impl Into<String>, role: Role, items: usize, run: impl FnMut() + 'a) -> Candidate<'a> {
        let work = Work::Here { repeats: 1, run: Box::new(run) };
        let items = items as f64;
        Candidate { name: name.into(), role, threads: 1, items, least: items, work }
    }

    /// A candidate in another process: it receives the number of items, at most `most`, and reports the seconds.
    pub fn elsewhere(
        name: impl Into<String>,
        most: usize,
        run: impl FnMut(f64) -> Result<f64, String> + 'a,
    ) -> Candidate<'a> {
        let work = Work::Elsewhere(Box::new(run));
        let items = most as f64;
        Candidate { name: name.into(), role: Role::Peer, threads: 1, items, least: 1.0, work }
    }

    /// Sets the number of threads.
    pub fn threads(self, threads: usize) -> Candidate<'a> {
        Candidate { threads, ..self }
    }

    /// Sets the role.
    pub fn role(self, role: Role) -> Candidate<'a> {
        Candidate { role, ..self }
    }

    /// Makes every run process all items.
    pub fn whole(self) -> Candidate<'a> {
        Candidate { least: self.items, ..self }
    }

    /// Warms up, and determines the number of repetitions or items for a run of about `seconds`.
    fn prepare(&mut self, seconds: f64, clock: Clock) -> Result<(), String> {
        let items = self.items;
        let clock = clock.on(self.threads);
        match &mut self.work {
            Work::Here { repeats, run } => {
                let once = clock.time(run).max(1e-9);
                *repeats = (seconds / once).ceil().clamp(1.0, 1e7) as usize;
            }
            Work::Elsewhere(run) => {
                let few = items.min(1000.0);
                run(few)?;
                let took = run(few)?.max(1e-9);
                self.items = (few * seconds / took).clamp(few.max(self.least), items).floor();
            }
        }
        Ok(())
    }

    /// Executes one run; returns nanoseconds per item.
    fn run(&mut self, clock: Clock) -> Result<f64, String> {
        let items = self.items;
        let clock = clock.on(self.threads);
        let seconds = match &mut self.work {
            Work::Here { repeats, run } => {
                let repeats = *repeats;
                clock.time(|| (0..repeats).for_each(|_| run())) / repeats as f64
            }
            Work::Elsewhere(run) => run(items)?,
        };
        Ok(1e9 * seconds / items)
    }
}

/// Runs a function once. Tools that count instructions collect only inside this function.
#[inline(never)]
pub fn counted(run: &mut dyn FnMut()) {
    run();
    // the call must not be a tail call, which would remove this frame
    black_box(());
}

/// Result of one candidate.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Its name.
    pub name: String,
    /// Its role.
    pub role: Role,
    /// The number of threads.
    pub threads: usize,
    /// Nanoseconds per item, or the reason why there are none.
    pub times: Result<Statistics, String>,
}

/// Measures the candidates in turn.
pub fn measure_in_turn(mut candidates: Vec<Candidate<'_>>, effort: &Effort) -> Vec<Outcome> {
    let (rounds, seconds, clock) = match effort {
        Effort::Rounds { rounds, seconds, clock, .. } => (*rounds, *seconds, *clock),
        Effort::Once { candidate } => {
            count(&mut candidates, candidate);
            return Vec::new();
        }
    };
    let prepare = |candidate: &mut Candidate<'_>| candidate.prepare(seconds, clock).map(|()| Vec::new());
    let mut states: Vec<Result<Vec<f64>, String>> = candidates.iter_mut().map(prepare).collect();
    for round in 0..rounds {
        // rotate the order, so that each candidate follows a different one in the next round
        let count = candidates.len();
        for i in (0..count).map(|i| (i + round) % count) {
            if let Ok(times) = &mut states[i] {
                match candidates[i].run(clock) {
                    Ok(time) => times.push(time),
                    Err(problem) => states[i] = Err(problem),
                }
            }
        }
    }
    candidates.into_iter().zip(states).map(|(candidate, state)| outcome(candidate, state)).collect()
}

fn outcome(candidate: Candidate<'_>, state: Result<Vec<f64>, String>) -> Outcome {
    let Candidate { name, role, threads, .. } = candidate;
    let times =
        state.and_then(|times| Statistics::of(&times).ok_or_else(|| "no time was measured".to_owned()));
    Outcome { name, role, threads, times }
}

/// Runs the candidate of this name once, if it runs in this process, and prints the number of
/// items.
fn count(candidates: &mut [Candidate<'_>], name: &str) {
    for candidate in candidates {
        if let Work::Here { run, .. } = &mut candidate.work
            && candidate.name == name
        {
            // a first call for lazy initialisation and allocation, which is not counted
            run();
            counted(run);
            println!("items {}", candidate.items);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;

    #[test]
    fn candidates_take_turns() {
        let recorded = RefCell::new(Vec::new());
        let calls = &recorded;
        let one = |name: &'static str| {
            Candidate::elsewhere(name, 5000, move |items| {
                calls.borrow_mut().push(name);
                Ok(items * 1e-9 * name.len() as f64)
            })
        };
        let effort = Effort::Rounds { rounds: 3, seconds: 1e-6, shrink: 1, clock: Clock::Wall };
        let outcomes = measure_in_turn(vec![one("a"), one("bb")], &effort);
        let medians: Vec<f64> =
            outcomes.iter().map(|outcome| outcome.times.as_ref().unwrap().median.round()).collect();
        assert_eq!(medians, [1.0, 2.0]);
        assert_eq!(recorded.into_inner(), ["a", "a", "bb", "bb", "a", "bb", "bb", "a", "a", "bb"]);
    }

    #[test]
    fn who_fails_is_out_and_says_why() {
        let mut left = 3;
        let frail = Candidate::elsewhere("frail", 10, |_| {
            left -= 1;
            if left < 0 { Err("tired".to_owned()) } else { Ok(1.0) }
        });
        let steady = Candidate::here("steady", Role::Ours, 1, || {});
        let outcomes = measure_in_turn(vec![frail, steady], &Effort::QUICK);
        assert_eq!(outcomes[0].times, Err("tired".to_owned()));
        assert!(outcomes[1].times.as_ref().is_ok_and(|times| times.count == 3));
    }

    #[test]
    fn sizes_shrink_to_whole_blocks() {
        assert_eq!((Effort::FULL.size(1 << 20), Effort::QUICK.size(1 << 20)), (1 << 20, 1 << 16));
        assert_eq!(Effort::QUICK.size(100), 64);
    }
}
