//! Tolerances and in-surface rays: the distance [`delta`] within which a point is *on* a surface, the test for rays *in* a
//! surface ([`coincides_along`]), and the crossings of such rays by symbolic perturbation.

use super::{Plane, Surface, SurfaceCrossings};
use crate::Ray;
use rayweave_math::{Affine, Mat3, PERTURBATION_DIRECTION, UNIT_ROUNDOFF, Vec3};

/// Perturbation directions for rays that lie in a surface: [`PERTURBATION_DIRECTION`] of the world and, for a surface
/// parallel to it, x, y or z. Each frame of a placed solid has its own `Perturbation`, with these world directions in
/// its coordinates, so that two solids with a common face agree on the side of a ray in it, however they are placed.
///
/// The maps into the frame change the ray by rounding errors in proportion to the lengths that occur in them. Surfaces that
/// detect rays in their own faces add these `lengths` to their magnitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perturbation {
    directions: [Vec3; 4],
    lengths: f64,
}

impl Perturbation {
    /// The directions in the frame of the world.
    pub const WORLD: Perturbation =
        Perturbation { directions: [PERTURBATION_DIRECTION, Vec3::X, Vec3::Y, Vec3::Z], lengths: 0.0 };

    /// The same directions in the frame of a placed solid. `local_from_world` maps from this frame into it; `lengths` is
    /// that of all maps from the world ([`Perturbation::lengths`]).
    pub fn transformed(&self, local_from_world: &Affine, lengths: f64) -> Perturbation {
        Perturbation { directions: self.directions.map(|v| local_from_world.vector(v)), lengths }
    }

    /// The directions; the first that is not tangent to the surface determines the side.
    pub fn directions(&self) -> [Vec3; 4] {
        self.directions
    }

    /// The length by which the maps from the world into this frame increase the magnitude of surfaces.
    pub fn lengths(&self) -> f64 {
        self.lengths
    }

    /// The same directions in the frame of a form at `centre`. The rounding error of the difference of a point and the centre
    /// is proportional to the lengths of both; the length of the point is at most that of the difference plus that of
    /// the centre.
    pub(super) fn mapped(&self, map: &Mat3, centre: Vec3) -> Perturbation {
        let norm =
            [map.x_axis, map.y_axis, map.z_axis].iter().map(|v| v.length_squared()).sum::<f64>().sqrt();
        let lengths = norm * (2.0 * centre.length() + self.lengths);
        Perturbation { directions: self.directions.map(|v| *map * v), lengths }
    }

    /// True if the perturbed ray is inside: if the perturbation makes a function that is 0, with this gradient, negative.
    pub fn leads_inside(&self, gradient: Vec3) -> bool {
        let mut slopes = self.directions.iter().map(|v| v.dot(gradient));
        slopes.find(|&slope| slope != 0.0).unwrap_or(0.0) < 0.0
    }
}

/// Tolerance: the distance within which a computed point at time `t` of a ray counts as on a surface.
///
/// `64 u (|o| + |t| |d| + magnitude)` with the unit roundoff u = 2^-53. The rounding error of a point of the ray is at most
/// `3 u (|o| + |t| |d|)`, that of the surface's parameters a few u times `magnitude`, which includes the composed
/// translations; 64 leaves room for the dozen roundings of a kernel.
pub fn delta(magnitude: f64, ray: &Ray, t: f64) -> f64 {
    delta_of(ray.origin.length() + t.abs() * ray.direction.length() + magnitude)
}

/// The tolerance `64 u lengths` for the sum of all lengths involved, in a space of any dimension.
pub fn delta_of(lengths: f64) -> f64 {
    64.0 * UNIT_ROUNDOFF * lengths
}

/// True if the piece of the ray between the times `a` and `b` lies within [`delta`] of the surface, by the tests of
/// [`coincides_between`]; a surface of many faces has its own test per face.
pub fn coincides_along(surface: &Surface, magnitude: f64, ray: &Ray, a: f64, b: f64) -> bool {
    if let Some(coincides) = surface.coincident_faces(magnitude, ray, a, b) {
        return coincides;
    }
    if is_off(surface, magnitude, ray, 0.5 * (a + b)) {
        return false;
    }
    let near = |t: f64| {
        let (value, slope) = surface.value_and_slope(ray.at(t));
        is_near(value, slope, delta(magnitude, ray, t), bend(surface))
    };
    let start = (ray.origin.length() + magnitude) / ray.direction.length();
    let shortest = || {
        let (rate, middle) = (surface.gradient_rate(ray.direction), 0.5 * (a + b));
        // not a number for other surfaces
        middle - surface.value_and_gradient(ray.at(middle)).1.dot(rate) / rate.length_squared()
    };
    coincides_between(near, start, surface.degree(), shortest, a, b)
}

