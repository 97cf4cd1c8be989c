//! Primitive solids: an open set. Each has its own file, which begins with its manual page.
//!
//! To add one, write its file (copy a similar one) and add two lines below: the module, and the entry in the list. The list
//! generates the enum [`Primitive`], the names in all interfaces, the [`MANUALS`], [`build`], and the examples and random
//! primitives that other crates use in tests.

mod arguments;
mod error;
mod lowered;
mod manual;
mod parameter;
mod sag;
mod shape;
mod support;
#[cfg(test)]
mod tests;
mod value;

pub mod asphere;
pub mod biconic;
pub mod box_from_corners;
pub mod centred_box;
pub mod cone;
pub mod convex;
pub mod cylinder;
pub mod ellipsoid;
pub mod freeform;
pub mod half_space;
pub mod mesh;
pub mod paraboloid;
pub mod prism;
pub mod quadric;
pub mod slab;
pub mod sphere;
pub mod torus;
pub mod tube;
pub mod wedge;

pub use arguments::Arguments;
pub use error::ShapeError;
pub use lowered::{Facet, Lowered};
pub use manual::{Manual, parameter_table};
pub use parameter::{Parameter, ParameterKind, ParameterUnit, Range};
pub use shape::Shape;
pub use value::Value;

macro_rules! primitives {
    ($($module:ident :: $shape:ident),* $(,)?) => {
        $(#[doc(no_inline)] pub use $module::$shape;)*

        /// A primitive solid.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Primitive {
            $(#[doc = concat!("See [`", stringify!($module), "`].")] $shape($shape),)*
        }

        $(impl From<$shape> for Primitive {
            fn from(shape: $shape) -> Primitive {
                Primitive::$shape(shape)
            }
        })*

        /// Manual pages of all primitives.
        pub static MANUALS: &[Manual] = &[$({
            const SOURCE: &str = include_str!(concat!(stringify!($module), ".rs"));
            static PAGE: [u8; manual::page_length(SOURCE)] = manual::page(SOURCE);
            Manual {
                name: $shape::NAME,
                summary: manual::first_line(manual::as_text(&PAGE)),
                parameters: $shape::PARAMETERS,
                faces: $shape::FACES,
                equation: $shape::EQUATION,
                text: manual::as_text(&PAGE),
            }
        }),*];

        type Build = fn(&Arguments) -> Result<Primitive, ShapeError>;
        type Random = fn(&mut dyn FnMut() -> f64) -> Primitive;

        // both are in the order of MANUALS
        const BUILD: &[Build] = &[$(|arguments| Ok($shape::from_arguments(arguments)?.into())),*];
        const RANDOM: &[Random] = &[$(|rng| $shape::random(rng).into()),*];

        impl Primitive {
            /// Name in all interfaces.
            pub fn name(&self) -> &'static str {
                match self {
                    $(Primitive::$shape(_) => $shape::NAME,)*
                }
            }

            /// Values of all parameters in the order of the manual; [`build`] makes an equal primitive from them.
            pub fn arguments(&self) -> Vec<(&'static str, Value)> {
                match self {
                    $(Primitive::$shape(shape) => shape.arguments(),)*
                }
            }

            /// The primitive as sides of surfaces.
            pub fn lower(&self) -> Lowered {
                match self {
                    $(Primitive::$shape(shape) => shape.lower(),)*
                }
            }

            /// The volume, if there is a closed form (in the file of the primitive); `inf` if it is unbounded.
            pub fn volume(&self) -> Option<f64> {
                match self {
                    $(Primitive::$shape(shape) => shape.volume(),)*
                }
            }

            /// One example of each kind, in the order of [`MANUALS`].
            pub fn examples() -> Vec<Primitive> {
                vec![$($shape::example().into()),*]
            }
        }
    };
}

primitives! {
    sphere::Sphere,
    ellipsoid::Ellipsoid,
    centred_box::CentredBox,
    box_from_corners::BoxFromCorners,
    cylinder::Cylinder,
    cone::Cone,
    half_space::HalfSpace,
    slab::Slab,
    torus::Torus,
    paraboloid::Paraboloid,
    quadric::Quadric,
    tube::Tube,
    wedge::Wedge,
    prism::Prism,
    convex::Convex,
    mesh::Mesh,
    asphere::Asphere,
    biconic::Biconic,
    freeform::Freeform,
}

impl Primitive {
    /// A typical example of the primitive with this name.
    pub fn example(name: &str) -> Option<Primitive> {
        Primitive::examples().into_iter().find(|primitive| primitive.name() == name)
    }

    /// A random primitive of size about 1, from numbers uniform in [0, 1).
    pub fn random(mut rng: impl FnMut() -> f64) -> Primitive {
        let kind = (rng() * RANDOM.len() as f64) as usize;
        RANDOM[kind.min(RANDOM.len() - 1)](&mut rng)
    }

    /// The manual page.
    pub fn manual(&self) -> &'static Manual {
        // every variant is in the list that generates the pages
        manual(self.name()).unwrap_or(&MANUALS[0])
    }
}

/// The manual page of a primitive.
pub fn manual(name: &str) -> Option<&'static Manual> {
    MANUALS.iter().find(|manual| manual.name == name)
}

/// A primitive from its name and arguments, in any order: the common entry point of files, command line and Python.
///
/// # Errors
///
/// An unknown name; an unknown, missing or repeated parameter; a value of the wrong kind or out of range; inconsistent
/// values.
pub fn build(name: &str, arguments: &[(&str, Value)]) -> Result<Primitive, ShapeError> {
    let found = MANUALS.iter().zip(BUILD).find(|(m, _)| m.name == name);
    let (manual, build) = found.ok_or_else(|| ShapeError::UnknownShape {
        name: name.to_owned(),
        suggestion: rayweave_error::did_you_mean(name, MANUALS.iter().map(|manual| manual.name)),
    })?;
    build(&Arguments::read(manual.name, manual.parameters, arguments)?)
}

/// Names of all primitives, for messages.
fn names() -> String {
    let names: Vec<&str> = MANUALS.iter().map(|manual| manual.name).collect();
    names.join(", ")
}
