//! Steps from face to face within boxes, such as crystals and light guides: eight photons at a time, each as long as it bounces.
//!
//! A photon that starts on a face of a box meets the faces of this box and of the few boxes within it. If its next crossing is
//! certain, if no scattering in the material comes first, and if the boundary is one that [lanes](crate::boundary) can apply, the
//! step needs neither a query nor memory: the photon stays in its lane until it is absorbed. The loop over all photons makes every
//! other step. Both compute the same bits.

use crate::boundary::{BARE_EVENTS, BoundaryEvent, Group, PAINTED_EVENTS};
use crate::detector::{Detector, Meeting};
use crate::draws::{LEAST_EXPONENTIAL, Words, free_path_uniforms};
use crate::flight::End;
use crate::free_path::shortest;
use crate::in_flight::{Mark, Numbers, Place};
use crate::material::{Bulk, MaterialValues, ValueTable};
use crate::photon::Photon;
use crate::rows::{Row, get, load, put, vector};
use crate::settings::RunSettings;
use fearless_simd::Simd;
use fearless_simd::prelude::*;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{AxisBox, BoxCell, BoxCells, BoxStart, PlacementId, RegionId, Start, SurfaceId};
use rayweave_shape::dispatch_wide;
use rayweave_shape::lanes::{LANES, Lanes, Mask, WideLevel, splat};

/// The largest number of boxes of a cell.
const BOXES: usize = BoxCells::MOST;

/// The largest number of processes in the material of a cell.
const PATHS: usize = 2;

/// The number of photons below which the loop over all photons is faster.
const FEW: u32 = 3;

/// No cell.
const NONE: u32 = u32::MAX;

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

/// The number of steps, and the events at their ends.
#[derive(Debug, Default)]
pub(crate) struct BoxStepCounts {
    pub steps: u64,
    bare: [u64; 3],
    painted: [u64; 3],
    /// The photons absorbed in materials, and at surfaces.
    absorbed: [u64; 2],
}

impl BoxStepCounts {
    /// The events that occurred, with their numbers.
    pub fn events(&self) -> impl Iterator<Item = (BoundaryEvent, u64)> {
        let bare = BARE_EVENTS.into_iter().zip(self.bare);
        let painted = PAINTED_EVENTS.into_iter().zip(self.painted);
        let absorbed = [(BoundaryEvent::Absorption, self.absorbed[1])];
        bare.chain(painted).chain(absorbed).filter(|(_, count)| *count > 0)
    }

    /// The ways in which photons ended, with their numbers.
    pub fn ends(&self) -> impl Iterator<Item = (End, u64)> {
        let ends = [End::Absorbed, End::SurfaceAbsorbed].into_iter().zip(self.absorbed);
        ends.filter(|(_, count)| *count > 0)
    }
}

/// Eight photons under way, with what they need of their cells.
#[derive(Debug)]
struct Eight {
    /// Bit mask of the lanes in use, and of the photons that have made a step.
    active: u64,
    moved: u64,
    /// The places of the photons in their batch.
    at: [usize; LANES],
    /// The surface on which each photon starts.
    start: [Start; LANES],
    cell: [u32; LANES],
    energy: Row,
    /// The last two cells of each lane, and the place of the last one: photons often go back to the one before.
    loaded: [[LoadedCell; 2]; LANES],
    last: [usize; LANES],
    position: [Row; 3],
    direction: [Row; 3],
    polarisation: [Row; 3],
    time: Row,
    /// The counters of the random numbers of the last step.
    counters: [Words; 3],
    /// The axis of the face of its own box on which each photon starts; 3 for none.
    axis: Row,
    velocity: Row,
    /// The mean free paths of the processes; +inf for none.
    paths: [Row; PATHS],
    /// Bit masks of the processes that are absorption.
    absorbs: [u64; PATHS],
    /// The boxes in the lists of the cells, by their places.
    boxes: [Listed; BOXES],
}

