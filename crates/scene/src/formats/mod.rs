//! File formats, one folder each.

pub mod native;
pub mod povray;
