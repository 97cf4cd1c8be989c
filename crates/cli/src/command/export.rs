//! `rayweave export`: export of a model to another program.

use crate::arguments::{GlobalArguments, ModelArguments, OnlyArguments};
use crate::failure::Failure;
use crate::terminal;
use clap::Args;
use rayweave::picture::{PictureOptions, arrange};
use rayweave::render::{Camera, Projection};
use rayweave::scene;
use rayweave::{Compiled, Vec3};
use std::path::{Path, PathBuf};

/// Write a model as a POV-Ray scene
///
/// Uses the camera of the model file; without one, the view shows the whole model. Standard error lists what will look different
/// in POV-Ray.
#[derive(Args)]
#[command(after_help = "\
Example:
  rayweave export lens.toml lens.pov
  povray +Ilens.pov +Olens.png +W1280 +H720 -A")]
pub struct Export {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    only: OnlyArguments,

    /// Output file, .pov; - is standard output
    #[arg(value_name = "OUT.pov")]
    out: PathBuf,
}

impl Export {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        let is_pov = self.out.extension().is_some_and(|e| e.eq_ignore_ascii_case("pov"));
        if !is_pov && self.out != Path::new("-") {
            return Err(Failure::Usage(format!(
                "{}: unknown format: models are exported as .pov. `rayweave convert` writes other formats.",
                self.out.display()
            )));
        }
        let mut scene = self.only.of(self.model.import_scene()?)?;
        let compiled = Compiled::new(&scene)?;
        let (camera, settings) = arrange(&scene, &compiled, &PictureOptions::default())?;
        let size = (settings.size.width() as u32, settings.size.height() as u32);
        scene.camera = Some(exported(&camera, size));
        let written = scene.to_povray().map_err(|problem| Failure::Run(problem.to_string()))?;
        for loss in &written.losses {
            terminal::note(&format!("lost: {loss}"));
        }
        if self.model.strict && !written.losses.is_empty() {
            return Err(crate::failure::lossy(&self.out));
        }
        terminal::save(&self.out, written.text.as_bytes())?;
        terminal::wrote(&self.out, global.quiet)
    }
}

/// Converts a camera to that of a scene.
fn exported(camera: &Camera, size: (u32, u32)) -> scene::Camera {
    let (position, up): (Vec3, Vec3) = (camera.position(), camera.up());
    scene::Camera {
        projection: match camera.projection() {
            Projection::Perspective { field_of_view } => {
                scene::Projection::Perspective { fov: field_of_view }
            }
            Projection::Orthographic { height } => scene::Projection::Orthographic { height },
        },
        position,
        target: position + camera.forward(),
        up,
        size: Some(size),
    }
}
