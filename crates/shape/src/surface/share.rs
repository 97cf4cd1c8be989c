//! Which surfaces of a group are one and the same.
//!
//! Solids that touch bring each its own copy of the common face, and the copies differ by the rounding of the
//! maps that placed them. Equal surfaces are found once, when a model is compiled, and replaced by one
//! representative, so that their roots are equal to the bit. What is not found here is still welded along
//! each ray: sharing strengthens, it decides nothing.
//!
//! Two surfaces of one kind are equal if all their numbers are: components of unit vectors within 64 u,
//! lengths within 64 u times the larger reach of the two, factors within 64 u relative; axes and planes of
//! either sense. Objects are equal if they are of one form to the bit, in places that are equal like this.
//!
//! *Method*: a sorted sweep. The surfaces of one kind are sorted by one of their numbers and cut wherever
//! neighbours differ by more than the tolerance; each part is treated the same by the next number, until no
//! number cuts it. (Hashing of rounded numbers would tear pairs apart that lie on both sides of a border.)
//! Parts are usually of one bit pattern, or narrower than the tolerance in every number and then one class;
//! in others pairs are compared and joined (union-find). O(n log n) for n surfaces unless many of them form a
//! chain that is wider than the tolerance.

use super::{Plane, Surface};
use rayweave_math::{UNIT_ROUNDOFF, Vec3};
use std::borrow::Borrow;
use std::cmp::Ordering;

/// For each surface the one that stands for it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Shared {
    /// The number of the surface that stands for the class: the smallest by the total order of its bits.
    pub representative: Vec<u32>,
    /// True if f of the surface has the opposite sign of the representative's: a plane that faces the other
    /// way.
    pub flipped: Vec<bool>,
}

/// A chain of surfaces, each equal to the next within the tolerance, whose ends are more than four tolerances
/// (of the largest reach among them) apart: neither one surface nor several. The model is nearly but not quite
/// aligned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WideClass {
    /// One member.
    pub first: usize,
    /// Another member, more than four tolerances away.
    pub second: usize,
}

impl std::fmt::Display for WideClass {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "surfaces {} and {} are too far apart to be one and too well joined by others to be two (a chain of \
             nearly equal faces) round their coordinates to fewer digits?",
            self.first, self.second
        )
    }
}

impl std::error::Error for WideClass {}

const TOLERANCE: f64 = 64.0 * UNIT_ROUNDOFF;

/// Finds equal surfaces. Each is given with its reach: its own or, better, one that counts the translations
/// composed on its way. At most `u32::MAX` surfaces.
pub fn share<S: Borrow<Surface>>(surfaces: &[(S, f64)]) -> Result<Shared, WideClass> {
    let surfaces: &[(&Surface, f64)] =
        &surfaces.iter().map(|(s, reach)| (s.borrow(), *reach)).collect::<Vec<_>>();
    let entries = entries(surfaces);
    let mut classes = Classes::new(surfaces.len());
    for kind in Kind::ALL {
        let of_kind = entries.iter().filter(|e| Kind::of(surfaces[e.index()].0) == kind);
        let part: Vec<Entry> = of_kind.copied().collect();
        for part in by_form(surfaces, part) {
            sweep(surfaces, kind, part, &mut classes);
        }
    }
    classes.into_shared(surfaces)
}

/// Entries of one kind apart by what no tolerance joins: the forms of objects.
fn by_form(surfaces: &[(&Surface, f64)], mut entries: Vec<Entry>) -> Vec<Vec<Entry>> {
    let object = |entry: &Entry| match surfaces[entry.index()].0 {
        Surface::Object(object) => Some(object),
        _ => None,
    };
    let Some(true) = entries.first().map(|entry| object(entry).is_some()) else { return vec![entries] };
    entries.sort_by_cached_key(|entry| object(entry).map(|object| object.form.fingerprint()));
    let is_same = |a: &Entry, b: &Entry| object(a).zip(object(b)).is_some_and(|(a, b)| a.has_form_of(b));
    entries.chunk_by(is_same).map(<[Entry]>::to_vec).collect()
}

/// A surface, perhaps with all its unit vectors reversed.
#[derive(Clone, Copy, Debug)]
struct Entry {
    index: u32,
    reversed: bool,
}

impl Entry {
    fn index(&self) -> usize {
        self.index as usize
    }
}

/// Each surface in the sense in which its vector points along a fixed direction; in both senses where that is
/// within the tolerance of neither.
fn entries(surfaces: &[(&Surface, f64)]) -> Vec<Entry> {
    let mut entries = Vec::with_capacity(surfaces.len());
    for (index, (surface, _)) in surfaces.iter().enumerate() {
        let along = sense(surface).map_or(1.0, |v| v.dot(SENSE));
        for reversed in [false, true] {
            let along = if reversed { -along } else { along };
            if along > -1e-12 {
                entries.push(Entry { index: index as u32, reversed });
            }
        }
    }
    entries
}

