//! glTF 2.0 and GLB reader and writer: JSON text with embedded or external buffers, or one binary file.
//!
//! *Source*: The Khronos Group, "glTF 2.0 Specification" (2021). The reader loads the triangles, triangle strips and triangle fans
//! of all meshes of the scene under the transforms of their nodes. Lines and points are ignored with a warning; skins,
//! materials and animations do not affect the solid. Coordinates are kept as they are: in metres, y up. Compressed and sparse
//! accessors are rejected.

use crate::budget::check_repetition;
use crate::builder::{MeshBuilder, check_limit};
use crate::{FileError, LoadedMesh, Location, ReadOptions};
use rayweave_error::Message;
use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_mesh::Mesh;
use rayweave_table::{AllowedFiles, RefusedFile};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::io::{self, Read, Write};
use std::path::Path;
use std::rc::Rc;

/// The magic numbers of a GLB file and of its two chunks.
const MAGIC: &[u8; 4] = b"glTF";
const JSON: u32 = 0x4e4f_534a;
const BINARY: u32 = 0x004e_4942;
/// The maximal size of a file, which is read into memory, in bytes.
const MAX_BYTES: u64 = 1 << 31;
/// The maximal size of all buffers outside of the binary chunk together, in bytes: coordinates and corners of 20 million vertices
/// and triangles take 480 MB.
const MAX_BUFFER_BYTES: u64 = 1 << 29;

/// Component types of accessors.
const BYTE: u64 = 5120;
const UNSIGNED_BYTE: u64 = 5121;
const SHORT: u64 = 5122;
const UNSIGNED_SHORT: u64 = 5123;
const UNSIGNED_INT: u64 = 5125;
const FLOAT: u64 = 5126;

pub fn read(
    mut from: impl Read,
    length: u64,
    folder: Option<(&Path, &AllowedFiles)>,
    options: &ReadOptions,
) -> Result<LoadedMesh, FileError> {
    if length > MAX_BYTES {
        return Err(invalid(format!("the file has {length} bytes"), format!("the limit is {MAX_BYTES}")));
    }
    let mut bytes = Vec::with_capacity(length as usize);
    from.by_ref().take(MAX_BYTES).read_to_end(&mut bytes)?;
    let (text, binary) = chunks(&bytes)?;
    let root: Value = serde_json::from_slice(text).map_err(|error| json_error(&error))?;
    reject_version_1(root["asset"]["version"].as_str(), root["meshes"].is_object())?;
    reject_extensions(&root)?;
    let buffers = buffers(&root, binary, folder)?;
    let mut scene = SceneReader::new(&root, buffers, length, options);
    scene.read()?;
    let SceneReader { mut builder, ignored, .. } = scene;
    if ignored > 0 {
        builder.warnings.push(format!("{ignored} sets of points and lines were ignored"));
    }
    let loaded = builder.finish(Location::Byte(0))?;
    Ok(LoadedMesh { unit: Some("m".to_owned()), ..loaded })
}

fn invalid(problem: impl Into<String>, reason: impl Into<String>) -> FileError {
    FileError::syntax(Location::Byte(0), problem, reason)
}

fn json_error(error: &serde_json::Error) -> FileError {
    FileError::syntax(Location::Line(error.line() as u64), "the JSON is invalid", error.to_string())
}

/// The JSON text and the binary chunk of a GLB file, if there is one.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), FileError> {
    if !bytes.starts_with(MAGIC) {
        return Ok((bytes, None));
    }
    if let Some([1, 0, 0, 0]) = bytes.get(4..8) {
        reject_version_1(Some("1.0"), true)?;
    }
    let (text, next) = chunk(bytes, 12, JSON)?;
    let binary = if next < bytes.len() { Some(chunk(bytes, next, BINARY)?.0) } else { None };
    Ok((text, binary))
}

