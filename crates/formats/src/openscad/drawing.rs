//! Contents of an imported drawing (SVG, DXF): closed chains and discs, and the omitted entities.

use super::facets::direction;
use super::flat::Leaf;
use rayweave_math::{Affine, Vec3};
use rayweave_polygon::Point;
use std::collections::HashSet;

/// Largest drawing file in bytes.
pub(super) const MAX_DRAWING_BYTES: u64 = 64 << 20;

/// Maximum number of points of a drawing; more take too long.
pub(super) const MAX_POINTS: usize = 1_000_000;

/// Chord tolerance: deviation of chords from their curve, relative to the size of the drawing.
pub(super) const TOLERANCE: f64 = 1e-4;

/// Regions of a drawing, whose union is the result.
#[derive(Debug, Default)]
pub(super) struct Drawing {
    pub leaves: Vec<(Leaf, Affine)>,
    /// True if curves were approximated by chords.
    pub has_chords: bool,
    /// Number of open chains that were closed by a straight line.
    pub closed: usize,
    /// The first omitted entities of each kind: name, reason, and line in the file.
    pub refused: Vec<(String, String, usize)>,
    /// Names and reasons of the listed entities.
    known: HashSet<(String, String)>,
    /// Number of omitted entities that are not listed.
    pub unlisted: usize,
}

/// Maximum number of omitted entities that are listed.
const MAX_LISTED: usize = 100;

impl Drawing {
    /// Omits an entity; its line is only needed if it is the first of its kind.
    pub fn refuse(&mut self, name: &str, why: &str, line: impl FnOnce() -> usize) {
        let name: String = name.chars().take(40).collect();
        if self.refused.len() < MAX_LISTED && self.known.insert((name.clone(), why.to_owned())) {
            self.refused.push((name, why.to_owned(), line()));
        } else {
            self.unlisted += 1;
        }
    }
}

/// The plane map that takes (x, y) to (a x + c y + e, b x + d y + f).
pub(super) fn plane_map([a, b, c, d, e, f]: [f64; 6]) -> Affine {
    let rows = [[a, c, 0.0, e], [b, d, 0.0, f], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];
    Affine::from_rows(&rows).unwrap_or(Affine::IDENTITY)
}

/// A translation in the plane.
pub(super) fn shift([x, y]: Point) -> Affine {
    Affine::translate(Vec3::new(x, y, 0.0))
}

/// Number of chords of an arc of the given angle (degrees) such that they deviate by at most `TOLERANCE` times the radius.
pub(super) fn chords(degrees: f64) -> usize {
    // 1 - cos(step / 2) = TOLERANCE
    let step = 2.0 * libm::acos(1.0 - TOLERANCE).to_degrees();
    (degrees.abs() / step).ceil().clamp(2.0, 1e4) as usize
}

/// Points on an axis-parallel ellipse about the origin with the given half axes, from one angle to another, both included.
pub(super) fn arc(radii: Point, from: f64, to: f64, pieces: usize) -> Vec<Point> {
    let at = |k: usize| {
        let angle = from + (to - from) * k as f64 / pieces as f64;
        let [cos, sin] = direction(angle, 360);
        [radii[0] * cos, radii[1] * sin]
    };
    (0..=pieces).map(at).collect()
}

/// Points of a Bézier curve given by its control points, without the first (P. de Casteljau).
pub(super) fn curve<const N: usize>(control: [Point; N], pieces: usize, points: &mut Vec<Point>) {
    for piece in 1..pieces {
        let t = piece as f64 / pieces as f64;
        let mut p = control;
        for last in (1..N).rev() {
            for k in 0..last {
                p[k] = [0, 1].map(|axis| p[k][axis] + t * (p[k + 1][axis] - p[k][axis]));
            }
        }
        points.push(p[0]);
    }
    points.push(control[N - 1]);
}

