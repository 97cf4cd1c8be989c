//! Surfaces that are not of revolution: closed forms, equivalent definitions of one surface, Zemax files.

use crate::lenses::{D_NM, at_image, disk, index, near};
use rayweave_lens::paraxial::Meridian;
use rayweave_lens::prescription::{Behind, Prescription, Surface, read_zmx, write_zmx};
use rayweave_math::Vec3;
use rayweave_optics::component::{Asphere, Figure, SurfaceForm, Zernike};
use rayweave_shape::Ray;

const PLANE: f64 = f64::INFINITY;

/// A spectacle lens of +2.5 dioptres in one meridian and +4.5 in the other, with its image plane 300 behind
/// it.
fn spectacle_lens() -> Prescription {
    let toric = Surface::new(-120.0, 300.0, Behind::Air).figure(Figure::Toroidal { turn: -260.0 });
    Prescription::new(vec![Surface::new(88.0, 4.0, index(1.5)), toric]).entrance_pupil_diameter(0.5)
}

fn polynomial(norm_radius: f64, coefficients: &[f64]) -> Figure {
    Figure::Polynomial { norm_radius, coefficients: coefficients.to_vec() }
}

fn zernike(order: Zernike, norm_radius: f64, coefficients: &[f64]) -> Figure {
    Figure::Zernike { order, norm_radius, coefficients: coefficients.to_vec() }
}

/// One lens of each figure, all with power along x and y.
fn one_of_each() -> Vec<Prescription> {
    let cylinder = Figure::Toroidal { turn: PLANE };
    let wavy = polynomial(12.0, &[0.0, 0.01, 0.2, 0.03, -0.1, 0.02, 0.0, 0.01, -0.03, 0.05]);
    let coma = zernike(Zernike::Noll, 11.0, &[0.1, 0.0, 0.01, 0.02, 0.03, -0.04, 0.02, 0.01]);
    let fringe = zernike(Zernike::Fringe, 11.0, &[0.0, 0.01, 0.0, 0.05, 0.04, 0.0, 0.02]);
    let even = [0.0, 2e-6, -3e-9, 0.0, 0.0, 0.0, 0.0, 0.0];
    let fronts = [
        Surface::new(40.0, 6.0, index(1.6))
            .figure(Figure::Biconic { radius_x: -90.0, conic_x: 0.7 })
            .conic(-1.4),
        Surface::new(40.0, 6.0, index(1.6)).figure(Figure::Toroidal { turn: 65.0 }),
        Surface::new(-40.0, 6.0, index(1.6)).figure(Figure::Toroidal { turn: 65.0 }),
        Surface::new(40.0, 6.0, index(1.6)).figure(cylinder.clone()).conic(-0.8),
        Surface::new(PLANE, 6.0, index(1.6))
            .figure(cylinder)
            .even([0.01, -2e-6, 1e-9, 0.0, 0.0, 0.0, 0.0, 0.0]),
        Surface::new(70.0, 6.0, index(1.6)).figure(wavy).conic(-0.5),
        Surface::new(70.0, 6.0, index(1.6)).figure(coma).even(even),
        Surface::new(-70.0, 6.0, index(1.6)).figure(fringe),
    ];
    let lens = |front: Surface| {
        let back =
            Surface::new(-60.0, 50.0, Behind::Air).figure(Figure::Biconic { radius_x: -75.0, conic_x: 0.0 });
        Prescription::new(vec![front, back]).entrance_pupil_diameter(16.0).field_angles(&[0.0, 3.0])
    };
    fronts.into_iter().map(lens).collect()
}

/// Thick lenses (E. Hecht, *Optics*, section 6.1): 1/f = (n - 1)(1/R1 - 1/R2 + (n - 1) d / (n R1 R2)), and
/// the back focal distance f (1 - (n - 1) d / (n R1)).
#[test]
fn first_order_data_of_both_meridians_are_those_of_two_lenses() {
    let lens = spectacle_lens();
    let (n, d, front) = (1.5, 4.0, 88.0);
    for (meridian, back) in [(Meridian::X, -260.0), (Meridian::Y, -120.0)] {
        let power = (n - 1.0) * (1.0 / front - 1.0 / back + (n - 1.0) * d / (n * front * back));
        let found = lens.first_order_along(meridian, D_NM).unwrap();
        near(found.focal_length, 1.0 / power, 1e-11);
        near(found.back_focal_distance, (1.0 - (n - 1.0) * d / (n * front)) / power, 1e-11);
    }
    let lens = Prescription::new(vec![
        Surface::new(PLANE, 3.0, index(1.5)).figure(Figure::Biconic { radius_x: 25.0, conic_x: 2.0 }),
        Surface::new(PLANE, 10.0, Behind::Air),
    ]);
    near(lens.first_order_along(Meridian::X, D_NM).unwrap().focal_length, 50.0, 1e-12);
    assert!(lens.first_order(D_NM).unwrap().focal_length.is_infinite());
    assert!(lens.seidel().unwrap_err().to_string().contains("not of revolution"));
}

