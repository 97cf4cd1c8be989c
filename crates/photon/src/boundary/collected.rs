//! Photons at boundaries, eight at a time: the operations of [`Boundary::apply`](super::Boundary) in the same order, and so the same
//! bits. The kernels of the processes are in [`bare`](super::bare) and [`painted`](super::painted).

use super::event::BoundaryEvent;
use super::lanes::{Contacts, Group};
use super::{bare, painted};
use crate::philox::Counter;
use crate::rows::get;
use fearless_simd::Simd;
use rayweave_math::Vec3;
use rayweave_optics::start_surfaces::StartSurfaces;
use rayweave_shape::dispatch_wide;
use rayweave_shape::lanes::{LANES, WideLevel};

/// Photons at boundaries of one kind.
#[derive(Debug)]
pub(crate) struct LaneBoundaries {
    level: Option<WideLevel>,
    kind: Kind,
    groups: Vec<Group>,
    count: usize,
}

/// A kind of boundaries.
#[derive(Clone, Copy, Debug)]
enum Kind {
    /// Bare polished interfaces between two dielectrics.
    Bare,
    /// Paint and metal that reflect by one rule.
    Painted,
}

/// A photon in front of a boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AtBoundary {
    pub direction: Vec3,
    pub polarisation: Vec3,
    /// Against the direction.
    pub normal: Vec3,
    pub surface: LaneSurface,
    /// The counter of its random numbers.
    pub counter: Counter,
    pub position: Vec3,
    /// The time of the crossing.
    pub t: f64,
    /// The place of the surface in the list of planes and spheres, if it is at one of them.
    pub contact: Option<u32>,
}

/// The surface in front of a photon.
#[derive(Clone, Copy, Debug)]
pub(crate) enum LaneSurface {
    /// An interface, with the indices in front of it and behind it.
    Bare([f64; 2]),
    /// Paint or metal, with its [values](super::Reflection::values).
    Painted([f64; 3]),
}

/// A photon after the process.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Departed {
    pub event: BoundaryEvent,
    pub direction: Vec3,
    pub polarisation: Vec3,
    pub is_behind: bool,
    /// The contact with a plane or a sphere.
    pub contact: Option<SurfacePoint>,
}

/// The contact of a photon with a plane or a sphere.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SurfacePoint {
    /// The point of the crossing, projected onto the surface.
    pub position: Vec3,
    /// True if the photon comes from the side where f < 0.
    pub is_rising: bool,
    /// True if it comes from the side where f > 0.
    pub is_falling: bool,
    /// True if certainly no other surface is within reach of the point.
    pub is_alone: bool,
}

impl LaneBoundaries {
    /// Of bare interfaces.
    pub fn bare() -> LaneBoundaries {
        LaneBoundaries::new(Kind::Bare)
    }

    /// Of painted surfaces.
    pub fn painted() -> LaneBoundaries {
        LaneBoundaries::new(Kind::Painted)
    }

    fn new(kind: Kind) -> LaneBoundaries {
        LaneBoundaries { level: WideLevel::widest(), kind, groups: Vec::new(), count: 0 }
    }

    /// Removes all photons. Their groups stay for the next ones: lanes that are not in use have former numbers.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds a photon; returns its number. `None` on processors without wide vectors.
    #[inline]
    pub fn push(&mut self, photon: &AtBoundary) -> Option<u32> {
        self.level?;
        let (number, lane) = (self.count / LANES, self.count % LANES);
        if number == self.groups.len() {
            self.groups.push(Group::default());
        }
        let group = &mut self.groups[number];
        if lane == 0 {
            group.has_contact = 0;
        }
        for k in 0..3 {
            group.direction[k][lane] = photon.direction[k];
            group.polarisation[k][lane] = photon.polarisation[k];
            group.normal[k][lane] = photon.normal[k];
            group.position[k][lane] = photon.position[k];
            group.counters[k][lane] = u64::from(photon.counter[k]);
        }
        let values = match photon.surface {
            LaneSurface::Bare([index, behind]) => [index, behind, 0.0],
            LaneSurface::Painted(values) => values,
        };
        for k in 0..3 {
            group.values[k][lane] = values[k];
        }
        group.t[lane] = photon.t;
        if let Some(contact) = photon.contact {
            group.contact[lane] = contact;
            group.has_contact |= 1 << lane;
        }
        self.count += 1;
        Some(self.count as u32 - 1)
    }

    /// Applies the process to all photons; `starts` has the planes and spheres that they may be at.
    pub fn apply(&mut self, seed: u64, starts: &StartSurfaces) {
        let contacts = (starts.lane_contacts(), starts.alone_lengths());
        let Some(level) = self.level else { return };
        let (groups, count) = (&mut self.groups[..self.count.div_ceil(LANES)], self.count);
        match self.kind {
            Kind::Bare => dispatch_wide!(level, simd => apply_bare(simd, groups, (seed, count), contacts)),
            Kind::Painted => dispatch_wide!(level, simd => apply_painted(simd, groups, seed, contacts)),
        }
    }

    /// A photon after the process, by its number; `None` if the scalar process is needed.
    #[inline]
    pub fn get(&self, number: u32) -> Option<Departed> {
        let group = self.groups.get(number as usize / LANES)?;
        let lane = number as usize % LANES;
        let bit = |mask: u64| mask >> lane & 1 == 1;
        if bit(group.unsure) {
            return None;
        }
        let [first, second, third] = match self.kind {
            Kind::Bare => bare::EVENTS,
            Kind::Painted => painted::EVENTS,
        };
        let event = match group.events.map(bit) {
            _ if bit(group.detected) => BoundaryEvent::Detection,
            _ if bit(group.lost) => BoundaryEvent::Absorption,
            [true, _] => first,
            [false, true] => second,
            [false, false] => third,
        };
        Some(Departed {
            event,
            direction: get(&group.direction, lane),
            polarisation: get(&group.polarisation, lane),
            is_behind: bit(group.is_behind),
            contact: bit(group.has_contact).then(|| SurfacePoint {
                position: get(&group.position, lane),
                is_rising: bit(group.rising),
                is_falling: bit(group.falling),
                is_alone: bit(group.alone),
            }),
        })
    }
}

/// A loop, not a closure, which would be compiled without the wide vectors.
#[inline(always)]
fn apply_bare<S: Simd>(simd: S, groups: &mut [Group], (seed, count): (u64, usize), contacts: Contacts<'_>) {
    for (k, group) in groups.iter_mut().enumerate() {
        let used = !0u64 >> (64 - (count - k * LANES).min(LANES));
        // the contacts need the directions before the process
        if group.has_contact != 0 {
            group.touch(simd, contacts);
        }
        group.meet_interface(simd, seed, used);
    }
}

/// As [`apply_bare`].
#[inline(always)]
fn apply_painted<S: Simd>(simd: S, groups: &mut [Group], seed: u64, contacts: Contacts<'_>) {
    for group in groups {
        if group.has_contact != 0 {
            group.touch(simd, contacts);
        }
        group.meet_paint(simd, seed);
    }
}
