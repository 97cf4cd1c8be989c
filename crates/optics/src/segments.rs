//! The traced light as a table: one row for each ray segment between two events, and the power balance.

use rayweave_math::Vec3;
use rayweave_shape::lanes::LANES;
use std::ops::Range;

/// The event at the end of a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Event {
    /// The light leaves the system; the end point is NaN.
    Escaped = 0,
    /// Transmission into another medium, or straight through a splitting sheet.
    Transmitted = 1,
    /// Reflection.
    Reflected = 2,
    /// Total internal reflection.
    TotallyReflected = 3,
    /// Division into a reflected and a transmitted ray.
    Split = 4,
    /// Absorption.
    Absorbed = 5,
    /// Passage through a sheet in the same direction.
    Passed = 6,
    /// Diffuse or rough scattering into a random direction.
    Scattered = 7,
    /// Deflection by a thin lens or a grating.
    Bent = 8,
    /// Continuation along a curve in a medium with a gradient index, whose pieces are separate rows.
    Curved = 9,
}

impl Event {
    /// All events in the order of their numbers.
    pub const ALL: [Event; 10] = [
        Event::Escaped,
        Event::Transmitted,
        Event::Reflected,
        Event::TotallyReflected,
        Event::Split,
        Event::Absorbed,
        Event::Passed,
        Event::Scattered,
        Event::Bent,
        Event::Curved,
    ];

    /// The name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Event::Escaped => "escaped",
            Event::Transmitted => "transmitted",
            Event::Reflected => "reflected",
            Event::TotallyReflected => "totally reflected",
            Event::Split => "split",
            Event::Absorbed => "absorbed",
            Event::Passed => "passed",
            Event::Scattered => "scattered",
            Event::Bent => "bent",
            Event::Curved => "curved",
        }
    }
}

/// A segment of a ray of light between two events.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// The number of the ray of the source.
    pub id: i64,
    /// The row of the previous segment; -1 for the first one.
    pub parent: i64,
    /// The number of events before it.
    pub generation: u32,
    /// The number of the source.
    pub source: u32,
    /// The vacuum wavelength in nanometres.
    pub wavelength_nm: f64,
    /// The power at its start.
    pub intensity: f64,
    /// The refractive index of the medium; in a gradient the index at its end.
    pub index: f64,
    /// The start point.
    pub start: Vec3,
    /// The end point; NaN for escaped light.
    pub end: Vec3,
    /// The direction, of unit length; in a gradient the direction at its end.
    pub direction: Vec3,
    /// The optical path length (the integral of the index over the length) from the source to its
    /// end, or to its start for escaped light.
    pub path: f64,
    /// The number of the element at its end; -1 for none.
    pub element: i32,
    /// The number of the surface at its end; -1 for none.
    pub surface: i32,
    /// The event at its end.
    pub event: Event,
}

/// A segment of each ray of a bundle, with the same event at their ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BundleRows<'a> {
    pub id: [i64; LANES],
    pub parent: [i64; LANES],
    pub generation: [u32; LANES],
    pub source: &'a [u32; LANES],
    pub wavelength_nm: &'a [f64; LANES],
    pub intensity: &'a [f64; LANES],
    pub index: [f64; LANES],
    pub start: [[f64; LANES]; 3],
    pub end: [[f64; LANES]; 3],
    pub direction: [[f64; LANES]; 3],
    pub path: [f64; LANES],
    pub element: usize,
    pub surface: usize,
    pub event: Event,
}

/// Segments as columns of equal length; see [`Segment`] for their meaning.
#[derive(Clone, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "the fields of Segment")]
pub struct Segments {
    pub id: Vec<i64>,
    pub parent: Vec<i64>,
    pub generation: Vec<u32>,
    pub source: Vec<u32>,
    pub wavelength_nm: Vec<f64>,
    pub intensity: Vec<f64>,
    pub index: Vec<f64>,
    pub start: [Vec<f64>; 3],
    pub end: [Vec<f64>; 3],
    pub direction: [Vec<f64>; 3],
    pub path: Vec<f64>,
    pub element: Vec<i32>,
    pub surface: Vec<i32>,
    pub event: Vec<u8>,
}

