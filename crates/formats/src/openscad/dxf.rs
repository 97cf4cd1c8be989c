//! DXF drawings with the semantics of OpenSCAD's import: closed chains of lines and arcs, circles and ellipses, filled by
//! the even-odd rule. Arcs within polylines (bulges) and splines are read as well; OpenSCAD 2021.01 omits them.
//!
//! *Source*: Autodesk, *DXF Reference*, chapters "ENTITIES section", "BLOCKS section". A file is a sequence of pairs of a
//! group code and a value, each on its own line.

use super::budget::Budget;
use super::drawing::{Drawing, MAX_POINTS, arc, chords, plane_map, shift};
use super::facets::Fineness;
use super::flat::{Leaf, image};
use rayweave_math::{Affine, Vec3};
use rayweave_polygon::Point;
use std::collections::HashMap;

/// Distance below which two line ends are the same point: 2^-10, as in OpenSCAD.
const NEAR: f64 = 1.0 / 1024.0;
/// Maximal nesting depth of blocks.
const DEEPEST: usize = 20;
/// Maximum number of block insertions, counting repetitions.
const MAX_USES: usize = 100_000;
/// Chords of a spline per knot interval.
const SPLINE_PIECES: usize = 128;

/// Options for reading a DXF drawing.
#[derive(Clone, Copy, Debug)]
pub(super) struct DxfOptions<'a> {
    /// Round shapes with the number of facets of OpenSCAD.
    pub facets: bool,
    pub fineness: Fineness,
    /// Name of the layer to read; all layers if it is empty.
    pub layer: &'a str,
    /// Factor by which the drawing is scaled afterwards, positive. In OpenSCAD, the scaled radius of round shapes outside of
    /// blocks determines their number of facets.
    pub scale: f64,
    pub budget: &'a Budget,
}

/// An entity: name, line in the file, and pairs.
#[derive(Debug)]
struct Entity<'a> {
    name: &'a str,
    line: usize,
    pairs: Vec<(u16, &'a str)>,
}

impl Entity<'_> {
    fn text(&self, code: u16) -> &str {
        self.pairs.iter().find(|pair| pair.0 == code).map_or("", |pair| pair.1)
    }

    /// All values with a group code as numbers; those that are not finite count as 0.
    fn numbers(&self, code: u16) -> impl Iterator<Item = f64> {
        self.pairs.iter().filter(move |pair| pair.0 == code).map(|pair| parsed(pair.1))
    }

    fn number(&self, code: u16, default: f64) -> f64 {
        self.numbers(code).next().unwrap_or(default)
    }

    fn point(&self, code: u16) -> Point {
        [self.number(code, 0.0), self.number(code + 10, 0.0)]
    }
}

fn parsed(text: &str) -> f64 {
    text.parse().ok().filter(|number: &f64| number.abs() < 1e100).unwrap_or(0.0)
}

/// The pairs of a file, with the line number of each group code.
fn pairs(text: &str) -> Result<Vec<(u16, &str, usize)>, String> {
    let mut lines = text.trim_start_matches('\u{feff}').lines().map(str::trim).enumerate();
    let mut all = Vec::new();
    while let Some((number, code)) = lines.next() {
        if code.is_empty() && all.last().is_some_and(|(_, value, _)| *value == "EOF") {
            break;
        }
        let code = code.parse().map_err(|_| format!("line {} of it is not a DXF group code", number + 1))?;
        let Some((_, value)) = lines.next() else {
            return Err(format!("it ends after the code in line {}", number + 1));
        };
        all.push((code, value, number + 1));
    }
    match all.last() {
        Some((0, "EOF", _)) => Ok(all),
        _ => Err("it has no EOF at its end: it is incomplete".to_owned()),
    }
}

/// Entities outside of blocks, and those of each block with its base point.
struct Content<'a> {
    entities: Vec<Entity<'a>>,
    blocks: HashMap<&'a str, (Point, Vec<Entity<'a>>)>,
}

