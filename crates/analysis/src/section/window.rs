//! Window and accuracy of a section, and options of its run.

use super::SectionError;
use rayweave_model::drive::Cancel;
use std::num::NonZeroUsize;

/// The greatest number of columns.
const MAX_COLUMNS: u32 = 1 << 16;

/// The window of a section, and its accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionWindow {
    /// The lower left corner of the window.
    pub lo: [f64; 2],
    /// The upper right corner of the window.
    pub hi: [f64; 2],
    /// The largest distance of edges from the surfaces, in the unit of the model.
    pub tolerance: f64,
    /// The minimum number of columns, from 2 to 65,536.
    pub columns: u32,
}

impl SectionWindow {
    /// A window with 512 columns and a tolerance of 1/20,000 of its larger side.
    pub fn new(lo: [f64; 2], hi: [f64; 2]) -> SectionWindow {
        let tolerance = 5e-5 * (hi[0] - lo[0]).max(hi[1] - lo[1]);
        SectionWindow { lo, hi, tolerance, columns: 512 }
    }

    /// Checks that the window has an area, and that tolerance and number of columns are in range.
    pub(super) fn check(&self) -> Result<(), SectionError> {
        let [lo, hi] = [self.lo, self.hi];
        let is_window =
            [lo, hi].as_flattened().iter().all(|x| x.is_finite()) && lo[0] < hi[0] && lo[1] < hi[1];
        match () {
            () if !is_window => Err(SectionError::Window { lo, hi }),
            () if !(self.tolerance > 0.0 && self.tolerance.is_finite()) => {
                Err(SectionError::Tolerance { tolerance: self.tolerance })
            }
            () if !(2..=MAX_COLUMNS).contains(&self.columns) => {
                Err(SectionError::Columns { columns: self.columns })
            }
            () => Ok(()),
        }
    }
}

/// The options of a run.
#[derive(Clone, Debug, Default)]
pub struct SectionRun {
    /// The number of threads; by default that of [`thread_count`](rayweave_model::drive::thread_count).
    /// Results do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Cancels the run.
    pub cancel: Cancel,
}
