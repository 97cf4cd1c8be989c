//! Drawings of single lens elements in the tabular form of ISO 10110-1: a section along the axis with diameter and centre
//! thickness, and the indications of both surfaces and of the material.

use crate::DrawError;
use crate::dimension::{self, draw_sides};
use crate::indications::Indications;
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
    /// The indications that a prescription does not have.
    pub indications: Indications,
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
/// surface form (`3/`), have the texts of [`LensElement::indications`], or remain empty.
///
/// # Errors
/// [`DrawError::Option`] for an element without a size or with a surface that ends within its diameter.
pub fn lens_element_drawing(element: &LensElement) -> Result<String, DrawError> {
    let sides = |sides: [Vec<[f64; 2]>; 2]| {
        Some((scale(extent(&sides), element.semi_diameter, element.unit)?, sides))
    };
    let Some((scale, sides)) = outline(element).and_then(sides) else {
        return Err(no_drawing(&element.title));
    };
    let mut svg = Svg::default();
    section(&mut svg, element, &sides, &scale);
    table(&mut svg, element);
    footer(&mut svg, &element.title, std::slice::from_ref(element), &scale);
    let description = format!("Lens element, scale {}.", scale.text());
    Ok(svg.finish(PAPER, &element.title, &description, &[STYLE, dimension::STYLE].concat()))
}

/// The drawing of cemented lens elements, in the order of z, as SVG: a section with the overall diameter and centre thickness, the
/// radii of all surfaces, and the glasses, thicknesses and diameters of the elements.
///
/// # Errors
/// As for [`lens_element_drawing`], and no elements.
pub fn lens_group_drawing(
    elements: &[LensElement],
    title: &str,
    indications: &Indications,
) -> Result<String, DrawError> {
    let sides: Option<Vec<_>> = elements.iter().map(outline).collect();
    let (Some(mut sides), Some(first)) = (sides, elements.first()) else { return Err(no_drawing(title)) };
    let mut vertices = vec![0.0];
    for (element, sides) in elements.iter().zip(&mut sides) {
        let vertex = vertices[vertices.len() - 1];
        sides.iter_mut().flatten().for_each(|point| point[0] += vertex);
        vertices.push(vertex + element.thickness);
    }
    let range = sides
        .iter()
        .map(extent)
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], own| [low.min(own[0]), high.max(own[1])]);
    let semi_diameter = elements.iter().map(|element| element.semi_diameter).fold(0.0, f64::max);
    let Some(scale) = scale(range, semi_diameter, first.unit) else { return Err(no_drawing(title)) };
    let group = Group { elements, sides: &sides, vertices: &vertices, range, semi_diameter };
    let mut svg = Svg::default();
    group.section(&mut svg, &scale, indications);
    group.table(&mut svg, indications);
    footer(&mut svg, title, elements, &scale);
    let description = format!("Cemented lens elements, scale {}.", scale.text());
    Ok(svg.finish(PAPER, title, &description, &[STYLE, dimension::STYLE].concat()))
}

fn no_drawing(title: &str) -> DrawError {
    let problem = format!("the lens {title:?} cannot be drawn");
    let message = Message::new(problem, "a surface ends within its diameter, or it has no size");
    DrawError::Option(message.suggest("Check its radii and semi-diameters."))
}

/// Cemented elements with their outlines.
struct Group<'a> {
    elements: &'a [LensElement],
    /// The sides of each element, with the vertex of the first one at 0.
    sides: &'a [[Vec<[f64; 2]>; 2]],
    /// The vertices of all surfaces along the axis.
    vertices: &'a [f64],
    /// The extent along the axis.
    range: [f64; 2],
    semi_diameter: f64,
}

