//! The contents of drawings.

use super::*;
use rayweave_scene::Compiled;
use rayweave_trace::AnyEvaluator;

const FLANGE: &str = "rayweave = 1\n[solid.disc]\ncylinder = { radius = 60, height = 12 }\n[solid.hub]\n\
    cylinder = { radius = 25, height = 40 }\ntransform = { translate = [0, 0, 14] }\n[solid.bore]\ncylinder = { radius = 15 }\n\
    [solid.hole]\ncylinder = { radius = 4.5 }\n[solid.holes]\nplace = { solid = \"hole\", ring = 8, radius = 47.5 }\n\
    [solid.flange]\nexpr = \"(disc | hub) - bore - holes\"\n[[region]]\nsolid = \"flange\"";

fn drawing(text: &str, options: &TechnicalOptions) -> Result<TechnicalDrawing, DrawError> {
    let (_, scene) = rayweave_scene::parse(text).unwrap();
    let evaluator = AnyEvaluator::new(None, Compiled::new(&scene).unwrap().program).unwrap();
    technical_drawing(&evaluator, "flange", scene.unit, options, &mut Run::default())
}

fn has(svg: &str, text: &str) -> bool {
    svg.contains(&format!(">{text}</text>"))
}

/// The values of an attribute of elements of a class.
fn numbers(svg: &str, class: &str, attribute: &str) -> Vec<f64> {
    let start = format!("class=\"{class}\"");
    let of = |line: &str| line.split_once(&format!(" {attribute}=\""))?.1.split('"').next()?.parse().ok();
    svg.lines().filter(|line| line.contains(&start)).filter_map(of).collect()
}

#[test]
fn diameters_hole_circles_and_overall_sizes() {
    let found = drawing(FLANGE, &TechnicalOptions::default()).unwrap();
    let svg = &found.svg;
    for text in ["\u{2300}120", "\u{2300}50", "\u{2300}30 through", "8\u{d7} \u{2300}9 through on \u{2300}95"]
    {
        assert!(has(svg, text), "{text}: {svg}");
    }
    // width and depth, and the height
    assert_eq!(svg.matches(">120</text>").count(), 2, "{svg}");
    assert!(has(svg, "40") && found.notes.is_empty(), "{:?}", found.notes);
    // the circle of the holes has its size at the scale of the drawing, 1:1 or smaller
    let scale =
        svg.split("scale 1:").nth(1).unwrap().split([' ', '.']).next().unwrap().parse::<f64>().unwrap();
    let radius = numbers(svg, "centre", "r")[0];
    assert!((radius - 47.5 * 96.0 / 25.4 / scale).abs() < 0.01, "{radius} at 1:{scale}");
    // every hole is visible from above, and none from the front, where the bore is hidden, too: two views with two lines for the bore
    // and for the holes at each of five places, some of which are one behind the other
    assert_eq!(svg.matches("class=\"hidden\"").count(), 24, "{svg}");
}

/// In first-angle projection the view from above is below that from the front, and the view from the left at its right.
#[test]
fn views_are_arranged_by_the_method_of_projection() {
    let places = |projection| {
        let svg = drawing(FLANGE, &TechnicalOptions { projection, size: None }).unwrap().svg;
        let place = |name: &str| {
            let line = svg.lines().find(|line| line.contains(&format!(">{name}</text>")))?;
            let of =
                |key: &str| line.split_once(&format!(" {key}=\""))?.1.split('"').next()?.parse::<f64>().ok();
            Some([of("x")?, of("y")?])
        };
        ["front", "top", "left", "right"].map(place)
    };
    let [front, top, left, right] = places(ProjectionMethod::ThirdAngle);
    let (front, top, right) = (front.unwrap(), top.unwrap(), right.unwrap());
    assert!(
        left.is_none()
            && top[1] < front[1]
            && top[0] == front[0]
            && right[0] > front[0]
            && right[1] == front[1]
    );
    let [front, top, left, right] = places(ProjectionMethod::FirstAngle);
    let (front, top, left) = (front.unwrap(), top.unwrap(), left.unwrap());
    assert!(
        right.is_none()
            && top[1] > front[1]
            && top[0] == front[0]
            && left[0] > front[0]
            && left[1] == front[1]
    );
}

