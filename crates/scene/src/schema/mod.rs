//! The JSON schema of the model file, for completion and validation in editors.

mod optics;
mod outline;
mod parts;
mod photons;

use crate::colour_names::COLOUR_NAMES;
use crate::document::Shading;
use crate::formats::native::VERSION;
use crate::keys::{EXTRUDE, REVOLVE};
use crate::unit::Unit;
use parts::{list, reference, table, text};
use rayweave_shape::primitive::{MANUALS, Manual, Parameter, ParameterKind};
use serde_json::{Map, Value, json};

/// The JSON schema (draft 2020-12) of the native model file. The schemas of the shapes are
/// generated from their manual pages.
pub fn schema() -> Value {
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Rayweave model",
        "type": "object",
        "properties": {
            "rayweave": { "const": VERSION as u64, "description": "The version of the format." },
            "unit": { "enum": Unit::ALL.map(|(_, symbol, _)| symbol), "description": "The unit of all lengths." },
            "parameters": {
                "description": "Named numbers; they may depend on each other in any order.",
                "type": "object",
                "additionalProperties": reference("number"),
            },
            "solid": {
                "description": "Named solids.",
                "type": "object",
                "additionalProperties": solid(),
            },
            "region": {
                "description": "Solids made of media; where they overlap, the last one has priority.",
                "type": "array",
                "items": region(),
            },
            "medium": {
                "description": "Media; `world` is the medium around everything.",
                "type": "object",
                "additionalProperties": medium(),
            },
            "camera": camera(),
            "light": { "description": "Lights.", "type": "array", "items": light() },
            "render": render(),
            "optics": optics::optics(),
            "photons": photons::photons(),
        },
        // tables with other names belong to other programs
        "additionalProperties": { "type": ["object", "array"] },
        "$defs": definitions(),
    })
}

fn definitions() -> Value {
    let mut definitions = json!({
        "number": {
            "description": "A number, or an arithmetic expression in parameters.",
            "type": ["number", "string"],
        },
        "vector": list("number", 3),
        "row": list("number", 4),
        "matrix": list("row", 4),
        "colour": {
            "description": "A name of CSS such as red, or #rgb, #rrggbb or #rrggbbaa",
            "type": "string",
            "anyOf": [
                { "pattern": "^#([0-9a-fA-F]{3}|[0-9a-fA-F]{6}|[0-9a-fA-F]{8})$" },
                { "enum": COLOUR_NAMES.map(|(name, _)| name).to_vec() },
            ],
        },
        "step": step(),
        "transform": {
            "description": "Maps, applied in this order.",
            "anyOf": [{ "type": "array", "items": reference("step") }, reference("step")],
        },
    });
    for (name, definition) in outline::definitions() {
        definitions[name] = definition;
    }
    definitions
}

fn solid() -> Value {
    let mut properties = Map::new();
    properties
        .insert("expr".into(), text("A boolean expression over names of solids: | & - ^ ~ and parentheses."));
    properties.insert("place".into(), place());
    properties.insert(EXTRUDE.into(), outline::extrude());
    properties.insert(REVOLVE.into(), outline::revolve());
    let shapes = MANUALS.iter().map(|manual| (manual.name.to_owned(), shape(manual)));
    properties.extend(shapes);
    let bodies: Vec<Value> = properties.keys().map(|key| json!({ "required": [key] })).collect();
    properties.insert("transform".into(), reference("transform"));
    properties.insert("name".into(), text("The name used within its face names; by default its own name."));
    json!({
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
        "oneOf": bodies,
    })
}

fn shape(manual: &Manual) -> Value {
    let properties: Map<String, Value> = manual
        .parameters
        .iter()
        .map(|parameter| (parameter.name.to_owned(), parameter_schema(parameter)))
        .collect();
    let needed = manual.parameters.iter().filter(|parameter| parameter.default_value().is_none());
    let needed: Vec<&str> = needed.map(|parameter| parameter.name).collect();
    match manual.name {
        "mesh" => mesh(manual.summary, properties, &needed),
        _ => table(manual.summary, properties.into(), &needed),
    }
}

/// A mesh, given in the model file or as a separate file in its folder.
fn mesh(summary: &str, mut properties: Map<String, Value>, needed: &[&str]) -> Value {
    properties
        .insert("file".into(), text("A file in the folder of the model: STL, OBJ, PLY, OFF, 3MF or glTF."));
    let repair = "Whether a mesh in a file is repaired as far as that is safe.";
    properties.insert("repair".into(), json!({ "type": "boolean", "description": repair }));
    let mut schema = table(summary, properties.into(), &[]);
    schema["oneOf"] = json!([{ "required": needed }, { "required": ["file"] }]);
    schema
}

