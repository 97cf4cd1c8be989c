//! Zemax files (`.zmx`): sequential lens prescriptions as text.
//!
//! A line is a keyword and its arguments; lines about a surface follow its `SURF` line. These keywords are
//! read and written:
//!
//! | keyword | holds |
//! | --- | --- |
//! | `NAME`, `NOTE 0` | the name, a line of notes |
//! | `UNIT` | the unit of lengths: MM, CM, IN, METER |
//! | `ENPD`, `FNUM`, `OBNA`, `FLOA` | diameter of the entrance pupil, F-number, object aperture, or float by the size of the stop |
//! | `FTYP` | kind of field (0 angle, 1 object height, 2 paraxial image height; 3, real image height, is read as 2), then the numbers of fields and of wavelengths |
//! | `XFLN`, `YFLN` (`XFLD`, `YFLD`) | fields |
//! | `WAVM n` (`WAVL`, `WWGT`), `PWAV` | wavelengths in µm with weights, the primary one |
//! | `SURF n` | begins a surface: 0 is the object, the last one the image |
//! | `TYPE` | STANDARD, EVENASPH, XASPHERE, ODDASPHE, BICONICX, TOROIDAL, XPOLYNOM, SZERNSAG or FZERNSAG |
//! | `PARM 1` to `PARM 8` | of EVENASPH, SZERNSAG and FZERNSAG, the coefficients of r^2, r^4, ..., r^16; of ODDASPHE, those of r, r^2, ..., r^8; of BICONICX, radius (0 for none) and conic constant along x; of TOROIDAL, the radius of rotation (0 for a cylinder) and the coefficients of y^2, y^4, ..., y^14 |
//! | from `XDAT 1`, or from `PARM 13` | of XASPHERE, the number of terms, the radius by which r is divided, the coefficients of r^2, r^4, ..., r^16; of XPOLYNOM, SZERNSAG and FZERNSAG, the number of terms, the radius by which x and y are divided, the coefficients: of x, y, x^2, x y, y^2, ...; of Noll's Zernike polynomials; of those in the fringe order |
//! | `CURV`, `CONI`, `DISZ` | curvature, conic constant, distance to the next surface |
//! | `GCAT` | the catalogues of glasses, in the order in which they are searched; the other makers follow. A file is written with the makers of all its glasses. A glass that another catalogue may mean, one that is not built in and comes first, is noted unless index and Abbe number in the file agree |
//! | `GLAS` | `MIRROR`, the name of a glass, or `___BLANK` with index and Abbe number, which also replace unknown glasses and those whose index in the catalogues differs by more than 1e-4 |
//! | `DIAM r 1`, `CLAP hole r` | semi-diameter, if it is fixed (a computed one, `DIAM r 0`, is recomputed) |
//! | `STOP` | the stop |
//!
//! `MODE` has to be `SEQ`. An outer radius `INF` of `CLAP` means no limit. Keywords without an effect on light (drawings,
//! mechanical data) are ignored silently, as are settings without an effect (vignetting factors of 0, equal weights, no ray
//! aiming). All others are ignored with a note of their lines; so are the flags of telecentric and afocal systems in `FTYP`. The format has no public
//! specification; the reader follows the Zemax OpticStudio user guide, "Lens data editor", and files
//! published by lens makers.

mod curvature;
mod glas;
mod kind;
mod read;
mod words;
mod write;

use rayweave_math::round_to_digits;

pub use read::{Read, ZmxError, read_zmx};
pub use write::write_zmx;

/// Significant digits within which a number counts as decimal.
const DIGITS: usize = 12;

/// The number rounded to 12 digits, if that changes it by no more than rounding error; otherwise unchanged.
fn decimal(value: f64) -> f64 {
    let short = round_to_digits(value, DIGITS);
    if ((short - value) / value).abs() <= 1e-15 { short } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_are_recovered() {
        assert_eq!(decimal(1.0 / (1.0 / 22.01359)), 22.01359);
        assert_eq!(decimal(587.5618 / 1e3), 0.5875618);
        assert_eq!(decimal(1.0 / 3.0), 1.0 / 3.0);
        assert_eq!(decimal(f64::INFINITY), f64::INFINITY);
    }
}
