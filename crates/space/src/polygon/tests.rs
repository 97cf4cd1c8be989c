//! The two ways of asking a region, against each other and against exact arithmetic on lattice points.

use super::{HalfPlane, Operator, PolygonError, Polygons, from_polygons};
use crate::{Point, Tracer, lie_direction};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng, seq::SliceRandom};
use rayweave_model::{Evaluator, Program, Query};
use rayweave_rootray::Side;
use rayweave_shape::Ray;
use rayweave_trace::Weave;
use std::sync::Arc;

type Lattice = [i64; 2];
type Contours = Vec<Vec<Lattice>>;

fn points(contour: &[Lattice]) -> Vec<Point<2>> {
    contour.iter().map(|p| p.map(|x| x as f64)).collect()
}

fn region(contours: &[Vec<Lattice>], outside: Side) -> Result<Polygons, PolygonError> {
    let contours: Vec<_> = contours.iter().map(|c| points(c)).collect();
    from_polygons(&contours, outside)
}

fn cross(a: Lattice, b: Lattice, c: Lattice) -> i128 {
    let d = |p: i64, q: i64| i128::from(p) - i128::from(q);
    d(b[0], a[0]) * d(c[1], a[1]) - d(b[1], a[1]) * d(c[0], a[0])
}

fn edges(contour: &[Lattice]) -> impl Iterator<Item = (Lattice, Lattice)> + Clone {
    let n = contour.len();
    (0..n).map(move |k| (contour[k], contour[(k + 1) % n]))
}

/// The oracle: crossings of the ray towards +x with all edges as they were given, in whole numbers. `None` on an edge.
fn is_inside(contours: &[Vec<Lattice>], scale: i64, outside: Side, p: Lattice) -> Option<bool> {
    let mut inside = outside.is_inside();
    for (a, b) in contours.iter().flat_map(|c| edges(c)) {
        let (a, b) = (a.map(|x| x * scale), b.map(|x| x * scale));
        let turn = cross(a, b, p);
        let between = |k: usize| a[k].min(b[k]) <= p[k] && p[k] <= a[k].max(b[k]);
        if turn == 0 && between(0) && between(1) {
            return None;
        }
        if (a[1] > p[1]) != (b[1] > p[1]) && (turn > 0) == (b[1] > a[1]) {
            inside = !inside;
        }
    }
    Some(inside)
}

/// True if two closed segments have a point in common.
fn meet((a, b): (Lattice, Lattice), (c, d): (Lattice, Lattice)) -> bool {
    let signs = |p, q, r, s| (cross(p, q, r).signum(), cross(p, q, s).signum());
    let ((s1, s2), (s3, s4)) = (signs(a, b, c, d), signs(c, d, a, b));
    let overlap = |k: usize| a[k].min(b[k]) <= c[k].max(d[k]) && c[k].min(d[k]) <= a[k].max(b[k]);
    s1 * s2 <= 0 && s3 * s4 <= 0 && overlap(0) && overlap(1)
}

/// The oracle of touching: every edge against every other one that is not its neighbour.
fn is_clear(contours: &[Vec<Lattice>]) -> bool {
    let all: Vec<_> = contours
        .iter()
        .enumerate()
        .flat_map(|(c, contour)| edges(contour).enumerate().map(move |(k, edge)| (c, k, contour.len(), edge)))
        .collect();
    let apart = |&(c, k, n, e): &(usize, usize, usize, _), &(d, l, _, f): &(usize, usize, usize, _)| {
        let neighbours = c == d && ((k + 1) % n == l || (l + 1) % n == k);
        neighbours || !meet(e, f)
    };
    (0..all.len()).all(|i| (0..i).all(|j| apart(&all[i], &all[j])))
}

fn random_contour(rng: &mut ChaCha8Rng, n: usize, size: i64) -> Vec<Lattice> {
    (0..n).map(|_| [0, 1].map(|_| rng.random_range(-size..=size))).collect()
}

