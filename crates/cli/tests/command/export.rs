//! `rayweave export`.

use crate::bench::Bench;

#[test]
fn a_scene_for_pov_ray() {
    let bench = Bench::new();
    let done = bench.run(&["export", "ball.toml", "ball.pov", "-D", "R=2"]);
    assert_eq!((done.code, done.out.as_str()), (0, "wrote ball.pov\n"), "{}", done.err);
    assert!(done.err.contains("lost: edges: they are not drawn.\n"), "{}", done.err);
    let text = bench.read("ball.pov");
    assert!(text.starts_with("#version 3.7;\n"), "{text}");
    assert!(text.contains("\nsphere { <0, 0, 0>, 2 texture { Region0 } }\n"), "{text}");
    assert!(text.contains("camera {\n  perspective\n  location <8.3"), "{text}");
    let piped = bench.run(&["export", "ball.toml", "-", "-D", "R=2"]);
    assert_eq!(piped.out, text);
    let one = bench.run(&["export", "cemented.toml", "-", "--solid", "left"]);
    assert!(one.out.contains("texture { Region0 }") && !one.out.contains("Region1"), "{}", one.out);
}

#[test]
fn other_formats_are_refused() {
    let bench = Bench::new();
    let message = bench.fails(2, &["export", "ball.toml", "ball.obj"]);
    assert_eq!(
        message,
        "error: ball.obj: unknown format: models are exported as .pov. `rayweave convert` writes other formats.\n"
    );
    assert!(bench.fails(3, &["export", "none.toml", "ball.pov"]).contains("none.toml"));
}
