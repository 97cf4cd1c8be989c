//! Reading and writing of Zemax files.

use crate::lenses::{cassegrain, doublet, near, triplet};
use rand::{RngExt, SeedableRng, rngs::ChaCha8Rng};
use rayweave_lens::prescription::{
    Behind, FieldKind, ImageSurface, Prescription, Surface, SystemAperture, WeightedWavelength, read_zmx,
    write_zmx,
};
use rayweave_optics::glass::FileProblem;

/// A file as programs write it: indented, with many irrelevant keywords.
const SINGLET: &str = "VERS 160720 18 100027\r\nMODE SEQ\r\nNAME a singlet\r\nNOTE 0 from 0.5 to 2\r\n\
UNIT IN X W X CM MR CPMM\r\nENPD 1.0E-1\r\nGCAT SCHOTT \r\nFTYP 0 0 2 3 0 0 0\r\nXFLN 0 0 0 0\r\nYFLN 0 7.0E+0 0 0\r\n\
FWGN 1 1\r\nWAVM 1 4.861327E-1 1\r\nWAVM 2 5.875618E-1 2\r\nWAVM 3 6.562725E-1 1\r\nWAVM 4 5.5E-1 1\r\nPWAV 2\r\n\
SURF 0\r\n  TYPE STANDARD\r\n  CURV 0.0 0 0 0 0 \"\"\r\n  DISZ INFINITY\r\n  DIAM 0 0 0 0 1 \"\"\r\n\
SURF 1\r\n  STOP\r\n  TYPE EVENASPH\r\n  CURV 5.0E-1 0 0 0 0 \"\"\r\n  CONI -5.0E-1\r\n  PARM 1 0\r\n  PARM 2 0.0\r\n  MIRR 2 0\r\n\
  DISZ 1.2E-1\r\n  GLAS N-BK7 0 0 1.5168 64.17\r\n  DIAM 2.5E-1 1 0 0 1 \"\"\r\n\
SURF 2\r\n  TYPE STANDARD\r\n  CURV 0.0\r\n  DISZ 3.7\r\n  DIAM 2.4E-1 0 0 0 1 \"\"\r\n  XDAT 1 2\r\n\
SURF 3\r\n  TYPE STANDARD\r\n  CURV -0.1\r\n  DISZ 0\r\n  DIAM 0.3 0 0 0 1 \"\"\r\nBLNK \r\nXDAT 3\r\n";

fn singlet() -> Prescription {
    let line = |wavelength_nm, weight| WeightedWavelength { wavelength_nm, weight };
    Prescription {
        name: "a singlet".to_owned(),
        notes: vec!["from 0.5 to 2".to_owned()],
        unit_nm: 2.54e7,
        aperture: SystemAperture::EntrancePupilDiameter(0.1),
        fields: vec![[0.0; 2], [0.0, 7.0]],
        lines: vec![line(486.1327, 1.0), line(587.5618, 2.0), line(656.2725, 1.0)],
        primary: 1,
        image: ImageSurface { radius: -10.0, conic: 0.0, semi_diameter: None },
        ..Prescription::new(vec![
            Surface::new(2.0, 0.12, Behind::Glass("N-BK7".to_owned())).conic(-0.5).semi_diameter(0.25),
            Surface::new(f64::INFINITY, 3.7, Behind::Air),
        ])
    }
}

#[test]
fn files_are_read_in_any_encoding() {
    let utf16: Vec<u8> = SINGLET.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let with_mark: Vec<u8> = [0xff, 0xfe].into_iter().chain(utf16.iter().copied()).collect();
    for bytes in [SINGLET.as_bytes(), &utf16, &with_mark] {
        let read = read_zmx(bytes).unwrap();
        assert_eq!(read.prescription, singlet());
        let notes: Vec<String> = read.notes.iter().map(ToString::to_string).collect();
        assert_eq!(notes, ["line 38: XDAT is ignored, also on line 45", "line 44: BLNK is ignored"]);
    }
    let latin: Vec<u8> = SINGLET.replace("a singlet", "R\u{f6}ntgen").chars().map(|c| c as u8).collect();
    assert_eq!(read_zmx(&latin).unwrap().prescription.name, "R\u{f6}ntgen");
}

