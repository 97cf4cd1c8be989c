//! Infill compared with closed forms; infill of plane regions compared with that of solids.

use super::*;
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::Vec3;
use rayweave_model::{Program, Region, Solid};
use rayweave_polygon::{Polygons, from_polygons};
use rayweave_rootray::Side;
use rayweave_shape::primitive::{BoxFromCorners, Cylinder, HalfSpace, Primitive, Sphere};
use rayweave_trace::{Reference, Weave};
use std::num::NonZeroUsize;
use std::sync::Arc;

fn filling(spacing: f64, angle: f64, phase: f64) -> Filling {
    Filling { raster: Raster::new(spacing, angle, phase).unwrap(), turn: 0.0, alternate: false }
}

/// Runs an infill with a `take` that never fails, so the only errors are those of the run.
fn fill_with<F: Fillable>(
    fillable: &F,
    filling: &Filling,
    layers: &Layers,
    run: &InfillRun,
) -> Result<(Vec<LayerTraces>, Summary), InfillError> {
    let mut all = Vec::new();
    let summary = infill(fillable, filling, layers, run, |layer| {
        all.push(layer);
        Ok::<(), InfillError>(())
    })?;
    Ok((all, summary))
}

fn fill<F: Fillable>(fillable: &F, filling: &Filling, layers: &Layers) -> Vec<LayerTraces> {
    fill_with(fillable, filling, layers, &InfillRun::default()).unwrap().0
}

fn flat(contours: &[Vec<[f64; 2]>]) -> Polygons {
    from_polygons(contours, Side::Outside).unwrap()
}

fn floor() -> Layers {
    Layers::At(vec![0.0])
}

fn square(size: f64) -> Vec<[f64; 2]> {
    vec![[0.0, 0.0], [size, 0.0], [size, size], [0.0, size]]
}

fn solid(primitive: impl Into<Primitive>) -> Solid {
    Solid::from(primitive.into())
}

fn plate(lo: [f64; 3], hi: [f64; 3]) -> Solid {
    solid(BoxFromCorners::new(lo.into(), hi.into()).unwrap())
}

fn weave(solid: &Solid) -> Weave {
    Weave::new(Arc::new(Program::compile(solid).unwrap()))
}

fn length(layer: &LayerTraces) -> f64 {
    layer.traces.iter().map(InfillTrace::length).sum()
}

#[test]
fn a_square_is_covered_exactly() {
    let layers = fill(&flat(&[square(10.0)]), &filling(1.0, 0.0, 0.0), &floor());
    let expected: Vec<InfillTrace> = (0..10)
        .map(|k| InfillTrace { scanline: k, component: 0, from: [0.0, k as f64], to: [10.0, k as f64] })
        .collect();
    assert_eq!(layers, [LayerTraces { layer: 0, z: 0.0, traces: expected.clone(), components: 1 }]);
    let cube = weave(&plate([0.0; 3], [10.0; 3]));
    assert_eq!(fill(&Slices(&cube), &filling(1.0, 0.0, 0.0), &Layers::At(vec![3.0]))[0].traces, expected);
    // the other quarter turns use the same grid in other directions; line k is at x = -k for 90 degrees
    for (angle, lines) in [(90.0, -9..=0), (180.0, -9..=0), (270.0, 0..=9)] {
        let layer = &fill(&flat(&[square(10.0)]), &filling(1.0, angle, 0.0), &floor())[0];
        let found: Vec<i64> = layer.traces.iter().map(|trace| trace.scanline).collect();
        assert_eq!((found, length(layer)), (lines.collect(), 100.0), "{angle}");
    }
    // the phase shifts all lines; a phase of 1 shifts them by one line
    let levels = |phase| {
        let layers = fill(&flat(&[square(2.0)]), &filling(1.0, 0.0, phase), &floor());
        layers[0].traces.iter().map(|trace| (trace.scanline, trace.from[1])).collect::<Vec<_>>()
    };
    assert_eq!(levels(0.25), [(0, 0.25), (1, 1.25)]);
    assert_eq!(levels(1.0), [(-1, 0.0), (0, 1.0)]);
}

