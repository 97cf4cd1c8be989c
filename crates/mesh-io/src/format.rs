//! Mesh file formats and their file name extensions.

use std::path::Path;

/// A mesh file format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MeshFormat {
    /// STL, text or binary.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// PLY, the Stanford polygon format.
    Ply,
    /// OFF, Geomview's object file format.
    Off,
    /// 3MF, the 3D Manufacturing Format.
    ThreeMf,
    /// glTF 2.0 as JSON text.
    Gltf,
    /// glTF 2.0 as a binary file.
    Glb,
}

impl MeshFormat {
    /// All formats.
    pub const ALL: [MeshFormat; 7] = [
        MeshFormat::Stl,
        MeshFormat::Obj,
        MeshFormat::Ply,
        MeshFormat::Off,
        MeshFormat::ThreeMf,
        MeshFormat::Gltf,
        MeshFormat::Glb,
    ];

    /// The name, which is also the usual file name extension.
    pub fn name(self) -> &'static str {
        match self {
            MeshFormat::Stl => "stl",
            MeshFormat::Obj => "obj",
            MeshFormat::Ply => "ply",
            MeshFormat::Off => "off",
            MeshFormat::ThreeMf => "3mf",
            MeshFormat::Gltf => "gltf",
            MeshFormat::Glb => "glb",
        }
    }

    /// The format with this name or extension, ignoring case.
    pub fn from_name(name: &str) -> Option<MeshFormat> {
        MeshFormat::ALL.into_iter().find(|format| format.name().eq_ignore_ascii_case(name))
    }

    /// The format of a file by its extension.
    pub fn from_path(path: &Path) -> Option<MeshFormat> {
        MeshFormat::from_name(path.extension()?.to_str()?)
    }
}
