//! Solids in R^d against closed forms, and validation of arguments.

use rayweave_rootray::{RootRay, Side};
use rayweave_space::curve::{Arc, Line, Parabola};
use rayweave_space::{Affine, Curve, Face, Point, Solid, SpaceError, Tracer, trace, trace_along};

fn times<const D: usize>(ray: &RootRay<Face<D>>) -> Vec<f64> {
    ray.times().collect()
}

fn close(got: &[f64], want: &[f64], slack: f64) {
    assert_eq!(got.len(), want.len(), "{got:?} {want:?}");
    assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() <= slack), "{got:?} {want:?}");
}

#[test]
fn half_space_slab_ball_and_box_have_their_closed_forms() {
    let half = Solid::<2>::half_space(1).unwrap();
    let ray = trace([3.0, -1.0], [5.0, 1.0], &half).unwrap();
    assert_eq!((ray.start(), times(&ray)), (Side::Inside, vec![0.5]));
    let face = ray.roots()[0].surface;
    assert_eq!((face.leaf, face.face, face.point, face.normal), (0, 0, [4.0, 0.0], [0.0, 1.0]));

    let ball = Solid::<4>::ball(2.0).unwrap();
    let ray = trace([-4.0, 0.0, 0.0, 0.0], [-3.0, 0.0, 0.0, 0.0], &ball).unwrap();
    assert_eq!((ray.start(), times(&ray)), (Side::Outside, vec![2.0, 6.0]));
    assert_eq!(ray.roots()[0].surface.normal, [-1.0, 0.0, 0.0, 0.0]);
    assert_eq!(ray.roots()[1].surface.normal, [1.0, 0.0, 0.0, 0.0]);

    let cube = Solid::<3>::box_from_corners([0.0; 3], [1.0, 2.0, 3.0]).unwrap();
    let ray = trace([-1.0, 1.0, 1.0], [0.0, 1.0, 1.0], &cube).unwrap();
    assert_eq!(times(&ray), [1.0, 2.0]);
    assert_eq!(ray.roots().iter().map(|r| r.surface.face).collect::<Vec<_>>(), [0, 1]);
    let slab = Solid::<1>::slab(0, -1.0, 4.0).unwrap();
    assert_eq!(times(&trace([0.0], [2.0], &slab).unwrap()), [-0.5, 2.0]);
}

#[test]
fn normals_of_a_complement_and_of_a_cavity_point_out_of_the_solid() {
    let shell = Solid::<2>::ball(2.0).unwrap() - Solid::ball(1.0).unwrap();
    let ray = trace([-3.0, 0.0], [-2.0, 0.0], &shell).unwrap();
    assert_eq!(times(&ray), [1.0, 2.0, 4.0, 5.0]);
    let normals: Vec<f64> = ray.roots().iter().map(|root| root.surface.normal[0]).collect();
    assert_eq!(normals, [-1.0, 1.0, -1.0, 1.0]);
    assert_eq!(ray.roots().iter().map(|root| root.surface.leaf).collect::<Vec<_>>(), [0, 1, 1, 0]);
    let outside = trace([-3.0, 0.0], [-2.0, 0.0], &!&shell).unwrap();
    assert_eq!(outside.start(), Side::Inside);
    assert_eq!(outside.roots()[0].surface.normal, [1.0, 0.0]);
}

/// The roots of the quadric (n, m, bias) on the line p + t d, by the textbook formula in exact small integers.
fn quadric_by_hand<const D: usize>(
    n: usize,
    m: usize,
    bias: f64,
    p: Point<D>,
    d: Point<D>,
) -> (bool, Vec<f64>) {
    let sign = |k: usize| if k < m { 1.0 } else { -1.0 };
    let sum = |f: &dyn Fn(usize) -> f64| (0..n).map(|k| sign(k) * f(k)).sum::<f64>();
    let (a, b, c) = (sum(&|k| d[k] * d[k]), sum(&|k| p[k] * d[k]), sum(&|k| p[k] * p[k]) + bias);
    let discriminant = b * b - a * c;
    let inside_far_away = [a, -b, c].into_iter().find(|&x| x != 0.0).is_some_and(|x| x < 0.0);
    match (a == 0.0, b == 0.0) {
        (true, true) => (inside_far_away, vec![]),
        (true, false) => (inside_far_away, vec![-0.5 * c / b]),
        _ if discriminant <= 0.0 => (a < 0.0, vec![]),
        _ => {
            let root = discriminant.sqrt();
            let (t, s) = ((-b - root) / a, (-b + root) / a);
            (a < 0.0, vec![t.min(s), t.max(s)])
        }
    }
}