fn content(text: &str) -> Result<Content<'_>, String> {
    let mut content = Content { entities: Vec::new(), blocks: HashMap::new() };
    let mut all: Vec<Entity> = Vec::new();
    for (code, value, line) in pairs(text)? {
        match (code, all.last_mut()) {
            (0, _) => all.push(Entity { name: value, line, pairs: Vec::new() }),
            (_, Some(entity)) => entity.pairs.push((code, value)),
            // comments may precede the first section
            _ => {}
        }
    }
    let (mut section, mut block): (&str, Option<&str>) = ("", None);
    for entity in all {
        match (entity.name, section) {
            ("SECTION", _) => section = entity.pairs.first().map_or("", |pair| pair.1),
            ("ENDSEC", _) => section = "",
            ("BLOCK", "BLOCKS") => {
                let name = entity.pairs.iter().find(|pair| pair.0 == 2).map_or("", |pair| pair.1);
                content.blocks.insert(name, (entity.point(10), Vec::new()));
                block = Some(name);
            }
            ("ENDBLK", "BLOCKS") => block = None,
            (_, "BLOCKS") => {
                if let Some((_, entities)) = block.and_then(|name| content.blocks.get_mut(name)) {
                    entities.push(entity);
                }
            }
            (_, "ENTITIES") => content.entities.push(entity),
            _ => {}
        }
    }
    match text.contains("SECTION") {
        true => Ok(content),
        false => Err("it has no sections: it is not a DXF file".to_owned()),
    }
}

/// Reads a DXF text; an error holds the problem and its line.
pub(super) fn read(text: &str, options: &DxfOptions) -> Result<Drawing, String> {
    let content = content(text)?;
    let mut reader = Reader {
        content: &content,
        options,
        chains: Vec::new(),
        leaves: Vec::new(),
        rounds: Vec::new(),
        points: 0,
        scale: options.scale,
        drawing: Drawing::default(),
    };
    reader.entities()?;
    Ok(reader.finish())
}

struct Reader<'a> {
    content: &'a Content<'a>,
    options: &'a DxfOptions<'a>,
    /// Lines and arcs to be joined.
    chains: Vec<Vec<Point>>,
    /// Closed outlines.
    leaves: Vec<Vec<Point>>,
    /// Circles and ellipses: half axes, map and number of facets.
    rounds: Vec<(Point, Affine, usize)>,
    points: usize,
    /// Scale of the radii that determine numbers of facets.
    scale: f64,
    drawing: Drawing,
}

impl<'a> Reader<'a> {
    fn entities(&mut self) -> Result<(), String> {
        let content = self.content;
        let mut waiting = vec![(&content.entities, Affine::IDENTITY, 0)];
        let mut uses = 0;
        while let Some((entities, map, depth)) = waiting.pop() {
            uses += 1;
            if uses > MAX_USES || depth > DEEPEST {
                return Err(format!(
                    "its blocks use each other more than {DEEPEST} deep or {MAX_USES} times"
                ));
            }
            // entities of a block are on the layer of the `INSERT`
            let is_wanted = |entity: &Entity| {
                depth > 0 || self.options.layer.is_empty() || entity.text(8) == self.options.layer
            };
            self.scale = if depth == 0 { self.options.scale } else { 1.0 };
            let mut polyline: Option<(bool, Vec<Vertex>)> = None;
            for entity in entities {
                // entities of a block are read once per use; each value requires a search among the pairs
                self.options.budget.spend(200 + 50 * entity.pairs.len())?;
                match entity.name {
                    "VERTEX" => polyline.iter_mut().for_each(|(_, all)| all.push(Vertex::of(entity))),
                    "SEQEND" => {
                        if let Some((is_closed, vertices)) = polyline.take() {
                            self.polyline(&vertices, is_closed, &map)?;
                        }
                    }
                    _ if !is_wanted(entity) => {}
                    "POLYLINE" => polyline = Some((entity.number(70, 0.0) as u32 & 1 == 1, Vec::new())),
                    "INSERT" => waiting.extend(
                        content
                            .blocks
                            .get(entity.text(2))
                            .map(|(base, inner)| (inner, placed(entity, *base).then(&map), depth + 1)),
                    ),
                    _ => self.entity(entity, &map)?,
                }
            }
        }
        Ok(())
    }

