//! The loop: light through a system, event by event.
//!
//! Rays are followed in chunks, all rays of a chunk a generation at a time. A ray that leaves an interface starts on its
//! surface, without any offset (see [`rayweave_model::Start`]); one that goes straight on through a sheet stays the same ray.

use crate::beam::{Beam, Emitter, Light};
use crate::error::OpticsError;
use crate::interact::{Arriving, Going, Outcome};
use crate::interface::Stokes;
use crate::near::{Leaves, foot};
use crate::segments::{Balance, Event, Segment, Segments};
use crate::settings::Settings;
use crate::system::{Plate, Substance, System};
use rayweave_math::{Affine, Vec3};
use rayweave_model::drive::{Stopped, drive, thread_count};
use rayweave_model::{
    Crossing, Evaluator, Limit, Program, Query, RayAnswer, RayBatch, RegionId, Start, StartLists, dress,
};
use rayweave_shape::Ray;
use rayweave_shape::surface::delta;
use std::ops::Range;
use std::sync::Arc;

/// Rays per chunk: enough for batches to pay, few enough to stay in cache with all their segments.
const CHUNK: usize = 2048;

/// A system with evaluators for its programs, ready to be asked.
#[derive(Debug)]
pub struct Tracer<'a, E> {
    system: &'a System,
    solids: E,
    sheets: Vec<E>,
    frames: Vec<(Affine, Affine)>,
}

/// Everything that came of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// The segments of all rays: chunk by chunk of the source, in each chunk generation by generation.
    pub segments: Segments,
    /// Where the power went.
    pub balance: Balance,
}

impl<'a, E: Evaluator> Tracer<'a, E> {
    /// With evaluators made by a function.
    pub fn new(system: &'a System, make: impl Fn(Arc<Program>) -> E) -> Tracer<'a, E> {
        let frames = system.plates.iter().map(|plate| {
            // a singular frame does not compile
            (plate.frame, plate.frame.inverse().unwrap_or(Affine::IDENTITY))
        });
        Tracer {
            system,
            solids: make(system.program.clone()),
            sheets: system.plates.iter().map(|plate| make(plate.program.clone())).collect(),
            frames: frames.collect(),
        }
    }

    /// The system.
    pub fn system(&self) -> &'a System {
        self.system
    }

    /// Traces light and keeps all segments.
    ///
    /// # Errors
    /// [`OpticsError`] for light that cannot be traced, and if the run is cancelled.
    pub fn trace(&self, light: &impl Emitter, settings: &Settings) -> Result<Trace, OpticsError> {
        let mut trace = Trace::default();
        trace.balance = self.run(light, settings, |segments| {
            trace.segments.append(&segments);
            Ok::<(), OpticsError>(())
        })?;
        Ok(trace)
    }

    /// Traces light and gives the segments away chunk by chunk, in the order of the source, so that a run of any length
    /// takes bounded memory. Parents are row numbers within the chunk.
    ///
    /// # Errors
    /// [`OpticsError`] for light that cannot be traced, if the run is cancelled, and what `sink` returns.
    pub fn run<X: From<OpticsError>>(
        &self,
        light: &impl Emitter,
        settings: &Settings,
        mut sink: impl FnMut(Segments) -> Result<(), X>,
    ) -> Result<Balance, X> {
        let count = light.count();
        let chunks = (0..count).step_by(CHUNK).map(|at| at..(at + CHUNK).min(count));
        let mut balance =
            Balance { absorbed: vec![0.0; self.system.element_names().len()], ..Balance::default() };
        let work = |worker: &mut Worker<'_, E>, range: Range<usize>| worker.chunk(light, range);
        let merge = |found: Result<(Segments, Balance), OpticsError>| {
            let (segments, part) = found?;
            balance.add(&part);
            sink(segments)
        };
        let threads = thread_count(settings.threads);
        drive(threads, &settings.cancel, chunks, || Worker::new(self, settings), work, merge).map_err(
            |stopped| match stopped {
                Stopped::Cancelled => OpticsError::Cancelled.into(),
                Stopped::Failed(error) => error,
            },
        )?;
        Ok(balance)
    }
}

