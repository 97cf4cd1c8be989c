//! Booleans of triangle meshes with the Rust port of the Manifold library (E. Lalish).
//!
//! Bodies are closed meshes without self-intersections. Unions, differences and intersections keep that property, also for
//! coincident faces: the kernel moves one of them by an infinitesimal amount. Coincident planes need exactly equal coordinates for that,
//! which `coincidence` provides.

mod coincidence;

use manifold_rust::linalg::{Vec2, Vec3 as KernelVec};
use manifold_rust::manifold::Manifold;
use manifold_rust::polygon::triangulate;
use manifold_rust::types::{Box as KernelBox, Error, MeshGL64, OpType};
use rayweave_math::{Affine, Bounds, Vec3};
use rayweave_mesh::{Mesh, Polyhedron, RepairOptions};
use rayweave_model::Facets;

/// A non-empty solid bounded by triangles.
#[derive(Clone)]
pub(crate) struct Body(Manifold);

fn to_kernel(v: Vec3) -> KernelVec {
    KernelVec { x: v.x, y: v.y, z: v.z }
}

impl Body {
    /// The solid inside a closed mesh; `None` if it has no interior beyond rounding errors.
    pub fn from_triangles(points: Vec<Vec3>, triangles: Vec<[u32; 3]>) -> Result<Option<Body>, String> {
        let raw = raw(&points, &triangles);
        let strict = Manifold::from_mesh_gl64(&raw);
        let made = match strict.status() {
            // for example an edge with four triangles
            Error::NotManifold => Manifold::from_mesh_gl64_robust(&raw),
            _ => strict,
        };
        Body::checked(made)
    }

    /// The solid inside facets; `None` if it has no interior beyond rounding errors.
    pub fn from_facets(facets: Facets) -> Result<Option<Body>, String> {
        let Facets { points, mut triangles, flat } = facets;
        for face in flat {
            let plane: Vec<Vec<[f64; 2]>> =
                face.contours.iter().map(|contour| contour.iter().map(|(_, at)| *at).collect()).collect();
            let numbers: Vec<u32> = face.contours.iter().flatten().map(|(number, _)| *number).collect();
            for corners in triangulated(&plane) {
                let [a, b, c] = corners.map(|k| numbers[k as usize]);
                triangles.push(if face.is_upright { [a, b, c] } else { [a, c, b] });
            }
        }
        Body::from_triangles(points, triangles)
    }

    pub fn from_polyhedron(solid: &Polyhedron) -> Result<Option<Body>, String> {
        let mesh = solid.to_mesh();
        let turned = mesh.repaired(&RepairOptions::default().with_fill(false));
        let (points, triangles) = turned.map_or(mesh, |(mesh, _)| mesh).into_parts();
        Body::from_triangles(points, triangles)
    }

    pub fn cuboid(bounds: &Bounds) -> Body {
        Body(Manifold::cube(to_kernel(bounds.size()), false).translate(to_kernel(bounds.lo)))
    }

    /// The convex hull; `None` if it is flat.
    pub fn hull(points: &[Vec3]) -> Result<Option<Body>, String> {
        if points.len() < 4 {
            return Ok(None);
        }
        let points: Vec<KernelVec> = points.iter().map(|p| to_kernel(*p)).collect();
        Body::checked(Manifold::hull(&points))
    }

    pub fn is_convex(&self) -> bool {
        self.0.as_impl().is_convex()
    }

    pub fn triangle_count(&self) -> usize {
        self.0.num_tri()
    }

    /// The Minkowski sum: the union of the sums of all triangles of the first body with the second (or with all triangles
    /// of the second if it is not convex), plus the interior that these do not cover.
    ///
    /// *Source*: the boundary of a Minkowski sum lies in the sum of the boundaries.
    pub fn sum(&self, other: &Body) -> Result<Option<Body>, String> {
        let (of, by) = if self.is_convex() { (other, self) } else { (self, other) };
        let pieces = if by.is_convex() { vec![by.triangles().0] } else { by.facets() };
        let facets = if of.is_convex() { vec![of.triangles().0] } else { of.facets() };
        let mut parts = Vec::new();
        for facet in &facets {
            for piece in &pieces {
                let sums: Vec<Vec3> = facet.iter().flat_map(|p| piece.iter().map(move |q| *p + *q)).collect();
                parts.extend(Body::hull(&sums)?.filter(|part| part.0.volume() > 0.0));
            }
        }
        // if the boundaries do not intersect, a component of one lies within the other
        parts.push(Body(of.0.translate(to_kernel(by.a_point()))));
        if !by.is_convex() {
            parts.push(Body(by.0.translate(to_kernel(of.a_point()))));
        }
        Body::union_all(parts)
    }

    fn facets(&self) -> Vec<Vec<Vec3>> {
        let (points, triangles) = self.triangles();
        triangles.iter().map(|t| t.map(|k| points[k as usize]).to_vec()).collect()
    }

    /// A point of the body: the mean of the vertices if it is convex, otherwise a vertex.
    fn a_point(&self) -> Vec3 {
        let (points, _) = self.triangles();
        match self.is_convex() {
            true => points.iter().copied().sum::<Vec3>() / points.len().max(1) as f64,
            false => points.first().copied().unwrap_or_default(),
        }
    }