impl Group<'_> {
    fn section(&self, svg: &mut Svg, scale: &Scale, indications: &Indications) {
        let frame = Frame::new(self.range, scale);
        for (sides, element) in self.sides.iter().zip(self.elements) {
            frame.element(svg, sides, &element.faces);
        }
        let [low, high] = self.range;
        frame.axis(svg, self.range);
        let ([z0, y0], [z1, _]) = (frame.at([low, 0.0]), frame.at([high, 0.0]));
        let reach = scale.pixels * self.semi_diameter;
        let unit = self.elements[0].unit;
        let diameter = format!("\u{2300}{}", length(unit, 2.0 * self.semi_diameter));
        let diameter = indications.after("diameter", diameter);
        draw_sides(svg, [z0, y0 - reach, z1, y0 + reach], (None, Some(&diameter)), [0.0; 2]);
        let total = self.vertices[self.vertices.len() - 1];
        let text = indications.after("thickness", length(unit, total));
        centre_thickness(svg, &text, [0.0, total].map(|z| frame.at([z, 0.0])[0]), y0 + reach);
        let last = self.elements.len();
        for k in 0..=last {
            let side = if k == last { &self.sides[k - 1][1] } else { &self.sides[k][0] };
            // the leaders fan out above the section
            let from = frame.at(side[side.len() * 3 / 4]);
            let spread = 2.0 * k as f64 / last as f64 - 1.0;
            let to = [0.5 * (z0 + z1) + spread * (0.5 * (z1 - z0) + 40.0), y0 - reach - 16.0];
            svg.path("dimension", format!("M{:.2} {:.2}L{:.2} {:.2}", from[0], from[1], to[0], to[1]), "");
            let text = format!("R{}", k + 1);
            svg.text("value", [to[0], to[1] - 4.0], Anchor::Middle, &text, &text);
        }
        for (k, vertex) in self.vertices[..last].iter().enumerate() {
            let at = frame.at([vertex + 0.5 * self.elements[k].thickness, -0.3 * self.semi_diameter]);
            svg.text("head", at, Anchor::Middle, &(k + 1).to_string(), &(k + 1).to_string());
        }
    }

    /// Three columns: the surfaces, the elements, the group.
    fn table(&self, svg: &mut Svg, indications: &Indications) {
        let unit = self.elements[0].unit;
        let last = self.elements.len() - 1;
        let mut surfaces: Vec<String> = self
            .elements
            .iter()
            .enumerate()
            .map(|(k, own)| format!("R{}: {}", k + 1, shape(own, 0)))
            .collect();
        surfaces.push(format!("R{}: {}", last + 2, shape(&self.elements[last], 1)));
        for (k, element) in self.elements.iter().enumerate().skip(1) {
            let face = &element.faces[0];
            let star = if face.is_computed { " *" } else { "" };
            surfaces.push(format!("R{} cemented, \u{2300}e {}{star}", k + 1, length(unit, 2.0 * face.clear)));
        }
        let element = |(k, own): (usize, &LensElement)| {
            let [thickness, diameter] = [own.thickness, 2.0 * own.semi_diameter].map(|own| length(unit, own));
            format!("{}: {}, thickness {thickness}, \u{2300}{diameter}", k + 1, own.material)
        };
        let elements = self.elements.iter().enumerate().map(element).collect();
        let group = ["cement", "4/", "5/", "note"].map(|field| indications.row(field, field_label(field)));
        columns(svg, [("Surfaces", surfaces), ("Elements", elements), ("Cemented group", group.to_vec())]);
    }
}

/// The label of a field in the table.
fn field_label(field: &str) -> &str {
    match field {
        "cement" => "Cement",
        "note" => "Note",
        "chamfer" => "Prot. chamfer",
        "coating" => "\u{3bb}",
        other => other,
    }
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

fn scale([low, high]: [f64; 2], semi_diameter: f64, unit: Unit) -> Option<Scale> {
    let (width, height) = (high - low, 2.0 * semi_diameter);
    let [left, top, right, bottom] = AREA;
    // half of the width is for the leaders of the radii
    let most = (0.5 * (right - left) / width).min((bottom - top) / height);
    (most.is_finite() && most > 0.0).then(|| Scale::below(most, unit)).flatten()
}

fn length(unit: Unit, length: f64) -> String {
    dimension::value(length, ROUNDING / unit.metres())
}

/// The place of a section on the paper: its middle is that of the area.
struct Frame<'a> {
    origin: [f64; 2],
    scale: &'a Scale,
}

