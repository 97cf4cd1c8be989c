//! Meshes of solids that touch along faces: no face of contact stays inside, in any placement.

use crate::scene;
use rayweave_formats::{Format, Options, WriteOptions, parse, write};
use rayweave_math::{Affine, Vec3};
use rayweave_mesh::Mesh;
use rayweave_mesh_io::{MeshFormat, ReadOptions, read_bytes};
use rayweave_model::Solid;
use rayweave_scene::Scene;
use rayweave_shape::primitive::{BoxFromCorners, Convex, Cylinder, Primitive};
use std::f64::consts::PI;

/// A union or difference of touching solids with its volume and area by closed forms.
struct Case {
    name: &'static str,
    /// The operands in the order of the model; those after the first are united with or subtracted from the ones before.
    parts: Vec<(bool, Solid)>,
    volume: f64,
    area: f64,
    /// The sum of `2 pi (r + h)` over all cylinders. Chords within a tolerance reduce a disc by up to `4 / 3 tolerance / r` of its area,
    /// and a side by a quarter of that.
    rims: f64,
}

fn solid(shape: impl Into<Primitive>) -> Solid {
    Solid::from(shape.into())
}

fn cuboid(lo: [f64; 3], hi: [f64; 3]) -> Solid {
    solid(BoxFromCorners::new(Vec3::from_array(lo), Vec3::from_array(hi)).unwrap())
}

/// A cylinder on a disc around a point.
fn boss(radius: f64, height: f64, foot: [f64; 3]) -> Solid {
    let up = Affine::translate(Vec3::new(foot[0], foot[1], foot[2] + 0.5 * height));
    solid(Cylinder::new(radius, height).unwrap()).apply(up)
}

/// The Minkowski sum of a plate and a cylinder, as the reader of OpenSCAD makes it: a convex solid and cylinders that touch it.
fn rounded_plate(radius: f64) -> Vec<(bool, Solid)> {
    let diagonal = (0.5_f64.sqrt(), (35.0 + radius) * 0.5_f64.sqrt());
    let mut planes = vec![[0.0, 0.0, 1.0, 3.0], [0.0, 0.0, -1.0, 2.0]];
    for sign in [-1.0, 1.0] {
        planes.extend([[sign, 0.0, 0.0, 20.0 + radius], [0.0, sign, 0.0, 15.0 + radius]]);
        planes.extend([-1.0, 1.0].map(|other| [sign * diagonal.0, other * diagonal.0, 0.0, diagonal.1]));
    }
    let mut parts = vec![(true, solid(Convex::new(planes).unwrap()))];
    for x in [-20.0, 20.0] {
        parts.extend([-15.0, 15.0].map(|y| (true, boss(radius, 5.0, [x, y, -2.0]))));
    }
    parts
}

