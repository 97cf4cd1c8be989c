//! Parser and printer of boolean expressions over the names of solids: `"slab - (hole1 | hole2)"`.
//!
//! Operators with Python's precedence, from weak to strong: `|` union, `^` symmetric difference,
//! `&` intersection, `-` difference, `~` complement. A chain of equal `|`, `^` or `&` is one
//! operation with many operands. Grouping is preserved: a printed expression parses to the same
//! tree, without redundant parentheses. `union(a, b, ..)`, `intersection(..)` and `symmetric_difference(..)` take any
//! number of operands. `empty` is the empty solid, `universe` is all of space. Names with characters
//! other than letters, digits and `_`, or that begin with a digit, are quoted: `'front lens'`.

use crate::fault::Fault;
use crate::source::Span;
use crate::suggestion::did_you_mean;
use crate::syntax::{Associativity, Grammar, ItemKind, is_plain_name, parse};
use std::fmt::Write;

static GRAMMAR: Grammar = Grammar {
    infix: |symbol| {
        Some(match symbol {
            "|" => (Operator::Union.power(), Associativity::Chain),
            "^" => (Operator::SymmetricDifference.power(), Associativity::Chain),
            "&" => (Operator::Intersection.power(), Associativity::Chain),
            "-" => (Operator::Difference.power(), Associativity::Left),
            _ => return None,
        })
    },
    prefix: |symbol| (symbol == "~").then_some(Operator::Complement.power()),
    operand: "the name of a solid",
    operators: "| (union), & (intersection), - (difference), ^ (symmetric difference) and ~ (complement)",
};

/// A boolean operation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    /// Inside at least one operand; any number of operands.
    Union,
    /// Inside an odd number of operands; any number of operands.
    SymmetricDifference,
    /// Inside all operands; any number of operands.
    Intersection,
    /// Inside the first operand and not the second.
    Difference,
    /// Outside the operand.
    Complement,
}

impl Operator {
    fn power(self) -> u8 {
        match self {
            Operator::Union => 1,
            Operator::SymmetricDifference => 2,
            Operator::Intersection => 3,
            Operator::Difference => 4,
            Operator::Complement => 5,
        }
    }

    fn symbol(self) -> &'static str {
        match self {
            Operator::Union => " | ",
            Operator::SymmetricDifference => " ^ ",
            Operator::Intersection => " & ",
            Operator::Difference => " - ",
            Operator::Complement => "~",
        }
    }

    fn function(self) -> &'static str {
        match self {
            Operator::Union => "union",
            Operator::SymmetricDifference => "symmetric_difference",
            Operator::Intersection => "intersection",
            Operator::Difference | Operator::Complement => "",
        }
    }
}

const FUNCTIONS: [Operator; 3] = [Operator::Union, Operator::Intersection, Operator::SymmetricDifference];

/// True for a word of the grammar of expressions, which is not allowed as the name of a solid.
pub(crate) fn is_reserved(name: &str) -> bool {
    matches!(name, "empty" | "universe")
}

/// One item of an expression in postfix order.
#[derive(Clone, Debug, PartialEq)]
pub enum ExpressionItem {
    /// A solid by its name.
    Name(String),
    /// The empty solid.
    Empty,
    /// All of space.
    Universe,
    /// An operation and the number of values before it that are its operands.
    Operation(Operator, usize),
}

impl ExpressionItem {
    /// Number of values that the operation consumes.
    pub fn arity(&self) -> usize {
        match self {
            ExpressionItem::Operation(_, count) => *count,
            _ => 0,
        }
    }
}

/// A boolean expression over names, in postfix order.
///
/// Equality compares the terms and ignores their spans.
#[derive(Clone, Debug, Default)]
pub struct Expression {
    terms: Vec<ExpressionItem>,
    spans: Vec<Span>,
}

impl PartialEq for Expression {
    fn eq(&self, other: &Expression) -> bool {
        self.terms == other.terms
    }
}

