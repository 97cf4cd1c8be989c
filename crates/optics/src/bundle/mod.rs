//! Light in ray bundles: eight rays in SIMD lanes, with verified hit prediction and a fallback to
//! the evaluator.
//!
//! A ray bundle holds eight rays, one in each SIMD lane, that all undergo the same events. Rays
//! that start on the same side of the same surface nearly always hit the same surface next, so the
//! surface that earlier rays hit is the *predicted hit* of a bundle. [`predict`] verifies it for
//! these eight rays without an intersection test against the rest of the system; a verified hit
//! equals the one that the evaluator would return, bit for bit. The bundle is then refracted in
//! lanes ([`incident`]) and traced to its next event.
//!
//! [`trace`] is the entry point. Bundles whose prediction cannot be verified, and the remainder of
//! the last bundle, fall back to the evaluator: they become [`Pending`] rays of the generation that
//! they have reached. A wrong prediction costs time, but never changes a result.
//!
//! After the evaluator has computed the hits of a generation, eight neighbouring rays that cross
//! the same face are refracted in lanes as well: [`Propagator::transmit_bundle`].
//!
//! All operations and their order are those of the scalar loop, so that every ray has bit for bit
//! the same result as if it were traced alone.

mod attenuation;
mod bounds;
mod incident;
mod predict;
mod transmit;

pub(crate) use bounds::LaneBounds;
pub(crate) use incident::{Refractor, TransmittedRays};
pub(crate) use predict::{FaceCrossing, PredictedHit, Predictor};

use crate::beam::Beam;
use crate::segments::{BundleRows, Event};
use crate::settings::Keep;
use crate::system::System;
use crate::trace::{Generation, OpticalConstants, Pending, Propagator};
use attenuation::Attenuation;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use incident::{IncidentBundle, load, load_one, stored};
use predict::{BundleRays, PredictionTable};
use rayweave_model::{Face, RegionId};
use rayweave_shape::dispatch_wide;
use rayweave_shape::lanes::{LANES, Lanes, Vec3Lanes, splat};

/// The evaluator: returns the hit of the first rays of a generation, if it is the same for all rays of a bundle.
pub(crate) type Evaluate<'a> = &'a mut dyn FnMut(&Generation) -> Option<PredictedHit>;

/// Traces the rays of a beam in bundles of eight, with verified hit prediction.
///
/// `first` is the number of the first ray of the beam. Rays whose prediction cannot be verified,
/// and the remainder of the last bundle, fall back to the evaluator: they are appended to
/// `pending`. If the system or the settings do not support prediction, all rays fall back.
pub(crate) fn trace(
    light: &mut Propagator<'_>,
    (beam, first): (&Beam, u64),
    pending: &mut Pending,
    evaluate: Evaluate<'_>,
) {
    let (system, settings) = (light.system, light.settings);
    let mut traced = 0;
    if let (Some(predictor), true) = (&system.predictor, settings.is_simple()) {
        let predictions = PredictionTable::default();
        let mut tracer = BundleTracer { light, predictor, beam, first, predictions, pending };
        tracer.trace(evaluate);
        traced = beam.len() / LANES * LANES;
    }
    pending.at(0).append_beam(beam, traced..beam.len(), first, settings.polarised);
}

/// Eight rays in flight, one per SIMD lane.
struct Bundle<S: Simd> {
    /// The number of the first ray in the beam.
    at: usize,
    rays: BundleRays<S>,
    path: Lanes<S>,
    power: [f64; LANES],
    /// The number of events so far, and the face of the last one.
    events: u32,
    face: Option<Face>,
    /// The row of the first ray for the last event; -1 for none.
    parent: i64,
    /// The wavelength, if all rays have the same.
    wavelength_nm: Option<f64>,
}

impl<S: Simd> Bundle<S> {
    /// Appends the rays to a generation; the first ray of the beam has the number `first`.
    fn append_to(&self, rays: &mut Generation, (beam, first): (&Beam, u64)) {
        let transmitted = TransmittedRays {
            origin: stored(self.rays.origin),
            direction: stored(self.rays.direction),
            path: self.path.to_array(),
            inside: self.rays.start.map_or(0, |(_, inside)| if inside { 0xff } else { 0 }),
            ..TransmittedRays::default()
        };
        let parent = (self.parent >= 0).then_some(self.parent);
        let after = (self.events, self.face);
        rays.append_bundle((beam, first), self.at, (&self.power, &transmitted), after, parent);
    }
}

