//! Arithmetic expressions in model files, such as `"2 * R + 1"`.
//!
//! Operators, from weak to strong: `+ -`, `* /`, signs, `^` (or `**`, from right to left, so that
//! `-2 ^ 2` is -4). Functions: see [`FUNCTIONS`]; angles are in degrees, as everywhere in a model file.
//! Constants: `pi`, `tau`, `inf`. Names are parameters. Transcendental functions come from `libm`, so
//! results have the same bits on every platform.

use crate::fault::Fault;
use crate::number::written;
use crate::source::Span;
use crate::suggestion::did_you_mean;
use crate::syntax::{Associativity, Grammar, ItemKind, parse};
use std::f64::consts::{PI, TAU};

/// A function of arithmetic expressions.
pub struct Function {
    /// Its name.
    pub name: &'static str,
    /// The minimum and the maximum number of arguments.
    pub arity: (usize, usize),
    /// A description of its value.
    pub summary: &'static str,
    apply: fn(&[f64]) -> f64,
}

const MANY: usize = usize::MAX;

const fn function(
    name: &'static str,
    arity: (usize, usize),
    summary: &'static str,
    apply: fn(&[f64]) -> f64,
) -> Function {
    Function { name, arity, summary, apply }
}

/// The functions of arithmetic expressions.
pub static FUNCTIONS: &[Function] = &[
    function("sqrt", (1, 1), "the square root", |x| x[0].sqrt()),
    function("sin", (1, 1), "the sine of an angle in degrees", |x| rayweave_math::sin_cos_degrees(x[0]).0),
    function("cos", (1, 1), "the cosine of an angle in degrees", |x| rayweave_math::sin_cos_degrees(x[0]).1),
    function("tan", (1, 1), "the tangent of an angle in degrees", |x| tan_degrees(x[0])),
    function("asin", (1, 1), "the angle in degrees with this sine", |x| libm::asin(x[0]).to_degrees()),
    function("acos", (1, 1), "the angle in degrees with this cosine", |x| libm::acos(x[0]).to_degrees()),
    function("atan", (1, 1), "the angle in degrees with this tangent", |x| libm::atan(x[0]).to_degrees()),
    function("atan2", (2, 2), "the angle in degrees from +x to (x, y), given y, x", |x| {
        libm::atan2(x[0], x[1]).to_degrees()
    }),
    function("abs", (1, 1), "the absolute value", |x| x[0].abs()),
    function("min", (1, MANY), "the smallest", |x| x.iter().copied().fold(f64::INFINITY, f64::min)),
    function("max", (1, MANY), "the largest", |x| x.iter().copied().fold(f64::NEG_INFINITY, f64::max)),
    function("floor", (1, 1), "rounded down", |x| x[0].floor()),
    function("ceil", (1, 1), "rounded up", |x| x[0].ceil()),
    function("round", (1, 1), "the nearest integer, halves rounded away from 0", |x| x[0].round()),
    function("exp", (1, 1), "e to this power", |x| libm::exp(x[0])),
    function("ln", (1, 1), "the natural logarithm", |x| libm::log(x[0])),
    function("pow", (2, 2), "the first to the power of the second", |x| libm::pow(x[0], x[1])),
    function("hypot", (2, 2), "the length of the hypotenuse", |x| libm::hypot(x[0], x[1])),
];

/// The constants of arithmetic expressions.
pub static CONSTANTS: &[(&str, f64)] = &[("pi", PI), ("tau", TAU), ("inf", f64::INFINITY)];

fn tan_degrees(degrees: f64) -> f64 {
    let (sin, cos) = rayweave_math::sin_cos_degrees(degrees);
    sin / cos
}

static GRAMMAR: Grammar = Grammar {
    infix: |symbol| {
        Some(match symbol {
            "+" | "-" => (1, Associativity::Left),
            "*" | "/" => (2, Associativity::Left),
            "^" | "**" => (4, Associativity::Right),
            _ => return None,
        })
    },
    prefix: |symbol| matches!(symbol, "+" | "-").then_some(3),
    operand: "a number or a parameter",
    operators: "+ - * / ^",
};

#[derive(Clone, Debug, PartialEq)]
enum Operation {
    Number(f64),
    Parameter(String),
    Negate,
    Keep,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Call(usize, usize),
}

