//! Image analysis with real rays, compared with closed forms.

use crate::lenses::{D_NM, cassegrain, doublet, index, near, triplet};
use rayweave_lens::analysis::{
    Arrival, LensAnalysisError, PupilQuadrature, Spot, Study, Wavefront, ZernikePolynomial, arrivals,
    best_focus, encircled_energy, encircled_energy_radius, fan_x, fan_y, fit_zernike, geometric_mtf,
    hexapolar, square, through_focus,
};
use rayweave_lens::design::{Goal, Operand, Optimiser};
use rayweave_lens::paraxial::Seidel;
use rayweave_lens::prescription::{Behind, CoordinateBreak, Prescription, Surface};
use rayweave_math::{Affine, Vec3};
use rayweave_optics::component::{Aperture, Sheet};
use rayweave_optics::{Action, Assembly, Beam, Element, Light, TraceSettings, Tracer};
use rayweave_shape::Ray;
use rayweave_trace::Packets;

/// Compiles a prescription and applies `question` to its study.
fn study<T>(lens: &Prescription, question: impl Fn(&Study<'_, Packets>) -> T) -> T {
    let layout = lens.assembly().unwrap();
    let system = layout.assembly.compile().unwrap();
    let tracer = Tracer::new(&system, Packets::new);
    question(&Study::new(lens, &layout, &tracer))
}

fn sphere(radius: f64, diameter: f64, angle: f64) -> Prescription {
    Prescription::new(vec![Surface::new(-radius, -0.5 * radius, Behind::Mirror)])
        .entrance_pupil_diameter(diameter)
        .field_angles(&[0.0, angle])
}

/// Rays from points of a disk of radius `radius`, directed towards a focus at z = `focus`.
fn disk(radius: f64, focus: f64) -> Vec<Arrival> {
    let ray = |(id, [x, y]): (usize, [f64; 2])| {
        let position = radius * Vec3::new(x, y, 0.0);
        let direction = (Vec3::Z * focus - position).normalize();
        Arrival { id, position, direction, path: 0.0, index: 1.0, wavelength_nm: D_NM, power: 1.0 }
    };
    square(201).into_iter().enumerate().map(ray).collect()
}

#[test]
fn spots_of_disks() {
    let rays = disk(2.0, 100.0);
    let spot = Spot::of(&rays).unwrap();
    // the mean square radius of a uniform disk is half the square of its radius
    near(spot.rms, 2.0 / 2f64.sqrt(), 3e-3);
    near(spot.rms_xy[0], 1.0, 3e-3);
    near(spot.geometric, 2.0, 1e-12);
    near(spot.centroid[0].hypot(spot.centroid[1]), 0.0, 1e-12);
    near(best_focus(&rays).unwrap(), 100.0, 1e-10);
    for (k, spot) in through_focus(&rays, &[-50.0, 0.0, 50.0, 100.0]).iter().enumerate() {
        near(spot.geometric, 2.0 * (1.5 - 0.5 * k as f64), 1e-12);
    }
    for (radius, energy) in
        [0.5, 1.0, 1.7, 3.0].into_iter().zip(encircled_energy(&rays, &[0.5, 1.0, 1.7, 3.0]))
    {
        near(energy, (radius * radius / 4.0_f64).min(1.0), 2e-3);
    }
    near(encircled_energy_radius(&rays, 0.5).unwrap(), 2f64.sqrt(), 1e-2);
    near(encircled_energy_radius(&rays, 1.0).unwrap(), 2.0, 1e-12);
    // the transform of a disk: 2 J1(x) / x
    let frequencies = [0.0, 0.05, 0.2, 0.305, 0.5];
    for direction in [[1.0, 0.0], [0.6, -0.8]] {
        for (v, found) in frequencies.into_iter().zip(geometric_mtf(&rays, direction, &frequencies)) {
            let x = std::f64::consts::TAU * v * 2.0;
            let expected = if v == 0.0 { 1.0 } else { (2.0 * libm::j1(x) / x).abs() };
            near(found, expected, 3e-3);
        }
    }
    assert_eq!(Spot::of(&[]), None);
    assert_eq!(best_focus(&[]), None);
    assert_eq!(encircled_energy_radius(&[], 0.5), None);
}

#[test]
fn rays_are_weighted_by_power() {
    let rays = disk(1.0, 10.0);
    let heavy: Vec<Arrival> = rays
        .iter()
        .map(|ray| Arrival { power: if ray.position.x > 0.0 { 3.0 } else { 1.0 }, ..*ray })
        .collect();
    // half disks have their centroids at 4 / (3 pi)
    near(Spot::of(&heavy).unwrap().centroid[0], 0.5 * 4.0 / (3.0 * std::f64::consts::PI), 6e-3);
}

#[test]
fn wavefronts_of_defocus_and_tilt() {
    // a perfect focus slightly behind the centre of the reference sphere
    let (shift, radius) = (1e-3, 100.0);
    let rays: Vec<Arrival> = disk(20.0, radius)
        .iter()
        .map(|ray| Arrival { position: Vec3::Z * shift, path: 500.0, ..*ray })
        .collect();
    let principal = Arrival { position: Vec3::ZERO, direction: Vec3::Z, path: 500.0 - shift, ..rays[0] };
    let pupil = square(201);
    let found = Wavefront::new(&principal, &rays, &pupil, radius, 1e6);
    for (ray, wave) in rays.iter().zip(&found.waves) {
        let expected = -shift * (1.0 - ray.direction.z) * 1e6 / D_NM;
        // second order in the shift
        near(*wave, expected, shift * shift / radius * 1e6 / D_NM);
    }
    assert!(found.peak_to_valley() > 0.03);
    let flat = Wavefront { pupil: pupil.clone(), waves: pupil.iter().map(|[x, _]| 0.2 * x).collect() };
    near(flat.rms_about_chief_ray(), 0.1, 1e-3);
    near(flat.rms(), 0.0, 1e-13);
    near(flat.strehl(), 1.0, 1e-13);
}

/// The RMS of coma, r^3 cos t, is 1 / sqrt(8) about the chief ray and 1 / sqrt(72) about the centroid: the tilt that fits
/// it best is 2 r cos t / 3 (V. N. Mahajan, J. Opt. Soc. Am. 72, 1258, 1982, table I).
#[test]
fn the_rms_about_the_centroid_is_without_tilt() {
    let pupil = square(301);
    let coma = |&[x, y]: &[f64; 2]| (x * x + y * y) * (0.8 * y - 0.6 * x);
    let tilted = |at: &[f64; 2]| 0.7 + 5.0 * at[0] - 3.0 * at[1] + coma(at);
    let front = Wavefront { waves: pupil.iter().map(coma).collect(), pupil: pupil.clone() };
    near(front.rms_about_chief_ray(), 1.0 / 8f64.sqrt(), 2e-3);
    near(front.rms(), 1.0 / 72f64.sqrt(), 1e-3);
    let moved = Wavefront { waves: pupil.iter().map(tilted).collect(), pupil };
    near(moved.rms(), front.rms(), 1e-12);
    // a fan determines one tilt only: the best line through x^3 from -1 to 1 is 3 x / 5
    for fan in [fan_x(2001), fan_y(2001)] {
        let waves = fan.iter().map(|[x, y]| (x + y).powi(3)).collect();
        near(Wavefront { pupil: fan, waves }.rms(), (4.0_f64 / 175.0).sqrt(), 2e-3);
    }
    assert_eq!(Wavefront { pupil: vec![[0.3, 0.4]], waves: vec![2.0] }.rms(), 0.0);
    assert!(Wavefront::default().rms().is_nan() && Wavefront::default().strehl().is_nan());
}

/// The peak of the point spread function of a paraboloid off the axis: the sum of the plane waves of all rays at points
/// of the image, without any reference sphere.
#[test]
fn the_strehl_ratio_is_that_of_the_peak() {
    let lens = Prescription::new(vec![Surface::new(-400.0, -200.0, Behind::Mirror).conic(-1.0)])
        .entrance_pupil_diameter(40.0)
        .field_angles(&[0.5]);
    let pupil = square(41);
    let (front, rays) = study(&lens, |study| {
        (study.wavefront(0, D_NM, &pupil).unwrap(), study.arrivals(0, D_NM, &pupil).unwrap())
    });
    let centre = Spot::of(&rays).unwrap().centroid;
    let number = std::f64::consts::TAU / (D_NM * 1e-6);
    let brightness = |[dx, dy]: [f64; 2]| {
        let at = Vec3::new(centre[0] + dx, centre[1] + dy, rays[0].position.z);
        let phase = |ray: &Arrival| number * (ray.path + ray.direction.dot(at - ray.position));
        let parts = rays.iter().map(|ray| phase(ray).sin_cos());
        let (sin, cos) = parts.fold((0.0, 0.0), |(a, b), (sin, cos)| (a + sin, b + cos));
        (sin * sin + cos * cos) / (rays.len() as f64).powi(2)
    };
    // the Airy disk has a radius of 0.0036 mm
    let steps = || (-40..=40).map(|k| 2e-4 * f64::from(k));
    let peak = steps().flat_map(|x| steps().map(move |y| brightness([x, y]))).fold(0.0, f64::max);
    near(peak, 0.72, 0.02);
    near(front.strehl(), peak, 0.02);
    assert!(front.rms_about_chief_ray() > 2.5 * front.rms());
}

#[test]
fn telecentric_lenses_have_wavefronts() {
    // the same spherical aberration whether the stop is at the lens or in its front focal plane
    let lens = |stop: f64| {
        let surfaces = vec![
            Surface::dummy(stop),
            Surface::new(60.0, 5.0, index(1.5)),
            Surface::new(-60.0, 0.0, Behind::Air),
        ];
        let mut lens = Prescription::new(surfaces).entrance_pupil_diameter(8.0);
        lens.surfaces[2].thickness = lens.first_order(D_NM).unwrap().image_distance;
        lens
    };
    let front = -{
        let bare = Prescription { surfaces: lens(1.0).surfaces[1..].to_vec(), ..lens(1.0) };
        bare.first_order(D_NM).unwrap().front_focal_distance
    };
    let telecentric = lens(front);
    assert!(telecentric.first_order(D_NM).unwrap().exit_pupil.position.abs() > 1e10);
    let waves =
        |lens: &Prescription| study(lens, |study| study.wavefront(0, D_NM, &fan_y(11)).unwrap().waves);
    let near_by = lens(1.0);
    let errors = study(&near_by, |study| study.fan(0, D_NM, &fan_y(11)).unwrap().errors);
    let image: f64 = near_by.surfaces.iter().map(|surface| surface.thickness).sum();
    let radius = image - near_by.first_order(D_NM).unwrap().exit_pupil.position;
    let (far, near_by) = (waves(&telecentric), waves(&near_by));
    assert!(far[0].abs() > 0.5);
    for ((a, b), [_, error]) in far.iter().zip(&near_by).zip(errors) {
        // spheres of different radii about one point differ by the square of the transverse aberration over
        // twice the radius
        let expected = error * error / (2.0 * radius) * 1e6 / D_NM;
        near(a - b, expected, 2e-2 * expected + 1e-9);
    }
}

#[test]
fn nolls_table() {
    // R. J. Noll, J. Opt. Soc. Am. 66, 207 (1976), table I
    let points = [[0.3, 0.4], [-0.7, 0.1], [0.0, 0.9], [0.5, -0.5]];
    for [x, y] in points {
        let (r, a) = (f64::hypot(x, y), y.atan2(x));
        let r2 = r * r;
        let table = [
            1.0,
            2.0 * r * a.cos(),
            2.0 * r * a.sin(),
            3f64.sqrt() * (2.0 * r2 - 1.0),
            6f64.sqrt() * r2 * (2.0 * a).sin(),
            6f64.sqrt() * r2 * (2.0 * a).cos(),
            8f64.sqrt() * (3.0 * r2 - 2.0) * r * a.sin(),
            8f64.sqrt() * (3.0 * r2 - 2.0) * r * a.cos(),
            8f64.sqrt() * r2 * r * (3.0 * a).sin(),
            8f64.sqrt() * r2 * r * (3.0 * a).cos(),
            5f64.sqrt() * (6.0 * r2 * r2 - 6.0 * r2 + 1.0),
            10f64.sqrt() * (4.0 * r2 - 3.0) * r2 * (2.0 * a).cos(),
            10f64.sqrt() * (4.0 * r2 - 3.0) * r2 * (2.0 * a).sin(),
            10f64.sqrt() * r2 * r2 * (4.0 * a).cos(),
            10f64.sqrt() * r2 * r2 * (4.0 * a).sin(),
        ];
        for (k, expected) in table.into_iter().enumerate() {
            near(ZernikePolynomial::noll(k as u32 + 1).at([x, y]), expected, 1e-14);
        }
        near(
            ZernikePolynomial::noll(22).at([x, y]),
            7f64.sqrt() * (20.0 * r2.powi(3) - 30.0 * r2 * r2 + 12.0 * r2 - 1.0),
            1e-13,
        );
    }
    // ANSI Z80.28: j = (n (n + 2) + m) / 2
    for j in 0..66 {
        let ZernikePolynomial { n, m } = ZernikePolynomial::osa(j);
        assert_eq!((n * (n + 2)) as i32 + m, 2 * j as i32);
        assert!(m.unsigned_abs() <= n && (n - m.unsigned_abs()) % 2 == 0, "{j}");
    }
    // on the rim all radial polynomials are 1
    for (n, m) in [(40, 0), (41, 3), (60, 58)] {
        let normal = if m == 0 { f64::from(n + 1).sqrt() } else { (2.0 * f64::from(n + 1)).sqrt() };
        near(ZernikePolynomial { n, m }.at([1.0, 0.0]), normal, 1e-10);
    }
}

#[test]
fn fits_recover_the_coefficients() {
    let terms: Vec<ZernikePolynomial> = (1..=15).map(ZernikePolynomial::noll).collect();
    let points = square(31);
    let truth =
        |point: [f64; 2]| 0.3 * terms[3].at(point) - 0.07 * terms[7].at(point) + 0.02 * terms[10].at(point);
    let values: Vec<f64> = points.iter().map(|&point| truth(point)).collect();
    let found = fit_zernike(&points, &values, &terms).unwrap();
    near(found.coefficient(ZernikePolynomial::noll(4)), 0.3, 1e-14);
    near(found.coefficient(ZernikePolynomial::noll(8)), -0.07, 1e-14);
    near(found.coefficient(ZernikePolynomial::noll(11)), 0.02, 1e-14);
    near(found.coefficient(ZernikePolynomial::noll(5)), 0.0, 1e-14);
    near(found.residual_rms, 0.0, 1e-14);
    near(found.at([0.2, 0.1]), truth([0.2, 0.1]), 1e-14);
    // the residual is r^6, which no term up to r^4 represents
    let sixth: Vec<f64> = points.iter().map(|&point| ZernikePolynomial::noll(22).at(point)).collect();
    assert!(fit_zernike(&points, &sixth, &terms).unwrap().residual_rms > 0.8);
    assert_eq!(
        fit_zernike(&points[..4], &values[..4], &terms).unwrap_err().to_string(),
        "4 points do not determine 15 terms: a fit needs at least one point per term. Use fewer terms."
    );
}

#[test]
fn spherical_aberration_of_a_sphere() {
    // W = S_I / 8 at the rim, and the Zernike coefficient of W r^4 is W / (6 sqrt 5) in Noll's normalisation
    let lens = sphere(1000.0, 50.0, 0.1);
    let expected = lens.seidel().unwrap()[0].spherical / 8.0 * 1e6 / D_NM;
    near(expected.abs(), 25f64.powi(4) / (4.0 * 1000f64.powi(3)) * 1e6 / D_NM, 1e-12);
    let wavefront = study(&lens, |study| study.wavefront(0, D_NM, &hexapolar(12)).unwrap());
    let rim = wavefront.pupil.iter().position(|p| p[0] == 1.0).unwrap();
    // the sign: marginal light arrives early
    near(wavefront.waves[rim], expected, 2e-3 * expected.abs());
    let terms: Vec<ZernikePolynomial> = (1..=22).map(ZernikePolynomial::noll).collect();
    let found = fit_zernike(&wavefront.pupil, &wavefront.waves, &terms).unwrap();
    near(
        found.coefficient(ZernikePolynomial::noll(11)),
        expected / (6.0 * 5f64.sqrt()),
        2e-3 * expected.abs(),
    );
    // the longitudinal aberration of a sphere: R (1 - 1 / (2 cos a)) - R / 2 with sin a = h / R
    for height in [0.5, 1.0] {
        let cosine = (1.0 - (25.0 * height / 1000.0_f64).powi(2)).sqrt();
        let found = study(&lens, |study| study.axial_focus(D_NM, height).unwrap());
        // light travels towards -z: closer to the mirror is greater z
        near(found, 1000.0 * (0.5 / cosine - 0.5), 1e-9);
    }
}

#[test]
fn thin_pencils_at_a_sphere_obey_coddington() {
    // 1/s + 1/s' = 2 cos i / R perpendicular to the plane of incidence, 2 / (R cos i) in it; the stop at the mirror
    let (radius, angle) = (1000.0, 8.0_f64);
    let cosine = angle.to_radians().cos();
    let foci = study(&sphere(radius, 10.0, angle), |study| study.field_foci(1, D_NM).unwrap());
    // along z from the plane of the paraxial focus, light going towards -z
    near(foci.tangential, 0.5 * radius - 0.5 * radius * cosine * cosine, 1e-3);
    near(foci.sagittal, 0.5 * radius - 0.5 * radius / cosine * cosine, 1e-3);
    let axis = study(&sphere(radius, 10.0, angle), |study| study.field_foci(0, D_NM).unwrap());
    near(axis.tangential, axis.sagittal, 1e-9);
}

#[test]
fn a_stop_in_the_centre_of_curvature_leaves_no_astigmatism() {
    let (radius, angle) = (500.0, 6.0_f64);
    let lens =
        Prescription::new(vec![Surface::dummy(radius), Surface::new(-radius, -0.5 * radius, Behind::Mirror)])
            .entrance_pupil_diameter(10.0)
            .field_angles(&[0.0, angle]);
    let foci = study(&lens, |study| study.field_foci(1, D_NM).unwrap());
    // the image lies on a sphere of radius R / 2 about the centre
    let expected = -0.5 * radius * (1.0 - angle.to_radians().cos());
    near(foci.tangential, expected, 1e-6);
    near(foci.sagittal, expected, 1e-6);
}

#[test]
fn a_mirror_that_is_its_own_stop_has_no_distortion() {
    let lens = Prescription::new(vec![Surface::new(-400.0, -200.0, Behind::Mirror).conic(-1.0)])
        .entrance_pupil_diameter(10.0)
        .field_angles(&[0.0, 5.0]);
    let found = study(&lens, |study| study.distortion(1, D_NM).unwrap());
    near(found.real, 200.0 * 5f64.to_radians().tan(), 1e-11);
    near(found.relative(), 0.0, 1e-13);
    // a stop in front of a lens, and aspheres away from the stop: dh = S_V / (2 n' u') for small fields, from
    // the Seidel sum
    let mut focused = triplet().field_angles(&[0.0, 2.0]);
    focused.surfaces[6].thickness = focused.first_order(D_NM).unwrap().image_distance;
    for lens in [focused, cassegrain().field_angles(&[0.0, 0.1])] {
        let sum = Seidel::sum(&lens.seidel().unwrap()).distortion;
        let found = study(&lens, |study| study.distortion(1, D_NM).unwrap());
        let slope = -0.5 / lens.first_order(D_NM).unwrap().f_number;
        near(found.real - found.paraxial, 0.5 * sum / slope, 2e-2 * (0.5 * sum / slope).abs());
    }
}

#[test]
fn colour_follows_dispersion() {
    let lens = Prescription::new(vec![
        Surface::new(60.0, 5.0, Behind::Glass("N-BK7".to_owned())),
        Surface::new(-60.0, 40.0, Behind::Air),
        Surface::dummy(15.0),
    ])
    .stop_at(3)
    .entrance_pupil_diameter(4.0)
    .field_angles(&[0.0, 1.0])
    .wavelengths_nm(&[486.1327, D_NM, 656.2725], 1);
    let shift = study(&lens, |study| {
        study.axial_focus(486.1327, 1e-3).unwrap() - study.axial_focus(656.2725, 1e-3).unwrap()
    });
    let image = |nm: f64| lens.first_order(nm).unwrap().image_distance;
    near(shift, image(486.1327) - image(656.2725), 1e-6);
    assert!(shift < -0.5);
    // C_II / (n' u') is the lateral colour between the outer wavelengths at the paraxial focus for a small
    // field: the chief rays of the colours go through different points of a lens that aberrates
    let focused = {
        let mut lens = lens.clone().field_angles(&[0.0, 0.1]);
        lens.surfaces[2].thickness = image(D_NM);
        lens
    };
    let lateral = study(&focused, |study| {
        study.lateral_colour(1, 486.1327).unwrap() - study.lateral_colour(1, 656.2725).unwrap()
    });
    let sum = Seidel::sum(&focused.seidel().unwrap()).lateral_colour;
    let slope = -0.5 / focused.first_order(D_NM).unwrap().f_number;
    near(lateral.abs(), (sum / slope).abs(), 2e-2 * (sum / slope).abs());
}

#[test]
fn rays_are_aimed_at_the_stop() {
    // a wide field, whose chief ray through the paraxial pupil misses the centre of the stop by far
    let lens = triplet().field_angles(&[0.0, 20.0]);
    let radius = lens.first_order(D_NM).unwrap().stop_semi_diameter;
    let points = hexapolar(4);
    let at_stop = |beam: &Beam, k: usize| lens.follow(&beam.get(k).ray, D_NM).unwrap()[4].point / radius;
    let (plain, aimed) = (lens.beam(1, D_NM, &points).unwrap(), lens.beam_at_stop(1, D_NM, &points).unwrap());
    assert!(at_stop(&plain, 0).y.abs() > 0.01);
    for (k, [x, y]) in points.iter().enumerate() {
        near(at_stop(&aimed, k).x, *x, 2e-11);
        near(at_stop(&aimed, k).y, *y, 2e-11);
    }
    // the solids agree: a stop of this size transmits the rays inside and blocks those outside
    let mut stopped = lens.clone();
    stopped.surfaces[4].semi_diameter = Some(radius);
    let count = |scale: f64| {
        let points: Vec<[f64; 2]> = points.iter().skip(1).map(|p| p.map(|c| c * scale)).collect();
        let layout = stopped.assembly().unwrap();
        let system = layout.assembly.compile().unwrap();
        let tracer = Tracer::new(&system, Packets::new);
        Study::new(&stopped, &layout, &tracer).aimed().arrivals(1, D_NM, &points).unwrap().len()
    };
    assert_eq!((count(0.9999), count(1.0001)), (60, 36));
}

/// A lens with a field of 100 degrees: a negative meniscus far in front of a stop and a positive lens. The
/// coefficient of its third-order pupil aberration is so large that the paraxial pupil is useless.
fn wide_angle() -> Prescription {
    Prescription::new(vec![
        Surface::new(45.0, 2.0, index(1.6)),
        Surface::new(11.0, 16.0, Behind::Air),
        Surface::dummy(1.0),
        Surface::new(20.0, 3.0, index(1.7)),
        Surface::new(-18.0, 20.0, Behind::Air),
    ])
    .entrance_pupil_diameter(1.0)
    .field_angles(&[0.0, 25.0, 50.0])
    .stop_at(3)
}

#[test]
fn the_principal_ray_goes_through_the_centre_of_the_stop() {
    // behind a plane plate the ray has its original direction: a stop there has no distortion at any angle
    let plate = Prescription::new(vec![Surface::new(f64::INFINITY, 10.0, index(1.5)), Surface::dummy(50.0)])
        .stop_at(2)
        .field_angles(&[0.0, 30.0, 50.0]);
    for field in [1, 2] {
        let found = study(&plate, |study| study.distortion(field, D_NM).unwrap());
        near(found.real, 50.0 * plate.fields[field][1].to_radians().tan(), 1e-9);
        near(found.relative(), 0.0, 1e-11);
        // the entrance pupil moves by T (tan a' - tan a / n) perpendicular to the axis
        let angle = plate.fields[field][1].to_radians();
        let inside = (angle.sin() / 1.5).asin();
        let [x, y] = plate.chief_ray_pupil_point(field, D_NM).unwrap();
        near(x, 0.0, 1e-10);
        near(y, (10.0 * (angle.tan() / 1.5 - inside.tan())) / 0.5, 1e-9);
    }

    let lens = wide_angle();
    for field in [1, 2] {
        // the same ray by bisection for its height on the first vertex plane
        let slope = lens.fields[field][1].to_radians().tan();
        let ray = |height: f64| {
            let direction = Vec3::new(0.0, slope, 1.0);
            Ray::new(Vec3::Y * height - 100.0 * direction, direction)
        };
        let passes = |height: f64| lens.follow(&ray(height), D_NM).ok();
        let (mut low, mut high) = (-16.0, 0.0);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            let is_low = passes(middle).is_none_or(|passes| passes[2].point.y < 0.0);
            (low, high) = if is_low { (middle, high) } else { (low, middle) };
        }
        let expected = passes(high).unwrap()[5].point.y;
        let found = study(&lens, |study| study.distortion(field, D_NM).unwrap());
        near(found.real, expected.abs(), 1e-9);
        let foci = study(&lens, |study| study.field_foci(field, D_NM).unwrap());
        assert!(foci.tangential.is_finite() && foci.sagittal.is_finite(), "{foci:?}");
    }
}

