//! From solids to a program.

use crate::gate::Network;
use crate::lower::{Content, Group, RawLeaf, lower};
use crate::program::{Leaf, LeafFacet, LeafKind, MARGIN, Program, Prototype, RegionInfo, SurfaceEntry};
use crate::simplify::{Formula, Watch, bounds, leaf_needs, output_bounds, prepare_watched as prepare};
use crate::{Ball, CompileError, CompileProblem, Expression, LeafId, PrototypeId, Region, Solid, SurfaceId};
use rayweave_math::{Bounds, Transform, Vec3};
use rayweave_shape::Ray;
use rayweave_shape::primitive::{Lowered, Primitive};
use rayweave_shape::surface::share;

impl Program {
    /// Compiles one solid. Its inside is region 1 of medium 1, everything else the world.
    pub fn compile(solid: &Solid) -> Result<Program, CompileError> {
        let regions = vec![RegionInfo { name: solid_name(solid), medium: 1 }];
        compile(&[solid], regions, |_, _| ())
    }

    /// Compiles an ordered list of regions: where they overlap, the later one wins.
    pub fn compile_regions(regions: &[Region]) -> Result<Program, CompileError> {
        compile_watched(regions, |_, _| ())
    }
}

/// Compiles regions; for each group, in the order of compilation, `watch` makes what looks on while it is prepared.
pub(crate) fn compile_watched<W: Watch>(
    regions: &[Region],
    watch: impl FnMut(usize, &Group) -> W,
) -> Result<Program, CompileError> {
    let solids: Vec<&Solid> = regions.iter().map(|region| &region.solid).collect();
    let infos = regions.iter().map(|r| RegionInfo { name: r.name.clone(), medium: r.medium }).collect();
    compile(&solids, infos, watch)
}

fn solid_name(solid: &Solid) -> String {
    match solid.node() {
        crate::Node::Named(name, _) => name.to_string(),
        _ => "solid".to_owned(),
    }
}

fn compile<W: Watch>(
    solids: &[&Solid],
    regions: Vec<RegionInfo>,
    mut watch: impl FnMut(usize, &Group) -> W,
) -> Result<Program, CompileError> {
    let groups = lower(solids)?;
    let order = inner_first(&groups);
    let mut compiler = Compiler {
        program: Program {
            prototypes: Vec::new(),
            surfaces: Vec::new(),
            leaves: Vec::new(),
            facets: Vec::new(),
            regions,
        },
        done: groups.iter().map(|_| None).collect(),
    };
    // leaf and surface numbers run group by group with the model first, whatever the order of compilation
    let mut first_leaf = 0;
    let firsts: Vec<u32> = groups
        .iter()
        .map(|group| {
            let first = first_leaf;
            first_leaf += group.leaves.len() as u32;
            first
        })
        .collect();
    let mut tables: Vec<Option<GroupTables>> = groups.iter().map(|_| None).collect();
    let mut groups: Vec<Option<Group>> = groups.into_iter().map(Some).collect();
    for id in order {
        let Some(group) = groups[id].take() else {
            continue;
        };
        let mut watch = watch(id, &group);
        tables[id] = Some(compiler.group(id, group, firsts[id], &mut watch)?);
    }
    compiler.assemble(tables)
}

/// The groups ordered so that placed solids come before what places them.
fn inner_first(groups: &[Group]) -> Vec<usize> {
    let inner = |id: usize| {
        groups[id].leaves.iter().filter_map(|leaf| match leaf.content {
            Content::Instance(prototype) => Some(prototype.index()),
            Content::Shape(..) => None,
        })
    };
    let (mut order, mut state) = (Vec::new(), vec![0u8; groups.len()]);
    let mut waiting: Vec<usize> = vec![0];
    while let Some(&id) = waiting.last() {
        match state[id] {
            0 => {
                state[id] = 1;
                waiting.extend(inner(id).filter(|&k| state[k] == 0));
            }
            1 => {
                state[id] = 2;
                order.push(id);
                waiting.pop();
            }
            _ => {
                waiting.pop();
            }
        }
    }
    order
}

/// The tables of one group, numbered from zero.
struct GroupTables {
    prototype: Prototype,
    leaves: Vec<Leaf>,
    facets: Vec<LeafFacet>,
    surfaces: Vec<SurfaceEntry>,
}

/// What later groups need to know about a compiled one.
#[derive(Clone, Copy)]
struct Summary {
    bounds: Bounds,
    placements: u32,
    /// A box that holds it at all times of a ray: see [`sure`].
    sure: Bounds,
    /// The largest margin of its leaves.
    margin: f64,
    condition: f64,
}

struct Compiler {
    program: Program,
    done: Vec<Option<Summary>>,
}

