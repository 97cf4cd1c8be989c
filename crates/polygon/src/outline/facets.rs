//! Facets of prisms and solids of revolution over outlines.
//!
//! Arcs become chords whose ends are on the arc, so that neighbouring faces have common vertices. All layers of a prism, and all
//! half-planes of a revolution, have the same chords: faces between them are trapezoids. They intersect nothing if the polygon of
//! the chords is simple in the first and in the last layer, which is verified with exact predicates.

use super::contour::{Arc, Edge};
use super::rim::{Rim, mitre_shift};
use super::{Contour, Outline};
use crate::{Point, from_polygons};
use rayweave_math::{Vec3, circle_count, sin_cos_degrees};
use rayweave_model::{Boundary, Facets, FlatFace, MAX_POINTS, Motion, Swept};
use rayweave_rootray::Side;
use std::f64::consts::PI;

/// The number of tolerances, each a quarter of the last, that are tried until the chords do not touch each other.
const TRIES: i32 = 5;

/// The distance from the axis that counts as 0, and the remainder of an arc that counts as a point, relative to the size.
const NOTHING: f64 = 1e-9;

/// A prism.
pub(super) struct Prism {
    pub outline: Outline,
    pub z: [f64; 2],
    pub rims: [Rim; 2],
}

/// A solid of revolution: angles in degrees.
pub(super) struct Revolution {
    pub outline: Outline,
    pub start: f64,
    pub sweep: f64,
}

/// A vertex of a polygon of chords.
#[derive(Clone, Copy)]
struct Corner {
    at: Point,
    /// The movement of the vertex into the material, for an inset of 1.
    inwards: Point,
    /// The centre and the radius of the convex arc that it belongs to.
    pivot: Option<(Point, f64)>,
}

impl Corner {
    fn moved(&self, inset: f64) -> Point {
        match self.pivot {
            // the movement may be infinite where there are no rims
            _ if inset == 0.0 => self.at,
            // all of the arc becomes one point, also where rounding errors differ
            Some((centre, radius)) if inset >= radius * (1.0 - NOTHING) => centre,
            _ => [self.at[0] + inset * self.inwards[0], self.at[1] + inset * self.inwards[1]],
        }
    }
}

impl Outline {
    /// The chords of all contours, with the material on the left. `widening` is the largest increase of a radius by insets.
    fn chords(&self, tolerance: f64, widening: f64) -> Option<Vec<Vec<Corner>>> {
        let chords = |contour: &Contour| {
            let mut corners = match contour.circle {
                Some((centre, radius)) => circle(contour, centre, radius, tolerance, widening)?,
                None => corners(contour, tolerance, widening)?,
            };
            if !contour.is_island {
                corners.reverse();
            }
            Some(corners)
        };
        self.contours.iter().map(chords).collect()
    }

    fn is_bent(&self) -> bool {
        self.contours.iter().flat_map(|contour| &contour.edges).any(|edge| edge.arc.is_some())
    }

    /// The chords for the first tolerance for which they are simple polygons, also with the given insets.
    fn simple_chords(&self, tolerance: f64, insets: &[f64]) -> Option<Vec<Vec<Corner>>> {
        let widening = insets.iter().copied().fold(0.0, f64::max);
        (0..TRIES).find_map(|k| {
            let contours = self.chords(tolerance * 0.25f64.powi(k), widening)?;
            let is_simple = |inset: f64| {
                let moved: Vec<Vec<Point>> = contours.iter().map(|c| distinct(c, inset)).collect();
                from_polygons(&moved, Side::Outside).is_ok_and(|all| all.contours().len() == moved.len())
            };
            insets.iter().all(|inset| is_simple(*inset)).then_some(contours)
        })
    }
}

/// The positions of the corners, without repeated ones.
fn distinct(corners: &[Corner], inset: f64) -> Vec<Point> {
    let mut points: Vec<Point> = corners.iter().map(|corner| corner.moved(inset)).collect();
    points.dedup();
    points
}

/// A circle, with the same vertices as a cylinder.
fn circle(
    contour: &Contour,
    centre: Point,
    radius: f64,
    tolerance: f64,
    widening: f64,
) -> Option<Vec<Corner>> {
    let side = if contour.is_island { -1.0 } else { 1.0 };
    let widened = if contour.is_island { radius } else { radius + widening };
    let count = circle_count(widened, tolerance)?;
    let corner = |k: usize| {
        let (sin, cos) = sin_cos_degrees(360.0 * k as f64 / count as f64);
        Corner {
            at: [centre[0] + radius * cos, centre[1] + radius * sin],
            inwards: [side * cos, side * sin],
            pivot: contour.is_island.then_some((centre, radius)),
        }
    };
    Some((0..count).map(corner).collect())
}

