//! Arithmetic expressions in attributes: numbers, names, units, functions and matrix elements.
//!
//! The language is that of the CLHEP evaluator, which Geant4 uses, with the constants and units that Geant4 sets
//! (millimetres, radians, MeV). Operators from weak to strong: `||`, `&&`, `== !=`, `< <= > >=`, `+ -`, `* /`, signs, and
//! `^` or `**`. All are left-associative, so `2^3^2` is 64, and `-2^2` is -4. Comparisons yield 1 or 0. `name[i, j]` is a
//! matrix element, with indices from 1.

use super::units;
use rayweave_scene::Span;
use std::collections::{BTreeMap, BTreeSet};

/// Maximal nesting depth of parentheses and signs.
const DEEPEST: usize = 200;

/// A problem with an expression, and the part of it that is wrong.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Fault {
    pub span: Span,
    pub problem: String,
    /// An undefined name, for a spelling suggestion.
    pub unknown: Option<String>,
}

/// Named numbers.
#[derive(Clone, Debug, Default)]
pub(super) struct Names {
    values: BTreeMap<String, f64>,
    matrices: BTreeMap<String, Matrix>,
    /// Names whose definition is invalid.
    failed: BTreeSet<String>,
}

/// A matrix of numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Matrix {
    pub columns: usize,
    pub values: Vec<f64>,
}

impl Matrix {
    /// An element by row and column, or by a single index in a matrix with one column or one row; indices start at 1.
    fn element(&self, indices: &[f64]) -> Option<f64> {
        let whole = |index: f64| (index.fract() == 0.0 && index >= 1.0).then_some(index as usize - 1);
        let rows = self.values.len() / self.columns;
        let (row, column) = match indices {
            [index] if self.columns == 1 => (whole(*index)?, 0),
            [index] if rows == 1 => (0, whole(*index)?),
            [row, column] => (whole(*row)?, whole(*column)?),
            _ => return None,
        };
        (column < self.columns).then(|| self.values.get(row * self.columns + column).copied()).flatten()
    }
}

impl Names {
    /// Value of a name: a variable of the file, a constant or a unit.
    pub fn value(&self, name: &str) -> Option<f64> {
        self.values.get(name).copied().or_else(|| units::value(name))
    }

    /// True if the file defines this name.
    pub fn is_set(&self, name: &str) -> bool {
        self.values.contains_key(name)
    }

    /// Defines a variable.
    pub fn set(&mut self, name: &str, value: f64) {
        self.values.insert(name.to_owned(), value);
    }

    /// Marks a name whose definition is invalid, and has been reported.
    pub fn set_failed(&mut self, name: &str) {
        self.failed.insert(name.to_owned());
    }

    /// True if the definition of a name is invalid.
    pub fn has_failed(&self, name: &str) -> bool {
        self.failed.contains(name)
    }

    pub fn set_matrix(&mut self, name: &str, matrix: Matrix) {
        self.matrices.insert(name.to_owned(), matrix);
    }

    pub fn matrix(&self, name: &str) -> Option<&Matrix> {
        self.matrices.get(name)
    }

    /// All matrices, by name.
    pub fn matrices(&self) -> impl Iterator<Item = (&String, &Matrix)> {
        self.matrices.iter()
    }

    /// All defined names.
    pub fn all(&self) -> impl Iterator<Item = &str> {
        let own = self.values.keys().chain(self.matrices.keys()).map(|name| name.as_str() as &str);
        let functions = FUNCTIONS.iter().map(|(name, _)| -> &str { name });
        own.chain(units::names().map(|name| -> &str { name })).chain(functions)
    }

    /// Value of an expression.
    pub fn evaluate(&self, text: &str) -> Result<f64, Fault> {
        let mut parser = Parser { names: self, text, at: 0, depth: 0 };
        let value = parser.binary(0)?;
        match parser.peek() {
            None => finite(value, text),
            Some(_) => Err(parser.unexpected("an operator")),
        }
    }

