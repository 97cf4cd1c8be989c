//! Optimisations with closed-form solutions.

use crate::lenses::near;
use rayweave_lens::analysis::{Study, square};
use rayweave_lens::design::{DesignParameter, Goal, Operand, Optimiser, Optimum, SeidelTerm};
use rayweave_lens::prescription::{Behind, Prescription, Surface};
use rayweave_optics::Tracer;
use rayweave_trace::Packets;

fn parameter(name: &str) -> DesignParameter {
    name.parse().unwrap()
}

/// A thin equiconvex singlet of index n, the start of the search.
fn singlet(n: f64) -> Prescription {
    let surfaces =
        vec![Surface::new(110.0, 0.01, Behind::Index(n)), Surface::new(-110.0, 100.0, Behind::Air)];
    Prescription::new(surfaces).entrance_pupil_diameter(10.0)
}

fn shape(lens: &Prescription) -> f64 {
    let [r1, r2] = [lens.surfaces[0].radius, lens.surfaces[1].radius];
    (r2 + r1) / (r2 - r1)
}

/// The singlet of the best form: its two curvatures and the image distance minimise the wavefront error.
fn best_form(n: f64) -> Optimum {
    let start = singlet(n);
    Optimiser::new(&start)
        .vary(parameter("curvature 1"))
        .vary(parameter("curvature 2"))
        .vary(parameter("thickness 2"))
        .goal(Goal::equal(Operand::FocalLength, 100.0).weight(100.0))
        .goal(Goal::equal(Operand::Wavefront { field: 0, wavelength_nm: 587.5618 }, 0.0))
        .run()
        .unwrap()
}

#[test]
fn the_singlet_of_best_form() {
    // E. Hecht, Optics, section 6.3.1; W. J. Smith: q = 2 (n^2 - 1) / (n + 2) for distant objects
    for n in [1.5, 1.7] {
        let found = best_form(n);
        let q = 2.0 * (n * n - 1.0) / (n + 2.0);
        near(shape(&found.lens), q, 5e-3);
        near(found.lens.first_order(587.5618).unwrap().focal_length, 100.0, 1e-4);
        assert!(found.after < found.before, "{found:?}");
    }
}

/// The goals of a field off the axis have the RMS of the study over the same points.
#[test]
fn wavefront_goals_have_the_rms_of_both_references() {
    // a paraboloid has coma
    let lens = Prescription::new(vec![Surface::new(-400.0, -200.0, Behind::Mirror).conic(-1.0)])
        .entrance_pupil_diameter(40.0)
        .field_angles(&[0.0, 0.5]);
    let nm = 587.5618;
    let found = Optimiser::new(&lens)
        .vary(parameter("thickness 1"))
        .goal(Goal::equal(Operand::Wavefront { field: 1, wavelength_nm: nm }, 0.0))
        .goal(Goal::equal(Operand::WavefrontAboutChiefRay { field: 1, wavelength_nm: nm }, 0.0))
        .rings(12)
        .run()
        .unwrap();
    let layout = lens.assembly().unwrap();
    let system = layout.assembly.compile().unwrap();
    let tracer = Tracer::new(&system, Packets::new);
    let even = square(201).into_iter().filter(|[x, y]| x.hypot(*y) < 0.999).collect::<Vec<_>>();
    let front = Study::new(&lens, &layout, &tracer).wavefront(1, nm, &even).unwrap();
    let [centroid, chief] = [0, 1].map(|k: usize| found.goals[k].values[0]);
    near(centroid, front.rms(), 0.01 * centroid);
    near(chief, front.rms_about_chief_ray(), 0.01 * chief);
    assert!(chief > 2.0 * centroid, "{chief} {centroid}");
}

#[test]
fn a_conic_without_spherical_aberration_is_descartes_s() {
    // a plane-hyperbolic lens with its plane towards the light: k = -n^2, exactly (Hecht, section 5.2.1)
    let n = 1.6;
    let surfaces =
        vec![Surface::new(f64::INFINITY, 6.0, Behind::Index(n)), Surface::new(-60.0, 100.0, Behind::Air)];
    let start = Prescription::new(surfaces).entrance_pupil_diameter(30.0);
    let found = Optimiser::new(&start)
        .vary(parameter("conic 2"))
        .vary(parameter("thickness 2"))
        .goal(Goal::equal(Operand::Spot { field: 0, wavelength_nm: Some(587.5618) }, 0.0))
        .run()
        .unwrap();
    assert!(found.has_converged, "{}", found.reason);
    assert!(found.after < 1e-9, "{}", found.after);
    near(found.lens.surfaces[1].conic, -n * n, 1e-7);
    near(found.lens.surfaces[1].thickness, 60.0 / (n - 1.0), 1e-7);
}

