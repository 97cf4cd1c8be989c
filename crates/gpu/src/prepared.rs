//! Kernels that a program compiles when they are first used.

use crate::kernel::{Kernel, Slot};
use crate::shader::Entry;
use std::sync::Mutex;

/// A kernel with its buffers.
#[derive(Debug)]
pub(crate) struct Prepared {
    pub entry: Entry,
    pub kernel: Kernel,
    pub slot: Slot,
    /// The number of rays that fit into the buffers.
    pub batch: usize,
}

/// Kernels that are compiled when they are first used.
#[derive(Debug, Default)]
pub(crate) struct Others {
    pub first: Mutex<Option<Prepared>>,
    pub all: Mutex<Option<Prepared>>,
    pub start: Mutex<Option<Prepared>>,
}
