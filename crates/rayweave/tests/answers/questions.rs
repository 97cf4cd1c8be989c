//! Hashes of model analyses: volume, section, thickness, check, diff, infill.

use crate::files::{listed, stem};
use crate::hash::Hash;
use crate::{Answers, root};
use rayweave::check::{CheckSettings, check};
use rayweave::diff::{DiffSettings, diff};
use rayweave::infill::{Filling, Layers, Raster, Slices, infill};
use rayweave::measure::{Estimate, MeasureSettings, measure_scene};
use rayweave::picture::{PictureOptions, arrange};
use rayweave::render::{Size, View};
use rayweave::scene::{Scene, load};
use rayweave::section::{SectionPlane, SectionSettings, cross_sections};
use rayweave::thickness::ThicknessMap;
use rayweave::{AnyEvaluator, Compiled, Error, Packets};

pub fn record(answers: &mut Answers) {
    for path in listed(&root().join("models"), "toml") {
        let (_, scene) = load(&path, &[]).unwrap();
        let name = stem(&path);
        answers.add(&format!("question/volume/{name}"), volume(&scene));
        answers.add(&format!("question/section/{name}"), section(&scene));
        answers.add(&format!("question/thickness/{name}"), thickness(&scene));
        answers.add(&format!("question/check/{name}"), checked(&scene));
        answers.add(&format!("question/diff/{name}"), different(&scene));
        answers.add(&format!("question/infill/{name}"), filled(&scene));
    }
}

fn estimate(hash: &mut Hash, estimate: &Estimate) {
    hash.numbers([&estimate.value, &estimate.half_width]);
}

/// The value of a result; an error is recorded as rejection, without its text.
fn or_refused<T, X>(hash: &mut Hash, result: Result<T, X>) -> Option<T> {
    if result.is_err() {
        hash.bytes(b"refused");
    }
    result.ok()
}

fn volume(scene: &Scene) -> Hash {
    let mut hash = Hash::new();
    let settings =
        MeasureSettings { precision: 1e-2, most_rays: 1 << 14, seed: 7, ..MeasureSettings::default() };
    let Some(report) =
        or_refused(&mut hash, measure_scene(scene, None, AnyEvaluator::maker(None), &settings, &mut |_| ()))
    else {
        return hash;
    };
    hash.count(report.rays);
    for region in &report.regions {
        estimate(&mut hash, &region.measured.volume);
        estimate(&mut hash, &region.measured.area);
        region.measured.centre.iter().flatten().for_each(|part| estimate(&mut hash, part));
        region.measured.inertia.iter().flatten().for_each(|part| estimate(&mut hash, part));
        region.exact_volume.iter().for_each(|value| hash.number(*value));
        region.mass.iter().for_each(|mass| estimate(&mut hash, mass));
    }
    hash
}

fn section(scene: &Scene) -> Hash {
    let mut hash = Hash::new();
    let planes = [0, 1, 2].map(|axis| SectionPlane::across(axis, 0.125).unwrap());
    let settings = SectionSettings { columns: 64, tolerance: Some(0.01), ..SectionSettings::default() };
    let sections = cross_sections(scene, None, AnyEvaluator::maker(None), &planes, &settings, &mut |_| ());
    for section in or_refused(&mut hash, sections).unwrap_or_default() {
        hash.numbers(section.lo.iter().chain(&section.hi));
        for part in &section.parts {
            hash.numbers([&part.area, &part.perimeter]);
            part.contours.iter().for_each(|contour| hash.numbers(contour.iter().flatten()));
        }
    }
    hash
}

fn thickness(scene: &Scene) -> Hash {
    let mut hash = Hash::new();
    let compiled = Compiled::new(scene).unwrap();
    let evaluator = AnyEvaluator::new(None, compiled.program.clone()).unwrap();
    let options = PictureOptions {
        size: Some(Size::new(32, 24).unwrap()),
        view: Some(View::Front),
        ..PictureOptions::default()
    };
    let Some((camera, picture)) = or_refused(&mut hash, arrange(scene, &compiled, &options)) else {
        return hash;
    };
    let ray = |x: usize, y: usize| camera.ray(picture.size, x as f64 + 0.5, y as f64 + 0.5);
    let size = [picture.size.width(), picture.size.height()];
    let map = ThicknessMap::new(&compiled, &evaluator, size, ray, &mut Default::default());
    if let Some(map) = or_refused(&mut hash, map) {
        hash.numbers(map.path_lengths().values());
        hash.numbers(&map.radiograph(scene));
    }
    hash
}

fn checked(scene: &Scene) -> Hash {
    let mut hash = Hash::new();
    let settings = CheckSettings { across: 16, seed: 3, ..CheckSettings::default() };
    let Some(report) =
        or_refused(&mut hash, check(scene, None, AnyEvaluator::maker(None), &settings, &mut |_| ()))
    else {
        return hash;
    };
    let scope = &report.scope;
    [scope.rays, scope.parts, scope.apart, scope.pairs, scope.operands]
        .iter()
        .for_each(|count| hash.count(*count));
    for finding in &report.findings {
        hash.count(finding.regions.len() as u64);
        hash.numbers(finding.size.iter().chain(&finding.area));
        finding.volume.iter().for_each(|volume| estimate(&mut hash, volume));
        finding.at.iter().for_each(|place| hash.numbers(place.as_ref()));
        hash.count(u64::from(finding.is_proved));
    }
    hash
}

/// The difference between a model and a slightly moved copy.
fn different(scene: &Scene) -> Hash {
    let mut hash = Hash::new();
    let mut other = scene.clone();
    for region in &mut other.regions {
        region.solid = region.solid.translate([0.125, 0.0, 0.0625]);
    }
    let mut settings = DiffSettings { across: 16, ..DiffSettings::default() };
    settings.measure.most_rays = 1 << 12;
    let Some(report) =
        or_refused(&mut hash, diff(scene, &other, AnyEvaluator::maker(None), &settings, &mut |_| ()))
    else {
        return hash;
    };
    hash.count(report.rays);
    for pair in &report.pairs {
        [&pair.both, &pair.a_only, &pair.b_only].into_iter().for_each(|volume| estimate(&mut hash, volume));
        if let Some(spot) = &pair.spot {
            hash.numbers(spot.at.as_ref());
            hash.number(spot.thickness);
        }
    }
    hash
}

fn filled(scene: &Scene) -> Hash {
    let mut hash = Hash::new();
    let compiled = Compiled::new(scene).unwrap();
    let size = compiled.program.bounds().size();
    if !(size.x.is_finite() && size.y.is_finite() && size.z.is_finite()) {
        hash.bytes(b"unbounded");
        return hash;
    }
    let evaluator = Packets::new(compiled.program.clone());
    let raster = Raster::new(size.x.max(size.y) / 24.0, 30.0, 0.5).unwrap();
    let filling = Filling { raster, turn: 67.0, alternate: true };
    let layers = Layers::Every(size.z / 4.0);
    let summary = infill(&Slices(&evaluator), &filling, &layers, &Default::default(), |layer| {
        for trace in &layer.traces {
            hash.numbers(trace.from.iter().chain(&trace.to));
        }
        Ok::<(), Error>(())
    });
    if let Some(summary) = or_refused(&mut hash, summary) {
        hash.count(summary.traces);
        hash.number(summary.length);
    }
    hash
}
