//! Cross-sections compared with closed forms.

use rayweave_analysis::section::{Cut, Section, SectionError, SectionWindow, section};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Program, Region, RegionId, Solid};
use rayweave_shape::primitive::{CentredBox, Cylinder, Freeform, HalfSpace, Primitive, Sphere};
use rayweave_shape::surface::sag::{Base, Description, Sag, Zernike, zernike_terms};
use rayweave_trace::Weave;
use std::f64::consts::PI;
use std::sync::Arc;

const ONE: RegionId = RegionId(1);
const TWO: RegionId = RegionId(2);

fn ball(radius: f64) -> Solid {
    Primitive::from(Sphere::new(radius).unwrap()).into()
}

fn cuboid(size: [f64; 3]) -> Solid {
    Primitive::from(CentredBox::new(size.into()).unwrap()).into()
}

fn rod(radius: f64, height: f64) -> Solid {
    Primitive::from(Cylinder::new(radius, height).unwrap()).into()
}

/// The section of regions by the plane x = 0, z to the right and y up.
fn cut(solids: &[Solid], window: &SectionWindow) -> Section {
    let region =
        |(k, solid): (u32, &Solid)| Region { name: format!("r{k}"), solid: solid.clone(), medium: k };
    let regions: Vec<Region> = (1..).zip(solids).map(region).collect();
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let plane = Cut::new(Vec3::ZERO, Vec3::Z, Vec3::Y).unwrap();
    section(&Weave::new(program), &plane, window).unwrap()
}

fn window() -> SectionWindow {
    SectionWindow::new([-10.0, -10.0], [10.0, 10.0])
}

/// The signed area of a contour.
fn area(contour: &[[f64; 2]]) -> f64 {
    let next = contour.iter().cycle().skip(1);
    0.5 * contour.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
}

#[test]
fn a_shell_is_a_ring() {
    let found = cut(&[ball(7.0) - ball(4.0)], &window());
    let mut contours = found.contours(ONE);
    contours.sort_by(|a, b| area(a).total_cmp(&area(b)));
    let [hole, outline] = &contours[..] else { panic!("{} contours", contours.len()) };
    // the hole goes around clockwise
    for (contour, radius, sign) in [(hole, 4.0, -1.0), (outline, 7.0, 1.0)] {
        assert!((area(contour) - sign * PI * radius * radius).abs() < 2e-3 * radius, "{}", area(contour));
        let off = contour.iter().map(|[u, v]| (u.hypot(*v) - radius).abs()).fold(0.0, f64::max);
        assert!(off < 1e-3, "{off}");
    }
    assert!((found.area(ONE) - PI * 33.0).abs() < 3e-2);
}

/// No point of an edge is farther from a rotated square than the tolerance, and the corners of the square are found.
#[test]
fn corners_and_walls() {
    for degrees in [0.0, 1e-3, 30.0, 45.0, 89.99] {
        let found = cut(&[cuboid([2.0, 6.0, 6.0]).rotate_x(degrees)], &window());
        let contours = found.contours(ONE);
        let [square] = &contours[..] else { panic!("{} contours at {degrees}", contours.len()) };
        assert!((area(square) - 36.0).abs() < 2e-2, "{degrees}: {}", area(square));
        // y turns towards z
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        for &[z, y] in square {
            let (a, b) = (y * cos + z * sin, z * cos - y * sin);
            let off = a.abs().max(b.abs()) - 3.0;
            assert!(off.abs() < 3e-3, "{degrees} [{z}, {y}] {off}");
        }
        for (a, b) in [(3.0, 3.0), (3.0, -3.0), (-3.0, 3.0), (-3.0, -3.0)] {
            let at = [b * cos + a * sin, a * cos - b * sin];
            let near = square.iter().map(|p| (p[0] - at[0]).hypot(p[1] - at[1])).fold(9.0, f64::min);
            assert!(near < 3e-3, "{degrees} {at:?} {near}");
        }
    }
}

/// A plate thinner than the column spacing is found because of its bounds.
#[test]
fn thin_plates() {
    let plate = cuboid([4.0, 8.0, 1e-2]).translate([0.0, 0.0, 1.2345]);
    let found = cut(&[plate], &window());
    assert!((found.area(ONE) - 8e-2).abs() < 1.6e-2, "{}", found.area(ONE));
}

/// Two cemented parts share one line, on the sphere between them, without a gap.
#[test]
fn cemented_parts_share_a_line() {
    let body = rod(5.0, 6.0);
    let back = &body & &ball(8.0).translate([0.0, 0.0, 8.0]);
    let found = cut(&[body, back], &window());
    let lines = found.between(TWO, ONE);
    let [line] = &lines[..] else { panic!("{} lines", lines.len()) };
    let off = line.iter().map(|[z, y]| ((z - 8.0).hypot(*y) - 8.0).abs()).fold(0.0, f64::max);
    assert!(off < 1e-3, "{off}");
    let ends = [line[0], line[line.len() - 1]];
    assert!(ends.iter().all(|end| (end[1].abs() - 5.0).abs() < 3e-3), "{ends:?}");
    let segment = |half: f64, r: f64| r * r * (half / r).asin() - half * (r * r - half * half).sqrt();
    // behind the chord at the rim there is a rectangle, in front of it a circular segment
    let sag = 8.0 - (64.0_f64 - 25.0).sqrt();
    let second = 10.0 * (3.0 - sag) + segment(5.0, 8.0);
    assert!((found.area(TWO) - second).abs() < 2e-2, "{} {second}", found.area(TWO));
    assert!((found.area(ONE) + found.area(TWO) - 60.0).abs() < 2e-2);
}

