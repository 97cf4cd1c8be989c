//! Tokens of Rust code outside tests.

use crate::masked::Masked;

/// A word, a path separator or a single other character, with its line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token<'a> {
    pub text: &'a str,
    /// Counted from 1.
    pub line: usize,
}

impl Token<'_> {
    /// True for identifiers, keywords and numbers.
    pub fn is_word(&self) -> bool {
        self.text.starts_with(is_word_character)
    }
}

fn is_word_character(character: char) -> bool {
    character.is_alphanumeric() || character == '_'
}

/// The tokens of a file, without comments, contents of literals, and items under `#[cfg(test)]`.
pub fn tokens(masked: &Masked) -> Vec<Token<'_>> {
    masked.library_code().flat_map(|(line, text)| tokens_of(line, text)).collect()
}

fn tokens_of(line: usize, text: &str) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let length = match first {
            _ if is_word_character(first) => {
                rest.find(|character| !is_word_character(character)).unwrap_or(rest.len())
            }
            ':' if rest.starts_with("::") => 2,
            _ => first.len_utf8(),
        };
        found.push(Token { text: &rest[..length], line });
        rest = rest[length..].trim_start();
    }
    found
}

/// The index after the bracket that closes the one at `open`, or the number of tokens.
pub fn behind_closing(tokens: &[Token<'_>], open: usize) -> usize {
    let mut depth = 0usize;
    for (place, token) in tokens.iter().enumerate().skip(open) {
        match token.text {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth = depth.saturating_sub(1),
            _ => {}
        }
        if depth == 0 {
            return place + 1;
        }
    }
    tokens.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_signs_are_told_apart() {
        let masked = Masked::new("use a::b_1; // c::d\nlet x = \"e::f\";\n#[cfg(test)]\nuse g::h;");
        let tokens = tokens(&masked);
        let texts: Vec<&str> = tokens.iter().map(|token| token.text).collect();
        assert_eq!(texts, ["use", "a", "::", "b_1", ";", "let", "x", "=", "\"", "\"", ";"]);
        assert_eq!((tokens[4].line, tokens[5].line), (1, 2));
    }

    #[test]
    fn brackets_are_closed() {
        let masked = Masked::new("f(a[1], {b}) c");
        let tokens = tokens(&masked);
        assert_eq!(tokens[behind_closing(&tokens, 1)].text, "c");
        assert_eq!(behind_closing(&tokens, 3), 6);
        assert_eq!(behind_closing(&tokens[..4], 1), 4);
    }
}
