//! Fuzz target: bytes as trees of solids; all evaluators agree, and their answers are consistent.

use crate::bytes::Bytes;
use rayweave::model::{Collected, Limit, RayBatch, Rays, RegionId};
use rayweave::shape::primitive::{MANUALS, Parameter, ParameterKind, ParameterUnit, Value, build};
use rayweave::{
    Affine, AnyEvaluator, Classified, ErrorKind, Evaluator, Program, Query, Ray, Region, Solid, Vec3, Window,
    explain,
};
use std::sync::Arc;

/// The limit of shapes in a model, without occurrences in placed solids.
const MAX_SHAPES: usize = 24;

/// The limit of copies of a shape: nested placements and doublings multiply.
const MAX_COPIES: usize = 64;

const SIZES: [f64; 8] = [1.0, 2.0, 0.5, 3.0, 1e-8, 1e8, 0.0, -1.0];
const PLACES: [f64; 8] = [0.0, 1.0, -1.0, 0.5, 2.0, -0.5, 1e6, 1e-9];
const ANGLES: [f64; 6] = [90.0, 45.0, 30.0, 180.0, 1e-7, 17.0];

/// The property: a model is rejected with a reason, or all evaluators return the same crossings along all
/// rays, with times that are finite, increase and lie in the window, and with consistent regions.
pub fn run(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let count = 1 + bytes.below(3);
    let regions: Vec<Region> = (0..count)
        .map(|k| {
            let mut shapes = MAX_SHAPES / count;
            let solid = solid(&mut bytes, &mut shapes, 1, 0);
            Region { name: format!("r{k}"), solid, medium: 1 + bytes.below(2) as u32 }
        })
        .collect();
    let program = match Program::compile_regions(&regions) {
        Ok(program) => Arc::new(program),
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let batch: RayBatch = (0..4).map(|_| ray(&mut bytes)).filter(|ray| ray.check().is_ok()).collect();
    for query in [Query::default(), Query::nearest(), window(&mut bytes)] {
        trace(&program, batch.rays(), &query);
    }
    if !batch.rays().is_empty() {
        match explain(&program, batch.rays().get(0), Window::ALL) {
            Ok(explanation) => assert!(explanation.to_string().ends_with("steps.)\n")),
            Err(error) => assert_eq!(error.kind(), ErrorKind::Compile),
        }
    }
}

fn trace(program: &Arc<Program>, rays: Rays<'_>, query: &Query<'_>) {
    // some evaluators reject models with much sharing
    let evaluators =
        AnyEvaluator::NAMES.iter().flat_map(|name| AnyEvaluator::new(Some(name), program.clone()));
    let answers: Vec<_> =
        evaluators.map(|evaluator| (evaluator.name(), evaluator.collect(rays, query).unwrap())).collect();
    let (_, first) = &answers[0];
    for (name, answer) in &answers {
        assert_eq!(answer, first, "{name}");
    }
    for ray in 0..first.len() {
        check(program, first, ray, query);
    }
}

fn check(program: &Program, answer: &Collected, ray: usize, query: &Query<'_>) {
    let crossings = answer.of(ray);
    let mut region = answer.starts[ray];
    let mut t = query.window.t_min();
    for crossing in crossings {
        assert!(crossing.t.is_finite() && crossing.t > t && crossing.t < query.window.t_max());
        assert_ne!(program.medium_of(crossing.before), program.medium_of(crossing.after));
        // between regions of one medium, the region can change without a crossing
        assert_eq!(program.medium_of(crossing.before), program.medium_of(region));
        (t, region) = (crossing.t, crossing.after);
    }
    assert!(region <= RegionId(program.regions().len() as u32));
    assert!(query.limit == Limit::All || crossings.len() <= 1);
}

/// A solid that will occur `copies` times.
fn solid(bytes: &mut Bytes<'_>, shapes: &mut usize, copies: usize, depth: usize) -> Solid {
    if *shapes == 0 || depth > 40 || bytes.rest().is_empty() {
        return Solid::empty();
    }
    let mut part = |bytes: &mut Bytes<'_>| solid(bytes, shapes, copies, depth + 1);
    match bytes.below(16) {
        0 => part(bytes) | part(bytes),
        1 => part(bytes) & part(bytes),
        2 => part(bytes) - part(bytes),
        3 => part(bytes) ^ part(bytes),
        4 => !part(bytes),
        5 => Solid::union((0..bytes.below(6)).map(|_| part(bytes)).collect::<Vec<_>>()),
        6 => Solid::intersection((0..bytes.below(6)).map(|_| part(bytes)).collect::<Vec<_>>()),
        7 => part(bytes).apply(map(bytes)),
        8 => {
            let most = (MAX_COPIES / copies).min(4);
            let maps: Vec<Affine> = (0..bytes.below(most + 1)).map(|_| map(bytes)).collect();
            solid(bytes, shapes, copies * maps.len().max(1), depth + 1).place(maps)
        }
        // the single-hit evaluator expands shared parts
        9 if 2 * copies <= MAX_COPIES => {
            let one = solid(bytes, shapes, 2 * copies, depth + 1);
            let same = one.clone();
            if bytes.below(2) == 0 { one - same } else { one | same }
        }
        _ => {
            *shapes -= 1;
            let moved = Affine::translate(point(bytes));
            shape(bytes).map_or(Solid::universe(), |solid| solid.apply(moved))
        }
    }
}

/// A shape, or `None` if it is rejected.
fn shape(bytes: &mut Bytes<'_>) -> Option<Solid> {
    let manual = &MANUALS[bytes.below(MANUALS.len())];
    let arguments: Vec<(&str, Value)> =
        manual.parameters.iter().map(|parameter| (parameter.name, argument(bytes, parameter))).collect();
    match build(manual.name, &arguments) {
        Ok(primitive) => Some(primitive.into()),
        Err(error) => {
            assert!(!error.to_string().is_empty());
            None
        }
    }
}

fn argument(bytes: &mut Bytes<'_>, parameter: &Parameter) -> Value {
    match parameter.kind {
        ParameterKind::Number => match parameter.unit {
            ParameterUnit::Angle => bytes.number(&ANGLES).into(),
            _ => bytes.number(&SIZES).into(),
        },
        ParameterKind::Count => f64::from(bytes.byte() % 9).into(),
        ParameterKind::Vector3 => point(bytes).into(),
        ParameterKind::NumberOrVector3 => Vec3::new(size(bytes), size(bytes), size(bytes)).into(),
        ParameterKind::Planes => rows(bytes, 7),
        ParameterKind::Triples => triples(bytes, parameter.unit == ParameterUnit::Count),
        ParameterKind::Matrix4 => rows(bytes, 4),
        ParameterKind::Numbers => {
            let count = bytes.below(6);
            Value::Vector((0..count).map(|_| bytes.number(&PLACES)).collect())
        }
    }
}

fn size(bytes: &mut Bytes<'_>) -> f64 {
    bytes.number(&SIZES)
}

/// Up to seven points, or up to seven triangles with small indices.
fn triples(bytes: &mut Bytes<'_>, is_whole: bool) -> Value {
    let number =
        |bytes: &mut Bytes<'_>| if is_whole { f64::from(bytes.byte() % 5) } else { bytes.number(&PLACES) };
    let count = bytes.below(8);
    Value::Rows((0..count).map(|_| (0..3).map(|_| number(bytes)).collect()).collect())
}

fn rows(bytes: &mut Bytes<'_>, most: usize) -> Value {
    let count = if most == 4 { 4 } else { bytes.below(most + 1) };
    let rows: Vec<Vec<f64>> = (0..count).map(|_| (0..4).map(|_| bytes.number(&PLACES)).collect()).collect();
    // the matrix of a quadric is symmetric
    let symmetric = |i: usize, j: usize| if most == 4 { rows[i.min(j)][i.max(j)] } else { rows[i][j] };
    Value::Rows((0..count).map(|i| (0..4).map(|j| symmetric(i, j)).collect()).collect())
}

fn point(bytes: &mut Bytes<'_>) -> Vec3 {
    Vec3::new(bytes.number(&PLACES), bytes.number(&PLACES), bytes.number(&PLACES))
}

fn map(bytes: &mut Bytes<'_>) -> Affine {
    match bytes.below(5) {
        0 => Affine::translate(point(bytes)),
        1 => Affine::scale(point(bytes)),
        2 => Affine::rotation(point(bytes), bytes.number(&ANGLES)),
        3 => Affine::mirror(point(bytes)),
        _ => Affine::rotation(Vec3::Z, bytes.number(&ANGLES)).then(&Affine::translate(point(bytes))),
    }
}

fn ray(bytes: &mut Bytes<'_>) -> Ray {
    match bytes.below(3) {
        0 => Ray::new(point(bytes), bytes.pick(&[Vec3::X, Vec3::Y, Vec3::Z])),
        1 => Ray::new(point(bytes), point(bytes)),
        _ => {
            let (from, to) = (point(bytes), point(bytes));
            Ray::new(from, to - from)
        }
    }
}

fn window(bytes: &mut Bytes<'_>) -> Query<'static> {
    let (t_min, t_max) = (bytes.number(&PLACES), bytes.number(&PLACES));
    let window = Window::new(t_min, t_max).unwrap_or_default();
    Query { window, limit: bytes.pick(&[Limit::All, Limit::First]), starts: None }
}
