//! The published results of Geant4's example OpNovice2 (`examples/extended/optical/OpNovice2`, files .mac and .out): the first event
//! of each photon at the surface of a box, and the spectra of two wavelength shifters. Each number is compared within 3 standard
//! deviations of both samples.

use super::uniforms;
use rayweave_formats::{Format, Options};
use rayweave_math::Vec3;
use rayweave_photon::{
    Detector, HistoryOptions, Photon, PhotonError, Process, RunSettings, Source, StepRow, simulate_parts,
};
use rayweave_trace::Packets;
use std::collections::{BTreeMap, HashMap};

/// A box of half side 1 m in a world of half side 10 m, with the surface of the example as skin of the box: seen from inside, it is
/// the example's border surface. Properties are (name, energies in eV with values).
struct Setup<'a> {
    tank: &'a [(&'a str, &'a str)],
    world: &'a [(&'a str, &'a str)],
    surface: &'a [(&'a str, &'a str)],
    attributes: &'a str,
}

impl Setup<'_> {
    fn build(&self) -> Detector {
        let mut define = String::new();
        let mut properties = |owner: &str, list: &[(&str, &str)]| -> String {
            let mut text = String::new();
            for (name, values) in list {
                let columns = if values.contains("eV") { 2 } else { 1 };
                define +=
                    &format!("<matrix name=\"{owner}_{name}\" coldim=\"{columns}\" values=\"{values}\"/>");
                text += &format!("<property name=\"{name}\" ref=\"{owner}_{name}\"/>");
            }
            text
        };
        let [tank, world, surface] = [("T", self.tank), ("W", self.world), ("S", self.surface)]
            .map(|(owner, list)| properties(owner, list));
        let material = |name: &str, own: &str| {
            format!("<material name=\"{name}\" Z=\"7\"><D value=\"1\"/><atom value=\"14\"/>{own}</material>")
        };
        let skin = match self.attributes {
            "" => "",
            _ => {
                "<skinsurface name=\"skin\" surfaceproperty=\"Surface\"><volumeref ref=\"Tank\"/></skinsurface>"
            }
        };
        let surface = match self.attributes {
            "" => String::new(),
            own => format!("<opticalsurface name=\"Surface\" {own}>{surface}</opticalsurface>"),
        };
        let text = format!(
            "<gdml><define>{define}</define><materials>{}{}</materials>
<solids><box name=\"A\" x=\"20\" y=\"20\" z=\"20\" lunit=\"m\"/><box name=\"B\" x=\"2\" y=\"2\" z=\"2\" lunit=\"m\"/>{surface}</solids>
<structure><volume name=\"Tank\"><materialref ref=\"Inner\"/><solidref ref=\"B\"/></volume>
<volume name=\"World\"><materialref ref=\"Outer\"/><solidref ref=\"A\"/><physvol name=\"tank\"><volumeref ref=\"Tank\"/></physvol></volume>
{skin}</structure><setup name=\"Default\" version=\"1.0\"><world ref=\"World\"/></setup></gdml>",
            material("Inner", &tank),
            material("Outer", &world)
        );
        let imported = rayweave_formats::parse(&text, Format::Gdml, &[], &Options::default()).unwrap();
        Detector::new(&imported.scene, &imported.document()).unwrap()
    }
}

/// The rows of all photons, with at most so many steps each.
fn steps(detector: &Detector, photons: Vec<Photon>, most: u32) -> Vec<StepRow> {
    let settings = RunSettings { max_steps: most, seed: 11, ..RunSettings::new(0..photons.len() as u64) };
    let options = HistoryOptions { steps: true, sequences: false };
    let evaluator = Packets::new(detector.program().clone());
    let mut rows = Vec::new();
    simulate_parts(detector, &evaluator, &Source::Photons(photons), &settings, Some(options), |part| {
        rows.extend(part.histories.unwrap().steps);
        Ok::<(), PhotonError>(())
    })
    .unwrap();
    rows
}

