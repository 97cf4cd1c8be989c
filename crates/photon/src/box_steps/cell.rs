//! The cells of eight photons, in lanes: boxes with the properties of their materials and surfaces.

use crate::rows::Row;
use rayweave_model::BoxCells;
use rayweave_shape::lanes::LANES;

/// The largest number of boxes of a cell.
pub(super) const BOXES: usize = BoxCells::MOST;

/// The largest number of processes in the material of a cell.
pub(super) const PATHS: usize = 2;

/// No cell.
pub(super) const NONE: u32 = u32::MAX;

/// A cell with the properties of its materials and surfaces at an energy.
#[derive(Clone, Copy, Debug)]
pub(super) struct LoadedCell {
    pub cell: u32,
    pub energy: f64,
    pub velocity: f64,
    /// The mean free paths of the processes, +inf for none, and whether they are absorption.
    pub paths: [(f64, bool); PATHS],
    boxes: [LoadedBox; BOXES],
    /// The number of boxes.
    count: usize,
    /// As those of eight photons, for the first of them.
    kinds: Kinds,
}

/// A box of a cell, as in [`Listed`].
#[derive(Clone, Copy, Debug)]
pub(super) struct LoadedBox {
    pub number: u32,
    pub is_lower: bool,
    pub is_bare: bool,
    pub is_painted: bool,
    pub is_detecting: bool,
    /// The translation into its frame, and the offsets of the low and of the high faces.
    pub faces: [[f64; 3]; 3],
    pub values: [f64; 3],
}

impl LoadedCell {
    /// A cell without boxes.
    pub const NONE: LoadedCell = LoadedCell {
        cell: NONE,
        energy: 0.0,
        velocity: 1.0,
        paths: [(f64::INFINITY, true); PATHS],
        boxes: [LoadedBox::NONE; BOXES],
        count: 0,
        kinds: Kinds::NONE,
    };

    /// Appends a box to the list.
    pub fn push(&mut self, own: LoadedBox) {
        let bit = |value: bool| u64::from(value) << (LANES * self.count);
        let LoadedBox { is_lower, is_bare, is_painted, is_detecting, .. } = own;
        let all = [true, is_lower, is_bare, is_painted, is_detecting];
        self.kinds.0.iter_mut().zip(all).for_each(|(mask, value)| *mask |= bit(value));
        self.boxes[self.count] = own;
        self.count += 1;
    }
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

/// Bit masks of the boxes of a kind in the cells of eight photons: bit 8 k + n belongs to the box at place k of photon n.
#[derive(Clone, Copy, Debug)]
struct Kinds([u64; 5]);

/// The bits of the first photon.
const FIRST: u64 = u64::MAX / 0xff;

impl Kinds {
    const NONE: Kinds = Kinds([0; 5]);

    /// The photons with a box of a kind at a place.
    #[inline(always)]
    fn at(&self, kind: usize, place: usize) -> u64 {
        self.0[kind] >> (LANES * place) & 0xff
    }
}

/// The boxes in the cells of eight photons, by their places in the lists.
#[derive(Clone, Debug)]
pub(super) struct CellRows {
    pub boxes: [Listed; BOXES],
    kinds: Kinds,
}

/// For each of eight photons, the box at a place in the list of its cell.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Listed {
    pub number: [u32; LANES],
    pub shift: [Row; 3],
    pub low: [Row; 3],
    pub high: [Row; 3],
    /// See [`Group::values`](crate::boundary::Group::values).
    pub values: [Row; 3],
}

impl Default for CellRows {
    fn default() -> CellRows {
        CellRows { boxes: [Listed::default(); BOXES], kinds: Kinds::NONE }
    }
}

impl CellRows {
    /// Bit mask of the lists that have a box at a place.
    #[inline(always)]
    pub fn present(&self, place: usize) -> u64 {
        self.kinds.at(0, place)
    }

    /// Bit mask of the boxes at a place that do not replace the box of the cell.
    #[inline(always)]
    pub fn lower(&self, place: usize) -> u64 {
        self.kinds.at(1, place)
    }

    /// Bit masks of the boundaries, where the photon crosses a face of the box at a place, that are bare, that are painted, and
    /// behind which photons are detected.
    #[inline(always)]
    pub fn boundaries(&self, place: usize) -> [u64; 3] {
        [2, 3, 4].map(|kind| self.kinds.at(kind, place))
    }

    /// Sets the cell of a photon.
    pub fn put(&mut self, lane: usize, own: &LoadedCell) {
        for (mask, bits) in self.kinds.0.iter_mut().zip(own.kinds.0) {
            *mask = *mask & !(FIRST << lane) | bits << lane;
        }
        for (row, listed) in self.boxes.iter_mut().zip(&own.boxes).take(own.count) {
            row.number[lane] = listed.number;
            let Listed { shift, low, high, .. } = row;
            for (rows, faces) in [shift, low, high].into_iter().zip(&listed.faces) {
                for k in 0..3 {
                    rows[k][lane] = faces[k];
                }
            }
            for k in 0..3 {
                row.values[k][lane] = listed.values[k];
            }
        }
    }
}
