//! Diagnostics of files: problem, reason, suggestion and source span.

use crate::source::{Source, Span};
use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use rayweave_error::{Classified, ErrorKind};
use std::borrow::Cow;
use std::fmt;
use std::path::Path;
use std::sync::Arc;

/// Severity of a diagnostic.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// The file cannot be used.
    Error,
    /// The file can be used, but may not have the intended meaning.
    Warning,
}

/// One problem, with its reason, source span and suggestion.
#[derive(Clone, Debug)]
pub struct Diagnostic {
    severity: Severity,
    message: String,
    place: Option<(Arc<Source>, Option<Span>)>,
    notes: Vec<(Span, String)>,
}

impl Diagnostic {
    /// An error.
    pub fn error(problem: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Severity::Error, problem.into())
    }

    /// A warning.
    pub fn warning(problem: impl Into<String>) -> Diagnostic {
        Diagnostic::new(Severity::Warning, problem.into())
    }

    fn new(severity: Severity, message: String) -> Diagnostic {
        Diagnostic { severity, message, place: None, notes: Vec::new() }
    }

    /// Adds the reason: `problem: reason.`
    pub fn why(mut self, reason: impl fmt::Display) -> Diagnostic {
        let reason = reason.to_string();
        let full_stop = if reason.ends_with(['.', '?']) { "" } else { "." };
        self.message += &format!(": {reason}{full_stop}");
        self
    }

    /// Adds a suggestion, if there is one: a question or a sentence.
    pub fn suggest(mut self, suggestion: Option<String>) -> Diagnostic {
        if let Some(suggestion) = suggestion {
            let full_stop = if suggestion.ends_with(['.', '?']) { "" } else { "." };
            let mut letters = suggestion.chars();
            let first = letters.next().map(|letter| letter.to_ascii_uppercase());
            let first = first.map(String::from).unwrap_or_default();
            self.message += &format!(" {first}{}{full_stop}", letters.as_str());
        }
        self
    }

    /// Sets the span of the problem in a text.
    pub fn at(mut self, source: &Arc<Source>, span: Span) -> Diagnostic {
        self.place = Some((source.clone(), Some(span)));
        self
    }

    /// Sets the file of a problem that concerns the whole file.
    pub fn in_file(mut self, source: &Arc<Source>) -> Diagnostic {
        self.place = Some((source.clone(), None));
        self
    }

    /// Adds a note at a related position in the same text.
    pub fn note(mut self, span: Span, text: impl Into<String>) -> Diagnostic {
        self.notes.push((span, text.into()));
        self
    }

    /// Severity.
    pub fn severity(&self) -> Severity {
        self.severity
    }

    /// The message as one line: `problem: reason. Suggestion.`
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The file, if the text comes from one.
    pub fn path(&self) -> Option<&Path> {
        let (source, _) = self.place.as_ref()?;
        source.path().map(|path| path.as_path())
    }

    /// The range of bytes in the text.
    pub fn span(&self) -> Option<Span> {
        self.place.as_ref()?.1
    }

    /// Line and column, from 1; columns count characters.
    pub fn line_column(&self) -> Option<(usize, usize)> {
        let (source, span) = self.place.as_ref()?;
        span.map(|span| source.line_column(span.start()))
    }

    /// Related places: line, column and note.
    pub fn notes(&self) -> impl Iterator<Item = (usize, usize, &str)> {
        let source = self.place.as_ref().map(|(source, _)| source.clone());
        self.notes.iter().filter_map(move |(span, text)| {
            let (line, column) = source.as_ref()?.line_column(span.start());
            Some((line, column, text.as_str()))
        })
    }

    fn render(&self, renderer: &Renderer) -> String {
        let level = match self.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let message = shortened(&self.message);
        let mut report = Group::with_title(level.primary_title(&*message));
        match &self.place {
            None => {}
            Some((source, None)) => report = report.element(annotate_snippets::Origin::path(source.name())),
            Some((source, Some(span))) => {
                let all = std::iter::once((*span, AnnotationKind::Primary, None));
                let notes = self.notes.iter();
                let notes = notes.map(|(span, text)| (*span, AnnotationKind::Context, Some(text.as_str())));
                for (span, kind, label) in all.chain(notes) {
                    report = match snippet(source, span, kind, label) {
                        Some(snippet) => report.element(snippet),
                        None => report.element(origin(source, span)),
                    };
                }
            }
        }
        renderer.render(&[report])
    }
}

