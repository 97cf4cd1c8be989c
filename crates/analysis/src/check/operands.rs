//! Checks for operands without effect and for suspicious meshes.

use super::probe::{FEW, Probe, leaves_of, rays_of};
use super::share::Outcome;
use super::{CheckSettings, Finding, FindingKind};
use crate::AnalysisError;
use rayweave_math::{Affine, Bounds};
use rayweave_model::{Evaluator, Node, Program, Region, Solid};
use rayweave_polygon::is_outline_part;
use rayweave_shape::primitive::{BoxFromCorners, Primitive};
use std::collections::HashSet;

/// The maximum number of operands of an intersection that is searched: each operand is compared with all others, because
/// boxes exclude none.
const MAX_INTERSECTED: usize = 1024;

/// Checks all operators of all regions, each once.
pub fn findings<E: Evaluator>(
    regions: &[Region],
    probe: &mut Probe<'_, E>,
) -> Result<Vec<Finding>, AnalysisError> {
    let mut search = Search { region: "", found: Vec::new(), probe };
    // the addresses of the visited nodes, which solids may share
    let mut met = HashSet::new();
    for region in regions {
        search.region = &region.name;
        walk(&region.solid, &mut met, &mut |node, map| search.node(node, map))?;
    }
    Ok(search.found)
}

/// The number of rays of the searches in operands; those that the budget leaves out count, too.
pub fn planned_rays(regions: &[Region], settings: &CheckSettings) -> Result<u64, AnalysisError> {
    let (mut met, mut count) = (HashSet::new(), 0);
    for region in regions {
        walk(&region.solid, &mut met, &mut |node, _| {
            count += match node {
                Node::Union(all) if all.len() > 1 => all.len(),
                Node::Intersection(all) if (2..=MAX_INTERSECTED).contains(&all.len()) => all.len(),
                Node::Difference(_, b) => united(b).len(),
                _ => 0,
            };
            Ok(())
        })?;
    }
    Ok(count.min(settings.most_pairs) as u64 * rays_of(2 * FEW))
}

/// Calls `visit` with each mesh and each operator of a solid that is not in `met` yet.
fn walk(
    solid: &Solid,
    met: &mut HashSet<*const Node>,
    visit: &mut dyn FnMut(&Node, &Affine) -> Result<(), AnalysisError>,
) -> Result<(), AnalysisError> {
    let mut waiting = vec![(solid.clone(), Affine::IDENTITY)];
    while let Some((solid, map)) = waiting.pop() {
        if !met.insert(solid.node()) {
            continue;
        }
        match solid.node() {
            Node::Named(name, _) if is_outline_part(name) => {}
            // one shape: its operators are not those of the model file
            _ if solid.boundary().is_some() => {}
            Node::Transformed(own, inner) => waiting.push((inner.clone(), own.get().then(&map))),
            Node::Placed(inner, maps) => {
                // one copy represents all
                waiting.extend(maps.first().map(|own| (inner.clone(), own.then(&map))));
            }
            node => {
                visit(node, &map)?;
                let operands: Vec<Solid> = match node {
                    Node::Difference(a, b) => vec![a.clone(), b.clone()],
                    node => node.operands().to_vec(),
                };
                waiting.extend(operands.into_iter().rev().map(|operand| (operand, map)));
            }
        }
    }
    Ok(())
}

struct Search<'a, 'p, E> {
    region: &'a str,
    found: Vec<Finding>,
    probe: &'a mut Probe<'p, E>,
}

