//! Wavefront OBJ reader and writer.
//!
//! *Source*: Alias|Wavefront, "Advanced Visualizer Manual", appendix B1 (1995). The reader supports `v` (values after the
//! three coordinates are ignored) and `f`, including negative (relative) indices; texture and normal indices are ignored. Points,
//! lines, curves and free-form surfaces are counted and ignored. The objects of the file are its `o` statements or, if there
//! are none, its groups (`g`). Materials and other statements do not affect the solid.

use crate::builder::MeshBuilder;
use crate::text::{printable, write_point};
use crate::tokens::{Tokens, excerpt};
use crate::{FileError, LoadedMesh, ReadOptions};
use rayweave_mesh::Mesh;
use std::io::{self, BufRead, Write};

/// Statements that define geometry other than polygons.
const OTHER_GEOMETRY: [&str; 9] = ["l", "p", "curv", "curv2", "surf", "fo", "bzp", "cdc", "res"];

pub fn read(from: impl BufRead, options: &ReadOptions) -> Result<LoadedMesh, FileError> {
    let mut tokens = Tokens::new(from, Some('#'));
    let (mut builder, mut ignored, mut corners) = (MeshBuilder::new(options), 0, Vec::new());
    let mut groups = Vec::new();
    while tokens.next_line()? {
        match tokens.token_in_line().map(str::to_owned).as_deref() {
            Some("v") => {
                let point = tokens.point()?;
                builder.add_vertex(point, tokens.location())?;
            }
            Some("f" | "fo") => {
                face_corners(&mut tokens, builder.vertices.len(), &mut corners)?;
                builder.add_face(&corners, tokens.location())?;
            }
            Some("o") => builder.start_object(tokens.rest()),
            Some("g") => groups.push((tokens.rest().to_owned(), builder.triangles.len())),
            Some(word) if OTHER_GEOMETRY.contains(&word) => ignored += 1,
            Some(word) if word.starts_with(|c: char| c.is_ascii_alphabetic()) => {}
            None => {}
            Some(word) => {
                // a file of a different format may be confidential, so nothing of it is quoted
                let problem = match builder.vertices.is_empty() {
                    true => "the file is not OBJ: a line does not begin with a statement".to_owned(),
                    false => format!("`{}` is not a statement", excerpt(word)),
                };
                let reason = "the name of an OBJ statement begins with a letter";
                return Err(FileError::syntax(tokens.location(), problem, reason));
            }
        }
    }
    if ignored > 0 {
        builder.warnings.push(format!(
            "{ignored} points, lines, curves and free-form surfaces are not supported and were ignored"
        ));
    }
    // groups count as objects only if the file has no objects
    if builder.object_starts.is_empty() {
        builder.object_starts = groups;
    }
    builder.finish(tokens.location())
}

/// The corners of a face, on this line and its continuation lines.
fn face_corners(
    tokens: &mut Tokens<impl BufRead>,
    count: usize,
    corners: &mut Vec<u64>,
) -> Result<(), FileError> {
    corners.clear();
    loop {
        let location = tokens.location();
        let Some(token) = tokens.token_in_line() else {
            return Ok(());
        };
        if token == "\\" {
            tokens.next_line()?;
            continue;
        }
        corners.push(vertex_index(token, count).ok_or_else(|| {
            let problem = format!("`{}` is not a corner", excerpt(token));
            FileError::syntax(location, problem, "a corner is the number of a vertex defined before the face")
        })?);
    }
}

/// The vertex index, from 0, of a corner such as `7`, `7/1`, `7/1/3`, `7//3` or `-1`.
fn vertex_index(token: &str, count: usize) -> Option<u64> {
    let number: i64 = token.split('/').next()?.parse().ok()?;
    match number {
        1.. => Some(number as u64 - 1),
        0 => None,
        _ => (count as u64).checked_sub(number.unsigned_abs()),
    }
}

pub fn write(objects: &[(&str, &Mesh)], to: &mut impl Write) -> io::Result<()> {
    writeln!(to, "# rayweave")?;
    let mut first = 1;
    for (name, mesh) in objects {
        if !name.is_empty() {
            writeln!(to, "o {}", printable(name))?;
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
