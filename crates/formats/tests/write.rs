//! Round trips: scenes written in every format and read back give the same solid, compared by rays and closed forms.

#[path = "write/assembly.rs"]
mod assembly;
#[path = "write/coaxial.rs"]
mod coaxial;
#[path = "write/outlines.rs"]
mod outlines;
#[path = "write/touching.rs"]
mod touching;

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_formats::{Format, Imported, Options, RemarkKind, WriteOptions, Written, parse, write};
use rayweave_math::{Affine, Bounds, Mat3, Vec3};
use rayweave_mesh::{Mesh, Polyhedron};
use rayweave_mesh_io::{MeshFormat, ReadOptions, read_bytes};
use rayweave_model::{Evaluator, Program, Query, RayBatch, RegionId, Solid};
use rayweave_scene::{Document, Scene, Unit};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{self, Primitive};
use rayweave_trace::Weave;
use std::sync::Arc;

/// A scene with one region per solid, each with its own medium.
fn scene(solids: &[(&str, Solid)]) -> Scene {
    let document = Document::from_solids(solids.iter().map(|(name, solid)| (*name, solid)));
    let regions = solids.iter().map(|(name, _)| format!("[[region]]\nsolid = '{name}'\n"));
    let text = document.to_toml() + &regions.collect::<String>();
    rayweave_scene::parse(&text).unwrap().1
}

fn written(scene: &Scene, format: Format, tolerance: Option<f64>) -> Written {
    write(scene, None, format, &WriteOptions { tolerance, text: true, ..WriteOptions::default() }).unwrap()
}

fn back(written: &Written, format: Format) -> Imported {
    let text = std::str::from_utf8(&written.bytes).unwrap();
    let imported = parse(text, format, &[], &Options::default()).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert!(imported.report.is_empty(), "{:?}", imported.report);
    imported
}

/// The union of all regions with a medium other than the world's.
fn whole(scene: &Scene) -> Solid {
    let solids = scene.regions.iter().filter(|region| region.colour.alpha > 0);
    Solid::union(solids.map(|region| region.solid.clone()))
}

/// Rays through a box from all sides.
fn rays(bounds: &Bounds, count: usize, seed: u64) -> RayBatch {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut point = || bounds.lo + bounds.size() * Vec3::new(rng.random(), rng.random(), rng.random());
    (0..count)
        .map(|_| {
            let (a, b) = (point(), point());
            Ray::new(a, b - a)
        })
        .collect()
}

/// Times at which each ray enters or leaves a solid.
fn times(solid: &Solid, batch: &RayBatch) -> Vec<Vec<f64>> {
    let weave = Weave::new(Arc::new(Program::compile(solid).unwrap()));
    let collected = weave.collect(batch.rays(), &Query::default()).unwrap();
    let of = |ray: usize| collected.of(ray).iter().map(|crossing| crossing.t).collect();
    (0..batch.len()).map(of).collect()
}

/// Largest and mean length, over all rays, on which exactly one of two solids is present.
fn difference(a: &Solid, b: &Solid, count: usize) -> (f64, f64) {
    // the solid that is read back may have an unbounded box, for example if it intersects a quadric with something else
    let bounds = Program::compile(a).unwrap().bounds();
    let batch = rays(&bounds.grown(0.05 * bounds.size().length()), count, 7);
    let lengths = times(a, &batch).into_iter().zip(times(b, &batch)).enumerate().map(|(ray, (a, b))| {
        // the solids differ after an odd number of changes of either
        let mut all = [a, b].concat();
        all.sort_by(f64::total_cmp);
        all.chunks(2).map(|pair| pair[1] - pair[0]).sum::<f64>() * batch.rays().get(ray).direction.length()
    });
    let lengths: Vec<f64> = lengths.collect();
    (lengths.iter().copied().fold(0.0, f64::max), lengths.iter().sum::<f64>() / count as f64)
}

/// Maps of all kinds: identity, rigid, reflection, non-uniform scale, shear.
fn maps() -> Vec<Affine> {
    let turn =
        Affine::rotation(Vec3::new(1.0, 2.0, -0.5), 40.0).then(&Affine::translate(Vec3::new(0.3, -0.2, 0.1)));
    let shear =
        Affine::from_linear(Mat3::from_cols(Vec3::X, Vec3::new(0.3, 1.0, 0.0), Vec3::new(0.0, 0.2, 1.0)));
    vec![
        Affine::IDENTITY,
        turn,
        Affine::mirror(Vec3::new(1.0, 0.5, 0.2)).then(&turn),
        Affine::scale(Vec3::new(1.0, 0.7, 1.3)).then(&turn),
        shear.then(&turn),
    ]
}

