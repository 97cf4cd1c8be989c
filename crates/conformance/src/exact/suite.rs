//! Tests of evaluators against exact answers.

use super::answer::{Answer, Expected, answer, region_at};
use super::sensitivity::sensitivity;
use super::shrink::smaller_models;
use super::tree::regions;
use super::trial::{generic, through};
use super::{Count, Exact, Line, Map, Part, Shape, Span, Tree, draw};
use crate::{EvaluatorUnderTest, Maker, Random, list};
use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_model::{Ball, Crossing, Limit, PlacementId, Program, Query, RayBatch, Window};
use rayweave_shape::Ray;
use std::ops::Range;
use std::sync::Arc;

/// Number of rays per model.
const RAYS: usize = 50;

/// A model in both forms, exact and compiled.
struct Subject {
    parts: Vec<Part>,
    exact: Exact,
    evaluators: Vec<Box<dyn EvaluatorUnderTest>>,
    /// The balls of the model, of all solids placed in it and of all meshes, each with the map into its frame.
    balls: Vec<(Affine, Ball)>,
    /// The map from the exact model to the engine's model.
    frame: Affine,
    /// True if the engine attributes crossings to leaves in the same way as the exact model.
    numbered: bool,
}

impl Subject {
    /// True if the engine's surfaces are rounded versions of the exact ones, or if rounding decides crossings
    /// far out.
    fn is_windowed(&self) -> bool {
        self.frame != Affine::IDENTITY || self.exact.surfaces.iter().any(|s| s.is_rounded() || s.is_open())
    }

    fn medium(&self, region: usize) -> u32 {
        if region == 0 { 0 } else { self.parts[region - 1].medium }
    }
}

fn subject(parts: &[Part], frame: Affine, makers: &[Maker]) -> Result<Subject, String> {
    let program =
        |frame: &Affine| Program::compile_regions(&regions(parts, frame)).map_err(|e| e.to_string());
    let compiled = program(&frame)?;
    // those of the model in the frame of the exact answer and in its own: the chord of a lone plane depends on its distance from
    // the origin
    let mut balls = balls(&program(&Affine::IDENTITY)?, &Affine::IDENTITY);
    if frame != Affine::IDENTITY {
        balls.extend(self::balls(&compiled, &frame));
    }
    parts.iter().for_each(|part| mesh_balls(&part.tree, &Affine::IDENTITY, &mut balls));
    // a mesh shares no surface with a plane in one of its faces, so rounding decides which leaf is crossed first
    let numbered = compiled.prototypes().len() == 1 && !parts.iter().any(|part| part.tree.has_mesh());
    let mut exact = Exact::new(parts);
    // the tolerances are those at the position of the engine's model
    exact.surfaces.iter_mut().for_each(|s| s.magnitude += 2.0 * frame.translation.length());
    let compiled = Arc::new(compiled);
    let evaluators = makers.iter().map(|make| make(compiled.clone())).collect();
    Ok(Subject { parts: parts.to_vec(), exact, evaluators, balls, frame, numbered })
}

/// The balls of a program, with the maps into their frames from one that `frame` maps to that of the program.
fn balls(program: &Program, frame: &Affine) -> Vec<(Affine, Ball)> {
    let placements = 0..program.prototypes()[0].placements;
    let ball = |k: u32| {
        let (world_from_local, group) = program.placement(PlacementId(k));
        let map = world_from_local.inverse().unwrap_or(Affine::IDENTITY);
        (frame.then(&map), program.prototype(group).ball)
    };
    placements.map(ball).collect()
}

/// The balls of meshes, over whose chords a ray has to stay in a face to lie in it (`rayweave_mesh::Polyhedron`), with
/// the maps into their frames.
fn mesh_balls(tree: &Tree, world_from_local: &Affine, balls: &mut Vec<(Affine, Ball)>) {
    match tree {
        Tree::Leaf(Shape::MeshCorners(lo, hi)) => {
            let [lo, hi] = [lo, hi].map(|corner| Vec3::from(*corner));
            let half = (0.5 * (hi - lo)).max_element();
            let ball = Ball { centre: 0.5 * (lo + hi), radius: 1.75 * half, magnitude: 0.0 };
            balls.push((world_from_local.inverse().unwrap_or(Affine::IDENTITY), ball));
        }
        Tree::Moved(map, a) => mesh_balls(a, &map.affine().then(world_from_local), balls),
        Tree::Placed(maps, a) => {
            maps.iter().for_each(|map| mesh_balls(a, &map.affine().then(world_from_local), balls));
        }
        _ => tree.operands().into_iter().for_each(|a| mesh_balls(a, world_from_local, balls)),
    }
}

