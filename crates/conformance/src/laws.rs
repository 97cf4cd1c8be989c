//! Laws that hold for every model: boolean identities, motions, reversal of the ray, and others.

use crate::in_surface::grid_ray;
use crate::models::{Model, compiled, motion, solid};
use crate::rays::{batch, rays};
use crate::{Effort, Random, Style, Tally, list};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Collected, Crossing, Evaluator, Program, Query, Region, RegionId, Solid, Window};
use rayweave_shape::Ray;
use std::sync::Arc;

/// The name of a law, and a function that makes two equivalent solids.
type Law = (&'static str, fn(&[Solid; 3]) -> (Solid, Solid));

const BOOLEAN: &[Law] = &[
    ("A | B = B | A", |[a, b, _]| (a | b, b | a)),
    ("A & B = B & A", |[a, b, _]| (a & b, b & a)),
    ("A ^ B = B ^ A", |[a, b, _]| (a ^ b, b ^ a)),
    ("(A | B) | C = A | (B | C)", |[a, b, c]| ((a | b) | c, a | (b | c))),
    ("(A & B) & C = A & (B & C)", |[a, b, c]| ((a & b) & c, a & (b & c))),
    ("(A ^ B) ^ C = A ^ (B ^ C)", |[a, b, c]| ((a ^ b) ^ c, a ^ (b ^ c))),
    ("union(C, A, B) = A | B | C", |[a, b, c]| (Solid::union([c, a, b].map(Solid::clone)), (a | b) | c)),
    ("odd(C, A, B) = A ^ B ^ C", |[a, b, c]| {
        (Solid::symmetric_difference([c, a, b].map(Solid::clone)), (a ^ b) ^ c)
    }),
    ("all(C, A, B) = A & B & C", |[a, b, c]| (Solid::intersection([c, a, b].map(Solid::clone)), (a & b) & c)),
    ("~(A | B) = ~A & ~B", |[a, b, _]| (!(a | b), !a & !b)),
    ("~(A & B) = ~A | ~B", |[a, b, _]| (!(a & b), !a | !b)),
    ("A - B = A & ~B", |[a, b, _]| (a - b, a & !b)),
    ("A ^ B = (A - B) | (B - A)", |[a, b, _]| (a ^ b, (a - b) | (b - a))),
    ("A ^ B = (A | B) - (A & B)", |[a, b, _]| (a ^ b, (a | b) - (a & b))),
    ("~(A ^ B) = ~A ^ B", |[a, b, _]| (!(a ^ b), !a ^ b)),
    ("A | (A & B) = A", |[a, b, _]| (a | (a & b), a.clone())),
    ("A & (A | B) = A", |[a, b, _]| (a & (a | b), a.clone())),
    ("A | A = A", |[a, ..]| (a | &a.clone(), a.clone())),
    ("A & A = A", |[a, ..]| (a & &a.clone(), a.clone())),
    ("A - A = empty", |[a, ..]| (a - &a.clone(), Solid::empty())),
    ("union(A, B, A) = A | B", |[a, b, _]| (Solid::union([a, b, a].map(Solid::clone)), a | b)),
    ("A | ~A = universe", |[a, ..]| (a | !a, Solid::universe())),
    ("A & ~A = empty", |[a, ..]| (a & !a, Solid::empty())),
    ("A ^ A = empty", |[a, ..]| (a ^ &a.clone(), Solid::empty())),
    ("A ^ ~A = universe", |[a, ..]| (a ^ !a, Solid::universe())),
    ("~~A = A", |[a, ..]| (!!a, a.clone())),
    ("A & (B | C) = (A & B) | (A & C)", |[a, b, c]| (a & (b | c), (a & b) | (a & c))),
    ("A | (B & C) = (A | B) & (A | C)", |[a, b, c]| (a | (b & c), (a | b) & (a | c))),
    ("A & (B ^ C) = (A & B) ^ (A & C)", |[a, b, c]| (a & (b ^ c), (a & b) ^ (a & c))),
    ("A - (B | C) = (A - B) - C", |[a, b, c]| (a - (b | c), (a - b) - c)),
    ("A - (B - C) = (A - B) | (A & C)", |[a, b, c]| (a - (b - c), (a - b) | (a & c))),
];

/// Tests boolean identities: the same crossings, bit for bit, for equivalent trees and any order of operands;
/// also for rays that lie in faces.
pub fn of_booleans<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("crossings unchanged by boolean identities");
    let rounds = 60 * effort.times();
    for seed in 0..rounds {
        let mut rng = Random::new(2_000_000 + seed);
        let style = [Style::Generic, Style::Grid, Style::Planes][seed as usize % 3];
        let frame = if rng.chance(0.5) { Affine::IDENTITY } else { motion(&mut rng) };
        let parts: [Solid; 3] = std::array::from_fn(|_| {
            let depth = rng.below(4);
            solid(&mut rng, style, depth)
        });
        let rays = rays(&mut rng, style, &frame, 30);
        // both sides of every law have the same leaves, and therefore the same ball and shared surfaces
        let nothing = Solid::union(parts.iter().map(nothing_of));
        let trace = |solid: Solid| {
            let program = compiled(Program::compile(&(solid | nothing.clone()).apply(frame)));
            make(program).collect(batch(&rays).rays(), &Query::default()).unwrap()
        };
        for (name, law) in BOOLEAN {
            let (left, right) = law(&parts);
            let (l, r) = (trace(left), trace(right));
            for (i, ray) in rays.iter().enumerate() {
                let same = l.starts[i] == r.starts[i] && bits(l.of(i)) == bits(r.of(i));
                tally.check(same, || {
                    let [a, b, c] = parts.each_ref().map(short);
                    let (left, right) = (list(l.of(i)), list(r.of(i)));
                    format!("{name}, seed {seed}, {ray:?}\nA = {a}\nB = {b}\nC = {c}\n{left}\nagainst{right}")
                });
            }
        }
    }
    tally.finish(rounds * 600);
}

