//! XML as a tree of elements with positions and expanded entities.
//!
//! The syntax is parsed by `quick-xml`. This module adds the tree, the positions, and the entities of a document type:
//! `<!ENTITY name "text">` and `<!ENTITY name SYSTEM "file.xml">`, where the path is relative to the declaring file.
//! Entities may refer to other entities. An entity expansion limit prevents short files from exhausting memory ("billion
//! laughs").

use super::problem::{Place, Problem};
use quick_xml::events::{BytesStart, Event};
use quick_xml::{Error, Reader};
use rayweave_scene::{Diagnostic, Source, Span};
use rayweave_table::AllowedFiles;
use std::collections::{BTreeMap, HashMap};
use std::path::PathBuf;
use std::sync::Arc;

/// Maximal nesting depth of elements: GDML itself nests about ten deep, and entities add to that.
const DEEPEST: usize = 200;
/// Maximum number of attributes of an element.
const MAX_ATTRIBUTES: usize = 200;
/// Maximal nesting depth of entity references.
const DEEPEST_ENTITY: usize = 20;
/// Maximum number of entity references in a document.
const MAX_REFERENCES: usize = 100_000;
/// Entity expansion limit: bytes of internal entities, counting every use.
const MAX_EXPANDED: usize = 16 << 20;
/// Bytes of external entities, counting every use.
const MAX_INCLUDED: usize = 64 << 20;

/// Name of an element or attribute; equal names share one allocation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Name(Arc<str>);

impl std::ops::Deref for Name {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl Name {
    pub fn new(name: &str) -> Name {
        Name(name.into())
    }

    pub fn as_str(&self) -> &str {
        &self.0
    }
}

impl PartialEq<str> for Name {
    fn eq(&self, other: &str) -> bool {
        *self.0 == *other
    }
}

impl PartialEq<&str> for Name {
    fn eq(&self, other: &&str) -> bool {
        *self.0 == **other
    }
}

impl std::fmt::Display for Name {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

/// An element: `<name attribute="value">children</name>`.
#[derive(Clone, Debug)]
pub(super) struct Element {
    pub name: Name,
    /// Position of the opening tag.
    pub place: Place,
    pub attributes: Vec<Attribute>,
    pub children: Vec<Element>,
    /// The first text among the children that is not blank.
    pub content: Option<Box<Attribute>>,
}

/// An attribute with its expanded value.
#[derive(Clone, Debug)]
pub(super) struct Attribute {
    pub name: Name,
    pub value: String,
    /// Position of the value between its quotation marks.
    pub place: Place,
    /// True if the value occurs unchanged in the text, so that positions within it are known.
    pub verbatim: bool,
}

impl Attribute {
    /// A part of the value, starting at a byte offset.
    pub fn part(&self, text: &str, at: usize) -> Attribute {
        let start = self.place.span.start() + at;
        let span = if self.verbatim { Span::new(start, start + text.len()) } else { self.place.span };
        Attribute { value: text.to_owned(), place: Place { span, ..self.place }, ..self.clone_head() }
    }

    fn clone_head(&self) -> Attribute {
        Attribute {
            name: self.name.clone(),
            value: String::new(),
            place: self.place,
            verbatim: self.verbatim,
        }
    }
}

impl Element {
    /// An attribute by its name.
    pub fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    /// Value of an attribute, or "".
    pub fn text(&self, name: &str) -> &str {
        self.attribute(name).map_or("", |attribute| attribute.value.as_str())
    }

    /// The first child with a name.
    pub fn child(&self, name: &str) -> Option<&Element> {
        self.children.iter().find(|child| child.name == name)
    }
}

/// The texts of a document.
#[derive(Debug, Default)]
pub(super) struct Files {
    /// The files that may be included.
    pub allowed: AllowedFiles,
    sources: Vec<Arc<Source>>,
}

impl Files {
    pub fn add(&mut self, source: Arc<Source>) -> u32 {
        self.sources.push(source);
        self.sources.len() as u32 - 1
    }

    /// The length of all texts so far.
    pub fn bytes(&self) -> usize {
        self.sources.iter().map(|source| source.text().len()).sum()
    }

    /// Adds the position to a diagnostic.
    pub fn locate(&self, problem: Diagnostic, place: Place) -> Diagnostic {
        match self.sources.get(place.file as usize) {
            Some(source) => problem.at(source, place.span),
            None => problem,
        }
    }

