//! Boolean formulas of regions with many edges, by cells: cuts parallel to the axes divide the plane into rectangles, and each of
//! them has a formula of the edges that pass through it.
//!
//! In the formula of [`Polygons::fold`] every half-plane matters everywhere, so that a ray is intersected with all of them. In the
//! formula by cells a half-plane matters in its cell only: a bounding volume hierarchy finds the few that a ray can reach.
//!
//! Within a cell the edges form *pieces*: runs of edges joined at corners in the cell, which enter and leave it, or whole contours.
//! The first and last edge of a piece extend beyond the cell and never return, since it is convex. A piece therefore is a simple
//! chain in the sense of [`Polygons::fold`] if these extensions do not intersect each other; otherwise the cell is divided. Pieces do
//! not touch each other, so that the region within the cell is the set of points to the left of an odd number of pieces, or the
//! complement of that. One point of the cell with a computed side decides. Adjacent cells have a common line, so that cuts are no
//! boundary of the region.
//!
//! All decisions use exact signs; a point on an edge counts as moved by (e, e^2) for an infinitesimal e. Cells contain corners on
//! their lower sides and not those on their upper sides.

use crate::exact::orientation;
use crate::formula::{Chain, HalfPlane, Operator, cross};
use crate::{Point, Polygons};
use rayweave_rootray::Side;
use std::collections::BinaryHeap;

/// Regions with up to this number of edges have the formula of [`Polygons::fold`].
pub(crate) const MAX_EDGES: usize = 256;

/// Limits of the division into cells.
struct Limits {
    /// Regions with up to this number of edges are not divided.
    edges: usize,
    /// Cells with up to this number of edges are not divided further.
    few: usize,
    /// Cells with a longer piece are divided even if most edges pass through both parts. The depth of a formula grows with the number
    /// of edges of a piece in the worst case, teeth on the outside of an arc; the number of pieces does not matter.
    piece: usize,
    /// Division stops when the number of edges in all cells together exceeds this multiple of the number of edges: long edges close
    /// to each other pass through many cells.
    copies: usize,
}

const LIMITS: Limits = Limits { edges: MAX_EDGES, few: 8, piece: 16, copies: 6 };

/// Cells without a valid formula are divided up to this multiple of the number of edges.
const MAX_COPIES: usize = 64;

/// The margin of the first cell around the region, relative to the larger side.
const RELATIVE_MARGIN: f64 = 0.25;

/// The share of a cell without edges that makes a cell of its own.
const LARGE: f64 = 0.25;

/// A rectangle, and the edges that pass through it.
struct Cell {
    lo: Point,
    hi: Point,
    /// The edges, sorted.
    edges: Vec<u32>,
    /// A point in the cell, and its side.
    at: Point,
    is_inside: bool,
}

/// The formula of the region in a cell; constants have none.
enum Part<T> {
    Constant(bool),
    Formula(T),
}

/// A maximal run of edges in a cell.
struct Piece {
    chain: Chain,
    is_closed: bool,
}

impl Piece {
    fn fold<T>(
        &self,
        half_plane: &mut impl FnMut(&Chain, usize) -> T,
        join: &mut impl FnMut(Operator, Vec<T>) -> T,
    ) -> T {
        let half_plane = &mut |edge: usize| half_plane(&self.chain, edge);
        match self.is_closed {
            true => self.chain.fold_closed(half_plane, join),
            false => self.chain.fold_open(half_plane, join),
        }
    }

    /// The ends of the piece, if their extensions intersect.
    fn crossed_ends(&self) -> Option<[Point; 2]> {
        let p = &self.chain.points;
        let n = p.len();
        if self.is_closed || n < 4 {
            return None;
        }
        let (first, last) = ([p[1], p[0]], [p[n - 2], p[n - 1]]);
        let between = [p[1], p[n - 2]];
        let turn = cross(first, last);
        (turn != 0 && cross(between, last) == turn && cross(between, first) == turn).then_some(between)
    }
}

