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
mod solids;
mod texts;
