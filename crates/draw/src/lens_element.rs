//! Drawings of single lens elements in the tabular form of ISO 10110-1: a section along the axis with diameter and centre
//! thickness, and the indications of both surfaces and of the material.

use crate::DrawError;
use crate::dimension::{self, draw_sides};
use crate::svg::{Anchor, Svg};
use crate::technical::Scale;
use rayweave_error::Message;
use rayweave_optics::component::{Figure, SurfaceForm};
use rayweave_scene::Unit;

/// One side of a lens element.
#[derive(Clone, Debug, PartialEq)]
pub struct ElementFace {
    /// The form, in the coordinates of the prescription: a positive radius has its centre on the side of +z.
    pub form: SurfaceForm,
    /// The semi-diameter at which the optical surface ends; beyond it, the side is flat.
    pub end: f64,
    /// The semi-diameter of the light, or the stated one.
    pub clear: f64,
    /// True if the clear semi-diameter was computed from rays.
    pub is_computed: bool,
}

/// A lens element.
#[derive(Clone, Debug, PartialEq)]
pub struct LensElement {
    /// The title of the drawing.
    pub title: String,
    /// The name of the glass.
    pub material: String,
    /// The index at the d line, and the Abbe number; none outside the range of the glass.
    pub index: Option<[f64; 2]>,
    /// The sides in the order of z.
    pub faces: [ElementFace; 2],
    /// The centre thickness.
    pub thickness: f64,
    /// The semi-diameter of the element.
    pub semi_diameter: f64,
    /// The unit of lengths.
    pub unit: Unit,
}

/// A4, landscape, in units of 1/96 inch.
const PAPER: [f64; 2] = [1123.0, 794.0];
const MARGIN: f64 = 28.0;
/// The area of the section: left, top, right, bottom.
const AREA: [f64; 4] = [110.0, 40.0, 1060.0, 420.0];
/// The upper edge of the table, and the height of its rows.
const TABLE: [f64; 2] = [492.0, 22.0];
/// The error of rounded lengths, in metres: `dimension::value` rounds to a micrometre.
const ROUNDING: f64 = 0.9e-6;
/// Points of each side of the section.
const POINTS: u32 = 64;