fn parameter_schema(parameter: &Parameter) -> Value {
    let mut schema = match parameter.kind {
        ParameterKind::Number | ParameterKind::Count => reference("number"),
        ParameterKind::Vector3 => reference("vector"),
        ParameterKind::NumberOrVector3 => json!({ "anyOf": [reference("number"), reference("vector")] }),
        ParameterKind::Planes => json!({ "type": "array", "items": reference("row"), "minItems": 1 }),
        ParameterKind::Triples => json!({ "type": "array", "items": reference("vector"), "minItems": 1 }),
        ParameterKind::Matrix4 => reference("matrix"),
        ParameterKind::Numbers => json!({ "type": "array", "items": reference("number") }),
    };
    schema["description"] = format!("{} ({}, {})", parameter.summary, parameter.unit, parameter.range).into();
    schema
}

fn place() -> Value {
    let mut place = table(
        "A solid, placed many times.",
        json!({
            "solid": text("The name of the solid."),
            "grid": list("number", 3),
            "step": reference("vector"),
            "origin": reference("vector"),
            "ring": reference("number"),
            "radius": reference("number"),
            "start": reference("number"),
            "at": { "type": "array", "items": reference("vector") },
            "matrices": { "type": "array", "items": reference("matrix") },
            "file": text("An NPY file in the folder of the model: float64, (N, 3) or (N, 4, 4)."),
            "name": text("The name of the copies in occurrence paths; that of the solid by default."),
            "numbers": { "type": "array", "items": reference("number") },
        }),
        &["solid"],
    );
    place["dependentRequired"] = json!({ "numbers": ["name"] });
    place["oneOf"] = json!([
        { "required": ["grid", "step"] },
        { "required": ["ring", "radius"] },
        { "required": ["at"] },
        { "required": ["matrices"] },
        { "required": ["file"] },
    ]);
    place
}

fn step() -> Value {
    let rotate = table(
        "Turn about an axis through the origin.",
        json!({ "axis": reference("vector"), "degrees": reference("number") }),
        &["axis", "degrees"],
    );
    let mut step = table(
        "One map.",
        json!({
            "translate": reference("vector"),
            "rotate_x": reference("number"),
            "rotate_y": reference("number"),
            "rotate_z": reference("number"),
            "rotate": rotate,
            "scale": { "anyOf": [reference("number"), reference("vector")] },
            "mirror": reference("vector"),
            "matrix": reference("matrix"),
        }),
        &[],
    );
    step["minProperties"] = 1.into();
    step["maxProperties"] = 1.into();
    step
}

fn region() -> Value {
    table(
        "A solid made of a medium.",
        json!({
            "solid": text("The name of the solid."),
            "medium": text("The name of the medium; by default, the region has its own medium."),
            "colour": reference("colour"),
            "name": text("The name of the region; by default that of its solid."),
        }),
        &["solid"],
    )
}

fn medium() -> Value {
    json!({
        "type": "object",
        "properties": {
            "index": reference("number"),
            "colour": reference("colour"),
        },
    })
}

fn camera() -> Value {
    table(
        "The camera of pictures.",
        json!({
            "projection": { "enum": ["perspective", "orthographic"] },
            "fov": reference("number"),
            "height": reference("number"),
            "position": reference("vector"),
            "target": reference("vector"),
            "up": reference("vector"),
            "size": list("number", 2),
        }),
        &["position"],
    )
}

fn light() -> Value {
    let mut light = table(
        "Parallel light, or light from a point.",
        json!({
            "direction": reference("vector"),
            "position": reference("vector"),
            "intensity": reference("number"),
            "colour": reference("colour"),
        }),
        &[],
    );
    light["oneOf"] = json!([{ "required": ["direction"] }, { "required": ["position"] }]);
    light
}

fn render() -> Value {
    table(
        "Options of pictures.",
        json!({
            "background": reference("colour"),
            "shading": { "enum": Shading::ALL.map(|(_, name)| name) },
            "edges": { "type": "boolean" },
            "shadows": { "type": "boolean" },
            "samples": reference("number"),
        }),
        &[],
    )
}
