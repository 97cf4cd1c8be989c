//! Cameras: position, orientation and projection.

use crate::{CameraError, RenderError, Size};
use rayweave_math::{Bounds, Vec3, any_perpendicular};
use rayweave_model::{PixelCamera, Program};
use rayweave_shape::{Ray, RayError};

/// A projection of space onto the picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// All rays leave the position of the camera.
    Perspective {
        /// The vertical field of view in degrees, in (0, 180): the angle between the rays through the middles
        /// of the upper and lower edge.
        field_of_view: f64,
    },
    /// All rays are parallel: no foreshortening.
    Orthographic {
        /// The height of the picture in lengths of the model, > 0.
        height: f64,
    },
}

/// A camera: a position, three perpendicular unit vectors, and a projection.
///
/// For a picture of w x h pixels, let `u = (2 x - w) / h` and `v = (h - 2 y) / h`, where (x, y) is measured
/// in pixels from the upper left corner; the centre of pixel (i, j) is (i + 1/2, j + 1/2). So v runs from 1
/// at the top to -1 at the bottom, and pixels are square. The ray through (x, y) is
///
/// - perspective: from `position` along `forward + s (u right + v up)`, normalised, with s = tan(field of
///   view / 2);
/// - orthographic: from `position + height / 2 (u right + v up)` along `forward`.
///
/// `right = forward x up`: seen from the camera, the axes are right-handed. Directions have unit length, so
/// `t` along a ray is a length. Only t > 0 is visible.
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
    /// A camera with `target` at the centre of the picture.
    ///
    /// `up` is the upward direction in the picture, of any length; if it is zero or parallel to the line of
    /// sight, an arbitrary perpendicular vector replaces it.
    ///
    /// # Errors
    /// [`CameraError`] for arguments that are not finite, `position` equal to `target`, and a field of view
    /// or height out of range.
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
    /// As for [`Camera::new`].
    pub fn perspective(
        position: impl Into<Vec3>,
        target: impl Into<Vec3>,
        up: impl Into<Vec3>,
        field_of_view: f64,
    ) -> Result<Camera, CameraError> {
        let projection = Projection::Perspective { field_of_view };
        Camera::new(position.into(), target.into(), up.into(), projection)
    }

    /// An orthographic camera; `height` is that of the picture in model units.
    ///
    /// # Errors
    /// As for [`Camera::new`].
    pub fn orthographic(
        position: impl Into<Vec3>,
        target: impl Into<Vec3>,
        up: impl Into<Vec3>,
        height: f64,
    ) -> Result<Camera, CameraError> {
        let projection = Projection::Orthographic { height };
        Camera::new(position.into(), target.into(), up.into(), projection)
    }

    /// A camera at a finite position with a unit line of sight.
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
            // below this, the direction of the product is mostly rounding error
            .filter(|right| right.length() > 1e-9)
            .and_then(unit)
            .unwrap_or_else(|| any_perpendicular(forward));
        Ok(Camera { position, forward, right, up: right.cross(forward), projection, half_height })
    }

    /// The position.
    pub fn position(&self) -> Vec3 {
        self.position
    }

    /// The line of sight, of unit length.
    pub fn forward(&self) -> Vec3 {
        self.forward
    }

    /// The unit vector to the right in the picture.
    pub fn right(&self) -> Vec3 {
        self.right
    }

    /// The unit vector upwards in the picture.
    pub fn up(&self) -> Vec3 {
        self.up
    }

    /// The projection.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// Checks that the model does not vanish at the distance of the camera: see [`RayError::TooFar`].
    ///
    /// # Errors
    /// [`RenderError::TooFar`]. Other limits of rays are not checked here.
    pub fn check(&self, program: &Program) -> Result<(), RenderError> {
        match program.check_ray(&self.ray_towards(program.bounds())) {
            Err(RayError::TooFar { distance, accuracy, size }) => {
                Err(RenderError::TooFar { distance, accuracy, size })
            }
            _ => Ok(()),
        }
    }

    /// The ray towards the middle of a box, whether or not it is in the picture; the line of sight if the box has no middle.
    fn ray_towards(&self, bounds: Bounds) -> Ray {
        let towards = bounds.centre() - self.position;
        match (bounds.is_finite(), self.projection) {
            (true, Projection::Perspective { .. }) => {
                Ray::new(self.position, unit(towards).unwrap_or(self.forward))
            }
            (true, Projection::Orthographic { .. }) => {
                let aside = towards - towards.dot(self.forward) * self.forward;
                Ray::new(self.position + aside, self.forward)
            }
            (false, _) => Ray::new(self.position, self.forward),
        }
    }

    /// The ray through the point (x, y), in pixels from the upper left corner.
    #[inline(always)] // into loops that are compiled for wider instructions
    pub fn ray(&self, size: Size, x: f64, y: f64) -> Ray {
        self.pixel_camera(size).ray(x, y)
    }

    /// The numbers that define the rays of a picture.
    #[inline(always)]
    pub fn pixel_camera(&self, size: Size) -> PixelCamera {
        PixelCamera {
            position: self.position,
            forward: self.forward,
            right: self.right,
            up: self.up,
            half_height: self.half_height,
            is_perspective: matches!(self.projection, Projection::Perspective { .. }),
            size: [size.width() as u32, size.height() as u32],
        }
    }

    /// Projects a point: its pixel coordinates from the upper left corner, inside the picture or not. `None`
    /// at or behind the position of a perspective camera.
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

    /// The side of a pixel at distance `t`, in model units.
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

/// The unit vector along a finite one, without intermediate overflow; `None` for zero.
fn unit(vector: Vec3) -> Option<Vec3> {
    let largest = vector.abs().max_element();
    (vector / largest).try_normalize()
}
