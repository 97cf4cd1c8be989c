//! Surface sharing: finds equal surfaces of a group and replaces them by one canonical representative.
//!
//! Two touching solids have two copies of their common face, which differ by the rounding of the placement maps.
//! Compilation identifies equal surfaces, so that their roots are bit-identical. Copies that are not identified here are
//! still welded along each ray: sharing is an improvement, not a requirement.
//!
//! Two surfaces of the same kind are equal if all their parameters are: components of unit vectors within 64 u, lengths
//! within 64 u times the larger magnitude of the two, factors within 64 u relative; axes and planes in either sense.
//! Quadrics are equal if their equations are, however their axes are chosen and up to sign, also to spheres, cylinders and
//! cones (`second_degree.rs`). Affine images of tori must have equal parameters. Objects are equal if their forms are
//! bit-identical and their placements equal within these tolerances.
//!
//! *Method*: a sorted sweep. The surfaces of one kind are sorted by one parameter and cut wherever neighbours differ by
//! more than the tolerance; each part is sorted by the next parameter, until no parameter cuts it. (Hashing of rounded
//! parameters would separate pairs on both sides of a rounding border.) Usually a part has one bit pattern, or is narrower
//! than the tolerance in every parameter, and is one class; in other parts all pairs are compared and joined (union-find).
//! The cost is O(n log n) for n surfaces unless many of them form a chain wider than the tolerance.

use super::second_degree::{Equation, TOLERANCE};
use super::{Plane, Surface};
use rayweave_math::Vec3;
use std::borrow::Borrow;
use std::cmp::Ordering;

/// The classes of equal surfaces.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Shared {
    /// Index of the representative of each surface: the smallest member of its class in the total order of bits.
    pub representative: Vec<u32>,
    /// True if f of the surface has the opposite sign of that of the representative: a plane with the opposite normal, a quadric
    /// with the negative matrix.
    pub flipped: Vec<bool>,
}

/// A chain of surfaces, each equal to the next within the tolerance, with ends more than four tolerances (for
/// the largest magnitude in the chain) apart: neither one surface nor several. The model is nearly but not
/// exactly aligned.
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
            "surfaces {} and {} are neither equal nor distinct: they differ by more than the tolerance, but a chain of nearly equal surfaces connects them. Round their coordinates to fewer digits.",
            self.first, self.second
        )
    }
}

impl std::error::Error for WideClass {}

/// A surface to compare, with its magnitude bound.
struct Candidate<'a> {
    surface: &'a Surface,
    magnitude: f64,
    /// The equation of a quadric and, if some quadric may be round, of every surface of degree 2.
    equation: Option<Box<Equation>>,
}

/// Finds equal surfaces. Each comes with its magnitude bound: its own or, better, one that includes the
/// composed translations. At most `u32::MAX` surfaces.
pub fn share<S: Borrow<Surface>>(surfaces: &[(S, f64)]) -> Result<Shared, WideClass> {
    let surfaces = &candidates(surfaces.iter().map(|(s, magnitude)| (s.borrow(), *magnitude)));
    let mut classes = Classes::new(surfaces.len());
    for kind in Kind::ALL {
        for part in by_form(surfaces, entries(surfaces, kind)) {
            sweep(surfaces, kind, part, &mut classes);
        }
    }
    classes.into_shared(surfaces)
}

fn candidates<'a>(surfaces: impl Iterator<Item = (&'a Surface, f64)>) -> Vec<Candidate<'a>> {
    let mut any_is_round = false;
    let mut candidates: Vec<Candidate> = surfaces
        .map(|(surface, magnitude)| {
            let is_quadric = matches!(surface, Surface::Quadric(_));
            let equation = is_quadric.then(|| Equation::new(surface)).flatten().map(Box::new);
            any_is_round |= equation.as_ref().is_some_and(|equation| equation.is_round);
            Candidate { surface, magnitude, equation }
        })
        .collect();
    if any_is_round {
        for candidate in candidates.iter_mut().filter(|candidate| candidate.equation.is_none()) {
            candidate.equation = Equation::new(candidate.surface).map(Box::new);
        }
    }
    candidates
}

