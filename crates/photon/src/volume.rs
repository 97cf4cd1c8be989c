//! Paths of volumes: the names and copy numbers of the placements that lead to a volume.

use crate::detector::{Detector, NO_COPY};
use rayweave_model::Face;
use rayweave_scene::bare_name;
use rayweave_shape::Ray;
use rustc_hash::FxHashMap;
use std::collections::HashMap;
use std::sync::Arc;

/// The path of a volume and its copy number: that of the innermost placement with a number, or -1 without one. `face` is a face of the volume,
/// or of a volume placed in it, as crossings at the ends of a step through the volume have it.
fn volume_path(detector: &Detector, region: u32, face: Option<Face>) -> (String, i64) {
    let own = bare_name(&detector.region_names[region as usize]);
    let Some(face) = face else { return (own.to_owned(), NO_COPY) };
    let path = detector.program.occurrence_path(face.occurrence()).placed();
    let steps = path.steps();
    let is_other = |name: &str| detector.region_names.iter().any(|region| bare_name(region) == name);
    let length = match steps.iter().rposition(|step| step.name == own) {
        Some(last) => last + 1,
        // a face of a daughter of the world, or of a mother whose own name is not part of the path
        None if steps.last().is_none_or(|step| is_other(step.name)) => 0,
        None => steps.len(),
    };
    let names: Vec<String> = steps[..length].iter().map(ToString::to_string).collect();
    let copy = steps[..length].iter().rev().find_map(|step| step.copy);
    match names.is_empty() {
        true => (own.to_owned(), NO_COPY),
        false => (names.join("/"), copy.unwrap_or(NO_COPY)),
    }
}

/// The copy number of the innermost step of a path with one, as in `module[3]/crystal`; -1 without one.
fn stated_copy(path: &str) -> i64 {
    let copy = |step: &str| step.strip_suffix(']')?.rsplit_once('[')?.1.parse().ok();
    path.rsplit('/').find_map(copy).unwrap_or(NO_COPY)
}

/// The distinct paths of volumes, numbered in the order of their appearance.
#[derive(Clone, Debug, Default)]
pub(crate) struct VolumePaths {
    /// Shared by all lists of a thread, so that tables know them by their addresses.
    names: Vec<Arc<str>>,
    /// The copy number of each path.
    copies: Vec<i64>,
    /// The numbers of the paths; those of the last ones may be missing until the next search for a path.
    numbers: HashMap<Arc<str>, u32>,
    /// The numbers of paths of other lists by their addresses, with the paths, so that no other one gets an address: parts of a run
    /// share the paths of their thread.
    shared: FxHashMap<usize, (Arc<str>, u32)>,
    /// The numbers by region, and by placement and leaf of a face: paths are made once.
    known: FxHashMap<(u32, Option<[u32; 2]>), u32>,
}

impl PartialEq for VolumePaths {
    fn eq(&self, other: &VolumePaths) -> bool {
        self.names == other.names
    }
}

impl VolumePaths {
    /// The paths by number.
    pub fn names(&self) -> &[Arc<str>] {
        &self.names
    }

    /// The copy number of each path, -1 without one.
    pub fn copies(&self) -> &[i64] {
        &self.copies
    }

    /// The number of the path of a volume ([`volume_path`]), of which `face` is a face.
    pub fn number(&mut self, detector: &Detector, region: u32, face: Option<Face>) -> u32 {
        let key = (region, face.map(|face| [face.placement.0, face.leaf.0]));
        if let Some(&number) = self.known.get(&key) {
            return number;
        }
        let (path, copy) = volume_path(detector, region, face);
        let number = self.insert(&path.into(), copy);
        self.known.insert(key, number);
        number
    }

    /// The number of the path of a volume that a ray enters at its origin; `face` is one of a crossing there, which may belong to
    /// another volume.
    pub fn number_entered(&mut self, detector: &Detector, region: u32, face: Face, ray: &Ray) -> u32 {
        let key = (region, Some([face.placement.0, face.leaf.0]));
        if let Some(&number) = self.known.get(&key) {
            return number;
        }
        if detector.is_of(region, face) {
            return self.number(detector, region, Some(face));
        }
        // not the same for the next ray at this face
        match detector.own_face(region, ray) {
            Some(own) => self.number(detector, region, Some(own)),
            None => {
                let (path, copy) = volume_path(detector, region, Some(face));
                self.insert(&path.into(), copy)
            }
        }
    }

    /// The number of a path that a file states. Its copy number is the last one in it.
    pub fn number_of(&mut self, path: &str) -> u32 {
        match self.numbers.get(path) {
            Some(&number) => number,
            None => self.insert(&path.into(), stated_copy(path)),
        }
    }

    /// Adds the paths of another list; returns the number of each of them.
    pub fn absorb(&mut self, other: &VolumePaths) -> Vec<u32> {
        other.names.iter().zip(&other.copies).map(|(path, &copy)| self.shared_number(path, copy)).collect()
    }

    /// The number of a path of another list.
    fn shared_number(&mut self, path: &Arc<str>, copy: i64) -> u32 {
        let address = path.as_ptr() as usize;
        if let Some(&(_, number)) = self.shared.get(&address) {
            return number;
        }
        let number = self.insert(path, copy);
        self.shared.insert(address, (path.clone(), number));
        number
    }

    /// The paths that `used` has, in this order, without the others; replaces the numbers.
    pub fn used_by(&self, used: &mut [u32]) -> VolumePaths {
        let mut ordered = VolumePaths::default();
        let mut numbers = vec![u32::MAX; self.names.len()];
        for number in used {
            let (old, new) = (*number as usize, ordered.names.len() as u32);
            if numbers[old] == u32::MAX {
                // the paths are distinct: most lists of a run are never searched
                numbers[old] = new;
                ordered.names.push(self.names[old].clone());
                ordered.copies.push(self.copies[old]);
            }
            *number = numbers[old];
        }
        ordered
    }

    /// Numbers the paths in a given order, those that it lacks behind them, and replaces the numbers.
    pub fn renumber_by(&mut self, order: &[(String, i64)], used: &mut [u32]) {
        let mut ordered = VolumePaths::default();
        for (path, copy) in order {
            ordered.insert(&path.as_str().into(), *copy);
        }
        let numbers = ordered.absorb(self);
        used.iter_mut().for_each(|number| *number = numbers[*number as usize]);
        *self = ordered;
    }

    fn insert(&mut self, path: &Arc<str>, copy: i64) -> u32 {
        for number in self.numbers.len()..self.names.len() {
            self.numbers.insert(self.names[number].clone(), number as u32);
        }
        if let Some(&number) = self.numbers.get(path) {
            return number;
        }
        let number = self.names.len() as u32;
        self.names.push(path.clone());
        self.copies.push(copy);
        self.numbers.insert(path.clone(), number);
        number
    }
}
