//! Optical surfaces: the description of the boundary between two volumes.

use crate::property::PropertyTable;
use crate::tables::{DavisTable, DichroicTable, LutTable};
use std::sync::Arc;

/// The model of the microfacets of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SurfaceModel {
    /// Facet normals within a ball about the normal.
    #[default]
    Glisur,
    /// Facet slopes of a Gaussian distribution (A. Levin, C. Moisan, IEEE NSS 1996).
    Unified,
    /// Reflection by measured tables of the Lawrence Berkeley National Laboratory (M. Janecek, W. W. Moses, IEEE
    /// Trans. Nucl. Sci. 57 (2010) 964). The facets of other types are those of `Unified`, without its lobes.
    Lut,
    /// Reflection and transmission by tables computed from measured topographies (E. Roncali, S. R. Cherry, Phys. Med.
    /// Biol. 58 (2013) 2185). The facets of other types are those of `Unified`, without its lobes.
    Davis,
    /// A dichroic filter. The facets are those of `Glisur` with a polish of 0.
    Dichroic,
}

impl SurfaceModel {
    /// True if the value of the surface is the standard deviation of the facet angles.
    pub(crate) fn has_gaussian_facets(self) -> bool {
        matches!(self, SurfaceModel::Unified | SurfaceModel::Lut | SurfaceModel::Davis)
    }
}

/// The finish of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SurfaceFinish {
    /// A smooth interface.
    #[default]
    Polished,
    /// A smooth surface with paint on it, which reflects like a mirror.
    PolishedFrontPainted,
    /// A smooth interface with paint behind a layer with an index of its own.
    PolishedBackPainted,
    /// A rough interface.
    Ground,
    /// Paint that reflects diffusely.
    GroundFrontPainted,
    /// A rough interface with diffuse paint behind a layer with an index of its own.
    GroundBackPainted,
    /// A finish of the measured tables, by its name in Geant4: one of [`LUT_FINISHES`] or [`DAVIS_FINISHES`].
    Measured(&'static str),
}

/// The finishes of the `LUT` model with the names of their files in Geant4's data set RealSurface, without extension.
/// The three finishes without wrapping have no file. Their numbers in GDML files start at 6.
pub const LUT_FINISHES: [(&str, &str); 24] = [
    ("polishedlumirrorair", "PolishedLumirror"),
    ("polishedlumirrorglue", "PolishedLumirrorGlue"),
    ("polishedair", ""),
    ("polishedteflonair", "PolishedTeflon"),
    ("polishedtioair", "PolishedTiO"),
    ("polishedtyvekair", "PolishedTyvek"),
    ("polishedvm2000air", "PolishedVM2000"),
    ("polishedvm2000glue", "PolishedVM2000Glue"),
    ("etchedlumirrorair", "EtchedLumirror"),
    ("etchedlumirrorglue", "EtchedLumirrorGlue"),
    ("etchedair", ""),
    ("etchedteflonair", "EtchedTeflon"),
    ("etchedtioair", "EtchedTiO"),
    ("etchedtyvekair", "EtchedTyvek"),
    ("etchedvm2000air", "EtchedVM2000"),
    ("etchedvm2000glue", "EtchedVM2000Glue"),
    ("groundlumirrorair", "GroundLumirror"),
    ("groundlumirrorglue", "GroundLumirrorGlue"),
    ("groundair", ""),
    ("groundteflonair", "GroundTeflon"),
    ("groundtioair", "GroundTiO"),
    ("groundtyvekair", "GroundTyvek"),
    ("groundvm2000air", "GroundVM2000"),
    ("groundvm2000glue", "GroundVM2000Glue"),
];

/// The finishes of the `DAVIS` model, which are also the names of their files. Their numbers in GDML files start at 30.
pub const DAVIS_FINISHES: [&str; 9] = [
    "Rough_LUT",
    "RoughTeflon_LUT",
    "RoughESR_LUT",
    "RoughESRGrease_LUT",
    "Polished_LUT",
    "PolishedTeflon_LUT",
    "PolishedESR_LUT",
    "PolishedESRGrease_LUT",
    "Detector_LUT",
];

impl SurfaceFinish {
    /// True for the three smooth finishes.
    #[must_use]
    pub fn is_polished(self) -> bool {
        use SurfaceFinish::{Polished, PolishedBackPainted, PolishedFrontPainted};
        matches!(self, Polished | PolishedFrontPainted | PolishedBackPainted)
    }

    /// True for a paint behind a layer.
    #[must_use]
    pub fn is_back_painted(self) -> bool {
        matches!(self, SurfaceFinish::PolishedBackPainted | SurfaceFinish::GroundBackPainted)
    }
}

/// The kinds of media that a surface separates.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SurfaceType {
    /// Two transparent media.
    #[default]
    DielectricDielectric,
    /// A transparent medium and one that reflects or absorbs.
    DielectricMetal,
    /// A reflector with the measured distribution of an [`LutTable`].
    DielectricLut,
    /// A reflector with the distributions of a [`DavisTable`].
    DielectricLutDavis,
    /// A filter that transmits undeviated light by a [`DichroicTable`] and reflects the rest.
    DielectricDichroic,
    /// Two transparent media with a thin film between them.
    Coated,
}

