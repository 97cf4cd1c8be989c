//! Files with the line ends of Windows (CRLF) mean the same as those with LF.

use crate::bench::Bench;

/// A mesh in each text format that no command writes.
const TETRAHEDRON: [(&str, &str); 2] = [
    (
        "part.stl",
        "solid part\n\
         facet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 0 0\nendloop\nendfacet\n\
         facet normal 0 -1 0\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 1\nendloop\nendfacet\n\
         facet normal -1 0 0\nouter loop\nvertex 0 0 0\nvertex 0 0 1\nvertex 0 1 0\nendloop\nendfacet\n\
         facet normal 1 1 1\nouter loop\nvertex 1 0 0\nvertex 0 1 0\nvertex 0 0 1\nendloop\nendfacet\n\
         endsolid part\n",
    ),
    (
        "part.ply",
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
         element face 4\nproperty list uchar int vertex_indices\nend_header\n\
         0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
    ),
];

#[test]
fn models() {
    let (unix, windows) = (Bench::new(), Bench::new());
    let mut names = vec!["cemented.toml".to_owned()];
    for ending in ["csg", "gdml", "obj", "off"] {
        let name = format!("part.{ending}");
        let done = unix.run(&["convert", "cemented.toml", &name, "--tolerance", "0.5"]);
        assert_eq!(done.code, 0, "{}", done.err);
        names.push(name);
    }
    for (name, text) in TETRAHEDRON {
        unix.write(name, text);
        names.push(name.to_owned());
    }
    for name in names {
        let text = unix.read(&name);
        assert!(text.lines().count() > 5 && !text.contains('\r'), "{name}");
        windows.write(&name, text.replace('\n', "\r\n"));
        let info = |bench: &Bench| bench.says(&["info", &name, "--json"]);
        assert_eq!(info(&windows), info(&unix), "{name}");
    }
}

#[test]
fn contours_and_rays() {
    let traces = |text: &str| {
        let bench = Bench::new();
        bench.write("plate.csv", text);
        bench.says(&["-q", "infill", "plate.csv", "--spacing", "1", "-o", "traces.csv"]);
        bench.bytes("traces.csv")
    };
    let plate = include_str!("../../../../models/plate.csv");
    assert_eq!(traces(&plate.replace('\n', "\r\n")), traces(plate));
    let hits = |text: &str| {
        let bench = Bench::new();
        bench.write("rays.csv", text);
        bench.says(&["-q", "trace", "ball.toml", "--rays", "rays.csv", "-o", "hits.csv"]);
        bench.bytes("hits.csv")
    };
    let rays = "ox,oy,oz,dx,dy,dz\n-2,0,0,1,0,0\n-2,0.5,0,1,0,0\n";
    assert_eq!(hits(&rays.replace('\n', "\r\n")), hits(rays));
}
