//! Sign changes along curves: against exact polynomials, planted roots, curves in surfaces, and
//! curves that violate their contract.

mod curves_support;

use curves_support::{Own, Polynomial};
use rayweave_conformance::Random;
use rayweave_math::{Affine, Vec3, perturbs_inside};
use rayweave_rootray::{RootRay, Side};
use rayweave_shape::surface::Surface;
use rayweave_space::curve::{Arc, Helix, Line, Mapped, Parabola, Spline, SplineEnds};
use rayweave_space::{Curve, CurveError, Point, isolate};
use std::f64::consts::{PI, TAU};

fn times(ray: &RootRay) -> Vec<f64> {
    ray.times().collect()
}

/// Checks that the roots are exactly the sign changes of a polynomial: as many as Sturm's theorem
/// gives, each within `within` of an exact sign change.
fn expect_exact(p: &Polynomial, got: &RootRay, (t0, t1): (f64, f64), within: f64, what: &str) {
    let times = times(got);
    assert_eq!(times.len(), p.count_roots(t0, t1), "{what}: {times:?}");
    assert_eq!(got.start().is_inside(), p.sign_at(t0) < 0, "{what}");
    for t in times {
        assert!(p.sign_at(t - within) * p.sign_at(t + within) < 0, "{what}: {t}");
    }
}

/// A projectile and a sphere, a cylinder, a cone about z, a plane: polynomials of degree 4 and 2.
#[test]
fn projectiles_against_exact_polynomials() {
    let mut rng = Random::new(1);
    let mut roots = 0;
    for round in 0..1500 {
        // a few binary digits make the exact polynomials of f and of the kernel the same
        let mut short = |half: f64| (rng.between(-half, half) * 1024.0).round() / 1024.0;
        let (p, v, a) =
            ([(); 3].map(|()| short(4.0)), [(); 3].map(|()| short(4.0)), [(); 3].map(|()| short(3.0)));
        let radius = short(2.0).abs() + 0.25;
        let curve = Parabola::new(p, v, a);
        let x: Vec<Polynomial> = (0..3).map(|k| Polynomial::new(&[p[k], v[k], 0.5 * a[k]])).collect();
        let square = |k: usize| x[k].times(&x[k]);
        let shifted = |c: f64| Polynomial::new(&[-c]);
        let (surface, g) = match round % 4 {
            0 => {
                let g = square(0).plus(&square(1)).plus(&square(2)).plus(&shifted(radius * radius));
                (Surface::sphere(Vec3::ZERO, radius), g)
            }
            1 => (
                Surface::cylinder(Vec3::ZERO, Vec3::Z, radius),
                square(0).plus(&square(1)).plus(&shifted(radius * radius)),
            ),
            2 => {
                let g = square(0).plus(&square(1)).plus(&square(2).times(&shifted(0.25)));
                (Surface::cone(Vec3::ZERO, Vec3::Z, 0.5), g)
            }
            _ => (Surface::plane(Vec3::Y, radius), x[1].plus(&shifted(radius))),
        };
        let got = isolate(&surface, &curve, -5.0, 5.0).unwrap();
        expect_exact(&g, &got, (-5.0, 5.0), 1e-9, &format!("round {round}"));
        roots += got.roots().len();
    }
    assert!(roots > 1000, "{roots}");
}

