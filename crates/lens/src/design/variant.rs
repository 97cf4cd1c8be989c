//! Prescriptions with changed parameters, and their images.

use super::{DesignError, DesignParameter, Quantity};
use crate::analysis::{
    Arrival, PupilQuadrature, Wavefront, defocused, reference_radius, sequential_arrival, weighted_rms,
    without_piston, without_tilt,
};
use crate::paraxial::FirstOrder;
use crate::prescription::{Pose, Prescription, PrescriptionError, Resolved, Surface, SurfaceIntersection};
use rayweave_math::{Affine, Vec3};

/// The limit of rings of rays in the pupil: 2 million rays for each field and wavelength.
const MAX_RINGS: usize = 1 << 10;

/// The default number of rings of rays in the pupil.
pub(super) const RINGS: usize = 6;

/// The number of rays through the rim of the pupil for clearances.
const RIM_POINTS: u32 = 32;

/// The points of the pupil with their weights.
pub(super) fn pupil(rings: usize) -> Result<PupilQuadrature, DesignError> {
    match rings {
        0..=MAX_RINGS => Ok(PupilQuadrature::gaussian(rings)),
        _ => {
            let what = "the number of rings".to_owned();
            Err(DesignError::BadNumber { what, value: rings as f64, range: "at most 1024" })
        }
    }
}

/// A prescription with changed parameters.
#[derive(Clone, Debug)]
pub(super) struct Variant {
    pub lens: Prescription,
    pub resolved: Resolved,
    /// True if rays end beyond the stated semi-diameter of a surface.
    pub vignettes: bool,
    /// True if rays go through points of the stop instead of the entrance pupil.
    pub aims: bool,
}

impl Variant {
    /// Applies changes of parameters in their order.
    pub fn new(lens: &Prescription, changes: &[(DesignParameter, f64)]) -> Result<Variant, DesignError> {
        let mut lens = lens.clone();
        for (parameter, change) in changes {
            parameter.add(&mut lens, *change)?;
        }
        let mut resolved = lens.resolved()?;
        if let Some(poses) = poses(&resolved, changes) {
            resolved.poses = poses;
        }
        Ok(Variant { lens, resolved, vignettes: false, aims: false })
    }

    /// First-order data at a wavelength, without decentres and tilts.
    pub fn first_order(&self, wavelength_nm: f64) -> Result<FirstOrder, DesignError> {
        Ok(self.lens.first_order_resolved(&self.resolved, wavelength_nm)?)
    }

    /// The rays of a field that arrive at the image; the id of a ray is the index of its pupil point, its power
    /// the weight of that point.
    pub fn arrivals(
        &self,
        field: usize,
        wavelength_nm: f64,
        pupil: &PupilQuadrature,
    ) -> Result<Vec<Arrival>, DesignError> {
        let launch = self.lens.launch(&self.resolved, field)?;
        let aim = self.aims.then(|| self.lens.aim(&self.resolved, field, wavelength_nm)).transpose()?;
        let ray = |point| match &aim {
            Some(aim) => aim.ray(point),
            None => Ok(launch.ray(point)),
        };
        let mut found = Vec::with_capacity(pupil.points.len());
        for (id, (&point, &power)) in pupil.points.iter().zip(&pupil.weights).enumerate() {
            let followed =
                ray(point).and_then(|ray| self.lens.follow_resolved(&self.resolved, &ray, wavelength_nm));
            match followed {
                Ok(passes) if self.vignettes && !self.passes(&passes) => {}
                Ok(passes) => {
                    let arrival = |last| Arrival {
                        power,
                        ..sequential_arrival(&self.resolved, id, last, wavelength_nm)
                    };
                    found.extend(passes.last().map(arrival));
                }
                Err(PrescriptionError::Lost { .. }) => {}
                Err(error) => return Err(error.into()),
            }
        }
        Ok(found)
    }

    /// True if a ray stays within all stated semi-diameters, in the coordinates of each surface, and outside
    /// holes.
    fn passes(&self, passes: &[SurfaceIntersection]) -> bool {
        let keeps = |(k, (pass, surface)): (usize, (&SurfaceIntersection, &Surface))| {
            let place = self.resolved.local(k, pass.point);
            let r = libm::hypot(place.x, place.y);
            surface.hole <= r && surface.semi_diameter.is_none_or(|most| r <= most)
        };
        passes.iter().zip(&self.lens.surfaces).enumerate().all(keeps)
    }

