//! Parser of the native model file.

use super::VERSION;
use super::fields::{Fields, Problems};
use super::foreign::Sections;
use super::pieces::{LENGTH, Merge, TopLevel, pieces};
use super::quick;
use crate::datum::{self, Datum, Table};
use crate::diagnostic::Diagnostic;
use crate::document::*;
use crate::expression::is_reserved;
use crate::keys::{EXTRUDE, REVOLVE, STEPS};
use crate::number::{Number, written};
use crate::resolve::Definitions;
use crate::source::{Source, Span, Spanned};
use crate::suggestion::did_you_mean;
use crate::unit::Unit;
use rayweave_error::with_limited_suggestions_of_part;
use rayweave_model::NameState;
use rayweave_model::drive::{Cancel, drive, thread_count};
use rayweave_shape::primitive::MANUALS;
use std::collections::HashSet;
use std::num::NonZeroUsize;
use std::ops::Range;
use std::sync::Arc;
use toml::de::DeTable;

/// The document, as far as it could be read.
pub(crate) struct Reading {
    pub document: Document,
    pub problems: Vec<Diagnostic>,
    /// True if the text is not valid TOML; missing names may then be in the part that could not be
    /// read.
    pub broken: bool,
    /// Names of solids and parameters in the file whose definitions are invalid.
    pub unreadable: HashSet<String>,
    /// The solids, if they are not in the document.
    pub definitions: Definitions,
}

/// The form of the solids that were read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kept {
    /// As entries of the document.
    Document,
    /// As definitions, which take less memory.
    Definitions,
}

/// The top-level tables.
const TABLES: [&str; 7] = ["parameters", "solid", "region", "medium", "camera", "light", "render"];

/// Tables that other crates of Rayweave read.
const OWNED: [&str; 3] = ["optics", "photons", "gdml"];

/// Reads as much as possible and collects all problems.
pub(crate) fn read(source: Arc<Source>, kept: Kept) -> Reading {
    match read_pieces(&source, LENGTH, kept) {
        Some(reader) => reader.finish(false),
        None => read_whole(&source, kept),
    }
}

/// Reads a text in pieces of at least this length, on all threads; `None` if it is not valid TOML, or if its pieces depend on
/// each other.
pub(super) fn read_pieces(source: &Arc<Source>, length: usize, kept: Kept) -> Option<Reader> {
    let mut reader = Reader::new(source, kept);
    let mut merge = Merge::default();
    let (hasher, count) = (merge.hasher(), source.text().len() / length + 1);
    let read = |(): &mut (), range: Range<usize>| {
        with_limited_suggestions_of_part(count, || Piece::read(source, range, kept, &hasher))
    };
    let add = |piece: Option<Piece>| {
        let Piece { contents, tables } = piece.ok_or(NotInPieces)?;
        if !merge.admits(tables) {
            return Err(NotInPieces);
        }
        reader.append(contents);
        Ok(())
    };
    let threads = if source.text().len() > 16 * length { thread_count(None) } else { NonZeroUsize::MIN };
    drive(threads, &Cancel::new(), pieces(source.text(), length), || (), read, add).ok()?;
    merge.has_unique_names().then_some(reader)
}

/// A text that must be read as a whole.
struct NotInPieces;

/// A piece of the text.
struct Piece {
    contents: Reader,
    /// Its top-level entries, for the comparison with those of other pieces.
    tables: Vec<TopLevel>,
}

impl Piece {
    /// `None` if the piece alone is not valid TOML.
    fn read(source: &Arc<Source>, range: Range<usize>, kept: Kept, hasher: &NameState) -> Option<Piece> {
        let (start, end) = (range.start, range.end);
        let mut contents = Reader::without_heading(source, kept);
        let table = match quick::parse(source.text(), range.clone()) {
            Some(table) => table,
            None => {
                let tree = DeTable::parse(&source.text()[range]).ok()?;
                datum::from_toml(tree.get_ref(), start, source, &mut contents.problems.list)
            }
        };
        let tables = table.iter().map(|entry| TopLevel::new(source, entry, hasher)).collect();
        contents.top(table, end);
        Some(Piece { contents, tables })
    }
}

