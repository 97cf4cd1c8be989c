//! Cross-sections compared with closed forms.

use super::*;
use crate::counted::Counted;
use rayweave_error::{Classified, ErrorKind};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Program, RegionId};
use rayweave_scene::Scene;
use rayweave_trace::AnyEvaluator;
use std::f64::consts::PI;
use std::sync::Arc;

fn scene(text: &str) -> Scene {
    rayweave_scene::parse(&format!("rayweave = 1\n{text}")).unwrap().1
}

fn cut_by(scene: &Scene, plane: SectionPlane, settings: &SectionSettings) -> CrossSection {
    cross_sections(scene, None, AnyEvaluator::maker(None), &[plane], settings, &mut |_| ()).unwrap().remove(0)
}

fn cut(text: &str, plane: &str) -> CrossSection {
    cut_by(&scene(text), plane.parse().unwrap(), &SectionSettings::default())
}

/// The signed area of a contour, positive if it is counter-clockwise.
fn signed(contour: &[[f64; 2]]) -> f64 {
    let next = contour.iter().cycle().skip(1);
    0.5 * contour.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
}

/// Areas agree within tolerance times perimeter; contours add up to them, and holes are clockwise.
fn check(section: &CrossSection, name: &str, area: f64, perimeter: f64, holes: usize) {
    let part = section.part(name).unwrap();
    assert!((part.area - area).abs() <= section.tolerance * part.perimeter, "{} {area}", part.area);
    assert!((part.perimeter - perimeter).abs() < 2e-3 * perimeter, "{} {perimeter}", part.perimeter);
    let all: f64 = part.contours.iter().map(|contour| signed(contour)).sum();
    assert!((all - part.area).abs() < 1e-9 * area, "{all} {}", part.area);
    assert_eq!(part.contours.iter().filter(|contour| signed(contour) < 0.0).count(), holes);
}

/// A plane in a face shows the side into which the perturbation points, also at any angle, and is recognised.
#[test]
fn planes_in_faces_show_one_side() {
    let turned = "[solid.cube]\nbox = { size = 2 }\ntransform = [{ rotate_x = 31 }, { rotate_z = 40 }, { translate = [7, -3, 90] }]";
    let scene = scene(turned);
    let map = |p: Vec3| {
        let ((sx, cx), (sz, cz)) =
            (rayweave_math::sin_cos_degrees(31.0), rayweave_math::sin_cos_degrees(40.0));
        let p = Vec3::new(p.x, cx * p.y - sx * p.z, sx * p.y + cx * p.z);
        Vec3::new(cz * p.x - sz * p.y, sz * p.x + cz * p.y, p.z)
    };
    for axis in Vec3::AXES {
        let normal = map(axis);
        let mut areas = Vec::new();
        for sign in [1.0, -1.0] {
            let point = Vec3::new(7.0, -3.0, 90.0) + sign * normal;
            let plane = SectionPlane::new(point, normal).unwrap();
            let section = cut_by(&scene, plane, &SectionSettings::default());
            assert!(section.in_face, "{plane}");
            let is_inside = (sign < 0.0) == (plane.side_in_face() == "side of its normal");
            let area: f64 = section.parts.iter().map(|part| part.area).sum();
            assert!((area - if is_inside { 4.0 } else { 0.0 }).abs() < 1e-2, "{plane}: {area}");
            areas.push(area);
            let beside = SectionPlane::new(point + 1e-9 * normal, normal).unwrap();
            assert!(!cut_by(&scene, beside, &SectionSettings::default()).in_face);
        }
        assert!((areas[0] + areas[1] - 4.0).abs() < 1e-2, "{areas:?}");
    }
    let straight = "[solid.cube]\nbox = { size = 2 }";
    let (above, below) = (cut(straight, "z=1"), cut(straight, "z=-1"));
    assert!(above.in_face && above.parts.is_empty() && above.plane.side_in_face() == "+z side");
    assert!(below.in_face && (below.parts[0].area - 4.0).abs() < 1e-2);
    assert!(!cut(straight, "z=0.5").in_face);
}

