//! The rays of one generation as columns, and what they meet.

use crate::abreast::{Around, Gone};
use crate::beam::{Beam, Light};
use crate::foresee::Step;
use crate::interface::Stokes;
use crate::segments::{Event, Segment};
use crate::system::System;
use crate::trace::mixed;
use rayweave_math::Vec3;
use rayweave_model::{
    Crossing, Face, FirstHits, PlacementId, RayBatch, Rays, RegionId, Start, StartLists, SurfaceId,
};
use rayweave_shape::Ray;
use rayweave_shape::lanes::LANES;
use std::ops::Range;

/// What a ray carries along.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Packet {
    pub wavelength_nm: f64,
    pub power: f64,
    pub path: f64,
    pub id: i64,
    pub parent: i64,
    /// The key of its random numbers.
    pub stream: u64,
    pub source: u32,
    pub generation: u32,
}

/// A ray on its way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Traveller {
    pub ray: Ray,
    pub packet: Packet,
    pub stokes: Option<Stokes>,
}

impl Traveller {
    /// A piece of the ray; what is met at its end is filled in later.
    pub fn segment(&self, (from, to): (f64, f64), intensity: f64, index: f64) -> Segment {
        let Traveller { ray, packet, .. } = self;
        Segment {
            id: packet.id,
            parent: packet.parent,
            generation: packet.generation,
            source: packet.source,
            wavelength_nm: packet.wavelength_nm,
            intensity,
            index,
            start: ray.at(from),
            end: ray.at(to),
            direction: ray.direction,
            path: packet.path,
            element: -1,
            surface: -1,
            event: Event::Escaped,
        }
    }
}

/// The sheet that a ray starts on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnSheet {
    pub ray: usize,
    pub sheet: usize,
    pub start: Start,
}

/// Rays that are asked about together.
#[derive(Debug)]
pub(crate) struct Generation {
    pub rays: RayBatch,
    pub packets: Packets,
    /// One for each ray, or none if polarisation is not followed.
    stokes: Vec<Stokes>,
    first: Vec<u32>,
    /// The surfaces of solids that they start on; those of a ray are appended before it is.
    pub starts: Vec<Start>,
    pub on_sheets: Vec<OnSheet>,
}

/// [`Packet`]s as columns.
#[derive(Debug, Default)]
pub(crate) struct Packets {
    pub wavelength_nm: Vec<f64>,
    pub power: Vec<f64>,
    pub path: Vec<f64>,
    pub id: Vec<i64>,
    pub parent: Vec<i64>,
    pub stream: Vec<u64>,
    pub source: Vec<u32>,
    pub generation: Vec<u32>,
}

impl Packets {
    fn clear(&mut self) {
        self.wavelength_nm.clear();
        self.power.clear();
        self.path.clear();
        self.id.clear();
        self.parent.clear();
        self.stream.clear();
        self.source.clear();
        self.generation.clear();
    }

    fn push(&mut self, packet: Packet) {
        self.wavelength_nm.push(packet.wavelength_nm);
        self.power.push(packet.power);
        self.path.push(packet.path);
        self.id.push(packet.id);
        self.parent.push(packet.parent);
        self.stream.push(packet.stream);
        self.source.push(packet.source);
        self.generation.push(packet.generation);
    }
}

impl Default for Generation {
    fn default() -> Generation {
        Generation {
            rays: RayBatch::default(),
            packets: Packets::default(),
            stokes: Vec::new(),
            first: vec![0],
            starts: Vec::new(),
            on_sheets: Vec::new(),
        }
    }
}

impl Generation {
    pub fn len(&self) -> usize {
        self.packets.id.len()
    }

    pub fn clear(&mut self) {
        self.rays.clear();
        self.packets.clear();
        self.stokes.clear();
        self.first.truncate(1);
        self.starts.clear();
        self.on_sheets.clear();
    }