/// The vertices of a contour, counter-clockwise.
fn corners(contour: &Contour, tolerance: f64, widening: f64) -> Option<Vec<Corner>> {
    let side = if contour.is_island { 1.0 } else { -1.0 };
    let count = contour.edges.len();
    let convex = |edge: &Edge| edge.arc.filter(|arc| arc.is_ccw == contour.is_island);
    let pivot = |arc: Arc| (arc.centre, arc.radius);
    let mut corners = Vec::new();
    for (k, edge) in contour.edges.iter().enumerate() {
        let before = &contour.edges[(k + count - 1) % count];
        // of two arcs the smaller one shrinks to a point first
        let arcs = [convex(before), convex(edge)].into_iter().flatten();
        let smallest = arcs.min_by(|a, b| a.radius.total_cmp(&b.radius));
        let inwards = mitre_shift(before, edge).map(|x| side * x);
        corners.push(Corner { at: edge.from, inwards, pivot: smallest.map(pivot) });
        let Some(arc) = edge.arc else { continue };
        let widened = if convex(edge).is_some() { arc.radius } else { arc.radius + widening };
        let step = 2.0 * PI / circle_count(widened, tolerance)? as f64;
        for (at, outwards) in edge.inner_points(step) {
            // away from the centre of a concave arc, towards that of a convex one
            let sign = if convex(edge).is_some() { -1.0 } else { 1.0 };
            corners.push(Corner { at, inwards: outwards.map(|x| sign * x), pivot: convex(edge).map(pivot) });
        }
    }
    Some(corners)
}

/// The heights and insets of the layers of a prism, upwards.
fn layers(prism: &Prism, tolerance: f64) -> Option<Vec<[f64; 2]>> {
    let [lo, hi] = prism.z;
    let [bottom, top] = prism.rims;
    let mut layers: Vec<[f64; 2]> = Vec::new();
    for [rise, inset] in profile(bottom, tolerance)?.into_iter().rev() {
        layers.push([lo + (bottom.size() - rise), inset]);
    }
    for [rise, inset] in profile(top, tolerance)? {
        layers.push([hi - (top.size() - rise), inset]);
    }
    // the rims may meet
    layers.dedup_by(|a, b| a[1] == b[1] && a[0] - b[0] <= NOTHING * (hi - lo));
    Some(layers)
}

/// The heights above the start of a rim, and the insets there.
fn profile(rim: Rim, tolerance: f64) -> Option<Vec<[f64; 2]>> {
    Some(match rim {
        Rim::Sharp => vec![[0.0, 0.0]],
        Rim::Chamfer(size) => vec![[0.0, 0.0], [size, size]],
        Rim::Fillet(size) => {
            let count = circle_count(size, tolerance)? / 4;
            let point = |k: usize| {
                let (sin, cos) = sin_cos_degrees(90.0 * k as f64 / count as f64);
                [size * sin, size * (1.0 - cos)]
            };
            (0..=count).map(point).collect()
        }
    })
}

/// The positions of the corners of all contours.
fn polygons(contours: &[Vec<Corner>]) -> Vec<Vec<Point>> {
    contours.iter().map(|contour| distinct(contour, 0.0)).collect()
}

impl Boundary for Prism {
    fn swept(&self, tolerance: f64) -> Option<Swept> {
        if self.rims.iter().any(|rim| !matches!(rim, Rim::Sharp)) {
            return None;
        }
        let contours = self.outline.simple_chords(tolerance, &[0.0])?;
        let [lo, hi] = self.z;
        let has_chords = self.outline.is_bent();
        Some(Swept { polygons: polygons(&contours), has_chords, motion: Motion::Along { lo, hi } })
    }

    fn facets(&self, tolerance: f64) -> Option<Facets> {
        let is_rounded = self.rims.iter().any(|rim| matches!(rim, Rim::Fillet(_)));
        // faces curved in two directions use half of the tolerance in each
        let tolerance = if is_rounded { 0.5 * tolerance } else { tolerance };
        let layers = layers(self, tolerance)?;
        let insets = [0.0, self.rims[0].size(), self.rims[1].size()];
        let contours = self.outline.simple_chords(tolerance, &insets)?;
        let total: usize = contours.iter().map(Vec::len).sum();
        if total.saturating_mul(layers.len()) > MAX_POINTS {
            return None;
        }
        let mut facets = Facets::default();
        let (mut bottom, mut top) = (Vec::new(), Vec::new());
        for corners in &contours {
            let mut below: Vec<(u32, Point)> = Vec::new();
            for (number, [z, inset]) in layers.iter().enumerate() {
                let ring = ring(&mut facets, corners, *z, *inset);
                if number == 0 {
                    bottom.push(ring.clone());
                } else {
                    for k in 0..ring.len() {
                        let next = (k + 1) % ring.len();
                        quad(&mut facets, [below[k].0, below[next].0, ring[k].0, ring[next].0]);
                    }
                }
                below = ring;
            }
            top.push(below);
        }
        for (contours, is_upright) in [(bottom, false), (top, true)] {
            facets.flat.push(FlatFace { contours: contours.into_iter().map(merged).collect(), is_upright });
        }
        Some(facets)
    }
}

