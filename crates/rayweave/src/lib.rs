//! Exact ray tracing through constructive solid geometry.
//!
//! Say a solid in many ways, compile it once, ask it in many ways. Solids are boolean expressions over shapes; a compiled
//! model answers along rays, with `f64` roots that are exact to rounding and an algebra that is exact: touching faces need
//! no nudging, and the same question gives the same bits whatever the evaluator and the number of threads.
//!
//! # Solids
//!
//! [`shapes`] holds a constructor for each shape. Solids are cheap to clone; the operators are `|` union, `&` intersection,
//! `-` difference, `^` symmetric difference and `!` complement. Transforms are about the origin and give new solids.
//!
//! ```
//! use rayweave::shapes::{cylinder, sphere};
//!
//! // a biconvex lens: two balls and a cylinder
//! let front = sphere(50.0)?.translate([0.0, 0.0, 48.0]).named("front");
//! let back = sphere(50.0)?.translate([0.0, 0.0, -48.0]).named("back");
//! let rim = cylinder(10.0, f64::INFINITY)?.named("rim");
//! let lens = &front & &back & &rim;
//! assert_eq!(lens.to_string(), "front & back & rim");
//! # Ok::<(), rayweave::Error>(())
//! ```
//!
//! # Questions along rays
//!
//! A [`Program`] is a solid compiled into flat tables, in which coincident faces have become one surface. [`Packets`] is the
//! evaluator for daily use, eight rays at a time where the model is small; [`Weave`] the one for models of any size,
//! [`Reference`] the obvious one, [`SingleHit`] the one that can explain itself (see [`explain()`]), [`Spans`] the one that
//! works on whole arrays; all answer through the trait [`Evaluator`].
//!
//! ```
//! use rayweave::{Evaluator, Program, Query, Ray, Vec3, Weave, shapes::sphere};
//! use std::sync::Arc;
//!
//! let shell = sphere(2.0)? - sphere(1.0)?;
//! let program = Arc::new(Program::compile(&shell)?);
//! let weave = Weave::new(program.clone());
//!
//! // all crossings: t counts in units of the direction
//! let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
//! let answer = weave.one(ray, &Query::default())?;
//! let times: Vec<f64> = answer.of(0).iter().map(|crossing| crossing.t).collect();
//! assert_eq!(times, [3.0, 4.0, 6.0, 7.0]);
//!
//! // the first after t = 0, with its outward normal and the name of its face
//! let nearest = weave.one(ray, &Query::nearest())?;
//! let first = &nearest.of(0)[0];
//! assert_eq!(rayweave::model::dress::normal(&program, &ray, first), Vec3::NEG_X);
//! let face = program.face_number(first.face.leaf, first.face.facet);
//! assert_eq!(program.face_name(face as u32), "sphere.side");
//!
//! assert!(weave.contains(Vec3::new(0.0, 1.5, 0.0)) && !weave.contains(Vec3::ZERO));
//! # Ok::<(), rayweave::Error>(())
//! ```
//!
//! For many rays, fill a [`RayBatch`](model::RayBatch) and ask [`Evaluator::collect`]; for all cores,
//! [`model::drive::drive`].
//!
//! # Regions and media
//!
//! A model is an ordered list of [`Region`]s, each a solid made of a medium; where they overlap, the later one wins, and
//! everything else is medium 0, the world. Where two parts touch, a ray passes from one to the other in one crossing.
//!
//! ```
//! use rayweave::{Evaluator, Program, Query, Ray, Region, Vec3, Weave, shapes::box_from_corners};
//! use std::sync::Arc;
//!
//! let part = |name: &str, medium, lo, hi| {
//!     let solid = box_from_corners([lo, -1.0, -1.0], [hi, 1.0, 1.0])?;
//!     Ok::<Region, rayweave::Error>(Region { name: name.to_owned(), solid, medium })
//! };
//! let cemented = [part("crown", 1, 0.0, 2.0)?, part("flint", 2, 2.0, 3.0)?];
//! let program = Arc::new(Program::compile_regions(&cemented)?);
//!
//! let ray = Ray::new(Vec3::new(-1.0, 0.1, 0.2), Vec3::X);
//! let answer = Weave::new(program.clone()).one(ray, &Query::default())?;
//! let media = answer.of(0).iter().map(|c| (c.t, program.medium_of(c.before), program.medium_of(c.after)));
//! assert_eq!(media.collect::<Vec<_>>(), [(1.0, 0, 1), (3.0, 1, 2), (4.0, 2, 0)]);
//! # Ok::<(), rayweave::Error>(())
//! ```
//!
//! # Model files
//!
//! [`scene::load`] reads a model from a TOML file, [`scene::parse`] from text; all problems are reported at once, each
//! with its place. [`Compiled`] is a scene's program with the names of its media.
//!
//! ```
//! use rayweave::{AnyEvaluator, Compiled, Evaluator, Query, Ray, Vec3, scene};
//!
//! let (_, scene) = scene::parse(r#"
//!     rayweave = 1
//!     unit = "mm"
//!
//!     [parameters]
//!     R = 5.0
//!
//!     [solid.ball]
//!     sphere = { radius = "R" }
//!
//!     [solid.hole]
//!     cylinder = { radius = "R / 5" }
//!
//!     [solid.bead]
//!     expr = "ball - hole"
//! "#)?;
//! let bead = Compiled::new(&scene)?;
//! let evaluator = AnyEvaluator::new(None, bead.program.clone())?;
//! let across = Ray::new(Vec3::new(-10.0, 0.0, 0.0), Vec3::X);
//! let answer = evaluator.one(across, &Query::default())?;
//! let crossings = answer.of(0).iter().map(|c| (c.t, bead.medium_name(c.after)));
//! let expected = [(5.0, "bead"), (9.0, "world"), (11.0, "bead"), (15.0, "world")];
//! assert_eq!(crossings.collect::<Vec<_>>(), expected);
//!
//! let error = rayweave::Error::from(scene::parse("rayweave = 1\n[solid.a]\nspere = {}").unwrap_err());
//! assert!(error.is_model_file() && error.to_string().contains("did you mean `sphere`?"));
//! # Ok::<(), rayweave::Error>(())
//! ```
//!
//! Models of other programs are read by [`formats::load`], which tells what was lost on the way; [`convert`] writes them.
//!
//! # Pictures
//!
//! [`render`](mod@render) draws what an evaluator sees; [`picture`] arranges camera, colours and lights from a scene.
//!
//! ```
//! use rayweave::picture::{Picture, PictureKind, Wishes, arrange};
//! use rayweave::render::{Run, Size, View};
//! use rayweave::{Compiled, Weave, scene};
//!
//! let (_, scene) = scene::parse("rayweave = 1\n[solid.ring]\ntorus = { major = 3, minor = 1 }")?;
//! let compiled = Compiled::new(&scene)?;
//! let wishes = Wishes { size: Some(Size::new(64, 48)?), view: Some(View::Top), ..Wishes::default() };
//! let (camera, settings) = arrange(&scene, &compiled, &wishes)?;
//! let weave = Weave::new(compiled.program.clone());
//! let picture = Picture::draw(PictureKind::Colour, &weave, &camera, &settings, &mut Run::default())?;
//! assert!(picture.to_png().starts_with(b"\x89PNG"));
//! # Ok::<(), rayweave::Error>(())
//! ```
//!
//! [`timeline`] draws what happens along one ray.
//!
//! # Files of rays
//!
//! [`files::trace_rays`] streams rays from CSV or NPY into a table of hits, on all cores and in constant memory.
//!
//! # Traces of a tool
//!
//! [`measure`] tells volume, mass, centre, inertia and surface area of regions, with confidence intervals.
//! [`thickness`] gives path lengths through media, and radiographs; [`section`](mod@section) cuts by planes.
//! [`diff`](mod@diff) tells whether two models are the same solid; [`check`](mod@check) looks for what was not meant.
//! [`infill`] fills a region of the plane ([`polygon`]), or the layers of a solid, with parallel traces.
//!
//! # Drawings of optical systems
//!
//! [`layout`] cuts a system open and draws light in it ([`section`](mod@section) is the cut alone); [`detector`] draws what arrives.
//!
//! # The algebra alone
//!
//! [`rootray`] knows no geometry: it combines the times at which a trajectory changes sides, for one ray or for arrays of
//! them. Whoever computes the times in his own way needs nothing else.
//!
//! ```
//! use rayweave::rootray::{RootRay, Side};
//!
//! let a = RootRay::from_times(Side::Outside, [1.0, 4.0])?;
//! let b = RootRay::from_times(Side::Outside, [2.0, 6.0])?;
//! assert_eq!((&a - &b).to_string(), "outside [1, 2]");
//! # Ok::<(), rayweave::Error>(())
//! ```
//!
//! # Errors
//!
//! Every error of this crate is an [`Error`], which says problem, reason and suggestion; [`Error::kind`] tells the sorts
//! apart.