    fn path(&self, file: u32) -> Option<&PathBuf> {
        self.sources.get(file as usize)?.path()
    }

    /// Path of a file that another file refers to, relative to the latter.
    pub fn beside(&self, file: u32, name: &str) -> PathBuf {
        let name = name.strip_prefix("file:").unwrap_or(name);
        // the main file may be a pipe, whose folder is not that of the model
        let path = self.path(file).filter(|_| file > 0);
        path.and_then(|path| path.parent()).unwrap_or(self.allowed.folder()).join(name)
    }
}

/// Parses a document and returns its root element.
///
/// # Errors
///
/// The first position where the text is not well-formed XML, an unresolved entity, or an exceeded limit.
pub(super) fn read(files: &mut Files, source: Arc<Source>) -> Result<Element, Problem> {
    let file = files.add(source.clone());
    let mut tree = Tree {
        files,
        entities: BTreeMap::new(),
        names: HashMap::new(),
        roots: Vec::new(),
        open: Vec::new(),
        references: 0,
        expanded: 0,
        included: 0,
    };
    tree.text(file, &source, 0)?;
    let mut roots = tree.roots;
    match roots.len() {
        1 => Ok(roots.remove(0)),
        0 => Err(Problem::new(
            "the file has no element: it is empty, or not XML.",
            Place { file, span: Span::default() },
        )),
        _ => Err(Problem::new(
            format!(
                "a second element `{}` after the end of the first: a file has one root element.",
                roots[1].name
            ),
            roots[1].place,
        )),
    }
}

/// The replacement of an entity.
#[derive(Clone)]
enum Entity {
    Text(Arc<Source>),
    File(PathBuf),
}

struct Tree<'f> {
    files: &'f mut Files,
    entities: BTreeMap<String, (Entity, Place)>,
    /// Interned names.
    names: HashMap<String, Name>,
    roots: Vec<Element>,
    /// Stack of open elements.
    open: Vec<Element>,
    references: usize,
    expanded: usize,
    included: usize,
}

impl Tree<'_> {
    /// Parses a text into the innermost open element.
    fn text(&mut self, file: u32, source: &Arc<Source>, depth: usize) -> Result<(), Problem> {
        let text = source.text();
        let floor = self.open.len();
        let mut reader = Reader::from_str(text);
        loop {
            let before = reader.buffer_position() as usize;
            let event = reader.read_event();
            let span = Span::new(before.min(text.len()), (reader.buffer_position() as usize).min(text.len()));
            let place = Place { file, span };
            match event
                .map_err(|error| syntax_problem(&error, place, reader.error_position() as usize, text))?
            {
                Event::Start(tag) => self.start(&tag, place, depth)?,
                Event::Empty(tag) => {
                    self.start(&tag, place, depth)?;
                    self.close();
                }
                Event::End(_) if self.open.len() > floor => self.close(),
                Event::DocType(declaration) => self.declare(&declaration, text, file)?,
                Event::GeneralRef(name) => self.refer(&name, place, depth)?,
                Event::Text(content) => self.content(&content, place),
                Event::Eof => break,
                _ => {}
            }
        }
        match self.open.get(floor) {
            None => Ok(()),
            Some(element) => Err(Problem::new(
                format!(
                    "the element `{}` is not closed: the text ends before `</{}>`.",
                    element.name, element.name
                ),
                element.place,
            )),
        }
    }

    fn start(&mut self, tag: &BytesStart, place: Place, depth: usize) -> Result<(), Problem> {
        if self.open.len() >= DEEPEST {
            return Err(Problem::new(
                format!("more than {DEEPEST} nested elements: GDML never nests so deeply."),
                place,
            ));
        }
        let mut attributes = Vec::new();
        for attribute in tag.attributes() {
            // each is compared with those before it
            if attributes.len() == MAX_ATTRIBUTES {
                let message = format!(
                    "the element has more than {MAX_ATTRIBUTES} attributes: GDML has no use for them."
                );
                return Err(Problem::new(message, place));
            }
            let attribute =
                attribute.map_err(|error| Problem::new(format!("the tag is malformed: {error}."), place))?;
            let at = place.span.start() + 1 + offset_in(tag, &attribute.value);
            let place = Place { file: place.file, span: Span::new(at, at + attribute.value.len()) };
            let value = self.unescaped(&attribute.value, place, depth)?;
            let verbatim = value == *attribute.value;
            let name = self.name(attribute.key.as_ref());
            attributes.push(Attribute { name, value, place, verbatim });
        }
        // there are as many attribute lists as elements, and memory limits the size of files
        attributes.shrink_to_fit();
        let name = self.name(tag.name().as_ref());
        self.open.push(Element { name, place, attributes, children: Vec::new(), content: None });
        Ok(())
    }

