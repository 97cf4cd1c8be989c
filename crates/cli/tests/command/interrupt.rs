//! Ctrl-C and termination signals in the middle of a run.
#![cfg(target_os = "linux")]

use crate::bench::{Bench, Done, RAYS, done, holds};
use std::io::Write;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

fn interrupt(child: &Child) {
    send(child, "-INT");
}

fn send(child: &Child, signal: &str) {
    let id = child.id().to_string();
    let status = Command::new("kill").args([signal, &id]).status().unwrap();
    assert!(status.success());
}

/// True if the process has a handler for SIGINT, signal 2, which is bit 1 of the mask
/// (proc_pid_status(5)).
fn listens(child: &Child) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
    u64::from_str_radix(mask.trim(), 16).unwrap() & 0b10 != 0
}

/// Waits until `ready`, at most half a minute.
fn wait_until(ready: impl Fn() -> bool) {
    let start = Instant::now();
    while !ready() {
        assert!(start.elapsed() < Duration::from_secs(30), "nothing happens");
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn assert_cancelled(bench: &Bench, done: Done) {
    assert_eq!((done.code, done.err.as_str()), (130, "error: cancelled: unfinished files were removed.\n"));
    assert_eq!(bench.files(), ["ball.toml", "cemented.toml"]);
}

fn trace(bench: &Bench) -> Child {
    let arguments = ["trace", "ball.toml", "--rays", "-", "-o", "hits.csv"];
    let mut command = bench.command(&arguments);
    command.stdin(Stdio::piped()).spawn().unwrap()
}

/// A model file that is a pipe without a writer never finishes loading.
#[test]
fn loading_can_be_interrupted() {
    let rest: [&[&str]; 5] = [
        &["trace", "endless.toml", "--rays", "-", "-o", "hits.csv"],
        &["optics", "endless.toml", "--out", "light.csv"],
        &["render", "endless.toml"],
        &["info", "endless.toml"],
        &["convert", "endless.toml", "other.csg"],
    ];
    for (arguments, signal) in rest.into_iter().zip(["-INT", "-TERM", "-HUP", "-INT", "-TERM"]) {
        let bench = Bench::new();
        assert!(Command::new("mkfifo").arg(bench.path("endless.toml")).status().unwrap().success());
        let child = bench.command(arguments).spawn().unwrap();
        wait_until(|| listens(&child));
        send(&child, signal);
        let done = done(child.wait_with_output().unwrap());
        std::fs::remove_file(bench.path("endless.toml")).unwrap();
        assert_cancelled(&bench, done);
    }
}

#[test]
fn compiling_can_be_interrupted() {
    // 2^18 spheres, each at a different position, intersected with a different sphere
    let mut model = "rayweave = 1\n[solid.s0]\nsphere = { radius = 1 }\n".to_owned();
    for k in 0..18 {
        let next = k + 1;
        model += &format!(
            "[solid.t{next}]\nexpr = \"s{k}\"\ntransform = [{{ translate = [{}, 0.5, 0] }}]\n",
            1 << k
        );
        model += &format!("[solid.s{next}]\nexpr = \"s{k} ^ t{next}\"\n");
    }
    for signal in ["-INT", "-TERM"] {
        let bench = Bench::new();
        bench.write("ball.toml", &model);
        let child = trace(&bench);
        wait_until(|| listens(&child));
        // loading takes seconds
        std::thread::sleep(Duration::from_millis(50));
        send(&child, signal);
        assert_cancelled(&bench, done(child.wait_with_output().unwrap()));
    }
}

#[test]
fn a_busy_trace_leaves_nothing() {
    let bench = Bench::new();
    let mut child = trace(&bench);
    let mut stdin = child.stdin.take().unwrap();
    // rays without end, until the command closes its input
    let feeder = std::thread::spawn(move || {
        let block = "-5,0.5,0,1,0,0\n".repeat(1000);
        let _ = stdin.write_all(RAYS.as_bytes());
        while stdin.write_all(block.as_bytes()).is_ok() {}
    });
    let folder = bench.path("");
    wait_until(|| holds(&folder, ".hits.csv."));
    // the command writes for a while
    std::thread::sleep(Duration::from_millis(300));
    interrupt(&child);
    assert_cancelled(&bench, done(child.wait_with_output().unwrap()));
    feeder.join().unwrap();
}

#[test]
fn a_trace_that_waits_for_rays_leaves_nothing() {
    for signal in ["-INT", "-TERM", "-HUP"] {
        let bench = Bench::new();
        let mut child = trace(&bench);
        let mut stdin = child.stdin.take().unwrap();
        stdin.write_all(RAYS.as_bytes()).unwrap();
        stdin.write_all(b"-5,0,0,1,0,0\n").unwrap();
        stdin.flush().unwrap();
        let folder = bench.path("");
        wait_until(|| holds(&folder, ".hits.csv."));
        send(&child, signal);
        assert_cancelled(&bench, done(child.wait_with_output().unwrap()));
        drop(stdin);
    }
}

/// The table of names goes to a pipe that nobody opens, while the table of hits is unfinished.
#[test]
fn a_trace_that_waits_for_a_reader_leaves_nothing() {
    let bench = Bench::new();
    bench.write("rays.csv", format!("{RAYS}-5,0,0,1,0,0\n"));
    assert!(Command::new("mkfifo").arg(bench.path("hits.names.json")).status().unwrap().success());
    let child =
        bench.command(&["trace", "ball.toml", "--rays", "rays.csv", "-o", "hits.npy"]).spawn().unwrap();
    let folder = bench.path("");
    wait_until(|| holds(&folder, ".hits.npy."));
    interrupt(&child);
    let done = done(child.wait_with_output().unwrap());
    assert_eq!((done.code, done.err.as_str()), (130, "error: cancelled: unfinished files are removed.\n"));
    assert_eq!(bench.files(), ["ball.toml", "cemented.toml", "hits.names.json", "rays.csv"]);
}

#[test]
fn a_trace_that_waits_for_its_header_can_be_interrupted() {
    let bench = Bench::new();
    let mut child = trace(&bench);
    let stdin = child.stdin.take();
    wait_until(|| listens(&child));
    interrupt(&child);
    assert_cancelled(&bench, done(child.wait_with_output().unwrap()));
    drop(stdin);
}

#[test]
fn a_picture_leaves_nothing() {
    let bench = Bench::new();
    let arguments =
        ["render", "ball.toml", "--size", "2000x2000", "--samples", "16", "--evaluator", "reference"];
    let child = bench.command(&arguments).spawn().unwrap();
    wait_until(|| listens(&child));
    // the command draws for a while: it needs some seconds
    std::thread::sleep(Duration::from_millis(100));
    interrupt(&child);
    assert_cancelled(&bench, done(child.wait_with_output().unwrap()));
}

/// A ball lens with a run that takes far longer than the test.
const LIGHT: &str = "rayweave = 1
[solid.ball]
sphere = { radius = 10 }
[optics.medium]
ball = 'N-BK7'
[[optics.source]]
beam = { circle = 10, rays = 2000000000 }
transform = [{ translate = [0, 0, -50] }]
";

#[test]
fn light_without_end_leaves_nothing() {
    let bench = Bench::new();
    bench.write("ball.toml", LIGHT);
    let arguments = ["optics", "ball.toml", "--out", "light.csv", "--layout", "ball.svg", "--map", "map.svg"];
    let child = bench.command(&arguments).spawn().unwrap();
    let folder = bench.path("");
    wait_until(|| holds(&folder, ".light.csv."));
    std::thread::sleep(Duration::from_millis(200));
    interrupt(&child);
    assert_cancelled(&bench, done(child.wait_with_output().unwrap()));
}
