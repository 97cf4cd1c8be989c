//! Reader of the `[photons]` tables of a native model file: the same contents as the `[gdml]` table of a GDML file.
//!
//! ```toml
//! [photons.medium.crystal]            # properties of a medium of the model, with Geant4's names
//! RINDEX = 1.79                       # at all energies
//! ABSLENGTH = { eV = [1.5, 4], value = [400, 300] }
//! SCINTILLATIONCOMPONENT1 = { wavelength_nm = [480, 550, 620], value = [0, 1, 0] }
//! SCINTILLATIONTIMECONSTANT1 = 1000   # ns
//!
//! [[photons.surface]]
//! name = "wrapping"
//! model = "unified"
//! finish = "groundfrontpainted"
//! type = "dielectric_dielectric"
//! value = 0                           # sigma_alpha (unified) or polish (glisur)
//! skin = ["bar"]                      # regions that it encloses
//! border = [["bar", "diode"]]         # from the first to the second region
//! REFLECTIVITY = 0.95
//!
//! [photons.sensor]                    # sensitive regions, each with the name of its sensor
//! diode = "photodiode"
//! ```

use crate::property::HC_MEV_NM;
use rayweave_scene::foreign::{Keys, Reader};
use rayweave_scene::{Datum, Diagnostic, Diagnostics, Document, Scene, Span, Spanned, Table};

/// The name of the table.
pub(super) const NAME: &str = "photons";

/// The tables in the form of a `[gdml]` table; the properties keep their spans.
///
/// # Errors
///
/// All problems of the form of the tables at once: unknown keys, media and regions, values of the wrong kind, and a unit other
/// than millimetres.
pub(super) fn table(document: &Document, scene: &Scene) -> Result<Datum, Diagnostics> {
    let Some(own) = document.foreign(NAME) else { return Ok(Datum::Table(Vec::new())) };
    let mut reader = Reader::new(document, scene);
    let span = own.value.span;
    if (scene.unit.metres() - 1e-3).abs() > 1e-12 {
        let problem = Diagnostic::error("the lengths of the model are not in millimetres");
        let problem = problem.why("optical photons are simulated in mm, ns and eV");
        reader.report(problem.suggest(Some("Set unit = \"mm\".".to_owned())), span);
    }
    let read = reader.keys(NAME, own.value.clone()).map(|keys| photons(&mut reader, scene, keys));
    reader.finish(read)
}

fn photons(reader: &mut Reader, scene: &Scene, mut keys: Keys) -> Datum {
    let materials = entries(reader, "photons.medium", keys.take("medium"));
    let materials = materials.into_iter().filter_map(|entry| material(reader, scene, entry));
    let materials: Vec<Datum> = materials.collect();
    let surfaces = keys.take("surface").map(|datum| match datum.value {
        Datum::List(list) => list,
        _ => {
            reader.wrong_type("photons.surface", &datum, "a list of tables, such as [[photons.surface]]");
            Vec::new()
        }
    });
    let mut rows = SurfaceRows::default();
    for item in surfaces.unwrap_or_default() {
        surface(reader, scene, item, &mut rows);
    }
    let sensors = entries(reader, "photons.sensor", keys.take("sensor"));
    let sensors = sensors.into_iter().filter_map(|(region, datum)| {
        let is_known = known_region(reader, scene, &region);
        let name = reader.text("sensor", datum)?;
        is_known.then_some((region.value, name.value))
    });
    let sensors: Vec<(String, String)> = sensors.collect();
    reader.reject_unknown(keys);
    row([
        ("material", list(materials)),
        ("surface", list(rows.surfaces)),
        ("skin", list(rows.skins)),
        ("border", list(rows.borders)),
        ("volume", list(volumes(scene, &sensors))),
    ])
}

