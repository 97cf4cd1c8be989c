//! 3MF.
//!
//! *Source*: 3MF Consortium, "3D Manufacturing Format Core Specification" 1.3 (2021): a ZIP archive with a model in XML, found by
//! the relationships of the archive. Read are the objects that the build names, each under its maps, with components of
//! components, also those in models of their own ("3MF Production Extension" 1.1.2, 2018: what slicers write); materials, slices and
//! the like say nothing about the solid.

use super::{FileError, Loaded, Place, ReadOptions, parts, within};
use crate::mesh::check_count;
use crate::{Mesh, MeshError};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use rayweave_math::{Affine, Mat3, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};
use std::io::{self, BufRead, BufReader, Cursor, Read, Seek, Write};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// The largest model, uncompressed.
const MOST_BYTES: u64 = 1 << 32;
/// The most components that are put in place: each may hold others.
const MOST_PLACED: usize = 1 << 20;

/// What stands under one number.
#[derive(Default)]
struct Object {
    name: String,
    /// Its type, which is empty for a model.
    kind: String,
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    components: Vec<Used>,
}

/// Where an object stands: the part of the archive and its number there.
type Key = (String, String);

/// An object that is used under a map.
type Used = (Key, Affine);

#[derive(Default)]
struct Model {
    unit: String,
    objects: FxHashMap<Key, Object>,
    build: Vec<Used>,
    /// Of all objects.
    vertices: u64,
    triangles: u64,
}

impl Model {
    /// The parts that objects are used from.
    fn parts(&self) -> impl Iterator<Item = &String> {
        let components = self.objects.values().flat_map(|object| &object.components);
        self.build.iter().chain(components).map(|((part, _), _)| part)
    }
}

pub fn read(from: impl BufRead + Seek, options: &ReadOptions) -> Result<Loaded, FileError> {
    let mut archive = ZipArchive::new(from).map_err(damaged)?;
    let model = whole_model(&mut archive, options)?;
    let (mut mesh, mut starts) = (Scattered::default(), Vec::new());
    let mut warnings = Vec::new();
    for (key, map) in &model.build {
        let object = model.objects.get(key);
        let name = object.map_or("", |object| &object.name);
        if let Some(object) = object.filter(|object| NO_MODELS.contains(&object.kind.as_str())) {
            let (id, kind) = (&key.1, &object.kind);
            warnings.push(format!(
                "object {id} `{name}` is left out (its type is `{kind}`: it is no part of the model)"
            ));
            continue;
        }
        starts.push((name.to_owned(), mesh.triangles.len()));
        placed(&model, (key, *map), options, &mut mesh)?;
    }
    let parts = parts(starts, mesh.triangles.len());
    let unit = short_unit(&model.unit).unwrap_or_else(|| {
        let unit = super::words::short(&model.unit);
        let known = UNITS.map(|(name, _)| name).join(", ");
        warnings
            .push(format!("the unit `{unit}` is unknown (3MF has {known}) lengths are taken in millimetres"));
        MILLIMETRE
    });
    let unit = Some(unit.to_owned());
    let error = |error| FileError::Mesh { place: Place::Byte(0), error };
    let mesh = Mesh::new(mesh.vertices, mesh.triangles).map_err(error)?;
    Ok(Loaded { mesh, warnings, unit, parts })
}

/// The model that the archive is about, and the parts that it uses.
fn whole_model(
    archive: &mut ZipArchive<impl BufRead + Seek>,
    options: &ReadOptions,
) -> Result<Model, FileError> {
    let mut model = Model::default();
    let mut waiting = vec![model_name(archive)?];
    let mut known: FxHashSet<String> = waiting.iter().cloned().collect();
    while let Some(name) = waiting.pop() {
        let part = archive.by_name(&name).map_err(damaged)?;
        let part = BufReader::new(part.take(MOST_BYTES));
        let is_root = known.len() == 1;
        Parser::new(name.clone(), is_root, &mut model, options).parse(part)?;
        waiting.extend(model.parts().filter(|part| known.insert((*part).clone())).cloned());
    }
    Ok(model)
}

