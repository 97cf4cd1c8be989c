//! Photons that bounce in boxes have the histories that the queries of every evaluator give, however the boxes touch.

use rayweave_math::Vec3;
use rayweave_model::Evaluator;
use rayweave_photon::philox::{Purpose, Stream};
use rayweave_photon::{DetectionRule, End, Photon, RunSettings, Source, simulate};
use rayweave_trace::{Packets, Weave};

/// A volume: name, material, size, position.
type Volume = (&'static str, &'static str, [f64; 3], [f64; 3]);

/// Painted shells at some places, each around a box of air that contains `inner`.
fn detector(inner: &[Volume], places: &[[f64; 3]]) -> String {
    let sides = |size: [f64; 3]| format!(r#"x="{}" y="{}" z="{}" lunit="mm""#, size[0], size[1], size[2]);
    let placed = |name: &str, volume: &str, [x, y, z]: [f64; 3]| {
        format!(
            r#"<physvol name="{name}"><volumeref ref="{volume}"/>
<position name="{name}_at" x="{x}" y="{y}" z="{z}" unit="mm"/></physvol>"#
        )
    };
    let solids: String = inner
        .iter()
        .map(|(name, _, size, _)| format!(r#"<box name="{name}Box" {}/>"#, sides(*size)))
        .collect();
    let volumes: String = inner
        .iter()
        .map(|(name, material, ..)| {
            format!(
                r#"<volume name="{name}"><materialref ref="{material}"/><solidref ref="{name}Box"/></volume>"#
            )
        })
        .collect();
    let daughters: String =
        inner.iter().map(|(name, _, _, at)| placed(&format!("{name}_in"), name, *at)).collect();
    let shells: String =
        places.iter().enumerate().map(|(k, at)| placed(&format!("shell{k}"), "Shell", *at)).collect();
    format!(
        r#"<gdml><define>
<matrix name="AIR" coldim="2" values="1*eV 1 10*eV 1"/><matrix name="GLASS" coldim="2" values="1*eV 1.6 10*eV 1.6"/>
<matrix name="WATER" coldim="2" values="1*eV 1.33 10*eV 1.33"/><matrix name="ZERO" coldim="2" values="1*eV 0 10*eV 0"/>
<matrix name="MOST" coldim="2" values="1*eV 0.97 10*eV 0.97"/><matrix name="HALF" coldim="2" values="1*eV 0.5 10*eV 0.5"/>
<matrix name="LONG" coldim="2" values="1*eV 400 10*eV 400"/></define>
<materials><element name="H" Z="1"><atom value="1"/></element>
<material name="Air"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="AIR"/></material>
<material name="Glass"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="GLASS"/>
<property name="ABSLENGTH" ref="LONG"/></material>
<material name="Water"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="WATER"/>
<property name="ABSLENGTH" ref="LONG"/><property name="RAYLEIGH" ref="LONG"/></material>
<material name="Silicon"><D value="1"/><fraction n="1" ref="H"/></material></materials>
<solids><box name="WorldBox" x="900" y="900" z="900" lunit="mm"/><box name="ShellBox" x="31" y="31" z="31" lunit="mm"/>
<box name="GapBox" x="30" y="30" z="30" lunit="mm"/>{solids}
<opticalsurface name="Paint" model="unified" finish="groundfrontpainted" type="dielectric_dielectric" value="0">
<property name="REFLECTIVITY" ref="MOST"/></opticalsurface>
<opticalsurface name="Cathode" model="unified" finish="polished" type="dielectric_metal" value="0">
<property name="REFLECTIVITY" ref="ZERO"/><property name="EFFICIENCY" ref="HALF"/></opticalsurface></solids>
<structure>{volumes}
<volume name="Gap"><materialref ref="Air"/><solidref ref="GapBox"/>{daughters}</volume>
<volume name="Shell"><materialref ref="Silicon"/><solidref ref="ShellBox"/>
<physvol name="gap"><volumeref ref="Gap"/></physvol></volume>
<volume name="World"><materialref ref="Silicon"/><solidref ref="WorldBox"/>{shells}</volume>
<skinsurface name="paint" surfaceproperty="Paint"><volumeref ref="Shell"/></skinsurface>
<skinsurface name="cathode" surfaceproperty="Cathode"><volumeref ref="Sensor"/></skinsurface></structure>
<setup name="Default" version="1.0"><world ref="World"/></setup></gdml>"#
    )
}

/// Photons from random points of the shell at a place, some of them along an axis.
fn photons(count: u64, place: [f64; 3]) -> Source {
    let photon = |number: u64| {
        let mut stream = Stream::new(3, number, 0, Purpose::Emission);
        let offset = Vec3::from_array([(); 3].map(|()| 29.8 * (stream.uniform() - 0.5)));
        let direction = if number.is_multiple_of(50) { Vec3::X } else { stream.direction() };
        let polarisation = stream.polarisation(direction);
        Photon {
            position: Vec3::from_array(place) + offset,
            direction,
            polarisation,
            energy: 3e-6,
            time: 0.0,
        }
    };
    Source::Photons((0..count).map(photon).collect())
}

const COUNT: u64 = 600;

/// Asserts that the evaluator has boxes and that runs with and without them are equal.
fn assert_equal_runs(inner: &[Volume], places: &[[f64; 3]]) {
    let detector = crate::detector(&detector(inner, places)).unwrap();
    let program = detector.program();
    let (packets, weave) = (Packets::new(program.clone()), Weave::new(program.clone()));
    if rayweave_shape::lanes::WideLevel::widest().is_some() {
        assert!(packets.box_cells().is_some_and(|cells| cells.cells.len() >= places.len()));
    }
    assert!(weave.box_cells().is_none());
    for (k, &place) in places.iter().enumerate() {
        let source = photons(COUNT, place);
        let all = RunSettings { seed: k as u64, ..RunSettings::new(0..COUNT) };
        let early = RunSettings { max_steps: 9, max_time: 0.5, ..all.clone() };
        let entered = RunSettings { detection: DetectionRule::Volume, ..all.clone() };
        for settings in [all, early, entered] {
            let own = simulate(&detector, &packets, &source, &settings).unwrap();
            let expected = simulate(&detector, &weave, &source, &settings).unwrap();
            assert_eq!(own, expected, "{inner:?} at {place:?}");
            if settings.max_steps > 9 && settings.detection == DetectionRule::Both {
                assert!(own.steps > 4 * COUNT, "{}", own.steps);
                assert!(own.ends.get(&End::Detected) > Some(&5), "{:?}", own.ends);
            }
        }
    }
}

const PLACES: [[f64; 3]; 3] = [[0.0; 3], [40.0, -0.3, 0.1], [-400.0, 411.7, 1.0 / 3.0]];

#[test]
fn bars_with_sensors_apart_and_glued() {
    for gap in [0.0, 1e-9, 1e-6, 1e-3, 0.5] {
        let sensor = ("Sensor", "Silicon", [18.0, 18.0, 2.0], [0.0, 0.0, 11.0 + gap]);
        assert_equal_runs(&[("Bar", "Glass", [20.0, 20.0, 20.0], [0.0; 3]), sensor], &PLACES);
    }
}

#[test]
fn boxes_flush_with_the_one_around_them() {
    let sensor = ("Sensor", "Silicon", [4.0, 30.0, 4.0], [13.0, 0.0, 13.0]);
    assert_equal_runs(&[("Bar", "Glass", [20.0, 20.0, 30.0], [0.0; 3]), sensor], &PLACES);
}

#[test]
fn three_boxes_that_touch_or_overlap() {
    for shift in [-0.5, 0.0, 0.01] {
        let bar = ("Bar", "Glass", [10.0, 12.0, 14.0], [-5.0, 0.0, 0.0]);
        let tank = ("Tank", "Water", [10.0, 12.0, 10.0], [5.0 + shift, 2.0, 0.0]);
        let sensor = ("Sensor", "Silicon", [6.0, 6.0, 2.0], [-5.0, 0.0, 8.0 + shift]);
        assert_equal_runs(&[bar, tank, sensor], &PLACES[1..]);
    }
}

#[test]
fn thin_gaps_below_the_margin() {
    for gap in [1e-5, 3e-4] {
        let side = 30.0 - 2.0 * gap;
        let sensor = ("Sensor", "Silicon", [10.0, 10.0, 1.0], [0.0, 0.0, 0.5 * side - 0.5]);
        let bar = ("Bar", "Glass", [side, side, side - 1.0], [0.0, 0.0, -0.5]);
        assert_equal_runs(&[bar, sensor], &PLACES[..2]);
    }
}

/// Photons that leave a copy for the next one of the same volume, across a gap of rounding errors, do not stop there.
#[test]
fn turned_copies_that_touch() {
    let copy = |k: u32| {
        format!(
            r#"<physvol name="b{k}"><volumeref ref="Bead"/><position name="p{k}" x="{}" y="70.9" z="5.3" unit="mm"/></physvol>"#,
            30.1 + 20.3 * f64::from(k)
        )
    };
    let copies: String = (0..4).map(copy).collect();
    let text = format!(
        r#"<gdml><define><matrix name="ONE" coldim="2" values="1*eV 1 10*eV 1"/>
<matrix name="GLASS" coldim="2" values="1*eV 1.5 10*eV 1.5"/></define>
<materials><element name="H" Z="1"><atom value="1"/></element>
<material name="Air"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="ONE"/></material>
<material name="Glass"><D value="1"/><fraction n="1" ref="H"/><property name="RINDEX" ref="GLASS"/></material></materials>
<solids><box name="WorldBox" x="900" y="900" z="900" lunit="mm"/><box name="FrameBox" x="500" y="400" z="300" lunit="mm"/>
<box name="BeadBox" x="20.3" y="20.3" z="20.3" lunit="mm"/></solids>
<structure><volume name="Bead"><materialref ref="Glass"/><solidref ref="BeadBox"/></volume>
<volume name="Frame"><materialref ref="Air"/><solidref ref="FrameBox"/>{copies}</volume>
<volume name="World"><materialref ref="Glass"/><solidref ref="WorldBox"/><physvol name="f"><volumeref ref="Frame"/>
<position name="pf" x="37.7" y="-20.9" z="11.3" unit="mm"/><rotation name="r" x="25" y="40" z="10" unit="deg"/></physvol>
</volume></structure><setup name="Default" version="1.0"><world ref="World"/></setup></gdml>"#
    );
    let detector = crate::detector(&text).unwrap();
    let program = detector.program();
    let source = photons(4000, [95.0, 60.0, 30.0]);
    let settings = RunSettings { max_steps: 20, ..RunSettings::new(0..4000) };
    let own = simulate(&detector, &Packets::new(program.clone()), &source, &settings).unwrap();
    let expected = simulate(&detector, &Weave::new(program.clone()), &source, &settings).unwrap();
    assert!(own.steps > 8000, "{}", own.steps);
    assert_eq!(own, expected);
    let same = rayweave_photon::BoundaryEvent::SameMaterial;
    assert_eq!(own.boundary_events.get(&same), None, "a stop between two copies");
}
