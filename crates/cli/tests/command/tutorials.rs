//! The commands of the tutorials and of guides with their own model: every line of their `sh` blocks is run, in order, page by
//! page.

use crate::bench::{Bench, done};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// Guides whose commands use only files of the page.
const GUIDES: [&str; 3] = ["optics-files.md", "photons.md", "radiography.md"];

fn pages() -> Vec<PathBuf> {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs");
    let mut pages: Vec<PathBuf> =
        fs::read_dir(docs.join("tutorials")).unwrap().map(|entry| entry.unwrap().path()).collect();
    pages.retain(|page| page.extension().is_some_and(|ending| ending == "md"));
    pages.sort();
    pages.extend(GUIDES.map(|name| docs.join("guides").join(name)));
    pages
}

/// The blocks of a page: language and contents.
fn blocks(text: &str) -> Vec<(&str, &str)> {
    let mut blocks = Vec::new();
    let mut rest = text;
    while let Some((_, after)) = rest.split_once("\n```") {
        let (language, after) = after.split_once('\n').unwrap();
        let (contents, after) = after.split_once("\n```\n").unwrap();
        blocks.push((language, contents));
        rest = after;
    }
    blocks
}

/// The name in the first line of a block, `# file: NAME` or `<!-- file: NAME -->`.
fn file_name(contents: &str) -> Option<&str> {
    let (_, name) = contents.lines().next()?.split_once("file: ")?;
    name.split_whitespace().next()
}

/// The words of a command line, with double quotes and comments.
fn words(line: &str) -> Vec<String> {
    let mut words = Vec::new();
    for (k, part) in line.split('"').enumerate() {
        match k % 2 {
            0 => words.extend(part.split(" #").next().unwrap().split_whitespace().map(str::to_owned)),
            _ => words.push(part.to_owned()),
        }
    }
    words
}

#[test]
fn commands_of_tutorials_and_guides_run() {
    let mut count = 0;
    for page in pages() {
        let text = fs::read_to_string(&page).unwrap();
        let bench = Bench::new();
        for (language, contents) in blocks(&text) {
            if let Some(name) = file_name(contents) {
                bench.write(name, contents);
            }
            for line in contents.lines().filter(|line| language == "sh" && line.starts_with("rayweave ")) {
                let mut words = words(line);
                let input = words.iter().position(|word| word == "<").map(|k| words.split_off(k)[1].clone());
                let arguments: Vec<&str> = words[1..].iter().map(String::as_str).collect();
                let mut command = bench.command(&arguments);
                if let Some(name) = input {
                    command.stdin(Stdio::from(fs::File::open(bench.path(&name)).unwrap()));
                }
                let done = done(command.output().unwrap());
                assert_eq!(done.code, 0, "{}: {line}\n{}{}", page.display(), done.out, done.err);
                count += 1;
            }
        }
    }
    assert!(count >= 22, "{count} commands");
}
