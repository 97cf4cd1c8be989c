//! Reader of Zemax files.

use super::curvature::radius;
use super::decimal;
use super::glas::behind;
use super::kind::{Parameters, broken, shaped};
use super::words::number;
use crate::prescription::{
    Behind, CoordinateBreak, FieldKind, ImageSurface, Prescription, Surface, SystemAperture,
    WeightedWavelength,
};
use rayweave_error::{Classified, ErrorKind};
use rayweave_math::{Affine, Vec3};
use rayweave_optics::glass::{FileProblem, decode_text};
use std::collections::BTreeMap;

/// The units of lengths with their names, in nanometres.
pub(super) const UNITS: [(&str, f64); 4] = [("MM", 1e6), ("CM", 1e7), ("IN", 2.54e7), ("METER", 1e9)];

/// A prescription read from a file, with notes.
#[derive(Clone, Debug, PartialEq)]
pub struct Read {
    /// The prescription.
    pub prescription: Prescription,
    /// Everything in the file that can have an effect and is ignored or replaced, in the order of its lines. An unknown
    /// keyword is listed once, with all its lines.
    pub notes: Vec<FileProblem>,
}

/// The problems of a file, in the order of its lines; at most 200, and one about the rest.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}", problems.iter().map(FileProblem::to_string).collect::<Vec<_>>().join("\n"))]
pub struct ZmxError {
    /// The problems, line by line; at least one.
    pub problems: Vec<FileProblem>,
}

impl Classified for ZmxError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Input
    }
}

/// The maximum number of reported problems, and of notes. More indicate a file in a different format.
const MAX_PROBLEMS: usize = 200;

/// Cuts a list of problems, sorted by line, to [`MAX_PROBLEMS`] and one about the others.
fn limited(mut problems: Vec<FileProblem>, what: &str) -> Vec<FileProblem> {
    if let Some(rest) = problems.len().checked_sub(MAX_PROBLEMS).filter(|rest| *rest > 0) {
        let line = problems[MAX_PROBLEMS].line;
        problems.truncate(MAX_PROBLEMS);
        problems.push(FileProblem { line, text: format!("from here on there are {rest} more {what}.") });
    }
    problems
}

/// Reads a Zemax file in UTF-16, UTF-8 or Latin-1.
///
/// # Errors
/// All problems at once, each with its line: malformed numbers, unknown glasses, surface types that are not
/// read.
///
/// ```
/// use rayweave_lens::prescription::read_zmx;
///
/// let file = b"ENPD 10\nYFLN 0\nWAVM 1 0.55 1\nSURF 0\n DISZ INFINITY\nSURF 1\n STOP\n CURV 0.02\n DISZ 4\n GLAS N-BK7\nSURF 2\n DISZ 95\nSURF 3\n";
/// let lens = read_zmx(file)?.prescription;
/// assert_eq!(lens.surfaces.len(), 2);
/// assert_eq!(lens.surfaces[0].radius, 50.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_zmx(bytes: &[u8]) -> Result<Read, ZmxError> {
    let text = decode_text(bytes);
    let mut reader = Reader::default();
    for (index, line) in text.lines().enumerate() {
        reader.line = index + 1;
        if let Err(text) = reader.read(line.trim()) {
            reader.problems.push(FileProblem { line: index + 1, text });
        }
    }
    reader.finish()
}

/// Keywords without any effect on the light: versions, drawings, margins of computed semi-diameters, settings of other analyses.
const SILENT: [&str; 18] = [
    "VERS", "PFIL", "LANG", "SDMA", "OMMA", "PICB", "GLRS", "GSTD", "NSCD", "COFN", "COMM", "HIDE", "MIRR",
    "SLAB", "POPS", "FIMP", "HYPR", "MOFF",
];

/// The wavelength in micrometres above which a note suspects nanometres: no lens is designed for longer ones.
const LONGEST_UM: f64 = 100.0;

