//! Parser: tokens to a syntax tree, without recursion.

use super::token::{Token, Tokens};
use super::value::{Argument, Value};
use rayweave_scene::{Diagnostic, Diagnostics, Source, Span};
use std::sync::Arc;

/// Maximal nesting depth of lists; a matrix is a list of lists.
const DEEPEST_LIST: usize = 16;

/// Maximum number of nodes, and of values: a file with more is not a dump, and would exhaust memory.
const MAX_NODES: usize = 4_000_000;
const MAX_VALUES: usize = 32_000_000;

/// Modifier characters before a name: `%` background, `#` highlight, `*` disabled, `!` root.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Modifiers {
    pub background: bool,
    pub disabled: bool,
    pub root: bool,
}

/// A node `name(arguments) { children }`.
#[derive(Debug)]
pub(super) struct Node {
    pub name: String,
    /// Position of the name.
    pub span: Span,
    pub modifiers: Modifiers,
    pub arguments: Vec<Argument>,
    /// Indices of the children, greater than that of the node.
    pub children: Vec<u32>,
}

/// All nodes of a file, each before its children. Node 0 is a group of everything.
#[derive(Debug)]
pub(super) struct Tree {
    pub nodes: Vec<Node>,
}

/// A node whose children are being parsed.
struct Open {
    node: u32,
    /// The opening brace; `None` if its only child is the item that follows.
    brace: Option<Span>,
}

struct Parser<'a> {
    source: &'a Arc<Source>,
    tokens: Tokens<'a>,
    nodes: Vec<Node>,
    open: Vec<Open>,
    values: usize,
    /// Numbers out of range, which do not stop the parser.
    problems: Vec<Diagnostic>,
}

/// Parses the text of a dump.
///
/// # Errors
///
/// All numbers out of range, or the first unexpected token.
pub(super) fn parse(source: &Arc<Source>) -> Result<Tree, Diagnostics> {
    let root = Node {
        name: "group".to_owned(),
        span: Span::default(),
        modifiers: Modifiers::default(),
        arguments: Vec::new(),
        children: Vec::new(),
    };
    let mut parser = Parser {
        source,
        tokens: Tokens::new(source.text()),
        nodes: vec![root],
        open: vec![Open { node: 0, brace: Some(Span::default()) }],
        values: 0,
        problems: Vec::new(),
    };
    if let Err(problem) = parser.items() {
        parser.problems.push(*problem);
    }
    match parser.problems.is_empty() {
        true => Ok(Tree { nodes: parser.nodes }),
        false => Err(Diagnostics::new(parser.problems)),
    }
}

/// The error is boxed to keep the common result small.
type Step<T> = Result<T, Box<Diagnostic>>;

