//! Fuzz target: bytes as arithmetic and as boolean text, compared with a minimal independent parser.

use rayweave::scene::parse;
use rayweave::{Compiled, Evaluator, Vec3, Weave};

/// Deeper texts are parsed, but not compared: the minimal parser is recursive.
const DEEPEST: usize = 200;

/// The property: a text is rejected with reasons, or has the value that the minimal parser computes.
pub fn run(data: &[u8]) {
    let Some((&first, rest)) = data.split_first() else { return };
    let Ok(text) = std::str::from_utf8(rest) else { return };
    match first % 2 {
        0 => arithmetic(text),
        _ => boolean(text),
    }
}

/// A text as an escaped TOML string.
fn quoted(text: &str) -> String {
    let escaped: String = text.chars().map(|c| format!("\\U{:08X}", u32::from(c))).collect();
    format!("\"{escaped}\"")
}

fn arithmetic(text: &str) {
    let model = format!(
        "rayweave = 1\n[parameters]\na = 3\nb = 0.5\nx = {}\n[solid.s]\nsphere = {{ radius = 1 }}\n",
        quoted(text)
    );
    match parse(&model) {
        Ok((_, scene)) => {
            let found = scene.parameters.iter().find(|(name, _)| name == "x").map(|(_, value)| *value);
            let expected = Reader::new(text).whole(|reader| reader.sum());
            if let (Some(found), Some(expected)) = (found, expected) {
                assert!(
                    found == expected || found.is_nan() && expected.is_nan(),
                    "{text}: {found} {expected}"
                );
            }
        }
        Err(problems) => assert!(!problems.to_string().is_empty()),
    }
}

fn boolean(text: &str) {
    let ball = |name: &str, at: [f64; 3]| {
        format!("[solid.{name}]\nsphere = {{ radius = 2 }}\ntransform = [{{ translate = {at:?} }}]\n")
    };
    let balls = ball("a", [-1.0, 0.0, 0.0]) + &ball("b", [1.0, 0.0, 0.0]) + &ball("c", [0.0, 1.5, 0.0]);
    let model = format!("rayweave = 1\n{balls}[solid.s]\nexpr = {}\n", quoted(text));
    let (_, scene) = match parse(&model) {
        Ok(read) => read,
        Err(problems) => return assert!(!problems.to_string().is_empty()),
    };
    let compiled = Compiled::solid(&scene, "s").unwrap();
    let weave = Weave::new(compiled.program.clone());
    for [x, y] in [
        [0.0, 0.5],
        [-1.0, -1.5],
        [1.0, -1.5],
        [0.0, 3.0],
        [0.0, -1.0],
        [-1.25, 1.25],
        [1.25, 1.25],
        [9.0, 9.0],
    ] {
        let inside = |cx: f64, cy: f64| (x - cx).powi(2) + (y - cy).powi(2) < 4.0;
        let sides = [inside(-1.0, 0.0), inside(1.0, 0.0), inside(0.0, 1.5)];
        let Some(expected) = Reader::new(text).whole(|reader| reader.chain(sides, 0)) else { return };
        assert_eq!(weave.contains(Vec3::new(x, y, 0.0)).unwrap(), expected, "{text} at {x}, {y}");
    }
}

/// A recursive-descent parser for a subset of the two languages. `None` outside the subset.
struct Reader<'a> {
    rest: &'a str,
    depth: usize,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str) -> Reader<'a> {
        Reader { rest: text, depth: 0 }
    }

    fn whole<T>(mut self, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        let value = read(&mut self)?;
        self.rest.trim_start_matches([' ', '\t']).is_empty().then_some(value)
    }

    fn takes(&mut self, symbol: &str) -> bool {
        self.rest = self.rest.trim_start_matches([' ', '\t']);
        match self.rest.strip_prefix(symbol) {
            Some(rest) => {
                self.rest = rest;
                true
            }
            None => false,
        }
    }

    fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        self.depth += 1;
        let value = if self.depth < DEEPEST { read(self) } else { None };
        self.depth -= 1;
        value
    }

    fn word(&mut self) -> &'a str {
        self.rest = self.rest.trim_start_matches([' ', '\t']);
        let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
        let end = self.rest.find(|c| !is_part(c)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(end);
        self.rest = rest;
        word
    }

    // ---- arithmetic ----

    fn sum(&mut self) -> Option<f64> {
        let mut value = self.product()?;
        loop {
            match () {
                () if self.takes("+") => value += self.product()?,
                () if self.takes("-") => value -= self.product()?,
                () => return Some(value),
            }
        }
    }

    fn product(&mut self) -> Option<f64> {
        let mut value = self.signed()?;
        loop {
            match () {
                () if self.rest.trim_start_matches([' ', '\t']).starts_with("**") => return None,
                () if self.takes("*") => value *= self.signed()?,
                () if self.takes("/") => value /= self.signed()?,
                () => return Some(value),
            }
        }
    }

    fn signed(&mut self) -> Option<f64> {
        match () {
            () if self.takes("-") => self.deeper(Self::signed).map(|value| -value),
            () if self.takes("+") => self.deeper(Self::signed),
            () => self.number(),
        }
    }

    /// A number, a parameter or an expression in brackets; powers are outside the subset.
    fn number(&mut self) -> Option<f64> {
        let value = match () {
            () if self.takes("(") => {
                let value = self.deeper(Self::sum)?;
                self.takes(")").then_some(value)
            }
            () => match self.word() {
                "a" => Some(3.0),
                "b" => Some(0.5),
                digits if digits.bytes().all(|byte| byte.is_ascii_digit()) => {
                    let digits = if self.rest.starts_with('.') { return None } else { digits };
                    digits.parse().ok()
                }
                _ => None,
            },
        }?;
        let next = self.rest.trim_start_matches([' ', '\t']);
        (!next.starts_with('^') && !next.starts_with('.')).then_some(value)
    }

    // ---- boolean text ----

    /// `|`, `^`, `&`, `-` from weak to strong; all are parsed from left to right, which matters only for the
    /// strongest.
    fn chain(&mut self, sides: [bool; 3], level: usize) -> Option<bool> {
        const SYMBOLS: [&str; 4] = ["|", "^", "&", "-"];
        let Some(symbol) = SYMBOLS.get(level) else { return self.operand(sides) };
        let mut value = self.chain(sides, level + 1)?;
        while self.takes(symbol) {
            let next = self.chain(sides, level + 1)?;
            value = match level {
                0 => value | next,
                1 => value ^ next,
                2 => value & next,
                _ => value & !next,
            };
        }
        Some(value)
    }

    fn operand(&mut self, sides: [bool; 3]) -> Option<bool> {
        if self.takes("~") {
            return self.deeper(|reader| reader.operand(sides)).map(|value| !value);
        }
        if self.takes("(") {
            let value = self.deeper(|reader| reader.chain(sides, 0))?;
            return self.takes(")").then_some(value);
        }
        match self.word() {
            "a" => Some(sides[0]),
            "b" => Some(sides[1]),
            "c" => Some(sides[2]),
            "empty" => Some(false),
            "universe" => Some(true),
            _ => None,
        }
    }
}
