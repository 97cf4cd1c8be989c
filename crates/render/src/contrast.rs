//! Contrast between neighbouring samples: outlines, creases, shadow edges.

use crate::sample::Sample;
use crate::{Camera, Lines, Size};
use rayweave_math::Vec3;

/// The kind of edge between two samples; see [`Lines`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum EdgeKind {
    None,
    Crease,
    Outline,
}

/// The sine of 20 degrees: a point seen farther than this angle from a tangent plane is on another surface.
/// On a sphere of radius r pixels, neighbours differ most at the limb, by about half of 0.32 / sqrt(r / 10)
/// radians: nothing larger than a few pixels reaches the limit of 0.35.
const STEEP: f64 = 0.342;

/// A step in depth of at most this many pixel sides is not tested: it counts as one surface.
const SHALLOW: f64 = 2.0;

/// Between different faces, a step of more than this many pixel sides is an outline even if the planes
/// through both points intersect between them: the limb of a curved face in front of another.
const DEEP: f64 = 6.0;

/// Compares samples of one picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contrast {
    camera: Camera,
    size: Size,
    /// The side of a pixel at two samples: a multiple of the distance, plus a constant.
    pixel: (f64, f64),
    crease_cosine: f32,
}

impl Contrast {
    pub fn new(camera: &Camera, size: Size, lines: Option<&Lines>) -> Contrast {
        let degrees = lines.map_or(Lines::default().crease_degrees, |l| l.crease_degrees);
        let at_start = camera.footprint(size, 0.0);
        let pixel = (camera.footprint(size, 1.0) - at_start, at_start);
        Contrast { camera: *camera, size, pixel, crease_cosine: libm::cos(degrees.to_radians()) as f32 }
    }

    /// The kind of edge between two samples at pixel positions.
    pub fn edge(&self, a: &Sample, a_at: [f64; 2], b: &Sample, b_at: [f64; 2]) -> EdgeKind {
        if a.region != b.region {
            return EdgeKind::Outline;
        }
        if a.region == 0 {
            return EdgeKind::None;
        }
        let apart = (a_at[0] - b_at[0]).abs().max((a_at[1] - b_at[1]).abs());
        let frontal = apart * (self.pixel.0 * a.t.min(b.t) + self.pixel.1);
        let jump = (a.t - b.t).abs();
        let is_outline = match a.face == b.face && a.placement == b.placement {
            true if jump <= SHALLOW * frontal => return EdgeKind::None,
            true => self.is_steep(a, a_at, b, b_at, false),
            false => jump > DEEP * frontal || self.is_steep(a, a_at, b, b_at, true),
        };
        match is_outline {
            true => EdgeKind::Outline,
            false if self.is_crease(a, b) => EdgeKind::Crease,
            false => EdgeKind::None,
        }
    }

    /// True if an edge separates two samples or different lights shine on them.
    pub fn differs(&self, a: &Sample, a_at: [f64; 2], b: &Sample, b_at: [f64; 2]) -> bool {
        a.lit != b.lit || self.edge(a, a_at, b, b_at) > EdgeKind::None
    }

    fn is_crease(&self, a: &Sample, b: &Sample) -> bool {
        if a.face == b.face && a.placement == b.placement {
            return false;
        }
        let cosine: f32 = (0..3).map(|k| a.normal[k] * b.normal[k]).sum();
        cosine < self.crease_cosine
    }

    /// True if the step is too steep for one surface. `hinged` allows for two planes that intersect between
    /// the points: then each point is in front of the other's plane (a valley), or each is behind it (a
    /// ridge).
    fn is_steep(&self, a: &Sample, a_at: [f64; 2], b: &Sample, b_at: [f64; 2], hinged: bool) -> bool {
        let between = self.point(b, b_at) - self.point(a, a_at);
        let before_a = between.dot(normal(a));
        let before_b = -between.dot(normal(b));
        let steepest = before_a.abs().max(before_b.abs());
        let one_occludes = !hinged || before_a * before_b <= 0.0;
        one_occludes && steepest > STEEP * between.length()
    }

    fn point(&self, sample: &Sample, at: [f64; 2]) -> Vec3 {
        self.camera.ray(self.size, at[0], at[1]).at(sample.t)
    }
}

fn normal(sample: &Sample) -> Vec3 {
    Vec3::from_array(sample.normal.map(f64::from))
}
