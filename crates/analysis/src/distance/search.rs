//! The search for the nearest boundary point by subdivision of space.

use super::candidates::Witness;
use super::field::Field;
use super::surfaces::curve_distance;
use super::tree::{Place, Tree};
use rayweave_math::{Interval, Vec3};
use std::cmp::Ordering;
use std::collections::BinaryHeap;
use std::rc::Rc;

/// A box.
type Cell = [Interval; 3];

/// The greatest number of surfaces whose sign patterns are all evaluated.
const MOST_PATTERNS: usize = 4;

/// The rest of the tree in a box, without the surfaces that have a constant sign there.
struct Part {
    tree: Tree,
    surfaces: Vec<u32>,
}

/// A box that may contain the nearest boundary point.
struct Open {
    /// Lower bound of the distance of boundary points in the box.
    least: f64,
    /// Boxes with equal bounds are processed in the order of their numbers.
    number: usize,
    lo: Vec3,
    hi: Vec3,
    part: Rc<Part>,
    /// The surfaces that a boundary point in the box may belong to, if there are few.
    meeting: Vec<u32>,
}

impl PartialEq for Open {
    fn eq(&self, other: &Open) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Open) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    /// The largest is the one with the smallest bound.
    fn cmp(&self, other: &Open) -> Ordering {
        other.least.total_cmp(&self.least).then(other.number.cmp(&self.number))
    }
}

/// One search.
pub(super) struct Search<'f> {
    pub field: &'f Field,
    pub point: Vec3,
    pub is_inside: bool,
    /// Lower bound of the distance from each surface.
    pub distances: &'f [f64],
    heap: BinaryHeap<Open>,
    cells: usize,
    places: Vec<Place>,
    scratch: Vec<Place>,
    values: Vec<bool>,
}

