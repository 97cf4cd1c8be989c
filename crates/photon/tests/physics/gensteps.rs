//! Cerenkov and scintillation photons against closed forms and quadrature.

use crate::sources::simpson;
use crate::{CLEAR, SlabDetector, assert_binomial, assert_distribution, photons_of, run, settings, uniform};
use rayweave_math::Vec3;
use rayweave_photon::property::{HC_MEV_NM, LIGHT_SPEED};
use rayweave_photon::{
    Detector, EmissionProcess, Genstep, GenstepNumbers, Gensteps, Hits, Origin, Photon, PhotonError, Process,
    Pulse, RunSettings, ScintillationComponent, ScintillationLight, Source, Torch, WavelengthDistribution,
    cerenkov_yield, gensteps_from_array, hit_schema, photons_from_opticks, sequence_text,
};
use rayweave_trace::Packets;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::num::NonZeroUsize;

const COUNT: u32 = 20_000;

/// A slab of a material with dispersion and three components of scintillation.
fn slab() -> Detector {
    SlabDetector {
        matrices: r#"<matrix name="WATER" coldim="2" values="2*eV 1.30 3*eV 1.36 3.5*eV 1.34 5*eV 1.45"/>
<matrix name="BLUE" coldim="2" values="2.5*eV 0 3*eV 2 3.5*eV 1 4*eV 0"/>
<matrix name="RED" coldim="2" values="1.8*eV 1 2.0*eV 1"/>
<matrix name="FAST" coldim="1" values="6*ns"/><matrix name="RISE" coldim="1" values="2*ns"/>
<matrix name="SLOW" coldim="1" values="1.5*us"/><matrix name="THIRD" coldim="1" values="0.3"/>
<matrix name="REST" coldim="1" values="0.7"/>"#,
        inner: r#"<property name="RINDEX" ref="WATER"/>
<property name="SCINTILLATIONCOMPONENT1" ref="BLUE"/><property name="SCINTILLATIONTIMECONSTANT1" ref="FAST"/>
<property name="SCINTILLATIONRISETIME1" ref="RISE"/><property name="SCINTILLATIONYIELD1" ref="THIRD"/>
<property name="SCINTILLATIONCOMPONENT2" ref="RED"/><property name="SCINTILLATIONTIMECONSTANT2" ref="SLOW"/>
<property name="SCINTILLATIONYIELD2" ref="REST"/>"#,
        ..CLEAR
    }
    .build()
}

/// The index of the slab by its definition, at an energy in eV.
fn index(ev: f64) -> f64 {
    match ev {
        e if e < 3.0 => 1.30 + 0.06 * (e - 2.0),
        e if e < 3.5 => 1.36 - 0.04 * (e - 3.0),
        e => 1.34 + 0.11 / 1.5 * (e - 3.5),
    }
}

/// sin^2 of the angle of emission, 0 below the threshold.
fn sin2(ev: f64, inverse_beta: f64) -> f64 {
    (1.0 - (inverse_beta / index(ev)).powi(2)).max(0.0)
}

/// The integral of sin^2 up to an energy, in parts that end where it has a kink.
fn integral(ev: f64, inverse_beta: f64) -> f64 {
    // index 1.35 at 2.8333, 3.25 and 3.6364 eV
    let kinks = [2.0f64, 2.0 + 5.0 / 6.0, 3.0, 3.25, 3.5, 3.5 + 15.0 / 110.0, 5.0];
    let parts = kinks.windows(2).map(|part| (part[0], part[1].min(ev)));
    parts
        .filter(|(from, to)| from < to)
        .map(|(from, to)| simpson(|e| sin2(e, inverse_beta), from, to, 64))
        .sum()
}

/// A step of 40 mm in the slab, in a direction without symmetry, of a particle that slows down.
fn step(process: EmissionProcess) -> Genstep {
    let displacement = 39.0 * Vec3::new(1.0, 2.0, 2.0) / 3.0;
    Genstep {
        process,
        material: 7,
        photons: COUNT,
        position: Vec3::new(10.0, 20.0, 30.0),
        time: 5.0,
        displacement,
        step_length: 40.0,
        charge: -1.0,
        velocity: [250.0, 200.0],
    }
}

fn cerenkov(inverse_beta: f64, density: [f64; 2]) -> Genstep {
    step(EmissionProcess::Cerenkov { inverse_beta, wavelengths: [0.0, f64::INFINITY], density })
}

