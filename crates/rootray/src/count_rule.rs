//! Symmetric boolean functions: k-of-n and parity of the number of operands that are inside.

/// A boolean function that depends only on how many of its operands are inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CountRule {
    /// At least k operands are inside (k-of-n): 1 is the union, n the intersection.
    AtLeast(usize),
    /// An odd number of operands is inside: symmetric difference.
    Odd,
}

impl CountRule {
    /// The value where `count` operands are inside.
    pub fn is_inside(self, count: usize) -> bool {
        match self {
            Self::AtLeast(threshold) => count >= threshold,
            Self::Odd => count % 2 == 1,
        }
    }
}
