//! Thinnest walls of parts with several walls, by closed forms.

use super::tests::{checked, quick, scene};
use super::*;
use crate::survey::{Faces, Piece, Survey, survey};
use rayweave_model::RegionId;
use rayweave_trace::AnyEvaluator;

/// A flange: disc 120 x 12, hub 50 x 40, eight holes of 9 on a circle of 95, a groove 3 wide and 2 deep.
fn flange(groove: f64, bore: f64) -> String {
    let outer = groove + 3.0;
    format!(
        "[solid.disc.revolve]\noutline = [[0, 0], {{ at = [60, 0], chamfer = 2 }}, {{ at = [60, 12], chamfer = 2 }}, [0, 12]]\n\
         [solid.hub]\ncylinder = {{ radius = 25, height = 40 }}\ntransform = {{ translate = [0, 0, 20] }}\n\
         [solid.bore]\ncylinder = {{ radius = {bore} }}\n[solid.hole]\ncylinder = {{ radius = 4.5 }}\n\
         [solid.holes]\nplace = {{ solid = \"hole\", ring = 8, radius = 47.5 }}\n\
         [solid.groove]\ntube = {{ inner_radius = {groove}, outer_radius = {outer}, height = 4 }}\n\
         [solid.flange]\nexpr = \"(disc | hub) - bore - holes - groove\"\n[[region]]\nsolid = \"flange\""
    )
}

fn thinnest(text: &str, wall: f64, across: u32, seed: u64) -> Option<f64> {
    let settings = CheckSettings { wall: Some(wall), across, seed, ..CheckSettings::default() };
    checked(text, &settings).of(FindingKind::Thin).next().map(|finding| finding.size.unwrap())
}

fn is_near(found: Option<f64>, expected: f64) -> bool {
    found.is_some_and(|found| (found - expected).abs() < 1e-6 * expected)
}

/// The wall of 7 between the groove and a hole is only 2 deep; others are 8 (hole to rim), 10 (hub) and 12 (disc). Rays at a slant
/// across it have larger widths than rays across the disc.
fn find_the_thinnest(samples: &[(u32, u64, f64)]) {
    for &(across, seed, wall) in samples {
        let found = thinnest(&flange(33.0, 15.0), wall, across, seed);
        assert!(is_near(found, 7.0), "{across} {seed} {wall}: {found:?}");
    }
}

/// The wall between groove and hole becomes thinner as the groove becomes larger; that of the hub as the bore becomes larger.
fn find_each_wall(grooves: &[f64], bores: &[f64]) {
    for &groove in grooves {
        let (found, expected) = (thinnest(&flange(groove, 15.0), 100.0, 64, 0), (40.0 - groove).min(8.0));
        assert!(is_near(found, expected), "{groove}: {found:?}, not {expected}");
    }
    for &bore in bores {
        let (found, expected) = (thinnest(&flange(33.0, bore), 11.0, 64, 1), (25.0 - bore).min(7.0));
        assert!(is_near(found, expected), "{bore}: {found:?}, not {expected}");
    }
}

#[test]
fn the_thinnest_of_several_walls_is_found() {
    find_the_thinnest(&[(32, 0, 100.0), (64, 3, 7.5)]);
    assert_eq!(thinnest(&flange(33.0, 15.0), 6.9999, 64, 0), None);
}

#[test]
fn a_wall_does_not_hide_another() {
    find_each_wall(&[26.0, 33.5], &[18.5]);
}

#[test]
#[ignore = "long"]
fn long_walls_of_further_flanges() {
    find_the_thinnest(&[(64, 1, 100.0), (128, 2, 100.0), (64, 4, 8.5), (64, 0, 11.0)]);
    find_each_wall(&[30.0, 32.0, 32.5, 35.0], &[17.0, 19.0]);
}

/// A box with a pocket beside its middle has walls of 0.5, 0.8, 1.5 and 2 around it and a floor of 1; all join the same two shapes.
#[test]
fn all_walls_below_the_limit_are_reported() {
    let text = "[solid.block]\nbox_from_corners = { lo = [0, 0, 0], hi = [20, 30, 10] }\n\
        [solid.pocket]\nbox_from_corners = { lo = [0.5, 2, 1], hi = [19.2, 28.5, 11] }\n\
        [solid.tray]\nexpr = \"block - pocket\"\n[[region]]\nsolid = \"tray\"";
    for (wall, expected) in
        [(3.0, &[0.5, 0.8, 1.0, 1.5, 2.0][..]), (1.2, &[0.5, 0.8, 1.0]), (0.7, &[0.5]), (0.4, &[])]
    {
        let report = checked(text, &CheckSettings { wall: Some(wall), ..CheckSettings::default() });
        let sizes: Vec<f64> = report.of(FindingKind::Thin).map(|finding| finding.size.unwrap()).collect();
        let is_equal = sizes.iter().zip(expected).all(|(size, expected)| is_near(Some(*size), *expected));
        assert!(sizes.len() == expected.len() && is_equal, "{wall}: {sizes:?}");
    }
}

