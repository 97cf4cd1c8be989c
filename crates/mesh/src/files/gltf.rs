//! glTF 2.0, as text with its numbers in it or beside it, and as one binary file (GLB).
//!
//! *Source*: The Khronos Group, "glTF 2.0 Specification" (2021). Read are the triangles, strips and fans of all meshes of the scene,
//! each under the maps of its nodes; lines, points, skins, materials and animations say nothing about the solid. Coordinates
//! are kept as they are: in metres, y up. Compressed and sparse accessors are refused.

use super::{Builder, FileError, Loaded, Place, ReadOptions, within};
use crate::Mesh;
use rayweave_math::{Affine, Mat3, Vec3};
use serde_json::{Value, json};
use std::io::{self, Read, Write};
use std::path::Path;

/// The magic numbers of a binary file and of its two chunks.
const MAGIC: &[u8; 4] = b"glTF";
const JSON: u32 = 0x4e4f_534a;
const BINARY: u32 = 0x004e_4942;
/// The largest file that is read: all of it is held.
const MOST_BYTES: u64 = 1 << 31;

/// Types of the numbers of an accessor.
const BYTE: u64 = 5120;
const UNSIGNED_BYTE: u64 = 5121;
const SHORT: u64 = 5122;
const UNSIGNED_SHORT: u64 = 5123;
const UNSIGNED_INT: u64 = 5125;
const FLOAT: u64 = 5126;

pub fn read(
    mut from: impl Read,
    length: u64,
    folder: Option<&Path>,
    options: &ReadOptions,
) -> Result<Loaded, FileError> {
    if length > MOST_BYTES {
        return Err(refused(format!("a file of {length} bytes (at most {MOST_BYTES} are read)")));
    }
    let mut bytes = Vec::with_capacity(length as usize);
    from.by_ref().take(MOST_BYTES).read_to_end(&mut bytes)?;
    let (text, binary) = chunks(&bytes)?;
    let root: Value = serde_json::from_slice(text)
        .map_err(|error| FileError::syntax(Place::Line(error.line() as u64), error.to_string()))?;
    refuse_old(root["asset"]["version"].as_str(), root["meshes"].is_object())?;
    refuse_extensions(&root)?;
    let buffers = buffers(&root, binary, folder)?;
    let mut scene = Scene { root: &root, buffers, builder: Builder::new(options), left_out: 0, options };
    scene.read()?;
    let Scene { mut builder, left_out, .. } = scene;
    if left_out > 0 {
        builder.warnings.push(format!("{left_out} sets of points and lines were left out"));
    }
    let loaded = builder.finish(Place::Byte(0))?;
    Ok(Loaded { unit: Some("m".to_owned()), ..loaded })
}

fn refused(problem: impl Into<String>) -> FileError {
    FileError::syntax(Place::Byte(0), problem)
}

/// The text and the binary chunk, if there is one.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), FileError> {
    if !bytes.starts_with(MAGIC) {
        return Ok((bytes, None));
    }
    if let Some([1, 0, 0, 0]) = bytes.get(4..8) {
        refuse_old(Some("1.0"), true)?;
    }
    let (text, next) = chunk(bytes, 12, JSON)?;
    let binary = if next < bytes.len() { Some(chunk(bytes, next, BINARY)?.0) } else { None };
    Ok((text, binary))
}

/// The chunk at a byte, and the byte after it.
fn chunk(bytes: &[u8], at: usize, kind: u32) -> Result<(&[u8], usize), FileError> {
    let number = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?));
    let place = Place::Byte(at as u64);
    let found =
        number(at).zip(number(at + 4)).ok_or_else(|| FileError::ends(place, "the head of a chunk"))?;
    if found.1 != kind {
        return Err(FileError::syntax(place, "a chunk of another kind than expected"));
    }
    let end = at + 8 + found.0 as usize;
    let content = bytes.get(at + 8..end).ok_or_else(|| FileError::ends(place, "the end of a chunk"))?;
    Ok((content, end))
}

