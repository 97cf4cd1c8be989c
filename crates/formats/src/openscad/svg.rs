//! SVG drawings with the semantics of OpenSCAD's import: the interiors of closed shapes, painted or not, and the strokes of
//! open ones.
//!
//! *Source*: W3C, *Scalable Vector Graphics (SVG) 1.1*, chapters 7 to 9. The position of the page and the number of chords
//! with facets are those of OpenSCAD 2021.01. As in SVG, but not in OpenSCAD, hidden elements (`display`, `visibility`) and
//! definitions are skipped, and `use` is followed.

use super::budget::{Budget, Exceeded};
use super::drawing::{Drawing, MAX_POINTS, TOLERANCE, arc, chords, curve, pieces, plane_map};
use super::flat::Leaf;
use super::region::{Contours, count_near, filled_near, is_near};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::mesh::float::stroke::offset::StrokeOffset;
use i_overlay::mesh::float::style::{LineCap, LineJoin, StrokeStyle};
use rayweave_math::Affine;
use rayweave_polygon::Point;
use roxmltree::{Document, Node, ParsingOptions};
use std::collections::HashMap;
use std::str::FromStr;
use svgtypes::{
    Align, AspectRatio, Length, LengthUnit, PathParser, PathSegment, PointsParser, SimplePathSegment,
    SimplifyingPathParser,
};
use svgtypes::{Transform, ViewBox};

/// Largest coordinate and stroke width that are drawn.
const FARTHEST: f64 = 1e100;
/// Largest number of a path with elliptical arcs. The parser of paths converts an arc of radius r, in pixels, to as many curves as the
/// sixth root of 11 r at least, which is 500 for this radius, but more than fit into memory for 1e60. Ends further apart than the
/// diameter enlarge the radius, therefore all numbers are limited.
const FARTHEST_OF_ARCS: f64 = 1e15;
/// Maximal nesting depth of elements, counting each `use`.
const DEEPEST: usize = 100;
/// Maximum number of elements, counting each `use`.
const MAX_ELEMENTS: usize = 200_000;
/// Maximum length of expanded entities, in bytes.
const MAX_EXPANDED: usize = 64 << 20;
/// Maximum number of entities within one, which the XML parser allows.
const MAX_NESTED: usize = 255;
/// Number of chords with facets: of a full ellipse, and of a curve.
const FACETS: (usize, usize) = (40, 20);

/// Options for reading an SVG drawing.
#[derive(Clone, Copy, Debug)]
pub(super) struct SvgOptions<'a> {
    /// Curves with the number of chords of OpenSCAD.
    pub facets: bool,
    /// Pixels per inch, positive.
    pub dpi: f64,
    pub budget: &'a Budget,
}

/// An element to be read, with its inherited properties.
struct Task<'a, 'input> {
    node: Node<'a, 'input>,
    map: Affine,
    style: Style,
    depth: usize,
}

/// Inherited properties.
#[derive(Clone, Copy, Debug)]
struct Style {
    width: f64,
    cap: Cap,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Cap {
    Butt,
    Round,
    Square,
}

struct Reader<'a, 'input> {
    document: &'a Document<'input>,
    named: HashMap<&'a str, Node<'a, 'input>>,
    options: SvgOptions<'a>,
    /// Chord tolerance in units of the drawing.
    within: f64,
    points: usize,
    drawing: Drawing,
}

/// Reads an SVG text; an error holds the problem and its line.
pub(super) fn read(text: &str, options: SvgOptions<'_>) -> Result<Drawing, String> {
    let limits = ParsingOptions { allow_dtd: true, nodes_limit: 4_000_000, entity_resolver: None };
    check_depth(text)?;
    check_entities(text)?;
    let document =
        Document::parse_with_options(text, limits).map_err(|error| format!("it is not SVG: {error}"))?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return Err(format!("it is not SVG: its outermost element is `{}`", root.tag_name().name()));
    }
    let (page, size) = page(root, options.dpi);
    let within = TOLERANCE * size;
    let named = document.descendants().filter_map(|node| Some((node.attribute("id")?, node))).collect();
    let mut reader =
        Reader { document: &document, named, options, within, points: 0, drawing: Drawing::default() };
    reader.elements(root, page)?;
    Ok(reader.drawing)
}

