//! Folds over the boolean tree below a node, with the shells of its leaves.

use super::arguments::{Arguments, Refusal};
use super::extent::Way;
use super::facets::sphere_rings;
use super::flat::Flat;
use super::mesh::{self, Twist};
use super::operation::Operation;
use super::primitive::CylinderSizes;
use super::region::{Contours, boundary};
use super::sector::{Sectors, profile, round};
use super::shell::Shell;
use super::state::Reader;
use super::{gather, transform};
use crate::kernel::triangulated;
use rayweave_math::Affine;

/// Maximum number of triangles of a node; more take too long.
const MAX_TRIANGLES: usize = 500_000;

/// Items that are the union of their children, up to a map.
const JOINED: [&str; 6] = ["group", "union", "render", "color", "multmatrix", "resize"];

/// A pending step of a traversal.
enum Task {
    Visit(usize, Affine),
    Join(Operation, usize),
}

/// Start of a traversal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Start {
    /// Start at a node.
    Item(usize),
    /// Start at the union of the children of a node, regardless of its operation.
    Below(usize),
}

impl Start {
    pub fn number(self) -> usize {
        match self {
            Start::Item(number) | Start::Below(number) => number,
        }
    }
}

/// Folds the boolean tree below `from`: `make` converts the shells of each leaf, `join` combines the results.
pub(super) fn fold<T>(
    reader: &Reader,
    from: Start,
    mut make: impl FnMut(&Arguments, &[Shell], &Affine) -> Result<T, Refusal>,
    mut join: impl FnMut(Operation, Vec<T>) -> Result<T, Refusal>,
) -> Result<T, Refusal> {
    let mut tasks = vec![Task::Visit(from.number(), Affine::IDENTITY)];
    let mut made = Vec::new();
    while let Some(task) = tasks.pop() {
        let (number, map) = match task {
            Task::Join(operation, count) => {
                let operands = made.split_off(made.len() - count.min(made.len()));
                made.push(join(operation, operands)?);
                continue;
            }
            Task::Visit(number, map) => (number, map),
        };
        let node = &reader.tree.nodes[number];
        let arguments = reader.arguments(number);
        arguments.spend(100)?;
        let is_known = from != Start::Below(number) && reader.is_known(number);
        let structure = if is_known { None } else { structure(reader, number, from, &arguments)? };
        match structure {
            Some((operation, inner)) => {
                let children: Vec<usize> =
                    node.children.iter().map(|k| *k as usize).filter(|k| reader.live[*k]).collect();
                tasks.push(Task::Join(operation, children.len()));
                let map = inner.then(&map);
                tasks.extend(children.into_iter().rev().map(|child| Task::Visit(child, map)));
            }
            None => {
                let shells = shells(reader, number, &arguments)?;
                let triangles = shells.iter().map(|shell| shell.triangles.len()).sum::<usize>();
                arguments.spend(300 * triangles)?;
                if triangles > MAX_TRIANGLES {
                    return Err(arguments.refusal(&format!("it has more than {MAX_TRIANGLES} facets")));
                }
                made.push(make(&arguments, &shells, &map)?);
            }
        }
    }
    // the first task produced the only remaining result
    made.pop().ok_or_else(|| reader.arguments(from.number()).refusal("it is empty"))
}

/// Boolean operation and map of the children of a node; `None` for nodes that have their own shells.
fn structure(
    reader: &Reader,
    number: usize,
    from: Start,
    arguments: &Arguments,
) -> Result<Option<(Operation, Affine)>, Refusal> {
    let name = reader.tree.nodes[number].name.as_str();
    let map = match name {
        "multmatrix" => transform::matrix(arguments)?,
        "resize" if from != Start::Below(number) => {
            reader.resized.get(&number).copied().unwrap_or(Affine::IDENTITY)
        }
        _ => Affine::IDENTITY,
    };
    let operation = match name {
        name if JOINED.contains(&name) => Operation::Union,
        "difference" => Operation::Difference,
        "intersection" => Operation::Intersection,
        // the node itself is not applied to its children
        _ if from == Start::Below(number) => Operation::Union,
        _ => return Ok(None),
    };
    Ok(Some((operation, map)))
}

/// Differences and intersections below `from` that occur elsewhere, too, and are not yet known; none of them contains another one.
pub(super) fn repeated(reader: &Reader, from: Start) -> Vec<usize> {
    let (mut waiting, mut found) = (vec![from.number()], Vec::new());
    while let Some(number) = waiting.pop() {
        let node = &reader.tree.nodes[number];
        let is_inner = Start::Item(number) != from && Start::Below(number) != from;
        let is_boolean = matches!(node.name.as_str(), "difference" | "intersection");
        match () {
            () if is_inner && reader.is_known(number) => {}
            () if is_inner && is_boolean && reader.shared().is_repeated(number) => found.push(number),
            () if from == Start::Below(number) || is_boolean || JOINED.contains(&node.name.as_str()) => {
                let children = node.children.iter().map(|child| *child as usize);
                waiting.extend(children.filter(|child| reader.live[*child]));
            }
            () => {}
        }
    }
    // the order of the text
    found.sort_unstable();
    found
}