/// A blind hole from below is hidden from above: its circle is dashed.
#[test]
fn hidden_holes_are_dashed() {
    let text = "rayweave = 1\n[solid.plate]\nbox = { size = [60, 40, 10] }\n[solid.hole]\ncylinder = { radius = 3, height = 8 }\n\
        transform = { translate = [10, 5, -5] }\n[solid.part]\nexpr = \"plate - hole\"\n[[region]]\nsolid = \"part\"";
    let svg = drawing(text, &TechnicalOptions::default()).unwrap().svg;
    assert!(has(&svg, "\u{2300}6 \u{d7} 4 deep"), "{svg}");
    // the circle, and both sides with the floor from the front and from the right
    assert_eq!(svg.matches("class=\"hidden\"").count(), 3, "{svg}");
}

const PLATE: &str = "rayweave = 1\n[solid.plate]\nbox_from_corners = { lo = [0, 0, 0], hi = [60, 40, 10] }\n\
    [solid.nut]\nprism = { sides = 6, radius = 6, height = 8 }\ntransform = { translate = [15, 20, Z] }\n\
    [solid.bolt]\ncylinder = { radius = 3 }\ntransform = { translate = [15, 20, 0] }\n\
    [solid.slot]\nbox_from_corners = { lo = [32, 15, -1], hi = [52, 23, 11] }\n\
    [solid.part]\nexpr = \"plate - nut - bolt - slot\"\n[[region]]\nsolid = \"part\"";

/// A pocket for a nut around a hole for a bolt: six sides, as deep as the nut; and a rectangular hole.
#[test]
fn polygonal_holes_have_sizes() {
    let flats = crate::axis::format_number(6.0 * 3f64.sqrt(), 1e-3);
    let [above, below] = ["10", "0"].map(|z| {
        let svg = drawing(&PLATE.replace('Z', z), &TechnicalOptions::default()).unwrap().svg;
        assert!(has(&svg, &format!("hexagon {flats} across flats \u{d7} 4 deep")), "{svg}");
        assert!(has(&svg, "20 \u{d7} 8 through") && has(&svg, "\u{2300}6 through"), "{svg}");
        svg.matches("class=\"hidden\"").count()
    });
    // the pocket from below is dashed in the view from above; from the front and the right every hole is
    assert_eq!(below, above + 1);
}

/// Cylinders read as prisms with 30 sides.
#[test]
fn holes_of_facets_have_diameters() {
    let text = PLATE.replace("sides = 6, radius = 6", "sides = 30, radius = 5").replace('Z', "10");
    let svg = drawing(&text, &TechnicalOptions::default()).unwrap().svg;
    assert!(has(&svg, "\u{2300}10 \u{d7} 4 deep"), "{svg}");
}

/// An angle with a foot 8 thick and a wall 5 thick: both thicknesses, the rest, and the overall sizes. The floor of a hole is no step.
#[test]
fn thicknesses_and_steps_have_dimensions() {
    let text = "rayweave = 1\n[solid.foot]\nbox_from_corners = { lo = [0, 0, 0], hi = [60, 30, 8] }\n\
        [solid.wall]\nbox_from_corners = { lo = [0, 0, 0], hi = [5, 30, 47] }\n\
        [solid.hole]\ncylinder = { radius = 4, height = 7 }\ntransform = { translate = [40, 15, 8] }\n\
        [solid.part]\nexpr = \"(foot | wall) - hole\"\n[[region]]\nsolid = \"part\"";
    let found = drawing(text, &TechnicalOptions::default()).unwrap();
    for value in ["8", "39", "5", "55", "60", "47", "30", "\u{2300}8 \u{d7} 3.5 deep"] {
        assert_eq!(found.svg.matches(&format!(">{value}</text>")).count(), 1, "{value}: {}", found.svg);
    }
    assert!(found.notes.is_empty(), "{:?}", found.notes);
}

