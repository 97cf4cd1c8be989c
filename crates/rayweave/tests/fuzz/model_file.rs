//! Bytes as a model file: read, written, read again, compiled, asked.

use rayweave::model::{Collected, LeafId, LeafKind, PrototypeId, RayBatch};
use rayweave::scene::{Document, Scene, parse};
use rayweave::{AnyEvaluator, Compiled, Evaluator, Program, Query, Ray, Vec3};

/// Models with more shapes, every placement counted, are read and compiled, but not asked: the time would grow without a
/// bound.
const MOST_SHAPES: usize = 300;

/// The property: a file is refused with reasons at places in it, or means the same when it is written and read again, and all
/// evaluators answer alike about it, with finite numbers.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    // the files of other people's folders are no input
    if text.contains("file") {
        return;
    }
    match parse(text) {
        Ok((document, scene)) => {
            let written = document.to_toml();
            let again = parse(&written).unwrap_or_else(|problems| panic!("{written}\n{problems}"));
            assert_eq!(again, (document, scene.clone()), "{written}");
            rebuilt(&scene);
            ask(&scene);
        }
        Err(problems) => {
            assert!(problems.has_errors());
            assert!(!problems.render(true).is_empty());
            for span in problems.iter().filter_map(|problem| problem.span()) {
                assert!(span.start <= span.end && span.end <= text.len(), "{span:?}");
            }
        }
    }
}

fn rebuilt(scene: &Scene) {
    let text = Document::from_scene(scene).to_toml();
    let (_, again) = parse(&text).unwrap_or_else(|problems| panic!("{text}\n{problems}"));
    assert_eq!(again.regions, scene.regions, "{text}");
}

fn ask(scene: &Scene) {
    let compiled = match Compiled::new(scene) {
        Ok(compiled) => compiled,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    if shapes(&compiled.program, PrototypeId(0)) > MOST_SHAPES {
        return;
    }
    let batch = rays();
    let answers = AnyEvaluator::NAMES.map(|name| {
        let evaluator = AnyEvaluator::new(Some(name), compiled.program.clone()).ok()?;
        Some(evaluator.collect(batch.rays(), &Query::default()).unwrap())
    });
    let answers: Vec<Collected> = answers.into_iter().flatten().collect();
    assert!(answers.iter().all(|answer| *answer == answers[0]));
    assert!(answers[0].crossings.iter().all(|crossing| crossing.t.is_finite()));
}

/// The shapes of a group, as often as they occur; just more than are asked if there are too many.
fn shapes(program: &Program, group: PrototypeId) -> usize {
    let leaves = &program.prototype(group).leaves;
    let mut count = 0;
    for leaf in leaves.clone() {
        count += match program.leaf(LeafId(leaf)).kind() {
            LeafKind::Instance { prototype, .. } => shapes(program, prototype),
            LeafKind::Shape { .. } => 1,
        };
        if count > MOST_SHAPES {
            break;
        }
    }
    count
}

/// Along an axis, in general position, from far away, short.
fn rays() -> RayBatch {
    let ray = |o: [f64; 3], d: [f64; 3]| Ray::new(Vec3::from(o), Vec3::from(d));
    RayBatch::from_iter([
        ray([0.0; 3], [1.0, 0.0, 0.0]),
        ray([0.0, 0.0, -100.0], [0.0, 0.0, 1.0]),
        ray([0.5, -0.25, 3.0], [0.1, 0.7, -0.3]),
        ray([1e9, 1e9, 1e9], [-1.0, -1.0, -1.0]),
        ray([1.0, 1.0, 1.0], [1e-30, 0.0, 2e-30]),
    ])
}
