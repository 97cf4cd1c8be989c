//! Air against Ciddor's tables and those of the National Institute of Standards and Technology.

use rayweave_optics::glass::{Air, GlassError, glass};

fn air(temperature_celsius: f64, pressure_pa: f64, relative_humidity: f64) -> Air {
    Air { temperature_celsius, pressure_pa, relative_humidity, ..Air::default() }
}

fn index(air: Air, wavelength_nm: f64) -> f64 {
    air.glass().unwrap().extrapolated().index(wavelength_nm).unwrap()
}

/// Ciddor 1996, table 1 (dry) and table 3 (moist): (n - 1) 10⁸ at 633 nm with 450 ppm of CO₂. The
/// entry for 40 °C, 80 kPa, 75 % is printed as 19 996.5, but the printed difference makes it 19
/// 896.5.
#[test]
fn ciddors_tables_are_reproduced() {
    let table = [
        (20.0, 80e3, 0.0, 21458.0),
        (20.0, 100e3, 0.0, 26824.4),
        (20.0, 120e3, 0.0, 32191.6),
        (10.0, 100e3, 0.0, 27774.7),
        (30.0, 100e3, 0.0, 25937.2),
        (20.0, 80e3, 0.75, 21394.0),
        (20.0, 120e3, 0.75, 32127.8),
        (40.0, 80e3, 0.75, 19896.5),
        (40.0, 120e3, 0.75, 29941.8),
        (50.0, 80e3, 1.0, 19058.4),
        (50.0, 120e3, 1.0, 28792.4),
    ];
    for (celsius, pascal, humidity, expected) in table {
        let refractivity = (index(air(celsius, pascal, humidity), 633.0) - 1.0) * 1e8;
        assert!(
            (refractivity - expected).abs() < 0.15,
            "{celsius} {pascal} {humidity}: {refractivity} {expected}"
        );
    }
}

/// J. A. Stone and J. H. Zimmerman, Engineering Metrology Toolbox (NIST), "Documentation", table of
/// test values; its formula for the vapour pressure is different, with an effect in the eighth
/// decimal.
#[test]
fn nists_test_values_are_reproduced() {
    let table = [
        (20.0, 101_325.0, 0.0, 633.0, 1.000271800),
        (20.0, 60_000.0, 0.0, 633.0, 1.000160924),
        (20.0, 120_000.0, 0.0, 633.0, 1.000321916),
        (50.0, 100_000.0, 0.0, 633.0, 1.000243285),
        (5.0, 100_000.0, 0.0, 633.0, 1.000282756),
        (-40.0, 100_000.0, 0.0, 633.0, 1.000337580),
        (50.0, 120_000.0, 1.0, 633.0, 1.000287924),
        (40.0, 120_000.0, 0.75, 633.0, 1.000299418),
        (20.0, 100_000.0, 1.0, 633.0, 1.000267394),
        (40.0, 110_000.0, 1.0, 1700.0, 1.000270247),
        (20.0, 101_325.0, 0.0, 1700.0, 1.000268479),
        (40.0, 110_000.0, 1.0, 300.0, 1.000289000),
        (20.0, 101_325.0, 0.0, 300.0, 1.000286581),
        (-40.0, 120_000.0, 0.0, 300.0, 1.000427233),
    ];
    for (celsius, pascal, humidity, wavelength_nm, expected) in table {
        let found = index(air(celsius, pascal, humidity), wavelength_nm);
        let slack = if humidity == 0.0 { 6e-10 } else { 3e-9 };
        assert!((found - expected).abs() < slack, "{celsius} {pascal} {humidity}: {found} {expected}");
    }
}

#[test]
fn standard_air_is_the_one_of_the_catalogue_and_vacuum_is_vacuum() {
    for wavelength_nm in [300.0, 589.2938, 1690.0] {
        let difference =
            index(Air::default(), wavelength_nm) - glass("air").unwrap().index(wavelength_nm).unwrap();
        assert!(difference.abs() < 1e-15);
        assert_eq!(index(air(20.0, 0.0, 0.0), wavelength_nm), 1.0);
    }
    // eq. 2: 0.534e-6 of the refractivity for each part of CO2 in a million
    let more = Air { co2_ppm: 1450.0, ..Air::default() };
    let ratio = (index(more, 633.0) - 1.0) / (index(Air::default(), 633.0) - 1.0);
    assert!((ratio - (1.0 + 0.534e-3)).abs() < 1e-12, "{ratio}");
}

#[test]
fn impossible_air_is_refused() {
    let text = |air: Air| air.glass().unwrap_err().to_string();
    assert_eq!(text(air(-50.0, 1e5, 0.0)), "temperature in °C of air is -50: it must be from -40 to 100.");
    assert_eq!(text(air(20.0, 1e6, 0.0)), "pressure in Pa of air is 1000000: it must be from 0 to 140000.");
    assert_eq!(text(air(20.0, 1e5, 50.0)), "relative humidity of air is 50: it must be from 0 to 1.");
    assert!(
        text(Air { co2_ppm: f64::NAN, ..Air::default() }).starts_with("content of CO2 in ppm of air is NaN")
    );
    // water boils below 2339 Pa at 20 °C
    assert!(matches!(
        air(20.0, 1000.0, 1.0).glass(),
        Err(GlassError::Air { quantity: "relative humidity", .. })
    ));
    assert!(air(20.0, 3000.0, 1.0).glass().is_ok());
}
