//! A region as an ordinary solid: of the plane, or of space as a prism.

use super::{HalfPlane, Operator, Polygons};
use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_shape::primitive::{HalfSpace, Primitive, ShapeError, Slab};

impl Polygons {
    /// The prism over the region, `lo < z < hi`, as a solid of space: one half-space for each edge, and a slab.
    ///
    /// Half-spaces are called after the contour and the vertex where their edge begins, `contour0.edge3`.
    ///
    /// # Errors
    ///
    /// [`ShapeError`] if `lo < hi` does not hold, or one of them is not finite.
    pub fn extrude(&self, lo: f64, hi: f64) -> Result<Solid, ShapeError> {
        let slab = Solid::from(Primitive::from(Slab::new(Vec3::Z, lo, hi)?)).named("ends");
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
            None => Ok(base & slab),
        }
    }

    fn edge_name(&self, edge: u32) -> String {
        let edge = self.edge(edge);
        format!("contour{}.edge{}", edge.contour, edge.from)
    }
}
