//! Tests of comparisons against closed forms, and with models that are the same by construction.

use super::*;
use crate::measure;
use rayweave_error::ErrorKind;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::drive::Cancel;
use rayweave_scene::Unit;
use rayweave_trace::AnyEvaluator;
use std::f64::consts::PI;
use std::num::NonZeroUsize;

fn scene(text: &str) -> Scene {
    rayweave_scene::parse(&format!("rayweave = 1\n{text}")).unwrap().1
}

fn quick() -> DiffSettings {
    measured(measure::MeasureSettings { most_rays: 1 << 17, ..DiffSettings::default().measure })
}

fn measured(measure: measure::MeasureSettings) -> DiffSettings {
    DiffSettings { across: 32, measure, ..DiffSettings::default() }
}

fn compared(a: &str, b: &str, settings: &DiffSettings) -> DiffReport {
    diff(&scene(a), &scene(b), AnyEvaluator::maker(None), settings, &mut |_| ()).unwrap()
}

const BALL: &str = "[solid.ball]\nsphere = { radius = 1 }";

fn ball(radius: f64) -> String {
    format!("[solid.ball]\nsphere = {{ radius = {radius} }}")
}

#[test]
fn different_descriptions_of_the_same_solid() {
    let proved = compared(BALL, BALL, &quick());
    assert!(proved.is_same() && proved.pairs[0].is_proved && proved.worst().is_none());
    // the same position through different maps and in a different unit: equal up to rounding
    let moved = "unit = \"in\"\n[solid.r]\ntorus = { major = 3, minor = 1 }\n\
        transform = [{ rotate_x = 33 }, { translate = [0.1, 0.2, 0.3] }]";
    let again = "unit = \"mm\"\n[solid.r]\ntorus = { major = 76.2, minor = 25.4 }\n\
        transform = [{ rotate_x = 11 }, { rotate_x = 22 }, { translate = [2.54, 0, 7.62] }, { translate = [0, 5.08, 0] }]";
    let report = compared(moved, again, &quick());
    assert!(report.is_same() && !report.pairs[0].is_proved, "{report:?}");
    assert!(report.pairs[0].both.contains(2.0 * PI * PI * 3.0), "{report:?}");
    assert_eq!(report.unit, Unit::Inch);
    // a box primitive and an intersection of slabs
    let cube = "[solid.a]\nbox = { size = 2 }";
    let planes = "[solid.x]\nslab = { normal = [1, 0, 0], lo = -1, hi = 1 }\n[solid.y]\nslab = { normal = [0, 1, 0], lo = -1, hi = 1 }\n\
        [solid.z]\nslab = { normal = [0, 0, 1], lo = -1, hi = 1 }\n[solid.all]\nexpr = \"x & y & z\"\n[[region]]\nsolid = \"all\"";
    assert!(compared(cube, planes, &quick()).is_same());
}

/// Two holes, one of them displaced, and a knob: each place by its volume and centre, the largest first.
#[test]
fn each_connected_place_is_listed() {
    let plate = "[solid.plate]\nbox_from_corners = { lo = [0, 0, 0], hi = [60, 40, 10] }\n";
    let a = format!(
        "{plate}[solid.hole]\ncylinder = {{ radius = 3 }}\ntransform = {{ translate = [15, 20, 0] }}\n\
        [solid.part]\nexpr = \"plate - hole\"\n[[region]]\nsolid = \"part\""
    );
    let b = format!(
        "{plate}[solid.knob]\nbox_from_corners = {{ lo = [40, 10, 5], hi = [44, 16, 12] }}\n\
        [solid.slot]\nbox_from_corners = {{ lo = [50, 30, -1], hi = [51, 31, 11] }}\n\
        [solid.part]\nexpr = \"(plate | knob) - slot\"\n[[region]]\nsolid = \"part\""
    );
    let report = compared(&a, &b, &quick());
    let places = &report.pairs[0].places;
    let expected = [
        (false, 90.0 * PI, Vec3::new(15.0, 20.0, 5.0)),
        (false, 48.0, Vec3::new(42.0, 13.0, 11.0)),
        (true, 10.0, Vec3::new(50.5, 30.5, 5.0)),
    ];
    assert_eq!(places.len(), 3, "{places:?}");
    for (place, (is_a, volume, centre)) in places.iter().zip(expected) {
        assert_eq!(place.is_a, is_a, "{places:?}");
        assert!((place.volume / volume - 1.0).abs() < 0.01, "{place:?}, {volume}");
        assert!((place.centre - centre).length() < 0.2, "{place:?}");
        assert!(place.bounds.contains(place.centre));
    }
    assert!(compared(&a, &a, &quick()).pairs[0].places.is_empty());
}

