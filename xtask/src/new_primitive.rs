//! Placeholder during development.
use crate::{Outcome, repository::Repository};
pub fn run(_: &Repository, _: &str) -> Outcome {
    Ok(())
}