/// Refuses entities that may expand to more than [`MAX_EXPANDED`] bytes: the XML parser stores the expanded text of each use.
fn check_entities(text: &str) -> Result<(), String> {
    let Some(start) = text.find("<!ENTITY") else { return Ok(()) };
    let end = text.rfind("<!ENTITY").unwrap_or(start);
    let (declared, rest) = text.split_at(end + text[end..].find('>').unwrap_or(text.len() - end));
    let declared = &declared[start..];
    // the parser limits the uses within one
    let nested = if declared.contains('&') { MAX_NESTED } else { 1 };
    let uses = rest.bytes().filter(|&byte| byte == b'&').count() + 1;
    match uses.saturating_mul(declared.len()).saturating_mul(nested) > MAX_EXPANDED {
        true => Err(format!("its entities may expand to more than {} MiB", MAX_EXPANDED >> 20)),
        false => Ok(()),
    }
}

/// Refuses nesting (opening minus closing tags) that would overflow the call stack of the XML parser.
fn check_depth(text: &str) -> Result<(), String> {
    let (mut depth, bytes) = (0usize, text.as_bytes());
    // an opening tag whose end has not been found
    let mut is_open = false;
    for (k, mark) in text.match_indices(['<', '>']) {
        match (mark, bytes.get(k + 1)) {
            (">", _) => {
                depth -= usize::from(is_open && bytes[k - 1] == b'/');
                is_open = false;
            }
            (_, Some(b'/')) => (depth, is_open) = (depth.saturating_sub(1), false),
            (_, Some(b'!' | b'?')) => is_open = false,
            _ => {
                is_open = true;
                depth += 1;
            }
        }
        if depth > 10 * DEEPEST {
            return Err(format!("its elements are nested more than {} deep", 10 * DEEPEST));
        }
    }
    Ok(())
}

/// A length in millimetres.
fn millimetres(length: Length, dpi: f64) -> Option<f64> {
    let factor = match length.unit {
        LengthUnit::None => 25.4 / dpi,
        // of CSS: OpenSCAD's `dpi` is for lengths without a unit
        LengthUnit::Px => 25.4 / 96.0,
        LengthUnit::In => 25.4,
        LengthUnit::Cm => 10.0,
        LengthUnit::Mm => 1.0,
        LengthUnit::Pt => 25.4 / 72.0,
        LengthUnit::Pc => 25.4 / 6.0,
        LengthUnit::Em | LengthUnit::Ex | LengthUnit::Percent => return None,
    };
    Some(factor * length.number).filter(|length| length.is_finite() && *length > 0.0)
}

/// Map from the drawing to the plane, with y upward, and the larger side of the page in units of the drawing.
fn page(root: Node, dpi: f64) -> (Affine, f64) {
    let given = |name| root.attribute(name).and_then(|text| Length::from_str(text).ok());
    let length = |name| given(name).and_then(|length| millimetres(length, dpi));
    let (width, height) = (length("width"), length("height"));
    let Some(view) = root.attribute("viewBox").and_then(|text| ViewBox::from_str(text).ok()) else {
        // without a view box, the unit is a millimetre; the height of the page still applies
        let top = height.unwrap_or(0.0);
        return (plane_map([1.0, 0.0, 0.0, -1.0, 0.0, top]), width.unwrap_or(100.0).max(top));
    };
    let pixel = 25.4 / dpi;
    let (width, height) = (width.unwrap_or(view.w * pixel), height.unwrap_or(view.h * pixel));
    let ratio = root.attribute("preserveAspectRatio").and_then(|text| AspectRatio::from_str(text).ok());
    let (align, slice) = ratio.map_or((Align::XMidYMid, false), |ratio| (ratio.align, ratio.slice));
    let own = [width / view.w, height / view.h];
    let even = if slice { own[0].max(own[1]) } else { own[0].min(own[1]) };
    let scale = if align == Align::None { own } else { [even; 2] };
    let (x, y) = shares(align);
    let left = x * (width - scale[0] * view.w);
    let above = y * (height - scale[1] * view.h);
    // the sign of the view box's y is inverted, as in OpenSCAD
    let map = [scale[0], 0.0, 0.0, -scale[1], left - scale[0] * view.x, height - above - scale[1] * view.y];
    (plane_map(map), view.w.max(view.h))
}

/// Shares of the unused space on the left and above.
fn shares(align: Align) -> (f64, f64) {
    match align {
        Align::None | Align::XMinYMin => (0.0, 0.0),
        Align::XMidYMin => (0.5, 0.0),
        Align::XMaxYMin => (1.0, 0.0),
        Align::XMinYMid => (0.0, 0.5),
        Align::XMidYMid => (0.5, 0.5),
        Align::XMaxYMid => (1.0, 0.5),
        Align::XMinYMax => (0.0, 1.0),
        Align::XMidYMax => (0.5, 1.0),
        Align::XMaxYMax => (1.0, 1.0),
    }
}

