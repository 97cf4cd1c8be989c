//! Independent searches of a check, which may run anywhere: their results by number, as text.

use crate::measure::MeasuredChord;
use rayweave_math::Vec3;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::ops::Range;

/// The first line of the text of a share.
const HEADER: &str = "rayweave check share 1";

/// The thickest place of a solid along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Thickest {
    pub thickness: f64,
    pub chord: MeasuredChord,
}

/// The result of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Outcome {
    /// No ray found anything.
    Nothing,
    /// There is nothing, as boxes prove.
    ProvedEmpty,
    /// The thickest place.
    Found(Thickest),
}

impl From<Option<Thickest>> for Outcome {
    fn from(met: Option<Thickest>) -> Outcome {
        met.map_or(Outcome::Nothing, Outcome::Found)
    }
}

/// The searches that a run performs.
pub(super) enum Work<'a> {
    /// All.
    All,
    /// Those with these numbers, with their results so far.
    Range(Range<u64>, CheckShare),
    /// Those without a known result.
    Known(&'a CheckShare),
}

/// Results of searches by their numbers, with the number of rays of each.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CheckShare {
    outcomes: BTreeMap<u64, (u64, Outcome)>,
}

impl CheckShare {
    pub(super) fn get(&self, number: u64) -> Option<(u64, Outcome)> {
        self.outcomes.get(&number).copied()
    }

    pub(super) fn add(&mut self, number: u64, rays: u64, outcome: Outcome) {
        self.outcomes.insert(number, (rays, outcome));
    }

    /// The number of results.
    pub fn len(&self) -> usize {
        self.outcomes.len()
    }

    /// True if there are no results.
    pub fn is_empty(&self) -> bool {
        self.outcomes.is_empty()
    }

    /// Adds the results of another range of searches of the same check.
    pub fn append(&mut self, other: CheckShare) {
        self.outcomes.extend(other.outcomes);
    }

    /// The results as a text with a line for each search. It does not depend on the order in which they were added.
    pub fn to_text(&self) -> String {
        let mut text = format!("{HEADER}\n");
        for (number, (rays, outcome)) in &self.outcomes {
            // writing to a text cannot fail
            let _ = write!(text, "{number} {rays}");
            match outcome {
                Outcome::Nothing => text.push_str(" nothing"),
                Outcome::ProvedEmpty => text.push_str(" empty"),
                Outcome::Found(Thickest { thickness, chord }) => {
                    let ends = chord.from.to_array().into_iter().chain(chord.to.to_array());
                    for x in [*thickness].into_iter().chain(ends) {
                        let _ = write!(text, " {x:?}");
                    }
                }
            }
            text.push('\n');
        }
        text
    }

    /// Reads the text of [`to_text`](Self::to_text); `None` if it is damaged.
    pub fn from_text(text: &str) -> Option<CheckShare> {
        let mut lines = text.lines();
        if lines.next()? != HEADER {
            return None;
        }
        let mut share = CheckShare::default();
        for line in lines {
            let words: Vec<&str> = line.split(' ').collect();
            let (number, rays, outcome) = match words.as_slice() {
                [number, rays, "nothing"] => (number, rays, Outcome::Nothing),
                [number, rays, "empty"] => (number, rays, Outcome::ProvedEmpty),
                [number, rays, numbers @ ..] => {
                    let numbers: Vec<f64> = numbers.iter().map(|x| x.parse().ok()).collect::<Option<_>>()?;
                    let [thickness, a, b, c, d, e, f] = numbers[..] else { return None };
                    let chord = MeasuredChord { from: Vec3::new(a, b, c), to: Vec3::new(d, e, f) };
                    (number, rays, Outcome::Found(Thickest { thickness, chord }))
                }
                _ => return None,
            };
            share.add(number.parse().ok()?, rays.parse().ok()?, outcome);
        }
        Some(share)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_read_back() {
        let mut share = CheckShare::default();
        let chord = MeasuredChord { from: Vec3::new(0.1, -2.0, 1e-300), to: Vec3::new(1.0 / 3.0, 5.0, 6.0) };
        share.add(7, 600, Outcome::Found(Thickest { thickness: 0.7, chord }));
        share.add(3, 0, Outcome::ProvedEmpty);
        let mut other = CheckShare::default();
        other.add(5, 600, Outcome::Nothing);
        share.append(other);
        assert_eq!(CheckShare::from_text(&share.to_text()), Some(share.clone()));
        assert!(share.to_text().lines().nth(2).unwrap().starts_with("5 600 nothing"));
        for damaged in ["", "x\n", "rayweave check share 1\n1 2\n", "rayweave check share 1\n1 2 3 4\n"] {
            assert_eq!(CheckShare::from_text(damaged), None, "{damaged}");
        }
    }
}
