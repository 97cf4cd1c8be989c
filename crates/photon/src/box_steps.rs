//! Steps from face to face within boxes, such as crystals and light guides: eight photons at a time, each as long as it bounces.
//!
//! A photon that starts on a face of a box meets the faces of this box and of the few boxes within it. If its next crossing is
//! certain, if no scattering in the material comes first, and if the boundary is one that [lanes](crate::boundary) can apply, the
//! step needs neither a query nor memory: the photon stays in its lane until it is absorbed. The loop over all photons makes every
//! other step. Both compute the same bits.

mod cell;
mod eight;
mod next;

use self::cell::{BOXES, LoadedBox, LoadedCell, PATHS};
use self::eight::{BoxStepCounts, Eight, Ends, World};
use crate::detector::{Detector, Meeting};
use crate::in_flight::{Mark, Numbers, Place};
use crate::material::{Bulk, MaterialValues, ValueTable};
use crate::photon::Photon;
use crate::rows::{get, put};
use crate::settings::RunSettings;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{AxisBox, BoxCell, BoxCells, BoxStart, RegionId, Start, SurfaceId};
use rayweave_shape::dispatch_wide;
use rayweave_shape::lanes::{LANES, WideLevel};

/// The number of photons below which the loop over all photons is faster.
const FEW: u32 = 3;

/// The steps of photons in the boxes of a detector.
pub(crate) struct BoxSteps<'d> {
    level: WideLevel,
    cells: &'d BoxCells,
    detector: &'d Detector,
    settings: &'d RunSettings,
    /// For each face of each box, the points out of reach of all surfaces but its own.
    alone: Vec<Bounds>,
    /// For each face of each box, true if the function of its surface is negative outside of the box.
    turned: Vec<bool>,
    eight: Box<Eight>,
    /// The photons that have ended.
    ended: Vec<usize>,
}

/// The photons of a batch.
pub(crate) struct BatchPhotons<'b> {
    pub photons: &'b mut [Photon],
    pub marks: &'b mut [Mark],
    pub numbers: &'b Numbers,
    pub tables: &'b [ValueTable],
    pub values: &'b mut [MaterialValues],
}

impl<'d> BoxSteps<'d> {
    /// For a detector with known cells; `None` if photons move in none of them, if photons of one number may be emitted together,
    /// whose order depends on the loop over all photons, and on processors without wide vectors.
    pub fn new(
        detector: &'d Detector,
        cells: Option<&'d BoxCells>,
        settings: &'d RunSettings,
    ) -> Option<Self> {
        let (level, cells) = (WideLevel::widest()?, cells?);
        let mut shifters = detector.materials.iter().flat_map(|material| &material.shifters);
        if shifters.any(|shifter| shifter.mean_photons.is_some()) {
            return None;
        }
        let is_entered = |cell: &BoxCell| {
            let region = cells.boxes[cell.list[0] as usize].region;
            let medium = detector.material_of.get(region.index());
            region.0 > 0 && medium.is_some_and(|&medium| detector.materials[medium as usize].index.is_some())
        };
        if !cells.cells.iter().any(is_entered) {
            return None;
        }
        // photons that leave a box start on its surfaces
        let is_listed = |own: &AxisBox, surface: SurfaceId| {
            let start = Start { surface, placement: own.placement, inside: false };
            Place::on(&start, &detector.starts).is_some()
        };
        let is_known = |own: &AxisBox| own.surfaces.iter().all(|&surface| is_listed(own, surface));
        if !cells.boxes.iter().all(is_known) {
            return None;
        }
        let contact = |(own, surface): (&AxisBox, SurfaceId)| {
            let number = detector.starts.lane_contact(surface, own.placement);
            number.and_then(|number| detector.starts.lane_contacts().get(number as usize))
        };
        let faces = cells.boxes.iter().flat_map(|own| own.surfaces.map(|surface| (own, surface)));
        let alone = faces.map(|face| contact(face).map_or(Bounds::EMPTY, |contact| contact.alone)).collect();
        let is_turned = |(face, surface): (usize, SurfaceId)| {
            let surface = &detector.program.surface(surface).surface;
            let outward = if face < 3 { -1.0 } else { 1.0 };
            surface.value_and_gradient(Vec3::ZERO).1[face % 3] * outward < 0.0
        };
        let surfaces = cells.boxes.iter().flat_map(|own| own.surfaces.into_iter().enumerate());
        let turned = surfaces.map(is_turned).collect();
        let (eight, ended) = (Box::default(), Vec::new());
        Some(BoxSteps { level, cells, detector, settings, alone, turned, eight, ended })
    }

    /// The place of a photon that starts on one face.
    fn place(&self, start: &Start) -> Option<BoxStart> {
        let on = |inside| self.cells.start(&Start { inside, ..*start });
        let BoxStart { cell, place, face } = on(true).or_else(|| on(false))?;
        let number = self.cells.cells[cell as usize].list[place] as usize;
        on(start.inside != self.turned[6 * number + face])
    }

