//! Conversions: models written in every format are read back without losses, and have the same volume.
//!
//! By default, small models are converted to a few formats, within seconds; the ignored test converts all models of the
//! repository and of the shared folder to all formats.

use rayweave_conformance::skipped;
use rayweave_formats::{Format, LossKind, Options, WriteOptions, load, parse, write};
use rayweave_math::Vec3;
use rayweave_mesh_io::MeshFormat;
use rayweave_model::{Evaluator, Program, Query, RayBatch};
use rayweave_scene::{Scene, Unit};
use rayweave_shape::Ray;
use rayweave_trace::Packets;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Largest model file of the default run, in bytes.
const SMALL: u64 = 1500;

/// Relative tolerance of volumes, for the tessellation of curved faces and for sampling with rays.
const NEAR: f64 = 0.02;

/// Formats of the default run: the three with operators, and one of triangles.
const FEW: [Format; 4] = [Format::Native, Format::OpenScad, Format::Gdml, Format::Mesh(MeshFormat::Ply)];

const ALL: [Format; 10] = [
    Format::Native,
    Format::OpenScad,
    Format::Gdml,
    Format::Mesh(MeshFormat::Stl),
    Format::Mesh(MeshFormat::Obj),
    Format::Mesh(MeshFormat::Ply),
    Format::Mesh(MeshFormat::Off),
    Format::Mesh(MeshFormat::ThreeMf),
    Format::Mesh(MeshFormat::Gltf),
    Format::Mesh(MeshFormat::Glb),
];

/// Volume of everything but the world in cubic millimetres, from rays along a skew axis; `None` for an empty scene.
fn volume(scene: &Scene) -> Result<Option<f64>, String> {
    const SIDE: usize = 120;
    let program = Program::compile_regions(&scene.model_regions()).map_err(|error| error.to_string())?;
    let bounds = program.bounds();
    if bounds.is_empty() {
        return Ok(None);
    }
    let (centre, reach) = (0.5 * (bounds.lo + bounds.hi), 0.5 * bounds.size().length());
    let w = Vec3::new(0.131, 0.277, 1.0).normalize();
    let u = w.cross(Vec3::X).normalize();
    let v = w.cross(u);
    let at = |k: usize| reach * ((2 * k + 1) as f64 / SIDE as f64 - 1.0);
    let rays: RayBatch =
        (0..SIDE * SIDE).map(|k| Ray::new(centre + at(k / SIDE) * u + at(k % SIDE) * v, w)).collect();
    let regions = scene.model_regions();
    let is_solid = |region: usize| region > 0 && regions[region - 1].medium != 0;
    let answers = Packets::new(Arc::new(program))
        .collect(rays.rays(), &Query::default())
        .map_err(|error| error.to_string())?;
    let mut length = 0.0;
    for ray in 0..SIDE * SIDE {
        for crossing in answers.of(ray) {
            length -= if is_solid(crossing.after.index()) { crossing.t } else { 0.0 };
            length += if is_solid(crossing.before.index()) { crossing.t } else { 0.0 };
        }
    }
    let unit = scene.unit.metres() / Unit::Millimetre.metres();
    Ok(Some(length * (2.0 * reach / SIDE as f64).powi(2) * unit.powi(3)))
}

/// Writes a scene, reads it back and compares; an error describes the difference.
fn convert(scene: &Scene, name: &str, format: Format) -> Result<(), String> {
    let written =
        write(scene, None, format, &WriteOptions::default()).map_err(|error| format!("writing: {error}"))?;
    let folder = std::env::temp_dir().join(format!("rayweave-convert-{}", std::process::id()));
    std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
    let path = folder.join(format!("{name}.{}", format.extensions()[0]));
    std::fs::write(&path, &written.bytes).map_err(|error| error.to_string())?;
    let read = load(&path, Some(format), &[], &Options::default());
    let _ = std::fs::remove_file(&path);
    let _ = std::fs::remove_dir(&folder);
    let read = read.map_err(|problems| format!("reading: {problems}"))?;
    if read.report.count(LossKind::Refused) > 0 {
        return Err(format!("reading: {}", read.report.warnings()));
    }
    match (volume(scene)?, volume(&read.scene)?) {
        (Some(own), Some(back)) if (back - own).abs() > NEAR * own => Err(format!("{back} instead of {own}")),
        (Some(own), None) if own > 0.0 => Err("nothing comes back".to_owned()),
        _ => Ok(()),
    }
}

fn check(name: &str, scene: &Scene, formats: &[Format]) -> Vec<String> {
    let failed = |format: &Format| {
        let why = convert(scene, name, *format).err()?;
        let why: String = why.chars().take(300).collect();
        Some(format!("{name} as {format}: {why}"))
    };
    formats.iter().filter_map(failed).collect()
}