/// The vertices of a layer. Neighbours at the same position are one vertex.
fn ring(facets: &mut Facets, corners: &[Corner], z: f64, inset: f64) -> Vec<(u32, Point)> {
    let mut ring: Vec<(u32, Point)> = Vec::new();
    for corner in corners {
        let at = corner.moved(inset);
        match (ring.last(), ring.first()) {
            (Some(last), _) if last.1 == at => ring.push(*last),
            (_, Some(first)) if first.1 == at => ring.push(*first),
            _ => {
                ring.push((facets.points.len() as u32, at));
                facets.points.push(Vec3::new(at[0], at[1], z));
            }
        }
    }
    ring
}

/// A contour without repeated vertices.
fn merged(mut ring: Vec<(u32, Point)>) -> Vec<(u32, Point)> {
    ring.dedup_by_key(|corner| corner.0);
    while ring.len() > 1 && ring.first().map(|corner| corner.0) == ring.last().map(|corner| corner.0) {
        ring.pop();
    }
    ring
}

/// The triangles of the trapezoid between the edges a b and c d, counter-clockwise a b d c.
fn quad(facets: &mut Facets, [a, b, c, d]: [u32; 4]) {
    for [p, q, r] in [[a, b, d], [a, d, c]] {
        if p != q && q != r && r != p {
            facets.triangles.push([p, q, r]);
        }
    }
}

impl Boundary for Revolution {
    fn swept(&self, tolerance: f64) -> Option<Swept> {
        let has_chords = self.outline.is_bent();
        let contours =
            self.outline.simple_chords(if has_chords { 0.5 * tolerance } else { tolerance }, &[0.0])?;
        let mut polygons = polygons(&contours);
        // rounding may have moved a point beyond the axis
        polygons.iter_mut().flatten().for_each(|point| point[0] = point[0].max(0.0));
        let motion = Motion::About { start: self.start, sweep: self.sweep };
        Some(Swept { polygons, has_chords, motion })
    }

    fn facets(&self, tolerance: f64) -> Option<Facets> {
        let [low, high] = self.outline.bounds;
        let larger = (high[0] - low[0]).max(high[1] - low[1]);
        let tolerance = if self.outline.is_bent() { 0.5 * tolerance } else { tolerance };
        let contours = self.outline.simple_chords(tolerance, &[0.0])?;
        let reach = contours.iter().flatten().map(|corner| corner.at[0]).fold(0.0, f64::max);
        let whole = circle_count(reach, tolerance)?;
        let is_whole = self.sweep == 360.0;
        let start = if is_whole { 0.0 } else { self.start };
        // half-planes and, for a whole turn, the first one again
        let steps = libm::ceil(whole as f64 * self.sweep / 360.0).max(1.0) as usize;
        let planes = if is_whole { steps } else { steps + 1 };
        let total: usize = contours.iter().map(Vec::len).sum();
        if total.saturating_mul(planes) > MAX_POINTS {
            return None;
        }
        let turns: Vec<(f64, f64)> =
            (0..planes).map(|k| sin_cos_degrees(start + self.sweep * k as f64 / steps as f64)).collect();
        let mut facets = Facets::default();
        let (mut first, mut last) = (Vec::new(), Vec::new());
        for corners in &contours {
            let rings: Vec<Vec<u32>> = corners
                .iter()
                .map(|corner| {
                    let [r, z] = corner.at;
                    let from = facets.points.len() as u32;
                    if r <= NOTHING * larger {
                        facets.points.push(Vec3::new(0.0, 0.0, z));
                        return vec![from; planes];
                    }
                    facets.points.extend(turns.iter().map(|(sin, cos)| Vec3::new(r * cos, r * sin, z)));
                    (from..).take(planes).collect()
                })
                .collect();
            for (k, ring) in rings.iter().enumerate() {
                let next = &rings[(k + 1) % rings.len()];
                for step in 0..steps {
                    let (own, other) = (step, (step + 1) % planes);
                    quad(&mut facets, [ring[own], ring[other], next[own], next[other]]);
                }
            }
            let end = |plane: usize| rings.iter().zip(corners).map(|(ring, c)| (ring[plane], c.at)).collect();
            first.push(end(0));
            last.push(end(planes - 1));
        }
        if !is_whole {
            // r, z and the direction of the turn form a left-handed frame: the start is seen from outside as in its plane
            facets.flat.push(FlatFace { contours: first, is_upright: true });
            facets.flat.push(FlatFace { contours: last, is_upright: false });
        }
        Some(facets)
    }
}
