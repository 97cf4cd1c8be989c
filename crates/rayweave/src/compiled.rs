//! The contents of a model file, ready to be asked.

use crate::Error;
use rayweave_model::{Program, RegionId, Solid};
use rayweave_scene::{Colour, Medium, Scene, SceneRegion};
use std::sync::Arc;

/// A compiled model with the names of its media.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The model.
    pub program: Arc<Program>,
    /// The names of the media: number 0 is that of the world.
    pub media: Arc<[String]>,
}

impl Compiled {
    /// Compiles the regions of a scene.
    ///
    /// # Errors
    ///
    /// [`crate::ErrorKind::Compile`], for a singular transform for instance.
    pub fn new(scene: &Scene) -> Result<Compiled, Error> {
        let program = Program::compile_regions(&scene.model_regions())?;
        let media = scene.medium_names().into_iter().map(str::to_owned).collect();
        Ok(Compiled { program: Arc::new(program), media })
    }

    /// Compiles one solid of a scene, as the only region. Its medium is that of the last region made of it; without any it
    /// is one of its own, called like the solid.
    ///
    /// # Errors
    ///
    /// [`crate::ErrorKind::Name`] if the scene has no solid of this name, [`crate::ErrorKind::Compile`].
    pub fn solid(scene: &Scene, name: &str) -> Result<Compiled, Error> {
        Compiled::new(&Compiled::alone(scene, name)?)
    }

    /// The scene with one of its solids as the only region, as [`Compiled::solid`] compiles it.
    ///
    /// # Errors
    ///
    /// [`crate::ErrorKind::Name`] if the scene has no solid of this name.
    pub fn alone(scene: &Scene, name: &str) -> Result<Scene, Error> {
        let solid = Compiled::find(scene, name)?;
        let mut alone = scene.clone();
        let own = scene.regions.iter().rfind(|region| region.solid.is_same(solid));
        let (medium, colour) = match own {
            Some(region) => (region.medium, region.colour),
            None => {
                alone.media.push(Medium { name: name.to_owned(), ..Medium::default() });
                (alone.media.len() as u32 - 1, Colour::PALETTE[0])
            }
        };
        alone.regions = vec![SceneRegion { name: name.to_owned(), solid: solid.clone(), medium, colour }];
        Ok(alone)
    }

    /// Compiles a solid of a scene, or all of its regions if there is no name.
    ///
    /// # Errors
    ///
    /// As [`Compiled::new`] and [`Compiled::solid`].
    pub fn named(scene: &Scene, solid: Option<&str>) -> Result<Compiled, Error> {
        match solid {
            Some(name) => Compiled::solid(scene, name),
            None => Compiled::new(scene),
        }
    }

    /// A solid of a scene by its name.
    pub(crate) fn find<'s>(scene: &'s Scene, name: &str) -> Result<&'s Solid, Error> {
        let known = scene.solids.iter().map(|(own, _)| own.as_str());
        scene.solid(name).ok_or_else(|| Error::unknown("solid", name, known))
    }

    /// The name of a region; `None` for the world.
    pub fn region_name(&self, region: RegionId) -> Option<&str> {
        let index = region.index().checked_sub(1)?;
        Some(&self.program.regions().get(index)?.name)
    }

    /// The name of the medium of a region, that of the world for region 0.
    pub fn medium_name(&self, region: RegionId) -> &str {
        let medium = self.program.medium_of(region) as usize;
        self.media.get(medium).map_or("", String::as_str)
    }
}
