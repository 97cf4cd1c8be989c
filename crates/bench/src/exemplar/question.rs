//! Evaluators as candidates: full lists and first hits, on one thread or many.

use crate::answer::{FirstTable, HitTable, ahead};
use crate::interleaved::{Candidate, Role};
use rayweave::model::drive::{Cancel, drive};
use rayweave::model::{FirstHits, HitArrayRows, Rays};
use rayweave::{AnyEvaluator, Evaluator, Window};
use std::convert::Infallible;
use std::iter::repeat_with;
use std::num::NonZeroUsize;

/// Rays per chunk of a thread.
pub const CHUNK: usize = 1 << 14;

/// All crossings, with their faces, as hit arrays of `rows` rows.
pub fn full<'a>(name: &str, evaluator: &'a AnyEvaluator, rays: Rays<'a>, rows: usize) -> Candidate<'a> {
    let mut table = HitTable::new(rows, rays.len());
    let mut scratch = evaluator.scratch();
    Candidate::here(name, Role::Ours, rays.len(), move || {
        let (mut times, mut faces) = table.rows();
        let mut rows = HitArrayRows { times: &mut times, faces: &mut faces };
        evaluator.hits(rays, Window::ALL, &mut scratch, &mut rows);
    })
}

/// The first crossing, with its face and its normal.
pub fn first<'a>(name: &str, evaluator: &'a AnyEvaluator, rays: Rays<'a>) -> Result<Candidate<'a>, String> {
    let mut table = FirstTable::new(rays.len());
    let (mut scratch, window) = (evaluator.scratch(), ahead().map_err(super::text)?);
    Ok(Candidate::here(name, Role::Ours, rays.len(), move || {
        evaluator.nearest(rays, window, &mut scratch, &mut table.hits());
    }))
}

/// [`full`] on several threads.
pub fn full_on_threads<'a>(
    name: &str,
    evaluator: &'a AnyEvaluator,
    rays: Rays<'a>,
    rows: usize,
    threads: usize,
) -> Candidate<'a> {
    into_table_on_threads(name, evaluator, rays, HitTable::new(rows, rays.len()), threads)
}

/// All crossings on several threads, with their faces if the table has buffers for them.
pub fn into_table_on_threads<'a>(
    name: &str,
    evaluator: &'a AnyEvaluator,
    rays: Rays<'a>,
    mut table: HitTable,
    threads: usize,
) -> Candidate<'a> {
    let run = move || {
        let (times, faces) = table.rows();
        let faces = columns(faces).into_iter().chain(repeat_with(Vec::new));
        let chunks = pieces(rays).zip(columns(times).into_iter().zip(faces));
        on_threads(evaluator, threads, chunks, |scratch, (rays, (mut times, mut faces))| {
            let mut rows = HitArrayRows { times: &mut times, faces: &mut faces };
            evaluator.hits(rays, Window::ALL, scratch, &mut rows);
        });
    };
    Candidate::here(name, Role::Ours, rays.len(), run).threads(threads)
}

/// [`first`] on several threads.
pub fn first_on_threads<'a>(
    name: &str,
    evaluator: &'a AnyEvaluator,
    rays: Rays<'a>,
    threads: usize,
) -> Result<Candidate<'a>, String> {
    let mut table = FirstTable::new(rays.len());
    let window = ahead().map_err(super::text)?;
    let run = move || {
        let chunks = pieces(rays).zip(hits(table.hits()));
        on_threads(evaluator, threads, chunks, |scratch, (rays, mut hits)| {
            evaluator.nearest(rays, window, scratch, &mut hits);
        });
    };
    Ok(Candidate::here(name, Role::Ours, rays.len(), run).threads(threads))
}