impl Parser<'_> {
    fn problem(&self, message: impl Into<String>, reason: &str, span: Span) -> Box<Diagnostic> {
        Box::new(Diagnostic::error(message).why(reason).at(self.source, span))
    }

    /// The next token, or an error at the end of the text.
    fn need(&mut self, wanted: &str) -> Step<(Token, Span)> {
        match self.tokens.next() {
            Some((Token::Bad(reason), span)) => {
                Err(self.problem(format!("{wanted} is missing"), reason, span))
            }
            Some(word) => Ok(word),
            None => {
                let reason = "the file ends here";
                let problem = *self.problem(format!("{wanted} is missing"), reason, self.tokens.place());
                let open = self.open.last().and_then(|open| open.brace).filter(|_| self.open.len() > 1);
                Err(Box::new(match open {
                    Some(brace) => problem.note(brace, "this brace is still open"),
                    None => problem,
                }))
            }
        }
    }

    fn unexpected(&self, wanted: &str, span: Span) -> Box<Diagnostic> {
        let found = self.source.slice(span);
        self.problem(format!("unexpected `{found}`"), &format!("{wanted} was expected"), span)
    }

    fn mark(&mut self, mark: char) -> Step<Span> {
        match self.need(&format!("`{mark}`"))? {
            (Token::Mark(found), span) if found == mark => Ok(span),
            (_, span) => Err(self.unexpected(&format!("`{mark}`"), span)),
        }
    }

    /// Parses the complete text.
    fn items(&mut self) -> Step<()> {
        loop {
            let (token, span) = if self.open.len() > 1 {
                self.need("`}`")?
            } else {
                match self.tokens.next() {
                    None => return Ok(()),
                    Some((Token::Bad(reason), span)) => {
                        return Err(self.problem("this is not an OpenSCAD dump", reason, span));
                    }
                    Some(word) => word,
                }
            };
            self.item(token, span)?;
        }
    }

    /// Parses an item up to its children, or the end of a list of children.
    fn item(&mut self, mut token: Token, mut span: Span) -> Step<()> {
        match token {
            Token::Mark('}') => return self.close(span),
            Token::Mark(';') => return Ok(()),
            _ => {}
        }
        let mut modifiers = Modifiers::default();
        while let Token::Mark(mark @ ('%' | '#' | '*' | '!')) = token {
            modifiers.background |= mark == '%';
            modifiers.disabled |= mark == '*';
            modifiers.root |= mark == '!';
            (token, span) = self.need("a name")?;
        }
        let Token::Name(name) = token else {
            return Err(self.unexpected("the name of an item", span));
        };
        self.mark('(')?;
        let arguments = self.arguments()?;
        let node = self.add(Node { name, span, modifiers, arguments, children: Vec::new() })?;
        match self.need("`;` or `{`")? {
            (Token::Mark(';'), _) => self.finish(),
            (Token::Mark('{'), brace) => self.open.push(Open { node, brace: Some(brace) }),
            (Token::Mark('}'), span) => return Err(self.unexpected("`;`, `{` or an item", span)),
            (_, span) => {
                // single child without braces: the loop reads its first token again
                self.open.push(Open { node, brace: None });
                self.tokens = Tokens::after(self.source.text(), span.start());
            }
        }
        Ok(())
    }

    fn add(&mut self, node: Node) -> Step<u32> {
        if self.nodes.len() >= MAX_NODES {
            let reason = format!("at most {MAX_NODES} can be read");
            return Err(self.problem("there are too many items", &reason, node.span));
        }
        let number = self.nodes.len() as u32;
        let parent = self.open.last().map_or(0, |open| open.node);
        self.nodes.push(node);
        self.nodes[parent as usize].children.push(number);
        Ok(number)
    }

    /// Completes a node, and all nodes that only waited for this child.
    fn finish(&mut self) {
        while self.open.last().is_some_and(|open| open.brace.is_none()) {
            self.open.pop();
        }
    }

    fn close(&mut self, span: Span) -> Step<()> {
        if self.open.len() == 1 || self.open.last().is_some_and(|open| open.brace.is_none()) {
            return Err(self.problem("this `}` closes nothing", "no `{` is open here", span));
        }
        self.open.pop();
        self.finish();
        Ok(())
    }

    /// Arguments up to the closing parenthesis.
    fn arguments(&mut self) -> Step<Vec<Argument>> {
        let mut arguments = Vec::new();
        let (mut token, mut span) = self.need("`)`")?;
        while token != Token::Mark(')') {
            arguments.push(self.argument(token, span)?);
            match self.need("`)`")? {
                (Token::Mark(')'), _) => break,
                (Token::Mark(','), _) => (token, span) = self.need("an argument")?,
                (_, span) => return Err(self.unexpected("`,` or `)`", span)),
            }
        }
        Ok(arguments)
    }

    /// `name = value`, or a value alone, which has the name "".
    fn argument(&mut self, token: Token, span: Span) -> Step<Argument> {
        let (name, first) = match token {
            Token::Name(name) if !is_word(&name) => {
                self.mark('=')?;
                (name, self.need("a value")?)
            }
            token => (String::new(), (token, span)),
        };
        let (value, end) = self.value(first)?;
        Ok(Argument { name, value, span: span.to(end) })
    }

    /// A value after its first token. Nested lists use an explicit stack.
    fn value(&mut self, (mut token, mut span): (Token, Span)) -> Step<(Value, Span)> {
        let mut lists: Vec<Vec<Value>> = Vec::new();
        loop {
            let mut value = match token {
                Token::Mark('[') => {
                    if lists.len() == DEEPEST_LIST {
                        let reason = format!("lists may be nested at most {DEEPEST_LIST} deep");
                        return Err(self.problem("this list is nested too deeply", &reason, span));
                    }
                    lists.push(Vec::new());
                    (token, span) = self.need("`]`")?;
                    if token != Token::Mark(']') {
                        continue;
                    }
                    Value::List(lists.pop().unwrap_or_default())
                }
                token => self.scalar(token, span)?,
            };
            // a complete value may also complete the lists around it
            loop {
                let Some(list) = lists.last_mut() else {
                    return Ok((value, span));
                };
                list.push(value);
                match self.need("`]`")? {
                    (Token::Mark(','), _) => break,
                    (Token::Mark(']'), end) => {
                        span = end;
                        value = Value::List(lists.pop().unwrap_or_default());
                    }
                    (_, span) => return Err(self.unexpected("`,` or `]`", span)),
                }
            }
            (token, span) = self.need("a value")?;
        }
    }

    /// A value other than a list.
    fn scalar(&mut self, token: Token, span: Span) -> Step<Value> {
        self.values += 1;
        if self.values > MAX_VALUES {
            let reason = format!("at most {MAX_VALUES} can be read");
            return Err(self.problem("there are too many values", &reason, span));
        }
        match token {
            Token::Text(text) => Ok(Value::Text(text)),
            Token::Name(name) => match name.as_str() {
                "true" | "false" => Ok(Value::Boolean(name == "true")),
                "undef" => Ok(Value::Undefined),
                "inf" => Ok(Value::Number(f64::INFINITY)),
                "nan" => Ok(Value::Number(f64::NAN)),
                _ => Err(self.unexpected("a value", span)),
            },
            Token::Mark(sign @ ('-' | '+')) => self.signed(sign),
            Token::Number(number) => Ok(Value::Number(self.in_range(number, span))),
            _ => Err(self.unexpected("a value", span)),
        }
    }

    fn signed(&mut self, sign: char) -> Step<Value> {
        let factor = if sign == '-' { -1.0 } else { 1.0 };
        match self.need("a number")? {
            (Token::Number(number), span) => Ok(Value::Number(factor * self.in_range(number, span))),
            (Token::Name(name), _) if name == "inf" => Ok(Value::Number(factor * f64::INFINITY)),
            (Token::Name(name), _) if name == "nan" => Ok(Value::Number(f64::NAN)),
            (_, span) => Err(self.unexpected("a number", span)),
        }
    }

    /// The number; a problem is recorded if it is out of range.
    fn in_range(&mut self, number: f64, span: Span) -> f64 {
        if !number.is_finite() {
            let found = self.source.slice(span).to_owned();
            let reason = "numbers are less than 1.8e308 in magnitude";
            self.problems.push(*self.problem(format!("`{found}` is too large"), reason, span));
        }
        number
    }
}

/// True for names that are values.
fn is_word(name: &str) -> bool {
    ["true", "false", "undef", "inf", "nan"].contains(&name)
}