#[test]
fn circle_and_annuli() {
    let ball = cut("[solid.ball]\nsphere = { radius = 5 }", "z=3");
    check(&ball, "ball", 16.0 * PI, 8.0 * PI, 0);
    let shell = "[solid.a]\nsphere = { radius = 5 }\n[solid.b]\nsphere = { radius = 4 }\n[solid.shell]\nexpr = \"a - b\"";
    let shell = format!("{shell}\n[[region]]\nsolid = \"shell\"");
    let found = cut(&shell, "x=3");
    check(&found, "shell", PI * (16.0 - 7.0), 2.0 * PI * (4.0 + 7f64.sqrt()), 1);
    // a torus cut through its axis, and in its plane
    let torus = "[solid.t]\ntorus = { major = 3, minor = 1 }";
    check(&cut(torus, "xz"), "t", 2.0 * PI, 4.0 * PI, 0);
    check(&cut(torus, "xy"), "t", 12.0 * PI, 12.0 * PI, 1);
    assert!(cut(torus, "z=1.5").parts.is_empty());
}

#[test]
fn an_oblique_cut_of_a_cylinder_is_an_ellipse() {
    let rod = scene("[solid.rod]\ncylinder = { radius = 2, height = 40 }");
    for degrees in [20.0, 45.0, 70.0] {
        let tilt = f64::to_radians(degrees);
        let normal = Vec3::new(tilt.sin(), 0.0, tilt.cos());
        let plane = SectionPlane::new(Vec3::new(0.1, 0.2, 0.3), normal).unwrap();
        let found = cut_by(&rod, plane, &SectionSettings::default());
        let part = found.part("rod").unwrap();
        let area = 4.0 * PI / tilt.cos();
        assert!(
            (part.area - area).abs() < found.tolerance * part.perimeter,
            "{degrees}: {} {area}",
            part.area
        );
        // every point lies on the cylinder
        let cut = plane.cut().unwrap();
        let off = part.contours[0].iter().map(|&point| cut.point(point));
        let off = off.map(|p| (p.x.hypot(p.y) - 2.0).abs()).fold(0.0, f64::max);
        assert!(off <= found.tolerance, "{off} {}", found.tolerance);
    }
}

/// No point of a contour, middles of edges included, is farther from the exact curve than the tolerance.
#[test]
fn tolerances_hold() {
    let ball = scene("[solid.ball]\nsphere = { radius = 1 }");
    for tolerance in [1e-2, 1e-3, 1e-5] {
        let settings = SectionSettings { tolerance: Some(tolerance), ..SectionSettings::default() };
        let found = cut_by(&ball, "xy".parse().unwrap(), &settings);
        let contour = &found.parts[0].contours[0];
        let next = contour.iter().cycle().skip(1);
        let middles = contour.iter().zip(next).map(|(a, b)| [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]);
        let points = contour.iter().copied().chain(middles);
        let off = points.map(|[x, y]| (x.hypot(y) - 1.0).abs()).fold(0.0, f64::max);
        assert!(off <= tolerance && off > 0.01 * tolerance, "{off} {tolerance}");
        // a chord of angle a stays within a^2 / 8 of the arc
        let least = PI / (2.0 * tolerance).sqrt();
        assert!((contour.len() as f64) < 6.0 * least + 24.0, "{} points for {tolerance}", contour.len());
    }
}

const TWO: &str = "[solid.a]\nbox_from_corners = { lo = [0, 0, 0], hi = [2, 1, 1] }\n\
    [solid.b]\nbox_from_corners = { lo = [2, 0, 0], hi = [3, 1, 1] }\n\
    [solid.c]\nsphere = { radius = 0.25 }\ntransform = [{ translate = [1, 0.5, 0.5] }]\n\
    [[region]]\nsolid = \"a\"\nmedium = \"steel\"\n[[region]]\nsolid = \"b\"\nmedium = \"steel\"\n\
    [[region]]\nsolid = \"c\"\nmedium = \"air\"\n[medium.steel]\n[medium.air]";

