//! OFF (Geomview's object file format) reader and writer.
//!
//! *Source*: The Geometry Center, "Geomview Manual", OFF files. Colours, normals and texture coordinates are ignored. Binary
//! files and dimensions other than three are rejected.

use crate::builder::{MeshBuilder, check_limit};
use crate::text::write_point;
use crate::tokens::Tokens;
use crate::{FileError, LoadedMesh, Location, ReadOptions};
use rayweave_mesh::Mesh;
use std::io::{self, BufRead, Write};

pub fn read(from: impl BufRead, length: u64, options: &ReadOptions) -> Result<LoadedMesh, FileError> {
    let mut tokens = Tokens::new(from, Some('#'));
    header(&mut tokens)?;
    let [vertices, faces] = [tokens.count("the number of vertices")?, tokens.count("the number of faces")?];
    // the number of edges, which may be missing
    tokens.token_in_line();
    let location = tokens.location();
    for (what, count) in [("vertices", vertices), ("faces", faces)] {
        check_limit(options, what, count, location)?;
        check_length(what, count, length, location)?;
    }
    let (mut builder, mut corners) = (MeshBuilder::new(options), Vec::new());
    for _ in 0..vertices {
        let point = tokens.point()?;
        builder.add_vertex(point, tokens.location())?;
        tokens.skip_line();
    }
    for _ in 0..faces {
        let count = tokens.count("the number of corners")?;
        check_length("corners", count, length, tokens.location())?;
        corners.clear();
        for _ in 0..count {
            corners.push(tokens.count("the index of a vertex")?);
        }
        builder.add_face(&corners, tokens.location())?;
        tokens.skip_line();
    }
    builder.finish(tokens.location())
}

/// Reads the keyword. Letters before OFF announce vertex attributes, which follow the coordinates.
fn header(tokens: &mut Tokens<impl BufRead>) -> Result<(), FileError> {
    let keyword = tokens.token()?.unwrap_or("").to_owned();
    let prefix = keyword.strip_suffix("OFF").map(|prefix| prefix.replace("ST", "").replace(['C', 'N'], ""));
    let location = tokens.location();
    if prefix.as_deref() != Some("") {
        // a file of a different format may be confidential, so nothing of it is quoted
        let problem = "the file is not three-dimensional OFF";
        let reason =
            "it must begin with OFF, after ST, C or N if vertices have these attributes (as in STCNOFF)";
        return Err(FileError::syntax(location, problem, reason));
    }
    match tokens.rest().eq_ignore_ascii_case("binary") {
        true => Err(FileError::syntax(location, "the file is binary OFF", "only text OFF is supported")),
        false => Ok(()),
    }
}

/// Rejects a count of items that do not fit into the file; an item takes at least two bytes.
fn check_length(what: &str, count: u64, length: u64, location: Location) -> Result<(), FileError> {
    if count > length / 2 {
        let problem = format!("the file announces {count} {what}");
        return Err(FileError::syntax(location, problem, format!("its {length} bytes cannot hold them")));
    }
    Ok(())
}

pub fn write(mesh: &Mesh, to: &mut impl Write) -> io::Result<()> {
    writeln!(to, "OFF\n{} {} 0", mesh.vertices().len(), mesh.triangles().len())?;
    for &point in mesh.vertices() {
        write_point(to, "", point)?;
    }
    for [a, b, c] in mesh.triangles() {
        writeln!(to, "3 {a} {b} {c}")?;
    }
    Ok(())
}
