//! Torches against the distributions that they are defined by.

use crate::{
    CLEAR, CRITICAL, SlabDetector, assert_binomial, assert_distribution, detector, kolmogorov, photons_of,
    settings, uniform,
};
use rayweave_math::Vec3;
use rayweave_photon::property::wavelength_nm;
use rayweave_photon::{
    Detector, Directions, LinearDensity, Origin, Photon, Pulse, RunSettings, Source, SourceVolume, Torch,
    WavelengthDistribution, check_start,
};
use rayweave_trace::Packets;
use std::f64::consts::PI;

const COUNT: usize = 20_000;

const GREEN: WavelengthDistribution = WavelengthDistribution::Single(520.0);

fn emitted(torch: Torch) -> Vec<Photon> {
    photons_of(&CLEAR.build(), &Source::Torch(torch), &settings(COUNT))
}

fn point() -> Torch {
    Torch::point(Vec3::new(1.0, 2.0, 30.0), 420.0).unwrap()
}

/// A hollow ball with the radii 50 mm and 100 mm in a box.
fn hollow_ball() -> Detector {
    let text = CLEAR
        .text()
        .replace(r#"<box name="SlabBox" x="1000" y="1000" z="100" lunit="mm"/>"#, SHELL)
        .replace(r#"<position name="p" z="50" unit="mm"/>"#, r#"<position name="p" x="20" unit="mm"/>"#);
    detector(&text).unwrap()
}

const SHELL: &str =
    r#"<sphere name="SlabBox" rmin="50" rmax="100" deltaphi="360" deltatheta="180" aunit="deg" lunit="mm"/>"#;

fn positions(detector: &Detector, volume: SourceVolume) -> Vec<Vec3> {
    let torch = Torch::new(Origin::Volume(volume), GREEN).unwrap();
    let photons = photons_of(detector, &Source::Torch(torch), &settings(COUNT));
    photons.iter().map(|photon| photon.position).collect()
}

#[test]
fn a_disc_is_uniform() {
    let (centre, axis) = (Vec3::new(5.0, -3.0, 20.0), Vec3::new(1.0, 2.0, 2.0) / 3.0);
    let torch = Torch::new(Origin::Disc { centre, axis: 7.0 * axis, radius: 30.0 }, GREEN).unwrap();
    let photons = emitted(torch);
    let away: Vec<Vec3> = photons.iter().map(|photon| photon.position - centre).collect();
    assert!(away.iter().all(|away| away.dot(axis).abs() < 1e-12 && away.length() <= 30.0 + 1e-12));
    assert_distribution(away.iter().map(|away| away.length()).collect(), |r| r * r / 900.0, "radius");
    let x = Vec3::new(2.0, 1.0, -2.0) / 3.0;
    let azimuth = |away: &Vec3| away.dot(axis.cross(x)).atan2(away.dot(x));
    assert_distribution(away.iter().map(azimuth).collect(), uniform(-PI, PI), "azimuth");
}

#[test]
fn a_line_is_uniform() {
    let (from, to) = (Vec3::new(1.0, 0.0, -5.0), Vec3::new(4.0, 4.0, 7.0));
    let photons = emitted(Torch::new(Origin::Line(from, to), GREEN).unwrap());
    let along = |photon: &Photon| (photon.position - from).dot(to - from) / 169.0;
    assert!(photons.iter().all(|p| (p.position - from - along(p) * (to - from)).length() < 1e-12));
    assert_distribution(photons.iter().map(along).collect(), uniform(0.0, 1.0), "line");
}

#[test]
fn a_volume_is_uniform() {
    let detector = hollow_ball();
    let evaluator = Packets::new(detector.program().clone());
    let inside = positions(&detector, SourceVolume::inside(&detector, &evaluator, "Slab").unwrap());
    let from_centre: Vec<Vec3> = inside.iter().map(|p| *p - Vec3::new(20.0, 0.0, 0.0)).collect();
    let cube = |r: f64| (r.powi(3) - 50f64.powi(3)) / (100f64.powi(3) - 50f64.powi(3));
    assert_distribution(from_centre.iter().map(|p| p.length()).collect(), cube, "radius");
    for (axis, what) in (0..3).zip(["x", "y", "z"]) {
        let cosines = from_centre.iter().map(|p| p[axis] / p.length());
        assert_distribution(cosines.collect(), uniform(-1.0, 1.0), what);
    }
    // the mother without its daughter
    let slab = CLEAR.build();
    let evaluator = Packets::new(slab.program().clone());
    let outside = positions(&slab, SourceVolume::inside(&slab, &evaluator, "World").unwrap());
    let is_in_slab = |p: &Vec3| p.x.abs() < 500.0 && p.y.abs() < 500.0 && (0.0..100.0).contains(&p.z);
    assert!(!outside.iter().any(is_in_slab));
    let below = outside.iter().filter(|p| p.z < 0.0).count() as u64;
    assert_binomial(below, COUNT as u64, 4.0 / 7.9, "below the slab");
}

/// The outer sphere has four times the area of the inner one; on each of them the cosines are uniform (Archimedes).
#[test]
fn a_surface_is_uniform() {
    let detector = hollow_ball();
    let evaluator = Packets::new(detector.program().clone());
    let places = positions(&detector, SourceVolume::boundary(&detector, &evaluator, "Slab").unwrap());
    let from_centre: Vec<Vec3> = places.iter().map(|p| *p - Vec3::new(20.0, 0.0, 0.0)).collect();
    // 1 nm inside along a line, so between 1 nm and nothing below the surface
    let is_outer = |p: &&Vec3| (100.0 - 1.001e-6..100.0).contains(&p.length());
    let is_inner = |p: &&Vec3| (50.0..50.0 + 1.001e-6).contains(&p.length());
    let outer: Vec<&Vec3> = from_centre.iter().filter(is_outer).collect();
    assert_eq!(outer.len() + from_centre.iter().filter(is_inner).count(), COUNT);
    assert_binomial(outer.len() as u64, COUNT as u64, 0.8, "outer sphere");
    for (axis, what) in (0..3).zip(["x", "y", "z"]) {
        let cosines = outer.iter().map(|p| p[axis] / p.length());
        assert_distribution(cosines.collect(), uniform(-1.0, 1.0), what);
    }
    // faces of a box by their areas: two of 1000 x 1000 and four of 1000 x 100
    let slab = CLEAR.build();
    let evaluator = Packets::new(slab.program().clone());
    let places = positions(&slab, SourceVolume::boundary(&slab, &evaluator, "Slab").unwrap());
    let top: Vec<&Vec3> = places.iter().filter(|p| p.z > 100.0 - 2e-6).collect();
    assert_binomial(top.len() as u64, COUNT as u64, 1.0 / 2.4, "top");
    assert_distribution(top.iter().map(|p| p.x).collect(), uniform(-500.0, 500.0), "x of the top");
    let side: Vec<f64> = places.iter().filter(|p| p.x > 500.0 - 2e-6).map(|p| p.z).collect();
    assert_binomial(side.len() as u64, COUNT as u64, 0.1 / 2.4, "side");
    assert!(side.len() < 1000 || side.iter().all(|z| (0.0..100.0).contains(z)));
}

#[test]
fn directions_are_uniform_in_solid_angle() {
    let axis = Vec3::new(2.0, -2.0, 1.0) / 3.0;
    let photons = emitted(point());
    for (k, what) in (0..3).zip(["x", "y", "z"]) {
        assert_distribution(photons.iter().map(|p| p.direction[k]).collect(), uniform(-1.0, 1.0), what);
    }
    for half_angle in [20.0, 150.0] {
        let cone = point().towards(Directions::Cone { axis, half_angle }).unwrap();
        let photons = emitted(cone);
        let cosines = photons.iter().map(|photon| photon.direction.dot(axis)).collect();
        assert_distribution(cosines, uniform(half_angle.to_radians().cos(), 1.0), "cosine");
    }
    let beam = emitted(point().towards(Directions::Cone { axis: 3.0 * axis, half_angle: 0.0 }).unwrap());
    assert!(beam.iter().all(|photon| (photon.direction - axis).length() < 1e-15));
}

#[test]
fn polarisations_are_perpendicular() {
    let is_transverse = |photon: &Photon| {
        photon.polarisation.dot(photon.direction).abs() < 1e-14
            && (photon.polarisation.length() - 1.0).abs() < 1e-14
    };
    let photons = emitted(point());
    assert!(photons.iter().all(is_transverse));
    let along_z = |p: &Photon| {
        let x = p.direction.cross(Vec3::Z).normalize();
        p.polarisation.dot(p.direction.cross(x)).atan2(p.polarisation.dot(x))
    };
    assert_distribution(photons.iter().map(along_z).collect(), uniform(-PI, PI), "azimuth of polarisation");
    let vector = Vec3::new(1.0, 1.0, 0.0);
    let photons = emitted(point().polarised(vector).unwrap());
    assert!(photons.iter().all(is_transverse));
    // in the plane of the vector and the direction, on the side of the vector
    let is_in_plane = |p: &Photon| p.polarisation.dot(p.direction.cross(vector)).abs() < 1e-12;
    assert!(photons.iter().all(|p| is_in_plane(p) && p.polarisation.dot(vector) > 0.0));
    let beam = point().towards(Directions::Cone { axis: vector, half_angle: 0.0 }).unwrap();
    assert!(beam.polarised(2.0 * vector).unwrap_err().to_string().contains("is parallel to the direction"));
}

#[test]
fn spectra_have_their_densities() {
    let nm = |wavelengths: WavelengthDistribution| -> Vec<f64> {
        let torch = Torch::new(Origin::Point(Vec3::ZERO), wavelengths).unwrap();
        emitted(torch).iter().map(|photon| wavelength_nm(photon.energy)).collect()
    };
    assert_distribution(
        nm(WavelengthDistribution::uniform(300.0, 700.0).unwrap()),
        uniform(300.0, 700.0),
        "uniform",
    );
    // rising from 0 at 400 to 2 at 500, then falling to 1 at 600: areas 100 and 150
    let table = LinearDensity::new(vec![(600.0, 1.0), (400.0, 0.0), (500.0, 2.0)]).unwrap();
    let integral = |x: f64| match x {
        x if x < 500.0 => (x - 400.0).powi(2) / 100.0 / 250.0,
        x => (100.0 + 2.0 * (x - 500.0) - (x - 500.0).powi(2) / 200.0) / 250.0,
    };
    assert_distribution(nm(WavelengthDistribution::Density(table)), integral, "table");
    let planck = |nm: f64| 1.0 / (nm.powi(4) * ((1.438_776_877e7 / (nm * 3000.0)).exp() - 1.0));
    let upto = |nm: f64| simpson(planck, 300.0, nm, 2000);
    let total = upto(1100.0);
    assert_distribution(
        nm(WavelengthDistribution::black_body(3000.0, 300.0, 1100.0).unwrap())[..2000].to_vec(),
        |nm| upto(nm) / total,
        "black body",
    );
}

/// Simpson's rule with an even number of intervals.
pub(crate) fn simpson(f: impl Fn(f64) -> f64, from: f64, to: f64, intervals: usize) -> f64 {
    let h = (to - from) / intervals as f64;
    let weight = |k: usize| match k {
        0 => 1.0,
        k if k == intervals => 1.0,
        k => 2.0 + 2.0 * (k % 2) as f64,
    };
    (0..=intervals).map(|k| weight(k) * f(from + h * k as f64)).sum::<f64>() * h / 3.0
}

#[test]
fn times_have_their_distributions() {
    const MANY: usize = 1_000_000;
    let detector = CLEAR.build();
    let times = |interval, deviation, decay| -> Vec<f64> {
        let torch = point().pulsed(Pulse { interval, deviation, decay }).unwrap();
        let photons = photons_of(&detector, &Source::Torch(torch), &settings(MANY));
        photons.iter().map(|photon| photon.time).collect()
    };
    assert!(times([3.0, 3.0], 0.0, 0.0).iter().all(|time| *time == 3.0));
    assert_distribution(times([3.0, 8.0], 0.0, 0.0), uniform(3.0, 8.0), "interval");
    let decay = |mean: f64| move |t: f64| 1.0 - (-(t - 2.0) / mean).exp();
    let normal = |deviation: f64| move |t: f64| 0.5 * libm::erfc(-t / (deviation * 2f64.sqrt()));
    let (mut late, mut spread) = (times([2.0, 2.0], 0.0, 5.0), times([0.0, 0.0], 1.5, 0.0));
    assert_distribution(late.clone(), decay(5.0), "decay");
    assert_distribution(spread.clone(), normal(1.5), "normal");
    // the same tests reject a decay time and a deviation that are off by 2 %
    for error in [0.98, 1.02] {
        assert!(kolmogorov(&mut late, decay(5.0 * error), "decay") > CRITICAL, "{error}");
        assert!(kolmogorov(&mut spread, normal(1.5 * error), "normal") > CRITICAL, "{error}");
    }
    // the parts add: mean 5.5 + 2, variance 25 / 12 + 1 + 4
    let all = times([3.0, 8.0], 1.0, 2.0);
    let mean = all.iter().sum::<f64>() / MANY as f64;
    let variance = all.iter().map(|t| (t - mean) * (t - mean)).sum::<f64>() / MANY as f64;
    let expected = 25.0 / 12.0 + 5.0;
    assert!((mean - 7.5).abs() < 5.0 * (expected / MANY as f64).sqrt(), "{mean}");
    // the fourth central moment of the sum is 241.3
    let error = ((241.3 - expected * expected) / MANY as f64).sqrt();
    assert!((variance - expected).abs() < 5.0 * error, "{variance}, expected {expected}");
    let bad = Pulse { interval: [1.0, 0.0], ..Pulse::default() };
    assert!(point().pulsed(bad).unwrap_err().to_string().contains("must not end before it starts"));
}

#[test]
fn places_without_an_index_are_reported() {
    let opaque = SlabDetector { inner: "", ..CLEAR }.build();
    let evaluator = Packets::new(opaque.program().clone());
    let check = |origin: Origin| {
        let source = Source::Torch(Torch::new(origin, GREEN).unwrap());
        check_start(&opaque, &evaluator, &source, &RunSettings::new(0..500))
    };
    let inside = check(Origin::Point(Vec3::new(0.0, 0.0, 50.0))).unwrap_err().to_string();
    assert!(inside.contains("in the volume `Slab` of material `Inner`, which has no RINDEX"), "{inside}");
    let outside = check(Origin::Point(Vec3::new(0.0, 0.0, 5000.0))).unwrap_err().to_string();
    assert!(outside.contains("is outside the world"), "{outside}");
    assert_eq!(check(Origin::Point(Vec3::ZERO - 10.0 * Vec3::Z)).unwrap(), None);
    let half = check(Origin::Line(Vec3::new(0.0, 0.0, -100.0), Vec3::new(0.0, 0.0, 100.0))).unwrap().unwrap();
    assert!(half.contains(" of the first 500 photons end at once: photon "), "{half}");
}

#[test]
fn wavelengths_beyond_the_tables_are_reported() {
    let detector = CLEAR.build();
    let evaluator = Packets::new(detector.program().clone());
    let check = |nm: f64| {
        let source = Source::Torch(Torch::point(Vec3::new(1.0, 2.0, 30.0), nm).unwrap());
        check_start(&detector, &evaluator, &source, &RunSettings::new(0..500)).unwrap()
    };
    assert_eq!([300.0, 420.0, 800.0].map(check), [None, None, None]);
    let far = check(4200.0).unwrap();
    assert!(far.contains("source, 4200 nm, are outside all tables of RINDEX"), "{far}");
    // the tables are from 1 eV to 10 eV
    assert!(far.contains("124 nm to 1239.8 nm"), "{far}");
}

#[test]
fn unknown_and_thin_volumes_are_refused() {
    let detector = CLEAR.build();
    let evaluator = Packets::new(detector.program().clone());
    let unknown = SourceVolume::inside(&detector, &evaluator, "Slap").unwrap_err().to_string();
    assert_eq!(unknown, "no volume is called `Slap`: the names are Slab, World. Did you mean `Slab`?");
}

/// Two modules of three bars that touch and are turned by 30 degrees about z, so that their boxes overlap, and a fourth bar in a
/// holder beside them.
fn bars() -> Detector {
    let bar = |k: u32| {
        let along = 20.0 * (f64::from(k) - 1.0);
        let (x, y) = (along * (PI / 6.0).cos(), along * (PI / 6.0).sin());
        format!(
            r#"<physvol name="bar{k}" copynumber="{k}"><volumeref ref="Bar"/><position name="b{k}" x="{x}" y="{y}" unit="mm"/>
<rotation name="r{k}" z="-30" unit="deg"/></physvol>"#
        )
    };
    let module = |k: u32, x: f64| {
        format!(
            r#"<physvol name="module{k}" copynumber="{k}"><volumeref ref="Module"/><position name="m{k}" x="{x}" unit="mm"/></physvol>"#
        )
    };
    let volumes = format!(
        r#"<volume name="Bar"><materialref ref="Inner"/><solidref ref="BarBox"/></volume>
<volume name="Module"><materialref ref="Outer"/><solidref ref="ModuleBox"/>{}</volume>
<volume name="Holder"><materialref ref="Outer"/><solidref ref="ModuleBox"/>
<physvol name="alone"><volumeref ref="Bar"/></physvol></volume>
<volume name="World"><materialref ref="Outer"/><solidref ref="WorldBox"/>{}{}
<physvol name="holder"><volumeref ref="Holder"/><position name="h" y="300" unit="mm"/></physvol></volume>"#,
        [0, 1, 2].map(bar).concat(),
        module(4, -200.0),
        module(7, 200.0)
    );
    let text = CLEAR.text();
    let (first, rest) = text.split_once("<volume name=\"Slab\">").unwrap();
    let (_, last) = rest.split_once("</structure>").unwrap();
    let boxes = r#"<box name="BarBox" x="20" y="60" z="10" lunit="mm"/><box name="ModuleBox" x="150" y="150" z="50" lunit="mm"/>"#;
    let first = first.replace("<box name=\"SlabBox\"", &format!("{boxes}<box name=\"SlabBox\""));
    detector(&format!("{first}{volumes}</structure>{last}")).unwrap()
}

/// Points in the frame of a bar whose centre is at `along` times its width in the module at x.
fn in_bar(places: &[Vec3], along: f64, x: f64) -> [Vec<f64>; 2] {
    let (cosine, sine) = ((PI / 6.0).cos(), (PI / 6.0).sin());
    let from_module = || places.iter().map(|p| *p - Vec3::new(x, 0.0, 0.0));
    let u = from_module().map(|p| p.x * cosine + p.y * sine - 20.0 * along);
    [u.collect(), from_module().map(|p| p.y * cosine - p.x * sine).collect()]
}

#[test]
fn a_path_selects_copies() {
    let detector = bars();
    let evaluator = Packets::new(detector.program().clone());
    let inside =
        |path: &str| positions(&detector, SourceVolume::inside(&detector, &evaluator, path).unwrap());
    for (path, along, x) in [("Module[4]/Bar[2]", 1.0, -200.0), ("Module[7]/Bar[1]", 0.0, 200.0)] {
        let [u, v] = in_bar(&inside(path), along, x);
        assert!(u.iter().all(|u| u.abs() < 10.0 + 1e-9), "{path}");
        assert_distribution(u, uniform(-10.0, 10.0), path);
        assert_distribution(v, uniform(-30.0, 30.0), path);
    }
    // several copies: one bar of each module, all bars of a module, and one that is placed once
    let both = inside("Bar[0]");
    assert_binomial(both.iter().filter(|p| p.x < 0.0).count() as u64, COUNT as u64, 0.5, "left module");
    let [u, _] = in_bar(&inside("Module[7]/Bar"), 0.0, 200.0);
    assert_distribution(u, uniform(-30.0, 30.0), "module");
    let alone = inside("Holder/Bar");
    assert_distribution(alone.iter().map(|p| p.y).collect(), uniform(270.0, 330.0), "holder");
    let all = inside("Bar");
    assert_binomial(all.iter().filter(|p| p.y > 150.0).count() as u64, COUNT as u64, 1.0 / 7.0, "all");
    assert_eq!(inside("Module[7]/Bar"), inside("Module[7]/Bar"));
}

/// The faces of a selected copy by their areas; those towards other copies of a volume without a surface do not count.
#[test]
fn a_path_selects_the_boundary_of_copies() {
    let detector = bars();
    let evaluator = Packets::new(detector.program().clone());
    let boundary =
        |path: &str| positions(&detector, SourceVolume::boundary(&detector, &evaluator, path).unwrap());
    let alone = boundary("Holder/Bar");
    assert!(alone.iter().all(|p| p.x.abs() < 10.0 && (p.y - 300.0).abs() < 30.0 && p.z.abs() < 5.0));
    let top = alone.iter().filter(|p| p.z > 5.0 - 2e-6).count() as u64;
    // 20 x 60 of 2 (20 x 60 + 20 x 10 + 60 x 10)
    assert_binomial(top, COUNT as u64, 1200.0 / 4000.0, "top");
    let places = boundary("Module[4]/Bar[1]");
    let [u, v] = in_bar(&places, 0.0, -200.0);
    assert!(u.iter().all(|u| u.abs() < 10.0 + 1e-9) && v.iter().all(|v| v.abs() < 30.0 + 1e-9));
    let top = places.iter().filter(|p| p.z > 5.0 - 2e-6).count() as u64;
    assert_binomial(top, COUNT as u64, 1200.0 / 2800.0, "top of the middle bar");
}

#[test]
fn unknown_copies_are_refused() {
    let detector = bars();
    let evaluator = Packets::new(detector.program().clone());
    let refused = |path: &str| SourceVolume::inside(&detector, &evaluator, path).unwrap_err().to_string();
    let unknown = refused("Module[4]/Bar[3]");
    assert!(
        unknown.starts_with("no copy of a volume is called `Module[4]/Bar[3]`: the names are "),
        "{unknown}"
    );
    assert!(
        unknown.contains("Module[4]/Bar[2], ") && unknown.contains("Did you mean `Module[4]/Bar["),
        "{unknown}"
    );
    assert!(refused("bar0").ends_with(
        "the names are Bar, Holder, Module, World. Did you mean `Bar`? A path as in tables of hits, such as \
         Module[1]/Crystal[3], selects copies."
    ), "{}", refused("bar0"));
}
