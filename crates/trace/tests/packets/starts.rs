//! Rays that start on surfaces: continued from their hits with the right side, and sometimes with the wrong
//! one.

use crate::oracle::{Setting, bits, evaluators, lists};
use fearless_simd::Level;
use rayweave_conformance::rays::batch;
use rayweave_conformance::{Random, Tally};
use rayweave_math::Vec3;
use rayweave_model::{
    Crossing, Evaluator, Face, FirstHits, LeafFacet, Limit, PlacementId, Program, Query, Start, StartLists,
    Window, attributes,
};
use rayweave_shape::Ray;
use rayweave_shape::surface::delta;

/// Follows the rays of a setting from face to face, and compares all answers.
pub fn follow(setting: &Setting, level: Level, rng: &mut Random, tally: &mut Tally) {
    let (truth, packets) = evaluators(setting, level);
    let (mut rays, mut listed) = (setting.rays.clone(), vec![Vec::new(); setting.rays.len()]);
    for _ in 0..4 {
        let mut first = vec![0];
        first.extend(listed.iter().scan(0, |sum, list: &Vec<Start>| {
            *sum += list.len() as u32;
            Some(*sum)
        }));
        let entries = listed.concat();
        let starts = Some(StartLists { first: &first, entries: &entries });
        let window = window(rng);
        let query = |limit| Query { window, limit, starts };
        let [all, expected] = [Limit::All, Limit::First].map(|limit| lists(&truth, &rays, &query(limit)));
        let [found, start] = [Limit::All, Limit::First].map(|limit| lists(&packets, &rays, &query(limit)));
        let near = nearest(&truth, &rays, &query(Limit::First), &[]);
        // the regions in which rays start, and wrong ones, change no answer
        let regions: Vec<u32> = all
            .starts
            .iter()
            .map(|start| if rng.chance(0.8) { start.0 } else { rng.below(6) as u32 })
            .collect();
        let hints = if rng.chance(0.8) { &regions[..] } else { &[] };
        let found_near = nearest(&packets, &rays, &query(Limit::First), hints);
        for i in 0..rays.len() {
            let same = |a: &[Crossing], b: &[Crossing]| bits(a) == bits(b);
            let begins = all.starts[i] == found.starts[i] && all.starts[i] == start.starts[i];
            let equal = same(all.of(i), found.of(i)) && same(expected.of(i), start.of(i));
            tally.check(begins && equal && near[i] == found_near[i], || {
                let (on, said) = (&listed[i], setting.describe(i));
                let (a, b, c) = (all.of(i), found.of(i), start.of(i));
                format!(
                    "{said}\nat {:?} on {on:?}, {level:?}, {window:?}\nfound {b:?}\n{c:?}\nnot {a:?}",
                    rays[i]
                )
            });
        }
        for (i, (ray, list)) in rays.iter_mut().zip(&mut listed).enumerate() {
            if let Some(crossing) = expected.of(i).first() {
                (*ray, *list) = sent_on(setting.program(), ray, crossing, rng);
            }
        }
    }
}

/// The first crossing of each ray by the reference.
pub fn lists_of_first(setting: &Setting, rays: &[Ray]) -> Vec<Crossing> {
    let (truth, _) = evaluators(setting, Level::new());
    let found = lists(&truth, rays, &Query::nearest());
    (0..rays.len()).filter_map(|i| found.of(i).first().copied()).collect()
}

/// Compares the first hits of rays with start lists; all of them hit something.
pub fn compare(setting: &Setting, rays: &[Ray], listed: &[Vec<Start>]) {
    let (truth, packets) = evaluators(setting, Level::new());
    let counts = listed.iter().scan(0, |sum, list| {
        *sum += list.len() as u32;
        Some(*sum)
    });
    let (first, entries): (Vec<u32>, _) = (std::iter::once(0).chain(counts).collect(), listed.concat());
    let starts = Some(StartLists { first: &first, entries: &entries });
    let query = Query { starts, ..Query::nearest() };
    let expected = nearest(&truth, rays, &query, &[]);
    assert!(expected.iter().all(|(_, [face, ..], _)| *face >= 0), "{expected:?}");
    assert_eq!(nearest(&packets, rays, &query, &[]), expected);
}

/// A window that usually begins at the start of the ray.
fn window(rng: &mut Random) -> Window {
    let from = match rng.below(6) {
        0 => f64::NEG_INFINITY,
        1 => -rng.uniform(),
        2 => f64::MIN_POSITIVE,
        _ => 0.0,
    };
    Window::new(from, if rng.chance(0.2) { 5.0 * rng.uniform() + 1e-3 } else { f64::INFINITY }).unwrap()
}