/// Model files in a folder, with their sizes.
fn files(folder: &Path) -> Vec<(PathBuf, u64)> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<(PathBuf, u64)> = entries
        .map(|entry| (entry.path(), entry.metadata().map_or(0, |data| data.len())))
        .filter(|(path, _)| {
            path.extension()
                .is_some_and(|ending| ["toml", "csg", "gdml"].iter().any(|known| ending == *known))
        })
        .collect();
    files.sort();
    files
}

fn models() -> Vec<(PathBuf, u64)> {
    files(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models"))
}

fn shared() -> Vec<(PathBuf, u64)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    if !folder.is_dir() {
        skipped(format!("examples of other programs are not at {}", folder.display()));
    }
    [files(&folder.join("openscad")), files(&folder.join("gdml"))].concat()
}

fn check_files(files: &[(PathBuf, u64)], formats: &[Format]) {
    let mut failures = Vec::new();
    for (path, _) in files {
        let Ok(imported) = load(path, None, &[], &Options::default()) else { continue };
        // a dump that is empty because its imported file is missing
        if imported.scene.regions.is_empty() {
            continue;
        }
        let name = path.file_stem().unwrap_or_default().to_string_lossy();
        failures.extend(check(&name, &imported.scene, formats));
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn small_models_come_back() {
    let small: Vec<_> =
        [models(), shared()].concat().into_iter().filter(|(_, size)| *size <= SMALL).collect();
    assert!(small.len() >= 3, "{small:?}");
    check_files(&small, &FEW);
}

#[test]
#[ignore = "long"]
fn long_all_models_come_back() {
    check_files(&[models(), shared()].concat(), &ALL);
}

/// Plates over sections and shadows of a bored ball, as in example021 of OpenSCAD, and similar cases: outlines with holes,
/// and a twisted region with a hole in an intersection, as in example009.
#[test]
fn regions_of_the_plane_come_back() {
    let rods = "cylinder($fn = 0, $fa = 30, $fs = 2, h = 62.5, r1 = 12.5, r2 = 6.25, center = true); \
                multmatrix([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]]) \
                cylinder($fn = 0, $fa = 30, $fs = 2, h = 62.5, r1 = 12.5, r2 = 6.25, center = true);";
    let thing = format!("difference() {{ sphere($fn = 0, $fa = 30, $fs = 2, r = 25); {rods} }}");
    let lean = |sign: f64| {
        let s = sign * 0.353_553;
        format!(
            "multmatrix([[0.933013, 0.0669873, {s}, 0], [0.0669873, 0.933013, {}, 0], [{}, {s}, 0.866025, 0], [0, 0, 0, 1]])",
            -s, -s
        )
    };
    let plate = |z: f64| {
        let shift =
            |z: f64| format!("multmatrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, {z}], [0, 0, 0, 1]])");
        format!(
            "{} {} linear_extrude(height = 0.5, center = true) projection(cut = true) {} {} {thing}",
            lean(-1.0),
            shift(-z),
            shift(z),
            lean(1.0)
        )
    };
    let plates: String = [-10.0, 0.0, 15.0].map(plate).concat();
    let angle = "polygon(points = [[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4]]);";
    let cases = [
        ("shadow", format!("linear_extrude(height = 0.5) projection(cut = false) {thing}")),
        ("plates", plates),
        (
            "fan",
            "intersection() { linear_extrude(height = 20, center = true, twist = 40, $fn = 40) difference() { \
             square(20, center = true); circle(r = 4, $fn = 12); } sphere(r = 12); }"
                .to_owned(),
        ),
        ("angles", format!("linear_extrude(height = 2) {angle} rotate_extrude(angle = 90) {angle}")),
        (
            "turned",
            format!(
                "multmatrix([[0.36, 0.48, -0.8, 0], [-0.8, 0.6, 0, 0], [0.48, 0.64, 0.6, 0], [0, 0, 0, 1]]) {{ {} }}",
                format!("linear_extrude(height = 2) {angle}").repeat(2)
            ),
        ),
    ];
    let mut failures = Vec::new();
    for (name, text) in cases {
        // exact discs become many chords
        for facets in if name == "shadow" { [false, true].to_vec() } else { vec![true] } {
            let options = Options { facets, ..Options::default() };
            let imported = parse(&text, Format::OpenScad, &[], &options).expect("a dump");
            assert_eq!(imported.report.count(LossKind::Refused), 0, "{}", imported.report.warnings());
            failures.extend(check(&format!("{name}-{facets}"), &imported.scene, &FEW));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
