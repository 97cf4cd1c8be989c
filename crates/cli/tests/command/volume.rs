//! `rayweave volume`.

use crate::bench::Bench;
use serde_json::Value;
use std::f64::consts::PI;

/// A block of glass with a bubble, in centimetres; an unbounded rod.
const BLOCK: &str = r#"
rayweave = 1
unit = "cm"

[solid.block]
box = { size = [2, 3, 4] }

[solid.bubble]
sphere = { radius = 1 }

[solid.rod]
cylinder = { radius = 1 }

[[region]]
solid = "block"
medium = "glass"

[[region]]
solid = "bubble"
medium = "air"

[medium.glass]
density = 2.5

[medium.air]
"#;

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("block.toml", BLOCK);
    bench
}

fn estimate(value: &Value) -> (f64, f64) {
    let number = |key: &str| value[key].as_f64().unwrap();
    (number("value"), number("half_width"))
}

fn holds(value: &Value, expected: f64) -> bool {
    let (value, half_width) = estimate(value);
    (value - expected).abs() <= half_width + 1e-9 * expected.abs()
}

#[test]
fn a_block_with_a_bubble() {
    let bench = bench();
    let json = bench.json(&["volume", "block.toml", "--json"]);
    let (block, bubble) = (&json["regions"][0], &json["regions"][1]);
    let ball = 4.0 / 3.0 * PI;
    assert!(holds(&block["volume"], 24.0 - ball) && holds(&bubble["volume"], ball), "{json}");
    assert!(holds(&block["mass_g"], 2.5 * (24.0 - ball)) && bubble["mass_g"].is_null(), "{json}");
    assert!(holds(&block["area"], 52.0 + 4.0 * PI) && holds(&bubble["area"], 4.0 * PI), "{json}");
    // the inertia of the block about z, minus that of the ball
    let about_z = 24.0 * (4.0 + 9.0) / 12.0 - 0.4 * ball;
    assert!(holds(&block["inertia"][2][2], about_z), "{json}");
    let (value, half_width) = estimate(&block["volume"]);
    assert!(half_width <= 1e-3 * value, "{json}");
}

#[test]
fn text_for_people() {
    let said = bench().says(&["volume", "block.toml", "--solid", "bubble", "--precision", "1e-2"]);
    let mut lines = said.lines();
    assert!(lines.next().unwrap().starts_with("block.toml: 99 % confidence intervals from "), "{said}");
    let row = lines.nth(2).unwrap();
    // the value from the formula is printed next to the measurement
    assert!(row.starts_with("bubble  air") && row.contains("4.188790205"), "{said}");
}

#[test]
fn within_a_box_a_rod_has_an_end() {
    let bench = bench();
    let failed = bench.fails(3, &["volume", "block.toml", "--solid", "rod"]);
    assert!(
        failed.contains("unbounded in z")
            && failed.contains("Intersect it with a box, or measure the part within one: --within LO HI, in Python within=(lo, hi)."),
        "{failed}"
    );
    let within = ["--within", "-2,-2,0", "2,2,5", "--json"];
    let json = bench.json(&[&["volume", "block.toml", "--solid", "rod"], &within[..]].concat());
    assert!(holds(&json["regions"][0]["volume"], 5.0 * PI), "{json}");
}

#[test]
fn refusals() {
    let bench = bench();
    let failed = bench.fails(2, &["volume", "block.toml", "--precision", "0"]);
    assert!(failed.contains("the precision is 0"), "{failed}");
    let failed = bench.fails(2, &["volume", "block.toml", "--precision", "-1"]);
    assert!(failed.contains("the precision is -1: it must be greater than 0"), "{failed}");
    let failed = bench.fails(2, &["volume", "block.toml", "--confidence", "1"]);
    assert!(failed.contains("the confidence is 1"), "{failed}");
    let failed = bench.fails(2, &["volume", "block.toml", "--solid", "bubbel"]);
    assert!(failed.contains("Did you mean `bubble`?"), "{failed}");
    let failed = bench.fails(2, &["volume", "block.toml", "--within", "1,1,1", "0,0,0"]);
    assert!(failed.contains("Are its corners swapped?"), "{failed}");
    bench.fails(3, &["volume", "none.toml"]);
    bench.write("part.scad", "cube(1);");
    let failed = bench.fails(3, &["volume", "part.scad"]);
    assert!(failed.contains("Create one with `openscad -o model.csg model.scad`"), "{failed}");
    // more threads than cores do no harm
    bench.says(&["volume", "block.toml", "--precision", "0.1", "--threads", "1000000"]);
}
