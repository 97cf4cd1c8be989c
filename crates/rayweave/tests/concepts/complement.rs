//! Picture of a shape, its complement, and a difference as an intersection, in the plane z = 0, filled by
//! rays.

use crate::kit::{Sheet, evaluator, root_ray, seen};
use rayweave::draw::svg::Pixels;
use rayweave::rootray::{RootRay, surface_count};
use rayweave::shapes::{box_from_corners, sphere};
use rayweave::{Ray, Solid, Vec3};
use std::fmt::Write;

/// The box A and the ball B.
const LOW: [f64; 2] = [-2.6, -1.25];
const HIGH: [f64; 2] = [0.7, 1.25];
const CENTRE: [f64; 2] = [0.9, 0.0];
const RADIUS: f64 = 1.5;

/// Half the size of the visible window, in model units.
const HALF: [f64; 2] = [3.1, 2.05];
const UNIT: f64 = 46.0;
const PANEL: [f64; 2] = [2.0 * HALF[0] * UNIT, 2.0 * HALF[1] * UNIT];
const GAP: f64 = 18.0;
const TOP: f64 = 62.0;

/// The heights of the drawn rays.
const RAYS: [f64; 3] = [1.62, 0.62, -0.62];

/// One of the panels side by side.
struct Panel {
    name: &'static str,
    note: &'static str,
    ground: &'static str,
    solid: Solid,
    /// The solids counted along the rays.
    operands: Vec<Solid>,
}

pub fn picture() -> String {
    let a = box_from_corners([LOW[0], LOW[1], -1.0], [HIGH[0], HIGH[1], 1.0]).unwrap();
    let b = sphere(RADIUS).unwrap().translate([CENTRE[0], CENTRE[1], 0.0]);
    let panels = [
        Panel { name: "B", note: "count of B", ground: "of-b", solid: b.clone(), operands: vec![b.clone()] },
        Panel {
            name: "~B: everything else",
            note: "count of ~B",
            ground: "of-b",
            solid: !&b,
            operands: vec![!&b],
        },
        Panel {
            name: "A \u{2212} B = A & ~B",
            note: "count of A and ~B",
            ground: "of-r",
            solid: &a - &b,
            operands: vec![a.clone(), !&b],
        },
    ];
    let mut sheet = Sheet::default();
    sheet.left("title", GAP, 26.0, "A complement is a solid like any other");
    for (k, panel) in panels.iter().enumerate() {
        draw(&mut sheet, panel, GAP + (PANEL[0] + GAP) * k as f64);
    }
    let description = "Three panels: a disc B; its complement, which fills the rest of the plane; and a rectangle A \
                       without B. Rays cross each of them, with the count of solids around them written along the ray.";
    let size = [GAP + 3.0 * (PANEL[0] + GAP), TOP + PANEL[1] + 20.0];
    sheet.finish(size, "A shape, its complement, and the difference", description)
}

fn draw(sheet: &mut Sheet, panel: &Panel, left: f64) {
    sheet.left("head", left, TOP - 12.0, panel.name);
    let indent = 7.4 * panel.name.chars().count() as f64 + 12.0;
    sheet.left("tick", left + indent, TOP - 12.0, panel.note);
    let place = |x: f64, y: f64| [left + (x + HALF[0]) * UNIT, TOP + (HALF[1] - y) * UNIT];
    fill(sheet, panel, &place);
    outlines(sheet, panel.operands.len() > 1, &place);
    for y in RAYS {
        ray(sheet, panel, y, &place);
    }
    let frame = [left, TOP, PANEL[0], PANEL[1]];
    sheet.svg.rectangle("axis", frame, "");
}

/// The line along x at a height.
fn along(y: f64) -> Ray {
    Ray::new(Vec3::new(0.0, y, 0.0), Vec3::X)
}

/// The spans of a ray, clipped to the window.
fn spans(ray: &RootRay) -> impl Iterator<Item = (f64, f64)> + '_ {
    let cut = |t: f64| t.clamp(-HALF[0], HALF[0]);
    ray.spans().map(move |(start, end)| (cut(start), cut(end))).filter(|(start, end)| start < end)
}

/// Fills a solid with one ray for every two pixels.
fn fill(sheet: &mut Sheet, panel: &Panel, place: &impl Fn(f64, f64) -> [f64; 2]) {
    let weave = evaluator(&panel.solid);
    let rows = (PANEL[1] / 2.0) as u32;
    let mut path = String::new();
    for row in 0..rows {
        let y = HALF[1] - (f64::from(row) + 0.5) * 2.0 / UNIT;
        for (start, end) in spans(&root_ray(&weave, along(y))) {
            let ([from, at], [to, _]) = (place(start, y), place(end, y));
            let _ = write!(path, "M{} {}H{}", Pixels(from), Pixels(at), Pixels(to));
        }
    }
    let style = r#" fill="none" stroke-width="2" stroke-opacity="0.28""#;
    sheet.svg.path(panel.ground, path, style);
}

fn outlines(sheet: &mut Sheet, with_box: bool, place: &impl Fn(f64, f64) -> [f64; 2]) {
    sheet.svg.circle("line of-b", place(CENTRE[0], CENTRE[1]), RADIUS * UNIT, "");
    if with_box {
        let [x, y] = place(LOW[0], HIGH[1]);
        let size = [(HIGH[0] - LOW[0]) * UNIT, (HIGH[1] - LOW[1]) * UNIT];
        sheet.svg.rectangle("line of-a", [x, y, size[0], size[1]], "");
    }
}

/// A ray: thick inside the solid, with the count above each span.
fn ray(sheet: &mut Sheet, panel: &Panel, y: f64, place: &impl Fn(f64, f64) -> [f64; 2]) {
    sheet.line("line of-n", place(-HALF[0], y), place(HALF[0], y));
    for (start, end) in spans(&seen(&panel.solid, along(y))) {
        sheet.line(&format!("thick {}", panel.ground), place(start, y), place(end, y));
    }
    sheet.arrow("n", place(HALF[0] - 0.02, y));
    let rays: Vec<RootRay> = panel.operands.iter().map(|operand| seen(operand, along(y))).collect();
    let count = surface_count(&rays);
    let mut ends = vec![-HALF[0]];
    ends.extend(count.steps.iter().map(|step| step.0));
    ends.push(HALF[0]);
    let counts = std::iter::once(count.start).chain(count.steps.iter().map(|step| step.1));
    for (piece, count) in ends.windows(2).zip(counts) {
        let [x, at] = place(0.5 * (piece[0] + piece[1]), y);
        sheet.centre("head", x, at - 6.0, &count.to_string());
    }
    for &(t, _) in &count.steps {
        sheet.svg.circle("n", place(t, y), 3.0, "");
    }
}
