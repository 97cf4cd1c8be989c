//! Mesh files as models: regions, units, defects and repair.

use rayweave_formats::{Format, Imported, LossKind, Options, load, parse};
use rayweave_math::Vec3;
use rayweave_mesh::Mesh;
use rayweave_mesh_io::{MeshFormat, MeshWriteOptions, save};
use rayweave_model::{Evaluator, Program, RegionId};
use rayweave_scene::{Diagnostics, Unit};
use rayweave_trace::Weave;
use std::path::PathBuf;
use std::sync::Arc;

/// A temporary folder, removed when dropped.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let folder = std::env::temp_dir().join(format!("rayweave-formats-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        Folder(folder)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The twelve triangles of a box.
fn cuboid(lo: [f64; 3], hi: [f64; 3]) -> Mesh {
    let corner = |k: usize| {
        Vec3::from_array(std::array::from_fn(|axis| if k >> axis & 1 == 1 { hi[axis] } else { lo[axis] }))
    };
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect();
    Mesh::new((0..8).map(corner).collect(), triangles).unwrap()
}

/// A mesh that comes from a pipe, of which neither the length nor the folder is known.
#[cfg(unix)]
#[test]
fn pipes() {
    let folder = Folder::new("pipes");
    // regions have the names of the files
    let [file, pipe] = ["box.stl", "pipe/box.stl"].map(|name| folder.0.join(name));
    std::fs::create_dir(folder.0.join("pipe")).unwrap();
    save(&cuboid([0.0; 3], [1.0, 2.0, 3.0]), &file, None, MeshWriteOptions::default()).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let bytes = std::fs::read(&file).unwrap();
    let own = pipe.clone();
    let writer = std::thread::spawn(move || std::fs::write(own, bytes));
    let piped = load(&pipe, None, &[], &Options::default()).unwrap_or_else(|problems| panic!("{problems}"));
    writer.join().unwrap().unwrap();
    let direct = load(&file, None, &[], &Options::default()).unwrap_or_else(|problems| panic!("{problems}"));
    assert_eq!(piped.scene.regions.len(), 1);
    assert_eq!(piped.scene.regions[0].solid, direct.scene.regions[0].solid);
}

fn obj(objects: &[(&str, &Mesh)]) -> String {
    let (mut text, mut first) = (String::new(), 1);
    for (name, mesh) in objects {
        text += &format!("o {name}\n");
        mesh.vertices().iter().for_each(|p| text += &format!("v {} {} {}\n", p.x, p.y, p.z));
        mesh.triangles()
            .iter()
            .for_each(|[a, b, c]| text += &format!("f {} {} {}\n", a + first, b + first, c + first));
        first += mesh.vertices().len() as u32;
    }
    text
}

fn read(text: &str, options: &Options) -> Result<Imported, Diagnostics> {
    parse(text, Format::Mesh(MeshFormat::Obj), &[], options)
}

/// Index of the region that contains a point, 0 for none.
fn region(imported: &Imported, point: [f64; 3]) -> u32 {
    let program = Arc::new(Program::compile_regions(&imported.scene.model_regions()).unwrap());
    let weave = Weave::new(program);
    let mut region = [RegionId(0)];
    let [x, y, z] = point;
    weave.regions_at([&[x], &[y], &[z]], &mut weave.scratch(), &mut region);
    region[0].0
}

#[test]
fn every_format_of_meshes_is_a_model() {
    let folder = Folder::new("every");
    for format in MeshFormat::ALL {
        let path = folder.0.join(format!("part.{}", format.name()));
        save(&cuboid([0.0; 3], [1.0, 2.0, 3.0]), &path, None, MeshWriteOptions::default()).unwrap();
        let imported = load(&path, None, &[], &Options::default()).unwrap();
        let scene = &imported.scene;
        assert_eq!((scene.regions.len(), scene.regions[0].name.as_str()), (1, "part"), "{format:?}");
        assert!(imported.report.is_empty() && scene.warnings.is_empty());
        // glTF has its y axis up
        let is_gltf = matches!(format, MeshFormat::Gltf | MeshFormat::Glb);
        let (inside, outside) = match is_gltf {
            true => ([0.5, -2.5, 1.5], [0.5, 1.5, 2.5]),
            false => ([0.5, 1.5, 2.5], [0.5, -2.5, 1.5]),
        };
        assert_eq!((region(&imported, inside), region(&imported, outside)), (1, 0), "{format:?}");
        assert_eq!(scene.unit, if is_gltf { Unit::Metre } else { Unit::Millimetre });
        // the document describes the same model
        let (_, back) = rayweave_scene::parse(&imported.document().to_toml()).unwrap();
        assert_eq!(&back, scene);
    }
}

