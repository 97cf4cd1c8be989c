//! Schema of the `[optics]` tables, which `rayweave-optics` reads.

use super::parts::{list, reference, table, text};
use serde_json::{Value, json};

pub(super) fn optics() -> Value {
    table(
        "Light: materials of media, finishes of faces, sheets, sources, settings.",
        json!({
            "branches": { "enum": ["ideal", "both", "random"] },
            "polarised": { "type": "boolean" },
            "generation_limit": reference("number"),
            "threshold": reference("number"),
            "seed": reference("number"),
            "medium": {
                "description": "Materials by name of the medium.",
                "type": "object",
                "additionalProperties": material(),
            },
            "face": {
                "description": "Finishes by region, or by region and face.",
                "type": "object",
                "additionalProperties": finish(),
            },
            "sheet": { "description": "Surfaces without thickness.", "type": "array", "items": sheet() },
            "source": { "description": "Sources of light.", "type": "array", "items": source() },
        }),
        &[],
    )
}

/// One of several words, or a table with one of several keys.
fn word_or_table(words: &[&str], keys: Value) -> Value {
    let mut one = table("One of these.", keys, &[]);
    one["minProperties"] = 1.into();
    one["maxProperties"] = 1.into();
    json!({ "anyOf": [{ "enum": words }, one] })
}

fn material() -> Value {
    let index = json!({ "n": reference("number"), "k": reference("number") });
    let place = json!({ "gradient": gradient(), "transform": reference("transform") });
    let graded = |mut keys: Value, needed: &'static str| {
        keys["gradient"] = place["gradient"].clone();
        keys["transform"] = place["transform"].clone();
        table("An index that may vary with position.", keys, &[needed])
    };
    json!({
        "description": "A material of the catalogue, an index, `mirror` or `absorber`.",
        "anyOf": [
            reference("number"),
            graded(index, "n"),
            graded(json!({ "glass": text("A material of the catalogue.") }), "glass"),
        ],
    })
}

fn gradient() -> Value {
    let coefficients = json!({ "type": "array", "items": reference("number"), "minItems": 1 });
    let laws = json!({
        "selfoc": reference("number"),
        "squared": coefficients,
        "radial": coefficients,
        "axial": coefficients,
        "fish_eye": reference("number"),
        "luneburg": reference("number"),
    });
    with_one_of("The factor of the index as a function of position.", json!({}), &laws, &[])
}

fn finish() -> Value {
    let keys = json!({
        "mirror": reference("number"),
        "splitter": reference("number"),
        "diffuse": reference("number"),
        "rough": reference("number"),
        "coated": { "type": "array", "items": reference("vector") },
    });
    word_or_table(&["polished", "absorber"], keys)
}

fn action() -> Value {
    let grating = table(
        "Lines per unit of length along x and y.",
        json!({ "lines": list("number", 2), "order": reference("number"), "reflects": { "type": "boolean" } }),
        &["lines", "order"],
    );
    let keys = json!({
        "mirror": reference("number"),
        "splitter": reference("number"),
        "thin_lens": reference("number"),
        "polariser": reference("number"),
        "retarder": list("number", 2),
        "grating": grating,
    });
    word_or_table(&["absorb", "record"], keys)
}

fn outline() -> Value {
    json!({
        "circle": reference("number"),
        "rectangle": list("number", 2),
        "ellipse": list("number", 2),
    })
}

/// A table with its own keys, and exactly one of several others.
fn with_one_of(description: &str, mut own: Value, others: &Value, required: &[&str]) -> Value {
    let others: Vec<_> = others.as_object().into_iter().flatten().collect();
    for (key, rule) in &others {
        own[key.as_str()] = (*rule).clone();
    }
    let mut all = table(description, own, required);
    all["oneOf"] = others.iter().map(|(key, _)| json!({ "required": [key] })).collect();
    all
}

fn sheet() -> Value {
    let own = json!({
        "name": text("The name of the sheet."),
        "opening": with_one_of("A hole in the middle.", json!({}), &outline(), &[]),
        "radius": reference("number"),
        "conic": reference("number"),
        "action": action(),
        "transform": reference("transform"),
    });
    with_one_of(
        "A piece of the plane z = 0, or of a conic of revolution.",
        own,
        &outline(),
        &["name", "action"],
    )
}

fn source() -> Value {
    let own = json!({
        "wavelength_nm": wavelength(),
        "power": reference("number"),
        "stokes": list("number", 4),
        "seed": reference("number"),
        "transform": reference("transform"),
    });
    with_one_of("Light from about the origin, along z.", own, &patterns(), &[])
}

fn patterns() -> Value {
    let rays = |description: &str, sizes: &[&'static str]| {
        let mut keys = json!({ "rays": reference("number") });
        sizes.iter().for_each(|size| keys[*size] = reference("number"));
        table(description, keys, &[sizes, &["rays"]].concat())
    };
    let mut point = rays("Rays into a cone.", &["angle"]);
    let sampling = json!({ "enum": ["fibonacci", "random", "grid", "hexapolar"] });
    point["properties"]["random"] = json!({ "type": "boolean" });
    point["properties"]["sampling"] = sampling.clone();
    let beam = json!({
        "rays": reference("number"),
        "waist": reference("number"),
        "random": { "type": "boolean" },
        "sampling": sampling,
    });
    let disc = json!({
        "angle": reference("number"),
        "rays": reference("number"),
        "emission": { "enum": ["lambert", "isotropic"] },
    });
    json!({
        "beam": with_one_of("Parallel rays over an outline.", beam, &outline(), &["rays"]),
        "line": rays("Parallel rays in a row.", &["length"]),
        "circle": rays("Parallel rays around a circle.", &["diameter"]),
        "cone": rays("Rays along the surface of a cone.", &["angle"]),
        "wedge": rays("Rays in a plane.", &["angle"]),
        "lamp": rays("A Lambertian rectangle.", &["width", "height", "angle"]),
        "point": point,
        "disc": with_one_of("Light from an outline.", disc, &outline(), &["angle", "rays"]),
        "rays": table("Rays from a file.", json!({ "file": text("The name of the file, in the folder of the model.") }), &["file"]),
    })
}

fn wavelength() -> Value {
    let pairs = json!({ "type": "array", "items": list("number", 2), "minItems": 1 });
    let spread = json!({
        "band": list("number", 2),
        "black_body": list("number", 3),
        "table": pairs,
    });
    json!({
        "description": "A wavelength in nm, pairs of wavelengths and weights, or a distribution.",
        "anyOf": [reference("number"), pairs, with_one_of("A distribution.", json!({}), &spread, &[])],
    })
}
