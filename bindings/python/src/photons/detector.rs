//! Detectors: GDML files with optical properties, and simulation of photons in them.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::Packets;
use rayweave::formats::{self, Format, Imported, LossKind, Options};
use rayweave::model::drive::Cancel;
use rayweave::photon::property::{PropertyTable, Spectrum};
use rayweave::photon::{
    DetectionRule, Detector, Histories, HistoryOptions, LintFinding, OpticalMaterial, OpticalSurface,
    PhotonPart, PhotonRun, RunSettings, SurfaceTables, TimeProfile, check_start, lint, read_hits,
};
use rayweave::photon_simulator::PhotonSimulator;

use crate::device::{device_argument, warn};
use crate::error::{bad_value, require_file};
use crate::interrupt::{abandonable, interruptible};
use crate::model::overrides;
use crate::photons::hits::PyPhotonHits;
use crate::photons::light::TorchLight;
use crate::photons::parts::DetectorParts;
use crate::photons::run::{Halt, PhotonWatch, PyPhotonRun};
use crate::photons::source::PyPhotonSource;
use crate::photons::tables::PyTables;

/// A property: its name, energies in MeV, values, and unit.
type Property<'py> = (String, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, &'static str);

/// The properties and constants of a material or surface, after its name.
type Described<'py> = (String, Vec<Property<'py>>, Vec<(String, f64)>);

/// A detector, compiled: see `rayweave.photons.Detector`.
#[pyclass(frozen, module = "rayweave.photons", name = "CompiledDetector")]
pub struct PyDetector {
    parts: Arc<DetectorParts>,
    warnings: Vec<String>,
}

/// Reads a detector from a GDML file, or from a native model converted from one.
#[pyfunction]
#[pyo3(signature = (
    path, tables, parameters: "dict[str, float | str] | None" = None, *, allow = Vec::new(), strict = false, allow_missing = false
))]
pub fn load_detector(
    py: Python<'_>,
    path: PathBuf,
    tables: &PyTables,
    parameters: Option<&Bound<'_, PyDict>>,
    allow: Vec<PathBuf>,
    strict: bool,
    allow_missing: bool,
) -> PyResult<PyDetector> {
    require_file(&path)?;
    let overrides = overrides(parameters)?;
    let options = Options { allow, strict, ..Options::default() };
    let tables = tables.0.clone();
    abandonable(py, move || {
        let imported = formats::load(&path, None, &overrides, &options).map_err(bad_value)?;
        PyDetector::new(complete(imported, allow_missing)?, tables)
    })?
}

/// A model without missing geometry and undefined references, unless they are accepted.
fn complete(imported: Imported, allow_missing: bool) -> PyResult<Imported> {
    let missing = imported.report.errors(&[LossKind::Refused, LossKind::Undefined]);
    if allow_missing || missing.is_empty() {
        return Ok(imported);
    }
    let advice = "The model is incomplete, and results would be wrong. Correct the file, or accept it with allow_missing=True.";
    Err(bad_value(format!("{missing}\n\n{advice}")))
}

/// Reads a detector from the text of a GDML file, or of a native model.
#[pyfunction]
#[pyo3(signature = (
    text, tables, parameters: "dict[str, float | str] | None" = None, *, allow = Vec::new(), strict = false, allow_missing = false,
    native = false
))]
#[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
pub fn loads_detector(
    py: Python<'_>,
    text: String,
    tables: &PyTables,
    parameters: Option<&Bound<'_, PyDict>>,
    allow: Vec<PathBuf>,
    strict: bool,
    allow_missing: bool,
    native: bool,
) -> PyResult<PyDetector> {
    let overrides = overrides(parameters)?;
    let options = Options { allow, strict, ..Options::default() };
    let tables = tables.0.clone();
    let format = if native { Format::Native } else { Format::Gdml };
    abandonable(py, move || {
        let imported = formats::parse(&text, format, &overrides, &options).map_err(bad_value)?;
        PyDetector::new(complete(imported, allow_missing)?, tables)
    })?
}

/// The settings of a run.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct PhotonSettings {
    seed: u64,
    range: (u64, u64),
    detect: String,
    max_steps: u32,
    max_time: f64,
    wls_time_profile: String,
    threads: Option<NonZeroUsize>,
    event: u32,
    record: Option<(bool, bool)>,
    device: String,
}

