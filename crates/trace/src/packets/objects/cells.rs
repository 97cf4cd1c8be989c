//! Surroundings of solids: for a ray that starts within a solid, the few solids that it can meet before it leaves.
//!
//! A ray that starts on a surface and inside of a solid, or on its outside within the solid around it, needs no search for the
//! solids along its way: they are those whose boxes touch the box of the solid, and their list is computed in advance. Solids
//! that contain all of that box, with a margin, have no events there; only the last of them counts, as the region behind
//! the surface. Where many solids lie within one, such as phototubes in a tank, a tree of them replaces the list.

use super::super::places::{Step, stretch};
use super::{Method, Object, Objects};
use rayweave_bvh::{ExactBvh, WideBvh};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{MARGIN, PlacementId, Program, Start, SurfaceEntry, SurfaceId};
use rayweave_shape::surface::Surface;
use std::collections::HashMap;
use std::ops::{ControlFlow, Range};

/// The solids with short lists.
#[derive(Clone, Debug, Default)]
pub(super) struct Cells {
    /// Sorted by class.
    cells: Vec<Cell>,
    crowds: Vec<Crowd>,
    /// The lists of objects, one after the other: the solid of the cell, then the others.
    lists: Vec<u32>,
    /// For the surfaces of each placement, the cells where f > 0 and where f < 0.
    sides: Vec<[u32; 2]>,
    /// The part of `sides` for each placement, and the number of its first surface.
    of_placement: Vec<(Range<u32>, u32)>,
    /// The cell of the only solid of each region.
    of_region: Vec<u32>,
    /// The distance from the box of a solid within which all others are listed.
    pub slack: f64,
}

/// A solid with the others that rays within it can meet.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    list: Range<u32>,
    /// The last region that contains the solid and its surroundings; 0 for the world.
    pub base: f64,
    /// The region of the solid.
    pub region: f64,
    /// Cells of equal class have lists of copies of the same parts.
    pub class: u32,
    /// The number of the tree of the others; [`NONE`] if they are few and in the list.
    pub crowd: u32,
    /// The cell of the last solid that contains the solid and its surroundings; [`NONE`] if it has none.
    pub mother: u32,
}

/// The many solids that rays within a solid can meet.
#[derive(Clone, Debug)]
pub(super) struct Crowd {
    pub tree: CrowdTree,
    /// The solids in the order of the tree.
    pub solids: Vec<u32>,
}

/// The boxes of a crowd.
#[derive(Clone, Debug)]
pub(super) enum CrowdTree {
    /// Most rays pass few of them: they go through the tree together.
    Sparse(WideBvh),
    /// Each ray goes its own way.
    Dense(ExactBvh),
}

/// No cell.
pub(super) const NONE: u32 = u32::MAX;

/// Distance from a solid, in radii of the model, within which all others are listed. It exceeds the length of a weld unless
/// a ray meets a surface at a small angle; a separate check covers these cases.
const SLACK: f64 = 2e-6;

/// Less for models of planes, in the sum of twice the radius and the distance of the model from the origin: a weld that is not
/// at a grazing angle is 8e5 tolerances long, 5.7e-9 of the lengths of its ray, which are up to five times this sum.
const SLACK_OF_PLANES: f64 = 1e-7;

/// Largest number of solids in a list.
const LISTED: usize = 8;

/// Number of boxes that touch the box of a solid up to which all solids get a list.
const TOUCHING: usize = 64;

/// Number of further boxes that touch the boxes of solids, per solid of the model, beyond which no solid gets a longer list.
const CROWDED: usize = 16;

/// Number of the boxes of a crowd that a ray passes on average, up to which the crowd is sparse.
const SPARSE_CROWD: f64 = 4.0;

/// Number of solids below which the nodes of their tree are few, so that most of them need not be full.
const SMALL_CROWD: usize = 1000;

/// Number of solids near a solid up to which those within others are found.
const NESTED: usize = 16;

/// Largest size of the table of surfaces, in entries per solid.
const SPARSE: usize = 256;

/// The list of a solid, without its class.
struct Draft {
    list: Vec<u32>,
    /// True if the list is long.
    is_crowded: bool,
    base: f64,
    mother: Option<u32>,
}