/// Real light through the solids of the spectacle lens converges to a line along y at the focus of the
/// meridian x, and to one along x at that of y; between them, in the dioptric middle, the beam is circular.
#[test]
fn a_toric_lens_has_two_focal_lines() {
    let lens = spectacle_lens();
    let [fx, fy] =
        [Meridian::X, Meridian::Y].map(|m| lens.first_order_along(m, D_NM).unwrap().back_focal_distance);
    let heights = [Meridian::X, Meridian::Y].map(|m| {
        // the beam width at the back principal plane is that of the pupil
        lens.first_order_along(m, D_NM).unwrap().focal_length
    });
    let widths = |z: f64| {
        let mut lens = lens.clone();
        lens.surfaces[1].thickness = z;
        let angle = |k: u32| f64::from(k) * std::f64::consts::PI / 32.0;
        let ring: Vec<_> = (0..64).map(|k| [angle(k).cos(), angle(k).sin()]).collect();
        let beam = lens.beam(0, D_NM, &ring).unwrap();
        let rows = at_image(&lens.assembly().unwrap(), &beam);
        assert_eq!(rows.len(), 64);
        rows.iter().fold([0.0f64; 2], |[x, y], row| [x.max(row.end.x.abs()), y.max(row.end.y.abs())])
    };
    let [x, y] = widths(fx);
    near(x, 0.0, 1e-5);
    near(y, 0.25 * (fx - fy).abs() / heights[1], 5e-4);
    let [x, y] = widths(fy);
    near(y, 0.0, 1e-5);
    near(x, 0.25 * (fx - fy).abs() / heights[0], 5e-4);
    let [x, y] = widths((heights[0] * fy + heights[1] * fx) / (heights[0] + heights[1]));
    near(x, y, 5e-4);
}

/// Sequential tracing and solids share no intersection code, and must give the same end points.
#[test]
fn solids_and_the_sequence_of_surfaces_agree() {
    for (number, lens) in one_of_each().iter().enumerate() {
        let layout = lens.assembly().unwrap_or_else(|error| panic!("{number}: {error}"));
        for field in 0..2 {
            let beam = lens.beam(field, D_NM, &disk(100, 0.97)).unwrap();
            let rows = at_image(&layout, &beam);
            assert_eq!(rows.len(), beam.len(), "lens {number} field {field}");
            for (k, row) in rows.iter().enumerate() {
                let passes = lens.follow(&beam.get(k).ray, D_NM).unwrap();
                let last = passes.last().unwrap();
                near((row.end - last.point).length(), 0.0, 1e-11);
                near((row.direction - last.direction).length(), 0.0, 1e-12);
                near(row.path, last.path, 1e-11);
            }
        }
    }
}

/// An elliptic cylinder with e = 1/n focuses collimated light of any height to a line in the glass, at n R /
/// (n - 1) (Descartes; R. K. Luneburg, *Mathematical Theory of Optics*, section 24): no spherical aberration
/// along y, straight along x.
#[test]
fn an_acylinder_of_descartes_has_a_perfect_line() {
    let (n, radius) = (1.5, 20.0);
    let front =
        |figure| Surface::new(radius, n * radius / (n - 1.0), index(n)).conic(-1.0 / (n * n)).figure(figure);
    for figure in [Figure::Toroidal { turn: PLANE }, Figure::Biconic { radius_x: PLANE, conic_x: 0.0 }] {
        let lens = Prescription::new(vec![front(figure)]).entrance_pupil_diameter(20.0);
        for [x, y] in disk(100, 10.0) {
            let passes = lens.follow(&Ray::new(Vec3::new(x, y, -30.0), Vec3::Z), D_NM).unwrap();
            near(passes[1].point.y, 0.0, 1e-13);
            near(passes[1].point.x, x, 1e-13);
        }
    }
}

