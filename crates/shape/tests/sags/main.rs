//! Sag surfaces against exact arithmetic (Sturm's theorem along the ray), against quadrics, and against signs at points.

mod heights;
#[path = "../oracle/mod.rs"]
mod oracle;
mod steep;

use dashu::rational::RBig;
use oracle::{approximate, count_between, effort, exact, rng, unit_vector};
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use rayweave_math::{Affine, Mat3, Transform, UNIT_ROUNDOFF, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::surface::object::Object;
use rayweave_shape::surface::sag::{Base, Description, Sag, SagError, Zernike, zernike_terms};
use rayweave_shape::surface::{Perturbation, Surface};
use std::sync::Arc;

const FLAT: Base = Base::Conic { curvature: 0.0, conic: 0.0 };

fn conic(aperture: f64, curvature: f64, conic: f64) -> Description {
    Description::new(aperture, Base::Conic { curvature, conic })
}

fn surface(of: &Description) -> Surface {
    Surface::Object(Box::new(Object::new(Arc::new(Sag::new(of).unwrap()))))
}

fn all(surface: &Surface, ray: &Ray) -> (bool, Vec<f64>) {
    let mut times = Vec::new();
    let starts = surface.all_crossings(ray, |t| times.push(t));
    assert!(times.windows(2).all(|pair| pair[0] < pair[1]), "{times:?}");
    (starts, times)
}

/// Ripples of order 20 with coefficients of alternating sign: Chebyshev's T_10 of 2 r^2 / R^2 - 1, times a depth.
fn ripples(aperture: f64, depth: f64) -> Description {
    let chebyshev = [
        1.0, -200.0, 6600.0, -84480.0, 549120.0, -2050048.0, 4659200.0, -6553600.0, 5570560.0, -2621440.0,
        524288.0,
    ];
    let even = (1..=10).map(|k| depth * chebyshev[k] / aperture.powi(2 * k as i32)).collect();
    Description { even, ..Description::new(aperture, FLAT) }
}

/// Polynomials without a base, including difficult ones, with apertures of any size.
fn polynomials(scale: f64, rng: &mut ChaCha8Rng) -> Vec<Description> {
    let mut number = |half: f64| rng.random_range(-half..half);
    let even = (1..=4).map(|k| number(0.3) / scale.powi(2 * k - 1)).collect();
    let mixed = (0u32..6).flat_map(|i| (0..6 - i).map(move |j| (i, j)));
    let mixed = mixed.map(|(i, j)| (i, j, number(0.2) / scale.powi((i + j) as i32 - 1))).collect();
    let waves: Vec<f64> = (0..37).map(|_| number(0.05) * scale).collect();
    vec![
        ripples(scale, 0.01 * scale),
        ripples(scale, scale),
        Description { even, ..Description::new(scale, FLAT) },
        Description { mixed, ..Description::new(scale, FLAT) },
        Description { mixed: zernike_terms(Zernike::Fringe, &waves, scale), ..Description::new(scale, FLAT) },
        Description { mixed: vec![(1, 1, 1.0 / scale)], ..Description::new(scale, FLAT) },
        Description {
            mixed: vec![(3, 0, 1.0 / (scale * scale)), (1, 2, -3.0 / (scale * scale))],
            ..Description::new(scale, FLAT)
        },
    ]
}

/// Rounds to few digits, to keep exact arithmetic fast.
fn rounded(x: f64) -> f64 {
    f64::from(x as f32)
}

fn short(mut of: Description) -> Description {
    // coefficients of high powers exceed the range of f32: all but 24 bits are dropped
    let few = |x: &mut f64| *x = f64::from_bits(x.to_bits() & !0x1fff_ffff);
    of.even.iter_mut().for_each(few);
    of.mixed.iter_mut().for_each(|term| few(&mut term.2));
    of
}

/// The exact polynomial in t of z - sag along the ray, without a base.
fn along(of: &Description, ray: &Ray, raise: f64) -> Vec<RBig> {
    let linear = |k: usize| vec![exact(ray.origin[k]), exact(ray.direction[k])];
    let (x, y) = (linear(0), linear(1));
    let square = plus(&times(&x, &x), &times(&y, &y));
    let minus = |sum: &[RBig], c: f64, by: &[RBig]| plus(sum, &times(&[exact(-c)], by));
    let mut sum = plus(&linear(2), &[exact(raise)]);
    let mut power = square.clone();
    for &c in &of.even {
        sum = minus(&sum, c, &power);
        power = times(&power, &square);
    }
    for &(i, j, c) in &of.mixed {
        let powers = (0..i).map(|_| &x).chain((0..j).map(|_| &y));
        sum = minus(&sum, c, &powers.fold(vec![exact(1.0)], |product, by| times(&product, by)));
    }
    sum
}

fn plus(a: &[RBig], b: &[RBig]) -> Vec<RBig> {
    let at = |v: &[RBig], k: usize| v.get(k).cloned().unwrap_or(RBig::ZERO);
    (0..a.len().max(b.len())).map(|k| at(a, k) + at(b, k)).collect()
}

fn times(a: &[RBig], b: &[RBig]) -> Vec<RBig> {
    let mut product = vec![RBig::ZERO; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] += x * y;
        }
    }
    product
}

