//! NPY reader of rays.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

use super::RayChunk;
use super::check::check_row;
use super::columns::{COLUMNS, Content, RAY_COLUMNS, Row};
use super::problems::{ProblemList, RayLocation};
use super::source::{Progress, RaySource};
use crate::error::RayProblem;
use crate::npy_header::{self, NpyHeader};

/// Number of rows read at once, 192 KiB.
const ROWS_PER_BLOCK: usize = 4096;

/// The type of the numbers in the file.
#[derive(Clone, Copy)]
enum Number {
    F32 { big_endian: bool },
    F64 { big_endian: bool },
}

impl Number {
    fn from_descr(descr: &str) -> Option<Self> {
        // "=" is the native byte order of the writer, assumed to be little endian
        let (order, kind) = descr.split_at_checked(1)?;
        let big_endian = order == ">";
        match (order, kind) {
            ("<" | ">" | "=", "f4") => Some(Self::F32 { big_endian }),
            ("<" | ">" | "=", "f8") => Some(Self::F64 { big_endian }),
            _ => None,
        }
    }

    fn size(self) -> usize {
        match self {
            Self::F32 { .. } => 4,
            Self::F64 { .. } => 8,
        }
    }

    /// Decodes a number from `size` bytes.
    fn decode(self, bytes: &[u8]) -> f64 {
        match self {
            Self::F32 { big_endian } => {
                let mut b = [0; 4];
                b.copy_from_slice(bytes);
                f64::from(if big_endian { f32::from_be_bytes(b) } else { f32::from_le_bytes(b) })
            }
            Self::F64 { big_endian } => {
                let mut b = [0; 8];
                b.copy_from_slice(bytes);
                if big_endian { f64::from_be_bytes(b) } else { f64::from_le_bytes(b) }
            }
        }
    }
}

/// An NPY file with a valid header.
pub(super) struct NpyRays {
    file: File,
    data_offset: u64,
    number: Number,
    fortran_order: bool,
    rows: u64,
    /// Number of columns, the first ones of [`COLUMNS`].
    columns: usize,
    /// Number of rows read so far.
    next: u64,
    is_file: bool,
    block: Vec<u8>,
}

impl NpyRays {
    /// Reads the header; `None` if it is invalid. `size` is the length of a regular file.
    pub(super) fn open(
        mut file: File,
        size: Option<u64>,
        content: Content,
        problems: &mut ProblemList,
    ) -> io::Result<Option<Self>> {
        let header = match npy_header::read(&mut file)? {
            Ok(header) => header,
            Err(message) => {
                problems.add(RayProblem::whole(message));
                return Ok(None);
            }
        };
        let (number, shape) = (check_dtype(&header, problems), check_shape(&header.shape, content, problems));
        let (Some(number), Some((rows, columns))) = (number, shape) else {
            return Ok(None);
        };
        if let Some(message) = check_length(&header, number.size() * columns, rows, size) {
            problems.add(RayProblem::whole(message));
            return Ok(None);
        }
        Ok(Some(Self {
            file,
            data_offset: header.data_offset,
            number,
            fortran_order: header.fortran_order,
            rows,
            columns,
            next: 0,
            is_file: size.is_some(),
            block: Vec::new(),
        }))
    }

    /// Reads rows `next..next + rows` into the block, in the order of the file (row-major or column-major).
    fn read_block(&mut self, rows: usize) -> io::Result<()> {
        let column_size = rows * self.number.size();
        self.block.resize(self.columns * column_size, 0);
        if !self.fortran_order {
            return self.file.read_exact(&mut self.block);
        }
        for (column, target) in (0..).zip(self.block.chunks_exact_mut(column_size)) {
            let before = (column * self.rows + self.next) * self.number.size() as u64;
            self.file.seek(SeekFrom::Start(self.data_offset + before))?;
            self.file.read_exact(target)?;
        }
        Ok(())
    }

    /// A row of the block of `rows` rows.
    fn row(&self, row: usize, rows: usize) -> Row {
        let size = self.number.size();
        let mut values = Row::default();
        for (column, value) in values.iter_mut().take(self.columns).enumerate() {
            let index = if self.fortran_order { column * rows + row } else { self.columns * row + column };
            *value = self.number.decode(&self.block[index * size..][..size]);
        }
        values
    }
}

