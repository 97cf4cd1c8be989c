//! Welding of lists: maximal runs of neighbours, and the weld of root-rays at the end of a computation.

use std::iter::Peekable;
use std::ops::Range;

use crate::RootRay;

/// The maximal runs of welded neighbours, as ranges of indices that cover `items` in order; an item that is welded to neither
/// neighbour is a run of its own. `welded(a, b)` is called once for each pair of neighbours, `a` before `b`.
///
/// The caller interprets a run. For crossings, compare the state before its first member with that after its last: report
/// nothing if they are equal, else one crossing at the time of the last member.
pub fn weld_runs<T>(
    items: &[T],
    mut welded: impl FnMut(&T, &T) -> bool,
) -> impl Iterator<Item = Range<usize>> {
    let mut start = 0;
    std::iter::from_fn(move || {
        let rest = items.get(start..).filter(|rest| !rest.is_empty())?;
        let run = start..start + run_length(rest, &mut welded);
        start = run.end;
        Some(run)
    })
}

/// The length of the maximal run that `items` begins with; 0 for no items.
pub(crate) fn run_length<T>(items: &[T], welded: &mut impl FnMut(&T, &T) -> bool) -> usize {
    let joints = items.windows(2).take_while(|pair| welded(&pair[0], &pair[1])).count();
    items.len().min(joints + 1)
}

/// Streaming form of [`weld_runs`]: replaces the contents of `run` by the next maximal run and returns
/// whether there is one. Reads at most one item beyond the run, and allocates only if `run` has to grow.
pub fn next_run<I: Iterator>(
    items: &mut Peekable<I>,
    run: &mut Vec<I::Item>,
    mut welded: impl FnMut(&I::Item, &I::Item) -> bool,
) -> bool {
    run.clear();
    run.extend(items.next());
    while let Some(last) = run.last()
        && let Some(next) = items.next_if(|next| welded(last, next))
    {
        run.push(next);
    }
    !run.is_empty()
}

impl<S: Clone> RootRay<S> {
    /// Drops the pieces, inside or outside, that are shorter than `min_sep(t1, t2)`, for example
    /// [`min_sep`](crate::min_sep) or `|_, _| 1e-6`.
    ///
    /// Neighbours with `t2 - t1 < min_sep(t1, t2)` are welded. A maximal run of welded neighbours becomes nothing if the sides
    /// before and after it are equal, else its last member. With [`min_sep`](crate::min_sep) or a constant, welding
    /// again changes nothing; a function that grows faster than the distance of its times can weld the result again.
    #[must_use]
    pub fn weld(&self, min_sep: impl Fn(f64, f64) -> f64) -> Self {
        let roots = self.roots();
        let runs = weld_runs(roots, |a, b| b.t - a.t < min_sep(a.t, b.t));
        let survivors = runs.filter(|run| run.len() % 2 == 1).map(|run| roots[run.end - 1].clone());
        Self::from_ordered(self.start(), survivors.collect())
    }
}
