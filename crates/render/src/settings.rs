//! How a picture is drawn.

use crate::limits::MOST_SAMPLES;
use crate::{Light, RenderError, Rgba, Size};

/// How surfaces are shaded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// From cool, away from the light, to warm, towards it, so that shape shows everywhere and nothing is black (Gooch,
    /// Gooch, Shirley, Cohen: "A Non-Photorealistic Lighting Model For Automatic Technical Illustration", SIGGRAPH 1998).
    #[default]
    Gooch,
    /// As bright as the cosine of the angle to the line of sight (Lambert): a lamp on the camera. Lights of the scene, if
    /// there are any, take its place.
    Headlight,
    /// The colour of the region alone.
    Flat,
}

/// What is behind the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// Nothing: the picture is transparent there.
    Transparent,
    /// One colour.
    Colour(Rgba),
    /// From one colour at the top to another at the bottom.
    Gradient {
        /// The colour of the upper edge.
        top: Rgba,
        /// The colour of the lower edge.
        bottom: Rgba,
    },
}

/// The drawing of lines where something begins or ends on the screen.
///
/// Two neighbouring samples are separated by an *outline* if one of them shows another region than the other, or nothing;
/// or if the step in depth between them is too steep for one surface: the line from point to point makes more than 20 degrees
/// with a tangent plane. They are separated by a *crease* if they are on different faces whose normals differ by more than
/// `crease_degrees`. So faces that go on smoothly, and coplanar faces of different parts of one region, show no line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lines {
    /// The width of outlines in pixels, from 0 to 8; creases have 6/10 of it.
    pub width: f64,
    /// The least angle between normals that is drawn, in degrees, from 0 to 180.
    pub crease_degrees: f64,
    /// The colour; its opacity tells how much of what is beneath shows through.
    pub colour: Rgba,
}

impl Default for Lines {
    fn default() -> Self {
        Lines { width: 1.4, crease_degrees: 8.0, colour: Rgba { alpha: 225, ..Rgba::opaque(24, 28, 38) } }
    }
}

/// All that is chosen about a picture besides model and camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// Width and height.
    pub size: Size,
    /// Samples along each side of a pixel, from 1 to [`Settings::MOST_SAMPLES`]: every pixel has one at its centre, and
    /// where pixels differ from their neighbours they are drawn anew with a regular grid of n x n.
    pub samples: u32,
    /// How surfaces are shaded.
    pub style: Style,
    /// The lines, if there are to be any.
    pub lines: Option<Lines>,
    /// What is behind the model.
    pub background: Background,
    /// The colours of the regions, see [`crate::region_colour`]. A region that is not opaque shows what is behind it.
    pub colours: Vec<Rgba>,
    /// The lights of the scene.
    pub lights: Vec<Light>,
    /// Whether lights cast shadows. Without lights there are none.
    pub shadows: bool,
}

impl Settings {
    /// The most samples along each side of a pixel.
    pub const MOST_SAMPLES: u32 = MOST_SAMPLES;

    /// The most lights.
    pub const MOST_LIGHTS: usize = 32;

    /// Gooch shading with lines, on white, 3 x 3 samples, no lights.
    pub fn new(size: Size) -> Settings {
        Settings {
            size,
            samples: 3,
            style: Style::default(),
            lines: Some(Lines::default()),
            background: Background::Colour(Rgba::WHITE),
            colours: Vec::new(),
            lights: Vec::new(),
            shadows: false,
        }
    }

    pub(crate) fn check(&self) -> Result<(), RenderError> {
        if !(1..=Settings::MOST_SAMPLES).contains(&self.samples) {
            return Err(RenderError::Samples { samples: self.samples });
        }
        if let Some(lines) = &self.lines {
            range("width of lines", lines.width, 0.0, 8.0)?;
            range("angle of creases", lines.crease_degrees, 0.0, 180.0)?;
        }
        let most = Settings::MOST_LIGHTS as f64;
        range("number of lights", self.lights.len() as f64, 0.0, most)?;
        (self.lights.iter().enumerate()).try_for_each(|(index, light)| light.check(index))
    }
}

fn range(what: &'static str, value: f64, lo: f64, hi: f64) -> Result<(), RenderError> {
    if (lo..=hi).contains(&value) { Ok(()) } else { Err(RenderError::Range { what, value, lo, hi }) }
}
