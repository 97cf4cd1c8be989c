//! Boolean operations.

/// Boolean operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Operation {
    Union,
    Difference,
    Intersection,
}
