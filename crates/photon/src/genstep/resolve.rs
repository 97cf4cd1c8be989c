//! Gensteps with the materials of a detector.

use super::cerenkov::{self, cerenkov_yield};
use super::emission::{Path, cerenkov_photon, scintillation_photon};
use super::{EmissionProcess, Genstep};
use crate::detector::Detector;
use crate::error::PhotonError;
use crate::material::OpticalMaterial;
use crate::philox::Stream;
use crate::photon::{MAX_PHOTONS, Photon};
use crate::property::HC_MEV_NM;
use crate::scintillation::chosen;
use rayweave_error::Message;
use rayweave_model::{Evaluator, RegionId};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Gensteps in a detector. The photons are numbered through all of them in their order.
#[derive(Clone, Debug)]
pub struct Gensteps {
    steps: Vec<Resolved>,
    /// The number of the first photon of each genstep, and at the end the number of all photons.
    first: Vec<u64>,
    notes: Vec<String>,
}

/// A genstep whose material is known.
#[derive(Clone, Copy, Debug)]
struct Resolved {
    path: Path,
    /// The number of the material in the detector.
    material: usize,
    light: Light,
}

#[derive(Clone, Copy, Debug)]
enum Light {
    Cerenkov {
        inverse_beta: f64,
        energies: [f64; 2],
        density: [f64; 2],
    },
    /// `component` is an index into those of the material; `None` to choose one by the yields.
    Scintillation {
        component: Option<usize>,
        time: Option<f64>,
        rise_time: Option<f64>,
        is_charged: bool,
    },
}

impl Gensteps {
    /// Assigns the materials of a detector to gensteps. `materials` are the names of materials by their numbers in the
    /// gensteps. A number without a name stands for the material that all of its gensteps lie in, by the middle of each.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] with the number of the genstep: numbers that are not finite or out of range, a material that is
    /// unknown or has no `RINDEX` or no such component of scintillation, a particle below the threshold of Cerenkov
    /// radiation, and more than 2^32 photons.
    pub fn new<E: Evaluator>(
        detector: &Detector,
        evaluator: &E,
        gensteps: &[Genstep],
        materials: &BTreeMap<u32, String>,
    ) -> Result<Gensteps, PhotonError> {
        for (row, genstep) in gensteps.iter().enumerate() {
            check(row, genstep)?;
        }
        let numbers = material_numbers(detector, evaluator, gensteps, materials)?;
        let mut first = vec![0];
        let mut steps = Vec::with_capacity(gensteps.len());
        for (row, genstep) in gensteps.iter().enumerate() {
            let material = numbers[&genstep.material];
            let light = light(row, genstep, &detector.materials[material])?;
            let Genstep { position, time, displacement, step_length, velocity, .. } = *genstep;
            let path = Path { position, time, displacement, step_length, velocity };
            steps.push(Resolved { path, material, light });
            first.push(first[row] + u64::from(genstep.photons));
        }
        let total = first[gensteps.len()];
        if total > MAX_PHOTONS {
            let problem = format!("the gensteps have {total} photons");
            return Err(PhotonError::setting(problem, "an event has at most 4294967296 photons"));
        }
        let mut notes = compare_yields(detector, gensteps, &steps);
        notes.extend(unused_names(gensteps, materials));
        notes.extend(misplaced(detector, evaluator, gensteps, materials));
        Ok(Gensteps { steps, first, notes })
    }

    /// The number of photons of all gensteps.
    #[must_use]
    pub fn photons(&self) -> u64 {
        self.first[self.steps.len()]
    }

    /// The number of the genstep that a photon comes from.
    #[must_use]
    pub fn parent(&self, photon: u64) -> usize {
        self.first.partition_point(|&first| first <= photon).saturating_sub(1)
    }

    /// True if a photon is a Cerenkov photon, and false if it is of scintillation.
    pub(crate) fn is_cerenkov(&self, photon: u64) -> bool {
        self.steps.get(self.parent(photon)).is_some_and(|step| matches!(step.light, Light::Cerenkov { .. }))
    }

