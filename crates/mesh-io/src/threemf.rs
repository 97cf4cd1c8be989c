//! 3MF (3D Manufacturing Format) reader and writer.
//!
//! *Source*: 3MF Consortium, "3D Manufacturing Format Core Specification" 1.3 (2021): a ZIP archive with a model in XML, which the
//! relationships of the archive name. The reader loads the objects of the build under their transforms, with nested
//! components, also from further model parts ("3MF Production Extension" 1.1.2, 2018, which slicers use). Materials, slices and
//! other extensions do not affect the solid.

use crate::budget::{Metered, check_repetition, expanded_bytes};
use crate::builder::{check_limit, objects};
use crate::text::printable;
use crate::tokens::excerpt;
use crate::{FileError, LoadedMesh, Location, ReadOptions, ThreeMfUnit};
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_mesh::{Mesh, MeshError};
use rustc_hash::{FxHashMap, FxHashSet};
use std::cell::Cell;
use std::io::{self, BufRead, BufReader, Cursor, Read, Seek, Write};
use std::rc::Rc;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// The maximal number of instances. Components may nest, so that a small file can describe exponentially many.
const MAX_INSTANCES: usize = 1 << 20;
/// The maximal number of objects, components and build items of all parts.
const MAX_ITEMS: usize = 1 << 20;
/// The maximal number of model parts: slicers write one for each object.
const MAX_PARTS: usize = 1 << 12;

/// An object resource.
#[derive(Default)]
struct Object {
    name: String,
    /// The attribute `type`; empty means `model`.
    object_type: String,
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    components: Vec<Instance>,
}

/// Identity of an object: its part of the archive and its id there.
type ObjectKey = (Rc<str>, Rc<str>);

/// An object under a transform.
type Instance = (ObjectKey, Affine);

#[derive(Default)]
struct Model {
    /// The length of the archive in bytes.
    length: u64,
    unit: String,
    objects: FxHashMap<ObjectKey, Object>,
    build: Vec<Instance>,
    /// Number of vertices of all objects.
    vertices: u64,
    /// Number of triangles of all objects.
    triangles: u64,
    /// Number of objects, components and build items.
    items: usize,
    /// The parts of the archive that the build and components refer to, in the order in which they occur.
    parts: Vec<Rc<str>>,
    known_parts: FxHashSet<Rc<str>>,
}

impl Model {
    /// The part with this name, which is scheduled for reading if it is new.
    fn part(&mut self, name: &str) -> Rc<str> {
        if let Some(known) = self.known_parts.get(name) {
            return known.clone();
        }
        let part: Rc<str> = name.into();
        self.known_parts.insert(part.clone());
        self.parts.push(part.clone());
        part
    }

    fn count_item(&mut self, location: Location) -> Result<(), FileError> {
        self.items += 1;
        if self.items > MAX_ITEMS {
            let problem = format!("the model has more than {MAX_ITEMS} objects, components and build items");
            return Err(FileError::syntax(location, problem, "larger models are not supported"));
        }
        Ok(())
    }
}

pub fn read(from: impl BufRead + Seek, length: u64, options: &ReadOptions) -> Result<LoadedMesh, FileError> {
    let mut archive = ZipArchive::new(from).map_err(archive_error)?;
    let model = whole_model(&mut archive, length, options)?;
    let (mut assembly, mut starts) = (Assembly::default(), Vec::new());
    let mut warnings = Vec::new();
    for (key, transform) in &model.build {
        let object = model.objects.get(key);
        let name = object.map_or("", |object| &object.name);
        if let Some(object) = object.filter(|object| AUXILIARY_TYPES.contains(&object.object_type.as_str())) {
            let (id, object_type) = (&key.1, &object.object_type);
            warnings.push(format!(
                "object {id} `{name}` was ignored: its type `{object_type}` is not part of the model"
            ));
            continue;
        }
        starts.push((name.to_owned(), assembly.triangles.len()));
        add_instance(&model, (key, *transform), options, &mut assembly)?;
    }
    let objects = objects(starts, assembly.triangles.len());
    let unit = short_unit(&model.unit).unwrap_or_else(|| {
        let unit = excerpt(&model.unit);
        let known = UNITS.map(|(name, _)| name).join(", ");
        warnings.push(format!(
            "the unit `{unit}` is unknown and was read as millimetres: the units of 3MF are {known}"
        ));
        MILLIMETRE
    });
    let unit = Some(unit.to_owned());
    let error = |error| FileError::Mesh { location: Location::Byte(0), error };
    let mesh = Mesh::new(assembly.vertices, assembly.triangles).map_err(error)?;
    Ok(LoadedMesh { mesh, warnings, unit, objects })
}

