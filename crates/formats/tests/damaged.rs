//! Damaged files of every format: they yield a clear error or a scene that compiles, in limited time and without a panic.
//!
//! The seeds are small files in each format, some of them written by this test from one scene. The mutations come from a
//! random generator with a fixed seed.

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_formats::{Format, Imported, Options, WriteError, WriteOptions, load, write};
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Program, Query, RayBatch};
use rayweave_scene::Diagnostics;
use rayweave_shape::Ray;
use rayweave_trace::Weave;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Time limit per file, generous enough for a busy machine.
const LONGEST: Duration = Duration::from_secs(600);

/// A native file that uses most features of the other formats.
const NATIVE: &str = "
rayweave = 1
unit = 'mm'
[parameters]
width = 3
[solid.ball]
sphere = { radius = 2 }
[solid.block]
box = { size = ['2 * width', 4, 5] }
[solid.row]
place = { solid = 'ball', ring = 4, radius = 'width' }
[solid.part]
expr = 'block - row'
[[region]]
solid = 'part'
medium = 'aluminium'
[[region]]
solid = 'ball'
[medium.aluminium]
density = 2.7
";

const CSG: &str = "group() {\n\tmultmatrix([[1, 0, 0, 5], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) {\n\t\tdifference() {\n\
\t\t\tcube(size = [10, 20, 30], center = true);\n\t\t\tcylinder($fn = 0, $fa = 12, $fs = 2, h = 40, r1 = 3, r2 = 5, center = true);\n\t\t}\n\t}\n\
\tlinear_extrude(height = 5, center = false, convexity = 1, twist = 30, slices = 4, scale = [1, 0.5], $fn = 0, $fa = 12, $fs = 2) {\n\
\t\tpolygon(points = [[0, 0], [4, 0], [4, 3], [1, 5]], paths = [[0, 1, 2, 3]], convexity = 1);\n\t}\n\
\thull() {\n\t\tsphere($fn = 0, $fa = 12, $fs = 2, r = 2);\n\t\tpolyhedron(points = [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]], faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], convexity = 1);\n\t}\n\
\trotate_extrude(convexity = 2, $fn = 0, $fa = 12, $fs = 2) {\n\t\toffset(r = 1, $fn = 0, $fa = 12, $fs = 2) {\n\t\t\tsquare(size = [3, 4], center = false);\n\t\t}\n\t}\n}\n";

const SVG: &str = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40mm\" height=\"30mm\" viewBox=\"0 0 40 30\"><g transform=\"rotate(10) scale(2)\">\
<path d=\"M1 1 h8 v6 a2 3 20 0 1 -4 2 q-1 -2 -3 -3 c1 1 2 2 -1 -3 z\"/><circle cx=\"5\" cy=\"5\" r=\"3\"/><use href=\"#r\" x=\"2\"/>\
<rect id=\"r\" x=\"3\" y=\"2\" width=\"7\" height=\"4\" rx=\"1\"/><polyline points=\"1,1 5,3 2,9\" stroke-width=\"0.5\"/></g></svg>";

const DXF: &str = "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\n0\n10\n0\n20\n0\n11\n5\n21\n0\n0\nARC\n8\n0\n10\n5\n20\n2.5\n40\n2.5\n50\n270\n51\n90\n\
0\nLINE\n8\n0\n10\n5\n20\n5\n11\n0\n21\n0\n0\nCIRCLE\n8\n0\n10\n20\n20\n20\n40\n4\n0\nLWPOLYLINE\n8\n0\n90\n3\n70\n1\n10\n30\n20\n0\n42\n0.5\n10\n35\n20\n0\n10\n30\n20\n5\n0\nENDSEC\n0\nEOF\n";

const OBJ: &str =
    "o a\nv 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\nf 1 3 2\nf 1/1 2/1 4/1\nf 2//1 3//1 4//1\nf -4 -1 -2\n";
const OFF: &str = "OFF\n4 4 6\n0 0 0\n4 0 0\n0 4 0\n0 0 4\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";

/// A seed file: name and contents. Drawings come with a dump that imports them.
struct Seed {
    name: String,
    bytes: Vec<u8>,
    dump: Option<&'static str>,
}

fn seed(name: &str, bytes: impl Into<Vec<u8>>) -> Seed {
    Seed { name: name.to_owned(), bytes: bytes.into(), dump: None }
}

