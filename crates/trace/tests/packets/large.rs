//! Large models, whose leaves are intersected eight at a time for all crossings.

use crate::arrange::{cube, cylinder, sphere};
use crate::oracle::{Oracle, Setting, levels};
use crate::starts;
use rayweave_conformance::models::shape;
use rayweave_conformance::{Random, Tally, scale};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{
    Evaluator, FirstHitColumns, Program, Query, RayAnswer, RayBatch, Region, Solid, Window,
};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::{Packets, Weave};
use std::sync::Arc;

/// Cubes of a grid that fills the cube between -1 and 1, most of which touch others.
fn blocks(rng: &mut Random, count: usize) -> Vec<Solid> {
    let at = |rng: &mut Random| (2 * rng.below(4)) as f64 / 4.0 - 0.75;
    let place = |rng: &mut Random| Vec3::new(at(rng), at(rng), at(rng));
    (0..count).map(|_| cube(Vec3::splat(0.25)).translate(place(rng))).collect()
}

/// Balls of a grid that touch or overlap.
fn balls(rng: &mut Random, count: usize) -> Vec<Solid> {
    let at = |rng: &mut Random| rng.below(5) as f64 / 2.0 - 1.0;
    (0..count)
        .map(|_| {
            let place = Vec3::new(at(rng), at(rng), at(rng));
            sphere(rng.pick(&[0.25, 0.25, 0.25 + 1e-15, 0.2, 0.4])).translate(place)
        })
        .collect()
}

/// Copies of a solid on a grid, where many of them touch or overlap.
fn on_grid(rng: &mut Random, count: usize, solid: &Solid) -> Vec<Solid> {
    let at = |rng: &mut Random| rng.below(9) as f64 / 4.0 - 1.0;
    (0..count).map(|_| solid.translate([at(rng), at(rng), at(rng)])).collect()
}

/// Unions of leaves that are turned, hollow, conical or elliptic, on a grid.
fn curved_models(rng: &mut Random) -> Vec<(&'static str, Vec<Solid>)> {
    let tube = shape("tube", &[("outer_radius", 0.25), ("inner_radius", 0.125), ("height", 0.5)]);
    let frustum = shape("cone", &[("radius1", 0.25), ("radius2", 0.125), ("height", 0.5)]);
    let tip = shape("cone", &[("radius1", 0.25), ("radius2", 0.0), ("height", 0.5)]);
    let bowl = shape("paraboloid", &[("focal_length", 0.125), ("height", 0.5)]);
    let egg = sphere(0.25).scale([1.0, 0.5, 1.5]);
    let rod = cylinder(0.125, 1.0).rotate_x(30.0);
    let oval = cylinder(0.25, 0.5).scale([1.0, 0.5, 1.0]);
    let mixed = [&tube, &frustum, &egg, &rod].map(|solid| on_grid(rng, 12, solid)).concat();
    let mut all = |solid: &Solid| vec![Solid::union(on_grid(rng, 50, solid))];
    vec![
        ("tubes", all(&tube)),
        ("turned tubes", all(&tube.rotate_x(90.0).rotate_z(45.0))),
        ("frustums", all(&frustum)),
        ("turned cones", all(&tip.rotate_y(40.0))),
        ("bowls", all(&bowl)),
        ("ellipsoids", all(&egg)),
        ("rods", all(&rod)),
        ("elliptic cylinders", all(&oval.rotate_x(20.0))),
        (
            "plate with turned bores",
            vec![cube(Vec3::new(1.0, 1.0, 0.25)) - Solid::union(on_grid(rng, 40, &rod))],
        ),
        ("plate less tubes", vec![cube(Vec3::new(1.0, 1.0, 0.25)) - Solid::union(on_grid(rng, 40, &tube))]),
        ("mixed parts", vec![Solid::union(mixed)]),
        ("random parts", vec![scale::parts(200, 5)]),
    ]
}

