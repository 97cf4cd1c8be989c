//! Coordinate breaks: decentres and tilts of the axis.

use rayweave_math::{Affine, Vec3};

/// A coordinate break: a change of frame for the next surface and all that follow.
///
/// The frame in front of a break has its origin at the vertex that the surface would have, and z along the
/// axis so far. Thicknesses continue along the new z. First-order data ignore breaks: they describe the
/// surfaces on one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateBreak {
    /// The surface behind the break, counted from 1; one more than the last surface for the image.
    pub before: usize,
    /// The rigid map from coordinates behind the break to those in front of it.
    pub map: Affine,
}

impl CoordinateBreak {
    /// A decentre along x and y, then tilts in degrees about x, the new y and the new z, each right-handed:
    /// the default order of Zemax's coordinate break (OpticStudio user guide, Ansys, 2024 R2, "Coordinate
    /// Break").
    pub fn new(before: usize, decentre: [f64; 2], tilt_degrees: [f64; 3]) -> CoordinateBreak {
        let [x, y, z] = turns(tilt_degrees);
        let map = z.then(&y).then(&x).then(&shift(decentre));
        CoordinateBreak { before, map }
    }

    /// Tilts about z, the new y and the new x, then the decentre. With all signs changed it is the inverse of
    /// [`CoordinateBreak::new`].
    pub fn tilts_first(before: usize, decentre: [f64; 2], tilt_degrees: [f64; 3]) -> CoordinateBreak {
        let [x, y, z] = turns(tilt_degrees);
        let map = shift(decentre).then(&x).then(&y).then(&z);
        CoordinateBreak { before, map }
    }
}

fn turns([x, y, z]: [f64; 3]) -> [Affine; 3] {
    [Affine::rotation(Vec3::X, x), Affine::rotation(Vec3::Y, y), Affine::rotation(Vec3::Z, z)]
}

fn shift([x, y]: [f64; 2]) -> Affine {
    Affine::translate(Vec3::new(x, y, 0.0))
}
