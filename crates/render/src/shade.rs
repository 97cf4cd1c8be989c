//! The colour of a surface in the light.

use crate::colour::Linear;
use crate::{Camera, Light, LightKind, Settings, Style, region_colour};
use rayweave_math::Vec3;
use rayweave_model::{Program, RegionId};

/// What shading needs to know, computed once per picture.
pub(crate) struct Shader {
    style: Style,
    /// Colour and opacity of each region; the first stands for the world and is never seen.
    regions: Vec<(Linear, f32)>,
    translucent: bool,
    lamps: Vec<Lamp>,
    shadows: bool,
}

/// A light, or what stands in where the scene has none.
pub(crate) struct Lamp {
    /// The light of the scene, for shadows.
    light: Option<Light>,
    pub source: Source,
    pub strength: Linear,
}

/// Where light comes from, ready for shading.
pub(crate) enum Source {
    /// Along the unit vector from anywhere to the light.
    Sun(Vec3),
    /// From a point.
    Point(Vec3),
    /// From the eye.
    Eye,
}

/// A surface that is to be shaded.
pub(crate) struct Look {
    /// The point that is seen.
    pub point: Vec3,
    /// The unit vector along the line of sight.
    pub sight: Vec3,
    /// The unit normal on the side of the eye.
    pub normal: Vec3,
    /// The region whose surface is seen.
    pub region: RegionId,
    /// The lights that shine on it, a bit each.
    pub lit: u32,
}

/// How many surfaces behind one another have lines where some are translucent.
const LEVELS: usize = 4;

/// The part of a surface's colour that it has in no light at all.
pub(crate) const AMBIENT: f32 = 0.18;

/// A tint that is added, and the part of the region's colour in it: the cool and the warm end of tones.
///
/// Those are k_blue with alpha and k_yellow with beta of Gooch et al. 1998, here for linear light, and chosen by eye so that
/// the region's own colour stays easy to recognise.
struct Tone {
    tint: Linear,
    part: f32,
}

const COOL: Tone = Tone { tint: [0.002, 0.008, 0.04], part: 0.15 };
const WARM: Tone = Tone { tint: [0.06, 0.045, 0.005], part: 1.0 };

/// What is left of the tone of a light in its shadow.
const SHADOWED: f32 = 0.3;

/// The strength of the brightest point of a highlight, and the power of the cosine by which it falls off (Phong:
/// "Illumination for Computer Generated Pictures", 1975).
const HIGHLIGHT: f32 = 0.35;
const HIGHLIGHT_SQUARINGS: u32 = 5;

impl Shader {
    pub fn new(program: &Program, camera: &Camera, settings: &Settings) -> Shader {
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

    /// True if some region shows what is behind it.
    pub fn is_translucent(&self) -> bool {
        self.translucent
    }

    /// How many surfaces on a ray, from the first, are compared with those of neighbours.
    pub fn levels(&self) -> usize {
        if self.translucent { LEVELS } else { 1 }
    }

    /// How much of what is behind it a region shows.
    pub fn transparency(&self, region: u32) -> f32 {
        1.0 - self.regions[region as usize].1
    }

    /// True if a region hides what is behind it.
    pub fn is_opaque(&self, region: RegionId) -> bool {
        self.regions[region.index()].1 >= 1.0
    }

    /// True if it must be known which lights shine on a surface.
    pub fn casts_shadows(&self) -> bool {
        self.shadows
    }

    /// The lights of the scene, in order.
    pub fn lights(&self) -> impl Iterator<Item = &Light> {
        self.lamps.iter().filter_map(|lamp| lamp.light.as_ref())
    }

    /// How surfaces are shaded.
    pub fn style(&self) -> Style {
        self.style
    }

    /// All that shines.
    pub fn lamps(&self) -> &[Lamp] {
        &self.lamps
    }

    /// The colour of a region.
    #[inline]
    pub fn colour(&self, region: RegionId) -> Linear {
        self.regions[region.index()].0
    }

    /// Light and opacity of a surface.
    #[inline]
    pub fn shade(&self, look: &Look) -> (Linear, f32) {
        let (colour, opacity) = self.regions[look.region.index()];
        let light = match self.style {
            Style::Flat => colour,
            Style::Headlight => self.lambert(colour, look),
            Style::Gooch => self.gooch(colour, look),
        };
        (light, opacity)
    }

    fn lambert(&self, colour: Linear, look: &Look) -> Linear {
        let mut arriving = [AMBIENT; 3];
        for (k, lamp) in self.lamps.iter().enumerate() {
            let cosine = look.normal.dot(lamp.direction(look)) as f32;
            if cosine > 0.0 && look.lit >> k & 1 == 1 {
                let part = (1.0 - AMBIENT) * cosine;
                arriving = std::array::from_fn(|c| arriving[c] + part * lamp.strength[c]);
            }
        }
        std::array::from_fn(|c| colour[c] * arriving[c])
    }

    /// The tone is the mean of the lights' tones, weighted by their strengths, so that several lights do not wash it out.
    fn gooch(&self, colour: Linear, look: &Look) -> Linear {
        let (mut tone, mut total, mut shine) = (0.0, 0.0, 0.0_f32);
        for (k, lamp) in self.lamps.iter().enumerate() {
            let towards = lamp.direction(look);
            let cosine = look.normal.dot(towards) as f32;
            let weight: f32 = lamp.strength.iter().sum();
            let part = 0.5 * (1.0 + cosine);
            total += weight;
            if look.lit >> k & 1 == 1 {
                tone += weight * part;
                shine = shine.max(highlight(look.normal, towards, look.sight));
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
    /// A light of the scene, or one like it.
    fn new(light: &Light, is_of_scene: bool) -> Lamp {
        let source = match light.kind {
            LightKind::Direction(_) => Source::Sun(light.towards(Vec3::ZERO)),
            LightKind::Position(position) => Source::Point(position),
        };
        Lamp { light: is_of_scene.then_some(*light), source, strength: light.strength() }
    }

    /// The unit vector from a surface to the light; zero at the light itself.
    fn direction(&self, look: &Look) -> Vec3 {
        match self.source {
            Source::Sun(towards) => towards,
            Source::Point(position) => (position - look.point).normalize_or_zero(),
            Source::Eye => -look.sight,
        }
    }
}

/// The lights of the scene; where it has none, what the style calls for.
fn lamps(camera: &Camera, settings: &Settings) -> Vec<Lamp> {
    if !settings.lights.is_empty() {
        return settings.lights.iter().map(|light| Lamp::new(light, true)).collect();
    }
    vec![match settings.style {
        // over the left shoulder of who looks, as in technical illustrations
        Style::Gooch => {
            let along = camera.forward() + 0.6 * camera.right() - 0.9 * camera.up();
            Lamp::new(&Light::along(along), false)
        }
        Style::Headlight | Style::Flat => Lamp { light: None, source: Source::Eye, strength: [1.0; 3] },
    }]
}

/// The cosine between the mirrored line of sight and the light, to the power 2^[`HIGHLIGHT_SQUARINGS`]: by squaring, which has
/// the same bits everywhere.
fn highlight(normal: Vec3, towards: Vec3, sight: Vec3) -> f32 {
    let mirrored = sight - 2.0 * sight.dot(normal) * normal;
    let cosine = mirrored.dot(towards).max(0.0) as f32;
    (0..HIGHLIGHT_SQUARINGS).fold(cosine, |power, _| power * power)
}