/// Splits entries of one kind by properties without a tolerance: the forms of objects.
fn by_form(surfaces: &[Candidate], mut entries: Vec<Entry>) -> Vec<Vec<Entry>> {
    let object = |entry: &Entry| match surfaces[entry.index()].surface {
        Surface::Object(object) => Some(object),
        _ => None,
    };
    let Some(true) = entries.first().map(|entry| object(entry).is_some()) else { return vec![entries] };
    entries.sort_by_cached_key(|entry| object(entry).map(|object| object.form.fingerprint()));
    let is_same = |a: &Entry, b: &Entry| object(a).zip(object(b)).is_some_and(|(a, b)| a.has_form_of(b));
    entries.chunk_by(is_same).map(<[Entry]>::to_vec).collect()
}

/// A surface, possibly with all its unit vectors reversed; a quadric possibly with the sign of its equation reversed.
#[derive(Clone, Copy, Debug)]
struct Entry {
    index: u32,
    reversed: bool,
}

impl Entry {
    fn index(&self) -> usize {
        self.index as usize
    }

    fn sign(&self) -> f64 {
        if self.reversed { -1.0 } else { 1.0 }
    }
}

/// Each surface of a kind in the sense for which its vector points along a fixed direction or the trace of its equation is
/// positive; in both senses if the vector is perpendicular to that direction, or the trace is 0, within the tolerance.
fn entries(surfaces: &[Candidate], kind: Kind) -> Vec<Entry> {
    let mut entries = Vec::new();
    for (index, candidate) in surfaces.iter().enumerate() {
        let along = match (&candidate.equation, kind) {
            (Some(equation), Kind::Quadric) => equation.trace(),
            _ if Kind::of(candidate.surface) == kind => {
                sense(candidate.surface).map_or(1.0, |v| v.dot(SENSE))
            }
            _ => continue,
        };
        for reversed in [false, true] {
            let along = if reversed { -along } else { along };
            if along > -1e-12 {
                entries.push(Entry { index: index as u32, reversed });
            }
        }
    }
    entries
}

/// A direction to which hardly any plane or axis of a man-made model is perpendicular.
const SENSE: Vec3 = Vec3::new(0.617_340_218_6, 0.531_871_409_3, 0.579_913_306_7);

/// The unit vector that describes the same surface in either sense.
fn sense(surface: &Surface) -> Option<Vec3> {
    match surface {
        Surface::Plane(s) => Some(s.normal),
        Surface::Cylinder(s) => Some(s.axis),
        Surface::Cone(s) => Some(s.axis),
        Surface::Torus(s) => Some(s.axis),
        Surface::Sphere(_) | Surface::Quadric(_) | Surface::AffineTorus(_) | Surface::Object(_) => None,
    }
}

/// A kind of surface. Only surfaces of one kind are compared; every [`Candidate`] with an equation counts as a quadric, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
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

    /// Number of parameters of a surface of this kind.
    fn numbers(self) -> usize {
        match self {
            Kind::Plane | Kind::Sphere => 4,
            Kind::Cylinder | Kind::Cone => 7,
            Kind::Torus => 8,
            Kind::Quadric => Equation::NUMBERS,
            Kind::AffineTorus => 17,
            Kind::Object => 12,
        }
    }
}

/// Parameter `k` of an entry as a surface of a kind, with the tolerance for equality.
fn number(surfaces: &[Candidate], kind: Kind, entry: &Entry, k: usize) -> (f64, f64) {
    let &Candidate { surface, magnitude, ref equation } = &surfaces[entry.index()];
    match (equation, kind) {
        (Some(equation), Kind::Quadric) => equation.number(magnitude, entry.sign(), k),
        _ => own_number(surface, magnitude, entry.sign(), k),
    }
}

/// Parameter `k` of a surface as one of its own kind, with its vectors times `sign`.
fn own_number(surface: &Surface, magnitude: f64, sign: f64, k: usize) -> (f64, f64) {
    let length = |x: f64| (x, TOLERANCE * magnitude);
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
            // tolerance as an angle
            _ => (s.slope, TOLERANCE * (1.0 + s.slope * s.slope)),
        },
        // compared as equations
        Surface::Quadric(s) => (s.numbers()[k], 0.0),
        Surface::Torus(s) => match k {
            0..3 => length(s.centre[k]),
            3..6 => unit(s.axis[k - 3]),
            6 => length(s.major),
            _ => length(s.minor),
        },
        // equal only under equal maps
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

