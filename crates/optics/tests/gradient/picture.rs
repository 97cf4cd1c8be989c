//! The picture of `docs/guides/gradient-index.md`, drawn from traces and compared with the file of the page.
//!
//! `cargo xtask golden --accept` writes it again: inspect it before committing.

use crate::{D_NM, ball, graded, plane, rod, trace};
use rayweave_math::Vec3;
use rayweave_optics::gradient::Gradient;
use rayweave_optics::{Action, Assembly, Beam, Element, Event, Light, Segment, System, TraceSettings};
use std::fmt::Write;
use std::fs;
use std::path::Path;

/// The variable that makes the test write the picture instead of comparing it.
const ACCEPT: &str = "RAYWEAVE_ACCEPT_GOLDEN";

const STYLE: &str = "text{font:14px sans-serif;fill:#333}.ray{fill:none;stroke:#c0392b;stroke-width:1.2}\
.edge{stroke:#345;stroke-width:1.5}.page{fill:#fff}";

/// A part of the picture: the position of the point (y, z) = 0, and the pixels per unit of length; z goes to the
/// right, y up.
struct Panel {
    centre: [f64; 2],
    scale: f64,
}

impl Panel {
    fn place(&self, p: Vec3) -> String {
        let (x, y) = (self.centre[0] + self.scale * p.z, self.centre[1] - self.scale * p.y);
        format!("{:.1} {:.1}", x + 0.0, y + 0.0)
    }

    /// The pieces of one ray: a curved piece is a cubic with the directions at its ends.
    fn ray(&self, light: &Light, rows: &[Segment], beyond: f64) -> String {
        let mut before = None;
        let mut path = format!("M{}", self.place(light.ray.origin));
        for row in rows {
            let end = if row.end.is_finite() { row.end } else { row.start + beyond * row.direction };
            let chord = (end - row.start).length();
            let is_bent = row.end.is_finite() && row.direction.cross(end - row.start).length() > 1e-9 * chord;
            if is_bent {
                let before = before.unwrap_or_else(|| begins(row));
                // the best cubic approximation of an arc of that angle (tangents of 4/3 tan of a
                // quarter of it)
                let quarter = 0.25 * before.angle_between(row.direction);
                let pull = chord * 4.0 / 3.0 * quarter.tan() / (2.0 * (2.0 * quarter).sin());
                let handles = [row.start + pull * before, end - pull * row.direction, end];
                let places = handles.map(|p| self.place(p)).join(" ");
                let _ = write!(path, "C{places}");
            } else {
                let _ = write!(path, "L{}", self.place(end));
            }
            // a face refracts light; the piece behind it begins like an arc
            before = (row.event == Event::Curved).then_some(row.direction);
        }
        format!("<path class=\"ray\" d=\"{path}\"/>\n")
    }
}

/// The direction at the beginning of a curved piece between a row before it and one at its end: the mirror image of that at the end in
/// the plane halfway, as on an arc.
fn begins(row: &Segment) -> Vec3 {
    let chord = (row.end - row.start).normalize();
    (2.0 * row.direction.dot(chord) * chord - row.direction).normalize()
}

fn rays(panel: &Panel, system: &System, lights: &[Light], beyond: f64) -> String {
    let ray = |light: &Light| {
        let beam = Beam::from_iter([*light]);
        let rows: Vec<Segment> = trace(system, &beam, &TraceSettings::default()).segments.iter().collect();
        panel.ray(light, &rows, beyond)
    };
    lights.iter().map(ray).collect()
}

/// Shades of the index from the middle to the rim.
fn shades(id: &str, kind: &str, index: impl Fn(f64) -> f64) -> String {
    let stop = |k: u32| {
        let part = f64::from(k) / 8.0;
        let depth = 0.08 + 0.5 * (index(part) - index(1.0)) / (index(0.0) - index(1.0));
        format!("<stop offset=\"{part}\" stop-color=\"#4a90d9\" stop-opacity=\"{depth:.3}\"/>")
    };
    let stops: String = (0..=8).map(stop).collect();
    format!(
        "<{kind} id=\"{id}\"{}>{stops}</{}>\n",
        if kind.starts_with("linear") {
            " x1=\"0\" y1=\"1\" x2=\"0\" y2=\"0\" spreadMethod=\"reflect\""
        } else {
            ""
        },
        kind
    )
}

fn disk(panel: &Panel, radius: f64, fill: &str) -> String {
    let [x, y] = panel.centre;
    let r = radius * panel.scale;
    format!("<circle class=\"edge\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{r:.1}\" fill=\"url(#{fill})\"/>\n")
}

fn text(x: f64, y: f64, text: &str) -> String {
    format!("<text x=\"{x}\" y=\"{y}\">{text}</text>\n")
}

