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
    let rows: Vec<Vec<String>> = MANUALS.iter().map(row).collect();
    terminal::table(&["shape", "is"], &rows, &[false, false])
}

fn page(name: &str) -> Result<String, Failure> {
    match manual(name) {
        Some(page) => Ok(format!("# {}\n\n{}\n", page.name, page.text.trim_end())),
        // the library composes the message for an unknown name
        None => {
            Err(Failure::Usage(build(name, &[]).map_or_else(|error| error.to_string(), |_| name.to_owned())))
        }
    }
}
