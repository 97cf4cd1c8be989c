//! Runs on a device against those of the CPU, bit for bit. Skipped with a message where there is no adapter.

#[path = "../../benches/gpu/detectors.rs"]
#[expect(dead_code, reason = "the benchmark reads more of a detector")]
mod detectors;

use super::codes::{ALL, HANDED_BACK, UNKNOWN};
use super::tables::kind;
use super::*;
use crate::history::{Histories, HistoryOptions, Process};
use crate::source::Torch;
use num_complex::Complex64;
use rayweave_formats::{Format, Options};
use rayweave_gpu::Gpu;
use rayweave_optics::interface::fresnel;
use rayweave_trace::Packets;

const MATRICES: &str = r#"
<matrix name="AIR" coldim="2" values="1*eV 1 10*eV 1"/>
<matrix name="WATER" coldim="2" values="1*eV 1.32 2.5*eV 1.335 4*eV 1.35 10*eV 1.4"/>
<matrix name="GLASS" coldim="2" values="1*eV 1.47 10*eV 1.52"/>
<matrix name="LONG" coldim="2" values="1*eV 20000 10*eV 15000"/>
<matrix name="MIDDLE" coldim="2" values="1*eV 900 10*eV 700"/>
<matrix name="BLUE" coldim="2" values="1*eV 1e12 2.9*eV 1e12 3.1*eV 0.8 11*eV 0.8"/>
<matrix name="GREEN" coldim="2" values="2.2*eV 0.1 2.5*eV 1 2.85*eV 0"/>
<matrix name="NS" coldim="1" values="2.5"/>
<matrix name="R" coldim="2" values="1*eV 0.9 10*eV 0.7"/>
<matrix name="FORWARD" coldim="1" values="0.8"/><matrix name="ALL" coldim="1" values="0.9"/>
<matrix name="NM" coldim="1" values="90*nm"/>
<matrix name="HALF" coldim="2" values="1*eV 0.5 10*eV 0.5"/>
<matrix name="LITTLE" coldim="2" values="1*eV 0.1 10*eV 0.2"/>"#;