/// The middle of a bore is at the height where a fillet in front of it ends.
#[test]
fn hidden_holes_behind_joints_of_faces_are_dashed() {
    for (bore, fillet) in [(20, 5), (25, 5), (28, 5), (25, 8)] {
        let text = format!(
            "rayweave = 1\n[solid.part.revolve]\noutline = [[{bore}, 0], [60, 0], [60, 16], \
             {{ at = [31, 16], fillet = {fillet} }}, [31, 42], [{bore}, 42]]"
        );
        let svg = drawing(&text, &TechnicalOptions::default()).unwrap().svg;
        // both sides, from the front and from the right
        assert_eq!(svg.matches("class=\"hidden\"").count(), 4, "bore {bore}, fillet {fillet}: {svg}");
    }
}

/// A groove in a bore is no hole, and the head of a bolt does not make a hole blind.
#[test]
fn labels_are_those_of_the_part_around_a_hole() {
    let groove = "rayweave = 1\n[solid.part.revolve]\n\
        outline = [[25, 0], [60, 0], [60, 42], [25, 42], [25, 30], [35, 30], [35, 12], [25, 12]]";
    let svg = drawing(groove, &TechnicalOptions::default()).unwrap().svg;
    assert!(has(&svg, "\u{2300}70 \u{d7} 18 wide") && has(&svg, "\u{2300}50 through"), "{svg}");
    let bolted = "rayweave = 1\n[solid.block]\nbox_from_corners = { lo = [-30, -30, 0], hi = [30, 30, 20] }\n\
        [solid.hole]\ncylinder = { radius = 6.75 }\n[solid.sink]\ncylinder = { radius = 12, height = 10 }\n\
        transform = { translate = [0, 0, 20] }\n[solid.plate]\nexpr = \"block - hole - sink\"\n\
        [solid.shank]\ncylinder = { radius = 6, height = 30 }\n[solid.head]\ncylinder = { radius = 10, height = 8 }\n\
        transform = { translate = [0, 0, 19] }\n[solid.bolt]\nexpr = \"shank | head\"\n\
        [[region]]\nsolid = \"plate\"\n[[region]]\nsolid = \"bolt\"";
    let svg = drawing(bolted, &TechnicalOptions::default()).unwrap().svg;
    assert!(has(&svg, "\u{2300}13.5 through") && has(&svg, "\u{2300}24 \u{d7} 5 deep"), "{svg}");
}

/// A foot with a wall whose corners have fillets: the centre of a fillet is outside of the part.
#[test]
fn arrows_end_on_edges() {
    let text = "rayweave = 1\n[solid.part.extrude]\noutline = [[-30, 0], [30, 0], [30, 8], { at = [15, 8], fillet = 3 }, [15, 30], \
        [-15, 30], { at = [-15, 8], fillet = 3 }, [-30, 8]]\nz = [-10, 10]\n\
        [solid.upright]\nexpr = \"part\"\ntransform = { rotate_x = 90 }\n[[region]]\nsolid = \"upright\"";
    let svg = drawing(text, &TechnicalOptions::default()).unwrap().svg;
    assert!(has(&svg, "2\u{d7} R3"), "{svg}");
    let paths = |class: &str| -> Vec<Vec<[f64; 2]>> {
        let start = format!("class=\"{class}\"");
        // not the symbol of the projection, which has circles and a closed path
        let paths = svg.lines().filter(|line| line.contains(&start)).filter_map(|line| {
            let (_, path) = line.split_once(" d=\"")?;
            path.split('"').next().filter(|path| !path.ends_with('Z'))
        });
        let point = |text: &str| {
            let mut numbers = text.split([' ', ',', 'H']).filter_map(|number| number.parse().ok());
            Some([numbers.next()?, numbers.next()?])
        };
        paths.map(|path| path.split(['M', 'L']).filter_map(point).collect()).collect()
    };
    let edges = paths("edge");
    for leader in paths("leader") {
        let tip = leader[0];
        let distance = |pair: &[[f64; 2]]| {
            let along = [0, 1].map(|k| pair[1][k] - pair[0][k]);
            let from = [0, 1].map(|k| tip[k] - pair[0][k]);
            let part =
                (from[0] * along[0] + from[1] * along[1]) / (along[0] * along[0] + along[1] * along[1]);
            let part = part.clamp(0.0, 1.0);
            libm::hypot(from[0] - part * along[0], from[1] - part * along[1])
        };
        let nearest =
            edges.iter().flat_map(|line| line.windows(2)).map(distance).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1.0, "{tip:?} is {nearest} from an edge: {svg}");
    }
}