/// A simple polygon through random lattice points, counter-clockwise: crossings are undone by reversing what lies
/// between them, which shortens the way and so comes to an end.
fn random_simple(rng: &mut ChaCha8Rng, n: usize, size: i64) -> Vec<Lattice> {
    loop {
        let mut points = random_contour(rng, n, size);
        points.sort();
        points.dedup();
        points.shuffle(rng);
        let n = points.len();
        for _ in 0..200 {
            let proper = |k: usize, l: usize| {
                let (a, b, c, d) = (points[k], points[k + 1], points[l], points[(l + 1) % n]);
                cross(a, b, c).signum() * cross(a, b, d).signum() < 0
                    && cross(c, d, a).signum() * cross(c, d, b).signum() < 0
            };
            let crossing =
                (0..n - 1).flat_map(|k| (k + 2..n).map(move |l| (k, l))).find(|&(k, l)| proper(k, l));
            match crossing {
                Some((k, l)) => points[k + 1..=l].reverse(),
                None => break,
            }
        }
        let corners = corners(&points);
        if corners.len() >= 3 && is_clear(std::slice::from_ref(&corners)) {
            return counter_clockwise(corners);
        }
    }
}

fn corners(contour: &[Lattice]) -> Vec<Lattice> {
    super::contour::corners(points(contour)).into_iter().map(|(p, _)| p.map(|x| x as i64)).collect()
}

fn counter_clockwise(mut contour: Vec<Lattice>) -> Vec<Lattice> {
    let area: i128 = edges(&contour).map(|(a, b)| cross([0, 0], a, b)).sum();
    if area < 0 {
        contour.reverse();
    }
    contour
}

