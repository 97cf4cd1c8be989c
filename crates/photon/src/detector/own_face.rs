//! The copy of a volume that a photon meets, where the faces of its crossing belong to other volumes.
//!
//! Faces of different volumes that touch are crossed at times that differ by rounding. If a photon leaves a volume that is flush with
//! its mother and enters a neighbour of the mother, the neighbour may begin just before: then no face of the crossing belongs to the
//! neighbour, although the photon is in it from there on.

use super::Detector;
use rayweave_math::UNIT_ROUNDOFF;
use rayweave_model::weld::local_ray;
use rayweave_model::{Crossing, Face, Occurrence, RegionId};
use rayweave_scene::bare_name;
use rayweave_shape::Ray;

/// Touching faces are closer than this part of the size of the detector, far more than rounding and far less than any part.
const NEAR: f64 = 1e7 * UNIT_ROUNDOFF;

/// A point this part of the size behind a face is inside of what begins there.
const BEHIND: f64 = 1e3 * NEAR;

impl Detector {
    /// True if a face belongs to a copy of the volume of a region, or to a volume placed in it.
    pub(crate) fn is_of(&self, region: u32, face: Face) -> bool {
        let own = bare_name(&self.region_names[region as usize]);
        self.program.occurrence_path(face.occurrence()).placed().steps().iter().any(|step| step.name == own)
    }

    /// The crossing of a ray with `left` and `entered` replaced by faces of the regions before and after, where they have others.
    pub(crate) fn with_own_faces(&self, ray: &Ray, crossing: &Crossing) -> Crossing {
        let from = |direction| Ray::new(ray.at(crossing.t), direction);
        let own = |region: RegionId, face: Face, direction| match self.is_of(region.0, face) {
            true => face,
            false => self.own_face(region.0, &from(direction)).unwrap_or(face),
        };
        let left = own(crossing.before, crossing.left, -ray.direction);
        let entered = own(crossing.after, crossing.entered, ray.direction);
        Crossing { left, entered, ..*crossing }
    }

    /// A face of the copy of a region's volume that a ray enters at its origin; `None` if there is none, or the region is the world.
    ///
    /// Of several copies that touch there, it is the one with the point behind the origin in its box.
    pub(crate) fn own_face(&self, region: u32, ray: &Ray) -> Option<Face> {
        let size = self.program.bounds().size().length();
        let near = NEAR * size;
        let rank = |occurrence: &&Occurrence| {
            let ray = local_ray(&self.program, ray, occurrence.placement).0;
            let bounds = self.program.leaf_bounds(occurrence.leaf);
            if !bounds.grown(near).contains(ray.origin) {
                return None;
            }
            let length = ray.direction.length();
            let mut facets = self.program.leaf(occurrence.leaf).facets().iter();
            let is_met = facets.any(|facet| {
                let crossings = self.program.surface(facet.surface()).surface.crossings(&ray);
                crossings.times().iter().any(|t| t.abs() * length <= near)
            });
            let is_behind = bounds.contains(ray.at(BEHIND * size / length));
            Some((is_met, is_behind))
        };
        let ranked = self.own_shapes(region).iter().filter_map(|own| Some((rank(&own)?, own)));
        // the first of equal ones
        let (_, best) = ranked.reduce(|best, next| if next.0 > best.0 { next } else { best })?;
        let facet = *self.program.leaf(best.leaf).facets().first()?;
        let Occurrence { placement, leaf } = *best;
        Some(Face { leaf, facet: 0, surface: facet.surface(), placement })
    }

    /// The shapes of the copies of a region's volume, without those placed in them; found when they are first needed.
    fn own_shapes(&self, region: u32) -> &[Occurrence] {
        let find = || {
            let own = bare_name(&self.region_names[region as usize]);
            let is_own = |occurrence: &Occurrence| {
                let path = self.program.occurrence_path(*occurrence).placed();
                path.steps().last().is_some_and(|step| step.name == own)
            };
            self.program.occurrences().filter(is_own).collect()
        };
        self.own_shapes[region as usize].get_or_init(find)
    }
}