impl RaySource for NpyRays {
    fn fill(
        &mut self,
        chunk: &mut RayChunk,
        first: u64,
        max_rays: usize,
        problems: &mut ProblemList,
    ) -> io::Result<u64> {
        let present = std::array::from_fn(|column| column < self.columns);
        let end = self.rows.min(first.saturating_add(max_rays as u64));
        while self.next < end && !problems.is_full() {
            let rows = (end - self.next).min(ROWS_PER_BLOCK as u64) as usize;
            match self.read_block(rows) {
                Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                    let message = format!("the file is incomplete: the header announces {} rays.", self.rows);
                    problems.add(RayProblem::whole(message));
                    self.rows = self.next;
                    break;
                }
                result => result?,
            }
            for row in 0..rows {
                let values = self.row(row, rows);
                let location = RayLocation { line: None, row: self.next + row as u64 };
                if check_row(&values, &present, location, problems) {
                    chunk.push(&values, &present);
                }
            }
            self.next += rows as u64;
        }
        Ok(self.next - first)
    }

    fn skip(&mut self, rows: u64) -> io::Result<u64> {
        if !self.is_file {
            return Ok(0);
        }
        self.next = rows.min(self.rows);
        if !self.fortran_order {
            let row_size = (self.columns * self.number.size()) as u64;
            self.file.seek(SeekFrom::Start(self.data_offset + self.next * row_size))?;
        }
        Ok(self.next)
    }

    fn progress(&self) -> Progress {
        let row_size = (self.columns * self.number.size()) as u64;
        Progress {
            done: self.data_offset + self.next * row_size,
            total: self.is_file.then_some(self.data_offset + self.rows * row_size),
        }
    }

    fn rays(&self) -> Option<u64> {
        Some(self.rows)
    }
}

fn check_dtype(header: &NpyHeader, problems: &mut ProblemList) -> Option<Number> {
    let number = Number::from_descr(&header.descr);
    if header.structured {
        problems.add(RayProblem::whole(
            "the array has named fields: rays are plain float64 of shape (N, 6). \
             Convert it with numpy.lib.recfunctions.structured_to_unstructured.",
        ));
    } else if number.is_none() {
        problems.add(RayProblem::whole(format!(
            "the dtype is {}: rays are float64 or float32. Convert it with array.astype(float).",
            header.descr
        )));
    }
    number
}

/// The number of rays and the number of columns.
fn check_shape(shape: &[u64], content: Content, problems: &mut ProblemList) -> Option<(u64, usize)> {
    let most = content.columns().len();
    let is_width = |columns: u64| (RAY_COLUMNS.len() as u64..=most as u64).contains(&columns);
    let suggestion = match *shape {
        [rows, columns] if is_width(columns) => return Some((rows, columns as usize)),
        [6, _] => " Transpose it.",
        [6] => " Reshape it to (1, 6).",
        [_, 2, 3] => " Reshape it to (-1, 6).",
        _ => "",
    };
    let shape = match shape {
        [length] => format!("({length},)"),
        _ => format!("({})", shape.iter().map(u64::to_string).collect::<Vec<_>>().join(", ")),
    };
    let widths = if content == Content::Rays { "(N, 6)" } else { "(N, 6) to (N, 8)" };
    let columns = COLUMNS[..most].join(", ");
    let message =
        format!("the shape is {shape}: rays have shape {widths} with the columns {columns}.{suggestion}");
    problems.add(RayProblem::whole(message));
    None
}

/// Compares the length of the array in the header with `size`, the length of the file, if there is
/// one.
fn check_length(header: &NpyHeader, row_size: usize, rows: u64, size: Option<u64>) -> Option<String> {
    let expected = rows.checked_mul(row_size as u64);
    let Some(expected) = expected.filter(|&bytes| bytes <= i64::MAX as u64) else {
        return Some(format!("the NPY header is damaged: it announces {rows} rays."));
    };
    let Some(size) = size else {
        let problem = "the array is in Fortran order: a pipe must be in C order. Save it in C order.";
        return header.fortran_order.then(|| problem.into());
    };
    let found = size.saturating_sub(header.data_offset);
    if found < expected {
        return Some(format!(
            "the file is incomplete: the header announces {rows} rays, {expected} bytes, and {found} bytes follow."
        ));
    }
    (found > expected).then(|| {
        let rest = found - expected;
        format!("{rest} bytes follow the array: the header announces {rows} rays. Save one array per file.")
    })
}
