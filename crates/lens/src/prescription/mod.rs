//! Lens prescriptions: sequential optical systems, surface by surface along the axis.
//!
//! The axis is z; the light comes from -z. A surface has a radius of curvature (positive if its centre lies
//! on the side of +z, infinite for a plane), a conic constant (see [`sag`](rayweave_optics::component::sag)),
//! aspheric terms, the distance to the next surface (negative where light travels back after a mirror) and
//! the medium behind it. Surfaces are counted from 1; 0 is the object. The vertex of surface 1 is the origin.
//! Lengths are in millimetres unless [`Prescription::unit_nm`] sets a different unit.
//!
//! | what | where |
//! | --- | --- |
//! | focal lengths, pupils, aberration sums | [`Prescription::first_order`], [`crate::paraxial`] |
//! | one real ray from surface to surface | [`Prescription::follow`] |
//! | rays through the entrance pupil | [`Prescription::beam`] |
//! | solids, stop and image as parts of a system | [`Prescription::assembly`] |
//! | Zemax files | [`read_zmx`], [`write_zmx`] |

//!
//! ```
//! use rayweave_lens::prescription::{Behind, Prescription, Surface};
//!
//! // a cemented doublet: W. J. Smith, Modern Optical Engineering, gives such tables
//! let doublet = Prescription::new(vec![
//!     Surface::new(61.47, 6.0, Behind::Glass("N-BK7".to_owned())),
//!     Surface::new(-44.64, 2.5, Behind::Glass("N-SF5".to_owned())),
//!     Surface::new(-129.94, 95.9, Behind::Air),
//! ])
//! .entrance_pupil_diameter(25.0);
//! let first_order = doublet.first_order(587.5618)?;
//! assert!((first_order.focal_length - 100.0).abs() < 0.5);
//! let layout = doublet.assembly()?;
//! assert_eq!(layout.assembly.compile()?.element_names(), ["lens 1-2", "lens 2-3", "image"]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod breaks;
mod coordinate_break;
mod error;
mod follow;
mod launch;
mod pose;
mod resolved;
mod solids;
mod stop;
mod zmx;

pub use coordinate_break::CoordinateBreak;
pub use error::PrescriptionError;
pub use follow::SurfaceIntersection;
pub use solids::{IMAGE, LensOutline, PrescriptionLayout};
pub use stop::{MOUNT, STOP, StopSheet};
pub use zmx::{Read, ZmxError, read_zmx, write_zmx};

pub(crate) use pose::Pose;
pub(crate) use resolved::Resolved;

use rayweave_optics::Medium;
use rayweave_optics::component::{Asphere, Figure, SurfaceForm};
use rayweave_optics::glass::{Glass, GlassError};

/// Nanometres in a millimetre.
const NM_PER_MM: f64 = 1e6;

/// The d line of helium, in nanometres.
const D_NM: f64 = 587.5618;

/// The medium behind a surface, or a mirror.
#[derive(Clone, Debug, PartialEq)]
pub enum Behind {
    /// Air, the reference medium of glass indices: index 1.
    Air,
    /// The surface is a mirror; the light travels back in the medium from which it came.
    Mirror,
    /// A glass of the built-in catalogue.
    Glass(String),
    /// A medium with the same index at all wavelengths.
    Index(f64),
    /// A model glass, by index and Abbe number at the d line (see [`Glass::from_abbe`]).
    Abbe {
        /// The index at the d line.
        n_d: f64,
        /// The Abbe number.
        v_d: f64,
    },
    /// Any other medium.
    Medium(Medium),
}

impl Behind {
    /// The medium; `None` for a mirror.
    ///
    /// # Errors
    /// [`GlassError`] for an unknown glass, or an invalid index or Abbe number.
    pub fn medium(&self) -> Result<Option<Medium>, GlassError> {
        Ok(Some(match self {
            Behind::Mirror => return Ok(None),
            Behind::Air => Medium::vacuum(),
            Behind::Glass(name) => Medium::glass(name)?,
            Behind::Index(n) => Medium::constant(&format!("n = {n}"), *n, 0.0)
                .map_err(|_| GlassError::NoIndex { glass: format!("n = {n}"), wavelength_nm: D_NM })?,
            Behind::Abbe { n_d, v_d } => Medium::from(Glass::from_abbe(*n_d, *v_d)?),
            Behind::Medium(medium) => medium.clone(),
        }))
    }
}

