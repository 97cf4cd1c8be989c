//! Dispersion formulas against the formulas as printed, and against published indices.

use rayweave_optics::glass::{Dispersion, DispersionError, Table, line_nm};

const NM: [f64; 3] = [404.6561, 587.5618, 1529.582];

fn assert_close(actual: Option<f64>, expected: f64) {
    let actual = actual.unwrap();
    assert!((actual - expected).abs() < 1e-14 * expected.abs().max(1.0), "{actual} is not {expected}");
}

/// Compares indices at three wavelengths; the formula takes micrometres.
fn assert_formula(dispersion: &Dispersion, index: impl Fn(f64) -> f64) {
    for wavelength_nm in NM {
        assert_close(dispersion.index(wavelength_nm), index(wavelength_nm / 1000.0));
    }
}

#[test]
fn the_formulas_of_agf_are_as_printed() {
    let c = [2.3, -0.011, 0.013, 2e-4, -3e-6, 4e-7, 5e-8, -6e-9, 7e-10, 0.0];
    let agf = |number: u32, count: usize| Dispersion::agf(number, &c[..count]).unwrap();
    assert_formula(&agf(1, 6), |l| {
        let tail = c[4] * l.powf(-6.0) + c[5] * l.powf(-8.0);
        (c[0] + c[1] * l.powf(2.0) + c[2] * l.powf(-2.0) + c[3] * l.powf(-4.0) + tail).sqrt()
    });
    assert_formula(&agf(3, 6), |l| {
        let h = 1.0 / (l.powf(2.0) - 0.028);
        c[0] + c[1] * h + c[2] * h.powf(2.0) + c[3] * l.powf(2.0) + c[4] * l.powf(4.0) + c[5] * l.powf(6.0)
    });
    assert_formula(&agf(5, 3), |l| c[0] + c[1] / l + c[2] / l.powf(3.5));
    assert_formula(&agf(10, 8), |l| {
        let powers = [0.0, 2.0, -2.0, -4.0, -6.0, -8.0, -10.0, -12.0];
        (0..8).map(|i| c[i] * l.powf(powers[i])).sum::<f64>().sqrt()
    });
    assert_formula(&agf(12, 8), |l| {
        let powers = [0.0, 2.0, -2.0, -4.0, -6.0, -8.0, 4.0, 6.0];
        (0..8).map(|i| c[i] * l.powf(powers[i])).sum::<f64>().sqrt()
    });
    assert_formula(&agf(13, 10), |l| {
        let powers = [0.0, 2.0, 4.0, -2.0, -4.0, -6.0, -8.0, -10.0, -12.0];
        (0..9).map(|i| c[i] * l.powf(powers[i])).sum::<f64>().sqrt()
    });
}

#[test]
fn the_formulas_of_agf_with_poles_are_as_printed() {
    let c = [1.1, 0.011, 0.3, 0.021, 0.9, 98.0, 0.05, 0.03, 0.02, 0.04];
    let agf = |number: u32, count: usize| Dispersion::agf(number, &c[..count]).unwrap();
    for (number, terms) in [(2, 3), (6, 4), (11, 5)] {
        assert_formula(&agf(number, 2 * terms), |l| {
            let term = |i: usize| c[2 * i] * l.powf(2.0) / (l.powf(2.0) - c[2 * i + 1]);
            (1.0 + (0..terms).map(term).sum::<f64>()).sqrt()
        });
    }
    assert_formula(&agf(4, 5), |l| {
        let first = c[1] * l.powf(2.0) / (l.powf(2.0) - c[2].powf(2.0));
        (1.0 + c[0] + first + c[3] / (l.powf(2.0) - c[4].powf(2.0))).sqrt()
    });
    let c = [2.2, 0.013, 0.02, 0.011, 0.04];
    let agf = |number: u32, count: usize| Dispersion::agf(number, &c[..count]).unwrap();
    assert_formula(&agf(7, 4), |l| (c[0] + c[1] / (l.powf(2.0) - c[2]) - c[3] * l.powf(2.0)).sqrt());
    assert_formula(&agf(8, 4), |l| {
        (c[0] + c[1] * l.powf(2.0) / (l.powf(2.0) - c[2]) - c[3] * l.powf(2.0)).sqrt()
    });
    assert_formula(&agf(9, 5), |l| {
        let square = l.powf(2.0);
        (c[0] + c[1] * square / (square - c[2]) + c[3] * square / (square - c[4])).sqrt()
    });
}