impl Compiler {
    fn group(
        &mut self,
        id: usize,
        group: Group,
        first_leaf: u32,
        watch: &mut impl Watch,
    ) -> Result<GroupTables, CompileError> {
        let mut tables = Tables::default();
        for raw in &group.leaves {
            let added = match &raw.content {
                Content::Shape(shape) => tables.shape(raw, &shape.0, &shape.1),
                Content::Instance(prototype) => {
                    tables.instance(raw, *prototype, self.done[prototype.index()])
                }
            };
            added.map_err(|problem| CompileError { path: group.path(raw), problem })?;
        }
        tables.share(&group)?;
        let ball = tables.ball();
        tables.add_margins(&ball);
        let (formula, bounds, sure) = tables.prepare(&group, watch);
        let expression = Expression::new(&formula);
        let prototype = Prototype {
            leaves: first_leaf..first_leaf + group.leaves.len() as u32,
            network: Network::new(&expression, formula.outputs(), group.leaves.len()),
            bounds,
            ball,
            condition: tables.condition,
            placements: tables.placements,
            instances: tables.instances.iter().map(|&(p, leaf)| (p, LeafId(first_leaf + leaf))).collect(),
            expression,
            outputs: formula.outputs().to_vec(),
        };
        let margin = tables.leaves.iter().map(|leaf| leaf.margin).fold(0.0, f64::max);
        let (placements, condition) = (prototype.placements, prototype.condition);
        self.done[id] = Some(Summary { bounds, sure, placements, margin, condition });
        Ok(GroupTables { prototype, leaves: tables.leaves, facets: tables.facets, surfaces: tables.surfaces })
    }

    /// Joins the tables of all groups, moving their numbers behind one another.
    fn assemble(mut self, tables: Vec<Option<GroupTables>>) -> Result<Program, CompileError> {
        for mut group in tables.into_iter().flatten() {
            let (facets, surfaces) = (self.program.facets.len() as u32, self.program.surfaces.len() as u32);
            for leaf in &mut group.leaves {
                if let LeafKind::Shape { facets: range, .. } = &mut leaf.kind {
                    *range = range.start + facets..range.end + facets;
                }
            }
            group.facets.iter_mut().for_each(|facet| facet.surface.0 += surfaces);
            self.program.prototypes.push(group.prototype);
            self.program.leaves.append(&mut group.leaves);
            self.program.facets.append(&mut group.facets);
            self.program.surfaces.append(&mut group.surfaces);
        }
        Ok(self.program)
    }
}

/// The tables of a group while they grow.
struct Tables {
    leaves: Vec<Leaf>,
    facets: Vec<LeafFacet>,
    surfaces: Vec<SurfaceEntry>,
    instances: Vec<(u32, u32)>,
    placements: u32,
    condition: f64,
}

impl Default for Tables {
    fn default() -> Self {
        Tables {
            leaves: Vec::new(),
            facets: Vec::new(),
            surfaces: Vec::new(),
            instances: Vec::new(),
            placements: 1,
            condition: 1.0,
        }
    }
}

impl Tables {
    fn shape(
        &mut self,
        raw: &RawLeaf,
        primitive: &Primitive,
        lowered: &Lowered,
    ) -> Result<(), CompileProblem> {
        let transform = transform_of(raw)?;
        let first = self.facets.len() as u32;
        let mut bounds = if lowered.complement {
            Bounds::ALL
        } else {
            lowered.bounds.transformed(&transform.world_from_local)
        };
        for facet in &lowered.facets {
            let surface = facet.surface.transformed(&transform);
            let reach = surface.reach() + transform.path;
            let is_in_reach = reach <= Ray::MOST;
            if !is_in_reach || !surface.is_finite() {
                return Err(CompileProblem::NotFinite);
            }
            if facet.inside {
                let both = bounds.intersection(&surface.inside_bounds());
                // two boxes of something very thin may miss each other by a rounding
                bounds = if both.is_empty() { bounds } else { both };
            }
            let name = format!("{}.{}", raw.name, facet.name).into();
            let surface_id = SurfaceId::from(self.surfaces.len());
            self.surfaces.push(SurfaceEntry { surface, reach });
            self.facets.push(LeafFacet { surface: surface_id, inside: facet.inside, name });
        }
        self.leaves.push(Leaf {
            name: raw.name.clone(),
            kind: LeafKind::Shape {
                facets: first..self.facets.len() as u32,
                primitive: primitive.clone(),
                complement: lowered.complement,
            },
            bounds,
            margin: 0.0,
            matters: sure(bounds),
            transform,
        });
        Ok(())
    }

    fn instance(
        &mut self,
        raw: &RawLeaf,
        prototype: PrototypeId,
        inner: Option<Summary>,
    ) -> Result<(), CompileProblem> {
        let transform = transform_of(raw)?;
        if transform.path > Ray::MOST {
            return Err(CompileProblem::NotFinite);
        }
        let Some(inner) = inner else { return Ok(()) };
        let placement = self.placements;
        self.placements = placement
            .checked_add(inner.placements)
            .filter(|&all| all < 1 << 31)
            .ok_or(CompileProblem::TooLarge { what: "placements" })?;
        let map = &transform.world_from_local;
        // a Frobenius norm is up to sqrt(3) times the greatest stretch: never too small
        let condition = map.stretch() * transform.local_from_world.stretch() * inner.condition;
        self.condition = self.condition.max(condition);
        self.instances.push((placement, self.leaves.len() as u32));
        self.leaves.push(Leaf {
            name: raw.name.clone(),
            kind: LeafKind::Instance { prototype, placement },
            bounds: inner.bounds.transformed(map),
            margin: map.stretch() * inner.margin + MARGIN * condition * transform.path,
            matters: sure(inner.sure.transformed(map)),
            transform,
        });
        Ok(())
    }