/// Value of a property from `style`, else from the attribute of the same name.
fn property<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    let of_style = node.attribute("style").into_iter().flat_map(|style| style.split(';'));
    let mut pairs = of_style.filter_map(|pair| pair.split_once(':'));
    let found = pairs.find(|(key, _)| key.trim() == name).map(|(_, value)| value.trim());
    found.or_else(|| node.attribute(name))
}

fn number(node: Node, name: &str) -> f64 {
    let length = node.attribute(name).and_then(|text| Length::from_str(text.trim()).ok());
    length.map_or(0.0, |length| length.number)
}

impl<'a, 'input> Reader<'a, 'input> {
    fn elements(&mut self, root: Node<'a, 'input>, map: Affine) -> Result<(), String> {
        let style = Style { width: 1.0, cap: Cap::Square };
        let mut waiting = vec![Task { node: root, map, style, depth: 0 }];
        let mut count = 0;
        while let Some(task) = waiting.pop() {
            count += 1;
            if count > MAX_ELEMENTS || task.depth > DEEPEST {
                return Err(format!(
                    "it has more than {MAX_ELEMENTS} elements, or they are nested more than {DEEPEST} deep"
                ));
            }
            self.element(task, &mut waiting)?;
        }
        Ok(())
    }

    fn element(&mut self, task: Task<'a, 'input>, waiting: &mut Vec<Task<'a, 'input>>) -> Result<(), String> {
        let Task { node, mut map, style, depth } = task;
        // an element that is used repeatedly is read repeatedly
        let length: usize = node.attributes().map(|attribute| attribute.value().len()).sum();
        self.options.budget.spend(1000 + 50 * length)?;
        if !node.is_element()
            || property(node, "display") == Some("none")
            || property(node, "visibility") == Some("hidden")
        {
            return Ok(());
        }
        let style = style.of(node);
        if let Some(transform) = node.attribute("transform") {
            match Transform::from_str(transform) {
                Ok(Transform { a, b, c, d, e, f }) => map = plane_map([a, b, c, d, e, f]).then(&map),
                Err(error) => return self.refuse(node, &format!("its transform cannot be read: {error}")),
            }
        }
        match node.tag_name().name() {
            "svg" if depth > 0 => self.refuse(node, "drawings within drawings cannot be read"),
            "svg" | "g" | "a" | "switch" => {
                waiting.extend(node.children().rev().map(|node| Task { node, map, style, depth: depth + 1 }));
                Ok(())
            }
            "use" => self.follow(Task { node, map, style, depth }, waiting),
            "circle" | "ellipse" => self.ellipse(node, &map),
            "rect" => self.rectangle(node, &map),
            "line" => {
                let ends = [("x1", "y1"), ("x2", "y2")].map(|(x, y)| [number(node, x), number(node, y)]);
                self.chains(node, vec![(ends.to_vec(), false)], &map, style)
            }
            "polyline" | "polygon" => {
                let points = node.attribute("points").unwrap_or_default();
                let points = PointsParser::from(points).map(|(x, y)| [x, y]).collect();
                self.chains(node, vec![(points, node.tag_name().name() == "polygon")], &map, style)
            }
            "path" => self.path(node, &map, style),
            "text" | "image" | "foreignObject" => self.refuse(node, "only shapes are read"),
            // definitions, metadata, elements that are not drawn
            _ => Ok(()),
        }
    }

    fn refuse(&mut self, node: Node, why: &str) -> Result<(), String> {
        let line = || self.document.text_pos_at(node.range().start).row as usize;
        self.drawing.refuse(node.tag_name().name(), why, line);
        Ok(())
    }

    /// Adds the element that a `use` refers to, translated.
    fn follow(&mut self, task: Task<'a, 'input>, waiting: &mut Vec<Task<'a, 'input>>) -> Result<(), String> {
        let Task { node, map, style, depth } = task;
        let name =
            node.attributes().find(|attribute| attribute.name() == "href").map(|attribute| attribute.value());
        let id = name.and_then(|name| name.strip_prefix('#')).unwrap_or_default();
        let Some(found) = self.named.get(id).copied() else {
            return self.refuse(node, "the element that it refers to does not exist");
        };
        let map = plane_map([1.0, 0.0, 0.0, 1.0, number(node, "x"), number(node, "y")]).then(&map);
        if found.tag_name().name() == "symbol" {
            waiting.extend(found.children().rev().map(|node| Task { node, map, style, depth: depth + 1 }));
        } else {
            waiting.push(Task { node: found, map, style, depth: depth + 1 });
        }
        Ok(())
    }