/// The error about an argument that is none of the names from which it must be chosen.
fn unknown_choice(argument: &str, value: &str, names: &[&str]) -> PyErr {
    let (last, others) = names.split_last().unwrap_or((&"", &[]));
    bad_value(format!("{argument} is {value:?}: it must be {} or {last}.", others.join(", ")))
}

impl PhotonSettings {
    fn settings(&self, cancel: &Cancel) -> PyResult<RunSettings> {
        let detection = DetectionRule::from_name(&self.detect).ok_or_else(|| {
            unknown_choice("detect", &self.detect, &DetectionRule::ALL.map(DetectionRule::name))
        })?;
        let wls_time_profile = TimeProfile::from_name(&self.wls_time_profile).ok_or_else(|| {
            unknown_choice(
                "wls_time_profile",
                &self.wls_time_profile,
                &TimeProfile::ALL.map(TimeProfile::name),
            )
        })?;
        Ok(RunSettings {
            seed: self.seed,
            event: self.event,
            detection,
            wls_time_profile,
            max_steps: self.max_steps,
            max_time: self.max_time,
            threads: self.threads,
            cancel: cancel.clone(),
            ..RunSettings::new(self.range.0..self.range.1)
        })
    }
}

#[pymethods]
impl PyDetector {
    /// Warnings of the reader of the file.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// The probable mistakes in optical properties and surfaces, one sentence each.
    #[getter]
    fn optical_warnings(&self) -> Vec<String> {
        self.parts.detector.warnings().to_vec()
    }

