//! Regions along a ray: closed forms for cemented, immersed, overlapping and nearly touching parts.

mod everyone;

use rayweave_math::Vec3;
use rayweave_model::{Crossing, Evaluator, Face, Program, Region, RegionId, Solid};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::{Packets, Weave};
use std::sync::Arc;

fn shape(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let arguments: Vec<_> = arguments.iter().map(|&(n, v)| (n, Value::Number(v))).collect();
    Solid::from(build(name, &arguments).unwrap())
}

/// A named cube of side 2, centred at the given x.
fn cube(name: &str, x: f64) -> Solid {
    shape("box", &[("size", 2.0)]).named(name).translate([x, 0.0, 0.0])
}

fn model(regions: &[(&Solid, u32)]) -> Arc<Program> {
    let region = |(k, &(solid, medium)): (usize, &(&Solid, u32))| Region {
        name: format!("region {k}"),
        solid: solid.clone(),
        medium,
    };
    Arc::new(Program::compile_regions(&regions.iter().enumerate().map(region).collect::<Vec<_>>()).unwrap())
}

fn along_x(program: &Arc<Program>) -> Vec<Crossing> {
    let ray = Ray::new(Vec3::new(-10.0, 0.1, 0.2), Vec3::X);
    everyone::trace(program, ray).crossings
}

/// `(t - 10, region before, region after)`: the position along x and the regions.
fn passes(crossings: &[Crossing]) -> Vec<(f64, u32, u32)> {
    crossings.iter().map(|c| (c.t - 10.0, c.before.0, c.after.0)).collect()
}

fn face_name(program: &Program, face: Face) -> String {
    program.leaf(face.leaf).face_name(face.facet as usize)
}

/// Points so far away that computations with boxes overflow.
#[test]
fn distant_points_are_outside() {
    fn regions<E: Evaluator>(evaluator: &E) -> Vec<RegionId> {
        let xs = [0.5, 1e150, -1e300, f64::MAX];
        let mut found = vec![RegionId(9); xs.len()];
        evaluator.regions_at([&xs, &[0.0; 4], &[0.0; 4]], &mut evaluator.scratch(), &mut found);
        found
    }
    let (one, other) = (cube("one", 0.0), cube("other", 5.0));
    let program = model(&[(&one, 1), (&other, 2)]);
    let expected = [1, 0, 0, 0].map(RegionId);
    assert_eq!(regions(&Weave::new(program.clone())), expected);
    assert_eq!(regions(&Packets::new(program)), expected);
}

#[test]
fn touching_regions_are_one_crossing_that_names_both_faces() {
    let program = model(&[(&cube("a", 0.0), 1), (&cube("b", 2.0), 2)]);
    let found = along_x(&program);
    assert_eq!(passes(&found), [(-1.0, 0, 1), (1.0, 1, 2), (3.0, 2, 0)]);
    assert_eq!(face_name(&program, found[1].left), "a.x+");
    assert_eq!(face_name(&program, found[1].entered), "b.x-");
    assert_eq!(face_name(&program, found[1].face), "a.x+");
    assert!(found[1].enters() && !found[2].enters());
}

#[test]
fn a_gap_of_rounding_size_is_no_gap() {
    // 0.1 + 0.2 != 0.3: scaled and moved so that the faces differ in the last bits
    let a = cube("a", 0.0).scale(Vec3::splat(0.1)).translate([0.1 + 0.2, 0.0, 0.0]);
    let b = cube("b", 2.0).scale(Vec3::splat(0.1)).translate([0.3, 0.0, 0.0]);
    let (c, d) = (
        a.place(vec![rayweave_math::Affine::IDENTITY, far()]),
        b.place(vec![rayweave_math::Affine::IDENTITY, far()]),
    );
    for (a, b) in [(&a, &b), (&c, &d)] {
        for regions in [[(a, 1), (b, 2)], [(b, 2), (a, 1)]] {
            let program = model(&regions);
            let ray = Ray::new(Vec3::new(-1.0, 0.01, 0.02), Vec3::new(1.0, 0.003, 0.001));
            let found = everyone::trace(&program, ray).crossings;
            let media: Vec<_> =
                found.iter().map(|c| (program.medium_of(c.before), program.medium_of(c.after))).collect();
            assert_eq!(media, [(0, 1), (1, 2), (2, 0)]);
        }
    }
}

/// A placement far from the rays of the tests.
fn far() -> rayweave_math::Affine {
    rayweave_math::Affine::translate(Vec3::new(0.0, 1e3, 0.0))
}

#[test]
fn later_regions_win_and_give_back() {
    let program = model(&[(&cube("body", 0.0), 1), (&shape("sphere", &[("radius", 0.5)]).named("core"), 2)]);
    let found = along_x(&program);
    let half = (0.25f64 - 0.01 - 0.04).sqrt();
    let places = passes(&found);
    let expected = [(-1.0, 0, 1), (-half, 1, 2), (half, 2, 1), (1.0, 1, 0)];
    for (place, expected) in places.iter().zip(expected) {
        assert!((place.0 - expected.0).abs() < 1e-14 && (place.1, place.2) == (expected.1, expected.2));
    }
    assert_eq!(places.len(), 4);
    // the core's own face is both left and entered on the way in and out
    assert!(
        face_name(&program, found[1].left).starts_with("core")
            && face_name(&program, found[2].entered).starts_with("core")
    );
    // in the opposite order the body hides the core
    let hidden = model(&[(&shape("sphere", &[("radius", 0.5)]), 2), (&cube("body", 0.0), 1)]);
    assert_eq!(passes(&along_x(&hidden)), [(-1.0, 0, 2), (1.0, 2, 0)]);
}

#[test]
fn equal_media_have_no_face_between_them() {
    let program = model(&[(&cube("a", 0.0), 7), (&cube("b", 2.0), 7), (&cube("c", 5.0), 7)]);
    assert_eq!(passes(&along_x(&program)), [(-1.0, 0, 1), (3.0, 2, 0), (4.0, 0, 3), (6.0, 3, 0)]);
    let empty = model(&[(&cube("a", 0.0), 0)]);
    assert_eq!(along_x(&empty), []);
}

#[test]
fn an_unbounded_region_starts_inside() {
    let water = Solid::universe();
    let program = model(&[(&water, 1), (&cube("a", 0.0), 2)]);
    let ray = Ray::new(Vec3::new(-10.0, 0.0, 0.0), Vec3::X);
    let found = everyone::trace(&program, ray);
    assert_eq!(found.starts[0].0, 1);
    assert_eq!(passes(&found.crossings), [(-1.0, 1, 2), (1.0, 2, 1)]);
}
