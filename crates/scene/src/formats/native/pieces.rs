//! The pieces of a large model file, which are read independently.
//!
//! The syntax tree of a text takes tens of times the memory of the text. A file is therefore cut in front of
//! headers such as `[solid.ball]`, and the tree of each piece is dropped before the next piece is parsed.
//!
//! A TOML file is a list of lines, apart from values that extend over several lines, and a truncated value does
//! not parse. So if each piece is valid, so is the file, unless several pieces define the same table: see
//! [`Merge`].

use super::foreign::with_comment;
use crate::datum::Datum;
use crate::source::{Source, Span, Spanned};
use rayweave_model::NameState;
use std::collections::HashMap;
use std::hash::BuildHasher;
use std::ops::Range;

/// The length of pieces in bytes, up to the next header.
pub(super) const LENGTH: usize = 1 << 16;

/// The beginnings of headers before which a text may be cut.
const HEADERS: [&str; 2] = ["[solid.", "[[region]]"];

/// The top-level tables that several pieces may add to. The reader passes their entries on one by one.
const SHARED: [&str; 4] = ["solid", "region", "medium", "light"];

/// Divides a text into pieces of about this length. Each ends before the next header and the comment above it.
pub(super) fn pieces(text: &str, length: usize) -> impl Iterator<Item = Range<usize>> {
    let mut next = Some(0);
    std::iter::from_fn(move || {
        let start = next?;
        next = cut(text, start, start + length);
        Some(start..next.unwrap_or(text.len()))
    })
}

/// The end of the piece that begins at `start`, at or after `from`; `None` if it is the last piece.
fn cut(text: &str, start: usize, mut from: usize) -> Option<usize> {
    let bytes = text.as_bytes();
    loop {
        let line = from + bytes.get(from..)?.iter().position(|&byte| byte == b'\n')? + 1;
        // the position is after a line end and thus between characters
        let cut = is_header(&text[line..]).then(|| with_comment(text, line)).filter(|&cut| cut > start);
        if cut.is_some() {
            return cut;
        }
        from = line;
    }
}

/// True at a header of a solid or a region. The header of a part of a solid, such as `[solid.ball.sphere]`, does
/// not count: it belongs to the table before it.
fn is_header(line: &str) -> bool {
    let found = HEADERS.iter().find_map(|header| line.strip_prefix(header));
    found.is_some_and(|rest| {
        let name = rest.find(|c: char| !c.is_ascii_alphanumeric() && c != '_' && c != '-');
        name.is_none_or(|end| rest[end..].starts_with([']', '\n', '\r']))
    })
}

/// A top-level entry of a piece.
pub(super) struct TopLevel {
    key: String,
    kind: Kind,
    /// Hashes of its names, of an entry to which several pieces may add named tables.
    names: Vec<u64>,
}

/// The form of a top-level entry.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// Only headers of its parts, such as `[solid.ball]`: other pieces may add more.
    Parts,
    /// Headers of its items, such as `[[region]]`: other pieces may add more.
    Items,
    /// Anything else.
    Whole,
}

impl TopLevel {
    /// Describes an entry; `hasher` is that of the [`Merge`].
    pub fn new(source: &Source, entry: &(Spanned<String>, Spanned<Datum>), hasher: &NameState) -> TopLevel {
        let (key, value) = (entry.0.value.clone(), &entry.1);
        let names = match &value.value {
            Datum::Table(table) if SHARED.contains(&key.as_str()) => {
                table.iter().map(|(name, _)| hasher.hash_one((&key, &name.value))).collect()
            }
            _ => Vec::new(),
        };
        TopLevel { kind: kind(source, value), key, names }
    }
}

/// Checks that the pieces of a text have the same tables as the text as a whole.
#[derive(Default)]
pub(super) struct Merge {
    kinds: HashMap<String, Kind>,
    /// Hashes of the names of solids and other named tables; two names with the same hash count as one.
    names: Vec<u64>,
    hasher: NameState,
}

impl Merge {
    pub fn hasher(&self) -> NameState {
        self.hasher.clone()
    }

    /// True if the entries of a piece can be added to those of the pieces before it, apart from repeated names.
    pub fn admits(&mut self, piece: Vec<TopLevel>) -> bool {
        piece.into_iter().all(|entry| self.admits_entry(entry))
    }

    fn admits_entry(&mut self, TopLevel { key, kind, names }: TopLevel) -> bool {
        self.names.extend(names);
        match self.kinds.get(&key) {
            Some(before) => kind != Kind::Whole && kind == *before && SHARED.contains(&key.as_str()),
            None => {
                self.kinds.insert(key, kind);
                true
            }
        }
    }

    /// True if no name is repeated.
    pub fn has_unique_names(mut self) -> bool {
        self.names.sort_unstable();
        self.names.windows(2).all(|pair| pair[0] != pair[1])
    }
}

fn kind(source: &Source, value: &Spanned<Datum>) -> Kind {
    let begins = |span: Span, with: &str| source.slice(span).starts_with(with);
    let is_item = |item: &Spanned<Datum>| matches!(item.value, Datum::Table(_)) && begins(item.span, "[[");
    match &value.value {
        // a table without its own header has the span of its name in the first header of a part
        Datum::Table(_) if !begins(value.span, "[") && !begins(value.span, "{") => Kind::Parts,
        Datum::List(list) if list.iter().all(is_item) && !list.is_empty() => Kind::Items,
        _ => Kind::Whole,
    }
}