#[test]
fn rays_that_have_to_be_aimed_are_not_traced_unaimed() {
    let lens = wide_angle();
    let points = hexapolar(3);
    let refused = study(&lens, |study| study.arrivals(2, D_NM, &points).unwrap_err().to_string());
    assert!(refused.starts_with("the real entrance pupil of field 2 is "), "{refused}");
    assert!(refused.ends_with(" of the stop. Aim the rays at the stop."), "{refused}");
    let refusals = study(&lens, |study| {
        [study.wavefront(2, D_NM, &points).is_err(), study.fan(2, D_NM, &fan_y(5)).is_err()]
    });
    assert_eq!(refusals, [true; 2]);
    let aimed = |field: usize| {
        let layout = lens.assembly().unwrap();
        let system = layout.assembly.compile().unwrap();
        let tracer = Tracer::new(&system, Packets::new);
        let study = Study::new(&lens, &layout, &tracer).aimed();
        // the rays at the rim of the stop touch it
        let inside: Vec<[f64; 2]> = points.iter().map(|point| point.map(|x| 0.99 * x)).collect();
        (
            study.arrivals(field, D_NM, &inside).unwrap().len(),
            study.wavefront(field, D_NM, &inside).unwrap().rms(),
        )
    };
    for field in [0, 1, 2] {
        let (count, rms) = aimed(field);
        assert_eq!(count, points.len());
        assert!(rms.is_finite());
    }
    // the triplet has little pupil aberration
    assert!(study(&triplet(), |study| study.wavefront(1, D_NM, &points).is_ok()));
}

