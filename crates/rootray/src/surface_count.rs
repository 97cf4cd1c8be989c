//! Surface count: the number of solids that contain a trajectory, as a step function of time.

use crate::RootRay;

/// The number of solids that a trajectory is inside of: a step function of time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceCount {
    /// The number as t -> -inf.
    pub start: usize,
    /// Every distinct time at which some solid is entered or left, increasing, with the number just after it.
    /// The number may stay the same, if as many solids are entered as left.
    pub steps: Vec<(f64, usize)>,
}

/// The number of root-rays that are inside, at every distinct time of any of them. O(n log n) for n roots in all.
pub fn surface_count<'a, S: 'a>(rays: impl IntoIterator<Item = &'a RootRay<S>>) -> SurfaceCount {
    let (mut start, mut changes) = (0_usize, Vec::new());
    for ray in rays {
        start += usize::from(ray.start().is_inside());
        changes.extend(ray.crossings().map(|(root, side)| (root.t, side.is_inside())));
    }
    changes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut count = start;
    let steps = changes.chunk_by(|a, b| a.0 == b.0).map(|tied| {
        let entered = tied.iter().filter(|change| change.1).count();
        // entered first: the sum without it might be less than the number left
        count = count + entered - (tied.len() - entered);
        (tied[0].0, count)
    });
    let steps = steps.collect();
    SurfaceCount { start, steps }
}
