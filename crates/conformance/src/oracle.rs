//! Point classification by direct formulas, independent of every evaluator.
//!
//! Each shape is an inequality, written from the table of shapes; maps are inverted and composed here, by
//! Cramer's rule. The result has three values: within a stated tolerance of a boundary that decides, it is
//! "near" (Kleene's three-valued logic), so that rounding neither hides an error nor causes one.

use rayweave_math::{Affine, Vec3};
use rayweave_model::{Node, Region, Solid};
use rayweave_shape::primitive::{Primitive, Value};

/// Outside, near a boundary that decides, or inside: ordered, so that "and" is `min` and "or" is `max`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// Outside by more than the tolerance.
    Outside,
    /// Within the tolerance of a boundary that decides.
    Near,
    /// Inside by more than the tolerance.
    Inside,
}

impl Side {
    fn of(depth: f64, tolerance: f64) -> Side {
        match () {
            () if depth > tolerance => Side::Inside,
            () if depth < -tolerance => Side::Outside,
            () => Side::Near,
        }
    }

    fn not(self) -> Side {
        match self {
            Side::Outside => Side::Inside,
            Side::Near => Side::Near,
            Side::Inside => Side::Outside,
        }
    }

    fn xor(self, other: Side) -> Side {
        match other {
            Side::Outside => self,
            Side::Near => Side::Near,
            Side::Inside => self.not(),
        }
    }
}

/// The affine map `p -> rows . p + shift`, with its own arithmetic.
#[derive(Clone, Copy)]
struct Map {
    rows: [[f64; 3]; 3],
    shift: [f64; 3],
}

impl Map {
    const IDENTITY: Map = Map { rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], shift: [0.0; 3] };

    fn apply(&self, p: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| {
            self.rows[i][0] * p[0] + self.rows[i][1] * p[1] + self.rows[i][2] * p[2] + self.shift[i]
        })
    }

    /// The inverse of an affine map by Cramer's rule.
    fn inverse_of(map: &Affine) -> Map {
        let m = map.to_rows();
        let minor = |i: usize, j: usize| {
            let (a, b) = ((i + 1) % 3, (i + 2) % 3);
            let (c, d) = ((j + 1) % 3, (j + 2) % 3);
            m[a][c] * m[b][d] - m[a][d] * m[b][c]
        };
        let determinant: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
        let rows: [[f64; 3]; 3] = std::array::from_fn(|i| std::array::from_fn(|j| minor(j, i) / determinant));
        let shift =
            std::array::from_fn(|i| -(rows[i][0] * m[0][3] + rows[i][1] * m[1][3] + rows[i][2] * m[2][3]));
        Map { rows, shift }
    }

    /// The composition: this map first, then `next`.
    fn then(&self, next: &Map) -> Map {
        let rows = std::array::from_fn(|i| {
            std::array::from_fn(|j| (0..3).map(|k| next.rows[i][k] * self.rows[k][j]).sum())
        });
        Map { rows, shift: next.apply(self.shift) }
    }

    fn norm(&self) -> f64 {
        self.rows.iter().flatten().map(|e| e * e).sum::<f64>().sqrt()
    }
}

enum Step {
    Shape(Box<Placed>),
    Constant(Side),
    Not,
    All(usize),
    Any(usize),
    Odd(usize),
}

/// A shape with its map and error factors.
struct Placed {
    formula: Formula,
    local_from_world: Map,
    /// Upper bound of the factor by which the map lengthens a vector.
    norm: f64,
    /// Upper bound of the factor by which a rounding error grows through the map and back.
    condition: f64,
    /// Sum of the lengths of the translations on the path.
    way: f64,
}

impl Placed {
    fn side(&self, probe: Probe) -> Side {
        let p = self.local_from_world.apply(probe.point.to_array());
        let world = (probe.origin + probe.point.length() + self.way) * self.norm;
        let local = p.iter().map(|x| x.abs()).sum::<f64>() + self.formula.size();
        self.formula.side(p, TOLERANCE * self.condition * (world + local))
    }
}

