//! Streaming of ray files into tables of hits, in constant memory.

mod table;

pub use table::{HitRowSink, HitSchema};

use crate::AnalysisError;
use crate::error::Cancelled;
use rayweave_error::Message;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::{BadRay, Evaluator, Program, Query, Rays};
use rayweave_scene::Compiled;
use rayweave_table::{Chunk, Part, Progress, RayChunk, RayReader, TableError, TableWriter};
use std::num::NonZeroUsize;
use std::path::Path;

/// The maximum number of rays per task. The results of a few tasks per thread wait in memory: the rows of 2,048 rays
/// with ten crossings each take 3 MiB.
const MAX_RAYS_PER_TASK: usize = 1 << 11;

/// The maximum number of ray-leaf pairs per task: a ray can cross every leaf of a large model.
const MAX_PAIRS_PER_TASK: usize = 1 << 20;

/// The same for an evaluator that prefers larger batches.
const MAX_RAYS_PER_LARGE_TASK: usize = 1 << 14;

fn rays_per_task(program: &Program, preferred: Option<NonZeroUsize>) -> usize {
    let most = preferred.map_or(MAX_RAYS_PER_TASK, |batch| batch.get().min(MAX_RAYS_PER_LARGE_TASK));
    let placements = program.prototypes().first().map_or(1, |group| group.placements);
    let leaves = program.leaves().len().max(placements as usize).max(1);
    (MAX_PAIRS_PER_TASK / leaves).clamp(1, most)
}

/// The options of a run.
#[derive(Clone, Debug, Default)]
pub struct TraceOptions {
    /// The query for every ray.
    pub query: Query<'static>,
    /// The number of threads; by default that of [`thread_count`].
    pub threads: Option<NonZeroUsize>,
    /// Adds the column `occurrence` to the table: see [`HitSchema::with_occurrences`].
    pub occurrences: bool,
    /// Cancels the run; the unfinished table is removed.
    pub cancel: Cancel,
    /// Traces only the rays in the range of this part, and writes its description; the total is that of the rays in the file.
    pub part: Option<Part>,
}

/// A summary of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct TraceSummary {
    /// The number of rays.
    pub rays: u64,
    /// The number of crossings.
    pub crossings: u64,
}

/// Traces all rays of a reader and writes the table of their crossings.
///
/// The columns are those of [`HitSchema`]. The extension of `hits` selects the format, `.csv`, `.npy` or (with
/// the feature `parquet`) `.parquet`; `-` is CSV on standard output. The file appears when it is complete,
/// and not at all after an error or a cancellation. Rows are in the order of the rays, and the bytes written do
/// not depend on the number of threads. `progress` receives the position of the reader after each chunk.
///
/// # Errors
///
/// [`AnalysisError`]: a file of rays that is invalid or cannot be read, a table that cannot be written, a
/// cancelled run.
pub fn trace_rays<E: Evaluator>(
    compiled: &Compiled,
    evaluator: &E,
    rays: RayReader,
    hits: &Path,
    options: &TraceOptions,
    mut progress: impl FnMut(Progress),
) -> Result<TraceSummary, AnalysisError> {
    let table = HitSchema::new(compiled)?;
    let table = if options.occurrences { table.with_occurrences()? } else { table };
    let mut writer = TableWriter::create(hits, table.schema())?;
    let mut traced = 0;
    let mut rays = match &options.part {
        Some(part) => rays.range(part.range.clone())?,
        None => rays,
    };
    drive(
        thread_count(options.threads),
        &options.cancel,
        Tasks {
            reader: &mut rays,
            has_failed: false,
            size: rays_per_task(evaluator.program(), evaluator.preferred_batch()),
        },
        || evaluator.scratch(),
        |scratch, task| answer(&table, evaluator, &options.query, scratch, task?),
        |answered: Result<Answered, AnalysisError>| {
            let answered = answered?;
            writer.write(&answered.rows)?;
            traced += answered.rays;
            progress(answered.progress);
            Ok(())
        },
    )
    .map_err(|stopped: Stopped<AnalysisError>| match stopped {
        Stopped::Cancelled => Cancelled.into(),
        Stopped::Failed(error) => error,
    })?;
    let crossings = match &options.part {
        Some(part) => writer.finish_part(&whole(part, &mut rays)?)?,
        None => writer.finish()?,
    };
    Ok(TraceSummary { rays: traced, crossings })
}

/// The part with the number of rays in the file as total.
fn whole(part: &Part, rays: &mut RayReader) -> Result<Part, AnalysisError> {
    let total = rays.count()?;
    if part.range.end > total {
        let problem = format!("the range ends at {}", part.range.end);
        let message = Message::new(problem, format!("the file has {total} rays"));
        return Err(TableError::Parts(message).into());
    }
    let mut whole = part.clone();
    whole.total = total;
    Ok(whole)
}

/// Rays to trace, and the position of the reader after them.
struct Task {
    rays: RayChunk,
    progress: Progress,
}

/// The rows of a task.
struct Answered {
    rows: Chunk,
    rays: u64,
    progress: Progress,
}

fn answer<E: Evaluator>(
    table: &HitSchema,
    evaluator: &E,
    query: &Query<'_>,
    scratch: &mut E::Scratch,
    task: Task,
) -> Result<Answered, AnalysisError> {
    let rays = Rays::from_columns(&task.rays.origin, &task.rays.direction);
    let first = task.rays.first;
    evaluator.program().check_rays(rays).map_err(|bad| BadRay { ray: first as usize + bad.ray, ..bad })?;
    let mut rows = table.rows(evaluator.program(), rays, first);
    evaluator.crossings(rays, query, scratch, &mut rows);
    Ok(Answered { rows: rows.finish()?, rays: rays.len() as u64, progress: task.progress })
}

/// The rays of a file, task by task. The iteration ends after an error.
struct Tasks<'r> {
    reader: &'r mut RayReader,
    has_failed: bool,
    size: usize,
}

impl Iterator for Tasks<'_> {
    type Item = Result<Task, AnalysisError>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut rays = RayChunk::default();
        if self.has_failed {
            return None;
        }
        match self.reader.read(&mut rays, self.size) {
            Ok(0) => None,
            Ok(_) => Some(Ok(Task { rays, progress: self.reader.progress() })),
            Err(error) => {
                self.has_failed = true;
                Some(Err(error.into()))
            }
        }
    }
}
