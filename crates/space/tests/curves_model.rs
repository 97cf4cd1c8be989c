//! Curves through compiled models: closed forms, coincident faces, and an oracle by dense sampling.

mod curves_support;

use rayweave_conformance::models::{block, half_space, motion, shape};
use rayweave_conformance::{Model, Random, Style};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Crossing, Evaluator, PlacementId, Program, RegionId, Solid, Start, SurfaceId};
use rayweave_space::curve::{Arc, Helix, Line, Mapped, Parabola, Spline, SplineEnds};
use rayweave_space::{
    Curve, CurveError, CurveTrace, Point, curve_normal, curve_point, trace_curve, trace_curve_from,
};
use rayweave_trace::Reference;
use std::f64::consts::TAU;

fn trace(solid: &Solid, curve: &dyn Curve<3>, t0: f64, t1: f64) -> CurveTrace {
    trace_curve(&Program::compile(solid).unwrap(), curve, t0, t1).unwrap()
}

fn times(trace: &CurveTrace) -> Vec<f64> {
    trace.crossings.iter().map(|crossing| crossing.t).collect()
}

/// Checks the start side and the alternating entry and exit times of a solid.
fn expect(solid: &Solid, curve: &dyn Curve<3>, (t0, t1): (f64, f64), inside: bool, want: &[f64], what: &str) {
    let got = trace(solid, curve, t0, t1);
    let (found, slack) = (times(&got), 1e-12 * (t1 - t0));
    assert_eq!(got.start == RegionId(1), inside, "{what}");
    assert_eq!(found.len(), want.len(), "{what}: {found:?} {want:?}");
    for (k, (a, b)) in found.iter().zip(want).enumerate() {
        assert!((a - b).abs() < slack, "{what}: {found:?} {want:?}");
        assert_eq!(got.crossings[k].enters(), inside == (k % 2 == 1), "{what}");
    }
}

/// Checks a case as given, and translated, rotated and scaled together with the curve.
fn expect_anywhere(
    solid: &Solid,
    curve: &dyn Curve<3>,
    window: (f64, f64),
    inside: bool,
    want: &[f64],
    what: &str,
) {
    expect(solid, curve, window, inside, want, what);
    let mut rng = Random::new(what.len() as u64);
    for scale in [1e-8, 1e-3, 1.0, 1e8] {
        let map = motion(&mut rng).then(&Affine::scale(Vec3::splat(scale)));
        let moved = Mapped::new(curve, map);
        expect(&solid.clone().apply(map), &moved, window, inside, want, &format!("{what}, times {scale}"));
        // as a placed solid
        let placed = solid.clone().place([map]);
        expect(&placed, &moved, window, inside, want, &format!("{what}, placed, times {scale}"));
    }
}

fn circle(centre: Point<3>, radius: f64) -> Arc<3> {
    Arc::new(centre, [[radius, 0.0, 0.0], [0.0, radius, 0.0]], 1.0).unwrap()
}

/// `(cos t, sin t, t / 5)`.
fn helix() -> Helix {
    Helix::about([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], 0.2 * TAU).unwrap()
}

#[test]
fn helix_in_slab_cylinder_and_sphere() {
    let slab = half_space(Vec3::Z, 1.7) & half_space(-Vec3::Z, 1.0);
    expect_anywhere(&slab, &helix(), (-30.0, 30.0), false, &[-5.0, 8.5], "helix in slab");
    // (cos t - c)^2 + sin^2 t = r^2 has cos t = (1 + c^2 - r^2) / (2 c)
    let (c, r) = (1.5, 1.0);
    let cylinder = shape("cylinder", &[("radius", r)]).apply(Affine::translate(Vec3::new(c, 0.0, 0.0)));
    let half = libm::acos((1.0 + c * c - r * r) / (2.0 * c));
    let want: Vec<f64> =
        (-4..=4).flat_map(|k| [f64::from(k) * TAU - half, f64::from(k) * TAU + half]).collect();
    expect_anywhere(&cylinder, &helix(), (-28.0, 28.0), false, &want, "helix in cylinder");
    let at = 5.0 * (2.0f64 * 2.0 - 1.0).sqrt();
    expect_anywhere(
        &shape("sphere", &[("radius", 2.0)]),
        &helix(),
        (-20.0, 20.0),
        false,
        &[-at, at],
        "helix in sphere",
    );
}

