//! Atomic output files: a file appears complete or not at all.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::TableError;

/// An output file written to a temporary file in the folder of its target and renamed when complete.
///
/// The target is untouched until [`finish`](Self::finish). The temporary file is removed on drop without `finish` and after a
/// failed write, so that an interrupted or failed run leaves no partial file. A killed process leaves the hidden file
/// `.NAME.PID-N.tmp`, but never a damaged target.
///
/// Symbolic links are followed. A target that is not a regular file, such as `/dev/null`, `NUL` on Windows, or a named pipe, is
/// written directly. An existing target keeps its permissions.
///
/// Writes are buffered. The file is not synced to disk: `finish` protects against failures of the program, not of the machine.
///
/// ```
/// use std::io::Write;
/// # let target = std::env::temp_dir().join(format!("rayweave-doc-{}.txt", std::process::id()));
/// let mut file = rayweave_table::AtomicFile::create(&target)?;
/// file.write_all(b"complete")?;
/// assert!(!target.exists());
/// file.finish()?;
/// assert_eq!(std::fs::read(&target)?, b"complete");
/// # std::fs::remove_file(&target)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct AtomicFile {
    /// The path as given by the caller, for messages.
    target: PathBuf,
    /// `None` after `finish`.
    file: Option<BufWriter<File>>,
    destination: Destination,
    failed: bool,
}

/// The destination of the bytes before completion.
#[derive(Debug)]
enum Destination {
    /// The file `temporary`, which is renamed to `resolved`.
    Temporary { temporary: Temporary, resolved: PathBuf },
    /// The target itself: a device or a pipe.
    Direct,
}

impl AtomicFile {
    /// Creates a temporary file in the folder of `target`.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if the folder is missing or not writable, if the target is a folder, or if the existing target is not
    /// writable.
    pub fn create(target: impl AsRef<Path>) -> Result<Self, TableError> {
        let target = target.as_ref();
        let opened = open(target).map_err(|error| create_error(target, error));
        opened.map(|(file, destination)| Self {
            target: target.to_path_buf(),
            file: Some(BufWriter::with_capacity(1 << 16, file)),
            destination,
            failed: false,
        })
    }

    /// True if this process has no temporary file at the moment. From then on none can be created (attempts return an
    /// error), so that the process may exit at any time.
    pub fn none_from_now_on() -> bool {
        let mut unfinished = lock();
        unfinished.refused |= unfinished.paths.is_empty();
        unfinished.refused
    }

    /// Removes all temporary files of this process and prevents new ones, so that the process may exit although a thread still
    /// writes to one, or waits for a blocked pipe while one is open. Their writers get an error from [`finish`](Self::finish).
    ///
    /// Some systems cannot remove an open file: it is left behind there.
    pub fn abandon_all() {
        let mut unfinished = lock();
        unfinished.refused = true;
        for path in &unfinished.paths {
            // a failure cannot be reported from here
            let _ = fs::remove_file(path);
        }
    }

    /// The path of the target as given by the caller.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Flushes the buffer and renames the file to its target.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if an earlier write failed, or if flushing or renaming fails. The target is then untouched and the
    /// temporary file is removed.
    pub fn finish(mut self) -> Result<(), TableError> {
        let done = self.close_and_rename();
        done.map_err(|error| TableError::io("write", &self.target, error))
        // the following drop removes the temporary file, if it still exists
    }

    fn close_and_rename(&mut self) -> io::Result<()> {
        if self.failed {
            return Err(io::Error::other("an earlier write failed"));
        }
        self.flush()?;
        let Destination::Temporary { temporary, resolved } = &self.destination else {
            return Ok(());
        };
        // close before the rename: some systems cannot rename an open file
        self.file = None;
        fs::rename(&temporary.0, resolved)?;
        self.destination = Destination::Direct;
        Ok(())
    }

    /// Runs an operation on the open file and records a failure, so that `finish` does not rename a damaged file.
    fn guard<T>(&mut self, operation: impl FnOnce(&mut BufWriter<File>) -> io::Result<T>) -> io::Result<T> {
        let Some(file) = &mut self.file else {
            return Err(io::Error::other("the file is closed"));
        };
        let result = operation(file);
        let is_fatal = |error: &io::Error| error.kind() != io::ErrorKind::Interrupted;
        self.failed |= result.as_ref().err().is_some_and(is_fatal);
        result
    }
}

