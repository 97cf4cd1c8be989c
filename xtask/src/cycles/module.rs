//! Modules of a crate: their items, imports and the paths in their code.

use super::token::{Token, behind_closing};
use std::collections::{BTreeMap, BTreeSet};

/// The names from a crate's root to a module.
pub type ModulePath = Vec<String>;

/// An imported path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Import {
    pub path: Vec<String>,
    pub line: usize,
    /// Declared with `pub`, so that other modules can import the name from here.
    pub is_public: bool,
}

/// A module, in its own file or inline.
#[derive(Debug, Default)]
pub struct Module {
    /// The file that contains it.
    pub file: String,
    /// The names that it defines.
    pub items: BTreeSet<String>,
    pub children: BTreeSet<String>,
    /// Imports by their local name.
    pub imports: BTreeMap<String, Import>,
    /// Glob imports.
    pub globs: Vec<Import>,
    /// Qualified paths in the code, with their lines.
    pub paths: Vec<(Vec<String>, usize)>,
    /// All words of the code, without imports.
    pub words: BTreeSet<String>,
}

/// Keywords before the name of an item.
const ITEMS: [&str; 8] = ["fn", "struct", "enum", "trait", "type", "const", "static", "union"];

/// Modifiers that can precede such a keyword.
const MODIFIERS: [&str; 5] = ["fn", "unsafe", "mut", "extern", "async"];