    /// Sentences about numbers of Cerenkov photons that the index of their material does not explain, a sign that another
    /// material was meant; about names of numbers that no genstep has; and about gensteps that are not in the material named for them.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Appends the photons of a range of numbers.
    pub(crate) fn emit(
        &self,
        detector: &Detector,
        numbers: Range<u64>,
        stream: impl Fn(u64) -> Stream,
        photons: &mut Vec<Photon>,
    ) {
        let mut row = self.parent(numbers.start);
        for number in numbers {
            // gensteps without photons are passed over
            while self.first[row + 1] <= number {
                row += 1;
            }
            let step = &self.steps[row];
            photons.push(step.photon(&detector.materials[step.material], &mut stream(number)));
        }
    }
}

impl Resolved {
    fn photon(&self, material: &OpticalMaterial, stream: &mut Stream) -> Photon {
        match self.light {
            Light::Cerenkov { inverse_beta, energies, density } => {
                let index = material.index.as_ref();
                cerenkov_photon(&self.path, (index, inverse_beta, energies), density, stream)
            }
            Light::Scintillation { component, time, rise_time, is_charged } => {
                let components = &material.scintillation;
                let component = &components[component.unwrap_or_else(|| chosen(components, stream))];
                let decay = time.or(component.time).unwrap_or(0.0);
                let rise = rise_time.unwrap_or(component.rise_time);
                scintillation_photon(&self.path, is_charged, (&component.spectrum, decay, rise), stream)
            }
        }
    }
}

fn fault(row: usize, reason: impl Into<String>) -> PhotonError {
    PhotonError::setting(format!("genstep {row} is invalid"), reason)
}

/// Checks the numbers of a genstep that do not depend on its material.
fn check(row: usize, genstep: &Genstep) -> Result<(), PhotonError> {
    let Genstep { position, time, displacement, step_length, charge, velocity, .. } = *genstep;
    let is_moving = step_length > 0.0;
    let reason = match () {
        () if !(position.is_finite() && displacement.is_finite()) => {
            "its position and displacement must be finite"
        }
        () if !(time.is_finite() && charge.is_finite()) => "its time and charge must be finite",
        () if !(step_length >= 0.0 && step_length.is_finite()) => {
            "the length of its step must be finite and at least 0"
        }
        () if is_moving && !velocity.iter().all(|v| *v >= 0.0 && v.is_finite()) => {
            "its velocities must be finite and at least 0"
        }
        () if is_moving && velocity[0] + velocity[1] <= 0.0 => "its velocity is 0 although it moves",
        () => match genstep.process {
            EmissionProcess::Cerenkov { inverse_beta, wavelengths: [shortest, longest], density } => {
                match () {
                    () if displacement.length() == 0.0 => "a Cerenkov step needs a displacement",
                    () if !(inverse_beta >= 1.0 - 1e-6 && inverse_beta.is_finite()) => {
                        "1/beta must be finite and at least 1"
                    }
                    () if !(shortest >= 0.0 && shortest < longest) => {
                        "its wavelengths must be positive and in ascending order"
                    }
                    () if !density.iter().all(|mean| *mean >= 0.0 && mean.is_finite()) => {
                        "its mean numbers of photons must be finite and at least 0"
                    }
                    () => return Ok(()),
                }
            }
            EmissionProcess::Scintillation { time, rise_time, .. } => {
                let is_time = |time: f64| time >= 0.0 && time.is_finite();
                match is_time(time) && rise_time.is_none_or(is_time) {
                    true => return Ok(()),
                    false => "its time constants must be finite and at least 0",
                }
            }
        },
    };
    Err(fault(row, reason))
}