/// A plate with two slots from its outline, and an oblique hole.
#[test]
fn slots_have_sizes_and_oblique_holes_a_note() {
    let text = "rayweave = 1\n[solid.plate.extrude]\noutline = [[[-30, -10], [30, -10], [30, 10], [-30, 10]], \
        [[19, -2.75], { at = [21, -2.75], bulge = 1 }, [21, 2.75], { at = [19, 2.75], bulge = 1 }], \
        [[-21, -2.75], { at = [-19, -2.75], bulge = 1 }, [-19, 2.75], { at = [-21, 2.75], bulge = 1 }]]\nheight = 8\n\
        [solid.hole]\ncylinder = { radius = 1.5, height = 40 }\ntransform = { rotate_y = 30 }\n\
        [solid.part]\nexpr = \"plate - hole\"\n[[region]]\nsolid = \"part\"";
    let found = drawing(text, &TechnicalOptions::default()).unwrap();
    assert!(has(&found.svg, "2\u{d7} slot 5.5 \u{d7} 7.5 through"), "{}", found.svg);
    let note = "not shown: the diameters of cylinders at an angle to the views, \u{2300}3 through at (";
    assert!(found.notes.iter().any(|own| own.starts_with(note)), "{:?}", found.notes);
}

const HUB: &str = "rayweave = 1\n[solid.body.revolve]\noutline = [[0, 0], { at = [40, 0], chamfer = 1.5 }, { at = [40, 10], chamfer = 1.5 }, \
    { at = [16, 10], fillet = 4 }, { at = [16, 32], chamfer = 1.5 }, [0, 32]]\n[solid.bore]\ncylinder = { radius = 10 }\n\
    [solid.pin]\ncylinder = { radius = 2, height = 40 }\ntransform = [{ rotate_y = 90 }, { translate = [20, 0, 22] }]\n\
    [solid.part]\nexpr = \"body - bore - pin\"\n[[region]]\nsolid = \"part\"";

/// A flange with a hub: three chamfers of one size, the fillet of the hub, and the height of a radial hole.
#[test]
fn fillets_chamfers_and_radial_holes_have_sizes() {
    let svg = drawing(HUB, &TechnicalOptions::default()).unwrap().svg;
    assert!(has(&svg, "3\u{d7} 1.5 \u{d7} 45\u{b0}") && has(&svg, "R4"), "{svg}");
    // the flange, from its face to the hole, and from there to the end of the hub
    for value in ["10", "12"] {
        assert!(has(&svg, value), "{value}: {svg}");
    }
    assert_eq!(svg.matches(">10</text>").count(), 2, "{svg}");
    let steep = HUB.replace("[16, 32], chamfer = 1.5 }", "[16, 30] }, [15, 32]");
    let svg = drawing(&steep, &TechnicalOptions::default()).unwrap().svg;
    let angle = crate::axis::format_number(0.5f64.atan().to_degrees(), 0.01);
    assert!(has(&svg, &format!("2 \u{d7} {angle}\u{b0}")), "{svg}");
    let block = "rayweave = 1\n[solid.block.extrude]\noutline = [{ at = [0, 0], chamfer = 2 }, [50, 0], { at = [50, 30], chamfer = 2 }, [0, 30]]\n\
        height = 12";
    let svg = drawing(block, &TechnicalOptions::default()).unwrap().svg;
    assert!(has(&svg, "2\u{d7} 2 \u{d7} 45\u{b0}"), "{svg}");
    // the sides of a hexagon are no chamfers
    let nut = "rayweave = 1\n[solid.plate]\nbox = { size = [80, 80, 6] }\n[solid.nut]\nprism = { sides = 6, radius = 5, height = 20 }\n\
        [solid.part]\nexpr = \"plate - nut\"\n[[region]]\nsolid = \"part\"";
    let svg = drawing(nut, &TechnicalOptions::default()).unwrap().svg;
    assert!(!svg.contains('\u{b0}'), "{svg}");
}

