//! The models of the benchmark, built in code.

use rayweave_math::{Affine, Vec3};
use rayweave_model::{Program, Region, Solid};
use rayweave_shape::primitive::{Value, build};
use std::sync::Arc;

/// A model with the half width of the cube that its rays pass through.
pub struct Scene {
    pub name: &'static str,
    pub program: Arc<Program>,
    pub half: f64,
}

type Made = Result<Scene, Box<dyn std::error::Error>>;

/// The name of a model with the function that builds it.
type Entry = (&'static str, fn() -> Made);

/// All models.
pub const SCENES: &[Entry] = &[
    ("die", die),
    ("lens", lens),
    ("boxes", boxes),
    ("plate", plate),
    ("lattice", lattice),
    ("spheres 1e3", || spheres("spheres 1e3", 1_000)),
    ("spheres 1e5", || spheres("spheres 1e5", 100_000)),
    ("spheres 1e6", || spheres("spheres 1e6", 1_000_000)),
    ("rings", rings),
];

/// Numbers from 0 to 1 by splitmix64.
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A point of the cube with a half width.
    pub fn point(&mut self, half: f64) -> Vec3 {
        let mut next = || half * (2.0 * self.next() - 1.0);
        Vec3::new(next(), next(), next())
    }
}

fn shape(name: &str, arguments: &[(&str, Value)]) -> Result<Solid, Box<dyn std::error::Error>> {
    Ok(build(name, arguments)?.into())
}

fn ball(radius: f64) -> Result<Solid, Box<dyn std::error::Error>> {
    shape("sphere", &[("radius", radius.into())])
}

fn block(lo: Vec3, hi: Vec3) -> Result<Solid, Box<dyn std::error::Error>> {
    shape("box_from_corners", &[("lo", lo.into()), ("hi", hi.into())])
}

fn rod(radius: f64, height: f64) -> Result<Solid, Box<dyn std::error::Error>> {
    shape("cylinder", &[("radius", radius.into()), ("height", height.into())])
}

fn scene(name: &'static str, regions: Vec<Solid>, half: f64) -> Made {
    let region = |(k, solid): (usize, Solid)| Region { name: format!("r{k}"), solid, medium: k as u32 + 1 };
    let regions: Vec<Region> = regions.into_iter().enumerate().map(region).collect();
    Ok(Scene { name, program: Arc::new(Program::compile_regions(&regions)?), half })
}

/// The die of `models/die.toml`: a rounded cube with placed pips and a layer of ink.
fn die() -> Made {
    const P: f64 = 0.48;
    let faces: [(&str, f64, Vec3, &[[f64; 2]]); 6] = [
        ("x", 180.0, -Vec3::Z, &[[0.0, 0.0]]),
        ("x", -90.0, Vec3::Y, &[[-P, -P], [P, P]]),
        ("y", 90.0, Vec3::X, &[[0.0, 0.0], [-P, -P], [P, P]]),
        ("y", -90.0, -Vec3::X, &[[-P, -P], [P, -P], [-P, P], [P, P]]),
        ("x", 90.0, -Vec3::Y, &[[0.0, 0.0], [-P, -P], [P, -P], [-P, P], [P, P]]),
        ("z", 0.0, Vec3::Z, &[[-P, -P], [P, -P], [-P, 0.0], [P, 0.0], [-P, P], [P, P]]),
    ];
    let pips = |radius: f64| -> Result<Solid, Box<dyn std::error::Error>> {
        let pip = ball(radius)?.apply(Affine::scale(Vec3::new(1.0, 1.0, 0.7)));
        let face = |(axis, angle, at, places): &(&str, f64, Vec3, &[[f64; 2]])| {
            let maps: Vec<Affine> =
                places.iter().map(|&[x, y]| Affine::translate(Vec3::new(x, y, 0.0))).collect();
            let axis = match *axis {
                "x" => Vec3::X,
                "y" => Vec3::Y,
                _ => Vec3::Z,
            };
            pip.clone().place(maps).apply(Affine::rotation(axis, *angle).then(&Affine::translate(*at)))
        };
        Ok(Solid::union(faces.iter().map(face).collect::<Vec<_>>()))
    };
    let blank = block(Vec3::splat(-1.0), Vec3::splat(1.0))? & ball(1.35)?;
    let body = blank - pips(0.21)?;
    let dye = body.clone() & pips(0.23)?;
    scene("die", vec![body, dye], 1.2)
}