impl Expression {
    /// Parses an expression. A syntax error is reported alone; otherwise all unknown functions and misplaced numbers
    /// are reported together.
    pub(crate) fn parse(text: &str) -> Result<Expression, Vec<Fault>> {
        let items = parse(text, &GRAMMAR).map_err(|fault| vec![fault])?;
        let mut expression = Expression::default();
        let mut faults = Vec::new();
        for item in items {
            match term(item.kind, text, item.span) {
                Ok(term) => expression.push(term, item.span),
                Err(fault) => faults.push(fault),
            }
        }
        if faults.is_empty() { Ok(expression) } else { Err(faults) }
    }

    /// Appends a term; the operands of an operation must precede it.
    pub(crate) fn push(&mut self, term: ExpressionItem, span: Span) {
        self.terms.push(term);
        self.spans.push(span);
    }

    /// The terms in postfix order, with their spans in the text.
    pub fn terms(&self) -> impl Iterator<Item = (&ExpressionItem, Span)> {
        self.terms.iter().zip(self.spans.iter().copied())
    }

    /// The names in the expression, once per occurrence.
    pub fn names(&self) -> impl Iterator<Item = (&str, Span)> {
        self.terms().filter_map(|(term, span)| match term {
            ExpressionItem::Name(name) => Some((name.as_str(), span)),
            _ => None,
        })
    }

    /// The operands of each operation, as indices of terms.
    fn operands(&self) -> Vec<Vec<usize>> {
        let mut stack = Vec::new();
        let mut operands = Vec::with_capacity(self.terms.len());
        for (index, term) in self.terms.iter().enumerate() {
            operands.push(stack.split_off(stack.len() - term.arity()));
            stack.push(index);
        }
        operands
    }
}

/// Prints with the fewest parentheses that preserve the tree.
impl std::fmt::Display for Expression {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.terms.is_empty() {
            return Ok(());
        }
        let operands = self.operands();
        let mut waiting = vec![Piece::Term(self.terms.len() - 1, 0)];
        while let Some(piece) = waiting.pop() {
            match piece {
                Piece::Text(text) => f.write_str(text)?,
                Piece::Term(index, power) => match &self.terms[index] {
                    ExpressionItem::Empty => f.write_str("empty")?,
                    ExpressionItem::Universe => f.write_str("universe")?,
                    ExpressionItem::Name(name) => write_name(f, name)?,
                    ExpressionItem::Operation(operator, _) => {
                        push_pieces(&mut waiting, *operator, &operands[index], power)
                    }
                },
            }
        }
        Ok(())
    }
}

