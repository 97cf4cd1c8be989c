//! OpenSCAD's dumps: what is read is the solid that was said.

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
