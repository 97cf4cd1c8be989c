//! Meshes in files.
//!
//! Readers take any length of input at its word only as far as the input goes: a count in a header is compared with what can
//! follow it before anything is allocated, lines have a longest length, and numbers that are not finite are refused with
//! their place. Faces with more than three corners are cut into triangles.
//!
//! | format | read | written | unit |
//! | --- | --- | --- | --- |
//! | STL | text and binary | binary (coordinates as `f32`) or text | none |
//! | OBJ | vertices and faces of all groups | vertices and triangles, by objects | none |
//! | PLY | text, binary of both byte orders | binary, `f64`, or text | none |
//! | OFF | `OFF`, `COFF`, `NOFF`, `STOFF` and their mixtures | text | none |
//! | 3MF | the objects of the build, with components, also in several models | objects | the file's; written in mm |
//! | glTF, GLB | the scene's triangles, under the maps of its nodes | a node for each mesh (coordinates as `f32`) | m |

mod error;
mod gltf;
mod obj;
mod off;
mod ply;
mod stl;
mod threemf;
mod words;

pub use error::{FileError, Place};

use crate::mesh::{Welder, check_count};
use crate::{Mesh, MeshError};
use rayweave_math::Vec3;
use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, Cursor, Seek, Write};
use std::ops::Range;
use std::path::Path;

/// A format of files of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshFormat {
    /// STL, text or binary.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// The Stanford polygon format.
    Ply,
    /// Geomview's object file format.
    Off,
    /// 3D Manufacturing Format.
    ThreeMf,
    /// glTF as text.
    Gltf,
    /// glTF as one binary file.
    Glb,
}

impl MeshFormat {
    /// All of them.
    pub const ALL: [MeshFormat; 7] = [
        MeshFormat::Stl,
        MeshFormat::Obj,
        MeshFormat::Ply,
        MeshFormat::Off,
        MeshFormat::ThreeMf,
        MeshFormat::Gltf,
        MeshFormat::Glb,
    ];

    /// The name, which is also the usual ending of a file's name.
    pub fn name(self) -> &'static str {
        match self {
            MeshFormat::Stl => "stl",
            MeshFormat::Obj => "obj",
            MeshFormat::Ply => "ply",
            MeshFormat::Off => "off",
            MeshFormat::ThreeMf => "3mf",
            MeshFormat::Gltf => "gltf",
            MeshFormat::Glb => "glb",
        }
    }

    /// The format of this name or ending, in letters of either case.
    pub fn from_name(name: &str) -> Option<MeshFormat> {
        MeshFormat::ALL.into_iter().find(|format| format.name().eq_ignore_ascii_case(name))
    }

    /// The format that the ending of a file's name tells.
    pub fn from_path(path: &Path) -> Option<MeshFormat> {
        MeshFormat::from_name(path.extension()?.to_str()?)
    }
}

/// What to refuse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ReadOptions {
    /// The most triangles, and the most vertices.
    pub most: u64,
}

impl ReadOptions {
    /// The bytes that reading, diagnosing and preparing a mesh takes at most, for each triangle.
    pub const BYTES_A_TRIANGLE: u64 = 176;

    /// As many triangles as fit into so much memory, in bytes, and no more than usual.
    pub fn within(bytes: u64) -> ReadOptions {
        ReadOptions { most: ReadOptions::default().most.min(bytes / Self::BYTES_A_TRIANGLE) }
    }
}

impl Default for ReadOptions {
    /// Twenty million: a solid of so many holds about a gigabyte.
    fn default() -> ReadOptions {
        ReadOptions { most: 20_000_000 }
    }
}

/// What a file holds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loaded {
    /// Points and triangles, in the file's order.
    pub mesh: Mesh,
    /// What was left out or read with some licence, in words.
    pub warnings: Vec<String>,
    /// The unit of length, if the format has one: "mm", "m", "inch" and so on.
    pub unit: Option<String>,
    /// The objects that the file tells apart, in its order; empty if it tells none.
    pub parts: Vec<Part>,
}

/// An object of a file: some of its triangles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Part {
    /// Its name, which may be empty or that of another part.
    pub name: String,
    /// Its triangles, by their numbers in the mesh.
    pub triangles: Range<usize>,
}

impl Loaded {
    /// One of the parts as a mesh of its own; points that it does not use are left out.
    pub fn part(&self, part: &Part) -> Mesh {
        self.mesh.portion(part.triangles.clone())
    }
}

/// The parts that begin at these triangles, those without a triangle left out.
fn parts(starts: Vec<(String, usize)>, count: usize) -> Vec<Part> {
    let ends: Vec<usize> = starts.iter().skip(1).map(|(_, start)| *start).chain([count]).collect();
    let part = |((name, start), end): ((String, usize), usize)| Part { name, triangles: start..end };
    starts.into_iter().zip(ends).map(part).filter(|part| !part.triangles.is_empty()).collect()
}

