//! Edges and outlines of a model in a direction of view, visible ones and those that other faces cover.
//!
//! Rays through the points of a grid find all faces. Where the faces of two neighbours do not correspond to each other, the interval
//! between them is bisected, each half of it as long as its ends differ, so that several edges between neighbours are found. A line that
//! coincides with a visible one is left out (ISO 128-2). Within each cell of the grid the points between the same faces are joined.

use crate::edges::{BISECTIONS, EdgeView, Grid, JUMP, SMOOTH, chains};
use rayweave_analysis::Cancelled;
use rayweave_math::Vec3;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::{Crossing, Evaluator, Query, RayAnswer, RayBatch, RegionId, attributes};
use rayweave_shape::Ray;
use std::collections::BTreeMap;
use std::num::NonZeroUsize;

type Point = [f64; 2];

/// A gap or a wall thinner than this, relative to the size of the window, results from rounding.
const THIN: f64 = 1e-12;

/// Edges nearer to each other than this, in steps of the grid, are one line.
const COINCIDENT: f64 = 0.02;

/// Hidden lines shorter than this, in steps of the grid, are left out.
const SHORT: f64 = 2.0;

/// The leaf, the facet and the placement of a face.
type FaceKey = (u32, u32, u32);

/// A face that a ray crosses.
#[derive(Clone, Copy, Debug)]
struct Layer {
    t: f64,
    normal: Vec3,
    face: FaceKey,
    /// The regions before and after; 0 stands for every region without a medium.
    regions: [usize; 2],
}

/// The faces along a ray.
type Layers = Vec<Layer>;

/// The edges of a view, as lines in the coordinates of the plane.
#[derive(Clone, Debug, Default)]
pub struct Edges {
    pub visible: Vec<Vec<Point>>,
    pub hidden: Vec<Vec<Point>>,
}

/// The visible and the hidden edges of the whole model.
///
/// # Errors
///
/// [`Cancelled`].
pub fn all_edges<E: Evaluator>(
    evaluator: &E,
    view: &EdgeView,
    threads: Option<NonZeroUsize>,
    cancel: &Cancel,
) -> Result<Edges, Cancelled> {
    let grid = Grid::new(view);
    let size = (view.window[1][0] - view.window[0][0]).max(view.window[1][1] - view.window[0][1]);
    let search = Search { evaluator, view, grid: &grid, size };
    let (mut above, mut places): (Vec<Layers>, [Places; 2]) = (Vec::new(), Default::default());
    let work = |scratch: &mut E::Scratch, row: usize| {
        let points: Vec<Point> = (0..grid.columns).map(|column| grid.point(column, row)).collect();
        (row, search.layers(&points, scratch))
    };
    let mut scratch = evaluator.scratch();
    let merge = |(row, layers): (usize, Vec<Layers>)| {
        if cancel.is_cancelled() {
            return Err(Cancelled);
        }
        let mut open = search.open(row, 0, layers.iter().zip(layers.iter().skip(1)));
        if row > 0 {
            open.extend(search.open(row - 1, 1, above.iter().zip(&layers)));
        }
        search.bisect(open, &mut scratch, &mut places);
        above = layers;
        Ok(())
    };
    match drive(thread_count(threads), cancel, 0..grid.rows, || evaluator.scratch(), work, merge) {
        Ok(()) => {}
        Err(Stopped::Cancelled | Stopped::Failed(Cancelled)) => return Err(Cancelled),
    }
    let [visible, hidden] = places.map(|own| chains(&segments(&grid, &own)));
    let length = |line: &[Point]| {
        line.windows(2).map(|pair| libm::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1])).sum::<f64>()
    };
    let hidden = hidden.into_iter().filter(|line| length(line) > SHORT * grid.step).collect();
    Ok(Edges { visible, hidden })
}

/// The side of a cell, by the index of its first point and its direction: 0 to the right, 1 up.
type Side = (usize, usize);

/// The edges on the sides of cells, with the faces that meet there.
type Places = BTreeMap<Side, Vec<(Point, Vec<FaceKey>)>>;

/// An interval whose ends differ.
struct Open {
    side: Side,
    ends: [(Point, Layers); 2],
}

/// A difference between the ends of a short interval: the faces at a visible edge, and those at hidden ones.
struct Change {
    at: Point,
    visible: Vec<FaceKey>,
    hidden: Vec<FaceKey>,
}

struct Search<'a, E> {
    evaluator: &'a E,
    view: &'a EdgeView,
    grid: &'a Grid,
    size: f64,
}

