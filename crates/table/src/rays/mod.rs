//! Ray files: streaming readers of CSV and NPY with validation.

mod check;
mod chunk;
mod columns;
mod csv;
mod npy;
mod problems;
mod source;

use std::fs::File;
use std::io::{self, Read};
use std::ops::Range;
use std::path::Path;

use rayweave_error::Message;

use crate::allowed::AllowedFiles;
use crate::error::TableError;
use crate::format::extension;
use columns::Content;
use problems::ProblemList;
use source::RaySource;

pub use chunk::RayChunk;
pub use columns::{LIGHT_COLUMNS, RAY_COLUMNS};
pub use source::Progress;

/// Recommended chunk size: 768 KiB of coordinates, enough work to distribute among threads.
pub const RAYS_PER_CHUNK: usize = 1 << 14;

/// Reads rays from a CSV or NPY file, or CSV from standard input, in chunks.
///
/// Memory use is a fixed buffer (under 1 MiB) and the caller's [`RayChunk`], for files of any size.
///
/// **CSV**: the header contains `ox,oy,oz,dx,dy,dz` in any order. Fields are separated by commas and may be quoted and surrounded
/// by spaces. Blank lines and a byte order mark are skipped. A line has at most 65,536 bytes.
///
/// **NPY**: shape (N, 6), float64 or float32, either byte order, C or Fortran order.
///
/// Numbers must be finite and directions nonzero. Errors give the file, the line or row, and the column. After the first problem a
/// regular file is validated to its end, or up to [`RayProblems::LIMIT`](crate::RayProblems::LIMIT) problems, so that all are
/// reported together; a stream is validated to the end of the chunk.
///
/// ```
/// use rayweave_table::{RAYS_PER_CHUNK, RayChunk, RayReader};
///
/// let text = "ox,oy,oz,dx,dy,dz\n0,0,-10,0,0,1\n0.5,0,-10,0,0,1\n";
/// let mut reader = RayReader::from_csv(text.as_bytes(), "rays.csv")?;
/// let mut chunk = RayChunk::default();
/// while reader.read(&mut chunk, RAYS_PER_CHUNK)? > 0 {
///     assert_eq!(chunk.origin[0], [0.0, 0.5]);
///     assert_eq!(chunk.direction[2], [1.0, 1.0]);
/// }
/// # Ok::<(), rayweave_table::TableError>(())
/// ```
pub struct RayReader {
    source: Box<dyn RaySource>,
    problems: ProblemList,
    row: u64,
    /// The number of the ray at which reading ends.
    end: u64,
    ended: bool,
}