/// Six counterbores around bolt holes: each volume is that of a ring, and the errors have both signs.
#[test]
fn volumes_of_equal_places_are_unbiased() {
    let a = "[solid.disc]\ncylinder = { radius = 40, height = 10 }\n[solid.hole]\ncylinder = { radius = 3.3 }\n\
        [solid.holes]\nplace = { solid = \"hole\", ring = 6, radius = 30, start = 30 }\n\
        [solid.part]\nexpr = \"disc - holes\"\n[[region]]\nsolid = \"part\"";
    let b = a.replace("disc - holes", "disc - holes - sinks")
        + "\n[solid.sink]\ncylinder = { radius = 5.5, height = 12 }\ntransform = { translate = [0, 0, 5] }\n\
           [solid.sinks]\nplace = { solid = \"sink\", ring = 6, radius = 30, start = 30 }\n";
    let report = compared(a, &b, &quick());
    let places = &report.pairs[0].places;
    let expected = PI * (5.5 * 5.5 - 3.3 * 3.3) * 6.0;
    let errors: Vec<f64> = places.iter().map(|place| place.volume / expected - 1.0).collect();
    assert_eq!(errors.len(), 6, "{places:?}");
    assert!(errors.iter().all(|error| error.abs() < 6e-3), "{errors:?}");
    assert!(errors.iter().sum::<f64>().abs() / 6.0 < 2e-3, "{errors:?}");
}

/// A shell thinner than the accepted thickness is not a difference, although rays near its rim have long pieces in it.
#[test]
fn thin_differences_are_ignored() {
    let shell = |radius: f64, distance: f64| {
        compared(BALL, &ball(radius), &DiffSettings { distance: Some(distance), ..quick() })
    };
    for gap in [1e-3, 1e-6, 1e-9] {
        let same = shell(1.0 + gap, 4.1 * gap);
        assert!(same.is_same() && same.pairs[0].b_only.value > 0.0, "{gap}: {same:?}");
        let other = shell(1.0 + gap, 0.5 * gap);
        let spot = other.pairs[0].spot.unwrap();
        assert!(!other.is_same() && !spot.is_a, "{gap}: {other:?}");
        assert!(spot.thickness > 0.99 * gap && spot.thickness < 4.1 * gap, "{gap}: {spot:?}");
        // the reported point lies between the two spheres
        let r = spot.at.length();
        assert!(r > 1.0 - 1e-12 && r < 1.0 + gap + 1e-12, "{r}");
    }
    // rounding is accepted by default
    assert!(compared(BALL, &ball(1.0 + 1e-13), &quick()).is_same());
    assert!(!compared(BALL, &ball(1.0 + 1e-7), &quick()).is_same());
}

#[test]
fn volumes_and_positions_of_differences() {
    let moved = format!("{BALL}\ntransform = [{{ translate = [1, 0, 0] }}]");
    let report = compared(BALL, &moved, &quick());
    let pair = &report.pairs[0];
    // two balls of radius 1 with centres at distance 1: the volume of their intersection is 5 pi / 12
    let common = 5.0 / 12.0 * PI;
    let rest = 4.0 / 3.0 * PI - common;
    assert!(
        pair.both.contains(common) && pair.a_only.contains(rest) && pair.b_only.contains(rest),
        "{pair:?}"
    );
    let place = pair.place.unwrap();
    assert!(place.lo.x > -1.001 && place.lo.x < -0.9 && place.hi.x < 2.001 && place.hi.x > 1.9, "{place:?}");
    let spot = pair.spot.unwrap();
    assert!(spot.thickness > 0.9 && spot.thickness <= 1.0 + 1e-9, "{spot:?}");
    assert!(if spot.is_a { spot.at.x < 0.5 } else { spot.at.x > 0.5 }, "{spot:?}");
    let section =
        diff_section(&scene(BALL), &scene(&moved), &report, AnyEvaluator::maker(None), &quick(), None)
            .unwrap();
    let names: Vec<&str> = section.parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["both", "A only", "B only"]);
}

