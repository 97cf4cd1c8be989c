//! `rayweave thickness`.

use crate::bench::{Bench, number, rows};

/// A ball of steel of radius 2 in a box of water, seen from the front.
const TANK: &str = r#"
rayweave = 1
unit = "cm"

[solid.tank]
box = { size = [6, 6, 6] }

[solid.ball]
sphere = { radius = 2 }

[[region]]
solid = "tank"
medium = "water"

[[region]]
solid = "ball"
medium = "steel"

[medium.water]
[medium.steel]
"#;

const VIEW: [&str; 4] = ["--view", "front", "--size", "41x41"];

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("tank.toml", TANK);
    bench
}

#[test]
fn path_lengths_as_a_table() {
    let bench = bench();
    let said = bench.says(&[&["thickness", "tank.toml", "-o", "t.csv"], &VIEW[..]].concat());
    assert!(
        said.starts_with(
            "t.csv: path lengths of 1681 rays along (0, 1, 0): the ray of column x and row y starts at ("
        ),
        "{said}"
    );
    let table = bench.read("t.csv");
    assert_eq!(table.lines().next(), Some("x,y,world,water,steel"));
    let rows = rows(&table);
    let middle = &rows[20 * 41 + 20];
    let lengths: Vec<f64> = middle[2..].iter().map(|field| number(field)).collect();
    // through the middle: 6 cm, of which 4 cm are steel
    assert!(
        lengths[0] == 0.0 && (lengths[1] - 2.0).abs() < 1e-12 && (lengths[2] - 4.0).abs() < 1e-12,
        "{middle:?}"
    );
    assert!(rows[0][2..].iter().all(|field| number(field) == 0.0), "{:?}", rows[0]);
}

#[test]
fn line_integrals_and_remarks_about_media() {
    let bench = bench();
    bench.write("mu.toml", TANK.replace("[medium.steel]", "[medium.steel]\nattenuation = 2.5"));
    let arguments = [&["thickness", "mu.toml", "-o", "t.png", "--line-integral"], &VIEW[..]].concat();
    let done = bench.run(&arguments);
    // 4 cm of steel
    assert_eq!((done.code, done.out.as_str()), (0, "t.png: white is a line integral of 10\n"));
    assert!(
        done.err.contains("medium 'water' has no attenuation beside media that have one"),
        "{}",
        done.err
    );
    bench.write("bad.toml", TANK.replace("[medium.steel]", "[medium.steel]\nattenuation = -1"));
    for quiet in ["--quiet", "--line-integral"] {
        let problem = bench.fails(2, &["thickness", "bad.toml", "-o", "bad.png", quiet]);
        assert!(problem.contains("the attenuation of the medium 'steel' is -1"), "{problem}");
    }
    let problem = bench.fails(2, &["thickness", "tank.toml", "-o", "t.csv", "--line-integral"]);
    assert!(problem.contains("--line-integral selects what a picture shows"), "{problem}");
}

#[test]
fn pictures() {
    let bench = bench();
    let said = bench.says(&[&["thickness", "tank.toml", "-o", "t.png"], &VIEW[..]].concat());
    assert!(said.starts_with("t.png: white is full transmission, the darkest pixel 5 %"), "{said}");
    assert!(
        said.ends_with("no medium has an attenuation, so it is taken as equal in all media.\n"),
        "{said}"
    );
    let said =
        bench.says(&[&["thickness", "tank.toml", "-o", "s.png", "--medium", "steel"], &VIEW[..]].concat());
    assert_eq!(said, "s.png: white is 4 cm of steel\n");
    let media = "[medium.water]\nattenuation = 0\n[medium.steel]\nattenuation = 0.3";
    bench.write("dense.toml", TANK.replace("[medium.water]\n[medium.steel]", media));
    let said = bench.says(&[&["thickness", "dense.toml", "-o", "d.png"], &VIEW[..]].concat());
    assert_eq!(said, "d.png: white is full transmission\n");
    // 4 of steel: exp(-8)
    bench.write("black.toml", bench.read("dense.toml").replace("0.3", "2"));
    let said = bench.says(&[&["thickness", "black.toml", "-o", "b.png"], &VIEW[..]].concat());
    assert!(
        said.contains("the darkest pixel transmits 0.000335") && said.contains("--line-integral"),
        "{said}"
    );
    assert!(bench.bytes("d.png").starts_with(b"\x89PNG") && bench.bytes("d.png") != bench.bytes("t.png"));
}

#[test]
fn refusals() {
    let bench = bench();
    let failed = bench.fails(2, &["thickness", "tank.toml", "-o", "t.png", "--medium", "steal"]);
    assert!(failed.contains("Did you mean `steel`?"), "{failed}");
    let failed = bench.fails(2, &["thickness", "tank.toml", "-o", "t.csv", "--medium", "steel"]);
    assert!(failed.contains("Write a .png file."), "{failed}");
    bench.fails(2, &["thickness", "tank.toml", "-o", "t.jpg"]);
    assert!(!bench.files().iter().any(|name| name.starts_with("t.")), "{:?}", bench.files());
}
