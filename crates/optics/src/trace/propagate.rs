//! Propagation of single rays to the next face or sheet, and the event there.

use super::generation::{Generation, RayState, SheetStart};
use super::hits::{Hits, SheetHit};
use super::index_cache::{IndexCache, OpticalConstants};
use super::rows::Rows;
use super::splitmix::splitmix64;
use crate::interface::refract;
use crate::scatter::{Incident, Outcome, Scattered};
use crate::segments::{Balance, Event, Segment};
use crate::settings::{Keep, TraceSettings};
use crate::start_surfaces::{ExitSide, newton_step, project, starts_inside};
use crate::system::{CompiledSheet, System};
use rayweave_math::Vec3;
use rayweave_model::{Crossing, Face, Program, RegionId, Start, attributes};
use rayweave_shape::Ray;
use rayweave_shape::lanes::LANES;
use rayweave_shape::surface::delta;

/// Applies events to rays whose hits have been computed: appends rows to the table, adds power to
/// the balance, and collects the rays of the next generation.
///
/// It is independent of the evaluator.
pub(crate) struct Propagator<'t> {
    pub system: &'t System,
    pub settings: &'t TraceSettings,
    pub indices: IndexCache,
    pub rows: Rows,
    pub balance: Balance,
    /// The rays of the next generation.
    pub next: Generation,
}

impl<'t> Propagator<'t> {
    pub fn new(system: &'t System, settings: &'t TraceSettings) -> Self {
        Propagator {
            system,
            settings,
            indices: IndexCache::default(),
            rows: Rows::default(),
            balance: Balance::default(),
            next: Generation::default(),
        }
    }

    /// Applies one event to every ray, and several to rays that pass sheets.
    pub(super) fn propagate_generation(&mut self, now: &Generation, hits: &Hits) {
        self.rows.rounds.push(self.rows.single.len());
        let is_simple = self.settings.is_simple();
        let mut sheets = &hits.sheets[..];
        let mut i = 0;
        while i < now.len() {
            let is_clear = sheets.first().is_none_or(|hit| hit.ray >= i + LANES);
            if is_simple && is_clear && self.transmit_bundle(now, hits, i).is_some() {
                i += LANES;
                continue;
            }
            let count = sheets.iter().take_while(|hit| hit.ray == i).count();
            let (here, rest) = sheets.split_at(count);
            sheets = rest;
            if !(here.is_empty() && is_simple && self.transmit(now, hits, i)) {
                match self.is_graded(hits, i) {
                    true => self.propagate_graded(now, hits, i),
                    false => self.propagate(now, hits, i, here),
                }
            }
            i += 1;
        }
    }

    /// Refracts a ray at a polished face between uniform media, the most frequent event. Returns
    /// false and changes nothing for any other event.
    fn transmit(&mut self, now: &Generation, hits: &Hits, i: usize) -> bool {
        let system = self.system;
        let (before, after) = (RegionId(hits.solids.before[i]), RegionId(hits.solids.after[i]));
        let Ok(number) = usize::try_from(hits.solids.face[i]) else { return false };
        let (Ok(left), Ok(entered)) = (system.polished(before, number), system.polished(after, number))
        else {
            return false;
        };
        let is_uniform = |region| system.substance(region).is_uniform();
        if hits.solids.placement[i] != 0
            || !is_uniform(before)
            || !is_uniform(after)
            || hits.between(i).is_some()
        {
            return false;
        }
        let mut payload = now.payload(i);
        let here = self.indices.get(system, system.program.medium_of(before), payload.wavelength_nm);
        let behind = self.indices.get(system, system.program.medium_of(after), payload.wavelength_nm);
        if here.index.re == behind.index.re || payload.power <= 0.0 {
            return false;
        }
        let (ray, t) = (now.rays.rays().get(i), hits.solids.t[i]);
        let normal = oriented_against(hits.solids.normal(i), ray.direction);
        let Some(direction) = refract(ray.direction, normal, here.index.re / behind.index.re) else {
            return false;
        };
        payload.path += here.index.re * t;
        let intensity = payload.power;
        payload.power -= self.absorb_in_medium(here, intensity, t);
        let is_terminated = self.is_terminated(payload.generation + 1, payload.power);
        if is_terminated || self.settings.keep == Keep::All {
            let segment = RayState { ray, payload, stokes: None }.segment((0.0, t), intensity, here.index.re);
            let element = entered.or(left).unwrap_or(0);
            payload.parent = self.record(segment, element, number, Event::Transmitted);
        }
        payload.generation += 1;
        if !is_terminated {
            let face = system.faces[number];
            let (point, side) = departure(&system.program, &ray, t, face, normal);
            let starts = &mut self.next.starts;
            let first = starts.len();
            starts.push(Start { surface: face.surface, placement: face.placement, inside: side });
            system.start_surfaces.append_others(
                &system.program,
                (&ray, t),
                first,
                ExitSide::Transmitted,
                starts,
            );
            self.next.push(Ray::new(point, direction), payload, None);
        }
        true
    }

