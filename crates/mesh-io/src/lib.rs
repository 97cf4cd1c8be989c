//! Mesh files: readers and writers of STL, OBJ, PLY, OFF, 3MF, glTF and GLB.
//!
//! Readers are safe on malformed input: a count in a header is compared with the length of the file before anything is
//! allocated, the length of lines is limited, and NaN or infinite numbers are rejected with their location. Faces with more
//! than three corners are triangulated. The parts of an archive may expand to 32 times its length (at least 16 MiB, at most 4
//! GiB); meshes that a file uses several times may make a million vertices and triangles or, if that is more, 2 for each byte
//! of the file.
//!
//! | format | read | written | unit |
//! | --- | --- | --- | --- |
//! | STL | text and binary | binary (coordinates as `f32`) or text | none |
//! | OBJ | vertices and faces of all groups | vertices and triangles, by object | none |
//! | PLY | text, binary of both byte orders | binary with `f64`, or text | none |
//! | OFF | `OFF`, `COFF`, `NOFF`, `STOFF` and their combinations | text | none |
//! | 3MF | the objects of the build, with components, also across several model parts | objects | the file's; written in mm |
//! | glTF, GLB | the triangles of the scene, under the transforms of its nodes | a node for each mesh (coordinates as `f32`) | m |
//!
//! ```
//! use rayweave_mesh_io::{MeshFormat, ReadOptions, read_bytes};
//!
//! let text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
//! let loaded = read_bytes(text, MeshFormat::Obj, &ReadOptions::default())?;
//! assert!(loaded.mesh.is_closed());
//! # Ok::<(), rayweave_mesh_io::FileError>(())
//! ```

mod budget;
mod builder;
mod error;
mod format;
mod gltf;
mod loaded;
mod obj;
mod off;
mod options;
mod ply;
mod read;
mod stl;
mod text;
mod threemf;
mod tokens;
mod write;

pub use error::{FileError, Location};
pub use format::MeshFormat;
pub use loaded::{LoadedMesh, MeshObject};
pub use options::{MeshWriteOptions, ReadOptions, ThreeMfUnit};
pub use read::{read, read_allowed, read_bytes};
pub use write::{save, write, write_objects};
