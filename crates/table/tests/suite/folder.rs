//! Temporary folder for a test.

use std::fs;
use std::path::{MAIN_SEPARATOR, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// An empty folder, removed with its contents on drop.
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    pub fn new() -> Self {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("rayweave-table-{}-{count}", std::process::id());
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).unwrap();
        Self { path }
    }

    pub fn join(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The names of the files, sorted.
    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.path).unwrap();
        let name = |entry: std::io::Result<fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
        let mut names: Vec<_> = entries.map(name).collect();
        names.sort();
        names
    }

    pub fn write(&self, name: &str, bytes: impl AsRef<[u8]>) -> PathBuf {
        fs::write(self.join(name), bytes).unwrap();
        self.join(name)
    }

    /// The text of an error without this folder's path.
    pub fn text_of(&self, error: &impl ToString) -> String {
        let place = format!("{}{}", self.path.display(), MAIN_SEPARATOR);
        error.to_string().replace(&place, "")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.path).unwrap();
    }
}