impl Polygons {
    /// Folds a boolean formula of the region like [`Polygons::fold`], for use with bounding volume hierarchies.
    ///
    /// For a region with few edges, and for an unbounded one, it is that formula. For others it is a union of intersections with
    /// cells, rectangles given by their smallest and largest coordinates, which `cell` converts. Edges have a half-plane for each
    /// cell that they pass through, on average at most 7. Sides of cells are no faces of the region.
    pub fn fold_by_cells<T>(
        &self,
        half_plane: impl FnMut(HalfPlane) -> T,
        cell: impl FnMut([Point; 2]) -> T,
        join: impl FnMut(Operator, Vec<T>) -> T,
    ) -> T {
        self.fold_within(&LIMITS, half_plane, cell, join)
    }

    fn fold_within<T>(
        &self,
        limits: &Limits,
        mut half_plane: impl FnMut(HalfPlane) -> T,
        mut cell: impl FnMut([Point; 2]) -> T,
        mut join: impl FnMut(Operator, Vec<T>) -> T,
    ) -> T {
        let Some(cells) = self.cells(limits) else { return self.fold(half_plane, join) };
        let mut half_plane = |chain: &Chain, edge: usize| half_plane(chain.half_plane(edge));
        let mut parts = Vec::new();
        for own in &cells {
            match self.formula_in(own, &mut half_plane, &mut join) {
                Part::Constant(false) => {}
                Part::Constant(true) => parts.push(cell([own.lo, own.hi])),
                // faces of the region come first: where one lies in a side of the cell, crossings are attributed to it
                Part::Formula(formula) => {
                    let both = vec![formula, cell([own.lo, own.hi])];
                    parts.push(join(Operator::Intersection, both));
                }
            }
        }
        join(Operator::Union, parts)
    }

    /// The cells; `None` if the region needs none or if they would have too many edges.
    fn cells(&self, limits: &Limits) -> Option<Vec<Cell>> {
        let n = self.edge_count();
        if n <= limits.edges || self.outside() == Side::Inside {
            return None;
        }
        let mut cells = vec![self.whole()];
        let mut copies = n;
        // the cells with most edges first; indices make the order unique
        let mut open = BinaryHeap::from([(n, 0)]);
        while let Some((count, index)) = open.pop() {
            let cell = &cells[index];
            let is_full = count <= limits.few || copies > limits.copies * n;
            let pieces = self.pieces(&cell.edges, [cell.lo, cell.hi]);
            let long = pieces.iter().map(|piece| piece.chain.edges.len()).filter(|&own| own > limits.piece);
            let has_long = 2 * long.sum::<usize>() > count;
            let cut = match pieces.iter().find_map(Piece::crossed_ends) {
                Some(_) if copies > MAX_COPIES * n => return None,
                Some(ends) => Some(between(ends)),
                None if is_full => None,
                None => self.empty_part(cell).or_else(|| self.best_cut(cell, has_long)),
            };
            let Some((axis, at)) = cut else { continue };
            let [below, above] = self.divided(cell, axis, at);
            copies += below.edges.len() + above.edges.len() - count;
            open.extend([(below.edges.len(), index), (above.edges.len(), cells.len())]);
            cells[index] = below;
            cells.push(above);
        }
        Some(cells)
    }

    /// A cell around all corners.
    fn whole(&self) -> Cell {
        let [lo, hi] = self.corner_bounds();
        let margin = RELATIVE_MARGIN * (hi[0] - lo[0]).max(hi[1] - lo[1]);
        let (lo, hi) = (lo.map(|x| x - margin), hi.map(|x| x + margin));
        let edges = (0..self.edge_count() as u32).collect();
        Cell { lo, hi, edges, at: lo, is_inside: self.outside() == Side::Inside }
    }

    /// Both parts of a cell.
    fn divided(&self, cell: &Cell, axis: usize, at: f64) -> [Cell; 2] {
        [false, true].map(|is_above| {
            let (mut lo, mut hi) = (cell.lo, cell.hi);
            if is_above {
                lo[axis] = at
            } else {
                hi[axis] = at
            }
            let edges = cell.edges.iter().copied().filter(|&edge| self.passes(edge, lo, hi)).collect();
            let (mut point, mut is_inside) = (cell.at, cell.is_inside);
            if is_above != (point[axis] >= at) {
                point = [0, 1].map(|k| 0.5 * (lo[k] + hi[k]));
                let crossed =
                    cell.edges.iter().filter(|&&edge| is_crossed(self.edge_ends(edge), cell.at, point));
                is_inside ^= crossed.count() % 2 == 1;
            }
            Cell { lo, hi, edges, at: point, is_inside }
        })
    }

