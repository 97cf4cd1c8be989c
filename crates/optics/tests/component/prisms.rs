//! Prisms: light paths, volumes, errors.

use crate::probe::{Path, Probe, assert_close, gauss_legendre, numbers};
use rayweave_math::Vec3;
use rayweave_optics::component::*;

/// The path of light along +z that enters the clear square of a prism and is reflected `times`
/// times.
fn through(probe: &Probe, side: f64, k: usize, times: usize) -> ([f64; 2], Path) {
    let [u, v, ..] = numbers(k);
    let (x, y) = (0.99 * side * (u - 0.5), 0.99 * side * (v - 0.5));
    let entry = &probe.hits(Vec3::new(x, y, -5.0 * side), Vec3::Z)[0];
    assert_eq!(entry.face, "front.plane");
    ([x, y], probe.reflect(entry.point, Vec3::Z, times))
}

#[test]
fn right_angles() {
    let probe = Probe::new(&right_angle_prism(4.0, 4.0).unwrap());
    for k in 0..100 {
        let ([x, y], path) = through(&probe, 4.0, k, 1);
        assert_eq!(path.faces, ["hypotenuse.plane", "exit.plane"]);
        assert!((path.direction - Vec3::Y).length() < 1e-15);
        assert_close(path.length, 4.0, 1e-14);
        assert!((path.point - Vec3::new(x, 2.0, y)).length() < 1e-14);
    }
}

/// Deviation by 90 degrees after a path of (2 + sqrt 2) sides, even if the prism is tilted in the
/// plane of the drawing.
#[test]
fn penta_prisms() {
    let solid = penta_prism(4.0, 4.0).unwrap();
    let probe = Probe::new(&solid);
    for k in 0..100 {
        let (_, path) = through(&probe, 4.0, k, 2);
        assert_eq!(path.faces, ["mirror1.plane", "mirror2.plane", "exit.plane"]);
        assert!((path.direction + Vec3::Y).length() < 1e-15);
        assert_close(path.length, 4.0 * (2.0 + 2f64.sqrt()), 1e-14);
    }
    let tilted = Probe::new(&solid.rotate_x(3.0)).reflect(Vec3::Z * -1.0, Vec3::Z, 2);
    assert_eq!(tilted.faces.len(), 3);
    assert!((tilted.direction + Vec3::Y).length() < 1e-15);
}

#[test]
fn amici_prisms() {
    let probe = Probe::new(&amici_prism(4.0).unwrap());
    for k in 0..400 {
        let [u, v, ..] = numbers(k);
        let (sin, cos) = (6.3 * v).sin_cos();
        let (x, y) = (1.999 * u.sqrt() * cos, 1.999 * u.sqrt() * sin);
        let entry = &probe.hits(Vec3::new(x, y, -9.0), Vec3::Z)[0];
        let path = probe.reflect(entry.point, Vec3::Z, 2);
        let roofs = if x > 0.0 { ["roof1.plane", "roof2.plane"] } else { ["roof2.plane", "roof1.plane"] };
        assert_eq!(path.faces, [roofs[0], roofs[1], "exit.plane"]);
        assert!((path.direction - Vec3::Y).length() < 1e-15);
        assert_close(path.length, 4.0 * 3f64.sqrt(), 1e-14);
        assert!((path.point - Vec3::new(-x, 2.0 * 3f64.sqrt(), y)).length() < 1e-14);
    }
}

/// Every ray that enters the inscribed circle leaves antiparallel, for any direction.
#[test]
fn corner_cubes() {
    let depth = 3.0;
    let probe = Probe::new(&corner_cube(depth).unwrap());
    for k in 0..200 {
        let [u, v, a, b] = numbers(k);
        let (sin, cos) = (6.3 * v).sin_cos();
        let entry = Vec3::new(cos, sin, 0.0) * (u * 0.99 * depth / 2f64.sqrt());
        let straight = probe.reflect(entry, Vec3::Z, 3);
        assert_eq!((straight.faces.len(), straight.faces[3].as_str()), (4, "front.plane"));
        assert!((straight.direction + Vec3::Z).length() < 2e-15);
        assert!((straight.point + entry).length() < 1e-14);
        assert_close(straight.length, 2.0 * depth, 1e-14);
        let direction = Vec3::new(0.2 * (a - 0.5), 0.2 * (b - 0.5), 1.0).normalize();
        let tilted = probe.reflect(entry * 0.7, direction, 3);
        assert!((tilted.direction + direction).length() < 2e-15);
    }
    let axis = probe.hits(Vec3::new(0.01, 0.02, -9.0), Vec3::Z);
    assert_close(axis[1].point.z, depth, 0.04);
}

