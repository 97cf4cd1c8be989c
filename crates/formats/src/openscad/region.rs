//! Polygon booleans, offsets and Minkowski sums of plane regions given by their boundaries.
//!
//! The booleans are those of the crate `i_overlay`, which rounds points to a grid of 2^-50 of the drawing or finer.

use super::arguments::{Arguments, Refusal};
use super::budget::{Budget, CROSSING, EDGE, Exceeded};
use super::drawing::chords;
use super::flat::{Flat, Flats, Leaf, NOWHERE, hull, image};
use super::operation::Operation;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::simplify::SimplifyShape;
use i_overlay::float::single::SingleFloatOverlay;
use rayweave_math::Affine;
use rayweave_polygon::Point;
use std::f64::consts::TAU;

/// Closed chains of points.
pub(super) type Contours = Vec<Vec<Point>>;

/// Maximum number of points of a region; more take too long.
const MAX_POINTS: usize = 2_000_000;

/// Largest coordinate: `i_overlay` accepts none beyond 2^500.
const FARTHEST: f64 = 1e150;

/// Grid of `i_overlay`, relative to the size of its input.
const GRID: f64 = 1.0 / (1u64 << 50) as f64;

/// The region inside contours according to a fill rule: counter-clockwise outlines and clockwise holes that do not cross.
pub(super) fn filled(
    arguments: &Arguments,
    contours: &Contours,
    rule: FillRule,
) -> Result<Contours, Refusal> {
    check_near(arguments, contours)?;
    arguments.limited(filled_near(arguments.budget(), contours, rule))
}

/// [`filled`] for contours that pass [`is_near`].
pub(super) fn filled_near(
    budget: &Budget,
    contours: &Contours,
    rule: FillRule,
) -> Result<Contours, Exceeded> {
    if contours.iter().all(|contour| contour.len() < 3) {
        return Ok(Vec::new());
    }
    count_crossings(budget, contours.iter())?;
    Ok(contours.simplify_shape_as::<i64>(rule).into_iter().flatten().collect())
}

/// Counts the cost of a boolean of regions: their edges, and the pairs of edges that cross, whose number may be
/// quadratic. A grid shows whether there can be many pairs; if so, a sweep along an axis finds them.
fn count_crossings<'c>(
    budget: &Budget,
    contours: impl Iterator<Item = &'c Vec<Point>>,
) -> Result<(), Exceeded> {
    let mut edges: Vec<[Point; 2]> = contours.flat_map(|contour| edges_of(contour)).collect();
    budget.spend(edges.len().saturating_mul(EDGE))?;
    if let Some(pairs) = pairs_in_cells(&edges) {
        return budget.spend(10 * pairs);
    }
    let [x, y] = [0, 1].map(|axis| {
        let [lo, hi] = range(&edges, axis);
        edges.iter().map(|[p, q]| (p[axis] - q[axis]).abs()).sum::<f64>() / (hi - lo)
    });
    // along the axis on which the edges overlap less
    let (along, across) = if x <= y { (0, 1) } else { (1, 0) };
    let span = |[p, q]: &[Point; 2], axis: usize| [p[axis].min(q[axis]), p[axis].max(q[axis])];
    edges.sort_unstable_by(|a, b| span(a, along)[0].total_cmp(&span(b, along)[0]));
    for (k, edge) in edges.iter().enumerate() {
        let (end, [lo, hi]) = (span(edge, along)[1], span(edge, across));
        let (mut passed, mut crossed) = (0, 0);
        for other in edges[k + 1..].iter().take_while(|other| span(other, along)[0] <= end) {
            passed += 1;
            let [low, high] = span(other, across);
            crossed += usize::from(low <= hi && lo <= high && may_cross(edge, other));
        }
        budget.spend(passed + CROSSING * crossed)?;
    }
    Ok(())
}

/// Lowest and highest coordinate of edges.
fn range(edges: &[[Point; 2]], axis: usize) -> [f64; 2] {
    let ends = edges.iter().flatten().map(|p| p[axis]);
    ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], x| [lo.min(x), hi.max(x)])
}

