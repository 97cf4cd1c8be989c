//! Kernels that a program compiles when they are first used.

use crate::kernel::Kernel;
use crate::shader::Entry;
use std::sync::{Arc, Mutex};

/// A kernel that was compiled for the last query of its kind.
pub(crate) type Prepared = Mutex<Option<(Entry, Arc<Kernel>)>>;

/// Kernels that are compiled when they are first used.
#[derive(Debug, Default)]
pub(crate) struct Others {
    pub pixels: Prepared,
    pub first: Prepared,
    pub all: Prepared,
    pub start: Prepared,
}