impl Frame<'_> {
    fn new([low, high]: [f64; 2], scale: &Scale) -> Frame<'_> {
        let [left, top, right, bottom] = AREA;
        let x = 0.5 * (left + right) - 0.5 * scale.pixels * (low + high);
        Frame { origin: [x, 0.5 * (top + bottom)], scale }
    }

    /// The pixels of a point (z, y).
    fn at(&self, [z, y]: [f64; 2]) -> [f64; 2] {
        [self.origin[0] + self.scale.pixels * z, self.origin[1] - self.scale.pixels * y]
    }

    fn line(&self, points: impl Iterator<Item = [f64; 2]>) -> String {
        let texts: Vec<String> =
            points.map(|at| self.at(at)).map(|[x, y]| format!("{x:.2} {y:.2}")).collect();
        format!("M{}", texts.join("L"))
    }

    /// An element with its clear surfaces.
    fn element(&self, svg: &mut Svg, sides: &[Vec<[f64; 2]>; 2], faces: &[ElementFace; 2]) {
        let around = sides[0].iter().chain(sides[1].iter().rev()).copied();
        svg.path("edge", self.line(around) + "Z", "");
        for (points, face) in sides.iter().zip(faces) {
            let clear = points.iter().filter(|point| point[1].abs() <= face.clear * (1.0 + 1e-9)).copied();
            svg.path("clear", self.line(clear), "");
        }
    }

    fn axis(&self, svg: &mut Svg, [low, high]: [f64; 2]) {
        let ([z0, y], [z1, _]) = (self.at([low, 0.0]), self.at([high, 0.0]));
        svg.path("centre", format!("M{:.2} {y:.2}H{:.2}", z0 - 24.0, z1 + 24.0), "");
    }
}

/// The section along the axis with its dimensions.
fn section(svg: &mut Svg, element: &LensElement, sides: &[Vec<[f64; 2]>; 2], scale: &Scale) {
    let [low, high] = extent(sides);
    let frame = Frame::new([low, high], scale);
    frame.element(svg, sides, &element.faces);
    frame.axis(svg, [low, high]);
    let at = |point: [f64; 2]| frame.at(point);
    let ([z0, y0], [z1, _]) = (at([low, 0.0]), at([high, 0.0]));
    let reach = scale.pixels * element.semi_diameter;
    let diameter = format!("\u{2300}{}", length(element.unit, 2.0 * element.semi_diameter));
    let diameter = element.indications.after("diameter", diameter);
    draw_sides(svg, [z0, y0 - reach, z1, y0 + reach], (None, Some(&diameter)), [0.0; 2]);
    let text = element.indications.after("thickness", length(element.unit, element.thickness));
    centre_thickness(svg, &text, [0.0, element.thickness].map(|z| at([z, 0.0])[0]), y0 + reach);
    for (k, text) in ["R1", "R2"].into_iter().enumerate() {
        let [x, y] = at(sides[k][sides[k].len() * 3 / 4]);
        let (end, anchor) = if k == 0 { (z0 - 40.0, Anchor::End) } else { (z1 + 40.0, Anchor::Start) };
        svg.path("dimension", format!("M{x:.2} {y:.2}L{end:.2} {:.2}", y - 20.0), "");
        svg.text("value", [end + 4.0 * (2.0 * k as f64 - 1.0), y - 17.0], anchor, text, text);
    }
}

/// The dimension of the centre thickness below the section, from vertex to vertex, with its value to the right where the arrows leave no
/// room. The extension lines begin below the section: from the axis, they would lie on the surfaces.
fn centre_thickness(svg: &mut Svg, text: &str, [from, to]: [f64; 2], lower: f64) {
    let y = lower + 30.0;
    let ends = [from, to].map(|x| format!("M{x:.2} {:.2}V{:.2}", lower + 3.0, y + 6.0));
    svg.path("dimension", ends.concat(), "");
    let needed = 7.5 * text.len() as f64 + 24.0;
    if to - from > needed {
        svg.path("dimension", format!("M{from:.2} {y:.2}H{to:.2}"), "");
        let arrows = dimension::arrow([from, y], [-1.0, 0.0]) + &dimension::arrow([to, y], [1.0, 0.0]);
        svg.path("arrow", arrows, "");
        svg.middle_text("value", [0.5 * (from + to), y - 5.0], 0.0, text);
        return;
    }
    svg.path("dimension", format!("M{:.2} {y:.2}H{:.2}", from - 24.0, to + 24.0), "");
    let arrows = dimension::arrow([from, y], [1.0, 0.0]) + &dimension::arrow([to, y], [-1.0, 0.0]);
    svg.path("arrow", arrows, "");
    svg.text("value", [to + 28.0, y + 4.0], Anchor::Start, text, text);
}

