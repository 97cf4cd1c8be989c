//! File formats of scenes, one folder each.

pub mod native;
pub mod povray;