fn scintillation(component: Option<u32>, time: f64, rise_time: Option<f64>) -> Genstep {
    step(EmissionProcess::Scintillation { component, time, rise_time })
}

fn resolved(detector: &Detector, steps: &[Genstep]) -> Result<Gensteps, PhotonError> {
    Gensteps::new(detector, &Packets::new(detector.program().clone()), steps, &BTreeMap::new())
}

fn photons(genstep: Genstep) -> Vec<Photon> {
    let detector = slab();
    let source = Source::Gensteps(resolved(&detector, &[genstep]).unwrap());
    photons_of(&detector, &source, &settings(COUNT as usize))
}

/// The integral of Frank and Tamm by quadrature: alpha / (hbar c) = 369.81 photons per eV and cm.
#[test]
fn the_cerenkov_yield_is_that_of_frank_and_tamm() {
    let detector = slab();
    let table =
        detector.materials().iter().find_map(|m| (m.name == "Inner").then(|| m.index.clone().unwrap()));
    let table = table.unwrap();
    for inverse_beta in [1.0, 1.2, 1.35] {
        let expected = 36.981 * integral(5.0, inverse_beta);
        for charge in [1.0, -2.0] {
            let found = cerenkov_yield(&table, inverse_beta, charge);
            let ratio = found / (expected * charge * charge);
            assert!((ratio - 1.0).abs() < 3e-6, "1/beta {inverse_beta}, charge {charge}: {ratio}");
        }
    }
    assert_eq!(cerenkov_yield(&table, 1.45, 1.0), 0.0);
    assert_eq!(cerenkov_yield(&table, 2.0, 1.0), 0.0);
}

/// The spectrum, above and partly below the threshold: 1/beta = 1.35 emits in two bands.
#[test]
fn the_cerenkov_spectrum_is_that_of_frank_and_tamm() {
    for inverse_beta in [1.0, 1.2, 1.35] {
        let photons = photons(cerenkov(inverse_beta, [1.0, 1.0]));
        let total = integral(5.0, inverse_beta);
        let energies: Vec<f64> = photons.iter().map(|photon| 1e6 * photon.energy).collect();
        assert!(energies.iter().all(|e| sin2(*e, inverse_beta) > 0.0));
        assert_distribution(energies, |e| integral(e, inverse_beta) / total, "Cerenkov energy");
    }
}

/// The angle of each photon follows from its energy; the polarisation is in the plane of the path and the direction.
#[test]
fn cerenkov_photons_lie_on_the_cone() {
    let axis = Vec3::new(1.0, 2.0, 2.0) / 3.0;
    let x = Vec3::new(2.0, 1.0, -2.0) / 3.0;
    let photons = photons(cerenkov(1.2, [1.0, 1.0]));
    for photon in &photons {
        let cosine = photon.direction.dot(axis);
        assert!((cosine - 1.2 / index(1e6 * photon.energy)).abs() < 1e-12);
        assert!(photon.polarisation.dot(photon.direction).abs() < 1e-14);
        assert!(photon.polarisation.dot(photon.direction.cross(axis)).abs() < 1e-14);
        // cos 90 degrees + theta to the path
        assert!((photon.polarisation.dot(axis) + (1.0 - cosine * cosine).sqrt()).abs() < 1e-12);
    }
    let azimuth = |photon: &Photon| photon.direction.dot(axis.cross(x)).atan2(photon.direction.dot(x));
    assert_distribution(photons.iter().map(azimuth).collect(), uniform(-PI, PI), "azimuth");
}

/// The density along the step is linear, and the time that of a velocity which is linear in the fraction of the step.
#[test]
fn photons_start_along_the_step() {
    let fractions = |photons: &[Photon]| -> Vec<f64> {
        let fraction = |photon: &Photon| {
            let away = photon.position - Vec3::new(10.0, 20.0, 30.0);
            let fraction = away.length() / 39.0;
            assert!((away - fraction * 39.0 * Vec3::new(1.0, 2.0, 2.0) / 3.0).length() < 1e-12);
            fraction
        };
        photons.iter().map(fraction).collect()
    };
    for [before, after] in [[3.0, 1.0], [0.0, 5.0], [2.0, 2.0]] {
        let photons = photons(cerenkov(1.2, [before, after]));
        let found = fractions(&photons);
        for (photon, x) in photons.iter().zip(&found) {
            let time = 5.0 + 40.0 * x / (250.0 - 25.0 * x);
            assert!((photon.time - time).abs() < 1e-12);
        }
        let distribution =
            move |x: f64| (before * x + 0.5 * (after - before) * x * x) / (0.5 * (before + after));
        assert_distribution(found, distribution, "fraction of the step");
    }
    let light = photons(scintillation(Some(1), 6.0, None));
    assert_distribution(fractions(&light), uniform(0.0, 1.0), "fraction of the step");
    let neutral = photons(Genstep { charge: 0.0, ..scintillation(Some(1), 6.0, None) });
    assert!(fractions(&neutral).iter().all(|x| (x - 1.0).abs() < 1e-12));
}

