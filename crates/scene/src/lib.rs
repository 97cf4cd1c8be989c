//! Model files: documents, diagnostics with source spans, the native TOML format.
//!
//! - [`load`] and [`parse`] read a model: a [`Document`] (the syntax tree, with the span of every
//!   word) and a [`Scene`] (the evaluated solids, regions, media, camera and lights).
//! - [`Diagnostics`] lists all problems of a file at once.
//! - [`arithmetic`] and [`Expression`] are the expression languages for numbers and for solids.
//! - [`foreign`] reads the tables of other programs.
//! - [`schema()`] describes the format for editors.
//!
//! ```
//! let text = r#"
//! rayweave = 1
//! [parameters]
//! R = 50
//! [solid.ball]
//! sphere = { radius = "R / 2" }
//! [solid.half]
//! expr = "ball & bottom"
//! [solid.bottom]
//! half_space = { normal = [0, 0, 1], offset = 0 }
//! "#;
//! let (document, scene) = rayweave_scene::parse(text).unwrap();
//! assert_eq!(scene.regions.len(), 1);
//! assert_eq!(scene.regions[0].name, "half");
//! assert_eq!(rayweave_scene::parse(&document.to_toml()).unwrap().1, scene);
//!
//! let problems = rayweave_scene::parse(&text.replace("ball &", "bal &")).unwrap_err();
//! let problem = problems.iter().next().unwrap();
//! assert_eq!(problem.line_column(), Some((8, 9)));
//! assert_eq!(problem.message(), "unknown solid `bal`: there is no [solid.bal]. Did you mean `ball`?");
//! ```

pub mod arithmetic;
mod bare_name;
mod colour;
mod colour_names;
mod compiled;
mod datum;
mod decompose;
mod diagnostic;
mod document;
mod drawing;
mod error;
mod expression;
mod fault;
mod file;
pub mod foreign;
mod formats;
mod identity;
mod keys;
mod number;
mod resolve;
mod scene;
mod schema;
mod source;
mod suggestion;
mod syntax;
mod unit;

pub use bare_name::bare_name;
pub use colour::Colour;
pub use compiled::{Compiled, world_name};
pub use datum::{Datum, Table, lookup};
pub use diagnostic::{Diagnostic, Diagnostics, Severity};
pub use document::*;
pub use error::SceneError;
pub use expression::{Expression, ExpressionItem, Operator};
pub use file::{load, load_allowing, load_scene, parse, parse_allowing, parse_with, read_bytes, read_stream};
pub use formats::povray::{PovRay, PovRayError};
pub use number::Number;
pub use rayweave_table::{nearby_files, nearby_sentence};
pub use resolve::reason;
pub use scene::{Camera, Light, Medium, Projection, RenderSettings, Scene, SceneRegion};
pub use schema::schema;
pub use source::{Source, Span, Spanned};
pub use unit::Unit;
