//! Files of rays: streamed in chunks, checked at the door.

mod chunk;
mod csv;
mod npy;

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use crate::error::{RayProblem, RayProblems, TableError};
use crate::format::extension;
pub use chunk::RayChunk;

/// The six columns of a file of rays: origin, then direction.
pub const RAY_COLUMNS: [&str; 6] = ["ox", "oy", "oz", "dx", "dy", "dz"];

/// The columns that a file of light may have besides: the vacuum wavelength in nanometres, and the power.
pub const LIGHT_COLUMNS: [&str; 2] = ["wavelength_nm", "power"];

/// All of them, in the order of NPY.
const COLUMNS: [&str; 8] = ["ox", "oy", "oz", "dx", "dy", "dz", "wavelength_nm", "power"];

/// The values of a row, whatever the file has.
type Row = [f64; COLUMNS.len()];

/// Which of the columns a file has.
type Has = [bool; COLUMNS.len()];

/// A good size of chunk: 768 KiB of coordinates, enough work to share among threads.
pub const RAYS_PER_CHUNK: usize = 1 << 14;

/// How far a reader has come, in bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Bytes read so far.
    pub done: u64,
    /// Bytes in all; `None` for standard input and pipes.
    pub total: Option<u64>,
}

/// Reads rays from a CSV or NPY file, or CSV from standard input, in chunks.
///
/// Memory is a fixed buffer (under 1 MiB) and the caller's [`RayChunk`], whatever the size of the file.
///
/// **CSV**: the header names `ox,oy,oz,dx,dy,dz` in any order; fields are separated by commas, may be quoted and
/// surrounded by spaces; blank lines and a byte order mark are skipped. A line has at most 65,536 bytes.
///
/// **NPY**: shape (N, 6), float64 or float32, either byte order, C or Fortran order.
///
/// Every number is finite and no direction is zero: anything else is an error that names file, line or row, and
/// column. A regular file with a problem is searched to its end, or to [`RayProblems::LIMIT`] problems, so that all
/// are reported together; a stream is searched to the end of the chunk.
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
    found: Findings,
    row: u64,
    ended: bool,
}