fn seeds() -> Vec<Seed> {
    let mut all = vec![
        seed("native.toml", NATIVE),
        seed("dump.csg", CSG),
        seed("solids.gdml", include_str!("gdml/solids.gdml")),
        seed("structure.gdml", include_str!("gdml/structure.gdml")),
        seed("copies.gdml", include_str!("gdml/copies.gdml")),
        seed("a.obj", OBJ),
        seed("a.off", OFF),
    ];
    let drawing = |name: &str, text: &str, dump| Seed { dump: Some(dump), ..seed(name, text) };
    all.push(drawing("a.svg", SVG, "linear_extrude(height = 2) import(file = \"a.svg\");"));
    all.push(drawing("a.dxf", DXF, "linear_extrude(height = 2) import(file = \"a.dxf\");"));
    let (_, scene) = rayweave_scene::parse(NATIVE).unwrap();
    for name in Format::NAMES {
        for text in [false, true] {
            let options = WriteOptions { tolerance: Some(0.5), text, ..WriteOptions::default() };
            let format = Format::from_name(name).unwrap();
            let written = match write(&scene, None, format, &options) {
                Err(WriteError::NotWritten(_)) => continue,
                written => written.unwrap(),
            };
            all.push(seed(&format!("written-{text}.{}", format.extensions()[0]), written.bytes));
        }
    }
    all
}

/// Numbers that are too large, too small, invalid, or would exhaust memory.
const NUMBERS: [&str; 16] = [
    "1e400",
    "-1e400",
    "nan",
    "inf",
    "-0",
    "0",
    "1e308",
    "-1e308",
    "1e-320",
    "1e-9",
    "4294967296",
    "99999999999",
    "-1",
    "0.5",
    "1e6",
    "",
];

/// A random mutation of a file.
fn changed(bytes: &[u8], rng: &mut ChaCha8Rng) -> Vec<u8> {
    let at = rng.random_range(0..bytes.len().max(1));
    let mut all = bytes.to_vec();
    match rng.random_range(0..8) {
        0 => all.truncate(at),
        1 => all[at] ^= 1 << rng.random_range(0..8),
        2 => all[at] = b"<>&\"'=[]{}(),;/\0\xff 0"[rng.random_range(0..19)],
        3 => drop(all.drain(piece(bytes, at))),
        4 => drop(all.splice(at..at, bytes[piece(bytes, at)].to_vec())),
        5 => {
            let other = piece(bytes, rng.random_range(0..bytes.len()));
            drop(all.splice(piece(bytes, at), bytes[other].to_vec()));
        }
        _ => {
            let number = NUMBERS[rng.random_range(0..NUMBERS.len())];
            drop(all.splice(digits(bytes, at), number.bytes()));
        }
    }
    all
}

/// A tag, a line or a word around an offset.
fn piece(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let is_end = |byte: &u8| b"\n>;,".contains(byte);
    let start = bytes[..at].iter().rposition(is_end).map_or(0, |found| found + 1);
    let end = bytes[at..].iter().position(is_end).map_or(bytes.len(), |found| at + found + 1);
    start..end.min(start + 200).max(at.min(start + 200))
}

/// The next number after an offset.
fn digits(bytes: &[u8], at: usize) -> std::ops::Range<usize> {
    let is_digit = |byte: &u8| byte.is_ascii_digit() || b".-+eE".contains(byte);
    let start = bytes[at..].iter().position(u8::is_ascii_digit).map_or(at, |found| at + found);
    let end =
        bytes[start..].iter().position(|byte| !is_digit(byte)).map_or(bytes.len(), |found| start + found);
    start..end
}

/// Reads a file, and traces a ray through the model.
fn examine(path: &Path) {
    let start = Instant::now();
    match load(path, None, &[], &Options::default()) {
        Err(problems) => is_clear(&problems),
        Ok(imported) => {
            if let Ok(program) = Program::compile_regions(&imported.scene.model_regions()) {
                let ray = Ray { origin: Vec3::new(-50.0, 0.3, 0.2), direction: Vec3::new(1.0, 0.01, 0.02) };
                let weave = Weave::new(Arc::new(program));
                let answer = weave.collect(RayBatch::from_iter([ray]).rays(), &Query::default()).unwrap();
                assert!(answer.crossings.iter().all(|crossing| !crossing.t.is_nan()));
            }
        }
    }
    assert!(start.elapsed() < LONGEST, "{:?}", start.elapsed());
}

