//! From the graph of volumes to regions.

use super::materials::Material;
use super::structure::{Graph, Volume};
use super::table::table;
use super::{Context, NO_REGION, Trouble};
use rayweave_math::Affine;
use rayweave_model::Solid;
use rayweave_scene::{Colour, Medium, Scene, SceneRegion, Table, Unit};
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The scene, with one region for each volume that is in the world.
pub(super) fn scene(context: &mut Context, graph: &Graph, world: usize) -> Option<(Scene, Table)> {
    let order = match order(graph, world) {
        Ok(order) => order,
        Err(cycle) => {
            context.error(cycle_trouble(graph, &cycle));
            return None;
        }
    };
    let media = Media::new(graph);
    let ancestry = Ancestry::new(graph, &order);
    let (mut regions, mut taken) = (Vec::new(), Taken::default());
    let mut names = HashMap::new();
    for &volume in order.iter().filter(|&&volume| !(volume == world && is_room(&graph.volumes[world]))) {
        let Some(solid) = ancestry.in_world(graph, volume) else {
            continue;
        };
        let name = taken.free(graph.volumes[volume].bare_name());
        names.insert(volume, name.clone());
        let medium = media.of(&graph.volumes[volume]);
        let colour = colour(&graph.volumes[volume], medium, volume == world);
        regions.push(SceneRegion { name, solid, medium, colour });
    }
    let table = table(graph, world, &order, &names, &media.names);
    let solids = regions.iter().map(|region| (region.name.clone(), region.solid.clone())).collect();
    let scene = Scene {
        unit: Unit::Millimetre,
        parameters: Vec::new(),
        solids,
        regions,
        media: media.list,
        camera: None,
        lights: Vec::new(),
        render: Default::default(),
        warnings: Default::default(),
    };
    Some((scene, table))
}

/// True for a world that was put around the regions of a scene when it was written.
fn is_room(world: &Volume) -> bool {
    world.auxiliary.iter().any(|tag| [tag.kind.as_str(), tag.value.as_str()] == NO_REGION)
}

/// The volumes within the world, mothers before all their daughters.
///
/// # Errors
///
/// Volumes each of which is in the one before, the last and the first the same.
pub(super) fn order(graph: &Graph, world: usize) -> Result<Vec<usize>, Vec<usize>> {
    // 0: not met, 1: on the way down to the current one, 2: done
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

/// By the length of the longest way from the world, and as the file has them among equals.
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

fn cycle_trouble(graph: &Graph, cycle: &[usize]) -> Trouble {
    let names: Vec<&str> = cycle.iter().map(|volume| graph.volumes[*volume].name.as_str()).collect();
    let place = graph.volumes[cycle[0]].place;
    Trouble::new(format!("the volume `{}` contains itself ({})", names[0], names.join(" contains ")), place)
}

/// A mother, and the maps of a daughter into it.
type Mother = (usize, Arc<[Affine]>);

/// Which volumes are placed where.
pub(super) struct Ancestry {
    /// For each volume its mothers, each with the maps of all its placements there.
    mothers: HashMap<usize, Vec<Mother>>,
    /// The place of each volume in the order.
    rank: HashMap<usize, usize>,
    order: Vec<usize>,
}

impl Ancestry {
    pub fn new(graph: &Graph, order: &[usize]) -> Ancestry {
        let mut mothers: HashMap<usize, Vec<Mother>> = HashMap::new();
        for &mother in order {
            let (mut maps, mut met): (HashMap<usize, Vec<Affine>>, Vec<usize>) = Default::default();
            for daughter in graph.daughters(mother) {
                let all = maps.entry(daughter.volume).or_default();
                if all.is_empty() {
                    met.push(daughter.volume);
                }
                all.extend(&daughter.maps);
            }
            for daughter in met {
                let maps = maps.remove(&daughter).unwrap_or_default();
                mothers.entry(daughter).or_default().push((mother, maps.into()));
            }
        }
        let rank = order.iter().enumerate().map(|(rank, volume)| (*volume, rank)).collect();
        Ancestry { mothers, rank, order: order.to_vec() }
    }

    /// All copies of a volume, in the frame of the world. Its solid goes up from mother to mother, and all ways that meet in one
    /// go on as one, so that what has many copies of many copies stays small.
    pub fn in_world(&self, graph: &Graph, volume: usize) -> Option<Solid> {
        let solid = graph.volumes[volume].solid()?.clone();
        let mut waiting = std::collections::BTreeMap::from([(self.rank[&volume], vec![solid])]);
        while let Some((rank, parts)) = waiting.pop_last() {
            let all = if parts.len() == 1 { parts.into_iter().next()? } else { Solid::union(parts) };
            if rank == 0 {
                return Some(all);
            }
            for (mother, maps) in self.mothers.get(&self.order[rank]).into_iter().flatten() {
                if !maps.is_empty() {
                    waiting.entry(self.rank[mother]).or_default().push(copies(&all, maps));
                }
            }
        }
        // a volume of which there are no copies
        None
    }
}

fn copies(solid: &Solid, maps: &Arc<[Affine]>) -> Solid {
    match &maps[..] {
        [map] if *map == Affine::IDENTITY => solid.clone(),
        [map] => solid.apply(*map),
        _ => solid.place(maps.clone()),
    }
}

/// Names that are taken, and for each how many have asked for it: many volumes of one name are common.
#[derive(Default)]
struct Taken {
    names: HashSet<String>,
    counts: HashMap<String, usize>,
}

impl Taken {
    /// The first of name, name2, name3, .. that is free.
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

/// The media of the scene: that around the world, the materials, and one for volumes that name none.
struct Media {
    list: Vec<Medium>,
    /// The name of the medium of each material.
    names: Vec<String>,
}

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

/// The colour that a volume's tag `Color` gives, or one for each medium. The world is clear, to be seen through.
fn colour(volume: &Volume, medium: u32, is_world: bool) -> Colour {
    let tag = volume.auxiliary.iter().find(|tag| tag.kind.eq_ignore_ascii_case("color"));
    let stated =
        tag.and_then(|tag| Colour::parse(&tag.value).or_else(|| Colour::parse(&format!("#{}", tag.value))));
    let palette = Colour::numbered(medium.saturating_sub(1) as usize);
    let colour = stated.unwrap_or(palette);
    if is_world { Colour { alpha: 0, ..colour } } else { colour }
}