/// The number in the detector of each material number of gensteps.
fn material_numbers<E: Evaluator>(
    detector: &Detector,
    evaluator: &E,
    gensteps: &[Genstep],
    names: &BTreeMap<u32, String>,
) -> Result<BTreeMap<u32, usize>, PhotonError> {
    let mut found = BTreeMap::new();
    for (&number, name) in names {
        let Some(at) = detector.materials.iter().position(|material| material.name == *name) else {
            let known = detector.materials.iter().map(|material| material.name.as_str());
            return Err(PhotonError::Setting(Message::unknown("material", name, known)));
        };
        found.insert(number, at);
    }
    let unnamed: Vec<usize> =
        (0..gensteps.len()).filter(|&row| !names.contains_key(&gensteps[row].material)).collect();
    let regions = regions_of(evaluator, gensteps, &unnamed);
    for (row, region) in unnamed.into_iter().zip(regions) {
        let number = gensteps[row].material;
        let problem = |reason: String| {
            let message =
                Message::new(format!("the material {number} of genstep {row} is not known"), reason);
            PhotonError::Setting(message.suggest("Give the name of the material for this number."))
        };
        if region.0 == 0 {
            return Err(problem("the middle of the step is outside the world".to_owned()));
        }
        let at = detector.material_of[region.index()] as usize;
        let known = *found.entry(number).or_insert(at);
        if known != at {
            let [first, second] = [known, at].map(|k| &detector.materials[k].name);
            return Err(problem(format!("steps with this number are in `{first}` and in `{second}`")));
        }
    }
    Ok(found)
}

/// The regions around the middles of some gensteps.
fn regions_of<E: Evaluator>(evaluator: &E, gensteps: &[Genstep], rows: &[usize]) -> Vec<RegionId> {
    let middle = |row: &usize| gensteps[*row].position + 0.5 * gensteps[*row].displacement;
    let columns = [0, 1, 2].map(|axis| rows.iter().map(|row| middle(row)[axis]).collect::<Vec<f64>>());
    let mut regions = vec![RegionId(0); rows.len()];
    evaluator.regions_at(columns.each_ref().map(Vec::as_slice), &mut evaluator.scratch(), &mut regions);
    regions
}

/// A sentence about gensteps in another material than the one named for their number: the detector may not be that of the
/// simulation that wrote them, or the names may be wrong.
fn misplaced<E: Evaluator>(
    detector: &Detector,
    evaluator: &E,
    gensteps: &[Genstep],
    names: &BTreeMap<u32, String>,
) -> Option<String> {
    let named: Vec<usize> =
        (0..gensteps.len()).filter(|&row| names.contains_key(&gensteps[row].material)).collect();
    let regions = regions_of(evaluator, gensteps, &named);
    let around = |region: RegionId| match region.0 {
        0 => None,
        _ => {
            detector.materials.get(detector.material_of[region.index()] as usize).map(|own| own.name.as_str())
        }
    };
    let differs = |&(row, region): &(usize, RegionId)| {
        around(region) != names.get(&gensteps[row].material).map(String::as_str)
    };
    let others: Vec<(usize, RegionId)> = named.into_iter().zip(regions).filter(differs).collect();
    let &(row, region) = others.first()?;
    let name = &names[&gensteps[row].material];
    let place = around(region).map_or("outside the world".to_owned(), |other| format!("in `{other}`"));
    let count = match others.len() {
        1 => "1 genstep is".to_owned(),
        count => format!("{count} gensteps are"),
    };
    Some(format!(
        "{count} not in the material that is named for their number: the middle of genstep {row}, of `{name}`, is {place}. Their \
         light starts where they are."
    ))
}