/// Models of one gate, of several gates and of several regions.
fn models(rng: &mut Random) -> Vec<(&'static str, Vec<Solid>)> {
    let turn = Affine::rotation(rng.direction(), 40.0);
    let turned = |solids: Vec<Solid>| solids.into_iter().map(|solid| solid.apply(turn)).collect::<Vec<_>>();
    let at_zero = [("normal", Value::from(Vec3::Z)), ("offset", Value::Number(0.0))];
    let half_space = Solid::from(build("half_space", &at_zero).expect("a valid shape"));
    let ring = shape("torus", &[("major", 0.6), ("minor", 0.2)]);
    let bores = |rng: &mut Random| {
        let at = |rng: &mut Random| rng.below(9) as f64 / 4.0 - 1.0;
        let bore = |rng: &mut Random| cylinder(0.125, 1.0).translate([at(rng), at(rng), 0.0]);
        Solid::union((0..40).map(|_| bore(rng)).collect::<Vec<_>>())
    };
    vec![
        ("random balls", vec![scale::spheres(200, 3)]),
        ("plate", vec![scale::plate(64)]),
        ("touching holes", vec![cube(Vec3::new(1.0, 1.0, 0.25)) - bores(rng)]),
        ("balls on a grid", vec![Solid::union(balls(rng, 60))]),
        ("odd balls", vec![Solid::symmetric_difference(balls(rng, 50))]),
        ("blocks", vec![Solid::union(blocks(rng, 50))]),
        ("turned blocks", vec![Solid::union(turned(blocks(rng, 50)))]),
        ("half space with pits", vec![half_space.clone() - Solid::union(balls(rng, 50))]),
        ("its complement", vec![!(half_space - Solid::union(balls(rng, 50)))]),
        ("blocks, bores and a ring", vec![(Solid::union(blocks(rng, 50)) - bores(rng)) | ring]),
        ("sponge", vec![scale::sponge(80)]),
        ("two media", vec![Solid::union(blocks(rng, 30)), Solid::union(balls(rng, 30))]),
    ]
}

/// A ray to a point in the cube: any, along an axis on the grid, or from within.
fn ray(rng: &mut Random) -> Ray {
    let grid = |rng: &mut Random| rng.below(17) as f64 / 8.0 - 1.0;
    let on_grid = Vec3::new(grid(rng), grid(rng), grid(rng));
    let to = if rng.chance(0.5) { on_grid } else { rng.point(1.0) };
    let along = match rng.below(4) {
        0 => rng.pick(&Vec3::AXES),
        1 => Vec3::ONE - 2.0 * rng.pick(&Vec3::AXES),
        _ => rng.direction(),
    };
    let nearly = rng.pick(&[0.0, 0.0, 1e-15, 1e-9, 1e-4]) * rng.direction();
    Ray::new(to - rng.pick(&[0.0, 0.0, 1.0, 1.0, 4.0, 4.0, 1e12]) * along, along + nearly)
}

fn settings(rng: &mut Random, count: usize) -> Vec<Setting> {
    let mut all = models(rng);
    all.extend(curved_models(rng));
    all.into_iter()
        .map(|(name, solids)| {
            let region = |(k, solid)| Region { name: format!("{k}"), solid, medium: 1 + k as u32 };
            let regions = solids.into_iter().enumerate().map(region).collect();
            let rays = (0..count).map(|_| ray(rng)).collect();
            Setting::new(regions, rays, name.to_owned()).unwrap_or_else(|| panic!("{name} is in lanes"))
        })
        .collect()
}

#[test]
fn large_models() {
    let mut oracle = Oracle::new("large models");
    for seed in 0..6 {
        let rng = &mut Random::new(11 << 40 | seed);
        for setting in settings(rng, 120) {
            oracle.everything(&setting, rng, &levels());
        }
    }
    oracle.finish(60_000);
}

/// Lists of any length: also all surfaces at the start.
#[test]
fn starts_in_large_models() {
    let mut tally = Tally::new("rays that start on surfaces of large models");
    for seed in 0..4 {
        let rng = &mut Random::new(12 << 40 | seed);
        for setting in settings(rng, 60) {
            starts::follow(&setting, rng.pick(&levels()), rng, &mut tally);
        }
    }
    tally.finish(16_000);
}

