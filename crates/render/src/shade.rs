//! Shading: the colour of a surface under the lights.

use crate::colour::Linear;
use crate::{Camera, Light, LightKind, RenderOptions, Style, region_colour};
use rayweave_math::Vec3;
use rayweave_model::{Program, RegionId};

/// Shading data, computed once per picture.
pub(crate) struct Shader {
    style: Style,
    /// Colour and opacity of each region; the first entry is the world, which is never visible.
    regions: Vec<(Linear, f32)>,
    translucent: bool,
    lamps: Vec<Lamp>,
    shadows: bool,
}

/// A light of the scene, or the default light of the style.
pub(crate) struct Lamp {
    /// The light of the scene, for shadows; `None` for a default light.
    light: Option<Light>,
    pub source: Source,
    pub strength: Linear,
}

/// The kind of a light source, prepared for shading.
pub(crate) enum Source {
    /// A directional light: the unit vector from the surface to the light.
    Sun(Vec3),
    /// A point light.
    Point(Vec3),
    /// A light at the camera.
    Eye,
}

/// A surface to be shaded.
pub(crate) struct ShadingPoint {
    /// The visible point.
    pub point: Vec3,
    /// The unit vector along the line of sight.
    pub sight: Vec3,
    /// The unit normal on the side of the camera.
    pub normal: Vec3,
    /// The visible region.
    pub region: RegionId,
    /// The lights that shine on it, one bit each.
    pub lit: u32,
}

/// The number of layers with lines where regions are translucent.
const LEVELS: usize = 4;

/// The ambient fraction of a surface's colour.
pub(crate) const AMBIENT: f32 = 0.18;

/// A tint and the fraction of the region's colour added to it, for the cool or the warm end of the tones.
///
/// They are k_blue with alpha and k_yellow with beta of Gooch et al. 1998, here for linear light and chosen
/// by eye so that the region's colour stays recognisable.
struct Tone {
    tint: Linear,
    part: f32,
}

const COOL: Tone = Tone { tint: [0.002, 0.008, 0.04], part: 0.15 };
const WARM: Tone = Tone { tint: [0.06, 0.045, 0.005], part: 1.0 };

/// The fraction of a light's tone that remains in its shadow.
const SHADOWED: f32 = 0.3;

/// The strength of a highlight at its brightest point, and the number of squarings that give the exponent of
/// its cosine (Phong: "Illumination for Computer Generated Pictures", 1975).
const HIGHLIGHT: f32 = 0.35;
const HIGHLIGHT_SQUARINGS: u32 = 5;

impl Shader {
    pub fn new(program: &Program, camera: &Camera, settings: &RenderOptions) -> Shader {
        let region = |k: usize| {
            let colour = region_colour(&settings.colours, RegionId::from(k));
            (colour.linear(), colour.opacity())
        };
        let regions: Vec<_> = (0..=program.regions().len()).map(region).collect();
        Shader {
            style: settings.style,
            translucent: regions[1..].iter().any(|&(_, opacity)| opacity < 1.0),
            regions,
            lamps: lamps(camera, settings),
            shadows: settings.shadows && settings.style != Style::Flat && !settings.lights.is_empty(),
        }
    }

    /// True if some region is translucent.
    pub fn is_translucent(&self) -> bool {
        self.translucent
    }

    /// The number of layers per ray that are compared with those of neighbours.
    pub fn levels(&self) -> usize {
        if self.translucent { LEVELS } else { 1 }
    }

    /// The transparency of a region, 1 - opacity.
    pub fn transparency(&self, region: u32) -> f32 {
        1.0 - self.regions[region as usize].1
    }

    /// True if a region is opaque.
    pub fn is_opaque(&self, region: RegionId) -> bool {
        self.regions[region.index()].1 >= 1.0
    }

    /// True if shadow rays are needed.
    pub fn casts_shadows(&self) -> bool {
        self.shadows
    }

    /// The lights of the scene, in order.
    pub fn lights(&self) -> impl Iterator<Item = &Light> {
        self.lamps.iter().filter_map(|lamp| lamp.light.as_ref())
    }

    /// The shading style.
    pub fn style(&self) -> Style {
        self.style
    }

    /// The lights used for shading.
    pub fn lamps(&self) -> &[Lamp] {
        &self.lamps
    }