/// The spectrum is sampled by its trapezoidal integral, linear between the points of the table as in Geant4: the areas are
/// 0.5, 0.75 and 0.25.
#[test]
fn scintillation_has_its_spectrum() {
    let photons = photons(scintillation(Some(1), 6.0, None));
    let integral = |e: f64| match e {
        e if e < 3.0 => (e - 2.5) / 0.5 / 3.0,
        e if e < 3.5 => (0.5 + 0.75 * (e - 3.0) / 0.5) / 1.5,
        e => (1.25 + 0.25 * (e - 3.5) / 0.5) / 1.5,
    };
    assert_distribution(photons.iter().map(|p| 1e6 * p.energy).collect(), integral, "energy");
    for (axis, what) in (0..3).zip(["x", "y", "z"]) {
        assert_distribution(photons.iter().map(|p| p.direction[axis]).collect(), uniform(-1.0, 1.0), what);
    }
    assert!(photons.iter().all(|p| p.polarisation.dot(p.direction).abs() < 1e-14));
}

/// The time after the passage of the particle, with and without a rise time: the density (1 - exp(-t / r)) exp(-t / d).
#[test]
fn scintillation_has_its_profile_of_time() {
    let delays = |genstep: Genstep| -> Vec<f64> {
        let at_rest = Genstep { step_length: 0.0, displacement: Vec3::ZERO, velocity: [0.0; 2], ..genstep };
        photons(at_rest).iter().map(|photon| photon.time - 5.0).collect()
    };
    // those of the genstep, those of the material, those of the component that has the time constant
    for (genstep, decay, rise) in [
        (scintillation(Some(1), 20.0, Some(3.0)), 20.0, 3.0),
        (scintillation(Some(1), 0.0, None), 6.0, 2.0),
        (scintillation(None, 6.0, Some(12.0)), 6.0, 12.0),
        (scintillation(Some(2), 0.0, None), 1500.0, 0.0),
    ] {
        let short = rise * decay / (rise + decay);
        let distribution = |t: f64| {
            let fast = if rise > 0.0 { short * (1.0 - (-t / short).exp()) } else { 0.0 };
            (decay * (1.0 - (-t / decay).exp()) - fast) / (decay - short)
        };
        let found = delays(genstep);
        let mean = found.iter().sum::<f64>() / f64::from(COUNT);
        let error = ((decay * decay + short * short) / f64::from(COUNT)).sqrt();
        assert!((mean - decay - short).abs() < 5.0 * error, "{mean}, expected {}", decay + short);
        assert_distribution(found, distribution, "delay");
    }
}

/// Component 0: each photon is of component 1 with the probability 0.3 and of component 2 with 0.7.
#[test]
fn components_have_their_yields() {
    let found = photons(scintillation(None, 0.0, None));
    // the spectra do not overlap
    let red = found.iter().filter(|photon| photon.energy < 2.2e-6).count() as u64;
    assert_binomial(red, u64::from(COUNT), 0.7, "component 2");
    let late = found.iter().filter(|photon| photon.time > 105.0).count() as u64;
    assert_binomial(late, u64::from(COUNT), 0.7 * (-100f64 / 1500.0).exp(), "late photons");
}

