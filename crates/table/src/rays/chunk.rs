//! Some rays of a file.

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

    pub(super) fn push(&mut self, ray: &[f64; 6]) {
        self.columns_mut().zip(ray).for_each(|(column, &x)| column.push(x));
    }

    fn columns_mut(&mut self) -> impl Iterator<Item = &mut Vec<f64>> {
        self.origin.iter_mut().chain(&mut self.direction)
    }
}
