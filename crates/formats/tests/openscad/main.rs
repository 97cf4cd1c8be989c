//! OpenSCAD's dumps: what is read is the solid that was said.

mod malformed;
mod measure;
mod solids;