/// The model in the root part of the archive, with all parts that it refers to.
fn whole_model(
    archive: &mut ZipArchive<impl BufRead + Seek>,
    length: u64,
    options: &ReadOptions,
) -> Result<Model, FileError> {
    // entries of an archive may overlap: the budget counts what is read, by all of them together
    let limit = expanded_bytes(length);
    let (left, event) = (Cell::new(limit), Cell::new(0));
    let mut model = Model { length, ..Model::default() };
    let root = model_name(archive)?;
    model.part(&root);
    let mut next = 0;
    while let Some(name) = model.parts.get(next).cloned() {
        if next >= MAX_PARTS {
            let problem = format!("the model has more than {MAX_PARTS} parts");
            return Err(FileError::syntax(Location::Byte(0), problem, "larger models are not supported"));
        }
        let part = archive.by_name(&name).map_err(archive_error)?;
        let part = Metered::new(BufReader::new(part), &left, limit, &event);
        ModelParser::new(name.clone(), next == 0, &mut model, options).parse(part, &event).map_err(
            |error| match error {
                FileError::Syntax { location, message } if next > 0 => {
                    let problem = format!("part `{}` of the archive: {}", excerpt(&name), message.problem());
                    FileError::syntax(location, problem, message.reason())
                }
                error => error,
            },
        )?;
        next += 1;
    }
    Ok(model)
}

fn archive_error(error: zip::result::ZipError) -> FileError {
    FileError::syntax(Location::Byte(0), "the ZIP archive of 3MF cannot be read", error.to_string())
}

fn xml_error(location: Location, error: &quick_xml::Error) -> FileError {
    match error {
        quick_xml::Error::Io(error) => {
            FileError::syntax(location, "a part of the archive cannot be read", error.to_string())
        }
        error => FileError::syntax(location, "the XML is invalid", error.to_string()),
    }
}

/// The part that the relationships of the archive name as the root model.
fn model_name(archive: &mut ZipArchive<impl BufRead + Seek>) -> Result<String, FileError> {
    let usual = || "3D/3dmodel.model".to_owned();
    let Ok(part) = archive.by_name("_rels/.rels") else {
        return Ok(usual());
    };
    let mut reader = Reader::from_reader(BufReader::new(part.take(1 << 20)));
    let (mut buffer, mut target) = (Vec::new(), None);
    loop {
        let event = reader.read_event_into(&mut buffer);
        match event.map_err(|error| xml_error(Location::Byte(reader.error_position()), &error))? {
            Event::Eof => break,
            Event::Start(e) | Event::Empty(e) => {
                let is_model = attribute(&e, "Type").is_some_and(|kind| kind.ends_with("/3dmodel"));
                target = attribute(&e, "Target").filter(|_| is_model).or(target);
            }
            _ => {}
        }
        buffer.clear();
    }
    Ok(target.map_or_else(usual, |target| target.trim_start_matches('/').to_owned()))
}

/// The value of an attribute, with entities unresolved.
fn attribute(element: &BytesStart, name: &str) -> Option<String> {
    let mut all = element.attributes();
    let found = all
        .with_checks(false)
        .filter_map(Result::ok)
        .find(|attribute| attribute.key.local_name().as_ref() == name)?;
    Some(found.value.into_owned())
}

/// Parser of one model part of the archive.
struct ModelParser<'a> {
    part: Rc<str>,
    /// True for the root model, which defines the unit and the build.
    is_root: bool,
    model: &'a mut Model,
    options: &'a ReadOptions,
    /// The namespace prefix of the core specification: that of the element `model`.
    prefix: Option<String>,
    /// The object that is being read.
    open: ObjectKey,
    is_complete: bool,
}

