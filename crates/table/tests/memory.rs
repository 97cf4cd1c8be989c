//! Reading a long stream of rays takes constant memory. A separate test binary, because memory is measured per process.
#![cfg(target_os = "linux")]

use std::io::{self, Read};

use rayweave_table::{RAYS_PER_CHUNK, RayChunk, RayReader};

const LINE: &[u8] = b"0.1234567890123456,-0.1234567890123456,-1000.123456789,0.001,-0.002,0.999999999\n";

/// A generated stream: a header and many equal lines.
struct Stream {
    header: &'static [u8],
    lines: usize,
    at: usize,
}

impl Read for Stream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if !self.header.is_empty() {
            return self.header.read(buffer);
        }
        let mut count = 0;
        while self.lines > 0 && count < buffer.len() {
            let read = (&LINE[self.at..]).read(&mut buffer[count..])?;
            count += read;
            self.at = (self.at + read) % LINE.len();
            self.lines -= usize::from(self.at == 0);
        }
        Ok(count)
    }
}

/// The peak resident set size of this process, in KiB.
fn peak() -> usize {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    line.split_whitespace().nth(1).unwrap().parse().unwrap()
}

#[test]
fn memory_is_constant() {
    let lines = 400_000;
    let header = b"ox,oy,oz,dx,dy,dz\n";
    let stream = Stream { header, lines, at: 0 };
    let before = peak();
    let mut reader = RayReader::from_csv(stream, "stream").unwrap();
    let mut chunk = RayChunk::default();
    let mut rays = 0;
    loop {
        let read = reader.read(&mut chunk, RAYS_PER_CHUNK).unwrap();
        if read == 0 {
            break;
        }
        rays += read;
        assert!(chunk.origin[0].capacity() <= 2 * RAYS_PER_CHUNK);
    }
    assert_eq!(rays, lines);
    assert_eq!(reader.progress().done, (header.len() + lines * LINE.len()) as u64);
    // the stream has 32 MB, its rays 19 MB
    let grown = peak() - before;
    assert!(grown < 6 * 1024, "{grown} KiB");
}