fn value(p: &[RBig], t: f64) -> f64 {
    approximate(&oracle::value(p, &exact(t)))
}

/// The interval of the ray in the aperture, slightly shortened at both ends.
fn inside(of: &Description, ray: &Ray) -> Option<(f64, f64)> {
    let (o, d) = (ray.origin.truncate(), ray.direction.truncate());
    let closest = -o.dot(d) / d.length_squared();
    let half = (of.aperture * of.aperture - (o + closest * d).length_squared()).sqrt() / d.length();
    let half = half * (1.0 - 1e-7);
    (half.is_finite() && half > 0.0).then_some((closest - half, closest + half))
}

/// Rays through the neighbourhood of the aperture: in general direction, nearly level, nearly along z, from afar.
fn ray(scale: f64, round: usize, rng: &mut ChaCha8Rng) -> Ray {
    let mut number = |half: f64| scale * rng.random_range(-half..half);
    let through = Vec3::new(number(0.8), number(0.8), number(0.3));
    let mut direction = unit_vector(rng);
    match round % 5 {
        0 => direction.z *= 1e-2,
        1 => direction.z *= 1e-6,
        2 => direction = Vec3::new(1e-7 * direction.x, 1e-7 * direction.y, 1.0),
        3 => direction.z = 0.0,
        _ => {}
    }
    let away = scale * if round.is_multiple_of(3) { 1e6 } else { 3.0 };
    Ray::new(through - away * direction, direction * rng.random_range(0.3..4.0))
}

/// The number of crossings in the aperture is that of Sturm's theorem, if that is the same for the surface raised and
/// lowered by delta; and each time is that of an exact sign change within delta.
#[test]
fn polynomials_have_the_number_of_crossings_of_sturms_theorem() {
    let mut rng = rng(1);
    let (mut clear, mut many, mut unclear) = (0, 0, 0);
    for round in 0..10 * effort() {
        let scale = [1.0, 1.0 / 1024.0, 1024.0][round % 3];
        for of in polynomials(scale, &mut rng).into_iter().map(short) {
            let Ray { origin, direction } = ray(scale, round, &mut rng);
            let ray = Ray::new(origin.map(rounded), direction.map(rounded));
            let surface = surface(&of);
            let Some((from, to)) = inside(&of, &ray) else { continue };
            let lengths =
                ray.origin.length() + to.abs().max(from.abs()) * ray.direction.length() + surface.magnitude();
            let delta = 64.0 * UNIT_ROUNDOFF * lengths;
            let steep = ray.direction.truncate().length() / ray.direction.length();
            let exact = |raise: f64| along(&of, &ray, raise);
            let (low, middle, high) = (exact(-4.0 * delta), exact(0.0), exact(4.0 * delta));
            let count = |p: &[RBig]| count_between(p, from, to);
            let (_, times) = all(&surface, &ray);
            let found: Vec<f64> = times.into_iter().filter(|t| (from..=to).contains(t)).collect();
            for &t in &found {
                let (_, gradient) = surface.value_and_gradient(ray.at(t));
                let off = value(&middle, t).abs() / gradient.length();
                assert!(off <= delta, "{off} {delta} {of:?} {ray:?}");
            }
            if count(&low) != count(&middle) || count(&high) != count(&middle) || steep < 1e-12 {
                unclear += 1;
                continue;
            }
            assert_eq!(found.len(), count(&middle), "{of:?} {ray:?} {found:?}");
            clear += 1;
            many += usize::from(found.len() > 4);
        }
    }
    assert!(
        clear > 40 && many > 1 && unclear < clear / 4,
        "{clear} clear, {many} of many, {unclear} unclear"
    );
}

