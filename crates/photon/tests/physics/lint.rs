//! Probable mistakes in the optical part of GDML files.

use crate::{CLEAR, SlabDetector};
use rayweave_formats::{Format, Options};
use rayweave_photon::{LintFinding, SurfaceTables, lint};
use rayweave_trace::Packets;

pub(crate) fn findings(text: &str) -> Vec<LintFinding> {
    let imported = rayweave_formats::parse(text, Format::Gdml, &[], &Options::default()).unwrap();
    let places = |element, name: &str, property: &str| {
        imported.places.find(element, name, property).map(str::to_owned)
    };
    lint(&imported.scene, &imported.document(), &SurfaceTables::default(), Packets::new, &places)
}

/// The only finding that contains a text.
fn found(slab: &SlabDetector<'_>, wanted: &str) -> LintFinding {
    let all = findings(&slab.text());
    let mut found = all.iter().filter(|finding| finding.to_string().contains(wanted));
    let one = found.next().unwrap_or_else(|| panic!("`{wanted}` is not among {all:#?}"));
    assert!(found.next().is_none(), "`{wanted}` is found twice: {all:#?}");
    one.clone()
}

/// Asserts that a finding is about a line of the file that contains a text.
fn assert_place(slab: &SlabDetector<'_>, finding: &LintFinding, on_line: &str) {
    let text = slab.text();
    let place = finding.place.as_ref().unwrap();
    let (line, _) = place.split_once(':').unwrap();
    let line = text.lines().nth(line.parse::<usize>().unwrap() - 1).unwrap();
    assert!(line.contains(on_line), "{place} is `{line}`");
}

const SKIN: &str = r#"<skinsurface name="skin" surfaceproperty="S"><volumeref ref="Slab"/></skinsurface>"#;

#[test]
fn a_sound_detector_has_no_findings() {
    assert_eq!(findings(&CLEAR.text()), []);
    let surface = r#"<opticalsurface name="S" model="unified" finish="ground" type="dielectric_metal" value="0.1">
<property name="REFLECTIVITY" ref="HALF"/><property name="EFFICIENCY" ref="HALF"/></opticalsurface>"#;
    let matrices = r#"<matrix name="LONG" coldim="2" values="1*eV 2*m 10*eV 1*m"/>"#;
    let sensor = SlabDetector {
        matrices,
        inner: r#"<property name="RINDEX" ref="GLASS"/><property name="ABSLENGTH" ref="LONG"/>"#,
        surfaces: surface,
        links: SKIN,
        auxiliary: r#"<auxiliary auxtype="SensDet" auxvalue="Counter"/>"#,
        ..CLEAR
    };
    assert_eq!(findings(&sensor.text()), []);
}

