//! Triangle meshes: diagnosis, repair, and the solid within a closed mesh with watertight ray intersection.
//!
//! - [`Mesh`]: vertices and triangles as they were given, with indices in range and finite coordinates.
//! - [`Mesh::diagnose`]: defects with their number and location; [`Mesh::repaired`]: safe repairs.
//! - [`Polyhedron`]: the solid within a closed mesh: crossings along lines, point containment, nearest triangle.
//!
//! The crate `rayweave-mesh-io` reads and writes mesh files (STL, OBJ, PLY, OFF, 3MF, glTF).
//!
//! # Inside and outside
//!
//! A point is inside if a ray from it to infinity crosses the mesh an odd number of times (even-odd rule). The orientation of
//! triangles does not matter: a shell within a shell is a cavity, and the overlap of two shells is outside.
//! [`Mesh::diagnose`] reports where this is probably not intended.

mod diagnosis;
mod error;
mod line;
mod mesh;
mod polyhedron;
mod repair;
mod shift;
mod topology;
mod tree;
mod triangle;
mod triangulate;

pub use diagnosis::{Component, Diagnosis, Findings, Hole, Intersection, PairBudget};
pub use error::MeshError;
pub use line::{Line, MeshCrossing, Perturbation};
pub use mesh::{Mesh, VertexWelder};
pub use polyhedron::{Nearest, Polyhedron};
pub use repair::{Repair, RepairOptions};
pub use triangulate::{EarBudget, triangulate_polygon};