/// The formulas of a solid, in postfix order.
pub struct Oracle {
    steps: Vec<Step>,
}

/// A point of a ray, with the length that determines its rounding error.
#[derive(Clone, Copy, Debug)]
pub struct Probe {
    /// The point.
    pub point: Vec3,
    /// The distance of the ray's origin from the origin of the world.
    pub origin: f64,
}

/// Tolerance per unit of the lengths involved: a point this close to a boundary may be on either side. About
/// 140 times the tolerance of the weld, to cover the compositions of maps and the slack of the bounds used
/// here.
pub const TOLERANCE: f64 = 1e-12;

impl Oracle {
    /// The oracle of a solid of moderate depth.
    pub fn new(solid: &Solid) -> Oracle {
        let mut oracle = Oracle { steps: Vec::new() };
        oracle.add(solid, &Map::IDENTITY, 1.0, 0.0);
        oracle
    }

    fn add(&mut self, solid: &Solid, map: &Map, world_norm: f64, way: f64) {
        match solid.node() {
            Node::Empty => self.steps.push(Step::Constant(Side::Outside)),
            Node::Universe => self.steps.push(Step::Constant(Side::Inside)),
            Node::Primitive(primitive) => {
                let norm = map.norm();
                self.steps.push(Step::Shape(Box::new(Placed {
                    formula: Formula::new(primitive),
                    local_from_world: *map,
                    norm,
                    condition: (norm * world_norm).max(1.0),
                    way,
                })));
            }
            Node::Complement(a) => {
                self.add(a, map, world_norm, way);
                self.steps.push(Step::Not);
            }
            Node::Union(all) => self.add_all(all, Step::Any, map, world_norm, way),
            Node::Intersection(all) => self.add_all(all, Step::All, map, world_norm, way),
            Node::SymmetricDifference(all) => self.add_all(all, Step::Odd, map, world_norm, way),
            Node::Difference(a, b) => {
                self.add(a, map, world_norm, way);
                self.add(b, map, world_norm, way);
                self.steps.extend([Step::Not, Step::All(2)]);
            }
            Node::Transformed(by, a) => self.add_moved(a, &by.get(), map, world_norm, way),
            Node::Named(_, a) => self.add(a, map, world_norm, way),
            Node::Placed(a, maps) => {
                maps.iter().for_each(|by| self.add_moved(a, by, map, world_norm, way));
                self.steps.push(Step::Any(maps.len()));
            }
        }
    }

    fn add_all(&mut self, all: &[Solid], join: fn(usize) -> Step, map: &Map, norm: f64, way: f64) {
        all.iter().for_each(|a| self.add(a, map, norm, way));
        self.steps.push(join(all.len()));
    }

    fn add_moved(&mut self, solid: &Solid, by: &Affine, map: &Map, world_norm: f64, way: f64) {
        let back = Map::inverse_of(by);
        let forth = by.to_rows()[..3].iter().flat_map(|row| &row[..3]).map(|e| e * e).sum::<f64>().sqrt();
        let shift = by.translation.length() * world_norm;
        // the Frobenius norm exceeds the spectral norm by a factor of up to sqrt(3), which must not
        // accumulate per map
        self.add(solid, &map.then(&back), world_norm * (forth / 3f64.sqrt()).max(1e-3), way + shift);
    }

    /// The side of a point.
    pub fn side(&self, probe: Probe) -> Side {
        let mut stack: Vec<Side> = Vec::with_capacity(16);
        for step in &self.steps {
            let joined = |stack: &mut Vec<Side>, count: usize, neutral, join: fn(Side, Side) -> Side| {
                let from = stack.len() - count;
                stack.drain(from..).fold(neutral, join)
            };
            let side = match step {
                Step::Constant(side) => *side,
                Step::Shape(placed) => placed.side(probe),
                Step::Not => joined(&mut stack, 1, Side::Outside, |_, b| b.not()),
                Step::All(count) => joined(&mut stack, *count, Side::Inside, Side::min),
                Step::Any(count) => joined(&mut stack, *count, Side::Outside, Side::max),
                Step::Odd(count) => joined(&mut stack, *count, Side::Outside, Side::xor),
            };
            stack.push(side);
        }
        stack.pop().unwrap_or(Side::Near)
    }
}

