//! Shapes bounded by planes and quadrics, as exact equations and as the engine's primitives.

use super::Dyadic;
use super::map::{Matrix, zero};
use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_shape::primitive::{Value, build};

/// A shape with parameters for which its equations are exact. Lengths are > 0 and integer multiples of powers
/// of two.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// `normal . p < offset`.
    HalfSpace([f64; 3], f64),
    /// `lo < normal . p < hi`.
    Slab([f64; 3], f64, f64),
    /// Centred, with these edge lengths.
    Box([f64; 3]),
    /// Between two corners.
    Corners([f64; 3], [f64; 3]),
    /// Between two corners, as a closed mesh of twelve triangles.
    MeshCorners([f64; 3], [f64; 3]),
    /// `a x + b y + c z < d` for all rows.
    Convex(Vec<[f64; 4]>),
    /// A sector around z: the quarter at which it starts and the number of quarters, 1 to 3.
    Wedge(u8, u8),
    /// Four-sided, with this circumradius and height: `|x| + |y| < radius`.
    Prism(f64, f64),
    /// Radius.
    Sphere(f64),
    /// Half axes, powers of two.
    Ellipsoid([f64; 3]),
    /// Radius and height, which may be infinite.
    Cylinder(f64, f64),
    /// Radii at the bottom and the top, and height, a power of two.
    Cone(f64, f64, f64),
    /// Focal length and height, which may be infinite.
    Paraboloid(f64, f64),
    /// Outer radius, inner radius and height.
    Tube(f64, f64, f64),
    /// `[x y z 1] Q [x y z 1]^T < 0`, and a length that characterises its size.
    Quadric([[f64; 4]; 4], f64),
}

/// A facet of a shape, in the shape's own frame.
#[derive(Clone, Debug)]
pub struct Facet {
    /// The equation.
    pub matrix: Matrix,
    /// True if the shape lies where it is negative.
    pub inside: bool,
    /// A point that gives its position, rounded.
    pub anchor: Vec3,
    /// Its size, 0 for planes.
    pub size: f64,
}

fn plane(normal: [f64; 3], offset: f64) -> Facet {
    let mut matrix: Matrix = std::array::from_fn(|_| std::array::from_fn(|_| zero()));
    for k in 0..3 {
        matrix[k][3] = Dyadic::from(normal[k]).scaled(-1);
        matrix[3][k] = matrix[k][3].clone();
    }
    matrix[3][3] = Dyadic::from(-offset);
    let n = Vec3::from(normal);
    Facet { matrix, inside: true, anchor: n * (offset / n.length_squared()), size: 0.0 }
}

/// `squares . (x^2, y^2, z^2) + 2 half z + constant < 0`.
fn upright(squares: [f64; 3], half: f64, constant: f64, size: f64) -> Facet {
    let mut matrix: Matrix = std::array::from_fn(|_| std::array::from_fn(|_| zero()));
    (0..3).for_each(|k| matrix[k][k] = Dyadic::from(squares[k]));
    matrix[2][3] = Dyadic::from(half);
    matrix[3][2] = Dyadic::from(half);
    matrix[3][3] = Dyadic::from(constant);
    Facet { matrix, inside: true, anchor: Vec3::ZERO, size }
}

fn pillar(radius: f64) -> Facet {
    upright([1.0, 1.0, 0.0], 0.0, -radius * radius, radius)
}

fn slab(normal: [f64; 3], lo: f64, hi: f64) -> [Facet; 2] {
    [plane(normal.map(|n| -n), -lo), plane(normal, hi)]
}

fn caps(height: f64) -> Vec<Facet> {
    if height.is_finite() { slab([0.0, 0.0, 1.0], -0.5 * height, 0.5 * height).into() } else { Vec::new() }
}

/// The direction at k quarter turns from +x towards +y.
fn at_quarter(k: u8) -> [f64; 2] {
    [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]][usize::from(k % 4)]
}

