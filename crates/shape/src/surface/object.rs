//! Objects: surfaces that a straight line may cross any number of times, each in its own frame.
//!
//! The other kernels of [`Surface`](super::Surface) return at most four sign changes by value. A surface that is described
//! by a list of numbers of any length (a freeform, a mesh) is a [`Form`]: it passes its crossings to a sink and is stored
//! once, regardless of its placements. A single variant of `Surface` refers to it, so that hot loops over the other kinds
//! are unaffected.

use super::{Perturbation, SurfaceCrossings, delta};
use crate::Ray;
use rayweave_math::{Affine, Bounds, Interval, Mat3, Transform, Vec3};
use std::any::Any;
use std::fmt::Debug;
use std::sync::Arc;

/// A closed or unbounded surface `f = 0` about its own origin, with the inside where `f < 0`.
///
/// Forms have the properties of all kernels (see the [module](super)): crossings are a function of the form, the origin and
/// the direction only, and each reported point r(t) lies within `64 u (|o| + |t| |d| + magnitude)` of the surface.
pub trait Form: Any + Debug + Send + Sync {
    /// Passes the times at which f changes sign along the ray to `emit`, in increasing order; returns true if f is negative
    /// as t -> -inf. The length of the direction is between 1e-90 and 1e90.
    fn crossings(&self, ray: &Ray, emit: &mut dyn FnMut(f64)) -> bool;

    /// Like `crossings`, in a frame whose perturbation directions are not those of the world; for a form that itself
    /// determines the side of a ray that lies in one of its faces.
    fn crossings_perturbation(
        &self,
        ray: &Ray,
        _perturbation: &Perturbation,
        emit: &mut dyn FnMut(f64),
    ) -> bool {
        self.crossings(ray, emit)
    }

    /// Like `crossings` for a ray that starts *on* the surface, for t >= 0: see
    /// [`Surface::crossings_from`](super::Surface::crossings_from). The side just after the start is
    /// [`Departing::inside_after`]; if the direction leads to the other one, the first time is 0.
    fn crossings_from(&self, start: &Departing<'_>, emit: &mut dyn FnMut(f64));

    /// f and its gradient at a point; near the surface |f| is about the distance times the length of the gradient.
    fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3);

    /// For a form of many faces: true if the piece of a ray between two times coincides with every face that it crosses at
    /// its ends, within the tolerance `delta` at a time. Each face is tested separately, so that a piece from one face to
    /// the next does not count. `None` if the form is a single face.
    fn coincident_faces(&self, _ray: &Ray, _ends: (f64, f64), _delta: &dyn Fn(f64) -> f64) -> Option<bool> {
        None
    }

    /// One less than the number of points at which a piece of a line is tested for coincidence with the surface: the degree
    /// of f along a line, if that is a polynomial; at least 5.
    fn degree(&self) -> u8;

    /// True if a straight line may lie in the surface over the size of a model.
    fn is_ruled(&self) -> bool;

    /// Upper bound of the lengths that describe the form, about its origin.
    fn magnitude(&self) -> f64;

    /// A box around the inside; infinite where it is unbounded.
    fn inside_bounds(&self) -> Bounds;

    /// Bounds of f, and of each component of its gradient, over all points of a box.
    fn ranges(&self, cell: &[Interval; 3]) -> (Interval, [Interval; 3]);

    /// A hash of the numbers that define the form: equal for forms that are the same surface.
    fn fingerprint(&self) -> u64;

    /// True if another form is bit-identical.
    fn is_same(&self, other: &dyn Form) -> bool;
}

/// A ray that starts on a form.
pub struct Departing<'a> {
    /// The ray; its origin lies on the surface up to rounding.
    pub ray: Ray,
    /// The side just after the start, according to the start list.
    pub inside_after: bool,
    /// Perturbation directions in the frame of the form.
    pub perturbation: Perturbation,
    /// The side of a ray that lies in the surface, true for inside.
    pub led_inside: &'a dyn Fn() -> bool,
}