/// The regions as volumes, each with one placement of its own name, without a mother.
fn volumes(scene: &Scene, sensors: &[(String, String)]) -> Vec<Datum> {
    let names = || scene.regions.iter().map(|region| region.name.as_str());
    let volume = |name: &str| {
        let tags = sensors.iter().filter(|(region, _)| region == name);
        let tag = |(_, sensor): &(String, String)| row([("type", text("SensDet")), ("value", text(sensor))]);
        row([("name", text(name)), ("region", text(name)), ("auxiliary", list(tags.map(tag).collect()))])
    };
    let placed = |name: &str| {
        let copies = list(vec![Datum::Number(0.0)]);
        row([("name", text(name)), ("volume", text(name)), ("maps", copies)])
    };
    let daughters = list(names().map(placed).collect());
    names().map(volume).chain([row([("daughters", daughters)])]).collect()
}

/// The rows of surfaces, and of where they are.
#[derive(Default)]
struct SurfaceRows {
    surfaces: Vec<Datum>,
    skins: Vec<Datum>,
    borders: Vec<Datum>,
}

type Entry = (Spanned<String>, Spanned<Datum>);

fn material(reader: &mut Reader, scene: &Scene, (name, datum): Entry) -> Option<Datum> {
    let names = scene.medium_names();
    let is_known = names.contains(&name.value.as_str());
    if !is_known {
        reader.unknown("medium", &name, &names);
    }
    let (mut keys, properties) = split(reader, &format!("photons.medium.{}", name.value), datum)?;
    let temperature = keys.take("temperature").and_then(|datum| {
        reader.checked("temperature", datum, "positive and finite", |value| value > 0.0 && value.is_finite())
    });
    reader.reject_unknown(keys);
    let mut entries = vec![("medium", text(&name.value)), ("properties", properties)];
    entries.extend(temperature.map(|value| ("temperature", Datum::Number(value))));
    is_known.then(|| row(entries))
}

fn surface(reader: &mut Reader, scene: &Scene, item: Spanned<Datum>, rows: &mut SurfaceRows) {
    let Some((mut keys, properties)) = split(reader, "photons.surface", item) else { return };
    let name = reader.need(&mut keys, "name").and_then(|datum| reader.text("name", datum));
    let name = name.map(|name| name.value).unwrap_or_default();
    let mut entries = vec![(spanned("name"), Spanned::from(text(&name)))];
    for key in ["model", "finish", "type"] {
        // unknown words are reported with the supported ones by the reader of surfaces
        let word = keys.take(key).and_then(|datum| reader.text(key, datum));
        entries.extend(word.map(|word| (spanned(key), Spanned::new(Datum::Text(word.value), word.span))));
    }
    let value = keys.take("value").and_then(|datum| reader.number("value", datum));
    entries.extend(value.map(|value| (spanned("value"), Spanned::from(Datum::Number(value)))));
    entries.push((spanned("properties"), properties.into()));
    rows.surfaces.push(Datum::Table(entries));
    let skins = keys.take("skin").map(|datum| regions(reader, scene, "skin", datum)).unwrap_or_default();
    if !skins.is_empty() {
        let skins = list(skins.into_iter().map(Datum::Text).collect());
        rows.skins.push(row([("name", text(&name)), ("surface", text(&name)), ("volume", skins)]));
    }
    let pairs = keys.take("border").map(|datum| items(reader, "border", datum)).unwrap_or_default();
    for pair in pairs {
        let (span, count) = (pair.span, pair.value.items().count());
        let names = regions(reader, scene, "border", pair);
        if count != 2 {
            let problem = Diagnostic::error(format!("a border has {count} regions"));
            reader.report(problem.why("it leads from a first to a second one"), span);
        } else if names.len() == 2 {
            let names = list(names.into_iter().map(Datum::Text).collect());
            let border = [("name", text(&name)), ("surface", text(&name)), ("placements", names)];
            rows.borders.push(row(border));
        }
    }
    reader.reject_unknown(keys);
}

/// The names of known regions in a list.
fn regions(reader: &mut Reader, scene: &Scene, what: &str, datum: Spanned<Datum>) -> Vec<String> {
    let mut names = Vec::new();
    for item in items(reader, what, datum) {
        if let Some(name) = reader.text(what, item)
            && known_region(reader, scene, &name)
        {
            names.push(name.value);
        }
    }
    names
}

