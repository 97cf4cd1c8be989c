//! Copies of a volume, selected by their path.

use crate::detector::Detector;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{
    GroupPoint, LeafId, LeafKind, Occurrence, PathStep, PlacementId, Program, PrototypeId, facets_contain,
};
use rayweave_scene::bare_name;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::fmt;
use std::sync::Arc;

/// Some of the copies of a volume.
#[derive(Clone)]
pub(super) struct SelectedCopies {
    program: Arc<Program>,
    /// Their shapes.
    shapes: BTreeSet<(u32, u32)>,
    /// Boxes with the placements whose groups are evaluated there; 0 for shapes of the model itself.
    boxes: Vec<(Bounds, PlacementId)>,
}

/// Without the program, which contains the SIMD level of the processor: parts of runs are identified by this text.
impl fmt::Debug for SelectedCopies {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let SelectedCopies { program: _, shapes, boxes } = self;
        f.debug_struct("SelectedCopies").field("shapes", shapes).field("boxes", boxes).finish_non_exhaustive()
    }
}

/// The result of a search for the copies with a path.
pub(super) enum Selection {
    /// The regions of the volume, and its copies with the path; `None` if these are all of them.
    Volume(BTreeSet<u32>, Option<SelectedCopies>),
    /// The paths of the volume in the last step, none of which matches; empty if there is no such volume.
    Unknown(Vec<String>),
}

/// Finds the copies whose path ends with `text`, for example `Module[1]/Crystal` for all crystals in the second module. A step without
/// a number matches all copies.
pub(super) fn select(detector: &Detector, text: &str) -> Selection {
    let program = &detector.program;
    let names: HashSet<&str> = detector.region_names.iter().skip(1).map(|name| bare_name(name)).collect();
    let mut volume = None;
    let (mut chosen, mut others) = (BTreeMap::new(), BTreeSet::new());
    for occurrence in program.occurrences() {
        let path = program.occurrence_path(occurrence).placed();
        // steps behind the last volume belong to its shape
        let Some(last) = path.steps().iter().rposition(|step| names.contains(step.name)) else { continue };
        let (steps, inner) = path.steps().split_at(last + 1);
        match (0..steps.len()).any(|first| matches(&steps[first..], text)) {
            true => {
                volume = Some(steps[last].name);
                let placement = if inner.is_empty() { occurrence.placement } else { PlacementId(0) };
                chosen.insert(occurrence, placement);
            }
            false if text.ends_with(']') || text.contains('/') => {
                if is_last_step(&steps[last], text) {
                    others.insert(steps.iter().map(ToString::to_string).collect::<Vec<_>>().join("/"));
                }
            }
            false => {}
        }
    }
    let Some(volume) = volume else { return Selection::Unknown(others.into_iter().collect()) };
    let is_all = others.is_empty();
    let copies = (!is_all).then(|| SelectedCopies::new(program, chosen));
    let regions = detector.region_names.iter().zip(0..).skip(1);
    Selection::Volume(regions.filter(|(name, _)| bare_name(name) == volume).map(|(_, k)| k).collect(), copies)
}

/// True if the steps of a path are those of a text; numbers may be left out there.
fn matches(steps: &[PathStep<'_>], text: &str) -> bool {
    let Some((first, inner)) = steps.split_first() else { return false };
    [first.to_string(), without_number(first)].iter().any(|step| match text.strip_prefix(step.as_str()) {
        Some("") => inner.is_empty(),
        Some(rest) => rest.strip_prefix('/').is_some_and(|rest| matches(inner, rest)),
        None => false,
    })
}

/// True if a text ends with a step of the same name.
fn is_last_step(step: &PathStep<'_>, text: &str) -> bool {
    let without_copy = match text.rsplit_once('[') {
        Some((name, number)) if number.ends_with(']') => name,
        _ => text,
    };
    without_copy
        .strip_suffix(&without_number(step))
        .is_some_and(|rest| rest.is_empty() || rest.ends_with('/'))
}

fn without_number(step: &PathStep<'_>) -> String {
    let text = step.to_string();
    let number = step.copy.map_or(String::new(), |copy| format!("[{copy}]"));
    let end = match step.ordinal {
        0 => number,
        ordinal => format!("{number}#{}", u64::from(ordinal) + 1),
    };
    text.strip_suffix(&end).unwrap_or(&text).to_owned()
}

impl SelectedCopies {
    fn new(program: &Arc<Program>, chosen: BTreeMap<Occurrence, PlacementId>) -> SelectedCopies {
        let shapes = chosen.keys().map(|own| (own.placement.0, own.leaf.0)).collect();
        let mut boxes: BTreeMap<PlacementId, Bounds> = BTreeMap::new();
        for (occurrence, placement) in chosen {
            let own = || {
                let (map, group) = program.placement(occurrence.placement);
                match occurrence.placement {
                    PlacementId(0) => program.leaf_bounds(occurrence.leaf),
                    _ => program.prototype(group).bounds.transformed(&map),
                }
            };
            match placement {
                PlacementId(0) => {
                    let all = boxes.entry(placement).or_insert(Bounds::EMPTY);
                    *all = all.union(&own());
                }
                _ => {
                    boxes.entry(placement).or_insert_with(own);
                }
            }
        }
        let boxes = boxes.into_iter().map(|(placement, bounds)| (bounds, placement)).collect();
        SelectedCopies { program: program.clone(), shapes, boxes }
    }

    /// A box around the copies.
    pub fn bounds(&self) -> Bounds {
        self.boxes.iter().fold(Bounds::EMPTY, |all, (own, _)| all.union(own))
    }

    /// True if a point lies in one of the copies; `regions` are the regions of the volume.
    pub fn contain(&self, regions: &BTreeSet<u32>, point: Vec3) -> bool {
        let near = self.boxes.iter().filter(|(bounds, _)| bounds.contains(point));
        near.into_iter().any(|(_, placement)| {
            let (_, group) = self.program.placement(*placement);
            let places = self.program.descend(*placement);
            let local = places.fold(GroupPoint::world(point), |outer, place| outer.placed(&place));
            let outputs = self.outputs(group, placement.0, &local);
            match placement {
                PlacementId(0) => {
                    let output = |region: &u32| outputs.get(*region as usize - 1).copied();
                    regions.iter().filter_map(output).any(|is_inside| is_inside)
                }
                _ => outputs.first().copied().unwrap_or(false),
            }
        })
    }

    /// The outputs of a group at a point in its frame, without shapes of other copies and volumes. `placement` is that of the group.
    fn outputs(&self, group: PrototypeId, placement: u32, point: &GroupPoint) -> Vec<bool> {
        let prototype = self.program.prototype(group);
        let first = prototype.leaves.start;
        let is_inside = |leaf: LeafId| {
            let number = first + leaf.0;
            let leaf = self.program.leaf(LeafId(number));
            match leaf.kind() {
                LeafKind::Shape { .. } => {
                    self.shapes.contains(&(placement, number))
                        && facets_contain(&self.program, leaf.facets(), point)
                }
                LeafKind::Instance { prototype, placement: own } => {
                    let own = placement + own;
                    let end = own + self.program.prototype(prototype).placements;
                    self.shapes.range((own, 0)..(end, 0)).next().is_some()
                        && self.outputs(prototype, own, &point.placed(&leaf.place()))[0]
                }
            }
        };
        let mut values = Vec::new();
        prototype.expression.evaluate(is_inside, &mut values);
        let outputs = prototype.expression.outputs().iter();
        outputs.map(|edge| values[edge.node().index()] ^ edge.is_complemented()).collect()
    }
}
