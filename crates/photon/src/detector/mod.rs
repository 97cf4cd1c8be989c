//! Detectors: compiled geometry with optical materials, surfaces and sensors.

mod borders;
mod copies;
pub(crate) mod former_names;
pub(crate) mod gdml;
mod meetings;
mod native;
mod own_face;
pub(crate) mod properties;
mod sensors;
mod surfaces;

pub(crate) use meetings::{Meeting, Meetings};
pub(crate) use sensors::NO_COPY;

use crate::energies;
use crate::error::PhotonError;
use crate::material::OpticalMaterial;
use crate::surface::OpticalSurface;
use crate::tables::SurfaceTables;
use borders::SurfaceTable;
use copies::divide_touching_copies;
use gdml::Volumes;
use properties::PropertyReader;
use rayweave_error::Message;
use rayweave_math::Bounds;
use rayweave_model::{Crossing, Face, LeafFacet, Occurrence, PlacementId, Program, Region, RegionId};
use rayweave_optics::start_surfaces::StartSurfaces;
use rayweave_scene::{Datum, Document, Scene, Source};
use sensors::SensorList;
use std::borrow::Cow;
use std::collections::HashSet;
use std::sync::{Arc, OnceLock};

/// The events that count as the detection of a photon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DetectionRule {
    /// Absorption at a surface, with the probability `EFFICIENCY`.
    Efficiency,
    /// Entering a sensitive volume (auxiliary tag `SensDet`).
    Volume,
    /// Either of the two, whichever comes first.
    #[default]
    Both,
}

impl DetectionRule {
    /// All rules.
    pub const ALL: [DetectionRule; 3] =
        [DetectionRule::Efficiency, DetectionRule::Volume, DetectionRule::Both];

    /// The name in files, bindings and commands.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            DetectionRule::Efficiency => "efficiency",
            DetectionRule::Volume => "volume",
            DetectionRule::Both => "both",
        }
    }

    /// True if photons that enter a sensitive volume are detected.
    pub(crate) fn counts_volumes(self) -> bool {
        self != DetectionRule::Efficiency
    }

    /// True if photons that a surface detects are detected.
    pub(crate) fn counts_efficiency(self) -> bool {
        self != DetectionRule::Volume
    }

    /// The rule of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<DetectionRule> {
        DetectionRule::ALL.into_iter().find(|rule| rule.name() == name)
    }
}

/// A detector, ready for simulation.
#[derive(Debug)]
pub struct Detector {
    pub(crate) program: Arc<Program>,
    /// The materials, by the number of the medium in the scene; 0 is the medium of the world.
    pub(crate) materials: Vec<OpticalMaterial>,
    /// The number of the material of each region.
    pub(crate) material_of: Vec<u32>,
    pub(crate) surfaces: Vec<OpticalSurface>,
    pub(crate) boundaries: SurfaceTable,
    pub(crate) meetings: Meetings,
    pub(crate) starts: StartSurfaces,
    /// The faces by number; the placements come with the crossings.
    pub(crate) faces: Vec<Face>,
    /// The name of the sensor of each region, if it is sensitive.
    pub(crate) sensors: Vec<Option<String>>,
    pub(crate) region_names: Arc<[String]>,
    /// The regions in which photons can be detected.
    detecting: HashSet<u32>,
    /// The sensors, found when they are needed.
    sensor_list: OnceLock<SensorList>,
    /// The shapes of the volume of each region, found when they are needed.
    own_shapes: Vec<OnceLock<Vec<Occurrence>>>,
    notes: Vec<String>,
    warnings: Vec<String>,
}

impl Detector {
    /// True if a region detects the photons that enter it.
    #[inline]
    pub(crate) fn is_detecting(&self, rule: DetectionRule, region: RegionId) -> bool {
        rule.counts_volumes() && self.sensors[region.index()].is_some()
    }

    /// Compiles a scene and reads the optical properties in the `[gdml]` or the `[photons]` table of its document.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Detector`] and, with their positions in a native model file, [`PhotonError::File`] for missing or invalid
    /// properties, all of them at once, and [`PhotonError::Compile`].
    pub fn new(scene: &Scene, document: &Document) -> Result<Detector, PhotonError> {
        Detector::with_tables(scene, document, &SurfaceTables::default())
    }