#[test]
fn written_files_are_read_back() {
    let model = Prescription::new(vec![
        Surface::new(33.3, 2.0, Behind::Abbe { n_d: 1.62, v_d: 36.37 }),
        Surface::new(-1.0 / 3.0e-2, 0.0, Behind::Index(1.5)),
        Surface::new(7.7, 5.0, Behind::Air).semi_diameter(2.5),
    ])
    .stop_at(2);
    let finite = Prescription {
        object_distance: 123.4,
        field_kind: FieldKind::ObjectHeight,
        fields: vec![[0.5, 1.0]],
        aperture: SystemAperture::ObjectNumericalAperture(0.05),
        ..model.clone()
    };
    let slow =
        Prescription { aperture: SystemAperture::FNumber(8.0), field_kind: FieldKind::ImageHeight, ..model };
    let hubble = {
        let mut lens = cassegrain();
        lens.surfaces[0].semi_diameter = Some(51.0);
        lens
    };
    // radii with all digits of an f64
    let optimised = {
        let mut lens = triplet();
        lens.surfaces
            .iter_mut()
            .zip(1..)
            .for_each(|(surface, k)| surface.radius *= 1.0 / 3.0 + 0.1 * f64::from(k));
        lens
    };
    for lens in [singlet(), doublet(), triplet(), finite, slow, hubble, optimised] {
        let text = write_zmx(&lens).unwrap();
        let read = read_zmx(text.as_bytes()).unwrap();
        assert_eq!(read.prescription, lens, "{text}");
        assert_eq!(read.notes, []);
        assert_eq!(write_zmx(&read.prescription).unwrap(), text);
    }
    let floating = Prescription { aperture: SystemAperture::StopSemiDiameter(3.0), ..triplet() };
    let read = read_zmx(write_zmx(&floating).unwrap().as_bytes()).unwrap().prescription;
    let diameter = |lens: &Prescription| lens.first_order(587.6).unwrap().entrance_pupil.diameter;
    near(diameter(&read), diameter(&floating), 1e-12);
    assert_eq!(read.surfaces[4].semi_diameter, Some(3.0));
}

#[test]
fn unknown_glasses_become_model_glasses() {
    let file =
        SINGLET.replace("N-BK7 0 0 1.5168 64.17", "BAK4 0 0 1.56883 56.13").replace("FTYP 0", "FTYP 3");
    let read = read_zmx(file.as_bytes()).unwrap();
    // N-BAK4 has the Abbe number 55.98
    assert_eq!(read.prescription.surfaces[0].behind, Behind::Abbe { n_d: 1.56883, v_d: 56.13 });
    assert_eq!(read.prescription.field_kind, FieldKind::ImageHeight);
    let notes: Vec<String> = read.notes.iter().map(ToString::to_string).collect();
    assert_eq!(notes[0], "line 8: real image heights of fields are taken as paraxial ones");
    assert!(notes[1].starts_with("line 31: no glass is named \"BAK4\""), "{notes:?}");
    assert!(notes[1].ends_with("; a model glass of its index 1.56883 and Abbe number 56.13 is used"));
    // the index and Abbe number that programs write as placeholders are ignored
    let dummy = |name: &str| SINGLET.replace("N-BK7 0 0 1.5168 64.17", &format!("{name} 0 0 1.5 40"));
    assert!(read_zmx(dummy("BK8").as_bytes()).unwrap_err().to_string().starts_with("line 31: no glass"));
    // an older Schott glass, replaced by its lead- and arsenic-free successor
    let read = read_zmx(dummy("BK7").as_bytes()).unwrap();
    assert_eq!(read.prescription.surfaces[0].behind, Behind::Glass("N-BK7".to_owned()));
    let reported = read.notes.iter().any(|note| note.to_string().ends_with("; its successor N-BK7 is used"));
    assert!(reported, "{:?}", read.notes);
}

