//! Pictures of scenes: from what a model file says, and what is wished besides, to cameras, settings and PNG files.
//!
//! [`Cut`], [`Explosion`] and [`Opacity`] change a scene before it is compiled, so that more of it is seen; a [`Sheet`] holds several views
//! and a legend.

mod cut;
mod explode;
mod opacity;
mod sheet;

pub use cut::Cut;
pub use explode::Explosion;
pub use opacity::Opacity;
pub use sheet::{Placed, Sheet, SheetKind};

use crate::{Compiled, Error};
use rayweave_model::{Evaluator, RegionId, RegionInfo};
use rayweave_render::{
    Background, Camera, IdKind, Image, Light, LightKind, Lines, Plane, Projection, Rgba, Run, Settings, Size,
    Style, View, depth, ids, normals, png, region_colour, render,
};
use rayweave_scene::{self as scene, Scene, SceneRegion};
use std::str::FromStr;

/// What is wished of a picture. What is `None` is taken from the model file, and if that says nothing, it is as
/// [`Wishes::default`] and [`Settings::new`] have it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wishes {
    /// Width and height; 1280 x 720 if nobody says anything.
    pub size: Option<Size>,
    /// The direction of view, from where all of the model is seen; without it the file's camera, else [`View::Iso`].
    pub view: Option<View>,
    /// The vertical field of view in degrees of a camera that is made for `view`. Without it, views that are asked for are
    /// orthographic, and the one that stands in for a missing camera has [`FIELD_OF_VIEW`].
    pub field_of_view: Option<f64>,
    /// How surfaces are shaded.
    pub style: Option<Style>,
    /// Whether edges are drawn.
    pub edges: Option<bool>,
    /// Whether there are shadows. If so and the file has no light, there is one from the upper left behind the camera.
    pub shadows: Option<bool>,
    /// Samples along each side of a pixel, 1 to [`Settings::MOST_SAMPLES`].
    pub samples: Option<u32>,
}

/// The vertical field of view, in degrees, of a camera that nobody described.
pub const FIELD_OF_VIEW: f64 = 30.0;

/// What a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureKind {
    /// The model as people see it.
    #[default]
    Colour,
    /// The distance to the first surface.
    Depth,
    /// Its normal.
    Normal,
    /// The number of its region.
    Id,
}

impl PictureKind {
    /// All of them, with their names at every door.
    pub const ALL: [(PictureKind, &'static str); 4] = [
        (PictureKind::Colour, "colour"),
        (PictureKind::Depth, "depth"),
        (PictureKind::Normal, "normal"),
        (PictureKind::Id, "id"),
    ];
}

impl FromStr for PictureKind {
    type Err = Error;

    fn from_str(name: &str) -> Result<PictureKind, Error> {
        let mut all = PictureKind::ALL.into_iter();
        let found = all.find(|(_, own)| *own == name);
        let names = PictureKind::ALL.into_iter().map(|(_, own)| own);
        found.map(|(kind, _)| kind).ok_or_else(|| Error::unknown("kind of picture", name, names))
    }
}

/// A drawn picture: colours or plain numbers, one per pixel.
#[derive(Clone, Debug)]
pub enum Picture {
    /// Colours.
    Colour(Image),
    /// Distances; +inf for a miss.
    Depth(Plane<f64>),
    /// Unit normals; NaN for a miss.
    Normal(Plane<[f64; 3]>),
    /// Numbers of regions; 0 for a miss.
    Id(Plane<i32>),
}

impl Picture {
    /// Draws a compiled scene.
    ///
    /// # Errors
    ///
    /// [`crate::ErrorKind::Value`] for settings out of range, [`crate::ErrorKind::Cancelled`].
    pub fn draw<E: Evaluator>(
        kind: PictureKind,
        evaluator: &E,
        camera: &Camera,
        settings: &Settings,
        run: &mut Run<'_>,
    ) -> Result<Picture, Error> {
        let size = settings.size;
        Ok(match kind {
            PictureKind::Colour => Picture::Colour(render(evaluator, camera, settings, run)?),
            PictureKind::Depth => Picture::Depth(depth(evaluator, camera, size, run)?),
            PictureKind::Normal => Picture::Normal(normals(evaluator, camera, size, run)?),
            PictureKind::Id => Picture::Id(ids(evaluator, camera, size, IdKind::Region, run)?),
        })
    }

    /// Width and height.
    pub fn size(&self) -> Size {
        match self {
            Picture::Colour(plane) => plane.size(),
            Picture::Depth(plane) => plane.size(),
            Picture::Normal(plane) => plane.size(),
            Picture::Id(plane) => plane.size(),
        }
    }

