//! Boundary of a closed triangle mesh.
//!
//! f is the signed distance from the mesh, negative inside. Its gradient is the unit vector away from the nearest point of
//! the mesh and, within rounding of the mesh, the normal of the nearest triangle. Crossings come from
//! [`Polyhedron::crossings`], which shares no arithmetic with f.
//!
//! *Guarantee*: each line has an even number of crossings, each within `64 u (|o| + |t| |d| + magnitude)` of its triangle. A
//! ray that lies in a face is on the side of it that the perturbation directions lead to.

use super::object::{Departing, Form};
use super::{Perturbation, coincides_between};
use crate::Ray;
use rayweave_math::{Bounds, Interval, UNIT_ROUNDOFF, Vec3};
use rayweave_mesh::{Line, MeshCrossing, Polyhedron};
use std::any::Any;
use std::cell::RefCell;

/// Boundary of a closed triangle mesh, as a surface.
#[derive(Debug, PartialEq)]
pub struct MeshForm {
    solid: Polyhedron,
}

thread_local! {
    /// Buffer for the crossings of one line, so that rays do not allocate.
    static FOUND: RefCell<Vec<MeshCrossing>> = const { RefCell::new(Vec::new()) };
}

fn line(ray: &Ray) -> Line {
    Line { origin: ray.origin, direction: ray.direction }
}

impl MeshForm {
    /// The boundary of a solid.
    pub fn new(solid: Polyhedron) -> MeshForm {
        MeshForm { solid }
    }

    /// The solid.
    pub fn solid(&self) -> &Polyhedron {
        &self.solid
    }

    /// Tolerance within which a point counts as on the mesh; `lengths` is that of [`Perturbation::lengths`].
    fn delta(&self, point: Vec3, lengths: f64) -> f64 {
        64.0 * UNIT_ROUNDOFF * (point.length() + self.solid.magnitude() + lengths)
    }

    /// Calls `take` with the crossings of a line, except pairs at the same time, which cancel.
    fn each_crossing(&self, line: &Line, perturbation: &Perturbation, mut take: impl FnMut(&MeshCrossing)) {
        FOUND.with_borrow_mut(|found| {
            let lengths = perturbation.lengths();
            self.solid.crossings_with(line, &perturbation.directions(), lengths, found);
            for at_once in found.chunk_by(|a, b| a.t == b.t).filter(|at_once| at_once.len() % 2 == 1) {
                take(&at_once[0]);
            }
        });
    }

    /// True if a piece of a ray lies in the plane of a triangle at the given end; `None` if the plane of each such triangle
    /// contains the whole chord of the ray through the ball around the mesh, so that none is crossed.
    fn faces_coincident_from(
        &self,
        end: f64,
        ray: &Ray,
        (a, b): (f64, f64),
        delta: &dyn Fn(f64) -> f64,
    ) -> Option<bool> {
        let chord = self.solid.chord(&line(ray)).unwrap_or((a, b));
        let start = (ray.origin.length() + self.solid.magnitude()) / ray.direction.length();
        let mut coincident = None;
        self.solid.triangles_within(ray.at(end), delta(end), |triangle| {
            let (normal, [corner, ..]) = (self.solid.normal(triangle), self.solid.triangle(triangle));
            let is_near = |t: f64| normal.dot(ray.at(t) - corner).abs() <= delta(t);
            let lies_in_it = is_near(chord.0) && is_near(chord.1);
            if !lies_in_it && normal.is_finite() {
                let coincides = || coincides_between(is_near, start, 1, || f64::NAN, a, b);
                coincident = Some(coincident == Some(true) || coincides());
            }
        });
        coincident
    }

    /// True if a crossing ahead is the one at the start, i.e. its triangle contains the start within rounding.
    fn is_at_start(&self, crossing: &MeshCrossing, start: &Departing<'_>) -> bool {
        let (origin, lengths) = (start.ray.origin, start.perturbation.lengths());
        self.solid.distance_from(crossing.triangle, origin) <= self.delta(origin, lengths)
    }
}

impl Form for MeshForm {
    fn crossings(&self, ray: &Ray, emit: &mut dyn FnMut(f64)) -> bool {
        self.crossings_perturbation(ray, &Perturbation::WORLD, emit)
    }

    fn crossings_perturbation(
        &self,
        ray: &Ray,
        perturbation: &Perturbation,
        emit: &mut dyn FnMut(f64),
    ) -> bool {
        self.each_crossing(&line(ray), perturbation, |crossing| emit(crossing.t));
        false
    }

