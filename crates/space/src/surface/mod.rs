//! Hyperplanes and quadrics in R^d, each in coordinates about its own centre; the inside is `f < 0`.
//!
//! Roots along a line depend on surface and line alone and have the same bits everywhere: only +, -, *, / and square roots in a
//! fixed order.

mod plane;
mod quadric;

pub use plane::Plane;
pub use quadric::Quadric;

use crate::affine::Affine;
use crate::curve::Line;
use crate::point::{dot, length, minus};
use crate::{Curve, Field, Point};
use rayweave_math::roots::Crossings;
use rayweave_math::{Interval, perturbation_direction, perturbs_inside};
use rayweave_shape::surface::{coincides_between, delta_of, is_near};

/// A surface in canonical form.
#[derive(Clone, Debug, PartialEq)]
pub enum Surface<const D: usize> {
    /// A hyperplane.
    Plane(Plane<D>),
    /// A quadric with a centre.
    Quadric(Box<Quadric<D>>),
}

impl<const D: usize> Surface<D> {
    /// The crossings of a line: the side as t -> -inf (negative is inside) and at most two times.
    pub fn crossings(&self, line: &Line<D>) -> Crossings<2> {
        match self {
            Surface::Plane(s) => s.crossings(line),
            Surface::Quadric(s) => s.crossings(line),
        }
    }

    /// The crossings of a line in the surface after an infinitesimal shift along w = [`perturbation_direction`]: the sign changes of
    /// `w . grad f`. In a plane or along a cylinder there are none, and the side is that in the middle.
    ///
    /// In a cone or a hyperboloid this function is linear along the line: a line shifted off a generator of a cone changes the side
    /// near the apex. (A single side for the whole line would depend on the choice of a point, and thus on the other parts of the
    /// solid.)
    pub(crate) fn perturbed_crossings(&self, line: &Line<D>, middle: f64) -> Crossings<2> {
        let along_w = match self {
            Surface::Plane(_) => None,
            Surface::Quadric(s) => s.perturbed_slope(line, &perturbation_direction()),
        };
        along_w.unwrap_or_else(|| {
            Crossings::constant(perturbs_inside(&self.value_and_gradient(&line.position(middle)).1))
        })
    }

    /// The longest length in the equation of the surface about its anchor; 0 for planes.
    pub fn size(&self) -> f64 {
        match self {
            Surface::Plane(_) => 0.0,
            Surface::Quadric(s) => s.size(),
        }
    }

    /// A point that represents the position of the surface: its centre or the foot point of the origin.
    pub fn anchor(&self) -> Point<D> {
        match self {
            Surface::Plane(s) => s.anchor(),
            Surface::Quadric(s) => s.centre,
        }
    }

    /// True if the surface may contain straight lines.
    pub fn may_contain_lines(&self) -> bool {
        match self {
            Surface::Plane(_) => true,
            Surface::Quadric(s) => s.may_contain_lines(),
        }
    }

    /// The image under a map, given with its inverse. The inside maps to the inside; the identity keeps all bits.
    pub fn transformed(&self, map: &Affine<D>, inverse: &Affine<D>) -> Surface<D> {
        match self {
            _ if *map == Affine::identity() => self.clone(),
            Surface::Plane(s) => Surface::Plane(s.transformed(map, inverse)),
            Surface::Quadric(s) => Surface::Quadric(Box::new(s.transformed(map, inverse))),
        }
    }

    /// True if no number of the surface is NaN or infinite.
    pub fn is_finite(&self) -> bool {
        match self {
            Surface::Plane(s) => s.is_finite(),
            Surface::Quadric(s) => s.is_finite(),
        }
    }

    fn degree(&self) -> u8 {
        match self {
            Surface::Plane(_) => 1,
            Surface::Quadric(_) => 2,
        }
    }

    /// Half of the largest change of the gradient per unit of length; the largest weight of a quadric is 1.
    fn bend(&self) -> f64 {
        match self {
            Surface::Plane(_) => 0.0,
            Surface::Quadric(_) => 1.0,
        }
    }

