//! The scene prepared for writers: a finite bounding box, and the regions to subtract from each region.

use super::facets;
use super::remark::Remarks;
use super::{RemarkKind, WriteError, WriteOptions};
use crate::Format;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::Program;
use rayweave_scene::{Scene, SceneRegion, Unit};
use rayweave_shape::primitive::Primitive;
use rayweave_shape::surface::{MeshForm, Surface};
use std::any::Any;

/// Margin of the clip box relative to the size of the model, so that no face of the model lies in a face of the box.
const MARGIN: f64 = 0.125;

/// Default tolerance relative to the diagonal of the model.
const USUAL_TOLERANCE: f64 = 2e-4;

/// A scene with the derived data that all writers need.
pub(super) struct Model<'s> {
    pub scene: &'s Scene,
    /// Clip box: contains all regions, with a margin.
    pub clip: Bounds,
    pub tolerance: f64,
    /// True if all regions are empty for certain.
    pub is_empty: bool,
    /// Whether the model has faces that are not planar.
    pub has_curved_faces: bool,
    /// For each region the indices of the later regions whose boxes overlap its own.
    pub later: Vec<Vec<usize>>,
}

impl<'s> Model<'s> {
    pub fn new(scene: &'s Scene, format: Format, options: &WriteOptions) -> Result<Model<'s>, WriteError> {
        let program = Program::compile_regions(&scene.model_regions())?;
        let boxes = program.region_bounds();
        let has_curved_faces = program.surfaces().iter().any(|entry| is_curved(&entry.surface));
        let is_endless = |bounds: &Bounds| !bounds.is_empty() && !bounds.is_finite();
        if let Some(number) = boxes.iter().position(is_endless) {
            return Err(WriteError::Unbounded { region: scene.regions[number].name.clone(), format });
        }
        let whole = boxes.iter().fold(Bounds::EMPTY, |all, one| all.union(one));
        let is_empty = whole.is_empty();
        let whole = if is_empty { Bounds::new(-Vec3::ONE, Vec3::ONE) } else { whole };
        let diagonal = whole.size().length();
        let tolerance = options.tolerance.unwrap_or(USUAL_TOLERANCE * diagonal);
        if !(tolerance > 0.0 && tolerance.is_finite()) {
            return Err(WriteError::Tolerance(tolerance));
        }
        let later = later(&boxes);
        // a flat region has no extent in some direction
        let clip = whole.grown(MARGIN * diagonal);
        Ok(Model { scene, clip, tolerance, is_empty, has_curved_faces, later })
    }

    /// The regions with a medium other than the world's, with their indices.
    pub fn regions(&self) -> impl Iterator<Item = (usize, &'s SceneRegion)> {
        self.scene.regions.iter().enumerate().filter(|(_, region)| region.medium != 0)
    }

    /// Millimetres per unit of the scene, for formats that use millimetres or have no unit.
    pub fn millimetres(&self) -> f64 {
        self.scene.unit.metres() / Unit::Millimetre.metres()
    }

    /// Adds a remark if lengths are converted to millimetres.
    pub fn remark_on_unit(&self, remarks: &mut Remarks) {
        self.remark_on_conversion(Unit::Millimetre, remarks);
    }

    /// Adds a remark if lengths are converted to the unit of the file.
    pub fn remark_on_conversion(&self, unit: Unit, remarks: &mut Remarks) {
        if self.scene.unit != unit {
            remarks.add(RemarkKind::Changed, format!("lengths, from {} to {unit}", self.scene.unit));
        }
    }

    /// Adds a remark on subtracted regions.
    pub fn remark_on_cuts(&self, remarks: &mut Remarks) {
        if self.later.iter().any(|list| !list.is_empty()) {
            remarks.add(
                RemarkKind::Changed,
                "regions: later regions that may overlap a region are subtracted from it",
            );
        }
    }

    /// The remark on a shape that becomes triangles.
    pub fn triangles_remark(&self, shape: &Primitive, region: usize) -> String {
        // cones of chamfers, countersinks and slanted edges of outlines
        let name = if facets::is_cone(shape) { "cone" } else { shape.name() };
        let region = &self.scene.regions[region].name;
        format!(
            "`{name}` in region `{region}`, with triangles within {:.3e} {}",
            self.tolerance, self.scene.unit
        )
    }

    /// The remark on arcs of a revolved outline that become chords.
    pub fn arcs_remark(&self, region: usize) -> String {
        let region = &self.scene.regions[region].name;
        format!(
            "arcs of a revolved outline in region `{region}`, with chords within {:.3e} {}",
            self.tolerance, self.scene.unit
        )
    }

    /// Adds remarks on data that only the native format holds.
    pub fn remark_on_pictures(&self, remarks: &mut Remarks) {
        let scene = self.scene;
        let all = [
            (scene.camera.is_some(), "the camera"),
            (!scene.lights.is_empty(), "lights"),
            (scene.render != Default::default(), "render settings"),
            (!scene.parameters.is_empty(), "parameters, replaced by their values"),
        ];
        for (_, what) in all.into_iter().filter(|(is_there, _)| *is_there) {
            remarks.add(RemarkKind::Dropped, what);
        }
    }

    /// Adds a remark on media, for formats without media.
    pub fn remark_on_media(&self, remarks: &mut Remarks) {
        let has_numbers =
            self.scene.media.iter().any(|medium| medium.index.is_some() || !medium.numbers.is_empty());
        // a reader gives each region the medium of its name
        let has_names = self.regions().any(|(_, region)| {
            self.scene.media.get(region.medium as usize).is_some_and(|medium| medium.name != region.name)
        });
        let what = match (has_names, has_numbers) {
            (true, true) => "names and properties (index, density, attenuation) of media",
            (true, false) => "names of media",
            (false, true) => "properties (index, density, attenuation) of media",
            (false, false) => return,
        };
        remarks.add(RemarkKind::Dropped, what);
    }
}

/// True unless the surface is a plane or a triangle mesh.
fn is_curved(surface: &Surface) -> bool {
    match surface {
        Surface::Plane(_) => false,
        Surface::Object(object) => !(object.form.as_ref() as &dyn Any).is::<MeshForm>(),
        _ => true,
    }
}

/// For each box the indices of the later boxes that overlap it.
fn later(boxes: &[Bounds]) -> Vec<Vec<usize>> {
    let meets = |i: usize, j: usize| {
        let both = boxes[i].intersection(&boxes[j]);
        !both.is_empty() && both.size().min_element() > 0.0
    };
    let count = boxes.len();
    (0..count).map(|i| (i + 1..count).filter(|&j| meets(i, j)).collect()).collect()
}