/// The RMS radius of the aimed rays of a field, traced through the solids, with the weights of Gaussian quadrature.
fn aimed_spot(lens: &Prescription, field: usize) -> f64 {
    let PupilQuadrature { points, weights } = PupilQuadrature::gaussian(6);
    let layout = lens.assembly().unwrap();
    let system = layout.assembly.compile().unwrap();
    let tracer = Tracer::new(&system, Packets::new);
    let rays = Study::new(lens, &layout, &tracer).aimed().arrivals(field, D_NM, &points).unwrap();
    assert_eq!(rays.len(), points.len());
    let sum =
        |of: &dyn Fn(Vec3) -> f64| rays.iter().map(|ray| weights[ray.id] * of(ray.position)).sum::<f64>();
    let centroid = Vec3::new(sum(&|p| p.x), sum(&|p| p.y), 0.0) / sum(&|_| 1.0);
    (sum(&|p| (p - centroid).length_squared()) / sum(&|_| 1.0)).sqrt()
}

/// The spot that an optimiser reports for aimed rays is that of the solids, and the smallest one.
#[test]
fn wide_fields_are_optimised_with_aimed_rays() {
    let lens = wide_angle();
    let goal = Goal::equal(Operand::Spot { field: 2, wavelength_nm: Some(D_NM) }, 0.0);
    let optimiser = Optimiser::new(&lens).vary("thickness 5".parse().unwrap()).goal(goal);
    let found = optimiser.clone().aimed().run().unwrap();
    let [before, after] = found.goals[0].values;
    assert!((before / aimed_spot(&lens, 2) - 1.0).abs() < 1e-9, "{before}");
    assert!((after / aimed_spot(&found.lens, 2) - 1.0).abs() < 1e-9 && after < before, "{found:?}");
    for step in [-0.05, 0.05] {
        let mut beside = found.lens.clone();
        beside.surfaces[4].thickness += step;
        assert!(aimed_spot(&beside, 2) > after);
    }
    // through the paraxial pupil there is no light, or light of another part of the stop
    assert!(optimiser.run().map_or(true, |other| (other.goals[0].values[0] / before - 1.0).abs() > 0.01));
}

