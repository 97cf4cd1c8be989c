//! Untyped values of a model file: numbers, strings, lists and tables with their source spans.

use crate::diagnostic::Diagnostic;
use crate::number::written;
use crate::source::{Source, Span, Spanned};
use std::sync::Arc;
use toml::de::{DeInteger, DeTable, DeValue};

/// An untyped value of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum Datum {
    /// A number; integers beyond 2^53 are rounded.
    Number(f64),
    /// A string.
    Text(String),
    /// `true` or `false`.
    Boolean(bool),
    /// A date or a time, as written.
    Time(String),
    /// Values in order.
    List(Vec<Spanned<Datum>>),
    /// Values with names, in the order of the file.
    Table(Table),
}

/// Values with names, in the order of the file.
pub type Table = Vec<(Spanned<String>, Spanned<Datum>)>;

impl Datum {
    /// The value of a key, if this is a table that has it.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&Datum> {
        if let Datum::Table(table) = self { lookup(table, key) } else { None }
    }

    /// The string of a key; empty if this is not a table that has such a string.
    #[must_use]
    pub fn text(&self, key: &str) -> &str {
        self.get(key).and_then(Datum::as_text).unwrap_or_default()
    }

    /// The values in the list of a key; none if this is not a table that has such a list.
    pub fn list(&self, key: &str) -> impl Iterator<Item = &Datum> {
        self.get(key).into_iter().flat_map(Datum::items)
    }

    /// The number, if this is one.
    #[must_use]
    pub fn as_number(&self) -> Option<f64> {
        if let Datum::Number(number) = self { Some(*number) } else { None }
    }

    /// The string, if this is one.
    #[must_use]
    pub fn as_text(&self) -> Option<&str> {
        if let Datum::Text(text) = self { Some(text) } else { None }
    }

    /// The values of a list; none for anything else.
    pub fn items(&self) -> impl Iterator<Item = &Datum> {
        let list = if let Datum::List(list) = self { list.as_slice() } else { &[] };
        list.iter().map(|item| &item.value)
    }

    /// The keys and values of a table; none for anything else.
    pub fn entries(&self) -> impl Iterator<Item = (&str, &Datum)> {
        let table = if let Datum::Table(table) = self { table.as_slice() } else { &[] };
        table.iter().map(|(name, value)| (name.value.as_str(), &value.value))
    }

    /// Kind of the value, for messages.
    pub(crate) fn description(&self) -> String {
        match self {
            Datum::Number(value) => format!("the number {}", written(*value)),
            Datum::Text(_) => "a string".to_owned(),
            Datum::Boolean(value) => format!("`{value}`"),
            Datum::Time(_) => "a date or time".to_owned(),
            Datum::List(list) => match list.len() {
                0 => "an empty list".to_owned(),
                1 => "a list of 1 value".to_owned(),
                n => format!("a list of {n} values"),
            },
            Datum::Table(_) => "a table".to_owned(),
        }
    }
}

/// The value of a key of a table, if it has the key.
#[must_use]
pub fn lookup<'t>(table: &'t Table, key: &str) -> Option<&'t Datum> {
    table.iter().find(|(name, _)| name.value == key).map(|(_, value)| &value.value)
}

/// Converts a table from the syntax tree of a text that begins at `offset` in the source. The TOML
/// parser limits the nesting of tables to fewer than 300 levels.
pub(crate) fn from_toml(
    table: &DeTable,
    offset: usize,
    source: &Arc<Source>,
    problems: &mut Vec<Diagnostic>,
) -> Table {
    let entry = |(key, value): (&toml::Spanned<_>, &toml::Spanned<_>)| {
        let key: &toml::Spanned<toml::de::DeString> = key;
        let name = Spanned::new(key.get_ref().to_string(), Span::from(key.span()).shifted(offset));
        (name, datum(value, offset, source, problems))
    };
    collected(table.iter().map(entry))
}

fn datum(
    value: &toml::Spanned<DeValue>,
    offset: usize,
    source: &Arc<Source>,
    problems: &mut Vec<Diagnostic>,
) -> Spanned<Datum> {
    let span = Span::from(value.span()).shifted(offset);
    let datum = match value.get_ref() {
        DeValue::String(text) => Datum::Text(text.to_string()),
        DeValue::Integer(integer) => Datum::Number(whole(integer)),
        DeValue::Float(float) => Datum::Number(real(float.as_str(), span, source, problems)),
        DeValue::Boolean(boolean) => Datum::Boolean(*boolean),
        DeValue::Datetime(time) => Datum::Time(time.to_string()),
        DeValue::Array(list) => {
            Datum::List(list.iter().map(|value| datum(value, offset, source, problems)).collect())
        }
        DeValue::Table(table) => Datum::Table(from_toml(table, offset, source, problems)),
    };
    Spanned::new(datum, span)
}

