//! Parallel driver: fixed chunks of work, ordered results, bounded memory, cancellation.
//!
//! The chunks do not depend on the number of threads, and results are merged in the order of the chunks, so that every
//! run gives the same bits on any machine. Chunks are pulled only as fast as results are merged: at most a few per
//! thread exist at any time. Work that is not divided into chunks, such as reading a file, can run [`aside`].

use rayweave_error::{Classified, ErrorKind};
use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock};
use std::time::Duration;

/// A cancellation token: stops a run from another thread or a signal handler.
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// A token that is not cancelled.
    pub fn new() -> Cancel {
        Cancel::default()
    }

    /// Makes every run that holds this token stop soon.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// True after [`Cancel::cancel`] was called.
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Inside work started by [`aside`] or [`Cancel::while_current`]: its token. Elsewhere: a new token, which nothing
    /// cancels.
    pub fn current() -> Cancel {
        CURRENT.with_borrow(|current| current.clone().unwrap_or_default())
    }

    /// Runs work with this token as [`Cancel::current`], for work that checks a token without a parameter for it, such as the compilation of solids.
    pub fn while_current<T>(&self, work: impl FnOnce() -> T) -> T {
        /// Restores the previous token, even after a panic.
        struct Restore(Option<Cancel>);
        impl Drop for Restore {
            fn drop(&mut self) {
                CURRENT.set(self.0.take());
            }
        }
        let _restore = Restore(CURRENT.replace(Some(self.clone())));
        work()
    }
}

thread_local! {
    static CURRENT: RefCell<Option<Cancel>> = const { RefCell::new(None) };
}

/// Interval at which [`aside`] calls `look`.
const LOOK: Duration = Duration::from_millis(50);

/// Stack size of a thread for [`aside`], in bytes: at least that of usual main threads.
const STACK: usize = 16 << 20;

/// Runs `work` on a thread of its own and returns its result, for work that does not check a token often enough. Meanwhile the
/// calling thread calls `look` every 50 ms.
///
/// An error of `look` is returned at once: the work is cancelled ([`Cancel::current`]) and its result dropped, but it may go on
/// for a while. A panic in `work` is propagated. If no thread can be started, `work` runs on the calling thread, without `look`
/// and without cancellation.
pub fn aside<T: Send + 'static, E>(
    work: impl FnOnce() -> T + Send + 'static,
    mut look: impl FnMut() -> Result<(), E>,
) -> Result<T, E> {
    let (sender, receiver) = sync_channel(1);
    let cancel = Cancel::new();
    let own = cancel.clone();
    let work = Arc::new(Mutex::new(Some(work)));
    let shared = work.clone();
    let take = |work: &Mutex<Option<_>>| work.lock().ok().and_then(|mut work| work.take());
    let run = move || {
        if let Some(work) = take(&shared) {
            // nobody receives it after an error of `look`
            let _ = sender.send(own.while_current(work));
        }
    };
    let thread = match std::thread::Builder::new().stack_size(STACK).spawn(run) {
        Ok(thread) => thread,
        // no thread can be started: the work runs here, where it cannot be cancelled
        Err(error) => match take(&work) {
            Some(work) => return Ok(work()),
            None => unreachable!("a thread that did not start took work: {error}"),
        },
    };
    loop {
        match receiver.recv_timeout(LOOK) {
            Ok(result) => return Ok(result),
            Err(RecvTimeoutError::Timeout) => look().inspect_err(|_| cancel.cancel())?,
            Err(RecvTimeoutError::Disconnected) => match thread.join() {
                Err(panic) => std::panic::resume_unwind(panic),
                Ok(()) => unreachable!("the work ended without a result"),
            },
        }
    }
}

/// The reason why a run ended early.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Stopped<E> {
    /// The token was cancelled.
    #[error("cancelled")]
    Cancelled,
    /// Merging a result failed.
    #[error(transparent)]
    Failed(#[from] E),
}

impl<E: Classified> Classified for Stopped<E> {
    fn kind(&self) -> ErrorKind {
        match self {
            Stopped::Cancelled => ErrorKind::Cancelled,
            Stopped::Failed(error) => error.kind(),
        }
    }
}

/// Upper limit of the number of threads: on current machines, additional threads only wait for each other.
const MAX_THREADS: NonZeroUsize = NonZeroUsize::new(1024).unwrap();

/// Number of threads: `requested` if given, else the environment variable `RAYWEAVE_THREADS`, else the number of
/// logical CPUs that the process may use; at most 1024. A value of the variable that is not a positive integer is ignored.
pub fn thread_count(requested: Option<NonZeroUsize>) -> NonZeroUsize {
    let from_variable = || std::env::var("RAYWEAVE_THREADS").ok()?.trim().parse().ok();
    requested.or_else(from_variable).unwrap_or_else(cores).min(MAX_THREADS)
}