/// A placed form: `q = local_from_world (p - centre)` lies on the form.
#[derive(Clone, Debug)]
pub struct Object {
    /// Position of the form's origin.
    pub centre: Vec3,
    /// Linear map into the frame of the form.
    pub local_from_world: Mat3,
    /// Its inverse.
    pub world_from_local: Mat3,
    /// The form.
    pub form: Arc<dyn Form>,
}

impl PartialEq for Object {
    fn eq(&self, other: &Object) -> bool {
        self.place() == other.place() && self.has_form_of(other)
    }
}

impl Object {
    /// A form in its own frame.
    pub fn new(form: Arc<dyn Form>) -> Object {
        let linear = Mat3::IDENTITY;
        Object { centre: Vec3::ZERO, local_from_world: linear, world_from_local: linear, form }
    }

    fn place(&self) -> (Vec3, Mat3, Mat3) {
        (self.centre, self.local_from_world, self.world_from_local)
    }

    /// True if both are placements of the same form.
    pub(super) fn has_form_of(&self, other: &Object) -> bool {
        Arc::ptr_eq(&self.form, &other.form) || self.form.is_same(&*other.form)
    }

    fn local(&self, ray: &Ray) -> Ray {
        Ray::new(self.local_from_world * (ray.origin - self.centre), self.local_from_world * ray.direction)
    }

    /// Passes the times at which f changes sign along the ray to `emit`, in order; returns true if f is negative at -inf.
    pub fn crossings(&self, ray: &Ray, perturbation: &Perturbation, mut emit: impl FnMut(f64)) -> bool {
        let (ray, rate) = ray.rescaled().unwrap_or((*ray, 1.0));
        let perturbation = perturbation.mapped(&self.local_from_world, self.centre);
        self.form
            .crossings_perturbation(&self.local(&ray), &perturbation, &mut |t| finite(t * rate, &mut emit))
    }

    /// Crossings of a ray that starts on the surface: see [`Surface::crossings_from`](super::Surface::crossings_from).
    pub fn crossings_from(
        &self,
        ray: &Ray,
        inside_after: bool,
        perturbation: &Perturbation,
        mut emit: impl FnMut(f64),
    ) {
        let (ray, rate) = ray.rescaled().unwrap_or((*ray, 1.0));
        let led_inside = || perturbation.leads_inside(self.value_and_gradient(ray.origin).1);
        let local_perturbation = perturbation.mapped(&self.local_from_world, self.centre);
        let ray = self.local(&ray);
        let start =
            Departing { ray, inside_after, perturbation: local_perturbation, led_inside: &led_inside };
        self.form.crossings_from(&start, &mut |t| finite(t * rate, &mut emit));
    }

    /// f of the form, and its gradient in the outer frame.
    pub fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
        let (value, gradient) = self.form.value_and_gradient(self.local_from_world * (point - self.centre));
        (value, self.local_from_world.transpose() * gradient)
    }

    pub(super) fn coincident_faces(&self, magnitude: f64, ray: &Ray, a: f64, b: f64) -> Option<bool> {
        // the Frobenius norm bounds the length of the image of a unit vector
        let columns = self.local_from_world.to_cols_array();
        let norm = columns.iter().map(|x| x * x).sum::<f64>().sqrt();
        let delta = |t: f64| norm * delta(magnitude, ray, t);
        self.form.coincident_faces(&self.local(ray), (a, b), &delta)
    }

    pub(super) fn magnitude(&self) -> f64 {
        self.centre.length() + self.size()
    }

    /// Upper bound of the lengths that describe the surface, about its centre.
    pub(super) fn size(&self) -> f64 {
        Affine::from_linear(self.world_from_local).linear_norm() * self.form.magnitude()
    }

    pub(super) fn inside_bounds(&self) -> Bounds {
        let map = Affine { linear: self.world_from_local, translation: self.centre };
        self.form.inside_bounds().transformed(&map)
    }

    pub(super) fn is_finite(&self) -> bool {
        self.centre.is_finite()
            && self.local_from_world.is_finite()
            && self.world_from_local.is_finite()
            && self.form.magnitude().is_finite()
    }

    pub(super) fn transformed(&self, to: &Transform) -> Object {
        Object {
            centre: to.world_from_local.point(self.centre),
            local_from_world: self.local_from_world * to.local_from_world.linear,
            world_from_local: to.world_from_local.linear * self.world_from_local,
            form: Arc::clone(&self.form),
        }
    }
}