/// A surface and the medium behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// The radius of curvature at the vertex, along y if the two meridians differ; infinite for a plane.
    pub radius: f64,
    /// The conic constant.
    pub conic: f64,
    /// The coefficients of r^2, r^4, ..., r^16, as in [`Asphere`].
    pub even: [f64; 8],
    /// The coefficients of r, r^3, ..., r^15, as in [`Asphere`].
    pub odd: [f64; 8],
    /// The departure from a surface of revolution.
    pub figure: Figure,
    /// The distance along z from this vertex to the next one.
    pub thickness: f64,
    /// The medium behind the surface.
    pub behind: Behind,
    /// The clear semi-diameter. By default the rays of all fields determine it, plus 2 %.
    pub semi_diameter: Option<f64>,
    /// The mechanical semi-diameter, to the edge of the lens: a lens is as wide as the greatest of the clear and mechanical
    /// semi-diameters of its two surfaces, and absorbs the light beyond the clear ones. Mirrors end at the clear semi-diameter.
    pub mechanical_semi_diameter: Option<f64>,
    /// The semi-diameter of a central hole, for mirrors only; 0 for none.
    pub hole: f64,
}

impl Surface {
    /// A sphere, or a plane for an infinite radius.
    pub fn new(radius: f64, thickness: f64, behind: Behind) -> Surface {
        let (even, odd) = ([0.0; 8], [0.0; 8]);
        Surface {
            radius,
            conic: 0.0,
            even,
            odd,
            figure: Figure::Round,
            thickness,
            behind,
            semi_diameter: None,
            mechanical_semi_diameter: None,
            hole: 0.0,
        }
    }

    /// A plane between equal media, for example for a stop.
    pub fn dummy(thickness: f64) -> Surface {
        Surface::new(f64::INFINITY, thickness, Behind::Air)
    }

    /// Sets the conic constant.
    pub fn conic(self, conic: f64) -> Surface {
        Surface { conic, ..self }
    }

    /// Sets the terms in r^2, r^4, ..., r^16.
    pub fn even(self, even: [f64; 8]) -> Surface {
        Surface { even, ..self }
    }

    /// Sets the terms in r, r^3, ..., r^15.
    pub fn odd(self, odd: [f64; 8]) -> Surface {
        Surface { odd, ..self }
    }

    /// Sets the figure: a biconic, a toroid, terms in x and y.
    pub fn figure(self, figure: Figure) -> Surface {
        Surface { figure, ..self }
    }

    /// Sets the clear semi-diameter.
    pub fn semi_diameter(self, semi_diameter: f64) -> Surface {
        Surface { semi_diameter: Some(semi_diameter), ..self }
    }

    /// Sets the mechanical semi-diameter.
    pub fn mechanical_semi_diameter(self, semi_diameter: f64) -> Surface {
        Surface { mechanical_semi_diameter: Some(semi_diameter), ..self }
    }

    /// Sets the semi-diameter of a central hole.
    pub fn hole(self, semi_diameter: f64) -> Surface {
        Surface { hole: semi_diameter, ..self }
    }

    /// True for a conic of revolution, without further terms.
    pub(crate) fn is_conic(&self) -> bool {
        self.figure == Figure::Round && self.even == [0.0; 8] && self.odd == [0.0; 8]
    }

    /// The coefficient of r^4 minus that of the sphere of the same vertex curvature, times 8.
    pub(crate) fn asphericity(&self) -> f64 {
        let base = 1.0 / self.radius;
        let vertex = base + 2.0 * self.even[0];
        let cubes = match self.even[0] {
            0.0 => self.conic * base * base * base,
            _ => (1.0 + self.conic) * base * base * base - vertex * vertex * vertex,
        };
        cubes + 8.0 * self.even[1]
    }

    /// The form (sag function) of the surface.
    pub fn form(&self) -> SurfaceForm {
        let asphere = Asphere { radius: self.radius, conic: self.conic, even: self.even, odd: self.odd };
        SurfaceForm::new(asphere, self.figure.clone())
    }
}

/// The system aperture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SystemAperture {
    /// The diameter of the entrance pupil.
    EntrancePupilDiameter(f64),
    /// The focal length over the diameter of the entrance pupil.
    FNumber(f64),
    /// The sine of the half angle of the cone from an object at a finite distance, times the index there.
    ObjectNumericalAperture(f64),
    /// The semi-diameter of the stop.
    StopSemiDiameter(f64),
}

