//! Energies of property tables that are not those of light.

use crate::detector::properties::Owner;
use rayweave_error::Message;
use rayweave_scene::Datum;

/// The range of photon energies of light in MeV, generously: 0.1 to 100 eV. A table that lies outside it is not about light.
const LIGHT: [f64; 2] = [1e-7, 1e-4];

/// A number with at most four significant digits.
pub(crate) fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&value.abs()) {
        return scientific(value);
    }
    let digits = (3.0 - libm::log10(value.abs()).floor()).max(0.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A number with an exponent and at most four significant digits, without zeros at their end.
fn scientific(value: f64) -> String {
    let text = format!("{value:.3e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    format!("{}e{exponent}", digits.trim_end_matches('0').trim_end_matches('.'))
}

/// Two numbers as a range, in one format: with exponents if one of them needs an exponent.
pub(crate) fn short_range(ends: [f64; 2]) -> String {
    let has_exponent = ends.map(short).iter().any(|text| text.contains('e'));
    let [low, high] = ends.map(|end| if has_exponent && end != 0.0 { scientific(end) } else { short(end) });
    format!("{low} to {high}")
}

/// The message about energies that are not those of light: numbers of another unit, taken as MeV.
pub(crate) fn foreign(owner: &Owner, name: &str, points: &[(f64, f64)]) -> Option<Message> {
    let low = points.iter().map(|point| point.0).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|point| point.0).fold(0.0, f64::max);
    if points.is_empty() || (low <= LIGHT[1] && high >= LIGHT[0]) {
        return None;
    }
    let within = |range: std::ops::RangeInclusive<f64>| range.contains(&low) && range.contains(&high);
    let advice = match () {
        () if within(0.5..=50.0) => {
            "The numbers look like eV: write the unit, as in `3*eV`; MeV is the default."
        }
        () if within(50.0..=3000.0) => {
            "The numbers look like wavelengths in nm: convert them to energies, as in `1239.84/420*eV`."
        }
        () if within(5e-4..=0.05) => {
            "The numbers look like keV: write the unit, as in `3*eV`; MeV is the default."
        }
        () if within(5e-13..=5e-11) => "The unit eV is probably applied twice.",
        () if within(1e-20..=1e-17) => {
            "The numbers look like joules: write energies with a unit, as in `3*eV`."
        }
        () => "Write energies with a unit, as in `3*eV`.",
    };
    let problem = format!("the energies of `{name}` of {owner} are not those of light");
    let reason = format!("they are {} eV", short_range([low * 1e6, high * 1e6]));
    Some(Message::new(problem, reason).suggest(advice))
}

/// The energies and values of a property, in the order of the file; none if its matrix has not two columns.
pub(crate) fn points(table: &Datum, property: &Datum) -> Vec<(f64, f64)> {
    let Some(name) = property.as_text() else { return Vec::new() };
    let matrix = table.list("matrix").find(|row| row.text("name") == name);
    let matrix = matrix.filter(|row| row.get("columns").and_then(Datum::as_number) == Some(2.0));
    let values: Vec<f64> =
        matrix.into_iter().flat_map(|row| row.list("values")).filter_map(Datum::as_number).collect();
    values.as_chunks::<2>().0.iter().map(|[energy, value]| (*energy, *value)).collect()
}

/// The messages about energies that are not those of light, at most one for each material and surface: a mistake that changes every
/// result of a run.
pub(crate) fn all_foreign(table: &Datum) -> Vec<Message> {
    let rows = |element, list| table.list(list).map(move |row| (Owner::new(element, row.text("name")), row));
    let all = rows("material", "material").chain(rows("surface", "surface"));
    let first = |(owner, row): (Owner, &Datum)| {
        let mut properties = row.get("properties").into_iter().flat_map(Datum::entries);
        properties.find_map(|(name, datum)| foreign(&owner, name, &points(table, datum)))
    };
    all.filter_map(first).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_one_format() {
        assert_eq!(
            [2e6, 3.5e6, 1.2346e7, 1e-4, 420.0, 0.5, 0.0].map(short),
            ["2e6", "3.5e6", "1.235e7", "1e-4", "420", "0.5", "0"]
        );
        assert_eq!(short_range([2e6, 3.5e6]), "2e6 to 3.5e6");
        assert_eq!(short_range([2e5, 3.5e6]), "2e5 to 3.5e6");
        assert_eq!(short_range([2.0, 3.5]), "2 to 3.5");
    }
}
