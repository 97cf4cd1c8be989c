//! Closed curves of SVG files: paths, rectangles, circles and polygons. Lines and circular arcs are exact; Bézier curves become chords.

use super::curve::{CHORD, Contours, size, vertex};
use rayweave_polygon::Vertex;
use roxmltree::{Document, Node};
use std::str::FromStr;
use svgtypes::{PathParser, PathSegment, PointsParser, Transform};

/// Elements whose contents are not drawn in place.
const SKIPPED: [&str; 11] =
    ["defs", "symbol", "clipPath", "mask", "pattern", "marker", "metadata", "title", "desc", "style", "text"];

/// A curve of a path, in the coordinates of the file.
enum Curve {
    Line([f64; 2]),
    /// The end and the bulge.
    Arc([f64; 2], f64),
    Cubic([[f64; 2]; 3]),
}

/// A closed path: its start and its curves.
struct Closed {
    start: [f64; 2],
    curves: Vec<Curve>,
}

pub(super) fn read(text: &str) -> Result<Contours, String> {
    let document = Document::parse(text).map_err(|error| format!("it is not an SVG file: {error}"))?;
    let mut paths = Vec::new();
    let mut waiting = vec![(document.root_element(), Transform::default())];
    while let Some((node, outer)) = waiting.pop() {
        let map = match node.attribute("transform") {
            Some(text) => {
                let own =
                    Transform::from_str(text).map_err(|error| format!("a transform is invalid: {error}"))?;
                product(&outer, &own)
            }
            None => outer,
        };
        if SKIPPED.contains(&node.tag_name().name()) {
            continue;
        }
        for path in shapes(node)? {
            paths.push(mapped(path, &map)?);
        }
        let children: Vec<Node> = node.children().filter(Node::is_element).collect();
        waiting.extend(children.into_iter().rev().map(|child| (child, map)));
    }
    let points = paths.iter().flat_map(|path| path.curves.iter().map(end).chain([path.start]));
    let tolerance = CHORD * size(points);
    Ok(paths.iter().map(|path| contour(path, tolerance)).collect())
}

fn end(curve: &Curve) -> [f64; 2] {
    match curve {
        Curve::Line(to) | Curve::Arc(to, _) | Curve::Cubic([.., to]) => *to,
    }
}

/// The map that applies `b` first.
fn product(a: &Transform, b: &Transform) -> Transform {
    let [p, q, origin] = [[b.a, b.b], [b.c, b.d], [b.e, b.f]];
    let linear = |v: [f64; 2]| [a.a * v[0] + a.c * v[1], a.b * v[0] + a.d * v[1]];
    let ([p, q], o) = ([linear(p), linear(q)], linear(origin));
    Transform { a: p[0], b: p[1], c: q[0], d: q[1], e: o[0] + a.e, f: o[1] + a.f }
}

/// The closed paths of an element.
fn shapes(node: Node) -> Result<Vec<Closed>, String> {
    let length = |name: &str| match node.attribute(name) {
        None => Ok(0.0),
        Some(text) => {
            text.trim().parse::<f64>().map_err(|_| format!("the {name} `{text}` is not a plain number"))
        }
    };
    match node.tag_name().name() {
        "path" => path(node.attribute("d").unwrap_or_default()),
        "polygon" => {
            let points = PointsParser::from(node.attribute("points").unwrap_or_default());
            Ok(polygon(points.map(|(x, y)| [x, y]).collect()))
        }
        "rect" => {
            if node.attribute("rx").is_some() || node.attribute("ry").is_some() {
                return Err("a rectangle has rounded corners: draw it as a path".to_owned());
            }
            let [x, y, w, h] = ["x", "y", "width", "height"].map(length);
            let (x, y, w, h) = (x?, y?, w?, h?);
            Ok(polygon(vec![[x, y], [x + w, y], [x + w, y + h], [x, y + h]]))
        }
        "circle" => {
            let (x, y, r) = (length("cx")?, length("cy")?, length("r")?);
            let curves = vec![Curve::Arc([x - r, y], 1.0), Curve::Arc([x + r, y], 1.0)];
            Ok(vec![Closed { start: [x + r, y], curves }])
        }
        kind @ ("ellipse" | "use" | "image") => {
            Err(format!("it has an element {kind}, which is not read: convert it to a path"))
        }
        _ => Ok(Vec::new()),
    }
}

