//! sRGB colours, and the default palette of regions.

use crate::colour_names::COLOUR_NAMES;
use std::fmt;

/// An sRGB colour with 8 bits per channel and an opacity (255 is opaque).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Colour {
    /// Red.
    pub red: u8,
    /// Green.
    pub green: u8,
    /// Blue.
    pub blue: u8,
    /// Opacity.
    pub alpha: u8,
}

impl Colour {
    /// White.
    pub const WHITE: Colour = Colour::new(255, 255, 255);

    /// Default colours of regions, assigned in turn: the palette of Okabe and Ito without black. Its
    /// colours remain distinguishable with colour vision deficiency ("Color Universal Design", 2008).
    pub const PALETTE: [Colour; 7] = [
        Colour::new(86, 180, 233),
        Colour::new(230, 159, 0),
        Colour::new(0, 158, 115),
        Colour::new(204, 121, 167),
        Colour::new(240, 228, 66),
        Colour::new(0, 114, 178),
        Colour::new(213, 94, 0),
    ];

    /// The default colour of region number `number`: those of [`Colour::PALETTE`] in turn, then
    /// lighter, darker and darkest versions, then again from the start.
    pub fn numbered(number: usize) -> Colour {
        let count = Colour::PALETTE.len();
        let (colour, round) = (Colour::PALETTE[number % count], number / count % 4);
        let shade = |level: u8| {
            let level = u16::from(level);
            let shade = match round {
                0 => level,
                1 => (level + 255) / 2,
                2 => level * 13 / 20,
                _ => level * 9 / 20,
            };
            shade as u8
        };
        Colour::new(shade(colour.red), shade(colour.green), shade(colour.blue))
    }

    /// An opaque colour.
    pub const fn new(red: u8, green: u8, blue: u8) -> Colour {
        let alpha = 255;
        Colour { red, green, blue, alpha }
    }

    /// Parses `#rgb`, `#rrggbb`, `#rrggbbaa` or a name of CSS such as `red`, in lower or upper case.
    pub fn parse(text: &str) -> Option<Colour> {
        let Some(digits) = text.strip_prefix('#') else {
            let named = COLOUR_NAMES.binary_search_by(|(name, _)| (*name).cmp(&text.to_ascii_lowercase()));
            let [red, green, blue] = COLOUR_NAMES[named.ok()?].1;
            return Some(Colour::new(red, green, blue));
        };
        let digits = digits.as_bytes();
        let nibbles: Vec<u8> =
            digits.iter().map(|c| (*c as char).to_digit(16).map(|d| d as u8)).collect::<Option<_>>()?;
        let pair = |k: usize| 16 * nibbles[2 * k] + nibbles[2 * k + 1];
        match nibbles.len() {
            3 => Some(Colour::new(17 * nibbles[0], 17 * nibbles[1], 17 * nibbles[2])),
            6 => Some(Colour::new(pair(0), pair(1), pair(2))),
            8 => Some(Colour { alpha: pair(3), ..Colour::new(pair(0), pair(1), pair(2)) }),
            _ => None,
        }
    }
}

/// Formats as `#rrggbb`, or `#rrggbbaa` if not opaque.
impl fmt::Display for Colour {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "#{:02x}{:02x}{:02x}", self.red, self.green, self.blue)?;
        match self.alpha {
            255 => Ok(()),
            alpha => write!(f, "{alpha:02x}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twenty_eight_colours_are_different() {
        let all: std::collections::HashSet<Colour> = (0..28).map(Colour::numbered).collect();
        assert_eq!(
            (all.len(), Colour::numbered(0), Colour::numbered(28)),
            (28, Colour::PALETTE[0], Colour::PALETTE[0])
        );
    }

    #[test]
    fn colours_are_read_and_written() {
        assert_eq!(Colour::parse("#8af"), Some(Colour::new(0x88, 0xaa, 0xff)));
        assert_eq!(Colour::parse("#88AAff"), Colour::parse("#8af"));
        assert_eq!(Colour::parse("#01020380").unwrap().alpha, 128);
        for text in ["#0a0b0c", "#0a0b0c0d"] {
            assert_eq!(Colour::parse(text).unwrap().to_string(), text);
        }
        assert_eq!(Colour::parse("red"), Some(Colour::new(255, 0, 0)));
        assert_eq!(Colour::parse("SteelBlue"), Colour::parse("#4682b4"));
        for text in ["", "#", "reddish", "8af", "#8a", "#8aff", "#gggggg", "#8888888888", "#\u{e4}\u{e4}"] {
            assert_eq!(Colour::parse(text), None, "{text}");
        }
    }
}
