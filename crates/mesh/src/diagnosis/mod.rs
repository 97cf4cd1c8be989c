//! What is wrong with a mesh, where, and how often.

pub(crate) mod holes;
mod intersections;
pub(crate) mod shells;

use crate::topology::{EdgeUse, by_edge, edge_uses, is_collapsed};
use crate::{Mesh, triangle};
use rayweave_math::{UNIT_ROUNDOFF, Vec3};
use rustc_hash::FxHashMap;
use std::fmt;

pub use holes::Hole;
pub use intersections::Intersection;
pub use shells::Component;

/// How many there are of something, and the first of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Findings<T> {
    /// All of them.
    pub count: usize,
    /// The first, at most [`Findings::KEPT`].
    pub first: Vec<T>,
}

impl<T> Default for Findings<T> {
    fn default() -> Findings<T> {
        Findings { count: 0, first: Vec::new() }
    }
}

impl<T> Findings<T> {
    /// How many are kept.
    pub const KEPT: usize = 1000;

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    fn add(&mut self, finding: T) {
        self.count += 1;
        if self.first.len() < Self::KEPT {
            self.first.push(finding);
        }
    }
}

impl<T> FromIterator<T> for Findings<T> {
    fn from_iter<I: IntoIterator<Item = T>>(found: I) -> Findings<T> {
        let mut findings = Findings::default();
        found.into_iter().for_each(|finding| findings.add(finding));
        findings
    }
}

/// What was found. Equal points count as one, so numbers of vertices are those of [`Mesh::welded`]; triangles have the
/// numbers of the mesh.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Diagnosis {
    /// Triangles in all.
    pub triangles: usize,
    /// Different points.
    pub vertices: usize,
    /// Edges with an odd number of triangles: with one of them, nothing is inside.
    pub open_edges: usize,
    /// Closed ways along edges that have one triangle.
    pub holes: Findings<Hole>,
    /// The middles of edges with three triangles or more.
    pub crowded_edges: Findings<Vec3>,
    /// Points at which parts of the mesh meet that have no edge there in common.
    pub pinched_vertices: Findings<Vec3>,
    /// Triangles that turn other than the most of their component.
    pub flipped: Findings<u32>,
    /// Triangles whose corners lie on one line, or are not three.
    pub degenerate: Findings<u32>,
    /// Pairs of triangles with the same corners.
    pub duplicates: Findings<[u32; 2]>,
    /// Pairs of triangles that go through each other.
    pub crossings: Findings<Intersection>,
    /// Pairs of triangles in one plane that have an area in common.
    pub overlaps: Findings<Intersection>,
    /// What hangs together by edges.
    pub components: Vec<Component>,
    /// True if it is closed and nothing is inside, but for rounding: all of it is folded flat.
    pub is_flat: bool,
}

impl Diagnosis {
    /// True if each edge has an even number of triangles: what is inside is defined ([`crate::Polyhedron`]).
    pub fn is_closed(&self) -> bool {
        self.open_edges == 0 && self.triangles > 0
    }

    /// True if the mesh is closed with something inside, and nothing that was found makes it doubtful what was meant: no shell
    /// goes through another or itself, and each turns as its place asks.
    pub fn is_sound(&self) -> bool {
        let shells = self.components.iter().all(|shell| shell.is_orientable && !shell.is_inside_out());
        let pairs = self.crossings.is_empty() && self.overlaps.is_empty() && self.duplicates.is_empty();
        self.is_closed() && pairs && shells && self.flipped.is_empty() && !self.is_flat
    }
}

