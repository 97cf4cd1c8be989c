//! Extents and cylinders by closed forms.

use super::*;
use crate::counted::Counted;
use crate::section::SectionRun;
use rayweave_math::Vec3;
use rayweave_model::Evaluator;
use rayweave_scene::Compiled;
use rayweave_trace::AnyEvaluator;
use std::f64::consts::TAU;

fn evaluator(text: &str) -> AnyEvaluator {
    let (_, scene) = rayweave_scene::parse(&format!("rayweave = 1\n{text}")).unwrap();
    AnyEvaluator::new(None, Compiled::new(&scene).unwrap().program).unwrap()
}

/// Diameter, share, is_hole and depth of the faces.
fn found(text: &str) -> Vec<(f64, f64, bool, Option<f64>)> {
    let faces = cylindrical_faces(&evaluator(text)).faces;
    let rounded = |x: f64| (x * 1e6).round() / 1e6;
    faces
        .iter()
        .map(|f| (rounded(2.0 * f.radius), rounded(f.share), f.is_hole, f.depth.map(rounded)))
        .collect()
}

/// A flange with a hub, a bore through it, and eight holes on a circle, with a chamfer of the bore.
#[test]
fn a_flange_has_a_rim_a_hub_a_bore_and_holes() {
    let text = "[solid.disc]\ncylinder = { radius = 60, height = 12 }\n[solid.hub]\ncylinder = { radius = 25, height = 40 }\n\
        transform = { translate = [0, 0, 14] }\n[solid.bore]\ncylinder = { radius = 15 }\n[solid.hole]\ncylinder = { radius = 4.5 }\n\
        [solid.holes]\nplace = { solid = \"hole\", ring = 8, radius = 47.5 }\n\
        [solid.flange]\nexpr = \"(disc | hub) - bore - holes\"\n[[region]]\nsolid = \"flange\"";
    let all = found(text);
    assert_eq!(all[..3], [(120.0, 1.0, false, None), (50.0, 1.0, false, None), (30.0, 1.0, true, None)]);
    assert_eq!(all[3..], vec![(9.0, 1.0, true, None); 8]);
    let faces = cylindrical_faces(&evaluator(text)).faces;
    for (face, length) in faces.iter().zip([12.0, 28.0, 40.0, 12.0]) {
        assert!((face.length() - length).abs() < 1e-9 && face.axis().z.abs() > 0.999_999, "{face:?}");
    }
    for hole in &faces[3..] {
        assert!((libm::hypot(hole.ends[0].x, hole.ends[0].y) - 47.5).abs() < 1e-9);
    }
}

/// A blind hole with a cone at its end and a chamfer at its opening: its depth begins at the plane around the opening.
#[test]
fn depths_are_measured_from_the_plane_around_a_hole() {
    let blind = |chamfer: &str| {
        format!(
            "[solid.block]\nbox_from_corners = {{ lo = [0, 0, 0], hi = [30, 30, 20] }}\n\
             [solid.drill]\ncylinder = {{ radius = 2.5, height = 12 }}\ntransform = {{ translate = [12, 11, 14] }}\n\
             [solid.tip]\ncone = {{ radius1 = 0, radius2 = 2.5, height = 1.5 }}\ntransform = {{ translate = [12, 11, 7.25] }}\n\
             {chamfer}"
        )
    };
    let plain = blind("[solid.part]\nexpr = \"block - (drill | tip)\"\n[[region]]\nsolid = \"part\"");
    assert_eq!(found(&plain), [(5.0, 1.0, true, Some(12.0))]);
    let chamfered = blind(
        "[solid.sink]\ncone = { radius1 = 2.5, radius2 = 3.5, height = 1 }\ntransform = { translate = [12, 11, 19.5] }\n\
         [solid.part]\nexpr = \"block - (drill | tip | sink)\"\n[[region]]\nsolid = \"part\"",
    );
    assert_eq!(found(&chamfered), [(5.0, 1.0, true, Some(12.0))]);
}

