//! Samples of reflected and transmitted directions by angle of incidence: the tables of the `DAVIS` model.

use super::rows::nearest_rows;
use super::text::read_numbers;
use crate::error::PhotonError;
use std::path::Path;

/// The reflectance and samples of reflected and transmitted directions for each degree of the angle of incidence.
///
/// *Source*: `G4OpBoundaryProcess::DielectricLUTDAVIS` and `G4OpticalSurface` of Geant4 11. Geant4 selects one of 20,000
/// samples uniformly, and again while both of its angles are 0; here such samples are left out.
#[derive(Clone, Debug)]
pub struct DavisTable {
    reflectance: Vec<f64>,
    /// Azimuth and elevation in radians of all samples: those of reflection by angle of incidence, then those of
    /// transmission.
    samples: Vec<[f32; 2]>,
    /// The number of samples that are in use of each block of 20,000, at its front.
    counts: Vec<usize>,
    /// The block of each angle of incidence, for reflection and for transmission.
    blocks: [Vec<usize>; 2],
}

impl DavisTable {
    /// The number of angles of incidence: 0 to 89 degrees.
    pub const INCIDENCES: usize = 90;
    /// The number of samples for each angle of incidence.
    pub const SAMPLES: usize = 20_000;
    /// The number of blocks of samples of reflection in the table, of which the last two are not used.
    const REFLECTED: usize = 91;
    /// The number of values that Geant4 reads.
    const VALUES: usize = 7_280_001;

    /// A table of the reflectance for each degree of the angle of incidence, shape (90,), and of directions.
    ///
    /// The directions are pairs of an azimuth and an elevation in radians, an angle from the normal: blocks of 20,000 pairs,
    /// 91 for reflection at 1, 2, ... degrees, then 90 for transmission at 0, 1, ... degrees, 7,240,000 values; further
    /// ones are not used. A block without samples is replaced by the nearest one that has some.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for other numbers of values, a reflectance beyond 0 to 1, directions that are not finite, and a table
    /// without directions.
    pub fn new(reflectance: Vec<f64>, directions: &[f32]) -> Result<DavisTable, PhotonError> {
        let refuse = |reason: String| Err(PhotonError::setting("the DAVIS table is invalid", reason));
        let (count, needed) = (reflectance.len(), Self::INCIDENCES);
        if count != needed {
            return refuse(format!("it has {count} reflectances, {needed} are needed"));
        }
        if let Some(k) = reflectance.iter().position(|value| !(0.0..=1.0).contains(value)) {
            return refuse(format!(
                "the reflectance at {k} degrees is {}: it must be from 0 to 1",
                reflectance[k]
            ));
        }
        let blocks = Self::REFLECTED + Self::INCIDENCES;
        let needed = 2 * Self::SAMPLES * blocks;
        if directions.len() < needed {
            return refuse(format!("it has {} values of directions, {needed} are needed", directions.len()));
        }
        if let Some(k) = directions[..needed].iter().position(|value| !value.is_finite()) {
            return refuse(format!("the value {k} of directions is {}: it must be finite", directions[k]));
        }
        let mut samples: Vec<[f32; 2]> = Vec::with_capacity(blocks * Self::SAMPLES);
        let mut counts = Vec::with_capacity(blocks);
        for block in directions[..needed].chunks_exact(2 * Self::SAMPLES) {
            let start = samples.len();
            let pairs = block.as_chunks::<2>().0;
            samples.extend(pairs.iter().filter(|pair| **pair != [0.0; 2]));
            counts.push(samples.len() - start);
            samples.resize(start + Self::SAMPLES, [0.0; 2]);
        }
        let filled: Vec<bool> = counts.iter().map(|count| *count > 0).collect();
        // reflection at k degrees has the block before, and at 0 degrees none
        let (reflected, transmitted) = filled.split_at(Self::REFLECTED);
        let (reflected, transmitted) =
            (nearest_rows(&reflected[..Self::INCIDENCES - 1]), nearest_rows(transmitted));
        let is_used = |is_reflection: bool| {
            let is_chosen = |value: &f64| if is_reflection { *value > 0.0 } else { *value < 1.0 };
            reflectance.iter().any(is_chosen)
        };
        if (reflected.is_none() && is_used(true)) || (transmitted.is_none() && is_used(false)) {
            return refuse("all of its directions are 0".to_owned());
        }
        let transmitted = transmitted.into_iter().flatten().map(|block| block + Self::REFLECTED).collect();
        let blocks = [reflected.unwrap_or_default(), transmitted];
        Ok(DavisTable { reflectance, samples, counts, blocks })
    }

