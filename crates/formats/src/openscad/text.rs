//! Text (`text`): glyph outlines along a line.
//!
//! Positions are those of OpenSCAD 2021.01: a port of HarfBuzz does the shaping, an em is the size divided by 0.72, and
//! curves have the same number of chords. OpenSCAD also hints glyphs, i.e. rounds outlines to a grid, by up to 1/32 of a
//! unit; that is not reproduced.

use super::arguments::{Arguments, Refusal};
use super::facets::Fineness;
use super::flat::Leaf;
use super::value::Value;
use fontdb::{Database, Family, ID, Query, Style, Weight};
use harfrust::{Direction, FontRef, GlyphBuffer, Language, Script, ShapeOptions, ShaperData, UnicodeBuffer};
use rayweave_polygon::Point;
use std::path::PathBuf;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// Em per text size: points of 1/72 inch at 100 dots per inch.
const EM: f64 = 100.0 / 72.0;

/// Factor by which OpenSCAD reduces advances and alignment offsets relative to the outlines.
const TIGHT: f64 = 1.0 / 1.024;

/// Substitutes for a missing font, in order of preference.
const STAND_INS: [&str; 5] = ["Liberation Sans", "Arimo", "Arial", "Helvetica", "DejaVu Sans"];

/// The default font of OpenSCAD.
const DEFAULT: &str = "Liberation Sans";

/// Maximum number of characters of a text.
const MAX_LETTERS: usize = 10_000;

/// Font databases, loaded at the first text.
pub(super) struct Fonts {
    paths: Vec<PathBuf>,
    given: Option<Database>,
    system: Option<Database>,
}

/// Leaves of a text, and the name of the substitute if its font is missing.
pub(super) struct Letters {
    pub leaves: Vec<Leaf>,
    pub stand_in: Option<String>,
}

impl Fonts {
    pub fn new(paths: &[PathBuf]) -> Fonts {
        Fonts { paths: paths.to_vec(), given: None, system: None }
    }

    fn given(&mut self) -> &Database {
        let paths = &self.paths;
        self.given.get_or_insert_with(|| {
            let mut database = Database::new();
            for path in paths {
                match path.is_dir() {
                    true => database.load_fonts_dir(path),
                    // a file that is not a font contributes none
                    false => database.load_font_file(path).unwrap_or(()),
                }
            }
            database
        })
    }

    fn system(&mut self) -> &Database {
        self.system.get_or_insert_with(|| {
            let mut database = Database::new();
            database.load_system_fonts();
            database
        })
    }

    /// A font by name, or a substitute with its name. Given font files have priority over system fonts.
    fn find(&mut self, wanted: &Wanted) -> Option<(&Database, ID, Option<String>)> {
        let names = std::iter::once(wanted.family.as_str()).chain(STAND_INS);
        for name in names {
            for is_given in [true, false] {
                let database = if is_given { self.given() } else { self.system() };
                if let Some(id) = wanted.query(database, name) {
                    let stand_in = (name != wanted.family).then(|| name.to_owned());
                    let database = if is_given { self.given() } else { self.system() };
                    return Some((database, id, stand_in));
                }
            }
        }
        None
    }
}

/// A font specification `Family:style=Bold Italic`.
struct Wanted {
    family: String,
    weight: Weight,
    style: Style,
}

impl Wanted {
    fn new(font: &str) -> Wanted {
        let (family, rest) = font.split_once(':').unwrap_or((font, ""));
        let style = rest.to_ascii_lowercase();
        let family = if family.trim().is_empty() { DEFAULT } else { family.trim() };
        Wanted {
            family: family.to_owned(),
            weight: if style.contains("bold") { Weight::BOLD } else { Weight::NORMAL },
            style: match () {
                () if style.contains("italic") => Style::Italic,
                () if style.contains("oblique") => Style::Oblique,
                () => Style::Normal,
            },
        }
    }

    fn query(&self, database: &Database, family: &str) -> Option<ID> {
        let families = [Family::Name(family)];
        let query = Query { families: &families, weight: self.weight, style: self.style, ..Query::default() };
        database.query(&query)
    }
}

