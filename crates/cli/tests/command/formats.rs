//! Models of other programs.

use crate::bench::Bench;

const DUMP: &str = "difference() {\n\tcube(size = [4, 4, 4], center = true);\n\tsphere($fn = 8, $fa = 12, $fs = 2, r = 1);\n}\n";

#[test]
fn openscad_by_ending_and_by_option() {
    let bench = Bench::new();
    bench.write("part.csg", DUMP);
    bench.write("part.txt", DUMP);
    for arguments in [&["info", "part.csg"][..], &["info", "part.txt", "--format", "openscad"]] {
        let info = bench.says(arguments);
        assert!(info.contains("1 region") && info.contains("sphere"), "{info}");
    }
    // exactly round: 1 from the centre; with --facets the apothem of a facet
    let probe = ["probe", "part.csg", "--from", "-4,0.1,0.1", "--to", "4,0.1,0.1"];
    let round = bench.says(&probe);
    let faceted = bench.says(&[&probe[..], &["--facets"]].concat());
    assert!(round != faceted, "{round}");
    assert!(bench.says(&["info", "part.csg", "--facets"]).contains("convex"));
    assert!(bench.fails(2, &["info", "part.csg", "--format", "opensacd"]).contains("openscad"));
    assert!(bench.fails(3, &["info", "part.txt"]).contains("part.txt"));
}

#[test]
fn losses_are_reported_with_their_places() {
    let bench = Bench::new();
    bench.write("part.csg", format!("{DUMP}import(file = \"gone.stl\");\n"));
    let output = bench.run(&["info", "part.csg"]);
    let messages = &output.err;
    assert!(messages.contains("part.csg:5:1") && messages.contains("no file `gone.stl`"), "{messages}");
    assert!(output.out.contains("1 region"));
    bench.write("cut.csg", &DUMP[..40]);
    assert!(bench.fails(3, &["info", "cut.csg"]).contains("cut.csg:2:"));
}