/// Refuses version 1, which names its entries where version 2 numbers them.
fn refuse_old(version: Option<&str>, has_named_meshes: bool) -> Result<(), FileError> {
    match version {
        Some(version) if version.starts_with("1.") || version == "1" || has_named_meshes => {
            Err(refused(format!("glTF of version {version} (version 2 is read) can it be converted?")))
        }
        None if has_named_meshes => {
            Err(refused("glTF without a version, of the first (version 2 is read) can it be converted?"))
        }
        _ => Ok(()),
    }
}

/// Beginnings of the names of extensions that leave the triangles as they are. Quantised positions are numbers of other types,
/// which the accessors tell.
const HARMLESS: [&str; 6] = [
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "KHR_lights_",
    "KHR_technique",
    "KHR_mesh_quantization",
];

fn refuse_extensions(root: &Value) -> Result<(), FileError> {
    let mut needed = list(root, "extensionsRequired").iter().filter_map(Value::as_str);
    match needed.find(|name| !HARMLESS.iter().any(|known| name.starts_with(known))) {
        Some(name) => Err(refused(format!("the file needs the extension {name} (it is not read)"))),
        None => Ok(()),
    }
}

fn list<'a>(value: &'a Value, name: &str) -> &'a [Value] {
    value[name].as_array().map_or(&[], Vec::as_slice)
}

/// An entry of one of the file's lists.
fn entry<'a>(root: &'a Value, name: &str, index: &Value) -> Result<&'a Value, FileError> {
    let number = index.as_u64().and_then(|index| usize::try_from(index).ok());
    let found = number.and_then(|number| list(root, name).get(number));
    found.ok_or_else(|| refused(format!("{name} has no entry {index}")))
}

/// The bytes of each buffer: the binary chunk, a text, a file beside.
fn buffers(root: &Value, binary: Option<&[u8]>, folder: Option<&Path>) -> Result<Vec<Vec<u8>>, FileError> {
    let mut all = Vec::new();
    for (index, buffer) in list(root, "buffers").iter().enumerate() {
        all.push(match (buffer["uri"].as_str(), binary) {
            (None, Some(binary)) if index == 0 => binary.to_vec(),
            (None, _) => return Err(refused(format!("buffer {index} is nowhere"))),
            (Some(uri), _) => match uri.split_once(";base64,") {
                Some((head, text)) if head.starts_with("data:") => {
                    from_base64(text).ok_or_else(|| refused(format!("buffer {index} is no base64")))?
                }
                _ => beside(uri, folder)?,
            },
        });
    }
    Ok(all)
}

/// A file in the folder of the first, or below it.
fn beside(uri: &str, folder: Option<&Path>) -> Result<Vec<u8>, FileError> {
    let is_plain = |part| matches!(part, std::path::Component::Normal(_));
    let path = folder.filter(|_| Path::new(uri).components().all(is_plain)).map(|folder| folder.join(uri));
    let path = path.ok_or_else(|| refused(format!("the buffer `{uri}` is not beside the file")))?;
    let named = |error: io::Error| refused(format!("the buffer `{uri}`: {error}"));
    if std::fs::metadata(&path).map_err(named)?.len() > MOST_BYTES {
        return Err(refused(format!(
            "the buffer `{uri}` is too large (at most {MOST_BYTES} bytes are read)"
        )));
    }
    std::fs::read(&path).map_err(named)
}

const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// RFC 4648.
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

struct Scene<'a> {
    root: &'a Value,
    buffers: Vec<Vec<u8>>,
    builder: Builder<'a>,
    left_out: usize,
    options: &'a ReadOptions,
}