/// Spikes out and in, repeated vertices and vertices on the way, at random places: nothing of any area.
fn dressed(rng: &mut ChaCha8Rng, contour: &[Lattice]) -> Vec<Lattice> {
    let mut out = Vec::new();
    for (a, b) in edges(contour) {
        out.push(a);
        match rng.random_range(0..6) {
            0 => out.push(a),
            1 => out.extend([random_contour(rng, 1, 20)[0], a]),
            2 => out.extend([[2 * b[0] - a[0], 2 * b[1] - a[1]], b]),
            3 if (b[0] - a[0]) % 2 == 0 && (b[1] - a[1]) % 2 == 0 => {
                out.push([(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]);
            }
            _ => {}
        }
    }
    out
}

fn square(half: i64) -> Vec<Lattice> {
    vec![[-half, -half], [half, -half], [half, half], [-half, half]]
}

fn comb(teeth: i64) -> Vec<Lattice> {
    let mut contour = vec![[2 * teeth - 1, 0], [2 * teeth - 1, 8]];
    for k in (0..teeth - 1).rev() {
        contour.extend([[2 * k + 2, 8], [2 * k + 2, 2], [2 * k + 1, 2], [2 * k + 1, 8]]);
    }
    contour.extend([[0, 8], [0, 0]]);
    contour
}

fn spiral(turns: i64) -> Vec<Lattice> {
    let mut inward = vec![[0, 0]];
    let (mut at, mut length) = ([0, 0], 4 * turns);
    for k in 0..4 * turns {
        let step = [[length, 0], [0, length], [-length, 0], [0, -length]][(k % 4) as usize];
        at = [at[0] + step[0], at[1] + step[1]];
        inward.push(at);
        length -= k % 2;
        if length < 2 {
            break;
        }
    }
    // the same way back, one unit to the inside: the wall of the spiral
    let n = inward.len();
    let inner = (1..n - 1).map(|k| {
        let (a, b, c) = (inward[k - 1], inward[k], inward[k + 1]);
        let unit = |p: Lattice, q: Lattice| [(q[0] - p[0]).signum(), (q[1] - p[1]).signum()];
        let (u, v) = (unit(a, b), unit(b, c));
        [3 * b[0] - u[0] + v[0], 3 * b[1] - u[1] + v[1]]
    });
    let inner: Vec<Lattice> = inner.rev().collect();
    let mut contour: Vec<Lattice> = inward[..n - 1].iter().map(|p| p.map(|x| 3 * x)).collect();
    contour.extend(inner);
    contour.push([1, 1]);
    contour
}

fn star(points: usize) -> Vec<Lattice> {
    (0..2 * points)
        .map(|k| {
            let radius = if k % 2 == 0 { 32.0 } else { 7.0 };
            let (sin, cos) = rayweave_math::sin_cos_degrees(180.0 * k as f64 / points as f64);
            [(radius * cos).round() as i64, (radius * sin).round() as i64]
        })
        .collect()
}

/// Regions of every sort with their outside, some with contours of no area.
fn regions(rng: &mut ChaCha8Rng) -> Vec<(Contours, Side)> {
    let rings = |first: bool| {
        let ring = |k: i64| {
            let mut ring = square(20 - 3 * k);
            if (k % 2 == 1) == first {
                ring.reverse();
            }
            ring
        };
        (0..6).map(ring).collect::<Contours>()
    };
    let mut all = vec![
        (vec![], Side::Outside),
        (vec![], Side::Inside),
        (vec![vec![[3, 4]], vec![[0, 0], [5, 5]]], Side::Outside),
        (vec![square(8)], Side::Outside),
        (rings(true), Side::Outside),
        (rings(false), Side::Inside),
        (vec![comb(6)], Side::Outside),
        (vec![spiral(3)], Side::Outside),
        (vec![star(5)], Side::Outside),
        (vec![star(12)], Side::Outside),
        (vec![vec![[0, 0], [9, 3], [2, 1]], vec![[20, 0], [28, 0], [24, 9]]], Side::Outside),
    ];
    for n in [3, 4, 5, 6, 8, 12, 20] {
        for size in [3, 5, 16] {
            let simple = random_simple(rng, n, size);
            let mut hole = simple.clone();
            hole.reverse();
            all.push((vec![simple.clone()], Side::Outside));
            all.push((vec![hole.clone()], Side::Inside));
            // in a frame, with a frame in a hole of it where there is room
            let frame = vec![square(40), hole, vec![[50, 50], [60, 50], [60, 60]]];
            all.push((frame, Side::Outside));
            all.push((vec![dressed(rng, &simple)], Side::Outside));
        }
    }
    all
}

#[test]
fn lines_agree_with_points_in_whole_numbers() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (mut asked, mut skipped) = (0, 0);
    for (contours, outside) in regions(&mut rng) {
        let region = region(&contours, outside).unwrap();
        for (p, q) in lines(&mut rng, &contours) {
            let d = [q[0] - p[0], q[1] - p[1]];
            let traced = region.trace(p.map(|x| x as f64), d.map(|x| x as f64)).unwrap();
            assert_eq!(traced.start(), traced.end(), "an odd number of roots");
            for _ in 0..12 {
                // times in 1/64; the point is moved aside along w by 2^-20
                let t = rng.random_range(-300i64..300);
                let w = lie_direction::<2>().map(|x| (x * 64.0) as i64);
                let scale = 1 << 26;
                let at = [0, 1].map(|k| p[k] * scale + t * d[k] * (scale / 64) + w[k]);
                let time = t as f64 / 64.0;
                // roots move a little when the line moves aside, and a corner that it touches gets two
                let is_corner = |v: &Lattice| (0..2).all(|k| v[k] * 64 == p[k] * 64 + t * d[k]);
                let near_root = traced.times().any(|root| (root - time).abs() < 1e-3);
                if near_root || contours.iter().flatten().any(is_corner) {
                    skipped += 1;
                    continue;
                }
                let Some(truth) = is_inside(&contours, scale, outside, at) else { continue };
                let side = traced.side_at(time).unwrap();
                assert_eq!(side.is_inside(), truth, "{contours:?} {outside} {p:?} {q:?} t = {time}");
                asked += 1;
            }
        }
    }
    assert!(asked > 20_000 && skipped < asked / 10, "{asked} {skipped}");
}

