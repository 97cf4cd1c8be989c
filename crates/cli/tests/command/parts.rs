//! `--range`, `--resume` and `merge`: parts computed by separate processes, in any order, with any number of threads, make up the
//! bytes of the whole; killed runs leave no part.

use crate::bench::{Bench, RAYS};
use crate::{optics, photons};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use serde_json::Value;

/// Rays along x at heights y from -1.5 to 1.5.
fn fan(count: usize) -> String {
    let line = |k: usize| format!("-5,{},0,2,0,0\n", 3.0 * (k as f64 + 0.5) / count as f64 - 1.5);
    RAYS.to_owned() + &(0..count).map(line).collect::<String>()
}

/// Random cuts of `0..total` at multiples of `step`.
fn cuts(random: &mut ChaCha8Rng, total: u64, step: u64) -> Vec<u64> {
    let mut cuts: Vec<u64> =
        (0..random.random_range(1..5)).map(|_| random.random_range(0..total.div_ceil(step)) * step).collect();
    cuts.extend([0, total]);
    cuts.sort_unstable();
    cuts
}

/// Runs the command for random slicings and compares the merged tables with those of the whole. `tables` are options with names of
/// tables.
fn slicings(
    bench: &Bench,
    arguments: &[&str],
    tables: &[(&str, &str)],
    (total, step): (u64, u64),
    times: u64,
) {
    let run = |prefix: &str, more: &[&str]| {
        let names: Vec<String> = tables.iter().map(|(_, name)| format!("{prefix}-{name}")).collect();
        let options = tables.iter().zip(&names).flat_map(|((option, _), name)| [*option, name.as_str()]);
        let all: Vec<&str> = arguments.iter().copied().chain(options).chain(more.iter().copied()).collect();
        bench.says(&all);
    };
    run("whole", &[]);
    let mut random = ChaCha8Rng::seed_from_u64(17);
    for time in 0..times {
        let cuts = cuts(&mut random, total, step);
        for (k, cut) in cuts.windows(2).enumerate() {
            let (range, threads) = (format!("{}:{}", cut[0], cut[1]), random.random_range(1..4).to_string());
            run(&format!("part{k}"), &["--range", &range, "--threads", &threads, "-q"]);
        }
        for (_, name) in tables {
            let parts: Vec<String> = (0..cuts.len() - 1).rev().map(|k| format!("part{k}-{name}")).collect();
            let merge = ["merge"].into_iter().chain(parts.iter().map(String::as_str));
            let merged = format!("merged-{name}");
            bench.says(&merge.chain(["-o", &merged]).collect::<Vec<_>>());
            let whole = format!("whole-{name}");
            assert!(bench.bytes(&merged) == bench.bytes(&whole), "{name}, slicing {time}: {cuts:?}");
            // a table without texts has no names
            if name.ends_with(".npy") && bench.path(&whole.replace(".npy", ".names.json")).exists() {
                let names = [&merged, &whole].map(|name| bench.bytes(&name.replace(".npy", ".names.json")));
                assert!(names[0] == names[1], "names of {name}, slicing {time}: {cuts:?}");
            }
        }
    }
}

#[test]
fn tables_of_crossings() {
    let bench = Bench::new();
    bench.write("rays.csv", fan(5000));
    for table in ["hits.csv", "hits.npy"] {
        let arguments = ["trace", "cemented.toml", "--rays", "rays.csv", "--occurrence"];
        slicings(&bench, &arguments, &[("-o", table)], (5000, 1), 4);
    }
    let with = |rays| ["trace", "cemented.toml", "--rays", rays, "-o", "x.csv", "--range", "0:2"];
    assert!(bench.fails(2, &with("-")).contains("the other rays of a stream are not known"));
    assert!(bench.fails(3, &with("missing.csv")).contains("cannot read missing.csv"));
}

#[cfg(feature = "parquet")]
#[test]
fn tables_of_crossings_in_parquet() {
    let bench = Bench::new();
    bench.write("rays.csv", fan(5000));
    let arguments = ["trace", "cemented.toml", "--rays", "rays.csv", "--occurrence"];
    slicings(&bench, &arguments, &[("-o", "hits.parquet")], (5000, 1), 3);
}

