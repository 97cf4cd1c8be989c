//! OpenSCAD dumps: the solid that is read equals the one in the file.

mod drawings;
mod files;
mod flat;
mod folder;
mod hulls;
mod malformed;
mod measure;
mod meshes;
mod shells;
#[path = "../skip/mod.rs"]
mod skip;
mod solids;
mod texts;