/// Grooves and pockets with fillets or chamfers in their corners are as deep as their floors; ball ends, cones and smaller holes begin
/// where the full diameter ends.
#[test]
fn depths_end_at_the_floor() {
    let depth = |outline: &str| {
        let text = format!("[solid.a.revolve]\noutline = [{outline}]\n[[region]]\nsolid = \"a\"");
        cylindrical_faces(&evaluator(&text)).faces.iter().find_map(|face| face.depth).unwrap()
    };
    let groove = |corner: &str| {
        format!(
            "[0, 0], [26, 0], {{ at = [26, 2.8], {corner} }}, {{ at = [30.5, 2.8], {corner} }}, [30.5, 0], [60, 0], [60, 14], [0, 14]"
        )
    };
    for corner in ["fillet = 0.2", "fillet = 0.4", "fillet = 0.8", "chamfer = 0.4"] {
        let deep = depth(&groove(corner));
        assert!((deep - 2.8).abs() < 1e-7, "{corner}: {deep}");
    }
    let pocket = |bottom: &str| format!("{bottom}, [5, 20], [30, 20], [30, 0]");
    // a pocket 12 deep with a rounded corner, and with a cone of 118 degrees, plain and to a smaller hole
    let deep = depth(&pocket("[0, 0], [0, 8], { at = [5, 8], fillet = 3 }"));
    assert!((deep - 12.0).abs() < 1e-7, "{deep}");
    for bottom in ["[0, 0], [0, 5], [5, 8]", "[0, 0], [0, 5.4], [2.5, 5.4], [2.5, 6.5], [5, 8]"] {
        let deep = depth(&pocket(bottom));
        assert!((deep - 12.0).abs() < 1e-7, "{bottom}: {deep}");
    }
    let ball = "[solid.b]\nbox = { size = [40, 40, 20] }\n[solid.e]\ncylinder = { radius = 5, height = 14 }\n\
        transform = { translate = [0, 0, 3] }\n[solid.ball]\nsphere = { radius = 5 }\ntransform = { translate = [0, 0, -4] }\n\
        [solid.part]\nexpr = \"b - e - ball\"\n[[region]]\nsolid = \"part\"";
    assert_eq!(found(ball), [(10.0, 1.0, true, Some(14.0))]);
}

/// A counterbore ends at a shoulder: it is a hole with a bottom, and the hole in its bottom goes through.
#[test]
fn counterbores_have_a_depth() {
    let text = "[solid.block]\nbox_from_corners = { lo = [0, 0, 0], hi = [30, 30, 20] }\n\
        [solid.bolt]\ncylinder = { radius = 3.3 }\ntransform = { translate = [12, 11, 0] }\n\
        [solid.head]\ncylinder = { radius = 5.5, height = 12 }\ntransform = { translate = [12, 11, 20] }\n\
        [solid.part]\nexpr = \"block - bolt - head\"\ntransform = [{ rotate_x = 30 }, { rotate_y = 40 }, { rotate_z = 50 }]\n[[region]]\nsolid = \"part\"";
    assert_eq!(found(text), [(11.0, 1.0, true, Some(6.0)), (6.6, 1.0, true, None)]);
}

