//! The check of links in Markdown files.

use super::violation::{Rule, Violation};
use crate::repository::Source;

static LINK: Rule = Rule { name: "link", why: "the target of a link must exist" };

pub fn check(source: &Source, exists: &dyn Fn(&str) -> bool) -> Vec<Violation> {
    if !source.is("md") {
        return Vec::new();
    }
    let folder = source.path.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut violations = Vec::new();
    for (line, target) in targets(&source.text) {
        let broken = match resolve(folder, target) {
            Resolved::Elsewhere => false,
            Resolved::Outside => true,
            Resolved::Inside(path) => !path.is_empty() && !exists(&path),
        };
        if broken {
            let problem = format!("no file '{target}'");
            violations.push(Violation::new(&LINK, source, line, problem, "links are relative to this file"));
        }
    }
    violations
}

/// The target of a link.
enum Resolved {
    /// Another site, or a place in the same file.
    Elsewhere,
    /// A file above the root of the repository.
    Outside,
    /// A path from the root.
    Inside(String),
}

/// The targets of all links and pictures with their lines, outside code.
fn targets(text: &str) -> Vec<(usize, &str)> {
    let mut targets = Vec::new();
    let mut in_code = false;
    for (index, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            in_code = !in_code;
        } else if !in_code {
            targets.extend(in_line(line).into_iter().map(|target| (index + 1, target)));
        }
    }
    targets
}

/// The targets on one line: `[text](target)`, `[text](target "title")` and `[name]: target`.
fn in_line(line: &str) -> Vec<&str> {
    let mut targets = Vec::new();
    for (at, _) in line.match_indices("](") {
        let in_code = line[..at].matches('`').count() % 2 == 1;
        if let Some(end) = line[at + 2..].find(')').filter(|_| !in_code) {
            targets.push(line[at + 2..at + 2 + end].split(' ').next().unwrap_or_default());
        }
    }
    if let Some((_, target)) = line.trim_start().strip_prefix('[').and_then(|rest| rest.split_once("]: ")) {
        targets.push(target.trim());
    }
    targets
}

/// Resolves the target of a link in a file of this folder to a path relative to the root.
fn resolve(folder: &str, target: &str) -> Resolved {
    let file = target.split('#').next().unwrap_or_default();
    if file.is_empty() || file.starts_with("mailto:") || file.contains("://") {
        return Resolved::Elsewhere;
    }
    let mut parts: Vec<&str> = folder.split('/').filter(|part| !part.is_empty()).collect();
    for part in file.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.pop().is_none() => return Resolved::Outside,
            ".." => {}
            name => parts.push(name),
        }
    }
    Resolved::Inside(parts.join("/"))
}

#[cfg(test)]
mod tests {
    use crate::tidy::found;

    #[test]
    fn broken_links_are_found() {
        let text = "[a](here.md) ![b](gone.png)\n[c](https://gone.example/x) [d](#part) `[e](gone)`\n\
                    ```\n[f](gone)\n```\n[g](../here/x.md#part) and [h](gone.md \"title\")\n[i]: gone/i.md\n";
        assert_eq!(found("docs/a.md", text), [("link", 1), ("link", 6), ("link", 7)]);
        assert_eq!(found("a.md", "[a](../here.md)\n"), [("link", 1)]);
    }

    #[test]
    fn links_are_relative_to_their_file() {
        assert_eq!(found("here/a.md", "[a](b.md)\n"), []);
        assert_eq!(found("here/a.md", "[a](../b.md)\n"), [("link", 1)]);
    }
}
