//! Warnings for content that Geant4 accepts, with or without its own message.

use super::{along, model, parse, volume};
use rayweave_formats::{Format, Imported, Options};
use rayweave_model::Program;
use std::sync::Arc;

const SOLIDS: &str =
    "<box name=\"w\" x=\"200\" y=\"200\" z=\"200\"/><box name=\"b\" x=\"2\" y=\"4\" z=\"6\"/>";

/// A world with the given elements, and a volume `V` of the solid `b` with further elements inside.
fn world(content: &str, inner: &str) -> String {
    format!(
        "<volume name=\"V\"><materialref ref=\"Al\"/><solidref ref=\"b\"/>{inner}</volume>\
         <volume name=\"World\"><materialref ref=\"Al\"/><solidref ref=\"w\"/>{content}</volume>"
    )
}

fn placed(inner: &str) -> String {
    format!("<physvol name=\"p\"><volumeref ref=\"V\"/>{inner}</physvol>")
}

fn read(text: &str) -> Imported {
    parse(text).unwrap_or_else(|problems| panic!("{problems}"))
}

/// The only warning of a model.
fn warning(imported: &Imported) -> (usize, String) {
    let all: Vec<_> = imported.scene.warnings.iter().collect();
    assert_eq!(all.len(), 1, "{}", imported.scene.warnings);
    (all[0].line_column().unwrap().0, all[0].message().to_owned())
}

fn says(imported: &Imported, words: &[&str]) {
    let (_, message) = warning(imported);
    for word in words {
        assert!(message.contains(word), "{message}: no `{word}`");
    }
}

#[test]
fn extensions_of_the_schema_are_read() {
    let text = model("", SOLIDS, &world(&placed(""), ""));
    for name in ["gdml_simple_extension", "my:gdml"] {
        let text = text.replace("<gdml>", &format!("<{name} xmlns:my=\"x\">"));
        let imported = read(&text.replace("</gdml>", &format!("</{name}>")));
        assert_eq!(imported.scene.regions.len(), 2);
        says(&imported, &[name, "extension of GDML"]);
    }
    // a document without any section is in a different format
    assert!(parse("<html><body/></html>").unwrap_err().to_string().contains("not GDML"));
}

/// Geant4 11.4.1 drops such a property: its table of the material has neither the constant nor the index.
#[test]
fn properties_with_a_value_and_no_matrix_are_named() {
    let with = |property: &str| {
        let surface = format!(
            "<opticalsurface name=\"o\" model=\"glisur\" finish=\"polished\" type=\"dielectric_metal\" value=\"1\">{property}</opticalsurface>"
        );
        read(&model(
            "<matrix name=\"T\" coldim=\"1\" values=\"7*ns\"/>",
            &(SOLIDS.to_owned() + &surface),
            &world("", ""),
        ))
    };
    says(
        &with("<property name=\"WLSTIMECONSTANT\" value=\"7 * ns\"/>"),
        &[
            "the property `WLSTIMECONSTANT` has a `value` and no `ref`",
            "Geant4 drops the property",
            "<matrix name=\"WLSTIMECONSTANT_M\" coldim=\"1\" values=\"7*ns\"/>",
        ],
    );
    says(
        &with("<property name=\"REFLECTIVITY\" value=\"0.9\"/>"),
        &["<matrix name=\"REFLECTIVITY_M\" coldim=\"2\" values=\"1*eV 0.9 10*eV 0.9\"/>"],
    );
    assert!(with("<property name=\"WLSTIMECONSTANT\" ref=\"T\"/>").scene.warnings.is_empty());
}

#[test]
fn surfaces_in_volumes_and_unknown_elements_are_ignored() {
    let surface = "<opticalsurface name=\"o\" model=\"glisur\" finish=\"polished\" type=\"dielectric_metal\" value=\"1\"/>";
    let skin = "<skinsurface name=\"k\" surfaceproperty=\"o\"><volumeref ref=\"V\"/></skinsurface>";
    let inner = |element: &str| model("", SOLIDS, &world(&placed(""), element));
    says(&read(&inner(surface)), &["`opticalsurface` has no effect in a volume", "`solids`"]);
    says(&read(&inner(skin)), &["`skinsurface` has no effect in a volume", "`structure`"]);
    says(&read(&inner("<auxilliary/>")), &["`auxilliary`", "Did you mean `auxiliary`?"]);
    let text = model("", SOLIDS, &world(&placed("<rotatoin x=\"90\"/>"), ""));
    says(&read(&text), &["`physvol` has no element `rotatoin`", "Did you mean `rotation`?"]);
    let text = text.replace("<rotatoin x=\"90\"/>", "").replace("<setup", "<extension/><setup");
    says(&read(&text), &["`extension` is ignored"]);
}

