//! Edges and corners that point into a region, found where rays hit different faces near each other.
//!
//! The hits of rays are sorted into cells. For each pair of faces hit in a cell or beside it, the point of their common curve that is
//! nearest to the middle of the cell is a candidate, and so are the corners of three faces. Around a point of an edge two surfaces
//! separate four sectors: the edge points into a region if exactly one of them is not in the region. Around a corner there are eight.

use super::probe::Budget;
use super::stratum::Stratum;
use crate::survey::Piece;
use rayweave_math::{Bounds, Transform, Vec3};
use rayweave_model::{Evaluator, Face, LeafId, PlacementId, Program, RegionId};
use rayweave_shape::surface::{MeshForm, Surface};
use std::any::Any;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// The number of cells along the longest edge of the sampled box.
const ACROSS: f64 = 32.0;

/// The most hits that are kept for a survey.
const MAX_HITS: usize = 1 << 17;

/// The most faces beside a cell whose pairs, and whose triples, are examined.
const MAX_FACES: usize = 24;
const MAX_FACES_OF_CORNERS: usize = 9;

/// The most pairs and triples of faces that are examined in a survey.
const MAX_CANDIDATES: usize = 200_000;

/// The work of a search for the common point of faces, and of finding the region of a point for each leaf that a ray reaches, in units
/// of the work of a ray for each of these leaves.
const WORK_OF_PAIR: u64 = 8;
const WORK_OF_POINT: f64 = 0.125;

/// The distance of points beside an edge or corner whose regions decide, relative to the diagonal of the model. Edges are exact to 256 u
/// times the lengths involved, some 1e-13, and sectors have a sine of 0.05 or more, of which the points are in the middle: rounding does
/// not matter, and parts of the model down to 1/10,000,000 of its size do.
const ASIDE: f64 = 1e-7;

/// Faces that meet at a smaller angle form no edge: the chords between faces find walls there. It is larger for meshes, which
/// approximate curved faces by triangles.
const LEAST_SINE: f64 = 0.05;
const LEAST_SINE_OF_MESH: f64 = 0.35;

/// The number of steps per unit of the normals and relative distances of planes by which triangles of a mesh belong to one face. Files
/// of meshes have coordinates in single precision, with relative errors of 2^-24 = 6e-8: the normal of a triangle with a height of 1/1000
/// of the size of the model is uncertain by 2 * 6e-8 * 1000, about one step. Smaller triangles of one face may count as several faces.
const STEPS_OF_PLANES: f64 = 1e4;

/// A face: leaf, placement and number within the leaf; of meshes also the plane of the triangle, in steps of [`STEPS_OF_PLANES`].
pub(super) type FaceKey = (LeafId, PlacementId, u32, [i32; 4]);

/// A point where a ray hit a face.
#[derive(Clone, Copy, Debug)]
struct Hit {
    face: Face,
    point: Vec3,
    normal: Vec3,
}

/// Cells of a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    bounds: Bounds,
    /// The edge of a cell.
    pub size: f64,
    /// The diagonal of the whole model.
    diagonal: f64,
}

type Cell = [i16; 3];

impl Grid {
    pub fn new(bounds: &Bounds, frame: &Bounds) -> Grid {
        let size = bounds.size().max_element() / ACROSS;
        Grid { bounds: bounds.grown(1e-6 * size), size, diagonal: frame.size().length() }
    }

    fn cell(&self, point: Vec3) -> Option<Cell> {
        let at = ((point - self.bounds.lo) / self.size).floor();
        self.bounds.contains(point).then(|| at.to_array().map(|x| x as i16))
    }

    fn middle(&self, cell: Cell) -> Vec3 {
        self.bounds.lo + self.size * (Vec3::from_array(cell.map(f64::from)) + Vec3::splat(0.5))
    }
}

/// The first hit of each face in each cell.
#[derive(Clone, Debug, Default)]
pub(super) struct Hits {
    cells: BTreeMap<(Cell, FaceKey), Hit>,
    /// The number of hits beyond the largest one.
    left_out: u64,
}

impl Hits {
    /// Adds the ends of a piece; those that are also ends of the piece before are left out.
    pub fn add(&mut self, piece: &Piece<'_>, grid: &Grid, program: &Program) {
        let (chord, faces) = (piece.chord(), piece.faces());
        let is_first = piece.neighbours()[0] == RegionId(0);
        for (end, point) in [chord.from, chord.to].into_iter().enumerate().skip(usize::from(!is_first)) {
            let Some(cell) = grid.cell(point) else { continue };
            let face = faces[end];
            let is_known =
                || self.cells.contains_key(&(cell, (face.leaf, face.placement, face.facet, [0; 4])));
            if !is_mesh(&program.surface(face.surface).surface) && is_known() {
                continue;
            }
            let hit = Hit { face, point, normal: piece.normals()[end] };
            self.insert((cell, key(&hit, grid, program)), hit);
        }
    }

