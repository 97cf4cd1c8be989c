//! Sign changes of a function of time: the result of every root solver.

/// The sign of a function of time at its start and the finite times at which the sign changes.
///
/// Times are strictly increasing and finite; after each the sign is the other one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossings<const N: usize> {
    starts_negative: bool,
    count: u8,
    times: [f64; N],
}

impl<const N: usize> Crossings<N> {
    /// A function that never changes sign.
    #[inline]
    pub fn constant(negative: bool) -> Self {
        Crossings { starts_negative: negative, count: 0, times: [0.0; N] }
    }

    /// Builds the list from the sign at -inf and the times of the sign changes in increasing order; times after the first `N`
    /// are ignored. Equal times cancel in pairs, -inf changes the sign at the start, and +inf or NaN ends the list.
    #[inline]
    pub fn new(starts_negative: bool, times: &[f64]) -> Self {
        let mut answer = Self::constant(starts_negative);
        for &t in times.iter().take(N) {
            answer.push(t);
        }
        answer
    }

    /// Appends a sign change at `t`, which must not lie before the last one.
    #[inline]
    fn push(&mut self, t: f64) {
        let count = usize::from(self.count);
        // adding 0 turns -0 into 0: times are compared by value and ordered by their bits
        let t = t + 0.0;
        if t == f64::NEG_INFINITY {
            self.starts_negative = !self.starts_negative;
        } else if count > 0 && self.times[count - 1] == t {
            self.count -= 1;
        } else if t.is_finite() {
            self.times[count] = t + 0.0;
            self.count += 1;
        }
    }

    /// True if the function is negative before the first sign change.
    #[inline]
    pub fn starts_negative(&self) -> bool {
        self.starts_negative
    }

    /// The times of the sign changes, strictly increasing.
    #[inline]
    pub fn times(&self) -> &[f64] {
        &self.times[..usize::from(self.count)]
    }

    /// True if the function is negative just after `t`.
    pub fn negative_after(&self, t: f64) -> bool {
        let passed = self.times().iter().filter(|&&root| root <= t).count();
        self.starts_negative ^ (passed % 2 == 1)
    }

    /// The sign changes of the negated function.
    #[inline]
    pub fn negated(mut self) -> Self {
        self.starts_negative = !self.starts_negative;
        self
    }

    /// All times shifted by `by`. Times that rounding makes equal cancel in pairs.
    pub fn shifted(&self, by: f64) -> Self {
        self.mapped(|t| t + by)
    }

    /// All times multiplied by a factor > 0.
    pub fn scaled(&self, factor: f64) -> Self {
        self.mapped(|t| t * factor)
    }

    fn mapped(&self, increasing: impl Fn(f64) -> f64) -> Self {
        let times = self.times.map(increasing);
        Crossings::new(self.starts_negative, &times[..usize::from(self.count)])
    }

    /// The same list with a capacity of `M >= N` times. A smaller `M`, which would lose times, does not compile.
    #[inline]
    pub fn widen<const M: usize>(&self) -> Crossings<M> {
        const { assert!(M >= N) };
        let mut times = [0.0; M];
        times[..N].copy_from_slice(&self.times);
        Crossings { starts_negative: self.starts_negative, count: self.count, times }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_times_cancel_and_infinite_ones_only_move_the_start() {
        let c = Crossings::<4>::new(false, &[f64::NEG_INFINITY, 1.0, 1.0, f64::INFINITY]);
        assert!(c.starts_negative());
        assert!(c.times().is_empty());
        let c = Crossings::<4>::new(true, &[1.0, 2.0, 2.0, 3.0]);
        assert_eq!(c.times(), [1.0, 3.0]);
        assert!(c.negative_after(0.0) && !c.negative_after(1.0) && c.negative_after(3.0));
        assert!(c.negated().negative_after(2.0));
    }
}
