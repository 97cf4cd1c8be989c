//! `rayweave watch`.

use crate::bench::Bench;

/// A tetrahedron with an edge of this length along each axis.
#[cfg(target_os = "linux")]
fn corner(length: f64) -> String {
    format!(
        "OFF\n4 4 0\n0 0 0\n{length} 0 0\n0 {length} 0\n0 0 {length}\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n"
    )
}

/// The picture is drawn again after changes of the model and of a file that it includes. A model with an error leaves the picture
/// as it is, and the command continues.
#[test]
#[cfg(target_os = "linux")]
fn a_picture_follows_its_model_and_its_files() {
    use std::fs::{self, File};
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let bench = Bench::new();
    let model = |scale: &str| {
        let text =
            format!("rayweave = 1\n[solid.a]\nmesh.file = \"a.off\"\ntransform = {{ scale = {scale} }}\n");
        bench.write("m.toml", text + "[camera]\nposition = [9, 8, 7]\nsize = [24, 16]\n");
    };
    model("1");
    bench.write("a.off", corner(1.0));
    let messages = File::create(bench.path("messages")).unwrap();
    let mut child =
        bench.command(&["watch", "m.toml"]).stdout(Stdio::null()).stderr(messages).spawn().unwrap();
    let waits = |count: usize| {
        let start = Instant::now();
        while bench.read("messages").matches("watching").count() < count {
            assert!(start.elapsed() < Duration::from_secs(30), "{}", bench.read("messages"));
            std::thread::sleep(Duration::from_millis(20));
        }
        fs::read(bench.path("m.png")).unwrap()
    };
    let first = waits(1);
    bench.write("a.off", corner(2.25));
    let larger = waits(2);
    assert!(larger != first);
    model("nonsense");
    assert!(waits(3) == larger);
    assert!(bench.read("messages").contains("m.toml:4"), "{}", bench.read("messages"));
    bench.write("a.off", corner(1.0));
    model("1");
    assert!(waits(4) == first);
    assert!(bench.read("messages").contains("watching 2 files"));
    let status = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(status.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert_eq!(bench.files(), ["a.off", "ball.toml", "cemented.toml", "m.png", "m.toml", "messages"]);
}

#[test]
fn what_cannot_be_drawn_again_is_rejected() {
    let bench = Bench::new();
    for (arguments, reason) in [
        (&["watch", "-"][..], "standard input"),
        (&["watch", "ball.toml", "-o", "-"], "standard output"),
        (&["watch", "ball.toml", "--range", "0:2"], "--range"),
    ] {
        let done = bench.run(arguments);
        assert_eq!(done.code, 2, "{}", done.err);
        assert!(done.err.contains(reason), "{}", done.err);
    }
}
