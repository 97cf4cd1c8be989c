//! Regions of the plane by their boundaries: booleans of polygons, and what is at a distance from them.
//!
//! The booleans are those of the crate `i_overlay`, which moves points to a grid of 2^-50 of the drawing or finer.

use super::arguments::{Arguments, Refusal};
use super::boolean::Operation;
use super::drawing::chords;
use super::flat::{Flat, Flats, Leaf, NOWHERE, hull, image};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::simplify::SimplifyShape;
use i_overlay::float::single::SingleFloatOverlay;
use rayweave_math::Affine;
use rayweave_space::Point;
use std::f64::consts::TAU;

/// Closed chains of points.
pub(super) type Contours = Vec<Vec<Point<2>>>;

/// More points than these take longer than a reader should.
const MOST_POINTS: usize = 2_000_000;

/// Points farther out than this cannot be told from infinity by what is done here: `i_overlay` takes none beyond 2^500.
const FARTHEST: f64 = 1e150;

/// The grid of `i_overlay` as a part of what it is given.
const GRID: f64 = 1.0 / (1u64 << 50) as f64;

/// What lies within contours by a rule, as outlines counter-clockwise and holes clockwise that do not cross.
pub(super) fn filled(
    arguments: &Arguments,
    contours: &Contours,
    rule: FillRule,
) -> Result<Contours, Refusal> {
    check_near(arguments, contours)?;
    Ok(filled_near(contours, rule))
}

/// [`filled`] of contours that are known to pass [`is_near`].
pub(super) fn filled_near(contours: &Contours, rule: FillRule) -> Contours {
    match contours.iter().all(|contour| contour.len() < 3) {
        true => Vec::new(),
        false => contours.simplify_shape_as::<i64>(rule).into_iter().flatten().collect(),
    }
}

/// Regions without crossings, joined into one of the same kind.
pub(super) fn join_contours(operation: Operation, operands: Vec<Contours>) -> Contours {
    let rule = match operation {
        Operation::Union => return filled_near(&operands.concat(), FillRule::NonZero),
        Operation::Difference => OverlayRule::Difference,
        Operation::Intersection => OverlayRule::Intersect,
    };
    let mut operands = operands.into_iter();
    let mut first = operands.next().unwrap_or_default();
    if operation == Operation::Difference {
        let others = filled_near(&operands.collect::<Vec<_>>().concat(), FillRule::NonZero);
        return overlaid(&first, &others, rule);
    }
    for other in operands {
        first = overlaid(&first, &other, rule);
    }
    first
}

fn overlaid(a: &Contours, b: &Contours, rule: OverlayRule) -> Contours {
    a.overlay_as::<i64>(b, rule, FillRule::NonZero).into_iter().flatten().collect()
}

/// The boundary of a region. Discs have their facets or, where they are truly round, chords: `Flats::has_chords` tells.
pub(super) fn boundary(arguments: &Arguments, flats: &Flats, flat: Flat) -> Result<Contours, Refusal> {
    let mut points = 0;
    let size = size_of_leaves(flats, flat)?;
    let outline = |leaf: &Leaf, map: &Affine| {
        let contours = match leaf {
            Leaf::Disc { radius, fragments } if !flats.facets => {
                flats.has_chords.set(true);
                Leaf::Disc { radius: *radius, fragments: chords(360.0).max(*fragments) }.contours()
            }
            leaf => leaf.contours(),
        };
        points += contours.iter().map(Vec::len).sum::<usize>();
        if points > MOST_POINTS {
            return Err(arguments.refusal(&format!("its outline has more than {MOST_POINTS} points")));
        }
        Ok(filled_near(&placed(arguments, contours, map, size)?, FillRule::EvenOdd))
    };
    flats.fold(flat, outline, join_contours)
}

/// The larger side of the box around all leaves, also those that are cut away.
pub(super) fn size_of_leaves(flats: &Flats, flat: Flat) -> Result<f64, Refusal> {
    let hull = |_, all: Vec<[Point<2>; 2]>| all.into_iter().fold(NOWHERE, hull);
    let [lo, hi] = flats.fold(flat, |leaf, map| Ok(leaf.bounds(map)), hull)?;
    Ok((hi[0] - lo[0]).max(hi[1] - lo[1]))
}

/// The contours of a leaf in their place, in a drawing of some size: refused if they are too far out, or if rounding loses one.
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
            let why = "its outline is too thin beside the size of the drawing: rounding loses it";
            return Err(arguments.refusal(why));
        }
    }
    Ok(contours)
}

