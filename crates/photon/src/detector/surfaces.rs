//! Optical surfaces in the `[gdml]` table of a document.

use super::properties::{Owner, Properties, PropertyReader};
use crate::surface::{
    Coating, DAVIS_FINISHES, LUT_FINISHES, MeasuredTable, OpticalSurface, SurfaceFinish, SurfaceModel,
    SurfaceType,
};
use crate::tables::SurfaceTables;
use rayweave_error::{Message, did_you_mean};
use rayweave_scene::{Datum, Span};
use std::collections::HashMap;

/// The optical surfaces, in the order of the file.
pub(super) fn read(
    table: &Datum,
    tables: &SurfaceTables,
    properties: &mut PropertyReader,
) -> Vec<OpticalSurface> {
    // surfaces of equal finish share one table
    let mut known = HashMap::new();
    let read = |row| surface(row, tables, &mut known, properties);
    table.list("surface").map(read).collect()
}

/// A word of an attribute, its number in files of Geant4, and its value.
type Word<T> = (&'static str, u32, T);

/// The models (`G4OpticalSurfaceModel`).
const MODELS: [Word<SurfaceModel>; 5] = [
    ("glisur", 0, SurfaceModel::Glisur),
    ("unified", 1, SurfaceModel::Unified),
    ("LUT", 2, SurfaceModel::Lut),
    ("DAVIS", 3, SurfaceModel::Davis),
    ("dichroic", 4, SurfaceModel::Dichroic),
];

/// The finishes without tables (`G4OpticalSurfaceFinish`).
const FINISHES: [Word<SurfaceFinish>; 6] = [
    ("polished", 0, SurfaceFinish::Polished),
    ("polishedfrontpainted", 1, SurfaceFinish::PolishedFrontPainted),
    ("polishedbackpainted", 2, SurfaceFinish::PolishedBackPainted),
    ("ground", 3, SurfaceFinish::Ground),
    ("groundfrontpainted", 4, SurfaceFinish::GroundFrontPainted),
    ("groundbackpainted", 5, SurfaceFinish::GroundBackPainted),
];

/// The types (`G4SurfaceType`). Geant4 writes `coated` as 7 and reads neither the word nor the number.
const TYPES: [Word<SurfaceType>; 6] = [
    ("dielectric_metal", 0, SurfaceType::DielectricMetal),
    ("dielectric_dielectric", 1, SurfaceType::DielectricDielectric),
    ("dielectric_LUT", 2, SurfaceType::DielectricLut),
    ("dielectric_LUTDAVIS", 3, SurfaceType::DielectricLutDavis),
    ("dielectric_dichroic", 4, SurfaceType::DielectricDichroic),
    ("coated", 7, SurfaceType::Coated),
];

/// All finishes with their numbers.
fn finishes() -> Vec<Word<SurfaceFinish>> {
    let measured = LUT_FINISHES.iter().map(|row| row.0).chain(DAVIS_FINISHES);
    let measured = measured.zip(6..).map(|(name, number)| (name, number, SurfaceFinish::Measured(name)));
    FINISHES.into_iter().chain(measured).collect()
}

impl OpticalSurface {
    /// The words of model, finish and type in GDML files, such as `unified`, `groundfrontpainted`, `dielectric_metal`.
    #[must_use]
    pub fn words(&self) -> [&'static str; 3] {
        [word_of(self.model, &MODELS), word_of(self.finish, &finishes()), word_of(self.kind, &TYPES)]
    }
}

/// The word of a value.
fn word_of<T: Copy + PartialEq>(value: T, words: &[Word<T>]) -> &'static str {
    words.iter().find(|(.., own)| *own == value).map_or("", |(word, ..)| word)
}

