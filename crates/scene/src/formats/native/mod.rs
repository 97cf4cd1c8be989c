//! The native model file, in TOML.

mod fields;
mod foreign;
mod pieces;
mod quick;
mod read;
mod write;

pub(crate) use fields::Problems;
pub(crate) use read::{Kept, Reading, read, transform};
pub(crate) use write::write;

/// The version of the format that this crate reads and writes.
pub const VERSION: f64 = 1.0;
