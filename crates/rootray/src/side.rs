//! The side of a solid that a point of the trajectory is on.

use std::fmt;
use std::ops::Not;

/// The side of a solid that a point is on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Side {
    /// In the exterior of the solid.
    #[default]
    Outside,
    /// In the interior of the solid.
    Inside,
}

impl Side {
    /// `Inside` if `inside` is true, else `Outside`.
    pub const fn from_inside(inside: bool) -> Self {
        if inside { Self::Inside } else { Self::Outside }
    }

    /// Whether this is `Inside`.
    pub const fn is_inside(self) -> bool {
        matches!(self, Self::Inside)
    }

    /// The side after `crossings` more crossings of the boundary: only their parity counts.
    #[must_use]
    pub const fn after(self, crossings: usize) -> Self {
        Self::from_inside(self.is_inside() != (crossings % 2 == 1))
    }
}

impl Not for Side {
    type Output = Self;

    fn not(self) -> Self {
        self.after(1)
    }
}

impl fmt::Display for Side {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.is_inside() { "inside" } else { "outside" })
    }
}
