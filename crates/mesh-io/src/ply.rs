//! PLY (Stanford polygon format) reader and writer, text and binary of both byte orders.
//!
//! *Source*: G. Turk, "The PLY Polygon File Format" (1994). The reader uses the element `vertex` with properties `x`, `y` and `z`
//! of any type and the element `face` with the list `vertex_indices` or `vertex_index`. Other elements and properties are
//! skipped. Triangle strips are rejected.

use crate::builder::{MeshBuilder, check_limit};
use crate::text::write_point;
use crate::tokens::{Tokens, excerpt};
use crate::{FileError, LoadedMesh, Location, MeshWriteOptions, ReadOptions};
use rayweave_math::Vec3;
use rayweave_mesh::Mesh;
use std::io::{self, BufRead, Read, Write};

/// A scalar type.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ScalarType {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl ScalarType {
    fn from_name(name: &str) -> Option<ScalarType> {
        Some(match name {
            "char" | "int8" => ScalarType::I8,
            "uchar" | "uint8" => ScalarType::U8,
            "short" | "int16" => ScalarType::I16,
            "ushort" | "uint16" => ScalarType::U16,
            "int" | "int32" => ScalarType::I32,
            "uint" | "uint32" => ScalarType::U32,
            "float" | "float32" => ScalarType::F32,
            "double" | "float64" => ScalarType::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            ScalarType::I8 | ScalarType::U8 => 1,
            ScalarType::I16 | ScalarType::U16 => 2,
            ScalarType::I32 | ScalarType::U32 | ScalarType::F32 => 4,
            ScalarType::F64 => 8,
        }
    }

    /// Converts from little-endian bytes.
    fn value(self, b: [u8; 8]) -> f64 {
        let four = [b[0], b[1], b[2], b[3]];
        match self {
            ScalarType::I8 => f64::from(b[0] as i8),
            ScalarType::U8 => f64::from(b[0]),
            ScalarType::I16 => f64::from(i16::from_le_bytes([b[0], b[1]])),
            ScalarType::U16 => f64::from(u16::from_le_bytes([b[0], b[1]])),
            ScalarType::I32 => f64::from(i32::from_le_bytes(four)),
            ScalarType::U32 => f64::from(u32::from_le_bytes(four)),
            ScalarType::F32 => f64::from(f32::from_le_bytes(four)),
            ScalarType::F64 => f64::from_le_bytes(b),
        }
    }
}

/// A property of an element: a scalar, or a list of scalars after its length.
#[derive(Clone, Debug)]
struct Property {
    name: String,
    /// The type of the length of a list.
    length: Option<ScalarType>,
    scalar: ScalarType,
}

#[derive(Clone, Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

impl Element {
    /// The minimal size of an element in bytes. A number in text takes at least a digit and a separator.
    fn min_size(&self, is_text: bool) -> u64 {
        let size = |scalar: ScalarType| if is_text { 2 } else { scalar.size() as u64 };
        self.properties.iter().map(|p| size(p.length.unwrap_or(p.scalar))).sum()
    }

    /// The name of a property that a mesh needs and this element lacks.
    fn missing_property(&self) -> Option<&'static str> {
        let is_list =
            |name: &str| self.properties.iter().find(|p| p.name == name).map(|p| p.length.is_some());
        match self.name.as_str() {
            "vertex" => ["x", "y", "z"].into_iter().find(|name| is_list(name) != Some(false)),
            "face" => {
                let has_corners = CORNER_LISTS.iter().any(|name| is_list(name) == Some(true));
                (!has_corners).then_some(CORNER_LISTS[0])
            }
            _ => None,
        }
    }
}

/// The two common names of the list of a face's corners.
const CORNER_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// The encoding of numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

pub fn read(from: impl BufRead, length: u64, options: &ReadOptions) -> Result<LoadedMesh, FileError> {
    let mut tokens = Tokens::new(from, None);
    let (encoding, elements) = header(&mut tokens)?;
    for element in &elements {
        check_size(element, encoding, length, options, tokens.location())?;
    }
    match encoding {
        Encoding::Text => read_elements(&mut tokens, &elements, options),
        _ => {
            let byte = tokens.bytes();
            let is_big = encoding == Encoding::BigEndian;
            read_elements(&mut Binary { from: tokens.into_inner(), byte, is_big }, &elements, options)
        }
    }
}