    /// Like [`new`](Detector::new), with tables for the surfaces whose behaviour is measured.
    ///
    /// # Errors
    ///
    /// Those of [`new`](Detector::new); [`PhotonError::Detector`] also for a surface whose table is absent or invalid.
    pub fn with_tables(
        scene: &Scene,
        document: &Document,
        tables: &SurfaceTables,
    ) -> Result<Detector, PhotonError> {
        let table = OpticalTable::of(scene, document)?;
        let scene = &*divide_touching_copies(&table.table, scene);
        let program = Arc::new(Program::compile_regions(&regions(scene))?);
        let Optics { properties, materials, surfaces, volumes, boundaries, sensors } =
            Optics::read(&table, scene, tables);
        let detecting =
            sensors::detecting_regions(&table.table, scene, (&surfaces, &materials), &volumes, &sensors);
        let names = std::iter::once("").chain(scene.regions.iter().map(|region| region.name.as_str()));
        let region_names = names.map(str::to_owned).collect();
        let starts = StartSurfaces::new(&program);
        let faces = faces(&program);
        let material_of: Vec<u32> =
            std::iter::once(0).chain(scene.regions.iter().map(|region| region.medium)).collect();
        let meetings = Meetings::new(&boundaries, &surfaces, &material_of);
        let [mut warnings, notes] = properties.finish()?;
        warnings.extend(energies::all_foreign(&table.table).iter().map(ToString::to_string));
        Ok(Detector {
            faces,
            program,
            materials,
            material_of,
            surfaces,
            boundaries,
            meetings,
            starts,
            sensors,
            region_names,
            detecting,
            sensor_list: OnceLock::new(),
            own_shapes: vec![OnceLock::new(); scene.regions.len() + 1],
            notes,
            warnings,
        })
    }

    /// The ignored input, one sentence each: properties that no process uses, and surfaces that are attached
    /// to nothing.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The input that is probably a mistake although it is valid, one sentence each: energies that are not those of light, such as
    /// numbers in eV taken as MeV, and border surfaces that name no placement or one of several with the same name.
    #[must_use]
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// The optical materials, by the number of the medium; 0 is the medium of the world.
    #[must_use]
    pub fn materials(&self) -> &[OpticalMaterial] {
        &self.materials
    }

    /// The material with a name.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for an unknown name, with the names of all materials.
    pub fn named_material(&self, name: &str) -> Result<&OpticalMaterial, PhotonError> {
        let found = self.materials.iter().find(|material| material.name == name);
        let names = self.materials.iter().map(|material| material.name.as_str());
        found.ok_or_else(|| PhotonError::Setting(Message::unknown("material", name, names)))
    }

    /// The optical surfaces, in the order of the file.
    #[must_use]
    pub fn surfaces(&self) -> &[OpticalSurface] {
        &self.surfaces
    }

    /// The compiled geometry.
    #[must_use]
    pub fn program(&self) -> &Arc<Program> {
        &self.program
    }

    /// The names of the regions and of their sensors, for sensitive volumes (auxiliary tag `SensDet`).
    pub fn sensors(&self) -> impl Iterator<Item = (&str, &str)> {
        let regions = self.region_names.iter().zip(&self.sensors).enumerate();
        // the regions of a volume whose copies touch follow each other
        let is_first = |k: usize| k == 0 || self.region_names[k - 1] != self.region_names[k];
        regions.filter_map(move |(k, (region, sensor))| {
            Some((region.as_str(), sensor.as_deref()?)).filter(|_| is_first(k))
        })
    }

    /// The paths of the sensors with their copy numbers (-1 without one), in the order of their placements, as [`Hits::paths`] has
    /// them: the sensitive volumes, and the volumes behind surfaces with an `EFFICIENCY`. Empty for a detector with more than 2^20
    /// occurrences of shapes.
    ///
    /// [`Hits::paths`]: crate::Hits::paths
    #[must_use]
    pub fn sensor_paths(&self) -> &[(String, i64)] {
        &self.sensor_list().paths
    }

    /// The boxes of the solids of the sensors in mm, in the order of [`sensor_paths`](Detector::sensor_paths); `None` for the world,
    /// and for volumes without a shape of their own.
    #[must_use]
    pub fn sensor_extents(&self) -> &[Option<Bounds>] {
        &self.sensor_list().extents
    }

    fn sensor_list(&self) -> &SensorList {
        self.sensor_list.get_or_init(|| SensorList::new(&self.program, &self.region_names, &self.detecting))
    }

