//! Clocks: wall-clock time and processor time of a thread.

use std::time::{Duration, Instant};

/// The kind of time that is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// Wall-clock time.
    #[default]
    Wall,
    /// Processor time of the thread: nearly the same on an idle machine, and still meaningful on a
    /// shared one. Falls back to wall-clock time if the system does not report it.
    Processor,
}

impl Clock {
    /// The duration of some work, in seconds.
    pub fn time(self, work: impl FnOnce()) -> f64 {
        match (self, processor_time()) {
            (Clock::Processor, Some(before)) => {
                work();
                processor_time().map_or(0.0, |after| after.saturating_sub(before).as_secs_f64())
            }
            _ => {
                let started = Instant::now();
                work();
                started.elapsed().as_secs_f64()
            }
        }
    }

    /// The clock for work on `threads` threads: processor time is available for a single thread only.
    pub fn on(self, threads: usize) -> Clock {
        if threads == 1 { self } else { Clock::Wall }
    }
}

/// The processor time of this thread so far.
#[cfg(unix)]
fn processor_time() -> Option<Duration> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Some(Duration::new(time.tv_sec.try_into().ok()?, time.tv_nsec.try_into().ok()?))
}

#[cfg(not(unix))]
fn processor_time() -> Option<Duration> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleep_takes_time_but_no_processor() {
        let nap = Duration::from_millis(20);
        let sleep = || std::thread::sleep(nap);
        assert!(Clock::Wall.time(sleep) >= nap.as_secs_f64());
        if cfg!(unix) {
            let processor = Clock::Processor.time(sleep);
            assert!((0.0..nap.as_secs_f64()).contains(&processor), "{processor}");
        }
        assert_eq!(Clock::Processor.on(2), Clock::Wall);
    }
}