    /// True if an edge passes through a box, without the upper sides of the box.
    fn passes(&self, edge: u32, lo: Point, hi: Point) -> bool {
        let [a, b] = self.edge_ends(edge);
        if (0..2).any(|k| a[k].min(b[k]) >= hi[k] || a[k].max(b[k]) < lo[k]) {
            return false;
        }
        if [a, b].iter().any(|&end| is_in(end, [lo, hi])) {
            return true;
        }
        let sides = [lo, [hi[0], lo[1]], hi, [lo[0], hi[1]]].map(|corner| orientation(a, b, corner));
        !(sides.iter().all(|&side| side > 0) || sides.iter().all(|&side| side < 0))
    }

    /// A cut that divides a cell into a part with all edges and a large part without any, in which the region has one box.
    fn empty_part(&self, cell: &Cell) -> Option<(usize, f64)> {
        let (mut lo, mut hi) = (cell.hi, cell.lo);
        for end in cell.edges.iter().flat_map(|&edge| clipped(self.edge_ends(edge), cell.lo, cell.hi)) {
            for k in 0..2 {
                (lo[k], hi[k]) = (lo[k].min(end[k]), hi[k].max(end[k]));
            }
        }
        let mut best: Option<(f64, (usize, f64))> = None;
        for k in 0..2 {
            let (below, above) = (lo[k] - cell.lo[k], cell.hi[k] - hi[k]);
            for (width, at) in [(below, lo[k] - below / 64.0), (above, hi[k] + above / 64.0)] {
                let share = width / (cell.hi[k] - cell.lo[k]);
                let is_cut = cell.lo[k] < at && at < cell.hi[k];
                if is_cut && share >= LARGE && best.is_none_or(|(largest, _)| share > largest) {
                    best = Some((share, (k, at)));
                }
            }
        }
        best.map(|(_, cut)| cut)
    }

    /// The cut through the median of the edges that leaves the fewest edges in the larger part; `None` if no cut leaves much fewer,
    /// unless the cell has a long piece.
    fn best_cut(&self, cell: &Cell, has_long: bool) -> Option<(usize, f64)> {
        let mut best: Option<(usize, (usize, f64))> = None;
        for axis in 0..2 {
            let Some(at) = self.median(cell, axis) else { continue };
            let mut counts = [0; 2];
            for &edge in &cell.edges {
                let [a, b] = clipped(self.edge_ends(edge), cell.lo, cell.hi).map(|end| end[axis]);
                counts[0] += usize::from(a.min(b) < at);
                counts[1] += usize::from(a.max(b) >= at);
            }
            let larger = counts[0].max(counts[1]);
            // edges on both sides of a cut with all edges on one side add to the copies, which are limited
            let is_worth_it = 4 * larger <= 3 * cell.edges.len() || has_long && counts[0].min(counts[1]) > 0;
            if is_worth_it && best.is_none_or(|(least, _)| larger < least) {
                best = Some((larger, (axis, at)));
            }
        }
        best.map(|(_, cut)| cut)
    }

    /// The median coordinate of the middles of all edges within a cell, moved to halfway between the adjacent corners.
    fn median(&self, cell: &Cell, axis: usize) -> Option<f64> {
        let middle = |&edge: &u32| {
            let [a, b] = clipped(self.edge_ends(edge), cell.lo, cell.hi);
            0.5 * (a[axis] + b[axis])
        };
        let mut middles: Vec<f64> = cell.edges.iter().map(middle).collect();
        let half = middles.len() / 2;
        let median = *middles.select_nth_unstable_by(half, f64::total_cmp).1;
        let corners = || cell.edges.iter().map(|&edge| self.vertices[edge as usize][axis]);
        let below = corners().filter(|&x| x <= median).fold(cell.lo[axis], f64::max);
        let above = corners().filter(|&x| x > median).fold(cell.hi[axis], f64::min);
        let at = 0.5 * (below + above);
        (cell.lo[axis] < at && at < cell.hi[axis]).then_some(at)
    }

