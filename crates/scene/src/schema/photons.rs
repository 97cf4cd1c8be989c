//! Schema of the `[photons]` tables, which `rayweave-photon` reads.

use super::parts::{reference, table, text};
use serde_json::{Value, json};

pub(super) fn photons() -> Value {
    let regions = json!({ "type": "array", "items": { "type": "string" } });
    let pair = json!({ "type": "array", "items": { "type": "string" }, "minItems": 2, "maxItems": 2 });
    let medium = json!({ "temperature": reference("number") });
    let surface = json!({
        "name": text("The name."),
        "model": text("The model, such as `unified`."),
        "finish": text("The finish, such as `ground`."),
        "type": text("The type, such as `dielectric_metal`."),
        "value": reference("number"),
        "skin": regions,
        "border": { "description": "Pairs of regions, from the first to the second.", "type": "array", "items": pair },
    });
    table(
        "Optical photons in detectors: properties of media, surfaces, sensors.",
        json!({
            "medium": {
                "description": "Properties by medium name; the properties have Geant4's names.",
                "type": "object",
                "additionalProperties": with_properties("The properties of a medium.", medium, &[]),
            },
            "surface": {
                "description": "Optical surfaces; the properties have Geant4's names.",
                "type": "array",
                "items": with_properties("An optical surface.", surface, &["name"]),
            },
            "sensor": {
                "description": "Names of sensors by sensitive region.",
                "type": "object",
                "additionalProperties": { "type": "string" },
            },
        }),
        &[],
    )
}

/// A table whose other keys are properties: a number, or a function of the energy or the wavelength.
fn with_properties(description: &str, keys: Value, required: &[&str]) -> Value {
    let numbers = json!({ "type": "array", "items": reference("number"), "minItems": 1 });
    let columns = json!({ "eV": numbers, "wavelength_nm": numbers, "value": numbers });
    let mut property = table("Values at energies or wavelengths.", columns, &["value"]);
    property["minProperties"] = 2.into();
    property["maxProperties"] = 2.into();
    let mut one = table(description, keys, required);
    one["additionalProperties"] = json!({ "anyOf": [reference("number"), property] });
    one
}
