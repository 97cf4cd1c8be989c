//! The compared scenes.

use rayweave::render::Camera;
use rayweave::scene::{Colour, Light, LightKind, Medium, RenderSettings, Scene, SceneRegion, Shading};
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_shape::primitive::{Primitive, Value, build};

/// A scene with a name.
pub struct Comparison {
    pub name: String,
    pub scene: Scene,
}

impl Comparison {
    fn new(name: impl Into<String>, solid: Solid) -> Comparison {
        let (_, empty) = rayweave::scene::parse("rayweave = 1\n").unwrap_or_else(|p| panic!("{p}"));
        let region =
            SceneRegion { name: "all".to_owned(), solid, medium: 1, colour: Colour::new(230, 159, 0) };
        let render = RenderSettings {
            background: Some(Colour::new(205, 214, 226)),
            shading: Some(Shading::Headlight),
            edges: Some(false),
            shadows: Some(true),
            samples: Some(1),
        };
        let media = vec![Medium::default(), Medium { name: "matter".to_owned(), ..Medium::default() }];
        Comparison { name: name.into(), scene: Scene { regions: vec![region], media, render, ..empty } }
    }

    /// A light above the left shoulder of the viewer, at the same distance.
    pub fn light(&self, camera: &Camera) -> Light {
        let offset = 0.5 * camera.up() - 0.45 * camera.right();
        let at = camera.position() + camera.position().length() * offset;
        Light { kind: LightKind::Position(at), intensity: 1.0, colour: Colour::WHITE }
    }
}

/// All scenes.
pub fn all() -> Vec<Comparison> {
    let mut all = vec![
        Comparison::new("die", die() | floor(1.1)),
        Comparison::new("lens", lens()),
        Comparison::new("flange", flange()),
        Comparison::new("tori", tori()),
        Comparison::new("plate", plate(10)),
        Comparison::new("lattice", lattice(8)),
    ];
    for count in [10, 100, 1_000, 10_000] {
        all.push(Comparison::new(format!("objects-{count}"), objects(count)));
    }
    all
}

fn shape(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let value = |&(name, value)| (name, Value::Number(value));
    let arguments: Vec<_> = arguments.iter().map(value).collect();
    let built: Result<Primitive, _> = build(name, &arguments);
    Solid::from(built.unwrap_or_else(|problem| panic!("{problem}")))
}

fn ball(radius: f64) -> Solid {
    shape("sphere", &[("radius", radius)])
}

fn rod(radius: f64, height: f64) -> Solid {
    shape("cylinder", &[("radius", radius), ("height", height)])
}

fn block(x: f64, y: f64, z: f64) -> Solid {
    let half = 0.5 * Vec3::new(x, y, z);
    let corners = [("lo", Value::from(-half)), ("hi", Value::from(half))];
    Solid::from(build("box_from_corners", &corners).unwrap_or_else(|problem| panic!("{problem}")))
}

fn ring(major: f64, minor: f64) -> Solid {
    shape("torus", &[("major", major), ("minor", minor)])
}

fn floor(below: f64) -> Solid {
    block(5.0, 5.0, 0.2).translate([0.0, 0.0, -below - 0.1])
}

fn die() -> Solid {
    let bore = rod(0.5, 4.0);
    (block(2.0, 2.0, 2.0) & ball(1.35)) - &bore - bore.rotate_x(90.0) - bore.rotate_y(90.0)
}

fn lens() -> Solid {
    let ball = ball(50.0);
    ball.translate([0.0, 0.0, 47.0]) & ball.translate([0.0, 0.0, -47.0]) & rod(12.5, 40.0)
}

/// A turned part: a flange with a conical neck, a groove for a seal, a bead, and six bolt holes.
fn flange() -> Solid {
    let neck =
        shape("cone", &[("radius1", 1.6), ("radius2", 0.9), ("height", 1.6)]).translate([0.0, 0.0, 1.05]);
    let body = rod(3.0, 0.5) | neck | ring(0.9, 0.22).translate([0.0, 0.0, 1.85]);
    let seal = ring(2.0, 0.18).translate([0.0, 0.0, 0.25]);
    let holes = (0..6).map(|k| {
        let sink = shape("cone", &[("radius1", 0.2), ("radius2", 0.4), ("height", 0.25)]);
        let hole = rod(0.2, 2.0) | sink.translate([0.0, 0.0, 0.15]);
        hole.translate([2.5, 0.0, 0.0]).rotate_z(60.0 * f64::from(k))
    });
    body - seal - rod(0.6, 8.0) - Solid::union(holes)
}

fn tori() -> Solid {
    let links = (0..7).map(|k| {
        let link = ring(1.0, 0.28).rotate_x(if k % 2 == 0 { 35.0 } else { -55.0 });
        link.translate([1.25 * f64::from(k) - 3.75, 0.0, 0.0])
    });
    Solid::union(links) - block(9.0, 0.3, 0.3)
}

fn plate(rows: usize) -> Solid {
    let at = |k: usize| k as f64 - 0.5 * (rows as f64 - 1.0);
    let places = (0..rows * rows).map(|k| [at(k % rows), at(k / rows), 0.0]);
    let width = rows as f64 + 0.4;
    block(width, width, 0.5) - Solid::union(places.map(|place| rod(0.35, 1.0).translate(place)))
}

fn lattice(rows: usize) -> Solid {
    let joint = ball(0.25) | rod(0.1, 1.0) | rod(0.1, 1.0).rotate_x(90.0) | rod(0.1, 1.0).rotate_y(90.0);
    let at = |k: usize| (k % rows) as f64 - 0.5 * (rows as f64 - 1.0);
    let place = |k| Affine::translate(Vec3::new(at(k), at(k / rows), at(k / (rows * rows))));
    joint.place((0..rows * rows * rows).map(place).collect::<Vec<_>>())
}

/// `count` small solids of five kinds at random places in a cube; their sizes shrink so that the total volume
/// is about independent of the count.
fn objects(count: usize) -> Solid {
    let mut random = Random(7);
    let size = 0.9 / (count as f64).cbrt();
    Solid::union((0..count).map(|k| {
        let own = match k % 5 {
            0 => block(1.0, 1.0, 1.0) & ball(0.65),
            1 => rod(0.5, 1.0) - ball(0.35).translate([0.0, 0.0, 0.5]),
            2 => shape("cone", &[("radius1", 0.5), ("radius2", 0.1), ("height", 1.0)]) | ring(0.45, 0.15),
            3 => block(1.0, 0.8, 0.6) - rod(0.25, 2.0),
            _ => ring(0.5, 0.2) - block(0.6, 0.6, 1.0).translate([0.5, 0.5, 0.0]),
        };
        let axis = Vec3::new(random.next() - 0.5, random.next() - 0.5, random.next() - 0.4);
        let place = Vec3::new(random.next() - 0.5, random.next() - 0.5, random.next() - 0.5);
        let own = own.scale(Vec3::splat(size * (0.5 + random.next())));
        own.rotate(axis, 360.0 * random.next()).translate(2.0 * place)
    }))
}

/// Random numbers in [0, 1): xorshift64* (Vigna: "An experimental exploration of Marsaglia's xorshift
/// generators, scrambled", 2016).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11) as f64 / (1u64 << 53) as f64
    }
}
