//! Malformed GDML files: all problems are reported at once, with positions, in limited time.

use super::{model, parse};

const WORLD: &str = "<volume name=\"World\"><materialref ref=\"Al\"/><solidref ref=\"b\"/></volume>";
const BOX: &str = "<box name=\"b\" x=\"1\" y=\"1\" z=\"1\"/>";

/// Messages with lines and columns.
fn problems(text: &str) -> Vec<(usize, usize, String)> {
    let problems = match parse(text) {
        Ok(_) => panic!("read: {text}"),
        Err(problems) => problems,
    };
    assert!(problems.to_string().len() < 100_000);
    problems
        .iter()
        .map(|problem| {
            let (line, column) = problem.line_column().unwrap_or_default();
            (line, column, problem.message().to_owned())
        })
        .collect()
}

#[test]
fn a_valid_file_is_accepted() {
    assert_eq!(parse(&model("", BOX, WORLD)).unwrap().scene.regions.len(), 1);
}

#[test]
fn all_problems_are_reported_at_once_with_their_places() {
    let define = "\n<constant name=\"a\" value=\"1e400\"/>\n<position name=\"p\" x=\"wdth\" unit=\"mn\"/>\n<constant name=\"width\" value=\"2\"/>";
    let solids = "\n<box name=\"b\" x=\"1\" z=\"widht\"/>\n<union name=\"u\"><first ref=\"bb\"/><second ref=\"b\"/></union>";
    let structure = "\n<volume name=\"World\"><materialref ref=\"Al\"/><solidref ref=\"b\"/>\n<physvol><volumeref ref=\"Wrld\"/></physvol></volume>";
    let found = problems(&model(define, solids, structure));
    let places: Vec<(usize, usize)> = found.iter().map(|(line, column, _)| (*line, *column)).collect();
    assert_eq!(places, [(3, 27), (4, 23), (4, 35), (8, 1), (8, 24), (9, 29), (12, 26)]);
    let says = |k: usize, words: &str| assert!(found[k].2.contains(words), "{}", found[k].2);
    says(0, "1e400 is too large");
    says(1, "unknown name `wdth`");
    says(2, "`mn` is not a unit of length");
    says(3, "`box` has no attribute `y`");
    says(4, "unknown name `widht`");
    says(4, "Did you mean `width`?");
    says(5, "unknown solid `bb`");
    says(6, "unknown volume `Wrld`");
    says(6, "Did you mean `World`?");
}

/// The uses of a name whose definition is invalid are not reported as well.
#[test]
fn an_invalid_definition_is_reported_once() {
    let define = "\n<constant name=\"hc\" value=\"h_Planck*2\"/>\n<variable name=\"a\" value=\"hc/3\"/><constant name=\"b\" value=\"a+hc\"/>";
    let solids = "\n<box name=\"b\" x=\"hc\" y=\"b\" z=\"other\"/>";
    let found = problems(&model(
        define,
        solids,
        "\n<volume name=\"World\"><materialref ref=\"Al\"/><solidref ref=\"b\"/></volume>",
    ));
    let texts: Vec<&str> = found.iter().map(|(_, _, text)| text.as_str()).collect();
    assert_eq!(texts.len(), 2, "{texts:?}");
    assert!(
        texts[0].contains("unknown name `h_Planck`") && texts[1].contains("unknown name `other`"),
        "{texts:?}"
    );
}

/// Geant4 refuses copy numbers with a fraction, and holds them as a C++ `int`.
#[test]
fn copy_numbers_are_whole() {
    let inner = "<volume name=\"In\"><solidref ref=\"b\"/></volume>";
    for copy in ["1.5", "1e30", "2^31"] {
        let physvol = format!("<physvol copynumber=\"{copy}\"><volumeref ref=\"In\"/></physvol>");
        let world = WORLD.replace("</volume>", &format!("{physvol}</volume>"));
        let found = problems(&model("", BOX, &(inner.to_owned() + &world)));
        assert_eq!(found.len(), 1, "{found:?}");
        assert!(
            found[0].2.starts_with("`copynumber` is ") && found[0].2.contains("must be a whole number"),
            "{found:?}"
        );
    }
}

