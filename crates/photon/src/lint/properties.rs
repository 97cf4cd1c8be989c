//! Rules for the properties of one material or surface: names, energies, order.

use super::state::Lint;
use super::values;
use crate::detector::former_names::successor;
use crate::detector::properties::Owner;
use crate::energies;
use rayweave_error::Message;
use rayweave_scene::Datum;

/// Emission spectra, by their present names.
const SPECTRA: [&str; 5] = [
    "SCINTILLATIONCOMPONENT1",
    "SCINTILLATIONCOMPONENT2",
    "SCINTILLATIONCOMPONENT3",
    "WLSCOMPONENT",
    "WLSCOMPONENT2",
];

/// The smallest fraction of photons at other energies than with a linear density for which a spectrum is called coarse. It is about
/// 0.1 h / sigma for points at the distance h on a Gaussian of the deviation sigma.
const COARSE: f64 = 0.1;

/// The message about an emission spectrum of few points: between two of them Geant4's density is constant, their mean.
///
/// On an interval of the width w with the values a and b, the fraction |b - a| w / 8 of the photons lies in the other half than with
/// a linear density; the area is (a + b) w / 2 with both.
fn coarse_spectrum(owner: &Owner, name: &str, mut points: Vec<(f64, f64)>) -> Option<Message> {
    if !SPECTRA.contains(&successor(name).unwrap_or(name))
        || points.iter().any(|point| !(point.0.is_finite() && point.1 >= 0.0))
    {
        return None;
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let sum = |of: fn(f64, f64) -> f64| -> f64 {
        points.windows(2).map(|pair| (pair[1].0 - pair[0].0) * of(pair[0].1, pair[1].1)).sum()
    };
    let (moved, area) = (sum(|a, b| (b - a).abs() / 8.0), sum(|a, b| (a + b) / 2.0));
    if area <= 0.0 || moved < COARSE * area {
        return None;
    }
    let problem = format!("the emission spectrum `{name}` of {owner} has few points");
    let percent = energies::short((100.0 * moved / area).round());
    let reason = format!(
        "as in Geant4, the density between two points is constant, their mean, and {percent} % of the photons have other energies \
         than with a density that is linear between the points"
    );
    Some(
        Message::new(problem, reason)
            .suggest("Add points where the values change, also near ends with the value 0."),
    )
}

impl Lint<'_> {
    /// All rules about single properties.
    pub(super) fn properties(&mut self) {
        for (owner, row) in self.owners() {
            let properties: Vec<(&str, &Datum)> =
                row.get("properties").into_iter().flat_map(Datum::entries).collect();
            for (name, datum) in &properties {
                self.name(&owner, name);
                let points = self.points(datum);
                self.energies(&owner, name, &points);
                if let Some(message) = coarse_spectrum(&owner, name, points) {
                    self.find(&owner, name, message);
                }
                if let Some(message) = self.implausible_value(&owner, name, datum) {
                    self.find(&owner, name, message);
                }
            }
            self.ranges(&owner, &properties);
            self.velocity(&owner, &properties);
            self.constants(&owner, &properties);
        }
    }

    /// The message about a property of an element with values of an implausible magnitude.
    pub(super) fn implausible(&self, owner: &Owner, name: &str) -> Option<Message> {
        let row = self.table.list(owner.element).find(|row| row.text("name") == owner.name)?;
        self.implausible_value(owner, name, row.get("properties")?.get(name)?)
    }

    fn implausible_value(&self, owner: &Owner, name: &str, datum: &Datum) -> Option<Message> {
        let (points, constant) = (self.points(datum), self.constant(datum));
        values::implausible(owner, name, &points, constant, self.sizes(owner))
    }

    /// Reports names that Geant4 11 replaced.
    fn name(&mut self, owner: &Owner, name: &str) {
        if let Some(new) = successor(name) {
            let problem = format!("{owner} has the property `{name}`");
            let reason = "Geant4 11 renamed it, and its GDML reader ignores the old name without a message";
            let advice = match name {
                "YIELDRATIO" => {
                    "Use SCINTILLATIONYIELD1 and, with 1 minus the ratio, SCINTILLATIONYIELD2.".to_owned()
                }
                _ => format!("Use {new}."),
            };
            self.find(owner, name, Message::new(problem, reason).suggest(advice));
        }
    }

    /// Energies that do not ascend, or are not those of light.
    fn energies(&mut self, owner: &Owner, name: &str, points: &[(f64, f64)]) {
        if let Some(message) = energies::foreign(owner, name, points) {
            return self.find(owner, name, message);
        }
        let falls = |pair: &[(f64, f64)]| pair[1].0 < pair[0].0;
        let falling = points.windows(2).filter(|pair| falls(pair)).count();
        // a list by wavelength falls throughout: nothing is wrong with it
        if falling > 0 && falling + 1 < points.len() {
            let at = points.windows(2).position(falls).unwrap_or(0);
            let [before, after] =
                [points[at].0, points[at + 1].0].map(|energy| energies::short(energy * 1e6));
            let problem = format!("the energies of `{name}` of {owner} are unsorted");
            let reason = format!("{after} eV follows {before} eV at row {}", at + 2);
            let advice = "Sort the rows; they are used in the order of their energies.";
            self.find(owner, name, Message::new(problem, reason).suggest(advice));
        }
    }

    /// Ranges of energies that do not overlap, and emission beyond the range of the index.
    fn ranges(&mut self, owner: &Owner, properties: &[(&str, &Datum)]) {
        let range = |points: &[(f64, f64)]| {
            let energies = || points.iter().map(|point| point.0);
            let range = [energies().fold(f64::INFINITY, f64::min), energies().fold(0.0, f64::max)];
            (points.len() > 1).then_some(range)
        };
        let Some((_, index)) = properties.iter().find(|(name, _)| *name == "RINDEX") else { return };
        let index = self.points(index);
        let Some([low, high]) = range(&index).filter(|_| energies::foreign(owner, "", &index).is_none())
        else {
            return;
        };
        let span = |[low, high]: [f64; 2]| format!("{} eV", energies::short_range([low * 1e6, high * 1e6]));
        for (name, datum) in properties.iter().filter(|(name, _)| *name != "RINDEX") {
            let points = self.points(datum);
            let Some(own) = range(&points).filter(|_| energies::foreign(owner, "", &points).is_none()) else {
                continue;
            };
            if own[1] < low || own[0] > high {
                let problem = format!("`{name}` and `RINDEX` of {owner} have no energies in common");
                let reason = format!("they cover {} and {}", span(own), span([low, high]));
                let advice =
                    "Outside its range a table has the value of its nearest end: extend one of them.";
                self.find(owner, name, Message::new(problem, reason).suggest(advice));
            } else if SPECTRA.contains(name)
                && points.iter().any(|(energy, value)| *value > 0.0 && !(low..=high).contains(energy))
            {
                let problem = format!("{owner} emits light where its index is not given");
                let reason = format!("`{name}` covers {}, `RINDEX` {}", span(own), span([low, high]));
                let advice = "Outside its range the index has the value of its nearest end: extend RINDEX.";
                self.find(owner, name, Message::new(problem, reason).suggest(advice));
            }
        }
    }

    /// Materials without a constant with whose lack Geant4 11 stops: its processes read them by `GetConstProperty`, where a missing
    /// property is a fatal exception (mat202).
    fn constants(&mut self, owner: &Owner, properties: &[(&str, &Datum)]) {
        let has = |wanted: &str| properties.iter().any(|(name, _)| *name == wanted);
        let (none, photon) = ("Rayweave needs no such property", "where it acts on a photon");
        let rows = [
            (
                ("SCINTILLATIONCOMPONENT1", "scintillates", "RESOLUTIONSCALE"),
                ("where a particle loses energy in it", none),
                "1 for a number of photons with Poisson's distribution",
            ),
            (
                ("WLSCOMPONENT", "shifts wavelengths", "WLSTIMECONSTANT"),
                (photon, "Rayweave uses 0"),
                "the decay time of the shifter",
            ),
            (
                ("WLSCOMPONENT2", "shifts wavelengths", "WLSTIMECONSTANT2"),
                (photon, "Rayweave uses 0"),
                "the decay time of the shifter",
            ),
            (
                ("MIEHG", "has Mie scattering", "MIEHG_FORWARD_RATIO"),
                (photon, "Rayweave uses 0"),
                "the fraction of the forward scattering",
            ),
            (
                ("MIEHG", "has Mie scattering", "MIEHG_FORWARD"),
                (photon, "Rayweave uses 0"),
                "the mean cosine of the forward scattering",
            ),
            (
                ("MIEHG", "has Mie scattering", "MIEHG_BACKWARD"),
                (photon, "Rayweave uses 0"),
                "the mean cosine of the backward scattering",
            ),
        ];
        for ((present, process, needed), (place, ours), value) in rows {
            if has(present) && !has(needed) {
                let problem = format!("{owner} {process} without `{needed}`");
                let reason = format!("Geant4 stops {place}; {ours}");
                let advice = format!("Add {needed}, {value}.");
                self.find(owner, present, Message::new(problem, reason).suggest(advice));
            }
        }
    }

    /// `GROUPVEL` before `RINDEX`, which replaces it.
    fn velocity(&mut self, owner: &Owner, properties: &[(&str, &Datum)]) {
        let at = |wanted: &str| properties.iter().position(|(name, _)| *name == wanted);
        if let (Some(velocity), Some(index)) = (at("GROUPVEL"), at("RINDEX"))
            && velocity < index
        {
            let problem = format!("`GROUPVEL` of {owner} has no effect");
            let reason = "`RINDEX` follows it, and Geant4 derives the velocity when the index is added";
            let advice = "Move GROUPVEL behind RINDEX.";
            self.find_unused(owner, "GROUPVEL", Message::new(problem, reason).suggest(advice));
        }
    }
}