/// Two roots a gap apart near the vertex of a parabola, at random positions and scales: found down
/// to gaps at which the curve is within delta of the plane between them.
#[test]
fn near_double_roots() {
    let mut rng = Random::new(2);
    for round in 0..400 {
        let frame = rayweave_conformance::models::motion(&mut rng);
        let scale = libm::pow(10.0, rng.between(-8.0, 8.0));
        let map = frame.then(&Affine::scale(Vec3::splat(scale)));
        let gap = libm::pow(10.0, -3.0 - 9.0 * (f64::from(round) / 400.0));
        let sag = 0.25 * gap * gap;
        let (middle, side) = (rng.between(-0.5, 0.5), if rng.chance(0.5) { 1.0 } else { -1.0 });
        // z = side ((t - middle)^2 - sag), above a line in the plane z = 0
        let z = Parabola::new(
            [-middle, 0.3, side * (middle * middle - sag)],
            [1.0, 0.0, -2.0 * side * middle],
            [0.0, 0.0, 2.0 * side],
        );
        let curve = Mapped::new(z, map);
        let normal = map.vector(Vec3::Z);
        let plane = Surface::plane(normal, normal.dot(map.point(Vec3::ZERO)));
        let got = times(&isolate(&plane, &curve, -1.0, 1.0).unwrap());
        let delta = rayweave_shape::surface::delta_of(curve.size(middle) + plane.magnitude());
        if sag * scale > 2.0 * delta {
            assert_eq!(got.len(), 2, "gap {gap:e}");
            let off = 2.0 * delta / (gap * scale);
            assert!((got[0] - (middle - 0.5 * gap)).abs() < off, "{got:?} {middle} {gap:e}");
            assert!((got[1] - (middle + 0.5 * gap)).abs() < off, "{got:?} {middle} {gap:e}");
        }
        // with the vertex on the other side of the plane there is no root
        let above =
            Mapped::new(Parabola::new([0.0, 0.3, side * sag], [1.0, 0.0, 0.0], [0.0, 0.0, 2.0 * side]), map);
        if sag * scale > 2.0 * delta {
            assert!(times(&isolate(&plane, &above, -1.0, 1.0).unwrap()).is_empty());
        }
    }
}

/// `y = height + amplitude sin(rate t)` on the plane y = 0.
fn wave(amplitude: f64, rate: f64, height: f64) -> impl Curve<3> {
    Own {
        position: move |t: f64| [t, height + amplitude * libm::sin(rate * t), 0.0],
        velocity: move |t: f64| [1.0, amplitude * rate * libm::cos(rate * t), 0.0],
        bound: move |_, _| (amplitude * rate * rate).abs(),
    }
}

/// Zeros at multiples of powers of two, which are the points of subdivision, and crests that just
/// exceed the plane: all are found.
#[test]
fn waves_with_roots_at_subdivision_points() {
    let plane = Surface::plane(Vec3::Y, 0.0);
    for (amplitude, rate) in [(1.0, 64.0 * PI), (1e-3, 512.0 * PI), (1e-9, 1000.0), (1e-12, 256.0 * PI)] {
        let got = times(&isolate(&plane, &wave(amplitude, rate, 0.0), -0.001, 1.0 + 1e-4).unwrap());
        let want = (rate * (1.0 + 1e-4) / PI).floor() as usize + 1;
        let before = (rate * 0.001 / PI).floor() as usize;
        assert_eq!(got.len(), want + before, "{amplitude} {rate}");
        for (k, t) in got.iter().enumerate() {
            let exact = (k as f64 - before as f64) * PI / rate;
            assert!((t - exact).abs() < 1e-13 / (amplitude * rate) + 1e-15, "{t} {exact}");
        }
    }
    // only the crests: 2 acos(1 - depth) wide
    for depth in [1e-2, 1e-6, 1e-10] {
        let got = isolate(&plane, &wave(1.0, 100.0, -(1.0 - depth)), 0.0, TAU).unwrap();
        assert_eq!((got.start(), got.roots().len()), (Side::Inside, 200), "{depth}");
    }
}

/// A third-order contact of a user-defined curve: one crossing, however flat.
#[test]
fn a_flat_crossing_is_a_single_crossing() {
    let plane = Surface::plane(Vec3::Y, 0.0);
    for power in [3, 5, 7] {
        let n = f64::from(power);
        let curve = Own {
            position: move |t: f64| [t, libm::pow(t, n), 0.0],
            velocity: move |t: f64| [1.0, n * libm::pow(t, n - 1.0), 0.0],
            bound: move |a: f64, b: f64| n * (n - 1.0) * libm::pow(a.abs().max(b.abs()), n - 2.0),
        };
        let got = isolate(&plane, &curve, -0.7, 1.1).unwrap();
        assert_eq!(got.roots().len(), 1, "{power}: {got}");
        assert_eq!(got.start(), Side::Inside);
        // within delta of the plane over the whole window
        assert!(libm::pow(times(&got)[0], n).abs() < 1e-14);
    }
}