#[test]
fn rays_are_aimed_at_a_stop_behind_a_mirror() {
    let lens = |surfaces: Vec<Surface>| {
        let stop = surfaces.len();
        let lens = Prescription::new(surfaces).entrance_pupil_diameter(4.0).stop_at(stop);
        Prescription { fields: vec![[0.0; 2], [4.0, 0.0]], ..lens }
    };
    let glass = [Surface::new(60.0, 5.0, index(1.5)), Surface::new(-60.0, 10.0, Behind::Air)];
    let [front, back] = glass;
    let straight = lens(vec![front.clone(), back.clone(), Surface::dummy(10.0), Surface::dummy(15.0)]);
    let mirror = Surface::new(f64::INFINITY, 0.0, Behind::Mirror);
    let tilt = |before| CoordinateBreak::new(before, [0.0; 2], [45.0, 0.0, 0.0]);
    let folded = lens(vec![front, back, mirror, Surface::dummy(-10.0), Surface::dummy(-15.0)]);
    let folded = folded.broken(tilt(3)).broken(tilt(4));
    let [expected, found] = [&straight, &folded].map(|lens| lens.chief_ray_pupil_point(1, D_NM).unwrap());
    assert!(expected[0].abs() > 1e-3);
    near(found[0], expected[0], 1e-9);
    near(found[1], expected[1], 1e-9);
}

