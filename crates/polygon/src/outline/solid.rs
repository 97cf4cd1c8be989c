//! Solids of outlines: prisms and solids of revolution.

use super::contour::Edge;
use super::facets::{Prism, Revolution};
use super::rim::{Rim, cutters};
use super::{Contour, Outline, OutlineError};
use crate::cells::MAX_EDGES;
use crate::prism::box_over;
use crate::{HalfPlane, Operator, Point, from_polygons};
use rayweave_math::roots::difference_of_products;
use rayweave_math::{UNIT_ROUNDOFF, Vec3};
use rayweave_model::Solid;
use rayweave_rootray::Side;
use rayweave_shape::primitive::{
    BoxFromCorners, Cylinder, HalfSpace, Primitive, Quadric, ShapeError, Sphere, Torus, Wedge,
};
use rayweave_shape::surface::DISTANT;
use std::sync::Arc;

/// The margin of the bounding box around a prism, relative to the larger side of the outline.
const RELATIVE_MARGIN: f64 = 1.0 / 64.0;

/// The maximum distance between an arc and the chords that replace it, where its revolution is not a torus or sphere, relative to
/// the larger side of the outline.
const CHORD_TOLERANCE: f64 = 1e-6;

/// The distance from the axis, relative to the size, that counts as 0. The centres of arcs have errors of a few roundings of the
/// coordinates, which may be a thousand times larger than the radius.
const AXIS_TOLERANCE: f64 = 1e-12;

/// The solid that a shape becomes.
pub(super) fn solid<P: Into<Primitive>>(shape: Result<P, ShapeError>) -> Result<Solid, OutlineError> {
    Ok(Solid::from(shape?.into()))
}

/// The sets of space that half-planes and discs become.
trait Sweep {
    fn wall(&self, half_plane: &HalfPlane) -> Result<Solid, OutlineError>;
    fn disc(&self, centre: Point, radius: f64) -> Result<Solid, OutlineError>;
    /// A bounded solid over a cell of the plane that has all of the solid of the outline there.
    fn cell(&self, cell: [Point; 2]) -> Result<Solid, OutlineError>;
}

/// Moved along z, without ends.
struct Moved {
    /// The lowest and the highest z of the prism.
    ends: [f64; 2],
}

/// Revolved about the axis x = 0 of the plane, which becomes the z axis.
struct Revolved {
    /// The lowest and the highest z.
    ends: [f64; 2],
}

impl Sweep for Moved {
    fn wall(&self, half_plane: &HalfPlane) -> Result<Solid, OutlineError> {
        let [x, y] = half_plane.normal;
        solid(HalfSpace::new(Vec3::new(x, y, 0.0), half_plane.offset))
    }

    fn disc(&self, centre: Point, radius: f64) -> Result<Solid, OutlineError> {
        rod(centre, radius)
    }

    fn cell(&self, cell: [Point; 2]) -> Result<Solid, OutlineError> {
        solid(box_over(cell, self.ends))
    }
}

impl Sweep for Revolved {
    /// The points with `a r + b z < c`, where r is the distance from the axis.
    fn wall(&self, half_plane: &HalfPlane) -> Result<Solid, OutlineError> {
        let ([a, b], c) = (half_plane.normal, half_plane.offset);
        match a == 0.0 {
            true => solid(HalfSpace::new(Vec3::new(0.0, 0.0, b), c)),
            false => {
                let (slope, radius) = (-b / a, c / a);
                let inner = match near_cylinder(slope, radius, self.ends)? {
                    Some(inner) => inner,
                    None => within([0.0; 2], slope, radius)?,
                };
                Ok(if a < 0.0 { !inner } else { inner })
            }
        }
    }

    fn disc(&self, [distance, height]: Point, radius: f64) -> Result<Solid, OutlineError> {
        let ring = match distance.abs() <= AXIS_TOLERANCE * radius {
            true => solid(Sphere::new(radius))?,
            false => solid(Torus::new(distance, radius))?,
        };
        Ok(ring.translate([0.0, 0.0, height]))
    }

    /// A box, the sides of which are outside of the outer cylinder; its ends are exactly those of the adjacent cells.
    fn cell(&self, [lo, hi]: [Point; 2]) -> Result<Solid, OutlineError> {
        if hi[0] <= 0.0 {
            return Ok(Solid::empty());
        }
        let side = 1.25 * hi[0];
        let around =
            solid(BoxFromCorners::new(Vec3::new(-side, -side, lo[1]), Vec3::new(side, side, hi[1])))?;
        let outer = around & rod([0.0; 2], hi[0])?;
        Ok(if lo[0] > 0.0 { outer - rod([0.0; 2], lo[0])? } else { outer })
    }
}

