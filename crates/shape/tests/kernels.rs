//! Every kernel against exact rational arithmetic: positions, numbers and sides of the crossings.

mod oracle;

use oracle::*;
use rand::RngExt;
use rand::rngs::ChaCha8Rng;
use rayweave_math::{Affine, Mat3, Transform, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::surface::Surface;

type Make = fn(Vec3, f64, &mut ChaCha8Rng) -> Surface;

/// Makers of surfaces with a given position and size.
const MAKERS: [(&str, Make); 10] = [
    ("plane", |p, _, rng| {
        let n = unit_vector(rng);
        Surface::plane(n, n.dot(p))
    }),
    ("sphere", |p, size, _| Surface::sphere(p, size)),
    ("cylinder", |p, size, rng| Surface::cylinder(p, unit_vector(rng), size)),
    ("cone", |p, _, rng| Surface::cone(p, unit_vector(rng), oracle::size(rng, 1e-2, 1e2))),
    ("ellipsoid", |p, size, rng| {
        let radii = Vec3::ZERO.map(|_| oracle::size(rng, 1e-3, 1.0));
        stretched(Surface::sphere(Vec3::ZERO, size), radii, p, rng)
    }),
    ("elliptic cylinder", |p, size, rng| {
        let radii = Vec3::ZERO.map(|_| oracle::size(rng, 1e-2, 1.0));
        stretched(Surface::cylinder(Vec3::ZERO, Vec3::Z, size), radii, p, rng)
    }),
    ("paraboloid", |p, size, rng| {
        let bowl = Mat3::from_diagonal(Vec3::new(1.0, oracle::size(rng, 1e-2, 1.0), 0.0));
        let bowl = Surface::quadric_about(Vec3::ZERO, bowl, Vec3::new(0.0, 0.0, -size), 0.0);
        placed(bowl, p, rng)
    }),
    ("hyperboloid", |p, size, rng| {
        let form = Mat3::from_diagonal(Vec3::new(1.0, 0.5, -oracle::size(rng, 1e-2, 1.0)));
        let sheets = if rng.random() { 1.0 } else { -1.0 };
        let form = Surface::quadric_about(Vec3::ZERO, form, Vec3::ZERO, sheets * size * size);
        placed(form, p, rng)
    }),
    ("torus", |p, size, rng| Surface::torus(p, unit_vector(rng), size, size * oracle::size(rng, 1e-4, 0.99))),
    ("affine torus", |p, size, rng| {
        let radii = Vec3::ZERO.map(|_| oracle::size(rng, 1e-1, 1.0));
        let ring = Surface::torus(Vec3::ZERO, unit_vector(rng), size, 0.3 * size);
        stretched(ring, radii, p, rng)
    }),
];

fn placed(surface: Surface, at: Vec3, rng: &mut ChaCha8Rng) -> Surface {
    stretched(surface, Vec3::ONE, at, rng)
}

fn stretched(surface: Surface, by: Vec3, at: Vec3, rng: &mut ChaCha8Rng) -> Surface {
    let map = Affine::scale(by)
        .then(&Affine::rotation(unit_vector(rng), rng.random_range(0.0..360.0)))
        .then(&Affine::translate(at));
    surface.transformed(&Transform::from_affine(map).unwrap())
}

/// A random point on the surface: by the tube of a torus, which may be thin; otherwise by a ray.
fn some_point_on(surface: &Surface, around: Vec3, size: f64, rng: &mut ChaCha8Rng) -> Vec3 {
    let way = unit_vector(rng);
    if let Surface::Torus(s) = surface {
        let outwards = s.axis.cross(way);
        let circle = s.centre + s.major / outwards.length() * outwards;
        return circle + s.minor * unit_vector(rng);
    }
    let ray = Ray::new(around + 0.3 * size * unit_vector(rng), way);
    let times = surface.crossings(&ray);
    times.times().first().map_or(around, |&t| ray.at(t.clamp(-10.0 * size, 10.0 * size)))
}

fn scenes(maker: Make, count: usize, seed: u64, mut check: impl FnMut(&Surface, Ray, &mut ChaCha8Rng)) {
    let mut rng = rng(seed);
    for _ in 0..count * effort() {
        let scale = size(&mut rng, 1e-8, 1e8);
        let away = scale * size(&mut rng, 1e-1, 1e2);
        let place = if rng.random() { away * unit_vector(&mut rng) } else { Vec3::ZERO };
        let surface = maker(place, scale, &mut rng);
        let target = some_point_on(&surface, place, scale, &mut rng);
        let thickness = match &surface {
            Surface::Torus(s) => s.minor,
            _ => scale,
        };
        let target = target + thickness * size(&mut rng, 1e-9, 1.0) * unit_vector(&mut rng);
        let ray = ray_through(target, scale, &mut rng);
        check(&surface, ray, &mut rng);
    }
}

/// Constant of the error bound: a crossing lies within `C u (|o| + |t| |d| + magnitude)` of the surface. `delta` has C = 64.
///
/// The derivation gives C = 16: about 3 for the point relative to the centre, 3 sqrt(3) for its coordinates in the frame of
/// the surface, 8 for coefficients and root. The observed value is below 3.
const C: f64 = 16.0;

#[test]
fn crossings_lie_on_the_surface() {
    for (name, maker) in MAKERS {
        let mut found = 0;
        scenes(maker, 1500, 11, |surface, ray, _| {
            for &t in surface.crossings(&ray).times() {
                let error = distance(surface, &ray, t) / rounding(surface, &ray, t);
                found += 1;
                assert!(error <= C, "{name}: {error} at t = {t:e}\n{surface:?}\n{ray:?}");
            }
        });
        assert!(found > 700, "{name}: only {found} crossings");
    }
}

/// The number of crossings and the sides between them are exact, except near tangency.
#[test]
fn sides_and_numbers_are_exact_off_tangency() {
    for (name, maker) in MAKERS {
        let (mut decided, mut all) = (0, 0);
        scenes(maker, 400, 12, |surface, ray, _| {
            let got = surface.crossings(&ray);
            all += 1;
            let Some(count) = clear_count(surface, &ray) else {
                return;
            };
            decided += 1;
            assert_eq!(got.times().len(), count, "{name}\n{surface:?}\n{ray:?}\n{got:?}");
            let probes = between(got.times());
            for (k, t) in probes.into_iter().enumerate() {
                let value = polynomial(surface, 0.0, &at(&ray, &exact(t)));
                let near = distance(surface, &ray, t) < 64.0 * rounding(surface, &ray, t);
                let negative = got.starts_negative() ^ (k % 2 == 1);
                assert!(
                    near || (sign(&value) < 0) == negative,
                    "{name}: side at {t:e}\n{surface:?}\n{ray:?}\n{got:?}"
                );
            }
        });
        assert!(decided > all / 2, "{name}: {decided} of {all} rays decided");
    }
}

/// The exact number of roots, if it is the same for the surface grown and shrunk by delta.
fn clear_count(surface: &Surface, ray: &Ray) -> Option<usize> {
    let centre = ray.closest_time(surface.anchor());
    let delta = 64.0 * rounding(surface, ray, centre);
    let count = |grow: f64| {
        let polynomial = coefficients(surface, grow, ray, usize::from(surface.degree()));
        count_real_roots(&polynomial)
    };
    let middle = count(0.0);
    match surface {
        Surface::Plane(_) | Surface::Sphere(_) | Surface::Cylinder(_) | Surface::Torus(_) => {
            (count(delta) == middle && count(-delta) == middle).then_some(middle)
        }
        Surface::AffineTorus(s) => {
            let grow = delta * Affine::from_linear(s.local_from_world).linear_norm();
            (count(grow) == middle && count(-grow) == middle).then_some(middle)
        }
        Surface::Cone(_) | Surface::Quadric(_) => {
            let c = coefficients(surface, 0.0, ray, 2);
            let t = approximate(&(-c[1].clone() / (exact(2.0) * &c[2])));
            let clear = distance(surface, ray, t) > 64.0 * rounding(surface, ray, t);
            clear.then_some(middle)
        }
        Surface::Object(_) => None,
    }
}

/// Times before, between and after the given ones.
fn between(times: &[f64]) -> Vec<f64> {
    let Some((&first, &last)) = times.first().zip(times.last()) else {
        return vec![0.0];
    };
    let margin = (last - first).max(1e-3 * first.abs()).max(1e-300);
    let mut probes = vec![first - margin];
    probes.extend(times.windows(2).map(|w| 0.5 * w[0] + 0.5 * w[1]));
    probes.push(last + margin);
    probes
}

/// Rays at a distance of 1 to 32 ulp, and up to some hundred ulp, from tangency.
#[test]
fn near_tangent_rays_are_decided_as_far_as_delta() {
    // only rays in a plane are tangent to it
    for (name, maker) in MAKERS.into_iter().skip(1) {
        let (mut decided, mut all) = (0, 0);
        scenes(maker, 500, 13, |surface, ray, rng| {
            let Some(ray) = tangent(surface, &ray, rng) else {
                return;
            };
            all += 1;
            let got = surface.crossings(&ray);
            for &t in got.times() {
                let error = distance(surface, &ray, t) / rounding(surface, &ray, t);
                assert!(error <= C, "{name}: {error} at t = {t:e}\n{surface:?}\n{ray:?}");
            }
            if let Some(count) = clear_count(surface, &ray) {
                decided += 1;
                assert_eq!(got.times().len(), count, "{name}\n{surface:?}\n{ray:?}\n{got:?}");
            }
        });
        assert!(all > 100 && decided > all / 8 && decided < all, "{name}: {decided} of {all}");
    }
}

/// A ray nearly tangent to the surface at a crossing of the given ray.
fn tangent(surface: &Surface, ray: &Ray, rng: &mut ChaCha8Rng) -> Option<Ray> {
    let &t = surface.crossings(ray).times().first()?;
    let foot = ray.at(t);
    let normal = surface.value_and_gradient(foot).1;
    let normal = normal / normal.length();
    let way = normal.cross(unit_vector(rng));
    let step = if rng.random() {
        f64::from(rng.random_range(-32i32..=32))
    } else {
        size(rng, 32.0, 1e5) * if rng.random() { 1.0 } else { -1.0 }
    };
    let start = size(rng, 1e-2, 1e1) * (foot - surface.anchor()).length() / way.length();
    let origin = foot - start * way;
    let planted = Ray::new(origin, way * size(rng, 1e-2, 1e2));
    let off = step * rounding(surface, &planted, planted.closest_time(foot));
    Some(Ray::new(origin + off * normal, planted.direction))
}

/// Lines that are nearly inflectional tangents, found by the property test below: g is 0 or noise at the inflection, and the
/// other crossings of the contact are 3e-3 away. The expected times are roots of the exact quartic.
#[test]
fn both_crossings_beside_an_inflectional_tangent_are_found() {
    let cases = [
        (
            [2.5, 1.5],
            [-1.6958730583607358, -2.2358230955051694, 1.9818146278856403],
            [0.7921770404185092, 0.40040498702422483, -0.4605772280529095],
            4,
        ),
        (
            [3.38310263062759, 1.7296651586367482],
            [1.3546308651913344, 1.420200917062075, 1.0814752401975762],
            [-0.686157381025385, 0.13395022668698817, -0.7150142552676059],
            2,
        ),
    ];
    for ([major, minor], origin, direction, count) in cases {
        let surface = Surface::torus(Vec3::ZERO, Vec3::Z, major, minor);
        let ray = Ray::new(Vec3::from_array(origin), Vec3::from_array(direction));
        let (got, expected) = (surface.crossings(&ray), real_roots(&surface, &ray));
        assert_eq!([got.times().len(), expected.len()], [count, count], "{got:?}, not {expected:?}");
        for (&got, &expected) in got.times().iter().zip(&expected) {
            // a root moves by noise / slope, here 1e-16 / 1e-7
            assert!((got - expected).abs() < 1e-8, "{got}, not {expected}");
        }
    }
}

/// Real roots along a ray at times up to 64, by Sturm's theorem.
fn real_roots(surface: &Surface, ray: &Ray) -> Vec<f64> {
    let chain = Sturm::new(&coefficients(surface, 0.0, ray, usize::from(surface.degree())));
    chain.roots(-64.0, 64.0).iter().map(approximate).collect()
}

/// Lines tilted by 0 to 1e-4 from the inflectional tangents on the inner half of a torus, where the normal curvature `sin^2 a /
/// minor + cos^2 a cos v / rho` of the direction at the angle a from the circle of latitude vanishes: sides are those of the
/// exact quartic, except within delta of the torus.
#[test]
fn sides_near_inflectional_tangents_are_exact() {
    let mut rng = rng(17);
    let mut pairs = 0;
    for k in 0..160 * effort() {
        let major = rng.random_range(0.5..4.0);
        let minor = major * rng.random_range(0.05..0.95);
        let (sin, cos) = libm::sincos(std::f64::consts::PI * rng.random_range(0.52..1.48));
        let (turn_sin, turn_cos) = libm::sincos(rng.random_range(0.0..std::f64::consts::TAU));
        let (out, around) = (Vec3::new(turn_cos, turn_sin, 0.0), Vec3::new(-turn_sin, turn_cos, 0.0));
        let rho = major + minor * cos;
        let foot = rho * out + minor * sin * Vec3::Z;
        let (normal, up) = (cos * out + sin * Vec3::Z, cos * Vec3::Z - sin * out);
        let way = (around + (-cos * minor / rho).sqrt() * up).normalize();
        for tilt in [0.0, 1e-9, 1e-8, 1e-7, 1e-6, 3e-6, 1e-5, 1e-4] {
            let tilt = if rng.random() { tilt } else { -tilt };
            let mut ray = Ray::new(foot, way + tilt * normal);
            ray.origin = foot - rng.random_range(-2.0..2.0) * ray.direction;
            let mut surface = Surface::torus(Vec3::ZERO, Vec3::Z, major, minor);
            let mut middle = ray.closest_time(foot);
            if k % 4 == 0 {
                let map = Affine::scale(Vec3::new(1.0, 1.5, 0.7));
                surface = surface.transformed(&Transform::from_affine(map).unwrap());
                ray = Ray::new(map.point(ray.origin), map.vector(ray.direction));
                middle = ray.closest_time(map.point(foot));
            }
            let got = surface.crossings(&ray);
            // the other roots of the contact are about the square root of the tilt away
            let reach = 8.0 * libm::sqrt(tilt.abs().max(1e-10));
            for step in -10..=10 {
                let t = middle + 0.1 * f64::from(step) * reach;
                let is_inside = sign(&polynomial(&surface, 0.0, &at(&ray, &exact(t)))) < 0;
                let is_right = got.negative_after(t) == is_inside;
                assert!(
                    is_right || distance(&surface, &ray, t) < 64.0 * rounding(&surface, &ray, t),
                    "tilt {tilt}: side at {t}\n{surface:?}\n{ray:?}\n{got:?}"
                );
            }
            pairs += usize::from(got.times().windows(2).any(|w| w[1] - w[0] < reach));
        }
    }
    assert!(pairs > 200, "only {pairs} lines with two crossings at the contact");
}

#[test]
fn closed_forms() {
    let along_x = |y: f64| Ray::new(Vec3::new(-10.0, y, 0.0), Vec3::new(2.0, 0.0, 0.0));
    let times = |surface: &Surface, y: f64| surface.crossings(&along_x(y)).times().to_vec();
    assert_eq!(times(&Surface::plane(Vec3::new(3.0, 0.0, 0.0), 6.0), 0.0), [6.0]);
    assert_eq!(times(&Surface::sphere(Vec3::X, 5.0), 3.0), [3.5, 7.5]);
    assert_eq!(times(&Surface::cylinder(Vec3::X, Vec3::Z, 5.0), 4.0), [4.0, 7.0]);
    assert_eq!(times(&Surface::cone(Vec3::X, Vec3::Y, 1.0), 2.0), [4.5, 6.5]);
    let torus = Surface::torus(Vec3::ZERO, Vec3::Z, 4.0, 1.0);
    assert_eq!(times(&torus, 0.0), [2.5, 3.5, 6.5, 7.5]);
    let (inner, outer) = (8f64.sqrt(), 24f64.sqrt());
    for (got, want) in times(&torus, 1.0).into_iter().zip([-outer, -inner, inner, outer]) {
        assert!((got - 0.5 * (10.0 + want)).abs() < 2e-15);
    }
    assert_eq!(times(&torus, 4.0).len(), 2);
    assert!(times(&torus, 5.0).is_empty(), "tangent outside");
    let q = [[1.0, 0.0, 0.0, 0.0], [0.0, 4.0, 0.0, 0.0], [0.0, 0.0, 9.0, 0.0], [0.0, 0.0, 0.0, -25.0]];
    assert_eq!(times(&Surface::quadric(&q).unwrap(), 2.0), [3.5, 6.5]);
}

/// In a spindle torus the lemon is solid: points nearer to the circle than the tube's radius are inside.
#[test]
fn spindle_tori_are_solid_in_the_middle() {
    let mut rng = rng(14);
    let mut found = [0; 5];
    for k in 0..3000 {
        let (major, minor) = (size(&mut rng, 1e-3, 1.0), 1.0);
        let surface = Surface::torus(Vec3::ZERO, Vec3::Z, major, minor);
        let ray = if k % 2 == 0 {
            let target = 2.0 * rng.random_range(0.0..1.0) * unit_vector(&mut rng);
            Ray::new(target, unit_vector(&mut rng))
        } else {
            // across the dimple
            let bottom = (minor * minor - major * major).sqrt();
            let height = bottom + rng.random_range(0.0..1.0) * (minor - bottom);
            let way = Vec3::new(rng.random_range(-1.0..1.0), 1.0, rng.random_range(-0.05..0.05));
            Ray::new(Vec3::new(0.0, 0.0, height), way)
        };
        let got = surface.crossings(&ray);
        found[got.times().len()] += 1;
        for step in -400..=400 {
            let t = 0.01 * f64::from(step);
            let p = ray.at(t);
            let nearest = (p.x.hypot(p.y) - major).hypot(p.z) - minor;
            if nearest.abs() > 1e-12 {
                assert_eq!(got.negative_after(t), nearest < 0.0, "{surface:?}\n{ray:?}\n{t} {got:?}");
            }
        }
    }
    assert!(found[2] > 1000 && found[4] > 300 && found[1] + found[3] == 0, "{found:?}");
    let through = Ray::new(Vec3::new(0.0, 0.0, -3.0), Vec3::Z);
    let spindle = Surface::torus(Vec3::ZERO, Vec3::Z, 3.0, 5.0);
    assert_eq!(spindle.crossings(&through).times(), [-1.0, 7.0]);
}

#[test]
fn directions_of_any_length_and_rays_along_axes() {
    let surfaces = [
        Surface::sphere(Vec3::ZERO, 1.0),
        Surface::cylinder(Vec3::ZERO, Vec3::Z, 1.0),
        Surface::cone(Vec3::ZERO, Vec3::Z, 1.0),
        Surface::torus(Vec3::ZERO, Vec3::Z, 1.0, 0.25),
    ];
    for surface in &surfaces {
        let slow = Ray::new(Vec3::new(-3.0, 0.1, 0.2), Vec3::X);
        let want = surface.crossings(&slow);
        assert!(want.times().len() >= 2);
        for power in [-1060, -900, -300, 300, 900, 1020] {
            let rate = libm::ldexp(1.0, power);
            let got = surface.crossings(&Ray::new(slow.origin, slow.direction * rate));
            let times: Vec<f64> = want.times().iter().map(|t| t / rate).filter(|t| t.is_finite()).collect();
            assert_eq!(got.times(), times, "{surface:?} at rate 2^{power}");
        }
    }
    let along_axis = Ray::new(Vec3::new(0.5, 0.0, 7.0), Vec3::Z);
    assert!(surfaces[1].crossings(&along_axis).starts_negative());
    assert_eq!(surfaces[2].crossings(&along_axis).times(), [-7.5, -6.5]);
    assert!(surfaces[2].crossings(&along_axis).starts_negative());
    assert!(surfaces[3].crossings(&along_axis).times().is_empty());
    let in_tube = Ray::new(Vec3::new(1.0, 0.0, 7.0), Vec3::Z);
    assert_eq!(surfaces[3].crossings(&in_tube).times(), [-7.25, -6.75]);
}

/// Far from the axis and nearly parallel to it: the crossings are far away, and all near points are outside.
#[test]
fn rays_that_hardly_leave_the_axis() {
    let cylinder = Surface::cylinder(Vec3::ZERO, Vec3::Z, 3.0);
    for slope in [1e-100, 1e-140, 1e-150, 1.1e-156, 1e-159, 1e-170] {
        let found = cylinder.crossings(&Ray::new(Vec3::new(1e6, 0.0, 2.0), Vec3::new(-slope, 0.0, -0.5)));
        assert!(!found.starts_negative(), "{slope:e}: {found:?}");
        assert!(found.times().iter().all(|&t| t > 0.99e6 / slope), "{slope:e}: {found:?}");
        assert!(slope < 1e-156 || found.times().len() == 2, "{slope:e}: {found:?}");
    }
}

#[test]
fn bad_numbers_give_an_answer() {
    for (_, maker) in MAKERS {
        let surface = maker(Vec3::ZERO, 1.0, &mut rng(15));
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
            for ray in
                [Ray::new(Vec3::new(bad, 0.0, 0.0), Vec3::X), Ray::new(Vec3::ZERO, Vec3::new(bad, 1.0, 0.0))]
            {
                let got = surface.crossings(&ray);
                assert!(got.times().iter().all(|t| t.is_finite()));
                assert!(got.times().windows(2).all(|w| w[0] < w[1]));
            }
        }
    }
}

