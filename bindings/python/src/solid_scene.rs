//! A single solid as a scene and as a compiled model of one region.

use std::sync::Arc;

use rayweave::Compiled;
use rayweave::model::{Program, Solid};
use rayweave::scene::{Colour, Medium, Scene, SceneRegion, Unit};

/// A compiled solid as a model of one region.
pub fn compiled_of(program: Arc<Program>) -> Compiled {
    Compiled { program, media: ["world".to_owned(), "solid".to_owned()].into() }
}

/// The scene of a single solid.
pub fn scene_of(solid: &Solid) -> Scene {
    let name = "solid".to_owned();
    let medium = |name: &str| Medium { name: name.to_owned(), ..Medium::default() };
    let region = SceneRegion { name, solid: solid.clone(), medium: 1, colour: Colour::PALETTE[0] };
    Scene::from_regions(Unit::default(), vec![region], vec![medium("world"), medium("solid")])
}