/// A ray on its way.
#[derive(Clone, Debug)]
struct Packet {
    ray: Ray,
    light: Light,
    stokes: Option<Stokes>,
    path: f64,
    id: i64,
    parent: i64,
    generation: u32,
    /// The key of its random numbers.
    stream: u64,
    /// The surfaces of solids that it starts on.
    starts: Range<usize>,
    /// The sheet that it starts on.
    on_sheet: Option<(usize, Start)>,
}

/// What a ray meets.
#[derive(Clone, Debug, Default)]
struct Met {
    region: u32,
    crossing: Option<Crossing>,
    sheets: Vec<(usize, Crossing)>,
}

/// A thread with its memory.
struct Worker<'t, E: Evaluator> {
    tracer: &'t Tracer<'t, E>,
    settings: &'t Settings,
    scratch: E::Scratch,
    sheet_scratch: Vec<E::Scratch>,
    beam: Beam,
    packets: Vec<Packet>,
    next: Vec<Packet>,
    starts: Vec<Start>,
    next_starts: Vec<Start>,
    met: Vec<Met>,
    rows: Segments,
    balance: Balance,
}

impl<'t, E: Evaluator> Worker<'t, E> {
    fn new(tracer: &'t Tracer<'t, E>, settings: &'t Settings) -> Self {
        Worker {
            tracer,
            settings,
            scratch: tracer.solids.scratch(),
            sheet_scratch: tracer.sheets.iter().map(Evaluator::scratch).collect(),
            beam: Beam::default(),
            packets: Vec::new(),
            next: Vec::new(),
            starts: Vec::new(),
            next_starts: Vec::new(),
            met: Vec::new(),
            rows: Segments::default(),
            balance: Balance::default(),
        }
    }

    /// Follows the rays of a range to their ends.
    fn chunk(
        &mut self,
        light: &impl Emitter,
        range: Range<usize>,
    ) -> Result<(Segments, Balance), OpticsError> {
        self.balance =
            Balance { absorbed: vec![0.0; self.tracer.system.element_names().len()], ..Balance::default() };
        self.beam.clear();
        light.emit(range.clone(), &mut self.beam);
        self.beam.check(self.tracer.system).map_err(|error| moved(error, range.start))?;
        self.packets.clear();
        self.starts.clear();
        for i in 0..self.beam.len() {
            let packet = Packet::new(self.beam.get(i), (range.start + i) as u64, self.settings.polarised);
            self.balance.emitted += packet.light.power;
            self.packets.push(packet);
        }
        while !self.packets.is_empty() {
            self.generation();
        }
        Ok((std::mem::take(&mut self.rows), std::mem::take(&mut self.balance)))
    }

    /// One event for every ray, or several where it passes sheets.
    fn generation(&mut self) {
        self.ask();
        let packets = std::mem::take(&mut self.packets);
        let met = std::mem::take(&mut self.met);
        for (packet, met) in packets.iter().zip(&met) {
            self.advance(packet.clone(), met);
        }
        (self.packets, self.met) = (packets, met);
        std::mem::swap(&mut self.packets, &mut self.next);
        std::mem::swap(&mut self.starts, &mut self.next_starts);
        self.next.clear();
        self.next_starts.clear();
    }

