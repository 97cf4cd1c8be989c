//! Damaged dumps: an error with a position, no panic, no hang.

use crate::measure::read;
use rayweave_formats::{Format, LossKind, Options, parse};
use std::time::{Duration, Instant};

const MODEL: &str = "group() {\n\tdifference() {\n\t\tcube(size = [30, 30.5, 3e1], center = true);\n\t\t#multmatrix([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -5], [0, 0, 0, 1]]) {\n\t\t\tsphere($fn = 0, r = 20);\n\t\t}\n\t\ttext(text = \"a\\\"b\");\n\t}\n}\n";

/// Message of the first problem, with its position.
fn problem(text: &str) -> (String, Option<(usize, usize)>) {
    let problems = parse(text, Format::OpenScad, &[], &Options::default()).expect_err(text);
    let first = problems.iter().next().expect("there is one");
    (first.message().to_owned(), first.line_column())
}

#[test]
fn cut_off_at_every_byte() {
    for end in (0..MODEL.len()).filter(|end| MODEL.is_char_boundary(*end)) {
        let read = parse(&MODEL[..end], Format::OpenScad, &[], &Options::default());
        // only the empty text and the text without its last line end are valid
        assert_eq!(read.is_ok(), end == 0 || end == MODEL.len() - 1, "{}", &MODEL[..end]);
    }
}

#[test]
fn problems_have_places() {
    let cases = [
        ("cube(1);\n}", "this `}` closes nothing", (2, 1)),
        ("group() {\ncube(1);", "`}` is missing", (2, 9)),
        ("cube(1;", "unexpected `;`", (1, 7)),
        ("cube[1];", "unexpected `[`", (1, 5)),
        ("group() }", "unexpected `}`", (1, 9)),
        ("cube(size = [1, 2);", "unexpected `)`", (1, 18)),
        ("cube(1e400);", "`1e400` is too large", (1, 6)),
        ("cube(size = -);", "unexpected `)`", (1, 14)),
        ("\u{e4};", "this is not an OpenSCAD dump", (1, 1)),
        ("solid part\n facet normal 0 0 1", "`(` is missing", (1, 7)),
        ("cube(size = cubic);", "unexpected `cubic`", (1, 13)),
        ("text(text = \"abc", "a value is missing", (1, 13)),
    ];
    for (text, message, place) in cases {
        let (found, at) = problem(text);
        assert!(found.starts_with(message) || found.starts_with("unexpected `part`"), "{text}: {found}");
        assert_eq!(at, Some(place), "{text}: {found}");
    }
}

#[test]
fn all_numbers_that_are_too_large_are_reported_at_once() {
    let text = "cube(1e400);\nsphere(r = -1e999);\ncube(";
    let problems = parse(text, Format::OpenScad, &[], &Options::default()).expect_err(text);
    assert_eq!(problems.len(), 3, "{problems}");
}

#[test]
fn deep_nesting_uses_no_call_stack() {
    let deep = 100_000;
    let matrix = "multmatrix([[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])";
    let texts = [
        format!("{}cube(1);{}", "group() {".repeat(deep), "}".repeat(deep)),
        format!("{}cube(1);", "union() ".repeat(deep)),
        format!("{}cube(1);", "color([1, 0, 0, 1]) difference() ".repeat(deep)),
        format!("{}cube(1);{}", format!("{matrix} {{").repeat(deep), "}".repeat(deep)),
    ];
    let worker = std::thread::Builder::new().stack_size(256 << 10).spawn(move || {
        for text in &texts {
            assert_eq!(read(text, false).scene.regions.len(), 1);
        }
        let lists = format!("cube({});", "[".repeat(deep));
        assert!(problem(&lists).0.starts_with("this list is nested too deeply"));
        let open = "group() {".repeat(deep);
        assert!(problem(&open).0.starts_with("`}` is missing"));
    });
    worker.expect("a thread").join().expect("no overflow");
}

/// Message, with the position, of the error that a dump exceeds its limits.
fn limit(text: &str, facets: bool) -> (String, Option<(usize, usize)>) {
    let options = Options { facets, ..Options::default() };
    let start: String = text.chars().take(80).collect();
    match parse(text, Format::OpenScad, &[], &options) {
        Ok(imported) => panic!("{start} is read: {}", imported.report.warnings()),
        Err(problems) => {
            let first = problems.iter().next().expect("there is one");
            (first.message().to_owned(), first.line_column())
        }
    }
}

