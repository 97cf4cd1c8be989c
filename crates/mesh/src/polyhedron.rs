//! The solid within a closed mesh: crossings of lines, point containment, nearest triangle.

use crate::diagnosis::shells::Shells;
use crate::line::{Line, MeshCrossing, Perturbation, Shear, contains_origin, is_edge_on};
use crate::shift::Shift;
use crate::topology::{HalfEdge, ParityUnionFind, by_edge, half_edges};
use crate::tree::TriangleTree;
use crate::triangle::{self, Triangle};
use crate::{Diagnosis, Mesh, MeshError};
use rayweave_math::{Bounds, Vec3};

/// The solid within a closed mesh, by the even-odd rule.
///
/// Immutable; queries do not fail. Memory is proportional to the number of triangles: 57 bytes per triangle
/// for a torus of a million ([`Polyhedron::bytes`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Polyhedron {
    vertices: Vec<Vec3>,
    /// Triangles in the order of the tree, as in the fields below unless stated otherwise.
    triangles: Vec<[u32; 3]>,
    /// The index in the input mesh of each triangle.
    numbers: Vec<u32>,
    /// The position in `triangles` of each triangle of the input mesh.
    places: Vec<u32>,
    /// For each triangle the largest one that is connected to it within its plane, and whose plane is used
    /// for all of them.
    faces: Vec<u32>,
    /// Whether each triangle is counter-clockwise seen from outside.
    outward: Vec<bool>,
    tree: TriangleTree,
    bounds: Bounds,
}

impl Default for Polyhedron {
    /// The empty solid.
    fn default() -> Polyhedron {
        let (tree, numbers) = TriangleTree::new(&Mesh::default());
        Polyhedron {
            vertices: Vec::new(),
            triangles: Vec::new(),
            places: Vec::new(),
            faces: Vec::new(),
            outward: Vec::new(),
            bounds: Bounds::EMPTY,
            numbers,
            tree,
        }
    }
}

/// The point of a mesh that is nearest to a given point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The point on the mesh.
    pub point: Vec3,
    /// A triangle that contains it, by its index in the mesh.
    pub triangle: u32,
}

/// The number of triangles with which the lines that orient shells, or determine their depths, may be compared.
pub(crate) const MAX_COMPARISONS: usize = 50_000_000;

/// A line prepared for intersection with triangles.
struct Query {
    shear: Shear,
    /// The line, possibly shifted by the perturbation.
    line: Line,
    /// The original line, to which times refer.
    timed: Line,
    /// The tolerance within which a triangle counts as parallel to the line; negative if the line was already
    /// shifted.
    delta: f64,
}

impl Mesh {
    /// True if the mesh is not empty and each edge has an even number of triangles, as [`Polyhedron::new`]
    /// requires.
    pub fn is_closed(&self) -> bool {
        let mesh = self.welded();
        check_closed(&mesh, &half_edges(&mesh)).is_ok()
    }
}

impl Polyhedron {
    /// The solid within a mesh. Equal points count as one; triangles with two equal corners are ignored.
    ///
    /// # Errors
    /// [`MeshError::Empty`] if no triangle is left, [`MeshError::Open`] if an edge has an odd number of triangles.
    pub fn new(mesh: &Mesh) -> Result<Polyhedron, MeshError> {
        let mesh = mesh.welded();
        let half_edges = half_edges(&mesh);
        check_closed(&mesh, &half_edges)?;
        let face_of = faces(&mesh, &half_edges);
        let shells = Shells::new(&mesh, &half_edges);
        drop(half_edges);
        let (tree, numbers) = TriangleTree::new(&mesh);
        let mut places = vec![0; numbers.len()];
        for (place, &number) in numbers.iter().enumerate() {
            places[number as usize] = place as u32;
        }
        let faces = numbers.iter().map(|&number| places[face_of[number as usize] as usize]).collect();
        let bounds = mesh.bounds();
        let (vertices, triangles) = in_order(&mesh, &numbers);
        let outward = Vec::new();
        let mut solid = Polyhedron { vertices, triangles, numbers, places, faces, outward, tree, bounds };
        solid.outward = solid.orientations(&shells);
        Ok(solid)
    }