    /// Finds what all rays meet.
    fn ask(&mut self) {
        let mut batch = RayBatch::default();
        let mut first = vec![0];
        let mut entries = Vec::with_capacity(self.starts.len());
        for packet in &self.packets {
            batch.push(packet.ray);
            entries.extend_from_slice(&self.starts[packet.starts.clone()]);
            first.push(entries.len() as u32);
        }
        self.met.iter_mut().for_each(|met| met.sheets.clear());
        self.met.resize_with(self.packets.len(), Met::default);
        let met = &mut self.met;
        let starts = (!entries.is_empty()).then_some(StartLists { first: &first, entries: &entries });
        let query = Query { limit: Limit::First, starts, ..Query::nearest() };
        let mut take = |answer: RayAnswer<'_>| {
            met[answer.ray].region = answer.start.0;
            met[answer.ray].crossing = answer.crossings.first().copied();
        };
        self.tracer.solids.crossings(batch.rays(), &query, &mut self.scratch, &mut take);
        for (number, sheet) in self.tracer.sheets.iter().enumerate() {
            let (mut first, mut entries) = (vec![0], Vec::new());
            for packet in &self.packets {
                entries.extend(packet.on_sheet.filter(|on| on.0 == number).map(|on| on.1));
                first.push(entries.len() as u32);
            }
            let starts = (!entries.is_empty()).then_some(StartLists { first: &first, entries: &entries });
            let query = Query { limit: Limit::All, starts, ..Query::nearest() };
            let mut take = |answer: RayAnswer<'_>| {
                let through = |c: &&Crossing| c.before.0 != 0 && c.after.0 != 0;
                met[answer.ray].sheets.extend(answer.crossings.iter().filter(through).map(|c| (number, *c)));
            };
            sheet.crossings(batch.rays(), &query, &mut self.sheet_scratch[number], &mut take);
        }
        let sort = |met: &mut Met| met.sheets.sort_by(|a, b| a.1.t.total_cmp(&b.1.t));
        if self.tracer.sheets.len() > 1 {
            self.met.iter_mut().for_each(sort);
        }
    }

    /// Takes a ray to its next event that is no straight passage through a sheet.
    fn advance(&mut self, mut packet: Packet, met: &Met) {
        let region = RegionId(met.region);
        let end = met.crossing.map_or(f64::INFINITY, |crossing| crossing.t);
        // what lies in a face of a solid comes first
        let slack = if end.is_finite() { delta(0.0, &packet.ray, end) } else { 0.0 };
        let mut from = 0.0;
        for (number, crossing) in met.sheets.iter().filter(|(_, crossing)| crossing.t <= end + slack) {
            let t = crossing.t.min(end);
            let plate = &self.tracer.system.plates[*number];
            let normal = against(dress::normal(&plate.program, &packet.ray, crossing), packet.ray.direction);
            let (arriving, row) = self.arrive(&mut packet, region, (from, t), normal);
            let (frame, local) = &self.tracer.frames[*number];
            let (point, unit_nm) = (packet.ray.at(t), self.tracer.system.unit_nm);
            let outcome = arriving.at_sheet(&plate.action, (frame, local), point, unit_nm, self.settings);
            let surface = self.tracer.system.sheets_from() + number;
            let row = self.record(row, plate.element, surface, &outcome);
            let straight = outcome.event == Event::Passed;
            if let (true, [Some(going), None]) = (straight, outcome.going) {
                self.charge(plate.element, packet.light.power - going.power);
                (packet.light.power, packet.stokes) = (going.power, going.stokes);
                (packet.parent, packet.generation, from) = (row, packet.generation + 1, t);
                if self.is_over(&packet) {
                    return;
                }
                continue;
            }
            self.go_on(&packet, row, plate.element, &outcome, |worker, going| {
                worker.leave_sheet(&packet, (*number, plate), (crossing, t), going)
            });
            return;
        }
        match met.crossing {
            None => self.escape(packet, region, from),
            Some(crossing) => self.meet(packet, region, from, &crossing),
        }
    }

    /// A face of a solid.
    fn meet(&mut self, mut packet: Packet, region: RegionId, from: f64, crossing: &Crossing) {
        let system = self.tracer.system;
        let normal = against(dress::normal(&system.program, &packet.ray, crossing), packet.ray.direction);
        let (arriving, row) = self.arrive(&mut packet, region, (from, crossing.t), normal);
        let face = system.face_at(crossing);
        let outcome = arriving.at_face(system.substance(crossing.after), &face, self.settings);
        let row = self.record(row, face.element, face.surface, &outcome);
        let point = foot(&system.program, &packet.ray, crossing, normal);
        self.go_on(&packet, row, face.element, &outcome, |worker, going| {
            let first = worker.next_starts.len();
            let near = (&packet.ray, crossing.t);
            let starts = &mut worker.next_starts;
            system.near.list(&system.program, near, Some(crossing), going.leaves, starts);
            (Ray::new(point, going.direction), first..worker.next_starts.len(), None)
        });
    }

    /// The ray that leaves a sheet in another direction.
    fn leave_sheet(
        &mut self,
        packet: &Packet,
        (number, plate): (usize, &Plate),
        (crossing, t): (&Crossing, f64),
        going: &Going,
    ) -> (Ray, Range<usize>, Option<(usize, Start)>) {
        let system = self.tracer.system;
        let first = self.next_starts.len();
        // faces of solids within the tolerance are still to be met
        let near = (&packet.ray, t);
        system.near.list(&system.program, near, None, Leaves::Here, &mut self.next_starts);
        let mut on = Vec::new();
        plate.near.list(&plate.program, (&packet.ray, crossing.t), Some(crossing), going.leaves, &mut on);
        let ray = Ray::new(packet.ray.at(t), going.direction);
        (ray, first..self.next_starts.len(), on.first().map(|start| (number, *start)))
    }

    /// Brings light to the end of a segment; the row for it lacks what is met there.
    fn arrive(
        &mut self,
        packet: &mut Packet,
        region: RegionId,
        (from, to): (f64, f64),
        normal: Vec3,
    ) -> (Arriving, Segment) {
        let (index, absorption) = self.index(region, packet.light.wavelength_nm);
        let length = to - from;
        let intensity = packet.light.power;
        packet.path += index * length;
        let lost = if length > 0.0 { -libm::expm1(-absorption * length) * intensity } else { 0.0 };
        self.balance.absorbed_in_media += lost;
        packet.light.power -= lost;
        packet.stokes = packet.stokes.map(|stokes| stokes.with_power(packet.light.power));
        let arriving = Arriving {
            direction: packet.ray.direction,
            normal,
            wavelength_nm: packet.light.wavelength_nm,
            power: packet.light.power,
            stokes: packet.stokes,
            index,
            // not a sum or the like: ray 3 in generation 5 must not draw what ray 5 draws in generation 3
            stream: mixed(packet.stream ^ u64::from(packet.generation)),
        };
        (arriving, packet.segment((from, to), intensity, index))
    }

    /// The index of what fills a region, and its absorption per unit of length.
    fn index(&self, region: RegionId, wavelength_nm: f64) -> (f64, f64) {
        match self.tracer.system.substance(region) {
            Substance::Transparent(medium) => {
                let index = medium.index(wavelength_nm);
                let per_nm = 4.0 * std::f64::consts::PI * index.im / wavelength_nm;
                (index.re, per_nm * self.tracer.system.unit_nm)
            }
            // light that starts inside of what no light enters ends there
            Substance::Opaque | Substance::Metal(_) => (1.0, f64::INFINITY),
        }
    }

    fn record(&mut self, mut row: Segment, element: usize, surface: usize, outcome: &Outcome) -> i64 {
        (row.element, row.surface, row.event) = (element as i32, surface as i32, outcome.event);
        self.rows.push(row);
        self.rows.len() as i64 - 1
    }

    fn charge(&mut self, element: usize, power: f64) {
        self.balance.absorbed[element] += power;
    }

    fn escape(&mut self, packet: Packet, region: RegionId, from: f64) {
        let (index, absorption) = self.index(region, packet.light.wavelength_nm);
        match absorption > 0.0 {
            true => self.balance.absorbed_in_media += packet.light.power,
            false => self.balance.escaped += packet.light.power,
        }
        if self.settings.keep_escaped {
            let row = packet.segment((from, f64::NAN), packet.light.power, index);
            self.rows.push(row);
        }
    }

    /// True, with the power booked, if the ray is not followed any more.
    fn is_over(&mut self, packet: &Packet) -> bool {
        let is_over = packet.generation >= self.settings.generation_limit
            || packet.light.power < self.settings.threshold
            || packet.light.power == 0.0;
        if is_over {
            self.balance.dropped += packet.light.power;
        }
        is_over
    }

    /// Sends out what goes on after an event; the rest is absorbed by the element.
    fn go_on(
        &mut self,
        packet: &Packet,
        row: i64,
        element: usize,
        outcome: &Outcome,
        mut start: impl FnMut(&mut Self, &Going) -> (Ray, Range<usize>, Option<(usize, Start)>),
    ) {
        let mut left = packet.light.power;
        for (branch, going) in outcome.going.iter().enumerate() {
            let Some(going) = going else { continue };
            left -= going.power;
            let mut next = packet.clone();
            (next.light.power, next.stokes) = (going.power, going.stokes);
            (next.parent, next.generation) = (row, packet.generation + 1);
            if branch == 1 {
                next.stream = mixed(packet.stream.wrapping_add(u64::from(packet.generation)));
            }
            if self.is_over(&next) {
                continue;
            }
            (next.ray, next.starts, next.on_sheet) = start(self, going);
            self.next.push(next);
        }
        self.charge(element, left);
    }
}

