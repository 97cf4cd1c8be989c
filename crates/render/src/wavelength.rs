//! Colours of spectral light.

use crate::Rgba;

/// The display colour of a wavelength in nanometres: hue and saturation as perceived, as bright as a screen
/// can show them; grey outside the visible range.
///
/// Uses the CIE 1931 colour matching functions in the approximation of C. Wyman, P.-P. Sloan and P. Shirley,
/// *Simple Analytic Approximations to the CIE XYZ Color Matching Functions*, JCGT 2, 2 (2013), and the
/// primaries of sRGB (IEC 61966-2-1). The hue is constant below 405 nm and above 680 nm, where that of the approximation turns back.
pub fn wavelength_colour(wavelength_nm: f64) -> Rgba {
    let strongest = |light: [f64; 3]| light[0].max(light[1]).max(light[2]);
    let visible = strongest(linear_light(wavelength_nm));
    if visible.is_nan() || visible < FAINT {
        return Rgba::opaque(110, 110, 110);
    }
    let light = linear_light(wavelength_nm.clamp(HUES[0], HUES[1]));
    Rgba::from(light.map(|channel| encoded(channel / strongest(light))))
}

/// The range of wavelengths in nm with hues of their own.
const HUES: [f64; 2] = [405.0, 680.0];

/// The linear channels of the light of a wavelength, without negative parts.
fn linear_light(wavelength_nm: f64) -> [f64; 3] {
    let lobe = |mean: f64, left: f64, right: f64| {
        let width = if wavelength_nm < mean { left } else { right };
        libm::exp(-0.5 * ((wavelength_nm - mean) * width).powi(2))
    };
    let x = 0.362 * lobe(442.0, 0.0624, 0.0374) + 1.056 * lobe(599.8, 0.0264, 0.0323)
        - 0.065 * lobe(501.1, 0.0490, 0.0382);
    let y = 0.821 * lobe(568.8, 0.0213, 0.0247) + 0.286 * lobe(530.9, 0.0613, 0.0322);
    let z = 1.217 * lobe(437.0, 0.0845, 0.0278) + 0.681 * lobe(459.0, 0.0385, 0.0725);
    let light = [
        3.2406 * x - 1.5372 * y - 0.4986 * z,
        -0.9689 * x + 1.8758 * y + 0.0415 * z,
        0.0557 * x - 0.2040 * y + 1.0570 * z,
    ];
    light.map(|channel| channel.max(0.0))
}

/// Below this value light is treated as invisible.
const FAINT: f64 = 1e-3;

/// The sRGB level of a linear channel value in [0, 1].
fn encoded(part: f64) -> u8 {
    let level = match part <= 0.003_130_8 {
        true => 12.92 * part,
        false => 1.055 * libm::pow(part, 1.0 / 2.4) - 0.055,
    };
    (255.0 * level).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares the strongest and the weakest channel.
    #[test]
    fn colours_of_the_rainbow() {
        let colour = |nm: f64| wavelength_colour(nm);
        let violet = colour(430.0);
        assert!(violet.blue == 255 && violet.green < 40 && violet.red > 60);
        let green = colour(530.0);
        assert!(green.green == 255 && green.red < 80 && green.blue < 60);
        let yellow = colour(575.0);
        assert!(yellow.red > 200 && yellow.green > 200 && yellow.blue < 60);
        let red = colour(650.0);
        assert!(red.red == 255 && red.green < 60 && red.blue < 60);
        // the ends are violet and red
        for nm in [370.0, 380.0, 390.0, 400.0] {
            let violet = colour(nm);
            assert!(violet.blue == 255 && violet.green == 0 && violet.red > 100, "{nm} {violet:?}");
        }
        for nm in [680.0, 690.0, 700.0, 710.0] {
            assert_eq!(colour(nm), Rgba::opaque(255, 0, 0), "{nm}");
        }
        for invisible in [1064.0, 200.0, 1e5, f64::NAN] {
            assert_eq!(colour(invisible), Rgba::opaque(110, 110, 110), "{invisible}");
        }
    }
}