/// Bases of all kinds, with and without terms.
fn mixtures(scale: f64) -> Vec<Description> {
    let even =
        |list: &[f64]| list.iter().zip(1..).map(|(c, n)| c / scale.powi(2 * n - 1)).collect::<Vec<f64>>();
    let odd = |list: &[f64]| list.iter().zip(0..).map(|(c, n)| c / scale.powi(2 * n)).collect::<Vec<f64>>();
    let base = |c: f64, k: f64| conic(scale, c / scale, k);
    let biconic = |c: [f64; 2], conics: [f64; 2]| {
        Description::new(scale, Base::Biconic { curvatures: c.map(|c| c / scale), conics })
    };
    let mixed =
        vec![(2, 1, 0.2 / (scale * scale)), (0, 4, -0.1 / scale.powi(3)), (5, 3, 0.3 / scale.powi(7))];
    vec![
        base(0.5, 0.0),
        base(1.0, 0.0),
        base(-0.9, -1.0),
        base(2.0, -2.5),
        base(0.3, 3.0),
        Description { even: even(&[0.0, 0.05, -0.02, 0.01]), ..base(0.6, -0.7) },
        Description { even: even(&[0.1, -1.0, 2.0, -1.0]), ..base(-0.99, 0.0) },
        Description { odd: odd(&[0.2]), ..base(0.0, 0.0) },
        Description { odd: odd(&[-0.1, 0.3, -0.2]), even: even(&[0.0, 0.2]), ..base(0.4, 0.0) },
        biconic([0.5, -0.3], [0.0, -1.0]),
        biconic([0.0, 0.9], [0.0, 0.0]),
        Description { mixed: mixed.clone(), ..biconic([0.9, 0.2], [0.2, 5.0]) },
        Description { mixed, ..base(0.5, -1.0) },
    ]
}

fn is_round(of: &Description) -> bool {
    matches!(of.base, Base::Conic { .. }) && of.mixed.is_empty()
}

/// z - sag by the textbook formula, with the sag of the rim beyond the aperture.
fn depth(of: &Description, p: Vec3) -> f64 {
    let r = libm::hypot(p.x, p.y);
    let by = if r > of.aperture { of.aperture / r } else { 1.0 };
    let (x, y, r) = (by * p.x, by * p.y, by * r);
    let base = match of.base {
        Base::Conic { curvature: c, conic: k } => {
            let inner: f64 = 1.0 - (1.0 + k) * c * c * r * r;
            c * r * r / (1.0 + inner.max(0.0).sqrt())
        }
        Base::Biconic { curvatures: [cx, cy], conics: [kx, ky] } => {
            let inner: f64 = 1.0 - (1.0 + kx) * cx * cx * x * x - (1.0 + ky) * cy * cy * y * y;
            (cx * x * x + cy * y * y) / (1.0 + inner.max(0.0).sqrt())
        }
    };
    let power = |v: f64, n: u32| libm::pow(v, f64::from(n));
    let even: f64 = of.even.iter().zip(1..).map(|(c, n)| c * power(r, 2 * n)).sum();
    let odd: f64 = of.odd.iter().zip(0..).map(|(c, n)| c * power(r, 2 * n + 1)).sum();
    let mixed: f64 = of.mixed.iter().map(|&(i, j, c)| c * power(x, i) * power(y, j)).sum();
    p.z - (base + even + odd + mixed)
}

/// Along each ray the side between crossings agrees with the textbook formula at many points, in the aperture and beyond;
/// and crossings lie on the surface.
#[test]
fn sides_along_rays_are_those_of_the_textbook_formula() {
    let mut rng = rng(2);
    for round in 0..75 * effort() {
        let scale = [1.0, 1e-3, 1e3][round % 3];
        for of in mixtures(scale).into_iter().chain([ripples(scale, 0.05 * scale)]) {
            let (surface, ray) = (surface(&of), ray(scale, round, &mut rng));
            let (starts, times) = all(&surface, &ray);
            // at a vertical rim a rounding of r becomes its square root in z
            let rim = if of == conic(scale, 1.0 / scale, 0.0) { 1e-6 * scale } else { 0.0 };
            let tolerance = |t: f64| {
                1e-12 * (ray.origin.length() + t.abs() * ray.direction.length() + surface.magnitude())
            };
            for &t in &times {
                let (_, gradient) = surface.value_and_gradient(ray.at(t));
                let off = depth(&of, ray.at(t)).abs() / gradient.length();
                assert!(off <= tolerance(t) + rim, "{off} at {t} {of:?} {ray:?}");
            }
            let middle = ray.closest_time(Vec3::ZERO);
            for k in -60..=60 {
                let t = middle + 0.04 * f64::from(k) * scale / ray.direction.length();
                let (value, gradient) = surface.value_and_gradient(ray.at(t));
                let expected = depth(&of, ray.at(t));
                let slack = tolerance(t) * gradient.length() + rim;
                assert!((value - expected).abs() <= slack, "{value} {expected} {of:?}");
                // beyond the aperture only surfaces of revolution are guaranteed
                if !is_round(&of) && ray.at(t).truncate().length() > 0.999 * scale {
                    continue;
                }
                let negative = starts ^ (times.iter().filter(|&&root| root <= t).count() % 2 == 1);
                assert!(
                    expected.abs() <= slack || negative == (expected < 0.0),
                    "{t} {times:?} {of:?} {ray:?}"
                );
            }
        }
    }
}