/// Lines through lattice points, through two vertices (so along edges), and along the axes.
fn lines(rng: &mut ChaCha8Rng, contours: &Contours) -> Vec<(Lattice, Lattice)> {
    let vertices: Vec<Lattice> = contours.iter().flatten().copied().collect();
    let mut all = Vec::new();
    for k in 0..90 {
        let (p, mut q) = match (vertices.len(), k % 3) {
            (0, _) | (_, 0) => (random_contour(rng, 1, 30)[0], random_contour(rng, 1, 30)[0]),
            (n, _) => (vertices[rng.random_range(0..n)], vertices[rng.random_range(0..n)]),
        };
        if k % 5 == 0 {
            q[k / 5 % 2] = p[k / 5 % 2];
        }
        if p != q {
            all.push((p, q));
        }
    }
    all
}

#[test]
fn formulas_agree_with_points_in_whole_numbers() {
    let mut rng = ChaCha8Rng::seed_from_u64(12);
    for (contours, outside) in regions(&mut rng) {
        let region = region(&contours, outside).unwrap();
        for _ in 0..300 {
            let at = [0, 1].map(|_| rng.random_range(-45i64 * 8..45 * 8));
            let Some(truth) = is_inside(&contours, 8, outside, at) else { continue };
            let mut uses = vec![0; region.edge_count()];
            let p = at.map(|x| x as f64 / 8.0);
            let mut on_a_line = false;
            let found = region.fold(
                |half_plane| {
                    uses[half_plane.edge as usize] += 1;
                    on_a_line |= height(&half_plane, p).abs() < 1e-12;
                    height(&half_plane, p) < 0.0
                },
                |operator, parts| match operator {
                    Operator::Intersection => parts.iter().all(|&part| part),
                    Operator::Union => parts.iter().any(|&part| part),
                    Operator::SymmetricDifference => parts.iter().filter(|&&part| part).count() % 2 == 1,
                    Operator::Complement => !parts[0],
                },
            );
            assert!(uses.iter().all(|&n| n == 1), "{uses:?}");
            assert!(on_a_line || found == truth, "{contours:?} {outside} {p:?}");
        }
    }
}

fn height(half_plane: &HalfPlane, p: Point<2>) -> f64 {
    half_plane.normal[0] * p[0] + half_plane.normal[1] * p[1] - half_plane.offset
}

#[test]
fn solids_of_the_plane_agree_with_lines() {
    let mut rng = ChaCha8Rng::seed_from_u64(16);
    let mut crossings = 0;
    for (contours, outside) in regions(&mut rng) {
        let region = region(&contours, outside).unwrap();
        let mut tracer = Tracer::new(&region.to_solid().unwrap()).unwrap();
        for (p, q) in lines(&mut rng, &contours) {
            let (p, q) = (p.map(|x| x as f64), q.map(|x| x as f64));
            let traced = region.trace(p, [q[0] - p[0], q[1] - p[1]]).unwrap();
            let solid = tracer.trace(p, q).unwrap();
            let near = |(a, b): (f64, f64)| (a - b).abs() <= 1e-10 * (1.0 + b.abs());
            let agree = traced.start() == solid.start()
                && traced.roots().len() == solid.roots().len()
                && traced.times().zip(solid.times()).all(near);
            assert!(agree, "{contours:?} {outside} {p:?} {q:?} {traced} {solid}");
            crossings += traced.roots().len();
        }
    }
    assert!(crossings > 5000, "{crossings}");
}

#[test]
fn prisms_agree_with_lines() {
    let mut rng = ChaCha8Rng::seed_from_u64(13);
    for (contours, outside) in regions(&mut rng) {
        let region = region(&contours, outside).unwrap();
        let program = Program::compile(&region.extrude(-1.0, 2.5).unwrap()).unwrap();
        let weave = Weave::new(Arc::new(program));
        for (p, q) in lines(&mut rng, &contours) {
            let origin = p.map(|x| x as f64);
            // the line in an edge moves to one side in the plane and to the other one in space
            let differs = |w: Point<2>| (q[0] - p[0]) as f64 * w[1] > (q[1] - p[1]) as f64 * w[0];
            let w = lie_direction::<3>();
            if differs(lie_direction::<2>()) != differs([w[0], w[1]]) {
                continue;
            }
            let direction = [q[0] - p[0], q[1] - p[1]].map(|x| x as f64);
            let traced = region.trace(origin, direction).unwrap();
            let ray = Ray::new([origin[0], origin[1], 0.5].into(), [direction[0], direction[1], 0.0].into());
            let answer = weave.one(ray, &Query::default()).unwrap();
            let times: Vec<f64> = answer.of(0).iter().map(|c| c.t).collect();
            assert_eq!(traced.roots().len(), times.len(), "{contours:?} {p:?} {q:?} {traced} {times:?}");
            let near = |(a, b): (f64, &f64)| (a - b).abs() <= 1e-10 * (1.0 + b.abs());
            assert!(traced.times().zip(&times).all(near), "{contours:?} {p:?} {q:?} {traced} {times:?}");
        }
    }
}