fn known_region(reader: &mut Reader, scene: &Scene, name: &Spanned<String>) -> bool {
    let names: Vec<&str> = scene.regions.iter().map(|region| region.name.as_str()).collect();
    let is_known = names.contains(&name.value.as_str());
    if !is_known {
        reader.unknown("region", name, &names);
    }
    is_known
}

fn items(reader: &mut Reader, what: &str, datum: Spanned<Datum>) -> Vec<Spanned<Datum>> {
    match datum.value {
        Datum::List(list) => list,
        _ => {
            reader.wrong_type(what, &datum, "a list");
            Vec::new()
        }
    }
}

fn entries(reader: &mut Reader, what: &str, datum: Option<Spanned<Datum>>) -> Table {
    match datum {
        Some(Spanned { value: Datum::Table(table), .. }) => table,
        Some(datum) => {
            reader.wrong_type(what, &datum, "a table");
            Vec::new()
        }
        None => Vec::new(),
    }
}

/// The keys of a table, and its properties: the names in capitals.
fn split(reader: &mut Reader, what: &str, datum: Spanned<Datum>) -> Option<(Keys, Datum)> {
    let span = datum.span;
    let Datum::Table(table) = datum.value else {
        reader.wrong_type(what, &datum, "a table");
        return None;
    };
    let is_property = |(name, _): &Entry| !name.value.contains(|c: char| c.is_ascii_lowercase());
    let (properties, keys): (Table, Table) = table.into_iter().partition(is_property);
    let keys = reader.keys(what, Spanned::new(Datum::Table(keys), span))?;
    let read = properties.into_iter().filter_map(|(name, datum)| {
        let value = property(reader, &name.value, datum)?;
        // problems of the values are reported at the name
        let span = name.span;
        Some((name, Spanned::new(value, span)))
    });
    Some((keys, Datum::Table(read.collect())))
}

/// A number, or the pairs of energy in MeV and value of a table, one after the other.
fn property(reader: &mut Reader, name: &str, datum: Spanned<Datum>) -> Option<Datum> {
    if !matches!(datum.value, Datum::Table(_)) {
        return reader.number(name, datum).map(Datum::Number);
    }
    let mut keys = reader.keys(name, datum)?;
    let places = reader.one_of(&mut keys, &["eV", "wavelength_nm"]);
    let values = reader.need(&mut keys, "value");
    reader.reject_unknown(keys);
    let ((key, places), values) = places.zip(values)?;
    let span = values.span;
    let is_energy = key.value == "eV";
    let places = numbers(reader, &key.value, places)?;
    let values = numbers(reader, "value", values)?;
    if places.len() != values.len() {
        let (places, values) = (places.len(), values.len());
        let problem = Diagnostic::error(format!(
            "`{name}` has {places} numbers in `{}` and {values} in `value`",
            key.value
        ));
        reader.report(problem.why("each point of the property has one of each"), span);
        return None;
    }
    let energy = |place: f64| if is_energy { 1e-6 * place } else { HC_MEV_NM / place };
    let pairs = places.into_iter().zip(values).flat_map(|(place, value)| [energy(place), value]);
    Some(list(pairs.map(Datum::Number).collect()))
}

fn numbers(reader: &mut Reader, what: &str, datum: Spanned<Datum>) -> Option<Vec<f64>> {
    let items = items(reader, what, datum);
    let read: Vec<Option<f64>> = items.into_iter().map(|item| reader.number(what, item)).collect();
    read.into_iter().collect()
}

fn spanned(key: &str) -> Spanned<String> {
    Spanned::new(key.to_owned(), Span::default())
}

fn text(text: &str) -> Datum {
    Datum::Text(text.to_owned())
}

fn list(items: Vec<Datum>) -> Datum {
    Datum::List(items.into_iter().map(Spanned::from).collect())
}

fn row<'k>(entries: impl IntoIterator<Item = (&'k str, Datum)>) -> Datum {
    Datum::Table(entries.into_iter().map(|(key, value)| (spanned(key), value.into())).collect())
}
