//! Solids bounded by triangles: twisted extrusions, polyhedra, and imported mesh files.

use crate::folder::Folder;
use crate::measure::{check_volume, losses, read, volume};
use rayweave_formats::LossKind;

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
