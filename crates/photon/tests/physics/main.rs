//! The physics of photons against closed forms, in small GDML detectors.

mod boundary;
mod boxes;
mod bulk;
mod cavities;
mod closed_volumes;
mod detector;
mod flush;
mod gensteps;
mod history;
mod lint;
mod reproducible;
mod sources;
mod surfaces;

use rayweave_formats::{Format, Options};
use rayweave_math::Vec3;
use rayweave_photon::{
    Detector, End, Photon, PhotonError, PhotonRun, RunSettings, Source, property, simulate,
};
use rayweave_scene::{Document, Scene};
use rayweave_trace::Packets;

/// A world of half side 1 m filled with `Outer`, and in it a slab of `Inner` from z = 0 to z = 100 mm, wide in x and y.
///
/// `matrices`, `inner` and `outer` are elements of `<define>` and of the two materials, `surfaces` of `<solids>`, and
/// `links` of `<structure>`; the slab's volume is `Slab`, its placement `slab`, and `auxiliary` is in its volume.
#[derive(Clone, Copy, Default)]
struct SlabDetector<'a> {
    matrices: &'a str,
    outer: &'a str,
    inner: &'a str,
    surfaces: &'a str,
    links: &'a str,
    auxiliary: &'a str,
}

impl SlabDetector<'_> {
    fn text(&self) -> String {
        let SlabDetector { matrices, outer, inner, surfaces, links, auxiliary } = self;
        format!(
            r#"<gdml><define>
<matrix name="ONE" coldim="2" values="1*eV 1 10*eV 1"/>
<matrix name="GLASS" coldim="2" values="1*eV 1.5 10*eV 1.5"/>
<matrix name="ZERO" coldim="2" values="1*eV 0 10*eV 0"/>
<matrix name="HALF" coldim="2" values="1*eV 0.5 10*eV 0.5"/>
{matrices}</define>
<materials>
<element name="H" Z="1"><atom value="1"/></element>
<material name="Outer"><D value="1"/><fraction n="1" ref="H"/>{outer}</material>
<material name="Inner"><D value="1"/><fraction n="1" ref="H"/>{inner}</material>
</materials>
<solids>
<box name="WorldBox" x="2000" y="2000" z="2000" lunit="mm"/>
<box name="SlabBox" x="1000" y="1000" z="100" lunit="mm"/>
{surfaces}</solids>
<structure>
<volume name="Slab"><materialref ref="Inner"/><solidref ref="SlabBox"/>{auxiliary}</volume>
<volume name="World"><materialref ref="Outer"/><solidref ref="WorldBox"/>
<physvol name="slab"><volumeref ref="Slab"/><position name="p" z="50" unit="mm"/></physvol></volume>
{links}</structure>
<setup name="Default" version="1.0"><world ref="World"/></setup></gdml>"#
        )
    }

    fn build(&self) -> Detector {
        self.try_build().unwrap()
    }

    fn try_build(&self) -> Result<Detector, PhotonError> {
        detector(&self.text())
    }
}

/// The two materials with their indices alone.
const CLEAR: SlabDetector<'static> = SlabDetector {
    matrices: "",
    outer: r#"<property name="RINDEX" ref="ONE"/>"#,
    inner: r#"<property name="RINDEX" ref="GLASS"/>"#,
    surfaces: "",
    links: "",
    auxiliary: "",
};

fn detector(gdml: &str) -> Result<Detector, PhotonError> {
    let (scene, document) = imported(gdml);
    Detector::new(&scene, &document)
}

fn imported(gdml: &str) -> (Scene, Document) {
    let imported = rayweave_formats::parse(gdml, Format::Gdml, &[], &Options::default()).unwrap();
    let document = imported.document();
    (imported.scene, document)
}

fn run(detector: &Detector, source: &Source, settings: &RunSettings) -> PhotonRun {
    let run = simulate(detector, &Packets::new(detector.program().clone()), source, settings).unwrap();
    assert_eq!(run.ends.values().sum::<u64>(), run.photons, "every photon ends once");
    run
}

/// Equal photons of 3 eV from a point below the slab.
fn beam(count: usize, direction: [f64; 3], polarisation: [f64; 3]) -> Source {
    let direction = Vec3::from_array(direction).normalize();
    let photon = Photon {
        position: Vec3::new(0.0, 0.0, -10.0),
        direction,
        polarisation: Vec3::from_array(polarisation).normalize(),
        energy: 3e-6,
        time: 0.0,
    };
    Source::Photons(vec![photon; count])
}

fn settings(count: usize) -> RunSettings {
    RunSettings::new(0..count as u64)
}

fn count(run: &PhotonRun, end: End) -> u64 {
    run.ends.get(&end).copied().unwrap_or(0)
}

/// Asserts that `count` of `total` trials agrees with a probability within five standard deviations.
fn assert_binomial(count: u64, total: u64, probability: f64, what: &str) {
    let expected = total as f64 * probability;
    let deviation = (expected * (1.0 - probability)).sqrt().max(1e-9);
    let z = (count as f64 - expected) / deviation;
    assert!(z.abs() < 5.0, "{what}: {count} of {total}, expected {expected:.1} (z = {z:.1})");
}

/// Asserts that a sample has a distribution, by the test of Kolmogorov and Smirnov at the significance 1e-4.
fn assert_distribution(mut sample: Vec<f64>, distribution: impl Fn(f64) -> f64, what: &str) {
    let statistic = kolmogorov(&mut sample, distribution, what);
    assert!(statistic < CRITICAL, "{what}: the Kolmogorov statistic is {statistic:.2}");
}

/// The Kolmogorov statistic that samples of a distribution exceed with the probability 1e-4: 2 exp(-2 x^2).
const CRITICAL: f64 = 2.225;

/// The largest difference between the distribution of a sample and another one, times the root of the size of the sample.
fn kolmogorov(sample: &mut [f64], distribution: impl Fn(f64) -> f64, what: &str) -> f64 {
    let count = sample.len() as f64;
    assert!(count >= 1000.0, "{what}: {count} values");
    sample.sort_by(f64::total_cmp);
    let mut largest = 0f64;
    for (rank, value) in (0..).map(f64::from).zip(sample.iter()) {
        let expected = distribution(*value);
        assert!((-1e-9..=1.0 + 1e-9).contains(&expected), "{what}: {expected} at {value}");
        largest = largest.max(expected - rank / count).max((rank + 1.0) / count - expected);
    }
    largest * count.sqrt()
}

/// The photons of a source as they start.
fn photons_of(detector: &Detector, source: &Source, settings: &RunSettings) -> Vec<Photon> {
    rayweave_photon::emit(detector, &Packets::new(detector.program().clone()), source, settings).unwrap()
}

/// The uniform distribution between two numbers.
fn uniform(from: f64, to: f64) -> impl Fn(f64) -> f64 {
    move |x| ((x - from) / (to - from)).clamp(0.0, 1.0)
}

#[test]
fn wavelength_and_energy_are_inverse() {
    // 3 eV: 413.2806 nm
    assert!((property::wavelength_nm(3e-6) - 413.280_661_444).abs() < 1e-6);
}
