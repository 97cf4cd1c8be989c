//! Tolerances and in-surface rays: the distance `delta` for points *on* a surface, the test for rays *in* one
//! (`coincides_along`), and their crossings by symbolic perturbation.

use super::{Surface, SurfaceCrossings};
use crate::Ray;
use rayweave_math::{Affine, Mat3, PERTURBATION_DIRECTION, UNIT_ROUNDOFF, Vec3};

/// Perturbation directions for rays that lie in a surface: [`PERTURBATION_DIRECTION`] of the world and, for a surface
/// that contains it, x, y or z. Each frame of a placed solid has its own `Perturbation`, with these world directions in
/// its coordinates, so that two solids with a common face agree on the side of a ray in it, however they are placed.
///
/// The maps into the frame round the ray, in proportion to the lengths in them. Surfaces that detect rays in their own faces
/// add these `lengths` to their magnitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perturbation {
    directions: [Vec3; 4],
    lengths: f64,
}

impl Perturbation {
    /// The directions in the frame of the world.
    pub const WORLD: Perturbation =
        Perturbation { directions: [PERTURBATION_DIRECTION, Vec3::X, Vec3::Y, Vec3::Z], lengths: 0.0 };

    /// The same directions in another frame, to whose surfaces the maps from the world add `lengths` in magnitude.
    pub fn transformed(&self, local_from_world: &Affine, lengths: f64) -> Perturbation {
        Perturbation { directions: self.directions.map(|v| local_from_world.vector(v)), lengths }
    }

    /// The directions; the first that leaves the surface determines the side.
    pub fn directions(&self) -> [Vec3; 4] {
        self.directions
    }

    /// The length that the maps from the world into this frame add to the magnitude of surfaces.
    pub fn lengths(&self) -> f64 {
        self.lengths
    }

    /// The same directions in the frame of a form at `centre`. The difference of a point and the centre is rounded in
    /// proportion to the lengths of both; the length of the point is at most that of the difference plus that of the
    /// centre.
    pub(super) fn mapped(&self, map: &Mat3, centre: Vec3) -> Perturbation {
        let norm =
            [map.x_axis, map.y_axis, map.z_axis].iter().map(|v| v.length_squared()).sum::<f64>().sqrt();
        let lengths = norm * (2.0 * centre.length() + self.lengths);
        Perturbation { directions: self.directions.map(|v| *map * v), lengths }
    }

    /// True (inside) if the perturbation makes a function with this gradient negative.
    pub fn leads_inside(&self, gradient: Vec3) -> bool {
        let mut slopes = self.directions.iter().map(|v| v.dot(gradient));
        slopes.find(|&slope| slope != 0.0).unwrap_or(0.0) < 0.0
    }
}

/// Tolerance: the distance within which a computed point at time `t` of a ray counts as on a surface.
///
/// `64 u (|o| + |t| |d| + magnitude)`: the rounding of a point of the ray is at most `3 u (|o| + |t| |d|)`, that of the
/// surface's parameters a few u times `magnitude`, which includes the composed translations; 64 leaves room for the dozen
/// roundings of a kernel.
pub fn delta(magnitude: f64, ray: &Ray, t: f64) -> f64 {
    delta_of(ray.origin.length() + t.abs() * ray.direction.length() + magnitude)
}

/// Tolerance from the sum of all lengths involved, in a space of any dimension.
pub fn delta_of(lengths: f64) -> f64 {
    64.0 * UNIT_ROUNDOFF * lengths
}

/// True if the piece of the ray between `a` and `b` lies within `delta` of the surface: see [`coincides_between`].
pub fn coincides_along(surface: &Surface, magnitude: f64, ray: &Ray, a: f64, b: f64) -> bool {
    if let Some(coincides_along) = surface.coincident_faces(magnitude, ray, a, b) {
        return coincides_along;
    }
    let near = |t: f64| {
        let (value, slope) = surface.value_and_slope(ray.at(t));
        is_near(value, slope, delta(magnitude, ray, t), bend(surface))
    };
    let start = (ray.origin.length() + magnitude) / ray.direction.length();
    coincides_between(near, start, surface.degree(), a, b)
}