/// The empty solid, with the leaves of `solid`: `A - A`.
pub(crate) fn nothing_of(solid: &Solid) -> Solid {
    solid - &solid.clone()
}

fn short(solid: &Solid) -> String {
    solid.to_string().chars().take(400).collect()
}

/// The part of a list that does not depend on the order in which leaves are declared.
fn bits(crossings: &[Crossing]) -> Vec<(u64, RegionId, RegionId)> {
    crossings.iter().map(|c| (c.t.to_bits(), c.before, c.after)).collect()
}

/// Tests scales by a power of two: times change by exactly that power, or not at all if the direction is
/// scaled too.
pub fn of_scale<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("crossings exactly scaled by powers of two");
    for_models(effort, 3_000_000, |rng, style, model| {
        let factor = rng.pick(&[0.125, 0.5, 2.0, 1024.0, 2f64.powi(40), 2f64.powi(-30)]);
        let map = Affine::scale(Vec3::splat(factor));
        let rays = rays(rng, style, &model.frame, 60);
        let (plain, scaled) = (trace(&make, model, &rays), {
            let rays: Vec<Ray> = rays.iter().map(|r| Ray::new(r.origin * factor, r.direction)).collect();
            trace(&make, &moved(model, &map), &rays)
        });
        for i in 0..rays.len() {
            let expected: Vec<_> =
                plain.of(i).iter().map(|c| ((c.t * factor).to_bits(), c.before, c.after)).collect();
            let same = plain.starts[i] == scaled.starts[i] && expected == bits(scaled.of(i));
            tally.check(same, || {
                let (l, r) = (list(plain.of(i)), list(scaled.of(i)));
                format!("scaled by {factor}: {:?}\n{model}{l}\nagainst{r}", rays[i])
            });
        }
    });
    tally.finish(5_000 * effort.times());
}

/// Tests motions and mirrors of model and ray together: the same crossings up to rounding.
pub fn of_motion<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("crossings unchanged by motions and mirrors");
    for_models(effort, 4_000_000, |rng, _, _| {
        // rays in faces are exempt from this law, so nothing may lie on a grid
        let model = Model::random(rng, Style::Generic);
        let map = if rng.chance(0.3) { Affine::mirror(rng.direction()) } else { motion(rng) };
        let rays = plain_rays(rng);
        let there: Vec<Ray> = rays.iter().map(|r| r.transformed(&map)).collect();
        let (plain, moved) = (trace(&make, &model, &rays), trace(&make, &moved(&model, &map), &there));
        for i in 0..rays.len() {
            let same = plain.starts[i] == moved.starts[i] && alike(plain.of(i), moved.of(i), 1e-5);
            tally.check(same, || {
                let (l, r) = (list(plain.of(i)), list(moved.of(i)));
                format!("moved by {map:?}: {:?}\n{model}{l}\nagainst{r}", rays[i])
            });
        }
    });
    tally.finish(3_000 * effort.times());
}

