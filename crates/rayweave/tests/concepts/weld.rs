//! Picture of the weld: two touching boxes, rotated; the rounding gap between them, and its removal.
//!
//! The boxes are placed solids, which share no surfaces: otherwise the two faces would be one, with nothing
//! to weld.

use crate::kit::{Sheet, evaluator, number, root_ray, seen};
use rayweave::draw::svg::Pixels;
use rayweave::math::UNIT_ROUNDOFF;
use rayweave::rootray::RootRay;
use rayweave::shapes::{box_from_corners, place as place_at};
use rayweave::{Affine, Evaluator, Ray, Solid, Vec3};
use rayweave_shape::surface::{coincides_along, delta};
use std::fmt::Write;

const WIDTH: f64 = 960.0;
/// The rotation of the pair about z, in degrees.
const ANGLE: f64 = 20.0;
const CORNERS: [[[f64; 2]; 2]; 2] = [[[0.0, 0.0], [0.3, 0.2]], [[0.1 + 0.2, 0.0], [0.5, 0.2]]];

/// The left half: the origin of the scene, seen from above.
const SCENE: [f64; 2] = [70.0, 300.0];
const UNIT: f64 = 590.0;
/// The right half: the neighbourhood of the touching faces along the ray.
const LEFT: f64 = 560.0;
const RIGHT: f64 = 924.0;
const FRAME: [f64; 4] = [420.0, 44.0, 520.0, 274.0];

fn boxes() -> [Solid; 2] {
    CORNERS.map(|[lo, hi]| {
        let upright = box_from_corners([lo[0], lo[1], -1.0], [hi[0], hi[1], 1.0]).unwrap();
        place_at(&upright, vec![Affine::rotation(Vec3::Z, ANGLE)])
    })
}

/// A ray through both boxes, by its height at x = 0 and its slope.
fn ray(height: f64, slope: f64) -> Ray {
    Ray::new(Vec3::new(-0.1, height, 0.25), Vec3::new(1.0, slope, 0.0))
}

/// The first of a series of rays with a gap between the boxes.
fn one_with_a_gap(boxes: &[Solid; 2]) -> (Ray, [RootRay; 2]) {
    let [a, b] = boxes.each_ref().map(evaluator);
    let rays = (0..400u32).map(|k| ray(0.16 + 1e-4 * f64::from(k), 0.11));
    let mut seen = rays.map(|ray| (ray, [root_ray(&a, ray), root_ray(&b, ray)]));
    seen.find(|(_, [a, b])| a.roots()[1].t < b.roots()[0].t).unwrap()
}

/// Of 10,000 rays, the exact numbers with a gap and with an overlap, and the number of crossings that the
/// weld leaves between the boxes.
fn survey(boxes: &[Solid; 2]) -> [usize; 3] {
    let [a, b] = boxes.each_ref().map(evaluator);
    let both = evaluator(&(&boxes[0] | &boxes[1]));
    let mut counts = [0; 3];
    for k in 0..10_000u32 {
        let ray = ray(0.13 + 1e-5 * f64::from(k % 100), 0.08 + 1e-3 * f64::from(k / 100));
        let [first, second] = [&a, &b].map(|evaluator| root_ray(evaluator, ray));
        let (leaves, enters) = (first.roots()[1].t, second.roots()[0].t);
        counts[0] += usize::from(leaves < enters);
        counts[1] += usize::from(leaves > enters);
        counts[2] += root_ray(&both, ray).roots().len() - 2;
    }
    counts
}

pub fn picture() -> String {
    let boxes = boxes();
    let (ray, [a, b]) = one_with_a_gap(&boxes);
    let mut sheet = Sheet::default();
    sheet.left("title", 20.0, 28.0, "Two boxes that touch, turned by 20 degrees");
    scene(&mut sheet, ray, &a, &b);
    close_up(&mut sheet, &boxes, ray, &a, &b);
    let [gaps, overlaps, left] = survey(&boxes);
    let note = format!(
        "Of 10,000 such rays {gaps} see a gap and {overlaps} an overlap before the weld; after it {left} see either."
    );
    sheet.left("name", 20.0, 344.0, &note);
    let description = "On the left two rectangles share a side and a ray crosses both. On the right the same place \
                       magnified: box A ends a rounding error before box B begins, the exact union has a gap there, \
                       the welded union has none.";
    sheet.finish([WIDTH, 362.0], "Touching boxes before and after the weld", description)
}

