//! Phases along rays against closed forms.

use num_complex::Complex64;
use rayweave_math::Vec3;
use rayweave_model::Solid;
use rayweave_optics::component::{Aperture, window};
use rayweave_optics::interface::Film;
use rayweave_optics::{
    Assembly, Beam, Branches, Element, Event, Finish, Light, Medium, Phases, Segments, System, TraceSettings,
    Tracer,
};
use rayweave_shape::primitive::{CentredBox, Primitive};
use rayweave_trace::Weave;
use std::f64::consts::PI;

fn glass(n: f64) -> Medium {
    Medium::constant("glass", n, 0.0).unwrap()
}

fn system(solid: Solid, n: f64, finish: Finish) -> System {
    Assembly::new().add(Element::transparent("plate", solid, &glass(n)).finish(finish)).compile().unwrap()
}

fn traced(system: &System, origin: Vec3, direction: Vec3, nm: f64) -> (Segments, Phases) {
    let light = Light::new(origin, direction, nm);
    let settings = TraceSettings { branches: Branches::Both, threshold: 1e-26, ..TraceSettings::default() };
    let tracer = Tracer::new(system, Weave::new);
    let trace = tracer.trace(&[light].into_iter().collect::<Beam>(), &settings).unwrap();
    let phases = tracer.phases(&trace.segments);
    (trace.segments, phases)
}

/// The amplitude of all light that leaves along a direction.
fn amplitude(segments: &Segments, phases: &[f64], along: Vec3) -> Complex64 {
    let rows = segments.iter().zip(phases);
    let leaves = rows.filter(|(row, _)| row.event == Event::Escaped && row.direction.dot(along) > 0.9);
    leaves.map(|(row, phase)| Complex64::from_polar(row.intensity.sqrt(), phase.to_radians())).sum()
}

/// A plate in air: the sum of all transmitted beams is Airy's function of its thickness, and the
/// rest is reflected (Born & Wolf, *Principles of Optics*, 7th edition, section 7.6.1, equations 11
/// to 15).
#[test]
fn beams_of_an_etalon_add_up_to_airys_formula() {
    let (n, thickness) = (1.8, 0.5);
    let plate = system(window(thickness, Aperture::circle(10.0)).unwrap(), n, Finish::Polished);
    let reflectance = ((n - 1.0) / (n + 1.0)).powi(2);
    let finesse = 4.0 * reflectance / (1.0 - reflectance).powi(2);
    for nm in [500.0, 500.03, 500.05, 500.08, 632.8] {
        let (segments, phases) = traced(&plate, Vec3::new(0.1, 0.2, -7.0), Vec3::Z, nm);
        let half = 2.0 * PI * n * thickness * 1e6 / nm;
        let expected = 1.0 / (1.0 + finesse * half.sin().powi(2));
        for own in [&phases.s, &phases.p] {
            let through = amplitude(&segments, own, Vec3::Z).norm_sqr();
            let back = amplitude(&segments, own, -Vec3::Z).norm_sqr();
            assert!((through - expected).abs() < 1e-8, "{nm}: {through} {expected}");
            assert!((through + back - 1.0).abs() < 1e-8, "{nm}: {through} {back}");
        }
    }
}

/// The phase jump between a row and its parent, in degrees.
fn jump(segments: &Segments, phases: &[f64], child: usize) -> f64 {
    let parent = segments.parent[child] as usize;
    let own =
        |row: usize| phases[row] - 360.0 * (segments.path[row] * 1e6 / segments.wavelength_nm[row]).fract();
    (own(child) - own(parent)).rem_euclid(360.0)
}

fn near(found: f64, degrees: f64) {
    let off = (found - degrees + 180.0).rem_euclid(360.0) - 180.0;
    assert!(off.abs() < 1e-6, "{found} is not {degrees}");
}

