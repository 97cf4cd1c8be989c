//! PLY.
//!
//! *Source*: G. Turk, "The PLY Polygon File Format" (1994). Read are the element `vertex` with `x`, `y` and `z` of any type and
//! the element `face` with the list `vertex_indices` or `vertex_index`; what else there is, is passed over. Triangle strips are
//! refused.

use super::words::{Words, short};
use super::{Builder, FileError, Loaded, Place, ReadOptions, WriteOptions, within, write_point};
use crate::Mesh;
use rayweave_math::Vec3;
use std::io::{self, BufRead, Read, Write};

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn from_name(name: &str) -> Option<Kind> {
        Some(match name {
            "char" | "int8" => Kind::I8,
            "uchar" | "uint8" => Kind::U8,
            "short" | "int16" => Kind::I16,
            "ushort" | "uint16" => Kind::U16,
            "int" | "int32" => Kind::I32,
            "uint" | "uint32" => Kind::U32,
            "float" | "float32" => Kind::F32,
            "double" | "float64" => Kind::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::F64 => 8,
        }
    }

    /// The number in so many bytes, the least first.
    fn value(self, b: [u8; 8]) -> f64 {
        let four = [b[0], b[1], b[2], b[3]];
        match self {
            Kind::I8 => f64::from(b[0] as i8),
            Kind::U8 => f64::from(b[0]),
            Kind::I16 => f64::from(i16::from_le_bytes([b[0], b[1]])),
            Kind::U16 => f64::from(u16::from_le_bytes([b[0], b[1]])),
            Kind::I32 => f64::from(i32::from_le_bytes(four)),
            Kind::U32 => f64::from(u32::from_le_bytes(four)),
            Kind::F32 => f64::from(f32::from_le_bytes(four)),
            Kind::F64 => f64::from_le_bytes(b),
        }
    }
}

/// A number, or a list of them with its count first.
#[derive(Clone, Debug)]
struct Property {
    name: String,
    count: Option<Kind>,
    kind: Kind,
}

#[derive(Clone, Debug)]
struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

impl Element {
    /// The bytes that each takes at least: in binary, or as text of a digit and a blank a number.
    fn least(&self, is_text: bool) -> u64 {
        let number = |kind: Kind| if is_text { 2 } else { kind.size() as u64 };
        self.properties.iter().map(|p| number(p.count.unwrap_or(p.kind))).sum()
    }

    /// A property that a mesh needs of this element, and it has not.
    fn missing(&self) -> Option<&'static str> {
        let is_list = |name: &str| self.properties.iter().find(|p| p.name == name).map(|p| p.count.is_some());
        match self.name.as_str() {
            "vertex" => ["x", "y", "z"].into_iter().find(|name| is_list(name) != Some(false)),
            "face" => {
                let has_corners = INDICES.iter().any(|name| is_list(name) == Some(true));
                (!has_corners).then_some(INDICES[0])
            }
            _ => None,
        }
    }
}

/// The names of the list of a face's corners.
const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// How numbers are kept.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

pub fn read(from: impl BufRead, length: u64, options: &ReadOptions) -> Result<Loaded, FileError> {
    let mut words = Words::new(from, None);
    let (encoding, elements) = header(&mut words)?;
    for element in &elements {
        check_size(element, encoding, length, options, words.place())?;
    }
    match encoding {
        Encoding::Text => read_elements(&mut words, &elements, options),
        _ => {
            let byte = words.bytes();
            let is_big = encoding == Encoding::BigEndian;
            read_elements(&mut Binary { from: words.into_inner(), byte, is_big }, &elements, options)
        }
    }
}

/// Refuses an element that lacks what is read of it, or that the rest of the file has no room for.
fn check_size(
    element: &Element,
    encoding: Encoding,
    length: u64,
    options: &ReadOptions,
    place: Place,
) -> Result<(), FileError> {
    match element.name.as_str() {
        "vertex" => within(options, "vertices", element.count, place)?,
        "face" => within(options, "triangles", element.count, place)?,
        _ => {}
    }
    if let Some(name) = element.missing() {
        let why = format!("element {} has no property {name} (it is needed)", element.name);
        return Err(FileError::syntax(place, why));
    }
    let least = element.least(encoding == Encoding::Text).max(1);
    // the last number of a text needs no blank
    if element.count.saturating_mul(least) > length + 1 {
        let Element { name, count, .. } = element;
        let why = format!("{count} of element {name} (the file has {length} bytes) is it complete?");
        return Err(FileError::syntax(place, why));
    }
    Ok(())
}

