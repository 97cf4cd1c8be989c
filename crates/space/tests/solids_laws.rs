//! Laws of solids in R^d: sides between crossings, boolean algebra, shared faces, lines in faces, trees of any depth.

#![allow(clippy::eq_op, reason = "solids less themselves are laws, too")]

use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_rootray::{RootRay, Side};
use rayweave_space::{Face, Point, Solid, Tracer, trace};

type Rng = ChaCha8Rng;

/// A solid with an independent containment formula.
struct Model<const D: usize> {
    solid: Solid<D>,
    inside: Box<dyn Fn(&Point<D>) -> bool>,
}

fn number(rng: &mut Rng, grid: bool) -> f64 {
    if grid { f64::from(rng.random_range(-2..=2i32)) } else { rng.random_range(-2.0..2.0) }
}

fn point<const D: usize>(rng: &mut Rng, grid: bool) -> Point<D> {
    std::array::from_fn(|_| number(rng, grid))
}

fn leaf<const D: usize>(rng: &mut Rng, grid: bool) -> Model<D> {
    let size = if grid { f64::from(rng.random_range(1..3u8)) } else { rng.random_range(0.4..2.0) };
    let m = rng.random_range(1..=D);
    let squares = |p: &[f64]| p.iter().map(|x| x * x).sum::<f64>();
    match rng.random_range(0..5u8) {
        0 => {
            let inside = Box::new(move |p: &Point<D>| squares(p) < size * size);
            Model { solid: Solid::ball(size).unwrap(), inside }
        }
        1 => {
            let (lo, axis) = (point::<D>(rng, grid), m - 1);
            let hi = lo.map(|x| x + size);
            match grid {
                true => {
                    let inside = Box::new(move |p: &Point<D>| (0..D).all(|k| lo[k] < p[k] && p[k] < hi[k]));
                    Model { solid: Solid::box_from_corners(lo, hi).unwrap(), inside }
                }
                false => {
                    let inside = Box::new(move |p: &Point<D>| lo[axis] < p[axis] && p[axis] < hi[axis]);
                    Model { solid: Solid::slab(axis, lo[axis], hi[axis]).unwrap(), inside }
                }
            }
        }
        2 => {
            let mut normal = point::<D>(rng, grid);
            normal[m - 1] = 1.0;
            let offset = number(rng, grid);
            let along = move |p: &Point<D>| (0..D).map(|k| normal[k] * p[k]).sum::<f64>();
            let inside = Box::new(move |p: &Point<D>| along(p) < offset);
            Model { solid: Solid::half_space_below(normal, offset).unwrap(), inside }
        }
        3 => {
            let inside = Box::new(move |p: &Point<D>| squares(&p[..m]) < size * size);
            Model { solid: Solid::cylinder(m, size).unwrap(), inside }
        }
        _ => {
            let bias = number(rng, grid);
            let inside = Box::new(move |p: &Point<D>| squares(&p[..m]) - squares(&p[m..]) + bias < 0.0);
            Model { solid: Solid::quadric(D, m, bias).unwrap(), inside }
        }
    }
}

/// The solid under a rotation, a scale or a translation; the formula evaluates the inverse image of the point.
fn moved<const D: usize>(rng: &mut Rng, grid: bool, model: Model<D>) -> Model<D> {
    let (from, to) = (rng.random_range(0..D - 1), D - 1);
    let degrees =
        if grid { 90.0 * f64::from(rng.random_range(0..4u8)) } else { rng.random_range(0.0..360.0) };
    let factors: Point<D> = std::array::from_fn(|_| if grid { 1.0 } else { rng.random_range(0.5..2.0) });
    let shift = point::<D>(rng, grid);
    let turned = model.solid.rotate(from, to, degrees).unwrap();
    let solid = turned.scale(factors).unwrap().translate(shift).unwrap();
    let (sin, cos) = degrees.to_radians().sin_cos();
    let inside = model.inside;
    let back = move |p: &Point<D>| {
        let mut q: Point<D> = std::array::from_fn(|k| (p[k] - shift[k]) / factors[k]);
        (q[from], q[to]) = (cos * q[from] + sin * q[to], cos * q[to] - sin * q[from]);
        inside(&q)
    };
    Model { solid, inside: Box::new(back) }
}

