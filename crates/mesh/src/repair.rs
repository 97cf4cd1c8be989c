//! What can safely be mended, and is only mended when asked for.

use crate::diagnosis::{holes, shells};
use crate::polygon::{area_vector, ears};
use crate::topology::{edge_uses, is_collapsed};
use crate::{Mesh, MeshError};
use rayweave_math::{UNIT_ROUNDOFF, Vec3};
use rustc_hash::{FxHashMap, FxHashSet};

/// What may be done.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RepairOptions {
    /// Points at most this far apart become one, in the unit of length; 0 joins equal points only.
    pub weld: f64,
    /// Whether holes are closed whose rim lies in one plane, within `weld` and rounding, and does not cross itself.
    pub fill: bool,
}

impl Default for RepairOptions {
    fn default() -> RepairOptions {
        RepairOptions { weld: 0.0, fill: true }
    }
}

/// What was done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Repair {
    /// Points that became one with another.
    pub welded: usize,
    /// Triangles without three different corners, left out.
    pub collapsed: usize,
    /// Triangles with the corners of another, left out.
    pub duplicates: usize,
    /// Holes that were closed.
    pub filled: usize,
    /// Triangles that were turned round.
    pub turned: usize,
}

impl Repair {
    /// What was done, in words, with how often; only what was done at all.
    pub fn told(&self) -> impl Iterator<Item = (usize, &'static str)> {
        let all = [
            (self.welded, "points joined with others near to them"),
            (self.collapsed, "triangles without three corners left out"),
            (self.duplicates, "repeated triangles left out"),
            (self.filled, "holes with a plane rim closed"),
            (self.turned, "triangles turned round"),
        ];
        all.into_iter().filter(|(count, _)| *count > 0)
    }
}

/// The distance, as a part of the size of a mesh, within which points are joined if nothing less closes it.
const NEAR: f64 = 1e-6;

impl Mesh {
    /// The mesh after the least of what is safe that closes it around something: nothing joined or filled, points nearer than a
    /// millionth of its size joined, plane holes filled, both. Filling comes late, because a triangle that hangs together with
    /// nothing is a hole, too. `None` if nothing is left of it.
    pub fn mended(&self) -> Option<(Mesh, Repair)> {
        let near = NEAR * self.bounds().size().length();
        let mut best = None;
        for (weld, fill) in [(0.0, false), (near, false), (0.0, true), (near, true)] {
            best = self.repaired(&RepairOptions { weld, fill }).ok().or(best);
            if best.as_ref().is_some_and(|(mesh, _)| mesh.is_closed() && mesh.volume() != 0.0) {
                break;
            }
        }
        best
    }

    /// The mesh after what can safely be mended: near points joined, triangles without three corners and repeated ones left
    /// out, plane holes closed, each shell turned as its place asks. What is left is for [`Mesh::diagnose`] to tell.
    ///
    /// # Errors
    /// [`MeshError`] if what is left is no mesh.
    pub fn repaired(&self, options: &RepairOptions) -> Result<(Mesh, Repair), MeshError> {
        let mut done = Repair::default();
        let mesh = self.welded();
        let (points, count) = (mesh.vertices().len(), mesh.triangles().len());
        let mesh = near_points_joined(&mesh, options.weld)?;
        done.welded = points - mesh.vertices().len();
        let mesh =
            mesh.with_triangles(mesh.triangles().iter().copied().filter(|&t| !is_collapsed(t)).collect());
        done.collapsed = count - mesh.triangles().len();
        let mesh = without_duplicates(mesh, &mut done);
        let mesh = if options.fill { filled(mesh, options.weld, &mut done) } else { mesh };
        Ok((turned(mesh, &mut done), done))
    }

    fn with_triangles(&self, triangles: Vec<[u32; 3]>) -> Mesh {
        Mesh::new(self.vertices().to_vec(), triangles).unwrap_or_default()
    }
}

/// Points within a distance become the first of them, cell by cell of a grid.
fn near_points_joined(mesh: &Mesh, distance: f64) -> Result<Mesh, MeshError> {
    if !(distance > 0.0 && distance.is_finite()) {
        return Ok(mesh.clone());
    }
    let cell = |p: Vec3| (p / distance).floor().to_array();
    let mut cells: FxHashMap<[u64; 3], Vec<u32>> = FxHashMap::default();
    let mut kept: Vec<Vec3> = Vec::new();
    let mut number = Vec::with_capacity(mesh.vertices().len());
    for &point in mesh.vertices() {
        let near = neighbours(cell(point)).find_map(|key| {
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

/// The keys of a cell and the 26 around it.
fn neighbours(cell: [f64; 3]) -> impl Iterator<Item = [u64; 3]> {
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
    let rims = holes::holes(&mesh, &edge_uses(&mesh));
    let lids: Vec<Vec<[u32; 3]>> = rims.iter().filter_map(|rim| lid(&mesh, rim, tolerance)).collect();
    done.filled = lids.len();
    if lids.is_empty() {
        return mesh;
    }
    mesh.with_triangles(mesh.triangles().iter().copied().chain(lids.into_iter().flatten()).collect())
}

/// The longest rim that is closed: cutting off ears takes the square of it at least.
const LONGEST_RIM: usize = 1000;

/// Triangles that close a rim, if it lies in one plane and does not cross itself.
fn lid(mesh: &Mesh, rim: &[u32], tolerance: f64) -> Option<Vec<[u32; 3]>> {
    let point = |vertex: u32| mesh.vertices()[vertex as usize];
    let normal = area_vector(mesh.vertices(), rim).normalize_or_zero();
    let reach = rim.iter().map(|&vertex| point(vertex).length()).fold(0.0, f64::max);
    let near = tolerance + 64.0 * UNIT_ROUNDOFF * reach;
    let is_in_plane = |&v: &u32| normal.dot(point(v) - point(rim[0])).abs() <= near;
    let is_plane = rim.len() <= LONGEST_RIM && normal != Vec3::ZERO && rim.iter().all(is_in_plane);
    if is_plane { ears(mesh.vertices(), rim, normal) } else { None }
}

/// Turns the triangles of each shell alike, and shells that are inside out.
fn turned(mesh: Mesh, done: &mut Repair) -> Mesh {
    let uses = edge_uses(&mesh);
    let shells = shells::Shells::new(&mesh, &uses);
    let components = shells.components(&mesh, &uses);
    let turn = |triangle: usize| {
        let shell = &components[shells.of[triangle] as usize];
        shell.is_orientable && shells.is_flipped[triangle] != shell.is_inside_out()
    };
    done.turned = (0..mesh.triangles().len()).filter(|&triangle| turn(triangle)).count();
    mesh.turned(turn)
}