pub(super) fn read_whole(source: &Arc<Source>, kept: Kept) -> Reading {
    let (tree, errors) = DeTable::parse_recoverable(source.text());
    let mut reader = Reader::new(source, kept);
    let table = datum::from_toml(tree.get_ref(), 0, source, &mut reader.problems.list);
    drop(tree);
    reader.top(table, source.text().len());
    if !errors.is_empty() {
        reader.add_syntax_errors(&errors);
    }
    reader.finish(!errors.is_empty())
}

/// The comment lines at the head of the file.
fn heading(text: &str) -> Vec<String> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let comments = text.lines().map_while(|line| line.strip_prefix('#'));
    comments.map(|line| line.trim().to_owned()).collect()
}

pub(super) struct Reader {
    document: Document,
    problems: Problems,
    unreadable: HashSet<String>,
    kept: Kept,
    definitions: Definitions,
    /// True if the text has the version of the format.
    stated: bool,
}

impl Reader {
    fn new(source: &Arc<Source>, kept: Kept) -> Reader {
        let mut reader = Reader::without_heading(source, kept);
        reader.document.heading = heading(source.text());
        reader
    }

    fn without_heading(source: &Arc<Source>, kept: Kept) -> Reader {
        Reader {
            document: Document { source: source.clone(), ..Document::default() },
            problems: Problems { source: source.clone(), list: Vec::new() },
            unreadable: HashSet::new(),
            kept,
            definitions: Definitions::default(),
            stated: false,
        }
    }

    pub fn finish(mut self, broken: bool) -> Reading {
        // with syntax errors the key may be one of the entries that cannot be read
        if !self.stated && !broken {
            let problem = Diagnostic::warning("the format version is missing")
                .why("future versions may read the file differently")
                .suggest(Some("add `rayweave = 1` as the first line".to_owned()));
            self.problems.list.push(problem.in_file(&self.document.source));
        }
        let Reader { document, problems, unreadable, definitions, .. } = self;
        Reading { document, problems: problems.list, broken, unreadable, definitions }
    }

    /// Adds what the next piece of the text contains. Of the entries that exist once, the pieces have one at most.
    fn append(&mut self, next: Reader) {
        let Reader { document, problems, unreadable, definitions, stated, .. } = next;
        let Document { unit, parameters, solids, regions, media, camera, lights, render, foreign, .. } =
            document;
        let whole = &mut self.document;
        whole.unit = unit.or(whole.unit.take());
        whole.parameters.extend(parameters);
        whole.solids.extend(solids);
        whole.regions.extend(regions);
        whole.media.extend(media);
        whole.camera = camera.or(whole.camera.take());
        whole.lights.extend(lights);
        whole.render = render.or(whole.render.take());
        whole.foreign.extend(foreign);
        self.problems.list.extend(problems.list);
        self.unreadable.extend(unreadable);
        self.definitions.append(definitions);
        self.stated |= stated;
    }

    /// Adds the syntax errors and removes other problems on the same lines, which are consequences
    /// of them.
    fn add_syntax_errors(&mut self, errors: &[toml::de::Error]) {
        let source = self.problems.source.clone();
        let span = |error: &toml::de::Error| error.span().map(Span::from).unwrap_or_default();
        let lines: HashSet<usize> =
            errors.iter().map(|error| source.line_column(span(error).start()).0).collect();
        let stays =
            |problem: &Diagnostic| problem.line_column().is_none_or(|(line, _)| !lines.contains(&line));
        self.problems.list.retain(stays);
        let mut seen = HashSet::new();
        for error in errors {
            if seen.insert((span(error), error.message())) {
                let problem = Diagnostic::error("invalid TOML").why(error.message());
                let at = span(error).start();
                // a syntax error at the end may come from a truncated file
                let is_end = source.text().get(at..).is_some_and(|rest| rest.trim().is_empty());
                let suggestion = match is_end {
                    true => Some("The file ends here: is it complete?".to_owned()),
                    false => unquoted_expression(source.text(), at),
                };
                self.problems.push(problem.suggest(suggestion), span(error));
            }
        }
    }

