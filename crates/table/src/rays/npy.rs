//! Rays from NPY.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};

use super::{COLUMNS, Findings, Kind, Place, Progress, RAY_COLUMNS, RayChunk, RaySource, Row, check_row};
use crate::error::RayProblem;
use crate::npy_header::{self, NpyHeader};

/// Rows read at a time: the buffer holds 192 KiB.
const ROWS_PER_BLOCK: usize = 4096;

/// The type of the file's numbers.
#[derive(Clone, Copy)]
enum Number {
    F32 { big_endian: bool },
    F64 { big_endian: bool },
}

impl Number {
    fn from_descr(descr: &str) -> Option<Self> {
        // "=" is the writer's own byte order: all machines that we build for are little endian
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

    /// The value of `size` bytes.
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

/// An NPY file whose header has been read and fits.
pub(super) struct NpyRays {
    file: File,
    data_offset: u64,
    number: Number,
    fortran_order: bool,
    rows: u64,
    /// Columns: the first of [`COLUMNS`].
    columns: usize,
    /// Rows read so far.
    next: u64,
    is_file: bool,
    block: Vec<u8>,
}

impl NpyRays {
    /// Reads the header; `None` if it has problems. `size` is that of a regular file.
    pub(super) fn open(
        mut file: File,
        size: Option<u64>,
        kind: Kind,
        found: &mut Findings,
    ) -> io::Result<Option<Self>> {
        let header = match npy_header::read(&mut file)? {
            Ok(header) => header,
            Err(message) => {
                found.add(RayProblem::whole(message));
                return Ok(None);
            }
        };
        let (number, shape) = (check_dtype(&header, found), check_shape(&header.shape, kind, found));
        let (Some(number), Some((rows, columns))) = (number, shape) else {
            return Ok(None);
        };
        if let Some(message) = check_length(&header, number.size() * columns, rows, size) {
            found.add(RayProblem::whole(message));
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

    /// Reads rows `next..next + rows` into the block, row by row or column by column as the file has them.
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

    /// One ray of the block, which holds `rows` rays.
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
        found: &mut Findings,
    ) -> io::Result<u64> {
        let has = std::array::from_fn(|column| column < self.columns);
        let end = self.rows.min(first.saturating_add(max_rays as u64));
        while self.next < end && !found.is_full() {
            let rows = (end - self.next).min(ROWS_PER_BLOCK as u64) as usize;
            match self.read_block(rows) {
                Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                    let message = format!("the file is cut off (the header promises {} rays)", self.rows);
                    found.add(RayProblem::whole(message));
                    self.rows = self.next;
                    break;
                }
                result => result?,
            }
            for row in 0..rows {
                let values = self.row(row, rows);
                let place = Place { line: None, row: self.next + row as u64 };
                if check_row(&values, &has, place, found) {
                    chunk.push(&values, &has);
                }
            }
            self.next += rows as u64;
        }
        Ok(self.next - first)
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

fn check_dtype(header: &NpyHeader, found: &mut Findings) -> Option<Number> {
    let number = Number::from_descr(&header.descr);
    if header.structured {
        found.add(RayProblem::whole(
            "the array has named fields (rays are plain float64 of shape (N, 6)); \
             convert it with numpy.lib.recfunctions.structured_to_unstructured",
        ));
    } else if number.is_none() {
        found.add(RayProblem::whole(format!(
            "dtype is {} (rays are float64 or float32); convert it with array.astype(float)",
            header.descr
        )));
    }
    number
}

/// The number of rays, and that of their columns.
fn check_shape(shape: &[u64], kind: Kind, found: &mut Findings) -> Option<(u64, usize)> {
    let most = kind.columns().len();
    let is_width = |columns: u64| (RAY_COLUMNS.len() as u64..=most as u64).contains(&columns);
    let suggestion = match *shape {
        [rows, columns] if is_width(columns) => return Some((rows, columns as usize)),
        [6, _] => "; transpose it",
        [6] => "; reshape it to (1, 6)",
        [_, 2, 3] => "; reshape it to (-1, 6)",
        _ => "",
    };
    let shape = match shape {
        [length] => format!("({length},)"),
        _ => format!("({})", shape.iter().map(u64::to_string).collect::<Vec<_>>().join(", ")),
    };
    let widths = if kind == Kind::Rays { "(N, 6)" } else { "(N, 6) to (N, 8)" };
    let columns = COLUMNS[..most].join(", ");
    let message = format!("shape is {shape} (rays have shape {widths}: {columns}){suggestion}");
    found.add(RayProblem::whole(message));
    None
}

/// Compares the promised length with the file's, if that is known.
fn check_length(header: &NpyHeader, row_size: usize, rows: u64, size: Option<u64>) -> Option<String> {
    let promised = rows.checked_mul(row_size as u64);
    let Some(promised) = promised.filter(|&bytes| bytes <= i64::MAX as u64) else {
        return Some(format!("the NPY header is damaged (it promises {rows} rays)"));
    };
    let Some(size) = size else {
        let problem = "the array is in Fortran order (that needs a file, not a pipe); save it in C order";
        return header.fortran_order.then(|| problem.into());
    };
    let there = size.saturating_sub(header.data_offset);
    if there < promised {
        return Some(format!(
            "the file is cut off (the header promises {rows} rays, {promised} bytes; {there} bytes are there)"
        ));
    }
    (there > promised).then(|| {
        let rest = there - promised;
        format!("{rest} bytes follow the array (the header promises {rows} rays); save one array in a file")
    })
}
