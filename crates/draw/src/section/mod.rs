//! Drawings of cross-sections.
//!
//! ```
//! use rayweave_analysis::section::{SectionPlane, SectionSettings, cross_sections};
//! use rayweave_draw::section::{section_dxf, section_svg};
//! use rayweave_trace::AnyEvaluator;
//!
//! let (_, scene) = rayweave_scene::parse("rayweave = 1\n[solid.ring]\ntorus = { major = 3, minor = 1 }")?;
//! let plane: SectionPlane = "z=0.6".parse()?;
//! let settings = SectionSettings { columns: 64, ..SectionSettings::default() };
//! let make = AnyEvaluator::maker(None);
//! let sections = cross_sections(&scene, None, make, &[plane], &settings, &mut |_| ())?;
//! assert!(section_svg(&sections, "a ring", "mm").contains(">ring</text>"));
//! // two contours
//! assert_eq!(section_dxf(&sections, "mm").matches("CIRCLE").count(), 2);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arcs;
mod bores;
mod dxf;
mod hatch;
mod svg;

pub use dxf::section_dxf;
pub use svg::{SectionStyle, section_drawing, section_svg, section_view, section_with_thickness};
