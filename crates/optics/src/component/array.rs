//! Fresnel lenses and lenslet arrays.

use super::aperture::solid;
use super::error::{consistent, positive};
use super::face::{Face, Profile};
use super::{Aperture, ComponentError};
use rayweave_error::Message;
use rayweave_math::{Affine, Vec3};
use rayweave_model::Solid;
use rayweave_shape::primitive::{Cylinder, HalfSpace};

/// The greatest number of grooves, and of lenslets along an axis.
const MAX_COUNT: f64 = 65536.0;

/// The maximum number of lenslets of an array: their maps take 400 MB.
const MAX_LENSLETS: u64 = 1 << 22;

/// A Fresnel lens: a plane in front (`front.plane`), behind it the rings of a convex surface of
/// radius |`r`| and conic constant `conic` (see [`sag`](super::sag)), each `pitch` wide and set
/// back to the same base, so that its outer edge is `thickness` behind the front.
///
/// The front is at z = -`thickness`/2. The rings are `back.side`, the steps between them
/// `draft.side` and the rim `edge.side`. In the ring between the radii a and b, the thickness at h
/// is `thickness + sag(b) - sag(h)`.
///
/// # Errors
/// Sizes that are not positive, a radius that is 0 or NaN, a diameter larger than the surface, more
/// than 65536 rings.
pub fn fresnel_lens(
    r: f64,
    conic: f64,
    pitch: f64,
    thickness: f64,
    diameter: f64,
) -> Result<Solid, ComponentError> {
    let part = "Fresnel lens";
    let profile = Profile::conic(-r.abs(), conic).checked(part, "r")?;
    let (pitch, thickness) = (positive(part, "pitch", pitch)?, positive(part, "thickness", thickness)?);
    let (reach, limit) = (0.5 * positive(part, "diameter", diameter)?, profile.limit());
    if reach > limit {
        return Err(ComponentError::ApertureTooLarge { part, surface: "back", reach, limit });
    }
    let rings = (reach / pitch).ceil();
    check_count(part, rings)?;
    let mut inner: Option<Solid> = None;
    let mut all = Vec::new();
    for ring in 1..=rings as u32 {
        let outer = if f64::from(ring) < rings { pitch * f64::from(ring) } else { reach };
        let wall = wall(outer, f64::from(ring) < rings)?;
        let within = if let Some(inner) = &inner { &wall - inner } else { wall.clone() };
        all.push(ring_back(profile, thickness, outer)? & within);
        inner = Some(wall);
    }
    let front = solid(HalfSpace::new(-Vec3::Z, 0.5 * thickness)?).named("front");
    Ok(front & Solid::union(all))
}

/// The round wall outside a ring.
fn wall(radius: f64, is_step: bool) -> Result<Solid, ComponentError> {
    let name = if is_step { "draft" } else { "edge" };
    Ok(solid(Cylinder::new(radius, f64::INFINITY)?).named(name))
}

/// The points before the surface of a ring, which has z = `thickness`/2 at its outer radius.
fn ring_back(profile: Profile, thickness: f64, outer: f64) -> Result<Solid, ComponentError> {
    let drop = -profile.sag(outer).unwrap_or(0.0);
    let (base, depth) = (0.5 * thickness, 0.5 * thickness + drop);
    let face = Face { name: "back", vertex: depth, profile };
    let before = face.before(-base)?;
    if profile.conic >= -1.0 {
        return Ok(before);
    }
    // without the other sheet of the hyperboloid
    let end = face.ceiling(depth, thickness);
    Ok(before & solid(HalfSpace::new(Vec3::Z, end)?).named("back"))
}

/// A plate of plano-convex lenses, `columns` along x and `rows` along y, each with the rectangular
/// outline `pitch` by `pitch`, the radius |`r`| and the thickness `thickness` on its own axis.
///
/// The front (`front.plane`) is at z = -`thickness`/2, the vertices (`back.side`) are at z =
/// `thickness`/2, and the array is centred on the axis. The lenslets are placements of one solid,
/// compiled once; they touch without a gap.
///
/// # Errors
/// As for [`lens`](super::lens), and no columns or rows, more than 65536 of them, or more than 2^22 lenslets.
pub fn lenslet_array(
    r: f64,
    thickness: f64,
    pitch: f64,
    columns: u32,
    rows: u32,
) -> Result<Solid, ComponentError> {
    let part = "lenslet array";
    positive(part, "columns", f64::from(columns))?;
    positive(part, "rows", f64::from(rows))?;
    check_count(part, f64::from(columns.max(rows)))?;
    let lenslets = u64::from(columns) * u64::from(rows);
    consistent(lenslets <= MAX_LENSLETS, || {
        Message::new(format!("{part} has {lenslets} lenslets"), format!("at most {MAX_LENSLETS} are allowed"))
    })?;
    let lenslet = super::plano_convex(r, thickness, Aperture::rectangle(pitch, pitch))?;
    let middle = |count: u32, k: u32| pitch * (f64::from(k) - 0.5 * f64::from(count - 1));
    let place = |row: u32| {
        move |column: u32| Affine::translate(Vec3::new(middle(columns, column), middle(rows, row), 0.0))
    };
    let places: Vec<Affine> = (0..rows).flat_map(|row| (0..columns).map(place(row))).collect();
    Ok(lenslet.place(places))
}

fn check_count(part: &'static str, count: f64) -> Result<(), ComponentError> {
    consistent(count <= MAX_COUNT, || {
        let problem = format!("{part} has {count} pieces in a row");
        Message::new(problem, format!("at most {MAX_COUNT} are allowed")).suggest("Is the pitch too small?")
    })
}
