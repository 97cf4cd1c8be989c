//! The `[optics]` tables of model files: results against closed forms, and messages for invalid
//! tables.

mod elements;
mod files;
mod media;
mod problems;
mod sources;

use rayweave_optics::file::{OpticalScene, optics_of};
use rayweave_optics::{Segment, System, Trace, Tracer};
use rayweave_scene::{Diagnostics, parse_with};
use rayweave_trace::Packets;

fn read_with(text: &str, definitions: &[(&str, &str)]) -> Result<OpticalScene, Diagnostics> {
    let owned = |(name, value): &(&str, &str)| ((*name).to_owned(), (*value).to_owned());
    let definitions: Vec<_> = definitions.iter().map(owned).collect();
    let (document, scene) = parse_with(&format!("rayweave = 1\n{text}"), &definitions)?;
    optics_of(&document, &scene)
}

fn read(text: &str) -> OpticalScene {
    read_with(text, &[]).unwrap_or_else(|problems| panic!("{problems}\n{text}"))
}

struct Run {
    system: System,
    trace: Trace,
}

impl Run {
    fn new(optics: &OpticalScene) -> Run {
        let system = optics.assembly.compile().unwrap();
        let trace = Tracer::new(&system, Packets::new).trace(&optics.sources, &optics.settings).unwrap();
        assert!(trace.balance.error().abs() < 1e-12 * trace.balance.emitted);
        Run { system, trace }
    }

    /// The power that ends at an element.
    fn absorbed(&self, element: &str) -> f64 {
        self.trace.balance.absorbed[self.number(element)]
    }

    fn number(&self, element: &str) -> usize {
        self.system.element_names().iter().position(|name| name == element).unwrap()
    }

    /// The segments that end at an element.
    fn at(&self, element: &str) -> Vec<Segment> {
        let number = self.number(element) as i32;
        self.trace.segments.iter().filter(|segment| segment.element == number).collect()
    }
}

fn close(found: f64, expected: f64) {
    assert!((found - expected).abs() < 1e-12, "{found} is not {expected}");
}

/// Light along z from z = -10, with two screens: `reflected` at z = -20, behind the source, and
/// `transmitted` at z = 20, for reflected and transmitted light. Each case adds its element at the origin.
const BENCH: &str = r#"
[[optics.source]]
beam = { circle = 2, rays = 50 }
wavelength_nm = 550
transform = [{ translate = [0, 0, -10] }]
[[optics.sheet]]
name = "reflected"
rectangle = [400, 400]
action = "absorb"
transform = [{ translate = [0, 0, -20] }]
[[optics.sheet]]
name = "transmitted"
circle = 400
action = "absorb"
transform = [{ translate = [0, 0, 20] }]
"#;

/// A plate of an index about the origin.
fn plate(index: f64) -> String {
    format!("[solid.plate]\nbox = {{ size = [60, 60, 2] }}\n[medium.plate]\nindex = {index}\n")
}

/// Line, column and message of each problem, one per line.
fn problems(text: &str) -> String {
    let problems = read_with(text, &[]).map(|_| ()).unwrap_err();
    let line = |problem: &rayweave_scene::Diagnostic| {
        let (line, column) = problem.line_column().unwrap_or_default();
        format!("{line}:{column} {}\n", problem.message())
    };
    problems.iter().map(line).collect()
}

#[test]
fn settings() {
    use rayweave_optics::Branches;
    let text = "[optics]\nbranches = 'random'\npolarised = true\ngeneration_limit = 12\nthreshold = 1e-3\nseed = 5\n";
    let found = read(text).settings;
    assert_eq!((found.branches, found.polarised, found.seed), (Branches::Random, true, 5));
    assert_eq!((found.generation_limit, found.threshold), (12, 1e-3));
    assert_eq!(read("[optics]\n").settings.branches, Branches::Ideal);
}