/// True if there is no difference or intersection below a node.
pub(super) fn is_union(reader: &Reader, root: usize) -> Result<bool, Refusal> {
    fold(
        reader,
        Start::Below(root),
        |_, _, _| Ok(true),
        |operation, parts| {
            Ok((operation == Operation::Union || parts.len() < 2) && parts.iter().all(|part| *part))
        },
    )
}

/// The shells whose union a node is.
fn shells(reader: &Reader, number: usize, arguments: &Arguments) -> Result<Vec<Shell>, Refusal> {
    if let Some(known) = reader.shells.get(&number) {
        arguments.spend(50 * known.iter().map(|shell| shell.triangles.len()).sum::<usize>())?;
        return Ok(known.clone());
    }
    if let Some(known) = reader.shared.get().and_then(|shared| shared.shell(number)) {
        arguments.spend(50 * known.triangles.len())?;
        return Ok(vec![known]);
    }
    let fragments = |radius: f64| round(reader, arguments, radius);
    let rings = |rings: &[[f64; 2]], fragments| {
        let (vertices, triangles) = mesh::between_rings(rings, fragments);
        vec![Shell { vertices, triangles, is_convex: true }]
    };
    Ok(match reader.tree.nodes[number].name.as_str() {
        "cube" => vec![Shell::hull(arguments, gather::cube(arguments)?)?],
        "sphere" => {
            let radius = arguments.number("r", 1.0)?;
            let fragments = fragments(radius)?;
            arguments.spend(100 * fragments * fragments)?;
            if radius > 0.0 { rings(&sphere_rings(radius, fragments), fragments) } else { Vec::new() }
        }
        "cylinder" => match CylinderSizes::of(arguments)? {
            Some(sizes) => rings(&sizes.rings(), fragments(sizes.largest())?),
            None => Vec::new(),
        },
        "polyhedron" => {
            let (vertices, triangles) = mesh::parts(arguments)?;
            let triangles = triangles.into_iter().map(|corners| corners.map(|k| k as u32)).collect();
            vec![Shell { vertices, triangles, is_convex: false }]
        }
        "linear_extrude" => match (Way::of(arguments)?, reader.extruded.get(&number)) {
            (Some(way), Some(flat)) => {
                let twist = Twist::new(arguments, &reader.flats, *flat, &way)?;
                vec![twist.shell(arguments, boundary(arguments, &reader.flats, *flat)?)?]
            }
            _ => Vec::new(),
        },
        "rotate_extrude" => match reader.extruded.get(&number) {
            Some(flat) => vec![turned_region(reader, arguments, *flat)?],
            None => Vec::new(),
        },
        _ => return Err(arguments.refusal("its boundary is unknown")),
    })
}

/// The facets of a `rotate_extrude` of a region, which may touch each other only if the region touches itself.
pub(super) fn turned_region(reader: &Reader, arguments: &Arguments, flat: Flat) -> Result<Shell, Refusal> {
    let contours = profile(reader, arguments, flat)?;
    let sectors = Sectors::of(reader, arguments, &contours)?;
    turned(arguments, &contours, &sectors)
}

/// Contours revolved about the z axis.
fn turned(arguments: &Arguments, contours: &Contours, sectors: &Sectors) -> Result<Shell, Refusal> {
    let (steps, is_whole) = (sectors.count, sectors.is_whole);
    let rings = if is_whole { steps } else { steps + 1 };
    let n = contours.iter().map(Vec::len).sum::<usize>();
    if n.saturating_mul(2 * rings) > MAX_TRIANGLES {
        return Err(arguments.refusal(&format!("it has more than {MAX_TRIANGLES} facets")));
    }
    arguments.spend(100 * n * rings)?;
    let ring = |k: usize| contours.iter().flatten().map(move |p| sectors.point(k, *p));
    let n = n as u32;
    let mut triangles = Vec::new();
    for k in 0..steps as u32 {
        let [a, b] = [k * n, (k + 1) % rings as u32 * n];
        for [i, j] in edges(contours) {
            triangles.extend([[a + i, b + i, b + j], [a + i, b + j, a + j]]);
        }
    }
    if !is_whole {
        let last = steps as u32 * n;
        let ends = triangulated(contours);
        triangles.extend(ends.iter().flat_map(|t| [*t, [last + t[0], last + t[2], last + t[1]]]));
    }
    Ok(Shell { vertices: (0..rings).flat_map(ring).collect(), triangles, is_convex: false })
}

/// Edges of contours, with the points of all contours numbered in sequence.
pub(super) fn edges(contours: &Contours) -> impl Iterator<Item = [u32; 2]> {
    let mut start = 0;
    contours.iter().flat_map(move |contour| {
        let (first, n) = (start, contour.len() as u32);
        start += n;
        (0..n).map(move |k| [first + k, first + (k + 1) % n])
    })
}
