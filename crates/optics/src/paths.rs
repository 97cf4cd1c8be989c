//! The ways that light takes: which elements it meets, one after the other, and where it is thrown back.

use crate::segments::{Event, Segments};
use rayweave_math::Vec3;
use std::collections::HashMap;

/// The ways of many rays, gathered chunk by chunk. In a lens, ghosts are the ways with two reflections.
#[derive(Clone, Debug, Default)]
pub struct Paths {
    steps: Vec<Step>,
    known: HashMap<Step, u32>,
    rays: Vec<u64>,
    power: Vec<f64>,
    /// Light on ways that are not told apart any more.
    others: (u64, f64),
}

/// A segment on a way: the steps before, and what is met at its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Step {
    before: u32,
    /// Whether the light was thrown back where the segment begins.
    is_back: bool,
    element: i32,
}

/// No step before.
const FIRST: u32 = u32::MAX;
/// A way that is not told from others.
const OTHER: u32 = u32::MAX - 1;
/// So many steps are told apart.
const MOST: usize = 1 << 20;

/// A way that light took.
#[derive(Clone, Debug, PartialEq)]
pub struct Path {
    /// The elements that were met, -1 for none (light that escaped, or was not followed any more), and whether the light was
    /// thrown back there.
    pub steps: Vec<(i32, bool)>,
    /// The number of rays that end on it.
    pub rays: u64,
    /// Their power where their last segments begin.
    pub power: f64,
}

impl Path {
    /// How often the light was thrown back.
    pub fn reflections(&self) -> usize {
        self.steps.iter().filter(|step| step.1).count()
    }

    /// The names of the elements in order, reflections marked by a `*`, nothing by a `-`.
    pub fn text(&self, elements: &[String]) -> String {
        let name = |element: i32| {
            usize::try_from(element).ok().and_then(|k| elements.get(k)).map_or("-", String::as_str)
        };
        let step = |&(element, is_back): &(i32, bool)| {
            format!("{}{}", name(element), if is_back { "*" } else { "" })
        };
        self.steps.iter().map(step).collect::<Vec<String>>().join(" ")
    }
}

impl Paths {
    /// Adds the segments of some rays, all of each: the parents of each row stand before it. Segments that are left out
    /// ([`crate::Keep::Ends`], escaped ones) are missed.
    pub fn add(&mut self, segments: &Segments) {
        let mut steps: Vec<Step> = Vec::with_capacity(segments.len());
        let mut goes_on = vec![false; segments.len()];
        for row in 0..segments.len() {
            let parent = usize::try_from(segments.parent[row]).ok().filter(|&parent| parent < row);
            let element = segments.element[row];
            let step = match parent {
                None => Step { before: FIRST, is_back: false, element },
                // a piece of a curve goes on with what the piece before began
                Some(parent) if segments.event[parent] == Event::Curved as u8 => {
                    Step { element, ..steps[parent] }
                }
                Some(parent) => {
                    let is_back = is_back(segments, parent, row);
                    Step { before: self.number(steps[parent]), is_back, element }
                }
            };
            parent.into_iter().for_each(|parent| goes_on[parent] = true);
            steps.push(step);
        }
        for row in (0..segments.len()).filter(|&row| !goes_on[row]) {
            let way = self.number(steps[row]);
            self.end(way, segments.intensity[row]);
        }
    }

    fn number(&mut self, step: Step) -> u32 {
        if let Some(&known) = self.known.get(&step) {
            return known;
        }
        if step.before == OTHER || self.steps.len() == MOST {
            return OTHER;
        }
        let number = self.steps.len() as u32;
        self.steps.push(step);
        self.rays.push(0);
        self.power.push(0.0);
        self.known.insert(step, number);
        number
    }

    fn end(&mut self, way: u32, power: f64) {
        if way == OTHER {
            self.others = (self.others.0 + 1, self.others.1 + power);
            return;
        }
        self.rays[way as usize] += 1;
        self.power[way as usize] += power;
    }

    /// The ways, that with the most power first.
    pub fn list(&self) -> Vec<Path> {
        let ended = (0..self.steps.len()).filter(|&way| self.rays[way] > 0);
        let mut found: Vec<Path> = ended.map(|way| self.path(way)).collect();
        found.sort_by(|a, b| b.power.total_cmp(&a.power));
        found
    }

    /// The number of rays and the power on ways that are not in the list, after a million steps on different ways.
    pub fn others(&self) -> (u64, f64) {
        self.others
    }

    fn path(&self, way: usize) -> Path {
        let (mut steps, mut at, mut is_back) = (Vec::new(), way as u32, false);
        while at != FIRST {
            let step = self.steps[at as usize];
            // a step says whether it begins with a reflection: at the element that the one before ends at
            steps.push((step.element, is_back));
            (at, is_back) = (step.before, step.is_back);
        }
        steps.reverse();
        Path { steps, rays: self.rays[way], power: self.power[way] }
    }
}

/// Whether a segment begins with a reflection. Of the two rays after a split it is the one that stays in its medium and turns;
/// within a gradient, where the index changes on the way, that cannot be told.
fn is_back(segments: &Segments, parent: usize, row: usize) -> bool {
    let direction = |row: usize| {
        let [x, y, z] = segments.direction.each_ref();
        Vec3::new(x[row], y[row], z[row])
    };
    let event = segments.event[parent];
    let is = |some: Event| event == some as u8;
    let turns = || direction(parent) != direction(row) && segments.index[parent] == segments.index[row];
    is(Event::Reflected) || is(Event::TotallyReflected) || is(Event::Scattered) || is(Event::Split) && turns()
}