fn quadrics<const D: usize>() -> usize {
    let mut count = 0;
    for n in 0..=D {
        for m in 0..=n {
            for bias in [-2.0, -1.0, 0.0, 1.0, 3.0] {
                let solid = Solid::<D>::quadric(n, m, bias).unwrap();
                let mut tracer = Tracer::new(&solid).unwrap();
                for k in 0..40 {
                    // small odd multiples of 1/8: lines in the surface are rare, and all values are exact
                    let number =
                        |k: usize, j: usize| ((k * 37 + j * 61 + k * k * j) % 33) as f64 / 8.0 - 2.0625;
                    let p: Point<D> = std::array::from_fn(|j| number(k, j));
                    let d: Point<D> = std::array::from_fn(|j| number(k + 7, j + 5));
                    let q = std::array::from_fn(|j| p[j] + d[j]);
                    let (inside, want) = quadric_by_hand(n, m, bias, p, d);
                    let ray = tracer.trace(p, q).unwrap();
                    assert_eq!(ray.start().is_inside(), inside, "{n} {m} {bias} {p:?} {d:?} {ray}");
                    let scale = 1.0 + want.iter().fold(0.0f64, |most, t| most.max(t.abs()));
                    close(&times(&ray), &want, 1e-12 * scale);
                    count += want.len();
                }
            }
        }
    }
    count
}

#[test]
fn quadrics_of_every_signature_have_the_roots_of_their_polynomial() {
    assert!(quadrics::<2>() > 200);
    assert!(quadrics::<3>() > 500);
    assert!(quadrics::<4>() > 1000);
    assert!(quadrics::<5>() > 2000);
}

#[test]
fn cylinders_and_cones_are_quadrics() {
    let line = ([0.5, -3.0, 0.25, 1.0], [0.75, -2.0, 0.5, 1.25]);
    for m in 1..=4 {
        let round = trace(line.0, line.1, &Solid::<4>::cylinder(m, 1.5).unwrap()).unwrap();
        assert_eq!(
            times(&round),
            times(&trace(line.0, line.1, &Solid::quadric(m, m, -2.25).unwrap()).unwrap())
        );
    }
    for m in 1..4 {
        let cone = trace(line.0, line.1, &Solid::<4>::cone(m, 2.0).unwrap()).unwrap();
        // slope 2: a cone of slope 1, stretched in the first m coordinates
        let factors = std::array::from_fn(|k| if k < m { 2.0 } else { 1.0 });
        let stretched = Solid::quadric(4, m, 0.0).unwrap().scale(factors).unwrap();
        let want = trace(line.0, line.1, &stretched).unwrap();
        assert_eq!(cone.start(), want.start());
        close(&times(&cone), &times(&want), 1e-13);
    }
}

#[test]
fn affine_maps_agree_with_inverse_maps_of_the_line() {
    let matrix = [[1.0, 0.5, 0.0, 2.0], [0.0, 2.0, -1.0, 0.0], [0.25, 0.0, 1.0, 0.0], [0.0, 0.0, 1.0, 1.0]];
    let shift = [1.0, -2.0, 3.0, 0.5];
    let map = Affine::new(matrix, shift).unwrap();
    let shapes = [
        Solid::<4>::ball(1.5).unwrap(),
        Solid::cylinder(2, 0.75).unwrap(),
        Solid::cone(3, 0.5).unwrap(),
        Solid::box_from_corners([-1.0, -2.0, -1.0, -0.5], [1.0, 1.0, 2.0, 0.5]).unwrap(),
        Solid::quadric(3, 1, 0.5).unwrap(),
        Solid::prism(&[[0.0, 0.0], [2.0, 0.0], [0.5, 0.5], [0.0, 2.0]]).unwrap(),
    ];
    let mut crossings = 0;
    for shape in &shapes {
        let moved = shape.affine(matrix, shift).unwrap();
        for k in 0..50 {
            let point =
                |j: usize| std::array::from_fn(|i| ((k * 29 + j * 53 + i * 17) % 41) as f64 / 10.0 - 2.03);
            let (p, q): (Point<4>, Point<4>) = (point(0), point(1));
            let want = trace(p, q, shape).unwrap();
            let got = trace(map.point(&p), map.point(&q), &moved).unwrap();
            assert_eq!(got.start(), want.start());
            close(&times(&got), &times(&want), 1e-10);
            crossings += want.roots().len();
            for (root, other) in got.roots().iter().zip(want.roots()) {
                // normals transform by the inverse transpose
                let back = map.covector(&root.surface.normal);
                let dot: f64 = back.iter().zip(&other.surface.normal).map(|(a, b)| a * b).sum();
                let size: f64 = back.iter().map(|a| a * a).sum::<f64>().sqrt();
                assert!((dot / size - 1.0).abs() < 1e-9, "{root:?} {other:?}");
            }
        }
    }
    assert!(crossings > 150, "{crossings}");
}