    /// Appends rays of a beam, the first of which has the number `first`, with directions of unit length.
    pub fn set_out(&mut self, beam: &Beam, range: Range<usize>, first: u64, polarised: bool) {
        let (rays, packets) = (beam.rays(), &mut self.packets);
        packets.wavelength_nm.extend_from_slice(&beam.wavelengths_nm()[range.clone()]);
        packets.power.extend_from_slice(&beam.powers()[range.clone()]);
        packets.source.extend_from_slice(&beam.sources()[range.clone()]);
        let numbers = range.clone().map(|i| first + i as u64);
        packets.id.extend(numbers.clone().map(|number| number as i64));
        packets.stream.extend(numbers.map(mixed));
        let count = packets.id.len();
        packets.path.resize(count, 0.0);
        packets.parent.resize(count, -1);
        packets.generation.resize(count, 0);
        self.first.resize(count + 1, self.starts.len() as u32);
        let part = |columns: [_; 3]| columns.map(|column: &[f64]| &column[range.clone()]);
        let (origins, directions) = (part(rays.origins), part(rays.directions));
        self.rays.extend_normalised(Rays { origins, directions });
        for i in range.filter(|_| polarised) {
            let Light { ray, power, stokes, .. } = beam.get(i);
            let known = stokes.map(|stokes| stokes.with_power(power));
            self.stokes.push(known.unwrap_or(Stokes::unpolarised(power, ray.direction.normalize())));
        }
    }

    /// Appends all rays of another generation that start on no sheets.
    pub fn append(&mut self, other: &Generation) {
        let lists = StartLists { first: &other.first, entries: &other.starts };
        for i in 0..other.len() {
            self.starts.extend_from_slice(lists.of(i));
            let Traveller { ray, packet, stokes } = other.get(i);
            self.push(ray, packet, stokes);
        }
    }

    pub fn push(&mut self, ray: Ray, packet: Packet, stokes: Option<Stokes>) {
        self.rays.push(ray);
        self.packets.push(packet);
        self.stokes.extend(stokes);
        self.first.push(self.starts.len() as u32);
    }

    /// Appends rays `at..` of another generation that go on from a face: with what they carry but for their powers and ways;
    /// the first of their parents is `parent`, or none of them has one.
    pub fn follow(
        &mut self,
        other: &Packets,
        at: usize,
        powers: &[f64; LANES],
        gone: &Gone,
        face: Face,
        parent: Option<i64>,
    ) {
        let (here, packets) = (at..at + LANES, &mut self.packets);
        packets.wavelength_nm.extend_from_slice(&other.wavelength_nm[here.clone()]);
        packets.power.extend_from_slice(powers);
        packets.id.extend_from_slice(&other.id[here.clone()]);
        packets.stream.extend_from_slice(&other.stream[here.clone()]);
        packets.source.extend_from_slice(&other.source[here.clone()]);
        packets.generation.extend(other.generation[here].iter().map(|generation| generation + 1));
        self.go_on(gone, Some(face), parent);
    }

    /// Appends rays `at..at + 8` of a beam, the first of which has the number `first`, with the powers that they have after
    /// some events that happened to all of them alike, the last one at a face.
    pub fn join(
        &mut self,
        (beam, first): (&Beam, u64),
        at: usize,
        (powers, gone): (&[f64; LANES], &Gone),
        (events, face): (u32, Option<Face>),
        parent: Option<i64>,
    ) {
        let (here, packets) = (at..at + LANES, &mut self.packets);
        packets.wavelength_nm.extend_from_slice(&beam.wavelengths_nm()[here.clone()]);
        packets.power.extend_from_slice(powers);
        packets.source.extend_from_slice(&beam.sources()[here.clone()]);
        let numbers = here.map(|i| first + i as u64);
        packets.id.extend(numbers.clone().map(|number| number as i64));
        packets.stream.extend(numbers.map(mixed));
        packets.generation.extend([events; LANES]);
        self.go_on(gone, face, parent);
    }