const TWO: &str = "[solid.bath]\nbox = { size = 4 }\n[solid.ball]\nsphere = { radius = 1 }\n\
    [[region]]\nsolid = \"bath\"\nmedium = \"water\"\n[[region]]\nsolid = \"ball\"\nmedium = \"glass\"\n[medium.water]\n[medium.glass]";

#[test]
fn region_by_region() {
    let other = TWO.replace("radius = 1", "radius = 1.1");
    let report = compared(TWO, &other, &quick());
    let [bath, ball] = &report.pairs[..] else { panic!("{report:?}") };
    let shell = 4.0 / 3.0 * PI * (1.331 - 1.0);
    assert!(report.by == Match::Region && !bath.is_same && !ball.is_same);
    // the larger ball takes the shell from the bath
    assert!(
        bath.a_only.contains(shell) && bath.b_only.value == 0.0 && ball.b_only.contains(shell),
        "{report:?}"
    );
    let whole = compared(TWO, &other, &DiffSettings { by: Match::Whole, ..quick() });
    assert!(whole.is_same() && (whole.pairs[0].both.value - 64.0).abs() < 1e-9, "{whole:?}");
    let renamed = TWO.replace("ball", "bead");
    let report = compared(TWO, &renamed, &quick());
    let found: Vec<_> =
        report.pairs.iter().map(|pair| (pair.name.as_str(), pair.is_in, pair.is_same)).collect();
    let expected =
        [("bath", [true; 2], true), ("ball", [true, false], false), ("bead", [false, true], false)];
    assert_eq!(found, expected);
    assert!(compared(TWO, &renamed, &DiffSettings { by: Match::Medium, ..quick() }).is_same());
}

#[test]
fn unbounded_models_need_a_box() {
    let below = |at: f64| format!("[solid.floor]\nhalf_space = {{ normal = [0, 0, 1], offset = {at} }}");
    let error =
        diff(&scene(&below(0.0)), &scene(&below(0.5)), AnyEvaluator::maker(None), &quick(), &mut |_| ())
            .unwrap_err();
    assert!(
        error.kind() == ErrorKind::Solid
            && error
                .to_string()
                .ends_with("Compare the parts within a box: --within LO HI, in Python within=(lo, hi)."),
        "{error}"
    );
    let within = Some(Bounds { lo: Vec3::splat(-1.0), hi: Vec3::new(1.0, 1.0, 2.0) });
    let report =
        compared(&below(0.0), &below(0.5), &measured(measure::MeasureSettings { within, ..quick().measure }));
    assert!((report.pairs[0].b_only.value - 2.0).abs() < 1e-9, "{report:?}");
    assert!((report.pairs[0].spot.unwrap().thickness - 0.5).abs() < 1e-12, "{report:?}");
}

#[test]
fn results_do_not_depend_on_threads_and_invalid_settings_fail() {
    let on = |threads: usize| {
        let threads = NonZeroUsize::new(threads);
        compared(BALL, &ball(1.2), &measured(measure::MeasureSettings { threads, ..quick().measure }))
    };
    assert_eq!(on(1), on(3));
    let message = |settings: DiffSettings| {
        diff(&scene(BALL), &scene(BALL), AnyEvaluator::maker(None), &settings, &mut |_| ())
            .unwrap_err()
            .to_string()
    };
    assert!(message(DiffSettings { distance: Some(-1.0), ..quick() }).starts_with("the distance is -1"));
    assert!(message(DiffSettings { distance: Some(f64::NAN), ..quick() }).starts_with("the distance is NaN"));
    assert!(message(DiffSettings { across: 0, ..quick() }).starts_with("the number of cells across is 0"));
    assert!(
        message(measured(measure::MeasureSettings { precision: 0.0, ..quick().measure }))
            .starts_with("the precision is 0")
    );
    let cancel = Cancel::new();
    cancel.cancel();
    assert_eq!(message(measured(measure::MeasureSettings { cancel, ..quick().measure })), "cancelled");
}

