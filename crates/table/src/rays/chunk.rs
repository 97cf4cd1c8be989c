//! Chunk of rays, stored by column (structure of arrays).

use super::columns::{Present, Row};

/// A chunk of consecutive rays of a file, stored by column. [`RayReader::read`](crate::RayReader::read) reuses its memory.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RayChunk {
    /// The index of the first ray, from 0.
    pub first: u64,
    /// x, y and z of the origins, in document units.
    pub origin: [Vec<f64>; 3],
    /// x, y and z of the directions: finite, nonzero, of any length.
    pub direction: [Vec<f64>; 3],
    /// Vacuum wavelengths in nanometres, greater than 0; empty if the file has none.
    pub wavelength_nm: Vec<f64>,
    /// Powers, nonnegative; empty if the file has none.
    pub power: Vec<f64>,
}

impl RayChunk {
    /// The number of rays.
    pub fn len(&self) -> usize {
        self.origin[0].len()
    }

    /// True if there are no rays.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Removes all rays and keeps the memory.
    pub fn clear(&mut self) {
        self.columns_mut().for_each(Vec::clear);
    }

    /// Appends the present columns of a row.
    pub(super) fn push(&mut self, row: &Row, present: &Present) {
        let columns = self.columns_mut().zip(row).zip(present).filter(|(_, is_present)| **is_present);
        columns.for_each(|((column, &x), _)| column.push(x));
    }

    fn columns_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        let RayChunk { origin, direction, wavelength_nm, power, .. } = self;
        origin.iter_mut().chain(direction).chain([wavelength_nm, power])
    }
}
