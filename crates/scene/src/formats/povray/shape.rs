//! Conversion of primitives to objects of POV-Ray.

use crate::number::written;
use rayweave_math::{Affine, Bounds, Mat3, PERTURBATION_DIRECTION, Transform, Vec3};
use rayweave_mesh::Polyhedron;
use rayweave_shape::primitive::{Facet, Primitive, Value};
use rayweave_shape::surface::{Quadric, Surface, Torus};

/// The empty solid: two disjoint spheres.
pub(super) const NOTHING: &str = "intersection { sphere { <0, 0, 0>, 1 } sphere { <4, 0, 0>, 1 } }";

/// A primitive under a map; `None` if the map is singular, or if POV-Ray has no object for one of
/// the faces.
///
/// Spheres, boxes, cylinders, cones and tori become the corresponding objects, which are the fastest in
/// POV-Ray. Any other primitive becomes an intersection of half-spaces and quadrics.
pub(super) fn object(primitive: &Primitive, place: &Affine) -> Option<String> {
    let transform = Transform::from_affine(*place).ok()?;
    let arguments = if matches!(primitive, Primitive::Mesh(_)) { Vec::new() } else { primitive.arguments() };
    let number = |name: &str| match arguments.iter().find(|(own, _)| *own == name)? {
        (_, Value::Number(number)) => number.is_finite().then_some(*number),
        _ => None,
    };
    let own = match primitive {
        Primitive::Sphere(_) => {
            return Some(sphere(number("radius")?, place));
        }
        Primitive::CentredBox(_) | Primitive::BoxFromCorners(_) => Some(cuboid(&primitive.lower().bounds)),
        Primitive::Cylinder(_) => number("height").and_then(|height| {
            Some(format!("cylinder {{ {}, {} }}", axis(height), written(number("radius")?)))
        }),
        Primitive::Cone(_) => number("height").and_then(|height| {
            let (bottom, top) = (written(number("radius1")?), written(number("radius2")?));
            let [lo, hi] = ends(height);
            Some(format!("cone {{ {lo}, {bottom}, {hi}, {top} }}"))
        }),
        Primitive::Mesh(mesh) => Some(triangles(mesh.solid())),
        Primitive::Ellipsoid(_)
        | Primitive::HalfSpace(_)
        | Primitive::Slab(_)
        | Primitive::Torus(_)
        | Primitive::Paraboloid(_)
        | Primitive::Quadric(_)
        | Primitive::Tube(_)
        | Primitive::Wedge(_)
        | Primitive::Prism(_)
        | Primitive::Convex(_)
        | Primitive::Asphere(_)
        | Primitive::Biconic(_)
        | Primitive::Freeform(_) => None,
    };
    match own {
        Some(own) => Some(placed(own, place)),
        None => faces(primitive, &transform),
    }
}

/// A mesh. POV-Ray determines its interior by the parity of crossings along a direction that the file
/// must specify.
fn triangles(solid: &Polyhedron) -> String {
    let mesh = solid.to_mesh();
    let points: Vec<String> = mesh.vertices().iter().map(|point| vector(*point)).collect();
    let faces: Vec<String> = mesh.triangles().iter().map(|[a, b, c]| format!("<{a}, {b}, {c}>")).collect();
    format!(
        "mesh2 {{ vertex_vectors {{ {}, {} }} face_indices {{ {}, {} }} inside_vector {} }}",
        points.len(),
        points.join(", "),
        faces.len(),
        faces.join(", "),
        vector(PERTURBATION_DIRECTION)
    )
}

fn ends(height: f64) -> [String; 2] {
    [-0.5, 0.5].map(|part| vector(Vec3::new(0.0, 0.0, part * height)))
}

fn axis(height: f64) -> String {
    ends(height).join(", ")
}

fn sphere(radius: f64, place: &Affine) -> String {
    match place.similarity() {
        Some(scale) => {
            format!("sphere {{ {}, {} }}", vector(place.translation), written(scale * radius))
        }
        None => placed(format!("sphere {{ <0, 0, 0>, {} }}", written(radius)), place),
    }
}

fn cuboid(bounds: &Bounds) -> String {
    format!("box {{ {}, {} }}", vector(bounds.lo), vector(bounds.hi))
}

/// An object under a map. A translation is written as such, because POV-Ray then keeps its
/// optimisations for axis-parallel boxes.
fn placed(object: String, place: &Affine) -> String {
    let modifier = match place {
        _ if *place == Affine::IDENTITY => return object,
        _ if place.linear == Mat3::IDENTITY => format!("translate {}", vector(place.translation)),
        _ => matrix(place),
    };
    with(object, &modifier)
}

