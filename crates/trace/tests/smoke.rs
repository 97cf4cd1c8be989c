//! Small closed forms for all evaluators.

mod everyone;

use rayweave_math::Vec3;
use rayweave_model::{Collected, Evaluator, Program, Query, RegionId, Solid};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Primitive, Value, build};
use rayweave_trace::Weave;
use std::sync::Arc;

fn shape(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let arguments: Vec<_> = arguments.iter().map(|&(n, v)| (n, Value::Number(v))).collect();
    Solid::from(build(name, &arguments).unwrap())
}

fn trace(solid: &Solid, ray: Ray) -> Collected {
    everyone::trace(&Arc::new(Program::compile(solid).unwrap()), ray)
}

fn times(solid: &Solid, ray: Ray) -> Vec<f64> {
    trace(solid, ray).crossings.iter().map(|c| c.t).collect()
}

#[test]
fn sphere_minus_sphere() {
    let x = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
    let big = shape("sphere", &[("radius", 2.0)]);
    let small = shape("sphere", &[("radius", 1.0)]);
    assert_eq!(times(&big, x), [3.0, 7.0]);
    assert_eq!(times(&(&big - &small), x), [3.0, 4.0, 6.0, 7.0]);
    assert_eq!(times(&(&small - &big), x), [0.0; 0]);
    assert_eq!(times(&(&big ^ &small.translate([2.0, 0.0, 0.0])), x), [3.0, 6.0, 7.0, 8.0]);
    let outside = trace(&!&big, x);
    assert_eq!(outside.starts, [RegionId(1)]);
    assert_eq!(outside.crossings.len(), 2);
}

#[test]
fn touching_boxes_are_one() {
    let unit = shape("box", &[("size", 1.0)]);
    let row = &unit | &unit.translate([1.0, 0.0, 0.0]);
    let x = Ray::new(Vec3::new(-5.0, 0.1, 0.2), Vec3::X);
    assert_eq!(times(&row, x), [4.5, 6.5]);
    assert_eq!(times(&(&unit - &unit.translate([1.0, 0.0, 0.0])), x), [4.5, 5.5]);
    assert_eq!(times(&(&unit & &unit.translate([1.0, 0.0, 0.0])), x), [0.0; 0]);
    // a ray in the shared face
    let in_face = Ray::new(Vec3::new(0.5, -5.0, 0.1), Vec3::Y);
    assert_eq!(times(&row, in_face), [4.5, 5.5]);
}

#[test]
fn placed_tiles_touch() {
    let unit = shape("box", &[("size", 1.0)]);
    let maps: Vec<_> =
        (0..10).map(|k| rayweave_math::Affine::translate(Vec3::new(f64::from(k), 0.0, 0.0))).collect();
    let tiles = unit.place(maps);
    let x = Ray::new(Vec3::new(-5.0, 0.1, 0.2), Vec3::new(1.0, 0.01, 0.0));
    let found = times(&tiles, x);
    assert_eq!(found.len(), 2, "{found:?}");
    assert!((found[0] - 4.5).abs() < 1e-12 && (found[1] - 14.5).abs() < 1e-12);
}

#[test]
fn deep_chain() {
    let mut s = shape("sphere", &[("radius", 0.4)]);
    for k in 1..100_000 {
        let next = shape("sphere", &[("radius", 0.4)]).translate([f64::from(k), 0.0, 0.0]);
        s = match k % 3 {
            0 => s | next,
            1 => s - next.translate([0.5, 0.0, 0.0]),
            _ => s ^ next,
        };
    }
    assert!(s.to_string().len() > 1_000_000);
    let program = Arc::new(Program::compile(&s).unwrap());
    let x = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
    // gate by gate such a chain would take quadratic time
    let found = Weave::new(program).one(x, &Query::default()).unwrap();
    assert!(found.crossings.len() > 100_000);
    let _ = Primitive::example("sphere");
}