/// The light of a genstep in its material.
fn light(row: usize, genstep: &Genstep, material: &OpticalMaterial) -> Result<Light, PhotonError> {
    let name = &material.name;
    match genstep.process {
        EmissionProcess::Cerenkov { inverse_beta, wavelengths: [shortest, longest], density } => {
            let Some(index) = &material.index else {
                return Err(fault(row, format!("its material `{name}` has no RINDEX")));
            };
            let energies = [HC_MEV_NM / longest, HC_MEV_NM / shortest];
            let light = cerenkov::integral(index, inverse_beta, energies);
            if genstep.photons > 0 && light <= 0.0 {
                let reason = match index.energies() {
                    [_] => format!(
                        "the RINDEX of `{name}` is a single number, and light is emitted in its range of energies: give \
                         RINDEX at two energies or more"
                    ),
                    _ => format!(
                        "1/beta = {inverse_beta} is not below the RINDEX of `{name}` at any of its wavelengths"
                    ),
                };
                return Err(fault(row, reason));
            }
            Ok(Light::Cerenkov { inverse_beta, energies, density })
        }
        EmissionProcess::Scintillation { component, time, rise_time } => {
            let components = &material.scintillation;
            if components.is_empty() {
                return Err(fault(row, format!("its material `{name}` has no SCINTILLATIONCOMPONENT1")));
            }
            let time = Some(time).filter(|time| *time > 0.0);
            let at = match (component, time) {
                (Some(number), _) => {
                    let at = components.iter().position(|component| component.number == number);
                    let missing = || format!("its material `{name}` has no SCINTILLATIONCOMPONENT{number}");
                    Some(at.ok_or_else(|| fault(row, missing()))?)
                }
                (None, Some(_)) if components.len() == 1 => Some(0),
                (None, Some(time)) => {
                    // float32 tables have relative errors of 6e-8
                    let is_equal = |own: f64| (own - time).abs() <= 1e-6 * time;
                    let at = components.iter().position(|component| component.time.is_some_and(is_equal));
                    let missing = || {
                        format!("no scintillation of its material `{name}` has the time constant {time} ns")
                    };
                    Some(at.ok_or_else(|| fault(row, missing()))?)
                }
                (None, None) => None,
            };
            let untimed = components.iter().enumerate().find(|(k, component)| {
                time.is_none() && component.time.is_none() && at.is_none_or(|at| at == *k)
            });
            if let Some((_, component)) = untimed {
                let reason =
                    format!("its material `{name}` has no SCINTILLATIONTIMECONSTANT{}", component.number);
                return Err(fault(row, reason));
            }
            if at.is_none() && components.iter().all(|component| component.share <= 0.0) {
                return Err(fault(row, format!("the yields of its material `{name}` are all 0")));
            }
            let is_charged = genstep.charge != 0.0;
            Ok(Light::Scintillation { component: at, time, rise_time, is_charged })
        }
    }
}

/// A sentence about names of material numbers that no genstep has, if other numbers have no name: they may be misspelt. A table
/// of all materials of the other program is no mistake.
fn unused_names(gensteps: &[Genstep], names: &BTreeMap<u32, String>) -> Option<String> {
    let numbers: BTreeSet<u32> = gensteps.iter().map(|genstep| genstep.material).collect();
    let (unused, _) = names.iter().find(|(number, _)| !numbers.contains(number))?;
    let unnamed = numbers.iter().find(|number| !names.contains_key(number))?;
    Some(format!(
        "the material {unused} has a name and no genstep has this number, and the material {unnamed} has none: its gensteps take \
         the material that they lie in. Check the numbers."
    ))
}

/// Compares the numbers of Cerenkov photons with the means of their materials.
fn compare_yields(detector: &Detector, gensteps: &[Genstep], steps: &[Resolved]) -> Vec<String> {
    let mut sums: BTreeMap<usize, (f64, f64)> = BTreeMap::new();
    for (genstep, step) in gensteps.iter().zip(steps) {
        let material = &detector.materials[step.material];
        if let (Light::Cerenkov { inverse_beta, .. }, Some(index)) = (step.light, &material.index) {
            let mean = genstep.step_length * cerenkov_yield(index, inverse_beta, genstep.charge);
            let (stated, expected) = sums.entry(step.material).or_default();
            *stated += f64::from(genstep.photons);
            *expected += mean;
        }
    }
    let differs = |(stated, expected): (f64, f64)| {
        let difference = (stated - expected).abs();
        difference > 6.0 * expected.sqrt() && difference > 0.1 * expected
    };
    let note = |(material, (stated, expected)): (usize, (f64, f64))| {
        let name = &detector.materials[material].name;
        let text = format!(
            "the gensteps in `{name}` have {stated} Cerenkov photons: its RINDEX predicts {expected:.0}. Compare its RINDEX with \
             that of the simulation that wrote the gensteps."
        );
        differs((stated, expected)).then_some(text)
    };
    sums.into_iter().filter_map(note).collect()
}