/// Models on a dyadic grid, unrotated: compares number of crossings, regions before and after, and times.
pub fn planted(makers: &[Maker], seeds: Range<u64>) -> Count {
    let mut count = Count::default();
    for seed in seeds {
        let mut rng = Random::new(seed);
        let (parts, stage) = (draw::parts(&mut rng), draw::stage(&mut rng));
        let parts: Vec<Part> = parts.into_iter().map(|part| on_stage(part, &stage)).collect();
        let Ok(subject) = subject(&parts, Affine::IDENTITY, makers) else { continue };
        let drawn = (0..RAYS).map(|_| draw::ray(&mut rng));
        let rays: Vec<Ray> = drawn.filter_map(|ray| draw::staged(ray, &stage)).collect();
        compare_all(&subject, &rays, seed, &mut count, makers);
    }
    count
}

/// The models of [`planted`] with most boxes as triangle meshes.
pub fn meshes(makers: &[Maker], seeds: Range<u64>) -> Count {
    let mut count = Count::default();
    for seed in seeds {
        let mut rng = Random::new(6 << 40 | seed);
        let (parts, stage) = (draw::parts(&mut rng), draw::stage(&mut rng));
        let parts: Vec<Part> = parts.into_iter().map(|part| on_stage(part, &stage)).collect();
        let meshed: Vec<Part> = parts
            .iter()
            .map(|part| Part { tree: part.tree.meshed(&mut rng, 0.75), medium: part.medium })
            .collect();
        if meshed == parts {
            continue;
        }
        let Ok(subject) = subject(&meshed, Affine::IDENTITY, makers) else { continue };
        let drawn = (0..RAYS).map(|_| draw::ray(&mut rng));
        let rays: Vec<Ray> = drawn.filter_map(|ray| draw::staged(ray, &stage)).collect();
        compare_all(&subject, &rays, seed, &mut count, makers);
    }
    count
}

/// Random rays through the models of [`planted`] and through random trees of boxes, balls and rods. Almost no ray has a
/// coincidence of its own, although half of the models have common faces.
pub fn transversal(makers: &[Maker], seeds: Range<u64>) -> Count {
    let mut count = Count::default();
    for seed in seeds {
        let mut rng = Random::new(5 << 40 | seed);
        let parts = match seed % 2 {
            0 => draw::parts(&mut rng),
            _ => vec![Part { tree: generic(&mut rng), medium: 1 }],
        };
        let Ok(subject) = subject(&parts, Affine::IDENTITY, makers) else { continue };
        let rays: Vec<Ray> = (0..RAYS).map(|_| through(&mut rng)).collect();
        compare_all(&subject, &rays, seed, &mut count, makers);
    }
    count
}

fn on_stage(part: Part, stage: &[Map]) -> Part {
    Part { tree: stage.iter().fold(part.tree, |tree, map| tree.moved(*map)), ..part }
}

/// The models of [`planted`] under a shift and a rotation from an integer quaternion, rounded.
pub fn turned(makers: &[Maker], seeds: Range<u64>) -> Count {
    let mut count = Count::default();
    for seed in seeds {
        let mut rng = Random::new(1 << 40 | seed);
        let parts = draw::parts(&mut rng);
        let frame = rotation(&mut rng);
        let Ok(subject) = subject(&parts, frame, makers) else { continue };
        let rays: Vec<Ray> = (0..RAYS).map(|_| draw::ray(&mut rng)).collect();
        compare_all(&subject, &rays, seed, &mut count, makers);
    }
    count
}

/// The rotation of a quaternion of small integers: entries are quotients of integers, each rounded once.
fn rotation(rng: &mut Random) -> Affine {
    let mut whole = || rng.below(9) as f64 - 4.0;
    let (a, b, c, d) = (whole(), whole(), whole(), whole() + 0.0);
    let a = if a == 0.0 && b == 0.0 && c == 0.0 && d == 0.0 { 1.0 } else { a };
    let n = a * a + b * b + c * c + d * d;
    let columns = [
        Vec3::new(a * a + b * b - c * c - d * d, 2.0 * (b * c + a * d), 2.0 * (b * d - a * c)) / n,
        Vec3::new(2.0 * (b * c - a * d), a * a - b * b + c * c - d * d, 2.0 * (c * d + a * b)) / n,
        Vec3::new(2.0 * (b * d + a * c), 2.0 * (c * d - a * b), a * a - b * b - c * c + d * d) / n,
    ];
    let [x, y, z] = columns;
    let shift = if rng.chance(0.5) { Vec3::ZERO } else { rng.point(3.0) };
    Affine { linear: Mat3::from_cols(x, y, z), translation: shift }
}