fn tree<const D: usize>(rng: &mut Rng, grid: bool) -> Model<D> {
    let count = rng.random_range(1..7);
    let mut pool: Vec<Model<D>> = Vec::new();
    for _ in 0..count {
        let leaf = leaf(rng, grid);
        pool.push(moved(rng, grid, leaf));
    }
    while pool.len() > 1 {
        let a = pool.swap_remove(rng.random_range(0..pool.len()));
        let b = pool.swap_remove(rng.random_range(0..pool.len()));
        let (f, g) = (a.inside, b.inside);
        pool.push(match rng.random_range(0..5u8) {
            0 => Model { solid: a.solid | b.solid, inside: Box::new(move |p| f(p) || g(p)) },
            1 => Model { solid: a.solid & b.solid, inside: Box::new(move |p| f(p) && g(p)) },
            2 => Model { solid: a.solid - b.solid, inside: Box::new(move |p| f(p) && !g(p)) },
            3 => Model { solid: a.solid ^ b.solid, inside: Box::new(move |p| f(p) ^ g(p)) },
            _ => Model { solid: !a.solid, inside: Box::new(move |p| !f(p)) },
        });
    }
    pool.remove(0)
}

/// Checks the sides of points between neighbouring crossings and far outside against the formula. Spans shorter than 1e-4 are skipped,
/// where the rounding of the formula matters.
fn check_sides<const D: usize>(model: &Model<D>, p: Point<D>, q: Point<D>, tracer: &mut Tracer<D>) -> usize {
    let ray = tracer.trace(p, q).unwrap();
    let ends = [-40.0, 40.0];
    let times: Vec<f64> =
        [ends[0]].into_iter().chain(ray.times().filter(|t| t.abs() < 40.0)).chain([ends[1]]).collect();
    let mut checked = 0;
    for pair in times.windows(2).filter(|pair| pair[1] - pair[0] > 1e-4) {
        for share in [0.1, 0.37, 0.5, 0.77, 0.9] {
            let t = pair[0] + share * (pair[1] - pair[0]);
            let at: Point<D> = std::array::from_fn(|k| p[k] + t * (q[k] - p[k]));
            let inside = ray.side_at(t).unwrap() == Side::Inside;
            // at a point where the line touches a surface, the formula may return either side
            let beside = |s: f64| (model.inside)(&std::array::from_fn(|k| at[k] + s * (q[k] - p[k])));
            let agrees = [0.0, 1e-6, -1e-6].iter().any(|&s| beside(s) == inside);
            assert!(agrees, "{p:?} {q:?} at {t}: {inside}, {ray}");
            checked += 1;
        }
    }
    checked
}

fn sides<const D: usize>(seed: u64) -> usize {
    let (mut rng, mut checked) = (Rng::seed_from_u64(seed), 0);
    for _ in 0..120 {
        let model = tree::<D>(&mut rng, false);
        let mut tracer = Tracer::new(&model.solid).unwrap();
        for _ in 0..20 {
            let (p, q) = (point(&mut rng, false), point(&mut rng, false));
            checked += check_sides(&model, p, q, &mut tracer);
        }
    }
    checked
}

#[test]
fn sides_between_crossings_agree_with_the_formula() {
    assert!(sides::<2>(1) > 10_000);
    assert!(sides::<3>(2) > 10_000);
    assert!(sides::<4>(3) > 10_000);
    assert!(sides::<5>(4) > 10_000);
}

/// Start side and times, as bits.
fn bits<const D: usize>(ray: &RootRay<Face<D>>) -> (Side, Vec<u64>) {
    (ray.start(), ray.times().map(f64::to_bits).collect())
}