/// Rays along the bristles of a brush have more than 4,096 pieces that are longer than the difference beside the brush.
#[test]
fn differences_behind_many_long_pieces_are_found() {
    let plate = "[solid.plate]\nbox_from_corners = { lo = [0, 0, -0.1], hi = [1.6, 1, 0] }\n";
    let brush = "[solid.bristle]\nbox_from_corners = { lo = [0, 0, 0], hi = [0.045, 0.045, 1] }\n\
        [solid.brush]\nplace = { solid = 'bristle', grid = [20, 20, 1], step = [0.05, 0.05, 1] }\n";
    let cube = "[solid.cube]\nbox_from_corners = { lo = [1.1, 0, 0], hi = [1.5, 0.4, 0.4] }\n";
    let settings = DiffSettings { distance: Some(0.1), by: Match::Whole, across: 96, ..quick() };
    let found = |more: &str| compared(plate, &format!("{plate}{brush}{more}"), &settings);
    assert!(found("").is_same());
    let spot = found(cube).pairs[0].spot.unwrap();
    assert!((spot.thickness - 0.4).abs() < 1e-9, "{spot:?}");
}

/// The difference of two holes is half the difference of their diameters, and that of a circle and a polygon in it the sagitta,
/// whatever the directions of the rays.
#[test]
fn thicknesses_of_curved_differences_are_perpendicular() {
    let plate = |radius: f64| {
        format!(
            "[solid.disc]\ncylinder = {{ radius = 50, height = 12 }}\n[solid.hole]\ncylinder = {{ radius = {radius}, height = 20 }}\n\
             transform = [{{ translate = [37.5, 0, 0] }}, {{ rotate_z = 33 }}]\n[solid.part]\nexpr = \"disc - hole\"\n\
             [[region]]\nsolid = \"part\""
        )
    };
    let report = compared(&plate(4.5), &plate(5.0), &quick());
    let thickness = report.pairs[0].spot.unwrap().thickness;
    assert!((thickness - 0.5).abs() < 1e-6, "{thickness}");
    let circle = "[solid.a]\ncylinder = { radius = 50, height = 12 }";
    let polygon = "[solid.a]\nprism = { sides = 64, radius = 50, height = 12 }";
    let sagitta = 50.0 * (1.0 - (PI / 64.0).cos());
    let within =
        |distance: f64| compared(circle, polygon, &DiffSettings { distance: Some(distance), ..quick() });
    let report = within(1.001 * sagitta);
    assert!(report.is_same(), "{report:?}");
    let report = within(0.97 * sagitta);
    let thickness = report.pairs[0].spot.unwrap().thickness;
    assert!(!report.is_same() && thickness <= sagitta * (1.0 + 1e-9), "{thickness} of {sagitta}");
}

/// Rays never decrease, pairs are finished in order, and each ends at the requested precision.
#[test]
fn progress_has_pairs_and_precision() {
    let other = TWO.replace("radius = 1", "radius = 1.1");
    let mut seen = Vec::new();
    let mut progress = |now: DiffProgress| seen.push(now);
    let (a, b) = (scene(TWO), scene(&other));
    let report = diff_with_progress(&a, &b, AnyEvaluator::maker(None), &quick(), &mut progress).unwrap();
    assert!(seen.windows(2).all(|pair| pair[0].rays <= pair[1].rays && pair[0].done <= pair[1].done));
    for done in 0..2 {
        let last = seen.iter().rfind(|now| now.done == done).unwrap();
        assert!(last.pairs == 2 && last.precision < 0.1, "{last:?}");
    }
    assert!(seen.last().unwrap().rays <= report.rays);
}