#[test]
fn arcs_against_sphere_box_and_torus() {
    // |c|^2 + r^2 + 2 r |c| cos t = R^2
    let sphere = shape("sphere", &[("radius", 2.0)]);
    let half = libm::acos((4.0 - 1.0 - 2.25) / (2.0 * 1.5));
    expect_anywhere(
        &sphere,
        &circle([1.0, 0.0, 0.0], 1.5),
        (-3.0, 3.0),
        true,
        &[-half, half],
        "arc in sphere",
    );
    // through four sides of a box: cos t = +-0.8, sin t = +-0.8
    let cube = shape("box", &[("size", 1.6)]);
    let (a, b) = (libm::acos(0.8), libm::asin(0.8));
    let want: Vec<f64> =
        (0..4).flat_map(|k| [a + 0.25 * TAU * f64::from(k), b + 0.25 * TAU * f64::from(k)]).collect();
    expect_anywhere(&cube, &circle([0.0; 3], 1.0), (0.0, TAU - 0.1), false, &want, "arc in box");
    // a circle in a plane through the axis, around the middle of the tube and off it
    let torus = shape("torus", &[("major", 2.0), ("minor", 0.5)]);
    let upright = |x: f64, r: f64| Arc::new([x, 0.0, 0.0], [[r, 0.0, 0.0], [0.0, 0.0, r]], 1.0).unwrap();
    expect_anywhere(&torus, &upright(2.0, 0.4), (0.0, 10.0), true, &[], "arc within the tube");
    expect_anywhere(&torus, &upright(2.0, 0.6), (0.0, 10.0), false, &[], "arc around the tube");
    // centres 0.3 apart, radii 0.6 and 0.5: 0.25 = 0.09 + 0.36 + 0.36 cos t
    let half = libm::acos((0.25 - 0.09 - 0.36) / 0.36);
    let arc = upright(2.3, 0.6);
    expect_anywhere(&torus, &arc, (0.0, 6.0), false, &[half, TAU - half], "arc beside the tube");
}

#[test]
fn projectile_and_floor() {
    // thrown from height 1 with speed (2, 3): down at (3 + sqrt(9 + 2 g)) / g
    let throw = Parabola::new([0.0, 0.0, 1.0], [2.0, 0.0, 3.0], [0.0, 0.0, -9.75]);
    let down = (3.0 + (9.0f64 + 19.5).sqrt()) / 9.75;
    let ground = half_space(Vec3::Z, 0.0);
    expect_anywhere(&ground, &throw, (0.0, 2.0), false, &[down], "throw on the ground");
    let program = Program::compile(&ground).unwrap();
    let crossing = trace_curve(&program, &throw, 0.0, 2.0).unwrap().crossings[0];
    assert_eq!(curve_normal(&program, &throw, &crossing), [0.0, 0.0, 1.0]);
    assert!((curve_point(&throw, &crossing)[0] - 2.0 * down).abs() < 1e-14);
}

/// A circle in shared faces: no overlap and no gap.
#[test]
fn circles_in_shared_faces() {
    let mut rng = Random::new(3);
    let below = block(Vec3::new(-2.0, -2.0, -1.0), Vec3::new(2.0, 2.0, 0.0));
    let above = block(Vec3::new(-2.0, -2.0, 0.0), Vec3::new(2.0, 2.0, 1.0));
    for round in 0..20 {
        let map = if round == 0 { Affine::IDENTITY } else { motion(&mut rng) };
        let arc = circle([0.0; 3], 1.0);
        let arc = Mapped::new(&arc, map);
        let (a, b) = (below.clone().apply(map), above.clone().apply(map));
        let full = |solid: Solid, inside: bool, what: &str| {
            expect(&solid, &arc, (0.0, 7.0), inside, &[], &format!("{what}, round {round}"));
        };
        full(a.clone() | b.clone(), true, "union");
        full(a.clone() & b.clone(), false, "intersection");
        full(a.clone() - a.clone(), false, "a solid minus itself");
        let (alone, minus) = (trace(&a, &arc, 0.0, 7.0), trace(&(a.clone() - b.clone()), &arc, 0.0, 7.0));
        assert_eq!((alone.start, times(&alone)), (minus.start, times(&minus)), "A - B = A");
        let b_placed = above.clone().place([map]);
        full(a.clone() | b_placed.clone(), true, "union with a placed solid");
        full(a & b_placed, false, "intersection with a placed solid");
    }
}

