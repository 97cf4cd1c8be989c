//! Shared helpers of the tests: shapes by name, evaluators, pictures as text.

#![allow(dead_code, reason = "each test file uses its part")]

use rayweave_model::{Program, Region, Solid};
use rayweave_render::{Camera, Image, PixelGrid, RenderOptions, Run, Size, render};
use rayweave_shape::primitive::{Value, build};
use rayweave_trace::Weave;
use std::num::NonZeroUsize;
use std::sync::Arc;

pub fn shape(name: &str, arguments: &[(&str, f64)]) -> Solid {
    let value = |&(name, value)| (name, Value::Number(value));
    let arguments: Vec<_> = arguments.iter().map(value).collect();
    Solid::from(build(name, &arguments).unwrap())
}

pub fn sphere(radius: f64) -> Solid {
    shape("sphere", &[("radius", radius)])
}

/// A box between two corners.
pub fn block(lo: [f64; 3], hi: [f64; 3]) -> Solid {
    let [lo, hi] = [lo, hi].map(|corner| Value::Vector(corner.to_vec()));
    Solid::from(build("box_from_corners", &[("lo", lo), ("hi", hi)]).unwrap())
}

pub fn weave(solid: &Solid) -> Weave {
    Weave::new(Arc::new(Program::compile(solid).unwrap()))
}

/// An evaluator of regions with distinct media.
pub fn weave_of(solids: &[Solid]) -> Weave {
    let regions: Vec<Region> = (solids.iter().zip(1..))
        .map(|(solid, k)| Region { name: format!("region {k}"), solid: solid.clone(), medium: k })
        .collect();
    Weave::new(Arc::new(Program::compile_regions(&regions).unwrap()))
}

pub fn size(width: u32, height: u32) -> Size {
    Size::new(width, height).unwrap()
}

pub fn run(threads: usize) -> Run<'static> {
    Run { threads: NonZeroUsize::new(threads), ..Run::default() }
}

pub fn draw(weave: &Weave, camera: &Camera, settings: &RenderOptions) -> Image {
    render(weave, camera, settings, &mut run(1)).unwrap()
}

/// A plane as rows of letters.
pub fn art<T>(plane: &PixelGrid<T>, letter: impl Fn(&T) -> char) -> Vec<String> {
    plane.rows().map(|row| row.iter().map(&letter).collect()).collect()
}
