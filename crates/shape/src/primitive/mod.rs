//! Primitive solids.

use crate::surface::Surface;
use rayweave_math::Bounds;
use std::borrow::Cow;

/// One face of a lowered primitive: a side of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Facet {
    /// The face's name, as its manual page gives it.
    pub name: Cow<'static, str>,
    /// The surface, in the primitive's own frame.
    pub surface: Surface,
    /// True if the primitive lies where `f < 0`.
    pub inside: bool,
}

/// A primitive as a conjunction of sides of surfaces: inside where all facets hold, or, if `complement` is
/// set, where not all of them hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Lowered {
    /// The faces; the conjunction of none is all of space.
    pub facets: Vec<Facet>,
    /// True if the solid is the complement of the conjunction.
    pub complement: bool,
    /// A box that holds the solid (not the conjunction), in the primitive's own frame.
    pub bounds: Bounds,
}
