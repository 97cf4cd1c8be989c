//! Hand-written kernel of the die, (box & sphere) - three cylinders: no program, no sweep, no
//! branch.
//!
//! Each leaf is an interval. Each of its two ends is a crossing of the die if the boolean
//! expression changes there, given the memberships of the *other* leaves at that time; this takes
//! comparisons and masks. A sorting network sorts the ends; those that are not crossings are set to
//! infinity. The first crossing is the minimum of the ends instead.
//!
//! There are no closures: one that is not inlined would be compiled without the SIMD target
//! features.
//!
//! Only for rays in general position: ends at equal times and rays parallel to a face are not
//! handled.

use super::lanes::{Lanes, Native};
use super::network::{End, sort};
use fearless_simd::{Level, dispatch};
use rayweave::model::Rays;

/// Half the edge of the box.
pub const HALF: f64 = 1.0;
/// The radius of the sphere.
pub const SPHERE: f64 = 1.35;
/// The radius of the cylinders, which are unbounded, about the x, y and z axes.
pub const BORE: f64 = 0.5;

/// The maximum number of crossings of a ray: a convex core minus three convex bores has at most
/// four spans.
pub const ROWS: usize = 8;

/// Faces in the order of the leaves and of their facets: x-, x+, y-, y+, z-, z+ of the box, the sphere, the cylinders.
const SPHERE_FACE: i64 = 6;

/// Interval of a ray inside a leaf, with the faces of entry and exit.
struct Leaf<L: Lanes> {
    ends: [End<L>; 2],
}

impl<L: Lanes> Leaf<L> {
    /// Mask of t inside the interval.
    #[inline(always)]
    fn holds(&self, t: L) -> L::Mask {
        self.ends[0].0.below(t) & t.below(self.ends[1].0)
    }
}

/// One ray per lane.
struct Ray<L> {
    origin: [L; 3],
    direction: [L; 3],
}

/// All crossings of the die on each ray, in order of time: the times, padded with +inf, and the
/// faces, undefined where the time is +inf.
///
/// # Panics
/// If there are fewer than 16 rays, or rows shorter than the batch.
pub fn crossings(
    level: Level,
    rays: &Rays<'_>,
    times: &mut [&mut [f64]; ROWS],
    faces: &mut [&mut [i32]; ROWS],
) {
    dispatch!(level, simd => all(Native::zero(simd), rays, times, faces));
}

/// [`crossings`] for one type of lanes.
#[inline(always)]
pub fn all<L: Lanes>(
    zero: L,
    rays: &Rays<'_>,
    times: &mut [&mut [f64]; ROWS],
    faces: &mut [&mut [i32]; ROWS],
) {
    let last = rays.len() - L::COUNT;
    for at in (0..rays.len()).step_by(L::COUNT).map(|at| at.min(last)) {
        let ends = sorted_ends(&load(zero, rays, at));
        let span = at..at + L::COUNT;
        for row in 0..ROWS {
            ends[row].0.store(&mut times[row][span.clone()]);
        }
        for (pair, rows) in faces.chunks_exact_mut(2).enumerate() {
            if let [first, second] = rows {
                let out = [&mut first[span.clone()], &mut second[span.clone()]];
                L::store_numbers([ends[2 * pair].1, ends[2 * pair + 1].1], out);
            }
        }
    }
}

/// First hit of each ray after t = 0.
pub struct First<'a> {
    /// The time; +inf for a miss, for which the other fields are undefined.
    pub t: &'a mut [f64],
    /// The number of the face.
    pub face: &'a mut [i32],
    /// The outward unit normal.
    pub normal: [&'a mut [f64]; 3],
}

/// The first crossing of each ray, with its normal.
///
/// # Panics
/// As [`crossings`].
pub fn first(level: Level, rays: &Rays<'_>, out: &mut First<'_>) {
    dispatch!(level, simd => first_of_all(Native::zero(simd), rays, out));
}