    fn entity(&mut self, entity: &Entity, map: &Affine) -> Result<(), String> {
        let centre = shift(entity.point(10)).then(map);
        let radius = entity.number(40, 0.0);
        match entity.name {
            "LINE" => self.chain(vec![entity.point(10), entity.point(11)], map),
            "CIRCLE" if radius > 0.0 => self.ellipse([radius; 2], &centre, 0),
            "ARC" if radius > 0.0 => {
                let (from, to) = (entity.number(50, 0.0), entity.number(51, 360.0));
                let span = (to - from).rem_euclid(360.0);
                let span = if span == 0.0 { 360.0 } else { span };
                self.arc([radius; 2], from, span, &centre)
            }
            "ELLIPSE" => {
                let [x, y] = entity.point(11);
                let (major, ratio) = (libm::hypot(x, y), entity.number(40, 1.0));
                if major <= 0.0 || ratio <= 0.0 {
                    return Ok(());
                }
                let turned = plane_map([x / major, y / major, -y / major, x / major, 0.0, 0.0]).then(&centre);
                let (from, to) = (entity.number(41, 0.0).to_degrees(), entity.number(42, 0.0).to_degrees());
                let span = if to > from { to - from } else { to - from + 360.0 };
                match span >= 360.0 - 1e-9 {
                    true => self.ellipse([major, ratio * major], &turned, 1),
                    false => self.arc([major, ratio * major], from, span, &turned),
                }
            }
            "LWPOLYLINE" => self.polyline(&light(entity), entity.number(70, 0.0) as u32 & 1 == 1, map),
            "SPLINE" => self.spline(entity, map),
            // entities without an area
            "POINT" | "TEXT" | "MTEXT" | "ATTRIB" | "ATTDEF" | "DIMENSION" | "LEADER" | "VIEWPORT"
            | "RAY" | "XLINE" | "CIRCLE" | "ARC" => Ok(()),
            name => {
                let why = "entities of this kind cannot be read".to_owned();
                self.drawing.refuse(name, &why, || entity.line);
                Ok(())
            }
        }
    }

    fn count(&mut self, points: usize) -> Result<(), String> {
        self.points += points;
        self.options.budget.spend(100 * points)?;
        match self.points > MAX_POINTS {
            true => Err(format!("it has more than {MAX_POINTS} points")),
            false => Ok(()),
        }
    }

    fn chain(&mut self, points: Vec<Point>, map: &Affine) -> Result<(), String> {
        self.count(points.len())?;
        self.chains.push(points.into_iter().map(|p| image(map, p)).collect());
        Ok(())
    }

    /// Number of chords of an arc of the given angle.
    fn pieces(&mut self, radius: f64, degrees: f64) -> usize {
        self.drawing.has_chords |= !self.options.facets;
        match self.options.facets {
            true => {
                let full = self.options.fineness.fragments(self.scale * radius) as f64;
                (full * degrees.abs() / 360.0).ceil().max(1.0) as usize
            }
            false => chords(degrees),
        }
    }

    /// OpenSCAD divides an ellipse into one more piece than a circle.
    fn ellipse(&mut self, radii: Point, map: &Affine, more: usize) -> Result<(), String> {
        let fragments = self.options.fineness.fragments(self.scale * radii[0]) + more;
        if !self.options.facets {
            self.rounds.push((radii, *map, fragments));
            return self.count(chords(360.0));
        }
        let mut points = arc(radii, 0.0, 360.0, fragments);
        points.pop();
        self.count(points.len())?;
        self.leaves.push(points.into_iter().map(|p| image(map, p)).collect());
        Ok(())
    }

    fn arc(&mut self, radii: Point, from: f64, span: f64, map: &Affine) -> Result<(), String> {
        let pieces = self.pieces(radii[0], span);
        self.chain(arc(radii, from, from + span, pieces), map)
    }

    fn polyline(&mut self, vertices: &[Vertex], is_closed: bool, map: &Affine) -> Result<(), String> {
        let mut points = Vec::new();
        for (k, vertex) in vertices.iter().enumerate() {
            points.push(vertex.at);
            let next = vertices.get(k + 1).or(vertices.first().filter(|_| is_closed));
            if let Some(next) = next.filter(|next| vertex.bulge != 0.0 && next.at != vertex.at) {
                self.bulge(vertex, next.at, &mut points);
            }
        }
        if let Some(first) = vertices.first().filter(|_| is_closed) {
            points.push(first.at);
        }
        self.chain(points, map)
    }

    /// Interior points of an arc; its bulge is the tangent of a quarter of its angle.
    fn bulge(&mut self, from: &Vertex, to: Point, points: &mut Vec<Point>) {
        let angle = 4.0 * libm::atan(from.bulge);
        let chord = [to[0] - from.at[0], to[1] - from.at[1]];
        // distance from the chord's midpoint to the centre, in half chord lengths
        let offset = 0.5 * (1.0 / from.bulge - from.bulge);
        let centre = [
            from.at[0] + 0.5 * (chord[0] - offset * chord[1]),
            from.at[1] + 0.5 * (chord[1] + offset * chord[0]),
        ];
        let [x, y] = [from.at[0] - centre[0], from.at[1] - centre[1]];
        let pieces = self.pieces(libm::hypot(x, y), angle.to_degrees());
        points.extend((1..pieces).map(|k| {
            let (sin, cos) = libm::sincos(angle * k as f64 / pieces as f64);
            [centre[0] + cos * x - sin * y, centre[1] + sin * x + cos * y]
        }));
    }

