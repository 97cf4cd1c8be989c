//! AGF files: encodings, all problems at once, and files as they occur.

use super::mutations;
use rayweave_optics::glass::{Published, glass, read_agf};

const FILE: &str = "CC Example (2024) 20 °C\r\n\
    ! a remark\r\n\
    NM N-BK7 2 517642.251 1.5168 64.17 0 1\r\n\
    GC step 0.5 available\r\n\
    ED 7.1 8.3 2.51 -0.0009 0\r\n\
    CD 1.03961212E+000 6.00069867E-003 2.31792344E-001 2.00179144E-002 1.01046945E+000 1.03560653E+002 0 0 0 0\r\n\
    TD 1.86E-006 1.31E-008 -1.37E-011 4.34E-007 6.27E-010 1.70E-001 2.0E+001\r\n\
    OD -1 1 0 1 2.3 2.3\r\n\
    LD 3.000E-001 2.500E+000\r\n\
    IT 0.365 0.988 10\r\n\
    IT 0.365 0.971 25\r\n\
    NM AMTIR1 3 0 1.000000 0.000000 0 0 0\r\n\
    CD 2.512536180 6.86942636E-2 2.11563734E-2 -1.55048679E-4 -4.35296121E-8 1.99858193E-10\r\n\
    LD 1 14\r\n";

#[test]
fn a_file_is_read_in_every_encoding() {
    let expected = read_agf(FILE.as_bytes(), "Me").unwrap();
    assert_eq!(expected.len(), 2);
    let little: Vec<u8> = FILE.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = FILE.encode_utf16().flat_map(u16::to_be_bytes).collect();
    let latin: Vec<u8> = FILE.chars().map(|character| u32::from(character) as u8).collect();
    let marked = |mark: &[u8], text: &[u8]| [mark, text].concat();
    let files = [
        marked(b"\xff\xfe", &little),
        marked(b"\xfe\xff", &big),
        marked(b"\xef\xbb\xbf", FILE.as_bytes()),
        little,
        big,
        latin,
    ];
    for file in files {
        assert_eq!(read_agf(&file, "Me").as_ref(), Ok(&expected));
    }
}

#[test]
fn glasses_have_the_data_of_the_file() {
    let glasses = read_agf(FILE.as_bytes(), "Me").unwrap();
    let bk7 = &glasses[0];
    assert_eq!([bk7.name(), bk7.maker()], ["N-BK7", "Me"]);
    assert_eq!(bk7.source(), "step 0.5 available; Example (2024) 20 °C");
    assert_eq!(bk7.published(), Some(Published { n_d: 1.5168, v_d: 64.17 }));
    assert_eq!(bk7.range_nm(), [300.0, 2500.0]);
    assert_eq!(bk7.index(500.0), glass("N-BK7").unwrap().index(500.0));
    // the optical depth -ln 0.971 = 0.029 is more accurate than -ln 0.988 = 0.012
    assert!((bk7.internal_transmittance(365.0, 25.0).unwrap() - 0.971).abs() < 1e-14);
    let amtir = &glasses[1];
    assert_eq!(amtir.published(), None, "an index of 1 and an Abbe number of 0 mean that there is none");
    // Amorphous Materials Inc., AMTIR-1: 2.4976 at 10 µm
    assert!((amtir.index(10_000.0).unwrap() - 2.4976).abs() < 2e-4);
}

#[test]
fn all_problems_are_reported_with_their_lines() {
    let file = "IT 0.5 0.9 10\n\
        NM ONE 2 0 1.5\n\
        NM TWO 99 0 1.5 60 0\nCD 1 0.01\nLD 0.4 0.7\n\
        NM THREE 2 0 1.5 60 0\nLD 0.4 0.7\n\
        NM FOUR 2 0 1.5 60 0\nCD 1 x\nLD 0.7\nIT 0.5 90 10\n\
        NM FIVE 2 0 1.5 60 0\nCD 1 0.01\nLD 0.7 0.4\n\
        NM SIX 2 0 1.5 60 0\nCD 1 0.01\n\
        NM GOOD 2 0 1.5 60 0\nCD 1 0.01\nLD 0.4 0.7\n";
    let error = read_agf(file.as_bytes(), "").unwrap_err();
    let expected = "\
line 1: a IT line has no glass: a glass begins with an NM line.
line 2: an NM line is too short: it needs a name, a formula, a MIL number, n_d and V_d.
line 4: an AGF catalogue has no formula 99: its formulas are numbered 1 to 13.
line 6: THREE has no CD line.
line 9: \"x\" is not a number.
line 10: an LD line is too short: it needs the shortest and the longest wavelength in µm.
line 11: internal transmittance is 90 through 10 mm at 500 nm: it must be from 0 to 1, through a thickness greater than 0. Is it in \
per cent?
line 14: range of FIVE is 700 nm to 400 nm: it must start at 0 or above and increase.
line 15: SIX has no LD line.";
    assert_eq!(error.to_string(), expected);
    assert_eq!(error.problems().len(), 9);
    let readable = error.into_readable();
    assert_eq!(readable.iter().map(|glass| glass.name()).collect::<Vec<_>>(), ["GOOD"]);
}

#[test]
fn any_bytes_are_read_or_refused() {
    assert_eq!(read_agf(b"", "").unwrap(), []);
    for bytes in
        [&b"\xff\xfeN"[..], b"NM", b"NM \nCD\nLD\nIT", b"\0\0\0\0", b"NM \xff 1 0 1.5 60\nCD 1e999\nLD 1 2"]
    {
        let _ = read_agf(bytes, "");
    }
    assert!(read_agf(b"NM", "").is_err());
    assert!(read_agf(b"NM A 1 0 1.5 60\nCD 1e999\nLD 1 2", "").is_err());
}

#[test]
fn mutated_files_are_read_or_rejected_with_line_numbers() {
    let mut refused = 0;
    for file in mutations(FILE, 3000) {
        if let Err(error) = read_agf(&file, "") {
            assert!(!error.problems().is_empty());
            assert!(error.problems().iter().all(|problem| (1..=40).contains(&problem.line)), "{error}");
            refused += 1;
        }
    }
    assert!((300..2900).contains(&refused), "{refused}");
}