impl Cells {
    /// The cells of all solids with lists; `bounds` are the boxes of the solids, and `extents` those around all of each.
    pub fn new(program: &Program, objects: &Objects, bounds: &[Bounds], extents: &[Bounds]) -> Cells {
        let limits = &objects.model.limits;
        // also in the frames of placed solids
        let is_flat = |entry: &SurfaceEntry| matches!(entry.surface, Surface::Plane(_));
        let slack = match program.surfaces().iter().all(is_flat) {
            true => SLACK_OF_PLANES * (2.0 * limits.radius + limits.centre.length()),
            false => SLACK * limits.radius,
        };
        let mut budget = CROWDED * extents.len();
        let mut drafts: Vec<Option<Draft>> = (0..extents.len())
            .map(|k| Draft::new(program, objects, (k, extents), slack, &mut budget))
            .collect();
        if drafts.iter().flatten().any(|draft| draft.is_crowded) {
            let covers = objects.covers(program, extents, slack);
            for (draft, object) in drafts.iter_mut().zip(&objects.objects) {
                if let Some(draft) = draft.as_mut().filter(|draft| draft.is_crowded) {
                    draft.thin_out(objects, object.region, &covers);
                }
            }
        }
        let mut classes = HashMap::new();
        let mut order: Vec<(u32, u32)> = Vec::new();
        for (k, draft) in (0..).zip(&drafts) {
            let Some(draft) = draft else { continue };
            let listed = if draft.is_crowded { &draft.list[..1] } else { &draft.list };
            let key: Vec<_> = listed
                .iter()
                .map(|&item| {
                    let object = &objects.objects[item as usize];
                    (object.part, object.steps.len())
                })
                .collect();
            let new = classes.len() as u32;
            order.push((*classes.entry(key).or_insert(new), k));
        }
        order.sort_unstable();
        let mut found = Cells { slack, ..Cells::default() };
        let mut of_object = vec![NONE; drafts.len()];
        for (class, k) in order {
            let Some(draft) = &drafts[k as usize] else { continue };
            of_object[k as usize] = found.cells.len() as u32;
            let first = found.lists.len() as u32;
            let (own, others) = draft.list.split_at(1);
            found.lists.extend(own);
            let mut crowd = NONE;
            if draft.is_crowded {
                crowd = found.crowds.len() as u32;
                found.crowds.push(Crowd::new(others, (&extents[k as usize], bounds), objects.condition));
            } else {
                found.lists.extend(others);
            }
            let (list, region) = (first..found.lists.len() as u32, objects.objects[k as usize].region);
            found.cells.push(Cell { list, base: draft.base, region, class, crowd, mother: NONE });
        }
        found.of_region = regions(objects, &of_object);
        let around = |k: usize| {
            let mother = drafts[k].as_ref().and_then(|draft| draft.mother);
            mother.map_or(NONE, |mother| of_object[mother as usize])
        };
        let sides: Vec<[u32; 2]> = (0..drafts.len()).map(|k| [around(k), of_object[k]]).collect();
        for &[mother, own] in &sides {
            if let Some(cell) = found.cells.get_mut(own as usize) {
                cell.mother = mother;
            }
        }
        found.tabulate(objects, &sides);
        found
    }

    /// Fills the table of the surfaces of each placement.
    fn tabulate(&mut self, objects: &Objects, sides: &[[u32; 2]]) {
        let mut spans: Vec<Range<u32>> = Vec::new();
        for object in &objects.objects {
            let placement = object.placement as usize;
            spans.resize(spans.len().max(placement + 1), Range { start: u32::MAX, end: 0 });
            let span = &mut spans[placement];
            for &(surface, _) in &objects.parts[object.part as usize].sides {
                *span = span.start.min(surface)..span.end.max(surface + 1);
            }
        }
        let total: usize = spans.iter().map(ExactSizeIterator::len).sum();
        if total > SPARSE * objects.objects.len() {
            self.cells.clear();
            return;
        }
        self.sides = vec![[NONE; 2]; total];
        let (mut within, mut first) = (vec![[false; 2]; total], 0);
        for span in spans {
            let next = first + span.len() as u32;
            self.of_placement.push((first..next, span.start));
            first = next;
        }
        for (object, sides) in objects.objects.iter().zip(sides) {
            let (range, offset) = self.of_placement[object.placement as usize].clone();
            for &(surface, inside) in &objects.parts[object.part as usize].sides {
                let (at, [out, own]) = ((range.start + surface - offset) as usize, *sides);
                let (cells, within) = (&mut self.sides[at], &mut within[at]);
                // of the solids that share a surface, the first one on each side is chosen, before those around them: rays that
                // start there find out whether they are in it
                let (inner, outer) = (usize::from(inside), usize::from(!inside));
                if own != NONE && !within[inner] {
                    (cells[inner], within[inner]) = (own, true);
                }
                if cells[outer] == NONE {
                    cells[outer] = out;
                }
            }
        }
    }

