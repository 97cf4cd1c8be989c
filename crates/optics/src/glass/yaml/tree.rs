//! YAML trees: texts, lists and mappings with their lines, of limited depth.

use saphyr_parser::{Event, Parser, ScanError, Span, StrInput};

use crate::glass::read::FileProblem;

/// Files of refractiveindex.info are four levels deep; the limit protects the call stack from hostile files.
const MAX_DEPTH: usize = 32;

/// A node and its first line.
#[derive(Debug, PartialEq)]
pub(super) struct Node {
    /// Counted from 1.
    pub line: usize,
    value: Value,
}

#[derive(Debug, PartialEq)]
enum Value {
    Text(String),
    List(Vec<Node>),
    /// Entries whose keys are not texts are left out.
    Mapping(Vec<(String, Node)>),
}

impl Node {
    /// The text of a scalar, uninterpreted.
    pub fn text(&self) -> Option<&str> {
        if let Value::Text(text) = &self.value { Some(text) } else { None }
    }

    /// The items of a list.
    pub fn items(&self) -> Option<&[Node]> {
        if let Value::List(items) = &self.value { Some(items) } else { None }
    }

    /// The value of a key of a mapping.
    pub fn get(&self, key: &str) -> Option<&Node> {
        let Value::Mapping(entries) = &self.value else { return None };
        entries.iter().find(|(known, _)| known == key).map(|(_, node)| node)
    }
}

/// The documents of a text.
///
/// # Errors
/// The first place that is not YAML, is too deep, or uses an alias.
pub(super) fn documents(text: &str) -> Result<Vec<Node>, FileProblem> {
    let mut builder = Builder { parser: Parser::new_from_str(text) };
    let mut documents = Vec::new();
    while let Some((event, span)) = builder.next()? {
        if starts_node(&event) {
            documents.push(builder.node(event, span, 0)?);
        }
    }
    Ok(documents)
}

fn starts_node(event: &Event) -> bool {
    matches!(event, Event::Scalar(..) | Event::SequenceStart(..) | Event::MappingStart(..) | Event::Alias(..))
}

struct Builder<'a> {
    parser: Parser<'a, StrInput<'a>>,
}

impl<'a> Builder<'a> {
    fn next(&mut self) -> Result<Option<(Event<'a>, Span)>, FileProblem> {
        self.parser.next_event().transpose().map_err(|error| problem_of_syntax(&error))
    }

    /// The node that begins with this event.
    fn node(&mut self, event: Event<'a>, span: Span, depth: usize) -> Result<Node, FileProblem> {
        let line = span.start.line();
        if depth > MAX_DEPTH {
            let text = format!("the lists and mappings are too deep: at most {MAX_DEPTH} may be nested.");
            return Err(FileProblem { line, text });
        }
        let value = match event {
            Event::Scalar(text, ..) => Value::Text(text.into_owned()),
            Event::SequenceStart(..) => Value::List(self.children(depth)?),
            Event::MappingStart(..) => Value::Mapping(pairs(self.children(depth)?)),
            _ => {
                let text =
                    "an alias is not allowed: files of refractiveindex.info have none. Write its value here."
                        .to_owned();
                return Err(FileProblem { line, text });
            }
        };
        Ok(Node { line, value })
    }

    /// The nodes up to the end of a list or a mapping.
    fn children(&mut self, depth: usize) -> Result<Vec<Node>, FileProblem> {
        let mut children = Vec::new();
        while let Some((event, span)) = self.next()? {
            match event {
                Event::SequenceEnd | Event::MappingEnd => break,
                event if starts_node(&event) => children.push(self.node(event, span, depth + 1)?),
                _ => {}
            }
        }
        Ok(children)
    }
}

fn pairs(children: Vec<Node>) -> Vec<(String, Node)> {
    let mut children = children.into_iter();
    let mut pairs = Vec::new();
    while let (Some(key), Some(value)) = (children.next(), children.next()) {
        if let Value::Text(key) = key.value {
            pairs.push((key, value));
        }
    }
    pairs
}

fn problem_of_syntax(error: &ScanError) -> FileProblem {
    let text = format!("this is not YAML: {}. Is an indentation wrong?", error.info());
    FileProblem { line: error.marker().line().max(1), text }
}
