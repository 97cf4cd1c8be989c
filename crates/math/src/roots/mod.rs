//! Polynomial root finding: the real roots of quadratics, cubics and quartics at which the sign changes.
//!
//! A solver returns [`Crossings`]: the sign of the polynomial at -inf and the finite times at which it changes, in increasing
//! order. Double roots do not change the sign and are not reported. A root beyond the range of `f64` counts as passed (towards
//! -inf) or as never reached (towards +inf).
//!
//! The header of each file gives the source of its method, its guarantee, and its results in degenerate cases.

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
