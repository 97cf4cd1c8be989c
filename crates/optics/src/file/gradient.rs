//! Reader of gradients of media.

use super::values::{list, transform};
use crate::gradient::Gradient;
use rayweave_scene::foreign::{Keys, Reader};
use rayweave_scene::{Datum, Spanned};

/// `gradient = { selfoc = 0.25 }` and similar, with the `transform` next to it.
pub(super) fn read(reader: &mut Reader, datum: Spanned<Datum>, around: &mut Keys) -> Option<Gradient> {
    let span = datum.span;
    let mut keys = reader.keys("gradient", datum)?;
    let read = law(reader, &mut keys);
    reader.reject_unknown(keys);
    let map = transform(reader, around)?;
    reader.accept(read?.placed(&map), span)
}

fn law(reader: &mut Reader, keys: &mut Keys) -> Option<Gradient> {
    let laws = ["selfoc", "squared", "radial", "axial", "fish_eye", "luneburg"];
    let (kind, datum) = reader.one_of(keys, &laws)?;
    let span = datum.span;
    let made = match kind.value.as_str() {
        "selfoc" => Gradient::selfoc(reader.number("selfoc", datum)?),
        "fish_eye" => Gradient::fish_eye(reader.number("fish_eye", datum)?),
        "luneburg" => Gradient::luneburg(reader.number("luneburg", datum)?),
        "squared" => Gradient::squared(&numbers(reader, "squared", datum)?),
        "radial" => Gradient::polynomial(&numbers(reader, "radial", datum)?, &[]),
        _ => Gradient::axial(&numbers(reader, "axial", datum)?),
    };
    reader.accept(made, span)
}

fn numbers(reader: &mut Reader, what: &str, datum: Spanned<Datum>) -> Option<Vec<f64>> {
    let items = list(reader, what, datum, "a list of coefficients")?;
    items.into_iter().map(|item| reader.number(what, item)).collect()
}
