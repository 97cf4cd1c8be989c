//! Lenses: volumes, hits, membership, shared surfaces, errors.

use crate::probe::{Probe, assert_close, numbers};
use rayweave_math::Vec3;
use rayweave_optics::component::*;
use std::f64::consts::PI;

const INF: f64 = f64::INFINITY;

/// The volume between the vertex plane of a sphere and the sphere, up to a radius: the cylinder
/// minus the cap h^2 (3 R - h) pi / 3 (Archimedes).
fn below_sphere(radius: f64, reach: f64) -> f64 {
    if radius.is_infinite() {
        return 0.0;
    }
    let (r, sign) = (radius.abs(), radius.signum());
    let h = r - (r * r - reach * reach).sqrt();
    sign * (PI * reach * reach * h - PI * h * h * (3.0 * r - h) / 3.0)
}

#[test]
fn volumes() {
    let cases = [
        (50.0, -50.0, 6.0, 25.0),
        (-40.0, 60.0, 2.0, 30.0),
        (30.0, 45.0, 4.0, 20.0),
        (-30.0, -25.0, 3.0, 18.0),
        (INF, -20.0, 5.0, 12.0),
        (-INF, 20.0, 5.0, 12.0),
        (INF, INF, 2.0, 10.0),
    ];
    for (r1, r2, thickness, diameter) in cases {
        let solid = lens(r1, r2, thickness, Aperture::circle(diameter)).unwrap();
        let reach = 0.5 * diameter;
        let exact = PI * reach * reach * thickness - below_sphere(r1, reach) + below_sphere(r2, reach);
        let found = Probe::new(&solid).volume_of_revolution(reach);
        assert_close(found, exact, 1e-10 * exact);
    }
}

/// A ray parallel to the axis hits a sphere at `c - sign R sqrt(R^2 - h^2)`, with its normal along
/// the radius.
#[test]
fn hits_on_spheres() {
    let probe = Probe::new(&lens(30.0, -45.0, 7.0, Aperture::circle(20.0)).unwrap());
    let centres = [Vec3::Z * 26.5, Vec3::Z * -41.5];
    for k in 0..200 {
        let [u, v, ..] = numbers(k);
        let (sin, cos) = (6.3 * v).sin_cos();
        let (x, y) = (9.9 * u * cos, 9.9 * u * sin);
        let hits = probe.hits(Vec3::new(x, y, -100.0), Vec3::Z);
        let faces: Vec<_> = hits.iter().map(|hit| hit.face.as_str()).collect();
        assert_eq!(faces, ["front.side", "back.side"]);
        let square = x * x + y * y;
        assert_close(hits[0].t, 126.5 - (900.0 - square).sqrt(), 1e-13);
        assert_close(hits[1].t, 58.5 + (2025.0 - square).sqrt(), 1e-13);
        for (hit, (centre, radius)) in hits.iter().zip([(centres[0], 30.0), (centres[1], 45.0)]) {
            assert!((hit.normal - (hit.point - centre) / radius).length() < 1e-14);
        }
    }
}

/// Rays from the side hit the rim, which belongs to `edge`; there is nothing else, near or far.
#[test]
fn rims() {
    let probe = Probe::new(&lens(-20.0, 20.0, 2.0, Aperture::circle(30.0)).unwrap());
    for z in [-5.0, -2.0, 0.0, 5.0] {
        let hits = probe.hits(Vec3::new(-50.0, 0.0, z), Vec3::X);
        assert_eq!((hits[0].face.as_str(), hits[0].point.x), ("edge.side", -15.0), "{z}");
        assert_eq!(hits.last().unwrap().point.x, 15.0);
        // in the open part of the dish, the ray also hits its surface
        assert_eq!(hits.len(), if z.abs() < 1.0 { 2 } else { 4 });
    }
    // the far halves of the spheres are not part of it
    for z in [-41.5, -30.0, -7.8, 7.8, 30.0, 41.5] {
        assert!(probe.crossings(Vec3::new(-50.0, 0.3, z), Vec3::X).is_empty(), "{z}");
    }
    let plate = Probe::new(&window(2.0, Aperture::rectangle(6.0, 4.0)).unwrap());
    assert_eq!(plate.hits(Vec3::new(-9.0, 0.0, 0.0), Vec3::X)[0].face, "edge.x-");
    assert_eq!(plate.chord(0.0, 1.9), 2.0);
    assert_eq!(plate.program.bounds().hi, Vec3::new(3.0, 2.0, 1.0));
}

