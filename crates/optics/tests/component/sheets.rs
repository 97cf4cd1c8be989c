//! Sheets: the position of the surface, and the piece inside the trim.

use crate::probe::{Probe, assert_close, numbers};
use rayweave_math::{Affine, Vec3};
use rayweave_optics::component::*;

/// The points at which a line hits the sheet: crossings of the surface inside the trim.
fn met(sheet: &Sheet, origin: Vec3, direction: Vec3) -> Vec<Vec3> {
    let trim = Probe::new(&sheet.trim);
    let hits = Probe::new(&sheet.surface).hits(origin, direction);
    hits.into_iter().map(|hit| hit.point).filter(|&point| trim.contains(point)).collect()
}

#[test]
fn stops_have_openings() {
    let stop = Sheet::stop(Aperture::rectangle(8.0, 6.0), Aperture::ellipse(4.0, 2.0)).unwrap();
    let iris = Sheet::iris(8.0, 4.0).unwrap();
    let mut counts = [0; 2];
    for k in 0..500 {
        let [u, v, w, s] = numbers(k);
        let (x, y) = (10.0 * u - 5.0, 10.0 * v - 5.0);
        let (from, slope) = (Vec3::new(x, y, 0.0), Vec3::new(w - 0.5, s - 0.5, 1.0));
        let on_stop = x.abs() < 4.0 && y.abs() < 3.0 && 0.25 * x * x + y * y > 1.0;
        let on_iris = (2.0..4.0).contains(&x.hypot(y));
        for (which, (sheet, expected)) in [(&stop, on_stop), (&iris, on_iris)].into_iter().enumerate() {
            let points = met(sheet, from - 7.0 * slope, slope);
            assert_eq!(points.len(), usize::from(expected), "{x} {y}");
            assert!(points.iter().all(|point| (point - from).length() < 1e-14));
            counts[which] += usize::from(expected);
        }
    }
    assert!(counts.iter().all(|&count| count > 100));
    let error = Sheet::iris(4.0, 8.0).unwrap_err().to_string();
    assert!(error.ends_with("Are the two swapped?"), "{error}");
}

/// Only the near half of the sphere, for all four directions of curvature.
#[test]
fn curved_sheets() {
    for radius in [10.0, -10.0] {
        for aperture in [Aperture::circle(12.0), Aperture::rectangle(10.0, 4.0)] {
            let sheet = Sheet::spherical(radius, aperture).unwrap();
            for k in 0..200 {
                let [u, v, ..] = numbers(k);
                let (x, y) = (14.0 * u - 7.0, 14.0 * v - 7.0);
                let points = met(&sheet, Vec3::new(x, y, -40.0), Vec3::Z);
                assert_eq!(points.len(), usize::from(aperture.contains([x, y])));
                for point in points {
                    let sag = radius - radius.signum() * (100.0 - x * x - y * y).sqrt();
                    assert_close(point.z, sag, 1e-13);
                }
            }
        }
        let bowl = Sheet::conic(radius, -1.0, Aperture::circle(40.0)).unwrap();
        assert_close(met(&bowl, Vec3::new(12.0, 5.0, -40.0), Vec3::Z)[0].z, 169.0 / (2.0 * radius), 1e-13);
        let tube = Sheet::cylindrical(radius, 16.0, 30.0).unwrap();
        assert_close(met(&tube, Vec3::new(8.0, 14.0, -40.0 * 1.0), Vec3::Z).len() as f64, 0.0, 0.0);
        assert_close(met(&tube, Vec3::new(6.0, 14.0, -40.0), Vec3::Z)[0].z, 0.2 * radius, 1e-13);
    }
    assert!(Sheet::spherical(10.0, Aperture::circle(21.0)).unwrap_err().to_string().contains("extends 10.5"));
    assert!(Sheet::spherical(0.0, Aperture::circle(2.0)).is_err());
    assert_eq!(
        Sheet::spherical(f64::INFINITY, Aperture::circle(2.0)).unwrap(),
        Sheet::plane(Aperture::circle(2.0)).unwrap()
    );
}

#[test]
fn placed_sheets_carry_their_frame() {
    let place = Affine::rotation(Vec3::X, 90.0).then(&Affine::translate(Vec3::new(1.0, 2.0, 3.0)));
    let sheet = Sheet::plane(Aperture::rectangle(4.0, 2.0)).unwrap().apply(&place).unwrap();
    let points = met(&sheet, Vec3::new(2.5, -5.0, 3.5), Vec3::Y);
    assert_eq!(points.len(), 1);
    let local = sheet.frame.inverse().unwrap().point(points[0]);
    assert!((local - Vec3::new(1.5, 0.5, 0.0)).length() < 1e-15, "{local}");
    assert!(met(&sheet, Vec3::new(2.5, -5.0, 4.5), Vec3::Y).is_empty());
    assert!(sheet.apply(&Affine::scale(Vec3::ZERO)).is_err());
}