/// A direction that no plane or axis of a man-made model is likely to be perpendicular to.
const SENSE: Vec3 = Vec3::new(0.617_340_218_6, 0.531_871_409_3, 0.579_913_306_7);

/// The unit vector of which either sense gives the same surface.
fn sense(surface: &Surface) -> Option<Vec3> {
    match surface {
        Surface::Plane(s) => Some(s.normal),
        Surface::Cylinder(s) => Some(s.axis),
        Surface::Cone(s) => Some(s.axis),
        Surface::Torus(s) => Some(s.axis),
        Surface::Sphere(_) | Surface::Quadric(_) | Surface::AffineTorus(_) | Surface::Object(_) => None,
    }
}

/// A kind of surface; only surfaces of one kind are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Plane,
    Sphere,
    Cylinder,
    Cone,
    Quadric,
    Torus,
    AffineTorus,
    Object,
}

impl Kind {
    const ALL: [Kind; 8] = [
        Kind::Plane,
        Kind::Sphere,
        Kind::Cylinder,
        Kind::Cone,
        Kind::Quadric,
        Kind::Torus,
        Kind::AffineTorus,
        Kind::Object,
    ];

    fn of(surface: &Surface) -> Kind {
        match surface {
            Surface::Plane(_) => Kind::Plane,
            Surface::Sphere(_) => Kind::Sphere,
            Surface::Cylinder(_) => Kind::Cylinder,
            Surface::Cone(_) => Kind::Cone,
            Surface::Quadric(_) => Kind::Quadric,
            Surface::Torus(_) => Kind::Torus,
            Surface::AffineTorus(_) => Kind::AffineTorus,
            Surface::Object(_) => Kind::Object,
        }
    }

    /// How many numbers describe a surface of the kind.
    fn numbers(self) -> usize {
        match self {
            Kind::Plane | Kind::Sphere => 4,
            Kind::Cylinder | Kind::Cone => 7,
            Kind::Torus => 8,
            Kind::Quadric => 19,
            Kind::AffineTorus => 17,
            Kind::Object => 12,
        }
    }
}

/// Number `k` of a surface, with the tolerance within which another is equal.
fn number(surface: &Surface, reach: f64, reversed: bool, k: usize) -> (f64, f64) {
    let sign = if reversed { -1.0 } else { 1.0 };
    let length = |x: f64| (x, TOLERANCE * reach);
    let unit = |x: f64| (sign * x, TOLERANCE);
    match surface {
        Surface::Plane(Plane { offset, .. }) if k == 3 => length(sign * offset),
        Surface::Plane(s) => unit(s.normal[k]),
        Surface::Sphere(s) if k == 3 => length(s.radius),
        Surface::Sphere(s) => length(s.centre[k]),
        Surface::Cylinder(s) => match k {
            0..3 => length(s.point[k]),
            3..6 => unit(s.axis[k - 3]),
            _ => length(s.radius),
        },
        Surface::Cone(s) => match k {
            0..3 => length(s.apex[k]),
            3..6 => unit(s.axis[k - 3]),
            // an angle within the tolerance
            _ => (s.slope, TOLERANCE * (1.0 + s.slope * s.slope)),
        },
        Surface::Quadric(s) => match k {
            0..3 => length(s.centre[k]),
            3..12 => (s.axes[(k - 3) / 3][k % 3], TOLERANCE),
            12..15 => relative(s.weights[k - 12]),
            15..18 => (s.linear[k - 15], TOLERANCE * s.linear.length()),
            _ => relative(s.constant),
        },
        Surface::Torus(s) => match k {
            0..3 => length(s.centre[k]),
            3..6 => unit(s.axis[k - 3]),
            6 => length(s.major),
            _ => length(s.minor),
        },
        // only under the same map
        Surface::AffineTorus(s) => match k {
            0..3 => (s.centre[k], 0.0),
            3..12 => (s.local_from_world.to_cols_array()[k - 3], 0.0),
            12..15 => (s.torus.axis[k - 12], 0.0),
            15 => (s.torus.major, 0.0),
            _ => (s.torus.minor, 0.0),
        },
        Surface::Object(s) => match k {
            0..3 => length(s.centre[k]),
            _ => {
                let linear = s.local_from_world.to_cols_array();
                let largest = linear.iter().fold(0.0f64, |most, x| most.max(x.abs()));
                (linear[k - 3], TOLERANCE * largest)
            }
        },
    }
}

fn relative(x: f64) -> (f64, f64) {
    (x, TOLERANCE * x.abs())
}

