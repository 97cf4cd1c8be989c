//! The shader of a program: templates, specialised for what the program needs.

use crate::layout::{Kind, Layout};

/// Threads of a workgroup.
pub(crate) const WORKGROUP: u32 = 64;

/// The answer that the shader computes for each ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Entry {
    /// The first crossing, in one row.
    Nearest,
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
            Entry::Nearest | Entry::Start => 1,
            Entry::First => 2,
            Entry::All(most) => 1 + most,
        }
    }
}

/// The source of the shader for tables.
pub(crate) fn source(layout: &Layout, entry: Entry) -> String {
    let kinds = [
        (Kind::Sphere, "sphere"),
        (Kind::Cylinder, "cylinder"),
        (Kind::Quadric, "quadric"),
        (Kind::Ball, "ball"),
    ];
    let cases: String = kinds
        .into_iter()
        .filter(|(kind, _)| layout.kinds[*kind as usize])
        .map(|(kind, name)| format!("        case {}u: {{ roots = {name}(facet.x, r); }}\n", kind as u32))
        .collect();
    let placed = |used: bool, text: &str| if used { text.to_owned() } else { String::new() };
    let find = if layout.stack > 0 { include_str!("large.wgsl") } else { include_str!("small.wgsl") };
    let main = match entry {
        Entry::Nearest => include_str!("nearest.wgsl"),
        Entry::First => include_str!("first.wgsl"),
        Entry::All(_) => include_str!("all.wgsl"),
        Entry::Start => include_str!("start.wgsl"),
    };
    let parts = [include_str!("surfaces.wgsl"), include_str!("walk.wgsl"), find, main];
    let replacements = [
        ("@KINDS@\n", cases),
        (
            "@NETWORK@",
            (if layout.nodes > 32 { include_str!("network4.wgsl") } else { include_str!("network1.wgsl") })
                .to_owned(),
        ),
        (
            "@BALLS@\n",
            placed(
                layout.balls,
                "    let near = tables[params.atoms + 2u * k + 1u].x;\n    if near != NONE && passes(near, r) {\n        \
                 return Events(false, vec4f(BIG), NONE, NONE);\n    }\n",
            ),
        ),
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
        ("@ONLY_START@", (entry == Entry::Start).to_string()),
        ("@WORKGROUP@", WORKGROUP.to_string()),
        ("@ROOM@", format!("{:?}", crate::twin::Bounds::default().room)),
        ("@STEP@", format!("{:?}", crate::twin::Bounds::default().step)),
        ("@DIRECTION_ERROR@", format!("{:?}", crate::twin::DIRECTION_ERROR)),
    ];
    replacements.iter().fold(parts.join("\n"), |text, (name, value)| text.replace(name, value))
}