/// A conic as a sag has the crossings of the quadric, within the aperture and on the sheet of the vertex.
#[test]
fn conics_are_quadrics() {
    let mut rng = rng(3);
    let mut seen = 0;
    for round in 0..2000 * effort() {
        let scale = [1.0, 1e-3, 1e3][round % 3];
        let (c, k) = (rng.random_range(-0.9..0.9) / scale, [0.0, -1.0, -3.0, 0.2][round % 4]);
        let sag = surface(&conic(scale, c, k));
        // c (x^2 + y^2 + (1 + k) z^2) = 2 z
        let form = Mat3::from_diagonal(c * Vec3::new(1.0, 1.0, 1.0 + k));
        let quadric = Surface::quadric_about(Vec3::ZERO, form, Vec3::new(0.0, 0.0, -2.0), 0.0);
        let ray = ray(scale, round, &mut rng);
        let inside = |t: &f64| {
            let p = ray.at(*t);
            p.truncate().length() < scale && 1.0 - c * (1.0 + k) * p.z > 0.0
        };
        let found: Vec<f64> = all(&sag, &ray).1.into_iter().filter(inside).collect();
        let expected: Vec<f64> = quadric.crossings(&ray).times().iter().copied().filter(inside).collect();
        let near_rim = |t: &f64| (ray.at(*t).truncate().length() - scale).abs() < 1e-9 * scale;
        if found.iter().chain(&expected).any(near_rim) {
            continue;
        }
        assert_eq!(found.len(), expected.len(), "{c} {k} {ray:?} {found:?} {expected:?}");
        for (a, b) in found.iter().zip(&expected) {
            let (_, gradient) = sag.value_and_gradient(ray.at(*a));
            let lengths = ray.origin.length() + a.abs() * ray.direction.length() + 3.0 * scale;
            let off = (a - b).abs() * gradient.dot(ray.direction).abs() / gradient.length();
            assert!(off <= 64.0 * UNIT_ROUNDOFF * lengths, "{off} {c} {k} {ray:?}");
        }
        seen += found.len();
    }
    assert!(seen > 500, "{seen}");
}

/// A ray that starts on the surface has the crossings of the whole line, without its start.
#[test]
fn rays_from_the_surface_meet_it_where_the_line_does() {
    let mut rng = rng(4);
    let (mut alone, mut again) = (0, 0);
    for round in 0..60 * effort() {
        let scale = [1.0, 1e-3, 1e3][round % 3];
        for of in mixtures(scale).into_iter().chain([ripples(scale, 0.05 * scale)]) {
            let surface = surface(&of);
            let spot = 0.95 * scale * rng.random_range(-0.7..0.7) * unit_vector(&mut rng);
            let foot = Vec3::new(spot.x, spot.y, spot.z - depth(&of, spot));
            let (_, gradient) = surface.value_and_gradient(foot);
            let mut direction = unit_vector(&mut rng);
            let along = direction - direction.dot(gradient) / gradient.length_squared() * gradient;
            let tilt = [1.0, 1e-2, 1e-4][round % 3];
            direction = along.normalize() + tilt * direction;
            let ray = Ray::new(foot, direction);
            let slope = gradient.dot(direction);
            let mut ahead = Vec::new();
            surface.all_crossings_from(&ray, slope < 0.0, &Perturbation::WORLD, |t| ahead.push(t));
            let mut from_the_wrong_side = Vec::new();
            surface
                .all_crossings_from(&ray, slope > 0.0, &Perturbation::WORLD, |t| from_the_wrong_side.push(t));
            assert_eq!(from_the_wrong_side.first(), Some(&0.0), "{of:?} {ray:?}");
            assert_eq!(from_the_wrong_side[1..], ahead);
            // the crossings of the whole line, except the root at the start
            let near = 1e-12 * (1e3 * scale + surface.magnitude()) / tilt;
            let line: Vec<f64> = all(&surface, &ray).1.into_iter().filter(|&t| t > near).collect();
            let close = ahead.iter().filter(|&&t| t <= near).count();
            assert!(ahead.iter().all(|&t| t > 0.0));
            if close > 0 {
                continue;
            }
            assert_eq!(ahead.len(), line.len(), "{of:?} {ray:?} {ahead:?} {line:?}");
            for (a, b) in ahead.iter().zip(&line) {
                let (_, there) = surface.value_and_gradient(ray.at(*a));
                let off = (a - b).abs() * there.dot(direction).abs() / there.length();
                assert!(
                    off <= 128.0 * UNIT_ROUNDOFF * (4.0 * scale + surface.magnitude()),
                    "{off} {of:?} {ray:?}"
                );
            }
            if line.is_empty() { alone += 1 } else { again += 1 }
        }
    }
    assert!(alone > 100 && again > 100, "{alone} {again}");
}

