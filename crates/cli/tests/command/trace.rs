//! `trace`: files of rays to tables of hits.

use crate::bench::{Bench, RAYS, number, rows};

const HEADER: &str = "ray,crossing,t,x,y,z,nx,ny,nz,enters,surface,solid,medium_before,medium_after";

/// Rays along x at heights y from -1.5 to 1.5.
fn fan(count: usize) -> String {
    let y = |k: usize| 3.0 * (k as f64 + 0.5) / count as f64 - 1.5;
    let lines = (0..count).map(|k| format!("-5,{},0,2,0,0\n", y(k)));
    RAYS.to_owned() + &lines.collect::<String>()
}

#[test]
fn csv_to_csv_by_closed_forms() {
    let bench = Bench::new();
    // more rays than one chunk
    let count = 5000;
    bench.write("rays.csv", fan(count));
    let said = bench.says(&["trace", "ball.toml", "--rays", "rays.csv", "-o", "hits.csv"]);
    let hits = bench.read("hits.csv");
    assert_eq!(hits.lines().next(), Some(HEADER));
    let mut found = rows(&hits).into_iter();
    let mut total = 0;
    for ray in 0..count {
        let y = 3.0 * (ray as f64 + 0.5) / count as f64 - 1.5;
        if y.abs() >= 1.0 {
            continue;
        }
        let half = (1.0 - y * y).sqrt();
        for (crossing, x) in [(0, -half), (1, half)] {
            let row = found.next().unwrap();
            assert_eq!(row[..2], [ray.to_string(), crossing.to_string()]);
            let [t, px, py, pz, nx, ny, nz] = std::array::from_fn(|k| number(row[2 + k]));
            // the root's condition number is 1 / half; half is at least 0.02 here
            assert!((t - 0.5 * (x + 5.0)).abs() < 1e-13 && (px - x).abs() < 1e-13, "{row:?}");
            assert_eq!([py, pz], [y, 0.0]);
            // the outward normal of the unit ball equals the point, at entry and at exit
            assert!((nx - x).abs() < 1e-12 && (ny - y).abs() < 1e-12 && nz == 0.0, "{row:?}");
            let (enters, before, after) = match crossing {
                0 => ("true", "world", "glass"),
                _ => ("false", "glass", "world"),
            };
            assert_eq!(row[9..], [enters, "ball.side", "ball", before, after]);
            total += 1;
        }
    }
    assert_eq!(found.next(), None::<Vec<&str>>);
    assert_eq!(said, format!("hits.csv: {total} crossings of {count} rays\n"));
}

/// The message names the ray by its number in the file, and no table is left behind.
#[test]
fn a_ray_from_too_far_is_rejected() {
    let bench = Bench::new();
    let far = fan(5000) + "1e15,0,0,1,0,0\n" + &fan(3)[RAYS.len()..];
    bench.write("rays.csv", far);
    for evaluator in ["packets", "weave", "reference", "single_hit"] {
        let said = bench.fails(
            3,
            &["trace", "ball.toml", "--rays", "rays.csv", "-o", "hits.csv", "--evaluator", evaluator],
        );
        assert!(
            said.contains(
                "ray 5000: the ray is too far from the model: at its closest point, 1e15 from its origin"
            ),
            "{said}"
        );
        assert!(!bench.files().contains(&"hits.csv".to_owned()), "{:?}", bench.files());
    }
}

#[test]
fn any_number_of_threads_and_any_evaluator_write_the_same_bytes() {
    let bench = Bench::new();
    bench.write("rays.csv", fan(10_000));
    let with = |out: &str, options: &[&str]| {
        let files = ["trace", "cemented.toml", "--rays", "rays.csv", "-o", out];
        bench.says(&[&files, options].concat());
        bench.read(out)
    };
    let one = with("one.csv", &["--threads", "1"]);
    assert!(one.lines().count() > 10_000);
    assert_eq!(one, with("four.csv", &["--threads", "4"]));
    assert_eq!(one, with("weave.csv", &["--evaluator", "weave"]));
    assert_eq!(one, with("reference.csv", &["--evaluator", "reference"]));
    assert_eq!(one, with("single_hit.csv", &["--evaluator", "single_hit"]));
}