/// Collects items into a list without spare capacity. `collect` allocates at least four places, but most lists
/// of a large file have one item.
pub(crate) fn collected<T>(items: impl ExactSizeIterator<Item = T>) -> Vec<T> {
    let mut list = Vec::with_capacity(items.len());
    list.extend(items);
    list
}

fn whole(integer: &DeInteger) -> f64 {
    match integer.radix() {
        10 => integer.as_str().parse().unwrap_or(f64::NAN),
        radix => u128::from_str_radix(integer.as_str(), radix).map_or(f64::NAN, |value| value as f64),
    }
}

fn real(text: &str, span: Span, source: &Arc<Source>, problems: &mut Vec<Diagnostic>) -> f64 {
    let value: f64 = text.parse().unwrap_or(f64::NAN);
    if value.is_infinite() && !text.contains("inf") {
        let problem =
            Diagnostic::error(format!("{text} is too large")).why("the largest number is about 1.8e308");
        let suggestion = Some("Did you mean `inf`?".to_owned());
        problems.push(problem.suggest(suggestion).at(source, span));
    }
    value
}

/// The value in TOML, on one line.
pub(crate) fn to_toml(datum: &Datum) -> String {
    match datum {
        Datum::Number(value) => written(*value),
        Datum::Text(text) => quoted(text),
        Datum::Boolean(value) => value.to_string(),
        Datum::Time(text) => text.clone(),
        Datum::List(list) => {
            let items: Vec<String> = list.iter().map(|item| to_toml(&item.value)).collect();
            format!("[{}]", items.join(", "))
        }
        Datum::Table(table) if table.is_empty() => "{}".to_owned(),
        Datum::Table(table) => {
            let items: Vec<String> = table
                .iter()
                .map(|(name, item)| format!("{} = {}", key(&name.value), to_toml(&item.value)))
                .collect();
            format!("{{ {} }}", items.join(", "))
        }
    }
}

/// A key in TOML.
pub(crate) fn key(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(bare) { name.to_owned() } else { quoted(name) }
}

/// A string in TOML.
pub(crate) fn quoted(text: &str) -> String {
    let mut quoted = String::with_capacity(text.len() + 2);
    quoted.push('"');
    for c in text.chars() {
        match c {
            '"' => quoted += "\\\"",
            '\\' => quoted += "\\\\",
            '\n' => quoted += "\\n",
            '\t' => quoted += "\\t",
            '\r' => quoted += "\\r",
            c if c.is_control() => quoted += &format!("\\u{:04x}", u32::from(c)),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> (Table, Vec<Diagnostic>) {
        let source = Arc::new(Source::new(None, text.to_owned()));
        let mut problems = Vec::new();
        let (table, errors) = DeTable::parse_recoverable(text);
        assert_eq!(errors, []);
        (from_toml(table.get_ref(), 0, &source, &mut problems), problems)
    }

    #[test]
    fn values_survive_printing() {
        let text = "a = [1, -2.5, 0x10, inf, 1e300]\n\"b c\" = \"q\\\"\\\\\\n\\u0001\u{e4}\"\nd = { e = true, f = {} }\ng = 1979-05-27";
        let (table, problems) = read(text);
        assert!(problems.is_empty());
        let printed: Vec<String> = table
            .iter()
            .map(|(name, datum)| format!("{} = {}", key(&name.value), to_toml(&datum.value)))
            .collect();
        assert_eq!(read(&printed.join("\n")).0, table);
        assert_eq!(printed[0], "a = [1, -2.5, 16, inf, 1e300]");
        assert_eq!(printed[2], "d = { e = true, f = {} }");
    }

    #[test]
    fn numbers_beyond_the_range_are_reported() {
        assert_eq!(
            read("a = 1e999").1[0].message(),
            "1e999 is too large: the largest number is about 1.8e308. Did you mean `inf`?"
        );
        assert_eq!(read("a = 99999999999999999999").0[0].1.value, Datum::Number(1e20));
    }
}