impl Segments {
    /// The number of rows.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// True if there are no rows.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// True if the ray of a row has met the elements `wanted` in this order, and no others, with the last of them at the end
    /// of this row. Elements that transmit it undeviated do not count; every segment of the ray has to be kept.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn followed(&self, row: usize, wanted: &[usize]) -> bool {
        let mut left = wanted.iter().rev();
        let mut at = row as i64;
        while at >= 0 {
            let here = at as usize;
            let is_straight = self.event[here] == Event::Passed as u8 && here != row;
            if !is_straight && left.next().map(|&element| element as i32) != Some(self.element[here]) {
                return false;
            }
            at = self.parent[here];
        }
        left.next().is_none()
    }

    /// The size of a row in bytes.
    pub const ROW: u64 = 15 * 8 + 4 * 4 + 1;

    /// Reserves memory for a number of additional rows.
    pub fn reserve(&mut self, rows: usize) {
        self.id.reserve(rows);
        self.parent.reserve(rows);
        self.generation.reserve(rows);
        self.source.reserve(rows);
        self.wavelength_nm.reserve(rows);
        self.intensity.reserve(rows);
        self.index.reserve(rows);
        for columns in [&mut self.start, &mut self.end, &mut self.direction] {
            columns.iter_mut().for_each(|column| column.reserve(rows));
        }
        self.path.reserve(rows);
        self.element.reserve(rows);
        self.surface.reserve(rows);
        self.event.reserve(rows);
    }

    /// Appends a row for each ray of a bundle.
    #[inline(always)]
    pub(crate) fn extend_bundle(&mut self, rows: &BundleRows<'_>) {
        self.id.extend_from_slice(&rows.id);
        self.parent.extend_from_slice(&rows.parent);
        self.generation.extend_from_slice(&rows.generation);
        self.source.extend_from_slice(rows.source);
        self.wavelength_nm.extend_from_slice(rows.wavelength_nm);
        self.intensity.extend_from_slice(rows.intensity);
        self.index.extend_from_slice(&rows.index);
        for k in 0..3 {
            self.start[k].extend_from_slice(&rows.start[k]);
            self.end[k].extend_from_slice(&rows.end[k]);
            self.direction[k].extend_from_slice(&rows.direction[k]);
        }
        self.path.extend_from_slice(&rows.path);
        self.element.extend_from_slice(&[rows.element as i32; LANES]);
        self.surface.extend_from_slice(&[rows.surface as i32; LANES]);
        self.event.extend_from_slice(&[rows.event as u8; LANES]);
    }

    /// Appends a range of other rows, with parents unchanged.
    pub(crate) fn append_range(&mut self, other: &Segments, rows: Range<usize>) {
        self.id.extend_from_slice(&other.id[rows.clone()]);
        self.parent.extend_from_slice(&other.parent[rows.clone()]);
        self.generation.extend_from_slice(&other.generation[rows.clone()]);
        self.source.extend_from_slice(&other.source[rows.clone()]);
        self.wavelength_nm.extend_from_slice(&other.wavelength_nm[rows.clone()]);
        self.intensity.extend_from_slice(&other.intensity[rows.clone()]);
        self.index.extend_from_slice(&other.index[rows.clone()]);
        for k in 0..3 {
            self.start[k].extend_from_slice(&other.start[k][rows.clone()]);
            self.end[k].extend_from_slice(&other.end[k][rows.clone()]);
            self.direction[k].extend_from_slice(&other.direction[k][rows.clone()]);
        }
        self.path.extend_from_slice(&other.path[rows.clone()]);
        self.element.extend_from_slice(&other.element[rows.clone()]);
        self.surface.extend_from_slice(&other.surface[rows.clone()]);
        self.event.extend_from_slice(&other.event[rows]);
    }

    /// Removes all rows and keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.id.clear();
        self.parent.clear();
        self.generation.clear();
        self.source.clear();
        self.wavelength_nm.clear();
        self.intensity.clear();
        self.index.clear();
        for columns in [&mut self.start, &mut self.end, &mut self.direction] {
            columns.iter_mut().for_each(Vec::clear);
        }
        self.path.clear();
        self.element.clear();
        self.surface.clear();
        self.event.clear();
    }

    /// Removes the last row.
    pub(crate) fn pop(&mut self) {
        self.id.pop();
        self.parent.pop();
        self.generation.pop();
        self.source.pop();
        self.wavelength_nm.pop();
        self.intensity.pop();
        self.index.pop();
        for columns in [&mut self.start, &mut self.end, &mut self.direction] {
            columns.iter_mut().for_each(|column| _ = column.pop());
        }
        self.path.pop();
        self.element.pop();
        self.surface.pop();
        self.event.pop();
    }

    /// Appends a row.
    pub fn push(&mut self, row: Segment) {
        self.id.push(row.id);
        self.parent.push(row.parent);
        self.generation.push(row.generation);
        self.source.push(row.source);
        self.wavelength_nm.push(row.wavelength_nm);
        self.intensity.push(row.intensity);
        self.index.push(row.index);
        for k in 0..3 {
            self.start[k].push(row.start[k]);
            self.end[k].push(row.end[k]);
            self.direction[k].push(row.direction[k]);
        }
        self.path.push(row.path);
        self.element.push(row.element);
        self.surface.push(row.surface);
        self.event.push(row.event as u8);
    }

    /// Appends other rows and offsets their parents, which count from 0, to the new row numbers.
    pub fn append(&mut self, other: &Segments) {
        let before = self.len();
        self.append_range(other, 0..other.len());
        for row in self.parent[before..].iter_mut().filter(|row| **row >= 0) {
            *row += before as i64;
        }
    }

    /// Row number `i`.
    pub fn get(&self, i: usize) -> Segment {
        let vector = |columns: &[Vec<f64>; 3]| Vec3::new(columns[0][i], columns[1][i], columns[2][i]);
        Segment {
            id: self.id[i],
            parent: self.parent[i],
            generation: self.generation[i],
            source: self.source[i],
            wavelength_nm: self.wavelength_nm[i],
            intensity: self.intensity[i],
            index: self.index[i],
            start: vector(&self.start),
            end: vector(&self.end),
            direction: vector(&self.direction),
            path: self.path[i],
            element: self.element[i],
            surface: self.surface[i],
            event: Event::ALL[usize::from(self.event[i])],
        }
    }

    /// All rows.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = Segment> + '_ {
        (0..self.len()).map(|i| self.get(i))
    }
}