/// Entries from `first` to `last` that `uncut` numbers up to `next` have not cut.
struct Part {
    first: usize,
    last: usize,
    next: usize,
    uncut: usize,
}

/// Cuts the entries of one kind until nothing cuts them, and joins what is left.
fn sweep(surfaces: &[(&Surface, f64)], kind: Kind, mut entries: Vec<Entry>, classes: &mut Classes) {
    let numbers = kind.numbers();
    let whole = Part { first: 0, last: entries.len(), next: 0, uncut: 0 };
    let mut parts = vec![whole];
    let mut keyed = Vec::new();
    while let Some(part) = parts.pop() {
        let slice = &mut entries[part.first..part.last];
        if slice.len() < 2 {
            continue;
        }
        if are_same_bits(surfaces, slice) {
            slice[1..].iter().for_each(|entry| classes.union(slice[0].index, entry.index));
            continue;
        }
        if part.uncut == numbers {
            join(surfaces, numbers, slice, classes);
            continue;
        }
        sort_by_number(surfaces, slice, part.next, &mut keyed);
        let next = (part.next + 1) % numbers;
        let mut first = part.first;
        for cut in cuts(&keyed).map(|k| part.first + k) {
            parts.push(Part { first, last: cut, next, uncut: 1 });
            first = cut;
        }
        let uncut = if first == part.first { part.uncut + 1 } else { 1 };
        parts.push(Part { first, last: part.last, next, uncut });
    }
}

/// True if all entries are of one bit pattern: copies of one face, of which large models have many.
fn are_same_bits(surfaces: &[(&Surface, f64)], entries: &[Entry]) -> bool {
    let (first, rest) = (&entries[0], &entries[1..]);
    rest.iter().all(|entry| {
        entry.reversed == first.reversed
            && by_bits(surfaces[entry.index()].0, surfaces[first.index()].0).is_eq()
    })
}

/// An entry with one of its numbers and its tolerance.
type Keyed = (f64, f64, Entry);

fn sort_by_number(surfaces: &[(&Surface, f64)], entries: &mut [Entry], k: usize, keyed: &mut Vec<Keyed>) {
    keyed.clear();
    keyed.extend(entries.iter().map(|e| {
        let (surface, reach) = &surfaces[e.index()];
        let (value, tolerance) = number(surface, *reach, e.reversed, k);
        (value, tolerance, *e)
    }));
    keyed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    for (entry, key) in entries.iter_mut().zip(keyed.iter()) {
        *entry = key.2;
    }
}

/// Where the sorted numbers, each widened by its tolerance, leave a gap: no entry before equals one after.
fn cuts(keyed: &[Keyed]) -> impl Iterator<Item = usize> {
    let mut end = f64::NEG_INFINITY;
    keyed.iter().enumerate().filter_map(move |(k, &(value, tolerance, _))| {
        let gap = k > 0 && value - tolerance > end;
        end = end.max(value + tolerance);
        gap.then_some(k)
    })
}

/// Joins the entries of an uncut part: all of them if it is narrow, else those pairs that are equal.
fn join(surfaces: &[(&Surface, f64)], numbers: usize, part: &mut [Entry], classes: &mut Classes) {
    let widths = (0..numbers).map(|k| width(surfaces, part, k));
    let widest = widths.max_by(|a, b| a.in_smallest().total_cmp(&b.in_smallest()));
    if widest.as_ref().is_none_or(|w| w.in_smallest() <= 1.0) {
        for entry in &part[1..] {
            classes.union(part[0].index, entry.index);
        }
        return;
    }
    let widest = widest.map_or(0, |w| w.number);
    let mut keyed = Vec::new();
    sort_by_number(surfaces, part, widest, &mut keyed);
    for (k, a) in keyed.iter().enumerate() {
        for b in &keyed[k + 1..] {
            if b.0 - a.0 > a.1 + b.1 {
                break;
            }
            if equal(surfaces, numbers, &a.2, &b.2) {
                classes.union(a.2.index, b.2.index);
            }
        }
    }
}

fn equal(surfaces: &[(&Surface, f64)], numbers: usize, a: &Entry, b: &Entry) -> bool {
    let of = |e: &Entry, k: usize| {
        let (surface, reach) = &surfaces[e.index()];
        number(surface, *reach, e.reversed, k)
    };
    (0..numbers).all(|k| {
        let ((a, a_tolerance), (b, b_tolerance)) = (of(a, k), of(b, k));
        (a - b).abs() <= a_tolerance.max(b_tolerance)
    })
}

/// The range of one number in a set of entries.
#[derive(Clone, Copy)]
struct Width {
    number: usize,
    lo: (f64, usize),
    hi: (f64, usize),
    /// Of the member of the smallest reach, and of the largest.
    tolerances: [f64; 2],
}