fn cases() -> Vec<Case> {
    let plate = || (true, cuboid([0.0; 3], [40.0, 30.0, 5.0]));
    let (plate_volume, plate_area) = (6000.0, 2.0 * (1200.0 + 200.0 + 150.0));
    let side = |radius: f64, height: f64| 2.0 * PI * radius * height;
    let disc = |radius: f64| PI * radius * radius;
    let rim = |radius: f64, height: f64| 2.0 * PI * (radius + height);
    let mut cases = vec![
        Case {
            name: "bosses on a plate",
            parts: vec![
                plate(),
                (true, boss(4.0, 10.0, [20.0, 15.0, 5.0])),
                (true, boss(3.0, 2.0, [8.0, 8.0, 5.0])),
            ],
            volume: plate_volume + disc(4.0) * 10.0 + disc(3.0) * 2.0,
            area: plate_area + side(4.0, 10.0) + side(3.0, 2.0),
            rims: rim(4.0, 10.0) + rim(3.0, 2.0),
        },
        Case {
            name: "angle of two boxes",
            parts: vec![plate(), (true, cuboid([0.0, 0.0, 5.0], [40.0, 3.0, 20.0]))],
            volume: plate_volume + 40.0 * 3.0 * 15.0,
            area: plate_area + 2.0 * (40.0 + 3.0) * 15.0,
            rims: 0.0,
        },
        Case {
            name: "bore through a boss",
            parts: vec![
                plate(),
                (true, boss(4.0, 10.0, [20.0, 15.0, 5.0])),
                (false, boss(2.0, 15.0, [20.0, 15.0, 0.0])),
            ],
            volume: plate_volume + disc(4.0) * 10.0 - disc(2.0) * 15.0,
            area: plate_area + side(4.0, 10.0) + side(2.0, 15.0) - 2.0 * disc(2.0),
            rims: rim(4.0, 10.0) + rim(2.0, 15.0),
        },
        Case {
            name: "coaxial cylinders of one radius",
            parts: vec![
                (true, boss(4.0, 3.0, [1.0, 2.0, 0.0])),
                (true, boss(4.0, 7.0, [1.0, 2.0, 3.0])),
                (true, boss(2.0, 5.0, [1.0, 2.0, 10.0])),
            ],
            volume: disc(4.0) * 10.0 + disc(2.0) * 5.0,
            area: side(4.0, 10.0) + side(2.0, 5.0) + 2.0 * disc(4.0),
            rims: rim(4.0, 10.0) + rim(2.0, 5.0),
        },
        // a roof over a floor with a wall on its slope; the slope descends by 3 for 4 along x, so that heights and lengths are rational
        Case {
            name: "block on a slope",
            parts: {
                let planes = vec![
                    [0.0, 0.0, -1.0, 0.0],
                    [-1.0, 0.0, 0.0, 0.0],
                    [0.0, -1.0, 0.0, 0.0],
                    [0.0, 1.0, 0.0, 30.0],
                    [0.6, 0.0, 0.8, 24.0],
                ];
                let tilt = Affine::rotation(Vec3::Y, libm::atan2(3.0, 4.0).to_degrees());
                let tilt = tilt.then(&Affine::translate(Vec3::new(0.0, 0.0, 30.0)));
                let block = cuboid([10.0, 5.0, 0.0], [20.0, 12.0, 6.0]).apply(tilt);
                let extension = cuboid([-8.0, 0.0, 0.0], [0.0, 30.0, 12.0]);
                vec![(true, solid(Convex::new(planes).unwrap())), (true, block), (true, extension)]
            },
            volume: 600.0 * 30.0 + 10.0 * 7.0 * 6.0 + 8.0 * 30.0 * 12.0,
            area: 2.0 * 600.0
                + 30.0 * (40.0 + 30.0 + 50.0)
                + 2.0 * (10.0 + 7.0) * 6.0
                + 2.0 * 8.0 * 12.0
                + 2.0 * 8.0 * 30.0,
            rims: 0.0,
        },
    ];
    for radius in [0.7, 1.0, 2.5, 3.0] {
        let flat = 40.0 * 30.0 + 140.0 * radius + disc(radius);
        let mut parts = rounded_plate(radius);
        parts.push((true, boss(4.0, 10.0, [0.0, 0.0, 3.0])));
        cases.push(Case {
            name: "boss on a rounded plate",
            parts,
            volume: flat * 5.0 + disc(4.0) * 10.0,
            area: 2.0 * flat + (140.0 + 2.0 * PI * radius) * 5.0 + side(4.0, 10.0),
            rims: 4.0 * rim(radius, 5.0) + rim(4.0, 10.0),
        });
    }
    cases
}

/// Identity, a rotation about z, rotations about any axis, a reflection and a change of scale.
fn placements() -> Vec<(Affine, f64)> {
    let turned = |axis: [f64; 3], angle: f64, to: [f64; 3]| {
        Affine::rotation(Vec3::from_array(axis), angle).then(&Affine::translate(Vec3::from_array(to)))
    };
    let tilted = turned([1.0, 2.0, -0.5], 40.0, [30.0, -20.0, 10.0]);
    vec![
        (Affine::IDENTITY, 1.0),
        (turned([0.0, 0.0, 1.0], 30.0, [0.1, 0.2, 0.3]), 1.0),
        (turned([1.0, 0.0, 0.0], -123.0, [50.0, 7.0, 1.0 / 3.0]), 1.0),
        (tilted, 1.0),
        (Affine::mirror(Vec3::new(1.0, 0.5, 0.2)).then(&tilted), 1.0),
        (turned([-3.0, 1.0, 1.0], 250.0, [-700.0, 300.0, 45.0]), 1.0),
        (Affine::scale(Vec3::splat(0.01)).then(&turned([1.0, 1.0, 1.0], 77.0, [0.5, 0.2, -0.7])), 0.01),
    ]
}

/// The ways to combine parts in their order: pairs, pairs each placed alone, all unions before all subtractions.
fn trees(parts: &[(bool, Solid)], place: &Affine) -> Vec<Solid> {
    let joined = |all: &[(bool, Solid)]| {
        let first = all[0].1.clone();
        all[1..]
            .iter()
            .fold(first, |rest, (is_added, part)| if *is_added { &rest | part } else { &rest - part })
    };
    let placed: Vec<(bool, Solid)> =
        parts.iter().map(|(is_added, part)| (*is_added, part.apply(*place))).collect();
    let of = |is_added: bool| {
        Solid::union(placed.iter().filter(|part| part.0 == is_added).map(|part| part.1.clone()))
    };
    vec![joined(parts).apply(*place), joined(&placed), &of(true) - &of(false)]
}

