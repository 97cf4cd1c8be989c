//! Compilation of solids into a [`Program`].

use crate::boxes::Extent;
use crate::gate::Network;
use crate::label::Labels;
use crate::leaf::LeafTable;
use crate::lower::{Content, Group, lower};
use crate::program::{Program, Prototype, RegionInfo, SurfaceEntry};
use crate::simplify::Observer;
use crate::size::{FOR_FILES, FOR_PROGRAMS, LeafLimit};
use crate::tables::Tables;
use crate::trail::Trail;
use crate::{CompileError, Region, Solid};

impl Program {
    /// Compiles one solid. Its inside is region 1 of medium 1, its outside the world.
    pub fn compile(solid: &Solid) -> Result<Program, CompileError> {
        let regions = vec![RegionInfo { name: solid_name(solid), medium: 1 }];
        compile(&[solid], regions, &FOR_PROGRAMS, |_, _| ())
    }

    /// Compiles an ordered list of regions: where they overlap, the later one has priority.
    pub fn compile_regions(regions: &[Region]) -> Result<Program, CompileError> {
        compile_limited(regions, &FOR_PROGRAMS, |_, _| ())
    }

    /// Compiles the regions of a model file like [`compile_regions`](Program::compile_regions), with the limit of
    /// [`check_repetition`](crate::check_repetition) on repeated solids.
    pub fn compile_file_regions(regions: &[Region]) -> Result<Program, CompileError> {
        compile_limited(regions, &FOR_FILES, |_, _| ())
    }
}

/// Compiles regions. For each group, in the order of compilation, `observer` makes the observer of its
/// simplification.
pub(crate) fn compile_observed<W: Observer>(
    regions: &[Region],
    observer: impl FnMut(usize, &Group) -> W,
) -> Result<Program, CompileError> {
    compile_limited(regions, &FOR_PROGRAMS, observer)
}

fn compile_limited<W: Observer>(
    regions: &[Region],
    limit: &LeafLimit,
    observer: impl FnMut(usize, &Group) -> W,
) -> Result<Program, CompileError> {
    let solids: Vec<&Solid> = regions.iter().map(|region| &region.solid).collect();
    let infos = regions.iter().map(|r| RegionInfo { name: r.name.clone(), medium: r.medium }).collect();
    compile(&solids, infos, limit, observer)
}

fn solid_name(solid: &Solid) -> String {
    match solid.node() {
        crate::Node::Named(name, _) => name.to_string(),
        _ => "solid".to_owned(),
    }
}

fn compile<W: Observer>(
    solids: &[&Solid],
    regions: Vec<RegionInfo>,
    limit: &LeafLimit,
    mut observer: impl FnMut(usize, &Group) -> W,
) -> Result<Program, CompileError> {
    let groups = lower(solids, limit)?;
    let order = inner_first(&groups);
    let mut compiler = Compiler { labels: Labels::default(), done: groups.iter().map(|_| None).collect() };
    // leaf and surface numbers run group by group with the model first, not in the order of compilation
    let mut first_leaf = 0;
    let firsts: Vec<u32> = groups
        .iter()
        .map(|group| {
            let first = first_leaf;
            first_leaf += group.leaf_count as u32;
            first
        })
        .collect();
    let mut tables: Vec<Option<GroupTables>> = groups.iter().map(|_| None).collect();
    let mut groups: Vec<Option<Group>> = groups.into_iter().map(Some).collect();
    for id in order {
        let Some(group) = groups[id].take() else {
            continue;
        };
        let mut observer = observer(id, &group);
        tables[id] = Some(compiler.group(id, group, firsts[id], &mut observer)?);
    }
    Ok(compiler.assemble(tables, regions))
}

/// The groups in an order in which placed solids come before the groups that place them.
fn inner_first(groups: &[Group]) -> Vec<usize> {
    let inner = |id: usize| {
        groups[id].parts.iter().filter_map(|part| match part.content {
            Content::Copies(prototype, ..) => Some(prototype.index()),
            Content::Shape(_) => None,
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
    leaves: LeafTable,
    surfaces: Vec<SurfaceEntry>,
    trail: Trail,
}

struct Compiler {
    labels: Labels,
    /// The extents of the groups compiled so far, for those that place them.
    done: Vec<Option<Extent>>,
}

impl Compiler {
    fn group(
        &mut self,
        id: usize,
        group: Group,
        first_leaf: u32,
        observer: &mut impl Observer,
    ) -> Result<GroupTables, CompileError> {
        let inner = |prototype: crate::PrototypeId| self.done[prototype.index()].unwrap_or_default();
        let mut tables = Tables::of(&group, &mut self.labels, inner)?;
        let path = group.parts.first().map(|part| group.path(part)).unwrap_or_default();
        let (formula, trail) = group.into_formula();
        tables.share(&path, &self.labels)?;
        let prepared = tables.prepare(formula, inner, observer);
        self.done[id] = Some(prepared.extent);
        let Tables { leaves, surfaces, .. } = tables;
        let prototype = Prototype {
            leaves: first_leaf..first_leaf + leaves.len() as u32,
            network: Network::new(&prepared.expression),
            expression: prepared.expression,
            bounds: prepared.extent.bounds,
            ball: prepared.ball,
            condition: prepared.extent.condition,
            placements: prepared.extent.placements,
            extent: prepared.extent,
            instances: 0..leaves.instances.len() as u32,
        };
        Ok(GroupTables { prototype, leaves, surfaces, trail })
    }

    /// Concatenates the tables of all groups and shifts their numbers accordingly.
    fn assemble(self, tables: Vec<Option<GroupTables>>, regions: Vec<RegionInfo>) -> Program {
        let mut program = Program {
            prototypes: Vec::new(),
            surfaces: Vec::new(),
            leaves: LeafTable::default(),
            regions,
            trails: Vec::new(),
        };
        for mut group in tables.into_iter().flatten() {
            let runs = program.leaves.instances.len() as u32;
            let instances = &mut group.prototype.instances;
            *instances = instances.start + runs..instances.end + runs;
            let surfaces = program.surfaces.len() as u32;
            // most models have one large group: its tables are moved, not copied
            if program.leaves.len() == 0 {
                (program.leaves, program.surfaces) = (group.leaves, group.surfaces);
            } else {
                program.leaves.append(group.leaves, surfaces, |label| label);
                program.surfaces.append(&mut group.surfaces);
            }
            program.prototypes.push(group.prototype);
            program.trails.push(group.trail);
        }
        program.leaves.labels = self.labels.into_labels();
        program.leaves.shrink_to_fit();
        program.surfaces.shrink_to_fit();
        program
    }
}
