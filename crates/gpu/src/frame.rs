//! Frames of the device: coordinates in which a group has a size of about 1, so that single precision resolves it.

use rayweave_math::{Affine, UNIT_ROUNDOFF, Vec3};
use rayweave_model::Prototype;
use rayweave_shape::Ray;

/// Half the width of the cube that the origins of rays on the device lie in, in units of the size of the model.
pub(crate) const NEAR: f64 = 4.0;

/// The greatest tolerance of the CPU, in units of the size of the model, that the margins of boxes and balls leave room for. It
/// grows with the distance of a ray's origin and reaches this at some 1e7 sizes.
pub(crate) const MOST_TOLERANCE: f64 = 1e-6;

/// Four times the tolerance of the CPU's kernels, `64 u` per length.
pub(crate) const TOLERANCE: f64 = 4.0 * 64.0 * UNIT_ROUNDOFF;

/// A time before or after everything, as in the shader.
const FARTHEST: f64 = 1e30;

/// A frame with the origin `centre`, whose unit is `scale`, a power of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    pub centre: Vec3,
    pub scale: f64,
}

impl Frame {
    /// The frame of a group. A bounded group lies within a distance of 1 from the origin, and so do the finite leaves of others.
    pub fn of(group: &Prototype) -> Frame {
        let bounds = &group.bounds;
        let (centre, size) = match bounds.is_finite() && !bounds.is_empty() {
            true => (bounds.centre(), 0.5 * bounds.size().length()),
            // the ball has twice the radius of the finite leaves
            false => (group.ball.centre, 0.5 * group.ball.radius),
        };
        let scale = if size > 0.0 { power_of_two(size) } else { 1.0 };
        Frame { centre, scale }
    }

    /// A point in this frame.
    pub fn point(&self, p: Vec3) -> Vec3 {
        (p - self.centre) / self.scale
    }

    /// The map from this frame to `inner`, where `map` takes the outer group's coordinates to the inner group's.
    pub fn to(&self, map: &Affine, inner: &Frame) -> Affine {
        let linear = map.linear * (self.scale / inner.scale);
        Affine { linear, translation: inner.point(map.point(self.centre)) }
    }
}

/// The least power of two that is not less than a positive number.
fn power_of_two(size: f64) -> f64 {
    let exponent = libm::ilogb(size);
    let power = libm::ldexp(1.0, exponent);
    if power < size { 2.0 * power } else { power }
}

/// A ray as the device receives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DeviceRay {
    /// Origin in the frame of the model, and the start of the window, in device time.
    pub origin: [f32; 3],
    pub start: f32,
    /// Unit direction, and the bound of the error of a component of the origin.
    pub direction: [f32; 3],
    pub error: f32,
}

impl DeviceRay {
    /// A ray that is not traced: with the direction zero it is uncertain.
    pub const NONE: DeviceRay = DeviceRay { origin: [0.0; 3], start: 0.0, direction: [0.0; 3], error: 0.0 };
}

/// The times of a ray from device times: `shift + t * rate`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clock {
    pub shift: f64,
    pub rate: f64,
    /// The start of the window.
    pub from: f64,
}

/// Where a ray is traced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Route {
    /// On the device.
    Device(Clock),
    /// Nowhere: it passes the model at a distance, so it has no crossing and starts in the world.
    Passes,
    /// On the CPU: it starts too far away for the bounds to settle anything.
    Cpu,
}

/// The rounding of rays into the frame of a model.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sender {
    pub frame: Frame,
    /// True if nothing of the model lies outside of the ball with radius 1 about the origin of the frame.
    pub bounded: bool,
    /// The greatest magnitude of a surface of the model itself.
    pub magnitude: f64,
    /// The start of the window, a time that may be infinite.
    pub from: f64,
}