/// Rejects an element that lacks a required property or does not fit into the rest of the file.
fn check_size(
    element: &Element,
    encoding: Encoding,
    length: u64,
    options: &ReadOptions,
    location: Location,
) -> Result<(), FileError> {
    match element.name.as_str() {
        "vertex" => check_limit(options, "vertices", element.count, location)?,
        "face" => check_limit(options, "triangles", element.count, location)?,
        _ => {}
    }
    if let Some(name) = element.missing_property() {
        let problem = format!("element {} has no property {name}", element.name);
        return Err(FileError::syntax(location, problem, "a mesh requires it"));
    }
    let min_size = element.min_size(encoding == Encoding::Text).max(1);
    // the last number of a text has no separator after it
    if element.count.saturating_mul(min_size) > length + 1 {
        let Element { name, count, .. } = element;
        let problem = format!("the file announces {count} elements {name}");
        return Err(FileError::syntax(location, problem, format!("it has {length} bytes")));
    }
    Ok(())
}

fn header(tokens: &mut Tokens<impl BufRead>) -> Result<(Encoding, Vec<Element>), FileError> {
    tokens.next_line()?;
    if tokens.rest() != "ply" {
        let problem = "the first line is not `ply`";
        return Err(FileError::syntax(tokens.location(), problem, "a PLY file begins with it"));
    }
    let (mut encoding, mut elements) = (None, Vec::<Element>::new());
    loop {
        if !tokens.next_line()? {
            return Err(FileError::truncated(tokens.location(), "`end_header`"));
        }
        let line: Vec<String> = tokens.rest().split_whitespace().map(str::to_owned).collect();
        let line: Vec<&str> = line.iter().map(String::as_str).collect();
        let location = tokens.location();
        match line[..] {
            ["end_header"] => {
                tokens.skip_line();
                break;
            }
            [] | ["comment" | "obj_info", ..] => {}
            ["format", name, _] => encoding = Some(encoding_named(name, location)?),
            ["element", name, count] => {
                let count = count.parse().map_err(|_| bad_line(&line, location))?;
                elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
            }
            ["property", ..] => {
                let property = property(&line).ok_or_else(|| bad_line(&line, location))?;
                elements.last_mut().ok_or_else(|| bad_line(&line, location))?.properties.push(property);
            }
            _ => return Err(bad_line(&line, location)),
        }
    }
    let missing =
        || FileError::syntax(tokens.location(), "the header has no line `format`", "PLY requires it");
    let encoding = encoding.ok_or_else(missing)?;
    Ok((encoding, elements))
}

fn bad_line(line: &[&str], location: Location) -> FileError {
    let problem = format!("`{}` is not a header line", excerpt(&line.join(" ")));
    FileError::syntax(
        location,
        problem,
        "a PLY header consists of format, comment, element and property lines",
    )
}

fn encoding_named(name: &str, location: Location) -> Result<Encoding, FileError> {
    match name {
        "ascii" => Ok(Encoding::Text),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => {
            let problem = format!("the encoding `{}` is unknown", excerpt(name));
            let reason = "PLY has ascii, binary_little_endian and binary_big_endian";
            Err(FileError::syntax(location, problem, reason))
        }
    }
}

fn property(line: &[&str]) -> Option<Property> {
    let (length, scalar, name) = match line {
        ["property", "list", length, scalar, name] => (Some(ScalarType::from_name(length)?), scalar, name),
        ["property", scalar, name] => (None, scalar, name),
        _ => return None,
    };
    Some(Property { name: (*name).to_owned(), length, scalar: ScalarType::from_name(scalar)? })
}

/// Source of scalars: text or binary.
trait Scalars {
    fn number(&mut self, scalar: ScalarType) -> Result<f64, FileError>;
    fn location(&self) -> Location;
}

impl<R: BufRead> Scalars for Tokens<R> {
    fn number(&mut self, _: ScalarType) -> Result<f64, FileError> {
        Tokens::number(self, "a number")
    }

    fn location(&self) -> Location {
        Tokens::location(self)
    }
}

struct Binary<R> {
    from: R,
    byte: u64,
    is_big: bool,
}

