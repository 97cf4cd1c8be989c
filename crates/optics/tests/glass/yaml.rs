//! Files of refractiveindex.info.

use super::mutations;
use rayweave_optics::glass::{Published, read_refractiveindex};

/// A file in the form that the database has used since 2024.
const GLASS: &str = "\
# this file is part of refractiveindex.info database

REFERENCES: |
    <a href=\"https://example.org/schott.agf\">SCHOTT Zemax catalog</a>
    (2017)<br>See also data sheets
COMMENTS: |
    step 0.5 available
DATA:
  - type: formula 2
    wavelength_range: 0.3 2.5
    coefficients: 0 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653
  - type: tabulated k
    data: |
        0.300 2.8607E-06
        0.310 1.3679E-06
CONDITIONS:
    temperature: 293
PROPERTIES:
    nd: 1.5168
    Vd: 64.17
    glass_code: 517642.251
    density:
      - value: 2510
";

#[test]
fn a_file_of_a_glass_is_read() {
    let glass = &read_refractiveindex(GLASS, "N-BK7").unwrap()[0];
    assert_eq!(glass.name(), "N-BK7");
    assert_eq!(glass.source(), "SCHOTT Zemax catalog (2017)See also data sheets");
    assert_eq!(glass.published(), Some(Published { n_d: 1.5168, v_d: 64.17 }));
    assert_eq!(glass.range_nm(), [300.0, 2500.0]);
    assert!((glass.index(587.5618).unwrap() - 1.5168).abs() < 1e-5);
    assert_eq!(glass.extinction_range_nm(), Some([300.0, 310.0]));
    assert!((glass.extinction(305.0).unwrap() - 2.1143e-6).abs() < 1e-20);
    // 0.3017 through 10 mm on Schott's data sheet of N-BK7 (0.05 through 25 mm)
    assert!((glass.internal_transmittance(300.0, 25.0).unwrap() - 0.05).abs() < 1e-5);
}

#[test]
fn tables_and_older_keys_are_read() {
    let nk =
        "DATA:\n  - type: tabulated nk\n    data: |\n        0.5209 0.62 2.081\n        0.5486 0.43 2.455\n";
    let gold = &read_refractiveindex(nk, "gold").unwrap()[0];
    let index = gold.complex_index(548.6).unwrap();
    assert_eq!([index.n, index.k], [0.43, 2.455]);
    assert_eq!(gold.range_nm(), [520.9, 548.6]);
    let old = "DATA:\n  - type: formula 1\n    range: 0.2 4\n    coefficients: 0 1.1 0.09\nSPECS:\n    nd: 1.4\n    Vd: 60\n";
    let old = &read_refractiveindex(old, "old").unwrap()[0];
    assert_eq!(old.range_nm(), [200.0, 4000.0]);
    assert_eq!(old.published(), Some(Published { n_d: 1.4, v_d: 60.0 }));
    // the first index is used
    let two =
        "DATA:\n- {type: tabulated n, data: 0.5 1.5}\n- {type: formula 5, range: 0.1 9, coefficients: 2}\n";
    assert_eq!(read_refractiveindex(two, "two").unwrap()[0].index(500.0), Ok(1.5));
    let one_number = "DATA:\n- {type: formula 5, wavelength_range: 0.1 9, coefficients: 2}\n";
    assert_eq!(read_refractiveindex(one_number, "").unwrap()[0].index(500.0), Ok(2.0));
}

#[test]
fn several_documents_have_names_of_their_own() {
    let text = "---\nNAME: a\nALIASES: b, c d\nDATA:\n- {type: formula 5, range: 0.1 9, coefficients: 2}\n---\nDATA:\n- {type: tabulated n, data: 1 3}\n";
    let read = read_refractiveindex(text, "rest").unwrap();
    assert_eq!(read.iter().map(|glass| glass.name()).collect::<Vec<_>>(), ["a", "rest"]);
    assert_eq!(read[0].aliases(), ["b", "c d"]);
}

#[test]
fn all_problems_are_reported_with_their_lines() {
    let text = "\
DATA:
  - type: formula 12
    wavelength_range: 0.3 2.5
    coefficients: 0 1
  - type: formula 2
    wavelength_range: 0.3
    coefficients: 0 1 x
  - type: tabulated nk
    data: |
        0.3 1.5
        0.4 1.5 0
        0.5 1.5 y
  - type: spline
  - data: 1
";
    let error = read_refractiveindex(text, "bad").unwrap_err();
    let expected = "\
line 4: refractiveindex.info has no formula 12: its formulas are numbered 1 to 9.
line 7: \"x\" is not a number.
line 10: a row has 2 numbers: it needs a wavelength in µm and 2 more.
line 12: \"y\" is not a number.
line 13: type \"spline\" is unknown: types are formula 1 to 9 and tabulated n, k, nk.
line 14: an entry of DATA has no type: types are formula 1 to 9 and tabulated n, k, nk.
line 1: DATA has no index: it needs a formula or a table of n or nk.";
    let text = error.to_string();
    for line in expected.lines() {
        assert!(text.contains(line), "{line}\nis not in\n{text}");
    }
    assert_eq!(error.problems().len(), 7);
    assert!(error.into_readable().is_empty());
}

#[test]
fn any_text_is_read_or_refused() {
    for text in
        ["", "x", "DATA: 1", "DATA: []", "[", "a: [1,", "DATA:\n- 1\n", "\t", "DATA:\n- {type: formula x}\n"]
    {
        let error = read_refractiveindex(text, "").unwrap_err();
        assert!(!error.problems().is_empty(), "{text:?}");
        assert!(error.problems().iter().all(|problem| problem.line >= 1), "{text:?}: {error}");
    }
    for deep in ["[".repeat(200_000), "a: ".repeat(1000), "- ".repeat(200_000), "{a: ".repeat(100_000)] {
        assert!(read_refractiveindex(&deep, "").is_err());
    }
    let negative = "DATA:\n- {type: tabulated nk, data: 0.5 1.5 -1}\n";
    assert_eq!(
        read_refractiveindex(negative, "gain").unwrap_err().to_string(),
        "line 2: extinction coefficient of gain is -1 at 500 nm: it must be at least 0."
    );
}

#[test]
fn mutated_files_are_read_or_rejected_with_line_numbers() {
    let mut refused = 0;
    for file in mutations(GLASS, 3000) {
        if let Err(error) = read_refractiveindex(&String::from_utf8_lossy(&file), "") {
            assert!(!error.problems().is_empty());
            assert!(error.problems().iter().all(|problem| (1..=40).contains(&problem.line)), "{error}");
            refused += 1;
        }
    }
    assert!((300..2900).contains(&refused), "{refused}");
}