#[test]
fn units_are_the_files_or_as_requested() {
    let folder = Folder::new("units");
    let inch = Options { unit: Some(Unit::Inch), ..Options::default() };
    let text = obj(&[("a", &cuboid([0.0; 3], [1.0; 3]))]);
    assert_eq!(read(&text, &inch).unwrap().scene.unit, Unit::Inch);
    let path = folder.0.join("part.3mf");
    save(&cuboid([0.0; 3], [1.0; 3]), &path, None, MeshWriteOptions::default()).unwrap();
    let refused = load(&path, None, &[], &inch).unwrap_err().to_string();
    assert!(
        refused.contains("the unit cannot be set to in: files in the format 3mf specify their unit."),
        "{refused}"
    );
}

#[test]
fn closed_objects_are_regions_and_the_later_wins() {
    let (a, b) = (cuboid([0.0; 3], [2.0; 3]), cuboid([1.0; 3], [3.0; 3]));
    let imported = read(&obj(&[("left", &a), ("right", &b), ("right", &b)]), &Options::default()).unwrap();
    let names: Vec<&str> = imported.scene.regions.iter().map(|region| region.name.as_str()).collect();
    assert_eq!(names, ["left", "right", "right2"]);
    let at = |x: f64| region(&imported, [x; 3]);
    assert_eq!([at(-0.5), at(0.5), at(1.5), at(2.5)], [0, 1, 3, 3]);
}

#[test]
fn objects_that_close_only_together_are_one_solid() {
    let whole = cuboid([0.0; 3], [1.0; 3]);
    let (vertices, triangles) = whole.into_parts();
    let half =
        |range: std::ops::Range<usize>| Mesh::new(vertices.clone(), triangles[range].to_vec()).unwrap();
    let imported = read(&obj(&[("a", &half(0..5)), ("b", &half(5..12))]), &Options::default()).unwrap();
    assert_eq!(imported.scene.regions.len(), 1);
    assert_eq!((region(&imported, [0.5; 3]), region(&imported, [1.5; 3])), (1, 0));
    let warnings = imported.scene.warnings.to_string();
    assert!(
        warnings.contains("2 of 2 objects are not closed on their own: all triangles together"),
        "{warnings}"
    );
}

#[test]
fn open_meshes_are_errors_with_position_unless_repaired() {
    let (vertices, triangles) = cuboid([0.0; 3], [1.0; 3]).into_parts();
    // a lid is missing, one triangle is duplicated, one is reversed
    let mut broken = triangles[2..].to_vec();
    broken.push(triangles[5]);
    broken[4].swap(0, 1);
    let text = obj(&[("a", &Mesh::new(vertices, broken).unwrap())]);
    let refused = read(&text, &Options::default()).unwrap_err().to_string();
    assert!(refused.contains("the mesh is not a solid: the mesh is not closed"), "{refused}");
    assert!(refused.contains("--repair"), "{refused}");
    let repair = Options { repair: true, ..Options::default() };
    let imported = read(&text, &repair).unwrap();
    assert_eq!((region(&imported, [0.5; 3]), region(&imported, [1.5; 3])), (1, 0));
    let done: Vec<(LossKind, &str)> =
        imported.report.iter().map(|loss| (loss.kind, loss.what.as_str())).collect();
    let expected = ["duplicate triangles removed", "plane holes filled", "triangles reversed"];
    assert_eq!(done, expected.map(|what| (LossKind::Approximated, what)));
    let warnings = imported.scene.warnings.to_string();
    assert!(warnings.contains("the mesh was repaired: 1 plane hole filled"), "{warnings}");
}

