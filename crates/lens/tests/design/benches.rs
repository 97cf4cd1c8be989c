//! The systems of `models/optics` without a prescription: model files with `[optics]` tables.

use crate::lenses::near;
use rayweave_lens::analysis::{Arrival, Spot, arrivals};
use rayweave_optics::file::optics_of;
use rayweave_optics::{Trace, Tracer};
use rayweave_scene::parse_with;
use rayweave_trace::Packets;

/// The light at the screen of a model with some parameters redefined.
fn screen(name: &str, definitions: &[(&str, &str)]) -> (Vec<Arrival>, Trace) {
    let path = format!("{}/../../models/optics/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(path).unwrap();
    let owned = |(name, value): &(&str, &str)| ((*name).to_owned(), (*value).to_owned());
    let definitions: Vec<_> = definitions.iter().map(owned).collect();
    let (document, scene) = parse_with(&text, &definitions).unwrap_or_else(|problems| panic!("{problems}"));
    let optics = optics_of(&document, &scene).unwrap_or_else(|problems| panic!("{problems}"));
    let system = optics.assembly.compile().unwrap();
    let trace = Tracer::new(&system, Packets::new).trace(&optics.sources, &optics.settings).unwrap();
    assert!(trace.balance.error().abs() < 1e-12);
    (arrivals(&system, &trace.segments, "screen", None).unwrap(), trace)
}

/// The rays of one spectral line.
fn line(all: &[Arrival], wavelength_nm: f64) -> Vec<Arrival> {
    all.iter().filter(|ray| (ray.wavelength_nm - wavelength_nm).abs() < 1e-6).copied().collect()
}

const MERCURY: [f64; 3] = [546.075, 576.961, 579.067];

#[test]
fn a_spectrometer_obeys_the_grating_equation() {
    let (all, _) = screen("czerny-turner", &[]);
    assert_eq!(all.len(), 3000, "light is lost");
    let spots = MERCURY.map(|nm| Spot::of(&line(&all, nm)).unwrap());
    // sin b = sin a - lines * wavelength, and a focal length of R cos(focusing) / 2; the screen is placed
    // for 550 nm
    let out = |nm: f64| (34.976_892_736_994_1_f64.to_radians().sin() - 1200.0 * nm * 1e-6).asin();
    let focal_length = 100.0 * 6.944_507_463_851_923_f64.to_radians().cos();
    for (spot, nm) in spots.iter().zip(MERCURY) {
        let expected = focal_length * (out(nm) - out(550.0)).tan();
        near(spot.centroid[0].abs(), expected.abs(), 0.02 * expected.abs() + 1e-3);
    }
    // the yellow doublet is 2.1 nm wide, and the lines are narrower along the spectrum than 0.1 nm: 12
    // micrometres
    let apart = (spots[2].centroid[0] - spots[1].centroid[0]).abs();
    near(apart, focal_length * (out(MERCURY[1]) - out(MERCURY[2])).abs(), 0.03 * apart);
    assert!(spots.iter().all(|spot| spot.rms_xy[0] < 0.012), "{spots:?}");
}

/// The third moment of a line along the spectrum over the cube of its width: 0 without coma.
fn skewness(rays: &[Arrival]) -> f64 {
    let spot = Spot::of(rays).unwrap();
    let cubes = rays.iter().map(|ray| (ray.position.x - spot.centroid[0]).powi(3));
    cubes.sum::<f64>() / rays.len() as f64 / spot.rms_xy[0].powi(3)
}

#[test]
fn shafers_condition_removes_coma() {
    let one = |focusing: &str| {
        let (all, _) = screen("czerny-turner", &[("focusing", focusing)]);
        let green = line(&all, MERCURY[0]);
        (skewness(&green), Spot::of(&green).unwrap().rms_xy[0])
    };
    let (good, width) = one("6.944507463851923");
    let (small, wide) = one("5.5");
    let (large, wider) = one("8.5");
    // it has opposite signs on both sides, and the line is narrowest in between
    assert!(small * large < 0.0 && good.abs() < 0.3 * small.abs().min(large.abs()), "{small} {good} {large}");
    assert!(width < 0.8 * wide.min(wider), "{wide} {width} {wider}");
}

#[test]
fn a_fibre_guides_light_within_its_numerical_aperture() {
    let (kept, trace) = screen("fibre-coupling", &[]);
    near(trace.balance.emitted, 1.0, 1e-12);
    assert_eq!(kept.len(), 2000);
    // all rays within the core
    assert!(kept.iter().all(|ray| ray.position.x.hypot(ray.position.y) < 0.1 + 0.01));
    // a wider beam: the ball turns a ray at height h by 2 (asin(h / r) - asin(h / n r)), and the core guides
    // rays that cross the axis and enter below the angle of its numerical aperture
    let n = 1.5168;
    let turn = |h: f64| 2.0 * ((h / 2.5).asin() - (h / (n * 2.5)).asin());
    let (mut low, mut high) = (0.0, 2.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if turn(middle).sin() < 0.22 { low = middle } else { high = middle }
    }
    let (kept, _) = screen("fibre-coupling", &[("beam", "2.4")]);
    let held = kept.iter().map(|ray| ray.power).sum::<f64>();
    near(held, (low / 1.2).powi(2), 2e-3);
}
