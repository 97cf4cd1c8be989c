//! Meshes of solids of revolution whose parts touch along circles, from files of other programs and from trees of operators.

use crate::{difference, whole};
use rayweave_formats::{Format, Options, WriteOptions, parse, write};
use rayweave_mesh::{Mesh, Polyhedron};
use rayweave_mesh_io::{MeshFormat, ReadOptions, read_bytes};
use rayweave_model::Solid;
use rayweave_scene::{Document, Scene};
use rayweave_shape::primitive::{self, Primitive};
use std::f64::consts::PI;

/// A flange with a fillet at the foot of its rim, a square minus a quarter of a disc, and a bore beside the axis.
const FLANGE: &str = "difference() {
    rotate_extrude(angle = 360, $fn = 0, $fa = 12, $fs = 2) {
        polygon(points = [[12.5, 0], [50, 0], [50, 14], [42, 14], [42, 10], [12.5, 10]]);
        difference() {
            multmatrix([[1, 0, 0, 40], [0, 1, 0, 10], [0, 0, 1, 0], [0, 0, 0, 1]]) square(size = [2, 2], center = false);
            multmatrix([[1, 0, 0, 40], [0, 1, 0, 12], [0, 0, 1, 0], [0, 0, 0, 1]]) circle($fn = 0, $fa = 12, $fs = 2, r = 2);
        }
    }
    multmatrix([[1, 0, 0, 30], [0, 1, 0, 0], [0, 0, 1, -1], [0, 0, 0, 1]])
        cylinder($fn = 0, $fa = 12, $fs = 0.5, h = 20, r1 = 4.5, r2 = 4.5, center = false);
}";

/// The volume of the flange by Pappus's theorem. The fillet has the integral of r over its area `40 a + 2^3 / 6` with its area
/// `a = 4 - pi`: a square minus a quarter of a disc, both with the corner (40, 12).
fn volume() -> f64 {
    let moment = 0.5 * (2500.0 - 156.25) * 10.0 + 0.5 * (2500.0 - 42.0 * 42.0) * 4.0;
    let fillet = 40.0 * (4.0 - PI) + 8.0 / 6.0;
    2.0 * PI * (moment + fillet) - PI * 4.5 * 4.5 * 10.0
}

fn read(text: &str, format: Format, facets: bool) -> Scene {
    let options = Options { facets, ..Options::default() };
    parse(text, format, &[], &options).unwrap_or_else(|problems| panic!("{problems}")).scene
}

/// The sound mesh of a scene.
fn solid_mesh(scene: &Scene, tolerance: f64) -> Mesh {
    let options = WriteOptions { tolerance: Some(tolerance), text: true, ..WriteOptions::default() };
    let file = write(scene, None, Format::Mesh(MeshFormat::Ply), &options).unwrap_or_else(|e| panic!("{e}"));
    let mesh = read_bytes(&file.bytes, MeshFormat::Ply, &ReadOptions::default()).unwrap().mesh;
    let diagnosis = mesh.diagnose();
    assert!(diagnosis.is_sound(), "{diagnosis}");
    mesh
}

fn has_volume(scene: &Scene, expected: f64) {
    for tolerance in [0.2, 0.05, 0.01] {
        let mesh = solid_mesh(scene, tolerance);
        let error = (mesh.volume() - expected).abs();
        // vertices lie on the surface
        assert!(error <= tolerance * mesh.area(), "{tolerance}: {} {expected}", mesh.volume());
    }
}

#[test]
fn a_tangent_fillet_of_a_dump_becomes_a_sound_mesh() {
    let dump = read(FLANGE, Format::OpenScad, false);
    has_volume(&dump, volume());
    // the native format has no revolved regions, only their surfaces
    let native = read(&Document::from_scene(&dump).to_toml(), Format::Native, false);
    has_volume(&native, volume());
    // a tilted and scaled copy: sin 30 degrees = 0.5
    let tilted = format!(
        "multmatrix([[0, 0, 3, 1], [1.5, 2.598076211353316, 0, 2], [-2.598076211353316, 1.5, 0, 3], [0, 0, 0, 1]]) {FLANGE}"
    );
    has_volume(&read(&tilted, Format::OpenScad, false), 27.0 * volume());
}