/// A lens between two spheres: two circular segments.
#[test]
fn a_lens_by_its_segments() {
    let (r, half) = (50.0_f64, 2.0);
    let face = |side: f64| ball(r).translate([0.0, 0.0, side * (r - half)]);
    let found = cut(&[&face(1.0) & &face(-1.0)], &SectionWindow::new([-5.0, -20.0], [5.0, 20.0]));
    let angle = 2.0 * ((r - half) / r).acos();
    let expected = r * r * (angle - angle.sin());
    assert!((found.area(ONE) / expected - 1.0).abs() < 1e-4, "{} {expected}", found.area(ONE));
    assert_eq!(found.contours(ONE).len(), 1);
}

#[test]
fn infinite_regions_end_at_the_window() {
    let below = Solid::from(Primitive::from(HalfSpace::new(Vec3::Y, 2.0).unwrap()));
    let found = cut(&[below], &window());
    assert!((found.area(ONE) - 240.0).abs() < 1e-9);
    assert_eq!(found.contours(ONE).len(), 1);
    assert!(cut(&[Solid::empty()], &window()).edges.is_empty());
    let all = cut(&[!Solid::empty()], &window());
    assert!((all.area(ONE) - 400.0).abs() < 1e-9);
}

#[test]
fn planes_windows_and_their_errors() {
    let plane =
        Cut::new(Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, 0.0, 5.0), Vec3::new(0.0, 3.0, 4.0)).unwrap();
    assert_eq!(plane.point([1.0, 2.0]), Vec3::new(1.0, 4.0, 4.0));
    assert_eq!(plane.place(Vec3::new(9.0, 4.0, 4.0)), [1.0, 2.0]);
    assert_eq!(plane.normal(), Vec3::NEG_X);
    let slab = Bounds::new(Vec3::new(f64::NEG_INFINITY, 0.0, 3.0), Vec3::new(f64::INFINITY, 1.0, 5.0));
    assert_eq!(plane.range(&slab, 0), [0.0, 2.0]);
    assert_eq!(plane.range(&slab, 1), [-2.0, -1.0]);
    assert!(plane.range(&Bounds::EMPTY, 0)[0] > plane.range(&Bounds::EMPTY, 0)[1]);
    assert!(matches!(Cut::new(Vec3::ZERO, Vec3::X, -2.0 * Vec3::X), Err(SectionError::Axes { .. })));
    assert!(Cut::new(Vec3::NAN, Vec3::X, Vec3::Y).is_err());
    let weave = Weave::new(Arc::new(Program::compile(&ball(1.0)).unwrap()));
    let plane = Cut::new(Vec3::ZERO, Vec3::Z, Vec3::Y).unwrap();
    let fails = |window: SectionWindow| section(&weave, &plane, &window).unwrap_err();
    assert!(matches!(fails(SectionWindow::new([0.0; 2], [0.0, 1.0])), SectionError::Window { .. }));
    assert!(matches!(fails(SectionWindow::new([f64::NAN; 2], [1.0; 2])), SectionError::Window { .. }));
    assert!(matches!(fails(SectionWindow { tolerance: 0.0, ..window() }), SectionError::Tolerance { .. }));
    for columns in [0, 1, 65_537] {
        assert_eq!(fails(SectionWindow { columns, ..window() }), SectionError::Columns { columns });
    }
}

/// A freeform with 300 Zernike terms, whose powers of x and y cancel each other: the area of its section is the integral of the
/// height above it.
#[test]
fn a_freeform_with_many_terms_has_its_area() {
    let zernike: Vec<f64> = (0..300).map(|k| if k % 2 == 0 { 0.01 } else { -0.01 }).collect();
    let [curvature, conic, norm_radius] = [0.0; 3];
    let freeform = Freeform::new(1.0, [curvature, conic], [&[], &zernike], norm_radius, 30.0).unwrap();
    let terms = zernike_terms(Zernike::Noll, &zernike, 1.0);
    let base = Base::Conic { curvature, conic };
    let sag = Sag::new(&Description { mixed: terms, ..Description::new(1.0, base) }).unwrap();
    let regions = [Region { name: "r".into(), solid: Primitive::from(freeform).into(), medium: 1 }];
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let bounds = program.bounds();
    assert!(bounds.lo.z > -30.0, "{bounds:?}");
    let plane = Cut::new(Vec3::ZERO, Vec3::Z, Vec3::Y).unwrap();
    let window = SectionWindow::new([bounds.lo.z - 0.1, -1.1], [bounds.hi.z + 0.1, 1.1]);
    let found = section(&Weave::new(program), &plane, &window).unwrap().area(ONE);
    let steps = 20_000;
    let at = |k: u32| 2.0 * (f64::from(k) + 0.5) / f64::from(steps) - 1.0;
    let expected = (0..steps).map(|k| (30.0 - sag.sag(0.0, at(k))[0]) * 2.0 / f64::from(steps)).sum::<f64>();
    assert!((found - expected).abs() < 0.05, "{found}, not {expected}");
}
