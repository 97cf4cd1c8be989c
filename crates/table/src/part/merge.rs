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
            "csv" => self.merge_csv(out),
            "npy" => npy::merge(self, out),
            #[cfg(feature = "parquet")]
            "parquet" => super::parquet::merge(self, out),
            // the description of parts of a format that this build lacks
            _ => crate::format::open(out, &crate::Schema::new(vec![crate::Column::new("x", crate::DType::F64)])?)
                .map(|_| ()),
        }
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
