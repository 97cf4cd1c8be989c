//! Volumes that touch a neighbour of their mother: a bar in a box of air, flush with it, between two copies of a sensor. The faces of
//! bar, box and sensor are crossed at times that differ by rounding, so that those of a crossing may belong to any of them.

use rayweave_math::Vec3;
use rayweave_photon::{End, Photon, PhotonRun, RunSettings, Source};

/// `links` are the border and skin surfaces.
fn bar(links: &str) -> String {
    format!(
        r#"<gdml><define>
<matrix name="BAR" coldim="2" values="1*eV 1.59 10*eV 1.59"/><matrix name="AIR" coldim="2" values="1*eV 1 10*eV 1"/>
<matrix name="ZERO" coldim="2" values="1*eV 0 10*eV 0"/></define>
<materials><element name="H" Z="1"><atom value="1"/></element>
<material name="Plastic"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="BAR"/></material>
<material name="Air"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="AIR"/></material>
<material name="Silicon"><D value="1"/><fraction n="1" ref="H"/></material></materials>
<solids><box name="WorldBox" x="200" y="200" z="200" lunit="mm"/><box name="AirBox" x="60" y="10" z="10" lunit="mm"/>
<box name="CoreBox" x="60" y="2" z="2" lunit="mm"/><box name="SensorBox" x="1" y="2" z="2" lunit="mm"/>
<opticalsurface name="Cathode" model="glisur" finish="polished" type="dielectric_metal" value="1">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="AIR"/></opticalsurface></solids>
<structure><volume name="Core"><materialref ref="Plastic"/><solidref ref="CoreBox"/></volume>
<volume name="Sensor"><materialref ref="Silicon"/><solidref ref="SensorBox"/></volume>
<volume name="Box"><materialref ref="Air"/><solidref ref="AirBox"/><physvol name="core"><volumeref ref="Core"/></physvol></volume>
<volume name="World"><materialref ref="Silicon"/><solidref ref="WorldBox"/>
<physvol name="box"><volumeref ref="Box"/></physvol>
<physvol name="right" copynumber="1"><volumeref ref="Sensor"/><position name="p" x="30.5" unit="mm"/></physvol>
<physvol name="left" copynumber="0"><volumeref ref="Sensor"/><position name="q" x="-30.5" unit="mm"/></physvol></volume>{links}</structure>
<setup name="Default" version="1.0"><world ref="World"/></setup></gdml>"#
    )
}

const SKIN: &str =
    r#"<skinsurface name="s" surfaceproperty="Cathode"><volumeref ref="Sensor"/></skinsurface>"#;
const BORDERS: &str = r#"<bordersurface name="r" surfaceproperty="Cathode"><physvolref ref="core"/><physvolref ref="right"/></bordersurface>
<bordersurface name="l" surfaceproperty="Cathode"><physvolref ref="core"/><physvolref ref="left"/></bordersurface>"#;

/// Photons from many distances to one end of the bar, each at a small angle.
fn run(links: &str, sign: f64, settings: &RunSettings) -> PhotonRun {
    let photon = |k: usize| Photon {
        position: Vec3::new(sign * (14.0 + 1e-3 * k as f64), 0.9, 0.1),
        direction: Vec3::new(sign, -0.07, 0.01).normalize(),
        polarisation: Vec3::new(0.0, 0.01, 0.07).normalize(),
        energy: 3e-6,
        time: 0.0,
    };
    let source = Source::Photons((0..COUNT).map(photon).collect());
    crate::run(&crate::detector(&bar(links)).unwrap(), &source, settings)
}

const COUNT: usize = 1500;

#[test]
fn hits_belong_to_the_copy_behind_the_end() {
    for (sign, copy) in [(1.0, 1), (-1.0, 0)] {
        for links in [SKIN, BORDERS] {
            let run = run(links, sign, &crate::settings(COUNT));
            assert_eq!(crate::count(&run, End::Detected), COUNT as u64, "{links}: {:?}", run.ends);
            let hits = &run.hits;
            let sensor = format!("Sensor[{copy}]");
            assert!(hits.sensor.iter().all(|&k| *hits.paths()[k as usize] == *sensor), "{:?}", hits.paths());
        }
    }
}