/// The planes of a sector that starts at a quarter and spans one or two.
fn sector(start: u8, sweep: u8) -> Vec<Facet> {
    // after the start: -y x0 + x y0 < 0 there; before the end
    let [c, s] = at_quarter(start);
    let after = plane([s, -c, 0.0], 0.0);
    if sweep == 2 {
        return vec![after];
    }
    let [c, s] = at_quarter(start + sweep);
    vec![after, plane([-s, c, 0.0], 0.0)]
}

/// `(x/a)^2 + (y/b)^2 + (z/c)^2 < 1` times a power of two.
fn ellipsoid(radii: [f64; 3]) -> Facet {
    let smallest = radii[0].min(radii[1]).min(radii[2]);
    let weight = |r: f64| (smallest / r) * (smallest / r);
    upright(radii.map(weight), 0.0, -smallest * smallest, smallest)
}

/// `x^2 + y^2 < (mean + slope z)^2`.
fn cone_side(radius1: f64, radius2: f64, height: f64) -> Facet {
    let (mean, slope) = (0.5 * (radius1 + radius2), (radius2 - radius1) / height);
    let apex = if slope == 0.0 { 0.0 } else { -mean / slope };
    let side = upright([1.0, 1.0, -slope * slope], -mean * slope, -mean * mean, 0.0);
    // referred to its apex if that is not far, else to the origin
    let size = if slope == 0.0 || apex.abs() > 16.0 * height.max(radius1).max(radius2) { mean } else { 0.0 };
    Facet { anchor: if size == 0.0 { Vec3::Z * apex } else { Vec3::ZERO }, size, ..side }
}

/// Vertices and triangles of a box, counter-clockwise from outside. Bit k of a vertex's number selects the upper corner on
/// axis k.
fn box_mesh(lo: [f64; 3], hi: [f64; 3]) -> [Vec<Vec<f64>>; 2] {
    let vertex = |k: usize| (0..3).map(|axis| if k >> axis & 1 == 1 { hi[axis] } else { lo[axis] }).collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    [(0..8).map(vertex).collect(), triangles.map(|triangle| triangle.map(f64::from).to_vec()).collect()]
}

impl Shape {
    /// A box from its corners as a mesh; other shapes unchanged.
    pub fn meshed(&self) -> Shape {
        match self {
            Shape::Box(size) => Shape::MeshCorners(size.map(|s| -0.5 * s), size.map(|s| 0.5 * s)),
            Shape::Corners(lo, hi) => Shape::MeshCorners(*lo, *hi),
            other => other.clone(),
        }
    }

