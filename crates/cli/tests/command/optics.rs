//! `optics`: light through the solids of a model.

use crate::bench::{Bench, number, rows};

const HEADER: &str = "id,parent,generation,source,wavelength_nm,intensity,index,x0,y0,z0,x1,y1,z1,x_tilt,y_tilt,z_tilt,path,\
                      element,surface,event";

/// A plate of glass about the origin, between the light and an ideal lens that is focused on the screen.
pub const PLATE: &str = r#"
rayweave = 1
unit = "mm"

[parameters]
n = 1.5

[solid.plate]
box = { size = [60, 60, 2] }

[medium.plate]
index = "n"

[optics]
branches = "ideal"

[[optics.sheet]]
name = "lens"
circle = 30
action = { thin_lens = 40 }
transform = [{ translate = [0, 0, 5] }]

[[optics.sheet]]
name = "screen"
rectangle = [30, 30]
action = "absorb"
transform = [{ rotate_z = 90 }, { translate = [3, 4, 45] }]

[[optics.source]]
beam = { circle = 20, rays = 5000 }
wavelength_nm = 550
power = 2
transform = [{ translate = [0, 0, -10] }]
"#;

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("plate.toml", PLATE);
    bench
}

#[test]
fn a_summary_for_people() {
    let said = bench().says(&["optics", "plate.toml", "--seed", "7"]);
    let lines: Vec<&str> = said.lines().collect();
    // through two faces of the plate and the lens to the screen
    assert_eq!(lines[0], "plate.toml: 5000 rays, 20000 segments");
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
    let found = |begin: &str| words(lines.iter().find(|line| line.starts_with(begin)).unwrap());
    assert_eq!(found("emitted"), ["emitted", "2"]);
    assert_eq!(found("absorbed by screen").last().unwrap(), "2");
    assert_eq!(found("absorbed by plate").last().unwrap(), "0");
    assert!(number(found("unaccounted for").last().unwrap()).abs() < 1e-12);
    assert!(said.contains("centroid / mm") && said.contains("RMS radius / mm"), "{said}");
}

/// The focus in the coordinates of the rotated screen; and a disc, whose RMS radius is
/// R / sqrt(2).
#[test]
fn spots_by_closed_forms() {
    let found = bench().json(&["optics", "plate.toml", "--json"]);
    let sheet = |k: usize| &found["sheets"][k];
    assert_eq!(
        (&found["unit"], &found["rays"], &sheet(1)["hits"]),
        (&"mm".into(), &5000.into(), &5000.into())
    );
    let close = |value: &serde_json::Value, expected: f64, error: f64| {
        assert!((value.as_f64().unwrap() - expected).abs() < error, "{value} is not {expected}");
    };
    // x of the screen is y of the world, y is -x
    close(&sheet(1)["centroid"][0], -4.0, 1e-12);
    close(&sheet(1)["centroid"][1], 3.0, 1e-12);
    close(&sheet(1)["rms_radius"], 0.0, 1e-12);
    close(&sheet(1)["power"], 2.0, 1e-12);
    close(&sheet(0)["rms_radius"], 10.0 / 2.0_f64.sqrt(), 1e-2);
    close(&found["error"], 0.0, 1e-12);
}

