//! Layered models: volumes in volumes, in copies, some of which touch, each region with a medium of its own.

use crate::arrange::{cube, cylinder, gap, sphere};
use crate::oracle::{Setting, levels};
use crate::starts;
use rayweave_conformance::{Random, Tally};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Face, PlacementId, Region, Solid, Start};
use rayweave_shape::Ray;

/// Copies of a core with a sensor on it, in a shell within a cover; in the world, beside a ball of the last region.
fn layers(rng: &mut Random, frame: &Affine) -> Vec<Region> {
    let half = Vec3::new(1.0, rng.pick(&[1.0, 0.5]), rng.pick(&[1.0, 2.0]));
    let shell = Vec3::splat(rng.pick(&[0.3, 0.01, 1e-9]));
    let up = Vec3::Z * (half.z + 0.1 + gap(rng));
    let at = |x: u32| Vec3::new(f64::from(x % 3), f64::from(x / 3), 0.0) * apart(half, shell);
    let maps: Vec<Affine> = (0..9).map(|x| Affine::translate(at(x))).collect();
    let core = if rng.chance(0.3) { sphere(half.min_element()) } else { cube(half) };
    let sensor = cube(Vec3::new(0.9 * half.x, 0.9 * half.y, 0.1)).translate(up.to_array());
    let inner = cube(half + shell + Vec3::Z * 0.2);
    let cover = cube(half + 2.0 * shell + Vec3::Z * 0.2);
    let is_placed = rng.chance(0.8);
    let copies = |solid: Solid| if is_placed { solid.place(maps.clone()) } else { solid };
    let world = cube(Vec3::splat(30.0));
    let ball = copies(sensor) | sphere(1.0).translate([-10.0, 0.0, 0.0]);
    let solids = [world, copies(cover), copies(inner), copies(core), ball];
    regions(solids, frame)
}

/// Regions of these solids in a frame, each with a medium of its own.
fn regions(solids: impl IntoIterator<Item = Solid>, frame: &Affine) -> Vec<Region> {
    let region = |(k, solid): (u32, Solid)| Region {
        name: format!("layer {k}"),
        solid: solid.apply(*frame),
        medium: k + 1,
    };
    (0..).zip(solids).map(region).collect()
}

/// The distances of copies with some space between their covers.
fn apart(half: Vec3, shell: Vec3) -> Vec3 {
    2.0 * half + 4.0 * shell + Vec3::splat(0.1)
}

/// Rays that are scattered from face to face.
#[test]
fn layers_from_their_surfaces() {
    let mut tally = Tally::new("layers from their surfaces");
    for seed in 0..120 {
        let rng = &mut Random::new(9 << 40 | seed);
        let frame = match rng.below(3) {
            0 => Affine::rotation(rng.direction(), 30.0),
            _ => Affine::IDENTITY,
        };
        let regions = layers(rng, &frame);
        let ray = |_| {
            let from = Vec3::new(rng.between(-1.0, 8.0), rng.between(-1.0, 4.0), rng.between(-1.0, 1.0));
            Ray::new(from, rng.direction()).transformed(&frame)
        };
        let rays = (0..40).map(ray).collect();
        let Some(setting) = Setting::new(regions, rays, format!("layers, seed {seed}")) else { continue };
        starts::follow(&setting, levels()[seed as usize % 2], rng, &mut tally);
    }
    tally.finish(15_000);
}

/// A tank with many balls, each with a core within, and a post across it: more solids than a list of neighbours holds.
fn tank(rng: &mut Random, frame: &Affine) -> Vec<Region> {
    let shell = rng.pick(&[0.3, 0.01, 1e-9]);
    let pitch = 2.0 + gap(rng);
    let at = |k: u32| pitch * Vec3::new(f64::from(k % 4), f64::from(k / 4 % 4), f64::from(k / 16)).round();
    let maps: Vec<Affine> = (0..48).map(|k| Affine::translate(at(k))).collect();
    let is_round = rng.chance(0.7);
    let part = |half: f64| if is_round { sphere(half) } else { cube(Vec3::splat(half)) };
    let tank = cube(Vec3::splat(20.0)).translate([pitch * 1.5; 3]);
    let post = cube(Vec3::new(0.1, 25.0, 0.1)).translate([-3.0, 0.0, 0.0]);
    let [balls, cores] = [1.0, 1.0 - shell].map(|half| part(half).place(maps.clone()));
    let solids = [cube(Vec3::splat(40.0)), tank, balls, cores, post];
    regions(solids, frame)
}