    fn spline(&mut self, entity: &Entity, map: &Affine) -> Result<(), String> {
        let degree = entity.number(71, 3.0) as usize;
        let knots: Vec<f64> = entity.numbers(40).collect();
        let points: Vec<Point> = entity.numbers(10).zip(entity.numbers(20)).map(|(x, y)| [x, y]).collect();
        let weights: Vec<f64> = entity.numbers(41).collect();
        let is_spline =
            (1..=20).contains(&degree) && points.len() > degree && knots.len() == points.len() + degree + 1;
        if !is_spline || knots.windows(2).any(|pair| pair[1] < pair[0]) {
            let why = "its numbers of knots and points do not match".to_owned();
            self.drawing.refuse("SPLINE", &why, || entity.line);
            return Ok(());
        }
        self.drawing.has_chords |= degree > 1;
        let pieces = if degree == 1 { 1 } else { SPLINE_PIECES };
        self.count(points.len() * pieces)?;
        self.options.budget.spend(5 * points.len() * pieces * degree * degree)?;
        let weight = |k: usize| weights.get(k).copied().filter(|w| *w > 0.0).unwrap_or(1.0);
        let control: Vec<Vec3> =
            points.iter().enumerate().map(|(k, p)| weight(k) * Vec3::new(p[0], p[1], 1.0)).collect();
        let mut all = Vec::new();
        for span in degree..points.len() {
            let (lo, hi) = (knots[span], knots[span + 1]);
            if hi > lo {
                all.extend((0..pieces).map(|k| {
                    de_boor(&control, &knots, degree, span, lo + (hi - lo) * k as f64 / pieces as f64)
                }));
            }
        }
        all.push(de_boor(&control, &knots, degree, points.len() - 1, knots[points.len()]));
        self.chain(all, map)
    }

    /// Keeps a single circle exactly round. Among other shapes, a circle may be or contain a hole and becomes a chain of chords.
    fn round_off(&mut self) {
        let rounds = std::mem::take(&mut self.rounds);
        if let [(radii, map, fragments)] = rounds[..]
            && self.leaves.is_empty()
            && self.chains.is_empty()
        {
            let own = Affine::scale(Vec3::new(radii[0], radii[1], 1.0)).then(&map);
            self.drawing.leaves.push((Leaf::Disc { radius: 1.0, fragments }, own));
            return;
        }
        self.drawing.has_chords |= !rounds.is_empty();
        for (radii, map, _) in rounds {
            let mut points = arc(radii, 0.0, 360.0, chords(360.0));
            points.pop();
            self.leaves.push(points.into_iter().map(|p| image(&map, p)).collect());
        }
    }

    /// Joins the chains into closed ones, which are filled together with the outlines by the even-odd rule.
    fn finish(mut self) -> Drawing {
        self.round_off();
        let (closed, open) = joined(std::mem::take(&mut self.chains));
        self.drawing.closed = open.len();
        self.leaves.extend(closed);
        self.leaves.extend(open);
        self.leaves.retain(|contour| contour.len() >= 3);
        if !self.leaves.is_empty() {
            self.drawing.leaves.push((Leaf::Outline(self.leaves), Affine::IDENTITY));
        }
        self.drawing
    }
}

/// A vertex of a polyline, with the bulge of the segment that follows.
struct Vertex {
    at: Point,
    bulge: f64,
}

impl Vertex {
    fn of(entity: &Entity) -> Vertex {
        Vertex { at: entity.point(10), bulge: entity.number(42, 0.0) }
    }
}

/// Vertices of a `LWPOLYLINE`; each bulge follows its point.
fn light(entity: &Entity) -> Vec<Vertex> {
    let mut vertices: Vec<Vertex> = Vec::new();
    for (code, text) in &entity.pairs {
        match (code, vertices.last_mut()) {
            (10, _) => vertices.push(Vertex { at: [parsed(text), 0.0], bulge: 0.0 }),
            (20, Some(last)) => last.at[1] = parsed(text),
            (42, Some(last)) => last.bulge = parsed(text),
            _ => {}
        }
    }
    vertices
}

