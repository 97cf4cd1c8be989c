//! Toric lenses: different curvatures along x and y.

use super::aperture::solid;
use super::error::positive;
use super::face::{Face, Profile};
use super::side::{Side, between_sides};
use super::{Aperture, ComponentError};
use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_shape::primitive::{HalfSpace, Torus};

/// A lens whose surfaces are tori: `[rx, ry]` are the radii of curvature along x and along y, with
/// the usual sign. Equal radii give a sphere, one infinite radius a cylinder.
///
/// The meridian with the smaller radius, in magnitude, is a circle of that radius. The surface is
/// this circle rotated with the other radius: with r along the coordinate p and R along q,
/// `sag = R - S sqrt((R - s(p))^2 - q^2)` with `s(p) = r - sign(r) sqrt(r^2 - p^2)` and S the sign
/// of R. (Radii of opposite sign give a saddle.) Vertices, thickness and faces are those of
/// [`lens`](super::lens).
///
/// # Errors
/// As for [`lens`](super::lens). The rectangle about the aperture has to lie within the surfaces,
/// which are compared with each other at 33 x 33 of its points.
///
/// ```
/// use rayweave_optics::component::{Aperture, toric_lens};
///
/// // a spectacle lens; with a thickness of 0.8 its surfaces would cross inside the aperture
/// let lens = toric_lens([88.0, 88.0], [120.0, 150.0], 0.8, Aperture::circle(40.0));
/// assert!(lens.unwrap_err().to_string().contains("cross"));
/// let lens = toric_lens([88.0, 88.0], [120.0, 150.0], 3.0, Aperture::circle(40.0))?;
/// # Ok::<(), rayweave_optics::component::ComponentError>(())
/// ```
pub fn toric_lens(
    front: [f64; 2],
    back: [f64; 2],
    thickness: f64,
    aperture: Aperture,
) -> Result<Solid, ComponentError> {
    let part = "toric lens";
    let half = 0.5 * positive(part, "thickness", thickness)?;
    let [width, height] = aperture.checked()?.size();
    let box_of = [0.5 * width, 0.5 * height];
    let front = Toric::new(part, "front", front, -half, box_of)?;
    let back = Toric::new(part, "back", back, half, box_of)?;
    between_sides(part, [&front, &back], &aperture, [0.0; 2])
}

/// A toric surface over a rectangle.
pub(super) struct Toric {
    part: &'static str,
    name: &'static str,
    vertex: f64,
    /// The half sizes of the rectangle.
    half: [f64; 2],
    /// The signed radius of the rotated circle, and the axis along which it is curved.
    tube: f64,
    axis: usize,
    /// The signed radius of rotation.
    turn: f64,
}

impl Toric {
    pub fn new(
        part: &'static str,
        name: &'static str,
        radii: [f64; 2],
        vertex: f64,
        half: [f64; 2],
    ) -> Result<Toric, ComponentError> {
        for (radius, along) in radii.into_iter().zip(["x", "y"]) {
            Profile::sphere(radius).checked(part, format!("{name} radius along {along}"))?;
        }
        let axis = usize::from(radii[1].abs() < radii[0].abs());
        let toric = Toric { part, name, vertex, half, tube: radii[axis], axis, turn: radii[1 - axis] };
        toric.check_limits()?;
        Ok(toric)
    }

    /// Checks that the rectangle lies within the surface, and that the surface over it lies in
    /// front of the other side of the torus.
    fn check_limits(&self) -> Result<(), ComponentError> {
        let (part, surface) = (self.part, self.name);
        let too_large = |reach, limit| Err(ComponentError::ApertureTooLarge { part, surface, reach, limit });
        let (across, along) = (self.half[self.axis], self.half[1 - self.axis]);
        if across > self.tube.abs() {
            return too_large(across, self.tube.abs());
        }
        let limit = (self.turn - self.tube_sag(across)).abs();
        if along > limit {
            return too_large(along, limit);
        }
        match self.is_torus() && self.deepest() >= self.far() {
            true => too_large(across, self.tube.abs()),
            false => Ok(()),
        }
    }

    fn is_torus(&self) -> bool {
        self.turn.is_finite() && self.turn != self.tube
    }

    /// The sag of the rotated circle at a distance `p` from the axis.
    fn tube_sag(&self, p: f64) -> f64 {
        Profile::sphere(self.tube).sag(p.abs()).unwrap_or(self.tube)
    }

    /// The sag above the vertex plane.
    fn sag(&self, point: [f64; 2]) -> f64 {
        let (p, q) = (point[self.axis], point[1 - self.axis]);
        let sag = self.tube_sag(p);
        // rotated about a circle of the radius turn - sag
        sag + Profile::sphere(self.turn - sag).sag(q.abs()).unwrap_or(self.turn - sag)
    }