/// Rays that are parallel or asymptotic up to rounding: no crossings are reported at times of 1e8 or 1e15.
mod nearly_never {
    use rayweave_math::{Affine, Transform, Vec3};
    use rayweave_shape::{Ray, surface::Surface};

    fn times(surface: &Surface, ray: &Ray) -> (bool, Vec<f64>) {
        let found = surface.crossings(ray);
        (found.starts_negative(), found.times().to_vec())
    }

    #[test]
    fn rays_along_a_plane_do_not_cross_it() {
        let plane = Surface::plane(Vec3::ONE, 1.0);
        let along = Vec3::new(-3.0, 1.0, 2.0);
        assert_eq!(times(&plane, &Ray::new(Vec3::new(2.0, 0.0, 0.0), along)), (false, vec![]));
        assert_eq!(times(&plane, &Ray::new(Vec3::new(-2.0, 0.0, 0.0), along)), (true, vec![]));
        // all integer directions perpendicular to integer normals
        let mut parallel = 0;
        for k in 0..7_i32.pow(6) {
            let digit = |place: u32| f64::from(k / 7_i32.pow(place) % 7 - 3);
            let (n, d) = (Vec3::new(digit(0), digit(1), digit(2)), Vec3::new(digit(3), digit(4), digit(5)));
            if n == Vec3::ZERO || d == Vec3::ZERO {
                continue;
            }
            let (is_inside, found) = times(&Surface::plane(n, 0.5), &Ray::new(n, d));
            assert_eq!(found.is_empty(), n.dot(d) == 0.0, "{n} {d} {found:?}");
            if found.is_empty() {
                parallel += 1;
                assert!(!is_inside, "{n} {d}");
            }
        }
        assert!(parallel > 5000, "{parallel}");
        // where the normal is a coordinate axis, a component of any size counts
        let across = times(&Surface::plane(Vec3::X, 1.0), &Ray::new(Vec3::ZERO, Vec3::new(1e-17, 0.0, 1.0)));
        assert_eq!(across, (true, vec![1e17]));
        // an angle of 1e-14 is not a rounding error
        let tilted = Ray::new(Vec3::ZERO, Vec3::new(-3.0, 1.0, 2.0 + 1e-13));
        assert_eq!(times(&plane, &tilted).1.len(), 1);
    }

