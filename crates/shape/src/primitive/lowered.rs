//! Lowered primitive: a conjunction of sides of surfaces.

use crate::surface::Surface;
use rayweave_math::{Bounds, Vec3};
use std::borrow::Cow;

/// One face of a lowered primitive: a side of a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Facet {
    /// Name of the face, as in the manual page.
    pub name: Cow<'static, str>,
    /// The surface, in the primitive's own frame.
    pub surface: Surface,
    /// True if the conjunction lies where `f < 0`.
    pub inside: bool,
}

impl Facet {
    /// The side `f < 0` of a surface.
    pub fn inside(name: impl Into<Cow<'static, str>>, surface: Surface) -> Facet {
        Facet { name: name.into(), surface, inside: true }
    }

    /// The side `f > 0` of a surface.
    pub fn outside(name: impl Into<Cow<'static, str>>, surface: Surface) -> Facet {
        Facet { name: name.into(), surface, inside: false }
    }

    fn holds(&self, point: Vec3) -> bool {
        let (value, _) = self.surface.value_and_gradient(point);
        (value < 0.0) == self.inside
    }
}

/// A primitive as a conjunction of sides of surfaces: the inside is where all facets hold, or, if `complement` is set,
/// where not all of them hold.
#[derive(Clone, Debug, PartialEq)]
pub struct Lowered {
    /// The faces; without any the conjunction is all of space.
    pub facets: Vec<Facet>,
    /// True if the solid is the complement of the conjunction.
    pub complement: bool,
    /// A box around the solid (not the conjunction) in the frame of the primitive: the smallest one, up to rounding and the
    /// exceptions in the manual pages of `convex` and `quadric`.
    pub bounds: Bounds,
}

impl Lowered {
    /// The solid in which all facets hold.
    pub fn conjunction(facets: Vec<Facet>, bounds: Bounds) -> Lowered {
        Lowered { facets, complement: false, bounds }
    }

    /// The solid in which not all facets hold.
    pub fn complement(facets: Vec<Facet>, bounds: Bounds) -> Lowered {
        Lowered { facets, complement: true, bounds }
    }

    /// The empty solid.
    pub fn nothing() -> Lowered {
        Lowered::complement(Vec::new(), Bounds::EMPTY)
    }

    /// All of space.
    pub fn everything() -> Lowered {
        Lowered::conjunction(Vec::new(), Bounds::ALL)
    }

    /// True if the point is inside, by the sign of each surface's function. For a point within rounding of a surface either
    /// answer is possible; ray queries do not use it.
    pub fn contains(&self, point: Vec3) -> bool {
        self.facets.iter().all(|facet| facet.holds(point)) != self.complement
    }
}

/// The faces `bottom` at `z = -height/2` and `top` at `z = height/2`; none for an infinite height.
pub(super) fn caps(height: f64) -> Vec<Facet> {
    if height == f64::INFINITY {
        return Vec::new();
    }
    vec![
        Facet::outside("bottom", Surface::plane(Vec3::Z, -0.5 * height)),
        Facet::inside("top", Surface::plane(Vec3::Z, 0.5 * height)),
    ]
}

/// The box around a centred solid of revolution about z of the given radius.
pub(super) fn pillar(radius: f64, height: f64) -> Bounds {
    Bounds::centred(Vec3::ZERO, Vec3::new(radius, radius, 0.5 * height))
}