fn laws<const D: usize>(seed: u64) -> usize {
    let (mut rng, mut crossings) = (Rng::seed_from_u64(seed), 0);
    for k in 0..150 {
        let grid = k % 3 != 0;
        let [a, b, c] = [0; 3].map(|_| tree::<D>(&mut rng, grid).solid);
        let pairs = [
            (&a | &b, &b | &a),
            (&a & &b, &b & &a),
            (&a ^ &b, &b ^ &a),
            (&(&a | &b) | &c, &a | &(&b | &c)),
            (&(&a & &b) & &c, &a & &(&b & &c)),
            (&(&a ^ &b) ^ &c, &a ^ &(&b ^ &c)),
            (&a & &(&b | &c), &(&a & &b) | &(&a & &c)),
            (&a | &(&b & &c), &(&a | &b) & &(&a | &c)),
            (!(&a | &b), !&a & !&b),
            (&a - &b, &a & &!&b),
            (&a ^ &b, &(&a - &b) | &(&b - &a)),
            (&a | &(&a & &b), a.clone()),
            (&a & &(&a | &b), a.clone()),
            (!!&a, a.clone()),
            (Solid::union([a.clone(), b.clone(), c.clone()]), &a | &(&b | &c)),
            (&a | &!&a, Solid::universe()),
            (&a - &a, Solid::empty()),
            (&a ^ &a, Solid::empty()),
        ];
        let mut tracers = pairs.map(|(x, y)| (Tracer::new(&x).unwrap(), Tracer::new(&y).unwrap()));
        for _ in 0..8 {
            let p: Point<D> = point(&mut rng, grid);
            let mut q = point(&mut rng, grid);
            q[0] += if p == q { 1.0 } else { 0.0 };
            for (number, (x, y)) in tracers.iter_mut().enumerate() {
                let (x, y) = (x.trace(p, q).unwrap(), y.trace(p, q).unwrap());
                assert_eq!(bits(&x), bits(&y), "law {number}, tree {k}: {p:?} {q:?}");
                crossings += x.roots().len();
            }
        }
    }
    crossings
}

#[test]
fn the_laws_of_boolean_algebra_hold_bit_for_bit() {
    assert!(laws::<2>(1) > 10_000);
    assert!(laws::<3>(2) > 10_000);
    assert!(laws::<4>(3) > 10_000);
}

fn corners<const D: usize>(lo: f64, hi: f64, first: (f64, f64)) -> Solid<D> {
    let corner = |x: f64, first: f64| std::array::from_fn(|k| if k == 0 { first } else { x });
    Solid::box_from_corners(corner(lo, first.0), corner(hi, first.1)).unwrap()
}

/// Two boxes that share the face x_0 = 0, with lines across it, along it and through its corners: as they are, rotated, and with one of
/// the boxes placed by other maps.
fn shared_face<const D: usize>(rng: &mut Rng) {
    let left = corners::<D>(0.0, 2.0, (-1.0, 0.0));
    let right = corners::<D>(0.0, 2.0, (0.0, 3.0));
    let carried = right.translate([0.3; D]).unwrap().translate([-0.3; D]).unwrap();
    for right in [right, carried] {
        for degrees in [0.0, 90.0, 33.0, 217.3] {
            let turn = |solid: &Solid<D>| solid.rotate(0, D - 1, degrees).unwrap();
            let turned = |p: Point<D>| rayweave_space::Affine::rotation(0, D - 1, degrees).unwrap().point(&p);
            let (a, b) = (turn(&left), turn(&right));
            let (union, common, rest) = (&a | &b, &a & &b, &a - &b);
            let across = |p, q| (turned(p), turned(q));
            let inner = |rng: &mut Rng| -> Point<D> { std::array::from_fn(|_| rng.random_range(0.2..1.8)) };
            for _ in 0..20 {
                let (mut p, mut q) = (inner(rng), inner(rng));
                (p[0], q[0]) = (-2.0, 4.0);
                let (p, q) = across(p, q);
                assert_eq!(trace(p, q, &union).unwrap().roots().len(), 2);
                assert_eq!(trace(p, q, &common).unwrap().roots().len(), 0);
                let (only, rest) = (trace(p, q, &a).unwrap(), trace(p, q, &rest).unwrap());
                assert_eq!(bits(&only), bits(&rest));
            }
            // in the face: perturbed along w into one of the boxes
            let (mut p, mut q) = ([0.0; D], [0.0; D]);
            (p[D - 1], q[D - 1]) = (-1.0, 1.0);
            (1..D - 1).for_each(|k| (p[k], q[k]) = (0.5, 0.75));
            let (p, q) = across(p, q);
            let (whole, both) = (trace(p, q, &union).unwrap(), trace(p, q, &common).unwrap());
            assert_eq!((whole.start(), whole.roots().len()), (Side::Outside, 2), "{degrees} {whole}");
            assert!(whole.times().zip([0.5, 1.5]).all(|(t, want)| (t - want).abs() < 1e-14));
            assert_eq!((both.start(), both.roots().len()), (Side::Outside, 0));
            let (only, rest) = (trace(p, q, &a).unwrap(), trace(p, q, &rest).unwrap());
            assert_eq!(bits(&only), bits(&rest));
        }
    }
}

#[test]
fn touching_boxes_join_without_a_seam() {
    let mut rng = Rng::seed_from_u64(5);
    shared_face::<2>(&mut rng);
    shared_face::<3>(&mut rng);
    shared_face::<4>(&mut rng);
}

