//! Exact ray tracing through constructive solid geometry.
//!
//! Define a solid, compile it once, query it along many rays. Solids are boolean expressions over shapes.
//! Crossings are `f64` roots accurate to rounding error, combined by an exact algebra: touching faces need no
//! offsets, and a query returns the same bits for every evaluator and any number of threads.
//!
//! # Solids
//!
//! [`shapes`] contains a constructor for each shape. Solids are cheap to clone; the operators are `|` union,
//! `&` intersection, `-` difference, `^` symmetric difference and `!` complement. Transforms are about the
//! origin and return new solids.
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
//! # Ray queries
//!
//! A [`Program`] is a solid compiled into flat tables, in which coincident faces are merged into one surface.
//! All evaluators implement the trait [`Evaluator`] and return the same answers. [`Packets`] is the default and
//! traces eight rays at a time in small models; [`Weave`] is for models of any size; [`Reference`] is the simplest
//! implementation; [`SingleHit`] can explain its decisions (see [`explain()`]).
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
//! assert_eq!(rayweave::model::attributes::normal(&program, &ray, first), Vec3::NEG_X);
//! assert_eq!(program.name_of(&first.face), "sphere.side");
//!
//! assert!(weave.contains(Vec3::new(0.0, 1.5, 0.0))? && !weave.contains(Vec3::ZERO)?);
//! # Ok::<(), rayweave::Error>(())
//! ```
//!
//! For many rays, fill a [`RayBatch`](model::RayBatch) and call [`Evaluator::collect`]; for all cores, use
//! [`model::drive::drive`].
//!
//! # Regions and media
//!
//! A model is an ordered list of [`Region`]s, each a solid with a medium; where regions overlap, the later
//! one has priority, and everything else is medium 0, the world. Where two parts touch, a ray passes from one
//! to the other in one crossing.
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
//! [`scene::load`] reads a model from a TOML file, [`scene::parse`] from text; all problems are reported at
//! once, each with its position. [`Compiled`] is the program of a scene with the names of its media.
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
//! assert!(error.is_model_file() && error.to_string().contains("Did you mean `sphere`?"));
//! # Ok::<(), rayweave::Error>(())
//! ```
//!
//! [`load`] reads a model file in any format; [`formats::load`] also takes options and values of parameters, and
//! reports what was lost; [`formats::save`] writes models.
//!
//! # Rendering
//!
//! [`render`](mod@render) renders a model through an evaluator; [`picture`] sets up camera, colours and
//! lights from a scene.
//!
//! ```
//! use rayweave::picture::{Picture, PictureKind, PictureOptions, arrange};
//! use rayweave::render::{Run, Size, View};
//! use rayweave::{Compiled, Weave, scene};
//!
//! let (_, scene) = scene::parse("rayweave = 1\n[solid.ring]\ntorus = { major = 3, minor = 1 }")?;
//! let compiled = Compiled::new(&scene)?;
//! let options =
//!     PictureOptions { size: Some(Size::new(64, 48)?), view: Some(View::Top), ..PictureOptions::default() };
//! let (camera, settings) = arrange(&scene, &compiled, &options)?;
//! let weave = Weave::new(compiled.program.clone());
//! let picture = Picture::draw(PictureKind::Colour, &weave, &camera, &settings, &mut Run::default())?;
//! assert!(picture.to_png().starts_with(b"\x89PNG"));
//! # Ok::<(), rayweave::Error>(())
//! ```
//!
//! [`draw::ray_timeline`] draws the timeline of one ray.
//!
//! # Files of rays
//!
//! [`hits::trace_rays`] streams rays from CSV or NPY into a table of hits, on all cores and in constant
//! memory.
//!
//! # Infill
//!
//! [`infill`] fills a region of the plane ([`polygon`]), or the layers of a solid, with parallel tool traces.
//!
//! # Analysis of models
//!
//! [`measure`](mod@measure) computes volume, mass, centre, inertia and surface area of regions, with
//! confidence intervals; [`thickness`] computes path lengths through media, and radiographs;
//! [`section`](mod@section) computes cross-sections by planes. [`diff`](mod@diff) compares two models;
//! [`check`](mod@check) reports modelling errors.
//!
//! # Drawings of optical systems
//!
//! [`layout`] draws a section of a system with light rays; [`detector`] bins and draws the light that arrives
//! at sheets.
//!
//! # Boolean algebra without geometry
//!
//! [`rootray`] is independent of geometry: it combines the times at which a trajectory changes sides, for one
//! ray or for arrays of rays. It suffices for programs that compute these times themselves.
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
//! # Features
//!
//! The default features are those of the command-line program. With `default-features = false` the crate
//! contains solids, programs, evaluators and root-rays, with at most twelve external crates; `analysis`,
//! `draw`, `formats`, `lens`, `optics`, `photon`, `render`, `scene`, `space`, `table`, `parquet`, `gpu`, `spans` and
//! `seed-view` add the rest.
//!
//! This crate re-exports items of other crates, and their examples name these crates: read `rayweave_rootray::`
//! as `rayweave::rootray::`, and so on. `check`, `diff`, `measure` and other analyses come from
//! `rayweave_analysis`.
//!
//! # Errors
//!
//! All errors convert into [`Error`], whose text states problem, reason and suggestion; [`Error::kind`]
//! classifies them.

