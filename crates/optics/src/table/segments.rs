//! The table of segments: one row for each ray segment between two events.

use super::LightTableError;
use crate::{Balance, Emitter, Event, Phases, Segments, System, TraceSettings, Tracer};
use rayweave_model::Evaluator;
use rayweave_table::{Chunk, Column, DType, NO_NAME, Part, Schema, TableError, TableWriter, Values};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// The table of the segments of many rays.
///
/// The columns, in this order:
///
/// - `id`: the number of the ray, from 0; `parent`: the row of the segment before, -1 for the
///   first; `generation`: the number of events before; `source`: the number of the source;
/// - `wavelength_nm`; `intensity`: the power at the start; `index` of the medium;
/// - `x0`, `y0`, `z0`: the start; `x1`, `y1`, `z1`: the end, NaN for escaped light; `x_tilt`,
///   `y_tilt`, `z_tilt`: the direction, of unit length;
/// - `path`: the optical path from the source to the end;
/// - `element`, `surface`: the names of those at the end, empty for none; `event`: the event there;
/// - `phase_s`, `phase_p`, optional: the [`Phases`] at the end of the path, in degrees from 0 to
///   360, NaN for none.
///
/// Lengths are in the unit of the document.
#[derive(Clone, Debug)]
pub struct SegmentTable {
    schema: Schema,
    phases: bool,
}

impl SegmentTable {
    /// The table for a system in a unit, with the names of its elements and surfaces, and optional
    /// columns of phases.
    ///
    /// # Errors
    ///
    /// None in practice: the names of the columns are fixed.
    pub fn new(system: &System, unit: &str, phases: bool) -> Result<SegmentTable, TableError> {
        let surfaces: Arc<[String]> =
            system.surfaces().map(|surface| system.surface_name(surface).to_owned()).collect();
        let events: Arc<[String]> = Event::ALL.iter().map(|event| event.name().to_owned()).collect();
        let mut columns = vec![Column::new("id", DType::I64), Column::new("parent", DType::Row)];
        columns.extend(["generation", "source"].map(|name| Column::new(name, DType::I64)));
        columns.push(Column::new("wavelength_nm", DType::F64).unit("nm"));
        columns.extend(["intensity", "index"].map(|name| Column::new(name, DType::F64)));
        let lengths = ["x0", "y0", "z0", "x1", "y1", "z1"];
        columns.extend(lengths.map(|name| Column::new(name, DType::F64).unit(unit)));
        columns.extend(["x_tilt", "y_tilt", "z_tilt"].map(|name| Column::new(name, DType::F64)));
        columns.push(Column::new("path", DType::F64).unit(unit));
        columns.push(Column::names("element", system.element_names().into()));
        columns.push(Column::names("surface", surfaces));
        columns.push(Column::names("event", events));
        if phases {
            columns.extend(["phase_s", "phase_p"].map(|name| Column::new(name, DType::F64).unit("deg")));
        }
        Ok(SegmentTable { schema: Schema::new(columns)?, phases })
    }

    /// The columns.
    pub fn schema(&self) -> &Schema {
        &self.schema
    }

    /// Converts segments to rows. Their parents, which count from 0, are offset by the number of
    /// rows before. `phases` computes the columns of phases; it is called only if the table has
    /// them.
    ///
    /// # Errors
    ///
    /// None: the columns of segments, and those of their phases, are of equal length.
    pub fn rows(
        &self,
        segments: Segments,
        before: u64,
        phases: impl FnOnce(&Segments) -> Phases,
    ) -> Result<Chunk, TableError> {
        let phases = self.phases.then(|| phases(&segments));
        let moved = |row: i64| if row < 0 { row } else { row + before as i64 };
        let whole = |column: Vec<u32>| column.into_iter().map(i64::from).collect::<Vec<i64>>();
        let mut columns: Vec<Values> = vec![
            segments.id.into(),
            segments.parent.into_iter().map(moved).collect::<Vec<i64>>().into(),
            whole(segments.generation).into(),
            whole(segments.source).into(),
            segments.wavelength_nm.into(),
            segments.intensity.into(),
            segments.index.into(),
        ];
        let vectors = [segments.start, segments.end, segments.direction];
        columns.extend(vectors.into_iter().flatten().map(Values::from));
        columns.push(segments.path.into());
        columns.extend([segments.element, segments.surface].map(names));
        columns.push(segments.event.into_iter().map(u32::from).collect::<Vec<u32>>().into());
        columns.extend(phases.into_iter().flat_map(|Phases { s, p }| [s, p]).map(Values::from));
        Chunk::new(columns)
    }
}

/// A file for the table of segments.
#[derive(Clone, Copy, Debug)]
pub struct SegmentFile<'a> {
    /// The path; `-` is standard output.
    pub path: &'a Path,
    /// The unit of lengths.
    pub unit: &'a str,
    /// Whether the table has the columns of phases. They require a second evaluation of each event,
    /// on one thread.
    pub phases: bool,
    /// The part that the file is, for a trace of a range of the rays ([`TraceSettings::rays`]); its description is written too.
    pub part: Option<&'a Part>,
}

/// Indices into a list of names; negative ones mean no name.
fn names(numbers: Vec<i32>) -> Values {
    let name = |number: i32| u32::try_from(number).unwrap_or(NO_NAME);
    numbers.into_iter().map(name).collect::<Vec<u32>>().into()
}

/// A summary of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightSummary {
    /// The number of rays.
    pub rays: u64,
    /// The number of segments.
    pub segments: u64,
    /// The power balance.
    pub balance: Balance,
}

/// Traces light and writes the table of its segments, if a file is given.
///
/// The columns are those of [`SegmentTable`]; the extension of `out` determines the format, `.csv`,
/// `.npy` or (with the feature `parquet`) `.parquet`, and `-` is CSV on standard output. The file
/// appears when it is complete; an error or a cancelled run leaves no file. Memory does not grow
/// with the number of rays, and the bytes do not depend on the number of threads. `look` receives
/// the segments chunk by chunk, in the order of the rays.
///
/// # Errors
///
/// [`LightTableError`]: light that cannot be traced, a table that cannot be written, or a cancelled run.
pub fn trace_light<E: Evaluator>(
    tracer: &Tracer<'_, E>,
    system: &System,
    light: &impl Emitter,
    settings: &TraceSettings,
    out: Option<SegmentFile<'_>>,
    mut look: impl FnMut(&Segments),
) -> Result<LightSummary, LightTableError> {
    let mut table = match out {
        Some(SegmentFile { path, unit, phases, .. }) => {
            let table = SegmentTable::new(system, unit, phases)?;
            let writer = TableWriter::create(path, table.schema())?;
            Some((table, writer))
        }
        None => None,
    };
    let mut segments = 0;
    let balance = tracer.run(light, settings, |rows: Segments| {
        look(&rows);
        let before = segments;
        segments += rows.len() as u64;
        match &mut table {
            Some((table, writer)) => {
                let chunk = table.rows(rows, before, |rows| tracer.phases(rows))?;
                Ok(writer.write(&chunk)?)
            }
            None => Ok::<(), LightTableError>(()),
        }
    })?;
    if let Some((_, writer)) = table {
        match out.and_then(|out| out.part) {
            Some(part) => writer.finish_part(part)?,
            None => writer.finish()?,
        };
    }
    let rays = settings.rays.as_ref().map_or(light.count(), Range::len);
    Ok(LightSummary { rays: rays as u64, segments, balance })
}
