//! The memory that a trace needs does not grow with the number of rays.
#![cfg(target_os = "linux")]

use crate::bench::{Bench, RAYS, done};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::process::Child;
use std::time::Duration;

/// Writes rays along x until the file has this size, and returns their number.
fn write_rays(bench: &Bench, bytes: usize) -> usize {
    let mut file = BufWriter::new(File::create(bench.path("rays.csv")).unwrap());
    file.write_all(RAYS.as_bytes()).unwrap();
    let mut written = RAYS.len();
    let mut count = 0;
    while written < bytes {
        // the digits differ from ray to ray; some rays hit, some miss
        let y = (count % 30_011) as f64 / 20_000.0;
        let line = format!("-5.0000000000001,{y:.12},0.0000000000001,1.0000000000001,0,0\n");
        file.write_all(line.as_bytes()).unwrap();
        written += line.len();
        count += 1;
    }
    file.flush().unwrap();
    count
}

/// The peak memory of the process so far, in MiB; `None` after it has ended.
fn peak(child: &Child) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib / 1024.0)
}

/// Traces a file of rays of this size and returns the peak memory in MiB.
fn peak_of_trace(bytes: usize) -> f64 {
    let bench = Bench::new();
    let rays = write_rays(&bench, bytes);
    let arguments = ["trace", "ball.toml", "--rays", "rays.csv", "-o", "hits.csv", "--threads", "4"];
    let mut child = bench.command(&arguments).spawn().unwrap();
    let mut most = 0.0;
    while child.try_wait().unwrap().is_none() {
        most = peak(&child).map_or(most, |now: f64| now.max(most));
        std::thread::sleep(Duration::from_millis(2));
    }
    let done = done(child.wait_with_output().unwrap());
    assert_eq!((done.code, done.err.as_str()), (0, ""));
    assert!(done.out.ends_with(&format!(" of {rays} rays\n")), "{}", done.out);
    assert!(most > 1.0, "the process was never seen");
    most
}

#[test]
fn twenty_megabytes_of_rays_take_no_more_than_two() {
    let (small, large) = (peak_of_trace(2_000_000), peak_of_trace(20_000_000));
    assert!(large < 64.0, "{large} MiB");
    assert!(large < small + 16.0, "{small} and {large} MiB");
}

#[test]
#[ignore = "writes a file of 1 GB"]
fn long_a_gigabyte_of_rays_fits_into_300_megabytes() {
    let most = peak_of_trace(1_000_000_000);
    assert!(most < 300.0, "{most} MiB");
}