/// A parsed arithmetic expression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Arithmetic {
    operations: Vec<(Operation, Span)>,
}

impl Arithmetic {
    /// Parses an expression. All unknown functions and wrong numbers of arguments are reported at
    /// once.
    pub fn parse(text: &str) -> Result<Arithmetic, Vec<Fault>> {
        let items = parse(text, &GRAMMAR).map_err(|fault| vec![fault])?;
        let (mut operations, mut faults) = (Vec::with_capacity(items.len()), Vec::new());
        for item in items {
            match operation(item.kind, item.span) {
                Ok(operation) => operations.push((operation, item.span)),
                Err(fault) => faults.push(fault),
            }
        }
        if faults.is_empty() { Ok(Arithmetic { operations }) } else { Err(faults) }
    }

    /// The parameters in the expression, once per occurrence.
    pub fn names(&self) -> impl Iterator<Item = (&str, Span)> {
        self.operations.iter().filter_map(|(operation, span)| match operation {
            Operation::Parameter(name) => Some((name.as_str(), *span)),
            _ => None,
        })
    }

    /// Evaluates the expression with the given values of its parameters. Division by zero, a NaN
    /// result, and an infinite result of finite numbers are faults.
    pub fn evaluate(&self, parameter: impl Fn(&str) -> f64) -> Result<f64, Fault> {
        let mut stack = Vec::new();
        for (operation, span) in &self.operations {
            let arguments = stack.split_off(stack.len() - operation.arity());
            stack.push(operation.apply(&arguments, *span, &parameter)?);
        }
        Ok(stack[0])
    }
}

fn operation(kind: ItemKind, span: Span) -> Result<Operation, Fault> {
    Ok(match kind {
        ItemKind::Number(number) => Operation::Number(number),
        ItemKind::Name(name) => match CONSTANTS.iter().find(|(constant, _)| *constant == name) {
            Some(&(_, value)) => Operation::Number(value),
            None => Operation::Parameter(name.into_owned()),
        },
        ItemKind::Prefix("-") => Operation::Negate,
        ItemKind::Prefix(_) => Operation::Keep,
        ItemKind::Infix("+", _) => Operation::Add,
        ItemKind::Infix("-", _) => Operation::Subtract,
        ItemKind::Infix("*", _) => Operation::Multiply,
        ItemKind::Infix("/", _) => Operation::Divide,
        ItemKind::Infix(..) => Operation::Power,
        ItemKind::Call(name, count) => call(name, count, span)?,
    })
}

fn call(name: &str, count: usize, span: Span) -> Result<Operation, Fault> {
    let Some(index) = FUNCTIONS.iter().position(|function| function.name == name) else {
        let names: Vec<&str> = FUNCTIONS.iter().map(|function| function.name).collect();
        let reason = format!("the functions are {}", names.join(", "));
        let suggestion = did_you_mean(name, names);
        let span = Span::new(span.start(), span.start() + name.len());
        return Err(Fault::new(span, format!("unknown function `{name}`"), reason).suggest(suggestion));
    };
    let (least, most) = FUNCTIONS[index].arity;
    if (least..=most).contains(&count) {
        return Ok(Operation::Call(index, count));
    }
    let wanted = match (least, most) {
        (1, 1) => "1 argument".to_owned(),
        (least, MANY) => format!("at least {least} argument"),
        (least, _) => format!("{least} arguments"),
    };
    let problem = format!("`{name}` has {count} arguments");
    Err(Fault::new(span, problem, format!("it takes {wanted}")))
}

impl Operation {
    fn arity(&self) -> usize {
        match self {
            Operation::Number(_) | Operation::Parameter(_) => 0,
            Operation::Negate | Operation::Keep => 1,
            Operation::Add
            | Operation::Subtract
            | Operation::Multiply
            | Operation::Divide
            | Operation::Power => 2,
            Operation::Call(_, count) => *count,
        }
    }

