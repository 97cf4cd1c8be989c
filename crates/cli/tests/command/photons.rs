//! `photons`: optical photons in a detector, on the model of the guide.

use crate::bench::Bench;
use serde_json::Value;

const PAGE: &str = include_str!("../../../../docs/guides/photons.md");

const HEADER: &str = "event,photon,x,y,z,time,dx,dy,dz,px,py,pz,wavelength_nm,steps,sensor";

/// The first block of a kind on the page.
fn block(kind: &str) -> &'static str {
    let (_, rest) = PAGE.split_once(&format!("```{kind}\n")).unwrap();
    rest.split_once("```\n").unwrap().0
}

pub fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("bar.gdml", block("xml"));
    bench
}

/// The guide's model with a second diode at the other end, whose boundary has no surface.
pub fn bench_of_two_diodes() -> Bench {
    let bench = Bench::new();
    let diode = r#"<physvol name="diode">"#;
    let second = r#"<physvol name="second" copynumber="7"><volumeref ref="Diode"/><position name="q" z="-50.5" unit="mm"/></physvol>"#;
    let text = block("xml");
    assert!(text.contains(diode));
    bench.write("bar.gdml", text.replace(diode, &format!("{second}{diode}")));
    bench
}

/// The arguments of a run of 2,000 photons in the guide's model.
pub fn run<'a>(more: &[&'a str]) -> Vec<&'a str> {
    let mut arguments = vec!["photons", "bar.gdml", "--at", "0,0,0", "--wavelength", "550", "-n", "2000"];
    arguments.extend(more);
    arguments
}

/// The guide's command runs; the counts of the ends add up; every hit is at the interface of the crystal and the diode, no
/// earlier than the straight path at c / 1.79 allows.
#[test]
fn the_guide() {
    let bench = bench();
    let arguments: Vec<&str> = block("sh").split_whitespace().skip(1).collect();
    assert!(bench.says(&arguments).contains("20000 photons"));
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
    assert_eq!(found["sensors"], serde_json::json!({ "Diode": found["hits"] }));
    assert!(rows.len() > 50, "{}", rows.len());
    let number = |text: &str| text.parse::<f64>().unwrap();
    for row in &rows {
        assert!((number(row[4]) - 50.0).abs() < 1e-12, "{row:?}");
        assert!(number(row[5]) >= 50.0 * 1.79 / 299.792_458 * (1.0 - 1e-12), "{row:?}");
        assert_eq!(row[14], "Diode");
    }
}

/// A second diode at the other end, whose boundary has no surface: it is listed with 0 hits.
#[test]
fn hits_are_counted_by_sensor() {
    let bench = bench_of_two_diodes();
    let found = bench.json(&run(&["--json"]));
    let sensors = found["sensors"].as_object().unwrap();
    assert_eq!(sensors.len(), 2, "{found}");
    let mut counts: Vec<u64> = sensors.values().filter_map(Value::as_u64).collect();
    counts.sort_unstable();
    assert_eq!(counts, [0, found["hits"].as_u64().unwrap()]);
    let said = bench.says(&run(&[]));
    let row = |path: &String| said.lines().find(|line| line.starts_with(path.as_str())).map(str::to_owned);
    for (path, count) in sensors {
        let row = row(path).unwrap_or_else(|| panic!("{path} is not in\n{said}"));
        assert_eq!(row.split_whitespace().nth(1), Some(count.to_string().as_str()), "{row}");
        // the fraction of the 2,000 photons with the binomial standard deviation
        let fraction = count.as_f64().unwrap() / 2000.0;
        let error = (fraction * (1.0 - fraction) / 2000.0).sqrt();
        let own = &found["sensor_fractions"][path];
        assert_eq!(own["fraction"].as_f64(), Some(fraction), "{own}");
        assert!((own["error"].as_f64().unwrap() - error).abs() < 1e-15, "{own}");
        let [percent, bound] = [3, 4].map(|k| row.split_whitespace().nth(k).unwrap());
        if *count == 0 {
            assert_eq!([percent, bound], ["0", "-"], "{row}");
            continue;
        }
        let [percent, bound] = [percent, bound].map(|text| text.parse::<f64>().unwrap());
        // two digits of the error
        assert!((bound - 100.0 * error).abs() <= 0.05 * bound, "{row}");
        assert!((percent - 100.0 * fraction).abs() <= 0.05 * bound, "{row}");
    }
    // the statistical error of a single sensor, too
    bench.write("bar.gdml", block("xml"));
    let single = bench.says(&run(&[]));
    let row: Vec<&str> =
        single.lines().find(|line| line.starts_with("Diode")).unwrap().split_whitespace().collect();
    let [hits, _, percent, error] = [1, 2, 3, 4].map(|k| row[k].parse::<f64>().unwrap());
    let part = hits / 2000.0;
    assert!((percent - 100.0 * part).abs() < 0.01, "{single}");
    assert!((error - 100.0 * (part * (1.0 - part) / 2000.0).sqrt()).abs() < 0.05 * error, "{single}");
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
    assert!(
        fails(2, &["--json", "-o", "-"])
            .contains("several results go to standard output: `-` is given more than once")
    );
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
    let reason = "the model has no optical properties: it has neither a table [photons] nor a table [gdml].";
    assert!(bench.fails(3, &plain).contains(reason));
}

