//! `rayweave shapes`: the shapes and their manual pages.

use crate::failure::Failure;
use crate::terminal;
use clap::Args;
use rayweave::shape::primitive::{MANUALS, build, manual};

/// List the shapes, or show the manual page of one
#[derive(Args)]
pub struct Shapes {
    /// The shape whose page is shown
    name: Option<String>,
}

/// Solids of outlines, which are not primitives but are written like them: name, parameters, summary, page.
const OUTLINES: [(&str, &str, &str, &str); 2] = [
    (
        "extrude",
        "outline, height",
        "an outline of edges and arcs moved along z",
        include_str!("../pages/extrude.md"),
    ),
    (
        "revolve",
        "outline",
        "an outline of edges and arcs revolved about z",
        include_str!("../pages/revolve.md"),
    ),
];

/// Keys of outlines, which other programs have as operations.
const CORNERS: [&str; 2] = ["fillet", "chamfer"];

impl Shapes {
    pub fn run(&self) -> Result<(), Failure> {
        match &self.name {
            None => terminal::print(&list()),
            Some(name) => terminal::print(&page(name)?),
        }
    }
}

fn list() -> String {
    let row = |page: &rayweave::shape::primitive::Manual| {
        let parameters: Vec<&str> = page.parameters.iter().map(|p| p.name).collect();
        let call = format!("{}({})", page.name, parameters.join(", "));
        vec![call, page.summary.to_owned()]
    };
    let outlines = OUTLINES
        .map(|(name, parameters, summary, _)| vec![format!("{name}({parameters})"), summary.to_owned()]);
    let rows: Vec<Vec<String>> = MANUALS.iter().map(row).chain(outlines).collect();
    terminal::table(&["shape", "is"], &rows, &[false, false])
}

fn page(name: &str) -> Result<String, Failure> {
    if let Some((.., page)) = OUTLINES.iter().find(|(own, ..)| *own == name) {
        return Ok((*page).to_owned());
    }
    match manual(name) {
        Some(page) => Ok(format!("# {}\n\n{}\n", page.name, page.text.trim_end())),
        None if CORNERS.contains(&name) => Err(Failure::Usage(format!(
            "unknown shape `{name}`: a {name} is no shape but a key of a point of an outline, or of the rim of an extrusion. See \
             `rayweave shapes extrude` and `rayweave shapes revolve`."
        ))),
        // the library composes the message for an unknown name
        None => {
            Err(Failure::Usage(build(name, &[]).map_or_else(|error| error.to_string(), |_| name.to_owned())))
        }
    }
}