    /// The photons that ended in the last steps, in ascending order.
    pub fn ended(&self) -> &[usize] {
        &self.ended
    }

    /// Makes the steps that are certain.
    pub fn run(&mut self, photons: &mut BatchPhotons<'_>) -> BoxStepCounts {
        let (mut counts, mut next) = (BoxStepCounts::default(), 0);
        self.ended.clear();
        loop {
            for lane in lanes_of(!self.eight.active & ALL) {
                while self.eight.active >> lane & 1 == 0 && next < photons.marks.len() {
                    self.board(lane, next, photons);
                    next += 1;
                }
            }
            let is_last = next == photons.marks.len() && self.eight.active.count_ones() < FEW;
            if is_last || self.settings.cancel.is_cancelled() {
                break;
            }
            let ends = self.step(&mut counts);
            let eight = &mut *self.eight;
            let ended = ends.absorbed[0] | ends.absorbed[1];
            self.ended.extend(lanes_of(ended).map(|lane| eight.at[lane]));
            eight.active &= !ended;
            eight.moved |= ends.stepped;
            let active = eight.active;
            for lane in lanes_of(active & ends.stepped & ends.behind) {
                self.cross(lane, &ends, photons);
            }
            for lane in lanes_of(active & !ends.stepped) {
                self.leave(lane, None, photons);
            }
        }
        for lane in 0..LANES {
            self.leave(lane, None, photons);
        }
        self.ended.sort_unstable();
        counts
    }

    /// Puts a photon into a lane, if it starts on one face, in a cell.
    fn board(&mut self, lane: usize, at: usize, photons: &mut BatchPhotons<'_>) {
        let mark = photons.marks[at];
        let Some(start) = mark.place.start(&self.detector.starts) else { return };
        let Some(place) = self.place(&start) else { return };
        let photon = photons.photons[at];
        if !self.enter(lane, place, photon.energy, photons) {
            return;
        }
        let eight = &mut *self.eight;
        eight.active |= 1 << lane;
        eight.moved &= !(1 << lane);
        eight.at[lane] = at;
        put(&mut eight.position, lane, photon.position);
        put(&mut eight.direction, lane, photon.direction);
        put(&mut eight.polarisation, lane, photon.polarisation);
        eight.time[lane] = photon.time;
        for (row, word) in eight.counters.iter_mut().zip(photons.numbers.counter(&mark)) {
            row[lane] = u64::from(word);
        }
    }

    /// Takes a photon out of its lane; it starts on a surface, or on the face of its lane.
    fn leave(&mut self, lane: usize, start: Option<Start>, photons: &mut BatchPhotons<'_>) {
        let eight = &*self.eight;
        let (at, bit) = (eight.at[lane], 1 << lane);
        if eight.active & eight.moved & bit != 0 {
            let (photon, mark) = (&mut photons.photons[at], &mut photons.marks[at]);
            photon.position = get(&eight.position, lane);
            photon.direction = get(&eight.direction, lane);
            photon.polarisation = get(&eight.polarisation, lane);
            photon.time = eight.time[lane];
            mark.steps = eight.counters[2][lane] as u32;
            // all surfaces of boxes have one: see `new`
            let place = eight.place[lane] as usize % BOXES;
            let face = (eight.boxes.boxes[place].number[lane], eight.face[lane] as usize % 6);
            let start = start.unwrap_or_else(|| self.start(face, place == 0));
            mark.place = Place::on(&start, &self.detector.starts).unwrap_or(Place::UNKNOWN);
        }
        self.eight.active &= !bit;
    }

    /// Prepares a lane for a photon on a face in a cell; false if its material has no index or too many processes.
    fn enter(
        &mut self,
        lane: usize,
        BoxStart { cell, place, face }: BoxStart,
        energy: f64,
        photons: &mut BatchPhotons<'_>,
    ) -> bool {
        if (self.eight.cell[lane], self.eight.energy[lane]) != (cell, energy) {
            let before = 1 - self.eight.last[lane];
            let LoadedCell { cell: known, energy: at, .. } = self.eight.loaded[lane][before];
            if (known, at) != (cell, energy) {
                let Some(loaded) = self.load(cell, energy, photons) else { return false };
                self.eight.loaded[lane][before] = loaded;
            }
            self.eight.put(lane, before);
        }
        (self.eight.place[lane], self.eight.face[lane]) = (place as f64, face as f64);
        true
    }

