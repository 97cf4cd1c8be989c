//! What is next after a time: the answer of a leaf, and of everything built from leaves.

use std::fmt;

/// What a leaf answers to "what is next after t?".
///
/// "At t" means just after it: on (t, t + 0). The side there is counted from the roots that have passed,
/// never found by looking at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Next {
    /// Outside until this finite time, then inside.
    Enter(f64),
    /// Inside until this finite time, then outside.
    Exit(f64),
    /// Outside for ever.
    Outside,
    /// Inside for ever: an exit at +inf.
    Inside,
}

impl Next {
    /// The answer of something that is inside or not and crosses its boundary next at the time given, if
    /// ever.
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

    /// The answer of the complement.
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

/// What is next of a node: like [`Next`], for values that are small numbers.
///
/// The value of a solid is 0 or 1; that of a k-of-n gate's parts the number of operands that the ray is
/// inside of; that of a model the region that wins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The value until `t`.
    pub before: u32,
    /// The value just after `t`; the same as `before` if it never changes again.
    pub after: u32,
    /// The time of the next change; +inf if there is none.
    pub t: f64,
}

impl Step {
    /// The same value for ever.
    pub fn constant(value: u32) -> Step {
        Step { before: value, after: value, t: f64::INFINITY }
    }

    /// The value, if it never changes again.
    pub fn settled(self) -> Option<u32> {
        (self.t == f64::INFINITY).then_some(self.before)
    }

    /// The same about another value, a function of this one.
    pub fn map(self, value: impl Fn(u32) -> u32) -> Step {
        Step { before: value(self.before), after: value(self.after), t: self.t }
    }

    /// As the answer of a solid: inside where the value is not 0.
    pub fn next(self) -> Next {
        Next::new(self.before != 0, self.t.is_finite().then_some(self.t))
    }
}

impl From<Next> for Step {
    fn from(next: Next) -> Step {
        let before = u32::from(next.is_inside());
        let t = next.time();
        Step { before, after: if t.is_finite() { 1 - before } else { before }, t }
    }
}