#[test]
fn a_scintillator_needs_a_resolution_scale_in_geant4() {
    let inner =
        r#"<property name="RINDEX" ref="GLASS"/><property name="SCINTILLATIONCOMPONENT1" ref="HALF"/>"#;
    let finding = found(&SlabDetector { inner, ..CLEAR }, "without `RESOLUTIONSCALE`");
    assert_place(&SlabDetector { inner, ..CLEAR }, &finding, "SCINTILLATIONCOMPONENT1");
    let inner = format!(r#"{inner}<property name="RESOLUTIONSCALE" ref="ONE"/>"#);
    let matrices = r#"<matrix name="ONE" coldim="1" values="1"/>"#;
    let complete = findings(&SlabDetector { inner: &inner, matrices, ..CLEAR }.text());
    assert!(
        complete.iter().all(|finding| !finding.to_string().contains("without `RESOLUTIONSCALE`")),
        "{complete:#?}"
    );
    // what the check asks for is not reported as unused
    let names = ["RESOLUTIONSCALE", "SCINTILLATIONYIELD"];
    let inner = format!(r#"{inner}<property name="SCINTILLATIONYIELD" ref="ONE"/>"#);
    let inner = inner.replace(r#"ref="ONE""#, r#"ref="SCALE""#);
    let matrices = r#"<matrix name="SCALE" coldim="1" values="1"/>"#;
    let complete = findings(&SlabDetector { inner: &inner, matrices, ..CLEAR }.text());
    assert!(
        complete.iter().all(|own| names.iter().all(|name| !own.to_string().contains(name))),
        "{complete:#?}"
    );
    assert_eq!(SlabDetector { inner: &inner, matrices, ..CLEAR }.build().notes(), [""; 0]);
}

/// Geant4 11.4.1 stops with the fatal exception mat202 in these materials, when the process acts on a photon.
#[test]
fn processes_need_their_constants_in_geant4() {
    let matrices = r#"<matrix name="SCALE" coldim="1" values="1"/>"#;
    let shifter = r#"<property name="RINDEX" ref="GLASS"/><property name="WLSABSLENGTH" ref="HALF"/><property name="WLSCOMPONENT" ref="HALF"/>"#;
    let scattering = r#"<property name="RINDEX" ref="GLASS"/><property name="MIEHG" ref="HALF"/>"#;
    for (inner, needed) in [
        (shifter, &["WLSTIMECONSTANT"][..]),
        (scattering, &["MIEHG_FORWARD_RATIO", "MIEHG_FORWARD", "MIEHG_BACKWARD"]),
    ] {
        let stated: String =
            needed.iter().map(|name| format!(r#"<property name="{name}" ref="SCALE"/>"#)).collect();
        let complete = format!("{inner}{stated}");
        for (inner, count) in [(inner, 1), (complete.as_str(), 0)] {
            let all = findings(&SlabDetector { inner, matrices, ..CLEAR }.text());
            for name in needed {
                let text = format!("without `{name}`: Geant4 stops where it acts on a photon");
                let found = all.iter().filter(|own| own.to_string().contains(&text)).count();
                assert_eq!(found, count, "{name}: {all:#?}");
            }
        }
    }
}

#[test]
fn energies_of_another_unit_are_named() {
    for (values, advice) in [
        ("2 1.5 4 1.5", "look like eV"),
        ("400 1.5 700 1.5", "look like wavelengths in nm"),
        ("0.002 1.5 0.004 1.5", "look like keV"),
        ("2*eV*eV 1.5 4*eV*eV 1.5", "applied twice"),
    ] {
        let matrices = format!(r#"<matrix name="OFF" coldim="2" values="{values}"/>"#);
        let inner = r#"<property name="RINDEX" ref="OFF"/>"#;
        let slab = SlabDetector { matrices: &matrices, inner, ..CLEAR };
        let finding = found(&slab, "are not those of light");
        assert!(finding.to_string().contains(advice), "{finding}");
        assert!(!finding.is_unused);
        assert_place(&slab, &finding, r#"ref="OFF""#);
    }
}

#[test]
fn implausible_values_are_named() {
    // 0.4 m, written without its unit, in a slab of 1.4 m
    let slab = |property: &'static str, values: &str| {
        let matrices = format!(r#"<matrix name="OFF" coldim="2" values="{values}"/>"#);
        (matrices, format!(r#"<property name="RINDEX" ref="GLASS"/><property name="{property}" ref="OFF"/>"#))
    };
    for (property, values, reason) in [
        (
            "ABSLENGTH",
            "2*eV 0.4 4*eV 0.4",
            "the longest absorption length is 0.4 mm, in volumes of at least 1418 mm",
        ),
        ("GROUPVEL", "2*eV 2e8 4*eV 2e8", "faster than light in vacuum"),
    ] {
        let (matrices, inner) = slab(property, values);
        let finding = found(&SlabDetector { matrices: &matrices, inner: &inner, ..CLEAR }, "are implausible");
        assert!(finding.to_string().contains(reason), "{finding}");
    }
    let inner = r#"<property name="RINDEX" ref="OFF"/>"#;
    let swapped = SlabDetector {
        matrices: r#"<matrix name="OFF" coldim="2" values="2*eV 30 4*eV 30"/>"#,
        inner,
        ..CLEAR
    };
    assert!(found(&swapped, "are implausible").to_string().contains("the index is 30 to 30"));
    let surface = |value: &str, rough: &str| {
        format!(
            r#"<opticalsurface name="S" model="unified" finish="ground" type="dielectric_dielectric" value="{value}">
<property name="SURFACEROUGHNESS" ref="{rough}"/></opticalsurface>"#
        )
    };
    let matrices =
        r#"<matrix name="TWENTY" coldim="1" values="20"/><matrix name="NM" coldim="1" values="20*nm"/>"#;
    let rough = surface("0.1", "TWENTY");
    let finding =
        found(&SlabDetector { matrices, surfaces: &rough, links: SKIN, ..CLEAR }, "SURFACEROUGHNESS");
    assert!(finding.to_string().contains("it is 20 mm, more than ten wavelengths"), "{finding}");
    let degrees = surface("12", "NM");
    let finding = found(&SlabDetector { matrices, surfaces: &degrees, links: SKIN, ..CLEAR }, "the value of");
    assert!(finding.to_string().contains("is it in degrees?"), "{finding}");
}

#[test]
fn tables_that_do_not_fit_together_are_named() {
    let matrices = r#"<matrix name="BLUE" coldim="2" values="2*eV 1.5 3*eV 1.5"/>
<matrix name="DEEP" coldim="2" values="5*eV 500 7*eV 500"/>
<matrix name="MIXED" coldim="2" values="2*eV 500 3*eV 500 2.5*eV 400"/>
<matrix name="GLOW" coldim="2" values="2.5*eV 1 3.5*eV 1"/><matrix name="NS" coldim="1" values="1*ns"/>"#;
    let with = |properties: &str, wanted: &str| {
        let inner = format!(r#"<property name="RINDEX" ref="BLUE"/>{properties}"#);
        found(&SlabDetector { matrices, inner: &inner, ..CLEAR }, wanted).to_string()
    };
    let apart = with(r#"<property name="ABSLENGTH" ref="DEEP"/>"#, "no energies in common");
    assert!(apart.contains("they cover 5 to 7 eV and 2 to 3 eV"), "{apart}");
    let unsorted = with(r#"<property name="ABSLENGTH" ref="MIXED"/>"#, "are unsorted");
    assert!(unsorted.contains("2.5 eV follows 3 eV at row 3"), "{unsorted}");
    let glow = r#"<property name="WLSABSLENGTH" ref="MIXED"/><property name="WLSCOMPONENT" ref="GLOW"/>"#;
    let emission = with(glow, "emits light where its index is not given");
    assert!(emission.contains("`WLSCOMPONENT` covers 2.5 to 3.5 eV, `RINDEX` 2 to 3 eV"), "{emission}");
}

/// The fraction of photons of a spectrum that lie elsewhere than with a linear density: 1/4 for a triangle of any shape (the area is 1/2
/// of its base, and |b - a| w / 8 adds up to 1/8 of it), 1/4 for a ramp from 0, and 1/14 for the values 1, 3, 3 and 1 at
/// equal distances, (2 + 2) / 8 over 2 + 3 + 2, which is no finding.
#[test]
fn coarse_emission_spectra_are_named() {
    let about = |values: &str| {
        let matrices = format!(
            r#"<matrix name="GLOW" coldim="2" values="{values}"/><matrix name="LONG" coldim="2" values="1*eV 9000 10*eV 9000"/>"#
        );
        let inner = r#"<property name="RINDEX" ref="GLASS"/><property name="WLSABSLENGTH" ref="LONG"/>
<property name="WLSCOMPONENT" ref="GLOW"/>"#;
        let all = findings(&SlabDetector { matrices: &matrices, inner, ..CLEAR }.text());
        all.iter().map(ToString::to_string).filter(|text| text.contains("has few points")).collect::<Vec<_>>()
    };
    for values in ["2.5*eV 0 2.9*eV 1 3.4*eV 0", "2.5*eV 0 3.4*eV 1"] {
        let [one] = about(values).try_into().unwrap();
        assert!(
            one.contains("`WLSCOMPONENT` of material `Inner`") && one.contains(" 25 % of the photons"),
            "{one}"
        );
    }
    assert_eq!(about("2.5*eV 1 3*eV 3 3.5*eV 3 4*eV 1"), Vec::<String>::new());
    assert_eq!(about("2.5*eV 1 3.4*eV 1"), Vec::<String>::new());
    // a Gaussian with points at half its deviation, which loses 5 %, and at one and a half
    let gaussian = |step: f64| {
        let at = |k: i32| {
            let x = f64::from(k) * step;
            format!("{}*eV {} ", 3.0 + 0.1 * x, (-0.5 * x * x).exp())
        };
        (-6..=6).map(at).collect::<String>()
    };
    assert_eq!(about(&gaussian(0.5)), Vec::<String>::new());
    let [coarse] = about(&gaussian(1.5)).try_into().unwrap();
    assert!(coarse.contains(" 15 % of the photons") || coarse.contains(" 14 % of the photons"), "{coarse}");
}

#[test]
fn names_and_order_of_geant4_are_respected() {
    let matrices = r#"<matrix name="SLOW" coldim="2" values="1*eV 100 10*eV 100"/>"#;
    let inner = r#"<property name="GROUPVEL" ref="SLOW"/>
<property name="RINDEX" ref="GLASS"/><property name="FASTCOMPONENT" ref="ONE"/>"#;
    let slab = SlabDetector { matrices, inner, ..CLEAR };
    let renamed = found(&slab, "FASTCOMPONENT");
    assert!(renamed.to_string().contains("Use SCINTILLATIONCOMPONENT1."), "{renamed}");
    assert_place(&slab, &renamed, "FASTCOMPONENT");
    let order = found(&slab, "`GROUPVEL` of material `Inner` has no effect");
    assert!(order.is_unused);
    // the velocity is that of the index
    let velocity = slab
        .build()
        .materials()
        .iter()
        .find(|material| material.name == "Inner")
        .unwrap()
        .group_velocity
        .clone();
    assert_eq!(velocity.unwrap().values(), [rayweave_photon::property::LIGHT_SPEED / 1.5; 2]);
    let coated = r#"<opticalsurface name="S" model="glisur" finish="polished" type="coated" value="1">
<property name="COATEDRINDEX" ref="GLASS"/></opticalsurface>"#;
    let coated = found(&SlabDetector { surfaces: coated, links: SKIN, ..CLEAR }, "the type `coated`");
    assert!(coated.to_string().contains("reads it as `x_ray`"), "{coated}");
    let filter =
        r#"<opticalsurface name="S" model="glisur" finish="polished" type="dielectric_dichroic" value="1"/>"#;
    let slab = SlabDetector { surfaces: filter, links: SKIN, ..CLEAR };
    assert!(
        found(&slab, "does not fit its type")
            .to_string()
            .contains("Set the model to LUT, DAVIS or dichroic.")
    );
    assert!(found(&slab, "has no table").place.is_some());
}

#[test]
fn problems_and_unused_input_have_their_places() {
    let surfaces = r#"<opticalsurface name="Idle" model="glisur" finish="polished" type="dielectric_metal" value="1"/>
<opticalsurface name="S" model="glisur" finish="polish" type="dielectric_metal" value="1">
<property name="REFLECTIVITY" ref="PERCENT"/></opticalsurface>"#;
    let matrices = r#"<matrix name="PERCENT" coldim="2" values="1*eV 95 10*eV 95"/>"#;
    let inner = r#"<property name="RINDEX" ref="GLASS"/>
<property name="RINDEKS" ref="GLASS"/>"#;
    let slab = SlabDetector { matrices, inner, surfaces, links: SKIN, ..CLEAR };
    let idle = found(&slab, "optical surface `Idle` is ignored");
    assert!(idle.is_unused);
    assert_place(&slab, &idle, r#"name="Idle""#);
    let unknown = found(&slab, "`RINDEKS` is ignored");
    assert!(unknown.is_unused);
    assert_place(&slab, &unknown, "RINDEKS");
    assert!(unknown.to_string().ends_with("Did you mean `RINDEX`?"), "{unknown}");
    let word = found(&slab, "the finish `polish`");
    assert!(word.to_string().contains("Did you mean `polished`?"), "{word}");
    assert_place(&slab, &word, r#"name="S""#);
    let percent = found(&slab, "`REFLECTIVITY` of optical surface `S` are implausible");
    assert!(percent.to_string().contains("Are they percentages?"), "{percent}");
}

#[test]
fn volumes_that_light_cannot_pass_are_named() {
    let opaque = SlabDetector {
        inner: "",
        auxiliary: r#"<auxiliary auxtype="SensDet" auxvalue="Counter"/>"#,
        ..CLEAR
    };
    let index = found(&opaque, "photons from `World` end on reaching it");
    assert!(index.to_string().contains("material `Inner` has no `RINDEX`"), "{index}");
    let sensor = found(&opaque, "with the sensor `Counter` detects nothing");
    assert_place(&opaque, &sensor, r#"<material name="Inner">"#);
    let surfaces = r#"<opticalsurface name="S" model="glisur" finish="polished" type="dielectric_metal" value="1">
<property name="EFFICIENCY" ref="HALF"/></opticalsurface>"#;
    let detecting = SlabDetector { surfaces, links: SKIN, ..opaque };
    assert_eq!(findings(&detecting.text()), []);
    let blind = SlabDetector { auxiliary: "", ..detecting };
    let blind = found(&blind, "no volume behind it is a sensor");
    assert!(blind.to_string().contains("--detect efficiency"), "{blind}");
}

/// Siblings that touch, in a mother that is opaque like one of them: a clear slab and an opaque plate on it.
#[test]
fn touching_siblings_without_an_index_are_named() {
    let text = |gap: f64, links: &str| {
        let plate = format!(
            r#"<physvol name="plate"><volumeref ref="Plate"/><position name="q" z="{}" unit="mm"/></physvol></volume>"#,
            150.0 + gap
        );
        let slab = SlabDetector { surfaces: MIRROR, links, ..CLEAR };
        slab.text()
            .replace(r#"<volume name="World">"#, r#"<volume name="Plate"><materialref ref="Lead"/><solidref ref="SlabBox"/></volume><volume name="World">"#)
            .replace("</materials>", r#"<material name="Lead"><D value="11"/><fraction n="1" ref="H"/></material></materials>"#)
            .replace(r#"unit="mm"/></physvol></volume>"#, &format!(r#"unit="mm"/></physvol>{plate}"#))
    };
    let about = |text: &str| {
        let all = findings(text);
        all.iter()
            .map(ToString::to_string)
            .filter(|found| found.contains("`Lead` has no"))
            .collect::<Vec<_>>()
    };
    // the mother is clear: named in any case, and the slab only if it touches
    let [apart, touching] = [1.0, 0.0].map(|gap| about(&text(gap, "")));
    assert!(apart.len() == 1 && apart[0].contains("photons from `World` end"), "{apart:?}");
    assert!(touching.len() == 1 && touching[0].contains("photons from `Slab`, `World` end"), "{touching:?}");
    // a skin of the plate is a surface between all of them
    let skin = r#"<skinsurface name="skin" surfaceproperty="S"><volumeref ref="Plate"/></skinsurface>"#;
    assert_eq!(about(&text(0.0, skin)), Vec::<String>::new());
}

const MIRROR: &str = r#"<opticalsurface name="S" model="glisur" finish="polished" type="dielectric_metal" value="1"/>
<opticalsurface name="T" model="glisur" finish="polished" type="dielectric_metal" value="1"/>"#;

#[test]
fn surfaces_that_compete_are_named() {
    let inside = r#"<physvol name="tank"><volumeref ref="Tank"/></physvol><physvol name="slab">"#;
    let border = |name: &str, first: &str, second: &str| {
        format!(
            r#"<bordersurface name="{name}" surfaceproperty="T"><physvolref ref="{first}"/><physvolref ref="{second}"/></bordersurface>"#
        )
    };
    let text = |links: &str| {
        let slab = SlabDetector { surfaces: MIRROR, links, ..CLEAR };
        let tank = r#"<volume name="Tank"><materialref ref="Outer"/><solidref ref="SlabBox"/></volume><volume name="World">"#;
        slab.text().replace(r#"<volume name="World">"#, tank).replace(r#"<physvol name="slab">"#, inside)
    };
    let one = format!("{SKIN}\n{}", border("way", "tank", "slab"));
    let all = findings(&text(&one));
    let competing =
        all.iter().find(|finding| finding.to_string().contains("two optical surfaces lie")).unwrap();
    assert!(
        competing.to_string().contains("skin surface `skin` of volume `Slab` on light in the other"),
        "{competing}"
    );
    let both = format!("{one}{}", border("back", "slab", "tank"));
    assert!(
        findings(&text(&both)).iter().all(|finding| !finding.to_string().contains("two optical surfaces"))
    );
    let twice =
        format!("{SKIN}{}", SKIN.replace(r#"name="skin""#, r#"name="again""#).replace(r#""S""#, r#""T""#));
    let twice = found(&SlabDetector { surfaces: MIRROR, links: &twice, ..CLEAR }, "has no effect");
    assert!(twice.to_string().contains("the volume has the skin `skin` already"), "{twice}");
    assert!(twice.is_unused);
}

/// A tank of water with a black skin and four sensors at one end, in an opaque world; `links` are its border and skin surfaces.
fn tank(links: &str) -> String {
    let placed = |k: i32| {
        let (x, y) = (25 * (2 * (k % 2) - 1), 25 * (2 * (k / 2) - 1));
        format!(
            r#"<physvol name="s{k}" copynumber="{k}"><volumeref ref="Sensor"/><position name="p{k}" x="{x}" y="{y}" z="151" unit="mm"/></physvol>"#
        )
    };
    let sensors: String = (0..4).map(placed).collect();
    format!(
        r#"<gdml><define>
<matrix name="WATER" coldim="2" values="1*eV 1.33 10*eV 1.33"/>
<matrix name="ZERO" coldim="2" values="1*eV 0 10*eV 0"/>
<matrix name="QUARTER" coldim="2" values="1*eV 0.25 10*eV 0.25"/>
<matrix name="PERCENT" coldim="2" values="1*eV 25 10*eV 25"/></define>
<materials><element name="H" Z="1"><atom value="1"/></element>
<material name="Liquid"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="WATER"/></material>
<material name="Black"><D value="1"/><fraction n="1" ref="H"/></material></materials>
<solids><box name="WorldBox" x="400" y="400" z="600" lunit="mm"/>
<box name="TankBox" x="100" y="100" z="300" lunit="mm"/><box name="SensorBox" x="50" y="50" z="2" lunit="mm"/>
<opticalsurface name="Paint" model="unified" finish="polished" type="dielectric_metal" value="1">
<property name="REFLECTIVITY" ref="ZERO"/></opticalsurface>
<opticalsurface name="Cathode" model="unified" finish="polished" type="dielectric_metal" value="1">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="QUARTER"/></opticalsurface></solids>
<structure><volume name="Tank"><materialref ref="Liquid"/><solidref ref="TankBox"/></volume>
<volume name="Sensor"><materialref ref="Black"/><solidref ref="SensorBox"/><auxiliary auxtype="SensDet" auxvalue="pmt"/></volume>
<volume name="World"><materialref ref="Black"/><solidref ref="WorldBox"/>
<physvol name="tank"><volumeref ref="Tank"/></physvol>{sensors}</volume>{links}</structure>
<setup name="Default" version="1.0"><world ref="World"/></setup></gdml>"#
    )
}

fn skin(name: &str, surface: &str, volume: &str) -> String {
    format!(
        r#"<skinsurface name="{name}" surfaceproperty="{surface}"><volumeref ref="{volume}"/></skinsurface>"#
    )
}

fn cathode(k: i32) -> String {
    format!(
        r#"<bordersurface name="c{k}" surfaceproperty="Cathode"><physvolref ref="tank"/><physvolref ref="s{k}"/></bordersurface>"#
    )
}

/// The number of hits of 4,000 photons from the middle of a tank, and the sensors with hits.
fn hits(text: &str) -> (usize, usize) {
    let detector = crate::detector(text).unwrap();
    let photons = rayweave_photon::Photon {
        position: rayweave_math::Vec3::ZERO,
        direction: rayweave_math::Vec3::new(0.1, 0.1, 1.0).normalize(),
        polarisation: rayweave_math::Vec3::new(1.0, -1.0, 0.0).normalize(),
        energy: 3e-6,
        time: 0.0,
    };
    let source = rayweave_photon::Source::Photons(vec![photons; 4000]);
    let run = crate::run(&detector, &source, &crate::settings(4000));
    (run.hits.len(), run.hits.paths().len())
}

/// The skin of the volume in front acts (`G4OpBoundaryProcess`: of siblings, the skin of the first volume comes first), so that the one
/// of the sensor does not.
#[test]
fn a_skin_that_another_one_covers_is_named() {
    let text = tank(&(skin("black", "Paint", "Tank") + &skin("cathode", "Cathode", "Sensor")));
    assert_eq!(hits(&text).0, 0);
    let all = findings(&text);
    let wanted = "skin surface `cathode` of volume `Sensor` detects nothing: light arrives from `Tank`, and the skin `black` of `Tank` acts instead";
    assert_eq!(all.len(), 1, "{all:#?}");
    let found = all[0].to_string();
    assert!(found.contains(wanted) && found.contains("border surface with `Cathode`"), "{found}");
    assert!(found.contains("make `Paint` the skin of their mother"), "{found}");
    // both remedies work: the skin of the mother, and borders
    let mother = tank(&(skin("black", "Paint", "World") + &skin("cathode", "Cathode", "Sensor")));
    let borders: String = (0..4).map(cathode).collect();
    for cured in [mother, tank(&(skin("black", "Paint", "Tank") + &borders))] {
        assert!(hits(&cured).0 > 900);
        assert_eq!(findings(&cured), []);
    }
}

/// The sensors are in clear liquid, where their skin acts on light from the world, but not on light from the tank.
#[test]
fn skins_are_judged_by_the_volumes_that_touch() {
    let clear = |links: &str| {
        tank(links).replace(r#""World"><materialref ref="Black"/>"#, r#""World"><materialref ref="Liquid"/>"#)
    };
    let skins = skin("black", "Paint", "Tank") + &skin("cathode", "Cathode", "Sensor");
    let all = findings(&clear(&skins));
    assert_eq!(hits(&clear(&skins)).0, 0);
    assert_eq!(all.len(), 1, "{all:#?}");
    assert!(!all[0].is_unused && all[0].place.is_some());
    let found = all[0].to_string();
    let wanted = "the skin `cathode` (EFFICIENCY) of volume `Sensor` does not act on light from `Tank`, which touches it: \
                  the skin `black` of `Tank` comes first";
    assert!(found.contains(wanted), "{found}");
    let advice = "Add a border surface with `Cathode` from `tank` to `s0`, `s1`, `s2` and 1 more.";
    assert!(found.contains(advice), "{found}");
    let borders: String = (0..4).map(cathode).collect();
    assert!(hits(&clear(&(skins.clone() + &borders))).0 > 900);
    assert_eq!(findings(&clear(&(skins + &borders))), []);
    // without the skin of the tank, that of the sensor acts
    let own = findings(&clear(&skin("cathode", "Cathode", "Sensor")));
    assert!(own.iter().all(|finding| finding.is_unused), "{own:#?}");
}

/// Interfaces that do not do what their properties suggest, each with the number of photons of 2,000 that end or pass as the
/// message states: they start in glass and meet the surface at 60 degrees, beyond the critical angle, or at 11 degrees.
#[test]
fn interfaces_without_the_properties_of_their_finish_are_named() {
    let surface = |finish: &str, properties: &str| {
        format!(
            r#"<opticalsurface name="S" model="unified" finish="{finish}" type="dielectric_dielectric" value="0">{properties}</opticalsurface>"#
        )
    };
    let about = |surfaces: &str| {
        let slab = SlabDetector { surfaces, links: SKIN, ..CLEAR };
        findings(&slab.text())
            .into_iter()
            .filter(|own| !own.is_unused)
            .map(|own| own.to_string())
            .collect::<Vec<_>>()
    };
    let ends = |surfaces: &str, direction: rayweave_math::Vec3, end: rayweave_photon::End| {
        let detector = SlabDetector { surfaces, links: SKIN, ..CLEAR }.build();
        let photon = rayweave_photon::Photon {
            position: rayweave_math::Vec3::new(0.0, 0.0, 50.0),
            direction: direction.normalize(),
            polarisation: rayweave_math::Vec3::Y,
            energy: 3e-6,
            time: 0.0,
        };
        let source = rayweave_photon::Source::Photons(vec![photon; 2000]);
        let run =
            crate::run(&detector, &source, &crate::RunSettings { max_steps: 1, ..crate::settings(2000) });
        crate::count(&run, end)
    };
    let steep = rayweave_math::Vec3::new(0.2, 0.0, 1.0);
    let (index, spike) =
        (r#"<property name="RINDEX" ref="ONE"/>"#, r#"<property name="SPECULARSPIKECONSTANT" ref="ONE"/>"#);
    let loss = r#"<property name="REFLECTIVITY" ref="HALF"/>"#;
    for finish in ["polishedbackpainted", "groundbackpainted"] {
        let closed = surface(finish, spike);
        let [one] = about(&closed).try_into().unwrap();
        assert!(one.contains("`S` has a back-painted finish and no `RINDEX`: all photons end"), "{one}");
        assert_eq!(ends(&closed, steep, rayweave_photon::End::NoIndex), 2000);
        assert_eq!(about(&surface(finish, &format!("{index}{spike}"))), Vec::<String>::new());
    }
    let [diffuse] = about(&surface("polishedbackpainted", &format!("{index}{loss}"))).try_into().unwrap();
    assert!(diffuse.contains("`S` is polished and reflects diffusely"), "{diffuse}");
    assert!(diffuse.ends_with("Add SPECULARSPIKECONSTANT, 1 for a polished face."), "{diffuse}");
    // rough faces are meant to be diffuse
    assert_eq!(about(&surface("groundbackpainted", &format!("{index}{loss}"))), Vec::<String>::new());
    let [bare] = about(&surface("polished", loss)).try_into().unwrap();
    assert!(bare.contains("`REFLECTIVITY` of optical surface `S` makes no reflector"), "{bare}");
    // a detector, paint and a surface that absorbs everything
    let efficiency = r#"<property name="EFFICIENCY" ref="HALF"/>"#;
    let black = r#"<property name="REFLECTIVITY" ref="ZERO"/>"#;
    let is_named = |surfaces: &str| about(surfaces).iter().any(|text| text.contains("makes no reflector"));
    assert!(!is_named(&surface("polished", &format!("{loss}{efficiency}"))));
    assert!(!is_named(&surface("polished", black)) && !is_named(&surface("groundfrontpainted", loss)));
}

/// A wrapped crystal that reaches to the face of its module: light leaves it into the world there, which is no sensor although
/// it contains one.
#[test]
fn a_world_around_sensors_is_no_sensor() {
    let text = |crystal: &str| {
        tank(&(skin("black", "Paint", "Tank") + &skin("cathode", "Cathode", "Sensor")))
            .replace(r#""World"><materialref ref="Black"/>"#, r#""World"><materialref ref="Liquid"/>"#)
            .replace(
                r#"<physvol name="tank"><volumeref ref="Tank"/></physvol>"#,
                r#"<physvol name="module"><volumeref ref="Module"/></physvol>"#,
            )
            .replace(
                r#"<volume name="World">"#,
                &format!(
                    r#"<volume name="Module"><materialref ref="Liquid"/><solidref ref="ModuleBox"/>
<physvol name="tank"><volumeref ref="Tank"/>{crystal}</physvol></volume><volume name="World">"#
                ),
            )
            .replace("<solids>", r#"<solids><box name="ModuleBox" x="120" y="120" z="300" lunit="mm"/>"#)
    };
    for crystal in ["", r#"<position name="m" x="30" unit="mm"/>"#] {
        let all = findings(&text(crystal));
        assert!(all.iter().all(|own| !own.to_string().contains("the sensor `World`")), "{all:#?}");
    }
}

/// A scintillator with paint on all faces, also on the one beside a light guide: in a clear world the sensor sees other light as well,
/// so that the guide is not its only way.
#[test]
fn painted_scintillators_without_a_way_out_are_named() {
    let glow = r#"<property name="RINDEX" ref="WATER"/><property name="SCINTILLATIONCOMPONENT1" ref="QUARTER"/>
<property name="RESOLUTIONSCALE" ref="YES"/></material>
<material name="Clear"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="WATER"/></material>"#;
    let text = |links: &str| {
        tank(&(skin("paint", "Paint", "Tank") + links))
            .replace(r#"<property name="RINDEX" ref="WATER"/></material>"#, glow)
            .replace("</define>", r#"<matrix name="YES" coldim="1" values="1"/></define>"#)
            .replace(r#""World"><materialref ref="Black"/>"#, r#""World"><materialref ref="Clear"/>"#)
            .replace(r#"z="151" "#, r#"z="161" "#)
            .replace("<solids>", r#"<solids><opticalsurface name="Bond" model="glisur" finish="polished" type="dielectric_dielectric" value="1"/>
<box name="GuideBox" x="100" y="100" z="10" lunit="mm"/>"#)
            .replace(r#"<volume name="Sensor">"#, r#"<volume name="Guide"><materialref ref="Clear"/><solidref ref="GuideBox"/></volume><volume name="Sensor">"#)
            .replace(r#"<physvol name="tank">"#, r#"<physvol name="guide"><volumeref ref="Guide"/><position name="g" z="155" unit="mm"/></physvol><physvol name="tank">"#)
    };
    let cathodes = skin("cathode", "Cathode", "Sensor");
    let mistakes = |text: &str| findings(text).into_iter().filter(|own| !own.is_unused).collect::<Vec<_>>();
    let [one] = mistakes(&text(&cathodes)).try_into().unwrap();
    assert!(
        one.to_string()
            .contains("skin surface `paint` of volume `Tank`, which emits light, lets no light out"),
        "{one}"
    );
    assert!(one.to_string().contains("Add a border surface from `tank` to"), "{one}");
    assert_eq!(hits(&text(&cathodes)).0, 0);
    let bond = r#"<bordersurface name="b" surfaceproperty="Bond"><physvolref ref="tank"/><physvolref ref="guide"/></bordersurface>
<bordersurface name="c" surfaceproperty="Bond"><physvolref ref="guide"/><physvolref ref="tank"/></bordersurface>"#;
    assert_eq!(mistakes(&text(&(cathodes.clone() + bond))), []);
    assert!(hits(&text(&(cathodes.clone() + bond))).0 > 500);
    // without emission the paint may be meant for light from outside
    let dark = text(&cathodes)
        .replace(r#"<property name="SCINTILLATIONCOMPONENT1" ref="QUARTER"/>"#, "")
        .replace(r#"<property name="RESOLUTIONSCALE" ref="YES"/>"#, "");
    assert_eq!(mistakes(&dark), []);
}

/// A chip that detects light from a crystal through a border surface absorbs that from the gap around it.
#[test]
fn chips_behind_borders_may_absorb_other_light() {
    let clear = |links: &str| {
        tank(links).replace(r#""World"><materialref ref="Black"/>"#, r#""World"><materialref ref="Liquid"/>"#)
    };
    let about = |links: &str| {
        let all = findings(&clear(links));
        all.iter().map(ToString::to_string).filter(|text| text.contains("has no `RINDEX`: photons")).count()
    };
    let borders: String = (0..4).map(cathode).collect();
    assert_eq!((about(&borders), about("")), (0, 1));
}

/// The borders of copies of a volume are one finding.
#[test]
fn borders_of_copies_are_one_finding() {
    let borders: String = (0..4).map(cathode).collect();
    let clear = tank(&(skin("wrap", "Paint", "Sensor") + &borders)).replace(
        r#"name="Sensor"><materialref ref="Black"/>"#,
        r#"name="Sensor"><materialref ref="Liquid"/>"#,
    );
    let all = findings(&clear);
    let texts: Vec<String> = all.iter().map(ToString::to_string).collect();
    let [one] = texts
        .into_iter()
        .filter(|text| text.contains("two optical surfaces"))
        .collect::<Vec<_>>()
        .try_into()
        .unwrap();
    assert!(
        one.contains("lie between placements `tank` and `s0`, and in 3 more places: border surface `c0` acts on light from \
                      `tank` to `s0`, skin surface `wrap`"),
        "{one}"
    );
}

#[test]
fn borders_of_unknown_placements_are_mistakes() {
    for (name, advice) in [
        ("tnak", "Did you mean `tank`?"),
        (
            "Tank",
            "`Tank` is a volume, and `physvolref` names a placement (`physvol`): those of the volume are `tank`.",
        ),
        ("grease", "the placements are `s0`, `s1`, `s2`, `s3`, `tank`."),
    ] {
        let border = format!(
            r#"<bordersurface name="c" surfaceproperty="Cathode"><physvolref ref="{name}"/><physvolref ref="s0"/></bordersurface>"#
        );
        let all = findings(&tank(&(skin("cathode", "Cathode", "Sensor") + &border)));
        let finding = all.iter().find(|finding| finding.to_string().contains("no placement named"));
        let finding = finding.unwrap_or_else(|| panic!("{all:#?}"));
        assert!(!finding.is_unused && finding.place.is_some(), "{finding:?}");
        assert!(finding.to_string().contains(&format!("`{name}`")), "{finding}");
        assert!(finding.to_string().ends_with(advice), "{finding}");
    }
}

#[test]
fn sensors_are_judged_by_placement() {
    let borders = |placed: &[i32]| {
        let borders: String = placed.iter().map(|&k| cathode(k)).collect();
        let all = findings(&tank(&(skin("black", "Paint", "Tank") + &borders)));
        all.iter()
            .map(ToString::to_string)
            .filter(|text| text.contains("with the sensor `pmt`"))
            .collect::<Vec<_>>()
    };
    assert_eq!(borders(&[0, 1, 2, 3]), Vec::<String>::new());
    let [one] = borders(&[0, 2, 3]).try_into().unwrap();
    assert!(one.contains("placement `s1` of volume `Sensor` with the sensor `pmt` detects nothing"), "{one}");
    assert!(one.contains("lies in front of it"), "{one}");
    let [two] = borders(&[0, 3]).try_into().unwrap();
    assert!(
        two.contains("placements `s1`, `s2` of volume `Sensor` with the sensor `pmt` detect nothing"),
        "{two}"
    );
    let [none] = borders(&[]).try_into().unwrap();
    assert!(none.contains("volume `Sensor` with the sensor `pmt` detects nothing"), "{none}");
}

/// A percentage gives one finding: the value, and nothing that follows from it.
#[test]
fn a_percentage_is_one_finding() {
    let borders: String = (0..4).map(cathode).collect();
    let text = tank(&(skin("black", "Paint", "Tank") + &borders));
    let all = findings(&text.replace(r#""EFFICIENCY" ref="QUARTER""#, r#""EFFICIENCY" ref="PERCENT""#));
    assert_eq!(all.len(), 1, "{all:#?}");
    assert!(all[0].to_string().contains("Are they percentages? Divide by 100."), "{all:#?}");
}

/// The numbers of sensors are those of the detector, whichever sensor is hit first.
#[test]
fn sensors_are_numbered_by_their_placements() {
    let borders: String = (0..4).map(cathode).collect();
    let detector = crate::detector(&tank(&(skin("black", "Paint", "Tank") + &borders))).unwrap();
    let sensors = |copies: [i64; 4]| copies.map(|copy| (format!("Sensor[{copy}]"), copy));
    assert_eq!(detector.sensor_paths(), sensors([0, 1, 2, 3]));
    // boxes of 50 mm by 50 mm by 2 mm
    for (k, extent) in (0..4).zip(detector.sensor_extents()) {
        let centre = rayweave_math::Vec3::new(
            25.0 * f64::from(2 * (k % 2) - 1),
            25.0 * f64::from(2 * (k / 2) - 1),
            151.0,
        );
        let (extent, half) = (extent.unwrap(), rayweave_math::Vec3::new(25.0, 25.0, 1.0));
        assert!((extent.lo - (centre - half)).length() < 1e-9, "{k}: {extent:?}");
        assert!((extent.hi - (centre + half)).length() < 1e-9, "{k}: {extent:?}");
    }
    let mut hits = {
        let photon = |x: f64, y: f64| rayweave_photon::Photon {
            position: rayweave_math::Vec3::new(x, y, 149.0),
            direction: rayweave_math::Vec3::Z,
            polarisation: rayweave_math::Vec3::X,
            energy: 3e-6,
            time: 0.0,
        };
        let photons = (0..400).map(|k| if k % 2 == 0 { photon(20.0, 20.0) } else { photon(-20.0, 20.0) });
        let source = rayweave_photon::Source::Photons(photons.collect());
        crate::run(&detector, &source, &crate::settings(400)).hits
    };
    let copies = |hits: &rayweave_photon::Hits| -> Vec<i64> {
        hits.sensor.iter().map(|&sensor| hits.copies()[sensor as usize]).collect()
    };
    let before = copies(&hits);
    assert!(before.contains(&3) && before.contains(&2) && hits.paths().len() == 2, "{before:?}");
    hits.number_by(&detector);
    assert_eq!(hits.paths(), [0, 1, 2, 3].map(|copy| format!("Sensor[{copy}]").into()));
    assert_eq!(copies(&hits), before);
    assert!(hits.sensor.iter().zip(before).all(|(&sensor, copy)| i64::from(sensor) == copy));
}

#[test]
fn numbers_in_ev_are_a_warning_of_the_detector() {
    let text = tank(&skin("cathode", "Cathode", "Sensor"));
    assert_eq!(crate::detector(&text).unwrap().warnings(), Vec::<String>::new());
    let detector = crate::detector(&text.replace("1*eV 1.33 10*eV 1.33", "1 1.33 10 1.33")).unwrap();
    let [warning] = detector.warnings() else { panic!("{:?}", detector.warnings()) };
    assert!(
        warning.contains("`RINDEX` of material `Liquid`") && warning.contains("look like eV"),
        "{warning}"
    );
}
