//! Volumes without a skin that the skin of another volume closes: Geant4's order of skins (`G4OpBoundaryProcess`: on entering a daughter
//! its skin, then that of its mother; otherwise that of the volume in front, then that of the one behind).

use crate::lint::findings;
use rayweave_math::Vec3;
use rayweave_photon::{RunSettings, Source, Torch};

/// A wrapped tank of liquid in steel with two phototubes, bulbs of glass with a cathode in each. `links` are the border and
/// skin surfaces. With `sensitive`, the tag of the bulb, the bulbs are the sensors and have no cathodes.
fn tank(links: &str, sensitive: &str) -> String {
    let cathode = match sensitive {
        "" => r#"<physvol name="cathode"><volumeref ref="Cathode"/></physvol>"#,
        _ => "",
    };
    format!(
        r#"<gdml><define>
<matrix name="LIQUID" coldim="2" values="1*eV 1.48 10*eV 1.48"/><matrix name="GLASS" coldim="2" values="1*eV 1.47 10*eV 1.47"/>
<matrix name="WHITE" coldim="2" values="1*eV 0.9 10*eV 0.9"/><matrix name="ZERO" coldim="2" values="1*eV 0 10*eV 0"/>
<matrix name="QE" coldim="2" values="1*eV 0.25 10*eV 0.25"/></define>
<materials><element name="H" Z="1"><atom value="1"/></element>
<material name="Liquid"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="LIQUID"/></material>
<material name="Glass"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="GLASS"/></material>
<material name="Steel"><D value="1"/><fraction n="1" ref="H"/></material></materials>
<solids><box name="WorldBox" x="400" y="400" z="400" lunit="mm"/><box name="ShellBox" x="220" y="220" z="220" lunit="mm"/>
<box name="TankBox" x="200" y="200" z="200" lunit="mm"/><orb name="Bulb" r="30" lunit="mm"/><orb name="Inside" r="28" lunit="mm"/>
<opticalsurface name="Paint" model="unified" finish="groundfrontpainted" type="dielectric_dielectric" value="0">
<property name="REFLECTIVITY" ref="WHITE"/></opticalsurface>
<opticalsurface name="Foil" model="unified" finish="polished" type="dielectric_metal" value="0">
<property name="REFLECTIVITY" ref="WHITE"/></opticalsurface>
<opticalsurface name="Photocathode" model="unified" finish="polished" type="dielectric_metal" value="0">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="QE"/></opticalsurface>
<opticalsurface name="Bare" model="glisur" finish="polished" type="dielectric_dielectric" value="1"/></solids>
<structure><volume name="Cathode"><materialref ref="Steel"/><solidref ref="Inside"/><auxiliary auxtype="SensDet" auxvalue="pmt"/></volume>
<volume name="Pmt"><materialref ref="Glass"/><solidref ref="Bulb"/>{sensitive}{cathode}</volume>
<volume name="Tank"><materialref ref="Liquid"/><solidref ref="TankBox"/>
<physvol name="left"><volumeref ref="Pmt"/><position name="p" x="-60" unit="mm"/></physvol>
<physvol name="right"><volumeref ref="Pmt"/><position name="q" x="60" unit="mm"/></physvol></volume>
<volume name="Shell"><materialref ref="Steel"/><solidref ref="ShellBox"/>
<physvol name="tank"><volumeref ref="Tank"/></physvol></volume>
<volume name="World"><materialref ref="Steel"/><solidref ref="WorldBox"/>
<physvol name="shell"><volumeref ref="Shell"/></physvol></volume>{links}</structure>
<setup name="Default" version="1.0"><world ref="World"/></setup></gdml>"#
    )
}

fn skin(name: &str, surface: &str, volume: &str) -> String {
    format!(
        r#"<skinsurface name="{name}" surfaceproperty="{surface}"><volumeref ref="{volume}"/></skinsurface>"#
    )
}

fn border(first: &str, second: &str) -> String {
    format!(
        r#"<bordersurface name="b{first}{second}" surfaceproperty="Bare"><physvolref ref="{first}"/><physvolref ref="{second}"/></bordersurface>"#
    )
}