    /// The picture as a PNG file; see [`png`] about numbers.
    pub fn to_png(&self) -> Vec<u8> {
        match self {
            Picture::Colour(image) => png::encode(image),
            Picture::Depth(plane) => png::encode_depth(plane),
            Picture::Normal(plane) => png::encode_normals(plane),
            Picture::Id(plane) => png::encode_ids(plane, IdKind::Region),
        }
    }
}

/// The camera and the settings for a picture of a compiled scene.
///
/// # Errors
///
/// [`crate::ErrorKind::Value`] for a size or field of view out of range.
pub fn arrange(scene: &Scene, compiled: &Compiled, wishes: &Wishes) -> Result<(Camera, Settings), Error> {
    let size = size(scene, wishes)?;
    let camera = camera(scene, compiled, wishes, size)?;
    let mut settings = Settings::new(size);
    let said = &scene.render;
    settings.style = wishes.style.or(said.shading.map(style)).unwrap_or(settings.style);
    if !wishes.edges.or(said.edges).unwrap_or(true) {
        settings.lines = None::<Lines>;
    }
    settings.samples = wishes.samples.or(said.samples).unwrap_or(settings.samples);
    if let Some(colour) = said.background {
        settings.background = Background::Colour(rgba(colour));
    }
    settings.colours = colours(scene, compiled);
    settings.lights = scene.lights.iter().map(light).collect();
    settings.shadows = wishes.shadows.or(said.shadows).unwrap_or(false);
    if settings.shadows && settings.lights.is_empty() {
        settings.lights.push(light_of_camera(&camera));
    }
    Ok((camera, settings))
}

fn size(scene: &Scene, wishes: &Wishes) -> Result<Size, Error> {
    if let Some(size) = wishes.size {
        return Ok(size);
    }
    let said = scene.camera.as_ref().and_then(|camera| camera.size);
    let (width, height) = said.unwrap_or((1280, 720));
    Ok(Size::new(width, height)?)
}

fn camera(scene: &Scene, compiled: &Compiled, wishes: &Wishes, size: Size) -> Result<Camera, Error> {
    let program = &compiled.program;
    let fitted = match (wishes.view, &scene.camera, wishes.field_of_view) {
        (None, Some(camera), None) => return own_camera(camera),
        (Some(view), _, None) => return Ok(view.fit(program, size)),
        (view, _, degrees) => {
            view.unwrap_or_default().fit_perspective(program, size, degrees.unwrap_or(FIELD_OF_VIEW))
        }
    };
    Ok(fitted?)
}

fn own_camera(camera: &scene::Camera) -> Result<Camera, Error> {
    let projection = match camera.projection {
        scene::Projection::Perspective { fov } => Projection::Perspective { field_of_view: fov },
        scene::Projection::Orthographic { height } => Projection::Orthographic { height },
    };
    let (position, target, up) = (camera.position, camera.target, camera.up);
    Ok(Camera::new(position, target, up, projection)?)
}

/// The colours of the program's regions: those of the scene, or of the region whose solid is taken alone.
fn colours(scene: &Scene, compiled: &Compiled) -> Vec<Rgba> {
    let colour = |(k, region): (usize, &RegionInfo)| {
        let is_same = |own: &&SceneRegion| own.name == region.name && own.medium == region.medium;
        let in_place = scene.regions.get(k).filter(is_same);
        let same_medium = |own: &&SceneRegion| own.medium == region.medium;
        let own = in_place.or_else(|| scene.regions.iter().rfind(same_medium));
        match own {
            Some(own) => rgba(own.colour),
            None => region_colour(&[], RegionId::from(k + 1)),
        }
    };
    let regions = compiled.program.regions().iter().enumerate();
    regions.map(colour).collect()
}

fn rgba(colour: scene::Colour) -> Rgba {
    Rgba::from([colour.red, colour.green, colour.blue, colour.alpha])
}

fn style(shading: scene::Shading) -> Style {
    match shading {
        scene::Shading::Gooch => Style::Gooch,
        scene::Shading::Headlight => Style::Headlight,
    }
}

fn light(light: &scene::Light) -> Light {
    Light {
        kind: match light.kind {
            scene::LightKind::Direction(along) => LightKind::Direction(along),
            scene::LightKind::Position(at) => LightKind::Position(at),
        },
        intensity: light.intensity,
        colour: rgba(light.colour),
    }
}

/// Light from the upper left behind the camera.
fn light_of_camera(camera: &Camera) -> Light {
    Light::along(camera.forward() + 0.5 * camera.right() - 0.8 * camera.up())
}
