//! What happens to one ray at its next event: at a face, at a sheet, or in no end of a medium.

use super::Worker;
use crate::generation::{Generation, Met, OnSheet, SheetMet, Traveller};
use crate::indices::Optics;
use crate::interact::{Arriving, Going, Outcome};
use crate::interface::refract;
use crate::near::{Leaves, foot, is_inside, stepped};
use crate::segments::{Event, Segment};
use crate::settings::Keep;
use crate::system::Plate;
use rayweave_math::Vec3;
use rayweave_model::{Crossing, Evaluator, Face, Program, RegionId, Start, dress};
use rayweave_shape::Ray;
use rayweave_shape::surface::delta;

impl<E: Evaluator> Worker<'_, E> {
    /// What happens to nearly all light: it goes on through a polished face into another uniform medium. False, with nothing
    /// done, if that is not what happens.
    pub(super) fn transmit(&mut self, now: &Generation, met: &Met, i: usize) -> bool {
        let system = self.tracer.system;
        let (before, after) = (RegionId(met.before[i]), RegionId(met.after[i]));
        let Ok(number) = usize::try_from(met.face[i]) else { return false };
        let (Ok(left), Ok(entered)) = (system.polished(before, number), system.polished(after, number))
        else {
            return false;
        };
        let is_uniform = |region| system.substance(region).is_uniform();
        if met.placement[i] != 0 || !is_uniform(before) || !is_uniform(after) || met.between(i).is_some() {
            return false;
        }
        let mut packet = now.packet(i);
        let here = self.indices.of(system, system.program.medium_of(before), packet.wavelength_nm);
        let behind = self.indices.of(system, system.program.medium_of(after), packet.wavelength_nm);
        if here.index.re == behind.index.re || packet.power <= 0.0 {
            return false;
        }
        let (ray, t) = (now.rays.rays().get(i), met.t[i]);
        let normal = against(met.normal(i), ray.direction);
        let Some(direction) = refract(ray.direction, normal, here.index.re / behind.index.re) else {
            return false;
        };
        packet.path += here.index.re * t;
        let intensity = packet.power;
        packet.power -= self.lose(here, intensity, t);
        let is_over = self.is_over(packet.generation + 1, packet.power);
        if is_over || self.settings.keep == Keep::All {
            let segment = Traveller { ray, packet, stokes: None }.segment((0.0, t), intensity, here.index.re);
            let element = entered.or(left).unwrap_or(0);
            packet.parent = self.record(segment, element, number, Event::Transmitted);
        }
        packet.generation += 1;
        if !is_over {
            let face = system.faces[number];
            let (point, side) = departure(&system.program, &ray, t, face, normal);
            let starts = &mut self.next.starts;
            let first = starts.len();
            starts.push(Start { surface: face.surface, placement: face.placement, inside: side });
            system.near.others(&system.program, (&ray, t), first, Leaves::Beyond, starts);
            self.next.push(Ray::new(point, direction), packet, None);
        }
        true
    }

    /// Takes a ray to its next event that is no straight passage through a sheet.
    pub(super) fn advance(&mut self, mut light: Traveller, met: &Met, i: usize, sheets: &[SheetMet]) {
        let region = RegionId(met.before[i]);
        let solid = met.crossing(self.tracer.system, i);
        let end = solid.map_or(f64::INFINITY, |crossing| crossing.t);
        // what lies in a face of a solid comes first
        let slack = if end.is_finite() { delta(0.0, &light.ray, end) } else { 0.0 };
        let mut from = 0.0;
        for SheetMet { sheet, crossing, .. } in sheets.iter().filter(|met| met.crossing.t <= end + slack) {
            let t = crossing.t.min(end);
            let row = self.arrive(&mut light, region, (from, t));
            if !self.meet_sheet(&mut light, row, *sheet, crossing, t) {
                return;
            }
            self.forget_way();
            from = t;
        }
        match solid {
            None => self.escape(&light, region, from),
            Some(crossing) => {
                let normal = against(met.normal(i), light.ray.direction);
                let row = self.arrive(&mut light, region, (from, crossing.t));
                self.meet_face(&light, row, &crossing, normal);
            }
        }
    }

    /// A sheet, at the time `t` of a ray that has been brought there; false if the light does not go straight on.
    pub(crate) fn meet_sheet(
        &mut self,
        light: &mut Traveller,
        row: Segment,
        sheet: usize,
        crossing: &Crossing,
        t: f64,
    ) -> bool {
        let plate = &self.tracer.system.plates[sheet];
        let normal = match plate.action.has_sides() {
            true => against(dress::normal(&plate.program, &light.ray, crossing), light.ray.direction),
            false => Vec3::NAN,
        };
        let arriving = arriving(light, normal, row.index);
        let (frame, local) = &self.tracer.frames[sheet];
        let (point, unit_nm) = (light.ray.at(t), self.tracer.system.unit_nm);
        let outcome = arriving.at_sheet(&plate.action, (frame, local), point, unit_nm, self.settings);
        let surface = self.tracer.system.sheets_from() + sheet;
        let row = self.record(row, plate.element, surface, outcome.event);
        let straight = outcome.event == Event::Passed;
        if let (true, [Some(going), None]) = (straight, outcome.going) {
            self.charge(plate.element, light.packet.power - going.power);
            (light.packet.power, light.stokes) = (going.power, going.stokes);
            light.packet.parent = row;
            light.packet.generation += 1;
            return !self.is_over(light.packet.generation, light.packet.power);
        }
        self.go_on(light, row, plate.element, &outcome, |worker, going| {
            worker.leave_sheet(&light.ray, (sheet, plate), (crossing, t), going)
        });
        false
    }

    /// A face of a solid, to which a ray has been brought.
    pub(crate) fn meet_face(&mut self, light: &Traveller, row: Segment, crossing: &Crossing, normal: Vec3) {
        let system = self.tracer.system;
        let arriving = arriving(light, normal, row.index);
        let face = system.face_at(crossing);
        let behind = system.substance(crossing.after);
        let index = behind.index_at(arriving.wavelength_nm, light.ray.at(crossing.t));
        let outcome = arriving.at_face((behind, index), &face, self.settings);
        let row = self.record(row, face.element, face.surface, outcome.event);
        self.go_on(light, row, face.element, &outcome, |worker, going| {
            let point = foot(&system.program, &light.ray, crossing, normal);
            let near = (&light.ray, crossing.t);
            let starts = &mut worker.next.starts;
            system.near.list(&system.program, near, Some(crossing), going.leaves, starts);
            (Ray::new(point, going.direction), None)
        });
    }

    /// The ray that leaves a sheet in another direction.
    fn leave_sheet(
        &mut self,
        ray: &Ray,
        (sheet, plate): (usize, &Plate),
        (crossing, t): (&Crossing, f64),
        going: &Going,
    ) -> (Ray, Option<(usize, Start)>) {
        let system = self.tracer.system;
        // faces of solids within the tolerance are still to be met
        system.near.list(&system.program, (ray, t), None, Leaves::Here, &mut self.next.starts);
        let mut on = Vec::new();
        plate.near.list(&plate.program, (ray, crossing.t), Some(crossing), going.leaves, &mut on);
        (Ray::new(ray.at(t), going.direction), on.first().map(|start| (sheet, *start)))
    }

    /// Brings light to the end of a segment; the row for it lacks what is met there.
    fn arrive(&mut self, light: &mut Traveller, region: RegionId, (from, to): (f64, f64)) -> Segment {
        let optics = self.optics(region, light.packet.wavelength_nm);
        let length = to - from;
        let intensity = light.packet.power;
        light.packet.path += optics.index.re * length;
        self.dim(light, optics, length);
        light.segment((from, to), intensity, optics.index.re)
    }

    /// Takes what a length of a medium absorbs.
    pub(crate) fn dim(&mut self, light: &mut Traveller, optics: Optics, length: f64) {
        light.packet.power -= self.lose(optics, light.packet.power, length);
        light.stokes = light.stokes.map(|stokes| stokes.with_power(light.packet.power));
    }

    /// Books what a length of a medium absorbs of a power.
    fn lose(&mut self, optics: Optics, power: f64, length: f64) -> f64 {
        let lost = optics.lost(power, length);
        self.balance.absorbed_in_media += lost;
        lost
    }

    pub(crate) fn optics(&mut self, region: RegionId, wavelength_nm: f64) -> Optics {
        let system = self.tracer.system;
        self.indices.of(system, system.program.medium_of(region), wavelength_nm)
    }

    /// Appends a row and answers with the parent of those that follow.
    pub(super) fn record(&mut self, mut row: Segment, element: usize, surface: usize, event: Event) -> i64 {
        (row.element, row.surface, row.event) = (element as i32, surface as i32, event);
        self.rows.single.push(row);
        self.parent_of_next()
    }

    /// The row that was appended last, for those that follow it.
    pub(crate) fn parent_of_next(&self) -> i64 {
        match self.settings.keep {
            Keep::All => self.rows.single.len() as i64 - 1,
            Keep::Ends => -1,
        }
    }

    /// The last row is not the end of its light.
    pub(crate) fn forget_way(&mut self) {
        if self.settings.keep == Keep::Ends {
            self.rows.single.pop();
        }
    }

    pub(super) fn charge(&mut self, element: usize, power: f64) {
        self.balance.absorbed[element] += power;
    }

    pub(crate) fn escape(&mut self, light: &Traveller, region: RegionId, from: f64) {
        let Optics { index, absorption } = self.optics(region, light.packet.wavelength_nm);
        match absorption > 0.0 {
            true => self.balance.absorbed_in_media += light.packet.power,
            false => self.balance.escaped += light.packet.power,
        }
        if self.settings.keep_escaped {
            self.rows.single.push(light.segment((from, f64::NAN), light.packet.power, index.re));
        }
    }

    /// True, with the power booked, if a ray is not followed any more.
    pub(super) fn is_over(&mut self, generation: u32, power: f64) -> bool {
        let is_over =
            generation >= self.settings.generation_limit || power < self.settings.threshold || power == 0.0;
        if is_over {
            self.balance.dropped += power;
        }
        is_over
    }

    /// Sends out what goes on after an event; the rest is absorbed by the element.
    fn go_on(
        &mut self,
        light: &Traveller,
        row: i64,
        element: usize,
        outcome: &Outcome,
        mut start: impl FnMut(&mut Self, &Going) -> (Ray, Option<(usize, Start)>),
    ) {
        let (mut left, followed) = (light.packet.power, self.next.len());
        for (branch, going) in outcome.going.iter().enumerate() {
            let Some(going) = going else { continue };
            left -= going.power;
            let mut packet = light.packet;
            (packet.power, packet.parent) = (going.power, row);
            packet.path += going.delay;
            packet.generation += 1;
            if branch == 1 {
                packet.stream = mixed(packet.stream.wrapping_add(u64::from(light.packet.generation)));
            }
            if self.is_over(packet.generation, packet.power) {
                continue;
            }
            let (ray, on_sheet) = start(self, going);
            let on = on_sheet.map(|(sheet, start)| OnSheet { ray: self.next.len(), sheet, start });
            self.next.on_sheets.extend(on);
            self.next.push(ray, packet, going.stokes);
        }
        self.charge(element, left);
        if self.next.len() > followed {
            self.forget_way();
        }
    }
}

