//! How a picture is computed: threads, progress, the way to stop.

use crate::RenderError;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use std::convert::Infallible;
use std::num::NonZeroUsize;

/// Threads, a token to stop with, and somebody who wants to know how far the work is.
#[derive(Default)]
pub struct Run<'a> {
    /// The number of threads; see [`thread_count`] if it is not given.
    pub threads: Option<NonZeroUsize>,
    /// Stops the work soon after it is used.
    pub cancel: Cancel,
    /// Told the part of the work that is done, from 0 to 1, on the calling thread.
    pub progress: Option<&'a mut dyn FnMut(f64)>,
}

impl Run<'_> {
    /// Runs `work` on every piece; pieces are slices that the work writes to, so that nothing is left to merge.
    /// `done` is the part of all work that is over at the beginning and at the end of this stage.
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
