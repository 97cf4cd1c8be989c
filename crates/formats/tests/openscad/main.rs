//! OpenSCAD's dumps: what is read is the solid that was said.

mod files;
mod flat;
mod hulls;
mod malformed;
mod measure;
mod meshes;
mod solids;
