//! A file that appears complete or not at all.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::TableError;

/// An output file that is written beside its target and renamed when complete.
///
/// Until [`finish`](Self::finish) the target is untouched. Dropped without `finish`, or after a failed write, the
/// temporary file is removed, so that an interrupted or failed run never leaves a half-written file. (A process that
/// is killed outright leaves the hidden file `.NAME.PID-N.tmp`, never a damaged target.)
///
/// A target that is a symbolic link is written where it points. A target that is no regular file (`/dev/null`, a
/// named pipe) has nothing to be renamed over, and is written directly. An existing target keeps its permissions.
///
/// Writes are buffered. The file is not synced to the disk: `finish` protects from failures of the program, not of
/// the machine.
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
    /// As the caller named it, for messages.
    target: PathBuf,
    /// `None` once finished.
    file: Option<BufWriter<File>>,
    place: Place,
    failed: bool,
}

/// Where the bytes go until they are complete.
#[derive(Debug)]
enum Place {
    /// Into `temporary`, which becomes `resolved`.
    Beside { temporary: PathBuf, resolved: PathBuf },
    /// Into the target itself: a device or a pipe.
    Direct,
}

impl AtomicFile {
    /// Opens a temporary file in the folder of `target`.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if the folder is missing or not writable, if the target is a folder, or if it exists and
    /// may not be written.
    pub fn create(target: impl AsRef<Path>) -> Result<Self, TableError> {
        let target = target.as_ref();
        let opened = open(target).map_err(|error| create_error(target, error));
        opened.map(|(file, place)| Self {
            target: target.to_path_buf(),
            file: Some(BufWriter::with_capacity(1 << 16, file)),
            place,
            failed: false,
        })
    }

    /// The target, as the caller named it.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Writes out what is buffered and gives the file its name.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if an earlier write failed, or if flushing or renaming fails; the target is then untouched
    /// and the temporary file is removed.
    pub fn finish(mut self) -> Result<(), TableError> {
        let done = self.close_and_rename();
        done.map_err(|error| TableError::io("write", &self.target, error))
        // the drop that follows removes the temporary file, if it is still there
    }

    fn close_and_rename(&mut self) -> io::Result<()> {
        if self.failed {
            return Err(io::Error::other("an earlier write failed"));
        }
        self.flush()?;
        let Place::Beside { temporary, resolved } = &self.place else {
            return Ok(());
        };
        // closed before the rename: some systems refuse to rename an open file
        self.file = None;
        fs::rename(temporary, resolved)?;
        self.place = Place::Direct;
        Ok(())
    }

    /// Runs one operation on the open file and remembers a failure, so that `finish` cannot bless a damaged file.
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
        if let Place::Beside { temporary, .. } = &self.place {
            // taken apart, so that the buffer of an abandoned file is not written for nothing
            drop(self.file.take().map(BufWriter::into_parts));
            // nothing to do about a failure here, and nobody to tell
            let _ = fs::remove_file(temporary);
        }
    }
}

fn create_error(target: &Path, error: io::Error) -> TableError {
    let folder = folder_of(target);
    if error.kind() == io::ErrorKind::NotFound && !folder.exists() {
        let missing = format!("the folder {} does not exist; create it first", folder.display());
        return TableError::io("create", target, io::Error::other(missing));
    }
    TableError::io("create", target, error)
}

fn open(target: &Path) -> io::Result<(File, Place)> {
    let Ok(metadata) = fs::metadata(target) else {
        return open_beside(resolve_link(target));
    };
    if metadata.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    // A rename needs rights on the folder only: asked here, a write-protected file is not replaced.
    let existing = OpenOptions::new().write(true).open(target)?;
    if !metadata.is_file() {
        return Ok((existing, Place::Direct));
    }
    let (file, place) = open_beside(fs::canonicalize(target)?)?;
    if let Err(error) = file.set_permissions(metadata.permissions()) {
        if let Place::Beside { temporary, .. } = &place {
            let _ = fs::remove_file(temporary);
        }
        return Err(error);
    }
    Ok((file, place))
}

/// The place that a link to a missing file names; any other path is itself.
fn resolve_link(target: &Path) -> PathBuf {
    match fs::read_link(target) {
        Ok(link) => folder_of(target).join(link),
        Err(_) => target.to_path_buf(),
    }
}

fn open_beside(resolved: PathBuf) -> io::Result<(File, Place)> {
    loop {
        let temporary = temporary_beside(&resolved)?;
        match OpenOptions::new().write(true).create_new(true).open(&temporary) {
            Ok(file) => {
                return Ok((file, Place::Beside { temporary, resolved }));
            }
            // left over by a killed process that had our number: take the next name
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// `.NAME.PID-N.tmp` in the target's folder; N counts the files of this process.
fn temporary_beside(target: &Path) -> io::Result<PathBuf> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let Some(name) = target.file_name() else {
        return Err(io::Error::other("the path does not end in a file name"));
    };
    // file systems limit a name to 255 bytes: 40 characters of at most 4 bytes leave room for the rest
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
