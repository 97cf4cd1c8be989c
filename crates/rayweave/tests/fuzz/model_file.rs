//! Fuzz target: bytes as a model file, parsed, written, parsed again, compiled and queried.

use rayweave::model::{Collected, LeafId, LeafKind, PrototypeId, RayBatch};
use rayweave::scene::{Document, Scene, parse};
use rayweave::{AnyEvaluator, Compiled, Evaluator, Program, Query, Ray, Vec3};

/// Models with more shapes, counting every placement, are parsed and compiled, but not queried: the time
/// would be unbounded.
const MAX_SHAPES: usize = 300;

/// The property: a file is rejected with reasons at positions in it, or has the same meaning when it is
/// written and parsed again, and all evaluators return the same finite results for it.
pub fn run(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    // no input that refers to other files
    if text.contains("file") {
        return;
    }
    match parse(text) {
        Ok((document, scene)) => {
            let written = document.to_toml();
            let again = parse(&written).unwrap_or_else(|problems| panic!("{written}\n{problems}"));
            assert_eq!(again, (document, scene.clone()), "{written}");
            rebuilt(&scene);
            trace(&scene);
        }
        Err(problems) => {
            assert!(problems.has_errors());
            assert!(!problems.render(true).is_empty());
            for span in problems.iter().filter_map(|problem| problem.span()) {
                assert!(span.start() <= span.end() && span.end() <= text.len(), "{span:?}");
            }
        }
    }
}

fn rebuilt(scene: &Scene) {
    let text = Document::from_scene(scene).to_toml();
    let (_, again) = parse(&text).unwrap_or_else(|problems| panic!("{text}\n{problems}"));
    assert_eq!(again.regions, scene.regions, "{text}");
}

pub fn trace(scene: &Scene) {
    let compiled = match Compiled::new(scene) {
        Ok(compiled) => compiled,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    if shapes(&compiled.program, PrototypeId(0)) > MAX_SHAPES {
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

/// The number of shapes of a group with their copies; more than the limit if there are too many.
fn shapes(program: &Program, group: PrototypeId) -> usize {
    let leaves = &program.prototype(group).leaves;
    let mut count = 0;
    for leaf in leaves.clone() {
        count += match program.leaf(LeafId(leaf)).kind() {
            LeafKind::Instance { prototype, .. } => shapes(program, prototype),
            LeafKind::Shape { .. } => 1,
        };
        if count > MAX_SHAPES {
            break;
        }
    }
    count
}

/// Rays along an axis, in general position, from far away, and with a short direction.
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
