//! Optical properties of materials.

use crate::property::{LIGHT_SPEED, Piece, PropertyTable, Spectrum, group_velocity, interval};

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
#[derive(Clone, Debug, PartialEq)]
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
    /// The mean free paths of the processes of the material; the first `count` are used.
    paths: [(f64, Bulk); MAX_PROCESSES],
    count: usize,
}

/// A process in a material.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Bulk {
    Absorption,
    Rayleigh,
    Mie,
    /// Absorption by a wavelength shifter, with its number.
    Shift(u8),
}

/// The number of sets of properties of wavelength shifting in a material.
pub(crate) const MAX_SHIFTERS: usize = 2;

/// The largest number of processes in a material.
const MAX_PROCESSES: usize = 3 + MAX_SHIFTERS;

impl MaterialValues {
    /// Of no energy and no process.
    const NONE: MaterialValues = MaterialValues {
        energy: f64::NAN,
        index: None,
        velocity: LIGHT_SPEED,
        paths: [(f64::INFINITY, Bulk::Absorption); MAX_PROCESSES],
        count: 0,
    };

    /// Of no energy yet, for the processes of a material.
    pub fn new(table: &ValueTable) -> MaterialValues {
        let mut values = MaterialValues { count: table.processes.len(), ..MaterialValues::NONE };
        for (path, process) in values.paths.iter_mut().zip(&table.processes) {
            path.1 = *process;
        }
        values
    }

    /// Sets the values to those at an energy.
    #[inline]
    pub fn set(&mut self, table: &ValueTable, energy: f64) {
        self.energy = energy;
        let [index, velocity, paths @ ..] = table.pieces(energy) else { return };
        self.index = table.has_index.then(|| index.at(energy));
        self.velocity = velocity.at(energy);
        for (path, piece) in self.paths.iter_mut().zip(paths) {
            path.0 = piece.at(energy);
        }
    }

    /// True if these are the values at an energy.
    pub fn is_at(&self, energy: f64) -> bool {
        self.energy == energy
    }

    /// The mean free paths of the processes, in the order of their random numbers.
    pub fn paths(&self) -> &[(f64, Bulk)] {
        &self.paths[..self.count.min(MAX_PROCESSES)]
    }
}

/// The properties of a material that a step needs, prepared for one search per energy.
#[derive(Clone, Debug)]
pub(crate) struct ValueTable {
    /// The energies of the points of all properties, ascending.
    energies: Vec<f64>,
    /// For each interval between them, and for those at the ends, the pieces of the properties: index, velocity, paths.
    pieces: Vec<Piece>,
    /// The number of properties.
    width: usize,
    has_index: bool,
    processes: Vec<Bulk>,
}

impl ValueTable {
    pub fn new(material: &OpticalMaterial) -> ValueTable {
        let (one, light) = (PropertyTable::constant(1.0), PropertyTable::constant(LIGHT_SPEED));
        let index = material.index.as_ref().unwrap_or(&one);
        let velocity = material.group_velocity.as_ref().unwrap_or(&light);
        let (mut tables, mut processes) = (vec![index, velocity], Vec::new());
        let shifters = (0..).zip(material.shifters.iter().take(MAX_SHIFTERS));
        let own = [
            (material.absorption_length.as_ref(), Bulk::Absorption),
            (material.rayleigh_length.as_ref(), Bulk::Rayleigh),
            (material.mie.as_ref().map(|mie| &mie.length), Bulk::Mie),
        ];
        let shifts = shifters.map(|(number, shifter)| (Some(&shifter.length), Bulk::Shift(number)));
        for (table, process) in own.into_iter().chain(shifts) {
            if let Some(table) = table {
                tables.push(table);
                processes.push(process);
            }
        }
        ValueTable { has_index: material.index.is_some(), processes, ..ValueTable::of(&tables) }
    }