#[test]
fn tables_of_photons() {
    let bench = photons::bench();
    let tables = [("-o", "hits.npy"), ("--steps", "steps.npy"), ("--histories", "histories.csv")];
    slicings(&bench, &photons::run(&["--seed", "3"]), &tables, (2000, 1), 4);
}

/// The counts of parts add up to the summary of the whole; those of processes only if all parts have them.
#[test]
fn counts_of_photons() {
    let bench = photons::bench();
    let run = |more: &[&str]| bench.says(&photons::run(&[&["--seed", "3"], more].concat()));
    let whole: Value = serde_json::from_str(&run(&["--json", "--counts"])).expect("a summary");
    for (range, out) in [("0:700", "a.csv"), ("700:900", "b.csv"), ("900:2000", "c.csv")] {
        run(&["--range", range, "-o", out, "--counts", "-q"]);
    }
    let merge = |parts: &[&str]| bench.says(&[&["merge"], parts, &["-o", "all.csv", "--json"]].concat());
    let merged: Value = serde_json::from_str(&merge(&["c.csv", "a.csv", "b.csv"])).expect("counts");
    for name in ["photons", "hits", "steps", "ends", "sensors", "processes"] {
        assert!(!whole[name].is_null() && merged[name] == whole[name], "{name}: {merged:#}");
    }
    assert_eq!(merged["parts"], 3);
    run(&["--range", "700:900", "-o", "b.csv", "-q"]);
    let text = bench.says(&["merge", "a.csv", "b.csv", "c.csv", "-o", "all.csv"]);
    assert!(text.contains("all.csv: 3 parts") && text.contains("2000 photons"), "{text}");
    let mixed: Value = serde_json::from_str(&merge(&["a.csv", "b.csv", "c.csv"])).expect("counts");
    assert_eq!((&mixed["ends"], &mixed["processes"]), (&whole["ends"], &Value::Null));
}

/// Rays are cut at multiples of 2048; the numbers of parents count the rows of the whole.
#[test]
fn tables_of_light() {
    let bench = Bench::new();
    bench.write("plate.toml", optics::PLATE.replace("rays = 5000", "rays = 9000"));
    for table in ["light.csv", "light.npy"] {
        let arguments = ["optics", "plate.toml", "--branches", "random"];
        slicings(&bench, &arguments, &[("--out", table)], (9000, 2048), 2);
    }
    let unaligned = ["optics", "plate.toml", "--out", "x.csv", "--range", "0:1000"];
    assert!(bench.fails(3, &unaligned).contains("start and end at multiples of 2048 or at 9000"));
    assert!(bench.fails(2, &["optics", "plate.toml", "--range", "0:2048"]).contains("--out"));
}

/// The model of a part is that of the document: comments do not matter, numbers and files of rays do. In debug builds, the hash of
/// compiled geometry, which depends on the processor, is refused.
#[test]
fn models_of_parts_are_documents() {
    let bench = Bench::new();
    let text = optics::PLATE.replace("beam = { circle = 20, rays = 5000 }", "rays = { file = 'rays.csv' }");
    let is_done = |text: &str, x: f64| {
        bench.write("plate.toml", text);
        bench.write("rays.csv", format!("{RAYS}{x},0,-10,0,0,1\n"));
        let done = bench.run(&["optics", "plate.toml", "--out", "light.csv", "--range", "0:1", "--resume"]);
        assert_eq!(done.code, 0, "{}", done.err);
        done.err.contains("complete already")
    };
    assert!(!is_done(&text, 0.0));
    assert!(is_done(&format!("# a comment\n{text}"), 0.0));
    assert!(!is_done(&text, 1.0));
    assert!(!is_done(&text.replace("[60, 60, 2]", "[60, 60, 3]"), 1.0));
    assert!(!is_done(&text.replace("thin_lens = 40", "thin_lens = 50"), 1.0));
    let bench = photons::bench_of_two_diodes();
    let opaque = r#"name="Diode"><materialref ref="Opaque"/>"#;
    bench.write("bar.gdml", bench.read("bar.gdml").replace(opaque, &opaque.replace("Opaque", "Crystal")));
    let copy = ["photons", "bar.gdml", "--source", "volume", "--volume", "Diode[7]", "--wavelength", "550"];
    let part = [&copy[..], &["-n", "200", "--range", "0:100", "-o", "hits.csv", "--resume"]].concat();
    assert_eq!(bench.run(&part).code, 0);
    assert!(bench.run(&part).err.contains("complete already"));
}

