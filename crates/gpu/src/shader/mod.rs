//! The shader of a program: templates, specialised for what the program needs.

use crate::codes::{Kind, declarations};
use crate::double::Doubles;
use crate::frame::{MOST_TOLERANCE, NEAR, TOLERANCE};
use crate::layout::Layout;
use rayweave_math::UNIT_ROUNDOFF;

/// Operations in double precision whose results the compiler of the device cannot change.
pub(crate) const ARITHMETIC: &str = include_str!("arithmetic.wgsl");

/// Vectors and lines in double precision.
pub(crate) const VECTORS: &str = include_str!("vectors.wgsl");

/// As `DOT_NOISE` in `surface/along.rs`, and `SLOW_SQUARE` in `surface/cylinder.rs`.
pub(crate) const DOT_NOISE: f64 = 8.0 * UNIT_ROUNDOFF;
pub(crate) const SLOW_SQUARE: f64 = 1e-4;

/// Words before the numbers of the pixels, for rays through pixels.
pub(crate) const PIXELS: usize = 31;

/// Threads of a workgroup.
pub(crate) const WORKGROUP: u32 = 64;

/// The answer that the shader computes for each ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Entry {
    /// The first crossing, in one row.
    Nearest,
    /// The first crossing after t = 0, in one row, of rays in double precision, with its time in double precision.
    Completed,
    /// Like [`Entry::Completed`], of rays through pixels, which the device computes.
    Pixels,
    /// The region at the start of the window and the first crossing.
    First,
    /// The region at the start of the window and up to a number of crossings.
    All(usize),
    /// The region at the start of the window.
    Start,
}

impl Entry {
    /// Rows of an answer.
    pub fn rows(self) -> usize {
        match self {
            Entry::Nearest | Entry::Completed | Entry::Pixels | Entry::Start => 1,
            Entry::First => 2,
            Entry::All(most) => 1 + most,
        }
    }

    /// True if the kernel has rays in double precision and returns times in it.
    pub fn completes(self) -> bool {
        matches!(self, Entry::Completed | Entry::Pixels)
    }
}

/// The source of the shader for tables.
pub(crate) fn source(layout: &Layout, entry: Entry, doubles: Option<&Doubles>) -> String {
    let placed = |used: bool, text: &str| if used { text.to_owned() } else { String::new() };
    let find = if layout.stack > 0 { include_str!("large.wgsl") } else { include_str!("small.wgsl") };
    let answer = match entry {
        Entry::Nearest => include_str!("nearest.wgsl"),
        Entry::Completed | Entry::Pixels => include_str!("double.wgsl"),
        Entry::First => include_str!("first.wgsl"),
        Entry::All(_) => include_str!("all.wgsl"),
        Entry::Start => include_str!("start.wgsl"),
    };
    let rays = if entry.completes() { "" } else { include_str!("rays.wgsl") };
    let lines =
        if entry == Entry::Pixels { include_str!("pixels.wgsl") } else { include_str!("columns.wgsl") };
    let parts = [
        include_str!("surfaces.wgsl"),
        if layout.kinds[Kind::FirstChord as usize] { include_str!("torus.wgsl") } else { "" },
        include_str!("walk.wgsl"),
        rays,
        find,
        answer,
        include_str!("main.wgsl"),
    ];
    let rows = |count: Option<usize>| count.unwrap_or(1).max(1).to_string();
    let number = |x: f64| format!("{x:?}");
    let replacements = [
        ("@SHARED@", declarations()),
        ("@KINDS@\n", cases(layout)),
        ("@WALK@", walk(layout)),
        ("@GROUP@", (if layout.is_simple { "row.w" } else { "row.x" }).to_owned()),
        ("@DATA_ROWS@", layout.data.len().max(1).to_string()),
        ("@TABLE_ROWS@", layout.tables.len().max(1).to_string()),
        (
            "@PLACED_ATOM@\n",
            placed(
                layout.placed_atoms,
                "    if atom.z != NONE {\n        r = placed(atom.z, group_ray);\n    }\n",
            ),
        ),
        (
            "@PLACED_ITEM@\n",
            placed(
                layout.placed_items,
                "            if row.y != NONE {\n                local = placed(row.y, r);\n            }\n",
            ),
        ),
        ("@ATOMS@", format!("{}u", layout.atoms)),
        ("@STACK@", format!("{}", layout.stack.max(1))),
        ("@MOST@", format!("{}u", entry.rows() - 1)),
        ("@COMPLETES@", entry.completes().to_string()),
        ("@ONLY_START@", (entry == Entry::Start).to_string()),
        ("@LINES@", lines.to_owned()),
        ("@PIXELS@", PIXELS.to_string()),
        ("@ARITHMETIC@", ARITHMETIC.to_owned()),
        ("@VECTORS@", VECTORS.to_owned()),
        ("@EXACT_ROWS@", rows(doubles.map(|doubles| doubles.exact.len()))),
        ("@LOOKUP_ROWS@", rows(doubles.map(|doubles| doubles.lookup.len()))),
        ("@NEAR@", number(NEAR)),
        ("@NEAR_SQUARE@", number(0.25 * NEAR * NEAR)),
        ("@TOLERANCE@", number(TOLERANCE)),
        ("@MOST_TOLERANCE@", number(MOST_TOLERANCE)),
        ("@DOT_NOISE@", number(DOT_NOISE)),
        ("@SLOW_SQUARE@", number(SLOW_SQUARE)),
        ("@WORKGROUP@", WORKGROUP.to_string()),
        ("@ROOM@", format!("{:?}", crate::twin::Bounds::default().room)),
        ("@STEP@", format!("{:?}", crate::twin::Bounds::default().step)),
        ("@DIRECTION_ERROR@", format!("{:?}", crate::twin::DIRECTION_ERROR)),
    ];
    replacements.iter().fold(parts.join("\n"), |text, (name, value)| text.replace(name, value))
}

/// The cases of the kinds of surfaces in use, except planes.
fn cases(layout: &Layout) -> String {
    let kinds = [
        (Kind::Sphere, "sphere"),
        (Kind::Cylinder, "cylinder"),
        (Kind::Quadric, "quadric"),
        (Kind::Ball, "ball"),
        (Kind::FirstChord, "torus"),
        (Kind::SecondChord, "torus"),
    ];
    kinds
        .into_iter()
        .filter(|(kind, _)| layout.kinds[*kind as usize])
        .map(|(kind, name)| {
            let chord = match kind {
                Kind::FirstChord => ", false",
                Kind::SecondChord => ", true",
                _ => "",
            };
            format!("        case {}u: {{ roots = {name}(facet.x, r{chord}); }}\n", kind as u32)
        })
        .collect()
}

/// The walk along a group: through its network, or along its only atom.
fn walk(layout: &Layout) -> String {
    if layout.is_simple {
        return include_str!("single.wgsl").to_owned();
    }
    let network =
        if layout.nodes > 32 { include_str!("network4.wgsl") } else { include_str!("network1.wgsl") };
    // first all balls and then the events of the atoms near the ray, so that rays near different atoms compute events at the same
    // time
    let (near, atom) =
        if layout.balls { (include_str!("near.wgsl"), "which[j]") } else { ("    let near = group.y;", "j") };
    include_str!("network.wgsl")
        .replace("@NETWORK@", network)
        .replace("@NEAR_ATOMS@", near.trim_end_matches('\n'))
        .replace("@NEAR_ATOM@", atom)
}