/// The sum of a function's values on a grid, times the spacing, differs from its integral by at most its
/// total variation times the spacing; the chord length of a convex region rises once to its maximum and falls
/// once.
fn check_area(layer: &LayerTraces, spacing: f64, area: f64, longest: f64, what: &str) {
    let covered = spacing * length(layer);
    assert!((covered - area).abs() <= 2.0 * longest * spacing, "{what}: {covered} {area}");
}

#[test]
fn areas_at_all_angles() {
    use std::f64::consts::PI;
    let disk = weave(&solid(Cylinder::new(5.0, 2.0).unwrap()));
    let bored = weave(&(plate([-6.0, -4.0, 0.0], [6.0, 4.0, 2.0]) - solid(Cylinder::new(3.0, 9.0).unwrap())));
    let frame = flat(&[square(10.0), square(4.0).iter().rev().map(|p| [p[0] + 3.0, p[1] + 3.0]).collect()]);
    for step in -12..=24 {
        let angle = 15.0 * f64::from(step) + 0.25;
        for spacing in [0.05, 0.3] {
            let filling = filling(spacing, angle, 0.4);
            let what = format!("{angle} {spacing}");
            let middle = Layers::At(vec![0.5]);
            check_area(&fill(&Slices(&disk), &filling, &middle)[0], spacing, 25.0 * PI, 10.0, &what);
            // two convex regions, one subtracted from the other
            let area = 96.0 - 9.0 * PI;
            check_area(&fill(&Slices(&bored), &filling, &middle)[0], spacing, area, 15.0 + 6.0, &what);
            check_area(&fill(&frame, &filling, &floor())[0], spacing, 84.0, 15.0 + 6.0, &what);
        }
    }
}

#[test]
fn a_ball_by_layers_has_its_volume() {
    let ball = weave(&solid(Sphere::new(3.0).unwrap()));
    let (height, spacing) = (0.1, 0.05);
    let (layers, summary) = fill_with(
        &Slices(&ball),
        &filling(spacing, 30.0, 0.5),
        &Layers::Every(height),
        &InfillRun::default(),
    )
    .unwrap();
    assert_eq!((layers.len(), summary.layers, summary.empty.len()), (60, 60, 0));
    for (j, layer) in layers.iter().enumerate() {
        assert!(layer.layer == j && (layer.z - (-2.95 + 0.1 * j as f64)).abs() < 1e-12, "{}", layer.z);
        assert_eq!(layer.components, 1);
    }
    let volume = height * spacing * summary.length;
    // layers: the variation of the area, 2 x 9 pi, times the height; lines: the variation of the chords, at most
    // 12, over a height of 6
    let bound = height * 18.0 * std::f64::consts::PI + 6.0 * 12.0 * spacing;
    assert!((volume - 36.0 * std::f64::consts::PI).abs() < bound, "{volume}");
    let sum: f64 = layers.iter().map(length).sum();
    assert!(
        (sum - summary.length).abs() < 1e-9 * sum
            && summary.traces as usize == layers.iter().map(|l| l.traces.len()).sum::<usize>()
    );
}

/// The box of an intersection of balls reaches to 2 along z, the intersection itself to sqrt(7) / 2.
#[test]
fn layers_begin_at_the_lowest_point() {
    let ball = solid(Sphere::new(2.0).unwrap());
    let lens = &ball & &ball.translate([3.0, 0.0, 0.0]);
    let (height, filling) = (0.25, filling(0.05, 0.0, 0.0));
    let layers = fill(&Slices(&weave(&lens)), &filling, &Layers::Every(height));
    let top = 1.75f64.sqrt();
    assert_eq!(layers.len(), 11);
    for (j, layer) in layers.iter().enumerate() {
        let z = -top + (j as f64 + 0.5) * height;
        assert!((layer.z - z).abs() < 1e-8 && !layer.traces.is_empty(), "{j}: {} {z}", layer.z);
    }
    // thinner than the distance of the rays that search for the extent; a scan line passes through it
    let needle = solid(Cylinder::new(1e-4, 3.8).unwrap()).translate([1.5, 0.0, 0.0]);
    let layers = fill(&Slices(&weave(&(&lens | &needle))), &filling, &Layers::Every(height));
    assert!(layers.iter().all(|layer| !layer.traces.is_empty()));
    let (first, last) = (layers[0].z, layers[layers.len() - 1].z);
    assert!(first > -1.9 && first - height < -1.9 && last < 1.9 && last + height > 1.9, "{first} {last}");
}