/// The points within a distance of a vertical axis.
fn rod([x, y]: Point, radius: f64) -> Result<Solid, OutlineError> {
    Ok(solid(Cylinder::new(radius, f64::INFINITY))?.translate([x, y, 0.0]))
}

/// The points with `r < slope z + radius`, where r is the distance from the vertical axis through a point.
pub(super) fn within([x, y]: Point, slope: f64, radius: f64) -> Result<Solid, OutlineError> {
    if slope == 0.0 {
        return match radius > 0.0 {
            true => rod([x, y], radius),
            false => Ok(Solid::empty()),
        };
    }
    // r^2 < slope^2 (z - apex)^2, on the side of the apex where the radius is positive
    let (zz, apex) = (-slope * slope, -radius / slope);
    let matrix = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, zz, 0.0], [0.0; 4]];
    let nappe = solid(HalfSpace::new(Vec3::new(0.0, 0.0, -slope), 0.0))?;
    Ok((solid(Quadric::new(matrix))? & nappe).translate([x, y, apex]))
}

/// The points between two heights with `r < slope z + radius`, where r is the distance from the z axis, if the apex of this cone is
/// farther away than [`DISTANT`] times the height and the radius there. An edge of an outline that is vertical up to roundings has its apex at a distance of 1e16.
pub fn near_cylinder(slope: f64, radius: f64, [low, high]: [f64; 2]) -> Result<Option<Solid>, ShapeError> {
    let middle = 0.5 * (low + high);
    let mean = slope * middle + radius;
    let far = DISTANT * mean.abs().max(high - low);
    if slope == 0.0 || mean.abs() <= far * slope.abs() {
        return Ok(None);
    }
    if mean < 0.0 {
        return Ok(Some(Solid::empty()));
    }
    // half of the tolerance of the surface
    if slope.abs() * (high - low) <= 32.0 * UNIT_ROUNDOFF * (mean + high - low) {
        return Ok(Some(Solid::from(Primitive::from(Cylinder::new(mean, f64::INFINITY)?))));
    }
    // r^2 < (slope q + mean)^2 with q = z - middle; the other side of the apex is outside of every solid
    let z = -slope * mean;
    let matrix = [
        [1.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 0.0],
        [0.0, 0.0, -slope * slope, z],
        [0.0, 0.0, z, -mean * mean],
    ];
    Ok(Some(Solid::from(Primitive::from(Quadric::new(matrix)?)).translate([0.0, 0.0, middle])))
}

impl Outline {
    /// The prism over the region, `lo < z < hi`, with its lower and its upper rim treated. Arcs become cylinders, and their treated
    /// rims tori and cones.
    ///
    /// Faces are named after the contour and the vertex before their edge, `contour0.edge3` and `contour0.arc3`; the ends are
    /// `ends.z-` and `ends.z+`, treated rims `bottom` and `top`.
    ///
    /// # Errors
    ///
    /// [`OutlineError`]: `lo < hi` is required; a rim that is larger than a curved corner or has no room.
    pub fn extrude(&self, lo: f64, hi: f64, rims: [Rim; 2]) -> Result<Solid, OutlineError> {
        let [low, high] = self.bounds;
        let margin = RELATIVE_MARGIN * (high[0] - low[0]).max(high[1] - low[1]);
        let corner = |at: Point, margin: f64, z: f64| Vec3::new(at[0] + margin, at[1] + margin, z);
        if self.contours.is_empty() {
            return Ok(Solid::empty());
        }
        let ends = solid(BoxFromCorners::new(corner(low, -margin, lo), corner(high, margin, hi)))?;
        let size: f64 = rims.iter().map(|rim| rim.size()).sum();
        if size > hi - lo {
            return Err(OutlineError::RimHeight { size, height: hi - lo });
        }
        let prism = self.swept(&Moved { ends: [lo, hi] })? & ends.named("ends");
        let mut cuts = Vec::new();
        for (rim, up) in rims.into_iter().zip([false, true]) {
            cuts.extend(cutters(self, rim, if up { hi } else { lo }, up)?);
        }
        let whole = if cuts.is_empty() { prism } else { prism - Solid::union(cuts) };
        Ok(whole.with_boundary(Arc::new(Prism { outline: self.clone(), z: [lo, hi], rims })))
    }

