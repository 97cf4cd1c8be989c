//! Constructors of solids: one function per shape, with the names and parameters of model files and Python.
//!
//! Lengths are in an arbitrary unit, angles in degrees, axes right-handed. Parameters out of range are errors
//! that name the parameter, its range and, where possible, the likely intention. The manual page of each
//! shape, with its equation, faces and degenerate cases, is in [`crate::shape::primitive::MANUALS`].
//! `polygon::Outline` (feature `space`) extrudes and revolves outlines.
//!
//! ```
//! use rayweave::shapes::{box_, sphere};
//!
//! let die = &box_([2.0, 2.0, 2.0])? & &sphere(1.4)?;
//! assert_eq!(die.to_string(), "box(size=[2.0, 2.0, 2.0]) & sphere(radius=1.4)");
//!
//! let error = sphere(-1.0).unwrap_err();
//! assert!(error.is_shape() && error.to_string().contains("radius"));
//! # Ok::<(), rayweave::Error>(())
//! ```

#[rustfmt::skip]
mod primitives;

pub use primitives::*;

use crate::Error;
use rayweave_math::Affine;
use rayweave_model::Solid;
use rayweave_shape::primitive::{Value, build};
use std::sync::Arc;

/// The empty solid: the neutral element of union.
pub fn empty() -> Solid {
    Solid::empty()
}

/// The universe, all of space: the neutral element of intersection.
pub fn universe() -> Solid {
    Solid::universe()
}

/// The union of solids; the union of none is [`empty`].
pub fn union(solids: impl IntoIterator<Item = Solid>) -> Solid {
    Solid::union(solids)
}

/// The intersection of solids; the intersection of none is [`universe`].
pub fn intersection(solids: impl IntoIterator<Item = Solid>) -> Solid {
    Solid::intersection(solids)
}

/// The union of copies of a solid under the maps `world_from_local`. The solid is compiled once for all
/// copies.
pub fn place(solid: &Solid, transforms: impl Into<Arc<[Affine]>>) -> Solid {
    solid.place(transforms)
}

fn make(name: &str, arguments: &[(&str, Value)]) -> Result<Solid, Error> {
    Ok(build(name, arguments)?.into())
}

/// Vertex numbers as the rows of numbers that primitives take; below 2^32, so exact.
fn indices(rows: &[[u32; 3]]) -> Vec<[f64; 3]> {
    rows.iter().map(|row| row.map(f64::from)).collect()
}