/// 25 slots at equal distances leave 24 walls between them, and one at each end.
#[test]
fn further_thin_walls_are_counted() {
    let slots: String = (0..25)
        .map(|k| {
            format!(
                "[solid.s{k}]\nbox = {{ size = [2, 8, 9] }}\ntransform = {{ translate = [{}, 0, 3] }}\n",
                3 * k
            )
        })
        .collect();
    let names: Vec<String> = (0..25).map(|k| format!("s{k}")).collect();
    let text = format!(
        "[solid.bar]\nbox_from_corners = {{ lo = [-2, -10, -5], hi = [74, 10, 5] }}\n{slots}[solid.comb]\nexpr = \"bar - ({})\"\n[[region]]\nsolid = \"comb\"",
        names.join(" | ")
    );
    let report = checked(&text, &CheckSettings { wall: Some(1.4), across: 128, ..CheckSettings::default() });
    let findings: Vec<&Finding> = report.of(FindingKind::Thin).collect();
    assert_eq!(findings.len(), 21, "{findings:?}");
    assert!(findings[..20].iter().all(|finding| is_near(finding.size, 1.0)), "{findings:?}");
    assert_eq!((findings[20].text.as_str(), findings[20].size), ("comb has 6 more thin walls", None));
}

/// A random number from 0 to 1 of a linear congruential generator (Knuth, MMIX).
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1u64 << 53) as f64
}

/// A plate 40 x 40 x 9 with holes at random places, turned by a random angle, and its thinnest wall.
fn plate(state: &mut u64) -> (String, f64) {
    let mut holes: Vec<[f64; 3]> = Vec::new();
    let mut thinnest = 9.0f64;
    while holes.len() < 4 {
        let [x, y, radius] = [0, 1, 2].map(|_| random(state));
        let hole = [30.0 * x - 15.0, 30.0 * y - 15.0, 1.0 + 7.0 * radius];
        let to_side = 20.0 - hole[0].abs().max(hole[1].abs()) - hole[2];
        let to_other =
            |other: &[f64; 3]| libm::hypot(hole[0] - other[0], hole[1] - other[1]) - hole[2] - other[2];
        let least = holes.iter().map(to_other).fold(to_side, f64::min);
        if least > 0.3 {
            holes.push(hole);
            thinnest = thinnest.min(least);
        }
    }
    let one = |(k, [x, y, radius]): (usize, &[f64; 3])| {
        format!(
            "[solid.h{k}]\ncylinder = {{ radius = {radius:?} }}\ntransform = {{ translate = [{x:?}, {y:?}, 0] }}\n"
        )
    };
    let solids: String = holes.iter().enumerate().map(one).collect();
    let text = format!(
        "[solid.plate]\nbox = {{ size = [40, 40, 9] }}\n{solids}[solid.part]\nexpr = \"plate - h0 - h1 - h2 - h3\"\n\
         transform = {{ rotate_z = {} }}\n[[region]]\nsolid = \"part\"",
        90.0 * random(state)
    );
    (text, thinnest)
}

/// The smallest width of a chord of the rays through the whole model.
fn least_of_chords(text: &str, settings: &CheckSettings) -> f64 {
    let model = Model::new(&scene(text), settings).unwrap();
    let evaluator = AnyEvaluator::maker(None)(model.program.clone()).unwrap();
    let rays = Survey {
        bounds: model.frame,
        across: settings.across,
        seed: settings.seed,
        stream: 1,
        threads: None,
        cancel: settings.cancel.clone(),
    };
    let visit = |found: &mut Vec<f64>, piece: &Piece<'_>| {
        if piece.region() != RegionId(0) && piece.wall().is_some() {
            found.push(piece.across().width(Faces::Wall));
        }
    };
    let mut least = f64::INFINITY;
    let merge = |some: Vec<f64>| least = some.into_iter().fold(least, f64::min);
    survey(&evaluator, &rays, visit, merge).unwrap();
    least
}

