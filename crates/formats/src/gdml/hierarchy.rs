//! Volume hierarchy: conversion of the graph of logical volumes to regions.

use super::context::Context;
use super::graph::{Daughter, Graph, Volume};
use super::materials::Material;
use super::problem::Problem;
use super::table::table;
use rayweave_math::Affine;
use rayweave_model::{Copies, Solid};
use rayweave_scene::{Colour, Medium, Scene, SceneRegion, Table, Unit};
use std::collections::{HashMap, HashSet};

/// The scene, with one region per volume that is placed in the world.
pub(super) fn scene(context: &mut Context, graph: &Graph, world: usize) -> Option<(Scene, Table)> {
    let order = match order(graph, world) {
        Ok(order) => order,
        Err(cycle) => {
            context.error(cycle_problem(graph, &cycle));
            return None;
        }
    };
    let media = Media::new(graph);
    let ancestry = Ancestry::new(graph, &order);
    let (mut regions, mut taken) = (Vec::new(), Taken::default());
    let (mut names, mut nested) = (HashMap::new(), 0);
    for &volume in order.iter().filter(|&&volume| !(volume == world && is_room(&graph.volumes[world]))) {
        let Some((solid, steps)) = ancestry.in_world(graph, volume) else {
            continue;
        };
        nested += steps;
        if nested > context.size_limit() {
            let message = format!(
                "the volumes up to `{}` are nested too deeply: all of them together are in more than {} others.",
                graph.volumes[volume].name,
                context.size_limit()
            );
            context.error(Problem::new(message, graph.volumes[volume].place));
            return None;
        }
        let name = taken.free(graph.volumes[volume].bare_name());
        names.insert(volume, name.clone());
        let medium = media.of(&graph.volumes[volume]);
        let colour = colour(&graph.volumes[volume], medium, volume == world);
        regions.push(SceneRegion { name, solid, medium, colour });
    }
    let table = table(graph, world, &order, &names, &media.names);
    Some((Scene::from_regions(Unit::Millimetre, regions, media.list), table))
}

/// True for a world that the writer added around the regions of a scene.
fn is_room(world: &Volume) -> bool {
    world.auxiliary.iter().any(|tag| [tag.kind.as_str(), tag.value.as_str()] == NO_REGION)
}

/// The volumes in the world in topological order, mothers before their daughters.
///
/// # Errors
///
/// A cycle: volumes each of which contains the next, with the first one repeated at the end.
pub(super) fn order(graph: &Graph, world: usize) -> Result<Vec<usize>, Vec<usize>> {
    // 0: not visited, 1: on the current path, 2: done
    let mut state = vec![0u8; graph.volumes.len()];
    let (mut way, mut done) = (vec![(world, 0)], Vec::new());
    state[world] = 1;
    while let Some((volume, next)) = way.last_mut() {
        let volume = *volume;
        match graph.daughters(volume).get(*next).map(|daughter| daughter.volume) {
            None => {
                state[volume] = 2;
                done.push(volume);
                way.pop();
            }
            Some(daughter) => {
                *next += 1;
                match state[daughter] {
                    0 => {
                        state[daughter] = 1;
                        way.push((daughter, 0));
                    }
                    1 => return Err(cycle(&way, daughter)),
                    _ => {}
                }
            }
        }
    }
    done.reverse();
    Ok(by_depth(graph, &done))
}

fn cycle(way: &[(usize, usize)], again: usize) -> Vec<usize> {
    let ring = way.iter().map(|(volume, _)| *volume).skip_while(|volume| *volume != again);
    ring.chain([again]).collect()
}

/// Sorts by the length of the longest path from the world, then by file order.
fn by_depth(graph: &Graph, order: &[usize]) -> Vec<usize> {
    let mut depth = vec![0usize; graph.volumes.len()];
    for &mother in order {
        for daughter in graph.daughters(mother) {
            depth[daughter.volume] = depth[daughter.volume].max(depth[mother] + 1);
        }
    }
    let mut sorted = order.to_vec();
    sorted.sort_by_key(|volume| (depth[*volume], *volume));
    sorted
}

fn cycle_problem(graph: &Graph, cycle: &[usize]) -> Problem {
    let names: Vec<&str> = cycle.iter().map(|volume| graph.volumes[*volume].name.as_str()).collect();
    let place = graph.volumes[cycle[0]].place;
    Problem::new(format!("the volume `{}` contains itself: {}.", names[0], names.join(" contains ")), place)
}

/// A mother, and the copies of a daughter in it.
type Mother = (usize, Copies);

/// The placements of all volumes in their mothers.
pub(super) struct Ancestry {
    /// Mothers of each volume, each with the maps of all placements in it.
    mothers: HashMap<usize, Vec<Mother>>,
    /// Rank of each volume in the order.
    rank: HashMap<usize, usize>,
    order: Vec<usize>,
}

impl Ancestry {
    pub fn new(graph: &Graph, order: &[usize]) -> Ancestry {
        let mut mothers: HashMap<usize, Vec<Mother>> = HashMap::new();
        for &mother in order {
            let (mut all, mut met): (HashMap<usize, Numbered>, Vec<usize>) = Default::default();
            for daughter in graph.daughters(mother) {
                let copies = all.entry(daughter.volume).or_default();
                if copies.maps.is_empty() {
                    met.push(daughter.volume);
                }
                copies.extend(daughter);
            }
            for daughter in met {
                let copies = all.remove(&daughter).unwrap_or_default();
                let copies = copies.labelled(graph.volumes[daughter].bare_name());
                mothers.entry(daughter).or_default().push((mother, copies));
            }
        }
        let rank = order.iter().enumerate().map(|(rank, volume)| (*volume, rank)).collect();
        Ancestry { mothers, rank, order: order.to_vec() }
    }