impl RayReader {
    /// Opens a file by its extension, `.csv` or `.npy`; `-` is CSV from standard input. The header is read here.
    ///
    /// # Errors
    ///
    /// [`TableError::Format`] for another extension, [`TableError::Io`] if the file cannot be read, and
    /// [`TableError::Rays`] for an empty file, a bad header, wrong shape or type, or an array that is cut off.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, TableError> {
        Self::open_as(path.as_ref(), Kind::Rays)
    }

    /// Opens a file of light: rays that may have wavelengths and powers of their own, [`LIGHT_COLUMNS`].
    ///
    /// In CSV their columns are named, in any order; NPY has the shape (N, 6), (N, 7) with wavelengths, or (N, 8) with both.
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open).
    ///
    /// ```
    /// use rayweave_table::{RayChunk, RayReader};
    ///
    /// let text = "power,ox,oy,oz,dx,dy,dz,wavelength_nm\n0.5,0,0,-10,0,0,1,633\n";
    /// let mut reader = RayReader::light_from_csv(text.as_bytes(), "light.csv")?;
    /// let mut chunk = RayChunk::default();
    /// assert_eq!(reader.read(&mut chunk, 100)?, 1);
    /// assert_eq!((chunk.wavelength_nm, chunk.power), (vec![633.0], vec![0.5]));
    /// # Ok::<(), rayweave_table::TableError>(())
    /// ```
    pub fn open_light(path: impl AsRef<Path>) -> Result<Self, TableError> {
        Self::open_as(path.as_ref(), Kind::Light)
    }

    fn open_as(path: &Path, kind: Kind) -> Result<Self, TableError> {
        if path == Path::new("-") {
            return Self::start("stdin".to_owned(), |found| {
                csv::CsvRays::open(io::stdin(), None, kind, found)
            });
        }
        let extension = extension(path);
        if extension != "csv" && extension != "npy" {
            let problem = "unknown format of rays (the extension says it: .csv or .npy)";
            return Err(TableError::format(path, problem));
        }
        let unreadable = |error| TableError::io("read", path, error);
        let file = File::open(path).map_err(unreadable)?;
        let metadata = file.metadata().map_err(unreadable)?;
        let size = metadata.is_file().then_some(metadata.len());
        let name = path.display().to_string();
        match extension.as_str() {
            "csv" => Self::start(name, |found| csv::CsvRays::open(file, size, kind, found)),
            _ => Self::start(name, |found| npy::NpyRays::open(file, size, kind, found)),
        }
    }

    /// Reads CSV from any source. `name` stands for the file in messages.
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open).
    pub fn from_csv(source: impl Read + Send + 'static, name: impl Into<String>) -> Result<Self, TableError> {
        Self::start(name.into(), |found| csv::CsvRays::open(source, None, Kind::Rays, found))
    }

    /// Reads CSV of light from any source; see [`open_light`](Self::open_light).
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open).
    pub fn light_from_csv(
        source: impl Read + Send + 'static,
        name: impl Into<String>,
    ) -> Result<Self, TableError> {
        Self::start(name.into(), |found| csv::CsvRays::open(source, None, Kind::Light, found))
    }

    fn start<S: RaySource + 'static>(
        name: String,
        open: impl FnOnce(&mut Findings) -> io::Result<Option<S>>,
    ) -> Result<Self, TableError> {
        let mut found = Findings::new(name);
        match open(&mut found) {
            Err(error) => Err(found.unreadable(error)),
            Ok(None) => Err(found.take().into()),
            Ok(Some(source)) => Ok(Self { source: Box::new(source), found, row: 0, ended: false }),
        }
    }

    /// Replaces the chunk's rays by the next ones, at most `max_rays` (at least one is asked for), and returns their
    /// number: 0 at the end of the file. The chunk's vectors keep their memory from call to call.
    ///
    /// # Errors
    ///
    /// [`TableError::Rays`] for rays that are not six finite numbers with a direction; [`TableError::Io`] if reading
    /// fails. The chunk is then empty, and the reader at its end.
    pub fn read(&mut self, chunk: &mut RayChunk, max_rays: usize) -> Result<usize, TableError> {
        chunk.clear();
        if self.ended {
            return Ok(0);
        }
        let filled = self.fill(chunk, max_rays.max(1));
        if filled.is_err() {
            chunk.clear();
        }
        self.ended = chunk.is_empty();
        filled.map(|()| chunk.len())
    }

    fn fill(&mut self, chunk: &mut RayChunk, max_rays: usize) -> Result<(), TableError> {
        self.fill_once(chunk, max_rays)?;
        if self.found.is_empty() {
            return Ok(());
        }
        let is_file = self.progress().total.is_some();
        while is_file && !self.found.is_full() && self.fill_once(chunk, max_rays)? {}
        Err(self.found.take().into())
    }

    /// Whether there were rows, good or bad.
    fn fill_once(&mut self, chunk: &mut RayChunk, max_rays: usize) -> Result<bool, TableError> {
        chunk.clear();
        chunk.first = self.row;
        let filled = self.source.fill(chunk, self.row, max_rays, &mut self.found);
        let rows = filled.map_err(|error| self.found.unreadable(error))?;
        self.row += rows;
        Ok(rows > 0)
    }

    /// How far the reader has come.
    pub fn progress(&self) -> Progress {
        self.source.progress()
    }

    /// The number of rays in the file, where it is known before reading: NPY says it.
    pub fn rays(&self) -> Option<u64> {
        self.source.rays()
    }
}

impl std::fmt::Debug for RayReader {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("RayReader")
            .field("file", &self.found.problems.file)
            .field("row", &self.row)
            .finish_non_exhaustive()
    }
}

/// What a file may hold.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// [`RAY_COLUMNS`].
    Rays,
    /// [`LIGHT_COLUMNS`] besides.
    Light,
}

impl Kind {
    /// The columns that a file may have.
    fn columns(self) -> &'static [&'static str] {
        match self {
            Kind::Rays => &COLUMNS[..RAY_COLUMNS.len()],
            Kind::Light => &COLUMNS,
        }
    }
}

/// One format of rays.
trait RaySource: Send {
    /// Appends at most `max_rays` rows to the chunk, the first of them being row `first`. Returns the number of rows
    /// that were consumed: 0 at the end. Bad rows are consumed and reported, not appended.
    fn fill(
        &mut self,
        chunk: &mut RayChunk,
        first: u64,
        max_rays: usize,
        found: &mut Findings,
    ) -> io::Result<u64>;

