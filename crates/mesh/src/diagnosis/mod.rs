//! Mesh diagnosis: open and non-manifold edges, holes, self-intersections, duplicates, orientation and shells.

pub(crate) mod holes;
pub(crate) mod intersections;
pub(crate) mod shells;

use crate::topology::{HalfEdge, by_edge, half_edges, is_degenerate};
use crate::{Mesh, triangle};
use rayweave_math::{UNIT_ROUNDOFF, Vec3};
use rustc_hash::FxHashMap;
use std::fmt;

pub use holes::Hole;
pub use intersections::{Intersection, PairBudget};
pub use shells::Component;

/// The number of defects of one kind, and the first of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Findings<T> {
    /// The number of all defects.
    pub count: usize,
    /// The first defects, at most [`Findings::MAX_KEPT`].
    pub first: Vec<T>,
}

impl<T> Default for Findings<T> {
    fn default() -> Findings<T> {
        Findings { count: 0, first: Vec::new() }
    }
}

impl<T> Findings<T> {
    /// The maximal length of [`Findings::first`].
    pub const MAX_KEPT: usize = 1000;

    /// True if there are no defects of this kind.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    fn add(&mut self, finding: T) {
        self.count += 1;
        if self.first.len() < Self::MAX_KEPT {
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

/// The result of a diagnosis. Equal points count as one vertex, so that vertex indices refer to [`Mesh::welded`]; triangle
/// indices refer to the mesh.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Diagnosis {
    /// The number of triangles.
    pub triangles: usize,
    /// The number of distinct vertices.
    pub vertices: usize,
    /// The number of edges with an odd number of triangles. If there are any, the inside is not defined.
    pub open_edges: usize,
    /// Closed loops of edges that belong to one triangle only.
    pub holes: Findings<Hole>,
    /// The midpoints of edges with three or more triangles.
    pub non_manifold_edges: Findings<Vec3>,
    /// Vertices shared by parts of the mesh that have no common edge there.
    pub non_manifold_vertices: Findings<Vec3>,
    /// Triangles oriented unlike the majority of their component.
    pub flipped: Findings<u32>,
    /// Triangles with collinear or coinciding corners.
    pub degenerate: Findings<u32>,
    /// Pairs of triangles with the same corners.
    pub duplicates: Findings<[u32; 2]>,
    /// Pairs of triangles that intersect each other. Of duplicates only the first is compared with others.
    pub crossings: Findings<Intersection>,
    /// Pairs of coplanar triangles that overlap; of duplicates only the first.
    pub overlaps: Findings<Intersection>,
    /// Pairs of triangles that touch beyond common corners and edges without an edge of one that crosses the interior of the
    /// other: parts in contact, corners in the middle of edges, and intersections exactly through edges.
    pub contacts: Findings<Intersection>,
    /// The triangle at which the search for intersections was given up, because the boxes of too many pairs overlap: more than
    /// 64 for each triangle, and two million. `None` if all pairs were compared.
    pub uncompared: Option<u32>,
    /// The components connected by edges.
    pub components: Vec<Component>,
    /// True if the mesh is closed and its volume is 0 within rounding.
    pub is_flat: bool,
}

impl Diagnosis {
    /// True if each edge has an even number of triangles, so that the inside is defined ([`crate::Polyhedron`]).
    pub fn is_closed(&self) -> bool {
        self.open_edges == 0 && self.triangles > 0
    }

    /// True if the mesh is closed around a volume and its solid is unambiguous: shells do not intersect each other or
    /// themselves, and the orientation of each agrees with its nesting depth.
    pub fn is_sound(&self) -> bool {
        let shells = self.components.iter().all(|shell| shell.is_orientable && !shell.is_inside_out());
        let pairs = self.crossings.is_empty() && self.overlaps.is_empty() && self.duplicates.is_empty();
        let is_searched = self.uncompared.is_none();
        self.is_closed() && pairs && is_searched && shells && self.flipped.is_empty() && !self.is_flat
    }

    /// The volume of the solid ([`crate::Polyhedron`]) within rounding, in cubes of the unit of length: the sum of the signed
    /// tetrahedra between the triangles and the centre of the mesh (divergence theorem), where shells at odd depths are
    /// cavities. The orientation of the triangles does not matter. `None` if the mesh is not closed, and where the sum may
    /// differ from the volume: if shells intersect, overlap or touch each other or themselves (except at single common
    /// corners), if an edge has more than two triangles, if a triangle has no area or was not compared with all others.
    pub fn volume(&self) -> Option<f64> {
        let pairs = [&self.crossings, &self.overlaps, &self.contacts].iter().all(|found| found.is_empty());
        let edges = self.non_manifold_edges.is_empty() && self.degenerate.is_empty();
        let shells = self.components.iter().all(|shell| shell.is_closed && shell.is_orientable);
        let is_searched = self.duplicates.is_empty() && self.uncompared.is_none();
        let is_known = self.is_closed() && pairs && edges && shells && is_searched;
        let signed = |shell: &Component| {
            let volume = shell.volume.abs();
            if shell.depth.is_multiple_of(2) { volume } else { -volume }
        };
        is_known.then(|| self.components.iter().map(signed).sum())
    }
}

impl Mesh {
    /// Finds all defects of the mesh. Takes O(n log n) time for n triangles, except for meshes of many nested shells; the search for
    /// intersections has a limit ([`Diagnosis::uncompared`]).
    pub fn diagnose(&self) -> Diagnosis {
        self.diagnose_within(&mut PairBudget::default())
    }

