//! A view of a drawing: the map to the drawing, centre lines, and hidden holes.

use super::circle::Group;
use crate::edges::is_edge;
use crate::plan::Plan;
use crate::svg::Svg;
use rayweave_analysis::features::{CylindricalFace, PolygonalFace};
use rayweave_analysis::section::Cut;
use rayweave_math::Vec3;
use rayweave_model::Evaluator;
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

/// The relative distance of rays beside a circle that test whether it is visible: on a curved face in front of it, their depths differ
/// by much less than those at an edge.
const BESIDE: f64 = 1e-5;

/// The places along a cylinder, as parts of its length, where its outline is tested. At a joint between faces in front of it, the
/// middle of a symmetric model, say, a ray may have the normal of either face, so that an outline there proves nothing.
const PARTS: [f64; 5] = [0.117, 0.283, 0.461, 0.719, 0.887];

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

    /// Draws centre lines, and the outlines of holes that are not visible.
    pub fn lines<E: Evaluator>(
        &self,
        svg: &mut Svg,
        evaluator: &E,
        (faces, polygons): (&[CylindricalFace], &[PolygonalFace]),
        groups: &[Group],
    ) {
        let jump = 1e-4 * (self.window[1][0] - self.window[0][0]).max(self.window[1][1] - self.window[0][1]);
        for group in groups {
            if let Some((centre, radius)) = group.ring {
                svg.circle("centre", self.position(centre), self.scale() * radius, "");
                self.cross(svg, centre, 0.0);
            }
            for circle in group.circles.iter().filter(|circle| circle.is_full).take(MAX_FACES) {
                self.cross(svg, circle.centre, circle.radius);
                let pairs = circle.beside(BESIDE);
                if is_edge(evaluator, &self.plane, &pairs, jump).contains(&false) {
                    match &circle.outline()[..] {
                        [] => {
                            svg.circle(
                                "hidden",
                                self.position(circle.centre),
                                self.scale() * circle.radius,
                                "",
                            );
                        }
                        outline => svg.path("hidden", self.plan.path(outline, true), ""),
                    }
                }
            }
        }
        let towards = self.plane.normal();
        let is_beside = |face: &&CylindricalFace| face.axis().dot(towards).abs() < 1e-9 && face.share > 0.5;
        for face in faces.iter().filter(is_beside).take(MAX_FACES) {
            let ends = face.ends.map(|end| self.plane.place(end));
            let sides = face.is_hole.then_some([-face.radius, face.radius]);
            self.side(svg, evaluator, ends, sides, jump);
        }
        let is_beside = |face: &&PolygonalFace| {
            face.is_hole && face.along.dot(towards).abs() < 1e-9 * face.along.length()
        };
        for face in polygons.iter().filter(is_beside).take(MAX_FACES) {
            let count = face.corners.len() as f64;
            let centre = face.corners.iter().copied().fold(Vec3::ZERO, |a, b| a + b) / count;
            let across = towards.cross(face.along).normalize_or_zero();
            let off = face.corners.iter().map(|&corner| across.dot(corner - centre));
            let sides = off.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| [lo.min(x), hi.max(x)]);
            let ends = [centre, centre + face.along].map(|end| self.plane.place(end));
            self.side(svg, evaluator, ends, Some(sides), jump);
        }
    }

    /// Crossed centre lines through a circle.
    fn cross(&self, svg: &mut Svg, centre: Point, radius: f64) {
        let [x, y] = self.position(centre);
        let far = self.scale() * radius + BEYOND;
        let path = format!("M{:.2} {y:.2}H{:.2}M{x:.2} {:.2}V{:.2}", x - far, x + far, y - far, y + far);
        svg.path("centre", path, "");
    }

    /// The axis of a cylinder or prism from the side, and its outline if it is a hole that is not visible. `sides` are the distances of
    /// the outline from the axis, to the left of it.
    fn side<E: Evaluator>(
        &self,
        svg: &mut Svg,
        evaluator: &E,
        [a, b]: [Point; 2],
        sides: Option<[f64; 2]>,
        jump: f64,
    ) {
        let length = libm::hypot(b[0] - a[0], b[1] - a[1]);
        let along = [0, 1].map(|k| (b[k] - a[k]) / length);
        let beyond = BEYOND / self.scale();
        let at = |from: Point, by: f64, off: f64| {
            [from[0] + by * along[0] - off * along[1], from[1] + by * along[1] + off * along[0]]
        };
        svg.path("centre", self.path(&[at(a, -beyond, 0.0), at(b, beyond, 0.0)]), "");
        let Some([right, left]) = sides else { return };
        let side = |part: f64, off: f64| {
            [1.0 - BESIDE, 1.0 + BESIDE].map(|factor| at(a, part * length, factor * off))
        };
        let pairs: Vec<[Point; 2]> =
            PARTS.iter().flat_map(|&part| [side(part, left), side(part, right)]).collect();
        if is_edge(evaluator, &self.plane, &pairs, jump).contains(&false) {
            let corners =
                [at(a, 0.0, left), at(b, 0.0, left), at(b, 0.0, right), at(a, 0.0, right), at(a, 0.0, left)];
            svg.path("hidden", self.path(&corners), "");
        }
    }
}