/// Dips of width 1e-5 in a curve of length 1, at random places: a sampling of less than 100,000 points misses some.
#[test]
fn narrow_dips_of_a_spline() {
    let mut rng = Random::new(4);
    let (mut knots, mut pieces) = (vec![0.0], Vec::new());
    let flat = |y: f64| [[0.0, y], [0.0; 2], [0.0; 2], [0.0; 2]];
    let dips = 300;
    for k in 0..dips {
        let at = (f64::from(k) + rng.between(0.1, 0.9)) / f64::from(dips);
        let width = 1e-5 * rng.between(0.5, 1.0);
        // down from 1 to -0.1 in the first half of the width, 1 - 1.1 (3 s^2 - 2 s^3), and up again
        let (start, middle, end) = (at, at + 0.5 * width, at + width);
        let mut ramp = |h: f64, from: f64, rise: f64| {
            pieces.push([[0.0, from], [0.0; 2], [0.0, 3.0 * rise / h / h], [0.0, -2.0 * rise / h / h / h]]);
        };
        ramp(1.0, 1.0, 0.0);
        ramp(middle - start, 1.0, -1.1);
        ramp(end - middle, -0.1, 1.1);
        knots.extend([start, middle, end]);
    }
    pieces.push(flat(1.0));
    knots.push(1.0);
    let spline = Spline::from_pieces(&knots, &pieces).unwrap();
    let line = Ball { centre: [0.0, -9.0], radius: 9.0 };
    let got = isolate(&line, &spline, 0.0, 1.0).unwrap();
    assert_eq!((got.start(), got.roots().len()), (Side::Outside, 2 * dips as usize));
}

/// A disc, for curves in the plane.
struct Ball<const D: usize> {
    centre: Point<D>,
    radius: f64,
}

impl<const D: usize> rayweave_space::Field<D> for Ball<D> {
    fn value_and_gradient(&self, point: &Point<D>) -> (f64, Point<D>) {
        let q: Point<D> = std::array::from_fn(|k| point[k] - self.centre[k]);
        (q.iter().map(|x| x * x).sum::<f64>() - self.radius * self.radius, q.map(|x| 2.0 * x))
    }

    fn ranges(
        &self,
        cell: &[rayweave_math::Interval; D],
    ) -> (rayweave_math::Interval, [rayweave_math::Interval; D]) {
        use rayweave_math::Interval;
        let q: [Interval; D] = std::array::from_fn(|k| cell[k] - Interval::point(self.centre[k]));
        let start = -Interval::point(self.radius).square();
        (q.iter().fold(start, |sum, x| sum + x.square()), q.map(|x| x * 2.0))
    }

    fn magnitude(&self) -> f64 {
        self.centre.iter().map(|x| x * x).sum::<f64>().sqrt() + self.radius
    }
}

/// A random natural spline in the plane and a disc, piece by piece against exact polynomials of degree 6.
#[test]
fn splines_against_exact_polynomials() {
    let mut rng = Random::new(5);
    let mut roots = 0;
    for round in 0..12 {
        let mut knots = vec![0.0];
        for _ in 0..24 {
            let last = knots[knots.len() - 1];
            knots.push(last + rng.between(0.01, 1.0));
        }
        let points: Vec<Point<2>> =
            knots.iter().map(|_| [rng.between(-1.0, 1.0), rng.between(-1.0, 1.0)]).collect();
        let spline = Spline::new(&knots, &points, SplineEnds::Natural).unwrap();
        let disc = Ball { centre: [0.125, -0.25], radius: 0.5 };
        let (first, last) = spline.domain();
        let got = isolate(&disc, &spline, first, last).unwrap();
        let mut want = 0;
        for (k, piece) in spline.pieces().iter().enumerate() {
            let x = |i: usize| {
                Polynomial::new(&[piece[0][i] - disc.centre[i], piece[1][i], piece[2][i], piece[3][i]])
            };
            let (x, y) = (x(0), x(1));
            let g = x.times(&x).plus(&y.times(&y)).plus(&Polynomial::new(&[-0.25]));
            want += g.count_roots(0.0, knots[k + 1] - knots[k]);
        }
        assert_eq!(got.roots().len(), want, "round {round}");
        roots += want;
    }
    assert!(roots > 100, "{roots}");
}

