//! Detectors from GDML: surfaces, properties, messages.

use crate::{CLEAR, SlabDetector, beam, count, detector, imported, run, settings};
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

/// A large matrix that many materials use would take gigabytes.
#[test]
fn uses_of_matrices_are_counted() {
    let rows: String = (0..20_000).map(|k| format!("{}e-9 1.5 ", 1500 + k)).collect();
    let matrix = format!(r#"<matrix name="LONG" coldim="2" values="{rows}"/></define>"#);
    let material = |k: usize| {
        format!(
            r#"<material name="m{k}" Z="1"><property name="RINDEX" ref="LONG"/><D value="1"/><atom value="1"/></material>"#
        )
    };
    let with = |count: usize| {
        let materials: String = (0..count).map(material).collect();
        let text = CLEAR.text().replace("</define>", &matrix);
        detector(&text.replace("</materials>", &format!("{materials}</materials>"))).map(drop)
    };
    with(100).unwrap();
    let message = with(800).unwrap_err().to_string();
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(
        message.contains("`RINDEX` of material `m") && message.contains("more than 20000000 values"),
        "{message}"
    );
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
    assert_eq!(notes.matches("numbers of scintillation photons come from the source").count(), 1, "{notes}");
    assert!(!notes.contains("the property `SCINTILLATIONYIELD`"), "{notes}");
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

/// A box of glass between two sensors with a skin, in a native model: the sensors are listed in the order of the regions, whichever has
/// the first hit, and hits of a file have their numbers.
#[test]
fn sensors_of_native_models_are_in_the_order_of_their_regions() {
    let text = r#"
rayweave = 1
unit = "mm"
[solid.glass]
box = { size = 20 }
[solid.up]
box = { size = [20, 20, 1] }
transform = [{ translate = [0, 0, 10.5] }]
[solid.down]
box = { size = [20, 20, 1] }
transform = [{ translate = [0, 0, -10.5] }]
[[region]]
solid = "glass"
medium = "glass"
[[region]]
solid = "up"
medium = "silicon"
[[region]]
solid = "down"
medium = "silicon"
[medium.glass]
[medium.silicon]
[photons.medium.glass]
RINDEX = 1.5
[[photons.surface]]
name = "chip"
model = "unified"
finish = "polished"
type = "dielectric_metal"
skin = ["up", "down"]
REFLECTIVITY = 0
EFFICIENCY = 1
"#;
    let (document, scene) = rayweave_scene::parse(text).unwrap();
    let detector = rayweave_photon::Detector::new(&scene, &document).unwrap();
    let names: Vec<&str> = detector.sensor_paths().iter().map(|(path, _)| path.as_str()).collect();
    assert_eq!(names, ["up", "down"]);
    let folder = std::env::temp_dir().join(format!("rayweave-hits-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for (z, number) in [(1.0, 0), (-1.0, 1)] {
        let mut light = beam(10, [0.0, 0.0, z], [1.0, 0.0, 0.0]);
        if let rayweave_photon::Source::Photons(photons) = &mut light {
            photons.iter_mut().for_each(|photon| photon.position.z = 0.0);
        }
        let mut hits = run(&detector, &light, &settings(10)).hits;
        hits.number_by(&detector);
        assert_eq!(hits.sensor, [number; 10]);
        assert_eq!(hits.paths().iter().map(|path| &**path).collect::<Vec<_>>(), names);
        for ending in ["csv", "npy"] {
            let path = folder.join(format!("hits.{ending}"));
            let mut table = rayweave_photon::hit_table(&path, &detector, false).unwrap();
            table.write(&hits.to_rows().unwrap()).unwrap();
            table.finish().unwrap();
            assert_eq!(rayweave_photon::read_hits(&path, &detector).unwrap(), hits);
        }
    }
    std::fs::remove_dir_all(folder).unwrap();
}

/// A row of three slabs of 100 mm that touch, with a surface: photons start in the middle one, along z.
fn touching_slabs(links: &str) -> rayweave_photon::Detector {
    numbered_slabs(links, [4, 5, 6])
}

/// The same with other copy numbers of the placements `copy4`, `copy5` and `copy6`.
fn numbered_slabs(links: &str, numbers: [i32; 3]) -> rayweave_photon::Detector {
    let copy = |name: i32, number: i32, z: i32| {
        format!(
            r#"<physvol name="copy{name}" copynumber="{number}"><volumeref ref="Slab"/><position name="p{name}" z="{z}" unit="mm"/></physvol>"#
        )
    };
    let copies = format!("{}{}</volume>", copy(4, numbers[0], -50), copy(6, numbers[2], 150));
    let surfaces =
        r#"<opticalsurface name="S" model="glisur" finish="polished" type="dielectric_metal" value="1"/>"#;
    let text = SlabDetector { surfaces, links, ..CLEAR }.text();
    let middle = format!(r#"<physvol name="copy5" copynumber="{}">"#, numbers[1]);
    let text = text.replace(r#"<physvol name="slab">"#, &middle);
    detector(&text.replace(r#"unit="mm"/></physvol></volume>"#, &format!(r#"unit="mm"/></physvol>{copies}"#)))
        .unwrap()
}

/// The numbers of reflections and of passages at the inner faces of photons that start in the middle slab.
fn at_inner_faces(detector: &rayweave_photon::Detector) -> [u64; 2] {
    let mut light = beam(100, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    if let rayweave_photon::Source::Photons(photons) = &mut light {
        photons.iter_mut().for_each(|photon| photon.position.z = 50.0);
    }
    let run = run(detector, &light, &rayweave_photon::RunSettings { max_steps: 1, ..settings(100) });
    [BoundaryEvent::SpikeReflection, BoundaryEvent::SameMaterial]
        .map(|event| run.boundary_events.get(&event).copied().unwrap_or(0))
}

/// The skin of a volume acts where two of its copies touch, as in Geant4, and a border in its direction.
#[test]
fn surfaces_between_touching_copies_act() {
    let skin = r#"<skinsurface name="skin" surfaceproperty="S"><volumeref ref="Slab"/></skinsurface>"#;
    assert_eq!(at_inner_faces(&touching_slabs(skin)), [100, 0]);
    let border = |first: &str, second: &str| {
        format!(
            r#"<bordersurface name="b" surfaceproperty="S"><physvolref ref="{first}"/><physvolref ref="{second}"/></bordersurface>"#
        )
    };
    assert_eq!(at_inner_faces(&touching_slabs(&border("copy5", "copy6"))), [100, 0]);
    // the way back, and the other neighbour: the photons pass
    assert_eq!(at_inner_faces(&touching_slabs(&border("copy6", "copy5"))), [0, 100]);
    assert_eq!(at_inner_faces(&touching_slabs(&border("copy5", "copy4"))), [0, 100]);
    // a border is between placements, whatever their copy numbers
    for numbers in [[5, 5, 5], [0, 0, 0], [5, 5, 4], [4, 5, 5]] {
        let reflected = |first, second| at_inner_faces(&numbered_slabs(&border(first, second), numbers));
        assert_eq!(reflected("copy5", "copy6"), [100, 0], "{numbers:?}");
        assert_eq!(reflected("copy6", "copy5"), [0, 100], "{numbers:?}");
        assert_eq!(reflected("copy5", "copy4"), [0, 100], "{numbers:?}");
        assert_eq!(reflected("copy4", "copy5"), [0, 100], "{numbers:?}");
    }
    // without a surface copies of one volume count as one: no boundary between them
    assert_eq!(at_inner_faces(&touching_slabs("")), [0, 0]);
}

/// A border around one of two placements of a volume acts there alone: in one mother with equal copy numbers, and in two mothers, where
/// neither has a number. Two boxes of 100 mm lie above and below the source.
#[test]
fn a_border_acts_on_one_placement() {
    let detects = r#"<opticalsurface name="S" model="unified" finish="polished" type="dielectric_metal" value="1">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="ONE"/></opticalsurface>"#;
    let inner = r#"<property name="RINDEX" ref="ONE"/>"#;
    let placed = |name: &str, number: &str, volume: &str, z: i32| {
        format!(
            r#"<physvol name="{name}" {number}><volumeref ref="{volume}"/><position name="{name}_at" z="{z}" unit="mm"/></physvol>"#
        )
    };
    let own =
        r#"<physvol name="slab"><volumeref ref="Slab"/><position name="p" z="50" unit="mm"/></physvol>"#;
    let shell = |name: &str, inner: &str| {
        format!(r#"<volume name="{name}"><materialref ref="Outer"/><solidref ref="Shell"/>{inner}</volume>"#)
    };
    for number in ["", r#"copynumber="0""#, r#"copynumber="7""#] {
        let in_one = placed("above", number, "Slab", 50) + &placed("below", number, "Slab", -150);
        let shells = shell("Upper", &placed("above", number, "Slab", 0))
            + &shell("Lower", &placed("below", number, "Slab", 0));
        let in_two = placed("upper", "", "Upper", 60) + &placed("lower", "", "Lower", -160);
        for (shells, placements, mothers) in
            [(String::new(), in_one, ["tank", "tank"]), (shells, in_two, ["upper", "lower"])]
        {
            for (place, mother, up, down) in [("above", mothers[0], 100, 0), ("below", mothers[1], 0, 100)] {
                let links = format!(
                    r#"<volume name="Room"><materialref ref="Outer"/><solidref ref="RoomBox"/>
<physvol name="tank"><volumeref ref="World"/></physvol></volume>
<bordersurface name="b" surfaceproperty="S"><physvolref ref="{mother}"/><physvolref ref="{place}"/></bordersurface>"#
                );
                let text = SlabDetector { surfaces: detects, links: &links, inner, ..CLEAR }.text();
                let boxes = r#"<box name="RoomBox" x="3000" y="3000" z="3000" lunit="mm"/>
<box name="Shell" x="1010" y="1010" z="110" lunit="mm"/></solids>"#;
                let text = text.replace("</solids>", boxes).replace(own, &placements);
                let text = text.replace(r#"<world ref="World"/>"#, r#"<world ref="Room"/>"#);
                let text =
                    text.replace(r#"<volume name="World">"#, &format!(r#"{shells}<volume name="World">"#));
                let detector = detector(&text).unwrap();
                let detected = |z: f64| {
                    let run = run(&detector, &beam(100, [0.0, 0.0, z], [1.0, 0.0, 0.0]), &settings(100));
                    count(&run, End::Detected)
                };
                assert_eq!([detected(1.0), detected(-1.0)], [up, down], "{number} {mother} {place}");
            }
        }
    }
}

/// A border between two volumes in one of two mothers acts there alone: both mothers have placements with equal volumes and copy
/// numbers. A film of 10 mm lies on a slab of 40 mm in a room above and in one below the source.
#[test]
fn a_border_acts_in_one_mother() {
    let placed = |name: &str, volume: &str, z: f64| {
        format!(
            r#"<physvol name="{name}"><volumeref ref="{volume}"/><position name="{name}_at" z="{z}" unit="mm"/></physvol>"#
        )
    };
    let volume = |name: &str, material: &str, solid: &str, inner: &str| {
        format!(
            r#"<volume name="{name}"><materialref ref="{material}"/><solidref ref="{solid}"/>{inner}</volume>"#
        )
    };
    let own =
        r#"<physvol name="slab"><volumeref ref="Slab"/><position name="p" z="50" unit="mm"/></physvol>"#;
    for (place, up, down) in [("u", 100, 0), ("l", 0, 100)] {
        let rooms: String = [("Upper", "u", 1.0), ("Lower", "l", -1.0)]
            .map(|(name, place, sign)| {
                let film = placed(&format!("{place}_film"), "Film", -20.0 * sign);
                let plate = placed(&format!("{place}_plate"), "Plate", 5.0 * sign);
                volume(name, "Outer", "Shell", &(film + &plate))
            })
            .concat();
        let inner = volume("Film", "Inner", "FilmBox", "") + &volume("Plate", "Outer", "PlateBox", "");
        let links = format!(
            r#"<bordersurface name="b" surfaceproperty="S"><physvolref ref="{place}_film"/><physvolref ref="{place}_plate"/></bordersurface>"#
        );
        let text = SlabDetector {
            surfaces: r#"<opticalsurface name="S" model="unified" finish="polished" type="dielectric_metal" value="1">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="ONE"/></opticalsurface>"#,
            links: &links,
            inner: r#"<property name="RINDEX" ref="ONE"/>"#,
            ..CLEAR
        };
        let boxes = r#"<box name="Shell" x="500" y="500" z="60" lunit="mm"/>
<box name="FilmBox" x="400" y="400" z="10" lunit="mm"/><box name="PlateBox" x="400" y="400" z="40" lunit="mm"/></solids>"#;
        let both = placed("upper", "Upper", 50.0) + &placed("lower", "Lower", -70.0);
        let text = text.text().replace("</solids>", boxes).replace(own, &both);
        let text =
            text.replace(r#"<volume name="World">"#, &format!(r#"{inner}{rooms}<volume name="World">"#));
        let detector = detector(&text).unwrap();
        let detected = |z: f64| {
            let run = run(&detector, &beam(100, [0.0, 0.0, z], [1.0, 0.0, 0.0]), &settings(100));
            count(&run, End::Detected)
        };
        assert_eq!([detected(1.0), detected(-1.0)], [up, down], "{place}");
    }
}

/// Hits in touching sensors have the path of their copy, and the volume is listed once.
#[test]
fn touching_sensors_keep_their_copies() {
    let links = r#"<skinsurface name="skin" surfaceproperty="S"><volumeref ref="Slab"/></skinsurface>"#;
    let copy = r#"<physvol name="next" copynumber="6"><volumeref ref="Slab"/><position name="q" z="150" unit="mm"/></physvol></volume>"#;
    let text = SlabDetector {
        surfaces: r#"<opticalsurface name="S" model="unified" finish="polished" type="dielectric_metal" value="0">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="ONE"/></opticalsurface>"#,
        links,
        auxiliary: r#"<auxiliary auxtype="SensDet" auxvalue="Counter"/>"#,
        ..CLEAR
    };
    let text = text.text().replace(r#"<physvol name="slab">"#, r#"<physvol name="slab" copynumber="5">"#);
    let text = text.replace(r#"unit="mm"/></physvol></volume>"#, &format!(r#"unit="mm"/></physvol>{copy}"#));
    let detector = detector(&text).unwrap();
    assert_eq!(detector.sensors().collect::<Vec<_>>(), [("Slab", "Counter")]);
    let mut light = beam(100, [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]);
    if let rayweave_photon::Source::Photons(photons) = &mut light {
        photons.iter_mut().for_each(|photon| photon.position.z = 50.0);
    }
    let hits = run(&detector, &light, &settings(100)).hits;
    assert_eq!((hits.len(), hits.paths(), hits.copies()), (100, &["Slab[6]".into()][..], &[6][..]));
    assert!(hits.position[2].iter().all(|z| (z - 100.0).abs() < 1e-12));
}

/// A border with a name of two placements acts on the first one in the file, as `G4PhysicalVolumeStore::GetVolume` finds it.
#[test]
fn a_border_acts_on_the_first_placement_of_its_name() {
    let detects = r#"<opticalsurface name="S" model="unified" finish="polished" type="dielectric_metal" value="1">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="ONE"/></opticalsurface>"#;
    let links = r#"<bordersurface name="b" surfaceproperty="S"><physvolref ref="world"/><physvolref ref="slab"/></bordersurface>"#;
    let room = r#"<volume name="Room"><materialref ref="Outer"/><solidref ref="RoomBox"/>
<physvol name="world"><volumeref ref="World"/></physvol></volume>"#;
    // without reflection, which would lead photons from one placement to the other
    let inner = r#"<property name="RINDEX" ref="ONE"/>"#;
    let text = SlabDetector { surfaces: detects, links, inner, ..CLEAR }.text();
    let text =
        text.replace("</solids>", r#"<box name="RoomBox" x="3000" y="3000" z="3000" lunit="mm"/></solids>"#);
    let text = text.replace(r#"<world ref="World"/>"#, r#"<world ref="Room"/>"#);
    let text = text.replace("<bordersurface", &format!("{room}<bordersurface"));
    // the other placement of the name lies below the source; copy numbers do not matter
    let other = |number: i32| {
        format!(
            r#"<physvol name="slab" copynumber="{number}"><volumeref ref="Slab"/><position name="q" z="-150" unit="mm"/></physvol>"#
        )
    };
    let own =
        r#"<physvol name="slab"><volumeref ref="Slab"/><position name="p" z="50" unit="mm"/></physvol>"#;
    let own_numbered = own.replace(r#"name="slab">"#, r#"name="slab" copynumber="7">"#);
    for (placements, up, down) in [
        (format!("{own_numbered}{}", other(3)), 100, 0),
        (format!("{}{own_numbered}", other(3)), 0, 100),
        // different names, a border on one of them
        (format!("{own_numbered}{}", other(3).replace(r#"name="slab""#, r#"name="below""#)), 100, 0),
    ] {
        let text = text.replace(own, &placements);
        let detector = detector(&text).unwrap();
        let detected = |z: f64| {
            let run = run(&detector, &beam(100, [0.0, 0.0, z], [1.0, 0.0, 0.0]), &settings(100));
            count(&run, End::Detected)
        };
        assert_eq!([detected(1.0), detected(-1.0)], [up, down], "{placements}");
        let findings = crate::lint::findings(&text);
        let found = findings.iter().find(|finding| finding.to_string().contains("named `slab`"));
        match placements.contains("below") {
            true => assert!(found.is_none(), "{findings:#?}"),
            false => {
                let finding = found.unwrap();
                assert!(finding.to_string().contains(
                    "border surface `b` acts on one of 2 placements named `slab`: it finds the first one in the file, that of volume \
                     `Slab` in `World`, as in Geant4. Give the placements different names and each a border surface, or make the \
                     surface the skin of `Slab`."
                ), "{finding}");
                assert!(finding.place.is_some());
                assert!(detector.warnings().iter().any(|note| note.contains("named `slab`")));
            }
        }
    }
}

/// A row of replicas with solids of different sizes is one placement, to which a border applies as a whole.
#[test]
fn replicas_of_different_sizes_are_one_placement() {
    let (scene, document) = imported(
        r#"<gdml><define><matrix name="ONE" coldim="2" values="1*eV 1 10*eV 1"/></define>
<materials><material name="M" Z="1"><D value="1"/><atom value="1"/><property name="RINDEX" ref="ONE"/></material></materials>
<solids><tube name="T" rmax="30" z="10" deltaphi="360" aunit="deg" lunit="mm"/>
<tube name="R" rmin="0" rmax="10" z="10" deltaphi="360" aunit="deg" lunit="mm"/><box name="B" x="100" y="100" z="100" lunit="mm"/>
<opticalsurface name="S" model="unified" finish="polished" type="dielectric_metal" value="1">
<property name="EFFICIENCY" ref="ONE"/></opticalsurface></solids>
<structure><volume name="Ring"><materialref ref="M"/><solidref ref="R"/></volume>
<volume name="Disc"><materialref ref="M"/><solidref ref="T"/><replicavol name="rings" number="3"><volumeref ref="Ring"/>
<replicate_along_axis><direction rho="1"/><width value="10" unit="mm"/><offset value="0" unit="mm"/></replicate_along_axis></replicavol></volume>
<volume name="World"><materialref ref="M"/><solidref ref="B"/><physvol name="disc"><volumeref ref="Disc"/></physvol></volume>
<bordersurface name="b" surfaceproperty="S"><physvolref ref="disc"/><physvolref ref="rings"/></bordersurface></structure>
<setup name="Default" version="1.0"><world ref="World"/></setup></gdml>"#,
    );
    let detector = rayweave_photon::Detector::new(&scene, &document).unwrap();
    assert!(detector.notes().is_empty(), "{:?}", detector.notes());
    assert_eq!(detector.sensor_paths().len(), 3, "{:?}", detector.sensor_paths());
}

/// Sensors are the volumes that light enters through a skin with an efficiency, not those around them.
#[test]
fn the_mother_of_a_sensor_is_none() {
    let skin = r#"<skinsurface name="skin" surfaceproperty="S"><volumeref ref="Slab"/></skinsurface>"#;
    let surfaces = r#"<opticalsurface name="S" model="unified" finish="polished" type="dielectric_metal" value="1">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="ONE"/></opticalsurface>"#;
    let names = |slab: SlabDetector<'_>| -> Vec<String> {
        detector(&slab.text()).unwrap().sensor_paths().iter().map(|(path, _)| path.clone()).collect()
    };
    let slab = SlabDetector { surfaces, links: skin, ..CLEAR };
    assert_eq!(names(slab), ["Slab"]);
    // light of the slab itself is detected where it leaves
    let inner =
        r#"<property name="RINDEX" ref="GLASS"/><property name="SCINTILLATIONCOMPONENT1" ref="HALF"/>"#;
    assert_eq!(names(SlabDetector { inner, ..slab }), ["Slab", "World"]);
    // light comes only from the slab
    assert_eq!(names(SlabDetector { outer: "", ..slab }), ["World"]);
    // a skin that lets light in
    let passing = surfaces.replace("dielectric_metal", "dielectric_dielectric").replace("ZERO", "HALF");
    assert_eq!(names(SlabDetector { surfaces: &passing, ..slab }), ["Slab", "World"]);
}
