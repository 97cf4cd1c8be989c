//! The patterns of PyRayT, listed rays, placement and errors.

use crate::{assert_close, mean, ray};
use rayweave_math::{Affine, Vec3};
use rayweave_optics::component::Aperture;
use rayweave_optics::source::*;

fn source(pattern: Pattern) -> Source {
    Source::new(pattern).unwrap()
}

#[test]
fn lines() {
    let rays = source(Pattern::Line { length: 10.0, count: 5 }).rays(0..5);
    for (k, y) in [-5.0, -2.5, 0.0, 2.5, 5.0].into_iter().enumerate() {
        assert_eq!(ray(&rays, k), (Vec3::Y * y, Vec3::Z));
    }
    assert_eq!((rays.power[4], rays.wavelength_nm[4], rays.id[4], rays.source[4]), (100.0, 633.0, 4, 0));
    let one = source(Pattern::Line { length: 10.0, count: 1 }).rays(0..9);
    assert_eq!((one.len(), ray(&one, 0)), (1, (Vec3::ZERO, Vec3::Z)));
}

#[test]
fn circles() {
    let rays = source(Pattern::Circle { diameter: 6.0, count: 12 }).rays(0..12);
    for k in 0..12 {
        let (origin, direction) = ray(&rays, k);
        let (sin, cos) = (k as f64 * std::f64::consts::TAU / 12.0).sin_cos();
        assert!((origin - Vec3::new(3.0 * cos, 3.0 * sin, 0.0)).length() < 3e-15 && direction == Vec3::Z);
    }
}

#[test]
fn cones_and_wedges() {
    let rays = source(Pattern::Cone { half_angle_degrees: 30.0, count: 7 }).rays(0..7);
    for k in 0..7 {
        let (origin, direction) = ray(&rays, k);
        let azimuth = direction.y.atan2(direction.x).rem_euclid(std::f64::consts::TAU);
        assert_close(azimuth, k as f64 * std::f64::consts::TAU / 7.0, 1e-14);
        assert_close(direction.z, 0.75f64.sqrt(), 1e-15);
        assert_eq!((origin, rays.power[k]), (Vec3::ZERO, 100.0));
    }
    let rays = source(Pattern::Wedge { angle_degrees: 40.0, count: 5 }).rays(0..5);
    for (k, degrees) in [-20.0f64, -10.0, 0.0, 10.0, 20.0].into_iter().enumerate() {
        let (sin, cos) = degrees.to_radians().sin_cos();
        assert!((ray(&rays, k).1 - Vec3::new(0.0, sin, cos)).length() < 1e-15);
    }
}

/// Uniform in solid angle, the power of a ray 100 times the cosine: Lambert's law.
#[test]
fn lamps() {
    let count = 200_000;
    for (degrees, seed) in [(90.0, 1), (35.0, 2)] {
        let lamp = Pattern::Lamp { width: 3.0, height: 5.0, half_angle_degrees: degrees, count };
        let rays = source(lamp).seed(seed).rays(0..count);
        let edge = f64::to_radians(degrees).cos();
        let plain = |value: &dyn Fn(Vec3, Vec3) -> f64| {
            (0..rays.len()).map(|k| value(ray(&rays, k).0, ray(&rays, k).1)).sum::<f64>() / count as f64
        };
        // an upper bound of five standard deviations of the mean of numbers in a range of 1
        let error = 5.0 * 0.5 / (count as f64).sqrt();
        assert_close(plain(&|_, d| d.z), 0.5 * (1.0 + edge), error);
        assert_close(plain(&|_, d| d.z * d.z), (1.0 + edge + edge * edge) / 3.0, error);
        assert_close(plain(&|_, d| d.x), 0.0, 2.0 * error);
        assert_close(plain(&|o, _| o.x * o.x / 9.0), 1.0 / 12.0, error);
        assert_close(plain(&|o, _| o.y * o.y / 25.0), 1.0 / 12.0, error);
        assert_close(plain(&|o, d| o.y / 5.0 * d.y), 0.0, error);
        for k in 0..rays.len() {
            let (_, direction) = ray(&rays, k);
            assert!((rays.power[k] - 100.0 * direction.z).abs() < 1e-13 && direction.z >= edge - 1e-15);
        }
        // weighted by power: the mean of cos over cos: (1 - c^3) / 3 over (1 - c^2) / 2
        let weighted = 2.0 / 3.0 * (1.0 - edge.powi(3)) / (1.0 - edge * edge);
        assert_close(mean(&rays, |_, d| d.z), weighted, 2.0 * error);
    }
}

