//! Non-recursive parser of infix expressions, shared by arithmetic and boolean expressions.
//!
//! The parser converts the text to postfix order by operator precedence (Dijkstra's shunting yard;
//! E. W. Dijkstra, "Algol 60 translation", MR 34/61, Mathematisch Centrum, 1961), with an explicit
//! stack: nesting takes heap memory instead of call stack, and the time is linear.

use crate::fault::Fault;
use crate::source::Span;
use crate::unit::Unit;
use std::borrow::Cow;

/// Associativity of operators of equal precedence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Associativity {
    /// a - b - c is (a - b) - c.
    Left,
    /// a ^ b ^ c is a ^ (b ^ c).
    Right,
    /// a | b | c is one operation with three operands.
    Chain,
}

/// The operators of a language, and descriptions for messages.
pub(crate) struct Grammar {
    /// Binding power and associativity of an infix operator.
    pub infix: fn(&str) -> Option<(u8, Associativity)>,
    /// Binding power of a prefix operator.
    pub prefix: fn(&str) -> Option<u8>,
    /// The kinds of operands, for messages.
    pub operand: &'static str,
    /// The operators, for messages.
    pub operators: &'static str,
}

/// One item of postfix text.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Item<'a> {
    pub kind: ItemKind<'a>,
    pub span: Span,
}

/// Effect of an item on the stack of values.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum ItemKind<'a> {
    /// Pushes a number.
    Number(f64),
    /// Pushes the value of a name.
    Name(Cow<'a, str>),
    /// Replaces the last value.
    Prefix(&'a str),
    /// Replaces the last `n` values, n >= 2.
    Infix(&'a str, usize),
    /// Replaces the last `n` values, n >= 0.
    Call(&'a str, usize),
}

/// True for the symbol of a unit.
fn is_unit(name: &str) -> bool {
    Unit::parse(name).is_some() || ["inch", "deg", "rad"].contains(&name)
}

/// Parses a complete text.
pub(crate) fn parse<'a>(text: &'a str, grammar: &Grammar) -> Result<Vec<Item<'a>>, Fault> {
    let mut yard = Yard { grammar, output: Vec::new(), waiting: Vec::new(), want_operand: true };
    let mut lexer = Lexer { text, at: 0 };
    while let Some((token, span)) = lexer.next()? {
        yard.push(token, span)?;
    }
    yard.finish(Span::new(text.len(), text.len()))
}

/// True for a name that needs no quotation marks.
pub(crate) fn is_plain_name(text: &str) -> bool {
    let mut chars = text.chars();
    chars.next().is_some_and(starts_name) && chars.all(continues_name)
}

fn starts_name(c: char) -> bool {
    c == '_' || c.is_alphabetic()
}

fn continues_name(c: char) -> bool {
    c == '_' || c.is_alphanumeric()
}

#[derive(Clone, Debug, PartialEq)]
enum Token<'a> {
    Number(f64),
    Name(Cow<'a, str>),
    /// A name followed by an opening parenthesis.
    Call(&'a str),
    Symbol(&'a str),
}

struct Lexer<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Lexer<'a> {
    fn next(&mut self) -> Result<Option<(Token<'a>, Span)>, Fault> {
        self.skip_blanks();
        let start = self.at;
        let Some(first) = self.rest().chars().next() else {
            return Ok(None);
        };
        let token = match first {
            '0'..='9' | '.' => self.number()?,
            '\'' => self.quoted()?,
            c if starts_name(c) => self.name(),
            '*' if self.rest().starts_with("**") => self.symbol(2),
            '+' | '-' | '*' | '/' | '^' | '(' | ')' | ',' | '|' | '&' | '~' => self.symbol(1),
            other => return Err(unknown_character(other, start)),
        };
        Ok(Some((token, Span::new(start, self.at))))
    }

    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn skip_blanks(&mut self) {
        self.take_while(char::is_whitespace);
    }

    fn name(&mut self) -> Token<'a> {
        let name = self.take_while(continues_name);
        let end = self.at;
        self.skip_blanks();
        if self.rest().starts_with('(') {
            self.at += 1;
            return Token::Call(name);
        }
        self.at = end;
        Token::Name(name.into())
    }

    fn symbol(&mut self, length: usize) -> Token<'a> {
        let symbol = &self.rest()[..length];
        self.at += length;
        Token::Symbol(symbol)
    }

    fn take_while(&mut self, wanted: impl Fn(char) -> bool) -> &'a str {
        let rest = self.rest();
        let length = rest.find(|c| !wanted(c)).unwrap_or(rest.len());
        self.at += length;
        &rest[..length]
    }

    fn number(&mut self) -> Result<Token<'a>, Fault> {
        let start = self.at;
        self.take_while(|c| c.is_ascii_digit() || c == '.');
        let digits = self.at;
        if self.rest().starts_with(['e', 'E']) {
            self.at += 1;
            self.at += usize::from(self.rest().starts_with(['+', '-']));
            if self.take_while(|c| c.is_ascii_digit()).is_empty() {
                self.at = digits;
            }
        }
        let text = &self.text[start..self.at];
        match text.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok(Token::Number(number)),
            _ => Err(bad_number(text, Span::new(start, self.at))),
        }
    }

    /// A quoted name; two quotation marks inside it stand for one.
    fn quoted(&mut self) -> Result<Token<'a>, Fault> {
        let start = self.at;
        self.at += 1;
        let mut name = String::new();
        loop {
            name += self.take_while(|c| c != '\'');
            if self.rest().starts_with("''") {
                name.push('\'');
                self.at += 2;
            } else if self.rest().starts_with('\'') {
                self.at += 1;
                return Ok(Token::Name(name.into()));
            } else {
                let span = Span::new(start, self.at);
                return Err(Fault::new(
                    span,
                    "the quoted name is not terminated",
                    "the closing `'` is missing",
                ));
            }
        }
    }
}

