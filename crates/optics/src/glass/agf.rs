//! Reader of AGF files, the text format in which Zemax and all glass makers provide glass catalogues.
//!
//! A catalogue begins with `CC` and a comment; a glass begins with its `NM` line, and lines in any
//! order follow:
//!
//! | line | holds | read |
//! | --- | --- | --- |
//! | `NM` | name, number of the formula (1 to 13), MIL number, n_d, V_d, exclude, status, melt frequency | the first five |
//! | `GC` | a comment on the glass | as its source, with the comment of `CC` |
//! | `CD` | up to ten coefficients of the formula | yes |
//! | `LD` | shortest and longest wavelength in µm | yes |
//! | `IT` | wavelength in µm, internal transmittance, thickness in mm | yes |
//! | `ED`, `TD`, `MD`, `OD`, `BD` | expansion, thermal, mechanical, other data, stress | ignored |
//!
//! Indices are those at the catalogue's temperature and pressure. Files come in UTF-16 with or
//! without a byte order mark, in UTF-8 and in Latin-1; [`read_agf`] detects the encoding. The
//! format: Zemax OpticStudio user guide, "The AGF & BGF file formats".

use super::read::{FileProblem, GlassFileError, finish, nm_from_um, number, numbers};
use super::{Dispersion, Glass, Published, Transmittance};

/// Reads a glass catalogue; `maker` is the maker of its glasses, and may be empty.
///
/// # Errors
/// All problems of the file at once, each with its line. Glasses without problems remain available:
/// [`into_readable`](GlassFileError::into_readable).
///
/// ```
/// use rayweave_optics::glass::read_agf;
/// let file = b"CC an example\nNM MINE 5 0 1.5 60 0 0\nCD 1.5 0.01 0.0005\nLD 0.4 0.7\nIT 0.5 0.99 10\n";
/// let glasses = read_agf(file, "Me").unwrap();
/// assert_eq!(glasses[0].name(), "MINE");
/// assert_eq!(glasses[0].range_nm(), [400.0, 700.0]);
/// ```
pub fn read_agf(bytes: &[u8], maker: &str) -> Result<Vec<Glass>, GlassFileError> {
    let text = decode_text(bytes);
    let mut reader = Reader { maker, ..Reader::default() };
    for (index, line) in text.lines().enumerate() {
        reader.read_line(index + 1, line.trim());
    }
    reader.finish_glass();
    finish(reader.glasses, reader.problems)
}

/// The text of a file in UTF-16 or UTF-8, with or without a byte order mark, or else in Latin-1.
pub fn decode_text(bytes: &[u8]) -> String {
    let zero_at = |parity: usize| bytes.iter().skip(parity).step_by(2).take(64).any(|&byte| byte == 0);
    match bytes {
        [0xff, 0xfe, text @ ..] => utf16(text, u16::from_le_bytes),
        [0xfe, 0xff, text @ ..] => utf16(text, u16::from_be_bytes),
        [0xef, 0xbb, 0xbf, text @ ..] => String::from_utf8_lossy(text).into_owned(),
        // text of this format is mostly ASCII, whose high bytes are zero
        _ if zero_at(1) => utf16(bytes, u16::from_le_bytes),
        _ if zero_at(0) => utf16(bytes, u16::from_be_bytes),
        _ => match str::from_utf8(bytes) {
            Ok(text) => text.to_owned(),
            Err(_) => bytes.iter().map(|&byte| char::from(byte)).collect(),
        },
    }
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    char::decode_utf16(units).map(|read| read.unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
}

#[derive(Default)]
struct Reader<'a> {
    maker: &'a str,
    catalogue: String,
    current: Option<Record>,
    glasses: Vec<Glass>,
    problems: Vec<FileProblem>,
}

/// The lines of one glass.
struct Record {
    line: usize,
    name: String,
    formula: u32,
    published: Option<Published>,
    comment: String,
    coefficients: Option<(usize, Vec<f64>)>,
    range: Option<(usize, [f64; 2])>,
    transmittances: Vec<Transmittance>,
    /// True if one of its lines is invalid.
    is_invalid: bool,
}