#[test]
fn nearby_points_are_joined_if_that_closes_the_mesh() {
    let mesh = cuboid([0.0; 3], [1.0; 3]);
    let (vertices, triangles) = mesh.into_parts();
    // each triangle has its own vertices, which differ in the seventh digit
    let apart: Vec<Vec3> = triangles
        .iter()
        .enumerate()
        .flat_map(|(k, t)| t.map(|v| vertices[v as usize] + 1e-8 * k as f64))
        .collect();
    let numbers = (0..triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let text = obj(&[("a", &Mesh::new(apart, numbers).unwrap())]);
    assert!(read(&text, &Options::default()).is_err());
    let imported = read(&text, &Options { repair: true, ..Options::default() }).unwrap();
    assert_eq!((region(&imported, [0.5; 3]), region(&imported, [1.5; 3])), (1, 0));
    let joined = imported.report.iter().next().unwrap();
    assert_eq!(joined.what, "vertices merged");
}

#[test]
fn impossible_counts_are_refused_before_allocation() {
    let folder = Folder::new("count");
    let path = folder.0.join("huge.stl");
    let mut bytes = vec![0; 84];
    bytes[80..].copy_from_slice(&u32::MAX.to_le_bytes());
    bytes.extend([0; 16]);
    std::fs::write(&path, bytes).unwrap();
    let refused = load(&path, None, &[], &Options::default()).unwrap_err().to_string();
    assert!(refused.contains("4294967295 triangles: the limit is"), "{refused}");
    let missing = load(folder.0.join("none.ply"), None, &[], &Options::default()).unwrap_err().to_string();
    assert!(missing.contains("none.ply") && missing.contains("there is no such file"), "{missing}");
    let set = [("R".to_owned(), "1".to_owned())];
    assert!(parse("", Format::Mesh(MeshFormat::Off), &set, &Options::default()).is_err());
}

#[test]
fn folded_sheets_enclose_no_volume() {
    // a boundary of three edges is a plane hole; filling it makes two triangles of one
    let text = "v 0 0 0\nv 3 0 0\nv 0 4 0\nf 1 2 3\n";
    let mending = Options { repair: true, ..Options::default() };
    let problems = read(text, &mending).unwrap_err().to_string();
    assert!(problems.contains("encloses no volume"), "{problems}");
    // both sides of a square
    let sheet = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\nf 1 3 2\nf 1 4 3\n";
    let problems = read(sheet, &Options::default()).unwrap_err().to_string();
    assert!(problems.contains("encloses no volume") && !problems.contains("--repair"), "{problems}");
}

/// The outward faces of a tetrahedron as an object of a 3MF model, with some attributes.
fn tetrahedron(attributes: &str) -> String {
    format!(
        r#"<object {attributes}><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/>
        <vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/><triangle v1="0" v2="1" v3="3"/>
        <triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles></mesh></object>"#
    )
}

/// A 3MF file with a unit, objects and a build.
fn threemf(folder: &Folder, unit: &str, objects: &str, build: &str) -> Imported {
    let path = folder.0.join("model.3mf");
    let mut archive = zip::ZipWriter::new(std::fs::File::create(&path).unwrap());
    archive.start_file("3D/3dmodel.model", zip::write::SimpleFileOptions::default()).unwrap();
    let model = format!("<model{unit}><resources>{objects}</resources><build>{build}</build></model>");
    std::io::Write::write_all(&mut archive, model.as_bytes()).unwrap();
    archive.finish().unwrap();
    load(&path, None, &[], &Options::default()).unwrap_or_else(|problems| panic!("{model}\n{problems}"))
}

#[test]
fn units_of_3mf_are_known_or_reported() {
    let folder = Folder::new("units-of-3mf");
    let read = |unit: &str| threemf(&folder, unit, &tetrahedron("id=\"1\""), "<item objectid=\"1\"/>").scene;
    let known = [
        ("", Unit::Millimetre),
        (" unit=\"micron\"", Unit::Micrometre),
        (" unit=\"millimeter\"", Unit::Millimetre),
        (" unit=\"centimeter\"", Unit::Centimetre),
        (" unit=\"inch\"", Unit::Inch),
        (" unit=\"foot\"", Unit::Foot),
        (" unit=\"meter\"", Unit::Metre),
    ];
    for (text, unit) in known {
        let scene = read(text);
        assert_eq!((scene.unit, scene.warnings.len()), (unit, 0), "{text}");
    }
    let scene = read(" unit=\"parsec\"");
    let warnings = scene.warnings.to_string();
    assert!(warnings.contains("the unit `parsec` is unknown"), "{warnings}");
    assert_eq!(scene.unit, Unit::Millimetre);
}

#[test]
fn supports_of_3mf_are_left_out() {
    let folder = Folder::new("supports-of-3mf");
    for kind in ["support", "solidsupport", "other"] {
        let objects = [
            tetrahedron("id=\"1\" type=\"model\""),
            tetrahedron(&format!("id=\"2\" name=\"foot\" type=\"{kind}\"")),
        ];
        let build = "<item objectid=\"1\"/><item objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 1 5 0 0\"/>";
        let imported = threemf(&folder, "", &objects.concat(), build);
        assert_eq!((region(&imported, [0.1; 3]), region(&imported, [5.1, 0.1, 0.1])), (1, 0), "{kind}");
        let warnings = imported.scene.warnings.to_string();
        assert!(warnings.contains(&format!("object 2 `foot` was ignored: its type `{kind}`")), "{warnings}");
    }
}

#[test]
fn mirrors_turn_triangles() {
    let folder = Folder::new("mirrors");
    // in the build, and in components of which one is a reflection of a reflection
    let objects = tetrahedron("id=\"1\"")
        + r#"<object id="2"><components><component objectid="1"/><component objectid="1" transform="-1 0 0 0 1 0 0 0 1 -9 0 0"/>
        </components></object>"#;
    let build = r#"<item objectid="2" transform="1 0 0 0 1 0 0 0 -1 0 0 0"/>"#;
    let imported = threemf(&folder, "", &objects, build);
    assert!(imported.scene.warnings.is_empty(), "{}", imported.scene.warnings);
    assert_eq!((region(&imported, [0.1, 0.1, -0.1]), region(&imported, [-9.1, 0.1, -0.1])), (1, 1));

    let path = folder.0.join("part.gltf");
    save(&cuboid([0.0; 3], [1.0; 3]), &path, None, MeshWriteOptions::default()).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    let nodes = r#""nodes":[{"mesh":0,"scale":[-1,1,1],"translation":[7,0,0]}],"scene""#;
    let mirrored = text.replace(r#""nodes":[{"mesh":0}],"scene""#, nodes);
    assert_ne!(mirrored, text);
    let imported = parse(&mirrored, Format::Mesh(MeshFormat::Gltf), &[], &Options::default()).unwrap();
    assert!(imported.scene.warnings.is_empty(), "{}", imported.scene.warnings);
    assert_eq!((region(&imported, [6.5, -0.5, 0.5]), region(&imported, [0.5, -0.5, 0.5])), (1, 0));
}

#[test]
fn thousands_of_objects_may_have_one_name() {
    let boxes: Vec<Mesh> = (0..3000)
        .map(|k| cuboid([3.0 * f64::from(k), 0.0, 0.0], [3.0 * f64::from(k) + 1.0, 1.0, 1.0]))
        .collect();
    let named: Vec<(&str, &Mesh)> = boxes.iter().map(|mesh| ("part", mesh)).collect();
    let start = std::time::Instant::now();
    let found = parse(&obj(&named), Format::Mesh(MeshFormat::Obj), &[], &Options::default()).unwrap();
    assert_eq!(found.scene.regions.len(), 3000);
    assert_eq!(found.scene.regions[2999].name, "part3000");
    assert!(start.elapsed().as_secs() < 30);
}