/// The number of hits of 2,000 isotropic photons from the middle of the tank.
fn hits(text: &str) -> usize {
    hits_of(text, 2000)
}

/// The number of hits of isotropic photons from the middle of the tank.
fn hits_of(text: &str, photons: u64) -> usize {
    let detector = crate::detector(text).unwrap();
    let source = Source::Torch(Torch::point(Vec3::ZERO, 420.0).unwrap());
    crate::run(&detector, &source, &RunSettings::new(0..photons)).hits.len()
}

/// The findings about skins that close volumes.
fn closed(text: &str) -> Vec<String> {
    let all = findings(text).into_iter().filter(|finding| !finding.is_unused);
    all.map(|finding| finding.to_string()).filter(|text| text.contains("lets no light")).collect()
}

#[test]
fn a_skin_around_phototubes_closes_them() {
    let cathode = skin("photo", "Photocathode", "Cathode");
    for paint in ["Paint", "Foil"] {
        let text = tank(&(skin("wrap", paint, "Tank") + &cathode), "");
        assert_eq!(hits(&text), 0);
        let [one] = closed(&text).try_into().unwrap();
        let problem = "skin surface `wrap` of volume `Tank` lets no light from it into its daughter `Pmt`, which contains a sensor";
        assert!(one.contains(problem), "{one}");
        assert!(one.contains(&format!("nothing passes `{paint}`")), "{one}");
        // the remedies that the message names, and borders of all placements
        let shell = skin("wrap", paint, "Shell");
        let bare = skin("wrap", paint, "Tank") + &skin("glass", "Bare", "Pmt");
        let borders = skin("wrap", paint, "Tank") + &border("tank", "left") + &border("tank", "right");
        for cured in [shell, bare, borders] {
            let text = tank(&(cured.clone() + &cathode), "");
            assert!(hits(&text) > 100, "{cured}: {}", hits(&text));
            assert_eq!(closed(&text), Vec::<String>::new(), "{cured}");
        }
        // a border to one of two placements
        let one = skin("wrap", paint, "Tank") + &border("tank", "left");
        let [one] = closed(&tank(&(one + &cathode), "")).try_into().unwrap();
        assert!(one.contains("the skin of its mother acts at the placements `right` as well"), "{one}");
    }
}