/// A root of the conic's equation `h^2 + (1 + k) z^2 = 2 R z` by the quadratic formula, independent
/// of the formula for the sag.
fn conic_height(radius: f64, conic: f64, height: f64) -> f64 {
    match (radius.is_infinite(), conic == -1.0) {
        (true, _) => 0.0,
        (_, true) => height * height / (2.0 * radius),
        _ => {
            let turn = 1.0 + conic;
            (radius - radius.signum() * (radius * radius - turn * height * height).sqrt()) / turn
        }
    }
}

/// Random lenses of all kinds of conics, thick and thin: a point is inside if it is between the surfaces and in the aperture.
#[test]
fn membership() {
    let radius = |u: f64, v: f64| {
        let size = 6.0 + 20.0 * u;
        [size, -size, INF][(3.0 * v) as usize]
    };
    let conic = |u: f64| [0.0, -1.0, -0.5, -2.5, 0.8][(5.0 * u) as usize];
    let (mut made, mut inside) = (0, 0);
    for k in 0..400 {
        let ([a, b, c, d], [e, f, g, h]) = (numbers(2 * k), numbers(2 * k + 1));
        let (r1, r2, k1, k2) = (radius(a, b), radius(c, d), conic(e), conic(f));
        let thickness = 0.5 + if k % 3 == 0 { 40.0 * g } else { 4.0 * g };
        let aperture = match k % 3 {
            0 => Aperture::circle(1.0 + 8.0 * h),
            1 => Aperture::rectangle(1.0 + 4.0 * h, 4.0),
            _ => Aperture::ellipse(1.0 + 8.0 * h, 5.0),
        };
        let Ok(solid) = conic_lens(r1, k1, r2, k2, thickness, aperture) else { continue };
        made += 1;
        let probe = Probe::new(&solid);
        let [width, height] = aperture.size();
        for j in 0..200 {
            let [u, v, w, _] = numbers(1000 * k + j);
            let (x, y) = (1.2 * width * (u - 0.5), 1.2 * height * (v - 0.5));
            let z = (thickness + 60.0 * (j % 2) as f64 + 4.0) * (w - 0.5);
            let across = x.hypot(y);
            let expected = aperture.contains([x, y])
                && z > -0.5 * thickness + conic_height(r1, k1, across)
                && z < 0.5 * thickness + conic_height(r2, k2, across);
            inside += u32::from(expected);
            assert_eq!(probe.contains(Vec3::new(x, y, z)), expected, "{solid} at {x} {y} {z}");
        }
    }
    assert!(made > 200 && inside > 5000, "{made} {inside}");
}