/// A torch with the light of a material has its spectra and times, added to those of the torch.
#[test]
fn torches_emit_scintillation_light() {
    let detector = slab();
    let name = detector.materials().iter().find(|own| !own.scintillation.is_empty()).unwrap().name.clone();
    let light = ScintillationLight::new(detector.named_material(&name).unwrap()).unwrap();
    let origin = Origin::Point(Vec3::new(1.0, 2.0, 30.0));
    let torch = Torch::new(origin, WavelengthDistribution::Scintillation(light)).unwrap();
    let torch = torch.pulsed(Pulse { interval: [100.0, 100.0], ..Pulse::default() }).unwrap();
    let found = photons_of(&detector, &Source::Torch(torch), &settings(COUNT as usize));
    let (red, blue): (Vec<Photon>, Vec<Photon>) = found.iter().partition(|photon| photon.energy < 2.2e-6);
    assert_binomial(red.len() as u64, u64::from(COUNT), 0.7, "component 2");
    assert_distribution(red.iter().map(|own| 1e6 * own.energy).collect(), uniform(1.8, 2.0), "energy");
    let exponential = |t: f64| 1.0 - (-(t - 100.0) / 1500.0).exp();
    assert_distribution(red.iter().map(|own| own.time).collect(), exponential, "time of component 2");
    // rise 2, decay 6: the integral of (1 - exp(-t / 2)) exp(-t / 6), normalised
    let risen = |t: f64| (6.0 * (1.0 - (-t / 6.0).exp()) - 1.5 * (1.0 - (-t / 1.5).exp())) / 4.5;
    assert_distribution(blue.iter().map(|own| own.time - 100.0).collect(), risen, "time of component 1");
    assert!(blue.iter().all(|own| (2.5e-6..=4.0e-6).contains(&own.energy)));
    assert!(found.iter().all(|own| own.position == Vec3::new(1.0, 2.0, 30.0)));
}

#[test]
fn materials_without_scintillation_are_refused() {
    let detector = slab();
    let reason = |name: &str| {
        let light = detector.named_material(name).and_then(ScintillationLight::new);
        light.err().map(|error| error.to_string()).unwrap_or_default()
    };
    let dark = detector.materials().iter().find(|own| own.scintillation.is_empty()).unwrap();
    assert!(reason(&dark.name).contains("has no SCINTILLATIONCOMPONENT1"), "{}", reason(&dark.name));
    assert!(reason("Sl").contains("no material is called `Sl`"), "{}", reason("Sl"));
    let own = detector.materials().iter().find(|own| !own.scintillation.is_empty()).unwrap();
    let changed = |change: fn(&mut ScintillationComponent)| {
        let mut material = own.clone();
        material.scintillation.iter_mut().for_each(change);
        ScintillationLight::new(&material).unwrap_err().to_string()
    };
    assert!(changed(|own| own.share = 0.0).contains("are all 0"));
    assert!(changed(|own| own.time = None).contains("has no SCINTILLATIONTIMECONSTANT1"));
}

/// A name for a number that no genstep has is reported if another number has none.
#[test]
fn unused_names_of_materials_are_reported() {
    let detector = slab();
    let steps = [Genstep { photons: 10, ..scintillation(None, 0.0, None) }];
    let number = steps[0].material;
    let name = detector.materials()[0].name.clone();
    let notes = |names: &[u32]| {
        let names = names.iter().map(|&number| (number, name.clone())).collect();
        let evaluator = Packets::new(detector.program().clone());
        Gensteps::new(&detector, &evaluator, &steps, &names).map(|own| own.notes().to_vec()).unwrap()
    };
    assert!(notes(&[number + 1])[0].starts_with(&format!("the material {} has a name", number + 1)));
    assert!(notes(&[]).is_empty());
}

/// Gensteps that lie in another material than the named one are reported.
#[test]
fn gensteps_in_another_material_are_reported() {
    let detector = slab();
    let inside = Genstep { photons: 10, ..scintillation(None, 0.0, None) };
    let beyond = Genstep { position: inside.position + Vec3::new(1e6, 0.0, 0.0), ..inside };
    let name = detector.materials().iter().find(|own| !own.scintillation.is_empty()).unwrap().name.clone();
    let names = BTreeMap::from([(inside.material, name.clone())]);
    let evaluator = Packets::new(detector.program().clone());
    let notes =
        |steps: &[Genstep]| Gensteps::new(&detector, &evaluator, steps, &names).unwrap().notes().to_vec();
    assert!(notes(&[inside; 2]).is_empty(), "{:?}", notes(&[inside; 2]));
    let [note] = &notes(&[inside, beyond, beyond])[..] else { panic!("one note") };
    assert!(note.starts_with("2 gensteps are not in the material"), "{note}");
    assert!(note.contains(&format!("genstep 1, of `{name}`, is outside the world")), "{note}");
}

fn from_opticks(numbers: &[f32]) -> Result<Vec<Genstep>, PhotonError> {
    gensteps_from_array(&[numbers.len() / 24, 6, 4], GenstepNumbers::Single(numbers))
}

