//! Execution of a rendering: threads, progress, cancellation.

use crate::RenderError;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use std::convert::Infallible;
use std::num::NonZeroUsize;

/// Threads, cancellation token and progress callback of a rendering.
#[derive(Default)]
pub struct Run<'a> {
    /// The number of threads; by default [`thread_count`].
    pub threads: Option<NonZeroUsize>,
    /// Cancels the rendering soon after it is triggered.
    pub cancel: Cancel,
    /// Called on the calling thread with the fraction of the work done, from 0 to 1.
    pub progress: Option<&'a mut dyn FnMut(f64)>,
}

impl Run<'_> {
    /// Runs `work` on every piece; pieces contain the slices that the work writes to, so no merge is needed.
    /// `done` is the fraction of all work done at the beginning and at the end of this stage.
    pub(crate) fn each<I: Send, S>(
        &mut self,
        done: std::ops::Range<f64>,
        pieces: impl ExactSizeIterator<Item = I> + Send,
        scratch: impl Fn() -> S + Sync,
        work: impl Fn(&mut S, I) + Sync,
    ) -> Result<(), RenderError> {
        let count = pieces.len().max(1) as f64;
        let threads =
            thread_count(self.threads).min(NonZeroUsize::new(pieces.len()).unwrap_or(NonZeroUsize::MIN));
        let mut finished = 0.0;
        let progress = &mut self.progress;
        let tell = |()| {
            finished += 1.0;
            if let Some(progress) = progress {
                progress(done.start + (done.end - done.start) * (finished / count));
            }
            Ok::<(), Infallible>(())
        };
        drive(threads, &self.cancel, pieces, scratch, work, tell).map_err(|stopped| match stopped {
            Stopped::Cancelled => RenderError::Cancelled,
            Stopped::Failed(never) => match never {},
        })
    }
}
