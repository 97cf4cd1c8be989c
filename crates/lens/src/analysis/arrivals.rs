//! Rays that arrive at a sheet.

use super::LensAnalysisError;
use crate::prescription::{Resolved, SurfaceIntersection};
use rayweave_math::{Affine, Vec3};
use rayweave_optics::{Segments, System};

/// A ray that arrives at a sheet, in the coordinates of the sheet: x and y along it, z along its normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// The number of the ray in its source.
    pub id: usize,
    /// The point on the sheet.
    pub position: Vec3,
    /// Its direction there, of unit length.
    pub direction: Vec3,
    /// The optical path length from the source.
    pub path: f64,
    /// The index of the medium in front of the sheet.
    pub index: f64,
    /// Its vacuum wavelength in nanometres.
    pub wavelength_nm: f64,
    /// The power, used as weight.
    pub power: f64,
}

/// The rays that arrive at the sheet named `sheet`, ordered by their ids. `sequence` lists the elements on
/// the path of the light, ending with the sheet; elements that transmit the ray undeviated are ignored.
/// Without it, the last arrival of each ray is returned.
///
/// # Errors
/// [`LensAnalysisError::NoSheet`].
pub fn arrivals(
    system: &System,
    segments: &Segments,
    sheet: &str,
    sequence: Option<&[usize]>,
) -> Result<Vec<Arrival>, LensAnalysisError> {
    let no_sheet = || LensAnalysisError::NoSheet(sheet.to_owned());
    let surface = system.sheet_surface(sheet).ok_or_else(no_sheet)? as i32;
    let frame = system.sheet_frame(sheet).ok_or_else(no_sheet)?;
    let local = frame.inverse().map_err(|_| no_sheet())?;
    let here = |&row: &usize| {
        segments.surface[row] == surface && sequence.is_none_or(|wanted| segments.followed(row, wanted))
    };
    let mut found: Vec<Arrival> =
        (0..segments.len()).filter(here).map(|row| arrival(segments, row, &local)).collect();
    // the sort is stable: the last arrival of a ray stays the last
    found.sort_by_key(|arrival| arrival.id);
    let mut last: Vec<Arrival> = Vec::with_capacity(found.len());
    for arrival in found {
        match last.last_mut().filter(|other| other.id == arrival.id) {
            Some(other) => *other = arrival,
            None => last.push(arrival),
        }
    }
    Ok(last)
}

fn arrival(segments: &Segments, row: usize, local: &Affine) -> Arrival {
    let segment = segments.get(row);
    Arrival {
        id: segment.id as usize,
        position: local.point(segment.end),
        direction: local.vector(segment.direction).normalize(),
        path: segment.path,
        index: segment.index,
        wavelength_nm: segment.wavelength_nm,
        power: segment.intensity,
    }
}

/// The arrival at the image of a ray that was traced sequentially through a prescription, from its intersection with the
/// `last` surface.
pub(crate) fn sequential_arrival(
    resolved: &Resolved,
    id: usize,
    last: &SurfaceIntersection,
    wavelength_nm: f64,
) -> Arrival {
    let space = resolved.media.len() - 1;
    let (point, direction) = match resolved.poses.get(space) {
        Some(pose) => pose.local(last.point, last.direction),
        None => (last.point, last.direction),
    };
    Arrival {
        id,
        position: point - Vec3::Z * resolved.vertices[space],
        direction,
        path: last.path,
        index: resolved.index(space, wavelength_nm).abs(),
        wavelength_nm,
        power: 1.0,
    }
}