/// First hits in unions of more leaves than have tables of normals.
#[test]
fn first_hits_in_very_large_unions() {
    let program = Arc::new(Program::compile(&scale::spheres(70_000, 4)).unwrap());
    let (packets, weave) = (Packets::new(program.clone()), Weave::new(program));
    let rng = &mut Random::new(14);
    // rays from afar are left to the weave
    let near = |ray: &Ray| ray.origin.length() < 1e6;
    let rays: RayBatch = std::iter::repeat_with(|| ray(rng)).filter(near).take(2001).collect();
    let window = Window::new(0.0, f64::INFINITY).unwrap();
    let mut found = [FirstHitColumns::new(2001), FirstHitColumns::new(2001)];
    let mut scratch = packets.scratch();
    packets.nearest(rays.rays(), window, &mut scratch, &mut found[0].hits());
    weave.nearest(rays.rays(), window, &mut weave.scratch(), &mut found[1].hits());
    let bits = |found: &FirstHitColumns| {
        let FirstHitColumns { t, normal: [x, y, z], .. } = found;
        [t, x, y, z].map(|column| column.iter().map(|value| value.to_bits()).collect::<Vec<u64>>())
    };
    let [packets, weave] = &found;
    assert_eq!(bits(packets), bits(weave));
    assert_eq!((&packets.face, &packets.before, &packets.after), (&weave.face, &weave.before, &weave.after));
    assert!(packets.face.iter().filter(|&&face| face >= 0).count() > 1000);
    // rays that start inside a sphere are left to the weave: about a fifth of those that start within the cube
    assert!(!lanes() || scratch.fallback_leaf_count() < 4000, "{}", scratch.fallback_leaf_count());
}

/// True if this build and processor have lanes.
fn lanes() -> bool {
    Packets::new(Arc::new(Program::compile(&sphere(1.0)).unwrap())).uses_lanes()
}

/// Rays that leave the bore of a tube through its wall, close to the end and at so small an angle that the piece of wall up to the
/// end is within the tolerance of the bore.
#[test]
fn rays_that_graze_the_end_of_a_bore() {
    let tube = shape("tube", &[("outer_radius", 0.2), ("inner_radius", 0.125), ("height", 0.5)]);
    let grid = |k: usize| Vec3::new((k % 4) as f64, (k / 4 % 4) as f64, (k / 16) as f64);
    let at = |k: usize| grid(k) * Vec3::new(0.5, 0.5, 0.7) - Vec3::splat(0.75);
    let solid = Solid::union((0..64).map(|k| tube.translate(at(k))));
    let mut oracle = Oracle::new("rays that graze the end of a bore");
    for seed in 0..8 {
        let rng = &mut Random::new(15 << 40 | seed);
        let ray = |_| {
            let angle = rng.between(0.0, std::f64::consts::TAU);
            let outwards = Vec3::new(libm::cos(angle), libm::sin(angle), 0.0);
            let before = libm::pow(10.0, rng.between(-6.0, -2.0));
            let on_wall = at(rng.below(16)) + 0.125 * outwards + Vec3::Z * (0.25 - before);
            let direction = Vec3::Z + libm::pow(10.0, rng.between(-12.0, -7.0)) * outwards;
            Ray::new(on_wall - direction, direction)
        };
        let rays = (0..500).map(ray).collect();
        let regions = vec![Region { name: "tubes".to_owned(), solid: solid.clone(), medium: 1 }];
        let Some(setting) = Setting::new(regions, rays, "tubes".to_owned()) else { continue };
        oracle.lists(&setting, &mut Random::new(seed));
    }
    oracle.finish(if lanes() { 4000 } else { 0 });
}

/// Few leaves are left to the scalar kernels, and few rays to the weave.
#[test]
fn leaves_of_large_models_are_in_lanes() {
    if lanes() {
        for solid in [scale::spheres(2000, 1), scale::plate(2000), scale::sponge(2000), scale::parts(2000, 1)]
        {
            let packets = Packets::new(Arc::new(Program::compile(&solid).unwrap()));
            let rng = &mut Random::new(13);
            let rays: RayBatch = (0..1000)
                .map(|_| {
                    let from = 4.0 * rng.direction();
                    Ray::new(from, rng.point(0.9) - from)
                })
                .collect();
            let (mut scratch, mut crossings) = (packets.scratch(), 0);
            packets.crossings(rays.rays(), &Query::default(), &mut scratch, &mut |answer: RayAnswer<'_>| {
                crossings += answer.crossings.len();
            });
            let leaves = scratch.fallback_leaf_count();
            assert!(crossings > 1000 && leaves < 20, "{crossings} {leaves}");
            let mut found = FirstHitColumns::new(1000);
            packets.nearest(rays.rays(), Window::ALL, &mut scratch, &mut found.hits());
            let leaves = scratch.fallback_leaf_count() - leaves;
            let is_union = solid.to_string().starts_with("union");
            assert!(!is_union || leaves < 20, "{leaves} for first hits");
        }
    }
}
