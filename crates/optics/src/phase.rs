//! Phases along rays: the phase of the optical path, and the phase jumps at reflection and
//! transmission (Fresnel equations, thin films).

use crate::element::{Action, Finish};
use crate::interface::{Film, transfer_matrix};
use crate::segments::{Event, Segment, Segments};
use crate::system::Substance;
use crate::trace::{Tracer, oriented_against};
use num_complex::Complex64;
use rayweave_model::{Collected, Crossing, Evaluator, Query, Window, attributes};
use rayweave_shape::Ray;

/// The phase of each segment of a table where its [path](Segment::path) ends, in degrees from 0 to
/// 360.
///
/// The phase grows along the ray with the optical path, by 360 degrees per wavelength, and jumps by
/// the argument of the amplitude of reflection or transmission: from the Fresnel equations, or from
/// a stack of thin films with all its multiple reflections ([`transfer_matrix`]), for light
/// polarised perpendicular to the plane of incidence (s) and in it (p). The amplitudes of
/// interfering beams add: `sum sqrt(intensity) exp(i phase)`.
///
/// - Waves go as `exp(i (k.r - w t))`. With `p = k x s` for every beam, p keeps its sign at
///   reflection by a denser medium at normal incidence, and s is reversed, by 180 degrees (Born &
///   Wolf, *Principles of Optics*, 7th edition, section 1.5.2).
/// - The sums of s and of p hold for light that stays s or p: with one common plane of incidence,
///   or at normal incidence. Where the plane turns from face to face, use the jump of each event
///   alone.
/// - Ideal mirrors and beam splitters reflect like perfect conductors: 180 degrees for s, 0 for p.
///   Polarisers, retarders, thin lenses and gratings add nothing to the phase of the path.
///   Scattered light (rough and diffuse faces) has no phase: NaN.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Phases {
    /// The phase of s light, polarised perpendicular to the plane of incidence.
    pub s: Vec<f64>,
    /// The phase of p light, polarised in the plane of incidence.
    pub p: Vec<f64>,
}

/// Phase jumps of s and p, in degrees.
type Jump = [f64; 2];

const NONE: Jump = [0.0; 2];
const UNKNOWN: Jump = [f64::NAN; 2];
const CONDUCTOR: Jump = [180.0, 0.0];

impl<E: Evaluator> Tracer<'_, E> {
    /// The phases of the segments of a trace of this system; each parent must come before its children, as
    /// in every [`Trace`](crate::Trace). Each event is recomputed, on a single thread.
    pub fn phases(&self, segments: &Segments) -> Phases {
        let mut jumps: Vec<Jump> = Vec::with_capacity(segments.len());
        for row in segments.iter() {
            let parent = usize::try_from(row.parent).ok().filter(|&parent| parent < jumps.len());
            let sum = parent.map_or(NONE, |parent| {
                let own = self.jump(&segments.get(parent), &row);
                [0, 1].map(|k| jumps[parent][k] + own[k])
            });
            jumps.push(sum);
        }
        let waves = |row: Segment| row.path * self.system.unit_nm / row.wavelength_nm;
        let whole = |k: usize| {
            let rows = segments.iter().zip(&jumps);
            rows.map(|(row, jump)| (360.0 * waves(row).fract() + jump[k]).rem_euclid(360.0)).collect()
        };
        Phases { s: whole(0), p: whole(1) }
    }

    /// The phase jump from the end of a segment to the start of one that follows it.
    fn jump(&self, before: &Segment, after: &Segment) -> Jump {
        match before.event {
            Event::Transmitted | Event::Reflected | Event::TotallyReflected | Event::Split => {}
            Event::Scattered => return UNKNOWN,
            _ => return NONE,
        }
        if let Some(sheet) = (before.surface as usize).checked_sub(self.system.first_sheet_surface()) {
            if matches!(self.system.sheets[sheet].action, Action::Grating { .. }) {
                return NONE;
            }
            let is_straight = before.direction.dot(after.direction) > 1.0 - 1e-12;
            return if is_straight { NONE } else { CONDUCTOR };
        }
        self.crossing(before).map_or(UNKNOWN, |(ray, crossing)| self.at_face(before, after, &ray, &crossing))
    }

    /// The crossing at the end of a segment, and its ray.
    fn crossing(&self, row: &Segment) -> Option<(Ray, Crossing)> {
        let length = (row.end - row.start).length();
        // the ray of a curve is the tangent at its end
        let ray = Ray::new(row.end - length * row.direction, row.direction);
        let query = Query { window: Window::new(0.5 * length, 2.0 * length).ok()?, ..Query::nearest() };
        let found: Collected = self.solids.one(ray, &query).ok()?;
        let crossing = *found.of(0).first()?;
        let surface = self.system.face_at(&crossing).surface;
        (surface == row.surface as usize).then_some((ray, crossing))
    }

    fn at_face(&self, before: &Segment, after: &Segment, ray: &Ray, crossing: &Crossing) -> Jump {
        let normal = oriented_against(attributes::normal(&self.system.program, ray, crossing), ray.direction);
        let is_reflected = after.direction.dot(normal) > 0.0;
        let face = self.system.face_at(crossing);
        let films: Vec<Film> = match face.finish {
            Finish::Polished => Vec::new(),
            // films are listed from outside
            Finish::Coated(films) if face.from_inside => films.iter().rev().copied().collect(),
            Finish::Coated(films) => films.clone(),
            Finish::Rough { .. } | Finish::Diffuse { .. } => return UNKNOWN,
            _ => return if is_reflected { CONDUCTOR } else { NONE },
        };
        let index = |substance: &Substance| substance.index_at(before.wavelength_nm, before.end);
        let [front, behind] =
            [crossing.before, crossing.after].map(|region| index(self.system.substance(region)));
        let cosine = ray.direction.dot(normal).abs().min(1.0);
        let found = transfer_matrix(front.re, &films, behind, cosine, before.wavelength_nm);
        (if is_reflected { found.reflected } else { found.transmitted }).map(degrees)
    }
}

fn degrees(amplitude: Complex64) -> f64 {
    libm::atan2(amplitude.im, amplitude.re).to_degrees()
}