    fn insert(&mut self, key: (Cell, FaceKey), hit: Hit) {
        if self.cells.len() < MAX_HITS {
            self.cells.entry(key).or_insert(hit);
        } else if !self.cells.contains_key(&key) {
            self.left_out += 1;
        }
    }

    /// Adds the hits of later rays.
    pub fn append(&mut self, other: Hits) {
        self.left_out += other.left_out;
        other.cells.into_iter().for_each(|(key, hit)| self.insert(key, hit));
    }
}

fn is_mesh(surface: &Surface) -> bool {
    match surface {
        Surface::Object(object) => {
            let form: &dyn Any = &*object.form;
            form.is::<MeshForm>()
        }
        _ => false,
    }
}

fn key(hit: &Hit, grid: &Grid, program: &Program) -> FaceKey {
    let Face { leaf, facet, surface, placement } = hit.face;
    let plane = match is_mesh(&program.surface(surface).surface) {
        true => {
            // both senses of the normal describe the same plane
            let [x, y, z] = hit.normal.to_array();
            let first = [x, y, z].into_iter().find(|x| x.abs() > 10.0 / STEPS_OF_PLANES).unwrap_or(1.0);
            let normal = hit.normal * first.signum();
            let offset = normal.dot(hit.point - grid.bounds.lo) / grid.diagonal.max(f64::MIN_POSITIVE);
            [normal.x, normal.y, normal.z, offset].map(|x| (STEPS_OF_PLANES * x).round() as i32)
        }
        false => [0; 4],
    };
    (leaf, placement, facet, plane)
}

/// The surfaces of faces in the frame of the world, by number.
pub(super) struct Surfaces<'p> {
    program: &'p Program,
    numbers: HashMap<FaceKey, usize>,
    surfaces: Vec<(FaceKey, Surface)>,
}

impl<'p> Surfaces<'p> {
    pub fn new(program: &'p Program) -> Surfaces<'p> {
        Surfaces { program, numbers: HashMap::new(), surfaces: Vec::new() }
    }

    /// The number of the surface of a face, hit at a point; `None` if its placement cannot be inverted.
    pub fn number(&mut self, face: Face, point: Vec3, normal: Vec3, grid: &Grid) -> Option<usize> {
        let hit = Hit { face, point, normal };
        let key = key(&hit, grid, self.program);
        if let Some(number) = self.numbers.get(&key) {
            return Some(*number);
        }
        let own = &self.program.surface(face.surface).surface;
        let placed = match is_mesh(own) {
            true => Surface::plane(normal, normal.dot(point)),
            false => {
                let map = self.program.placement(face.placement).0;
                own.transformed(&Transform::from_affine(map).ok()?)
            }
        };
        self.surfaces.push((key, placed));
        self.numbers.insert(key, self.surfaces.len() - 1);
        Some(self.surfaces.len() - 1)
    }

    pub fn key(&self, number: usize) -> FaceKey {
        self.surfaces[number].0
    }

    pub fn get(&self, number: usize) -> &Surface {
        &self.surfaces[number].1
    }

    pub fn stratum(&self, feature: &Ends) -> Stratum<'_> {
        match feature {
            Ends::Apex(number) => match self.get(*number) {
                Surface::Cone(cone) => Stratum::Apex(cone.apex),
                other => Stratum::Common(vec![other]),
            },
            Ends::Common(numbers) => {
                Stratum::Common(numbers.iter().map(|number| self.get(*number)).collect())
            }
        }
    }

    /// The faces that meet there.
    pub fn faces(&self, feature: &Ends) -> Vec<FaceKey> {
        match feature {
            Ends::Apex(number) => vec![self.key(*number)],
            Ends::Common(numbers) => numbers.iter().map(|number| self.key(*number)).collect(),
        }
    }

    fn is_of_mesh(&self, number: usize) -> bool {
        self.key(number).3 != [0; 4]
    }
}

/// A face, edge or corner by the numbers of its surfaces, or the apex of a cone.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Ends {
    Common(Vec<usize>),
    Apex(usize),
}

/// A point of an edge, or a corner, that points into a region.
#[derive(Clone, Debug)]
pub(super) struct Feature {
    pub point: Vec3,
    pub ends: Ends,
    /// The region into which it points, and the one within the edge.
    pub region: RegionId,
    pub beyond: RegionId,
    /// The unit normals of the faces, out of the region. A shortest way from the region ends here if its direction is a sum of
    /// positive multiples of them.
    pub normals: Vec<Vec3>,
}