/// The number of photons by the process that ends their first step.
fn first_events(detector: &Detector, photons: Vec<Photon>) -> BTreeMap<&'static str, u64> {
    let mut counts = BTreeMap::new();
    for row in
        steps(detector, photons, 1).iter().filter(|row| row.step == 1 && row.process.name() != "step_limit")
    {
        *counts.entry(row.process.name()).or_default() += 1;
    }
    counts
}

/// Photons along x, or at angles to x that are uniform in 0 to 90 degrees, as the example's generator makes them. `angle` is that of the
/// polarisation in degrees: 0 is parallel to the plane of incidence on a face across x, 90 perpendicular to it.
fn gun(count: usize, x: f64, energy: f64, is_random: bool, angle: Option<f64>) -> Vec<Photon> {
    let turns = std::f64::consts::TAU;
    let uniform = uniforms(77, 3 * count);
    let photon = |k: usize| {
        let [u, v, w] = [uniform[3 * k], uniform[3 * k + 1], uniform[3 * k + 2]];
        let (theta, phi) = if is_random { (0.25 * turns * u, turns * v) } else { (0.0, 0.0) };
        let direction = Vec3::new(theta.cos(), theta.sin() * phi.sin(), theta.sin() * phi.cos());
        let across = Vec3::new(1.0, 0.0, 0.0).cross(direction);
        let across = if across.length() > 0.0 { across.normalize() } else { Vec3::new(0.0, 0.0, 1.0) };
        let along = across.cross(direction);
        let turn = angle.map_or(turns * w, f64::to_radians);
        let polarisation = (along * turn.cos() + across * turn.sin()).normalize();
        Photon { position: Vec3::new(x, 0.0, 0.0), direction, polarisation, energy: energy * 1e-6, time: 0.0 }
    };
    (0..count).map(photon).collect()
}

/// Asserts that two fractions are equal within 3 standard deviations.
fn assert_same([a, n]: [u64; 2], [b, m]: [u64; 2], what: &str) {
    let (a, n, b, m) = (a as f64, n as f64, b as f64, m as f64);
    let pooled = (a + b) / (n + m);
    let z = (a / n - b / m) / (pooled * (1.0 - pooled) * (1.0 / n + 1.0 / m)).sqrt();
    assert!(z.abs() < 3.0, "{what}: {a} of {n}, published {b} of {m}: z = {z:.2}");
}

/// coated.mac: 53,700 of 499,758 and 53,778 of 499,765 are reflected at a film of 100 nm and index 1.7 between 1.4 and 1.0.
#[test]
fn coated() {
    let detector = Setup {
        tank: &[("RINDEX", "2*eV 1.4 8*eV 1.4"), ("ABSLENGTH", "2*eV 100 5*eV 200 8*eV 300")],
        world: &[("RINDEX", "2*eV 1.0 8*eV 1.0"), ("ABSLENGTH", "2*eV 1e6 5*eV 2e6 8*eV 3e6")],
        surface: &[
            ("REFLECTIVITY", "2*eV 1 8*eV 1"),
            ("COATEDRINDEX", "2*eV 1.7 8*eV 1.7"),
            ("COATEDTHICKNESS", "1e-4"),
        ],
        attributes: "model=\"unified\" finish=\"polished\" type=\"coated\" value=\"0\"",
    }
    .build();
    for (angle, published) in [(0.0, [53_700, 499_758]), (90.0, [53_778, 499_765])] {
        let found = first_events(&detector, gun(200_000, 999.9, 5.0, false, Some(angle)));
        let reflected = found["coated_reflection"];
        assert_same([reflected, reflected + found["coated_refraction"]], published, "coated");
    }
}