    /// All copies of a volume, in the frame of the world. The copies are collected from mother to mother, and all paths
    /// through the same mother are merged there, so that copies of copies take little memory. Also returns the number of
    /// placements on the way.
    pub fn in_world(&self, graph: &Graph, volume: usize) -> Option<(Solid, usize)> {
        let mut steps = 0;
        let solid = graph.volumes[volume].solid()?.clone();
        let mut waiting = std::collections::BTreeMap::from([(self.rank[&volume], vec![solid])]);
        while let Some((rank, parts)) = waiting.pop_last() {
            let all = if parts.len() == 1 { parts.into_iter().next()? } else { Solid::union(parts) };
            if rank == 0 {
                return Some((all, steps));
            }
            for (mother, copies) in self.mothers.get(&self.order[rank]).into_iter().flatten() {
                if !copies.is_empty() {
                    steps += 1;
                    waiting.entry(self.rank[mother]).or_default().push(all.place_copies(copies.clone()));
                }
            }
        }
        // a volume without copies
        None
    }
}

/// The copies of a volume in one mother, with the copy numbers of the file.
#[derive(Default)]
struct Numbered {
    maps: Vec<Affine>,
    numbers: Vec<i64>,
    /// True if a number differs from the position among the copies.
    is_numbered: bool,
}

impl Numbered {
    fn extend(&mut self, daughter: &Daughter) {
        for (k, map) in daughter.maps.iter().enumerate() {
            let counted = self.maps.len() as i64;
            let number = daughter.copy.map_or(counted, |first| first.saturating_add(k as i64));
            self.is_numbered |= number != counted;
            self.maps.push(*map);
            self.numbers.push(number);
        }
    }

    /// The copies, named after their volume. A copy with its own dimensions is a volume `name[k]`.
    fn labelled(self, volume: &str) -> Copies {
        let sized = volume.strip_suffix(']').and_then(|text| text.rsplit_once('['));
        let sized = sized.and_then(|(name, k)| Some((name, k.parse::<i64>().ok()?)));
        match sized {
            Some((name, k)) if self.maps.len() == 1 => Copies::labelled(self.maps, name, Some([k].into())),
            _ => {
                let numbers = self.is_numbered.then(|| self.numbers.into());
                Copies::labelled(self.maps, volume, numbers)
            }
        }
    }
}

/// Names in use, with a counter per base name, since many volumes may share a name.
#[derive(Default)]
struct Taken {
    names: HashSet<String>,
    counts: HashMap<String, usize>,
}

impl Taken {
    /// The first unused name of name, name2, name3, ...
    fn free(&mut self, name: &str) -> String {
        let name = if name.is_empty() { "volume" } else { name };
        let count = self.counts.entry(name.to_owned()).or_insert(0);
        loop {
            *count += 1;
            let candidate = if *count == 1 { name.to_owned() } else { format!("{name}{count}") };
            if self.names.insert(candidate.clone()) {
                return candidate;
            }
        }
    }
}

/// The media of the scene: the surroundings, the materials, and one for volumes without material.
struct Media {
    list: Vec<Medium>,
    /// Name of the medium of each material.
    names: Vec<String>,
}

/// Auxiliary tag (kind and value) of a world that the writer added as the bounding box of a model; the reader creates no
/// region for it.
pub(crate) const NO_REGION: [&str; 2] = ["rayweave", "room"];

/// The medium of volumes without material.
pub(crate) const UNSPECIFIED: &str = "unspecified";

impl Media {
    fn new(graph: &Graph) -> Media {
        let outside = Medium { name: "world".to_owned(), ..Medium::default() };
        let mut taken = Taken::default();
        taken.names.extend([outside.name.clone(), UNSPECIFIED.to_owned()]);
        let mut list = vec![outside];
        let free = |material: &Material| taken.free(material.bare_name());
        let names: Vec<String> = graph.materials.list.iter().map(free).collect();
        list.extend(
            graph.materials.list.iter().zip(&names).map(|(material, name)| material.medium(name.clone())),
        );
        if graph.volumes.iter().any(|volume| volume.material.is_none() && volume.shape.is_some()) {
            list.push(Medium { name: UNSPECIFIED.to_owned(), ..Medium::default() });
        }
        Media { list, names }
    }

    fn of(&self, volume: &Volume) -> u32 {
        let last = self.list.len() - 1;
        volume.material.map_or(last, |material| material + 1) as u32
    }
}

/// Colour of a volume: that of the auxiliary tag `Color`, else a colour per medium. The world is transparent.
fn colour(volume: &Volume, medium: u32, is_world: bool) -> Colour {
    let tag = volume.auxiliary.iter().find(|tag| tag.kind.eq_ignore_ascii_case("color"));
    let stated =
        tag.and_then(|tag| Colour::parse(&tag.value).or_else(|| Colour::parse(&format!("#{}", tag.value))));
    let palette = Colour::numbered(medium.saturating_sub(1) as usize);
    let colour = stated.unwrap_or(palette);
    if is_world { Colour { alpha: 0, ..colour } } else { colour }
}
