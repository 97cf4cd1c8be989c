//! `rayweave new`: a commented model to start from.

use crate::arguments::GlobalArguments;
use crate::failure::Failure;
use crate::terminal;
use clap::{Args, ValueEnum};
use std::fs::OpenOptions;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Write a commented model file to start from
///
/// An existing file is never overwritten.
#[derive(Args)]
#[command(after_help = "\
Examples:
  rayweave new part.toml
  rayweave new lens.toml lens
  rayweave new -                     # print it")]
pub struct New {
    /// The file to write; - is standard output
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// What the model describes
    #[arg(value_name = "KIND", default_value = "part")]
    kind: Kind,
}

/// The models to start from.
#[derive(Clone, Copy, ValueEnum)]
enum Kind {
    /// A plate with holes and a slot
    Part,
    /// An angle bracket
    Bracket,
    /// A lens with a beam of light and a screen
    Lens,
    /// Crystal tiles on a sensor board
    Detector,
}

impl Kind {
    fn text(self) -> &'static str {
        match self {
            Kind::Part => include_str!("../starters/part.toml"),
            Kind::Bracket => include_str!("../starters/bracket.toml"),
            Kind::Lens => include_str!("../starters/lens.toml"),
            Kind::Detector => include_str!("../starters/detector.toml"),
        }
    }
}

impl New {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let name = self.file.display().to_string();
        if self.file == Path::new("-") {
            return terminal::print(&self.kind.text().replace("FILE", "FILE.toml"));
        }
        // with another ending, the file would be read as a different format
        if !self.file.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml")) {
            let text = format!(
                "cannot write {name}: the model is written as TOML. Choose a name that ends in .toml."
            );
            return Err(Failure::Usage(text));
        }
        // a line break in the name would end the comment
        let shown = if name.contains(char::is_control) { "FILE.toml" } else { &name };
        let text = self.kind.text().replace("FILE", shown);
        self.create(&text).map_err(|error| {
            let reason = match error.kind() {
                ErrorKind::AlreadyExists => "the file exists. Choose another name or remove it".to_owned(),
                ErrorKind::NotFound => match self.file.parent() {
                    Some(folder) if !folder.exists() => {
                        format!("the folder {} does not exist. Create it first", folder.display())
                    }
                    _ => error.to_string(),
                },
                _ => error.to_string(),
            };
            Failure::Run(format!("cannot write {name}: {reason}."))
        })?;
        match global.quiet {
            true => Ok(()),
            false => terminal::print(&format!("{name}\n")),
        }
    }

    /// Writes the file if it does not exist yet: completely or not at all.
    fn create(&self, text: &str) -> std::io::Result<()> {
        let mut file = OpenOptions::new().write(true).create_new(true).open(&self.file)?;
        file.write_all(text.as_bytes()).inspect_err(|_| {
            // the error of the write is reported, not one of the removal
            std::fs::remove_file(&self.file).ok();
        })
    }
}