    /// Appends the ways of eight rays.
    fn go_on(&mut self, gone: &Gone, face: Option<Face>, parent: Option<i64>) {
        self.rays.extend(gone.rays(), 0..LANES);
        self.packets.path.extend_from_slice(&gone.path);
        for lane in 0..LANES {
            self.packets.parent.push(parent.map_or(-1, |parent| parent + lane as i64));
            let inside = gone.inside >> lane & 1 == 1;
            self.starts.extend(face.map(|face| Start {
                surface: face.surface,
                placement: face.placement,
                inside,
            }));
            self.first.push(self.starts.len() as u32);
        }
    }

    pub fn packet(&self, i: usize) -> Packet {
        let Packets { wavelength_nm, power, path, id, parent, stream, source, generation } = &self.packets;
        Packet {
            wavelength_nm: wavelength_nm[i],
            power: power[i],
            path: path[i],
            id: id[i],
            parent: parent[i],
            stream: stream[i],
            source: source[i],
            generation: generation[i],
        }
    }

    pub fn get(&self, i: usize) -> Traveller {
        Traveller {
            ray: self.rays.rays().get(i),
            packet: self.packet(i),
            stokes: self.stokes.get(i).copied(),
        }
    }

    pub fn lists(&self) -> Option<StartLists<'_>> {
        let lists = StartLists { first: &self.first, entries: &self.starts };
        (!self.starts.is_empty()).then_some(lists)
    }
}

/// A crossing of a sheet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SheetMet {
    pub ray: usize,
    pub sheet: usize,
    pub crossing: Crossing,
}

/// What the rays of a generation meet.
#[derive(Debug, Default)]
pub(crate) struct Met {
    pub t: Vec<f64>,
    pub face: Vec<i32>,
    pub placement: Vec<u32>,
    pub before: Vec<u32>,
    pub after: Vec<u32>,
    pub normal: [Vec<f64>; 3],
    /// Those that belong to other faces on their two sides, by ray.
    pub between: Vec<(usize, Crossing)>,
    /// Crossings of sheets, by ray and time.
    pub sheets: Vec<SheetMet>,
}

impl Met {
    /// Makes room for so many rays.
    pub fn reset(&mut self, count: usize) {
        let ids = [&mut self.placement, &mut self.before, &mut self.after];
        ids.into_iter().for_each(|column| column.resize(count, 0));
        self.t.resize(count, 0.0);
        self.face.resize(count, 0);
        self.normal.iter_mut().for_each(|column| column.resize(count, 0.0));
        self.between.clear();
        self.sheets.clear();
    }

    /// The sheet that eight rays meet first, if that is the same one and no solid comes before it, and the surface in
    /// which they do so.
    pub fn common_sheet(&self, at: usize) -> Option<(usize, SurfaceId)> {
        let mut left = &self.sheets[self.sheets.partition_point(|met| met.ray < at)..];
        let (sheet, surface) = left.first().map(|met| (met.sheet, met.crossing.face.surface))?;
        for i in at..at + LANES {
            let first = left.first().filter(|met| met.ray == i && met.crossing.t < self.t[i])?;
            if (first.sheet, first.crossing.face.surface) != (sheet, surface) {
                return None;
            }
            left = &left[left.partition_point(|met| met.ray == i)..];
        }
        Some((sheet, surface))
    }

    /// The face that eight rays meet, if it is the same one.
    pub fn common_face(&self, at: usize) -> Option<usize> {
        let face = self.face[at];
        let is_same = self.face[at..at + LANES].iter().all(|&other| other == face);
        usize::try_from(face).ok().filter(|_| is_same)
    }

    /// Columns to be filled.
    pub fn columns(&mut self) -> (FirstHits<'_>, &mut Vec<(usize, Crossing)>) {
        let Met { t, face, placement, before, after, normal: [x, y, z], between, .. } = self;
        (FirstHits { t, face, placement, before, after, normal: Some([x, y, z]) }, between)
    }

