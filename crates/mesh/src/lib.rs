//! Closed triangle meshes.
//!
//! - [`Mesh`]: points and triangles as they were given, each index in range and each number finite.
//! - [`Mesh::diagnose`]: what is wrong with it, where and how often; [`Mesh::repaired`]: what can safely be mended.
//! - [`Polyhedron`]: the solid within a closed mesh: crossings along lines, points inside, the nearest triangle.
//! - [`files`]: STL, OBJ, PLY, OFF, 3MF and glTF, read and written.
//!
//! # What is inside
//!
//! A point is inside if a line from it to infinity crosses the mesh an odd number of times. So the direction in which a
//! triangle turns says nothing about what is solid: shells within shells are hollows, and where two shells overlap there
//! is none of either. [`Mesh::diagnose`] tells where that may not be what was meant.

pub mod files;

mod diagnosis;
mod error;
mod hierarchy;
mod line;
mod mesh;
mod polygon;
mod polyhedron;
mod repair;
mod topology;
mod triangle;

pub use diagnosis::{Component, Diagnosis, Findings, Hole, Intersection};
pub use error::MeshError;
pub use line::{Aside, Crossing, Line};
pub use mesh::Mesh;
pub use polygon::triangles as polygon_triangles;
pub use polyhedron::{Nearest, Polyhedron};
pub use repair::{Repair, RepairOptions};
