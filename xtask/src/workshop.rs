//! What the stages of a run share.

use crate::python::Python;
use crate::repository::Repository;
use crate::slowest::Slowest;

/// What the stages share.
pub struct Workshop<'a> {
    /// The checkout under test.
    pub repository: &'a Repository,
    /// The Python of this run.
    pub python: Python,
    /// The slowest test programs so far.
    pub slowest: Slowest,
}
