//! Why a mesh cannot be made; messages read "problem (why) suggestion?".

use rayweave_math::Vec3;

/// Why points and triangles are no mesh, or a mesh is no solid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A coordinate is NaN, infinite or beyond [`crate::Mesh::MOST`].
    #[error("vertex {index} is ({:?}, {:?}, {:?}) (coordinates must be finite and at most 1e60) is the unit right?", .point.x, .point.y, .point.z)]
    Coordinate {
        /// The vertex, from 0.
        index: usize,
        /// What it is.
        point: Vec3,
    },
    /// A triangle names a vertex that there is not.
    #[error(
        "triangle {triangle} names vertex {vertex} (there are {count}, counted from 0) are indices counted from 1?"
    )]
    Index {
        /// The triangle, from 0.
        triangle: usize,
        /// The vertex named.
        vertex: u64,
        /// The number of vertices.
        count: usize,
    },
    /// More vertices or triangles than can be held.
    #[error("{count} {what} (at most {limit} are held) can the mesh be made coarser?")]
    TooMany {
        /// "vertices" or "triangles".
        what: &'static str,
        /// How many there are.
        count: u64,
        /// How many there may be.
        limit: u64,
    },
    /// No triangle with three different corners.
    #[error("the mesh has no triangle (a solid needs four at least) is the file complete?")]
    Empty,
    /// Closed, but all of it is folded flat.
    #[error("the mesh encloses nothing (its volume is 0 but for rounding) is it a surface?")]
    Flat,
    /// Edges with an odd number of triangles: nothing is inside.
    #[error(
        "the mesh is not closed: {edges} edges belong to an odd number of triangles, the first at ({:?}, {:?}, {:?}) \
         (inside and outside are not told apart) diagnose and repair it?", .at.x, .at.y, .at.z
    )]
    Open {
        /// How many such edges there are.
        edges: usize,
        /// The middle of one of them.
        at: Vec3,
    },
}
