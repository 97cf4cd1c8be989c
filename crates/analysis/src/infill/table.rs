//! The table of traces.

use super::{Fillable, Filling, InfillRun, LayerTraces, Layers, Summary, infill};
use crate::AnalysisError;
use rayweave_table::{Chunk, Column, DType, Schema, TableError, TableWriter, Values};
use std::path::Path;

/// The table of infill traces, one row per trace.
///
/// The columns, in this order: `layer`, from 0; `z`, its height; `scanline`, the number of the scan line on
/// the grid of the layer, which may be negative; `component`, from 0 in each layer; `x0`, `y0`, the start of
/// the trace; `x1`, `y1`, its end. Rows are in the order in which traces are run.
#[derive(Clone, Debug)]
pub struct InfillTable {
    schema: Schema,
}

impl InfillTable {
    /// The table with lengths in `unit`.
    ///
    /// # Errors
    ///
    /// None in practice: the names of the columns are fixed.
    pub fn new(unit: &str) -> Result<InfillTable, TableError> {
        let whole = |name| Column::new(name, DType::I64);
        let length = |name| Column::new(name, DType::F64).unit(unit);
        let columns = vec![
            whole("layer"),
            length("z"),
            whole("scanline"),
            whole("component"),
            length("x0"),
            length("y0"),
            length("x1"),
            length("y1"),
        ];
        Ok(InfillTable { schema: Schema::new(columns)? })
    }

    /// The columns.
    pub fn schema(&self) -> &Schema {
        &self.schema
    }

    /// The rows of a layer.
    ///
    /// # Errors
    ///
    /// None: the columns grow together.
    pub fn rows(&self, layer: &LayerTraces) -> Result<Chunk, TableError> {
        let traces = &layer.traces;
        let numbers = |of: &dyn Fn(usize) -> f64| Values::from((0..traces.len()).map(of).collect::<Vec<_>>());
        let whole = |of: &dyn Fn(usize) -> i64| Values::from((0..traces.len()).map(of).collect::<Vec<_>>());
        let columns = vec![
            whole(&|_| layer.layer as i64),
            numbers(&|_| layer.z),
            whole(&|k| traces[k].scanline),
            whole(&|k| i64::from(traces[k].component)),
            numbers(&|k| traces[k].from[0]),
            numbers(&|k| traces[k].from[1]),
            numbers(&|k| traces[k].to[0]),
            numbers(&|k| traces[k].to[1]),
        ];
        Chunk::new(columns)
    }
}

/// Fills a region or the layers of a solid and writes the table of traces, layer by layer; `see` is called
/// with each layer after it is written.
///
/// The extension of `out` selects the format, `.csv`, `.npy` or (with the feature `parquet`) `.parquet`; `-`
/// is CSV on standard output; without `out` nothing is written. The file appears when it is complete, and not
/// at all after an error or a cancellation. The bytes written do not depend on the number of threads.
///
/// # Errors
///
/// Those of [`infill`], and a table that cannot be written.
pub fn write_infill<F: Fillable>(
    fillable: &F,
    filling: &Filling,
    layers: &Layers,
    run: &InfillRun,
    unit: &str,
    out: Option<&Path>,
    mut see: impl FnMut(LayerTraces),
) -> Result<Summary, AnalysisError> {
    let table = InfillTable::new(unit)?;
    let create = |path| TableWriter::create(path, table.schema());
    let mut writer = out.map(create).transpose()?;
    let summary = infill(fillable, filling, layers, run, |layer| {
        if let Some(writer) = &mut writer {
            writer.write(&table.rows(&layer)?)?;
        }
        see(layer);
        Ok::<(), AnalysisError>(())
    })?;
    if let Some(writer) = writer {
        writer.finish()?;
    }
    Ok(summary)
}
