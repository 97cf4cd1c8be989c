//! Leaf and surface tables of a group during compilation.

use crate::boxes::{Boxes, Extent};
use crate::drive::{Cancel, Stopped, drive, thread_count};
use crate::instances::{Instances, Numbers};
use crate::label::Labels;
use crate::leaf::{LeafFacet, LeafTable};
use crate::lower::{Content, Group, Part};
use crate::name_map::NameMap;
use crate::program::SurfaceEntry;
use crate::simplify::{Formula, Observer, bounds, leaf_needs, output_bounds, prepare_observed};
use crate::{Ball, CompileError, CompileProblem, Expression, PrototypeId, SurfaceId};
use rayweave_math::{Bounds, Transform, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::primitive::Primitive;
use rayweave_shape::surface::{Surface, share};
use std::num::NonZeroUsize;

/// The leaves and surfaces of a group.
#[derive(Default)]
pub(crate) struct Tables {
    pub leaves: LeafTable,
    pub surfaces: Vec<SurfaceEntry>,
    /// Numbers of the planes of the current chunk, by the bits of plane and magnitude: large models have
    /// millions of faces in few planes.
    planes: NameMap<[u64; 5], SurfaceId>,
}

/// Results of compiling a group, other than its tables.
pub(crate) struct Prepared {
    pub expression: Expression,
    pub ball: Ball,
    pub extent: Extent,
}

/// Number of shapes that are transformed into the group's frame at a time.
const CHUNK: usize = 4096;

/// A run of shapes in the frame of their group, with their own labels, or the copies of a placed solid.
enum Lowered<'g, 'a> {
    Shapes(Box<(Tables, Labels)>),
    Copies(&'g Part<'a>),
}

impl Tables {
    /// The leaves of a group with their surfaces, not yet shared; labels are numbered across all groups.
    pub fn of(
        group: &Group<'_>,
        labels: &mut Labels,
        inner: impl Fn(PrototypeId) -> Extent,
    ) -> Result<Tables, CompileError> {
        let is_shape = |part: &Part<'_>| matches!(part.content, Content::Shape(_));
        let runs = group.parts.chunk_by(|a, b| is_shape(a) && is_shape(b));
        let chunks = runs.flat_map(|run| run.chunks(CHUNK));
        let threads = if group.parts.len() > CHUNK { thread_count(None) } else { NonZeroUsize::MIN };
        let (mut tables, mut placements) = (Tables::default(), 1);
        let done = drive(
            threads,
            &Cancel::current(),
            chunks,
            || (),
            |(), chunk| lowered(group, chunk),
            |chunk| match chunk? {
                Lowered::Shapes(shapes) => {
                    tables.append(*shapes, labels);
                    Ok(())
                }
                Lowered::Copies(part) => tables.copies(group, part, &inner, &mut placements),
            },
        );
        match done {
            Ok(()) => Ok(tables),
            Err(Stopped::Cancelled) => Err(CompileError::cancelled()),
            Err(Stopped::Failed(error)) => Err(error),
        }
    }

    fn append(&mut self, (shapes, names): (Tables, Labels), labels: &mut Labels) {
        let numbers: Vec<u32> = names.into_labels().into_iter().map(|label| labels.insert(label)).collect();
        self.leaves.append(shapes.leaves, self.surfaces.len() as u32, |label| numbers[label as usize]);
        self.surfaces.extend(shapes.surfaces);
    }

    fn shape(
        &mut self,
        part: &Part<'_>,
        place: &Transform,
        primitive: &Primitive,
        labels: &mut Labels,
    ) -> Result<(), CompileProblem> {
        let lowered = primitive.lower();
        let mut bounds = match lowered.complement {
            true => Bounds::ALL,
            false => lowered.bounds.transformed(&place.world_from_local),
        };
        let names = lowered.facets.iter().map(|facet| facet.name.clone());
        let label = labels.number(&part.name, primitive.name(), names);
        self.leaves.push_shape(label, lowered.complement);
        for facet in &lowered.facets {
            let surface = facet.surface.transformed(place);
            let magnitude = surface.magnitude() + place.path;
            let is_in_range = magnitude <= Ray::MAX_COMPONENT;
            if !is_in_range || !surface.is_finite() {
                return Err(CompileProblem::NotFinite);
            }
            if facet.inside {
                let both = bounds.intersection(&surface.inside_bounds());
                // the boxes of a very thin shape may be disjoint by a rounding
                bounds = if both.is_empty() { bounds } else { both };
            }
            let id = self.surface(SurfaceEntry { surface, magnitude });
            self.leaves.facets.push(LeafFacet::new(id, facet.inside));
        }
        self.leaves.push_bounds(bounds);
        Ok(())
    }

    /// Adds a surface and returns its number; bitwise equal planes get the same number.
    fn surface(&mut self, entry: SurfaceEntry) -> SurfaceId {
        let fresh = SurfaceId::from(self.surfaces.len());
        if let Surface::Plane(plane) = &entry.surface {
            let [x, y, z] = plane.normal.to_array();
            let key = [x, y, z, plane.offset, entry.magnitude].map(f64::to_bits);
            let known = *self.planes.entry(key).or_insert(fresh);
            if known != fresh {
                return known;
            }
        }
        self.surfaces.push(entry);
        fresh
    }

    fn copies(
        &mut self,
        group: &Group<'_>,
        part: &Part<'_>,
        inner: impl Fn(PrototypeId) -> Extent,
        placements: &mut u32,
    ) -> Result<(), CompileError> {
        let Content::Copies(prototype, _, maps) = part.content else { return Ok(()) };
        let fail = |problem| CompileError { path: group.path(part), problem };
        let placements_each = inner(prototype).placements;
        let numbers = Numbers {
            prototype,
            first_leaf: self.leaves.len() as u32,
            before: self.leaves.instance_count() as u32,
            first_placement: *placements,
            placements_each,
        };
        *placements = (maps.len() as u32)
            .checked_mul(placements_each)
            .and_then(|more| placements.checked_add(more))
            .filter(|&all| all < 1 << 31)
            .ok_or_else(|| fail(CompileProblem::TooLarge { what: "placements" }))?;
        let (outer, way) = group.place(part);
        let instances = Instances::new(&part.name, numbers, outer, way, maps).map_err(fail)?;
        if (0..instances.len()).any(|k| instances.place(k).path > Ray::MAX_COMPONENT) {
            return Err(fail(CompileProblem::NotFinite));
        }
        self.leaves.push_instances(instances);
        Ok(())
    }

    /// Replaces coincident surfaces by one representative, bit for bit. `path` is that of the first leaf.
    pub fn share(&mut self, path: &str, labels: &Labels) -> Result<(), CompileError> {
        let candidates: Vec<_> = self.surfaces.iter().map(|s| (&s.surface, s.magnitude)).collect();
        let shared = share(&candidates).map_err(|wide| {
            let name = |surface: usize| {
                let mut facets = self.leaves.facets.iter();
                let facet = facets.position(|facet| facet.surface().index() == surface).unwrap_or(0);
                let leaf = self.leaves.leaf_of_facet(facet);
                labels.get(leaf.label_number()).face_name(facet - leaf.first_facet())
            };
            CompileError {
                path: path.to_owned(),
                problem: CompileProblem::WideClass { first: name(wide.first), second: name(wide.second) },
            }
        })?;
        drop(candidates);
        let mut number = vec![u32::MAX; self.surfaces.len()];
        // the representative of each class, and its magnitude
        let mut kept: Vec<(u32, f64)> = Vec::new();
        for facet in &mut self.leaves.facets {
            let k = facet.surface().index();
            let representative = shared.representative[k];
            let class = &mut number[representative as usize];
            if *class == u32::MAX {
                *class = kept.len() as u32;
                kept.push((representative, self.surfaces[representative as usize].magnitude));
            }
            let magnitude = &mut kept[*class as usize].1;
            // the class shares one tolerance, wide enough for each of its members
            *magnitude = magnitude.max(self.surfaces[k].magnitude);
            *facet = LeafFacet::new(SurfaceId(*class), facet.inside() ^ shared.flipped[k]);
        }
        drop((number, shared));
        // Surfaces are numbered in the order of the facets, and classes too, so class k has no member before
        // surface k, and no later class has surface k.
        for (k, &(representative, magnitude)) in kept.iter().enumerate() {
            if representative as usize != k {
                self.surfaces[k] = self.surfaces[representative as usize].clone();
            }
            self.surfaces[k].magnitude = magnitude;
        }
        self.surfaces.truncate(kept.len());
        Ok(())
    }

    /// Simplifies the formula of a group and marks the leaves that affect no output.
    pub fn prepare(
        &mut self,
        mut formula: Formula,
        inner: impl Fn(PrototypeId) -> Extent,
        observer: &mut impl Observer,
    ) -> Prepared {
        formula.complement_leaves(|leaf| self.leaves.leaf(leaf.index()).is_complement());
        let boxes = Boxes { leaves: &self.leaves, surfaces: &self.surfaces, inner };
        let count = self.leaves.len();
        let exact: Vec<Bounds> = (0..count).map(|leaf| boxes.bounds(leaf)).collect();
        let ball = self.ball(&exact);
        // grown by more than rounding, so that parts in contact do not count as disjoint; for a ray that
        // starts so far away that its roots err by more than the gap between two parts, the result is still
        // that of disjoint parts
        let mut margin = 0.0f64;
        let sure: Vec<Bounds> = (0..count)
            .map(|leaf| {
                let (grown, by) = boxes.grown(leaf, &ball);
                margin = margin.max(by);
                grown
            })
            .collect();
        let condition = (0..count).map(|leaf| boxes.condition(leaf)).fold(1.0, f64::max);
        let prepared = prepare_observed(&formula, &sure, observer);
        let tight = output_bounds(&prepared, &bounds(&prepared, &exact));
        observer.finish(&formula, &prepared, &exact, tight);
        drop((exact, formula));
        let nodes = bounds(&prepared, &sure);
        let needs = leaf_needs(&prepared, &nodes, count);
        needs
            .iter()
            .enumerate()
            .filter(|(_, here)| here.is_empty())
            .for_each(|(leaf, _)| self.leaves.mark_unused(leaf));
        let placements =
            self.leaves.instances.iter().map(|run| run.placements_each * run.len() as u32).sum::<u32>();
        let extent = Extent {
            bounds: tight,
            sure: output_bounds(&prepared, &nodes),
            margin,
            condition,
            placements: 1 + placements,
        };
        Prepared { expression: Expression::new(&prepared, count), ball, extent }
    }

    /// The ball around the finite leaves and, for the others, around the anchor points of their surfaces with the size of
    /// each surface on every side.
    fn ball(&self, bounds: &[Bounds]) -> Ball {
        let mut finite = Bounds::EMPTY;
        for (leaf, bounds) in bounds.iter().enumerate() {
            if bounds.is_finite() {
                finite = finite.union(bounds);
            } else {
                for facet in self.leaves.leaf(leaf).facets() {
                    let surface = &self.surfaces[facet.surface().index()].surface;
                    finite = finite.union(&Bounds::centred(surface.anchor(), Vec3::splat(surface.size())));
                }
            }
        }
        let magnitude = self.surfaces.iter().map(|entry| entry.magnitude).fold(0.0, f64::max);
        Ball::around(&finite, magnitude)
    }
}

/// Transforms shapes into the frame of their group. Copies are returned as they are, to be numbered in order.
fn lowered<'g, 'a>(group: &Group<'_>, parts: &'g [Part<'a>]) -> Result<Lowered<'g, 'a>, CompileError> {
    let (mut tables, mut labels) = (Tables::default(), Labels::default());
    for part in parts {
        let Content::Shape(primitive) = part.content else { return Ok(Lowered::Copies(part)) };
        let (world_from_local, way) = group.place(part);
        Transform::new(world_from_local, way)
            .map_err(CompileProblem::from)
            .and_then(|place| tables.shape(part, &place, primitive, &mut labels))
            .map_err(|problem| CompileError { path: group.path(part), problem })?;
    }
    Ok(Lowered::Shapes(Box::new((tables, labels))))
}
