//! Mesh repair: vertex welding, removal of degenerate and duplicate triangles, hole filling, consistent orientation.

use crate::diagnosis::intersections::intersections;
use crate::diagnosis::{Component, PairBudget, holes, shells};
use crate::topology::{half_edges, is_degenerate};
use crate::triangulate::{EarBudget, area_vector, clip_ears};
use crate::{Mesh, MeshError};
use rayweave_math::{UNIT_ROUNDOFF, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};

/// Options of a repair.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RepairOptions {
    /// The distance within which vertices are merged, in the unit of length; 0 merges equal vertices only.
    pub weld: f64,
    /// Whether to fill plane holes: those whose boundary loop lies in one plane, within `weld` and rounding, and does not
    /// intersect itself.
    pub fill: bool,
}

impl RepairOptions {
    /// The options with this distance for merging vertices.
    pub fn with_weld(self, weld: f64) -> RepairOptions {
        RepairOptions { weld, ..self }
    }

    /// The options with filling of plane holes on or off.
    pub fn with_fill(self, fill: bool) -> RepairOptions {
        RepairOptions { fill, ..self }
    }
}

/// Merging of equal vertices, and filling of plane holes.
impl Default for RepairOptions {
    fn default() -> RepairOptions {
        RepairOptions { weld: 0.0, fill: true }
    }
}

/// The numbers of changes of a repair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repair {
    /// Vertices merged into another one.
    pub welded: usize,
    /// Triangles removed because they lack three different corners.
    pub collapsed: usize,
    /// Triangles removed because another one has the same corners.
    pub duplicates: usize,
    /// Holes filled.
    pub filled: usize,
    /// Triangles whose orientation was reversed.
    pub reversed: usize,
}

impl Repair {
    /// The changes as texts, such as `1 plane hole filled`, each with its kind, `plane holes filled`; kinds of changes that did not
    /// occur are left out.
    pub fn summary(&self) -> impl Iterator<Item = (String, &'static str)> {
        let all = [
            (self.welded, "vertex merged", "vertices merged"),
            (
                self.collapsed,
                "triangle without three corners removed",
                "triangles without three corners removed",
            ),
            (self.duplicates, "duplicate triangle removed", "duplicate triangles removed"),
            (self.filled, "plane hole filled", "plane holes filled"),
            (self.reversed, "triangle reversed", "triangles reversed"),
        ];
        let text = |(count, one, several)| match count {
            0 => None,
            1 => Some((format!("1 {one}"), several)),
            count => Some((format!("{count} {several}"), several)),
        };
        all.into_iter().filter_map(text)
    }
}

/// The distance for merging vertices, relative to the size of the mesh, if a smaller change does not close it.
const RELATIVE_WELD: f64 = 1e-6;

impl Mesh {
    /// The least repair that closes the mesh around a volume: neither merging nor filling; merging vertices within a millionth
    /// of the mesh's size; filling plane holes; both. Filling comes late, because every isolated triangle is a plane hole. If
    /// none of these closes the mesh, the result is the last one; `None` if no repair succeeds.
    pub fn auto_repaired(&self) -> Option<(Mesh, Repair)> {
        let near = RELATIVE_WELD * self.bounds().size().length();
        let mut best = None;
        for (weld, fill) in [(0.0, false), (near, false), (0.0, true), (near, true)] {
            best = self.repaired(&RepairOptions { weld, fill }).ok().or(best);
            if best.as_ref().is_some_and(|(mesh, _)| mesh.is_closed() && mesh.volume() != 0.0) {
                break;
            }
        }
        best
    }

    /// Repairs what is safe to repair: merges close vertices, removes degenerate and duplicate triangles, fills plane holes, and
    /// orients each shell by its nesting depth. [`Mesh::diagnose`] reports the remaining defects.
    ///
    /// # Errors
    /// [`MeshError`] if the merged vertices do not form a mesh.
    pub fn repaired(&self, options: &RepairOptions) -> Result<(Mesh, Repair), MeshError> {
        let mut done = Repair::default();
        let mesh = self.welded();
        let (vertices, count) = (mesh.vertices().len(), mesh.triangles().len());
        let mesh = merge_close_vertices(&mesh, options.weld)?;
        done.welded = vertices - mesh.vertices().len();
        let mesh =
            mesh.with_triangles(mesh.triangles().iter().copied().filter(|&t| !is_degenerate(t)).collect());
        done.collapsed = count - mesh.triangles().len();
        let mesh = without_duplicates(mesh, &mut done);
        let mesh = if options.fill { filled(mesh, options.weld, &mut done) } else { mesh };
        Ok((oriented(mesh, &mut done), done))
    }

    fn with_triangles(&self, triangles: Vec<[u32; 3]>) -> Mesh {
        Mesh::new(self.vertices().to_vec(), triangles).unwrap_or_default()
    }
}