/// Items of a few bytes that would take minutes or gigabytes cause an error that names the item. The limits count work, so
/// the test does not depend on the machine.
#[test]
fn explosive_items_are_errors() {
    let nested = |item: &str, count: usize, inner: &str| format!("{}{inner}", item.repeat(count));
    let map = "multmatrix([[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]) ";
    let random = |count: usize| {
        let mut state = 1u64;
        let mut number = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 54
        };
        let points: Vec<String> = (0..count).map(|_| format!("[{}, {}]", number(), number())).collect();
        format!("polygon(points = [{}]);", points.join(", "))
    };
    let colours: String =
        (0..9000).map(|k| format!("color([0.{}, 0.{}, 0, 1]) cube();", k / 100 + 10, k % 100 + 10)).collect();
    let cases = [
        ("sphere(r = 5, $fn = 5000);".to_owned(), true, "sphere()"),
        ("hull() sphere(r = 5, $fn = 9000);".to_owned(), true, "sphere()"),
        ("linear_extrude(height = 1, twist = 9, slices = 20000) circle(r = 3, $fn = 500);".into(), false, ""),
        (nested("hull() ", 100_000, "cube(1);"), false, "hull()"),
        (nested("resize([2, 2, 2]) ", 40_000, "cube(1);"), false, "resize()"),
        (nested("resize([2, 2, 2]) ", 40_000, "square(1);"), false, "resize()"),
        (format!("{} {{ {colours} }}", map.repeat(5000)), false, "multmatrix()"),
        (format!("linear_extrude(height = 1) {}", random(40_000)), false, "linear_extrude()"),
        (format!("linear_extrude(height = 1) offset(delta = 1) {}", random(40_000)), false, "offset()"),
        (format!("rotate_extrude() {}", random(40_000)), false, "rotate_extrude()"),
    ];
    for (text, facets, item) in cases {
        let (message, place) = limit(&text, facets);
        assert!(message.starts_with(item) && message.contains("all together"), "{message}");
        assert!(place.is_some(), "{message}: {place:?}");
    }
}

/// Huge counts, which would exhaust memory, are refused with their item.
#[test]
fn huge_counts() {
    for (text, message) in [
        ("linear_extrude(height = 1, twist = 90, slices = 1e9) square(1);", "more than 20000 slices"),
        ("cylinder(h = 1, r1 = 1, r2 = 1, $fn = 1e9);", "$fn is more than 10000"),
        ("text(text = \"a\", $fn = 1e300);", "$fn is more than 10000"),
    ] {
        let options = Options { facets: true, ..Options::default() };
        let imported = parse(text, Format::OpenScad, &[], &options).expect("a dump");
        let messages = imported.report.warnings().to_string();
        assert!(messages.contains(message), "{text}: {messages}");
    }
}

#[test]
fn damaged_bytes_never_panic() {
    use rand::{Rng, RngExt, SeedableRng};
    let mut rng = rand::rngs::ChaCha8Rng::seed_from_u64(8);
    let alphabet: Vec<char> = "(){}[];,=\"-.$%#*!e09 azx\u{e4}\n".chars().collect();
    let start = Instant::now();
    for _ in 0..2000 {
        let mut characters: Vec<char> = MODEL.chars().collect();
        for _ in 0..1 + rng.next_u32() % 3 {
            let at = rng.random_range(0..characters.len());
            characters[at] = alphabet[rng.random_range(0..alphabet.len())];
        }
        let text: String = characters.into_iter().collect();
        // either result is fine, as long as the call returns
        let _ = parse(&text, Format::OpenScad, &[], &Options::default());
    }
    assert!(start.elapsed() < Duration::from_secs(60));
}

#[test]
fn parameters_are_refused() {
    let overrides = [("R".to_owned(), "1".to_owned())];
    let problems =
        parse("cube(1);", Format::OpenScad, &overrides, &Options::default()).expect_err("no parameters");
    assert!(problems.to_string().contains("have no parameters"), "{problems}");
}

/// Coordinates at which `i_overlay` panics or loses points.
#[test]
fn points_that_are_too_far_out_are_refused() {
    let thin = |far: &str| format!("polygon(points = [[0, 0], [{far}, 4], [4, 0], [0, 4]], paths = undef);");
    let cases = [
        (format!("rotate_extrude() {}", thin("1e153")), "too far out"),
        (format!("rotate_extrude() {}", thin("1e20")), "too thin relative to the size"),
        (
            format!("linear_extrude(height = 1) offset(delta = 1) {}", thin("1e20")),
            "too thin relative to the size",
        ),
        ("linear_extrude(height = 1) offset(delta = 1e155) square(1);".to_owned(), "too far out"),
        (
            "linear_extrude(height = 1) offset(delta = 1) { square(1e20); square(1); }".to_owned(),
            "too thin relative to the size",
        ),
    ];
    for (text, why) in cases {
        let report = read(&text, false).report;
        assert!(report.count(LossKind::Refused) > 0, "{text}");
        let first = report.iter().next().expect("one");
        assert!(report.warnings().to_string().contains(why), "{text}\n{}", report.warnings());
        assert!(first.first.line_column().is_some(), "{text}");
    }
    // small relative to the drawing, but not lost
    assert!(
        read("rotate_extrude() polygon(points = [[0, 0], [1e9, 4], [4, 0], [0, 4]]);", false)
            .report
            .is_empty()
    );
}