impl Reader<'_> {
    fn read_line(&mut self, line: usize, text: &str) {
        let (mnemonic, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let outcome = match mnemonic {
            "CC" => {
                self.catalogue = rest.trim().to_owned();
                Ok(())
            }
            "NM" => self.begin_glass(line, rest),
            "GC" | "CD" | "LD" | "IT" => self.read_part(line, mnemonic, rest),
            _ => Ok(()),
        };
        if let Err(text) = outcome {
            self.report(line, text);
        }
    }

    fn report(&mut self, line: usize, text: String) {
        self.problems.push(FileProblem { line, text });
        if let Some(record) = &mut self.current {
            record.is_invalid = true;
        }
    }

    fn begin_glass(&mut self, line: usize, rest: &str) -> Result<(), String> {
        self.finish_glass();
        let words: Vec<&str> = rest.split_whitespace().collect();
        let name = words.first().copied().unwrap_or_default().to_owned();
        self.current = Some(Record::new(line, name));
        let [_, formula, _, n_d, v_d, ..] = words[..] else {
            return Err(
                "an NM line is too short: it needs a name, a formula, a MIL number, n_d and V_d.".to_owned()
            );
        };
        let (formula, n_d, v_d) = (whole(formula)?, number(n_d)?, number(v_d)?);
        if let Some(record) = &mut self.current {
            record.formula = formula;
            // these files give materials that are opaque at the d line an index of 1 and an Abbe number of 0
            record.published = (n_d > 1.0 && v_d > 0.0).then_some(Published { n_d, v_d });
        }
        Ok(())
    }

    fn read_part(&mut self, line: usize, mnemonic: &str, rest: &str) -> Result<(), String> {
        let Some(record) = &mut self.current else {
            return Err(format!("a {mnemonic} line has no glass: a glass begins with an NM line."));
        };
        match mnemonic {
            "GC" => record.comment = rest.trim().to_owned(),
            "CD" => record.coefficients = Some((line, numbers(rest)?)),
            "LD" => record.range = Some((line, read_range(rest)?)),
            _ => record.transmittances.push(read_transmittance(rest)?),
        }
        Ok(())
    }

    fn finish_glass(&mut self) {
        let Some(record) = self.current.take() else { return };
        if record.is_invalid {
            return;
        }
        match record.glass(self.maker, &self.catalogue) {
            Ok(glass) => self.glasses.push(glass),
            Err(problem) => self.problems.push(problem),
        }
    }
}

/// A whole number, which some files write with a decimal point.
fn whole(word: &str) -> Result<u32, String> {
    let value = number(word)?;
    let whole = value as u32;
    if f64::from(whole) == value {
        Ok(whole)
    } else {
        Err(format!("{word:?} is not the number of a formula."))
    }
}

fn read_range(rest: &str) -> Result<[f64; 2], String> {
    match numbers(rest)?[..] {
        [first, last, ..] => Ok([nm_from_um(first), nm_from_um(last)]),
        _ => {
            Err("an LD line is too short: it needs the shortest and the longest wavelength in µm.".to_owned())
        }
    }
}

fn read_transmittance(rest: &str) -> Result<Transmittance, String> {
    let [um, transmittance, thickness_mm, ..] = numbers(rest)?[..] else {
        return Err(
            "an IT line is too short: it needs a wavelength in µm, a transmittance and a thickness in mm."
                .to_owned(),
        );
    };
    let measured = Transmittance { wavelength_nm: nm_from_um(um), transmittance, thickness_mm };
    measured.check().map_err(|error| error.to_string())?;
    Ok(measured)
}

impl Record {
    fn new(line: usize, name: String) -> Record {
        Record {
            line,
            name,
            formula: 0,
            published: None,
            comment: String::new(),
            coefficients: None,
            range: None,
            transmittances: Vec::new(),
            is_invalid: false,
        }
    }

    fn glass(self, maker: &str, catalogue: &str) -> Result<Glass, FileProblem> {
        let at = |line: usize| move |text: String| FileProblem { line, text };
        let missing = |what: &str| at(self.line)(format!("{} has no {what} line.", self.name));
        let (line, coefficients) = self.coefficients.as_ref().ok_or_else(|| missing("CD"))?;
        let dispersion =
            Dispersion::agf(self.formula, coefficients).map_err(|error| at(*line)(error.to_string()))?;
        let (line, range_nm) = self.range.ok_or_else(|| missing("LD"))?;
        let source = [self.comment.as_str(), catalogue].into_iter().filter(|text| !text.is_empty());
        let mut glass = Glass::new(self.name.as_str(), dispersion)
            .with_maker(maker)
            .with_source(source.collect::<Vec<_>>().join("; "))
            .with_range_nm(range_nm)
            .map_err(|error| at(line)(error.to_string()))?;
        if let Some(published) = self.published {
            glass = glass.with_published(published);
        }
        if self.transmittances.is_empty() {
            return Ok(glass);
        }
        glass.with_transmittances(&self.transmittances).map_err(|error| at(self.line)(error.to_string()))
    }
}
