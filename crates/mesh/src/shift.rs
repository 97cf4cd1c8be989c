//! The shift that moves a line out of the faces in which it lies.

use rayweave_math::Vec3;

/// Shifts in units of the tolerance: enough to leave a face within whose tolerance the line lies.
const FACTOR: f64 = 4.0;

/// Faces whose unit normals have a cross product of at most this length are in one plane: normals of small triangles are
/// inaccurate.
const PARALLEL: f64 = 1e-6;

/// The shift of a line that lies in faces, collected face by face.
///
/// The perturbation determines the side of each face. A line in a single plane is shifted along its normal, so that it keeps its
/// distance from perpendicular faces. A line in several planes, along an edge, is shifted along the perturbation.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shift {
    along_normal: Vec3,
    along_perturbation: Vec3,
    is_in_several_planes: bool,
}

impl Shift {
    /// Adds a face with a unit normal in which the line lies within `delta`. `directions` are those of the perturbation, the
    /// first of which that leaves the face counts.
    pub fn add(&mut self, normal: Vec3, directions: &[Vec3], delta: f64) {
        let leaves = |direction: &Vec3| normal.dot(*direction).abs() > 1e-3 * direction.length();
        let direction = directions.iter().copied().find(leaves).unwrap_or(normal);
        let slope = normal.dot(direction);
        let along_normal = (FACTOR * delta * slope.signum()) * normal;
        self.is_in_several_planes |=
            self.along_normal.cross(normal).length() > PARALLEL * self.along_normal.length();
        self.along_normal = longer(self.along_normal, along_normal);
        self.along_perturbation = longer(self.along_perturbation, (FACTOR * delta / slope.abs()) * direction);
    }

    /// The shift; 0 if the line lies in no face.
    pub fn vector(&self) -> Vec3 {
        if self.is_in_several_planes { self.along_perturbation } else { self.along_normal }
    }
}

/// The longer of two vectors. Among equal lengths an order of the components decides, so that the longest of many
/// does not depend on their order.
fn longer(a: Vec3, b: Vec3) -> Vec3 {
    let rank = |v: Vec3| (v.length_squared(), v.x, v.y, v.z);
    if rank(b) > rank(a) { b } else { a }
}