/// A system without a prescription: a grating, an ideal lens and a detector.
#[test]
fn a_spectrometer() {
    let sheet = |z: f64| {
        let map = Affine::translate(Vec3::Z * z);
        Sheet::plane(Aperture::circle(200.0)).unwrap().apply(&map).unwrap()
    };
    let (lines_per_mm, focal_length) = (600.0, 100.0);
    let grating = Action::Grating { lines: lines_per_mm * Vec3::X, order: 1, reflects: false };
    let system = Assembly::new()
        .add(Element::sheet("grating", sheet(0.0), grating))
        .add(Element::sheet("lens", sheet(50.0), Action::ThinLens { focal_length }))
        .add(Element::sheet("detector", sheet(50.0 + focal_length), Action::Absorb))
        .compile()
        .unwrap();
    let tracer = Tracer::new(&system, Packets::new);
    for wavelength_nm in [400.0, 550.0, 633.0] {
        let light = |p: &[f64; 2]| Light::new([5.0 * p[0], 5.0 * p[1], -20.0], Vec3::Z, wavelength_nm);
        let beam: Beam = hexapolar(5).iter().map(light).collect();
        let trace = tracer.trace(&beam, &TraceSettings::default()).unwrap();
        let rays = arrivals(&system, &trace.segments, "detector", Some(&[0, 1, 2])).unwrap();
        let spot = Spot::of(&rays).unwrap();
        assert_eq!(spot.rays, 91);
        // sin(b) = m wavelength / d, and the lens maps an angle to f tan(b)
        let sine = lines_per_mm * wavelength_nm * 1e-6;
        near(spot.centroid[0], focal_length * sine / (1.0 - sine * sine).sqrt(), 1e-12);
        near(spot.rms, 0.0, 1e-12);
        near(best_focus(&rays).unwrap(), 0.0, 1e-11);
    }
}