/// Transverse aberrations a rho^3 + b rho have the smallest RMS at b = -a mean(rho^4) / mean(rho^2) = -2 a / 3 over a
/// disk: the best focus lies at two thirds of the longitudinal aberration of the marginal ray. A spherical mirror
/// sends that ray, at the sine s = h / R of its angle of incidence, to R (1 / sqrt(1 - s^2) - 1) / 2 from the
/// paraxial focus; higher orders change the ratio by about s^2.
#[test]
fn the_best_focus_of_a_spherical_mirror() {
    let start =
        Prescription::new(vec![Surface::new(-200.0, -100.0, Behind::Mirror)]).entrance_pupil_diameter(20.0);
    let s = 10.0_f64 / 200.0;
    let marginal = 100.0 * ((1.0 - s * s).sqrt().recip() - 1.0);
    for rings in [2, 4, 6] {
        let found = Optimiser::new(&start)
            .vary(parameter("thickness 1"))
            .goal(Goal::equal(Operand::Spot { field: 0, wavelength_nm: Some(587.5618) }, 0.0))
            .rings(rings)
            .run()
            .unwrap();
        let shift = found.lens.surfaces[0].thickness + 100.0;
        near(shift / marginal, 2.0 / 3.0, s * s);
        // the RMS radius there is a third of that of the marginal ray's circle of least confusion times sqrt(1/2)
        near(found.after, marginal * 0.1 / 6.0, 0.01 * marginal * 0.1 / 6.0);
    }
}

#[test]
fn an_achromat_has_the_powers_that_cancel() {
    let lines = [486.1327, 587.5618, 656.2725];
    let glass = |name: &str| Behind::Glass(name.to_owned());
    let surfaces = vec![
        Surface::new(60.0, 1e-4, glass("N-BK7")),
        Surface::new(-60.0, 1e-4, glass("N-SF5")),
        Surface::new(-300.0, 100.0, Behind::Air),
    ];
    let start = Prescription::new(surfaces).entrance_pupil_diameter(10.0).wavelengths_nm(&lines, 1);
    let found = Optimiser::new(&start)
        .vary(parameter("curvature 2"))
        .vary(parameter("curvature 3"))
        .goal(Goal::equal(Operand::FocalLength, 100.0))
        .goal(Goal::equal(Operand::Seidel(SeidelTerm::AxialColour), 0.0).weight(1e3))
        .run()
        .unwrap();
    assert!(found.after < 1e-9, "{} {}", found.after, found.reason);
    let index = |name: &str, line: f64| rayweave_optics::glass::glass(name).unwrap().index(line).unwrap();
    let power = |name: &str, k: usize| {
        let [a, b] = [k, k + 1].map(|k| 1.0 / found.lens.surfaces[k].radius);
        (index(name, lines[1]) - 1.0) * (a - b)
    };
    let abbe = |name: &str| (index(name, lines[1]) - 1.0) / (index(name, lines[0]) - index(name, lines[2]));
    let (v1, v2) = (abbe("N-BK7"), abbe("N-SF5"));
    // thin lenses in contact: power V1 / (V1 - V2) and -V2 / (V1 - V2); their thickness is 1e-6 of the focal
    // length
    near(power("N-BK7", 0), 0.01 * v1 / (v1 - v2), 1e-6);
    // the contribution of a goal is the square of its weighted deviation
    let [focal, colour] = found.goals[..] else { panic!("{:?}", found.goals) };
    near(focal.values[0], start.first_order(lines[1]).unwrap().focal_length, 1e-12);
    near(focal.contributions[0], (focal.values[0] - 100.0) * (focal.values[0] - 100.0), 1e-9);
    near(colour.contributions[0], 1e6 * colour.values[0] * colour.values[0], 1e-9);
    let sum = focal.contributions[0] + colour.contributions[0];
    near(sum.sqrt(), found.before, 1e-12 * found.before);
    near(focal.values[1], 100.0, 1e-9);
    near(power("N-SF5", 1), -0.01 * v2 / (v1 - v2), 1e-6);
}

