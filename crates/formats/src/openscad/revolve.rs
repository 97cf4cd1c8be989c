//! Rotate extrusion (`rotate_extrude`): solids of revolution about the z axis. Edges become cones, cylinders and planes,
//! discs become tori.

use super::arguments::{Arguments, Refusal};
use super::boolean::join_solids;
use super::budget::CORNER;
use super::extrude::{formula, odd};
use super::facets::Fineness;
use super::flat::{Flat, Flats, Leaf, simple};
use super::operation::Operation;
use super::part::solid;
use super::region::{Contours, boundary, filled, placed, size_of_leaves};
use i_overlay::core::fill_rule::FillRule;
use rayweave_math::{Affine, Vec3, sin_cos_degrees, unit_vector_degrees};
use rayweave_model::Solid;
use rayweave_polygon::{HalfPlane, Point, near_cylinder};
use rayweave_shape::primitive::{BoxFromCorners, Cylinder, HalfSpace, Quadric, Sphere, Torus, Wedge};

/// Distance by which a region may cross the axis because of rounding, relative to its size.
const OVER: f64 = 1e-6;

/// A rotate extrusion of a region.
pub(super) struct Turn<'a> {
    pub arguments: &'a Arguments<'a>,
    pub facets: bool,
    /// Parts that are not exact.
    pub approximations: Vec<&'static str>,
    /// Angle of revolution in degrees from `start`, positive.
    angle: f64,
    start: f64,
    /// Map of the region to the side of positive x.
    map: Affine,
    /// Largest distance from the axis; `ends`: lowest and highest z.
    reach: f64,
    ends: [f64; 2],
    /// Size of all leaves of the region, the reference for rounding errors.
    size: f64,
}

