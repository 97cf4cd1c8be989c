//! Plane regions as boolean trees of mapped outlines and discs. They are not converted to polygons: an operation on a
//! region (such as an extrusion) is applied to its leaves, and the results are combined by the same boolean tree.

use super::arguments::{Arguments, Refusal, finite};
use super::facets::{Fineness, direction};
use super::operation::Operation;
use super::value::Value;
use rayweave_math::{Affine, Vec3};
use rayweave_polygon::Point;
use rayweave_polygon::{PolygonError, Polygons, from_polygons};
use rayweave_rootray::Side;
use std::cell::Cell;
use std::collections::HashMap;

/// Index of a plane region in [`Flats`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Flat(u32);

/// A leaf of the boolean tree of a region.
#[derive(Clone, Debug)]
pub(super) enum Leaf {
    /// The even-odd region of closed chains of points.
    Outline(Vec<Vec<Point>>),
    /// A disc about the origin, and the number of its facets.
    Disc { radius: f64, fragments: usize },
}

#[derive(Clone, Debug)]
enum Node {
    Leaf(Leaf),
    Join(Operation, Vec<Flat>),
    Transformed(Affine, Flat),
}

/// Arena of all plane regions of a file.
#[derive(Clone, Debug, Default)]
pub(super) struct Flats {
    nodes: Vec<Node>,
    /// True if discs are divided as in OpenSCAD.
    pub facets: bool,
    /// For regions that are the sum of a region and a disc: that region and the radius.
    grown: HashMap<Flat, (Flat, f64)>,
    /// Set when a disc is approximated by chords; the reader resets it after each item.
    pub has_chords: Cell<bool>,
}

/// A pending step of a traversal of a region.
enum Task {
    Visit(Flat, Affine),
    Join(Operation, usize),
}

impl Flats {
    pub fn new(facets: bool) -> Flats {
        Flats { facets, ..Flats::default() }
    }

    fn add(&mut self, node: Node) -> Flat {
        self.nodes.push(node);
        Flat(self.nodes.len() as u32 - 1)
    }

    pub fn leaf(&mut self, leaf: Leaf) -> Flat {
        self.add(Node::Leaf(leaf))
    }

    pub fn join(&mut self, operation: Operation, operands: Vec<Flat>) -> Flat {
        self.add(Node::Join(operation, operands))
    }

    /// The region and the radius of the disc whose sum is the given region, if known.
    pub fn grown(&self, flat: Flat) -> Option<(Flat, f64)> {
        self.grown.get(&flat).copied()
    }

    pub fn set_grown(&mut self, flat: Flat, original: Flat, by: f64) {
        self.grown.insert(flat, (original, by));
    }

    /// A region under a plane map.
    pub fn transformed(&mut self, map: Affine, flat: Flat) -> Flat {
        self.add(Node::Transformed(map, flat))
    }

    /// Folds the boolean tree: `make` converts each mapped leaf, `join` combines the results.
    pub fn fold<T>(
        &self,
        arguments: &Arguments,
        root: Flat,
        mut make: impl FnMut(&Leaf, &Affine) -> Result<T, Refusal>,
        mut join: impl FnMut(Operation, Vec<T>) -> Result<T, Refusal>,
    ) -> Result<T, Refusal> {
        let mut tasks = vec![Task::Visit(root, Affine::IDENTITY)];
        let mut made = Vec::new();
        while let Some(task) = tasks.pop() {
            // regions may share parts, which are visited once per use
            arguments.spend(100)?;
            match task {
                Task::Visit(flat, map) => match &self.nodes[flat.0 as usize] {
                    Node::Leaf(leaf) => {
                        arguments.spend(20 * leaf.point_count())?;
                        made.push(make(leaf, &map)?);
                    }
                    Node::Transformed(inner, flat) => tasks.push(Task::Visit(*flat, inner.then(&map))),
                    Node::Join(operation, flats) => {
                        tasks.push(Task::Join(*operation, flats.len()));
                        tasks.extend(flats.iter().rev().map(|flat| Task::Visit(*flat, map)));
                    }
                },
                Task::Join(operation, count) => {
                    let operands = made.split_off(made.len() - count.min(made.len()));
                    made.push(join(operation, operands)?);
                }
            }
        }
        // the first task produced the only remaining result
        Ok(made.swap_remove(0))
    }

    /// Bounding box of the leaves of the region: lo, hi.
    pub fn bounds(&self, arguments: &Arguments, flat: Flat) -> Result<[Point; 2], Refusal> {
        self.fold(
            arguments,
            flat,
            |leaf, map| Ok(leaf.bounds(map)),
            |operation, all| {
                Ok(match operation {
                    Operation::Union => all.into_iter().fold(NOWHERE, hull),
                    Operation::Intersection => all.into_iter().fold(EVERYWHERE, overlap),
                    Operation::Difference => all.first().copied().unwrap_or(NOWHERE),
                })
            },
        )
    }

    /// True if the region is a union of its leaves; its convex hull is then the hull of the leaves.
    pub fn is_union(&self, arguments: &Arguments, flat: Flat) -> Result<bool, Refusal> {
        let is_union =
            |operation, parts: Vec<bool>| Ok(operation == Operation::Union && parts.iter().all(|part| *part));
        self.fold(arguments, flat, |_, _| Ok(true), is_union)
    }
}

type Box2 = [Point; 2];

pub(super) const NOWHERE: Box2 = [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]];
const EVERYWHERE: Box2 = [[f64::NEG_INFINITY; 2], [f64::INFINITY; 2]];

