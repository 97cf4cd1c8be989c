//! The schema accepts the models and rejects invalid files, according to a validator of the few
//! keywords that it uses.

use rayweave_scene::schema;
use serde_json::{Value, json};
use std::path::Path;
use toml::de::{DeTable, DeValue};

/// The first reason why a value does not conform to the schema; `None` if it conforms.
fn problem(root: &Value, rule: &Value, value: &Value) -> Option<String> {
    let rule = rule.as_object()?;
    rule.iter().find_map(|(word, rule_value)| {
        word_problem(root, rule, word, rule_value, value).map(|why| format!("{word}: {why} in {value}"))
    })
}

fn word_problem(
    root: &Value,
    rule: &serde_json::Map<String, Value>,
    word: &str,
    argument: &Value,
    value: &Value,
) -> Option<String> {
    let fits = |rule: &Value| problem(root, rule, value).is_none();
    let count = |argument: &Value| {
        argument.as_array().map_or(0, |rules| rules.iter().filter(|rule| fits(rule)).count())
    };
    let bad = |wrong: bool| wrong.then(|| argument.to_string());
    let length = value.as_array().map(Vec::len);
    let keys = value.as_object().map(serde_json::Map::len);
    let limit = argument.as_u64().map(|limit| limit as usize);
    match word {
        "$schema" | "title" | "description" | "$defs" | "pattern" => None,
        "$ref" => problem(root, root.pointer(argument.as_str()?.strip_prefix('#')?)?, value),
        "const" => bad(argument != value && argument.as_f64() != value.as_f64()),
        "enum" => bad(!argument.as_array()?.contains(value)),
        "type" => bad(!types(argument).iter().any(|name| is_of_type(value, name))),
        "oneOf" => bad(count(argument) != 1),
        "anyOf" => bad(count(argument) == 0),
        "minItems" => bad(length < limit && length.is_some()),
        "maxItems" => bad(length > limit),
        "minProperties" => bad(keys < limit && keys.is_some()),
        "maxProperties" => bad(keys > limit),
        "items" => value.as_array()?.iter().find_map(|item| problem(root, argument, item)),
        "required" => {
            let keys = argument.as_array()?.iter().filter_map(Value::as_str);
            keys.filter(|_| value.is_object()).find(|key| value.get(key).is_none()).map(str::to_owned)
        }
        "dependentRequired" => {
            let given = argument.as_object()?.iter().filter(|(key, _)| value.get(key).is_some());
            let needed = given.filter_map(|(_, names)| names.as_array()).flatten().filter_map(Value::as_str);
            needed.into_iter().find(|name| value.get(name).is_none()).map(|name| format!("{name} is missing"))
        }
        "properties" => {
            let rules = argument.as_object()?.iter();
            rules
                .filter_map(|(key, rule)| Some((rule, value.get(key)?)))
                .find_map(|(rule, v)| problem(root, rule, v))
        }
        "additionalProperties" => {
            let known = rule.get("properties").and_then(Value::as_object);
            let others =
                value.as_object()?.iter().filter(|(key, _)| known.is_none_or(|k| !k.contains_key(*key)));
            others.into_iter().find_map(|(key, v)| match argument {
                Value::Bool(false) => Some(format!("unknown key {key}")),
                rule => problem(root, rule, v),
            })
        }
        other => panic!("the validator does not support {other}"),
    }
}

fn types(argument: &Value) -> Vec<&str> {
    match argument {
        Value::Array(names) => names.iter().filter_map(Value::as_str).collect(),
        name => name.as_str().into_iter().collect(),
    }
}

fn is_of_type(value: &Value, name: &str) -> bool {
    match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "boolean" => value.is_boolean(),
        other => panic!("the validator does not support {other}"),
    }
}

fn from_toml(value: &DeValue) -> Value {
    match value {
        DeValue::String(text) => json!(text.to_string()),
        DeValue::Integer(number) => json!(number.as_str().parse::<f64>().unwrap()),
        DeValue::Float(number) => json!(number.as_str().parse::<f64>().unwrap()),
        DeValue::Boolean(boolean) => json!(boolean),
        DeValue::Datetime(time) => json!(time.to_string()),
        DeValue::Array(list) => list.iter().map(|item| from_toml(item.get_ref())).collect(),
        DeValue::Table(table) => from_table(table),
    }
}

fn from_table(table: &DeTable) -> Value {
    let entries = table.iter().map(|(key, value)| (key.get_ref().to_string(), from_toml(value.get_ref())));
    Value::Object(entries.collect())
}

fn check(text: &str) -> Option<String> {
    let table = DeTable::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"));
    let schema = schema();
    problem(&schema, &schema, &from_table(table.get_ref()))
}

#[test]
fn every_model_fits() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    let mut count = 0;
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            assert_eq!(check(&std::fs::read_to_string(&path).unwrap()), None, "{}", path.display());
            count += 1;
        }
    }
    assert!(count >= 12);
}

