//! Error kinds, error messages and spelling suggestions, shared by all crates.
//!
//! Each crate has error types of its own. [`Classified`] assigns an [`ErrorKind`] to each of them; [`Message`] gives all texts
//! the same form.

mod kind;
mod message;
mod number;
mod similar;

pub use kind::{Classified, ErrorKind};
pub use message::Message;
pub use number::short_number;
pub use similar::{closest, did_you_mean, with_limited_suggestions, with_limited_suggestions_of_part};
