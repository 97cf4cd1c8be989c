//! Shared helpers of the concept pictures: elements, colours, and queries.

use rayweave::draw::svg::{Anchor, Pixels, Svg};
use rayweave::rootray::{RootRay, Side};
use rayweave::{Compiled, Evaluator, Program, Query, Ray, Solid, Weave, scene};
use std::path::Path;
use std::sync::Arc;

/// Classes beyond the common ones: table cells, the first operand (a), the second (b), the result (r),
/// neutral (n). The colours (M. Okabe and K. Ito's colour-blind safe palette) work on light and dark
/// backgrounds.
pub const STYLE: &str = "\
.cell { font-size: 12px }
.small { font-size: 10.5px }
.head { font-size: 12px; font-weight: 600 }
.faint { font-size: 12px; opacity: 0.35 }
.a { fill: #0072b2 }
.b { fill: #009e73 }
.r { fill: #d55e00 }
.n { fill: #8d97a3 }
.on { fill-opacity: 0.85 }
.tint { fill-opacity: 0.24 }
.line { fill: none; stroke-width: 1.5 }
.thick { fill: none; stroke-width: 4 }
.of-a { stroke: #0072b2 }
.of-b { stroke: #009e73 }
.of-r { stroke: #d55e00 }
.of-n { stroke: #8d97a3 }
.thread { fill: none; stroke-width: 1; stroke-opacity: 0.7 }
.ring { fill: none; stroke-width: 1.8 }
.wrong { fill: none; stroke: #d55e00; stroke-width: 2.5 }
@media (prefers-color-scheme: dark) {
.a { fill: #4aa3df }
.b { fill: #2bb58c }
.of-a { stroke: #4aa3df }
.of-b { stroke: #2bb58c }
}
";

/// A drawing with the elements of these pictures.
#[derive(Default)]
pub struct Sheet {
    pub svg: Svg,
}

impl Sheet {
    pub fn left(&mut self, class: &str, x: f64, y: f64, text: &str) {
        self.svg.text(class, [x, y], Anchor::Start, text, text);
    }

    pub fn centre(&mut self, class: &str, x: f64, y: f64, text: &str) {
        self.svg.text(class, [x, y], Anchor::Middle, text, text);
    }

    pub fn right(&mut self, class: &str, x: f64, y: f64, text: &str) {
        self.svg.text(class, [x, y], Anchor::End, text, text);
    }

    /// A line between two points.
    pub fn line(&mut self, class: &str, from: [f64; 2], to: [f64; 2]) {
        let [x1, y1, x2, y2] = [from[0], from[1], to[0], to[1]].map(Pixels);
        self.svg.path(class, format_args!("M{x1} {y1}L{x2} {y2}"), "");
    }

    /// A cell of a table: its background, unless the class is empty, and its text.
    pub fn cell(&mut self, ground: &str, place: [f64; 4], class: &str, text: &str) {
        let [x, y, width, height] = place;
        if !ground.is_empty() {
            self.svg.rectangle(ground, [x + 1.0, y + 1.0, width - 2.0, height - 2.0], r#" rx="3""#);
        }
        self.centre(class, x + 0.5 * width, y + 0.5 * height + 4.2, text);
    }

    /// A triangle that points along a ray.
    pub fn arrow(&mut self, class: &str, tip: [f64; 2]) {
        let [x, y, back, above, below] =
            [tip[0], tip[1], tip[0] - 9.0, tip[1] - 4.5, tip[1] + 4.5].map(Pixels);
        self.svg.path(class, format_args!("M{x} {y}L{back} {above}V{below}Z"), "");
    }

    pub fn finish(self, size: [f64; 2], title: &str, description: &str) -> String {
        self.svg.finish(size, title, description, STYLE)
    }
}

/// A model of the repository.
pub fn model(name: &str) -> scene::Scene {
    let models = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../models");
    scene::load(models.join(name).with_extension("toml"), &[]).unwrap().1
}

/// The root-ray of a solid of a model.
pub fn of_model(scene: &scene::Scene, name: &str, ray: Ray) -> RootRay {
    root_ray(&Weave::new(Compiled::solid(scene, name).unwrap().program), ray)
}

/// The root-ray of a solid.
pub fn seen(solid: &Solid, ray: Ray) -> RootRay {
    root_ray(&evaluator(solid), ray)
}

pub fn evaluator(solid: &Solid) -> Weave {
    Weave::new(Arc::new(Program::compile(solid).unwrap()))
}

pub fn root_ray(evaluator: &Weave, ray: Ray) -> RootRay {
    let answer = evaluator.one(ray, &Query::default()).unwrap();
    let start = Side::from_inside(answer.starts[0].index() > 0);
    RootRay::from_times(start, answer.of(0).iter().map(|crossing| crossing.t)).unwrap()
}

/// The two operands of `models/timeline.toml` along the middle of their bar.
pub fn operands() -> [RootRay; 2] {
    let scene = model("timeline");
    let along = Ray::new([0.0, 0.1, 0.2].into(), rayweave::Vec3::X);
    ["a", "b"].map(|name| of_model(&scene, name, along))
}

/// A number with a proper minus sign.
pub fn number(value: f64) -> String {
    value.to_string().replace('-', "\u{2212}")
}
