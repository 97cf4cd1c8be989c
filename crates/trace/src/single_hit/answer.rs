//! The next change after a time: of a leaf, and of nodes built from leaves.

use std::fmt;

/// Next change of a leaf after a time t.
///
/// The side at t is that on (t, t + 0), just after t. It is counted from the roots passed, never found by
/// evaluating a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Next {
    /// Outside until this finite time, then inside.
    Enter(f64),
    /// Inside until this finite time, then outside.
    Exit(f64),
    /// Outside forever.
    Outside,
    /// Inside forever: an exit at +inf.
    Inside,
}

impl Next {
    /// The next change of a solid whose side and next boundary crossing, if any, are given.
    pub fn new(inside: bool, crossing: Option<f64>) -> Next {
        match (inside, crossing) {
            (false, Some(t)) => Next::Enter(t),
            (true, Some(t)) => Next::Exit(t),
            (false, None) => Next::Outside,
            (true, None) => Next::Inside,
        }
    }

    /// True if the ray is inside until the crossing.
    pub fn is_inside(self) -> bool {
        matches!(self, Next::Exit(_) | Next::Inside)
    }

    /// The time of the crossing; +inf if there is none.
    pub fn time(self) -> f64 {
        match self {
            Next::Enter(t) | Next::Exit(t) => t,
            Next::Outside | Next::Inside => f64::INFINITY,
        }
    }

    /// The next change of the complement.
    pub fn complement(self) -> Next {
        match self {
            Next::Enter(t) => Next::Exit(t),
            Next::Exit(t) => Next::Enter(t),
            Next::Outside => Next::Inside,
            Next::Inside => Next::Outside,
        }
    }
}

impl fmt::Display for Next {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Next::Enter(t) => write!(f, "entered at {t}"),
            Next::Exit(t) => write!(f, "left at {t}"),
            Next::Outside => f.write_str("outside for good"),
            Next::Inside => f.write_str("inside for good"),
        }
    }
}

/// Next change of a node whose values are small integers; compare [`Next`].
///
/// The value of a solid is 0 or 1; that of a partial sum of a k-of-n gate is the number of operands that
/// contain the ray; that of a model is the number of the owner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueStep {
    /// The value until `t`.
    pub before: u32,
    /// The value just after `t`; the same as `before` if it never changes again.
    pub after: u32,
    /// The time of the next change; +inf if there is none.
    pub t: f64,
}

impl ValueStep {
    /// A value that never changes.
    pub fn constant(value: u32) -> ValueStep {
        ValueStep { before: value, after: value, t: f64::INFINITY }
    }

    /// The value, if it never changes again.
    pub fn resolved(self) -> Option<u32> {
        (self.t == f64::INFINITY).then_some(self.before)
    }

    /// The same change of a function of the value.
    pub fn map(self, value: impl Fn(u32) -> u32) -> ValueStep {
        ValueStep { before: value(self.before), after: value(self.after), t: self.t }
    }

    /// Converts to the change of a solid: inside where the value is not 0.
    pub fn next(self) -> Next {
        Next::new(self.before != 0, self.t.is_finite().then_some(self.t))
    }
}

impl From<Next> for ValueStep {
    fn from(next: Next) -> ValueStep {
        let before = u32::from(next.is_inside());
        let t = next.time();
        ValueStep { before, after: if t.is_finite() { 1 - before } else { before }, t }
    }
}
