//! A region as an ordinary solid: of the plane, or of space as a prism.

use super::{HalfPlane, Operator, Polygons};
use crate::SpaceError;
use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_rootray::Side;
use rayweave_shape::primitive::{BoxFromCorners, HalfSpace, Primitive, ShapeError, Slab};

/// By how much the box around a prism stands off from it, as a part of the larger side.
const LOOSE: f64 = 1.0 / 64.0;

impl Polygons {
    /// The region as a solid of the plane, for boolean operators, maps and curves: see [`crate::Solid::over_polygons`].
    ///
    /// # Errors
    ///
    /// None: corners are within the range of lengths that solids allow, and the plane has two dimensions.
    pub fn to_solid(&self) -> Result<crate::Solid<2>, SpaceError> {
        crate::Solid::over_polygons(self)
    }

    /// The prism over the region, `lo < z < hi`, as a solid of space: one half-space for each edge, and a box.
    ///
    /// Half-spaces are called after the contour and the vertex where their edge begins, `contour0.edge3`. The box is
    /// called `ends`: its faces `z-` and `z+` are those of the prism; the others stand off from the region by a
    /// quarter of its size and say only that it is bounded. (An unbounded region has a slab of that name.)
    ///
    /// A ray in a face is moved aside along the `w` of space, not that of the plane: where an edge's slope is between
    /// the slopes of these two, such a ray and the line under it ([`Polygons::trace`]) are on different sides of
    /// that edge.
    ///
    /// # Errors
    ///
    /// [`ShapeError`] if `lo < hi` does not hold, or one of them is not finite.
    pub fn extrude(&self, lo: f64, hi: f64) -> Result<Solid, ShapeError> {
        let ends = Solid::from(self.ends(lo, hi)?).named("ends");
        let mut problem = None;
        let wall = |half_plane: HalfPlane| {
            let normal = Vec3::new(half_plane.normal[0], half_plane.normal[1], 0.0);
            match HalfSpace::new(normal, half_plane.offset) {
                Ok(half_space) => {
                    Solid::from(Primitive::from(half_space)).named(&self.edge_name(half_plane.edge))
                }
                Err(error) => {
                    problem = Some(error);
                    Solid::vacuum()
                }
            }
        };
        let base = self.fold(wall, |operator, parts| match operator {
            Operator::Intersection => Solid::intersection(parts),
            Operator::Union => Solid::union(parts),
            Operator::SymmetricDifference => Solid::symmetric_difference(parts),
            Operator::Complement => !Solid::union(parts),
        });
        match problem {
            Some(error) => Err(error),
            None => Ok(base & ends),
        }
    }

    /// What bounds the prism in z, and loosely in x and y if the region is bounded.
    fn ends(&self, lo: f64, hi: f64) -> Result<Primitive, ShapeError> {
        let [low, high] = self.corner_bounds();
        if self.outside() == Side::Inside || self.edge_count() == 0 {
            return Ok(Slab::new(Vec3::Z, lo, hi)?.into());
        }
        // enough that no corner lies on a wall, and little enough that the box is of use
        let margin = LOOSE * (high[0] - low[0]).max(high[1] - low[1]);
        let corner = |at: [f64; 2], margin: f64, z| Vec3::new(at[0] + margin, at[1] + margin, z);
        Ok(BoxFromCorners::new(corner(low, -margin, lo), corner(high, margin, hi))?.into())
    }

    fn edge_name(&self, edge: u32) -> String {
        let edge = self.edge(edge);
        format!("contour{}.edge{}", edge.contour, edge.from)
    }
}
