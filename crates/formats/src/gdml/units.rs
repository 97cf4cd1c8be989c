//! Units and constants in Geant4's system: millimetres, nanoseconds, MeV, elementary charge, kelvin.
//!
//! Source: G. Barrand et al., CLHEP, `Evaluator/setSystemOfUnits` and `setStdMath`; the joule uses the elementary charge
//! 1.602176634e-19 C (SI 2019), as Geant4 does since release 10.6.

const PI: f64 = std::f64::consts::PI;
const METRE: f64 = 1e3;
const MM: f64 = 1.0;
const SECOND: f64 = 1e9;
const COULOMB: f64 = 1.0 / 1.602176634e-19;
const JOULE: f64 = 1e-6 / 1.602176634e-19;
const KILOGRAM: f64 = JOULE * SECOND * SECOND / (METRE * METRE);
const AMPERE: f64 = COULOMB / SECOND;
const VOLT: f64 = JOULE / COULOMB;
const NEWTON: f64 = JOULE / METRE;
const PASCAL: f64 = NEWTON / (METRE * METRE);
const TESLA: f64 = VOLT * SECOND / (METRE * METRE);

/// The physical quantity of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Length,
    Angle,
    Other,
}

use Quantity::{Angle, Length, Other};

const TABLE: &[(&str, f64, Quantity)] = &[
    ("pi", PI, Other),
    ("e", std::f64::consts::E, Other),
    ("gamma", 0.577_215_664_901_532_9, Other),
    ("m", METRE, Length),
    ("meter", METRE, Length),
    ("metre", METRE, Length),
    ("km", 1e3 * METRE, Length),
    ("kilometer", 1e3 * METRE, Length),
    ("kilometre", 1e3 * METRE, Length),
    ("cm", 10.0 * MM, Length),
    ("centimeter", 10.0 * MM, Length),
    ("centimetre", 10.0 * MM, Length),
    ("mm", MM, Length),
    ("millimeter", MM, Length),
    ("millimetre", MM, Length),
    ("um", 1e-3 * MM, Length),
    ("micron", 1e-3 * MM, Length),
    ("micrometer", 1e-3 * MM, Length),
    ("micrometre", 1e-3 * MM, Length),
    ("nm", 1e-6 * MM, Length),
    ("nanometer", 1e-6 * MM, Length),
    ("nanometre", 1e-6 * MM, Length),
    ("angstrom", 1e-7 * MM, Length),
    ("Ang", 1e-7 * MM, Length),
    ("fermi", 1e-12 * MM, Length),
    ("fm", 1e-12 * MM, Length),
    ("inch", 25.4 * MM, Length),
    ("in", 25.4 * MM, Length),
    ("ft", 304.8 * MM, Length),
    ("foot", 304.8 * MM, Length),
    ("rad", 1.0, Angle),
    ("radian", 1.0, Angle),
    ("mrad", 1e-3, Angle),
    ("milliradian", 1e-3, Angle),
    ("deg", PI / 180.0, Angle),
    ("degree", PI / 180.0, Angle),
    ("sr", 1.0, Other),
    ("steradian", 1.0, Other),
    ("m2", METRE * METRE, Other),
    ("cm2", 100.0, Other),
    ("mm2", 1.0, Other),
    ("m3", METRE * METRE * METRE, Other),
    ("cm3", 1e3, Other),
    ("mm3", 1.0, Other),
    ("L", 1e6, Other),
    ("liter", 1e6, Other),
    ("litre", 1e6, Other),
    ("barn", 1e-22, Other),
    ("millibarn", 1e-25, Other),
    ("s", SECOND, Other),
    ("second", SECOND, Other),
    ("ms", 1e-3 * SECOND, Other),
    ("millisecond", 1e-3 * SECOND, Other),
    ("us", 1e-6 * SECOND, Other),
    ("microsecond", 1e-6 * SECOND, Other),
    ("ns", 1e-9 * SECOND, Other),
    ("nanosecond", 1e-9 * SECOND, Other),
    ("ps", 1e-12 * SECOND, Other),
    ("picosecond", 1e-12 * SECOND, Other),
    ("Hz", 1.0 / SECOND, Other),
    ("hertz", 1.0 / SECOND, Other),
    ("eV", 1e-6, Other),
    ("electronvolt", 1e-6, Other),
    ("keV", 1e-3, Other),
    ("kiloelectronvolt", 1e-3, Other),
    ("MeV", 1.0, Other),
    ("megaelectronvolt", 1.0, Other),
    ("GeV", 1e3, Other),
    ("gigaelectronvolt", 1e3, Other),
    ("TeV", 1e6, Other),
    ("PeV", 1e9, Other),
    ("J", JOULE, Other),
    ("joule", JOULE, Other),
    ("W", JOULE / SECOND, Other),
    ("watt", JOULE / SECOND, Other),
    ("kg", KILOGRAM, Other),
    ("kilogram", KILOGRAM, Other),
    ("g", 1e-3 * KILOGRAM, Other),
    ("gram", 1e-3 * KILOGRAM, Other),
    ("mg", 1e-6 * KILOGRAM, Other),
    ("milligram", 1e-6 * KILOGRAM, Other),
    ("N", NEWTON, Other),
    ("newton", NEWTON, Other),
    ("Pa", PASCAL, Other),
    ("pascal", PASCAL, Other),
    ("bar", 1e5 * PASCAL, Other),
    ("atm", 101_325.0 * PASCAL, Other),
    ("atmosphere", 101_325.0 * PASCAL, Other),
    ("C", COULOMB, Other),
    ("coulomb", COULOMB, Other),
    ("A", AMPERE, Other),
    ("ampere", AMPERE, Other),
    ("V", VOLT, Other),
    ("volt", VOLT, Other),
    ("kV", 1e3 * VOLT, Other),
    ("T", TESLA, Other),
    ("tesla", TESLA, Other),
    ("G", 1e-4 * TESLA, Other),
    ("gauss", 1e-4 * TESLA, Other),
    ("kG", 0.1 * TESLA, Other),
    ("K", 1.0, Other),
    ("kelvin", 1.0, Other),
    ("mol", 1.0, Other),
    ("mole", 1.0, Other),
    ("Bq", 1.0 / SECOND, Other),
    ("becquerel", 1.0 / SECOND, Other),
    ("cd", 1.0, Other),
    ("candela", 1.0, Other),
];

/// Value of a unit or a constant.
pub(super) fn value(name: &str) -> Option<f64> {
    row(name).map(|row| row.1)
}

/// Value of a unit of length or angle.
pub(super) fn of(quantity: Quantity, name: &str) -> Option<f64> {
    row(name).filter(|row| row.2 == quantity).map(|row| row.1)
}

/// Names of all units and constants.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    TABLE.iter().map(|row| row.0)
}

/// Names of the units of one quantity.
pub(super) fn names_of(quantity: Quantity) -> impl Iterator<Item = &'static str> {
    TABLE.iter().filter(move |row| row.2 == quantity).map(|row| row.0)
}

fn row(name: &str) -> Option<&'static (&'static str, f64, Quantity)> {
    TABLE.iter().find(|row| row.0 == name)
}

/// Value of the default unit of densities, g/cm3.
pub(super) const GRAM_PER_CM3: f64 = 1e-3 * KILOGRAM / 1e3;
/// Value of the default unit of pressures, Pa.
pub(super) const PA: f64 = PASCAL;