    /// The region revolved about its axis x = 0, which becomes the z axis of space, as y becomes z, from `start` degrees about z,
    /// counted from the x axis, by `sweep` degrees; 360 is a full turn.
    ///
    /// Straight edges become cones, cylinders and planes, arcs become tori and spheres. Arcs whose centre lies beyond the axis are
    /// replaced by chords within 1e-6 of the larger side of the outline.
    ///
    /// # Errors
    ///
    /// [`OutlineError`]: the region reaches x < 0, or an angle is out of range.
    pub fn revolve(&self, start: f64, sweep: f64) -> Result<Solid, OutlineError> {
        if self.contours.is_empty() {
            return Ok(Solid::empty());
        }
        let [low, high] = self.bounds;
        let larger = (high[0] - low[0]).max(high[1] - low[1]);
        let turned = self.before_axis(larger)?;
        let (margin, height) = (0.25 * high[0].max(high[1] - low[1]), high[1] - low[1]);
        let rod = solid(Cylinder::new(high[0] + margin, height + 2.0 * margin))?;
        let around = rod.translate([0.0, 0.0, 0.5 * (low[1] + high[1])]).named("contour.around");
        let whole = turned.swept(&Revolved { ends: [low[1], high[1]] })? & around;
        let solid = match sweep == 360.0 {
            true => whole,
            false => whole & solid(Wedge::new(start, sweep))?.named("sides"),
        };
        Ok(solid.with_boundary(Arc::new(Revolution { outline: self.clone(), start, sweep })))
    }

    /// The outline with chords in place of arcs whose centres are at x < 0; it must not cross the axis. `larger` is the larger side of
    /// its box.
    fn before_axis(&self, larger: f64) -> Result<Outline, OutlineError> {
        let mut outline = self.clone();
        for (number, contour) in outline.contours.iter_mut().enumerate() {
            let left = contour.edges.iter().map(Edge::smallest_x).fold(f64::INFINITY, f64::min);
            if left < -AXIS_TOLERANCE * larger {
                return Err(OutlineError::Axis { contour: number, x: left });
            }
            let edges = contour.edges.iter().flat_map(|edge| match edge.arc {
                Some(arc) if arc.centre[0] < -AXIS_TOLERANCE * arc.radius => {
                    edge.chords(CHORD_TOLERANCE * larger)
                }
                _ => vec![*edge],
            });
            contour.edges = edges.collect();
        }
        Ok(outline)
    }

    /// The region as a set of space.
    fn swept(&self, sweep: &impl Sweep) -> Result<Solid, OutlineError> {
        let straight = self.contours.iter().filter(|contour| contour.circle.is_none());
        if straight.map(|contour| contour.edges.len()).sum::<usize>() > MAX_EDGES {
            return self.swept_by_cells(sweep);
        }
        let inner: Vec<Solid> =
            (0..).zip(&self.contours).map(|(k, c)| c.swept(k, sweep)).collect::<Result<_, _>>()?;
        let mut holes: Vec<Vec<Solid>> = vec![Vec::new(); inner.len()];
        for (contour, solid) in self.contours.iter().zip(&inner).filter(|(contour, _)| !contour.is_island) {
            if let Some(island) = contour.parent {
                holes[island].push(solid.clone());
            }
        }
        let islands = (0..inner.len()).filter(|k| self.contours[*k].is_island).map(|island| {
            let holes = std::mem::take(&mut holes[island]);
            match holes.is_empty() {
                true => inner[island].clone(),
                false => inner[island].clone() - Solid::union(holes),
            }
        });
        let mut islands: Vec<Solid> = islands.collect();
        Ok(if islands.len() == 1 { islands.remove(0) } else { Solid::union(islands) })
    }

