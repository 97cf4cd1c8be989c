//! Problems with positions.

use rayweave_scene::Span;

/// A position in one of the texts of a document.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Place {
    pub file: u32,
    pub span: Span,
}

/// A problem and its position.
#[derive(Clone, Debug)]
pub struct Problem {
    pub message: String,
    pub place: Place,
}

impl Problem {
    pub fn new(message: impl Into<String>, place: Place) -> Problem {
        Problem { message: message.into(), place }
    }

    /// Adds a spelling suggestion.
    pub fn did_you_mean<'a>(mut self, name: &str, known: impl IntoIterator<Item = &'a str>) -> Problem {
        if let Some(nearest) = rayweave_error::did_you_mean(name, known) {
            self.message += &format!(" Did you mean `{nearest}`?");
        }
        self
    }
}