    fn progress(&self) -> Progress;

    fn rays(&self) -> Option<u64>;
}

/// Collects problems up to the limit.
struct Findings {
    problems: RayProblems,
}

impl Findings {
    fn new(file: String) -> Self {
        Self { problems: RayProblems { file, problems: Vec::new(), stopped: false } }
    }

    fn add(&mut self, problem: RayProblem) {
        if self.problems.problems.len() < RayProblems::LIMIT {
            self.problems.problems.push(problem);
        } else {
            self.problems.stopped = true;
        }
    }

    fn is_empty(&self) -> bool {
        self.problems.problems.is_empty()
    }

    /// Whether a problem had to be left out.
    fn is_full(&self) -> bool {
        self.problems.stopped
    }

    fn take(&mut self) -> RayProblems {
        let file = self.problems.file.clone();
        std::mem::replace(&mut self.problems, Self::new(file).problems)
    }

    fn unreadable(&self, error: io::Error) -> TableError {
        TableError::io("read", Path::new(&self.problems.file), error)
    }
}

/// Where a ray stands in its file.
#[derive(Clone, Copy)]
struct Place {
    line: Option<u64>,
    row: u64,
}

impl Place {
    fn problem(self, column: Option<usize>, message: String) -> RayProblem {
        RayProblem {
            line: self.line,
            row: Some(self.row),
            column: column.map(|column| COLUMNS[column]),
            message,
        }
    }
}

/// The greatest size of a number that is taken, and the inverse of the least size of a direction: squares of
/// such numbers, and of their inverses, are far from the ends of the range of f64.
const HUGE: f64 = 1e100;

/// Reports every number that is out of range. Returns whether the row is good.
fn check_row(row: &Row, has: &Has, place: Place, found: &mut Findings) -> bool {
    let is_ray = check_ray(&row[..RAY_COLUMNS.len()], place, found);
    let is_light = check_light(row, has, place, found);
    is_ray && is_light
}

/// Reports wavelengths and powers that are none.
fn check_light(row: &Row, has: &Has, place: Place, found: &mut Findings) -> bool {
    let [wavelength, power] = [6, 7];
    let is_sound = |column: usize| match column == wavelength {
        true => row[column] > 0.0 && row[column].is_finite(),
        false => row[column] >= 0.0 && row[column].is_finite(),
    };
    let bad = [wavelength, power].into_iter().filter(|&column| has[column] && !is_sound(column));
    let bad: Vec<usize> = bad.collect();
    for &column in &bad {
        let range = if column == wavelength { "greater than 0" } else { "at least 0" };
        let message = format!("{} is {} (it is finite and {range})", COLUMNS[column], row[column]);
        found.add(place.problem(Some(column), message));
    }
    bad.is_empty()
}

/// Reports every number that is not finite or too large, or else a direction that is zero or too small. Returns
/// whether the ray is good.
fn check_ray(ray: &[f64], place: Place, found: &mut Findings) -> bool {
    let in_range = |x: &f64| (-HUGE..=HUGE).contains(x);
    let longest = ray[3..].iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let is_in_range = ray.iter().all(in_range);
    if is_in_range && longest >= 1.0 / HUGE {
        return true;
    }
    for (column, x) in ray.iter().enumerate().filter(|(_, x)| !in_range(x)) {
        let name = RAY_COLUMNS[column];
        let message = match () {
            () if x.is_nan() => format!("{name} is NaN (a ray is six finite numbers)"),
            () if x.is_infinite() => format!("{name} is infinite (a ray is six finite numbers)"),
            () => format!("{name} is {x:e} (its square overflows) is the unit far too small?"),
        };
        found.add(place.problem(Some(column), message));
    }
    if is_in_range {
        let message = match longest {
            0.0 => "dx, dy and dz are all 0 (a direction is a vector that is not zero)",
            _ => {
                "dx, dy and dz are all below 1e-100 (the square of such a direction vanishes) give it a length near 1?"
            }
        };
        found.add(place.problem(None, message.into()));
    }
    false
}