pub(super) fn hull(a: Box2, b: Box2) -> Box2 {
    [[0, 1].map(|k| a[0][k].min(b[0][k])), [0, 1].map(|k| a[1][k].max(b[1][k]))]
}

fn overlap(a: Box2, b: Box2) -> Box2 {
    [[0, 1].map(|k| a[0][k].max(b[0][k])), [0, 1].map(|k| a[1][k].min(b[1][k]))]
}

/// The image of a plane point.
pub(super) fn image(map: &Affine, p: Point) -> Point {
    let q = map.point(Vec3::new(p[0], p[1], 0.0));
    [q.x, q.y]
}

impl Leaf {
    pub fn bounds(&self, map: &Affine) -> Box2 {
        match self {
            Leaf::Outline(contours) => {
                let points = contours.iter().flatten().map(|p| image(map, *p));
                points.fold(NOWHERE, |bounds, p| hull(bounds, [p, p]))
            }
            Leaf::Disc { radius, .. } => {
                let centre = [map.translation.x, map.translation.y];
                let reach = [0, 1].map(|k| radius * libm::hypot(map.linear.x_axis[k], map.linear.y_axis[k]));
                [[0, 1].map(|k| centre[k] - reach[k]), [0, 1].map(|k| centre[k] + reach[k])]
            }
        }
    }

    /// Number of points of the contours.
    pub fn point_count(&self) -> usize {
        match self {
            Leaf::Outline(contours) => contours.iter().map(Vec::len).sum(),
            Leaf::Disc { fragments, .. } => *fragments,
        }
    }

    /// Contours of the leaf; a disc has the facets of OpenSCAD.
    pub fn contours(&self) -> Vec<Vec<Point>> {
        match self {
            Leaf::Outline(contours) => contours.clone(),
            Leaf::Disc { radius, fragments } => {
                let corner = |k: usize| direction(k as f64, *fragments).map(|x| radius * x);
                vec![(0..*fragments).map(corner).collect()]
            }
        }
    }
}

/// A single contour of either orientation as a region; `None` if its area is zero.
pub(super) fn simple(arguments: &Arguments, mut contour: Vec<Point>) -> Result<Option<Polygons>, Refusal> {
    let mut found = from_polygons(&[&contour], Side::Outside);
    if let Err(PolygonError::Orientation { .. }) = found {
        contour.reverse();
        found = from_polygons(&[&contour], Side::Outside);
    }
    match found {
        Ok(polygons) => Ok((polygons.edge_count() > 0).then_some(polygons)),
        Err(error) => Err(arguments.refusal(&format!("its outline is not simple: {error}"))),
    }
}

/// `square(size, center)`: `None` if it has no area.
pub(super) fn square(arguments: &Arguments) -> Result<Option<Leaf>, Refusal> {
    let size: [f64; 2] = arguments.point("size", 1.0)?;
    if size[0] <= 0.0 || size[1] <= 0.0 {
        return Ok(None);
    }
    let lo = if arguments.boolean("center", false)? { size.map(|x| -0.5 * x) } else { [0.0; 2] };
    let hi = [lo[0] + size[0], lo[1] + size[1]];
    Ok(Some(Leaf::Outline(vec![vec![lo, [hi[0], lo[1]], hi, [lo[0], hi[1]]]])))
}

/// `circle(r)`: `None` if it has no area.
pub(super) fn circle(arguments: &Arguments, facets: bool) -> Result<Option<Leaf>, Refusal> {
    let radius = arguments.number("r", 1.0)?;
    if radius <= 0.0 {
        return Ok(None);
    }
    let disc = Leaf::Disc { radius, fragments: Fineness::of(arguments)?.fragments(radius) };
    Ok(Some(if facets { Leaf::Outline(disc.contours()) } else { disc }))
}

/// `polygon(points, paths)`, filled by the even-odd rule; without paths all points form one path.
pub(super) fn polygon(arguments: &Arguments) -> Result<Option<Leaf>, Refusal> {
    let points = arguments.get("points", "a list of points (x, y), all finite", points)?.unwrap_or_default();
    let paths = arguments.get("paths", "a list of lists of point indices", paths)?;
    let contours = match paths {
        Some(paths) if !paths.is_empty() => {
            let point = |number: &usize| {
                let reason = || {
                    arguments
                        .refusal(&format!("a path refers to point {number}, but there are {}", points.len()))
                };
                points.get(*number).copied().ok_or_else(reason)
            };
            let contour = |path: &Vec<usize>| path.iter().map(point).collect::<Result<Vec<_>, _>>();
            paths.iter().map(contour).collect::<Result<Vec<_>, _>>()?
        }
        _ => vec![points],
    };
    Ok(Some(Leaf::Outline(contours)))
}

fn points(value: &Value) -> Option<Vec<Point>> {
    value.list()?.iter().map(finite).collect()
}

/// Lists of vertex indices; a single flat list is one path.
fn paths(value: &Value) -> Option<Vec<Vec<usize>>> {
    let path = |value: &Value| value.numbers()?.into_iter().map(index).collect::<Option<Vec<usize>>>();
    match value.list()?.first() {
        Some(Value::Number(_)) => Some(vec![path(value)?]),
        _ => value.list()?.iter().map(path).collect(),
    }
}

/// Converts a number to a point index.
pub(super) fn index(number: f64) -> Option<usize> {
    ((0.0..4e9).contains(&number) && number.fract() == 0.0).then_some(number as usize)
}