/// A foil that transmits at most a tenth of the light counts as closed.
#[test]
fn a_foil_that_transmits_little_closes_phototubes() {
    for (transmittance, is_closed) in [(0.01, true), (0.1, true), (0.11, false)] {
        let matrix = format!(
            r#"<matrix name="T" coldim="2" values="1*eV {transmittance} 10*eV {transmittance}"/></define>"#
        );
        let reflectivity = r#"type="dielectric_metal" value="0">
<property name="REFLECTIVITY" ref="WHITE"/>"#;
        let text = tank(&(skin("wrap", "Foil", "Tank") + &skin("photo", "Photocathode", "Cathode")), "")
            .replace("</define>", &matrix)
            .replace("\"1*eV 0.9 10*eV 0.9\"", "\"1*eV 0.8 10*eV 0.8\"")
            .replace(reflectivity, &format!(r#"{reflectivity}<property name="TRANSMITTANCE" ref="T"/>"#));
        // at a transmittance of 0.01 about one photon in a thousand is detected
        assert!(hits_of(&text, 20_000) > 0);
        let all: Vec<String> = findings(&text).iter().map(ToString::to_string).collect();
        let problem =
            "skin surface `wrap` of volume `Tank` lets hardly any light from it into its daughter `Pmt`";
        let reason = format!("the `TRANSMITTANCE` of `Foil` is at most {transmittance}");
        let found = all.iter().filter(|text| text.contains(problem) && text.contains(&reason)).count();
        assert_eq!(found, usize::from(is_closed), "{all:#?}");
    }
}

/// A sensitive bulb with an index, whose photons are detected as they enter.
#[test]
fn a_skin_closes_sensitive_daughters() {
    let sensitive = r#"<auxiliary auxtype="SensDet" auxvalue="pmt"/>"#;
    for paint in ["Paint", "Foil"] {
        let text = tank(&skin("wrap", paint, "Tank"), sensitive);
        assert_eq!(hits(&text), 0);
        assert_eq!(closed(&text).len(), 1);
    }
    let cured = tank(&skin("wrap", "Paint", "Shell"), sensitive);
    assert!(hits(&cured) > 100);
    assert_eq!(closed(&cured), Vec::<String>::new());
    // the skin of the mother detects: the bulbs are its sensors
    let detecting = tank(&skin("wrap", "Photocathode", "Tank"), sensitive);
    assert!(hits(&detecting) > 100);
    assert_eq!(closed(&detecting), Vec::<String>::new());
    // a skin that transmits closes nothing
    let bare = tank(&skin("wrap", "Bare", "Tank"), sensitive);
    assert!(hits(&bare) > 100);
    assert_eq!(closed(&bare), Vec::<String>::new());
}

/// A wrapped crystal that touches a sensitive window with an index, beside it in the world.
#[test]
fn a_skin_closes_a_sensor_beside_it() {
    let text = |links: &str| {
        let window = r#"<volume name="Window"><materialref ref="Glass"/><solidref ref="TankBox"/><auxiliary auxtype="SensDet" auxvalue="w"/></volume><volume name="Shell">"#;
        let placed = r#"<physvol name="window"><volumeref ref="Window"/><position name="w" z="200" unit="mm"/></physvol><physvol name="tank">"#;
        let text = tank(links, "").replace(r#"<volume name="Shell">"#, window);
        let text = text
            .replace(r#"<physvol name="tank">"#, placed)
            .replace(r#""ShellBox" x="220" y="220" z="220""#, r#""ShellBox" x="220" y="220" z="640""#);
        text.replace(r#""WorldBox" x="400" y="400" z="400""#, r#""WorldBox" x="400" y="400" z="800""#)
    };
    let links = skin("wrap", "Paint", "Tank") + &skin("glass", "Bare", "Pmt");
    assert_eq!(hits(&text(&links)), 0);
    let [one] = closed(&text(&links)).try_into().unwrap();
    let problem = "skin surface `wrap` of volume `Tank` lets no light from it into the sensor `Window`, which it touches";
    assert!(one.contains(problem) && one.contains("from `tank` to `window`"), "{one}");
    let cured = text(&(links + &border("tank", "window")));
    assert!(hits(&cured) > 100);
    assert_eq!(closed(&cured), Vec::<String>::new());
}

/// A wrapped crystal, a layer of grease on it and an opaque sensor with a photocathode behind the grease: beside each other.
#[test]
fn a_skin_closes_the_window_of_a_sensor() {
    let text = |links: &str| {
        let volumes = r#"<volume name="Grease"><materialref ref="Glass"/><solidref ref="Plate"/></volume>
<volume name="Diode"><materialref ref="Steel"/><solidref ref="Plate"/><auxiliary auxtype="SensDet" auxvalue="d"/></volume>
<volume name="Shell">"#;
        let placed = |name: &str, volume: &str, z: u32| {
            format!(
                r#"<physvol name="{name}"><volumeref ref="{volume}"/><position name="{name}At" z="{z}" unit="mm"/></physvol>"#
            )
        };
        let placed =
            placed("grease", "Grease", 101) + &placed("diode", "Diode", 103) + r#"<physvol name="tank">"#;
        tank(links, "")
            .replace(r#"<volume name="Shell">"#, volumes)
            .replace(r#"<physvol name="tank">"#, &placed)
            .replace(
                "<orb name=\"Bulb\"",
                "<box name=\"Plate\" x=\"200\" y=\"200\" z=\"2\" lunit=\"mm\"/><orb name=\"Bulb\"",
            )
    };
    let links = skin("wrap", "Paint", "Tank")
        + &skin("glass", "Bare", "Pmt")
        + &skin("diode", "Photocathode", "Diode");
    assert_eq!(hits(&text(&links)), 0);
    let [one] = closed(&text(&links)).try_into().unwrap();
    let problem =
        "lets no light from it into `Grease`, which it touches, the only way of light to the sensor `Diode`";
    assert!(one.contains(problem) && one.contains("from `tank` to `grease`"), "{one}");
    let cured = text(&(links + &border("tank", "grease")));
    assert!(hits(&cured) > 100);
    assert_eq!(closed(&cured), Vec::<String>::new());
}