    /// The ignored properties and surfaces, one sentence each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.parts.detector.notes().to_vec()
    }

    /// The names of the sensitive volumes and of their sensors.
    #[getter]
    fn sensors(&self) -> Vec<(String, String)> {
        let own = |(volume, sensor): (&str, &str)| (volume.to_owned(), sensor.to_owned());
        self.parts.detector.sensors().map(own).collect()
    }

    /// The materials: name; properties with their energies in MeV, values and units; constants.
    #[cfg_attr(
        false,
        stub(
            "() -> list[tuple[str, list[tuple[str, NDArray[np.float64], NDArray[np.float64], str]], list[tuple[str, float]]]]"
        )
    )]
    fn materials<'py>(&self, py: Python<'py>) -> Vec<Described<'py>> {
        self.parts.detector.materials().iter().map(|material| described_material(py, material)).collect()
    }

    /// The surfaces: the words of model, finish and type, the value; name, properties and constants as those of materials.
    #[cfg_attr(
        false,
        stub(
            "() -> list[tuple[tuple[str, str, str], float, tuple[str, list[tuple[str, NDArray[np.float64], NDArray[np.float64], str]], list[tuple[str, float]]]]]"
        )
    )]
    fn surfaces<'py>(&self, py: Python<'py>) -> Vec<((&str, &str, &str), f64, Described<'py>)> {
        let own = |surface: &'_ OpticalSurface| {
            let [model, finish, kind] = surface.words();
            ((model, finish, kind), surface.value, described_surface(py, surface))
        };
        self.parts.detector.surfaces().iter().map(own).collect()
    }

    /// The findings of the lint: rule (optical or unused), place, problem with its reason and suggestion.
    fn findings(&self, py: Python<'_>) -> Vec<(&'static str, Option<String>, String)> {
        let DetectorParts { imported, tables, .. } = &*self.parts;
        let places = |element, name: &str, property: &str| {
            imported.places.find(element, name, property).map(str::to_owned)
        };
        let found = py.detach(|| lint(&imported.scene, &imported.document(), tables, Packets::new, &places));
        let own = |finding: LintFinding| {
            let kind = if finding.is_unused { "unused" } else { "optical" };
            (kind, finding.place, finding.message.to_string())
        };
        let undefined = imported.report.undefined();
        let undefined = undefined.map(|loss| ("optical", loss.place(), loss.first.message().to_owned()));
        undefined.chain(found.into_iter().map(own)).collect()
    }

    /// A sentence about photons of a source that start outside the world or in a material without a refractive index; an error if
    /// all of them do.
    fn check_start(
        &self,
        py: Python<'_>,
        source: &PyPhotonSource,
        settings: PhotonSettings,
    ) -> PyResult<Option<String>> {
        source.check_detector(&self.parts)?;
        let run = settings.settings(&Cancel::new())?;
        let DetectorParts { detector, evaluator, .. } = &*self.parts;
        py.detach(|| check_start(detector, evaluator, &source.source, &run)).map_err(bad_value)
    }

    /// Hits from a table: .csv, or .npy with the file of names beside it.
    fn read_hits(&self, py: Python<'_>, path: PathBuf) -> PyResult<PyPhotonHits> {
        require_file(&path)?;
        let hits = py.detach(|| read_hits(&path, &self.parts.detector)).map_err(bad_value)?;
        Ok(PyPhotonHits { hits, flags: None, detector: self.parts.clone() })
    }

    /// A torch in a volume, or on its boundary.
    fn volume_source(
        &self,
        py: Python<'_>,
        name: &str,
        is_boundary: bool,
        light: TorchLight,
    ) -> PyResult<PyPhotonSource> {
        PyPhotonSource::in_volume(py, self.parts.clone(), (name, is_boundary), &light)
    }

    /// Gensteps in the layout of Opticks, (N, 6, 4), or of Geant4, (N, 16), with the names of materials by their numbers.
    #[pyo3(signature = (gensteps: "ArrayLike", materials: "Mapping[int, str]"))]
    fn gensteps(
        &self,
        py: Python<'_>,
        gensteps: &Bound<'_, PyAny>,
        materials: BTreeMap<u32, String>,
    ) -> PyResult<PyPhotonSource> {
        PyPhotonSource::of_gensteps(py, self.parts.clone(), gensteps, &materials)
    }

    /// Simulates photons of a source. `progress` is called with the number of finished photons and the total.
    #[pyo3(signature = (source, settings, progress: "Callable[[int, int], object] | None" = None))]
    fn simulate(
        &self,
        py: Python<'_>,
        source: &PyPhotonSource,
        settings: PhotonSettings,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<PyPhotonRun> {
        source.check_detector(&self.parts)?;
        let cancel = Cancel::new();
        let run = settings.settings(&cancel)?;
        let record = settings.record.map(|(steps, sequences)| HistoryOptions { steps, sequences });
        let device = device_argument(&settings.device)?;
        let parts = self.parts.clone();
        let begin = Instant::now();
        let simulate = || {
            let source = &source.source;
            let mut watch = PhotonWatch::new(&run.photons, progress);
            let (mut total, mut histories) = (PhotonRun::default(), Histories::default());
            let merge = |part: PhotonPart| -> Result<(), Halt> {
                watch.check(part.photons.end)?;
                total.append(part.run);
                part.histories.into_iter().for_each(|own| histories.append(own));
                Ok(())
            };
            let DetectorParts { detector, evaluator, .. } = &*parts;
            let on_device = |simulator: &PhotonSimulator| -> Result<_, Halt> {
                simulator.simulate_parts(detector, evaluator, source, &run, record, merge)?;
                let notice = simulator.finish().map_err(bad_value)?;
                Ok(notice.or(simulator.notice().map(str::to_owned)))
            };
            let notice = parts.with_simulator(device, record.is_some(), on_device).map_err(bad_value)??;
            watch.end()?;
            Ok((total, record.map(|_| histories), notice))
        };
        // errors of Python pass through as they are
        let done: Result<_, Halt> = interruptible(py, &cancel, || Ok::<_, String>(simulate()))?;
        let (run, histories, notice) = done.map_err(Halt::into_error)?;
        warn(py, notice.as_deref())?;
        PyPhotonRun::new(run, histories, begin.elapsed(), self.parts.clone())
    }
}

impl PyDetector {
    fn new(imported: Imported, tables: SurfaceTables) -> PyResult<PyDetector> {
        let detector = Detector::with_tables(&imported.scene, &imported.document(), &tables);
        let detector = detector.map_err(bad_value)?;
        let evaluator = Packets::new(detector.program().clone());
        let rendered = |warning: &rayweave::scene::Diagnostic| {
            rayweave::scene::Diagnostics::from(warning.clone()).render(false)
        };
        let warnings = imported.scene.warnings.iter().map(rendered).collect();
        let parts =
            Arc::new(DetectorParts { detector, evaluator, imported, tables, simulators: Default::default() });
        Ok(PyDetector { parts, warnings })
    }
}