/// Like [`Diagnostics::render`] of this problem alone, without colours. A leading `error: ` or `warning: ` is left out: programs
/// print it themselves.
impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = self.render(&Renderer::plain());
        let label = match self.severity {
            Severity::Error => "error: ",
            Severity::Warning => "warning: ",
        };
        f.write_str(text.strip_prefix(label).unwrap_or(&text))
    }
}

/// The maximum number of characters of a message in rendered text: a message may quote a name or an expression of any
/// length.
const MAX_MESSAGE: usize = 1000;

/// The number of characters at the end of a message that is shortened.
const MESSAGE_END: usize = 300;

/// The text without its middle part if it is too long.
fn shortened(text: &str) -> Cow<'_, str> {
    // characters are at least as many bytes
    if text.len() <= MAX_MESSAGE || text.chars().count() <= MAX_MESSAGE {
        return Cow::Borrowed(text);
    }
    let at = |(byte, _): (usize, char)| byte;
    let end = text.char_indices().rev().nth(MESSAGE_END - 1).map_or(0, at);
    let begin = text.char_indices().nth(MAX_MESSAGE - MESSAGE_END).map_or(0, at);
    Cow::Owned(format!("{} [...] {}", &text[..begin], &text[end..]))
}

/// The maximum number of problems in rendered text, and the number of bytes after which no further ones follow.
const MAX_RENDERED: usize = 50;
const MAX_BYTES: usize = 20_000;

/// The maximum length of the source lines shown with a problem, in bytes: a file with a single line may have thousands of problems.
const LONGEST: usize = 4096;

/// The position of a range, shown instead of lines that are too long.
fn origin(source: &Source, span: Span) -> annotate_snippets::Origin<'_> {
    let (line, column) = source.line_column(span.start());
    annotate_snippets::Origin::path(source.name()).line(line).char_column(column)
}

/// The lines that a range overlaps, with the range underlined; `None` if they are too long. The renderer receives only these
/// lines, so the time per problem does not depend on the length of the file.
fn snippet<'a>(
    source: &'a Source,
    span: Span,
    kind: AnnotationKind,
    label: Option<&'a str>,
) -> Option<Snippet<'a, annotate_snippets::Annotation<'a>>> {
    let (line, text, within) = source.lines_of(span);
    let snippet = || {
        Snippet::source(text)
            .line_start(line)
            .path(source.name())
            .annotation(kind.span(within.range()).label(label))
    };
    (text.len() <= LONGEST).then(snippet)
}

/// All problems of a file, in the order of the file.
#[derive(Clone, Debug, Default)]
pub struct Diagnostics {
    list: Vec<Diagnostic>,
}

impl Classified for Diagnostics {
    fn kind(&self) -> ErrorKind {
        ErrorKind::ModelFile
    }
}

impl Diagnostics {
    /// Creates a list sorted by position; problems of the file as a whole come first.
    pub fn new(mut list: Vec<Diagnostic>) -> Diagnostics {
        list.sort_by_key(|diagnostic| diagnostic.span());
        Diagnostics { list }
    }