/// The numbers in the files are those of Schott's catalogue of 1996.
#[test]
fn successors_with_the_same_index_and_abbe_number_replace_older_glasses() {
    for (name, data) in [("SK16", "1.62041 60.33"), ("BK7", "1.5168 64.17"), ("SK16", "1.620410 60.3236")] {
        let line = format!("{name} 0 0 {data}");
        let read = read_zmx(SINGLET.replace("N-BK7 0 0 1.5168 64.17", &line).as_bytes()).unwrap();
        assert_eq!(read.prescription.surfaces[0].behind, Behind::Glass(format!("N-{name}")));
        let notes: Vec<String> = read.notes.iter().map(ToString::to_string).collect();
        let text = format!(
            "line 31: no glass is named {name:?}; its successor N-{name} is used, which has its index and Abbe number"
        );
        assert!(notes.contains(&text), "{notes:?}");
    }
    for data in ["1.6206 60.33", "1.62041 60.2"] {
        let line = format!("SK16 0 0 {data}");
        let read = read_zmx(SINGLET.replace("N-BK7 0 0 1.5168 64.17", &line).as_bytes()).unwrap();
        assert!(matches!(read.prescription.surfaces[0].behind, Behind::Abbe { .. }), "{data}");
    }
}

/// F2 is a name of two makers (Schott 1.62004, CDGM 1.61293); F4 one of CDGM (1.62005) and, in the file, the
/// older Schott glass of index 1.61659, which no catalogue has.
#[test]
fn glasses_are_those_of_the_makers_and_of_the_index_in_the_file() {
    let of = |makers: &str, glass: &str| {
        let file = SINGLET.replace("GCAT SCHOTT", makers).replace("N-BK7 0 0 1.5168 64.17", glass);
        let read = read_zmx(file.as_bytes()).unwrap();
        let notes: Vec<String> = read.notes.iter().map(ToString::to_string).collect();
        let note = notes.into_iter().find(|note| note.starts_with("line 31: "));
        let behind = read.prescription.surfaces[0].behind.clone();
        (read.prescription, behind, note)
    };
    let glass = |name: &str| Behind::Glass(name.to_owned());
    let (_, found, note) = of("GCAT SCHOTT", "F4 0 0 1.61659 36.63");
    assert_eq!(found, Behind::Abbe { n_d: 1.61659, v_d: 36.63 });
    let text = "line 31: the index of F4 is 1.61659 here and 1.620";
    assert!(note.as_deref().is_some_and(|note| note.starts_with(text)), "{note:?}");
    // without an index in the file, the maker is what is compared
    let (_, found, note) = of("GCAT SCHOTT", "F4");
    assert_eq!((found, note.as_deref()), (glass("F4"), Some("line 31: F4 of CDGM is used: Schott has none")));
    assert_eq!(of("GCAT CDGM SCHOTT", "F4").2, None);
    let text = "line 31: F4 of CDGM is used: Schott has none, and MISC is not among the built-in catalogues";
    assert_eq!(of("GCAT MISC SCHOTT", "F4").2.as_deref(), Some(text));
    assert_eq!(of("GCAT SCHOTT CDGM", "F2").1, glass("F2"));
    let (lens, found, note) = of("GCAT CDGM_2012 SCHOTT", "F2 0 0 1.5 40");
    assert_eq!((found, note), (glass("CDGM F2"), None));
    // the index decides before the order of the makers
    assert_eq!(of("GCAT SCHOTT", "F2 0 0 1.61293 36.99").1, glass("CDGM F2"));
    let text = write_zmx(&lens).unwrap();
    assert!(text.contains("GCAT CDGM\n") && text.contains("GLAS F2 0 0 1.612929"), "{text}");
    assert_eq!(read_zmx(text.as_bytes()).unwrap().prescription.surfaces[0].behind, glass("CDGM F2"));
}

/// Hikari's F2 has the index of Schott's, 1.62004, and the Abbe number 36.33 instead of 36.37 (Nikon's Zemax catalogue,
/// November 2017).
#[test]
fn glasses_of_catalogues_that_are_not_built_in_are_noted() {
    let note = |makers: &str, glass: &str| {
        let file = SINGLET.replace("GCAT SCHOTT", makers).replace("N-BK7 0 0 1.5168 64.17", glass);
        let read = read_zmx(file.as_bytes()).unwrap();
        assert_eq!(read.prescription.surfaces[0].behind, Behind::Glass("F2".to_owned()));
        read.notes.iter().map(ToString::to_string).find(|note| note.starts_with("line 31: "))
    };
    let missing = "line 31: F2 of Schott is used: HIKARI is not among the built-in catalogues";
    for glass in ["F2", "F2 0 0 1.5 40", "F2 0 0 1.62004 36.33"] {
        assert_eq!(note("GCAT HIKARI", glass).as_deref(), Some(missing), "{glass}");
    }
    let first = format!("{missing}, and the file searches it first");
    assert_eq!(note("GCAT HIKARI SCHOTT", "F2"), Some(first));
    // the numbers of the file are those of Schott's glass
    assert_eq!(note("GCAT HIKARI", "F2 0 0 1.62004 36.37"), None);
    assert_eq!(note("GCAT SCHOTT HIKARI", "F2"), None);
}