    /// Reads the two files of a finish: the reflectances (such as `Rough_LUTR.dat`) and the directions (`Rough_LUT.dat`). Files
    /// with the extension `.z` are decompressed, and read in place of absent ones.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for files that cannot be read, and for those of [`DavisTable::new`].
    pub fn read(reflectance: &Path, directions: &Path) -> Result<DavisTable, PhotonError> {
        let values = read_numbers(reflectance, Self::INCIDENCES)?;
        DavisTable::new(values, &read_numbers::<f32>(directions, Self::VALUES)?)
    }

    /// The row of an angle of incidence in degrees.
    pub(crate) fn row(degrees: f64) -> usize {
        (degrees.max(0.0) as usize).min(Self::INCIDENCES - 1)
    }

    /// The reflectance in a row.
    pub(crate) fn reflectance(&self, row: usize) -> f64 {
        self.reflectance[row]
    }

    /// The azimuth and the elevation in radians of a reflected (or transmitted) direction in a row above 0, for a uniform
    /// random number; `None` if the table has none.
    pub(crate) fn sample(&self, is_reflected: bool, row: usize, u: f64) -> Option<[f64; 2]> {
        let block = if is_reflected {
            *self.blocks[0].get(row.checked_sub(1)?)?
        } else {
            *self.blocks[1].get(row)?
        };
        let number = ((u * self.counts[block] as f64) as usize).min(self.counts[block].checked_sub(1)?);
        Some(self.samples[block * Self::SAMPLES + number].map(f64::from))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_are_those_of_the_angle() {
        let mut directions = vec![0f32; 7_240_000];
        // reflection at 2 degrees: the second block; two samples
        directions[40_000 + 100] = 0.5;
        directions[40_000 + 101] = 0.25;
        directions[40_000 + 39_999] = 1.0;
        // transmission at 3 degrees
        directions[3_640_000 + 3 * 40_000 + 1] = 2.0;
        let table = DavisTable::new(vec![0.5; 90], &directions).unwrap();
        assert_eq!(table.sample(true, 2, 0.3), Some([0.5, 0.25]));
        assert_eq!(table.sample(true, 2, 0.7), Some([0.0, 1.0]));
        assert_eq!(table.sample(true, 89, 0.7), Some([0.0, 1.0]));
        assert_eq!(table.sample(true, 0, 0.7), None);
        assert_eq!(table.sample(false, 3, 0.7), Some([0.0, 2.0]));
        assert_eq!(table.sample(false, 80, 0.1), Some([0.0, 2.0]));
        assert_eq!([0.0, 0.99, 1.0, 89.9, 90.0].map(DavisTable::row), [0, 0, 1, 89, 89]);
    }

    #[test]
    fn unusable_tables_are_refused() {
        let refused = |reflectance: Vec<f64>, directions: &[f32]| {
            DavisTable::new(reflectance, directions).unwrap_err().to_string()
        };
        assert!(refused(vec![0.5; 89], &[]).contains("it has 89 reflectances, 90 are needed"));
        assert!(refused(vec![1.5; 90], &[]).contains("the reflectance at 0 degrees is 1.5"));
        assert!(refused(vec![0.5; 90], &[0.0; 8]).contains("8 values of directions, 7240000 are needed"));
        let mut directions = vec![0.0; 7_240_000];
        assert!(refused(vec![0.5; 90], &directions).contains("all of its directions are 0"));
        directions[5] = f32::INFINITY;
        assert!(refused(vec![0.5; 90], &directions).contains("the value 5 of directions is inf"));
    }
}