/// The medium at a point of an ordered list of regions, or `None` near a boundary that decides.
pub fn medium(regions: &[Region], oracles: &[Oracle], probe: Probe) -> Option<u32> {
    for (region, oracle) in regions.iter().zip(oracles).rev() {
        match oracle.side(probe) {
            Side::Inside => return Some(region.medium),
            Side::Near => return None,
            Side::Outside => {}
        }
    }
    Some(0)
}

/// The inequalities of a shape: all of them hold inside (for a wide wedge, any of them).
enum Formula {
    Ball(f64),
    Ellipsoid([f64; 3]),
    Box([f64; 3], [f64; 3]),
    /// Radius at z = lo, radius at z = hi, lo, hi; and the radius of a coaxial hole.
    Frustum([f64; 2], [f64; 2], f64),
    Torus(f64, f64),
    Paraboloid(f64, f64),
    Quadric([[f64; 4]; 4]),
    /// Rows (n, d): n . p < d.
    Planes(Vec<([f64; 3], f64)>),
    AnyPlane(Vec<([f64; 3], f64)>),
    /// The corners of the triangles of a closed mesh.
    Triangles(Vec<[[f64; 3]; 3]>),
    /// Above a sag, in its aperture and below a height.
    Sag(Sag),
}

/// A conic or biconic with terms in powers of x, y and r = sqrt(x^2 + y^2).
struct Sag {
    aperture: f64,
    height: f64,
    curvatures: [f64; 2],
    conics: [f64; 2],
    terms: Vec<Term>,
}

/// The exponents of x, y and r, and the coefficient.
type Term = ([u32; 3], f64);

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Number(x) => vec![*x],
        Value::Vector(list) => list.clone(),
        Value::Rows(rows) => rows.concat(),
    }
}