    /// Some properties without a material.
    pub fn of(tables: &[&PropertyTable]) -> ValueTable {
        let varies = tables.iter().filter(|table| !table.is_constant());
        let mut energies: Vec<f64> = varies.flat_map(|table| table.energies().iter().copied()).collect();
        energies.sort_by(f64::total_cmp);
        energies.dedup();
        // each property has one piece between two neighbouring energies, and up to the first of them
        let starts = std::iter::once(0.0).chain(energies.iter().copied());
        let pieces = starts.flat_map(|start| tables.iter().map(move |table| table.piece(start))).collect();
        ValueTable { energies, pieces, width: tables.len(), has_index: false, processes: Vec::new() }
    }

    /// The energies, and the pieces of all properties from each of them on.
    #[cfg(feature = "gpu")]
    pub fn columns(&self) -> (&[f64], &[Piece], usize) {
        (&self.energies, &self.pieces, self.width)
    }

    /// The processes in the order of their paths, and whether there is a refractive index.
    #[cfg(feature = "gpu")]
    pub fn processes(&self) -> (&[Bulk], bool) {
        (&self.processes, self.has_index)
    }

    /// The pieces of the properties at an energy.
    #[inline]
    fn pieces(&self, energy: f64) -> &[Piece] {
        let first = interval(&self.energies, energy) * self.width;
        &self.pieces[first..first + self.width]
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::property::HC_MEV_NM;

    /// The values at an energy are linear between the points of their tables, and constant beyond them.
    #[test]
    fn values_at_an_energy_are_those_of_the_tables() {
        let table = |points: &[(f64, f64)]| PropertyTable::new(points.to_vec()).unwrap();
        let material = OpticalMaterial {
            group_velocity: Some(table(&[(2e-6, 200.0), (4e-6, 180.0)])),
            absorption_length: Some(table(&[(1e-6, 100.0), (3e-6, 300.0)])),
            ..OpticalMaterial::transparent("Glass", table(&[(2e-6, 1.3), (4e-6, 1.5)]))
        };
        let tables = ValueTable::new(&material);
        let mut values = MaterialValues::new(&tables);
        for (energy, index, velocity, length) in
            [(1.5e-6, 1.3, 200.0, 150.0), (2.5e-6, 1.35, 195.0, 250.0), (3.5e-6, 1.45, 185.0, 300.0)]
        {
            values.set(&tables, energy);
            let own = [values.index.unwrap(), values.velocity, values.paths()[0].0];
            let is_near = |(own, expected): (f64, f64)| (own / expected - 1.0).abs() < 1e-12;
            assert!(own.into_iter().zip([index, velocity, length]).all(is_near), "{energy}: {own:?}");
        }
    }

    /// Light of 400 nm in water of index 1.34 at 283.15 K: 163.534310 m, computed in SI units with Boltzmann's constant in J/K. The
    /// length goes with the fourth power of the wavelength, and inversely with temperature and factor.
    #[test]
    fn the_rayleigh_length_is_that_of_density_fluctuations() {
        let energy = HC_MEV_NM / 400.0;
        let index = PropertyTable::new(vec![(energy, 1.34), (2.0 * energy, 1.34)]).unwrap();
        let water =
            Compressibility { value: WATER_COMPRESSIBILITY, temperature: WATER_TEMPERATURE, scale: 1.0 };
        let length = |constants: Compressibility| rayleigh_length(&index, constants).values().to_vec();
        let is_near = |own: &[f64], expected: f64| (own[0] / expected - 1.0).abs() < 1e-7;
        let own = length(water);
        assert!(is_near(&own, 163_534.309_9), "{own:?}");
        assert!((own[0] / own[1] - 16.0).abs() < 1e-12, "{own:?}");
        let warm = length(Compressibility { temperature: 2.0 * WATER_TEMPERATURE, ..water });
        assert!(is_near(&warm, 0.5 * 163_534.309_9), "{warm:?}");
        let scaled = length(Compressibility { scale: 4.0, ..water });
        assert!(is_near(&scaled, 0.25 * 163_534.309_9), "{scaled:?}");
    }
}