/// An example of every shape under a map, intersected with a ball if it is unbounded.
fn examples(map: &Affine) -> Vec<(&'static str, Solid)> {
    let ball = Solid::from(Primitive::from(primitive::Sphere::new(3.0).unwrap()));
    let finite = |primitive: Primitive| {
        let (name, bounds) = (primitive.name(), primitive.lower().bounds);
        let solid = Solid::from(primitive);
        let solid = if bounds.is_finite() { solid } else { &solid & &ball };
        (name, solid.apply(*map))
    };
    Primitive::examples().into_iter().map(finite).collect()
}

fn is_exact(written: &Written) -> bool {
    written.remarks.iter().all(|remark| remark.kind != RemarkKind::Approximated)
}

#[test]
fn every_shape_under_every_map_comes_back() {
    let mut exact = 0;
    for format in [Format::Native, Format::OpenScad, Format::Gdml] {
        for map in maps() {
            for (name, solid) in examples(&map) {
                let scene = scene(&[(name, solid.clone())]);
                let size = Program::compile(&solid).unwrap().bounds().size().length();
                let file = written(&scene, format, Some(1e-2 * size));
                let (most, mean) = difference(&solid, &whole(&back(&file, format).scene), 400);
                if is_exact(&file) {
                    exact += 1;
                    assert!(most < 1e-9 * size, "{format} {name} {map:?}: {most}");
                } else {
                    assert!(mean < 3e-2 * size, "{format} {name} {map:?}: {mean}");
                }
            }
        }
    }
    // of 19 shapes, 5 maps and 3 formats
    assert!(exact > 200, "{exact}");
}

/// A random tree of shapes within a ball.
fn random_solid(rng: &mut ChaCha8Rng, depth: u32) -> Solid {
    if depth == 0 {
        let exact = [
            "sphere",
            "ellipsoid",
            "box",
            "cylinder",
            "cone",
            "half_space",
            "slab",
            "torus",
            "tube",
            "wedge",
            "prism",
            "convex",
        ];
        let shape = loop {
            let shape = Primitive::random(|| rng.random());
            if exact.contains(&shape.name()) {
                break shape;
            }
        };
        let mut number = || rng.random_range(-1.0..1.0);
        let axis = Vec3::new(number(), number(), 1.1);
        let turn = Affine::rotation(axis, 180.0 * number());
        return Solid::from(shape).apply(turn.then(&Affine::translate(Vec3::new(
            number(),
            number(),
            number(),
        ))));
    }
    let (a, b) = (random_solid(rng, depth - 1), random_solid(rng, depth - 1));
    match rng.random_range(0..6) {
        0 | 1 => a | b,
        2 => a & b,
        3 => a - b,
        4 => a ^ b,
        _ => !a | b,
    }
}

#[test]
fn random_models_come_back() {
    let mut rng = ChaCha8Rng::seed_from_u64(61);
    let ball = Solid::from(Primitive::from(primitive::Sphere::new(2.5).unwrap()));
    for round in 0..30 {
        let solid = random_solid(&mut rng, 1 + round % 3) & ball.clone();
        if Program::compile(&solid).unwrap().bounds().is_empty() {
            continue;
        }
        let scene = scene(&[("part", solid.clone())]);
        for format in [Format::Native, Format::OpenScad, Format::Gdml] {
            let file = written(&scene, format, None);
            let approximated: Vec<_> =
                file.remarks.iter().filter(|remark| remark.kind == RemarkKind::Approximated).collect();
            let (most, _) = difference(&solid, &whole(&back(&file, format).scene), 300);
            assert!(most < 1e-8 || !approximated.is_empty(), "{format} {round}: {most} {solid}");
        }
    }
}

