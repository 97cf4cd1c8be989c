//! Ceilings of the machine: memory bandwidth and arithmetic throughput, measured before the
//! exemplars.

mod arithmetic;
mod copy;

use crate::interleaved::{Effort, Outcome, Role, measure_in_turn};
use crate::level;
use crate::statistics::Statistics;
use fearless_simd::Level;

/// The measured ceilings.
#[derive(Clone, Debug)]
pub struct Ceilings {
    /// Bytes read plus bytes written per nanosecond in a copy of arrays larger than all caches: by
    /// one thread and by all.
    pub copy: [Statistics; 2],
    /// Arithmetic in registers and in the L1 cache, by SIMD level.
    pub levels: Vec<Rates>,
    /// The number of threads of the multi-threaded copy.
    pub threads: usize,
}

/// Operations on 64-bit numbers per nanosecond, on one thread.
#[derive(Clone, Debug)]
pub struct Rates {
    /// The level.
    pub level: Level,
    /// Fused multiply-adds, counted as two operations each. (No kernel uses them, because their
    /// rounding differs.)
    pub fused: Statistics,
    /// Additions and multiplications, half of each.
    pub simple: Statistics,
    /// Minima and maxima.
    pub extremes: Statistics,
    /// Divisions.
    pub divisions: Statistics,
    /// Square roots.
    pub roots: Statistics,
}

/// A lower bound of the cost of one item.
#[derive(Clone, Copy, Debug)]
pub enum Need {
    /// Bytes read from or written to memory.
    Bytes(f64),
    /// Operations on 64-bit numbers.
    Operations {
        /// Additions, multiplications and similar operations.
        simple: f64,
        /// Divisions.
        divisions: f64,
        /// Square roots.
        roots: f64,
        /// The SIMD level of the operations; the widest by default.
        level: Option<Level>,
    },
    /// The time of a hand-written kernel for the same work on one thread, in nanoseconds.
    Kernel(f64),
}

/// The minimum time, and the resource that limits it.
#[derive(Clone, Debug, PartialEq)]
pub struct Floor {
    /// The limiting resource.
    pub what: &'static str,
    /// Nanoseconds per item.
    pub time: f64,
}

impl Ceilings {
    /// Measures the ceilings.
    pub fn measure(levels: &[Level], threads: usize, effort: &Effort) -> Result<Ceilings, String> {
        let [one, all] = copy::measure(threads, effort)?;
        let levels = levels.iter().map(|&level| arithmetic::measure(level, effort));
        Ok(Ceilings { copy: [one, all], levels: levels.collect::<Result<_, _>>()?, threads })
    }

    /// The maximum of the minimum times of the resources of one item, on `threads` threads.
    pub fn floor(&self, needs: &[Need], threads: usize) -> Option<Floor> {
        let floors = needs.iter().filter_map(|need| self.floor_of(*need, threads));
        floors.max_by(|a, b| a.time.total_cmp(&b.time))
    }

    fn floor_of(&self, need: Need, threads: usize) -> Option<Floor> {
        let scale = threads as f64;
        Some(match need {
            Need::Bytes(bytes) => {
                let copy = &self.copy[usize::from(threads > 1)];
                Floor { what: "memory", time: bytes / copy.median }
            }
            Need::Operations { simple, divisions, roots, level } => {
                let rates = self.rates(level)?;
                let divider = divisions / rates.divisions.median + roots / rates.roots.median;
                let adder = simple / rates.simple.median;
                match divider > adder {
                    true => Floor { what: "divider", time: divider / scale },
                    false => Floor { what: "arithmetic", time: adder / scale },
                }
            }
            Need::Kernel(time) => Floor { what: "kernel by hand", time: time / scale },
        })
    }

    /// The rates of a level, or of the widest.
    fn rates(&self, level: Option<Level>) -> Option<&Rates> {
        let wanted = level.map(level::name);
        let mut levels = self.levels.iter().rev();
        levels.find(|rates| wanted.is_none() || wanted == Some(level::name(rates.level)))
    }

    /// The ceilings as rows: name, unit, figure.
    pub fn rows(&self) -> Vec<(String, &'static str, Statistics)> {
        let mut rows = vec![
            ("copy, 1 thread".to_owned(), "GB/s", self.copy[0]),
            (format!("copy, {} threads", self.threads), "GB/s", self.copy[1]),
        ];
        for rates in &self.levels {
            let name = level::name(rates.level);
            let kinds = [
                ("fused multiply-add", rates.fused),
                ("multiply and add", rates.simple),
                ("minimum and maximum", rates.extremes),
                ("divide", rates.divisions),
                ("square root", rates.roots),
            ];
            rows.extend(kinds.map(|(kind, rate)| (format!("{kind}, {name}"), "G/s", rate)));
        }
        rows
    }
}

/// The rates of candidates, in the given order: items per nanosecond.
fn rates<const N: usize>(outcomes: Vec<Outcome>) -> Result<[Statistics; N], String> {
    let rates: Result<Vec<Statistics>, String> =
        outcomes.into_iter().map(|outcome| Ok(outcome.times?.map(|time| 1.0 / time))).collect();
    rates?.try_into().map_err(|rates: Vec<Statistics>| format!("{} ceilings instead of {N}", rates.len()))
}

/// A candidate for the ceiling.
fn ceiling<'a>(name: &str, items: usize, run: impl FnMut() + 'a) -> crate::interleaved::Candidate<'a> {
    crate::interleaved::Candidate::here(name, Role::Ceiling, items, run)
}

/// Measures candidates for ceilings.
fn measure_rates<const N: usize>(
    candidates: Vec<crate::interleaved::Candidate<'_>>,
    effort: &Effort,
) -> Result<[Statistics; N], String> {
    rates(measure_in_turn(candidates, effort))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ceilings_are_positive_and_bind() {
        let ceilings = Ceilings::measure(&level::available(None), 2, &Effort::QUICK).unwrap();
        assert!(ceilings.rows().iter().all(|(_, _, figure)| figure.range[0] > 0.0));
        let needs = [Need::Bytes(64.0), Need::Kernel(1e9)];
        let floor = ceilings.floor(&needs, 2).unwrap();
        assert_eq!(floor, Floor { what: "kernel by hand", time: 5e8 });
        let memory = ceilings.floor(&needs[..1], 1).unwrap();
        assert_eq!(memory.time, 64.0 / ceilings.copy[0].median);
        let work = Need::Operations { simple: 1.0, divisions: 100.0, roots: 0.0, level: None };
        assert_eq!(ceilings.floor(&[work], 1).unwrap().what, "divider");
    }
}