fn finite(t: f64, emit: &mut impl FnMut(f64)) {
    if t.is_finite() {
        // turns -0.0 into 0.0, since times are also compared by their bits
        emit(t + 0.0);
    }
}

/// The first four crossings, and whether these are all, which holds for most rays.
pub(super) fn first_four(crossings: impl FnOnce(&mut dyn FnMut(f64)) -> bool) -> (SurfaceCrossings, bool) {
    let (mut times, mut count) = ([0.0; 4], 0);
    let starts_negative = crossings(&mut |t| {
        if let Some(slot) = times.get_mut(count) {
            *slot = t;
        }
        count += 1;
    });
    (SurfaceCrossings::new(starts_negative, &times[..count.min(4)]), count <= 4)
}

#[cfg(test)]
mod tests {
    use super::super::{Shared, Surface, coincides_along, share};
    use super::*;
    use std::hash::{DefaultHasher, Hash, Hasher};

    /// `f = (z - z_0) (z - z_1) ...`: a stack of planes z = z_k.
    #[derive(Debug, PartialEq)]
    struct Floors(Vec<f64>);

    impl Floors {
        fn times(&self, ray: &Ray) -> Vec<f64> {
            let mut times: Vec<f64> = self
                .0
                .iter()
                .map(|z| (z - ray.origin.z) / ray.direction.z)
                .filter(|t| t.is_finite())
                .collect();
            times.sort_by(f64::total_cmp);
            times
        }
    }

    impl Form for Floors {
        fn crossings(&self, ray: &Ray, emit: &mut dyn FnMut(f64)) -> bool {
            self.times(ray).into_iter().for_each(emit);
            self.0.len() % 2 == 1 && ray.direction.z > 0.0
        }

        fn crossings_from(&self, start: &Departing<'_>, emit: &mut dyn FnMut(f64)) {
            let rest = self.times(&start.ray).into_iter().filter(|&t| t > 1e-9);
            let led_inside = match start.ray.direction.z == 0.0 {
                true => (start.led_inside)(),
                false => self.value_and_gradient(start.ray.origin).1.z * start.ray.direction.z < 0.0,
            };
            (led_inside != start.inside_after).then_some(0.0).into_iter().chain(rest).for_each(emit);
        }

        fn value_and_gradient(&self, point: Vec3) -> (f64, Vec3) {
            let product = |skip: usize| {
                let others = self.0.iter().enumerate().filter(|(k, _)| *k != skip);
                others.map(|(_, z)| point.z - z).product::<f64>()
            };
            let slope = (0..self.0.len()).map(product).sum();
            (product(usize::MAX), Vec3::new(0.0, 0.0, slope))
        }

        fn degree(&self) -> u8 {
            self.0.len() as u8
        }

        fn is_ruled(&self) -> bool {
            true
        }

        fn magnitude(&self) -> f64 {
            self.0.iter().fold(0.0, |most, z| most.max(z.abs()))
        }

        fn inside_bounds(&self) -> Bounds {
            Bounds::ALL
        }

        fn ranges(&self, _: &[Interval; 3]) -> (Interval, [Interval; 3]) {
            (Interval::ALL, [Interval::ALL; 3])
        }

        fn fingerprint(&self) -> u64 {
            let mut hasher = DefaultHasher::new();
            self.0.len().hash(&mut hasher);
            hasher.finish()
        }

        fn is_same(&self, other: &dyn Form) -> bool {
            (other as &dyn Any).downcast_ref() == Some(self)
        }
    }

    fn floors(count: u32) -> Surface {
        let form = Floors((0..count).map(f64::from).collect());
        Surface::Object(Box::new(Object::new(Arc::new(form))))
    }

