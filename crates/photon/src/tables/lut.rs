//! Distributions of reflected light by angle of incidence: the tables of the `LUT` model.

use super::rows::nearest_rows;
use super::text::read_numbers;
use crate::error::PhotonError;
use std::path::Path;

/// The distribution of the reflected direction for each degree of the angle of incidence.
///
/// *Source*: `G4OpBoundaryProcess::DielectricLUT` of Geant4 11. It selects a bin of the two angles uniformly among the
/// first 44 and 36 and accepts it with the probability in the table; this table has the same distribution by bin.
#[derive(Clone, Debug)]
pub struct LutTable {
    /// The sums of the probabilities up to each bin, by angle of incidence.
    cumulative: Vec<f64>,
    /// The row of each angle of incidence.
    rows: Vec<usize>,
}

impl LutTable {
    /// The number of angles of incidence: 0 to 90 degrees.
    pub const INCIDENCES: usize = 91;
    /// The number of angles theta: -90 to 86 degrees in steps of 4.
    pub const THETAS: usize = 45;
    /// The number of angles phi: -90 to 90 degrees in steps of 5.
    pub const PHIS: usize = 37;

    /// The bins that Geant4 uses: it leaves out the last angle of each kind.
    const USED: [usize; 2] = [Self::THETAS - 1, Self::PHIS - 1];

    /// A table of probabilities, of shape (37, 45, 91): phi, theta, angle of incidence. Values beyond 0 to 1 count as the
    /// nearest of these. An angle of incidence without any direction takes the distribution of the nearest angle that
    /// has one.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for another number of values, NaN, or a table without any direction.
    pub fn new(values: &[f64]) -> Result<LutTable, PhotonError> {
        let count = Self::INCIDENCES * Self::THETAS * Self::PHIS;
        if values.len() != count {
            let problem = format!("the LUT table has {} values", values.len());
            return Err(PhotonError::setting(problem, format!("{count} are needed")));
        }
        if let Some(k) = values.iter().position(|value| value.is_nan()) {
            return Err(PhotonError::setting("the LUT table is invalid", format!("the value {k} is NaN")));
        }
        let [thetas, phis] = Self::USED;
        let mut cumulative = Vec::with_capacity(Self::INCIDENCES * thetas * phis);
        let mut filled = Vec::with_capacity(Self::INCIDENCES);
        for incidence in 0..Self::INCIDENCES {
            let mut sum = 0.0;
            for phi in 0..phis {
                for theta in 0..thetas {
                    sum +=
                        values[incidence + Self::INCIDENCES * (theta + Self::THETAS * phi)].clamp(0.0, 1.0);
                    cumulative.push(sum);
                }
            }
            filled.push(sum > 0.0);
        }
        let rows = nearest_rows(&filled).ok_or_else(|| {
            PhotonError::setting("the LUT table has no directions", "all of its probabilities are 0")
        })?;
        Ok(LutTable { cumulative, rows })
    }

    /// Reads a file of the data set: 151,515 numbers, of which the angle of incidence varies fastest. A file with the
    /// extension `.z` is decompressed, and read in place of an absent one.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for files that cannot be read, and for those of [`LutTable::new`].
    pub fn read(path: &Path) -> Result<LutTable, PhotonError> {
        LutTable::new(&read_numbers(path, Self::INCIDENCES * Self::THETAS * Self::PHIS)?)
    }

    /// The angles theta and phi in radians of a reflected direction, for an angle of incidence in degrees and a uniform
    /// random number.
    pub(crate) fn sample(&self, degrees: f64, u: f64) -> [f64; 2] {
        let [thetas, phis] = Self::USED;
        let row = self.rows[(libm::rint(degrees) as usize).min(Self::INCIDENCES - 1)];
        let sums = &self.cumulative[row * thetas * phis..][..thetas * phis];
        let wanted = u * sums[sums.len() - 1];
        let bin = sums.partition_point(|sum| *sum <= wanted).min(sums.len() - 1);
        [-90.0 + 4.0 * (bin % thetas) as f64, -90.0 + 5.0 * (bin / thetas) as f64].map(f64::to_radians)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(incidence: usize, theta: usize, phi: usize) -> usize {
        incidence + 91 * (theta + 45 * phi)
    }

    #[test]
    fn bins_have_their_probabilities() {
        let mut values = vec![0.0; 91 * 45 * 37];
        values[at(30, 10, 20)] = 0.25;
        values[at(30, 20, 5)] = 0.75;
        // never used: the last theta
        values[at(30, 44, 5)] = 1.0;
        let table = LutTable::new(&values).unwrap();
        let expected = |theta: f64, phi: f64| [theta, phi].map(f64::to_radians);
        // by phi first: the bin of phi 5 comes before that of phi 20
        assert_eq!(table.sample(30.4, 0.74), expected(-10.0, -65.0));
        assert_eq!(table.sample(29.6, 0.76), expected(-50.0, 10.0));
        // rows without directions
        assert_eq!(table.sample(90.0, 0.74), expected(-10.0, -65.0));
        assert_eq!(table.sample(0.0, 0.999_999), expected(-50.0, 10.0));
    }

    #[test]
    fn unusable_tables_are_refused() {
        assert!(LutTable::new(&[1.0; 7]).unwrap_err().to_string().contains("151515 are needed"));
        let mut values = vec![0.5; 151_515];
        values[7] = f64::NAN;
        assert!(LutTable::new(&values).unwrap_err().to_string().contains("the value 7 is NaN"));
        let dark = LutTable::new(&vec![0.0; 151_515]).unwrap_err().to_string();
        assert!(dark.contains("all of its probabilities are 0"), "{dark}");
    }
}