fn polygon(points: Vec<[f64; 2]>) -> Vec<Closed> {
    let Some((first, rest)) = points.split_first() else { return Vec::new() };
    vec![Closed { start: *first, curves: rest.iter().map(|p| Curve::Line(*p)).collect() }]
}

fn path(text: &str) -> Result<Vec<Closed>, String> {
    let mut pen = Pen::default();
    for segment in PathParser::from(text) {
        pen.draw(segment.map_err(|error| format!("a path is invalid: {error}"))?)?;
    }
    Ok(pen.closed.into_iter().filter(|path| !path.curves.is_empty()).collect())
}

/// The state between two segments of a path.
#[derive(Default)]
struct Pen {
    closed: Vec<Closed>,
    /// The current point.
    at: [f64; 2],
    /// The last control point of a cubic and of a quadratic curve, if the last segment was one.
    cubic: Option<[f64; 2]>,
    quadratic: Option<[f64; 2]>,
    is_done: bool,
}

impl Pen {
    fn draw(&mut self, segment: PathSegment) -> Result<(), String> {
        let origin = self.at;
        let place = |abs: bool, x: f64, y: f64| if abs { [x, y] } else { [origin[0] + x, origin[1] + y] };
        let mirrored = |p: Option<[f64; 2]>| p.map_or(origin, |p| [0, 1].map(|k| 2.0 * origin[k] - p[k]));
        let (cubic, quadratic) = (mirrored(self.cubic.take()), mirrored(self.quadratic.take()));
        match segment {
            PathSegment::MoveTo { abs, x, y } => {
                self.at = place(abs, x, y);
                self.is_done = false;
                self.closed.push(Closed { start: self.at, curves: Vec::new() });
            }
            PathSegment::LineTo { abs, x, y } => self.add(Curve::Line(place(abs, x, y))),
            PathSegment::HorizontalLineTo { abs, x } => {
                self.add(Curve::Line([if abs { x } else { origin[0] + x }, origin[1]]));
            }
            PathSegment::VerticalLineTo { abs, y } => {
                self.add(Curve::Line([origin[0], if abs { y } else { origin[1] + y }]));
            }
            PathSegment::CurveTo { abs, x1, y1, x2, y2, x, y } => {
                self.curve([place(abs, x1, y1), place(abs, x2, y2), place(abs, x, y)]);
            }
            PathSegment::SmoothCurveTo { abs, x2, y2, x, y } => {
                self.curve([cubic, place(abs, x2, y2), place(abs, x, y)]);
            }
            PathSegment::Quadratic { abs, x1, y1, x, y } => self.raised(place(abs, x1, y1), place(abs, x, y)),
            PathSegment::SmoothQuadratic { abs, x, y } => self.raised(quadratic, place(abs, x, y)),
            PathSegment::EllipticalArc { abs, rx, ry, large_arc, sweep, x, y, .. } => {
                if rx.abs() != ry.abs() {
                    return Err("a path has an elliptical arc: convert it to Bézier curves".to_owned());
                }
                let to = place(abs, x, y);
                if to != origin {
                    self.add(Curve::Arc(to, bulge(origin, to, rx.abs(), large_arc, sweep)));
                }
            }
            PathSegment::ClosePath { .. } => {
                self.at = self.closed.last().map_or(self.at, |path| path.start);
                self.is_done = true;
            }
        }
        Ok(())
    }