    /// Reads the entries of a piece of the text, which ends at `end`.
    fn top(&mut self, table: Table, end: usize) {
        let mut foreign = vec![String::new(); table.len()];
        if table.iter().any(is_foreign) {
            let source = self.document.source.clone();
            let sections = Sections::new(&source, &table, end);
            for (text, entry) in foreign.iter_mut().zip(&table).filter(|(_, entry)| is_foreign(entry)) {
                *text = sections.text(entry);
            }
        }
        for ((key, value), text) in table.into_iter().zip(foreign) {
            self.entry(key, value, text);
        }
    }

    fn entry(&mut self, key: Spanned<String>, value: Spanned<Datum>, text: String) {
        match key.value.as_str() {
            "rayweave" => {
                self.stated = true;
                self.version(value);
            }
            "unit" => self.unit(value),
            "parameters" => self.parameters(value),
            "solid" => self.named_tables("solid", value, Reader::solid),
            "region" => self.tables("region", value, Reader::region),
            "medium" => self.named_tables("medium", value, Reader::medium),
            "camera" => self.camera(value),
            "light" => self.tables("light", value, Reader::light),
            "render" => self.render(value),
            _ if text.is_empty() => self.unknown(&key),
            _ => self.foreign(key, value, text),
        }
    }

    fn unknown(&mut self, key: &Spanned<String>) {
        let names = ["rayweave", "unit"];
        let problem = Diagnostic::error(format!("unknown key `{}`", key.value))
            .why(format!("outside tables there are only {}", names.join(" and ")))
            .suggest(did_you_mean(&key.value, names.iter().chain(&TABLES).copied()));
        self.problems.push(problem, key.span);
    }

    fn foreign(&mut self, name: Spanned<String>, value: Spanned<Datum>, text: String) {
        if !OWNED.contains(&name.value.as_str()) {
            let known: Vec<&str> = TABLES.into_iter().chain(OWNED).collect();
            let problem = Diagnostic::warning(format!("the table `{}` is not used", name.value))
                .why(format!("the tables are {}", known.join(", ")))
                .suggest(did_you_mean(&name.value, known));
            self.problems.push(problem, name.span);
        }
        self.document.foreign.push(Foreign { name, value, text });
    }

    fn version(&mut self, value: Spanned<Datum>) {
        if value.value != Datum::Number(VERSION) {
            let found = match &value.value {
                Datum::Number(number) => format!("unknown version {}", written(*number)),
                other => format!("`rayweave` is {}", other.description()),
            };
            let reason = format!("this program reads version {}", written(VERSION));
            self.problems.push(Diagnostic::error(found).why(reason), value.span);
        }
    }

    fn unit(&mut self, value: Spanned<Datum>) {
        let choices = Unit::ALL.map(|(unit, symbol, _)| (unit, symbol));
        self.document.unit = self.problems.choice("unit", value, &choices);
    }

    fn parameters(&mut self, value: Spanned<Datum>) {
        let Some(fields) = Fields::new(&mut self.problems, "parameters", value) else {
            return;
        };
        for (name, value) in fields.keys.rest {
            match self.problems.number(&name.value, value) {
                Some(value) => self.document.parameters.push(Parameter { name, value }),
                None => drop(self.unreadable.insert(name.value)),
            }
        }
    }

