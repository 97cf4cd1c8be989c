//! A record of the files that a model opens, to notice when they change.

use std::cell::RefCell;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// A file and its state at one time: when it was modified, and its length. Two equal stamps of one path mean that the file has not
/// changed, as far as its metadata show.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileStamp {
    /// The path under which the file was opened.
    pub path: PathBuf,
    /// Time of modification and length in bytes; `None` if there is no such file.
    state: Option<(SystemTime, u64)>,
}

impl FileStamp {
    /// The present state of a file.
    pub fn of(path: &Path) -> FileStamp {
        let state = fs::metadata(path).and_then(|data| Ok((data.modified()?, data.len()))).ok();
        FileStamp { path: path.to_owned(), state }
    }

    /// True if the file is now in a different state.
    pub fn has_changed(&self) -> bool {
        FileStamp::of(&self.path) != *self
    }
}

thread_local! {
    /// The files of each [`record_opened`] that runs on this thread, innermost last.
    static RECORDS: RefCell<Vec<Vec<FileStamp>>> = const { RefCell::new(Vec::new()) };
}

/// Adds a file to the records of this thread, in its state before it is opened.
pub(crate) fn record(path: &Path) {
    RECORDS.with_borrow_mut(|records| {
        if let Some(record) = records.last_mut()
            && record.iter().all(|stamp| stamp.path != path)
        {
            record.push(FileStamp::of(path));
        }
    });
}

/// Runs a function; returns its value and the files that models tried to open in it on this thread, each in its state before it was
/// opened first. A model file itself is not among them: its caller has its name.
///
/// ```
/// use rayweave_table::{AllowedFiles, record_opened};
/// use std::path::Path;
///
/// let files = AllowedFiles::of_model(Some(Path::new("model.toml")), &[]);
/// let (_, opened) = record_opened(|| files.open(Path::new("part.stl")).is_ok());
/// assert_eq!(opened[0].path, Path::new("part.stl"));
/// ```
pub fn record_opened<T>(run: impl FnOnce() -> T) -> (T, Vec<FileStamp>) {
    RECORDS.with_borrow_mut(|records| records.push(Vec::new()));
    let value = run();
    let opened = RECORDS.with_borrow_mut(|records| records.pop().unwrap_or_default());
    (value, opened)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn changes_are_noticed() {
        let path = std::env::temp_dir().join(format!("rayweave-stamp-{}", std::process::id()));
        let missing = FileStamp::of(&path);
        assert!(!missing.has_changed());
        fs::write(&path, "a").unwrap();
        assert!(missing.has_changed());
        let short = FileStamp::of(&path);
        fs::write(&path, "ab").unwrap();
        assert!(short.has_changed());
        let present = FileStamp::of(&path);
        assert!(!present.has_changed());
        fs::remove_file(&path).unwrap();
        assert!(present.has_changed());
    }

    #[test]
    fn records_are_separate() {
        let (inner, outer) = record_opened(|| {
            record(Path::new("a"));
            let ((), inner) = record_opened(|| record(Path::new("b")));
            record(Path::new("a"));
            inner
        });
        let names = |stamps: &[FileStamp]| stamps.iter().map(|s| s.path.clone()).collect::<Vec<_>>();
        assert_eq!((names(&inner), names(&outer)), (vec![PathBuf::from("b")], vec![PathBuf::from("a")]));
        record(Path::new("c"));
        assert!(record_opened(|| ()).1.is_empty());
    }
}
