//! Prism (linear extrusion) over a region, as a solid of space.

use crate::{HalfPlane, Operator, Point, Polygons};
use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_rootray::Side;
use rayweave_shape::primitive::{BoxFromCorners, HalfSpace, Primitive, ShapeError, Slab};

/// The margin of the bounding box around a prism, relative to the larger side of the region.
const RELATIVE_MARGIN: f64 = 1.0 / 64.0;

impl Polygons {
    /// The prism over the region, `lo < z < hi`, as a solid of space: one half-space for each edge, and a box.
    ///
    /// Half-spaces are named after the contour and the first vertex of their edge, `contour0.edge3`. The box is named `ends`: its
    /// faces `z-` and `z+` are those of the prism, the others keep a margin around the region and only make the solid bounded.
    /// (For an unbounded region `ends` is a slab.) A prism with many edges also has boxes named `cell`, whose faces are none of the
    /// prism ([`Polygons::fold_by_cells`]).
    ///
    /// A ray in a face is perturbed along the direction for space ([`rayweave_math::PERTURBATION_DIRECTION`]), not that for the
    /// plane. At an edge whose slope lies between the slopes of these two directions, the ray and the line under it
    /// ([`Polygons::trace`]) are on different sides.
    ///
    /// # Errors
    ///
    /// [`ShapeError`] unless `lo < hi` and both are finite.
    pub fn extrude(&self, lo: f64, hi: f64) -> Result<Solid, ShapeError> {
        let ends = Solid::from(self.ends(lo, hi)?).named("ends");
        let wall = |half_plane: HalfPlane| {
            let normal = Vec3::new(half_plane.normal[0], half_plane.normal[1], 0.0);
            let half_space = HalfSpace::new(normal, half_plane.offset)?;
            Ok(Solid::from(Primitive::from(half_space)).named(&self.edge_name(half_plane.edge)))
        };
        let cell = |cell| Ok(Solid::from(Primitive::from(box_over(cell, [lo, hi])?)).named("cell"));
        let join = |operator: Operator, parts: Vec<Result<Solid, ShapeError>>| {
            Ok(operator.solid(parts.into_iter().collect::<Result<_, _>>()?))
        };
        Ok(self.fold_by_cells(wall, cell, join)? & ends)
    }

    /// The box or slab that bounds the prism in z and, for a bounded region, with a margin in x and y.
    fn ends(&self, lo: f64, hi: f64) -> Result<Primitive, ShapeError> {
        let [low, high] = self.corner_bounds();
        if self.outside() == Side::Inside || self.edge_count() == 0 {
            return Ok(Slab::new(Vec3::Z, lo, hi)?.into());
        }
        // large enough to keep corners away from the walls, small enough for a tight box
        let margin = RELATIVE_MARGIN * (high[0] - low[0]).max(high[1] - low[1]);
        let corner = |at: [f64; 2], margin: f64, z| Vec3::new(at[0] + margin, at[1] + margin, z);
        Ok(BoxFromCorners::new(corner(low, -margin, lo), corner(high, margin, hi))?.into())
    }

    fn edge_name(&self, edge: u32) -> String {
        let edge = self.edge(edge);
        format!("contour{}.edge{}", edge.contour, edge.from)
    }
}

/// A box over a cell, for a prism between two heights: its own ends lie beyond those of the prism.
pub(crate) fn box_over([a, b]: [Point; 2], [lo, hi]: [f64; 2]) -> Result<BoxFromCorners, ShapeError> {
    BoxFromCorners::new(Vec3::new(a[0], a[1], lo - (hi - lo)), Vec3::new(b[0], b[1], hi + (hi - lo)))
}

impl Operator {
    /// The solid of a formula with this operator.
    pub(crate) fn solid(self, parts: Vec<Solid>) -> Solid {
        match self {
            Operator::Intersection => Solid::intersection(parts),
            Operator::Union => Solid::union(parts),
            Operator::SymmetricDifference => Solid::symmetric_difference(parts),
            Operator::Complement => !Solid::union(parts),
        }
    }
}
