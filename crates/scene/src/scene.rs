//! Evaluated model: solids, regions, media, camera and lights, with all numbers resolved.

use crate::colour::Colour;
use crate::diagnostic::Diagnostics;
use crate::document::{LightKind, Shading};
use crate::unit::Unit;
use rayweave_math::Vec3;
use rayweave_model::{Region, Solid};

/// A scene, ready to be compiled and drawn.
#[derive(Clone, Debug)]
pub struct Scene {
    /// The unit of all lengths.
    pub unit: Unit,
    /// The parameters with their values, in the order of the file.
    pub parameters: Vec<(String, f64)>,
    /// The solids with their names, in the order of the file.
    pub solids: Vec<(String, Solid)>,
    /// The regions in order; where they overlap, the later one has priority.
    pub regions: Vec<SceneRegion>,
    /// The media by number; 0 is the medium of the world.
    pub media: Vec<Medium>,
    /// The camera of pictures.
    pub camera: Option<Camera>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Options of pictures.
    pub render: RenderSettings,
    /// Warnings.
    pub warnings: Diagnostics,
}

/// Equality ignores warnings.
impl PartialEq for Scene {
    fn eq(&self, other: &Scene) -> bool {
        self.unit == other.unit
            && self.parameters == other.parameters
            && self.solids == other.solids
            && self.regions == other.regions
            && self.media == other.media
            && self.camera == other.camera
            && self.lights == other.lights
            && self.render == other.render
    }
}

impl Scene {
    /// A scene of regions, whose solids have the names of the regions, without parameters, camera and lights.
    pub fn from_regions(unit: Unit, regions: Vec<SceneRegion>, media: Vec<Medium>) -> Scene {
        Scene {
            unit,
            parameters: Vec::new(),
            solids: regions.iter().map(|region| (region.name.clone(), region.solid.clone())).collect(),
            regions,
            media,
            camera: None,
            lights: Vec::new(),
            render: RenderSettings::default(),
            warnings: Diagnostics::default(),
        }
    }

    /// A solid by its name.
    pub fn solid(&self, name: &str) -> Option<&Solid> {
        self.solids.iter().find(|(own, _)| own == name).map(|(_, solid)| solid)
    }

    /// The scene without the regions of opacity 0, so that pictures show their contents; unchanged
    /// if all regions have opacity 0.
    pub fn seen(mut self) -> Scene {
        let is_seen = |region: &SceneRegion| region.colour.alpha > 0;
        if self.regions.iter().any(is_seen) {
            self.regions.retain(is_seen);
        }
        self
    }

    /// The regions in the form that the compiler takes.
    pub fn model_regions(&self) -> Vec<Region> {
        let region = |region: &SceneRegion| Region {
            name: region.name.clone(),
            solid: region.solid.clone(),
            medium: region.medium,
        };
        self.regions.iter().map(region).collect()
    }

    /// The names of the media, by number.
    pub fn medium_names(&self) -> Vec<&str> {
        self.media.iter().map(|medium| medium.name.as_str()).collect()
    }
}

/// A solid made of a medium.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneRegion {
    /// Name.
    pub name: String,
    /// Its solid; the parts that later regions overlap belong to those regions.
    pub solid: Solid,
    /// The number of its medium.
    pub medium: u32,
    /// Its colour in pictures.
    pub colour: Colour,
}

/// Material of a region.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Medium {
    /// Its name.
    pub name: String,
    /// Refractive index, if given.
    pub index: Option<f64>,
    /// The colour of regions made of it.
    pub colour: Option<Colour>,
    /// Other numeric properties.
    pub numbers: Vec<(String, f64)>,
}

impl Medium {
    /// A numeric property; `None` if the medium has none of this name.
    #[must_use]
    pub fn number(&self, name: &str) -> Option<f64> {
        self.numbers.iter().find(|(own, _)| own == name).map(|(_, value)| *value)
    }
}

/// The camera of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// Projection.
    pub projection: Projection,
    /// Position of the camera.
    pub position: Vec3,
    /// The point in the middle of the picture; must differ from the position.
    pub target: Vec3,
    /// The direction that is up in the picture; must not be parallel to the direction of view.
    pub up: Vec3,
    /// Width and height of the picture in pixels.
    pub size: Option<(u32, u32)>,
}

/// Projection of space onto the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Perspective projection.
    Perspective {
        /// The vertical field of view in degrees, between 0 and 180.
        fov: f64,
    },
    /// Orthographic projection.
    Orthographic {
        /// The height of the picture in the unit of the model, > 0.
        height: f64,
    },
}

/// A light.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Position or direction; directions are not zero and need not be of unit length.
    pub kind: LightKind<Vec3>,
    /// Intensity, >= 0.
    pub intensity: f64,
    /// Its colour.
    pub colour: Colour,
}

/// Options of pictures; the renderer has defaults for those that are `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderSettings {
    /// The colour of the background.
    pub background: Option<Colour>,
    /// Shading style.
    pub shading: Option<Shading>,
    /// Whether edges are drawn.
    pub edges: Option<bool>,
    /// Whether there are shadows.
    pub shadows: Option<bool>,
    /// Samples per pixel along x and along y: 1 to 16.
    pub samples: Option<u32>,
}