/// [`first`] for one type of lanes.
#[inline(always)]
pub fn first_of_all<L: Lanes>(zero: L, rays: &Rays<'_>, out: &mut First<'_>) {
    // two steps at a time, because integers are stored in pairs
    let (step, last) = (2 * L::COUNT, rays.len() - 2 * L::COUNT);
    for at in (0..rays.len()).step_by(step).map(|at| at.min(last)) {
        let faces = [nearest(zero, rays, at, out), nearest(zero, rays, at + L::COUNT, out)];
        let (low, high) = out.face[at..at + step].split_at_mut(L::COUNT);
        L::store_numbers(faces, [low, high]);
    }
}

/// One step: writes time and normal, and returns the face.
#[inline(always)]
fn nearest<L: Lanes>(zero: L, rays: &Rays<'_>, at: usize, out: &mut First<'_>) -> L::Numbers {
    let ray = load(zero, rays, at);
    let leaves = leaves(&ray);
    let [p, q, a, b, c] = kept(&leaves);
    let (p, q, a, b, c) = (sooner(p), sooner(q), sooner(a), sooner(b), sooner(c));
    let (t, face) = earlier(earlier(p, q), earlier(earlier(a, b), c));
    let span = at..at + L::COUNT;
    t.store(&mut out.t[span.clone()]);
    let on = [!t.below(p.0), !t.below(q.0), !t.below(a.0), !t.below(b.0), !t.below(c.0)];
    let normal = normal(&ray, t, on);
    for axis in 0..3 {
        normal[axis].store(&mut out.normal[axis][span.clone()]);
    }
    face
}

/// The earlier of two ends after t = 0.
#[inline(always)]
fn sooner<L: Lanes>([a, b]: [End<L>; 2]) -> End<L> {
    earlier(ahead(a), ahead(b))
}

/// The end, or infinity if it is not after t = 0.
#[inline(always)]
fn ahead<L: Lanes>((t, face): End<L>) -> End<L> {
    (L::choose(t.like(0.0).below(t), t, t.like(f64::INFINITY)), face)
}

/// The normal at t on a given leaf: box, sphere, cylinders.
#[inline(always)]
fn normal<L: Lanes>(ray: &Ray<L>, t: L, on: [L::Mask; 5]) -> [L; 3] {
    let zero = t.like(0.0);
    let mut normal = [zero; 3];
    for axis in 0..3 {
        let x = ray.origin[axis] + t * ray.direction[axis];
        let of_ball = x * x.like(1.0 / SPHERE);
        // the die is entered where a bore is left
        let of_bore = x * x.like(-1.0 / BORE);
        let near = slab(ray, axis).ends;
        let on_slab = !(near[0].0.below(t) & t.below(near[1].0));
        let of_block = L::choose(on_slab, L::choose(zero.below(x), x.like(1.0), x.like(-1.0)), zero);
        let (k, l) = ((axis + 1) % 3, (axis + 2) % 3);
        normal[axis] = L::choose(on[0], of_block, normal[axis]);
        normal[axis] = L::choose(on[1], of_ball, normal[axis]);
        normal[axis] = L::choose(on[2 + k] | on[2 + l], of_bore, normal[axis]);
    }
    normal
}

#[inline(always)]
fn load<L: Lanes>(zero: L, rays: &Rays<'_>, at: usize) -> Ray<L> {
    Ray { origin: load_three(zero, &rays.origins, at), direction: load_three(zero, &rays.directions, at) }
}

#[inline(always)]
fn load_three<L: Lanes>(zero: L, columns: &[&[f64]; 3], at: usize) -> [L; 3] {
    let span = at..at + L::COUNT;
    let [x, y, z] = columns;
    [zero.load(&x[span.clone()]), zero.load(&y[span.clone()]), zero.load(&z[span])]
}

