//! Rows of copies along axes.

use crate::gdml::units::Quantity;
use crate::gdml::xml::Element;

/// Axis of a row of copies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    X,
    Y,
    Z,
    Rho,
    Phi,
}

/// The axes with their names in divisions and in the directions of replicas.
pub(super) const AXES: [(&str, &str, Axis); 5] = [
    ("kXAxis", "x", Axis::X),
    ("kYAxis", "y", Axis::Y),
    ("kZAxis", "z", Axis::Z),
    ("kRho", "rho", Axis::Rho),
    ("kPhi", "phi", Axis::Phi),
];

/// A row of copies: width of each, and offset of the first, in millimetres, or in degrees along phi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Row {
    pub axis: Axis,
    pub count: usize,
    pub width: f64,
    pub offset: f64,
}

/// The axis of a name such as `kXAxis`.
pub(super) fn axis(name: &str) -> Option<Axis> {
    AXES.iter().find(|row| row.0 == name).map(|row| row.2)
}

/// The axis of `<direction x="1"/>`.
pub(super) fn direction(element: &Element) -> Option<Axis> {
    let is_set = |name: &str| element.text(name).trim().parse::<f64>().is_ok_and(|value| value == 1.0);
    AXES.iter().find(|row| is_set(row.1)).map(|row| row.2)
}

/// The physical quantity of a length or angle along an axis.
pub fn measure(is_angle: bool) -> Quantity {
    if is_angle { Quantity::Angle } else { Quantity::Length }
}