    fn push(&mut self, contours: Contours, map: &Affine) -> Result<(), String> {
        self.points += contours.iter().map(Vec::len).sum::<usize>();
        if self.points > MAX_POINTS {
            return Err(format!("it has more than {MAX_POINTS} points"));
        }
        if contours.iter().any(|contour| contour.len() >= 3) {
            self.drawing.leaves.push((Leaf::Outline(contours), *map));
        }
        Ok(())
    }

    fn ellipse(&mut self, node: Node, map: &Affine) -> Result<(), String> {
        let radii = match node.tag_name().name() {
            "circle" => [number(node, "r"); 2],
            _ => [number(node, "rx"), number(node, "ry")],
        };
        if radii[0] <= 0.0 || radii[1] <= 0.0 {
            return Ok(());
        }
        let own = plane_map([radii[0], 0.0, 0.0, radii[1], number(node, "cx"), number(node, "cy")]).then(map);
        let disc = Leaf::Disc { radius: 1.0, fragments: FACETS.0 };
        if self.options.facets {
            return self.push(disc.contours(), &own);
        }
        self.drawing.leaves.push((disc, own));
        Ok(())
    }

    fn rectangle(&mut self, node: Node, map: &Affine) -> Result<(), String> {
        let [x, y, w, h] = ["x", "y", "width", "height"].map(|name| number(node, name));
        if w <= 0.0 || h <= 0.0 {
            return Ok(());
        }
        let given = ["rx", "ry"].map(|name| node.attribute(name).map(|_| number(node, name)));
        let rx = given[0].or(given[1]).unwrap_or(0.0).clamp(0.0, 0.5 * w);
        let ry = given[1].or(given[0]).unwrap_or(0.0).clamp(0.0, 0.5 * h);
        if rx == 0.0 || ry == 0.0 {
            return self.push(vec![vec![[x, y], [x + w, y], [x + w, y + h], [x, y + h]]], map);
        }
        let pieces = if self.options.facets { FACETS.0 / 4 } else { chords(90.0) };
        self.drawing.has_chords |= !self.options.facets;
        let centres =
            [[x + w - rx, y + h - ry], [x + rx, y + h - ry], [x + rx, y + ry], [x + w - rx, y + ry]];
        let corner = |(k, c): (usize, &Point)| {
            let points = arc([rx, ry], 90.0 * k as f64, 90.0 * (k + 1) as f64, pieces);
            points.into_iter().map(|p| [c[0] + p[0], c[1] + p[1]]).collect::<Vec<_>>()
        };
        self.push(vec![centres.iter().enumerate().flat_map(corner).collect()], map)
    }

    fn path(&mut self, node: Node, map: &Affine, style: Style) -> Result<(), String> {
        if has_far_arcs(node.attribute("d").unwrap_or_default()) {
            return self.refuse(node, "its numbers are too large");
        }
        let mut chains: Vec<(Vec<Point>, bool)> = Vec::new();
        for segment in SimplifyingPathParser::from(node.attribute("d").unwrap_or_default()) {
            // SVG error handling: a path is drawn up to its first error
            let Ok(segment) = segment else {
                self.refuse(node, "a part of its path cannot be read")?;
                break;
            };
            self.segment(segment, &mut chains)?;
        }
        self.chains(node, chains, map, style)
    }

    fn segment(
        &mut self,
        segment: SimplePathSegment,
        chains: &mut Vec<(Vec<Point>, bool)>,
    ) -> Result<(), String> {
        if let SimplePathSegment::MoveTo { x, y } = segment {
            chains.push((vec![[x, y]], false));
            return Ok(());
        }
        let Some((chain, is_closed)) = chains.last_mut() else { return Ok(()) };
        let Some(&start) = chain.last() else { return Ok(()) };
        let before = chain.len();
        match segment {
            SimplePathSegment::MoveTo { .. } => {}
            SimplePathSegment::LineTo { x, y } => chain.push([x, y]),
            SimplePathSegment::CurveTo { x1, y1, x2, y2, x, y } => {
                let control = [start, [x1, y1], [x2, y2], [x, y]];
                curve(control, self.options.pieces(&control, self.within), chain);
            }
            SimplePathSegment::Quadratic { x1, y1, x, y } => {
                let control = [start, [x1, y1], [x, y]];
                curve(control, self.options.pieces(&control, self.within), chain);
            }
            SimplePathSegment::ClosePath => *is_closed = true,
        }
        self.drawing.has_chords |= chain.len() > before + 1 && !self.options.facets;
        self.points += chain.len() - before;
        match self.points > MAX_POINTS {
            true => Err(format!("it has more than {MAX_POINTS} points")),
            false => Ok(()),
        }
    }

