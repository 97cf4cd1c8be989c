//! Colours: sRGB pixels, linear light, palette.

use rayweave_model::RegionId;
use std::sync::LazyLock;

/// An sRGB colour with 8 bits per channel and opacity (255 is opaque).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Rgba {
    /// Red.
    pub red: u8,
    /// Green.
    pub green: u8,
    /// Blue.
    pub blue: u8,
    /// Opacity.
    pub alpha: u8,
}

impl Rgba {
    /// White.
    pub const WHITE: Rgba = Rgba::opaque(255, 255, 255);

    /// An opaque colour.
    pub const fn opaque(red: u8, green: u8, blue: u8) -> Rgba {
        Rgba { red, green, blue, alpha: 255 }
    }

    /// The linear light of the colour, not multiplied by the opacity.
    pub fn linear(self) -> Linear {
        [self.red, self.green, self.blue].map(|level| SRGB.decoded[usize::from(level)])
    }

    /// The opacity, from 0 to 1.
    pub fn opacity(self) -> f32 {
        f32::from(self.alpha) / 255.0
    }
}

impl From<[u8; 3]> for Rgba {
    fn from([red, green, blue]: [u8; 3]) -> Rgba {
        Rgba::opaque(red, green, blue)
    }
}

impl From<[u8; 4]> for Rgba {
    fn from([red, green, blue, alpha]: [u8; 4]) -> Rgba {
        Rgba { red, green, blue, alpha }
    }
}

/// Linear light, red, green and blue; 1 is the maximum of the screen.
pub type Linear = [f32; 3];

/// The default colours of regions, in order: those of Okabe and Ito without black, distinguishable with any
/// kind of colour vision ("Color Universal Design", 2008).
pub const PALETTE: [Rgba; 7] = [
    Rgba::opaque(86, 180, 233),
    Rgba::opaque(230, 159, 0),
    Rgba::opaque(0, 158, 115),
    Rgba::opaque(204, 121, 167),
    Rgba::opaque(240, 228, 66),
    Rgba::opaque(0, 114, 178),
    Rgba::opaque(213, 94, 0),
];

/// The colour of a region: entry k of the list for region k + 1, otherwise one of [`PALETTE`] in turn.
pub fn region_colour(colours: &[Rgba], region: RegionId) -> Rgba {
    let index = region.index().saturating_sub(1);
    let of_palette = PALETTE[index % PALETTE.len()];
    colours.get(index).copied().unwrap_or(of_palette)
}

/// The transfer function of sRGB (IEC 61966-2-1:1999), tabulated.
struct Srgb {
    /// The linear light of each level.
    decoded: [f32; 256],
    /// The least light that rounds to each level; the first entry is unused, and so is the last, which no
    /// light reaches.
    threshold: [f32; 257],
    /// The level of the lower end of each of [`STEPS`] equal steps of light.
    guess: [u8; STEPS],
}

const STEPS: usize = 4096;

static SRGB: LazyLock<Srgb> = LazyLock::new(|| {
    let light = |level: f64| decode(level / 255.0) as f32;
    let decoded = std::array::from_fn(|k| light(k as f64));
    let least = |k: usize| if k < 256 { light(k as f64 - 0.5) } else { f32::INFINITY };
    let threshold: [f32; 257] = std::array::from_fn(least);
    let level = |step: usize| {
        let value = step as f32 / STEPS as f32;
        (threshold.partition_point(|&least| least <= value) - 1) as u8
    };
    let guess = std::array::from_fn(level);
    Srgb { decoded, threshold, guess }
});

/// Linear light of an sRGB level in [0, 1].
fn decode(level: f64) -> f64 {
    if level <= 0.04045 { level / 12.92 } else { libm::pow((level + 0.055) / 1.055, 2.4) }
}

/// The nearest sRGB level of a linear value; values outside [0, 1] are clamped.
#[inline]
pub(crate) fn encode(light: f32) -> u8 {
    SRGB.encode(light)
}

impl Srgb {
    /// Table lookup: the curve is steepest at 0, where a step has 12.92 * 255 / 4096 = 0.8 levels, so a step
    /// contains at most one threshold.
    #[inline]
    fn encode(&self, light: f32) -> u8 {
        let step = (light.clamp(0.0, 1.0) * STEPS as f32) as usize;
        let level = self.guess[step.min(STEPS - 1)];
        level + u8::from(light >= self.threshold[usize::from(level) + 1])
    }
}

/// Premultiplied colour with its opacity: the form in which colours are averaged and composited.
pub(crate) type Premultiplied = [f32; 4];

pub(crate) fn premultiply(light: Linear, opacity: f32) -> Premultiplied {
    let [r, g, b] = light.map(|channel| channel * opacity);
    [r, g, b, opacity]
}

/// Composites `front` over `back`.
pub(crate) fn over(front: Premultiplied, back: Premultiplied) -> Premultiplied {
    std::array::from_fn(|k| front[k] + (1.0 - front[3]) * back[k])
}

/// Converts a premultiplied colour to a pixel.
pub(crate) fn pixel(colour: Premultiplied) -> [u8; 4] {
    let [r, g, b, opacity] = colour;
    if opacity <= 0.0 {
        return [0; 4];
    }
    let light = |channel: f32| if opacity == 1.0 { channel } else { channel / opacity };
    let level = |channel: f32| encode(light(channel));
    let alpha = (opacity.min(1.0) * 255.0 + 0.5) as u8;
    [level(r), level(g), level(b), alpha]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The inverse transfer function of IEC 61966-2-1, as an independent formula.
    fn srgb(light: f64) -> f64 {
        if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
    }

    #[test]
    fn every_level_survives_the_round_trip() {
        for level in 0..=255 {
            let light = Rgba::opaque(level, level, level).linear()[0];
            assert_eq!(encode(light), level);
            assert_eq!(pixel([light, light, light, 1.0]), [level, level, level, 255]);
        }
    }

    #[test]
    fn encoding_rounds_to_the_nearest_level() {
        for k in 0..=100_000 {
            let light = k as f32 / 100_000.0;
            let exact = 255.0 * srgb(f64::from(light));
            let error = (f64::from(encode(light)) - exact).abs();
            // the two branches of the standard agree only to four digits, and light has 24 bits
            assert!(error <= 0.501, "{light}: {} for {exact}", encode(light));
        }
        assert_eq!([encode(-1.0), encode(7.0), encode(f32::NAN)], [0, 255, 0]);
    }

    #[test]
    fn colours_are_composited() {
        let red = premultiply([1.0, 0.0, 0.0], 0.5);
        let blue = premultiply([0.0, 0.0, 1.0], 1.0);
        assert_eq!(over(red, blue), [0.5, 0.0, 0.5, 1.0]);
        assert_eq!(over(blue, red), blue);
        assert_eq!(pixel(over(red, [0.0; 4])), [255, 0, 0, 128]);
    }

    #[test]
    fn regions_without_a_colour_take_one_in_turn() {
        let own = [Rgba::WHITE];
        assert_eq!(region_colour(&own, RegionId(1)), Rgba::WHITE);
        assert_eq!(region_colour(&own, RegionId(2)), PALETTE[1]);
        assert_eq!(region_colour(&[], RegionId(8)), PALETTE[0]);
    }
}