    fn apply(&self, x: &[f64], span: Span, parameter: &impl Fn(&str) -> f64) -> Result<f64, Fault> {
        let value = match self {
            Operation::Number(number) => return Ok(*number),
            Operation::Parameter(name) => return Ok(parameter(name)),
            Operation::Negate => -x[0],
            Operation::Keep => x[0],
            Operation::Add => x[0] + x[1],
            Operation::Subtract => x[0] - x[1],
            Operation::Multiply => x[0] * x[1],
            Operation::Divide if x[1] == 0.0 => {
                let reason = format!("the divisor of {} / {} is zero", written(x[0]), written(x[1]));
                return Err(Fault::new(span, "division by zero", reason));
            }
            Operation::Divide => x[0] / x[1],
            Operation::Power => libm::pow(x[0], x[1]),
            Operation::Call(index, _) => (FUNCTIONS[*index].apply)(x),
        };
        self.checked(value, x, span)
    }

    fn checked(&self, value: f64, x: &[f64], span: Span) -> Result<f64, Fault> {
        if value.is_nan() {
            let reason = format!("{} has no value", self.with_arguments(x));
            return Err(Fault::new(span, "the result is not a number", reason));
        }
        if value.is_infinite() && x.iter().all(|x| x.is_finite()) {
            let reason = format!("{} is beyond the range of a 64-bit float", self.with_arguments(x));
            return Err(Fault::new(span, "the result is infinite", reason));
        }
        Ok(value)
    }