// docs.rs builds with a nightly compiler and this flag: each item shows the features that it needs
#![cfg_attr(docsrs, feature(doc_cfg))]

mod error;
#[cfg(all(feature = "draw", feature = "lens"))]
mod lens_drawing;
#[cfg(feature = "formats")]
mod load;

pub mod device;
#[cfg(feature = "photon")]
pub mod photon_simulator;

pub mod shapes;

/// Vectors, affine maps and boxes.
pub mod math {
    pub use rayweave_math::{
        Affine, Bounds, Interval, Mat3, SingularError, Transform, UNIT_ROUNDOFF, Vec3, sin_cos_degrees,
        unit_vector_degrees,
    };
}

/// Solids, programs and queries. The building blocks of evaluators are in [`rayweave_model`].
pub mod model {
    pub use rayweave_model::{
        ApproximateColumns, ApproximateEvaluator, BadPoint, BadRay, Collected, CompileError, CompileProblem,
        Copies, Crossing, CrossingColumns, Evaluator, Face, FirstHitColumns, FirstHits, HitArrayRows, Leaf,
        LeafFacet, LeafId, LeafKind, Limit, Medium, Node, Occurrence, OccurrencePath, PathStep, PixelCamera,
        PixelRays, Place, PlacementId, Program, Prototype, PrototypeId, Query, RayAnswer, RayBatch,
        RaySource, Rays, Region, RegionId, RegionInfo, Sink, Solid, Start, StartLists, SurfaceEntry,
        SurfaceId, Window, WindowError, attributes, drive, expanded_size, memory, plain, simplify,
    };
}

/// Rays, and shapes with their manual pages. The intersection kernels of surfaces are in [`rayweave_shape`].
pub mod shape {
    pub use rayweave_shape::{Ray, RayError, primitive};
}

#[cfg(feature = "analysis")]
/// Cross-sections of models, with drawings as SVG and DXF.
pub mod section {
    pub use rayweave_analysis::section::{
        By, CrossSection, Cut, Section, SectionEdge, SectionError, SectionPart, SectionPlane, SectionRun,
        SectionSettings, SectionWindow, cross_sections, section, section_with,
    };
    #[cfg(feature = "draw")]
    pub use rayweave_draw::section::{
        SectionStyle, section_drawing, section_dxf, section_svg, section_view, section_with_thickness,
    };
}

#[cfg(feature = "analysis")]
/// Infill: parallel traces that fill a region of the plane or the layers of a solid, with tables and
/// drawings.
pub mod infill {
    pub use rayweave_analysis::infill::{
        ContourProblems, Fillable, Filling, InfillError, InfillRun, InfillTable, InfillTrace, LayerTraces,
        Layers, Raster, Slices, Summary, infill, read_region, write_infill,
    };
    #[cfg(feature = "draw")]
    pub use rayweave_draw::InfillPicture;
}

