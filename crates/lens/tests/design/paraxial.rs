//! First-order data and Seidel sums.

use crate::lenses::{D_NM, at_image, cassegrain, doublet, index, near, triplet};
use rayweave_lens::paraxial::Seidel;
use rayweave_lens::prescription::{Behind, FieldKind, Prescription, Surface, SystemAperture};
use rayweave_optics::component::lensmaker;

#[test]
fn thick_lenses_obey_the_lensmakers_equation() {
    for (r1, r2, t, n) in [(50.0, -80.0, 6.0, 1.5168), (-20.0, 35.0, 2.0, 1.7), (40.0, 40.0, 10.0, 1.6)] {
        let lens =
            Prescription::new(vec![Surface::new(r1, t, index(n)), Surface::new(r2, 10.0, Behind::Air)]);
        let found = lens.first_order(D_NM).unwrap();
        let f = lensmaker(r1, r2, n, t).unwrap();
        near(found.focal_length, f, 1e-13 * f.abs());
        // Hecht, section 6.1: the principal planes
        near(found.front_principal_plane, -f * (n - 1.0) * t / (r2 * n), 1e-12);
        near(found.back_principal_plane, -f * (n - 1.0) * t / (r1 * n), 1e-12);
        near(found.back_focal_distance, found.back_principal_plane + f, 1e-12 * f.abs());
        near(found.front_focal_distance, found.front_principal_plane - f, 1e-12 * f.abs());
        near(found.petzval_sum, (1.0 / n - 1.0) * (1.0 / r1 - 1.0 / r2), 1e-16);
    }
}

#[test]
fn systems_without_power_have_an_infinite_focal_length() {
    let plate = Prescription::new(vec![
        Surface::new(f64::INFINITY, 5.0, index(1.5)),
        Surface::new(f64::INFINITY, 5.0, Behind::Air),
    ]);
    let data = plate.first_order(D_NM).unwrap();
    assert_eq!([data.focal_length, data.back_focal_distance], [f64::INFINITY; 2]);
    // the path in the plate, reduced by its index
    near(data.matrix.b, 5.0 / 1.5, 1e-15);
}

#[test]
fn pupils_are_images_of_the_stop() {
    // a stop 10 behind a thin lens of focal length 50: 1/s' = 1/50 - 1/10, s' = -12.5, magnified 1.25 times
    let f = 50.0;
    let lens = Prescription::new(vec![
        Surface::new(0.5 * f, 0.0, index(1.5)),
        Surface::new(f64::INFINITY, 10.0, Behind::Air),
        Surface::dummy(40.0),
    ])
    .stop_at(3);
    let lens = Prescription { aperture: SystemAperture::StopSemiDiameter(4.0), ..lens };
    let found = lens.first_order(D_NM).unwrap();
    near(found.entrance_pupil.position, 12.5, 1e-13);
    near(found.entrance_pupil.diameter, 10.0, 1e-13);
    near(found.exit_pupil.position, 10.0, 1e-13);
    near(found.exit_pupil.diameter, 8.0, 1e-13);
    near(found.f_number, 5.0, 1e-13);
    let open = Prescription { aperture: SystemAperture::FNumber(5.0), ..lens };
    near(open.first_order(D_NM).unwrap().stop_semi_diameter, 4.0, 1e-13);
}

#[test]
fn images_obey_the_lens_equation() {
    let f = 50.0;
    let thin = vec![Surface::new(0.5 * f, 0.0, index(1.5)), Surface::new(f64::INFINITY, 150.0, Behind::Air)];
    let lens = Prescription { object_distance: 75.0, ..Prescription::new(thin) };
    let lens = Prescription { aperture: SystemAperture::ObjectNumericalAperture(0.1), ..lens };
    let found = lens.first_order(D_NM).unwrap();
    near(found.image_distance, 150.0, 1e-12);
    near(found.magnification, -2.0, 1e-14);
    near(found.entrance_pupil.diameter, 150.0 * 0.1 / 0.99_f64.sqrt(), 1e-12);
    // the three field kinds
    let rays = [(FieldKind::ObjectHeight, 3.0), (FieldKind::ImageHeight, -6.0)].map(|(kind, y)| {
        let lens = Prescription { field_kind: kind, fields: vec![[0.0, y]], ..lens.clone() };
        lens.beam(0, D_NM, &[[0.0, 0.5]]).unwrap().get(0).ray
    });
    near((rays[0].origin - rays[1].origin).length(), 0.0, 1e-13);
    near(rays[0].origin.y, 3.0, 0.0);
}

#[test]
fn a_two_mirror_telescope() {
    // D. J. Schroeder, Astronomical Optics, section 2.5: f = f1 m with m = far / near of the secondary
    let found = cassegrain().first_order(D_NM).unwrap();
    near(found.focal_length, 300.0 * 300.0 / 60.0, 1e-10);
    near(found.back_focal_distance, 300.0, 1e-10);
    near(found.f_number, 15.0, 1e-12);
    // the secondary (focal length -75) images the primary, which is the stop: 1/s' = -1/75 - 1/240, a virtual
    // pupil behind it
    near(found.exit_pupil.position, -240.0 - 1.0 / (1.0 / 75.0 + 1.0 / 240.0), 1e-10);
    near(found.exit_pupil.diameter, 100.0 / 240.0 / (1.0 / 75.0 + 1.0 / 240.0), 1e-10);
}

