//! Pictures of scenes: camera and settings from a model file and from options.
//!
//! [`CutAway`], [`Explosion`] and [`Opacity`] change a scene before it is compiled, to show its interior. A [`PictureSheet`]
//! contains several views and a legend.
//!
//! ```
//! use rayweave_draw::picture::{Picture, PictureKind, PictureOptions, arrange};
//! use rayweave_render::{RenderError, Run, Size, View};
//! use rayweave_scene::Compiled;
//! use rayweave_trace::Packets;
//!
//! let (_, scene) = rayweave_scene::parse("rayweave = 1\n[solid.ring]\ntorus = { major = 3, minor = 1 }")?;
//! let compiled = Compiled::new(&scene)?;
//! let options =
//!     PictureOptions { size: Some(Size::new(64, 48)?), view: Some(View::Top), ..PictureOptions::default() };
//! let (camera, settings) = arrange(&scene, &compiled, &options)?;
//! let evaluator = Packets::new(compiled.program.clone());
//! let picture = Picture::draw(PictureKind::Depth, &evaluator, &camera, &settings, &mut Run::default())?;
//! assert!(picture.to_png().starts_with(b"\x89PNG"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cut;
mod explode;
mod opacity;
mod sheet;

pub use cut::CutAway;
pub use explode::Explosion;
pub use opacity::Opacity;
pub use sheet::{PictureSheet, PlacedPicture, SheetKind, WholeModel};

use crate::DrawError;
use rayweave_error::Message;
use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_model::{Evaluator, Program, Region, RegionId, RegionInfo, memory};
use rayweave_render::{
    Background, Camera, IdKind, Image, Light, LightKind, Lines, PixelGrid, Projection, RenderError,
    RenderOptions, Rgba, Run, Size, Style, View, depth, ids, normals, png, region_colour, render,
};
use rayweave_scene::{self as scene, Compiled, Scene, SceneRegion};
use std::str::FromStr;

/// The options of a picture. `None` means the value in the model file or, if the file has none, the default of
/// [`RenderOptions::new`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PictureOptions {
    /// Width and height, 1280 x 720 by default.
    pub size: Option<Size>,
    /// The direction of view, with the whole model in the picture; by default that of the camera in the file, else [`View::Iso`].
    pub view: Option<View>,
    /// The vertical field of view, in degrees, of a camera that is fitted to the model. Without it, a `view` is orthographic, and
    /// the substitute for a missing camera has [`FIELD_OF_VIEW`].
    pub field_of_view: Option<f64>,
    /// The shading of surfaces.
    pub style: Option<Style>,
    /// True to draw edges.
    pub edges: Option<bool>,
    /// True to cast shadows. If the file has no light, one is added at the upper left behind the camera.
    pub shadows: Option<bool>,
    /// Samples along each side of a pixel, 1 to [`RenderOptions::MAX_SAMPLES`].
    pub samples: Option<u32>,
}

/// The names of the axes.
const AXES: [&str; 3] = ["x", "y", "z"];

/// The vertical field of view, in degrees, of the substitute for a missing camera.
pub const FIELD_OF_VIEW: f64 = 30.0;

/// The quantity that a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PictureKind {
    /// The shaded model.
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
    /// All kinds with their names in options.
    pub const ALL: [(PictureKind, &'static str); 4] = [
        (PictureKind::Colour, "colour"),
        (PictureKind::Depth, "depth"),
        (PictureKind::Normal, "normal"),
        (PictureKind::Id, "id"),
    ];
}

impl FromStr for PictureKind {
    type Err = DrawError;

    fn from_str(name: &str) -> Result<PictureKind, DrawError> {
        let mut all = PictureKind::ALL.into_iter();
        let found = all.find(|(_, own)| *own == name);
        let names = PictureKind::ALL.into_iter().map(|(_, own)| own);
        found
            .map(|(kind, _)| kind)
            .ok_or_else(|| DrawError::UnknownName(Message::unknown("kind of picture", name, names)))
    }
}

/// A drawn picture: one colour or number per pixel.
#[derive(Clone, Debug)]
pub enum Picture {
    /// Colours.
    Colour(Image),
    /// Distances; +inf for a miss.
    Depth(PixelGrid<f64>),
    /// Unit normals; NaN for a miss.
    Normal(PixelGrid<[f64; 3]>),
    /// Numbers of regions; 0 for a miss.
    Id(PixelGrid<i32>),
}

