//! Random models: generic ones, and ones with faces that coincide by construction.

use crate::Random;
use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_model::{CompileError, Program, Region, Solid};
use rayweave_shape::primitive::{Primitive, Value, build};
use std::fmt;
use std::sync::Arc;

/// The arrangement of the parts of a model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Style {
    /// Arbitrary positions: no two faces coincide except those of shared parts.
    Generic,
    /// On a grid with pitch 0.5 and few sizes: many faces, edges and axes coincide.
    Grid,
    /// Like `Grid`, with planes only.
    Planes,
}

/// A random model with the frame in which it was built.
#[derive(Clone, Debug)]
pub struct Model {
    /// The solids with their media, in order.
    pub regions: Vec<Region>,
    /// From the frame in which it was built to the world.
    pub frame: Affine,
    /// The arrangement of its parts.
    pub style: Style,
}

impl Model {
    /// A model with one solid or several regions; every second model has a random frame.
    pub fn random(rng: &mut Random, style: Style) -> Model {
        let frame = if rng.chance(0.5) { Affine::IDENTITY } else { motion(rng) };
        let count = if rng.chance(0.7) { 1 } else { 2 + rng.below(5) };
        let depth = (40.0 * rng.uniform() * rng.uniform()) as usize / count + usize::from(count == 1);
        Model::with(rng, style, frame, count, depth)
    }

    /// Like [`Model::random`], with few leaves.
    pub fn small(rng: &mut Random, style: Style) -> Model {
        let frame = if rng.chance(0.5) { Affine::IDENTITY } else { motion(rng) };
        let count = if rng.chance(0.8) { 1 } else { 2 };
        let depth = 1 + rng.below(5 / count);
        Model::with(rng, style, frame, count, depth)
    }

    fn with(rng: &mut Random, style: Style, frame: Affine, count: usize, depth: usize) -> Model {
        let region = |k: usize| {
            let solid = Maker::new(rng, style).solid(depth).apply(frame);
            Region { name: format!("r{k}"), solid, medium: 1 + rng.below(3) as u32 }
        };
        Model { regions: (0..count).map(region).collect(), frame, style }
    }

    /// One solid as a model.
    pub fn of(solid: Solid) -> Model {
        let region = Region { name: "solid".to_owned(), solid, medium: 1 };
        Model { regions: vec![region], frame: Affine::IDENTITY, style: Style::Generic }
    }

    /// The compiled model; panics if that fails.
    pub(crate) fn compiled(&self) -> Arc<Program> {
        compiled(Program::compile_regions(&self.regions))
    }

    /// The compiled model.
    pub fn compile(&self) -> Result<Arc<Program>, CompileError> {
        Program::compile_regions(&self.regions).map(Arc::new)
    }
}

impl fmt::Display for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for region in &self.regions {
            let text = region.solid.to_string();
            // long texts are cut off: the seed identifies the model
            let short: String = text.chars().take(500).collect();
            writeln!(f, "{} (medium {}): {short}", region.name, region.medium)?;
        }
        Ok(())
    }
}

/// Unwraps a program. Every model of the suite is valid, so an error is a bug.
pub(crate) fn compiled(program: Result<Program, CompileError>) -> Arc<Program> {
    Arc::new(program.unwrap_or_else(|e| panic!("a valid model is rejected: {e}")))
}

/// A random solid of about the given depth.
pub fn solid(rng: &mut Random, style: Style, depth: usize) -> Solid {
    Maker::new(rng, style).solid(depth)
}

/// A rotation and a translation.
pub fn motion(rng: &mut Random) -> Affine {
    let turn = Affine::rotation(rng.direction(), rng.between(-180.0, 180.0));
    turn.then(&Affine::translate(rng.point(3.0)))
}

/// A shape by its name and numbers.
pub fn shape(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let arguments: Vec<_> = arguments.iter().map(|&(name, v)| (name, Value::Number(v))).collect();
    made(name, &arguments)
}

/// The box between two corners.
pub fn block(lo: Vec3, hi: Vec3) -> Solid {
    made("box_from_corners", &[("lo", lo.into()), ("hi", hi.into())])
}

/// The half-space `normal . p < offset`.
pub fn half_space(normal: Vec3, offset: f64) -> Solid {
    made("half_space", &[("normal", normal.into()), ("offset", offset.into())])
}

fn slab(normal: Vec3, lo: f64, hi: f64) -> Solid {
    made("slab", &[("normal", normal.into()), ("lo", lo.into()), ("hi", hi.into())])
}

/// Makes a shape. The suite uses valid arguments only, so an error is a bug.
fn made(name: &str, arguments: &[(&str, Value)]) -> Solid {
    Solid::from(build(name, arguments).unwrap_or_else(|e| panic!("{name}: {e}")))
}

struct Maker<'r> {
    rng: &'r mut Random,
    style: Style,
    /// Parts made before, for reuse.
    pool: Vec<Solid>,
    /// The number of shapes of the solid with all placements expanded.
    size: usize,
}

/// Upper bound of the number of shapes of a solid, with all placements expanded.
const MAX_SHAPES: usize = 300;

impl<'r> Maker<'r> {
    fn new(rng: &'r mut Random, style: Style) -> Self {
        Maker { rng, style, pool: Vec::new(), size: 0 }
    }

    fn solid(&mut self, depth: usize) -> Solid {
        let mut solid = self.operand(3);
        for _ in 0..depth {
            solid = self.step(solid);
            if self.rng.chance(0.2) {
                self.pool.push(solid.clone());
            }
        }
        solid
    }