impl<'a> Turn<'a> {
    /// The extrusion of a region; `None` if it is empty or the angle is 0.
    pub fn new(
        arguments: &'a Arguments<'a>,
        facets: bool,
        flats: &Flats,
        flat: Flat,
    ) -> Result<Option<Turn<'a>>, Refusal> {
        let angle = arguments.number("angle", 360.0)?;
        let [mut lo, mut hi] = flats.bounds(arguments, flat)?;
        if angle == 0.0 || lo[0] >= hi[0] || lo[1] >= hi[1] {
            return Ok(None);
        }
        let over = OVER * (hi[0] - lo[0]);
        if lo[0] < -over && hi[0] > over {
            // leaves may cross the axis even if the region itself does not
            match corner_bounds(&boundary(arguments, flats, flat)?) {
                Some(bounds) => [lo, hi] = bounds,
                None => return Ok(None),
            }
            // the boundary is made of chords, but the solid is not
            flats.has_chords.take();
        }
        let is_turned = hi[0] <= over;
        if lo[0] < -over && !is_turned {
            return Err(arguments.refusal("the region lies on both sides of the axis"));
        }
        let is_whole = angle.abs() >= 360.0;
        // OpenSCAD starts a full turn at 180 degrees
        let start = arguments.number("start", if is_whole { 180.0 } else { 0.0 })?;
        let (map, start) = match is_turned {
            true => (Affine::scale(Vec3::new(-1.0, 1.0, 1.0)), start + 180.0),
            false => (Affine::IDENTITY, start),
        };
        let start = if angle < 0.0 { start + angle.max(-360.0) } else { start };
        Ok(Some(Turn {
            arguments,
            facets,
            approximations: Vec::new(),
            angle: angle.abs().min(360.0),
            start,
            map,
            reach: hi[0].max(-lo[0]),
            ends: [lo[1], hi[1]],
            size: size_of_leaves(arguments, flats, flat)?,
        }))
    }

    pub fn solid(&mut self, flats: &Flats, flat: Flat) -> Result<Solid, Refusal> {
        if self.facets {
            return self.sectors(flats, flat);
        }
        let turned = flats.fold(
            self.arguments,
            flat,
            |leaf, map| self.leaf(leaf, map),
            |operation, parts| Ok(join_solids(operation, parts)),
        )?;
        let bounds = self.around()?;
        Ok(match self.angle < 360.0 {
            true => turned & bounds & solid(self.arguments, Wedge::new(self.start, self.angle))?,
            false => turned & bounds,
        })
    }

    /// A cylinder around the solid, with a margin on all sides.
    fn around(&self) -> Result<Solid, Refusal> {
        let [lo, hi] = self.ends;
        let margin = 0.25 * self.reach.max(hi - lo);
        let rod = solid(self.arguments, Cylinder::new(self.reach + margin, hi - lo + 2.0 * margin))?;
        Ok(rod.translate([0.0, 0.0, 0.5 * (lo + hi)]))
    }

    fn leaf(&mut self, leaf: &Leaf, map: &Affine) -> Result<Solid, Refusal> {
        self.arguments.spend(5 * CORNER)?;
        let map = map.then(&self.map);
        if let Leaf::Disc { radius, .. } = leaf {
            match plane_similarity(&map) {
                Some(factor) => return self.ring(factor * radius, &map),
                None => self.approximations.push("uses the facets of an ellipse"),
            }
        }
        let (arguments, ends) = (self.arguments, self.ends);
        self.contours(leaf, &map, |half_plane| turned_edge(arguments, &half_plane, ends))
    }

    /// The contours of a mapped leaf, each as a formula of half-planes.
    fn contours(
        &self,
        leaf: &Leaf,
        map: &Affine,
        mut wall: impl FnMut(HalfPlane) -> Result<Solid, Refusal>,
    ) -> Result<Solid, Refusal> {
        self.arguments.spend(CORNER * (3 + leaf.point_count()))?;
        let mut contours = placed(self.arguments, leaf.contours(), map, self.size)?;
        if contours.iter().any(|contour| simple(self.arguments, contour.clone()).is_err()) {
            contours = filled(self.arguments, &contours, FillRule::EvenOdd)?;
        }
        let mut parts = Vec::new();
        for contour in contours {
            if let Some(polygons) = simple(self.arguments, contour)? {
                parts.push(formula(&polygons, &mut wall)?);
            }
        }
        Ok(odd(parts))
    }

    /// A torus: a disc revolved about the axis.
    fn ring(&self, radius: f64, map: &Affine) -> Result<Solid, Refusal> {
        let (distance, height) = (map.translation.x, map.translation.y);
        let ring = match distance.abs() <= OVER * radius {
            true => solid(self.arguments, Sphere::new(radius))?,
            false if distance > 0.0 => solid(self.arguments, Torus::new(distance, radius))?,
            false if distance + radius <= 0.0 => return Ok(Solid::empty()),
            false => return Err(self.arguments.refusal("the centre of a disc lies beyond the axis")),
        };
        Ok(ring.translate([0.0, 0.0, height]))
    }

    /// Faceted revolution as in OpenSCAD: equal sectors, with a straight extrusion of the region in each.
    fn sectors(&mut self, flats: &Flats, flat: Flat) -> Result<Solid, Refusal> {
        let full = Fineness::of(self.arguments)?.fragments(self.reach) as f64;
        let count = (full * self.angle / 360.0).floor().max(1.0);
        let step = self.angle / count;
        let (half_sin, half_cos) = sin_cos_degrees(0.5 * step);
        if half_cos <= 0.0 {
            return Err(self.arguments.refusal("one facet would turn by 180 degrees or more"));
        }
        let arguments = self.arguments;
        let wall = |half_plane: HalfPlane| {
            let ([a, b], c) = (half_plane.normal, half_plane.offset);
            let normal = Vec3::new(a, a * half_sin / half_cos, b);
            solid(arguments, HalfSpace::new(normal, c))
        };
        let sector = flats.fold(
            arguments,
            flat,
            |leaf, map| self.contours(leaf, &map.then(&self.map), wall),
            |operation: Operation, parts| Ok(join_solids(operation, parts)),
        )?;
        let maps: Vec<Affine> =
            (0..count as usize).map(|k| Affine::rotation(Vec3::Z, self.start + step * k as f64)).collect();
        Ok((sector & self.slice(step)?).place(maps))
    }

    /// The wedge between the half-planes at 0 and `step` degrees, cut by a box.
    fn slice(&self, step: f64) -> Result<Solid, Refusal> {
        let end = unit_vector_degrees(step + 90.0);
        let [lo, hi] = self.ends;
        let margin = 0.01 * self.reach.max(hi - lo);
        let far = self.reach + margin;
        // a narrow sector gets a narrow box, which most rays miss
        let (sin, cos) = sin_cos_degrees(step);
        let [left, up] = if cos > 0.0 { [-margin, far * sin + margin] } else { [-far, far] };
        let corners = [Vec3::new(left, -margin, lo - margin), Vec3::new(far, up, hi + margin)];
        Ok(Solid::intersection([
            solid(self.arguments, HalfSpace::new(Vec3::NEG_Y, 0.0))?,
            solid(self.arguments, HalfSpace::new(end, 0.0))?,
            solid(self.arguments, BoxFromCorners::new(corners[0], corners[1]))?,
        ]))
    }
}