    /// Propagates a ray to its next event, straight through the sheets that transmit it unchanged.
    fn propagate(&mut self, now: &Generation, hits: &Hits, i: usize, sheets: &[SheetHit]) {
        let (mut light, known) = (now.get(i), now.starts_of(i));
        let region = RegionId(hits.solids.before[i]);
        let solid = hits.crossing(self.system, i);
        let end = solid.map_or(f64::INFINITY, |crossing| crossing.t);
        // a sheet within the tolerance of a face is crossed before the face
        let slack = if end.is_finite() { delta(0.0, &light.ray, end) } else { 0.0 };
        let mut from = 0.0;
        for SheetHit { sheet, crossing, .. } in sheets.iter().filter(|hit| hit.crossing.t <= end + slack) {
            let t = crossing.t.min(end);
            let row = self.travel(&mut light, region, (from, t));
            if !self.hit_sheet(&mut light, row, *sheet, (crossing, t), known) {
                return;
            }
            self.drop_row_before_next();
            from = t;
        }
        match solid {
            None => self.escape(&light, region, from),
            Some(crossing) => {
                let normal = oriented_against(hits.solids.normal(i), light.ray.direction);
                let row = self.travel(&mut light, region, (from, crossing.t));
                self.hit_face(&light, row, (&crossing, normal), known);
            }
        }
    }

    /// Applies a sheet to a ray that has travelled to it, at time `t`; false unless the ray
    /// continues straight. `known` is the start list of the ray, as for [`StartSurfaces::append`](
    /// crate::start_surfaces::StartSurfaces::append).
    pub(crate) fn hit_sheet(
        &mut self,
        light: &mut RayState,
        row: Segment,
        sheet: usize,
        (crossing, t): (&Crossing, f64),
        known: &[Start],
    ) -> bool {
        let compiled = &self.system.sheets[sheet];
        let normal = match compiled.action.needs_normal() {
            true => oriented_against(
                attributes::normal(&compiled.program, &light.ray, crossing),
                light.ray.direction,
            ),
            false => Vec3::NAN,
        };
        let incident = incident(light, normal, row.index);
        let frames = (&compiled.frame, &compiled.local_from_world);
        let (point, unit_nm) = (light.ray.at(t), self.system.unit_nm);
        let outcome = incident.scatter_at_sheet(&compiled.action, frames, point, unit_nm, self.settings);
        let surface = self.system.first_sheet_surface() + sheet;
        let row = self.record(row, compiled.element, surface, outcome.event);
        let straight = outcome.event == Event::Passed;
        if let (true, [Some(passed), None]) = (straight, outcome.rays) {
            self.absorb(compiled.element, light.payload.power - passed.power);
            (light.payload.power, light.stokes) = (passed.power, passed.stokes);
            light.payload.parent = row;
            light.payload.generation += 1;
            return !self.is_terminated(light.payload.generation, light.payload.power);
        }
        self.spawn(light, row, compiled.element, &outcome, |propagator, scattered| {
            propagator.ray_from_sheet(&light.ray, (sheet, compiled), (crossing, t), scattered, known)
        });
        false
    }