/// Text and layout parameters of an item.
struct Setting<'a> {
    text: &'a str,
    size: f64,
    spacing: f64,
    horizontal: &'a str,
    vertical: &'a str,
    direction: &'a str,
    script: &'a str,
    language: &'a str,
    /// Number of chords of a curve.
    pieces: usize,
}

/// `text(text, size, font, spacing, direction, language, script, halign, valign)`.
pub(super) fn text(arguments: &Arguments, fonts: &mut Fonts) -> Result<Letters, Refusal> {
    let word = |name, default| Ok::<&str, Refusal>(arguments.get(name, "a string", word)?.unwrap_or(default));
    let wanted = Wanted::new(word("font", "")?);
    let size = arguments.number("size", 10.0)?;
    let setting = Setting {
        text: word("text", "")?,
        size,
        spacing: arguments.number("spacing", 1.0)?,
        horizontal: word("halign", "left")?,
        vertical: word("valign", "baseline")?,
        direction: word("direction", "")?,
        script: word("script", "")?,
        language: word("language", "")?,
        pieces: (Fineness::of(arguments)?.fragments(size) / 8 + 1).max(2),
    };
    if setting.text.chars().count() > MAX_LETTERS {
        return Err(arguments.refusal(&format!("it has more than {MAX_LETTERS} letters")));
    }
    if setting.text.is_empty() || size <= 0.0 {
        return Ok(Letters { leaves: Vec::new(), stand_in: None });
    }
    let Some((database, id, stand_in)) = fonts.find(&wanted) else {
        return Err(arguments.refusal(&format!(
            "there is no font `{}` and no substitute. Give a font file or a folder of fonts",
            wanted.family
        )));
    };
    // a font is parsed for each text
    arguments.spend(1_000_000 + 10_000 * setting.text.len())?;
    let leaves = database.with_face_data(id, |data, index| {
        let face = Face::parse(data, index).ok()?;
        let glyphs = setting.shaped(&FontRef::from_index(data, index).ok()?);
        Some(setting.leaves(arguments, &face, &glyphs))
    });
    let leaves = leaves.flatten().ok_or_else(|| arguments.refusal("its font cannot be read"))??;
    Ok(Letters {
        leaves,
        stand_in: stand_in.map(|name| format!("uses the font `{name}` instead of `{}`", wanted.family)),
    })
}

fn word(value: &Value) -> Option<&str> {
    match value {
        Value::Text(text) => Some(text),
        _ => None,
    }
}