/// fresnel.mac: at angles uniform in 0 to 90 degrees 4.507 % are reflected with perpendicular polarisation, 1.444 to 1.480 % with
/// parallel, and 48.7 to 48.9 % totally.
#[test]
fn fresnel() {
    let detector = Setup {
        tank: &[("RINDEX", "2*eV 1.4 8*eV 1.41"), ("ABSLENGTH", "2*eV 100 5*eV 200 8*eV 300")],
        world: &[("RINDEX", "2*eV 1.01 8*eV 1.01"), ("ABSLENGTH", "2*eV 1e6 5*eV 2e6 8*eV 3e6")],
        surface: &[("REFLECTIVITY", "2*eV 1 8*eV 1")],
        attributes: "model=\"unified\" finish=\"polished\" type=\"dielectric_dielectric\" value=\"0\"",
    }
    .build();
    let count = 200_000;
    for (angle, least, most) in [(0.0, 0.01444, 0.01480), (90.0, 0.04507, 0.04507)] {
        let found = first_events(&detector, gun(count, 999.9, 5.0, true, Some(angle)));
        for (name, least, most) in
            [("fresnel_reflection", least, most), ("total_internal_reflection", 0.487, 0.489)]
        {
            let fraction = found[name] as f64 / count as f64;
            let p: f64 = least;
            let margin = 3.0 * (p * (1.0 - p) * (1.0 / count as f64 + 1.0 / 500_000.0)).sqrt();
            assert!(fraction > least - margin && fraction < most + margin, "{name} at {angle}: {fraction}");
        }
    }
}

/// complexRindex.mac: aluminium at 4 eV absorbs 50,618 of 499,911 photons with parallel polarisation, and 25,346 of 499,907 with
/// perpendicular.
#[test]
fn complex_index() {
    let detector = Setup {
        tank: &[("RINDEX", "2*eV 1.01 8*eV 1.01"), ("ABSLENGTH", "2*eV 1e6 5*eV 2e6 8*eV 3e6")],
        world: &[("RINDEX", "2*eV 1.38 4*eV 0.28 6*eV 0.13 8*eV 0.077")],
        surface: &[
            ("REALRINDEX", "2*eV 1.38 4*eV 0.28 6*eV 0.13 8*eV 0.077"),
            ("IMAGINARYRINDEX", "2*eV 7.31 4*eV 3.71 6*eV 2.40 8*eV 1.71"),
        ],
        attributes: "model=\"unified\" finish=\"polished\" type=\"dielectric_metal\" value=\"0\"",
    }
    .build();
    for (angle, published) in [(0.0, [50_618, 499_911]), (90.0, [25_346, 499_907])] {
        let found = first_events(&detector, gun(200_000, 900.0, 4.0, true, Some(angle)));
        let absorbed = found["surface_absorbed"];
        let total = found.iter().filter(|(name, _)| **name != "absorbed").map(|(_, count)| count).sum();
        assert_same([absorbed, total], published, "aluminium");
    }
}

/// boundary.mac, the first run: a ground surface of the unified model with sigma_alpha 0.2.
#[test]
fn boundary_ground() {
    let tenth = "2*eV 0.1 8*eV 0.1";
    let detector = Setup {
        tank: &[("RINDEX", "2*eV 1.3 8*eV 1.4"), ("ABSLENGTH", "2*eV 1e6 5*eV 2e6 8*eV 3e6")],
        world: &[("RINDEX", "2*eV 1.01 8*eV 1.01"), ("ABSLENGTH", "2*eV 1e6 5*eV 2e6 8*eV 3e6")],
        surface: &[
            ("SPECULARLOBECONSTANT", tenth),
            ("SPECULARSPIKECONSTANT", tenth),
            ("BACKSCATTERCONSTANT", tenth),
            ("TRANSMITTANCE", tenth),
            ("REFLECTIVITY", "2*eV 0.8 8*eV 0.8"),
            ("EFFICIENCY", tenth),
            ("RINDEX", "2*eV 1.4 8*eV 1.5"),
        ],
        attributes: "model=\"unified\" finish=\"ground\" type=\"dielectric_dielectric\" value=\"0.2\"",
    }
    .build();
    let direction = Vec3::new(0.9, 0.44, 0.0).normalize();
    let photon =
        Photon { position: Vec3::ZERO, direction, polarisation: Vec3::ZERO, energy: 3e-6, time: 0.0 };
    let found = first_events(&detector, vec![photon; 200_000]);
    let total = found.iter().filter(|(name, _)| **name != "absorbed").map(|(_, count)| count).sum();
    for (name, published) in [
        ("transmission", 979),
        ("fresnel_refraction", 7508),
        ("lambertian_reflection", 319),
        ("lobe_reflection", 54),
        ("spike_reflection", 52),
        ("back_scattering", 55),
        ("surface_absorbed", 933),
        ("detected", 93),
    ] {
        assert_same([found[name], total], [published, 9_993], name);
    }
}