/// Number of logical CPUs that the process may use, cached: the system call takes longer than tracing a thousand rays.
fn cores() -> NonZeroUsize {
    static CORES: OnceLock<NonZeroUsize> = OnceLock::new();
    *CORES.get_or_init(|| std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN))
}

/// Number of chunks per thread that may be pulled but not yet merged.
const AHEAD: usize = 3;

/// Runs `work` on every chunk and merges the results in the order of the chunks.
///
/// The calling thread is one of the `threads`. Each thread makes its own scratch once. `merge` runs on the calling
/// thread. The iterator may wait for its source, as for requests that arrive one by one: results are merged meanwhile. An error of `merge` ends the run, and so does cancellation, which is checked before each chunk and each
/// merge. A panic in `work` causes a panic here.
pub fn drive<I, O, S, E>(
    threads: NonZeroUsize,
    cancel: &Cancel,
    chunks: impl Iterator<Item = I> + Send,
    scratch: impl Fn() -> S + Sync,
    work: impl Fn(&mut S, I) -> O + Sync,
    mut merge: impl FnMut(O) -> Result<(), E>,
) -> Result<(), Stopped<E>>
where
    I: Send,
    O: Send,
{
    if threads.get() == 1 {
        return drive_here(cancel, chunks, scratch, work, merge);
    }
    let helpers = threads.get() - 1;
    let queue = Queue::new(chunks, AHEAD * threads.get(), helpers);
    std::thread::scope(|scope| {
        for _ in 0..helpers {
            scope.spawn(|| {
                let _guard = Leaving(&queue);
                let mut scratch = scratch();
                while let Some((number, chunk)) = queue.next(cancel) {
                    queue.deliver(number, work(&mut scratch, chunk));
                }
            });
        }
        let _guard = Closing(&queue);
        queue.merge_all(cancel, &mut scratch(), &work, &mut merge)
    })
}

fn drive_here<I, O, S, E>(
    cancel: &Cancel,
    chunks: impl Iterator<Item = I>,
    scratch: impl Fn() -> S,
    work: impl Fn(&mut S, I) -> O,
    mut merge: impl FnMut(O) -> Result<(), E>,
) -> Result<(), Stopped<E>> {
    let mut scratch = scratch();
    for chunk in chunks {
        if cancel.is_cancelled() {
            return Err(Stopped::Cancelled);
        }
        let result = work(&mut scratch, chunk);
        if cancel.is_cancelled() {
            return Err(Stopped::Cancelled);
        }
        merge(result)?;
    }
    if cancel.is_cancelled() { Err(Stopped::Cancelled) } else { Ok(()) }
}

/// Number of pulled chunks that may wait for a thread.
const READY: usize = 2;

/// Chunks to be processed and results to be merged.
///
/// The calling thread never pulls chunks: their iterator may wait for its source, such as a pipe, and finished results are merged
/// meanwhile. A chunk that was pulled does not wait for the next one either, because one thread pulls at a time, without the lock of
/// the state, and all others take chunks that are ready.
struct Queue<C, I, O> {
    chunks: Mutex<C>,
    state: Mutex<QueueState<I, O>>,
    changed: Condvar,
    ahead: usize,
}

struct QueueState<I, O> {
    /// Pulled chunks with their numbers, lowest first.
    ready: VecDeque<(usize, I)>,
    /// True while a thread pulls a chunk.
    pulling: bool,
    /// Number of the next chunk to pull.
    pulled: usize,
    /// Number of the next result to merge.
    merged: usize,
    results: BTreeMap<usize, O>,
    /// Threads other than the calling one that are still running.
    helpers: usize,
    /// Threads that wait for a change; [`Queue::change`] notifies only if it is not 0.
    waiting: usize,
    /// True if no further chunk will be pulled.
    closed: bool,
}

/// Next step of the calling thread.
enum Turn<I, O> {
    Merge(O),
    Work(usize, I),
    Done,
}

impl<I, C: Iterator<Item = I>, O> Queue<C, I, O> {
    fn new(chunks: C, ahead: usize, helpers: usize) -> Self {
        let state = QueueState {
            ready: VecDeque::new(),
            pulling: false,
            pulled: 0,
            merged: 0,
            results: BTreeMap::new(),
            helpers,
            waiting: 0,
            closed: false,
        };
        Queue { chunks: Mutex::new(chunks), state: Mutex::new(state), changed: Condvar::new(), ahead }
    }

