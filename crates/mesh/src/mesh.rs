//! Points and triangles.

use crate::MeshError;
use rayweave_math::{Bounds, Vec3};
use rustc_hash::FxHashMap;

/// Points and triangles, in the order in which they were given.
///
/// Every index is in range and every coordinate finite; nothing else is promised: a mesh may have holes, and points may
/// occur twice ([`Mesh::welded`]).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// The sums behind volume and centre.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    volume: f64,
    weighted: Vec3,
}

impl Mesh {
    /// The greatest coordinate in absolute value: products of three of them are far from the end of the range of `f64`.
    pub const MOST: f64 = 1e60;
    /// Coordinates below this are taken as 0: products of two of them keep all their digits.
    pub const LEAST: f64 = 1e-100;
    /// The most triangles of a mesh, and the most vertices: what the hierarchy can number.
    pub const MOST_TRIANGLES: usize = 1 << 28;

    /// A mesh of points and of triangles, each of which names three of the points.
    ///
    /// # Errors
    /// [`MeshError::TooMany`], [`MeshError::Coordinate`], [`MeshError::Index`]: the first that is met.
    pub fn new(mut vertices: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Mesh, MeshError> {
        for (what, count) in [("vertices", vertices.len()), ("triangles", triangles.len())] {
            check_count(what, count as u64)?;
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

    /// The points.
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// The triangles, as indices of their corners.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: usize) -> [Vec3; 3] {
        self.triangles[triangle].map(|vertex| self.vertices[vertex as usize])
    }

    /// The smallest box that holds all corners of triangles; empty if there are none.
    pub fn bounds(&self) -> Bounds {
        let corners = self.triangles.iter().flatten().map(|&vertex| self.vertices[vertex as usize]);
        corners.fold(Bounds::EMPTY, |bounds, point| bounds.union(&Bounds { lo: point, hi: point }))
    }

    /// The volume within a closed mesh whose triangles turn counter-clockwise seen from outside; negative if they turn the
    /// other way. In cubes of the unit of length, by the divergence theorem about the middle of the bounds.
    pub fn volume(&self) -> f64 {
        self.moments(0..self.triangles.len()).volume
    }

    /// The centre of the volume ([`Mesh::volume`]); `None` if that is 0.
    pub fn centroid(&self) -> Option<Vec3> {
        let Moments { volume, weighted } = self.moments(0..self.triangles.len());
        (volume != 0.0).then(|| self.middle() + weighted / volume)
    }

    /// The area of all triangles, in squares of the unit of length.
    pub fn area(&self) -> f64 {
        let area = |triangle| {
            let [a, b, c] = self.corners(triangle);
            0.5 * (b - a).cross(c - a).length()
        };
        (0..self.triangles.len()).map(area).sum()
    }

    /// The volume by some of the triangles.
    pub(crate) fn volume_of(&self, triangles: impl IntoIterator<Item = usize>) -> f64 {
        self.moments(triangles).volume
    }

    /// Sums over tetrahedra between triangles and the middle of the bounds.
    fn moments(&self, triangles: impl IntoIterator<Item = usize>) -> Moments {
        let middle = self.middle();
        let mut sums = Moments::default();
        for triangle in triangles {
            let [a, b, c] = self.corners(triangle).map(|corner| corner - middle);
            let volume = a.dot(b.cross(c)) / 6.0;
            sums.volume += volume;
            sums.weighted += volume * 0.25 * (a + b + c);
        }
        sums
    }

    fn middle(&self) -> Vec3 {
        let bounds = self.bounds();
        if bounds.is_empty() { Vec3::ZERO } else { bounds.centre() }
    }

    /// The mesh with equal points taken as one, in the order of their first use; triangles keep their numbers, unused
    /// points are dropped.
    pub fn welded(&self) -> Mesh {
        let mut welder = Welder::default();
        let weld = |corners: &[u32; 3]| corners.map(|vertex| welder.index(self.vertices[vertex as usize]));
        let triangles = self.triangles.iter().map(weld).collect();
        Mesh { triangles, vertices: welder.vertices }
    }

    /// Some of the triangles, with the points that they use, in the order of their first use.
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

    /// Triangles turned round, those of which `turn` says so.
    pub(crate) fn turned(mut self, turn: impl Fn(usize) -> bool) -> Mesh {
        for (triangle, corners) in self.triangles.iter_mut().enumerate() {
            if turn(triangle) {
                corners.swap(1, 2);
            }
        }
        self
    }

    /// The mesh with every point moved, say by a map.
    ///
    /// # Errors
    /// [`MeshError::Coordinate`] if a point is no longer in range.
    pub fn mapped(&self, map: impl Fn(Vec3) -> Vec3) -> Result<Mesh, MeshError> {
        Mesh::new(self.vertices.iter().map(|&point| map(point)).collect(), self.triangles.clone())
    }

    /// Points and triangles.
    pub fn into_parts(self) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        (self.vertices, self.triangles)
    }
}

/// Refuses more than can be numbered, before anything is allocated.
pub(crate) fn check_count(what: &'static str, count: u64) -> Result<(), MeshError> {
    let limit = Mesh::MOST_TRIANGLES as u64;
    if count > limit { Err(MeshError::TooMany { what, count, limit }) } else { Ok(()) }
}

/// A point whose coordinates can be computed with.
fn checked(index: usize, point: Vec3) -> Result<Vec3, MeshError> {
    // NaN is in no range
    if !point.to_array().iter().all(|x| (-Mesh::MOST..=Mesh::MOST).contains(x)) {
        return Err(MeshError::Coordinate { index, point });
    }
    // also makes one zero of the two
    Ok(Vec3::from_array(point.to_array().map(|x| if x.abs() < Mesh::LEAST { 0.0 } else { x })))
}

/// Numbers points in the order in which they are met, equal ones alike.
#[derive(Debug, Default)]
pub(crate) struct Welder {
    numbers: FxHashMap<[u64; 3], u32>,
    pub vertices: Vec<Vec3>,
}

impl Welder {
    /// The number of a point.
    pub fn index(&mut self, point: Vec3) -> u32 {
        // adding 0 makes one zero of the two
        let key = point.to_array().map(|x| (x + 0.0).to_bits());
        *self.numbers.entry(key).or_insert_with(|| {
            self.vertices.push(point);
            (self.vertices.len() - 1) as u32
        })
    }
}