impl Picture {
    /// Draws a compiled scene.
    ///
    /// # Errors
    ///
    /// [`DrawError::Render`]: settings out of range, or the run was cancelled.
    pub fn draw<E: Evaluator>(
        kind: PictureKind,
        evaluator: &E,
        camera: &Camera,
        settings: &RenderOptions,
        run: &mut Run<'_>,
    ) -> Result<Picture, DrawError> {
        let size = settings.size;
        check_memory(size, kind, memory::available())?;
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

    /// The picture as a PNG file. [`png`] documents the encoding of numbers.
    pub fn to_png(&self) -> Vec<u8> {
        match self {
            Picture::Colour(image) => png::encode(image),
            Picture::Depth(plane) => png::encode_depth(plane),
            Picture::Normal(plane) => png::encode_normals(plane),
            Picture::Id(plane) => png::encode_ids(plane, IdKind::Region),
        }
    }
}

/// Rejects a picture that would not fit into memory, before anything is allocated.
fn check_memory(size: Size, kind: PictureKind, available: Option<u64>) -> Result<(), RenderError> {
    // measured: 108 bytes for colours with edges, 29 for normals and 9 for depths
    let bytes_per_pixel = match kind {
        PictureKind::Colour => 128,
        PictureKind::Normal => 48,
        PictureKind::Depth | PictureKind::Id => 24,
    };
    let needed = bytes_per_pixel * size.count() as u64;
    match available {
        Some(available) if needed > available => Err(RenderError::Memory {
            width: size.width() as u32,
            height: size.height() as u32,
            needed: needed.div_ceil(1 << 20),
            available: available >> 20,
        }),
        _ => Ok(()),
    }
}

/// The camera and the settings for a picture of a compiled scene.
///
/// # Errors
///
/// [`DrawError::Render`] or [`DrawError::Camera`] for a size or field of view out of range.
pub fn arrange(
    scene: &Scene,
    compiled: &Compiled,
    options: &PictureOptions,
) -> Result<(Camera, RenderOptions), DrawError> {
    let size = size(scene, options)?;
    let camera = camera(scene, compiled, options, size)?;
    let mut settings = RenderOptions::new(size);
    let file = &scene.render;
    settings.style = options.style.or(file.shading.map(style)).unwrap_or(settings.style);
    if !options.edges.or(file.edges).unwrap_or(true) {
        settings.lines = None::<Lines>;
    }
    settings.samples = options.samples.or(file.samples).unwrap_or(settings.samples);
    if let Some(colour) = file.background {
        settings.background = Background::Colour(rgba(colour));
    }
    settings.colours = colours(scene, compiled);
    settings.lights = scene.lights.iter().map(light).collect();
    settings.shadows = options.shadows.or(file.shadows).unwrap_or(false);
    if settings.shadows && settings.lights.is_empty() {
        settings.lights.push(light_of_camera(&camera));
    }
    Ok((camera, settings))
}

fn size(scene: &Scene, options: &PictureOptions) -> Result<Size, DrawError> {
    if let Some(size) = options.size {
        return Ok(size);
    }
    let in_file = scene.camera.as_ref().and_then(|camera| camera.size);
    let (width, height) = in_file.unwrap_or((1280, 720));
    Ok(Size::new(width, height)?)
}

fn camera(
    scene: &Scene,
    compiled: &Compiled,
    options: &PictureOptions,
    size: Size,
) -> Result<Camera, DrawError> {
    let program = &compiled.program;
    let fitted = match (options.view, &scene.camera, options.field_of_view) {
        (None, Some(camera), None) => return own_camera(camera),
        (Some(view), _, None) => return Ok(fitted(view, scene, program, size)),
        (view, _, degrees) => {
            view.unwrap_or_default().fit_perspective(program, size, degrees.unwrap_or(FIELD_OF_VIEW))
        }
    };
    Ok(fitted?)
}

/// The greatest number of leaves and placements of a model that is compiled again for the frame of a picture.
const MAX_LEAVES: u64 = 20_000;

/// The camera of a view without perspective. The view at a slant is fitted to the box along the axes of the picture: the projection
/// of the box along the axes of the model is much larger than a round model.
pub(super) fn fitted(view: View, scene: &Scene, program: &Program, size: Size) -> Camera {
    let loose = view.fit(program, size);
    match view {
        View::Iso => framed(&loose, scene, program, size).unwrap_or(loose),
        _ => loose,
    }
}

fn framed(camera: &Camera, scene: &Scene, program: &Program, size: Size) -> Option<Camera> {
    let placements = program.prototypes().first().map_or(1, |group| u64::from(group.placements));
    if program.leaves().len() as u64 + placements > MAX_LEAVES {
        return None;
    }
    let (right, up, back) = (camera.right(), camera.up(), -camera.forward());
    let to_picture = Affine { linear: Mat3::from_cols(right, up, back).transpose(), translation: Vec3::ZERO };
    let turned = scene
        .model_regions()
        .into_iter()
        .map(|region| Region { solid: region.solid.apply(to_picture), ..region });
    let bounds = Program::compile_regions(&turned.collect::<Vec<_>>()).ok()?.bounds();
    let extent = bounds.size();
    if bounds.is_empty() || !bounds.is_finite() || extent.max_element() == 0.0 {
        return None;
    }
    let aspect = size.width() as f64 / size.height() as f64;
    let height = extent.y.max(extent.x / aspect).max(1e-3 * extent.max_element());
    let centre = bounds.centre();
    let target = right * centre.x + up * centre.y + back * centre.z;
    let position = target + back * extent.length();
    Camera::orthographic(position, target, up, height / (1.0 - 2.0 * View::MARGIN)).ok()
}

fn own_camera(camera: &scene::Camera) -> Result<Camera, DrawError> {
    let projection = match camera.projection {
        scene::Projection::Perspective { fov } => Projection::Perspective { field_of_view: fov },
        scene::Projection::Orthographic { height } => Projection::Orthographic { height },
    };
    let (position, target, up) = (camera.position, camera.target, camera.up);
    Ok(Camera::new(position, target, up, projection)?)
}

/// The colour of each region of the program: that of the region of the scene or, for a single solid, that of the last region
/// with its medium.
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

/// A light at the upper left behind the camera.
fn light_of_camera(camera: &Camera) -> Light {
    Light::along(camera.forward() + 0.5 * camera.right() - 0.8 * camera.up())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ball fills the picture but for the margin; the projection of the box around it is 1.6 times as high.
    #[test]
    fn round_models_fill_the_view_at_a_slant() {
        let (_, scene) =
            rayweave_scene::parse("rayweave = 1\n[solid.ball]\nsphere = { radius = 2 }").unwrap();
        let compiled = Compiled::new(&scene).unwrap();
        let size = Size::new(80, 60).unwrap();
        let options = PictureOptions { size: Some(size), view: Some(View::Iso), ..PictureOptions::default() };
        let (camera, _) = arrange(&scene, &compiled, &options).unwrap();
        let Projection::Orthographic { height } = camera.projection() else { panic!("{camera:?}") };
        assert!((height - 4.0 / (1.0 - 2.0 * View::MARGIN)).abs() < 1e-9, "{height}");
        let moved =
            "rayweave = 1\n[solid.ball]\nsphere = { radius = 2 }\ntransform = { translate = [5, 7, -3] }";
        let (_, scene) = rayweave_scene::parse(moved).unwrap();
        let camera = fitted(View::Iso, &scene, &Compiled::new(&scene).unwrap().program, size);
        let across = (Vec3::new(5.0, 7.0, -3.0) - camera.position()).reject_from(camera.forward());
        assert!(across.length() < 1e-9, "{across}");
    }

    #[test]
    fn pictures_that_do_not_fit_into_memory_are_refused() {
        let size = Size::new(32_768, 32_768).unwrap();
        assert!(check_memory(size, PictureKind::Colour, None).is_ok());
        assert!(check_memory(size, PictureKind::Colour, Some(128 << 30)).is_ok());
        let refused = check_memory(size, PictureKind::Colour, Some((128 << 30) - 1)).unwrap_err();
        let text = "a picture of 32768 x 32768 pixels cannot be drawn: it takes up to 131072 MiB of memory, and there are 131071. \
                    Draw a smaller one.";
        assert_eq!(refused.to_string(), text);
        assert!(check_memory(size, PictureKind::Depth, Some(24 << 30)).is_ok());
    }
}
