//! Some rays of a file.

use super::{Has, Row};

/// Rays number `first`, `first + 1`, ... of a file, as structure of arrays: six vectors of equal length, made to be
/// filled again and again.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RayChunk {
    /// The number of the first ray, from 0.
    pub first: u64,
    /// x, y and z of the origins, in document units.
    pub origin: [Vec<f64>; 3],
    /// x, y and z of the directions: finite, not zero, of any length.
    pub direction: [Vec<f64>; 3],
    /// Vacuum wavelengths in nanometres, greater than 0; empty if the file has none.
    pub wavelength_nm: Vec<f64>,
    /// Powers, at least 0; empty if the file has none.
    pub power: Vec<f64>,
}

impl RayChunk {
    /// The number of rays.
    pub fn len(&self) -> usize {
        self.origin[0].len()
    }

    /// Whether there are no rays.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes all rays and keeps the memory.
    pub fn clear(&mut self) {
        self.columns_mut().for_each(Vec::clear);
    }

    /// Appends a row, of which only those columns count that the file has.
    pub(super) fn push(&mut self, row: &Row, has: &Has) {
        let columns = self.columns_mut().zip(row).zip(has).filter(|(_, has)| **has);
        columns.for_each(|((column, &x), _)| column.push(x));
    }

    fn columns_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let RayChunk { origin, direction, wavelength_nm, power, .. } = self;
        origin.iter_mut().chain(direction).chain([wavelength_nm, power])
    }
}