impl RayReader {
    /// Opens a file by its extension, `.csv` or `.npy`, and reads its header. The path `-` is CSV from standard input.
    ///
    /// # Errors
    ///
    /// [`TableError::Format`] for any other extension, [`TableError::Io`] if the file cannot be read, and
    /// [`TableError::Rays`] for an empty file, an invalid header, a wrong shape or type, or a truncated array.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, TableError> {
        Self::open_as(path.as_ref(), Content::Rays)
    }

    /// Opens a light file: rays with optional wavelengths and powers, [`LIGHT_COLUMNS`].
    ///
    /// CSV has named columns in any order; NPY has the shape (N, 6), (N, 7) with wavelengths, or (N, 8) with both.
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open).
    ///
    /// ```
    /// use rayweave_table::{RayChunk, RayReader};
    ///
    /// let text = "power,ox,oy,oz,dx,dy,dz,wavelength_nm\n0.5,0,0,-10,0,0,1,633\n";
    /// let path = std::env::temp_dir().join(format!("rayweave-light-{}.csv", std::process::id()));
    /// std::fs::write(&path, text)?;
    /// let mut reader = RayReader::open_light(&path)?;
    /// let mut chunk = RayChunk::default();
    /// assert_eq!(reader.read(&mut chunk, 100)?, 1);
    /// assert_eq!((chunk.wavelength_nm, chunk.power), (vec![633.0], vec![0.5]));
    /// # std::fs::remove_file(&path)?;
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn open_light(path: impl AsRef<Path>) -> Result<Self, TableError> {
        Self::open_as(path.as_ref(), Content::Light)
    }

    /// Opens a light file that a model names, if it is among the given files; see [`open_light`](Self::open_light).
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open), and [`TableError::Refused`] for a file that is not allowed.
    pub fn open_allowed_light(path: impl AsRef<Path>, files: &AllowedFiles) -> Result<Self, TableError> {
        let path = path.as_ref();
        let extension = ray_extension(path)?;
        let file = files.open(path).map_err(|refused| TableError::refused(path, refused))?;
        Self::start_file(file, path, &extension, Content::Light)
    }

    fn open_as(path: &Path, content: Content) -> Result<Self, TableError> {
        if path == Path::new("-") {
            return Self::start("stdin".to_owned(), |problems| {
                csv::CsvRays::open(io::stdin(), None, content, problems)
            });
        }
        let extension = ray_extension(path)?;
        let file = File::open(path).map_err(|error| TableError::io("read", path, error))?;
        Self::start_file(file, path, &extension, content)
    }

    fn start_file(file: File, path: &Path, extension: &str, content: Content) -> Result<Self, TableError> {
        let metadata = file.metadata().map_err(|error| TableError::io("read", path, error))?;
        let size = metadata.is_file().then_some(metadata.len());
        let name = path.display().to_string();
        match extension {
            "csv" => Self::start(name, |problems| csv::CsvRays::open(file, size, content, problems)),
            _ => Self::start(name, |problems| npy::NpyRays::open(file, size, content, problems)),
        }
    }

    /// Reads CSV from any source. Messages use `name` as the file name.
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open).
    pub fn from_csv(source: impl Read + Send + 'static, name: impl Into<String>) -> Result<Self, TableError> {
        Self::start(name.into(), |problems| csv::CsvRays::open(source, None, Content::Rays, problems))
    }

    fn start<S: RaySource + 'static>(
        name: String,
        open: impl FnOnce(&mut ProblemList) -> io::Result<Option<S>>,
    ) -> Result<Self, TableError> {
        let mut problems = ProblemList::new(name);
        match open(&mut problems) {
            Err(error) => Err(problems.read_error(error)),
            Ok(None) => Err(problems.take().into()),
            Ok(Some(source)) => {
                Ok(Self { source: Box::new(source), problems, row: 0, end: u64::MAX, ended: false })
            }
        }
    }

    /// Replaces the contents of the chunk by the next rays, at most `max_rays` (but at least one), and returns their number: 0 at
    /// the end of the file. Reuses the memory of the chunk.
    ///
    /// # Errors
    ///
    /// [`TableError::Rays`] for invalid rays; [`TableError::Io`] if reading fails. The chunk is then empty, and the reader is at
    /// its end.
    pub fn read(&mut self, chunk: &mut RayChunk, max_rays: usize) -> Result<usize, TableError> {
        chunk.clear();
        if self.ended {
            return Ok(0);
        }
        let left = usize::try_from(self.end - self.row).unwrap_or(usize::MAX);
        if left == 0 {
            self.ended = true;
            return Ok(0);
        }
        let filled = self.fill(chunk, max_rays.clamp(1, left));
        if filled.is_err() {
            chunk.clear();
        }
        self.ended = chunk.is_empty();
        filled.map(|()| chunk.len())
    }

    /// The reader of a range of the rays, before the first ray is read. [`RayChunk::first`] keeps the numbers of the file. Rays of an
    /// NPY file before the range are not read, those of CSV are validated.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read). A range that exceeds the file is no error: see [`count`](Self::count).
    pub fn range(mut self, range: Range<u64>) -> Result<Self, TableError> {
        self.end = range.end.max(range.start);
        self.row = self.source.skip(range.start).map_err(|error| self.problems.read_error(error))?;
        let mut chunk = RayChunk::default();
        while self.row < range.start {
            let left = usize::try_from(range.start - self.row).unwrap_or(usize::MAX);
            let before = self.row;
            self.fill(&mut chunk, left.min(RAYS_PER_CHUNK))?;
            if self.row == before {
                self.end = before;
            }
            if self.end == self.row {
                break;
            }
        }
        Ok(self)
    }

    /// The number of rays in the file. CSV is read and validated to its end; then there is nothing left to read.
    ///
    /// # Errors
    ///
    /// As [`read`](Self::read).
    pub fn count(&mut self) -> Result<u64, TableError> {
        if let Some(rays) = self.rays() {
            return Ok(rays);
        }
        let (mut chunk, mut before) = (RayChunk::default(), None);
        while before != Some(self.row) {
            before = Some(self.row);
            self.fill(&mut chunk, RAYS_PER_CHUNK)?;
        }
        self.ended = true;
        Ok(self.row)
    }

    fn fill(&mut self, chunk: &mut RayChunk, max_rays: usize) -> Result<(), TableError> {
        self.fill_once(chunk, max_rays)?;
        if self.problems.is_empty() {
            return Ok(());
        }
        let is_file = self.progress().total.is_some();
        while is_file && !self.problems.is_full() && self.fill_once(chunk, max_rays)? {}
        Err(self.problems.take().into())
    }

    /// Reads a chunk; true if there were rows, valid or not.
    fn fill_once(&mut self, chunk: &mut RayChunk, max_rays: usize) -> Result<bool, TableError> {
        chunk.clear();
        chunk.first = self.row;
        let filled = self.source.fill(chunk, self.row, max_rays, &mut self.problems);
        let rows = filled.map_err(|error| self.problems.read_error(error))?;
        self.row += rows;
        Ok(rows > 0)
    }

    /// The progress in bytes.
    pub fn progress(&self) -> Progress {
        self.source.progress()
    }

    /// The number of rays in the file, if its header gives it (NPY).
    pub fn rays(&self) -> Option<u64> {
        self.source.rays()
    }
}

/// The extension of a ray file, in lower case.
fn ray_extension(path: &Path) -> Result<String, TableError> {
    let extension = extension(path);
    if extension != "csv" && extension != "npy" {
        let message = Message::new("the ray file format is unknown", "the extension must be .csv or .npy");
        return Err(TableError::format(path, message));
    }
    Ok(extension)
}

impl std::fmt::Debug for RayReader {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RayReader")
            .field("file", &self.problems.list.file)
            .field("row", &self.row)
            .finish_non_exhaustive()
    }
}
