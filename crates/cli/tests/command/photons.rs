//! `photons`: optical photons in a detector, on the model of the guide.

use crate::bench::Bench;
use serde_json::Value;

const PAGE: &str = include_str!("../../../../docs/guides/photons.md");

const HEADER: &str = "photon,x,y,z,time,dx,dy,dz,px,py,pz,wavelength_nm,steps,sensor";

/// The first block of a kind on the page.
fn block(kind: &str) -> &'static str {
    let (_, rest) = PAGE.split_once(&format!("```{kind}\n")).unwrap();
    rest.split_once("```\n").unwrap().0
}

fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("bar.gdml", block("xml"));
    bench
}

/// The arguments of a run of 2,000 photons of the guide.
fn run<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["photons", "bar.gdml", "--at", "0,0,0", "--wavelength", "550", "-n", "2000"];
    arguments.extend(more);
    arguments
}

/// The command of the guide runs; the ends add up; every hit is at the interface of the crystal and the diode, after at
/// least the time of the straight way at c / 1.79.
#[test]
fn the_guide() {
    let bench = bench();
    let arguments: Vec<&str> = block("sh").split_whitespace().skip(1).collect();
    assert!(bench.says(&arguments).contains("100000 photons"));
    let found = bench.json(&run(&["--json", "-o", "hits.csv"]));
    let ends = found["ends"].as_object().unwrap();
    assert_eq!(ends.values().filter_map(Value::as_u64).sum::<u64>(), 2000);
    assert_eq!(found["photons"], 2000);
    assert_eq!(found["detection"], "both");
    assert!(found["seconds"].as_f64().unwrap() > 0.0);
    let table = bench.read("hits.csv");
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some(HEADER));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len() as u64, found["hits"].as_u64().unwrap());
    assert!(rows.len() > 50, "{}", rows.len());
    let number = |text: &str| text.parse::<f64>().unwrap();
    for row in &rows {
        assert!((number(row[3]) - 50.0).abs() < 1e-12, "{row:?}");
        assert!(number(row[4]) >= 50.0 * 1.79 / 299.792_458 * (1.0 - 1e-12), "{row:?}");
        assert_eq!(row[13], "Diode");
    }
}

/// The tables of consecutive ranges make up the table of the whole run, with any number of threads.
#[test]
fn ranges_are_parts_of_the_run() {
    let bench = bench();
    let rows = |more: &[&str]| {
        let arguments: Vec<&str> = run(&["-o", "-"]).into_iter().chain(more.iter().copied()).collect();
        bench.says(&arguments).lines().skip(1).map(str::to_owned).collect::<Vec<_>>()
    };
    let whole = rows(&[]);
    let parts: Vec<String> =
        ["0:700", "700:701", "701:2000"].iter().flat_map(|range| rows(&["--range", range])).collect();
    assert_eq!(parts, whole);
    assert_eq!(rows(&["--threads", "3"]), whole);
    assert_ne!(rows(&["--seed", "1"]), whole);
}

#[test]
fn bad_arguments_are_explained() {
    let bench = bench();
    let fails = |code: i32, more: &[&str]| bench.fails(code, &run(more));
    assert!(fails(2, &["--range", "10:5"]).contains("A at most B"));
    assert!(fails(2, &["--range", "0:3000"]).contains("the run has 2000 photons"));
    assert!(fails(2, &["--json", "-o", "-"]).contains("several things go to standard output"));
    assert!(fails(2, &["--towards", "0,0,0"]).contains("it must be finite and not zero"));
    assert!(fails(2, &["--max-time", "0"]).contains("the maximum time is 0 ns: it must be positive."));
    let negative = ["photons", "bar.gdml", "--at", "0,0,0", "--wavelength=-5"];
    assert!(bench.fails(2, &negative).contains("the wavelength is -5 nm: it must be positive and finite."));
    // before the run, and without leaving a file
    let endless = "18446744073709551615";
    for (path, reason) in [("hits.txt", "the table format is unknown"), ("no/hits.csv", "no/hits.csv")] {
        let before = bench.files();
        let arguments =
            ["photons", "bar.gdml", "--at", "0,0,0", "--wavelength", "550", "-n", endless, "-o", path];
        let done = bench.run(&arguments);
        assert!(done.code != 0 && done.err.contains(reason), "{}", done.err);
        assert_eq!(bench.files(), before);
    }
    bench.write("plain.toml", "rayweave = 1\n[solid.a]\nsphere = { radius = 1 }\n");
    let plain = ["photons", "plain.toml", "--at", "0,0,0", "--wavelength", "500"];
    assert!(bench.fails(3, &plain).contains("the model has no optical properties: it has no table [gdml]."));
}

