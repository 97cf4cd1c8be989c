//! Hits as the photons of Opticks.

use crate::detector::Detector;
use crate::flight::End;
use crate::history::Process;
use crate::hits::Hits;
use rayweave_math::Vec3;
use rayweave_table::{NpySingles, TableError, TextIds};
use std::path::Path;

/// The numbers of a photon.
const NUMBERS: usize = 16;

/// The lengths of the dimensions of a photon.
const SHAPE: [u64; 2] = [4, 4];

/// The number of bits of a sensor; the upper bits of a photon's number follow.
const SENSOR_BITS: u32 = 24;

/// The photons of Opticks' `hit.npy` (`sphoton.h`), (4, 4) float32 numbers for each hit, as bits.
///
/// Rows: position and time; direction and, as an integer, the index of the instance, which is 0; polarisation and wavelength; as integers,
/// the flag SURFACE_DETECT, the number of the sensor plus 1 (24 bits) with the upper bits of the photon's number, its lower bits, and the
/// mask of the flags of all steps. `flags` are these masks ([`Histories::hit_flags`](crate::Histories)); without them, in runs that record no
/// histories, the mask has SURFACE_DETECT alone. `sensor` is the number of the path of a sensor in [`Hits::paths`] to be written.
pub fn opticks_photons<'h>(
    hits: &'h Hits,
    flags: Option<&'h [u32]>,
    sensor: impl Fn(u32) -> u32 + 'h,
) -> impl Iterator<Item = [u32; NUMBERS]> + 'h {
    let detected = Process::End(End::Detected).flag();
    (0..hits.len()).map(move |k| {
        let at = |columns: &[Vec<f64>; 3]| Vec3::new(columns[0][k], columns[1][k], columns[2][k]);
        let rows = [
            (&hits.position, hits.time[k]),
            (&hits.direction, 0.0),
            (&hits.polarisation, hits.wavelength_nm[k]),
        ];
        let mut photon = [0; NUMBERS];
        for (row, (vector, last)) in rows.into_iter().enumerate() {
            let Vec3 { x, y, z } = at(vector);
            for (column, value) in [x, y, z, last].into_iter().enumerate() {
                photon[4 * row + column] = (value as f32).to_bits();
            }
        }
        let number = hits.photon[k] as u64;
        let sensor = sensor(hits.sensor[k]).wrapping_add(1) & ((1 << SENSOR_BITS) - 1);
        let mask = flags.and_then(|flags| flags.get(k)).map_or(detected, |flags| flags | detected);
        photon[12..].copy_from_slice(&[
            detected,
            ((number >> 32) as u32) << SENSOR_BITS | sensor,
            number as u32,
            mask,
        ]);
        photon
    })
}

/// The file of the hits of a run as photons of Opticks: an NPY array (n, 4, 4) of float32 numbers.
#[derive(Debug)]
pub struct OpticksHits {
    file: NpySingles,
    /// The numbers of the paths of sensors: those of the detector come first.
    sensors: TextIds,
}

impl OpticksHits {
    /// Creates the file.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if it cannot be created.
    pub fn create(path: &Path, detector: &Detector) -> Result<OpticksHits, TableError> {
        let mut sensors = TextIds::default();
        for (sensor, _) in detector.sensor_paths() {
            sensors.id(&sensor.as_str().into());
        }
        Ok(OpticksHits { file: NpySingles::create(path, &SHAPE)?, sensors })
    }

    /// Appends hits, with the masks of [`opticks_photons`].
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if writing fails.
    pub fn write(&mut self, hits: &Hits, flags: Option<&[u32]>) -> Result<(), TableError> {
        let numbers: Vec<u32> = hits.paths().iter().map(|path| self.sensors.id(path)).collect();
        opticks_photons(hits, flags, |sensor| numbers[sensor as usize])
            .try_for_each(|photon| self.file.write(&photon))
    }

    /// Completes the file.
    ///
    /// # Errors
    ///
    /// [`TableError::Io`] if writing fails; an existing file is then unchanged.
    pub fn finish(self) -> Result<(), TableError> {
        self.file.finish()
    }
}