    /// The solid within a mesh that was diagnosed.
    ///
    /// # Errors
    /// As [`Polyhedron::new`], and [`MeshError::Flat`] if the mesh encloses no volume.
    pub fn closed(mesh: &Mesh, diagnosis: &Diagnosis) -> Result<Polyhedron, MeshError> {
        if diagnosis.is_flat { Err(MeshError::Flat) } else { Polyhedron::new(mesh) }
    }

    /// Determines which triangles are counter-clockwise seen from outside, by one line through each shell. When these lines have
    /// been compared with [`MAX_COMPARISONS`] triangles, the lines of earlier shells decide for those that they crossed, so that many shells
    /// behind each other do not take quadratic time.
    /// For shells that intersect others, or are one-sided, the result holds only for some of the triangles.
    fn orientations(&self, shells: &Shells) -> Vec<bool> {
        let mut outward: Vec<Option<bool>> = vec![None; shells.count()];
        let mut crossed: Vec<Option<bool>> = vec![None; shells.count()];
        let largest = shells.largest(|triangle| {
            triangle::cross(self.corners(self.places[triangle as usize] as usize)).length_squared()
        });
        let (mut left, mut found) = (MAX_COMPARISONS, Vec::new());
        for (shell, &triangle) in largest.iter().enumerate() {
            if left == 0 && crossed[shell].is_some() {
                outward[shell] = crossed[shell];
                continue;
            }
            let Some(line) = self.line_through(triangle) else { continue };
            let compared = self.crossings(&line, &[Vec3::ONE, Vec3::X, Vec3::Y, Vec3::Z], &mut found);
            left = left.saturating_sub(compared);
            for (rank, crossing) in found.iter().enumerate() {
                let other = shells.component_of[crossing.triangle as usize] as usize;
                if crossed[other].is_none() {
                    // the line enters at even ranks, against the normal that points outwards
                    let along = triangle::normal(self.triangle(crossing.triangle)).dot(line.direction) > 0.0;
                    crossed[other] =
                        Some(along ^ (rank % 2 == 0) ^ shells.is_flipped[crossing.triangle as usize]);
                }
            }
            // along its normal the line leaves the solid
            let rank = found.iter().position(|crossing| crossing.triangle == triangle);
            outward[shell] = rank.map(|rank| (rank % 2 == 1) ^ shells.is_flipped[triangle as usize]);
        }
        let of = |&number: &u32| {
            let outward = outward[shells.component_of[number as usize] as usize].unwrap_or(true);
            outward ^ shells.is_flipped[number as usize]
        };
        self.numbers.iter().map(of).collect()
    }

    /// The line along the normal of a triangle through its centroid; `None` if the triangle is degenerate.
    fn line_through(&self, triangle: u32) -> Option<Line> {
        let corners = self.triangle(triangle);
        let line = Line { origin: triangle::middle(corners), direction: triangle::normal(corners) };
        line.direction.is_finite().then_some(line)
    }

    /// The mesh in its original order, with equal points merged.
    pub fn to_mesh(&self) -> Mesh {
        let mut triangles = vec![[0; 3]; self.triangles.len()];
        for (&number, &corners) in self.numbers.iter().zip(&self.triangles) {
            triangles[number as usize] = corners;
        }
        Mesh::new(self.vertices.clone(), triangles).unwrap_or_default().welded()
    }

    /// The volume within rounding: see [`Diagnosis::volume`], which takes O(n log n) time for n triangles.
    pub fn volume(&self) -> Option<f64> {
        self.to_mesh().diagnose().volume()
    }

