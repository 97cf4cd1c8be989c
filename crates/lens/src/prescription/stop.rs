//! The sheets of the aperture stop: a plane in a medium, or a ring on the face of a lens and the mount around it.

use super::{Behind, Prescription, Resolved};
use rayweave_math::{Affine, Vec3};
use rayweave_optics::Medium;
use rayweave_optics::component::{Aperture, Asphere, ComponentError, Sheet, SurfaceForm};

/// The name of the stop element. There is none if the stop is the rim of the widest lens, or of a mirror.
pub const STOP: &str = "stop";
/// The name of the plate around the lens with the stop, which blocks light that would pass beside that lens.
pub const MOUNT: &str = "mount";

/// Relative difference of semi-diameters that counts as rounding.
const EQUAL: f64 = 1e-9;

/// The gap between a face and the ring on it, relative to the semi-diameter of the face and to the length of the
/// system: some 10^4 times the rounding errors of crossings, 64 u times the lengths. The two are placed by different maps and agree
/// up to rounding only; with the gap, light from the air meets the ring first, so that the face reflects none of what the stop blocks.
/// The height of a ray on the ring differs by less than the gap from that on the face, unless the ray is steep.
const GAP: [f64; 2] = [1e-9, 1e-10];

/// Steps along the radius in which surfaces are compared with the plane of the mount.
const STEPS: u32 = 64;

/// An absorbing sheet of the aperture stop.
#[derive(Clone, Debug, PartialEq)]
pub struct StopSheet {
    /// The name of the element: [`STOP`] or [`MOUNT`].
    pub name: &'static str,
    /// The form of the surface.
    pub form: SurfaceForm,
    /// The semi-diameter of the opening.
    pub opening: f64,
    /// The semi-diameter of the outline.
    pub outline: f64,
    /// The height of its vertex above that of the stop's surface.
    height: f64,
}

impl StopSheet {
    fn plane(name: &'static str, [opening, outline]: [f64; 2], height: f64) -> StopSheet {
        let form = Asphere::conic(f64::INFINITY, 0.0).into();
        StopSheet { name, form, opening, outline, height }
    }

    /// The sheet; `place` is the placement of the stop's surface with its vertex at the origin.
    pub(super) fn sheet(&self, place: &Affine) -> Result<Sheet, ComponentError> {
        let [outline, opening] = [self.outline, self.opening].map(|reach| Aperture::circle(2.0 * reach));
        let is_plane = self.form == Asphere::conic(f64::INFINITY, 0.0).into();
        let sheet = match is_plane {
            true => Sheet::stop(outline, opening),
            false => Sheet::curved_stop(&self.form, outline, opening),
        };
        sheet?.apply(&Affine::translate(Vec3::Z * self.height).then(place))
    }
}

/// The extents of the solids at each surface: semi-diameters.
#[derive(Clone, Debug)]
pub(super) struct Extents {
    /// The clear semi-diameters; the last is that of the image.
    pub clear: Vec<f64>,
    /// The extent of the surface as a face of a lens.
    pub face: Vec<f64>,
    /// The extent of the lenses at the surface, with their flat rims.
    pub part: Vec<f64>,
}

impl Extents {
    pub fn new(clear: &[f64]) -> Extents {
        Extents { clear: clear.to_vec(), face: clear.to_vec(), part: clear.to_vec() }
    }

    /// Adds a lens: the number of each of its surfaces with the semi-diameter at which it ends, and the semi-diameter of the lens.
    pub fn add_lens(&mut self, surfaces: [(usize, f64); 2], semi_diameter: f64) {
        for (k, end) in surfaces {
            self.part[k] = self.part[k].max(semi_diameter);
            self.face[k] = self.face[k].max(end);
        }
    }
}

