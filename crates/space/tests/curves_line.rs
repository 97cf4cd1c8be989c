//! A straight curve through a compiled model has the crossings that the reference evaluator finds
//! on the ray.

use rayweave_conformance::rays::rays;
use rayweave_conformance::{Model, Random, Style};
use rayweave_math::Vec3;
use rayweave_model::attributes::normal;
use rayweave_model::weld::local_ray;
use rayweave_model::{
    Crossing, Evaluator, Face, LeafId, LeafKind, PlacementId, Program, PrototypeId, Query, RayBatch,
    SurfaceId, Window,
};
use rayweave_shape::Ray;
use rayweave_shape::surface::delta;
use rayweave_space::curve::Line;
use rayweave_space::trace_curve;
use rayweave_trace::Reference;

#[derive(Debug, Default)]
struct Count {
    lines: usize,
    crossings: usize,
    /// Lines at a distance between delta / 4 and 4 delta from a surface, or within delta of one
    /// between two crossings or around one of its roots; both results are valid.
    borderline: usize,
    differ: Vec<String>,
}

/// The distance of a point of the ray from a surface, in units of delta.
fn deltas(program: &Program, ray: &Ray, placement: PlacementId, surface: SurfaceId, t: f64) -> f64 {
    let (local, magnitude) = local_ray(program, ray, placement);
    let entry = program.surface(surface);
    let (value, gradient) = entry.surface.value_and_gradient(local.at(t));
    value.abs() / gradient.length() / delta(entry.magnitude + magnitude, &local, t)
}

/// True if the ray is close to the threshold of lying in some surface of the model, over the whole
/// window or at its ends.
fn is_borderline(program: &Program, ray: &Ray, times: [f64; 3]) -> bool {
    let placements = program.prototype(PrototypeId(0)).placements;
    (0..placements).map(PlacementId).any(|placement| {
        let leaves = &program.prototype(program.placement(placement).1).leaves;
        leaves.clone().any(|leaf| match &program.leaf(LeafId(leaf)).kind() {
            LeafKind::Shape { facets, .. } => facets.clone().any(|facet| {
                let surface = program.facets()[facet as usize].surface();
                times.iter().any(|&t| (0.25..4.0).contains(&deltas(program, ray, placement, surface, t)))
            }),
            LeafKind::Instance { .. } => false,
        })
    })
}

/// True if the ray is within delta of a surface between two neighbouring crossings: rounding of the roots of that surface then decides
/// about the other one.
fn has_sliver(program: &Program, ray: &Ray, crossings: &[Crossing]) -> bool {
    let near = |face: Face, t: f64| deltas(program, ray, face.placement, face.surface, t) < 4.0;
    crossings.windows(2).any(|pair| near(pair[0].face, pair[1].t) || near(pair[1].face, pair[0].t))
}

/// True if two crossings agree. At an edge, where times are equal up to rounding, any face of the edge is accepted.
fn same(program: &Program, ray: &Ray, a: &Crossing, b: &Crossing) -> bool {
    let slope = |c: &Crossing| normal(program, ray, c).dot(ray.direction).abs();
    let slope = slope(a).min(slope(b));
    let magnitude = program.surface(b.face.surface).magnitude + 3.0;
    let slack = 2.0 * delta(magnitude, ray, b.t) / slope;
    let face = |x: Face, y: Face| x == y || deltas(program, ray, x.placement, x.surface, b.t) < 4.0;
    (a.t - b.t).abs() <= slack
        && (a.before, a.after) == (b.before, b.after)
        && face(a.face, b.face)
        && face(a.left, b.left)
        && face(a.entered, b.entered)
}

fn compare(reference: &Reference, ray: Ray, count: &mut Count, name: &str) {
    let program = reference.program();
    let line = Line::new(ray.origin.to_array(), ray.direction.to_array());
    let (closest, half) = (ray.closest_time(Vec3::ZERO), 9.0 / ray.direction.length());
    let (t0, t1) = (closest - half, closest + half);
    let query = Query { window: Window::new(t0, t1).unwrap(), ..Query::default() };
    let want = reference.collect(RayBatch::from_iter([ray]).rays(), &query).unwrap();
    let got = trace_curve(program, &line, t0, t1).unwrap();
    count.lines += 1;
    count.crossings += want.crossings.len();
    let equal = got.start == want.starts[0]
        && got.crossings.len() == want.crossings.len()
        && got.crossings.iter().zip(&want.crossings).all(|(a, b)| same(program, &ray, a, b));
    let grazing = [&got.crossings, &want.crossings].into_iter().flatten().any(|crossing| {
        normal(program, &ray, crossing).dot(ray.direction).abs() < 1e-6 * ray.direction.length()
    });
    let unsure = grazing
        || has_sliver(program, &ray, &got.crossings)
        || has_sliver(program, &ray, &want.crossings)
        || is_borderline(program, &ray, [t0, closest, t1]);
    if !equal && unsure {
        count.borderline += 1;
    } else if !equal {
        count.differ.push(format!("{name}: {ray:?}\n{got:?}\n{want:?}"));
    }
}

fn compare_all(seeds: std::ops::Range<u64>, lines: usize) -> Count {
    let mut count = Count::default();
    for seed in seeds {
        let style = [Style::Generic, Style::Grid, Style::Planes][seed as usize % 3];
        let mut rng = Random::new(seed);
        let model = Model::random(&mut rng, style);
        let Ok(program) = model.compile() else { continue };
        let reference = Reference::new(program);
        for ray in rays(&mut rng, style, &model.frame, lines) {
            compare(&reference, ray, &mut count, &format!("model {seed}"));
        }
    }
    count
}

fn expect_equal(count: Count) {
    for text in count.differ.iter().take(3) {
        println!("{text}\n");
    }
    println!("{} lines, {} crossings, {} borderline", count.lines, count.crossings, count.borderline);
    assert!(count.differ.is_empty(), "{} of {} differ", count.differ.len(), count.lines);
    assert!(count.crossings * 2 > count.lines && count.borderline * 200 < count.lines);
}

#[test]
fn lines_agree_with_the_reference() {
    expect_equal(compare_all(0..300, 20));
}

#[test]
#[ignore = "long"]
fn long_many_lines_agree_with_the_reference() {
    expect_equal(compare_all(1000..3000, 100));
}