/// Number of chords of a Bézier curve for a given chord tolerance: the second derivative is at most n (n - 1) times the
/// largest second difference of the control points, and a chord over a parameter interval `h` deviates by at most `h^2 / 8`
/// of it.
pub(super) fn pieces<const N: usize>(control: &[Point; N], within: f64) -> usize {
    let second =
        |w: &[Point]| libm::hypot(w[0][0] - 2.0 * w[1][0] + w[2][0], w[0][1] - 2.0 * w[1][1] + w[2][1]);
    let bend = control.windows(3).map(second).fold(0.0, f64::max) * ((N - 1) * (N - 2)) as f64;
    libm::sqrt(bend / (8.0 * within)).ceil().clamp(1.0, 1000.0) as usize
}

#[cfg(test)]
mod tests {
    use super::super::arguments::Arguments;
    use super::super::budget::Budget;
    use super::super::dxf::{self, DxfOptions};
    use super::super::facets::Fineness;
    use super::super::flat::Flats;
    use super::super::operation::Operation;
    use super::super::region::{area, boundary};
    use super::super::svg::{self, SvgOptions};
    use super::super::syntax::parse;
    use super::*;
    use rayweave_scene::Source;
    use std::f64::consts::PI;
    use std::sync::Arc;

    /// Area of a drawing.
    fn area_of(drawing: Drawing, facets: bool) -> f64 {
        assert!(drawing.refused.is_empty(), "{:?}", drawing.refused);
        let source = Arc::new(Source::new(None, "group();".to_owned()));
        let tree = parse(&source).expect("a dump");
        let budget = Budget::new(0);
        let arguments = Arguments::new(&source, &tree.nodes[0], &budget);
        let mut flats = Flats::new(facets);
        let all = drawing.leaves.into_iter().map(|(leaf, map)| {
            let leaf = flats.leaf(leaf);
            flats.transformed(map, leaf)
        });
        let all = all.collect();
        let flat = flats.join(Operation::Union, all);
        boundary(&arguments, &flats, flat).expect("a region").iter().map(|contour| area(contour)).sum()
    }

