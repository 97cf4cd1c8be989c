//! The time line of one ray through a scene: the leaves that it crosses, their count, what comes of them.

use crate::{Compiled, Error};
use rayweave_math::Affine;
use rayweave_model::{Crossing, Evaluator, Node, Program, Query, RegionId, Solid};
use rayweave_render::Timeline;
use rayweave_rootray::{RootRay, Side};
use rayweave_scene::Scene;
use rayweave_shape::Ray;
use rayweave_trace::Weave;
use std::sync::Arc;

/// The most rows of operands that can be read.
const MOST_OPERANDS: usize = 40;

/// So many rows are shown even if the ray touches none of them.
const FEW_OPERANDS: usize = 8;

/// The most nodes that are looked at: a solid whose parts are shared can have leaves without end.
const MOST_NODES: usize = 10_000;

/// Draws what happens along a ray: a wave for each leaf, their count, the regions and media that the ray is in.
///
/// The leaves are those of the solids of the regions, or of the one solid that `compiled` was made of. A solid that is
/// placed many times counts as one leaf, leaves of one name with the same wave (a solid used in several places,
/// unbounded along the way between them) are drawn and counted once, and of many leaves those are left out
/// that the ray does not touch. Where there are more leaves than can be read, the waves are those of the
/// regions' whole solids; where those are too many, there are none.
///
/// # Errors
///
/// [`crate::ErrorKind::Compile`], [`crate::ErrorKind::Name`] if the scene has no solid of this name.
pub fn timeline(
    scene: &Scene,
    solid: Option<&str>,
    compiled: &Compiled,
    ray: Ray,
) -> Result<Timeline, Error> {
    let mut timeline = Timeline::new();
    let operands = operands(scene, solid)?;
    let shows_all = operands.len() <= FEW_OPERANDS;
    let mut drawn: Vec<(String, RootRay)> = Vec::new();
    for (name, operand) in operands {
        let row = (name, wave(&operand, ray)?);
        let is_touched = row.1.start() == Side::Inside || !row.1.roots().is_empty();
        if (shows_all || is_touched) && !drawn.contains(&row) {
            timeline.operand(&row.0, &row.1);
            drawn.push(row);
        }
    }
    let answer = Weave::new(compiled.program.clone()).one(ray, &Query::default())?;
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

/// The rows of operands with their names.
fn operands(scene: &Scene, solid: Option<&str>) -> Result<Vec<(String, Solid)>, Error> {
    let whole: Vec<(String, Solid)> = match solid {
        Some(name) => vec![(name.to_owned(), Compiled::find(scene, name)?.clone())],
        None => scene.regions.iter().map(|region| (region.name.clone(), region.solid.clone())).collect(),
    };
    let leaves = leaves(&whole);
    let few_regions = Some(whole).filter(|rows| rows.len() <= MOST_OPERANDS);
    Ok(leaves.or(few_regions).unwrap_or_default())
}

/// A part of a solid on the way to its leaves.
struct Part {
    solid: Solid,
    name: Option<Arc<str>>,
    world_from_local: Affine,
}

impl Part {
    /// Another solid in the place of this one.
    fn with(&self, solid: &Solid) -> Part {
        Part { solid: solid.clone(), name: self.name.clone(), world_from_local: self.world_from_local }
    }

    fn is_same(&self, other: &Part) -> bool {
        self.solid.is_same(&other.solid) && self.world_from_local == other.world_from_local
    }
}

/// The leaves of solids in the order of declaration, each occurrence once; `None` if there are too many.
fn leaves(solids: &[(String, Solid)]) -> Option<Vec<(String, Solid)>> {
    let part = |(_, solid): &(String, Solid)| Part {
        solid: solid.clone(),
        name: None,
        world_from_local: Affine::IDENTITY,
    };
    let mut waiting: Vec<Part> = solids.iter().rev().map(part).collect();
    let mut seen: Vec<Part> = Vec::new();
    for _ in 0..MOST_NODES {
        let Some(part) = waiting.pop() else {
            return Some(seen.into_iter().map(row).collect());
        };
        match part.solid.node() {
            Node::Vacuum | Node::Plenum | Node::Primitive(_) | Node::Placed(..) => {
                if !seen.iter().any(|other| other.is_same(&part)) {
                    seen.push(part);
                }
            }
            Node::Named(name, inner) => {
                waiting.push(Part { name: Some(name.clone()), ..part.with(inner) });
            }
            Node::Transformed(map, inner) => {
                let world_from_local = map.then(&part.world_from_local);
                waiting.push(Part { world_from_local, ..part.with(inner) });
            }
            node => waiting.extend(node.operand_refs().rev().map(|operand| part.with(operand))),
        }
        if seen.len() > MOST_OPERANDS {
            return None;
        }
    }
    None
}

fn row(leaf: Part) -> (String, Solid) {
    let kind = match leaf.solid.node() {
        Node::Primitive(primitive) => primitive.name(),
        Node::Placed(..) => "placed",
        Node::Vacuum => "vacuum",
        _ => "plenum",
    };
    let name = leaf.name.as_deref().unwrap_or(kind).to_owned();
    (name, leaf.solid.apply(leaf.world_from_local))
}

/// The root-ray of a solid alone.
fn wave(solid: &Solid, ray: Ray) -> Result<RootRay, Error> {
    let weave = Weave::new(Arc::new(Program::compile(solid)?));
    let answer = weave.one(ray, &Query::default())?;
    wave_of(answer.starts[0], answer.of(0))
}

fn wave_of(start: RegionId, crossings: &[Crossing]) -> Result<RootRay, Error> {
    let start = if start == RegionId(0) { Side::Outside } else { Side::Inside };
    Ok(RootRay::from_times(start, crossings.iter().map(|crossing| crossing.t))?)
}
