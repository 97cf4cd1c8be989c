//! GDML import, against results of Geant4, closed forms and malformed files.

#[path = "gdml/files.rs"]
mod files;
#[path = "gdml/malformed.rs"]
mod malformed;
#[path = "gdml/solids.rs"]
mod solids;
#[path = "gdml/structure.rs"]
mod structure;
#[path = "gdml/warned.rs"]
mod warned;
#[path = "gdml/written.rs"]
mod written;

use rayweave_formats::{Format, Imported, Options};
use rayweave_math::Vec3;
use rayweave_model::{Evaluator, Program, Query, RayBatch};
use rayweave_scene::Diagnostics;
use rayweave_shape::Ray;
use rayweave_trace::Weave;
use std::sync::Arc;

/// Reads a text.
fn parse(text: &str) -> Result<Imported, Diagnostics> {
    rayweave_formats::parse(text, Format::Gdml, &[], &Options::default())
}

/// A file with the given definitions, solids and structure, and the boilerplate that every file needs.
fn model(define: &str, solids: &str, structure: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<gdml><define>{define}</define>\n<materials><material name=\"Al\" Z=\"13\">\
         <D value=\"2.7\"/><atom value=\"26.98\"/></material></materials>\n<solids>{solids}</solids>\n\
         <structure>{structure}</structure>\n<setup name=\"Default\" version=\"1.0\"><world ref=\"World\"/></setup></gdml>"
    )
}

/// Names of the regions along a ray, each with its start; the last one is the outside.
fn along(imported: &Imported, origin: [f64; 3], direction: [f64; 3]) -> Vec<(f64, String)> {
    // each region gets its own medium, since only changes of medium are crossings
    let mut regions = imported.scene.model_regions();
    regions.iter_mut().zip(1..).for_each(|(region, medium)| region.medium = medium);
    let program = Arc::new(Program::compile_regions(&regions).unwrap());
    let ray = Ray { origin: Vec3::from_array(origin), direction: Vec3::from_array(direction) };
    let answer = Weave::new(program).collect(RayBatch::from_iter([ray]).rays(), &Query::default()).unwrap();
    let name = |region: rayweave_model::RegionId| match region.index() {
        0 => "-".to_owned(),
        k => imported.scene.regions[k - 1].name.clone(),
    };
    answer.crossings.iter().map(|crossing| (crossing.t, name(crossing.after))).collect()
}

/// Volume of a solid, by `n` times `n` rays along z through the cell centres of a grid over its bounds.
fn volume(program: &Arc<Program>, n: usize) -> f64 {
    let bounds = program.prototypes()[0].bounds;
    let size = bounds.hi - bounds.lo;
    let at = |axis: usize, k: usize| bounds.lo[axis] + (k as f64 + 0.5) / n as f64 * size[axis];
    let start = bounds.lo.z - size.z;
    let rays =
        (0..n * n).map(|k| Ray { origin: Vec3::new(at(0, k % n), at(1, k / n), start), direction: Vec3::Z });
    let answer =
        Weave::new(program.clone()).collect(RayBatch::from_iter(rays).rays(), &Query::default()).unwrap();
    let signed =
        answer.crossings.iter().map(|crossing| if crossing.enters() { -crossing.t } else { crossing.t });
    signed.sum::<f64>() * size.x * size.y / (n * n) as f64
}