    /// The material of a region.
    #[must_use]
    pub fn material(&self, region: RegionId) -> &OpticalMaterial {
        &self.materials[self.material_of[region.index()] as usize]
    }

    /// The name of the material of a region; `None` without a refractive index.
    #[must_use]
    pub fn medium(&self, region: RegionId) -> Option<String> {
        let material = self.material(region);
        material.index.as_ref().map(|_| material.name.clone())
    }

    /// The optical surface at a crossing, if there is one. If it [depends on copies](SurfaceTable::depends_on_copies), the crossing must
    /// have [own faces](Detector::with_own_faces).
    pub(crate) fn surface(&self, crossing: &Crossing) -> Option<&OpticalSurface> {
        self.boundaries.find(&self.program, crossing).map(|number| &self.surfaces[number])
    }

    /// The number of the optical surface at a crossing, if there is one.
    pub(crate) fn surface_number(&self, crossing: &Crossing) -> Option<u32> {
        self.boundaries.find(&self.program, crossing).map(|number| number as u32)
    }
}

/// The optical properties of a model, in the form of a `[gdml]` table.
pub(crate) struct OpticalTable<'d> {
    pub table: Cow<'d, Datum>,
    /// The native model file that the properties come from.
    source: Option<&'d Arc<Source>>,
}

impl<'d> OpticalTable<'d> {
    /// The `[gdml]` or the `[photons]` table of a document.
    pub fn of(scene: &Scene, document: &'d Document) -> Result<OpticalTable<'d>, PhotonError> {
        let gdml = document.foreign("gdml").map(|foreign| &foreign.value.value);
        let is_native = document.foreign(native::NAME).is_some();
        match gdml {
            Some(table) if !is_native => Ok(OpticalTable { table: Cow::Borrowed(table), source: None }),
            None if is_native => {
                let table = native::table(document, scene).map_err(PhotonError::File)?;
                Ok(OpticalTable { table: Cow::Owned(table), source: Some(&document.source) })
            }
            _ => Err(no_properties(is_native)),
        }
    }
}

/// The optical part of a detector, as its file states it.
pub(crate) struct Optics {
    /// The reader, with problems and notes.
    pub properties: PropertyReader,
    /// The materials, by the number of the medium.
    pub materials: Vec<OpticalMaterial>,
    pub surfaces: Vec<OpticalSurface>,
    pub volumes: Volumes,
    pub boundaries: SurfaceTable,
    /// The name of the sensor of each region.
    pub sensors: Vec<Option<String>>,
}

impl Optics {
    pub fn read(own: &OpticalTable<'_>, scene: &Scene, tables: &SurfaceTables) -> Optics {
        let table = own.table.as_ref();
        let mut properties = PropertyReader::new(table, own.source);
        let materials = gdml::materials(table, &scene.medium_names(), &mut properties);
        let surfaces = surfaces::read(table, tables, &mut properties);
        let volumes = gdml::volumes(table, scene);
        let boundaries = SurfaceTable::new(table, &surfaces, &volumes, &mut properties);
        let sensors = sensors::names(table, scene);
        Optics { properties, materials, surfaces, volumes, boundaries, sensors }
    }
}

/// The error of a model without optical properties, or with both tables of them.
fn no_properties(has_both: bool) -> PhotonError {
    let message = if has_both {
        let reason = "it has both of the tables [gdml] and [photons]";
        Message::new("the optical properties of the model are not clear", reason)
            .suggest("Remove one of them.")
    } else {
        let reason = "it has neither a table [photons] nor a table [gdml]";
        let message = Message::new("the model has no optical properties", reason);
        message.suggest("Use a GDML file, or add the table [photons] to a native model.")
    };
    PhotonError::Detector(vec![message])
}

/// The regions of a scene, each with a medium of its own: a photon stops at every boundary between two volumes, even of
/// equal material, since it may have an optical surface or a sensor behind it.
pub(crate) fn regions(scene: &Scene) -> Vec<Region> {
    let own = scene.model_regions().into_iter().zip(1..);
    own.map(|(region, medium)| Region { medium, ..region }).collect()
}

/// The faces of a program by number.
fn faces(program: &Program) -> Vec<Face> {
    let faces = program.leaves().flat_map(|leaf| {
        let face = move |(facet, k): (&LeafFacet, u32)| Face {
            leaf: leaf.id(),
            facet: k,
            surface: facet.surface(),
            placement: PlacementId(0),
        };
        leaf.facets().iter().zip(0..).map(face)
    });
    faces.collect()
}
