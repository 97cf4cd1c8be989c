//! The time line of one ray through a scene: its leaves, their count, regions and media.

use crate::{DrawError, Timeline};
use rayweave_math::Affine;
use rayweave_model::{Collected, Crossing, Evaluator, Node, Program, Query, RegionId, Solid};
use rayweave_rootray::{RootRay, Side};
use rayweave_scene::{Compiled, Scene};
use rayweave_shape::{Ray, RayError};
use std::sync::Arc;

/// The maximum number of rows of operands.
const MAX_OPERANDS: usize = 40;

/// Up to this number of operands, all of them are shown, even if the ray does not cross them.
const FEW_OPERANDS: usize = 8;

/// The maximum number of nodes that are visited: with shared parts, the number of leaves can be exponential.
const MAX_NODES: usize = 10_000;

/// The time line of a ray: a wave for each leaf, the count of leaves that contain the ray, and bands for regions and media.
///
/// The leaves are those of the solids of the regions, or of the solid from which `compiled` was made; `make` constructs
/// evaluators. A placed solid counts as one leaf. Leaves with the same name and the same wave are drawn and counted once. If
/// there are many leaves, only those that the ray crosses are drawn. Above 40 leaves, the waves are those of the regions'
/// solids; above 40 regions, there are none.
///
/// # Errors
///
/// [`DrawError::Compile`], [`DrawError::Scene`] if the scene has no solid with this name.
pub fn ray_timeline<E: Evaluator>(
    scene: &Scene,
    solid: Option<&str>,
    compiled: &Compiled,
    ray: Ray,
    make: impl Fn(Arc<Program>) -> E,
) -> Result<Timeline, DrawError> {
    let mut timeline = Timeline::new();
    let operands = operands(scene, solid)?;
    let shows_all = operands.len() <= FEW_OPERANDS;
    let mut drawn: Vec<(String, RootRay)> = Vec::new();
    for (name, operand) in operands {
        let alone = make(Arc::new(Program::compile(&operand)?));
        let row = (name, wave(&alone, ray)?);
        let is_touched = row.1.start() == Side::Inside || !row.1.roots().is_empty();
        if (shows_all || is_touched) && !drawn.contains(&row) {
            timeline.operand(&row.0, &row.1);
            drawn.push(row);
        }
    }
    let answer = answer(&make(compiled.program.clone()), ray)?;
    let start = answer.starts[0];
    if let [region] = compiled.program.regions() {
        timeline.result(&region.name, &wave_of(start, answer.of(0))?);
    } else {
        let name = |region| compiled.region_name(region).unwrap_or("");
        let changes = answer.of(0).iter().map(|crossing| (crossing.t, name(crossing.after)));
        timeline.bands("region", name(start), changes)?;
    }
    let medium = |region| compiled.medium_name(region);
    let changes = answer.of(0).iter().map(|crossing| (crossing.t, medium(crossing.after)));
    timeline.bands("medium", medium(start), changes)?;
    Ok(timeline)
}

/// The operands with their names.
fn operands(scene: &Scene, solid: Option<&str>) -> Result<Vec<(String, Solid)>, DrawError> {
    let whole: Vec<(String, Solid)> = match solid {
        Some(name) => vec![(name.to_owned(), scene.find_solid(name)?.clone())],
        None => scene.regions.iter().map(|region| (region.name.clone(), region.solid.clone())).collect(),
    };
    let leaves = leaves(&whole);
    let few_regions = Some(whole).filter(|rows| rows.len() <= MAX_OPERANDS);
    Ok(leaves.or(few_regions).unwrap_or_default())
}

/// A node of a solid with its inherited name and transform.
struct Part {
    solid: Solid,
    name: Option<Arc<str>>,
    world_from_local: Affine,
}

impl Part {
    /// Another solid with the same name and transform.
    fn with(&self, solid: &Solid) -> Part {
        Part { solid: solid.clone(), name: self.name.clone(), world_from_local: self.world_from_local }
    }

    fn is_same(&self, other: &Part) -> bool {
        self.solid.is_same(&other.solid) && self.world_from_local == other.world_from_local
    }
}

/// The distinct leaves of solids in the order of declaration; `None` if there are too many.
fn leaves(solids: &[(String, Solid)]) -> Option<Vec<(String, Solid)>> {
    let part = |(_, solid): &(String, Solid)| Part {
        solid: solid.clone(),
        name: None,
        world_from_local: Affine::IDENTITY,
    };
    let mut waiting: Vec<Part> = solids.iter().rev().map(part).collect();
    let mut seen: Vec<Part> = Vec::new();
    for _ in 0..MAX_NODES {
        let Some(part) = waiting.pop() else {
            return Some(seen.into_iter().map(row).collect());
        };
        if let Some((map, inner)) = part.solid.node().single_map() {
            let world_from_local = map.then(&part.world_from_local);
            waiting.push(Part { world_from_local, ..part.with(inner) });
            continue;
        }
        match part.solid.node() {
            Node::Empty | Node::Universe | Node::Primitive(_) | Node::Placed(..) => {
                if !seen.iter().any(|other| other.is_same(&part)) {
                    seen.push(part);
                }
            }
            Node::Named(name, inner) => {
                waiting.push(Part { name: Some(name.clone()), ..part.with(inner) });
            }
            node => waiting.extend(node.operand_refs().rev().map(|operand| part.with(operand))),
        }
        if seen.len() > MAX_OPERANDS {
            return None;
        }
    }
    None
}

fn row(leaf: Part) -> (String, Solid) {
    let kind = match leaf.solid.node() {
        Node::Primitive(primitive) => primitive.name(),
        Node::Placed(..) => "placed",
        Node::Empty => "empty",
        _ => "universe",
    };
    let name = leaf.name.as_deref().unwrap_or(kind).to_owned();
    (name, leaf.solid.apply(leaf.world_from_local))
}

/// The root-ray of a solid.
fn wave(evaluator: &impl Evaluator, ray: Ray) -> Result<RootRay, DrawError> {
    let answer = answer(evaluator, ray)?;
    wave_of(answer.starts[0], answer.of(0))
}

/// The crossings of a ray.
fn answer(evaluator: &impl Evaluator, ray: Ray) -> Result<Collected, RayError> {
    evaluator.one(ray, &Query::default())
}

/// The root-ray of the given crossings, inside where the region is not the world.
fn wave_of(start: RegionId, crossings: &[Crossing]) -> Result<RootRay, DrawError> {
    let start = if start == RegionId(0) { Side::Outside } else { Side::Inside };
    Ok(RootRay::from_times(start, crossings.iter().map(|crossing| crossing.t))?)
}
