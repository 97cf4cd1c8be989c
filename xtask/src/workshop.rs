//! Shared state of the stages of a run.

use crate::profile::Profile;
use crate::python::Python;
use crate::repository::Repository;
use crate::slowest::Slowest;

/// Shared state of the stages of a run.
pub struct Workshop<'a> {
    /// The checkout under test.
    pub repository: &'a Repository,
    /// Cargo's profile for the command.
    pub profile: Profile,
    /// The Python of this run.
    pub python: Python,
    /// The slowest test programs so far.
    pub slowest: Slowest,
}
