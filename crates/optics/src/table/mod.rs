//! Tables of traced light: segments and light paths.

mod paths;
mod segments;

pub use paths::write_paths;
pub use segments::{LightSummary, SegmentFile, SegmentTable, trace_light};

use crate::OpticsError;
use rayweave_error::{Classified, ErrorKind};
use rayweave_table::TableError;

/// Light that cannot be traced into a table.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LightTableError {
    /// The light cannot be traced.
    #[error(transparent)]
    Optics(#[from] OpticsError),
    /// The table cannot be written.
    #[error(transparent)]
    Table(#[from] TableError),
}

impl Classified for LightTableError {
    fn kind(&self) -> ErrorKind {
        match self {
            LightTableError::Optics(error) => error.kind(),
            LightTableError::Table(error) => error.kind(),
        }
    }
}
