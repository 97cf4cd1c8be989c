//! Optical surfaces: the description of the boundary between two volumes.

use crate::property::PropertyTable;

/// The model of the microfacets of a surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SurfaceModel {
    /// Facet normals within a ball about the normal.
    #[default]
    Glisur,
    /// Facet slopes of a Gaussian distribution (A. Levin, C. Moisan, IEEE NSS 1996).
    Unified,
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
}

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
}
