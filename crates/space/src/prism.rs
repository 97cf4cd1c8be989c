//! Prisms in R^d: solids over polygons of the plane of the first two coordinates, unbounded in the others.

use crate::shape::Shape;
use crate::surface::{Plane, Surface};
use crate::vector::padded;
use crate::{Point, Solid, SpaceError};
use rayweave_polygon::{HalfPlane, Operator, PolygonError, Polygons, from_polygons};
use rayweave_rootray::Side;

impl<const D: usize> Solid<D> {
    /// The points whose first two coordinates lie in a simple polygon, unbounded in the others. The points may have either
    /// orientation; the half-space of the edge from point k to the next is named `edge` k.
    ///
    /// # Errors
    /// `Polygon` for an invalid coordinate or edges that cross; `Dimension` if D < 2.
    pub fn prism(points: &[Point<2>]) -> Result<Self, SpaceError> {
        match from_polygons(&[points], Side::Outside) {
            Err(PolygonError::Orientation { .. }) => {
                let reversed: Vec<Point<2>> = points.iter().rev().copied().collect();
                let polygons = from_polygons(&[reversed], Side::Outside)?;
                // an edge begins where the reversed edge ends
                over(&polygons, |edge| format!("edge{}", points.len() - 1 - polygons.edge(edge).to))
            }
            polygons => {
                let polygons = polygons?;
                over(&polygons, |edge| format!("edge{}", polygons.edge(edge).from))
            }
        }
    }

    /// The points whose first two coordinates lie in a region bounded by polygons, unbounded in the others. The half-spaces of edges
    /// are named after the contour and the first vertex of the edge, `contour0.edge3`.
    ///
    /// # Errors
    /// `Dimension` if D < 2.
    pub fn over_polygons(polygons: &Polygons) -> Result<Self, SpaceError> {
        over(polygons, |edge| {
            let edge = polygons.edge(edge);
            format!("contour{}.edge{}", edge.contour, edge.from)
        })
    }
}

fn over<const D: usize>(polygons: &Polygons, name: impl Fn(u32) -> String) -> Result<Solid<D>, SpaceError> {
    if D < 2 {
        return Err(SpaceError::Dimension { from: 2, to: D });
    }
    let [lo, hi] = polygons.corner_bounds();
    let finite = (lo[0] <= hi[0]).then(|| {
        let (middle, half) = ([0, 1].map(|k| 0.5 * (lo[k] + hi[k])), [0, 1].map(|k| 0.5 * (hi[k] - lo[k])));
        (padded(&middle), padded(&half))
    });
    let wall = |half_plane: HalfPlane| {
        let plane = Plane::new(&padded(&half_plane.normal), half_plane.offset);
        let shape = Shape { kind: "half_space", facets: vec![Surface::Plane(plane)], finite };
        Solid::from(shape).named(&name(half_plane.edge))
    };
    Ok(polygons.fold(wall, |operator, parts| match operator {
        Operator::Intersection => Solid::intersection(parts),
        Operator::Union => Solid::union(parts),
        Operator::SymmetricDifference => Solid::symmetric_difference(parts),
        Operator::Complement => !Solid::union(parts),
    }))
}
