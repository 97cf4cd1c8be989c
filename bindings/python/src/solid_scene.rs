//! A single solid as a scene and as a compiled model of one region.

use std::sync::Arc;

use rayweave::Compiled;
use rayweave::model::{Program, Solid};
use rayweave::scene::{Colour, Medium, RenderSettings, Scene, SceneRegion, Unit};

/// A compiled solid as a model of one region.
pub fn compiled_of(program: Arc<Program>) -> Compiled {
    Compiled { program, media: ["world".to_owned(), "solid".to_owned()].into() }
}

/// The scene of a single solid.
pub fn scene_of(solid: &Solid) -> Scene {
    let name = "solid".to_owned();
    let medium = |name: &str| Medium { name: name.to_owned(), ..Medium::default() };
    let region =
        SceneRegion { name: name.clone(), solid: solid.clone(), medium: 1, colour: Colour::PALETTE[0] };
    Scene {
        unit: Unit::default(),
        parameters: Vec::new(),
        solids: vec![(name, solid.clone())],
        regions: vec![region],
        media: vec![medium("world"), medium("solid")],
        camera: None,
        lights: Vec::new(),
        render: RenderSettings::default(),
        warnings: Default::default(),
    }
}