/// `tan(s / 2) = -sqrt(sin^2 - n^2) / cos` and `tan(p / 2) = -sqrt(sin^2 - n^2) / (n^2 cos)` with n the index behind over
/// that in front (Born & Wolf, section 1.5.4, equation 60).
#[test]
fn total_reflection_delays_s_and_p_differently() {
    let n = 1.51;
    let block = system(
        Solid::from(Primitive::from(CentredBox::new(Vec3::splat(10.0)).unwrap())),
        n,
        Finish::Polished,
    );
    for degrees in [20.0_f64, 45.0, 65.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (segments, phases) = traced(
            &block,
            Vec3::new(4.0 - 2.0 * sin, 0.3, -5.0 - 2.0 * cos),
            Vec3::new(sin, 0.0, cos),
            500.0,
        );
        let is_first = |row: &usize| segments.generation[*row] == 2 && segments.parent[*row] >= 0;
        let reflected = (0..segments.len())
            .filter(is_first)
            .find(|&row| segments.event[segments.parent[row] as usize] == Event::TotallyReflected as u8);
        let row = reflected.unwrap();
        // on the face x = 5: the angle of incidence is 90 degrees less that of refraction
        let (sin, cos) = ((1.0 - (sin / n).powi(2)).sqrt(), sin / n);
        let ratio = 1.0 / n;
        let root = (sin * sin - ratio * ratio).sqrt();
        near(jump(&segments, &phases.s, row), -2.0 * (root / cos).atan().to_degrees());
        near(jump(&segments, &phases.p, row), -2.0 * (root / (ratio * ratio * cos)).atan().to_degrees());
    }
}

/// A jump of half a wave for light from the thinner medium, none for light from the denser one; p
/// changes sign at Brewster's angle, and refracted light has no jump (Born & Wolf, section 1.5.3).
#[test]
fn reflection_from_a_denser_medium_reverses() {
    let n = 1.5;
    let plate = system(window(2.0, Aperture::circle(50.0)).unwrap(), n, Finish::Polished);
    for (degrees, [s, p], [s_within, p_within]) in [
        (0.0_f64, [180.0, 0.0], [0.0, 180.0]),
        (40.0, [180.0, 0.0], [0.0, 180.0]),
        (70.0, [180.0, 180.0], [0.0, 0.0]),
    ] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (segments, phases) =
            traced(&plate, Vec3::new(-3.0 * sin, 0.0, -1.0 - 3.0 * cos), Vec3::new(sin, 0.0, cos), 600.0);
        let rows: Vec<usize> = (1..segments.len()).filter(|&row| segments.generation[row] <= 2).collect();
        assert!(rows.len() >= 4);
        for row in rows {
            let parent = segments.parent[row] as usize;
            let turns = segments.direction[2][row] * segments.direction[2][parent] < 0.0;
            let expected = match (turns, segments.index[parent] == 1.0) {
                (false, _) => [0.0, 0.0],
                (true, true) => [s, p],
                (true, false) => [s_within, p_within],
            };
            near(jump(&segments, &phases.s, row), expected[0]);
            near(jump(&segments, &phases.p, row), expected[1]);
        }
    }
}

/// One film, by the sum of its beams: `r = (r1 + r2 e^(2 i b)) / (1 + r1 r2 e^(2 i b))`, from either side (Born & Wolf, section
/// 1.6.4, equation 57).
#[test]
fn a_film_delays_by_the_argument_of_its_sum_of_beams() {
    let (n, film, d, nm) = (1.6, 1.38, 137.0, 520.0);
    let coat = Finish::Coated(vec![Film::new(film, 0.0, d)]);
    let plate = system(window(2.0, Aperture::circle(50.0)).unwrap(), n, coat);
    let (segments, phases) = traced(&plate, Vec3::new(0.0, 0.0, -5.0), Vec3::Z, nm);
    let turn = Complex64::from_polar(1.0, 4.0 * PI * film * d / nm);
    let sum = |r1: f64, r2: f64| ((r1 + r2 * turn) / (1.0 + r1 * r2 * turn)).arg().to_degrees();
    let [first, second] = [(1.0 - film) / (1.0 + film), (film - n) / (film + n)];
    for row in (1..segments.len()).filter(|&row| segments.generation[row] <= 3) {
        let parent = segments.parent[row] as usize;
        if segments.direction[2][row] * segments.direction[2][parent] < 0.0 {
            let from_air = segments.index[parent] == 1.0;
            let expected = if from_air { sum(first, second) } else { sum(-second, -first) };
            near(jump(&segments, &phases.s, row), expected);
        }
    }
}