/// Rays that start between many solids, and are scattered from face to face.
#[test]
fn a_tank_of_many_solids() {
    let mut tally = Tally::new("a tank of many solids");
    for seed in 0..12 {
        let rng = &mut Random::new(10 << 40 | seed);
        let frame = match rng.below(3) {
            0 => Affine::rotation(rng.direction(), 30.0),
            _ => Affine::IDENTITY,
        };
        let regions = tank(rng, &frame);
        let ray = |_| {
            let from = Vec3::from_array([(); 3].map(|()| rng.between(-4.0, 10.0)));
            Ray::new(from, rng.direction()).transformed(&frame)
        };
        let rays = (0..40).map(ray).collect();
        let Some(setting) = Setting::new(regions, rays, format!("tank, seed {seed}")) else { continue };
        starts::follow(&setting, levels()[seed as usize % 2], rng, &mut tally);
    }
    tally.finish(1_000);
}

/// A tank that balls nearly fill, or a narrow one around a row of them, each with a core within: rays pass many of their boxes.
fn crowded(rng: &mut Random, counts: [u32; 3], frame: &Affine) -> Vec<Region> {
    let pitch = 2.0 + rng.pick(&[0.1, 0.2]);
    let [x, y, z] = counts;
    let at = |k: u32| pitch * Vec3::new(f64::from(k % x), f64::from(k / x % y), f64::from(k / (x * y)));
    let maps: Vec<Affine> = (0..x * y * z).map(|k| Affine::translate(at(k))).collect();
    let size = pitch * Vec3::from_array(counts.map(f64::from));
    let centre = 0.5 * (size - Vec3::splat(pitch));
    let tank = cube(0.5 * size).translate(centre.to_array());
    let [balls, cores] = [0.9, 0.4].map(|radius| sphere(radius).place(maps.clone()));
    regions([cube(Vec3::splat(150.0)), tank, balls, cores], frame)
}

/// Rays in a tank that solids fill search them from front to back; those along a row leave the search of all rays together.
#[test]
fn a_crowded_tank() {
    let mut tally = Tally::new("a crowded tank");
    for seed in 0..8 {
        let rng = &mut Random::new(12 << 40 | seed);
        let frame = if rng.chance(0.5) { Affine::rotation(rng.direction(), 30.0) } else { Affine::IDENTITY };
        let is_row = seed % 2 == 1;
        let regions = crowded(rng, if is_row { [1, 1, 60] } else { [7, 7, 7] }, &frame);
        let ray = |_| {
            let ray = match is_row {
                // beside the balls, and nearly along the row
                true => {
                    let from = Vec3::new(rng.between(0.8, 1.0), rng.between(0.8, 1.0), -1.0);
                    Ray::new(from, Vec3::Z + 0.01 * rng.direction())
                }
                false => {
                    let from = Vec3::from_array([(); 3].map(|()| rng.between(-1.0, 13.0)));
                    Ray::new(from, rng.direction())
                }
            };
            ray.transformed(&frame)
        };
        let rays = (0..40).map(ray).collect();
        let Some(setting) = Setting::new(regions, rays, format!("crowded, seed {seed}")) else { continue };
        starts::follow(&setting, levels()[seed as usize % 2], rng, &mut tally);
    }
    tally.finish(500);
}

/// A tank whose solids are turned, each in its own way, and of which some are not convex or are unions of several parts; some
/// reach through the wall, some overlap, and each has another one within it.
fn turned_solids(rng: &mut Random, frame: &Affine) -> Vec<Region> {
    let pitch = rng.pick(&[2.2, 1.7]);
    let at = |k: u32| pitch * Vec3::new(f64::from(k % 4), f64::from(k / 4 % 4), f64::from(k / 16));
    let is_turned = rng.chance(0.7);
    let mut map = |k: u32| {
        let angle = if is_turned { 90.0 * f64::from(k % 3) + 10.0 } else { 0.0 };
        Affine::rotation(rng.direction(), angle).then(&Affine::translate(at(k)))
    };
    let maps: Vec<Affine> = (0..48).map(&mut map).collect();
    let outer = match rng.below(4) {
        0 => cylinder(0.8, 1.0),
        1 => cube(Vec3::splat(0.7)) - sphere(0.9),
        2 => sphere(0.7) | cylinder(0.3, 2.0),
        _ => sphere(0.9),
    };
    let core = sphere(0.1).translate([0.0, 0.0, rng.pick(&[0.0, 0.6])]);
    let wall = rng.pick(&[20.0, 3.0 * pitch]);
    let tank = cube(Vec3::splat(wall)).translate([pitch * 1.5; 3]);
    let solids = [cube(Vec3::splat(40.0)), tank, outer.place(maps.clone()), core.place(maps)];
    regions(solids, frame)
}