impl Sender {
    /// A ray from the start of the window on.
    ///
    /// A ray from outside is moved to its point closest to the centre, in f64, so that the distance of its origin costs no
    /// digits. The bound of the error of its origin includes, besides the rounding to f32, the tolerance of the CPU's
    /// kernels: a root computed there lies within `64 u (|o| + |t| |d| + magnitude)` of the surface, for the times at which
    /// the ray is near the model, and the shift has an error of the same form. Four times that leaves room for both.
    pub fn send(&self, ray: &Ray) -> (Route, DeviceRay) {
        let Frame { centre, scale } = self.frame;
        // a power of two
        let per_scale = 1.0 / scale;
        let (direction, factor) = squarable(ray.direction);
        let per_length = 1.0 / direction.length();
        let unit = direction * per_length;
        let offset = ray.origin - centre;
        let square = offset.length_squared();
        // the time of the moved origin, as a length
        let shift = if square <= 0.25 * NEAR * NEAR * scale * scale { 0.0 } else { -offset.dot(unit) };
        let at = (offset + shift * unit) * per_scale;
        // sums of components are upper bounds of lengths; |offset| <= |origin| + |centre|
        let lengths = 3.0 * (l1(ray.origin) + l1(centre)) + 16.0 * scale + self.magnitude;
        let tolerance = TOLERANCE * lengths * per_scale;
        // NaN compares false
        if !(at.abs().max_element() <= NEAR && tolerance < MOST_TOLERANCE) {
            let misses = self.bounded && tolerance < MOST_TOLERANCE && at.is_finite();
            return (if misses { Route::Passes } else { Route::Cpu }, DeviceRay::NONE);
        }
        let per_speed = factor * per_length;
        // the window starts at this length along the ray
        let begin = self.from / per_speed;
        let start = offset + begin * unit;
        if shift < begin && self.bounded && start.length_squared() > 4.0 * scale * scale {
            // behind the start, and outside of everything
            return (Route::Passes, DeviceRay::NONE);
        }
        // f32 holds an infinite start as one that is farther away than anything
        let start = ((begin - shift) * per_scale).clamp(-FARTHEST, FARTHEST);
        let origin = at.to_array().map(|x| x as f32);
        let error = (0..3).map(|k| (at[k] - f64::from(origin[k])).abs()).fold(0.0, f64::max);
        let device = DeviceRay {
            origin,
            start: start as f32,
            direction: unit.to_array().map(|x| x as f32),
            error: above(error + tolerance),
        };
        let clock = Clock { shift: shift * per_speed, rate: scale * per_speed, from: self.from };
        (Route::Device(clock), device)
    }
}

/// A direction whose squared length neither overflows nor loses digits, and its ratio to the given one.
fn squarable(direction: Vec3) -> (Vec3, f64) {
    let largest = direction.abs().max_element();
    let factor = if (1e-100..1e100).contains(&largest) { 1.0 } else { 1.0 / largest };
    (direction * factor, factor)
}

/// The sum of the absolute values of the components.
fn l1(v: Vec3) -> f64 {
    let v = v.abs();
    v.x + v.y + v.z
}

/// A number of f32 that is not less than a non-negative one.
pub(crate) fn above(x: f64) -> f32 {
    let rounded = x as f32;
    if f64::from(rounded) < x { rounded.next_up() } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sender(bounded: bool) -> Sender {
        let frame = Frame { centre: Vec3::new(1.0, 2.0, 3.0), scale: 4.0 };
        Sender { frame, bounded, magnitude: 10.0, from: 0.0 }
    }

    fn send(bounded: bool, origin: Vec3, direction: Vec3) -> (Route, DeviceRay) {
        sender(bounded).send(&Ray::new(origin, direction))
    }

    #[test]
    fn times_of_the_device_lead_back_to_points_of_the_ray() {
        for origin in [Vec3::new(2.0, 2.0, 2.0), Vec3::new(-900.0, 300.0, 40.0)] {
            let direction = 7.0 * (Vec3::new(1.5, 2.0, 3.5) - origin);
            let (Route::Device(clock), ray) = send(true, origin, direction) else { panic!("{origin}") };
            let [o, d] = [ray.origin, ray.direction].map(|v| Vec3::from_array(v.map(f64::from)));
            for t in [-1.0, 0.0, 2.0] {
                let there = sender(true).frame.point(origin + (clock.shift + t * clock.rate) * direction);
                let error = (o + t * d - there).abs().max_element();
                assert!(error < f64::from(ray.error) + 1e-7 * t.abs(), "{origin} {t}: {error}");
            }
            // the window starts at t = 0
            assert!(
                (clock.shift + f64::from(ray.start) * clock.rate).abs() < 1e-6 * clock.rate.abs() * 300.0
            );
        }
    }

    #[test]
    fn rays_that_pass_or_come_from_too_far_are_not_sent() {
        assert_eq!(send(true, Vec3::new(100.0, 100.0, 0.0), Vec3::X), (Route::Passes, DeviceRay::NONE));
        assert_eq!(send(true, Vec3::new(100.0, 2.0, 3.0), Vec3::X), (Route::Passes, DeviceRay::NONE));
        assert_eq!(send(false, Vec3::new(100.0, 100.0, 0.0), Vec3::X), (Route::Cpu, DeviceRay::NONE));
        assert!(matches!(send(false, Vec3::new(100.0, 2.0, 3.0), Vec3::X), (Route::Device(_), _)));
        assert_eq!(send(true, Vec3::new(1e14, 2.0, 3.0), -Vec3::X), (Route::Cpu, DeviceRay::NONE));
    }

    #[test]
    fn above_rounds_up() {
        for x in [0.0, 1.0, 0.1, 1e-30, 0.3] {
            assert!(f64::from(above(x)) >= x && f64::from(above(x)) <= x * (1.0 + 3e-7), "{x}");
        }
        assert_eq!([power_of_two(1.0), power_of_two(1.1), power_of_two(0.3)], [1.0, 2.0, 0.5]);
    }
}