    fn moved(surface: &Surface, map: Affine) -> Surface {
        surface.transformed(&Transform::from_affine(map).unwrap())
    }

    fn all(surface: &Surface, ray: &Ray) -> (bool, Vec<f64>) {
        let mut times = Vec::new();
        let starts = surface.all_crossings(ray, |t| times.push(t));
        (starts, times)
    }

    #[test]
    fn any_number_of_crossings_reaches_the_sink_and_few_are_answered_in_place() {
        let map = Affine::scale(Vec3::new(1.0, 1.0, 3.0)).then(&Affine::rotation(Vec3::X, 90.0));
        let ray = Ray::new(Vec3::new(0.3, 3.0, 0.2), Vec3::new(0.1, -0.75, 0.0));
        let stack = moved(&floors(7), map);
        // the axis of the stack is -y, and its floors are 3 apart
        assert_eq!(all(&stack, &ray), (true, (0..7).map(|k| 4.0 * f64::from(k + 1)).collect()));
        assert_eq!(stack.few_crossings(&ray), None);
        assert_eq!(stack.crossings(&ray).times(), [4.0, 8.0, 12.0, 16.0]);
        let few = moved(&floors(3), map);
        assert_eq!(few.few_crossings(&ray).unwrap().times(), [4.0, 8.0, 12.0]);
        // directions with squares that would underflow
        let slow = Ray::new(ray.origin, 1e-95 * ray.direction);
        for (slow, t) in all(&stack, &slow).1.iter().zip(all(&stack, &ray).1) {
            assert!((slow * 1e-95 - t).abs() <= 1e-15 * t, "{slow} {t}");
        }
    }

    #[test]
    fn a_ray_from_an_object_meets_what_lies_ahead() {
        let (stack, up) = (floors(7), Ray::new(Vec3::new(0.0, 0.0, 1.0), Vec3::Z));
        let ahead = |inside: bool| {
            let mut times = Vec::new();
            stack.all_crossings_from(&up, inside, &Perturbation::WORLD, |t| times.push(t));
            assert_eq!(
                stack.few_crossings_from(&up, inside, &Perturbation::WORLD).is_some(),
                times.len() <= 4
            );
            times
        };
        // f is negative between floors 1 and 2, the second and third of seven
        assert_eq!(ahead(true), [1.0, 2.0, 3.0, 4.0, 5.0]);
        assert_eq!(ahead(false), [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
    }

    /// A piece between two floors is close to neither, and one along a floor is close to it throughout.
    #[test]
    fn pieces_are_sampled_in_as_many_places_as_the_degree_needs() {
        let stack = floors(9);
        let along = Ray::new(Vec3::new(0.0, 0.0, 3.0), Vec3::X);
        assert!(coincides_along(&stack, 8.0, &along, -5.0, 5.0));
        // the piece touches a floor at its ends, middle and quarter points
        let up = Ray::new(Vec3::ZERO, Vec3::Z);
        assert!(!coincides_along(&stack, 8.0, &up, 0.0, 8.0));
    }

    #[test]
    fn copies_of_one_form_in_one_place_are_one_surface() {
        let turn = Affine::rotation(Vec3::new(1.0, 2.0, 3.0), 40.0);
        let there = |shift: f64| turn.then(&Affine::translate(Vec3::new(shift, 0.0, 0.0)));
        let again = moved(&moved(&floors(3), turn), Affine::translate(Vec3::new(0.1 + 0.2, 0.0, 0.0)));
        let surfaces = [
            moved(&floors(3), there(0.3)),
            again,
            moved(&floors(4), there(0.3)),
            moved(&floors(3), there(0.31)),
            moved(&floors(3), turn),
        ];
        let magnitude = |s: &Surface| s.magnitude();
        let shared = share(&surfaces.each_ref().map(|s| (s, magnitude(s)))).unwrap();
        let Shared { representative, flipped } = shared;
        assert_eq!(representative[0], representative[1]);
        assert_eq!(representative[2..], [2, 3, 4]);
        assert!(flipped.iter().all(|flipped| !flipped));
    }
}
