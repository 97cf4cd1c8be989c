//! Lens files as prescriptions, with their units and fields as text.

use crate::failure::Failure;
use crate::terminal::{self, short};
use rayweave::lens::prescription::{FieldKind, Prescription, read_zmx};
use rayweave::scene::{Unit, nearby_sentence, read_bytes};
use std::path::Path;

/// True if a path has the extension of a lens file.
pub fn is_one(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("zmx"))
}

/// Reads a lens file; ignored and replaced entries are reported on standard error or, if `strict`, as an error.
pub fn read(path: &Path, strict: bool) -> Result<Prescription, Failure> {
    let name = path.display();
    let unreadable =
        |reason| Failure::Input(format!("{name}: cannot be read: {reason}.{}", nearby_sentence(path)));
    let bytes = read_bytes(path).map_err(unreadable)?;
    let read = read_zmx(&bytes).map_err(|error| wrong(path, &error))?;
    if let (true, Some(note)) = (strict, read.notes.first()) {
        return Err(Failure::Input(format!("{name}: {note}")));
    }
    for note in &read.notes {
        terminal::caution(&format!("{name}: {note}"));
    }
    Ok(read.prescription)
}

/// The failure of an error about a lens file, line by line.
pub fn wrong(path: &Path, error: &dyn std::error::Error) -> Failure {
    let name = path.display();
    let lines: Vec<String> = error.to_string().lines().map(|line| format!("{name}: {line}")).collect();
    Failure::Input(lines.join("\nerror: "))
}

/// The symbol of the unit of length of a lens; empty for an unusual one.
pub fn unit(lens: &Prescription) -> &'static str {
    Unit::of_metres(1e-9 * lens.unit_nm).map_or("", Unit::symbol)
}

/// The coordinates of the fields of a lens.
pub fn field_texts(lens: &Prescription) -> Vec<String> {
    lens.fields.iter().map(|&place| field_text(lens.field_kind, place, unit(lens))).collect()
}

/// The fields of a lens for legends: a number for a field along y.
pub fn field_names(lens: &Prescription) -> Vec<String> {
    let name = |&[x, y]: &[f64; 2]| match (x == 0.0, lens.field_kind) {
        (true, FieldKind::Angle) => format!("{}\u{b0}", short(y)),
        (true, _) => format!("{} {}", short(y), unit(lens)),
        (false, kind) => field_text(kind, [x, y], unit(lens)),
    };
    lens.fields.iter().map(name).collect()
}

/// The coordinates of a field with their unit.
fn field_text(kind: FieldKind, place: [f64; 2], unit: &str) -> String {
    let coordinates = place.map(short).join(", ");
    match kind {
        FieldKind::Angle => format!("({coordinates})\u{b0}"),
        FieldKind::ObjectHeight | FieldKind::ImageHeight => format!("({coordinates}) {unit}"),
    }
}
