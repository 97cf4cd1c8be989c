//! Malformed GDML files: all problems are reported at once, with positions, in limited time.

use super::{model, parse};
use rayweave_formats::{Format, LossKind, Options};
use rayweave_model::Program;

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
}

/// Geant4 11.4.1 stops at each of these references: "Referenced volume 'Worlt' was not found!" and similar. The geometry is complete
/// without them.
#[test]
fn undefined_references_of_optical_data_are_losses() {
    let define = "<matrix name=\"M\" coldim=\"2\" values=\"2 1 3 1\"/>";
    let surface = "<opticalsurface name=\"ESR\"><property name=\"REFLECTIVITY\" ref=\"M\"/></opticalsurface>";
    let links = "\n<skinsurface name=\"s\" surfaceproperty=\"ESR\"><volumeref ref=\"World\"/></skinsurface>\
                 \n<bordersurface name=\"c\" surfaceproperty=\"ESR\"><physvolref ref=\"p\"/><physvolref ref=\"In_PV\"/></bordersurface>";
    let inner = "<volume name=\"In\"><solidref ref=\"b\"/></volume>";
    let placed = "<physvol name=\"p\"><volumeref ref=\"In\"/></physvol><physvol><volumeref ref=\"In\"/></physvol></volume>";
    let world = WORLD.replace("</volume>", placed);
    let text = model(define, &format!("{BOX}{surface}"), &format!("{inner}{world}{links}"));
    assert_eq!(parse(&text).unwrap().report.count(LossKind::Undefined), 0);
    for (from, to, message) in [
        (
            "\"Al\"/>",
            "\"Alu\"/>",
            "unknown material `Alu`: no material defined before has this name. Did you mean `Al`?",
        ),
        (
            "ref=\"M\"",
            "ref=\"m\"",
            "unknown matrix `m`: the property `REFLECTIVITY` has no value. Did you mean `M`?",
        ),
        (
            "surfaceproperty=\"ESR\"><volume",
            "surfaceproperty=\"Esr\"><volume",
            "unknown optical surface `Esr`: no `opticalsurface` has this name. Did you mean `ESR`?",
        ),
        (
            "ref=\"World\"/></skin",
            "ref=\"Worlt\"/></skin",
            "unknown volume `Worlt`: no `volume` has this name. Did you mean `World`?",
        ),
        (
            "physvolref ref=\"p\"",
            "physvolref ref=\"q\"",
            "unknown placement `q`: no `physvol` has this name.",
        ),
        (
            "physvolref ref=\"p\"",
            "physvolref ref=\"In\"",
            "unknown placement `In`: it is the name of a volume, not of a `physvol`.",
        ),
    ] {
        assert!(text.contains(from), "{from}");
        let imported = parse(&text.replacen(from, to, 1)).unwrap();
        let losses: Vec<_> = imported.report.iter().collect();
        assert_eq!((losses.len(), losses[0].kind), (1, LossKind::Undefined), "{to}");
        assert_eq!(losses[0].first.message(), message);
        let (line, column) = losses[0].first.line_column().unwrap();
        assert_eq!(losses[0].place(), Some(format!("{line}:{column}")));
        let errors = imported.report.errors(&[LossKind::Undefined]);
        assert_eq!(errors.iter().next().unwrap().message(), message);
        // the lint knows placements
        assert_eq!(imported.report.undefined().count(), usize::from(!message.contains("placement")));
        assert_eq!(imported.scene.regions.len(), 2);
    }
}

/// An error or warning in a loop is listed once for each position, with a count.
#[test]
fn problems_of_loops_are_counted() {
    let define = "<variable name=\"i\" value=\"0\"/>";
    let looped = |attribute: &str| {
        let placed = format!(
            "<loop for=\"i\" from=\"1\" to=\"16\" step=\"1\">\n<physvol name=\"q[i]\"><volumeref ref=\"In\"/>\
             <position {attribute}/></physvol></loop></volume>"
        );
        let inner = "<volume name=\"In\"><solidref ref=\"b\"/></volume>";
        model(define, BOX, &format!("{inner}{}", WORLD.replace("</volume>", &placed)))
    };
    assert_eq!(parse(&looped("x=\"i\"")).unwrap().report.iter().count(), 0);
    let found = problems(&looped("x=\"floor(i/4)\" unit=\"mn\""));
    let texts: Vec<&str> = found.iter().map(|(_, _, text)| text.as_str()).collect();
    let functions =
        "abs, min, max, sqrt, pow, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh, exp, log, log10";
    let function =
        format!("unknown function `floor`: the functions are {functions}. It occurs 16 times, first here.");
    assert_eq!(texts.len(), 2, "{texts:?}");
    assert!(texts.contains(&function.as_str()), "{texts:?}");
    assert!(
        texts
            .iter()
            .any(|text| text.starts_with("`mn` is not a unit of length") && text.contains("16 times")),
        "{texts:?}"
    );
    // names that differ by the index of the loop
    let found = problems(&looped("x=\"0\"").replace("volumeref ref=\"In\"", "volumeref ref=\"Inn[i]\""));
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(
        found[0].2.contains("unknown volume `Inn_0`")
            && found[0].2.contains("16 times with different numbers"),
        "{found:?}"
    );
    // two problems of one element are two
    assert_eq!(problems(&model("", "<box name=\"b\" z=\"1\"/>", WORLD)).len(), 2);
}

/// The caller's numbers replace those of definitions; other definitions depend on them.
#[test]
fn definitions_are_overridden() {
    let define = "<constant name=\"half\" value=\"10\"/><quantity name=\"q\" value=\"3\" unit=\"cm\"/>\
                  <variable name=\"v\" value=\"2*half\"/><expression name=\"e\">v+1</expression>";
    let text = model(define, "<box name=\"b\" x=\"v\" y=\"q\" z=\"e\"/>", WORLD);
    let sizes = |given: &[(&str, &str)]| {
        let given: Vec<(String, String)> =
            given.iter().map(|(name, text)| ((*name).to_owned(), (*text).to_owned())).collect();
        let imported = rayweave_formats::parse(&text, Format::Gdml, &given, &Options::default());
        imported.map(|imported| {
            let program = Program::compile_regions(&imported.scene.model_regions()).unwrap();
            let bounds = program.prototypes()[0].bounds;
            (bounds.hi - bounds.lo).to_array().map(|size| (size * 1e6).round() / 1e6)
        })
    };
    assert_eq!(sizes(&[]).unwrap(), [20.0, 30.0, 21.0]);
    assert_eq!(sizes(&[("half", "15")]).unwrap(), [30.0, 30.0, 31.0]);
    // a quantity keeps its unit; expressions have units and the names before
    assert_eq!(sizes(&[("q", "4"), ("v", "half+1*cm")]).unwrap(), [20.0, 40.0, 21.0]);
    assert_eq!(sizes(&[("e", "7"), ("e", "8")]).unwrap(), [20.0, 30.0, 8.0]);
    let error = sizes(&[("hlaf", "15")]).unwrap_err().to_string();
    assert!(
        error.contains(
            "unknown parameter `hlaf`: the file's constants, variables and quantities are e, half, q, v. Did you mean `half`?"
        ),
        "{error}"
    );
    let error = sizes(&[("v", "2*hafl")]).unwrap_err().to_string();
    assert!(error.contains("unknown name `hafl`") && error.contains("v=2*hafl"), "{error}");
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