/// The power balance of a run: emitted, absorbed, escaped and dropped power.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Balance {
    /// The power of the sources.
    pub emitted: f64,
    /// The power absorbed at the surfaces of each element.
    pub absorbed: Vec<f64>,
    /// The power absorbed in media.
    pub absorbed_in_media: f64,
    /// The power of escaped light.
    pub escaped: f64,
    /// The power of dropped rays: below the threshold, or at the limit of generations.
    pub dropped: f64,
}

impl Balance {
    /// An empty balance of a system with a number of elements.
    pub(crate) fn of_elements(count: usize) -> Balance {
        Balance { absorbed: vec![0.0; count], ..Balance::default() }
    }

    /// The unaccounted power: 0 except for rounding.
    pub fn error(&self) -> f64 {
        let ends = self.absorbed.iter().sum::<f64>() + self.absorbed_in_media + self.escaped + self.dropped;
        self.emitted - ends
    }

    /// Adds another balance of the same system.
    pub fn add(&mut self, other: &Balance) {
        self.emitted += other.emitted;
        self.absorbed.resize(self.absorbed.len().max(other.absorbed.len()), 0.0);
        self.absorbed.iter_mut().zip(&other.absorbed).for_each(|(sum, part)| *sum += part);
        self.absorbed_in_media += other.absorbed_in_media;
        self.escaped += other.escaped;
        self.dropped += other.dropped;
    }
}
