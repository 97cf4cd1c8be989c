//! Tables and ray files: streaming writers of CSV, NPY and Parquet, atomic output files, and streaming readers of rays.
//!
//! This crate is about columns, not geometry:
//!
//! - [`TableWriter`] writes a table (names, types, units) as CSV, NPY or, with the cargo feature `parquet`, Parquet.
//! - [`AtomicFile`] is an output file that appears complete or not at all.
//! - [`AllowedFiles`] decides which files a model may read.
//! - [`NpyArray`] is a whole array of float64 numbers, read from an NPY file.
//! - [`NpySingles`] writes an NPY array of float32 numbers row by row.
//! - [`TableReader`] reads a table row by row.
//! - [`Part`] describes a part of a table, a range of its rays; [`PartSet`] joins the parts to the whole.
//! - [`TextIds`] numbers texts.
//! - [`RayReader`] reads rays from CSV or NPY in constant memory and reports every problem with its location.
//!
//! ```
//! use rayweave_table::{Chunk, Column, DType, Schema, TableWriter};
//!
//! # let path = std::env::temp_dir().join(format!("rayweave-table-doc-{}.csv", std::process::id()));
//! let media = ["air".to_string(), "glass".to_string()].into();
//! let schema = Schema::new(vec![
//!     Column::new("t", DType::F64).unit("mm"),
//!     Column::new("enters", DType::Bool),
//!     Column::names("medium", media),
//! ])?;
//! let mut table = TableWriter::create(&path, &schema)?;
//! table.write(&Chunk::new(vec![vec![0.5, 2.0].into(), vec![true, false].into(), vec![1, 0_u32].into()])?)?;
//! table.finish()?;
//! assert_eq!(std::fs::read_to_string(&path)?, "t,enters,medium\n0.5,true,glass\n2.0,false,air\n");
//! # std::fs::remove_file(&path)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod allowed;
mod atomic;
mod chunk;
mod content_hash;
mod error;
mod format;
mod nearby;
mod npy_array;
mod npy_header;
mod npy_singles;
mod opened;
mod part;
mod rays;
mod read;
mod reason;
mod schema;
mod text_ids;
mod writer;

pub use allowed::{AllowedFiles, RefusedFile};
pub use atomic::AtomicFile;
pub use chunk::{Chunk, Values};
pub use content_hash::ContentHash;
pub use error::{RayProblem, RayProblems, TableError};
pub use nearby::{nearby_files, nearby_sentence};
pub use npy_array::{NpyArray, NpyArrayError, read_npy_words};
pub use npy_singles::NpySingles;
pub use opened::{FileStamp, record_opened};
pub use part::{Counts, Part, PartSet, missing_ranges};
pub use rays::{LIGHT_COLUMNS, Progress, RAY_COLUMNS, RAYS_PER_CHUNK, RayChunk, RayReader};
pub use read::{TableReader, TableRow};
pub use schema::{Column, DType, NO_NAME, Schema};
pub use text_ids::TextIds;
pub use writer::TableWriter;
