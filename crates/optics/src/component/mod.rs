//! Optical components as solids: lenses, mirrors, prisms, concentrators and sheets.
//!
//! The optical axis is z and light travels towards +z. Lengths are in the unit of the document,
//! angles in degrees. Radii of curvature are positive if the centre lies on the side of +z; an
//! infinite radius is a plane. Components are built about the origin; rotate and translate them
//! into place.
//!
//! | kind | functions |
//! | --- | --- |
//! | lenses | [`lens`], [`biconvex`], [`biconcave`], [`plano_convex`], [`plano_concave`], [`conic_lens`], [`cylindrical_lens`], [`toric_lens`], [`cemented`], [`window`], [`ball_lens`], [`half_ball_lens`], [`rod`], [`axicon`], [`fresnel_lens`], [`lenslet_array`] |
//! | mirrors | [`plane_mirror`], [`spherical_mirror`], [`parabolic_mirror`], [`elliptic_mirror`], [`hyperbolic_mirror`], [`conic_mirror`] |
//! | prisms | [`equilateral_prism`], [`dispersing_prism`], [`right_angle_prism`], [`penta_prism`], [`dove_prism`], [`amici_prism`], [`corner_cube`], [`wedge_prism`], [`beam_splitter_cube`] |
//! | concentrators | [`light_pipe`], [`tapered_light_pipe`], [`Cpc`] |
//! | sheets | [`Sheet::plane`], [`Sheet::stop`], [`Sheet::iris`], [`Sheet::spherical`], [`Sheet::conic`], [`Sheet::cylindrical`] |
//!
//! Equivalents in PyRayT, whose axes x, y, z are z, x, y here:
//!
//! | PyRayT | Rayweave |
//! | --- | --- |
//! | `thick_lens(r1, r2, thickness)` | [`lens`] |
//! | `biconvex_lens(r1, r2, thickness)` | [`biconvex`]; that of PyRayT 0.3.1 is correct only if r1 = r2 |
//! | `plano_convex_lens(r, thickness)` | [`plano_convex`] |
//! | `plane_mirror(thickness)` | [`plane_mirror`]; centred in PyRayT, with its face in the plane of the origin here |
//! | `spherical_mirror(radius, thickness)` | [`spherical_mirror`]; for radius > 0 of a [`Blank::turned`] |
//! | `parabolic_mirror(focus, thickness)` | [`parabolic_mirror`] of a [`Blank::turned`], translated by -focus along the axis |
//! | `equilateral_prism(side_length, width)` | [`equilateral_prism`] |
//! | `baffle(aperture)`, `aperture(size, aperture_size)` | [`Sheet::plane`], [`Sheet::stop`] |
//! | `aperture=d`, `(a, b)`, `(-a, -b)` | [`Aperture::circle`], [`Aperture::rectangle`], [`Aperture::ellipse`], which fails in PyRayT |
//! | `off_axis=(y, z)` | [`Blank::off_axis`] |
//! | `lensmakers_equation` | [`lensmaker`] |
//!
//! # Names of faces
//!
//! Leaves are named by their function: `front` for the first surface that light hits, `back` for
//! the last, `edge` for the rim. The name of a face consists of the name of its leaf and the place
//! on that leaf. Each function documents its faces: `front.side` if curved, `front.plane` if plane.
//! A name given to the whole component does not change them, because a leaf keeps the innermost
//! name; [`with_prefix`] adds it:
//!
//! ```
//! use rayweave_model::Program;
//! use rayweave_optics::component::{Aperture, plano_convex, with_prefix};
//!
//! let lens = plano_convex(50.0, 5.0, Aperture::circle(20.0))?;
//! let objective = with_prefix(&lens, "objective");
//! let faces = |solid| Program::compile(solid).unwrap().face_names().collect::<Vec<_>>();
//! assert_eq!(faces(&lens)[..3], ["front.plane", "back.side", "edge.side"]);
//! assert_eq!(faces(&objective)[..3], ["objective.front.plane", "objective.back.side", "objective.edge.side"]);
//! # Ok::<(), rayweave_optics::component::ComponentError>(())
//! ```

mod aperture;
mod array;
mod concentrator;
mod element;
mod error;
mod face;
mod form;
mod form_side;
mod lens;
mod lensmaker;
mod mirror;
mod prefix;
mod prism;
mod sheet;
mod side;
mod toric;

pub use aperture::Aperture;
pub use array::{fresnel_lens, lenslet_array};
pub use concentrator::{Cpc, light_pipe, tapered_light_pipe};
pub use error::ComponentError;
pub use face::{Asphere, sag};
pub use form::{Figure, SurfaceForm};
pub use lens::{
    aspheric_lens, axicon, ball_lens, biconcave, biconvex, cemented, conic_lens, cylindrical_lens,
    freeform_lens, half_ball_lens, lens, plano_concave, plano_convex, rod, window,
};
pub use lensmaker::lensmaker;
pub use mirror::{
    Blank, aspheric_mirror, conic_mirror, elliptic_mirror, freeform_mirror, hyperbolic_mirror,
    parabolic_mirror, plane_mirror, spherical_mirror,
};
pub use prefix::with_prefix;
pub use prism::{
    amici_prism, beam_splitter_cube, corner_cube, dispersing_prism, dove_length, dove_prism,
    equilateral_prism, penta_prism, right_angle_prism, wedge_prism,
};
pub use sheet::Sheet;
pub use toric::toric_lens;

pub use rayweave_shape::surface::sag::Zernike;