#[cfg(feature = "optics")]
/// Light at detectors: spot diagrams and irradiance, computed by [`optics::detector`] and drawn by
/// [`draw::detector`].
pub mod detector {
    #[cfg(feature = "draw")]
    pub use rayweave_draw::detector::{
        Histogram, HitPositions, MapPlane, MapScale, PropertyCurve, histograms_svg, hit_maps_svg,
        irradiance_svg, property_curves_svg, spot_svg, spots_svg,
    };
    pub use rayweave_optics::detector::{
        Detector, Detectors, IrradianceBins, IrradianceMap, SpotDiagram, SpotPoint,
    };
}

// Without `inline` the pages of these crates would only be links, and their functions not in the index and the search.
#[cfg(feature = "analysis")]
#[doc(inline)]
pub use rayweave_analysis::{AnalysisError, check, diff, distance, features, hits, measure, thickness};
#[cfg(feature = "draw")]
#[doc(inline)]
pub use rayweave_draw::{self as draw, DrawError, layout, picture};
#[cfg(feature = "formats")]
#[doc(inline)]
pub use rayweave_formats as formats;
#[cfg(feature = "gpu")]
#[doc(inline)]
pub use rayweave_gpu as gpu;
#[cfg(feature = "lens")]
#[doc(inline)]
pub use rayweave_lens as lens;
#[doc(inline)]
pub use rayweave_mesh as mesh;
#[cfg(feature = "scene")]
#[doc(inline)]
pub use rayweave_mesh_io as mesh_io;
#[cfg(feature = "optics")]
#[doc(inline)]
pub use rayweave_optics as optics;
#[cfg(feature = "photon")]
#[doc(inline)]
pub use rayweave_photon as photon;
#[cfg(feature = "space")]
#[doc(inline)]
pub use rayweave_polygon as polygon;
#[cfg(feature = "render")]
#[doc(inline)]
pub use rayweave_render as render;
#[doc(inline)]
pub use rayweave_rootray as rootray;
#[cfg(feature = "scene")]
#[doc(inline)]
pub use rayweave_scene as scene;
#[cfg(feature = "space")]
#[doc(inline)]
pub use rayweave_space as space;
#[cfg(feature = "table")]
#[doc(inline)]
pub use rayweave_table as table;
#[doc(inline)]
pub use rayweave_trace as trace;

#[cfg(all(feature = "draw", feature = "lens"))]
pub use lens_drawing::{lens_drawing, lens_drawing_with};
#[cfg(feature = "formats")]
pub use load::load;

pub use error::Error;
pub use rayweave_error::{Classified, ErrorKind, Message};
pub use rayweave_math::{Affine, Bounds, Vec3};
pub use rayweave_model::{Crossing, Evaluator, Program, Query, Region, Solid, Window};
#[cfg(feature = "scene")]
pub use rayweave_scene::Compiled;
pub use rayweave_shape::Ray;
#[cfg(feature = "spans")]
pub use rayweave_trace::Spans;
pub use rayweave_trace::single_hit::explain;
pub use rayweave_trace::{AnyEvaluator, AnyScratch, Packets, Reference, SingleHit, Weave};

/// The Rust code of the README, compiled and run with the documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

/// The Rust code of the page on the algebra, compiled and run with the documentation tests.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/concepts/algebra.md")]
struct Algebra;

/// The Rust code of the tutorial for Rust programmers, compiled and run with the documentation tests.
#[cfg(all(doctest, feature = "scene"))]
#[doc = include_str!("../../../docs/tutorials/rust.md")]
struct Tutorial;

/// The Rust code of the guide to gradient-index media, compiled and run with the documentation tests.
#[cfg(all(doctest, feature = "optics"))]
#[doc = include_str!("../../../docs/guides/gradient-index.md")]
struct Gradients;

/// The Rust code of the guide to lens design, compiled and run with the documentation tests.
#[cfg(all(doctest, feature = "lens"))]
#[doc = include_str!("../../../docs/guides/lens-design.md")]
struct LensDesign;
