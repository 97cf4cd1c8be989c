//! Reader of `[[optics.sheet]]`.

use super::values::{Choice, aperture, finite, fraction, transform, word_or_keyed};
use crate::component::{Aperture, Asphere, Sheet, SurfaceForm};
use crate::element::{Action, Element};
use rayweave_math::{Vec3, sin_cos_degrees};
use rayweave_scene::foreign::{Keys, Reader};
use rayweave_scene::{Datum, Diagnostic, Spanned};

pub(super) fn read(reader: &mut Reader, keys: &mut Keys, mut taken: Vec<String>) -> Vec<Element> {
    let Some(datum) = keys.take("sheet") else { return Vec::new() };
    let tables = reader.tables("optics.sheet", datum);
    tables.into_iter().filter_map(|keys| element(reader, keys, &mut taken)).collect()
}

fn element(reader: &mut Reader, mut keys: Keys, taken: &mut Vec<String>) -> Option<Element> {
    let name = reader.need(&mut keys, "name").and_then(|datum| reader.text("name", datum));
    if let Some(name) = &name {
        check_unique(reader, name, taken);
    }
    let sheet = sheet(reader, &mut keys);
    let action = reader.need(&mut keys, "action").and_then(|datum| action(reader, datum));
    let span = keys.span();
    let map = transform(reader, &mut keys);
    reader.reject_unknown(keys);
    let sheet = reader.accept(sheet?.apply(&map?), span)?;
    Some(Element::sheet(&name?.value, sheet, action?))
}

fn check_unique(reader: &mut Reader, name: &Spanned<String>, taken: &mut Vec<String>) {
    if taken.contains(&name.value) {
        let problem = Diagnostic::error(format!("two elements are called `{}`", name.value));
        let reason = "element names must be unique, since results refer to them";
        reader.report(problem.why(reason).suggest(Some("rename one of them".to_owned())), name.span);
    }
    taken.push(name.value.clone());
}

fn sheet(reader: &mut Reader, keys: &mut Keys) -> Option<Sheet> {
    let span = keys.span();
    let outline = aperture(reader, keys);
    let opening = keys.take("opening").map(|datum| opening(reader, datum));
    let curve = curve(reader, keys)?;
    let sheet = match (opening, curve) {
        (None, None) => Sheet::plane(outline?),
        (Some(opening), None) => Sheet::stop(outline?, opening?),
        (None, Some([radius, conic])) => Sheet::conic(radius, conic, outline?),
        (Some(opening), Some([radius, conic])) => {
            let form = SurfaceForm::from(Asphere::conic(radius, conic));
            Sheet::curved_stop(&form, outline?, opening?)
        }
    };
    reader.accept(sheet, span)
}

fn opening(reader: &mut Reader, datum: Spanned<Datum>) -> Option<Aperture> {
    let mut keys = reader.keys("opening", datum)?;
    let opening = aperture(reader, &mut keys);
    reader.reject_unknown(keys);
    opening
}

/// `radius` and `conic` of a curved sheet; `None` if one of them is invalid.
fn curve(reader: &mut Reader, keys: &mut Keys) -> Option<Option<[f64; 2]>> {
    let (radius, conic) = (keys.take("radius"), keys.take("conic"));
    let Some(radius) = radius else {
        let Some(datum) = conic else { return Some(None) };
        let problem = Diagnostic::error("the sheet has a conic constant without a `radius`");
        reader.report(problem.why("it is plane"), datum.span);
        return None;
    };
    let radius = reader.number("radius", radius);
    let conic = conic.map_or(Some(0.0), |datum| finite(reader, "conic", datum));
    Some(Some([radius?, conic?]))
}

fn action(reader: &mut Reader, datum: Spanned<Datum>) -> Option<Action> {
    let keys = ["mirror", "splitter", "thin_lens", "grating", "polariser", "retarder"];
    let (key, datum) = match word_or_keyed(reader, "action", datum, &["absorb", "record"], &keys)? {
        Choice::Word(word) if word.value == "absorb" => return Some(Action::Absorb),
        Choice::Word(_) => return Some(Action::Record),
        Choice::Keyed(key, datum) => (key.value, datum),
    };
    Some(match key.as_str() {
        "mirror" => Action::Mirror { reflectance: fraction(reader, "mirror", datum)? },
        "splitter" => Action::Splitter { reflectance: fraction(reader, "splitter", datum)? },
        "thin_lens" => {
            let holds = |length: f64| length.is_finite() && length != 0.0;
            Action::ThinLens { focal_length: reader.checked("thin_lens", datum, "finite and not 0", holds)? }
        }
        "polariser" => Action::Polariser { axis: axis(finite(reader, "polariser", datum)?) },
        "retarder" => retarder(reader, datum)?,
        _ => grating(reader, datum)?,
    })
}

/// The direction at an angle in degrees from x towards y.
fn axis(degrees: f64) -> Vec3 {
    let (sin, cos) = sin_cos_degrees(degrees);
    Vec3::new(cos, sin, 0.0)
}

fn retarder(reader: &mut Reader, datum: Spanned<Datum>) -> Option<Action> {
    let span = datum.span;
    let [retardance_degrees, degrees] = reader.numbers("retarder", datum)?;
    let is_finite = retardance_degrees.is_finite() && degrees.is_finite();
    if !is_finite {
        let problem = Diagnostic::error("an angle of the retarder is infinite");
        reader.report(
            problem.why("it needs its retardance and the angle of its fast axis, both finite, in degrees"),
            span,
        );
    }
    is_finite.then(|| Action::Retarder { axis: axis(degrees), retardance_degrees })
}

fn grating(reader: &mut Reader, datum: Spanned<Datum>) -> Option<Action> {
    let mut keys = reader.keys("grating", datum)?;
    let lines = reader.need(&mut keys, "lines").and_then(|datum| lines(reader, datum));
    let is_order = |order: f64| order.fract() == 0.0 && order.abs() <= f64::from(i32::MAX);
    let order = reader.need(&mut keys, "order");
    let order = order.and_then(|datum| reader.checked("order", datum, "a whole number", is_order));
    let reflects = match keys.take("reflects") {
        Some(datum) => reader.boolean("reflects", datum),
        None => Some(false),
    };
    reader.reject_unknown(keys);
    Some(Action::Grating { lines: lines?, order: order? as i32, reflects: reflects? })
}

/// Lines per unit of length along x and y of the sheet.
fn lines(reader: &mut Reader, datum: Spanned<Datum>) -> Option<Vec3> {
    let span = datum.span;
    let [x, y] = reader.numbers("lines", datum)?;
    let lines = Vec3::new(x, y, 0.0);
    let is_grating = lines.is_finite() && lines != Vec3::ZERO;
    if !is_grating {
        let problem = Diagnostic::error(format!("the grating has [{x}, {y}] lines"));
        reader.report(problem.why("they must be finite, and not both 0"), span);
    }
    is_grating.then_some(lines)
}