/// A GDML file: materials as (name, properties), then solids and structure.
fn detector(materials: &[(&str, &str)], solids: &str, structure: &str) -> Detector {
    let property = |pair: &str| {
        let (name, table) = pair.split_once('=').unwrap();
        format!(r#"<property name="{name}" ref="{table}"/>"#)
    };
    let material = |(name, properties): &(&str, &str)| {
        let properties: String = properties.split_whitespace().map(property).collect();
        format!(r#"<material name="{name}"><D value="1"/><fraction n="1" ref="H"/>{properties}</material>"#)
    };
    let materials: String = materials.iter().map(material).collect();
    let text = format!(
        r#"<gdml><define>{MATRICES}</define>
<materials><element name="H" Z="1"><atom value="1"/></element>{materials}</materials>
<solids>{solids}</solids><structure>{structure}</structure>
<setup name="Default" version="1.0"><world ref="World"/></setup></gdml>"#
    );
    loaded(&text)
}

fn loaded(text: &str) -> Detector {
    let imported = rayweave_formats::parse(text, Format::Gdml, &[], &Options::default()).unwrap();
    let document = imported.document();
    Detector::new(&imported.scene, &document).unwrap()
}

fn cube(name: &str, size: f64) -> String {
    format!(r#"<box name="{name}" x="{size}" y="{size}" z="{size}" lunit="mm"/>"#)
}

fn volume(name: &str, material: &str, solid: &str, inside: &str) -> String {
    format!(
        r#"<volume name="{name}"><materialref ref="{material}"/><solidref ref="{solid}"/>{inside}</volume>"#
    )
}

fn placed(volume: &str, [x, y, z]: [f64; 3], turned: &str) -> String {
    format!(
        r#"<physvol name="{volume}_pv"><volumeref ref="{volume}"/>
<position name="p_{volume}" x="{x}" y="{y}" z="{z}" unit="mm"/>{turned}</physvol>"#
    )
}

const SENSITIVE: &str = r#"<auxiliary auxtype="SensDet" auxvalue="eye"/>"#;

/// A box of water in air, with a block of glass that detects.
pub(super) fn water() -> Detector {
    detector(
        &[
            ("Air", "RINDEX=AIR"),
            ("Water", "RINDEX=WATER ABSLENGTH=LONG RAYLEIGH=MIDDLE"),
            ("Glass", "RINDEX=GLASS ABSLENGTH=LONG"),
        ],
        &[cube("WorldBox", 3000.0), cube("WaterBox", 1000.0), cube("EyeBox", 150.0)].concat(),
        &[
            volume("Eye", "Glass", "EyeBox", SENSITIVE),
            volume("Tank", "Water", "WaterBox", &placed("Eye", [200.0, -100.0, 300.0], "")),
            volume("World", "Air", "WorldBox", &placed("Tank", [10.0, 0.0, 0.0], "")),
        ]
        .concat(),
    )
}

/// Liquid argon in a layer of pTP, in wavelength-shifting plastic, in a shell of metal that detects, in a world.
pub(super) fn argon() -> Detector {
    loaded(include_str!("../../benches/gpu/argon.gdml"))
}

/// A sphere of glass with a mirror on a smaller sphere in it, in water.
pub(super) fn sphere() -> Detector {
    let surfaces = r#"<opticalsurface name="Mirror" model="glisur" finish="polished" type="dielectric_metal" value="1">
<property name="REFLECTIVITY" ref="R"/><property name="EFFICIENCY" ref="HALF"/></opticalsurface>
<opticalsurface name="Skin" model="unified" finish="polished" type="dielectric_dielectric" value="0">
<property name="REFLECTIVITY" ref="R"/><property name="TRANSMITTANCE" ref="LITTLE"/></opticalsurface>"#;
    detector(
        &[
            ("Water", "RINDEX=WATER ABSLENGTH=LONG RAYLEIGH=MIDDLE"),
            ("Glass", "RINDEX=GLASS ABSLENGTH=LONG"),
            ("Steel", ""),
        ],
        &[
            cube("WorldBox", 2000.0),
            r#"<orb name="Ball" r="300" lunit="mm"/><orb name="Core" r="120" lunit="mm"/>"#.to_owned(),
            surfaces.to_owned(),
        ]
        .concat(),
        &[
            volume("Inner", "Steel", "Core", ""),
            volume("Outer", "Glass", "Ball", &placed("Inner", [40.0, 30.0, -20.0], "")),
            volume("World", "Water", "WorldBox", &placed("Outer", [-100.0, 50.0, 20.0], "")),
            r#"<skinsurface name="a" surfaceproperty="Mirror"><volumeref ref="Inner"/></skinsurface>
<bordersurface name="b" surfaceproperty="Skin"><physvolref ref="World_pv"/><physvolref ref="Outer_pv"/></bordersurface>
<skinsurface name="c" surfaceproperty="Skin"><volumeref ref="Outer"/></skinsurface>"#
                .to_owned(),
        ]
        .concat(),
    )
}

/// Phototubes in water: cylinders of glass around vacuum, with a cathode that detects and a reflecting tube around it, one of them turned.
pub(super) fn phototube() -> Detector {
    let turned = r#"<rotation name="r" x="25" y="40" z="10" unit="deg"/>"#;
    let solids = r#"<tube name="Body" rmax="100" z="300" deltaphi="360" aunit="deg" lunit="mm"/>
<tube name="Void" rmax="97" z="292" deltaphi="360" aunit="deg" lunit="mm"/>
<tube name="Disc" rmax="90" z="2" deltaphi="360" aunit="deg" lunit="mm"/>
<tube name="Ring" rmin="92" rmax="95" z="200" deltaphi="360" aunit="deg" lunit="mm"/>
<opticalsurface name="Cathode" model="glisur" finish="polished" type="dielectric_dielectric" value="1">
<property name="REFLECTIVITY" ref="HALF"/><property name="EFFICIENCY" ref="R"/></opticalsurface>
<opticalsurface name="Paint" model="unified" finish="groundfrontpainted" type="dielectric_dielectric" value="1">
<property name="REFLECTIVITY" ref="R"/></opticalsurface>"#;
    let inside = [placed("Plate", [0.0, 0.0, 140.0], ""), placed("Tube", [0.0, 0.0, 20.0], "")].concat();
    detector(
        &[
            ("Water", "RINDEX=WATER ABSLENGTH=LONG RAYLEIGH=MIDDLE"),
            ("Glass", "RINDEX=GLASS ABSLENGTH=LONG"),
            ("Vacuum", "RINDEX=AIR"),
        ],
        &[cube("WorldBox", 1500.0), solids.to_owned()].concat(),
        &[
            volume("Plate", "Glass", "Disc", ""),
            volume("Tube", "Glass", "Ring", ""),
            volume("Hollow", "Vacuum", "Void", &inside),
            volume("Pmt", "Glass", "Body", &placed("Hollow", [0.0; 3], "")),
            volume("World", "Water", "WorldBox", &placed("Pmt", [150.0, -80.0, 60.0], turned)),
            r#"<skinsurface name="a" surfaceproperty="Cathode"><volumeref ref="Plate"/></skinsurface>
<skinsurface name="b" surfaceproperty="Paint"><volumeref ref="Tube"/></skinsurface>"#
                .to_owned(),
        ]
        .concat(),
    )
}

/// Rough surfaces of both models, with all reflections, and scattering by small particles.
fn rough() -> Detector {
    let surface = |name: &str, model: &str, kind: &str, value: f64, lobes: &str| {
        format!(
            r#"<opticalsurface name="{name}" model="{model}" finish="ground" type="{kind}" value="{value}">
<property name="REFLECTIVITY" ref="R"/><property name="EFFICIENCY" ref="HALF"/>{lobes}</opticalsurface>"#
        )
    };
    let lobes = r#"<property name="SPECULARLOBECONSTANT" ref="HALF"/><property name="SPECULARSPIKECONSTANT" ref="LITTLE"/>
<property name="BACKSCATTERCONSTANT" ref="LITTLE"/>"#;
    let solids = [
        surface("A", "unified", "dielectric_dielectric", 0.15, lobes),
        surface("B", "glisur", "dielectric_dielectric", 0.6, ""),
        surface("C", "unified", "dielectric_metal", 0.2, lobes),
        surface("D", "glisur", "dielectric_metal", 0.7, ""),
    ];
    let names = ["A", "B", "C", "D"];
    let inside: String = (0..4)
        .map(|k| {
            placed(&format!("V{}", names[k]), [-300.0 + 200.0 * k as f64, 100.0 - 50.0 * k as f64, 40.0], "")
        })
        .collect();
    let volumes = names.map(|name| volume(&format!("V{name}"), "Glass", "Ball", ""));
    let skins = names.map(|name| {
        format!(
            r#"<skinsurface name="s{name}" surfaceproperty="{name}"><volumeref ref="V{name}"/></skinsurface>"#
        )
    });
    let haze = "RINDEX=WATER ABSLENGTH=LONG MIEHG=MIDDLE MIEHG_FORWARD=FORWARD MIEHG_BACKWARD=FORWARD MIEHG_FORWARD_RATIO=ALL";
    detector(
        &[("Haze", haze), ("Glass", "RINDEX=GLASS ABSLENGTH=LONG")],
        &[cube("WorldBox", 1000.0), r#"<orb name="Ball" r="80" lunit="mm"/>"#.to_owned(), solids.concat()]
            .concat(),
        &[volumes.concat(), volume("World", "Haze", "WorldBox", &inside), skins.concat()].concat(),
    )
}

/// Metals with a complex index of both models and finishes, and interfaces with a roughness.
fn metals() -> Detector {
    let lobes = r#"<property name="SPECULARLOBECONSTANT" ref="HALF"/><property name="SPECULARSPIKECONSTANT" ref="HALF"/>"#;
    let metal = |name: &str, model: &str, finish: &str, value: f64, more: &str| {
        format!(
            r#"<opticalsurface name="{name}" model="{model}" finish="{finish}" type="dielectric_metal" value="{value}">
<property name="REALRINDEX" ref="HALF"/><property name="IMAGINARYRINDEX" ref="GLASS"/>
<property name="EFFICIENCY" ref="R"/>{more}</opticalsurface>"#
        )
    };
    let frost = |name: &str, model: &str, finish: &str, value: f64| {
        format!(
            r#"<opticalsurface name="{name}" model="{model}" finish="{finish}" type="dielectric_dielectric" value="{value}">
<property name="SURFACEROUGHNESS" ref="NM"/>{lobes}</opticalsurface>"#
        )
    };
    let transmits = r#"<property name="TRANSMITTANCE" ref="LITTLE"/>"#;
    let solids = [
        metal("A", "glisur", "polished", 1.0, ""),
        metal("B", "unified", "ground", 0.3, lobes),
        metal("C", "glisur", "ground", 0.5, transmits),
        frost("D", "glisur", "polished", 1.0),
        frost("E", "unified", "ground", 0.1),
        frost("F", "glisur", "ground", 0.6),
    ];
    let names = ["A", "B", "C", "D", "E", "F"];
    let place = |k: usize| {
        [-250.0 + 250.0 * (k % 3) as f64, if k < 3 { 150.0 } else { -150.0 }, 40.0 * k as f64 - 100.0]
    };
    let inside: String = (0..6).map(|k| placed(&format!("V{}", names[k]), place(k), "")).collect();
    // interfaces are rough where the index falls: light is emitted in glass
    let volumes =
        names.map(|name| volume(&format!("V{name}"), if name < "D" { "Steel" } else { "Air" }, "Ball", ""));
    let skins = names.map(|name| {
        format!(
            r#"<skinsurface name="s{name}" surfaceproperty="{name}"><volumeref ref="V{name}"/></skinsurface>"#
        )
    });
    detector(
        &[("Glass", "RINDEX=GLASS ABSLENGTH=LONG"), ("Air", "RINDEX=AIR ABSLENGTH=LONG"), ("Steel", "")],
        &[cube("WorldBox", 1000.0), r#"<orb name="Ball" r="100" lunit="mm"/>"#.to_owned(), solids.concat()]
            .concat(),
        &[volumes.concat(), volume("World", "Glass", "WorldBox", &inside), skins.concat()].concat(),
    )
}

/// Parts that the device does not settle: a thin film, paint behind a layer, a cone, a shifter that emits several photons, and copies
/// that touch.
fn others() -> Detector {
    let solids = r#"<cone name="Horn" rmax1="40" rmax2="100" z="200" deltaphi="360" aunit="deg" lunit="mm"/>
<opticalsurface name="Film" model="glisur" finish="polished" type="coated" value="1">
<property name="COATEDRINDEX" ref="WATER"/><property name="COATEDTHICKNESS" ref="NM"/></opticalsurface>
<opticalsurface name="Wrapped" model="unified" finish="polishedbackpainted" type="dielectric_dielectric" value="0.1">
<property name="RINDEX" ref="AIR"/><property name="REFLECTIVITY" ref="R"/></opticalsurface>"#;
    let copy = |number: u32, x: f64| {
        format!(
            r#"<physvol name="e{number}" copynumber="{number}"><volumeref ref="Eye"/><position name="q{number}" x="{x}" y="425" z="425" unit="mm"/></physvol>"#
        )
    };
    let inside = [
        placed("Dye", [-200.0, -150.0, 100.0], ""),
        placed("Horn", [-200.0, 200.0, -100.0], ""),
        placed("Film", [250.0, 250.0, -250.0], ""),
        placed("Wrapped", [300.0, -100.0, -350.0], ""),
        copy(1, 0.0),
        copy(2, 150.0),
    ]
    .concat();
    detector(
        &[
            ("Water", "RINDEX=WATER ABSLENGTH=LONG RAYLEIGH=MIDDLE"),
            ("Glass", "RINDEX=GLASS ABSLENGTH=LONG"),
            (
                "Dye",
                "RINDEX=GLASS WLSABSLENGTH=BLUE WLSCOMPONENT=GREEN WLSTIMECONSTANT=NS WLSMEANNUMBERPHOTONS=NS",
            ),
        ],
        &[cube("WorldBox", 3000.0), cube("WaterBox", 1000.0), cube("EyeBox", 150.0), solids.to_owned()]
            .concat(),
        &[
            volume("Eye", "Glass", "EyeBox", SENSITIVE),
            volume("Dye", "Dye", "EyeBox", ""),
            volume("Horn", "Glass", "Horn", ""),
            volume("Film", "Glass", "EyeBox", ""),
            volume("Wrapped", "Glass", "EyeBox", ""),
            volume("Tank", "Water", "WaterBox", &inside),
            volume("World", "Glass", "WorldBox", &placed("Tank", [10.0, 0.0, 0.0], "")),
            ["Film", "Wrapped"]
                .map(|name| {
                    format!(
                        r#"<skinsurface name="{name}_skin" surfaceproperty="{name}"><volumeref ref="{name}"/></skinsurface>"#
                    )
                })
                .concat(),
        ]
        .concat(),
    )
}

/// Parts that touch, turned in space: a block of crystal with a sensor at its end and a daughter flush with three of its faces, a core
/// in a tube of the same radius, and a row of copies.
fn touching() -> Detector {
    let solids = r#"<box name="FrameBox" x="500" y="400" z="300" lunit="mm"/>
<box name="BlockBox" x="200" y="100" z="90" lunit="mm"/><box name="SensorBox" x="7" y="100" z="80" lunit="mm"/>
<box name="FlushBox" x="33.3" y="100" z="90" lunit="mm"/>
<tube name="Core" rmax="30.1" z="150" deltaphi="360" aunit="deg" lunit="mm"/>
<tube name="Sleeve" rmin="30.1" rmax="45.7" z="150" deltaphi="360" aunit="deg" lunit="mm"/>"#;
    let at = |name: &str, volume: &str, [x, y, z]: [f64; 3]| {
        format!(
            r#"<physvol name="{name}"><volumeref ref="{volume}"/><position name="p_{name}" x="{x}" y="{y}" z="{z}" unit="mm"/></physvol>"#
        )
    };
    let inside = [
        at("block", "Block", [-50.3, -90.7, 10.1]),
        at("sensor", "Sensor", [53.2, -90.7, 10.1]),
        at("core", "Core", [-110.3, 80.1, 20.7]),
        at("sleeve", "Sleeve", [-110.3, 80.1, 20.7]),
        (0..4).map(|k| at(&format!("bead{k}"), "Bead", [30.1 + 20.3 * f64::from(k), 70.9, 5.3])).collect(),
    ]
    .concat();
    let turned = r#"<rotation name="r" x="25" y="40" z="10" unit="deg"/>"#;
    detector(
        &[
            ("Water", "RINDEX=WATER ABSLENGTH=LONG RAYLEIGH=MIDDLE"),
            ("Glass", "RINDEX=GLASS ABSLENGTH=LONG"),
            ("Air", "RINDEX=AIR"),
        ],
        &[cube("WorldBox", 1500.0), cube("BeadBox", 20.3), solids.to_owned()].concat(),
        &[
            volume("Flush", "Water", "FlushBox", ""),
            volume("Block", "Glass", "BlockBox", &at("flush", "Flush", [-83.35, 0.0, 0.0])),
            volume("Sensor", "Glass", "SensorBox", SENSITIVE),
            volume("Core", "Water", "Core", ""),
            volume("Sleeve", "Glass", "Sleeve", ""),
            volume("Bead", "Glass", "BeadBox", ""),
            volume("Frame", "Air", "FrameBox", &inside),
            volume("World", "Water", "WorldBox", &placed("Frame", [37.7, -20.9, 11.3], turned)),
        ]
        .concat(),
    )
}

/// A detector of the benchmark.
fn of_benchmark(name: &str) -> (Detector, Source) {
    let (_, case) = detectors::DETECTORS.iter().find(|(own, _)| *own == name).unwrap();
    let case = case().unwrap();
    let torch = Torch::point(Vec3::from_array(case.at), case.wavelength_nm).unwrap();
    (loaded(&case.gdml), Source::Torch(torch))
}

/// Photons at a surface that the device does not know are handed back: no kernel takes it for a simpler one.
#[test]
fn surfaces_that_the_device_does_not_know() {
    let detector = others();
    assert_eq!(detector.surfaces.len(), 2);
    for surface in &detector.surfaces {
        assert_eq!(kind(Some(surface), false), UNKNOWN, "{surface:?}");
    }
    // the device knows the surfaces of the other detectors
    for surface in
        [argon(), sphere(), phototube(), rough(), metals()].iter().flat_map(|detector| &detector.surfaces)
    {
        assert_ne!(kind(Some(surface), false), UNKNOWN, "{surface:?}");
    }
}

/// The detectors, each with a place and a wavelength of its photons and the largest share that the CPU may have to finish.
fn cases() -> [(&'static str, Detector, Source, f64); 10] {
    let [crystals, tank] = ["crystals 10 x 10", "tank of 10086"].map(of_benchmark);
    let torch = |place: [f64; 3], nm: f64| Source::Torch(Torch::point(Vec3::from_array(place), nm).unwrap());
    [
        ("water box", water(), torch([30.0, 20.0, 10.0], 420.0), 0.01),
        ("five boxes of liquid argon", argon(), torch([300.0, 20.0, -10.0], 128.0), 0.01),
        ("sphere in a box", sphere(), torch([200.0, 350.0, 100.0], 400.0), 0.01),
        ("phototube", phototube(), torch([150.0, -80.0, 60.0], 400.0), 0.02),
        ("rough balls in haze", rough(), torch([0.0, 0.0, 0.0], 410.0), 0.02),
        ("metals and rough interfaces", metals(), torch([0.0, 0.0, 0.0], 410.0), 0.02),
        ("others", others(), torch([15.0, 35.0, 100.0], 410.0), 0.9),
        ("parts that touch", touching(), torch([0.0, -80.0, 60.0], 410.0), 0.02),
        ("10 x 10 wrapped crystals", crystals.0, crystals.1, 0.02),
        ("10086 phototubes", tank.0, tank.1, 0.02),
    ]
}

fn with_adapter(test: impl FnOnce(&Adapter)) {
    let gpu = Gpu::new();
    match gpu.adapter(0) {
        Ok(adapter) if adapter.has_f64() => test(adapter),
        Ok(adapter) => rayweave_conformance::skipped(format!("{} has no double precision", adapter.name())),
        Err(problem) => rayweave_conformance::skipped(problem),
    }
}

fn on_device(
    device: &PhotonDevice,
    detector: &Detector,
    source: &Source,
    settings: &RunSettings,
) -> (PhotonRun, PhotonDeviceReport) {
    let evaluator = Packets::new(detector.program.clone());
    let (mut total, mut report) = (PhotonRun::default(), PhotonDeviceReport::default());
    let merge = |part: PhotonPart| -> Result<(), PhotonError> {
        total.append(part.run);
        Ok(())
    };
    device.simulate_parts(detector, &evaluator, source, settings, &mut report, merge).unwrap();
    (total, report)
}

fn compare_with_the_cpu(cases: &[(&'static str, Detector, Source, f64)]) {
    with_adapter(|adapter| {
        for (name, detector, source, most) in cases {
            let device = PhotonDevice::new(adapter, detector).unwrap();
            hits_and_counts(name, (&device, detector, source), *most);
            histories(name, (&device, detector, source), *most);
        }
    });
}

/// In two tests, since lavapipe compiles each kernel for many seconds.
#[test]
fn photons_are_those_of_the_cpu() {
    compare_with_the_cpu(&cases()[..5]);
}

#[test]
fn photons_at_special_surfaces_and_in_large_detectors() {
    compare_with_the_cpu(&cases()[5..]);
}

/// Hits and counts are those of the CPU; `most` is the largest share of the photons that the CPU may have to finish.
fn hits_and_counts(name: &str, (device, detector, source): (&PhotonDevice, &Detector, &Source), most: f64) {
    let settings = RunSettings { seed: 11, ..RunSettings::new(5..20_005) };
    let evaluator = Packets::new(detector.program.clone());
    let cpu = crate::simulate(detector, &evaluator, source, &settings).unwrap();
    let (gpu, report) = on_device(device, detector, source, &settings);
    let share = report.handed_back as f64 / report.photons as f64;
    println!(
        "{name}: {} photons, {} steps, {} hits; {:.2} % of the photons handed back, {:.2} % of the steps",
        cpu.photons,
        cpu.steps,
        cpu.hits.len(),
        100.0 * share,
        100.0 * (1.0 - report.steps as f64 / cpu.steps as f64)
    );
    assert_eq!(report.problem, None);
    assert!(cpu.hits.len() > 50, "{name}: {} hits", cpu.hits.len());
    assert_eq!(gpu, cpu, "{name}");
    assert!(share < most, "{name}: {share}");
}

/// Photons that the device finishes have the ends, the steps, the times and the wavelengths of the CPU.
fn histories(name: &str, (device, detector, source): (&PhotonDevice, &Detector, &Source), most: f64) {
    let settings = RunSettings { seed: 3, ..RunSettings::new(0..5000) };
    let evaluator = Packets::new(detector.program.clone());
    let mut histories = Histories::default();
    let options = Some(HistoryOptions { steps: true, sequences: false });
    simulate_parts(detector, &evaluator, source, &settings, options, |part| {
        histories.append(part.histories.unwrap());
        Ok::<(), PhotonError>(())
    })
    .unwrap();
    let job = Job { device, detector, evaluator: &evaluator, source, settings: &settings };
    let own = endings(device, &job, 0..5000);
    assert!(own.len() as f64 >= 5000.0 * (1.0 - most), "{name}: {}", own.len());
    let mut last = std::collections::HashMap::new();
    for row in &histories.steps {
        let end = match row.process {
            Process::End(end) => end,
            // followed by no other row
            _ => End::Detected,
        };
        last.insert(row.photon as u64, (end, row.step, row.time.to_bits(), row.wavelength_nm));
    }
    for (number, end, steps, [time, energy]) in own {
        let (own_end, own_steps, own_time, wavelength) = last[&number];
        assert_eq!((end, steps, time), (own_end, own_steps, own_time), "{name}: photon {number}");
        let energy = crate::property::wavelength_nm(f64::from_bits(energy));
        assert_eq!(energy.to_bits(), wavelength.to_bits(), "{name}: photon {number}");
    }
}

/// Two batches are in flight, and the second of each pair is complete before the first: the result is that of the CPU.
#[test]
fn the_order_in_which_batches_are_complete_changes_nothing() {
    const ROOM: u64 = 1000;
    static COMPLETE: Mutex<Vec<u64>> = Mutex::new(Vec::new());
    fn after_the_next(first: u64) {
        let begin = Instant::now();
        let waits =
            || (first / ROOM).is_multiple_of(2) && !COMPLETE.lock().unwrap().contains(&(first + ROOM));
        while waits() && begin.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(1));
        }
        COMPLETE.lock().unwrap().push(first);
    }
    with_adapter(|adapter| {
        let detector = rough();
        let source = Source::Torch(Torch::point(Vec3::ZERO, 410.0).unwrap());
        let evaluator = Packets::new(detector.program.clone());
        let tables = Tables::new(&detector).unwrap();
        let mut device = PhotonDevice::with_tables(adapter, tables, ROOM as usize).unwrap();
        for threads in [1, 3] {
            let threads = NonZeroUsize::new(threads);
            let settings = RunSettings { seed: 8, threads, ..RunSettings::new(0..4 * ROOM) };
            let cpu = crate::simulate(&detector, &evaluator, &source, &settings).unwrap();
            assert!(cpu.hits.len() > 100);
            device.completed = after_the_next;
            COMPLETE.lock().unwrap().clear();
            let (run, report) = on_device(&device, &detector, &source, &settings);
            assert_eq!((run, report.problem), (cpu, None));
            assert_eq!(*COMPLETE.lock().unwrap(), [ROOM, 0, 3 * ROOM, 2 * ROOM]);
        }
        assert_eq!(device.slots.lock().unwrap().len(), 2);
    });
}

/// Photons on a device by another kernel.
fn device_with(adapter: &Adapter, detector: &Detector, change: impl Fn(String) -> String) -> PhotonDevice {
    let tables = Tables::new(detector).unwrap();
    let tables = Tables { source: change(tables.source.clone()), ..tables };
    PhotonDevice::with_tables(adapter, tables, SOFTWARE_ROOM).unwrap()
}

/// A kernel with a result that is wrong by one unit in the last place is noticed.
#[test]
fn an_error_of_one_unit_is_noticed() {
    with_adapter(|adapter| {
        let wrong = [
            ("let length = times_(mean, -log64(u));", "let length = off(times_(mean, -log64(u)));"),
            ("touched.position = difference64(", "touched.position = off_x("),
        ];
        let helpers = "fn off(x: f64) -> f64 { return bitcast<f64>(bitcast<u64>(x) + 1lu); }
fn off_x(a: vec3<f64>, b: vec3<f64>) -> vec3<f64> {
    let v = difference64(a, b);
    return vec3<f64>(off(v.x), v.yz);
}
";
        let (detector, source) =
            (water(), Source::Torch(Torch::point(Vec3::new(30.0, 20.0, 10.0), 420.0).unwrap()));
        let settings = RunSettings::new(0..2000);
        for (right, wrong) in wrong {
            let device = device_with(adapter, &detector, |text| {
                assert!(text.contains(right), "{right}");
                format!("{}\n{helpers}", text.replace(right, wrong))
            });
            let (run, report) = on_device(&device, &detector, &source, &settings);
            // the CPU has simulated all photons instead
            let evaluator = Packets::new(detector.program.clone());
            assert_eq!(run, crate::simulate(&detector, &evaluator, &source, &settings).unwrap());
            assert!(matches!(report.problem, Some(GpuError::Contradicted { .. })), "{wrong}: {report:?}");
        }
    });
}

/// For each photon that ended on the device: the number, the way of ending, the steps, and the bits of time and energy.
fn endings(
    device: &PhotonDevice,
    job: &Job<'_, Packets>,
    numbers: Range<u64>,
) -> Vec<(u64, End, u32, [u64; 2])> {
    let (carrier, slots) = (&device.carrier, device.slots.lock().unwrap());
    job.emit(&slots[0], numbers.clone()).ok().unwrap();
    let mut params = job.params();
    params[6] |= ALL;
    let carried = carrier.run(&slots[0], (numbers.end - numbers.start) as usize, &params, || false).unwrap();
    let key = EventKey { seed: job.settings.seed, event: job.settings.event };
    let rows = 0..carried.words.len() / ROW[1];
    let mut all: Vec<_> = rows
        .map(|row| Returned::new(&carried, row, (numbers.start, key)))
        .filter(|own| own.state != HANDED_BACK)
        .map(|own| {
            let bits = [own.flight.photon.time, own.flight.photon.energy].map(f64::to_bits);
            (own.flight.origin, End::ALL[own.state as usize - 1], own.flight.steps, bits)
        })
        .collect();
    all.sort_unstable_by_key(|row| row.0);
    all
}

/// Reflected powers of metals, and logarithms, cosines and sines of the device for arguments between 0 and 1, those of turns and those of angles up to an eighth of
/// a turn.
fn check_functions(batches: u64) {
    with_adapter(|adapter| {
        let tables = Tables::new(&water()).unwrap();
        let main = tables.source.split("fn main(").next().unwrap();
        let source = format!(
            "{main}fn main(@builtin(global_invocation_id) id: vec3u, @builtin(num_workgroups) groups: vec3u) {{
    let i = id.y * groups.x * 64u + id.x;
    if i >= params.count {{
        if params.count == 0u {{
            fly(i);
        }}
        return;
    }}
    let x = numbers[11u * i];
    let turn = cos_sin(x);
    back_numbers[11u * i] = log64(x);
    back_numbers[11u * i + 1u] = turn.x;
    back_numbers[11u * i + 2u] = turn.y;
    let angle = min(x, 0.7849lf);
    back_numbers[11u * i + 3u] = small_sine(angle);
    back_numbers[11u * i + 4u] = small_cosine(angle);
    let n = 11u * i;
    let powers = metal_powers(numbers[n + 1u], vec2<f64>(numbers[n + 2u], numbers[n + 3u]), numbers[n + 4u]);
    back_numbers[n + 5u] = powers.x;
    back_numbers[n + 6u] = powers.y;
    atomicAdd(&counts[0], 1u);
}}"
        );
        const ROOM: usize = 1 << 18;
        let form = CarrierForm { state: STATE, row: ROW, counts: COUNTS, params: 8 };
        let columns = (&tables.next.exact[..], &tables.next.words[..]);
        let carrier = Carrier::new(adapter, source, columns, form, ROOM).unwrap();
        let slot = carrier.slot().unwrap();
        for batch in 0..batches {
            let mut stream = crate::philox::Stream::new(batch, 1, 2, crate::philox::Purpose::Boundary);
            // half of them near 0
            let number = |k: usize| {
                let u = stream.uniform();
                if k.is_multiple_of(2) {
                    u
                } else {
                    (u * libm::ldexp(1.0, -((k / 2 % 50) as i32))).max(libm::ldexp(1.0, -54))
                }
            };
            let numbers: Vec<f64> = (0..ROOM).map(number).collect();
            // index in front, complex index, cosine; some metals do not absorb
            let mut metal = |k: usize| {
                let [a, b, c, d] = std::array::from_fn(|_| stream.uniform());
                [1.0 + a, 0.02 + 3.0 * b, if k.is_multiple_of(8) { 0.0 } else { 5.0 * c * c }, d]
            };
            let metals: Vec<[f64; 4]> = (0..ROOM).map(&mut metal).collect();
            let arguments = || numbers.iter().zip(&metals);
            let state = |(x, metal): (&f64, &[f64; 4])| {
                let mut state = [0.0; STATE[0]];
                state[0] = *x;
                state[1..5].copy_from_slice(metal);
                state.map(f64::to_le_bytes).concat()
            };
            let bytes: Vec<u8> = arguments().flat_map(state).collect();
            carrier.load(&slot, 0, &bytes, &[]);
            let carried = carrier.run(&slot, ROOM, &[0; 8], || false).unwrap();
            let mut certain = 0;
            for ((x, metal), found) in arguments().zip(carried.numbers.chunks(ROW[0])) {
                let (cos, sin) = crate::philox::cos_sin_turns(*x);
                let expected = [libm::log(*x), cos, sin].map(f64::to_bits);
                assert_eq!([found[0], found[1], found[2]].map(f64::to_bits), expected, "{x:e}");
                // angles of facets
                let angle = x.min(0.7849);
                let expected = [libm::sin(angle), libm::cos(angle)].map(f64::to_bits);
                if angle > 2e-8 {
                    assert_eq!([found[3], found[4]].map(f64::to_bits), expected, "{angle:e}");
                }
                // reflected powers, within the bound in `approximate.wgsl`: the margin of comparisons is a hundred times as large
                let [index, real, imaginary, cosine] = *metal;
                let reflected = fresnel(index, Complex64::new(real, imaginary), cosine).reflected;
                if found[5] >= 0.0 {
                    certain += 1;
                    let errors = [0, 1].map(|p| (found[5 + p] - reflected[p].norm_sqr()).abs());
                    assert!(errors.iter().all(|error| *error < 1e-11), "{metal:?}: {errors:?}");
                }
            }
            assert!(certain as f64 > 0.99 * ROOM as f64, "{certain}");
        }
    });
}

#[test]
fn functions_are_those_of_the_cpu() {
    check_functions(2);
}

#[test]
#[ignore = "long"]
fn long_functions_are_those_of_the_cpu() {
    check_functions(40);
}

#[test]
fn unsuitable_cards_are_rejected_in_sentences() {
    let adapter = || "Card".to_owned();
    assert_eq!(
        GpuError::NoDouble { adapter: adapter() }.to_string(),
        "the GPU `Card` cannot follow photons: it has no numbers in double precision. Use the CPU."
    );
    assert_eq!(
        GpuError::Rounding { adapter: adapter() }.to_string(),
        "the GPU `Card` cannot follow photons: it rounds numbers in double precision otherwise than the CPU. Use the CPU."
    );
}

/// A volume with more shapes than a word has bits is an error that says so.
#[test]
fn volumes_of_too_many_shapes_are_rejected() {
    let mut solids = [cube("WorldBox", 3000.0), cube("Hole", 10.0), cube("Plate0", 2000.0)].concat();
    for k in 0..70 {
        solids += &format!(
            r#"<subtraction name="Plate{}"><first ref="Plate{k}"/><second ref="Hole"/><position name="q{k}" x="{}" unit="mm"/></subtraction>"#,
            k + 1,
            20 * k - 690
        );
    }
    let plate = placed("Plate", [0.0; 3], "");
    let detector = detector(
        &[("Water", "RINDEX=WATER")],
        &solids,
        &[volume("Plate", "Water", "Plate70", SENSITIVE), volume("World", "Water", "WorldBox", &plate)]
            .concat(),
    );
    let problem = Tables::new(&detector).unwrap_err().to_string();
    assert!(problem.contains("has more than 63 leaves and gates. Trace it on the CPU."), "{problem}");
}
