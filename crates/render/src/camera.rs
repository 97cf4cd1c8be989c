//! Where a picture is taken from.

use crate::{CameraError, Size};
use rayweave_math::{Vec3, any_perpendicular};
use rayweave_shape::Ray;

/// How space becomes a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// As the eye sees it: all rays leave the position of the camera.
    Perspective {
        /// The angle between the rays through the middles of the upper and lower edge, in degrees, in (0, 180).
        field_of_view: f64,
    },
    /// Without foreshortening: all rays are parallel.
    Orthographic {
        /// The height of the picture in lengths of the model, > 0.
        height: f64,
    },
}

/// A camera: a position, three perpendicular unit vectors, and a projection.
///
/// For a picture of w x h pixels, let `u = (2 x - w) / h` and `v = (h - 2 y) / h`, where (x, y) is measured in pixels from
/// the upper left corner; the centre of pixel (i, j) is (i + 1/2, j + 1/2). So v runs from 1 at the top to -1 at the bottom,
/// and pixels are square. The ray of a place is
///
/// - perspective: from `position` along `forward + s (u right + v up)`, made unit, with s = tan(field of view / 2);
/// - orthographic: from `position + height / 2 (u right + v up)` along `forward`.
///
/// `right = forward x up`: seen from the camera, the axes are right-handed. Directions have unit length, so the time along
/// a ray is a length. Only what lies at t > 0 is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    position: Vec3,
    forward: Vec3,
    right: Vec3,
    up: Vec3,
    projection: Projection,
    /// Half the height of the picture: at distance 1, or in lengths of the model.
    half_height: f64,
}

impl Camera {
    /// A camera that sees `target` in the middle of the picture.
    ///
    /// `up` is the direction that points upwards in the picture, of any length; one that is zero or parallel to the line of
    /// sight is replaced by some perpendicular vector.
    ///
    /// # Errors
    /// Arguments that are not finite, `position` equal to `target`, a field of view or height out of range.
    pub fn new(
        position: Vec3,
        target: Vec3,
        up: Vec3,
        projection: Projection,
    ) -> Result<Camera, CameraError> {
        for (what, vector) in [("position", position), ("target", target), ("up", up)] {
            if !vector.is_finite() {
                return Err(CameraError::NotFinite { what });
            }
        }
        let forward = unit(target - position).ok_or(CameraError::NoDirection)?;
        Camera::along(position, forward, up, projection)
    }

    /// A perspective camera; `field_of_view` is vertical, in degrees.
    ///
    /// # Errors
    /// As [`Camera::new`].
    pub fn perspective(
        position: impl Into<Vec3>,
        target: impl Into<Vec3>,
        up: impl Into<Vec3>,
        field_of_view: f64,
    ) -> Result<Camera, CameraError> {
        let projection = Projection::Perspective { field_of_view };
        Camera::new(position.into(), target.into(), up.into(), projection)
    }

    /// An orthographic camera; `height` is that of the picture in lengths of the model.
    ///
    /// # Errors
    /// As [`Camera::new`].
    pub fn orthographic(
        position: impl Into<Vec3>,
        target: impl Into<Vec3>,
        up: impl Into<Vec3>,
        height: f64,
    ) -> Result<Camera, CameraError> {
        let projection = Projection::Orthographic { height };
        Camera::new(position.into(), target.into(), up.into(), projection)
    }

    /// A camera at a finite position that looks along a unit vector.
    pub(crate) fn along(
        position: Vec3,
        forward: Vec3,
        up: Vec3,
        projection: Projection,
    ) -> Result<Camera, CameraError> {
        let half_height = half_height(projection)?;
        // up is scaled first: the cross product of huge vectors would overflow
        let right = unit(up)
            .map(|up| forward.cross(up))
            // below this the direction of the product is mostly rounding
            .filter(|right| right.length() > 1e-9)
            .and_then(unit)
            .unwrap_or_else(|| any_perpendicular(forward));
        Ok(Camera { position, forward, right, up: right.cross(forward), projection, half_height })
    }

    /// Where the camera is.
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// The line of sight, of unit length.
    pub fn forward(&self) -> Vec3 {
        self.forward
    }

    /// What points to the right in the picture, of unit length.
    pub fn right(&self) -> Vec3 {
        self.right
    }

    /// What points upwards in the picture, of unit length.
    pub fn up(&self) -> Vec3 {
        self.up
    }

    /// How space becomes a picture.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// The ray of the place (x, y), in pixels from the upper left corner.
    #[inline(always)] // into loops that are compiled for wider instructions
    pub fn ray(&self, size: Size, x: f64, y: f64) -> Ray {
        let (w, h) = (size.width() as f64, size.height() as f64);
        let u = (2.0 * x - w) / h * self.half_height;
        let v = (h - 2.0 * y) / h * self.half_height;
        let perturbation = u * self.right + v * self.up;
        match self.projection {
            Projection::Perspective { .. } => {
                Ray::new(self.position, (self.forward + perturbation).normalize())
            }
            Projection::Orthographic { .. } => Ray::new(self.position + perturbation, self.forward),
        }
    }

    /// The place of a point in the picture, in pixels from the upper left corner, inside the picture or not; `None` for a
    /// point that no ray of a perspective camera can reach, at or behind its position.
    pub fn place_of(&self, size: Size, point: Vec3) -> Option<(f64, f64)> {
        let (w, h) = (size.width() as f64, size.height() as f64);
        let offset = point - self.position;
        let scale = match self.projection {
            Projection::Perspective { .. } => offset.dot(self.forward) * self.half_height,
            Projection::Orthographic { .. } => self.half_height,
        };
        let u = offset.dot(self.right) / scale;
        let v = offset.dot(self.up) / scale;
        (scale > 0.0).then_some((0.5 * (w + u * h), 0.5 * (h - v * h)))
    }

    /// The side of a pixel at distance `t`, in lengths of the model.
    pub(crate) fn footprint(&self, size: Size, t: f64) -> f64 {
        let pixel = 2.0 * self.half_height / size.height() as f64;
        match self.projection {
            Projection::Perspective { .. } => pixel * t,
            Projection::Orthographic { .. } => pixel,
        }
    }
}

fn half_height(projection: Projection) -> Result<f64, CameraError> {
    match projection {
        Projection::Perspective { field_of_view } => {
            if field_of_view > 0.0 && field_of_view < 180.0 {
                Ok(libm::tan(0.5 * field_of_view.to_radians()))
            } else {
                Err(CameraError::FieldOfView { degrees: field_of_view })
            }
        }
        Projection::Orthographic { height } => {
            if height > 0.0 && height.is_finite() {
                Ok(0.5 * height)
            } else {
                Err(CameraError::Height { height })
            }
        }
    }
}

/// The unit vector along a finite one, without overflow on the way; `None` for zero.
fn unit(vector: Vec3) -> Option<Vec3> {
    let largest = vector.abs().max_element();
    (vector / largest).try_normalize()
}