/// The paths of copies are the same for any number of threads, in text and by number.
#[test]
fn occurrences_name_the_copies() {
    let bench = Bench::new();
    let model = "rayweave = 1\n[solid.ball]\nsphere = { radius = 1 }\n[solid.row]\n\
                 place = { solid = \"ball\", grid = [9, 1, 1], step = [4, 0, 0] }\n[solid.rows]\n\
                 place = { solid = \"row\", at = [[0, 0, 0], [0, 9, 0]], name = \"tray\", numbers = [4, 2] }\n";
    bench.write("rows.toml", model);
    let lines: Vec<String> = (0..3000).map(|k| format!("{},{},-5,0,0,1\n", k % 9 * 4, k % 2 * 9)).collect();
    bench.write("rays.csv", format!("{RAYS}{}", lines.concat()));
    let with = |out: &str, threads: &str| {
        let files = ["trace", "rows.toml", "--rays", "rays.csv", "-o", out, "--occurrence", "--nearest"];
        bench.says(&[&files[..], &["--threads", threads]].concat());
        bench.bytes(out)
    };
    let text = String::from_utf8(with("one.csv", "1")).unwrap();
    assert_eq!(text.lines().next().unwrap(), format!("{HEADER},occurrence"));
    for (k, row) in text.lines().skip(1).enumerate() {
        let expected = format!("rows/tray[{}]/row/ball[{}]", [4, 2][k % 2], k % 9);
        assert_eq!(row.rsplit(',').next(), Some(&*expected));
    }
    assert_eq!(text.as_bytes(), with("four.csv", "4"));
    with("hits.npy", "4");
    let names: serde_json::Value = serde_json::from_str(&bench.read("hits.names.json")).unwrap();
    let paths = names["occurrence"].as_array().unwrap();
    assert_eq!((paths.len(), &paths[1]), (18, &serde_json::json!("rows/tray[2]/row/ball[1]")));
    bench.write("rows.toml", model.replace("[4, 2]", "[4]"));
    let message = bench.fails(3, &["trace", "rows.toml", "--rays", "rays.csv", "-o", "-"]);
    assert!(message.contains("`numbers` has 1 entries: it needs one for each of the 2 copies"), "{message}");
}

#[test]
fn nearest_and_windows() {
    let bench = Bench::new();
    // from inside, from in front, from behind
    bench.write("rays.csv", format!("{RAYS}0,0,0,1,0,0\n-5,0,0,1,0,0\n5,0,0,1,0,0\n"));
    let times = |options: &[&str]| {
        let files = ["trace", "ball.toml", "--rays", "rays.csv", "-o", "-"];
        let table = bench.says(&[&files, options].concat());
        let found = rows(&table).into_iter();
        found.map(|row| (row[0].parse().unwrap(), number(row[2]))).collect::<Vec<(u32, f64)>>()
    };
    let all = [(0, -1.0), (0, 1.0), (1, 4.0), (1, 6.0), (2, -6.0), (2, -4.0)];
    assert_eq!(times(&[]), all);
    assert_eq!(times(&["--nearest"]), [(0, 1.0), (1, 4.0)]);
    assert_eq!(times(&["--nearest", "--t-min", "-inf"]), [(0, -1.0), (1, 4.0), (2, -6.0)]);
    assert_eq!(times(&["--t-min", "-1", "--t-max", "6"]), [(0, 1.0), (1, 4.0)]);
    let message = bench
        .fails(2, &["trace", "ball.toml", "--rays", "rays.csv", "-o", "-", "--t-min", "2", "--t-max", "1"]);
    assert_eq!(
        message,
        "error: the window is empty or reversed: t_min must be less than t_max. Are its ends swapped?\n"
    );
}

#[test]
fn pipes_on_both_sides() {
    let bench = Bench::new();
    let arguments = ["trace", "ball.toml", "--rays", "-", "-o", "-"];
    let done = bench.run_with_input(&arguments, &format!("{RAYS}-5,0,0,1,0,0\n"));
    assert_eq!((done.code, done.err.as_str()), (0, ""));
    let expected = "0,0,4.0,-1.0,0.0,0.0,-1.0,0.0,0.0,true,ball.side,ball,world,glass\n\
                    0,1,6.0,1.0,0.0,0.0,1.0,0.0,0.0,false,ball.side,ball,glass,world\n";
    assert_eq!(done.out, format!("{HEADER}\n{expected}"));
    let bad = bench.run_with_input(&arguments, &format!("{RAYS}-5,0,0,1,0\n"));
    assert_eq!(bad.code, 3);
    assert!(bad.err.starts_with("error: stdin:2: "), "{}", bad.err);
}

#[test]
fn npy_in_and_out() {
    let bench = Bench::new();
    let values = [[-5.0, 0.0, 0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 9.0, 0.0, 0.0, -2.0]];
    bench.write("rays.npy", npy(&values));
    bench.says(&["trace", "ball.toml", "--rays", "rays.npy", "-o", "hits.npy"]);
    let names: serde_json::Value = serde_json::from_str(&bench.read("hits.names.json")).unwrap();
    assert_eq!(names["surface"], serde_json::json!(["ball.side"]));
    assert_eq!(names["medium_before"], serde_json::json!(["world", "glass"]));
    let bytes = bench.bytes("hits.npy");
    let table = npyz::NpyFile::new(&bytes[..]).unwrap();
    assert_eq!(table.shape(), [4]);
    // two i64, seven f64, one bool, four u32, packed
    let width = 2 * 8 + 7 * 8 + 1 + 4 * 4;
    let data = &bytes[bytes.len() - 4 * width..];
    let t = |row: usize| f64::from_le_bytes(data[row * width + 16..][..8].try_into().unwrap());
    assert_eq!([t(0), t(1), t(2), t(3)], [4.0, 6.0, 4.0, 5.0]);
    let medium_after =
        |row: usize| u32::from_le_bytes(data[(row + 1) * width - 4..][..4].try_into().unwrap());
    assert_eq!([medium_after(0), medium_after(1)], [1, 0]);
}

