//! `rayweave infill`.

use crate::bench::{Bench, number, rows};

const HEADER: &str = "layer,z,scanline,component,x0,y0,x1,y1";

/// A plate with a square window and an island in it; an unbounded bar; an empty solid; two towers.
const SHOP: &str = r#"
rayweave = 1
unit = "mm"

[solid.plate]
box_from_corners = { lo = [0, 0, 0], hi = [10, 8, 2] }

[solid.bar]
cylinder = { radius = 1 }

[solid.wall]
slab = { normal = [1, 0, 0], lo = 0, hi = 1 }

[solid.none]
expr = "plate & far"

[solid.far]
box_from_corners = { lo = [50, 0, 0], hi = [51, 1, 1] }

[solid.towers]
expr = "plate - gap"

[solid.gap]
box_from_corners = { lo = [3, -1, 1], hi = [6, 9, 3] }

[[region]]
solid = "plate"
"#;

const REGION: &str = "contour,x,y\nplate,0,0\nplate,6,0\nplate,6,4\nplate,0,4\n\
                      hole,1,1\nhole,1,3\nhole,3,3\nhole,3,1\npoint,9,9\n";

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("shop.toml", SHOP);
    bench.write("region.csv", REGION);
    bench
}

#[test]
fn a_plate_by_closed_forms() {
    let bench = bench();
    let said = bench.says(&["infill", "shop.toml", "--spacing", "2", "--layer-height", "1", "-o", "t.csv"]);
    assert_eq!(said, "t.csv: 8 traces in 2 layers, 80 mm in total\n");
    let table = bench.read("t.csv");
    assert_eq!(table.lines().next(), Some(HEADER));
    let expected: Vec<Vec<String>> = (0..8)
        .map(|k| {
            let (layer, line) = (k / 4, k % 4);
            let y = format!("{}.0", 2 * line);
            let z = format!("{}.5", layer);
            [&layer.to_string(), &z, &line.to_string(), "0", "0.0", &y, "10.0", &y].map(str::to_owned).into()
        })
        .collect();
    assert_eq!(rows(&table), expected);
}

#[test]
fn angles_turns_phases_and_alternating_lines() {
    let bench = bench();
    let table = |options: &[&str]| {
        let arguments = ["infill", "shop.toml", "--spacing", "2", "-o", "-"];
        bench.says(&[&arguments, options].concat())
    };
    let found = table(&["--z", "0.5,1.5", "--turn", "90", "--phase", "0.5", "--alternate"]);
    let ends: Vec<[f64; 5]> =
        rows(&found).iter().map(|row| [2, 4, 5, 6, 7].map(|k| number(row[k]))).collect();
    assert_eq!(ends[..2], [[0.0, 0.0, 1.0, 10.0, 1.0], [1.0, 10.0, 3.0, 0.0, 3.0]]);
    // scan line k of the second layer is at x = -2 (k + 1/2)
    assert_eq!(ends[4..6], [[-5.0, 9.0, 8.0, 9.0, 0.0], [-4.0, 7.0, 0.0, 7.0, 8.0]]);
    assert_eq!(ends.len(), 4 + 5);
    assert_eq!(table(&["--z", "1", "--angle", "-30"]), table(&["--z", "1", "--angle", "330"]));
    let components = table(&["--z", "0.5", "--z", "1.5", "--solid", "towers"]);
    let layers: Vec<[&str; 2]> = rows(&components).iter().map(|row| [row[0], row[3]]).collect();
    assert_eq!(layers[..4], [["0", "0"]; 4]);
    assert_eq!(layers[4..], [["1", "0"], ["1", "1"]].repeat(4));
}

#[test]
fn a_region_of_the_plane() {
    let bench = bench();
    let arguments = ["infill", "region.csv", "--spacing", "1", "--phase", "0.5", "-o", "t.csv"];
    let said = bench.says(&[&arguments[..], &["--svg", "t.svg"]].concat());
    // four lines of length 6, two of which skip the hole, 2 wide: 24 - 4 is the area
    assert_eq!(said, "t.csv: 6 traces in 1 layer, 20 in total\n");
    let table = bench.read("t.csv");
    let lines: Vec<Vec<&str>> = rows(&table);
    assert_eq!(lines[1], ["0", "0.0", "1", "0", "0.0", "1.5", "1.0", "1.5"]);
    assert_eq!(lines[2], ["0", "0.0", "1", "0", "3.0", "1.5", "6.0", "1.5"]);
    let svg = bench.read("t.svg");
    assert!(svg.starts_with("<svg xmlns=") && svg.ends_with("</svg>\n"), "{svg}");
    // the drawing is in units of the document, y up
    assert!(svg.contains("viewBox=\"-1 -5 8 6\"") && svg.contains("scale(1 -1)"), "{svg}");
    assert!(svg.contains("M0 1.5L1 1.5M3 1.5L6 1.5") && svg.contains("M1 1L1 3L3 3L3 1Z"), "{svg}");
    assert_eq!(svg.matches('<').count(), svg.matches('>').count());
}

