//! Solids bounded by triangles: twisted extrusions, polyhedra, and imported mesh files.

use crate::folder::Folder;
use crate::measure::{check_volume, losses, read, volume, whole};
use rayweave_formats::{Format, LossKind, WriteOptions, write};
use rayweave_mesh::Diagnosis;
use rayweave_scene::Scene;
use rayweave_shape::primitive::Primitive;

const NEAR: f64 = 1e-3;

#[test]
fn polyhedra_that_are_not_convex_and_contours_that_cross_themselves() {
    // a box with a pyramid subtracted from its floor; the roof is one face
    let dented = "polyhedron(points = [[0, 0, 0], [4, 0, 0], [4, 4, 0], [0, 4, 0], [2, 2, 1], [0, 0, 4], [4, 0, 4], [4, 4, 4], [0, 4, 4]], \
                  faces = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4], [8, 7, 6, 5], [0, 5, 6, 1], [1, 6, 7, 2], [2, 7, 8, 3], [3, 8, 5, 0]]);";
    check_volume(dented, false, 64.0 - 16.0 / 3.0, NEAR);
    check_volume(
        "linear_extrude(height = 2) polygon(points = [[0, 0], [4, 4], [4, 0], [0, 4]]);",
        false,
        16.0,
        NEAR,
    );
    check_volume(
        "linear_extrude(height = 3, scale = 0) polygon(points = [[0, 0], [4, 4], [4, 0], [0, 4]]);",
        false,
        8.0,
        NEAR,
    );
    let (refused, messages) = losses(
        "polyhedron(points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces = [[0, 1, 2]]);",
        LossKind::Refused,
    );
    assert!(refused == 1 && messages.contains("polyhedron()"), "{messages}");
}

/// The diagnoses of all meshes of a scene.
fn diagnoses(scene: &Scene) -> Vec<Diagnosis> {
    let mut waiting: Vec<_> = scene.regions.iter().map(|region| region.solid.clone()).collect();
    let mut found = Vec::new();
    while let Some(solid) = waiting.pop() {
        if let rayweave_model::Node::Primitive(Primitive::Mesh(mesh)) = solid.node() {
            found.push(mesh.solid().to_mesh().diagnose());
        }
        waiting.extend(solid.node().operand_refs().cloned());
    }
    found
}

/// The prism over an L of area 12 from z = 0 to 3, with its faces clockwise seen from outside as OpenSCAD requires.
const ELL: &str = "polyhedron(points = [[0, 0, 0], [4, 0, 0], [4, 2, 0], [2, 2, 0], [2, 4, 0], [0, 4, 0], [0, 0, 3], [4, 0, 3], \
                   [4, 2, 3], [2, 2, 3], [2, 4, 3], [0, 4, 3]], faces = [[0, 1, 2, 3, 4, 5], [11, 10, 9, 8, 7, 6], [1, 0, 6, 7], \
                   [2, 1, 7, 8], [3, 2, 8, 9], [4, 3, 9, 10], [5, 4, 10, 11], [0, 5, 11, 6]]);";

#[test]
fn faces_are_clockwise_seen_from_outside() {
    let reversed = ELL
        .replace("[0, 1, 2, 3, 4, 5]", "[5, 4, 3, 2, 1, 0]")
        .replace("[11, 10, 9, 8, 7, 6]", "[6, 7, 8, 9, 10, 11]")
        .replace("[1, 0, 6, 7]", "[7, 6, 0, 1]")
        .replace("[2, 1, 7, 8]", "[8, 7, 1, 2]")
        .replace("[3, 2, 8, 9]", "[9, 8, 2, 3]")
        .replace("[4, 3, 9, 10]", "[10, 9, 3, 4]")
        .replace("[5, 4, 10, 11]", "[11, 10, 4, 5]")
        .replace("[0, 5, 11, 6]", "[6, 11, 5, 0]");
    for (text, is_right) in [(ELL, true), (reversed.as_str(), false)] {
        let scene = whole(text, false);
        let [diagnosis] = &diagnoses(&scene)[..] else { panic!("{text}") };
        assert_eq!(diagnosis.is_sound(), is_right, "{diagnosis}");
        assert_eq!(
            diagnosis.components.iter().filter(|shell| shell.is_inside_out()).count(),
            usize::from(!is_right)
        );
        // the solid does not depend on the order
        check_volume(text, false, 24.0 + 12.0, NEAR);
        assert_eq!(diagnosis.volume(), Some(36.0));
    }
    // the writer follows the same rule, also for a file that did not
    for text in [ELL, &reversed] {
        let written = write(&whole(text, false), None, Format::OpenScad, &WriteOptions::default()).unwrap();
        let again = diagnoses(&whole(&String::from_utf8(written.bytes).unwrap(), false));
        assert!(again.len() == 1 && again.iter().all(Diagnosis::is_sound) == (text == ELL), "{again:?}");
    }
}