    /// Applies a face of a solid to a ray that has travelled to it; for `known` see [`Propagator::hit_sheet`].
    pub(crate) fn hit_face(
        &mut self,
        light: &RayState,
        row: Segment,
        (crossing, normal): (&Crossing, Vec3),
        known: &[Start],
    ) {
        let system = self.system;
        let incident = incident(light, normal, row.index);
        let face = system.face_at(crossing);
        let behind = system.substance(crossing.after);
        let index = behind.index_at(incident.wavelength_nm, light.ray.at(crossing.t));
        let outcome = incident.scatter_at_face((behind, index), &face, self.settings);
        let row = self.record(row, face.element, face.surface, outcome.event);
        self.spawn(light, row, face.element, &outcome, |propagator, scattered| {
            let point = project(&system.program, &light.ray, crossing, normal);
            let (program, near) = (&system.program, (&light.ray, crossing.t));
            let starts = &mut propagator.next.starts;
            system.start_surfaces.append(program, near, Some(crossing), scattered.side, known, starts);
            (Ray::new(point, scattered.direction), None)
        });
    }

    /// The ray that leaves a sheet in a new direction, and its start on the sheet.
    fn ray_from_sheet(
        &mut self,
        ray: &Ray,
        (sheet, compiled): (usize, &CompiledSheet),
        (crossing, t): (&Crossing, f64),
        scattered: &Scattered,
        known: &[Start],
    ) -> (Ray, Option<(usize, Start)>) {
        let system = self.system;
        // faces of solids within the tolerance are crossed later
        let starts = &mut self.next.starts;
        system.start_surfaces.append(&system.program, (ray, t), None, ExitSide::Incident, known, starts);
        let mut on = Vec::new();
        let (program, at) = (&compiled.program, (ray, crossing.t));
        compiled.start_surfaces.append(program, at, Some(crossing), scattered.side, &[], &mut on);
        (Ray::new(ray.at(t), scattered.direction), on.first().map(|start| (sheet, *start)))
    }

    /// Moves a ray to the end of a segment and returns the row, without element, surface and event.
    fn travel(&mut self, light: &mut RayState, region: RegionId, (from, to): (f64, f64)) -> Segment {
        let medium = self.optical_constants(region, light.payload.wavelength_nm);
        let length = to - from;
        let intensity = light.payload.power;
        light.payload.path += medium.index.re * length;
        self.attenuate(light, medium, length);
        light.segment((from, to), intensity, medium.index.re)
    }

    /// Subtracts the power that a length of a medium absorbs.
    pub(crate) fn attenuate(&mut self, light: &mut RayState, medium: OpticalConstants, length: f64) {
        light.payload.power -= self.absorb_in_medium(medium, light.payload.power, length);
        light.stokes = light.stokes.map(|stokes| stokes.with_power(light.payload.power));
    }

    /// Adds the power that a length of a medium absorbs to the balance, and returns it.
    fn absorb_in_medium(&mut self, medium: OpticalConstants, power: f64, length: f64) -> f64 {
        let absorbed = medium.absorbed_power(power, length);
        self.balance.absorbed_in_media += absorbed;
        absorbed
    }

    pub(crate) fn optical_constants(&mut self, region: RegionId, wavelength_nm: f64) -> OpticalConstants {
        let system = self.system;
        self.indices.get(system, system.program.medium_of(region), wavelength_nm)
    }

    /// Appends a row and returns the parent of the rows that follow.
    fn record(&mut self, mut row: Segment, element: usize, surface: usize, event: Event) -> i64 {
        (row.element, row.surface, row.event) = (element as i32, surface as i32, event);
        self.rows.single.push(row);
        self.next_parent()
    }

