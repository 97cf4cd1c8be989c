//! Where a polynomial changes sign.
//!
//! A solver answers with [`Crossings`]: the sign of the polynomial far to the left and the finite times at
//! which it changes, in increasing order. A double root is no change of sign and is not reported, and a root
//! beyond the range of `f64` counts as already passed (towards -inf) or never reached (towards +inf).
//!
//! Each file's header says where its method comes from, what it guarantees, and what it answers in degenerate
//! cases.

mod crossings;
pub mod cubic;
pub mod exact;
pub mod isolate;
#[cfg(test)]
mod oracle;
pub mod quadratic;
pub mod quartic;

pub use crossings::Crossings;
pub use cubic::cubic;
pub use exact::{difference_of_products, two_product, two_sum};
pub use quadratic::quadratic;
pub use quartic::quartic;