/// Two touching parts of steel have one outline by medium, and two by region.
#[test]
fn by_medium_or_by_region() {
    let scene = scene(TWO);
    let plane = "z=0.5".parse().unwrap();
    let hole = PI / 16.0;
    let by_medium = cut_by(&scene, plane, &SectionSettings::default());
    check(&by_medium, "steel", 3.0 - hole, 8.0 + 0.5 * PI, 1);
    check(&by_medium, "air", hole, 0.5 * PI, 0);
    assert_eq!(by_medium.part("steel").unwrap().contours.len(), 2);
    let by_region = cut_by(&scene, plane, &SectionSettings { by: By::Region, ..SectionSettings::default() });
    check(&by_region, "a", 2.0 - hole, 6.0 + 0.5 * PI, 1);
    check(&by_region, "b", 1.0, 4.0, 0);
    // straight lines have no points except their corners
    assert_eq!(by_region.part("b").unwrap().contours[0].len(), 4);
}

/// A single solid has the medium of its region; one that is no region has its own name.
#[test]
fn one_solid_has_its_own_medium() {
    let scene = scene(&TWO.replace(
        "[[region]]\nsolid = \"a\"",
        "[solid.d]\nsphere = { radius = 1 }\n[[region]]\nsolid = \"a\"",
    ));
    for (solid, name) in [("b", "steel"), ("c", "air"), ("d", "d")] {
        let (plane, settings) = ("z=0.5".parse().unwrap(), SectionSettings::default());
        let make = AnyEvaluator::maker(None);
        let found = cross_sections(&scene, Some(solid), make, &[plane], &settings, &mut |_| ()).unwrap();
        let names: Vec<&str> = found[0].parts.iter().map(|part| part.name.as_str()).collect();
        assert_eq!(names, [name], "{solid}");
    }
}

#[test]
fn a_box_bounds_unbounded_solids() {
    let rod = scene("[solid.rod]\ncylinder = { radius = 1, height = inf }");
    let settings = SectionSettings::default();
    let plane = || "xz".parse().unwrap();
    let refused = cross_sections(&rod, None, AnyEvaluator::maker(None), &[plane()], &settings, &mut |_| ())
        .unwrap_err();
    assert!(
        refused.kind() == ErrorKind::Solid
            && refused
                .to_string()
                .contains("Cut the part within a box: --within LO HI, in Python within=(lo, hi)."),
        "{refused}"
    );
    let within = Some(Bounds { lo: Vec3::new(0.0, -5.0, 0.0), hi: Vec3::new(5.0, 5.0, 3.0) });
    let found = cut_by(&rod, plane(), &SectionSettings { within, ..settings.clone() });
    check(&found, "rod", 3.0, 8.0, 0);
    // the plane across the unbounded rod needs no box
    check(&cut_by(&rod, "z=1e3".parse().unwrap(), &settings), "rod", PI, 2.0 * PI, 0);
}

#[test]
fn a_stack_of_a_cone() {
    let cone = scene("[solid.cone]\ncone = { radius1 = 2, radius2 = 0, height = 2 }");
    let plane: SectionPlane = "xy".parse().unwrap();
    let planes = plane.stack(-0.75, 0.75, 0.5).unwrap();
    let settings = SectionSettings::default();
    let mut reported = 0;
    let found = cross_sections(&cone, None, AnyEvaluator::maker(None), &planes, &settings, &mut |done| {
        reported = done
    })
    .unwrap();
    assert_eq!((found.len(), reported), (4, 4));
    for (section, z) in found.iter().zip([-0.75, -0.25, 0.25, 0.75]) {
        let r = 1.0 - z;
        check(section, "cone", PI * r * r, 2.0 * PI * r, 0);
    }
}

#[test]
fn labels_of_stacks_are_short() {
    let stack =
        "z=0".parse::<SectionPlane>().unwrap().stack(-6858.585858585859, 0.0, 6858.585858585858).unwrap();
    assert_eq!(stack[0].label(), "z = -6858.6");
}