/// The contents of the chunk at an offset, and the offset after it.
fn chunk(bytes: &[u8], at: usize, kind: u32) -> Result<(&[u8], usize), FileError> {
    let number = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let location = Location::Byte(at as u64);
    let found = number(at)
        .zip(number(at + 4))
        .ok_or_else(|| FileError::truncated(location, "the header of a chunk"))?;
    if found.1 != kind {
        let problem = "the chunk has an unexpected type";
        return Err(FileError::syntax(location, problem, "GLB has a JSON chunk and then a binary chunk"));
    }
    let end = at + 8 + found.0 as usize;
    let content =
        bytes.get(at + 8..end).ok_or_else(|| FileError::truncated(location, "the end of a chunk"))?;
    Ok((content, end))
}

/// Rejects version 1, which refers to entries by name instead of by index.
fn reject_version_1(version: Option<&str>, has_named_meshes: bool) -> Result<(), FileError> {
    match version {
        Some(version) if version.starts_with("1.") || version == "1" || has_named_meshes => {
            Err(old_version(&format!("version {version}")))
        }
        None if has_named_meshes => Err(old_version("no version")),
        _ => Ok(()),
    }
}

fn old_version(version: &str) -> FileError {
    let message = Message::new(format!("the glTF file has {version}"), "only version 2 is supported");
    FileError::Syntax { location: Location::Byte(0), message: message.suggest("Convert it") }
}

/// Name prefixes of extensions that do not change triangles. Quantised positions are accessors with different component
/// types.
const HARMLESS: [&str; 6] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "KHR_lights_",
    "KHR_technique",
    "KHR_mesh_quantization",
];

fn reject_extensions(root: &Value) -> Result<(), FileError> {
    let mut needed = list(root, "extensionsRequired").iter().filter_map(Value::as_str);
    match needed.find(|name| !HARMLESS.iter().any(|known| name.starts_with(known))) {
        Some(name) => Err(invalid(format!("the file requires the extension {name}"), "it is not supported")),
        None => Ok(()),
    }
}

fn list<'a>(value: &'a Value, name: &str) -> &'a [Value] {
    value[name].as_array().map_or(&[], Vec::as_slice)
}

/// An entry of a top-level list by its index.
fn entry<'a>(root: &'a Value, name: &str, index: &Value) -> Result<&'a Value, FileError> {
    let number = index.as_u64().and_then(|index| usize::try_from(index).ok());
    let found = number.and_then(|number| list(root, name).get(number));
    found.ok_or_else(|| {
        invalid(format!("{name} has no entry {index}"), format!("it has {}", list(root, name).len()))
    })
}

/// The contents of all buffers: the binary chunk, a data URI, or a file beside the document. Buffers of the same URI share them.
fn buffers<'a>(
    root: &'a Value,
    binary: Option<&'a [u8]>,
    folder: Option<(&Path, &AllowedFiles)>,
) -> Result<Vec<Rc<Cow<'a, [u8]>>>, FileError> {
    let mut all: Vec<Rc<Cow<[u8]>>> = Vec::new();
    let mut known: HashMap<&str, Rc<Cow<[u8]>>> = HashMap::new();
    let mut left = MAX_BUFFER_BYTES;
    for (index, buffer) in list(root, "buffers").iter().enumerate() {
        let contents = match (buffer["uri"].as_str(), binary) {
            (None, Some(binary)) if index == 0 => Rc::new(Cow::Borrowed(binary)),
            (None, _) => {
                return Err(invalid(
                    format!("buffer {index} has no data"),
                    "it has no URI, and no binary chunk is left",
                ));
            }
            (Some(uri), _) => match known.get(uri) {
                Some(contents) => contents.clone(),
                None => {
                    let contents = contents(index, uri, folder, left)?;
                    left -= (contents.len() as u64).min(left);
                    let contents = Rc::new(Cow::<[u8]>::Owned(contents));
                    known.insert(uri, contents.clone());
                    contents
                }
            },
        };
        all.push(contents);
    }
    Ok(all)
}

/// The contents of a buffer with a URI, at most `left` bytes.
fn contents(
    index: usize,
    uri: &str,
    folder: Option<(&Path, &AllowedFiles)>,
    left: u64,
) -> Result<Vec<u8>, FileError> {
    match uri.split_once(";base64,") {
        Some((head, text)) if head.starts_with("data:") => {
            if text.len() as u64 / 4 * 3 > left {
                return Err(too_large(index));
            }
            let problem = || invalid(format!("buffer {index} is invalid"), "its URI is not base64");
            from_base64(text).ok_or_else(problem)
        }
        _ => read_external(index, uri, folder, left),
    }
}