impl Scene<'_> {
    /// The meshes of the scene's nodes; of all nodes that are nobody's child, if there is no scene.
    fn read(&mut self) -> Result<(), FileError> {
        let root = self.root;
        let nodes = list(root, "nodes");
        let scene = if root["scene"].is_null() { &json!(0) } else { &root["scene"] };
        let mut waiting: Vec<(Value, Affine)> = match list(root, "scenes") {
            [] => roots(nodes).map(|k| (json!(k), Affine::IDENTITY)).collect::<Vec<_>>(),
            _ => {
                let first = list(entry(root, "scenes", scene)?, "nodes");
                first.iter().map(|k| (k.clone(), Affine::IDENTITY)).collect()
            }
        };
        // in the order of the file
        waiting.reverse();
        let mut visited = 0;
        while let Some((index, map)) = waiting.pop() {
            visited += 1;
            // each node has one parent at most, or the nodes form a ring
            if visited > nodes.len() {
                return Err(refused("a node is a child of two, or of itself"));
            }
            let node = entry(root, "nodes", &index)?;
            let map = local(node)?.then(&map);
            if !node["mesh"].is_null() {
                let mesh = entry(root, "meshes", &node["mesh"])?;
                let name = node["name"].as_str().or(mesh["name"].as_str());
                self.builder.start(name.unwrap_or_default());
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
                self.left_out += 1;
                continue;
            }
            let first = self.builder.vertices.len() as u64;
            let positions = self.numbers(&primitive["attributes"]["POSITION"], "VEC3")?;
            for p in positions.chunks_exact(3) {
                self.builder.vertex(map.point(Vec3::new(p[0], p[1], p[2])), Place::Byte(0))?;
            }
            let corners: Vec<u64> = match &primitive["indices"] {
                Value::Null => (0..positions.len() as u64 / 3).collect(),
                indices => self.numbers(indices, "SCALAR")?.into_iter().map(|x| x as u64).collect(),
            };
            // a mirror turns the triangles (glTF 2.0, section 3.7.4)
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
                // every second triangle of a strip turns the other way
                5 => [k, k + 1 + k % 2, k + 2 - k % 2],
                _ => [0, k + 1, k + 2],
            };
            if is_mirror {
                triangle.swap(1, 2);
            }
            self.builder
                .face(&triangle.map(|corner| corners[corner].saturating_add(first)), Place::Byte(0))?;
        }
        Ok(())
    }

    /// The numbers of an accessor.
    fn numbers(&self, index: &Value, kind: &str) -> Result<Vec<f64>, FileError> {
        let accessor = entry(self.root, "accessors", index)?;
        let wrong = |what: &str| refused(format!("accessor {index}: {what}"));
        if accessor["type"] != kind || !accessor["sparse"].is_null() {
            return Err(wrong("of another type than needed, or sparse (it is not read)"));
        }
        let count = accessor["count"].as_u64().unwrap_or(0);
        within(self.options, "vertices", count / 3, Place::Byte(0))?;
        let view = entry(self.root, "bufferViews", &accessor["bufferView"])?;
        let buffer = view["buffer"].as_u64().and_then(|k| self.buffers.get(usize::try_from(k).ok()?));
        let buffer = buffer.ok_or_else(|| wrong("its buffer is nowhere"))?;
        let offset = |value: &Value| value["byteOffset"].as_u64().unwrap_or(0);
        let component = accessor["componentType"].as_u64().unwrap_or(0);
        let size = match component {
            BYTE | UNSIGNED_BYTE => 1,
            SHORT | UNSIGNED_SHORT => 2,
            UNSIGNED_INT | FLOAT => 4,
            _ => return Err(wrong("numbers of a type that is not read")),
        };
        let width = if kind == "VEC3" { 3 } else { 1 };
        let stride = view["byteStride"].as_u64().unwrap_or(size * width);
        let start = offset(view).saturating_add(offset(accessor));
        let end =
            start.saturating_add(stride.saturating_mul(count.saturating_sub(1))).saturating_add(size * width);
        if count > 0 && (end > buffer.len() as u64 || stride < size * width) {
            return Err(wrong("it goes beyond its buffer"));
        }
        let is_normalised = accessor["normalized"] == true;
        let at = |k: u64, axis: u64| {
            let number = number(buffer, (start + k * stride + axis * size) as usize, component);
            if is_normalised { (number / most(component)).max(-1.0) } else { number }
        };
        Ok((0..count).flat_map(|k| (0..width).map(move |axis| at(k, axis))).collect())
    }
}

/// The largest number of a type, which stands for 1 where numbers are normalised.
fn most(component: u64) -> f64 {
    match component {
        BYTE => f64::from(i8::MAX),
        UNSIGNED_BYTE => f64::from(u8::MAX),
        SHORT => f64::from(i16::MAX),
        UNSIGNED_SHORT => f64::from(u16::MAX),
        _ => 1.0,
    }
}

/// The number at a place that is known to be there.
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

