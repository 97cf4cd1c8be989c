//! A view of a drawing: the map to the drawing, and centre lines.

use super::circle::Group;
use crate::plan::Plan;
use crate::svg::Svg;
use rayweave_analysis::features::{CylindricalFace, PolygonalFace};
use rayweave_analysis::section::Cut;
use rayweave_math::Vec3;
use rayweave_render::View;

type Point = [f64; 2];

/// A view with its place in the drawing.
pub struct Panel {
    pub view: View,
    pub plane: Cut,
    pub window: [Point; 2],
    plan: Plan,
}

/// The length of centre lines beyond the circles and cylinders, in pixels.
const BEYOND: f64 = 7.0;

/// The greatest number of cylinders with lines.
const MAX_FACES: usize = 1000;

impl Panel {
    /// Fits the window into a frame: left, top, width, height.
    pub fn new(view: View, plane: Cut, [lo, hi]: [Point; 2], frame: [f64; 4]) -> Panel {
        Panel { view, plane, window: [lo, hi], plan: Plan::new(lo, hi, frame) }
    }

    pub fn position(&self, point: Point) -> Point {
        self.plan.position(point)
    }

    /// Pixels per unit of length.
    pub fn scale(&self) -> f64 {
        self.plan.scale
    }

    pub fn path(&self, line: &[Point]) -> String {
        self.plan.path(line, false)
    }

    /// Left, top, right and bottom.
    pub fn sides(&self) -> [f64; 4] {
        let [lo, hi] = self.window;
        let ([left, top], [right, bottom]) = (self.position([lo[0], hi[1]]), self.position([hi[0], lo[1]]));
        [left, top, right, bottom]
    }

    /// Draws the centre lines of circles, cylinders and polygonal holes.
    pub fn centre_lines(
        &self,
        svg: &mut Svg,
        (faces, polygons): (&[CylindricalFace], &[PolygonalFace]),
        groups: &[Group],
    ) {
        for group in groups {
            if let Some((centre, radius)) = group.ring {
                svg.circle("centre", self.position(centre), self.scale() * radius, "");
                self.cross(svg, centre, 0.0);
            }
            for circle in group.circles.iter().filter(|circle| circle.is_full).take(MAX_FACES) {
                self.cross(svg, circle.centre, circle.radius);
            }
        }
        let towards = self.plane.normal();
        let is_beside = |face: &&CylindricalFace| face.axis().dot(towards).abs() < 1e-9 && face.share > 0.5;
        for face in faces.iter().filter(is_beside).take(MAX_FACES) {
            self.axis(svg, face.ends);
        }
        let is_beside = |face: &&PolygonalFace| {
            face.is_hole && face.along.dot(towards).abs() < 1e-9 * face.along.length()
        };
        for face in polygons.iter().filter(is_beside).take(MAX_FACES) {
            let count = face.corners.len() as f64;
            let centre = face.corners.iter().copied().fold(Vec3::ZERO, |a, b| a + b) / count;
            self.axis(svg, [centre, centre + face.along]);
        }
    }

    /// Crossed centre lines through a circle.
    fn cross(&self, svg: &mut Svg, centre: Point, radius: f64) {
        let [x, y] = self.position(centre);
        let far = self.scale() * radius + BEYOND;
        let path = format!("M{:.2} {y:.2}H{:.2}M{x:.2} {:.2}V{:.2}", x - far, x + far, y - far, y + far);
        svg.path("centre", path, "");
    }

    /// The axis of a cylinder or prism from the side.
    fn axis(&self, svg: &mut Svg, ends: [Vec3; 2]) {
        let [a, b] = ends.map(|end| self.plane.place(end));
        let length = libm::hypot(b[0] - a[0], b[1] - a[1]);
        let beyond = [0, 1].map(|k| BEYOND / self.scale() * (b[k] - a[k]) / length);
        let line = [[a[0] - beyond[0], a[1] - beyond[1]], [b[0] + beyond[0], b[1] + beyond[1]]];
        svg.path("centre", self.path(&line), "");
    }
}