    /// The pieces in a box, of all edges that pass through it.
    fn pieces(&self, edges: &[u32], cell: [Point; 2]) -> Vec<Piece> {
        let goes_on = |edge: u32| is_in(self.vertices[self.next[edge as usize] as usize], cell);
        let mut pieces = Vec::new();
        let mut rest = edges;
        while let Some(&edge) = rest.first() {
            // the edges of one contour
            let contour = self.contour[edge as usize] as usize;
            let range = self.corners_of(contour);
            let (own, others) = rest.split_at(rest.partition_point(|&edge| (edge as usize) < range.end));
            rest = others;
            let Some(end) = own.iter().position(|&edge| !goes_on(edge)) else {
                let island = self.nesting[contour].is_island;
                let chain = Chain::new(&self.vertices[range.clone()], range.start as u32, island);
                pieces.push(Piece { chain, is_closed: true });
                continue;
            };
            let mut chain = Chain { points: Vec::new(), edges: Vec::new() };
            for &edge in own[end + 1..].iter().chain(&own[..=end]) {
                let [from, to] = self.edge_ends(edge);
                if chain.edges.is_empty() {
                    chain.points.push(from);
                }
                chain.points.push(to);
                chain.edges.push(edge);
                if !goes_on(edge) {
                    let empty = Chain { points: Vec::new(), edges: Vec::new() };
                    pieces.push(Piece { chain: std::mem::replace(&mut chain, empty), is_closed: false });
                }
            }
        }
        pieces
    }

    /// The formula of the region in a cell.
    fn formula_in<T>(
        &self,
        cell: &Cell,
        half_plane: &mut impl FnMut(&Chain, usize) -> T,
        join: &mut impl FnMut(Operator, Vec<T>) -> T,
    ) -> Part<T> {
        let pieces = self.pieces(&cell.edges, [cell.lo, cell.hi]);
        if pieces.is_empty() {
            return Part::Constant(cell.is_inside);
        }
        let is_left = |piece: &Piece| {
            piece.fold(
                &mut |chain, edge| is_left_of([chain.points[edge], chain.points[edge + 1]], cell.at),
                &mut |operator, parts: Vec<bool>| match operator {
                    Operator::Intersection => parts.iter().all(|part| *part),
                    Operator::Union => parts.iter().any(|part| *part),
                    Operator::SymmetricDifference => parts.iter().filter(|part| **part).count() % 2 == 1,
                    Operator::Complement => !parts.iter().any(|part| *part),
                },
            )
        };
        let is_odd = pieces.iter().filter(|piece| is_left(piece)).count() % 2 == 1;
        let mut sides: Vec<T> = pieces.iter().map(|piece| piece.fold(half_plane, join)).collect();
        let odd = if sides.len() == 1 { sides.remove(0) } else { join(Operator::SymmetricDifference, sides) };
        Part::Formula(match is_odd == cell.is_inside {
            true => odd,
            false => join(Operator::Complement, vec![odd]),
        })
    }
}

/// True for a point in a box, without its upper sides.
fn is_in(p: Point, [lo, hi]: [Point; 2]) -> bool {
    (0..2).all(|k| lo[k] <= p[k] && p[k] < hi[k])
}

/// A cut between two different points: the second is above it or on it.
fn between([a, b]: [Point; 2]) -> (usize, f64) {
    let axis = usize::from((a[1] - b[1]).abs() > (a[0] - b[0]).abs());
    let (low, high) = (a[axis].min(b[axis]), a[axis].max(b[axis]));
    let middle = 0.5 * (low + high);
    (axis, if low < middle { middle } else { high })
}

/// The ends of an edge within a box, up to rounding.
fn clipped([a, b]: [Point; 2], lo: Point, hi: Point) -> [Point; 2] {
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for k in 0..2 {
        let length = b[k] - a[k];
        if length != 0.0 {
            let [s, t] = [(lo[k] - a[k]) / length, (hi[k] - a[k]) / length];
            (from, to) = (from.max(s.min(t)), to.min(s.max(t)));
        }
    }
    [from, to].map(|t| [0, 1].map(|k| (a[k] + t * (b[k] - a[k])).clamp(lo[k], hi[k])))
}

/// The sign of the orientation of two points and a third one that is moved by way * (e, e^2), with a way of 1 or -1.
fn side([a, b]: [Point; 2], p: Point, way: i8) -> i8 {
    // moving along x matters most, unless the line is horizontal
    let is_up = if a[1] == b[1] { a[0] >= b[0] } else { b[1] > a[1] };
    match orientation(a, b, p) {
        0 if is_up => -way,
        0 => way,
        sign => sign,
    }
}