impl<'a> ModelParser<'a> {
    fn new(part: Rc<str>, is_root: bool, model: &'a mut Model, options: &'a ReadOptions) -> ModelParser<'a> {
        let open = (part.clone(), "".into());
        ModelParser { part, is_root, model, options, prefix: None, open, is_complete: false }
    }

    /// Parses the part. `read` counts the bytes of one XML event.
    fn parse(mut self, from: impl BufRead, read: &Cell<u64>) -> Result<(), FileError> {
        let mut reader = Reader::from_reader(from);
        let mut buffer = Vec::new();
        loop {
            read.set(0);
            let event = reader.read_event_into(&mut buffer);
            let location = Location::Byte(reader.buffer_position());
            match event.map_err(|error| xml_error(location, &error))? {
                Event::Eof if self.is_complete => return Ok(()),
                Event::Eof => return Err(FileError::truncated(location, "`</model>`")),
                Event::Start(e) | Event::Empty(e) => self.element(&e, location)?,
                Event::End(e) => self.is_complete |= e.local_name().as_ref() == "model",
                _ => {}
            }
            buffer.clear();
        }
    }

    /// Handles the start of an element; elements of extensions are ignored.
    fn element(&mut self, e: &BytesStart, location: Location) -> Result<(), FileError> {
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
        let attributes = Attributes { e, location };
        match e.local_name().as_ref() {
            "object" => self.object(&attributes),
            "vertex" => self.vertex(&attributes),
            "triangle" => self.triangle(&attributes),
            "component" => {
                self.model.count_item(location)?;
                let instance = self.instance(&attributes)?;
                self.open_object().components.push(instance);
                Ok(())
            }
            "item" if self.is_root => {
                self.model.count_item(location)?;
                let instance = self.instance(&attributes)?;
                self.model.build.push(instance);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// The object that is being read.
    fn open_object(&mut self) -> &mut Object {
        self.model.objects.entry(self.open.clone()).or_default()
    }

    fn object(&mut self, attributes: &Attributes) -> Result<(), FileError> {
        self.model.count_item(attributes.location)?;
        self.open.1 = attributes.required("id")?.into();
        let name = attribute(attributes.e, "name").unwrap_or_default();
        // a name with invalid entities is kept as it is
        let name = quick_xml::escape::unescape(&name).map(|name| name.into_owned()).unwrap_or(name);
        let object_type = attribute(attributes.e, "type").unwrap_or_default();
        self.model.objects.insert(self.open.clone(), Object { name, object_type, ..Object::default() });
        Ok(())
    }

    fn vertex(&mut self, attributes: &Attributes) -> Result<(), FileError> {
        let point = Vec3::new(attributes.number("x")?, attributes.number("y")?, attributes.number("z")?);
        self.open_object().vertices.push(point);
        self.model.vertices += 1;
        check_limit(self.options, "vertices", self.model.vertices, attributes.location)
    }

    fn triangle(&mut self, attributes: &Attributes) -> Result<(), FileError> {
        let triangle = [attributes.index("v1")?, attributes.index("v2")?, attributes.index("v3")?];
        self.open_object().triangles.push(triangle);
        self.model.triangles += 1;
        check_limit(self.options, "triangles", self.model.triangles, attributes.location)
    }

    /// The instance that a component or a build item describes.
    fn instance(&mut self, attributes: &Attributes) -> Result<Instance, FileError> {
        let path = attribute(attributes.e, "path");
        let part = match path {
            Some(path) => self.model.part(path.trim_start_matches('/')),
            None => self.part.clone(),
        };
        let transform = transform(attribute(attributes.e, "transform"), attributes.location)?;
        Ok(((part, attributes.required("objectid")?.into()), transform))
    }
}

/// The attributes of an element.
struct Attributes<'a> {
    e: &'a BytesStart<'a>,
    location: Location,
}

impl Attributes<'_> {
    fn required(&self, name: &str) -> Result<String, FileError> {
        let missing = || {
            let problem = format!("the attribute {name} is missing");
            FileError::syntax(self.location, problem, "3MF requires it")
        };
        attribute(self.e, name).ok_or_else(missing)
    }

    fn number(&self, name: &str) -> Result<f64, FileError> {
        let text = self.required(name)?;
        let found = text.trim().parse::<f64>().ok().filter(|x| x.abs() <= Mesh::MAX_COORDINATE);
        found.ok_or_else(|| self.invalid(name, &text, "it must be a finite number"))
    }

    fn index(&self, name: &str) -> Result<u32, FileError> {
        let text = self.required(name)?;
        let found = text.trim().parse::<u32>();
        found.map_err(|_| self.invalid(name, &text, "it must be the index of a vertex"))
    }

    fn invalid(&self, name: &str, text: &str, reason: &str) -> FileError {
        FileError::syntax(self.location, format!("{name} is `{}`", excerpt(text)), reason)
    }
}

/// A transform of twelve numbers: the images of the axes and the translation, as rows.
fn transform(text: Option<String>, location: Location) -> Result<Affine, FileError> {
    let Some(text) = text else {
        return Ok(Affine::IDENTITY);
    };
    let numbers: Vec<f64> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    match numbers[..] {
        [a, b, c, d, e, f, g, h, i, x, y, z] if numbers.iter().all(|n: &f64| n.is_finite()) => {
            let linear = Mat3::from_cols(Vec3::new(a, b, c), Vec3::new(d, e, f), Vec3::new(g, h, i));
            Ok(Affine { linear, translation: Vec3::new(x, y, z) })
        }
        _ => {
            let problem = format!("transform is `{}`", excerpt(&text));
            Err(FileError::syntax(location, problem, "it must be 12 finite numbers"))
        }
    }
}