/// The sorted ends of the leaves; ends that are not crossings of the die are at infinity, last.
#[inline(always)]
fn sorted_ends<L: Lanes>(ray: &Ray<L>) -> [End<L>; 10] {
    let [[t0, t1], [t2, t3], [t4, t5], [t6, t7], [t8, t9]] = kept(&leaves(ray));
    let mut ends = [t0, t1, t2, t3, t4, t5, t6, t7, t8, t9];
    sort(&mut ends);
    ends
}

/// The box, the sphere and the cylinders.
#[inline(always)]
fn leaves<L: Lanes>(ray: &Ray<L>) -> [Leaf<L>; 5] {
    [block(ray), ball(ray), bore(ray, 0), bore(ray, 1), bore(ray, 2)]
}

/// The ends of each leaf; ends that are not crossings of the die are at infinity.
#[inline(always)]
fn kept<L: Lanes>([block, ball, a, b, c]: &[Leaf<L>; 5]) -> [[End<L>; 2]; 5] {
    [
        crossings_of(block, [ball], [a, b, c]),
        crossings_of(ball, [block], [a, b, c]),
        crossings_of(a, [block, ball], [b, c]),
        crossings_of(b, [block, ball], [a, c]),
        crossings_of(c, [block, ball], [a, b]),
    ]
}

/// The ends of a leaf that lie inside all leaves of the first set and outside all of the second;
/// others are at infinity.
#[inline(always)]
fn crossings_of<L: Lanes, const IN: usize, const OUT: usize>(
    leaf: &Leaf<L>,
    within: [&Leaf<L>; IN],
    outside: [&Leaf<L>; OUT],
) -> [End<L>; 2] {
    let [first, second] = leaf.ends;
    [keep(first, within, outside), keep(second, within, outside)]
}

/// One of these ends.
#[inline(always)]
fn keep<L: Lanes, const IN: usize, const OUT: usize>(
    (t, face): End<L>,
    within: [&Leaf<L>; IN],
    outside: [&Leaf<L>; OUT],
) -> End<L> {
    let mut kept = within[0].holds(t);
    for leaf in &within[1..] {
        kept = kept & leaf.holds(t);
    }
    for leaf in outside {
        kept = kept & !leaf.holds(t);
    }
    (L::choose(kept, t, t.like(f64::INFINITY)), face)
}

/// The interval in the box, between the last plane entered and the first one left. For a ray that
/// misses the box the exit precedes the entry; the ends of such an empty interval are not
/// crossings.
#[inline(always)]
fn block<L: Lanes>(ray: &Ray<L>) -> Leaf<L> {
    let slabs = [slab(ray, 0), slab(ray, 1), slab(ray, 2)];
    let [a, b, c] = slabs;
    let enters = later(later(a.ends[0], b.ends[0]), c.ends[0]);
    let leaves = earlier(earlier(a.ends[1], b.ends[1]), c.ends[1]);
    let hit = enters.0.below(leaves.0);
    let nowhere = enters.0.like(f64::NAN);
    Leaf {
        ends: [(L::choose(hit, enters.0, nowhere), enters.1), (L::choose(hit, leaves.0, nowhere), leaves.1)],
    }
}

#[inline(always)]
fn pick<L: Lanes>(mask: L::Mask, yes: End<L>, no: End<L>) -> End<L> {
    (L::choose(mask, yes.0, no.0), L::choose_number(mask, yes.1, no.1))
}

#[inline(always)]
fn later<L: Lanes>(a: End<L>, b: End<L>) -> End<L> {
    pick(a.0.below(b.0), b, a)
}

#[inline(always)]
fn earlier<L: Lanes>(a: End<L>, b: End<L>) -> End<L> {
    pick(b.0.below(a.0), b, a)
}