/// Only the part around a hole closes it: a bolt whose head covers the hole, and a washer around a blind hole, do not.
#[test]
fn other_parts_do_not_change_depths() {
    let parts = "[solid.block]\nbox_from_corners = { lo = [0, 0, 0], hi = [40, 30, 20] }\n\
        [solid.drill]\ncylinder = { radius = 3.3 }\ntransform = { translate = [12, 11, 0] }\n\
        [solid.blind]\ncylinder = { radius = 4, height = 24 }\ntransform = { translate = [30, 11, 20] }\n\
        [solid.part]\nexpr = \"block - drill - blind\"\n\
        [solid.shank]\ncylinder = { radius = 3, height = 30 }\ntransform = { translate = [12, 11, 5] }\n\
        [solid.head]\ncylinder = { radius = 5.5, height = 6 }\ntransform = { translate = [12, 11, 23] }\n\
        [solid.bolt]\nexpr = \"shank | head\"\n\
        [solid.washer]\ntube = { inner_radius = 5, outer_radius = 9, height = 2 }\ntransform = { translate = [30, 11, 21] }\n";
    let alone = format!("{parts}[[region]]\nsolid = \"part\"");
    let all = format!("{alone}\n[[region]]\nsolid = \"bolt\"\n[[region]]\nsolid = \"washer\"");
    for text in [alone, all] {
        let faces = cylindrical_faces(&evaluator(&text)).faces;
        let hole = |radius: f64| *faces.iter().find(|f| f.is_hole && f.radius == radius).unwrap();
        assert!(hole(3.3).is_through && hole(3.3).depth.is_none(), "{faces:?}");
        assert!(!hole(4.0).is_through && (hole(4.0).depth.unwrap() - 12.0).abs() < 1e-9, "{faces:?}");
    }
}

/// A groove in a bore is closed at both ends: it has no depth, and it is not through.
#[test]
fn grooves_are_not_through() {
    let text = "[solid.part.revolve]\n\
        outline = [[25, 0], [60, 0], [60, 42], [25, 42], [25, 30], [35, 30], [35, 12], [25, 12]]";
    let faces = cylindrical_faces(&evaluator(text)).faces;
    let of = |radius: f64| faces.iter().filter(move |face| face.radius == radius);
    assert!(of(35.0).all(|f| f.is_hole && f.depth.is_none() && !f.is_through), "{faces:?}");
    assert_eq!((of(35.0).count(), of(25.0).filter(|face| face.is_through).count()), (1, 2), "{faces:?}");
}

/// The corners of an extruded outline are quarters of cylinders, outside; the ends of a slot are half cylinders.
#[test]
fn fillets_are_parts_of_cylinders() {
    let text = "[solid.plate.extrude]\nheight = 5\noutline = [{ at = [0, 0], fillet = 4 }, { at = [30, 0], fillet = 4 }, \
                { at = [30, 20], fillet = 4 }, { at = [0, 20], fillet = 4 }]\n[[region]]\nsolid = \"plate\"";
    assert_eq!(found(text), vec![(8.0, 0.25, false, None); 4]);
}

#[test]
fn cylinders_that_are_no_faces_are_not_reported() {
    // inside another body, and beside it
    let text = "[solid.block]\nbox = { size = 20 }\n[solid.core]\ncylinder = { radius = 3, height = 10 }\n\
        [solid.far]\ncylinder = { radius = 2 }\ntransform = { translate = [40, 0, 0] }\n\
        [solid.part]\nexpr = \"(block | core) - far\"\n[[region]]\nsolid = \"part\"";
    assert_eq!(found(text), []);
    assert_eq!(found("[solid.rod]\ncylinder = { radius = 3 }"), []);
}

#[test]
fn extents_are_those_of_the_model_not_of_its_box() {
    let cut = "[solid.a]\nsphere = { radius = 5 }\n[solid.b]\nsphere = { radius = 5 }\ntransform = { translate = [8, 0, 0] }\n\
        [solid.lens]\nexpr = \"a & b\"\n[[region]]\nsolid = \"lens\"";
    let found = extent(&evaluator(cut)).unwrap();
    let half = Vec3::new(1.0, 3.0, 3.0);
    assert!((found.bounds.centre() - Vec3::new(4.0, 0.0, 0.0)).length() < 1e-9, "{found:?}");
    assert!((0.5 * found.bounds.size() - half).abs().max_element() < 1e-8, "{found:?}");
    let cube = extent(&evaluator("[solid.a]\nbox = { size = [2, 3, 4] }")).unwrap();
    assert!(cube.is_exact && cube.bounds.size() == Vec3::new(2.0, 3.0, 4.0), "{cube:?}");
    // the apex of a cone, and the turned corner of a box
    let cone = extent(&evaluator("[solid.a]\ncone = { radius1 = 3, radius2 = 0, height = 7 }")).unwrap();
    assert!((cone.bounds.hi.z - 3.5).abs() < 1e-9, "{cone:?}");
    let turned = "[solid.a]\nbox = { size = 2 }\ntransform = [{ rotate_z = 45 }]";
    assert!((extent(&evaluator(turned)).unwrap().bounds.hi.x - 2f64.sqrt()).abs() < 1e-9);
    assert_eq!(extent(&evaluator("[solid.rod]\ncylinder = { radius = 3 }")), None);
}

