//! Mesh files: round trips, hand-written files and malformed files.

#[path = "../../mesh/tests/shapes/mod.rs"]
mod shapes;

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::Vec3;
use rayweave_mesh::{Mesh, MeshError};
use rayweave_mesh_io::{
    FileError, LoadedMesh, MeshFormat, MeshWriteOptions, ReadOptions, read, read_bytes, save, write,
    write_objects,
};
use shapes::{cuboid, potato};

fn written(mesh: &Mesh, format: MeshFormat, text: bool) -> Vec<u8> {
    let mut bytes = Vec::new();
    write(mesh, format, MeshWriteOptions::default().with_text(text), &mut bytes).unwrap();
    bytes
}

fn loaded(bytes: &[u8], format: MeshFormat) -> Result<LoadedMesh, FileError> {
    read_bytes(bytes, format, &ReadOptions::default())
}

fn error_of(text: &str, format: MeshFormat) -> String {
    loaded(text.as_bytes(), format).unwrap_err().to_string()
}

/// The corners of all triangles: formats without vertex indices preserve these.
fn corners(mesh: &Mesh) -> Vec<[Vec3; 3]> {
    (0..mesh.triangles().len()).map(|k| mesh.corners(k)).collect()
}

#[test]
fn round_trips_preserve_every_bit() {
    let mesh = potato(2);
    let single = mesh.mapped(|p| p.as_vec3().as_dvec3()).unwrap();
    for format in MeshFormat::ALL {
        for text in [false, true] {
            let is_single =
                matches!(format, MeshFormat::Gltf | MeshFormat::Glb) || format == MeshFormat::Stl && !text;
            let mesh = if is_single { &single } else { &mesh };
            let back = loaded(&written(mesh, format, text), format).unwrap();
            assert_eq!(corners(&back.mesh), corners(mesh), "{format:?} {text}");
            assert!(back.warnings.is_empty() && back.mesh.vertices().len() == mesh.vertices().len());
        }
    }
}

#[test]
fn formats_follow_the_extension_and_files_are_renamed_when_complete() {
    let folder = std::env::temp_dir().join(format!("rayweave-mesh-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mesh = cuboid(Vec3::ZERO, Vec3::ONE);
    for format in MeshFormat::ALL {
        let path = folder.join(format!("part.{}", format.name().to_uppercase()));
        save(&mesh, &path, None, MeshWriteOptions::default()).unwrap();
        assert_eq!(corners(&read(&path, None, &ReadOptions::default()).unwrap().mesh), corners(&mesh));
    }
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), MeshFormat::ALL.len());
    let unknown = read(&folder.join("part.xyz"), None, &ReadOptions::default()).unwrap_err();
    assert!(unknown.to_string().contains("is unknown: the known extensions are"), "{unknown}");
    std::fs::remove_dir_all(&folder).unwrap();
}

