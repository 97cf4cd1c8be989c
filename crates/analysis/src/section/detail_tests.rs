//! Sections with very many corners and crossings, compared with closed forms, and their work.

use super::*;
use rayweave_math::Vec3;
use rayweave_model::{Program, Solid};
use rayweave_polygon::{Corner, Outline, Vertex};
use rayweave_rootray::Side;
use rayweave_shape::primitive::{Cylinder, Primitive};
use rayweave_trace::Weave;
use std::f64::consts::{PI, TAU};
use std::num::NonZeroUsize;
use std::sync::Arc;

/// The section of a solid at z = 0 within a square, and the number of crossings of its scan lines.
fn cut_counted(solid: &Solid, half: f64, threads: usize) -> (Section, u64) {
    let weave = Weave::new(Arc::new(Program::compile(solid).unwrap()));
    let plane = Cut::new(Vec3::ZERO, Vec3::X, Vec3::Y).unwrap();
    let run = SectionRun { threads: NonZeroUsize::new(threads), ..SectionRun::default() };
    let window = SectionWindow::new([-half; 2], [half; 2]);
    let (section, crossings) = counted_section(&weave, &plane, &window, &run).unwrap();
    (section.simplified(window.tolerance), crossings)
}

/// A prism around z = 0 over corners at these radii, evenly spaced.
fn prism(radii: &[f64]) -> Solid {
    let corner = |(k, radius): (usize, &f64)| {
        let (sin, cos) = libm::sincos(TAU * k as f64 / radii.len() as f64);
        Vertex { at: [radius * cos, radius * sin], bulge: 0.0, corner: Corner::Sharp }
    };
    let corners = radii.iter().enumerate().map(corner).collect();
    Outline::new(&[corners]).unwrap().extrude(-1.0, 1.0, [Default::default(); 2]).unwrap()
}

/// The area of a polygon with corners at these radii, evenly spaced.
fn area(radii: &[f64]) -> f64 {
    let pairs = radii.iter().zip(radii.iter().cycle().skip(1)).map(|(a, b)| a * b);
    0.5 * (TAU / radii.len() as f64).sin() * pairs.sum::<f64>()
}

/// Each corner is found, and costs a few crossings: not those of whole scan lines, and not as many as a bisection.
#[test]
fn corners_are_exact_and_cheap() {
    let ragged = |k: u64| 10.0 + (k * 7919 % 1009) as f64 / 1009.0;
    let shapes: [(&str, fn(u64) -> f64); 3] =
        [("disc", |_| 10.0), ("star", |k| 10.0 + 10.0 * (k % 2) as f64), ("ragged disc", ragged)];
    for (name, radius) in shapes {
        let radii: Vec<f64> = (0..4000).map(radius).collect();
        let (section, crossings) = cut_counted(&prism(&radii), 21.0, 2);
        let expected = area(&radii);
        let found = section.area(RegionId(1));
        assert!((found - expected).abs() < 1e-9 * expected, "{name}: {found} {expected}");
        let [contour] = &section.contours(RegionId(1))[..] else { panic!("{name}: one contour") };
        let off = contour.iter().map(|[x, y]| {
            // the nearest corner, or one of its neighbours
            let nearest = (libm::atan2(*y, *x) / TAU * 4000.0).round() as i64;
            let distance = |k: i64| {
                let k = k.rem_euclid(4000);
                let (sin, cos) = libm::sincos(TAU * k as f64 / 4000.0);
                libm::hypot(x - radii[k as usize] * cos, y - radii[k as usize] * sin)
            };
            (nearest - 1..=nearest + 1).map(distance).fold(f64::INFINITY, f64::min)
        });
        let (corners, off) =
            off.fold((0, 0.0f64), |(n, worst), off| (n + usize::from(off < 1e-9), worst.max(off)));
        if name != "disc" {
            // the corners of the disc deviate from straight edges by less than the tolerance
            assert!(corners >= 4000 && off < 1e-9, "{name}: {corners} corners, {off}");
        }
        assert!(crossings < 4000 * 400, "{name}: {crossings} crossings");
    }
}

/// Circles among thousands of others: those on the same scan lines do not slow down each other.
#[test]
fn a_field_of_rods() {
    let rod = Solid::from(Primitive::from(Cylinder::new(1.0, 2.0).unwrap()));
    let rods = (0..40).flat_map(|x| (0..40).map(move |y| [3.0 * f64::from(x), 3.0 * f64::from(y), 0.0]));
    let field = Solid::union(rods.map(|at| rod.translate(at))).translate([-58.5, -58.5, 0.0]);
    let (section, crossings) = cut_counted(&field, 61.0, 2);
    let contours = section.contours(RegionId(1));
    assert_eq!(contours.len(), 1600);
    let (area, perimeter) = (section.area(RegionId(1)), section.perimeter(RegionId(1)));
    let tolerance = 5e-5 * 122.0;
    assert!((area - 1600.0 * PI).abs() < tolerance * perimeter, "{area}");
    assert!((perimeter - 3200.0 * PI).abs() < 0.01 * perimeter, "{perimeter}");
    for [x, y] in contours.iter().flatten() {
        let own = [x, y].map(|x| (x + 58.5) / 3.0).map(|at| 3.0 * (at - at.round()));
        assert!((libm::hypot(own[0], own[1]) - 1.0).abs() < tolerance, "{x} {y}");
    }
    assert!(crossings < 1600 * 2000, "{crossings}");
    assert_eq!(cut_counted(&field, 61.0, 1), (section, crossings));
}

/// Teeth along the scan lines, with edges along them, and gaps that open and close.
#[test]
fn teeth_along_the_scan_lines() {
    let mut corners = vec![[-1.0, -10.0], [-1.0, 10.0]];
    for k in (0..1500).rev() {
        let (low, high) = (-9.0 + 0.012 * f64::from(k), -9.0 + 0.012 * f64::from(k) + 0.006);
        let length = 5.0 + f64::from(k * 37 % 101) / 101.0;
        corners.extend([[0.0, high], [length, high], [length, low], [0.0, low]]);
    }
    let vertices = corners.iter().map(|&at| Vertex { at, bulge: 0.0, corner: Corner::Sharp }).collect();
    let comb = Outline::new(&[vertices]).unwrap().extrude(-1.0, 1.0, [Default::default(); 2]).unwrap();
    let (section, crossings) = cut_counted(&comb, 11.0, 2);
    let polygon = rayweave_polygon::from_polygons(
        &[{
            let mut all = corners.clone();
            all.reverse();
            all
        }],
        Side::Outside,
    )
    .unwrap();
    let expected = polygon.area();
    let found = section.area(RegionId(1));
    assert!((found - expected).abs() < 1e-9 * expected, "{found} {expected}");
    assert!(crossings < 6000 * 1000, "{crossings}");
}