/// Entries from `first` to `last`, which the `uncut` parameters before `next` did not cut.
struct Part {
    first: usize,
    last: usize,
    next: usize,
    uncut: usize,
}

/// Cuts the entries of one kind until no parameter cuts them, and joins the parts.
fn sweep(surfaces: &[Candidate], kind: Kind, mut entries: Vec<Entry>, classes: &mut Classes) {
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
            join(surfaces, kind, slice, classes);
            continue;
        }
        sort_by_number(surfaces, kind, slice, part.next, &mut keyed);
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

/// True if all entries are bit-identical: copies of one face, which are common in large models.
fn are_same_bits(surfaces: &[Candidate], entries: &[Entry]) -> bool {
    let (first, rest) = (&entries[0], &entries[1..]);
    rest.iter().all(|entry| {
        entry.reversed == first.reversed
            && by_bits(surfaces[entry.index()].surface, surfaces[first.index()].surface).is_eq()
    })
}

/// An entry with one of its parameters and the tolerance.
type Keyed = (f64, f64, Entry);

fn sort_by_number(
    surfaces: &[Candidate],
    kind: Kind,
    entries: &mut [Entry],
    k: usize,
    keyed: &mut Vec<Keyed>,
) {
    keyed.clear();
    keyed.extend(entries.iter().map(|e| {
        let (value, tolerance) = number(surfaces, kind, e, k);
        (value, tolerance, *e)
    }));
    keyed.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    for (entry, key) in entries.iter_mut().zip(keyed.iter()) {
        *entry = key.2;
    }
}

/// Gaps between the sorted parameters, each widened by its tolerance: no entry before a gap equals one after it.
fn cuts(keyed: &[Keyed]) -> impl Iterator<Item = usize> {
    let mut end = f64::NEG_INFINITY;
    keyed.iter().enumerate().filter_map(move |(k, &(value, tolerance, _))| {
        let gap = k > 0 && value - tolerance > end;
        end = end.max(value + tolerance);
        gap.then_some(k)
    })
}

/// Joins the entries of an uncut part: all of them if it is narrow or, of quadrics, if all are equal to the first; else all
/// equal pairs.
fn join(surfaces: &[Candidate], kind: Kind, part: &mut [Entry], classes: &mut Classes) {
    let widths = (0..kind.numbers()).map(|k| width(surfaces, kind, part, k));
    let widest = widths.max_by(|a, b| a.in_smallest().total_cmp(&b.in_smallest()));
    let is_one_class = match kind {
        Kind::Quadric => part[1..].iter().all(|entry| equal(surfaces, kind, &part[0], entry)),
        _ => widest.as_ref().is_none_or(|w| w.in_smallest() <= 1.0),
    };
    if is_one_class {
        for entry in &part[1..] {
            classes.union(part[0].index, entry.index);
        }
        return;
    }
    let widest = widest.map_or(0, |w| w.number);
    let mut keyed = Vec::new();
    sort_by_number(surfaces, kind, part, widest, &mut keyed);
    for (k, a) in keyed.iter().enumerate() {
        for b in &keyed[k + 1..] {
            if b.0 - a.0 > a.1 + b.1 {
                break;
            }
            if equal(surfaces, kind, &a.2, &b.2) {
                classes.union(a.2.index, b.2.index);
            }
        }
    }
}

fn equal(surfaces: &[Candidate], kind: Kind, a: &Entry, b: &Entry) -> bool {
    let has_equal_numbers = (0..kind.numbers()).all(|k| {
        let ((x, x_tolerance), (y, y_tolerance)) =
            (number(surfaces, kind, a, k), number(surfaces, kind, b, k));
        (x - y).abs() <= x_tolerance.max(y_tolerance)
    });
    let [first, second] = [a, b].map(|entry| surfaces[entry.index()].equation.as_ref());
    has_equal_numbers
        && match (kind, first.zip(second)) {
            (Kind::Quadric, Some((first, second))) => first.has_axes_of(second, a.sign() * b.sign()),
            _ => true,
        }
}