fn compare_all(subject: &Subject, rays: &[Ray], seed: u64, count: &mut Count, makers: &[Maker]) {
    for ray in rays {
        let verdict = compare(subject, *ray);
        tally(&verdict, count);
        if let Verdict::Wrong(what) = verdict {
            count.wrong += 1;
            // one message per model
            if count.messages.last().is_none_or(|(last, _)| *last != seed) {
                let small = shrink(subject, *ray, makers);
                count.messages.push((seed, format!("{what}\n{small}")));
            }
        }
    }
}

/// The outcome for one ray.
enum Verdict {
    /// The exact answer is uncertain.
    Doubtful,
    /// Not compared: a ray in a face of a rotated model.
    Exempt,
    /// Right.
    Right(Answer),
    /// Near an edge of a rotated model; true if the answer equals the exact one.
    NearEdge(bool),
    /// Different where rounding decides.
    Torn,
    /// Wrong.
    Wrong(String),
}

fn tally(verdict: &Verdict, count: &mut Count) {
    match verdict {
        Verdict::Doubtful => count.redrawn += 1,
        Verdict::Exempt => {}
        Verdict::NearEdge(right) => {
            count.near_edges.0 += 1;
            count.near_edges.1 += u64::from(!right);
        }
        Verdict::Torn => count.torn += 1,
        Verdict::Wrong(_) => count.rays += 1,
        Verdict::Right(answer) => {
            let traits = &answer.traits;
            count.rays += 1;
            count.crossings += answer.crossings.len() as u64;
            count.in_surface += u64::from(traits.lies);
            count.ties += u64::from(traits.ties);
            count.touching += u64::from(traits.touches);
            count.plain += u64::from(!(traits.lies || traits.ties || traits.touches));
        }
    }
}

fn compare(subject: &Subject, ray: Ray) -> Verdict {
    let line = Line::new(ray);
    let span = Span::new(&ray, &subject.balls);
    let Ok(expected) = answer(&subject.exact, &line, &span) else { return Verdict::Doubtful };
    let turned = subject.frame != Affine::IDENTITY;
    if turned && expected.traits.lies {
        return Verdict::Exempt;
    }
    let expected = if subject.is_windowed() { expected.within(far(&ray)) } else { expected };
    let mut evaluators = subject.evaluators.iter();
    let wrong = evaluators.find_map(|evaluator| differences(subject, &**evaluator, ray, &expected));
    let look = || sensitivity(&subject.exact, &line, &span);
    if turned {
        match look() {
            Ok(sensitivity) if sensitivity.clearance < 1e-9 => return Verdict::NearEdge(wrong.is_none()),
            Ok(_) => {}
            Err(_) => return Verdict::Doubtful,
        }
    }
    match wrong {
        None => Verdict::Right(expected),
        Some(_) if look().is_ok_and(|sensitivity| sensitivity.order_uncertain) => Verdict::Torn,
        Some(what) => Verdict::Wrong(what),
    }
}

/// The time up to which a ray is compared if the model's surfaces are rounded: a ray that rounding keeps from
/// being parallel to a face crosses it far out.
fn far(ray: &Ray) -> f64 {
    (100.0 + ray.origin.length()) / ray.direction.length()
}