    /// The least distance of the rays of a field through the rim of the pupil from the edges of the stated semi-diameters, at the
    /// primary wavelength; `None` if one of them does not arrive.
    pub fn clearance(&self, field: usize) -> Result<Option<f64>, DesignError> {
        if self.lens.surfaces.iter().all(|surface| surface.semi_diameter.is_none()) {
            return Err(DesignError::None("surface with a stated semi-diameter"));
        }
        let nm = self.lens.primary_nm();
        let launch = self.lens.launch(&self.resolved, field)?;
        let aim = self.aims.then(|| self.lens.aim(&self.resolved, field, nm)).transpose()?;
        let mut least = f64::INFINITY;
        for k in 0..RIM_POINTS {
            let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(k) / f64::from(RIM_POINTS));
            let ray = match &aim {
                Some(aim) => aim.ray([cos, sin]),
                None => Ok(launch.ray([cos, sin])),
            };
            let passes = match ray.and_then(|ray| self.lens.follow_resolved(&self.resolved, &ray, nm)) {
                Ok(passes) => passes,
                Err(PrescriptionError::Lost { .. }) => return Ok(None),
                Err(error) => return Err(error.into()),
            };
            for (k, (pass, surface)) in passes.iter().zip(&self.lens.surfaces).enumerate() {
                let place = self.resolved.local(k, pass.point);
                let spare = surface.semi_diameter.map(|edge| edge - libm::hypot(place.x, place.y));
                least = spare.map_or(least, |spare| least.min(spare));
            }
        }
        Ok(Some(least))
    }

    /// The rays of a field at all wavelengths; powers are the weights of points times those of wavelengths.
    pub fn polychromatic(&self, field: usize, pupil: &PupilQuadrature) -> Result<Vec<Arrival>, DesignError> {
        let mut all = Vec::new();
        for line in &self.lens.lines {
            let found = self.arrivals(field, line.wavelength_nm, pupil)?;
            all.extend(found.into_iter().map(|ray| Arrival { power: line.weight * ray.power, ..ray }));
        }
        Ok(all)
    }

    /// The wavefront of a field on the image plane moved along the axis; `None` if the ray through the centre
    /// of the pupil does not arrive.
    pub fn wavefront(
        &self,
        field: usize,
        wavelength_nm: f64,
        pupil: &PupilQuadrature,
        shift: f64,
    ) -> Result<Option<WeightedWaves>, DesignError> {
        let centre = PupilQuadrature::equal(&[[0.0; 2]]);
        let principal = defocused(&self.arrivals(field, wavelength_nm, &centre)?, shift);
        let Some(principal) = principal.first() else { return Ok(None) };
        let found = defocused(&self.arrivals(field, wavelength_nm, pupil)?, shift);
        let image = self.lens.surfaces.iter().map(|surface| surface.thickness).sum::<f64>();
        let exit = self.first_order(wavelength_nm)?.exit_pupil.position - image;
        let radius = reference_radius(principal, exit);
        let front = Wavefront::new(principal, &found, &pupil.points, radius, self.lens.unit_nm);
        Ok(Some(WeightedWaves { front, weights: found.iter().map(|arrival| arrival.power).collect() }))
    }
}

/// The reference of a wavefront.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WavefrontReference {
    /// The centroid of the image: without tilt.
    Centroid,
    /// The point of the chief ray on the image.
    ChiefRay,
}

/// A wavefront with the weights of the points of the pupil.
#[derive(Clone, Debug)]
pub(super) struct WeightedWaves {
    pub front: Wavefront,
    pub weights: Vec<f64>,
}

impl WeightedWaves {
    /// The differences about a reference.
    fn differences(&self, reference: WavefrontReference) -> Vec<f64> {
        let Wavefront { pupil, waves } = &self.front;
        match reference {
            WavefrontReference::Centroid => without_tilt(pupil, waves, &self.weights),
            WavefrontReference::ChiefRay => without_piston(waves, &self.weights),
        }
    }

    /// The differences about a reference, times the roots of the weights of their points, whose sum is 1.
    pub fn deviations(&self, reference: WavefrontReference) -> Vec<f64> {
        let total: f64 = self.weights.iter().sum();
        let differences = self.differences(reference);
        differences.iter().zip(&self.weights).map(|(off, weight)| (weight / total).sqrt() * off).collect()
    }

    /// The RMS over the pupil; NaN if there are no points.
    pub fn rms(&self, reference: WavefrontReference) -> f64 {
        weighted_rms(&self.differences(reference), &self.weights)
    }
}

/// The poses of surfaces and image; `None` if no parameter decentres or tilts them.
fn poses(resolved: &Resolved, changes: &[(DesignParameter, f64)]) -> Option<Vec<Pose>> {
    if !changes.iter().any(|(parameter, _)| parameter.quantity.is_pose()) {
        return None;
    }
    let count = resolved.vertices.len();
    let mut maps = vec![Affine::IDENTITY; count];
    for (parameter, change) in changes {
        let vertex = Vec3::Z * resolved.vertices[parameter.first - 1];
        let map = motion(parameter.quantity, *change, vertex);
        for own in &mut maps[parameter.first - 1..parameter.last] {
            *own = own.then(&map);
        }
    }
    let whole = |(k, map): (usize, Affine)| match resolved.poses.get(k) {
        Some(pose) => Pose::new(map.then(&pose.to_world())),
        None => Pose::new(map),
    };
    Some(maps.into_iter().enumerate().map(whole).collect())
}

fn motion(quantity: Quantity, change: f64, vertex: Vec3) -> Affine {
    let about = |axis: Vec3| {
        let turn = Affine::rotation(axis, change);
        Affine::translate(-vertex).then(&turn).then(&Affine::translate(vertex))
    };
    match quantity {
        Quantity::DecentreX => Affine::translate(Vec3::X * change),
        Quantity::DecentreY => Affine::translate(Vec3::Y * change),
        Quantity::TiltX => about(Vec3::X),
        Quantity::TiltY => about(Vec3::Y),
        _ => Affine::IDENTITY,
    }
}
