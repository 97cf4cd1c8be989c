//! Decomposition of regions into the copies and operands of their unions, each with its box.

use crate::AnalysisError;
use rayweave_math::{Affine, Bounds};
use rayweave_model::{Node, Program, Region, Solid};

/// A part of a region.
#[derive(Clone, Debug)]
pub struct Part {
    pub region: usize,
    pub solid: Solid,
    pub bounds: Bounds,
    /// The number of the copy, for placed solids.
    pub copy: Option<usize>,
}

/// The maximum number of parts of a region; a region with more parts is not divided.
const MAX_PARTS: usize = 1 << 16;

/// All parts of all regions.
pub fn parts(regions: &[Region], boxes: &[Bounds]) -> Result<Vec<Part>, AnalysisError> {
    let mut all = Vec::new();
    for (region, (own, bounds)) in regions.iter().zip(boxes).enumerate() {
        let found = taken_apart(&own.solid)?;
        match found {
            Some(found) => all.extend(found.into_iter().map(|piece| Part { region, ..piece })),
            None => all.push(Part { region, solid: own.solid.clone(), bounds: *bounds, copy: None }),
        }
    }
    Ok(all)
}

/// A solid still to be divided, with its placement.
struct Waiting {
    solid: Solid,
    map: Affine,
    copy: Option<usize>,
}

fn taken_apart(solid: &Solid) -> Result<Option<Vec<Part>>, AnalysisError> {
    let mut waiting = vec![Waiting { solid: solid.clone(), map: Affine::IDENTITY, copy: None }];
    let (mut parts, mut copies) = (Vec::new(), 0);
    let mut boxes = Vec::new();
    while let Some(Waiting { solid, map, copy }) = waiting.pop() {
        if parts.len() + waiting.len() > MAX_PARTS {
            return Ok(None);
        }
        if let Some((own, inner)) = solid.node().single_map() {
            waiting.push(Waiting { solid: inner.clone(), map: own.then(&map), copy });
            continue;
        }
        match solid.node() {
            Node::Union(all) => {
                waiting.extend(all.iter().rev().map(|solid| Waiting { solid: solid.clone(), map, copy }));
            }
            Node::Named(_, inner) => waiting.push(Waiting { solid: inner.clone(), map, copy }),
            Node::Placed(inner, maps) => {
                let first = copies;
                copies += maps.len();
                if parts.len() + waiting.len() + maps.len() > MAX_PARTS {
                    return Ok(None);
                }
                waiting.extend(maps.iter().enumerate().rev().map(|(k, own)| Waiting {
                    solid: inner.clone(),
                    map: own.then(&map),
                    copy: Some(first + k),
                }));
            }
            _ => {
                let bounds = box_of(&solid, &mut boxes)?.transformed(&map);
                if !bounds.is_empty() {
                    parts.push(Part { region: 0, solid: solid.apply(map), bounds, copy });
                }
            }
        }
    }
    Ok(Some(parts))
}

/// The box of a solid in local coordinates. Copies are consecutive, so the last few solids are cached.
fn box_of(solid: &Solid, known: &mut Vec<(Solid, Bounds)>) -> Result<Bounds, AnalysisError> {
    if let Some((_, bounds)) = known.iter().rev().take(64).find(|(own, _)| own.is_same(solid)) {
        return Ok(*bounds);
    }
    let bounds = Program::compile(solid)?.bounds();
    known.push((solid.clone(), bounds));
    Ok(bounds)
}

/// The axis along which the boxes overlap least: a sweep along it meets the fewest boxes at a time.
fn sweep_axis(parts: &[Part]) -> usize {
    let all = parts.iter().fold(Bounds::EMPTY, |all, part| all.union(&part.bounds));
    let mean = |axis: usize| {
        let width: f64 = parts.iter().map(|part| part.bounds.size()[axis]).sum();
        width / all.size()[axis].max(f64::MIN_POSITIVE)
    };
    (0..3).min_by(|&a, &b| mean(a).total_cmp(&mean(b))).unwrap_or(0)
}

/// The pairs of boxes that overlap in more than a face, found by a sweep along an axis: O(n log n) for scattered boxes.
/// `wanted` selects pairs; those beyond `most` are only counted.
pub fn overlapping_pairs(
    parts: &[Part],
    distance: f64,
    wanted: impl Fn(&Part, &Part) -> bool,
    most: usize,
) -> OverlappingPairs {
    let axis = sweep_axis(parts);
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by(|&a, &b| parts[a].bounds.lo[axis].total_cmp(&parts[b].bounds.lo[axis]));
    let mut found = OverlappingPairs::default();
    let mut open: Vec<usize> = Vec::new();
    for k in order {
        let own = &parts[k];
        open.retain(|&j| parts[j].bounds.hi[axis] > own.bounds.lo[axis] + distance);
        for &j in &open {
            let common = own.bounds.intersection(&parts[j].bounds);
            let is_met = !common.is_empty() && common.size().min_element() > distance;
            if is_met && wanted(own, &parts[j]) {
                found.count += 1;
                if found.pairs.len() < most {
                    found.pairs.push((k.min(j), k.max(j), common));
                }
            }
        }
        open.push(k);
    }
    found.pairs.sort_by_key(|&(a, b, _)| (a, b));
    found
}

/// Pairs of parts with overlapping boxes.
#[derive(Default)]
pub struct OverlappingPairs {
    /// The parts by number, with the intersection of their boxes.
    pub pairs: Vec<(usize, usize, Bounds)>,
    /// The total number of pairs.
    pub count: usize,
}