/// The segments of a bundle up to an event.
struct BundleSegments<S: Simd> {
    end: Vec3Lanes<S>,
    path: Lanes<S>,
    index: Lanes<S>,
    /// The numbers of the element and of its surface.
    hit: (usize, usize),
    event: Event,
}

/// The outcome of a verified event.
enum Advance {
    Transmitted,
    Absorbed,
}

/// The outcome of tracing a bundle.
enum Traced {
    /// All rays are absorbed.
    ToTheEnd,
    /// The next hit could not be predicted or verified.
    Fallback,
}

/// Traces the bundles of a beam, one after the other. Not generic over the evaluator, so that its
/// kernels are compiled once.
struct BundleTracer<'a, 't> {
    light: &'a mut Propagator<'t>,
    predictor: &'t Predictor,
    beam: &'a Beam,
    /// The number of the first ray of the beam.
    first: u64,
    predictions: PredictionTable,
    pending: &'a mut Pending,
}

impl BundleTracer<'_, '_> {
    fn trace(&mut self, evaluate: Evaluate<'_>) {
        dispatch_wide!(self.predictor.level, simd => self.trace_in_lanes(simd, evaluate));
    }

    #[inline(always)]
    fn trace_in_lanes<S: Simd>(&mut self, simd: S, evaluate: Evaluate<'_>) {
        for at in (0..self.beam.len() / LANES * LANES).step_by(LANES) {
            let Some(mut bundle) = self.bundle(simd, at) else { continue };
            if let Traced::Fallback = self.trace_bundle(simd, &mut bundle, evaluate) {
                let pending = self.pending.at(bundle.events as usize);
                bundle.append_to(pending, (self.beam, self.first));
            }
        }
    }

    /// Rays `at..at + 8` of the beam, with directions of unit length.
    #[inline(always)]
    fn bundle<S: Simd>(&self, simd: S, at: usize) -> Option<Bundle<S>> {
        let (rays, wavelengths) = (self.beam.rays(), self.beam.wavelengths_nm());
        let (origin, direction) = (load(simd, rays.origins, at)?, load(simd, rays.directions, at)?);
        let direction = direction.times(splat(simd, 1.0) / direction.length_squared().sqrt());
        let (path, common) = (splat(simd, 0.0), *wavelengths.get(at)?);
        let is_common = load_one(simd, wavelengths, at)?.simd_eq(common).all_true();
        let sides = self.predictor.sides(simd, origin, origin.taxicab());
        let rays = BundleRays { origin, direction, start: None, sides };
        let (wavelength_nm, power) = (is_common.then_some(common), *self.beam.powers()[at..].first_chunk()?);
        Some(Bundle { at, rays, path, power, events: 0, face: None, parent: -1, wavelength_nm })
    }

    /// Traces a bundle until it is absorbed, or until its next hit cannot be verified.
    #[inline(always)]
    fn trace_bundle<S: Simd>(&mut self, simd: S, bundle: &mut Bundle<S>, evaluate: Evaluate<'_>) -> Traced {
        let power = Lanes::load_array_ref(simd, &bundle.power);
        if !(power.simd_ge(self.light.settings.threshold) & power.simd_gt(0.0)).all_true() {
            return Traced::Fallback;
        }
        loop {
            let predicted = self.predictions.entry(bundle.rays.start).hit;
            let advance = match predicted {
                Some(PredictedHit::Face { surface }) => self.transmit(simd, bundle, surface),
                Some(PredictedHit::Sheet { sheet, surface }) => self.absorb(simd, bundle, (sheet, surface)),
                None => None,
            };
            match advance {
                Some(Advance::Absorbed) => return Traced::ToTheEnd,
                Some(Advance::Transmitted) => {}
                None if self.update_prediction(bundle, predicted, evaluate) => {}
                None => return Traced::Fallback,
            }
        }
    }