/// Rays near the axis, through the solids.
#[test]
fn real_rays_near_the_axis_have_these_focal_lengths() {
    for lens in [doublet(), triplet()] {
        let lens = Prescription { fields: vec![[0.0; 2]], ..lens };
        let found = lens.first_order(D_NM).unwrap();
        let height = 1e-4;
        let layout = lens.assembly().unwrap();
        let beam = lens.beam(0, D_NM, &[[0.0, height]]).unwrap();
        let last = at_image(&layout, &beam)[0];
        let y = 0.5 * found.entrance_pupil.diameter * height;
        // aberrations are of second order in the height
        near(-y * last.direction.z / last.direction.y, found.focal_length, 1e-6);
        let vertex = last.end.z - lens.surfaces.last().unwrap().thickness;
        let crossing = last.end.z - last.end.y * last.direction.z / last.direction.y;
        near(crossing - vertex, found.back_focal_distance, 1e-6);
    }
}

/// A spherical mirror with the stop at its centre has no axis of its own: its image lies on a sphere of half the radius
/// about that centre, the Petzval surface.
#[test]
fn the_petzval_surface_of_a_concentric_mirror() {
    let mirror = Prescription::new(vec![Surface::dummy(200.0), Surface::new(-200.0, -100.0, Behind::Mirror)])
        .entrance_pupil_diameter(10.0);
    let found = mirror.first_order(D_NM).unwrap();
    near(found.entrance_pupil.position, 0.0, 0.0);
    // light travels back: n' = -1
    near(-found.petzval_sum, -1.0 / 100.0, 1e-16);
}

#[test]
fn a_thin_lens_in_the_stop_has_the_textbook_seidel_sums() {
    // Welford, section 12.3: thin lens, stop at the lens, distant object, equi-convex, n = 1.5:
    // S_III = H^2 K, S_IV = H^2 K / n, S_V = 0
    let (n, f, h, slope) = (1.5, 100.0, 10.0, 0.1);
    let lens = Prescription::new(vec![Surface::new(f, 0.0, index(n)), Surface::new(-f, 100.0, Behind::Air)])
        .entrance_pupil_diameter(2.0 * h)
        .field_angles(&[0.0, 0.1_f64.atan().to_degrees()]);
    let sum = Seidel::sum(&lens.seidel().unwrap());
    let invariant = h * slope;
    near(sum.astigmatism, invariant * invariant / f, 1e-14);
    near(sum.petzval, invariant * invariant / f / n, 1e-14);
    near(sum.petzval, -invariant * invariant * lens.first_order(D_NM).unwrap().petzval_sum, 1e-14);
    near(sum.distortion, 0.0, 1e-14);
    // S_I = h^4 K^3 / 4 ((n / (n - 1))^2 + (n + 2) / (n (n - 1)^2) (B + 2 (n^2 - 1) / (n + 2) C)^2 - n / (n + 2) C^2), B = 0,
    // C = -1 for a distant object
    let c = -1.0_f64;
    let bent = 2.0 * (n * n - 1.0) / (n + 2.0) * c;
    let factor = (n / (n - 1.0_f64)).powi(2) + (n + 2.0) / (n * (n - 1.0).powi(2)) * bent * bent
        - n / (n + 2.0) * c * c;
    near(sum.spherical, 0.25 * h.powi(4) / f.powi(3) * factor, 1e-14);
    // S_II = -h^2 K^2 H / 2 ((n + 1) / (n (n - 1)) B + (2 n + 1) / n C)
    near(sum.coma, -0.5 * h * h / f / f * -invariant * (2.0 * n + 1.0) / n * c, 1e-14);
}

#[test]
fn paraboloids_have_no_spherical_aberration_and_cassegrains_no_sum_of_it() {
    let mirror = Prescription::new(vec![Surface::new(-200.0, -100.0, Behind::Mirror).conic(-1.0)])
        .entrance_pupil_diameter(50.0);
    near(mirror.seidel().unwrap()[0].spherical, 0.0, 1e-16);
    let sum = Seidel::sum(&cassegrain().field_angles(&[0.0, 0.1]).seidel().unwrap());
    near(sum.spherical, 0.0, 1e-16);
    assert!(sum.coma.abs() > 1e-6);
}

#[test]
fn the_two_formulas_for_distortion_agree() {
    // S_V = (A' / A) (S_III + S_IV), where A'/A = S_II / S_I for spherical surfaces
    let parts = triplet().seidel().unwrap();
    for part in parts.iter().filter(|part| part.spherical != 0.0) {
        let expected = part.coma / part.spherical * (part.astigmatism + part.petzval);
        near(part.distortion, expected, 1e-12 * expected.abs().max(1e-3));
    }
}

/// A spherical surface of radius 50 before a medium of index 1.5 has the power P = 0.5 / 50. A stop t = 30 behind it gives
/// A = 1 - P t / 1.5 = 0.8, and the chief ray the slope 1 / (1.5 A) of that in the object space, which is
/// n d / (n' d') of the pupils.
#[test]
fn the_angular_magnification_is_that_of_the_pupils() {
    let lens = Prescription::new(vec![
        Surface::new(50.0, 30.0, Behind::Index(1.5)),
        Surface::new(f64::INFINITY, 100.0, Behind::Index(1.5)),
    ])
    .stop_at(2)
    .entrance_pupil_diameter(10.0);
    let data = lens.first_order(550.0).unwrap();
    near(data.angular_magnification, 1.0 / (1.5 * 0.8), 1e-14);
    near(data.entrance_pupil.diameter / (1.5 * data.exit_pupil.diameter), data.angular_magnification, 1e-14);
}