/// The vertices and triangles of all instances so far, in the frame of the build.
#[derive(Default)]
struct Assembly {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Number of instances.
    count: usize,
}

/// Adds an instance of an object with all its components.
fn add_instance(
    model: &Model,
    item: (&ObjectKey, Affine),
    options: &ReadOptions,
    to: &mut Assembly,
) -> Result<(), FileError> {
    let location = Location::Byte(0);
    let Assembly { vertices, triangles, count } = to;
    let mut waiting = vec![item];
    while let Some((key, transform)) = waiting.pop() {
        *count += 1;
        let (part, id) = key;
        let missing = || {
            let problem = format!("there is no object {id} in the part `{part}`");
            FileError::syntax(location, problem, "the build or a component refers to it")
        };
        let object = model.objects.get(key).ok_or_else(missing)?;
        if *count > MAX_INSTANCES {
            let problem = format!("the build has more than {MAX_INSTANCES} instances");
            return Err(FileError::syntax(location, problem, "components probably contain each other"));
        }
        let first = vertices.len() as u64;
        for (what, sum) in [
            ("vertices", first + object.vertices.len() as u64),
            ("triangles", (triangles.len() + object.triangles.len()) as u64),
        ] {
            check_limit(options, what, sum, location)?;
            check_repetition(what, sum, model.length, location)?;
            Mesh::check_count(what, sum).map_err(|error| FileError::Mesh { location, error })?;
        }
        vertices.extend(object.vertices.iter().map(|&point| transform.point(point)));
        // a reflection reverses the orientation of triangles
        let is_mirror = transform.linear.determinant() < 0.0;
        for corners in &object.triangles {
            if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= object.vertices.len()) {
                let (vertex, count) = (u64::from(vertex), object.vertices.len());
                let error = MeshError::Index { triangle: triangles.len(), vertex, count };
                return Err(FileError::Mesh { location, error });
            }
            let [a, b, c] = corners.map(|corner| corner + first as u32);
            triangles.push(if is_mirror { [a, c, b] } else { [a, b, c] });
        }
        waiting.extend(object.components.iter().rev().map(|(key, inner)| (key, inner.then(&transform))));
    }
    Ok(())
}

/// Units of the core specification (`ST_Unit`) with their abbreviations.
const UNITS: [(&str, &str); 6] = [
    ("micron", "um"),
    ("millimeter", MILLIMETRE),
    ("centimeter", "cm"),
    ("inch", "inch"),
    ("foot", "foot"),
    ("meter", "m"),
];

const MILLIMETRE: &str = "mm";

/// Types of objects that are not part of the model: support structures, and objects for components only.
const AUXILIARY_TYPES: [&str; 3] = ["support", "solidsupport", "other"];

/// The abbreviation of a unit; millimetres by default, `None` for an unknown unit.
fn short_unit(unit: &str) -> Option<&'static str> {
    match unit {
        "" => Some(MILLIMETRE),
        _ => UNITS.iter().find(|(name, _)| *name == unit).map(|(_, short)| *short),
    }
}

const TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>"#;
const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>"#;

/// Writes an archive of meshes in a unit.
pub fn write(objects: &[(&str, &Mesh)], unit: ThreeMfUnit, to: &mut impl Write) -> io::Result<()> {
    let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
    // default options have no time stamp: output is reproducible
    let options = SimpleFileOptions::default();
    for (name, text) in [("[Content_Types].xml", TYPES), ("_rels/.rels", RELATIONSHIPS)] {
        archive.start_file(name, options)?;
        archive.write_all(text.as_bytes())?;
    }
    archive.start_file("3D/3dmodel.model", options)?;
    write_model(objects, unit, &mut archive)?;
    to.write_all(archive.finish()?.get_ref())
}

fn write_model(objects: &[(&str, &Mesh)], unit: ThreeMfUnit, to: &mut impl Write) -> io::Result<()> {
    writeln!(to, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(
        to,
        r#"<model unit="{}" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">"#,
        unit.word()
    )?;
    writeln!(to, "<resources>")?;
    for (number, (name, mesh)) in objects.iter().enumerate() {
        let name = match name.is_empty() {
            true => String::new(),
            false => format!(r#" name="{}""#, quick_xml::escape::escape(printable(name))),
        };
        writeln!(to, r#"<object id="{}" type="model"{name}>"#, number + 1)?;
        write_mesh(mesh, to)?;
        writeln!(to, "</object>")?;
    }
    writeln!(to, "</resources><build>")?;
    for number in 1..=objects.len() {
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
