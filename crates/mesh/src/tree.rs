//! The bounding volume hierarchy over the triangles of a mesh, with margins for the errors of lines and points.

use crate::{Line, Mesh};
use rayweave_bvh::Bvh;
use rayweave_math::{Bounds, UNIT_ROUNDOFF, Vec3};
use std::ops::Range;

/// Maximum number of triangles in a leaf.
const LEAF: usize = 4;

/// Growth of boxes in units of half the mesh size, in addition to the growth for rounding errors.
const MARGIN: f64 = 1.05e-6;

/// A BVH over the triangles of a mesh, which are reordered.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct TriangleTree {
    tree: Bvh<LEAF>,
    middle: Vec3,
    half: f64,
    magnitude: f64,
}

impl TriangleTree {
    /// Builds the tree; also returns the order of the triangles in it.
    pub fn new(mesh: &Mesh) -> (TriangleTree, Vec<u32>) {
        let bounds = mesh.bounds();
        let middle = if bounds.is_empty() { Vec3::ZERO } else { bounds.centre() };
        let size = if bounds.is_empty() { 0.0 } else { 0.5 * bounds.size().max_element() };
        let half = if size > 0.0 { size } else { 1.0 };
        let bounds_of = |k| crate::triangle::bounds(mesh.corners(k));
        let boxes: Vec<Bounds> = (0..mesh.triangles().len()).map(bounds_of).collect();
        let (tree, order) = Bvh::of_clusters(&boxes);
        (TriangleTree { tree, middle, half, magnitude: middle.length() + 2.0 * half }, order)
    }

    /// Upper bound of the distance of a point of the mesh from the origin.
    pub fn magnitude(&self) -> f64 {
        self.magnitude
    }

    /// Size in bytes.
    pub fn bytes(&self) -> usize {
        self.tree.bytes()
    }

    /// The times between which the line is in a ball around the mesh, slightly enlarged; `None` if it misses
    /// the ball.
    pub fn chord(&self, line: &Line) -> Option<(f64, f64)> {
        let time = line.closest_time(self.middle);
        let distance = (line.at(time) - self.middle).length();
        let radius = 1.75 * self.half + self.slack(line.origin);
        // NaN proves nothing: the line is traced
        if distance > radius {
            return None;
        }
        let half = radius / line.direction.length();
        Some((time - half, time + half))
    }

    /// Upper bound of the error of a point near the mesh that is computed from a point or from the origin of a
    /// line.
    fn slack(&self, from: Vec3) -> f64 {
        64.0 * UNIT_ROUNDOFF * (from.length() + self.magnitude)
    }

    /// Calls `visit` with ranges of triangles, in the order of the tree, that include every triangle close to
    /// the line.
    ///
    /// A triangle that the line misses, visited because of its neighbours in a leaf, can shift a line that lies in its
    /// plane ([`Polyhedron::crossings`](crate::Polyhedron::crossings)). A different division into leaves can therefore
    /// change times by rounding errors.
    pub fn traverse(&self, line: &Line, visit: impl FnMut(Range<usize>)) {
        if self.chord(line).is_none() {
            return;
        }
        let margin = MARGIN * self.half + self.slack(line.origin);
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        self.tree.traverse(&self.tree.probe(line.origin, line.direction, margin, all), visit);
    }

    /// Calls `visit` with ranges of triangles that include every triangle whose box intersects this one.
    pub fn within(&self, bounds: &Bounds, visit: impl FnMut(Range<usize>)) {
        self.tree.overlapping(bounds, MARGIN * self.half, visit);
    }

    /// Calls `visit` with ranges of triangles and the squared distance within which triangles still count;
    /// `visit` returns a new one. Ends when no unvisited box is nearer to the point than that.
    pub fn around(&self, point: Vec3, within: f64, visit: impl FnMut(Range<usize>, f64) -> f64) {
        self.tree.nearest(point, MARGIN * self.half + self.slack(point), within, visit);
    }
}