impl<'f> Search<'f> {
    pub fn new(field: &'f Field, point: Vec3, is_inside: bool, distances: &'f [f64]) -> Search<'f> {
        Search {
            field,
            point,
            is_inside,
            distances,
            heap: BinaryHeap::new(),
            cells: 0,
            places: vec![Place::Unknown; distances.len()],
            scratch: Vec::new(),
            values: Vec::new(),
        }
    }

    /// Improves the bounds of the distance until they differ by at most the tolerance of the upper one, or until `most` boxes were
    /// examined. The boundary within `reach` of the point is searched; the lower bound is at most `reach`.
    pub fn run(&mut self, mut lower: f64, best: &mut Witness, reach: f64, most: usize) -> f64 {
        let root = Rc::new(Part { tree: self.field.tree.clone(), surfaces: self.field.tree.surfaces() });
        self.open(self.point - Vec3::splat(reach), self.point + Vec3::splat(reach), &root);
        while let Some(cell) = self.heap.pop() {
            lower = lower.max(cell.least);
            let tolerance = self.field.tolerance(self.point, best.distance);
            if lower >= best.distance - tolerance || self.cells > most {
                return lower.min(best.distance);
            }
            self.improve(&cell, best);
            let middle = 0.5 * cell.lo + 0.5 * cell.hi;
            if (cell.hi - cell.lo).max_element() < 0.1 * tolerance {
                return lower.min(best.distance);
            }
            for k in 0..8 {
                let (mut lo, mut hi) = (cell.lo, cell.hi);
                for axis in 0..3 {
                    if k >> axis & 1 == 0 { hi[axis] = middle[axis] } else { lo[axis] = middle[axis] }
                }
                self.open(lo, hi, &cell.part);
            }
        }
        lower.max(best.distance.min(reach))
    }

    /// Adds a box, unless it contains no boundary point that may be the nearest one.
    fn open(&mut self, lo: Vec3, hi: Vec3, parent: &Rc<Part>) {
        self.cells += 1;
        let cell: Cell = std::array::from_fn(|k| Interval::new(lo[k], hi[k]));
        let mut gradients = Vec::with_capacity(parent.surfaces.len().min(16));
        let mut unknown = Vec::with_capacity(parent.surfaces.len().min(16));
        for &number in &parent.surfaces {
            let (value, gradient) = self.field.surface(number).ranges(&cell);
            self.places[number as usize] = match () {
                () if value.hi < 0.0 => Place::Inside,
                () if value.lo > 0.0 => Place::Outside,
                () => Place::Unknown,
            };
            if self.places[number as usize] == Place::Unknown {
                unknown.push(number);
                gradients.push((number, gradient));
            }
        }
        let part = match unknown.len() == parent.surfaces.len() {
            true => parent.clone(),
            false => {
                let tree = parent.tree.reduced(&self.places, &mut self.scratch);
                Rc::new(Part { surfaces: tree.surfaces(), tree })
            }
        };
        parent.surfaces.iter().for_each(|&number| self.places[number as usize] = Place::Unknown);
        if part.tree.constant().is_some() {
            return;
        }
        let distance = distance_from_box(self.point, lo, hi);
        let (bound, meeting) = match part.surfaces.len() <= MOST_PATTERNS {
            true => {
                let meeting = self.deciding(&part);
                gradients.retain(|(number, _)| meeting.contains(number));
                (self.least_critical(&cell, &gradients), meeting)
            }
            false => (self.nearest_of(part.surfaces.iter().copied()), Vec::new()),
        };
        if bound < f64::INFINITY {
            let (least, number) = (distance.max(bound), self.cells);
            self.heap.push(Open { least, number, lo, hi, part, meeting });
        }
    }

    /// The surfaces whose side matters for some sides of the others.
    fn deciding(&mut self, part: &Part) -> Vec<u32> {
        let bit = |number: u32| part.surfaces.iter().position(|&own| own == number).unwrap_or(0);
        let table: Vec<bool> = (0..1usize << part.surfaces.len())
            .map(|pattern| part.tree.is_inside(|number| pattern >> bit(number) & 1 == 1, &mut self.values))
            .collect();
        let matters = |k: usize| (0..table.len()).any(|pattern| table[pattern] != table[pattern ^ (1 << k)]);
        (0..part.surfaces.len()).filter(|&k| matters(k)).map(|k| part.surfaces[k]).collect()
    }

    fn nearest_of(&self, surfaces: impl Iterator<Item = u32>) -> f64 {
        surfaces.map(|number| self.distances[number as usize]).fold(f64::INFINITY, f64::min)
    }

    /// A lower bound of the distance of those points of a box in which the distance can have a minimum on the boundary: on one
    /// surface where its normal leads to the point, on a curve where it is perpendicular to that direction, and where three
    /// surfaces meet. Infinite if there is no such point.
    fn least_critical(&self, cell: &Cell, gradients: &[(u32, Cell)]) -> f64 {
        let way: Cell = std::array::from_fn(|k| cell[k] - Interval::point(self.point[k]));
        let mut least = f64::INFINITY;
        for (i, (a, gradient_a)) in gradients.iter().enumerate() {
            let from_a = self.distances[*a as usize];
            if cross(&way, gradient_a).iter().all(|side| side.contains_zero()) {
                least = least.min(from_a);
            }
            for (j, (b, gradient_b)) in gradients.iter().enumerate().skip(i + 1) {
                let of_curve =
                    curve_distance(self.field.surface(*a), self.field.surface(*b), self.point).unwrap_or(0.0);
                let from_both =
                    (of_curve - self.field.rounding(self.point)).max(from_a).max(self.distances[*b as usize]);
                if dot(&cross(gradient_a, gradient_b), &way).contains_zero() {
                    least = least.min(from_both);
                }
                for (c, _) in &gradients[j + 1..] {
                    least = least.min(from_both.max(self.distances[*c as usize]));
                }
            }
        }
        least
    }

    /// Looks in a box for points on the other side than the point of the search.
    fn improve(&mut self, cell: &Open, best: &mut Witness) {
        let middle = 0.5 * cell.lo + 0.5 * cell.hi;
        let corner = |k: usize| {
            Vec3::from_array(std::array::from_fn(|axis| {
                if k >> axis & 1 == 0 { cell.lo[axis] } else { cell.hi[axis] }
            }))
        };
        for sample in std::iter::once(middle).chain((0..8).map(corner)) {
            if (sample - self.point).length() < best.distance
                && self.field.is_inside(sample) != self.is_inside
            {
                *best = Witness { distance: (sample - self.point).length(), beyond: sample, on: None };
            }
        }
        if !cell.meeting.is_empty() && cell.meeting.len() <= 3 {
            self.field.try_meeting(self.point, self.is_inside, middle, &cell.meeting, best);
        }
    }
}

fn distance_from_box(point: Vec3, lo: Vec3, hi: Vec3) -> f64 {
    let outside = (lo - point).max(point - hi).max(Vec3::ZERO);
    // rounding: a bound from below
    outside.length() * (1.0 - f64::EPSILON * 4.0)
}

fn cross(a: &Cell, b: &Cell) -> Cell {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: &Cell, b: &Cell) -> Interval {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