/// A curve that enters a shared face from above, follows it and leaves it below or above.
#[test]
fn curves_that_follow_a_shared_face() {
    let below = block(Vec3::new(-9.0, -9.0, -9.0), Vec3::new(9.0, 9.0, 0.0));
    let above = block(Vec3::new(-9.0, -9.0, 0.0), Vec3::new(9.0, 9.0, 9.0));
    // z falls as z (1 - s)^3 in a unit of time, or rises as z s^3: twice continuously differentiable
    let fall = |x: f64, z: f64| [[x, 0.0, z], [1.0, 0.0, -3.0 * z], [0.0, 0.0, 3.0 * z], [0.0, 0.0, -z]];
    let rise = |x: f64, z: f64| [[x, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0; 3], [0.0, 0.0, z]];
    let mut rng = Random::new(8);
    for (round, leave) in [2.0, -2.0].into_iter().cycle().take(20).enumerate() {
        let pieces = [fall(-1.0, 2.0), rise(0.0, 0.0), rise(1.0, leave)];
        let spline = Spline::from_pieces(&[-1.0, 0.0, 1.0, 2.0], &pieces).unwrap();
        let map = if round < 2 { Affine::IDENTITY } else { motion(&mut rng) };
        let path = Mapped::new(&spline, map);
        let (a, b) = (below.clone().apply(map), above.clone().apply(map));
        let of = |solid: Solid| trace(&solid, &path, -1.0, 2.0);
        let union = of(a.clone() | b.clone());
        assert_eq!((union.start, times(&union)), (RegionId(1), vec![]), "round {round}");
        let both = of(a.clone() & b.clone());
        assert_eq!((both.start, times(&both)), (RegionId(0), vec![]), "round {round}");
        // one crossing within the coincident span if the curve changes sides
        let one = of(a.clone());
        assert_eq!(
            (one.start, one.crossings.len()),
            (RegionId(0), usize::from(leave < 0.0)),
            "round {round}"
        );
        assert!(times(&one).iter().all(|t| (-1e-3..1.001).contains(t)), "{:?}", times(&one));
    }
}

#[test]
fn edges_corners_and_contacts() {
    let cube = shape("box", &[("size", 2.0)]);
    // a parabola through the edge x = 1, z = 1 and out at the bottom
    let dive = Parabola::new([2.0, 0.0, 2.0], [-1.0, 0.0, -1.0], [0.0, 0.0, 0.0]);
    expect_anywhere(&cube, &dive, (0.0, 9.0), false, &[1.0, 3.0], "line through two edges");
    let bent = Parabola::new([2.0, 0.25, 2.0], [-1.5, 0.0, -0.5], [1.0, 0.0, -1.0]);
    // x = 2 - 1.5 t + t^2 / 2 = 1 and z = 2 - t / 2 - t^2 / 2 = 1 at t = 1, where z = 1 has its only root > 0, and x
    // the first of 1 and 2; z = -1 at t = 2
    expect_anywhere(&cube, &bent, (0.0, 1.9), false, &[1.0], "parabola through an edge");
    // through the corner (1, 1, 1) from outside to outside: (1, 1, 1) + s (1, -1, 0) + s^2 (0, 0, 1)
    let past = Parabola::new([1.0, 1.0, 1.0], [1.0, -1.0, 0.0], [0.0, 0.0, 2.0]);
    expect_anywhere(&cube, &past, (-3.0, 3.0), false, &[], "past a corner");
    let along = Arc::new([1.0, 0.0, 0.0], [[0.0, 0.0, 2.0], [0.0, 2.0, 0.0]], 1.0).unwrap();
    let got = trace(&cube, &along, 0.0, TAU);
    assert!(got.crossings.is_empty(), "a circle in the plane of a face, around it: {got:?}");
    // two spheres that touch at the origin, crossed along the line of centres and across it
    let ball = |x: f64| shape("sphere", &[("radius", 1.0)]).apply(Affine::translate(Vec3::new(x, 0.0, 0.0)));
    let pair = ball(-1.0) | ball(1.0);
    let through = Parabola::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.125, 0.0]);
    let got = trace(&pair, &through, -3.0, 3.0);
    assert_eq!(got.crossings.len(), 2, "{got:?}");
    let between = Parabola::new([0.0; 3], [0.0, 1.0, 0.0], [0.0, 0.0, 0.25]);
    expect_anywhere(&pair, &between, (-3.0, 3.0), false, &[], "between two spheres");
}

