//! `render`: pictures.

use crate::bench::Bench;

const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Returns width and height from the header of a PNG file (PNG specification, section 11.2.2).
fn size(png: &[u8]) -> [u32; 2] {
    assert!(png.starts_with(SIGNATURE));
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    [number(16), number(20)]
}

/// Bit depth and colour type.
fn format(png: &[u8]) -> [u8; 2] {
    [png[24], png[25]]
}

fn picture(bench: &Bench, options: &[&str]) -> rayweave::render::Image {
    let files = ["render", "ball.toml", "-o", "out.png", "--size", "60x40"];
    let said = bench.says(&[&files, options].concat());
    assert_eq!(said, "out.png: 60 x 40 pixels\n");
    rayweave::render::png::decode(&bench.bytes("out.png")).unwrap()
}

#[test]
fn the_picture_is_named_like_the_model() {
    let bench = Bench::new();
    std::fs::create_dir(bench.path("sub")).unwrap();
    bench.write("sub/part.v2.toml", crate::bench::BALL);
    let said = bench.says(&["render", "sub/part.v2.toml", "--size", "32x24"]);
    assert_eq!(said, "part.v2.png: 32 x 24 pixels\n");
    assert_eq!(size(&bench.bytes("part.v2.png")), [32, 24]);
}

#[test]
fn a_ball_fills_the_middle_of_its_picture() {
    let bench = Bench::new();
    let image = picture(&bench, &["--view", "front", "--no-edges", "--shading", "flat"]);
    let [middle, corner] = [(30, 20), (0, 0)].map(|(x, y)| *image.get(x, y).unwrap());
    assert_eq!(corner, [255; 4]);
    assert_ne!(middle, corner);
    // the ball in one colour: the margin of the view around its disc is 4 % of the height
    let inside = image.values().iter().filter(|&&pixel| pixel != corner).count() as f64;
    let radius = 0.5 * (1.0 - 2.0 * 0.04) * 40.0;
    let disc = std::f64::consts::PI * radius * radius;
    assert!((inside - disc).abs() < 0.1 * disc, "{inside} for {disc}");
}

#[test]
fn a_cut_that_removes_nothing_is_noted() {
    let bench = Bench::new();
    let cut =
        |cut: &str| bench.run(&["render", "ball.toml", "-o", "out.png", "--size", "32x24", "--cut", cut]);
    for text in ["z>10", "x>0,y<-200"] {
        let run = cut(text);
        let expected =
            format!("note: --cut {text} removes nothing: the model reaches from (-1, -1, -1) to (1, 1, 1).");
        assert!(run.code == 0 && run.err.contains(&expected), "{}", run.err);
    }
    assert!(!cut("x>0,y<0").err.contains("note"));
}

#[test]
fn options_change_the_picture() {
    let bench = Bench::new();
    let plain = picture(&bench, &[]);
    assert_eq!(plain, picture(&bench, &["--edges", "--shading", "gooch", "--threads", "3"]));
    for options in [
        &["--no-edges"][..],
        &["--shading", "headlight"],
        &["--view", "top"],
        &["--fov", "90"],
        &["--samples", "1"],
        &["--shadows"],
        &["-D", "R=1e-3", "--solid", "ball", "--shading", "flat"],
    ] {
        assert_ne!(plain, picture(&bench, options), "{options:?}");
    }
    assert_eq!(plain, picture(&bench, &["--evaluator", "reference"]));
    assert_eq!(plain, picture(&bench, &["--shadows", "--no-shadows", "--no-edges", "--edges"]));
}

#[test]
fn kinds_of_pictures() {
    let bench = Bench::new();
    let kind = |name: &str| {
        bench.says(&["render", "ball.toml", "-o", "out.png", "--size", "16x12", "--kind", name]);
        format(&bench.bytes("out.png"))
    };
    // grey is colour type 0, RGB 2, RGBA 6
    assert_eq!(kind("colour"), [8, 6]);
    assert_eq!(kind("depth"), [16, 0]);
    assert_eq!(kind("normal"), [16, 2]);
    assert_eq!(kind("id"), [8, 6]);
}

#[test]
fn a_picture_goes_through_a_pipe() {
    let bench = Bench::new();
    let output = bench.command(&["render", "ball.toml", "--size", "8x8", "-o", "-"]).output().unwrap();
    assert_eq!(size(&output.stdout), [8, 8]);
    assert!(output.status.success() && output.stderr.is_empty());
}

