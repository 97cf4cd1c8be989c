//! Model formats: names and file extensions.

use rayweave_mesh_io::MeshFormat;
use std::fmt;
use std::path::Path;

/// A model format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// Rayweave's own model file, `.toml`.
    Native,
    /// The flattened dump of OpenSCAD, `.csg`.
    OpenScad,
    /// The Geometry Description Markup Language of Geant4, `.gdml`.
    Gdml,
    /// A triangle mesh file.
    Mesh(MeshFormat),
}

/// All formats, each with its name and file extensions.
const TABLE: &[(Format, &str, &[&str])] = &[
    (Format::Native, "native", &["toml"]),
    (Format::OpenScad, "openscad", &["csg"]),
    (Format::Gdml, "gdml", &["gdml"]),
    (Format::Mesh(MeshFormat::Stl), "stl", &["stl"]),
    (Format::Mesh(MeshFormat::Obj), "obj", &["obj"]),
    (Format::Mesh(MeshFormat::Ply), "ply", &["ply"]),
    (Format::Mesh(MeshFormat::Off), "off", &["off"]),
    (Format::Mesh(MeshFormat::ThreeMf), "3mf", &["3mf"]),
    (Format::Mesh(MeshFormat::Gltf), "gltf", &["gltf"]),
    (Format::Mesh(MeshFormat::Glb), "glb", &["glb"]),
];

impl Format {
    /// Names of all formats.
    pub const NAMES: [&'static str; TABLE.len()] = {
        let mut names = [""; TABLE.len()];
        let mut k = 0;
        while k < names.len() {
            names[k] = TABLE[k].1;
            k += 1;
        }
        names
    };

    /// The name on the command line and in Python.
    pub fn name(self) -> &'static str {
        TABLE.iter().find(|row| row.0 == self).map_or("", |row| row.1)
    }

    /// The format with the given name.
    pub fn from_name(name: &str) -> Option<Format> {
        TABLE.iter().find(|row| row.1 == name).map(|row| row.0)
    }

    /// The file extensions, in lower case without the dot. Written files have the first one.
    pub fn extensions(self) -> &'static [&'static str] {
        TABLE.iter().find(|row| row.0 == self).map_or(&[][..], |row| row.2)
    }

    /// The format of a file extension, in lower or upper case.
    pub fn from_path(path: &Path) -> Option<Format> {
        let ending = path.extension()?.to_str()?.to_ascii_lowercase();
        TABLE.iter().find(|row| row.2.contains(&ending.as_str())).map(|row| row.0)
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_format_has_its_own_name_and_extensions() {
        for (k, (format, name, endings)) in TABLE.iter().enumerate() {
            assert_eq!(Format::from_name(name), Some(*format));
            assert_eq!(Format::NAMES[k], format.name());
            assert_eq!(format.extensions(), *endings);
            for ending in *endings {
                assert_eq!(Format::from_path(Path::new(&format!("a.b.{ending}"))), Some(*format));
            }
        }
        assert_eq!(Format::from_path(Path::new("PART.CSG")), Some(Format::OpenScad));
        for unknown in ["part", "part.scad", ".csg", ""] {
            assert_eq!(Format::from_path(Path::new(unknown)), None, "{unknown}");
        }
    }

    #[test]
    fn the_documentation_lists_every_extension() {
        let page = include_str!("../../../docs/reference/formats.md");
        let table = page.split("\n\n").find(|part| part.starts_with("| format | endings |")).unwrap();
        for (format, _, endings) in TABLE {
            for ending in *endings {
                assert!(table.contains(&format!("`.{ending}`")), "{format}: .{ending}");
            }
        }
    }
}
