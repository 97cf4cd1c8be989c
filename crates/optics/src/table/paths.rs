//! The table of ray paths.

use crate::{Path, Paths};
use rayweave_table::{Chunk, Column, DType, Schema, TableError, TableWriter, Values};
use std::sync::Arc;

/// Writes the ray paths in order of decreasing power.
///
/// The columns: `path`, its elements, with a `*` for a reflection and a `-` for no element;
/// `reflections`, their number; `end`, the element at its end, empty for none; `rays`; `power`, at
/// the start of the last segments; `part`, the fraction of the emitted power. The extension of
/// `out` determines the format, `.csv`, `.npy` or (with the feature `parquet`) `.parquet`.
///
/// # Errors
/// The table cannot be written.
pub fn write_paths(
    out: &std::path::Path,
    paths: &Paths,
    elements: &[String],
    emitted: f64,
) -> Result<u64, TableError> {
    let list = paths.list();
    let texts: Arc<[String]> = list.iter().map(|path| path.text(elements)).collect();
    let columns = vec![
        Column::names("path", texts),
        Column::new("reflections", DType::I64),
        Column::names("end", elements.into()),
        Column::new("rays", DType::I64),
        Column::new("power", DType::F64),
        Column::new("part", DType::F64),
    ];
    let schema = Schema::new(columns)?;
    let mut writer = TableWriter::create(out, &schema)?;
    writer.write(&rows(&list, emitted)?)?;
    writer.finish()
}

fn rows(list: &[Path], emitted: f64) -> Result<Chunk, TableError> {
    let whole = |value: fn(&Path) -> i64| Values::from(list.iter().map(value).collect::<Vec<i64>>());
    let number = |value: &dyn Fn(&Path) -> f64| Values::from(list.iter().map(value).collect::<Vec<f64>>());
    let end = |path: &Path| path.steps.last().and_then(|step| u32::try_from(step.0).ok());
    let ends: Vec<u32> = list.iter().map(|path| end(path).unwrap_or(rayweave_table::NO_NAME)).collect();
    let columns = vec![
        Values::from((0..list.len() as u32).collect::<Vec<u32>>()),
        whole(|path| path.reflections() as i64),
        Values::from(ends),
        whole(|path| path.rays as i64),
        number(&|path| path.power),
        number(&|path| path.power / emitted),
    ];
    Chunk::new(columns)
}
