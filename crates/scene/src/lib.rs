//! Model files: documents, diagnostics with source spans, the native TOML format.

pub mod arithmetic;
mod diagnostic;
mod expression;
mod fault;
mod number;
mod source;
mod suggestion;
mod syntax;

pub use diagnostic::{Diagnostic, Diagnostics, Severity};
pub use expression::{Expression, Operator, Term};
pub use number::Number;
pub use source::{Source, Span, Spanned};