impl Mesh {
    /// Looks for all that may be wrong with a mesh. Takes time in proportion to n log n for n triangles and what is found.
    pub fn diagnose(&self) -> Diagnosis {
        let mesh = self.welded();
        let uses = edge_uses(&mesh);
        let shells = shells::Shells::new(&mesh, &uses);
        let (crossings, overlaps) = intersections::intersections(&mesh);
        let components = shells.components(&mesh, &uses);
        let open_edges = by_edge(&uses).filter(|edge| edge.len() % 2 == 1).count();
        Diagnosis {
            triangles: mesh.triangles().len(),
            vertices: mesh.vertices().len(),
            open_edges,
            holes: holes::holes(&mesh, &uses).into_iter().map(|corners| Hole::new(&mesh, corners)).collect(),
            crowded_edges: by_edge(&uses).filter(|edge| edge.len() > 2).map(|e| middle(&mesh, e)).collect(),
            pinched_vertices: shells::pinched(&mesh, &uses).map(|v| mesh.vertices()[v as usize]).collect(),
            flipped: shells.flipped(),
            degenerate: degenerate(&mesh).collect(),
            duplicates: duplicates(&mesh),
            crossings,
            overlaps,
            is_flat: open_edges == 0 && !components.is_empty() && encloses_nothing(&mesh, &components),
            components,
        }
    }
}

/// Volumes as small as the rounding of a sum over all triangles.
fn encloses_nothing(mesh: &Mesh, components: &[Component]) -> bool {
    let rounding = 64.0 * UNIT_ROUNDOFF * mesh.area() * mesh.bounds().size().length();
    components.iter().all(|component| component.volume.abs() <= rounding)
}

fn middle(mesh: &Mesh, edge: &[EdgeUse]) -> Vec3 {
    let [a, b] = edge[0].ends.map(|vertex| mesh.vertices()[vertex as usize]);
    0.5 * (a + b)
}

fn degenerate(mesh: &Mesh) -> impl Iterator<Item = u32> {
    let flat = |&k: &usize| is_collapsed(mesh.triangles()[k]) || triangle::is_flat(mesh.corners(k));
    (0..mesh.triangles().len()).filter(flat).map(|k| k as u32)
}

/// Triangles with the corners of one before them, and that one.
pub(crate) fn duplicates(mesh: &Mesh) -> Findings<[u32; 2]> {
    let mut first: FxHashMap<[u32; 3], u32> = FxHashMap::default();
    let mut found = Findings::default();
    for (number, &corners) in mesh.triangles().iter().enumerate() {
        let mut key = corners;
        key.sort_unstable();
        let number = number as u32;
        let before = *first.entry(key).or_insert(number);
        if before != number && !is_collapsed(corners) {
            found.add([before, number]);
        }
    }
    found
}

/// Some of them in words: "3 holes, the first at (0, 0, 1)".
impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shells = self.components.len();
        write!(f, "{} triangles, {} vertices, {shells} shells", self.triangles, self.vertices)?;
        if self.is_flat {
            write!(f, "; nothing is inside")?;
        }
        let inside_out = self.components.iter().filter(|shell| shell.is_inside_out()).count();
        let one_sided = self.components.iter().filter(|shell| !shell.is_orientable).count();
        let at = |p: &Vec3| format!("({}, {}, {})", p.x, p.y, p.z);
        let lines = [
            (self.open_edges, "open edges", String::new()),
            (
                self.holes.count,
                "holes",
                first(&self.holes, |h| format!("{}, {} edges", at(&h.centre), h.edges)),
            ),
            (self.crowded_edges.count, "edges with more than two triangles", first(&self.crowded_edges, at)),
            (self.pinched_vertices.count, "pinched vertices", first(&self.pinched_vertices, at)),
            (self.flipped.count, "flipped triangles", first(&self.flipped, |k| format!("triangle {k}"))),
            (
                self.degenerate.count,
                "degenerate triangles",
                first(&self.degenerate, |k| format!("triangle {k}")),
            ),
            (
                self.duplicates.count,
                "duplicate triangles",
                first(&self.duplicates, |k| format!("triangles {k:?}")),
            ),
            (self.crossings.count, "crossing pairs of triangles", first(&self.crossings, |x| at(&x.at))),
            (self.overlaps.count, "overlapping pairs of triangles", first(&self.overlaps, |x| at(&x.at))),
            (inside_out, "shells inside out", String::new()),
            (one_sided, "shells with one side only", String::new()),
        ];
        for (count, what, place) in lines.iter().filter(|(count, ..)| *count > 0) {
            write!(f, "; {what}: {count}{place}")?;
        }
        Ok(())
    }
}

fn first<T>(findings: &Findings<T>, at: impl Fn(&T) -> String) -> String {
    findings.first.first().map(|finding| format!(" (the first: {})", at(finding))).unwrap_or_default()
}