/// True if a point with this value of f and length of the gradient is within `delta` of the surface:
/// `|f| <= delta |grad f|`. `bend` is half of the largest change of the gradient per unit of length. It matters for
/// surfaces smaller than `delta`, at whose centre the gradient is 0.
pub fn is_near(value: f64, gradient_length: f64, delta: f64, bend: f64) -> bool {
    value.abs() <= delta * (gradient_length + delta * bend)
}

/// True if a piece of a straight line lies in a surface, by tests of [`is_near`] at single times, in a space of any
/// dimension: at both ends, the middle and, for degree 4, the quarter points; for a higher degree n at n + 1 equidistant
/// points, too. (The middle alone would weld the two crossings of a ray through two tangent spheres.)
///
/// `delta` grows with |t|, so a piece much longer than the lengths at the ray's start, `start` in units of time, is also
/// tested where `delta` is smallest: at the time `c` closest to 0, and at a distance of `start` before and after it.
/// Without these tests, distant faces would be welded if the ray, parallel to them up to rounding, crosses them at times of
/// 1e16.
pub fn coincides_between(near: impl Fn(f64) -> bool, start: f64, degree: u8, a: f64, b: f64) -> bool {
    let middle = 0.5 * (a + b);
    let near_the_start = || {
        let c = 0.0f64.clamp(a, b);
        b - a <= start || (near(c) && near((c - start).max(a)) && near((c + start).min(b)))
    };
    near(middle)
        && near(a)
        && near(b)
        && near_the_start()
        && (degree < 4 || (near(0.5 * (a + middle)) && near(0.5 * (middle + b))))
        && (degree < 5 || (1..degree).all(|k| near(a + (b - a) * (f64::from(k) / f64::from(degree)))))
}

/// True only if no piece of the ray from `a` to a time between `from` and `to` lies within `delta` of the
/// surface ([`coincides_along`]), with `a <= from <= to`; for callers that have not yet found the end of the
/// piece. Always false for surfaces of degree 4.
///
/// Along the ray f is a polynomial q of degree at most 2. On a piece [a, b] it differs from the straight line through its
/// values at the ends by `k (t - a) (b - t)`, with the maximum in the middle. So if |q| is at most T at the ends and in the
/// middle, it is at most 3 T throughout. T, the tolerance of [`is_near`], grows with delta and the gradient, which are
/// largest at `a` or at `to`, being convex in t. The rounding of the kernel is less than T; 16 leaves room for both.
pub fn separated_along(surface: &Surface, magnitude: f64, ray: &Ray, a: f64, (from, to): (f64, f64)) -> bool {
    if surface.degree() > 2 {
        return false;
    }
    let value_and_slope = |t: f64| {
        let (value, gradient) = surface.value_and_gradient(ray.at(t));
        (value.abs(), gradient.length())
    };
    let delta = delta(magnitude, ray, a.abs().max(to.abs()));
    let slope = value_and_slope(a).1.max(value_and_slope(to).1);
    value_and_slope(from).0 > 16.0 * delta * (slope + delta * bend(surface))
}

/// Half of the largest change of the gradient of a surface per unit of length.
fn bend(surface: &Surface) -> f64 {
    match surface {
        Surface::Plane(_) | Surface::Torus(_) | Surface::AffineTorus(_) | Surface::Object(_) => 0.0,
        Surface::Sphere(_) | Surface::Cylinder(_) | Surface::Quadric(_) => 1.0,
        Surface::Cone(s) => 1.0 + s.slope * s.slope,
    }
}

/// A piece of a ray as long as its model, with the common data of all tests against surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// Determines the side of a ray in a surface.
    pub perturbation: Perturbation,
    ends: (f64, f64),
    middle: Vec3,
    /// `delta` in the middle, for a surface with magnitude 0.
    delta: f64,
}

impl Chord {
    /// The piece of the ray between two times, in the frame of the world.
    pub fn new(ray: &Ray, ends: (f64, f64)) -> Chord {
        let middle = 0.5 * (ends.0 + ends.1);
        Chord {
            perturbation: Perturbation::WORLD,
            ends,
            middle: ray.at(middle),
            delta: delta(0.0, ray, middle),
        }
    }

