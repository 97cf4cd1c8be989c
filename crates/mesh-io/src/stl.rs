//! STL (stereolithography) reader and writer, text and binary.
//!
//! *Source*: 3D Systems, "StereoLithography Interface Specification" (1988). A binary file has a header of 80 bytes, the
//! number of triangles and 50 bytes for each. Normals are ignored: they follow from the corners. A file counts as text if it
//! begins with `solid` and its length differs from that of a binary file.

use crate::builder::{TriangleSoup, check_limit};
use crate::text::{printable, write_point};
use crate::tokens::{Tokens, excerpt};
use crate::{FileError, LoadedMesh, Location, ReadOptions};
use rayweave_math::Vec3;
use rayweave_mesh::Mesh;
use std::io::{self, BufRead, Read, Write};

const HEADER: u64 = 84;
const RECORD: u64 = 50;

pub fn read(mut from: impl BufRead, length: u64, options: &ReadOptions) -> Result<LoadedMesh, FileError> {
    let mut head = Vec::with_capacity(HEADER as usize);
    from.by_ref().take(HEADER).read_to_end(&mut head)?;
    let count = head.get(80..84).map(|b| u64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])));
    let is_text = head.trim_ascii_start().get(..5).is_some_and(|start| start.eq_ignore_ascii_case(b"solid"));
    match count {
        Some(count) if !is_text || HEADER + RECORD * count == length => {
            read_binary(from, count, length, options)
        }
        None if !is_text => {
            Err(FileError::truncated(Location::Byte(head.len() as u64), "the header of 84 bytes"))
        }
        _ => read_text(io::Cursor::new(head).chain(from), options),
    }
}

fn read_binary(
    mut from: impl BufRead,
    count: u64,
    length: u64,
    options: &ReadOptions,
) -> Result<LoadedMesh, FileError> {
    check_limit(options, "triangles", count, Location::Byte(80))?;
    let needed = HEADER + RECORD * count;
    if length < needed {
        let problem = format!("{count} triangles take {needed} bytes");
        return Err(FileError::syntax(Location::Byte(80), problem, format!("the file has {length}")));
    }
    let mut soup = TriangleSoup::default();
    soup.triangles.reserve_exact(count as usize);
    let mut record = [0; RECORD as usize];
    for k in 0..count {
        let location = Location::Byte(HEADER + RECORD * k);
        from.read_exact(&mut record).map_err(|_| FileError::truncated(location, "the last triangle"))?;
        soup.add(corners(&record, location)?);
    }
    let surplus =
        (length > needed).then(|| format!("{} bytes after the last triangle are ignored", length - needed));
    soup.finish(surplus.into_iter().collect(), Vec::new(), Location::Byte(HEADER))
}

/// The corners in a record of three numbers for the normal, nine for the corners and two bytes of attributes.
fn corners(record: &[u8; RECORD as usize], location: Location) -> Result<[Vec3; 3], FileError> {
    let number = |k: usize| {
        let bytes = [0, 1, 2, 3].map(|byte| record[4 * (k + 3) + byte]);
        f64::from(f32::from_le_bytes(bytes))
    };
    let corners = [0, 3, 6].map(|k| Vec3::new(number(k), number(k + 1), number(k + 2)));
    match corners.iter().find(|corner| !corner.is_finite()) {
        None => Ok(corners),
        Some(c) => {
            let problem = format!("a corner is ({:?}, {:?}, {:?})", c.x, c.y, c.z);
            Err(FileError::syntax(location, problem, "coordinates must be finite"))
        }
    }
}

fn read_text(from: impl BufRead, options: &ReadOptions) -> Result<LoadedMesh, FileError> {
    let mut tokens = Tokens::new(from, None);
    let (mut soup, mut solids, mut is_open) = (TriangleSoup::default(), Vec::new(), false);
    // the name of a solid is the rest of its line, without restrictions
    while let Some(token) = tokens.token()? {
        match token.to_ascii_lowercase().as_str() {
            "solid" => {
                solids.push((tokens.rest().to_owned(), soup.triangles.len()));
                tokens.next_line()?;
                is_open = true;
            }
            "endsolid" => {
                tokens.next_line()?;
                is_open = false;
            }
            "facet" if is_open => soup.add(facet(&mut tokens)?),
            _ => {
                // a file of a different format may be confidential, so nothing of it is quoted
                let problem = match solids.is_empty() {
                    true => "the file is not STL".to_owned(),
                    false => format!("`{}` is not expected here", excerpt(token)),
                };
                let reason = "STL requires `facet` or `endsolid`";
                return Err(FileError::syntax(tokens.location(), problem, reason));
            }
        }
        check_limit(options, "triangles", soup.triangles.len() as u64, tokens.location())?;
    }
    if is_open {
        return Err(FileError::truncated(tokens.location(), "`endsolid`"));
    }
    soup.finish(Vec::new(), solids, tokens.location())
}

fn facet(tokens: &mut Tokens<impl BufRead>) -> Result<[Vec3; 3], FileError> {
    tokens.expect("normal")?;
    // not parsed: some programs write nan for degenerate triangles
    for _ in 0..3 {
        tokens.token()?;
    }
    tokens.expect("outer")?;
    tokens.expect("loop")?;
    let mut corners = [Vec3::ZERO; 3];
    for corner in &mut corners {
        tokens.expect("vertex")?;
        *corner = tokens.point()?;
    }
    tokens.expect("endloop")?;
    tokens.expect("endfacet")?;
    Ok(corners)
}

pub fn write_binary(mesh: &Mesh, to: &mut impl Write) -> io::Result<()> {
    let mut header = [b' '; 80];
    header[..8].copy_from_slice(b"rayweave");
    to.write_all(&header)?;
    to.write_all(&(mesh.triangles().len() as u32).to_le_bytes())?;
    for k in 0..mesh.triangles().len() {
        let corners = mesh.corners(k);
        for point in [normal(mesh, k)].into_iter().chain(corners) {
            for x in point.to_array() {
                to.write_all(&(x as f32).to_le_bytes())?;
            }
        }
        to.write_all(&[0, 0])?;
    }
    Ok(())
}

/// The unit normal; 0 for a degenerate triangle.
fn normal(mesh: &Mesh, triangle: usize) -> Vec3 {
    mesh.normal(triangle).unwrap_or(Vec3::ZERO)
}

pub fn write_text(objects: &[(&str, &Mesh)], to: &mut impl Write) -> io::Result<()> {
    for (name, mesh) in objects {
        let name = if name.is_empty() { "rayweave".to_owned() } else { printable(name) };
        write_solid(&name, mesh, to)?;
    }
    Ok(())
}

fn write_solid(name: &str, mesh: &Mesh, to: &mut impl Write) -> io::Result<()> {
    writeln!(to, "solid {name}")?;
    for k in 0..mesh.triangles().len() {
        let corners = mesh.corners(k);
        write_point(to, "facet normal ", normal(mesh, k))?;
        writeln!(to, "outer loop")?;
        for corner in corners {
            write_point(to, "vertex ", corner)?;
        }
        writeln!(to, "endloop\nendfacet")?;
    }
    writeln!(to, "endsolid {name}")
}