impl Feature {
    /// Directions in the cone of normals.
    pub fn outward(&self) -> Vec<Vec3> {
        let mean = |parts: &[f64]| -> Option<Vec3> {
            self.normals.iter().zip(parts).map(|(normal, part)| *part * *normal).sum::<Vec3>().try_normalize()
        };
        match self.normals.len() {
            2 => (0..=6).filter_map(|k| mean(&[f64::from(k), f64::from(6 - k)])).collect(),
            3 => [[1.0, 1.0, 1.0], [1.0, 1.0, 0.1], [0.1, 1.0, 1.0], [1.0, 0.1, 1.0]]
                .into_iter()
                .chain([[1.0, 0.1, 0.1], [0.1, 1.0, 0.1], [0.1, 0.1, 1.0]])
                .filter_map(|parts| mean(&parts))
                .collect(),
            _ => self.normals.clone(),
        }
    }
}

/// A candidate, with the points around it whose regions decide.
struct Candidate {
    point: Vec3,
    ends: Ends,
    /// The direction to the middle of each sector.
    sectors: Vec<Vec3>,
    normals: Vec<Vec3>,
}

/// The signs of a sector.
fn signs(sector: usize) -> [f64; 3] {
    [0, 1, 2].map(|k| if sector >> k & 1 == 0 { 1.0 } else { -1.0 })
}

/// Directions along which each of two or three linear functions with these gradients has the same magnitude, one for each pattern of
/// signs; `None` if the gradients are nearly dependent.
fn sectors(units: &[Vec3], least_sine: f64) -> Option<Vec<Vec3>> {
    let duals = match *units {
        [a, b] => {
            let cosine = a.dot(b);
            let square = 1.0 - cosine * cosine;
            if square < least_sine * least_sine {
                return None;
            }
            vec![(a - cosine * b) / square, (b - cosine * a) / square]
        }
        [a, b, c] => {
            let volume = a.dot(b.cross(c));
            if volume.abs() < least_sine * least_sine {
                return None;
            }
            vec![b.cross(c) / volume, c.cross(a) / volume, a.cross(b) / volume]
        }
        _ => return None,
    };
    let direction = |sector: usize| -> Vec3 {
        let sum: Vec3 = duals.iter().zip(signs(sector)).map(|(dual, sign)| sign * *dual).sum();
        sum.normalize_or_zero()
    };
    Some((0..1 << units.len()).map(direction).collect())
}

/// The edges and corners that point into a region, and the number of candidates that were left out; `leaves` is the number that a ray
/// reaches.
pub(super) fn features<E: Evaluator>(
    evaluator: &E,
    hits: &Hits,
    grid: &Grid,
    surfaces: &mut Surfaces<'_>,
    (leaves, budget): (u64, &mut Budget),
    scratch: &mut E::Scratch,
) -> (Vec<Feature>, u64) {
    let of_point = 1 + (WORK_OF_POINT * leaves as f64) as u64;
    let mut cells: BTreeMap<Cell, Vec<usize>> = BTreeMap::new();
    let mut cones = BTreeSet::new();
    for ((cell, _), hit) in &hits.cells {
        let Some(number) = surfaces.number(hit.face, hit.point, hit.normal, grid) else { continue };
        cells.entry(*cell).or_default().push(number);
        if matches!(surfaces.get(number), Surface::Cone(_)) {
            cones.insert(number);
        }
    }
    let (mut candidates, mut left_out, mut tried) = (Vec::new(), hits.left_out, 0);
    for cell in cells.keys() {
        let mut near: Vec<usize> = Vec::new();
        for step in 0..27i16 {
            let beside = [cell[0] + step % 3 - 1, cell[1] + step / 3 % 3 - 1, cell[2] + step / 9 - 1];
            near.extend(cells.get(&beside).into_iter().flatten());
        }
        near.sort_unstable();
        near.dedup();
        left_out += near.len().saturating_sub(MAX_FACES) as u64;
        near.truncate(MAX_FACES);
        let middle = grid.middle(*cell);
        let mut edges = Vec::new();
        for (k, &a) in near.iter().enumerate() {
            for &b in &near[k + 1..] {
                if tried == MAX_CANDIDATES || !budget.takes(WORK_OF_PAIR) {
                    left_out += 1;
                    continue;
                }
                tried += 1;
                let Some(candidate) = common(surfaces, vec![a, b], middle, grid) else { continue };
                if budget.takes(candidate.sectors.len() as u64 * of_point) {
                    candidates.push(candidate);
                    edges.push((a, b));
                } else {
                    left_out += 1;
                }
            }
        }
        // a corner of three faces is an end of the edge of two of them
        if !edges.is_empty() {
            left_out += edges.len().saturating_sub(MAX_FACES_OF_CORNERS * MAX_FACES_OF_CORNERS) as u64;
            left_out += near.len().saturating_sub(MAX_FACES_OF_CORNERS) as u64;
        }
        let mut corners = BTreeSet::new();
        for &(a, b) in edges.iter().take(MAX_FACES_OF_CORNERS * MAX_FACES_OF_CORNERS) {
            for &c in near.iter().take(MAX_FACES_OF_CORNERS) {
                let mut three = [a, b, c];
                three.sort_unstable();
                if c == a || c == b || !corners.insert(three) {
                    continue;
                }
                if tried == MAX_CANDIDATES || !budget.takes(WORK_OF_PAIR) {
                    left_out += 1;
                    continue;
                }
                tried += 1;
                let Some(candidate) = common(surfaces, three.to_vec(), middle, grid) else { continue };
                match budget.takes(candidate.sectors.len() as u64 * of_point) {
                    true => candidates.push(candidate),
                    false => left_out += 1,
                }
            }
        }
    }
    candidates.extend(cones.into_iter().filter_map(|number| apex(surfaces, number, grid)));
    (pointing(evaluator, candidates, ASIDE * grid.diagonal, scratch), left_out)
}