    /// Refracts a bundle at a polished face between uniform media, if that is verified to be its next hit.
    #[inline(always)]
    fn transmit<S: Simd>(&mut self, simd: S, bundle: &mut Bundle<S>, surface: usize) -> Option<Advance> {
        let (system, settings) = (self.light.system, self.light.settings);
        let hit = self.predictor.verify(simd, &bundle.rays, surface)?;
        let (element, number) = polished_face(system, &hit.crossing)?;
        let (before, absorbing) = self.index(simd, bundle, hit.crossing.before)?;
        let (behind, _) = self.index(simd, bundle, hit.crossing.after)?;
        let is_last = bundle.events + 1 >= settings.generation_limit;
        if is_last || before.simd_eq(behind).any_true() {
            return None;
        }
        if may_hit_sheets(simd, system, &bundle.rays, hit.t, usize::MAX) {
            return None;
        }
        let face = system.faces[hit.crossing.face];
        let incident = IncidentBundle {
            origin: bundle.rays.origin,
            direction: bundle.rays.direction,
            t: hit.t,
            end: hit.point,
            normal: hit.normal,
            slope: hit.slope,
            path: bundle.path,
            surface: face.surface,
            is_alone: hit.is_alone,
        };
        let transmitted = system.refractor.as_ref()?.refract_lanes(simd, &incident, [before, behind])?;
        let inside = match transmitted.inside {
            0 => false,
            0xff => true,
            _ => return None,
        };
        let attenuation = absorbing.map(|media| Attenuation::new(&media, &bundle.power, &hit.t.to_array()));
        if attenuation.as_ref().is_some_and(|after| !after.exceeds(settings.threshold)) {
            return None;
        }
        if settings.keep == Keep::All {
            let (end, path, hit) = (hit.point, transmitted.path, (element, number));
            let segments = BundleSegments { end, path, index: before, hit, event: Event::Transmitted };
            self.record(bundle, &segments);
        }
        let (origin, direction) = (transmitted.origin, transmitted.direction);
        bundle.rays = BundleRays { origin, direction, start: Some((surface, inside)), sides: hit.sides };
        (bundle.path, bundle.face) = (transmitted.path, Some(face));
        self.attenuate(bundle, attenuation);
        bundle.events += 1;
        Some(Advance::Transmitted)
    }

    /// Absorbs a bundle at an absorbing sheet, if that is verified to be its next hit.
    #[inline(always)]
    fn absorb<S: Simd>(
        &mut self,
        simd: S,
        bundle: &mut Bundle<S>,
        (sheet, surface): (usize, usize),
    ) -> Option<Advance> {
        let system = self.light.system;
        let compiled = &system.sheets[sheet];
        let (t, [before, after]) = compiled.predictor.as_ref()?.verify_first(simd, &bundle.rays, surface)?;
        let region = self.predictor.region_up_to(simd, &bundle.rays, t)?;
        let (index, absorbing) = self.index(simd, bundle, region)?;
        let is_through = before != RegionId(0) && after != RegionId(0);
        if !is_through || may_hit_sheets(simd, system, &bundle.rays, t, sheet) {
            return None;
        }
        let end = bundle.rays.origin.plus(bundle.rays.direction.times(t));
        let path = bundle.path + index * t;
        let hit = (compiled.element, system.first_sheet_surface() + sheet);
        self.record(bundle, &BundleSegments { end, path, index, hit, event: Event::Absorbed });
        self.attenuate(bundle, absorbing.map(|media| Attenuation::new(&media, &bundle.power, &t.to_array())));
        for power in bundle.power {
            self.light.balance.absorbed[compiled.element] += power;
        }
        Some(Advance::Absorbed)
    }

    /// Subtracts the power that an absorbing medium has absorbed.
    #[inline(always)]
    fn attenuate<S: Simd>(&mut self, bundle: &mut Bundle<S>, attenuation: Option<Attenuation>) {
        if let Some(Attenuation { absorbed, power }) = attenuation {
            self.light.balance.absorbed_in_media += absorbed;
            bundle.power = power;
        }
    }