/// A program that searches the catalogues in the order of the file finds the glasses of the prescription.
#[test]
fn files_name_the_makers_of_all_glasses() {
    let line = |names: &[&str]| {
        let glass = |name: &&str| Surface::new(50.0, 2.0, Behind::Glass((*name).to_owned()));
        let lens = Prescription::new(names.iter().map(glass).collect());
        let text = write_zmx(&lens).unwrap();
        let read = read_zmx(text.as_bytes()).unwrap();
        assert_eq!((read.prescription.surfaces, read.notes), (lens.surfaces, Vec::new()), "{text}");
        text.lines().find(|line| line.starts_with("GCAT")).map(ToOwned::to_owned)
    };
    assert_eq!(line(&["F2", "N-BK7"]).as_deref(), Some("GCAT SCHOTT"));
    // CDGM has an F2, too
    assert_eq!(line(&["H-K9L", "F2"]).as_deref(), Some("GCAT SCHOTT CDGM"));
    assert_eq!(line(&["CDGM F2", "N-BK7"]).as_deref(), Some("GCAT CDGM SCHOTT"));
    assert_eq!(line(&["SiO2"]), None);
}

/// Everything with an effect in Zemax that is not read is named with its line; neutral settings are not.
#[test]
fn ignored_keywords_are_reported() {
    let notes = |file: &str| -> Vec<String> {
        read_zmx(file.as_bytes()).unwrap().notes.iter().map(ToString::to_string).collect()
    };
    let file = SINGLET.replace("FTYP 0 0 2 3 0 0 0", "FTYP 0 1 2 3 0 0 1");
    let found = notes(&file);
    assert!(found[0].starts_with("line 8: the object space is telecentric"), "{found:?}");
    assert!(found[1].starts_with("line 8: the image space is afocal"), "{found:?}");
    let with = |lines: &str| {
        let found = notes(&SINGLET.replace("PWAV 2\r\n", &format!("PWAV 2\r\n{lines}\r\n")));
        found.into_iter().filter(|note| note.starts_with("line 17: ")).collect::<Vec<_>>()
    };
    let neutral = [
        "ENVD 20 1 0",
        "ENVD 20 1 1",
        "ENVD 60 0 0",
        "GFAC 0 0",
        "RAIM 0 0 1 1 0 0 0 0 0 1",
        "PUSH 0 0 0 0 0 0",
        "ROPD 2",
        "POLS 1 0 1 0 0 1 0",
        "FWGN 2 2",
        "VDXN 0 0",
        "VCYN 0 0.0E+0",
        "MNUM 1 1",
        "SDMA 0 1 0",
        "LANG 0",
    ];
    for line in neutral {
        assert_eq!(with(line), [""; 0], "{line}");
    }
    let effects = [
        ("ENVD 60 1 1", "temperature"),
        ("GFAC 1 2", "apodisation"),
        ("RAIM 0 2 1 1 0 1", "aimed"),
        ("PUSH 0 0 0 1 0 0", "shift"),
        ("ROPD 1", "exit pupil"),
        ("POLS 0 1 0 0 0 1 0", "polarised"),
        ("FWGN 1 3", "weight"),
        ("VCYN 0 0.2", "vignetting"),
        ("MNUM 4 1", "configurations"),
        ("FNUM 4 1", "working F-number"),
        ("ZZZZ 1", "ZZZZ is ignored"),
    ];
    for (line, text) in effects {
        let found = with(line);
        assert!(found.len() == 1 && found[0].contains(text), "{line}: {found:?}");
    }
    // apertures, coatings and tilts of surfaces: all their lines
    let file = SINGLET.replace("  TYPE", "  COAT AR\r\n  SQAP 1 2 0\r\n  TYPE");
    let found = notes(&file);
    assert!(found.contains(&"line 18: COAT is ignored, also on lines 26, 38 and 46".to_owned()), "{found:?}");
    assert!(
        found.iter().any(|note| note.starts_with("line 19: SQAP is ignored, also on lines ")),
        "{found:?}"
    );
}