/// Tables of a name, if there is one, and a unit.
type Table<'a> = (&'static str, Option<&'a PropertyTable>, &'static str);

fn properties<'py>(py: Python<'py>, tables: &[Table<'_>]) -> Vec<Property<'py>> {
    let own = |&(name, table, unit): &Table<'_>| {
        let array = |values: &[f64]| PyArray1::from_slice(py, values);
        table.map(|table| (name.to_owned(), array(table.energies()), array(table.values()), unit))
    };
    tables.iter().filter_map(own).collect()
}

fn described_material<'py>(py: Python<'py>, material: &OpticalMaterial) -> Described<'py> {
    let OpticalMaterial { index, group_velocity, absorption_length, rayleigh_length, mie, .. } = material;
    let mut tables: Vec<Table<'_>> = vec![
        ("RINDEX", index.as_ref(), ""),
        ("GROUPVEL", group_velocity.as_ref(), "mm/ns"),
        ("ABSLENGTH", absorption_length.as_ref(), "mm"),
        ("RAYLEIGH", rayleigh_length.as_ref(), "mm"),
        ("MIEHG", mie.as_ref().map(|mie| &mie.length), "mm"),
    ];
    let mut spectra = Vec::new();
    let mut constants = Vec::new();
    if let Some(mie) = mie {
        let values = [mie.forward, mie.backward, mie.forward_ratio];
        let names = ["MIEHG_FORWARD", "MIEHG_BACKWARD", "MIEHG_FORWARD_RATIO"].map(str::to_owned);
        constants.extend(names.into_iter().zip(values));
    }
    let sets = [
        ["WLSABSLENGTH", "WLSCOMPONENT", "WLSTIMECONSTANT", "WLSMEANNUMBERPHOTONS"],
        ["WLSABSLENGTH2", "WLSCOMPONENT2", "WLSTIMECONSTANT2", "WLSMEANNUMBERPHOTONS2"],
    ];
    for ([length, spectrum, time, mean], shifter) in sets.into_iter().zip(&material.shifters) {
        tables.push((length, Some(&shifter.length), "mm"));
        spectra.push((spectrum.to_owned(), &shifter.spectrum));
        constants.push((time.to_owned(), shifter.time));
        constants.extend(shifter.mean_photons.map(|number| (mean.to_owned(), number)));
    }
    for component in &material.scintillation {
        let named = |name: &str| format!("SCINTILLATION{name}{}", component.number);
        spectra.push((named("COMPONENT"), &component.spectrum));
        constants.extend(component.time.map(|time| (named("TIMECONSTANT"), time)));
        constants.push((named("RISETIME"), component.rise_time));
        constants.push((named("YIELD"), component.share));
    }
    let mut properties = properties(py, &tables);
    let array = |values: &[f64]| PyArray1::from_slice(py, values);
    let own = |(name, spectrum): (String, &Spectrum)| {
        (name, array(spectrum.energies()), array(spectrum.values()), "")
    };
    properties.extend(spectra.into_iter().map(own));
    (material.name.clone(), properties, constants)
}

fn described_surface<'py>(py: Python<'py>, surface: &OpticalSurface) -> Described<'py> {
    let (real, imaginary) = match &surface.metal_index {
        Some((real, imaginary)) => (Some(real), Some(imaginary)),
        None => (None, None),
    };
    let tables = [
        ("REFLECTIVITY", surface.reflectivity.as_ref(), ""),
        ("TRANSMITTANCE", surface.transmittance.as_ref(), ""),
        ("EFFICIENCY", surface.efficiency.as_ref(), ""),
        ("RINDEX", surface.index.as_ref(), ""),
        ("REALRINDEX", real, ""),
        ("IMAGINARYRINDEX", imaginary, ""),
        ("SPECULARLOBECONSTANT", surface.lobe.as_ref(), ""),
        ("SPECULARSPIKECONSTANT", surface.spike.as_ref(), ""),
        ("BACKSCATTERCONSTANT", surface.backscatter.as_ref(), ""),
    ];
    let constants = vec![("SURFACEROUGHNESS".to_owned(), surface.roughness)];
    (surface.name.clone(), properties(py, &tables), constants)
}
