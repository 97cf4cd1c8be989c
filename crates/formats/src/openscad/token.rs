//! Lexer: tokens of a dump.

use rayweave_scene::Span;

/// A token.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    /// A name, with `$` for special variables.
    Name(String),
    /// A number; infinite if it is out of range.
    Number(f64),
    /// A string, without its quotation marks.
    Text(String),
    /// One of `( ) [ ] { } , ; = % # * ! - +`.
    Mark(char),
    /// An invalid or unterminated token, with the reason.
    Bad(&'static str),
}

/// Token iterator over a text.
pub(super) struct Tokens<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Tokens<'a> {
    pub fn new(text: &'a str) -> Tokens<'a> {
        // some editors write a byte order mark at the start
        let at = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
        Tokens { text, at }
    }

    /// The tokens from an offset, which must be the start of a token.
    pub fn after(text: &'a str, at: usize) -> Tokens<'a> {
        Tokens { text, at }
    }

    /// The current position, after the last token that was read.
    pub fn place(&self) -> Span {
        Span::new(self.at, self.at)
    }

    fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or_default()
    }

    /// Number of consecutive bytes from here that satisfy a condition.
    fn run(&self, is_part: impl Fn(u8) -> bool) -> usize {
        self.rest().bytes().take_while(|byte| is_part(*byte)).count()
    }

    /// Skips blanks and comments; false if a comment is not terminated.
    fn skip(&mut self) -> bool {
        loop {
            self.at += self.run(|byte| byte.is_ascii_whitespace());
            let rest = self.rest();
            if rest.starts_with("//") {
                self.at += rest.find('\n').unwrap_or(rest.len());
            } else if rest.starts_with("/*") {
                match rest.find("*/") {
                    Some(end) => self.at += end + 2,
                    None => return false,
                }
            } else {
                return true;
            }
        }
    }

    fn word(&mut self, first: char) -> Token {
        match first {
            'a'..='z' | 'A'..='Z' | '_' | '$' => self.name(),
            '0'..='9' | '.' => self.number(),
            '"' => self.quoted(),
            '(' | ')' | '[' | ']' | '{' | '}' | ',' | ';' | '=' | '%' | '#' | '*' | '!' | '-' | '+' => {
                self.at += 1;
                Token::Mark(first)
            }
            _ => {
                self.at += first.len_utf8();
                Token::Bad("no token of a dump begins with this character")
            }
        }
    }

    fn name(&mut self) -> Token {
        let length = self.run(|byte| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'$');
        let name = self.rest()[..length].to_owned();
        self.at += length;
        Token::Name(name)
    }

    fn number(&mut self) -> Token {
        let digits = |tokens: &mut Self| tokens.at += tokens.run(|byte| byte.is_ascii_digit());
        let start = self.at;
        digits(self);
        if self.rest().starts_with('.') {
            self.at += 1;
            digits(self);
        }
        if self.rest().starts_with(['e', 'E']) {
            self.at += 1;
            if self.rest().starts_with(['+', '-']) {
                self.at += 1;
            }
            digits(self);
        }
        match self.text[start..self.at].parse() {
            Ok(number) => Token::Number(number),
            Err(_) => Token::Bad("this is not a number"),
        }
    }

    fn quoted(&mut self) -> Token {
        self.at += 1;
        let mut text = String::new();
        let mut characters = self.rest().char_indices();
        while let Some((offset, character)) = characters.next() {
            match character {
                '"' => {
                    self.at += offset + 1;
                    return Token::Text(text);
                }
                '\\' => match characters.next() {
                    Some((_, escaped)) => text.push(unescaped(escaped)),
                    None => break,
                },
                other => text.push(other),
            }
        }
        self.at = self.text.len();
        Token::Bad("this string is not terminated")
    }
}

fn unescaped(character: char) -> char {
    match character {
        'n' => '\n',
        't' => '\t',
        'r' => '\r',
        other => other,
    }
}

impl Iterator for Tokens<'_> {
    type Item = (Token, Span);

    fn next(&mut self) -> Option<(Token, Span)> {
        let is_whole = self.skip();
        let start = self.at;
        let first = self.rest().chars().next()?;
        let token = if is_whole {
            self.word(first)
        } else {
            self.at = self.text.len();
            Token::Bad("this comment is not terminated")
        };
        Some((token, Span::new(start, self.at)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<Token> {
        Tokens::new(text).map(|(token, _)| token).collect()
    }

    #[test]
    fn words_of_every_sort() {
        let text = "\u{feff}#cube($fn = -1.5e-3, \"a\\\"b\\n\") // end\n/* more */ {.5}";
        let expected = [
            Token::Mark('#'),
            Token::Name("cube".into()),
            Token::Mark('('),
            Token::Name("$fn".into()),
            Token::Mark('='),
            Token::Mark('-'),
            Token::Number(1.5e-3),
            Token::Mark(','),
            Token::Text("a\"b\n".into()),
            Token::Mark(')'),
            Token::Mark('{'),
            Token::Number(0.5),
            Token::Mark('}'),
        ];
        assert_eq!(words(text), expected);
    }

    #[test]
    fn places_are_those_in_the_text() {
        let text = "ab  \"\u{e4}\" 12";
        let places: Vec<&str> = Tokens::new(text).map(|(_, span)| &text[span.range()]).collect();
        assert_eq!(places, ["ab", "\"\u{e4}\"", "12"]);
    }

    #[test]
    fn invalid_words() {
        for text in ["\u{e4}", "\"abc", "\"abc\\", "/* abc", "1e", "1e+", "."] {
            assert!(matches!(words(text)[..], [Token::Bad(_)]), "{text}: {:?}", words(text));
        }
        assert_eq!(words("1e400"), [Token::Number(f64::INFINITY)]);
        assert_eq!(words("  // nothing"), []);
    }
}
