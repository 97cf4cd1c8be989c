//! STL, text and binary.
//!
//! *Source*: 3D Systems, "StereoLithography Interface Specification" (1988). A binary file has a header of 80 bytes, the
//! number of triangles and 50 bytes for each; normals are not looked at, they follow from the corners. A file is text if it
//! begins with `solid` and its length is not that of a binary file.

use super::words::Words;
use super::{FileError, Loaded, Place, ReadOptions, Soup, within, write_point};
use crate::{Mesh, triangle};
use rayweave_math::Vec3;
use std::io::{self, BufRead, Read, Write};

const HEADER: u64 = 84;
const RECORD: u64 = 50;

pub fn read(mut from: impl BufRead, length: u64, options: &ReadOptions) -> Result<Loaded, FileError> {
    let mut head = Vec::with_capacity(HEADER as usize);
    from.by_ref().take(HEADER).read_to_end(&mut head)?;
    let count = head.get(80..84).map(|b| u64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])));
    let is_text = head.trim_ascii_start().get(..5).is_some_and(|start| start.eq_ignore_ascii_case(b"solid"));
    match count {
        Some(count) if !is_text || HEADER + RECORD * count == length => {
            read_binary(from, count, length, options)
        }
        None if !is_text => Err(FileError::ends(Place::Byte(head.len() as u64), "the header of 84 bytes")),
        _ => read_text(io::Cursor::new(head).chain(from), options),
    }
}

fn read_binary(
    mut from: impl BufRead,
    count: u64,
    length: u64,
    options: &ReadOptions,
) -> Result<Loaded, FileError> {
    within(options, "triangles", count, Place::Byte(80))?;
    let needed = HEADER + RECORD * count;
    if length < needed {
        let why = format!("{count} triangles take {needed} bytes (the file has {length}) is it complete?");
        return Err(FileError::syntax(Place::Byte(80), why));
    }
    let mut soup = Soup::default();
    soup.triangles.reserve_exact(count as usize);
    let mut record = [0; RECORD as usize];
    for k in 0..count {
        let place = Place::Byte(HEADER + RECORD * k);
        from.read_exact(&mut record).map_err(|_| FileError::ends(place, "its last triangle"))?;
        soup.add(corners(&record, place)?);
    }
    let more = (length > needed).then(|| format!("{} bytes after the last triangle", length - needed));
    soup.finish(more.into_iter().collect(), Vec::new(), Place::Byte(HEADER))
}

/// The corners in a record: three numbers of the normal, nine of the corners, two bytes for anything.
fn corners(record: &[u8; RECORD as usize], place: Place) -> Result<[Vec3; 3], FileError> {
    let number = |k: usize| {
        let bytes = [0, 1, 2, 3].map(|byte| record[4 * (k + 3) + byte]);
        f64::from(f32::from_le_bytes(bytes))
    };
    let corners = [0, 3, 6].map(|k| Vec3::new(number(k), number(k + 1), number(k + 2)));
    match corners.iter().find(|corner| !corner.is_finite()) {
        None => Ok(corners),
        Some(c) => {
            let why = format!("a corner is ({:?}, {:?}, {:?}) (coordinates must be finite)", c.x, c.y, c.z);
            Err(FileError::syntax(place, why))
        }
    }
}

fn read_text(from: impl BufRead, options: &ReadOptions) -> Result<Loaded, FileError> {
    let mut words = Words::new(from, None);
    let (mut soup, mut solids, mut is_open) = (Soup::default(), Vec::new(), false);
    // the name of a solid is the rest of its line, and may be anything
    while let Some(word) = words.word()? {
        match word.to_ascii_lowercase().as_str() {
            "solid" => {
                solids.push((words.rest().to_owned(), soup.triangles.len()));
                words.next_line()?;
                is_open = true;
            }
            "endsolid" => {
                words.next_line()?;
                is_open = false;
            }
            "facet" if is_open => soup.add(facet(&mut words)?),
            _ => {
                let found = super::words::short(word);
                let why = format!("`{found}` where `facet` or `endsolid` should be (is it STL?)");
                return Err(FileError::syntax(words.place(), why));
            }
        }
        within(options, "triangles", soup.triangles.len() as u64, words.place())?;
    }
    if is_open {
        return Err(FileError::ends(words.place(), "`endsolid`"));
    }
    soup.finish(Vec::new(), solids, words.place())
}

fn facet(words: &mut Words<impl BufRead>) -> Result<[Vec3; 3], FileError> {
    words.expect("normal")?;
    // three words: some write nan for triangles without area
    for _ in 0..3 {
        words.word()?;
    }
    words.expect("outer")?;
    words.expect("loop")?;
    let mut corners = [Vec3::ZERO; 3];
    for corner in &mut corners {
        words.expect("vertex")?;
        *corner = words.point()?;
    }
    words.expect("endloop")?;
    words.expect("endfacet")?;
    Ok(corners)
}

pub fn write_binary(mesh: &Mesh, to: &mut impl Write) -> io::Result<()> {
    let mut header = [b' '; 80];
    header[..8].copy_from_slice(b"rayweave");
    to.write_all(&header)?;
    to.write_all(&(mesh.triangles().len() as u32).to_le_bytes())?;
    for k in 0..mesh.triangles().len() {
        let corners = mesh.corners(k);
        for point in [normal(corners)].into_iter().chain(corners) {
            for x in point.to_array() {
                to.write_all(&(x as f32).to_le_bytes())?;
            }
        }
        to.write_all(&[0, 0])?;
    }
    Ok(())
}

/// The unit normal, 0 for a triangle without area.
fn normal(corners: [Vec3; 3]) -> Vec3 {
    let normal = triangle::normal(corners);
    if normal.is_finite() { normal } else { Vec3::ZERO }
}

pub fn write_text(parts: &[(&str, &Mesh)], to: &mut impl Write) -> io::Result<()> {
    for (name, mesh) in parts {
        let name = if name.is_empty() { "rayweave".to_owned() } else { super::plain(name) };
        write_solid(&name, mesh, to)?;
    }
    Ok(())
}

fn write_solid(name: &str, mesh: &Mesh, to: &mut impl Write) -> io::Result<()> {
    writeln!(to, "solid {name}")?;
    for k in 0..mesh.triangles().len() {
        let corners = mesh.corners(k);
        write_point(to, "facet normal ", normal(corners))?;
        writeln!(to, "outer loop")?;
        for corner in corners {
            write_point(to, "vertex ", corner)?;
        }
        writeln!(to, "endloop\nendfacet")?;
    }
    writeln!(to, "endsolid {name}")
}
