//! Tables against wavelength, with linear interpolation.

use super::DispersionError;

/// A quantity as a function of wavelength, interpolated linearly as refractiveindex.info and most ray tracers do.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Increasing.
    wavelengths_nm: Vec<f64>,
    values: Vec<f64>,
}

impl Table {
    /// A table of pairs (wavelength in nanometres, value), in any order.
    ///
    /// # Errors
    /// The table is empty, a wavelength is not positive, a number is not finite, or a wavelength
    /// occurs twice with different values.
    pub fn new(mut pairs: Vec<(f64, f64)>) -> Result<Table, DispersionError> {
        let fits = |&&(wavelength, value): &&(f64, f64)| {
            wavelength > 0.0 && wavelength.is_finite() && value.is_finite()
        };
        if let Some(&(wavelength_nm, value)) = pairs.iter().find(|pair| !fits(pair)) {
            return Err(DispersionError::Entry { wavelength_nm, value });
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        pairs.dedup();
        if let Some(pair) = pairs.windows(2).find(|pair| pair[0].0 == pair[1].0) {
            return Err(DispersionError::Twice { wavelength_nm: pair[0].0, values: [pair[0].1, pair[1].1] });
        }
        if pairs.is_empty() {
            return Err(DispersionError::Empty);
        }
        let (wavelengths_nm, values) = pairs.into_iter().unzip();
        Ok(Table { wavelengths_nm, values })
    }

    /// The shortest and the longest wavelength in nanometres.
    pub fn range_nm(&self) -> [f64; 2] {
        [self.wavelengths_nm[0], self.wavelengths_nm[self.wavelengths_nm.len() - 1]]
    }

    /// The value at a wavelength in nanometres; beyond the ends the value of the nearest end.
    pub fn at(&self, wavelength_nm: f64) -> f64 {
        let next = self.wavelengths_nm.partition_point(|&known| known <= wavelength_nm);
        if next == 0 || next == self.values.len() {
            return self.values[next.saturating_sub(1)];
        }
        let [left, right] = [self.wavelengths_nm[next - 1], self.wavelengths_nm[next]];
        let part = (wavelength_nm - left) / (right - left);
        self.values[next - 1] * (1.0 - part) + self.values[next] * part
    }

    /// The pairs (wavelength in nanometres, value), in order of increasing wavelength.
    pub fn pairs(&self) -> impl Iterator<Item = (f64, f64)> {
        self.wavelengths_nm.iter().copied().zip(self.values.iter().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn straight_lines_between_entries_in_any_order() {
        let table = Table::new(vec![(700.0, 3.0), (500.0, 1.0), (600.0, 2.5)]).unwrap();
        assert_eq!(table.range_nm(), [500.0, 700.0]);
        assert_eq!(table.at(500.0), 1.0);
        assert_eq!(table.at(550.0), 1.75);
        assert_eq!(table.at(600.0), 2.5);
        assert_eq!(table.at(700.0), 3.0);
        assert_eq!([table.at(1.0), table.at(9000.0)], [1.0, 3.0]);
    }

    #[test]
    fn an_entry_may_be_repeated_but_not_contradicted() {
        assert!(Table::new(vec![(500.0, 1.0), (500.0, 1.0)]).is_ok());
        let error = Table::new(vec![(500.0, 1.0), (600.0, 1.0), (500.0, 2.0)]).unwrap_err();
        assert_eq!(error, DispersionError::Twice { wavelength_nm: 500.0, values: [1.0, 2.0] });
    }

    #[test]
    fn no_numbers_and_no_entries_are_refused() {
        assert_eq!(Table::new(vec![]), Err(DispersionError::Empty));
        for bad in [(f64::NAN, 1.0), (500.0, f64::INFINITY), (0.0, 1.0), (-1.0, 1.0)] {
            assert!(matches!(Table::new(vec![bad]), Err(DispersionError::Entry { .. })), "{bad:?}");
        }
    }
}