    /// `[what.name]` tables.
    fn named_tables(
        &mut self,
        what: &str,
        value: Spanned<Datum>,
        each: fn(&mut Reader, Spanned<String>, Spanned<Datum>),
    ) {
        let Datum::Table(table) = value.value else {
            self.problems.wrong_type(what, &value, &format!("named tables, such as [{what}.name]"));
            return;
        };
        for (name, value) in table {
            each(self, name, value);
        }
    }

    /// `[[what]]` tables.
    fn tables(&mut self, what: &str, value: Spanned<Datum>, each: fn(&mut Reader, Spanned<Datum>)) {
        match value.value {
            Datum::List(list) => list.into_iter().for_each(|value| each(self, value)),
            _ => self.problems.wrong_type(what, &value, &format!("a list of tables, such as [[{what}]]")),
        }
    }

    fn solid(&mut self, name: Spanned<String>, value: Spanned<Datum>) {
        if is_reserved(&name.value) {
            let problem = Diagnostic::error(format!("no solid can be called `{}`", name.value));
            self.problems.push(problem.why("the name has a special meaning in expressions"), name.span);
        }
        let what = format!("solid.{}", name.value);
        let before = self.problems.list.len();
        let entry = Fields::new(&mut self.problems, &what, value).map(|fields| solid(fields, name.clone()));
        let is_readable = self.problems.list.len() == before;
        if !is_readable {
            self.unreadable.insert(name.value);
        }
        let Some(entry) = entry else { return };
        match self.kept {
            Kept::Document => self.document.solids.push(entry),
            Kept::Definitions => self.definitions.push(entry, is_readable),
        }
    }

    fn region(&mut self, value: Spanned<Datum>) {
        let Some(mut fields) = Fields::new(&mut self.problems, "region", value) else {
            return;
        };
        let solid = fields.need("solid").and_then(|datum| fields.problems.text("solid", datum));
        let (medium, colour, name) = (fields.text("medium"), fields.colour("colour"), fields.text("name"));
        fields.finish();
        if let Some(solid) = solid {
            self.document.regions.push(RegionEntry { solid, medium, colour, name });
        }
    }

    fn medium(&mut self, name: Spanned<String>, value: Spanned<Datum>) {
        let what = format!("medium.{}", name.value);
        let Some(mut fields) = Fields::new(&mut self.problems, &what, value) else {
            return;
        };
        let (index, colour) = (fields.number("index"), fields.colour("colour"));
        let others = fields.keys.rest;
        for (key, _) in &others {
            let suggestion = did_you_mean(&key.value, ["index", "colour", "density"]);
            if suggestion.is_some() {
                let problem = Diagnostic::warning(format!("`{}` is not used", key.value))
                    .why("additional keys of media are kept only for other programs")
                    .suggest(suggestion);
                self.problems.push(problem, key.span);
            }
        }
        self.document.media.push(MediumEntry { name, index, colour, others });
    }

    fn camera(&mut self, value: Spanned<Datum>) {
        let span = value.span;
        let Some(mut fields) = Fields::new(&mut self.problems, "camera", value) else {
            return;
        };
        let projection = projection(&mut fields);
        let position = fields.need("position").and_then(|datum| fields.problems.numbers("position", datum));
        let target = fields.vector("target");
        let up = fields.vector("up");
        let size = fields.take("size").and_then(|datum| fields.problems.numbers("size", datum));
        fields.finish();
        if let (Some(projection), Some(position)) = (projection, position) {
            let camera = CameraEntry { projection, position, target, up, size };
            self.document.camera = Some(Spanned::new(camera, span));
        }
    }