/// Equivalent definitions of the same surfaces.
#[test]
fn figures_agree_where_they_are_the_same_surface() {
    let (r, k) = (30.0, -0.7);
    let conic = SurfaceForm::from(Asphere::conic(r, k));
    let alike = [
        (Figure::Biconic { radius_x: r, conic_x: k }, Asphere::conic(r, k)),
        (polynomial(3.0, &[0.0; 5]), Asphere::conic(r, k)),
    ];
    for (figure, asphere) in alike {
        let form = SurfaceForm::new(asphere, figure);
        for point in disk(50, 20.0) {
            near(form.sag(point).unwrap(), conic.sag(point).unwrap(), 2e-15 * r);
        }
    }
    // a circle rotated about its own centre is a sphere; about a distant centre, a cylinder up to x^2 / (2 R)
    let sphere = SurfaceForm::from(Asphere::conic(r, 0.0));
    let turned = SurfaceForm::new(Asphere::conic(r, 0.0), Figure::Toroidal { turn: r });
    // Noll's Z4 is sqrt(3) (2 r^2 - 1), his Z6 sqrt(6) (x^2 - y^2), his Z7 sqrt(8) (3 r^2 - 2) y over the
    // unit disc
    let sum = SurfaceForm::new(
        Asphere::conic(PLANE, 0.0),
        zernike(Zernike::Noll, 20.0, &[0.0, 0.0, 0.0, 0.3, 0.0, -0.2, 0.1]),
    );
    for point in disk(50, 20.0) {
        near(turned.sag(point).unwrap(), sphere.sag(point).unwrap(), 1e-14);
        let [x, y] = point.map(|p| p / 20.0);
        let square = x * x + y * y;
        let expected = 0.3 * 3f64.sqrt() * (2.0 * square - 1.0) - 0.2 * 6f64.sqrt() * (x * x - y * y)
            + 0.1 * 8f64.sqrt() * (3.0 * square - 2.0) * y;
        near(sum.sag(point).unwrap(), expected, 1e-15);
    }
}

/// A paraboloid as a polynomial in x and y, and one with different foci along x and y: the rays of each
/// meridian converge at its focus.
#[test]
fn mirrors_of_terms_in_x_and_y() {
    let mirror = |fx: f64, fy: f64| {
        let terms = [0.0, 0.0, -0.25 / fx, 0.0, -0.25 / fy].map(|c: f64| c * 100.0);
        let face = Surface::new(PLANE, -100.0, Behind::Mirror).figure(polynomial(10.0, &terms));
        Prescription::new(vec![face]).entrance_pupil_diameter(60.0)
    };
    let lens = mirror(100.0, 100.0);
    let beam = lens.beam(0, D_NM, &disk(100, 0.95)).unwrap();
    let rows = at_image(&lens.assembly().unwrap(), &beam);
    assert_eq!(rows.len(), 100);
    rows.iter().for_each(|row| near(row.end.x.hypot(row.end.y), 0.0, 1e-12));
    let lens = mirror(100.0, 120.0);
    for (meridian, f) in [(Meridian::X, 100.0), (Meridian::Y, 120.0)] {
        near(lens.first_order_along(meridian, D_NM).unwrap().focal_length, f, 1e-12);
    }
    // y = 0 is a symmetry plane whose section is a parabola
    let passes = lens.follow(&Ray::new(Vec3::new(25.0, 0.0, -50.0), Vec3::Z), D_NM).unwrap();
    near(passes[1].point.x, 0.0, 1e-13);
}

#[test]
fn zemax_files_represent_all_figures() {
    for lens in one_of_each().iter().chain([&spectacle_lens()]) {
        let text = write_zmx(lens).unwrap();
        assert_eq!(&read_zmx(text.as_bytes()).unwrap().prescription, lens, "{text}");
    }
    let file = "ENPD 4\nWAVM 1 0.55 1\nSURF 0\n DISZ INFINITY\nSURF 1\n STOP\n TYPE XPOLYNOM\n CURV 0.02\n XDAT 1 5 0 0 1 0 0\n \
                XDAT 2 4.0 0 0 1 0 0\n XDAT 5 0.25 0 0 1 0 0\n XDAT 7 -0.5 0 0 1 0 0\n XDAT 9 7.0\n DISZ 4\n GLAS N-BK7\nSURF 2\n \
                TYPE SZERNSAG\n PARM 2 1e-5\n PARM 13 3\n PARM 14 8.5\n PARM 17 0.25\n PARM 18 1.0\n DISZ 9\nSURF 3\n";
    let lens = read_zmx(file.as_bytes()).unwrap().prescription;
    // terms beyond the stated number are ignored
    assert_eq!(lens.surfaces[0].figure, polynomial(4.0, &[0.0, 0.0, 0.25, 0.0, -0.5]));
    assert_eq!(lens.surfaces[1].figure, zernike(Zernike::Noll, 8.5, &[0.0, 0.0, 0.25]));
    assert_eq!(lens.surfaces[1].even[1], 1e-5);
    // x^2 and y^2 over 4 with coefficients 0.25 and -0.5 add 2 c / 16 to the curvature
    let form = SurfaceForm::new(Asphere::conic(50.0, 0.0), lens.surfaces[0].figure.clone());
    near(form.sag([2.0, 0.0]).unwrap(), 50.0 - 2496f64.sqrt() + 0.25 / 4.0, 1e-14);
    near(form.sag([0.0, 2.0]).unwrap(), 50.0 - 2496f64.sqrt() - 0.5 / 4.0, 1e-14);
}