    /// The number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Size in bytes.
    pub fn bytes(&self) -> usize {
        let per_triangle = size_of::<[u32; 3]>() + 3 * size_of::<u32>() + size_of::<bool>();
        self.vertices.len() * size_of::<Vec3>() + self.triangles.len() * per_triangle + self.tree.bytes()
    }

    /// The bounding box.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// Upper bound of the distance of its points from the origin.
    pub fn magnitude(&self) -> f64 {
        self.tree.magnitude()
    }

    /// Finds the crossings of a line with the boundary, at all times, in order of time: an even number.
    ///
    /// The time of a crossing is that of the plane of its face, clamped to the range of the triangle's
    /// corners. A line that lies in faces, within [`Line::delta`] along its chord of the ball around the
    /// mesh, is shifted by a few such distances out of them (see `shift.rs`), so that the whole line is on the side to which
    /// `perturbation` leads. At edges and vertices symbolic perturbation puts the
    /// line on one side, the same for all triangles (`contains_origin`).
    ///
    /// `found` is cleared first. Returns the number of triangles with which the line was compared.
    pub fn crossings(
        &self,
        line: &Line,
        perturbation: &Perturbation,
        found: &mut Vec<MeshCrossing>,
    ) -> usize {
        self.crossings_with(line, perturbation, 0.0, found)
    }

    /// [`Polyhedron::crossings`] of a line that was mapped into the frame of the mesh: `lengths` is added to the magnitude of
    /// the mesh for the rounding of these maps.
    pub fn crossings_with(
        &self,
        line: &Line,
        perturbation: &Perturbation,
        lengths: f64,
        found: &mut Vec<MeshCrossing>,
    ) -> usize {
        found.clear();
        let Some(chord) = self.tree.chord(line) else {
            return 0;
        };
        let far = chord.0.abs().max(chord.1.abs());
        let delta = line.delta(if far.is_finite() { far } else { 0.0 }, self.magnitude() + lengths);
        let (shift, mut compared) = self.gather(
            &Query { shear: Shear::new(line), line: *line, timed: *line, delta },
            chord,
            perturbation,
            found,
        );
        let shift = shift.vector();
        if shift != Vec3::ZERO {
            found.clear();
            let moved = Line { origin: line.origin + shift, ..*line };
            let again = Query { shear: Shear::new(&moved), line: moved, timed: *line, delta: -1.0 };
            compared += self.gather(&again, chord, perturbation, found).1;
        }
        found.sort_unstable_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        compared
    }

    /// Appends the crossings of a line, in no order. Returns the shift that moves the line out of all faces in which it lies, and
    /// the number of triangles with which the line was compared.
    fn gather(
        &self,
        query: &Query,
        chord: (f64, f64),
        perturbation: &Perturbation,
        found: &mut Vec<MeshCrossing>,
    ) -> (Shift, usize) {
        let (mut shift, mut compared) = (Shift::default(), 0);
        self.tree.traverse(&query.line, |range| {
            compared += range.len();
            for place in range {
                let corners = self.corners(place);
                let images = corners.map(|corner| query.shear.image(corner));
                if contains_origin(images) {
                    let t = self.time(place, &query.timed);
                    found.push(MeshCrossing { t, triangle: self.numbers[place] });
                }
                if query.delta >= 0.0
                    && is_edge_on(images, query.delta)
                    && let Some(normal) = self.face_around(place, query, chord)
                {
                    shift.add(normal, perturbation, query.delta);
                }
            }
        });
        (shift, compared)
    }

    /// The normal of the face of a triangle if a line lies in its plane.
    fn face_around(&self, place: usize, query: &Query, chord: (f64, f64)) -> Option<Vec3> {
        let [corner, ..] = self.corners(self.faces[place] as usize);
        let normal = self.face_normal(place);
        let lies = |t: f64| normal.dot(query.line.at(t) - corner).abs() <= query.delta;
        (lies(chord.0) && lies(chord.1)).then_some(normal)
    }