    /// The parent of the rows that follow the last one: its number, or -1 where only ends are kept.
    pub(crate) fn next_parent(&self) -> i64 {
        match self.settings.keep {
            Keep::All => self.rows.single.len() as i64 - 1,
            Keep::Ends => -1,
        }
    }

    /// Removes the last row if only ends are kept, because the ray continues.
    pub(crate) fn drop_row_before_next(&mut self) {
        if self.settings.keep == Keep::Ends {
            self.rows.single.pop();
        }
    }

    fn absorb(&mut self, element: usize, power: f64) {
        self.balance.absorbed[element] += power;
    }

    pub(crate) fn escape(&mut self, light: &RayState, region: RegionId, from: f64) {
        let OpticalConstants { index, absorption } =
            self.optical_constants(region, light.payload.wavelength_nm);
        match absorption > 0.0 {
            true => self.balance.absorbed_in_media += light.payload.power,
            false => self.balance.escaped += light.payload.power,
        }
        if self.settings.keep_escaped {
            self.rows.single.push(light.segment((from, f64::NAN), light.payload.power, index.re));
        }
    }

    /// True if a ray is not traced any further; its power is then added to the dropped power.
    fn is_terminated(&mut self, generation: u32, power: f64) -> bool {
        let is_terminated =
            generation >= self.settings.generation_limit || power < self.settings.threshold || power == 0.0;
        if is_terminated {
            self.balance.dropped += power;
        }
        is_terminated
    }

    /// Appends the rays that leave an event to the next generation; the element absorbs the rest of
    /// the power.
    fn spawn(
        &mut self,
        light: &RayState,
        row: i64,
        element: usize,
        outcome: &Outcome,
        mut start: impl FnMut(&mut Self, &Scattered) -> (Ray, Option<(usize, Start)>),
    ) {
        let (mut left, spawned) = (light.payload.power, self.next.len());
        for (branch, scattered) in outcome.rays.iter().enumerate() {
            let Some(scattered) = scattered else { continue };
            left -= scattered.power;
            let mut payload = light.payload;
            (payload.power, payload.parent) = (scattered.power, row);
            payload.path += scattered.delay;
            payload.generation += 1;
            if branch == 1 {
                payload.stream = splitmix64(payload.stream.wrapping_add(u64::from(light.payload.generation)));
            }
            if self.is_terminated(payload.generation, payload.power) {
                continue;
            }
            let (ray, on_sheet) = start(self, scattered);
            let on = on_sheet.map(|(sheet, start)| SheetStart { ray: self.next.len(), sheet, start });
            self.next.sheet_starts.extend(on);
            self.next.push(ray, payload, scattered.stokes);
        }
        self.absorb(element, left);
        if self.next.len() > spawned {
            self.drop_row_before_next();
        }
    }
}

/// The start of a ray behind a face of an unplaced solid: the hit, projected onto the face like
/// [`project`], and whether the ray is where f < 0 behind the face.
fn departure(program: &Program, ray: &Ray, t: f64, face: Face, normal: Vec3) -> (Vec3, bool) {
    let point = ray.at(t);
    let (value, gradient) = program.surface(face.surface).surface.value_and_gradient(point);
    let point = newton_step(point, normal, value / gradient.dot(normal));
    (point, starts_inside(gradient.dot(ray.direction), 0.0, ExitSide::Transmitted))
}

/// The light of a ray that is incident on an interface.
fn incident(light: &RayState, normal: Vec3, index: f64) -> Incident {
    Incident {
        direction: light.ray.direction,
        normal,
        wavelength_nm: light.payload.wavelength_nm,
        power: light.payload.power,
        stokes: light.stokes,
        index,
        // a hash, not a sum: ray 3 in generation 5 must not draw the same numbers as ray 5 in
        // generation 3
        stream: splitmix64(light.payload.stream ^ u64::from(light.payload.generation)),
    }
}

/// A normal turned against a direction.
pub(crate) fn oriented_against(normal: Vec3, direction: Vec3) -> Vec3 {
    if normal.dot(direction) > 0.0 { -normal } else { normal }
}