/// Asserts that the messages are not empty and of limited length.
fn is_clear(problems: &Diagnostics) {
    assert!(problems.iter().count() > 0);
    assert!(problems.iter().all(|problem| !problem.message().is_empty()));
    assert!(problems.to_string().len() < 1_000_000);
}

fn damage(seed: &Seed, folder: &Path, count: u64) {
    let mut rng = ChaCha8Rng::seed_from_u64(7);
    for k in 0..count {
        let mut bytes = seed.bytes.clone();
        for _ in 0..=k % 3 {
            if !bytes.is_empty() {
                bytes = changed(&bytes, &mut rng);
            }
        }
        let path = folder.join(&seed.name);
        fs::write(&path, &bytes).unwrap();
        eprintln!("{} {k}", seed.name);
        match seed.dump {
            Some(dump) => {
                let main = folder.join("main.csg");
                fs::write(&main, dump).unwrap();
                examine(&main);
            }
            None => examine(&path),
        }
    }
}

/// A temporary folder.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn damaged_files_do_no_harm() {
    let folder = folder("damaged");
    for seed in seeds() {
        damage(&seed, &folder, 50);
    }
}

/// Reads a seed with other contents.
fn read(seed: &Seed, bytes: &[u8], folder: &Path) -> Result<Imported, Diagnostics> {
    let path = folder.join(&seed.name);
    fs::write(&path, bytes).unwrap();
    let main = match seed.dump {
        Some(dump) => {
            let main = folder.join("main.csg");
            fs::write(&main, dump).unwrap();
            main
        }
        None => path,
    };
    load(&main, None, &[], &Options::default())
}

/// Line ends and a byte order mark do not change a model. Text in another encoding, an empty file, and a file of a format with an
/// end that lacks it, are never read without a message.
#[test]
fn encodings_and_ends_of_files() {
    let folder = folder("encodings");
    for seed in seeds() {
        let expected = read(&seed, &seed.bytes, &folder).unwrap();
        let name = &seed.name;
        let is_same =
            |bytes: &[u8]| read(&seed, bytes, &folder).is_ok_and(|read| read.scene == expected.scene);
        let is_noticed = |bytes: &[u8]| {
            let read = read(&seed, bytes, &folder);
            read.is_err() || read.is_ok_and(|read| !read.scene.warnings.is_empty())
        };
        assert!(is_noticed(b""), "{name}: empty");
        if let Ok(text) = str::from_utf8(&seed.bytes).map(|text| text.replace("\r\n", "\n")) {
            let mark = "\u{feff}";
            assert!(is_same(text.replace('\n', "\r\n").as_bytes()), "{name}: CRLF");
            assert!(is_same(format!("{mark}{text}").as_bytes()), "{name}: byte order mark");
            for swapped in [u16::to_le_bytes, u16::to_be_bytes] {
                let units = |text: &str| text.encode_utf16().flat_map(swapped).collect::<Vec<u8>>();
                assert!(is_noticed(&units(&text)), "{name}: UTF-16");
                assert!(is_noticed(&units(&format!("{mark}{text}"))), "{name}: UTF-16 with a mark");
            }
        }
        // a shorter file of another format may be valid
        let has_end = !["toml", "csg", "obj"].iter().any(|ending| name.ends_with(ending));
        for part in (1..16).filter(|_| has_end) {
            let cut = &seed.bytes[..seed.bytes.len() * part / 16];
            assert!(is_noticed(cut), "{name}: {part} of 16 parts");
        }
    }
}

/// More mutations, including those of real files if they are present.
#[test]
#[ignore = "long"]
fn long_damaged_files_do_no_harm() {
    let folder = folder("long-damaged");
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    for kind in ["gdml", "openscad"] {
        let Ok(entries) = fs::read_dir(shared.join(kind)) else { continue };
        for path in
            entries.flatten().map(|entry| entry.path()).filter(|path| Format::from_path(path).is_some())
        {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let bytes = fs::read(&path).unwrap();
            if bytes.len() < 200_000 {
                damage(&seed(&name, bytes), &folder, 100);
            }
        }
    }
    for seed in seeds() {
        damage(&seed, &folder, 1500);
    }
}