#[test]
fn cylinders_balls_and_rods() {
    let cylinder = Probe::new(&cylindrical_lens(20.0, INF, 3.0, 10.0, 30.0).unwrap());
    for (x, y) in [(0.0, 14.9), (3.0, -14.0), (-4.9f64, 0.0)] {
        assert_close(cylinder.chord(x, y), 3.0 - 20.0 + (400.0 - x * x).sqrt(), 1e-14);
    }
    assert!(cylinder.crossings(Vec3::new(0.0, 15.1, -9.0), Vec3::Z).is_empty());
    assert_close(Probe::new(&ball_lens(8.0).unwrap()).volume_of_revolution(4.0), 256.0 / 3.0 * PI, 1e-2);
    let half = Probe::new(&half_ball_lens(8.0).unwrap());
    let hits = half.hits(Vec3::new(2.0, 0.0, -9.0), Vec3::Z);
    assert_eq!((hits[0].face.as_str(), hits[1].face.as_str(), hits[1].t), ("front.side", "back.plane", 9.0));
    assert_close(hits[0].t, 9.0 - 12f64.sqrt(), 1e-15);
    assert_close(Probe::new(&rod(2.0, 9.0).unwrap()).volume_of_revolution(1.0), 9.0 * PI, 1e-12);
    // balls at both ends of a rod: the far halves of the spheres lie inside it
    let ends = Probe::new(&lens(3.0, -3.0, 30.0, Aperture::circle(6.0)).unwrap());
    assert_close(ends.chord(2.4, 0.0), 30.0 - 2.0 * 1.2, 1e-14);
    assert_close(ends.volume_of_revolution(2.999), 24.0 * PI * 9.0 + 36.0 * PI, 0.5);
}

/// A cone takes a third of the cylinder around it; 30 degrees are a slope of 1 / sqrt(3).
#[test]
fn axicons() {
    let probe = Probe::new(&axicon(30.0, 9.0, 12.0).unwrap());
    let drop = 6.0 / 3f64.sqrt();
    assert_close(probe.volume_of_revolution(6.0), PI * 36.0 * (9.0 - drop + drop / 3.0), 1e-11);
    let hit = &probe.hits(Vec3::new(0.0, 1.0, -9.0), Vec3::Z)[1];
    assert_eq!(hit.face, "back.side");
    assert!((hit.normal - Vec3::new(0.0, 0.5, 0.75f64.sqrt())).length() < 1e-15);
    assert!(axicon(60.0, 9.0, 12.0).unwrap_err().to_string().contains("cross inside the aperture, 5.196"));
    assert!(
        axicon(95.0, 9.0, 12.0).unwrap_err().to_string().starts_with("cone_degrees of the axicon is 95:")
    );
}

#[test]
fn cemented_elements_share_their_surfaces() {
    let radii = [62.8, -45.7, -128.2, 80.0, INF];
    let elements = cemented(&radii, &[6.0, 2.5, 4.0, 3.0], Aperture::circle(25.0)).unwrap();
    let probe = Probe::regions(&elements);
    // four faces inside each of two elements, five optical surfaces and one rim
    let surface = |element: u32, name: &str| {
        let leaf = probe.program.leaves().filter(|leaf| leaf.face_name(0).starts_with(name));
        leaf.map(|leaf| leaf.facets()[0].surface()).nth(element as usize).unwrap()
    };
    for element in 0..3 {
        assert_eq!(surface(element, "back"), surface(element + 1, "front"), "{element}");
    }
    let mut met = [0; 4];
    for k in 0..20_000 {
        let [u, v, w, s] = numbers(k);
        let from = Vec3::new(16.0 * u - 8.0, 16.0 * v - 8.0, -20.0);
        let to = Vec3::new(16.0 * w - 8.0, 16.0 * s - 8.0, 20.0);
        let media: Vec<u32> = probe
            .crossings(from, to - from)
            .iter()
            .map(|crossing| probe.program.medium_of(crossing.after))
            .collect();
        assert_eq!(media, [1, 2, 3, 4, 0]);
        met[media.len() - 2] += 1;
    }
    assert_eq!(met, [0, 0, 0, 20_000]);
}

