//! Drawings in DXF, as OpenSCAD imports them: closed chains of lines and arcs, circles and ellipses; what lies in an odd number
//! of them is inside. Arcs within polylines and splines are read too, which OpenSCAD 2021.01 leaves out.
//!
//! *Source*: Autodesk, *DXF Reference*, chapters "ENTITIES section", "BLOCKS section": pairs of a code and a value, a line each.

use super::drawing::{Drawing, MOST_POINTS, arc, chords, plane_map, shift};
use super::facets::Fineness;
use super::flat::{Leaf, image};
use rayweave_math::{Affine, Vec3};
use rayweave_space::Point;
use std::collections::HashMap;

/// Ends of lines nearer than this are one point, as in OpenSCAD: 2^-10.
const NEAR: f64 = 1.0 / 1024.0;
/// How deep blocks may use each other.
const DEEPEST: usize = 20;
/// Blocks that are used, every time counted.
const MOST_USES: usize = 100_000;
/// Pieces of a spline between two knots.
const SPLINE_PIECES: usize = 128;

/// How a drawing is read.
#[derive(Clone, Copy, Debug)]
pub(super) struct DxfOptions<'a> {
    /// Round shapes in as many pieces as OpenSCAD makes of them.
    pub facets: bool,
    pub fineness: Fineness,
    /// Only this layer; all, if it is empty.
    pub layer: &'a str,
}

/// An entity: its name, its line, and its pairs.
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

    /// All numbers of a code; what is no finite number is 0.
    fn numbers(&self, code: u16) -> impl Iterator<Item = f64> {
        self.pairs.iter().filter(move |pair| pair.0 == code).map(|pair| parsed(pair.1))
    }

    fn number(&self, code: u16, default: f64) -> f64 {
        self.numbers(code).next().unwrap_or(default)
    }

    fn point(&self, code: u16) -> Point<2> {
        [self.number(code, 0.0), self.number(code + 10, 0.0)]
    }
}

fn parsed(text: &str) -> f64 {
    text.parse().ok().filter(|number: &f64| number.abs() < 1e100).unwrap_or(0.0)
}

/// The pairs of a file, with the lines of their codes.
fn pairs(text: &str) -> Result<Vec<(u16, &str, usize)>, String> {
    let mut lines = text.trim_start_matches('\u{feff}').lines().map(str::trim).enumerate();
    let mut all = Vec::new();
    while let Some((number, code)) = lines.next() {
        if code.is_empty() && all.last().is_some_and(|(_, value, _)| *value == "EOF") {
            break;
        }
        let code = code.parse().map_err(|_| format!("line {} of it is no code of a DXF", number + 1))?;
        let Some((_, value)) = lines.next() else {
            return Err(format!("it ends after the code in line {}", number + 1));
        };
        all.push((code, value, number + 1));
    }
    Ok(all)
}

/// The entities outside of blocks, and those of each block with its base point.
struct Content<'a> {
    entities: Vec<Entity<'a>>,
    blocks: HashMap<&'a str, (Point<2>, Vec<Entity<'a>>)>,
}

fn content(text: &str) -> Result<Content<'_>, String> {
    let mut content = Content { entities: Vec::new(), blocks: HashMap::new() };
    let mut all: Vec<Entity> = Vec::new();
    for (code, value, line) in pairs(text)? {
        match (code, all.last_mut()) {
            (0, _) => all.push(Entity { name: value, line, pairs: Vec::new() }),
            (_, Some(entity)) => entity.pairs.push((code, value)),
            // comments may stand first
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
        false => Err("it has no sections: it is no DXF".to_owned()),
    }
}

/// Reads a text; an error says what is wrong, and where.
pub(super) fn read(text: &str, options: &DxfOptions) -> Result<Drawing, String> {
    let content = content(text)?;
    let mut reader = Reader {
        content: &content,
        options,
        chains: Vec::new(),
        leaves: Vec::new(),
        rounds: Vec::new(),
        points: 0,
        drawing: Drawing::default(),
    };
    reader.entities()?;
    Ok(reader.finish())
}