impl<E: Evaluator> Search<'_, E> {
    fn layers(&self, places: &[Point], scratch: &mut E::Scratch) -> Vec<Layers> {
        let (program, forward) = (self.evaluator.program(), -self.view.plane.normal());
        let rays: Vec<Ray> =
            places.iter().map(|&place| Ray::new(self.view.plane.point(place), forward)).collect();
        let mut batch = RayBatch::default();
        rays.iter().for_each(|ray| batch.push(*ray));
        let number = |region: RegionId| if program.medium_of(region) == 0 { 0 } else { region.index() };
        let mut found = vec![Layers::new(); places.len()];
        let mut sink = |answer: RayAnswer<'_>| {
            let layer = |crossing: &Crossing| {
                let (face, normal) =
                    (crossing.face, attributes::normal(program, &rays[answer.ray], crossing));
                let regions = [crossing.before, crossing.after].map(number);
                Layer { t: crossing.t, normal, face: (face.leaf.0, face.facet, face.placement.0), regions }
            };
            let layers = answer.crossings.iter().map(layer).filter(|own| own.regions[0] != own.regions[1]);
            found[answer.ray] = layers.collect();
        };
        self.evaluator.crossings(batch.rays(), &Query::default(), scratch, &mut sink);
        found
    }

    /// The sides of cells in a row whose ends differ.
    fn open<'l>(
        &self,
        row: usize,
        direction: usize,
        pairs: impl Iterator<Item = (&'l Layers, &'l Layers)>,
    ) -> Vec<Open> {
        let mut open = Vec::new();
        for (column, (first, last)) in pairs.enumerate() {
            let points = match direction {
                0 => [self.grid.point(column, row), self.grid.point(column + 1, row)],
                _ => [self.grid.point(column, row), self.grid.point(column, row + 1)],
            };
            let ends = [(points[0], first.clone()), (points[1], last.clone())];
            if !self.is_alike(&ends) {
                open.push(Open { side: (self.grid.index(column, row), direction), ends });
            }
        }
        open
    }

    /// True if no edge separates the ends: each face is the same, or continues the other one.
    fn is_alike(&self, [(p, first), (q, last)]: &[(Point, Layers); 2]) -> bool {
        let [u, v] = self.view.plane.axes();
        let along = (q[0] - p[0]) * u + (q[1] - p[1]) * v;
        let forward = -self.view.plane.normal();
        // the distance of the tangent plane at one end from the face at the other one, along the rays
        let off = |own: &Layer, along: Vec3, rise: f64| {
            (rise + own.normal.dot(along) / own.normal.dot(forward)).abs()
        };
        let continues = |(a, b): (&Layer, &Layer)| {
            let rise = b.t - a.t;
            a.regions == b.regions
                // the triangles of a mesh are one face
                && a.normal.dot(b.normal) >= SMOOTH
                && (a.face == b.face
                    || off(a, along, rise).max(off(b, -along, -rise)) < 0.1 * JUMP * self.size)
        };
        first.len() == last.len() && first.iter().zip(last).all(continues)
    }

    /// Bisects intervals of one or two rows, and adds the visible and the hidden edges.
    fn bisect(&self, mut open: Vec<Open>, scratch: &mut E::Scratch, [visible, hidden]: &mut [Places; 2]) {
        for _ in 0..BISECTIONS {
            let middle = |open: &Open| [0, 1].map(|k| 0.5 * (open.ends[0].0[k] + open.ends[1].0[k]));
            let middles: Vec<Point> = open.iter().map(middle).collect();
            let found = self.layers(&middles, scratch);
            let mut next = Vec::with_capacity(open.len());
            for ((Open { side, ends: [first, last] }, at), layers) in open.into_iter().zip(middles).zip(found)
            {
                let middle = (at, layers);
                let before = [first, middle.clone()];
                if !self.is_alike(&before) {
                    next.push(Open { side, ends: before });
                }
                let after = [middle, last];
                if !self.is_alike(&after) {
                    next.push(Open { side, ends: after });
                }
            }
            open = next;
        }
        for own in open.chunk_by(|a, b| a.side == b.side) {
            let mut changes: Vec<Change> = Vec::new();
            for change in own.iter().filter_map(|open| self.change(open)) {
                let is_near = |last: &&mut Change| {
                    (change.at[0] - last.at[0]).abs().max((change.at[1] - last.at[1]).abs())
                        < COINCIDENT * self.grid.step
                };
                match changes.last_mut().filter(is_near) {
                    Some(last) => {
                        last.visible.extend(change.visible);
                        last.hidden.extend(change.hidden);
                    }
                    None => changes.push(change),
                }
            }
            for change in changes {
                let (places, mut faces) = match change.visible.is_empty() {
                    true => (&mut *hidden, change.hidden),
                    false => (&mut *visible, change.visible),
                };
                faces.sort_unstable();
                faces.dedup();
                places.entry(own[0].side).or_default().push((change.at, faces));
            }
        }
    }

    /// The edge between the ends of a short interval.
    fn change(&self, Open { ends: [(at, first), (_, last)], .. }: &Open) -> Option<Change> {
        let (mut i, mut j) = (0, 0);
        let (mut visible, mut hidden): (Vec<FaceKey>, Vec<FaceKey>) = (Vec::new(), Vec::new());
        let mut single: [Vec<usize>; 2] = [Vec::new(), Vec::new()];
        while i < first.len() || j < last.len() {
            match (first.get(i), last.get(j)) {
                (Some(a), Some(b)) if a.regions == b.regions && (a.t - b.t).abs() < JUMP * self.size => {
                    if a.normal.dot(b.normal) < SMOOTH {
                        let faces = if i == 0 || j == 0 { &mut visible } else { &mut hidden };
                        faces.extend([a.face, b.face]);
                    }
                    (i, j) = (i + 1, j + 1);
                }
                (Some(a), b) if b.is_none_or(|b| a.t <= b.t) => {
                    single[0].push(i);
                    i += 1;
                }
                _ => {
                    single[1].push(j);
                    j += 1;
                }
            }
        }
        for (own, layers) in single.iter().zip([first, last]) {
            for &k in own {
                let is_thin = |other: usize| {
                    own.contains(&other) && (layers[other].t - layers[k].t).abs() < THIN * self.size
                };
                if !(is_thin(k + 1) || k > 0 && is_thin(k - 1)) {
                    let faces = if k == 0 { &mut visible } else { &mut hidden };
                    faces.push(layers[k].face);
                }
            }
        }
        (!(visible.is_empty() && hidden.is_empty())).then_some(Change { at: *at, visible, hidden })
    }
}

