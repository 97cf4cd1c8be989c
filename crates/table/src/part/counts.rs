//! Counts of a part of a run, which add up to those of the whole.

use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// A number of things, or numbers by name: of photons by way of ending, say.
///
/// ```
/// use rayweave_table::Counts;
///
/// let mut ends = Counts::group([("absorbed", Counts::Number(3))]);
/// ends.add(&Counts::group([("absorbed", Counts::Number(2)), ("escaped", Counts::Number(1))]));
/// let sums = Counts::group([("absorbed", Counts::Number(5)), ("escaped", Counts::Number(1))]);
/// assert_eq!(ends, sums);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Counts {
    /// A number.
    Number(u64),
    /// Counts by name.
    Group(BTreeMap<String, Counts>),
}

impl Counts {
    /// Counts by name.
    pub fn group<N: Into<String>>(counts: impl IntoIterator<Item = (N, Counts)>) -> Counts {
        Counts::Group(counts.into_iter().map(|(name, counts)| (name.into(), counts)).collect())
    }

    /// The counts with this name, if there are any.
    pub fn get(&self, name: &str) -> Option<&Counts> {
        match self {
            Counts::Number(_) => None,
            Counts::Group(counts) => counts.get(name),
        }
    }

    /// The number, if it is one.
    pub fn number(&self) -> Option<u64> {
        match self {
            Counts::Number(number) => Some(*number),
            Counts::Group(_) => None,
        }
    }

    /// Adds other counts. A name that only one of the two has keeps its counts, and a number beside a group is lost.
    pub fn add(&mut self, other: &Counts) {
        match (self, other) {
            (Counts::Number(sum), Counts::Number(number)) => *sum = sum.saturating_add(*number),
            (Counts::Group(sums), Counts::Group(counts)) => {
                for (name, count) in counts {
                    match sums.get_mut(name) {
                        Some(sum) => sum.add(count),
                        None => drop(sums.insert(name.clone(), count.clone())),
                    }
                }
            }
            _ => {}
        }
    }

    /// The counts as JSON: a number or an object.
    pub fn to_json(&self) -> Value {
        match self {
            Counts::Number(number) => (*number).into(),
            Counts::Group(counts) => counts
                .iter()
                .map(|(name, counts)| (name.clone(), counts.to_json()))
                .collect::<Map<_, _>>()
                .into(),
        }
    }

    /// The counts from JSON; `None` if a value is neither a whole number from 0 nor an object.
    pub fn from_json(value: &Value) -> Option<Counts> {
        if let Some(number) = value.as_u64() {
            return Some(Counts::Number(number));
        }
        let counts =
            value.as_object()?.iter().map(|(name, value)| Some((name.clone(), Counts::from_json(value)?)));
        Some(Counts::Group(counts.collect::<Option<_>>()?))
    }
}