#[test]
fn a_tank_of_turned_solids() {
    let mut tally = Tally::new("a tank of turned solids");
    for seed in 0..16 {
        let rng = &mut Random::new(11 << 40 | seed);
        let frame = if rng.chance(0.5) { Affine::rotation(rng.direction(), 30.0) } else { Affine::IDENTITY };
        let regions = turned_solids(rng, &frame);
        let ray = |_| {
            let from = Vec3::from_array([(); 3].map(|()| rng.between(-4.0, 10.0)));
            Ray::new(from, rng.direction()).transformed(&frame)
        };
        let rays = (0..50).map(ray).collect();
        let Some(setting) = Setting::new(regions, rays, format!("turned, seed {seed}")) else { continue };
        starts::follow(&setting, levels()[seed as usize % 2], rng, &mut tally);
    }
    tally.finish(1_500);
}

/// Copies of a tile with a hole for a fibre and its cladding, in a wrapping with the same hole that touches the tile, or nearly.
fn tiles(rng: &mut Random, frame: &Affine) -> Vec<Region> {
    let half = Vec3::new(1.5, 0.5, rng.pick(&[1.5, 0.7]));
    let [slit, thin] = [(); 2].map(|()| if rng.chance(0.4) { 0.0 } else { gap(rng) });
    let hole = || cylinder(0.12, 6.0);
    let tile = cube(half) - hole();
    let wrapping = cube(half + Vec3::splat(0.1)) - cube(half + Vec3::splat(slit)) - hole();
    let core = cylinder(0.06, rng.pick(&[3.8, 1.0]));
    let cladding = cylinder(0.08, 3.8) - cylinder(0.06 + thin, 5.0);
    let is_turned = rng.chance(0.5);
    let map = |k: u32| {
        let turn = Affine::rotation(Vec3::X, if is_turned { 90.0 } else { 0.0 });
        let shift = Vec3::new(3.5 * f64::from(k % 3), 5.0 * f64::from(k / 3), 0.1 * f64::from(k));
        turn.then(&Affine::translate(shift))
    };
    let maps: Vec<Affine> = (0..6).map(map).collect();
    let sensor = cube(Vec3::splat(0.1)).translate([0.0, 0.0, 2.0]);
    let cell = cube(Vec3::new(1.7, 0.7, 2.2));
    let parts = [cell, tile, wrapping, core, cladding, sensor].map(|solid| solid.place(maps.clone()));
    regions(std::iter::once(cube(Vec3::splat(30.0))).chain(parts), frame)
}

/// Rays in tiles leave several solids and enter others at the same or nearly the same time.
#[test]
fn tiles_with_fibres() {
    let mut tally = Tally::new("tiles with fibres");
    for seed in 0..60 {
        let rng = &mut Random::new(13 << 40 | seed);
        let frame = match rng.below(3) {
            0 => Affine::rotation(rng.direction(), 30.0),
            _ => Affine::IDENTITY,
        };
        let regions = tiles(rng, &frame);
        let ray = |_| {
            let from = Vec3::new(rng.between(-1.0, 8.0), rng.between(-1.0, 6.0), rng.between(-0.5, 1.0));
            Ray::new(from, rng.direction()).transformed(&frame)
        };
        let rays = (0..40).map(ray).collect();
        let Some(setting) = Setting::new(regions, rays, format!("tiles, seed {seed}")) else { continue };
        starts::follow(&setting, levels()[seed as usize % 2], rng, &mut tally);
    }
    tally.finish(5_000);
}

/// A ray that starts within one copy of a region, on the plane of a face of another copy: the solids beside that copy are not
/// all that it can meet.
#[test]
fn a_start_on_the_plane_of_another_copy() {
    let half = Vec3::splat(0.5);
    let copies = cube(half).place([Affine::IDENTITY, Affine::translate(Vec3::new(0.5, 1.0, 0.0))]);
    let target = cube(Vec3::splat(0.1)).translate([0.2, 1.2, 0.0]);
    let solids = [cube(Vec3::splat(9.0)), copies, target];
    let regions = regions(solids, &Affine::IDENTITY);
    let ray = Ray::new(Vec3::new(0.5, 1.2, 0.0), -Vec3::X);
    let setting = Setting::new(regions, vec![ray; 8], "two copies".to_owned()).unwrap();
    let program = setting.program();
    let is_there = |face: &Face| {
        let plane = program.surface(face.surface).surface.value_and_gradient(Vec3::new(0.5, 7.0, 7.0)).0;
        face.placement == PlacementId(1) && plane == 0.0
    };
    // the face of the first copy at x = 0.5, reached from outside
    let towards = Ray::new(Vec3::new(0.9, 0.0, 0.0), -Vec3::X);
    let reached = starts::lists_of_first(&setting, &[towards]);
    let face = reached.first().map(|crossing| crossing.face).filter(is_there).unwrap();
    let start = Start { surface: face.surface, placement: face.placement, inside: true };
    starts::compare(&setting, &[ray; 8], &vec![vec![start]; 8]);
}