/// Number of pairs of edges in the cells of a grid with about as many cells as edges; `None` if edges are longer than a few
/// cells, or if the pairs are many.
fn pairs_in_cells(edges: &[[Point; 2]]) -> Option<usize> {
    const MAX_CELLS: usize = 9;
    const MAX_PAIRS: usize = 30;
    let side = edges.len().isqrt().clamp(1, 1000);
    let ranges = [range(edges, 0), range(edges, 1)];
    let cell = |p: &Point, axis: usize| {
        let [lo, hi] = ranges[axis];
        (((p[axis] - lo) / (hi - lo) * side as f64) as usize).min(side - 1)
    };
    let mut counts = vec![0usize; side * side];
    for [p, q] in edges {
        let [[x, x_end], [y, y_end]] = [0, 1].map(|axis| {
            let ends = [cell(p, axis), cell(q, axis)];
            [ends[0].min(ends[1]), ends[0].max(ends[1])]
        });
        if (x_end - x + 1) * (y_end - y + 1) > MAX_CELLS {
            return None;
        }
        for row in y..=y_end {
            counts[row * side + x..=row * side + x_end].iter_mut().for_each(|count| *count += 1);
        }
    }
    let pairs = counts.iter().map(|count| count * count.saturating_sub(1) / 2).sum::<usize>();
    Some(pairs).filter(|pairs| *pairs <= MAX_PAIRS * edges.len())
}

/// Counts the cost of stroking a chain of points: its pieces overlap where edges are near each other.
pub(super) fn count_near(budget: &Budget, chain: &[Point], width: f64) -> Result<(), Exceeded> {
    budget.spend(chain.len().saturating_mul(10 * EDGE))?;
    let mut boxes: Vec<[Point; 2]> = chain
        .windows(2)
        .map(|pair| [[0, 1].map(|k| pair[0][k].min(pair[1][k])), [0, 1].map(|k| pair[0][k].max(pair[1][k]))])
        .collect();
    let extent = |axis: usize| {
        let range = boxes.iter().map(|[lo, hi]| hi[axis] - lo[axis] + width).sum::<f64>();
        let all = boxes.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], [lo, hi]| {
            [low.min(lo[axis]), high.max(hi[axis])]
        });
        range / (all[1] - all[0])
    };
    let (along, across) = if extent(0) <= extent(1) { (0, 1) } else { (1, 0) };
    boxes.sort_unstable_by(|a, b| a[0][along].total_cmp(&b[0][along]));
    for (k, [lo, hi]) in boxes.iter().enumerate() {
        let (mut passed, mut near) = (0, 0);
        for [low, high] in boxes[k + 1..].iter().take_while(|other| other[0][along] <= hi[along] + width) {
            passed += 1;
            near += usize::from(low[across] <= hi[across] + width && lo[across] <= high[across] + width);
        }
        budget.spend(passed + CROSSING * near)?;
    }
    Ok(())
}

/// True if two edges cross or touch each other, apart from common ends and up to rounding.
fn may_cross([p, q]: &[Point; 2], [r, s]: &[Point; 2]) -> bool {
    if p == r || p == s || q == r || q == s {
        return false;
    }
    let turn =
        |a: &Point, b: &Point, c: &Point| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    turn(p, q, r) * turn(p, q, s) <= 0.0 && turn(r, s, p) * turn(r, s, q) <= 0.0
}

/// Boolean of regions without crossings.
pub(super) fn join_contours(
    arguments: &Arguments,
    operation: Operation,
    operands: Vec<Contours>,
) -> Result<Contours, Refusal> {
    let budget = arguments.budget();
    let united =
        |all: Vec<Contours>| arguments.limited(filled_near(budget, &all.concat(), FillRule::NonZero));
    let rule = match operation {
        Operation::Union => return united(operands),
        Operation::Difference => OverlayRule::Difference,
        Operation::Intersection => OverlayRule::Intersect,
    };
    let mut operands = operands.into_iter();
    let mut first = operands.next().unwrap_or_default();
    if operation == Operation::Difference {
        let others = united(operands.collect())?;
        return arguments.limited(overlaid(budget, &first, &others, rule));
    }
    for other in operands {
        first = arguments.limited(overlaid(budget, &first, &other, rule))?;
    }
    Ok(first)
}