#[test]
fn rows_of_pixels() {
    let bench = Bench::new();
    let arguments = ["render", "cemented.toml", "--size", "97x83", "--shading", "gooch"];
    slicings(&bench, &arguments, &[("-o", "picture.png")], (83, 1), 0);
    let mut random = ChaCha8Rng::seed_from_u64(3);
    for _ in 0..6 {
        let mut cuts = cuts(&mut random, 83, 1);
        cuts.dedup();
        let mut merge = vec!["merge".to_owned()];
        for (k, cut) in cuts.windows(2).enumerate() {
            let (range, name) = (format!("{}:{}", cut[0], cut[1]), format!("rows{k}.png"));
            bench.says(&[&arguments[..], &["--range", &range, "-o", &name, "-q"]].concat());
            merge.push(name);
        }
        merge.extend(["-o", "merged.png"].map(str::to_owned));
        bench.says(&merge.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(bench.bytes("merged.png") == bench.bytes("whole-picture.png"), "{cuts:?}");
    }
    assert!(bench.fails(2, &["render", "ball.toml", "--range", "0:10000"]).contains("rows of pixels"));
    let sheet = ["render", "ball.toml", "--view", "sheet", "--range", "0:10"];
    assert!(bench.fails(2, &sheet).contains("rows of one picture"));
}

#[test]
fn tables_of_thickness() {
    let bench = Bench::new();
    let arguments = ["thickness", "cemented.toml", "--size", "31x40"];
    slicings(&bench, &arguments, &[("-o", "lengths.npy")], (40, 1), 3);
    assert!(
        bench.fails(2, &["thickness", "ball.toml", "-o", "t.png", "--range", "0:4"]).contains("grey levels")
    );
}

/// Sums over cells: the merged file is that of one run, and the report that of a run without parts.
#[test]
fn sums_of_volumes() {
    let bench = Bench::new();
    for total in ["0", "5"] {
        assert!(bench.fails(2, &["volume", "ball.toml", "--total", total]).contains("--total"));
    }
    // 3 * 40^2 cells
    let arguments = ["volume", "cemented.toml", "--total", "9600", "--precision", "0.5", "--seed", "4"];
    bench.says(&[&arguments[..], &["--range", "0:4800", "-o", "whole.sums"]].concat());
    let mut random = ChaCha8Rng::seed_from_u64(11);
    for _ in 0..4 {
        let cuts = cuts(&mut random, 4800, 1);
        let mut merge = vec!["merge".to_owned()];
        for (k, cut) in cuts.windows(2).enumerate() {
            let (range, name) = (format!("{}:{}", cut[0], cut[1]), format!("{k}.sums"));
            let threads = random.random_range(1..4).to_string();
            bench.says(&[&arguments[..], &["--range", &range, "-o", &name, "--threads", &threads]].concat());
            merge.insert(1, name);
        }
        merge.extend(["-o", "merged.sums"].map(str::to_owned));
        bench.says(&merge.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(bench.bytes("merged.sums") == bench.bytes("whole.sums"), "{cuts:?}");
    }
    let json = |more: &[&str]| bench.json(&[&arguments[..], &["--json"], more].concat());
    let found = json(&["--sums", "merged.sums"]);
    assert_eq!(found, json(&[]));
    for (region, volume) in [(1, 8.0), (2, 12.0)] {
        let own = &found["regions"][region]["volume"];
        let [value, width] = ["value", "half_width"].map(|name| own[name].as_f64().unwrap());
        assert!((value - volume).abs() <= width && width < 0.2 * volume, "{own}");
    }
    let other = ["volume", "cemented.toml", "--total", "9600", "--seed", "5", "--sums", "merged.sums"];
    let text = bench.fails(3, &other);
    assert!(text.contains("merged.sums has other sums"), "{text}");
}

/// Parts of other models, seeds and settings are refused; missing ranges are listed and computed; complete parts are not computed again.
#[test]
fn missing_ranges_are_computed() {
    let bench = photons::bench();
    let run = |range: &str, out: &str, more: &[&str]| {
        let all = [photons::run(&["--range", range, "-o", out]), more.to_vec()].concat();
        bench.run(&all)
    };
    for (range, out) in [("0:500", "a.csv"), ("1200:2000", "c.csv")] {
        assert_eq!(run(range, out, &[]).code, 0);
    }
    let parts = ["a.csv", "b.csv", "c.csv"];
    let missing = || bench.says(&[&["merge", "--missing", "2000", "-q"], &parts[..]].concat());
    assert_eq!(missing(), "500:1200\n");
    let text = bench.fails(3, &["merge", "a.csv", "c.csv", "-o", "hits.csv"]);
    assert!(text.contains("the ranges 500:1200 of 2000 are missing"), "{text}");
    // a part that is cut short counts as missing
    let bytes = bench.bytes("c.csv");
    bench.write("c.csv", &bytes[..bytes.len() - 10]);
    assert_eq!(missing(), "500:2000\n");
    bench.write("c.csv", bytes);
    let modified = || bench.path("c.csv").metadata().unwrap().modified().unwrap();
    let before = modified();
    let done = run("1200:2000", "c.csv", &["--resume"]);
    assert!(
        done.code == 0 && done.err.contains("the part is complete already") && before == modified(),
        "{}",
        done.err
    );
    assert_eq!(run("500:1200", "b.csv", &["--resume", "--seed", "1"]).code, 0);
    let merge = ["merge", "a.csv", "b.csv", "c.csv", "-o", "hits.csv"];
    let text = bench.fails(3, &merge);
    assert!(
        text.contains("a.csv and b.csv are parts of different results: `seed` is 0 in the first and 1"),
        "{text}"
    );
    // --resume computes a part with other settings again
    assert_eq!(run("500:1200", "b.csv", &["--resume"]).code, 0);
    assert_eq!(missing(), "");
    bench.says(&merge);
    bench.says(&photons::run(&["-o", "whole.csv"]));
    assert_eq!(bench.bytes("hits.csv"), bench.bytes("whole.csv"));
    assert!(bench.fails(2, &["merge", "--missing", "999", "a.csv"]).contains("the parts are of 2000 items"));
    assert!(bench.fails(3, &["merge", "whole.csv", "-o", "x.csv"]).contains("the file is not a part"));
    assert!(bench.fails(2, &["merge", "a.csv"]).contains("--out"));
}

/// A run that is killed, twice, leaves no part or a complete one; computed again, the merged table is the whole.
#[test]
fn killed_runs_leave_no_part_or_a_complete_one() {
    let bench = photons::bench();
    let long = |range: &str, out: &str| {
        let all = [
            "photons",
            "bar.gdml",
            "--at",
            "0,0,0",
            "--wavelength",
            "550",
            "-n",
            "30000",
            "--range",
            range,
            "-o",
            out,
        ];
        bench.command(&all)
    };
    for delay in [10, 60] {
        let mut child = long("0:20000", "a.npy").spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(delay));
        // a run cannot react to this
        child.kill().unwrap();
        child.wait().unwrap();
        // the description is written last: a run that is killed after it has left a complete part
        if bench.files().contains(&"a.npy.part.json".to_owned()) {
            println!("the run was faster than the signal");
            assert_eq!(bench.says(&["merge", "--missing", "30000", "-q", "a.npy"]), "20000:30000\n");
        }
    }
    assert!(long("20000:30000", "b.npy").status().unwrap().success());
    let missing = bench.says(&["merge", "--missing", "30000", "-q", "a.npy", "b.npy"]);
    for range in missing.lines() {
        assert!(long(range, "a.npy").status().unwrap().success());
    }
    bench.says(&["merge", "b.npy", "a.npy", "-o", "hits.npy"]);
    assert!(long("0:30000", "whole.npy").status().unwrap().success());
    assert!(bench.bytes("hits.npy") == bench.bytes("whole.npy"));
}

/// Unmounts a file system at the end.
#[cfg(target_os = "linux")]
struct Mounted<'a>(&'a std::path::Path);