/// The table of a surface whose behaviour is measured.
#[derive(Clone, Debug)]
pub enum MeasuredTable {
    /// For [`SurfaceType::DielectricLut`].
    Lut(Arc<LutTable>),
    /// For [`SurfaceType::DielectricLutDavis`].
    Davis(Arc<DavisTable>),
    /// For [`SurfaceType::DielectricDichroic`].
    Dichroic(Arc<DichroicTable>),
}

/// The thin film of a [`SurfaceType::Coated`] surface.
#[derive(Clone, Debug)]
pub struct Coating {
    /// The refractive index, `COATEDRINDEX`.
    pub index: PropertyTable,
    /// The thickness in mm, `COATEDTHICKNESS`.
    pub thickness: f64,
    /// True if light tunnels through the film beyond the critical angle, `COATEDFRUSTRATEDTRANSMISSION`.
    pub has_frustrated_transmission: bool,
}

/// An optical surface.
#[derive(Clone, Debug, Default)]
pub struct OpticalSurface {
    /// The name.
    pub name: String,
    /// The model.
    pub model: SurfaceModel,
    /// The finish.
    pub finish: SurfaceFinish,
    /// The type.
    pub kind: SurfaceType,
    /// The standard deviation of the facet angles in radians for `Unified`, the polish (from 0, rough, to 1) for `Glisur`.
    pub value: f64,
    /// `REFLECTIVITY`: 1 minus the fraction that is lost at the surface; 1 where absent.
    pub reflectivity: Option<PropertyTable>,
    /// `TRANSMITTANCE`: the fraction that passes undeviated; 0 where absent.
    pub transmittance: Option<PropertyTable>,
    /// `EFFICIENCY`: the probability that an absorbed photon is detected; 0 where absent.
    pub efficiency: Option<PropertyTable>,
    /// `RINDEX` of the layer in front of a back paint.
    pub index: Option<PropertyTable>,
    /// `REALRINDEX` and `IMAGINARYRINDEX` of a metal.
    pub metal_index: Option<(PropertyTable, PropertyTable)>,
    /// `SPECULARLOBECONSTANT`: reflection about the normal of a facet.
    pub lobe: Option<PropertyTable>,
    /// `SPECULARSPIKECONSTANT`: reflection about the mean normal.
    pub spike: Option<PropertyTable>,
    /// `BACKSCATTERCONSTANT`.
    pub backscatter: Option<PropertyTable>,
    /// `SURFACEROUGHNESS` in mm.
    pub roughness: f64,
    /// The table of a type that needs one.
    pub table: Option<MeasuredTable>,
    /// The film of a coated surface.
    pub coating: Option<Coating>,
}

/// The largest `TRANSMITTANCE` of a surface that the lint takes for closed.
const NEARLY_OPAQUE: f64 = 0.1;

impl OpticalSurface {
    /// True if photons that the surface absorbs can be detected.
    pub(crate) fn detects(&self) -> bool {
        self.efficiency.as_ref().is_some_and(|table| table.values().iter().any(|value| *value > 0.0))
    }

    /// True if no photon passes the surface, whatever its energy and angle: it is reflected or absorbed (and perhaps detected).
    ///
    /// A dichroic filter and a film count as surfaces that transmit light. `is_same_material` states whether the materials in front
    /// and behind are equal: unpainted interfaces between equal materials do nothing.
    pub(crate) fn is_opaque(&self, is_same_material: bool) -> bool {
        self.transmits_at_most(0.0, is_same_material)
    }

    /// True if the surface is opaque but for a `TRANSMITTANCE` of at most 0.1, such as that of a reflecting foil.
    pub(crate) fn is_nearly_opaque(&self, is_same_material: bool) -> bool {
        self.transmits_at_most(NEARLY_OPAQUE, is_same_material)
    }

    /// The largest value of `TRANSMITTANCE`, 0 without one.
    pub(crate) fn largest_transmittance(&self) -> f64 {
        let values = self.transmittance.iter().flat_map(|table| table.values());
        values.copied().fold(0.0, f64::max)
    }

    fn transmits_at_most(&self, transmittance: f64, is_same_material: bool) -> bool {
        use SurfaceFinish::{Ground, GroundFrontPainted, Polished, PolishedFrontPainted};
        let any = |table: &Option<PropertyTable>, is_such: fn(f64) -> bool| {
            table.as_ref().is_some_and(|table| table.values().iter().any(|value| is_such(*value)))
        };
        // TRANSMITTANCE acts on the photons beyond REFLECTIVITY, which is 1 where it is absent
        let loses = any(&self.reflectivity, |value| value < 1.0) || self.metal_index.is_some();
        if loses && self.largest_transmittance() > transmittance {
            return false;
        }
        match self.kind {
            SurfaceType::DielectricMetal | SurfaceType::DielectricLut => true,
            SurfaceType::DielectricLutDavis => {
                let efficiency = self.efficiency.as_ref();
                // with an efficiency all that is not reflected is absorbed
                efficiency.is_some_and(|table| table.values().iter().all(|value| *value > 0.0))
            }
            SurfaceType::DielectricDichroic | SurfaceType::Coated => false,
            SurfaceType::DielectricDielectric => match self.finish {
                PolishedFrontPainted | GroundFrontPainted => true,
                own if own.is_back_painted() => true,
                Polished | Ground if is_same_material => false,
                _ => self.reflectivity.is_some() && !any(&self.reflectivity, |value| value > 0.0),
            },
        }
    }
}