/// The ball of radius 1 seen from the front fills 0.92 of the height of its picture; with three
/// quarters of its width cut away, it is the segment of a circle with a sagitta of 1/2, at the
/// same scale.
#[test]
fn a_cut_takes_away_a_part() {
    let bench = Bench::new();
    let options = ["--cut", "x>25%", "--view", "front", "--no-edges", "--shading", "flat"];
    let image = picture(&bench, &options);
    let corner = *image.get(0, 0).unwrap();
    // half of the pixels on its edge count as inside
    let whole = *image.get(16, 20).unwrap();
    let part = |&pixel: &[u8; 4]| {
        if pixel == whole {
            1.0
        } else if pixel == corner {
            0.0
        } else {
            0.5
        }
    };
    let inside: f64 = image.values().iter().map(part).sum();
    // r^2 acos(1 - h/r) - (r - h) sqrt(2 r h - h^2) with h = r / 2
    let radius = 0.92 * 20.0;
    let segment = radius * radius * (std::f64::consts::FRAC_PI_3 - 3_f64.sqrt() / 4.0);
    assert!((inside - segment).abs() < 0.04 * segment, "{inside} for {segment}");
}

/// Two boxes in contact, 2 and 3 long; exploded by half of the largest side, 5, they have a gap of
/// 2.5.
#[test]
fn regions_are_drawn_apart() {
    let bench = Bench::new();
    let columns = |options: &[&str]| {
        let files = ["render", "cemented.toml", "-o", "out.png", "--size", "300x60", "--view", "front"];
        bench.says(&[&files[..], &["--no-edges", "--opacity", "bath=0"], options].concat());
        let image = rayweave::render::png::decode(&bench.bytes("out.png")).unwrap();
        let row: Vec<_> = (0..300).map(|x| *image.get(x, 30).unwrap()).collect();
        row.chunk_by(|a, b| (*a == [255; 4]) == (*b == [255; 4])).map(<[_]>::len).collect::<Vec<_>>()
    };
    assert_eq!(columns(&[]).len(), 3);
    // they are 2 high, which is 0.92 of the height of the picture
    let found = columns(&["--explode", "x:0.5"]);
    let expected = [2.0, 2.5, 3.0].map(|length| 0.92 * 60.0 * length / 2.0);
    assert_eq!(found.len(), 5, "{found:?}");
    for (found, expected) in found[1..4].iter().zip(expected) {
        assert!((*found as f64 - expected).abs() < 1.5, "{found} for {expected}");
    }
}

#[test]
fn sheets_and_legends() {
    let bench = Bench::new();
    let said =
        bench.says(&["render", "cemented.toml", "--view", "sheet", "-o", "sheet.svg", "--size", "640x480"]);
    assert_eq!(said, "sheet.svg: 640 x 480 pixels\n");
    let svg = String::from_utf8(bench.bytes("sheet.svg")).unwrap();
    assert_eq!(svg.matches("<image ").count(), 4);
    for name in ["front", "top", "right", "iso"] {
        assert!(svg.contains(&format!(">{name}</text>")), "{name}");
    }
    bench.says(&["render", "ball.toml", "--legend", "-o", "one.svg", "--size", "120x90"]);
    let svg = String::from_utf8(bench.bytes("one.svg")).unwrap();
    assert!(svg.contains(">glass</text>") && svg.matches("<image ").count() == 1);
    bench.says(&["render", "ball.toml", "--legend", "-o", "one.png", "--size", "120x90"]);
    assert_eq!(size(&bench.bytes("one.png")), [120, 90]);
    // the ball is in the picture, above the legend
    let image = rayweave::render::png::decode(&bench.bytes("one.png")).unwrap();
    assert!(*image.get(60, 30).unwrap() != [255; 4] && *image.get(100, 84).unwrap() == [255; 4]);
}

#[test]
fn technical_drawings() {
    let bench = Bench::new();
    let plate = "rayweave = 1\n[solid.plate]\nbox = { size = [60, 40, 8] }\n[solid.hole]\ncylinder = { radius = 3 }\n\
        [solid.part]\nexpr = \"plate - hole\"\n[[region]]\nsolid = \"part\"\n";
    bench.write("plate.toml", plate);
    let draw = ["render", "plate.toml", "--view", "sheet", "--dimensions"];
    let said = bench.says(&[&draw[..], &["-o", "plate.svg"]].concat());
    assert_eq!(said, "wrote plate.svg\n");
    let svg = bench.read("plate.svg");
    for text in ["\u{2300}6 through", "60", "40", "8"] {
        assert!(svg.contains(&format!(">{text}</text>")), "{text}: {svg}");
    }
    assert!(svg.contains("scale 2:1") && svg.contains("third-angle projection"), "{svg}");
    bench.says(&[&draw[..], &["--projection", "first", "-o", "plate.pdf"]].concat());
    assert!(bench.bytes("plate.pdf").starts_with(b"%PDF-"));
    let without = bench.fails(2, &["render", "plate.toml", "--view", "top", "--dimensions", "-o", "p.png"]);
    assert!(without.contains("Add --view sheet."), "{without}");
    let cut = bench.fails(2, &[&draw[..], &["--cut", "x>0", "-o", "p.svg"]].concat());
    assert!(cut.starts_with("error: --cut and --dimensions are given: "), "{cut}");
    let section = "section plate.toml --plane x=0 --hatch --dimensions -o section.svg";
    assert!(cut.contains(&format!("`rayweave {section}`")), "{cut}");
    bench.says(&section.split(' ').collect::<Vec<_>>());
    // the advice for a percentage works, too
    let cut = bench.fails(2, &[&draw[..], &["--cut", "y<50%", "-o", "p.svg"]].concat());
    let section = section.replace("x=0", "y=50%");
    assert!(cut.contains(&format!("`rayweave {section}`")), "{cut}");
    bench.says(&section.split(' ').collect::<Vec<_>>());
}

