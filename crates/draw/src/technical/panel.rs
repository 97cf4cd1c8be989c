//! A view of a drawing: the map to the drawing, centre lines, and hidden holes.

use super::circle::Group;
use crate::edges::is_edge;
use crate::plan::Plan;
use crate::svg::Svg;
use rayweave_analysis::features::CylindricalFace;
use rayweave_analysis::section::Cut;
use rayweave_model::Evaluator;
use rayweave_render::View;
use std::f64::consts::TAU;

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
        faces: &[CylindricalFace],
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
                let beside = |k: u32| {
                    let angle = TAU * (f64::from(k) + 0.41) / 8.0;
                    let at = |radius: f64| {
                        [
                            circle.centre[0] + radius * libm::cos(angle),
                            circle.centre[1] + radius * libm::sin(angle),
                        ]
                    };
                    [at((1.0 - BESIDE) * circle.radius), at((1.0 + BESIDE) * circle.radius)]
                };
                let pairs: Vec<[Point; 2]> = (0..8).map(beside).collect();
                if is_edge(evaluator, &self.plane, &pairs, jump).contains(&false) {
                    svg.circle("hidden", self.position(circle.centre), self.scale() * circle.radius, "");
                }
            }
        }
        let towards = self.plane.normal();
        let is_beside = |face: &&CylindricalFace| face.axis().dot(towards).abs() < 1e-9 && face.share > 0.5;
        for face in faces.iter().filter(is_beside).take(MAX_FACES) {
            self.side(svg, evaluator, face, jump);
        }
    }

    /// Crossed centre lines through a circle.
    fn cross(&self, svg: &mut Svg, centre: Point, radius: f64) {
        let [x, y] = self.position(centre);
        let far = self.scale() * radius + BEYOND;
        let path = format!("M{:.2} {y:.2}H{:.2}M{x:.2} {:.2}V{:.2}", x - far, x + far, y - far, y + far);
        svg.path("centre", path, "");
    }

    /// The axis of a cylinder from the side, and its outline if it is a hole that is not visible.
    fn side<E: Evaluator>(&self, svg: &mut Svg, evaluator: &E, face: &CylindricalFace, jump: f64) {
        let [a, b] = face.ends.map(|end| self.plane.place(end));
        let length = face.length();
        let along = [0, 1].map(|k| (b[k] - a[k]) / length);
        let beyond = BEYOND / self.scale();
        let at = |from: Point, by: f64, off: f64| {
            [from[0] + by * along[0] - off * along[1], from[1] + by * along[1] + off * along[0]]
        };
        svg.path("centre", self.path(&[at(a, -beyond, 0.0), at(b, beyond, 0.0)]), "");
        if !face.is_hole {
            return;
        }
        let side = |part: f64, sign: f64| {
            let off = |factor: f64| at(a, part * length, sign * factor * face.radius);
            [off(1.0 - BESIDE), off(1.0 + BESIDE)]
        };
        let pairs: Vec<[Point; 2]> =
            PARTS.iter().flat_map(|&part| [side(part, 1.0), side(part, -1.0)]).collect();
        if is_edge(evaluator, &self.plane, &pairs, jump).contains(&false) {
            let r = face.radius;
            let corners = [at(a, 0.0, r), at(b, 0.0, r), at(b, 0.0, -r), at(a, 0.0, -r), at(a, 0.0, r)];
            svg.path("hidden", self.path(&corners), "");
        }
    }
}