#[test]
fn unknown_attributes_get_a_suggestion() {
    // zcut2 is misspelt: without the warning, the missing upper cut would go unnoticed
    let lung = "<ellipsoid name=\"b\" ax=\"20\" by=\"30\" cz=\"40\" zcut1=\"-5\" zcut0=\"10\"/>";
    let solids = format!("<box name=\"w\" x=\"200\" y=\"200\" z=\"200\"/>{lung}");
    let text = model("", &solids, &world(&placed(""), ""));
    let imported = read(&text);
    says(&imported, &["`ellipsoid` has no attribute `zcut0`", "Did you mean `zcut2`?"]);
    assert_eq!(warning(&imported).0, 4);
    // one warning for all occurrences
    let boxes: String =
        (0..30).map(|k| format!("<box name=\"c{k}\" x=\"1\" y=\"1\" z=\"1\" w=\"1\"/>")).collect();
    says(
        &read(&model("", &(SOLIDS.to_owned() + &boxes), &world(&placed(""), ""))),
        &["`w`", "occurs 30 times"],
    );
    // attributes in other namespaces are not GDML attributes
    let text =
        model("", SOLIDS, &world(&placed(""), "")).replace("<gdml>", "<gdml xmlns:xsi=\"i\" xsi:no=\"s\">");
    assert!(read(&text).scene.warnings.is_empty());
}

/// Geant4 11.4.1 places the box of 2, 4, 6 mm with its original size for the first two of these scales, mirrored according
/// to the signs, and refuses the third file (`G4ReflectionFactory::CheckScale`).
#[test]
fn only_the_signs_of_a_scale_count() {
    for (scale, reason) in
        [([2, 3, 4], "as in Geant4"), ([-2, -3, 1], "as in Geant4"), ([-2, 1, 1], "refuses")]
    {
        let [x, y, z] = scale;
        let text = model("", SOLIDS, &world(&placed(&format!("<scale x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")), ""));
        let imported = read(&text);
        says(&imported, &[&format!("({x}, {y}, {z})"), "only the signs are used", reason, "scaledSolid"]);
        for (axis, half) in [1.0, 2.0, 3.0].into_iter().enumerate() {
            let (mut origin, mut direction) = ([0.1, 0.2, 0.3], [0.0; 3]);
            (origin[axis], direction[axis]) = (-100.0, 1.0);
            let hits = along(&imported, origin, direction);
            let start = hits.iter().find(|hit| hit.1 == "V").map(|hit| hit.0);
            assert!(start.is_some_and(|start| (start - (100.0 - half)).abs() < 1e-9), "{hits:?}");
        }
    }
    let mirrored = model("", SOLIDS, &world(&placed("<scale x=\"-1\" y=\"1\" z=\"1\"/>"), ""));
    assert!(read(&mirrored).scene.warnings.is_empty());
}

#[test]
fn an_index_for_other_wavelengths_is_no_index() {
    let text = |values: &str| {
        model(
            &format!("<matrix name=\"n\" coldim=\"2\" values=\"{values}\"/>"),
            SOLIDS,
            &world(&placed(""), ""),
        )
        .replace("</material>", "<property name=\"RINDEX\" ref=\"n\"/></material>")
    };
    // h c = 1239.841984 eV nm: 3.1 eV are 399.949 nm and 6.2 eV are 199.9745 nm
    let imported = read(&text("3.1*eV 1.4 6.2*eV 1.5"));
    assert_eq!(imported.scene.media[1].index, None);
    says(&imported, &["`Al` has no refractive index", "199.9745 to 399.9490 nm", "589.3 nm"]);
    // limits that are rounded to four digits
    let imported = read(&text("2.104*eV 1.4 6.2*eV 1.5"));
    assert!(imported.scene.warnings.is_empty() && imported.scene.media[1].index == Some(1.4));
    let imported = read(&text("1.55*eV 1.4 6.2*eV 0"));
    assert!(imported.scene.media[1].index.is_some() && imported.scene.warnings.is_empty());
    says(&read(&text("1.55*eV 0 6.2*eV 0")), &["its value at 589.3 nm is 0"]);
}

#[test]
fn quantities_of_materials_may_be_defined() {
    let text = model(
        "<quantity name=\"rho\" type=\"density\" value=\"2700\" unit=\"kg/m3\"/>",
        SOLIDS,
        &world(&placed(""), ""),
    );
    let imported = read(&text.replace("<D value=\"2.7\"/>", "<Dref ref=\"rho\"/>"));
    let density = imported.scene.media[1].numbers.iter().find(|number| number.0 == "density").unwrap().1;
    assert!((density - 2.7).abs() < 1e-12, "{density}");
    let unknown = text.replace("<D value=\"2.7\"/>", "<Dref ref=\"roh\"/>");
    assert!(parse(&unknown).unwrap_err().to_string().contains("Did you mean `rho`?"));
}

