//! Source text of the tables of other programs.

use crate::datum::{Datum, Table, from_toml, key, to_toml};
use crate::source::{Source, Span, Spanned};
use std::sync::Arc;
use toml::de::DeTable;

/// The sections of a file: from one header, or the comment directly above it, to the next.
pub(super) struct Sections<'a> {
    source: &'a Source,
    /// Start of each section, and the top-level table that it belongs to.
    starts: Vec<(usize, &'a str)>,
    /// The end of the last section.
    end: usize,
}

impl<'a> Sections<'a> {
    /// The sections of a table, the last of which ends at `end`.
    pub fn new(source: &'a Source, table: &'a Table, end: usize) -> Sections<'a> {
        let mut starts = Vec::new();
        for (name, value) in table {
            collect_headers(source, value, &name.value, &mut starts);
        }
        for (start, _) in &mut starts {
            *start = with_comment(source.text(), *start);
        }
        starts.sort();
        starts.dedup_by_key(|(start, _)| *start);
        Sections { source, starts, end }
    }

    /// The text of a top-level table: that of all its sections, or `name = { .. }` if it has none.
    pub fn text(&self, entry: &(Spanned<String>, Spanned<Datum>)) -> String {
        let (name, value) = entry;
        let ends = self.starts.iter().skip(1).map(|(start, _)| *start).chain([self.end]);
        let mine = self.starts.iter().zip(ends).filter(|((_, owner), _)| *owner == name.value);
        let text: String = mine.map(|((start, _), end)| self.source.slice(Span::new(*start, end))).collect();
        let text = match text.trim_end() {
            "" => self.source.slice(name.span.to(value.span)),
            text => text,
        };
        // dotted keys may be anywhere in the file; the text of the sections is then incomplete
        match says(text, entry) {
            true => format!("{text}\n"),
            false => format!("{} = {}\n", key(&name.value), to_toml(&value.value)),
        }
    }
}

/// True if a text is exactly equivalent to an entry.
fn says(text: &str, entry: &(Spanned<String>, Spanned<Datum>)) -> bool {
    let source = Arc::new(Source::default());
    let table = DeTable::parse(text).map(|table| from_toml(table.get_ref(), 0, &source, &mut Vec::new()));
    table.is_ok_and(|table| table.as_slice() == std::slice::from_ref(entry))
}

/// Collects the positions of all headers (`[a.b]`, `[[a.b]]`) below a value.
fn collect_headers<'a>(
    source: &Source,
    value: &Spanned<Datum>,
    name: &'a str,
    starts: &mut Vec<(usize, &'a str)>,
) {
    match &value.value {
        Datum::Table(table) => {
            if source.slice(value.span).starts_with('[') {
                starts.push((value.span.start(), name));
            }
            table.iter().for_each(|(_, value)| collect_headers(source, value, name, starts));
        }
        // the position of an array of tables is that of its first header; its items have their own
        Datum::List(list) => list.iter().for_each(|value| collect_headers(source, value, name, starts)),
        _ => {}
    }
}

/// Moves the start of a header to the first of the comment lines directly above it.
pub(super) fn with_comment(text: &str, header: usize) -> usize {
    let mut start = text[..header].rfind('\n').map_or(0, |end| end + 1);
    loop {
        let Some(above) = text[..start].strip_suffix('\n') else {
            return start;
        };
        let line = above.rfind('\n').map_or(0, |end| end + 1);
        if !above[line..].trim_start().starts_with('#') {
            return start;
        }
        start = line;
    }
}