#[test]
fn prisms_accept_both_orientations_and_name_their_edges() {
    let arrow = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [2.0, 1.0], [0.0, 3.0]];
    let mut reversed = arrow;
    reversed.reverse();
    for (points, notch) in
        [(arrow, ["edge4", "edge3", "edge2", "edge1"]), (reversed, ["edge4", "edge0", "edge1", "edge2"])]
    {
        let plane = Solid::<2>::prism(&points).unwrap();
        let ray = trace([-1.0, 2.0], [0.0, 2.0], &plane).unwrap();
        assert_eq!((ray.start(), times(&ray)), (Side::Outside, vec![1.0, 2.0, 4.0, 5.0]));
        let program = plane.compile().unwrap();
        let names: Vec<_> =
            ray.roots().iter().map(|root| program.leaf_name(root.surface.leaf).unwrap().to_owned()).collect();
        let sides = [[0.0, 3.0], [2.0, 1.0]];
        assert!(sides.iter().all(|corner| points.contains(corner)));
        assert_eq!(names, notch);
        // in space-time the same region, for all z and t
        let always = Solid::<4>::prism(&points).unwrap();
        let ray = trace([-1.0, 2.0, 7.0, -1.0], [0.0, 2.0, 9.0, 5.0], &always).unwrap();
        assert_eq!(times(&ray), [1.0, 2.0, 4.0, 5.0]);
    }
}

#[test]
fn extruded_solids_do_not_depend_on_the_new_coordinates() {
    let flat = (Solid::<2>::ball(2.0).unwrap() - Solid::half_space(0).unwrap()).rotate(0, 1, 30.0).unwrap()
        ^ Solid::slab(1, -0.5, 0.5).unwrap().named("strip");
    let tall = flat.extrude::<4>().unwrap();
    for k in 0..20 {
        let (p, q) = ([0.1 * k as f64 - 1.0, -3.0], [0.2, 0.05 * k as f64]);
        let want = trace(p, q, &flat).unwrap();
        let got = trace([p[0], p[1], 5.0, -1.0], [q[0], q[1], -2.0, 3.0], &tall).unwrap();
        assert_eq!(got.start(), want.start());
        close(&times(&got), &times(&want), 1e-12);
    }
    assert_eq!(tall.extrude::<2>().err(), Some(SpaceError::Dimension { from: 4, to: 2 }));
    assert_eq!(tall.compile().unwrap().leaf_name(2), Some("strip"));
}

#[test]
fn curves_through_solids_of_the_plane_have_their_closed_forms() {
    // a stone thrown over a wall: y = 4 - t^2, x = t
    let throw = Parabola::new([0.0, 4.0], [1.0, 0.0], [0.0, -2.0]);
    let wall = Solid::<2>::box_from_corners([0.5, 0.0], [3.0, 3.0]).unwrap();
    let ray = trace_along(&throw, -3.0, 3.0, &wall).unwrap();
    assert_eq!(ray.start(), Side::Outside);
    close(&times(&ray), &[1.0, 2.0], 1e-14);
    assert_eq!(ray.roots()[0].surface.face, 3);
    assert_eq!(ray.roots()[0].surface.normal, [0.0, 1.0]);
    // a line as a curve has the roots of the line
    let (p, q) = ([-1.0, 0.25], [2.0, 1.0]);
    let line = Line::new(p, [3.0, 0.75]);
    let on_line = trace(p, q, &wall).unwrap().clip(-9.0, 9.0).unwrap();
    close(&times(&trace_along(&line, -9.0, 9.0, &wall).unwrap()), &times(&on_line), 1e-14);
    assert_eq!(line.position(1.0), q);
    // a circle about a corner of the wall is inside for a quarter of its length
    let circle = Arc::new([0.5, 0.0], [[0.25, 0.0], [0.0, 0.25]], 1.0).unwrap();
    let ray = trace_along(&circle, -0.5, 6.0, &wall).unwrap();
    close(&times(&ray), &[0.0, std::f64::consts::FRAC_PI_2], 1e-14);
    assert!(matches!(trace_along(&throw, 1.0, 1.0, &wall), Err(SpaceError::Curve(_))));
}