/// All 2^D boxes around one point: lines through it along axes, diagonals and edges cross one solid.
fn orthants<const D: usize>() {
    let all = Solid::<D>::union((0..1u32 << D).map(|signs| {
        let is_negative = |k: usize| signs >> k & 1 == 1;
        let lo = std::array::from_fn(|k| if is_negative(k) { -1.0 } else { 0.0 });
        Solid::box_from_corners(lo, lo.map(|x| x + 1.0)).unwrap()
    }));
    for directions in 1..3u32.pow(D as u32) {
        let digit = |k: usize| f64::from(directions / 3u32.pow(k as u32) % 3) - 1.0;
        let q: Point<D> = std::array::from_fn(digit);
        if q == [0.0; D] {
            continue;
        }
        let ray = trace([0.0; D], q, &all).unwrap();
        assert_eq!((ray.start(), ray.times().collect::<Vec<_>>()), (Side::Outside, vec![-1.0, 1.0]), "{q:?}");
        assert_eq!(trace([0.0; D], q, &!&all).unwrap().times().collect::<Vec<_>>(), [-1.0, 1.0]);
    }
}

#[test]
fn fans_of_boxes_are_solid_along_their_common_edges() {
    orthants::<2>();
    orthants::<3>();
    orthants::<4>();
}

#[test]
fn touching_spheres_are_distinct_and_equal_spheres_are_one() {
    fn check<const D: usize>() {
        let at = |x: f64| {
            let shift = std::array::from_fn(|k| if k == 0 { x } else { 0.0 });
            Solid::<D>::ball(1.0).unwrap().translate(shift).unwrap()
        };
        let mut q = [0.0; D];
        q[0] = 1.0;
        let (a, b) = (at(-1.0), at(1.0));
        // through the point of contact: neither gap nor overlap
        assert_eq!(trace([0.0; D], q, &(&a | &b)).unwrap().times().collect::<Vec<_>>(), [-2.0, 2.0]);
        assert_eq!(trace([0.0; D], q, &(&a & &b)).unwrap().roots().len(), 0);
        // the same ball, constructed differently
        let same = at(0.25).translate(std::array::from_fn(|k| if k == 0 { 0.75 } else { 0.0 })).unwrap();
        let mut p = [0.1; D];
        p[0] = -3.0;
        assert_eq!(trace(p, q, &(&b ^ &same)).unwrap().roots().len(), 0);
        assert_eq!(bits(&trace(p, q, &(&b | &same)).unwrap()), bits(&trace(p, q, &b).unwrap()));
        // a tangent line
        let mut high = [0.0; D];
        high[1] = 1.0;
        let mut on = high;
        on[0] = 1.0;
        assert_eq!(trace(high, on, &at(0.0)).unwrap().roots().len(), 0);
    }
    check::<2>();
    check::<3>();
    check::<4>();
}

const DEPTH: usize = 100_000;

/// Builds, compiles, traces and drops deep chains of operators, complements, maps and names.
fn deep() {
    let slab = |k: usize| Solid::<4>::slab(0, 2.0 * k as f64, 2.0 * k as f64 + 1.0).unwrap();
    let mut comb = slab(0);
    for k in 1..DEPTH {
        comb = match k % 3 {
            0 => comb | slab(k),
            1 => slab(k) | comb,
            _ => !(!comb & !slab(k)),
        };
    }
    let ray = trace([-1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], &comb).unwrap();
    assert_eq!(ray.roots().len(), 2 * DEPTH);
    assert!(ray.times().enumerate().all(|(k, t)| t == k as f64 + 1.0));
    let mut moved = Solid::<2>::ball(1.0).unwrap();
    for k in 0..DEPTH {
        moved = match k % 3 {
            0 => moved.translate([1.0, 0.0]).unwrap(),
            1 => !moved.translate([-1.0, 0.0]).unwrap(),
            _ => moved.named("ball").rotate(0, 1, 90.0).unwrap(),
        };
    }
    let ray = trace([-2.0, 0.25], [-1.0, 0.25], &moved).unwrap();
    assert_eq!(ray.roots().len(), 2);
    assert_eq!(moved.compile().unwrap().leaf_name(0), Some("ball"));
    // each step uses the previous one twice: 2^100,000 paths
    let mut shared = Solid::<3>::ball(1.0).unwrap();
    for k in 0..DEPTH {
        let other = Solid::half_space(k % 3).unwrap();
        shared = if k % 2 == 0 { &shared ^ &(&shared & &other) } else { &shared | &shared };
    }
    assert!(trace([0.0; 3], [1.0; 3], &shared).unwrap().roots().len() <= 2);
    let tall = comb.extrude::<5>().unwrap();
    drop((comb, moved, shared, tall));
}