#[test]
fn a_scan_gives_what_its_lines_give_alone() {
    let mut rng = ChaCha8Rng::seed_from_u64(14);
    for (contours, outside) in regions(&mut rng) {
        let region = region(&contours, outside).unwrap();
        let direction = [0, 1].map(|_| f64::from(rng.random_range(-4i32..=4)));
        if direction == [0.0; 2] {
            continue;
        }
        let origins: Vec<Point<2>> = points(&random_contour(&mut rng, 50, 30));
        let scan = region.scan(direction, &origins).unwrap();
        assert_eq!((scan.len(), scan.start(), scan.is_empty()), (50, outside, false));
        for (k, &origin) in origins.iter().enumerate() {
            assert_eq!(scan.roots(k), region.trace(origin, direction).unwrap().roots());
        }
    }
}

#[test]
fn whatever_crosses_or_touches_is_found() {
    let mut rng = ChaCha8Rng::seed_from_u64(15);
    let (mut clear, mut touching) = (0, 0);
    for round in 0..30_000 {
        let n = 3 + round % 6;
        let size = [2, 4, 9][round % 3];
        let mut contours = vec![random_contour(&mut rng, n, size)];
        if round % 4 == 0 {
            contours.push(random_contour(&mut rng, 3, size));
        }
        let kept: Contours = contours.iter().map(|c| corners(c)).filter(|c| !c.is_empty()).collect();
        let outcome = region(&contours, Side::Outside);
        let found = matches!(outcome, Err(PolygonError::Touching { .. }));
        assert_eq!(found, !is_clear(&kept), "{contours:?} {outcome:?}");
        if let Err(PolygonError::Touching { first, second }) = outcome {
            let ends = |e: super::Edge| (contours[e.contour][e.from], contours[e.contour][e.to]);
            assert!(first != second && meet(ends(first), ends(second)), "{contours:?}");
            touching += 1;
        } else {
            clear += 1;
        }
    }
    assert!(clear > 5000 && touching > 5000, "{clear} {touching}");
}

#[test]
fn only_one_way_around_is_right_at_every_depth() {
    let rings = |turned: u32, outside| {
        let ring = |k: i64| {
            let mut ring = square(20 - 3 * k);
            if turned >> k & 1 == 1 {
                ring.reverse();
            }
            ring
        };
        region(&(0..5).map(ring).collect::<Contours>(), outside)
    };
    for turned in 0..32u32 {
        for (outside, right) in [(Side::Outside, 0b01010), (Side::Inside, 0b10101)] {
            let wrong = (0..5).find(|k| (turned ^ right) >> k & 1 == 1);
            let around = |k: usize| k.checked_sub(1);
            match (rings(turned, outside), wrong) {
                (Ok(region), None) => {
                    let depths: Vec<_> = region.contours().map(|c| c.around).collect();
                    assert_eq!(depths, (0..5).map(around).collect::<Vec<_>>());
                }
                (Err(PolygonError::Orientation { contour, clockwise, around: outer }), Some(wrong)) => {
                    assert_eq!((contour, clockwise), (wrong, turned >> wrong & 1 == 1));
                    assert_eq!(outer, around(wrong));
                }
                (outcome, _) => panic!("{turned:b} {outside}: {outcome:?}"),
            }
        }
    }
}