/// The kind of the field coordinates, which are pairs (x, y).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FieldKind {
    /// Angles from the axis in degrees: the chief ray has the direction (tan x, tan y, 1).
    Angle,
    /// The position of an object point, at a finite distance.
    ObjectHeight,
    /// The position of a paraxial image point.
    ImageHeight,
}

/// A wavelength with its weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedWavelength {
    /// The vacuum wavelength in nanometres.
    pub wavelength_nm: f64,
    /// The relative weight.
    pub weight: f64,
}

/// The image surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageSurface {
    /// The radius of curvature; infinite for a plane.
    pub radius: f64,
    /// The conic constant.
    pub conic: f64,
    /// The semi-diameter; by default twice the extent of the rays of all fields.
    pub semi_diameter: Option<f64>,
}

/// A sequential lens prescription.
#[derive(Clone, Debug, PartialEq)]
pub struct Prescription {
    /// The name.
    pub name: String,
    /// The source and other remarks, line by line.
    pub notes: Vec<String>,
    /// The unit of lengths, in nanometres.
    pub unit_nm: f64,
    /// The system aperture.
    pub aperture: SystemAperture,
    /// The kind of the field coordinates.
    pub field_kind: FieldKind,
    /// The field points.
    pub fields: Vec<[f64; 2]>,
    /// The wavelengths.
    pub lines: Vec<WeightedWavelength>,
    /// The index of the primary wavelength, counted from 0.
    pub primary: usize,
    /// The distance from the object to the first surface; infinite for distant objects.
    pub object_distance: f64,
    /// The surfaces between object and image; the thickness of the last is the distance to the image.
    pub surfaces: Vec<Surface>,
    /// The surface at the aperture stop, counted from 1.
    pub stop: usize,
    /// The image surface.
    pub image: ImageSurface,
    /// Decentres and tilts of the axis; several in front of one surface apply in order.
    pub breaks: Vec<CoordinateBreak>,
}

impl Prescription {
    /// A prescription with a distant object on the axis, light of the d line, an entrance pupil of diameter
    /// 1, the stop at the first surface, and a plane image.
    pub fn new(surfaces: Vec<Surface>) -> Prescription {
        Prescription {
            name: String::new(),
            notes: Vec::new(),
            unit_nm: NM_PER_MM,
            aperture: SystemAperture::EntrancePupilDiameter(1.0),
            field_kind: FieldKind::Angle,
            fields: vec![[0.0; 2]],
            lines: vec![WeightedWavelength { wavelength_nm: D_NM, weight: 1.0 }],
            primary: 0,
            object_distance: f64::INFINITY,
            surfaces,
            stop: 1,
            image: ImageSurface { radius: f64::INFINITY, conic: 0.0, semi_diameter: None },
            breaks: Vec::new(),
        }
    }

    /// Sets the name.
    pub fn named(self, name: &str) -> Prescription {
        Prescription { name: name.to_owned(), ..self }
    }

    /// Sets the diameter of the entrance pupil.
    pub fn entrance_pupil_diameter(self, diameter: f64) -> Prescription {
        Prescription { aperture: SystemAperture::EntrancePupilDiameter(diameter), ..self }
    }

    /// Sets fields at these angles along y, in degrees.
    pub fn field_angles(self, degrees: &[f64]) -> Prescription {
        let fields = degrees.iter().map(|&y| [0.0, y]).collect();
        Prescription { field_kind: FieldKind::Angle, fields, ..self }
    }

    /// Sets the surface of the stop, counted from 1.
    pub fn stop_at(self, surface: usize) -> Prescription {
        Prescription { stop: surface, ..self }
    }

    /// Sets the wavelengths, of equal weight; `primary` is the index of the primary one, counted from 0.
    pub fn wavelengths_nm(self, wavelengths: &[f64], primary: usize) -> Prescription {
        let line = |&wavelength_nm: &f64| WeightedWavelength { wavelength_nm, weight: 1.0 };
        Prescription { lines: wavelengths.iter().map(line).collect(), primary, ..self }
    }

    /// The primary wavelength in nanometres; the d line if there is none.
    pub fn primary_nm(&self) -> f64 {
        self.lines.get(self.primary).map_or(D_NM, |line| line.wavelength_nm)
    }
}