    /// The extent of the surface from its vertex towards the centre of the tube.
    fn deepest(&self) -> f64 {
        let [low, high] = self.range();
        if self.tube > 0.0 { high - self.vertex } else { self.vertex - low }
    }

    /// The least extent of the torus in that direction over the rectangle: to the centre of the
    /// tube if the rotation has the same sign, else to the other side of the tube, which is nearest
    /// over a corner.
    fn far(&self) -> f64 {
        if self.turn * self.tube > 0.0 {
            return self.tube.abs();
        }
        let sign = self.tube.signum();
        let other = 2.0 * self.tube - self.tube_sag(self.half[self.axis]);
        let turned = Profile::sphere(self.turn - other).sag(self.half[1 - self.axis]).unwrap_or(0.0);
        sign * (other + turned)
    }

    /// A height between the surface over the rectangle and the other side of the torus.
    fn divide(&self) -> f64 {
        self.vertex + self.tube.signum() * 0.5 * (self.deepest() + self.far())
    }

    /// The torus: the points on the side of +z near the vertex.
    fn inside(&self) -> Result<Solid, ComponentError> {
        // the distance between both centres of curvature
        let major = (self.turn - self.tube).abs();
        let ring = solid(Torus::new(major, self.tube.abs())?);
        let ring = if self.axis == 0 { ring.rotate_y(90.0) } else { ring.rotate_x(90.0) };
        let ring = ring.translate([0.0, 0.0, self.vertex + self.turn]).named(self.name);
        Ok(if self.tube > 0.0 { ring } else { !ring })
    }

    /// The height of the axis of the torus. A saddle has a hole there, and behind it the other side
    /// of the ring.
    fn middle(&self) -> f64 {
        self.vertex + self.turn
    }

    /// The surface as a sphere, cylinder (curved along x) or plane, if it is one.
    fn simple(&self) -> Option<Face> {
        let profile = Profile { cylindrical: self.turn.is_infinite(), ..Profile::sphere(self.tube) };
        (!self.is_torus()).then_some(Face { name: self.name, vertex: self.vertex, profile })
    }

    /// A simple surface rotated to the axis along which it is curved.
    fn turned(&self, simple: Solid) -> Solid {
        if self.axis == 1 && self.turn.is_infinite() { simple.rotate_z(90.0) } else { simple }
    }
}

impl Side for Toric {
    fn name(&self) -> &'static str {
        self.name
    }

    fn z(&self, point: [f64; 2]) -> f64 {
        self.vertex + self.sag(point)
    }

    fn range(&self) -> [f64; 2] {
        let [x, y] = self.half;
        let corners = [[0.0, 0.0], [x, 0.0], [0.0, y], [x, y]].map(|corner| self.z(corner));
        corners.into_iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], z| [lo.min(z), hi.max(z)])
    }

    fn beyond(&self, until: f64) -> Result<Solid, ComponentError> {
        if let Some(face) = self.simple() {
            return Ok(self.turned(face.beyond(until)?));
        }
        let end = match self.tube > 0.0 {
            true => self.divide(),
            false if self.turn > 0.0 => self.middle(),
            false => f64::INFINITY,
        };
        let inside = self.inside()?;
        if until <= end {
            return Ok(inside);
        }
        Ok(inside | solid(HalfSpace::new(-Vec3::Z, -end)?).named(self.name))
    }

    fn before(&self, from: f64) -> Result<Solid, ComponentError> {
        if let Some(face) = self.simple() {
            return Ok(self.turned(face.before(from)?));
        }
        let end = match self.tube < 0.0 {
            true => self.divide(),
            false if self.turn < 0.0 => self.middle(),
            false => f64::NEG_INFINITY,
        };
        let outside = !self.inside()?;
        if from >= end {
            return Ok(outside);
        }
        Ok(outside | solid(HalfSpace::new(Vec3::Z, end)?).named(self.name))
    }

    fn floor(&self, wanted: f64) -> f64 {
        let low = self.range()[0];
        match self.simple() {
            Some(face) => face.floor(low, low - wanted),
            None if self.tube < 0.0 => wanted.max(self.divide()),
            None if self.turn < 0.0 => wanted.max(0.5 * (low + self.middle())),
            None => wanted,
        }
    }

    fn ceiling(&self, wanted: f64) -> f64 {
        let high = self.range()[1];
        match self.simple() {
            Some(face) => face.ceiling(high, wanted - high),
            None if self.tube > 0.0 => wanted.min(self.divide()),
            None if self.turn > 0.0 => wanted.min(0.5 * (high + self.middle())),
            None => wanted,
        }
    }
}
