//! Emission of photons without propagation, and a check of the places where they start.

use crate::detector::Detector;
use crate::error::PhotonError;
use crate::photon::{EventKey, Photon};
use crate::property::{PropertyTable, wavelength_nm};
use crate::settings::RunSettings;
use crate::source::Source;
use rayweave_error::short_number;
use rayweave_model::{Evaluator, RegionId};

/// The photons of a run as the source emits them, by their numbers.
///
/// # Errors
///
/// [`PhotonError::Setting`] for invalid photons, and for numbers beyond those of the source.
pub fn emit<E: Evaluator>(
    detector: &Detector,
    evaluator: &E,
    source: &Source,
    settings: &RunSettings,
) -> Result<Vec<Photon>, PhotonError> {
    source.check()?;
    source.check_range(&settings.photons)?;
    let mut photons = Vec::new();
    let key = EventKey { seed: settings.seed, event: settings.event };
    let numbers = settings.photons.clone();
    source.emit((detector, evaluator), &mut evaluator.scratch(), key, numbers, &mut photons);
    Ok(photons)
}

/// The number of photons whose places are checked.
const CHECKED: u64 = 1000;

/// Checks the first photons of a run. Returns a sentence if some of them start outside the world or in a material without a
/// refractive index, where they end at once, or else if the energies of all are outside the tables of all indices.
///
/// # Errors
///
/// [`PhotonError::Setting`] if all of them do.
pub fn check_start<E: Evaluator>(
    detector: &Detector,
    evaluator: &E,
    source: &Source,
    settings: &RunSettings,
) -> Result<Option<String>, PhotonError> {
    let start = settings.photons.start;
    let end = settings.photons.end.min(start.saturating_add(CHECKED));
    let photons =
        emit(detector, evaluator, source, &RunSettings { photons: start..end, ..settings.clone() })?;
    let columns =
        [0, 1, 2].map(|axis| photons.iter().map(|photon| photon.position[axis]).collect::<Vec<_>>());
    let mut regions = vec![RegionId(0); photons.len()];
    evaluator.regions_at(columns.each_ref().map(Vec::as_slice), &mut evaluator.scratch(), &mut regions);
    let is_lost = |region: &RegionId| detector.material(*region).index.is_none();
    let lost = regions.iter().filter(|region| is_lost(region)).count();
    let Some(at) = regions.iter().position(is_lost) else { return Ok(beyond_tables(detector, &photons)) };
    let place = match regions[at].0 {
        0 => "outside the world".to_owned(),
        region => {
            let material = &detector.material(regions[at]).name;
            let volume = &detector.region_names[region as usize];
            format!("in the volume `{volume}` of material `{material}`, which has no RINDEX")
        }
    };
    let position = photons[at].position;
    if lost == photons.len() {
        let problem = format!("the source at {position} is {place}");
        return Err(PhotonError::setting(problem, "no photon can move there"));
    }
    Ok(Some(format!(
        "{lost} of the first {} photons end at once: photon {} starts at {position}, {place}.",
        photons.len(),
        start + at as u64
    )))
}

/// A sentence if the energies of all photons are outside the tables of all refractive indices.
fn beyond_tables(detector: &Detector, photons: &[Photon]) -> Option<String> {
    let tables = detector.materials().iter().filter_map(|material| material.index.as_ref());
    let range = |table: &PropertyTable| match table.energies() {
        [first, .., last] => [*first, *last],
        // a single value has no range
        _ => [0.0, f64::INFINITY],
    };
    let ranges: Vec<[f64; 2]> = tables.map(range).collect();
    // wavelengths at the ends of a table are within it up to rounding
    let is_within =
        |energy: f64, [low, high]: [f64; 2]| (low * (1.0 - 1e-9)..=high * (1.0 + 1e-9)).contains(&energy);
    let is_known = |photon: &Photon| ranges.iter().any(|&range| is_within(photon.energy, range));
    if ranges.is_empty() || photons.is_empty() || photons.iter().any(is_known) {
        return None;
    }
    let of = |all: &mut dyn Iterator<Item = f64>| {
        let (low, high) =
            all.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), x| (low.min(x), high.max(x)));
        // a wavelength below 1 nm is in another unit by mistake
        let shown = |nm: f64| match nm < 1.0 {
            true => short_number(nm),
            false => ((nm * 10.0).round() / 10.0).to_string(),
        };
        let [low, high] = [wavelength_nm(high), wavelength_nm(low)].map(shown);
        if low == high { format!("{low} nm") } else { format!("{low} nm to {high} nm") }
    };
    let own = of(&mut photons.iter().map(|photon| photon.energy));
    let known = of(&mut ranges.iter().flatten().copied());
    Some(format!(
        "the wavelengths of the source, {own}, are outside all tables of RINDEX, {known}: photons have the values at the ends of \
         the tables."
    ))
}
