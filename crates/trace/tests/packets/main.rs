//! [`Packets`] against [`Reference`]: equal answers, bit for bit, to every kind of query, with every
//! instruction set and batch size, on models and rays designed to make lanes report wrong results as certain.
//!
//! [`Packets`]: rayweave_trace::Packets
//! [`Reference`]: rayweave_trace::Reference

mod aim;
mod arrange;
mod combine;
mod crowd;
mod large;
mod layers;
mod oracle;
mod placed;
mod starts;

use aim::aimed;
use arrange::Arrangement;
use combine::regions;
use crowd::{bundles, carved, crowd};
use oracle::{Oracle, Setting, levels};
use rayweave_conformance::rays::rays;
use rayweave_conformance::{Model, Random, Style, Tally};
use rayweave_math::{Affine, Vec3};
use rayweave_model::Region;
use rayweave_shape::Ray;

/// A model of one of the arrangements, turned, moved and scaled, with rays aimed at its degenerate places.
fn arranged(seed: u64, arrangement: Arrangement, count: usize) -> (Vec<Region>, Vec<Ray>) {
    let rng = &mut Random::new(5 << 40 | seed);
    let (parts, targets) = arrangement(rng);
    let frame = frame(rng);
    let regions = regions(rng, &parts, &frame);
    let rays = (0..count).map(|_| aimed(rng, &targets).transformed(&frame)).collect();
    (regions, rays)
}

/// Half of the frames are rotated only by multiples of 90 degrees, if at all; some are large, small or far away.
fn frame(rng: &mut Random) -> Affine {
    let turn = match rng.below(4) {
        0 => Affine::IDENTITY,
        1 => Affine::rotation(rng.pick(&Vec3::AXES), rng.pick(&[90.0, 180.0, 270.0])),
        _ => Affine::rotation(rng.direction(), rng.between(-180.0, 180.0)),
    };
    let size = if rng.chance(0.5) { 1.0 } else { rng.magnitude(-8.0, 8.0).abs() };
    let far = rng.pick(&[0.0, 0.0, 0.5, 1.0, 1e3]);
    let place = Affine::translate(size * far * rng.direction());
    turn.then(&Affine::scale(Vec3::splat(size))).then(&place)
}

/// Compares all queries on models of an arrangement.
fn check(what: &'static str, arrangement: Arrangement, models: u64, least: u64) {
    let mut oracle = Oracle::new(what);
    for seed in 0..models {
        let (regions, rays) = arranged(seed, arrangement, 48);
        let Some(setting) = Setting::new(regions, rays, format!("{what}, model {seed}")) else { continue };
        oracle.everything(&setting, &mut Random::new(seed), &levels());
    }
    oracle.finish(models * least);
}

/// Numbers of models of the short and the long form.
const SHORT: u64 = 150;
const LONG: u64 = 40_000;

macro_rules! arrangements {
    ($($name:ident, $long:ident;)*) => {$(
        #[test]
        fn $name() {
            check(stringify!($name), arrange::$name, SHORT, 30);
        }

        #[test]
        #[ignore = "long"]
        fn $long() {
            check(stringify!($name), arrange::$name, LONG, 30);
        }
    )*};
}

arrangements! {
    thin_shells, long_thin_shells;
    thin_gaps, long_thin_gaps;
    touching_balls, long_touching_balls;
    coaxial_rods, long_coaxial_rods;
    edges_and_corners, long_edges_and_corners;
    rims, long_rims;
    bores_beside_faces, long_bores_beside_faces;
    unbounded_parts, long_unbounded_parts;
    whole_coordinates, long_whole_coordinates;
    cones, long_cones;
    conics, long_conics;
    rings, long_rings;
}

/// Compares all queries on unions of many solids, with bundles of rays.
fn check_crowds(models: u64, least: u64) {
    let mut oracle = Oracle::new("crowds");
    for seed in 0..models {
        let rng = &mut Random::new(7 << 40 | seed);
        let frame = frame(rng);
        let (regions, targets) = crowd(rng, &frame);
        let rays = bundles(rng, &targets, 96).into_iter().map(|ray| ray.transformed(&frame)).collect();
        let Some(setting) = Setting::new(regions, rays, format!("crowd {seed}")) else { continue };
        oracle.everything(&setting, rng, &levels());
    }
    oracle.finish(models * least);
}