    /// True without any cell.
    pub fn is_empty(&self) -> bool {
        self.cells.is_empty()
    }

    /// A cell by its number.
    pub fn get(&self, number: u32) -> &Cell {
        &self.cells[number as usize]
    }

    /// The solids of a cell: its own, then the others.
    pub fn list(&self, cell: &Cell) -> &[u32] {
        &self.lists[cell.list.start as usize..cell.list.end as usize]
    }

    /// The many solids of a cell, by their number.
    pub fn crowd(&self, number: u32) -> &Crowd {
        &self.crowds[number as usize]
    }

    /// The number of cells.
    pub fn count(&self) -> usize {
        self.cells.len()
    }

    /// The number of the cell of the only solid of a region; [`NONE`] if there are several, or none.
    pub fn of_region(&self, region: u32) -> u32 {
        self.of_region.get(region as usize).copied().unwrap_or(NONE)
    }

    /// The number of the cell in which a ray probably starts; [`NONE`] if there is none. The search finds out if it does
    /// not.
    pub fn of(&self, starts: &[Start]) -> u32 {
        let [Start { surface: SurfaceId(surface), placement: PlacementId(placement), inside }, ..] = *starts
        else {
            return NONE;
        };
        let Some((range, offset)) = self.of_placement.get(placement as usize) else { return NONE };
        let at = surface.wrapping_sub(*offset);
        if at >= range.end - range.start {
            return NONE;
        }
        self.sides[(range.start + at) as usize][usize::from(inside)]
    }
}

/// The cell of the only solid of each region, from the cells of all solids.
fn regions(objects: &Objects, of_object: &[u32]) -> Vec<u32> {
    let mut found: Vec<Option<u32>> = Vec::new();
    for (object, &cell) in objects.objects.iter().zip(of_object) {
        let region = object.region as usize;
        found.resize(found.len().max(region + 1), None);
        found[region] = Some(if found[region].is_none() { cell } else { NONE });
    }
    found.into_iter().map(|cell| cell.unwrap_or(NONE)).collect()
}

impl Crowd {
    /// Some solids, and the box of the solid around them. `condition` is that of the model: see
    /// [`Prototype::condition`](rayweave_model::Prototype::condition).
    fn new(solids: &[u32], (around, bounds): (&Bounds, &[Bounds]), condition: f64) -> Crowd {
        let boxes: Vec<Bounds> = solids.iter().map(|&k| bounds[k as usize]).collect();
        // of the random lines through a convex body, the part that passes a body within it is the ratio of their surfaces
        // (Crofton 1885)
        let surface = |bounds: &Bounds| {
            let Vec3 { x, y, z } = bounds.size();
            x * y + y * z + z * x
        };
        let is_sparse = boxes.iter().map(surface).sum::<f64>() <= SPARSE_CROWD * surface(around);
        let all = boxes.iter().fold(*around, |all, bounds| all.union(bounds));
        if is_sparse && all.is_finite() {
            let tree = WideBvh::new(&boxes, around, condition * MARGIN);
            return Crowd { tree: CrowdTree::Sparse(tree), solids: solids.to_vec() };
        }
        let (tree, order) = match boxes.len() < SMALL_CROWD {
            true => ExactBvh::sorted_apart(&boxes),
            false => ExactBvh::sorted(&boxes),
        };
        let solids = order.into_iter().map(|k| solids[k as usize]).collect();
        Crowd { tree: CrowdTree::Dense(tree), solids }
    }
}

