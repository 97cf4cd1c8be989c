//! Cameras of pictures and radiographs.

use pyo3::prelude::*;
use rayweave::math::Vec3;
use rayweave::scene::{Camera, Projection};

use crate::vectors::vector;

/// A camera from the attributes of a `rayweave.Camera`.
pub fn camera_of(object: &Bound<'_, PyAny>) -> PyResult<Camera> {
    let number = |name: &str| object.getattr(name)?.extract::<Option<f64>>();
    let place = |name: &str| vector(&object.getattr(name)?, &format!("camera.{name}"));
    let projection = match (number("height")?, number("field_of_view")?) {
        (Some(height), _) => Projection::Orthographic { height },
        (None, degrees) => {
            Projection::Perspective { fov: degrees.unwrap_or(rayweave::picture::FIELD_OF_VIEW) }
        }
    };
    let (position, target, up): (Vec3, Vec3, Vec3) = (place("position")?, place("target")?, place("up")?);
    Ok(Camera { projection, position, target, up, size: None })
}