impl Setting<'_> {
    /// Glyphs and positions after shaping.
    fn shaped(&self, font: &FontRef) -> GlyphBuffer {
        let mut buffer = UnicodeBuffer::new();
        buffer.push_str(self.text);
        // missing or unknown properties are derived from the characters
        buffer.guess_segment_properties();
        if let Ok(direction) = self.direction.parse::<Direction>() {
            buffer.set_direction(direction);
        }
        if let Ok(script) = self.script.parse::<Script>() {
            buffer.set_script(script);
        }
        if let Ok(language) = self.language.parse::<Language>() {
            buffer.set_language(language);
        }
        ShaperData::new(font).shaper(font).build().shape(buffer, ShapeOptions::new())
    }

    /// The outlines in their positions.
    fn leaves(&self, arguments: &Arguments, face: &Face, glyphs: &GlyphBuffer) -> Result<Vec<Leaf>, Refusal> {
        let unit = self.size * EM / f64::from(face.units_per_em());
        let start = self.start(face, glyphs);
        let mut at = [0.0; 2];
        let mut leaves = Vec::new();
        for (info, place) in glyphs.glyph_infos().iter().zip(glyphs.glyph_positions()) {
            let offset = [place.x_offset, place.y_offset].map(f64::from);
            let by = [0, 1].map(|axis| TIGHT * (start[axis] + at[axis] + offset[axis]));
            let outline = self.outline(face, glyph_id(info.glyph_id), unit, by);
            arguments.hold(outline.as_ref().map_or(0, Leaf::point_count))?;
            leaves.extend(outline);
            at[0] += self.spacing * f64::from(place.x_advance);
            at[1] += self.spacing * f64::from(place.y_advance);
        }
        Ok(leaves)
    }

    /// Position of the first glyph in font units: alignment uses advances along the line and bounding boxes across it.
    fn start(&self, face: &Face, glyphs: &GlyphBuffer) -> Point {
        let boxes = || {
            glyphs.glyph_infos().iter().filter_map(|info| face.glyph_bounding_box(glyph_id(info.glyph_id)))
        };
        let advance = |along: fn(&harfrust::GlyphPosition) -> i32| {
            self.spacing * glyphs.glyph_positions().iter().map(along).map(f64::from).sum::<f64>()
        };
        let along_x = advance(|place| place.x_advance);
        let (width, above, below) = match along_x != 0.0 {
            true => (
                along_x,
                boxes().map(|b| f64::from(b.y_max)).fold(0.0, f64::max),
                boxes().map(|b| -f64::from(b.y_min)).fold(0.0, f64::max),
            ),
            false => {
                let width = boxes().map(|b| f64::from(b.x_max) - f64::from(b.x_min)).fold(0.0, f64::max);
                (width, advance(|place| place.y_advance), 0.0)
            }
        };
        [self.across(width), self.upward(above, below)]
    }

    fn across(&self, width: f64) -> f64 {
        match self.horizontal {
            "right" => -width,
            "center" => -0.5 * width,
            _ => 0.0,
        }
    }

    fn upward(&self, above: f64, below: f64) -> f64 {
        match self.vertical {
            "top" => -above,
            "center" => 0.5 * (below - above),
            "bottom" => below,
            _ => 0.0,
        }
    }

    /// A glyph outline translated by a vector in font units; `None` for a blank.
    fn outline(&self, face: &Face, glyph: GlyphId, unit: f64, by: Point) -> Option<Leaf> {
        let mut pen = Pen { scale: unit, by, pieces: self.pieces, contours: Vec::new() };
        face.outline_glyph(glyph, &mut pen)?;
        (!pen.contours.is_empty()).then_some(Leaf::Outline(pen.contours))
    }
}

/// A glyph index of 16 bits; 0 is the index of the missing glyph.
fn glyph_id(number: u32) -> GlyphId {
    GlyphId(u16::try_from(number).unwrap_or(0))
}

/// Collects the outline of a glyph as chains of points.
struct Pen {
    scale: f64,
    by: Point,
    pieces: usize,
    contours: Vec<Vec<Point>>,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> Point {
        [self.scale * (f64::from(x) + self.by[0]), self.scale * (f64::from(y) + self.by[1])]
    }

    fn push(&mut self, p: Point) {
        if let Some(contour) = self.contours.last_mut() {
            contour.push(p);
        }
    }

    fn last(&self) -> Point {
        self.contours.last().and_then(|contour| contour.last()).copied().unwrap_or_default()
    }

    /// Adds a Bézier curve given by its control points, the first of which is the current point (de Casteljau).
    fn curve<const N: usize>(&mut self, control: [Point; N]) {
        for piece in 1..self.pieces {
            let t = piece as f64 / self.pieces as f64;
            let mut points = control;
            for last in (1..N).rev() {
                for k in 0..last {
                    points[k] =
                        [0, 1].map(|axis| points[k][axis] + t * (points[k + 1][axis] - points[k][axis]));
                }
            }
            self.push(points[0]);
        }
        // the exact end point, so that contours close
        self.push(control[N - 1]);
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let start = self.at(x, y);
        self.contours.push(vec![start]);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.push(self.at(x, y));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.curve([self.last(), self.at(x1, y1), self.at(x, y)]);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.curve([self.last(), self.at(x1, y1), self.at(x2, y2), self.at(x, y)]);
    }

    fn close(&mut self) {}
}