#[test]
fn messages_name_the_place_and_suggest() {
    let message =
        |contours: &[Vec<Point<2>>], outside| from_polygons(contours, outside).unwrap_err().to_string();
    let square = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
    let mut bad = square.clone();
    bad[2][1] = f64::NAN;
    assert_eq!(
        message(&[square.clone(), bad.clone()], Side::Outside),
        "contour 1, vertex 2: y is NaN (coordinates are finite)"
    );
    bad[2][1] = -2e60;
    let text = message(&[bad], Side::Outside);
    assert!(
        text.starts_with("contour 0, vertex 2: y is -2000") && text.ends_with("use another unit?"),
        "{text}"
    );
    let shifted: Vec<Point<2>> = square.iter().map(|p| [p[0] + 4.0, p[1] + 1.0]).collect();
    let text = message(&[vec![], square.clone(), shifted], Side::Outside);
    assert!(
        text.starts_with("contour 1, edge from vertex 1 to vertex 2 crosses or touches contour 2, edge"),
        "{text}"
    );
    let reversed: Vec<Point<2>> = square.iter().rev().copied().collect();
    let text = message(std::slice::from_ref(&reversed), Side::Outside);
    assert!(
        text.starts_with("contour 0 goes around clockwise, as a hole does, but lies in no other contour"),
        "{text}"
    );
    assert!(
        text.ends_with("reverse its vertices (or give outside = -1, if the region is unbounded)?"),
        "{text}"
    );
    let text = message(&[square], Side::Inside);
    assert!(text.contains("where it is inside already") && text.contains("outside = +1"), "{text}");
}

#[test]
fn bad_lines_are_refused() {
    let plate = region(&[square(4)], Side::Outside).unwrap();
    let message = |o, d| plate.trace(o, d).unwrap_err().to_string();
    assert!(message([0.0, f64::INFINITY], [1.0, 0.0]).contains("not finite"));
    assert!(message([0.0; 2], [f64::NAN, 0.0]).contains("not finite"));
    assert!(message([0.0; 2], [0.0, -0.0]).contains("zero"));
    assert!(message([0.0; 2], [1e-61, 0.0]).contains("1e-60"));
    assert!(message([0.0, 1e61], [1.0, 0.0]).contains("1e60"));
    assert!(plate.contains([f64::NAN, 0.0]).is_err());
}

#[test]
fn closed_forms() {
    let plate = region(&[square(4), square(1).into_iter().rev().collect()], Side::Outside).unwrap();
    assert_eq!(plate.area(), 60.0);
    assert_eq!(plate.corner_bounds(), [[-4.0; 2], [4.0; 2]]);
    let across = plate.trace([-10.0, 0.5], [2.0, 0.0]).unwrap();
    assert_eq!(across.times().collect::<Vec<_>>(), [3.0, 4.5, 5.5, 7.0]);
    let names: Vec<_> =
        across.roots().iter().map(|r| plate.edge(r.surface)).map(|e| (e.contour, e.from)).collect();
    assert_eq!(names, [(0, 3), (1, 3), (1, 1), (0, 1)]);
    // w points to +x and +y: the lower and the left face are in, the upper and the right one are not
    let hits = |p, d| plate.trace(p, d).unwrap().times().collect::<Vec<_>>();
    assert_eq!(hits([0.0, -4.0], [1.0, 0.0]), [-4.0, 4.0]);
    assert_eq!(hits([0.0, 4.0], [1.0, 0.0]), [0.0; 0]);
    assert_eq!(hits([-4.0, 0.0], [0.0, -1.0]), [-4.0, 4.0]);
    assert_eq!(hits([4.0, 0.0], [0.0, 1.0]), [0.0; 0]);
    let contains = |p| plate.contains(p).unwrap();
    assert!(contains([2.0, 0.0]) && !contains([0.0, 0.0]) && !contains([5.0, 0.0]));
    let all = region(&[], Side::Inside).unwrap();
    assert!(all.area().is_infinite() && all.contains([1.0, 2.0]).unwrap());
    assert_eq!(all.corner_bounds(), [[f64::INFINITY; 2], [f64::NEG_INFINITY; 2]]);
}
