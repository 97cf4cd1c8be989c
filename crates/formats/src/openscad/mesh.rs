//! Solids bounded by triangles: `polyhedron`, and `linear_extrude` with twist.
//!
//! Inside and outside follow the even-odd rule along a ray. Faces may therefore be triangulated as fans, whose triangles
//! overlap if the face is not convex.

use super::arguments::{Arguments, Refusal, vector};
use super::budget::TRIANGLE;
use super::convex_hull::{convex_hull, planes, volume};
use super::extent::Way;
use super::facets::{Fineness, ring_points};
use super::flat::{Flat, Flats, index};
use super::part::Part;
use super::part::solid;
use super::region::{Contours, faceted_boundary, filled};
use super::shell::Shell;
use super::value::Value;
use crate::kernel::triangulated;
use i_overlay::core::fill_rule::FillRule;
use rayweave_math::{Vec3, sin_cos_degrees};
use rayweave_model::Solid;
use rayweave_polygon::Point;
use rayweave_shape::primitive::{Convex, Mesh};

/// Maximum number of slices of an extrusion, for the same reason.
const MAX_SLICES: f64 = 20_000.0;

/// Relative tolerance for planes through three points: coordinates are printed with six digits.
const DIGITS: f64 = 2e-5;

/// Maximum number of faces of a convex solid given by planes; larger polyhedra are faster as a mesh, which has a BVH.
pub(super) const MAX_PLANES: usize = 64;

pub(super) fn within(
    arguments: &Arguments,
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
) -> Result<Solid, Refusal> {
    arguments.spend(TRIANGLE * triangles.len())?;
    let mesh = rayweave_mesh::Mesh::new(vertices, triangles);
    let mesh = mesh.map_err(|error| arguments.refusal(&error.to_string()))?;
    solid(arguments, Mesh::new(&mesh))
}

/// A convex solid as an intersection of half-spaces or, if there are many, as a mesh.
pub(super) fn convex(
    arguments: &Arguments,
    planes: Vec<[f64; 4]>,
    mesh: impl FnOnce() -> (Vec<Vec3>, Vec<[u32; 3]>),
) -> Result<Solid, Refusal> {
    if planes.len() <= MAX_PLANES {
        return solid(arguments, Convex::new(planes));
    }
    let (vertices, triangles) = mesh();
    within(arguments, vertices, triangles)
}

/// The solid between rings (radius, z) of `fragments` vertices each, from the top down. A ring may be a point.
pub(super) fn between_rings(rings: &[[f64; 2]], fragments: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let count = |ring: &[f64; 2]| if ring[0] > 0.0 { fragments as u32 } else { 1 };
    let mut triangles = Vec::new();
    let mut upper = 0;
    for pair in rings.windows(2) {
        let (m, n) = (count(&pair[0]), count(&pair[1]));
        let lower = upper + m;
        for k in 0..fragments as u32 {
            let [a, b] = [upper + k % m, upper + (k + 1) % m];
            let [c, d] = [lower + k % n, lower + (k + 1) % n];
            triangles.extend([[a, c, d], [a, d, b]].into_iter().filter(|t| t[0] != t[2] && t[1] != t[2]));
        }
        upper = lower;
    }
    let last = rings.last().map_or(1, count);
    triangles.extend((1..rings.first().map_or(1, count).max(2) - 1).map(|k| [0, k, k + 1]));
    triangles.extend((1..last.max(2) - 1).map(|k| [upper, upper + k + 1, upper + k]));
    (ring_points(rings, fragments), triangles)
}

/// Points of a `polyhedron`, and triangles that are counter-clockwise seen from outside: OpenSCAD lists the corners of a face
/// clockwise.
pub(super) fn parts(arguments: &Arguments) -> Result<(Vec<Vec3>, Vec<[usize; 3]>), Refusal> {
    let (points, faces) = points_and_faces(arguments)?;
    for face in &faces {
        // the search for ears compares all corners; larger faces are not searched
        let corners = face.len();
        arguments.spend(if corners > 1000 {
            100 * corners
        } else {
            corners * corners * (10 + corners / 5)
        })?;
    }
    let mut ears = rayweave_mesh::EarBudget::default();
    let turned = |[a, b, c]: [usize; 3]| [a, c, b];
    let triangles = faces.iter().flat_map(|face| cut(&points, face, &mut ears)).map(turned).collect();
    Ok((points, triangles))
}

fn points_and_faces(arguments: &Arguments) -> Result<(Vec<Vec3>, Vec<Vec<usize>>), Refusal> {
    let points = arguments.get("points", "a list of points (x, y, z), all finite", |value| {
        value.list()?.iter().map(vector).collect::<Option<Vec<Vec3>>>()
    })?;
    let points = points.unwrap_or_default();
    let wanted = "a list of lists of point indices";
    let given = match arguments.get("faces", wanted, faces)? {
        Some(given) => given,
        // the name of the argument in older dumps
        None => arguments.get("triangles", wanted, faces)?.unwrap_or_default(),
    };
    if given.iter().any(|face| face.len() > points.len()) {
        return Err(arguments.refusal("a face has more corners than there are points"));
    }
    if let Some(number) = given.iter().flatten().find(|number| **number >= points.len()) {
        return Err(
            arguments.refusal(&format!("a face refers to point {number}, but there are {}", points.len()))
        );
    }
    Ok((points, given))
}