fn header(words: &mut Words<impl BufRead>) -> Result<(Encoding, Vec<Element>), FileError> {
    words.next_line()?;
    if words.rest() != "ply" {
        return Err(FileError::syntax(words.place(), "the first line is not `ply` (is it PLY?)"));
    }
    let (mut encoding, mut elements) = (None, Vec::<Element>::new());
    loop {
        if !words.next_line()? {
            return Err(FileError::ends(words.place(), "`end_header`"));
        }
        let line: Vec<String> = words.rest().split_whitespace().map(str::to_owned).collect();
        let line: Vec<&str> = line.iter().map(String::as_str).collect();
        let place = words.place();
        match line[..] {
            ["end_header"] => {
                words.end_line();
                break;
            }
            [] | ["comment" | "obj_info", ..] => {}
            ["format", name, _] => encoding = Some(encoding_named(name, place)?),
            ["element", name, count] => {
                let count = count.parse().map_err(|_| bad_line(&line, place))?;
                elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
            }
            ["property", ..] => {
                let property = property(&line).ok_or_else(|| bad_line(&line, place))?;
                elements.last_mut().ok_or_else(|| bad_line(&line, place))?.properties.push(property);
            }
            _ => return Err(bad_line(&line, place)),
        }
    }
    let encoding =
        encoding.ok_or_else(|| FileError::syntax(words.place(), "no line `format` in the header"))?;
    Ok((encoding, elements))
}

fn bad_line(line: &[&str], place: Place) -> FileError {
    FileError::syntax(place, format!("`{}` is no line of a header", short(&line.join(" "))))
}

fn encoding_named(name: &str, place: Place) -> Result<Encoding, FileError> {
    match name {
        "ascii" => Ok(Encoding::Text),
        "binary_little_endian" => Ok(Encoding::LittleEndian),
        "binary_big_endian" => Ok(Encoding::BigEndian),
        _ => Err(FileError::syntax(place, format!("unknown format `{}`", short(name)))),
    }
}

fn property(line: &[&str]) -> Option<Property> {
    let (count, kind, name) = match line {
        ["property", "list", count, kind, name] => (Some(Kind::from_name(count)?), kind, name),
        ["property", kind, name] => (None, kind, name),
        _ => return None,
    };
    Some(Property { name: (*name).to_owned(), count, kind: Kind::from_name(kind)? })
}

/// Where numbers come from.
trait Numbers {
    fn number(&mut self, kind: Kind) -> Result<f64, FileError>;
    fn place(&self) -> Place;
}

impl<R: BufRead> Numbers for Words<R> {
    fn number(&mut self, _: Kind) -> Result<f64, FileError> {
        Words::number(self, "a number")
    }

    fn place(&self) -> Place {
        Words::place(self)
    }
}

struct Binary<R> {
    from: R,
    byte: u64,
    is_big: bool,
}

impl<R: Read> Numbers for Binary<R> {
    fn number(&mut self, kind: Kind) -> Result<f64, FileError> {
        let (size, mut bytes) = (kind.size(), [0; 8]);
        let place = self.place();
        self.from.read_exact(&mut bytes[..size]).map_err(|_| FileError::ends(place, "its last element"))?;
        if self.is_big {
            bytes[..size].reverse();
        }
        self.byte += size as u64;
        Ok(kind.value(bytes))
    }

    fn place(&self) -> Place {
        Place::Byte(self.byte)
    }
}

fn read_elements(
    from: &mut impl Numbers,
    elements: &[Element],
    options: &ReadOptions,
) -> Result<Loaded, FileError> {
    let mut builder = Builder::new(options);
    for element in elements {
        for _ in 0..element.count {
            match element.name.as_str() {
                "vertex" => vertex(from, element, &mut builder)?,
                "face" => face(from, element, &mut builder)?,
                "tristrips" => {
                    return Err(FileError::syntax(from.place(), "triangle strips (they are not read)"));
                }
                _ => pass_over(from, element)?,
            }
        }
    }
    builder.finish(from.place())
}

fn vertex(from: &mut impl Numbers, element: &Element, builder: &mut Builder) -> Result<(), FileError> {
    let (mut point, place) = (Vec3::splat(f64::NAN), from.place());
    for property in &element.properties {
        match (property.count, property.name.as_str()) {
            (None, "x") => point.x = from.number(property.kind)?,
            (None, "y") => point.y = from.number(property.kind)?,
            (None, "z") => point.z = from.number(property.kind)?,
            _ => values(from, property, |_| {})?,
        }
    }
    builder.vertex(point, place)
}

fn face(from: &mut impl Numbers, element: &Element, builder: &mut Builder) -> Result<(), FileError> {
    let (mut corners, place) = (Vec::new(), from.place());
    for property in &element.properties {
        let is_corners = INDICES.contains(&property.name.as_str());
        // what is negative becomes a number that there is not
        let corner = |x: f64| if x < 0.0 { u64::MAX } else { x as u64 };
        values(from, property, |x| corners.extend(is_corners.then(|| corner(x))))?;
    }
    builder.face(&corners, place)
}

fn pass_over(from: &mut impl Numbers, element: &Element) -> Result<(), FileError> {
    element.properties.iter().try_for_each(|property| values(from, property, |_| {}))
}

/// The number of a property, or all numbers of a list.
fn values(from: &mut impl Numbers, property: &Property, mut take: impl FnMut(f64)) -> Result<(), FileError> {
    let count = property.count.map_or(Ok(1.0), |kind| from.number(kind))?;
    if !(0.0..=4_294_967_295.0).contains(&count) {
        return Err(FileError::syntax(from.place(), format!("a list of {count} numbers")));
    }
    for _ in 0..count as u64 {
        take(from.number(property.kind)?);
    }
    Ok(())
}

pub fn write(mesh: &Mesh, options: WriteOptions, to: &mut impl Write) -> io::Result<()> {
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
