//! Depth, normals and ids: what pictures are made from, as plain numbers.

use crate::extent::Extent;
use crate::sample::seen;
use crate::survey::centre;
use crate::{Camera, Plane, RenderError, Run, Size};
use rayweave_math::Vec3;
use rayweave_model::{Crossing, Evaluator, Query, RayAnswer, RayBatch, dress};
use rayweave_shape::Ray;

/// Which numbers [`ids`] gives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum IdKind {
    /// The number of the region, from 1; 0 for a miss: the world's number.
    #[default]
    Region,
    /// The number of the leaf ([`rayweave_model::LeafId`]), from 0; -1 for a miss.
    Leaf,
    /// The number of the face in [`rayweave_model::Program::facets`], from 0; -1 for a miss.
    Face,
    /// The number of the placement ([`rayweave_model::PlacementId`]), from 0 for the model itself; -1 for a miss.
    Placement,
}

/// The distance to the first surface at the centre of each pixel: t along the unit ray of the camera ([`Camera::ray`]), > 0;
/// +inf for a miss.
///
/// # Errors
/// The run was cancelled.
pub fn depth<E: Evaluator>(
    evaluator: &E,
    camera: &Camera,
    size: Size,
    run: &mut Run<'_>,
) -> Result<Plane<f64>, RenderError> {
    let value = |_: &Ray, crossing: &Crossing| crossing.t;
    plane(evaluator, camera, size, run, f64::INFINITY, value)
}

/// The unit normal of the first surface at the centre of each pixel, outward of what is entered or left: towards the camera
/// where it sees a region from outside, away from it where it looks out of a region into the world. NaN for a miss.
///
/// # Errors
/// The run was cancelled.
pub fn normals<E: Evaluator>(
    evaluator: &E,
    camera: &Camera,
    size: Size,
    run: &mut Run<'_>,
) -> Result<Plane<[f64; 3]>, RenderError> {
    let program = evaluator.program();
    let value = |ray: &Ray, crossing: &Crossing| dress::normal(program, ray, crossing).to_array();
    plane(evaluator, camera, size, run, Vec3::NAN.to_array(), value)
}

/// What the first surface at the centre of each pixel belongs to; see [`IdKind`].
///
/// # Errors
/// The run was cancelled.
pub fn ids<E: Evaluator>(
    evaluator: &E,
    camera: &Camera,
    size: Size,
    kind: IdKind,
    run: &mut Run<'_>,
) -> Result<Plane<i32>, RenderError> {
    let program = evaluator.program();
    let miss = match kind {
        IdKind::Region => 0,
        IdKind::Leaf | IdKind::Face | IdKind::Placement => -1,
    };
    let value = |_: &Ray, crossing: &Crossing| {
        let face = crossing.face;
        let number = match kind {
            IdKind::Region => seen(crossing).0,
            IdKind::Leaf => face.leaf.0,
            IdKind::Face => program.face_number(face.leaf, face.facet),
            IdKind::Placement => face.placement.0,
        };
        // compiling refuses models with more than 2^31 of anything
        number as i32
    };
    plane(evaluator, camera, size, run, miss, value)
}

/// The value of the first crossing on the ray of each pixel's centre.
fn plane<E: Evaluator, T: Clone + Send>(
    evaluator: &E,
    camera: &Camera,
    size: Size,
    run: &mut Run<'_>,
    miss: T,
    value: impl Fn(&Ray, &Crossing) -> T + Sync,
) -> Result<Plane<T>, RenderError> {
    let mut plane = Plane::filled(size, miss);
    let extent = Extent::new(camera, size, &evaluator.program().bounds());
    let rows = plane.values_mut().chunks_mut(size.width()).enumerate();
    let scratch = || (evaluator.scratch(), RayBatch::default());
    run.each(0.0..1.0, rows, scratch, |(scratch, batch), (y, row)| {
        let columns = extent.columns(y);
        let row = &mut row[columns.clone()];
        batch.clear();
        for [x, y] in columns.map(|x| centre(x, y)) {
            batch.push(camera.ray(size, x, y));
        }
        let rays = batch.rays();
        let mut take = |answer: RayAnswer<'_>| {
            if let Some(first) = answer.crossings.first() {
                row[answer.ray] = value(&rays.get(answer.ray), first);
            }
        };
        evaluator.crossings(rays, &Query::nearest(), scratch, &mut take);
    })?;
    Ok(plane)
}