/// Terms that remain to be printed.
enum Piece {
    Text(&'static str),
    /// A term in a context that requires operators of a higher precedence than this.
    Term(usize, u8),
}

/// Puts the pieces of an operation onto the stack, last first.
fn push_pieces(waiting: &mut Vec<Piece>, operator: Operator, operands: &[usize], power: u8) {
    let own = operator.power();
    let called = operator != Operator::Complement && operands.len() < 2;
    let enclosed = called || own <= power;
    if enclosed {
        waiting.push(Piece::Text(")"));
    }
    for (place, &operand) in operands.iter().enumerate().rev() {
        let needed = match operator {
            _ if called => 0,
            // ~~a and a - b - c need no parentheses
            Operator::Complement => own - 1,
            Operator::Difference if place == 0 => own - 1,
            _ => own,
        };
        waiting.push(Piece::Term(operand, needed));
        if place > 0 {
            waiting.push(Piece::Text(operator.symbol()));
        }
    }
    if operator == Operator::Complement {
        waiting.push(Piece::Text(operator.symbol()));
    }
    if enclosed {
        waiting.push(Piece::Text("("));
    }
    if called {
        waiting.push(Piece::Text(operator.function()));
    }
}

fn write_name(f: &mut std::fmt::Formatter<'_>, name: &str) -> std::fmt::Result {
    if is_plain_name(name) && !is_reserved(name) {
        return f.write_str(name);
    }
    f.write_char('\'')?;
    f.write_str(&name.replace('\'', "''"))?;
    f.write_char('\'')
}

fn term(kind: ItemKind, text: &str, span: Span) -> Result<ExpressionItem, Fault> {
    Ok(match kind {
        ItemKind::Number(_) => {
            let problem = format!("`{}` is not the name of a solid", &text[span.range()]);
            let reason = "names that begin with a digit or contain a `-` must be quoted";
            return Err(Fault::new(span, problem, reason));
        }
        // in quotation marks, it is a name
        ItemKind::Name(_) if &text[span.range()] == "empty" => ExpressionItem::Empty,
        ItemKind::Name(_) if &text[span.range()] == "universe" => ExpressionItem::Universe,
        ItemKind::Name(name) => ExpressionItem::Name(name.into_owned()),
        ItemKind::Prefix(_) => ExpressionItem::Operation(Operator::Complement, 1),
        ItemKind::Infix("|", count) => ExpressionItem::Operation(Operator::Union, count),
        ItemKind::Infix("&", count) => ExpressionItem::Operation(Operator::Intersection, count),
        ItemKind::Infix("^", count) => ExpressionItem::Operation(Operator::SymmetricDifference, count),
        ItemKind::Infix(..) => ExpressionItem::Operation(Operator::Difference, 2),
        ItemKind::Call(name, count) => call(name, count, span)?,
    })
}

fn call(name: &str, count: usize, span: Span) -> Result<ExpressionItem, Fault> {
    if let Some(operator) = FUNCTIONS.iter().find(|operator| operator.function() == name) {
        return Ok(ExpressionItem::Operation(*operator, count));
    }
    let names = FUNCTIONS.map(Operator::function);
    let problem = format!("unknown function `{name}`");
    let reason = format!("the functions of solids are {}", names.join(", "));
    let span = Span::new(span.start(), span.start() + name.len());
    let suggestion = match name {
        "difference" | "subtract" | "minus" | "cut" => Some("Write `a - b`.".to_owned()),
        "complement" | "not" | "invert" => Some("Write `~a`.".to_owned()),
        _ => did_you_mean(name, names),
    };
    Err(Fault::new(span, problem, reason).suggest(suggestion))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The tree with all its parentheses, from an independent recursive printer.
    fn tree(expression: &Expression) -> String {
        let mut stack: Vec<String> = Vec::new();
        for (term, _) in expression.terms() {
            let arguments = stack.split_off(stack.len() - term.arity());
            stack.push(match term {
                ExpressionItem::Name(name) => name.clone(),
                ExpressionItem::Empty => "0".to_owned(),
                ExpressionItem::Universe => "1".to_owned(),
                ExpressionItem::Operation(operator, _) => format!("{operator:?}[{}]", arguments.join(" ")),
            });
        }
        assert_eq!(stack.len(), 1);
        let short = stack.remove(0).replace("Union", "or").replace("SymmetricDifference", "xor");
        short.replace("Intersection", "and").replace("Difference", "minus").replace("Complement", "not")
    }

    fn check(text: &str, expected: &str) {
        let expression = Expression::parse(text).unwrap_or_else(|faults| panic!("{text}: {faults:?}"));
        assert_eq!(tree(&expression), expected, "{text}");
        let printed = expression.to_string();
        assert_eq!(Expression::parse(&printed).unwrap(), expression, "{text} printed as {printed}");
    }

    fn check_print(text: &str, expected: &str) {
        assert_eq!(Expression::parse(text).unwrap().to_string(), expected);
    }

    fn check_fault(text: &str, span: (usize, usize), message: &str) {
        let fault = Expression::parse(text).unwrap_err().remove(0);
        let suggestion =
            fault.suggestion.map(|s| format!(" {}{}", s[..1].to_uppercase(), &s[1..])).unwrap_or_default();
        assert_eq!(format!("{}: {}.{suggestion}", fault.problem, fault.reason), message, "{text}");
        assert_eq!(fault.span, Span::new(span.0, span.1), "{text}");
    }

    #[test]
    fn precedence_is_that_of_python() {
        check("a", "a");
        check("a | b & c", "or[a and[b c]]");
        check("a & b | c", "or[and[a b] c]");
        check("a ^ b & c | d", "or[xor[a and[b c]] d]");
        check("a & b - c", "and[a minus[b c]]");
        check("a - b - c", "minus[minus[a b] c]");
        check("a - (b - c)", "minus[a minus[b c]]");
        check("~a - b", "minus[not[a] b]");
        check("~(a - b)", "not[minus[a b]]");
        check("~~a", "not[not[a]]");
        check("a - ~b", "minus[a not[b]]");
        check("front & back & rim", "and[front back rim]");
        check("slab - (hole1 | hole2)", "minus[slab or[hole1 hole2]]");
    }

    #[test]
    fn chains_are_flat_and_parentheses_are_kept() {
        check("a | b | c | d", "or[a b c d]");
        check("(a | b) | c", "or[or[a b] c]");
        check("a | (b | c)", "or[a or[b c]]");
        check("a ^ b ^ c", "xor[a b c]");
        check("a | b & c & d | e", "or[a and[b c d] e]");
    }

    #[test]
    fn functions_and_constants() {
        check("union(a, b, c)", "or[a b c]");
        check("union(a)", "or[a]");
        check("union()", "or[]");
        check("intersection( )", "and[]");
        check("symmetric_difference(a, b) | c", "or[xor[a b] c]");
        check("empty | universe", "or[0 1]");
        check("union(a | b, c - d)", "or[or[a b] minus[c d]]");
        check("~union(a)", "not[or[a]]");
        check("union", "union");
    }

    #[test]
    fn quoted_names() {
        check("'front lens' & 'it''s'", "and[front lens it's]");
        check("'empty'", "empty");
        check("'hole-1' | h\u{f6}he2", "or[hole-1 h\u{f6}he2]");
    }

    #[test]
    fn printing_uses_few_parentheses() {
        check_print("((a)|(b&c))", "a | b & c");
        check_print("(a - b) - c", "a - b - c");
        check_print("~(~(a))", "~~a");
        check_print("(a | b) & c", "(a | b) & c");
        check_print("union(a,b)", "a | b");
        check_print("union(union())", "union(union())");
        check_print("intersection(a | b) - c", "intersection(a | b) - c");
        check_print("'x y' & 'z'", "'x y' & z");
    }

    #[test]
    fn faults() {
        check_fault("a &", (3, 3), "the expression ends too early: the name of a solid is missing.");
        check_fault(
            "a b",
            (2, 3),
            "an operator is missing before this: the operators are | (union), & (intersection), - (difference), ^ (symmetric difference) and ~ (complement).",
        );
        check_fault("a & | b", (4, 5), "unexpected `|`: the name of a solid is missing before it.");
        check_fault(
            "a + b",
            (2, 3),
            "unexpected operator `+`: the operators are | (union), & (intersection), - (difference), ^ (symmetric difference) and ~ (complement).",
        );
        check_fault(
            "a ~ b",
            (2, 3),
            "unexpected operator `~`: it takes one operand and cannot stand between two.",
        );
        check_fault("!a", (0, 1), "unexpected character `!`: it has no meaning here. Did you mean `~`?");
        check_fault("(a | b", (0, 1), "unmatched `(`: there is no `)` after it.");
        check_fault("'a", (0, 2), "the quoted name is not terminated: the closing `'` is missing.");
        check_fault(
            "difference(a, b)",
            (0, 10),
            "unknown function `difference`: the functions of solids are union, intersection, symmetric_difference. Write `a - b`.",
        );
        check_fault(
            "unoin(a)",
            (0, 5),
            "unknown function `unoin`: the functions of solids are union, intersection, symmetric_difference. Did you mean `union`?",
        );
        check_fault(
            "hole-1",
            (5, 6),
            "`1` is not the name of a solid: names that begin with a digit or contain a `-` must be quoted.",
        );
    }

    #[test]
    fn depth_costs_no_call_stack() {
        let deep = || {
            let n = 100_000;
            let texts = [
                format!("{}a{}", "(".repeat(n), ")".repeat(n)),
                format!("{}a{}", "(b | ".repeat(n), ")".repeat(n)),
                format!("{}a{}", "union(b, ".repeat(n), ")".repeat(n)),
                format!("{}a{}", "(".repeat(n), " & b)".repeat(n)),
                format!("{}a", "~".repeat(n)),
                format!("a{}", " - b".repeat(n)),
                format!("a{}", " | b".repeat(n)),
            ];
            for text in texts {
                let expression = Expression::parse(&text).unwrap();
                assert_eq!(Expression::parse(&expression.to_string()).unwrap(), expression);
            }
        };
        let thread = std::thread::Builder::new().stack_size(256 * 1024).spawn(deep);
        thread.unwrap().join().unwrap();
    }
}