    /// The problems, in the order of the file.
    pub fn iter(&self) -> std::slice::Iter<'_, Diagnostic> {
        self.list.iter()
    }

    /// Number of diagnostics, including warnings.
    pub fn len(&self) -> usize {
        self.list.len()
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    /// True if one of them is an error.
    pub fn has_errors(&self) -> bool {
        self.list.iter().any(|diagnostic| diagnostic.severity == Severity::Error)
    }

    /// The same problems, all as errors.
    pub fn into_errors(mut self) -> Diagnostics {
        self.list.iter_mut().for_each(|diagnostic| diagnostic.severity = Severity::Error);
        self
    }

    /// Renders as text: each problem with its file, line and column and the source line underlined, optionally with terminal
    /// colours. Of more than 50 problems, or 20 kB, the number of the others is stated at the end; long messages are shortened.
    /// [`iter`](Self::iter) has them all.
    pub fn render(&self, colour: bool) -> String {
        let renderer = if colour { Renderer::styled() } else { Renderer::plain() };
        // warnings must not displace errors
        let is_error = |own: &&Diagnostic| own.severity == Severity::Error;
        let most_warnings = MAX_RENDERED.saturating_sub(self.list.iter().filter(is_error).count());
        let (mut text, mut shown, mut warnings) = (String::new(), 0, 0);
        for diagnostic in &self.list {
            let is_warning = !is_error(&diagnostic);
            if shown == MAX_RENDERED || text.len() > MAX_BYTES || is_warning && warnings == most_warnings {
                continue;
            }
            let gap = if text.is_empty() { "" } else { "\n\n" };
            text += &format!("{gap}{}", diagnostic.render(&renderer));
            shown += 1;
            warnings += usize::from(is_warning);
        }
        match self.list.len() - shown {
            0 => text,
            1 => text + "\n\nand 1 more problem",
            more => text + &format!("\n\nand {more} more problems"),
        }
    }
}

/// Like [`Diagnostics::render`] without colours. A leading `error: ` is left out: programs print it before the text of any error.
impl fmt::Display for Diagnostics {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let text = self.render(false);
        f.write_str(text.strip_prefix("error: ").unwrap_or(&text))
    }
}

impl std::error::Error for Diagnostics {}

impl From<Diagnostic> for Diagnostics {
    fn from(diagnostic: Diagnostic) -> Diagnostics {
        Diagnostics::new(vec![diagnostic])
    }
}

impl<'a> IntoIterator for &'a Diagnostics {
    type Item = &'a Diagnostic;
    type IntoIter = std::slice::Iter<'a, Diagnostic>;

    fn into_iter(self) -> Self::IntoIter {
        self.list.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_single_problem_is_printed_without_its_severity() {
        assert_eq!(Diagnostic::warning("a table is unknown").to_string(), "a table is unknown");
        assert_eq!(Diagnostic::error("a name is missing").to_string(), "a name is missing");
    }

    #[test]
    fn rendered_text_is_limited() {
        let warnings = (0..200).map(|k| Diagnostic::warning(format!("warning {k}")));
        let last =
            Diagnostic::error("the error").why("r".repeat(100_000)).suggest(Some("Change it".to_owned()));
        let all = Diagnostics::new(warnings.chain([last]).collect());
        let text = all.render(false);
        assert!(text.len() < 10_000, "{}", text.len());
        assert!(
            text.contains("the error: rrr") && text.contains(" [...] r") && text.contains("r. Change it.")
        );
        assert!(text.contains("warning 48") && !text.contains("warning 49"));
        assert!(text.ends_with("\n\nand 151 more problems"));
        assert_eq!(all.len(), 201);
        let few = Diagnostics::new(vec![Diagnostic::error("a"), Diagnostic::warning("b")]);
        assert_eq!(few.render(false), "error: a\n\nwarning: b");
    }

    #[test]
    fn messages_are_shortened_between_characters() {
        let text = "\u{e9}".repeat(1001);
        let short = shortened(&text);
        assert_eq!(short.chars().count(), 1000 + " [...] ".len());
        assert!(matches!(shortened(&text[2..]), Cow::Borrowed(_)));
    }
}