impl<'a, E: Evaluator> Search<'a, '_, E> {
    fn node(&mut self, node: &Node, map: &Affine) -> Result<(), AnalysisError> {
        match node {
            Node::Primitive(Primitive::Mesh(mesh)) => {
                self.mesh(mesh);
                Ok(())
            }
            Node::Union(all) => self.union(all, map),
            Node::Intersection(all) => self.intersection(all, map),
            Node::Difference(a, b) => {
                let size = leaves_of(a);
                united(b).iter().try_for_each(|hole| {
                    let size = size.saturating_add(leaves_of(hole));
                    self.operand(hole, size, || a & hole, map, "takes nothing from")
                })
            }
            _ => Ok(()),
        }
    }

    /// Compares each operand with those whose boxes overlap its own: no other operand can contain any part of it.
    fn union(&mut self, all: &[Solid], map: &Affine) -> Result<(), AnalysisError> {
        match all.len() {
            0..2 => return Ok(()),
            many if self.is_full() => return self.leave_out(many),
            _ => {}
        }
        let boxes = all.iter().map(|own| Ok(Program::compile(own)?.bounds()));
        let boxes = boxes.collect::<Result<Vec<_>, AnalysisError>>()?;
        let sizes: Vec<u64> = all.iter().map(leaves_of).collect();
        let row = Row::new(&boxes);
        for (k, own) in all.iter().enumerate() {
            if self.is_full() {
                return self.leave_out(all.len() - k);
            }
            let others = row.around(&boxes, k);
            // no other operand can contain any part of a shape alone in its box
            if others.is_empty() && sizes[k] == 1 && !boxes[k].is_empty() {
                self.probe.begin(rays_of(2 * FEW));
                self.probe.scope.operands += 1;
                continue;
            }
            let size = others.iter().map(|&j| sizes[j]).fold(sizes[k], u64::saturating_add);
            let effect = || own - &Solid::union(others.iter().map(|&j| all[j].clone()));
            self.operand(own, size, effect, map, "adds nothing to")?;
        }
        Ok(())
    }

    /// Compares each operand with all others.
    fn intersection(&mut self, all: &[Solid], map: &Affine) -> Result<(), AnalysisError> {
        match all.len() {
            0..2 => return Ok(()),
            many if many > MAX_INTERSECTED => return self.leave_out(many),
            _ => {}
        }
        let size = all.iter().map(leaves_of).fold(0, u64::saturating_add);
        for (k, own) in all.iter().enumerate() {
            let others = || Solid::intersection((0..all.len()).filter(|&j| j != k).map(|j| all[j].clone()));
            self.operand(own, size, || &others() - own, map, "takes nothing from")?;
        }
        Ok(())
    }

    fn is_full(&self) -> bool {
        self.probe.scope.operands >= self.probe.settings.most_pairs as u64
    }

    fn leave_out(&mut self, operands: usize) -> Result<(), AnalysisError> {
        self.probe.scope.operands_left_out += operands as u64;
        Ok(())
    }

    /// Checks one operand; `effect` is the part of space that it changes, and `leaves` its number of leaves.
    fn operand(
        &mut self,
        own: &Solid,
        leaves: u64,
        effect: impl Fn() -> Solid,
        map: &Affine,
        what: &str,
    ) -> Result<(), AnalysisError> {
        self.probe.begin(rays_of(2 * FEW));
        // the half-spaces of an outline are not operands of the model file
        if matches!(own.node(), Node::Named(name, _) if is_outline_part(name)) {
            return Ok(());
        }
        if self.is_full() || !self.probe.in_operands.affords(rays_of(2 * FEW), leaves) {
            return self.leave_out(1);
        }
        self.probe.scope.operands += 1;
        let outcome = self.probe.independent(|probe| {
            let effect = effect().apply(*map);
            let bounds = Program::compile(&effect)?.bounds();
            match bounds.is_empty() {
                true => Ok(Outcome::ProvedEmpty),
                false if bounds.is_finite() => Ok(probe.is_there(&effect, &bounds, 2 * FEW)?.into()),
                false => {
                    // what an operand of an intersection cuts off lies outside of the model
                    let around = probe.frame.grown(probe.frame.size().length());
                    let bounds = bounds.intersection(&around);
                    if bounds.is_empty() {
                        return Ok(Outcome::Nothing);
                    }
                    // rays measure pieces with two ends: a ray that ends in an unbounded part, such as a half-space, has none there
                    let within = Primitive::from(BoxFromCorners::new(bounds.lo, bounds.hi)?);
                    let effect = &effect & &Solid::from(within);
                    Ok(probe.is_there(&effect, &bounds, 2 * FEW)?.into())
                }
            }
        })?;
        let is_proved = outcome == Outcome::ProvedEmpty;
        if !matches!(outcome, Outcome::Found(_)) {
            let how = if is_proved { "" } else { ", as far as rays show" };
            let text = format!("{} {what} the rest of {}{how}", label(own), self.region);
            let finding = Finding::new(FindingKind::Absorbed, &[self.region], text);
            let place = Program::compile(&own.apply(*map))?.bounds();
            let at = (place.is_finite() && !place.is_empty()).then(|| place.centre());
            self.found.push(Finding { is_proved, at, ..finding });
        }
        Ok(())
    }

    fn mesh(&mut self, mesh: &rayweave_shape::primitive::Mesh) {
        let diagnosis = mesh.solid().to_mesh().diagnose();
        if !diagnosis.is_sound() {
            let text = format!("the mesh in {} may not be as intended: {diagnosis}", self.region);
            let finding = Finding::new(FindingKind::Mesh, &[self.region], text);
            self.found.push(Finding { is_proved: true, ..finding });
        }
    }
}

