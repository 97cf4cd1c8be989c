//! Wavefront OBJ.
//!
//! *Source*: Alias|Wavefront, "Advanced Visualizer Manual", appendix B1 (1995). Read are `v`, with what follows the three
//! coordinates left out, and `f`, with negative (relative) numbers of vertices, and those of textures and normals left out.
//! Curves and surfaces are counted and left out. Objects (`o`), or groups (`g`) where there is none, are its parts;
//! materials and the like say nothing about the solid.

use super::words::{Words, short};
use super::{Builder, FileError, Loaded, ReadOptions, write_point};
use crate::Mesh;
use std::io::{self, BufRead, Write};

/// Statements that make something which is not read.
const SHAPES: [&str; 9] = ["l", "p", "curv", "curv2", "surf", "fo", "bzp", "cdc", "res"];

pub fn read(from: impl BufRead, options: &ReadOptions) -> Result<Loaded, FileError> {
    let mut words = Words::new(from, Some('#'));
    let (mut builder, mut left_out, mut corners) = (Builder::new(options), 0, Vec::new());
    let mut groups = Vec::new();
    while words.next_line()? {
        match words.word_here().map(str::to_owned).as_deref() {
            Some("v") => {
                let point = words.point()?;
                builder.vertex(point, words.place())?;
            }
            Some("f" | "fo") => {
                face_corners(&mut words, builder.vertices.len(), &mut corners)?;
                builder.face(&corners, words.place())?;
            }
            Some("o") => builder.start(words.rest()),
            Some("g") => groups.push((words.rest().to_owned(), builder.triangles.len())),
            Some(word) if SHAPES.contains(&word) => left_out += 1,
            Some(word) if word.starts_with(|c: char| c.is_ascii_alphabetic()) => {}
            None => {}
            Some(word) => {
                let why = format!("`{}` is no statement (is it OBJ?)", short(word));
                return Err(FileError::syntax(words.place(), why));
            }
        }
    }
    if left_out > 0 {
        builder.warnings.push(format!("{left_out} points, lines, curves and curved surfaces were left out"));
    }
    // groups tell objects apart only where nothing else does
    if builder.starts.is_empty() {
        builder.starts = groups;
    }
    let place = words.place();
    builder.finish(place)
}

/// The corners of a face, on this line and those that it goes on in.
fn face_corners(
    words: &mut Words<impl BufRead>,
    count: usize,
    corners: &mut Vec<u64>,
) -> Result<(), FileError> {
    corners.clear();
    loop {
        let place = words.place();
        let Some(word) = words.word_here() else {
            return Ok(());
        };
        if word == "\\" {
            words.next_line()?;
            continue;
        }
        corners.push(vertex_number(word, count).ok_or_else(|| {
            let why = format!("`{}` is no corner (it must be the number of a vertex before it)", short(word));
            FileError::syntax(place, why)
        })?);
    }
}

/// The vertex named by `7`, `7/1`, `7/1/3`, `7//3` or `-1`, counted from 0.
fn vertex_number(word: &str, count: usize) -> Option<u64> {
    let number: i64 = word.split('/').next()?.parse().ok()?;
    match number {
        1.. => Some(number as u64 - 1),
        0 => None,
        _ => (count as u64).checked_sub(number.unsigned_abs()),
    }
}

pub fn write(parts: &[(&str, &Mesh)], to: &mut impl Write) -> io::Result<()> {
    writeln!(to, "# rayweave")?;
    let mut first = 1;
    for (name, mesh) in parts {
        if !name.is_empty() {
            writeln!(to, "o {}", super::plain(name))?;
        }
        for &point in mesh.vertices() {
            write_point(to, "v ", point)?;
        }
        for corners in mesh.triangles() {
            let [a, b, c] = corners.map(|vertex| vertex as usize + first);
            writeln!(to, "f {a} {b} {c}")?;
        }
        first += mesh.vertices().len();
    }
    Ok(())
}