#[test]
fn turning_region_and_raster_changes_no_length() {
    let shape = [[0.0, 0.0], [7.0, 1.0], [5.0, 3.0], [8.0, 6.0], [2.0, 5.0], [3.0, 3.0]];
    let at_rest = fill(&flat(&[shape.to_vec()]), &filling(0.25, 0.0, 0.3), &floor());
    for angle in [17.0, 90.0, 123.4, -60.0, 720.5] {
        let (sin, cos) = rayweave_math::sin_cos_degrees(angle);
        let turned = shape.map(|[x, y]| [cos * x - sin * y, sin * x + cos * y]);
        let layers = fill(&flat(&[turned.to_vec()]), &filling(0.25, angle, 0.3), &floor());
        assert_eq!(layers[0].components, at_rest[0].components);
        assert_eq!(layers[0].traces.len(), at_rest[0].traces.len());
        for (a, b) in at_rest[0].traces.iter().zip(&layers[0].traces) {
            assert_eq!((a.scanline, a.component), (b.scanline, b.component));
            assert!((a.length() - b.length()).abs() < 1e-12, "{angle} {a:?} {b:?}");
        }
    }
}

#[test]
fn prisms_are_filled_like_their_bases() {
    let mut rng = ChaCha8Rng::seed_from_u64(21);
    for _ in 0..40 {
        // star-shaped polygons about the origin are simple
        let n = rng.random_range(3..40);
        let corner = |k: usize, radius: f64| {
            let (sin, cos) = rayweave_math::sin_cos_degrees(360.0 * k as f64 / n as f64);
            [radius * cos, radius * sin]
        };
        let base: Vec<[f64; 2]> = (0..n).map(|k| corner(k, rng.random_range(1.0..5.0))).collect();
        let hole: Vec<[f64; 2]> = (0..n).rev().map(|k| corner(k, 0.2)).collect();
        let base = flat(&[base, hole]);
        let prism = weave(&base.extrude(-1.0, 1.0).unwrap());
        let filling = filling(0.13, rng.random_range(-180.0..180.0), 0.2);
        let (plane, space) = (fill(&base, &filling, &floor()), fill(&Slices(&prism), &filling, &floor()));
        assert_eq!(
            (plane[0].traces.len(), plane[0].components),
            (space[0].traces.len(), space[0].components)
        );
        for (a, b) in plane[0].traces.iter().zip(&space[0].traces) {
            assert_eq!((a.scanline, a.component), (b.scanline, b.component));
            let near = |p: [f64; 2], q: [f64; 2]| (0..2).all(|k| (p[k] - q[k]).abs() < 1e-11);
            assert!(near(a.from, b.from) && near(a.to, b.to), "{a:?} {b:?}");
        }
    }
}

#[test]
fn any_threads_and_any_evaluator_give_the_same_bits() {
    let shape = solid(Sphere::new(4.0).unwrap()) - solid(Cylinder::new(1.0, f64::INFINITY).unwrap());
    let filling = Filling { turn: 33.0, alternate: true, ..filling(0.004, 10.0, 0.0) };
    let with = |threads: usize| {
        let run = InfillRun { threads: NonZeroUsize::new(threads), ..InfillRun::default() };
        fill_with(&Slices(&weave(&shape)), &filling, &Layers::Every(2.0), &run).unwrap()
    };
    let (layers, summary) = with(1);
    assert!(layers.len() == 4 && summary.traces > 4000);
    assert_eq!((layers.clone(), summary.clone()), with(3));
    let reference = Reference::new(Arc::new(Program::compile(&shape).unwrap()));
    let other = fill_with(&Slices(&reference), &filling, &Layers::Every(2.0), &InfillRun::default()).unwrap();
    assert_eq!((layers, summary), other);
}