/// A narrow beam through a plate at an angle of incidence a leaves its face t tan(b), sin(b) = sin(a) / n, away from
/// the axis, so that two colours are t (tan(b1) - tan(b2)) apart. The RMS radius of two points of weights v and w
/// about their centroid is their distance times sqrt(v w) / (v + w).
#[test]
fn a_spot_of_all_wavelengths_contains_lateral_colour() {
    let lines = [486.1327, 656.2725];
    let glass = Behind::Abbe { n_d: 1.7, v_d: 30.0 };
    let surfaces = vec![Surface::new(f64::INFINITY, 8.0, glass.clone()), Surface::dummy(1.0)];
    let mut plate = Prescription::new(surfaces).entrance_pupil_diameter(1e-7).wavelengths_nm(&lines, 0);
    plate.fields = vec![[0.0, 30.0]];
    plate.lines[1].weight = 3.0;
    let medium = glass.medium().unwrap().unwrap();
    let tan = |line: f64| {
        let sin = 0.5 / medium.index(line).re;
        sin / (1.0 - sin * sin).sqrt()
    };
    let apart = 8.0 * (tan(lines[1]) - tan(lines[0]));
    let of = |wavelength_nm: Option<f64>| {
        let goal = Goal::equal(Operand::Spot { field: 0, wavelength_nm }, 0.0);
        Optimiser::new(&plate).vary(parameter("thickness 1")).goal(goal).run().unwrap()
    };
    let found = of(None);
    near(found.before, apart * 3.0_f64.sqrt() / 4.0, 1e-7);
    near(found.goals[0].values[0], found.before, 1e-12);
    // without glass there is no colour: the plate vanishes
    near(found.lens.surfaces[0].thickness, 0.0, 1e-6);
    for line in lines {
        assert!(of(Some(line)).before < 1e-6, "one wavelength has no lateral colour");
    }
}

#[test]
fn bounds_hold() {
    // a biconvex lens of a given power, as thin as its edge allows
    let surfaces = vec![Surface::new(50.0, 12.0, Behind::Index(1.5)), Surface::new(-50.0, 45.0, Behind::Air)];
    let start = Prescription::new(surfaces).entrance_pupil_diameter(20.0);
    let edge = Operand::EdgeThickness { surface: 1, height: Some(12.0) };
    let found = Optimiser::new(&start)
        .vary(parameter("thickness 1"))
        .goal(Goal::equal(Operand::Value(parameter("thickness 1")), 0.0).weight(1e-3))
        .goal(Goal::at_least(edge, 2.0).weight(1e3))
        .run()
        .unwrap();
    let sag = 50.0 - (50.0_f64 * 50.0 - 144.0).sqrt();
    near(found.lens.surfaces[0].thickness, 2.0 + 2.0 * sag, 1e-4);
    // a satisfied bound has no effect
    let centre = Operand::Value(parameter("thickness 1"));
    let idle = Optimiser::new(&start)
        .vary(parameter("thickness 1"))
        .goal(Goal::at_most(centre, 15.0))
        .goal(Goal::at_least(centre, 10.0))
        .run()
        .unwrap();
    assert_eq!((idle.lens.surfaces[0].thickness, idle.before, idle.after), (12.0, 0.0, 0.0));
}

#[test]
fn the_edge_at_the_clear_semi_diameter_follows_the_rays() {
    // the beam of a distant point on the axis fills 20 mm of the front; the back is smaller
    let surfaces = vec![Surface::new(50.0, 12.0, Behind::Index(1.5)), Surface::new(-50.0, 45.0, Behind::Air)];
    let start = Prescription::new(surfaces).entrance_pupil_diameter(20.0);
    let edge = Operand::EdgeThickness { surface: 1, height: None };
    let found = Optimiser::new(&start)
        .vary(parameter("curvature 1"))
        .goal(Goal::equal(edge, 9.0))
        .goal(Goal::equal(Operand::TotalTrack, 57.0))
        .run()
        .unwrap();
    let clear = found.lens.assembly().unwrap().semi_diameters;
    let height = clear[0].max(clear[1]);
    assert!(height > 10.0 && height < 10.5, "{height}");
    let sag = |radius: f64| radius - (radius * radius - height * height).sqrt();
    near(12.0 - sag(50.0) - sag(found.lens.surfaces[0].radius), 9.0, 1e-9);
    // the track did not change
    assert_eq!(found.goals[1].values, [57.0; 2]);
}