/// The common point of two or three surfaces that is nearest to the middle of a cell, if it is in the cell or next to it.
fn common(surfaces: &Surfaces<'_>, numbers: Vec<usize>, middle: Vec3, grid: &Grid) -> Option<Candidate> {
    let ends = Ends::Common(numbers);
    let (point, units) = surfaces.stratum(&ends).project(middle)?;
    if (point - middle).abs().max_element() > 0.75 * grid.size {
        return None;
    }
    let Ends::Common(numbers) = &ends else { return None };
    let has_mesh = numbers.iter().any(|number| surfaces.is_of_mesh(*number));
    let sectors = sectors(&units, if has_mesh { LEAST_SINE_OF_MESH } else { LEAST_SINE })?;
    Some(Candidate { point, ends, sectors, normals: units })
}

/// The apex of a cone, with the directions of its axis and across it.
fn apex(surfaces: &Surfaces<'_>, number: usize, grid: &Grid) -> Option<Candidate> {
    let Surface::Cone(cone) = surfaces.get(number) else { return None };
    grid.cell(cone.apex)?;
    let side = cone.axis.any_orthonormal_vector();
    let other = cone.axis.cross(side);
    let sectors = vec![cone.axis, -cone.axis, side, -side, other, -other];
    Some(Candidate {
        point: cone.apex,
        ends: Ends::Apex(number),
        sectors,
        normals: vec![cone.axis, -cone.axis],
    })
}

/// The candidates that point into a region: around them, all but one sector are in it.
fn pointing<E: Evaluator>(
    evaluator: &E,
    candidates: Vec<Candidate>,
    step: f64,
    scratch: &mut E::Scratch,
) -> Vec<Feature> {
    let points = candidates.iter().flat_map(|own| own.sectors.iter().map(|way| own.point + step * *way));
    let regions = regions_at(evaluator, points, scratch);
    let mut first = 0;
    let mut found = Vec::new();
    for Candidate { point, ends, sectors, normals } in candidates {
        let around = &regions[first..first + sectors.len()];
        first += sectors.len();
        let odd = (0..around.len()).find(|&k| {
            let mut others = (0..around.len()).filter(|&j| j != k).map(|j| around[j]);
            let region = others.next();
            region != Some(around[k]) && others.all(|other| Some(other) == region)
        });
        let Some(odd) = odd else { continue };
        let (beyond, region) = (around[odd], around[usize::from(odd == 0)]);
        let normals = match ends {
            // the way must be in the sector itself: across the axis, the cone cannot be alone
            Ends::Apex(_) if odd >= 2 => continue,
            Ends::Apex(_) => vec![normals[odd]],
            Ends::Common(_) => normals.iter().zip(signs(odd)).map(|(unit, sign)| sign * *unit).collect(),
        };
        found.push(Feature { point, ends, region, beyond, normals });
    }
    found
}

/// The regions of points.
pub(super) fn regions_at<E: Evaluator>(
    evaluator: &E,
    points: impl Iterator<Item = Vec3>,
    scratch: &mut E::Scratch,
) -> Vec<RegionId> {
    let mut columns = [Vec::new(), Vec::new(), Vec::new()];
    for point in points {
        columns.iter_mut().zip(point.to_array()).for_each(|(column, x)| column.push(x));
    }
    let mut regions = vec![RegionId(0); columns[0].len()];
    evaluator.regions_at([&columns[0], &columns[1], &columns[2]], scratch, &mut regions);
    regions
}