    /// The refractive index of a region for each ray, and the optical constants if the medium
    /// absorbs; `None` in a medium with a gradient index.
    #[inline(always)]
    fn index<S: Simd>(
        &mut self,
        simd: S,
        bundle: &Bundle<S>,
        region: RegionId,
    ) -> Option<(Lanes<S>, Option<[OpticalConstants; LANES]>)> {
        let system = self.light.system;
        if !system.substance(region).is_uniform() {
            return None;
        }
        let medium = system.program.medium_of(region);
        if let Some(wavelength_nm) = bundle.wavelength_nm {
            let constants = self.light.indices.get(system, medium, wavelength_nm);
            let absorbs = constants.absorption != 0.0;
            return Some((splat(simd, constants.index.re), absorbs.then_some([constants; LANES])));
        }
        let (mut found, mut absorbs) = ([OpticalConstants::default(); LANES], false);
        let wavelengths = self.beam.wavelengths_nm().get(bundle.at..)?;
        for (found, &wavelength_nm) in found.iter_mut().zip(wavelengths) {
            *found = self.light.indices.get(system, medium, wavelength_nm);
            absorbs |= found.absorption != 0.0;
        }
        let index = found.map(|constants| constants.index.re);
        Some((Lanes::load_array_ref(simd, &index), absorbs.then_some(found)))
    }

    /// Appends a row for each ray of a bundle.
    #[inline(always)]
    fn record<S: Simd>(&mut self, bundle: &mut Bundle<S>, segments: &BundleSegments<S>) {
        let (at, beam, events, parent) = (bundle.at, self.beam, bundle.events, bundle.parent);
        let (Some(source), Some(wavelength_nm)) =
            (beam.sources()[at..].first_chunk(), beam.wavelengths_nm()[at..].first_chunk())
        else {
            return;
        };
        let rows = &mut self.light.rows;
        if self.light.settings.keep == Keep::All {
            bundle.parent = rows.bundle_parent(events);
        }
        rows.bundles_at(events).extend_bundle(&BundleRows {
            id: std::array::from_fn(|lane| (self.first + (at + lane) as u64) as i64),
            parent: std::array::from_fn(|lane| if parent < 0 { -1 } else { parent + lane as i64 }),
            generation: [events; LANES],
            source,
            wavelength_nm,
            intensity: &bundle.power,
            index: segments.index.to_array(),
            start: stored(bundle.rays.origin),
            end: stored(segments.end),
            direction: stored(bundle.rays.direction),
            path: segments.path.to_array(),
            element: segments.hit.0,
            surface: segments.hit.1,
            event: segments.event,
        });
    }

    /// Replaces the prediction for the start of a bundle by the hit that the evaluator returns;
    /// false if there is no new prediction.
    fn update_prediction<S: Simd>(
        &mut self,
        bundle: &Bundle<S>,
        known: Option<PredictedHit>,
        evaluate: Evaluate<'_>,
    ) -> bool {
        let entry = self.predictions.entry(bundle.rays.start);
        if !entry.may_evaluate() {
            return false;
        }
        let mut rays = Generation::default();
        bundle.append_to(&mut rays, (self.beam, self.first));
        let found = evaluate(&rays);
        entry.hit = found.or(known);
        found.is_some() && found != known
    }
}

/// The numbers of the element and of its face at a crossing whose two sides are polished: those of
/// the element that is entered, or of the one that is left if the ray enters the world.
fn polished_face(system: &System, crossing: &FaceCrossing) -> Option<(usize, usize)> {
    let left = system.polished(crossing.before, crossing.left).ok()?;
    match system.polished(crossing.after, crossing.entered).ok()? {
        Some(element) => Some((element, crossing.entered)),
        None => Some((left.unwrap_or(0), crossing.left)),
    }
}

/// True if a ray of a bundle may hit a sheet other than `except` before the times `t`.
/// Conservative: false is definite, true is not.
#[inline(always)]
fn may_hit_sheets<S: Simd>(
    simd: S,
    system: &System,
    rays: &BundleRays<S>,
    t: Lanes<S>,
    except: usize,
) -> bool {
    // not an iterator: its closures are compiled without the SIMD target features
    for (k, sheet) in system.sheets.iter().enumerate() {
        if k != except && sheet.lane_bounds.may_hit_lanes(simd, rays.origin, rays.direction, t) != 0 {
            return true;
        }
    }
    false
}