    /// The region as a set of space, with one formula by cells for the chords of all contours: every ray would be intersected with all
    /// edges otherwise.
    fn swept_by_cells(&self, sweep: &impl Sweep) -> Result<Solid, OutlineError> {
        let numbers: Vec<usize> =
            (0..self.contours.len()).filter(|k| self.contours[*k].circle.is_none()).collect();
        let is_island: Vec<bool> = numbers.iter().map(|k| self.is_island_without_circles(*k)).collect();
        let contours = || numbers.iter().map(|k| &self.contours[*k]).zip(&is_island);
        let points = contours().map(|(contour, is_island)| {
            let mut points: Vec<Point> = contour.edges.iter().map(|edge| edge.from).collect();
            if !is_island {
                points.reverse();
            }
            points
        });
        let chords = from_polygons(&points.collect::<Vec<_>>(), Side::Outside).map_err(|error| {
            let origins = contours().map(|(contour, is_island)| {
                let mut origins: Vec<usize> = contour.edges.iter().map(|edge| edge.origin).collect();
                if !is_island {
                    origins.reverse();
                }
                origins
            });
            OutlineError::of_polygons(error, &origins.collect::<Vec<_>>())
        })?;
        let name =
            |index: usize, kind: &str, origin: usize| format!("contour{}.{kind}{origin}", numbers[index]);
        let wall = |half: HalfPlane| {
            let edge = chords.edge(half.edge);
            let edges = &self.contours[numbers[edge.contour]].edges;
            let from = if is_island[edge.contour] { edge.from } else { edges.len() - 1 - edge.to };
            Ok(sweep.wall(&half)?.named(&name(edge.contour, "edge", edges[from].origin)))
        };
        let cell = |cell| Ok(sweep.cell(cell)?.named("contour.cell"));
        let join = |operator: Operator, parts: Vec<Result<Solid, OutlineError>>| {
            Ok(operator.solid(parts.into_iter().collect::<Result<_, _>>()?))
        };
        let polygons = chords.fold_by_cells(wall, cell, join)?;
        let (mut added, mut removed) = (vec![polygons], Vec::new());
        for (index, (contour, is_island)) in contours().enumerate() {
            for edge in &contour.edges {
                let Some(arc) = edge.arc else { continue };
                let wall = sweep.wall(&half_plane_of(edge))?.named(&name(index, "edge", edge.origin));
                let disc = sweep.disc(arc.centre, arc.radius)?.named(&name(index, "arc", edge.origin));
                let segment = if arc.is_ccw { disc - wall } else { disc & wall };
                if arc.is_ccw == *is_island { added.push(segment) } else { removed.push(segment) }
            }
        }
        let whole = if added.len() == 1 { added.remove(0) } else { Solid::union(added) };
        let whole = if removed.is_empty() { whole } else { whole - Solid::union(removed) };
        let circles = self.contours.iter().enumerate().filter_map(|(k, contour)| Some((k, contour.circle?)));
        let mut odd = vec![whole];
        for (k, (centre, radius)) in circles {
            odd.push(sweep.disc(centre, radius)?.named(&format!("contour{k}")));
        }
        Ok(if odd.len() == 1 { odd.remove(0) } else { Solid::symmetric_difference(odd) })
    }

    /// True for a contour within an even number of contours that are not circles.
    fn is_island_without_circles(&self, contour: usize) -> bool {
        let around = std::iter::successors(self.contours[contour].parent, |k| self.contours[*k].parent);
        around.filter(|k| self.contours[*k].circle.is_none()).count() % 2 == 0
    }
}

impl Contour {
    /// The inner side of the contour as a set of space.
    fn swept(&self, number: usize, sweep: &impl Sweep) -> Result<Solid, OutlineError> {
        if let Some((centre, radius)) = self.circle {
            return Ok(sweep.disc(centre, radius)?.named(&format!("contour{number}")));
        }
        let points: Vec<Point> = self.edges.iter().map(|edge| edge.from).collect();
        let chords = from_polygons(&[points], Side::Outside).map_err(|error| {
            OutlineError::of_polygons(error, &[self.edges.iter().map(|e| e.origin).collect()])
        })?;
        let name = |kind: &str, origin: usize| format!("contour{number}.{kind}{origin}");
        let (mut problem, mut walls) = (None, vec![None; self.edges.len()]);
        let wall = |half_plane: HalfPlane| {
            let index = chords.edge(half_plane.edge).from;
            let wall = sweep.wall(&half_plane).unwrap_or_else(|error| {
                problem = Some(error);
                Solid::empty()
            });
            let wall = wall.named(&name("edge", self.edges[index].origin));
            walls[index] = Some(wall.clone());
            wall
        };
        let polygon = chords.fold(wall, Operator::solid);
        if let Some(error) = problem {
            return Err(error);
        }
        let (mut added, mut removed) = (vec![polygon], Vec::new());
        for (edge, wall) in self.edges.iter().zip(walls) {
            let Some(arc) = edge.arc else { continue };
            let wall = match wall {
                Some(wall) => wall,
                // the chord is in one line with its neighbour
                None => sweep.wall(&half_plane_of(edge))?,
            };
            let disc = sweep.disc(arc.centre, arc.radius)?.named(&name("arc", edge.origin));
            match arc.is_ccw {
                true => added.push(disc - wall),
                false => removed.push(disc & wall),
            }
        }
        let whole = if added.len() == 1 { added.remove(0) } else { Solid::union(added) };
        Ok(if removed.is_empty() { whole } else { whole - Solid::union(removed) })
    }
}

/// The half-plane to the left of a chord.
pub(super) fn half_plane_of(edge: &Edge) -> HalfPlane {
    let normal = [edge.to[1] - edge.from[1], edge.from[0] - edge.to[0]];
    let largest = normal[0].abs().max(normal[1].abs());
    // computed as in the formula of polygons, so that both are one surface
    let offset = difference_of_products(edge.from[0], edge.to[1], edge.from[1], edge.to[0]) / largest;
    HalfPlane { normal: normal.map(|x| x / largest), offset, edge: 0 }
}
