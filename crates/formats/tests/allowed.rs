//! Files that models refer to: only those in the folder of the model or below are read, and those that the caller allows.
#![cfg(unix)]

use rayweave_formats::{Options, load};
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder with `model/`, which contains the models, and `other/`, which they may not read.
struct Tree(PathBuf);

impl Tree {
    fn new(name: &str) -> Tree {
        let root = std::env::temp_dir().join(format!("rayweave-allowed-{name}-{}", std::process::id()));
        for folder in ["model/below", "other"] {
            fs::create_dir_all(root.join(folder)).expect("a folder");
        }
        Tree(root)
    }

    fn write(&self, path: &str, contents: &[u8]) {
        fs::write(self.0.join(path), contents).expect("a file");
    }

    fn load(&self, model: &str, allowed: &[&str]) -> Result<(), String> {
        let allow = allowed.iter().map(|path| self.0.join(path)).collect();
        let options = Options { allow, ..Options::default() };
        let imported = load(self.0.join("model").join(model), None, &[], &options);
        imported.map(|imported| assert!(imported.report.is_empty())).map_err(|problems| problems.to_string())
    }
}

impl Drop for Tree {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

const CUBE: &str = "OFF\n8 6 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n\
    4 0 2 3 1\n4 4 5 7 6\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";

const PART: &str = "<gdml><solids><box name=\"c\" x=\"1\" y=\"1\" z=\"1\"/></solids><structure><volume name=\"P\">\
    <solidref ref=\"c\"/></volume></structure><setup name=\"Default\"><world ref=\"P\"/></setup></gdml>";

const OUTER: &str = "<gdml><solids>SOLIDS<box name=\"b\" x=\"9\" y=\"9\" z=\"9\"/></solids><structure>\
    <volume name=\"W\"><solidref ref=\"b\"/>PLACED</volume></structure><setup name=\"Default\"><world ref=\"W\"/></setup></gdml>";

fn npy() -> Vec<u8> {
    let header = format!("{:<117}\n", "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3), }");
    [b"\x93NUMPY\x01\x00v\x00", header.as_bytes(), &[0; 24]].concat()
}

/// Each way in which a model can refer to a file: the name of the model, its text with FILE for the file name, and the
/// extension and the contents of the file.
fn ways() -> Vec<(&'static str, String, &'static str, Vec<u8>)> {
    let gdml = |solids: &str, placed: &str| OUTER.replace("SOLIDS", solids).replace("PLACED", placed);
    let entity = "<!DOCTYPE gdml [<!ENTITY e SYSTEM \"FILE\">]>".to_owned() + &gdml("&e;", "");
    vec![
        (
            "mesh.toml",
            "rayweave = 1\n[solid.m]\nmesh = { file = 'FILE' }\n".to_owned(),
            "off",
            CUBE.as_bytes().to_vec(),
        ),
        (
            "place.toml",
            "rayweave = 1\n[solid.s]\nsphere = { radius = 1 }\n[solid.p]\nplace = { solid = 's', file = 'FILE' }\n"
                .to_owned(),
            "npy",
            npy(),
        ),
        ("entity.gdml", entity, "xml", b"<box name=\"a\" x=\"1\" y=\"1\" z=\"1\"/>".to_vec()),
        ("file.gdml", gdml("", "<physvol><file name=\"FILE\"/></physvol>"), "gdml", PART.as_bytes().to_vec()),
        ("import.csg", "import(file = \"FILE\");".to_owned(), "off", CUBE.as_bytes().to_vec()),
        ("surface.csg", "surface(file = \"FILE\");".to_owned(), "dat", b"1 2\n3 4\n".to_vec()),
        (
            "drawing.csg",
            "linear_extrude(height = 1) import(file = \"FILE\");".to_owned(),
            "svg",
            b"<svg><rect width=\"1\" height=\"1\"/></svg>".to_vec(),
        ),
        (
            "buffer.gltf",
            "{\"asset\": {\"version\": \"2.0\"}, \"buffers\": [{\"uri\": \"FILE\", \"byteLength\": 84}], \"bufferViews\": [\
             {\"buffer\": 0, \"byteOffset\": 0, \"byteLength\": 48}, {\"buffer\": 0, \"byteOffset\": 48, \"byteLength\": 12}], \
             \"accessors\": [{\"bufferView\": 0, \"componentType\": 5126, \"count\": 4, \"type\": \"VEC3\"}, {\"bufferView\": 1, \
             \"componentType\": 5121, \"count\": 12, \"type\": \"SCALAR\"}], \"meshes\": [{\"primitives\": [{\"attributes\": \
             {\"POSITION\": 0}, \"indices\": 1}]}], \"nodes\": [{\"mesh\": 0}], \"scenes\": [{\"nodes\": [0]}]}"
                .to_owned(),
            "bin",
            tetrahedron(),
        ),
    ]
}

/// Corners as f32 and triangles as bytes.
fn tetrahedron() -> Vec<u8> {
    let corners = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
    let triangles = [0u8, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2];
    corners.iter().flat_map(|x| x.to_le_bytes()).chain(triangles).collect()
}

#[test]
fn models_read_files_in_their_folder_below_and_allowed_ones() {
    let tree = Tree::new("every");
    for (model, text, ending, contents) in ways() {
        let part = format!("part.{ending}");
        for folder in ["model", "model/below", "other"] {
            tree.write(&format!("{folder}/{part}"), &contents);
        }
        let load = |name: &str, allowed: &[&str]| {
            tree.write(&format!("model/{model}"), text.replace("FILE", name).as_bytes());
            tree.load(model, allowed)
        };
        for name in [part.clone(), format!("below/{part}"), format!("below/../{part}")] {
            assert_eq!(load(&name, &[]), Ok(()), "{model} {name}");
        }
        let link = tree.0.join("model").join(format!("link.{ending}"));
        let _ = fs::remove_file(&link);
        symlink(tree.0.join("other").join(&part), &link).expect("a link");
        let absolute = tree.0.join("other").join(&part).display().to_string();
        for name in [format!("../other/{part}"), absolute, format!("link.{ending}")] {
            let message = load(&name, &[]).expect_err("it is elsewhere");
            assert!(message.contains("outside the folder of the model"), "{model} {name}: {message}");
            assert!(message.contains("--allow-path") && message.contains("`allow`"), "{model}: {message}");
            assert_eq!(load(&name, &["other"]), Ok(()), "{model} {name}");
            assert_eq!(load(&name, &[&format!("other/{part}")]), Ok(()), "{model} {name}");
        }
        let missing = load(&format!("../other/missing.{ending}"), &[]).expect_err("it is elsewhere");
        assert!(missing.contains("outside the folder of the model"), "{model}: {missing}");
    }
}

/// Opening a FIFO would wait for a writer, and reading a device may never end.
#[test]
fn models_read_regular_files_only() {
    let tree = Tree::new("special");
    for (model, text, ending, _) in ways() {
        let fifo = tree.0.join(format!("model/fifo.{ending}"));
        if !fifo.exists() {
            assert!(Command::new("mkfifo").arg(&fifo).status().expect("mkfifo runs").success());
        }
        let device = tree.0.join(format!("model/device.{ending}"));
        if !device.exists() {
            symlink("/dev/zero", &device).expect("a link");
        }
        for name in ["fifo", "device"] {
            tree.write(
                &format!("model/{model}"),
                text.replace("FILE", &format!("{name}.{ending}")).as_bytes(),
            );
            let allowed: Vec<&Path> = [Path::new("/dev/zero")].into();
            let options = Options {
                allow: allowed.iter().map(|path| path.to_path_buf()).collect(),
                ..Options::default()
            };
            let problems = load(tree.0.join("model").join(model), None, &[], &options).expect_err("no file");
            let message = problems.to_string();
            assert!(message.contains("a pipe or a device, not a regular file"), "{model} {name}: {message}");
        }
    }
}

/// A file in a different format may contain someone's secret.
#[test]
fn messages_do_not_quote_files_in_other_formats() {
    let tree = Tree::new("secret");
    let secret = "hunter2:x:0:0:root\nsecond hunter2\n";
    for (model, text, ending, _) in ways() {
        tree.write(&format!("model/{model}"), text.replace("FILE", &format!("secret.{ending}")).as_bytes());
        tree.write(&format!("model/secret.{ending}"), secret.as_bytes());
        let imported = load(tree.0.join("model").join(model), None, &[], &Options::default());
        let messages = match imported {
            Ok(imported) => imported.scene.warnings.to_string(),
            Err(problems) => problems.to_string(),
        };
        assert!(!messages.is_empty() && !messages.contains("hunter2"), "{model}: {messages}");
    }
    // the outermost element of another XML file
    tree.write("model/secret.gdml", b"<hunter2/>");
    let message = tree.load("file.gdml", &[]).expect_err("it is no GDML");
    assert!(message.contains("it is not GDML") && !message.contains("hunter2"), "{message}");
    for ending in ["obj", "ply", "stl", "3mf", "gltf", "glb"] {
        let text = format!("rayweave = 1\n[solid.m]\nmesh = {{ file = 'secret.{ending}' }}\n");
        tree.write("model/mesh.toml", text.as_bytes());
        for contents in [secret.to_owned(), secret.repeat(10), format!("42 {secret}")] {
            tree.write(&format!("model/secret.{ending}"), contents.as_bytes());
            let message = tree.load("mesh.toml", &[]).expect_err("it is not a mesh");
            assert!(!message.contains("hunter2"), "{ending}: {message}");
        }
    }
}
