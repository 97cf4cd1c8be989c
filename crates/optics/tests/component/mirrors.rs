//! Mirrors: foci, positions, off-axis pieces.

use crate::probe::{Probe, assert_close, numbers, reflected};
use rayweave_math::Vec3;
use rayweave_optics::component::*;

/// A point of the aperture.
fn target(blank: &Blank, k: usize) -> [f64; 2] {
    let ([u, v, ..], [width, height]) = (numbers(k), blank.aperture.size());
    [blank.off_axis[0] + 0.7 * width * (u - 0.5), blank.off_axis[1] + 0.7 * height * (v - 0.5)]
}

/// The distance of the reflected ray from a point.
fn miss(probe: &Probe, origin: Vec3, direction: Vec3, focus: Vec3) -> f64 {
    let hit = probe.next(origin, direction, 0.0).unwrap();
    assert_eq!(hit.face, "front.side");
    reflected(direction.normalize(), hit.normal).cross(focus - hit.point).length()
}

fn blanks() -> [Blank; 4] {
    let round = Blank::new(Aperture::circle(20.0), 4.0);
    [
        round,
        round.off_axis(12.0, -25.0),
        Blank::new(Aperture::rectangle(10.0, 16.0), 2.0).off_axis(0.0, 30.0),
        Blank::new(Aperture::ellipse(10.0, 16.0), 2.0).off_axis(-8.0, 0.0),
    ]
}

/// A parabola reflects every ray parallel to its axis through its focus.
#[test]
fn paraboloids() {
    for blank in blanks() {
        for (blank, side) in [(blank, -1.0), (blank.turned(), 1.0)] {
            let probe = Probe::new(&parabolic_mirror(40.0, &blank).unwrap());
            for k in 0..100 {
                let [x, y] = target(&blank, k);
                let from = Vec3::new(x, y, side * 200.0);
                let off = miss(&probe, from, -side * Vec3::Z, side * Vec3::Z * 40.0);
                assert!(off < 1e-13 * 200.0, "{off:e}");
            }
        }
    }
}

/// An ellipsoid images one focus to the other, a hyperboloid the focus behind it to the one in
/// front.
#[test]
fn two_foci() {
    for blank in blanks() {
        let (near, far) = (Vec3::Z * -40.0, Vec3::Z * -90.0);
        let ellipsoid = Probe::new(&elliptic_mirror(40.0, 90.0, &blank).unwrap());
        let hyperboloid =
            Probe::new(&hyperbolic_mirror(30.0, 120.0, &Blank { thickness: 25.0, ..blank }).unwrap());
        for k in 0..100 {
            let [x, y] = target(&blank, k);
            let on_ellipsoid = ellipsoid.hits(Vec3::new(x, y, -30.0), Vec3::Z)[0].point;
            let off = miss(&ellipsoid, near, on_ellipsoid - near, far);
            assert!(off < 2e-13 * 90.0, "{off:e}");
            // towards the focus behind, stopped by the mirror
            let on_hyperboloid = hyperboloid.hits(Vec3::new(x, y, -30.0), Vec3::Z)[0].point;
            let aim = Vec3::Z * 30.0 - on_hyperboloid;
            let off = miss(&hyperboloid, on_hyperboloid - aim, aim, Vec3::Z * -120.0);
            assert!(off < 2e-13 * 120.0, "{off:e}");
        }
    }
}

#[test]
fn spheres_reflect_radii_back_and_face_as_requested() {
    let blank = Blank::new(Aperture::circle(20.0), 4.0).off_axis(0.0, 15.0);
    for radius in [-50.0, 50.0] {
        for (blank, side) in [(blank, -1.0), (blank.turned(), 1.0)] {
            // the sag of a convex mirror must stay in front of the back
            let thickness = if radius * side < 0.0 { 10.0 } else { 4.0 };
            let probe = Probe::new(&spherical_mirror(radius, &Blank { thickness, ..blank }).unwrap());
            let centre = Vec3::Z * radius;
            for k in 0..50 {
                let [x, y] = target(&blank, k);
                let hit = probe.next(Vec3::new(x, y, side * 30.0), -side * Vec3::Z, 0.0).unwrap();
                assert_eq!(hit.face, "front.side");
                let square = x * x + y * y;
                assert_close(hit.point.z, radius - radius.signum() * (2500.0 - square).sqrt(), 1e-13);
                assert!(hit.normal.cross(hit.point - centre).length() < 1e-13 && hit.normal.z * side > 0.0);
            }
            let back = probe.next(Vec3::new(0.0, 15.0, -side * 30.0), side * Vec3::Z, 0.0).unwrap();
            assert_eq!((back.face.as_str(), back.point.z), ("back.plane", -side * thickness));
        }
    }
}

#[test]
fn planes() {
    let probe =
        Probe::new(&plane_mirror(&Blank::new(Aperture::circle(2.0), 1.0).off_axis(3.0, 0.0)).unwrap());
    let hits = probe.hits(Vec3::new(3.5, 0.0, -4.0), Vec3::Z);
    assert_eq!((hits[0].face.as_str(), hits[0].t, hits[1].t), ("front.plane", 4.0, 5.0));
    assert!(probe.crossings(Vec3::new(0.0, 0.0, -4.0), Vec3::Z).is_empty());
    assert_eq!(probe.program.bounds().lo.x, 2.0);
}

#[test]
fn refusals() {
    let blank = Blank::new(Aperture::circle(20.0), 1.0);
    let message = |radius, blank: Blank| spherical_mirror(radius, &blank).unwrap_err().to_string();
    assert!(message(-9.0, blank).contains("extends 10 from the axis: the front surface ends 9"));
    assert!(message(-30.0, blank.off_axis(0.0, 25.0)).contains("extends 35"));
    // convex and too thin: cut by its back at the sag 1
    let crossing = message(20.0, blank);
    assert!(crossing.contains("cross inside the aperture, 6.245 from"), "{crossing}");
    assert!(message(-30.0, Blank { thickness: 0.0, ..blank }).starts_with("thickness of the mirror is 0:"));
    assert!(message(-30.0, blank.off_axis(f64::NAN, 0.0)).starts_with("off_axis x of the mirror is NaN:"));
    assert!(parabolic_mirror(-3.0, &blank).unwrap_err().to_string().contains("Did you mean 3?"));
    let exchanged = hyperbolic_mirror(5.0, 4.0, &blank).unwrap_err().to_string();
    assert!(exchanged.ends_with("Are the two swapped?"), "{exchanged}");
}