#[test]
fn listed_rays() {
    let origins = vec![Vec3::X, Vec3::Y, Vec3::Z];
    let directions = vec![Vec3::Z * 1e-200, Vec3::new(3.0, 0.0, 4.0), -Vec3::X];
    let plain = ListedRays::new(origins.clone(), directions.clone(), None, None).unwrap();
    let rays = source(Pattern::Rays(plain)).rays(0..3);
    assert_eq!((ray(&rays, 0), ray(&rays, 2)), ((Vec3::X, Vec3::Z), (Vec3::Z, -Vec3::X)));
    assert!((ray(&rays, 1).1 - Vec3::new(0.6, 0.0, 0.8)).length() < 1e-15);
    assert_eq!((rays.power[1], rays.wavelength_nm[1]), (100.0, 633.0));
    let columns = (Some(vec![400.0, 500.0, 600.0]), Some(vec![1.0, 2.0, 6.0]));
    let full = ListedRays::new(origins.clone(), directions, columns.0, columns.1).unwrap();
    let rays = source(Pattern::Rays(full.clone())).rays(0..3);
    assert_eq!(
        (&rays.power[..], &rays.wavelength_nm[..]),
        (&[1.0, 2.0, 6.0][..], &[400.0, 500.0, 600.0][..])
    );
    let rays = source(Pattern::Rays(full)).power(Power::Total(18.0)).unwrap().rays(0..3);
    assert_eq!(rays.power, [2.0, 4.0, 12.0]);

    let message = |directions: Vec<Vec3>, wavelength: Option<Vec<f64>>, power: Option<Vec<f64>>| {
        ListedRays::new(origins.clone(), directions, wavelength, power).unwrap_err().to_string()
    };
    assert_eq!(
        message(vec![Vec3::Z, Vec3::Z], None, None),
        "column directions of the rays has 2 rows: the origins have 3."
    );
    let zero = vec![Vec3::Z, Vec3::Z, Vec3::ZERO];
    assert!(message(zero, None, None).starts_with("directions[2] of the rays is [0, 0, 0]: its length"));
    let ahead = vec![Vec3::Z; 3];
    assert!(
        message(ahead.clone(), Some(vec![500.0, -1.0, 500.0]), None)
            .starts_with("wavelength_nm[1] of the rays is -1:")
    );
    assert!(
        message(ahead.clone(), None, Some(vec![1.0, 1.0, f64::NAN]))
            .starts_with("power[2] of the rays is NaN:")
    );
    assert!(message(ahead, None, Some(vec![0.0; 3])).starts_with("all powers of the rays are 0:"));
}

#[test]
fn placement() {
    let turn = Affine::rotation(Vec3::X, 90.0);
    let moved = Affine::translate(Vec3::new(1.0, 2.0, 3.0));
    let line = source(Pattern::Line { length: 2.0, count: 3 });
    let rays = line.clone().apply(&turn).unwrap().apply(&moved).unwrap().rays(0..3);
    assert_eq!(ray(&rays, 0), (Vec3::new(1.0, 2.0, 2.0), -Vec3::Y));
    let stretched = line.clone().apply(&Affine::scale(Vec3::new(1.0, 3.0, 5.0))).unwrap().rays(0..3);
    assert_eq!(ray(&stretched, 2), (Vec3::Y * 3.0, Vec3::Z));
    assert!(line.apply(&Affine::scale(Vec3::ZERO)).is_err());
}

#[test]
fn total_power() {
    let sampling = Sampling::Hexapolar { rings: 20 };
    let aperture = Aperture::ellipse(2.0, 3.0);
    for pattern in [
        Pattern::Line { length: 1.0, count: 77 },
        Pattern::Beam { aperture, profile: BeamProfile::TopHat, sampling },
        Pattern::Beam { aperture, profile: BeamProfile::Gaussian { radius: 0.7 }, sampling },
        Pattern::Point { half_angle_degrees: 70.0, sampling },
        Pattern::Extended { aperture, emission: Emission::Lambert, half_angle_degrees: 60.0, count: 1000 },
    ] {
        let source = source(pattern).power(Power::Total(3.0)).unwrap();
        assert_close(source.rays(0..source.count()).power.iter().sum(), 3.0, 1e-12);
    }
    // the mean of a lamp: the standard deviation of a cosine uniform in [0, 1] is 1 / sqrt(12)
    let lamp = Pattern::Lamp { width: 1.0, height: 1.0, half_angle_degrees: 90.0, count: 100_000 };
    let lamp = source(lamp).power(Power::Total(3.0)).unwrap();
    assert_close(lamp.rays(0..100_000).power.iter().sum(), 3.0, 5.0 * 6.0 / 12e5f64.sqrt());
}

#[test]
fn refusals() {
    let message = |pattern| Source::new(pattern).unwrap_err().to_string();
    assert_eq!(
        message(Pattern::Line { length: -1.0, count: 3 }),
        "length of the line of rays is -1: it must be finite and greater than 0. Did you mean 1?"
    );
    assert_eq!(
        message(Pattern::Circle { diameter: 1.0, count: 0 }),
        "circle of rays has 0 rays: a source needs from 1 to 2^53 rays."
    );
    let cone = |half_angle_degrees| Pattern::Cone { half_angle_degrees, count: 3 };
    assert!(message(cone(181.0)).ends_with("is 181: it must be greater than 0 and at most 180 degrees."));
    assert!(message(cone(f64::NAN)).contains("is NaN"));
    let lamp = Pattern::Lamp { width: 1.0, height: 0.0, half_angle_degrees: 90.0, count: 3 };
    assert!(message(lamp).starts_with("height of the aperture is 0:"));
    let beam = |aperture, profile, sampling| Pattern::Beam { aperture, profile, sampling };
    let (plate, disc) = (Aperture::rectangle(1.0, 2.0), Aperture::circle(1.0));
    let (rings, gauss) = (Sampling::Hexapolar { rings: 3 }, BeamProfile::Gaussian { radius: -1.0 });
    assert!(message(beam(plate, BeamProfile::TopHat, rings)).contains("hexapolar sampling of a rectangle"));
    assert!(
        message(beam(plate, gauss, Sampling::Random { count: 1 }))
            .contains("Gaussian profile over a rectangle")
    );
    assert!(message(beam(disc, gauss, rings)).starts_with("radius of the beam is -1:"));
    assert!(message(beam(Aperture::circle(0.0), gauss, rings)).starts_with("diameter of the aperture is 0:"));
    let line = source(Pattern::Line { length: 1.0, count: 3 });
    assert!(line.power(Power::Total(0.0)).unwrap_err().to_string().starts_with("power of the source is 0:"));
}