/// Sides at the apex angle, volume, and the axis at half height.
#[test]
fn dispersing_prisms() {
    let probe = Probe::new(&equilateral_prism(6.0, 5.0).unwrap());
    let faces = probe.hits(Vec3::new(0.0, 0.5, -9.0), Vec3::Z);
    assert_eq!([&faces[0].face, &faces[1].face], ["front.plane", "back.plane"]);
    assert_close(faces[0].normal.dot(faces[1].normal), -0.5, 1e-15);
    let height = 27f64.sqrt();
    let section = gauss_legendre(-0.5 * height, 0.5 * height, |y| probe.chord(0.0, y));
    assert_close(section * 5.0, 5.0 * 9.0 * 3f64.sqrt(), 1e-12);
    let base = probe.hits(Vec3::new(0.0, -9.0, 0.0), Vec3::Y);
    assert_eq!(base[0].face, "base.plane");
    assert_close(base[0].point.y, -0.5 * height, 1e-15);
    let bounds = probe.program.bounds();
    assert!(bounds.is_finite() && bounds.hi.z < 4.0, "{bounds:?}");
    let wide = Probe::new(&dispersing_prism(100.0, 2.0, 1.0).unwrap());
    assert_close(wide.hits(Vec3::new(0.0, 0.0, -9.0), Vec3::Z)[1].t - 9.0, 50f64.to_radians().sin(), 1e-15);
    assert!(dispersing_prism(180.0, 2.0, 1.0).is_err());
}

/// With the length of [`dove_length`] the beam of full height leaves by the back, inverted.
#[test]
fn dove_prisms() {
    for index in [1.4, 1.5168, 1.9] {
        let height = 3.0;
        let length = dove_length(height, index).unwrap();
        let probe = Probe::new(&dove_prism(height, length, 4.0).unwrap());
        for k in 0..50 {
            let y = height * (numbers(k)[0] - 0.5) * 0.999;
            let entry = &probe.hits(Vec3::new(0.0, y, -20.0), Vec3::Z)[0];
            // Snell at 45 degrees
            let inside = 45f64.to_radians() - (0.5f64.sqrt() / index).asin();
            let direction = Vec3::new(0.0, -inside.sin(), inside.cos());
            let path = probe.reflect(entry.point, direction, 1);
            assert_eq!(path.faces, ["base.plane", "back.plane"], "{index} {y}");
            assert_close(path.point.y, -y, 1e-13);
        }
    }
    let short = dove_prism(3.0, 5.0, 1.0).unwrap_err().to_string();
    assert!(
        short.starts_with("length of the Dove prism is 5 and its height 3:") && short.ends_with('?'),
        "{short}"
    );
    assert!(dove_length(1.0, 0.9).unwrap_err().to_string().starts_with("index of the Dove prism is 0.9:"));
}

/// The mean thickness of a wedge over a symmetric aperture is that on the axis.
#[test]
fn wedges() {
    let solid = wedge_prism(5.0, 2.0, Aperture::rectangle(8.0, 6.0)).unwrap();
    let probe = Probe::new(&solid);
    let tan = 5f64.to_radians().tan();
    assert_close(probe.chord(0.0, -2.9), 2.0 + 2.9 * tan, 1e-14);
    assert_close(gauss_legendre(-3.0, 3.0, |y| 8.0 * probe.chord(0.0, y)), 96.0, 1e-11);
    let thin = wedge_prism(60.0, 2.0, Aperture::circle(4.0)).unwrap_err().to_string();
    assert!(thin.contains("cross inside the aperture, 1.1547 from"), "{thin}");
}

#[test]
fn beam_splitters_share_their_face() {
    let probe = Probe::regions(&beam_splitter_cube(2.0).unwrap());
    for k in 0..1000 {
        let [u, v, w, s] = numbers(k);
        let from = Vec3::new(1.9 * u - 0.95, 1.9 * v - 0.95, -3.0);
        let direction = Vec3::new(0.02 * (w - 0.5), 0.02 * (s - 0.5), 1.0);
        let media: Vec<u32> =
            probe.crossings(from, direction).iter().map(|c| probe.program.medium_of(c.after)).collect();
        assert_eq!(media, [1, 2, 0]);
    }
    let hits = probe.hits(Vec3::new(0.0, 0.3, -3.0), Vec3::Z);
    assert_eq!([&hits[0].face, &hits[1].face, &hits[2].face], ["front.plane", "split.plane", "back.plane"]);
    assert_eq!([hits[0].t, hits[2].t], [2.0, 4.0]);
    assert_close(hits[1].t, 3.3, 1e-15);
}