    fn add(&mut self, curve: Curve) {
        if self.is_done {
            // a path continues at the start of the one that was closed
            self.closed.push(Closed { start: self.at, curves: Vec::new() });
            self.is_done = false;
        }
        self.at = end(&curve);
        if let Some(path) = self.closed.last_mut() {
            path.curves.push(curve);
        }
    }

    fn curve(&mut self, points: [[f64; 2]; 3]) {
        self.add(Curve::Cubic(points));
        self.cubic = Some(points[1]);
    }

    /// A quadratic curve as a cubic one.
    fn raised(&mut self, control: [f64; 2], to: [f64; 2]) {
        let third = |p: [f64; 2]| [0, 1].map(|k| p[k] + 2.0 / 3.0 * (control[k] - p[k]));
        self.add(Curve::Cubic([third(self.at), third(to), to]));
        self.quadratic = Some(control);
    }
}

/// The bulge of an arc, positive in the direction of growing angles. A radius that is too small becomes half the chord (SVG, F.6.6).
fn bulge(from: [f64; 2], to: [f64; 2], radius: f64, is_large: bool, is_positive: bool) -> f64 {
    let half = 0.5 * libm::hypot(to[0] - from[0], to[1] - from[1]);
    // the sine of half the angle of the smaller arc; tan(a/4) = sin(a/2) / (1 + cos(a/2))
    let sin = (half / radius).min(1.0);
    let cos = ((1.0 - sin) * (1.0 + sin)).sqrt();
    let size = if is_large { (1.0 + cos) / sin } else { sin / (1.0 + cos) };
    if is_positive { size } else { -size }
}

/// A path after a map, with y upwards.
fn mapped(path: Closed, map: &Transform) -> Result<Closed, String> {
    let point = |p: [f64; 2]| [map.a * p[0] + map.c * p[1] + map.e, -(map.b * p[0] + map.d * p[1] + map.f)];
    let has_arcs = path.curves.iter().any(|curve| matches!(curve, Curve::Arc(..)));
    let near = |x: f64, y: f64| (x - y).abs() <= 1e-9 * (map.a.abs() + map.b.abs());
    let (turns, mirrors) =
        (near(map.a, map.d) && near(map.b, -map.c), near(map.a, -map.d) && near(map.b, map.c));
    if has_arcs && !turns && !mirrors {
        return Err(
            "a circle or arc is stretched by a transform: convert it to a path of Bézier curves".to_owned()
        );
    }
    // y points upwards, which mirrors all arcs
    let sign = if mirrors && !turns { 1.0 } else { -1.0 };
    let curves = path.curves.into_iter().map(|curve| match curve {
        Curve::Line(to) => Curve::Line(point(to)),
        Curve::Arc(to, bulge) => Curve::Arc(point(to), sign * bulge),
        Curve::Cubic(points) => Curve::Cubic(points.map(point)),
    });
    Ok(Closed { start: point(path.start), curves: curves.collect() })
}

fn contour(path: &Closed, tolerance: f64) -> Vec<Vertex> {
    let mut vertices = vec![vertex(path.start, 0.0)];
    let mut from = path.start;
    for curve in &path.curves {
        match curve {
            Curve::Line(_) => {}
            Curve::Arc(_, bulge) => {
                if let Some(last) = vertices.last_mut() {
                    last.bulge = *bulge;
                }
            }
            Curve::Cubic(points) => vertices.extend(chords(from, *points, tolerance)),
        }
        from = end(curve);
        vertices.push(vertex(from, 0.0));
    }
    // the last point closes the contour
    if vertices.len() > 1 && vertices.last().map(|last| last.at) == vertices.first().map(|first| first.at) {
        vertices.pop();
    }
    vertices
}