fn from_geant4(numbers: &[f64]) -> Result<Vec<Genstep>, PhotonError> {
    gensteps_from_array(&[numbers.len() / 16, 16], GenstepNumbers::Double(numbers))
}

/// The layout follows from the shape. Other shapes, and numbers that do not fill the last row, are errors.
#[test]
fn shapes_of_gensteps() {
    let zeros = [0.0; 96];
    let problem = |shape: &[usize], count: usize| {
        gensteps_from_array(shape, GenstepNumbers::Double(&zeros[..count])).unwrap_err().to_string()
    };
    for (shape, text) in
        [(&[5, 16, 1][..], "(5, 16, 1)"), (&[16], "(16,)"), (&[1, 24], "(1, 24)"), (&[], "()")]
    {
        let expected = format!("the array of gensteps has shape {text}: it must be (N, 6, 4) or (N, 16).");
        assert_eq!(problem(shape, 16), expected);
    }
    assert_eq!(
        problem(&[1, 6, 4], 24),
        "gensteps of shape (N, 6, 4) are not float32: they hold integers in the bits of float32. Give the array as it was written."
    );
    for (shape, count) in [(&[2, 16][..], 31), (&[1, 6, 4], 47), (&[usize::MAX, 16], 16)] {
        assert!(problem(shape, count).contains(&format!("has {count} numbers")), "{}", problem(shape, count));
    }
    assert!(gensteps_from_array(&[0, 16], GenstepNumbers::Double(&[])).unwrap().is_empty());
    let problem =
        |shape: &[usize], count: usize| photons_from_opticks(shape, &zeros[..count]).unwrap_err().to_string();
    assert_eq!(problem(&[16], 16), "the array of photons has shape (16,): it must be (N, 4, 4).");
    assert_eq!(problem(&[1, 2, 8], 16), "the array of photons has shape (1, 2, 8): it must be (N, 4, 4).");
    for shape in [[2, 4, 4], [usize::MAX, 4, 4]] {
        assert!(problem(&shape, 17).contains("has 17 numbers"), "{}", problem(&shape, 17));
    }
    assert!(photons_from_opticks(&[0, 4, 4], &[]).unwrap().is_empty());
}

/// The layouts of Opticks and Geant4 hold the same steps.
#[test]
fn layouts_are_equal() {
    let bits = |integer: u32| f32::from_bits(integer);
    let mut rows = vec![
        [bits(15), bits(9), bits(7), bits(300), 10.0, 20.0, 30.0, 5.0, 13.0, 26.0, 26.0, 40.0],
        [bits(16), bits(9), bits(7), bits(200), 10.0, 20.0, 30.0, 5.0, 13.0, 26.0, 26.0, 40.0],
    ];
    let ends = [
        [bits(11), -1.0, 1.0, 250.0, 1.25, 0.0, 0.0, 0.9, 0.2, 3.0, 2.0, 200.0],
        [bits(11), -1.0, 1.0, 225.0, bits(1), 0.0, 0.0, 0.0, 6.0, 0.0, 0.0, 0.0],
    ];
    let opticks: Vec<f32> = rows.drain(..).zip(ends).flat_map(|(a, b)| a.into_iter().chain(b)).collect();
    let steps = from_opticks(&opticks).unwrap();
    let expected = cerenkov(1.25, [3.0, 2.0]);
    assert_eq!(steps[0], Genstep { photons: 300, ..expected });
    let light = scintillation(Some(1), 6.0, None);
    assert_eq!(steps[1], Genstep { photons: 200, velocity: [225.0; 2], ..light });
    // the kinds of JUNO have the same fields
    let mut of_juno = opticks.clone();
    (of_juno[0], of_juno[24]) = (bits(18), bits(5));
    assert_eq!(from_opticks(&of_juno).unwrap(), steps);
    let refused = |kind: f32| {
        let mut changed = opticks.clone();
        changed[24] = kind;
        from_opticks(&changed).unwrap_err().to_string()
    };
    assert!(refused(bits(6)).starts_with("genstep 1 is of the kind 6"), "{}", refused(bits(6)));
    assert!(refused(bits(6)).contains("use a source"), "{}", refused(bits(6)));
    assert!(refused(bits(1)).contains("an older layout"), "{}", refused(bits(1)));
    assert!(refused(16.0).contains("has the kind 16 as a floating-point number"), "{}", refused(16.0));
    // 1/beta from the mean velocity
    let mean = LIGHT_SPEED / 1.25;
    let common = [7.0, 300.0, -1.0, 40.0, mean + 10.0, -20.0, 13.0, 26.0, 26.0];
    let row = |kind: f64, last: [f64; 2]| [&[kind, 10.0, 20.0, 30.0, 5.0], &common[..], &last[..]].concat();
    let steps = from_geant4(&[row(15.0, [3.0, 2.0]), row(16.0, [6.0, 2.0])].concat()).unwrap();
    let velocity = [mean + 10.0, mean - 10.0];
    let EmissionProcess::Cerenkov { inverse_beta, .. } = steps[0].process else { panic!("a Cerenkov step") };
    assert!((inverse_beta - 1.25).abs() < 1e-15);
    assert_eq!(steps[0], Genstep { photons: 300, velocity, ..cerenkov(inverse_beta, [3.0, 2.0]) });
    assert_eq!(steps[1], Genstep { photons: 300, velocity, ..scintillation(None, 6.0, Some(2.0)) });
    let unknown = from_geant4(&row(6.0, [0.0; 2])).unwrap_err().to_string();
    assert!(unknown.contains("genstep 0 is of the kind 6: the kinds are 15"), "{unknown}");
    let single: Vec<f32> = row(15.0, [3.0, 2.0]).into_iter().map(|number| number as f32).collect();
    let single = gensteps_from_array(&[1, 16], GenstepNumbers::Single(&single)).unwrap();
    assert_eq!((single[0].photons, single[0].position), (300, Vec3::new(10.0, 20.0, 30.0)));
    let broken = from_geant4(&row(15.0, [0.0; 2]).into_iter().map(|x| x + 0.5).collect::<Vec<_>>());
    assert!(broken.is_err());
}