fn overlaid(budget: &Budget, a: &Contours, b: &Contours, rule: OverlayRule) -> Result<Contours, Exceeded> {
    count_crossings(budget, a.iter().chain(b))?;
    Ok(a.overlay_as::<i64>(b, rule, FillRule::NonZero).into_iter().flatten().collect())
}

/// Boundary of a region. Discs have their facets or, if they are exact, chords; this sets `Flats::has_chords`.
pub(super) fn boundary(arguments: &Arguments, flats: &Flats, flat: Flat) -> Result<Contours, Refusal> {
    let is_fine = !flats.facets;
    boundary_of(arguments, flats, flat, is_fine)
}

/// Boundary of a region in which all discs have the facets of OpenSCAD.
pub(super) fn faceted_boundary(
    arguments: &Arguments,
    flats: &Flats,
    flat: Flat,
) -> Result<Contours, Refusal> {
    boundary_of(arguments, flats, flat, false)
}

fn boundary_of(arguments: &Arguments, flats: &Flats, flat: Flat, is_fine: bool) -> Result<Contours, Refusal> {
    let mut points = 0;
    let size = size_of_leaves(arguments, flats, flat)?;
    let spacing = leaf_spacing(size);
    let outline = |leaf: &Leaf, map: &Affine| {
        let contours = match leaf {
            Leaf::Disc { radius, fragments } if is_fine => {
                flats.has_chords.set(true);
                Leaf::Disc { radius: *radius, fragments: chords(360.0).max(*fragments) }.contours()
            }
            leaf => leaf.contours(),
        };
        points += contours.iter().map(Vec::len).sum::<usize>();
        if points > MAX_POINTS {
            return Err(arguments.refusal(&format!("its outline has more than {MAX_POINTS} points")));
        }
        let mut contours = filled(arguments, &placed(arguments, contours, map, size)?, FillRule::EvenOdd)?;
        if let Some(spacing) = spacing {
            contours.iter_mut().flatten().flatten().for_each(|x| *x = libm::rint(*x / spacing) * spacing);
        }
        Ok(contours)
    };
    let join = |operation, parts| join_contours(arguments, operation, parts);
    flats.fold(arguments, flat, outline, join)
}

/// Spacing of the common grid, relative to the size of the drawing: far above the rounding error of the coordinates of one
/// leaf, so that vertices shared by two leaves stay equal. Without it, a slit of the size of a rounding error would separate
/// touching leaves.
const LEAF_GRID: f64 = 1.0 / (1u64 << 40) as f64;

/// Spacing of the common grid of the leaves of a drawing of the given size: a power of 2, so that neither division nor
/// multiplication by it is rounded. `None` for drawings without extent, or with a size near the limits of `f64`.
fn leaf_spacing(size: f64) -> Option<f64> {
    let spacing = libm::exp2(libm::ceil(libm::log2(size))) * LEAF_GRID;
    spacing.is_normal().then_some(spacing)
}

/// Larger side of the bounding box of all leaves, including subtracted ones.
pub(super) fn size_of_leaves(arguments: &Arguments, flats: &Flats, flat: Flat) -> Result<f64, Refusal> {
    let hull = |_, all: Vec<[Point; 2]>| Ok(all.into_iter().fold(NOWHERE, hull));
    let [lo, hi] = flats.fold(arguments, flat, |leaf, map| Ok(leaf.bounds(map)), hull)?;
    Ok((hi[0] - lo[0]).max(hi[1] - lo[1]))
}

