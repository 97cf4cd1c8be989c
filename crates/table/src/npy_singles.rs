//! Writer of NPY arrays of float32 numbers, whose length is patched into the header at the end.

use crate::{AtomicFile, TableError, npy_header};
use std::io::{Seek, SeekFrom, Write};
use std::path::Path;

/// Writes an array of float32 numbers of shape (n, ...) row by row. The file appears when it is complete.
#[derive(Debug)]
pub struct NpySingles {
    file: AtomicFile,
    /// The lengths of the dimensions of a row.
    inner: Vec<u64>,
    rows: u64,
}

impl NpySingles {
    /// Creates the file of an array whose rows have the dimensions `inner`.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if the file cannot be created.
    pub fn create(path: impl AsRef<Path>, inner: &[u64]) -> Result<NpySingles, TableError> {
        let path = path.as_ref();
        let mut file = AtomicFile::create(path)?;
        // same length as the final header, which replaces it
        let written = file.write_all(&npy_header::single(0, inner));
        written.map_err(|error| TableError::io("write", path, error))?;
        Ok(NpySingles { file, inner: inner.to_vec(), rows: 0 })
    }

    /// Appends a row, given by the bits of its numbers: some layouts keep integers in them.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if writing fails, or if the row has another number of numbers.
    pub fn write(&mut self, row: &[u32]) -> Result<(), TableError> {
        let numbers: u64 = self.inner.iter().product();
        let written = match row.len() as u64 == numbers {
            true => row.iter().try_for_each(|bits| self.file.write_all(&bits.to_le_bytes())),
            false => Err(std::io::Error::other(format!("a row of {numbers} numbers has {}", row.len()))),
        };
        self.rows += 1;
        written.map_err(|error| TableError::io("write", self.file.target(), error))
    }

    /// Completes the file.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if writing fails; an existing file is then unchanged.
    pub fn finish(mut self) -> Result<(), TableError> {
        let header = npy_header::single(self.rows, &self.inner);
        let patched = self.file.seek(SeekFrom::Start(0)).and_then(|_| self.file.write_all(&header));
        patched.map_err(|error| TableError::io("write", self.file.target(), error))?;
        self.file.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NpyArray;
    use std::fs::File;

    /// The reader of arrays reads the rows; rows of another size are refused.
    #[test]
    fn rows_are_read_back() {
        let path = std::env::temp_dir().join(format!("rayweave-singles-{}.npy", std::process::id()));
        let rows: [[f32; 4]; 3] = [[1.5, -2.0, 0.1, 1e30], [0.0; 4], [f32::MIN_POSITIVE, 7.0, 8.0, f32::MAX]];
        for count in [0, 3] {
            let mut file = NpySingles::create(&path, &[2, 2]).unwrap();
            for row in &rows[..count] {
                file.write(&row.map(f32::to_bits)).unwrap();
            }
            file.finish().unwrap();
            let (array, is_single) = NpyArray::read_floats(&mut File::open(&path).unwrap(), 100).unwrap();
            assert!(is_single);
            assert_eq!(array.shape, [count as u64, 2, 2]);
            let expected: Vec<f64> =
                rows[..count].as_flattened().iter().map(|&number| number.into()).collect();
            assert_eq!(array.numbers, expected);
        }
        let error = NpySingles::create(&path, &[2, 2]).unwrap().write(&[0; 3]).unwrap_err().to_string();
        assert!(error.contains("a row of 4 numbers has 3"), "{error}");
        std::fs::remove_file(&path).unwrap();
    }
}