    /// Brings what was found in any order into that of the rays.
    pub fn sort(&mut self) {
        self.between.sort_by_key(|(ray, _)| *ray);
        self.sheets.sort_by(|a, b| a.ray.cmp(&b.ray).then(a.crossing.t.total_cmp(&b.crossing.t)));
    }

    /// The crossing of a ray with the solids.
    pub fn crossing(&self, system: &System, i: usize) -> Option<Crossing> {
        let face = *system.faces.get(usize::try_from(self.face[i]).ok()?)?;
        if let Some((_, crossing)) = self.between(i) {
            return Some(*crossing);
        }
        let face = Face { placement: PlacementId(self.placement[i]), ..face };
        let [before, after] = [self.before[i], self.after[i]].map(RegionId);
        Some(Crossing { t: self.t[i], face, left: face, entered: face, before, after })
    }

    /// What eight rays meet, if it is one face between the same regions, the same on both sides.
    pub fn common(&self, at: usize) -> Option<Step> {
        let here = at..at + LANES;
        let (face, before, after) = (*self.face.get(at)?, self.before[at], self.after[at]);
        let is_same = self.face.get(here.clone())?.iter().all(|&other| other == face)
            && self.before[here.clone()].iter().all(|&other| other == before)
            && self.after[here.clone()].iter().all(|&other| other == after)
            && self.placement[here].iter().all(|&other| other == 0);
        let between = || self.between_from(at).is_some_and(|(ray, _)| *ray < at + LANES);
        let face = usize::try_from(face).ok().filter(|_| is_same && !between())?;
        Some(Step { face, left: face, entered: face, before: RegionId(before), after: RegionId(after) })
    }

    pub fn between(&self, i: usize) -> Option<&(usize, Crossing)> {
        self.between_from(i).filter(|(ray, _)| *ray == i)
    }

    /// The first of them on the rays `i..`, once they are sorted.
    fn between_from(&self, i: usize) -> Option<&(usize, Crossing)> {
        self.between.get(self.between.partition_point(|(ray, _)| *ray < i))
    }

    pub fn normal(&self, i: usize) -> Vec3 {
        let [x, y, z] = &self.normal;
        Vec3::new(x[i], y[i], z[i])
    }
}

/// Some rays of a generation, to be asked about.
#[derive(Debug, Default)]
pub(crate) struct Part {
    pub rays: RayBatch,
    /// Their numbers in the generation.
    pub numbers: Vec<usize>,
    pub first: Vec<u32>,
    pub starts: Vec<Start>,
}

impl Part {
    fn clear(&mut self) {
        self.rays.clear();
        self.numbers.clear();
        self.first.clear();
        self.starts.clear();
        self.first.push(0);
    }

    fn push(&mut self, ray: Ray, number: usize, starts: impl IntoIterator<Item = Start>) {
        self.rays.push(ray);
        self.numbers.push(number);
        self.starts.extend(starts);
        self.first.push(self.starts.len() as u32);
    }

    /// Gathers those that may meet a sheet before a solid: by the ends of the piece of each ray up to that.
    pub fn gather(&mut self, now: &Generation, met: &Met, sheet: usize, around: &Around) {
        self.clear();
        let rays = now.rays.rays();
        let mut on = now.on_sheets.iter().filter(|on| on.sheet == sheet).peekable();
        for at in (0..now.len()).step_by(LANES) {
            let eight = if at + LANES <= now.len() { around.may_touch(rays, at, &met.t) } else { None };
            if eight == Some(0) {
                continue;
            }
            let is_asked = |i: &usize| eight.is_none_or(|eight| eight >> (i - at) & 1 == 1);
            for i in (at..now.len().min(at + LANES)).filter(is_asked) {
                while on.next_if(|on| on.ray < i).is_some() {}
                self.push(rays.get(i), i, on.next_if(|on| on.ray == i).map(|on| on.start));
            }
        }
    }

    pub fn lists(&self) -> Option<StartLists<'_>> {
        let lists = StartLists { first: &self.first, entries: &self.starts };
        (!self.starts.is_empty()).then_some(lists)
    }
}