/// The bits of photons of gensteps and of a volume do not depend on threads and ranges; events differ.
#[test]
fn gensteps_are_reproducible() {
    let detector = slab();
    let empty = Genstep { photons: 0, ..cerenkov(1.2, [1.0, 1.0]) };
    let steps = [
        Genstep { photons: 3000, ..cerenkov(1.2, [1.0, 1.0]) },
        empty,
        Genstep { photons: 7000, ..scintillation(None, 0.0, None) },
        empty,
    ];
    let gensteps = resolved(&detector, &steps).unwrap();
    assert_eq!([0, 2999, 3000, 9999].map(|photon| gensteps.parent(photon)), [0, 0, 2, 2]);
    let source = Source::Gensteps(gensteps);
    let whole = photons_of(&detector, &source, &settings(10_000));
    let parts = [0..1, 1..2999, 2999..3002, 3002..10_000];
    let parts: Vec<Photon> = parts
        .into_iter()
        .flat_map(|range| photons_of(&detector, &source, &RunSettings::new(range)))
        .collect();
    assert_eq!(parts, whole);
    let other = photons_of(&detector, &source, &RunSettings { event: 1, ..settings(10_000) });
    assert!(whole.iter().zip(&other).all(|(a, b)| a.direction != b.direction));
    let one = run(&detector, &source, &RunSettings { threads: NonZeroUsize::new(1), ..settings(10_000) });
    assert_eq!(one.hits.genstep, Some(Vec::new()), "no hits, of gensteps");
    let three = run(&detector, &source, &RunSettings { threads: NonZeroUsize::new(3), ..settings(10_000) });
    assert_eq!(one, three);
    let beyond = rayweave_photon::simulate(
        &detector,
        &Packets::new(detector.program().clone()),
        &source,
        &RunSettings::new(0..10_001),
    );
    assert!(beyond.unwrap_err().to_string().contains("the source has 10000 photons"));
}

