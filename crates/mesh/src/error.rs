//! Errors of mesh construction.

use rayweave_math::Vec3;

/// Error: vertices and triangles do not form a mesh, or a mesh does not bound a solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A coordinate is NaN, infinite or beyond [`crate::Mesh::MAX_COORDINATE`].
    #[error(
        "vertex {index} is ({:?}, {:?}, {:?}): coordinates must be finite and at most 1e60 in magnitude. Check the unit.",
        .point.x, .point.y, .point.z
    )]
    Coordinate {
        /// The index of the vertex, from 0.
        index: usize,
        /// Its coordinates.
        point: Vec3,
    },
    /// A triangle has a vertex index out of range.
    #[error(
        "triangle {triangle} refers to vertex {vertex}: the mesh has {count} vertices, numbered from 0. \
         Check whether the indices start at 1."
    )]
    Index {
        /// The index of the triangle, from 0.
        triangle: usize,
        /// The vertex index.
        vertex: u64,
        /// The number of vertices.
        count: usize,
    },
    /// The number of vertices or triangles exceeds the limit.
    #[error("the mesh has {count} {what}: the limit is {limit}. Use a coarser mesh.")]
    TooMany {
        /// "vertices" or "triangles".
        what: &'static str,
        /// The number.
        count: u64,
        /// The limit.
        limit: u64,
    },
    /// No triangle has three different corners.
    #[error("the mesh has no triangles: a solid needs at least four. Check that the file is complete.")]
    Empty,
    /// The mesh is closed, but its volume is 0 within rounding.
    #[error("the mesh encloses no volume: all of its shells are flat. Give a surface some thickness.")]
    Flat,
    /// Some edges have an odd number of triangles, so that inside and outside are not defined.
    #[error(
        "the mesh is not closed: {edges} edges belong to an odd number of triangles, the first at ({:?}, {:?}, {:?}). \
         Repair it.", .at.x, .at.y, .at.z
    )]
    Open {
        /// The number of such edges.
        edges: usize,
        /// The midpoint of the first one.
        at: Vec3,
    },
}

impl MeshError {
    /// The message in two parts: the problem with its reason, and the suggestion.
    pub fn parts(&self) -> (String, String) {
        let mut text = self.to_string();
        // every message ends with a suggestion of one sentence
        let suggestion = text.rfind(". ").map(|end| text.split_off(end + 1)).unwrap_or_default();
        (text.trim_end_matches('.').to_owned(), suggestion.trim_start().to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_have_two_parts() {
        let open = MeshError::Open { edges: 2, at: Vec3::new(0.5, 1.0, 0.0) };
        for error in [MeshError::Empty, MeshError::Flat, open] {
            let (problem, suggestion) = error.parts();
            assert_eq!(format!("{problem}. {suggestion}"), error.to_string());
            assert!(problem.starts_with("the mesh ") && suggestion.split(' ').count() > 1, "{error}");
        }
    }
}
