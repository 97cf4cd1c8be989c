//! The whole table from its parts, with the bytes of a table that was written at once.

use super::{PartSet, npy};
use crate::format::extension;
use crate::{AtomicFile, TableError};
use rayweave_error::Message;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;

impl PartSet {
    /// Writes the whole table. The file has the bytes of the table that a run over all rays writes.
    ///
    /// # Errors
    ///
    /// [`TableError`] for missing ranges ([`check_whole`](Self::check_whole)), for parts that are no tables or have another format
    /// than `out`, and if a file cannot be read or written.
    pub fn merge_tables(&self, out: &Path) -> Result<(), TableError> {
        self.check_whole()?;
        let format = extension(out);
        if let Some((path, _)) = self.parts().find(|(path, _)| extension(path) != format) {
            let problem = format!("{} has another format than {}", path.display(), out.display());
            return Err(TableError::Parts(Message::new(problem, "a merge keeps the format of the parts")));
        }
        if let Some((path, _)) = self.parts().find(|(_, part)| part.columns.is_empty()) {
            let message = Message::new("the part is not a table", "its description has no columns");
            return Err(TableError::table(path, message));
        }
        match format.as_str() {
            "csv" if self.first().is_some_and(|part| part.columns.iter().any(is_row)) => self.merge_rows(out),
            "csv" => self.merge_csv(out),
            "npy" => npy::merge(self, out),
            #[cfg(feature = "parquet")]
            "parquet" => super::parquet::merge(self, out),
            // the description of parts of a format that this build lacks
            _ => crate::format::open(
                out,
                &crate::Schema::new(vec![crate::Column::new("x", crate::DType::F64)])?,
            )
            .map(|_| ()),
        }
    }

    /// Like `merge_csv`, for tables with numbers of rows.
    fn merge_rows(&self, out: &Path) -> Result<(), TableError> {
        let mut whole =
            csv::WriterBuilder::new().buffer_capacity(1 << 16).from_writer(AtomicFile::create(out)?);
        let failed = |error: csv::Error| TableError::io("write", out, error.into());
        let mut before = 0;
        for (number, (path, part)) in self.parts().enumerate() {
            let broken = |error: csv::Error| TableError::io("read", path, error.into());
            let is_row: Vec<bool> = part.columns.iter().map(is_row).collect();
            let mut reader = csv::ReaderBuilder::new().has_headers(false).from_path(path).map_err(broken)?;
            let (mut record, mut rows) = (csv::ByteRecord::new(), 0);
            while reader.read_byte_record(&mut record).map_err(broken)? {
                // the header counts as a row
                if rows == 0 && number == 0 {
                    whole.write_byte_record(&record).map_err(failed)?;
                }
                rows += 1;
                if rows == 1 {
                    continue;
                }
                for (field, &is_row) in record.iter().zip(&is_row) {
                    let row = is_row.then(|| std::str::from_utf8(field).ok()?.parse::<i64>().ok()).flatten();
                    match row.filter(|row| *row >= 0) {
                        Some(row) => whole.write_field((row + before).to_string()),
                        None => whole.write_field(field),
                    }
                    .map_err(failed)?;
                }
                whole.write_record(None::<&[u8]>).map_err(failed)?;
            }
            before += rows - 1;
        }
        let whole = whole.into_inner().map_err(|error| TableError::io("write", out, error.into_error()))?;
        whole.finish()
    }

    /// The header of the first part, then the rows of all parts.
    fn merge_csv(&self, out: &Path) -> Result<(), TableError> {
        let mut whole = AtomicFile::create(out)?;
        for (number, (path, _)) in self.parts().enumerate() {
            let file = File::open(path).map_err(|error| TableError::io("read", path, error))?;
            let (mut file, mut header) = (BufReader::with_capacity(1 << 16, file), Vec::new());
            // names of columns contain no line breaks
            file.read_until(b'\n', &mut header).map_err(|error| TableError::io("read", path, error))?;
            let start: &[u8] = if number == 0 { &header } else { &[] };
            let copied = whole.write_all(start).and_then(|()| io::copy(&mut file, &mut whole));
            copied.map_err(|error| TableError::io("write", out, error))?;
        }
        whole.finish()
    }
}

fn is_row(column: &super::PartColumn) -> bool {
    column.dtype == "row"
}
