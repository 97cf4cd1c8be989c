//! An oracle without rounding, sharing no code with the engine.
//!
//! Models of planes and quadrics in dyadic numbers, rays taken as exactly the `f64` that they consist of.
//! Crossings are numbers (p +- sqrt(d)) / q with p, d, q = m 2^e, compared exactly; booleans are decided on the
//! open intervals between distinct crossings; a ray in a surface is moved along the fixed direction in
//! thought, with the exact sign; and neighbours are welded as the rules for coincidence say, where pieces of
//! about the depth of the tolerance have no certain answer and are counted apart.
//!
//! The one thing taken from the compiled model is its ball, which says how long a ray has to keep to a surface
//! to lie in it.

mod along;
mod answer;
mod count;
pub(crate) mod draw;
mod dyadic;
mod flat;
mod map;

mod root;
mod scrutiny;
mod shape;
mod shrink;
mod suite;
mod surface;
mod tree;
mod trial;

pub use along::{Doubt, Span};
pub use answer::{Answer, Expected, Traits, answer, region_at};
pub use count::Count;
pub use dyadic::Dyadic;
pub use flat::{Exact, Leaf, Node};
pub use map::Map;
pub use root::{Root, SignChanges, sign_changes};
pub use scrutiny::{Scrutiny, scrutiny};
pub use shape::Shape;
pub use suite::{planted, points, transversal, turned};
pub use surface::{Line, Surface};
pub use tree::{Part, Tree, regions};
pub use trial::{Binary, Family, Operator, Trial, trial};
