//! Light pipes and the compound parabolic concentrator.

use crate::probe::{Probe, assert_close, gauss_legendre, reflected};
use rayweave_math::Vec3;
use rayweave_optics::component::*;
use std::f64::consts::PI;

/// Frusta of pyramids and cones (Heron).
#[test]
fn tapered_pipes() {
    let cone = tapered_light_pipe(9.0, Aperture::circle(4.0), Aperture::circle(6.0)).unwrap();
    assert_close(Probe::new(&cone).volume_of_revolution(3.0), PI * 9.0 * 19.0 / 3.0, 1e-2);
    let (a, b) = (Aperture::rectangle(4.0, 2.0), Aperture::rectangle(6.0, 8.0));
    let probe = Probe::new(&tapered_light_pipe(9.0, a, b).unwrap());
    // the area of the section grows with the product of both sides
    let section = |z: f64| {
        let across = |direction: Vec3| {
            let hits = probe.crossings(Vec3::Z * z, direction);
            hits[1].t - hits[0].t
        };
        across(Vec3::X) * across(Vec3::Y)
    };
    let prismatoid = 9.0 / 6.0 * (8.0 + 4.0 * 25.0 + 48.0);
    assert_close(gauss_legendre(-4.5, 4.5, section), prismatoid, 1e-11);
    let hits = probe.hits(Vec3::Z * -9.0, Vec3::Z);
    assert_eq!((hits[0].face.as_str(), hits[1].face.as_str()), ("front.plane", "back.plane"));
    assert!(probe.program.bounds().is_finite());
    assert!(
        tapered_light_pipe(9.0, a, Aperture::circle(2.0)).unwrap_err().to_string().contains("two circles")
    );
}

/// Straight pipes preserve angles: a ray leaves with the slope with which it entered.
#[test]
fn straight_pipes() {
    let probe = Probe::new(&light_pipe(50.0, Aperture::rectangle(2.0, 3.0)).unwrap());
    let direction = Vec3::new(0.31, -0.17, 1.0).normalize();
    let path = probe.reflect(Vec3::new(0.2, 0.1, -25.0), direction, 10);
    assert!((path.direction.abs() - direction.abs()).length() < 1e-14);
    let round = Probe::new(&light_pipe(50.0, Aperture::circle(2.0)).unwrap());
    assert_eq!(round.hits(Vec3::new(-4.0, 0.0, 0.0), Vec3::X)[0].face, "edge.side");
}

/// The joints lie on the concentrator's equation (Welford & Winston 1989, equation 4.7):
/// `(r cos a + z sin a)^2 + 2 r' (1 + sin a)^2 r - 2 r' cos a (2 + sin a) z - r'^2 (1 + sin a) (3 + sin a) = 0`.
#[test]
fn the_profile_of_the_concentrator() {
    for (exit, degrees) in [(1.0, 30.0), (2.5, 12.0), (0.3, 65.0f64)] {
        let cpc = Cpc::new(exit, degrees, 1e-4 * exit).unwrap();
        let (s, c) = degrees.to_radians().sin_cos();
        for [r, z] in &cpc.joints {
            let value = (r * c + z * s).powi(2) + 2.0 * exit * (1.0 + s).powi(2) * r
                - 2.0 * exit * c * (2.0 + s) * z
                - exit * exit * (1.0 + s) * (3.0 + s);
            assert!(value.abs() < 1e-12 * cpc.entrance_radius.powi(2), "{value:e}");
        }
        let [first, last] = [cpc.joints[0], cpc.joints[cpc.joints.len() - 1]];
        assert_close(first[0], exit, 1e-13);
        assert_close(first[1], 0.0, 1e-13);
        assert_close(last[0], exit / s, 1e-12);
        assert_close(last[1], (exit + exit / s) / degrees.to_radians().tan(), 1e-12);
        assert!(cpc.error <= 1e-4 * exit);
    }
}

/// The documented error is a bound and is attained: the profile half-way between joints is found by
/// Newton's method on the equation above.
#[test]
fn the_error_of_the_polyline() {
    let (exit, degrees) = (1.0, 30.0f64);
    let cpc = Cpc::new(exit, degrees, 1e-3).unwrap();
    let (s, c) = degrees.to_radians().sin_cos();
    let f = |r: f64, z: f64| {
        (r * c + z * s).powi(2) + 2.0 * (1.0 + s).powi(2) * r
            - 2.0 * c * (2.0 + s) * z
            - (1.0 + s) * (3.0 + s)
    };
    let mut most = 0f64;
    for pair in cpc.joints.windows(2) {
        let ([r1, z1], [r2, z2]) = (pair[0], pair[1]);
        let length = (r2 - r1).hypot(z2 - z1);
        for k in 1..20 {
            let part = f64::from(k) / 20.0;
            let (r, z) = (r1 + part * (r2 - r1), z1 + part * (z2 - z1));
            // along the normal of the chord, outwards
            let (nr, nz) = ((z2 - z1) / length, (r1 - r2) / length);
            let mut d = 0.0;
            for _ in 0..20 {
                let slope = (f(r + (d + 1e-6) * nr, z + (d + 1e-6) * nz) - f(r + d * nr, z + d * nz)) / 1e-6;
                d -= f(r + d * nr, z + d * nz) / slope;
            }
            assert!(d > 0.0 && d <= cpc.error, "{d:e} {:e}", cpc.error);
            most = most.max(d);
        }
    }
    assert!(most > 0.8 * cpc.error, "{most:e} {:e}", cpc.error);
}