    /// The colour of a region.
    #[inline]
    pub fn colour(&self, region: RegionId) -> Linear {
        self.regions[region.index()].0
    }

    /// The reflected light and the opacity of a surface.
    #[inline]
    pub fn shade(&self, point: &ShadingPoint) -> (Linear, f32) {
        let (colour, opacity) = self.regions[point.region.index()];
        let light = match self.style {
            Style::Flat => colour,
            Style::Headlight => self.lambert(colour, point),
            Style::Gooch => self.gooch(colour, point),
        };
        (light, opacity)
    }

    fn lambert(&self, colour: Linear, point: &ShadingPoint) -> Linear {
        let mut arriving = [AMBIENT; 3];
        for (k, lamp) in self.lamps.iter().enumerate() {
            let cosine = point.normal.dot(lamp.direction(point)) as f32;
            if cosine > 0.0 && point.lit >> k & 1 == 1 {
                let part = (1.0 - AMBIENT) * cosine;
                arriving = std::array::from_fn(|c| arriving[c] + part * lamp.strength[c]);
            }
        }
        std::array::from_fn(|c| colour[c] * arriving[c])
    }

    /// The tone is the mean of the lights' tones weighted by their strengths, so several lights do not wash
    /// it out.
    fn gooch(&self, colour: Linear, point: &ShadingPoint) -> Linear {
        let (mut tone, mut total, mut shine) = (0.0, 0.0, 0.0_f32);
        for (k, lamp) in self.lamps.iter().enumerate() {
            let towards = lamp.direction(point);
            let cosine = point.normal.dot(towards) as f32;
            let weight: f32 = lamp.strength.iter().sum();
            let part = 0.5 * (1.0 + cosine);
            total += weight;
            if point.lit >> k & 1 == 1 {
                tone += weight * part;
                shine = shine.max(highlight(point.normal, towards, point.sight));
            } else {
                tone += weight * SHADOWED * part;
            }
        }
        let warmth = if total > 0.0 { tone / total } else { 0.0 };
        std::array::from_fn(|c| {
            let end = |tone: &Tone| tone.tint[c] + tone.part * colour[c];
            let base = (1.0 - warmth) * end(&COOL) + warmth * end(&WARM);
            base + HIGHLIGHT * shine * (1.0 - base).max(0.0)
        })
    }
}

impl Lamp {
    /// A light of the scene, or a default light of the same kind.
    fn new(light: &Light, is_of_scene: bool) -> Lamp {
        let source = match light.kind {
            LightKind::Direction(_) => Source::Sun(light.towards(Vec3::ZERO)),
            LightKind::Position(position) => Source::Point(position),
        };
        Lamp { light: is_of_scene.then_some(*light), source, strength: light.strength() }
    }

    /// The unit vector from a surface to the light; zero at the position of the light.
    fn direction(&self, point: &ShadingPoint) -> Vec3 {
        match self.source {
            Source::Sun(towards) => towards,
            Source::Point(position) => (position - point.point).normalize_or_zero(),
            Source::Eye => -point.sight,
        }
    }
}

/// The lights of the scene, or the default light of the style if there are none.
fn lamps(camera: &Camera, settings: &RenderOptions) -> Vec<Lamp> {
    if !settings.lights.is_empty() {
        return settings.lights.iter().map(|light| Lamp::new(light, true)).collect();
    }
    vec![match settings.style {
        // over the left shoulder of the viewer, as in technical illustrations
        Style::Gooch => {
            let along = camera.forward() + 0.6 * camera.right() - 0.9 * camera.up();
            Lamp::new(&Light::along(along), false)
        }
        Style::Headlight | Style::Flat => Lamp { light: None, source: Source::Eye, strength: [1.0; 3] },
    }]
}

/// The cosine between the mirrored line of sight and the light, to the power 2^[`HIGHLIGHT_SQUARINGS`];
/// repeated squaring gives the same bits on every platform.
fn highlight(normal: Vec3, towards: Vec3, sight: Vec3) -> f32 {
    let mirrored = sight - 2.0 * sight.dot(normal) * normal;
    let cosine = mirrored.dot(towards).max(0.0) as f32;
    (0..HIGHLIGHT_SQUARINGS).fold(cosine, |power, _| power * power)
}
