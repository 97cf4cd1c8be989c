//! Building blocks of schemas.

use serde_json::{Value, json};

/// A reference to a definition by its name.
pub fn reference(name: &str) -> Value {
    json!({ "$ref": format!("#/$defs/{name}") })
}

/// An object with no other keys than these.
pub fn table(description: &str, properties: Value, required: &[&str]) -> Value {
    json!({
        "description": description,
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    })
}

/// A string.
pub fn text(description: &str) -> Value {
    json!({ "type": "string", "description": description })
}

/// A list of `length` items.
pub fn list(of: &str, length: usize) -> Value {
    json!({ "type": "array", "items": reference(of), "minItems": length, "maxItems": length })
}