    /// The time at which a line crosses the plane of a triangle's face, clamped to the range of the
    /// triangle's corners.
    fn time(&self, place: usize, line: &Line) -> f64 {
        let face = self.corners(self.faces[place] as usize);
        let t = plane_time(face, line);
        let times = self.corners(place).map(|corner| line.closest_time(corner));
        let (first, last) = (times[0].min(times[1]).min(times[2]), times[0].max(times[1]).max(times[2]));
        // NaN, from a line parallel to the plane, becomes the first
        if t >= first { t.min(last) } else { first }
    }

    /// True if a point is inside, by the crossings of a line through it. A point on the boundary counts as
    /// moved along `perturbation`.
    pub fn contains(&self, point: Vec3, perturbation: &Perturbation) -> bool {
        self.contains_with(point, perturbation, &mut Vec::new())
    }

    /// Like [`Polyhedron::contains`], with a reusable buffer for repeated calls.
    pub fn contains_with(
        &self,
        point: Vec3,
        perturbation: &Perturbation,
        found: &mut Vec<MeshCrossing>,
    ) -> bool {
        if !self.bounds.contains(point) {
            return false;
        }
        self.crossings(&Line { origin: point, direction: perturbation[0] }, perturbation, found);
        found.iter().filter(|crossing| crossing.t > 0.0).count() % 2 == 1
    }

    /// The point of the mesh nearest to a given point, if it is nearer than `within`.
    pub fn nearest(&self, point: Vec3, within: f64) -> Option<Nearest> {
        let mut best: Option<Nearest> = None;
        self.tree.around(point, within * within, |range, mut within| {
            for place in range {
                let on_triangle = triangle::closest_point(self.corners(place), point);
                let distance = (on_triangle - point).length_squared();
                let triangle = self.numbers[place];
                let ties = distance == within && best.is_some_and(|best| triangle < best.triangle);
                if distance < within || ties {
                    within = distance;
                    best = Some(Nearest { point: on_triangle, triangle });
                }
            }
            within
        });
        best
    }

    /// The unit normal of the plane of a triangle, by the right-hand rule; NaN if the corners are collinear.
    pub fn normal(&self, triangle: u32) -> Vec3 {
        self.face_normal(self.places[triangle as usize] as usize)
    }

    /// The outward unit normal of a triangle; NaN if the corners are collinear. (Where shells intersect each
    /// other it may point inward.)
    pub fn outward_normal(&self, triangle: u32) -> Vec3 {
        let place = self.places[triangle as usize] as usize;
        // the triangle that represents the face may have the opposite orientation
        let normal = self.face_normal(place);
        let own = triangle::cross(self.corners(place));
        if (normal.dot(own) >= 0.0) == self.outward[place] { normal } else { -normal }
    }

    /// The distance of a point from a triangle.
    pub fn distance_from(&self, triangle: u32, point: Vec3) -> f64 {
        let corners = self.corners(self.places[triangle as usize] as usize);
        (triangle::closest_point(corners, point) - point).length()
    }

    /// The corners of a triangle.
    pub fn triangle(&self, number: u32) -> [Vec3; 3] {
        self.corners(self.places[number as usize] as usize)
    }

    /// The index of the largest triangle that is connected to this one within its plane, exactly.
    pub fn face(&self, triangle: u32) -> u32 {
        self.numbers[self.faces[self.places[triangle as usize] as usize] as usize]
    }

    /// Calls `visit` with the indices of all triangles nearer to a point than `distance`.
    pub fn triangles_within(&self, point: Vec3, distance: f64, mut visit: impl FnMut(u32)) {
        let within = distance * distance;
        self.tree.around(point, within, |range, within| {
            for place in range {
                let nearest = triangle::closest_point(self.corners(place), point);
                if (nearest - point).length_squared() < within {
                    visit(self.numbers[place]);
                }
            }
            within
        });
    }

    /// The times between which a line is in the ball around the mesh; `None` if it misses the ball.
    pub fn chord(&self, line: &Line) -> Option<(f64, f64)> {
        self.tree.chord(line)
    }