/// Reads the file at a path; without a format, by the ending of its name.
///
/// # Errors
/// [`FileError`], with line or byte.
pub fn read(path: &Path, format: Option<MeshFormat>, options: &ReadOptions) -> Result<Loaded, FileError> {
    let format = format.or_else(|| MeshFormat::from_path(path)).ok_or_else(|| unknown(path))?;
    let file = File::open(path)?;
    let length = file.metadata()?.len();
    read_from(BufReader::with_capacity(1 << 16, file), length, path.parent(), format, options)
}

fn unknown(path: &Path) -> FileError {
    FileError::UnknownFormat { name: path.display().to_string() }
}

/// Reads a file from memory.
///
/// # Errors
/// [`FileError`], with line or byte.
pub fn read_bytes(bytes: &[u8], format: MeshFormat, options: &ReadOptions) -> Result<Loaded, FileError> {
    read_from(Cursor::new(bytes), bytes.len() as u64, None, format, options)
}

/// Reads so many bytes; other files, if a format may be in several, are looked for in a folder.
fn read_from(
    from: impl BufRead + Seek,
    length: u64,
    folder: Option<&Path>,
    format: MeshFormat,
    options: &ReadOptions,
) -> Result<Loaded, FileError> {
    match format {
        MeshFormat::Stl => stl::read(from, length, options),
        MeshFormat::Obj => obj::read(from, options),
        MeshFormat::Ply => ply::read(from, length, options),
        MeshFormat::Off => off::read(from, length, options),
        MeshFormat::ThreeMf => threemf::read(from, options),
        MeshFormat::Gltf | MeshFormat::Glb => gltf::read(from, length, folder, options),
    }
}

/// How to write.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct WriteOptions {
    /// Text, where a format may be text or binary. Numbers in text are the shortest that read back to the same bits.
    pub text: bool,
}

/// Writes a mesh in a format.
///
/// # Errors
/// Those of the writer.
pub fn write(
    mesh: &Mesh,
    format: MeshFormat,
    options: WriteOptions,
    to: impl Write,
) -> Result<(), FileError> {
    write_parts(&[("", mesh)], format, options, to)
}

/// Writes named meshes as the objects of one file: [`Loaded::parts`] tells them apart again, but for PLY, OFF and binary
/// STL, which know no objects and hold all triangles together.
///
/// # Errors
/// [`MeshError::TooMany`] as a [`FileError`], or those of the writer.
pub fn write_parts(
    parts: &[(&str, &Mesh)],
    format: MeshFormat,
    options: WriteOptions,
    mut to: impl Write,
) -> Result<(), FileError> {
    match format {
        MeshFormat::Stl if options.text => stl::write_text(parts, &mut to)?,
        MeshFormat::Stl => stl::write_binary(joined(parts)?.as_ref(), &mut to)?,
        MeshFormat::Obj => obj::write(parts, &mut to)?,
        MeshFormat::Ply => ply::write(joined(parts)?.as_ref(), options, &mut to)?,
        MeshFormat::Off => off::write(joined(parts)?.as_ref(), &mut to)?,
        MeshFormat::ThreeMf => threemf::write(parts, &mut to)?,
        MeshFormat::Gltf => gltf::write_text(parts, &mut to)?,
        MeshFormat::Glb => gltf::write_binary(parts, &mut to)?,
    }
    Ok(to.flush()?)
}

/// All points and triangles, one mesh after the other.
fn joined<'a>(parts: &[(&str, &'a Mesh)]) -> Result<Cow<'a, Mesh>, FileError> {
    if let [(_, mesh)] = parts {
        return Ok(Cow::Borrowed(mesh));
    }
    let error = |error| FileError::Mesh { place: Place::Byte(0), error };
    let count: usize = parts.iter().map(|(_, mesh)| mesh.vertices().len()).sum();
    check_count("vertices", count as u64).map_err(error)?;
    let (mut vertices, mut triangles) = (Vec::with_capacity(count), Vec::new());
    for (_, mesh) in parts {
        let first = vertices.len() as u32;
        vertices.extend_from_slice(mesh.vertices());
        triangles.extend(mesh.triangles().iter().map(|corners| corners.map(|corner| corner + first)));
    }
    Ok(Cow::Owned(Mesh::new(vertices, triangles).map_err(error)?))
}

