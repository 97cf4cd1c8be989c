//! A compiled scene: the program with the names of its media.

use crate::{Colour, Medium, Scene, SceneError, SceneRegion};
use rayweave_error::Message;
use rayweave_model::{Program, Region, RegionId, Solid};
use std::collections::HashSet;
use std::sync::Arc;

/// A compiled scene with the names of its media.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The model.
    pub program: Arc<Program>,
    /// The names of the media by number; 0 is the medium of the world.
    pub media: Arc<[String]>,
}

impl Compiled {
    /// Compiles the regions of a scene. A change of region within one medium is not a crossing of the model: see
    /// [`by_region`](Self::by_region).
    ///
    /// # Errors
    ///
    /// [`SceneError::Compile`], for example for a singular transform, or if repeated solids expand to too many leaves
    /// ([`check_repetition`](rayweave_model::check_repetition)).
    pub fn new(scene: &Scene) -> Result<Compiled, SceneError> {
        Compiled::of(&scene.model_regions(), scene.medium_names())
    }

    /// Compiles the regions of a scene, each as a medium of its own, with the name of the region: crossings between regions of
    /// one medium, which [`new`](Self::new) leaves out, are found, too.
    ///
    /// # Errors
    ///
    /// Those of [`Compiled::new`].
    pub fn by_region(scene: &Scene) -> Result<Compiled, SceneError> {
        let regions: Vec<_> =
            (1..).zip(scene.model_regions()).map(|(medium, region)| Region { medium, ..region }).collect();
        let names = || regions.iter().map(|region| region.name.as_str());
        Compiled::of(&regions, std::iter::once(world_name(names())).chain(names()))
    }

    fn of<'a>(regions: &[Region], media: impl IntoIterator<Item = &'a str>) -> Result<Compiled, SceneError> {
        let program = Arc::new(Program::compile_file_regions(regions)?);
        Ok(Compiled { program, media: media.into_iter().map(str::to_owned).collect() })
    }

    /// Compiles one solid of a scene as the only region: see [`Scene::alone`].
    ///
    /// # Errors
    ///
    /// [`SceneError`]: an unknown name, or a solid that cannot be compiled.
    pub fn solid(scene: &Scene, name: &str) -> Result<Compiled, SceneError> {
        Compiled::new(&scene.alone(name)?)
    }

    /// Compiles a solid of a scene, or all of its regions if no name is given.
    ///
    /// # Errors
    ///
    /// Those of [`Compiled::new`] and [`Compiled::solid`].
    pub fn named(scene: &Scene, solid: Option<&str>) -> Result<Compiled, SceneError> {
        match solid {
            Some(name) => Compiled::solid(scene, name),
            None => Compiled::new(scene),
        }
    }

    /// The name of a region; `None` for the world.
    pub fn region_name(&self, region: RegionId) -> Option<&str> {
        let index = region.index().checked_sub(1)?;
        Some(&self.program.regions().get(index)?.name)
    }

    /// The name of the medium of a region; region 0 is the world.
    pub fn medium_name(&self, region: RegionId) -> &str {
        let medium = self.program.medium_of(region) as usize;
        self.media.get(medium).map_or("", String::as_str)
    }
}

impl Scene {
    /// A solid by its name.
    ///
    /// # Errors
    ///
    /// [`SceneError::UnknownName`], which suggests the most similar name.
    pub fn find_solid(&self, name: &str) -> Result<&Solid, SceneError> {
        let known = self.solids.iter().map(|(own, _)| own.as_str());
        self.solid(name).ok_or_else(|| SceneError::UnknownName(Message::unknown("solid", name, known)))
    }

    /// The scene with one of its solids as the only region. Its medium is that of the last region
    /// with this solid or, without such a region, a new medium with the name of the solid.
    ///
    /// # Errors
    ///
    /// [`SceneError::UnknownName`].
    pub fn alone(&self, name: &str) -> Result<Scene, SceneError> {
        let solid = self.find_solid(name)?;
        let mut alone = self.clone();
        let own = self.regions.iter().rfind(|region| region.solid.is_same(solid));
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
}

/// The name of the space outside of all regions, among regions with these names: `world`, or another one if a region is called so, as
/// in many GDML files.
#[must_use]
pub fn world_name<'a>(regions: impl Iterator<Item = &'a str>) -> &'static str {
    let taken: HashSet<&str> = regions.filter(|name| CANDIDATES.contains(name)).collect();
    CANDIDATES.into_iter().find(|name| !taken.contains(name)).unwrap_or("")
}

/// Names of the space outside of all regions.
const CANDIDATES: [&str; 4] = ["world", "outside", "space outside", "(outside)"];
