//! Ray paths (ghost analysis): the sequences of elements that light hits, with its reflections.

use crate::segments::{Event, Segments};
use rayweave_math::Vec3;
use std::collections::HashMap;

/// The ray paths of a run, gathered chunk by chunk. In a lens, ghosts are the paths with two reflections.
#[derive(Clone, Debug, Default)]
pub struct Paths {
    steps: Vec<PathStep>,
    known: HashMap<PathStep, u32>,
    rays: Vec<u64>,
    power: Vec<f64>,
    /// The number of rays and the power on paths beyond the limit.
    others: (u64, f64),
}

/// A segment of a path: the steps before it, and the element at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct PathStep {
    before: u32,
    /// The surface of the reflection with which the segment begins; none without a reflection.
    reflected_at: Option<i32>,
    element: i32,
}

/// No step before.
const FIRST: u32 = u32::MAX;
/// A path beyond the limit.
const OTHER: u32 = u32::MAX - 1;
/// The greatest number of distinct steps.
const MAX_STEPS: usize = 1 << 20;

/// A ray path: the sequence of elements that light hits.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// The numbers of the elements, -1 for none (light that escaped or was dropped), and whether
    /// the light was reflected there.
    pub steps: Vec<(i32, bool)>,
    /// The numbers of the surfaces of the reflections in order, as in the column `surface` of the segments. Paths that differ
    /// only in these are different paths.
    pub reflected_at: Vec<i32>,
    /// The number of rays that end on this path.
    pub rays: u64,
    /// The power of these rays at the start of their last segments.
    pub power: f64,
}

impl Path {
    /// The number of reflections.
    pub fn reflections(&self) -> usize {
        self.steps.iter().filter(|step| step.1).count()
    }

    /// The names of the elements in order; a `*` marks reflections, a `-` means no element.
    pub fn text(&self, elements: &[String]) -> String {
        let name = |element: i32| {
            usize::try_from(element).ok().and_then(|k| elements.get(k)).map_or("-", String::as_str)
        };
        let step = |&(element, is_reflected): &(i32, bool)| {
            format!("{}{}", name(element), if is_reflected { "*" } else { "" })
        };
        self.steps.iter().map(step).collect::<Vec<String>>().join(" ")
    }
}

impl Paths {
    /// Adds all segments of some rays; the parent of each row must come before it. Segments left out of the
    /// table ([`crate::Keep::Ends`], escaped light) are missing from the paths.
    pub fn add(&mut self, segments: &Segments) {
        let mut steps: Vec<PathStep> = Vec::with_capacity(segments.len());
        let mut goes_on = vec![false; segments.len()];
        for row in 0..segments.len() {
            let parent = usize::try_from(segments.parent[row]).ok().filter(|&parent| parent < row);
            let element = segments.element[row];
            let step = match parent {
                None => PathStep { before: FIRST, reflected_at: None, element },
                // a piece of a curve continues the step of the piece before it
                Some(parent) if segments.event[parent] == Event::Curved as u8 => {
                    PathStep { element, ..steps[parent] }
                }
                Some(parent) => {
                    let reflected_at =
                        is_reflected(segments, parent, row).then_some(segments.surface[parent]);
                    PathStep { before: self.number(steps[parent]), reflected_at, element }
                }
            };
            parent.into_iter().for_each(|parent| goes_on[parent] = true);
            steps.push(step);
        }
        for row in (0..segments.len()).filter(|&row| !goes_on[row]) {
            let path = self.number(steps[row]);
            self.end(path, segments.intensity[row]);
        }
    }

    fn number(&mut self, step: PathStep) -> u32 {
        if let Some(&known) = self.known.get(&step) {
            return known;
        }
        if step.before == OTHER || self.steps.len() == MAX_STEPS {
            return OTHER;
        }
        let number = self.steps.len() as u32;
        self.steps.push(step);
        self.rays.push(0);
        self.power.push(0.0);
        self.known.insert(step, number);
        number
    }

    fn end(&mut self, path: u32, power: f64) {
        if path == OTHER {
            self.others = (self.others.0 + 1, self.others.1 + power);
            return;
        }
        self.rays[path as usize] += 1;
        self.power[path as usize] += power;
    }

    /// The paths in order of decreasing power.
    pub fn list(&self) -> Vec<Path> {
        let ended = (0..self.steps.len()).filter(|&path| self.rays[path] > 0);
        let mut found: Vec<Path> = ended.map(|path| self.path(path)).collect();
        found.sort_by(|a, b| b.power.total_cmp(&a.power));
        found
    }

    /// The number of rays and the power on paths that are not in the list: paths that appear after
    /// 2^20 distinct steps.
    pub fn others(&self) -> (u64, f64) {
        self.others
    }

    fn path(&self, path: usize) -> Path {
        let (mut steps, mut at, mut is_reflected) = (Vec::new(), path as u32, false);
        let mut reflected_at = Vec::new();
        while at != FIRST {
            let step = self.steps[at as usize];
            // a step that begins with a reflection was reflected at the element of the previous step
            steps.push((step.element, is_reflected));
            reflected_at.extend(step.reflected_at);
            (at, is_reflected) = (step.before, step.reflected_at.is_some());
        }
        steps.reverse();
        reflected_at.reverse();
        Path { steps, reflected_at, rays: self.rays[path], power: self.power[path] }
    }
}

/// True if a segment begins with a reflection. After a split, the reflected ray is the one that
/// stays in its medium and changes direction. Reflections within a gradient, where the index
/// varies, are not detected.
pub(crate) fn is_reflected(segments: &Segments, parent: usize, row: usize) -> bool {
    let direction = |row: usize| {
        let [x, y, z] = segments.direction.each_ref();
        Vec3::new(x[row], y[row], z[row])
    };
    let event = segments.event[parent];
    let is = |some: Event| event == some as u8;
    let turns = || direction(parent) != direction(row) && segments.index[parent] == segments.index[row];
    is(Event::Reflected) || is(Event::TotallyReflected) || is(Event::Scattered) || is(Event::Split) && turns()
}
