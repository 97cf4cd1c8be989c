//! The table of the ways that light took.

use crate::Error;
use rayweave_optics::{Path, Paths};
use rayweave_table::{Chunk, Column, DType, Schema, TableWriter, Values};
use std::sync::Arc;

/// Writes the ways that light took, that with the most power first.
///
/// The columns: `path`, the elements that were met, reflections marked by a `*`, nothing by a `-`; `reflections`, how often
/// light was thrown back; `end`, the element at which it ends, empty for none; `rays`; `power`, where the last segments begin;
/// `part`, that of the power that was emitted. The extension of `out` says the format, `.csv`, `.npy` or (with the feature
/// `parquet`) `.parquet`.
///
/// # Errors
/// [`crate::ErrorKind::Output`], [`crate::ErrorKind::Format`].
pub fn write_paths(
    out: &std::path::Path,
    paths: &Paths,
    elements: &[String],
    emitted: f64,
) -> Result<u64, Error> {
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
    let schema = Schema::new(columns).map_err(Error::output)?;
    let mut writer = TableWriter::create(out, &schema).map_err(Error::output)?;
    writer.write(&rows(&list, emitted)?).map_err(Error::output)?;
    writer.finish().map_err(Error::output)
}

fn rows(list: &[Path], emitted: f64) -> Result<Chunk, Error> {
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
    Chunk::new(columns).map_err(Error::output)
}