/// A point on the flat end of a rod, imaged every half pitch, and parallel after five quarters.
fn selfoc() -> String {
    let (g, radius) = (0.25, 1.2);
    let length = 2.5 * std::f64::consts::PI / g;
    let panel = Panel { centre: [60.0, 110.0], scale: 23.0 };
    let medium = graded(1.6, Gradient::selfoc(g).unwrap());
    let rod = Element::transparent("rod", rod(radius, length), &medium);
    let system = Assembly::new().add(rod).compile().unwrap();
    let light = |k: i32| {
        let (s, c) = (4.0 * f64::from(k)).to_radians().sin_cos();
        Light::new(-2.0 * Vec3::new(0.0, s, c), Vec3::new(0.0, s, c), D_NM)
    };
    let lights: Vec<Light> = (-5..=5).map(light).collect();
    let [x, y] = panel.centre;
    let (w, h) = (panel.scale * length, panel.scale * radius);
    let mut picture = String::new();
    for (id, top, turn) in [("upper", y - h, ""), ("lower", y, "-flipped")] {
        let _ = writeln!(
            picture,
            "<rect x=\"{x:.1}\" y=\"{top:.1}\" width=\"{w:.1}\" height=\"{h:.1}\" fill=\"url(#rod{turn})\" data-part=\"{id}\"/>"
        );
    }
    let _ = writeln!(
        picture,
        "<rect class=\"edge\" x=\"{x:.1}\" y=\"{:.1}\" width=\"{w:.1}\" height=\"{:.1}\" fill=\"none\"/>",
        y - h,
        2.0 * h
    );
    picture
        + &rays(&panel, &system, &lights, 2.5)
        + &text(60.0, 50.0, "A rod of five quarters of a pitch, n = 1.6 (1 - g² r²)^½")
}

fn luneburg() -> String {
    let (a, panel) = (3.0, Panel { centre: [210.0, 370.0], scale: 45.0 });
    let ball = Element::transparent("ball", ball(a), &graded(1.0, Gradient::luneburg(a).unwrap()));
    let system = Assembly::new().add(ball).compile().unwrap();
    let light = |k: i32| Light::new(Vec3::new(0.0, 0.28 * f64::from(k), -4.2), Vec3::Z, D_NM);
    let lights: Vec<Light> = (-10..=10).map(light).collect();
    disk(&panel, a, "luneburg") + &rays(&panel, &system, &lights, 1.6) + &text(60.0, 210.0, "Luneburg's lens")
}

fn fish_eye() -> String {
    let (a, panel) = (2.0, Panel { centre: [620.0, 370.0], scale: 23.0 });
    let ball = Element::transparent("ball", ball(6.0), &graded(1.0, Gradient::fish_eye(a).unwrap()));
    let image = Element::sheet("image", plane(4.0, 0.5), Action::Absorb);
    let system = Assembly::new().add(ball).add(image).compile().unwrap();
    let light = |k: i32| {
        let (s, c) = (8.0 * f64::from(k)).to_radians().sin_cos();
        [Light::new(-Vec3::Z, Vec3::new(0.0, s, c), D_NM), Light::new(-Vec3::Z, Vec3::new(0.0, -s, c), D_NM)]
    };
    let lights: Vec<Light> = (6..=16).flat_map(light).collect();
    disk(&panel, 6.0, "fish-eye")
        + &rays(&panel, &system, &lights, 0.0)
        + &text(480.0, 210.0, "Maxwell's fish-eye")
}

fn picture() -> String {
    let shade = shades("rod", "linearGradient", |r| (1.0 - (0.3 * r).powi(2)).sqrt());
    let flipped = shade
        .replace("\"rod\"", "\"rod-flipped\"")
        .replace("y1=\"1\"", "y1=\"0\"")
        .replace("y2=\"0\"", "y2=\"1\"");
    let defs = shade
        + &flipped
        + &shades("luneburg", "radialGradient", |r| (2.0 - r * r).sqrt())
        + &shades("fish-eye", "radialGradient", |r| 2.0 / (1.0 + 9.0 * r * r));
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 860 530\" role=\"img\">\n\
         <title>Light in media with a gradient</title>\n<style>{STYLE}</style>\n<defs>\n{defs}</defs>\n\
         <rect class=\"page\" width=\"860\" height=\"530\"/>\n{}{}{}</svg>\n",
        selfoc(),
        luneburg(),
        fish_eye()
    )
}

#[test]
fn the_picture_is_that_of_the_page() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/guides/images/gradient-index.svg");
    let drawn = picture();
    if std::env::var_os(ACCEPT).is_some() {
        fs::write(&path, drawn).unwrap();
        return;
    }
    let kept = fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == drawn, "the picture has changed: set {ACCEPT} to write it, and look at it");
}