/// Threads that write the same file do not share a temporary file, and the target of a link is replaced, not the link.
#[cfg(unix)]
#[test]
fn threads_and_links() {
    let folder = std::env::temp_dir().join(format!("rayweave-mesh-links-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (target, link) = (folder.join("part.off"), folder.join("link.off"));
    std::fs::write(&target, "old").unwrap();
    std::os::unix::fs::symlink("part.off", &link).unwrap();
    let mesh = cuboid(Vec3::ZERO, Vec3::ONE);
    let save_often = || (0..50).for_each(|_| save(&mesh, &link, None, MeshWriteOptions::default()).unwrap());
    std::thread::scope(|scope| (0..4).for_each(|_| drop(scope.spawn(save_often))));
    assert!(link.is_symlink());
    assert_eq!(corners(&read(&target, None, &ReadOptions::default()).unwrap().mesh), corners(&mesh));
    assert_eq!(std::fs::read_dir(&folder).unwrap().count(), 2);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn faces_with_many_corners_are_triangulated() {
    let text = "# a block with an L as its base\nv 0 0 0\nv 2 0 0\nv 2 1 0 0.5\nv 1 1 0\nv 1 2 0\nv 0 2 0\n\
                v 0 0 1\nv 2 0 1\nv 2 1 1\nv 1 1 1\nv 1 2 1\nv 0 2 1\nvn 0 0 1\no body\ng top\nusemtl red\ns off\n\
                f 6 5 4 3 2 1\nf -6//1 -5//1 -4//1 \\\n -3//1 -2//1 -1//1\n\
                f 1 2 8 7\nf 2 3 9 8\nf 3/1 4/2 10/3 9/4\nf 4 5 11 10\nf 5 6 12 11\nf 6 1 7 12\nl 1 2\n";
    let LoadedMesh { mesh, warnings, .. } = loaded(text.as_bytes(), MeshFormat::Obj).unwrap();
    assert!(mesh.diagnose().is_sound(), "{}", mesh.diagnose());
    assert_eq!((mesh.volume(), mesh.triangles().len()), (3.0, 4 + 4 + 12));
    assert_eq!(
        warnings,
        ["1 points, lines, curves and free-form surfaces are not supported and were ignored"]
    );
    let bent = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n4 0 1 2 3 255 0 0\n";
    let bent = loaded(bent.as_bytes(), MeshFormat::Off).unwrap();
    assert!(bent.warnings[0].starts_with("1 faces with more than three corners are not planar"));
}

#[test]
fn ply_elements_of_both_byte_orders_are_read_and_others_skipped() {
    let head = "format binary_big_endian 1.0\nobj_info by hand\nelement vertex 4\nproperty uchar red\n\
                property float x\nproperty short y\nproperty double z\nelement face 4\n\
                property list uchar ushort vertex_index\nproperty list uint float more\nelement edge 1\nproperty int a\n";
    let mut bytes = format!("ply\n{head}end_header\n").into_bytes();
    for [x, y, z] in [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]] {
        bytes.push(7);
        bytes.extend((x as f32).to_be_bytes());
        bytes.extend((y as i16).to_be_bytes());
        bytes.extend(f64::from(z).to_be_bytes());
    }
    for corners in [[0u16, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]] {
        bytes.push(3);
        corners.iter().for_each(|vertex| bytes.extend(vertex.to_be_bytes()));
        bytes.extend(1u32.to_be_bytes());
        bytes.extend(0.5f32.to_be_bytes());
    }
    bytes.extend([0; 4]);
    let tetrahedron = loaded(&bytes, MeshFormat::Ply).unwrap().mesh;
    assert!((tetrahedron.volume() - 1.0 / 6.0).abs() < 1e-16 && tetrahedron.diagnose().is_sound());
    bytes.truncate(bytes.len() - 6);
    let error = loaded(&bytes, MeshFormat::Ply).unwrap_err().to_string();
    assert!(error.starts_with("byte ") && error.contains("ends before the last element"), "{error}");
}

#[test]
fn errors_give_the_line() {
    use MeshFormat::{Obj, Off, Ply, Stl};
    let cases = [
        (Obj, "v 0 0 0\nv 1 0 nan\n", "line 2: a coordinate is `nan`: it must be finite."),
        (Obj, "v 0 0 1e400\n", "line 1: a coordinate is `1e400`: it must be finite."),
        (Obj, "v 0 0\n", "line 1: the file ends before a coordinate: it is incomplete."),
        (Obj, "v 0 0 1e99\n", "line 1: vertex 0 is"),
        (Obj, "v 0 0 0\nf 1 1 2\n", "line 2: triangle 0 refers to vertex 1"),
        (Obj, "v 0 0 0\nf 1 1\n", "line 2: a face has 2 corners: a face needs at least three."),
        (Obj, "v 0 0 0\nf 1 0 1\n", "line 2: `0` is not a corner"),
        (Obj, "{\"asset\": 1}", "line 1: the file is not OBJ: a line does not begin with a statement"),
        (Off, "OFF\n99999999 3 0\n", "line 2: the mesh has 99999999 vertices: the limit is 20000000."),
        (
            Off,
            "OFF\n9999999 3 0\n",
            "line 2: the file announces 9999999 vertices: its 16 bytes cannot hold them.",
        ),
        (Off, "OFF\n1 1 0\n0 0 0\n4000000000 0 0", "line 4: the file announces 4000000000 corners: its "),
        (Off, "4OFF\n", "line 1: the file is not three-dimensional OFF"),
        (Off, "OFF BINARY\n", "line 1: the file is binary OFF"),
        (Off, "OFF\n-1 0 0\n", "line 2: the number of vertices is `-1`"),
        (Ply, "plx\n", "line 1: the first line is not `ply`"),
        (Ply, "ply\nformat ascii 1.0\n", "line 2: the file ends before `end_header`"),
        (Ply, "ply\nproperty float x\n", "line 2: `property float x` is not a header line"),
        (
            Ply,
            "ply\nformat ascii 1.0\nelement edge 18000000\nproperty float x\nend_header\n",
            "line 5: the file announces 18000000 elements edge",
        ),
        (
            Ply,
            "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n",
            "line 5: element vertex has no property y",
        ),
        (Stl, "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf\n", "line 4: a coordinate is `inf`"),
        (
            Stl,
            "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n",
            "line 4: the file ends before vertex",
        ),
        (Stl, "solid x\n", "line 1: the file ends before `endsolid`"),
        (Stl, "", "byte 0: the file ends before the header"),
    ];
    for (format, text, wanted) in cases {
        let found = error_of(text, format);
        assert!(found.starts_with(wanted), "{text:?}: {found}");
    }
}

/// A 3MF archive with one model part.
fn archive(model: &str) -> Vec<u8> {
    archive_of(&[("3D/3dmodel.model", model)])
}

fn archive_of(models: &[(&str, &str)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, model) in models {
        archive.start_file(*name, zip::write::SimpleFileOptions::default()).unwrap();
        std::io::Write::write_all(&mut archive, model.as_bytes()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

const TETRAHEDRON: &str = r#"<object id="1"><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/>
    <vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles><triangle v1="0" v2="2" v3="1"/>
    <triangle v1="0" v2="1" v3="3"/><triangle v1="1" v2="2" v3="3"/><triangle v1="0" v2="3" v3="2"/></triangles></mesh></object>"#;

#[test]
fn components_of_3mf_are_instantiated() {
    let model = format!(
        r#"<model unit="inch"><resources>{TETRAHEDRON}<object id="2"><components>
        <component objectid="1"/><component objectid="1" transform="2 0 0 0 2 0 0 0 2 5 0 0"/></components></object></resources>
        <build><item objectid="2" transform="0 1 0 -1 0 0 0 0 1 0 0 10"/></build></model>"#
    );
    let found = loaded(&archive(&model), MeshFormat::ThreeMf).unwrap();
    assert_eq!(found.unit.as_deref(), Some("inch"));
    assert!((found.mesh.volume() - 9.0 / 6.0).abs() < 1e-14);
    let bounds = found.mesh.bounds();
    assert_eq!((bounds.lo, bounds.hi), (Vec3::new(-2.0, 0.0, 10.0), Vec3::new(0.0, 7.0, 12.0)));
    let error = |from: &str, to: &str| {
        loaded(&archive(&model.replace(from, to)), MeshFormat::ThreeMf).unwrap_err().to_string()
    };
    assert!(error("objectid=\"2\"", "objectid=\"7\"").contains("there is no object 7"));
    assert!(error("objectid=\"1\"/>", "objectid=\"2\"/>").contains("components probably contain each other"));
    assert!(error("x=\"1\"", "x=\"1e400\"").contains("x is `1e400`: it must be a finite number"));
    assert!(error("v1=\"1\"", "v1=\"4\"").contains("refers to vertex 4"));
    assert!(error("</model>", "").contains("ends before `</model>`"));
    assert!(error("2 0 0 0 2", "2 0 0 0").contains("12 finite numbers"));
}

/// The layout of slicers: each object in a model part of its own, with its own ids and build.
#[test]
fn model_parts_of_3mf_refer_to_each_other() {
    let main = r#"<model unit="centimeter" xmlns:p="production" xmlns:s="slices"><resources><s:slicestack id="9"><s:vertex x="0" y="0"/></s:slicestack>
        <object id="1"><components><component p:path="/3D/Objects/one.model" objectid="1"/>
        <component p:path="/3D/Objects/one.model" objectid="1" transform="2 0 0 0 2 0 0 0 2 5 0 0"/></components></object></resources>
        <build><item objectid="1"/><item p:path="/3D/Objects/one.model" objectid="1" transform="1 0 0 0 1 0 0 0 1 0 0 9"/></build></model>"#;
    let one = format!(
        r#"<model unit="inch"><resources>{TETRAHEDRON}</resources><build><item objectid="1"/></build></model>"#
    );
    let names = ["3D/3dmodel.model", "3D/Objects/one.model"];
    let found = loaded(&archive_of(&[(names[0], main), (names[1], &one)]), MeshFormat::ThreeMf).unwrap();
    assert_eq!(found.unit.as_deref(), Some("cm"));
    assert!((found.mesh.volume() - 10.0 / 6.0).abs() < 1e-14);
    assert_eq!((found.mesh.bounds().lo, found.mesh.bounds().hi), (Vec3::ZERO, Vec3::new(7.0, 2.0, 10.0)));
    assert_eq!(found.objects.len(), 2);
    let alone = loaded(&archive(main), MeshFormat::ThreeMf).unwrap_err().to_string();
    assert!(alone.contains("specified file not found"), "{alone}");
    let other = one.replace("object id=\"1\"", "object id=\"2\"");
    let refused =
        loaded(&archive_of(&[(names[0], main), (names[1], &other)]), MeshFormat::ThreeMf).unwrap_err();
    assert!(refused.to_string().contains("no object 1 in the part `3D/Objects/one.model`"), "{refused}");
}

#[test]
fn lines_may_end_with_carriage_returns_alone() {
    let mesh = cuboid(Vec3::ZERO, Vec3::ONE);
    for format in [MeshFormat::Stl, MeshFormat::Obj, MeshFormat::Off] {
        let text = String::from_utf8(written(&mesh, format, true)).unwrap();
        for end in ["\r", "\r\n"] {
            let found = loaded(text.replace('\n', end).as_bytes(), format).unwrap();
            assert_eq!(found.mesh.volume(), 1.0);
            assert_eq!(found.mesh.triangles().len(), 12);
        }
    }
}

#[test]
fn version_1_of_gltf_is_rejected() {
    let error = |bytes: &[u8]| loaded(bytes, MeshFormat::Gltf).unwrap_err().to_string();
    let first = br#"{"asset":{"version":"1.0"},"meshes":{"box":{}}}"#;
    assert!(error(first).contains("the glTF file has version 1.0: only version 2 is supported. Convert it."));
    assert!(error(br#"{"meshes":{"box":{}}}"#).contains("the glTF file has no version"));
    assert!(error(b"glTF\x01\0\0\0\x14\0\0\0").contains("the glTF file has version 1.0"));
}

/// Normalised 16-bit positions, in which 32767 represents 1, and a required extension that does not affect triangles.
#[test]
fn quantised_positions_of_gltf_are_read() {
    let mesh = cuboid(Vec3::ZERO, Vec3::ONE);
    let text = String::from_utf8(written(&mesh, MeshFormat::Gltf, false)).unwrap();
    let mut root: serde_json::Value = serde_json::from_str(&text).unwrap();
    let points: Vec<u8> = mesh
        .vertices()
        .iter()
        .flat_map(|p| p.to_array())
        .flat_map(|x| (if x > 0.5 { i16::MAX } else { i16::MIN }).to_le_bytes())
        .collect();
    let uri = format!("data:application/octet-stream;base64,{}", base64(&points));
    let count = root["buffers"].as_array().unwrap().len();
    root["buffers"]
        .as_array_mut()
        .unwrap()
        .push(serde_json::json!({ "byteLength": points.len(), "uri": uri }));
    root["bufferViews"][0] = serde_json::json!({ "buffer": count, "byteLength": points.len() });
    root["accessors"][0]["componentType"] = 5122.into();
    root["accessors"][0]["normalized"] = true.into();
    root["extensionsRequired"] = serde_json::json!(["KHR_mesh_quantization", "KHR_materials_sheen"]);
    let found = loaded(root.to_string().as_bytes(), MeshFormat::Gltf).unwrap();
    assert_eq!((found.mesh.bounds().lo, found.mesh.bounds().hi), (Vec3::NEG_ONE, Vec3::ONE));
    root["extensionsRequired"] = serde_json::json!(["KHR_draco_mesh_compression"]);
    assert!(loaded(root.to_string().as_bytes(), MeshFormat::Gltf).unwrap_err().to_string().contains("draco"));
}

/// Base64 (RFC 4648, section 4).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for three in bytes.chunks(3) {
        let bits =
            three.iter().fold(0u32, |bits, &byte| bits << 8 | u32::from(byte)) << (8 * (3 - three.len()));
        for k in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * k) & 63) as usize];
            text.push(if k > three.len() { '=' } else { char::from(digit) });
        }
    }
    text
}

#[test]
fn nodes_of_gltf_are_transformed() {
    let mesh = cuboid(Vec3::ZERO, Vec3::ONE);
    let text = String::from_utf8(written(&mesh, MeshFormat::Gltf, false)).unwrap();
    let nodes = r#""nodes":[{"children":[1,2]},{"mesh":0,"scale":[2,1,1],"rotation":[0,0,0.7071067811865476,0.7071067811865476],"translation":[0,0,5]},
        {"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,7,0,0,1]}],"scene""#;
    let tree = text.replace(r#""nodes":[{"mesh":0}],"scene""#, nodes);
    assert_ne!(tree, text);
    let found = loaded(tree.as_bytes(), MeshFormat::Gltf).unwrap();
    assert!((found.mesh.volume() - 3.0).abs() < 1e-14);
    let bounds = found.mesh.bounds();
    assert!((bounds.lo - Vec3::new(-1.0, 0.0, 0.0)).length() < 1e-15, "{bounds:?}");
    assert!((bounds.hi - Vec3::new(8.0, 2.0, 6.0)).length() < 1e-15, "{bounds:?}");
    let error = |from: &str, to: &str| {
        assert!(tree.contains(from), "{from}");
        loaded(tree.replace(from, to).as_bytes(), MeshFormat::Gltf).unwrap_err().to_string()
    };
    assert!(error("\"children\":[1,2]", "\"children\":[1,0]").contains("a child of two nodes, or of itself"));
    assert!(
        error("\"count\":36", "\"count\":37").contains("accessor 1 cannot be read: it exceeds its buffer")
    );
    assert!(error("\"count\":36", "\"count\":36000000000").contains("the limit is 20000000"));
    assert!(error("base64,", "base64,!").contains("buffer 0 is invalid: its URI is not base64"));
    assert!(error("data:application", "../data").contains("is outside the folder of the model"));
}

/// A wrong count in a header does not cause an allocation.
#[test]
fn counts_are_compared_with_the_length_of_the_file() {
    let mut bytes = written(&cuboid(Vec3::ZERO, Vec3::ONE), MeshFormat::Stl, false);
    let more = [bytes.clone(), vec![1, 2, 3]].concat();
    assert_eq!(
        loaded(&more, MeshFormat::Stl).unwrap().warnings,
        ["3 bytes after the last triangle are ignored"]
    );
    bytes[80..84].copy_from_slice(&13u32.to_le_bytes());
    let error = loaded(&bytes, MeshFormat::Stl).unwrap_err().to_string();
    assert!(error.starts_with("byte 80: 13 triangles take 734 bytes: the file has 684."), "{error}");
    bytes[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = loaded(&bytes, MeshFormat::Stl).unwrap_err();
    assert!(matches!(error, FileError::Mesh { error: MeshError::TooMany { count: 4_294_967_295, .. }, .. }));
    // some programs write `solid` at the start of binary files
    let mut solid = written(&cuboid(Vec3::ZERO, Vec3::ONE), MeshFormat::Stl, false);
    solid[..5].copy_from_slice(b"solid");
    assert_eq!(loaded(&solid, MeshFormat::Stl).unwrap().mesh.triangles().len(), 12);
    let few = ReadOptions::default().with_max_elements(11);
    assert!(read_bytes(&solid, MeshFormat::Stl, &few).is_err());
}

/// Truncated files and files with changed bytes are read or rejected, without a panic and without delay.
#[test]
fn damaged_files_are_read_or_rejected() {
    let mesh = cuboid(-Vec3::ONE, Vec3::splat(1.5));
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    for format in MeshFormat::ALL {
        for text in [false, true] {
            let bytes = written(&mesh, format, text);
            let (mut read, mut rejected) = (0, 0);
            let mut check = |bytes: &[u8]| match loaded(bytes, format) {
                Ok(found) => {
                    assert!(found.mesh.vertices().iter().all(|p| p.is_finite()));
                    read += 1;
                }
                Err(error) => {
                    assert!(!error.to_string().is_empty());
                    rejected += 1;
                }
            };
            (0..bytes.len()).for_each(|end| check(&bytes[..end]));
            for _ in 0..1500 {
                let mut damaged = bytes.clone();
                for _ in 0..rng.random_range(1..4) {
                    let at = rng.random_range(0..damaged.len());
                    damaged[at] = match rng.random_range(0..3) {
                        0 => rng.random(),
                        1 => damaged[at] ^ 1 << rng.random_range(0..8),
                        _ => b"0 -9enf\n"[rng.random_range(0..8)],
                    };
                }
                check(&damaged);
            }
            assert!(read > 20 && rejected > 300, "{format:?} {text}: {read} {rejected}");
        }
    }
}

#[test]
fn objects_of_a_file_are_distinguished() {
    let (a, b) = (cuboid(Vec3::ZERO, Vec3::ONE), potato(1).mapped(|p| p.as_vec3().as_dvec3()).unwrap());
    let objects = [("a <&> \"b\"", &a), ("second one", &b)];
    for format in MeshFormat::ALL {
        for text in [false, true] {
            let mut bytes = Vec::new();
            write_objects(&objects, format, MeshWriteOptions::default().with_text(text), &mut bytes).unwrap();
            let back = loaded(&bytes, format).unwrap();
            let all = [corners(&a), corners(&b)].concat();
            assert!(back.warnings.is_empty() && corners(&back.mesh) == all, "{format:?} {text}");
            let has_no_objects =
                matches!(format, MeshFormat::Ply | MeshFormat::Off) || format == MeshFormat::Stl && !text;
            let found =
                back.objects.iter().map(|object| (object.name.as_str(), corners(&back.object_mesh(object))));
            let expected = objects.iter().map(|(name, mesh)| (*name, corners(mesh)));
            let is_equal = found.collect::<Vec<_>>() == expected.collect::<Vec<_>>();
            assert!(
                if has_no_objects { back.objects.is_empty() } else { is_equal },
                "{format:?} {text} {:?}",
                back.objects
            );
        }
    }
    let groups = "g a\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ng empty\ng b\nf 3 2 1\n";
    let objects = loaded(groups.as_bytes(), MeshFormat::Obj).unwrap().objects;
    let names: Vec<_> = objects.into_iter().map(|object| (object.name, object.triangles)).collect();
    assert_eq!(names, [("a".to_owned(), 0..1), ("b".to_owned(), 1..2)]);
}

#[test]
fn names_of_gltf_are_those_of_nodes_and_meshes() {
    let (a, b) = (cuboid(Vec3::ZERO, Vec3::ONE), cuboid(Vec3::ZERO, Vec3::splat(2.0)));
    let mut bytes = Vec::new();
    let options = MeshWriteOptions::default();
    write_objects(&[("skull", &a), ("", &b)], MeshFormat::Gltf, options, &mut bytes).unwrap();
    let root: serde_json::Value = serde_json::from_slice(&bytes).unwrap();
    for kind in ["nodes", "meshes"] {
        let names: Vec<_> =
            root[kind].as_array().unwrap().iter().map(|entry| entry["name"].as_str()).collect();
        assert_eq!(names, [Some("skull"), None], "{kind}");
    }
}

/// Small archives that describe much more than they contain.
#[test]
fn archives_have_one_budget() {
    let error =
        |parts: &[(&str, &str)]| loaded(&archive_of(parts), MeshFormat::ThreeMf).unwrap_err().to_string();
    let model = |resources: &str, build: &str| {
        format!("<model unit=\"meter\"><resources>{resources}</resources><build>{build}</build></model>")
    };
    let main = "3D/3dmodel.model";
    // one attribute of 20 MB, and many elements that compress as well
    let name =
        model(&TETRAHEDRON.replace("id=\"1\"", &format!("id=\"1\" name=\"{}\"", "a".repeat(20_000_000))), "");
    let found = error(&[(main, &name)]);
    assert!(found.contains("an element has more than 1048576 bytes"), "{found}");
    let found =
        error(&[(main, &model(&"<vertex/>\n".repeat(0).replace("", &" ".repeat(1000)).repeat(20_000), ""))]);
    assert!(found.contains("bytes"), "{found}");
    let found = error(&[(main, &model(&"<!-- nothing -->".repeat(1_200_000), ""))]);
    assert!(found.contains("the archive expands to more than 16777216 bytes"), "{found}");
    // parts share the budget, and the message names the one that exceeds it
    let items: String = (0..30).map(|k| format!("<item objectid=\"1\" path=\"/3D/{k}.model\"/>")).collect();
    let (first, filler) = (model("", &items), model(&"<!-- nothing -->".repeat(60_000), ""));
    let names: Vec<String> = (0..30).map(|k| format!("3D/{k}.model")).collect();
    let parts: Vec<(&str, &str)> = std::iter::once((main, first.as_str()))
        .chain(names.iter().map(|name| (name.as_str(), filler.as_str())))
        .collect();
    let found = error(&parts);
    assert!(found.contains("part `3D/") && found.contains("the archive expands to more"), "{found}");
    let items: String = (0..5000).map(|k| format!("<item objectid=\"1\" path=\"/3D/{k}.model\"/>")).collect();
    let names: Vec<String> = (0..5000).map(|k| format!("3D/{k}.model")).collect();
    let (first, nothing) = (model("", &items), model("", ""));
    let parts: Vec<(&str, &str)> = std::iter::once((main, first.as_str()))
        .chain(names.iter().map(|name| (name.as_str(), nothing.as_str())))
        .collect();
    assert!(error(&parts).contains("the model has more than 4096 parts"));
    // nested components: 4^13 tetrahedra, which the limit of vertices cuts off
    let nested: String = (2..15)
        .map(|id| {
            format!(
                "<object id=\"{id}\"><components>{}</components></object>",
                format!("<component objectid=\"{}\"/>", id - 1).repeat(4)
            )
        })
        .collect();
    let found = error(&[(main, &model(&format!("{TETRAHEDRON}{nested}"), "<item objectid=\"14\"/>"))]);
    assert!(found.contains("the file uses its meshes so often that they make 300004 vertices"), "{found}");
    let many = model("", &"<item objectid=\"1\"/>".repeat(600_000));
    let found = error(&[(main, &many)]);
    assert!(found.contains("no object 1") || found.contains("more than"), "{found}");
}

#[test]
fn accessors_of_gltf_are_not_used_without_limit() {
    let mesh = cuboid(Vec3::ZERO, Vec3::ONE);
    let text = String::from_utf8(written(&mesh, MeshFormat::Gltf, false)).unwrap();
    let mut root: serde_json::Value = serde_json::from_str(&text).unwrap();
    let primitive = root["meshes"][0]["primitives"][0].clone();
    root["meshes"][0]["primitives"] = vec![primitive; 100_000].into();
    let found = loaded(root.to_string().as_bytes(), MeshFormat::Gltf).map(|mesh| mesh.mesh.triangles().len());
    // 1.2 million triangles are few for a file of this size, but not for one that repeats the primitive by nodes
    assert_eq!(found.unwrap(), 1_200_000);
    root["meshes"][0]["primitives"].as_array_mut().unwrap().truncate(100);
    root["nodes"] = vec![root["nodes"][0].clone(); 2000].into();
    root["scenes"][0]["nodes"] = (0..2000).collect::<Vec<_>>().into();
    let found = loaded(root.to_string().as_bytes(), MeshFormat::Gltf).unwrap_err().to_string();
    assert!(found.contains("uses its meshes so often that they make 3000"), "{found}");
}

/// The nodes of a long list of roots, which took quadratic time.
#[test]
fn root_nodes_of_gltf_are_found_in_linear_time() {
    let nodes = vec!["{\"children\":[]}"; 100_000].join(",");
    let children: Vec<String> = (1..100_000).map(|k| k.to_string()).collect();
    let text = format!(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"nodes\":[{{\"children\":[{}]}},{nodes}]}}",
        children.join(",")
    );
    let start = std::time::Instant::now();
    let found = loaded(text.as_bytes(), MeshFormat::Gltf);
    assert!(found.is_ok_and(|found| found.mesh.triangles().is_empty()));
    assert!(start.elapsed().as_secs() < 20);
}

#[test]
fn buffers_of_gltf_are_read_once_and_within_a_limit() {
    let folder = std::env::temp_dir().join(format!("rayweave-buffers-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let write = |length: u64| {
        let sparse = std::fs::File::create(folder.join("sparse.bin")).unwrap();
        sparse.set_len(length).unwrap();
        let buffers = ["{\"uri\":\"sparse.bin\"}"; 6].join(",");
        let text = format!("{{\"asset\":{{\"version\":\"2.0\"}},\"buffers\":[{buffers}]}}");
        std::fs::write(folder.join("a.gltf"), text).unwrap();
        read(&folder.join("a.gltf"), None, &ReadOptions::default())
    };
    assert!(write(1 << 20).is_ok());
    let found = write(1 << 30).unwrap_err().to_string();
    std::fs::remove_dir_all(&folder).unwrap();
    assert!(
        found.contains("buffer 0 is too large: together the buffers may have 536870912 bytes"),
        "{found}"
    );
}