/// Meridional light within the acceptance angle leaves through the exit; light beyond it is
/// reflected back (the edge-ray principle).
#[test]
fn acceptance() {
    let cpc = Cpc::new(1.0, 30.0, 1e-5).unwrap();
    let probe = Probe::new(&cpc.solid().unwrap());
    let half = 0.5 * cpc.length;
    let exit = |degrees: f64, y: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let entry = Vec3::new(0.0, y, -half);
        let (mut point, mut direction) = (entry, Vec3::new(0.0, sin, cos));
        loop {
            let path = probe.reflect(point, direction, 0);
            match path.faces[0].as_str() {
                "back.plane" => return true,
                "front.plane" => return false,
                _ => {
                    let step = probe.reflect(point, direction, 1);
                    let hit = probe.next(point, direction, 1e-9).unwrap();
                    (point, direction) = (hit.point, step.direction);
                }
            }
        }
    };
    for k in -19..=19 {
        let y = 0.05 * f64::from(k) * cpc.entrance_radius;
        assert!(exit(29.5, y) && exit(10.0, y), "{y}");
        assert!(!exit(30.5, y) && !exit(45.0, y), "{y}");
    }
    let volume = probe.volume_of_revolution(cpc.entrance_radius);
    let frusta: f64 = cpc
        .joints
        .windows(2)
        .map(|w| PI / 3.0 * (w[1][1] - w[0][1]) * (w[0][0].powi(2) + w[0][0] * w[1][0] + w[1][0].powi(2)))
        .sum();
    assert_close(volume, frusta, 1e-3 * frusta);
}

#[test]
fn refusals() {
    let fine = Cpc::new(1.0, 30.0, 1e-12).unwrap_err().to_string();
    assert!(fine.contains("at most 4096 are allowed"), "{fine}");
    assert!(Cpc::new(1.0, 90.0, 1e-3).is_err() && Cpc::new(-1.0, 20.0, 1e-3).is_err());
}

/// The fraction of the light at an angle that leaves through the exit, for rays spread evenly over
/// the entrance.
fn transmission(cpc: &Cpc, probe: &Probe, degrees: f64, rays: u32) -> f64 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let passes = |k: &u32| {
        // a spiral with the golden angle covers a disc evenly (H. Vogel, Math. Biosci. 44, 179, 1979)
        let radius = cpc.entrance_radius * ((f64::from(*k) + 0.5) / f64::from(rays)).sqrt() * (1.0 - 1e-9);
        let angle = 2.399_963_229_728_653 * f64::from(*k);
        let mut point = Vec3::new(radius * angle.cos(), radius * angle.sin(), -0.5 * cpc.length);
        let mut direction = Vec3::new(sin, 0.0, cos);
        for _ in 0..200 {
            let Some(hit) = probe.next(point, direction, 1e-9) else { return false };
            match hit.face.as_str() {
                "back.plane" => return true,
                "front.plane" => return false,
                _ => (point, direction) = (hit.point, reflected(direction, hit.normal)),
            }
        }
        false
    };
    (0..rays).filter(passes).count() as f64 / f64::from(rays)
}

/// The concentrator of revolution passes nearly all light within the acceptance angle and nearly
/// none beyond it; between, over a few degrees, skew rays are turned back within the angle and let
/// through beyond it (W. T. Welford and R. Winston, *High Collection Nonimaging Optics*, 1989,
/// section 4.4). Etendue limits the flux of isotropic light to that of an ideal concentrator, which
/// transmits all light within the angle: `pi a^2 sin^2 = pi a'^2`.
#[test]
fn flux() {
    let acceptance = 30.0_f64;
    let cpc = Cpc::new(1.0, acceptance, 1e-3).unwrap();
    assert_close(
        (cpc.entrance_radius / cpc.exit_radius).powi(2),
        1.0 / acceptance.to_radians().sin().powi(2),
        1e-12,
    );
    let probe = Probe::new(&cpc.solid().unwrap());
    let curve: Vec<(f64, f64)> = (0..=22)
        .map(|k| 2.0 * f64::from(k) + 0.5)
        .map(|degrees| (degrees, transmission(&cpc, &probe, degrees, 160)))
        .collect();
    for &(degrees, share) in &curve {
        match degrees {
            _ if degrees < 22.0 => assert!(share > 0.97, "{degrees} {share}"),
            _ if degrees > 34.0 => assert!(share < 0.03, "{degrees} {share}"),
            _ => {}
        }
    }
    // isotropic light of equal radiance: the integral of T(theta) sin(2 theta), which etendue
    // bounds by sin^2 of the angle
    let flux: f64 = curve
        .iter()
        .map(|(degrees, share)| share * (2.0 * degrees.to_radians()).sin() * 2f64.to_radians())
        .sum();
    let most = acceptance.to_radians().sin().powi(2);
    assert!(flux < 1.01 * most && flux > 0.98 * most, "{flux} {most}");
}