#[cfg(target_os = "linux")]
impl Drop for Mounted<'_> {
    fn drop(&mut self) {
        let _ = std::process::Command::new("umount").arg(self.0).status();
    }
}

/// A full disk is an error with the name of the file, and leaves no part.
#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_leaves_no_part() {
    let bench = photons::bench();
    let disk = bench.path("disk");
    std::fs::create_dir(&disk).unwrap();
    let mut mount = std::process::Command::new("mount");
    let mount = mount.args(["-t", "tmpfs", "-o", "size=16k", "tmpfs"]).arg(&disk).output();
    if !mount.is_ok_and(|done| done.status.success()) {
        rayweave_conformance::skipped("a file system can be mounted by root only");
        return;
    }
    let _mounted = Mounted(&disk);
    let done = bench.run(&photons::run(&["--range", "0:2000", "--steps", "disk/steps.csv"]));
    assert!(
        done.code == 1 && done.err.contains("cannot write disk/steps.csv"),
        "{}: {}",
        done.code,
        done.err
    );
    assert_eq!(std::fs::read_dir(&disk).unwrap().count(), 0);
}

/// Searches of a check: the merged file is that of one run over all searches, and the report with it that of a run without parts.
#[test]
fn searches_of_checks() {
    let bench = Bench::new();
    let mut model = "rayweave = 1\n".to_owned();
    for k in 0..6 {
        let (x, name) = (f64::from(k) * 1.5, format!("b{k}"));
        model += &format!("[solid._s{k}]\nsphere.radius = 1\n[solid._t{k}]\nsphere.radius = 0.5\n");
        model += &format!("[solid.{name}]\nexpr = \"_s{k} | _t{k}\"\ntransform.translate = [{x}, 0, 0]\n");
        model += &format!("[[region]]\nsolid = \"{name}\"\n");
    }
    bench.write("row.toml", model);
    let arguments = ["check", "row.toml", "--cells", "16", "--seed", "5"];
    let report = bench.json(&[&arguments[..], &["--json"]].concat());
    let kinds =
        |kind: &str| report["findings"].as_array().unwrap().iter().filter(|f| f["kind"] == kind).count();
    assert_eq!((kinds("overlap"), kinds("absorbed")), (5, 6));
    let said = bench.fails(2, &[&arguments[..], &["--range", "0:1000", "-o", "x"]].concat());
    let total: u64 = said.split("the check has ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(total > 10, "{said}");
    bench.says(&[&arguments[..], &["--range", &format!("0:{total}"), "-o", "whole.txt"]].concat());
    let mut random = ChaCha8Rng::seed_from_u64(29);
    for _ in 0..3 {
        let cuts = cuts(&mut random, total, 1);
        let mut merge = vec!["merge".to_owned()];
        for (k, cut) in cuts.windows(2).enumerate() {
            let (range, name) = (format!("{}:{}", cut[0], cut[1]), format!("searches{k}.txt"));
            let threads = random.random_range(1..4).to_string();
            let part = ["--range", &range, "-o", &name, "-q", "--threads", &threads];
            bench.says(&[&arguments[..], &part].concat());
            merge.push(name);
        }
        merge.extend(["-o", "merged.txt"].map(str::to_owned));
        bench.says(&merge.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(bench.bytes("merged.txt") == bench.bytes("whole.txt"), "{cuts:?}");
    }
    let merged = bench.json(&[&arguments[..], &["--searches", "merged.txt", "--json"]].concat());
    assert_eq!(merged, report);
    let other = ["check", "row.toml", "--cells", "16", "--seed", "6", "--searches", "merged.txt"];
    assert!(bench.fails(3, &other).contains("other searches"));
    let range = format!("0:{total}");
    let resumed = [&arguments[..], &["--range", &range, "-o", "whole.txt", "--resume"]].concat();
    assert!(bench.run(&resumed).err.contains("complete already"));
}
