//! Parts of tables: for random slicings the merged file has the bytes of the whole, and what does not fit is refused.

use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use rayweave_table::{
    Chunk, Column, DType, NO_NAME, Part, PartSet, Schema, TableError, TableWriter, Values, missing_ranges,
};
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A folder for one test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("rayweave-parts-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        Folder(path)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn schema() -> Schema {
    let names: Arc<[String]> = ["air", "glass, \"BK7\"", "water"].map(str::to_owned).into();
    Schema::new(vec![
        Column::new("ray", DType::I64),
        Column::new("t", DType::F64).unit("mm"),
        Column::new("number", DType::I32),
        Column::new("parent", DType::Row),
        Column::new("enters", DType::Bool),
        Column::names("medium", names),
        Column::new("path", DType::Text),
    ])
    .unwrap()
}

/// The rows of a range of rays: ray k has k % 3 rows, of which the second refers to the first; `before` is the number of rows
/// before them in their table.
fn rows(rays: Range<u64>, before: u64) -> Chunk {
    let rows: Vec<u64> = rays.flat_map(|ray| std::iter::repeat_n(ray, (ray % 3) as usize)).collect();
    let texts: Vec<Arc<str>> = (0..40).map(|k| format!("tower[{k}]\n/brick").into()).collect();
    Chunk::new(vec![
        Values::I64(rows.iter().map(|&ray| ray as i64).collect()),
        Values::F64(
            rows.iter().map(|&ray| if ray % 11 == 0 { f64::INFINITY } else { (ray as f64).sqrt() }).collect(),
        ),
        Values::I32(rows.iter().map(|&ray| ray as i32 - 7).collect()),
        Values::I64(
            (0..rows.len())
                .map(|k| if k > 0 && rows[k - 1] == rows[k] { (before + k as u64 - 1) as i64 } else { -1 })
                .collect(),
        ),
        Values::Bool(rows.iter().map(|&ray| ray % 5 == 0).collect()),
        Values::Name(rows.iter().map(|&ray| if ray % 4 == 3 { NO_NAME } else { (ray % 3) as u32 }).collect()),
        // the order of the first occurrence differs between parts
        Values::Text(rows.iter().map(|&ray| texts[(ray * 17 % 40) as usize].clone()).collect()),
    ])
    .unwrap()
}

fn part(range: Range<u64>, total: u64) -> Part {
    let settings = [("model", "0123"), ("seed", "7"), ("rays", "ab")];
    Part::new("trace", settings.map(|(name, value)| (name.to_owned(), value.to_owned())), range, total)
}

/// Lists two texts in advance, of which one does not occur.
fn list(table: &mut TableWriter) {
    table.list_texts("path", ["tower[7]\n/brick", "roof"]);
}

/// Writes a part, its rows in chunks of random size.
fn write(path: &Path, part: &Part, random: &mut ChaCha8Rng) {
    let mut table = TableWriter::create(path, &schema()).unwrap();
    list(&mut table);
    let mut next = part.range.start;
    while next < part.range.end {
        let end = (next + random.random_range(1..=1 + part.total / 3)).min(part.range.end);
        table.write(&rows(next..end, table.rows())).unwrap();
        next = end;
    }
    table.finish_part(part).unwrap();
}

/// Writes the whole and its parts for random slicings, and compares the merged files.
fn slicings(extension: &str, total: u64, times: usize) {
    let (folder, mut random) = (Folder::new(extension), ChaCha8Rng::seed_from_u64(5));
    let whole = folder.file(&format!("whole.{extension}"));
    let mut table = TableWriter::create(&whole, &schema()).unwrap();
    list(&mut table);
    table.write(&rows(0..total, 0)).unwrap();
    table.finish().unwrap();
    if extension == "npy" {
        let names: serde_json::Value =
            serde_json::from_slice(&fs::read(whole.with_extension("names.json")).unwrap()).unwrap();
        assert_eq!((&names["path"][0], &names["path"][1]), (&"tower[7]\n/brick".into(), &"roof".into()));
        assert_eq!(names["path"].as_array().unwrap().len(), 41);
    }
    for time in 0..times {
        let mut cuts: Vec<u64> =
            (0..random.random_range(0..7)).map(|_| random.random_range(0..=total)).collect();
        cuts.extend([0, total]);
        cuts.sort_unstable();
        let mut files = Vec::new();
        for (k, cut) in cuts.windows(2).enumerate() {
            let file = folder.file(&format!("part{k}.{extension}"));
            write(&file, &part(cut[0]..cut[1], total), &mut random);
            files.insert(random.random_range(0..=files.len()), file);
        }
        let merged = folder.file(&format!("merged.{extension}"));
        PartSet::read(&files).unwrap().merge_tables(&merged).unwrap();
        assert!(fs::read(&merged).unwrap() == fs::read(&whole).unwrap(), "slicing {time}: {cuts:?}");
        if extension == "npy" {
            let names =
                ["merged", "whole"].map(|name| fs::read(folder.file(&format!("{name}.names.json"))).unwrap());
            assert!(names[0] == names[1], "slicing {time}: {cuts:?}");
        }
    }
}