fn too_large(index: usize) -> FileError {
    let reason = format!("together the buffers may have {MAX_BUFFER_BYTES} bytes");
    invalid(format!("buffer {index} is too large"), reason)
}

/// The contents of an external buffer, with its name relative to the folder of the document.
fn read_external(
    index: usize,
    uri: &str,
    folder: Option<(&Path, &AllowedFiles)>,
    left: u64,
) -> Result<Vec<u8>, FileError> {
    let refused =
        |error: RefusedFile| invalid(format!("the buffer `{uri}` cannot be read"), error.to_string());
    let (folder, files) = folder.ok_or_else(|| refused(RefusedFile::Outside))?;
    let file = files.open(&folder.join(uri)).map_err(refused)?;
    let unreadable = |error: io::Error| refused(RefusedFile::Io(error));
    if file.metadata().map_err(unreadable)?.len() > left {
        return Err(too_large(index));
    }
    // the file may grow meanwhile
    let mut bytes = Vec::new();
    file.take(left + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > left { Err(too_large(index)) } else { Ok(bytes) }
}

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Decodes base64 (RFC 4648).
fn from_base64(text: &str) -> Option<Vec<u8>> {
    let digits = text.trim_end_matches('=').bytes();
    let (mut bytes, mut held, mut count) = (Vec::with_capacity(text.len() / 4 * 3), 0u32, 0);
    for digit in digits {
        held = held << 6 | DIGITS.iter().position(|&known| known == digit)? as u32;
        count += 6;
        if count >= 8 {
            count -= 8;
            bytes.push((held >> count) as u8);
        }
    }
    Some(bytes)
}

fn to_base64(bytes: &[u8]) -> String {
    let four = |three: &[u8]| {
        let held = (0..3).fold(0, |held, k| held << 8 | u32::from(three.get(k).copied().unwrap_or(0)));
        let digit = |k: usize| {
            if k > three.len() { '=' } else { char::from(DIGITS[(held >> (18 - 6 * k) & 63) as usize]) }
        };
        [0, 1, 2, 3].map(digit)
    };
    bytes.chunks(3).flat_map(four).collect()
}

/// Reader of the scene graph.
struct SceneReader<'a> {
    root: &'a Value,
    buffers: Vec<Rc<Cow<'a, [u8]>>>,
    builder: MeshBuilder<'a>,
    /// Number of primitives without triangles.
    ignored: usize,
    /// The length of the file with its external buffers, in bytes.
    length: u64,
    options: &'a ReadOptions,
}

