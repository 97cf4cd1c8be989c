//! `photons compare`: tables that the command wrote.

use crate::bench::Bench;
use serde_json::Value;

const HISTORIES: &str = "photon,track,steps,history,volume,x,y,z,time,wavelength_nm\n";

/// A table of `photons` photons of which `absorbed` are absorbed.
fn table(photons: usize, absorbed: usize) -> String {
    let row = |photon: usize| {
        let end = if photon < absorbed { "absorbed,Tank" } else { "fresnel_refraction escaped,World" };
        format!("{photon},{photon},1,emission {end},0,0,0,{photon},400\n")
    };
    HISTORIES.to_owned() + &(0..photons).map(row).collect::<String>()
}

fn quantity<'a>(found: &'a Value, name: &str) -> &'a Value {
    found["quantities"].as_array().unwrap().iter().find(|own| own["name"] == name).unwrap()
}

/// Tables of histories and of steps of one run are equal in both formats; another seed is another sample of the same distribution.
#[test]
fn tables_of_runs() {
    let bench = Bench::new();
    let (_, page) = include_str!("../../../../docs/guides/photons.md").split_once("```xml\n").unwrap();
    bench.write("bar.gdml", page.split_once("```\n").unwrap().0);
    let run = |seed: &str, more: &[&str]| {
        let start =
            ["photons", "bar.gdml", "--at", "0,0,0", "--wavelength", "550", "-n", "1000", "--seed", seed];
        bench.says(&[&start, more].concat());
    };
    run("0", &["--histories", "a.csv", "--steps", "steps.npy", "-o", "hits.csv"]);
    run("0", &["--histories", "a.npy"]);
    run("5", &["--histories", "b.csv"]);
    assert!(bench.read("a.csv").starts_with(HISTORIES));
    for other in ["a.npy", "steps.npy"] {
        let found = bench.json(&["photons", "compare", "a.csv", other, "--json"]);
        for name in ["history", "end", "volume", "time", "wavelength"] {
            assert_eq!(quantity(&found, name)["chi2"], 0.0, "{other} {name}");
        }
        assert_eq!(found["pairs"]["equal"], 1000);
        assert_eq!(found["is_equal"], true);
        let text = bench.says(&["photons", "compare", "a.csv", other]);
        let equality =
            "A and B are equal: 1000 photons, one by one, in history, end, volume, time, wavelength.";
        assert!(text.ends_with(&format!("{equality}\n")), "{text}");
    }
    let found = bench.json(&["photons", "compare", "a.csv", "b.csv", "--json"]);
    let history = quantity(&found, "history");
    assert!(history["ndf"].as_u64().unwrap() > 10 && history["p"].as_f64().unwrap() > 1e-3, "{history}");
    assert_eq!(found["pairs"]["is_same_run"], false);
    assert_eq!(found["is_equal"], false);
    // all hits are equal, not the fractions of different numbers of photons
    let hits = ["photons", "compare", "hits.csv", "hits.csv"];
    assert!(bench.says(&hits).contains("are equal"));
    assert!(!bench.says(&[&hits[..], &["--photons", "1000", "2000"]].concat()).contains("are equal"));
    let found = bench.json(&["photons", "compare", "hits.csv", "b.csv", "--json"]);
    assert_eq!(found["is_hits"], true);
    assert!(found["hits_z"].as_f64().unwrap().abs() < 4.0);
}

/// A planted difference has the z of two fractions; the text names the largest bins and the first difference.
#[test]
fn planted_difference() {
    let bench = Bench::new();
    bench.write("a.csv", table(1000, 500));
    bench.write("b.csv", table(1000, 560));
    let found = bench.json(&["photons", "compare", "a.csv", "b.csv", "--json"]);
    let expected = -0.06 / (0.53f64 * 0.47 * 2.0 / 1000.0).sqrt();
    let z = quantity(&found, "end")["bins"][0]["z"].as_f64().unwrap();
    assert!((z - expected).abs() < 1e-9, "{z}, {expected}");
    assert_eq!(found["pairs"]["first_difference"]["photon"], 500);
    assert_eq!(found["pairs"]["first_difference"]["row"], 1);
    let text = bench.says(&["photons", "compare", "a.csv", "b.csv"]);
    assert!(text.contains("940 of 1000 photons have equal histories"), "{text}");
    assert!(text.contains("first difference: photon 500, row 1"), "{text}");
    assert!(text.contains("-2.69  emission absorbed"), "{text}");
    // chi squared is 10,000 with one degree of freedom: p is about exp(-5,000), below the range of f64
    bench.write("a.csv", table(5000, 0));
    bench.write("b.csv", table(5000, 5000));
    let text = bench.says(&["photons", "compare", "a.csv", "b.csv"]);
    assert!(text.contains("  < 1e-300  "), "{text}");
}

/// Missing and empty files are errors, as is a comparison without a second file; a simulation still needs a model and a source.
#[test]
fn errors() {
    let bench = Bench::new();
    bench.write("a.csv", table(10, 5));
    bench.write("empty.csv", HISTORIES);
    assert!(bench.fails(3, &["photons", "compare", "a.csv", "none.csv"]).contains("none.csv"));
    let text = bench.fails(3, &["photons", "compare", "a.csv", "empty.csv"]);
    assert!(text.contains("empty.csv cannot be compared: the file has no photons."), "{text}");
    assert!(bench.fails(2, &["photons", "compare", "a.csv"]).contains("<B>"));
    assert!(bench.fails(2, &["photons", "compare", "a.csv", "a.csv", "--least", "0"]).contains("at least 1"));
    assert!(bench.fails(2, &["photons"]).contains("required arguments"));
}