#[test]
fn merged_csv_files_equal_the_whole() {
    slicings("csv", 1000, 25);
}

#[test]
fn merged_npy_files_equal_the_whole() {
    slicings("npy", 1000, 25);
}

/// More rows than a row group has.
#[cfg(feature = "parquet")]
#[test]
fn merged_parquet_files_equal_the_whole() {
    slicings("parquet", 130_000, 4);
}

fn refusal(result: Result<impl Sized, TableError>) -> String {
    result.err().expect("an error").to_string()
}

#[test]
fn parts_that_do_not_fit_are_refused_by_name() {
    let (folder, mut random) = (Folder::new("refused"), ChaCha8Rng::seed_from_u64(1));
    let [a, b, c] = ["a.csv", "b.csv", "c.csv"].map(|name| folder.file(name));
    let merged = folder.file("merged.csv");
    write(&a, &part(0..40, 100), &mut random);
    write(&b, &part(60..100, 100), &mut random);
    let set = PartSet::read(&[b.clone(), a.clone()]).unwrap();
    assert_eq!(set.missing(100).as_slice(), std::slice::from_ref(&(40..60)));
    let text = refusal(set.merge_tables(&merged));
    assert!(text.contains("the ranges 40:60 of 100 are missing") && !merged.exists(), "{text}");
    write(&c, &part(30..60, 100), &mut random);
    let text = refusal(PartSet::read(&[a.clone(), b.clone(), c.clone()]));
    assert!(
        text.contains("a.csv") && text.contains("c.csv overlap: their ranges are 0:40 and 30:60."),
        "{text}"
    );
    for (setting, expected) in [("seed", "`seed` is 7 in the first and 8"), ("model", "`model` is 0123")] {
        let mut other = part(40..60, 100);
        other.settings.insert(setting.to_owned(), "8".to_owned());
        other.settings.insert("rays".to_owned(), "other".to_owned());
        write(&c, &other, &mut random);
        let text = refusal(PartSet::read(&[a.clone(), b.clone(), c.clone()]));
        assert!(text.contains("are parts of different results") && text.contains(expected), "{text}");
    }
    write(&c, &part(40..60, 101), &mut random);
    assert!(refusal(PartSet::read(&[a.clone(), c.clone()])).contains("the total is 100"));
    write(&c, &part(40..60, 100), &mut random);
    let text = refusal(
        PartSet::read(&[a.clone(), b.clone(), c.clone()]).unwrap().merge_tables(&folder.file("x.npy")),
    );
    assert!(text.contains("another format"), "{text}");
    assert!(refusal(PartSet::read(&[])).contains("at least one"));
}

#[test]
fn incomplete_and_damaged_parts_are_refused() {
    let (folder, mut random) = (Folder::new("damaged"), ChaCha8Rng::seed_from_u64(1));
    let [a, b] = ["a.npy", "b.npy"].map(|name| folder.file(name));
    write(&a, &part(0..40, 100), &mut random);
    write(&b, &part(40..100, 100), &mut random);
    assert!(part(0..40, 100).is_in(&a) && !part(0..41, 100).is_in(&a));
    let bytes = fs::read(&b).unwrap();
    fs::write(&b, &bytes[..bytes.len() - 1]).unwrap();
    assert!(refusal(PartSet::read(&[a.clone(), b.clone()])).contains("the part is damaged: it has"));
    let mut flipped = bytes.clone();
    *flipped.last_mut().unwrap() ^= 1;
    fs::write(&b, &flipped).unwrap();
    assert!(refusal(PartSet::read(&[a.clone(), b.clone()])).contains("differ from the hash"));
    fs::write(&b, &bytes).unwrap();
    // the names of a NPY file are a part of the part
    let names = fs::read_to_string(b.with_extension("names.json")).unwrap();
    fs::write(b.with_extension("names.json"), names.replace("glass", "grass")).unwrap();
    assert!(refusal(PartSet::read(&[a.clone(), b.clone()])).contains("differ from the hash"));
    fs::write(b.with_extension("names.json"), names).unwrap();
    fs::write(Part::path(&b), "{").unwrap();
    assert!(refusal(PartSet::read(&[a.clone(), b.clone()])).contains("description of the part is damaged"));
    fs::remove_file(Part::path(&b)).unwrap();
    assert!(refusal(PartSet::read(&[a.clone(), b.clone()])).contains("the file is not a part: there is no"));
    let (set, errors) = PartSet::read_complete(&[a, b, folder.file("absent.npy")]).unwrap();
    assert_eq!(set.missing(100).as_slice(), std::slice::from_ref(&(40..100)));
    assert_eq!(errors.len(), 2);
}

#[test]
fn a_part_needs_a_file() {
    let folder = Folder::new("stream");
    let table = TableWriter::create(folder.file("a.csv"), &schema()).unwrap();
    table.finish_part(&part(0..0, 0)).unwrap();
    assert!(refusal(TableWriter::check_part(Path::new("-"))).contains("a part cannot be written here"));
    assert_eq!(missing_ranges([], 3).as_slice(), std::slice::from_ref(&(0..3)));
    assert_eq!(missing_ranges([1..1, 0..3], 3), []);
}
