//! The number of rays of the next round for a region, from the rounds before it.
//!
//! Rays that are added until their own interval is short enough stop early where the interval happens to be too short: the values
//! are then biased, and the intervals contain the truth too seldom (F. J. Anscombe, "Sequential estimation", *Journal of the Royal
//! Statistical Society* B 15, 1953, 1-29). So the size of a round depends on earlier rounds alone, and the result is that of the last
//! round alone, which is independent of them: two stages, a pilot and a sample of the size that the pilot demands (C. Stein, "A
//! two-sample test for a linear hypothesis whose power is independent of the variance", *Annals of Mathematical Statistics* 16, 1945,
//! 243-258; F. J. Hickernell, L. Jiang, Y. Liu and A. B. Owen, "Guaranteed conservative fixed width confidence intervals via Monte
//! Carlo sampling", *Monte Carlo and Quasi-Monte Carlo Methods 2012*, Springer, 2013, 105-128).
//!
//! The size has a margin ([`aim`]). A round that misses the precision all the same becomes the pilot of another one. If a share p
//! of the rounds misses it, an interval at the level 1 - a contains the truth with a probability of at least 1 - a (1 + p + p^2 ...):
//! each of the rounds is wrong with a probability of a, whatever the rounds before it were.

/// Rounds are planned for at most this part of the requested half width, since the half width that a pilot predicts is uncertain.
const AIM: f64 = 0.9;

/// The uncertainty of half widths, relative to them, in units of the relative deviation of the volume: the fewer cells contribute, the
/// larger are both. Measured for a small ball beside a large one: 1.7; times 2.3 deviations, which one of a hundred exceeds, times the
/// root of two, for the pilot and the round itself.
const UNCERTAINTY: f64 = 5.5;

/// The part of the requested half width for which a round is planned; both are relative to the volume.
pub(super) fn aim(precision: f64, quantile: f64) -> f64 {
    precision * AIM.min(1.0 / (1.0 + UNCERTAINTY * precision / quantile))
}

/// The order of convergence for a smooth boundary: half widths decrease as this power of the number of rays.
const ORDER: f64 = 0.75;

/// The order for independent rays, which is that of details smaller than the distance of the rays.
const LEAST_ORDER: f64 = 0.5;

/// A round is reported only if it has at most this many times as many cells along an edge as its pilot, about 8 times the rays: the
/// order of convergence is not known well enough for more. So pilots cost about an eighth of the rays.
const FAR: f64 = 2.83;

/// A pilot has at most this many times as many cells along an edge as the round before it.
const PILOT_FAR: f64 = 8.0;

/// The last round of a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Traced {
    /// The number of cells per area, summed over the axes.
    pub density: f64,
    /// The half width of the volume, relative to the volume; infinite if the volume is 0.
    pub half_width: f64,
}

/// The size of the next round of a region, from the rounds before it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    last: Option<Traced>,
    order: f64,
}

impl Default for Plan {
    fn default() -> Self {
        Plan { last: None, order: ORDER }
    }
}

/// The next round of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct NextRound {
    /// The number of cells along an edge.
    pub across: u64,
    /// False for a pilot, which is not reported, however short its interval.
    pub is_final: bool,
}

/// The limits of the next round: numbers of cells along an edge.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
    pub least: u64,
    pub most: u64,
}

impl Plan {
    /// Adds a round.
    pub fn add(&mut self, now: Traced) {
        if let Some(last) = self.last {
            let ratio = now.density / last.density;
            let is_known =
                [last.half_width, now.half_width].iter().all(|half| half.is_finite() && *half > 0.0);
            if is_known && ratio >= 2.0 {
                let order = libm::log(last.half_width / now.half_width) / libm::log(ratio);
                self.order = order.clamp(LEAST_ORDER, ORDER);
            }
        }
        self.last = Some(now);
    }

    /// True if a ray of the last round crossed the region.
    pub fn is_met(&self) -> bool {
        self.last.is_some_and(|last| last.half_width.is_finite())
    }

    /// The number of cells along an edge with the density of the last round, in a box whose density is `unit` for one cell.
    pub fn had(&self, unit: f64) -> f64 {
        self.last.map_or(0.0, |last| (last.density / unit).sqrt())
    }