fn damaged(error: zip::result::ZipError) -> FileError {
    FileError::syntax(Place::Byte(0), format!("no archive that can be read ({error}) is it 3MF?"))
}

fn bad(place: Place, problem: impl Into<String>) -> FileError {
    FileError::syntax(place, problem)
}

/// The part that the relationships of the archive name as its model.
fn model_name(archive: &mut ZipArchive<impl BufRead + Seek>) -> Result<String, FileError> {
    let plain = || "3D/3dmodel.model".to_owned();
    let Ok(part) = archive.by_name("_rels/.rels") else {
        return Ok(plain());
    };
    let mut reader = Reader::from_reader(BufReader::new(part.take(1 << 20)));
    let (mut buffer, mut target) = (Vec::new(), None);
    loop {
        let event = reader.read_event_into(&mut buffer);
        match event.map_err(|error| bad(Place::Byte(reader.error_position()), error.to_string()))? {
            Event::Eof => break,
            Event::Start(e) | Event::Empty(e) => {
                let is_model = attribute(&e, "Type").is_some_and(|kind| kind.ends_with("/3dmodel"));
                target = attribute(&e, "Target").filter(|_| is_model).or(target);
            }
            _ => {}
        }
        buffer.clear();
    }
    Ok(target.map_or_else(plain, |target| target.trim_start_matches('/').to_owned()))
}

/// An attribute's value; nothing that is read here needs entities.
fn attribute(element: &BytesStart, name: &str) -> Option<String> {
    let mut all = element.attributes();
    let found = all
        .with_checks(false)
        .filter_map(Result::ok)
        .find(|attribute| attribute.key.local_name().as_ref() == name)?;
    Some(found.value.into_owned())
}

/// Reads one part of the archive.
struct Parser<'a> {
    part: String,
    /// The unit and the build are those of the first part.
    is_root: bool,
    model: &'a mut Model,
    options: &'a ReadOptions,
    /// What stands before the names of the core specification's elements: that of `model`.
    prefix: Option<String>,
    open: Key,
    is_complete: bool,
}

