//! The solid inside a closed triangle mesh.
//!
//! | parameter | is | unit | range | default | meaning |
//! | --- | --- | --- | --- | --- | --- |
//! | `vertices` | rows of 3 numbers | length | finite |  | the points |
//! | `faces` | rows of 3 numbers | count | a whole number from 0 to 268435455 |  | triangles: the numbers of their three corners, from 0 |
//!
//! Inside: `a line from (x, y, z) to infinity crosses the triangles an odd number of times`.
//!
//! One face: `surface`.
//!
//! Each edge must belong to an even number of triangles, which defines inside and outside. Equal points count as one,
//! and triangles with two equal vertices are ignored. The orientation of triangles has no meaning: shells within
//! shells are cavities, and where two shells overlap there is no solid. A model file may name a mesh file instead:
//! `mesh = { file = "part.stl" }`.
//!
//! The volume is the sum of the signed tetrahedra between the triangles and a fixed point; it is unknown where shells
//! intersect or overlap each other or themselves.
//!
//! A ray through an edge or a vertex crosses the mesh as if it passed beside it, on the same side of all triangles
//! (S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2, 2013).

use super::shape::between;
use super::{
    Arguments, Facet, Lowered, Parameter, ParameterKind, ParameterUnit, Range, Shape, ShapeError, Value,
};
use crate::surface::{MeshForm, Object, Surface};
use rayweave_math::Vec3;
use rayweave_mesh::Polyhedron;
use std::sync::Arc;

/// The solid inside a closed mesh: [the manual page](self).
///
/// Copies share one mesh.
#[derive(Clone, Debug)]
pub struct Mesh {
    form: Arc<MeshForm>,
}

impl PartialEq for Mesh {
    fn eq(&self, other: &Mesh) -> bool {
        Arc::ptr_eq(&self.form, &other.form) || self.form == other.form
    }
}

impl From<Polyhedron> for Mesh {
    fn from(solid: Polyhedron) -> Mesh {
        Mesh { form: Arc::new(MeshForm::new(solid)) }
    }
}

impl Mesh {
    /// The solid inside a mesh.
    ///
    /// # Errors
    /// [`ShapeError::Mesh`] if the mesh is not closed.
    pub fn new(mesh: &rayweave_mesh::Mesh) -> Result<Mesh, ShapeError> {
        Ok(Polyhedron::new(mesh).map_err(wrong)?.into())
    }

    /// The solid itself.
    pub fn solid(&self) -> &Polyhedron {
        self.form.solid()
    }

    fn from_rows(vertices: Vec<[f64; 3]>, faces: &[[f64; 3]]) -> Result<Mesh, ShapeError> {
        let vertices = vertices.into_iter().map(Vec3::from_array).collect();
        let faces = faces.iter().map(|face| face.map(|number| number as u32)).collect();
        Mesh::new(&rayweave_mesh::Mesh::new(vertices, faces).map_err(wrong)?)
    }
}

fn wrong(error: rayweave_mesh::MeshError) -> ShapeError {
    ShapeError::Mesh { shape: Mesh::NAME, error }
}

impl Shape for Mesh {
    const NAME: &'static str = "mesh";
    const EQUATION: &'static str =
        "a line from (x, y, z) to infinity crosses the triangles an odd number of times";
    const PARAMETERS: &'static [Parameter] = &[
        Parameter::new(
            "vertices",
            ParameterKind::Triples,
            ParameterUnit::Length,
            Range::Finite,
            "the points",
        ),
        Parameter::new(
            "faces",
            ParameterKind::Triples,
            ParameterUnit::Count,
            Range::Whole(0, (1 << 28) - 1),
            "triangles: the numbers of their three corners, from 0",
        ),
    ];
    const FACES: &'static [&'static str] = &["surface"];

    fn from_arguments(arguments: &Arguments) -> Result<Mesh, ShapeError> {
        Mesh::from_rows(arguments.triples("vertices"), &arguments.triples("faces"))
    }

    fn arguments(&self) -> Vec<(&'static str, Value)> {
        let mesh = self.solid().to_mesh();
        let vertices = mesh.vertices().iter().map(|vertex| vertex.to_array().to_vec()).collect();
        let faces = mesh.triangles().iter().map(|face| face.map(f64::from).to_vec()).collect();
        vec![("vertices", Value::Rows(vertices)), ("faces", Value::Rows(faces))]
    }

    fn lower(&self) -> Lowered {
        let object = Object::new(Arc::clone(&self.form) as _);
        let facet = Facet::inside("surface", Surface::Object(Box::new(object)));
        Lowered::conjunction(vec![facet], self.solid().bounds())
    }

    fn volume(&self) -> Option<f64> {
        self.solid().volume()
    }

    /// The compound of two tetrahedra: a spike on each face of an octahedron.
    fn example() -> Mesh {
        let sign = |k: usize, axis: usize| if k >> axis & 1 == 1 { 1.0 } else { -1.0 };
        let tips = (0..8).map(|k| [sign(k, 0), sign(k, 1), sign(k, 2)]);
        let hollows =
            (0..6).map(|k| std::array::from_fn(|axis| if k / 2 == axis { sign(k, 0) } else { 0.0 }));
        let faces: Vec<[f64; 3]> = (0..8).flat_map(spike).map(|face| face.map(f64::from)).collect();
        // a count of the faces by hand shows that it is closed
        Mesh::from_rows(tips.chain(hollows).collect(), &faces).unwrap_or_else(|_| tetrahedron([[0.0; 3]; 5]))
    }

    /// A tetrahedron with a dent in one face.
    fn random(rng: &mut dyn FnMut() -> f64) -> Mesh {
        let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0], [-0.1; 3]];
        let shaken = corners.map(|corner: [f64; 3]| corner.map(|x| x + between(rng, -0.3, 0.3)));
        tetrahedron(shaken)
    }
}

