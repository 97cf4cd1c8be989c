//! The table of ray paths.

use crate::{Path, Paths, System};
use rayweave_table::{Chunk, Column, DType, Schema, TableError, TableWriter, Values};
use std::sync::Arc;

/// Writes the ray paths in order of decreasing power.
///
/// The columns: `path`, its elements, with a `*` for a reflection and a `-` for no element;
/// `reflections`, their number; `end`, the element at its end, empty for none; `rays`; `power`, at
/// the start of the last segments; `part`, the fraction of the emitted power; `reflected_at`, the
/// surfaces of the reflections, as in the table of segments. The extension of `out` determines the format, `.csv`,
/// `.npy` or (with the feature `parquet`) `.parquet`.
///
/// # Errors
/// The table cannot be written.
pub fn write_paths(
    out: &std::path::Path,
    paths: &Paths,
    system: &System,
    emitted: f64,
) -> Result<u64, TableError> {
    let (list, elements) = (paths.list(), system.element_names());
    let name = |&surface: &i32| {
        let own = u32::try_from(surface).ok().and_then(|k| system.surfaces().nth(k as usize));
        own.map_or("-", |own| system.surface_name(own)).to_owned()
    };
    let reflections: Arc<[String]> =
        list.iter().map(|path| path.reflected_at.iter().map(name).collect::<Vec<_>>().join(" ")).collect();
    let texts: Arc<[String]> = list.iter().map(|path| path.text(elements)).collect();
    let columns = vec![
        Column::names("path", texts),
        Column::new("reflections", DType::I64),
        Column::names("end", elements.into()),
        Column::new("rays", DType::I64),
        Column::new("power", DType::F64),
        Column::new("part", DType::F64),
        Column::names("reflected_at", reflections),
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
    let numbers = || Values::from((0..list.len() as u32).collect::<Vec<u32>>());
    let columns = vec![
        numbers(),
        whole(|path| path.reflections() as i64),
        Values::from(ends),
        whole(|path| path.rays as i64),
        number(&|path| path.power),
        number(&|path| path.power / emitted),
        numbers(),
    ];
    Chunk::new(columns)
}