impl<'a> SceneReader<'a> {
    fn new(
        root: &'a Value,
        buffers: Vec<Rc<Cow<'a, [u8]>>>,
        length: u64,
        options: &'a ReadOptions,
    ) -> SceneReader<'a> {
        let mut seen = HashSet::new();
        let external = buffers.iter().filter(|buffer| seen.insert(buffer.as_ptr()));
        let length = length + external.map(|buffer| buffer.len() as u64).sum::<u64>();
        SceneReader { root, buffers, builder: MeshBuilder::new(options), ignored: 0, length, options }
    }

    /// Reads the meshes of all nodes of the scene, or of all root nodes if there is no scene.
    fn read(&mut self) -> Result<(), FileError> {
        let root = self.root;
        let nodes = list(root, "nodes");
        let scene = if root["scene"].is_null() { &json!(0) } else { &root["scene"] };
        let mut waiting: Vec<(Value, Affine)> = match list(root, "scenes") {
            [] => root_nodes(nodes).map(|k| (json!(k), Affine::IDENTITY)).collect::<Vec<_>>(),
            _ => {
                let first = list(entry(root, "scenes", scene)?, "nodes");
                first.iter().map(|k| (k.clone(), Affine::IDENTITY)).collect()
            }
        };
        // last in, first out: the order of the file
        waiting.reverse();
        let mut visited = 0;
        while let Some((index, map)) = waiting.pop() {
            visited += 1;
            // a node may have one parent only, so that more visits than nodes reveal a cycle or a shared node
            if visited > nodes.len() {
                let problem = "a node is a child of two nodes, or of itself";
                return Err(invalid(problem, "the nodes of glTF form trees"));
            }
            let node = entry(root, "nodes", &index)?;
            let map = local_transform(node)?.then(&map);
            if !node["mesh"].is_null() {
                let mesh = entry(root, "meshes", &node["mesh"])?;
                let name = node["name"].as_str().or(mesh["name"].as_str());
                self.builder.start_object(name.unwrap_or_default());
                self.mesh(mesh, &map)?;
            }
            waiting.extend(list(node, "children").iter().rev().map(|child| (child.clone(), map)));
        }
        Ok(())
    }

    fn mesh(&mut self, mesh: &Value, map: &Affine) -> Result<(), FileError> {
        for primitive in list(mesh, "primitives") {
            let mode = primitive["mode"].as_u64().unwrap_or(4);
            if !(4..=6).contains(&mode) {
                self.ignored += 1;
                continue;
            }
            let first = self.builder.vertices.len() as u64;
            let positions = self.numbers(&primitive["attributes"]["POSITION"], "VEC3")?;
            let corners: Vec<u64> = match &primitive["indices"] {
                Value::Null => (0..positions.len() as u64 / 3).collect(),
                indices => self.numbers(indices, "SCALAR")?.into_iter().map(|x| x as u64).collect(),
            };
            let made = self.builder.vertices.len().max(self.builder.triangles.len());
            let more = (positions.len() / 3).max(corners.len());
            let (what, made) = ("vertices and triangles", (made + more) as u64);
            check_repetition(what, made, self.length, Location::Byte(0))?;
            for p in positions.chunks_exact(3) {
                self.builder.add_vertex(map.point(Vec3::new(p[0], p[1], p[2])), Location::Byte(0))?;
            }
            // a reflection reverses the orientation of triangles (glTF 2.0, section 3.7.4)
            let is_mirror = map.linear.determinant() < 0.0;
            self.triangles(&corners, mode, first, is_mirror)?;
        }
        Ok(())
    }

    fn triangles(
        &mut self,
        corners: &[u64],
        mode: u64,
        first: u64,
        is_mirror: bool,
    ) -> Result<(), FileError> {
        let count = match mode {
            4 => corners.len() / 3,
            _ => corners.len().saturating_sub(2),
        };
        for k in 0..count {
            let mut triangle = match mode {
                4 => [3 * k, 3 * k + 1, 3 * k + 2],
                // every second triangle of a strip has the opposite orientation
                5 => [k, k + 1 + k % 2, k + 2 - k % 2],
                _ => [0, k + 1, k + 2],
            };
            if is_mirror {
                triangle.swap(1, 2);
            }
            self.builder
                .add_face(&triangle.map(|corner| corners[corner].saturating_add(first)), Location::Byte(0))?;
        }
        Ok(())
    }

    /// The numbers of an accessor of type `SCALAR` or `VEC3`.
    fn numbers(&self, index: &Value, accessor_type: &str) -> Result<Vec<f64>, FileError> {
        let accessor = entry(self.root, "accessors", index)?;
        let wrong = |reason: &str| invalid(format!("accessor {index} cannot be read"), reason);
        if accessor["type"] != accessor_type {
            return Err(wrong(&format!("its type is not {accessor_type}")));
        }
        if !accessor["sparse"].is_null() {
            return Err(wrong("sparse accessors are not supported"));
        }
        let count = accessor["count"].as_u64().unwrap_or(0);
        check_limit(self.options, "vertices", count / 3, Location::Byte(0))?;
        let view = entry(self.root, "bufferViews", &accessor["bufferView"])?;
        let buffer = view["buffer"].as_u64().and_then(|k| self.buffers.get(usize::try_from(k).ok()?));
        let buffer = buffer.ok_or_else(|| wrong("its buffer does not exist"))?;
        let offset = |value: &Value| value["byteOffset"].as_u64().unwrap_or(0);
        let component = accessor["componentType"].as_u64().unwrap_or(0);
        let size = match component {
            BYTE | UNSIGNED_BYTE => 1,
            SHORT | UNSIGNED_SHORT => 2,
            UNSIGNED_INT | FLOAT => 4,
            _ => return Err(wrong("its component type is unknown")),
        };
        let width = if accessor_type == "VEC3" { 3 } else { 1 };
        let stride = view["byteStride"].as_u64().unwrap_or(size * width);
        let start = offset(view).saturating_add(offset(accessor));
        let end =
            start.saturating_add(stride.saturating_mul(count.saturating_sub(1))).saturating_add(size * width);
        if count > 0 && (end > buffer.len() as u64 || stride < size * width) {
            return Err(wrong("it exceeds its buffer"));
        }
        let is_normalised = accessor["normalized"] == true;
        let at = |k: u64, axis: u64| {
            let number = number(buffer, (start + k * stride + axis * size) as usize, component);
            if is_normalised { (number / max_integer(component)).max(-1.0) } else { number }
        };
        Ok((0..count).flat_map(|k| (0..width).map(move |axis| at(k, axis))).collect())
    }
}