    fn light(&mut self, value: Spanned<Datum>) {
        let span = value.span;
        let Some(mut fields) = Fields::new(&mut self.problems, "light", value) else {
            return;
        };
        let (direction, position) = (fields.take("direction"), fields.take("position"));
        let (intensity, colour) = (fields.number("intensity"), fields.colour("colour"));
        let kind = match (direction, position) {
            (Some(datum), None) => fields.problems.numbers("direction", datum).map(LightKind::Direction),
            (None, Some(datum)) => fields.problems.numbers("position", datum).map(LightKind::Position),
            (both, _) => {
                let found = if both.is_some() { "a `direction` and a" } else { "no `direction` and no" };
                let problem = Diagnostic::error(format!("the light has {found} `position`"));
                fields.problems.push(problem.why("it needs one of them"), span);
                None
            }
        };
        fields.finish();
        if let Some(kind) = kind {
            self.document.lights.push(LightEntry { kind, intensity, colour });
        }
    }

    fn render(&mut self, value: Spanned<Datum>) {
        let Some(mut fields) = Fields::new(&mut self.problems, "render", value) else {
            return;
        };
        let shading = fields.take("shading");
        let entry = RenderEntry {
            background: fields.colour("background"),
            shading: shading.and_then(|datum| fields.problems.choice("shading", datum, &Shading::ALL)),
            edges: fields.boolean("edges"),
            shadows: fields.boolean("shadows"),
            samples: fields.number("samples"),
        };
        fields.finish();
        self.document.render = Some(entry);
    }
}

/// True for a table of another program.
fn is_foreign((key, value): &(Spanned<String>, Spanned<Datum>)) -> bool {
    let known = TABLES.contains(&key.value.as_str()) || matches!(key.value.as_str(), "rayweave" | "unit");
    !known && (matches!(value.value, Datum::Table(_)) || is_tables(&value.value))
}

fn is_tables(value: &Datum) -> bool {
    match value {
        Datum::List(list) => {
            !list.is_empty() && list.iter().all(|item| matches!(item.value, Datum::Table(_)))
        }
        _ => false,
    }
}

fn projection(fields: &mut Fields) -> Option<ProjectionEntry> {
    const CHOICES: [(bool, &str); 2] = [(false, "perspective"), (true, "orthographic")];
    let (fov, height) = (fields.take_entry("fov"), fields.take_entry("height"));
    let orthographic = match fields.take("projection") {
        Some(datum) => fields.problems.choice("projection", datum, &CHOICES)?.value,
        None => height.is_some() && fov.is_none(),
    };
    let (used, unused) = if orthographic { (height, fov) } else { (fov, height) };
    let kind = CHOICES[usize::from(orthographic)].1;
    if let Some((key, _)) = unused {
        let problem = Diagnostic::error(format!("`{}` has no meaning here", key.value));
        let reason = "`fov` is for perspective cameras and `height` for orthographic ones";
        fields.problems.push(problem.why(reason), key.span);
    }
    let number = match used {
        Some((key, datum)) => Some(fields.problems.number(&key.value, datum)?),
        None => None,
    };
    match (kind, number) {
        ("perspective", fov) => Some(ProjectionEntry::Perspective(fov)),
        (_, Some(height)) => Some(ProjectionEntry::Orthographic(height)),
        _ => {
            fields.missing("height");
            None
        }
    }
}

fn solid(mut fields: Fields, name: Spanned<String>) -> SolidEntry {
    let label = fields.text("name");
    let transform = fields.take("transform").map(|datum| transform(fields.problems, datum));
    // an invalid body is replaced, so that the rest is also checked
    let body = body(fields).unwrap_or_else(|| Body::Expression("empty".into()));
    SolidEntry { name, label, body, transform: transform.unwrap_or_default() }
}