    fn name(&mut self, name: &str) -> Name {
        if let Some(known) = self.names.get(name) {
            return known.clone();
        }
        let new = Name::new(name);
        self.names.insert(name.to_owned(), new.clone());
        new
    }

    fn content(&mut self, text: &str, place: Place) {
        if let Some(element) = self.open.last_mut().filter(|element| element.content.is_none()) {
            let (start, trimmed) = (text.len() - text.trim_start().len(), text.trim());
            if trimmed.is_empty() {
                return;
            }
            let at = place.span.start() + start;
            let place = Place { span: Span::new(at, at + trimmed.len()), ..place };
            let name = Name::new("");
            element.content =
                Some(Box::new(Attribute { name, value: trimmed.to_owned(), place, verbatim: true }));
        }
    }

    fn close(&mut self) {
        if let Some(mut element) = self.open.pop() {
            element.children.shrink_to_fit();
            let siblings = self.open.last_mut().map_or(&mut self.roots, |parent| &mut parent.children);
            siblings.push(element);
        }
    }

    /// A reference in the content: parses the replacement text in its place.
    fn refer(&mut self, name: &str, place: Place, depth: usize) -> Result<(), Problem> {
        if character(name).is_some() {
            return Ok(());
        }
        self.count(place, depth)?;
        let source = match self.entity(name, place)? {
            Entity::Text(source) => {
                self.expand(source.text().len(), name, place)?;
                source
            }
            Entity::File(path) => {
                let source =
                    Arc::new(super::source::included(&self.files.allowed, &path).map_err(|reason| {
                        Problem::new(
                            format!("the entity `{name}` cannot be read ({}: {reason})", path.display()),
                            place,
                        )
                    })?);
                self.included += source.text().len();
                if self.included > MAX_INCLUDED {
                    return Err(Problem::new(
                        format!("the files of the entities have more than {} MiB", MAX_INCLUDED >> 20),
                        place,
                    ));
                }
                source
            }
        };
        let file = self.files.add(source.clone());
        self.text(file, &source, depth + 1)
    }

    fn count(&mut self, place: Place, depth: usize) -> Result<(), Problem> {
        self.references += 1;
        if depth >= DEEPEST_ENTITY {
            return Err(Problem::new(
                format!("entities are nested more than {DEEPEST_ENTITY} deep. Does one contain itself?"),
                place,
            ));
        }
        if self.references > MAX_REFERENCES {
            return Err(Problem::new(format!("more than {MAX_REFERENCES} references to entities"), place));
        }
        Ok(())
    }

    fn expand(&mut self, bytes: usize, name: &str, place: Place) -> Result<(), Problem> {
        self.expanded += bytes;
        match self.expanded > MAX_EXPANDED {
            true => Err(Problem::new(
                format!(
                    "the entity `{name}` makes the text longer than {} MiB. Do entities repeat each other?",
                    MAX_EXPANDED >> 20
                ),
                place,
            )),
            false => Ok(()),
        }
    }

    fn entity(&self, name: &str, place: Place) -> Result<Entity, Problem> {
        match self.entities.get(name) {
            Some((entity, _)) => Ok(entity.clone()),
            None => {
                let known = self.entities.keys().map(String::as_str);
                Err(Problem::new(
                    format!("unknown entity `&{name};`: no <!ENTITY {name} ..> declares it."),
                    place,
                )
                .did_you_mean(name, known))
            }
        }
    }