#[test]
fn the_formulas_of_refractiveindex_info_are_as_printed() {
    let of = |number: u32, c: &[f64]| Dispersion::refractiveindex(number, c).unwrap();
    let c = [0.1, 0.9, 0.08, 0.4, 0.11, 0.9, 9.9];
    assert_formula(&of(1, &c), |l| {
        let term = |i: usize| c[i] * l.powf(2.0) / (l.powf(2.0) - c[i + 1].powf(2.0));
        (1.0 + c[0] + term(1) + term(3) + term(5)).sqrt()
    });
    assert_formula(&of(2, &c), |l| {
        let term = |i: usize| c[i] * l.powf(2.0) / (l.powf(2.0) - c[i + 1]);
        (1.0 + c[0] + term(1) + term(3) + term(5)).sqrt()
    });
    let c = [2.2, 0.01, -2.0, 3e-4, -4.0, -0.01, 2.0, 1e-3, 1.5];
    assert_formula(&of(3, &c), |l| {
        let term = |i: usize| c[i] * l.powf(c[i + 1]);
        (c[0] + term(1) + term(3) + term(5) + term(7)).sqrt()
    });
    assert_formula(&of(5, &c), |l| {
        let term = |i: usize| c[i] * l.powf(c[i + 1]);
        c[0] + term(1) + term(3) + term(5) + term(7)
    });
    let c = [2.2, 0.3, 2.0, 0.1, 2.0, 0.02, 0.0, 0.2, 1.5, -0.01, 2.0, 1e-3, 4.0];
    assert_formula(&of(4, &c), |l| {
        let term = |i: usize| c[i] * l.powf(c[i + 1]) / (l.powf(2.0) - c[i + 2].powf(c[i + 3]));
        (c[0] + term(1) + term(5) + c[9] * l.powf(c[10]) + c[11] * l.powf(c[12])).sqrt()
    });
    let c = [1.45, 0.01, 1e-4, -0.003, 2e-5, -1e-6];
    assert_formula(&of(7, &c), |l| {
        let h = 1.0 / (l.powf(2.0) - 0.028);
        c[0] + c[1] * h + c[2] * h.powf(2.0) + c[3] * l.powf(2.0) + c[4] * l.powf(4.0) + c[5] * l.powf(6.0)
    });
    let c = [0.4, 0.1, 0.05, -0.002];
    assert_formula(&of(8, &c), |l| {
        let q = c[0] + c[1] * l.powf(2.0) / (l.powf(2.0) - c[2]) + c[3] * l.powf(2.0);
        ((1.0 + 2.0 * q) / (1.0 - q)).sqrt()
    });
    let c = [2.5, 0.014, 0.02, 0.03, 0.25, 0.4];
    assert_formula(&of(9, &c), |l| {
        let shifted = l - c[4];
        (c[0] + c[1] / (l.powf(2.0) - c[2]) + c[3] * shifted / (shifted.powf(2.0) + c[5])).sqrt()
    });
}