    /// Expands `[expression]` in a name, as used in loops: with i = 4, `pixel[i]` is `pixel_3`.
    pub fn expand(&self, name: &str) -> Result<String, Fault> {
        let Some((before, rest)) = name.split_once('[') else {
            return Ok(name.to_owned());
        };
        let base = before.len() + 1;
        let shifted = |fault: Fault, by: usize| Fault {
            span: Span::new(fault.span.start() + by, fault.span.end() + by),
            ..fault
        };
        let Some((inside, after)) = rest.split_once(']') else {
            return Err(Fault {
                span: Span::new(base - 1, name.len()),
                problem: "`[` without `]`".to_owned(),
                unknown: None,
            });
        };
        let (mut expanded, mut at) = (before.to_owned(), base);
        for index in inside.split(',') {
            let value = self.evaluate(index).map_err(|fault| shifted(fault, at))?;
            // Geant4 counts matrix elements from 1, but copies made in loops from 0
            expanded += &format!("_{}", (value as i64).saturating_sub(1));
            at += index.len() + 1;
        }
        let rest = self.expand(after).map_err(|fault| shifted(fault, base + inside.len() + 1))?;
        Ok(expanded + &rest)
    }
}

fn finite(value: f64, text: &str) -> Result<f64, Fault> {
    if value.is_finite() {
        return Ok(value);
    }
    let problem = format!("`{}` is not a finite number: the largest is about 1.8e308.", text.trim());
    Err(Fault { span: Span::new(0, text.len()), problem, unknown: None })
}

type Function = (usize, fn(&[f64]) -> f64);

/// Functions with their numbers of arguments.
static FUNCTIONS: [(&str, Function); 18] = [
    ("abs", (1, |a| a[0].abs())),
    ("min", (2, |a| a[0].min(a[1]))),
    ("max", (2, |a| a[0].max(a[1]))),
    ("sqrt", (1, |a| a[0].sqrt())),
    ("pow", (2, |a| libm::pow(a[0], a[1]))),
    ("sin", (1, |a| libm::sin(a[0]))),
    ("cos", (1, |a| libm::cos(a[0]))),
    ("tan", (1, |a| libm::tan(a[0]))),
    ("asin", (1, |a| libm::asin(a[0]))),
    ("acos", (1, |a| libm::acos(a[0]))),
    ("atan", (1, |a| libm::atan(a[0]))),
    ("atan2", (2, |a| libm::atan2(a[0], a[1]))),
    ("sinh", (1, |a| libm::sinh(a[0]))),
    ("cosh", (1, |a| libm::cosh(a[0]))),
    ("tanh", (1, |a| libm::tanh(a[0]))),
    ("exp", (1, |a| libm::exp(a[0]))),
    ("log", (1, |a| libm::log(a[0]))),
    ("log10", (1, |a| libm::log10(a[0]))),
];

/// An operator: symbol, precedence and function.
type Infix = (&'static str, u8, fn(f64, f64) -> f64);

/// The binary operators, longest symbol first.
const OPERATORS: [Infix; 14] = [
    ("||", 1, |a, b| boolean(a != 0.0 || b != 0.0)),
    ("&&", 2, |a, b| boolean(a != 0.0 && b != 0.0)),
    ("==", 3, |a, b| boolean(a == b)),
    ("!=", 3, |a, b| boolean(a != b)),
    ("<=", 4, |a, b| boolean(a <= b)),
    (">=", 4, |a, b| boolean(a >= b)),
    ("**", 8, libm::pow),
    ("<", 4, |a, b| boolean(a < b)),
    (">", 4, |a, b| boolean(a > b)),
    ("+", 5, |a, b| a + b),
    ("-", 5, |a, b| a - b),
    ("*", 6, |a, b| a * b),
    ("/", 6, |a, b| a / b),
    ("^", 8, libm::pow),
];

/// Precedence of a sign.
const SIGN: u8 = 7;

fn boolean(value: bool) -> f64 {
    f64::from(u8::from(value))
}

struct Parser<'a> {
    names: &'a Names,
    text: &'a str,
    at: usize,
    depth: usize,
}

impl<'a> Parser<'a> {
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    /// Consumes a symbol if it comes next.
    fn pass(&mut self, symbol: &str) -> bool {
        self.peek();
        let found = self.text[self.at..].starts_with(symbol);
        self.at += if found { symbol.len() } else { 0 };
        found
    }