impl Draft {
    /// The list of a solid; `None` if it has no extent, or if too many boxes touch its own. `budget` is the number of
    /// further boxes that may touch those of all solids.
    fn new(
        program: &Program,
        objects: &Objects,
        (own, extents): (usize, &[Bounds]),
        slack: f64,
        budget: &mut usize,
    ) -> Option<Draft> {
        let (object, extent) = (&objects.objects[own], &extents[own]);
        if !extent.is_finite() {
            return None;
        }
        if objects.is_carved(own as u32) {
            return None;
        }
        // twice, for the rounding of the sums
        let around = extent.grown(2.0 * slack);
        let mut near = Vec::new();
        let all = objects.boxes.visit(
            |bounds| !bounds.intersection(&around).is_empty(),
            |k| {
                near.push(k as u32);
                if near.len() > TOUCHING + *budget {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            },
        );
        *budget -= near.len().saturating_sub(TOUCHING).min(*budget);
        if all.is_break() {
            return None;
        }
        let get = |k: u32| &objects.objects[k as usize];
        let mothers = near
            .iter()
            .copied()
            .filter(|&k| get(k).region < object.region && objects.contains_box(program, get(k), &around));
        let mother = mothers.max_by(|&a, &b| get(a).region.total_cmp(&get(b).region));
        let base = mother.map_or(0.0, |k| get(k).region);
        let mut list: Vec<u32> =
            near.into_iter().filter(|&k| k as usize != own && get(k).region > base).collect();
        if list.len() <= NESTED {
            let around = |k: u32| extents[k as usize].grown(2.0 * slack);
            // rays meet the solid around it first, and start elsewhere if they start in that
            let covers = |k: u32, other: u32| {
                let shell = get(other);
                let is_later = other != k && shell.region > object.region;
                is_later && objects.contains(program, shell, (get(k), &around(k)), slack)
            };
            let is_covered: Vec<bool> =
                list.iter().map(|&k| list.iter().any(|&other| covers(k, other))).collect();
            let mut covered = is_covered.into_iter();
            list.retain(|_| covered.next() != Some(true));
        }
        list.sort_by_key(|&k| (get(k).part, get(k).region as u32, k));
        list.insert(0, own as u32);
        let is_crowded = !objects.is_short(&list);
        Some(Draft { list, is_crowded, base, mother })
    }

    /// Removes the solids within others from a long list. `region` is that of the solid, and `covers` are those around all.
    fn thin_out(&mut self, objects: &Objects, region: f64, covers: &[f64]) {
        let own = self.list[0];
        // rays meet the solid around it first, and start elsewhere if they start in that
        self.list.retain(|&k| k == own || covers[k as usize] <= region);
        self.is_crowded = !objects.is_short(&self.list);
    }
}

impl Objects {
    /// There is no kernel for rays that start on carved solids.
    fn is_carved(&self, k: u32) -> bool {
        matches!(self.parts[self.objects[k as usize].part as usize].method, Method::Carved(_))
    }

    /// True if the solids of a list are so few that every ray is intersected with all of them.
    fn is_short(&self, list: &[u32]) -> bool {
        list.len() <= LISTED && !list.iter().any(|&k| self.is_carved(k))
    }

