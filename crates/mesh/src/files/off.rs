//! OFF.
//!
//! *Source*: The Geometry Center, "Geomview Manual", OFF files. Colours, normals and texture coordinates are left out;
//! the binary kind and other dimensions than three are refused.

use super::words::{Words, short};
use super::{Builder, FileError, Loaded, Place, ReadOptions, within, write_point};
use crate::Mesh;
use std::io::{self, BufRead, Write};

pub fn read(from: impl BufRead, length: u64, options: &ReadOptions) -> Result<Loaded, FileError> {
    let mut words = Words::new(from, Some('#'));
    header(&mut words)?;
    let [vertices, faces] = [words.count("the number of vertices")?, words.count("the number of faces")?];
    // the number of edges, which some leave out
    words.word_here();
    let place = words.place();
    for (what, count) in [("vertices", vertices), ("triangles", faces)] {
        within(options, what, count, place)?;
        could_follow(what, count, length, place)?;
    }
    let (mut builder, mut corners) = (Builder::new(options), Vec::new());
    for _ in 0..vertices {
        let point = words.point()?;
        builder.vertex(point, words.place())?;
        words.end_line();
    }
    for _ in 0..faces {
        let count = words.count("the number of corners")?;
        could_follow("corners", count, length, words.place())?;
        corners.clear();
        for _ in 0..count {
            corners.push(words.count("the number of a vertex")?);
        }
        builder.face(&corners, words.place())?;
        words.end_line();
    }
    let place = words.place();
    builder.finish(place)
}

/// The first word: the letters before OFF say what vertices have beside their coordinates, which come first.
fn header(words: &mut Words<impl BufRead>) -> Result<(), FileError> {
    let word = words.word()?.unwrap_or("").to_owned();
    let more = word.strip_suffix("OFF").map(|more| more.replace("ST", "").replace(['C', 'N'], ""));
    let place = words.place();
    if more.as_deref() != Some("") {
        let why = format!("`{}` where `OFF` should be (only OFF of three dimensions is read)", short(&word));
        return Err(FileError::syntax(place, why));
    }
    match words.rest().eq_ignore_ascii_case("binary") {
        true => Err(FileError::syntax(place, "binary OFF (only text is read)")),
        false => Ok(()),
    }
}

/// Refuses a count of things, of two bytes each at least, that the file has no room for.
fn could_follow(what: &str, count: u64, length: u64, place: Place) -> Result<(), FileError> {
    if count > length / 2 {
        let why = format!("{count} {what} (the file has {length} bytes) is it complete?");
        return Err(FileError::syntax(place, why));
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