    /// The operation with its arguments, for messages.
    fn with_arguments(&self, x: &[f64]) -> String {
        let infix = |symbol| format!("{} {symbol} {}", written(x[0]), written(x[1]));
        match self {
            Operation::Number(_) | Operation::Parameter(_) | Operation::Negate | Operation::Keep => {
                "it".to_owned()
            }
            Operation::Add => infix("+"),
            Operation::Subtract => infix("-"),
            Operation::Multiply => infix("*"),
            Operation::Divide => infix("/"),
            Operation::Power => infix("^"),
            Operation::Call(index, _) => {
                let arguments: Vec<String> = x.iter().copied().map(written).collect();
                format!("{}({})", FUNCTIONS[*index].name, arguments.join(", "))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_the_model_file_lists_every_function() {
        let page = include_str!("../../../docs/reference/model-file.md");
        for function in FUNCTIONS {
            assert!(page.contains(&format!("`{}`", function.name)), "{}", function.name);
        }
    }

    fn value(text: &str) -> Result<f64, Vec<Fault>> {
        let parameter = |name: &str| match name {
            "R" => 50.0,
            "_a1" => -2.5,
            "gr\u{f6}\u{df}e" => 7.0,
            other => panic!("no parameter {other}"),
        };
        Arithmetic::parse(text)?.evaluate(parameter).map_err(|fault| vec![fault])
    }

    fn check(text: &str, expected: f64) {
        let found = value(text).unwrap_or_else(|faults| panic!("{text}: {faults:?}"));
        assert!((found - expected).abs() <= 4e-16 * expected.abs() || found == expected, "{text}: {found}");
    }

    fn check_fault(text: &str, span: (usize, usize), message: &str) {
        let faults = value(text).unwrap_err();
        let fault = &faults[0];
        let suggestion = fault
            .suggestion
            .as_deref()
            .map(|s| format!(" {}{}", s[..1].to_uppercase(), &s[1..]))
            .unwrap_or_default();
        assert_eq!(format!("{}: {}.{suggestion}", fault.problem, fault.reason), message, "{text}");
        assert_eq!(fault.span, Span::new(span.0, span.1), "{text}");
    }

    #[test]
    fn values() {
        check("1", 1.0);
        check(" 1.5e3 ", 1500.0);
        check(".5", 0.5);
        check("5.", 5.0);
        check("1+2*3", 7.0);
        check("(1+2)*3", 9.0);
        check("10 - 4 - 3", 3.0);
        check("24 / 4 / 3", 2.0);
        check("2^3^2", 512.0);
        check("2**3", 8.0);
        check("-2^2", -4.0);
        check("2^-1", 0.5);
        check("2 ^ -2 ^ 2", 0.0625);
        check("- - 3", 3.0);
        check("2 * -3", -6.0);
        check("+4", 4.0);
        check("2*R", 100.0);
        check("_a1 + gr\u{f6}\u{df}e", 4.5);
        check("sqrt(R^2 - 48^2)", 14.0);
        check("sqrt (16)", 4.0);
        check("sin(30)", 0.5);
        check("cos(90)", 0.0);
        check("tan(45)", 1.0);
        check("asin(1) + acos(-1) + atan(1)", 315.0);
        check("atan2(1, -1)", 135.0);
        check("min(3, 1, 2) + max(4)", 5.0);
        check("floor(-1.5) + ceil(1.2) + round(2.5)", 3.0);
        check("exp(0) + ln(1) + abs(-3)", 4.0);
        check("pow(2, 10) + hypot(3, 4)", 1029.0);
        check("pi", PI);
        check("tau/2", PI);
        check("inf", f64::INFINITY);
        check("1/inf", 0.0);
    }

    #[test]
    fn faults() {
        check_fault("1 / (2 - 2)", (2, 3), "division by zero: the divisor of 1 / 0 is zero.");
        check_fault("sqrt(0 - 4)", (0, 11), "the result is not a number: sqrt(-4) has no value.");
        check_fault("inf - inf", (4, 5), "the result is not a number: inf - inf has no value.");
        check_fault(
            "1e300 * 1e300",
            (6, 7),
            "the result is infinite: 1e300 * 1e300 is beyond the range of a 64-bit float.",
        );
        check_fault(
            "0 ^ -1",
            (2, 3),
            "the result is infinite: 0 ^ -1 is beyond the range of a 64-bit float.",
        );
        check_fault("", (0, 0), "the text is empty: a number or a parameter is missing.");
        check_fault("1 +", (3, 3), "the expression ends too early: a number or a parameter is missing.");
        check_fault("1 + * 2", (4, 5), "unexpected `*`: a number or a parameter is missing before it.");
        check_fault("2e", (1, 2), "an operator is missing before this: the operators are + - * / ^.");
        check_fault("2 R", (2, 3), "an operator is missing before this: the operators are + - * / ^.");
        let no_unit = "numbers have no unit; lengths are in the unit of the model, angles in degrees";
        let advice = "Write 60, or 60 * mm for a product with a parameter";
        check_fault("60mm", (2, 4), &format!("`mm` follows a number: {no_unit}. {advice}"));
        check_fault("2(3)", (1, 2), "an operator is missing before this: the operators are + - * / ^.");
        check_fault("(1", (0, 1), "unmatched `(`: there is no `)` after it.");
        check_fault("1)", (1, 2), "unmatched `)`: there is no `(` before it.");
        check_fault("()", (1, 2), "unexpected `)`: a number or a parameter is missing before it.");
        check_fault("1, 2", (1, 2), "unexpected `,`: it separates the arguments of a function.");
        check_fault("min(1,)", (6, 7), "unexpected `)`: a number or a parameter is missing before it.");
        check_fault("min()", (0, 5), "`min` has 0 arguments: it takes at least 1 argument.");
        check_fault("hypot(1)", (0, 8), "`hypot` has 1 arguments: it takes 2 arguments.");
        check_fault("1 | 2", (2, 3), "unexpected operator `|`: the operators are + - * / ^.");
        check_fault("1.2.3", (0, 5), "`1.2.3` is not a number: it has more than one decimal point.");
        check_fault("1e999", (0, 5), "`1e999` is not a number: it is too large for a 64-bit float.");
        check_fault(
            "2 \u{d7} 3",
            (2, 4),
            "unexpected character `\u{d7}`: it has no meaning here. Did you mean `*`?",
        );
        let functions: Vec<&str> = FUNCTIONS.iter().map(|function| function.name).collect();
        let message = format!(
            "unknown function `sqr`: the functions are {}. Did you mean `sqrt`?",
            functions.join(", ")
        );
        check_fault("1 + sqr(4)", (4, 7), &message);
    }

    #[test]
    fn all_faults_of_calls_are_reported() {
        assert_eq!(Arithmetic::parse("foo(1) + bar(2) + min()").unwrap_err().len(), 3);
    }

    #[test]
    fn depth_costs_no_call_stack() {
        let deep = || {
            let n = 100_000;
            let text = format!("{}1{}", "(".repeat(n), ")".repeat(n));
            check(&text, 1.0);
            check(&format!("{}1{}", "abs(-".repeat(n), ")".repeat(n)), 1.0);
            check(&format!("{}1", "-".repeat(n)), 1.0);
            check(&format!("1{}", "^1".repeat(n)), 1.0);
            assert!(value(&"(".repeat(n)).is_err());
        };
        let thread = std::thread::Builder::new().stack_size(256 * 1024).spawn(deep);
        thread.unwrap().join().unwrap();
    }
}
