//! The results of the boundary process.

/// The result of the boundary process.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum BoundaryEvent {
    /// Refraction at an interface.
    FresnelRefraction,
    /// Reflection at an interface or a metal.
    FresnelReflection,
    /// Reflection beyond the critical angle.
    TotalInternalReflection,
    /// Diffuse reflection.
    LambertianReflection,
    /// Reflection about the normal of a facet, or by a table of the `DAVIS` model.
    LobeReflection,
    /// Mirror reflection about the mean normal.
    SpikeReflection,
    /// Reflection into the direction of incidence.
    BackScattering,
    /// Absorption at the surface.
    Absorption,
    /// Absorption at the surface, with detection.
    Detection,
    /// Undeviated transmission, or transmission by a table of the `DAVIS` model.
    Transmission,
    /// The same material on both sides.
    SameMaterial,
    /// Absorption, since the material behind has no refractive index.
    NoIndex,
    /// Reflection by a table of the `LUT` model; Geant4 has a status for each finish, such as `PolishedTyvekAirReflection`.
    LutReflection,
    /// Undeviated transmission by a dichroic filter.
    Dichroic,
    /// Reflection at a thin film.
    CoatedReflection,
    /// Refraction through a thin film.
    CoatedRefraction,
    /// Transmission through a thin film beyond the critical angle of the film.
    CoatedFrustratedTransmission,
}
