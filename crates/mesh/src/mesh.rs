//! Indexed triangle mesh: vertices and triangles, with volume, centroid, area and vertex welding.

use crate::{MeshError, triangle};
use rayweave_math::{Bounds, Vec3};
use rustc_hash::FxHashMap;

/// An indexed triangle mesh, with vertices and triangles in the given order.
///
/// Every index is in range and every coordinate is finite. There are no further guarantees: a mesh may have holes, and vertices
/// may coincide ([`Mesh::welded`]).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// Volume integrals of 1 and of the position.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    volume: f64,
    weighted: Vec3,
}

impl Mesh {
    /// The maximal magnitude of a coordinate. Products of three stay well within the range of `f64`.
    pub const MAX_COORDINATE: f64 = 1e60;
    /// Coordinates of smaller magnitude are set to 0. Products of two larger ones do not underflow.
    pub const MIN_COORDINATE: f64 = 1e-100;
    /// The maximal number of triangles, and of vertices: the limit of the indices in the bounding volume hierarchy.
    pub const MAX_TRIANGLES: usize = 1 << 28;

    /// A mesh of vertices and of triangles, given as triples of vertex indices.
    ///
    /// # Errors
    /// The first of [`MeshError::TooMany`], [`MeshError::Coordinate`] and [`MeshError::Index`] that applies.
    pub fn new(mut vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Mesh, MeshError> {
        for (what, count) in [("vertices", vertices.len()), ("triangles", triangles.len())] {
            Mesh::check_count(what, count as u64)?;
        }
        for (index, point) in vertices.iter_mut().enumerate() {
            *point = checked(index, *point)?;
        }
        let count = vertices.len();
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&vertex| vertex as usize >= count) {
                return Err(MeshError::Index { triangle, vertex: u64::from(vertex), count });
            }
        }
        Ok(Mesh { vertices, triangles })
    }

    /// Checks a number of vertices or triangles against [`Mesh::MAX_TRIANGLES`]; readers do this before they allocate.
    /// `what` is "vertices" or "triangles", for the message.
    ///
    /// # Errors
    /// [`MeshError::TooMany`].
    pub fn check_count(what: &'static str, count: u64) -> Result<(), MeshError> {
        let limit = Mesh::MAX_TRIANGLES as u64;
        if count > limit { Err(MeshError::TooMany { what, count, limit }) } else { Ok(()) }
    }

    /// The vertices.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// The triangles, as triples of vertex indices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|vertex| self.vertices[vertex as usize])
    }

    /// The unit normal of a triangle by the right-hand rule; `None` if the triangle is degenerate.
    pub fn normal(&self, triangle: usize) -> Option<Vec3> {
        Some(triangle::normal(self.corners(triangle))).filter(|normal| normal.is_finite())
    }

    /// The bounding box of all triangles; empty if there are none.
    pub fn bounds(&self) -> Bounds {
        let corners = self.triangles.iter().flatten().map(|&vertex| self.vertices[vertex as usize]);
        corners.fold(Bounds::EMPTY, |bounds, point| bounds.union(&Bounds { lo: point, hi: point }))
    }

    /// The signed volume within a closed mesh: positive if the triangles are counter-clockwise seen from outside. In cubes of the
    /// unit of length, by the divergence theorem about the centre of the bounding box.
    pub fn volume(&self) -> f64 {
        self.moments(0..self.triangles.len(), self.middle()).volume
    }

    /// The centroid of the volume ([`Mesh::volume`]); `None` if the volume is 0.
    pub fn centroid(&self) -> Option<Vec3> {
        let Moments { volume, weighted } = self.moments(0..self.triangles.len(), self.middle());
        (volume != 0.0).then(|| self.middle() + weighted / volume)
    }

    /// The total area of all triangles, in squares of the unit of length.
    pub fn area(&self) -> f64 {
        let area = |triangle| {
            let [a, b, c] = self.corners(triangle);
            0.5 * (b - a).cross(c - a).length()
        };
        (0..self.triangles.len()).map(area).sum()
    }

    /// The contribution of some of the triangles to the volume. `middle` is [`Mesh::middle`], which callers compute once.
    pub(crate) fn volume_of(&self, triangles: impl IntoIterator<Item = usize>, middle: Vec3) -> f64 {
        self.moments(triangles, middle).volume
    }

    /// Sums over the tetrahedra between triangles and the centre of the bounding box.
    fn moments(&self, triangles: impl IntoIterator<Item = usize>, middle: Vec3) -> Moments {
        let mut sums = Moments::default();
        for triangle in triangles {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - middle);
            let volume = a.dot(b.cross(c)) / 6.0;
            sums.volume += volume;
            sums.weighted += volume * 0.25 * (a + b + c);
        }
        sums
    }

    /// The centre of the bounding box.
    pub(crate) fn middle(&self) -> Vec3 {
        let bounds = self.bounds();
        if bounds.is_empty() { Vec3::ZERO } else { bounds.centre() }
    }

    /// The mesh with equal vertices merged, in order of first use. Triangles keep their order; unused vertices are dropped.
    pub fn welded(&self) -> Mesh {
        let mut welder = VertexWelder::default();
        let weld = |corners: &[u32; 3]| corners.map(|vertex| welder.index(self.vertices[vertex as usize]));
        let triangles = self.triangles.iter().map(weld).collect();
        Mesh { triangles, vertices: welder.into_vertices() }
    }

    /// The submesh of some of the triangles, with the vertices that they use, in order of first use.
    pub fn portion(&self, triangles: impl IntoIterator<Item = usize>) -> Mesh {
        let (mut numbers, mut vertices) = (FxHashMap::default(), Vec::new());
        let mut number = |vertex: u32| {
            *numbers.entry(vertex).or_insert_with(|| {
                vertices.push(self.vertices[vertex as usize]);
                (vertices.len() - 1) as u32
            })
        };
        let triangles = triangles.into_iter().map(|k| self.triangles[k].map(&mut number)).collect();
        Mesh { vertices, triangles }
    }

    /// The mesh with the orientation of selected triangles reversed.
    pub(crate) fn reversed(mut self, selected: impl Fn(usize) -> bool) -> Mesh {
        for (triangle, corners) in self.triangles.iter_mut().enumerate() {
            if selected(triangle) {
                corners.swap(1, 2);
            }
        }
        self
    }

    /// The mesh with a function applied to every vertex.
    ///
    /// # Errors
    /// [`MeshError::Coordinate`] if a coordinate leaves the range.
    pub fn mapped(&self, map: impl Fn(Vec3) -> Vec3) -> Result<Mesh, MeshError> {
        Mesh::new(self.vertices.iter().map(|&point| map(point)).collect(), self.triangles.clone())
    }

    /// The vertices and triangles.
    pub fn into_parts(self) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        (self.vertices, self.triangles)
    }
}

