//! State of the writer, and the text of positions and rotations.

use crate::write::model::Model;
use crate::write::remark::Remarks;
use rayweave_math::{Affine, Bounds, Mat3, Vec3};
use rayweave_model::Solid;
use rayweave_scene::Table;
use std::collections::{HashMap, HashSet};

/// A solid of the file in its own frame, with its rotation and translation.
#[derive(Clone)]
pub struct Part {
    pub solid: String,
    pub place: Affine,
}

/// State of the writer.
pub struct Writer<'m, 's> {
    pub model: &'m Model<'s>,
    pub remarks: &'m mut Remarks,
    pub region: usize,
    /// Millimetres per unit of the scene.
    pub scale: f64,
    pub clip: Bounds,
    pub defines: String,
    pub solids: String,
    pub count: usize,
    /// Names of solids in use.
    pub taken: HashSet<String>,
    /// Elements of the original file, by the names of their solids.
    pub origins: HashMap<String, Vec<Origin>>,
    /// Regions written so far.
    pub known: HashMap<usize, Option<Part>>,
}

/// An element of the file from which the scene was read.
pub struct Origin {
    pub row: Table,
    /// The solid of the element, once it was needed.
    pub solid: Option<Option<Solid>>,
    /// Its name in the new file, once it was written.
    pub written: Option<String>,
}

/// Text of a structure, and the name of its world.
pub struct Structure {
    pub volumes: String,
    pub world: String,
}

/// Position and rotation elements; empty for the identity. Boolean solids give the rotation of the second operand,
/// placements that of the frame.
pub fn place_text(place: &Affine, is_placement: bool) -> (String, String) {
    let t = place.translation;
    let position = match t == Vec3::ZERO {
        true => String::new(),
        false => format!("\n        <position x=\"{:?}\" y=\"{:?}\" z=\"{:?}\" unit=\"mm\"/>", t.x, t.y, t.z),
    };
    let turned = if is_placement { place.linear.transpose() } else { place.linear };
    let [x, y, z] = angles(&turned);
    let rotation = match [x, y, z] == [0.0; 3] {
        true => String::new(),
        false => format!("\n        <rotation x=\"{x:?}\" y=\"{y:?}\" z=\"{z:?}\" unit=\"deg\"/>"),
    };
    (position, rotation)
}

/// Rotation angles in degrees about x, then y, then z.
fn angles(r: &Mat3) -> [f64; 3] {
    let (cx, cy, cz) = (r.x_axis, r.y_axis, r.z_axis);
    let cosine = libm::hypot(cx.x, cx.y);
    let y = libm::atan2(-cx.z, cosine);
    let (x, z) = match cosine > 1e-9 {
        true => (libm::atan2(cy.z, cz.z), libm::atan2(cx.y, cx.x)),
        // gimbal lock: the other two rotate about the same axis
        false => (libm::atan2(-cz.y, cy.y), 0.0),
    };
    // + 0.0 turns -0.0 into 0.0
    [x, y, z].map(|angle| angle.to_degrees() + 0.0)
}