#[test]
fn invalid_numbers_are_rejected_with_their_index() {
    let nan = f64::NAN;
    let text = |error: Option<SpaceError>| error.map(|e| e.to_string()).unwrap_or_default();
    let half = Solid::<3>::half_space(0).unwrap();
    assert_eq!(trace([1.0; 3], [1.0; 3], &half).err(), Some(SpaceError::SamePoint));
    let nan_point = trace([1.0, nan, 0.0], [1.0; 3], &half).err();
    assert!(matches!(&nan_point, Some(SpaceError::NotFinite { what: "p", index, .. }) if *index == [1]));
    assert!(text(nan_point).starts_with("p[1] is NaN"));
    assert!(matches!(trace([0.0; 3], [1e200, 0.0, 0.0], &half), Err(SpaceError::Extreme { what: "q", .. })));
    assert_eq!(
        text(Solid::<3>::half_space(3).err()),
        "axis 3 is out of range: R^3 has the axes 0 to 2. Number axes from 0."
    );
    assert_eq!(Solid::<2>::half_space_below([0.0; 2], 1.0).err(), Some(SpaceError::ZeroNormal));
    assert!(matches!(Solid::<2>::ball(-1.0).err(), Some(SpaceError::NotPositive { what: "radius", .. })));
    assert!(matches!(Solid::<2>::ball(nan).err(), Some(SpaceError::NotFinite { .. })));
    assert!(matches!(Solid::<2>::slab(0, 1.0, 1.0).err(), Some(SpaceError::NotIncreasing { .. })));
    assert!(matches!(
        Solid::<2>::box_from_corners([0.0, 2.0], [1.0, 1.0]).err(),
        Some(SpaceError::NotIncreasing { index, .. }) if index == [1]
    ));
    assert!(matches!(Solid::<2>::quadric(3, 1, 0.0).err(), Some(SpaceError::Squares { .. })));
    assert!(matches!(Solid::<2>::quadric(1, 2, 0.0).err(), Some(SpaceError::Squares { .. })));
    assert!(matches!(Solid::<2>::cone(2, 1.0).err(), Some(SpaceError::Squares { .. })));
    assert!(matches!(Solid::<2>::cylinder(0, 1.0).err(), Some(SpaceError::Squares { .. })));
    assert!(matches!(
        Solid::<2>::prism(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]).err(),
        Some(SpaceError::Polygon(_))
    ));
    assert!(matches!(
        Solid::<1>::prism(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]).err(),
        Some(SpaceError::Dimension { .. })
    ));
    assert!(matches!(half.scale([1.0, 0.0, 1.0]).err(), Some(SpaceError::Map(_))));
    assert!(matches!(half.translate([nan, 0.0, 0.0]).err(), Some(SpaceError::NotFinite { .. })));
    assert!(matches!(half.rotate(0, 0, 10.0).err(), Some(SpaceError::SameAxis { axis: 0 })));
    assert!(matches!(half.compile().unwrap().contains([0.0, nan, 0.0]), Err(SpaceError::NotFinite { .. })));
    // maps that are well-conditioned individually
    let mut crushed = Solid::<2>::ball(1.0).unwrap();
    for _ in 0..10 {
        crushed = crushed.scale([1.0, 1e-10]).unwrap();
    }
    assert!(matches!(trace([0.0; 2], [1.0; 2], &crushed), Err(SpaceError::Map(_))));
    let mut vast = Solid::<2>::ball(1.0).unwrap();
    for _ in 0..30 {
        vast = vast.scale([1e50; 2]).unwrap();
    }
    assert!(trace([0.0; 2], [1.0; 2], &vast).is_err());
}

#[test]
fn points_on_faces_are_perturbed_along_w() {
    let cube = Solid::<4>::box_from_corners([0.0; 4], [1.0; 4]).unwrap().compile().unwrap();
    assert_eq!(cube.contains([0.5; 4]), Ok(true));
    assert_eq!(cube.contains([0.5, 0.5, 0.5, 1.5]), Ok(false));
    // w points to larger coordinates: points on the lower faces are inside, on the upper faces outside
    assert_eq!(cube.contains([0.0, 0.5, 0.5, 0.5]), Ok(true));
    assert_eq!(cube.contains([1.0, 0.5, 0.5, 0.5]), Ok(false));
    assert_eq!(Solid::<2>::universe().compile().unwrap().contains([0.0; 2]), Ok(true));
    assert_eq!(Solid::<2>::empty().compile().unwrap().contains([0.0; 2]), Ok(false));
}

