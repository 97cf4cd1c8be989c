//! Fuzz target: bytes as a catalogue of glasses, in the formats AGF and YAML.

use rayweave::optics::glass::{Glass, GlassFileError, read_agf, read_refractiveindex};

/// The property: a rejected file has reasons, and each readable glass has, within its range, a positive finite index or
/// an error with a reason.
pub fn run(data: &[u8]) {
    let Some((&first, rest)) = data.split_first() else { return };
    match first % 2 {
        0 => check(read_agf(rest, "maker")),
        _ => check(read_refractiveindex(&String::from_utf8_lossy(rest), "name")),
    }
}

fn check(read: Result<Vec<Glass>, GlassFileError>) {
    let glasses = read.unwrap_or_else(|error| {
        assert!(!error.problems().is_empty() && !error.to_string().is_empty());
        error.into_readable()
    });
    for glass in &glasses {
        let [from, to] = glass.range_nm();
        assert!(from <= to, "{}: {from} to {to}", glass.name());
        for part in [0.0, 0.25, 0.5, 1.0] {
            match glass.index(from + part * (to - from)) {
                Ok(index) => assert!(index.is_finite() && index > 0.0, "{}: {index}", glass.name()),
                Err(error) => assert!(!error.to_string().is_empty()),
            }
        }
    }
}