/// A cemented doublet in a barrel: three spheres and a cylinder, one sphere common to both glasses.
fn lens() -> Made {
    let at = |radius: f64, z: f64| -> Result<Solid, Box<dyn std::error::Error>> {
        Ok(ball(radius)?.apply(Affine::translate(z * Vec3::Z)))
    };
    let edge = rod(12.5, 40.0)?;
    let crown = at(61.5, 61.5)? & at(44.6, -38.6)? & edge.clone();
    let flint = (edge - at(44.6, -38.6)?) & at(129.9, -121.4)?;
    let barrel = (rod(15.0, 14.0)? - rod(12.5, 50.0)?).apply(Affine::translate(4.0 * Vec3::Z));
    scene("lens", vec![crown, flint, barrel], 14.0)
}

/// A cryostat with liquid argon and sensors along one wall.
fn boxes() -> Made {
    let cryostat = block(Vec3::new(-105.0, -55.0, -55.0), Vec3::new(105.0, 55.0, 55.0))?;
    let argon = block(Vec3::new(-100.0, -50.0, -50.0), Vec3::new(100.0, 50.0, 50.0))?;
    let mut regions = vec![cryostat, argon];
    for k in 0..10 {
        let x = -90.0 + 20.0 * f64::from(k);
        regions.push(block(Vec3::new(x - 5.0, -50.0, -30.0), Vec3::new(x + 5.0, -49.0, 30.0))?);
    }
    scene("boxes", regions, 105.0)
}

/// A plate with 32 x 32 holes.
fn plate() -> Made {
    let plate = block(Vec3::new(-33.0, -33.0, -1.0), Vec3::new(33.0, 33.0, 1.0))?;
    let mut holes = Vec::new();
    for k in 0..1024 {
        let at = Vec3::new(-31.0 + 2.0 * f64::from(k % 32), -31.0 + 2.0 * f64::from(k / 32), 0.0);
        holes.push(rod(0.7, 4.0)?.apply(Affine::translate(at)));
    }
    scene("plate", vec![plate - Solid::union(holes)], 30.0)
}

/// A lattice of 100 x 100 x 10 placed bricks, each with a bore and a dimple.
fn lattice() -> Made {
    let dimple = ball(0.2)?.apply(Affine::translate(Vec3::new(0.1, 0.2, 0.4)));
    let brick = block(Vec3::splat(-0.4), Vec3::splat(0.4))? - rod(0.2, 2.0)? - dimple;
    let maps: Vec<Affine> = (0..100_000)
        .map(|k| {
            let (x, y, z) = (f64::from(k % 100), f64::from(k / 100 % 100), f64::from(k / 10_000));
            Affine::rotation(Vec3::new(1.0, 0.3, 0.2), x + 2.0 * y)
                .then(&Affine::translate(1.5 * Vec3::new(x - 50.0, y - 50.0, z - 5.0)))
        })
        .collect();
    scene("lattice", vec![brick.place(maps)], 70.0)
}

fn spheres(name: &'static str, count: usize) -> Made {
    let mut numbers = Numbers(count as u64);
    // about 5 % of the cube is inside
    let size = 0.35 / libm::cbrt(count as f64);
    let mut balls = Vec::with_capacity(count);
    for _ in 0..count {
        let radius = size * (0.5 + numbers.next());
        balls.push(ball(radius)?.apply(Affine::translate(numbers.point(1.0))));
    }
    scene(name, vec![Solid::union(balls)], 1.0)
}

/// 1,000 rings in all directions.
fn rings() -> Made {
    let mut numbers = Numbers(7);
    let mut rings = Vec::new();
    for _ in 0..1_000 {
        let major = 0.03 + 0.03 * numbers.next();
        let ring = shape("torus", &[("major", major.into()), ("minor", (0.3 * major).into())])?;
        let turn = Affine::rotation(numbers.point(1.0).normalize_or(Vec3::X), 360.0 * numbers.next());
        rings.push(ring.apply(turn.then(&Affine::translate(numbers.point(1.0)))));
    }
    scene("rings", vec![Solid::union(rings)], 1.0)
}