/// The effect of ignoring a keyword that often holds a neutral setting; empty if the setting is neutral. `None` for other
/// keywords.
fn setting(keyword: &str, words: &[&str]) -> Option<&'static str> {
    let is = |place: usize, value: f64| words.get(place).is_none_or(|word| word.parse() == Ok(value));
    let are_zero = (0..words.len()).all(|place| is(place, 0.0));
    let (has_effect, effect) = match keyword {
        "ENVD" => (
            !(is(2, 0.0) || is(0, 20.0) && is(1, 1.0)),
            "indices of glass are not adjusted to a temperature and a pressure",
        ),
        "GFAC" => (!is(0, 0.0), "the pupil is illuminated evenly, without apodisation"),
        "RAIM" => (!is(1, 0.0), "rays are aimed at the stop only on request"),
        "PUSH" => (!are_zero, "the shift of the pupil for ray aiming is not needed"),
        "ROPD" => (!is(0, 2.0), "wavefronts are referred to the exit pupil"),
        "POLS" => (!is(0, 1.0), "the light is not polarised"),
        "FWGN" | "FWGT" => (
            words.iter().any(|word| word.parse::<f64>() != words[0].parse()),
            "all fields have the same weight",
        ),
        "VDXN" | "VDYN" | "VCXN" | "VCYN" | "VANN" | "VDXT" | "VDYT" | "VCXT" | "VCYT" | "VANT" => {
            (!are_zero, "vignetting factors are not applied: the apertures of the surfaces vignette")
        }
        "FLAP" => (!is(0, 0.0), "the inner radius of a floating aperture is not applied"),
        "MNUM" => (!is(0, 1.0), "only the current one of several configurations is read"),
        _ => return None,
    };
    Some(if has_effect { effect } else { "" })
}

/// The number of lines that a note lists.
const LISTED: usize = 12;

/// Other lines to which a note applies, to follow its text.
fn also_on(lines: &[usize]) -> String {
    let listed: Vec<String> = lines.iter().take(LISTED).map(usize::to_string).collect();
    match (lines.len(), listed.as_slice()) {
        (0, _) => String::new(),
        (1, _) => format!(", also on line {}", lines[0]),
        (2..=LISTED, [first @ .., last]) => format!(", also on lines {} and {last}", first.join(", ")),
        (count, _) => format!(", also on lines {} and {} more", listed.join(", "), count - LISTED),
    }
}

/// The data of a surface read so far.
#[derive(Default)]
struct Record {
    line: usize,
    type_line: usize,
    kind: String,
    /// `None` without a curvature.
    radius: Option<f64>,
    conic: f64,
    thickness: f64,
    behind: Option<Behind>,
    semi_diameter: Option<f64>,
    /// The `DIAM` value, fixed or computed.
    diam: f64,
    mechanical_semi_diameter: Option<f64>,
    /// The line of the mechanical semi-diameter.
    mechanical_line: usize,
    hole: f64,
    /// The line of the hole.
    hole_line: usize,
    /// True if the aperture is decentred.
    is_decentred: bool,
    is_stop: bool,
    /// The parameters of the type, extra data included.
    parameters: Parameters,
}

#[derive(Default)]
struct Reader {
    line: usize,
    name: String,
    notes: Vec<String>,
    /// The glass catalogues in the order in which they are searched.
    makers: Vec<String>,
    unit_nm: Option<f64>,
    aperture: Option<SystemAperture>,
    kind: Option<FieldKind>,
    counts: Option<[usize; 2]>,
    fields: [Vec<f64>; 2],
    wavelengths: Vec<f64>,
    weights: Vec<f64>,
    primary: usize,
    surfaces: Vec<Record>,
    /// The lines of each keyword that is not known.
    unknown: BTreeMap<String, Vec<usize>>,
    ignored: Vec<FileProblem>,
    problems: Vec<FileProblem>,
}