/// Curves that lie in a surface have no root; their side is that into which w points.
#[test]
fn curves_in_surfaces() {
    let mut rng = Random::new(6);
    for round in 0..60 {
        let frame =
            if round == 0 { Affine::IDENTITY } else { rayweave_conformance::models::motion(&mut rng) };
        let scale = if round % 3 == 0 { 1.0 } else { libm::pow(10.0, rng.between(-8.0, 8.0)) };
        let map = frame.then(&Affine::scale(Vec3::splat(scale)));
        let place = rayweave_math::Transform::from_affine(map).unwrap();
        let circle = |centre: Point<3>, a: Point<3>, b: Point<3>| Arc::new(centre, [a, b], 1.0).unwrap();
        let small = circle([0.0, 0.0, 0.6], [0.8, 0.0, 0.0], [0.0, 0.8, 0.0]);
        let wound = Helix::about([0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], 0.7).unwrap();
        let meridian = circle([2.0, 0.0, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5]);
        let top = circle([0.0, 0.0, 0.5], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]);
        let sphere = Surface::sphere(Vec3::ZERO, 1.0);
        let torus = Surface::torus(Vec3::ZERO, Vec3::Z, 2.0, 0.5);
        let ruling = Line::new([0.6, 0.8, 0.0], [0.0, 0.0, 1.0]);
        let cases: [(&str, Surface, &dyn Curve<3>); 8] = [
            ("circle of latitude", sphere.clone(), &small),
            ("circle in a plane", Surface::plane(Vec3::Z, 0.6), &small),
            ("circle in a cone", Surface::cone(Vec3::ZERO, Vec3::Z, 0.8 / 0.6), &small),
            ("helix in a cylinder", Surface::cylinder(Vec3::ZERO, Vec3::Z, 1.0), &wound),
            ("ruling of a cylinder", Surface::cylinder(Vec3::ZERO, Vec3::Z, 1.0), &ruling),
            ("meridian of a torus", torus.clone(), &meridian),
            ("top of a torus", torus, &top),
            ("small circle of a small sphere", Surface::sphere(Vec3::new(0.0, 0.0, 0.6), 0.8), &small),
        ];
        for (name, surface, curve) in cases {
            let (surface, curve) = (surface.transformed(&place), Mapped::new(curve, map));
            let (t0, t1) = (rng.between(-7.0, -1.0), rng.between(1.0, 7.0));
            let got = isolate(&surface, &curve, t0, t1).unwrap();
            let at = Vec3::from_array(curve.position(0.5 * t0 + 0.5 * t1));
            let side = perturbs_inside(&surface.value_and_gradient(at).1.to_array());
            assert_eq!((got.start().is_inside(), times(&got)), (side, vec![]), "{name}, round {round}");
        }
    }
}

/// Circles in the plane and in space-time, as in space.
#[test]
fn circles_of_other_dimensions() {
    let at = |inside: bool, want: &[f64], got: RootRay| {
        assert_eq!(got.start().is_inside(), inside, "{got}");
        assert_eq!(got.roots().len(), want.len(), "{got}");
        assert!(times(&got).iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-14), "{got}");
    };
    let flat = Arc::new([0.5, 0.0], [[1.0, 0.0], [0.0, 1.0]], 2.0).unwrap();
    // unit circles half a unit apart intersect where cos 2t = -1/4
    let half = 0.5 * libm::acos(-0.25);
    at(
        false,
        &[half, PI - half],
        isolate(&Ball { centre: [0.0, 0.0], radius: 1.0 }, &flat, 0.0, PI).unwrap(),
    );
    // the circle itself: in the middle of the window the gradient points along -x, and w along +x
    at(true, &[], isolate(&Ball { centre: [0.5, 0.0], radius: 1.0 }, &flat, 0.0, PI).unwrap());
    let a = [0.5, 0.5, 0.5, 0.5];
    let great = Arc::new([0.0; 4], [a, [0.5, -0.5, 0.5, -0.5]], 1.0).unwrap();
    at(false, &[], isolate(&Ball { centre: [0.0; 4], radius: 1.0 }, &great, -1.0, 1.0).unwrap());
    // |a cos t + b sin t - a / 2|^2 = 5/4 - cos t < 1
    let beside = Ball { centre: a.map(|x| 0.5 * x), radius: 1.0 };
    let half = libm::acos(0.25);
    at(false, &[-half, half], isolate(&beside, &great, -3.0, 3.0).unwrap());
}