/// For a sag that is placed, scaled and rotated, the times are those of the ray in the frame of the sag.
#[test]
fn placed_sags_are_evaluated_in_their_own_frame() {
    let mut rng = rng(5);
    let map = Affine::scale(Vec3::new(1.0, 2.0, 0.5))
        .then(&Affine::rotation(Vec3::new(1.0, 2.0, 3.0), 50.0))
        .then(&Affine::translate(Vec3::new(5.0, -3.0, 1.0)));
    let place = Transform::from_affine(map).unwrap();
    for (k, of) in mixtures(1.0).iter().enumerate() {
        let own = surface(of);
        let there = own.transformed(&place);
        for round in 0..40 {
            let here = ray(1.0, 5 * round + 4 - 2 * (k % 2), &mut rng);
            let carried = here.transformed(&map);
            let ((a, first), (b, second)) = (all(&own, &here), all(&there, &carried));
            assert_eq!((a, first.len()), (b, second.len()), "{of:?} {here:?}");
            for (s, t) in first.iter().zip(&second) {
                let (_, gradient) = own.value_and_gradient(here.at(*s));
                let off = (s - t).abs() * gradient.dot(here.direction).abs() / gradient.length();
                assert!(off <= 1e-13 * (here.origin.length() + 20.0), "{of:?} {here:?} {s} {t}");
            }
            let inside = there.inside_bounds().grown(1e-12);
            let below = carried.at(first.first().map_or(0.0, |t| t + 0.1));
            assert!(there.value_and_gradient(below).0 >= 0.0 || inside.contains(below));
        }
    }
}

#[test]
fn invalid_descriptions_are_rejected() {
    let message = |of: &Description| Sag::new(of).unwrap_err().to_string();
    assert_eq!(
        message(&conic(2.0, 0.8, 0.0)),
        "the aperture's radius is 2: the conic ends at 1.25, where its square root becomes imaginary. Is the curvature too large?"
    );
    assert!(Sag::new(&conic(1.25, 0.8, 0.0)).is_ok());
    assert!(Sag::new(&conic(2.0, 0.8, -1.0)).is_ok());
    for bad in [
        conic(0.0, 0.1, 0.0),
        conic(-1.0, 0.1, 0.0),
        conic(f64::INFINITY, 0.0, 0.0),
        conic(1.0, f64::NAN, 0.0),
    ] {
        assert!(matches!(Sag::new(&bad), Err(SagError::NotFinite { .. })), "{bad:?}");
    }
    let nan = Description { even: vec![0.0, f64::NAN], ..conic(1.0, 0.1, 0.0) };
    assert!(matches!(Sag::new(&nan), Err(SagError::NotFinite { .. })));
    let huge = Description { even: vec![0.0, 1e300], ..conic(1e30, 0.0, 0.0) };
    assert!(matches!(Sag::new(&huge), Err(SagError::NotFinite { .. })));
    let high = Description { mixed: vec![(20, 11, 1.0)], ..conic(1.0, 0.0, 0.0) };
    assert_eq!(Sag::new(&high), Err(SagError::TooManyTerms { degree: 31 }));
}