const STYLE: &str = "\
.edge { fill: #a8d1f0; fill-opacity: 0.35; stroke: currentColor; stroke-width: 1.3; stroke-linejoin: round }
.centre { fill: none; stroke: #3d6ea8; stroke-width: 0.7; stroke-dasharray: 12 3 2 3 }
.clear { fill: none; stroke: #3d6ea8; stroke-width: 2.4 }
.frame { fill: none; stroke: currentColor; stroke-width: 0.7 }
.head { font-size: 13px; font-weight: 600 }
@media (prefers-color-scheme: dark) { .centre, .clear { stroke: #8fb8e8 } }
";

/// The drawing of a lens element as SVG. Fields for indications that a prescription does not have, such as tolerances of the
/// surface form (`3/`), remain empty.
///
/// # Errors
/// [`DrawError::Option`] for an element without a size or with a surface that ends within its diameter.
pub fn lens_element_drawing(element: &LensElement) -> Result<String, DrawError> {
    let drawn = outline(element).and_then(|sides| Some((scale(element, &sides)?, sides)));
    let Some((scale, sides)) = drawn else {
        let problem = format!("the lens {:?} cannot be drawn", element.title);
        let message = Message::new(problem, "a surface ends within its diameter, or it has no size");
        return Err(DrawError::Option(message.suggest("Check its radii and semi-diameters.")));
    };
    let mut svg = Svg::default();
    section(&mut svg, element, &sides, &scale);
    table(&mut svg, element);
    footer(&mut svg, element, &scale);
    let description = format!("Lens element, scale {}.", scale.text());
    Ok(svg.finish(PAPER, &element.title, &description, &[STYLE, dimension::STYLE].concat()))
}

/// The points (z, y) of both sides from the lower to the upper edge, with the vertex of the first side at 0.
fn outline(element: &LensElement) -> Option<[Vec<[f64; 2]>; 2]> {
    let side = |k: usize| {
        let (face, vertex) = (&element.faces[k], [0.0, element.thickness][k]);
        let end = face.end.min(element.semi_diameter);
        let height = |step: u32| end * (2.0 * f64::from(step) / f64::from(POINTS) - 1.0);
        let curve =
            (0..=POINTS).map(|step| Some([vertex + face.form.sag([0.0, height(step)])?, height(step)]));
        let curve: Vec<[f64; 2]> = curve.collect::<Option<_>>()?;
        let (first, last) = (curve[0], curve[curve.len() - 1]);
        let rim = |at: [f64; 2], y: f64| (end < element.semi_diameter).then_some([at[0], y]);
        let lower = rim(first, -element.semi_diameter);
        Some(lower.into_iter().chain(curve).chain(rim(last, element.semi_diameter)).collect::<Vec<_>>())
    };
    Some([side(0)?, side(1)?])
}

/// The extent of the element along the axis.
fn extent(sides: &[Vec<[f64; 2]>; 2]) -> [f64; 2] {
    let z = sides.iter().flatten().map(|point| point[0]);
    z.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], z| [low.min(z), high.max(z)])
}

fn scale(element: &LensElement, sides: &[Vec<[f64; 2]>; 2]) -> Option<Scale> {
    let [low, high] = extent(sides);
    let (width, height) = (high - low, 2.0 * element.semi_diameter);
    let [left, top, right, bottom] = AREA;
    // half of the width is for the leaders of the radii
    let most = (0.5 * (right - left) / width).min((bottom - top) / height);
    (most.is_finite() && most > 0.0).then(|| Scale::below(most, element.unit)).flatten()
}

fn length(element: &LensElement, length: f64) -> String {
    dimension::value(length, ROUNDING / element.unit.metres())
}

/// The section along the axis with its dimensions.
fn section(svg: &mut Svg, element: &LensElement, sides: &[Vec<[f64; 2]>; 2], scale: &Scale) {
    let [low, high] = extent(sides);
    let [left, top, right, bottom] = AREA;
    let (x0, y0) = (0.5 * (left + right) - 0.5 * scale.pixels * (low + high), 0.5 * (top + bottom));
    let at = |[z, y]: [f64; 2]| [x0 + scale.pixels * z, y0 - scale.pixels * y];
    let line = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let texts: Vec<String> = points.map(at).map(|[x, y]| format!("{x:.2} {y:.2}")).collect();
        format!("M{}", texts.join("L"))
    };
    let around = sides[0].iter().chain(sides[1].iter().rev()).copied();
    svg.path("edge", line(&mut around.clone()) + "Z", "");
    for (points, face) in sides.iter().zip(&element.faces) {
        let clear = points.iter().filter(|point| point[1].abs() <= face.clear * (1.0 + 1e-9)).copied();
        svg.path("clear", line(&mut clear.clone()), "");
    }
    let ([z0, _], [z1, _]) = (at([low, 0.0]), at([high, 0.0]));
    svg.path("centre", format!("M{:.2} {y0:.2}H{:.2}", z0 - 24.0, z1 + 24.0), "");
    let reach = scale.pixels * element.semi_diameter;
    let diameter = format!("\u{2300}{}", length(element, 2.0 * element.semi_diameter));
    draw_sides(svg, [z0, y0 - reach, z1, y0 + reach], (None, Some(&diameter)), [0.0; 2]);
    centre_thickness(svg, element, [at([0.0, 0.0])[0], at([element.thickness, 0.0])[0]], [y0, y0 + reach]);
    for (k, text) in ["R1", "R2"].into_iter().enumerate() {
        let [x, y] = at(sides[k][sides[k].len() * 3 / 4]);
        let (end, anchor) = if k == 0 { (z0 - 40.0, Anchor::End) } else { (z1 + 40.0, Anchor::Start) };
        svg.path("dimension", format!("M{x:.2} {y:.2}L{end:.2} {:.2}", y - 20.0), "");
        svg.text("value", [end + 4.0 * (2.0 * k as f64 - 1.0), y - 17.0], anchor, text, text);
    }
}

/// The dimension of the centre thickness below the section, from vertex to vertex, with its value to the right where the arrows leave no
/// room.
fn centre_thickness(svg: &mut Svg, element: &LensElement, [from, to]: [f64; 2], [axis, lower]: [f64; 2]) {
    let (y, text) = (lower + 30.0, length(element, element.thickness));
    let ends = [from, to].map(|x| format!("M{x:.2} {axis:.2}V{:.2}", y + 6.0));
    svg.path("dimension", ends.concat(), "");
    let needed = 7.5 * text.len() as f64 + 24.0;
    if to - from > needed {
        svg.path("dimension", format!("M{from:.2} {y:.2}H{to:.2}"), "");
        let arrows = dimension::arrow([from, y], [-1.0, 0.0]) + &dimension::arrow([to, y], [1.0, 0.0]);
        svg.path("arrow", arrows, "");
        svg.middle_text("value", [0.5 * (from + to), y - 5.0], 0.0, &text);
        return;
    }
    svg.path("dimension", format!("M{:.2} {y:.2}H{:.2}", from - 24.0, to + 24.0), "");
    let arrows = dimension::arrow([from, y], [1.0, 0.0]) + &dimension::arrow([to, y], [-1.0, 0.0]);
    svg.path("arrow", arrows, "");
    svg.text("value", [to + 28.0, y + 4.0], Anchor::Start, &text, &text);
}

/// The indications of a surface.
fn surface_rows(element: &LensElement, k: usize) -> Vec<String> {
    let face = &element.faces[k];
    let asphere = &face.form.asphere;
    let radius = asphere.radius;
    let shape = match (radius.is_infinite(), (radius > 0.0) == (k == 0)) {
        (true, _) => "R \u{221e}".to_owned(),
        (false, true) => format!("R {} CX", length(element, radius.abs())),
        (false, false) => format!("R {} CC", length(element, radius.abs())),
    };
    let star = if face.is_computed { " *" } else { "" };
    let mut rows = vec![shape, format!("\u{2300}e {}{star}", length(element, 2.0 * face.clear))];
    rows.extend(["Prot. chamfer", "\u{3bb}", "3/", "4/", "5/", "6/"].map(str::to_owned));
    if asphere.conic != 0.0 {
        rows.push(format!("K = {}", asphere.conic));
    }
    let odd = asphere.odd.iter().enumerate().map(|(n, c)| (2 * n + 1, *c));
    let even = asphere.even.iter().enumerate().map(|(n, c)| (2 * n + 2, *c));
    let mut terms: Vec<(usize, f64)> = odd.chain(even).filter(|(_, c)| *c != 0.0).collect();
    terms.sort_by_key(|(power, _)| *power);
    rows.extend(terms.iter().map(|(power, c)| format!("A{power} = {c:e}")));
    if face.form.figure != Figure::Round {
        rows.push("not of revolution: see the prescription".to_owned());
    }
    rows
}

fn material_rows(element: &LensElement) -> Vec<String> {
    let mut rows = vec![element.material.clone()];
    rows.extend(match element.index {
        Some([n_d, v_d]) => [format!("nd = {n_d:.6}"), format!("\u{3bd}d = {v_d:.2}")],
        None => ["nd".to_owned(), "\u{3bd}d".to_owned()],
    });
    rows.extend(["0/", "1/", "2/"].map(str::to_owned));
    rows
}

/// Three columns: the left surface, the material, the right surface.
fn table(svg: &mut Svg, element: &LensElement) {
    let columns = [
        ("Left surface (R1)", surface_rows(element, 0)),
        ("Material", material_rows(element)),
        ("Right surface (R2)", surface_rows(element, 1)),
    ];
    let [top, row] = TABLE;
    let width = (PAPER[0] - 2.0 * MARGIN) / 3.0;
    let bottom = PAPER[1] - MARGIN - 44.0;
    for (k, (head, rows)) in columns.iter().enumerate() {
        let x = MARGIN + width * k as f64;
        svg.rectangle("frame", [x, top, width, bottom - top], "");
        svg.text("head", [x + 10.0, top + 17.0], Anchor::Start, head, head);
        // rows that do not fit continue in a second column
        let fitting = (((bottom - top) / row) as usize).saturating_sub(1).max(1);
        for (number, text) in rows.iter().enumerate() {
            let place = [
                x + 10.0 + 0.5 * width * (number / fitting) as f64,
                top + 17.0 + row * (number % fitting + 1) as f64,
            ];
            svg.text("value", place, Anchor::Start, text, text);
        }
    }
}

fn footer(svg: &mut Svg, element: &LensElement, scale: &Scale) {
    let [width, height] = PAPER;
    let y = height - MARGIN;
    svg.text("title", [MARGIN, y], Anchor::Start, &element.title, &element.title);
    let facts = format!(
        "indications as in ISO 10110  \u{b7}  scale {}  \u{b7}  lengths in {}",
        scale.text(),
        element.unit.symbol()
    );
    svg.text("name", [width - MARGIN, y], Anchor::End, &facts, &facts);
    if element.faces.iter().any(|face| face.is_computed) {
        let note = "* not stated: the rays of all fields plus 2 %; the diameter of the element is the larger one, without a mounting rim";
        svg.text("name", [MARGIN, y - 22.0], Anchor::Start, note, note);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_optics::component::Asphere;

    fn biconcave() -> LensElement {
        let face = |radius: f64, is_computed| ElementFace {
            form: Asphere::conic(radius, 0.0).into(),
            end: 4.42406,
            clear: 4.0,
            is_computed,
        };
        LensElement {
            title: "lens 3-4".to_owned(),
            material: "F2".to_owned(),
            index: Some([1.62004, 36.3665]),
            faces: [face(-22.21328, true), face(20.29192, false)],
            thickness: 0.99997,
            semi_diameter: 4.42406,
            unit: Unit::Millimetre,
        }
    }

    #[test]
    fn a_lens_has_its_radii_thickness_and_glass() {
        let svg = lens_element_drawing(&biconcave()).unwrap();
        for text in
            ["R 22.213 CC", "R 20.292 CC", "\u{2300}8.848", ">1<", "F2", "nd = 1.620040", "\u{3bd}d = 36.37"]
        {
            assert!(svg.contains(text), "{text}: {svg}");
        }
        // only the computed diameter has the mark
        assert!(svg.contains("\u{2300}e 8 *<") && svg.contains("\u{2300}e 8<"), "{svg}");
    }

    #[test]
    fn surfaces_that_end_are_an_error() {
        let mut lens = biconcave();
        lens.faces[0].form = Asphere::conic(3.0, 0.0).into();
        let error = lens_element_drawing(&lens).unwrap_err().to_string();
        assert!(error.starts_with("the lens \"lens 3-4\" cannot be drawn: "), "{error}");
    }
}