/// The first difference between an evaluator and the exact answer.
fn differences(
    subject: &Subject,
    evaluator: &dyn EvaluatorUnderTest,
    ray: Ray,
    expected: &Answer,
) -> Option<String> {
    let turned = subject.frame != Affine::IDENTITY;
    let window = match subject.is_windowed() {
        true => Window::new(-far(&ray), far(&ray)).unwrap_or_default(),
        false => Window::ALL,
    };
    let ray = if turned { ray.transformed(&subject.frame) } else { ray };
    let batch: RayBatch = [ray].into_iter().collect();
    let found = evaluator.trace(batch.rays(), &Query { window, ..Query::default() });
    let crossings = found.of(0);
    let wrong = |what: &str| {
        let name = evaluator.name();
        let start = found.starts[0].0;
        Some(format!("{what}: {name} from {start} {}\nexact {}", list(crossings), description(expected)))
    };
    if subject.medium(found.starts[0].index()) != subject.medium(expected.start) {
        return wrong("a different medium at the start");
    }
    if crossings.len() != expected.crossings.len() {
        return wrong("a different number of crossings");
    }
    let pairs = || crossings.iter().zip(&expected.crossings);
    let media = |before: usize, after: usize| [before, after].map(|k| subject.medium(k));
    if !pairs().all(|(c, e)| media(c.before.index(), c.after.index()) == media(e.before, e.after)) {
        return wrong("other media");
    }
    let slack = if turned { 2.0 } else { 1.0 };
    if !pairs().all(|(c, e)| in_time(c, e, slack)) {
        return wrong("another time");
    }
    if subject.numbered && !pairs().all(|(c, e)| e.leaves.contains(&c.face.leaf.index())) {
        return wrong("another leaf");
    }
    if nearest_differs(evaluator, &batch, crossings) {
        return wrong("a different nearest crossing");
    }
    let start = subject.is_windowed() || found.starts[0].index() == expected.start;
    if !start || !pairs().all(|(c, e)| (c.before.index(), c.after.index()) == (e.before, e.after)) {
        return wrong("other regions");
    }
    None
}

fn in_time(crossing: &Crossing, expected: &Expected, slack: f64) -> bool {
    let (lo, hi) = expected.times;
    let (middle, half) = (0.5 * (lo + hi), 0.5 * (hi - lo));
    (crossing.t - middle).abs() <= slack * half
}

/// True if the nearest crossing after a time between the last two crossings is not the last one.
fn nearest_differs(evaluator: &dyn EvaluatorUnderTest, rays: &RayBatch, crossings: &[Crossing]) -> bool {
    let Some(pair) = crossings.windows(2).last() else { return false };
    // not the middle, where the models have slivers that are welded away
    let t_min = pair[0].t + 0.37 * (pair[1].t - pair[0].t);
    let Ok(window) = Window::new(t_min, f64::INFINITY) else { return false };
    if !(pair[0].t < t_min && t_min < pair[1].t) {
        return false;
    }
    let found = evaluator.trace(rays.rays(), &Query { window, limit: Limit::First, starts: None });
    found.of(0).first().map(|c| (c.t, c.after)) != Some((pair[1].t, pair[1].after))
}

fn description(answer: &Answer) -> String {
    let line =
        |e: &Expected| format!("\n  t in {:?}: {} -> {} by {:?}", e.times, e.before, e.after, e.leaves);
    let lines: String = answer.crossings.iter().map(line).collect();
    format!("from {} {:?}{lines}", answer.start, answer.traits)
}

/// A smaller model with a wrong answer for the same ray, with both answers.
fn shrink(subject: &Subject, ray: Ray, makers: &[Maker]) -> String {
    let mut parts = subject.parts.clone();
    let fails = |parts: &[Part]| {
        let smaller = self::subject(parts, subject.frame, makers).ok()?;
        match compare(&smaller, ray) {
            Verdict::Wrong(what) => Some(what),
            _ => None,
        }
    };
    let mut what = String::new();
    while let Some((smaller, description)) =
        smaller_models(&parts).into_iter().find_map(|p| fails(&p).map(|description| (p, description)))
    {
        (parts, what) = (smaller, description);
    }
    format!("{parts:?}\n{ray:?} frame {:?}\nshrunk: {what}", subject.frame)
}

/// Compares the region at points of the grid and others; on a surface the side along w decides.
pub fn points(makers: &[Maker], seeds: Range<u64>) -> Count {
    let mut count = Count::default();
    for seed in seeds {
        let mut rng = Random::new(2 << 40 | seed);
        let parts = draw::parts(&mut rng);
        let Ok(subject) = subject(&parts, Affine::IDENTITY, makers) else { continue };
        for _ in 0..RAYS {
            let ray = draw::ray(&mut rng);
            point(&subject, ray.at(rng.below(3) as f64), seed, &mut count);
        }
    }
    count
}

fn point(subject: &Subject, point: Vec3, seed: u64, count: &mut Count) {
    let Some(expected) = region_at(&subject.exact, point) else {
        count.redrawn += 1;
        return;
    };
    count.rays += 1;
    let mut answers = subject.evaluators.iter().map(|e| (e.name(), e.region_at(point)));
    if let Some((name, found)) = answers.find(|(_, region)| region.index() != expected) {
        count.wrong += 1;
        let parts = &subject.parts;
        count.messages.push((seed, format!("{point:?} is in {expected}, not {found:?} ({name})\n{parts:?}")));
    }
}
