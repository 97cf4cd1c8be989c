//! Properties of materials and surfaces as functions of the photon energy.

use crate::error::PropertyError;

/// The product of Planck's constant and the speed of light, in MeV nm (CODATA 2018, exact constants).
pub const HC_MEV_NM: f64 = 1.239_841_984_332_002_6e-3;

/// The speed of light in vacuum, in mm/ns (exact).
pub const LIGHT_SPEED: f64 = 299.792_458;

/// The wavelength in nm of a photon of an energy in MeV, and the other way round.
#[must_use]
pub fn wavelength_nm(energy: f64) -> f64 {
    HC_MEV_NM / energy
}

/// The number of points up to which a table is searched point by point.
const SHORT: usize = 16;

/// A function of the photon energy: linear between its points, constant beyond its ends (as Geant4's
/// `G4MaterialPropertyVector`).
#[derive(Clone, Debug, PartialEq)]
pub struct PropertyTable {
    energies: Vec<f64>,
    values: Vec<f64>,
    /// True if all values are equal: there is nothing to look up.
    is_constant: bool,
}

/// A linear function of the energy: the value and the energy at its start, and its rise over a width.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece {
    start: f64,
    width: f64,
    value: f64,
    rise: f64,
}

impl Piece {
    /// Start, width, value and rise.
    #[cfg(feature = "gpu")]
    pub fn numbers(&self) -> [f64; 4] {
        [self.start, self.width, self.value, self.rise]
    }

    #[inline]
    pub fn at(&self, energy: f64) -> f64 {
        // a sum in this case too, which is never -0
        let rise = if self.rise == 0.0 { 0.0 } else { self.rise * ((energy - self.start) / self.width) };
        self.value + rise
    }
}

/// The number of energies, in ascending order, up to the given one.
#[inline]
pub(crate) fn interval(energies: &[f64], energy: f64) -> usize {
    match energies.len() {
        // without branches that depend on the energy
        ..=SHORT => energies.iter().map(|&e| usize::from(e <= energy)).sum(),
        _ => energies.partition_point(|&e| e <= energy),
    }
}

impl PropertyTable {
    /// A table of (energy in MeV, value) points in any order. Two points of equal energy make a step: the second one
    /// holds at the energy itself.
    ///
    /// # Errors
    ///
    /// No points, an energy that is not positive and finite, a value that is not finite.
    pub fn new(mut points: Vec<(f64, f64)>) -> Result<PropertyTable, PropertyError> {
        if points.is_empty() {
            return Err(PropertyError::Empty);
        }
        for (index, &(energy, value)) in points.iter().enumerate() {
            if !(energy > 0.0 && energy.is_finite()) {
                return Err(PropertyError::Energy { index, energy });
            }
            if !value.is_finite() {
                return Err(PropertyError::Value { index, value });
            }
        }
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (energies, values) = points.into_iter().unzip();
        Ok(PropertyTable::from_columns(energies, values))
    }

    /// A table of as many values as energies, in ascending order of these; at least one.
    fn from_columns(energies: Vec<f64>, values: Vec<f64>) -> PropertyTable {
        let is_constant = values.iter().all(|value| *value == values[0]);
        PropertyTable { energies, values, is_constant }
    }

    /// The value at an energy in MeV.
    #[must_use]
    #[inline]
    pub fn at(&self, energy: f64) -> f64 {
        if self.is_constant { self.values[0] } else { self.interpolated(energy) }
    }

    fn interpolated(&self, energy: f64) -> f64 {
        self.piece(energy).at(energy)
    }

    /// The linear piece of the function at an energy.
    pub(crate) fn piece(&self, energy: f64) -> Piece {
        let flat = |value: f64| Piece { start: 0.0, width: 1.0, value, rise: 0.0 };
        match interval(&self.energies, energy) {
            0 => flat(self.values[0]),
            n if n == self.energies.len() => flat(self.values[n - 1]),
            n => {
                let [e0, e1] = [self.energies[n - 1], self.energies[n]];
                let [v0, v1] = [self.values[n - 1], self.values[n]];
                Piece { start: e0, width: e1 - e0, value: v0, rise: v1 - v0 }
            }
        }
    }

    /// True if all values are equal.
    pub(crate) fn is_constant(&self) -> bool {
        self.is_constant
    }

    /// A constant.
    #[must_use]
    pub fn constant(value: f64) -> PropertyTable {
        PropertyTable::from_columns(vec![1e-6], vec![value])
    }

