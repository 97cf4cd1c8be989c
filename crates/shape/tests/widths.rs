//! The operations and kernels that are generic over the width: one ray (`f64`) and eight lanes give the same bits, for
//! special values too.

use fearless_simd::prelude::*;
use fearless_simd::{Level, Simd, dispatch};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_math::{Mat3, Vec3};
use rayweave_shape::lanes::{Kernel, LANES, Lanes, Vec3Lanes};
use rayweave_shape::real::Real;
use rayweave_shape::surface::Surface;

/// Zeros, the ends of the range of f64, ordinary numbers, infinities and NaN.
const SPECIAL: [f64; 18] = [
    0.0,
    -0.0,
    5e-324,
    -5e-324,
    f64::MIN_POSITIVE,
    1e-160,
    -1e-160,
    1.0,
    -1.0,
    1.0 + f64::EPSILON,
    0.1,
    3.0,
    1e16,
    -1e155,
    f64::MAX,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::NAN,
];

/// The bits, the same for all NaNs: their sign and payload have no meaning.
fn bits(x: f64) -> u64 {
    if x.is_nan() { f64::NAN.to_bits() } else { x.to_bits() }
}

/// Results of all operations for two numbers; masks as 1 and 0.
#[inline(always)]
fn operations<R: Real>(x: R, y: R) -> [R; 15] {
    let one = |mask: R::Mask| R::select(mask, x.splat(1.0), x.splat(0.0));
    [
        x + y,
        x - y,
        x * y,
        x / y,
        -x,
        x + 0.1,
        x - 0.1,
        x * 0.1,
        x.taken_from(0.1),
        x.abs(),
        x.sqrt(),
        one(x.is_below(y)),
        one(x.is_at_most(y)),
        one(x.is_zero()),
        one(x.is_zero() & y.is_below(x)),
    ]
}

#[inline(always)]
fn in_lanes<S: Simd>(simd: S, x: f64, y: &[f64; LANES]) -> [[f64; LANES]; 15] {
    let y: Lanes<S> = Lanes::from_fn(simd, |k| y[k]);
    operations(y.splat(x), y).map(|lanes| lanes.to_array())
}

#[test]
fn operations_on_special_values_have_the_same_bits() {
    let padded: Vec<f64> = SPECIAL.into_iter().cycle().take(SPECIAL.len().next_multiple_of(LANES)).collect();
    let mut compared = 0;
    for x in SPECIAL {
        for eight in padded.as_chunks::<LANES>().0 {
            let got = dispatch!(Level::new(), simd => in_lanes(simd, x, eight));
            for (k, &y) in eight.iter().enumerate() {
                for (number, expected) in operations(x, y).into_iter().enumerate() {
                    assert_eq!(bits(got[number][k]), bits(expected), "operation {number} of {x:e} and {y:e}");
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, SPECIAL.len() * padded.len() * 15);
}

fn surfaces() -> Vec<Surface> {
    let (at, axis) = (Vec3::new(0.3, -0.2, 0.5), Vec3::new(1.0, 2.0, -0.5));
    let diagonal = |x, y, z| Mat3::from_diagonal(Vec3::new(x, y, z));
    vec![
        Surface::plane(axis, 0.3),
        Surface::plane(-Vec3::Y, 0.3),
        Surface::sphere(at, 1.5),
        Surface::sphere(Vec3::ZERO, 1e-60),
        Surface::cylinder(at, axis, 0.7),
        Surface::cylinder(Vec3::ZERO, Vec3::Z, 0.7),
        Surface::cylinder(at, Vec3::X, 1e60),
        Surface::cone(at, axis, 0.4),
        Surface::cone(Vec3::ZERO, Vec3::Y, 8.0),
        Surface::quadric_about(at, diagonal(1.0, 2.0, 0.3), Vec3::ZERO, -1.0),
        Surface::quadric_about(at, diagonal(1.0, -0.8, 0.0), Vec3::new(0.0, 0.0, 1.0), 0.0),
    ]
}

#[inline(always)]
fn values<S: Simd>(simd: S, kernel: &Kernel, points: &[Vec3; LANES]) -> [[f64; LANES]; 4] {
    let column = |k: usize| Lanes::from_fn(simd, |lane| points[lane][k]);
    let points: Vec3Lanes<S> = Vec3Lanes { x: column(0), y: column(1), z: column(2) };
    let (value, gradient) = kernel.value_and_gradient(simd, points);
    [value, gradient.x, gradient.y, gradient.z].map(|lanes| lanes.to_array())
}

/// Random points, some of whose coordinates are special values. Zeros have no sign here: the lane kernel of a plane across a
/// coordinate axis does not keep those of the normal.
#[test]
fn values_and_gradients_have_the_same_bits() {
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut finite = 0;
    for surface in surfaces() {
        let kernel = Kernel::of(&surface).unwrap();
        for _ in 0..400 {
            let mut coordinate = || match rng.random_range(0..3) {
                0 => SPECIAL[rng.random_range(0..SPECIAL.len())],
                _ => rng.random_range(-2.0..2.0),
            };
            let points = std::array::from_fn(|_| Vec3::new(coordinate(), coordinate(), coordinate()));
            let got = dispatch!(Level::new(), simd => values(simd, &kernel, &points));
            for (k, &point) in points.iter().enumerate() {
                let (value, gradient) = surface.value_and_gradient(point);
                finite += usize::from(value.is_finite());
                let expected = [value, gradient.x, gradient.y, gradient.z].map(|x| bits(x + 0.0));
                assert_eq!(got.map(|column| bits(column[k] + 0.0)), expected, "{surface:?} {point:?}");
            }
        }
    }
    assert!(finite > 10_000, "{finite} finite values");
}