/// The interval between two planes of the box.
#[inline(always)]
fn slab<L: Lanes>(ray: &Ray<L>, axis: usize) -> Leaf<L> {
    let (o, d) = (ray.origin[axis], ray.direction[axis]);
    let inverse = o.like(1.0) / d;
    let (low, high) = ((o.like(-HALF) - o) * inverse, (o.like(HALF) - o) * inverse);
    let forward = o.like(0.0).below(d);
    let (low_face, high_face) = (o.number(2 * axis as i64), o.number(2 * axis as i64 + 1));
    Leaf {
        ends: [
            (low.least(high), L::choose_number(forward, low_face, high_face)),
            (low.greatest(high), L::choose_number(forward, high_face, low_face)),
        ],
    }
}

/// The interval in the sphere.
#[inline(always)]
fn ball<L: Lanes>(ray: &Ray<L>) -> Leaf<L> {
    let [[x, y, z], [u, v, w]] = [ray.origin, ray.direction];
    let a = u * u + v * v + w * w;
    let b = x * u + y * v + z * w;
    let c = x * x + y * y + z * z - x.like(SPHERE * SPHERE);
    quadric(a, b, c, SPHERE_FACE)
}

/// The interval in the cylinder along an axis.
#[inline(always)]
fn bore<L: Lanes>(ray: &Ray<L>, axis: usize) -> Leaf<L> {
    let (k, l) = ((axis + 1) % 3, (axis + 2) % 3);
    let (x, y, u, v) = (ray.origin[k], ray.origin[l], ray.direction[k], ray.direction[l]);
    let a = u * u + v * v;
    let b = x * u + y * v;
    let c = x * x + y * y - x.like(BORE * BORE);
    quadric(a, b, c, SPHERE_FACE + 1 + axis as i64)
}

/// The interval between the roots of a t^2 + 2 b t + c, a > 0: (-b -+ sqrt(b^2 - a c)) / a; NaN if
/// there are none.
#[inline(always)]
fn quadric<L: Lanes>(a: L, b: L, c: L, face: i64) -> Leaf<L> {
    let root = (b * b - a * c).root();
    let inverse = a.like(1.0) / a;
    let face = a.number(face);
    Leaf { ends: [((-b - root) * inverse, face), ((root - b) * inverse, face)] }
}

#[cfg(test)]
mod tests {
    use super::super::lanes::{Counted, Tally};
    use super::*;
    use crate::answer::{FirstTable, HitTable};
    use crate::batch::incoherent;
    use crate::exemplar::die::program;
    use crate::level;
    use rayweave::model::{FirstHits, HitArrayRows, RayBatch};
    use rayweave::{Evaluator, Reference, Window};
    use std::sync::Arc;

    const COUNT: usize = 4096;

    /// All crossings by the kernel: times and faces, row by row.
    fn by_hand(
        batch: &RayBatch,
        run: impl Fn(&mut [&mut [f64]; ROWS], &mut [&mut [i32]; ROWS]),
    ) -> (Vec<f64>, Vec<i32>) {
        let count = batch.rays().len();
        let (mut times, mut faces) = (vec![0.0; ROWS * count], vec![0; ROWS * count]);
        run(&mut rows(&mut times, count), &mut rows(&mut faces, count));
        (times, faces)
    }

    fn rows<T>(table: &mut [T], columns: usize) -> [&mut [T]; ROWS] {
        let mut rows = table.chunks_mut(columns);
        std::array::from_fn(|_| rows.next().unwrap())
    }

    fn by_reference(batch: &RayBatch) -> (Vec<f64>, Vec<i32>) {
        let reference = Reference::new(Arc::new(program().unwrap()));
        let count = batch.rays().len();
        let (mut times, mut faces) = (vec![0.0; ROWS * count], vec![0; ROWS * count]);
        let most = reference.hits(
            batch.rays(),
            Window::ALL,
            &mut reference.scratch(),
            &mut HitArrayRows { times: &mut rows(&mut times, count), faces: &mut rows(&mut faces, count) },
        );
        assert!(most <= ROWS);
        (times, faces)
    }

