//! `rayweave watch`: a picture that follows its model.

use crate::arguments::GlobalArguments;
use crate::command::Render;
use crate::failure::Failure;
use crate::{interrupt, outputs, terminal};
use clap::Args;
use rayweave::table::{FileStamp, record_opened};
use std::thread::sleep;
use std::time::Duration;

/// Render a picture of a model, again whenever the model changes
///
/// The files that the model refers to, such as meshes, drawings and tables, are watched as well. The messages of a model with errors are printed, and the last picture
/// stays until the model is correct again. Ctrl-C ends the command with exit code 130; the picture is complete at all times.
#[derive(Args)]
#[command(after_help = "\
Examples:
  rayweave watch part.toml
  rayweave watch part.toml --view sheet -o part.svg")]
pub struct Watch {
    #[command(flatten)]
    render: Render,
}

/// The interval at which the files are examined.
const INTERVAL: Duration = Duration::from_millis(100);

impl Watch {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        self.render.check_repeatable()?;
        loop {
            let model = FileStamp::of(self.render.model_file());
            outputs::take_read();
            let (drawn, mut files) = record_opened(|| self.render.run(global));
            files.extend(outputs::take_read());
            files.push(model);
            match drawn {
                Ok(()) => {}
                Err(failure @ (Failure::Usage(_) | Failure::Cancelled)) => return Err(failure),
                Err(failure) => {
                    terminal::report(&failure);
                }
            }
            if !global.quiet {
                let files =
                    if files.len() == 1 { "1 file".to_owned() } else { format!("{} files", files.len()) };
                terminal::note(&format!("watching {files}; Ctrl-C ends"));
            }
            wait(&files)?;
        }
    }
}

/// Waits until one of the files has changed and all have then remained the same for an interval: programs may write a file in
/// several steps.
fn wait(files: &[FileStamp]) -> Result<(), Failure> {
    let pause = || {
        sleep(INTERVAL);
        if interrupt::token().is_cancelled() { Err(Failure::Cancelled) } else { Ok(()) }
    };
    while !files.iter().any(FileStamp::has_changed) {
        pause()?;
    }
    loop {
        let now: Vec<FileStamp> = files.iter().map(|file| FileStamp::of(&file.path)).collect();
        pause()?;
        if !now.iter().any(FileStamp::has_changed) {
            return Ok(());
        }
    }
}