    fn lock(&self) -> MutexGuard<'_, QueueState<I, O>> {
        // after a panic under the lock the counters are still consistent
        self.state.lock().unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    fn wait<'a>(&self, mut guard: MutexGuard<'a, QueueState<I, O>>) -> MutexGuard<'a, QueueState<I, O>> {
        guard.waiting += 1;
        let mut guard = self.changed.wait(guard).unwrap_or_else(|poisoned| poisoned.into_inner());
        guard.waiting -= 1;
        guard
    }

    /// Changes the state and wakes the waiting threads.
    fn change(&self, change: impl FnOnce(&mut QueueState<I, O>)) {
        let mut state = self.lock();
        change(&mut state);
        if state.waiting > 0 {
            self.changed.notify_all();
        }
    }

    /// The next chunk with its number for a thread other than the calling one, after waiting until the merge is near enough; `None`
    /// at the end or after cancellation.
    fn next(&self, cancel: &Cancel) -> Option<(usize, I)> {
        loop {
            let mut state = self.lock();
            loop {
                if cancel.is_cancelled() {
                    return None;
                }
                let may_pull = !state.closed && !state.pulling && state.pulled < state.merged + self.ahead;
                if may_pull && state.ready.len() < READY {
                    break;
                }
                if let Some(chunk) = state.ready.pop_front() {
                    return Some(chunk);
                }
                if state.closed {
                    return None;
                }
                state = self.wait(state);
            }
            state.pulling = true;
            drop(state);
            let chunk = self.chunks.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).next();
            self.change(|state| {
                state.pulling = false;
                match chunk {
                    Some(chunk) => {
                        state.ready.push_back((state.pulled, chunk));
                        state.pulled += 1;
                    }
                    None => state.closed = true,
                }
            });
        }
    }

    fn deliver(&self, number: usize, result: O) {
        self.change(|state| _ = state.results.insert(number, result));
    }

    /// Merges results in order, and processes chunks while the next result is missing, until all are merged.
    fn merge_all<S, E>(
        &self,
        cancel: &Cancel,
        scratch: &mut S,
        work: &impl Fn(&mut S, I) -> O,
        merge: &mut impl FnMut(O) -> Result<(), E>,
    ) -> Result<(), Stopped<E>> {
        loop {
            let turn = self.turn();
            if cancel.is_cancelled() {
                return Err(Stopped::Cancelled);
            }
            match turn {
                Turn::Merge(result) => {
                    merge(result)?;
                    self.change(|state| state.merged += 1);
                }
                Turn::Work(number, chunk) => self.deliver(number, work(scratch, chunk)),
                Turn::Done => return Ok(()),
            }
        }
    }

    fn turn(&self) -> Turn<I, O> {
        let mut state = self.lock();
        loop {
            let next = state.merged;
            if let Some(result) = state.results.remove(&next) {
                return Turn::Merge(result);
            }
            if let Some((number, chunk)) = state.ready.pop_front() {
                if state.waiting > 0 {
                    // there is room for another chunk
                    self.changed.notify_all();
                }
                return Turn::Work(number, chunk);
            }
            if state.helpers == 0 {
                return Turn::Done;
            }
            state = self.wait(state);
        }
    }
}

/// Releases waiting threads when the calling thread stops merging, even by a panic.
struct Closing<'a, I, C: Iterator<Item = I>, O>(&'a Queue<C, I, O>);

impl<I, C: Iterator<Item = I>, O> Drop for Closing<'_, I, C, O> {
    fn drop(&mut self) {
        self.0.change(|state| {
            state.closed = true;
            state.ready.clear();
        });
    }
}

/// Counts a thread out when it ends, even by a panic, so that the merge cannot wait forever.
struct Leaving<'a, I, C: Iterator<Item = I>, O>(&'a Queue<C, I, O>);

