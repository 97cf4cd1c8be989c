//! Magnitudes: values that are probably off by the factor of a unit.

use crate::detector::properties::Owner;
use crate::energies::{short, short_range};
use crate::property::LIGHT_SPEED;
use rayweave_error::Message;

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
            let reason = format!("the index is {}", short_range([low, high]));
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
