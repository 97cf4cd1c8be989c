//! An oracle without rounding errors, independent of the engine's code.
//!
//! Models consist of planes and quadrics with dyadic coefficients; rays are exactly the `f64` values that
//! they consist of. Crossings are numbers (p +- sqrt(d)) / q with p, d, q = m 2^e, compared exactly. Boolean
//! operations are evaluated on the open intervals between distinct crossings. A ray in a surface is perturbed
//! symbolically along the fixed direction, with the exact sign. Neighbouring crossings are welded by the
//! rules of coincidence; a ray is uncertain if the depth of a piece is close to the tolerance, and is counted
//! separately.
//!
//! The only input taken from the compiled model is its balls, which determine over what length a ray has to
//! stay in a surface to lie in it.

mod along;
mod answer;
mod count;
pub(crate) mod draw;
mod dyadic;
mod flat;
mod map;

mod root;
mod sensitivity;
mod shape;
mod shrink;
mod suite;
mod surface;
mod tree;
mod trial;

pub use along::{Span, Uncertain};
pub use answer::{Answer, Expected, Traits, answer, region_at};
pub use count::Count;
pub use dyadic::Dyadic;
pub use flat::{Exact, Leaf, Node};
pub use map::Map;
pub use root::{Root, SignChanges, sign_changes};
pub use sensitivity::{Sensitivity, sensitivity};
pub use shape::Shape;
pub use suite::{meshes, planted, points, transversal, turned};
pub use surface::{Line, Surface};
pub use tree::{Part, Tree, regions};
pub use trial::{Binary, Family, Operator, Trial, trial};
