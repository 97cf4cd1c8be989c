//! Daughters whose volumes are not resolved yet.

use super::row::Row;
use crate::gdml::problem::Place;
use crate::gdml::solids::Shape;

/// A daughter whose volume is not resolved yet.
pub struct Pending {
    pub mother: usize,
    pub daughter: usize,
    pub name: String,
    pub place: Place,
    pub copies: Copies,
}

/// Kind of copies of a daughter, expanded when its volume is resolved.
pub enum Copies {
    /// Ordinary placements, already in the graph.
    Placed,
    Replicas(Row),
    Divisions(Row),
    /// Parameterised copies, each with its own dimensions.
    Shapes(Vec<Option<Shape>>),
}