    /// Adds one level: an operator, a complement, a map, a name or placements.
    fn step(&mut self, solid: Solid) -> Solid {
        match self.rng.below(14) {
            0..3 => solid | self.operand(3),
            3..5 => solid - self.operand(3),
            5 => self.operand(3) - solid,
            6 => solid & self.operand(3),
            7 => solid & !self.operand(2),
            8 => solid ^ self.operand(3),
            9 => self.many(solid),
            10 => !solid,
            11 => solid.apply(self.map()),
            12 => solid.named("part"),
            _ if self.size * 3 < MAX_SHAPES => {
                let count = 2 + self.rng.below(2);
                self.size *= count;
                let maps: Vec<Affine> = (0..count).map(|_| self.map()).collect();
                solid.place(maps)
            }
            _ => self.operand(2) | solid,
        }
    }

    fn many(&mut self, solid: Solid) -> Solid {
        let mut all: Vec<Solid> = (0..2 + self.rng.below(4)).map(|_| self.operand(1)).collect();
        all.push(solid);
        match self.rng.below(4) {
            0 => Solid::intersection(all.into_iter().map(|s| !s)),
            1 => Solid::symmetric_difference(all),
            _ => Solid::union(all),
        }
    }

    /// A small solid: a shape, a reused part, or a few shapes joined.
    fn operand(&mut self, depth: usize) -> Solid {
        if depth > 0 && self.rng.chance(0.25) {
            let (a, b) = (self.operand(depth - 1), self.operand(depth - 1));
            return match self.rng.below(4) {
                0 => a | b,
                1 => a & b,
                2 => a - b,
                _ => a ^ b,
            };
        }
        if !self.pool.is_empty() && self.size < MAX_SHAPES && self.rng.chance(0.15) {
            self.size += 10;
            return self.pool[self.rng.below(self.pool.len())].clone();
        }
        self.size += 1;
        let shape = match self.style {
            Style::Generic => Solid::from(Primitive::random(|| self.rng.uniform())),
            Style::Grid if self.rng.chance(0.5) => self.curved(),
            Style::Grid | Style::Planes => self.flat(),
        };
        let map = self.map();
        if self.rng.chance(0.8) { shape.apply(map) } else { shape }
    }

    fn half(&mut self) -> f64 {
        0.5 * (self.rng.below(9) as f64 - 4.0)
    }

    fn axis(&mut self) -> Vec3 {
        self.rng.pick(&[Vec3::X, Vec3::Y, Vec3::Z, -Vec3::X, -Vec3::Y, -Vec3::Z])
    }

    fn flat(&mut self) -> Solid {
        let size = Vec3::from_array(std::array::from_fn(|_| self.rng.pick(&[0.5, 1.0, 2.0])));
        match self.rng.below(8) {
            0 => made("box", &[("size", size.into())]),
            1..4 => {
                let lo = Vec3::new(self.half(), self.half(), self.half());
                block(lo, lo + size)
            }
            4 => half_space(self.axis(), self.half()),
            5 => {
                let lo = self.half();
                slab(self.axis(), lo, lo + self.rng.pick(&[0.5, 1.0, 2.0]))
            }
            6 => shape(
                "wedge",
                &[
                    ("start_degrees", self.rng.pick(&[0.0, 90.0, -90.0, 180.0])),
                    ("sweep_degrees", self.rng.pick(&[90.0, 180.0, 270.0])),
                ],
            ),
            _ => shape("box", &[("size", size.x)]),
        }
    }

    fn curved(&mut self) -> Solid {
        let radius = self.rng.pick(&[0.5, 1.0]);
        let height = self.rng.pick(&[1.0, 2.0, f64::INFINITY]);
        match self.rng.below(9) {
            0..2 => shape("sphere", &[("radius", radius)]),
            2..5 => shape("cylinder", &[("radius", radius), ("height", height)]),
            5 => shape("cone", &[("radius1", radius), ("radius2", radius - 0.5), ("height", 1.0)]),
            6 => {
                shape("tube", &[("outer_radius", 2.0 * radius), ("inner_radius", radius), ("height", height)])
            }
            7 => shape("torus", &[("major", 1.0), ("minor", 0.5 * radius)]),
            _ => shape("prism", &[("sides", self.rng.pick(&[4.0, 6.0])), ("radius", 1.0), ("height", 1.0)]),
        }
    }

    fn map(&mut self) -> Affine {
        match self.style {
            Style::Generic => self.generic_map(),
            _ => self.grid_map(),
        }
    }

    fn generic_map(&mut self) -> Affine {
        let here = Affine::translate(self.rng.point(1.5));
        let turn = Affine::rotation(self.rng.direction(), self.rng.between(-180.0, 180.0));
        match self.rng.below(8) {
            0..2 => here,
            2..5 => turn.then(&here),
            5 => Affine::scale(self.rng.point(0.5) + Vec3::splat(1.0)).then(&here),
            6 => Affine::mirror(self.rng.direction()).then(&here),
            _ => {
                let shear = Mat3::from_cols(
                    Vec3::X + 0.3 * self.rng.point(1.0),
                    Vec3::Y + 0.3 * self.rng.point(1.0),
                    Vec3::Z,
                );
                Affine::from_linear(shear).then(&here)
            }
        }
    }

    fn grid_map(&mut self) -> Affine {
        let here = Affine::translate(Vec3::new(self.half(), self.half(), self.half()));
        match self.rng.below(8) {
            0..4 => here,
            4..6 => {
                let quarters = self.rng.pick(&[90.0, 180.0, 270.0, -90.0]);
                Affine::rotation(self.axis(), quarters).then(&here)
            }
            6 => Affine::mirror(self.axis()).then(&here),
            _ => {
                let factors = [Vec3::splat(0.5), Vec3::splat(2.0), Vec3::new(1.0, 2.0, 1.0)];
                let scale = Affine::scale(self.rng.pick(&factors));
                scale.then(&Affine::translate(0.5 * here.translation))
            }
        }
    }
}
