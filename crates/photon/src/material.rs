//! Optical properties of materials.

use crate::property::{LIGHT_SPEED, PropertyTable, Spectrum, group_velocity};

/// The optical properties of a material. Lengths are in mm, times in ns, energies in MeV.
#[derive(Clone, Debug, Default)]
pub struct OpticalMaterial {
    /// The name.
    pub name: String,
    /// The refractive index, `RINDEX`; a photon that enters a material without one is absorbed.
    pub index: Option<PropertyTable>,
    /// The group velocity in mm/ns, `GROUPVEL`, or derived from the index.
    pub group_velocity: Option<PropertyTable>,
    /// The absorption length, `ABSLENGTH`.
    pub absorption_length: Option<PropertyTable>,
    /// The mean free path of Rayleigh scattering, `RAYLEIGH`, or derived from the compressibility.
    pub rayleigh_length: Option<PropertyTable>,
    /// Scattering by small particles.
    pub mie: Option<Mie>,
    /// Wavelength shifting, the first and the second set of properties.
    pub shifters: Vec<WavelengthShifter>,
    /// The components of scintillation.
    pub scintillation: Vec<ScintillationComponent>,
}

/// A component of scintillation, with its number k.
#[derive(Clone, Debug)]
pub struct ScintillationComponent {
    /// The number, 1 to 3.
    pub number: u32,
    /// The emission spectrum, `SCINTILLATIONCOMPONENTk`.
    pub spectrum: Spectrum,
    /// The time constant in ns, `SCINTILLATIONTIMECONSTANTk`.
    pub time: Option<f64>,
    /// The rise time in ns, `SCINTILLATIONRISETIMEk`; 0 by default.
    pub rise_time: f64,
    /// The relative yield, `SCINTILLATIONYIELDk`; by default 1 for the first component and 0 for the others.
    pub share: f64,
}

/// Scattering by small particles: the phase function of Henyey and Greenstein (1941) with two lobes.
#[derive(Clone, Debug)]
pub struct Mie {
    /// The mean free path, `MIEHG`.
    pub length: PropertyTable,
    /// The mean cosine of the forward lobe, `MIEHG_FORWARD`.
    pub forward: f64,
    /// The mean cosine of the backward lobe, measured from the backward direction, `MIEHG_BACKWARD`.
    pub backward: f64,
    /// The probability of the forward lobe, `MIEHG_FORWARD_RATIO`.
    pub forward_ratio: f64,
}

/// Absorption followed by isotropic emission of photons of lower energy.
#[derive(Clone, Debug)]
pub struct WavelengthShifter {
    /// The absorption length, `WLSABSLENGTH`.
    pub length: PropertyTable,
    /// The emission spectrum, `WLSCOMPONENT`.
    pub spectrum: Spectrum,
    /// The delay of the emission in ns, `WLSTIMECONSTANT`.
    pub time: f64,
    /// The mean of the Poisson distributed number of photons, `WLSMEANNUMBERPHOTONS`; `None` for exactly one.
    pub mean_photons: Option<f64>,
}

/// The constants of the Einstein-Smoluchowski formula.
#[derive(Clone, Copy, Debug)]
pub struct Compressibility {
    /// The isothermal compressibility in mm3/MeV.
    pub value: f64,
    /// The temperature in K.
    pub temperature: f64,
    /// A factor on the inverse of the mean free path, `RS_SCALE_FACTOR`.
    pub scale: f64,
}

/// The compressibility that Geant4 uses for the material named "Water", in mm3/MeV: 7.658e-23 m3/MeV.
pub const WATER_COMPRESSIBILITY: f64 = 7.658e-23 * 1e9;

/// The temperature that Geant4 uses for the material named "Water", in K.
pub const WATER_TEMPERATURE: f64 = 283.15;

/// Boltzmann's constant in MeV/K (exact, SI 2019).
const BOLTZMANN: f64 = 8.617_333_262_145_18e-11;

/// The mean free path of Rayleigh scattering in a liquid, in mm: 6 pi / (k^4 (n^2 - 1)^2 (n^2 + 2)^2 / 9 * beta kB T)
/// with the wave number k in vacuum (Einstein 1910; Smoluchowski 1908; `G4OpRayleigh` of Geant4 11.4).
#[must_use]
pub fn rayleigh_length(index: &PropertyTable, constants: Compressibility) -> PropertyTable {
    let points = index.energies().iter().zip(index.values());
    let length = |(&energy, &n): (&f64, &f64)| {
        let wave_number = std::f64::consts::TAU * energy / (crate::property::HC_MEV_NM * 1e-6);
        let contrast = (n * n - 1.0) * (n * n + 2.0) / 3.0;
        let fluctuation = constants.value * BOLTZMANN * constants.temperature * constants.scale;
        let square = wave_number * wave_number * contrast;
        (6.0 * std::f64::consts::PI / (square * square * fluctuation)).min(f64::MAX)
    };
    index.mapped(points.map(length).collect())
}

/// The properties of a material at one energy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MaterialValues {
    /// The energy in MeV.
    energy: f64,
    /// The refractive index.
    pub index: Option<f64>,
    /// The group velocity in mm/ns.
    pub velocity: f64,
    pub absorption_length: Option<f64>,
    pub rayleigh_length: Option<f64>,
    pub mie_length: Option<f64>,
    /// The absorption lengths of the wavelength shifters.
    pub shifter_lengths: [Option<f64>; MAX_SHIFTERS],
}

/// The number of sets of properties of wavelength shifting in a material.
pub(crate) const MAX_SHIFTERS: usize = 2;

impl MaterialValues {
    /// Of no energy.
    pub const NONE: MaterialValues = MaterialValues {
        energy: f64::NAN,
        index: None,
        velocity: LIGHT_SPEED,
        absorption_length: None,
        rayleigh_length: None,
        mie_length: None,
        shifter_lengths: [None; MAX_SHIFTERS],
    };

    pub fn new(material: &OpticalMaterial, energy: f64) -> MaterialValues {
        let at = |table: &Option<PropertyTable>| table.as_ref().map(|table| table.at(energy));
        let shifter = |k: usize| material.shifters.get(k).map(|shifter| shifter.length.at(energy));
        MaterialValues {
            energy,
            index: at(&material.index),
            velocity: at(&material.group_velocity).unwrap_or(LIGHT_SPEED),
            absorption_length: at(&material.absorption_length),
            rayleigh_length: at(&material.rayleigh_length),
            mie_length: material.mie.as_ref().map(|mie| mie.length.at(energy)),
            shifter_lengths: std::array::from_fn(shifter),
        }
    }

    /// True if these are the values at an energy.
    pub fn is_at(&self, energy: f64) -> bool {
        self.energy == energy
    }
}

impl OpticalMaterial {
    /// A material of a constant refractive index without any other property.
    #[must_use]
    pub fn transparent(name: impl Into<String>, index: PropertyTable) -> OpticalMaterial {
        let group_velocity = Some(group_velocity(&index));
        OpticalMaterial {
            name: name.into(),
            index: Some(index),
            group_velocity,
            ..OpticalMaterial::default()
        }
    }
}