#[test]
fn the_same_on_any_number_of_threads() {
    let scene = scene(TWO);
    let on = |threads: usize| {
        let run = SectionRun { threads: std::num::NonZeroUsize::new(threads), ..SectionRun::default() };
        let settings = SectionSettings { run, columns: 5000, ..SectionSettings::default() };
        cut_by(&scene, "z=0.5".parse().unwrap(), &settings)
    };
    assert_eq!(on(1), on(3));
    let settings = SectionSettings::default();
    settings.run.cancel.cancel();
    let stopped = cross_sections(
        &scene,
        None,
        AnyEvaluator::maker(None),
        &["xy".parse().unwrap()],
        &settings,
        &mut |_| (),
    );
    assert!(stopped.unwrap_err().kind() == ErrorKind::Cancelled);
}

#[test]
fn refusals() {
    let ball = scene("[solid.ball]\nsphere = { radius = 1 }");
    let fails = |settings: SectionSettings| {
        cross_sections(
            &ball,
            None,
            AnyEvaluator::maker(None),
            &["xy".parse().unwrap()],
            &settings,
            &mut |_| (),
        )
        .unwrap_err()
    };
    assert!(fails(SectionSettings { tolerance: Some(0.0), ..Default::default() }).kind() == ErrorKind::Value);
    assert!(
        fails(SectionSettings { tolerance: Some(f64::NAN), ..Default::default() }).kind() == ErrorKind::Value
    );
    let swapped = Some(Bounds { lo: Vec3::ONE, hi: Vec3::ZERO });
    assert!(fails(SectionSettings { within: swapped, ..Default::default() }).kind() == ErrorKind::Shape);
    let none = cross_sections(
        &ball,
        Some("bal"),
        AnyEvaluator::maker(None),
        &[],
        &SectionSettings::default(),
        &mut |_| (),
    );
    assert!(none.unwrap_err().to_string().contains("Did you mean `ball`?"));
}

/// The corners of a star at radius 10 and 20 in turn, around a point of the x axis.
fn corners_of_star(corners: usize, x: f64) -> String {
    let corner = |k: usize| {
        let angle = 2.0 * PI * (k as f64 + 0.3) / corners as f64;
        let radius = if k.is_multiple_of(2) { 10.0 } else { 20.0 };
        format!("[{:?}, {:?}]", x + radius * angle.cos(), radius * angle.sin())
    };
    let all: Vec<String> = (0..corners).map(corner).collect();
    all.join(", ")
}

/// A prism over a star, 1 high.
fn star(corners: usize) -> String {
    format!("[solid.star]\nextrude = {{ outline = [{}], height = 1 }}", corners_of_star(corners, 0.0))
}

/// The area of a star is a sum of triangles: 1/2 r R sin(2 pi / n) for each corner. Its corners are exact, and each takes a few scan
/// lines instead of some hundred.
#[test]
fn corners_of_a_star_take_few_scan_lines() {
    let n = 1000;
    let scene = scene(&star(n));
    let program = Arc::new(Program::compile_regions(&scene.model_regions()).unwrap());
    let evaluator = Counted::new(program);
    let plane = "z=0.25".parse::<SectionPlane>().unwrap().cut().unwrap();
    let found = section(&evaluator, &plane, &SectionWindow::new([-21.0; 2], [21.0; 2])).unwrap();
    let area = 0.5 * n as f64 * 200.0 * (2.0 * PI / n as f64).sin();
    let own = found.area(RegionId(1));
    assert!((own - area).abs() < 1e-9 * area, "{own} {area}");
    assert_eq!(found.contours(RegionId(1)).len(), 1);
    // a tolerance of the width of the spikes: their sides are not confused
    let coarse = SectionWindow { tolerance: 0.02, ..SectionWindow::new([-21.0; 2], [21.0; 2]) };
    let [rays, _] = evaluator.take();
    let own = section(&evaluator, &plane, &coarse).unwrap().area(RegionId(1));
    assert!((own - area).abs() < 1e-9 * area, "{own} {area}");
    assert!(rays < 15 * n as u64, "{rays}");
}