/// For each of eight photons, the box at a place in the list of its cell.
#[derive(Clone, Copy, Debug, Default)]
struct Listed {
    number: [u32; LANES],
    shift: [Row; 3],
    low: [Row; 3],
    high: [Row; 3],
    /// Bit mask of the lists that have a box at this place.
    present: u64,
    /// Bit mask of the boxes on which the photons start: they leave these.
    departed: u64,
    /// Bit mask of the boxes that do not replace the box of the cell.
    lower: u64,
    /// Bit masks of the kinds of boundaries where the photon crosses a face of the box.
    bare: u64,
    painted: u64,
    /// Bit mask of the boundaries behind which photons are detected.
    detecting: u64,
    /// See [`Group::values`].
    values: [Row; 3],
}

/// A cell with the properties of its materials and surfaces at an energy.
#[derive(Clone, Copy, Debug)]
struct LoadedCell {
    cell: u32,
    energy: f64,
    velocity: f64,
    /// The mean free paths of the processes, +inf for none, and whether they are absorption.
    paths: [(f64, bool); PATHS],
    boxes: [LoadedBox; BOXES],
    /// The number of boxes.
    count: usize,
}

/// A box of a cell, as in [`Listed`].
#[derive(Clone, Copy, Debug)]
struct LoadedBox {
    number: u32,
    is_lower: bool,
    is_bare: bool,
    is_painted: bool,
    is_detecting: bool,
    /// The translation into its frame, and the offsets of the low and of the high faces.
    faces: [[f64; 3]; 3],
    values: [f64; 3],
}

impl LoadedCell {
    const NONE: LoadedCell = LoadedCell {
        cell: NONE,
        energy: 0.0,
        velocity: 1.0,
        paths: [(f64::INFINITY, true); PATHS],
        boxes: [LoadedBox::NONE; BOXES],
        count: 0,
    };
}

impl LoadedBox {
    const NONE: LoadedBox = LoadedBox {
        number: 0,
        is_lower: false,
        is_bare: false,
        is_painted: false,
        is_detecting: false,
        faces: [[0.0; 3]; 3],
        values: [0.0; 3],
    };
}

/// The next crossings of eight photons.
struct Next<S: Simd> {
    t: Lanes<S>,
    /// The time of the next crossing after it, or an earlier one.
    second: Lanes<S>,
    /// The place of the box in the list of the cell.
    place: Lanes<S>,
    axis: Lanes<S>,
    /// The translation into the frame of the box along this axis, and the offset of the face.
    shift: Lanes<S>,
    offset: Lanes<S>,
    unsure: Mask<S>,
}

/// The ends of the steps of eight photons.
struct Ends {
    /// Bit masks of the photons that have made a step and go on, and of those behind the boundary.
    stepped: u64,
    behind: u64,
    /// Bit masks of the photons that were absorbed in a material, and at a surface.
    absorbed: [u64; 2],
    place: Row,
    face: Row,
}

/// The lines of flight of eight photons, by axes.
struct Lines<S: Simd> {
    origin: [Lanes<S>; 3],
    /// The absolute values of the directions, and where these are positive.
    size: [Lanes<S>; 3],
    rises: [Mask<S>; 3],
    /// The least time between two crossings that are certainly separate.
    apart: Lanes<S>,
}

/// The contacts of eight photons with faces.
struct FaceContact<S: Simd> {
    /// The numbers of the faces.
    face: Lanes<S>,
    /// The normals, against the photons.
    normal: [Row; 3],
    /// The points of the crossings, before and after their projection onto the faces.
    points: [Row; 3],
    on_face: [Row; 3],
    /// Bit mask of the photons for whose lengths the boxes of
    /// [`LaneContact`](rayweave_optics::start_surfaces::LaneContact) hold.
    near: u64,
}

/// Bit masks of the kinds of boundaries, as in [`Listed`].
struct Meetings {
    bare: u64,
    painted: u64,
    detecting: u64,
}