impl Width {
    /// The range in units of the smallest tolerance: up to 1, all are equal to each other.
    fn in_smallest(&self) -> f64 {
        self.in_units(self.tolerances[0])
    }

    /// The range in units of the largest tolerance, which the class has if its members are made one.
    fn in_largest(&self) -> f64 {
        self.in_units(self.tolerances[1])
    }

    fn in_units(&self, tolerance: f64) -> f64 {
        let range = self.hi.0 - self.lo.0;
        if range == 0.0 { 0.0 } else { range / tolerance }
    }
}

fn width(surfaces: &[(&Surface, f64)], entries: &[Entry], k: usize) -> Width {
    let mut width = Width {
        number: k,
        lo: (f64::INFINITY, 0),
        hi: (f64::NEG_INFINITY, 0),
        tolerances: [f64::INFINITY, 0.0],
    };
    for entry in entries {
        let (surface, reach) = &surfaces[entry.index()];
        let (value, tolerance) = number(surface, *reach, entry.reversed, k);
        if value < width.lo.0 {
            width.lo = (value, entry.index());
        }
        if value > width.hi.0 {
            width.hi = (value, entry.index());
        }
        width.tolerances = [width.tolerances[0].min(tolerance), width.tolerances[1].max(tolerance)];
    }
    width
}

/// Union-find with path halving; the root of a class is its lowest number.
struct Classes {
    parent: Vec<u32>,
}

impl Classes {
    fn new(count: usize) -> Classes {
        Classes { parent: (0..count as u32).collect() }
    }

    fn root(&mut self, mut k: u32) -> u32 {
        while self.parent[k as usize] != k {
            let up = self.parent[self.parent[k as usize] as usize];
            self.parent[k as usize] = up;
            k = up;
        }
        k
    }

    fn union(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b) as usize] = a.min(b);
    }

    fn into_shared(mut self, surfaces: &[(&Surface, f64)]) -> Result<Shared, WideClass> {
        let count = surfaces.len() as u32;
        let mut members: Vec<(u32, u32)> = (0..count).map(|k| (self.root(k), k)).collect();
        members.sort_unstable();
        let mut shared =
            Shared { representative: (0..count).collect(), flipped: vec![false; surfaces.len()] };
        for class in members.chunk_by(|a, b| a.0 == b.0).filter(|class| class.len() > 1) {
            add_class(surfaces, class, &mut shared)?;
        }
        Ok(shared)
    }
}

fn add_class(
    surfaces: &[(&Surface, f64)],
    class: &[(u32, u32)],
    shared: &mut Shared,
) -> Result<(), WideClass> {
    let surface = |k: u32| surfaces[k as usize].0;
    let lowest = class[0].1;
    if class.iter().all(|&(_, k)| by_bits(surface(k), surface(lowest)).is_eq()) {
        class.iter().for_each(|&(_, k)| shared.representative[k as usize] = lowest);
        return Ok(());
    }
    let chosen = class
        .iter()
        .map(|&(_, k)| k)
        .reduce(|a, b| if by_bits(surface(b), surface(a)).is_lt() { b } else { a })
        .unwrap_or(0);
    let against = sense(surface(chosen));
    let turned = |k: u32| match (sense(surface(k)), against) {
        (Some(v), Some(w)) => v.dot(w) < 0.0,
        _ => false,
    };
    let entries: Vec<Entry> =
        class.iter().map(|&(_, index)| Entry { index, reversed: turned(index) }).collect();
    for k in 0..Kind::of(surface(chosen)).numbers() {
        let width = width(surfaces, &entries, k);
        if width.in_largest() > 4.0 {
            return Err(WideClass { first: width.lo.1, second: width.hi.1 });
        }
    }
    for entry in entries {
        shared.representative[entry.index()] = chosen;
        shared.flipped[entry.index()] = entry.reversed && matches!(surface(chosen), Surface::Plane(_));
    }
    Ok(())
}

/// The total order of the bits of two surfaces of one kind.
fn by_bits(a: &Surface, b: &Surface) -> Ordering {
    match (a, b) {
        // by far the most common kinds, spelled out for speed
        (Surface::Plane(a), Surface::Plane(b)) => {
            by_numbers(&a.normal.to_array(), &b.normal.to_array()).then(a.offset.total_cmp(&b.offset))
        }
        _ => (0..Kind::of(a).numbers())
            .map(|k| number(a, 0.0, false, k).0.total_cmp(&number(b, 0.0, false, k).0))
            .find(|order| order.is_ne())
            .unwrap_or(Ordering::Equal),
    }
}

fn by_numbers(a: &[f64], b: &[f64]) -> Ordering {
    let orders = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
    orders.fold(Ordering::Equal, Ordering::then)
}