/// The crossings of all rays grow in proportion to the number of corners, not to its square: only short parts of scan lines are traced
/// at corners.
#[test]
fn corners_of_a_large_star_take_few_crossings() {
    for n in [1000, 4000] {
        let scene = scene(&star(n));
        let evaluator = Counted::new(Arc::new(Program::compile_regions(&scene.model_regions()).unwrap()));
        let plane = "z=0.25".parse::<SectionPlane>().unwrap().cut().unwrap();
        let found = section(&evaluator, &plane, &SectionWindow::new([-21.0; 2], [21.0; 2])).unwrap();
        let turn = 2.0 * PI / n as f64;
        let (area, side) = (0.5 * n as f64 * 200.0 * turn.sin(), (500.0 - 400.0 * turn.cos()).sqrt());
        assert!((found.area(RegionId(1)) - area).abs() < 1e-8 * area, "{n}: {}", found.area(RegionId(1)));
        let perimeter = found.perimeter(RegionId(1));
        assert!((perimeter - n as f64 * side).abs() < 1e-6 * perimeter, "{n}: {perimeter}");
        assert_eq!(found.contours(RegionId(1)).len(), 1);
        let crossings = evaluator.take_crossings();
        assert!(crossings < 400 * n as u64, "{n}: {crossings}");
    }
}

/// The cones of a revolved star meet a plane through the axis in lines; their corners are exact, too.
#[test]
fn corners_of_a_revolved_star_take_few_scan_lines() {
    let n = 400;
    let text = format!("[solid.star]\nrevolve = {{ outline = [{}] }}", corners_of_star(n, 30.0));
    let scene = scene(&text);
    let evaluator = Counted::new(Arc::new(Program::compile_regions(&scene.model_regions()).unwrap()));
    let plane = "y=0".parse::<SectionPlane>().unwrap().cut().unwrap();
    let window = SectionWindow::new([-51.0; 2], [51.0; 2]);
    let found = section(&evaluator, &plane, &window).unwrap();
    // one star on each side of the axis
    let area = 2.0 * 0.5 * n as f64 * 200.0 * (2.0 * PI / n as f64).sin();
    let own = found.area(RegionId(1));
    assert!((own - area).abs() < 1e-9 * area, "{own} {area}");
    assert_eq!(found.contours(RegionId(1)).len(), 2);
    let [rays, _] = evaluator.take();
    assert!(rays < 30 * n as u64, "{rays}");
}

/// A solid of revolution with a chamfer at both ends, fillets, a groove and a step.
const TURNED: &str = "[solid.a.revolve]\noutline = [[0, 0], [9, 0], [10, 1], [10, 3], [9, 4], [10, 5], [10, 7], [8, 7.5], [8, 9], [7, 10], [0, 10]]";

/// The number of rays of a section, its area and the number of its contours.
fn counted(text: &str, plane: SectionPlane) -> (u64, f64, usize) {
    let scene = scene(text);
    let evaluator = Counted::new(Arc::new(Program::compile_regions(&scene.model_regions()).unwrap()));
    let window = SectionWindow::new([-40.0; 2], [40.0; 2]);
    let found = section(&evaluator, &plane.cut().unwrap(), &window).unwrap();
    (evaluator.take()[0], found.area(RegionId(1)), found.contours(RegionId(1)).len())
}

/// The most scan lines of a circle or annulus: 512, and some dozens at each end of a circle.
const MOST: u64 = 1500;

fn is_disc(text: &str, plane: SectionPlane, radii: [f64; 2]) {
    let (rays, area, contours) = counted(text, plane);
    assert!(rays < MOST, "{plane}: {rays} rays of {text}");
    let exact = PI * (radii[1] * radii[1] - radii[0] * radii[0]);
    let off = 4e-3 * 2.0 * PI * (radii[0] + radii[1]);
    assert!((area - exact).abs() < off, "{plane}: {area} {exact} of {text}");
    assert_eq!(contours, if radii[0] > 0.0 { 2 } else { 1 }, "{plane} of {text}");
}