/// An NPY file of numbers.
fn npy(descr: &str, shape: &str, bytes: impl IntoIterator<Item = u8>) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.bytes());
    file.extend(bytes);
    file
}

fn singles(numbers: &[f32]) -> impl Iterator<Item = u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes())
}

/// All kinds of sources run, with their distributions, and report which required options are missing.
#[test]
fn sources() {
    let bench = bench();
    bench.write("lines.csv", "wavelength_nm,density\n500,0\n550,2\n600,0\n");
    let run = |text: &str| {
        let base = ["photons", "bar.gdml", "-n", "500"];
        base.into_iter().chain(text.split_whitespace()).map(str::to_owned).collect::<Vec<String>>()
    };
    let says = |text: &str| {
        let arguments = run(&format!("{text} -o -"));
        bench.says(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let fails = |text: &str| {
        let arguments = run(text);
        bench.fails(2, &arguments.iter().map(String::as_str).collect::<Vec<_>>())
    };
    for text in [
        "--source disc --at 0,0,0 --radius 5 --towards 0,0,1 --cone 30 --wavelength 500:600",
        "--source line --at 0,0,-40 --to 0,0,40 --spectrum lines.csv --time 5:10",
        "--source volume --volume Bar --wavelength 500:600 --black-body 5000 --time-deviation 0.1",
        "--source surface --volume Bar --wavelength 550 --time-decay 100 --polarisation 1,0,0",
    ] {
        let table = says(text);
        assert!(table.lines().count() > 20, "{text}: {table}");
        let wavelengths =
            table.lines().skip(1).map(|row| row.split(',').nth(12).unwrap().parse::<f64>().unwrap());
        assert!(wavelengths.clone().all(|nm| (500.0..=600.0 + 1e-9).contains(&nm)), "{text}");
    }
    let events = |event: &str| says(&format!("--at 0,0,0 --wavelength 550 --event {event}"));
    assert!(events("7").lines().skip(1).all(|row| row.starts_with("7,")));
    let photons = |table: String| table.lines().map(|row| row[2..].to_owned()).collect::<Vec<_>>();
    assert_ne!(photons(events("7")), photons(events("8")));
    for (text, reason) in [
        ("--wavelength 550", "--at is missing: the source `point` needs it."),
        ("--at 0,0,0", "the wavelength is missing"),
        ("--at 0,0,0 --scintillation Crystl", "Did you mean `Crystal`?"),
        ("--at 0,0,0 --scintillation Crystal", "the material `Crystal` has no scintillation light"),
        ("--source disc --at 0,0,0 --radius 5 --wavelength 550", "--normal is missing"),
        ("--source volume --volume Baar --wavelength 550", "Did you mean `Bar`?"),
        ("--at 0,0,0 --wavelength 600:500", "A at most B"),
        ("--at 0,0,0 --radius 3 --wavelength 550", "--radius has no effect on the source `point`."),
        ("--at 0,0,90 --wavelength 550", "in the volume `World` of material `Opaque`, which has no RINDEX"),
        ("--at 0,0,900 --wavelength 550", "is outside the world"),
    ] {
        let message = fails(text);
        assert!(message.contains(reason), "{text}: {message}");
    }
    bench.write("bad.csv", "500,1\n550\n");
    let bad = ["photons", "bar.gdml", "--at", "0,0,0", "--spectrum", "bad.csv"];
    assert!(bench.fails(3, &bad).contains("bad.csv: line 2: two numbers are needed"));
    // a device states no size and never ends
    #[cfg(unix)]
    {
        let endless = ["photons", "bar.gdml", "--at", "0,0,0", "--spectrum", "/dev/zero"];
        assert!(bench.fails(3, &endless).contains("the spectrum has more than 67108864 bytes"));
    }
}

/// Gensteps and photons from arrays; the number of photons is that of the file.
#[test]
fn arrays() {
    let bench = bench();
    let bits = |integer: u32| f32::from_bits(integer);
    let mut step = vec![bits(15), bits(1), bits(4), bits(400), 0.0, 0.0, -20.0, 2.0, 0.0, 0.0, 40.0, 40.0];
    step.extend([bits(11), -1.0, 1.0, 290.0, 1.03, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 290.0]);
    bench.write("steps.npy", npy("<f4", "(1, 6, 4)", singles(&step)));
    let run = |more: &[&str]| {
        let arguments = ["photons", "bar.gdml", "--gensteps", "steps.npy"];
        arguments.into_iter().chain(more.iter().copied()).map(str::to_owned).collect::<Vec<String>>()
    };
    let text = |arguments: &[String]| arguments.iter().map(String::as_str).collect::<Vec<_>>().join(" ");
    let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<String>>();
    let done = |more: &[&str]| {
        let line = text(&run(more));
        let words = words(&line);
        bench.run(&words.iter().map(String::as_str).collect::<Vec<_>>())
    };
    let whole = done(&["--json", "--quiet"]);
    let found: Value = serde_json::from_str(&whole.out).unwrap();
    assert_eq!(found["photons"], 400, "{}", whole.err);
    assert!(found["hits"].as_u64().unwrap() > 10);
    // the number of the only genstep is the last column
    let table = done(&["-o", "-", "--quiet"]).out;
    assert!(table.lines().next().unwrap().ends_with(",sensor,genstep"), "{table}");
    assert!(table.lines().skip(1).all(|row| row.ends_with(",0")), "{table}");
    let sequences = done(&["--sequences", "--quiet", "--json"]).out;
    assert!(sequences.contains("CK ") && !sequences.contains("TO"), "{sequences}");
    assert_eq!(done(&["--material", "4=Crystal", "-o", "-"]).out, done(&["-o", "-", "--quiet"]).out);
    assert!(done(&["--material", "4=Water"]).err.contains("no material is called `Water`"));
    assert!(done(&["-n", "401"]).err.contains("-n is 401: the source has 400 photons."));
    assert!(done(&["--at", "0,0,0"]).err.contains("cannot be used with"));
    let photon = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 0.0, 0.0, 550.0, 0.0, 0.0, 0.0, 0.0];
    bench.write("photons.npy", npy("<f4", "(1, 4, 4)", singles(&photon)));
    let given = ["photons", "bar.gdml", "--photons", "photons.npy", "--json"];
    assert_eq!(bench.json(&given)["photons"], 1);
    bench.write("flat.npy", npy("<f4", "(16,)", singles(&photon)));
    let flat = ["photons", "bar.gdml", "--photons", "flat.npy"];
    let message = bench.fails(3, &flat);
    assert!(
        message.contains("flat.npy: the array of photons has shape (16,): it must be (N, 4, 4)."),
        "{message}"
    );
    let flat = ["photons", "bar.gdml", "--gensteps", "flat.npy"];
    assert!(
        bench
            .fails(3, &flat)
            .contains("flat.npy: the array of gensteps has shape (16,): it must be (N, 6, 4) or (N, 16).")
    );
    let ints = ["photons", "bar.gdml", "--gensteps", "ints.npy"];
    bench.write("ints.npy", npy("<i4", "(1, 6, 4)", singles(&step)));
    assert!(bench.fails(3, &ints).contains("its numbers are <i4: they must be float32 or float64."));
    bench.write("empty.npy", Vec::new());
    let empty = bench.fails(3, &["photons", "bar.gdml", "--gensteps", "empty.npy"]);
    assert!(empty.ends_with("empty.npy: the file is empty: an NPY header is required.\n"), "{empty}");
    let missing = bench.fails(3, &["photons", "bar.gdml", "--gensteps", "step.npy"]);
    assert!(missing.ends_with("step.npy: there is no such file. Did you mean `steps.npy`?\n"), "{missing}");
}

/// The native model of the guide has the hits of the GDML file.
#[test]
fn native_models() {
    let bench = bench();
    bench.write("bar.toml", block("toml"));
    let run = |model: &str| {
        let source = ["--at", "0,0,0", "--wavelength", "550", "-n", "2000", "-o", "-"];
        let arguments: Vec<&str> = ["photons", model].into_iter().chain(source).collect();
        let numbers = |row: &str| row.rsplit_once(',').map(|(numbers, _)| numbers.to_owned());
        bench.says(&arguments).lines().filter_map(numbers).collect::<Vec<String>>()
    };
    let native = run("bar.toml");
    assert!(native.len() > 50);
    assert_eq!(native, run("bar.gdml"));
    for (from, to, place, reason) in [
        ("RINDEX = 1.79", "RINDEX = -1", "bar.toml:26:1", "it has the value -1: it must be positive"),
        ("\"bar\", \"diode\"", "\"bar\", \"dioda\"", "bar.toml:43:19", "Did you mean `diode`?"),
        ("unified", "unifide", "bar.toml:31:9", "the model `unifide` of optical surface `wrapping`"),
        ("[400, 400]", "[400]", "bar.toml:27:38", "`ABSLENGTH` has 2 numbers in `eV` and 1 in `value`"),
        ("skin", "skins", "bar.toml:35:1", "Did you mean `skin`?"),
        ("unit = \"mm\"", "unit = \"cm\"", "bar.toml:", "not in millimetres"),
        ("[photons.medium.crystal]", "[photons.medium.cristal]", "bar.toml:25:17", "Did you mean `crystal`?"),
    ] {
        bench.write("bar.toml", block("toml").replacen(from, to, 1));
        let bad = ["photons", "bar.toml", "--at", "0,0,0", "--wavelength", "550"];
        let message = bench.fails(3, &bad);
        assert!(message.contains(place) && message.contains(reason), "{message}");
    }
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
    // photons absorbed on their first segment: the absorption length is 400 mm, much longer than the segment
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
    assert!(bench.fails(2, &run(&["--draw", "a.gif"])).contains(".png or .jpg"));
    assert!(bench.fails(2, &run(&["--draw", "-", "--map", "-"])).contains("`-` is given more than once"));
    assert!(bench.fails(2, &run(&["--plane", "yz"])).contains("--draw"));
    assert!(bench.read("m.svg").contains(">x / mm<") && bench.read("m.svg").contains(">y / mm<"));
    bench.says(&run(&["--map", "side.svg", "--map-plane", "xz"]));
    assert!(bench.read("side.svg").contains(">z / mm<") && !bench.read("side.svg").contains(">y / mm<"));
    assert!(bench.fails(2, &run(&["--map-plane", "yz"])).contains("--map"));
    let text = bench.fails(2, &run(&["--map", "m.svg", "--map-plane", "up"]));
    assert!(text.contains("it must be yz, xz, xy or sphere"), "{text}");
    // the diode from -10 to 10: a cell, and three by three
    let cells = |name: &str| {
        let map = bench.read(name);
        map.lines()
            .filter(|line| line.contains("<path class=\"cell\""))
            .map(|line| line.matches('Z').count())
            .sum::<usize>()
    };
    bench.says(&run(&["--map", "three.svg", "--map-bins", "3"]));
    assert_eq!(cells("three.svg"), 9);
    assert!([">\u{2212}10<", ">10<"].iter().all(|tick| bench.read("three.svg").contains(tick)));
    assert!(bench.fails(2, &run(&["--map", "m.svg", "--map-bins", "0"])).contains("1 to 1023"));
    assert!(bench.fails(2, &run(&["--map-bins", "3"])).contains("--map"));
}

/// Drawings of a merged table are those of the whole run, byte for byte.
#[test]
fn drawings_of_tables_of_hits() {
    let bench = bench_of_two_diodes();
    let whole = run(&["--map", "map.svg", "--spectra", "spectra.svg", "-o", "hits.csv"]);
    bench.says(&whole);
    for (range, part) in [("0:700", "a.npy"), ("700:2000", "b.npy")] {
        bench.says(&run(&["--range", range, "-o", part]));
    }
    bench.says(&["merge", "a.npy", "b.npy", "-o", "merged.npy"]);
    for hits in ["merged.npy", "hits.csv"] {
        bench.says(&["photons", "draw", "bar.gdml", hits, "--map", "again.svg", "--spectra", "times.svg"]);
        assert_eq!(bench.read("again.svg"), bench.read("map.svg"));
        assert_eq!(bench.read("times.svg"), bench.read("spectra.svg"));
    }
    let message = bench.fails(2, &["photons", "draw", "bar.gdml", "hits.csv"]);
    assert!(message.contains("--map") && message.contains("--spectra"), "{message}");
    bench.says(&run(&["--steps", "steps.csv"]));
    let message = bench.fails(3, &["photons", "draw", "bar.gdml", "steps.csv", "--map", "m.svg"]);
    assert!(message.contains("steps.csv is not a table of hits: it has no column `event`"), "{message}");
}

/// Every track in the drawing ends with a mark of detection, where some 5 % of the photons are detected.
#[test]
fn tracks_of_detected_photons() {
    let bench = bench();
    bench.says(&run(&["--draw", "all.svg", "--tracks", "20"]));
    bench.says(&run(&["--draw", "detected.svg", "--draw-detected", "--tracks", "20"]));
    // the marks, and one in the legend
    let marks = |name: &str| bench.read(name).matches("class=\"mark\"").count();
    assert!(marks("all.svg") < 10, "{}", bench.read("all.svg"));
    assert!(marks("detected.svg") >= 20, "{}", bench.read("detected.svg"));
    assert!(bench.fails(2, &run(&["--draw-detected"])).contains("--draw"));
}

/// The array of Opticks has the hits of the table. Its masks have the flags of the sequences if histories are recorded.
#[test]
fn hits_as_photons_of_opticks() {
    let bench = bench();
    let array = |more: &[&str]| {
        let arguments = [&["-o", "hits.npy", "--layout", "opticks", "--json"][..], more].concat();
        bench.json(&run(&arguments));
        let bytes = bench.bytes("hits.npy");
        let (header, data) = bytes.split_at(128);
        let words: Vec<u32> =
            data.chunks(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect();
        let shape = format!("'descr': '<f4', 'fortran_order': False, 'shape': ({}, 4, 4,)", words.len() / 16);
        assert!(String::from_utf8_lossy(header).contains(&shape), "{header:?}");
        words.chunks(16).map(|photon| photon.try_into().unwrap()).collect::<Vec<[u32; 16]>>()
    };
    bench.json(&run(&["--json", "-o", "hits.csv", "--histories", "histories.csv"]));
    let table = bench.read("hits.csv");
    let rows: Vec<Vec<&str>> = table.lines().skip(1).map(|line| line.split(',').collect()).collect();
    let (plain, marked) = (array(&[]), array(&["--counts"]));
    assert_eq!((plain.len(), marked.len()), (rows.len(), rows.len()));
    assert!(rows.len() > 50, "{}", rows.len());
    let histories = bench.read("histories.csv");
    let flag = |process: &str| match process {
        "emission" => 1 << 12,
        "fresnel_refraction" => 1 << 11,
        "fresnel_reflection" | "total_internal_reflection" => 1 << 10,
        "spike_reflection" => 1 << 9,
        "lambertian_reflection" => 1 << 8,
        "detected" => 1 << 6,
        _ => panic!("{process}"),
    };
    for ((row, own), marked) in rows.iter().zip(&plain).zip(&marked) {
        let single = |column: usize| row[column].parse::<f32>().unwrap().to_bits();
        let floats = [2, 3, 4, 5, 6, 7, 8].map(single);
        assert_eq!(floats, own[..7]);
        assert_eq!([9, 10, 11, 12].map(single), own[8..12]);
        // the index of the instance, the flag, the sensor plus 1, the photon, the mask
        let photon: u32 = row[1].parse().unwrap();
        assert_eq!([own[7], own[12], own[13], own[14], own[15]], [0, 64, 1, photon, 64]);
        assert_eq!(own[..15], marked[..15]);
        let history = histories.lines().find(|line| line.starts_with(&format!("{photon},"))).unwrap();
        let processes = history.split(',').nth(3).unwrap().split(' ');
        assert_eq!(marked[15], processes.map(flag).fold(0, |mask, flag| mask | flag), "{history}");
    }
    assert!(bench.fails(2, &run(&["-o", "hits.csv", "--layout", "opticks"])).contains("ends with .npy"));
    assert!(bench.fails(2, &run(&["-o", "-", "--layout", "opticks"])).contains("ends with .npy"));
    assert!(bench.fails(2, &run(&["--layout", "opticks"])).contains("--out"));
}

/// A note of a run without hits states the number of mistakes that `check` finds, or that it finds none.
#[test]
fn the_note_of_a_dark_run_is_true() {
    let bench = bench();
    let arguments = ["photons", "bar.gdml", "--at", "0,0,0", "--wavelength", "550", "-n", "200"];
    let border = r#"<bordersurface name="end" surfaceproperty="Cathode"><physvolref ref="bar"/><physvolref ref="diode"/></bordersurface>"#;
    assert!(block("xml").contains(border));
    for (skin, expected, kinds) in [
        // the skin of the diode, beside a bar with a skin, never acts
        (
            r#"<skinsurface name="end" surfaceproperty="Cathode"><volumeref ref="Diode"/></skinsurface>"#,
            true,
            "optical",
        ),
        // a bar without a detector
        ("", false, ""),
    ] {
        let sensor = r#"<volume name="Diode"><auxiliary auxtype="SensDet" auxvalue="d"/>"#;
        let text = block("xml").replace(border, skin);
        bench.write(
            "bar.gdml",
            if skin.is_empty() { text } else { text.replace(r#"<volume name="Diode">"#, sensor) },
        );
        let said = bench.run(&arguments).err;
        let found = bench.json(&["check", "bar.gdml", "--json"]);
        let count = found["findings"].as_array().unwrap().iter().filter(|own| own["kind"] == kinds).count();
        assert_eq!(count > 0, expected, "{found}");
        assert!(said.contains("no photon is detected"), "{said}");
        assert_eq!(said.contains("reports no probable mistake"), !expected, "{said}");
        if expected {
            let number = if count == 1 {
                "1 probable mistake ".to_owned()
            } else {
                format!("{count} probable mistakes")
            };
            assert!(said.contains(&number), "{said}");
        }
    }
}

/// An undefined reference, at which Geant4 stops: the run is refused with its place, `check` lists it, and --allow-missing goes on.
#[test]
fn undefined_references_are_refused() {
    let bench = bench();
    let (from, to) = (r#"surfaceproperty="Cathode""#, r#"surfaceproperty="Cathodes""#);
    assert!(block("xml").contains(from));
    bench.write("bar.gdml", block("xml").replace(from, to));
    let said = bench.fails(3, &run(&[]));
    assert!(
        said.contains("unknown optical surface `Cathodes`") && said.contains("Did you mean `Cathode`?"),
        "{said}"
    );
    assert!(said.contains("bar.gdml:") && said.contains("a reference names nothing in the file"), "{said}");
    let allowed = bench.run(&run(&["--json", "--allow-missing"]));
    assert!(allowed.err.contains("warning: unknown optical surface `Cathodes`"), "{}", allowed.err);
    assert!(!allowed.err.contains("no probable mistake"), "{}", allowed.err);
    assert_eq!(serde_json::from_str::<serde_json::Value>(&allowed.out).unwrap()["hits"], 0);
    let found = bench.json(&["check", "bar.gdml", "--json", "-q"]);
    let texts = found["findings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|own| own["text"].as_str().unwrap_or_default().to_owned());
    assert_eq!(
        texts.filter(|text| text.contains("unknown optical surface `Cathodes`")).count(),
        1,
        "{found}"
    );
}

/// The run notes a daughter that extends beyond its mother with the words of the check.
#[test]
fn protruding_daughters_are_noted() {
    let bench = bench();
    let text = block("xml");
    let diode = r#"z="50.5""#;
    assert!(text.contains(diode));
    assert!(!bench.run(&run(&[])).err.contains("extends beyond"));
    // the diode, half outside the hall
    bench.write("bar.gdml", text.replace(diode, r#"z="100""#));
    let said = bench.run(&run(&[])).err;
    let found = bench.json(&["check", "bar.gdml", "--json"]);
    let outside = found["findings"].as_array().unwrap().iter().find(|own| own["kind"] == "outside").unwrap();
    let note = format!("note: {}: it replaces what is there", outside["text"].as_str().unwrap());
    assert!(said.contains(&note), "{said}");
    assert!(!bench.run(&run(&["--quiet"])).err.contains("extends beyond"));
}

/// A wrapping of the `LUT` model needs its table; a source outside all volumes is an error.
#[test]
fn measured_surfaces_and_outer_sources() {
    let bench = bench();
    let wrapped = block("xml").replace(
        r#"finish="groundfrontpainted" type="dielectric_dielectric""#,
        r#"finish="groundtyvekair" type="dielectric_LUT""#,
    );
    bench.write("wrapped.gdml", &wrapped);
    let run = ["photons", "wrapped.gdml", "--at", "0,0,0", "--wavelength", "550", "-n", "100", "--json"];
    assert!(bench.fails(3, &run).contains("data set RealSurface with GroundTyvek.z"));
    // the check needs the table as well
    let check = ["check", "wrapped.gdml", "--cells", "4", "--json"];
    let missing = bench.says(&check);
    assert!(missing.contains("RealSurface with GroundTyvek.z"), "{missing}");
    bench.write("GroundTyvek.dat", "1 ".repeat(151_515));
    let with: Vec<&str> = run.into_iter().chain(["--surface-tables", "."]).collect();
    assert_eq!(bench.json(&with)["photons"], 100);
    let with: Vec<&str> = check.into_iter().chain(["--surface-tables", "."]).collect();
    let found = bench.says(&with);
    assert!(!found.contains("RealSurface"), "{found}");
    let outside = ["photons", "bar.gdml", "--at", "0,0,500", "--wavelength", "550", "-n", "10"];
    assert!(bench.fails(2, &outside).contains("the source at [0, 0, 500] is outside the world"));
}