    /// x^2 + y^2 - z^2 = 1 and its asymptotic directions, turned by any angle.
    #[test]
    fn asymptotic_rays_do_not_cross_a_quadric() {
        let form = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.0], [0.0, 0.0, 0.0, -1.0]];
        let hyperboloid = Surface::quadric(&form).unwrap();
        for k in 0..2000 {
            let k = f64::from(k);
            let turn = Affine::rotation(Vec3::new(1.0, 0.3 * k, -2.0), 17.0 * k);
            let there = Transform::from_affine(turn).unwrap();
            let surface = hyperboloid.transformed(&there);
            let asymptotic = turn.vector(Vec3::new(0.1 * k.cos(), 0.1 * k.sin(), 0.1));
            // through a point of the circle at the waist: inside for ever, or one crossing nearby
            for (x, most) in [(0.0, 0), (0.5, 1), (3.0, 1)] {
                let at = turn.point(Vec3::new(x * k.sin(), -x * k.cos(), 0.0));
                let (_, found) = times(&surface, &Ray::new(at, asymptotic));
                assert!(found.len() <= most && found.iter().all(|t| t.abs() < 1e6), "{k} {x} {found:?}");
            }
            // across the asymptotic direction there is one, where f = 0
            let at = turn.point(Vec3::new(2.0 * k.cos(), 2.0 * k.sin(), 0.0));
            let ray = Ray::new(at, asymptotic);
            let (_, found) = times(&surface, &ray);
            // |q + t d|^2: 4 + 0.4 t = 1
            assert!(found.len() == 1 && (found[0] + 7.5).abs() < 1e-9, "{k} {found:?}");
        }
    }

    #[test]
    fn rays_along_a_cylinder_or_a_cone_do_not_cross_it_far_out() {
        for k in 0..2000 {
            let k = f64::from(k);
            let axis = Vec3::new((1.1 * k).sin(), 0.7 + (0.3 * k).cos(), 1.0 - 0.001 * k);
            let cylinder = Surface::cylinder(Vec3::ZERO, axis, 2.0);
            let scaled = 0.37 * k * axis + 0.01 * axis;
            let within = Ray::new(Vec3::new(0.3, 0.2, -0.4), scaled);
            assert_eq!(times(&cylinder, &within), (true, vec![]), "{k}");
            let beside = Ray::new(Vec3::new(0.3, 0.2, -0.4) + 5.0 * axis.any_orthonormal_vector(), scaled);
            assert_eq!(times(&cylinder, &beside), (false, vec![]), "{k}");
            // along a line of the cone's surface, from a point on the axis
            let cone = Surface::cone(Vec3::ZERO, axis, 0.5);
            let unit = axis.normalize();
            let side = unit.any_orthonormal_vector();
            let (_, found) = times(&cone, &Ray::new(3.0 * unit, unit + 0.5 * side));
            assert!(found.len() <= 1 && found.iter().all(|t| t.abs() < 1e3), "{k} {found:?}");
        }
    }
}
