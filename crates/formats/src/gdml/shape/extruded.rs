//! Extruded polygons (`G4ExtrudedSolid`).

use super::{Made, of, union_of};
use crate::gdml::attributes::{Failure, refused};
use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_polygon::{HalfPlane, Operator, Polygons, from_polygons};
use rayweave_rootray::Side;
use rayweave_shape::primitive::{BoxFromCorners, Convex, HalfSpace, ShapeError};

/// A section: the polygon at a height, scaled about the origin, then translated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::gdml) struct Section {
    pub z: f64,
    pub offset: [f64; 2],
    pub scale: f64,
}

/// `G4ExtrudedSolid`: a simple polygon, convex or not, ruled between its sections in order along z.
pub(in crate::gdml) fn extruded(corners: &[[f64; 2]], sections: &[Section]) -> Made {
    let polygon = polygon(corners)?;
    let mut sections = sections.to_vec();
    sections.sort_by(|a, b| a.z.total_cmp(&b.z));
    if sections.iter().any(|section| section.scale < 0.0) {
        return refused("a scaling factor is negative");
    }
    let mut layers = Vec::new();
    for pair in sections.windows(2).filter(|pair| pair[0].z < pair[1].z) {
        layers.push(Layer { low: pair[0], high: pair[1] }.solid(&polygon)?);
    }
    union_of(layers, "all of its sections are at the same height")
}

fn polygon(corners: &[[f64; 2]]) -> Result<Polygons, Failure> {
    let mut corners = corners.to_vec();
    let turn: f64 = super::round::edges(&corners).map(|(a, b)| a[0] * b[1] - b[0] * a[1]).sum();
    if turn < 0.0 {
        corners.reverse();
    }
    let polygon =
        from_polygons(&[corners], Side::Outside).map_err(|error| Failure::Refused(error.to_string()))?;
    match polygon.edge_count() {
        0 => refused("its polygon has no area"),
        _ => Ok(polygon),
    }
}

/// The part between two sections.
struct Layer {
    low: Section,
    high: Section,
}

/// A list of planes for a convex polygon, otherwise a solid.
enum Part {
    Planes(Vec<[f64; 4]>),
    Solid(Solid),
}

impl Layer {
    fn solid(&self, polygon: &Polygons) -> Made {
        let mut problem: Option<ShapeError> = None;
        let mut solid = |part: Part| match part {
            Part::Solid(solid) => solid,
            Part::Planes(planes) => behind(planes).unwrap_or_else(|error| {
                problem = Some(error);
                Solid::empty()
            }),
        };
        let ends = [[0.0, 0.0, -1.0, -self.low.z], [0.0, 0.0, 1.0, self.high.z]];
        let part = polygon.fold_by_cells(
            |half_plane| Part::Planes(vec![self.plane(half_plane)]),
            |cell| Part::Planes([&self.sides(cell)[..], &ends].concat()),
            |operator, parts| joined(operator, parts, &mut solid),
        );
        let made = match part {
            Part::Planes(planes) => of(Convex::new([&planes[..], &ends].concat())?),
            Part::Solid(walls) => walls & self.bounds(polygon)?,
        };
        problem.map_or(Ok(made), |error| Err(error.into()))
    }

    /// The plane over an edge of the polygon: n . (p - offset(z)) < scale(z) d, all linear in z.
    fn plane(&self, half_plane: HalfPlane) -> [f64; 4] {
        let (low, high, normal) = (self.low, self.high, half_plane.normal);
        let height = high.z - low.z;
        let value = |section: Section| {
            normal[0] * section.offset[0] + normal[1] * section.offset[1] + section.scale * half_plane.offset
        };
        let slope = (value(high) - value(low)) / height;
        [normal[0], normal[1], -slope, value(low) - slope * low.z]
    }

    /// The planes over the sides of a rectangle.
    fn sides(&self, [lo, hi]: [[f64; 2]; 2]) -> [[f64; 4]; 4] {
        let plane = |normal, offset| self.plane(HalfPlane { normal, offset, edge: 0 });
        [
            plane([1.0, 0.0], hi[0]),
            plane([0.0, 1.0], hi[1]),
            // the planes of adjacent rectangles differ in sign only
            plane([-1.0, 0.0], -lo[0]),
            plane([0.0, -1.0], -lo[1]),
        ]
    }

    /// A box that ends with the layer in z, and whose sides lie outside of the solid.
    fn bounds(&self, polygon: &Polygons) -> Made {
        let [lo, hi] = polygon.corner_bounds();
        let margin = 0.25 * (hi[0] - lo[0]).max(hi[1] - lo[1]) * self.low.scale.max(self.high.scale);
        let corner = |at: [f64; 2], sign: f64, z: f64| {
            let along = |axis: usize| {
                let place = |s: Section| s.offset[axis] + s.scale * at[axis];
                let (a, b) = (place(self.low), place(self.high));
                sign * (sign * a).max(sign * b) + sign * margin
            };
            Vec3::new(along(0), along(1), z)
        };
        let (low, high) = (corner(lo, -1.0, self.low.z), corner(hi, 1.0, self.high.z));
        Ok(of(BoxFromCorners::new(low, high)?))
    }
}

/// Intersection of half-spaces, which may be unbounded.
fn behind(planes: Vec<[f64; 4]>) -> Result<Solid, ShapeError> {
    match planes.as_slice() {
        [[a, b, c, d]] => Ok(of(HalfSpace::new(Vec3::new(*a, *b, *c), *d)?)),
        _ => Ok(of(Convex::new(planes)?)),
    }
}

/// Combines parts; an intersection of planes stays a list of planes.
fn joined(operator: Operator, parts: Vec<Part>, solid: &mut impl FnMut(Part) -> Solid) -> Part {
    if operator == Operator::Intersection && parts.iter().all(|part| matches!(part, Part::Planes(_))) {
        let planes = parts.into_iter().flat_map(|part| match part {
            Part::Planes(planes) => planes,
            Part::Solid(_) => Vec::new(),
        });
        return Part::Planes(planes.collect());
    }
    let solids = parts.into_iter().map(solid);
    Part::Solid(match operator {
        Operator::Intersection => Solid::intersection(solids),
        Operator::Union => Solid::union(solids),
        Operator::SymmetricDifference => Solid::symmetric_difference(solids),
        Operator::Complement => !Solid::union(solids),
    })
}
