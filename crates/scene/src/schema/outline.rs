//! Schema of extruded and revolved outlines.

use super::parts::{list, reference, table, text};
use serde_json::{Value, json};

/// The definitions that the schemas of this file refer to.
pub fn definitions() -> [(&'static str, Value); 4] {
    let point = table(
        "A point of a contour, with the form of its corner, or the arc to the next point.",
        json!({
            "at": reference("pair"),
            "fillet": reference("number"),
            "chamfer": reference("number"),
            "bulge": reference("number"),
            "through": reference("pair"),
        }),
        &["at"],
    );
    let circle =
        table("A circle.", json!({ "circle": reference("number"), "at": reference("pair") }), &["circle"]);
    let points = json!({
        "type": "array",
        "minItems": 2,
        "items": { "anyOf": [reference("pair"), point] },
    });
    let mut rim = table(
        "The treatment of all edges of one end.",
        json!({ "fillet": reference("number"), "chamfer": reference("number") }),
        &[],
    );
    rim["oneOf"] = json!([{ "required": ["fillet"] }, { "required": ["chamfer"] }]);
    let outline = json!({
        "description": "A contour, or a list of contours; points within an odd number of them are inside.",
        "anyOf": [reference("contour"), { "type": "array", "items": reference("contour") }],
    });
    [
        ("pair", list("number", 2)),
        ("contour", json!({ "anyOf": [points, circle] })),
        ("outline", outline),
        ("rim", rim),
    ]
}

pub fn extrude() -> Value {
    let mut schema = table(
        "An outline extruded along z.",
        json!({
            "outline": reference("outline"),
            "file": text("A DXF or SVG file in the folder of the model, instead of `outline`."),
            "layer": text("The layer of a DXF file."),
            "scale": reference("number"),
            "height": reference("number"),
            "z": reference("pair"),
            "fillet": reference("number"),
            "chamfer": reference("number"),
            "top": reference("rim"),
            "bottom": reference("rim"),
        }),
        &[],
    );
    let forms = [("outline", "height"), ("outline", "z"), ("file", "height"), ("file", "z")];
    schema["oneOf"] = forms.map(|(outline, height)| json!({ "required": [outline, height] })).to_vec().into();
    schema
}

pub fn revolve() -> Value {
    let mut schema = table(
        "An outline in the half-plane x >= 0, whose y becomes z, revolved about z.",
        json!({
            "outline": reference("outline"),
            "file": text("A DXF or SVG file in the folder of the model, instead of `outline`."),
            "layer": text("The layer of a DXF file."),
            "scale": reference("number"),
            "fillet": reference("number"),
            "chamfer": reference("number"),
            "start": reference("number"),
            "angle": reference("number"),
        }),
        &[],
    );
    schema["oneOf"] = json!([{ "required": ["outline"] }, { "required": ["file"] }]);
    schema
}
