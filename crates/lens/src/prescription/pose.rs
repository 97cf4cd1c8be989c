//! Poses of surfaces off the axis.

use rayweave_math::{Affine, Vec3};

/// The pose of a surface relative to its place on the axis.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose {
    to_world: Affine,
    to_local: Affine,
}

impl Pose {
    /// A pose from a rigid map, in the coordinates of the prescription.
    pub fn new(to_world: Affine) -> Pose {
        // a rigid map has an inverse
        Pose { to_world, to_local: to_world.inverse().unwrap_or(Affine::IDENTITY) }
    }

    /// Maps a point and a direction to coordinates in which the surface is on the axis.
    pub fn local(&self, point: Vec3, direction: Vec3) -> (Vec3, Vec3) {
        (self.to_local.point(point), self.to_local.vector(direction))
    }

    /// The map from the place on the axis.
    pub fn to_world(self) -> Affine {
        self.to_world
    }

    /// True if both poses are equal up to rounding.
    pub fn is_near(&self, other: &Pose) -> bool {
        let entries = |pose: &Pose| pose.to_world.to_rows().into_iter().flatten().collect::<Vec<f64>>();
        let is_near = |(a, b): (f64, f64)| (a - b).abs() <= 1e-12 * (1.0 + a.abs());
        entries(self).into_iter().zip(entries(other)).all(is_near)
    }

    /// Maps a point and a direction back to the coordinates of the prescription.
    pub fn world(&self, point: Vec3, direction: Vec3) -> (Vec3, Vec3) {
        (self.to_world.point(point), self.to_world.vector(direction))
    }
}