#[test]
fn deep_trees_need_no_stack() {
    let thread = std::thread::Builder::new().stack_size(256 * 1024).spawn(deep).unwrap();
    assert!(thread.join().is_ok());
}

#[test]
fn a_tracer_is_reusable() {
    let mut rng = Rng::seed_from_u64(6);
    for grid in [false, true] {
        let model = tree::<4>(&mut rng, grid);
        let mut tracer = Tracer::new(&model.solid).unwrap();
        for _ in 0..50 {
            let (p, q): (Point<4>, Point<4>) = (point(&mut rng, false), point(&mut rng, false));
            let (again, fresh) = (tracer.trace(p, q).unwrap(), trace(p, q, &model.solid).unwrap());
            assert_eq!(again, fresh);
            assert_eq!(trace(p, q, &model.solid.clone()).unwrap(), fresh);
        }
    }
}

/// Checks that the line through p and q has the crossings of the line translated by 1e-7 w, for
/// times below 100.
fn lies_like_its_neighbour<const D: usize>(solid: &Solid<D>, p: Point<D>, q: Point<D>) -> Vec<f64> {
    let w = rayweave_math::perturbation_direction::<D>();
    let perturbation = |p: Point<D>| std::array::from_fn(|k| p[k] + 1e-7 * w[k]);
    let near = |ray: RootRay<Face<D>>| ray.clip(-100.0, 100.0).unwrap();
    let (on, beside) =
        (near(trace(p, q, solid).unwrap()), near(trace(perturbation(p), perturbation(q), solid).unwrap()));
    assert_eq!((on.start(), on.roots().len()), (beside.start(), beside.roots().len()), "{on} {beside}");
    assert!(on.times().zip(beside.times()).all(|(t, s)| (t - s).abs() < 1e-6), "{on} {beside}");
    on.times().collect()
}

#[test]
fn a_line_in_a_surface_agrees_with_the_perturbed_line() {
    // two crossing lines: a line translated off one of them crosses the other
    let wedge = Solid::<2>::quadric(2, 1, 0.0).unwrap();
    assert_eq!(lies_like_its_neighbour(&wedge, [1.0, 1.0], [2.0, 2.0]), [-1.0]);
    // independent of other parts of the model
    let ball = Solid::<2>::ball(0.5).unwrap().translate([9.0, 3.0]).unwrap();
    assert_eq!(lies_like_its_neighbour(&(&wedge - &ball), [1.0, 1.0], [2.0, 2.0]), [-1.0]);
    let cone = Solid::<3>::quadric(3, 2, 0.0).unwrap();
    assert_eq!(lies_like_its_neighbour(&cone, [3.0, 4.0, 5.0], [6.0, 8.0, 10.0]), [-1.0]);
    let light = Solid::<4>::cone(3, 1.0).unwrap();
    assert_eq!(lies_like_its_neighbour(&light, [0.0; 4], [1.0, 2.0, 2.0, 3.0]), [0.0]);
    assert_eq!(lies_like_its_neighbour(&light, [-1.0, -2.0, -2.0, 3.0], [0.0; 4]), [1.0]);
    let hyperboloid = Solid::<3>::quadric(3, 2, -1.0).unwrap();
    assert_eq!(lies_like_its_neighbour(&hyperboloid, [1.0, -1.0, -1.0], [1.0, 0.0, 0.0]).len(), 1);
    let cylinder = Solid::<4>::cylinder(2, 5.0).unwrap();
    assert!(lies_like_its_neighbour(&cylinder, [3.0, 4.0, 0.0, 1.0], [3.0, 4.0, 1.0, 7.0]).is_empty());
    assert!(lies_like_its_neighbour(&!cylinder, [-3.0, 4.0, 0.0, 1.0], [-3.0, 4.0, 1.0, 7.0]).is_empty());
    let plane = Solid::<4>::half_space_below([1.0, -1.0, 0.0, 0.0], 0.0).unwrap();
    assert!(lies_like_its_neighbour(&plane, [1.0, 1.0, 0.0, 2.0], [2.0, 2.0, 5.0, 1.0]).is_empty());
}