/// The largest integer of a component type, which represents 1 in normalised accessors.
fn max_integer(component: u64) -> f64 {
    match component {
        BYTE => f64::from(i8::MAX),
        UNSIGNED_BYTE => f64::from(u8::MAX),
        SHORT => f64::from(i16::MAX),
        UNSIGNED_SHORT => f64::from(u16::MAX),
        _ => 1.0,
    }
}

/// The number at an offset that is within the bytes.
fn number(bytes: &[u8], at: usize, component: u64) -> f64 {
    let four = || [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
    match component {
        BYTE => f64::from(bytes[at] as i8),
        UNSIGNED_BYTE => f64::from(bytes[at]),
        SHORT => f64::from(i16::from_le_bytes([bytes[at], bytes[at + 1]])),
        UNSIGNED_SHORT => f64::from(u16::from_le_bytes([bytes[at], bytes[at + 1]])),
        UNSIGNED_INT => f64::from(u32::from_le_bytes(four())),
        _ => f64::from(f32::from_le_bytes(four())),
    }
}

/// The nodes without a parent.
fn root_nodes(nodes: &[Value]) -> impl Iterator<Item = u64> {
    let children: HashSet<u64> =
        nodes.iter().flat_map(|node| list(node, "children")).filter_map(Value::as_u64).collect();
    (0..nodes.len() as u64).filter(move |k| !children.contains(k))
}

/// The transform of a node: a matrix by columns, or scale, rotation and translation.
fn local_transform(node: &Value) -> Result<Affine, FileError> {
    let numbers = |name: &str, default: &[f64]| -> Result<Vec<f64>, FileError> {
        if node[name].is_null() {
            return Ok(default.to_vec());
        }
        let found: Vec<f64> = list(node, name).iter().filter_map(Value::as_f64).collect();
        if found.len() == default.len() {
            Ok(found)
        } else {
            let reason = format!("it must be {} numbers", default.len());
            Err(invalid(format!("the {name} of a node is invalid"), reason))
        }
    };
    if !node["matrix"].is_null() {
        let m = numbers("matrix", &[0.0; 16])?;
        let column = |k: usize| Vec3::new(m[4 * k], m[4 * k + 1], m[4 * k + 2]);
        let linear = Mat3::from_cols(column(0), column(1), column(2));
        return Ok(Affine { linear, translation: column(3) });
    }
    let (s, t) = (numbers("scale", &[1.0; 3])?, numbers("translation", &[0.0; 3])?);
    let q = numbers("rotation", &[0.0, 0.0, 0.0, 1.0])?;
    let linear = rotation([q[0], q[1], q[2], q[3]]) * Mat3::from_diagonal(Vec3::new(s[0], s[1], s[2]));
    Ok(Affine { linear, translation: Vec3::new(t[0], t[1], t[2]) })
}

/// The rotation matrix of a quaternion of any length.
fn rotation([x, y, z, w]: [f64; 4]) -> Mat3 {
    let s = 2.0 / (x * x + y * y + z * z + w * w);
    Mat3::from_cols(
        Vec3::new(1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)),
        Vec3::new(s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w)),
        Vec3::new(s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y)),
    )
}

