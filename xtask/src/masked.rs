//! Separation of Rust source into code and comments, line by line.

/// Two copies of a Rust text in which all characters of other kinds are spaces.
///
/// Both keep the line breaks, so line numbers are those of the original. The contents of string and
/// character literals are in neither copy; their quotes are in `code`.
pub struct Masked {
    /// Only code.
    pub code: Vec<String>,
    /// Only comments, documentation included.
    pub comments: Vec<String>,
    /// Whether the line belongs to an item under `#[cfg(test)]`.
    pub test: Vec<bool>,
}

/// Class of a character.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Code,
    Comment,
    Literal,
}

impl Masked {
    /// Splits a text. Invalid Rust is split on a best-effort basis, without an error.
    pub fn new(text: &str) -> Masked {
        let characters: Vec<char> = text.chars().collect();
        let kinds = classify(&characters);
        let code = lines_of(&characters, &kinds, Kind::Code);
        let comments = lines_of(&characters, &kinds, Kind::Comment);
        let test = test_lines(&code);
        Masked { code, comments, test }
    }

    /// The lines of code outside tests, with their numbers from 1.
    pub fn library_code(&self) -> impl Iterator<Item = (usize, &str)> {
        let lines = self.code.iter().zip(&self.test).enumerate();
        lines.filter(|(_, (_, test))| !**test).map(|(index, (line, _))| (index + 1, line.as_str()))
    }
}

/// Keeps the characters of one kind and the line breaks.
fn lines_of(characters: &[char], kinds: &[Kind], wanted: Kind) -> Vec<String> {
    let kept: String = characters
        .iter()
        .zip(kinds)
        .map(|(&character, &kind)| if kind == wanted || character == '\n' { character } else { ' ' })
        .collect();
    kept.lines().map(str::to_owned).collect()
}

/// The kind of every character.
fn classify(text: &[char]) -> Vec<Kind> {
    let mut kinds = vec![Kind::Code; text.len()];
    let mut at = 0;
    while at < text.len() {
        let (kind, end) = token(text, at);
        // the quotes of a literal remain code, so that masked code still shows the position of a
        // value
        let quotes = usize::from(kind == Kind::Literal);
        let inner = (at + quotes).min(end)..end.saturating_sub(quotes).max((at + quotes).min(end));
        kinds[inner].fill(kind);
        at = end;
    }
    kinds
}

/// The kind and the end of the comment, literal or single character that starts here.
fn token(text: &[char], at: usize) -> (Kind, usize) {
    let next = text.get(at + 1).copied();
    match text[at] {
        '/' if next == Some('/') => (Kind::Comment, find(text, at, '\n')),
        '/' if next == Some('*') => (Kind::Comment, end_of_block(text, at)),
        '"' => (Kind::Literal, end_of_string(text, at)),
        'r' if !follows_word(text, at) => raw_string(text, at),
        '\'' if next == Some('\\') => (Kind::Literal, (find(text, at + 3, '\'') + 1).min(text.len())),
        '\'' if text.get(at + 2) == Some(&'\'') => (Kind::Literal, at + 3),
        _ => (Kind::Code, at + 1),
    }
}

/// The index of the next occurrence of a character from here on, or the length of the text.
fn find(text: &[char], from: usize, wanted: char) -> usize {
    let found = text.get(from..).and_then(|rest| rest.iter().position(|&character| character == wanted));
    found.map_or(text.len(), |distance| from + distance)
}