/// True only if the point of the ray at a time fails [`is_near`]. No square roots: it rejects nearly every piece of every ray.
///
/// `delta` is computed from taxicab lengths, which are not shorter; `(a + b)^2 <= 2 (a^2 + b^2)`, and 4 leaves room for
/// rounding. False for surfaces of a degree above 2, which have a test of their own.
fn is_off(surface: &Surface, magnitude: f64, ray: &Ray, t: f64) -> bool {
    if surface.degree() > 2 {
        return false;
    }
    let (value, gradient) = surface.value_and_gradient(ray.at(t));
    let taxicab = |v: Vec3| v.abs().element_sum();
    let delta = delta_of(taxicab(ray.origin) + t.abs() * taxicab(ray.direction) + magnitude);
    let bent = delta * bend(surface);
    value * value > 4.0 * delta * delta * (gradient.length_squared() + bent * bent)
}

/// True if a point with this value of f and length of the gradient is within `delta` of the surface:
/// `|f| <= delta |grad f| + bend delta^2`. `bend` is half of the largest change of the gradient per unit of length. It matters
/// only for surfaces smaller than `delta`, at whose centre the gradient is 0.
pub fn is_near(value: f64, gradient_length: f64, delta: f64, bend: f64) -> bool {
    value.abs() <= delta * (gradient_length + delta * bend)
}

/// True if the piece of a straight line between the times `a` and `b` lies in a surface, in a space of any dimension. `near`
/// is the test of [`is_near`] at one time. It is made at both ends, in the middle, for degree 4 or higher at the quarter
/// points, and for a degree n above 4 at n + 1 equidistant points. (The middle alone would weld the two crossings of a ray
/// through two tangent spheres.)
///
/// `delta` grows with |t|. A piece longer than `start`, the time in which the ray travels the lengths at its start, is
/// therefore also tested where `delta` is smallest: at the time `c` of the piece closest to 0, and `start` before and after
/// it. Without these tests, distant faces would be welded if the ray, parallel to them up to rounding, crosses them at times
/// of 1e16.
///
/// On a cone or quadric, it is also tested at the time `shortest` where the gradient is shortest, if that is on the piece; NaN for
/// other surfaces. Beside a ruling f can be constant while the gradient turns around at the apex or waist, so that the distance from
/// the surface, about `|f| / |grad f|`, is largest there: a line at a distance d from a ruling is within d^2 / x of the surface at a
/// distance x from the apex.
pub fn coincides_between(
    near: impl Fn(f64) -> bool,
    start: f64,
    degree: u8,
    shortest: impl FnOnce() -> f64,
    a: f64,
    b: f64,
) -> bool {
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
        && {
            let time = shortest();
            !(a < time && time < b) || near(time)
        }
}

/// True only if no piece of the ray from `a` to a time between `from` and `to` lies within `delta` of the
/// surface ([`coincides_along`]), with `a <= from <= to`; for callers that have not yet found the end of the
/// piece. Always false for surfaces of a degree above 2.
///
/// Along the ray f is a polynomial q of degree at most 2. On a piece [a, b] it differs from the straight line through its
/// values at the ends by `k (t - a) (b - t)`, with the maximum in the middle. So if |q| is at most T at the ends and in the
/// middle, it is at most 3 T throughout. T, the tolerance of [`is_near`], grows with delta and the length of the gradient;
/// both are convex in t, so they are largest at `a` or at `to`. The rounding error of the kernel is less than T; the factor
/// 16 leaves room for both.
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

/// Upper bound of half of the change of the gradient per unit of length, for surfaces of degree 1 and 2. 0 for all others,
/// whose tolerance has no second-order term.
fn bend(surface: &Surface) -> f64 {
    match surface {
        Surface::Plane(_) | Surface::Torus(_) | Surface::AffineTorus(_) | Surface::Object(_) => 0.0,
        Surface::Sphere(_) | Surface::Cylinder(_) | Surface::Quadric(_) => 1.0,
        Surface::Cone(s) => 1.0 + s.slope * s.slope,
    }
}

/// A piece of a ray about as long as the model, with the data that all tests against surfaces share.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Chord {
    /// The directions that determine the side of a ray in a surface.
    pub perturbation: Perturbation,
    ends: (f64, f64),
    middle: Vec3,
    /// [`delta`] in the middle, for a surface with magnitude 0.
    delta: f64,
}

