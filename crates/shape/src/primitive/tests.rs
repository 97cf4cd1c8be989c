//! Tests of properties of all primitives, and checks that the tests of each file use.

use super::*;
use crate::Ray;
use crate::surface::Surface;
use rayweave_math::{Bounds, Vec3};

/// Numbers uniform in [0, 1): SplitMix64 (Steele, Lea and Flood, OOPSLA 2014).
pub fn uniform(mut seed: u64) -> impl FnMut() -> f64 {
    move || {
        seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (seed ^ (seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 * 2f64.powi(-53)
    }
}

fn point_in(bounds: &Bounds, rng: &mut impl FnMut() -> f64) -> Vec3 {
    bounds.lo + Vec3::new(rng(), rng(), rng()) * bounds.size()
}

/// Asserts that `contains` agrees with a direct formula at random points of the box with the given half extents about the
/// origin, that both answers occur, and that the bounds contain every inside point.
pub fn check_inside(shape: &impl Shape, half: Vec3, inside: impl Fn(Vec3) -> bool) {
    let lowered = shape.lower();
    let (region, mut rng) = (Bounds::centred(Vec3::ZERO, half), uniform(1));
    let mut count = [0; 2];
    for _ in 0..4000 {
        let p = point_in(&region, &mut rng);
        assert_eq!(lowered.contains(p), inside(p), "{p} in {lowered:?}");
        count[usize::from(inside(p))] += 1;
        assert!(!inside(p) || lowered.bounds.contains(p), "{p} in {lowered:?}");
    }
    assert!(count[0] > 40 && count[1] > 40, "one-sided test: {count:?}");
}

/// Asserts that the bounds are tight: each finite face of the bounds contains one of the points, which are on the boundary
/// of the solid, since they are inside when moved slightly towards `middle`. (`check_inside` tests that the bounds are
/// large enough.)
pub fn check_touched(shape: &impl Shape, middle: Vec3, points: &[Vec3]) {
    let lowered = shape.lower();
    let size = points.iter().fold(0.0f64, |size, p| size.max((*p - middle).length()));
    for p in points {
        let nearly = *p + (middle - *p) * 1e-7;
        assert!(lowered.contains(nearly), "{p} of {lowered:?}");
    }
    let bounds = lowered.bounds;
    for (k, face) in (0..6).map(|k| (k % 3, [bounds.lo, bounds.hi][k / 3][k % 3])) {
        let touched = points.iter().any(|p| (p[k] - face).abs() <= 1e-13 * size);
        assert!(face.is_infinite() || touched, "axis {k}: {face} in {bounds:?}");
    }
}

/// Asserts that the closed form of the volume agrees with a count of one random point per cell of a grid of n^3 over the
/// bounds.
///
/// If a line crosses the boundary at most about four times, the boundary intersects at most 12 n^2 cells. Each contributes
/// a standard deviation of at most half a cell, so five standard deviations are 9 n^-2 of the box.
pub fn check_volume(shape: &impl Shape) {
    const N: u32 = 36;
    let lowered = shape.lower();
    let (lo, cell) = (lowered.bounds.lo, lowered.bounds.size() / f64::from(N));
    let mut rng = uniform(2);
    let mut inside = 0;
    for i in 0..N * N * N {
        let corner = [i % N, i / N % N, i / N / N].map(f64::from);
        let jitter = Vec3::new(rng(), rng(), rng());
        inside += u32::from(lowered.contains(lo + (Vec3::from_array(corner) + jitter) * cell));
    }
    let unit = cell.x * cell.y * cell.z;
    let (counted, closed) = (f64::from(inside) * unit, shape.volume().unwrap());
    let error = 9.0 * f64::from(N) * unit;
    assert!((counted - closed).abs() <= error, "{counted} {closed} +- {error}");
}

/// The message of an error.
pub fn message<T>(result: Result<T, ShapeError>) -> String {
    result.err().map(|error| error.to_string()).unwrap_or_default()
}

fn many() -> Vec<Primitive> {
    let mut rng = uniform(3);
    let random = (0..2000).map(|_| Primitive::random(&mut rng));
    Primitive::examples().into_iter().chain(random).collect()
}

#[test]
fn arguments_build_the_same_primitive_again() {
    for primitive in many() {
        let mut arguments = primitive.arguments();
        assert_eq!(build(primitive.name(), &arguments).as_ref(), Ok(&primitive));
        arguments.reverse();
        assert_eq!(build(primitive.name(), &arguments).as_ref(), Ok(&primitive));
        let names: Vec<&str> = primitive.arguments().iter().map(|(name, _)| *name).collect();
        let table: Vec<&str> = primitive.manual().parameters.iter().map(|p| p.name).collect();
        assert_eq!(names, table);
    }
}

#[test]
fn random_primitives_are_of_all_kinds_and_examples_in_order() {
    let random = many().split_off(MANUALS.len());
    for manual in MANUALS {
        assert!(random.iter().any(|p| p.name() == manual.name), "{}", manual.name);
        assert_eq!(Primitive::example(manual.name).unwrap().name(), manual.name);
    }
    let names = MANUALS.iter().map(|manual| manual.name);
    assert!(Primitive::examples().iter().map(Primitive::name).eq(names));
    assert_eq!(Primitive::example("teapot"), None);
    assert_eq!(Primitive::random(|| 1.0 - 1e-16).name(), MANUALS[MANUALS.len() - 1].name);
}

#[test]
fn bounds_hold_what_is_inside() {
    let mut rng = uniform(4);
    let near = Bounds::centred(Vec3::ZERO, Vec3::splat(4.0));
    for primitive in many() {
        let lowered = primitive.lower();
        let slack = lowered.bounds.grown(1e-14);
        for _ in 0..200 {
            let p = point_in(&near, &mut rng);
            assert!(!lowered.contains(p) || slack.contains(p), "{p} in {primitive:?}");
        }
    }
}

/// Along random rays the crossings that the kernels report agree with the signs of f at points between them.
#[test]
fn crossings_agree_with_the_signs_at_points() {
    let mut rng = uniform(10);
    let cube = Bounds::centred(Vec3::ZERO, Vec3::splat(2.0));
    for primitive in many() {
        let (origin, target) = (point_in(&cube, &mut rng), point_in(&cube, &mut rng));
        let ray = Ray::new(origin, target - origin);
        let lowered = primitive.lower();
        let reach = lowered.bounds.hi.x;
        for facet in lowered.facets {
            let crossings = facet.surface.crossings(&ray);
            for _ in 0..20 {
                let t = 6.0 * rng() - 2.5;
                let (value, gradient) = facet.surface.value_and_gradient(ray.at(t));
                // beyond its aperture a sag surface is clipped, and its crossings are not guaranteed
                let is_clipped =
                    matches!(facet.surface, Surface::Object(_)) && ray.at(t).truncate().length() >= reach;
                let clear = value.abs() > 1e-9 * gradient.length() && !is_clipped;
                assert!(!clear || crossings.negative_after(t) == (value < 0.0), "{facet:?} {ray:?} {t}");
            }
        }
    }
}

#[test]
fn pages_agree_with_the_code() {
    for manual in MANUALS {
        let page = manual.text;
        assert!(page.contains(&parameter_table(manual.parameters)), "{page}");
        assert!(page.contains(&format!("`{}`", manual.equation)), "{}", manual.name);
        assert!(page.starts_with(manual.summary) && manual.summary.ends_with('.'));
        for face in manual.faces {
            assert!(page.contains(&format!("`{face}`")), "{face} of {}", manual.name);
        }
        assert!(page.contains("\nFace") || page.contains("\nOne face"), "{}", manual.name);
    }
}

/// `side0..sideN-1` matches any number.
fn is_face(pattern: &str, name: &str) -> bool {
    match pattern.split_once("0..") {
        None => pattern == name,
        Some((stem, _)) => name.strip_prefix(stem).is_some_and(|k| k.parse::<u32>().is_ok()),
    }
}

#[test]
fn faces_have_the_names_of_the_page_each_once() {
    for primitive in many() {
        let facets = primitive.lower().facets;
        let faces = primitive.manual().faces;
        for (i, facet) in facets.iter().enumerate() {
            assert!(faces.iter().any(|face| is_face(face, &facet.name)), "{facet:?}");
            assert!(facets[..i].iter().all(|other| other.name != facet.name), "{facet:?}");
        }
    }
}

#[test]
fn unknown_names_are_rejected() {
    let number = |x: f64| Value::Number(x);
    assert_eq!(
        message(build("spehre", &[])),
        format!("unknown shape `spehre`: the shapes are {}. Did you mean `sphere`?", names())
    );
    assert!(message(build("teapot", &[])).ends_with(&format!("{}.", names())));
    assert_eq!(
        message(build("sphere", &[("raduis", number(1.0))])),
        "sphere: unknown parameter `raduis`: the parameters are radius. Did you mean `radius`?"
    );
    assert_eq!(
        message(build("sphere", &[("diameter", number(1.0))])),
        "sphere: unknown parameter `diameter`: the parameters are radius. Did you mean `radius`, half the diameter?"
    );
    assert!(message(build("cube", &[])).ends_with("Did you mean `box`?"));
    assert_eq!(
        message(build("sphere", &[])),
        "sphere: radius is missing: it is a number and has no default. Did you forget it?"
    );
    assert_eq!(
        message(build("sphere", &[("radius", number(1.0)), ("radius", number(1.0))])),
        "sphere: radius is given more than once: each parameter has one value. Keep one of them."
    );
}

#[test]
fn invalid_values_are_rejected() {
    let refuse = |name: &str, parameter: &str, value: Value| message(build(name, &[(parameter, value)]));
    assert_eq!(
        refuse("sphere", "radius", Value::Vector(vec![1.0, 2.0])),
        "sphere: radius is a list of 2 numbers: radius must be a number. Are there too few or too many numbers?"
    );
    assert_eq!(
        refuse("convex", "planes", Value::Rows(vec![vec![1.0; 4], vec![1.0; 3]])),
        "convex: planes[1] is a list of 3 numbers: planes must be 1 row or more of 4 numbers. Are there too few or too many numbers?"
    );
    assert_eq!(
        refuse("box", "size", Value::Vector(vec![1.0, f64::NAN, 1.0])),
        "box: size[1] is nan: size must be finite and greater than 0."
    );
    assert_eq!(
        refuse("sphere", "radius", Value::Number(f64::INFINITY)),
        "sphere: radius is inf: radius must be finite and greater than 0."
    );
    assert_eq!(
        refuse("sphere", "radius", Value::Number(1e200)),
        "sphere: radius is 1e200: only lengths from 1e-60 to 1e60 are supported. Is the unit right?"
    );
    let error = build("box", &[("size", Value::Vector(vec![1.0, 2.0, -3.0]))]).unwrap_err();
    assert_eq!((error.parameter(), error.index()), (Some("size"), vec![2]));
}

/// Every parameter of every primitive rejects NaN at every position, and every default is in range.
#[test]
fn nan_is_rejected_everywhere() {
    for example in Primitive::examples() {
        for (k, parameter) in example.manual().parameters.iter().enumerate() {
            let default = parameter.default_value();
            assert!(default.is_none_or(|d| parameter.check(example.name(), &d).is_ok()));
            let mut arguments = example.arguments();
            poison(&mut arguments[k].1);
            let error = build(example.name(), &arguments).unwrap_err();
            assert!(matches!(error, ShapeError::OutOfRange { .. }), "{error}");
            assert_eq!(error.parameter(), Some(parameter.name));
        }
    }
}

fn poison(value: &mut Value) {
    match value {
        Value::Number(number) => *number = f64::NAN,
        Value::Vector(list) => *list.last_mut().unwrap() = f64::NAN,
        Value::Rows(rows) => *rows[0].last_mut().unwrap() = f64::NAN,
    }
}