#[test]
fn later_regions_win_in_every_format() {
    let ball = |radius: f64, x: f64| {
        Solid::from(Primitive::from(primitive::Sphere::new(radius).unwrap())).translate([x, 0.0, 0.0])
    };
    let scene = scene(&[("one", ball(2.0, 0.0)), ("two", ball(1.5, 1.5)), ("three", ball(0.5, 1.0))]);
    let region = |scene: &Scene, x: f64, scale: f64| {
        let program = Arc::new(Program::compile_regions(&scene.model_regions()).unwrap());
        let weave = Weave::new(program);
        let mut found = [RegionId(0)];
        let [x, y, z] = [x, 0.01, 0.02].map(|number| scale * number);
        weave.regions_at([&[x], &[y], &[z]], &mut weave.scratch(), &mut found);
        let found = found[0].0 as usize;
        (found > 0 && scene.regions[found - 1].colour.alpha > 0).then(|| scene.regions[found - 1].colour)
    };
    for format in
        [Format::OpenScad, Format::Gdml, Format::Mesh(MeshFormat::Obj), Format::Mesh(MeshFormat::Gltf)]
    {
        let back = back(&written(&scene, format, Some(0.01)), format);
        if format == Format::Gdml {
            // without the world of the file, which the writer added
            let names: Vec<&str> = back.scene.regions.iter().map(|region| region.name.as_str()).collect();
            assert_eq!(names, ["one", "two", "three"]);
        }
        for x in [-2.5, -1.0, 0.2, 0.7, 1.3, 2.2, 2.9, 3.1] {
            let expected = region(&scene, x, 1.0);
            // glTF uses metres
            let scale = if format == Format::Mesh(MeshFormat::Gltf) { 1e-3 } else { 1.0 };
            assert_eq!(region(&back.scene, x, scale), expected, "{format} {x}");
        }
    }
}

/// The mesh of a solid, which must be sound.
fn mesh(solid: &Solid, tolerance: f64) -> Mesh {
    let scene = scene(&[("part", solid.clone())]);
    let file = written(&scene, Format::Mesh(MeshFormat::Ply), Some(tolerance));
    let mesh = read_bytes(&file.bytes, MeshFormat::Ply, &ReadOptions::default()).unwrap().mesh;
    let diagnosis = mesh.diagnose();
    assert!(diagnosis.is_sound(), "{solid}: {diagnosis}");
    mesh
}

#[test]
fn meshes_of_shapes_are_sound_and_within_the_tolerance() {
    for (primitive, tolerance) in
        Primitive::examples().into_iter().flat_map(|p| [(p.clone(), 0.02), (p, 0.002)])
    {
        let name = primitive.name();
        let Some(volume) = primitive.volume().filter(|volume| volume.is_finite()) else { continue };
        let solid = Solid::from(primitive);
        let mesh = mesh(&solid, tolerance);
        // vertices lie on the surface, so that the volume error is at most the tolerance times the area
        let error = (mesh.volume() - volume).abs();
        assert!(error <= tolerance * mesh.area(), "{name} {tolerance}: {} {volume}", mesh.volume());
        let body = Solid::from(Primitive::from(primitive::Mesh::from(Polyhedron::new(&mesh).unwrap())));
        let (_, mean) = difference(&solid, &body, 300);
        assert!(mean <= 4.0 * tolerance, "{name} {tolerance}: {mean}");
    }
}

#[test]
fn booleans_of_meshes_keep_edges_and_closed_forms() {
    let cylinder =
        |radius, height| Solid::from(Primitive::from(primitive::Cylinder::new(radius, height).unwrap()));
    let cuboid =
        |size: f64| Solid::from(Primitive::from(primitive::CentredBox::new(Vec3::splat(size)).unwrap()));
    let ball = |radius| Solid::from(Primitive::from(primitive::Sphere::new(radius).unwrap()));
    let pi = std::f64::consts::PI;
    let cases = [
        // coincident faces
        ("bored cube", cuboid(2.0) - cylinder(0.5, 2.0), 8.0 - 0.5 * pi),
        ("endless bore", cuboid(2.0) - cylinder(0.5, f64::INFINITY), 8.0 - 0.5 * pi),
        ("plug in its bore", (cuboid(2.0) - cylinder(0.5, 2.0)) | cylinder(0.5, 2.0), 8.0),
        ("two cubes side by side", cuboid(1.0) | cuboid(1.0).translate([1.0, 0.0, 0.0]), 2.0),
        ("cap of a ball", ball(1.0) & cuboid(2.0).translate([0.0, 0.0, 1.5]), 5.0 * pi / 24.0),
        ("hollow ball", ball(1.0) - ball(0.5), 4.0 / 3.0 * pi * 0.875),
        ("Steinmetz solid", cylinder(1.0, 4.0) & cylinder(1.0, 4.0).rotate_x(90.0), 16.0 / 3.0),
        ("complement", cuboid(2.0) & !ball(0.8), 8.0 - 4.0 / 3.0 * pi * 0.512),
        ("odd", cuboid(2.0) ^ cuboid(1.0), 7.0),
    ];
    for (name, solid, volume) in cases {
        for tolerance in [0.02, 0.001] {
            let mesh = mesh(&solid, tolerance);
            let error = (mesh.volume() - volume).abs();
            assert!(error <= tolerance * mesh.area(), "{name} {tolerance}: {} {volume}", mesh.volume());
        }
    }
}

