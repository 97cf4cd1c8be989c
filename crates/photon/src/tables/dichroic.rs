//! Transmittance of a dichroic filter by wavelength and angle of incidence.

use super::text::read_numbers;
use crate::error::PhotonError;
use rayweave_error::Message;
use std::path::Path;

/// The transmittance of a filter at nodes of wavelength and angle of incidence; bilinear between them and constant beyond.
///
/// *Source*: `G4Physics2DVector::Value` and `G4OpBoundaryProcess::DielectricDichroic` of Geant4 11.
#[derive(Clone, Debug, PartialEq)]
pub struct DichroicTable {
    wavelengths: Vec<f64>,
    angles: Vec<f64>,
    /// In percent, by angle and within it by wavelength.
    percent: Vec<f64>,
}

/// The largest number of values of a file.
const MAX_VALUES: usize = 10_000_000;

impl DichroicTable {
    /// A table of the transmittance in percent, of shape (angles, wavelengths), at ascending wavelengths in nm and ascending
    /// angles of incidence in degrees.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for fewer than two nodes, nodes that are not finite or do not ascend, another number of values,
    /// and values beyond 0 to 100.
    pub fn new(
        wavelengths: Vec<f64>,
        angles: Vec<f64>,
        percent: Vec<f64>,
    ) -> Result<DichroicTable, PhotonError> {
        let refuse = |reason: String| Err(PhotonError::setting("the dichroic table is invalid", reason));
        for (name, nodes) in [("wavelengths", &wavelengths), ("angles", &angles)] {
            if nodes.len() < 2 {
                return refuse(format!("it has {} {name}, at least 2 are needed", nodes.len()));
            }
            if !nodes[0].is_finite() {
                return refuse(format!("the first of the {name} is {}: it must be finite", nodes[0]));
            }
            if let Some(k) = (1..nodes.len()).find(|&k| !(nodes[k - 1] < nodes[k] && nodes[k].is_finite())) {
                let [before, at] = [nodes[k - 1], nodes[k]];
                return refuse(format!("{at} follows {before} among the {name}, which must ascend"));
            }
        }
        let (count, needed) = (percent.len(), wavelengths.len() * angles.len());
        if count != needed {
            return refuse(format!("it has {count} values of transmittance, {needed} are needed"));
        }
        if let Some(k) = percent.iter().position(|value| !(0.0..=100.0).contains(value)) {
            let value = percent[k];
            return refuse(format!(
                "the value {k} of transmittance is {value} %: it must be from 0 to 100 %"
            ));
        }
        Ok(DichroicTable { wavelengths, angles, percent })
    }

    /// Reads a file in the format of Geant4: a number without meaning here (4), the numbers of wavelengths and angles, the
    /// wavelengths in nm, the angles in degrees, and for each angle the transmittance in percent at each wavelength.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for files that cannot be read, and for those of [`DichroicTable::new`].
    pub fn read(path: &Path) -> Result<DichroicTable, PhotonError> {
        let numbers: Vec<f64> = read_numbers(path, MAX_VALUES)?;
        let refuse = |reason: String| {
            let problem = format!("cannot read the dichroic table {}", path.display());
            PhotonError::Setting(Message::new(problem, reason))
        };
        let &[_, columns, rows, ref values @ ..] = numbers.as_slice() else {
            return Err(refuse("it has fewer than three numbers".to_owned()));
        };
        let is_count = |n: f64| n >= 2.0 && n.fract() == 0.0 && n <= MAX_VALUES as f64;
        if !is_count(columns) || !is_count(rows) {
            return Err(refuse(format!(
                "it states {columns} wavelengths and {rows} angles, at least 2 are needed"
            )));
        }
        let (columns, rows) = (columns as usize, rows as usize);
        let needed = columns + rows + columns * rows;
        if values.len() < needed {
            return Err(refuse(format!(
                "{} numbers follow the first three, {needed} are needed",
                values.len()
            )));
        }
        let (wavelengths, rest) = values.split_at(columns);
        let (angles, rest) = rest.split_at(rows);
        DichroicTable::new(wavelengths.to_vec(), angles.to_vec(), rest[..columns * rows].to_vec())
    }

    /// The transmittance, from 0 to 1, at a wavelength in nm and an angle of incidence in degrees, which is rounded to whole
    /// degrees.
    #[must_use]
    pub fn transmittance(&self, wavelength: f64, degrees: f64) -> f64 {
        let (i, x) = interval(&self.wavelengths, wavelength);
        let (j, y) = interval(&self.angles, (degrees + 0.5).floor());
        let at = |i: usize, j: usize| self.percent[j * self.wavelengths.len() + i];
        let along = |j: usize| at(i, j) + (at(i + 1, j) - at(i, j)) * x;
        0.01 * (along(j) + (along(j + 1) - along(j)) * y)
    }
}

/// The interval of ascending nodes that holds a value, and its fraction there, from 0 to 1.
fn interval(nodes: &[f64], value: f64) -> (usize, f64) {
    let k = nodes.partition_point(|node| *node <= value).clamp(1, nodes.len() - 1) - 1;
    (k, ((value - nodes[k]) / (nodes[k + 1] - nodes[k])).clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transmittance_is_bilinear_and_clamped() {
        let table =
            DichroicTable::new(vec![400.0, 500.0], vec![0.0, 60.0], vec![10.0, 30.0, 50.0, 90.0]).unwrap();
        // at 30 degrees the means of the two rows: 30 % and 60 %
        assert!((table.transmittance(425.0, 30.4) - 0.375).abs() < 1e-15);
        assert_eq!(table.transmittance(300.0, 0.2), 0.1);
        assert!((table.transmittance(900.0, 89.0) - 0.9).abs() < 1e-15);
    }

    #[test]
    fn bad_tables_are_refused() {
        let refused = |x: &[f64], y: &[f64], z: &[f64]| {
            DichroicTable::new(x.to_vec(), y.to_vec(), z.to_vec()).unwrap_err().to_string()
        };
        assert!(refused(&[1.0], &[0.0, 1.0], &[]).contains("it has 1 wavelengths"));
        let below = [f64::NEG_INFINITY, 1.0];
        assert!(refused(&below, &[0.0, 1.0], &[0.0; 4]).contains("the first of the wavelengths is -inf"));
        assert!(refused(&[2.0, 1.0], &[0.0, 1.0], &[]).contains("1 follows 2 among the wavelengths"));
        assert!(
            refused(&[1.0, 2.0], &[0.0, 1.0], &[0.0; 3]).contains("3 values of transmittance, 4 are needed")
        );
        assert!(refused(&[1.0, 2.0], &[0.0, 1.0], &[0.0, 0.0, 0.0, 101.0]).contains("the value 3"));
    }
}