/// The sheets of the stop.
///
/// A stop between equal media is a plane at the vertex. A stop on a face of a lens is a ring on that face,
/// from the clear semi-diameter to the end of the face, off it by a tiny gap; light is blocked at the sag of the surface, as
/// by a sequential trace that compares the height of a ray on the surface with the semi-diameter. Around the
/// lens, a plane mount blocks the light beside it; the mount is left out where it is not needed, because no other
/// surface is wider, and where it could lie in the path of the light: in systems with mirrors or coordinate
/// breaks, and where a neighbour extends through its plane.
pub(super) fn stop_sheets(lens: &Prescription, resolved: &Resolved, extents: &Extents) -> Vec<StopSheet> {
    let k = lens.stop - 1;
    let surface = &lens.surfaces[k];
    if surface.behind == Behind::Mirror {
        return Vec::new();
    }
    let count = lens.surfaces.len();
    let widest = extents.clear.iter().fold(0.0_f64, |widest, &reach| widest.max(reach));
    let clear = extents.clear[k];
    if resolved.media[k] == resolved.media[k + 1] {
        return vec![StopSheet::plane(STOP, [clear, 2.0 * widest.max(clear)], 0.0)];
    }
    let opening = opening(lens, resolved, extents);
    let is_wider = |reach: f64, than: f64| reach > than * (1.0 + EQUAL);
    let mut sheets = Vec::new();
    if is_wider(extents.face[k], opening) {
        let (form, outline) = (resolved.forms[k].clone(), extents.face[k]);
        let height = gap(resolved, k, outline);
        sheets.push(StopSheet { name: STOP, form, opening, outline, height });
    }
    let reach = extents.part[k].max(opening);
    let widest = extents.clear[..count].iter().fold(0.0_f64, |widest, &reach| widest.max(reach));
    let is_lens_in_front = resolved.media[k] != Medium::vacuum();
    if let Some(height) = rim(&resolved.forms[k], extents.face[k], is_lens_in_front)
        && is_wider(widest, reach)
        && is_free(lens, resolved, extents, [reach, height])
    {
        let name = if sheets.is_empty() { STOP } else { MOUNT };
        sheets.push(StopSheet::plane(name, [reach, 2.0 * widest], height));
    }
    sheets
}

/// The distance along z of the ring from the face: into the air, or in front of the face if there is no air.
fn gap(resolved: &Resolved, k: usize, reach: f64) -> f64 {
    let span = resolved.vertices.iter().fold(0.0_f64, |span, z| span.max(z.abs()));
    let is_behind = resolved.media[k + 1] == Medium::vacuum();
    let size = GAP[0] * reach + GAP[1] * span;
    if is_behind == resolved.forward[k] { size } else { -size }
}

/// The semi-diameter of the opening of a stop on a face. In systems with mirrors, light may pass the same face
/// again: the wider pass counts.
fn opening(lens: &Prescription, resolved: &Resolved, extents: &Extents) -> f64 {
    let k = lens.stop - 1;
    let has_mirrors = resolved.forward.iter().any(|forward| !forward);
    let span = resolved.vertices.iter().fold(0.0_f64, |span, z| span.max(z.abs()));
    let is_same = |j: usize| {
        let apart = (resolved.vertices[j] - resolved.vertices[k]).abs();
        apart <= EQUAL * span && resolved.are_aligned(j, k)
    };
    let passes = (0..lens.surfaces.len()).filter(|&j| j == k || (has_mirrors && is_same(j)));
    passes.fold(0.0, |widest, j| extents.clear[j].max(widest))
}

/// The height of the mount above the vertex of the stop's surface: at its rim or, if that is not plane, where the plane cuts the edge
/// of the lens everywhere, so that no light passes between the two. `None` beyond the end of the surface.
fn rim(form: &SurfaceForm, reach: f64, is_lens_in_front: bool) -> Option<f64> {
    let heights = form.directions().map(|[x, y]| form.sag([reach * x, reach * y]));
    let heights = heights.collect::<Option<Vec<f64>>>()?;
    heights.into_iter().reduce(if is_lens_in_front { f64::min } else { f64::max })
}

/// True if no light of the prescription crosses the plane at a height above the stop's vertex outside `reach`:
/// all surfaces before the stop lie in front of the plane there, and all others behind it.
fn is_free(lens: &Prescription, resolved: &Resolved, extents: &Extents, [reach, height]: [f64; 2]) -> bool {
    let k = lens.stop - 1;
    let plane = resolved.vertices[k] + height;
    let is_folded = !resolved.poses.is_empty() || resolved.forward.iter().any(|forward| !forward);
    if is_folded || (lens.object_distance.is_finite() && -lens.object_distance >= plane) {
        return false;
    }
    let mut others = (0..extents.clear.len()).filter(|&j| j != k && extents.face[j] > reach);
    others.all(|j| {
        let (form, vertex, end) = (&resolved.forms[j], resolved.vertices[j], extents.face[j]);
        let mut radii = (0..=STEPS).map(|step| reach + (end - reach) * f64::from(step) / f64::from(STEPS));
        radii.all(|r| {
            let mut sags = form.directions().map(|[x, y]| form.sag([r * x, r * y]));
            sags.all(|sag| sag.is_some_and(|sag| (vertex + sag < plane) == (j < k)))
        })
    })
}