impl Chord {
    /// The piece of the ray between two times, with the perturbation of the world's frame.
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
        // fast path: one evaluation, without a square root, rejects nearly every ray
        let (value, gradient) = surface.value_and_gradient(self.middle);
        self.may_be_near((value, gradient), bend(surface), magnitude)
            && coincides_along(surface, magnitude, ray, self.ends.0, self.ends.1)
    }

    /// False only if the ray does not lie in the plane along the whole chord.
    #[inline]
    pub fn may_lie_in_plane(&self, plane: &Plane, magnitude: f64) -> bool {
        let (value, gradient) = plane.value_and_gradient(self.middle.into());
        self.may_be_near((value, gradient.into()), 0.0, magnitude)
    }

    /// False only if the middle of the chord, where f has this value and gradient, fails [`is_near`]: implied by it, since
    /// (a + b)^2 <= 2 (a^2 + b^2).
    #[inline]
    fn may_be_near(&self, (value, gradient): (f64, Vec3), bend: f64, magnitude: f64) -> bool {
        let delta = self.delta + delta_of(magnitude);
        let bent = delta * bend;
        value * value <= 2.0 * delta * delta * (gradient.length_squared() + bent * bent)
    }

    /// The crossings of a ray that lies in the surface along the whole chord, by symbolic perturbation; `None` for any
    /// other ray.
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

/// Bound of the error of the gradient along a piece of a ray in a surface of degree 1 or 2: the error of a point of the ray
/// is less than `delta`, and the gradient changes by at most `2 bend` per unit of length.
fn gradient_noise(surface: &Surface, magnitude: f64, ray: &Ray, (a, b): (f64, f64)) -> f64 {
    2.0 * bend(surface) * delta(magnitude, ray, a.abs().max(b.abs()))
}

/// The crossings of a ray that lies in a surface along the piece between two times, after an infinitesimal shift along
/// `perturbation`: the sign changes of `w . grad f` for the first of its directions w for which this is not 0.
///
/// On the ray f is 0, so f of the shifted ray is proportional to `w . grad f`, for degree 1 and 2 a linear function of the
/// time. In a plane and along a cylinder it is constant, and the whole ray is on one side; for an object the gradient in the
/// middle determines one side. Along a ruling of a cone the sign changes at the apex, along a ruling of a hyperboloid at one
/// point. (One side for the whole ruling would depend on the point at which the gradient is computed, and thus on other
/// parts of the model.) A change of `w . grad f` within the rounding error of the gradient counts as 0.
///
/// The zero of the linear function is found from its value at t = 0 and its rate, the second derivative of f along w and
/// the direction of the ray: its error is that of the gradient at the origin of the ray, which is within `gradient_noise`,
/// over the rate. A rate from two values on the piece between `a` and `b` would multiply that error by |t| / (b - a), a
/// large number if the ray starts far away.
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
    let (first, rates) = (gradient(0.0), surface.gradient_rate(ray.direction));
    let noise = gradient_noise(surface, magnitude, ray, (a, b));
    for w in perturbation.directions() {
        let rate = w.dot(rates);
        if rate.abs() * (b - a) > 2.0 * noise * w.length() {
            return SurfaceCrossings::new(rate > 0.0, &[-w.dot(first) / rate]);
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

    /// Rays in general directions and rays nearly tangent to the surface, each from every crossing on: if
    /// [`separated_along`] is true for a range of ends, no piece that ends in it coincides with the surface.
    #[test]
    fn separated_pieces_never_coincide() {
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

    /// Points at distances about the tolerance from surfaces of all sizes: the test without square roots rejects none that is near,
    /// and all that are ten tolerances away.
    #[test]
    fn points_near_a_surface_are_never_off() {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let (mut near, mut off) = (0, 0);
        for round in 0..30_000 {
            let size = [1e-60, 1e-6, 1.0, 1e7, 1e60][round % 5];
            let surfaces = surfaces(size);
            let surface = &surfaces[round % surfaces.len()];
            let magnitude = surface.magnitude();
            let mut vector = || Vec3::from_array(std::array::from_fn(|_| rng.random_range(-1.0..1.0)));
            let ray = Ray::new(3.0 * size * vector(), vector());
            let Some(&root) = surface.crossings(&ray).times().first() else { continue };
            let steps = delta(magnitude, &ray, root) / ray.direction.length();
            let t = root + libm::pow(10.0, rng.random_range(-1.0..3.0)) * steps;
            let (value, slope) = surface.value_and_slope(ray.at(t));
            let is_close = |factor: f64| {
                is_near(value, slope, factor * delta(magnitude, &ray, t), factor * bend(surface))
            };
            if is_close(1.0) {
                near += 1;
                assert!(!is_off(surface, magnitude, &ray, t), "{surface:?} {ray:?} {t}");
            } else if !is_close(10.0) && surface.degree() <= 2 {
                off += 1;
                assert!(is_off(surface, magnitude, &ray, t), "{surface:?} {ray:?} {t}");
            }
        }
        assert!(near > 2000 && off > 2000, "{near} near, {off} off");
    }

    /// A ray through a ball is separated from its surface after a millionth of the radius; a ray in a plane never is.
    #[test]
    fn ordinary_rays_separate_from_a_surface_at_once() {
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