/// An NPY file of shape (N, 6), written by another library.
fn npy(values: &[[f64; 6]]) -> Vec<u8> {
    use npyz::WriterBuilder;
    let mut bytes = Vec::new();
    let mut writer = npyz::WriteOptions::new()
        .default_dtype()
        .shape(&[values.len() as u64, 6])
        .writer(&mut bytes)
        .begin_nd()
        .unwrap();
    writer.extend(values.as_flattened().iter().copied()).unwrap();
    writer.finish().unwrap();
    bytes
}

#[test]
fn bad_rays_are_named() {
    let bench = Bench::new();
    let message = |contents: &str| {
        bench.write("rays.csv", contents);
        let message = bench.fails(3, &["trace", "ball.toml", "--rays", "rays.csv", "-o", "hits.csv"]);
        assert!(!bench.path("hits.csv").exists() && bench.files().len() == 3, "{:?}", bench.files());
        message
    };
    let all = message(&format!("{RAYS}0,0,0,1,0,0\n0,nan,0,1,0,0\n0,0,0,0,0,-0\n0,0,0,1,x,0\n"));
    let lines: Vec<&str> = all.lines().collect();
    assert_eq!(lines[0], "error: rays.csv:3: oy is NaN: a ray is six finite numbers.");
    assert_eq!(lines[1], "rays.csv:4: dx, dy and dz are all 0: a direction must be a nonzero vector.");
    assert!(lines[2].starts_with("rays.csv:5: dy"), "{all}");
    assert!(message("").starts_with("error: rays.csv: "), "{}", message(""));
    assert!(message("a,b\n1,2\n").contains("ox"), "{}", message("a,b\n1,2\n"));
}

#[test]
fn no_rays_are_no_error() {
    let bench = Bench::new();
    bench.write("rays.csv", RAYS);
    let said = bench.says(&["trace", "ball.toml", "--rays", "rays.csv", "-o", "hits.csv"]);
    assert_eq!(said, "hits.csv: 0 crossings of 0 rays\n");
    assert_eq!(bench.read("hits.csv"), format!("{HEADER}\n"));
}

#[test]
fn files_that_cannot_be_opened() {
    let bench = Bench::new();
    bench.write("rays.csv", fan(3));
    let fails =
        |code, rays: &str, out: &str| bench.fails(code, &["trace", "ball.toml", "--rays", rays, "-o", out]);
    assert_eq!(
        fails(3, "ray.csv", "hits.csv"),
        "error: cannot read ray.csv: there is no such file or folder. Did you mean `rays.csv`?\n"
    );
    std::fs::create_dir(bench.path("folder.csv")).unwrap();
    assert!(fails(3, "folder.csv", "hits.csv").contains("it is a folder"));
    assert!(fails(2, "rays.txt", "hits.csv").contains("the ray file format is unknown"));
    assert!(fails(2, "rays.csv", "hits.txt").contains("the table format is unknown"));
    assert_eq!(
        fails(1, "rays.csv", "nowhere/hits.csv"),
        "error: cannot create nowhere/hits.csv: the folder nowhere does not exist. Create it first.\n"
    );
    assert!(fails(1, "rays.csv", "folder.csv").contains("it is a folder"));
}

#[test]
fn an_existing_table_survives_a_failure() {
    let bench = Bench::new();
    bench.write("hits.csv", "precious");
    let text = fan(5000) + "0,0,0,0,0,0\n";
    bench.write("rays.csv", text);
    bench.fails(3, &["trace", "ball.toml", "--rays", "rays.csv", "-o", "hits.csv"]);
    assert_eq!(bench.read("hits.csv"), "precious");
    assert_eq!(bench.files(), ["ball.toml", "cemented.toml", "hits.csv", "rays.csv"]);
}

#[test]
fn quiet_is_quiet() {
    let bench = Bench::new();
    bench.write("rays.csv", fan(3));
    assert_eq!(bench.says(&["trace", "-q", "ball.toml", "--rays", "rays.csv", "-o", "hits.csv"]), "");
}

#[test]
fn a_closed_reader_is_not_an_error() {
    let bench = Bench::new();
    bench.write("rays.csv", fan(20_000));
    let mut child = bench.command(&["trace", "ball.toml", "--rays", "rays.csv", "-o", "-"]).spawn().unwrap();
    drop(child.stdout.take());
    let done = crate::bench::done(child.wait_with_output().unwrap());
    assert_eq!((done.code, done.err.as_str()), (0, ""));
}