/// Number of non-planar faces of a `polyhedron`, beyond the six-digit rounding of a dump.
pub(super) fn bent_faces(arguments: &Arguments) -> Result<usize, Refusal> {
    let (points, faces) = points_and_faces(arguments)?;
    Ok(faces.iter().filter(|face| face.len() > 3 && is_bent(&points, face)).count())
}

fn is_bent(points: &[Vec3], face: &[usize]) -> bool {
    let first = points[face[0]];
    let from_first = |k: usize| points[face[k % face.len()]] - first;
    // M. E. Newell's normal
    let across: Vec3 = (0..face.len()).map(|k| from_first(k).cross(from_first(k + 1))).sum();
    let normal = across.normalize_or_zero();
    let far = face.iter().map(|k| points[*k].abs().max_element()).fold(0.0, f64::max);
    (0..face.len()).any(|k| normal.dot(from_first(k)).abs() > DIGITS * far)
}

/// `polyhedron(points, faces)`: half-spaces if it is convex, else triangles.
pub(super) fn polyhedron(arguments: &Arguments) -> Result<Part, Refusal> {
    let (points, triangles) = parts(arguments)?;
    if triangles.is_empty() {
        return Ok(Part::Empty);
    }
    if let Some(planes) =
        convex_planes(arguments, &points, &triangles)?.filter(|planes| planes.len() <= MAX_PLANES)
    {
        return Ok(solid(arguments, Convex::new(planes))?.into());
    }
    let triangles = triangles.iter().map(|corners| corners.map(|k| k as u32)).collect();
    Ok(within(arguments, points, triangles)?.into())
}

/// True if a `polyhedron` is the convex hull of its points.
pub(super) fn is_convex(arguments: &Arguments) -> Result<bool, Refusal> {
    let (points, triangles) = parts(arguments)?;
    Ok(convex_planes(arguments, &points, &triangles)?.is_some())
}

fn faces(value: &Value) -> Option<Vec<Vec<usize>>> {
    let face = |value: &Value| value.numbers()?.into_iter().map(index).collect::<Option<Vec<usize>>>();
    value.list()?.iter().map(face).collect()
}

/// Triangulation of a face.
fn cut(points: &[Vec3], face: &[usize], ears: &mut rayweave_mesh::EarBudget) -> Vec<[usize; 3]> {
    match face.len() {
        0..3 => Vec::new(),
        3 => vec![[face[0], face[1], face[2]]],
        _ => {
            let corners: Vec<u32> = face.iter().map(|k| *k as u32).collect();
            let (triangles, _) = rayweave_mesh::triangulate_polygon(points, &corners, ears);
            triangles.into_iter().map(|t| t.map(|k| k as usize)).collect()
        }
    }
}

/// The planes of a polyhedron that equals the convex hull of its points, else `None`.
fn convex_planes(
    arguments: &Arguments,
    points: &[Vec3],
    triangles: &[[usize; 3]],
) -> Result<Option<Vec<[f64; 4]>>, Refusal> {
    let Some(hull) = convex_hull(arguments, points)? else { return Ok(None) };
    let (own, whole) = (volume(points, triangles).abs(), volume(points, &hull));
    Ok(((whole - own).abs() <= 1e-9 * whole).then(|| planes(points, &hull)))
}

/// Twist of a linear extrusion, and its number of slices.
#[derive(Clone, Copy, Debug)]
pub(super) struct Twist {
    way: Way,
    degrees: f64,
    slices: usize,
}

impl Twist {
    /// The twist of an item, with the slices of OpenSCAD 2021.01: at least three per turn, from `$fn` or the coarser of
    /// `$fa` and `$fs`.
    pub fn new(arguments: &Arguments, flats: &Flats, flat: Flat, way: &Way) -> Result<Twist, Refusal> {
        let degrees = arguments.number("twist", 0.0)?;
        let fineness = Fineness::of(arguments)?;
        let [lo, hi] = flats.bounds(arguments, flat)?;
        let reach = [0, 1].map(|k| hi[k].abs().max(lo[k].abs()));
        let slices = match arguments.number("slices", 0.0)? {
            given if given > MAX_SLICES => {
                return Err(arguments.refusal(&format!("it has more than {MAX_SLICES} slices")));
            }
            given if given >= 1.0 => given as usize,
            _ => fineness.slices(reach, degrees.abs(), way),
        };
        Ok(Twist { way: *way, degrees, slices })
    }

    /// An extrusion without twist, in one slice.
    pub fn plain(way: &Way) -> Twist {
        Twist { way: *way, degrees: 0.0, slices: 1 }
    }

