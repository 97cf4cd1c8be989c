//! `text`: the outlines of glyphs, one after the other.
//!
//! Letters stand as OpenSCAD 2021.01 places them: an em is the size over 0.72, curves are divided by the same rule. It moves
//! outlines to a grid of its own ("hinting") by up to 1/32 of a unit, which is not done here. Scripts whose letters join or
//! move need more than this and are refused.

use super::arguments::{Arguments, Refusal};
use super::facets::Fineness;
use super::flat::Leaf;
use super::value::Value;
use fontdb::{Database, Family, ID, Query, Style, Weight};
use rayweave_space::Point;
use std::path::PathBuf;
use ttf_parser::{Face, GlyphId, OutlineBuilder};

/// An em, over the size of a text: points of 1/72 inch at 100 dots an inch.
const EM: f64 = 100.0 / 72.0;

/// Fonts that stand for one that is not there, in this order.
const STAND_INS: [&str; 5] = ["Liberation Sans", "Arimo", "Arial", "Helvetica", "DejaVu Sans"];

/// The font that OpenSCAD takes where none is named.
const DEFAULT: &str = "Liberation Sans";

/// Longer texts are no letters on a part.
const MOST_LETTERS: usize = 10_000;

/// The fonts that texts may have, looked for when the first text is met.
pub(super) struct Fonts {
    paths: Vec<PathBuf>,
    given: Option<Database>,
    system: Option<Database>,
}

/// The leaves of a text, and what stands for its font if it is not there.
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
                    // a file that is no font has none
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

    /// The font of a name, or one that stands for it, with its name: of those given first.
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

/// `Family:style=Bold Italic`.
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

/// The numbers of a text.
struct Setting<'a> {
    text: &'a str,
    /// A unit of the font.
    unit: f64,
    spacing: f64,
    horizontal: &'a str,
    vertical: &'a str,
    /// How many pieces a curve has.
    pieces: usize,
}

/// `text(text, size, font, spacing, halign, valign)`.
pub(super) fn text(arguments: &Arguments, fonts: &mut Fonts) -> Result<Letters, Refusal> {
    let word = |name, default| Ok::<&str, Refusal>(arguments.get(name, "a text", word)?.unwrap_or(default));
    let text = word("text", "")?;
    check_text(arguments, text, word("direction", "ltr")?)?;
    let wanted = Wanted::new(word("font", "")?);
    let size = arguments.number("size", 10.0)?;
    let pieces = (Fineness::of(arguments)?.fragments(size) / 8 + 1).max(2);
    let spacing = arguments.number("spacing", 1.0)?;
    let (horizontal, vertical) = (word("halign", "left")?, word("valign", "baseline")?);
    if text.is_empty() || size <= 0.0 {
        return Ok(Letters { leaves: Vec::new(), stand_in: None });
    }
    let Some((database, id, stand_in)) = fonts.find(&wanted) else {
        return Err(arguments.refusal(&format!(
            "there is no font `{}`, and none that could stand for it: name a file or a folder of fonts",
            wanted.family
        )));
    };
    let leaves = database.with_face_data(id, |data, index| {
        let face = Face::parse(data, index).ok()?;
        let unit = size * EM / f64::from(face.units_per_em());
        let setting = Setting { text, unit, spacing, horizontal, vertical, pieces };
        Some(setting.leaves(&face))
    });
    let leaves = leaves.flatten().ok_or_else(|| arguments.refusal("its font cannot be read"))?;
    Ok(Letters {
        leaves,
        stand_in: stand_in.map(|name| format!("has the font `{name}` instead of `{}`", wanted.family)),
    })
}

fn word(value: &Value) -> Option<&str> {
    match value {
        Value::Text(text) => Some(text),
        _ => None,
    }
}

