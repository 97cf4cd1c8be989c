//! Values of several tables: words, numbers, lists, apertures, transforms.

use crate::component::Aperture;
use rayweave_math::Affine;
use rayweave_scene::foreign::{Keys, Reader};
use rayweave_scene::{Datum, Diagnostic, Spanned};

/// The entries of a table with free names.
pub(super) fn entries(
    reader: &mut Reader,
    what: &str,
    datum: Spanned<Datum>,
) -> Vec<(Spanned<String>, Spanned<Datum>)> {
    match datum.value {
        Datum::Table(table) => table,
        _ => {
            reader.wrong_type(what, &datum, "a table");
            Vec::new()
        }
    }
}

/// A word, or a table with one key: `"absorb"`, `{ mirror = 0.9 }`.
pub(super) enum Choice {
    Word(Spanned<String>),
    Keyed(Spanned<String>, Spanned<Datum>),
}

/// The value of `what`: one of the words, or one of the keys with its value.
pub(super) fn word_or_keyed(
    reader: &mut Reader,
    what: &str,
    datum: Spanned<Datum>,
    words: &[&str],
    keys: &[&str],
) -> Option<Choice> {
    match datum.value {
        Datum::Text(word) => {
            let word = Spanned::new(word, datum.span);
            let is_known = words.contains(&word.value.as_str());
            if keys.contains(&word.value.as_str()) {
                let problem = Diagnostic::error(format!("{what} `{}` has no value", word.value));
                let suggestion = format!("{{ {} = ... }}", word.value);
                reader.report(
                    problem.why("it must be a table with one key").suggest(Some(suggestion)),
                    datum.span,
                );
            } else if !is_known {
                reader.unknown(what, &word, &[words, keys].concat());
            }
            is_known.then_some(Choice::Word(word))
        }
        Datum::Table(mut table) if table.len() == 1 => {
            let (key, value) = table.pop()?;
            let is_known = keys.contains(&key.value.as_str());
            if words.contains(&key.value.as_str()) {
                let problem = Diagnostic::error(format!("{what} `{}` takes no value", key.value));
                let suggestion = format!("\"{}\"", key.value);
                reader.report(problem.why("it must be a word").suggest(Some(suggestion)), key.span);
            } else if !is_known {
                reader.unknown(what, &key, &[words, keys].concat());
            }
            is_known.then_some(Choice::Keyed(key, value))
        }
        _ => {
            let [words, keys] = [words, keys].map(|names| names.join(", "));
            let wanted = format!("one of the words {words}, or a table with one of the keys {keys}");
            reader.wrong_type(what, &datum, &wanted);
            None
        }
    }
}

/// A fraction of the power, from 0 to 1.
pub(super) fn fraction(reader: &mut Reader, what: &str, datum: Spanned<Datum>) -> Option<f64> {
    reader.checked(what, datum, "from 0 to 1", |value| (0.0..=1.0).contains(&value))
}

/// A finite number.
pub(super) fn finite(reader: &mut Reader, what: &str, datum: Spanned<Datum>) -> Option<f64> {
    reader.checked(what, datum, "finite", f64::is_finite)
}

/// The items of a list.
pub(super) fn list(
    reader: &mut Reader,
    what: &str,
    datum: Spanned<Datum>,
    wanted: &str,
) -> Option<Vec<Spanned<Datum>>> {
    match datum.value {
        Datum::List(list) => Some(list),
        _ => {
            reader.wrong_type(what, &datum, wanted);
            None
        }
    }
}

/// A seed of random numbers.
pub(super) fn seed(reader: &mut Reader, keys: &mut Keys) -> Option<u64> {
    keys.take("seed").and_then(|datum| reader.whole("seed", datum, 0, 1 << 53))
}

/// The product of the maps of `transform`; the identity by default.
pub(super) fn transform(reader: &mut Reader, keys: &mut Keys) -> Option<Affine> {
    match keys.take("transform") {
        Some(datum) => reader.transform(datum),
        None => Some(Affine::IDENTITY),
    }
}

/// `circle = diameter`, `rectangle = [width, height]` or `ellipse = [width, height]`, with errors
/// located at it.
pub(super) fn aperture(reader: &mut Reader, keys: &mut Keys) -> Option<Aperture> {
    let (kind, datum) = reader.one_of(keys, &["circle", "rectangle", "ellipse"])?;
    let span = datum.span;
    let aperture = match kind.value.as_str() {
        "circle" => Aperture::circle(reader.number("circle", datum)?),
        kind => {
            let [width, height] = reader.numbers(kind, datum)?;
            let is_rectangle = kind == "rectangle";
            if is_rectangle { Aperture::rectangle(width, height) } else { Aperture::ellipse(width, height) }
        }
    };
    reader.accept(aperture.checked(), span)
}