fn mesh(scene: &Scene, format: MeshFormat, tolerance: f64, what: &str) -> Mesh {
    let options = WriteOptions { tolerance: Some(tolerance), ..WriteOptions::default() };
    let file = write(scene, None, Format::Mesh(format), &options).unwrap_or_else(|e| panic!("{what}: {e}"));
    read_bytes(&file.bytes, format, &ReadOptions::default()).unwrap().mesh
}

/// A sound mesh of one shell with this volume and area, up to chords within a tolerance.
fn has(mesh: &Mesh, [volume, area, rims]: [f64; 3], tolerance: f64, what: &str) {
    let diagnosis = mesh.diagnose();
    assert!(diagnosis.is_sound(), "{what}: {diagnosis}");
    assert_eq!(diagnosis.components.len(), 1, "{what}");
    let (found, single) = ([mesh.volume(), mesh.area()], 1e-5);
    assert!(
        (found[0] - volume).abs() <= tolerance * area + single * volume,
        "{what}: volume {} {volume}",
        found[0]
    );
    assert!(
        (found[1] - area).abs() <= 4.0 / 3.0 * tolerance * rims + single * area,
        "{what}: area {} {area}",
        found[1]
    );
}

/// Checks every tree of every case in every placement.
fn check(tolerances: &[f64], formats: &[MeshFormat]) {
    for case in cases() {
        for (k, (place, scale)) in placements().iter().enumerate() {
            let expected =
                [case.volume * scale * scale * scale, case.area * scale * scale, case.rims * scale];
            for (tree, solid) in trees(&case.parts, place).into_iter().enumerate() {
                let scene = scene(&[("part", solid)]);
                for tolerance in tolerances {
                    for format in formats {
                        let what =
                            format!("{}, placement {k}, tree {tree}, {tolerance}, {format:?}", case.name);
                        let tolerance = tolerance * scale;
                        has(&mesh(&scene, *format, tolerance, &what), expected, tolerance, &what);
                    }
                }
            }
        }
    }
}

#[test]
fn faces_of_contact_leave_nothing_inside() {
    check(&[0.1], &[MeshFormat::Stl]);
}

#[test]
#[ignore = "long"]
fn long_faces_of_contact_leave_nothing_inside() {
    // slivers beside a line of contact may be narrower than single precision
    check(&[0.3, 0.1, 0.01, 0.002], &[MeshFormat::Ply]);
}

/// Copies of one solid in rows: those of a row touch along faces, the rows are 1 mm apart.
#[test]
fn copies_that_touch_become_one_shell_for_each_row() {
    let text = "rayweave = 1
[solid.tile]
box = { size = [10, 10, 2] }
transform = [{ translate = [0.1, 0.2, 0.3] }]
[solid.rows]
place = { solid = 'tile', grid = [6, 4, 1], step = [10, 11, 1] }
transform = [{ rotate_x = 33 }, { rotate_z = 21 }]
[[region]]
solid = 'rows'
";
    let scene = rayweave_scene::parse(text).unwrap_or_else(|e| panic!("{e}")).1;
    let mesh = mesh(&scene, MeshFormat::Stl, 0.01, "rows");
    let diagnosis = mesh.diagnose();
    assert!(diagnosis.is_sound() && diagnosis.components.len() == 4, "{diagnosis}");
    assert!((mesh.volume() - 4.0 * 60.0 * 10.0 * 2.0).abs() < 1e-2, "{}", mesh.volume());
    assert!((mesh.area() - 4.0 * 2.0 * (600.0 + 120.0 + 20.0)).abs() < 1e-2, "{}", mesh.area());
}

/// A dump of OpenSCAD in which a point of the inner union is off by a rounding error.
#[test]
fn a_boss_on_a_minkowski_sum_touches_it() {
    for radius in [0.5, 1.0, 2.0, 3.0] {
        let text = format!(
            "minkowski() {{ cube(size = [40, 30, 4], center = true); cylinder(h = 1, r1 = {radius}, r2 = {radius}); }}
            multmatrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 3], [0, 0, 0, 1]]) {{ cylinder(h = 10, r1 = 4, r2 = 4); }}"
        );
        let scene =
            parse(&text, Format::OpenScad, &[], &Options::default()).unwrap_or_else(|e| panic!("{e}")).scene;
        let flat = 40.0 * 30.0 + 140.0 * radius + PI * radius * radius;
        let volume = flat * 5.0 + PI * 160.0;
        let area = 2.0 * flat + (140.0 + 2.0 * PI * radius) * 5.0 + PI * 80.0;
        let rims = 2.0 * PI * (4.0 * (radius + 5.0) + 14.0);
        let what = format!("radius {radius}");
        has(&mesh(&scene, MeshFormat::Stl, 0.01, &what), [volume, area, rims], 0.01, &what);
    }
}
