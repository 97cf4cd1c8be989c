//! The parts of one result.

use super::{Counts, Part};
use crate::TableError;
use rayweave_error::Message;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Parts of one result, in the order of their ranges.
#[derive(Clone, Debug)]
pub struct PartSet {
    parts: Vec<(PathBuf, Part)>,
}

impl PartSet {
    /// Reads the descriptions of files and verifies their contents.
    ///
    /// # Errors
    ///
    /// [`TableError::Table`] for no file at all, a file that is not a part or is damaged, parts of different queries, models, seeds or
    /// other settings, and ranges that overlap. The message names the files.
    pub fn read(files: &[PathBuf]) -> Result<PartSet, TableError> {
        let parts = files.iter().map(|file| Ok((file.clone(), Part::read(file)?)));
        PartSet::of(parts.collect::<Result<_, TableError>>()?)
    }

    /// Like [`read`](Self::read), but leaves out files that are absent, not parts, or damaged; their errors are the second result.
    ///
    /// # Errors
    ///
    /// [`TableError::Table`] for parts of different results and ranges that overlap.
    pub fn read_complete(files: &[PathBuf]) -> Result<(PartSet, Vec<TableError>), TableError> {
        let (mut parts, mut errors) = (Vec::new(), Vec::new());
        for file in files {
            match Part::read(file) {
                Ok(part) => parts.push((file.clone(), part)),
                Err(error) => errors.push(error),
            }
        }
        match parts.is_empty() {
            true => Ok((PartSet { parts }, errors)),
            false => Ok((PartSet::of(parts)?, errors)),
        }
    }

    fn of(mut parts: Vec<(PathBuf, Part)>) -> Result<PartSet, TableError> {
        let Some((first, rest)) = parts.split_first() else {
            let message = Message::new("there are no parts", "a merge needs at least one");
            return Err(TableError::Parts(message));
        };
        rest.iter().try_for_each(|other| same_whole(first, other))?;
        parts.sort_by_key(|(_, part)| (part.range.start, part.range.end));
        let ranged = parts.iter().filter(|(_, part)| !part.range.is_empty());
        ranged.clone().zip(ranged.skip(1)).try_for_each(|(a, b)| disjoint(a, b))?;
        Ok(PartSet { parts })
    }

    /// The files with their descriptions, in the order of their ranges.
    pub fn parts(&self) -> impl ExactSizeIterator<Item = (&Path, &Part)> {
        self.parts.iter().map(|(path, part)| (path.as_path(), part))
    }

    /// The first part: all others have the same query, settings and total. `None` if there are no parts.
    pub fn first(&self) -> Option<&Part> {
        self.parts.first().map(|(_, part)| part)
    }

    /// The sums of the counts of all parts, of those names that all parts have; `None` if a part has no counts.
    pub fn counts(&self) -> Option<Counts> {
        let parts: Vec<&Counts> =
            self.parts.iter().map(|(_, part)| part.counts.as_ref()).collect::<Option<_>>()?;
        let (first, rest) = parts.split_first()?;
        let mut sums = (*first).clone();
        rest.iter().for_each(|counts| sums.add(counts));
        if let Counts::Group(sums) = &mut sums {
            sums.retain(|name, _| parts.iter().all(|counts| counts.get(name).is_some()));
        }
        Some(sums)
    }

    /// The ranges of `0..total` that no part covers.
    pub fn missing(&self, total: u64) -> Vec<Range<u64>> {
        missing_ranges(self.parts.iter().map(|(_, part)| part.range.clone()), total)
    }

    /// Checks that the parts cover the whole.
    ///
    /// # Errors
    ///
    /// [`TableError::Parts`], which names the missing ranges.
    pub fn check_whole(&self) -> Result<(), TableError> {
        let total = self.first().map_or(0, |part| part.total);
        let missing: Vec<String> =
            self.missing(total).iter().map(|range| format!("{}:{}", range.start, range.end)).collect();
        if missing.is_empty() {
            return Ok(());
        }
        let reason = format!("the ranges {} of {total} are missing", missing.join(", "));
        Err(TableError::Parts(
            Message::new("the parts are not the whole", reason).suggest("Compute the missing ranges"),
        ))
    }
}

/// The ranges of `0..total` that none of `ranges`, in order of their starts, covers.
///
/// ```
/// assert_eq!(rayweave_table::missing_ranges([2..5, 5..6, 8..9], 10), [0..2, 6..8, 9..10]);
/// ```
pub fn missing_ranges(ranges: impl IntoIterator<Item = Range<u64>>, total: u64) -> Vec<Range<u64>> {
    let (mut missing, mut next) = (Vec::new(), 0);
    for range in ranges.into_iter().filter(|range| !range.is_empty()).chain(std::iter::once(total..total)) {
        if next < range.start.min(total) {
            missing.push(next..range.start.min(total));
        }
        next = next.max(range.end);
    }
    missing
}

/// Checks that two parts belong to the same whole.
fn same_whole((a, first): &(PathBuf, Part), (b, other): &(PathBuf, Part)) -> Result<(), TableError> {
    let differing = |what: &str, one: &str, two: &str| {
        let problem = format!("{} and {} are parts of different results", a.display(), b.display());
        let reason = format!("{what} is {one} in the first and {two} in the second");
        Err(TableError::Parts(Message::new(problem, reason)))
    };
    if first.query != other.query {
        return differing("the query", &first.query, &other.query);
    }
    let absent = "absent".to_owned();
    let value = |part: &Part, name: &String| part.settings.get(name).unwrap_or(&absent).clone();
    // the model first: it also changes hashes of other inputs
    let names = first.settings.keys().chain(other.settings.keys());
    let mut names: Vec<&String> = names.filter(|name| value(first, name) != value(other, name)).collect();
    names.sort_by_key(|name| (*name != "model", *name != "seed"));
    if let Some(name) = names.first() {
        return differing(&format!("`{name}`"), &value(first, name), &value(other, name));
    }
    if first.total != other.total {
        return differing("the total", &first.total.to_string(), &other.total.to_string());
    }
    match first.columns == other.columns {
        true => Ok(()),
        false => differing("the list of columns", "one", "another"),
    }
}

/// Checks that two parts, in order of their starts, do not overlap.
fn disjoint((a, first): &(PathBuf, Part), (b, other): &(PathBuf, Part)) -> Result<(), TableError> {
    if first.range.end <= other.range.start {
        return Ok(());
    }
    let problem = format!("{} and {} overlap", a.display(), b.display());
    let [one, two] = [first, other].map(|part| format!("{}:{}", part.range.start, part.range.end));
    let reason = format!("their ranges are {one} and {two}");
    Err(TableError::Parts(Message::new(problem, reason).suggest("Leave one of them out")))
}