#[test]
fn refusals() {
    let message = |surface: Surface| {
        let lens = Prescription::new(vec![surface, Surface::new(PLANE, 10.0, Behind::Air)])
            .entrance_pupil_diameter(10.0);
        let found = lens.first_order(D_NM).map(drop).and_then(|()| lens.assembly().map(drop));
        found.unwrap_err().to_string()
    };
    let surface = |radius, figure| Surface::new(radius, 5.0, index(1.5)).figure(figure);
    let biconic = |radius_x| Figure::Biconic { radius_x, conic_x: 0.0 };
    let even = [0.0, 1e-5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    assert!(
        message(surface(20.0, biconic(0.0))).starts_with("surface 1: radius_x"),
        "{}",
        message(surface(20.0, biconic(0.0)))
    );
    assert!(
        message(surface(20.0, biconic(4.0))).contains("ends 3.9999"),
        "{}",
        message(surface(20.0, biconic(4.0)))
    );
    assert!(message(surface(20.0, biconic(9.0)).even(even)).contains("even terms in r: a biconic has none"));
    assert!(message(surface(20.0, Figure::Toroidal { turn: f64::NAN })).contains("turn"));
    // a circle rotated about an axis closer than its centre
    assert!(
        message(surface(20.0, Figure::Toroidal { turn: 15.0 }))
            .contains("a radius of rotation of at least its radius")
    );
    assert!(message(surface(20.0, polynomial(0.0, &[1.0]))).contains("norm_radius"));
    assert!(message(surface(20.0, polynomial(1.0, &[f64::INFINITY]))).contains("coefficient"));
    assert!(message(surface(20.0, polynomial(9.0, &vec![1e-9; 500]))).contains("degree 31"));
    let file = |kind: &str, lines: &str| {
        let text = format!(
            "ENPD 4\nWAVM 1 0.55 1\nSURF 0\n DISZ INFINITY\nSURF 1\n STOP\n TYPE {kind}\n{lines}\n DISZ 4\nSURF 2\n"
        );
        read_zmx(text.as_bytes()).unwrap_err().to_string()
    };
    assert!(
        file("TOROIDAL", "XDAT 1 3\nXDAT 2 5\nXDAT 4 0.1").starts_with("line 7: the toroid has parameter 13")
    );
    assert!(file("SZERNSAG", "PARM 9 0.5").contains("without decentres"));
    assert!(file("BICONICZ", "").contains("BICONICX"));
    assert!(file("XPOLYNOM", "XDAT 700000 1").contains("numbers up to 500 are allowed"));
    let mut odd = spectacle_lens();
    odd.surfaces[1].even[7] = 1e-20;
    assert!(write_zmx(&odd).unwrap_err().to_string().contains("y^16"));
}

/// Image points (x, y) of three rays through some of these lenses with a sphere as their back, computed by
/// Optiland 0.6.3 with its intersection search continued to 1e-15 (its biconic is the sum of two curves, a
/// different surface).
const OPTILAND: [(usize, [[f64; 2]; 3]); 4] = [
    (
        1,
        [
            [1.0595585275496244, -2.6709256142228908],
            [1.0128903848513735, -1.179481467945363],
            [1.04505179450864, 0.38512945088739237],
        ],
    ),
    (
        2,
        [
            [1.0883871177272701, 3.1826736822413584],
            [1.012582503599492, -3.2286843707835535],
            [1.0501927884242876, -9.642844372817544],
        ],
    ),
    (
        5,
        [
            [0.8536446846836898, -1.2756135494719425],
            [1.279824046521056, -1.6711434202371276],
            [1.067052446445947, -2.0590992911082378],
        ],
    ),
    (
        6,
        [
            [1.0612204420175826, -1.840260270792859],
            [0.7907090604447564, -1.1960144225524103],
            [1.3855124236348102, -1.47951075341508],
        ],
    ),
];

#[test]
fn optiland_agrees() {
    let mut all = one_of_each();
    for (number, expected) in OPTILAND {
        // Optiland cannot combine these with Zernike polynomials
        all[number].surfaces[0].even = [0.0; 8];
        all[number].surfaces[1] = Surface::new(-60.0, 50.0, Behind::Air);
        let starts = [[3.0, 4.0], [-5.0, -1.0], [0.0, -6.0]];
        for ([x, y], [u, v]) in starts.into_iter().zip(expected) {
            let ray = Ray::new(Vec3::new(x, y, -10.0), Vec3::new(0.02, -0.03, 1.0));
            let point = all[number].follow(&ray, D_NM).unwrap()[2].point;
            near(point.x, u, 1e-12);
            near(point.y, v, 1e-12);
        }
    }
}