/// Parses the modules of a file: its own module at `path`, and its inline modules.
pub fn read(file: &str, path: &[String], tokens: &[Token<'_>], modules: &mut BTreeMap<ModulePath, Module>) {
    let mut module = Module { file: file.to_owned(), ..Module::default() };
    let mut at = 0;
    while at < tokens.len() {
        if tokens[at].text == "#" {
            let open = at + 1 + usize::from(tokens.get(at + 1).is_some_and(|token| token.text == "!"));
            at = behind_closing(tokens, open);
            continue;
        }
        let end = item_end(tokens, at);
        let item = &tokens[at..end];
        let (is_public, start) = visibility(item);
        match item.get(start).map(|token| token.text) {
            Some("use") => module.import(&item[start + 1..], is_public),
            Some("mod") => {
                let name = item[start + 1].text.to_owned();
                if item.get(start + 2).is_some_and(|token| token.text == "{") {
                    let inner: ModulePath = path.iter().cloned().chain([name.clone()]).collect();
                    read(file, &inner, &item[start + 3..item.len() - 1], modules);
                }
                module.children.insert(name);
            }
            _ => module.item(&item[start..]),
        }
        at = end;
    }
    modules.insert(path.to_vec(), module);
}

/// Whether an item is public, and the index of its first token after the visibility.
fn visibility(item: &[Token<'_>]) -> (bool, usize) {
    match item {
        [first, next, ..] if first.text == "pub" && next.text == "(" => (true, behind_closing(item, 1)),
        [first, ..] if first.text == "pub" => (true, 1),
        _ => (false, 0),
    }
}

/// The index after the item that starts at `start`: after its semicolon, or the end of its body.
fn item_end(tokens: &[Token<'_>], start: usize) -> usize {
    let mut first = tokens[start..].iter().map(|token| token.text).filter(|text| *text != "pub");
    let ends_with_semicolon = matches!(first.next(), Some("use" | "static" | "type"))
        || (tokens[start..].iter().take(6).any(|token| token.text == "const")
            && !tokens[start..].iter().take(8).any(|token| matches!(token.text, "fn" | "{")));
    let mut at = start;
    while at < tokens.len() {
        match tokens[at].text {
            ";" => return at + 1,
            "{" if !ends_with_semicolon => return behind_closing(tokens, at),
            "(" | "[" | "{" => at = behind_closing(tokens, at),
            _ => at += 1,
        }
    }
    tokens.len()
}

impl Module {
    /// Adds an item that is neither an import nor a module.
    fn item(&mut self, item: &[Token<'_>]) {
        let head = item.iter().take_while(|token| !matches!(token.text, "{" | "(" | "=")).take(8);
        let head: Vec<&str> = head.map(|token| token.text).collect();
        let name = head.windows(2).find(|pair| ITEMS.contains(&pair[0]) && !MODIFIERS.contains(&pair[1]));
        if head.first() == Some(&"macro_rules") {
            self.items.extend(head.get(2).map(|name| (*name).to_owned()));
        } else if head.first() != Some(&"impl") {
            self.items.extend(name.map(|pair| pair[1].to_owned()));
        }
        let mut at = 0;
        while at < item.len() {
            let token = item[at];
            let follows_path = at > 0 && item[at - 1].text == "::";
            let begins_statement = at > 0 && matches!(item[at - 1].text, "{" | "}" | ";");
            if token.text == "use" && begins_statement {
                let end = item_end(item, at);
                self.local_import(&item[at + 1..end]);
                at = end;
            } else if token.is_word() && !follows_path {
                self.words.insert(token.text.to_owned());
                let path = path_at(item, at);
                at += 2 * path.len() - 1;
                if path.len() > 1 {
                    self.paths.push((path, token.line));
                }
            } else {
                at += 1;
            }
        }
    }

    /// Adds the imports of a `use` declaration, from the tokens after `use`.
    fn import(&mut self, tokens: &[Token<'_>], is_public: bool) {
        for (path, name, line) in imports(tokens) {
            let import = Import { path, line, is_public };
            match name {
                Some(name) => {
                    self.imports.insert(name, import);
                }
                None => self.globs.push(import),
            }
        }
    }

    /// Adds the imports of a declaration inside a function; they count as paths.
    fn local_import(&mut self, tokens: &[Token<'_>]) {
        for (path, name, line) in imports(tokens) {
            match name {
                Some(_) => self.paths.push((path, line)),
                None => self.globs.push(Import { path, line, is_public: false }),
            }
        }
    }
}

/// The words of the path that starts at `start`.
fn path_at(tokens: &[Token<'_>], start: usize) -> Vec<String> {
    let mut path = vec![tokens[start].text.to_owned()];
    let mut at = start + 1;
    while let [separator, word, ..] = &tokens[at.min(tokens.len())..] {
        if separator.text != "::" || !word.is_word() {
            break;
        }
        path.push(word.text.to_owned());
        at += 2;
    }
    path
}

/// Imported paths, their local names (`None` for glob imports), and lines.
fn imports(tokens: &[Token<'_>]) -> Vec<(Vec<String>, Option<String>, usize)> {
    let mut found = Vec::new();
    tree(tokens, 0, &[], &mut found);
    found
}

/// Parses one tree of a `use` declaration; returns the index after it.
fn tree(
    tokens: &[Token<'_>],
    mut at: usize,
    prefix: &[String],
    found: &mut Vec<(Vec<String>, Option<String>, usize)>,
) -> usize {
    let mut path = prefix.to_vec();
    while let Some(token) = tokens.get(at) {
        match token.text {
            "::" => at += 1,
            "*" => {
                found.push((path, None, token.line));
                return at + 1;
            }
            "{" => {
                at += 1;
                while tokens.get(at).is_some_and(|token| token.text != "}") {
                    at = tree(tokens, at, &path, found);
                    at += usize::from(tokens.get(at).is_some_and(|token| token.text == ","));
                }
                return at + 1;
            }
            _ if token.is_word() => {
                path.push(token.text.to_owned());
                at += 1;
                if tokens.get(at).is_some_and(|token| token.text == "::") {
                    continue;
                }
                if path.last().is_some_and(|last| last == "self") {
                    path.pop();
                }
                let mut name = path.last().cloned().unwrap_or_default();
                if tokens.get(at).is_some_and(|token| token.text == "as") {
                    name = tokens.get(at + 1).map_or(name, |token| token.text.to_owned());
                    at += 2;
                }
                found.push((path, Some(name), token.line));
                return at;
            }
            _ => return at + 1,
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::super::token::tokens;
    use super::*;
    use crate::masked::Masked;

    fn module(text: &str) -> Module {
        let mut modules = BTreeMap::new();
        read("lib.rs", &[], &tokens(&Masked::new(text)), &mut modules);
        modules.remove(&Vec::new()).unwrap()
    }

    fn path(text: &str) -> Vec<String> {
        text.split("::").map(str::to_owned).collect()
    }

    #[test]
    fn items_are_found() {
        let text = "mod a;\npub(crate) mod b { fn inner() {} }\npub struct C<T>(T);\nimpl C<u8> { fn method() {} }\n\
                    pub const fn d() {}\nconst E: [u8; { 2 }] = [0; 2];\nmacro_rules! f { () => {} }\n#[derive(Debug)]\n\
                    enum G { H }\npub(super) type I = u8;\nstatic J: u8 = 1;";
        let module = module(text);
        assert_eq!(module.items.iter().collect::<Vec<_>>(), ["C", "E", "G", "I", "J", "d", "f"]);
        assert_eq!(module.children.iter().collect::<Vec<_>>(), ["a", "b"]);
    }

    #[test]
    fn imports_are_found() {
        let module = module("use crate::{a::{self, B as C}, d::*};\npub use super::e::F;");
        let import = |text: &str, is_public, line| Import { path: path(text), line, is_public };
        assert_eq!(module.imports["a"], import("crate::a", false, 1));
        assert_eq!(module.imports["C"], import("crate::a::B", false, 1));
        assert_eq!(module.imports["F"], import("super::e::F", true, 2));
        assert_eq!(module.globs, [import("crate::d", false, 1)]);
    }

    #[test]
    fn paths_are_found() {
        let module = module("fn f(x: a::B) -> C {\n    use super::d::E;\n    crate::g::<u8>(x.h::<I>())\n}");
        let paths: Vec<String> = module.paths.iter().map(|(path, _)| path.join("::")).collect();
        assert_eq!(paths, ["a::B", "super::d::E", "crate::g"]);
        assert_eq!(module.paths[2].1, 3);
        assert!(module.words.contains("C") && !module.words.contains("B"));
    }
}