#[test]
fn an_optimised_index_is_that_of_the_glass() {
    // the lensmaker's equation of a thin lens: 1/f = (n - 1) (1/R1 - 1/R2)
    for behind in
        [Behind::Glass("N-BK7".to_owned()), Behind::Abbe { n_d: 1.6, v_d: 60.0 }, Behind::Index(1.5)]
    {
        let surfaces = vec![Surface::new(50.0, 0.0, behind.clone()), Surface::new(-50.0, 46.0, Behind::Air)];
        let start = Prescription::new(surfaces).entrance_pupil_diameter(10.0);
        let found = Optimiser::new(&start)
            .vary(parameter("index 1"))
            .goal(Goal::equal(Operand::FocalLength, 60.0))
            .run()
            .unwrap();
        near(found.values[0].1, 1.0 + 25.0 / 60.0, 1e-9);
        let medium = found.lens.surfaces[0].behind.medium().unwrap().unwrap();
        let before = behind.medium().unwrap().unwrap();
        let change = |nm: f64| medium.index(nm).re - before.index(nm).re;
        near(change(450.0), change(650.0), 1e-15);
        assert_ne!(found.lens, start);
        let is_named = medium.as_constant().is_some() || medium.as_glass().is_some();
        assert!(is_named && medium.name() != before.name(), "{medium:?}");
    }
}

#[test]
fn refusals() {
    let start = singlet(1.5);
    let focal = Goal::equal(Operand::FocalLength, 100.0);
    let text = |optimiser: Optimiser<'_>| optimiser.run().unwrap_err().to_string();
    assert!(text(Optimiser::new(&start).goal(focal)).contains("parameter to vary"));
    assert!(text(Optimiser::new(&start).vary(parameter("radius 1"))).contains("no goal"));
    assert!(text(Optimiser::new(&start).vary(parameter("radius 9")).goal(focal)).contains("no radius 9"));
    assert!(
        text(Optimiser::new(&start).vary(parameter("tilt x 1")).goal(focal))
            .contains("decentres and tilts cannot be varied")
    );
    let spot = Goal::equal(Operand::Spot { field: 4, wavelength_nm: Some(500.0) }, 0.0);
    assert!(text(Optimiser::new(&start).vary(parameter("radius 1")).goal(spot)).contains("field"));
    // rays that miss the lens
    let wide = singlet(1.5).entrance_pupil_diameter(400.0);
    let spot = Goal::equal(Operand::Spot { field: 0, wavelength_nm: Some(500.0) }, 0.0);
    assert!(text(Optimiser::new(&wide).vary(parameter("radius 1")).goal(spot)).contains("cannot begin"));
}

/// A stop in front of a plane-parallel plate: the chief ray leaves the plate parallel to itself, and Snell's law gives its height.
#[test]
fn the_distortion_of_the_chief_ray_behind_a_plate() {
    let (thickness, n, angle) = (12.0, 1.6, 40.0);
    let lens = |distance: f64| {
        let surfaces = vec![
            Surface::new(f64::INFINITY, 3.0, Behind::Air),
            Surface::new(f64::INFINITY, thickness, Behind::Index(n)),
            Surface::new(f64::INFINITY, distance, Behind::Air),
        ];
        let mut lens = Prescription::new(surfaces).entrance_pupil_diameter(1.0);
        lens.fields = vec![[0.0; 2], [0.0, angle]];
        lens
    };
    let slope = f64::tan(f64::to_radians(angle));
    let inside = f64::tan(f64::asin(f64::sin(f64::to_radians(angle)) / n));
    let relative = |air: f64| (air * slope + thickness * inside) / (slope * (air + thickness / n)) - 1.0;
    let goal = Goal::equal(Operand::Distortion { field: 1 }, 0.0);
    let at_axis = Goal::equal(Operand::Distortion { field: 0 }, 0.0);
    let start = lens(30.0);
    let first = Optimiser::new(&start).vary(parameter("thickness 3")).goal(at_axis).goal(goal).run().unwrap();
    near(first.goals[1].values[0], relative(33.0), 1e-12);
    assert_eq!(first.goals[0].values[0], 0.0);
    // the third-order sum is a length
    let sum = Goal::equal(Operand::Seidel(SeidelTerm::Distortion), 0.0);
    let third = Optimiser::new(&start).vary(parameter("thickness 3")).goal(sum).run().unwrap();
    assert!((third.goals[0].values[0] - relative(33.0)).abs() > 1e-4);
    // the distance at which the distortion has a given value
    let goal = Goal::equal(Operand::Distortion { field: 1 }, relative(20.0)).weight(1e3);
    let found = Optimiser::new(&start).vary(parameter("thickness 3")).goal(goal).run().unwrap();
    near(found.lens.surfaces[2].thickness, 17.0, 1e-6);
    let missing = Goal::equal(Operand::Distortion { field: 2 }, 0.0);
    let error = Optimiser::new(&start).vary(parameter("thickness 3")).goal(missing).run().unwrap_err();
    assert!(error.to_string().contains("field"), "{error}");
}