impl<'a> Parser<'a> {
    fn new(part: String, is_root: bool, model: &'a mut Model, options: &'a ReadOptions) -> Parser<'a> {
        let open = (part.clone(), String::new());
        Parser { part, is_root, model, options, prefix: None, open, is_complete: false }
    }

    fn parse(mut self, from: impl BufRead) -> Result<(), FileError> {
        let mut reader = Reader::from_reader(from);
        let mut buffer = Vec::new();
        loop {
            let event = reader.read_event_into(&mut buffer);
            let place = Place::Byte(reader.buffer_position());
            match event.map_err(|error| bad(place, error.to_string()))? {
                Event::Eof if self.is_complete => return Ok(()),
                Event::Eof => return Err(FileError::ends(place, "`</model>`")),
                Event::Start(e) | Event::Empty(e) => self.element(&e, place)?,
                Event::End(e) => self.is_complete |= e.local_name().as_ref() == "model",
                _ => {}
            }
            buffer.clear();
        }
    }

    /// Takes what one element says, if it is one of the core specification.
    fn element(&mut self, e: &BytesStart, place: Place) -> Result<(), FileError> {
        let name = e.name();
        let prefix = name.prefix().map(|prefix| prefix.as_ref().to_owned());
        if e.local_name().as_ref() == "model" {
            self.prefix = prefix;
            if self.is_root {
                self.model.unit = attribute(e, "unit").unwrap_or_default();
            }
            return Ok(());
        }
        if prefix != self.prefix {
            return Ok(());
        }
        let values = Values { e, place };
        match e.local_name().as_ref() {
            "object" => self.object(&values),
            "vertex" => self.vertex(&values),
            "triangle" => self.triangle(&values),
            "component" => {
                let used = self.used(&values)?;
                self.opened().components.push(used);
                Ok(())
            }
            "item" if self.is_root => {
                let used = self.used(&values)?;
                self.model.build.push(used);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The object that is being read.
    fn opened(&mut self) -> &mut Object {
        self.model.objects.entry(self.open.clone()).or_default()
    }

    fn object(&mut self, values: &Values) -> Result<(), FileError> {
        self.open.1 = values.needed("id")?;
        let name = attribute(values.e, "name").unwrap_or_default();
        // a name that is no proper text is as good as another
        let name = quick_xml::escape::unescape(&name).map(|name| name.into_owned()).unwrap_or(name);
        let kind = attribute(values.e, "type").unwrap_or_default();
        self.model.objects.insert(self.open.clone(), Object { name, kind, ..Object::default() });
        Ok(())
    }

    fn vertex(&mut self, values: &Values) -> Result<(), FileError> {
        let point = Vec3::new(values.number("x")?, values.number("y")?, values.number("z")?);
        self.opened().vertices.push(point);
        self.model.vertices += 1;
        within(self.options, "vertices", self.model.vertices, values.place)
    }

    fn triangle(&mut self, values: &Values) -> Result<(), FileError> {
        let triangle = [values.corner("v1")?, values.corner("v2")?, values.corner("v3")?];
        self.opened().triangles.push(triangle);
        self.model.triangles += 1;
        within(self.options, "triangles", self.model.triangles, values.place)
    }

    /// The object that a component or an item names.
    fn used(&self, values: &Values) -> Result<Used, FileError> {
        let path = attribute(values.e, "path");
        let part = path.map_or_else(|| self.part.clone(), |path| path.trim_start_matches('/').to_owned());
        let map = map(attribute(values.e, "transform"), values.place)?;
        Ok(((part, values.needed("objectid")?), map))
    }
}

/// The attributes of an element.
struct Values<'a> {
    e: &'a BytesStart<'a>,
    place: Place,
}

impl Values<'_> {
    fn needed(&self, name: &str) -> Result<String, FileError> {
        attribute(self.e, name).ok_or_else(|| bad(self.place, format!("{name} is missing")))
    }

    fn number(&self, name: &str) -> Result<f64, FileError> {
        let text = self.needed(name)?;
        let found = text.trim().parse::<f64>().ok().filter(|x| x.abs() <= Mesh::MOST);
        let why = || format!("{name} is `{}` (it must be a finite number)", super::words::short(&text));
        found.ok_or_else(|| bad(self.place, why()))
    }

    fn corner(&self, name: &str) -> Result<u32, FileError> {
        let text = self.needed(name)?;
        let found = text.trim().parse::<u32>();
        found.map_err(|_| bad(self.place, format!("{name} is `{}`", super::words::short(&text))))
    }
}

/// A map of twelve numbers, the images of the axes and the translation: points are rows there.
fn map(text: Option<String>, place: Place) -> Result<Affine, FileError> {
    let Some(text) = text else {
        return Ok(Affine::IDENTITY);
    };
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [a, b, c, d, e, f, g, h, i, x, y, z] if numbers.iter().all(|n: &f64| n.is_finite()) => {
            let linear = Mat3::from_cols(Vec3::new(a, b, c), Vec3::new(d, e, f), Vec3::new(g, h, i));
            Ok(Affine { linear, translation: Vec3::new(x, y, z) })
        }
        _ => Err(bad(place, format!("transform is `{}` (12 finite numbers)", super::words::short(&text)))),
    }
}

/// Points and triangles that are being put in place.
#[derive(Default)]
struct Scattered {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// How many objects and components have been placed.
    count: usize,
}

