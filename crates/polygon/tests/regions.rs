//! Lines, formulas and prisms of a region, against each other and against exact arithmetic on lattice points.

mod support;

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::perturbation_direction;
use rayweave_model::{Evaluator, Program, Query};
use rayweave_polygon::{ContourEdge, HalfPlane, Operator, Point, PolygonError, from_polygons};
use rayweave_rootray::Side;
use rayweave_shape::Ray;
use rayweave_trace::Weave;
use std::sync::Arc;
use support::{
    Contours, Lattice, corners, intersect, is_clear, is_inside, lines, points, random_contour, region,
    regions, square,
};

#[test]
fn lines_agree_with_integer_containment() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let (mut checked, mut skipped) = (0, 0);
    for (contours, outside) in regions(&mut rng) {
        let region = region(&contours, outside).unwrap();
        for (p, q) in lines(&mut rng, &contours) {
            let d = [q[0] - p[0], q[1] - p[1]];
            let traced = region.trace(p.map(|x| x as f64), d.map(|x| x as f64)).unwrap();
            assert_eq!(traced.start(), traced.end(), "an odd number of roots");
            for _ in 0..12 {
                // times in 1/64; the point is perturbed along w by 2^-20
                let t = rng.random_range(-300i64..300);
                let w = perturbation_direction::<2>().map(|x| (x * 64.0) as i64);
                let scale = 1 << 26;
                let at = [0, 1].map(|k| p[k] * scale + t * d[k] * (scale / 64) + w[k]);
                let time = t as f64 / 64.0;
                // the perturbation moves roots slightly, and a touched corner has two of them
                let is_corner = |v: &Lattice| (0..2).all(|k| v[k] * 64 == p[k] * 64 + t * d[k]);
                let near_root = traced.times().any(|root| (root - time).abs() < 1e-3);
                if near_root || contours.iter().flatten().any(is_corner) {
                    skipped += 1;
                    continue;
                }
                let Some(truth) = is_inside(&contours, scale, outside, at) else { continue };
                let side = traced.side_at(time).unwrap();
                assert_eq!(side.is_inside(), truth, "{contours:?} {outside} {p:?} {q:?} t = {time}");
                checked += 1;
            }
        }
    }
    assert!(checked > 20_000 && skipped < checked / 10, "{checked} {skipped}");
}

#[test]
fn formulas_agree_with_integer_containment() {
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

fn height(half_plane: &HalfPlane, p: Point) -> f64 {
    half_plane.normal[0] * p[0] + half_plane.normal[1] * p[1] - half_plane.offset
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
            // skips lines whose perturbations in the plane and in space lead to different sides
            let differs = |w: Point| (q[0] - p[0]) as f64 * w[1] > (q[1] - p[1]) as f64 * w[0];
            let w = perturbation_direction::<3>();
            if differs(perturbation_direction::<2>()) != differs([w[0], w[1]]) {
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

/// Prisms whose formula is divided into cells: the answers are those of lines in the plane, which know no cells, also for lines
/// through corners and along edges.
#[test]
fn prisms_of_many_edges_agree_with_lines() {
    let mut rng = ChaCha8Rng::seed_from_u64(16);
    let mut star = |n: u32, inner: f64, outer: f64| -> Vec<Lattice> {
        let corner = |k: u32| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / f64::from(n));
            let radius = rng.random_range(inner..outer);
            [cos, sin].map(|x| (radius * x).round() as i64)
        };
        (0..n).map(corner).collect()
    };
    let mut hole = star(150, 300.0, 600.0);
    hole.reverse();
    let mut steps: Vec<Lattice> = (0..200).flat_map(|k| [[k, k], [k + 1, k]]).collect();
    steps.push([-40, 200]);
    let mut rng = ChaCha8Rng::seed_from_u64(17);
    for contours in [vec![star(600, 700.0, 3000.0), hole], vec![steps]] {
        let region = region(&contours, Side::Outside).unwrap();
        let program = Program::compile(&region.extrude(-1.0, 2.5).unwrap()).unwrap();
        let weave = Weave::new(Arc::new(program));
        let mut rays = 0;
        for _ in 0..20 {
            for (p, q) in lines(&mut rng, &contours) {
                let w = perturbation_direction::<3>();
                let differs = |w: Point| (q[0] - p[0]) as f64 * w[1] > (q[1] - p[1]) as f64 * w[0];
                if differs(perturbation_direction::<2>()) != differs([w[0], w[1]]) {
                    continue;
                }
                let (origin, direction) = (p.map(|x| x as f64), [q[0] - p[0], q[1] - p[1]].map(|x| x as f64));
                let traced = region.trace(origin, direction).unwrap();
                let ray =
                    Ray::new([origin[0], origin[1], 0.5].into(), [direction[0], direction[1], 0.0].into());
                let answer = weave.one(ray, &Query::default()).unwrap();
                let times: Vec<f64> = answer.of(0).iter().map(|c| c.t).collect();
                assert_eq!(traced.roots().len(), times.len(), "{p:?} {q:?} {traced} {times:?}");
                let near = |(a, b): (f64, &f64)| (a - b).abs() <= 1e-10 * (1.0 + b.abs());
                assert!(traced.times().zip(&times).all(near), "{p:?} {q:?} {traced} {times:?}");
                rays += 1;
            }
        }
        assert!(rays > 50, "{rays}");
    }
}

/// A point lies in the boxes of few half-spaces of a prism, however many it has.
#[test]
fn half_spaces_matter_near_their_edges() {
    for n in [300, 20_000] {
        let corner = |k: u32| {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / f64::from(n));
            let radius = 5.0 + 0.5 * f64::from((k * 7919) % 11) / 11.0;
            [radius * cos, radius * sin]
        };
        let star: Vec<Point> = (0..n).map(corner).collect();
        let region = from_polygons(&[star], Side::Outside).unwrap();
        let program = Program::compile(&region.extrude(0.0, 1.0).unwrap()).unwrap();
        let boxes = program.matters(&program.prototypes()[0]);
        for at in [[0.0, 0.0], [5.2, 0.0], [3.7, 3.7], [-4.0, 1.0], [0.1, -5.3]] {
            let is_around = |own: &&rayweave_math::Bounds| own.contains([at[0], at[1], 0.5].into());
            let around = boxes.iter().filter(is_around).count();
            assert!(around < 200, "{n} edges: {around} half-spaces matter at {at:?}");
        }
    }
}