    /// A sweep of 1e60 would be converted to billions of curves.
    #[test]
    fn far_arcs_are_refused_before_they_are_converted() {
        let read = |path: &str, facets: bool| {
            let text = format!(r#"<svg xmlns="http://www.w3.org/2000/svg"><path d="{path}"/></svg>"#);
            let options = SvgOptions { facets, dpi: 72.0, budget: &Budget::new(0) };
            svg::read(&text, options).expect("a drawing")
        };
        let far = [
            "a5 5 0 0 1 1e60 5 Z",
            "a1e60 5 0 0 1 5 5 Z",
            "h1e60 A5 5 0 0 1 5 5 Z",
            "v-1e40 a5 5 0 0 1 5 5 Z",
        ];
        for (path, facets) in far.iter().flat_map(|path| [(path, false), (path, true)]) {
            let drawing = read(&format!("M0 0 h20 v20 {path}"), facets);
            assert!(drawing.leaves.is_empty(), "{path}");
            assert_eq!(drawing.refused[0].1, "its numbers are too large", "{path}");
        }
        let near = read("M0 0 h20 v20 a1e9 1e9 0 0 1 -20 0 Z", false);
        assert!(near.refused.is_empty() && near.leaves.len() == 1);
    }

    fn svg_area(body: &str, facets: bool) -> f64 {
        let head = "xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\"";
        let page = "width=\"100mm\" height=\"100mm\" viewBox=\"0 0 100 100\"";
        let text = format!("<svg {head} {page}>{body}</svg>");
        area_of(
            svg::read(&text, SvgOptions { facets, dpi: 72.0, budget: &Budget::new(0) }).expect("a drawing"),
            facets,
        )
    }

    fn dxf_area(text: &str, layer: &str, facets: bool) -> f64 {
        let source = Arc::new(Source::new(None, "group();".to_owned()));
        let tree = parse(&source).expect("a dump");
        let budget = Budget::new(0);
        let fineness = Fineness::of(&Arguments::new(&source, &tree.nodes[0], &budget)).expect("defaults");
        let options = DxfOptions { facets, fineness, layer, scale: 1.0, budget: &budget };
        area_of(dxf::read(text, &options).expect("a drawing"), facets)
    }

    /// The areas equal those of the exports of OpenSCAD 2021.01.
    #[test]
    fn svg_areas_equal_those_of_openscad() {
        let cases = [
            ("<circle cx=\"50\" cy=\"50\" r=\"20\"/>", 1251.4741),
            ("<ellipse cx=\"50\" cy=\"50\" rx=\"20\" ry=\"10\"/>", 625.739),
            ("<path d=\"M20 30 C 20 60, 60 60, 60 30 z\"/>", 717.003),
            ("<path d=\"M20 30 Q 20 60, 60 60 L 60 30 z\"/>", 999.0),
            ("<rect x=\"5\" y=\"5\" width=\"20\" height=\"10\" rx=\"3\"/>", 192.1311),
            // strokes with square ends and sharp corners
            ("<path d=\"M20 30 L60 30 L60 60\" style=\"fill:red;stroke:black;stroke-width:4\"/>", 296.0),
            ("<polyline points=\"10,10 50,10 50,50\"/>", 81.0),
            ("<line x1=\"10\" y1=\"10\" x2=\"50\" y2=\"10\" stroke-width=\"3\"/>", 129.0),
            (
                "<line x1=\"10\" y1=\"10\" x2=\"50\" y2=\"10\" stroke-width=\"3\" stroke-linecap=\"butt\"/>",
                120.0,
            ),
            ("<path fill=\"none\" stroke=\"black\" d=\"M20 30 L60 30 L60 60 L20 30\"/>", 600.0),
            (
                "<rect width=\"10\" height=\"10\" transform=\"rotate(45) skewX(10) scale(2,1) translate(1 2) matrix(1 0 0 1 2 3)\"/>",
                200.0,
            ),
            // two that overlap, and a self-intersecting path
            ("<rect width=\"6\" height=\"6\"/><rect x=\"3\" y=\"3\" width=\"6\" height=\"6\"/>", 63.0),
            ("<path d=\"M0 9 h2 v1 h-2z M1 9 h1 v1 h-1z\"/>", 1.0),
        ];
        for (body, expected) in cases {
            let found = svg_area(body, true);
            assert!((found / expected - 1.0).abs() < 3e-3, "{body}: {found} instead of {expected}");
        }
    }

    #[test]
    fn svg_by_closed_forms() {
        let cases = [
            ("<circle cx=\"50\" cy=\"50\" r=\"20\"/>", 400.0 * PI),
            ("<g transform=\"scale(2 1)\"><circle r=\"10\"/></g>", 200.0 * PI),
            ("<rect width=\"20\" height=\"10\" ry=\"3\"/>", 200.0 - 9.0 * (4.0 - PI)),
            // a cubic Bezier curve over its chord: 3/20 of the sum of the cross products of its control points
            ("<path d=\"M20 30 C 20 60, 60 60, 60 30 z\"/>", 720.0),
            ("<path d=\"M20 30 A 20 20 0 0 1 60 30 z\"/>", 200.0 * PI),
            (
                "<defs><rect id=\"q\" width=\"5\" height=\"4\"/></defs><use xlink:href=\"#q\"/><use href=\"#q\" x=\"30\"/>",
                40.0,
            ),
            ("<symbol id=\"q\"><rect width=\"5\" height=\"4\"/></symbol><use href=\"#q\"/>", 20.0),
            ("<rect width=\"5\" height=\"4\"/><rect width=\"50\" height=\"4\" display=\"none\"/>", 20.0),
            (
                "<rect width=\"5\" height=\"4\"/><g style=\"display: none\"><rect width=\"50\" height=\"4\"/></g>",
                20.0,
            ),
        ];
        for (body, expected) in cases {
            let found = svg_area(body, false);
            assert!((found / expected - 1.0).abs() < 1e-3, "{body}: {found} instead of {expected}");
        }
    }

    /// A DXF entity as pairs of group codes and values.
    fn entity(name: &str, pairs: &[(u16, &str)]) -> String {
        let pairs: String = pairs.iter().map(|(code, value)| format!("{code}\n{value}\n")).collect();
        format!("0\n{name}\n{pairs}")
    }

    fn line(a: [i32; 2], b: [i32; 2]) -> String {
        format!("0\nLINE\n8\n0\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n", a[0], a[1], b[0], b[1])
    }

    fn square() -> String {
        [line([0, 0], [10, 0]), line([10, 0], [10, 10]), line([0, 10], [10, 10]), line([0, 10], [0, 0])]
            .concat()
    }

    fn dxf(entities: &str, blocks: &str) -> String {
        format!(
            "0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"
        )
    }

    #[test]
    fn dxf_files() {
        let circle = |layer| entity("CIRCLE", &[(8, layer), (10, "5"), (20, "6"), (40, "4")]);
        let half = [
            entity("ARC", &[(10, "0"), (20, "0"), (40, "4"), (50, "0"), (51, "180")]),
            line([-4, 0], [4, 0]),
        ]
        .concat();
        let full =
            entity("ELLIPSE", &[(11, "4"), (21, "0"), (40, "0.5"), (41, "0"), (42, "6.283185307179586")]);
        let block = |inner: &str| {
            format!("{}{inner}{}", entity("BLOCK", &[(2, "B"), (10, "0"), (20, "0")]), entity("ENDBLK", &[]))
        };
        let insert = entity("INSERT", &[(2, "B"), (10, "100"), (20, "50"), (41, "2"), (42, "3"), (50, "90")]);
        let light = |bulge: &[(u16, &'static str)]| {
            let head = [(90, "4"), (70, "1"), (10, "0"), (20, "0"), (10, "10"), (20, "0")];
            entity(
                "LWPOLYLINE",
                &[&head[..], bulge, &[(10, "10"), (20, "10"), (10, "0"), (20, "10")]].concat(),
            )
        };
        let old =
            [("0", "0"), ("6", "0"), ("6", "5")].map(|(x, y)| entity("VERTEX", &[(10, x), (20, y)])).concat();
        let old = [entity("POLYLINE", &[(66, "1"), (70, "1")]), old, entity("SEQEND", &[])].concat();
        let knots = ["0", "0", "0", "0", "1", "1", "1", "1"].map(|knot| (40, knot));
        let control =
            [("0", "0"), ("0", "5"), ("5", "5"), ("5", "0")].map(|(x, y)| [(10, x), (20, y)]).concat();
        let spline =
            [entity("SPLINE", &[&[(71, "3")], &knots[..], &control].concat()), line([0, 0], [5, 0])].concat();
        // entities, blocks, the area in closed form, and the area in OpenSCAD 2021.01
        let cases = [
            (square(), String::new(), 100.0, Some(100.0)),
            (circle("0"), String::new(), 16.0 * PI, Some(48.332566)),
            (half, String::new(), 8.0 * PI, Some(24.294113)),
            (full, String::new(), 8.0 * PI, Some(24.298963)),
            (light(&[]), String::new(), 100.0, Some(100.0)),
            (light(&[(42, "1")]), String::new(), 100.0 + 12.5 * PI, None),
            (light(&[(42, "-0.4142135623730951")]), String::new(), 100.0 - 25.0 * (0.5 * PI - 1.0), None),
            (old, String::new(), 15.0, None),
            ([square(), circle("0")].concat(), String::new(), 100.0 - 16.0 * PI, None),
            (insert, block(&square()), 600.0, Some(600.0)),
            (spline, String::new(), 15.0, None),
        ];
        for (entities, blocks, exact, openscad) in cases {
            let text = dxf(&entities, &blocks);
            let found = dxf_area(&text, "", false);
            assert!((found / exact - 1.0).abs() < 1e-3, "{entities}: {found} instead of {exact}");
            if let Some(expected) = openscad {
                let found = dxf_area(&text, "", true);
                assert!((found / expected - 1.0).abs() < 3e-4, "{entities}: {found} instead of {expected}");
            }
        }
        let layers = dxf(&[square(), circle("bar")].concat(), "");
        assert!((dxf_area(&layers, "bar", true) / 48.332639 - 1.0).abs() < 1e-4);
    }
}