    /// Closed chains as one region, and the strokes of open ones.
    fn chains(
        &mut self,
        node: Node,
        chains: Vec<(Vec<Point>, bool)>,
        map: &Affine,
        style: Style,
    ) -> Result<(), String> {
        let is_finite = |(chain, _): &(Vec<Point>, bool)| is_near(std::slice::from_ref(chain));
        if !chains.iter().all(is_finite) {
            return self.refuse(node, "its numbers are too large");
        }
        let (mut closed, mut strokes) = (Contours::new(), Contours::new());
        for (chain, is_closed) in chains {
            match is_closed || (chain.len() > 2 && chain.first() == chain.last()) {
                true => closed.push(chain),
                false if chain.len() > 1 => strokes.extend(style.stroke(self.options.budget, chain)?),
                false => {}
            }
        }
        let budget = self.options.budget;
        self.push(filled_near(budget, &closed, FillRule::EvenOdd)?, map)?;
        self.push(filled_near(budget, &strokes, FillRule::NonZero)?, map)
    }
}

/// True if a path has an elliptical arc and a number beyond [`FARTHEST_OF_ARCS`].
fn has_far_arcs(path: &str) -> bool {
    let (mut has_arcs, mut farthest) = (false, 0.0_f64);
    for segment in PathParser::from(path).map_while(Result::ok) {
        let numbers = match segment {
            PathSegment::MoveTo { x, y, .. }
            | PathSegment::LineTo { x, y, .. }
            | PathSegment::SmoothQuadratic { x, y, .. } => [x, y, 0.0, 0.0, 0.0, 0.0],
            PathSegment::HorizontalLineTo { x, .. } => [x, 0.0, 0.0, 0.0, 0.0, 0.0],
            PathSegment::VerticalLineTo { y, .. } => [0.0, y, 0.0, 0.0, 0.0, 0.0],
            PathSegment::CurveTo { x1, y1, x2, y2, x, y, .. } => [x1, y1, x2, y2, x, y],
            PathSegment::SmoothCurveTo { x2, y2, x, y, .. } => [x2, y2, x, y, 0.0, 0.0],
            PathSegment::Quadratic { x1, y1, x, y, .. } => [x1, y1, x, y, 0.0, 0.0],
            PathSegment::EllipticalArc { rx, ry, x, y, .. } => {
                has_arcs = true;
                [rx, ry, x, y, 0.0, 0.0]
            }
            PathSegment::ClosePath { .. } => [0.0; 6],
        };
        farthest = numbers.iter().fold(farthest, |most, number| most.max(number.abs()));
    }
    has_arcs && farthest > FARTHEST_OF_ARCS
}

impl SvgOptions<'_> {
    fn pieces<const N: usize>(&self, control: &[Point; N], within: f64) -> usize {
        if self.facets { FACETS.1 } else { pieces(control, within) }
    }
}

impl Style {
    fn of(self, node: Node) -> Style {
        let width = property(node, "stroke-width").and_then(|text| Length::from_str(text).ok());
        let cap = match property(node, "stroke-linecap") {
            Some("butt") => Cap::Butt,
            Some("round") => Cap::Round,
            Some("square") => Cap::Square,
            _ => self.cap,
        };
        Style { width: width.map_or(self.width, |width| width.number), cap }
    }

    /// The stroke of an open chain; empty if it is beyond the range of `i_overlay`.
    fn stroke(&self, budget: &Budget, chain: Vec<Point>) -> Result<Contours, Exceeded> {
        // the library panics if it cannot scale the coordinates to integers
        let is_far = |length: &f64| length.is_nan() || length.abs() > FARTHEST;
        if self.width <= 0.0 || is_far(&self.width) || chain.iter().flatten().any(is_far) {
            return Ok(Contours::new());
        }
        count_near(budget, &chain, self.width)?;
        let cap = match self.cap {
            Cap::Butt => LineCap::Butt,
            Cap::Round => LineCap::Round(0.1),
            Cap::Square => LineCap::Square,
        };
        let style =
            StrokeStyle::new(self.width).line_join(LineJoin::Miter(0.0)).start_cap(cap.clone()).end_cap(cap);
        Ok(vec![chain].stroke_as::<i64>(style, false).into_iter().flatten().collect())
    }
}