/// Every proper prefix of a file is an error (the end tag is missing), in limited time and without a panic.
#[test]
fn truncated_files_are_errors() {
    let text = model("<constant name=\"a\" value=\"2*cm\"/>", BOX, WORLD);
    let end = text.rfind("</gdml>").unwrap() + "</gdml".len();
    for length in (0..=end).filter(|length| text.is_char_boundary(*length)) {
        assert!(!problems(&text[..length]).is_empty(), "{length}");
    }
}

#[test]
fn wrong_nesting_is_reported_where_it_is() {
    let found = problems("<gdml>\n<define>\n</solids></gdml>");
    assert_eq!((found.len(), found[0].0), (1, 3));
    assert!(found[0].2.contains("not well-formed"), "{}", found[0].2);
    assert!(
        problems("<gdml><define>")[0].2.contains("`define` is not closed")
            || problems("<gdml><define>")[0].2.contains("`gdml` is not closed")
    );
    assert!(problems("")[0].2.contains("no element"));
    assert!(problems("solid cube")[0].2.contains("no element"));
    assert!(problems("<html/>")[0].2.contains("not GDML"));
    assert!(problems("<gdml/><gdml/>")[0].2.contains("second element"));
    assert!(problems(&"<gdml>".repeat(100_000))[0].2.contains("more than 200 nested elements"));
}

#[test]
fn volumes_that_contain_themselves_are_refused() {
    let inner = |name: &str, other: &str| {
        format!(
            "<volume name=\"{name}\"><materialref ref=\"Al\"/><solidref ref=\"b\"/><physvol><volumeref ref=\"{other}\"/></physvol></volume>"
        )
    };
    let found = problems(&model("", BOX, &(inner("World", "A") + &inner("A", "B") + &inner("B", "A"))));
    assert_eq!(found.len(), 1);
    assert!(found[0].2.contains("`A` contains itself: A contains B contains A."), "{}", found[0].2);
}

/// "Billion laughs": a few lines that would expand to gigabytes.
#[test]
fn entities_have_limits() {
    let mut declarations = "<!ENTITY l0 \"<constant name='a' value='1'/>\">".to_owned();
    for k in 1..20 {
        declarations += &format!("<!ENTITY l{k} \"{}\">", format!("&l{};", k - 1).repeat(10));
    }
    let text = format!("<!DOCTYPE gdml [{declarations}]><gdml><define>&l19;</define></gdml>");
    let found = problems(&text);
    assert!(found[0].2.contains("references") || found[0].2.contains("longer than"), "{}", found[0].2);
    let attribute = text
        .replace("&l19;", "<constant name=\"&l19;\" value=\"1\"/>")
        .replace("<constant name='a' value='1'/>", "lol");
    assert!(!problems(&attribute).is_empty());
    let ring = "<!DOCTYPE gdml [<!ENTITY a \"&b;\"><!ENTITY b \"&a;\">]><gdml>&a;</gdml>";
    assert!(problems(ring)[0].2.contains("Does one contain itself?"));
    let found = problems("<!DOCTYPE gdml [<!ENTITY part \"\">]>\n<gdml>&prt;</gdml>");
    assert!(found[0].2.contains("Did you mean `part`?"), "{}", found[0].2);
    assert!(
        problems("<!DOCTYPE gdml [<!ENTITY f SYSTEM \"nowhere.xml\">]><gdml>&f;</gdml>")[0]
            .2
            .contains("cannot be read")
    );
}

#[test]
fn loops_end() {
    let endless = "<variable name=\"i\" value=\"0\"/><loop for=\"i\" from=\"1\" to=\"2\" step=\"0\"><constant name=\"a\" value=\"1\"/></loop>";
    assert!(problems(&model(endless, BOX, WORLD))[0].2.contains("would not end"));
    let long = endless.replace("step=\"0\"", "step=\"1e-9\"");
    assert!(problems(&model(&long, BOX, WORLD))[0].2.contains("more than 500000 elements"));
}

/// Millions of faces from a few lines are refused before they are allocated.
#[test]
fn faces_of_polyhedra_have_a_limit() {
    let planes = "<loop for=\"i\" from=\"0\" to=\"1000\"><zplane z=\"i\" rmax=\"1\"/></loop>";
    let solid = format!("<polyhedra name=\"b\" numsides=\"4096\">{planes}</polyhedra>");
    let imported = parse(&model("", &solid, WORLD)).unwrap();
    assert!(imported.report.iter().next().unwrap().first.message().contains("too many faces"));
}

