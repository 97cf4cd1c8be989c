//! Parts of schemas.

use serde_json::{Value, json};

/// A schema by its name among the definitions.
pub fn reference(name: &str) -> Value {
    json!({ "$ref": format!("#/$defs/{name}") })
}

/// An object that has no other keys than these.
pub fn table(description: &str, properties: Value, required: &[&str]) -> Value {
    json!({
        "description": description,
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

/// A text.
pub fn text(description: &str) -> Value {
    json!({ "type": "string", "description": description })
}

/// A list of so many items.
pub fn list(of: &str, length: usize) -> Value {
    json!({ "type": "array", "items": reference(of), "minItems": length, "maxItems": length })
}