fn set(mask: &mut u64, lane: usize, value: bool) {
    *mask = *mask & !(1 << lane) | u64::from(value) << lane;
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
            for lane in 0..LANES {
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
            let active = self.eight.active;
            for lane in (0..LANES).filter(|lane| active >> lane & 1 == 1) {
                if (ends.absorbed[0] | ends.absorbed[1]) >> lane & 1 == 1 {
                    self.ended.push(self.eight.at[lane]);
                    self.eight.active &= !(1 << lane);
                } else if ends.stepped >> lane & 1 == 0 || !self.follow(lane, &ends, photons) {
                    self.leave(lane, photons);
                }
            }
        }
        for lane in 0..LANES {
            self.leave(lane, photons);
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
        (eight.at[lane], eight.start[lane]) = (at, start);
        put(&mut eight.position, lane, photon.position);
        put(&mut eight.direction, lane, photon.direction);
        put(&mut eight.polarisation, lane, photon.polarisation);
        eight.time[lane] = photon.time;
        for (row, word) in eight.counters.iter_mut().zip(photons.numbers.counter(&mark)) {
            row[lane] = u64::from(word);
        }
    }

    /// Takes a photon out of its lane.
    fn leave(&mut self, lane: usize, photons: &mut BatchPhotons<'_>) {
        let eight = &mut *self.eight;
        let (at, bit) = (eight.at[lane], 1 << lane);
        if eight.active & eight.moved & bit != 0 {
            let (photon, mark) = (&mut photons.photons[at], &mut photons.marks[at]);
            photon.position = get(&eight.position, lane);
            photon.direction = get(&eight.direction, lane);
            photon.polarisation = get(&eight.polarisation, lane);
            photon.time = eight.time[lane];
            mark.steps = eight.counters[2][lane] as u32;
            // all surfaces of boxes have one: see `new`
            mark.place = Place::on(&eight.start[lane], &self.detector.starts).unwrap_or(Place::UNKNOWN);
        }
        eight.active &= !bit;
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
        let eight = &mut *self.eight;
        eight.axis[lane] = if place == 0 { (face % 3) as f64 } else { 3.0 };
        for (k, listed) in eight.boxes.iter_mut().enumerate() {
            set(&mut listed.departed, lane, k == place);
        }
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
        let mut loaded = LoadedCell { cell, energy, velocity: values.velocity, ..LoadedCell::NONE };
        loaded.count = own.list.len().min(BOXES);
        for (k, &(mean, process)) in paths.iter().enumerate() {
            loaded.paths[k] = (mean, matches!(process, Bulk::Absorption));
        }
        for (place, &number) in own.list.iter().enumerate().take(BOXES) {
            let listed = &self.cells.boxes[number as usize];
            let behind = if place == 0 { own.behind } else { listed.region };
            let meeting = self.meeting([region, behind], (index, energy), photons);
            let detects = self.detector.is_detecting(self.settings.detection, behind);
            loaded.boxes[place] = LoadedBox {
                number,
                faces: [listed.shift.to_array(), listed.low, listed.high],
                is_lower: place > 0 && listed.region <= region,
                is_bare: meeting.is_some_and(|(is_bare, _)| is_bare),
                is_painted: meeting.is_some_and(|(is_bare, _)| !is_bare),
                is_detecting: detects,
                values: meeting.unwrap_or_default().1,
            };
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

    /// Sets the cell and the start of a photon after its step; false if it goes on elsewhere.
    fn follow(&mut self, lane: usize, ends: &Ends, photons: &mut BatchPhotons<'_>) -> bool {
        let (place, face) = (ends.place[lane] as usize % BOXES, ends.face[lane] as usize % 6);
        let is_behind = ends.behind >> lane & 1 == 1;
        let number = self.eight.boxes[place].number[lane];
        let AxisBox { surfaces, placement, cell, around, .. } = &self.cells.boxes[number as usize];
        self.eight.moved |= 1 << lane;
        let inside = ((place == 0) != is_behind) != self.turned[6 * number as usize + face];
        self.eight.start[lane] = Start { surface: surfaces[face], placement: *placement, inside };
        let start = match (is_behind, place) {
            (false, _) => Some(BoxStart { cell: self.eight.cell[lane], place, face }),
            (true, 0) => around.map(|(cell, place)| BoxStart { cell, place, face }),
            (true, _) => cell.map(|cell| BoxStart { cell, place: 0, face }),
        };
        let energy = self.eight.energy[lane];
        start.is_some_and(|start| self.enter(lane, start, energy, photons))
    }
}

/// The common data of the steps of all photons.
struct World<'d> {
    seed: u64,
    max_steps: u32,
    max_time: f64,
    /// See [`BoxCells`].
    margin: f64,
    zeros: [f64; 2],
    /// See [`StartSurfaces`](rayweave_optics::start_surfaces::StartSurfaces).
    alone_lengths: f64,
    /// For each face of each box, the points out of reach of all surfaces but its own.
    alone: &'d [Bounds],
}

/// Writes vectors in some lanes.
#[inline(always)]
fn write<S: Simd>(simd: S, rows: &mut [Row; 3], some: Mask<S>, values: &[Row; 3]) {
    for k in 0..3 {
        some.select(load(simd, &values[k]), load(simd, &rows[k])).store_array(&mut rows[k]);
    }
}

/// One of three numbers, by the number of an axis.
#[inline(always)]
fn at_axis<S: Simd>(axis: Lanes<S>, [x, y, z]: [Lanes<S>; 3]) -> Lanes<S> {
    axis.simd_eq(0.0).select(x, axis.simd_eq(1.0).select(y, z))
}

impl Default for Eight {
    fn default() -> Eight {
        let (zero, one) = ([0.0; LANES], [1.0; LANES]);
        let start = Start { surface: SurfaceId(0), placement: PlacementId(0), inside: false };
        Eight {
            active: 0,
            moved: 0,
            at: [0; LANES],
            start: [start; LANES],
            cell: [NONE; LANES],
            energy: zero,
            loaded: [[LoadedCell::NONE; 2]; LANES],
            last: [0; LANES],
            position: [zero; 3],
            // lanes that are not in use have a direction
            direction: [one; 3],
            polarisation: [one; 3],
            time: zero,
            counters: [[0; LANES]; 3],
            axis: zero,
            velocity: one,
            paths: [one; PATHS],
            absorbs: [0; PATHS],
            boxes: [Listed::default(); BOXES],
        }
    }
}

impl Listed {
    /// The heights of the photons above the low faces and below the high ones, in the frames of the boxes, by axes.
    #[inline(always)]
    fn heights<S: Simd>(&self, simd: S, origin: [Lanes<S>; 3]) -> [[Lanes<S>; 2]; 3] {
        let mut heights = [[origin[0]; 2]; 3];
        for k in 0..3 {
            let local = origin[k] + load(simd, &self.shift[k]);
            heights[k] = [local + load(simd, &self.low[k]), load(simd, &self.high[k]) - local];
        }
        heights
    }

    /// Bit mask of the photons that [`Eight::meet`] certainly has nothing to say about: the box is behind them, or they enter it after
    /// the time `t`. Most boxes are, and divisions are slow.
    #[inline(always)]
    fn out_of_reach<S: Simd>(
        &self,
        simd: S,
        &Lines { origin, size, rises, apart }: &Lines<S>,
        near: Lanes<S>,
        t: Lanes<S>,
    ) -> u64 {
        let heights = self.heights(simd, origin);
        // twice the least time between crossings, and more than the rounding errors of quotients
        let until = (t.max(splat(simd, 0.0)) + apart * 2.0) * (1.0 + 1e-9);
        let mut out = Mask::splat(simd, false);
        for k in 0..3 {
            let [below, above] = heights[k];
            out |= rises[k].select(above, below).simd_lt(near * -2.0);
            out |= (-rises[k].select(below, above)).simd_gt(until * size[k]);
        }
        out.to_bitmask()
    }
}

impl Eight {
    /// Puts one of the last two cells of a lane into it.
    fn put(&mut self, lane: usize, place: usize) {
        let own = &self.loaded[lane][place];
        self.last[lane] = place;
        (self.cell[lane], self.energy[lane], self.velocity[lane]) = (own.cell, own.energy, own.velocity);
        for (k, &(mean, absorbs)) in own.paths.iter().enumerate() {
            self.paths[k][lane] = mean;
            set(&mut self.absorbs[k], lane, absorbs);
        }
        for (place, (row, listed)) in self.boxes.iter_mut().zip(&own.boxes).enumerate() {
            set(&mut row.present, lane, place < own.count);
            if place >= own.count {
                continue;
            }
            row.number[lane] = listed.number;
            let Listed { shift, low, high, .. } = row;
            for (rows, faces) in [shift, low, high].into_iter().zip(&listed.faces) {
                for k in 0..3 {
                    rows[k][lane] = faces[k];
                }
            }
            set(&mut row.lower, lane, listed.is_lower);
            set(&mut row.bare, lane, listed.is_bare);
            set(&mut row.painted, lane, listed.is_painted);
            set(&mut row.detecting, lane, listed.is_detecting);
            for k in 0..3 {
                row.values[k][lane] = listed.values[k];
            }
        }
    }

    /// The first face that each photon crosses.
    #[inline(always)]
    fn next<S: Simd>(&self, simd: S, margin: f64) -> Next<S> {
        let (position, direction) = (vector(simd, &self.position), vector(simd, &self.direction));
        let (origin, d) = ([position.x, position.y, position.z], [direction.x, direction.y, direction.z]);
        let size = [d[0].abs(), d[1].abs(), d[2].abs()];
        let speed = size[0] + size[1] + size[2];
        let zero = splat(simd, 0.0);
        let rises = [d[0].simd_gt(zero), d[1].simd_gt(zero), d[2].simd_gt(zero)];
        let (near, apart) = (splat(simd, margin), splat(simd, margin) / speed);
        let (infinity, slow) = (splat(simd, f64::INFINITY), speed * BoxCells::SLOW);
        let axis = load(simd, &self.axis);
        let mut next = Next {
            t: infinity,
            second: infinity,
            place: zero,
            axis: zero,
            shift: zero,
            offset: zero,
            unsure: Mask::splat(simd, false),
        };
        let own = &self.boxes[0];
        let heights = own.heights(simd, origin);
        for k in 0..3 {
            let [below, above] = heights[k];
            // well within the box, or on one of its faces and away from it
            let (is_above, is_below) = (below.simd_gt(near), above.simd_gt(near));
            let leaves = axis.simd_eq(splat(simd, k as f64))
                & (is_above | (rises[k] & below.simd_gt(-near)))
                & (is_below | (!rises[k] & above.simd_gt(-near)));
            next.unsure |= !((is_above & is_below) | leaves) | !size[k].simd_gt(slow);
            let t = rises[k].select(above, below) / size[k] + 0.0;
            let is_closer = t.simd_lt(next.t);
            next.second = is_closer.select(next.t, next.second.min(t));
            next.t = is_closer.select(t, next.t);
            next.axis = is_closer.select(splat(simd, k as f64), next.axis);
            let offset = rises[k].select(load(simd, &own.high[k]), load(simd, &own.low[k]));
            next.offset = is_closer.select(offset, next.offset);
            next.shift = is_closer.select(load(simd, &own.shift[k]), next.shift);
        }
        for place in 1..BOXES {
            let other = &self.boxes[place];
            let met = other.present & !other.departed & self.active;
            if met == 0 {
                continue;
            }
            let lines = Lines { origin, size, rises, apart };
            let met = met & !other.out_of_reach(simd, &lines, near, next.t);
            if met != 0 {
                self.meet(simd, place, met, &lines, &mut next);
            }
        }
        next.unsure |= !next.second.simd_gt(next.t + apart);
        next
    }

    /// The entries of photons in a bit mask into the other boxes at a place.
    #[inline(always)]
    fn meet<S: Simd>(
        &self,
        simd: S,
        place: usize,
        met: u64,
        &Lines { origin, size, rises, apart }: &Lines<S>,
        next: &mut Next<S>,
    ) {
        let other = &self.boxes[place];
        let heights = other.heights(simd, origin);
        let (infinity, zero) = (splat(simd, f64::INFINITY), splat(simd, 0.0));
        let (mut from, mut to, mut axis) = (-infinity, infinity, zero);
        let (mut shift, mut offset) = (zero, zero);
        for k in 0..3 {
            let [below, above] = heights[k];
            let enter = -(rises[k].select(below, above) / size[k]) + 0.0;
            to = to.min(rises[k].select(above, below) / size[k] + 0.0);
            let is_later = enter.simd_gt(from);
            from = is_later.select(enter, from);
            axis = is_later.select(splat(simd, k as f64), axis);
            let face = rises[k].select(load(simd, &other.low[k]), load(simd, &other.high[k]));
            offset = is_later.select(face, offset);
            shift = is_later.select(load(simd, &other.shift[k]), shift);
        }
        let passes = Mask::from_bitmask(simd, met) & from.simd_lt(to) & !to.simd_lt(-apart);
        let is_ahead = from.simd_gt(apart);
        next.unsure |= passes & !is_ahead;
        let t = (passes & is_ahead).select(from, infinity);
        let is_closer = t.simd_lt(next.t);
        next.second = next.second.min(is_closer.select(next.t.min(to), t));
        next.unsure |= is_closer & Mask::from_bitmask(simd, other.lower);
        next.t = is_closer.select(t, next.t);
        next.place = is_closer.select(splat(simd, place as f64), next.place);
        next.axis = is_closer.select(axis, next.axis);
        next.offset = is_closer.select(offset, next.offset);
        next.shift = is_closer.select(shift, next.shift);
    }

    /// Makes the steps that are certain.
    #[inline(always)]
    fn step<S: Simd>(&mut self, simd: S, world: &World<'_>, counts: &mut BoxStepCounts) -> Ends {
        let next = self.next(simd, world.margin);
        let mut counters = self.counters;
        let (mut limited, limit) = (0, u64::from(world.max_steps));
        for lane in 0..LANES {
            limited |= u64::from(counters[2][lane] >= limit) << lane;
            counters[2][lane] += 1;
        }
        let known = self.active & !limited & !next.unsure.to_bitmask();
        let [long, absorbed] = self.free(simd, world, (known, &counters), next.t);
        counts.absorbed[0] += u64::from(absorbed.count_ones());
        let time = load(simd, &self.time) + next.t / load(simd, &self.velocity);
        let reached = known & long & time.simd_le(splat(simd, world.max_time)).to_bitmask();
        let contact = self.contact(simd, world, &next);
        let mut ends = Ends {
            stepped: 0,
            behind: 0,
            absorbed: [absorbed, 0],
            place: next.place.to_array(),
            face: contact.face.to_array(),
        };
        let mut group = Group {
            direction: self.direction,
            polarisation: self.polarisation,
            normal: contact.normal,
            counters,
            ..Group::default()
        };
        let met = self.boundaries(simd, next.place, &mut group);
        let met = Meetings { bare: met.bare & reached, painted: met.painted & reached, ..met };
        let alone = self.alone(world, (met.bare | met.painted) & contact.near, &ends, &contact.points);
        self.apply(simd, world.seed, (&mut group, &met, alone), (&mut ends, &mut *counts));
        let stepped = Mask::from_bitmask(simd, ends.stepped);
        write(simd, &mut self.position, stepped, &contact.on_face);
        stepped.select(time, load(simd, &self.time)).store_array(&mut self.time);
        for lane in 0..LANES {
            self.counters[2][lane] += ends.stepped >> lane & 1;
        }
        let ended = ends.absorbed[0] | ends.absorbed[1];
        counts.steps += u64::from((ends.stepped | ended).count_ones());
        ends
    }

    /// Of the photons in a bit mask those whose free paths lead to the boundary at the times `t`, and those that are absorbed before.
    /// The first bit mask may have others.
    #[inline(always)]
    fn free<S: Simd>(
        &self,
        simd: S,
        world: &World<'_>,
        (known, counters): (u64, &[Words; 3]),
        t: Lanes<S>,
    ) -> [u64; 2] {
        let uniforms = free_path_uniforms(*counters, world.seed);
        let mut is_long = Mask::splat(simd, true);
        for k in 0..PATHS {
            let rest = splat(simd, 1.0) - load(simd, &uniforms[k]);
            let least = load(simd, &self.paths[k]) * rest * LEAST_EXPONENTIAL;
            is_long &= least.simd_gt(t);
        }
        let (mut long, mut absorbed) = (is_long.to_bitmask(), 0);
        let short = known & !long;
        if short == 0 {
            return [long, absorbed];
        }
        let times = t.to_array();
        for lane in (0..LANES).filter(|lane| short >> lane & 1 == 1) {
            let paths = (0..PATHS).map(|k| (self.paths[k][lane], self.absorbs[k] >> lane & 1 == 1));
            let (free, absorbs) = shortest(paths, uniforms.map(|row| row[lane]), times[lane]);
            let absorbs = absorbs == Some(true);
            if free >= times[lane] {
                long |= 1 << lane;
            } else if absorbs && self.time[lane] + free / self.velocity[lane] <= world.max_time {
                absorbed |= 1 << lane;
            }
        }
        [long, absorbed]
    }

    /// The contacts with the faces, by the operations of [`Group::touch`].
    #[inline(always)]
    fn contact<S: Simd>(&self, simd: S, world: &World<'_>, next: &Next<S>) -> FaceContact<S> {
        let &Next { t, place, axis, .. } = next;
        let (origin, direction) = (vector(simd, &self.position), vector(simd, &self.direction));
        let point = origin.plus(direction.times(t));
        let lengths = origin.taxicab() + t.abs() * direction.taxicab();
        let near = lengths.simd_le(splat(simd, world.alone_lengths)).to_bitmask();
        let d = at_axis(axis, [direction.x, direction.y, direction.z]);
        let local = at_axis(axis, [origin.x, origin.y, origin.z]) + next.shift + d * t;
        let rises = d.simd_gt(splat(simd, 0.0));
        let leaves = place.simd_eq(splat(simd, 0.0));
        let is_high = !(leaves ^ rises);
        let across = at_axis(axis, [point.x, point.y, point.z]);
        let on_face = is_high.select(across - (local - next.offset), across + (-local - next.offset));
        let (low, high) = (splat(simd, world.zeros[0]), splat(simd, world.zeros[1]));
        let flat = leaves.select(rises.select(-high, -low), rises.select(low, high));
        let against = rises.select(splat(simd, -1.0), splat(simd, 1.0));
        let points = [point.x.to_array(), point.y.to_array(), point.z.to_array()];
        let mut contact = FaceContact {
            face: is_high.select(axis + 3.0, axis),
            normal: points,
            on_face: points,
            points,
            near,
        };
        for k in 0..3 {
            let is_across = axis.simd_eq(splat(simd, k as f64));
            is_across.select(against, flat).store_array(&mut contact.normal[k]);
            is_across.select(on_face, load(simd, &points[k])).store_array(&mut contact.on_face[k]);
        }
        contact
    }

    /// The kinds of the boundaries at the boxes at some places; sets the values of the group.
    #[inline(always)]
    fn boundaries<S: Simd>(&self, simd: S, place: Lanes<S>, group: &mut Group) -> Meetings {
        let mut met = Meetings { bare: 0, painted: 0, detecting: 0 };
        let mut values = [splat(simd, 0.0); 3];
        for k in 0..BOXES {
            let listed = &self.boxes[k];
            let here = place.simd_eq(splat(simd, k as f64));
            let bits = here.to_bitmask() & self.active;
            if bits == 0 {
                continue;
            }
            met.bare |= listed.bare & bits;
            met.painted |= listed.painted & bits;
            met.detecting |= listed.detecting & bits;
            for j in 0..3 {
                values[j] = here.select(load(simd, &listed.values[j]), values[j]);
            }
        }
        for j in 0..3 {
            values[j].store_array(&mut group.values[j]);
        }
        met
    }

    /// Applies the processes at the boundaries; `alone` is a bit mask of the photons out of reach of other surfaces.
    #[inline(always)]
    fn apply<S: Simd>(
        &mut self,
        simd: S,
        seed: u64,
        (group, met, alone): (&mut Group, &Meetings, u64),
        (ends, counts): (&mut Ends, &mut BoxStepCounts),
    ) {
        let (bare, painted) = (met.bare & alone, met.painted);
        if painted != 0 {
            let mut paint = *group;
            simd.vectorize(
                #[inline(always)]
                || paint.meet_paint(simd, seed),
            );
            // absorption needs no contact
            ends.absorbed[1] = painted & paint.lost & !paint.detected & !paint.unsure;
            counts.absorbed[1] += u64::from(ends.absorbed[1].count_ones());
            let stepped = painted & alone & !paint.unsure & !paint.lost;
            let stepped = stepped & !(paint.is_behind & met.detecting);
            ends.stepped = stepped;
            ends.behind = stepped & paint.is_behind;
            count(&mut counts.painted, stepped, paint.events);
            self.depart(simd, stepped, &paint);
        }
        if bare != 0 {
            simd.vectorize(
                #[inline(always)]
                || group.meet_interface(simd, seed, bare),
            );
            let stepped = bare & !group.unsure & !(group.is_behind & met.detecting);
            ends.stepped |= stepped;
            ends.behind |= stepped & group.is_behind;
            count(&mut counts.bare, stepped, group.events);
            self.depart(simd, stepped, group);
        }
    }

    /// Sets the directions and polarisations of the photons in a bit mask to those after their boundaries.
    #[inline(always)]
    fn depart<S: Simd>(&mut self, simd: S, some: u64, group: &Group) {
        let some = Mask::from_bitmask(simd, some);
        write(simd, &mut self.direction, some, &group.direction);
        write(simd, &mut self.polarisation, some, &group.polarisation);
    }

    /// Bit mask of those of the photons in `some` that reach points out of reach of all surfaces but their own.
    #[inline(always)]
    fn alone(&self, world: &World<'_>, some: u64, ends: &Ends, points: &[Row; 3]) -> u64 {
        let mut alone = 0;
        for lane in (0..LANES).filter(|lane| some >> lane & 1 == 1) {
            let number = self.boxes[ends.place[lane] as usize % BOXES].number[lane];
            let at = 6 * number as usize + ends.face[lane] as usize;
            let Some(Bounds { lo, hi }) = world.alone.get(at) else { continue };
            let mut is_alone = true;
            for k in 0..3 {
                // without branches, which nobody can predict
                is_alone &= (lo[k] <= points[k][lane]) & (points[k][lane] <= hi[k]);
            }
            alone |= u64::from(is_alone) << lane;
        }
        alone
    }
}

/// Counts the events of the photons in a bit mask.
#[inline(always)]
fn count(counts: &mut [u64; 3], some: u64, [first, second]: [u64; 2]) {
    let masks = [some & first, some & !first & second, some & !first & !second];
    for (count, mask) in counts.iter_mut().zip(masks) {
        *count += u64::from(mask.count_ones());
    }
}
