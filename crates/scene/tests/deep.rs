//! Deeply nested files take heap memory instead of call stack, and linear time.

use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_scene::{Document, parse};
use rayweave_shape::primitive::build;
use std::fmt::Write;

const DEPTH: usize = 100_000;

/// Runs a test on a stack of 256 KiB.
fn on_a_small_stack(work: impl FnOnce() + Send + 'static) {
    let thread = std::thread::Builder::new().stack_size(256 * 1024).spawn(work);
    thread.unwrap().join().unwrap();
}

fn ball() -> Solid {
    build("sphere", &[("radius", 1.0.into())]).unwrap().into()
}

#[test]
fn deep_expressions_are_read_and_written() {
    on_a_small_stack(|| {
        let ball_text = "[solid.a]\nsphere = { radius = 1 }\n";
        let nested = format!("{}a{}", "(a | ".repeat(DEPTH), ")".repeat(DEPTH));
        let text = format!("rayweave = 1\n{ball_text}[solid.deep]\nexpr = '{nested}'\n");
        let (document, scene) = parse(&text).unwrap();
        let (_, again) = parse(&document.to_toml()).unwrap();
        assert!(again == scene);
        let (_, rebuilt) = parse(&Document::from_scene(&scene).to_toml()).unwrap();
        assert!(rebuilt.solid("deep") == scene.solid("deep"));
    });
}

#[test]
fn long_chains_of_solids_and_parameters_are_resolved() {
    on_a_small_stack(|| {
        let n = DEPTH / 4;
        let mut text = String::from("rayweave = 1\n[parameters]\n");
        for k in 0..n {
            writeln!(text, "p{k} = 'p{} + 1'", k + 1).unwrap();
        }
        writeln!(text, "p{n} = 0\n[solid.s{n}]\nsphere = {{ radius = 'p0' }}").unwrap();
        // each one uses the next, so the first depends on all others
        for k in 0..n {
            writeln!(text, "[solid.s{k}]\nexpr = '~s{}'", k + 1).unwrap();
        }
        let (_, scene) = parse(&text).unwrap();
        assert_eq!(scene.parameters[0], ("p0".to_owned(), n as f64));
        assert_eq!(scene.regions.len(), 1);
        let mut expected: Solid = build("sphere", &[("radius", (n as f64).into())]).unwrap().into();
        expected = expected.named(&format!("s{n}"));
        for k in (0..n).rev() {
            expected = (!expected).named(&format!("s{k}"));
        }
        assert!(scene.solid("s0") == Some(&expected));
    });
}

#[test]
fn deep_solids_become_documents() {
    on_a_small_stack(|| {
        let (ball, mut left, mut right) = (ball(), ball(), ball());
        for _ in 0..DEPTH {
            left = left - &ball;
            right = &ball & right;
        }
        let mut moved = ball.clone();
        for _ in 0..DEPTH / 10 {
            moved = !moved.translate(Vec3::X);
        }
        for solid in [left, right, moved] {
            let (_, scene) = parse(&Document::from_solid("deep", &solid).to_toml()).unwrap();
            assert!(scene.solid("deep") == Some(&solid.named("deep")));
        }
    });
}

#[test]
fn a_cycle_of_many_is_reported_in_one_line() {
    on_a_small_stack(|| {
        let mut text = String::from("rayweave = 1\n");
        let n = DEPTH / 10;
        for k in 0..n {
            writeln!(text, "[solid.s{k}]\nexpr = '~s{}'", (k + 1) % n).unwrap();
        }
        let problems = parse(&text).unwrap_err();
        assert_eq!(problems.len(), 1);
        assert!(problems.to_string().len() < 1000);
    });
}