/// Equal surfaces have equal bits: a stack of tiles has no gaps along any curve, and cemented parts have one crossing at their contact.
#[test]
fn tiles_in_contact() {
    let mut rng = Random::new(12);
    for round in 0..20 {
        let tiles: Vec<Solid> = (0..6)
            .map(|k| {
                let x = f64::from(k) - 3.0;
                block(Vec3::new(x, -1.0, -1.0), Vec3::new(x + 1.0, 1.0, 1.0))
            })
            .collect();
        let map = motion(&mut rng);
        let stack = Solid::union(tiles).apply(map);
        let wavy = Spline::new(
            &[0.0, 1.0, 2.0, 3.0, 4.0],
            &[[-4.0, 0.0, 0.0], [2.5, 0.5, 0.3], [-2.5, -0.5, 0.0], [2.0, 0.3, -0.5], [4.0, 0.0, 0.0]],
            SplineEnds::Natural,
        );
        let wavy = Mapped::new(wavy.unwrap(), map);
        let got = trace(&stack, &wavy, 0.0, 4.0);
        assert_eq!((got.start, got.crossings.len()), (RegionId(0), 2), "round {round}: {got:?}");
    }
}

/// A curve that violates its contract is rejected even if it misses everything.
#[test]
fn a_curve_that_violates_its_contract_is_rejected() {
    let cube = Program::compile(&shape("box", &[("size", 1.0)])).unwrap();
    let lying = curves_support::Own {
        position: |t: f64| [5.0 + libm::cos(t), libm::sin(t), 0.0],
        velocity: |t: f64| [-libm::sin(t), libm::cos(t), 0.0],
        bound: |_: f64, _: f64| 0.1,
    };
    let error = trace_curve(&cube, &lying, 0.0, 6.0).unwrap_err();
    assert!(matches!(error, CurveError::BoundViolated { bound: 0.1, .. }), "{error}");
    let window = trace_curve(&cube, &lying, 0.0, f64::INFINITY).unwrap_err();
    assert!(matches!(window, CurveError::Window { .. }), "{window}");
}

/// Random curves of all kinds through the volume of the random models.
fn random_curve(rng: &mut Random) -> (Box<dyn Curve<3>>, f64, f64) {
    let mut point = |half: f64| rng.point(half).to_array();
    let (p, v, a) = (point(2.5), point(1.5), point(1.0));
    match rng.below(6) {
        0 => (Box::new(Parabola::new(p, v, a)), -3.0, 3.0),
        1 => (Box::new(Arc::new(p, [v, a], 1.0).unwrap()), -4.0, 4.0),
        2 => (Box::new(Helix::new(p, v, a, rng.between(-3.0, 3.0)).unwrap()), -5.0, 5.0),
        3 => (Box::new(Arc::about(p, v, a, 1.0).unwrap()), -4.0, 4.0),
        4 => {
            let knots: Vec<f64> = (0..12).map(f64::from).collect();
            let points: Vec<Point<3>> = knots.iter().map(|_| rng.point(2.5).to_array()).collect();
            (Box::new(Spline::new(&knots, &points, SplineEnds::Natural).unwrap()), 0.0, 11.0)
        }
        _ => (Box::new(Line::new(p, v)), -3.0, 3.0),
    }
}

/// Checks that the medium at sampled points away from crossings agrees with the crossings.
fn check_by_sampling(
    reference: &Reference,
    curve: &dyn Curve<3>,
    t0: f64,
    t1: f64,
    samples: usize,
    what: &str,
) -> usize {
    let program = reference.program();
    let got = trace_curve(program, curve, t0, t1).unwrap();
    let step = (t1 - t0) / samples as f64;
    let at: Vec<f64> = (0..samples).map(|k| t0 + (k as f64 + 0.5) * step).collect();
    let mut columns: [Vec<f64>; 3] = Default::default();
    for &t in &at {
        let point = curve.position(t);
        (0..3).for_each(|k| columns[k].push(point[k]));
    }
    let mut regions = vec![RegionId(0); samples];
    let points = [&columns[0][..], &columns[1][..], &columns[2][..]];
    reference.regions_at(points, &mut reference.scratch(), &mut regions);
    let (mut medium, mut next) = (program.medium_of(got.start), 0);
    for (t, region) in at.into_iter().zip(regions) {
        while let Some(Crossing { after, .. }) = got.crossings.get(next).filter(|crossing| crossing.t <= t) {
            medium = program.medium_of(*after);
            next += 1;
        }
        let near = |k: usize| got.crossings.get(k).is_some_and(|crossing| (crossing.t - t).abs() < 1e-9);
        if !(near(next) || next > 0 && near(next - 1)) {
            assert_eq!(program.medium_of(region), medium, "{what} at {t}: {got:?}");
        }
    }
    check_crossings(program, curve, &got, what);
    got.crossings.len()
}