#[test]
fn crowds() {
    check_crowds(100, 60);
}

#[test]
#[ignore = "long"]
fn long_crowds() {
    check_crowds(20_000, 60);
}

/// Compares all queries on solids minus many others.
fn check_carved(models: u64, least: u64) {
    let mut oracle = Oracle::new("carved solids");
    for seed in 0..models {
        let rng = &mut Random::new(9 << 40 | seed);
        let frame = frame(rng);
        let (regions, targets) = carved(rng, &frame);
        let rays = bundles(rng, &targets, 96).into_iter().map(|ray| ray.transformed(&frame)).collect();
        let Some(setting) = Setting::new(regions, rays, format!("carved {seed}")) else { continue };
        oracle.everything(&setting, rng, &levels());
    }
    oracle.finish(models * least);
}

#[test]
fn carved_solids() {
    check_carved(100, 60);
}

#[test]
#[ignore = "long"]
fn long_carved_solids() {
    check_carved(20_000, 60);
}

/// Random models of the suite that are traced in lanes; most are small, and half have rays on the grid where
/// faces coincide.
fn sweep(seeds: std::ops::Range<u64>, count: usize, least: u64) {
    let mut oracle = Oracle::new("random models of the suite");
    for seed in seeds {
        let rng = &mut Random::new(6 << 40 | seed);
        let style = [Style::Generic, Style::Grid, Style::Grid, Style::Planes][seed as usize % 4];
        let model = if seed % 8 < 5 {
            Model::small(rng, style)
        } else {
            Model::random(&mut Random::new(seed), style)
        };
        let rays = rays(rng, style, &model.frame, count);
        let Some(setting) = Setting::new(model.regions, rays, format!("sweep, seed {seed}")) else {
            continue;
        };
        oracle.lists(&setting, &mut Random::new(seed));
    }
    oracle.finish(least);
}

#[test]
fn random_models() {
    sweep(0..3000, 100, 100_000);
}

/// `cargo test --release -p rayweave-trace --test packets -- --ignored long_random_models`.
#[test]
#[ignore = "long"]
fn long_random_models() {
    sweep(3000..50_000, 1000, 10_000_000);
}

/// Compares rays that start on surfaces of all arrangements and of random models.
fn check_starts(seeds: std::ops::Range<u64>, least: u64) {
    let mut tally = Tally::new("rays that start on surfaces");
    for seed in seeds {
        let rng = &mut Random::new(8 << 40 | seed);
        let (regions, rays) = match arrange::ALL.get(seed as usize % (arrange::ALL.len() + 8)) {
            Some(&arrangement) => arranged(seed, arrangement, 40),
            None => {
                let model = Model::small(rng, Style::Generic);
                (model.regions, rays(rng, Style::Generic, &model.frame, 40))
            }
        };
        let Some(setting) = Setting::new(regions, rays, format!("starts, seed {seed}")) else { continue };
        starts::follow(&setting, rng.pick(&levels()), rng, &mut tally);
    }
    tally.finish(least);
}

#[test]
fn starts_on_surfaces() {
    check_starts(0..1500, 100_000);
}

#[test]
#[ignore = "long"]
fn long_starts_on_surfaces() {
    check_starts(1500..200_000, 10_000_000);
}

#[test]
fn batches_of_any_size() {
    let mut oracle = Oracle::new("batches of any size");
    for (k, arrangement) in arrange::ALL.into_iter().enumerate() {
        let found = (100..).find_map(|seed| {
            let (regions, rays) = arranged(seed, arrangement, 1000);
            Setting::new(regions, rays, format!("arrangement {k}"))
        });
        let Some(setting) = found else { continue };
        for size in [1, 7, 8, 9, 64, 1000] {
            oracle.in_batches(&setting, size, &levels()[..1]);
        }
    }
    oracle.finish(6 * 1000 * arrange::ALL.len() as u64);
}