/// Nodes that are nobody's child.
fn roots(nodes: &[Value]) -> impl Iterator<Item = u64> {
    let children: Vec<u64> =
        nodes.iter().flat_map(|node| list(node, "children")).filter_map(Value::as_u64).collect();
    (0..nodes.len() as u64).filter(move |k| !children.contains(k))
}

/// The map of a node: a matrix by columns, or scale, rotation and translation.
fn local(node: &Value) -> Result<Affine, FileError> {
    let numbers = |name: &str, plain: &[f64]| -> Result<Vec<f64>, FileError> {
        if node[name].is_null() {
            return Ok(plain.to_vec());
        }
        let found: Vec<f64> = list(node, name).iter().filter_map(Value::as_f64).collect();
        if found.len() == plain.len() {
            Ok(found)
        } else {
            Err(refused(format!("{name} of a node is wrong")))
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

/// The matrix of a quaternion, which need not be of unit length.
fn rotation([x, y, z, w]: [f64; 4]) -> Mat3 {
    let s = 2.0 / (x * x + y * y + z * z + w * w);
    Mat3::from_cols(
        Vec3::new(1.0 - s * (y * y + z * z), s * (x * y + z * w), s * (x * z - y * w)),
        Vec3::new(s * (x * y - z * w), 1.0 - s * (x * x + z * z), s * (y * z + x * w)),
        Vec3::new(s * (x * z + y * w), s * (y * z - x * w), 1.0 - s * (x * x + y * y)),
    )
}

/// The meshes in one binary buffer, each with its coordinates as `f32`, then its corners as `u32`.
fn document(parts: &[(&str, &Mesh)], uri: Option<String>) -> Value {
    let (mut nodes, mut meshes, mut views, mut accessors) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut length = 0;
    for (k, (name, mesh)) in parts.iter().enumerate() {
        let (points, corners) = (12 * mesh.vertices().len(), 12 * mesh.triangles().len());
        let mut node = json!({ "mesh": k });
        if !name.is_empty() {
            node["name"] = (*name).into();
        }
        nodes.push(node);
        let attributes = json!({ "POSITION": 2 * k });
        meshes.push(json!({ "primitives": [{ "attributes": attributes, "indices": 2 * k + 1, "mode": 4 }] }));
        views.push(json!({ "buffer": 0, "byteOffset": length, "byteLength": points, "target": 34962 }));
        views.push(
            json!({ "buffer": 0, "byteOffset": length + points, "byteLength": corners, "target": 34963 }),
        );
        accessors.extend(described(mesh, 2 * k));
        length += points + corners;
    }
    let mut buffer = json!({ "byteLength": length });
    if let Some(uri) = uri {
        buffer["uri"] = uri.into();
    }
    let scene = json!({ "nodes": (0..parts.len()).collect::<Vec<_>>() });
    json!({
        "asset": { "version": "2.0", "generator": "rayweave" },
        "scene": 0, "scenes": [scene], "nodes": nodes, "meshes": meshes,
        "buffers": [buffer], "bufferViews": views, "accessors": accessors,
    })
}

/// The accessors of a mesh: its points in a view, its corners in the next.
fn described(mesh: &Mesh, view: usize) -> [Value; 2] {
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

fn buffer(parts: &[(&str, &Mesh)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (_, mesh) in parts {
        bytes
            .extend(mesh.vertices().iter().flat_map(|p| p.to_array()).flat_map(|x| (x as f32).to_le_bytes()));
        bytes.extend(mesh.triangles().iter().flatten().flat_map(|corner| corner.to_le_bytes()));
    }
    bytes
}

pub fn write_text(parts: &[(&str, &Mesh)], to: &mut impl Write) -> io::Result<()> {
    let uri = format!("data:application/octet-stream;base64,{}", to_base64(&buffer(parts)));
    write!(to, "{}", document(parts, Some(uri)))
}

pub fn write_binary(parts: &[(&str, &Mesh)], to: &mut impl Write) -> io::Result<()> {
    let mut text = document(parts, None).to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let binary = buffer(parts);
    let length = 12 + 8 + text.len() + 8 + binary.len();
    let length = u32::try_from(length).map_err(|_| io::Error::other("a mesh too large for GLB"))?;
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