fn triple(list: &[f64]) -> [f64; 3] {
    match list {
        [x] => [*x; 3],
        _ => [list[0], list[1], list[2]],
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn turn(degrees: f64) -> [f64; 2] {
    let radians = degrees / 180.0 * std::f64::consts::PI;
    [libm::cos(radians), libm::sin(radians)]
}

impl Formula {
    fn new(primitive: &Primitive) -> Formula {
        let arguments = primitive.arguments();
        let list = |name: &str| {
            let found = arguments.iter().find(|(n, _)| *n == name);
            numbers(&found.unwrap_or_else(|| panic!("{} without {name}", primitive.name())).1)
        };
        let number = |name: &str| list(name)[0];
        let caps = |height: f64| [-height / 2.0, height / 2.0];
        match primitive.name() {
            "sphere" => Formula::Ball(number("radius")),
            "ellipsoid" => Formula::Ellipsoid(triple(&list("radii"))),
            "box" => {
                let half = triple(&list("size")).map(|s| s / 2.0);
                Formula::Box(half.map(|h| -h), half)
            }
            "box_from_corners" => Formula::Box(triple(&list("lo")), triple(&list("hi"))),
            "cylinder" => Formula::Frustum([number("radius"); 2], caps(number("height")), 0.0),
            "cone" => Formula::Frustum([number("radius1"), number("radius2")], caps(number("height")), 0.0),
            "tube" => {
                let outer = [number("outer_radius"); 2];
                Formula::Frustum(outer, caps(number("height")), number("inner_radius"))
            }
            "half_space" => Formula::Planes(vec![(triple(&list("normal")), number("offset"))]),
            "slab" => {
                let n = triple(&list("normal"));
                Formula::Planes(vec![(n, number("hi")), (n.map(|x| -x), -number("lo"))])
            }
            "torus" => Formula::Torus(number("major"), number("minor")),
            "paraboloid" => Formula::Paraboloid(number("focal_length"), number("height")),
            "quadric" => {
                let m = list("matrix");
                Formula::Quadric(std::array::from_fn(|i| std::array::from_fn(|j| m[4 * i + j])))
            }
            "wedge" => wedge(number("start_degrees"), number("sweep_degrees")),
            "prism" => prism(number("sides"), number("radius"), number("height")),
            "convex" => {
                let rows = list("planes");
                Formula::Planes(rows.chunks(4).map(|r| (triple(r), r[3])).collect())
            }
            "mesh" => {
                let (vertices, faces) = (list("vertices"), list("faces"));
                let corner = |k: f64| triple(&vertices[3 * k as usize..3 * k as usize + 3]);
                Formula::Triangles(faces.chunks(3).map(|face| triple(face).map(corner)).collect())
            }
            "asphere" => Formula::Sag(Sag {
                aperture: number("aperture"),
                height: number("height"),
                curvatures: [number("curvature"); 2],
                conics: [number("conic"); 2],
                terms: radial_terms(&list("even"), &list("odd")),
            }),
            "biconic" => Formula::Sag(Sag {
                aperture: number("aperture"),
                height: number("height"),
                curvatures: [number("curvature_x"), number("curvature_y")],
                conics: [number("conic_x"), number("conic_y")],
                terms: Vec::new(),
            }),
            "freeform" => {
                let aperture = number("aperture");
                let given = number("norm_radius");
                let norm = if given > 0.0 { given } else { aperture };
                let mut terms = xy_terms(&list("xy"));
                terms.extend(noll_terms(&list("zernike")));
                for (powers, c) in &mut terms {
                    *c /= libm::pow(norm, f64::from(powers.iter().sum::<u32>()));
                }
                Formula::Sag(Sag {
                    aperture,
                    height: number("height"),
                    curvatures: [number("curvature"); 2],
                    conics: [number("conic"); 2],
                    terms,
                })
            }
            other => panic!("the oracle has no formula for {other}: write one"),
        }
    }

    /// A length that bounds the shape's own parameters.
    fn size(&self) -> f64 {
        let finite = |list: &[f64]| list.iter().filter(|x| x.is_finite()).map(|x| x.abs()).sum::<f64>();
        match self {
            Formula::Ball(r) => *r,
            Formula::Ellipsoid(radii) => finite(radii),
            Formula::Box(lo, hi) => finite(lo) + finite(hi),
            Formula::Frustum(radii, z, hole) => finite(radii) + finite(z) + hole,
            Formula::Torus(major, minor) => major + minor,
            Formula::Paraboloid(focal, height) => finite(&[*focal, *height]),
            Formula::Quadric(_) => 1.0,
            Formula::Triangles(all) => all.iter().flatten().flatten().fold(0.0, |most, x| x.abs().max(most)),
            Formula::Sag(sag) => sag.aperture + sag.size() + finite(&[sag.height]),
            Formula::Planes(rows) | Formula::AnyPlane(rows) => {
                rows.iter().map(|(n, d)| d.abs() / dot(*n, *n).sqrt()).fold(0.0, f64::max)
            }
        }
    }

    /// The side of a point in the shape's own frame, with a tolerance for its position.
    fn side(&self, p: [f64; 3], tolerance: f64) -> Side {
        let [x, y, z] = p;
        let rho = (x * x + y * y).sqrt();
        let plane = |(n, d): &([f64; 3], f64)| Side::of(d - dot(*n, p), tolerance * dot(*n, *n).sqrt());
        let between = |v: f64, lo: f64, hi: f64| Side::of((v - lo).min(hi - v), tolerance);
        match self {
            Formula::Ball(r) => Side::of(r - dot(p, p).sqrt(), tolerance),
            Formula::Ellipsoid(radii) => {
                let scaled: [f64; 3] = std::array::from_fn(|k| p[k] / radii[k]);
                let slope: [f64; 3] = std::array::from_fn(|k| scaled[k] / radii[k]);
                let bend = radii.iter().map(|r| 1.0 / (r * r)).fold(0.0, f64::max);
                let error = tolerance * (2.0 * dot(slope, slope).sqrt() + bend * tolerance);
                Side::of(1.0 - dot(scaled, scaled), error)
            }
            Formula::Box(lo, hi) => (0..3).map(|k| between(p[k], lo[k], hi[k])).min().unwrap_or(Side::Near),
            Formula::Frustum([r1, r2], [lo, hi], hole) => {
                let slope = if hi.is_finite() { (r2 - r1) / (hi - lo) } else { 0.0 };
                let radius = if slope == 0.0 { *r1 } else { r1 + slope * (z - lo) };
                let wall = Side::of(radius - rho, tolerance * (1.0 + slope.abs()));
                let bore = if *hole > 0.0 { Side::of(rho - hole, tolerance) } else { Side::Inside };
                wall.min(bore).min(between(z, *lo, *hi))
            }
            Formula::Torus(major, minor) => {
                let from_ring = ((rho - major) * (rho - major) + z * z).sqrt();
                Side::of(minor - from_ring, tolerance)
            }
            Formula::Paraboloid(focal, height) => {
                let error = tolerance * (2.0 * rho + 4.0 * focal + tolerance);
                Side::of(4.0 * focal * z - rho * rho, error).min(Side::of(height - z, tolerance))
            }
            Formula::Quadric(q) => {
                let h = [x, y, z, 1.0];
                let row = |i: usize| (0..4).map(|j| q[i][j] * h[j]).sum::<f64>();
                let value: f64 = (0..4).map(|i| h[i] * row(i)).sum();
                let size: f64 = q.iter().flatten().map(|e| e.abs()).sum();
                let slope = 2.0 * dot([row(0), row(1), row(2)], [row(0), row(1), row(2)]).sqrt();
                // the value is a sum of terms of this magnitude
                let terms =
                    (0..4).map(|i| (0..4).map(|j| (h[i] * q[i][j] * h[j]).abs()).sum::<f64>()).sum::<f64>();
                Side::of(-value, tolerance * (slope + size * tolerance) + 1e-14 * terms)
            }
            Formula::Sag(sag) => {
                // near the wall the result is Near, whatever the sag beyond it
                let (value, slope) = sag.depth(p);
                let surface = Side::of(value, tolerance * (1.0 + slope));
                let cap = Side::of(sag.height - z, tolerance);
                Side::of(sag.aperture - rho, tolerance).min(surface).min(cap)
            }
            Formula::Planes(rows) => rows.iter().map(plane).min().unwrap_or(Side::Inside),
            Formula::AnyPlane(rows) => rows.iter().map(plane).max().unwrap_or(Side::Outside),
            Formula::Triangles(all) => {
                let distance = all.iter().map(|t| distance(*t, p)).fold(f64::INFINITY, f64::min);
                let turns: f64 = all.iter().map(|t| solid_angle(*t, p)).sum::<f64>() / std::f64::consts::TAU;
                // 2 per full turn; nested shells add more turns
                let is_inside = (0.5 * turns).round().rem_euclid(2.0) == 1.0;
                Side::of(if is_inside { distance } else { -distance }, tolerance)
            }
        }
    }
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// The signed solid angle of a triangle, seen from a point: the formula of A. Van Oosterom and J. Strackee
/// (1983).
fn solid_angle(triangle: [[f64; 3]; 3], p: [f64; 3]) -> f64 {
    let [a, b, c] = triangle.map(|corner| minus(corner, p));
    let [x, y, z] = [a, b, c].map(|v| dot(v, v).sqrt());
    let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
    2.0 * libm::atan2(dot(a, cross), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y)
}

/// The distance of a point from a triangle: the minimum over its edges and, if the foot is inside, its plane.
fn distance(triangle: [[f64; 3]; 3], p: [f64; 3]) -> f64 {
    let to_edge = |k: usize| {
        let (a, b) = (triangle[k], triangle[(k + 1) % 3]);
        let (edge, away) = (minus(b, a), minus(p, a));
        let part = (dot(edge, away) / dot(edge, edge)).clamp(0.0, 1.0);
        let foot = std::array::from_fn(|k| away[k] - part * edge[k]);
        dot(foot, foot).sqrt()
    };
    let [a, b, c] = triangle;
    let (u, v, away) = (minus(b, a), minus(c, a), minus(p, a));
    let (uu, uv, vv) = (dot(u, u), dot(u, v), dot(v, v));
    let (up, vp, det) = (dot(u, away), dot(v, away), uu * vv - uv * uv);
    let (s, t) = ((vv * up - uv * vp) / det, (uu * vp - uv * up) / det);
    let edges = (0..3).map(to_edge).fold(f64::INFINITY, f64::min);
    if s > 0.0 && t > 0.0 && s + t < 1.0 {
        let foot: [f64; 3] = std::array::from_fn(|k| away[k] - s * u[k] - t * v[k]);
        return edges.min(dot(foot, foot).sqrt());
    }
    edges
}

impl Sag {
    /// The sum of the magnitudes of all terms at the rim.
    fn size(&self) -> f64 {
        let base = self.curvatures[0].abs().max(self.curvatures[1].abs()) * self.aperture * self.aperture;
        let power = |n: &[u32; 3]| libm::pow(self.aperture, f64::from(n.iter().sum::<u32>()));
        base + self.terms.iter().map(|(n, c)| c.abs() * power(n)).sum::<f64>()
    }

    /// The height above the surface, and an upper bound of the slope nearby.
    fn depth(&self, [x, y, z]: [f64; 3]) -> (f64, f64) {
        let at = |x: f64, y: f64| self.sag(x, y);
        let here = at(x, y);
        let step = 1e-5 * self.aperture;
        let slope = |dx: f64, dy: f64| ((at(x + dx, y + dy) - here) / step).abs();
        let steep = slope(step, 0.0).max(slope(-step, 0.0)) + slope(0.0, step).max(slope(0.0, -step));
        (z - here, 2.0 * steep)
    }

    fn sag(&self, x: f64, y: f64) -> f64 {
        let ([cx, cy], [kx, ky]) = (self.curvatures, self.conics);
        let inner = 1.0 - (1.0 + kx) * cx * cx * x * x - (1.0 + ky) * cy * cy * y * y;
        let base = (cx * x * x + cy * y * y) / (1.0 + inner.max(0.0).sqrt());
        let r = (x * x + y * y).sqrt();
        let power = |v: f64, n: u32| libm::pow(v, f64::from(n));
        self.terms.iter().fold(base, |sum, (n, c)| sum + c * power(x, n[0]) * power(y, n[1]) * power(r, n[2]))
    }
}

/// The powers r^2, r^4, ... and r, r^3, ...
fn radial_terms(even: &[f64], odd: &[f64]) -> Vec<Term> {
    let even = even.iter().zip(1..).map(|(&c, k)| ([0, 0, 2 * k], c));
    let odd = odd.iter().zip(0..).map(|(&c, k)| ([0, 0, 2 * k + 1], c));
    even.chain(odd).collect()
}

/// The powers x, y, x^2, x y, y^2, ...
fn xy_terms(list: &[f64]) -> Vec<Term> {
    let (mut powers, mut degree, mut j) = (Vec::new(), 1, 0);
    for &c in list {
        powers.push(([degree - j, j, 0], c));
        (degree, j) = if j == degree { (degree + 1, 0) } else { (degree, j + 1) };
    }
    powers
}

/// Noll's first fifteen polynomials, from the table in his paper.
fn noll_terms(list: &[f64]) -> Vec<Term> {
    let table: [(f64, &[Term]); 15] = [
        (1.0, &[([0, 0, 0], 1.0)]),
        (4.0, &[([1, 0, 0], 1.0)]),
        (4.0, &[([0, 1, 0], 1.0)]),
        (3.0, &[([0, 0, 2], 2.0), ([0, 0, 0], -1.0)]),
        (6.0, &[([1, 1, 0], 2.0)]),
        (6.0, &[([2, 0, 0], 1.0), ([0, 2, 0], -1.0)]),
        (8.0, &[([0, 1, 2], 3.0), ([0, 1, 0], -2.0)]),
        (8.0, &[([1, 0, 2], 3.0), ([1, 0, 0], -2.0)]),
        (8.0, &[([2, 1, 0], 3.0), ([0, 3, 0], -1.0)]),
        (8.0, &[([3, 0, 0], 1.0), ([1, 2, 0], -3.0)]),
        (5.0, &[([0, 0, 4], 6.0), ([0, 0, 2], -6.0), ([0, 0, 0], 1.0)]),
        (10.0, &[([2, 0, 2], 4.0), ([0, 2, 2], -4.0), ([2, 0, 0], -3.0), ([0, 2, 0], 3.0)]),
        (10.0, &[([1, 1, 2], 8.0), ([1, 1, 0], -6.0)]),
        (10.0, &[([4, 0, 0], 1.0), ([2, 2, 0], -6.0), ([0, 4, 0], 1.0)]),
        (10.0, &[([3, 1, 0], 4.0), ([1, 3, 0], -4.0)]),
    ];
    assert!(list.len() <= table.len(), "the oracle knows Noll's first fifteen polynomials: write more");
    let all = list.iter().zip(table);
    all.flat_map(|(c, (square, terms))| {
        let norm = libm::sqrt(square);
        terms.iter().map(move |(powers, factor)| (*powers, c * norm * factor))
    })
    .collect()
}

/// Left of the first ray and right of the second; above 180 degrees one of the two suffices.
fn wedge(start: f64, sweep: f64) -> Formula {
    let ([c1, s1], [c2, s2]) = (turn(start), turn(start + sweep));
    let rows = vec![([s1, -c1, 0.0], 0.0), ([-s2, c2, 0.0], 0.0)];
    if sweep <= 180.0 { Formula::Planes(rows) } else { Formula::AnyPlane(rows) }
}

fn prism(sides: f64, radius: f64, height: f64) -> Formula {
    let middle = 180.0 / sides;
    let mut rows: Vec<_> = (0..sides as usize)
        .map(|k| {
            let [c, s] = turn((2.0 * k as f64 + 1.0) * middle);
            ([c, s, 0.0], radius * turn(middle)[0])
        })
        .collect();
    if height.is_finite() {
        rows.extend([([0.0, 0.0, 1.0], height / 2.0), ([0.0, 0.0, -1.0], height / 2.0)]);
    }
    Formula::Planes(rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::models::shape;

    fn at(solid: &Solid, x: f64, y: f64, z: f64) -> Side {
        Oracle::new(solid).side(Probe { point: Vec3::new(x, y, z), origin: 0.0 })
    }

    #[test]
    fn sides_of_plain_shapes() {
        let ball = shape("sphere", &[("radius", 1.0)]);
        assert_eq!(at(&ball, 0.9, 0.0, 0.0), Side::Inside);
        assert_eq!(at(&ball, 0.0, 1.0, 0.0), Side::Near);
        assert_eq!(at(&!&ball, 0.9, 0.9, 0.0), Side::Inside);
        let moved = ball.scale([2.0, 1.0, 1.0]).rotate_z(90.0).translate([0.0, 5.0, 0.0]);
        assert_eq!(at(&moved, 0.0, 6.9, 0.0), Side::Inside);
        assert_eq!(at(&moved, 1.1, 5.0, 0.0), Side::Outside);
        let wide = shape("wedge", &[("start_degrees", 0.0), ("sweep_degrees", 270.0)]);
        assert_eq!(at(&wide, -1.0, -1.0, 9.0), Side::Inside);
        assert_eq!(at(&wide, 1.0, -1.0, 9.0), Side::Outside);
        assert_eq!(at(&(&ball ^ &ball), 0.1, 0.0, 0.0), Side::Outside);
        // near a boundary that does not decide
        assert_eq!(at(&(&ball | &ball.scale([2.0, 2.0, 2.0])), 1.0, 0.0, 0.0), Side::Inside);
    }

    #[test]
    fn has_a_formula_for_every_shape() {
        for example in Primitive::examples() {
            let bounds = example.lower().bounds;
            let far = Probe { point: Vec3::new(1e6, 2e6, -3e6), origin: 0.0 };
            let side = Oracle::new(&Solid::from(example)).side(far);
            assert!(side == Side::Outside || !bounds.is_finite());
        }
    }
}