/// Both faces at a round edge in the plane are cut in the same circle: rounding decides which is crossed, scan line by scan line.
#[test]
fn planes_through_round_edges_take_few_scan_lines() {
    let radii = [(1.0, 10.0), (3.0, 10.0), (4.0, 9.0), (5.0, 10.0), (7.0, 10.0), (7.5, 8.0), (9.0, 8.0)];
    for (z, radius) in radii {
        let plane = SectionPlane::across(2, z).unwrap();
        is_disc(TURNED, plane, [0.0, radius]);
        for (degrees, x) in [(37.0, 3.0), (90.0, 0.1), (123.4, -1.7)] {
            let turn = format!(
                "\n[[region]]\nsolid = \"b\"\n[solid.b]\nexpr = \"a\"\ntransform = [{{ rotate_y = {degrees} }}, {{ translate = [{x}, 1, 2] }}]"
            );
            let angle = f64::to_radians(degrees);
            let axis = Vec3::new(angle.sin(), 0.0, angle.cos());
            let plane = SectionPlane::new(Vec3::new(x, 1.0, 2.0) + z * axis, axis).unwrap();
            is_disc(&format!("{TURNED}{turn}"), plane, [0.0, radius]);
        }
    }
    // a cone and a cylinder, written by hand, and a bore with a chamfer
    let by_hand = "[solid.c]\ncylinder = { radius = 10, height = 4 }\ntransform = { translate = [0, 0, 3] }\n\
        [solid.k]\ncone = { radius1 = 9, radius2 = 10, height = 1 }\ntransform = { translate = [0, 0, 0.5] }\n\
        [solid.p]\nexpr = \"c | k\"\n[[region]]\nsolid = \"p\"";
    is_disc(by_hand, "z=1".parse().unwrap(), [0.0, 10.0]);
    let bore = "[solid.a.revolve]\noutline = [[4, 0], [12, 0], [12, 5], [3, 5], [3, 1]]";
    is_disc(bore, "z=1".parse().unwrap(), [3.0, 12.0]);
    // a torus between two cylinders of its own, and its halves
    let torus = "[solid.t]\ntorus = { major = 8, minor = 2 }\n[solid.c]\ncylinder = { radius = 10, height = 4 }\n\
        [solid.i]\ncylinder = { radius = 6, height = 4 }\n[solid.h]\nhalf_space = { normal = [0, 0, 1], offset = 0 }\n\
        [solid.p]\nexpr = \"(t & h) | (c - h - i)\"\n[[region]]\nsolid = \"p\"";
    is_disc(torus, "z=0".parse().unwrap(), [6.0, 10.0]);
    for (end, z) in [("bottom", 1.0), ("top", 4.0)] {
        for edge in ["chamfer = 1", "fillet = 1"] {
            let part = format!(
                "[solid.a]\nextrude = {{ outline = {{ circle = 10 }}, height = 5, {end} = {{ {edge} }} }}"
            );
            is_disc(&part, SectionPlane::across(2, z).unwrap(), [0.0, 10.0]);
        }
    }
}

/// Planes at, and next to, every corner of random outlines of revolution.
#[test]
fn planes_through_corners_of_random_outlines() {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut random = |lo: f64, hi: f64| {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        lo + (hi - lo) * ((state >> 11) as f64 / (1u64 << 53) as f64)
    };
    for _ in 0..12 {
        let mut z = random(-3.0, 3.0);
        let corners: Vec<[f64; 2]> = (0..6)
            .map(|_| {
                z += random(0.2, 3.0);
                [random(2.0, 20.0), z]
            })
            .collect();
        let all: Vec<String> = corners.iter().map(|[r, z]| format!("[{r:?}, {z:?}]")).collect();
        let [lo, hi] = [corners[0][1], corners[5][1]];
        let text = format!("[solid.a.revolve]\noutline = [[0, {lo:?}], {}, [0, {hi:?}]]", all.join(", "));
        for [radius, z] in &corners[1..5] {
            for step in [0.0, 1e-15, -1e-15, 1e-13, 1e-9] {
                is_disc(&text, SectionPlane::across(2, z + step).unwrap(), [0.0, *radius]);
            }
        }
    }
}

#[test]
fn the_limit_of_scan_lines_comes_with_a_suggestion() {
    let refused = SectionError::TooManyScanLines { limit: 1 << 20 }.to_string();
    assert!(refused.contains("Use a larger tolerance, or cut a smaller box"), "{refused}");
}