/// Histories of gensteps begin with Opticks' flags CK and SI, and hits have the numbers of their gensteps.
#[test]
fn photons_know_their_gensteps() {
    let text = SlabDetector {
        auxiliary: r#"<auxiliary auxtype="SensDet" auxvalue="Counter"/>"#,
        inner: r#"<property name="RINDEX" ref="GLASS"/>"#,
        outer: r#"<property name="RINDEX" ref="GLASS"/><property name="SCINTILLATIONCOMPONENT1" ref="HALF"/>
<property name="SCINTILLATIONTIMECONSTANT1" ref="TAU"/>"#,
        matrices: r#"<matrix name="TAU" coldim="1" values="5"/>"#,
        ..CLEAR
    };
    let detector = text.build();
    let below = Vec3::new(0.0, 0.0, -40.0);
    let steps = [
        Genstep { position: below, photons: 300, ..scintillation(Some(1), 0.0, None) },
        Genstep { position: below, photons: 200, ..cerenkov(1.2, [1.0, 1.0]) },
    ];
    let source = Source::Gensteps(resolved(&detector, &steps).unwrap());
    let (run, histories) = crate::history::record(&detector, &source, &settings(500));
    assert_eq!(histories.processes[&Process::Scintillation], 300);
    assert_eq!(histories.processes[&Process::Cerenkov], 200);
    assert!(!histories.processes.contains_key(&Process::Emission));
    for sequence in &histories.sequences {
        let flag = if sequence.photon < 300 { "SI" } else { "CK" };
        assert!(sequence_text(sequence.words).starts_with(flag), "{sequence:?}");
    }
    let parents = run.hits.genstep.as_ref().unwrap();
    let expected: Vec<i64> = run.hits.photon.iter().map(|&photon| i64::from(photon >= 300)).collect();
    assert_eq!(parents, &expected);
    assert!(parents.contains(&0) && parents.contains(&1), "{parents:?}");
    let columns = |has_gensteps| hit_schema(has_gensteps).unwrap().columns().len();
    assert_eq!(columns(true), columns(false) + 1);
    assert_eq!(run.hits.to_rows().unwrap().columns().len(), columns(true));
    assert_eq!(Hits::default().to_rows().unwrap().columns().len(), columns(false));
    // beside hits of another source
    let torch = Source::Torch(Torch::point(below, 500.0).unwrap());
    let mut mixed = crate::run(&detector, &torch, &settings(100)).hits;
    let others = mixed.len();
    assert!(others > 0 && mixed.genstep.is_none());
    mixed.append(run.hits.clone());
    assert_eq!(mixed.genstep.unwrap(), [vec![-1; others], expected].concat());
}

/// Materials by name, by the middle of the steps, and the messages about those that do not fit.
#[test]
fn materials_are_found_or_refused() {
    let detector = slab();
    let evaluator = Packets::new(detector.program().clone());
    let step = cerenkov(1.2, [1.0, 1.0]);
    let with = |steps: &[Genstep], names: &[(u32, &str)]| {
        let names = names.iter().map(|(number, name)| (*number, (*name).to_owned())).collect();
        Gensteps::new(&detector, &evaluator, steps, &names)
    };
    let fails = |steps: &[Genstep], names: &[(u32, &str)], text: &str| {
        let message = with(steps, names).unwrap_err().to_string();
        assert!(message.contains(text), "{message}");
    };
    assert_eq!(with(&[step], &[(7, "Inner")]).unwrap().photons(), u64::from(COUNT));
    fails(&[step], &[(7, "Iner")], "no material is called `Iner`");
    fails(&[step], &[(7, "Outer")], "genstep 0 is invalid: 1/beta = 1.2 is not below the RINDEX of `Outer`");
    let single = SlabDetector {
        matrices: r#"<matrix name="ONE" coldim="2" values="2*eV 1.33"/>"#,
        inner: r#"<property name="RINDEX" ref="ONE"/>"#,
        ..CLEAR
    };
    let single = single.build();
    let evaluator_of_it = Packets::new(single.program().clone());
    let names = [(7, "Inner".to_owned())].into();
    let message = Gensteps::new(&single, &evaluator_of_it, &[step], &names).unwrap_err().to_string();
    assert!(message.contains("is a single number"), "{message}");
    let outside = Genstep { position: Vec3::new(0.0, 0.0, -100.0), ..step };
    fails(&[step, outside], &[], "steps with this number are in `Inner` and in `Outer`. Give the name");
    let beyond = Genstep { position: Vec3::new(0.0, 0.0, 9000.0), material: 8, ..step };
    fails(&[step, beyond], &[], "genstep 1 is not known: the middle of the step is outside the world");
    fails(&[scintillation(Some(3), 6.0, None)], &[], "has no SCINTILLATIONCOMPONENT3");
    fails(
        &[scintillation(None, 7.0, None)],
        &[],
        "no scintillation of its material `Inner` has the time constant 7 ns",
    );
    fails(&[scintillation(Some(1), 6.0, None)], &[(7, "Outer")], "has no SCINTILLATIONCOMPONENT1");
    for (bad, text) in [
        (Genstep { time: f64::NAN, ..step }, "its time and charge must be finite"),
        (Genstep { step_length: -1.0, ..step }, "the length of its step"),
        (Genstep { velocity: [0.0, 0.0], ..step }, "its velocity is 0"),
        (Genstep { displacement: Vec3::ZERO, ..step }, "a Cerenkov step needs a displacement"),
        (cerenkov(0.9, [1.0, 1.0]), "1/beta must be finite and at least 1"),
        (cerenkov(1.2, [f64::INFINITY, 1.0]), "its mean numbers of photons"),
        (scintillation(Some(1), -1.0, None), "its time constants"),
    ] {
        fails(&[bad], &[], text);
    }
    let most = vec![Genstep { photons: u32::MAX, ..step }; 2];
    fails(&most, &[], "an event has at most 4294967296");
    // a number of photons that the index does not explain
    let mean = 36.981 * 40.0 * integral(5.0, 1.2);
    let stated = |photons: f64| with(&[Genstep { photons: photons as u32, ..step }], &[]).unwrap();
    assert!(stated(mean).notes().is_empty());
    let note = stated(2.0 * mean).notes().join(" ");
    assert!(note.contains("Cerenkov photons: its RINDEX predicts"), "{note}");
}

