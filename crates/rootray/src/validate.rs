//! Validation of lists of root times.

use crate::{Problem, min_sep};

/// All problems of a list of root times, in order: NaN, infinities, times not strictly increasing, and neighbours closer than
/// [`min_sep`]. A time is compared with the last number before it; a pair is reported as out of order or as too close, never
/// as both.
pub fn validate_times(times: impl IntoIterator<Item = f64>) -> Vec<Problem> {
    let mut previous = None;
    let mut problems = Vec::new();
    for (index, t) in times.into_iter().enumerate() {
        problems.extend(value_problem(index, t));
        if !t.is_nan() {
            problems.extend(previous.and_then(|previous| pair_problem(index, previous, t)));
            previous = Some(t);
        }
    }
    problems
}

/// The problem of a single time.
fn value_problem(index: usize, t: f64) -> Option<Problem> {
    if t.is_nan() {
        Some(Problem::Nan { index })
    } else if t.is_infinite() {
        Some(Problem::Infinite { index, t })
    } else {
        None
    }
}

/// The problem of two neighbours, neither of them NaN.
fn pair_problem(index: usize, previous: f64, t: f64) -> Option<Problem> {
    if t <= previous {
        return Some(Problem::NotIncreasing { index, previous, t });
    }
    let finite = previous.is_finite() && t.is_finite();
    let min_sep = min_sep(previous, t);
    (finite && t - previous < min_sep).then_some(Problem::TooClose { index, previous, t, min_sep })
}