    /// The set where a function is greater than 0, sampled on a grid of the given spacing.
    pub fn level_set(
        of: impl Fn(Vec3) -> f64 + Sync,
        bounds: &Bounds,
        spacing: f64,
        tolerance: f64,
    ) -> Result<Option<Body>, String> {
        let kernel_box = KernelBox { min: to_kernel(bounds.lo), max: to_kernel(bounds.hi) };
        let of = |p: KernelVec| of(Vec3::new(p.x, p.y, p.z));
        Body::checked(Manifold::level_set_with_tolerance(of, kernel_box, spacing, 0.0, tolerance))
    }

    fn checked(made: Manifold) -> Result<Option<Body>, String> {
        match made.status() {
            Error::NoError => Ok((!made.is_empty()).then_some(Body(made))),
            error => Err(format!("{error:?}")),
        }
    }

    /// The image under a map; `None` if it has no interior beyond rounding errors.
    pub fn placed(&self, map: &Affine) -> Result<Option<Body>, String> {
        if *map == Affine::IDENTITY {
            return Ok(Some(self.clone()));
        }
        let mesh = self.0.get_mesh_gl64(-1);
        let (points, mut triangles) = parts(&mesh);
        if map.linear.determinant() < 0.0 {
            triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
        }
        let points: Vec<Vec3> = points.into_iter().map(|p| map.point(p)).collect();
        Body::from_triangles(points, triangles)
    }

    fn boolean(&self, other: &Body, operation: OpType) -> Result<Option<Body>, String> {
        Body::checked(match coincidence::aligned(&self.0, &other.0) {
            Some((frame, [first, second])) => frame.back(first.boolean(&second, operation)),
            None => self.0.boolean(&other.0, operation),
        })
    }

    pub fn union(&self, other: &Body) -> Result<Option<Body>, String> {
        self.boolean(other, OpType::Add)
    }

    pub fn difference(&self, other: &Body) -> Result<Option<Body>, String> {
        self.boolean(other, OpType::Subtract)
    }

    pub fn intersection(&self, other: &Body) -> Result<Option<Body>, String> {
        self.boolean(other, OpType::Intersect)
    }

    /// The union of all bodies, computed pairwise so that operands stay small until the last step.
    pub fn union_all(mut all: Vec<Body>) -> Result<Option<Body>, String> {
        while all.len() > 1 {
            let pairs = all.chunks(2).map(|pair| match pair {
                [a, b] => a.union(b),
                rest => Ok(rest.first().cloned()),
            });
            all = pairs.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
        }
        Ok(all.pop())
    }

    /// The centroids of the triangles.
    pub fn centroids(&self) -> Vec<Vec3> {
        let (points, triangles) = self.triangles();
        triangles.iter().map(|t| t.iter().map(|k| points[*k as usize]).sum::<Vec3>() / 3.0).collect()
    }

    /// The vertices and the triangles, counter-clockwise seen from outside.
    pub fn triangles(&self) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        parts(&self.0.get_mesh_gl64(-1))
    }

    pub fn mesh(&self) -> Result<Mesh, String> {
        let (points, triangles) = self.triangles();
        Mesh::new(points, triangles).map_err(|error| error.to_string())
    }
}

/// Triangulation of a plane region bounded by contours that do not cross: outer contours counter-clockwise, holes
/// clockwise. The triangles index the points of all contours in sequence.
pub(crate) fn triangulated(contours: &[Vec<[f64; 2]>]) -> Vec<[u32; 3]> {
    let polygon = |contour: &Vec<[f64; 2]>| contour.iter().map(|[x, y]| Vec2 { x: *x, y: *y }).collect();
    let polygons = contours.iter().map(polygon).collect();
    // a negative tolerance: the library derives it from the size
    let triangles = triangulate(&polygons, -1.0, true);
    triangles.iter().map(|t| [t.x as u32, t.y as u32, t.z as u32]).collect()
}

fn raw(points: &[Vec3], triangles: &[[u32; 3]]) -> MeshGL64 {
    MeshGL64 {
        num_prop: 3,
        vert_properties: points.iter().flat_map(|p| p.to_array()).collect(),
        tri_verts: triangles.iter().flatten().map(|&corner| corner.into()).collect(),
        ..MeshGL64::default()
    }
}

/// Points and triangles, with merged vertices.
fn parts(mesh: &MeshGL64) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let width = mesh.num_prop as usize;
    let points: Vec<Vec3> =
        mesh.vert_properties.chunks_exact(width).map(|p| Vec3::new(p[0], p[1], p[2])).collect();
    let mut number: Vec<u32> = (0..points.len() as u32).collect();
    for (from, to) in mesh.merge_from_vert.iter().zip(&mesh.merge_to_vert) {
        number[*from as usize] = *to as u32;
    }
    let corner = |k: &u64| number[*k as usize];
    let triangles =
        mesh.tri_verts.chunks_exact(3).map(|t| [corner(&t[0]), corner(&t[1]), corner(&t[2])]).collect();
    (points, triangles)
}