    /// Twisted extrusion of a region. Its parts are united before they are twisted, as in OpenSCAD: walls between them would
    /// not coincide with each other in every slice.
    pub fn solid(&self, arguments: &Arguments, flats: &Flats, flat: Flat) -> Result<Solid, Refusal> {
        let contours = faceted_boundary(arguments, flats, flat)?;
        self.within(arguments, contours)
    }

    /// Extrusion of contours that may cross, filled by the even-odd rule.
    pub fn over(&self, arguments: &Arguments, contours: &Contours) -> Result<Solid, Refusal> {
        let contours = filled(arguments, contours, FillRule::EvenOdd)?;
        self.within(arguments, contours)
    }

    fn within(&self, arguments: &Arguments, contours: Contours) -> Result<Solid, Refusal> {
        let shell = self.shell(arguments, contours)?;
        match shell.triangles.is_empty() {
            true => Ok(Solid::empty()),
            false => within(arguments, shell.vertices, shell.triangles),
        }
    }

    /// Extrusion of contours that do not cross (outlines counter-clockwise, holes clockwise), as a mesh without
    /// self-intersections.
    pub fn shell(&self, arguments: &Arguments, contours: Contours) -> Result<Shell, Refusal> {
        let count: usize = contours.iter().map(Vec::len).sum();
        self.check(arguments, count)?;
        // triangulation takes quadratic time for outlines with many nearly collinear points
        arguments.spend(count.saturating_mul(20 * count))?;
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        let (mut bottom, mut top) = (Vec::new(), Vec::new());
        for contour in &contours {
            let (start, n) = (vertices.len() as u32, contour.len() as u32);
            self.walls(contour, &mut vertices, &mut triangles);
            bottom.extend(start..start + n);
            top.extend(vertices.len() as u32 - n..vertices.len() as u32);
        }
        for [a, b, c] in triangulated(&contours).into_iter().map(|t| t.map(|k| k as usize)) {
            triangles.extend([[bottom[a], bottom[c], bottom[b]], [top[a], top[b], top[c]]]);
        }
        Ok(Shell { vertices, triangles, is_convex: false })
    }

    fn check(&self, arguments: &Arguments, points: usize) -> Result<(), Refusal> {
        arguments.hold(points.saturating_mul(2 * (self.slices + 1)))
    }

    /// Adds the walls over a contour. Each quadrilateral is divided along its shorter diagonal (for equal ones by
    /// orientation and sense of the twist), and along the longer one below a vanishing edge, as in OpenSCAD 2021.01.
    fn walls(&self, contour: &[Point], vertices: &mut Vec<Vec3>, triangles: &mut Vec<[u32; 3]>) {
        let (n, start) = (contour.len() as u32, vertices.len() as u32);
        vertices.extend((0..=self.slices).flat_map(|slice| self.slice(contour, slice)));
        let tie = (signed_area(contour) > 0.0) == (self.degrees > 0.0);
        for slice in 0..self.slices as u32 {
            let vanishes = slice + 1 == self.slices as u32 && self.way.scale.contains(&0.0);
            for k in 0..n {
                let lower = start + n * slice;
                let [a, b] = [lower + k, lower + (k + 1) % n];
                let [c, d] = [a + n, b + n];
                let length = |i: u32, j: u32| flat_distance(vertices[i as usize], vertices[j as usize]);
                match shorter(length(a, d), length(b, c)).unwrap_or(tie) != vanishes {
                    true => triangles.extend([[a, b, d], [a, d, c]]),
                    false => triangles.extend([[a, b, c], [b, d, c]]),
                }
            }
        }
    }

    fn slice<'c>(&self, contour: &'c [Point], slice: usize) -> impl Iterator<Item = Vec3> + use<'c> {
        let t = slice as f64 / self.slices as f64;
        let (sin, cos) = sin_cos_degrees(-self.degrees * t);
        let [fx, fy] = self.way.scale.map(|factor| 1.0 + (factor - 1.0) * t);
        let z = self.way.bottom + (self.way.top - self.way.bottom) * t;
        // rotated, then scaled
        contour
            .iter()
            .map(move |p| Vec3::new(fx * (cos * p[0] - sin * p[1]), fy * (sin * p[0] + cos * p[1]), z))
    }
}

/// Edges of a closed chain of points.
fn edges(contour: &[Point]) -> impl Iterator<Item = (&Point, &Point)> {
    contour.iter().zip(contour.iter().skip(1).chain(contour.first()))
}

/// Twice the signed area, negative for a clockwise contour.
fn signed_area(contour: &[Point]) -> f64 {
    edges(contour).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum()
}

/// Distance between the projections of two points onto the plane.
fn flat_distance(p: Vec3, q: Vec3) -> f64 {
    (p - q).truncate().length()
}

/// Whether the first length is the shorter one; `None` if they differ by less than 10^-5 of their mean: OpenSCAD 2021.01
/// treats such lengths as equal.
fn shorter(a: f64, b: f64) -> Option<bool> {
    let differ = 2e5 * (a - b).abs() > a + b;
    differ.then_some(a < b)
}
