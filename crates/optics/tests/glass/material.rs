//! Ranges, absorption and the errors of a single material.

use rayweave_optics::glass::{
    Dispersion, DispersionError, Glass, GlassError, Table, Transmittance, glass, glasses,
};

fn plain() -> Glass {
    Glass::new("plain", Dispersion::Constant(1.5)).with_range_nm([400.0, 700.0]).unwrap()
}

#[test]
fn ranges_include_their_ends() {
    let glass = plain();
    assert_eq!(glass.index(400.0), Ok(1.5));
    assert_eq!(glass.index(700.0), Ok(1.5));
    assert_eq!(
        glass.index(399.999).unwrap_err().to_string(),
        "plain has no refractive index at 399.999 nm: its data range from 400 nm to 700 nm. Use extrapolated()."
    );
    assert!(glass.index(700.001).is_err());
    assert_eq!(glass.extrapolated().index(10.0), Ok(1.5));
    assert!(glass.index(10.0).is_err(), "extrapolating is up to each copy");
}

#[test]
fn invalid_wavelengths_are_rejected_even_when_extrapolating() {
    for wavelength_nm in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for glass in [plain(), plain().extrapolated()] {
            assert!(matches!(glass.index(wavelength_nm), Err(GlassError::Wavelength(_))));
            assert!(matches!(glass.extinction(wavelength_nm), Err(GlassError::Wavelength(_))));
        }
    }
    assert_eq!(
        plain().index(-1.0).unwrap_err().to_string(),
        "wavelength is -1 nm: wavelengths must be greater than 0 and finite. Is it in nanometres?"
    );
    let error = glass("N-BK7").unwrap().extrapolated().index(60.0).unwrap_err();
    assert_eq!(
        error.to_string(),
        "N-BK7 has no refractive index at 60 nm: its formula has no positive value there."
    );
}

/// τ = exp(-αd), α = 4πk/λ.
#[test]
fn transmittance_and_absorption_follow_beer_and_lambert() {
    let k = Table::new(vec![(500.0, 1e-6), (600.0, 3e-6)]).unwrap();
    let glass = plain().with_extinction(k).unwrap();
    let alpha = 4.0 * std::f64::consts::PI * 2e-6 / 550e-6;
    assert!((glass.extinction(550.0).unwrap() - 2e-6).abs() < 1e-18);
    assert!((glass.absorption_per_mm(550.0).unwrap() - alpha).abs() < 1e-15);
    assert!((glass.internal_transmittance(550.0, 7.0).unwrap() - (-7.0 * alpha).exp()).abs() < 1e-14);
    assert_eq!(glass.internal_transmittance(550.0, 0.0), Ok(1.0));
    assert_eq!(glass.internal_transmittance(550.0, f64::INFINITY), Ok(0.0));
    assert_eq!(
        glass.extinction(650.0).unwrap_err().to_string(),
        "plain has no extinction coefficient at 650 nm: its data range from 500 nm to 600 nm. Use extrapolated()."
    );
    assert_eq!(glass.extrapolated().extinction(650.0), Ok(3e-6));
    for thickness_mm in [-1.0, f64::NAN] {
        assert!(matches!(glass.internal_transmittance(550.0, thickness_mm), Err(GlassError::Thickness(_))));
    }
}

#[test]
fn materials_without_absorption_are_transparent() {
    let glass = plain();
    assert_eq!(glass.extinction_range_nm(), None);
    assert_eq!(glass.extinction(1e5), Ok(0.0));
    assert_eq!(glass.internal_transmittance(500.0, f64::INFINITY), Ok(1.0));
}

fn measured(wavelength_nm: f64, transmittance: f64, thickness_mm: f64) -> Transmittance {
    Transmittance { wavelength_nm, transmittance, thickness_mm }
}

#[test]
fn transmittances_come_back_at_their_thickness() {
    let table = [measured(600.0, 0.9, 10.0), measured(500.0, 0.5, 2.0), measured(450.0, 1.0, 2.0)];
    let glass = plain().with_transmittances(&table).unwrap();
    for row in table {
        let back = glass.internal_transmittance(row.wavelength_nm, row.thickness_mm).unwrap();
        assert!((back - row.transmittance).abs() < 1e-14);
    }
    assert_eq!(glass.extinction(450.0), Ok(0.0));
    // of 25 mm and 1 mm, the transmittance nearest to 1/e is used; 0 counts as 1e-5
    let thick_and_thin = [measured(500.0, 0.0, 25.0), measured(500.0, 0.4, 1.0), measured(600.0, 0.0, 25.0)];
    let glass = plain().with_transmittances(&thick_and_thin).unwrap();
    assert!((glass.internal_transmittance(500.0, 1.0).unwrap() - 0.4).abs() < 1e-14);
    assert!((glass.internal_transmittance(600.0, 25.0).unwrap() - 1e-5).abs() < 1e-17);
}

#[test]
fn impossible_materials_are_refused() {
    for range_nm in [[700.0, 400.0], [-1.0, 400.0], [f64::NAN, 400.0]] {
        assert!(matches!(plain().with_range_nm(range_nm), Err(GlassError::Range { .. })), "{range_nm:?}");
    }
    let gain = Table::new(vec![(500.0, -1e-9)]).unwrap();
    assert_eq!(
        plain().with_extinction(gain).unwrap_err().to_string(),
        "extinction coefficient of plain is -0.000000001 at 500 nm: it must be at least 0."
    );
    for wrong in [measured(500.0, 1.1, 10.0), measured(500.0, 0.5, 0.0), measured(0.0, 0.5, 1.0)] {
        assert!(matches!(plain().with_transmittances(&[wrong]), Err(GlassError::Transmittance { .. })));
    }
    let nothing = plain().with_transmittances(&[]).unwrap_err();
    assert_eq!(nothing, GlassError::Dispersion(DispersionError::Empty));
}

#[test]
fn tables_are_valid_from_end_to_end() {
    let table = Table::new(vec![(400.0, 1.6), (800.0, 1.4)]).unwrap();
    let glass = Glass::new("measured", Dispersion::Tabulated(table));
    assert_eq!(glass.range_nm(), [400.0, 800.0]);
    assert!((glass.index(500.0).unwrap() - 1.55).abs() < 1e-15);
    assert!(glass.index(801.0).is_err());
    assert_eq!(glass.extrapolated().index(801.0), Ok(1.4));
}

/// The errors stated in the documentation of `Dispersion::from_abbe`.
#[test]
fn glasses_from_their_numbers_are_as_near_to_the_real_ones_as_stated() {
    let mut worst: Vec<f64> = Vec::new();
    for real in glasses().iter().filter(|glass| glass.maker() == "Schott").map(Glass::extrapolated) {
        let model = Glass::from_abbe(real.index(587.5618).unwrap(), real.abbe_number().unwrap()).unwrap();
        let error = |nm: i32| (model.index(nm.into()).unwrap() - real.index(nm.into()).unwrap()).abs();
        worst.push((450..=700).step_by(10).map(error).fold(0.0, f64::max));
    }
    worst.sort_by(f64::total_cmp);
    let [median, last] = [worst[worst.len() / 2], worst[worst.len() - 1]];
    assert!((1.5e-4..2.5e-4).contains(&median) && (3.5e-3..4e-3).contains(&last), "{median} {last}");
}