/// A ray that touches a surface has no crossing, or two within the square root of the noise of the point of contact; it never has
/// one far from the surface.
#[test]
fn touching_rays_have_no_crossing_off_the_surface() {
    let paraboloid = conic(4.0, 2.0, -1.0);
    let biconic = Description::new(4.0, Base::Biconic { curvatures: [2.0, 2.0], conics: [-1.0, -1.0] });
    let terms = Description { mixed: vec![(2, 0, 1.0), (0, 2, 1.0)], ..Description::new(4.0, FLAT) };
    let below = Description { even: vec![1.0], ..Description::new(4.0, FLAT) };
    let mut rng = rng(77);
    for of in [paraboloid, biconic, terms, below] {
        let surface = surface(&of);
        for round in 0..400 * effort() {
            // numbers of few bits: z = x^2 + y^2 exactly, and the ray is exactly in the tangent plane
            let mut dyadic = |bits: f64| rng.random_range(-16i32..=16) as f64 / bits;
            let (x, y, dx, dy) = (dyadic(8.0), dyadic(8.0), dyadic(4.0), dyadic(4.0));
            if (dx, dy) == (0.0, 0.0) {
                continue;
            }
            let (touch, d) = (Vec3::new(x, y, x * x + y * y), Vec3::new(dx, dy, 2.0 * (x * dx + y * dy)));
            let back = dyadic(4.0);
            let d = if round % 3 == 0 { d.normalize() } else { d };
            let ray = Ray::new(touch - back * d, d);
            for t in all(&surface, &ray).1 {
                let p = ray.origin + t * ray.direction;
                let off = (p.z - (p.x * p.x + p.y * p.y)).abs();
                assert!(p.truncate().length() > 3.99 || off < 1e-12, "{ray:?}: {off:e} at {t}");
            }
        }
    }
}

/// Rays through points of the surface with few bits, so that f is exactly 0 where the search divides the ray: the side between
/// the crossings is that of exact arithmetic.
#[test]
fn roots_at_dyadic_times_hide_no_other_root() {
    let few = |mixed| Description { mixed, ..Description::new(4.0, FLAT) };
    let list = [
        few(vec![(3, 0, 1.0)]),
        few(vec![(1, 1, 1.0 / 16.0)]),
        few(vec![(2, 1, 0.25), (0, 2, -0.5)]),
        Description { even: vec![-1.0, 0.25], ..Description::new(2.0, FLAT) },
    ];
    let (mut rng, mut tested) = (rng(78), 0);
    for (of, _) in list.iter().flat_map(|of| (0..3000 * effort()).map(move |round| (of, round))) {
        let mut dyadic = |bits: f64| rng.random_range(-8i32..=8) as f64 / bits;
        let (x, y, d) = (dyadic(4.0), dyadic(4.0), Vec3::new(dyadic(2.0), dyadic(2.0), dyadic(4.0)));
        let back = dyadic(4.0);
        let ray = Ray::new(Vec3::new(x, y, 0.0), d);
        // raised so that f is 0 at time 0
        let raised = -value(&along(of, &ray, 0.0), 0.0);
        let ray = Ray::new(ray.origin + Vec3::new(0.0, 0.0, raised) - back * d, d);
        let Some((from, to)) = (d.truncate().length() > 0.0).then(|| inside(of, &ray)).flatten() else {
            continue;
        };
        let (exactly, (starts, times)) = (along(of, &ray, 0.0), all(&surface(of), &ray));
        for k in 0..16 {
            let t = from + (to - from) * (k as f64 + 0.37) / 16.0;
            let exact = value(&exactly, t);
            let inside = starts ^ (times.iter().filter(|&&root| root < t).count() % 2 == 1);
            if exact.abs() > 1e-12 {
                tested += 1;
                assert_eq!(inside, exact < 0.0, "{of:?} {ray:?} at {t}: {exact:e}, {times:?}");
            }
        }
    }
    assert!(tested > 30_000, "{tested}");
}

/// The cone z > r, with the ray on it at the time 0: `r^2 - z^2 = 16 t^2 + 5.5 t`.
#[test]
fn a_chord_of_a_cone_that_ends_at_time_0() {
    let cone = Description { odd: vec![1.0], ..Description::new(4.0, FLAT) };
    let ray = Ray::new(Vec3::new(-1.0, 0.75, 1.25), Vec3::new(-1.0, 4.0, 1.0));
    let times = all(&surface(&cone), &ray).1;
    assert!(times.len() == 3 && times[0] == -0.34375 && times[1].abs() < 1e-15, "{times:?}");
}