#[test]
fn pictures_of_layers_and_totals_alone() {
    let bench = bench();
    let fill = |options: &[&str]| {
        bench.says(&[&["infill", "shop.toml", "--spacing", "1", "--solid", "towers"], options].concat())
    };
    assert_eq!(
        fill(&["--layer-height", "0.5", "--svg", "t.svg"]),
        "t.svg: 48 traces in 4 layers, 272 mm in total\n"
    );
    let svg = bench.read("t.svg");
    for part in ["0: z = 0.25", "3: z = 1.75", "<title>shop.toml, towers: traces 1 apart</title>"] {
        assert!(svg.contains(part), "{part}: {svg}");
    }
    // layers 0 and 1 in one colour, 2 and 3 in two
    assert_eq!((svg.matches("#0072b2").count(), svg.matches("#d55e00").count()), (4, 2));
    assert_eq!(fill(&["--z", "0.5"]), "shop.toml: 8 traces in 1 layer, 80 mm in total\n");
    assert_eq!(fill(&["--z", "0.5", "--quiet"]), "");
    assert!(fill(&["--z", "0.5", "--svg", "-"]).starts_with("<svg "));
}

#[test]
fn any_threads_and_any_evaluator_write_the_same_bytes() {
    let bench = bench();
    let with = |out: &str, options: &[&str]| {
        let arguments = ["infill", "cemented.toml", "--spacing", "0.01", "--layer-height", "5", "-o", out];
        bench.says(&[&arguments, options].concat());
        bench.bytes(out)
    };
    let one = with("one.npy", &["--threads", "1"]);
    assert!(one.starts_with(b"\x93NUMPY") && one.len() > 64 * 4000);
    assert_eq!(one, with("three.npy", &["--threads", "3"]));
    assert_eq!(one, with("reference.npy", &["--evaluator", "reference"]));
    assert_eq!(one, with("single_hit.npy", &["--evaluator", "single_hit"]));
}

#[test]
fn heights_beyond_the_solid_are_reported() {
    let bench = bench();
    let said = bench.says(&["infill", "shop.toml", "--spacing", "1", "--z", "1,9,-3", "-o", "t.csv"]);
    assert_eq!(
        said,
        "t.csv: 8 traces in 3 layers, 80 mm in total\n\
         layer 1 at z = 9 (and 1 more) has no traces: the filled solid lies between z = 0 and 2\n"
    );
    assert_eq!(rows(&bench.read("t.csv")).len(), 8);
    let said = bench.says(&["infill", "shop.toml", "--spacing", "100", "--phase", "0.5", "--z", "1"]);
    assert!(
        said.ends_with("layer 0 at z = 1 has no traces: no scan line crosses the solid there\n"),
        "{said}"
    );
}

#[test]
fn settings_that_make_no_sense() {
    let bench = bench();
    let fails = |code, options: &[&str]| {
        let message = bench.fails(code, &[&["infill", "shop.toml", "-o", "t.csv"], options].concat());
        assert!(!bench.path("t.csv").exists());
        message
    };
    for bad in ["0", "-1", "nan", "inf"] {
        let message = fails(2, &["--spacing", bad, "--z", "1"]);
        assert!(message.starts_with("error: the spacing is "), "{message}");
        let message = fails(2, &["--spacing", "1", "--layer-height", bad]);
        assert!(message.starts_with("error: the layer height is "), "{message}");
    }
    assert!(fails(2, &["--spacing", "1e-9", "--z", "1"]).contains("8e9 scan lines: at most 10000000"));
    assert!(fails(2, &["--spacing", "1", "--layer-height", "1e-9"]).contains("2e9 layers: at most 1000000"));
    assert!(fails(2, &["--spacing", "1", "--z", "1", "--phase", "2"]).contains("from 0 to 1"));
    assert!(fails(2, &["--spacing", "1", "--z", "1", "--angle", "inf"]).contains("the angle is inf"));
    assert!(fails(2, &["--spacing", "1", "--z", "1", "--turn", "nan"]).contains("the turn is NaN"));
    assert!(fails(2, &["--spacing", "1", "--z", "1,nan"]).contains("height 1 of the layers is NaN"));
    assert!(fails(2, &["--spacing", "wide", "--z", "1"]).contains("`wide` is not a number"));
    assert!(fails(2, &["--z", "1"]).contains("--spacing"));
    assert!(fails(2, &["--spacing", "1"]).contains("Give --layer-height or --z."));
    assert!(fails(2, &["--spacing", "1", "--z", "1", "--layer-height", "1"]).contains("cannot be used with"));
}