    /// A table at the same energies with other values.
    pub(crate) fn mapped(&self, values: Vec<f64>) -> PropertyTable {
        PropertyTable::from_columns(self.energies.clone(), values)
    }

    /// The energies in MeV, ascending.
    #[must_use]
    pub fn energies(&self) -> &[f64] {
        &self.energies
    }

    /// The value at each of the energies.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}

/// The group velocity in mm/ns of a refractive index: c / (n + dn / d ln E) at the ends of the table from its
/// outermost intervals, between them at the mean energy and index of the inner points; c / n where that is
/// negative or larger (`G4MaterialPropertiesTable::CalculateGROUPVEL` of Geant4 11.4).
#[must_use]
pub fn group_velocity(index: &PropertyTable) -> PropertyTable {
    // of a step the upper value
    let points: Vec<(f64, f64)> = index.energies.iter().copied().zip(index.values.iter().copied()).collect();
    let is_last_of_step = |k: &usize| points.get(k + 1).is_none_or(|next| next.0 > points[*k].0);
    let (energies, values): (Vec<f64>, Vec<f64>) =
        (0..points.len()).filter(is_last_of_step).map(|k| points[k]).unzip();
    let last = energies.len() - 1;
    if last == 0 {
        let values = vec![LIGHT_SPEED / values[0]];
        return PropertyTable::from_columns(energies, values);
    }
    let speed = |n: f64, k: usize| {
        let slope = (values[k + 1] - values[k]) / libm::log(energies[k + 1] / energies[k]);
        let group = LIGHT_SPEED / (n + slope);
        if group < 0.0 || group > LIGHT_SPEED / n { LIGHT_SPEED / n } else { group }
    };
    let (mut middles, mut speeds) = (vec![energies[0]], vec![speed(values[0], 0)]);
    for k in 0..last - 1 {
        middles.push(0.5 * (energies[k] + energies[k + 1]));
        speeds.push(speed(0.5 * (values[k] + values[k + 1]), k));
    }
    middles.push(energies[last]);
    speeds.push(speed(values[last], last - 1));
    PropertyTable::from_columns(middles, speeds)
}

/// The cumulative distribution of an emission spectrum, by the trapezoidal rule and linear between its points, as in Geant4
/// (`BuildPhysicsTable` of `G4Scintillation` and `G4OpWLS`): the density between two points of the table is constant, the
/// mean of their values.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrum {
    energies: Vec<f64>,
    /// The values of the table.
    values: Vec<f64>,
    /// The integral from the first energy to each energy.
    cumulative: Vec<f64>,
}

impl Spectrum {
    /// The distribution whose density is a table.
    ///
    /// # Errors
    ///
    /// A negative value, or a spectrum without any intensity.
    pub fn new(density: &PropertyTable) -> Result<Spectrum, PropertyError> {
        if let Some((index, &value)) = density.values.iter().enumerate().find(|(_, value)| **value < 0.0) {
            return Err(PropertyError::Negative { index, value });
        }
        let mut cumulative = vec![0.0];
        for k in 1..density.energies.len() {
            let area = 0.5
                * (density.values[k] + density.values[k - 1])
                * (density.energies[k] - density.energies[k - 1]);
            cumulative.push(cumulative[k - 1] + area);
        }
        match cumulative.last() {
            Some(total) if *total > 0.0 => {
                let (energies, values) = (density.energies.clone(), density.values.clone());
                Ok(Spectrum { energies, values, cumulative })
            }
            _ => Err(PropertyError::Dark),
        }
    }

    /// The energies of the table in MeV, ascending.
    #[must_use]
    pub fn energies(&self) -> &[f64] {
        &self.energies
    }

    /// The values of the table.
    #[must_use]
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The energies, and the integral from the first of them to each.
    #[cfg(feature = "gpu")]
    pub(crate) fn columns(&self) -> [&[f64]; 2] {
        [&self.energies, &self.cumulative]
    }

    /// The energy below which a fraction of the spectrum lies that is cut at an energy; linear in the
    /// cumulative distribution between its points, as in Geant4. `None` if nothing lies below the cut.
    #[must_use]
    pub fn quantile(&self, fraction: f64, cut: f64) -> Option<f64> {
        let total = interpolate(&self.energies, &self.cumulative, cut);
        let energy = interpolate(&self.cumulative, &self.energies, fraction * total);
        (total > 0.0).then_some(energy)
    }
}