/// A tangent contact is not a crossing, from either side.
#[test]
fn tangent_curves() {
    let circle = Arc::new([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 1.0).unwrap();
    let touched = [
        (Surface::plane(Vec3::X, 1.0), true),
        (Surface::sphere(Vec3::new(3.0, 0.0, 0.0), 2.0), false),
        (Surface::sphere(Vec3::new(-1.0, 0.0, 0.0), 2.0), true),
        (Surface::cylinder(Vec3::new(0.0, -1.5, 0.0), Vec3::Z, 0.5), false),
        (Surface::torus(Vec3::new(0.0, 3.0, 0.0), Vec3::Z, 1.5, 0.5), false),
    ];
    for (surface, inside) in touched {
        let got = isolate(&surface, &circle, -1.0, 6.0).unwrap();
        assert_eq!((got.start().is_inside(), times(&got)), (inside, vec![]), "{surface:?}");
    }
}

/// A curve may start or end on a surface, and return to it.
#[test]
fn windows_that_end_on_the_surface() {
    let plane = Surface::plane(Vec3::Z, 0.0);
    let throw = Parabola::new([0.0; 3], [1.0, 0.0, 4.0], [0.0, 0.0, -2.0]);
    assert_eq!(isolate(&plane, &throw, 0.0, 4.0).unwrap().to_string(), "outside []");
    assert_eq!(isolate(&plane, &throw, 0.0, 5.0).unwrap().to_string(), "outside [4]");
    assert_eq!(isolate(&plane, &throw, -1.0, 4.0).unwrap().to_string(), "inside [0]");
    let fall = Parabola::new([0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, -2.0]);
    assert_eq!(isolate(&plane, &fall, 0.0, 5.0).unwrap().to_string(), "inside []");
    assert_eq!(isolate(&plane, &fall, -5.0, 5.0).unwrap().to_string(), "inside []");
}

fn circle_with_bound(bound: impl Fn(f64, f64) -> f64) -> impl Curve<3> {
    Own {
        position: |t: f64| [libm::cos(t), libm::sin(t), 0.1 * t],
        velocity: |t: f64| [-libm::sin(t), libm::cos(t), 0.1],
        bound,
    }
}

/// Every violation of the contract of a curve is an error with its times, and never a panic.
#[test]
fn curves_that_violate_their_contract() {
    let sphere = Surface::sphere(Vec3::new(0.5, 0.5, 0.2), 0.7);
    let of = |curve: &dyn Curve<3>| isolate(&sphere, curve, 0.0, 5.0);
    assert_eq!(of(&circle_with_bound(|_, _| 1.0)).unwrap().roots().len(), 2);
    // a bound that is far too large only costs time
    let (plain, costly) =
        (times(&of(&circle_with_bound(|_, _| 1.0)).unwrap()), of(&circle_with_bound(|_, _| 1e4)));
    assert!(plain.iter().zip(times(&costly.unwrap())).all(|(a, b)| (a - b).abs() < 1e-15));
    for bad in [f64::NAN, -1.0, f64::INFINITY] {
        let error = of(&circle_with_bound(move |_, _| bad)).unwrap_err();
        assert!(matches!(error, CurveError::InvalidBound { .. }), "{error}");
    }
    for low in [0.0, 0.5, 0.9] {
        let error = of(&circle_with_bound(move |_, _| low)).unwrap_err();
        assert!(matches!(error, CurveError::BoundViolated { bound, .. } if bound == low), "{error}");
    }
    let error = of(&circle_with_bound(|_, _| 1e300)).unwrap_err();
    assert!(matches!(error, CurveError::TooMuchWork { t0: 0.0, t1: 5.0, .. }), "{error}");
    let own = |position: fn(f64) -> Point<3>, velocity: fn(f64) -> Point<3>| Own {
        position,
        velocity,
        bound: |_: f64, _: f64| 1.0,
    };
    let velocity = |t: f64| [-libm::sin(t), libm::cos(t), 0.1];
    let hole = own(|t| [libm::cos(t), if t > 2.0 { f64::NAN } else { libm::sin(t) }, 0.1 * t], velocity);
    let error = of(&hole).unwrap_err();
    assert!(matches!(error, CurveError::NotFinite { t } if t > 2.0), "{error}");
    let jump = own(|t| [libm::cos(t), libm::sin(t) + if t > 2.0 { 1.0 } else { 0.0 }, 0.1 * t], velocity);
    assert!(matches!(of(&jump), Err(CurveError::BoundViolated { .. })));
    let still = own(|t| [libm::cos(t), libm::sin(t), 0.1 * t], |_| [0.0; 3]);
    assert!(matches!(of(&still), Err(CurveError::BoundViolated { .. })));
    let endless = own(|t| [1.0 / (t - 2.5), 0.0, 0.0], |t| [-1.0 / (t - 2.5) / (t - 2.5), 0.0, 0.0]);
    assert!(of(&endless).is_err());
}

#[test]
fn windows_that_are_refused() {
    let sphere = Surface::sphere(Vec3::ZERO, 1.0);
    let line = Line::new([0.0; 3], [1.0, 0.0, 0.0]);
    for (t0, t1) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::INFINITY), (-1e308, 1e308)] {
        let error = isolate(&sphere, &line, t0, t1).unwrap_err();
        assert!(matches!(error, CurveError::Window { .. }), "{error}");
    }
    let points = [[0.0; 3], [1.0; 3]];
    let spline = Spline::new(&[0.0, 1.0], &points, SplineEnds::Natural).unwrap();
    assert!(isolate(&sphere, &spline, 0.0, 1.0).is_ok());
    let error = isolate(&sphere, &spline, 0.0, 1.5).unwrap_err();
    assert_eq!(error, CurveError::OutsideDomain { t0: 0.0, t1: 1.5, first: 0.0, last: 1.0 });
}