    /// Faces that coincide get one surface, the same bits for all of them.
    fn share(&mut self, group: &Group) -> Result<(), CompileError> {
        let candidates: Vec<_> = self.surfaces.iter().map(|s| (s.surface.clone(), s.reach)).collect();
        let shared = share(&candidates).map_err(|wide| {
            let name = |k: usize| self.facets[k].name.to_string();
            CompileError {
                path: group.leaves.first().map(|leaf| group.path(leaf)).unwrap_or_default(),
                problem: CompileProblem::WideClass { first: name(wide.first), second: name(wide.second) },
            }
        })?;
        let mut number = vec![u32::MAX; self.surfaces.len()];
        let mut kept: Vec<SurfaceEntry> = Vec::new();
        for (k, facet) in self.facets.iter_mut().enumerate() {
            let representative = shared.representative[k] as usize;
            if number[representative] == u32::MAX {
                number[representative] = kept.len() as u32;
                kept.push(self.surfaces[representative].clone());
            }
            let entry = &mut kept[number[representative] as usize];
            // the class shares one tolerance, wide enough for each of its members
            entry.reach = entry.reach.max(self.surfaces[k].reach);
            facet.surface = SurfaceId(number[representative]);
            facet.inside ^= shared.flipped[k];
        }
        self.surfaces = kept;
        Ok(())
    }

    /// The share of the group in the margins of its leaves: their own sizes and ways, those of the faces that they share
    /// surfaces with, and the tolerance by which rays lie in faces, at the far end of a chord.
    fn add_margins(&mut self, ball: &Ball) {
        let far = |v: Vec3| if v.is_finite() { v.length() } else { 0.0 };
        let chord = ball.centre.length() + 2.0 * ball.radius;
        for leaf in &mut self.leaves {
            let facets = match &leaf.kind {
                LeafKind::Shape { facets, .. } => facets.start as usize..facets.end as usize,
                LeafKind::Instance { .. } => 0..0,
            };
            let reach = |facet: &LeafFacet| self.surfaces[facet.surface.index()].reach;
            let way = self.facets[facets].iter().map(reach).fold(leaf.transform.path, f64::max);
            leaf.margin += MARGIN * (far(leaf.bounds.lo) + far(leaf.bounds.hi) + way + chord);
        }
    }

    /// Prepares the formula of the group, and finds for each leaf the part of its box where it can matter. Answers
    /// with two boxes around what is asked of the group, too: one from the boxes of the leaves, one that is grown
    /// and of what is sure alone.
    fn prepare(&mut self, group: &Group, watch: &mut impl Watch) -> (Formula, Bounds, Bounds) {
        // grown by more than rounding, so that parts that only touch are not taken for apart; a ray that starts so
        // far away that its roots err by more than the gap between two parts gets what is true of them
        let sure: Vec<Bounds> = self.leaves.iter().map(|leaf| leaf.matters.grown(leaf.margin)).collect();
        let formula = prepare(&group.formula, &sure, watch);
        let exact: Vec<Bounds> = self.leaves.iter().map(|leaf| leaf.bounds).collect();
        let tight = output_bounds(&formula, &bounds(&formula, &exact));
        watch.finish(&group.formula, &formula, &exact, tight);
        drop(exact);
        let nodes = bounds(&formula, &sure);
        let needs = leaf_needs(&formula, &nodes, self.leaves.len());
        for (leaf, here) in self.leaves.iter_mut().zip(needs) {
            leaf.matters = here;
        }
        let sure = output_bounds(&formula, &nodes);
        (formula, tight, sure)
    }

    /// The ball around the finite leaves and the anchors of the surfaces of the others.
    fn ball(&self) -> Ball {
        let mut finite = Bounds::EMPTY;
        for leaf in &self.leaves {
            if leaf.bounds.is_finite() {
                finite = finite.union(&leaf.bounds);
            } else if let LeafKind::Shape { facets, .. } = &leaf.kind {
                for facet in &self.facets[facets.start as usize..facets.end as usize] {
                    let anchor = self.surfaces[facet.surface.index()].surface.anchor();
                    finite = finite.union(&Bounds { lo: anchor, hi: anchor });
                }
            }
        }
        Ball::around(&finite)
    }
}

/// A box that does not end on all sides says nothing for certain: a ray nearly parallel to a face leaves it at
/// a time of 1e16 or so, at no certain place.
fn sure(bounds: Bounds) -> Bounds {
    if bounds.is_finite() || bounds.is_empty() { bounds } else { Bounds::ALL }
}

fn transform_of(raw: &RawLeaf) -> Result<Transform, CompileProblem> {
    Ok(Transform::new(raw.world_from_local, raw.way)?)
}