    /// True if the span of the line between two times lies in the surface, within the tolerance `delta`. `magnitude` is that of the
    /// surface plus the lengths of all composed translations.
    pub(crate) fn coincides_along(&self, magnitude: f64, line: &Line<D>, a: f64, b: f64) -> bool {
        let (from, speed) = (length(&line.origin), length(&line.direction));
        let near = |t: f64| {
            let (value, gradient) = self.value_and_gradient(&line.position(t));
            is_near(value, length(&gradient), delta_of(from + t.abs() * speed + magnitude), self.bend())
        };
        let shortest = || {
            let [first, last] = [a, b].map(|t| self.value_and_gradient(&line.position(t)).1);
            let change = minus(&last, &first);
            // not a number for planes
            a - dot(&first, &change) / dot(&change, &change) * (b - a)
        };
        coincides_between(near, (from + magnitude) / speed, self.degree(), shortest, a, b)
    }
}

impl<const D: usize> Field<D> for Surface<D> {
    fn value_and_gradient(&self, point: &Point<D>) -> (f64, Point<D>) {
        match self {
            Surface::Plane(s) => s.value_and_gradient(point),
            Surface::Quadric(s) => s.value_and_gradient(point),
        }
    }

    fn ranges(&self, cell: &[Interval; D]) -> (Interval, [Interval; D]) {
        match self {
            Surface::Plane(s) => s.ranges(cell),
            Surface::Quadric(s) => s.ranges(cell),
        }
    }