/// The outer radius of an aperture can be infinite.
#[test]
fn apertures_have_an_inner_and_an_outer_radius() {
    let with = |line: &str| {
        let file =
            SINGLET.replace("DIAM 2.5E-1 1 0 0 1 \"\"", line).replace("N-BK7 0 0 1.5168 64.17", "MIRROR");
        read_zmx(file.as_bytes())
    };
    let front = |line: &str| with(line).unwrap().prescription.surfaces[0].clone();
    for infinite in ["INF", "INFINITY", "inf"] {
        let surface = front(&format!("CLAP 3.81 {infinite}"));
        assert_eq!((surface.hole, surface.semi_diameter), (3.81, None));
        let surface = front(&format!("DIAM 9 1\r\n  CLAP 3.81 {infinite} 0"));
        assert_eq!((surface.hole, surface.semi_diameter), (3.81, Some(9.0)));
    }
    assert_eq!(front("CLAP 0.5 4").semi_diameter, Some(4.0));
    for wrong in ["CLAP INF 4", "CLAP 4 2", "CLAP -1 2", "CLAP 4 NaN"] {
        let problem = with(wrong).unwrap_err().to_string();
        assert!(problem.starts_with("line 32: "), "{wrong}: {problem}");
    }
    let glass = SINGLET.replace("DIAM 2.5E-1 1 0 0 1 \"\"", "CLAP 3.81 INF");
    let notes = read_zmx(glass.as_bytes()).unwrap().notes;
    let found = notes.iter().find(|note| note.line == 32).unwrap().to_string();
    assert!(
        found.contains("inner radius 3.81") && found.contains("only mirrors have a central hole"),
        "{found}"
    );
}

#[test]
fn mechanical_semi_diameters_are_read_and_written() {
    let fixed =
        SINGLET.replace("  DIAM 2.5E-1 1 0 0 1", "  MEMA 3.0E-1 1 0 0 1 \"\"\r\n  DIAM 2.5E-1 1 0 0 1");
    let read = read_zmx(fixed.as_bytes()).unwrap();
    assert_eq!(read.prescription.surfaces[0].mechanical_semi_diameter, Some(0.3));
    assert_eq!(read.notes, read_zmx(SINGLET.as_bytes()).unwrap().notes.iter().map(later).collect::<Vec<_>>());
    assert_eq!(read.prescription.assembly().unwrap().lenses[0].semi_diameter, 0.3);
    let back = read_zmx(write_zmx(&read.prescription).unwrap().as_bytes()).unwrap();
    assert_eq!(back.prescription, read.prescription);
    // a computed one is not stated
    let computed = fixed.replace("MEMA 3.0E-1 1", "MEMA 3.0E-1 0");
    assert_eq!(read_zmx(computed.as_bytes()).unwrap().prescription, singlet());
    // mirrors have none
    let mirror = fixed.replace("GLAS N-BK7 0 0 1.5168 64.17", "GLAS MIRROR 0 0 1.5 40");
    let read = read_zmx(mirror.as_bytes()).unwrap();
    assert_eq!(read.prescription.surfaces[0].mechanical_semi_diameter, None);
    let note = "line 32: the mechanical semi-diameter 0.3 of the mirror, MEMA, is ignored: a mirror ends at its clear semi-diameter";
    assert!(read.notes.iter().any(|found| found.to_string() == note), "{:?}", read.notes);
}

/// A note one line later.
fn later(note: &FileProblem) -> FileProblem {
    let text = note.text.replace("line 45", "line 46");
    FileProblem { line: note.line + 1, text }
}

#[test]
fn wavelengths_in_nanometres_are_noted() {
    let file = SINGLET.replace("WAVM 2 5.875618E-1 2", "WAVM 2 587.56 2");
    let read = read_zmx(file.as_bytes()).unwrap();
    assert_eq!(read.prescription.lines[1].wavelength_nm, 587_560.0);
    let note = "line 13: the wavelength 587.56 is one in micrometres, as in all Zemax files: 587.56 nm would be 0.58756";
    assert_eq!(read.notes[0].to_string(), note);
}

