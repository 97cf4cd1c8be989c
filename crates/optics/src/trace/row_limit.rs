//! The limit of the rows of a run that are kept in one table: the available memory.

use crate::beam::Emitter;
use crate::error::OpticsError;
use crate::segments::Segments;
use crate::settings::TraceSettings;
use rayweave_model::memory::{self, Growth, Shortage};

/// Stops a run whose segments are kept in one table before memory runs out.
#[derive(Clone, Debug)]
pub struct RowLimit {
    rays: usize,
    growth: Growth,
}

impl RowLimit {
    /// The limit for the segments of a run.
    ///
    /// # Errors
    /// [`OpticsError::Memory`] if not even one row for each ray fits into memory.
    pub fn new(light: &impl Emitter, settings: &TraceSettings) -> Result<RowLimit, OpticsError> {
        let limit = RowLimit { rays: light.count(), growth: Growth::default() };
        // without rows for escaped light there may be any number of rows, even none
        match settings.keep_escaped {
            true => memory::check(limit.rays as u64, Segments::ROW)
                .map(|()| limit.clone())
                .map_err(|shortage| limit.error(shortage)),
            false => Ok(limit),
        }
    }

    /// Checks that the table may grow beyond a number of rows.
    ///
    /// # Errors
    /// [`OpticsError::Memory`].
    pub fn check(&mut self, rows: usize) -> Result<(), OpticsError> {
        let grown = self.growth.check((rows as u64).saturating_mul(Segments::ROW));
        grown.map_err(|shortage| self.error(shortage))
    }

    fn error(&self, shortage: Shortage) -> OpticsError {
        OpticsError::Memory { rays: self.rays, shortage }
    }
}