    /// True if the mesh is closed and encloses no volume, as [`Diagnosis::is_flat`], without the search for other defects.
    pub fn is_flat(&self) -> bool {
        let mesh = self.welded();
        let uses = half_edges(&mesh);
        let components = shells::Shells::new(&mesh, &uses).components(&mesh, &uses);
        let is_closed = by_edge(&uses).all(|edge| edge.len() % 2 == 0);
        is_closed && !components.is_empty() && encloses_no_volume(&mesh, &components)
    }

    /// [`Mesh::diagnose`] with a budget for the search for intersections, which the meshes of one file share.
    pub fn diagnose_within(&self, budget: &mut PairBudget) -> Diagnosis {
        let mesh = self.welded();
        let half_edges = half_edges(&mesh);
        let shells = shells::Shells::new(&mesh, &half_edges);
        let (duplicates, is_duplicate) = duplicates(&mesh);
        let is_duplicate = |triangle: u32| is_duplicate[triangle as usize];
        let found = intersections::intersections(&mesh, &shells.component_of, is_duplicate, budget);
        let mut components = shells.components(&mesh, &half_edges);
        found.mixed.iter().for_each(|&shell| components[shell as usize].is_mixed = true);
        let open_edges = by_edge(&half_edges).filter(|edge| edge.len() % 2 == 1).count();
        Diagnosis {
            triangles: mesh.triangles().len(),
            vertices: mesh.vertices().len(),
            open_edges,
            holes: holes::boundary_loops(&mesh, &half_edges)
                .into_iter()
                .map(|corners| Hole::new(&mesh, corners))
                .collect(),
            non_manifold_edges: by_edge(&half_edges)
                .filter(|edge| edge.len() > 2)
                .map(|e| middle(&mesh, e))
                .collect(),
            non_manifold_vertices: shells::non_manifold_vertices(&mesh, &half_edges)
                .map(|v| mesh.vertices()[v as usize])
                .collect(),
            flipped: shells.flipped(),
            degenerate: degenerate(&mesh).collect(),
            duplicates,
            crossings: found.crossings,
            overlaps: found.overlaps,
            contacts: found.contacts,
            uncompared: found.end,
            is_flat: open_edges == 0 && !components.is_empty() && encloses_no_volume(&mesh, &components),
            components,
        }
    }
}

/// True if all volumes are within the rounding error of a sum over all triangles.
fn encloses_no_volume(mesh: &Mesh, components: &[Component]) -> bool {
    let rounding = 64.0 * UNIT_ROUNDOFF * mesh.area() * mesh.bounds().size().length();
    components.iter().all(|component| component.volume.abs() <= rounding)
}

fn middle(mesh: &Mesh, edge: &[HalfEdge]) -> Vec3 {
    let [a, b] = edge[0].ends.map(|vertex| mesh.vertices()[vertex as usize]);
    0.5 * (a + b)
}

fn degenerate(mesh: &Mesh) -> impl Iterator<Item = u32> {
    let flat = |&k: &usize| is_degenerate(mesh.triangles()[k]) || triangle::is_flat(mesh.corners(k));
    (0..mesh.triangles().len()).filter(flat).map(|k| k as u32)
}

/// Pairs of triangles with the same corners, and whether a triangle is the second of a pair.
pub(crate) fn duplicates(mesh: &Mesh) -> (Findings<[u32; 2]>, Vec<bool>) {
    let mut first: FxHashMap<[u32; 3], u32> = FxHashMap::default();
    let (mut found, mut is_duplicate) = (Findings::default(), vec![false; mesh.triangles().len()]);
    for (number, &corners) in mesh.triangles().iter().enumerate() {
        let mut key = corners;
        key.sort_unstable();
        let number = number as u32;
        let before = *first.entry(key).or_insert(number);
        if before != number && !is_degenerate(corners) {
            found.add([before, number]);
            is_duplicate[number as usize] = true;
        }
    }
    (found, is_duplicate)
}

/// A summary with the first defect of each kind: `holes: 3 (the first: (0, 0, 1), 4 edges)`.
impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shells = match self.components.len() {
            1 => "1 shell".to_owned(),
            count => format!("{count} shells"),
        };
        write!(f, "{} triangles, {} vertices, {shells}", self.triangles, self.vertices)?;
        if self.is_flat {
            write!(f, "; no volume inside")?;
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
            (self.non_manifold_edges.count, "non-manifold edges", first(&self.non_manifold_edges, at)),
            (
                self.non_manifold_vertices.count,
                "non-manifold vertices",
                first(&self.non_manifold_vertices, at),
            ),
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
            (self.crossings.count, "intersecting pairs of triangles", first(&self.crossings, |x| at(&x.at))),
            (self.overlaps.count, "overlapping pairs of triangles", first(&self.overlaps, |x| at(&x.at))),
            (inside_out, "shells inside out", String::new()),
            (one_sided, "non-orientable shells", String::new()),
        ];
        for (count, what, place) in lines.iter().filter(|(count, ..)| *count > 0) {
            write!(f, "; {what}: {count}{place}")?;
        }
        if let Some(triangle) = self.uncompared {
            write!(
                f,
                "; too many triangles are close together: the search for intersections ended at triangle {triangle}"
            )?;
        }
        Ok(())
    }
}

fn first<T>(findings: &Findings<T>, at: impl Fn(&T) -> String) -> String {
    findings.first.first().map(|finding| format!(" (the first: {})", at(finding))).unwrap_or_default()
}