/// Contours of a mapped leaf, in a drawing of the given size; refused if they are too far out, or if rounding removes one.
pub(super) fn placed(
    arguments: &Arguments,
    mut contours: Contours,
    map: &Affine,
    size: f64,
) -> Result<Contours, Refusal> {
    for contour in &mut contours {
        let (_, is_sure) = width(contour);
        contour.iter_mut().for_each(|p| *p = image(map, *p));
        check_near(arguments, std::slice::from_ref(contour))?;
        if is_sure && width(contour).0 < GRID * size {
            let why = "its outline is too thin relative to the size of the drawing: rounding would remove it";
            return Err(arguments.refusal(why));
        }
    }
    Ok(contours)
}

/// Largest distance of the points from the line through the first point and the one farthest from it, and whether that
/// exceeds the rounding errors of decimal numbers and of products, i.e. whether the points are certainly not collinear.
fn width(points: &[Point]) -> (f64, bool) {
    let Some(&first) = points.first() else { return (0.0, false) };
    let from_first = |p: &Point| [p[0] - first[0], p[1] - first[1]];
    let length = |p: &Point| libm::hypot(from_first(p)[0], from_first(p)[1]);
    let far = points.iter().copied().max_by(|p, q| length(p).total_cmp(&length(q))).unwrap_or(first);
    let [x, y] = from_first(&far);
    let across = |p: &Point| (x * from_first(p)[1] - y * from_first(p)[0]).abs();
    // coordinates, their differences, the products and the difference of those each have a relative error of u
    let sum = |p: &Point, k: usize| p[k].abs() + first[k].abs();
    let off = |p: &Point| 4.0 * f64::EPSILON * (sum(&far, 0) * sum(p, 1) + sum(&far, 1) * sum(p, 0));
    let width = points.iter().map(across).fold(0.0, f64::max) / length(&far);
    (width, points.iter().any(|p| across(p) > off(p)))
}

/// True if all points are within the range of `i_overlay`, which panics beyond it.
pub(super) fn is_near(contours: &[Vec<Point>]) -> bool {
    contours.iter().flatten().flatten().all(|x| x.abs() < FARTHEST)
}

/// Refuses contours that do not pass [`is_near`].
pub(super) fn check_near(arguments: &Arguments, contours: &[Vec<Point>]) -> Result<(), Refusal> {
    match is_near(contours) {
        true => Ok(()),
        false => Err(arguments.refusal("its points are too far out")),
    }
}

/// Mitre limit: corners whose edges turn by nearly 180 degrees are cut off. The value is 1 + the cosine of the turn, for a
/// mitre length of 10^6 times the distance.
const SHARPEST: f64 = 2e-12;

/// Join type at a corner that is convex towards the offset side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Corner {
    /// Mitre: both edges are extended until they intersect.
    Sharp,
    /// Chamfer: cut across the bisector at the offset distance.
    Cut,
    /// Arc, with the number of pieces of a full turn.
    Round(usize),
}

/// Polygon offset, inward for a negative distance: every edge is moved, and the points with a positive winding number are
/// kept. Mitres are limited to a million times the distance, as in OpenSCAD.
///
/// *Source*: X. Chen, S. McMains, "Polygon offsetting by computing winding numbers", ASME 2005; A. Johnson, *Clipper* 6.
pub(super) fn offset(
    arguments: &Arguments,
    contours: &Contours,
    by: f64,
    corner: Corner,
) -> Result<Contours, Refusal> {
    let moved: Contours = contours.iter().map(|contour| moved(contour, by, corner)).collect();
    filled(arguments, &moved, FillRule::Positive)
}

/// A contour with its edges moved to the right.
fn moved(contour: &[Point], by: f64, corner: Corner) -> Vec<Point> {
    let mut contour = contour.to_vec();
    contour.dedup();
    let n = contour.len();
    if n < 3 {
        return Vec::new();
    }
    let normal = |k: usize| {
        let (p, q) = (contour[k % n], contour[(k + 1) % n]);
        let [x, y] = [q[0] - p[0], q[1] - p[1]];
        let length = libm::hypot(x, y);
        [y / length, -x / length]
    };
    let mut points = Vec::with_capacity(2 * n);
    for k in 0..n {
        let before = normal(k + n - 1);
        around(contour[k], before, normal(k), by, corner, &mut points);
    }
    points.retain(|p| p[0].is_finite() && p[1].is_finite());
    points
}