#[test]
fn refusals() {
    let message = |r1, r2, thickness, diameter| {
        lens(r1, r2, thickness, Aperture::circle(diameter)).unwrap_err().to_string()
    };
    assert_eq!(
        message(50.0, 50.0, -1.0, 10.0),
        "thickness of the lens is -1: it must be finite and greater than 0. Did you mean 1?"
    );
    assert!(message(50.0, 50.0, 0.0, 10.0).starts_with("thickness of the lens is 0:"));
    assert!(message(0.0, 50.0, 1.0, 10.0).starts_with("r1 of the lens is 0: a radius of curvature"));
    assert!(message(50.0, f64::NAN, 1.0, 10.0).starts_with("r2 of the lens is NaN:"));
    assert!(message(50.0, 50.0, INF, 10.0).starts_with("thickness of the lens is inf:"));
    assert_eq!(
        message(50.0, 4.0, 1.0, 10.0),
        "the aperture of the lens extends 5 from the axis: the back surface ends 4 from it. Is a diameter given as a radius?"
    );
    // a meniscus: the sags 50 - sqrt(2500 - h^2) and 10 - sqrt(100 - h^2) differ by 1 where they cross
    let problem = lens(10.0, 50.0, 1.0, Aperture::circle(18.0)).unwrap_err();
    let crossing = problem.to_string();
    let ComponentError::SurfacesCross { height, .. } = problem else { panic!("{crossing}") };
    let difference = (10.0 - (100.0 - height * height).sqrt()) - (50.0 - (2500.0 - height * height).sqrt());
    assert_close(difference, 1.0, 1e-12);
    assert!(crossing.contains("surfaces front and back of the lens cross inside the aperture"), "{crossing}");
    // a sharp edge is not a crossing
    let sharp = (50.0f64 * 50.0 - 49.0 * 49.0).sqrt();
    assert!(lens(50.0, -50.0, 2.0, Aperture::circle(2.0 * sharp)).is_ok());
    assert!(message(50.0, -50.0, 2.0, 2.0 * sharp + 1e-9).contains("cross"));
    let counts = cemented(&[1.0, 2.0], &[1.0, 1.0], Aperture::circle(1.0)).unwrap_err().to_string();
    assert!(counts.starts_with("cemented lens has 2 radii and 2 thicknesses:"), "{counts}");
    let inner = cemented(&[50.0, -20.0, -10.0], &[4.0, 1.0], Aperture::circle(16.0)).unwrap_err().to_string();
    assert!(inner.contains("surfaces radii[1] and radii[2] of the cemented lens cross"), "{inner}");
}

/// The thickness of two conics may be least between axis and rim.
#[test]
fn conics_that_cross_in_the_middle_only() {
    // slopes h / R and h / sqrt(r^2 - h^2) agree at h^2 = R^2 - r^2 (over -1 - 0): paraboloid against sphere
    let (big, small) = (10.0f64, 9.0f64);
    let middle = (big * big - small * small).sqrt().min(8.0);
    let front = conic_height(small, -1.0, 4.0);
    let back = conic_height(big, 0.0, 4.0);
    assert!(front > back);
    let at = |h: f64| conic_height(big, 0.0, h) - conic_height(small, -1.0, h);
    let least = (0..=800).map(|k| at(0.01 * k as f64)).fold(INF, f64::min);
    assert!(least < at(8.0).min(0.0) && middle < 8.0);
    let make = |thickness| conic_lens(small, -1.0, big, 0.0, thickness, Aperture::circle(16.0));
    assert!(make(-least + 1e-4).is_ok());
    assert!(make(-least - 1e-4).unwrap_err().to_string().contains("cross"));
}

/// Nearly plane surfaces, whose centres are far away: the error of heights is a few roundings of
/// the radius.
#[test]
fn weak_curvatures() {
    for radius in [1e3, 1e5, 1e6, 1e8] {
        let probe = Probe::new(&lens(radius, -radius, 3.0, Aperture::circle(20.0)).unwrap());
        for k in 0..100 {
            let height = 9.9 * numbers(k)[0];
            let ratio = height / radius;
            let sag = height * ratio / (1.0 + (1.0 - ratio * ratio).sqrt());
            assert_close(probe.chord(height, 0.0), 3.0 - 2.0 * sag, 4e-16 * radius);
        }
    }
}