#[test]
fn scan_lines_agree_with_single_lines() {
    let mut rng = ChaCha8Rng::seed_from_u64(14);
    for (contours, outside) in regions(&mut rng) {
        let region = region(&contours, outside).unwrap();
        let direction = [0, 1].map(|_| f64::from(rng.random_range(-4i32..=4)));
        if direction == [0.0; 2] {
            continue;
        }
        let origins: Vec<Point> = points(&random_contour(&mut rng, 50, 30));
        let scan = region.scan(direction, &origins).unwrap();
        assert_eq!((scan.len(), scan.start(), scan.is_empty()), (50, outside, false));
        for (k, &origin) in origins.iter().enumerate() {
            assert_eq!(scan.roots(k), region.trace(origin, direction).unwrap().roots());
        }
    }
}

#[test]
fn crossing_and_touching_edges_are_found() {
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
            let ends = |e: ContourEdge| (contours[e.contour][e.from], contours[e.contour][e.to]);
            assert!(first != second && intersect(ends(first), ends(second)), "{contours:?}");
            touching += 1;
        } else {
            clear += 1;
        }
    }
    assert!(clear > 5000 && touching > 5000, "{clear} {touching}");
}

#[test]
fn only_one_orientation_is_valid_at_every_depth() {
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
            let parent = |k: usize| k.checked_sub(1);
            match (rings(turned, outside), wrong) {
                (Ok(region), None) => {
                    let depths: Vec<_> = region.contours().map(|c| c.parent).collect();
                    assert_eq!(depths, (0..5).map(parent).collect::<Vec<_>>());
                }
                (Err(PolygonError::Orientation { contour, clockwise, parent: outer }), Some(wrong)) => {
                    assert_eq!((contour, clockwise), (wrong, turned >> wrong & 1 == 1));
                    assert_eq!(outer, parent(wrong));
                }
                (outcome, _) => panic!("{turned:b} {outside}: {outcome:?}"),
            }
        }
    }
}

#[test]
fn messages_give_the_location_and_a_suggestion() {
    let message =
        |contours: &[Vec<Point>], outside| from_polygons(contours, outside).unwrap_err().to_string();
    let square = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
    let mut bad = square.clone();
    bad[2][1] = f64::NAN;
    assert_eq!(
        message(&[square.clone(), bad.clone()], Side::Outside),
        "contour 1, vertex 2: y is NaN: coordinates must be finite."
    );
    bad[2][1] = -2e60;
    let text = message(&[bad], Side::Outside);
    assert!(
        text.starts_with("contour 0, vertex 2: y is -2000") && text.ends_with("Use a different unit."),
        "{text}"
    );
    let shifted: Vec<Point> = square.iter().map(|p| [p[0] + 4.0, p[1] + 1.0]).collect();
    let text = message(&[vec![], square.clone(), shifted], Side::Outside);
    assert!(
        text.starts_with("contour 1, edge from vertex 1 to vertex 2 crosses or touches contour 2, edge"),
        "{text}"
    );
    let reversed: Vec<Point> = square.iter().rev().copied().collect();
    let text = message(std::slice::from_ref(&reversed), Side::Outside);
    assert!(
        text.starts_with("contour 0 is clockwise, as a hole, but lies within no other contour"),
        "{text}"
    );
    assert!(
        text.ends_with("Reverse its vertices, or set outside to -1 if the region is unbounded."),
        "{text}"
    );
    let text = message(&[square], Side::Inside);
    assert!(text.contains("which is inside the region") && text.contains("set outside to +1"), "{text}");
}

#[test]
fn invalid_lines_are_rejected() {
    let plate = region(&[square(4)], Side::Outside).unwrap();
    let message = |o, d| plate.trace(o, d).unwrap_err().to_string();
    assert!(message([0.0, f64::INFINITY], [1.0, 0.0]).contains("must be finite"));
    assert!(message([0.0; 2], [f64::NAN, 0.0]).contains("must be finite"));
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
    // w points to +x and +y: lines in the lower and left edges are inside, in the upper and right edges outside
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