/// The end of a block comment; these nest.
fn end_of_block(text: &[char], start: usize) -> usize {
    let (mut at, mut depth) = (start, 0usize);
    while at + 1 < text.len() {
        match (text[at], text[at + 1]) {
            ('/', '*') => (at, depth) = (at + 2, depth + 1),
            ('*', '/') => (at, depth) = (at + 2, depth - 1),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    text.len()
}

/// The index after the closing quote.
fn end_of_string(text: &[char], start: usize) -> usize {
    let mut at = start + 1;
    while at < text.len() && text[at] != '"' {
        at += if text[at] == '\\' { 2 } else { 1 };
    }
    (at + 1).min(text.len())
}

/// A raw string that starts at its `r`, or the single character `r`.
fn raw_string(text: &[char], start: usize) -> (Kind, usize) {
    let hashes = text[start + 1..].iter().take_while(|&&character| character == '#').count();
    if text.get(start + 1 + hashes) != Some(&'"') {
        return (Kind::Code, start + 1);
    }
    let mut at = start + 2 + hashes;
    loop {
        at = find(text, at, '"') + 1;
        if at > text.len() {
            return (Kind::Literal, text.len());
        }
        if text[at..].iter().take_while(|&&character| character == '#').count() >= hashes {
            return (Kind::Literal, at + hashes);
        }
    }
}

/// True if this character continues a word; the prefixes `b` and `c` of literals do not count.
fn follows_word(text: &[char], at: usize) -> bool {
    let word = |index: usize| text[index].is_alphanumeric() || text[index] == '_';
    match at {
        0 => false,
        1 => word(0) && !matches!(text[0], 'b' | 'c'),
        _ => word(at - 1) && (!matches!(text[at - 1], 'b' | 'c') || word(at - 2)),
    }
}

/// Marks the lines of every item that follows `#[cfg(test)]`.
fn test_lines(code: &[String]) -> Vec<bool> {
    let mut test = vec![false; code.len()];
    for start in 0..code.len() {
        if code[start].contains("#[cfg(test)]") {
            let end = item_end(code, start);
            test[start..=end].fill(true);
        }
    }
    test
}

/// The last line of the item that starts here: the one with its closing brace, or its first semicolon.
pub fn item_end(code: &[String], start: usize) -> usize {
    let (mut depth, mut braces) = (0i64, 0i64);
    for (index, line) in code.iter().enumerate().skip(start) {
        for character in line.chars() {
            match character {
                '(' | '[' => depth += 1,
                ')' | ']' => depth -= 1,
                // braces inside parentheses are const generics or arguments, not the body of the
                // item
                '{' if depth == 0 => braces += 1,
                '}' if depth == 0 => {
                    braces -= 1;
                    if braces <= 0 {
                        return index;
                    }
                }
                ';' if depth == 0 && braces == 0 => return index,
                _ => {}
            }
        }
    }
    code.len() - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn code(text: &str) -> String {
        Masked::new(text).code.join("\n")
    }

    #[test]
    fn comments_and_code_part() {
        let masked = Masked::new("let a = 1; // why\n/* b /* c */ d */ let e = 2;");
        assert_eq!(masked.code, ["let a = 1;       ", "                  let e = 2;"]);
        assert_eq!(masked.comments, ["           // why", "/* b /* c */ d */           "]);
    }

    #[test]
    fn literals_are_blank_but_keep_their_quotes() {
        assert_eq!(code(r#"f("a // b", 'x', '\'', '\u{1F600}')"#), r#"f("      ", ' ', '  ', '         ')"#);
        assert_eq!(code(r#"f("a\"b\\", c)"#), r#"f("      ", c)"#);
        assert_eq!(code("b\"{\" {"), "b\" \" {");
    }

    #[test]
    fn raw_strings_end_at_their_own_hashes() {
        assert_eq!(code("r#\"a \"b\" // c\"# + 1"), "r             # + 1");
        assert_eq!(code("br\"\\\" + 1"), "br  \" + 1");
        assert_eq!(code("r#type + for_r\"x\""), "r#type + for_r\" \"");
    }

    #[test]
    fn lifetimes_are_no_characters() {
        assert_eq!(code("fn f<'a>(x: &'a str) -> &'a str { x }"), "fn f<'a>(x: &'a str) -> &'a str { x }");
    }

    #[test]
    fn unfinished_text_is_survived() {
        for text in ["\"abc", "/* abc", "r#\"abc", "'\\", "'", "r", "\"\\"] {
            assert_eq!(Masked::new(text).code.len(), 1, "{text}");
        }
        assert_eq!(Masked::new("").code.len(), 0);
    }

    #[test]
    fn test_items_are_known() {
        let text = "fn a() {}\n#[cfg(test)]\nmod tests {\n  fn b() { \"}\"; }\n}\nfn c() {}\n#[cfg(test)]\nuse d::e;\nfn f() {}";
        assert_eq!(Masked::new(text).test, [false, true, true, true, true, false, true, true, false]);
        let lines: Vec<usize> = Masked::new(text).library_code().map(|(line, _)| line).collect();
        assert_eq!(lines, [1, 6, 9]);
    }

    #[test]
    fn a_body_begins_after_the_signature() {
        let lines: Vec<String> =
            ["fn a(x: [f64; { 2 }])", "where B: C {", "  if d { e }", "}", "x"].map(str::to_owned).into();
        assert_eq!(item_end(&lines, 0), 3);
    }
}