/// A cube of side 2 as 12 triangles, each on a separate line from line 11 on, some with the vertices in reverse order and
/// some missing.
fn cube(reversed: &[usize], missing: &[usize]) -> String {
    let corner = |k: i32| [k & 1, k >> 1 & 1, k >> 2].map(|bit| 2 * bit - 1);
    let position = |k: i32| {
        let [x, y, z] = corner(k);
        format!("<position name=\"p{k}\" x=\"{x}\" y=\"{y}\" z=\"{z}\"/>")
    };
    let define: String = (0..8).map(position).collect();
    // counter-clockwise seen from outside
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    let facet = |(k, [a, b, c]): (usize, [i32; 3])| {
        let [b, c] = if reversed.contains(&k) { [c, b] } else { [b, c] };
        let facet =
            format!("\n<triangular vertex1=\"p{a}\" vertex2=\"p{b}\" vertex3=\"p{c}\" type=\"ABSOLUTE\"/>");
        if missing.contains(&k) { "\n".to_owned() } else { facet }
    };
    let facets: String = triangles.enumerate().map(facet).collect();
    let solid = format!("\n\n\n\n\n\n<tessellated name=\"s\">{facets}</tessellated>");
    let structure = "<volume name=\"World\"><materialref ref=\"Al\"/><solidref ref=\"s\"/></volume>";
    model(&define, &solid, structure)
}

#[test]
fn facets_in_the_wrong_order_are_reported_with_their_solid() {
    let size = |imported: &Imported| {
        volume(&Arc::new(Program::compile(&imported.scene.regions[0].solid).unwrap()), 40)
    };
    let good = read(&cube(&[], &[]));
    assert!(good.scene.warnings.is_empty(), "{}", good.scene.warnings);
    let one = read(&cube(&[7], &[]));
    says(&one, &["facet 7", "`s`", "wrong orientation", "3 such edges"]);
    assert_eq!(warning(&one).0, 11 + 7);
    let all = read(&cube(&(0..12).collect::<Vec<_>>(), &[]));
    says(&all, &["`s` is inside out", "clockwise"]);
    assert_eq!(warning(&all).0, 10);
    for imported in [good, one, all] {
        assert!((size(&imported) - 8.0).abs() < 1e-9);
    }
}

#[test]
fn holes_in_facets_are_reported() {
    // half of a face: its plane is still known
    let half = read(&cube(&[], &[3]));
    says(&half, &["`s` has holes", "3 of its edges", "facet 2"]);
    assert_eq!(warning(&half).0, 11 + 2);
    // without a whole face, the planes of the others enclose no volume
    let open = read(&cube(&[], &[2, 3]));
    assert!(open.scene.regions.is_empty());
    assert!(open.scene.warnings.iter().any(|warning| warning.message().contains("the solid `s` is refused")));
}

/// Geant4 stops with "Redefinition of constant or variable" at each of these.
#[test]
fn redefined_units_and_names_are_reported() {
    let cube = "<box name=\"w\" x=\"200\" y=\"200\" z=\"200\"/><box name=\"b\" x=\"2*cm\" y=\"2\" z=\"2\"/>";
    let with = |define: &str| read(&model(define, cube, &world(&placed(""), "")));
    let unit = with("<constant name=\"cm\" value=\"1\"/>");
    says(&unit, &["the constant `cm` has the name of a unit", "its value 1 instead of 10", "Geant4 rejects"]);
    assert_eq!(warning(&unit).0, 2);
    // the side is 2 of the file's own unit
    assert_eq!(along(&unit, [-50.0, 0.0, 0.0], [1.0, 0.0, 0.0])[1].0, 49.0);
    says(&with("<variable name=\"pi\" value=\"3\"/>"), &["the variable `pi`"]);
    says(&with("<quantity name=\"eV\" value=\"2\" unit=\"MeV\"/>"), &["the quantity `eV`"]);
    says(&with("<expression name=\"deg\">1</expression>"), &["the expression `deg`"]);
    for (kind, attributes) in [
        ("constant", "value=\"1\""),
        ("variable", "value=\"1\""),
        ("quantity", "value=\"1\" unit=\"mm\""),
        ("matrix", "coldim=\"2\" values=\"1 2 3 4\""),
    ] {
        let row = format!("<{kind} name=\"a\" {attributes}/>");
        assert!(with(&row).scene.warnings.is_empty(), "{kind}");
        says(&with(&row.repeat(2)), &[&format!("the {kind} `a` is defined again: the later value is used")]);
    }
    let options = Options { strict: true, ..Options::default() };
    let text = model("<constant name=\"cm\" value=\"1\"/>", cube, &world(&placed(""), ""));
    assert!(rayweave_formats::parse(&text, Format::Gdml, &[], &options).is_err());
}