/// Faces of many solids, attributes of one element, and volumes within volumes, all of them below 1 MB.
#[test]
fn the_work_for_a_file_has_a_limit() {
    let corners: String = (0..1000)
        .map(|k| {
            let (sin, cos) = (f64::from(k) * 0.006).sin_cos();
            format!("<twoDimVertex x=\"{cos}\" y=\"{sin}\"/>")
        })
        .collect();
    let section = |k: u32| format!("<section zOrder=\"{k}\" zPosition=\"{k}\" scalingFactor=\"1\"/>");
    let sections: String = (0..1000).map(section).collect();
    let solid = format!("<xtru name=\"b\">{corners}{sections}</xtru>");
    let imported = parse(&model("", &solid, WORLD)).unwrap();
    let first = &imported.report.iter().next().unwrap().first;
    assert!(first.message().contains("files of this length may have 300000"), "{}", first.message());
    assert!(first.line_column().is_some());
    let attributes: String = (0..300).map(|k| format!(" a{k}=\"1\"")).collect();
    let found = problems(&model("", &BOX.replace(" x=", &format!("{attributes} x=")), WORLD));
    assert!(found[0].2.contains("more than 200 attributes"), "{}", found[0].2);
    let volume = |k: u32, inside: &str| {
        format!("<volume name=\"v{k}\"><materialref ref=\"Al\"/><solidref ref=\"b\"/>{inside}</volume>")
    };
    let nested = |k: u32| volume(k, &format!("<physvol><volumeref ref=\"v{}\"/></physvol>", k - 1));
    let deep = |count: u32| {
        let inner: String = (1..count).map(nested).collect();
        let world = WORLD.replace(
            "</volume>",
            &format!("<physvol><volumeref ref=\"v{}\"/></physvol></volume>", count - 1),
        );
        model("", BOX, &format!("{}{inner}{world}", volume(0, "")))
    };
    assert_eq!(parse(&deep(200)).unwrap().scene.regions.len(), 201);
    let found = problems(&deep(1500));
    assert!(found[0].2.contains("nested too deeply"), "{}", found[0].2);
}

#[test]
fn missing_worlds_and_references() {
    let text = model("", BOX, WORLD);
    let without = |part: &str| text.replace(part, "");
    // then the only volume is the world
    assert_eq!(parse(&without("<world ref=\"World\"/>")).unwrap().scene.regions.len(), 1);
    assert!(problems(&without("<solidref ref=\"b\"/>"))[0].2.contains("no `solidref`"));
    let found = problems(&text.replace("<world ref=\"World\"/>", "<world ref=\"Wold\"/>"));
    assert!(found[0].2.contains("Did you mean `World`?"), "{}", found[0].2);
    let unknown = text.replace("materialref ref=\"Al\"", "materialref ref=\"Aluminium\"");
    let imported = parse(&unknown).unwrap();
    assert!(imported.scene.warnings.iter().any(|warning| warning.message().contains("unknown material")));
}

#[test]
fn degrees_that_are_read_as_radians_are_suspected() {
    let tube = "<tube name=\"b\" rmax=\"1\" z=\"1\" deltaphi=\"360\"/>";
    let imported = parse(&model("", tube, WORLD)).unwrap();
    let warning = imported.scene.warnings.iter().next().unwrap();
    assert!(warning.message().contains("Is `aunit=\"deg\"` missing?"), "{}", warning.message());
}

/// Every byte of a file changed, removed or duplicated: a result or an error, but no panic.
#[test]
fn damaged_files_do_no_harm() {
    let text = model("<constant name=\"a\" value=\"2*(3+cm)\"/>", BOX, WORLD).into_bytes();
    for (k, byte) in text.iter().enumerate() {
        for change in [vec![], vec![*byte, *byte], vec![b'&'], vec![b'<'], vec![b'"'], vec![b'0'], vec![0xc3]]
        {
            let damaged = [&text[..k], &change, &text[k + 1..]].concat();
            let _ = parse(&String::from_utf8_lossy(&damaged));
        }
    }
}