fn plain_rays(rng: &mut Random) -> Vec<Ray> {
    (0..60).map(|_| Ray::new(rng.point(4.0), rng.direction())).collect()
}

fn alike(a: &[Crossing], b: &[Crossing], tolerance: f64) -> bool {
    let pair = |(a, b): (&Crossing, &Crossing)| {
        let near = (a.t - b.t).abs() <= tolerance * (1.0 + a.t.abs());
        near && (a.before, a.after) == (b.before, b.after)
    };
    a.len() == b.len() && a.iter().zip(b).all(pair)
}

/// Tests that the reversed ray gives the reversed list: number and media in any case, surfaces and times for
/// models in which nothing is welded.
pub fn of_reversal<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("crossings mirrored by reversing the ray");
    for_models(effort, 5_000_000, |rng, style, model| {
        let rays = if style == Style::Generic { plain_rays(rng) } else { rays(rng, style, &model.frame, 60) };
        let back: Vec<Ray> = rays.iter().map(|r| Ray::new(r.origin, -r.direction)).collect();
        let (there, back) = (trace(&make, model, &rays), trace(&make, model, &back));
        for i in 0..rays.len() {
            let reversed: Vec<Crossing> = back.of(i).iter().rev().map(reverse).collect();
            // a change of region within one medium is not reported, so the ends are compared by medium
            let medium = |region: RegionId| match region.index() {
                0 => 0,
                k => model.regions[k - 1].medium,
            };
            let end = |answer: &Collected| answer.of(i).last().map_or(answer.starts[i], |c| c.after);
            let sides = |c: &Crossing| (medium(c.before), medium(c.after));
            let pairs = || there.of(i).iter().zip(&reversed);
            let mut same = there.of(i).len() == reversed.len();
            same &= medium(end(&there)) == medium(back.starts[i]);
            same &= medium(end(&back)) == medium(there.starts[i]);
            same &= pairs().all(|(a, b)| sides(a) == sides(b));
            if style == Style::Generic {
                same &= pairs().all(|(a, b)| a.face.surface == b.face.surface);
                same &= pairs().all(|(a, b)| (a.t - b.t).abs() <= 1e-9 * (1.0 + a.t.abs()));
            }
            tally.check(same, || {
                let (l, r) = (list(there.of(i)), list(&reversed));
                format!("{:?}\n{model}{l}\nreversed{r}", rays[i])
            });
        }
    });
    tally.finish(5_000 * effort.times());
}

fn reverse(c: &Crossing) -> Crossing {
    Crossing { t: -c.t, before: c.after, after: c.before, left: c.entered, entered: c.left, ..*c }
}

/// Tests a ray cut in two: the lists before and after the cut, concatenated, are the whole list. Cuts must
/// not lie in a run of welded crossings: the rays have short runs only, and the cuts are off the grid where
/// such runs may be.
pub fn of_cuts<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("rays cut in two");
    for_models(effort, 8_000_000, |rng, _, model| {
        let mut rays = plain_rays(rng);
        rays.extend((0..20).map(|_| grid_ray(rng).transformed(&model.frame)));
        let evaluator = make(model.compiled());
        let whole = trace(&make, model, &rays);
        for (i, ray) in rays.iter().enumerate() {
            let cut = 0.5 * (rng.below(33) as f64 - 16.0) + rng.between(0.05, 0.2);
            let part = |t_min: f64, t_max: f64| {
                let window = Window::new(t_min, t_max).unwrap_or_default();
                evaluator.one(*ray, &Query { window, ..Query::default() }).unwrap_or_default()
            };
            let (before, after) = (part(f64::NEG_INFINITY, cut), part(cut, f64::INFINITY));
            let both = [before.of(0), after.of(0)].concat();
            // a change of region within one medium is not reported, so the sides at the cut are compared by
            // medium
            let side = before.of(0).last().map_or(before.starts[0], |c| c.after);
            let medium = |region| evaluator.program().medium_of(region);
            let same = before.starts[0] == whole.starts[i] && both == whole.of(i);
            tally.check(same && medium(side) == medium(after.starts[0]), || {
                format!("{ray:?} cut at {cut}\n{model}{}\nagainst{}", list(whole.of(i)), list(&both))
            });
        }
    });
    tally.finish(10_000 * effort.times());
}

