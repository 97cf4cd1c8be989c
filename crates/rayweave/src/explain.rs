//! How an answer comes about.

use crate::Error;
use rayweave_model::{Program, Query, Window};
use rayweave_shape::Ray;
use rayweave_trace::SingleHit;
use rayweave_trace::single_hit::Explanation;
use std::sync::Arc;

/// The story of how the crossings of one ray come about: every question to the model, every decision at a gate of its
/// tree with the answers that it was made from, and the crossings. Printed, it reads as text; its fields hold the same
/// as data.
///
/// # Errors
///
/// [`crate::ErrorKind::Value`] if the ray is out of range (see [`Ray::check`]), [`crate::ErrorKind::Compile`] if the
/// model is too large for [`SingleHit`], which tells the story.
///
/// ```
/// use rayweave::{Program, Ray, Vec3, Window, explain, shapes};
/// use std::sync::Arc;
///
/// let eye = shapes::sphere(2.0)?.named("ball") - shapes::half_space(Vec3::X, 0.0)?.named("left");
/// let program = Arc::new(Program::compile(&eye)?);
/// let ray = Ray::new(Vec3::new(-5.0, 0.0, 0.0), Vec3::X);
/// let story = explain(&program, ray, Window::ALL)?;
/// assert_eq!(story.crossings.len(), 2);
/// let line = "ball - left stays outside at 3: ball is entered, but the ray is inside left until 5. So ball is asked again.";
/// assert!(story.to_string().contains(line), "{story}");
/// # Ok::<(), rayweave::Error>(())
/// ```
pub fn explain(program: &Arc<Program>, ray: Ray, window: Window) -> Result<Explanation, Error> {
    ray.check()?;
    let evaluator = SingleHit::new(program.clone())?;
    Ok(evaluator.explain(ray, &Query { window, ..Query::default() }))
}