struct Reader<'a> {
    content: &'a Content<'a>,
    options: &'a DxfOptions<'a>,
    /// Lines and arcs that are to be joined.
    chains: Vec<Vec<Point<2>>>,
    /// Closed outlines.
    leaves: Vec<Vec<Point<2>>>,
    /// Circles and ellipses by their half axes and maps, with the number of their facets.
    rounds: Vec<(Point<2>, Affine, usize)>,
    points: usize,
    drawing: Drawing,
}

impl<'a> Reader<'a> {
    fn entities(&mut self) -> Result<(), String> {
        let content = self.content;
        let mut waiting = vec![(&content.entities, Affine::IDENTITY, 0)];
        let mut uses = 0;
        while let Some((entities, map, depth)) = waiting.pop() {
            uses += 1;
            if uses > MOST_USES || depth > DEEPEST {
                return Err(format!(
                    "its blocks use each other more than {DEEPEST} deep or {MOST_USES} times"
                ));
            }
            // those within a block are of the layer that uses it
            let is_wanted = |entity: &Entity| {
                depth > 0 || self.options.layer.is_empty() || entity.text(8) == self.options.layer
            };
            let mut polyline: Option<(bool, Vec<Vertex>)> = None;
            for entity in entities {
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
            // what is no region
            "POINT" | "TEXT" | "MTEXT" | "ATTRIB" | "ATTDEF" | "DIMENSION" | "LEADER" | "VIEWPORT"
            | "RAY" | "XLINE" | "CIRCLE" | "ARC" => Ok(()),
            name => {
                let why = "entities of this kind cannot be read".to_owned();
                self.drawing.refused.push((name.chars().take(40).collect(), why, entity.line));
                Ok(())
            }
        }
    }

    fn count(&mut self, points: usize) -> Result<(), String> {
        self.points += points;
        match self.points > MOST_POINTS {
            true => Err(format!("it has more than {MOST_POINTS} points")),
            false => Ok(()),
        }
    }

    fn chain(&mut self, points: Vec<Point<2>>, map: &Affine) -> Result<(), String> {
        self.count(points.len())?;
        self.chains.push(points.into_iter().map(|p| image(map, p)).collect());
        Ok(())
    }

    /// The pieces of an arc of so many degrees.
    fn pieces(&mut self, radius: f64, degrees: f64) -> usize {
        self.drawing.has_chords |= !self.options.facets;
        match self.options.facets {
            true => {
                let full = self.options.fineness.fragments(radius) as f64;
                (full * degrees.abs() / 360.0).ceil().max(1.0) as usize
            }
            false => chords(degrees),
        }
    }

    /// OpenSCAD gives an ellipse one piece more than a circle.
    fn ellipse(&mut self, radii: Point<2>, map: &Affine, more: usize) -> Result<(), String> {
        let fragments = self.options.fineness.fragments(radii[0]) + more;
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

    fn arc(&mut self, radii: Point<2>, from: f64, span: f64, map: &Affine) -> Result<(), String> {
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

    /// The points within an arc, whose bulge is the tangent of a quarter of its angle.
    fn bulge(&mut self, from: &Vertex, to: Point<2>, points: &mut Vec<Point<2>>) {
        let angle = 4.0 * libm::atan(from.bulge);
        let chord = [to[0] - from.at[0], to[1] - from.at[1]];
        // from the middle of the chord to the centre, in halves of the chord across it
        let aside = 0.5 * (1.0 / from.bulge - from.bulge);
        let centre = [
            from.at[0] + 0.5 * (chord[0] - aside * chord[1]),
            from.at[1] + 0.5 * (chord[1] + aside * chord[0]),
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
        let points: Vec<Point<2>> = entity.numbers(10).zip(entity.numbers(20)).map(|(x, y)| [x, y]).collect();
        let weights: Vec<f64> = entity.numbers(41).collect();
        let is_spline =
            (1..=20).contains(&degree) && points.len() > degree && knots.len() == points.len() + degree + 1;
        if !is_spline || knots.windows(2).any(|pair| pair[1] < pair[0]) {
            let why = "its knots and points do not fit each other".to_owned();
            self.drawing.refused.push(("SPLINE".to_owned(), why, entity.line));
            return Ok(());
        }
        self.drawing.has_chords |= degree > 1;
        let pieces = if degree == 1 { 1 } else { SPLINE_PIECES };
        self.count(points.len() * pieces)?;
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

    /// A circle alone stays round. Together with others it may be a hole, or have one, and is a chain of chords.
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

    /// Joins the chains to closed ones, which count by the even-odd rule together with the outlines.
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

/// A corner of a polyline, and how the way to the next one bends.
struct Vertex {
    at: Point<2>,
    bulge: f64,
}

impl Vertex {
    fn of(entity: &Entity) -> Vertex {
        Vertex { at: entity.point(10), bulge: entity.number(42, 0.0) }
    }
}

/// The corners of a `LWPOLYLINE`, whose bulges stand after the points that they belong to.
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

/// Where an `INSERT` puts a block.
fn placed(entity: &Entity, base: Point<2>) -> Affine {
    let scale = [entity.number(41, 1.0), entity.number(42, 1.0)];
    shift([-base[0], -base[1]])
        .then(&Affine::scale(Vec3::new(scale[0], scale[1], 1.0)))
        .then(&Affine::rotation(Vec3::Z, entity.number(50, 0.0)))
        .then(&shift(entity.point(10)))
}

/// A point of a rational B-spline within a span of its knots (C. de Boor 1972), control points in homogeneous coordinates.
fn de_boor(control: &[Vec3], knots: &[f64], degree: usize, span: usize, t: f64) -> Point<2> {
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

type Chains = Vec<Vec<Point<2>>>;

/// Chains whose ends meet as one: those that are closed, and those that remain open. Polylines without points are none.
fn joined(mut chains: Chains) -> (Chains, Chains) {
    chains.retain(|chain| !chain.is_empty());
    let mut nodes = Nodes::default();
    let ends: Vec<[usize; 2]> =
        chains.iter().map(|chain| [chain[0], chain[chain.len() - 1]].map(|p| nodes.number(p))).collect();
    let mut at: Vec<Vec<usize>> = vec![Vec::new(); nodes.count];
    ends.iter().enumerate().for_each(|(k, pair)| pair.iter().for_each(|node| at[*node].push(k)));
    let mut used = vec![false; chains.len()];
    let (mut closed, mut open) = (Vec::new(), Vec::new());
    // open ways begin at nodes where only one chain ends
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
            next = if node == first { None } else { at[node].iter().copied().find(|k| !used[*k]) };
            if next.is_none() && node != first {
                let last = if side == 0 { chains[k].last() } else { chains[k].first() };
                way.extend(last);
            }
        }
        if node == first { closed.push(way) } else { open.push(way) }
    }
    (closed, open)
}

/// Points that are one if they are near each other.
#[derive(Default)]
struct Nodes {
    cells: HashMap<[i64; 2], Vec<(Point<2>, usize)>>,
    count: usize,
}

impl Nodes {
    fn number(&mut self, p: Point<2>) -> usize {
        let cell = p.map(|x| (x / NEAR).floor().clamp(-9e15, 9e15) as i64);
        for dx in -1..=1 {
            for dy in -1..=1 {
                let known = self.cells.get(&[cell[0] + dx, cell[1] + dy]).into_iter().flatten();
                let near = |(q, _): &&(Point<2>, usize)| libm::hypot(p[0] - q[0], p[1] - q[1]) <= NEAR;
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