/// Range of one parameter in a set of entries.
#[derive(Clone, Copy)]
struct Width {
    number: usize,
    lo: (f64, usize),
    hi: (f64, usize),
    /// Tolerances of the members with the smallest and the largest magnitude.
    tolerances: [f64; 2],
}

impl Width {
    /// The range in units of the smallest tolerance; up to 1, all members are equal to each other.
    fn in_smallest(&self) -> f64 {
        self.in_units(self.tolerances[0])
    }

    /// The range in units of the largest tolerance, which the class has if its members are merged.
    fn in_largest(&self) -> f64 {
        self.in_units(self.tolerances[1])
    }

    fn in_units(&self, tolerance: f64) -> f64 {
        let range = self.hi.0 - self.lo.0;
        if range == 0.0 { 0.0 } else { range / tolerance }
    }
}

fn width(surfaces: &[Candidate], kind: Kind, entries: &[Entry], k: usize) -> Width {
    let mut width = Width {
        number: k,
        lo: (f64::INFINITY, 0),
        hi: (f64::NEG_INFINITY, 0),
        tolerances: [f64::INFINITY, 0.0],
    };
    for entry in entries {
        let (value, tolerance) = number(surfaces, kind, entry, k);
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

/// Union-find with path halving; the root of a class is its lowest index.
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

    fn into_shared(mut self, surfaces: &[Candidate]) -> Result<Shared, WideClass> {
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

fn add_class(surfaces: &[Candidate], class: &[(u32, u32)], shared: &mut Shared) -> Result<(), WideClass> {
    let surface = |k: u32| surfaces[k as usize].surface;
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
    let kinds = class.iter().map(|&(_, k)| Kind::of(surface(k)));
    let kind = if kinds.clone().any(|kind| kind == Kind::Quadric) {
        Kind::Quadric
    } else {
        Kind::of(surface(chosen))
    };
    let equation = |k: u32| surfaces[k as usize].equation.as_ref().filter(|_| kind == Kind::Quadric);
    let is_reversed = |k: u32| match equation(k).zip(equation(chosen)) {
        Some((own, chosen)) => own.is_negative_of(chosen),
        None => {
            sense(surface(k)).zip(sense(surface(chosen))).is_some_and(|(own, chosen)| own.dot(chosen) < 0.0)
        }
    };
    let entries: Vec<Entry> =
        class.iter().map(|&(_, index)| Entry { index, reversed: is_reversed(index) }).collect();
    for k in 0..kind.numbers() {
        let width = width(surfaces, kind, &entries, k);
        if width.in_largest() > 4.0 {
            return Err(WideClass { first: width.lo.1, second: width.hi.1 });
        }
    }
    for entry in entries {
        shared.representative[entry.index()] = chosen;
        shared.flipped[entry.index()] = entry.reversed && matches!(kind, Kind::Plane | Kind::Quadric);
    }
    Ok(())
}

/// The total order of two surfaces: by kind, and of one kind by their bits.
fn by_bits(a: &Surface, b: &Surface) -> Ordering {
    match (a, b) {
        // explicit for speed: by far the most frequent kinds
        (Surface::Plane(a), Surface::Plane(b)) => {
            by_numbers(&a.normal.to_array(), &b.normal.to_array()).then(a.offset.total_cmp(&b.offset))
        }
        (Surface::Quadric(a), Surface::Quadric(b)) => by_numbers(&a.numbers(), &b.numbers()),
        _ if Kind::of(a) != Kind::of(b) => Kind::of(a).cmp(&Kind::of(b)),
        _ => (0..Kind::of(a).numbers())
            .map(|k| own_number(a, 0.0, 1.0, k).0.total_cmp(&own_number(b, 0.0, 1.0, k).0))
            .find(|order| order.is_ne())
            .unwrap_or(Ordering::Equal),
    }
}

fn by_numbers(a: &[f64], b: &[f64]) -> Ordering {
    let orders = a.iter().zip(b).map(|(a, b)| a.total_cmp(b));
    orders.fold(Ordering::Equal, Ordering::then)
}