/// Compares regions along a ray with equivalent solids: region k is its solid minus all later ones.
pub fn of_regions<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("regions equal to the solids that they amount to");
    for_models(effort, 6_000_000, |rng, _, _| {
        let solids: Vec<Solid> = (0..4).map(|_| solid(rng, Style::Generic, 2)).collect();
        let rays = plain_rays(rng);
        let region = |(k, s): (usize, &Solid)| Region {
            name: format!("r{k}"),
            solid: s.clone(),
            medium: k as u32 + 1,
        };
        let regions: Vec<Region> = solids.iter().enumerate().map(region).collect();
        let program = compiled(Program::compile_regions(&regions));
        let partition = make(program).collect(batch(&rays).rays(), &Query::default()).unwrap();
        for k in 0..solids.len() {
            // includes all solids, so that the leaves and their shared surfaces are the same
            let earlier = Solid::union(solids[..k].iter().map(nothing_of));
            let later = Solid::union(solids[k + 1..].iter().cloned());
            let alone = compiled(Program::compile(&(earlier | (&solids[k] - later))));
            let alone = make(alone).collect(batch(&rays).rays(), &Query::default()).unwrap();
            let here = RegionId(k as u32 + 1);
            for i in 0..rays.len() {
                let ours: Vec<(u64, bool)> = partition
                    .of(i)
                    .iter()
                    .filter(|c| (c.before == here) != (c.after == here))
                    .map(|c| (c.t.to_bits(), c.after == here))
                    .collect();
                let theirs: Vec<_> = alone.of(i).iter().map(|c| (c.t.to_bits(), c.enters())).collect();
                let same =
                    ours == theirs && (partition.starts[i] == here) == (alone.starts[i] != RegionId(0));
                tally.check(same, || {
                    let (l, r) = (list(partition.of(i)), list(alone.of(i)));
                    format!("region {k} of {solids:?}\n{:?}{l}\nagainst{r}", rays[i])
                });
            }
        }
    });
    tally.finish(10_000 * effort.times());
}

/// Compares instances with separate copies: the same crossings up to the tolerance of the weld.
pub fn of_placements<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, effort: Effort) {
    let mut tally = Tally::new("placed copies equal to single ones");
    for_models(effort, 7_000_000, |rng, style, _| {
        let part = solid(rng, style, 1);
        let other = solid(rng, style, 1);
        let half = |rng: &mut Random| 0.5 * (rng.below(7) as f64 - 3.0);
        let steps: Vec<Vec3> = (0..3).map(|_| Vec3::new(half(rng), half(rng), half(rng))).collect();
        let maps: Vec<Affine> = steps.iter().map(|&v| Affine::translate(v)).collect();
        let placed = part.place(maps);
        let single = Solid::union(steps.iter().map(|&v| part.translate(v)));
        // a ray within a few tolerances of a face lies in it or not depending on lengths that differ between
        // the two
        let mut rays = plain_rays(rng);
        rays.extend((0..60).map(|_| grid_ray(rng)));
        // a root at 1e17, of a ray that rounding keeps from being parallel to a face, may just as well be at infinity
        let window = Window::new(-1e6, 1e6).unwrap_or_default();
        let query = Query { window, ..Query::default() };
        let trace =
            |solid: Solid| make(Model::of(solid).compiled()).collect(batch(&rays).rays(), &query).unwrap();
        let (placed, single) = (trace(placed - other.clone()), trace(single - other));
        for i in 0..rays.len() {
            let (l, r) = (placed.of(i), single.of(i));
            let same = placed.starts[i] == single.starts[i] && alike(l, r, 1e-5);
            tally.check(same, || {
                format!("{part:?} at {steps:?}, {:?}{}\nagainst{}", rays[i], list(l), list(r))
            });
        }
    });
    tally.finish(3_000 * effort.times());
}

fn moved(model: &Model, map: &Affine) -> Model {
    let mut there = model.clone();
    there.regions.iter_mut().for_each(|region| region.solid = region.solid.apply(*map));
    there
}

fn trace<E: Evaluator>(make: impl Fn(Arc<Program>) -> E, model: &Model, rays: &[Ray]) -> Collected {
    make(model.compiled()).collect(batch(rays).rays(), &Query::default()).unwrap()
}

/// Runs a test on random models of all styles.
fn for_models(effort: Effort, first: u64, mut test: impl FnMut(&mut Random, Style, &Model)) {
    for seed in 0..150 * effort.times() {
        let mut rng = Random::new(first + seed);
        let style = [Style::Generic, Style::Grid, Style::Planes][seed as usize % 3];
        let model = Model::random(&mut rng, style);
        test(&mut rng, style, &model);
    }
}
