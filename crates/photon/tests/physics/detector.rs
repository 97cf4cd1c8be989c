//! Detectors from GDML: surfaces, properties, messages.

use crate::{CLEAR, SlabDetector, beam, count, detector, run, settings};
use rayweave_photon::{BoundaryEvent, End};

/// A border surface has priority over skins and holds in one direction only.
#[test]
fn border_surfaces_have_a_direction() {
    let mirror =
        r#"<opticalsurface name="S" model="glisur" finish="polished" type="dielectric_metal" value="1"/>"#;
    let linked = |first: &str, second: &str| {
        let links = format!(
            r#"<bordersurface name="b" surfaceproperty="S"><physvolref ref="{first}"/><physvolref ref="{second}"/></bordersurface>"#
        );
        let text = SlabDetector { surfaces: mirror, ..CLEAR }
            .text()
            .replace("</structure>", &format!("{links}</structure>"));
        // a tank around the slab, so that both sides of the border are placements
        let tank = r#"<volume name="Tank"><materialref ref="Outer"/><solidref ref="WorldBox"/>
<physvol name="slab"><volumeref ref="Slab"/><position name="p" z="50" unit="mm"/></physvol></volume>
<volume name="World"><materialref ref="Outer"/><solidref ref="Room"/><physvol name="tank"><volumeref ref="Tank"/></physvol></volume>"#;
        let (start, rest) = text.split_once(r#"<volume name="World">"#).unwrap();
        let (_, end) = rest.split_once("</volume>").unwrap();
        let room = r#"<box name="Room" x="3000" y="3000" z="3000" lunit="mm"/></solids>"#;
        detector(&format!("{start}{tank}{end}").replace("</solids>", room)).unwrap()
    };
    let light = beam(100, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    let reflected = |first, second| {
        let run = run(&linked(first, second), &light, &settings(100));
        run.boundary_events.get(&BoundaryEvent::SpikeReflection).copied().unwrap_or(0)
    };
    assert_eq!(reflected("tank", "slab"), 100);
    // from inside: those that entered the slab bounce between its two faces, without a way out
    assert!(reflected("slab", "tank") > 1000);
}

/// Volumes of equal material are different volumes: the skin of an inner one acts.
#[test]
fn surfaces_between_equal_materials_act() {
    let slab = SlabDetector {
        inner: r#"<property name="RINDEX" ref="ONE"/>"#,
        surfaces: r#"<opticalsurface name="S" model="unified" finish="polished" type="dielectric_metal" value="0">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="ONE"/></opticalsurface>"#,
        links: r#"<skinsurface name="skin" surfaceproperty="S"><volumeref ref="Slab"/></skinsurface>"#,
        ..CLEAR
    };
    let run = run(&slab.build(), &beam(100, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &settings(100));
    assert_eq!(count(&run, End::Detected), 100);
}

/// With skins on the mother and on its daughter, that of the daughter acts on what enters it.
#[test]
fn the_skin_of_a_daughter_has_priority() {
    let slab = SlabDetector {
        surfaces: r#"<opticalsurface name="Mirror" model="glisur" finish="polished" type="dielectric_metal" value="1"/>
<opticalsurface name="S" model="unified" finish="polished" type="dielectric_metal" value="0">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="ONE"/></opticalsurface>"#,
        links: r#"<skinsurface name="outer" surfaceproperty="Mirror"><volumeref ref="World"/></skinsurface>
<skinsurface name="inner" surfaceproperty="S"><volumeref ref="Slab"/></skinsurface>"#,
        ..CLEAR
    };
    let run = run(&slab.build(), &beam(100, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &settings(100));
    assert_eq!(count(&run, End::Detected), 100);
}

#[test]
fn unused_properties_and_surfaces_are_noted() {
    let slab = SlabDetector {
        inner: r#"<property name="RINDEX" ref="GLASS"/><property name="SCINTILLATIONYIELD" ref="ONE"/>"#,
        surfaces: r#"<opticalsurface name="Idle" model="glisur" finish="polished" type="dielectric_metal" value="1"/>"#,
        ..CLEAR
    };
    let notes = slab.build().notes().join("\n");
    assert!(notes.contains("material `Inner`: the property `SCINTILLATIONYIELD` is ignored"), "{notes}");
    assert!(notes.contains("optical surface `Idle` is ignored: it is attached to no volume."), "{notes}");
}

#[test]
fn all_bad_properties_are_reported_at_once() {
    let slab = SlabDetector {
        matrices: r#"<matrix name="BAD" coldim="2" values="1*eV -3 2*eV 1"/><matrix name="ROW" coldim="1" values="7"/>"#,
        outer: r#"<property name="RINDEX" ref="BAD"/>"#,
        inner: r#"<property name="RINDEX" ref="ROW"/><property name="ABSLENGTH" ref="BAD"/>"#,
        surfaces: r#"<opticalsurface name="S" model="lut" finish="polished" type="dielectric_metal" value="1"/>"#,
        ..CLEAR
    };
    let message = slab.try_build().unwrap_err().to_string();
    let lines: Vec<&str> = message.lines().collect();
    assert_eq!(lines.len(), 4, "{message}");
    assert!(lines[0].contains("`RINDEX` of material `Outer` is invalid: it has the value -3"), "{message}");
    assert!(lines[1].contains("`RINDEX` of material `Inner` is invalid: it has one column"), "{message}");
    assert!(
        lines[2].contains("`ABSLENGTH` of material `Inner` is invalid: it has the value -3"),
        "{message}"
    );
    assert!(lines[3].contains("the model `lut` of optical surface `S` is not supported"), "{message}");
}

#[test]
fn a_model_without_optical_properties_is_refused() {
    let (document, scene) =
        rayweave_scene::parse("rayweave = 1\n[solid.a]\nsphere = { radius = 1 }\n").unwrap();
    let message = rayweave_photon::Detector::new(&scene, &document).unwrap_err().to_string();
    assert!(message.contains("neither a table [photons] nor a table [gdml]. Use a GDML file"), "{message}");
}