    /// For each solid, the last region with another solid that contains its box, with a margin; 0 if none is found.
    fn covers(&self, program: &Program, extents: &[Bounds], slack: f64) -> Vec<f64> {
        let cover = |k: usize| {
            let around = extents[k].grown(2.0 * slack);
            let (mut last, mut count) = (0.0, 0);
            let _ = self.boxes.visit(
                |bounds| bounds.union(&around) == *bounds,
                |other| {
                    let shell = &self.objects[other];
                    let inner = (&self.objects[k], &around);
                    if other != k && shell.region > last && self.contains(program, shell, inner, slack) {
                        last = shell.region;
                    }
                    count += 1;
                    if count == TOUCHING { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                },
            );
            last
        };
        (0..extents.len()).map(cover).collect()
    }

    /// True if a solid, with a margin, certainly lies in a convex one: if its box does, or if it is a ball that does.
    fn contains(
        &self,
        program: &Program,
        shell: &Object,
        (inner, bounds): (&Object, &Bounds),
        slack: f64,
    ) -> bool {
        self.contains_box(program, shell, bounds) || self.contains_ball(program, shell, inner, slack)
    }

    /// True if a solid that is a ball, with a margin, certainly lies in a convex one.
    fn contains_ball(&self, program: &Program, shell: &Object, inner: &Object, slack: f64) -> bool {
        let Method::Plan(plan) = &self.parts[shell.part as usize].method else { return false };
        let [(surface, true)] = self.parts[inner.part as usize].sides[..] else { return false };
        let Surface::Sphere(ball) = &program.surface(SurfaceId(surface)).surface else { return false };
        let (up, _) = program.placement(PlacementId(inner.placement));
        let steps = self.steps(shell);
        let norm: f64 = steps.iter().map(Step::stretch).product();
        let centre = steps.iter().fold(up.point(ball.centre), |point, step| step.point(point));
        // the margin covers the rounding of the maps, which is far below the slack
        let radius = norm * (stretch(&up) * ball.radius * (1.0 + 1e-9) + 2.0 * slack);
        let holds = |&(surface, inside): &(u32, bool)| match &program.surface(SurfaceId(surface)).surface {
            Surface::Plane(plane) => {
                let height = plane.normal.dot(centre) - plane.offset;
                (if inside { -height } else { height }) > radius
            }
            Surface::Sphere(shell) => inside && (centre - shell.centre).length() + radius < shell.radius,
            Surface::Cylinder(shell) => {
                let offset = centre - shell.point;
                let across = offset - offset.dot(shell.axis) * shell.axis;
                inside && across.length() + radius < shell.radius
            }
            _ => false,
        };
        plan.is_single_span() && self.parts[shell.part as usize].sides.iter().all(holds)
    }

    /// True if a box certainly lies in a convex solid: if its corners do.
    fn contains_box(&self, program: &Program, object: &Object, bounds: &Bounds) -> bool {
        let Method::Plan(plan) = &self.parts[object.part as usize].method else { return false };
        if !plan.is_single_span() {
            return false;
        }
        let steps = self.steps(object);
        let holds = |&(surface, inside): &(u32, bool), corner: Vec3| {
            let surface = &program.surface(SurfaceId(surface)).surface;
            let is_convex = match surface {
                Surface::Plane(_) => true,
                Surface::Sphere(_) | Surface::Cylinder(_) => inside,
                _ => false,
            };
            let value = surface.value_and_gradient(corner).0;
            is_convex && if inside { value < 0.0 } else { value > 0.0 }
        };
        bounds.corners().into_iter().all(|corner| {
            let corner = steps.iter().fold(corner, |point, step| step.point(point));
            self.parts[object.part as usize].sides.iter().all(|side| holds(side, corner))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::packets::plan::Common;
    use rayweave_math::Affine;
    use rayweave_model::{Region, Solid};
    use rayweave_shape::primitive::{Value, build};

    fn shape(name: &str, argument: &str, value: f64) -> Solid {
        Solid::from(build(name, &[(argument, Value::Number(value))]).unwrap())
    }

    /// A tank of tubes, each with a cathode within it, has a tree of the tubes, and a tube has a list.
    #[test]
    fn a_tank_has_a_tree_of_the_solids_directly_within_it() {
        let maps: Vec<Affine> = (0..100)
            .map(|k| Affine::translate(Vec3::new(f64::from(k % 10), f64::from(k / 10), 0.0)))
            .collect();
        let solids = [
            shape("box", "size", 60.0),
            shape("box", "size", 50.0),
            shape("sphere", "radius", 0.4).place(maps.clone()),
            shape("sphere", "radius", 0.3).place(maps),
        ];
        let region =
            |(k, solid): (u32, &Solid)| Region { name: format!("{k}"), solid: solid.clone(), medium: k + 1 };
        let regions: Vec<Region> = (0..).zip(&solids).map(region).collect();
        let program = Program::compile_regions(&regions).unwrap();
        let objects = Objects::new(&program, &Common::new(&program).unwrap()).unwrap();
        let cells = &objects.cells;
        let tank = cells.get(cells.of_region(2));
        let others = &cells.crowd(tank.crowd).solids;
        assert_eq!((tank.base, others.len()), (1.0, 100));
        assert!(others.iter().all(|&k| objects.objects[k as usize].region == 3.0));
        let tubes: Vec<&Cell> = cells.cells.iter().filter(|cell| cell.region == 3.0).collect();
        assert_eq!(tubes.len(), 100);
        assert!(tubes.iter().all(|tube| tube.crowd == NONE && cells.list(tube).len() == 2));
    }
}