    /// True if the ray lies in the surface along the whole chord.
    pub fn lies_in(&self, surface: &Surface, magnitude: f64, ray: &Ray) -> bool {
        if !surface.is_ruled() {
            return false;
        }
        // fast path: a single value and no root decide for nearly every ray
        let (value, gradient) = surface.value_and_gradient(self.middle);
        let delta = self.delta + delta_of(magnitude);
        value * value <= delta * delta * gradient.length_squared()
            && coincides_along(surface, magnitude, ray, self.ends.0, self.ends.1)
    }

    /// The crossings of a ray that lies in the surface along the whole chord, by symbolic perturbation; `None` if it does
    /// not lie in it.
    pub fn crossings_in(&self, surface: &Surface, magnitude: f64, ray: &Ray) -> Option<SurfaceCrossings> {
        self.lies_in(surface, magnitude, ray)
            .then(|| perturbed_crossings(surface, magnitude, ray, &self.perturbation, self.ends))
    }

    /// True if the piece of a ray in the surface between two times is too short to determine the side of the perturbed
    /// ray: `w . grad f` is 0 at both ends up to rounding.
    pub fn side_is_uncertain(
        &self,
        surface: &Surface,
        magnitude: f64,
        ray: &Ray,
        (a, b): (f64, f64),
    ) -> bool {
        let [w, ..] = self.perturbation.directions();
        let noise = gradient_noise(surface, magnitude, ray, (a, b)) * w.length();
        [a, b].into_iter().all(|t| w.dot(surface.value_and_gradient(ray.at(t)).1).abs() <= 2.0 * noise)
    }
}

/// Bound of the error of the gradient along a piece of a ray: a point of the ray is off by less than `delta`, and the
/// gradient changes by at most `2 bend` per unit of length.
fn gradient_noise(surface: &Surface, magnitude: f64, ray: &Ray, (a, b): (f64, f64)) -> f64 {
    2.0 * bend(surface) * delta(magnitude, ray, a.abs().max(b.abs()))
}

/// The crossings of a ray that lies in a surface of degree 1 or 2 along the piece between two times, after an infinitesimal
/// shift along `perturbation`: the sign changes of `w . grad f` for the first of its directions w with a nonzero result.
///
/// On the ray f is 0, so f of the shifted ray is proportional to `w . grad f`, a linear function of the time. In a plane
/// and along a cylinder it is constant, and the whole ray is on one side. Along a ruling of a cone its sign changes at the
/// apex, along a ruling of a hyperboloid at one point. (One side for the whole ray would depend on the point at which the
/// gradient is computed, and thus on other parts of the model.) A rise within the rounding of the gradient counts as 0.
pub(super) fn perturbed_crossings(
    surface: &Surface,
    magnitude: f64,
    ray: &Ray,
    perturbation: &Perturbation,
    (a, b): (f64, f64),
) -> SurfaceCrossings {
    let gradient = |t: f64| surface.value_and_gradient(ray.at(t)).1;
    let middle = gradient(0.5 * (a + b));
    if !surface.turns_along_rulings() {
        return SurfaceCrossings::constant(perturbation.leads_inside(middle));
    }
    let (first, last) = (gradient(a), gradient(b));
    let noise = gradient_noise(surface, magnitude, ray, (a, b));
    for w in perturbation.directions() {
        let rise = w.dot(last) - w.dot(first);
        if rise.abs() > 2.0 * noise * w.length() {
            // extrapolated from t = 0, whose error does not depend on the ends: exact for a change at the origin of the ray
            return SurfaceCrossings::new(rise > 0.0, &[-w.dot(gradient(0.0)) / rise * (b - a)]);
        }
        let slope = w.dot(middle);
        if slope != 0.0 {
            return SurfaceCrossings::constant(slope < 0.0);
        }
    }
    SurfaceCrossings::constant(false)
}

/// [`Chord::lies_in`] for the piece of the ray between two times.
pub fn lies_in(surface: &Surface, magnitude: f64, ray: &Ray, ends: (f64, f64)) -> bool {
    Chord::new(ray, ends).lies_in(surface, magnitude, ray)
}

