//! Test fixture: a temporary folder with models, in which the command runs.

use serde_json::Value;
use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

/// A ball of radius `R` = 1 about the origin, made of glass.
pub const BALL: &str = r#"
rayweave = 1
unit = "mm"

[parameters]
R = 1.0

[solid.ball]
sphere = { radius = "R" }

[[region]]
solid = "ball"
medium = "glass"

[medium.glass]
index = 1.5
"#;

/// Two boxes of different media that touch at x = 0, inside a larger ball of a third medium.
pub const CEMENTED: &str = r#"
rayweave = 1
unit = "cm"

[solid.left]
box_from_corners = { lo = [-2, -1, -1], hi = [0, 1, 1] }

[solid.right]
box_from_corners = { lo = [0, -1, -1], hi = [3, 1, 1] }

[solid.bath]
sphere = { radius = 10 }

[[region]]
solid = "bath"
medium = "water"

[[region]]
solid = "left"
medium = "crown"

[[region]]
solid = "right"
medium = "flint"

[medium.water]
[medium.crown]
[medium.flint]
"#;

/// A temporary folder, removed at the end.
pub struct Bench {
    folder: PathBuf,
}

/// The outcome of a run.
pub struct Done {
    pub code: i32,
    pub out: String,
    pub err: String,
}

impl Bench {
    /// A folder with `ball.toml` and `cemented.toml`.
    pub fn new() -> Bench {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("rayweave-command-{}-{count}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        fs::create_dir_all(&folder).unwrap();
        let bench = Bench { folder };
        bench.write("ball.toml", BALL);
        bench.write("cemented.toml", CEMENTED);
        bench
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) {
        fs::write(self.path(name), contents).unwrap();
    }

    pub fn read(&self, name: &str) -> String {
        String::from_utf8(self.bytes(name)).unwrap()
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// The names of all files, sorted.
    pub fn files(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.folder).unwrap();
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The command in this folder.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rayweave"));
        command
            .current_dir(&self.folder)
            .env_remove("RAYWEAVE_THREADS")
            // Mesa's layer that selects devices writes to standard error where there is no desktop session
            .env("NODEVICE_SELECT", "1")
            .args(arguments)
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        command
    }

    /// Runs the command; a panic in it fails the test.
    pub fn run(&self, arguments: &[&str]) -> Done {
        done(self.command(arguments).output().unwrap())
    }

    /// Runs the command with this text on its standard input.
    pub fn run_with_input(&self, arguments: &[&str], input: &str) -> Done {
        let mut child = self.command(arguments).stdin(Stdio::piped()).spawn().unwrap();
        // the texts are shorter than the buffer of a pipe, so that this does not block
        let written = child.stdin.take().unwrap().write_all(input.as_bytes());
        let done = done(child.wait_with_output().unwrap());
        assert!(written.is_ok() || done.code != 0, "{}", done.err);
        done
    }

    /// Runs the command, which must succeed, and returns its output.
    pub fn says(&self, arguments: &[&str]) -> String {
        let done = self.run(arguments);
        assert_eq!((done.code, done.err.as_str()), (0, ""), "{arguments:?}");
        done.out
    }

    /// Runs the command, which must succeed and print JSON.
    pub fn json(&self, arguments: &[&str]) -> Value {
        serde_json::from_str(&self.says(arguments)).unwrap()
    }

    /// Runs the command, which must fail with this exit code, and returns its message.
    pub fn fails(&self, code: i32, arguments: &[&str]) -> String {
        let done = self.run(arguments);
        assert_eq!(done.code, code, "{arguments:?}: {}", done.err);
        assert_eq!(done.out, "", "{arguments:?}");
        done.err
    }
}

impl Drop for Bench {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

pub fn done(output: std::process::Output) -> Done {
    let err = String::from_utf8(output.stderr).unwrap();
    let code = output.status.code().unwrap_or(-1);
    assert!(code != 101 && !err.contains("panicked"), "{err}");
    let out = String::from_utf8_lossy(&output.stdout).into_owned();
    Done { code, out, err }
}

/// The rows of a CSV file, without its header, as fields.
pub fn rows(csv: &str) -> Vec<Vec<&str>> {
    let lines = csv.lines().skip(1);
    lines.map(|line| line.split(',').collect()).collect()
}

/// The number in a field.
pub fn number(field: &str) -> f64 {
    field.parse().unwrap_or_else(|_| panic!("no number: {field}"))
}

/// The header of files of rays.
pub const RAYS: &str = "ox,oy,oz,dx,dy,dz\n";

/// True if the folder contains a file whose name contains `part`.
#[cfg(target_os = "linux")]
pub fn holds(folder: &std::path::Path, part: &str) -> bool {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).any(|name| name.contains(part))
}
