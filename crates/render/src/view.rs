//! Standard views, and cameras that fit a model.

use crate::{Camera, CameraError, Projection, Size};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::Program;
use std::fmt;
use std::str::FromStr;

/// A direction of view, named as on technical drawings. z is up, x to the right in the front view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// Along +y; x to the right, z up.
    Front,
    /// Along -y; -x to the right, z up.
    Back,
    /// From the left, along +x; -y to the right, z up.
    Left,
    /// From the right, along -x; y to the right, z up.
    Right,
    /// Down along -z; x to the right, y up.
    Top,
    /// Up along +z; x to the right, -y up.
    Bottom,
    /// From (+x, -y, +z), at the same angle to all three axes; z up.
    #[default]
    Iso,
}

impl View {
    /// The margin that [`View::fit`] leaves on every side, as a fraction of the picture.
    pub const MARGIN: f64 = 0.04;

    /// All views.
    pub const ALL: [View; 7] =
        [View::Front, View::Back, View::Left, View::Right, View::Top, View::Bottom, View::Iso];

    /// The name in files, bindings and commands.
    pub fn name(self) -> &'static str {
        match self {
            View::Front => "front",
            View::Back => "back",
            View::Left => "left",
            View::Right => "right",
            View::Top => "top",
            View::Bottom => "bottom",
            View::Iso => "iso",
        }
    }

    /// The unit line of sight and the upward direction in the picture.
    pub fn forward_and_up(self) -> (Vec3, Vec3) {
        match self {
            View::Front => (Vec3::Y, Vec3::Z),
            View::Back => (Vec3::NEG_Y, Vec3::Z),
            View::Left => (Vec3::X, Vec3::Z),
            View::Right => (Vec3::NEG_X, Vec3::Z),
            View::Top => (Vec3::NEG_Z, Vec3::Y),
            View::Bottom => (Vec3::Z, Vec3::NEG_Y),
            View::Iso => (Vec3::new(-1.0, 1.0, -1.0).normalize(), Vec3::Z),
        }
    }

    /// An orthographic camera that shows all of a box; see [`View::fit`] for empty and infinite boxes.
    pub fn of_bounds(self, bounds: &Bounds, size: Size) -> Camera {
        let (forward, up) = self.forward_and_up();
        frame_orthographic(forward, up, bounds, size)
    }

    /// An orthographic camera that shows all of a model, with a margin of [`View::MARGIN`] on every side.
    ///
    /// For a model without finite bounds, each infinite side of its bounds is replaced by that of the box
    /// around the ball of the model ([`rayweave_model::Prototype::ball`], which contains the finite leaves
    /// and the anchor points of surfaces with their sizes, doubled). An empty model is seen from outside that box.
    pub fn fit(self, program: &Program, size: Size) -> Camera {
        self.of_bounds(&subject(program), size)
    }

    /// A perspective camera that shows all of a model, like [`View::fit`], with a vertical field of view in
    /// degrees.
    ///
    /// # Errors
    /// [`CameraError`] for a field of view out of range.
    pub fn fit_perspective(
        self,
        program: &Program,
        size: Size,
        field_of_view: f64,
    ) -> Result<Camera, CameraError> {
        let (forward, up) = self.forward_and_up();
        frame_perspective(forward, up, &subject(program), size, field_of_view)
    }
}

impl fmt::Display for View {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Error for an unknown name of a view.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no view is called '{0}': the views are front, back, left, right, top, bottom, iso.")]
pub struct UnknownView(String);

impl FromStr for View {
    type Err = UnknownView;

    fn from_str(name: &str) -> Result<View, UnknownView> {
        let found = View::ALL.into_iter().find(|view| view.name() == name);
        found.ok_or_else(|| UnknownView(name.to_owned()))
    }
}

/// A finite box of non-zero size that contains the visible part of a model.
fn subject(program: &Program) -> Bounds {
    let ball = &program.prototypes()[0].ball;
    // the ball is twice as large as its content
    let finite = Bounds::centred(ball.centre, Vec3::splat(0.5 * ball.radius));
    let bounds = program.bounds();
    if bounds.is_empty() {
        return finite;
    }
    let pick = |own: Vec3, other: Vec3| Vec3::select(own.is_finite_mask(), own, other);
    let seen = Bounds { lo: pick(bounds.lo, finite.lo), hi: pick(bounds.hi, finite.hi) };
    if seen.is_empty() { finite } else { seen }
}

/// The half extents of a box along the axes of a picture: right, up, forward.
fn half_extents(camera: &Camera, bounds: &Bounds) -> Vec3 {
    let half = 0.5 * bounds.size();
    let along = |axis: Vec3| axis.abs().dot(half);
    let extents = Vec3::new(along(camera.right()), along(camera.up()), along(camera.forward()));
    if extents.max_element() > 0.0 { extents } else { Vec3::ONE }
}

/// A camera at the centre of a box, to be moved back; its height does not matter.
fn at_centre(forward: Vec3, up: Vec3, bounds: &Bounds, projection: Projection) -> Camera {
    let upright = Camera::along(bounds.centre(), forward, up, projection);
    upright.unwrap_or_else(|_| unreachable!("the callers checked the projection"))
}

fn frame_orthographic(forward: Vec3, up: Vec3, bounds: &Bounds, size: Size) -> Camera {
    let unit = Projection::Orthographic { height: 1.0 };
    let camera = at_centre(forward, up, bounds, unit);
    let half = half_extents(&camera, bounds);
    let aspect = size.width() as f64 / size.height() as f64;
    // a box that projects to a point or a line still needs a picture of some height
    let half_height = half.y.max(half.x / aspect).max(1e-3 * half.max_element());
    let projection = Projection::Orthographic { height: 2.0 * half_height / (1.0 - 2.0 * View::MARGIN) };
    let back = 2.0 * half.length();
    let position = camera.position() - back * forward;
    Camera::along(position, forward, up, projection).unwrap_or(camera)
}

fn frame_perspective(
    forward: Vec3,
    up: Vec3,
    bounds: &Bounds,
    size: Size,
    field_of_view: f64,
) -> Result<Camera, CameraError> {
    let projection = Projection::Perspective { field_of_view };
    let camera = Camera::along(bounds.centre(), forward, up, projection)?;
    let aspect = size.width() as f64 / size.height() as f64;
    let slope = libm::tan(0.5 * field_of_view.to_radians()) * (1.0 - 2.0 * View::MARGIN);
    // the closest position with each corner in view, then one with all corners in view
    let nearest = bounds.corners().map(|corner| {
        let offset = corner - bounds.centre();
        let across = offset.dot(camera.up()).abs();
        let across = across.max(offset.dot(camera.right()).abs() / aspect);
        across / slope - offset.dot(forward)
    });
    let least = 1e-3 * half_extents(&camera, bounds).max_element();
    let back = nearest.into_iter().fold(least, f64::max);
    Camera::along(camera.position() - back * forward, forward, up, projection)
}