    fn corners(&self, place: usize) -> Triangle {
        self.triangles[place].map(|vertex| self.vertices[vertex as usize])
    }

    fn face_normal(&self, place: usize) -> Vec3 {
        triangle::normal(self.corners(self.faces[place] as usize))
    }
}

/// Reorders the triangles, and their vertices by first use, so that neighbours are close in memory.
fn in_order(mesh: &Mesh, numbers: &[u32]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut new = vec![u32::MAX; mesh.vertices().len()];
    let mut vertices = Vec::with_capacity(new.len());
    let mut renumbered = |vertex: u32| {
        let number = &mut new[vertex as usize];
        if *number == u32::MAX {
            *number = vertices.len() as u32;
            vertices.push(mesh.vertices()[vertex as usize]);
        }
        *number
    };
    let triangles = numbers.iter().map(|&k| mesh.triangles()[k as usize].map(&mut renumbered)).collect();
    (vertices, triangles)
}

/// The time at which a line crosses the plane of a triangle. All triangles in a plane perpendicular to an
/// axis give the same time.
fn plane_time(triangle: Triangle, line: &Line) -> f64 {
    let cross = triangle::cross(triangle);
    let away = triangle[0] - line.origin;
    if let Some(axis) = (0..3).find(|&k| cross[(k + 1) % 3] == 0.0 && cross[(k + 2) % 3] == 0.0) {
        return away[axis] / line.direction[axis];
    }
    // the product of two areas may overflow
    let cross = cross / cross.abs().max_element();
    cross.dot(away) / cross.dot(line.direction)
}

/// Rejects a mesh that has an edge with an odd number of triangles.
fn check_closed(mesh: &Mesh, half_edges: &[HalfEdge]) -> Result<(), MeshError> {
    let mut open = by_edge(half_edges).filter(|edge| edge.len() % 2 == 1);
    let Some(first) = open.next() else {
        return if half_edges.is_empty() { Err(MeshError::Empty) } else { Ok(()) };
    };
    let [a, b] = first[0].ends.map(|vertex| mesh.vertices()[vertex as usize]);
    Err(MeshError::Open { edges: 1 + open.count(), at: 0.5 * (a + b) })
}

/// For each triangle the largest one that is connected to it within one plane, exactly.
fn faces(mesh: &Mesh, half_edges: &[HalfEdge]) -> Vec<u32> {
    let mut sets = ParityUnionFind::new(mesh.triangles().len());
    for edge in by_edge(half_edges) {
        for pair in edge.windows(2).filter(|pair| are_coplanar(mesh, pair)) {
            sets.union(pair[0].triangle, pair[1].triangle, false);
        }
    }
    let area = |triangle: u32| triangle::cross(mesh.corners(triangle as usize)).length_squared();
    let mut largest: Vec<u32> = (0..mesh.triangles().len() as u32).collect();
    for triangle in 0..largest.len() as u32 {
        let (set, _) = sets.find(triangle);
        if area(triangle) > area(largest[set as usize]) {
            largest[set as usize] = triangle;
        }
    }
    (0..largest.len() as u32).map(|triangle| largest[sets.find(triangle).0 as usize]).collect()
}

/// True if two triangles at an edge lie in one plane and neither is degenerate.
fn are_coplanar(mesh: &Mesh, pair: &[HalfEdge]) -> bool {
    let [a, b] = [0, 1].map(|k| mesh.corners(pair[k].triangle as usize));
    let is_end = |vertex: &&u32| pair[1].ends.contains(vertex);
    let other = mesh.triangles()[pair[1].triangle as usize].iter().find(|vertex| !is_end(vertex));
    let in_plane = |&vertex: &u32| triangle::side_of(a, mesh.vertices()[vertex as usize]) == 0;
    other.is_some_and(in_plane) && !triangle::is_flat(a) && !triangle::is_flat(b)
}