/// Adds an object that the build names, in place.
fn placed(
    model: &Model,
    item: (&Key, Affine),
    options: &ReadOptions,
    to: &mut Scattered,
) -> Result<(), FileError> {
    let place = Place::Byte(0);
    let Scattered { vertices, triangles, count } = to;
    let mut waiting = vec![item];
    while let Some((key, map)) = waiting.pop() {
        *count += 1;
        let (part, id) = key;
        let missing = || bad(place, format!("there is no object {id} in the part `{part}`"));
        let object = model.objects.get(key).ok_or_else(missing)?;
        if *count > MOST_PLACED {
            return Err(bad(place, format!("more than {MOST_PLACED} objects (do they hold each other?)")));
        }
        let first = vertices.len() as u64;
        for (what, sum) in [
            ("vertices", first + object.vertices.len() as u64),
            ("triangles", (triangles.len() + object.triangles.len()) as u64),
        ] {
            within(options, what, sum, place)?;
            check_count(what, sum).map_err(|error| FileError::Mesh { place, error })?;
        }
        vertices.extend(object.vertices.iter().map(|&point| map.point(point)));
        // a mirror turns the triangles
        let is_mirror = map.linear.determinant() < 0.0;
        for corners in &object.triangles {
            if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= object.vertices.len()) {
                let (vertex, count) = (u64::from(vertex), object.vertices.len());
                let error = MeshError::Index { triangle: triangles.len(), vertex, count };
                return Err(FileError::Mesh { place, error });
            }
            let [a, b, c] = corners.map(|corner| corner + first as u32);
            triangles.push(if is_mirror { [a, c, b] } else { [a, b, c] });
        }
        waiting.extend(object.components.iter().rev().map(|(key, inner)| (key, inner.then(&map))));
    }
    Ok(())
}

/// What the core specification calls its units, and what they are called here (`ST_Unit`).
const UNITS: [(&str, &str); 6] = [
    ("micron", "um"),
    ("millimeter", MILLIMETRE),
    ("centimeter", "cm"),
    ("inch", "inch"),
    ("foot", "foot"),
    ("meter", "m"),
];

const MILLIMETRE: &str = "mm";

/// Types of objects that are no part of what is to be made: what holds it up while it is made, and what is for components only.
const NO_MODELS: [&str; 3] = ["support", "solidsupport", "other"];

/// The unit of a model, millimetres if none is said; `None` of one that is unknown.
fn short_unit(unit: &str) -> Option<&'static str> {
    match unit {
        "" => Some(MILLIMETRE),
        _ => UNITS.iter().find(|(name, _)| *name == unit).map(|(_, short)| *short),
    }
}

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>"#;
const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;

/// Writes an archive, in millimetres.
pub fn write(parts: &[(&str, &Mesh)], to: &mut impl Write) -> io::Result<()> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    // the same bytes whenever it is written
    let options = SimpleFileOptions::default();
    for (name, text) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONS)] {
        archive.start_file(name, options)?;
        archive.write_all(text.as_bytes())?;
    }
    archive.start_file("3D/3dmodel.model", options)?;
    write_model(parts, &mut archive)?;
    to.write_all(archive.finish()?.get_ref())
}

fn write_model(parts: &[(&str, &Mesh)], to: &mut impl Write) -> io::Result<()> {
    writeln!(to, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(
        to,
        r#"<model unit="millimeter" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">"#
    )?;
    writeln!(to, "<resources>")?;
    for (number, (name, mesh)) in parts.iter().enumerate() {
        let name = match name.is_empty() {
            true => String::new(),
            false => format!(r#" name="{}""#, quick_xml::escape::escape(super::plain(name))),
        };
        writeln!(to, r#"<object id="{}" type="model"{name}>"#, number + 1)?;
        write_mesh(mesh, to)?;
        writeln!(to, "</object>")?;
    }
    writeln!(to, "</resources><build>")?;
    for number in 1..=parts.len() {
        writeln!(to, r#"<item objectid="{number}"/>"#)?;
    }
    writeln!(to, "</build></model>")
}

fn write_mesh(mesh: &Mesh, to: &mut impl Write) -> io::Result<()> {
    writeln!(to, "<mesh><vertices>")?;
    for p in mesh.vertices() {
        writeln!(to, r#"<vertex x="{:?}" y="{:?}" z="{:?}"/>"#, p.x, p.y, p.z)?;
    }
    writeln!(to, "</vertices><triangles>")?;
    for [a, b, c] in mesh.triangles() {
        writeln!(to, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#)?;
    }
    writeln!(to, "</triangles></mesh>")
}
