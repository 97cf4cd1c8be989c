//! The module `rayweave.space`: solids in R^d for d = 2, 3, 4, and curves.

pub mod curve;
pub mod follow;
pub mod kinds;
mod own;
mod recipe;
pub mod solid;
pub mod table;

use rayweave::space::Solid;
use rayweave::space::curve::Curve;
use std::sync::Arc;

/// A solid in a space of one of the dimensions that Python supports.
#[derive(Clone)]
pub enum AnySolid {
    /// In the plane.
    Two(Solid<2>),
    /// In space.
    Three(Solid<3>),
    /// In four dimensions, such as space-time.
    Four(Solid<4>),
}

/// A curve that threads may share.
pub type Shared<const D: usize> = Arc<dyn Curve<D> + Send + Sync>;

/// A curve in a space of one of these dimensions.
pub enum AnyCurve {
    /// In the plane.
    Two(Shared<2>),
    /// In space.
    Three(Shared<3>),
    /// In four dimensions, such as space-time.
    Four(Shared<4>),
}

/// A type for any dimension that may hold a `T` of one dimension.
pub trait Holds<T>: Sized {
    /// Wraps a `T`.
    fn hold(inner: T) -> Self;

    /// The `T`, if it is of that dimension.
    fn held(&self) -> Option<&T>;
}

macro_rules! holds {
    ($($any:ident::$variant:ident($inner:ty)),* $(,)?) => {$(
        impl Holds<$inner> for $any {
            fn hold(inner: $inner) -> Self {
                $any::$variant(inner)
            }

            fn held(&self) -> Option<&$inner> {
                match self {
                    $any::$variant(inner) => Some(inner),
                    _ => None,
                }
            }
        }
    )*};
}

holds! {
    AnySolid::Two(Solid<2>),
    AnySolid::Three(Solid<3>),
    AnySolid::Four(Solid<4>),
    AnyCurve::Two(Shared<2>),
    AnyCurve::Three(Shared<3>),
    AnyCurve::Four(Shared<4>),
}

/// Evaluates an expression for the variant of an `AnySolid` or an `AnyCurve`.
macro_rules! each {
    ($kind:ident, $any:expr, $inner:ident => $body:expr) => {
        match $any {
            $kind::Two($inner) => $body,
            $kind::Three($inner) => $body,
            $kind::Four($inner) => $body,
        }
    };
}

/// Evaluates an expression with a constant `D` for each supported dimension; an error for any
/// other.
macro_rules! in_dimension {
    ($dimension:expr, $d:ident => $body:expr) => {
        match $dimension {
            2 => {
                const $d: usize = 2;
                $body
            }
            3 => {
                const $d: usize = 3;
                $body
            }
            4 => {
                const $d: usize = 4;
                $body
            }
            other => Err(crate::space::no_such_dimension(other)),
        }
    };
}

pub(crate) use {each, in_dimension};

impl AnySolid {
    /// The dimension of its space.
    pub fn dimension(&self) -> usize {
        match self {
            AnySolid::Two(_) => 2,
            AnySolid::Three(_) => 3,
            AnySolid::Four(_) => 4,
        }
    }
}

impl AnyCurve {
    /// The dimension of its space.
    pub fn dimension(&self) -> usize {
        match self {
            AnyCurve::Two(_) => 2,
            AnyCurve::Three(_) => 3,
            AnyCurve::Four(_) => 4,
        }
    }
}

/// The error for an unsupported dimension.
fn no_such_dimension(dimension: usize) -> pyo3::PyErr {
    crate::error::bad_value(format!(
        "the dimension is {dimension}: spaces of 2, 3 and 4 dimensions are supported."
    ))
}