fn unknown_character(character: char, at: usize) -> Fault {
    let span = Span::new(at, at + character.len_utf8());
    let problem = format!("unexpected character `{}`", character.escape_debug());
    let suggestion = match character {
        '\u{222a}' => Some("Did you mean `|`?"),
        '\u{2229}' => Some("Did you mean `&`?"),
        '\u{2212}' | '\u{2013}' | '\\' => Some("Did you mean `-`?"),
        '\u{d7}' | '\u{b7}' => Some("Did you mean `*`?"),
        '!' => Some("Did you mean `~`?"),
        '[' | '{' => Some("Did you mean `(`?"),
        ']' | '}' => Some("Did you mean `)`?"),
        _ => None,
    };
    Fault::new(span, problem, "it has no meaning here").suggest(suggestion.map(str::to_owned))
}

fn bad_number(text: &str, span: Span) -> Fault {
    let reason = if text.matches('.').count() > 1 {
        "it has more than one decimal point"
    } else if text == "." {
        "it has no digits"
    } else {
        "it is too large for a 64-bit float"
    };
    Fault::new(span, format!("`{text}` is not a number"), reason)
}

/// Operators whose last operand is not complete.
enum Waiting<'a> {
    Prefix(&'a str, u8, Span),
    Infix(&'a str, u8, Associativity, usize, Span),
    /// An open parenthesis.
    Group(Span),
    /// An open parenthesis after a function's name, with the number of complete arguments.
    Call(&'a str, usize, Span),
}

struct Yard<'a, 'g> {
    grammar: &'g Grammar,
    output: Vec<Item<'a>>,
    waiting: Vec<Waiting<'a>>,
    want_operand: bool,
}

impl<'a> Yard<'a, '_> {
    fn push(&mut self, token: Token<'a>, span: Span) -> Result<(), Fault> {
        match token {
            Token::Number(number) => self.operand(ItemKind::Number(number), span),
            Token::Name(name) => self.operand(ItemKind::Name(name), span),
            Token::Call(name) => self.open(Waiting::Call(name, 0, span), span),
            Token::Symbol("(") => self.open(Waiting::Group(span), span),
            Token::Symbol(")") => self.close(span),
            Token::Symbol(",") => self.comma(span),
            Token::Symbol(symbol) if self.want_operand => self.prefix(symbol, span),
            Token::Symbol(symbol) => self.infix(symbol, span),
        }
    }

    fn operand(&mut self, kind: ItemKind<'a>, span: Span) -> Result<(), Fault> {
        if !self.want_operand {
            return Err(match (&kind, self.output.last().map(|last| &last.kind)) {
                (ItemKind::Name(name), Some(ItemKind::Number(number))) if is_unit(name) => {
                    let reason =
                        "numbers have no unit; lengths are in the unit of the model, angles in degrees";
                    let advice =
                        format!("Write {number}, or {number} * {name} for a product with a parameter");
                    Fault::new(span, format!("`{name}` follows a number"), reason).suggest(Some(advice))
                }
                _ => self.missing_operator(span),
            });
        }
        self.output.push(Item { kind, span });
        self.want_operand = false;
        Ok(())
    }

    fn open(&mut self, waiting: Waiting<'a>, span: Span) -> Result<(), Fault> {
        if !self.want_operand {
            return Err(self.missing_operator(span));
        }
        self.waiting.push(waiting);
        Ok(())
    }

    fn comma(&mut self, span: Span) -> Result<(), Fault> {
        self.need_operand_before(span, ",")?;
        self.reduce(0, false);
        match self.waiting.last_mut() {
            Some(Waiting::Call(_, arguments, _)) => *arguments += 1,
            _ => return Err(Fault::new(span, "unexpected `,`", "it separates the arguments of a function")),
        }
        self.want_operand = true;
        Ok(())
    }

    fn close(&mut self, span: Span) -> Result<(), Fault> {
        if let (true, Some(&Waiting::Call(name, 0, start))) = (self.want_operand, self.waiting.last()) {
            self.waiting.pop();
            self.call(name, 0, start.to(span));
            return Ok(());
        }
        self.need_operand_before(span, ")")?;
        self.reduce(0, false);
        match self.waiting.pop() {
            Some(Waiting::Group(_)) => {}
            Some(Waiting::Call(name, arguments, start)) => self.call(name, arguments + 1, start.to(span)),
            _ => return Err(Fault::new(span, "unmatched `)`", "there is no `(` before it")),
        }
        Ok(())
    }

    fn call(&mut self, name: &'a str, arguments: usize, span: Span) {
        let kind = ItemKind::Call(name, arguments);
        self.output.push(Item { kind, span });
        self.want_operand = false;
    }

    fn prefix(&mut self, symbol: &'a str, span: Span) -> Result<(), Fault> {
        match (self.grammar.prefix)(symbol) {
            Some(power) => self.waiting.push(Waiting::Prefix(symbol, power, span)),
            None => return Err(self.missing_operand(span, symbol)),
        }
        Ok(())
    }

    fn infix(&mut self, symbol: &'a str, span: Span) -> Result<(), Fault> {
        let Some((power, associativity)) = (self.grammar.infix)(symbol) else {
            let reason = match (self.grammar.prefix)(symbol) {
                Some(_) => "it takes one operand and cannot stand between two".to_owned(),
                None => format!("the operators are {}", self.grammar.operators),
            };
            return Err(Fault::new(span, format!("unexpected operator `{symbol}`"), reason));
        };
        self.want_operand = true;
        self.reduce(power, associativity == Associativity::Left);
        match self.waiting.last_mut() {
            Some(Waiting::Infix(same, _, Associativity::Chain, count, _)) if *same == symbol => *count += 1,
            _ => self.waiting.push(Waiting::Infix(symbol, power, associativity, 2, span)),
        }
        Ok(())
    }

    /// Moves the operators that bind more strongly than `power` (or as strongly, if `or_equal`) to the output, up to
    /// the innermost open parenthesis.
    fn reduce(&mut self, power: u8, or_equal: bool) {
        loop {
            let (item, own) = match self.waiting.last() {
                Some(&Waiting::Prefix(symbol, own, span)) => {
                    (Item { kind: ItemKind::Prefix(symbol), span }, own)
                }
                Some(&Waiting::Infix(symbol, own, _, count, span)) => {
                    let kind = ItemKind::Infix(symbol, count);
                    (Item { kind, span }, own)
                }
                _ => return,
            };
            if own < power || (own == power && !or_equal) {
                return;
            }
            self.output.push(item);
            self.waiting.pop();
        }
    }

    fn finish(mut self, end: Span) -> Result<Vec<Item<'a>>, Fault> {
        if self.want_operand {
            let problem = match self.output.is_empty() && self.waiting.is_empty() {
                true => "the text is empty",
                false => "the expression ends too early",
            };
            return Err(Fault::new(end, problem, format!("{} is missing", self.grammar.operand)));
        }
        self.reduce(0, false);
        match self.waiting.last() {
            Some(&(Waiting::Group(span) | Waiting::Call(_, _, span))) => {
                Err(Fault::new(span, "unmatched `(`", "there is no `)` after it"))
            }
            _ => Ok(self.output),
        }
    }

    fn need_operand_before(&self, span: Span, symbol: &str) -> Result<(), Fault> {
        match self.want_operand {
            true => Err(self.missing_operand(span, symbol)),
            false => Ok(()),
        }
    }

    fn missing_operand(&self, span: Span, symbol: &str) -> Fault {
        let reason = format!("{} is missing before it", self.grammar.operand);
        Fault::new(span, format!("unexpected `{symbol}`"), reason)
    }

    fn missing_operator(&self, span: Span) -> Fault {
        let reason = format!("the operators are {}", self.grammar.operators);
        Fault::new(span, "an operator is missing before this", reason)
    }
}