/// P. E. Ciddor, Appl. Opt. 35, 1566 (1996), eq. 1, in its units: (n - 1) 10⁸ for dry air at 15 °C, 101 325 Pa, 450 ppm CO₂.
#[test]
fn the_formula_of_gases_gives_ciddors_air() {
    let air = Dispersion::refractiveindex(6, &[0.0, 0.05792105, 238.0185, 0.00167917, 57.362]).unwrap();
    let excess = (air.index(633.0).unwrap() - 1.0) * 1e8;
    let sigma2 = 1.0 / (0.633f64 * 0.633);
    let expected = 5_792_105.0 / (238.0185 - sigma2) + 167_917.0 / (57.362 - sigma2);
    assert!((excess - expected).abs() < 1e-3, "{excess}");
}

/// I. H. Malitson, J. Opt. Soc. Am. 55, 1205 (1965), table I, computed values.
#[test]
fn malitsons_fused_silica_has_the_indices_of_his_table() {
    let c = [0.0, 0.6961663, 0.0684043, 0.4079426, 0.1162414, 0.8974794, 9.896161];
    let silica = Dispersion::refractiveindex(1, &c).unwrap();
    for (line, published) in [("h", 1.46962), ("g", 1.46669), ("e", 1.46008), ("C", 1.45637)] {
        let index = silica.index(line_nm(line).unwrap()).unwrap();
        assert!((index - published).abs() < 6e-6, "{line}: {index}");
    }
}

#[test]
fn an_abbe_number_is_reproduced_exactly() {
    for (n_d, v_d) in [(1.5168, 64.17), (1.80518, 25.43)] {
        let glass = Dispersion::from_abbe(n_d, v_d).unwrap();
        let at = |line: &str| glass.index(line_nm(line).unwrap()).unwrap();
        assert!((at("d") - n_d).abs() < 1e-14);
        assert!(((at("d") - 1.0) / (at("F") - at("C")) - v_d).abs() < 1e-9);
    }
    for (n_d, v_d) in [(1.0, 60.0), (1.5, 0.0), (f64::NAN, 60.0), (1.5, f64::INFINITY)] {
        assert!(matches!(Dispersion::from_abbe(n_d, v_d), Err(DispersionError::Abbe { .. })));
    }
}

#[test]
fn no_index_where_a_formula_gives_none() {
    let glass = Dispersion::sellmeier(&[(1.0, 0.25)]);
    assert_eq!(glass.index(499.0), None, "beyond the resonance the square is negative");
    assert_eq!(glass.index(500.0), None, "at the resonance it is infinite");
    for wavelength_nm in [0.0, -500.0, f64::NAN, f64::INFINITY] {
        assert_eq!(glass.index(wavelength_nm), None);
    }
    assert_eq!(Dispersion::Constant(1.5).index(1.0), Some(1.5));
    let table = Table::new(vec![(400.0, 1.6), (800.0, 1.4)]).unwrap();
    assert_eq!(Dispersion::Tabulated(table).index(600.0), Some(1.5));
}

#[test]
fn wrong_numbers_are_refused_with_their_reason() {
    let text = |result: Result<Dispersion, DispersionError>| result.unwrap_err().to_string();
    assert_eq!(
        text(Dispersion::agf(14, &[1.0])),
        "an AGF catalogue has no formula 14: its formulas are numbered 1 to 13."
    );
    assert_eq!(
        text(Dispersion::refractiveindex(2, &[0.0, 1.0])),
        "formula 2 of refractiveindex.info has 2 coefficients: it takes a constant, then pairs."
    );
    assert_eq!(
        text(Dispersion::agf(5, &[1.5, 0.0, 0.0, 1.0])),
        "formula 5 of an AGF catalogue has 4 coefficients: it takes fewer; surplus ones must be 0."
    );
    assert_eq!(
        text(Dispersion::agf(1, &[1.5, f64::NAN])),
        "coefficient 2 is NaN: coefficients must be finite."
    );
    for bad in [&[][..], &[1.0, 2.0], &[1.0; 7]] {
        assert!(Dispersion::refractiveindex(4, bad).is_err(), "{bad:?}");
        assert!(Dispersion::refractiveindex(9, &[1.0; 7]).is_err());
    }
}
