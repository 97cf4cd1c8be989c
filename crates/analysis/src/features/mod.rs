//! Sizes for drawings: the extent of a model, its cylindrical faces (holes, shafts, fillets) with their diameters and depths, its
//! fillets and chamfers, and its polygonal holes and steps along the axes.
//!
//! All are found by rays, with exact crossings: coordinates and radii have no error but rounding. [`Extent::is_exact`] states whether
//! the bounding box confirms an extent; a cylinder is a face only where rays inside and outside of it differ.

mod corners;
mod cylinders;
mod extent;
mod polygons;
mod spans;
#[cfg(test)]
mod tests;

pub use corners::{CornerFace, CornerPlace, CornerSize, corner_faces};
pub use cylinders::{CylindricalFace, CylindricalFaces, cylindrical_faces};
pub use extent::{Extent, extent};
pub(crate) use extent::{MOST_REACHED, extent_of};
pub use polygons::{AxialFeatures, PolygonalFace, axial_features, sides_of_rectangle};