/// Adds the points that replace the corner `p` between edges with the normals `m` and `n`.
fn around(p: Point, m: Point, n: Point, by: f64, corner: Corner, points: &mut Vec<Point>) {
    let at = |u: Point, by: f64| [p[0] + by * u[0], p[1] + by * u[1]];
    let (sine, cosine) = (m[0] * n[1] - m[1] * n[0], m[0] * n[0] + m[1] * n[1]);
    if sine * by < 0.0 {
        // the moved edges cross: the detour via the corner gives the area between them the opposite winding
        points.extend([at(m, by), p, at(n, by)]);
        return;
    }
    match corner {
        Corner::Sharp if 1.0 + cosine > SHARPEST => {
            points.push(at([m[0] + n[0], m[1] + n[1]], by / (1.0 + cosine)));
        }
        Corner::Sharp | Corner::Cut => {
            // along both edges to the line across the bisector
            let along = by * libm::tan(0.25 * libm::atan2(sine, cosine));
            points.push([p[0] + by * m[0] - along * m[1], p[1] + by * m[1] + along * m[0]]);
            points.push([p[0] + by * n[0] + along * n[1], p[1] + by * n[1] - along * n[0]]);
        }
        Corner::Round(fragments) => {
            let step = TAU / fragments as f64;
            let angle = libm::atan2(sine, cosine);
            if angle.abs() < 0.75 * step {
                // a corner of a chain of chords: two points would double the corners at each of several nested offsets
                points.push(at([m[0] + n[0], m[1] + n[1]], by / (1.0 + cosine)));
                return;
            }
            let pieces = (angle.abs() / step).round().max(1.0) as usize;
            points.extend((0..pieces).map(|k| {
                let (sin, cos) = libm::sincos((k as f64 * step).copysign(angle));
                at([cos * m[0] - sin * m[1], sin * m[0] + cos * m[1]], by)
            }));
            points.push(at(n, by));
        }
    }
}

/// Minkowski sum of two regions. If the boundary of one does not intersect the mirror image of the other, a whole component
/// of one lies within the other, and one point of each component is enough.
pub(super) fn sum(arguments: &Arguments, a: &Contours, b: &Contours) -> Result<Contours, Refusal> {
    let edges = |contours: &Contours| contours.iter().map(Vec::len).sum::<usize>();
    if edges(a).saturating_mul(edges(b)) > MAX_POINTS / 4 {
        return Err(arguments.refusal(&format!("it has more than {} pairs of edges", MAX_POINTS / 4)));
    }
    let mut all = Contours::new();
    for [p, q] in a.iter().flat_map(|contour| edges_of(contour)) {
        for [r, s] in b.iter().flat_map(|contour| edges_of(contour)) {
            all.push(upright(vec![plus(p, r), plus(q, r), plus(q, s), plus(p, s)]));
        }
    }
    for (region, other) in [(a, b), (b, a)] {
        // holes are not components
        for first in other.iter().filter(|contour| area(contour) > 0.0).map(|contour| contour[0]) {
            all.extend(region.iter().map(|contour| contour.iter().map(|p| plus(*p, first)).collect()));
        }
    }
    // each contour is counter-clockwise, so that windings do not cancel
    filled(arguments, &all, FillRule::Positive)
}

fn plus(p: Point, q: Point) -> Point {
    [p[0] + q[0], p[1] + q[1]]
}

fn edges_of(contour: &[Point]) -> impl Iterator<Item = [Point; 2]> {
    (0..contour.len()).map(|k| [contour[k], contour[(k + 1) % contour.len()]])
}

/// Signed area of a contour, negative if clockwise.
pub(super) fn area(contour: &[Point]) -> f64 {
    0.5 * edges_of(contour).map(|[p, q]| p[0] * q[1] - p[1] * q[0]).sum::<f64>()
}

fn upright(mut contour: Vec<Point>) -> Vec<Point> {
    if area(&contour) < 0.0 {
        contour.reverse();
    }
    contour
}
