//! Closed cavities of all shapes of GDML: no photon leaves one, whatever its number of reflections.

use crate::{detector, settings};
use rayweave_photon::{
    BoundaryEvent, Detector, End, Origin, RunSettings, Source, SourceVolume, Torch, WavelengthDistribution,
    simulate,
};
use rayweave_trace::Packets;

/// A file with all solids of GDML, in several forms each.
const SOLIDS: &str = include_str!("../../../formats/tests/gdml/solids.gdml");

/// The part of a text between two others.
fn between<'t>(text: &'t str, from: &str, to: &str) -> &'t str {
    let (_, rest) = text.split_once(from).unwrap();
    rest.split_once(to).unwrap().0
}

/// The names of the solids, those of the boolean ones included.
fn names() -> Vec<&'static str> {
    let volumes = SOLIDS.split("<solidref ref=\"").skip(1).map(|rest| rest.split_once('"').unwrap().0);
    // references within boolean solids precede the structure
    let (solids, _) = SOLIDS.split_once("<structure>").unwrap();
    let inner = solids.matches("<solidref ref=\"").count();
    volumes.skip(inner).filter(|name| *name != "worldbox").collect()
}

/// A cavity with walls that reflect all light, in a world in which photons cannot move.
fn cavity(solid: &str, finish: &str) -> Detector {
    let (define, solids) =
        (between(SOLIDS, "<define>", "</define>"), between(SOLIDS, "<solids>", "</solids>"));
    detector(&format!(
        r#"<gdml><define>{define}<matrix name="ONE" coldim="2" values="1*eV 1 10*eV 1"/></define>
<materials><element name="H" Z="1"><atom value="1"/></element>
<material name="Gas"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="ONE"/></material>
<material name="Opaque"><D value="1"/><fraction n="1" ref="H"/></material></materials>
<solids>{solids}
<opticalsurface name="Mirror" model="unified" finish="{finish}" type="dielectric_metal" value="0.1"/></solids>
<structure><volume name="Cavity"><materialref ref="Gas"/><solidref ref="{solid}"/></volume>
<volume name="World"><materialref ref="Opaque"/><solidref ref="worldbox"/>
<physvol name="cavity"><volumeref ref="Cavity"/></physvol></volume>
<skinsurface name="skin" surfaceproperty="Mirror"><volumeref ref="Cavity"/></skinsurface></structure>
<setup name="Default" version="1.0"><world ref="World"/></setup></gdml>"#
    ))
    .unwrap()
}

/// Reflects photons `bounces` times each in all cavities, with mirrors and with diffuse walls; returns the number of reflections.
fn reflect(photons: u64, bounces: u32) -> u64 {
    let mut total = 0;
    for solid in names() {
        for (finish, event) in
            [("polished", BoundaryEvent::SpikeReflection), ("ground", BoundaryEvent::LambertianReflection)]
        {
            let what = format!("{solid}, {finish}");
            let detector = cavity(solid, finish);
            let evaluator = Packets::new(detector.program().clone());
            let volume = SourceVolume::inside(&detector, &evaluator, "Cavity").unwrap();
            let torch = Torch::new(Origin::Volume(volume), WavelengthDistribution::Single(500.0)).unwrap();
            let settings = RunSettings { max_steps: bounces, seed: 5, ..settings(photons as usize) };
            let run = simulate(&detector, &evaluator, &Source::Torch(torch), &settings).unwrap();
            assert_eq!(run.ends.get(&End::StepLimit), Some(&photons), "{what}: {:?}", run.ends);
            let reflections = photons * u64::from(bounces);
            assert_eq!(run.boundary_events.get(&event), Some(&reflections), "{what}");
            assert_eq!(run.steps, reflections, "{what}");
            total += reflections;
        }
    }
    total
}

#[test]
fn the_file_has_all_solids_of_gdml() {
    let (solids, _) = SOLIDS.split_once("</solids>").unwrap();
    let kinds = [
        "box",
        "tube",
        "cutTube",
        "cone",
        "polycone",
        "genericPolycone",
        "polyhedra",
        "genericPolyhedra",
        "sphere",
        "orb",
        "torus",
        "ellipsoid",
        "eltube",
        "elcone",
        "paraboloid",
        "hype",
        "para",
        "trd",
        "trap",
        "arb8",
        "tet",
        "xtru",
        "tessellated",
        "union",
        "subtraction",
        "intersection",
        "multiUnion",
        "scaledSolid",
    ];
    for kind in kinds {
        assert!(solids.contains(&format!("<{kind} ")), "{kind}");
    }
    assert!(names().len() > 50, "{:?}", names());
}

#[test]
fn no_photon_leaves_a_closed_cavity() {
    assert!(reflect(20, 50) > 100_000);
}

/// 1e8 reflections.
#[test]
#[ignore = "long"]
fn long_no_photon_leaves_a_closed_cavity() {
    let cases = 2 * names().len() as u64;
    assert!(reflect(100_000_000 / 1000 / cases + 1, 1000) >= 100_000_000);
}