/// The JSON document for meshes in one buffer: for each mesh its coordinates as `f32`, then its vertex indices as `u32`.
fn document(objects: &[(&str, &Mesh)], uri: Option<String>) -> Value {
    let (mut nodes, mut meshes, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut length = 0;
    for (k, (name, mesh)) in objects.iter().enumerate() {
        let (points, corners) = (12 * mesh.vertices().len(), 12 * mesh.triangles().len());
        let attributes = json!({ "POSITION": 2 * k });
        let primitive = json!({ "attributes": attributes, "indices": 2 * k + 1, "mode": 4 });
        let (mut node, mut shape) = (json!({ "mesh": k }), json!({ "primitives": [primitive] }));
        if !name.is_empty() {
            // some programs read the names of nodes, others those of meshes
            node["name"] = (*name).into();
            shape["name"] = (*name).into();
        }
        nodes.push(node);
        meshes.push(shape);
        views.push(json!({ "buffer": 0, "byteOffset": length, "byteLength": points, "target": 34962 }));
        views.push(
            json!({ "buffer": 0, "byteOffset": length + points, "byteLength": corners, "target": 34963 }),
        );
        accessors.extend(accessors_of(mesh, 2 * k));
        length += points + corners;
    }
    let mut buffer = json!({ "byteLength": length });
    if let Some(uri) = uri {
        buffer["uri"] = uri.into();
    }
    let scene = json!({ "nodes": (0..objects.len()).collect::<Vec<_>>() });
    json!({
        "asset": { "version": "2.0", "generator": "rayweave" },
        "scene": 0, "scenes": [scene], "nodes": nodes, "meshes": meshes,
        "buffers": [buffer], "bufferViews": views, "accessors": accessors,
    })
}

/// The two accessors of a mesh: positions in a buffer view, indices in the next.
fn accessors_of(mesh: &Mesh, view: usize) -> [Value; 2] {
    let single = |p: Vec3| p.to_array().map(|x| f64::from(x as f32));
    let bounds = mesh
        .vertices()
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), &p| (lo.min(p), hi.max(p)));
    [
        json!({ "bufferView": view, "componentType": FLOAT, "count": mesh.vertices().len(), "type": "VEC3",
                "min": single(bounds.0), "max": single(bounds.1) }),
        json!({ "bufferView": view + 1, "componentType": UNSIGNED_INT, "count": 3 * mesh.triangles().len(), "type": "SCALAR" }),
    ]
}

/// The buffer that [`document`] describes.
fn buffer(objects: &[(&str, &Mesh)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (_, mesh) in objects {
        bytes
            .extend(mesh.vertices().iter().flat_map(|p| p.to_array()).flat_map(|x| (x as f32).to_le_bytes()));
        bytes.extend(mesh.triangles().iter().flatten().flat_map(|corner| corner.to_le_bytes()));
    }
    bytes
}

pub fn write_text(objects: &[(&str, &Mesh)], to: &mut impl Write) -> io::Result<()> {
    let uri = format!("data:application/octet-stream;base64,{}", to_base64(&buffer(objects)));
    write!(to, "{}", document(objects, Some(uri)))
}

pub fn write_binary(objects: &[(&str, &Mesh)], to: &mut impl Write) -> io::Result<()> {
    let mut text = document(objects, None).to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let binary = buffer(objects);
    let length = 12 + 8 + text.len() + 8 + binary.len();
    let length = u32::try_from(length)
        .map_err(|_| io::Error::other("the mesh is too large for GLB: its length must be below 4 GiB"))?;
    to.write_all(MAGIC)?;
    for number in [2, length, text.len() as u32, JSON] {
        to.write_all(&number.to_le_bytes())?;
    }
    to.write_all(&text)?;
    for number in [binary.len() as u32, BINARY] {
        to.write_all(&number.to_le_bytes())?;
    }
    to.write_all(&binary)
}
