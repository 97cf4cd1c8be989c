//! The distribution of rays over apertures and directions: moments against closed forms.

use crate::{assert_close, mean, ray};
use rayweave_math::Vec3;
use rayweave_optics::component::Aperture;
use rayweave_optics::source::*;

const COUNT: u64 = 90_000;

/// Samplings, each with the error of a mean over its rays of a number between 0 and 1: five
/// standard deviations for random points.
fn samplings() -> [(Sampling, f64); 4] {
    [
        (Sampling::Grid { columns: 300, rows: 300 }, 1e-4),
        (Sampling::Hexapolar { rings: 170 }, 1e-4),
        (Sampling::Fibonacci { count: COUNT }, 1e-4),
        (Sampling::Random { count: COUNT }, 5.0 * 0.5 / 300.0),
    ]
}

fn all(pattern: Pattern) -> SourceRays {
    let source = Source::new(pattern).unwrap().seed(3);
    source.rays(0..source.count())
}

/// Over a disc of radius R the mean of r^2 is R^2/2 and of r^4 R^4/3; over a rectangle that of x^2 is w^2/12.
#[test]
fn top_hats() {
    for (sampling, error) in samplings() {
        let beam = |aperture| Pattern::Beam { aperture, profile: BeamProfile::TopHat, sampling };
        let rays = all(beam(Aperture::circle(2.0)));
        assert_close(mean(&rays, |o, _| o.length_squared()), 0.5, error);
        assert_close(mean(&rays, |o, _| o.length_squared().powi(2)), 1.0 / 3.0, error);
        assert_close(mean(&rays, |o, _| o.x), 0.0, 2.0 * error);
        let rays = all(beam(Aperture::ellipse(2.0, 6.0)));
        assert_close(mean(&rays, |o, _| o.x * o.x), 0.25, error);
        assert_close(mean(&rays, |o, _| o.y * o.y / 9.0), 0.25, error);
        assert!((0..rays.len()).all(|k| {
            let (origin, direction) = ray(&rays, k);
            origin.x * origin.x + origin.y * origin.y / 9.0 <= 1.0 + 1e-12 && direction == Vec3::Z
        }));
        if !matches!(sampling, Sampling::Hexapolar { .. }) {
            let rays = all(beam(Aperture::rectangle(2.0, 6.0)));
            assert_close(mean(&rays, |o, _| o.x * o.x), 1.0 / 3.0, error);
            assert_close(mean(&rays, |o, _| o.y * o.y / 9.0), 1.0 / 3.0, error);
            assert_close(mean(&rays, |o, _| o.x * o.y / 3.0), 0.0, 2.0 * error);
        }
    }
}

/// 1 - 1/e^2 of the power lies within the radius of a Gaussian beam, and the mean of r^2 is radius^2 / 2; cut off at R,
/// `1 - exp(-2 r^2 / radius^2)` is divided by its value at R.
#[test]
fn gaussian_beams() {
    for (sampling, error) in samplings() {
        // rays on rings: the fraction changes by a whole ring; a mapped grid has 150 rings
        let on_rings = matches!(sampling, Sampling::Hexapolar { .. } | Sampling::Grid { .. });
        let coarse = if on_rings { 0.01 } else { error };
        let beam = |diameter, radius| {
            let (aperture, profile) = (Aperture::circle(diameter), BeamProfile::Gaussian { radius });
            all(Pattern::Beam { aperture, profile, sampling })
        };
        let within =
            |rays: &SourceRays, radius: f64| mean(rays, |o, _| f64::from(u8::from(o.length() < radius)));
        let wide = beam(20.0, 1.5);
        assert_close(within(&wide, 1.5), 1.0 - (-2f64).exp(), coarse);
        assert_close(within(&wide, 0.75), 1.0 - (-0.5f64).exp(), coarse);
        if !on_rings {
            // the squares of random places deviate by as much as their mean
            assert_close(mean(&wide, |o, _| o.length_squared() / 2.25), 0.5, 10.0 * error);
        }
        let cut = beam(2.0, 1.5);
        let passed = |r: f64| 1.0 - (-2.0 * r * r / 2.25).exp();
        assert_close(within(&cut, 0.5), passed(0.5) / passed(1.0), coarse);
        assert!((0..cut.len()).all(|k| ray(&cut, k).0.length() <= 1.0));
    }
}

/// Uniform cosines: the mean of cos is (1 + c)/2, of its square (1 + c + c^2)/3; all azimuths are
/// equally likely.
#[test]
fn points_shine_evenly_in_solid_angle() {
    for (sampling, error) in samplings() {
        for degrees in [0.01, 20.0, 90.0, 180.0] {
            let rays = all(Pattern::Point { half_angle_degrees: degrees, sampling });
            let edge = f64::to_radians(degrees).cos();
            let span = 1.0 - edge;
            assert_close(mean(&rays, |_, d| d.z), 0.5 * (1.0 + edge), error * span + 1e-16);
            let square = (1.0 + edge + edge * edge) / 3.0;
            assert_close(mean(&rays, |_, d| d.z * d.z), square, 2.0 * error * span + 1e-15);
            assert_close(mean(&rays, |_, d| d.x * d.x), 0.5 * (1.0 - square), 2.0 * error * span + 1e-15);
            assert!((0..rays.len()).all(|k| {
                let (_, direction) = ray(&rays, k);
                direction.z >= edge - 1e-15 && (direction.length() - 1.0).abs() < 4e-16
            }));
        }
    }
}

/// Lambert: the mean of cos is 2/3 and of its square 1/2 over a hemisphere; within the angle a, 1 - sin^2(a)/2 for the square.
#[test]
fn extended_sources() {
    let aperture = Aperture::circle(4.0);
    let source = |emission, half_angle_degrees| {
        all(Pattern::Extended { aperture, emission, half_angle_degrees, count: COUNT })
    };
    let error = 5.0 * 0.5 / 300.0;
    let lambert = source(Emission::Lambert, 90.0);
    assert_close(mean(&lambert, |_, d| d.z), 2.0 / 3.0, error);
    assert_close(mean(&lambert, |_, d| d.z * d.z), 0.5, error);
    assert_close(mean(&lambert, |o, _| o.length_squared()), 2.0, 4.0 * error);
    assert_close(mean(&lambert, |o, d| o.x * d.x), 0.0, 2.0 * error);
    assert!(lambert.power.iter().all(|&power| power == 100.0));
    // power per solid angle in zones of equal height is proportional to the cosine in their middle
    for zone in 0..10 {
        let (low, high) = (f64::from(zone) / 10.0, f64::from(zone + 1) / 10.0);
        let part = mean(&lambert, |_, d| f64::from(u8::from(d.z >= low && d.z < high)));
        assert_close(part, high * high - low * low, error);
    }
    let narrow = source(Emission::Lambert, 30.0);
    assert_close(mean(&narrow, |_, d| d.z * d.z), 0.875, error);
    let even = source(Emission::Isotropic, 60.0);
    assert_close(mean(&even, |_, d| d.z), 0.75, error);
    assert_close(mean(&even, |_, d| d.z * d.z), 1.75 / 3.0, error);
}