#[test]
fn components_hang_together() {
    let count = |contours: &[Vec<[f64; 2]>], angle| {
        let layers = fill(&flat(contours), &filling(0.1, angle, 0.5), &floor());
        (layers[0].components, layers[0].traces.iter().map(|trace| trace.component).max())
    };
    let moved = |x: f64, y: f64| square(4.0).iter().map(|p| [p[0] + x, p[1] + y]).collect::<Vec<_>>();
    let ring: Vec<[f64; 2]> = square(10.0);
    let hole: Vec<[f64; 2]> = moved(3.0, 3.0).into_iter().rev().collect();
    for angle in [0.0, 45.0, 90.0, 200.0] {
        assert_eq!(count(&[moved(0.0, 0.0), moved(10.0, 0.0), moved(3.0, 20.0)], angle), (3, Some(2)));
        assert_eq!(count(&[ring.clone(), hole.clone()], angle), (1, Some(0)));
    }
}

#[test]
fn layers_turn_and_lines_alternate() {
    let cube = weave(&plate([0.0; 3], [4.0; 3]));
    let settings = Filling { turn: 90.0, alternate: true, ..filling(1.0, 0.0, 0.5) };
    let layers = fill(&Slices(&cube), &settings, &Layers::At(vec![1.0, 2.0]));
    let ends =
        |layer: &LayerTraces| layer.traces.iter().map(|t| (t.scanline, t.from, t.to)).collect::<Vec<_>>();
    assert_eq!(ends(&layers[0])[..2], [(0, [0.0, 0.5], [4.0, 0.5]), (1, [4.0, 1.5], [0.0, 1.5])]);
    // line k is at x = -(k + 1/2)
    assert_eq!(ends(&layers[1])[2..], [(-2, [1.5, 0.0], [1.5, 4.0]), (-1, [0.5, 4.0], [0.5, 0.0])]);
    // a line with two traces is run backwards as a whole
    let two = flat(&[square(1.0), square(1.0).iter().map(|p| [p[0] + 3.0, p[1]]).collect()]);
    let settings = Filling { alternate: true, ..filling(1.0, 180.0, 0.5) };
    let [a, b] = fill(&two, &settings, &floor())[0].traces[..] else { panic!() };
    assert_eq!((a.scanline, a.from, a.to, a.component), (-1, [0.0, 0.5], [1.0, 0.5], 0));
    assert_eq!((b.from, b.to, b.component), ([3.0, 0.5], [4.0, 0.5], 1));
}

#[test]
fn layers_beyond_the_solid_are_empty_and_reported() {
    let cube = weave(&plate([0.0; 3], [4.0; 3]));
    let layers = Layers::At(vec![9.0, 2.0, -1.0]);
    let (layers, summary) =
        fill_with(&Slices(&cube), &filling(1.0, 0.0, 0.0), &layers, &InfillRun::default()).unwrap();
    assert_eq!(layers.iter().map(|layer| layer.traces.len()).collect::<Vec<_>>(), [0, 4, 0]);
    assert_eq!((summary.layers, summary.empty), (3, vec![0, 2]));
}

#[test]
fn unfillable_solids_are_named() {
    let message = |solid: &Solid, spacing: f64, layers: Layers| {
        let filling = filling(spacing, 0.0, 0.0);
        fill_with(&Slices(&weave(solid)), &filling, &layers, &InfillRun::default()).unwrap_err().to_string()
    };
    let cube = plate([0.0; 3], [4.0; 3]);
    let half = solid(HalfSpace::new(Vec3::X, 1.0).unwrap());
    let text = message(&Solid::empty(), 1.0, floor());
    assert!(text.contains("is empty: there is nothing to fill."), "{text}");
    let text = message(&(&cube & &solid(Sphere::new(1.0).unwrap()).translate([9.0, 0.0, 0.0])), 1.0, floor());
    assert!(text.contains("is empty"), "{text}");
    assert!(message(&half, 1.0, floor()).contains("unbounded in x and y: scan lines would never end."));
    let bar = solid(Cylinder::new(1.0, f64::INFINITY).unwrap());
    assert!(message(&bar, 1.0, Layers::Every(1.0)).contains("unbounded in z"));
    assert_eq!(fill(&Slices(&weave(&bar)), &filling(1.0, 0.0, 0.5), &floor())[0].traces.len(), 2);
    let text = message(&cube, 1e-9, floor());
    assert!(text.contains("4e9 scan lines: at most 10000000"), "{text}");
    assert!(
        message(&cube, 1e-5, Layers::Every(0.01)).contains("1.6e8 scan lines"),
        "{}",
        message(&cube, 1e-5, Layers::Every(0.01))
    );
    assert!(message(&cube, 1e-30, floor()).contains("Use a larger spacing."));
    let region = Region { name: "plate".to_owned(), solid: half, medium: 1 };
    let model = Weave::new(Arc::new(Program::compile_regions(&[region]).unwrap()));
    let error =
        fill_with(&Slices(&model), &filling(1.0, 0.0, 0.0), &floor(), &InfillRun::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "plate is unbounded in x and y: scan lines would never end. Intersect it with a box."
    );
    let all = from_polygons(&[square(1.0).into_iter().rev().collect::<Vec<_>>()], Side::Inside).unwrap();
    assert!(fill_with(&all, &filling(1.0, 0.0, 0.0), &floor(), &InfillRun::default()).is_err());
}