impl Write for AtomicFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.guard(|file| file.write(bytes))
    }

    fn flush(&mut self) -> io::Result<()> {
        self.guard(|file| file.flush())
    }
}

impl Seek for AtomicFile {
    fn seek(&mut self, position: SeekFrom) -> io::Result<u64> {
        self.guard(|file| file.seek(position))
    }
}

impl Drop for AtomicFile {
    fn drop(&mut self) {
        if let Destination::Temporary { temporary, .. } = &self.destination {
            // discards the buffer, which dropping the writer would flush
            drop(self.file.take().map(BufWriter::into_parts));
            // a failure cannot be reported from here
            let _ = fs::remove_file(&temporary.0);
        }
    }
}

fn create_error(target: &Path, error: io::Error) -> TableError {
    let folder = folder_of(target);
    // Windows reports the same error for both
    if error.kind() == io::ErrorKind::NotFound && folder.ancestors().any(Path::is_file) {
        return TableError::io("create", target, io::ErrorKind::NotADirectory.into());
    }
    if error.kind() == io::ErrorKind::NotFound && !folder.exists() {
        let missing = format!("the folder {} does not exist. Create it first", folder.display());
        return TableError::io("create", target, io::Error::other(missing));
    }
    TableError::io("create", target, error)
}

fn open(target: &Path) -> io::Result<(File, Destination)> {
    let Ok(metadata) = fs::metadata(target) else {
        // devices of Windows, such as NUL, have no metadata
        if cfg!(windows)
            && let Ok(device) = OpenOptions::new().write(true).open(target)
        {
            return Ok((device, Destination::Direct));
        }
        return open_temporary(resolve_link(target));
    };
    if metadata.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    // a rename requires write permission on the folder only: opening the file protects write-protected files
    let existing = OpenOptions::new().write(true).open(target)?;
    if !metadata.is_file() {
        return Ok((existing, Destination::Direct));
    }
    let (file, destination) = open_temporary(fs::canonicalize(target)?)?;
    if let Err(error) = file.set_permissions(metadata.permissions()) {
        if let Destination::Temporary { temporary, .. } = &destination {
            let _ = fs::remove_file(&temporary.0);
        }
        return Err(error);
    }
    Ok((file, destination))
}

/// The target of a link to a missing file; any other path unchanged.
fn resolve_link(target: &Path) -> PathBuf {
    match fs::read_link(target) {
        Ok(link) => folder_of(target).join(link),
        Err(_) => target.to_path_buf(),
    }
}

/// The temporary files of this process.
struct Unfinished {
    paths: Vec<PathBuf>,
    /// True if no further files may be created.
    refused: bool,
}

static UNFINISHED: Mutex<Unfinished> = Mutex::new(Unfinished { paths: Vec::new(), refused: false });

fn lock() -> MutexGuard<'static, Unfinished> {
    // no panic is possible under the lock
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A path in the list of [`Unfinished`].
#[derive(Debug)]
struct Temporary(PathBuf);

impl Temporary {
    /// Creates a file, which must not exist. The list is locked meanwhile, so that it names every file that exists.
    fn create(path: PathBuf) -> io::Result<(File, Temporary)> {
        let mut unfinished = lock();
        if unfinished.refused {
            return Err(io::Error::other("the program ends"));
        }
        let file = OpenOptions::new().write(true).create_new(true).open(&path)?;
        unfinished.paths.push(path.clone());
        Ok((file, Temporary(path)))
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        lock().paths.retain(|path| *path != self.0);
    }
}

fn open_temporary(resolved: PathBuf) -> io::Result<(File, Destination)> {
    loop {
        match Temporary::create(temporary_path(&resolved)?) {
            Ok((file, temporary)) => return Ok((file, Destination::Temporary { temporary, resolved })),
            // left by a killed process with the same id: try the next name
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// The path `.NAME.PID-N.tmp` in the target's folder; N counts the files of this process.
fn temporary_path(target: &Path) -> io::Result<PathBuf> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let Some(name) = target.file_name() else {
        return Err(io::Error::other("the path does not end in a file name"));
    };
    // names are limited to 255 bytes: 40 characters of at most 4 bytes leave room for the rest
    let short: String = name.to_string_lossy().chars().take(40).collect();
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let temporary = OsString::from(format!(".{short}.{}-{count}.tmp", process::id()));
    Ok(folder_of(target).join(temporary))
}

fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder,
        _ => Path::new("."),
    }
}