/// A volume that its daughters fill up to 1e-8 mm is a film: it has no volume in glTF, in single precision, but has one in OBJ.
#[test]
fn regions_without_volume_are_left_out() {
    let corners = |hi: &str| format!("box_from_corners = {{ lo = [0, 0, 0], hi = [{hi}, 1, 1] }}\n");
    let text = format!(
        "rayweave = 1\nunit = 'mm'\n[solid.mother]\n{}[solid.daughter]\n{}[[region]]\nsolid = 'mother'\n[[region]]\nsolid = 'daughter'\n",
        corners("1.00000001"),
        corners("1")
    );
    let (_, scene) = rayweave_scene::parse(&text).unwrap();
    for (format, expected) in
        [(MeshFormat::Gltf, &["daughter"][..]), (MeshFormat::Obj, &["mother", "daughter"])]
    {
        let written = written(&scene, Format::Mesh(format), None);
        let left_out = "`mother` is left out: later regions cover all of its volume";
        let is_told = written.remarks.iter().any(|remark| remark.what == left_out);
        assert_eq!(is_told, expected.len() == 1, "{:?}", written.remarks);
        let found = back(&written, Format::Mesh(format)).scene;
        let names: Vec<&str> = found.regions.iter().map(|region| region.name.as_str()).collect();
        // a file with one object has the name of the file
        assert_eq!(names.len(), expected.len(), "{names:?}");
        assert!(expected.len() == 1 || names == expected, "{names:?}");
    }
}

#[test]
fn a_failed_write_has_a_reason() {
    let endless =
        scene(&[("rod", Primitive::from(primitive::Cylinder::new(1.0, f64::INFINITY).unwrap()).into())]);
    let refused = write(&endless, None, Format::OpenScad, &WriteOptions::default()).unwrap_err().to_string();
    assert_eq!(
        refused,
        "region `rod` is unbounded: the format openscad needs bounded solids. Intersect it with a box."
    );
    let ball = scene(&[("ball", Primitive::from(primitive::Sphere::new(1.0).unwrap()).into())]);
    for tolerance in [0.0, -1.0, f64::NAN] {
        let options = WriteOptions { tolerance: Some(tolerance), text: false, ..WriteOptions::default() };
        assert!(write(&ball, None, Format::Gdml, &options).is_err());
    }
    let fine = WriteOptions { tolerance: Some(1e-12), text: false, ..WriteOptions::default() };
    let refused = write(&ball, None, Format::Mesh(MeshFormat::Stl), &fine).unwrap_err().to_string();
    assert!(refused.contains("a circle of radius 1 needs more than 20000 vertices"), "{refused}");
    // 1 - cos(pi / 20000) = 1.23e-8, twice for a curve
    assert!(refused.contains("a tolerance of 2.6e-8 is large enough"), "{refused}");
    let fine = WriteOptions { tolerance: Some(1e-7), text: false, ..WriteOptions::default() };
    let refused = write(&ball, None, Format::Mesh(MeshFormat::Stl), &fine).unwrap_err().to_string();
    assert!(refused.contains("it needs more than 4194304 vertices"), "{refused}");
    // a mesh without triangles cannot be read back
    let empty = write(&scene(&[]), None, Format::Mesh(MeshFormat::Obj), &WriteOptions::default());
    assert!(empty.unwrap_err().to_string().starts_with("the model is empty: a file of the format obj needs"));
}

