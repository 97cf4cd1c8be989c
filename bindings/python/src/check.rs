//! Findings of a model check, as rows.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayweave::check::{
    CheckProgress, CheckReport, CheckSettings, Finding, Hierarchy, check, finding_section,
};
use rayweave::model::drive::Cancel;
use rayweave::{AnalysisError, AnyEvaluator};

use crate::engine::thread_argument;
use crate::model::PyModel;
use crate::progress::watched;
use crate::section::PySection;
use crate::subject::{bounds, scene};

/// Kind, regions, text; size, volume with its half width, area; place; ray; whether it is proved;
/// picture.
type Row = (
    (&'static str, Vec<String>, String, Vec<String>),
    [f64; 4],
    Option<[f64; 3]>,
    Option<[[f64; 3]; 2]>,
    bool,
    Option<PySection>,
);

/// Probable faults of a model, with the unit and the scope of the check: see `rayweave.check`.
#[pyfunction]
#[pyo3(signature = (
    subject: "Subject", wall, gap, distance, cells, confidence, most_pairs,
    within: "Sequence[Sequence[float]] | None", seed, pictures, threads: "int | None",
    progress: "Callable[[int, int], object] | None" = None
) -> "tuple[list[CheckRow], str, dict[str, float]]")]
#[expect(clippy::too_many_arguments, reason = "those of the function in Python")]
pub fn check_rows<'py>(
    subject: &Bound<'py, PyAny>,
    wall: Option<f64>,
    gap: Option<f64>,
    distance: Option<f64>,
    cells: u32,
    confidence: f64,
    most_pairs: usize,
    within: Option<[[f64; 3]; 2]>,
    seed: u64,
    pictures: bool,
    threads: Option<&Bound<'py, PyAny>>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Vec<Row>, &'static str, Bound<'py, PyDict>)> {
    let py = subject.py();
    let scene = scene(subject)?;
    let model = subject.cast::<PyModel>().ok();
    let hierarchy = model.and_then(|model| Hierarchy::of(model.get().stated()?, &scene));
    let cancel = Cancel::new();
    let settings = CheckSettings {
        wall,
        gap,
        distance,
        across: cells,
        confidence,
        most_pairs,
        within: within.map(bounds),
        seed,
        threads: threads.map(thread_argument).transpose()?,
        cancel: cancel.clone(),
    };
    let unit = scene.unit.symbol();
    let (report, rows) = watched(py, &cancel, progress, |watch| {
        let mut tell = |now: CheckProgress| watch.report(now.done, now.total);
        let report = check(&scene, hierarchy.as_ref(), AnyEvaluator::maker(None), &settings, &mut tell)?;
        let picture = |finding: &Finding| match pictures {
            true => finding_section(&scene, finding, AnyEvaluator::maker(None), &settings),
            false => Ok(None),
        };
        let row = |finding: &Finding| {
            let section = picture(finding)?.map(|section| PySection::new(section, unit));
            Ok(row(finding, section))
        };
        let rows = report.findings.iter().map(row).collect::<Result<Vec<_>, AnalysisError>>()?;
        Ok::<_, AnalysisError>((report, rows))
    })?;
    Ok((rows, unit, scope(py, &report)?))
}

fn row(finding: &Finding, section: Option<PySection>) -> Row {
    let volume = finding.volume.map_or([f64::NAN; 2], |volume| [volume.value, volume.half_width]);
    let or_nan = |value: Option<f64>| value.unwrap_or(f64::NAN);
    (
        (finding.kind.name(), finding.regions.clone(), finding.text.clone(), finding.faces.clone()),
        [or_nan(finding.size), volume[0], volume[1], or_nan(finding.area)],
        finding.at.map(|at| at.to_array()),
        finding.ray.map(|ray| [ray.from.to_array(), ray.to.to_array()]),
        finding.is_proved,
        section,
    )
}

fn scope<'py>(py: Python<'py>, report: &CheckReport) -> PyResult<Bound<'py, PyDict>> {
    let (dict, scope) = (PyDict::new(py), &report.scope);
    dict.set_item("rays", scope.rays)?;
    dict.set_item("cells", scope.cells)?;
    dict.set_item("cells_in_regions", scope.cells_in_regions)?;
    dict.set_item("reached", scope.reached)?;
    dict.set_item("chords", scope.chords)?;
    dict.set_item("edges", scope.edges)?;
    dict.set_item("edges_left_out", scope.edges_left_out)?;
    dict.set_item("wall", scope.wall)?;
    dict.set_item("gap", scope.gap)?;
    dict.set_item("distance", scope.distance)?;
    dict.set_item("parts", scope.parts)?;
    dict.set_item("pairs_apart", scope.apart)?;
    dict.set_item("pairs", scope.pairs)?;
    dict.set_item("pairs_left_out", scope.left_out)?;
    dict.set_item("operands", scope.operands)?;
    dict.set_item("operands_left_out", scope.operands_left_out)?;
    dict.set_item("pieces_left_out", scope.pieces_left_out)?;
    dict.set_item("cavities_left_out", scope.cavities_left_out)?;
    dict.set_item("has_hierarchy", scope.has_hierarchy)?;
    Ok(dict)
}