/// Light at an angle of incidence a leaves a plate t tan(b), sin(b) = sin(a) / n, away from where it enters.
#[test]
fn fans_about_the_primary_wavelength_contain_lateral_colour() {
    let glass = Behind::Abbe { n_d: 1.7, v_d: 30.0 };
    let surfaces = vec![Surface::new(f64::INFINITY, 8.0, glass.clone()), Surface::dummy(1.0)];
    let mut plate =
        Prescription::new(surfaces).entrance_pupil_diameter(2.0).wavelengths_nm(&[486.1327, D_NM], 1);
    plate.fields = vec![[0.0, 30.0]];
    let medium = glass.medium().unwrap().unwrap();
    let tan = |line: f64| {
        let sin = 0.5 / medium.index(line).re;
        sin / (1.0 - sin * sin).sqrt()
    };
    study(&plate, |study| {
        let about = |reference: f64| study.fan_about(0, 486.1327, reference, &fan_y(5)).unwrap().errors[2];
        near(about(D_NM)[1], 8.0 * (tan(486.1327) - tan(D_NM)), 1e-12);
        assert_eq!(about(486.1327), [0.0; 2]);
        assert_eq!(study.fan(0, 486.1327, &fan_y(5)), study.fan_about(0, 486.1327, 486.1327, &fan_y(5)));
    });
}