/// A point with coordinates in range; tiny ones become 0.
fn checked(index: usize, point: Vec3) -> Result<Vec3, MeshError> {
    // false for NaN
    if !point.to_array().iter().all(|x| (-Mesh::MAX_COORDINATE..=Mesh::MAX_COORDINATE).contains(x)) {
        return Err(MeshError::Coordinate { index, point });
    }
    // also turns -0 into 0
    Ok(Vec3::from_array(point.to_array().map(|x| if x.abs() < Mesh::MIN_COORDINATE { 0.0 } else { x })))
}

/// Table that gives equal points one index, numbered in order of first use (vertex deduplication).
#[derive(Debug, Default)]
pub struct VertexWelder {
    numbers: FxHashMap<[u64; 3], u32>,
    vertices: Vec<Vec3>,
}

impl VertexWelder {
    /// The index of a point; a point that is not in the table is added.
    pub fn index(&mut self, point: Vec3) -> u32 {
        // adding 0 turns -0 into 0
        let key = point.to_array().map(|x| (x + 0.0).to_bits());
        *self.numbers.entry(key).or_insert_with(|| {
            self.vertices.push(point);
            (self.vertices.len() - 1) as u32
        })
    }

    /// The distinct points, by index.
    pub fn into_vertices(self) -> Vec<Vec3> {
        self.vertices
    }
}