/// Transform of an `INSERT`.
fn placed(entity: &Entity, base: Point) -> Affine {
    let scale = [entity.number(41, 1.0), entity.number(42, 1.0)];
    shift([-base[0], -base[1]])
        .then(&Affine::scale(Vec3::new(scale[0], scale[1], 1.0)))
        .then(&Affine::rotation(Vec3::Z, entity.number(50, 0.0)))
        .then(&shift(entity.point(10)))
}

/// A point of a rational B-spline within a knot span (C. de Boor 1972), with control points in homogeneous coordinates.
fn de_boor(control: &[Vec3], knots: &[f64], degree: usize, span: usize, t: f64) -> Point {
    let mut d: Vec<Vec3> = control[span - degree..=span].to_vec();
    for r in 1..=degree {
        for j in (r..=degree).rev() {
            let (lo, hi) = (knots[span + j - degree], knots[span + 1 + j - r]);
            let a = if hi > lo { (t - lo) / (hi - lo) } else { 0.0 };
            d[j] = d[j - 1].lerp(d[j], a);
        }
    }
    [d[degree].x / d[degree].z, d[degree].y / d[degree].z]
}

type Chains = Vec<Vec<Point>>;

/// Joins chains at common ends: closed chains, and those that remain open. Empty polylines are dropped.
fn joined(mut chains: Chains) -> (Chains, Chains) {
    chains.retain(|chain| !chain.is_empty());
    let mut nodes = Nodes::default();
    let ends: Vec<[usize; 2]> =
        chains.iter().map(|chain| [chain[0], chain[chain.len() - 1]].map(|p| nodes.number(p))).collect();
    let mut at: Vec<Vec<usize>> = vec![Vec::new(); nodes.count];
    ends.iter().enumerate().for_each(|(k, pair)| pair.iter().for_each(|node| at[*node].push(k)));
    let mut used = vec![false; chains.len()];
    // number of chains at each node that are known to be used, so that a node with many chains is not searched repeatedly
    let mut passed = vec![0; nodes.count];
    let (mut closed, mut open) = (Vec::new(), Vec::new());
    // open chains start at nodes with only one chain end
    let single = (0..chains.len()).filter(|k| ends[*k].iter().any(|node| at[*node].len() == 1));
    for start in single.collect::<Vec<_>>().into_iter().chain(0..chains.len()) {
        if used[start] {
            continue;
        }
        let mut side = usize::from(at[ends[start][0]].len() != 1 && at[ends[start][1]].len() == 1);
        let first = ends[start][side];
        let (mut way, mut next) = (Vec::new(), Some(start));
        let mut node = first;
        while let Some(k) = next {
            used[k] = true;
            side = usize::from(ends[k][0] != node);
            let piece = chains[k].iter();
            match side {
                0 => way.extend(piece.take(chains[k].len() - 1)),
                _ => way.extend(piece.rev().take(chains[k].len() - 1)),
            }
            node = ends[k][1 - side];
            next = None;
            while node != first && next.is_none() && passed[node] < at[node].len() {
                next = Some(at[node][passed[node]]).filter(|k| !used[*k]);
                passed[node] += usize::from(next.is_none());
            }
            if next.is_none() && node != first {
                let last = if side == 0 { chains[k].last() } else { chains[k].first() };
                way.extend(last);
            }
        }
        if node == first { closed.push(way) } else { open.push(way) }
    }
    (closed, open)
}

/// Set of points that merges points near each other.
#[derive(Default)]
struct Nodes {
    cells: HashMap<[i64; 2], Vec<(Point, usize)>>,
    count: usize,
}

impl Nodes {
    fn number(&mut self, p: Point) -> usize {
        let cell = p.map(|x| (x / NEAR).floor().clamp(-9e15, 9e15) as i64);
        for dx in -1..=1 {
            for dy in -1..=1 {
                let known = self.cells.get(&[cell[0] + dx, cell[1] + dy]).into_iter().flatten();
                let near = |(q, _): &&(Point, usize)| libm::hypot(p[0] - q[0], p[1] - q[1]) <= NEAR;
                if let Some((_, number)) = known.into_iter().find(near) {
                    return *number;
                }
            }
        }
        self.cells.entry(cell).or_default().push((p, self.count));
        self.count += 1;
        self.count - 1
    }
}