    fn magnitude(&self) -> f64 {
        match self {
            Surface::Plane(s) => s.offset.abs(),
            Surface::Quadric(s) => s.magnitude(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
    use std::array::from_fn;

    fn random_surface(rng: &mut ChaCha8Rng, k: usize) -> Surface<3> {
        let mut number = || rng.random_range(-2.0..2.0);
        let matrix = from_fn(|i| from_fn(|j| number() * 0.3 + f64::from(u8::from(i == j))));
        let map = Affine::new(matrix, from_fn(|_| number())).unwrap_or(Affine::identity());
        let surface = match k % 4 {
            0 => Surface::Plane(Plane::new(&[number(), number(), 1.0], number())),
            1 => Surface::Quadric(Box::new(Quadric::along_axes([1.0, 1.0, -1.0], number()))),
            2 => Surface::Quadric(Box::new(Quadric::along_axes([1.0, 0.0, 0.5], -1.0))),
            _ => Surface::Quadric(Box::new(Quadric::along_axes([1.0, 1.0, 1.0], -1.0))),
        };
        surface.transformed(&map, &map.inverse().unwrap_or(Affine::identity()))
    }

    #[test]
    fn ranges_contain_all_values_in_a_box_and_are_tight() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        for k in 0..400 {
            let surface = random_surface(&mut rng, k);
            let middle: Point<3> = from_fn(|_| rng.random_range(-3.0..3.0));
            let half = libm::pow(10.0, rng.random_range(-6.0..0.0));
            let (value, gradient) = surface.ranges(&middle.map(|x| Interval::around(x, half)));
            let contains = |interval: Interval, x: f64| interval.lo - 1e-14 <= x && x <= interval.hi + 1e-14;
            for _ in 0..50 {
                let point = from_fn(|j| middle[j] + half * rng.random_range(-1.0..1.0));
                let (f, grad) = surface.value_and_gradient(&point);
                assert!(contains(value, f) && (0..3).all(|j| contains(gradient[j], grad[j])), "{surface:?}");
            }
            let (_, grad) = surface.value_and_gradient(&middle);
            let steepest = length(&grad) + 8.0 * half;
            assert!(value.hi - value.lo <= 12.0 * half * steepest + 1e-12, "{surface:?} {value:?}");
        }
    }

    /// Lines that are parallel to a plane, or asymptotic to a hyperboloid, except for rounding.
    #[test]
    fn rounding_makes_no_distant_crossings() {
        let plane = Surface::Plane(Plane::new(&[1.0; 3], 1.0));
        let line = Line::new([2.0, 0.0, 0.0], [-3.0, 1.0, 2.0]);
        assert_eq!(plane.crossings(&line), Crossings::constant(false));
        let plane = Surface::Plane(Plane::new(&[1.0, 2.0, 3.0, 4.0], 1.0));
        let (mut nonzero, mut rng) = (0, ChaCha8Rng::seed_from_u64(4));
        for _ in 0..200 {
            let [a, b, c]: [f64; 3] = from_fn(|_| f64::from(rng.random_range(-9..10)));
            let parallel = [-2.0 * a - 3.0 * b - 4.0 * c, a, b, c];
            if [a, b, c] == [0.0; 3] {
                continue;
            }
            let Surface::Plane(Plane { normal, .. }) = &plane else { unreachable!() };
            nonzero += usize::from(crate::point::dot(normal, &parallel) != 0.0);
            for from in [[2.0, 0.0, 0.0, 0.0], [-2.0, 0.0, 0.0, 0.0]] {
                let expected = Crossings::constant(from[0] < 0.0);
                assert_eq!(plane.crossings(&Line::new(from, parallel)), expected, "{parallel:?}");
            }
            // a step of 1e-12 across it is not a rounding error
            let across = from_fn(|k| parallel[k] + 1e-12 * normal[k]);
            assert_eq!(plane.crossings(&Line::new([2.0, 0.0, 0.0, 0.0], across)).times().len(), 1);
        }
        assert!(nonzero > 50, "{nonzero} products are not exactly 0");
        for degrees in [20.0, 45.0, 77.0] {
            let turn = Affine::<3>::rotation(0, 2, degrees).expect("two axes");
            let back = turn.inverse().expect("a rotation");
            let cone = Quadric::along_axes([1.0, 1.0, -1.0], -1.0);
            let surface = Surface::Quadric(Box::new(cone)).transformed(&turn, &back);
            for angle in 0..36 {
                let (sin, cos) = libm::sincos(f64::from(angle) * 0.1);
                let direction = turn.vector(&[cos, sin, 1.0]);
                let found = surface.crossings(&Line::new([0.3, 0.2, 0.1], direction));
                assert!(found.times().iter().all(|t| t.abs() < 1e6), "{degrees} {angle} {found:?}");
            }
        }
    }

    #[test]
    fn gradients_agree_with_differences_of_values() {
        let mut rng = ChaCha8Rng::seed_from_u64(2);
        for k in 0..100 {
            let surface = random_surface(&mut rng, k);
            let point: Point<3> = from_fn(|_| rng.random_range(-3.0..3.0));
            let (_, gradient) = surface.value_and_gradient(&point);
            for j in 0..3 {
                let at = |step: f64| {
                    let moved = from_fn(|i| point[i] + if i == j { step } else { 0.0 });
                    surface.value_and_gradient(&moved).0
                };
                // exact for squares up to rounding
                assert!(((at(0.5) - at(-0.5)) - gradient[j]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn thin_and_sheared_ellipsoids_keep_their_points() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        for k in 0..200 {
            let thin = libm::pow(10.0, -f64::from(k as u8 % 9));
            let scaling = Affine::<4>::scale([1.0, thin, 1.0, 0.5]).expect("not singular");
            let turn = Affine::rotation(0, 1, rng.random_range(0.0..360.0)).expect("two axes");
            let shear = from_fn(|i| from_fn(|j| if i == j { 1.0 } else { 0.3 * (i as f64 - j as f64) }));
            let shear = Affine::new(shear, [0.5, -1.0, 0.25, 2.0]).expect("not singular");
            let map = scaling.then(&turn).then(&shear);
            let ball = Surface::Quadric(Box::new(Quadric::along_axes([1.0; 4], -1.0)));
            let image = ball.transformed(&map, &map.inverse().expect("not singular"));
            for _ in 0..20 {
                let direction: Point<4> = from_fn(|_| rng.random_range(-1.0..1.0));
                let point = map.point(&crate::vector::unit(&direction).0);
                let (value, gradient) = image.value_and_gradient(&point);
                assert!(value.abs() <= delta_of(4.0) * length(&gradient), "{thin:e} {value:e}");
            }
        }
    }
}
