//! The part of a root-ray inside a window of times.

use crate::{RootRay, RootRayError};

impl<S: Clone> RootRay<S> {
    /// The crossings with `t_min < t < t_max`, and the side just after `t_min` as the start side. Either end may be infinite.
    ///
    /// A root at `t_min` is dropped and inverts the start; a root at `t_max` is dropped. The result continues to infinity on the
    /// sides on which the trajectory enters and leaves the window.
    ///
    /// # Errors
    /// `NanWindow` if an end is NaN, `EmptyWindow` unless `t_min < t_max`.
    pub fn clip(&self, t_min: f64, t_max: f64) -> Result<Self, RootRayError> {
        check_window(t_min, t_max)?;
        let first = self.count_until(t_min);
        let end = self.roots().partition_point(|root| root.t < t_max);
        Ok(Self::from_ordered(self.start().after(first), self.roots()[first..end].to_vec()))
    }
}

fn check_window(t_min: f64, t_max: f64) -> Result<(), RootRayError> {
    if t_min.is_nan() || t_max.is_nan() {
        return Err(RootRayError::NanWindow { t_min, t_max });
    }
    if t_min >= t_max {
        return Err(RootRayError::EmptyWindow { t_min, t_max });
    }
    Ok(())
}