mod compiled;
mod error;
mod evaluator;
mod explain;
mod legend;
mod plan;
mod timeline;

pub mod check;
pub mod convert;
pub mod detector;
pub mod diff;
pub mod files;
pub mod infill;
pub mod layout;
pub mod measure;
pub mod picture;
pub mod section;
pub mod shapes;
pub mod thickness;

pub use rayweave_formats as formats;
pub use rayweave_math as math;
pub use rayweave_mesh as mesh;
pub use rayweave_model as model;
pub use rayweave_optics as optics;
pub use rayweave_render as render;
pub use rayweave_rootray as rootray;
pub use rayweave_scene as scene;
pub use rayweave_shape as shape;
pub use rayweave_space as space;
pub use rayweave_space::polygon;
pub use rayweave_table as table;
pub use rayweave_trace as trace;

pub use compiled::Compiled;
pub use error::{Error, ErrorKind};
pub use evaluator::{AnyEvaluator, AnyScratch};
pub use explain::explain;
pub use rayweave_math::{Affine, Bounds, Vec3};
pub use rayweave_model::{Crossing, Evaluator, Program, Query, Region, Solid, Window};
pub use rayweave_shape::Ray;
pub use rayweave_trace::{Packets, Reference, SingleHit, Spans, Weave};
pub use timeline::timeline;

/// The Rust in the README, compiled and run with the documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// The Rust of the page about the algebra, likewise.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/concepts/algebra.md")]
struct Algebra;
