//! Tool traces of infill, as columns.

use std::sync::Arc;

use numpy::PyArray1;
use pyo3::prelude::*;
use rayweave::AnyEvaluator;
use rayweave::infill::{
    Fillable, Filling, InfillError, InfillRun, LayerTraces, Layers, Raster, Slices, infill,
};
use rayweave::model::Program;
use rayweave::model::memory::Growth;

use crate::arrays::list;
use crate::engine::{Engine, thread_argument};
use crate::error::{bad_type, bad_value, shown};
use crate::model::PyModel;
use crate::polygons::PyPolygons;
use crate::solid::PySolid;

/// Integers: layer, scanline, component.
type Whole<'py> = Bound<'py, PyArray1<i64>>;

/// The columns in the order of the table.
type Columns<'py> = ([Whole<'py>; 3], [Bound<'py, PyArray1<f64>>; 5]);

/// The traces that fill a solid, a model or a region: see `rayweave.infill`.
#[pyfunction]
#[pyo3(signature = (
    subject: "Subject | Polygons", spacing, angle, phase, turn, alternate, layers: "ArrayLike | None",
    layer_height, evaluator, threads: "int | None"
))]
#[allow(clippy::too_many_arguments)] // those of the function in Python
pub fn infill_columns<'py>(
    subject: &Bound<'py, PyAny>,
    spacing: f64,
    angle: f64,
    phase: f64,
    turn: f64,
    alternate: bool,
    layers: Option<&Bound<'py, PyAny>>,
    layer_height: Option<f64>,
    evaluator: Option<&str>,
    threads: Option<&Bound<'py, PyAny>>,
) -> PyResult<Columns<'py>> {
    let py = subject.py();
    let raster = Raster::new(spacing, angle, phase).map_err(bad_value)?;
    let filling = Filling { raster, turn, alternate };
    let run = InfillRun { threads: threads.map(thread_argument).transpose()?, ..InfillRun::default() };
    let heights = layers.map(|layers| list(layers, "layers")).transpose()?;
    let table = match subject.cast::<PyPolygons>() {
        Ok(region) => {
            if heights.is_some() || layer_height.is_some() {
                let text = "a region of the plane is one layer: layers and layer_height are for solids.";
                return Err(bad_value(text));
            }
            let region = region.get().polygons();
            py.detach(|| fill(region, &filling, &Layers::At(vec![0.0]), &run))?
        }
        Err(_) => {
            let layers = match (heights, layer_height) {
                (Some(heights), None) => Layers::At(heights),
                (None, Some(height)) => Layers::Every(height),
                _ => {
                    return Err(bad_value(
                        "layers or layer_height must be given, but not both: a solid is filled layer by layer.",
                    ));
                }
            };
            let program = program_of(subject)?;
            let evaluator = evaluator_of(&program, evaluator)?;
            py.detach(|| fill(&Slices(&evaluator), &filling, &layers, &run))?
        }
    };
    Ok((
        table.whole.map(|column| PyArray1::from_vec(py, column)),
        table.numbers.map(|column| PyArray1::from_vec(py, column)),
    ))
}

fn program_of(subject: &Bound<'_, PyAny>) -> PyResult<Arc<Program>> {
    let py = subject.py();
    let program = |engine: &Engine| engine.program.clone();
    if let Ok(solid) = subject.cast::<PySolid>() {
        return solid.get().engine(py).map(program);
    }
    match subject.cast::<PyModel>() {
        Ok(model) => model.get().compiled(py).map(|(_, engine)| program(engine)),
        Err(_) => {
            Err(bad_type(format!("subject is {}: it must be a Solid, a Model or Polygons.", shown(subject))))
        }
    }
}

fn evaluator_of(program: &Arc<Program>, name: Option<&str>) -> PyResult<AnyEvaluator> {
    AnyEvaluator::new(name, program.clone()).map_err(bad_value)
}

/// Builder of the columns.
#[derive(Default)]
struct Table {
    /// `layer`, `scanline`, `component`.
    whole: [Vec<i64>; 3],
    /// `z` and the ends.
    numbers: [Vec<f64>; 5],
}

/// The size of a row of the table in bytes.
const ROW: u64 = 8 * 8;

/// The reason why a run ended early.
struct Stopped(PyErr);

impl From<InfillError> for Stopped {
    fn from(error: InfillError) -> Stopped {
        Stopped(bad_value(error))
    }
}

fn fill<F: Fillable>(fillable: &F, filling: &Filling, layers: &Layers, run: &InfillRun) -> PyResult<Table> {
    let (mut table, mut growth) = (Table::default(), Growth::default());
    infill(fillable, filling, layers, run, |layer| {
        growth
            .check((table.numbers[0].len() + layer.traces.len()) as u64 * ROW)
            .map_err(InfillError::from)?;
        table.add(&layer);
        Python::attach(|py| py.check_signals()).map_err(Stopped)
    })
    .map_err(|Stopped(error)| error)?;
    Ok(table)
}

impl Table {
    fn add(&mut self, layer: &LayerTraces) {
        for trace in &layer.traces {
            let whole = [layer.layer as i64, trace.scanline, i64::from(trace.component)];
            let numbers = [layer.z, trace.from[0], trace.from[1], trace.to[0], trace.to[1]];
            self.whole.iter_mut().zip(whole).for_each(|(column, value)| column.push(value));
            self.numbers.iter_mut().zip(numbers).for_each(|(column, value)| column.push(value));
        }
    }
}