impl<R: Read> Scalars for Binary<R> {
    fn number(&mut self, scalar: ScalarType) -> Result<f64, FileError> {
        let (size, mut bytes) = (scalar.size(), [0; 8]);
        let location = self.location();
        self.from
            .read_exact(&mut bytes[..size])
            .map_err(|_| FileError::truncated(location, "the last element"))?;
        if self.is_big {
            bytes[..size].reverse();
        }
        self.byte += size as u64;
        Ok(scalar.value(bytes))
    }

    fn location(&self) -> Location {
        Location::Byte(self.byte)
    }
}

fn read_elements(
    from: &mut impl Scalars,
    elements: &[Element],
    options: &ReadOptions,
) -> Result<LoadedMesh, FileError> {
    let mut builder = MeshBuilder::new(options);
    for element in elements {
        for _ in 0..element.count {
            match element.name.as_str() {
                "vertex" => vertex(from, element, &mut builder)?,
                "face" => face(from, element, &mut builder)?,
                "tristrips" => {
                    let problem = "the file has triangle strips";
                    return Err(FileError::syntax(from.location(), problem, "only faces are supported"));
                }
                _ => skip(from, element)?,
            }
        }
    }
    builder.finish(from.location())
}

fn vertex(from: &mut impl Scalars, element: &Element, builder: &mut MeshBuilder) -> Result<(), FileError> {
    let (mut point, location) = (Vec3::splat(f64::NAN), from.location());
    for property in &element.properties {
        match (property.length, property.name.as_str()) {
            (None, "x") => point.x = from.number(property.scalar)?,
            (None, "y") => point.y = from.number(property.scalar)?,
            (None, "z") => point.z = from.number(property.scalar)?,
            _ => values(from, property, |_| {})?,
        }
    }
    builder.add_vertex(point, location)
}

fn face(from: &mut impl Scalars, element: &Element, builder: &mut MeshBuilder) -> Result<(), FileError> {
    let (mut corners, location) = (Vec::new(), from.location());
    for property in &element.properties {
        let is_corners = CORNER_LISTS.contains(&property.name.as_str());
        // a negative index becomes one that is out of range
        let corner = |x: f64| if x < 0.0 { u64::MAX } else { x as u64 };
        values(from, property, |x| corners.extend(is_corners.then(|| corner(x))))?;
    }
    builder.add_face(&corners, location)
}

fn skip(from: &mut impl Scalars, element: &Element) -> Result<(), FileError> {
    element.properties.iter().try_for_each(|property| values(from, property, |_| {}))
}

/// Calls `take` with the scalar of a property, or with each scalar of a list.
fn values(from: &mut impl Scalars, property: &Property, mut take: impl FnMut(f64)) -> Result<(), FileError> {
    let count = property.length.map_or(Ok(1.0), |scalar| from.number(scalar))?;
    if !(0.0..=4_294_967_295.0).contains(&count) {
        let problem = format!("the length of a list is {count}");
        return Err(FileError::syntax(from.location(), problem, "it must be an integer from 0 to 2^32 - 1"));
    }
    for _ in 0..count as u64 {
        take(from.number(property.scalar)?);
    }
    Ok(())
}

pub fn write(mesh: &Mesh, options: MeshWriteOptions, to: &mut impl Write) -> io::Result<()> {
    let format = if options.text { "ascii" } else { "binary_little_endian" };
    writeln!(to, "ply\nformat {format} 1.0\ncomment rayweave\nelement vertex {}", mesh.vertices().len())?;
    writeln!(to, "property double x\nproperty double y\nproperty double z")?;
    writeln!(to, "element face {}", mesh.triangles().len())?;
    writeln!(to, "property list uchar uint vertex_indices\nend_header")?;
    if options.text { write_text(mesh, to) } else { write_binary(mesh, to) }
}

fn write_text(mesh: &Mesh, to: &mut impl Write) -> io::Result<()> {
    for &point in mesh.vertices() {
        write_point(to, "", point)?;
    }
    for [a, b, c] in mesh.triangles() {
        writeln!(to, "3 {a} {b} {c}")?;
    }
    Ok(())
}

fn write_binary(mesh: &Mesh, to: &mut impl Write) -> io::Result<()> {
    for x in mesh.vertices().iter().flat_map(|point| point.to_array()) {
        to.write_all(&x.to_le_bytes())?;
    }
    for corners in mesh.triangles() {
        to.write_all(&[3])?;
        for vertex in corners {
            to.write_all(&vertex.to_le_bytes())?;
        }
    }
    Ok(())
}