    #[test]
    fn agrees_with_the_reference_at_every_level() {
        let batch = incoherent(COUNT, 7);
        let (times, faces) = by_reference(&batch);
        let crossings_there = times.iter().filter(|t| t.is_finite()).count() as f64 / COUNT as f64;
        assert!((crossings_there - 2.73).abs() < 0.1, "{crossings_there}");
        for level in level::available(None) {
            let (t, face) = by_hand(&batch, |times, faces| crossings(level, &batch.rays(), times, faces));
            for i in 0..t.len() {
                let (expected, found) = (times[i], t[i]);
                let same = expected == found || (expected - found).abs() <= 1e-9 * expected.abs();
                assert!(same, "{level:?}: entry {i} at {found} instead of {expected}");
                assert!(expected == f64::INFINITY || faces[i] == face[i], "{level:?}: entry {i}");
            }
        }
    }

    #[test]
    fn first_hits_agree_with_the_reference() {
        let batch = incoherent(COUNT, 8);
        let reference = Reference::new(Arc::new(program().unwrap()));
        let mut table = FirstTable::new(COUNT);
        let mut hits = table.hits();
        reference.nearest(batch.rays(), crate::answer::ahead().unwrap(), &mut reference.scratch(), &mut hits);
        let FirstHits { t: expected, face: expected_face, normal: Some(expected_normal), .. } = hits else {
            panic!("normals were requested");
        };
        for level in level::available(None) {
            let (mut t, mut face) = (vec![0.0; COUNT], vec![0; COUNT]);
            let mut normal = [vec![0.0; COUNT], vec![0.0; COUNT], vec![0.0; COUNT]];
            let [x, y, z] = &mut normal;
            first(level, &batch.rays(), &mut First { t: &mut t, face: &mut face, normal: [x, y, z] });
            for i in (0..COUNT).filter(|&i| expected[i].is_finite()) {
                assert!((t[i] - expected[i]).abs() <= 1e-9 * expected[i], "{level:?}: ray {i}");
                assert_eq!(face[i], expected_face[i], "{level:?}: ray {i}");
                for axis in 0..3 {
                    assert!((normal[axis][i] - expected_normal[axis][i]).abs() < 1e-7, "{level:?}: ray {i}");
                }
            }
            assert_eq!(
                t.iter().filter(|t| t.is_finite()).count(),
                expected.iter().filter(|t| t.is_finite()).count()
            );
        }
    }

    #[test]
    fn one_counting_lane_does_the_same() {
        let batch = incoherent(64, 9);
        let tally = Tally::default();
        let (counted, _) =
            by_hand(&batch, |times, faces| all(Counted::zero(&tally), &batch.rays(), times, faces));
        let level = level::available(None)[0];
        let (native, _) = by_hand(&batch, |times, faces| crossings(level, &batch.rays(), times, faces));
        assert_eq!(counted, native, "the same operations in the same order give the same bits");
        // a root for each of four quadrics, a division for each of them and each slab
        assert_eq!((tally.roots(), tally.divisions()), (4 * 64, 7 * 64));
        assert!(tally.simple() > 64 * 29 * 3, "the network alone has 29 comparators");
    }

    /// A batch that is not a multiple of a step ends with a step that overlaps the previous one.
    #[test]
    fn the_last_step_may_overlap() {
        let (batch, fewer) = (incoherent(40, 3), incoherent(37, 3));
        let level = Level::new();
        let (all, _) = by_hand(&batch, |times, faces| crossings(level, &batch.rays(), times, faces));
        let (some, _) = by_hand(&fewer, |times, faces| crossings(level, &fewer.rays(), times, faces));
        for row in 0..ROWS {
            assert_eq!(all[40 * row..][..37], some[37 * row..][..37]);
        }
        let mut table = HitTable::new(2, 3);
        assert_eq!(table.rows().0.len(), 2);
    }
}