/// Rays along x and y through a star of 2,000 corners reach hundreds of edges each: there are fewer of them.
#[test]
fn extents_of_many_shapes_take_limited_work() {
    let corner = |k: u32| {
        let (sin, cos) = (TAU * f64::from(k) / 2000.0).sin_cos();
        let radius = if k.is_multiple_of(2) { 20.0 } else { 10.0 };
        format!("[{:.9}, {:.9}]", radius * cos, radius * sin)
    };
    let outline = (0..2000).map(corner).collect::<Vec<_>>().join(", ");
    let text = format!("rayweave = 1\n[solid.a]\nextrude = {{ outline = [{outline}], height = 1 }}");
    let (_, scene) = rayweave_scene::parse(&text).unwrap();
    let counted = Counted::new(Compiled::new(&scene).unwrap().program);
    let bounds = extent(&counted).unwrap().bounds;
    let far = (bounds.hi.max(-bounds.lo) - Vec3::new(20.0, 20.0, 0.0)).abs();
    assert!(far.x < 0.4 && far.y < 0.4 && bounds.lo.z == 0.0 && bounds.hi.z == 1.0, "{bounds:?}");
    let program = counted.program();
    let load = program.ray_load().along_axes(&program.bounds());
    let [rays, _] = counted.take();
    // 4096 are along z, and as many along x and y, with thousands beside the farthest ones, if there is no limit
    let across = (rays - 4096) as f64;
    assert!(load[0] > 300.0 && across * load[0] <= MOST_REACHED as f64, "{rays} rays, {load:?}");
}

/// A pocket with six sides around a hole, a rectangular hole at an angle, a hole with 30 sides, a boss with five sides, and a step.
#[test]
fn polygonal_holes_have_exact_corners() {
    let text = "[solid.plate]\nbox_from_corners = { lo = [0, 0, 0], hi = [60, 40, 10] }\n\
        [solid.nut]\nprism = { sides = 6, radius = 4, height = 8 }\ntransform = [{ rotate_z = 11 }, { translate = [10, 12, 0] }]\n\
        [solid.bolt]\ncylinder = { radius = 2 }\ntransform = { translate = [10, 12, 0] }\n\
        [solid.slot]\nbox = { size = [8, 3, 40] }\ntransform = [{ rotate_z = 30 }, { translate = [25, 30, 0] }]\n\
        [solid.drill]\nprism = { sides = 30, radius = 5, height = 40 }\ntransform = { translate = [40, 12, 0] }\n\
        [solid.boss]\nprism = { sides = 5, radius = 3, height = 30 }\ntransform = { translate = [50, 30, 0] }\n\
        [solid.part]\nexpr = \"(plate | boss) - nut - bolt - slot - drill\"\n[[region]]\nsolid = \"part\"";
    let evaluator = evaluator(text);
    let round = cylindrical_faces(&evaluator).faces;
    let found = axial_features(&evaluator, &round, &SectionRun::default()).unwrap();
    let of = |sides: usize, is_hole: bool| {
        let own = found.polygons.iter().filter(|face| face.corners.len() == sides && face.is_hole == is_hole);
        let own: Vec<&PolygonalFace> = own.collect();
        assert!(!own.is_empty(), "{sides} {found:?}");
        own
    };
    for (sides, is_hole, centre, radius, depth) in [
        (6, true, [10.0, 12.0], 4.0, Some(4.0)),
        (4, true, [25.0, 30.0], 0.5 * 73f64.sqrt(), None),
        (30, true, [40.0, 12.0], 5.0, None),
        (5, false, [50.0, 30.0], 3.0, None),
    ] {
        for face in of(sides, is_hole) {
            assert_eq!(face.depth.map(|depth| (depth * 1e9).round() / 1e9), depth, "{face:?}");
            for corner in &face.corners {
                let from = libm::hypot(corner.x - centre[0], corner.y - centre[1]);
                assert!((from - radius).abs() < 1e-9, "{sides}: {from} {radius}");
            }
        }
    }
    assert_eq!((of(6, true).len(), of(4, true).len(), of(30, true).len()), (1, 1, 1));
    // the boss ends below and above the plate; the floor of the pocket and the sides of holes are no steps
    let [x, y, z] = &found.steps;
    assert!(x.is_empty() && y.is_empty() && found.left_out.is_empty(), "{found:?}");
    assert!(z.len() == 2 && z[0].abs() < 1e-9 && (z[1] - 10.0).abs() < 1e-9, "{z:?}");
}