    /// The facets whose intersection is the shape, or, if the flag is true, its complement.
    pub fn facets(&self) -> (Vec<Facet>, bool) {
        let with_caps = |side: Facet, height: f64| [vec![side], caps(height)].concat();
        let facets = match self {
            Shape::HalfSpace(normal, offset) => vec![plane(*normal, *offset)],
            Shape::Slab(normal, lo, hi) => slab(*normal, *lo, *hi).into(),
            Shape::Box(size) => {
                return Shape::Corners(size.map(|s| -0.5 * s), size.map(|s| 0.5 * s)).facets();
            }
            Shape::Corners(lo, hi) | Shape::MeshCorners(lo, hi) => {
                (0..3).flat_map(|k| slab(Vec3::AXES[k].to_array(), lo[k], hi[k])).collect()
            }
            Shape::Convex(rows) => rows.iter().map(|&[a, b, c, d]| plane([a, b, c], d)).collect(),
            Shape::Wedge(start, 3) => return (sector(start + 3, 1), true),
            Shape::Wedge(start, sweep) => sector(*start, *sweep),
            Shape::Prism(radius, height) => {
                let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]];
                let sides = corners.map(|[x, y]| plane([x, y, 0.0], *radius));
                [sides.to_vec(), caps(*height)].concat()
            }
            Shape::Sphere(radius) => vec![ellipsoid([*radius; 3])],
            Shape::Ellipsoid(radii) => vec![ellipsoid(*radii)],
            Shape::Cylinder(radius, height) => with_caps(pillar(*radius), *height),
            Shape::Cone(radius1, radius2, height) => {
                with_caps(cone_side(*radius1, *radius2, *height), *height)
            }
            Shape::Paraboloid(focal, height) => {
                let side = upright([1.0, 1.0, 0.0], -2.0 * focal, 0.0, 4.0 * focal);
                [vec![side], if height.is_finite() { vec![plane([0.0, 0.0, 1.0], *height)] } else { vec![] }]
                    .concat()
            }
            Shape::Tube(outer, inner, height) => {
                let bore = Facet { inside: false, ..pillar(*inner) };
                [with_caps(pillar(*outer), *height), vec![bore]].concat()
            }
            Shape::Quadric(matrix, size) => {
                let matrix = matrix.map(|row| row.map(Dyadic::from));
                vec![Facet { matrix, inside: true, anchor: Vec3::ZERO, size: *size }]
            }
        };
        (facets, false)
    }

    /// The engine's name and arguments of the shape.
    fn arguments(&self) -> (&'static str, Vec<(&'static str, Value)>) {
        let vector = |v: &[f64]| Value::Vector(v.to_vec());
        match self {
            Shape::HalfSpace(normal, offset) => {
                ("half_space", vec![("normal", vector(normal)), ("offset", (*offset).into())])
            }
            Shape::Slab(normal, lo, hi) => {
                ("slab", vec![("normal", vector(normal)), ("lo", (*lo).into()), ("hi", (*hi).into())])
            }
            Shape::Box(size) => ("box", vec![("size", vector(size))]),
            Shape::Corners(lo, hi) => ("box_from_corners", vec![("lo", vector(lo)), ("hi", vector(hi))]),
            Shape::MeshCorners(lo, hi) => {
                let [vertices, faces] = box_mesh(*lo, *hi);
                ("mesh", vec![("vertices", Value::Rows(vertices)), ("faces", Value::Rows(faces))])
            }
            Shape::Convex(rows) => ("convex", vec![("planes", rows.as_slice().into())]),
            Shape::Wedge(start, sweep) => {
                let degrees = |k: u8| Value::Number(90.0 * f64::from(k));
                ("wedge", vec![("start_degrees", degrees(*start)), ("sweep_degrees", degrees(*sweep))])
            }
            Shape::Prism(radius, height) => {
                ("prism", numbers(&[("sides", 4.0), ("radius", *radius), ("height", *height)]))
            }
            Shape::Sphere(radius) => ("sphere", numbers(&[("radius", *radius)])),
            Shape::Ellipsoid(radii) => ("ellipsoid", vec![("radii", vector(radii))]),
            Shape::Cylinder(radius, height) => {
                ("cylinder", numbers(&[("radius", *radius), ("height", *height)]))
            }
            Shape::Cone(a, b, height) => {
                ("cone", numbers(&[("radius1", *a), ("radius2", *b), ("height", *height)]))
            }
            Shape::Paraboloid(focal, height) => {
                ("paraboloid", numbers(&[("focal_length", *focal), ("height", *height)]))
            }
            Shape::Tube(outer, inner, height) => {
                ("tube", numbers(&[("outer_radius", *outer), ("inner_radius", *inner), ("height", *height)]))
            }
            Shape::Quadric(matrix, _) => ("quadric", vec![("matrix", matrix.as_slice().into())]),
        }
    }

    /// The shape as the engine's solid.
    pub fn solid(&self) -> Solid {
        let (name, arguments) = self.arguments();
        Solid::from(build(name, &arguments).unwrap_or_else(|e| panic!("{self:?}: {e}")))
    }
}

fn numbers(arguments: &[(&'static str, f64)]) -> Vec<(&'static str, Value)> {
    arguments.iter().map(|&(name, x)| (name, x.into())).collect()
}