/// Volume by lines along z through the cells of a grid.
fn volume_by_rays(solid: &Solid, bounds: &Bounds) -> f64 {
    const CELLS: usize = 150;
    let size = bounds.size();
    let line = |k: usize| {
        let cell = Vec3::new((k % CELLS) as f64 + 0.5, (k / CELLS) as f64 + 0.5, -1.0) / CELLS as f64;
        Ray::new(bounds.lo + size * cell, Vec3::Z)
    };
    let batch: RayBatch = (0..CELLS * CELLS).map(line).collect();
    let length = |times: Vec<f64>| times.chunks(2).map(|pair| pair[1] - pair[0]).sum::<f64>();
    let sum: f64 = times(solid, &batch).into_iter().map(length).sum();
    sum / (CELLS * CELLS) as f64 * size.x * size.y
}

#[test]
fn booleans_of_twenty_pairs_of_meshes_agree_with_those_of_the_kernel() {
    let mut rng = ChaCha8Rng::seed_from_u64(20);
    let solid = |primitive: &Primitive, map: &Affine| {
        let mesh = mesh(&Solid::from(primitive.clone()), 0.05).mapped(|p| map.point(p)).unwrap();
        Solid::from(Primitive::from(primitive::Mesh::from(Polyhedron::new(&mesh).unwrap())))
    };
    let names = ["sphere", "torus", "cylinder", "cone", "mesh"];
    for round in 0..20 {
        let mut number = || rng.random_range(-0.6..0.6);
        let turn = Affine::rotation(Vec3::new(number(), number(), 1.0), 90.0 * number());
        let random = turn.then(&Affine::translate(Vec3::new(number(), number(), number())));
        // equal shapes translated along the axis or within their ends have coincident faces
        let shifts =
            [Vec3::new(0.5, 0.0, 0.0), Vec3::new(0.0, 0.25, 0.0), Vec3::new(0.0, 0.0, 0.5), Vec3::ZERO];
        let map = if round % 2 == 0 { random } else { Affine::translate(shifts[round / 2 % 4]) };
        let first = Primitive::example(names[round % names.len()]).unwrap();
        let second = if round % 2 == 0 {
            Primitive::example(names[(round / 2 + 1) % 5]).unwrap()
        } else {
            first.clone()
        };
        let (a, b) = (solid(&first, &Affine::IDENTITY), solid(&second, &map));
        let result = match round % 3 {
            0 => a | b,
            1 => a & b,
            _ => a - b,
        };
        let bounds = Program::compile(&result).unwrap().bounds();
        let expected = if bounds.is_empty() { 0.0 } else { volume_by_rays(&result, &bounds) };
        // a solid minus itself
        if expected < 1e-9 {
            continue;
        }
        let made = mesh(&result, 1.0);
        let size = bounds.size();
        let error = (made.volume() - expected).abs();
        assert!(error < 2e-3 * size.x * size.y * size.z, "{round}: {} {expected}", made.volume());
    }
}

/// Only curved faces are approximated: the triangles of a box, and of a mesh that was read, are exact.
#[test]
fn plane_faces_are_not_reported_as_approximated() {
    let cuboid = Solid::from(Primitive::from(primitive::CentredBox::new(Vec3::new(2.0, 3.0, 4.0)).unwrap()));
    let ball = Solid::from(Primitive::from(primitive::Sphere::new(1.0).unwrap()));
    let format = Format::Mesh(MeshFormat::Off);
    let reports_curves = |scene: &Scene| {
        let remarks = written(scene, format, None).remarks;
        remarks.iter().any(|remark| remark.to_string().contains("curved faces"))
    };
    let plain = scene(&[("cuboid", cuboid)]);
    assert!(!reports_curves(&plain));
    assert!(!reports_curves(&back(&written(&plain, format, None), format).scene));
    assert!(reports_curves(&scene(&[("ball", ball)])));
}

