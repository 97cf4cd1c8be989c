//! Evaluation of camera, lights and rendering options.

use super::context::Context;
use super::numbers::Numbers;
use super::solids::direction;
use crate::colour::Colour;
use crate::diagnostic::Diagnostic;
use crate::document::{CameraEntry, LightEntry, LightKind, ProjectionEntry, RenderEntry};
use crate::scene::{Camera, Light, Projection, RenderSettings};
use crate::source::{Span, Spanned};
use rayweave_math::Vec3;

/// The default vertical field of view, in degrees.
const FOV: f64 = 35.0;

/// The maximum number of pixels along one side of a picture.
const MAX_PIXELS: u32 = 32_768;

pub(super) fn build(
    context: &mut Context,
    numbers: &mut Numbers,
) -> (Option<Camera>, Vec<Light>, RenderSettings) {
    let document = context.document;
    let camera = document.camera.as_ref().and_then(|entry| camera(context, numbers, entry));
    let lights = document.lights.iter().filter_map(|entry| light(context, numbers, entry)).collect();
    let render = document.render.as_ref().map(|entry| render(context, numbers, entry));
    (camera, lights, render.unwrap_or_default())
}

fn camera(context: &mut Context, numbers: &Numbers, entry: &Spanned<CameraEntry>) -> Option<Camera> {
    let (entry, span) = (&entry.value, entry.span);
    let projection = projection(context, numbers, &entry.projection);
    let position = numbers.vector(context, &entry.position);
    let target = entry.target.as_ref().map_or(Some(Vec3::ZERO), |target| numbers.vector(context, target));
    let up = entry.up.as_ref().map_or(Some(Vec3::Z), |up| direction(context, numbers, up, "direction `up`"));
    let size = entry
        .size
        .as_ref()
        .map(|size| size.each_ref().map(|n| numbers.whole(context, "a side of `size`", n, 1, MAX_PIXELS)));
    let size = match size {
        Some([width, height]) => Some((width?, height?)),
        None => None,
    };
    let (position, target) = (position?, target?);
    let up = sensible_up(context, target - position, up?, entry.up.is_some(), span)?;
    Some(Camera { projection: projection?, position, target, up, size })
}

/// Validates the up direction: the camera must have a direction of view that is not parallel to it.
/// If the default +z is parallel, +y replaces it.
fn sensible_up(context: &mut Context, view: Vec3, up: Vec3, stated: bool, span: Span) -> Option<Vec3> {
    if view == Vec3::ZERO {
        let problem = Diagnostic::error("the camera has no direction of view");
        context.push(problem.why("its position equals its target"), span);
        return None;
    }
    // below 1e-9 rad, the direction to the side has no significant digits
    let parallel = view.normalize().cross(up.normalize()).length() < 1e-9;
    if parallel && stated {
        let problem = Diagnostic::error("the direction of view is parallel to `up`");
        context.push(problem.why("the upward direction of the picture is undefined"), span);
        return None;
    }
    Some(if parallel { Vec3::Y } else { up })
}

fn projection(context: &mut Context, numbers: &Numbers, entry: &ProjectionEntry) -> Option<Projection> {
    match entry {
        ProjectionEntry::Perspective(None) => Some(Projection::Perspective { fov: FOV }),
        ProjectionEntry::Perspective(Some(fov)) => {
            let condition = "an angle in degrees greater than 0 and less than 180";
            let fov = numbers.checked(context, "`fov`", fov, condition, |fov| 0.0 < fov && fov < 180.0)?;
            Some(Projection::Perspective { fov })
        }
        ProjectionEntry::Orthographic(height) => {
            let positive = |height: f64| height > 0.0 && height.is_finite();
            let height =
                numbers.checked(context, "`height`", height, "finite and greater than 0", positive)?;
            Some(Projection::Orthographic { height })
        }
    }
}

fn light(context: &mut Context, numbers: &Numbers, entry: &LightEntry) -> Option<Light> {
    let kind = match &entry.kind {
        LightKind::Direction(vector) => {
            direction(context, numbers, vector, "direction").map(LightKind::Direction)
        }
        LightKind::Position(vector) => numbers.vector(context, vector).map(LightKind::Position),
    };
    let sensible = |value: f64| value >= 0.0 && value.is_finite();
    let intensity = match &entry.intensity {
        Some(intensity) => {
            numbers.checked(context, "`intensity`", intensity, "finite and at least 0", sensible)
        }
        None => Some(1.0),
    };
    Some(Light {
        kind: kind?,
        intensity: intensity?,
        colour: entry.colour.as_ref().map_or(Colour::WHITE, |colour| colour.value),
    })
}

fn render(context: &mut Context, numbers: &Numbers, entry: &RenderEntry) -> RenderSettings {
    RenderSettings {
        background: entry.background.as_ref().map(|colour| colour.value),
        shading: entry.shading.as_ref().map(|shading| shading.value),
        edges: entry.edges.as_ref().map(|edges| edges.value),
        shadows: entry.shadows.as_ref().map(|shadows| shadows.value),
        samples: entry
            .samples
            .as_ref()
            .and_then(|samples| numbers.whole(context, "`samples`", samples, 1, 16)),
    }
}