#[test]
fn solids_that_cannot_be_filled() {
    let bench = bench();
    let fails = |code, solid: &str, layers: &[&str]| {
        let arguments = ["infill", "shop.toml", "--spacing", "1", "-o", "t.csv", "--solid", solid];
        let message = bench.fails(code, &[&arguments, layers].concat());
        assert!(!bench.path("t.csv").exists());
        message
    };
    let z = ["--z", "0.5"];
    assert_eq!(
        fails(3, "wall", &z),
        "error: wall is unbounded in y: scan lines would never end. Intersect it with a box.\n"
    );
    assert!(fails(3, "bar", &["--layer-height", "1"]).contains("bar is unbounded in z"));
    assert!(fails(3, "none", &z).contains("none is empty: there is nothing to fill"));
    assert!(fails(2, "plat", &z).contains("Did you mean `plate`?"));
    assert!(
        bench
            .fails(3, &["infill", "no.toml", "--spacing", "1", "--z", "1"])
            .contains("there is no such file")
    );
    let bar = ["infill", "shop.toml", "--solid", "bar", "--spacing", "1", "--phase", "0.5", "--z", "1e3"];
    assert!(bench.says(&bar).contains(": 2 traces"));
}

#[test]
fn regions_that_cannot_be_filled() {
    let bench = bench();
    let fails = |code, text: &str, options: &[&str]| {
        bench.write("bad.csv", text);
        let message =
            bench.fails(code, &[&["infill", "bad.csv", "--spacing", "1", "-o", "t.csv"], options].concat());
        assert!(!bench.path("t.csv").exists());
        message
    };
    let message = fails(3, "contour,x,y\na,0,0\na,1,nan\na,1,b\n", &[]);
    assert_eq!(
        message,
        "error: bad.csv:3: y is NaN: coordinates must be finite.\nbad.csv:4: y is `b`: it must be a number.\n"
    );
    let crossing = "contour,x,y\na,0,0\na,4,0\na,0,4\na,4,4\n";
    let message = fails(3, crossing, &[]);
    assert!(
        message.starts_with("error: bad.csv:3: contour 0, edge from vertex 1 to vertex 2 crosses"),
        "{message}"
    );
    let backwards = "contour,x,y\na,0,0\na,0,4\na,4,0\n";
    assert!(fails(3, backwards, &[]).contains("bad.csv:2: contour 0 is clockwise"));
    assert!(fails(3, "contour,x,y\na,0,0\na,1,0\n", &[]).contains("the region is empty"));
    assert!(fails(3, "", &[]).contains("the file is empty"));
    assert!(bench.fails(3, &["infill", "no.csv", "--spacing", "1"]).contains("cannot read no.csv"));
    for (option, value) in
        [("--z", "1"), ("--layer-height", "1"), ("--solid", "a"), ("--evaluator", "weave"), ("-D", "a=1")]
    {
        let message = fails(2, REGION, &[option, value]);
        assert!(
            message.contains("does not apply to bad.csv: a region of the plane is one layer"),
            "{message}"
        );
    }
}

#[test]
fn tables_and_pictures_that_cannot_be_written() {
    let bench = bench();
    let fails = |code, options: &[&str]| {
        bench.fails(code, &[&["infill", "region.csv", "--spacing", "1"], options].concat())
    };
    assert!(fails(2, &["-o", "t.txt"]).contains("the table format is unknown"));
    assert!(fails(1, &["-o", "nowhere/t.csv"]).contains("the folder nowhere does not exist"));
    assert!(fails(1, &["--svg", "nowhere/t.svg"]).contains("the folder nowhere does not exist"));
}

#[test]
fn the_plate_of_the_models() {
    let bench = bench();
    bench.write("plate.csv", include_str!("../../../../models/plate.csv"));
    let table = bench.says(&["infill", "plate.csv", "--spacing", "0.01", "--angle", "20", "-o", "-"]);
    let found = rows(&table);
    let length = |row: &Vec<&str>| {
        let [x0, y0, x1, y1] = [4, 5, 6, 7].map(|k| number(row[k]));
        (x1 - x0).hypot(y1 - y0)
    };
    // plate, window, isle, slot, star, by the shoelace formula
    let area = 2400.0 - 400.0 + 100.0 - 200.0 + 195.0;
    let covered = 0.01 * found.iter().map(length).sum::<f64>();
    // error bound: the spacing times the total variation of the chord lengths of five contours, each at most 75, up and down twice
    assert!((covered - area).abs() < 0.01 * 5.0 * 4.0 * 75.0, "{covered} {area}");
    // the tips of the star are nearly parallel to the scan lines, so their ends may be separate components
    let mut areas = [0.0; 8];
    found.iter().for_each(|row| areas[row[3].parse::<usize>().unwrap()] += 0.01 * length(row));
    assert_eq!(areas.iter().filter(|&&area| area > 1.0).count(), 3, "{areas:?}");
}
