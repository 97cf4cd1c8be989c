//! Toric lenses.

use crate::probe::{Probe, assert_close, numbers};
use rayweave_math::Vec3;
use rayweave_optics::component::*;

const INF: f64 = f64::INFINITY;

/// A root of the equation of a torus: the circle of the smaller radius, rotated about an axis at
/// the greater one.
fn height([rx, ry]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
    let ((r, p), (turn, q)) = if rx.abs() <= ry.abs() { ((rx, x), (ry, y)) } else { ((ry, y), (rx, x)) };
    if r.is_infinite() {
        return 0.0;
    }
    let sag = r - r.signum() * (r * r - p * p).sqrt();
    if turn.is_infinite() {
        return sag;
    }
    turn - turn.signum() * ((turn - sag) * (turn - sag) - q * q).sqrt()
}

/// Random lenses with rings, spindles, saddles, cylinders and spheres: a point is inside if it is between both surfaces.
#[test]
fn membership() {
    let radius = |u: f64| [12.0, -12.0, 18.0, -18.0, 40.0, -40.0, 300.0, INF][(8.0 * u) as usize];
    let (mut made, mut inside) = (0, 0);
    for k in 0..600 {
        let ([a, b, c, d], [e, f, ..]) = (numbers(2 * k), numbers(2 * k + 1));
        let (front, back) = ([radius(a), radius(b)], [radius(c), radius(d)]);
        let thickness = 0.5 + if k % 3 == 0 { 30.0 * e } else { 4.0 * e };
        let aperture = match k % 2 {
            0 => Aperture::circle(2.0 + 12.0 * f),
            _ => Aperture::rectangle(2.0 + 10.0 * f, 7.0),
        };
        let Ok(solid) = toric_lens(front, back, thickness, aperture) else { continue };
        made += 1;
        let probe = Probe::new(&solid);
        let [width, tall] = aperture.size();
        for j in 0..200 {
            let [u, v, w, _] = numbers(1000 * k + j);
            let (x, y) = (1.2 * width * (u - 0.5), 1.2 * tall * (v - 0.5));
            let z = (thickness + 60.0 * (j % 2) as f64 + 4.0) * (w - 0.5);
            let expected = aperture.contains([x, y])
                && z > -0.5 * thickness + height(front, [x, y])
                && z < 0.5 * thickness + height(back, [x, y]);
            inside += u32::from(expected);
            assert_eq!(
                probe.contains(Vec3::new(x, y, z)),
                expected,
                "{front:?} {back:?} {thickness} {x} {y} {z}"
            );
        }
    }
    assert!(made > 300 && inside > 8000, "{made} {inside}");
}

#[test]
fn hits() {
    let (front, back) = ([30.0, 50.0], [-80.0, 20.0]);
    let probe = Probe::new(&toric_lens(front, back, 5.0, Aperture::circle(16.0)).unwrap());
    for k in 0..200 {
        let [u, v, ..] = numbers(k);
        let (sin, cos) = (6.3 * v).sin_cos();
        let (x, y) = (7.9 * u * cos, 7.9 * u * sin);
        let hits = probe.hits(Vec3::new(x, y, -60.0), Vec3::Z);
        let faces: Vec<_> = hits.iter().map(|hit| hit.face.as_str()).collect();
        assert_eq!(faces, ["front.side", "back.side"]);
        assert_close(hits[0].point.z, -2.5 + height(front, [x, y]), 1e-12);
        assert_close(hits[1].point.z, 2.5 + height(back, [x, y]), 1e-12);
    }
}

/// A toric lens that is a sphere or a cylinder is the same as a lens of that form.
#[test]
fn simple_torics() {
    let aperture = Aperture::circle(10.0);
    assert_eq!(
        toric_lens([30.0, 30.0], [-40.0, -40.0], 4.0, aperture).unwrap().to_string(),
        lens(30.0, -40.0, 4.0, aperture).unwrap().to_string()
    );
    let probe = Probe::new(&toric_lens([INF, 20.0], [INF, INF], 4.0, aperture).unwrap());
    assert_close(probe.chord(3.9, 3.0), 4.0 - 20.0 + 391f64.sqrt(), 1e-14);
}

#[test]
fn refusals() {
    let message = |front, thickness| {
        toric_lens(front, [INF, INF], thickness, Aperture::circle(20.0)).unwrap_err().to_string()
    };
    assert!(message([0.0, 20.0], 2.0).starts_with("front radius along x of the toric lens is 0:"));
    assert!(message([9.0, 20.0], 5.0).contains("extends 10 from the axis: the front surface ends 9"));
    assert!(
        message([15.0, 90.0], 2.0)
            .contains("surfaces front and back of the toric lens cross inside the aperture")
    );
    assert!(message([15.0, 90.0], -2.0).contains("Did you mean 2?"));
}