#[test]
fn valid_files_match_the_schema() {
    for text in [
        "",
        "rayweave = 1\nunit = 'in'\n[wiring]\nx = 1\n[[detector]]\n",
        "[parameters]\na = 1\nb = 'a + 1'\n",
        "[solid.s]\nsphere = { radius = 'R' }\ntransform = { scale = [1, 2, 3] }\nname = 't'\n",
        "[solid.s]\nplace = { solid = 't', ring = 3, radius = 1 }\n",
        "[solid.s]\nplace = { solid = 't', ring = 2, radius = 1, name = 'n', numbers = [4, 7] }\n",
        "[solid.s]\ncylinder = { radius = 1 }\n",
        "[solid.s]\nextrude = { outline = [[0, 0], { at = [1, 'a'], fillet = 1 }, [0, 1]], height = 2, top = { chamfer = 1 } }\n",
        "[solid.s]\nrevolve = { outline = [{ circle = 1, at = [3, 0] }, [[0, 0], [1, 0], [1, 1]]], angle = 90 }\n",
        "[medium.m]\nindex = 1.5\nanything = [1]\n",
        "[[light]]\nposition = [0, 0, 0]\n",
        "[optics]\nbranches = 'both'\n[optics.medium]\na = 'N-BK7'\nb = 1.5\nc = { n = 1, k = '2' }\n",
        "[optics.face]\na = 'polished'\n'a.b' = { mirror = 0.5 }\nc = { coated = [[1.38, 0, 'd']] }\n",
        "[[optics.sheet]]\nname = 's'\ncircle = 4\nopening = { ellipse = [1, 2] }\naction = 'absorb'\n",
        "[[optics.sheet]]\nname = 's'\nrectangle = [4, 3]\naction = { retarder = [90, 45] }\ntransform = { scale = 2 }\n",
        "[[optics.source]]\nbeam = { circle = 4, rays = 9, waist = 2 }\nwavelength_nm = [[486.1, 1]]\n",
        "[[optics.source]]\nlamp = { width = 4, height = 9, angle = 2, rays = 'N' }\nwavelength_nm = { band = [4, 7] }\n",
        "[photons.medium.m]\nRINDEX = 1.5\nABSLENGTH = { eV = [1, 2], value = [3, 'a'] }\ntemperature = 300\n",
        "[[photons.surface]]\nname = 's'\nskin = ['a']\nborder = [['a', 'b']]\nREFLECTIVITY = 0.5\n",
        "[photons.sensor]\na = 'pmt'\n",
    ] {
        assert_eq!(check(text), None, "{text}");
    }
}

#[test]
fn invalid_files_do_not_match_the_schema() {
    for text in [
        "rayweave = 2",
        "unit = 'furlong'",
        "foo = 3",
        "[solid.s]\nplace = { solid = 't', ring = 2, radius = 1, numbers = [4, 7] }\n",
        "[parameters]\na = [1]\n",
        "[solid.s]\n",
        "[solid.s]\nsphre = { radius = 1 }\n",
        "[solid.s]\nsphere = { raduis = 1 }\n",
        "[solid.s]\nsphere = {}\n",
        "[solid.s]\nsphere = 1\n",
        "[solid.s]\nsphere = { radius = 1 }\nexpr = 'a'\n",
        "[solid.s]\nexpr = 1\n",
        "[solid.s]\nexpr = 'a'\ntransform = [{ scale = 1, rotate_x = 2 }]\n",
        "[solid.s]\nexpr = 'a'\ntransform = [{ translate = [1, 2] }]\n",
        "[solid.s]\nplace = { solid = 't', ring = 3 }\n",
        "[solid.s]\nplace = { solid = 't', at = [], file = 'x' }\n",
        "[solid.s]\nextrude = { outline = [[0, 0], [1, 0], [0, 1]] }\n",
        "[solid.s]\nextrude = { outline = [[0, 0], [1, 0], [0, 1]], height = 2, top = {} }\n",
        "[solid.s]\nrevolve = { outline = 3 }\n",
        "[[region]]\nmedium = 'a'\n",
        "[region]\nsolid = 'a'\n",
        "[camera]\nfov = 3\n",
        "[[light]]\nposition = [0, 0, 0]\ndirection = [0, 0, 1]\n",
        "[render]\nshading = 'none'\n",
    ] {
        assert!(check(text).is_some(), "{text}");
        assert!(rayweave_scene::parse(text).is_err(), "{text}");
    }
}

/// The programs that own these tables report their problems, not this crate.
#[test]
fn invalid_optics_do_not_match_the_schema() {
    for text in [
        "[optics]\nbranch = 'both'\n",
        "[optics]\nbranches = 'none'\n",
        "[optics.medium]\na = { n = 1, m = 2 }\n",
        "[optics.face]\na = 'polish'\n",
        "[optics.face]\na = { mirror = 1, rough = 1 }\n",
        "[[optics.sheet]]\nname = 's'\naction = 'absorb'\n",
        "[[optics.sheet]]\nname = 's'\ncircle = 4\naction = 'absorbs'\n",
        "[[optics.sheet]]\nname = 's'\ncircle = 4\nellipse = [1, 2]\naction = 'absorb'\n",
        "[[optics.source]]\nwavelength_nm = 500\n",
        "[[optics.source]]\nbeam = { rays = 5 }\n",
        "[[optics.source]]\ncone = { rays = 5 }\n",
        "[[optics.source]]\nline = { length = 1, rays = 5 }\nwavelength_nm = { bland = [1, 2] }\n",
        "[photons.media.m]\nRINDEX = 1.5\n",
        "[photons.medium.m]\nRINDEX = [1.5]\n",
        "[photons.medium.m]\nRINDEX = { eV = [1, 2] }\n",
        "[[photons.surface]]\nskin = ['a']\n",
        "[[photons.surface]]\nname = 's'\nborder = [['a']]\n",
        "[photons.sensor]\na = 1\n",
    ] {
        assert!(check(text).is_some(), "{text}");
    }
}