fn surface(
    row: &Datum,
    tables: &SurfaceTables,
    known: &mut HashMap<&'static str, MeasuredTable>,
    properties: &mut PropertyReader,
) -> OpticalSurface {
    let name = row.get("name").and_then(Datum::as_text).unwrap_or_default().to_owned();
    let owner = Owner::new("surface", &name);
    let model = word(row, "model", &MODELS, &owner, properties);
    let finish = word(row, "finish", &finishes(), &owner, properties);
    let kind = word(row, "type", &TYPES, &owner, properties);
    let value = row.get("value").and_then(Datum::as_number).unwrap_or(1.0);
    let table = kind.zip(finish).and_then(|(kind, finish)| {
        let table = measured_table(&name, kind, finish, tables, known);
        table.map_err(|message| properties.problem(owner.clone(), message, place(row, "type"))).ok().flatten()
    });
    let kind = kind.unwrap_or_default();
    let mut properties = properties.of(owner, row);
    let [reflectivity, transmittance, efficiency, lobe, spike, backscatter] = [
        "REFLECTIVITY",
        "TRANSMITTANCE",
        "EFFICIENCY",
        "SPECULARLOBECONSTANT",
        "SPECULARSPIKECONSTANT",
        "BACKSCATTERCONSTANT",
    ]
    .map(|name| properties.table_in(name, 0.0..=1.0));
    let index = properties.positive("RINDEX");
    let real = properties.table_in("REALRINDEX", 0.0..=f64::INFINITY);
    let imaginary = properties.table_in("IMAGINARYRINDEX", 0.0..=f64::INFINITY);
    let roughness = properties.constant("SURFACEROUGHNESS").unwrap_or(0.0);
    let coating = if kind == SurfaceType::Coated { coating(&mut properties) } else { None };
    properties.finish();
    OpticalSurface {
        name,
        model: model.unwrap_or_default(),
        finish: finish.unwrap_or_default(),
        kind,
        value,
        reflectivity,
        transmittance,
        efficiency,
        index,
        metal_index: real.zip(imaginary),
        lobe,
        spike,
        backscatter,
        roughness,
        table,
        coating,
    }
}

/// The table of a surface with a type that needs one.
fn measured_table(
    name: &str,
    kind: SurfaceType,
    finish: SurfaceFinish,
    tables: &SurfaceTables,
    known: &mut HashMap<&'static str, MeasuredTable>,
) -> Result<Option<MeasuredTable>, Message> {
    let is_tabulated = matches!(kind, SurfaceType::DielectricLut | SurfaceType::DielectricLutDavis);
    match finish {
        SurfaceFinish::Measured(finish) if is_tabulated => {
            if tables.has(name) {
                return tables.find(name, kind, finish);
            }
            if let Some(table) = known.get(finish) {
                return Ok(Some(table.clone()));
            }
            let table = tables.find(name, kind, finish)?;
            known.extend(table.clone().map(|table| (finish, table)));
            Ok(table)
        }
        SurfaceFinish::Measured(finish) if kind != SurfaceType::DielectricDichroic => {
            let problem =
                format!("the finish `{finish}` of optical surface `{name}` has no meaning for its type");
            let message = Message::new(problem, "it is a finish of the measured tables");
            Err(message.suggest("Set the type to dielectric_LUT or dielectric_LUTDAVIS."))
        }
        _ => tables.find(name, kind, ""),
    }
}

/// The film of a coated surface. Without a thickness there is none, as in Geant4.
fn coating(properties: &mut Properties<'_>) -> Option<Coating> {
    if !properties.has("COATEDRINDEX") {
        properties.problem("COATEDRINDEX", "a coated surface needs the index of its film");
    }
    let index = properties.positive("COATEDRINDEX");
    let thickness = properties.constant("COATEDTHICKNESS").unwrap_or(0.0);
    if !(thickness >= 0.0 && thickness.is_finite()) {
        properties
            .problem("COATEDTHICKNESS", &format!("it is {thickness} mm: it must be finite and at least 0"));
    }
    let frustrated = properties.constant("COATEDFRUSTRATEDTRANSMISSION");
    Some(Coating {
        index: index?,
        thickness,
        has_frustrated_transmission: frustrated.is_none_or(|value| value != 0.0),
    })
}

/// One of the words of an attribute, or its number; others are problems.
fn word<T: Copy + Default>(
    row: &Datum,
    attribute: &str,
    words: &[Word<T>],
    owner: &Owner,
    properties: &mut PropertyReader,
) -> Option<T> {
    let text = row.text(attribute);
    if text.is_empty() {
        return Some(T::default());
    }
    if let Some((.., value)) =
        words.iter().find(|(word, number, _)| text == *word || text == number.to_string())
    {
        return Some(*value);
    }
    let names = words.iter().map(|(word, ..)| *word);
    let listed = names.clone().take(MAX_LISTED).collect::<Vec<_>>().join(", ");
    let more = if words.len() > MAX_LISTED { ", and those of Geant4's tables" } else { "" };
    let problem = format!("the {attribute} `{text}` of {owner} is not supported");
    let message = Message::new(problem, format!("the supported ones are {listed}{more}"));
    let message = match did_you_mean(text, names) {
        Some(meant) => message.suggest(format!("Did you mean `{meant}`?")),
        None => message,
    };
    properties.problem(owner.clone(), message, place(row, attribute));
    None
}

/// The number of words that a message lists.
const MAX_LISTED: usize = 6;

/// The place of the value of a key in a native model file.
fn place(row: &Datum, key: &str) -> Span {
    let Datum::Table(table) = row else { return Span::default() };
    let entry = table.iter().find(|(name, _)| name.value == key);
    entry.map(|(_, value)| value.span).unwrap_or_default()
}