#[test]
fn the_facets_of_a_tangent_fillet_become_a_sound_mesh() {
    let dump = read(FLANGE, Format::OpenScad, true);
    let mesh = solid_mesh(&dump, 0.1);
    let body = Solid::from(Primitive::from(primitive::Mesh::from(Polyhedron::new(&mesh).unwrap())));
    let (most, mean) = difference(&whole(&dump), &body, 400);
    assert!(most < 1e-6 && mean < 1e-9, "{most} {mean}");
    let part = "rotate_extrude(angle = 100, $fn = 24) multmatrix([[1, 0, 0, -9], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) circle(r = 2, $fn = 8);";
    let dump = read(part, Format::OpenScad, true);
    // an octagon with its centre 9 from the axis, in 6 straight sectors of 100 / 6 degrees, which start on the side of negative x
    let octagon = 8.0 * 0.5 * 4.0 * (0.25 * PI).sin();
    let expected = 6.0 * (100.0_f64 / 6.0).to_radians().sin() * 9.0 * octagon;
    let found = solid_mesh(&dump, 0.1).volume();
    assert!((found - expected).abs() < 1e-9 * expected, "{found} {expected}");
}

/// Solids of revolution of all kinds in one tree of operators, with a part that is not one.
#[test]
fn trees_of_coaxial_shapes_have_the_volumes_of_closed_forms() {
    let solid = |primitive: Primitive| Solid::from(primitive);
    let rod = |radius: f64| solid(primitive::Cylinder::new(radius, f64::INFINITY).unwrap().into());
    let below = |z: f64| solid(primitive::HalfSpace::new(rayweave_math::Vec3::Z, z).unwrap().into());
    let around = solid(primitive::Cylinder::new(30.0, 12.0).unwrap().into());
    let slab = |z: [f64; 2]| (below(z[1]) - below(z[0])) & &around;
    let ring = solid(primitive::Torus::new(12.0, 2.0).unwrap().into());
    // a cone of slope 1 with its apex at z = -10, and its mirror image above z = 10
    let cone = |up: f64| {
        let z = -10.0 * up;
        let (zz, linear, constant) = (-1.0, z, -z * z);
        let matrix = [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, zz, linear],
            [0.0, 0.0, linear, constant],
        ];
        solid(primitive::Quadric::new(matrix).unwrap().into())
    };
    let disc = slab([-2.0, 2.0]) & rod(12.0);
    // the bead of the torus touches both faces of the disc along circles, and half of it is outside
    let beaded = &disc | &ring;
    let bead = 2.0 * PI * (0.5 * PI * 4.0 * 12.0 + 2.0 / 3.0 * 8.0);
    let whole = PI * 144.0 * 4.0 + bead;
    let spindle = cone(-1.0) & slab([-2.0, 2.0]);
    // r = 10 + z between z = -2 and 2
    let frustum = PI / 3.0 * 4.0 * (64.0 + 96.0 + 144.0);
    let cube = solid(primitive::CentredBox::new(rayweave_math::Vec3::splat(2.0)).unwrap().into());
    for (name, solid, expected) in [
        ("bead", beaded.clone(), whole),
        ("bead with a bore", &beaded - &rod(3.0), whole - PI * 9.0 * 4.0),
        ("bead with a square hole", &beaded - &cube, whole - 8.0),
        ("bead around a cone", &beaded - &spindle, whole - frustum),
        ("the other cone", &beaded - &(cone(1.0) & slab([-2.0, 2.0])), whole - frustum),
        (
            "complement",
            &disc & !(!ring.clone() | !disc.clone()),
            PI * 4.0 * 12.0 * PI * 2.0 / 2.0 * 2.0 - bead,
        ),
    ] {
        let document = Document::from_solids([("part", &solid)]);
        let scene = rayweave_scene::parse(&(document.to_toml() + "[[region]]\nsolid = 'part'\n")).unwrap().1;
        for tolerance in [0.1, 0.02] {
            let mesh = solid_mesh(&scene, tolerance);
            let error = (mesh.volume() - expected).abs();
            assert!(error <= tolerance * mesh.area(), "{name} {tolerance}: {} {expected}", mesh.volume());
        }
    }
}