#[cfg(test)]
mod tests {
    use super::super::read::{Kept, Reading, read_pieces, read_whole};
    use super::*;
    use crate::diagnostic::Diagnostics;
    use rand::rngs::ChaCha8Rng;
    use rand::{RngExt, SeedableRng};
    use std::sync::Arc;

    #[test]
    fn pieces_end_before_headers() {
        let mut text = "rayweave = 1\n".to_owned();
        for k in 0..5000 {
            text += &format!("# ball {k}\n[solid.b{k}]\n[solid.b{k}.sphere]\nradius = {k}.5\n\n");
        }
        let all: Vec<_> = pieces(&text, LENGTH).collect();
        assert!(all.len() > 2 && all.iter().skip(1).all(|piece| text[piece.clone()].starts_with("# ball ")));
        assert!(
            all.iter().rev().skip(1).all(|piece| piece.len() + 100 > LENGTH && piece.len() < LENGTH + 100)
        );
        assert_eq!(all.iter().map(|piece| &text[piece.clone()]).collect::<String>(), text);
        assert!(pieces("", LENGTH).eq(std::iter::once(0..0)));
    }

    #[test]
    fn long_comments_stay_with_their_table() {
        let comment = "# \u{e4}\u{e4}\u{e4}\n".repeat(LENGTH / 4);
        let text = format!("{comment}[solid.a]\n{comment}[solid.b]\n{comment}");
        let all: Vec<_> = pieces(&text, LENGTH).collect();
        assert_eq!(all.len(), 2);
        assert_eq!(all[0].end, comment.len() + "[solid.a]\n".len());
    }

    /// Everything that was read, with all spans.
    fn shown(reading: Reading) -> String {
        let Reading { document, problems, broken, unreadable, .. } = reading;
        let unreadable: std::collections::BTreeSet<String> = unreadable.into_iter().collect();
        format!("{document:#?} {:#?} {broken} {unreadable:?}", Diagnostics::new(problems))
    }

    /// True if a text can be read in pieces; asserts that the result is then the same as for the whole text.
    fn agrees(text: &str) -> bool {
        let source = Arc::new(Source::new(None, text.to_owned()));
        let whole = read_whole(&source, Kept::Document);
        let Some(reader) = read_pieces(&source, 1, Kept::Document) else { return false };
        assert!(!whole.broken, "{text}");
        assert_eq!(shown(reader.finish(false)), shown(whole), "{text}");
        true
    }

    fn models() -> Vec<String> {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../models");
        let files = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path());
        let mut files: Vec<_> =
            files.filter(|path| path.extension().is_some_and(|end| end == "toml")).collect();
        files.sort();
        files.iter().map(|path| std::fs::read_to_string(path).unwrap()).collect()
    }

    #[test]
    fn models_read_in_pieces_as_they_do_whole() {
        let models = models();
        assert!(models.len() > 10);
        assert!(models.iter().all(|text| agrees(text)));
    }

    #[test]
    fn tables_of_several_pieces() {
        let agree = [
            "[[region]]\nsolid = 'a'\n[[region]]\nsolid = 'b'\n# c\n[solid.a]\nsphere = { radius = 1e999 }",
            "[medium.a]\n[solid.a]\n[medium.b]\n[[light]]\n[solid.b]\n[[light]]\n[[region]]\n[x]\na = 1",
            "[solid.a]\n[solid.a.sphere]\nradius = 1\n[solid.b]\n[solid.b.sphere]\nradius = 2",
            "a.b = 1\nsolid.c.sphere.radius = 1\n[solid.d]\nname = \"\"\"\n[x]\n\"\"\"\n[solid.e]\nsphere = 5",
        ];
        assert!(agree.iter().all(|text| agrees(text)));
        // valid TOML or not, these are read as a whole
        let others = [
            "[solid.a]\nx = 1\n[solid.b]\n[solid.a]",
            "[solid]\nb = {}\n[solid.a]",
            "solid = {}\n[solid.a]",
            "region = []\n[[region]]",
            "region = [{}]\n[[region]]",
            "[solid.a]\n[[solid]]",
            "[solid.a]\n[solid.b]\n[solid]",
            "[optics.a]\n[solid.b]\n[optics.c]",
            "[[region]]\n[solid.b]\n[region.c]",
            "[solid.a]\nname = '''\n[solid.b]\n'''",
            "[solid.a]\nx = [\n[[region]]\n]",
        ];
        assert!(others.iter().all(|text| !agrees(text)));
    }

    #[test]
    fn changed_models_read_in_pieces_as_they_do_whole() {
        let mut rng = ChaCha8Rng::seed_from_u64(1);
        let models = models();
        let lines: Vec<&str> = models.iter().flat_map(|text| text.lines()).collect();
        let mut agreeing = 0;
        for _ in 0..2000 {
            let mut text: Vec<&str> = models[rng.random_range(0..models.len())].lines().collect();
            for _ in 0..rng.random_range(1..4) {
                let (at, other) = (rng.random_range(0..text.len()), rng.random_range(0..text.len()));
                match rng.random_range(0..3) {
                    0 => drop(text.remove(at)),
                    1 => text.insert(at, lines[rng.random_range(0..lines.len())]),
                    _ => text.swap(at, other),
                }
                if text.is_empty() {
                    break;
                }
            }
            agreeing += u32::from(agrees(&text.join("\n")));
        }
        // many are no longer valid TOML
        assert!(agreeing > 500, "{agreeing}");
    }
}