/// A layout, a spot diagram and an irradiance map, as SVG and as PNG.
#[test]
fn drawings() {
    let bench = bench();
    for end in ["svg", "png"] {
        let names = ["layout", "spot", "map"].map(|name| format!("--{name}={name}.{end}"));
        let [layout, spot, map] = names.each_ref().map(String::as_str);
        assert_eq!(bench.says(&["optics", "plate.toml", "--quiet", layout, spot, map]), "");
    }
    let layout = bench.read("layout.svg");
    let count = |class: &str| layout.matches(&format!(r#"class="{class}""#)).count();
    // the plate and the two sheets; all rays have one colour and their full power
    assert_eq!(["glass", "outline", "sheet", "ray"].map(count), [1, 1, 2, 1]);
    assert!(layout.contains(">550 nm<") && layout.contains(">20 mm<"), "{layout}");
    let spot = bench.read("spot.svg");
    assert!(spot.contains("Spot diagram: screen"), "{spot}");
    assert!(spot.contains("5000 rays, centroid (\u{2212}4, 3) mm"), "{spot}");
    assert!(bench.read("map.svg").contains("power / mm\u{b2}"));
    for name in ["layout", "spot", "map"] {
        let bytes = std::fs::read(bench.path(&format!("{name}.png"))).unwrap();
        assert!(bytes.starts_with(b"\x89PNG\r\n"), "{name}");
    }
}

#[test]
fn drawings_of_what_is_requested() {
    let bench = bench();
    bench.says(&["optics", "plate.toml", "--map", "map.svg", "--detector", "lens", "--bins", "10", "-q"]);
    let map = bench.read("map.svg");
    assert!(map.contains("Irradiance: lens") && map.contains("power 2 on"), "{map}");
    let drawn = |plane: &str| bench.says(&["optics", "plate.toml", "-q", "--layout", "-", "--plane", plane]);
    assert!(drawn("x=3").contains("section x = 3") && drawn("zx").contains("section y = 0"));
    assert!(bench.fails(2, &["optics", "plate.toml", "--layout", "a.gif"]).contains(".png or .jpg"));
    let unknown = bench.fails(2, &["optics", "plate.toml", "--spot", "a.svg", "--detector", "scren"]);
    assert!(
        unknown.contains("no sheet is called `scren`: the names are lens, screen. Did you mean `screen`?"),
        "{unknown}"
    );
    assert!(bench.fails(2, &["optics", "plate.toml", "--layout", "a.svg", "--plane", "q"]).contains("x=2.5"));
    let sheets = PLATE.find("[[optics.sheet]]").unwrap()..PLATE.find("[[optics.source]]").unwrap();
    let bare = PLATE.replace(&PLATE[sheets], "");
    bench.write("bare.toml", &bare);
    assert!(bench.fails(2, &["optics", "bare.toml", "--spot", "a.svg"]).contains("no [[optics.sheet]]"));
    assert!(!bench.path("a.svg").exists());
}

/// The paths through a plate whose faces reflect the fraction r: the straight one, and those with
/// pairs of reflections inside.
#[test]
fn ghosts() {
    let bench = bench();
    bench.says(&["optics", "plate.toml", "--branches", "both", "--paths", "paths.csv", "--quiet"]);
    let table = bench.read("paths.csv");
    assert_eq!(table.lines().next(), Some("path,reflections,end,rays,power,part,reflected_at"));
    let rows = rows(&table);
    let r: f64 = 0.04;
    let through = |reflections: i32| 2.0 * (1.0 - r).powi(2) * r.powi(reflections);
    for (path, reflections) in [
        ("plate plate lens screen", 0),
        ("plate plate* plate* plate lens screen", 2),
        ("plate plate* plate* plate* plate* plate lens screen", 4),
    ] {
        let row = rows.iter().find(|row| row[0] == path).unwrap_or_else(|| panic!("{path} in\n{table}"));
        assert_eq!(row[1..4], [reflections.to_string().as_str(), "screen", "5000"]);
        assert!((number(row[4]) / through(reflections) - 1.0).abs() < 1e-9, "{row:?}");
        assert!((number(row[5]) / number(row[4]) - 0.5).abs() < 1e-12, "{row:?}");
    }
    // the first face reflects light, which escapes
    let back = rows.iter().find(|row| row[0] == "plate* -").unwrap();
    assert_eq!(back[1..4], ["1", "", "5000"]);
    assert!((number(back[4]) - 2.0 * r).abs() < 1e-12);
    // the faces of the reflections, as in the table of segments
    let twice = rows.iter().find(|row| row[1] == "2" && row[2] == "screen").unwrap();
    assert_eq!(back[6], "plate.plate.z-", "{table}");
    assert_eq!(twice[6], "plate.plate.z+ plate.plate.z-", "{table}");
    assert!(rows.windows(2).all(|pair| number(pair[0][4]) >= number(pair[1][4])));
}

/// Ghosts that pass beside the image are counted: a wider image catches exactly these.
#[test]
fn ghosts_beside_the_image() {
    let bench = Bench::new();
    let file = |image: &str| {
        format!(
            "UNIT MM\nWAVM 1 0.5875618 1\nPWAV 1\nENPD 20\nYFLN 0\nSURF 0\n DISZ INFINITY\nSURF 1\n STOP\n CURV 0.02\n DISZ 6\n GLAS N-BK7\nSURF 2\n \
             CURV -0.01\n DISZ 60\nSURF 3\n{image}"
        )
    };
    bench.write("narrow.zmx", file(""));
    bench.write("wide.zmx", file(" DIAM 500 1\n"));
    let run = |name: &str| {
        let json = bench.json(&["optics", name, "--branches", "both", "--json"]);
        let sheets = json["sheets"].as_array().unwrap();
        let image = sheets.iter().find(|sheet| sheet["sheet"] == "image").unwrap().clone();
        let pair = |key: &str, count: &str| {
            (image[key][count].as_u64().unwrap(), image[key]["power"].as_f64().unwrap())
        };
        (pair("ghosts_beside", "rays"), pair("stray", "hits"))
    };
    let ((beside, lost), (hits, power)) = run("narrow.zmx");
    let ((none, _), (all, total)) = run("wide.zmx");
    assert!(beside > 100 && lost > 0.0 && none == 0, "{beside} {lost} {none}");
    assert_eq!(beside + hits, all);
    assert!((lost + power - total).abs() < 1e-9 * total);
    let said = bench.says(&["optics", "narrow.zmx", "--branches", "both"]);
    assert!(
        said.contains(&format!("- {beside} rays of ghosts (")) && said.contains("image_semi_diameter"),
        "{said}"
    );
    assert!(!bench.says(&["optics", "wide.zmx", "--branches", "both"]).contains("of ghosts"));
}

/// A cemented doublet: each lens, and both on one sheet, with indications.
#[test]
fn drawings_of_lenses() {
    let bench = Bench::new();
    let file = "UNIT MM\nWAVM 1 0.5875618 1\nPWAV 1\nENPD 20\nSURF 0\n DISZ INFINITY\nSURF 1\n STOP\n CURV 0.02\n DISZ 6\n GLAS N-BK7\nSURF 2\n CURV -0.02\n \
                DISZ 2.5\n GLAS N-SF5\nSURF 3\n DISZ 60\nSURF 4\n CURV 0.01\n DISZ 4\n GLAS N-BK7\nSURF 5\n DISZ 60\nSURF 6\n";
    bench.write("doublet.zmx", file);
    let draw = |extra: &[&str]| {
        bench.says(&[&["optics", "doublet.zmx", "--drawing", "out.svg", "--quiet"], extra].concat());
        bench.read("out.svg")
    };
    let one =
        draw(&["--element", "2", "--indication", "left 3/=2(0.5)", "--indication", "thickness=\u{b1} 0.05"]);
    assert!(
        one.contains(">R 50 CC<") && one.contains(">3/ 2(0.5)<") && one.contains(">2.5 \u{b1} 0.05<"),
        "{one}"
    );
    let both = draw(&["--element", "1-2", "--indication", "cement=NOA 61"]);
    for text in [">8.5<", ">R1: R 50 CX<", ">R3: R \u{221e}<", ">Cement NOA 61<", "N-SF5"] {
        assert!(both.contains(text), "{text}: {both}");
    }
    let fails =
        |extra: &[&str]| bench.fails(3, &[&["optics", "doublet.zmx", "--drawing", "x.svg"], extra].concat());
    assert!(fails(&["--element", "4"]).contains("there is no lens 4: the lenses have the numbers 1 to 3"));
    let apart = fails(&["--element", "2-3"]);
    assert!(apart.contains("lens 2-3 and lens 4-5 are not cemented"), "{apart}");
    assert!(fails(&["--indication", "left 7/=1"]).contains("there is no field \"left 7/\" on this drawing"));
    assert!(
        bench.fails(2, &["optics", "doublet.zmx", "--drawing", "x.svg", "--element", "x"]).contains("1-2")
    );
}

/// Two faces of reflectance r transmit (1 - r) / (1 + r).
#[test]
fn options_win_over_the_file() {
    let bench = bench();
    let through = |options: &[&str]| {
        let found = bench.json(&[&["optics", "plate.toml", "--json"], options].concat());
        assert_eq!(found["absorbed"][2]["element"], "screen");
        found["absorbed"][2]["power"].as_f64().unwrap()
    };
    let expected = |n: f64| {
        let r = ((n - 1.0) / (n + 1.0)).powi(2);
        2.0 * (1.0 - r) / (1.0 + r)
    };
    assert!((through(&["--branches", "both"]) - expected(1.5)).abs() < 1e-9);
    assert!((through(&["--branches", "both", "--polarised"]) - expected(1.5)).abs() < 1e-9);
    assert!((through(&["--branches", "both", "-D", "n=2"]) - expected(2.0)).abs() < 1e-9);
    let random = ["1", "2"].map(|seed| through(&["--branches", "random", "--seed", seed]));
    // 5000 rays, each transmitted with p = 0.92: four standard deviations are 0.031 of 2
    random.iter().for_each(|power| assert!((power - expected(1.5)).abs() < 0.031, "{power}"));
    assert_ne!(random[0], random[1]);
}

#[test]
fn the_table_of_segments() {
    let bench = bench();
    let said = bench.says(&["optics", "plate.toml", "--out", "segments.csv", "--branches", "both"]);
    let table = bench.read("segments.csv");
    assert_eq!(table.lines().next(), Some(HEADER));
    let rows = rows(&table);
    assert!(said.contains(&format!(", {} segments", rows.len())), "{said}");
    assert!(rows.len() > 30_000, "{}", rows.len());
    let whole = |text: &str| text.parse::<i64>().unwrap();
    let mut seen = [0; 3];
    for row in &rows {
        let parent = whole(row[1]);
        if parent < 0 {
            assert_eq!((row[2], row[9]), ("0", "-10.0"));
            seen[0] += 1;
            continue;
        }
        let before = &rows[usize::try_from(parent).unwrap()];
        // the same ray, one event later, starts at the end of the previous segment
        assert_eq!((row[0], whole(row[2])), (before[0], whole(before[2]) + 1));
        assert_eq!(row[7..10], before[10..13]);
        let inside = number(row[9]).abs() <= 1.0 && number(row[12]).abs() <= 1.0;
        assert_eq!(number(row[6]), if inside { 1.5 } else { 1.0 });
        let (element, event) = (row[17], row[19]);
        match element {
            "screen" => assert_eq!((row[18], event), ("screen", "absorbed")),
            "lens" => assert_eq!(event, "bent"),
            "plate" => assert_eq!(&row[18][..12], "plate.plate."),
            other => assert_eq!((other, event, row[12]), ("", "escaped", "nan")),
        }
        seen[1] += usize::from(element == "screen");
        seen[2] += usize::from(element.is_empty());
    }
    assert_eq!(seen[0], 5000);
    assert!(seen[1] >= 5000 && seen[2] >= 5000, "{seen:?}");
}

#[test]
fn any_number_of_threads_writes_the_same_bytes() {
    let bench = bench();
    let with = |threads: &str| {
        let said =
            bench.says(&["optics", "plate.toml", "--branches", "random", "-o", "-", "--threads", threads]);
        assert!(said.starts_with(HEADER) && said.lines().count() > 15_000);
        said
    };
    assert!(with("1") == with("3"));
    assert_eq!(bench.says(&["optics", "plate.toml", "--quiet", "--paths", "paths.csv"]), "");
    // without a file, the report is the result
    let report = bench.says(&["optics", "plate.toml", "--quiet"]);
    assert!(report.contains("screen") && report == bench.says(&["optics", "plate.toml"]), "{report}");
}

#[test]
fn invalid_runs_are_rejected_with_a_reason() {
    let bench = bench();
    let message = bench.fails(3, &["optics", "ball.toml"]);
    assert!(message.contains("the model has no [optics] table"), "{message}");
    let fails = |text: &str, problem: &str, place: &str| {
        bench.write("bad.toml", text);
        let message = bench.fails(3, &["optics", "bad.toml", "-o", "table.csv"]);
        assert!(message.contains(problem) && message.contains(place), "{message}");
        assert!(!bench.path("table.csv").exists());
    };
    let unknown = "unknown key `wavelenth_nm` in `optics.source`";
    fails(&PLATE.replace("wavelength_nm", "wavelenth_nm"), unknown, "bad.toml:31:1");
    let dark = &PLATE[..PLATE.find("[[optics.source]]").unwrap()];
    fails(dark, "the model has no [[optics.source]]: without one there is no light.", "bad.toml");
    let glass = PLATE.replace("[[optics.source]]", "[optics.medium]\nplate = \"N-BK7\"\n[[optics.source]]");
    fails(
        &glass.replace("550", "5500"),
        "the source emits at 5500 nm: the index of `N-BK7` is known from",
        ":33:17",
    );
    let twice = bench.fails(2, &["optics", "plate.toml", "--layout", "-", "--out", "-"]);
    assert!(twice.contains("several results go to standard output"), "{twice}");
    let usage = bench.fails(2, &["optics", "plate.toml", "--json", "--out", "-"]);
    assert!(usage.contains("Write the others to files."), "{usage}");
    assert!(bench.fails(2, &["optics", "plate.toml", "--branches", "none"]).contains("ideal"));
    assert!(
        bench.fails(2, &["optics", "plate.toml", "-o", "table.txt"]).contains("the table format is unknown")
    );
}

/// The model of the guide runs and prints the output shown on the page, and its quarter-wave films
/// agree with the closed form.
#[test]
fn the_guide() {
    let page = include_str!("../../../../docs/guides/optics-files.md");
    let block = |kind: &str| {
        let (_, rest) = page.split_once(&format!("```{kind}\n")).unwrap();
        rest.split_once("```\n").unwrap().0
    };
    let bench = Bench::new();
    bench.write("lens.toml", block("toml"));
    let arguments: Vec<&str> = block("sh").split_whitespace().skip(1).collect();
    assert_eq!(bench.says(&arguments), block("text"));
    assert_eq!(bench.read("segments.csv").lines().next(), Some(HEADER));

    // light of 550 nm near the axis of a thin lens: each face reflects ((1.38^2 - n) / (1.38^2 + n))^2
    let near = block("toml").replace("circle = 10, rays", "circle = 0.1, rays");
    let near = near.replace("[[486.1, 1], [587.6, 1], [656.3, 1]]", "550").replace("\"N-BK7\"", "1.5185");
    bench.write("near.toml", near);
    let found = bench.json(&["optics", "near.toml", "--json"]);
    let r = ((1.38_f64.powi(2) - 1.5185) / (1.38_f64.powi(2) + 1.5185)).powi(2);
    let power = found["absorbed"][1]["power"].as_f64().unwrap();
    assert!((power - (1.0 - r) / (1.0 + r)).abs() < 1e-4, "{power}");
}

/// The phase is 360 degrees per wavelength of path: 9 mm to the plate, 12 mm to its far side;
/// transmission causes no jump.
#[test]
fn phases_are_columns_on_request() {
    let bench = bench();
    bench.says(&["optics", "plate.toml", "--out", "rays.csv", "--phases"]);
    let table = bench.read("rays.csv");
    let mut lines = table.lines();
    assert_eq!(lines.next().unwrap(), format!("{HEADER},phase_s,phase_p"));
    let phase = |path_mm: f64| 360.0 * (path_mm * 1e6 / 550.0).fract();
    let mut seen = [0; 2];
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let generation: usize = cells[2].parse().unwrap();
        let Some(&path) = [9.0, 12.0].get(generation) else { continue };
        for cell in &cells[20..22] {
            let found: f64 = cell.parse().unwrap();
            assert!((found - phase(path)).abs() < 1e-6, "{line}");
        }
        seen[generation] += 1;
    }
    assert_eq!(seen, [5000; 2]);
    assert!(bench.fails(2, &["optics", "plate.toml", "--phases"]).contains("--out"));
}

/// A plano-convex lens of BK7 as a lens file: f = R / (n - 1).
#[test]
fn a_lens_file() {
    let bench = Bench::new();
    let file = "UNIT MM\nENPD 2\nYFLN 0 1\nWAVM 1 0.5876 1\nSURF 0\n DISZ INFINITY\nSURF 1\n STOP\n CURV 0.02\n DISZ 3\n GLAS N-BK7\n\
                SURF 2\n DISZ 94.775\nSURF 3\n";
    bench.write("lens.ZMX", file);
    let said = bench.says(&["optics", "lens.ZMX", "--spot", "spot.svg", "--layout", "layout.svg"]);
    // two fields of 880 rays, each through two faces to the image and beyond
    assert!(said.starts_with("lens.ZMX: 1760 rays, 7040 segments"), "{said}");
    assert!(!said.contains("on other paths"), "{said}");
    // the image surface is behind the paraxial image of a plano-convex lens, whose distance is f - d / n
    let length = |name: &str| -> f64 {
        let line = said.lines().find(|line| line.starts_with(name)).unwrap();
        line.split_whitespace().rev().nth(1).unwrap().parse().unwrap()
    };
    let paraxial = length("focal length") - 3.0 / 1.5168;
    assert!((length("paraxial image distance") - paraxial).abs() < 1e-3, "{said}");
    assert_eq!(length("actual image distance"), 94.775);
    assert!((length("defocus") - (paraxial - 94.775)).abs() < 1e-3, "{said}");
    let image: Vec<&str> =
        said.lines().find(|line| line.starts_with("image ")).unwrap().split_whitespace().collect();
    // mean of the fields of 0 and 1 degree, with the focal length of 96.75 mm = 50 / 0.5168
    let height: f64 = image[3].trim_end_matches(')').parse().unwrap();
    assert!((height - 0.5 * 96.75 * 1f64.to_radians().tan()).abs() < 2e-3, "{said}");
    // one diagram and one radius for each field, instead of one for all fields
    let fields: Vec<&str> = said.lines().skip_while(|line| !line.starts_with("field on the image")).collect();
    assert!(fields.iter().any(|line| line.starts_with("0 (0, 0)\u{b0}")), "{said}");
    assert!(fields.iter().any(|line| line.starts_with("1 (0, 1)\u{b0}")), "{said}");
    assert!(said.contains("- no common radius: light of several fields arrives"), "{said}");
    // all light that escapes has passed through the image
    let powers: Vec<&str> = ["escaped", "of it passed through the image"]
        .iter()
        .map(|what| said.lines().find_map(|line| line.trim().strip_prefix(what)).unwrap().trim())
        .collect();
    assert_eq!(powers[0], powers[1], "{said}");
    let help = bench.says(&["optics", "--help"]);
    assert!(help.contains("Zemax lens file"), "{help}");
    let drawing = bench.read("spot.svg");
    assert!(
        drawing.contains(">field 0 (0, 0)\u{b0}<") && drawing.contains(">field 1 (0, 1)\u{b0}<"),
        "{drawing}"
    );
    let found = bench.json(&["optics", "lens.ZMX", "--json"]);
    let image = found["sheets"].as_array().unwrap().iter().find(|sheet| sheet["sheet"] == "image").unwrap();
    assert!(image["rms_radius"].is_null() && image["hits"] == 1760, "{image}");
    // each spot is much smaller than the distance between the fields, 1.7 mm
    let radii: Vec<f64> = (0..2).map(|k| image["fields"][k]["rms_radius"].as_f64().unwrap()).collect();
    assert!(radii.iter().all(|radius| *radius < 0.02), "{radii:?}");
    // spherical aberration and defocus: the mean over the pupil of (a rho^3 + b rho)^2 by the points of the spot itself would
    // count the rim twice; powers count its area, so that the radius of a cone of rays is that of the rim over sqrt(2)
    bench.write("out.zmx", file.replace("94.775", "60").replace("YFLN 0 1", "YFLN 0"));
    let cone = bench.json(&["optics", "out.zmx", "--json"]);
    let image = cone["sheets"].as_array().unwrap().iter().find(|sheet| sheet["sheet"] == "image").unwrap();
    let radius = image["rms_radius"].as_f64().unwrap();
    // the slope of the marginal ray is 1 / 96.75, and the cone converges from 94.775 to 60 of its height of 1; the
    // correction of the sine is far below the difference of an equal weight of all points, 10 %
    assert!(
        (radius - (1.0 - 60.0 / 94.775) * (94.775 / 96.75) / 2f64.sqrt()).abs() < 2e-3 * radius,
        "{cone}"
    );
    // the number of ghosts is bounded
    let ghosts = bench.says(&["optics", "lens.ZMX", "--branches", "both", "--paths", "-"]);
    assert!(ghosts.contains("lens 1-2 lens 1-2* lens 1-2* lens 1-2 image"), "{ghosts}");
    bench.write("bad.zmx", "SURF x\n");
    let failed = bench.fails(3, &["optics", "bad.zmx"]);
    assert!(failed.contains("error: bad.zmx: line 1: the file has no aperture"), "{failed}");
    assert!(bench.fails(3, &["optics", "none.zmx"]).contains("none.zmx: cannot be read"));
    let missing = bench.fails(3, &["optics", "bat.zmx"]);
    assert!(
        missing.ends_with("cannot be read: there is no such file. Did you mean `bad.zmx`?\n"),
        "{missing}"
    );
    assert!(bench.fails(2, &["optics", "lens.ZMX", "-D", "a=3"]).contains("a lens file has no parameters"));
}

/// The plano-convex lens of a file, 3 mm thick and 50 mm in radius: f = R / (n - 1), and the back focal point is t / n nearer
/// to the lens than that (E. Hecht, Optics, section 6.1).
#[test]
fn first_order_data_of_a_lens_file() {
    let bench = Bench::new();
    let lines = "WAVM 1 0.4861327 1\nWAVM 2 0.5875618 2\nWAVM 3 0.6562725 1\nPWAV 2\n";
    let file = format!(
        "NAME single\nUNIT MM\nENPD 2\nYFLN 0 5\n{lines}SURF 0\n DISZ INFINITY\nSURF 1\n STOP\n CURV 0.02\n DISZ 3\n GLAS N-BK7\n\
         SURF 2\n DISZ 94.775\nSURF 3\n"
    );
    bench.write("lens.zmx", &file);
    // Schott's data sheet
    let n = 1.51680;
    let (focal, back) = (50.0 / (n - 1.0), 50.0 / (n - 1.0) - 3.0 / n);
    for command in ["optics", "info"] {
        let said = bench.says(&[command, "lens.zmx"]);
        let value = |what: &str| -> f64 {
            let line =
                said.lines().find(|line| line.starts_with(what)).unwrap_or_else(|| panic!("{what}: {said}"));
            line[what.len()..].split_whitespace().next().unwrap().parse().unwrap()
        };
        assert!((value("focal length") / focal - 1.0).abs() < 2e-5, "{said}");
        assert!((value("back focal distance") / back - 1.0).abs() < 2e-5, "{said}");
        assert!((value("F-number") / (focal / 2.0) - 1.0).abs() < 2e-5, "{said}");
        // barrel distortion of a thin lens behind its stop is less than the square of the field angle
        let distortion = value("distortion at (0, 5)\u{b0}") / 100.0;
        assert!(distortion.abs() > 0.0 && distortion.abs() < 5f64.to_radians().powi(2), "{said}");
        let json = bench.json(&[command, "lens.zmx", "--json"]);
        let found = &json["first_order"];
        assert!((found["focal_length"].as_f64().unwrap() / focal - 1.0).abs() < 2e-5, "{json}");
        assert!((100.0 * found["distortion"].as_f64().unwrap() - 100.0 * distortion).abs() < 1e-3, "{json}");
    }
    let said = bench.says(&["info", "lens.zmx"]);
    assert!(said.starts_with("lens.zmx: single, lengths in mm"), "{said}");
    let row = |begin: &str| {
        said.lines().find(|line| line.starts_with(begin)).unwrap().split_whitespace().collect::<Vec<_>>()
    };
    assert_eq!(
        (&row("1 ")[..4], row("1 ").last()),
        (&["1", "50", "3", "N-BK7"][..], Some(&"stop")),
        "{said}"
    );
    assert_eq!(&row("2 ")[..3], ["2", "inf", "94.775"], "{said}");
    assert!(bench.fails(2, &["info", "lens.zmx", "--explain"]).contains("not a tree of solids"));
    // the mean square over all wavelengths is that within each and of their centroids, weighted by power
    let json = bench.json(&["optics", "lens.zmx", "--json"]);
    let image = json["sheets"].as_array().unwrap().iter().find(|sheet| sheet["sheet"] == "image").unwrap();
    for field in image["fields"].as_array().unwrap() {
        let lines = field["wavelengths"].as_array().unwrap();
        let number = |value: &serde_json::Value| value.as_f64().unwrap();
        assert_eq!(
            lines.iter().map(|line| number(&line["wavelength_nm"])).collect::<Vec<_>>(),
            [486.1327, 587.5618, 656.2725]
        );
        let power: f64 = lines.iter().map(|line| number(&line["power"])).sum();
        let squares: f64 = lines
            .iter()
            .map(|line| {
                let off = number(&line["centroid"][1]) - number(&field["centroid"][1]);
                number(&line["power"]) * (number(&line["rms_radius"]).powi(2) + off * off)
            })
            .sum();
        assert!((squares / power / number(&field["rms_radius"]).powi(2) - 1.0).abs() < 1e-9, "{field}");
        assert!(number(&lines[0]["rms_radius"]) > number(&lines[1]["rms_radius"]), "{field}");
    }
}

/// Five rays of each field, evenly spaced over the pupil, from slightly in front of the lens to the image.
#[test]
fn the_layout_of_a_lens_file() {
    let bench = Bench::new();
    let file = "UNIT MM\nENPD 10\nYFLN 0 5\nWAVM 1 0.4861327 1\nWAVM 2 0.5875618 1\nPWAV 2\nSURF 0\n DISZ INFINITY\nSURF 1\n STOP\n \
                CURV 0.02\n DISZ 3\n GLAS N-BK7\nSURF 2\n DISZ 94.775\nSURF 3\n";
    bench.write("lens.zmx", file);
    // the ends of all lines of a class, path by path
    let lines = |drawing: &str, class: &str| -> Vec<Vec<[f64; 2]>> {
        let paths = drawing.split("<path ").filter(|path| path.contains(&format!(r#"class="{class}""#)));
        let points = |path: &str| {
            let path =
                path.split_once(" d=\"").unwrap().1.split('"').next().unwrap().replace(['M', 'L'], ";");
            let point = |text: &str| {
                let mut numbers = text.split_whitespace().map(|number| number.parse().unwrap());
                [numbers.next().unwrap(), numbers.next().unwrap()]
            };
            path.split(';').filter(|part| !part.is_empty()).map(point).collect()
        };
        paths.map(points).collect()
    };
    bench.says(&["optics", "lens.zmx", "--quiet", "--layout", "lens.svg"]);
    let drawing = bench.read("lens.svg");
    for text in [">field 0\u{b0}<", ">field 5\u{b0}<", ">stop<", ">section x = 0<"] {
        assert!(drawing.contains(text), "{text}: {drawing}");
    }
    assert!(!drawing.contains(" nm<"), "{drawing}");
    let rays = lines(&drawing, "ray");
    // a path for each field: five rays of three segments
    assert_eq!(rays.iter().map(Vec::len).collect::<Vec<_>>(), [30, 30]);
    let sheets = lines(&drawing, "sheet");
    let right = |paths: &[Vec<[f64; 2]>]| paths.iter().flatten().map(|point| point[0]).fold(0.0, f64::max);
    assert!((right(&rays) - right(&sheets)).abs() < 0.1, "{drawing}");
    for ray in &rays {
        let left = ray.iter().map(|point| point[0]).fold(f64::INFINITY, f64::min);
        let mut heights: Vec<f64> =
            ray.iter().filter(|point| point[0] < left + 0.1).map(|point| point[1]).collect();
        heights.sort_by(f64::total_cmp);
        let steps: Vec<f64> = heights.windows(2).map(|pair| pair[1] - pair[0]).collect();
        assert!(
            steps.len() == 4 && steps.iter().all(|step| (step / steps[0] - 1.0).abs() < 0.02),
            "{heights:?}"
        );
    }
    let drawn =
        |options: &[&str]| bench.says(&[&["optics", "lens.zmx", "-q", "--layout", "-"], options].concat());
    let by_wavelength = drawn(&["--colour", "wavelength", "--rays", "12"]);
    assert!(
        by_wavelength.contains(">486.13 nm<") && by_wavelength.contains(">587.56 nm<"),
        "{by_wavelength}"
    );
    // three rays of each field and wavelength
    assert_eq!(lines(&by_wavelength, "ray").iter().map(Vec::len).collect::<Vec<_>>(), [36, 36]);
    assert!(drawn(&["--plane", "xz"]).contains(">section y = 0<"));
}

/// A triplet whose lenses clip the oblique fields: rays that pass beside a lens reach the image far from the spot. The RMS
/// radii of 401 x 401 rays that meet all surfaces are 5.000, 17.139 and 22.292 um (from Python).
#[test]
fn vignetted_rays_are_not_in_the_spots() {
    let bench = Bench::new();
    let rows = [
        ("21.25", "2", "1.62041 60.33", "6.5"),
        ("-158.65", "6", "", "6.5"),
        ("-20.25", "1", "1.61659 36.63", "5"),
        ("19.3", "6", "", "5"),
        ("141.25", "2", "1.62041 60.33", "6.5"),
        ("-17.285", "42.95", "", "6.5"),
    ];
    let mut file = "UNIT MM\nENPD 12.5\nYFLN 0 14 20\nWAVM 1 0.4861327 1\nWAVM 2 0.5875618 1\nWAVM 3 0.6562725 1\nPWAV 2\n\
                    SURF 0\n DISZ INFINITY\n"
        .to_owned();
    for (k, (radius, thickness, glass, size)) in rows.iter().enumerate() {
        let curvature = 1.0 / radius.parse::<f64>().unwrap();
        file += &format!("SURF {}\n CURV {curvature}\n DISZ {thickness}\n DIAM {size} 1\n", k + 1);
        file += if k == 2 { " STOP\n" } else { "" };
        file += &if glass.is_empty() { String::new() } else { format!(" GLAS ___BLANK 1 0 {glass}\n") };
    }
    bench.write("triplet.zmx", &(file + "SURF 7\n"));
    let found = bench.json(&["optics", "triplet.zmx", "--json"]);
    let image = found["sheets"].as_array().unwrap().iter().find(|sheet| sheet["sheet"] == "image").unwrap();
    for (field, wanted) in [5.000e-3, 17.139e-3, 22.292e-3].into_iter().enumerate() {
        let radius = image["fields"][field]["rms_radius"].as_f64().unwrap();
        assert!((radius / wanted - 1.0).abs() < 0.015, "{field}: {radius}");
    }
    let hits = |entry: &serde_json::Value| entry["hits"].as_u64().unwrap();
    let in_order: u64 = (0..3).map(|field| hits(&image["fields"][field])).sum();
    let stray = hits(&image["stray"]);
    assert!(stray > 0 && in_order + stray == hits(image), "{image}");
    assert!(image["stray"]["power"].as_f64().unwrap() > 0.0, "{image}");
    let said = bench.says(&["optics", "triplet.zmx"]);
    assert!(
        said.contains(&format!("- {stray} rays (")) && said.contains("they are not in the RMS"),
        "{said}"
    );
}

/// The drawing of a lens has its radii and its glass; a number without a lens is an error.
#[test]
fn drawings_of_single_lenses() {
    let bench = Bench::new();
    bench.write("lens.zmx", std::fs::read_to_string("../../models/optics/cooke-triplet.zmx").unwrap());
    bench.says(&["optics", "lens.zmx", "-q", "--drawing", "lens.svg", "--element", "2"]);
    let svg = bench.read("lens.svg");
    assert!(svg.contains("R 22.213 CC") && svg.contains(">F2<") && svg.contains("R 20.292 CC"), "{svg}");
    let failed = bench.fails(3, &["optics", "lens.zmx", "-q", "--drawing", "lens.svg", "--element", "9"]);
    assert!(failed.contains("there is no lens 9: the lenses have the numbers 1 to 3."), "{failed}");
}
