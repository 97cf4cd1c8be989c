//! Magnitudes: energies and values that are probably off by the factor of a unit.

use crate::detector::properties::Owner;
use crate::property::LIGHT_SPEED;
use rayweave_error::Message;

/// The range of photon energies of light in MeV, generously: 0.1 to 100 eV. A table that lies outside it is not about light.
const LIGHT: [f64; 2] = [1e-7, 1e-4];

/// A number with at most four significant digits.
pub(super) fn short(value: f64) -> String {
    if value == 0.0 || !(1e-3..1e6).contains(&value.abs()) {
        return format!("{value:.3e}").replace(".000e", "e");
    }
    let digits = (3.0 - libm::log10(value.abs()).floor()).max(0.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// The message about energies that are not those of light: numbers of another unit, taken as MeV.
pub(super) fn foreign_energies(owner: &Owner, name: &str, points: &[(f64, f64)]) -> Option<Message> {
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
    let reason = format!("they are {} to {} eV", short(low * 1e6), short(high * 1e6));
    Some(Message::new(problem, reason).suggest(advice))
}

/// The message about values of an implausible magnitude. `sizes` are the diagonals in mm of the volumes of a material.
pub(super) fn implausible(
    owner: &Owner,
    name: &str,
    points: &[(f64, f64)],
    constant: Option<f64>,
    sizes: Option<[f64; 2]>,
) -> Option<Message> {
    let low = points.iter().map(|point| point.1).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|point| point.1).fold(f64::NEG_INFINITY, f64::max);
    let message = |reason: String, advice: &str| {
        let problem = format!("the values of `{name}` of {owner} are implausible");
        Some(Message::new(problem, reason).suggest(advice))
    };
    match (name, constant) {
        ("ABSLENGTH", None) if high > 0.0 => {
            let [smallest, _] = sizes?;
            let reason = format!(
                "the longest absorption length is {} mm, in volumes of at least {} mm",
                short(high),
                short(smallest)
            );
            let advice = "Write the unit, as in `2*m`; mm is the default.";
            if high < 1e-3 * smallest { message(reason, advice) } else { None }
        }
        ("RINDEX", None) if low < 0.7 || high > 5.0 => {
            let reason = format!("the index is {} to {}", short(low), short(high));
            message(reason, "Are the columns energy and index, in this order?")
        }
        ("GROUPVEL", None) if high > LIGHT_SPEED * (1.0 + 1e-6) => {
            let reason = format!("{} mm/ns is faster than light in vacuum, 299.8 mm/ns", short(high));
            message(reason, "Velocities are in mm/ns.")
        }
        ("REFLECTIVITY" | "TRANSMITTANCE" | "EFFICIENCY", None) if high > 1.0 && high <= 100.0 => message(
            format!("the largest is {}, and 1 means all light", short(high)),
            "Are they percentages? Divide by 100.",
        ),
        ("SURFACEROUGHNESS" | "COATEDTHICKNESS", Some(value)) if value > 0.01 => message(
            format!("it is {} mm, more than ten wavelengths", short(value)),
            "Write the unit, as in `20*nm`; mm is the default.",
        ),
        ("SCINTILLATIONYIELD", Some(value)) if value > 0.0 && value < 1.0 => {
            let reason = format!("{} photons per MeV are hardly any", short(value));
            message(reason, "The yield is per MeV: write `10000/MeV`, and not a number per eV or keV.")
        }
        _ => None,
    }
}