    fn binary(&mut self, weakest: u8) -> Result<f64, Fault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.fault(self.at, format!("more than {DEEPEST} nested parentheses")));
        }
        let mut value = self.operand()?;
        while let Some((symbol, power, apply)) = self.operator().filter(|(_, power, _)| *power > weakest) {
            self.at += symbol.len();
            value = apply(value, self.binary(power)?);
        }
        self.depth -= 1;
        Ok(value)
    }

    fn operator(&mut self) -> Option<Infix> {
        self.peek();
        let rest = &self.text[self.at..];
        OPERATORS.into_iter().find(|(symbol, ..)| rest.starts_with(symbol))
    }

    fn operand(&mut self) -> Result<f64, Fault> {
        match self.peek() {
            Some('-') => {
                self.at += 1;
                Ok(-self.binary(SIGN)?)
            }
            Some('+') => {
                self.at += 1;
                self.binary(SIGN)
            }
            Some('(') => {
                self.at += 1;
                let value = self.binary(0)?;
                self.expect(')').map(|()| value)
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            _ => Err(self.unexpected("a number or a name")),
        }
    }

    fn expect(&mut self, symbol: char) -> Result<(), Fault> {
        match self.peek() == Some(symbol) {
            true => {
                self.at += 1;
                Ok(())
            }
            false => Err(self.unexpected(&format!("`{symbol}`"))),
        }
    }

    fn number(&mut self) -> Result<f64, Fault> {
        let start = self.at;
        let bytes = self.text.as_bytes();
        let digits = |mut at: usize| {
            while bytes.get(at).is_some_and(u8::is_ascii_digit) {
                at += 1;
            }
            at
        };
        let mut end = digits(start);
        if bytes.get(end) == Some(&b'.') {
            end = digits(end + 1);
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            let exponent = digits(end + 1 + sign);
            end = if exponent > end + 1 + sign { exponent } else { end };
        }
        self.at = end;
        let text = &self.text[start..end];
        let value: f64 = text.parse().map_err(|_| self.fault(start, format!("`{text}` is not a number")))?;
        match value.is_finite() {
            true => Ok(value),
            false => {
                Err(self.fault(start, format!("{text} is too large: the largest number is about 1.8e308.")))
            }
        }
    }

    fn name(&mut self) -> Result<f64, Fault> {
        let start = self.at;
        let rest = &self.text[start..];
        let length = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        self.at += length;
        let name = &rest[..length];
        match self.peek() {
            Some('(') => self.call(name, start),
            Some('[') => self.element(name, start),
            _ => self.names.value(name).ok_or_else(|| self.unknown(name, start, "name")),
        }
    }

    fn call(&mut self, name: &str, start: usize) -> Result<f64, Fault> {
        let function = FUNCTIONS.iter().find(|(own, _)| *own == name);
        let (_, (count, apply)) = *function.ok_or_else(|| self.unknown(name, start, "function"))?;
        let arguments = self.list(')')?;
        match arguments.len() == count {
            true => Ok(apply(&arguments)),
            false => {
                Err(self
                    .fault(start, format!("`{name}` has {} arguments: it takes {count}.", arguments.len())))
            }
        }
    }

    fn element(&mut self, name: &str, start: usize) -> Result<f64, Fault> {
        let matrix = self.names.matrix(name).ok_or_else(|| self.unknown(name, start, "matrix"))?;
        let indices = self.list(']')?;
        let rows = matrix.values.len() / matrix.columns;
        matrix.element(&indices).ok_or_else(|| {
            let size = format!("it has {rows} rows and {} columns, counted from 1", matrix.columns);
            self.fault(
                start,
                format!("`{}` is not an element of the matrix: {size}.", &self.text[start..self.at]),
            )
        })
    }

    /// Values from the current bracket to its closing bracket.
    fn list(&mut self, close: char) -> Result<Vec<f64>, Fault> {
        self.at += 1;
        let mut values = vec![self.binary(0)?];
        while self.pass(",") {
            values.push(self.binary(0)?);
        }
        self.expect(close).map(|()| values)
    }

    fn fault(&self, start: usize, problem: String) -> Fault {
        Fault { span: Span::new(start, self.at.max(start)), problem, unknown: None }
    }

    fn unknown(&self, name: &str, start: usize, what: &str) -> Fault {
        let reason = match what {
            "function" => {
                let all: Vec<&str> = FUNCTIONS.iter().map(|(name, _)| *name).collect();
                format!("the functions are {}.", all.join(", "))
            }
            "matrix" => "no matrix defined before has this name.".to_owned(),
            _ => "no constant, variable, quantity or matrix defined before has this name, and no unit."
                .to_owned(),
        };
        let problem = format!("unknown {what} `{name}`: {reason}");
        Fault { span: Span::new(start, start + name.len()), problem, unknown: Some(name.to_owned()) }
    }

    fn unexpected(&mut self, wanted: &str) -> Fault {
        let found = self.peek().map_or("the end of the expression".to_owned(), |c| format!("`{c}`"));
        let end = self.text[self.at..].chars().next().map_or(self.at, |c| self.at + c.len_utf8());
        Fault {
            span: Span::new(self.at, end),
            problem: format!("{found} where {wanted} is expected"),
            unknown: None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> f64 {
        let mut names = Names::default();
        names.set("R", 50.0);
        names.set_matrix("M", Matrix { columns: 2, values: vec![1.0, 2.0, 3.0, 4.0] });
        names.set_matrix("N", Matrix { columns: 1, values: vec![1.0, 20.0, 3.0] });
        names.evaluate(text).unwrap_or(f64::NAN)
    }

    /// Values computed by Geant4 11.4.1.
    #[test]
    fn expressions_have_the_values_that_geant4_gives() {
        let table = [
            ("2^3^2", 64.0),
            ("-2^2", -4.0),
            ("2*-3^2", -18.0),
            ("2^-2^2", 0.0625),
            ("1-2-3", -4.0),
            ("2**3", 8.0),
            ("7/2/2", 1.75),
            ("-3*-2", 6.0),
            ("2-+3", -1.0),
            ("3>2", 1.0),
            ("1==1 && 0", 0.0),
            ("3<2||1", 1.0),
            ("1+2*3==7", 1.0),
            ("sqrt(16)+abs(-3)", 7.0),
            ("pow(2,3)", 8.0),
            ("min(1,2)+max(1,2)", 3.0),
            ("M[2,1]", 3.0),
            ("N[2]", 20.0),
            ("2 ^ -1", 0.5),
            ("10*cm", 100.0),
            ("deg", 0.017453292519943295),
            ("1240*eV/1100", 1.127272727272727e-06),
            ("g/cm3", 6.241509074460762e+18),
            ("bar", 624150907.4460763),
            ("tesla", 0.0009999999999999998),
            ("atan2(1,1)", std::f64::consts::FRAC_PI_4),
            ("gamma", 0.5772156649015329),
        ];
        for (text, expected) in table {
            assert!(
                (value(text) - expected).abs() <= 4.0 * f64::EPSILON * expected.abs(),
                "{text}: {}",
                value(text)
            );
        }
    }

    #[test]
    fn faults_have_places() {
        let names = Names::default();
        let fault = |text: &str| {
            let fault = names.evaluate(text).unwrap_err();
            (fault.span.start(), fault.span.end(), fault.problem)
        };
        assert_eq!(fault("1 + 1e400").0, 4);
        assert_eq!(fault("2 * (3 + x)").0, 9);
        assert_eq!(fault("1.e+3mm"), (5, 6, "`m` where an operator is expected".to_owned()));
        assert_eq!(fault("(1 + 2"), (6, 6, "the end of the expression where `)` is expected".to_owned()));
        assert_eq!(fault("").2, "the end of the expression where a number or a name is expected");
        assert!(fault("1/0").2.starts_with("`1/0` is not a finite number"));
        assert!(fault(&"(".repeat(1_000_000)).2.starts_with("more than 200 nested parentheses"));
        assert!(fault("pow(2)").2.starts_with("`pow` has 1 arguments"));
        assert!(fault(".").2.starts_with("`.` is not a number"));
        assert!(fault("1 é").2.starts_with("`é`"));
    }

    #[test]
    fn names_in_loops_have_numbers() {
        let mut names = Names::default();
        names.set("i", 3.0);
        assert_eq!(names.expand("pixel[i]").unwrap(), "pixel_2");
        assert_eq!(names.expand("a[i+1,2]b[i]").unwrap(), "a_3_1b_2");
        assert_eq!(names.expand("plain").unwrap(), "plain");
        assert!(names.expand("a[-1e30]").unwrap().starts_with("a_-9"));
        assert!(names.expand("a[i").is_err());
        assert_eq!(names.expand("a[k]").unwrap_err().span.start(), 2);
    }
}