/// [`Chord::crossings_in`] for the piece of the ray between two times.
pub fn crossings_in(
    surface: &Surface,
    magnitude: f64,
    ray: &Ray,
    ends: (f64, f64),
) -> Option<SurfaceCrossings> {
    Chord::new(ray, ends).crossings_in(surface, magnitude, ray)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
    use rayweave_math::Transform;

    fn surfaces(size: f64) -> Vec<Surface> {
        let (at, axis) = (size * Vec3::new(0.3, -0.2, 0.5), Vec3::new(1.0, 2.0, -0.5));
        let squeeze = Affine::scale(Vec3::new(1.0, 2.0, 1e-3)).then(&Affine::rotation(axis, 30.0));
        let squeezed = Surface::sphere(at, size).transformed(&Transform::from_affine(squeeze).unwrap());
        let cone = Surface::cone(at, axis, 0.4);
        let saddle = Surface::quadric(&[
            [1.0, 0.0, 0.0, 0.0],
            [0.0, -1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, -0.5 * size],
            [0.0, 0.0, -0.5 * size, 0.0],
        ]);
        let ring = Surface::torus(at, axis, size, 0.3 * size);
        let round = [Surface::sphere(at, size), Surface::cylinder(at, axis, size), squeezed, cone, ring];
        round.into_iter().chain(saddle).chain([Surface::plane(axis, size)]).collect()
    }

    /// Rays in general direction, and rays that hardly leave the surface, from each crossing on: if a piece is reported
    /// clear, it does not coincide with the surface, wherever it ends.
    #[test]
    fn no_piece_coincides_along_a_surface_that_was_cleared() {
        let mut rng = ChaCha8Rng::seed_from_u64(8);
        let (mut cleared, mut near) = (0, 0);
        for round in 0..30_000 {
            let size = [1e-6, 1.0, 1e7][round % 3];
            let surfaces = surfaces(size);
            let surface = &surfaces[round % surfaces.len()];
            let magnitude = surface.magnitude();
            let mut vector = || Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
            let (through, direction) = (size * vector(), vector());
            // nearly along the surface
            let normal = surface.value_and_gradient(through).1.normalize_or(Vec3::Z);
            let tilt = [1.0, 1e-3, 1e-7, 1e-12, 0.0][rng.random_range(0..5)];
            let direction = direction - (1.0 - tilt) * direction.dot(normal) * normal;
            let ray = Ray::new(through - rng.random_range(0.0..3.0) * size * direction, direction);
            let to = 20.0 * size;
            for &a in surface.crossings(&ray).times().iter().filter(|t| t.abs() < to) {
                let from = a + (to - a) * libm::pow(10.0, rng.random_range(-16.0..0.0));
                if !separated_along(surface, magnitude, &ray, a, (from, to)) {
                    near += 1;
                    continue;
                }
                cleared += 1;
                let others = surface.crossings(&ray);
                let ends = others.times().iter().copied().chain((0..20).map(|_| rng.random_range(from..to)));
                for b in ends.filter(|b| (from..=to).contains(b)) {
                    assert!(
                        !coincides_along(surface, magnitude, &ray, a, b),
                        "{surface:?} {ray:?} {a} {from} {b}"
                    );
                }
            }
        }
        assert!(cleared > 5000 && near > 1000, "{cleared} cleared, {near} not");
    }

    /// A ray through a ball is clear of it after a millionth of its size; a ray along a plane is not.
    #[test]
    fn ordinary_rays_clear_a_surface_at_once() {
        let ball = Surface::sphere(Vec3::new(0.0, 0.0, 5.0), 1.0);
        let ray = Ray::new(Vec3::new(0.3, 0.2, 0.0), Vec3::Z);
        let enter = ball.crossings(&ray).times()[0];
        assert!(separated_along(&ball, 6.0, &ray, enter, (enter + 1e-6, 100.0)));
        assert!(!separated_along(&ball, 6.0, &ray, enter, (enter, 100.0)));
        let plane = Surface::plane(Vec3::X, 0.3);
        assert!(!separated_along(&plane, 0.3, &ray, 1.0, (4.0, 100.0)));
        assert!(separated_along(
            &plane,
            0.3,
            &Ray::new(Vec3::ZERO, Vec3::new(1.0, 0.0, 1e3)),
            0.3,
            (0.3001, 100.0)
        ));
    }
}