/// 3MF states the unit of the model where the format has it; glTF is always in metres. Other units are a remark.
#[test]
fn lengths_keep_their_unit_or_are_a_remark() {
    let cuboid = Solid::from(Primitive::from(primitive::CentredBox::new(Vec3::new(2.0, 3.0, 4.0)).unwrap()));
    let folder = std::env::temp_dir().join(format!("rayweave-units-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for (unit, symbol, metres) in Unit::ALL {
        let mut scene = scene(&[("cuboid", cuboid.clone())]);
        scene.unit = unit;
        for format in [MeshFormat::ThreeMf, MeshFormat::Glb] {
            let kept = match format {
                MeshFormat::ThreeMf if ["nm", "km"].contains(&symbol) => Unit::Millimetre,
                MeshFormat::ThreeMf => unit,
                _ => Unit::Metre,
            };
            let file = written(&scene, Format::Mesh(format), None);
            let remarks: Vec<String> = file.remarks.iter().map(ToString::to_string).collect();
            let remark = format!("changed: lengths, from {symbol} to {kept}");
            assert_eq!(remarks.contains(&remark), kept != unit, "{format:?} {symbol} {remarks:?}");
            let path = folder.join(format!("{symbol}.{}", Format::Mesh(format).extensions()[0]));
            std::fs::write(&path, &file.bytes).unwrap();
            let back = rayweave_formats::load(&path, None, &[], &Options::default()).unwrap().scene;
            assert_eq!(back.unit, kept, "{format:?} {symbol}");
            let size = Program::compile(&whole(&back)).unwrap().bounds().size() * (kept.metres() / metres);
            assert!(
                (size - Vec3::new(2.0, 3.0, 4.0)).abs().max_element() < 1e-6,
                "{format:?} {symbol} {size:?}"
            );
        }
    }
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Media of regions whose names differ from those of the media are lost, as are their numbers.
#[test]
fn lost_names_and_properties_of_media_are_remarks() {
    let ball = Solid::from(Primitive::from(primitive::Sphere::new(1.0).unwrap()));
    let format = Format::Mesh(MeshFormat::Obj);
    let of_media = |scene: &Scene| {
        let remarks = written(scene, format, None).remarks.into_iter().map(|remark| remark.to_string());
        remarks.filter(|text| text.contains("media")).collect::<Vec<_>>()
    };
    let mut scene = scene(&[("ball", ball)]);
    let medium = scene.regions[0].medium as usize;
    scene.media[medium].name = "ball".to_owned();
    assert_eq!(of_media(&scene), Vec::<String>::new());
    scene.media[medium].name = "steel".to_owned();
    assert_eq!(of_media(&scene), ["dropped: names of media"]);
    scene.media[medium].index = Some(1.5);
    assert_eq!(of_media(&scene), ["dropped: names and properties (index, density, attenuation) of media"]);
    scene.media[medium].name = "ball".to_owned();
    assert_eq!(of_media(&scene), ["dropped: properties (index, density, attenuation) of media"]);
}

/// A box without curved faces, and a ball, in centimetres.
#[test]
fn lengths_default_to_millimetres_in_formats_without_units() {
    let cuboid = Solid::from(Primitive::from(primitive::CentredBox::new(Vec3::new(2.0, 3.0, 4.0)).unwrap()));
    let ball = Solid::from(Primitive::from(primitive::Sphere::new(1.0).unwrap())).translate([5.0, 0.0, 0.0]);
    let mut scene = scene(&[("cuboid", cuboid), ("ball", ball)]);
    scene.unit = Unit::Centimetre;
    let size = Vec3::new(7.0, 3.0, 4.0);
    let meshes = [MeshFormat::Stl, MeshFormat::Obj, MeshFormat::Ply, MeshFormat::Off].map(Format::Mesh);
    for format in [Format::OpenScad, Format::Gdml].into_iter().chain(meshes) {
        // the tolerance is in the unit of the scene
        let file = written(&scene, format, Some(0.01));
        let remarks: Vec<String> = file.remarks.iter().map(ToString::to_string).collect();
        assert!(remarks.contains(&"changed: lengths, from cm to mm".to_owned()), "{format} {remarks:?}");
        assert!(!remarks.iter().any(|line| line.contains("unit")), "{format} {remarks:?}");
        let back = back(&file, format).scene;
        assert_eq!(back.unit, Unit::Millimetre);
        let bounds = Program::compile(&whole(&back)).unwrap().bounds();
        let off = (bounds.size() - 10.0 * size).abs().max_element();
        assert!(off <= 2.0 * 10.0 * 0.01, "{format} {bounds:?}");
        if format == Format::OpenScad {
            let colours =
                |scene: &Scene| -> Vec<_> { scene.regions.iter().map(|region| region.colour).collect() };
            assert_eq!(colours(&back), colours(&scene));
        }
    }
    scene.unit = Unit::Millimetre;
    let text = String::from_utf8(written(&scene, Format::OpenScad, None).bytes).unwrap();
    // one per shape, none for the unit
    assert_eq!(text.matches("multmatrix").count(), 2, "{text}");
}