/// Checks that crossings are in order and on their faces, with unit normals against or along the curve.
fn check_crossings(program: &Program, curve: &dyn Curve<3>, got: &CurveTrace, what: &str) {
    let mut region = program.medium_of(got.start);
    for pair in got.crossings.windows(2) {
        assert!(pair[0].t < pair[1].t, "{what}");
    }
    for crossing in &got.crossings {
        let normal = Vec3::from_array(curve_normal(program, curve, crossing));
        let slope = normal.dot(Vec3::from_array(curve.velocity(crossing.t)));
        assert!((normal.length() - 1.0).abs() < 1e-14, "{what}");
        assert!(if crossing.enters() { slope <= 0.0 } else { slope >= 0.0 }, "{what}: {crossing:?}");
        assert_eq!(program.medium_of(crossing.before), region, "{what}");
        region = program.medium_of(crossing.after);
    }
}

fn sampled(seeds: std::ops::Range<u64>, curves: usize, samples: usize) -> usize {
    let mut crossings = 0;
    for seed in seeds {
        let mut rng = Random::new(seed);
        let model = Model::random(&mut rng, Style::Generic);
        let Ok(program) = model.compile() else { continue };
        let reference = Reference::new(program);
        for k in 0..curves {
            let (curve, t0, t1) = random_curve(&mut rng);
            let curve = Mapped::new(&*curve, model.frame);
            let what = format!("model {seed}, curve {k}");
            crossings += check_by_sampling(&reference, &curve, t0, t1, samples, &what);
        }
    }
    crossings
}

#[test]
fn dense_samples_find_nothing_else() {
    let crossings = sampled(0..60, 6, 400);
    assert!(crossings > 500, "{crossings}");
}

#[test]
#[ignore = "long"]
fn long_dense_samples_find_nothing_else() {
    let crossings = sampled(1000..1400, 20, 1000);
    assert!(crossings > 20_000, "{crossings}");
}

/// A curve split at the times of its crossings, with the sides of surfaces carried over: each
/// crossing is reported exactly once, by the piece before or after it. Without the sides, rounding
/// of the ends would lose crossings.
#[test]
fn pieces_that_end_on_faces() {
    let solid = block(Vec3::new(-1.0, -0.7, -0.5), Vec3::new(1.1, 0.8, 3.0))
        - block(Vec3::new(-0.4, -2.0, 0.3), Vec3::new(0.5, 2.0, 1.2));
    let program = Program::compile(&solid).unwrap();
    let helix = Helix::new([0.2, -0.1, -1.0], [0.9, 0.1, 0.21], [0.0, 0.0, 1.0], 0.8).unwrap();
    let whole = trace_curve(&program, &helix, 0.0, 15.0).unwrap();
    let want = times(&whole);
    assert!(want.len() > 4, "{want:?}");
    let cuts: Vec<f64> = [0.0].into_iter().chain(want.iter().copied()).chain([15.0]).collect();
    let (mut sides, mut found, mut now) = (Vec::new(), Vec::new(), whole.start);
    for pair in cuts.windows(2) {
        let piece = trace_curve_from(&program, &helix, pair[0], pair[1], &mut sides).unwrap();
        assert_eq!(piece.start, now);
        found.extend(times(&piece));
        now = piece.crossings.last().map_or(now, |crossing| crossing.after);
    }
    assert_eq!(found.len(), want.len(), "{found:?} {want:?}");
    assert!(found.iter().zip(&want).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {want:?}");
}

/// A curve that begins on a face starts on the given side, for any rounding of the first point.
#[test]
fn curves_that_begin_on_faces() {
    let program = Program::compile(&shape("sphere", &[("radius", 2.0)])).unwrap();
    let mut rng = Random::new(11);
    for _ in 0..300 {
        let unit = rng.direction();
        let inwards = -unit + 0.9 * unit.any_orthonormal_vector();
        for inside in [true, false] {
            let start = if inside { inwards } else { unit };
            let curve = Parabola::new((2.0 * unit).to_array(), start.to_array(), [0.01, 0.0, -0.02]);
            let (surface, placement) = (SurfaceId(0), PlacementId(0));
            let mut sides = vec![Start { surface, placement, inside }];
            let found = trace_curve_from(&program, &curve, 0.0, 5.0, &mut sides).unwrap();
            assert_eq!(found.start, RegionId(u32::from(inside)));
            assert_eq!(found.crossings.len(), usize::from(inside));
            assert!(!sides[0].inside);
        }
    }
}