/// A pocket and a hole with round corners, a pocket with two different radii, and a slot, which is no rectangle.
#[test]
fn rounded_rectangles_have_their_sides_and_radius() {
    let outline = |[x, y]: [f64; 2], radii: [f64; 4]| {
        let corners = [[-x, -y], [x, -y], [x, y], [-x, y]];
        let corner = corners.iter().zip(radii).map(|(at, r)| format!("{{ at = {at:?}, fillet = {r:?} }}"));
        format!("outline = [{}]", corner.collect::<Vec<_>>().join(", "))
    };
    let text = format!(
        "[solid.plate]\nbox_from_corners = {{ lo = [0, 0, 0], hi = [100, 60, 10] }}\n\
         [solid.pocket]\ntransform = [{{ rotate_z = 25 }}, {{ translate = [20, 30, 6] }}]\n[solid.pocket.extrude]\nheight = 20\n{}\n\
         [solid.hole]\ntransform = [{{ translate = [50, 40, -10] }}]\n[solid.hole.extrude]\nheight = 40\n{}\n\
         [solid.uneven]\ntransform = [{{ translate = [50, 15, -10] }}]\n[solid.uneven.extrude]\nheight = 40\n{}\n\
         [solid.slot]\ntransform = [{{ translate = [80, 30, -10] }}]\n[solid.slot.extrude]\nheight = 40\n{}\n\
         [solid.part]\nexpr = \"plate - pocket - hole - uneven - slot\"\n[[region]]\nsolid = \"part\"",
        outline([10.0, 6.0], [3.0; 4]),
        outline([4.0, 7.0], [3.5; 4]),
        outline([9.0, 5.0], [1.0, 2.0, 1.0, 2.0]),
        outline([4.0, 8.0], [4.0, 4.0, 4.0, 4.0]),
    );
    let evaluator = evaluator(&text);
    let round = cylindrical_faces(&evaluator).faces;
    let found = axial_features(&evaluator, &round, &SectionRun::default()).unwrap();
    let size = |face: &PolygonalFace| {
        let corners: Vec<[f64; 2]> = face.corners.iter().map(|corner| [corner.x, corner.y]).collect();
        let sides = sides_of_rectangle(&corners, 1e-5).unwrap();
        [sides[0], sides[1], face.corner_radius, face.depth.unwrap_or(0.0)].map(|x| (x * 1e8).round() / 1e8)
    };
    let mut sizes: Vec<[f64; 4]> = found.polygons.iter().map(size).collect();
    sizes.sort_by(|a, b| b[0].total_cmp(&a[0]));
    assert_eq!(sizes, [[20.0, 12.0, 3.0, 4.0], [14.0, 8.0, 3.5, 0.0]], "{found:?}");
}