    /// The number of cells along an edge that a half width, relative to the volume, needs; infinite if unknown.
    pub fn needed(&self, unit: f64, aim: f64) -> f64 {
        let Some(last) = self.last.filter(|last| last.half_width.is_finite()) else {
            return f64::INFINITY;
        };
        self.had(unit) * libm::pow(last.half_width / aim, 0.5 / self.order)
    }

    /// True if a round of so many cells along an edge is expected to reach the half width, and the last round knows that well enough.
    pub fn is_enough(&self, unit: f64, aim: f64, across: f64) -> bool {
        let needed = self.needed(unit, aim);
        needed <= across && (needed <= FAR * self.had(unit) || FAR * needed <= across)
    }

    /// The next round of this region alone; `None` if the limit does not permit one as large as the last.
    pub fn next(&self, unit: f64, aim: f64, limits: Limits) -> Option<NextRound> {
        next_together(&[*self], unit, aim, limits)
    }
}

/// The next round of some regions, in one box; `None` if the limit does not permit one as large as the last. The round is also final
/// for each region for which it is large enough ([`Plan::is_enough`]).
pub(super) fn next_together(
    plans: &[Plan],
    unit: f64,
    aim: f64,
    Limits { least, most }: Limits,
) -> Option<NextRound> {
    let had = plans.iter().map(|plan| plan.had(unit)).fold(0.0, f64::max);
    // rounded, so that a round of the same size is possible
    if most == 0 || (most as f64) < had.floor() {
        return None;
    }
    // a region that no ray has crossed gets about twice as many rays
    let needed = |plan: &Plan| if plan.is_met() { plan.needed(unit, aim) } else { had * 99.0 / 70.0 };
    let needed = plans.iter().map(needed).fold(0.0, f64::max);
    // the conversion saturates
    let target = (needed.ceil() as u64).max(least).min(most);
    let pilot = ((target as f64 / FAR).min(PILOT_FAR * had).ceil() as u64).max(least);
    let is_last = target == most && (target as f64 <= FAR * had || pilot >= most);
    if is_last || plans.iter().all(|plan| plan.is_enough(unit, aim, target as f64)) {
        return Some(NextRound { across: target, is_final: true });
    }
    let is_near = target as f64 <= FAR * had;
    Some(NextRound { across: if is_near { target } else { pilot.min(most) }, is_final: false })
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits { least: 48, most: 10_000 };

    fn plan(rounds: &[(f64, f64)]) -> Plan {
        let mut plan = Plan::default();
        rounds.iter().for_each(|&(density, half_width)| plan.add(Traced { density, half_width }));
        plan
    }

    /// In a box of density 1 for one cell, for a half width of 0.9.
    fn next(rounds: &[(f64, f64)], limits: Limits) -> Option<(u64, bool)> {
        plan(rounds).next(1.0, AIM, limits).map(|next| (next.across, next.is_final))
    }

    #[test]
    fn sizes_of_rounds() {
        let first = 48.0 * 48.0;
        // a round of the same size is final, however short the interval of the first
        assert_eq!(next(&[(first, 1e-6)], LIMITS), Some((48, true)));
        assert_eq!(next(&[(first, 0.0)], LIMITS), Some((48, true)));
        // 2.2^(2/3) times as many cells along an edge for half the half width, with the margin
        assert_eq!(next(&[(first, 2.0)], LIMITS), Some((82, true)));
        // a pilot where the first round cannot know
        assert_eq!(next(&[(first, 100.0)], LIMITS), Some((384, false)));
        assert_eq!(next(&[(1.0, f64::INFINITY)], LIMITS), Some((48, false)));
        // independent rays converge more slowly
        let order = plan(&[(first, 8.0), (4.0 * first, 4.0)]).order;
        assert!((order - 0.5).abs() < 1e-12, "{order}");
    }

    #[test]
    fn limits_of_rounds() {
        let first = 48.0 * 48.0;
        let limited = |most: u64| Limits { most, ..LIMITS };
        // a smaller round would be worse
        assert_eq!(next(&[(first, 2.0)], limited(47)), None);
        assert_eq!(next(&[(first, 1e3)], limited(100)), Some((100, true)));
        // a limit far from the first round gets a pilot: the rays may suffice
        assert_eq!(next(&[(first, 1e3)], limited(1_000)), Some((354, false)));
        assert_eq!(next(&[(354.0 * 354.0, 1e3)], limited(935)), Some((935, true)));
    }
}