/// All other items that become meshes.
#[test]
fn meshes_of_the_reader_are_the_right_way_out() {
    let folder = Folder::new("orientation");
    std::fs::write(folder.0.join("part.off"), TETRAHEDRON).expect("a file");
    std::fs::write(folder.0.join("map.dat"), "1 2 3 5\n2 2 4 1\n0 1 0 2\n").expect("a file");
    let cross = "polygon(points = [[0, 0], [4, 4], [4, 0], [0, 4]])";
    for text in [
        "linear_extrude(height = 20, twist = 90, $fn = 12) square(size = [20, 10], center = true);".to_owned(),
        "linear_extrude(height = 20, twist = -90, scale = 0.5, $fn = 12) difference() { circle(9); circle(4); }".to_owned(),
        format!("linear_extrude(height = 2) {cross};"),
        "linear_extrude(height = 2) circle(5, $fn = 99);".to_owned(),
        "sphere(5, $fn = 30);".to_owned(),
        "cylinder(h = 9, r1 = 5, r2 = 2, $fn = 99);".to_owned(),
        "cylinder(h = 9, r1 = 0, r2 = 2, $fn = 99);".to_owned(),
        "hull() { sphere(5, $fn = 30); cube(9); }".to_owned(),
        "minkowski() { sphere(2, $fn = 12); difference() { cube(9); cube(4); } }".to_owned(),
        "surface(file = \"map.dat\");".to_owned(),
        "import(file = \"part.off\");".to_owned(),
    ] {
        let options = rayweave_formats::Options { facets: true, ..Default::default() };
        let all = diagnoses(&folder.read_with(&text, &options).scene);
        assert!(!all.is_empty() && all.iter().all(Diagnosis::is_sound), "{text}: {all:?}");
    }
}

/// Volumes of the exports of OpenSCAD 2021.01.
#[test]
fn twisted_solids() {
    let cases = [
        (
            "linear_extrude(height = 20, twist = 90, $fn = 0, $fa = 12, $fs = 2) { square(size = [20, 10], center = true); }",
            4299.5242,
            1e-3,
        ),
        (
            "linear_extrude(height = 40, center = true, twist = -360, scale = 0, $fn = 0, $fa = 1, $fs = 1) { square(size = [20, 10], center = true); }",
            2785.4455,
            1e-3,
        ),
        (
            "linear_extrude(height = 10, twist = 200, slices = 7) multmatrix([[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) circle($fn = 20, r = 3);",
            269.6347,
            1e-3,
        ),
    ];
    for (text, expected, tolerance) in cases {
        check_volume(text, true, expected, tolerance);
        let (approximated, messages) = losses(text, LossKind::Approximated);
        assert!(approximated == 1 && messages.contains("twisted in slices"), "{messages}");
    }
    // clockwise twist: at the top the bar is on the negative y axis, and in between at x > 0, y < 0
    let bar = read(
        "linear_extrude(height = 2, twist = 90, $fn = 180) multmatrix([[1, 0, 0, 4], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) square(1, center = true);",
        true,
    );
    let middle = read(
        "intersection() { linear_extrude(height = 2, twist = 90, $fn = 180) multmatrix([[1, 0, 0, 4], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) square(1, center = true); multmatrix([[1, 0, 0, 0], [0, 1, 0, -9], [0, 0, 1, 0], [0, 0, 0, 1]]) cube([9, 9, 9]); }",
        true,
    );
    let (whole, part) = (volume(&bar.scene, 200), volume(&middle.scene, 200));
    assert!(part > 0.9 * whole, "{part} of {whole}");
}

#[test]
fn bent_faces_are_reported() {
    let cube = |last: &str| {
        format!(
            "polyhedron(points = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], {last}, [0, 1, 1]], faces = [[0, 1, 2, 3], \
             [4, 7, 6, 5], [0, 4, 5, 1], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 4, 0]]);"
        )
    };
    assert_eq!(losses(&cube("[1, 1, 1.00001]"), LossKind::Approximated).0, 0);
    let (approximated, messages) = losses(&cube("[1, 1, 1.3]"), LossKind::Approximated);
    assert!(approximated == 1 && messages.contains("faces that are not planar"), "{messages}");
}

const TETRAHEDRON: &str = "OFF\n4 4 0\n0 0 0\n3 0 0\n0 3 0\n0 0 4\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