    /// Crossings through triangles that contain the start are skipped. The parity of the others gives the side after the
    /// start, since the ray is outside far away.
    fn crossings_from(&self, start: &Departing<'_>, emit: &mut dyn FnMut(f64)) {
        let line = line(&start.ray);
        let is_ahead = |crossing: &MeshCrossing| crossing.t > 0.0 && !self.is_at_start(crossing, start);
        let mut is_inside = false;
        self.each_crossing(&line, &start.perturbation, |crossing| is_inside ^= is_ahead(crossing));
        if is_inside != start.inside_after {
            emit(0.0);
        }
        self.each_crossing(&line, &start.perturbation, |crossing| {
            if is_ahead(crossing) {
                emit(crossing.t);
            }
        });
    }

    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let Some(nearest) = self.solid.nearest(point, f64::INFINITY) else {
            // so far away that squared distances are infinite
            return (point.length(), point.normalize_or(Vec3::X));
        };
        let away = point - nearest.point;
        let normal = self.solid.outward_normal(nearest.triangle);
        if away.length() <= self.delta(point, 0.0) && normal.is_finite() {
            return (away.dot(normal), normal);
        }
        let perturbation = Perturbation::WORLD.directions();
        let is_inside = FOUND.with_borrow_mut(|found| self.solid.contains_with(point, &perturbation, found));
        let outward = if is_inside { -1.0 } else { 1.0 };
        (outward * away.length(), outward * away.normalize_or(Vec3::X))
    }

    fn coincident_faces(&self, ray: &Ray, (a, b): (f64, f64), delta: &dyn Fn(f64) -> f64) -> Option<bool> {
        let is_near = |t: f64| self.solid.nearest(ray.at(t), delta(t)).is_some();
        let is_near_all_along = is_near(0.5 * (a + b)) && is_near(a) && is_near(b);
        Some(
            is_near_all_along && {
                let ends = [a, b].map(|end| self.faces_coincident_from(end, ray, (a, b), delta));
                ends.iter().any(Option::is_some)
                    && ends.into_iter().all(|coincident| coincident.unwrap_or(true))
            },
        )
    }

    fn degree(&self) -> u8 {
        8
    }

    fn is_ruled(&self) -> bool {
        // `crossings_perturbation` handles rays in faces
        false
    }

    fn magnitude(&self) -> f64 {
        self.solid.magnitude()
    }

    fn inside_bounds(&self) -> Bounds {
        self.solid.bounds()
    }

    /// f changes by at most the distance.
    fn ranges(&self, cell: &[Interval; 3]) -> (Interval, [Interval; 3]) {
        let middle = Vec3::from_array(cell.map(|side| 0.5 * side.lo + 0.5 * side.hi));
        let half = Vec3::from_array(cell.map(|side| 0.5 * side.hi - 0.5 * side.lo));
        if !(middle.is_finite() && half.is_finite()) {
            return (Interval::ALL, [Interval::new(-1.0, 1.0); 3]);
        }
        let (value, _) = self.value_and_gradient(middle);
        let radius = half.length() * (1.0 + 8.0 * UNIT_ROUNDOFF) + self.delta(middle, 0.0);
        (Interval::around(value, radius), [Interval::new(-1.0, 1.0); 3])
    }

    fn fingerprint(&self) -> u64 {
        let bounds = self.solid.bounds();
        let numbers = [bounds.lo, bounds.hi].into_iter().flat_map(|corner| corner.to_array());
        let mix = |hash: u64, bits: u64| (hash ^ bits).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29);
        numbers.map(f64::to_bits).fold(self.solid.triangle_count() as u64, mix)
    }

    fn is_same(&self, other: &dyn Form) -> bool {
        (other as &dyn Any).downcast_ref() == Some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Object, Surface};
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
    use rayweave_math::{Affine, Transform};
    use rayweave_mesh::Mesh;
    use std::sync::Arc;

    /// The unit cube minus a smaller cube in its corner at the origin.
    fn notched() -> Surface {
        let boxes =
            [[0.0, 0.0, 0.5, 1.0, 1.0, 1.0], [0.5, 0.0, 0.0, 1.0, 1.0, 0.5], [0.0, 0.5, 0.0, 0.5, 1.0, 0.5]];
        let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
        for [a, b, c, d, e, f] in boxes {
            let first = vertices.len() as u32;
            let pick = |k: u32, axis: u32, lo: f64, hi: f64| if k >> axis & 1 == 1 { hi } else { lo };
            vertices.extend((0..8).map(|k| Vec3::new(pick(k, 0, a, d), pick(k, 1, b, e), pick(k, 2, c, f))));
            let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
            let corners = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
            triangles.extend(corners.map(|t: [u32; 3]| t.map(|vertex| vertex + first)));
        }
        let solid = Polyhedron::new(&Mesh::new(vertices, triangles).unwrap()).unwrap();
        Surface::Object(Box::new(Object::new(Arc::new(MeshForm::new(solid)))))
    }

    fn is_inside(p: Vec3) -> bool {
        let within = |lo: f64, hi: f64| p.to_array().iter().all(|&x| lo < x && x < hi);
        within(0.0, 1.0) && !p.to_array().iter().all(|&x| x < 0.5)
    }

    fn ahead(surface: &Surface, ray: &Ray, inside: bool) -> Vec<f64> {
        let mut times = Vec::new();
        surface.all_crossings_from(ray, inside, &Perturbation::WORLD, |t| times.push(t));
        times
    }

    /// Interior faces, where the two boxes touch, cancel, and the sides are those of the formula.
    #[test]
    fn crossings_and_signs_are_those_of_the_formula() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let map = Affine::scale(Vec3::new(1.0, 2.0, 0.5))
            .then(&Affine::rotation(Vec3::new(1.0, 2.0, 3.0), 40.0))
            .then(&Affine::translate(Vec3::new(3.0, 4.0, 5.0)));
        let placed = notched().transformed(&Transform::from_affine(map).unwrap());
        let mut several = 0;
        for _ in 0..400 {
            let mut point = || Vec3::from_array(std::array::from_fn(|_| rng.random_range(-0.2..1.2)));
            let (from, to) = (point(), point());
            let ray = Ray::new(map.point(from), map.vector(to - from));
            let mut times = Vec::new();
            assert!(!placed.all_crossings(&ray, |t| times.push(t)));
            several += usize::from(times.len() > 2);
            for k in -200..400 {
                let (t, p) = (f64::from(k) * 0.01, from + f64::from(k) * 0.01 * (to - from));
                let faces = p.to_array().into_iter().flat_map(|x| [x, x - 0.5, x - 1.0]);
                if faces.fold(1.0, |near: f64, x| near.min(x.abs())) > 1e-9 {
                    let crossed = times.iter().filter(|&&time| time < t).count() % 2 == 1;
                    assert_eq!(crossed, is_inside(p), "{ray:?} {t}");
                    assert_eq!(placed.value_and_gradient(ray.at(t)).0 < 0.0, is_inside(p));
                }
            }
        }
        assert!(several > 5, "{several}");
    }

    /// A ray that starts on a face, an edge or a vertex hits what is ahead, and its start only if the list disagrees.
    #[test]
    fn rays_from_the_mesh_never_meet_their_start_again() {
        let surface = notched();
        let from_face = Ray::new(Vec3::new(1.0, 0.7, 0.6), Vec3::new(-1.0, 0.0, 0.0));
        assert_eq!(ahead(&surface, &from_face, true), [1.0]);
        assert_eq!(ahead(&surface, &from_face, false), [0.0, 1.0]);
        let outward = Ray::new(from_face.origin, -from_face.direction);
        assert_eq!((ahead(&surface, &outward, false), ahead(&surface, &outward, true)), (vec![], vec![0.0]));
        // across the notch
        let notch = Ray::new(Vec3::new(0.5, 0.1, 0.2), Vec3::new(-1.0, 0.3, 0.0));
        assert_eq!(ahead(&surface, &notch, false), Vec::<f64>::new());
        let notch = Ray::new(Vec3::new(0.5, 0.1, 0.2), Vec3::new(-1.0, 0.0, 1.0));
        let times = ahead(&surface, &notch, false);
        assert_eq!(times.len(), 2);
        assert!((times[0] - 0.3).abs() < 1e-15 && (times[1] - 0.5).abs() < 1e-15);
        // from a vertex and from an edge, inwards and outwards
        let corner = Ray::new(Vec3::ONE, Vec3::new(-1.0, -1.1, -1.2));
        assert_eq!(ahead(&surface, &corner, true).len() % 2, 1);
        assert!(ahead(&surface, &corner, true).iter().all(|&t| t > 0.4));
        let edge = Ray::new(Vec3::new(0.5, 0.2, 0.5), Vec3::new(-1.0, 0.0, -1.0));
        assert_eq!(ahead(&surface, &edge, false), Vec::<f64>::new());
    }

    #[test]
    fn ranges_hold_the_values_in_the_box() {
        let (surface, mut rng) = (notched(), ChaCha8Rng::seed_from_u64(2));
        for _ in 0..200 {
            let mut side = || {
                let (at, width): (f64, f64) = (rng.random_range(-0.5..1.5), rng.random_range(0.0..0.5));
                Interval::new(at, at + width)
            };
            let cell = [side(), side(), side()];
            let (values, gradients) = surface.ranges(&cell);
            for _ in 0..10 {
                let p = cell.map(|side| side.lo + rng.random_range(0.0..=1.0) * (side.hi - side.lo));
                let (value, gradient) = surface.value_and_gradient(Vec3::from_array(p));
                assert!(values.contains(value));
                assert!((0..3).all(|k| gradients[k].contains(gradient[k])));
            }
        }
    }
}
