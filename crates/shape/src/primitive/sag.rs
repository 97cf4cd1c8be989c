//! Common parts of the primitives with a sag surface (asphere, biconic, freeform).

use super::{Facet, Lowered, Shape, ShapeError, Value};
use crate::surface::sag::{Description, Sag};
use crate::surface::{Object, Surface};
use rayweave_math::{Bounds, Vec3};
use std::sync::Arc;

/// The sag surface of checked arguments.
pub(super) fn checked<S: Shape>(
    arguments: &[(&'static str, Value)],
    description: impl FnOnce() -> Description,
) -> Result<Arc<Sag>, ShapeError> {
    for (parameter, (_, value)) in S::PARAMETERS.iter().zip(arguments) {
        parameter.check(S::NAME, value)?;
    }
    let sag = Sag::new(&description()).map_err(|problem| ShapeError::Sag { shape: S::NAME, problem })?;
    Ok(Arc::new(sag))
}

/// The solid above a sag in its aperture, up to a height.
pub(super) fn above(sag: &Arc<Sag>, height: f64) -> Lowered {
    let (radius, [low, _]) = (sag.aperture(), sag.heights());
    let surface = Surface::Object(Box::new(Object::new(sag.clone())));
    let mut facets = vec![
        Facet::outside("surface", surface),
        Facet::inside("side", Surface::cylinder(Vec3::ZERO, Vec3::Z, radius)),
    ];
    if height.is_finite() {
        facets.push(Facet::inside("top", Surface::plane(Vec3::Z, height)));
    }
    let bounds = Bounds { lo: Vec3::new(-radius, -radius, low), hi: Vec3::new(radius, radius, height) };
    Lowered::conjunction(facets, if low < height { bounds } else { Bounds::EMPTY })
}