impl Packet {
    fn new(light: Light, number: u64, polarised: bool) -> Packet {
        let direction = light.ray.direction.normalize();
        let known = light.stokes.map(|stokes| stokes.with_power(light.power));
        let stokes = || known.unwrap_or(Stokes::unpolarised(light.power, direction));
        Packet {
            ray: Ray::new(light.ray.origin, direction),
            light,
            stokes: polarised.then(stokes),
            path: 0.0,
            id: number as i64,
            parent: -1,
            generation: 0,
            stream: mixed(number),
            starts: 0..0,
            on_sheet: None,
        }
    }

    /// A piece of the ray; what is met at its end is filled in later.
    fn segment(&self, (from, to): (f64, f64), intensity: f64, index: f64) -> Segment {
        Segment {
            id: self.id,
            parent: self.parent,
            generation: self.generation,
            source: self.light.source,
            wavelength_nm: self.light.wavelength_nm,
            intensity,
            index,
            start: self.ray.at(from),
            end: self.ray.at(to),
            direction: self.ray.direction,
            path: self.path,
            element: -1,
            surface: -1,
            event: Event::Escaped,
        }
    }
}

/// A normal turned against a direction.
fn against(normal: Vec3, direction: Vec3) -> Vec3 {
    if normal.dot(direction) > 0.0 { -normal } else { normal }
}

/// Scatters the bits of a key (the finaliser of SplitMix64: Steele, Lea, Flood, OOPSLA 2014).
fn mixed(key: u64) -> u64 {
    let a = key.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let b = (a ^ (a >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let c = (b ^ (b >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    c ^ (c >> 31)
}

/// Counts the rays of an error from the beginning of the source.
fn moved(error: OpticsError, by: usize) -> OpticsError {
    match error {
        OpticsError::Ray(mut bad) => {
            bad.ray += by;
            OpticsError::Ray(bad)
        }
        OpticsError::BadLight { column, ray, value, range } => {
            OpticsError::BadLight { column, ray: ray + by, value, range }
        }
        OpticsError::Wavelength { ray, wavelength_nm, medium, range_nm } => {
            OpticsError::Wavelength { ray: ray + by, wavelength_nm, medium, range_nm }
        }
        other => other,
    }
}