#[test]
fn files_beside_the_dump() {
    let folder = Folder::new("files");
    std::fs::write(folder.0.join("part.off"), TETRAHEDRON).expect("a file");
    std::fs::write(folder.0.join("open.off"), TETRAHEDRON.replace("4 4 0", "4 3 0").replace("3 2 0 3\n", ""))
        .expect("a file");
    // two rows of three cells: the centre of a cell is the mean of its corners, the floor is 1 below the lowest point
    std::fs::write(folder.0.join("map.dat"), "# heights\n1 2 3 5\n2 2 4 1\n\n0 1 0 2\n").expect("a file");
    let measured = |text: &str| {
        let imported = folder.read(text);
        assert!(imported.report.is_empty(), "{}", imported.report.warnings());
        volume(&imported.scene, 300)
    };
    assert!((measured("import(file = \"part.off\", convexity = 1);") / 6.0 - 1.0).abs() < NEAR);
    // volume of the export of OpenSCAD 2021.01
    assert!(
        (measured("surface(file = \"map.dat\", center = false, invert = false);") / 18.5 - 1.0).abs() < NEAR
    );
    // the floor is at 0 for heights of 1 and more; short rows are padded with zeros
    for (map, expected, padded) in [
        ("5 5 5\n5 5 5\n5 5 5\n", 20.0, ""),
        ("9 6 7\n6 8 9\n5 3 2\n2\n", 29.5, "surface() pads 1 short row of its file with zeros"),
    ] {
        std::fs::write(folder.0.join("high.dat"), map).expect("a file");
        let imported = folder.read("surface(file = \"high.dat\");");
        assert!((volume(&imported.scene, 300) / expected - 1.0).abs() < 2.0 * NEAR, "{map}");
        let messages: Vec<_> = imported.report.warnings().iter().map(|w| w.message().to_owned()).collect();
        assert_eq!(messages.join("\n"), padded);
    }
    let corner = "intersection() { surface(file = \"map.dat\", center = true); multmatrix([[1, 0, 0, 0.3], [0, 1, 0, 0.2], [0, 0, 1, -1], [0, 0, 0, 1]]) cube(9); }";
    assert!((measured(corner) / 2.490002 - 1.0).abs() < 2.0 * NEAR);
    for (text, message) in [
        ("import(file = \"gone.stl\"); cube(1);", "there is no file `gone.stl` in the folder of the dump"),
        ("import(file = \"part.csg\"); cube(1);", "only meshes (STL, OFF, 3MF, OBJ, PLY) and drawings"),
        ("import(file = \"open.off\"); cube(1);", "import() is left out"),
        ("surface(file = \"part.off\"); cube(1);", "line 1 of its file has a value that is not a number"),
        ("import(layer = \"x\"); cube(1);", "it has no file name"),
    ] {
        let report = folder.read(text).report;
        assert_eq!(report.count(LossKind::Refused), 1, "{text}");
        assert!(report.warnings().to_string().contains(message), "{}", report.warnings());
    }
}

/// Images as height maps, with the volumes of the exports of OpenSCAD 2021.01: grey, colour, and grey with alpha, which is
/// ignored.
#[test]
fn pictures_of_heights() {
    let grey = [0u8, 100, 200, 50, 150, 255];
    let colours = [255u8, 0, 0, 0, 255, 0, 0, 0, 255, 10, 20, 30, 255, 255, 255, 0, 0, 0];
    let alpha = [100u8, 255, 100, 128, 100, 0, 50, 255, 150, 255, 255, 255];
    let cases: [(png::ColorType, &[u8], bool, f64); 4] = [
        (png::ColorType::Grayscale, &grey, false, 100.5294),
        (png::ColorType::Grayscale, &grey, true, 103.4709),
        (png::ColorType::Rgb, &colours, false, 96.7031),
        (png::ColorType::GrayscaleAlpha, &alpha, false, 98.5294),
    ];
    let folder = Folder::new("pictures");
    for (kind, bytes, invert, expected) in cases {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 3, 2);
        encoder.set_color(kind);
        encoder.write_header().and_then(|mut writer| writer.write_image_data(bytes)).expect("a picture");
        folder.write("map.png", &file);
        let text = format!("surface(file = \"map.png\", center = false, invert = {invert});");
        let found = volume(&folder.read(&text).scene, 300);
        assert!((found / expected - 1.0).abs() < 2e-3, "{kind:?} {invert}: {found} instead of {expected}");
    }
    folder.write("map.png", b"\x89PNG\r\n\x1a\n");
    let report = folder.read("surface(file = \"map.png\");").report;
    assert!(report.warnings().to_string().contains("its picture cannot be read"), "{}", report.warnings());
}