/// wls.mac: the mean energies of the photons of two wavelength shifters that feed each other are 5.085 and 2.796 eV. Absorption above
/// 5.5 eV is that of the first: each absorbs at least 1,000 times as often as the other on its side.
#[test]
fn wavelength_shifters() {
    let detector = Setup {
        tank: &[
            ("ABSLENGTH", "2*eV 1 5*eV 2 8*eV 3"),
            ("RAYLEIGH", "2*eV 1 8*eV 1"),
            ("RINDEX", "2*eV 1.3 8*eV 1.4"),
            ("WLSABSLENGTH", "5*eV 1e5 6*eV 0.06 7*eV 0.08 8*eV 0.09 9*eV 1e5"),
            ("WLSCOMPONENT", "3*eV 0.1 4*eV 0.4 5*eV 0.7 6*eV 0.6 7*eV 0.1"),
            ("WLSABSLENGTH2", "2*eV 1e5 3*eV 0.36 4*eV 0.18 5*eV 0.09 6*eV 1e4"),
            ("WLSCOMPONENT2", "2*eV 0.1 3*eV 0.8 4*eV 0.9 5*eV 0.1"),
            ("WLSMEANNUMBERPHOTONS", "1"),
            ("WLSMEANNUMBERPHOTONS2", "3"),
            ("WLSTIMECONSTANT", "1"),
            ("WLSTIMECONSTANT2", "2"),
        ],
        world: &[("RINDEX", "2*eV 1.01 8*eV 1.01"), ("ABSLENGTH", "2*eV 100 8*eV 100")],
        surface: &[],
        attributes: "",
    }
    .build();
    let count = 10_000usize;
    let rows = steps(&detector, gun(count, 0.0, 7.0, false, None), 10_000);
    let energy = |row: &StepRow| 1_239.841_984_332 / row.wavelength_nm;
    // the absorbed energy by photon and place: that of the row before the one which continues the track
    let place = |row: &StepRow| (row.photon, row.position.to_array().map(f64::to_bits));
    let absorbed: HashMap<_, f64> = rows
        .windows(2)
        .filter(|pair| pair[1].process == Process::Reemission && pair[0].track == pair[1].track)
        .map(|pair| (place(&pair[1]), energy(&pair[0])))
        .collect();
    for (is_first, published) in [(true, 5.085), (false, 2.796)] {
        // sums by photon: emissions of one photon are not independent
        let mut sums = vec![[0.0, 0.0]; count];
        for row in rows.iter().filter(|row| row.process == Process::Reemission) {
            let Some(&before) = absorbed.get(&place(row)) else { continue };
            if (before > 5.5) == is_first {
                sums[row.photon as usize][0] += 1.0;
                sums[row.photon as usize][1] += energy(row);
            }
        }
        let [number, total] = sums.iter().fold([0.0, 0.0], |[n, e], own| [n + own[0], e + own[1]]);
        let mean = total / number;
        assert!(number > 1000.0, "{number}");
        let variance: f64 = sums.iter().map(|own| (own[1] - mean * own[0]).powi(2)).sum();
        // both samples have the same number of photons
        let z = (mean - published) / (2.0 * variance).sqrt() * number;
        assert!(z.abs() < 3.0, "{mean} eV of {number} photons, published {published}: z = {z:.2}");
    }
}