/// The radius of a side, convex (CX) or concave (CC) as seen from outside.
fn shape(element: &LensElement, k: usize) -> String {
    let radius = element.faces[k].form.asphere.radius;
    match (radius.is_infinite(), (radius > 0.0) == (k == 0)) {
        (true, _) => "R \u{221e}".to_owned(),
        (false, true) => format!("R {} CX", length(element.unit, radius.abs())),
        (false, false) => format!("R {} CC", length(element.unit, radius.abs())),
    }
}

/// The indications of a surface.
fn surface_rows(element: &LensElement, k: usize) -> Vec<String> {
    let face = &element.faces[k];
    let asphere = &face.form.asphere;
    let side = ["left", "right"][k];
    let star = if face.is_computed { " *" } else { "" };
    let mut rows = vec![
        element.indications.after(&format!("{side} radius"), shape(element, k)),
        format!("\u{2300}e {}{star}", length(element.unit, 2.0 * face.clear)),
    ];
    let fields = ["chamfer", "coating", "3/", "4/", "5/", "6/"];
    rows.extend(fields.map(|field| element.indications.row(&format!("{side} {field}"), field_label(field))));
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
    rows.extend(["0/", "1/", "2/"].map(|field| element.indications.row(field, field)));
    rows
}

/// Three columns: the left surface, the material, the right surface.
fn table(svg: &mut Svg, element: &LensElement) {
    let left = ("Left surface (R1)", surface_rows(element, 0));
    let right = ("Right surface (R2)", surface_rows(element, 1));
    columns(svg, [left, ("Material", material_rows(element)), right]);
}