/// How far points lie from the line through the first of them and the one farthest from it, and whether that is surely more than
/// the rounding of numbers in text and of products makes of points on a line.
fn width(points: &[Point<2>]) -> (f64, bool) {
    let Some(&first) = points.first() else { return (0.0, false) };
    let from_first = |p: &Point<2>| [p[0] - first[0], p[1] - first[1]];
    let length = |p: &Point<2>| libm::hypot(from_first(p)[0], from_first(p)[1]);
    let far = points.iter().copied().max_by(|p, q| length(p).total_cmp(&length(q))).unwrap_or(first);
    let [x, y] = from_first(&far);
    let across = |p: &Point<2>| (x * from_first(p)[1] - y * from_first(p)[0]).abs();
    // coordinates are off by u, their differences by u, and their products and the difference of them by u again
    let sum = |p: &Point<2>, k: usize| p[k].abs() + first[k].abs();
    let off = |p: &Point<2>| 4.0 * f64::EPSILON * (sum(&far, 0) * sum(p, 1) + sum(&far, 1) * sum(p, 0));
    let width = points.iter().map(across).fold(0.0, f64::max) / length(&far);
    (width, points.iter().any(|p| across(p) > off(p)))
}

/// True if no point is too far out for `i_overlay`, which panics there.
pub(super) fn is_near(contours: &[Vec<Point<2>>]) -> bool {
    contours.iter().flatten().flatten().all(|x| x.abs() < FARTHEST)
}

/// Refuses contours that do not pass [`is_near`].
pub(super) fn check_near(arguments: &Arguments, contours: &[Vec<Point<2>>]) -> Result<(), Refusal> {
    match is_near(contours) {
        true => Ok(()),
        false => Err(arguments.refusal("its points are too far out")),
    }
}

/// Corners whose edges turn by nearly 180 degrees are cut off: 1 + the cosine of the turn, for a reach of 10^6 times the distance.
const SHARPEST: f64 = 2e-12;

/// What a corner becomes that the boundary turns away from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Corner {
    /// Both edges go on until they meet.
    Sharp,
    /// Cut off across its bisector at the distance of the edges.
    Cut,
    /// An arc in pieces, so many of a full turn.
    Round(usize),
}

/// The region grown by a distance, or shrunk if it is negative: every edge is moved, and what is wound around once or more is
/// kept. Sharp corners reach at most a million times as far as the edges move, as in OpenSCAD.
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
fn moved(contour: &[Point<2>], by: f64, corner: Corner) -> Vec<Point<2>> {
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

/// The points that stand for the corner `p` between edges with the normals `m` and `n`.
fn around(p: Point<2>, m: Point<2>, n: Point<2>, by: f64, corner: Corner, points: &mut Vec<Point<2>>) {
    let at = |u: Point<2>, by: f64| [p[0] + by * u[0], p[1] + by * u[1]];
    let (sine, cosine) = (m[0] * n[1] - m[1] * n[0], m[0] * n[0] + m[1] * n[1]);
    if sine * by < 0.0 {
        // the moved edges cross: the way over the corner winds what is between them the other way round
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
            let pieces = (angle.abs() / step).round().max(1.0) as usize;
            points.extend((0..pieces).map(|k| {
                let (sin, cos) = libm::sincos((k as f64 * step).copysign(angle));
                at([cos * m[0] - sin * m[1], sin * m[0] + cos * m[1]], by)
            }));
            points.push(at(n, by));
        }
    }
}

/// The sum of two regions: every sum of a point of one and a point of the other. Where the boundary of one does not meet the
/// mirror image of the other, a whole component of one lies within the other, so that one of its points stands for it.
pub(super) fn sum(arguments: &Arguments, a: &Contours, b: &Contours) -> Result<Contours, Refusal> {
    let edges = |contours: &Contours| contours.iter().map(Vec::len).sum::<usize>();
    if edges(a).saturating_mul(edges(b)) > MOST_POINTS / 4 {
        return Err(arguments.refusal(&format!("it has more than {} pairs of edges", MOST_POINTS / 4)));
    }
    let mut all = Contours::new();
    for [p, q] in a.iter().flat_map(|contour| edges_of(contour)) {
        for [r, s] in b.iter().flat_map(|contour| edges_of(contour)) {
            all.push(upright(vec![plus(p, r), plus(q, r), plus(q, s), plus(p, s)]));
        }
    }
    for (region, other) in [(a, b), (b, a)] {
        // holes have no component of their own
        for first in other.iter().filter(|contour| area(contour) > 0.0).map(|contour| contour[0]) {
            all.extend(region.iter().map(|contour| contour.iter().map(|p| plus(*p, first)).collect()));
        }
    }
    // one by one counter-clockwise, so that nothing counts against another
    filled(arguments, &all, FillRule::Positive)
}

fn plus(p: Point<2>, q: Point<2>) -> Point<2> {
    [p[0] + q[0], p[1] + q[1]]
}

fn edges_of(contour: &[Point<2>]) -> impl Iterator<Item = [Point<2>; 2]> {
    (0..contour.len()).map(|k| [contour[k], contour[(k + 1) % contour.len()]])
}

/// The area that a contour goes round, negative if clockwise.
pub(super) fn area(contour: &[Point<2>]) -> f64 {
    0.5 * edges_of(contour).map(|[p, q]| p[0] * q[1] - p[1] * q[0]).sum::<f64>()
}

fn upright(mut contour: Vec<Point<2>>) -> Vec<Point<2>> {
    if area(&contour) < 0.0 {
        contour.reverse();
    }
    contour
}
