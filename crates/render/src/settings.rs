//! Options of a rendering.

use crate::limits::MAX_SAMPLES;
use crate::{Light, RenderError, Rgba, Size};
use std::ops::Range;

/// The shading style.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Style {
    /// Gooch shading: from cool, away from the light, to warm, towards it, so that shape is visible
    /// everywhere and nothing is black (Gooch, Gooch, Shirley, Cohen: "A Non-Photorealistic Lighting Model
    /// For Automatic Technical Illustration", SIGGRAPH 1998).
    #[default]
    Gooch,
    /// Lambert shading with a light at the camera: an ambient part, plus a part proportional to the cosine
    /// of the angle to the line of sight. Lights of the scene, if there are any, replace that light.
    Headlight,
    /// The colour of the region, unshaded.
    Flat,
}

/// The background.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Background {
    /// A transparent background.
    Transparent,
    /// One colour.
    Colour(Rgba),
    /// A vertical gradient.
    Gradient {
        /// The colour of the upper edge.
        top: Rgba,
        /// The colour of the lower edge.
        bottom: Rgba,
    },
}

/// Lines along outlines and creases.
///
/// Two neighbouring samples are separated by an *outline* if they show different regions, or only one of them
/// shows a region; or if the step in depth between them is too steep for one surface: the line from point to
/// point makes more than 20 degrees with a tangent plane. They are separated by a *crease* if they are on
/// different faces whose normals differ by more than `crease_degrees`. Faces that join smoothly, and coplanar
/// faces of different parts of one region, have no line between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lines {
    /// The width of outlines in pixels, from 0 to 8; creases have 6/10 of this width.
    pub width: f64,
    /// The least angle between normals that is drawn, in degrees, from 0 to 180.
    pub crease_degrees: f64,
    /// The colour; its opacity determines how much of the picture below shows through.
    pub colour: Rgba,
}

impl Default for Lines {
    fn default() -> Self {
        Lines { width: 1.4, crease_degrees: 8.0, colour: Rgba { alpha: 225, ..Rgba::opaque(24, 28, 38) } }
    }
}

/// The settings of a rendering besides model and camera.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    /// Width and height.
    pub size: Size,
    /// Samples along each side of a pixel, from 1 to [`RenderOptions::MAX_SAMPLES`]: every pixel has one at its
    /// centre, and pixels that differ from their neighbours are supersampled on a regular grid of n x n.
    pub samples: u32,
    /// The shading style.
    pub style: Style,
    /// The lines; `None` for no lines.
    pub lines: Option<Lines>,
    /// The background.
    pub background: Background,
    /// The colours of the regions, see [`crate::region_colour`]. Regions with opacity below 255 are
    /// translucent.
    pub colours: Vec<Rgba>,
    /// The lights of the scene.
    pub lights: Vec<Light>,
    /// True if lights cast shadows. Without lights there are none.
    pub shadows: bool,
    /// Renders only these rows of pixels, counted from the top; all by default. They have the pixels of the whole picture.
    pub rows: Option<Range<u32>>,
}

impl RenderOptions {
    /// The greatest number of samples along each side of a pixel.
    pub const MAX_SAMPLES: u32 = MAX_SAMPLES;

    /// The greatest number of lights.
    pub const MAX_LIGHTS: usize = 32;

    /// Gooch shading with lines, on white, 3 x 3 samples, no lights.
    pub fn new(size: Size) -> RenderOptions {
        RenderOptions {
            size,
            samples: 3,
            style: Style::default(),
            lines: Some(Lines::default()),
            background: Background::Colour(Rgba::WHITE),
            colours: Vec::new(),
            lights: Vec::new(),
            shadows: false,
            rows: None,
        }
    }

    pub(crate) fn check(&self) -> Result<(), RenderError> {
        if !(1..=RenderOptions::MAX_SAMPLES).contains(&self.samples) {
            return Err(RenderError::Samples { samples: self.samples });
        }
        if let Some(lines) = &self.lines {
            range("width of lines", lines.width, 0.0, 8.0)?;
            range("angle of creases", lines.crease_degrees, 0.0, 180.0)?;
        }
        if let Some(rows) = &self.rows {
            let height = self.size.height() as f64;
            range("end of the rows", f64::from(rows.end), 1.0, height)?;
            range("start of the rows", f64::from(rows.start), 0.0, f64::from(rows.end) - 1.0)?;
        }
        let most = RenderOptions::MAX_LIGHTS as f64;
        range("number of lights", self.lights.len() as f64, 0.0, most)?;
        (self.lights.iter().enumerate()).try_for_each(|(index, light)| light.check(index))
    }
}

fn range(what: &'static str, value: f64, lo: f64, hi: f64) -> Result<(), RenderError> {
    if (lo..=hi).contains(&value) { Ok(()) } else { Err(RenderError::Range { what, value, lo, hi }) }
}
