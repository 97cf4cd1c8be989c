//! Refractivities of dry air and of water vapour (P. E. Ciddor, Appl. Opt. 35, 1566, 1996; numbers
//! of equations are Ciddor's).

/// n - 1 of standard air at a wavelength in µm (eq. 1).
fn standard_air(square_um: f64) -> f64 {
    let sigma2 = 1.0 / square_um;
    1e-8 * (5_792_105.0 / (238.0185 - sigma2) + 167_917.0 / (57.362 - sigma2))
}

/// n - 1 of water vapour at 20 °C and 1333 Pa (eq. 3).
fn standard_vapour(square_um: f64) -> f64 {
    let sigma2 = 1.0 / square_um;
    let polynomial = 295.235 + sigma2 * (2.6422 + sigma2 * (-0.032380 + sigma2 * 0.004028));
    1.022e-8 * polynomial
}

/// n of air with these densities relative to standard air and standard vapour (eq. 5).
pub(super) fn air_index(dry: f64, vapour: f64, square_um: f64) -> f64 {
    1.0 + (dry * standard_air(square_um) + vapour * standard_vapour(square_um))
}