/// Curves that run beside a surface for long, at any distance: no crossing, and bounded work.
#[test]
fn curves_beside_surfaces() {
    let mut rng = Random::new(9);
    let cylinder = Surface::cylinder(Vec3::ZERO, Vec3::Z, 1.0);
    let torus = Surface::torus(Vec3::ZERO, Vec3::Z, 2.0, 0.5);
    for decade in [0, 2, 4, 6, 8, 9, 10, 11, 13, 15, 17] {
        let off = if rng.chance(0.5) { 0.3 } else { -0.3 } * libm::pow(10.0, -f64::from(decade));
        let map = rayweave_conformance::models::motion(&mut rng);
        let place = rayweave_math::Transform::from_affine(map).unwrap();
        let wound = Helix::about([0.0; 3], [0.0, 0.0, 1.0], [1.0 + off, 0.0, 0.0], 0.7).unwrap();
        let ruling = Line::new([0.0, 1.0 + off, 0.0], [0.0, 0.0, 1.0]);
        let r = 0.5 + off;
        let meridian = Arc::new([2.0, 0.0, 0.0], [[r, 0.0, 0.0], [0.0, 0.0, r]], 1.0).unwrap();
        let cases: [(&Surface, &dyn Curve<3>); 3] =
            [(&cylinder, &wound), (&cylinder, &ruling), (&torus, &meridian)];
        for (k, (surface, curve)) in cases.into_iter().enumerate() {
            let (surface, curve) = (surface.transformed(&place), Mapped::new(curve, map));
            let got = isolate(&surface, &curve, -3.0, 5.0).unwrap();
            assert!(times(&got).is_empty(), "{k} {off}");
            if decade < 12 {
                assert_eq!(got.start().is_inside(), off < 0.0, "{k} {off}");
            }
        }
    }
}

/// Crests at the points of subdivision, and roots between them: a wave that only appears to run
/// beside the plane.
#[test]
fn waves_with_crests_at_subdivision_points() {
    let plane = Surface::plane(Vec3::Y, 0.0);
    for (amplitude, log) in [(1.0, 5), (1e-7, 9), (1e-9, 12), (1e-11, 9), (1e-12, 12)] {
        let rate = TAU * libm::pow(2.0, f64::from(log));
        let curve = Own {
            position: move |t: f64| [t, amplitude * libm::cos(rate * t), 0.0],
            velocity: move |t: f64| [1.0, -amplitude * rate * libm::sin(rate * t), 0.0],
            bound: move |_, _| amplitude * rate * rate,
        };
        let got = isolate(&plane, &curve, 0.0, 1.0).unwrap();
        assert_eq!(got.roots().len(), 2 << log, "{amplitude} {log}");
    }
}