impl Reader {
    fn read(&mut self, line: &str) -> Result<(), String> {
        let (keyword, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let words: Vec<&str> = rest.split_whitespace().collect();
        match keyword {
            "" => Ok(()),
            "SURF" => {
                self.surfaces.push(Record { line: self.line, ..Record::default() });
                Ok(())
            }
            _ if self.of_surface(keyword, &words)? || self.of_system(keyword, rest, &words)? => Ok(()),
            _ if SILENT.contains(&keyword) => Ok(()),
            _ => {
                match setting(keyword, &words) {
                    Some("") => {}
                    Some(effect) => self.note(format!("{keyword} is ignored: {effect}")),
                    None => self.unknown.entry(keyword.to_owned()).or_default().push(self.line),
                }
                Ok(())
            }
        }
    }

    /// The notes in the order of their lines.
    fn notes(&mut self) -> Vec<FileProblem> {
        let mut notes = std::mem::take(&mut self.ignored);
        let unknown = std::mem::take(&mut self.unknown);
        notes.extend(unknown.into_iter().map(|(keyword, lines)| FileProblem {
            line: lines[0],
            text: format!("{keyword} is ignored{}", also_on(&lines[1..])),
        }));
        notes.sort_by_key(|note| note.line);
        limited(notes, "notes")
    }

    /// Reads a system keyword; false if it is not one.
    fn of_system(&mut self, keyword: &str, rest: &str, words: &[&str]) -> Result<bool, String> {
        match keyword {
            "MODE" if words != ["SEQ"] => {
                return Err(format!("the mode is {rest}: only sequential systems, SEQ, are read."));
            }
            "MODE" => {}
            "NAME" => self.name = rest.trim().to_owned(),
            "NOTE" => {
                let (_, note) = rest.trim().split_once(' ').unwrap_or_default();
                self.notes.push(note.to_owned());
            }
            "GCAT" => self.makers = words.iter().map(|&word| word.to_owned()).collect(),
            "UNIT" => self.unit_nm = Some(unit(words.first().copied().unwrap_or(""))?),
            "ENPD" => self.aperture = Some(SystemAperture::EntrancePupilDiameter(number(words, 0)?)),
            "FNUM" => {
                self.aperture = Some(SystemAperture::FNumber(number(words, 0)?));
                if words.get(1) == Some(&"1") {
                    self.note(
                        "the paraxial working F-number is taken as the F-number at infinity".to_owned(),
                    );
                }
            }
            "OBNA" if words.get(1) == Some(&"1") => {
                return Err(
                    "the object aperture is an angle: only the numerical aperture is read.".to_owned()
                );
            }
            "OBNA" => self.aperture = Some(SystemAperture::ObjectNumericalAperture(number(words, 0)?)),
            "FLOA" => self.aperture = Some(SystemAperture::StopSemiDiameter(f64::NAN)),
            "FTYP" => {
                self.kind = Some(field_kind(words)?);
                if words.first() == Some(&"3") {
                    self.note("real image heights of fields are taken as paraxial ones".to_owned());
                }
                if words.get(1).is_some_and(|flag| *flag != "0") {
                    let text = "the object space is telecentric, which is ignored: chief rays go through the centre of the stop";
                    self.note(text.to_owned());
                }
                if words.get(6).is_some_and(|flag| *flag != "0") {
                    let text = "the image space is afocal, which is ignored: rays are taken where they hit the image surface";
                    self.note(text.to_owned());
                }
                let count = |k: usize| words.get(k).and_then(|word| word.parse::<usize>().ok());
                self.counts = count(2).zip(count(3)).map(|(fields, lines)| [fields, lines]);
            }
            "XFLN" | "XFLD" => self.fields[0] = numbers(words)?,
            "YFLN" | "YFLD" => self.fields[1] = numbers(words)?,
            "WAVM" => {
                let wavelength = number(words, 1)?;
                self.note_wavelengths(&[wavelength]);
                self.wavelengths.push(wavelength);
                self.weights.push(number(words, 2).unwrap_or(1.0));
            }
            "WAVL" | "WAVN" => {
                self.wavelengths = numbers(words)?;
                self.note_wavelengths(&self.wavelengths.clone());
            }
            "WWGT" | "WWGN" => self.weights = numbers(words)?,
            "PWAV" => self.primary = whole(words, 0)?.max(1) - 1,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Reads a keyword of the last surface; false if it is not one.
    fn of_surface(&mut self, keyword: &str, words: &[&str]) -> Result<bool, String> {
        let Some(surface) = self.surfaces.last_mut() else { return Ok(false) };
        let is_standard = matches!(surface.kind.as_str(), "" | "STANDARD");
        match keyword {
            "TYPE" => {
                surface.type_line = self.line;
                surface.kind = words.first().copied().unwrap_or("").to_owned();
            }
            "PARM" if is_standard => {}
            "XDAT" if is_standard => return Ok(false),
            "PARM" => surface.parameters.set(whole(words, 0)?, number(words, 1)?)?,
            "XDAT" => surface.parameters.set_extra(whole(words, 0)?, number(words, 1)?)?,
            "CURV" => {
                let curvature = number(words, 0)?;
                surface.radius = words.first().map(|text| radius(text, curvature));
            }
            "CONI" => surface.conic = number(words, 0)?,
            "DISZ" if words.first() == Some(&"INFINITY") => surface.thickness = f64::INFINITY,
            "DISZ" => surface.thickness = number(words, 0)?,
            "GLAS" => {
                let (behind, note) = behind(words, &self.makers)?;
                surface.behind = Some(behind);
                note.into_iter().for_each(|note| self.note(note));
                if words.get(1) == Some(&"4") {
                    self.note("the offset of index and Abbe number in GLAS is ignored".to_owned());
                }
                let deviation = number(words, 5).unwrap_or(0.0);
                if words.first() == Some(&"___BLANK") && deviation != 0.0 {
                    self.note(format!(
                        "the deviation {deviation} of the partial dispersion in GLAS is ignored"
                    ));
                }
            }
            "DIAM" => {
                let is_fixed = words.get(1).is_some_and(|flag| *flag != "0");
                let value = number(words, 0)?;
                surface.diam = value;
                surface.semi_diameter = (is_fixed && value > 0.0).then_some(value).or(surface.semi_diameter);
            }
            // a computed one is the greatest clear one of the lens
            "MEMA" if words.get(1).is_some_and(|flag| *flag != "0") => {
                surface.mechanical_semi_diameter = Some(number(words, 0)?).filter(|value| *value > 0.0);
                surface.mechanical_line = self.line;
            }
            "MEMA" => {}
            "CLAP" => {
                let (inner, outer) = (number(words, 0)?, outer_radius(words, 1)?);
                if inner < 0.0 || outer.is_some_and(|outer| outer > 0.0 && outer <= inner) {
                    let text = words[..2].join(" to ");
                    return Err(format!(
                        "the aperture reaches from radius {text}: the outer radius must be the greater one."
                    ));
                }
                (surface.hole, surface.hole_line) = (inner, self.line);
                surface.semi_diameter = outer.filter(|outer| *outer > 0.0).or(surface.semi_diameter);
            }
            "OBDC" if numbers(&words[..words.len().min(2)])?.iter().any(|&place| place != 0.0) => {
                surface.is_decentred = true;
                self.note(
                    "the decentred aperture, OBDC, is replaced by one about the vertex that contains all rays"
                        .to_owned(),
                );
            }
            "STOP" => surface.is_stop = true,
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// Notes a wavelength that may be stated in nanometres.
    fn note_wavelengths(&mut self, micrometres: &[f64]) {
        if let Some(wavelength) = micrometres.iter().find(|wavelength| **wavelength > LONGEST_UM) {
            self.note(format!(
                "the wavelength {wavelength} is one in micrometres, as in all Zemax files: {wavelength} nm would be {}",
                decimal(wavelength / 1e3)
            ));
        }
    }

    fn note(&mut self, text: String) {
        self.ignored.push(FileProblem { line: self.line, text });
    }

    fn problem(&mut self, line: usize, text: &str) {
        self.problems.push(FileProblem { line, text: text.to_owned() });
    }

    fn finish(mut self) -> Result<Read, ZmxError> {
        if self.surfaces.is_empty() && self.aperture.is_none() && self.wavelengths.is_empty() {
            self.problems.clear();
            self.problem(
                1,
                "the file has no line of a Zemax file (SURF, ENPD, WAVM, ...). Is it a different kind of file?",
            );
            return Err(ZmxError { problems: self.problems });
        }
        self.check_distances();
        let breaks = self.take_breaks();
        let stop = self.surfaces.iter().position(|surface| surface.is_stop);
        if self.surfaces.len() < 3 {
            self.problem(
                self.line,
                "the file has no surface between object and image: it needs three SURF lines.",
            );
        } else if !stop.is_some_and(|stop| (1..self.surfaces.len() - 1).contains(&stop)) {
            self.problem(self.line, "no surface between object and image is the STOP");
        }
        if self.aperture.is_none() {
            self.problem(self.line, "the file has no aperture: it needs one of ENPD, FNUM, OBNA, FLOA.");
        }
        let sizeless = |stop: &Record| stop.semi_diameter.unwrap_or(stop.diam) <= 0.0;
        let floating = matches!(self.aperture, Some(SystemAperture::StopSemiDiameter(_)));
        let stop_line = stop
            .map(|stop| &self.surfaces[stop])
            .filter(|stop| floating && sizeless(stop))
            .map(|stop| stop.line);
        if let Some(line) = stop_line {
            self.problem(
                line,
                "the stop has no semi-diameter, DIAM, and the aperture is that of the stop, FLOA",
            );
        }
        let lines = self.lines();
        if lines.is_empty() {
            self.problem(self.line, "the file has no wavelength: it needs WAVM or WAVL.");
        }
        let surfaces = self.surfaces();
        match (self.problems.is_empty(), stop, self.aperture) {
            (true, Some(stop), Some(aperture)) => {
                self.note_ends(&surfaces);
                self.note_holes();
                self.note_mirrors();
                self.ignored = self.notes();
                let Read { prescription, notes } = self.prescription(surfaces, (stop, aperture), lines);
                Ok(Read { prescription: Prescription { breaks, ..prescription }, notes })
            }
            _ => {
                self.problems.sort_by_key(|problem| problem.line);
                Err(ZmxError { problems: limited(self.problems, "problems") })
            }
        }
    }

    fn check_distances(&mut self) {
        let far = self.surfaces.iter().skip(1).find(|surface| surface.thickness.is_infinite());
        if let Some(line) = far.map(|surface| surface.line) {
            self.problem(
                line,
                "the distance to the next surface is infinite: only that of the object may be.",
            );
        }
    }

    /// Removes coordinate breaks from the list of surfaces. Their thicknesses are added to that of the
    /// surface before, for first-order data, and undone in the frame of the surface behind.
    fn take_breaks(&mut self) -> Vec<CoordinateBreak> {
        let along = |z: f64| Affine::translate(Vec3::Z * z);
        let mut breaks = Vec::new();
        let (mut kept, mut frame): (Vec<Record>, Option<(Affine, f64)>) = (Vec::new(), None);
        for record in std::mem::take(&mut self.surfaces) {
            if record.kind != "COORDBRK" || kept.is_empty() {
                let moved = frame.take().map(|(map, by)| map.then(&along(-by)));
                breaks.extend(moved.map(|map| CoordinateBreak { before: kept.len(), map }));
                kept.push(record);
                continue;
            }
            match broken(&record.parameters) {
                Ok(own) => {
                    let (map, by) = frame.unwrap_or((Affine::IDENTITY, 0.0));
                    frame = Some((along(record.thickness).then(&own).then(&map), by + record.thickness));
                    kept.iter_mut()
                        .last()
                        .into_iter()
                        .for_each(|before| before.thickness += record.thickness);
                    let text =
                        "the coordinate break is not a surface of its own; surfaces are counted without it"
                            .to_owned();
                    self.ignored.push(FileProblem { line: record.line, text });
                }
                Err(text) => self.problem(record.type_line, &text),
            }
        }
        if frame.is_some() {
            self.problem(self.line, "the image is a coordinate break: it has to be a surface.");
        }
        self.surfaces = kept;
        breaks
    }

    fn lines(&self) -> Vec<WeightedWavelength> {
        let count = self.counts.map_or(usize::MAX, |counts| counts[1].max(1));
        let line = |(k, &um): (usize, &f64)| WeightedWavelength {
            wavelength_nm: decimal(um * 1e3),
            weight: self.weights.get(k).copied().unwrap_or(1.0),
        };
        self.wavelengths.iter().enumerate().take(count).map(line).collect()
    }

    fn fields(&self) -> Vec<[f64; 2]> {
        let given = self.fields[0].len().max(self.fields[1].len());
        let count = self.counts.map_or(given, |counts| counts[0].min(given)).max(1);
        let at = |axis: usize, k: usize| self.fields[axis].get(k).copied().unwrap_or(0.0);
        (0..count).map(|k| [at(0, k), at(1, k)]).collect()
    }

    /// All surfaces, object and image included; invalid types and parameters are reported as problems.
    fn surfaces(&mut self) -> Vec<Surface> {
        let found: Vec<_> = self.surfaces.iter().map(|record| (record.type_line, record.surface())).collect();
        let kept = |(line, surface): (usize, Result<Surface, String>)| {
            surface.map_err(|text| self.problem(line, &text)).ok()
        };
        found.into_iter().filter_map(kept).collect()
    }

    /// Notes that terms of object and image are ignored.
    fn note_ends(&mut self, surfaces: &[Surface]) {
        let last = surfaces.len().saturating_sub(1);
        for (k, name) in [(0, "object"), (last, "image")] {
            if surfaces.get(k).is_some_and(|surface| !surface.is_conic()) {
                let line = self.surfaces[k].type_line;
                let text = format!("the terms of the {name} beyond its conic are ignored");
                self.ignored.push(FileProblem { line, text });
            }
        }
    }

    /// Notes that only mirrors have a hole.
    fn note_holes(&mut self) {
        for record in &self.surfaces {
            if record.hole > 0.0 && record.behind != Some(Behind::Mirror) {
                let text = format!(
                    "the inner radius {} of the aperture, CLAP, is ignored: only mirrors have a central hole",
                    record.hole
                );
                self.ignored.push(FileProblem { line: record.hole_line, text });
            }
        }
    }

    /// Notes that a mirror has no rim.
    fn note_mirrors(&mut self) {
        for record in &self.surfaces {
            if let (Some(radius), Some(Behind::Mirror)) = (record.mechanical_semi_diameter, &record.behind) {
                let text = format!(
                    "the mechanical semi-diameter {radius} of the mirror, MEMA, is ignored: a mirror ends at its clear semi-diameter"
                );
                self.ignored.push(FileProblem { line: record.mechanical_line, text });
            }
        }
    }

    fn prescription(
        self,
        surfaces: Vec<Surface>,
        (stop, aperture): (usize, SystemAperture),
        lines: Vec<WeightedWavelength>,
    ) -> Read {
        let fields = self.fields();
        let last = self.surfaces.len() - 1;
        let image = &self.surfaces[last];
        let image = ImageSurface {
            radius: image.radius.unwrap_or(f64::INFINITY),
            conic: image.conic,
            semi_diameter: image.semi_diameter,
        };
        let stop_radius = self.surfaces[stop].semi_diameter.unwrap_or(self.surfaces[stop].diam);
        let aperture = match aperture {
            SystemAperture::StopSemiDiameter(_) => SystemAperture::StopSemiDiameter(stop_radius),
            aperture => aperture,
        };
        let prescription = Prescription {
            name: self.name,
            notes: self.notes,
            unit_nm: self.unit_nm.unwrap_or(1e6),
            aperture,
            field_kind: self.kind.unwrap_or(FieldKind::Angle),
            fields,
            lines,
            primary: self.primary,
            object_distance: self.surfaces[0].thickness,
            surfaces: surfaces[1..last].to_vec(),
            stop,
            image,
            breaks: Vec::new(),
        };
        Read { prescription, notes: self.ignored }
    }
}

impl Record {
    fn surface(&self) -> Result<Surface, String> {
        let behind = self.behind.clone().unwrap_or(Behind::Air);
        let radius = self.radius.unwrap_or(f64::INFINITY);
        let conic = Surface {
            semi_diameter: self.semi_diameter.filter(|_| !self.is_decentred),
            mechanical_semi_diameter: self.mechanical_semi_diameter.filter(|_| behind != Behind::Mirror),
            ..Surface::new(radius, self.thickness, behind).conic(self.conic).hole(self.hole)
        };
        shaped(&self.kind, &self.parameters, conic)
    }
}

fn unit(name: &str) -> Result<f64, String> {
    let known = UNITS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
    known
        .map(|(_, nm)| *nm)
        .ok_or_else(|| format!("the unit {name:?} is not known: MM, CM, IN and METER are."))
}

fn field_kind(words: &[&str]) -> Result<FieldKind, String> {
    match words.first().copied() {
        Some("0") => Ok(FieldKind::Angle),
        Some("1") => Ok(FieldKind::ObjectHeight),
        Some("2" | "3") => Ok(FieldKind::ImageHeight),
        other => Err(format!(
            "fields are of type {}: only 0 to 3 are read (angle, object height, paraxial and real image height).",
            other.unwrap_or("nothing")
        )),
    }
}

/// The outer radius of an aperture; `None` if it is infinite.
fn outer_radius(words: &[&str], place: usize) -> Result<Option<f64>, String> {
    let is_infinite = |word: &&str| ["INF", "INFINITY"].iter().any(|name| word.eq_ignore_ascii_case(name));
    if words.get(place).is_some_and(is_infinite) { Ok(None) } else { number(words, place).map(Some) }
}

fn whole(words: &[&str], place: usize) -> Result<usize, String> {
    let word = words.get(place).copied().unwrap_or("");
    word.parse().map_err(|_| format!("{word:?} is not a whole number"))
}

fn numbers(words: &[&str]) -> Result<Vec<f64>, String> {
    (0..words.len()).map(|k| number(words, k)).collect()
}