/// The boxes from above, the ray, and the magnified place.
fn scene(sheet: &mut Sheet, ray: Ray, a: &RootRay, b: &RootRay) {
    let [x0, bottom] = SCENE;
    let place = |x: f64, y: f64| [x0 + UNIT * x, bottom - UNIT * y];
    let turn = Affine::rotation(Vec3::Z, ANGLE);
    for (corners, class) in CORNERS.iter().zip(["a tint", "b tint"]) {
        let [lo, hi] = corners;
        let mut path = String::new();
        for ([x, y], letter) in
            [[lo[0], lo[1]], [hi[0], lo[1]], [hi[0], hi[1]], [lo[0], hi[1]]].into_iter().zip("MLLL".chars())
        {
            let corner = turn.point(Vec3::new(x, y, 0.0));
            let [px, py] = place(corner.x, corner.y).map(Pixels);
            let _ = write!(path, "{letter}{px} {py}");
        }
        sheet.svg.path(class, format_args!("{path}Z"), "");
    }
    let at = |t: f64| {
        let point = ray.at(t);
        place(point.x, point.y)
    };
    let [start, end] = [at(0.04), at(0.66)];
    sheet.line("line of-n", start, end);
    sheet.arrow("n", end);
    for (crossed, class) in [(a, "thick of-a"), (b, "thick of-b")] {
        let roots = crossed.roots();
        sheet.line(class, at(roots[0].t), at(roots[1].t));
    }
    let middle = at(a.roots()[1].t);
    sheet.svg.circle("line of-r", middle, 11.0, "");
    for (from, to) in [(-11.0, FRAME[1]), (11.0, FRAME[1] + FRAME[3])] {
        sheet.line("thread of-r", [middle[0], middle[1] + from], [FRAME[0], to]);
    }
    sheet.svg.rectangle("thread of-r", FRAME, "");
    let [ax, ay] = at(0.5 * (a.roots()[0].t + a.roots()[1].t));
    let [bx, by] = at(0.5 * (b.roots()[0].t + b.roots()[1].t));
    sheet.centre("head", ax, ay + 24.0, "A");
    sheet.centre("head", bx, by + 24.0, "B");
}

/// The neighbourhood along the ray, magnified until single floating-point numbers are distinguishable.
fn close_up(sheet: &mut Sheet, boxes: &[Solid; 2], ray: Ray, a: &RootRay, b: &RootRay) {
    let (leaves, enters) = (a.roots()[1].t, b.roots()[0].t);
    let ulp = leaves.next_up() - leaves;
    let middle = leaves + ulp * ((enters - leaves) / ulp / 2.0).floor();
    let unit = (RIGHT - LEFT) / 12.0;
    let place = |t: f64| (LEFT + unit * (6.0 + (t - middle) / ulp)).clamp(LEFT, RIGHT);
    let exact = a | b;
    let welded = seen(&(&boxes[0] | &boxes[1]), ray);
    let rows = [
        ("A alone", a, "a"),
        ("B alone", b, "b"),
        ("A | B exactly", &exact, "r"),
        ("A | B welded", &welded, "r"),
    ];
    let magnified = format!("magnified: neighbouring numbers are {} apart", power_of_two(ulp));
    sheet.left("head", LEFT - 124.0, 64.0, &magnified);
    for (k, (name, ray, class)) in rows.into_iter().enumerate() {
        let y = 80.0 + 44.0 * k as f64;
        sheet.right("name", LEFT - 14.0, y + 18.0, name);
        for (start, end) in ray.spans() {
            let (from, to) = (place(start), place(end));
            if from < to {
                sheet.svg.rectangle(&format!("{class} tint"), [from, y, to - from, 26.0], "");
                sheet.line(&format!("line of-{class}"), [from, y], [to, y]);
            }
        }
        for root in ray.roots().iter().map(|root| place(root.t)).filter(|&x| LEFT < x && x < RIGHT) {
            sheet.line(&format!("line of-{class}"), [root, y], [root, y + 26.0]);
        }
    }
    steps(sheet, middle, ulp, &place);
    tolerance(sheet, boxes, ray, [leaves, enters]);
}

/// The floating-point numbers around a time.
fn steps(sheet: &mut Sheet, middle: f64, ulp: f64, place: &impl Fn(f64) -> f64) {
    let y = 262.0;
    sheet.line("axis", [LEFT, y], [RIGHT, y]);
    for k in -5..=5_i32 {
        let x = place(middle + f64::from(k) * ulp);
        sheet.line("axis", [x, y], [x, y + 4.0]);
        let text = if k == 0 { format!("t = {middle}") } else { format!("{k:+}").replace('-', "\u{2212}") };
        if k == 0 || k.abs() == 5 {
            sheet.centre("tick", x, y + 17.0, &text);
        }
    }
}

/// The ratio of the tolerance to the gap.
fn tolerance(sheet: &mut Sheet, boxes: &[Solid; 2], ray: Ray, [leaves, enters]: [f64; 2]) {
    let weave = evaluator(&boxes[0]);
    let program = weave.program();
    let near = program
        .surfaces()
        .iter()
        .find(|s| coincides_along(&s.surface, s.magnitude, &ray, leaves, enters))
        .unwrap();
    let width = delta(near.magnitude, &ray, leaves);
    let parts = (width / (enters - leaves)).round();
    let note = format!(
        "The gap is {} u; delta is {} u here, {} times as much.",
        number(((enters - leaves) / UNIT_ROUNDOFF * 100.0).round() / 100.0),
        number((width / UNIT_ROUNDOFF).round()),
        number(parts)
    );
    sheet.left("tick", LEFT - 124.0, 306.0, &note);
}

/// A power of two in mathematical notation.
fn power_of_two(value: f64) -> String {
    let exponent = (value.to_bits() >> 52) as i64 - 1023;
    format!("2^{exponent}").replace('-', "\u{2212}")
}