/// Steps, counts and sequences agree with the ways of ending; recording and drawing do not change the hits.
#[test]
fn histories_and_drawings() {
    let bench = bench();
    let plain = bench.json(&run(&["--json", "-o", "plain.csv"]));
    let drawings =
        ["--draw", "t.svg", "--tracks", "30", "--plane", "yz", "--map", "m.svg", "--spectra", "s.svg"];
    let mut more = vec!["--json", "-o", "hits.csv", "--steps", "steps.csv", "--counts", "--sequences", "5"];
    more.extend(drawings);
    let found = bench.json(&run(&more));
    assert_eq!(bench.read("hits.csv"), bench.read("plain.csv"));
    assert_eq!(found["ends"], plain["ends"]);
    let table = bench.read("steps.csv");
    let mut lines = table.lines();
    let header = "photon,track,step,process,x,y,z,time,dx,dy,dz,px,py,pz,wavelength_nm,volume,surface";
    assert_eq!(lines.next(), Some(header));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    let count = |process: &str| rows.iter().filter(|row| row[3] == process).count() as u64;
    assert_eq!(count("emission"), 2000);
    for (process, number) in found["processes"].as_object().unwrap() {
        assert_eq!(number.as_u64(), Some(count(process)), "{process}");
    }
    for (end, number) in found["ends"].as_object().unwrap() {
        assert_eq!(number.as_u64(), Some(count(end)), "{end}");
    }
    for row in found["surfaces"].as_array().unwrap() {
        let [surface, process] = ["surface", "process"].map(|key| row[key].as_str().unwrap());
        let own = rows.iter().filter(|row| row[16] == surface && row[3] == process);
        assert_eq!(row["count"], own.count(), "{row}");
    }
    let sequences = found["sequences"].as_array().unwrap();
    assert_eq!(sequences.len(), 5);
    // photons that are absorbed on their first way: of 400 mm on at most 10 sqrt(3) to 50 mm
    assert!(sequences.iter().any(|row| row["sequence"] == "TO AB"), "{sequences:?}");
    assert!(bench.read("t.svg").contains("section x = 0") && bench.read("t.svg").contains("550 nm"));
    assert!(bench.read("m.svg").contains(&format!("{} hits of one sensor", found["hits"])));
    assert!(bench.read("s.svg").contains("time / ns"));
    let text = bench.says(&run(&["--counts", "--sequences"]));
    assert!(text.contains("Wrapping  lambertian_reflection") && text.contains("TO DR"), "{text}");
    // the history of one photon is a part of the histories of all
    bench.says(&run(&["--range", "17:18", "--steps", "one.csv", "--draw", "one.png", "--tracks", "1"]));
    let one = bench.read("one.csv");
    let whole: Vec<&str> = table.lines().filter(|line| line.starts_with("17,")).collect();
    assert_eq!(one.lines().skip(1).collect::<Vec<_>>(), whole);
    assert!(bench.fails(2, &run(&["--draw", "a.pdf"])).contains(".svg or .png"));
    assert!(bench.fails(2, &run(&["--draw", "-", "--map", "-"])).contains("`-` is given more than once"));
    assert!(bench.fails(2, &run(&["--plane", "yz"])).contains("--draw"));
}

/// A wrapping of the `LUT` model needs its table; a source outside all volumes is noted.
#[test]
fn measured_surfaces_and_outer_sources() {
    let bench = bench();
    let wrapped = block("xml").replace(
        r#"finish="groundfrontpainted" type="dielectric_dielectric""#,
        r#"finish="groundtyvekair" type="dielectric_LUT""#,
    );
    bench.write("wrapped.gdml", &wrapped);
    let run = ["photons", "wrapped.gdml", "--at", "0,0,0", "--wavelength", "550", "-n", "100", "--json"];
    assert!(bench.fails(3, &run).contains("data set RealSurface with GroundTyvek.dat"));
    bench.write("GroundTyvek.dat", "1 ".repeat(151_515));
    let with: Vec<&str> = run.into_iter().chain(["--surface-tables", "."]).collect();
    assert_eq!(bench.json(&with)["photons"], 100);
    let outside = ["photons", "bar.gdml", "--at", "0,0,500", "--wavelength", "550", "-n", "10"];
    let done = bench.run(&outside);
    assert!(done.code == 0 && done.err.contains("the source is outside all volumes"), "{}", done.err);
}