/// A suggestion for an arithmetic expression without quotation marks at a syntax error.
fn unquoted_expression(text: &str, at: usize) -> Option<String> {
    let line = text.get(..at)?.rfind('\n').map_or(0, |end| end + 1);
    let end = text.get(at..)?.find('\n').map_or(text.len(), |length| at + length);
    let line = text.get(line..end)?;
    let at = at + line.len() - end;
    // the error may be anywhere in the value, which begins after the last separator outside of parentheses
    let start = line.get(..at)?.rfind(['=', ',', '[', '{']).map(|separator| separator + 1)?;
    // the head of a table
    if matches!(line[..start - 1].trim(), "" | "[") {
        return None;
    }
    let mut depth = 0;
    let length = line[start..].find(|next: char| {
        depth += i32::from(next == '(') - i32::from(next == ')');
        matches!(next, ']' | '}' | '#' | '"' | '\'' | '=') || depth == 0 && next == ','
    });
    let value = length.map_or(&line[start..], |length| &line[start..start + length]).trim();
    let is_number = value.parse::<f64>().is_ok() || value.is_empty();
    if is_number || crate::arithmetic::Arithmetic::parse(value).is_err() {
        return None;
    }
    let key =
        line[..start - 1].trim_end().rsplit(|c: char| !(c.is_alphanumeric() || c == '_' || c == '-')).next();
    let written = match key.filter(|key| line[..start].ends_with('=') && !key.is_empty()) {
        Some(key) => format!("{key} = \"{value}\""),
        None => format!("\"{value}\""),
    };
    Some(format!("Write an expression as a string: `{written}`."))
}

/// The expression that a word of other programs for a boolean stands for.
fn boolean_of(word: &str) -> Option<&'static str> {
    Some(match word {
        "union" | "join" | "fuse" | "add" => "a | b",
        "intersection" | "intersect" | "common" => "a & b",
        "difference" | "subtract" | "subtraction" | "cut" => "a - b",
        "symmetric_difference" | "xor" => "a ^ b",
        _ => return None,
    })
}

fn body(mut fields: Fields) -> Option<Body> {
    let mut keywords =
        ["expr", "place", EXTRUDE, REVOLVE].into_iter().chain(MANUALS.iter().map(|manual| manual.name));
    let found = match fields.take_last(|key| keywords.clone().any(|keyword| keyword == key)) {
        Some(entry) => vec![entry],
        None => keywords.by_ref().filter_map(|keyword| fields.take_entry(keyword)).collect(),
    };
    if let [(first, _), (second, _), ..] = found.as_slice() {
        let problem = format!("the solid has both `{}` and `{}`", first.value, second.value);
        let problem =
            Diagnostic::error(problem).why("a solid has one definition; an `expr` combines several solids");
        fields.problems.push(problem, second.span);
    }
    let Some((keyword, datum)) = found.into_iter().next() else {
        return nothing_known(fields);
    };
    let body = match keyword.value.as_str() {
        "expr" => fields.problems.text("expr", datum).map(Body::Expression),
        "place" => place(fields.problems, datum).map(|place| Body::Place(Box::new(place))),
        _ => arguments(fields.problems, &keyword, datum).map(|table| Body::Shape(keyword, table)),
    };
    fields.finish();
    body
}

/// Reports a solid without a known keyword.
fn nothing_known(fields: Fields) -> Option<Body> {
    if fields.is_exhausted() {
        let problem = Diagnostic::error("the solid has no shape")
            .why("it needs a shape, `extrude`, `revolve`, `expr` or `place`");
        fields.problems.push(problem, fields.keys.span);
        return None;
    }
    let shapes: Vec<&str> = MANUALS.iter().map(|manual| manual.name).collect();
    let names =
        ["expr", "place", EXTRUDE, REVOLVE, "transform", "name"].into_iter().chain(shapes.iter().copied());
    for (key, _) in &fields.keys.rest {
        let problem = Diagnostic::error(format!("unknown shape `{}`", key.value))
            .why(format!(
                "the shapes are {}; a solid can also be an `extrude`, `revolve`, `expr` or `place`",
                shapes.join(", ")
            ))
            .suggest(match boolean_of(&key.value) {
                Some(expression) => Some(format!("Combine named solids with `expr = \"{expression}\"`.")),
                None => did_you_mean(&key.value, names.clone()),
            });
        fields.problems.push(problem, key.span);
    }
    None
}

