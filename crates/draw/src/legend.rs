//! Legends: the meaning of the colours of a drawing.

use crate::axis::format_number;
use crate::svg::{Anchor, Svg, paint};
use rayweave_render::{Rgba, wavelength_colour};

const MARGIN: f64 = 24.0;
const ROW: f64 = 20.0;
/// The approximate width of a character.
const LETTER: f64 = 6.4;

/// A name with its colour, of a line or of an area.
pub struct Entry {
    /// The name.
    pub name: String,
    /// The paint of the swatch.
    pub colour: String,
    /// The shape of the swatch.
    pub swatch: Swatch,
}

/// The shape of a swatch.
#[derive(Clone, Copy, PartialEq)]
pub enum Swatch {
    Line,
    Area,
    /// A circle, as points are marked.
    Mark,
    /// A circle of a class of the style sheet.
    Circle(&'static str),
}

/// Draws entries in rows below a height. Returns the height of a drawing that ends below them.
pub fn draw(svg: &mut Svg, entries: &[Entry], from: f64, width: f64) -> f64 {
    let (mut x, mut y) = (MARGIN, from);
    for Entry { name, colour, swatch } in entries {
        let wide = 24.0 + LETTER * name.chars().count() as f64 + 18.0;
        if x + wide > width - MARGIN && x > MARGIN {
            (x, y) = (MARGIN, y + ROW);
        }
        let fill = format!(r#" fill="{colour}""#);
        match swatch {
            Swatch::Line => svg.rectangle("swatch", [x, y - 5.5, 16.0, 2.5], &fill),
            // an outline, since the paper may have the colour of the area
            Swatch::Area => {
                let outlined = format!(r##"{fill} stroke="#8d97a3" stroke-width="0.6""##);
                svg.rectangle("swatch", [x, y - 9.5, 16.0, 11.0], &outlined);
            }
            Swatch::Mark => svg.circle("mark", [x + 8.0, y - 4.0], 3.0, ""),
            Swatch::Circle(class) => svg.circle(class, [x + 8.0, y - 4.0], 6.0, ""),
        }
        svg.text("tick", [x + 22.0, y], Anchor::Start, name, name);
        x += wide;
    }
    if entries.is_empty() { from } else { y + MARGIN }
}

/// The distinct wavelengths of a drawing, in nanometres.
pub struct Wavelengths(Vec<f64>);

impl Wavelengths {
    /// Sorts wavelengths and removes duplicates.
    pub fn new(wavelengths_nm: impl Iterator<Item = f64>) -> Wavelengths {
        let mut lengths: Vec<f64> = wavelengths_nm.collect();
        lengths.sort_by(f64::total_cmp);
        lengths.dedup();
        Wavelengths(lengths)
    }

    /// An entry for each wavelength if there are at most six, otherwise for the ends and the middle.
    pub fn entries(&self) -> Vec<Entry> {
        let few = match self.0.len() {
            0..=6 => self.0.clone(),
            n => vec![self.0[0], self.0[n / 2], self.0[n - 1]],
        };
        let entry = |nm: f64| Entry {
            name: format!("{} nm", format_number(nm, 0.1)),
            colour: wavelength_paint(nm),
            swatch: Swatch::Line,
        };
        few.into_iter().map(entry).collect()
    }
}

/// The paint of light with a wavelength in nanometres.
pub fn wavelength_paint(wavelength_nm: f64) -> String {
    paint(darkened(wavelength_colour(wavelength_nm)))
}

/// A colour dark enough for a thin line on white: light greens and yellows are darkened the most.
fn darkened(colour: Rgba) -> Rgba {
    let Rgba { red, green, blue, .. } = colour;
    let bright = (0.2 * f64::from(red) + 0.7 * f64::from(green) + 0.1 * f64::from(blue)) / 255.0;
    Rgba::from([red, green, blue].map(|level| (f64::from(level) * (1.0 - 0.35 * bright)) as u8))
}