#[test]
fn wrong_views() {
    let bench = Bench::new();
    let fails = |options: &[&str]| bench.fails(2, &[&["render", "ball.toml"], options].concat());
    assert!(fails(&["--cut", "x"]).contains("neither < nor >"));
    assert!(fails(&["--explode", "up"]).contains("such as z:0.2"));
    assert!(fails(&["--opacity", "glas=0.3"]).contains("Did you mean `glass`?"));
    assert!(fails(&["--opacity", "glass=3"]).contains("from 0 to 1"));
    assert!(fails(&["--view", "sheet", "--kind", "depth"]).contains("are in colour"));
    assert!(fails(&["--view", "sheet", "--size", "40x40"]).contains("leave no room"));
    assert!(fails(&["--legend", "-o", "a.gif"]).contains(".png or .jpg"));
    assert_eq!(bench.files(), ["ball.toml", "cemented.toml"]);
}

#[test]
fn wrong_options() {
    let bench = Bench::new();
    let fails = |code, options: &[&str]| bench.fails(code, &[&["render", "ball.toml"], options].concat());
    assert!(fails(2, &["--size", "0x0"]).contains("0 x 0 pixels"));
    assert!(fails(2, &["--size", "big"]).contains("such as 640x480"));
    assert!(fails(2, &["--view", "above"]).contains("front, back, left, right, top, bottom, iso, sheet"));
    assert!(fails(2, &["--samples", "0"]).contains("1..=16"));
    assert!(fails(2, &["--fov", "180"]).contains("the field of view is 180 degrees"));
    assert!(fails(2, &["--solid", "bell"]).contains("Did you mean `ball`?"));
    assert!(fails(2, &["-o", "out.gif"]).contains("pictures are written as .png or .jpg"));
    assert!(fails(1, &["-o", "nowhere/out.png"]).contains("the folder nowhere does not exist"));
    assert_eq!(bench.files(), ["ball.toml", "cemented.toml"]);
}

/// Width and height of a JPEG file: those of its frame header (ITU-T T.81, B.2.2).
fn jpeg_size(bytes: &[u8]) -> [usize; 2] {
    let word = |at: usize| usize::from(bytes[at]) << 8 | usize::from(bytes[at + 1]);
    let mut at = 2;
    while bytes[at + 1] != 0xc0 {
        at += 2 + word(at + 2);
    }
    [word(at + 7), word(at + 5)]
}

#[test]
fn pictures_as_jpeg_and_pdf() {
    let bench = Bench::new();
    let said = bench.says(&["render", "ball.toml", "-o", "a.jpg", "--size", "60x40"]);
    assert_eq!(said, "a.jpg: 60 x 40 pixels\n");
    assert_eq!(jpeg_size(&bench.bytes("a.jpg")), [60, 40]);
    bench.says(&["render", "ball.toml", "-o", "b.jpeg", "--size", "160x120", "--legend"]);
    assert_eq!(jpeg_size(&bench.bytes("b.jpeg")), [160, 120]);
    bench.says(&["render", "ball.toml", "-o", "c.pdf", "--size", "160x120", "--legend"]);
    let pdf = String::from_utf8_lossy(&bench.bytes("c.pdf")).into_owned();
    assert!(
        pdf.starts_with("%PDF-") && pdf.contains("/Subtype /Image") && pdf.contains("/MediaBox [0 0 120 90]")
    );
    let fails = |more: &[&str]| bench.fails(2, &[&["render", "ball.toml", "-o", "x.jpg"], more].concat());
    assert!(fails(&["--kind", "depth"]).contains("JPEG changes numbers"));
    assert!(fails(&["--range", "0:10"]).contains("cannot be joined"));
    assert_eq!(bench.files(), ["a.jpg", "b.jpeg", "ball.toml", "c.pdf", "cemented.toml"]);
}
