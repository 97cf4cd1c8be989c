//! Ctrl-C and termination signals (SIGTERM, SIGHUP) end the command at any time, without leaving unfinished files.

use crate::failure::Failure;
use rayweave::model::drive::{Cancel, aside};
use rayweave::table::AtomicFile;
use std::io::{self, Read};
use std::sync::OnceLock;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

/// The time that the command has after a signal to end by itself. Runs check [`token`] between their tasks; reading files and
/// compiling models check it only rarely. Together with the time in which the system frees the memory of a large model, it stays
/// below half a second.
const PATIENCE: Duration = Duration::from_millis(150);

/// The time after a signal in which the command may remove its unfinished files itself. It cannot while it waits for a pipe that
/// nobody reads.
const LAST_PATIENCE: Duration = Duration::from_secs(2);

/// The token that Ctrl-C and termination signals cancel.
pub fn token() -> Cancel {
    static TOKEN: OnceLock<Cancel> = OnceLock::new();
    TOKEN.get_or_init(Cancel::new).clone()
}

/// Runs the command on a separate thread and ends it soon after a signal: at the next check of [`token`], at any point where it
/// has no unfinished file, or after [`LAST_PATIENCE`], which removes its unfinished files.
pub fn watch(command: impl FnOnce() -> Result<(), Failure> + Send + 'static) -> Result<(), Failure> {
    let (cancel, own) = (token(), token());
    ctrlc::set_handler(move || own.cancel())
        .map_err(|error| Failure::Run(format!("cannot listen for Ctrl-C: {error}.")))?;
    let mut signalled = None;
    let look = || {
        if !cancel.is_cancelled() {
            return Ok(());
        }
        let waited = signalled.get_or_insert_with(Instant::now).elapsed();
        if waited >= LAST_PATIENCE {
            AtomicFile::abandon_all();
        }
        match waited >= PATIENCE && AtomicFile::none_from_now_on() {
            true => Err(Failure::Cancelled),
            false => Ok(()),
        }
    };
    aside(|| token().while_current(command), look)?
}

/// A reader of a source that may block forever, such as a pipe. A separate thread reads the
/// source, so a waiting reader can be cancelled.
pub struct Interruptible {
    blocks: Receiver<io::Result<Vec<u8>>>,
    block: Vec<u8>,
    used: usize,
    cancel: Cancel,
}

/// Interval at which a waiting reader checks its token.
const LOOK: Duration = Duration::from_millis(50);

impl Interruptible {
    /// Opens the source and starts the thread.
    pub fn new<R: Read>(
        open: impl FnOnce() -> io::Result<R> + Send + 'static,
        cancel: Cancel,
    ) -> Interruptible {
        let (sender, blocks) = sync_channel(4);
        // not joined, because it may block forever
        thread::spawn(move || {
            let mut source = match open() {
                Ok(source) => source,
                Err(error) => return drop(sender.send(Err(error))),
            };
            loop {
                let mut block = vec![0; 1 << 16];
                let read = source.read(&mut block);
                let is_end = matches!(read, Ok(0));
                let is_over = match read {
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
                    Err(error) => sender.send(Err(error)).is_err(),
                    Ok(length) => {
                        block.truncate(length);
                        sender.send(Ok(block)).is_err()
                    }
                };
                if is_end || is_over {
                    return;
                }
            }
        });
        Interruptible { blocks, block: Vec::new(), used: 0, cancel }
    }

    /// The next block; empty at the end.
    fn next(&self) -> io::Result<Vec<u8>> {
        loop {
            if self.cancel.is_cancelled() {
                return Err(io::Error::other("cancelled"));
            }
            match self.blocks.recv_timeout(LOOK) {
                Ok(block) => return block,
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => return Ok(Vec::new()),
            }
        }
    }
}

impl Read for Interruptible {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.used == self.block.len() {
            self.block = self.next()?;
            self.used = 0;
        }
        let rest = &self.block[self.used..];
        let length = rest.len().min(buffer.len());
        buffer[..length].copy_from_slice(&rest[..length]);
        self.used += length;
        Ok(length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_arrive_in_order() {
        let text: Vec<u8> = (0..1_000_000u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        let source = text.clone();
        let mut reader = Interruptible::new(move || Ok(io::Cursor::new(source)), Cancel::new());
        let mut read = Vec::new();
        reader.read_to_end(&mut read).unwrap();
        assert_eq!(read, text);
    }

    #[test]
    fn an_error_arrives() {
        let refuse = || Err::<io::Empty, _>(io::Error::from(io::ErrorKind::PermissionDenied));
        let error = Interruptible::new(refuse, Cancel::new()).read(&mut [0]).unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::PermissionDenied);
    }

    #[test]
    fn a_waiting_reader_can_be_cancelled() {
        struct Never;
        impl Read for Never {
            fn read(&mut self, _: &mut [u8]) -> io::Result<usize> {
                thread::sleep(Duration::from_secs(3600));
                Ok(0)
            }
        }
        let cancel = Cancel::new();
        let mut reader = Interruptible::new(|| Ok(Never), cancel.clone());
        let waiting = thread::spawn(move || reader.read(&mut [0]).is_err());
        cancel.cancel();
        assert!(waiting.join().unwrap());
    }
}