/// The three faces of the spike over an octant, by the indices of its tip, 0 to 7, and of the ends of the axes, 8 to 13.
fn spike(octant: u32) -> [[u32; 3]; 3] {
    let end = |axis: u32| 8 + 2 * axis + (octant >> axis & 1);
    let is_mirrored = octant.count_ones().is_multiple_of(2);
    [(0, 1), (1, 2), (2, 0)]
        .map(|(a, b)| if is_mirrored { [octant, end(b), end(a)] } else { [octant, end(a), end(b)] })
}

/// Four vertices, and a fifth that replaces the face opposite to the first one.
fn tetrahedron(points: [[f64; 3]; 5]) -> Mesh {
    let faces = [[0, 1, 2], [0, 2, 3], [0, 3, 1], [4, 2, 1], [4, 3, 2], [4, 1, 3]];
    let vertices = points.map(Vec3::from_array).to_vec();
    let solid = rayweave_mesh::Mesh::new(vertices, faces.to_vec()).and_then(|mesh| Polyhedron::new(&mesh));
    solid.unwrap_or_default().into()
}

#[cfg(test)]
mod tests {
    use super::super::tests::{check_inside, check_touched, message};
    use super::*;

    #[test]
    fn two_tetrahedra_at_every_scale() {
        for scale in [1e-8, 1.0, 1e8] {
            let mesh = Mesh::example().solid().to_mesh().mapped(|p| scale * p).unwrap();
            assert!(mesh.diagnose().is_sound());
            // each has half the volume of the cube minus four corners, and their intersection is an octahedron
            assert!((mesh.volume() - 4.0 * scale.powi(3)).abs() < 1e-14 * scale.powi(3));
            let solid = Mesh::new(&mesh).unwrap();
            assert!((solid.volume().unwrap() - 4.0 * scale.powi(3)).abs() < 1e-14 * scale.powi(3));
            let inside = |p: Vec3| {
                let [x, y, z] = (p / scale).to_array();
                let one = [x + y + z, x - y - z, y - z - x, z - x - y];
                one.iter().all(|&side| side < 1.0) || one.iter().all(|&side| side > -1.0)
            };
            check_inside(&solid, Vec3::splat(1.2 * scale), inside);
            check_touched(&solid, Vec3::ZERO, &[Vec3::splat(scale), Vec3::splat(-scale)]);
        }
    }

    #[test]
    fn invalid_arguments_are_rejected() {
        let rows = |rows: &[[f64; 3]]| Value::Rows(rows.iter().map(|row| row.to_vec()).collect());
        let build = |vertices: &[[f64; 3]], faces: &[[f64; 3]]| {
            message(super::super::build("mesh", &[("vertices", rows(vertices)), ("faces", rows(faces))]))
        };
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let open = build(&corners, &[[0.0, 2.0, 1.0], [0.0, 1.0, 3.0]]);
        assert!(open.starts_with("mesh: the mesh is not closed: 4 edges belong to an odd number"), "{open}");
        let index = build(&corners, &[[0.0, 2.0, 4.0]]);
        assert!(index.starts_with("mesh: triangle 0 refers to vertex 4: the mesh has 4 vertices"), "{index}");
        assert!(
            build(&corners, &[[0.0, 0.5, 1.0]])
                .starts_with("mesh: faces[0][1] is 0.5: faces must be a whole")
        );
        let empty =
            super::super::build("mesh", &[("vertices", Value::Rows(vec![])), ("faces", rows(&corners))]);
        assert!(message(empty).starts_with("mesh: vertices is an empty list"));
    }
}
