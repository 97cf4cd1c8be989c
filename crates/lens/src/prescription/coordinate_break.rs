//! Coordinate breaks: decentres and tilts of the axis.

use rayweave_math::{Affine, Vec3};

/// A coordinate break: the surface behind it, and all that follow, lie in another frame than on the axis.
///
/// The frame in front of a break has its origin where the vertex of the surface would be, and z along the axis so far.
/// Thicknesses go on along the new z. First-order data do not know of breaks: they are those of the surfaces on one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CoordinateBreak {
    /// The surface that it is in front of, counted from 1; the image is one more than the last surface.
    pub before: usize,
    /// Coordinates in front of the break from those behind it: a rigid map.
    pub map: Affine,
}

impl CoordinateBreak {
    /// A decentre along x and y, then tilts in degrees about x, about the new y and about the new z, each right-handed: what
    /// Zemax's coordinate break does by default (OpticStudio user guide, Ansys, 2024 R2, "Coordinate Break").
    pub fn new(before: usize, decentre: [f64; 2], tilt_degrees: [f64; 3]) -> CoordinateBreak {
        let [x, y, z] = turns(tilt_degrees);
        let map = z.then(&y).then(&x).then(&shift(decentre));
        CoordinateBreak { before, map }
    }

    /// The tilts first, about z, the new y and the new x, then the decentre: with all signs changed the way back from
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