#[test]
fn fans_and_stops() {
    let lens = doublet();
    study(&lens, |study| {
        let fan = study.fan(1, D_NM, &fan_y(21)).unwrap();
        assert_eq!((fan.pupil[10], fan.errors[10]), ([0.0; 2], [0.0; 2]));
        assert!(fan.errors.iter().all(|error| error[0].abs() < 1e-12));
        // the fan across the field is symmetric
        let fan = study.fan(1, D_NM, &fan_x(21)).unwrap();
        for k in 0..10 {
            near(fan.errors[k][0], -fan.errors[20 - k][0], 1e-12);
            near(fan.errors[k][1], fan.errors[20 - k][1], 1e-12);
        }
        let white = study.polychromatic(0, &hexapolar(3)).unwrap();
        assert_eq!(white.len(), 37);
        assert!(matches!(study.fan(7, D_NM, &fan_y(3)), Err(LensAnalysisError::Prescription(_))));
    });
    // the secondary mirror blocks the centre of the pupil, but not the reference ray
    study(&cassegrain(), |study| {
        let found = study.wavefront(0, D_NM, &hexapolar(8)).unwrap();
        assert!(found.waves.len() > 150 && found.waves.len() < 217);
        assert!(found.waves.iter().all(|wave| wave.abs() < 1e-6), "{:?}", found.peak_to_valley());
    });
    let layout = lens.assembly().unwrap();
    let system = layout.assembly.compile().unwrap();
    let beam = lens.beam(0, D_NM, &hexapolar(2)).unwrap();
    let trace = Tracer::new(&system, Packets::new).trace(&beam, &TraceSettings::default()).unwrap();
    assert_eq!(arrivals(&system, &trace.segments, "image", None).unwrap().len(), 19);
    assert_eq!(arrivals(&system, &trace.segments, "image", Some(&[0, 2])).unwrap().len(), 0);
    let unknown = arrivals(&system, &trace.segments, "film", None).unwrap_err();
    assert_eq!(unknown.to_string(), "there is no sheet `film`: the image has to be a sheet of the system.");
    assert_eq!(index(1.5), Behind::Index(1.5));
}