/// Linear interpolation of y at x; x ascending, constant beyond the ends.
fn interpolate(xs: &[f64], ys: &[f64], x: f64) -> f64 {
    let after = xs.partition_point(|&at| at <= x);
    match after {
        0 => ys[0],
        n if n == xs.len() => ys[n - 1],
        n => ys[n - 1] + (ys[n] - ys[n - 1]) * ((x - xs[n - 1]) / (xs[n] - xs[n - 1])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(points: &[(f64, f64)]) -> PropertyTable {
        PropertyTable::new(points.to_vec()).unwrap()
    }

    #[test]
    fn values_are_interpolated_and_clamped() {
        let table = table(&[(4e-6, 1.5), (2e-6, 1.3)]);
        assert_eq!([1e-6, 2e-6, 4e-6, 9e-6].map(|energy| table.at(energy)), [1.3, 1.3, 1.5, 1.5]);
        assert!((table.at(3e-6) - 1.4).abs() < 1e-15);
    }

    #[test]
    fn bad_tables_are_refused() {
        let refused = |points: &[(f64, f64)]| PropertyTable::new(points.to_vec()).unwrap_err().to_string();
        assert!(refused(&[]).contains("no points"));
        assert!(refused(&[(0.0, 1.0)]).contains("positive"));
        assert!(refused(&[(1.0, f64::NAN)]).contains("NaN"));
        let step = table(&[(1.0, 1.0), (2.0, 1.0), (2.0, 3.0), (4.0, 3.0)]);
        assert_eq!([1.999_999, 2.0, 3.0].map(|energy| step.at(energy)), [1.0, 3.0, 3.0]);
    }

    /// A linear index n(E) = 1.3 + 0.05 E / eV from 2 to 4 eV, evaluated by hand.
    #[test]
    fn the_group_velocity_follows_the_index() {
        let flat = group_velocity(&table(&[(2e-6, 1.5), (4e-6, 1.5)]));
        assert_eq!(flat.values(), [LIGHT_SPEED / 1.5; 2]);
        let rising = group_velocity(&table(&[(2e-6, 1.4), (3e-6, 1.45), (4e-6, 1.5)]));
        assert_eq!(rising.energies(), [2e-6, 0.5 * (2e-6 + 3e-6), 4e-6]);
        let slope = [0.05 / libm::log(1.5), 0.05 / libm::log(4.0 / 3.0)];
        let expected = [1.4 + slope[0], 1.425 + slope[0], 1.5 + slope[1]].map(|n| LIGHT_SPEED / n);
        for (value, expected) in rising.values().iter().zip(expected) {
            assert!((value - expected).abs() < 1e-12, "{value} {expected}");
        }
        // an index that falls: the formula exceeds c / n, which is taken instead
        let falling = group_velocity(&table(&[(2e-6, 1.5), (4e-6, 1.4)]));
        assert_eq!(falling.values(), [LIGHT_SPEED / 1.5, LIGHT_SPEED / 1.4]);
    }

    #[test]
    fn a_spectrum_is_sampled_by_its_quantiles() {
        let spectrum = Spectrum::new(&table(&[(2e-6, 1.0), (4e-6, 1.0)])).unwrap();
        assert!((spectrum.quantile(0.25, 1.0).unwrap() - 2.5e-6).abs() < 1e-18);
        // a triangle: each side has its area at a constant density, so that its quantiles are linear in the fraction
        let triangle = Spectrum::new(&table(&[(2.5e-6, 0.0), (2.9e-6, 1.0), (3.4e-6, 0.0)])).unwrap();
        // 4/9 of the area lie below 2.9 eV
        for (fraction, energy) in [(2.0 / 9.0, 2.7e-6), (4.0 / 9.0, 2.9e-6), (6.5 / 9.0, 3.15e-6)] {
            assert!((triangle.quantile(fraction, 1.0).unwrap() - energy).abs() < 1e-18, "{energy}");
        }
        // cut at 3 eV: the lower half is left
        assert!((spectrum.quantile(0.5, 3e-6).unwrap() - 2.5e-6).abs() < 1e-18);
        assert_eq!(spectrum.quantile(0.5, 1e-6), None);
        let dark = Spectrum::new(&table(&[(2e-6, 0.0), (4e-6, 0.0)])).unwrap_err();
        assert!(dark.to_string().contains("no intensity"));
    }
}