/// Merges each vertex with the first one within a distance, found by a hash grid.
fn merge_close_vertices(mesh: &Mesh, distance: f64) -> Result<Mesh, MeshError> {
    if !(distance > 0.0 && distance.is_finite()) {
        return Ok(mesh.clone());
    }
    let cell = |p: Vec3| (p / distance).floor().to_array();
    let mut cells: FxHashMap<[u64; 3], Vec<u32>> = FxHashMap::default();
    let mut kept: Vec<Vec3> = Vec::new();
    let mut number = Vec::with_capacity(mesh.vertices().len());
    for &point in mesh.vertices() {
        let near = cell_block(cell(point)).find_map(|key| {
            let here = cells.get(&key)?.iter();
            here.copied().find(|&other| (kept[other as usize] - point).length() <= distance)
        });
        number.push(near.unwrap_or_else(|| {
            let key = cell(point).map(|x| (x + 0.0).to_bits());
            cells.entry(key).or_default().push(kept.len() as u32);
            kept.push(point);
            (kept.len() - 1) as u32
        }));
    }
    let triangles = mesh.triangles().iter().map(|corners| corners.map(|v| number[v as usize])).collect();
    Mesh::new(kept, triangles)
}

/// The keys of a cell and its 26 neighbours.
fn cell_block(cell: [f64; 3]) -> impl Iterator<Item = [u64; 3]> {
    (0..27).map(move |k| {
        let step = [k % 3, k / 3 % 3, k / 9].map(|step| f64::from(step) - 1.0);
        [0, 1, 2].map(|axis| (cell[axis] + step[axis] + 0.0).to_bits())
    })
}

fn without_duplicates(mesh: Mesh, done: &mut Repair) -> Mesh {
    let mut seen: FxHashSet<[u32; 3]> = FxHashSet::default();
    let is_new = |&corners: &[u32; 3]| {
        let mut key = corners;
        key.sort_unstable();
        seen.insert(key)
    };
    let kept: Vec<[u32; 3]> = mesh.triangles().iter().copied().filter(is_new).collect();
    done.duplicates = mesh.triangles().len() - kept.len();
    if done.duplicates == 0 { mesh } else { mesh.with_triangles(kept) }
}

fn filled(mesh: Mesh, tolerance: f64, done: &mut Repair) -> Mesh {
    let loops = holes::boundary_loops(&mesh, &half_edges(&mesh));
    let mut budget = EarBudget::default();
    let caps: Vec<Vec<[u32; 3]>> =
        loops.iter().filter_map(|corners| cap(&mesh, corners, tolerance, &mut budget)).collect();
    done.filled = caps.len();
    if caps.is_empty() {
        return mesh;
    }
    mesh.with_triangles(mesh.triangles().iter().copied().chain(caps.into_iter().flatten()).collect())
}

/// The maximal length of a boundary loop that is filled: ear clipping takes at least quadratic time.
const MAX_LOOP_LENGTH: usize = 1000;

/// Triangles that fill a boundary loop, if it lies in one plane and does not intersect itself.
fn cap(mesh: &Mesh, corners: &[u32], tolerance: f64, budget: &mut EarBudget) -> Option<Vec<[u32; 3]>> {
    let point = |vertex: u32| mesh.vertices()[vertex as usize];
    let normal = area_vector(mesh.vertices(), corners).normalize_or_zero();
    let magnitude = corners.iter().map(|&vertex| point(vertex).length()).fold(0.0, f64::max);
    let near = tolerance + 64.0 * UNIT_ROUNDOFF * magnitude;
    let is_in_plane = |&v: &u32| normal.dot(point(v) - point(corners[0])).abs() <= near;
    let is_plane =
        corners.len() <= MAX_LOOP_LENGTH && normal != Vec3::ZERO && corners.iter().all(is_in_plane);
    if is_plane { clip_ears(mesh.vertices(), corners, normal, budget) } else { None }
}

/// Makes the orientation of each shell consistent and outward, by its nesting depth. Shells that cross another one have no depth, and
/// keep the orientation of the majority of their triangles.
fn oriented(mesh: Mesh, done: &mut Repair) -> Mesh {
    let half_edges = half_edges(&mesh);
    let shells = shells::Shells::new(&mesh, &half_edges);
    let mut components = shells.components(&mesh, &half_edges);
    // the search takes longer than all else here, and shells that are not inside out stay as they are
    if components.len() > 1 && components.iter().any(Component::is_inside_out) {
        let found = intersections(&mesh, &shells.component_of, |_| false, &mut PairBudget::default());
        found.mixed.iter().for_each(|&shell| components[shell as usize].is_mixed = true);
    }
    let is_reversed = |triangle: usize| {
        let shell = &components[shells.component_of[triangle] as usize];
        shell.is_orientable && shells.is_flipped[triangle] != shell.is_inside_out()
    };
    done.reversed = (0..mesh.triangles().len()).filter(|&triangle| is_reversed(triangle)).count();
    mesh.reversed(is_reversed)
}