fn arguments(problems: &mut Problems, keyword: &Spanned<String>, datum: Spanned<Datum>) -> Option<Table> {
    match datum.value {
        Datum::Table(table) => Some(table),
        _ => {
            let manual = MANUALS.iter().find(|manual| manual.name == keyword.value);
            let parameter =
                manual.and_then(|manual| manual.parameters.first()).map_or("outline", |first| first.name);
            let wanted = format!("a table of its parameters, such as {{ {parameter} = .. }}");
            problems.wrong_type(&keyword.value, &datum, &wanted);
            None
        }
    }
}

/// The valid steps of a transform.
pub(crate) fn transform(problems: &mut Problems, datum: Spanned<Datum>) -> Vec<Spanned<Step>> {
    match datum.value {
        Datum::List(list) => {
            let mut steps = Vec::with_capacity(list.len());
            steps.extend(list.into_iter().filter_map(|item| step(problems, item)));
            steps
        }
        // a single step needs no brackets
        Datum::Table(_) => step(problems, datum).into_iter().collect(),
        _ => {
            problems.wrong_type("transform", &datum, "a list of steps, such as [{ rotate_x = 90 }]");
            Vec::new()
        }
    }
}

fn step(problems: &mut Problems, datum: Spanned<Datum>) -> Option<Spanned<Step>> {
    let span = datum.span;
    let mut fields = Fields::new(problems, "transform", datum)?;
    let found: Vec<_> = match fields.take_last(|key| STEPS.contains(&key)) {
        Some(entry) => vec![entry],
        None => STEPS.iter().filter_map(|key| fields.take_entry(key)).collect(),
    };
    let counted = found.len() == 1 || !fields.is_exhausted();
    if !counted {
        let problem = Diagnostic::error(format!("the step has {} maps", found.len()));
        fields.problems.push(problem.why("a step is one map, because the order of maps matters"), span);
    }
    let step = match found.into_iter().next() {
        Some((key, datum)) if counted => map(fields.problems, &key.value, datum),
        _ => None,
    };
    fields.finish();
    step.map(|step| Spanned::new(step, span))
}

fn map(problems: &mut Problems, key: &str, datum: Spanned<Datum>) -> Option<Step> {
    match key {
        "translate" => problems.numbers(key, datum).map(Step::Translate),
        "rotate_x" => problems.number(key, datum).map(Step::RotateX),
        "rotate_y" => problems.number(key, datum).map(Step::RotateY),
        "rotate_z" => problems.number(key, datum).map(Step::RotateZ),
        "rotate" => rotate(problems, datum),
        "scale" if matches!(datum.value, Datum::List(_)) => problems.numbers(key, datum).map(Step::ScaleAxes),
        "scale" => problems.number(key, datum).map(Step::Scale),
        "mirror" => problems.numbers(key, datum).map(Step::Mirror),
        _ => problems.matrix(key, datum).map(|rows| Step::Matrix(Box::new(rows))),
    }
}

fn rotate(problems: &mut Problems, datum: Spanned<Datum>) -> Option<Step> {
    if !matches!(datum.value, Datum::Table(_)) {
        let wanted = "a table such as { axis = [0, 0, 1], degrees = 90 }; `rotate_x`, `rotate_y` and `rotate_z` turn about one axis";
        problems.wrong_type("rotate", &datum, wanted);
        return None;
    }
    let mut fields = Fields::new(problems, "rotate", datum)?;
    let axis = fields.need("axis").and_then(|datum| fields.problems.numbers("axis", datum));
    let degrees = fields.need("degrees").and_then(|datum| fields.problems.number("degrees", datum));
    fields.finish();
    Some(Step::Rotate(axis?, degrees?))
}