/// Photons in the layout of Opticks: float32 vectors are made unit vectors, and an absent polarisation random.
#[test]
fn photons_are_read() {
    let row = [1.0, 2.0, 50.0, 4.0, 0.6, 0.0, 0.8, 1.0, 0.8, 0.0, -0.600_01, 500.0, 0.0, 0.0, 0.0, 0.0];
    let mut unpolarised = row;
    unpolarised[8..11].fill(0.0);
    let photons = photons_from_opticks(&[2, 4, 4], &[row, unpolarised].concat()).unwrap();
    assert!((photons[0].polarisation - Vec3::new(0.8, 0.0, -0.6)).length() < 1e-4);
    assert!(photons[0].polarisation.dot(photons[0].direction).abs() < 1e-15);
    assert!((photons[0].energy - HC_MEV_NM / 500.0).abs() < 1e-20);
    let emitted = photons_of(&slab(), &Source::Photons(photons.clone()), &settings(2));
    assert_eq!(emitted[0], photons[0]);
    assert!((emitted[1].polarisation.length() - 1.0).abs() < 1e-14);
    assert!(emitted[1].polarisation.dot(emitted[1].direction).abs() < 1e-14);
    for (k, value, text) in [
        (0, f64::NAN, "its position and time must be finite"),
        (6, 0.0, "its direction must have length 1"),
        (8, 0.9, "its polarisation must have length 1"),
        (11, 0.0, "its wavelength must be positive"),
    ] {
        let mut bad = row;
        bad[k] = value;
        let message = photons_from_opticks(&[2, 4, 4], &[row, bad].concat()).unwrap_err().to_string();
        assert!(message.contains("photon 1 is invalid") && message.contains(text), "{message}");
    }
}

/// The names of properties before version 11 of Geant4 are read, with notes.
#[test]
fn former_names_are_read() {
    let slab = SlabDetector {
        matrices: r#"<matrix name="BAND" coldim="2" values="2*eV 1 3*eV 1"/>
<matrix name="TIME" coldim="1" values="6*ns"/><matrix name="RATIO" coldim="1" values="0.8"/>"#,
        inner: r#"<property name="RINDEX" ref="GLASS"/><property name="FASTCOMPONENT" ref="BAND"/>
<property name="SLOWCOMPONENT" ref="BAND"/><property name="FASTTIMECONSTANT" ref="TIME"/>
<property name="YIELDRATIO" ref="RATIO"/>"#,
        ..CLEAR
    }
    .build();
    let material = slab.materials().iter().find(|material| material.name == "Inner").unwrap();
    let found: Vec<_> = material.scintillation.iter().map(|c| (c.number, c.time, c.share)).collect();
    assert_eq!(found, [(1, Some(6.0), 0.8), (2, None, 1.0 - 0.8)]);
    let notes = slab.notes().join("\n");
    assert!(
        notes.contains("`FASTCOMPONENT` is read as `SCINTILLATIONCOMPONENT1`: that is its name since"),
        "{notes}"
    );
    assert!(notes.contains("`YIELDRATIO` is read as two yields: `SCINTILLATIONYIELD1` is 0.8"), "{notes}");
}