#[test]
fn settings_out_of_range() {
    let message = |spacing, angle, phase| Raster::new(spacing, angle, phase).unwrap_err().to_string();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(message(bad, 0.0, 0.0).starts_with("the spacing is "), "{bad}");
    }
    assert!(message(1.0, f64::NAN, 0.0).starts_with("the angle is NaN"));
    for bad in [-0.1, 1.1, f64::NAN] {
        assert!(message(1.0, 0.0, bad).contains("from 0 to 1"), "{bad}");
    }
    let filling = Filling { turn: f64::INFINITY, ..filling(1.0, 0.0, 0.0) };
    let error = fill_with(&flat(&[square(1.0)]), &filling, &floor(), &InfillRun::default()).unwrap_err();
    assert!(matches!(error, InfillError::Turn(_)));
    // the angles are finite up to the third layer
    let filling = Filling { raster: Raster::new(1.0, 1e308, 0.0).unwrap(), turn: 5e307, alternate: false };
    let layers = Layers::At(vec![0.0; 3]);
    let error = fill_with(&flat(&[square(1.0)]), &filling, &layers, &InfillRun::default()).unwrap_err();
    assert!(matches!(error, InfillError::Turn(_)), "{error}");
}

/// Scan lines far beyond the region are not traced: they may be too far away for rays.
#[test]
fn a_spacing_larger_than_numbers_can_be_traced_loses_no_line() {
    let middle = vec![[-1.0, -1.0], [2.0, -1.0], [2.0, 3.0], [-1.0, 3.0]];
    let bar = weave(&plate([-1.0, -1.0, -1.0], [2.0, 3.0, 1.0]));
    for spacing in [1e10, 1e59, 1e61, 1e120, 1e300, f64::MAX] {
        for angle in [0.0, 90.0, 30.0] {
            let through_origin = filling(spacing, angle, 0.0);
            let layer = &fill(&flat(std::slice::from_ref(&middle)), &through_origin, &floor())[0];
            assert_eq!(layer.traces.len(), 1, "{spacing:e} {angle}");
            assert_eq!(fill(&Slices(&bar), &through_origin, &floor())[0].traces.len(), 1);
            // between two lines there is no trace, but the layer is reported
            let beside = fill(&flat(std::slice::from_ref(&middle)), &filling(spacing, angle, 0.5), &floor());
            assert_eq!(beside.iter().map(|layer| layer.traces.len()).collect::<Vec<_>>(), [0]);
        }
    }
    // at the largest allowed distance
    for angle in [0.0, 45.0, 90.0] {
        let far = square(1e59);
        let layer = &fill(&flat(std::slice::from_ref(&far)), &filling(1e58, angle, 0.5), &floor())[0];
        let area = length(layer) * 1e58;
        assert!((area / 1e118 - 1.0).abs() < 0.01, "{angle}: {area:e}");
    }
    let error = fill_with(&flat(&[square(1e60)]), &filling(1e59, 0.0, 0.0), &floor(), &InfillRun::default());
    assert!(matches!(error, Err(InfillError::TooFar { .. })), "{error:?}");
}

#[test]
fn a_run_can_be_stopped() {
    let run = InfillRun::default();
    run.cancel.cancel();
    let outcome = fill_with(&flat(&[square(1.0)]), &filling(0.1, 0.0, 0.0), &floor(), &run);
    assert_eq!(outcome, Err(InfillError::Cancelled));
}