/// The window is validated even for solids without faces.
#[test]
fn windows_are_checked_for_constant_solids_too() {
    let line = rayweave_space::curve::Line::new([0.0; 2], [1.0, 0.0]);
    for solid in [Solid::<2>::empty(), Solid::universe()] {
        for (t0, t1) in [(1.0, f64::NAN), (1.0, 1.0), (2.0, 1.0), (0.0, f64::INFINITY)] {
            let refused = trace_along(&line, t0, t1, &solid);
            assert!(matches!(refused, Err(SpaceError::Curve(_))), "{t0} {t1}: {refused:?}");
        }
    }
}

/// The chord of a ray is at least as long as the longest half axis, wherever the ray starts. At the contact w points inside.
#[test]
fn a_line_that_touches_a_flat_cylinder_does_not_lie_in_it() {
    let thin = 2f64.powi(-30);
    let flat = Solid::<3>::cylinder(2, 1.0).unwrap().scale([1.0, thin, 1.0]).unwrap();
    for exponent in -60..=10 {
        let x = 2f64.powi(exponent);
        for next in [x - 1.0, x + 1.0] {
            let ray = trace([x, -thin, 0.0], [next, -thin, 0.0], &flat).unwrap();
            assert_eq!((ray.start(), times(&ray)), (Side::Outside, vec![]), "{x} to {next}");
        }
    }
}

/// `x^2 - y^2 < 2^-40 (z^2 + w^2)`, nearly two crossing planes: the crossings have their places to the rounding of a point, along
/// lines nearly in one of the planes that are closest to the origin far from the edge of both.
#[test]
fn lines_nearly_in_one_of_two_crossing_planes_cross_both() {
    let wide = 2f64.powi(20);
    let solid = Solid::<4>::quadric(4, 1, 0.0).unwrap().scale([1.0, 1.0, wide, wide]).unwrap();
    for exponent in 0..=16 {
        let slope = 2f64.powi(-exponent);
        // sums and differences of the coordinates are exact
        let (p, v) = ([1.0, 1.0 + 0.125 * slope, 1.5, 0.5], [-0.75, -0.75 - 1.25 * slope, -0.625, 0.25]);
        let rest = |t: f64| ((p[2] + t * v[2]).powi(2) + (p[3] + t * v[3]).powi(2)) / (wide * wide);
        let sides = [(p[0] - p[1], v[0] - v[1]), (p[0] + p[1], v[0] + v[1])];
        // x - y = c and x + y = d with c d = rest: at the time s after that of the plane c = 0, s speed (d + s speed of d) = rest
        let mut want = [(sides[0], sides[1]), (sides[1], sides[0])].map(|((c, speed), (d, other))| {
            let plane = -c / speed;
            let step = |s: f64| rest(plane + s) / (speed * (d + (plane + s) * other));
            (plane + (0..40).fold(0.0, |s, _| step(s)), speed.abs())
        });
        want.sort_by(|a, b| a.0.total_cmp(&b.0));
        let got = times(&trace(p, std::array::from_fn(|k| p[k] + v[k]), &solid).unwrap());
        assert_eq!(got.len(), 2, "{exponent}: {got:?}");
        for (t, (expected, speed)) in got.iter().zip(want) {
            let off = (t - expected).abs() * speed;
            assert!(off <= 16.0 * f64::EPSILON, "{exponent}: {off} at {t} for {expected}");
        }
    }
}

/// Lines that touch an elliptic cylinder from outside do not enter it, however they are tilted along its axis and wherever they begin.
#[test]
fn tangents_of_elliptic_cylinders_do_not_enter() {
    for (stretch, point, along) in [(2.0, [3.0, 8.0], [-2.0, 3.0]), (64.0, [4.0, 192.0], [-3.0, 256.0])] {
        let cylinder = Solid::<3>::cylinder(2, 5.0).unwrap().scale([1.0, stretch, 1.0]).unwrap();
        for grow in [1.0, 1.0 / 3.0, 0.1] {
            let cylinder = cylinder.scale([grow, grow, grow]).unwrap();
            for (tilt, begin) in
                [0.0, 1e-9, 1e-3, 1.0, 1e3].iter().flat_map(|t| [-7.0, -0.5, 3.0].map(|b| (t, b)))
            {
                let at =
                    |s: f64| [grow * (point[0] + s * along[0]), grow * (point[1] + s * along[1]), tilt * s];
                let got = times(&trace(at(begin), at(begin + 1.0), &cylinder).unwrap());
                assert_eq!(got, [0.0; 0], "{stretch} {grow} {tilt} {begin}");
            }
        }
    }
}