/// Slots and holes in a shaft are as deep as on their axes, in the middle of the shaft or beside it.
#[test]
fn depths_in_curved_faces_are_those_on_the_axis() {
    let slot = |y: f64| {
        format!(
            "rayweave = 1\n[solid.shaft]\ncylinder = {{ radius = 10, height = 60 }}\n[solid.slot.extrude]\noutline = [{{ at = [-9, -3] }}, \
             {{ at = [9, -3], through = [12, 0] }}, [9, 3], {{ at = [-9, 3], through = [-12, 0] }}]\nheight = 6\n[solid.key]\nexpr = \"slot\"\n\
             transform = [{{ rotate_y = 90 }}, {{ translate = [6.5, {y}, 2] }}]\n[solid.part]\nexpr = \"shaft - key\"\n[[region]]\nsolid = \"part\""
        )
    };
    let svg = drawing(&slot(0.0), &TechnicalOptions::default()).unwrap().svg;
    assert!(has(&svg, "slot 6 \u{d7} 24 \u{d7} 3.5 deep"), "{svg}");
    let svg = drawing(&slot(1.0), &TechnicalOptions::default()).unwrap().svg;
    let deep = crate::axis::format_number(99f64.sqrt() - 6.5, 1e-3);
    assert!(has(&svg, &format!("slot 6 \u{d7} 24 \u{d7} {deep} deep")), "{svg}");
    let hole = "rayweave = 1\n[solid.s]\ncylinder = { radius = 10, height = 60 }\n[solid.h]\ncylinder = { radius = 3, height = 20 }\n\
        transform = [{ rotate_y = 90 }, { translate = [15, 0, 7] }]\n[solid.part]\nexpr = \"s - h\"\n[[region]]\nsolid = \"part\"";
    let svg = drawing(hole, &TechnicalOptions::default()).unwrap().svg;
    assert!(has(&svg, "\u{2300}6 \u{d7} 5 deep"), "{svg}");
}

/// A cube as a mesh has the edges of a cube, which are seen at a slant, too, and a note.
#[test]
fn meshes_have_edges_and_a_note() {
    let cube = |shape: &str| {
        let text = format!("rayweave = 1\n[solid.cube]\n{shape}");
        drawing(&text, &TechnicalOptions::default()).unwrap()
    };
    let mesh = cube(
        "mesh = { vertices = [[0, 0, 0], [9, 0, 0], [0, 9, 0], [9, 9, 0], [0, 0, 9], [9, 0, 9], [0, 9, 9], [9, 9, 9]], \
         faces = [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]] }",
    );
    let exact = cube("box_from_corners = { lo = [0, 0, 0], hi = [9, 9, 9] }");
    let edges = |drawing: &TechnicalDrawing| drawing.svg.matches("class=\"edge\"").count();
    assert_eq!(edges(&mesh), edges(&exact), "{}", mesh.svg);
    assert!(
        mesh.notes.iter().any(|note| note.contains("no diameters")) && has(&mesh.svg, MESH_NOTE),
        "{:?}",
        mesh.notes
    );
    assert!(exact.notes.is_empty() && !has(&exact.svg, MESH_NOTE), "{:?}", exact.notes);
}

/// The view at a slant looks along the diagonal of a cube: along the axes x, y and z in equal parts.
#[test]
fn the_view_at_a_slant_is_isometric() {
    let normal = plane(View::Iso, Vec3::ZERO).normal();
    let expected = Vec3::new(1.0, -1.0, 1.0).normalize();
    assert!((normal - expected).length() < 1e-12, "{normal}");
}

#[test]
fn models_and_sheets_that_cannot_be_drawn_are_errors() {
    let endless =
        drawing("rayweave = 1\n[solid.rod]\ncylinder = { radius = 3 }", &TechnicalOptions::default());
    assert!(endless.unwrap_err().to_string().starts_with("the model is empty or unbounded"));
    let size = Size::new(120, 90).ok();
    let small = drawing(FLANGE, &TechnicalOptions { size, ..TechnicalOptions::default() }).unwrap_err();
    assert!(small.to_string().ends_with("Give a larger size."), "{small}");
}