/// Where light leaves a face of the model itself: the point put onto it as [`foot`] does it, and whether that is where
/// f < 0 behind the face.
fn departure(program: &Program, ray: &Ray, t: f64, face: Face, normal: Vec3) -> (Vec3, bool) {
    let point = ray.at(t);
    let (value, gradient) = program.surface(face.surface).surface.value_and_gradient(point);
    let point = stepped(point, normal, value / gradient.dot(normal));
    (point, is_inside(gradient.dot(ray.direction), 0.0, Leaves::Beyond))
}

/// Light at an interface.
fn arriving(light: &Traveller, normal: Vec3, index: f64) -> Arriving {
    Arriving {
        direction: light.ray.direction,
        normal,
        wavelength_nm: light.packet.wavelength_nm,
        power: light.packet.power,
        stokes: light.stokes,
        index,
        // not a sum or the like: ray 3 in generation 5 must not draw what ray 5 draws in generation 3
        stream: mixed(light.packet.stream ^ u64::from(light.packet.generation)),
    }
}

/// A normal turned against a direction.
pub(crate) fn against(normal: Vec3, direction: Vec3) -> Vec3 {
    if normal.dot(direction) > 0.0 { -normal } else { normal }
}

/// Scatters the bits of a key (the finaliser of SplitMix64: Steele, Lea, Flood, OOPSLA 2014).
pub(crate) fn mixed(key: u64) -> u64 {
    let a = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let b = (a ^ (a >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let c = (b ^ (b >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    c ^ (c >> 31)
}