/// A name without line ends and other control characters, which no format of text can hold.
fn plain(name: &str) -> String {
    name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

/// Writes a mesh to a file, by the ending of its name if no format is given: beside it first, renamed when complete.
///
/// # Errors
/// [`FileError::UnknownFormat`], or that the file cannot be written.
pub fn save(
    mesh: &Mesh,
    path: &Path,
    format: Option<MeshFormat>,
    options: WriteOptions,
) -> Result<(), FileError> {
    let format = format.or_else(|| MeshFormat::from_path(path)).ok_or_else(|| unknown(path))?;
    let mut name = path.file_name().unwrap_or_default().to_os_string();
    name.push(format!(".{}.part", std::process::id()));
    let beside = path.with_file_name(name);
    let written = File::create(&beside)
        .map_err(FileError::from)
        .and_then(|file| write(mesh, format, options, BufWriter::new(file)))
        .and_then(|()| Ok(std::fs::rename(&beside, path)?));
    if written.is_err() {
        // the first error is the one to tell
        let _ = std::fs::remove_file(&beside);
    }
    written
}

/// Collects what a reader meets.
struct Builder<'a> {
    options: &'a ReadOptions,
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Faces with more than three corners that do not lie in a plane.
    bent: usize,
    warnings: Vec<String>,
    /// The names of objects, and their first triangles.
    starts: Vec<(String, usize)>,
}

impl<'a> Builder<'a> {
    fn new(options: &'a ReadOptions) -> Builder<'a> {
        Builder {
            options,
            vertices: Vec::new(),
            triangles: Vec::new(),
            bent: 0,
            warnings: Vec::new(),
            starts: Vec::new(),
        }
    }

    fn vertex(&mut self, point: Vec3, place: Place) -> Result<(), FileError> {
        if !point.to_array().iter().all(|x| x.abs() <= Mesh::MOST) {
            return Err(FileError::Mesh {
                place,
                error: MeshError::Coordinate { index: self.vertices.len(), point },
            });
        }
        self.vertices.push(point);
        within(self.options, "vertices", self.vertices.len() as u64, place)
    }

    /// A face of three corners or more, each counted from 0.
    fn face(&mut self, corners: &[u64], place: Place) -> Result<(), FileError> {
        let (triangle, count) = (self.triangles.len(), self.vertices.len());
        if let Some(&vertex) = corners.iter().find(|&&vertex| vertex >= count as u64) {
            return Err(FileError::Mesh { place, error: MeshError::Index { triangle, vertex, count } });
        }
        let corner = |k: usize| corners[k] as u32;
        match corners.len() {
            0..3 => return Err(FileError::syntax(place, "a face with less than three corners")),
            3 => self.triangles.push([0, 1, 2].map(corner)),
            _ => {
                let corners: Vec<u32> = corners.iter().map(|&vertex| vertex as u32).collect();
                let (triangles, is_plane) = crate::polygon::triangles(&self.vertices, &corners);
                self.bent += usize::from(!is_plane);
                self.triangles.extend(triangles);
            }
        }
        within(self.options, "triangles", self.triangles.len() as u64, place)
    }

    /// An object begins.
    fn start(&mut self, name: &str) {
        self.starts.push((name.trim().to_owned(), self.triangles.len()));
    }

    fn finish(mut self, place: Place) -> Result<Loaded, FileError> {
        let parts = parts(std::mem::take(&mut self.starts), self.triangles.len());
        if self.bent > 0 {
            let bent = self.bent;
            self.warnings.push(format!(
                "{bent} faces with more than three corners are not plane (they were cut into triangles in one of several ways)"
            ));
        }
        let mesh =
            Mesh::new(self.vertices, self.triangles).map_err(|error| FileError::Mesh { place, error })?;
        Ok(Loaded { mesh, warnings: self.warnings, unit: None, parts })
    }
}

/// Refuses more than the options allow.
fn within(options: &ReadOptions, what: &'static str, count: u64, place: Place) -> Result<(), FileError> {
    let limit = options.most.min(Mesh::MOST_TRIANGLES as u64);
    match count > limit {
        true => Err(FileError::Mesh { place, error: MeshError::TooMany { what, count, limit } }),
        false => Ok(()),
    }
}

/// Joins equal points as they are met, for formats that repeat them.
#[derive(Default)]
struct Soup {
    welder: Welder,
    triangles: Vec<[u32; 3]>,
}

impl Soup {
    fn add(&mut self, corners: [Vec3; 3]) {
        let triangle = corners.map(|point| self.welder.index(point));
        self.triangles.push(triangle);
    }

    fn finish(
        self,
        warnings: Vec<String>,
        starts: Vec<(String, usize)>,
        place: Place,
    ) -> Result<Loaded, FileError> {
        let parts = parts(starts, self.triangles.len());
        let mesh = Mesh::new(self.welder.vertices, self.triangles)
            .map_err(|error| FileError::Mesh { place, error })?;
        Ok(Loaded { mesh, warnings, unit: None, parts })
    }
}

/// Three numbers in the shortest text that reads back to the same bits.
fn write_point(to: &mut impl Write, before: &str, p: Vec3) -> io::Result<()> {
    writeln!(to, "{before}{:?} {:?} {:?}", p.x, p.y, p.z)
}