/// The modifier for a map. POV-Ray multiplies row vectors from the left, so the rows are the images
/// of the axes.
fn matrix(place: &Affine) -> String {
    let Affine { linear, translation } = place;
    let rows = [linear.x_axis, linear.y_axis, linear.z_axis, *translation];
    let numbers: Vec<String> = rows.iter().flat_map(|row| row.to_array()).map(written).collect();
    format!("matrix <{}>", numbers.join(", "))
}

/// An object with one more modifier before its last brace.
pub(super) fn with(mut object: String, modifier: &str) -> String {
    object.truncate(object.len() - " }".len());
    object + " " + modifier + " }"
}

/// The conjunction of the faces of a primitive, or its complement.
fn faces(primitive: &Primitive, place: &Transform) -> Option<String> {
    let lowered = primitive.lower();
    let sides: Vec<String> = lowered.facets.iter().map(|facet| side(facet, place)).collect::<Option<_>>()?;
    let both = match &sides[..] {
        [] => match lowered.complement {
            true => return Some(NOTHING.to_owned()),
            false => return Some(with(NOTHING.to_owned(), "inverse")),
        },
        [one] => one.clone(),
        _ => format!("intersection {{ {} }}", sides.join(" ")),
    };
    let both = match lowered.complement {
        true => with(format!("object {{ {both} }}"), "inverse"),
        false => both,
    };
    let bounds = lowered.bounds.transformed(&place.world_from_local);
    // planes and quadrics are infinite, so POV-Ray needs an explicit bound
    if bounds.is_finite() && sides.len() > 1 && !lowered.complement {
        let bounds = bounds.grown(LOOSE * bounds.size().max_element());
        return Some(with(both, &format!("bounded_by {{ {} }}", cuboid(&bounds))));
    }
    Some(both)
}

/// The relative margin of bounding boxes, so that their faces touch nothing.
const LOOSE: f64 = 1e-3;

fn side(facet: &Facet, place: &Transform) -> Option<String> {
    let object = surface(&facet.surface.transformed(place))?;
    Some(if facet.inside { object } else { with(object, "inverse") })
}

fn surface(surface: &Surface) -> Option<String> {
    Some(match surface {
        Surface::Plane(plane) => {
            format!("plane {{ {}, {} }}", vector(plane.normal), written(plane.offset))
        }
        Surface::Sphere(sphere) => {
            format!("sphere {{ {}, {} }}", vector(sphere.centre), written(sphere.radius))
        }
        Surface::Cylinder(cylinder) => {
            let matrix = Mat3::IDENTITY - outer(cylinder.axis);
            quadric(cylinder.point, &matrix, Vec3::ZERO, -cylinder.radius * cylinder.radius)
        }
        Surface::Cone(cone) => {
            // |q|^2 - (axis . q)^2 (1 + slope^2)
            let matrix = Mat3::IDENTITY - (1.0 + cone.slope * cone.slope) * outer(cone.axis);
            quadric(cone.apex, &matrix, Vec3::ZERO, 0.0)
        }
        Surface::Quadric(q) => principal(q),
        Surface::Torus(own) => torus(own),
        Surface::AffineTorus(own) => {
            let place = Affine { linear: own.world_from_local, translation: own.centre };
            placed(torus(&own.torus), &place)
        }
        Surface::Object(_) => return None,
    })
}

fn principal(q: &Quadric) -> String {
    let matrix = (0..3).fold(Mat3::ZERO, |sum, k| sum + q.weights[k] * outer(q.axes[k]));
    quadric(q.centre, &matrix, q.linear, q.constant)
}

/// `q . M q + linear . q + constant < 0` with q = p - centre.
fn quadric(centre: Vec3, m: &Mat3, linear: Vec3, constant: f64) -> String {
    let squares = vector(Vec3::new(m.x_axis.x, m.y_axis.y, m.z_axis.z));
    let mixed = vector(2.0 * Vec3::new(m.x_axis.y, m.x_axis.z, m.y_axis.z));
    let object = format!("quadric {{ {squares}, {mixed}, {}, {} }}", vector(linear), written(constant));
    placed(object, &Affine::translate(centre))
}

/// POV-Ray's torus is about the y axis.
fn torus(torus: &Torus) -> String {
    let object = format!("torus {{ {}, {} }}", written(torus.major), written(torus.minor));
    let x = rayweave_math::any_perpendicular(torus.axis);
    let linear = Mat3::from_cols(x, torus.axis, x.cross(torus.axis));
    placed(object, &Affine { linear, translation: torus.centre })
}

/// The matrix `v v^T`.
fn outer(v: Vec3) -> Mat3 {
    Mat3::from_cols(v * v.x, v * v.y, v * v.z)
}

pub(super) fn vector(v: Vec3) -> String {
    format!("<{}, {}, {}>", written(v.x), written(v.y), written(v.z))
}