/// Joins the edges on the sides of each cell: those between the same faces, and the rest with each other, as at corners.
fn segments(grid: &Grid, places: &Places) -> Vec<[Point; 2]> {
    let mut segments = Vec::new();
    let mut cells: Vec<(usize, usize)> = Vec::new();
    for &(index, direction) in places.keys() {
        let (column, row) = (index % grid.columns, index / grid.columns);
        cells.push((row, column));
        match direction {
            0 if row > 0 => cells.push((row - 1, column)),
            1 if column > 0 => cells.push((row, column - 1)),
            _ => {}
        }
    }
    cells.sort_unstable();
    cells.dedup();
    for (row, column) in cells {
        let sides = [
            (grid.index(column, row), 0),
            (grid.index(column, row + 1), 0),
            (grid.index(column, row), 1),
            (grid.index(column + 1, row), 1),
        ];
        let mut by_faces: BTreeMap<&[FaceKey], Vec<Point>> = BTreeMap::new();
        for (at, faces) in sides.iter().filter_map(|side| places.get(side)).flatten() {
            by_faces.entry(faces).or_default().push(*at);
        }
        let mut rest = Vec::new();
        for points in by_faces.into_values() {
            match points[..] {
                [a, b] => segments.push([a, b]),
                _ => rest.extend(points),
            }
        }
        match rest[..] {
            [] | [_] => {}
            [a, b] => segments.push([a, b]),
            _ => {
                let mean = |k: usize| rest.iter().map(|p| p[k]).sum::<f64>() / rest.len() as f64;
                let middle = [mean(0), mean(1)];
                segments.extend(rest.iter().map(|&p| [p, middle]));
            }
        }
    }
    segments
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_analysis::section::Cut;
    use rayweave_scene::Compiled;
    use rayweave_trace::AnyEvaluator;

    /// The hidden edges from the direction of -x: y to the right, z up.
    fn hidden(text: &str) -> Vec<Vec<Point>> {
        let (_, scene) = rayweave_scene::parse(&format!("rayweave = 1\n{text}")).unwrap();
        let evaluator = AnyEvaluator::new(None, Compiled::new(&scene).unwrap().program).unwrap();
        let plane = Cut::new(Vec3::ZERO, Vec3::Y, Vec3::Z).unwrap();
        let view = EdgeView { plane, is_behind: false, window: [[-25.113; 2], [25.0; 2]], step: 0.137 };
        all_edges(&evaluator, &view, None, &Cancel::new()).unwrap().hidden
    }

    /// The lengths of vertical lines by their y, rounded to 1e-4, and the length of the other lines.
    fn vertical(lines: &[Vec<Point>]) -> (BTreeMap<i64, f64>, f64) {
        let (mut found, mut rest) = (BTreeMap::new(), 0.0);
        for pair in lines.iter().flat_map(|line| line.windows(2)) {
            let [a, b] = [pair[0], pair[1]];
            let length = libm::hypot(b[0] - a[0], b[1] - a[1]);
            match (b[0] - a[0]).abs() < 1e-4 {
                true => *found.entry((1e4 * a[0]).round() as i64).or_insert(0.0) += length,
                false => rest += length,
            }
        }
        (found, rest)
    }

    /// A bore of radius 10 with a keyway of width 6 and half length 15 on both sides: the bore has no outline at 10, where the keyway is,
    /// but edges at sqrt(100 - 9).
    #[test]
    fn a_bore_with_a_keyway_has_the_edges_of_both() {
        let lines = hidden(
            "[solid.block]\nbox = { size = [40, 40, 20] }\n[solid.bore]\ncylinder = { radius = 10 }\n\
             [solid.key]\nbox = { size = [6, 30, 60] }\n[solid.part]\nexpr = \"block - bore - key\"\n[[region]]\nsolid = \"part\"",
        );
        let (found, rest) = vertical(&lines);
        let edge = (1e4 * 91f64.sqrt()).round() as i64;
        assert_eq!(found.keys().copied().collect::<Vec<_>>(), [-150_000, -edge, edge, 150_000], "{found:?}");
        assert!(found.values().all(|length| (length - 20.0).abs() < 0.3) && rest < 0.3, "{found:?} {rest}");
    }

    /// A bore that ends half-way up has an outline only there, and a floor; the part of a shaft in front of a slot covers its edges.
    #[test]
    fn outlines_end_where_the_face_ends() {
        let lines = hidden(
            "[solid.block]\nbox = { size = [40, 40, 20] }\n[solid.bore]\ncylinder = { radius = 10, height = 20 }\n\
             transform = { translate = [0, 0, 10] }\n[solid.part]\nexpr = \"block - bore\"\n[[region]]\nsolid = \"part\"",
        );
        let (found, rest) = vertical(&lines);
        assert_eq!(found.keys().copied().collect::<Vec<_>>(), [-100_000, 100_000], "{found:?}");
        assert!(found.values().all(|length| (length - 10.0).abs() < 0.3), "{found:?}");
        assert!((rest - 20.0).abs() < 0.6, "{rest}");
    }

    /// A blind groove in the far side: its walls are hidden, and its ends, which the outline of the model covers, are not drawn twice.
    #[test]
    fn grooves_in_the_far_side_are_hidden() {
        let slot = |x: f64| {
            hidden(&format!(
                "[solid.shaft]\ncylinder = {{ radius = 10, height = 30 }}\n[solid.slot]\nbox = {{ size = [10, 6, 12] }}\n\
                 transform = {{ translate = [{x}, 0, 0] }}\n[solid.part]\nexpr = \"shaft - slot\"\n[[region]]\nsolid = \"part\""
            ))
        };
        let (found, rest) = vertical(&slot(-11.5));
        assert_eq!(found.keys().copied().collect::<Vec<_>>(), [-30_000, 30_000], "{found:?}");
        assert!(found.values().all(|length| (length - 12.0).abs() < 0.3), "{found:?}");
        assert!((rest - 12.0).abs() < 0.6, "{rest}");
        // in the near side all of them are visible
        assert!(slot(11.5).is_empty());
    }

    /// A ball in a cavity has two hidden circles.
    #[test]
    fn cavities_have_outlines() {
        let lines = hidden(
            "[solid.block]\nbox = { size = [40, 40, 40] }\n[solid.hollow]\nsphere = { radius = 15 }\n[solid.ball]\nsphere = { radius = 9 }\n\
             [solid.part]\nexpr = \"(block - hollow) | ball\"\n[[region]]\nsolid = \"part\"",
        );
        let length: f64 = lines
            .iter()
            .flat_map(|line| line.windows(2))
            .map(|pair| libm::hypot(pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]))
            .sum();
        assert!((length / (std::f64::consts::TAU * 24.0) - 1.0).abs() < 1e-3, "{length}");
        assert_eq!(lines.len(), 2);
    }
}