    /// Reads a cell with the properties of its materials and surfaces at an energy; `None` if its material has no index or too many
    /// processes.
    fn load(&self, cell: u32, energy: f64, photons: &mut BatchPhotons<'_>) -> Option<LoadedCell> {
        let own = &self.cells.cells[cell as usize];
        let region = self.cells.boxes[own.list[0] as usize].region;
        let values = self.values(region, energy, photons)?;
        let (index, paths) = (values.index?, values.paths());
        if paths.len() > PATHS {
            return None;
        }
        let mut loaded = LoadedCell::NONE;
        (loaded.cell, loaded.energy, loaded.velocity) = (cell, energy, values.velocity);
        for (k, &(mean, process)) in paths.iter().enumerate() {
            loaded.paths[k] = (mean, matches!(process, Bulk::Absorption));
        }
        for (place, &number) in own.list.iter().enumerate().take(BOXES) {
            let listed = &self.cells.boxes[number as usize];
            let behind = if place == 0 { own.behind } else { listed.region };
            let meeting = self.meeting([region, behind], (index, energy), photons);
            let detects = self.detector.is_detecting(self.settings.detection, behind);
            loaded.push(LoadedBox {
                number,
                faces: [listed.shift.to_array(), listed.low, listed.high],
                is_lower: place > 0 && listed.region <= region,
                is_bare: meeting.is_some_and(|(is_bare, _)| is_bare),
                is_painted: meeting.is_some_and(|(is_bare, _)| !is_bare),
                is_detecting: detects,
                values: meeting.unwrap_or_default().1,
            });
        }
        Some(loaded)
    }

    /// The values of the material of a region at an energy; `None` for the world.
    fn values(
        &self,
        region: RegionId,
        energy: f64,
        photons: &mut BatchPhotons<'_>,
    ) -> Option<MaterialValues> {
        let medium = *self.detector.material_of.get(region.index())? as usize;
        let values = &mut photons.values[medium];
        if !values.is_at(energy) {
            values.set(&photons.tables[medium], energy);
        }
        (region.0 > 0).then_some(*values)
    }

    /// The boundary between two regions in lanes: true for a bare interface, false for paint, and the
    /// [values](Group::values); `None` for other boundaries.
    fn meeting(
        &self,
        regions: [RegionId; 2],
        (index, energy): (f64, f64),
        photons: &mut BatchPhotons<'_>,
    ) -> Option<(bool, [f64; 3])> {
        match self.detector.meetings.of(regions.map(|region| region.0)) {
            // the end of the world
            _ if regions[1].0 == 0 => None,
            Meeting::Bare => {
                let behind = self.values(regions[1], energy, photons)?.index?;
                Some((true, [index, behind, 0.0]))
            }
            Meeting::Painted(number, rule) => {
                Some((false, rule.values(&self.detector.surfaces[number as usize], energy)))
            }
            Meeting::Other => None,
        }
    }

    /// Makes the steps of all photons in lanes that are certain.
    fn step(&mut self, counts: &mut BoxStepCounts) -> Ends {
        let starts = &self.detector.starts;
        let world = World {
            seed: self.settings.seed,
            max_steps: self.settings.max_steps,
            max_time: self.settings.max_time,
            margin: self.cells.margin,
            zeros: self.cells.zeros,
            alone_lengths: starts.alone_lengths(),
            alone: &self.alone,
        };
        let (level, eight) = (self.level, &mut *self.eight);
        dispatch_wide!(level, simd => eight.step(simd, &world, counts))
    }

    /// Sets the cell of a photon that has passed a boundary; takes it out of its lane if it goes on elsewhere.
    fn cross(&mut self, lane: usize, ends: &Ends, photons: &mut BatchPhotons<'_>) {
        let (place, face) = (ends.place[lane] as usize % BOXES, ends.face[lane] as usize % 6);
        let number = self.eight.boxes.boxes[place].number[lane];
        let AxisBox { cell, around, .. } = self.cells.boxes[number as usize];
        let start = match place {
            0 => around.map(|(cell, place)| BoxStart { cell, place, face }),
            _ => cell.map(|cell| BoxStart { cell, place: 0, face }),
        };
        let energy = self.eight.energy[lane];
        if !start.is_some_and(|start| self.enter(lane, start, energy, photons)) {
            self.leave(lane, Some(self.start((number, face), place > 0)), photons);
        }
    }

    /// The start of a photon on a face of a box, given by their numbers, within the box or around it.
    fn start(&self, (number, face): (u32, usize), is_within: bool) -> Start {
        let AxisBox { surfaces, placement, .. } = &self.cells.boxes[number as usize];
        let inside = is_within != self.turned[6 * number as usize + face];
        Start { surface: surfaces[face], placement: *placement, inside }
    }
}

/// The bit mask of all lanes.
const ALL: u64 = (1 << LANES) - 1;

/// The lanes in a bit mask.
fn lanes_of(mut mask: u64) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let lane = (mask != 0).then(|| mask.trailing_zeros() as usize % LANES);
        mask &= mask.wrapping_sub(1);
        lane
    })
}