fn place(problems: &mut Problems, datum: Spanned<Datum>) -> Option<Place> {
    let span = datum.span;
    let mut fields = Fields::new(problems, "place", datum)?;
    let solid = fields.need("solid").and_then(|datum| fields.problems.text("solid", datum));
    let mut found = Vec::new();
    for key in ["grid", "ring", "at", "matrices", "file"] {
        found.extend(fields.take_entry(key));
    }
    if found.len() != 1 {
        let names: Vec<&str> = found.iter().map(|(key, _)| key.value.as_str()).collect();
        let problem = match names.is_empty() {
            true => "`place` has no positions".to_owned(),
            false => format!("`place` has the positions of {}", names.join(" and ")),
        };
        let problem =
            Diagnostic::error(problem).why("it needs exactly one of grid, ring, at, matrices and file");
        let example =
            names.is_empty().then(|| "Write `grid = [3, 2, 1], step = [10, 10, 0]`, for example".to_owned());
        fields.problems.push(problem.suggest(example), span);
        return None;
    }
    let (key, datum) = found.remove(0);
    let layout = layout(&mut fields, &key.value, datum);
    let name = fields.text("name");
    let numbers = copy_numbers(&mut fields, name.is_some());
    fields.finish();
    let (solid, layout) = (solid?, layout?);
    Some(Place { solid, layout, name, numbers })
}

fn copy_numbers(fields: &mut Fields, has_name: bool) -> Option<Spanned<Vec<Spanned<Number>>>> {
    let datum = fields.take("numbers")?;
    let span = datum.span;
    if !has_name {
        let problem = Diagnostic::error("`place` has `numbers` and no `name`");
        let reason = "in occurrence paths, the number follows the name of the copy";
        fields.problems.push(problem.why(reason), span);
    }
    let numbers = list(fields.problems, "numbers", datum, Problems::number)?;
    Some(Spanned { value: numbers, span })
}

fn layout(fields: &mut Fields, key: &str, datum: Spanned<Datum>) -> Option<Layout> {
    match key {
        "grid" => {
            let count = fields.problems.numbers(key, datum);
            let step = fields.need("step").and_then(|datum| fields.problems.numbers("step", datum));
            let origin = fields.vector("origin");
            let (count, step) = (count?, step?);
            Some(Layout::Grid(Box::new(Grid { count, step, origin })))
        }
        "ring" => {
            let count = fields.problems.number(key, datum);
            let radius = fields.need("radius").and_then(|datum| fields.problems.number("radius", datum));
            let start = fields.number("start");
            let (count, radius) = (count?, radius?);
            Some(Layout::Ring { count, radius, start })
        }
        "at" if is_point(&datum.value) => {
            let problem = Diagnostic::error("`at` is one point").why("it must be a list of points");
            fields.problems.push(problem.suggest(Some("Write `at = [[x, y, z]]`".to_owned())), datum.span);
            None
        }
        "at" => list(fields.problems, key, datum, Problems::numbers).map(Layout::At),
        "matrices" => list(fields.problems, key, datum, Problems::matrix).map(Layout::Matrices),
        _ => fields.problems.text(key, datum).map(Layout::File),
    }
}

/// True for a list of three values none of which is a list.
fn is_point(datum: &Datum) -> bool {
    match datum {
        Datum::List(list) => list.len() == 3 && !list.iter().any(|item| matches!(item.value, Datum::List(_))),
        _ => false,
    }
}

fn list<T>(
    problems: &mut Problems,
    key: &str,
    datum: Spanned<Datum>,
    each: fn(&mut Problems, &str, Spanned<Datum>) -> Option<T>,
) -> Option<Vec<T>> {
    match datum.value {
        Datum::List(list) => {
            let items: Vec<Option<T>> = list.into_iter().map(|item| each(problems, key, item)).collect();
            items.into_iter().collect()
        }
        _ => {
            problems.wrong_type(key, &datum, "a list");
            None
        }
    }
}