/// No thickness is below the closed form or above the width of a chord, and nearly all are the closed form.
#[test]
fn thinnest_walls_of_random_plates() {
    let (mut state, mut exact) = (1, 0);
    for seed in 0..12 {
        let (text, expected) = plate(&mut state);
        let settings = CheckSettings { wall: Some(100.0), seed, ..quick() };
        let found = thinnest(&text, 100.0, settings.across, seed).unwrap();
        let chords = least_of_chords(&text, &settings);
        assert!(found > expected * (1.0 - 1e-9), "{seed}: {found}, not {expected}\n{text}");
        assert!(found < chords * (1.0 + 1e-9), "{seed}: {found}, chord of {chords}\n{text}");
        exact += u32::from(is_near(Some(found), expected));
    }
    assert!(exact >= 11, "{exact}");
}

/// The plane of the picture of a wall contains the chord across it, so that the wall has its thickness there.
#[test]
fn pictures_of_slanted_walls_are_cut_along_the_chord() {
    for [x, y, z] in [[0, 0, 0], [0, 0, 90], [0, 30, 0], [35, 20, 10]] {
        let turn = format!("[{{ rotate_x = {x} }}, {{ rotate_y = {y} }}, {{ rotate_z = {z} }}]");
        let text = format!("[solid.wall]\nbox = {{ size = [0.5, 9, 9] }}\ntransform = {turn}");
        let settings = CheckSettings { wall: Some(1.0), across: 32, ..CheckSettings::default() };
        let (scene, report) = (scene(&text), checked(&text, &settings));
        let wall = report.of(FindingKind::Thin).next().unwrap();
        let section = finding_section(&scene, wall, AnyEvaluator::maker(None), &settings).unwrap().unwrap();
        let ray = wall.ray.unwrap();
        for end in [ray.from, ray.to] {
            assert!((end - section.plane.point()).dot(section.plane.normal()).abs() < 1e-6, "{turn}");
        }
        let cut = section.plane.cut().unwrap();
        let [a, b] = [ray.from, ray.to].map(|end| cut.place(end));
        assert!((libm::hypot(b[0] - a[0], b[1] - a[1]) - 0.5).abs() < 1e-6, "{turn}");
        let is_along_axes = section.plane.axis_names() != ["u", "v"];
        assert_eq!(is_along_axes, x == 0, "{turn}");
    }
}

/// Balls that intersect each other have edges, also between faces at a small angle, but no walls.
#[test]
fn edges_of_intersecting_balls_are_no_walls() {
    let mut state = 3u64;
    let mut random = || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (1e4 * ((state >> 33) as f64 / 2f64.powi(31) - 0.5)).round() / 1e3
    };
    let (mut solids, mut regions) = (String::new(), String::new());
    for k in 0..30 {
        let (radius, centre) = (10.0 + 1e-3 * f64::from(k), [random(), random(), random()]);
        solids += &format!(
            "[solid.s{k}]\nsphere = {{ radius = {radius} }}\ntransform = {{ translate = {centre:?} }}\n"
        );
        regions += &format!("[[region]]\nsolid = \"s{k}\"\n");
    }
    let report = checked(&(solids + &regions), &quick());
    let thin: Vec<_> = report.of(FindingKind::Thin).map(|finding| finding.size).collect();
    assert!(thin.is_empty(), "{thin:?}");
    assert!(report.of(FindingKind::Overlap).count() > 50);
}

/// A hole near the rim of a disc leaves a wall. One that breaks through the rim leaves edges, at any angle: they are not walls.
#[test]
fn a_hole_through_the_rim_leaves_no_wall() {
    let part = |at: f64| {
        format!(
            "[solid.disc]\ncylinder = {{ radius = 60, height = 14 }}\n[solid.hole]\ncylinder = {{ radius = 4.5 }}\n\
             transform = {{ translate = [{at}, 0, 0] }}\n[solid.part]\nexpr = \"disc - hole\"\n[[region]]\nsolid = \"part\""
        )
    };
    for at in [50.0, 54.0, 55.0, 55.4] {
        let found = thinnest(&part(at), 2.0, 64, 0);
        let expected = 60.0 - at - 4.5;
        assert!(expected > 2.0 || is_near(found, expected), "{at}: {found:?}, not {expected}");
    }
    for at in [55.501, 55.51, 55.55, 55.6, 55.7, 55.8, 56.0, 57.0, 58.5, 60.0, 63.0] {
        assert_eq!(thinnest(&part(at), 2.0, 64, 0), None, "{at}");
    }
}