/// A ray that leaves a face in some direction, with its start list.
fn sent_on(program: &Program, ray: &Ray, crossing: &Crossing, rng: &mut Random) -> (Ray, Vec<Start>) {
    let normal = attributes::normal(program, ray, crossing);
    let speed = ray.direction.length();
    let direction = match rng.below(4) {
        0 => ray.direction,
        1 => ray.direction - 2.0 * ray.direction.dot(normal) * normal,
        // along the face, or nearly
        2 => speed * (rng.direction().cross(normal) + rng.magnitude(-17.0, 0.0) * normal),
        _ => speed * rng.direction(),
    };
    let start = |face: Face, turned: bool| {
        let gradient = attributes::world_gradient(program, ray, face, crossing.t);
        let inside = (gradient.dot(direction) < 0.0) ^ turned;
        Start { surface: face.surface, placement: face.placement, inside }
    };
    let at = start(crossing.face, rng.chance(0.05));
    // further entries of the list must be true, which is not checked here for placed solids
    let is_flat = program.prototypes().len() == 1;
    let list = match if is_flat { rng.below(10) } else { 3 * rng.below(2) } {
        0 => vec![],
        1 => vec![Start { placement: PlacementId(1), ..at }],
        // all other surfaces near the point
        2 => {
            let near = faces(program).filter(|face| is_on(program, face, ray, crossing.t));
            let others = near.map(|face| start(face, false)).filter(|other| other.surface != at.surface);
            [at].into_iter().chain(others).collect()
        }
        _ => vec![at],
    };
    // moved onto the face, as required of rays that start there
    let (value, slope) =
        program.surface(crossing.face.surface).surface.value_and_gradient(ray.at(crossing.t));
    let step = value / slope.dot(normal);
    let point = ray.at(crossing.t) - if is_flat && step.is_finite() { step } else { 0.0 } * normal;
    let leaves = Ray::new(point, direction);
    let is_ray = direction != Vec3::ZERO && leaves.check().is_ok();
    if is_ray { (leaves, list) } else { (*ray, Vec::new()) }
}

fn faces(program: &Program) -> impl Iterator<Item = Face> + '_ {
    program.leaves().flat_map(|leaf| {
        let (leaf, sides) = (leaf.id(), leaf.facets());
        let face = move |(facet, side): (u32, &LeafFacet)| Face {
            leaf,
            facet,
            surface: side.surface(),
            placement: PlacementId(0),
        };
        (0..).zip(sides).map(face)
    })
}

fn is_on(program: &Program, face: &Face, ray: &Ray, t: f64) -> bool {
    let entry = program.surface(face.surface);
    let (value, gradient) = entry.surface.value_and_gradient(ray.at(t));
    value.abs() <= delta(entry.magnitude, ray, t) * gradient.length()
}

/// Numbers as bits, ids, and crossings whose faces differ on the two sides.
type Near = ([u64; 4], [i64; 4], Vec<Crossing>);

/// The first hits, with the regions in which the rays probably start.
fn nearest<E: Evaluator>(evaluator: &E, rays: &[Ray], query: &Query<'_>, regions: &[u32]) -> Vec<Near> {
    let count = rays.len();
    let (mut numbers, mut face) = ([(); 4].map(|()| vec![0.5; count]), vec![i32::MIN; count]);
    let (mut ids, mut between) = ([(); 3].map(|()| vec![u32::MAX; count]), Vec::new());
    let ([t, nx, ny, nz], [placement, before, after]) = (&mut numbers, &mut ids);
    let normal = Some([&mut nx[..], &mut ny[..], &mut nz[..]]);
    let mut hits = FirstHits { t, face: &mut face, placement, before, after, normal };
    let (query, rays) = ((query, regions), batch(rays));
    evaluator.nearest_in(rays.rays(), query, &mut evaluator.scratch(), &mut hits, &mut between);
    let answer = |i: usize| {
        let [placement, before, after] = std::array::from_fn(|k| i64::from(ids[k][i]));
        let sides = between.iter().filter(|(ray, _)| *ray == i).map(|(_, crossing)| *crossing);
        let numbers = std::array::from_fn(|k| numbers[k][i].to_bits());
        (numbers, [face[i].into(), placement, before, after], sides.collect())
    };
    (0..count).map(answer).collect()
}