/// Processes all chunks, with a scratch memory per thread; returns the results in order.
pub fn on_threads<I: Send, O: Send>(
    evaluator: &AnyEvaluator,
    threads: usize,
    chunks: impl Iterator<Item = I> + Send,
    work: impl Fn(&mut <AnyEvaluator as Evaluator>::Scratch, I) -> O + Sync,
) -> Vec<O> {
    let threads = NonZeroUsize::new(threads).unwrap_or(NonZeroUsize::MIN);
    let mut made = Vec::new();
    let merge = |one| {
        made.push(one);
        Ok::<(), Infallible>(())
    };
    // cannot fail: the run is never cancelled
    let _ = drive(threads, &Cancel::new(), chunks, || evaluator.scratch(), work, merge);
    made
}

/// The rays, chunk by chunk.
pub fn pieces(rays: Rays<'_>) -> impl Iterator<Item = Rays<'_>> + Send {
    (0..rays.len()).step_by(CHUNK).map(move |at| {
        let part = |column: &'_ [f64]| at..(at + CHUNK).min(column.len());
        Rays {
            origins: rays.origins.map(|column| &column[part(column)]),
            directions: rays.directions.map(|column| &column[part(column)]),
        }
    })
}

/// Splits the rows of a table into the columns of its chunks.
fn columns<T>(rows: Vec<&mut [T]>) -> Vec<Vec<&mut [T]>> {
    let count = rows.first().map_or(0, |row| row.len().div_ceil(CHUNK));
    let mut chunks: Vec<Vec<&mut [T]>> = (0..count).map(|_| Vec::new()).collect();
    for row in rows {
        chunks.iter_mut().zip(row.chunks_mut(CHUNK)).for_each(|(chunk, part)| chunk.push(part));
    }
    chunks
}

/// Splits first hits into those of the chunks.
pub fn hits(hits: FirstHits<'_>) -> impl Iterator<Item = FirstHits<'_>> + Send {
    let FirstHits { t, face, placement, before, after, normal } = hits;
    let [x, y, z] = normal.unwrap_or_default();
    let times = t.chunks_mut(CHUNK).zip(face.chunks_mut(CHUNK));
    let ids = placement.chunks_mut(CHUNK).zip(before.chunks_mut(CHUNK)).zip(after.chunks_mut(CHUNK));
    let parts = times.zip(ids).zip(components([x, y, z]));
    parts.map(|(((t, face), ((placement, before), after)), normal)| FirstHits {
        t,
        face,
        placement,
        before,
        after,
        normal: Some(normal),
    })
}

/// Splits columns of components into those of the chunks.
pub fn components([x, y, z]: [&mut [f64]; 3]) -> impl Iterator<Item = [&mut [f64]; 3]> + Send {
    let parts = x.chunks_mut(CHUNK).zip(y.chunks_mut(CHUNK)).zip(z.chunks_mut(CHUNK));
    parts.map(|((x, y), z)| [x, y, z])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::answer::{first_lists, full_lists};
    use crate::batch::incoherent;
    use crate::exemplar::die;
    use crate::interleaved::counted;
    use std::sync::Arc;

    /// Candidates return the evaluator's results for any number of threads.
    #[test]
    fn chunks_put_together_are_the_whole() {
        let program = Arc::new(die::program().unwrap());
        let evaluator = AnyEvaluator::new(None, program).unwrap();
        let batch = incoherent(CHUNK + 100, 5);
        let rays = batch.rays();

        let mut table = FirstTable::new(rays.len());
        let window = ahead().unwrap();
        counted(&mut || {
            on_threads(&evaluator, 2, pieces(rays).zip(hits(table.hits())), |scratch, (rays, mut hits)| {
                evaluator.nearest(rays, window, scratch, &mut hits);
            });
        });
        assert_eq!(table.lists(), first_lists(&evaluator, rays).unwrap());

        let mut table = HitTable::new(die::ROWS, rays.len());
        let (times, faces) = table.rows();
        let chunks = pieces(rays).zip(columns(times).into_iter().zip(columns(faces)));
        on_threads(&evaluator, 2, chunks, |scratch, (rays, (mut times, mut faces))| {
            let mut rows = HitArrayRows { times: &mut times, faces: &mut faces };
            evaluator.hits(rays, Window::ALL, scratch, &mut rows);
        });
        assert_eq!(table.lists(), full_lists(&evaluator, rays));
    }
}