fn is_left_of(edge: [Point; 2], p: Point) -> bool {
    side(edge, p, 1) > 0
}

/// True if the way between two points, both moved by (e, e^2), crosses an edge.
fn is_crossed(edge: [Point; 2], p: Point, q: Point) -> bool {
    if p == q || side(edge, p, 1) == side(edge, q, 1) {
        return false;
    }
    // a corner relative to the moved way is a corner moved the other way relative to the way
    side([p, q], edge[0], -1) != side([p, q], edge[1], -1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::from_polygons;
    use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};

    type Lattice = [i64; 2];

    /// The values of a formula at some points.
    fn folded(polygons: &Polygons, limits: &Limits, points: &[Point]) -> Vec<bool> {
        let all = |test: &dyn Fn(&Point) -> bool| points.iter().map(test).collect::<Vec<bool>>();
        polygons.fold_within(
            limits,
            |half| all(&|p| half.normal[0] * p[0] + half.normal[1] * p[1] < half.offset),
            |cell| all(&|p| is_in(*p, cell)),
            |operator, parts| {
                let counts = (0..points.len()).map(|k| parts.iter().filter(|part| part[k]).count());
                let value = |count: usize| match operator {
                    Operator::Intersection => count == parts.len(),
                    Operator::Union => count > 0,
                    Operator::SymmetricDifference => count % 2 == 1,
                    Operator::Complement => count == 0,
                };
                counts.map(value).collect()
            },
        )
    }

    /// Containment in integer arithmetic, by the even-odd rule: the point is the given one, divided by `scale`, with an odd `scale` and
    /// coordinates that are no multiples of it, so that it has the height of no corner. `None` on an edge.
    fn is_within(contours: &[Vec<Lattice>], at: Lattice, scale: i64) -> Option<bool> {
        let mut inside = false;
        for contour in contours {
            for (k, a) in contour.iter().enumerate() {
                let [a, b] = [*a, contour[(k + 1) % contour.len()]].map(|p| p.map(|x| x * scale));
                if (a[1] > at[1]) == (b[1] > at[1]) {
                    continue;
                }
                let turn = (b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0]);
                match turn {
                    0 => return None,
                    _ => inside ^= (turn > 0) == (b[1] > a[1]),
                }
            }
        }
        Some(inside)
    }

    fn polygons(contours: &[Vec<Lattice>]) -> Polygons {
        let points = contours.iter().map(|contour| contour.iter().map(|p| p.map(|x| x as f64)).collect());
        from_polygons(&points.collect::<Vec<Vec<Point>>>(), Side::Outside).unwrap()
    }

    fn star(rng: &mut ChaCha8Rng, n: usize, inner: f64, outer: f64) -> Vec<Lattice> {
        (0..n)
            .map(|k| {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / n as f64);
                let radius = rng.random_range(inner..outer);
                [cos, sin].map(|x| (radius * x).round() as i64)
            })
            .collect()
    }

    /// A comb whose teeth have corners at few different heights, many of them in line.
    fn comb(rng: &mut ChaCha8Rng, teeth: i64, turned: bool) -> Vec<Lattice> {
        let mut points = vec![[0, -10], [8 * teeth, -10]];
        for k in (0..teeth).rev() {
            let (low, high) = (rng.random_range(0..3), rng.random_range(4..7) * 10);
            points.extend([[8 * k + 8, low], [8 * k + 6, high], [8 * k + 3, high], [8 * k + 1, low]]);
        }
        points.dedup();
        if turned { points.into_iter().map(|[x, y]| [-y, x]).collect() } else { points }
    }

    /// A band that winds around the origin.
    fn spiral(steps: i64) -> Vec<Lattice> {
        let at = |k: i64, gap: f64| {
            let angle = 0.1 * k as f64;
            let (sin, cos) = libm::sincos(angle);
            [cos, sin].map(|x| ((40.0 + 15.0 * angle + gap) * x).round() as i64)
        };
        (0..steps).map(|k| at(k, 45.0)).chain((0..steps).rev().map(|k| at(k, 0.0))).collect()
    }

    fn squares(rng: &mut ChaCha8Rng) -> Vec<Vec<Lattice>> {
        let mut all = Vec::new();
        for (x, y) in (0..12).flat_map(|x| (0..12).map(move |y| (20 * x, 20 * y))) {
            for nesting in 0..rng.random_range(1..4i64) {
                let r = 9 - 3 * nesting;
                let mut square = vec![[x + r, y], [x, y + r], [x - r, y], [x, y - r]];
                if nesting % 2 == 1 {
                    square.reverse();
                }
                all.push(square);
            }
        }
        all
    }

    fn shapes() -> Vec<Vec<Vec<Lattice>>> {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut hole = star(&mut rng, 150, 300.0, 700.0);
        hole.reverse();
        vec![
            vec![star(&mut rng, 400, 2000.0, 9000.0)],
            vec![star(&mut rng, 60, 10.0, 9000.0)],
            vec![star(&mut rng, 200, 8000.0, 8001.0), hole],
            vec![comb(&mut rng, 70, false)],
            vec![comb(&mut rng, 70, true)],
            vec![spiral(300)],
            squares(&mut rng),
        ]
    }

    #[test]
    fn cells_of_any_size_agree_with_integer_containment() {
        let mut rng = ChaCha8Rng::seed_from_u64(4);
        for (number, contours) in shapes().iter().enumerate() {
            let polygons = polygons(contours);
            let [lo, hi] = polygons.corner_bounds();
            for few in [0, 3, 8, 40] {
                let limits = Limits { edges: 0, few, piece: few, copies: if few == 0 { 30 } else { 6 } };
                let mut coordinate = |k: usize| {
                    let x = rng.random_range((lo[k] - 9.0) * 7.0..(hi[k] + 9.0) * 7.0) as i64;
                    if x % 7 == 0 { x + 1 } else { x }
                };
                let places: Vec<Lattice> = (0..300).map(|_| [coordinate(0), coordinate(1)]).collect();
                let points: Vec<Point> = places.iter().map(|at| at.map(|x| x as f64 / 7.0)).collect();
                for (at, value) in places.iter().zip(folded(&polygons, &limits, &points)) {
                    let Some(truth) = is_within(contours, *at, 7) else { continue };
                    assert_eq!(value, truth, "shape {number}, {few} edges per cell, {at:?} / 7");
                }
            }
        }
    }

    /// Long teeth on an arc: cells with both their tips and their bases would have pieces of hundreds of edges, whose formulas are as
    /// deep as they are long.
    #[test]
    fn formulas_of_teeth_are_shallow() {
        let count = 3000;
        let tooth = |k: usize| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * k as f64 / count as f64);
            [cos, sin].map(|x| if k.is_multiple_of(2) { 10.0 * x } else { 20.0 * x })
        };
        let polygons =
            from_polygons(&[(0..count).map(tooth).collect::<Vec<Point>>()], Side::Outside).unwrap();
        let depths = |cell: &Cell| -> Vec<u32> {
            let mut joined = |_: Operator, parts: Vec<Vec<u32>>| -> Vec<u32> {
                parts.into_iter().flatten().map(|depth| depth + 1).collect()
            };
            match polygons.formula_in(cell, &mut |_: &Chain, _: usize| vec![0], &mut joined) {
                Part::Formula(depths) => depths,
                Part::Constant(_) => Vec::new(),
            }
        };
        let all: Vec<u32> = polygons.cells(&LIMITS).unwrap().iter().flat_map(depths).collect();
        let mean = f64::from(all.iter().sum::<u32>()) / all.len() as f64;
        assert!(all.len() <= 7 * count && mean < 4.0, "{} half-planes below {mean} operators", all.len());
    }

    /// Cells have few edges, and edges are in few cells.
    #[test]
    fn large_regions_have_small_cells() {
        let mut rng = ChaCha8Rng::seed_from_u64(5);
        let mut regions = vec![vec![spiral(2000)], vec![comb(&mut rng, 5000, false)]];
        regions.push(vec![star(&mut rng, 20_000, 8e8, 9e8)]);
        for (contours, most) in regions.iter().zip([16, 16, 200]) {
            let polygons = polygons(contours);
            let sizes: Vec<usize> =
                polygons.cells(&LIMITS).unwrap().iter().map(|cell| cell.edges.len()).collect();
            let (all, largest) = (sizes.iter().sum::<usize>(), sizes.iter().max().unwrap());
            let n = polygons.edge_count();
            assert!(all <= 7 * n && *largest <= most, "{n} edges: {all} in cells of up to {largest}");
        }
    }
}