/// Lowest and highest coordinates; `None` if there are no points.
fn corner_bounds(contours: &Contours) -> Option<[Point; 2]> {
    let mut points = contours.iter().flatten();
    let first = *points.next()?;
    let grown =
        |[lo, hi]: [Point; 2], p: &Point| [[0, 1].map(|k| lo[k].min(p[k])), [0, 1].map(|k| hi[k].max(p[k]))];
    Some(points.fold([first, first], grown))
}

/// Scale factor of a plane similarity map, which keeps discs round.
pub(super) fn plane_similarity(map: &Affine) -> Option<f64> {
    let (x, y) = (map.linear.x_axis, map.linear.y_axis);
    let (length, other) = (libm::hypot(x.x, x.y), libm::hypot(y.x, y.y));
    // tolerance: matrices are printed with six digits
    let near = |a: f64, b: f64| (a - b).abs() <= 1e-5 * length.max(other);
    let inner = (x.x * y.x + x.y * y.y) / length.max(other);
    (near(length, other) && near(inner, 0.0)).then_some(0.5 * (length + other))
}

/// The set `a r + b z < c` with r the distance from the axis, between two heights: inside or outside of a cylinder, of one nappe of
/// a cone, or of a slab.
fn turned_edge(arguments: &Arguments, half_plane: &HalfPlane, ends: [f64; 2]) -> Result<Solid, Refusal> {
    let ([a, b], c) = (half_plane.normal, half_plane.offset);
    if a == 0.0 {
        return solid(arguments, HalfSpace::new(Vec3::new(0.0, 0.0, b), c));
    }
    let (slope, radius) = (-b / a, c / a);
    let distant = near_cylinder(slope, radius, ends);
    let inner = match distant.map_err(|error| arguments.refusal(&error.to_string()))? {
        Some(inner) => inner,
        None => within(arguments, slope, radius)?,
    };
    // for a < 0 it is r > (-b z + c) / a
    Ok(if a < 0.0 { !inner } else { inner })
}

/// The points with `r < slope z + radius`.
fn within(arguments: &Arguments, slope: f64, radius: f64) -> Result<Solid, Refusal> {
    if slope == 0.0 {
        return match radius > 0.0 {
            true => solid(arguments, Cylinder::new(radius, f64::INFINITY)),
            false => Ok(Solid::empty()),
        };
    }
    // r^2 < (slope z + radius)^2 on the side of the apex where the right side is positive
    let (zz, z) = (-slope * slope, -slope * radius);
    let matrix =
        [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, zz, z], [0.0, 0.0, z, -radius * radius]];
    let nappe = HalfSpace::new(Vec3::new(0.0, 0.0, -slope), radius);
    Ok(solid(arguments, Quadric::new(matrix))? & solid(arguments, nappe)?)
}
