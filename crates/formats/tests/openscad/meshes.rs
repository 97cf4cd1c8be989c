//! Solids within triangles: twisted ones, those of points and faces, and those of files beside a dump.

use crate::measure::{check_volume, losses, read, volume};
use rayweave_formats::{Imported, LossKind, Options, load};
use std::path::PathBuf;

const NEAR: f64 = 1e-3;

#[test]
fn polyhedra_that_are_not_convex_and_contours_that_cross_themselves() {
    // a box with a pyramid cut out of its floor; the roof is one face
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

/// The volumes are those of what OpenSCAD 2021.01 exports.
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
    // it turns clockwise on its way up: at the top the bar lies along y, and passed x = y < 0 on the way
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

/// A folder of its own, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let folder = std::env::temp_dir().join(format!("rayweave-openscad-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        Folder(folder)
    }

    /// Reads a dump that stands in the folder.
    fn read(&self, text: &str) -> Imported {
        std::fs::write(self.0.join("part.csg"), text).expect("a file");
        load(self.0.join("part.csg"), None, &[], &Options::default()).expect("it is a dump")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

const TETRAHEDRON: &str = "OFF\n4 4 0\n0 0 0\n3 0 0\n0 3 0\n0 0 4\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n";

#[test]
fn files_beside_the_dump() {
    let folder = Folder::new("files");
    std::fs::write(folder.0.join("part.off"), TETRAHEDRON).expect("a file");
    std::fs::write(folder.0.join("open.off"), TETRAHEDRON.replace("4 4 0", "4 3 0").replace("3 2 0 3\n", ""))
        .expect("a file");
    // two rows of two squares: the middle of a square is the mean of its corners, the floor 1 below the lowest point
    std::fs::write(folder.0.join("map.dat"), "# heights\n1 2 3 5\n2 2 4 1\n\n0 1 0 2\n").expect("a file");
    let measured = |text: &str| {
        let imported = folder.read(text);
        assert!(imported.report.is_empty(), "{}", imported.report.warnings());
        volume(&imported.scene, 300)
    };
    assert!((measured("import(file = \"part.off\", convexity = 1);") / 6.0 - 1.0).abs() < NEAR);
    // the same as OpenSCAD 2021.01 exports
    assert!(
        (measured("surface(file = \"map.dat\", center = false, invert = false);") / 18.5 - 1.0).abs() < NEAR
    );
    let corner = "intersection() { surface(file = \"map.dat\", center = true); multmatrix([[1, 0, 0, 0.3], [0, 1, 0, 0.2], [0, 0, 1, -1], [0, 0, 0, 1]]) cube(9); }";
    assert!((measured(corner) / 2.490002 - 1.0).abs() < 2.0 * NEAR);
    for (text, message) in [
        ("import(file = \"gone.stl\"); cube(1);", "there is no file `gone.stl` beside the dump"),
        ("import(file = \"part.csg\"); cube(1);", "only files of meshes"),
        ("import(file = \"open.off\"); cube(1);", "import() is left out"),
        ("surface(file = \"part.off\"); cube(1);", "line 1 of its file holds something that is no number"),
        ("import(layer = \"x\"); cube(1);", "it names no file"),
    ] {
        let report = folder.read(text).report;
        assert_eq!(report.count(LossKind::Refused), 1, "{text}");
        assert!(report.warnings().to_string().contains(message), "{}", report.warnings());
    }
}