fn columns(svg: &mut Svg, columns: [(&str, Vec<String>); 3]) {
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

fn footer(svg: &mut Svg, title: &str, elements: &[LensElement], scale: &Scale) {
    let [width, height] = PAPER;
    let y = height - MARGIN;
    svg.text("title", [MARGIN, y], Anchor::Start, title, title);
    let facts = format!(
        "indications as in ISO 10110  \u{b7}  scale {}  \u{b7}  lengths in {}",
        scale.text(),
        elements[0].unit.symbol()
    );
    svg.text("name", [width - MARGIN, y], Anchor::End, &facts, &facts);
    if elements.iter().flat_map(|element| &element.faces).any(|face| face.is_computed) {
        let clear = |element: &LensElement| element.faces.iter().map(|face| face.clear).fold(0.0, f64::max);
        let has_rim = |element: &LensElement| element.semi_diameter > clear(element) * (1.0 + 1e-9);
        let diameter = match elements.iter().all(has_rim) {
            true => "",
            false => "; the diameter of the element is the larger one, without a mounting rim",
        };
        let note = format!("* not stated: the rays of all fields plus 2 %{diameter}");
        svg.text("name", [MARGIN, y - 22.0], Anchor::Start, &note, &note);
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
            indications: Indications::default(),
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
    fn indications_fill_their_fields() {
        let entries = [
            ("thickness", "\u{b1} 0.05"),
            ("diameter", "-0.02"),
            ("left radius", "\u{b1} 0.02"),
            ("left 3/", "2(0.5)"),
            ("right 4/", "4/ 3'"),
            ("right coating", "R < 0.5 %"),
            ("0/", "10"),
        ];
        let entries = entries.map(|(field, text)| (field.to_owned(), text.to_owned()));
        let indications = Indications::of_element(entries).unwrap();
        let svg = lens_element_drawing(&LensElement { indications, ..biconcave() }).unwrap();
        for text in [
            ">1 \u{b1} 0.05<",
            ">\u{2300}8.848 -0.02<",
            ">R 22.213 CC \u{b1} 0.02<",
            ">3/ 2(0.5)<",
            ">4/ 3&#39;<",
            ">\u{3bb} R &lt; 0.5 %<",
            ">0/ 10<",
            // the other side has none
            ">3/<",
            ">4/<",
        ] {
            assert!(svg.contains(text), "{text}: {svg}");
        }
        let wrong = Indications::of_element([("left 7/".to_owned(), String::new())]).unwrap_err().to_string();
        assert!(wrong.starts_with("there is no field \"left 7/\""), "{wrong}");
        let group = Indications::of_group([("left 3/".to_owned(), String::new())]).unwrap_err().to_string();
        assert!(group.contains("cement"), "{group}");
    }

    /// A plano-convex and a plano-concave part, cemented at the radius 50.
    #[test]
    fn cemented_elements_have_one_drawing() {
        let face = |radius: f64| ElementFace {
            form: Asphere::conic(radius, 0.0).into(),
            end: 10.0,
            clear: 9.0,
            is_computed: false,
        };
        let part = |material: &str, radii: [f64; 2], thickness: f64, semi_diameter: f64| LensElement {
            title: String::new(),
            material: material.to_owned(),
            index: None,
            faces: radii.map(face),
            thickness,
            semi_diameter,
            unit: Unit::Millimetre,
            indications: Indications::default(),
        };
        let parts = [
            part("N-BK7", [f64::INFINITY, -50.0], 6.0, 10.0),
            part("N-SF5", [-50.0, f64::INFINITY], 2.5, 10.0),
        ];
        let indications = Indications::of_group([("cement".to_owned(), "NOA 61".to_owned())]).unwrap();
        let svg = lens_group_drawing(&parts, "doublet", &indications).unwrap();
        for text in [
            // the overall thickness and diameter
            ">8.5<",
            ">\u{2300}20<",
            ">R1: R \u{221e}<",
            ">R2: R 50 CC<",
            ">R3: R \u{221e}<",
            ">R2 cemented, \u{2300}e 18<",
            ">1: N-BK7, thickness 6, \u{2300}20<",
            ">2: N-SF5, thickness 2.5, \u{2300}20<",
            ">Cement NOA 61<",
        ] {
            assert!(svg.contains(text), "{text}: {svg}");
        }
        assert!(lens_group_drawing(&[], "none", &indications).is_err());
    }

    /// The extension lines of the centre thickness begin below the element, not on its surfaces.
    #[test]
    fn extension_lines_keep_off_the_surfaces() {
        let svg = lens_element_drawing(&biconcave()).unwrap();
        let edge = svg.lines().find(|line| line.contains("class=\"edge\"")).unwrap();
        let outline = edge.split("d=\"M").nth(1).unwrap().split('Z').next().unwrap();
        let lowest = outline
            .split('L')
            .filter_map(|point| point.split(' ').nth(1)?.parse::<f64>().ok())
            .fold(0.0, f64::max);
        let ends = svg.lines().filter(|line| line.contains("class=\"dimension\"") && line.contains('V'));
        let starts: Vec<f64> = ends
            .flat_map(|line| {
                line.split("d=\"").nth(1).unwrap().split('M').map(str::to_owned).collect::<Vec<_>>()
            })
            .filter_map(|part| part.split_once('V')?.0.split(' ').nth(1)?.parse().ok())
            .collect();
        assert_eq!(starts.len(), 2, "{svg}");
        assert!(starts.iter().all(|start| *start > lowest), "{starts:?} {lowest}");
    }

    #[test]
    fn surfaces_that_end_are_an_error() {
        let mut lens = biconcave();
        lens.faces[0].form = Asphere::conic(3.0, 0.0).into();
        let error = lens_element_drawing(&lens).unwrap_err().to_string();
        assert!(error.starts_with("the lens \"lens 3-4\" cannot be drawn: "), "{error}");
    }
}