/// A flange by its outline, with a fillet at the foot of the rim, as in [`FLANGE`].
const OUTLINE: &str = "[[12.5, 0], [50, 0], [50, 14], [42, 14], FOOT, [12.5, 10]]";

fn native(text: &str) -> Scene {
    rayweave_scene::parse(&format!("rayweave = 1\nunit = 'mm'\n{text}"))
        .unwrap_or_else(|e| panic!("{text}: {e}"))
        .1
}

/// Outlines in files of other programs: straight ones come back exactly, all of them can become meshes.
#[test]
fn outlines_pass_through_files_of_other_programs() {
    let straight = OUTLINE.replace("FOOT", "[42, 10]");
    let hole = "{ circle = 1, at = [30, 5] }";
    let bored = |outline: &str, more: &str| {
        format!(
            "[solid.body.revolve]\noutline = {outline}\n{more}\n[solid.bore]\ncylinder = {{ radius = 4.5 }}\n\
                 transform = {{ translate = [30, 0, 0] }}\n[solid.part]\nexpr = 'body - bore'\n[[region]]\nsolid = 'part'\n"
        )
    };
    let moment = 0.5 * (2500.0 - 156.25) * 10.0 + 0.5 * (2500.0 - 42.0 * 42.0) * 4.0;
    let bore = PI * 4.5 * 4.5 * 10.0;
    let tilted = "transform = [{ scale = 2 }, { rotate = { axis = [1, 2, 3], degrees = 40 } }, { translate = [1, 2, 3] }]";
    for (text, is_exact, expected) in [
        (bored(&straight, ""), true, 2.0 * PI * moment - bore),
        (bored(&OUTLINE.replace("FOOT", "{ at = [42, 10], fillet = 2 }"), ""), false, volume()),
        (
            format!("[solid.a]\nrevolve = {{ outline = {straight}, start = 20, angle = 90 }}\n{tilted}\n"),
            true,
            8.0 * 0.5 * PI * moment,
        ),
        (
            format!("[solid.a.extrude]\noutline = {straight}\nheight = 3\n"),
            true,
            3.0 * (37.5 * 10.0 + 8.0 * 4.0),
        ),
        (
            format!("[solid.a.revolve]\noutline = [{straight}, {hole}]\n"),
            false,
            2.0 * PI * (moment - 30.0 * PI),
        ),
    ] {
        let scene = native(&text);
        for format in [Format::OpenScad, Format::Gdml] {
            let options = WriteOptions { tolerance: Some(0.01), ..WriteOptions::default() };
            let file = write(&scene, None, format, &options).unwrap();
            let approximated: Vec<String> = file
                .remarks
                .iter()
                .filter(|remark| remark.kind == rayweave_formats::RemarkKind::Approximated)
                .map(ToString::to_string)
                .collect();
            let back = read(std::str::from_utf8(&file.bytes).unwrap(), format, false);
            if is_exact && (format == Format::OpenScad || text.contains("revolve")) {
                assert!(approximated.is_empty(), "{format} {text} {approximated:?}");
                let (most, _) = difference(&whole(&scene), &whole(&back), 400);
                assert!(most < 1e-9, "{format} {text} {most}");
            }
            if format == Format::OpenScad || !text.contains("circle") {
                let mesh = solid_mesh(&back, 0.05);
                let error = (mesh.volume() - expected).abs();
                assert!(error <= 0.06 * mesh.area(), "{format} {text}: {} {expected}", mesh.volume());
            }
            let is_named =
                |remark: &String| remark.contains("in region `part`") || remark.contains("in region `a`");
            assert!(approximated.iter().all(is_named), "{approximated:?}");
        }
    }
}