/// Boxes in the order of their lower ends along x.
struct Row {
    order: Vec<usize>,
    starts: Vec<f64>,
    /// The largest width along x.
    width: f64,
}

impl Row {
    fn new(boxes: &[Bounds]) -> Row {
        let mut order: Vec<usize> = (0..boxes.len()).collect();
        order.sort_by(|&a, &b| boxes[a].lo.x.total_cmp(&boxes[b].lo.x));
        let starts = order.iter().map(|&k| boxes[k].lo.x).collect();
        let width = boxes.iter().map(|own| own.hi.x - own.lo.x).fold(0.0, f64::max);
        Row { order, starts, width }
    }

    /// The boxes that overlap box `k`, in the given order.
    fn around(&self, boxes: &[Bounds], k: usize) -> Vec<usize> {
        // twice the width: the difference is rounded
        let from = self.starts.partition_point(|&x| x < boxes[k].lo.x - 2.0 * self.width);
        let to = self.starts.partition_point(|&x| x <= boxes[k].hi.x);
        let near = self.order[from.min(to)..to].iter().copied();
        let mut found: Vec<usize> =
            near.filter(|&j| j != k && !boxes[k].intersection(&boxes[j]).is_empty()).collect();
        found.sort_unstable();
        found
    }
}

/// The operands of a union, also below names; any other solid as the only element.
fn united(solid: &Solid) -> Vec<Solid> {
    match solid.node() {
        Node::Union(all) => all.clone(),
        Node::Named(_, inner) if matches!(inner.node(), Node::Union(_)) => united(inner),
        _ => vec![solid.clone()],
    }
}

/// The name of a primitive after "a" or "an". No name begins with a vowel that sounds like a consonant.
fn with_article(name: &str) -> String {
    let article = if name.starts_with(['a', 'e', 'i', 'o']) { "an" } else { "a" };
    format!("{article} {name}")
}

/// The label of a solid: its name, or its kind.
fn label(solid: &Solid) -> String {
    let mut solid = solid;
    loop {
        match solid.node() {
            Node::Named(name, _) => return name.to_string(),
            Node::Transformed(_, inner) | Node::Placed(inner, _) => solid = inner,
            // boxes have two names in model files, and a third one in those of OpenSCAD
            Node::Primitive(Primitive::BoxFromCorners(_)) => return "a box".to_owned(),
            Node::Primitive(primitive) => return with_article(primitive.name()),
            Node::Union(_) => return "a union".to_owned(),
            Node::Intersection(_) => return "an intersection".to_owned(),
            Node::Difference(..) => return "a difference".to_owned(),
            Node::SymmetricDifference(_) => return "a symmetric difference".to_owned(),
            Node::Complement(_) => return "a complement".to_owned(),
            Node::Empty => return "empty".to_owned(),
            Node::Universe => return "universe".to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::with_article;

    #[test]
    fn articles() {
        assert_eq!(["ellipsoid", "sphere"].map(with_article), ["an ellipsoid", "a sphere"]);
    }
}