/// Only what is set letter by letter from the left can be set.
fn check_text(arguments: &Arguments, text: &str, direction: &str) -> Result<(), Refusal> {
    if text.chars().count() > MOST_LETTERS {
        return Err(arguments.refusal(&format!("it has more than {MOST_LETTERS} letters")));
    }
    if !["ltr", ""].contains(&direction) {
        return Err(arguments.refusal("only texts from left to right can be set"));
    }
    // Hebrew to Hangul Jamo: letters that join, move or stand from right to left
    if text.chars().any(|c| ('\u{590}'..='\u{11ff}').contains(&c)) {
        return Err(arguments.refusal("its script needs letters that join or move"));
    }
    Ok(())
}

impl Setting<'_> {
    fn leaves(&self, face: &Face) -> Vec<Leaf> {
        let glyphs: Vec<GlyphId> =
            self.text.chars().map(|c| face.glyph_index(c).unwrap_or_default()).collect();
        let mut places = Vec::with_capacity(glyphs.len());
        let mut width = 0.0;
        for (k, glyph) in glyphs.iter().enumerate() {
            places.push(width);
            let advance = f64::from(face.glyph_hor_advance(*glyph).unwrap_or(0));
            let kerning = glyphs.get(k + 1).map_or(0.0, |next| kerning(face, *glyph, *next));
            width += self.spacing * (advance + kerning);
        }
        let shift = [self.across(width), self.upward(face, &glyphs)];
        let outline =
            |(glyph, place): (&GlyphId, &f64)| self.outline(face, *glyph, [shift[0] + place, shift[1]]);
        glyphs.iter().zip(&places).filter_map(outline).collect()
    }

    fn across(&self, width: f64) -> f64 {
        match self.horizontal {
            "right" => -width,
            "center" => -0.5 * width,
            _ => 0.0,
        }
    }

    fn upward(&self, face: &Face, glyphs: &[GlyphId]) -> f64 {
        let boxes: Vec<_> = glyphs.iter().filter_map(|glyph| face.glyph_bounding_box(*glyph)).collect();
        let above = boxes.iter().map(|b| f64::from(b.y_max)).fold(0.0, f64::max);
        let below = boxes.iter().map(|b| -f64::from(b.y_min)).fold(0.0, f64::max);
        match self.vertical {
            "top" => -above,
            "center" => 0.5 * (below - above),
            "bottom" => below,
            _ => 0.0,
        }
    }

    /// A glyph moved by a vector in units of the font; `None` for a blank.
    fn outline(&self, face: &Face, glyph: GlyphId, by: Point<2>) -> Option<Leaf> {
        let mut pen = Pen { scale: self.unit, by, pieces: self.pieces, contours: Vec::new() };
        face.outline_glyph(glyph, &mut pen)?;
        (!pen.contours.is_empty()).then_some(Leaf::Outline(pen.contours))
    }
}

/// How much nearer two letters stand, in units of the font.
fn kerning(face: &Face, left: GlyphId, right: GlyphId) -> f64 {
    let Some(table) = face.tables().kern else {
        return 0.0;
    };
    let subtables = table.subtables.into_iter().filter(|table| table.horizontal && !table.has_cross_stream);
    let moves = subtables.filter_map(|table| table.glyphs_kerning(left, right));
    moves.map(f64::from).sum()
}

/// Takes the outline of a glyph as chains of points.
struct Pen {
    scale: f64,
    by: Point<2>,
    pieces: usize,
    contours: Vec<Vec<Point<2>>>,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> Point<2> {
        [self.scale * (f64::from(x) + self.by[0]), self.scale * (f64::from(y) + self.by[1])]
    }

    fn push(&mut self, p: Point<2>) {
        if let Some(contour) = self.contours.last_mut() {
            contour.push(p);
        }
    }

    fn last(&self) -> Point<2> {
        self.contours.last().and_then(|contour| contour.last()).copied().unwrap_or_default()
    }

    /// A Bézier curve by its control points, the first of which is where the pen is (de Casteljau).
    fn curve<const N: usize>(&mut self, control: [Point<2>; N]) {
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
        // exactly, so that a contour ends where it began
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