#[test]
fn all_problems_are_reported_with_their_lines() {
    let file = "MODE NSC\nUNIT FURLONG\nENPD x\nFTYP 4\nSURF 0\n DISZ INFINITY\nSURF 1\n TYPE TILTSURF\n GLAS BK8\n CURV\nSURF 2\n \
                TYPE EVENASPH\n PARM 9 1e-5\n DISZ INFINITY\nSURF 3\n";
    let problems: Vec<String> =
        read_zmx(file.as_bytes()).unwrap_err().problems.iter().map(ToString::to_string).collect();
    let expected = [
        "line 1: the mode is NSC: only sequential systems, SEQ, are read.",
        "line 2: the unit \"FURLONG\" is not known: MM, CM, IN and METER are.",
        "line 3: \"x\" is not a number",
        "line 4: fields are of type 4: only 0 to 3 are read (angle, object height, paraxial and real image height).",
        "line 8: the surface is of type TILTSURF: STANDARD, EVENASPH,",
        "line 9: no glass is named \"BK8\"",
        "line 10: number 1 of the line is missing",
        "line 11: the distance to the next surface is infinite: only that of the object may be.",
        "line 12: the asphere has parameter 9: only 1 to 8 are read, r^2 to r^16.",
        "line 15: no surface between object and image is the STOP",
        "line 15: the file has no aperture: it needs one of ENPD, FNUM, OBNA, FLOA.",
        "line 15: the file has no wavelength: it needs WAVM or WAVL.",
    ];
    assert_eq!(problems.len(), expected.len(), "{problems:#?}");
    for (found, expected) in problems.iter().zip(expected) {
        assert!(found.starts_with(expected), "{found}");
    }
    let floating = SINGLET.replace("ENPD 1.0E-1", "FLOA").replace("DIAM 2.5E-1 1", "DIAM 0 0");
    assert_eq!(
        read_zmx(floating.as_bytes()).unwrap_err().to_string(),
        "line 22: the stop has no semi-diameter, DIAM, and the aperture is that of the stop, FLOA"
    );
    for other in [&b""[..], b"rayweave = 1\n[solid.a]\nsphere = {}\n", b"\x89PNG\r\n"] {
        assert!(
            read_zmx(other)
                .unwrap_err()
                .to_string()
                .starts_with("line 1: the file has no line of a Zemax file")
        );
    }
}

/// Files with words moved, doubled, dropped and replaced: the reader returns a prescription or problems and
/// never panics, and what it returns can be analysed.
#[test]
fn damaged_files_never_panic() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let words = [
        "SURF 9",
        "STOP",
        "1e300",
        "-1e-300",
        "0",
        "INFINITY",
        "NaN",
        "GLAS MIRROR",
        "\u{fffd}",
        "CURV",
        "FTYP 2 0 999999999 0",
    ];
    let (mut read, mut made) = (0, 0);
    for _ in 0..3000 {
        let mut parts: Vec<&str> = SINGLET.split_inclusive(' ').collect();
        for _ in 0..random.random_range(1..4) {
            let at = random.random_range(0..parts.len());
            match random.random_range(0..3) {
                0 => drop(parts.remove(at)),
                1 => parts.insert(at, words[random.random_range(0..words.len())]),
                _ => parts[at] = words[random.random_range(0..words.len())],
            }
        }
        let Ok(found) = read_zmx(parts.concat().as_bytes()) else { continue };
        read += 1;
        let lens = found.prescription;
        let _ = (lens.first_order(lens.primary_nm()), lens.seidel(), write_zmx(&lens));
        made += usize::from(lens.assembly().is_ok_and(|layout| layout.assembly.compile().is_ok()));
    }
    assert!(read > 300 && made > 100, "{read} {made}");
}

/// A file in which every line is wrong: the message names the first problems, and the number of the others.
#[test]
fn many_problems_make_a_short_message() {
    let lines = "ENPD x\n".repeat(5000);
    let error = read_zmx(format!("SURF 0\n{lines}").as_bytes()).unwrap_err();
    assert_eq!(error.problems.len(), 201);
    let text = error.to_string();
    let last = text.lines().last().unwrap();
    assert!(last.contains("line 202") && last.contains("more problems"), "{last}");
    let unknown: String = (0..3000).map(|k| format!("Q{k} 1\n")).collect();
    let read = read_zmx(format!("{SINGLET}{unknown}").as_bytes()).unwrap();
    assert!(read.notes.len() <= 201 && read.notes.last().unwrap().text.contains("more notes"));
}