    /// Value of an attribute with expanded references.
    fn unescaped(&mut self, raw: &str, place: Place, depth: usize) -> Result<String, Problem> {
        let (mut value, mut rest) = (String::with_capacity(raw.len()), raw);
        while let Some(at) = rest.find('&') {
            value += &rest[..at];
            let end = rest[at..].find(';').ok_or_else(|| {
                Problem::new(
                    "a value has a `&` without `;`: it begins a reference. Did you mean `&amp;`?",
                    place,
                )
            })?;
            let name = &rest[at + 1..at + end];
            match character(name) {
                Some(c) => value.push(c),
                None => value += &self.replacement(name, place, depth)?,
            }
            rest = &rest[at + end + 1..];
        }
        value += rest;
        Ok(value)
    }

    fn replacement(&mut self, name: &str, place: Place, depth: usize) -> Result<String, Problem> {
        self.count(place, depth)?;
        match self.entity(name, place)? {
            Entity::File(_) => Err(Problem::new(
                format!("the entity `{name}` is a file, which is not allowed in a value"),
                place,
            )),
            Entity::Text(source) => {
                self.expand(source.text().len(), name, place)?;
                self.unescaped(source.text(), place, depth + 1)
            }
        }
    }

    /// Reads the entities of a document type; other declarations have no effect.
    fn declare(&mut self, declaration: &str, text: &str, file: u32) -> Result<(), Problem> {
        let base = text.find(declaration).unwrap_or(0);
        let mut at = 0;
        while let Some(found) = declaration[at..].find("<!ENTITY") {
            let start = at + found;
            let words = declaration_words(&declaration[start + "<!ENTITY".len()..]);
            let place = Place { file, span: Span::new(base + start, base + start + "<!ENTITY".len()) };
            at = start + "<!ENTITY".len();
            let texts: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
            let entity = match texts.as_slice() {
                ["%", ..] => continue,
                [name, "SYSTEM", path, ..] => (*name, Entity::File(self.files.beside(file, path))),
                [name, "PUBLIC", _, path, ..] => (*name, Entity::File(self.files.beside(file, path))),
                [name, text, ..] if words[1].1 => {
                    let source = Source::new(Some(format!("&{name};").into()), (*text).to_owned());
                    (*name, Entity::Text(Arc::new(source)))
                }
                _ => {
                    return Err(Problem::new(
                        "the declaration of an entity is malformed: the forms are <!ENTITY name \"text\"> and <!ENTITY name SYSTEM \"file\">.",
                        place,
                    ));
                }
            };
            // the first declaration of an entity is binding (XML 1.0, section 4.2)
            self.entities.entry(entity.0.to_owned()).or_insert((entity.1, place));
        }
        Ok(())
    }
}

/// The words of a declaration up to its `>`, each with a flag whether it is quoted.
fn declaration_words(text: &str) -> Vec<(&str, bool)> {
    let (mut words, mut rest) = (Vec::new(), text.trim_start());
    while words.len() < 4 && !rest.is_empty() && !rest.starts_with('>') {
        let quote = rest.chars().next().filter(|c| matches!(c, '"' | '\''));
        let (word, after) = match quote {
            Some(quote) => rest[1..].split_once(quote).unwrap_or((&rest[1..], "")),
            None => rest.split_at(rest.find(|c: char| c.is_whitespace() || c == '>').unwrap_or(rest.len())),
        };
        words.push((word, quote.is_some()));
        rest = after.trim_start();
    }
    words
}

/// The character of a predefined or numeric reference.
fn character(name: &str) -> Option<char> {
    match name {
        "lt" => Some('<'),
        "gt" => Some('>'),
        "amp" => Some('&'),
        "quot" => Some('"'),
        "apos" => Some('\''),
        _ => {
            let digits = name.strip_prefix('#')?;
            let code = match digits.strip_prefix('x') {
                Some(hex) => u32::from_str_radix(hex, 16),
                None => digits.parse(),
            };
            char::from_u32(code.ok()?)
        }
    }
}

/// Byte offset of a part of a text.
fn offset_in(text: &str, part: &str) -> usize {
    let offset = (part.as_ptr() as usize).wrapping_sub(text.as_ptr() as usize);
    if offset <= text.len() { offset } else { 0 }
}

fn syntax_problem(error: &Error, place: Place, at: usize, text: &str) -> Problem {
    let at = at.min(text.len());
    let span = if at > place.span.start() {
        Span::new(place.span.start(), at)
    } else {
        Span::new(at, at.max(place.span.end()))
    };
    Problem::new(format!("the file is not well-formed XML: {error}."), Place { span, ..place })
}