impl<I, C: Iterator<Item = I>, O> Drop for Leaving<'_, I, C, O> {
    fn drop(&mut self) {
        self.0.change(|state| {
            state.helpers -= 1;
            // a panic of the iterator: nobody pulls any more
            state.closed |= std::thread::panicking();
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicUsize;

    fn threads(n: usize) -> NonZeroUsize {
        NonZeroUsize::new(n).unwrap()
    }

    #[test]
    fn results_come_in_order_whatever_the_threads() {
        for n in [1, 2, 7] {
            let mut seen = Vec::new();
            let work = |_: &mut (), k: u64| {
                std::thread::sleep(std::time::Duration::from_micros(k * 7919 % 300));
                k * k
            };
            let merge = |r| {
                seen.push(r);
                Ok::<(), ()>(())
            };
            drive(threads(n), &Cancel::new(), 0..200, || (), work, merge).unwrap();
            assert_eq!(seen, (0..200).map(|k| k * k).collect::<Vec<u64>>());
        }
    }

    #[test]
    fn few_chunks_exist_at_a_time() {
        let (made, merged) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let most = AtomicUsize::new(0);
        let chunks = (0..1000).inspect(|_| {
            let ahead = made.fetch_add(1, Ordering::SeqCst) + 1 - merged.load(Ordering::SeqCst);
            most.fetch_max(ahead, Ordering::SeqCst);
        });
        let merge = |()| {
            merged.fetch_add(1, Ordering::SeqCst);
            Ok::<(), ()>(())
        };
        drive(threads(2), &Cancel::new(), chunks, || (), |_, _| (), merge).unwrap();
        assert_eq!(merged.load(Ordering::SeqCst), 1000);
        assert!(most.load(Ordering::SeqCst) <= 2 * AHEAD + 1);
    }

    #[test]
    fn results_are_merged_while_the_next_chunk_is_awaited() {
        for n in 1..=8 {
            let (merged, was_merged) = std::sync::mpsc::channel();
            // each chunk comes after the result of the one before, as from a client that waits for its answers
            let chunks = (0..20).map_while(move |k: u32| {
                let is_answered = k == 0 || was_merged.recv_timeout(Duration::from_secs(20)) == Ok(k - 1);
                is_answered.then_some(k)
            });
            let mut count = 0;
            let merge = |k: u32| {
                count += 1;
                // nobody receives it after the last chunk
                let _ = merged.send(k);
                Ok::<(), ()>(())
            };
            drive(threads(n), &Cancel::new(), chunks, || (), |_, k| k, merge).unwrap();
            assert_eq!(count, 20, "{n} threads");
        }
    }

    #[test]
    fn a_panic_of_the_iterator_is_passed_on() {
        for n in [1, 2, 4] {
            let chunks = (0..100).inspect(|k| assert!(*k < 50));
            let run = || drive(threads(n), &Cancel::new(), chunks, || (), |_, _| (), |()| Ok::<(), ()>(()));
            assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(run)).is_err());
        }
    }

    #[test]
    fn a_stopped_run_has_the_kind_of_its_cause() {
        assert_eq!(Stopped::<crate::BadRay>::Cancelled.kind(), ErrorKind::Cancelled);
        let bad = crate::BadRay { ray: 0, problem: rayweave_shape::RayError::NoDirection };
        assert_eq!(Stopped::Failed(bad).kind(), ErrorKind::Value);
    }

    #[test]
    fn errors_and_cancelling_stop_the_run() {
        for n in [1, 3] {
            let merge = |k: usize| if k < 10 { Ok(()) } else { Err("full") };
            let failed = drive(threads(n), &Cancel::new(), 0.., || (), |_, k| k, merge);
            assert_eq!(failed, Err(Stopped::Failed("full")));
            let cancel = Cancel::new();
            let mut count = 0;
            let merge = |_| {
                count += 1;
                if count == 5 {
                    cancel.cancel();
                }
                Ok::<(), ()>(())
            };
            assert_eq!(drive(threads(n), &cancel, 0usize.., || (), |_, k| k, merge), Err(Stopped::Cancelled));
            assert_eq!(count, 5);
        }
    }

    #[test]
    fn work_aside_is_abandoned_at_once_and_told_so() {
        assert_eq!(aside(|| 7, || Err(())), Ok(7));
        let (told, heard) = std::sync::mpsc::channel();
        let work = move || {
            let cancel = Cancel::current();
            while !cancel.is_cancelled() {
                std::thread::sleep(Duration::from_millis(1));
            }
            told.send(()).unwrap();
            // longer than anyone waits
            std::thread::sleep(Duration::from_secs(5));
        };
        let start = std::time::Instant::now();
        assert_eq!(aside(work, || Err("stop")), Err("stop"));
        assert!(start.elapsed() < Duration::from_secs(4));
        heard.recv_timeout(Duration::from_secs(4)).unwrap();
        assert!(!Cancel::current().is_cancelled());
        let panics = || aside(|| assert!(LOOK.is_zero()), || Ok::<(), ()>(()));
        assert!(std::panic::catch_unwind(panics).is_err());
    }

    #[test]
    fn a_panic_is_passed_on() {
        let run = || {
            drive(threads(2), &Cancel::new(), 0..100, || (), |_, k| assert!(k < 50), |()| Ok::<(), ()>(()))
        };
        assert!(std::panic::catch_unwind(run).is_err());
    }
}
