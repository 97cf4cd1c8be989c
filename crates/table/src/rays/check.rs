//! Validation of rows.

use super::columns::{COLUMNS, Present, RAY_COLUMNS, Row};
use super::problems::{ProblemList, RayLocation};

/// The maximal magnitude of a number, and the inverse of the minimal magnitude of a direction: squares of these and of
/// their inverses stay well within the range of f64.
const MAX_MAGNITUDE: f64 = 1e100;

/// Reports all numbers out of range; true if the row is valid.
pub(super) fn check_row(
    row: &Row,
    present: &Present,
    location: RayLocation,
    problems: &mut ProblemList,
) -> bool {
    let is_ray = check_ray(&row[..RAY_COLUMNS.len()], location, problems);
    let is_light = check_light(row, present, location, problems);
    is_ray && is_light
}

/// Reports an invalid wavelength or power; true if both are valid.
fn check_light(row: &Row, present: &Present, location: RayLocation, problems: &mut ProblemList) -> bool {
    let [wavelength, power] = [6, 7];
    let is_valid = |column: usize| match column == wavelength {
        true => row[column] > 0.0 && row[column].is_finite(),
        false => row[column] >= 0.0 && row[column].is_finite(),
    };
    let invalid = [wavelength, power].into_iter().filter(|&column| present[column] && !is_valid(column));
    let invalid: Vec<usize> = invalid.collect();
    for &column in &invalid {
        let range = if column == wavelength { "positive" } else { "nonnegative" };
        let message = format!("{} is {}: it must be finite and {range}.", COLUMNS[column], row[column]);
        problems.add(location.problem(Some(column), message));
    }
    invalid.is_empty()
}

/// Reports all numbers that are not finite or too large, and a direction that is zero or too small; true if the ray is valid.
fn check_ray(ray: &[f64], location: RayLocation, problems: &mut ProblemList) -> bool {
    let in_range = |x: &f64| (-MAX_MAGNITUDE..=MAX_MAGNITUDE).contains(x);
    let longest = ray[3..].iter().fold(0.0f64, |most, x| most.max(x.abs()));
    let is_in_range = ray.iter().all(in_range);
    if is_in_range && longest >= 1.0 / MAX_MAGNITUDE {
        return true;
    }
    for (column, x) in ray.iter().enumerate().filter(|(_, x)| !in_range(x)) {
        let name = RAY_COLUMNS[column];
        let message = match () {
            () if x.is_nan() => format!("{name} is NaN: a ray is six finite numbers."),
            () if x.is_infinite() => format!("{name} is infinite: a ray is six finite numbers."),
            () => {
                format!("{name} is {x:e}: numbers beyond 1e100 overflow in computations. Use a larger unit.")
            }
        };
        problems.add(location.problem(Some(column), message));
    }
    if is_in_range {
        let message = match longest {
            0.0 => "dx, dy and dz are all 0: a direction must be a nonzero vector.",
            _ => {
                "dx, dy and dz are all below 1e-100: the square of the direction underflows. Give it a length near 1."
            }
        };
        problems.add(location.problem(None, message.into()));
    }
    false
}