/// The inner points of chords within a tolerance of a Bézier curve. A chord over a length h of the parameter is at most M h^2 / 8
/// from the curve, where M bounds its second derivative: 6 times the larger second difference of the control points.
fn chords(p: [f64; 2], [a, b, q]: [[f64; 2]; 3], tolerance: f64) -> Vec<Vertex> {
    let second = |u: [f64; 2], v: [f64; 2], w: [f64; 2]| {
        libm::hypot(u[0] - 2.0 * v[0] + w[0], u[1] - 2.0 * v[1] + w[1])
    };
    let bound = 6.0 * second(p, a, b).max(second(a, b, q));
    let count = (bound / (8.0 * tolerance)).sqrt().ceil().clamp(1.0, 10_000.0) as u32;
    let point = |k: u32| {
        let t = f64::from(k) / f64::from(count);
        let s = 1.0 - t;
        let at = [0, 1]
            .map(|k| s * s * s * p[k] + 3.0 * s * s * t * a[k] + 3.0 * s * t * t * b[k] + t * t * t * q[k]);
        vertex(at, 0.0)
    };
    (1..count).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_polygon::Outline;

    fn contours(body: &str) -> Result<Contours, String> {
        read(&format!(r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 9 9">{body}</svg>"#))
    }

    fn area(body: &str) -> f64 {
        Outline::new(&contours(body).unwrap()).unwrap().area()
    }

    #[test]
    fn closed_curves_are_read() {
        let pi = std::f64::consts::PI;
        assert_eq!(area(r#"<rect x="1" y="2" width="4" height="3"/>"#), 12.0);
        assert!(
            (area(r#"<g transform="translate(3 1) scale(2)"><circle cx="1" cy="1" r="1"/></g>"#) - 4.0 * pi)
                .abs()
                < 1e-13
        );
        assert_eq!(area(r#"<polygon points="0,0 4,0 0,3"/>"#), 6.0);
        // a slot with relative commands, and a hole
        let slot = r#"<path d="M1 0h4a1 1 0 0 1 0 2h-4a1 1 0 0 1 0 -2zm1 .5v1h1v-1z"/>"#;
        assert!((area(slot) - (8.0 + pi - 1.0)).abs() < 1e-13);
        // the larger arc
        let most = area(r#"<path d="M0 0 A1 1 0 1 1 0 1.4142135623730951z"/>"#);
        assert!((most - (0.75 * pi + 0.5)).abs() < 1e-12, "{most}");
        // y points upwards: the tip of the triangle is at the bottom
        let points = contours(r#"<path d="M0 0L2 0L1 3z"/>"#).unwrap();
        assert_eq!(points[0].iter().map(|v| v.at).collect::<Vec<_>>(), [[0.0, 0.0], [2.0, 0.0], [1.0, -3.0]]);
    }

    /// The area below the cubic curve is the integral of 12 t (1 - t) over x = 18 t^2 - 12 t^3: 432/30.
    #[test]
    fn curves_become_chords() {
        let found = area(r#"<path d="M0 0C0 4 6 4 6 0z"/>"#);
        assert!((found - 14.4).abs() < 9.0 * 6e-5, "{found}");
        assert!((area(r#"<path d="M0 0Q3 6 6 0z"/>"#) - 12.0).abs() < 6.0 * 6e-5);
        assert!((area(r#"<path d="M0 0Q1 2 2 0T4 0V-2H0z"/>"#) - 8.0).abs() < 1e-3);
    }

    #[test]
    fn problems_are_reported() {
        let fails = |body: &str| contours(body).unwrap_err();
        assert!(fails(r#"<ellipse rx="1" ry="2"/>"#).contains("an element ellipse"));
        assert!(fails(r#"<path d="M0 0A1 2 0 0 1 2 0z"/>"#).contains("elliptical arc"));
        assert!(fails(r#"<circle r="1" transform="scale(1 2)"/>"#).contains("stretched"));
        assert!(fails(r#"<circle r="1cm"/>"#).contains("not a plain number"));
        assert!(read("nothing").unwrap_err().contains("not an SVG file"));
    }
}
