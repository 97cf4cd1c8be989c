//! Meshes from files, with their objects.

use rayweave_mesh::Mesh;
use std::ops::Range;

/// The contents of a mesh file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LoadedMesh {
    /// Vertices and triangles, in the order of the file.
    pub mesh: Mesh,
    /// Descriptions of contents that were ignored or interpreted leniently.
    pub warnings: Vec<String>,
    /// The unit of length, if the format has one: "mm", "m", "inch" and so on.
    pub unit: Option<String>,
    /// The objects of the file, in its order; empty if the file does not distinguish objects.
    pub objects: Vec<MeshObject>,
}

/// An object of a mesh file: a range of its triangles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MeshObject {
    /// The name; may be empty, and names may repeat.
    pub name: String,
    /// The indices of its triangles in the mesh.
    pub triangles: Range<usize>,
}

impl LoadedMesh {
    /// The mesh of one object, without unused vertices.
    pub fn object_mesh(&self, object: &MeshObject) -> Mesh {
        self.mesh.portion(object.triangles.clone())
    }
}
