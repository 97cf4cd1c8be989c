//! Touching copies of a volume, as regions of their own.
//!
//! A photon stops where the region changes. Copies of one volume are one region, so that it would not stop where two of them
//! touch, and an optical surface there would have no effect. The copies of a volume with a surface are therefore divided into
//! regions without copies that touch each other.

use rayweave_math::{Affine, Bounds};
use rayweave_model::{Copies, Node, Program, Solid};
use rayweave_scene::{Datum, Scene, SceneRegion};
use std::borrow::Cow;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// The largest number of copies in one mother that are compared.
const MAX_COPIES: usize = 100_000;

/// The largest number of regions of a volume.
const MAX_PARTS: usize = 64;

/// Boxes closer than this part of their size touch. Copies that only seem to touch are divided without any other effect.
const NEAR: f64 = 1e-6;

/// The scene with the touching copies of volumes with surfaces divided; regions of one volume follow each other and have its name.
pub(super) fn divide_touching_copies<'s>(table: &Datum, scene: &'s Scene) -> Cow<'s, Scene> {
    let with_surface = regions_with_surface(table);
    let parts = |region: &SceneRegion| match with_surface.contains(region.name.as_str()) {
        true => divided(&region.solid),
        false => vec![region.solid.clone()],
    };
    let all: Vec<Vec<Solid>> = scene.regions.iter().map(parts).collect();
    if all.iter().all(|parts| parts.len() == 1) {
        return Cow::Borrowed(scene);
    }
    let own = |(region, parts): (&SceneRegion, Vec<Solid>)| {
        let region = region.clone();
        parts.into_iter().map(move |solid| SceneRegion { solid, ..region.clone() })
    };
    let regions = scene.regions.iter().zip(all).flat_map(own).collect();
    Cow::Owned(Scene { regions, ..scene.clone() })
}

/// The regions of volumes with a skin surface, or with a border surface between two of their copies.
fn regions_with_surface(table: &Datum) -> HashSet<&str> {
    let skins = table.list("skin").flat_map(|row| row.list("volume")).filter_map(Datum::as_text);
    let mut volumes: HashSet<&str> = skins.collect();
    for row in table.list("border") {
        let names: Vec<&str> = row.list("placements").filter_map(Datum::as_text).collect();
        let [first, second] = names.as_slice() else { continue };
        let [first, second] = [first, second].map(|name| volumes_of_placement(table, name));
        volumes.extend(first.intersection(&second));
    }
    let rows = table.list("volume").filter(|row| volumes.contains(row.text("name")));
    rows.map(|row| row.text("region")).collect()
}

/// The volumes that are placed under a name.
fn volumes_of_placement<'d>(table: &'d Datum, name: &str) -> HashSet<&'d str> {
    let daughters = table.list("volume").flat_map(|row| row.list("daughters"));
    daughters
        .filter(|daughter| daughter.text("name") == name)
        .map(|daughter| daughter.text("volume"))
        .collect()
}

/// A solid, placed by the copies of a volume and of its mothers, as solids without touching copies.
fn divided(solid: &Solid) -> Vec<Solid> {
    // from the outermost mother inwards
    let (mut levels, mut inner) = (Vec::new(), solid.clone());
    loop {
        inner = match inner.node() {
            // shapes made of copies have no names of volumes
            Node::Placed(own, copies) if copies.name().is_some() => {
                levels.push(copies.clone());
                own.clone()
            }
            _ => break,
        };
    }
    let mut parts = vec![inner.clone()];
    for copies in levels.iter().rev() {
        let classes = classes(&inner, copies.maps());
        inner = inner.place_copies(copies.clone());
        let few = classes.len() * parts.len() <= MAX_PARTS;
        let classes = if few { classes } else { vec![(0..copies.maps().len()).collect()] };
        let place = |part: &Solid| {
            let chosen = |class: &Vec<usize>| part.place_copies(subset(copies, class));
            classes.iter().map(chosen).collect::<Vec<Solid>>()
        };
        parts = parts.iter().flat_map(place).collect();
    }
    if parts.len() == 1 { vec![solid.clone()] } else { parts }
}

/// Some of several copies, with the numbers that they have among all. Copies with equal numbers differ by their order.
fn subset(copies: &Copies, chosen: &[usize]) -> Copies {
    if chosen.len() == copies.maps().len() {
        return copies.clone();
    }
    let number = |&k: &usize| {
        let stated = copies.numbers().and_then(|numbers| numbers.get(k).copied());
        stated.unwrap_or(k as i64)
    };
    let maps: Vec<Affine> = chosen.iter().map(|&k| copies.maps()[k]).collect();
    let numbers: Arc<[i64]> = chosen.iter().map(number).collect();
    let some = Copies::labelled(maps, copies.name().unwrap_or_default(), Some(numbers));
    let mut seen: HashMap<i64, u32> = HashMap::new();
    let mut ordinal = |k: usize| {
        let count = seen.entry(number(&k)).or_default();
        *count += 1;
        *count - 1
    };
    let ordinals: Vec<u32> = (0..copies.maps().len()).map(&mut ordinal).collect();
    match seen.len() < ordinals.len() {
        true => some.with_ordinals(chosen.iter().map(|&k| ordinals[k]).collect()),
        false => some,
    }
}

/// Classes of copies that do not touch each other, by their boxes: each copy gets the first class without a neighbour.
fn classes(solid: &Solid, maps: &[Affine]) -> Vec<Vec<usize>> {
    let whole = || vec![(0..maps.len()).collect()];
    let bounds = Program::compile(solid).map(|program| program.bounds());
    let Ok(bounds) = bounds else { return whole() };
    if maps.len() < 2 || maps.len() > MAX_COPIES || !bounds.is_finite() || bounds.is_empty() {
        return whole();
    }
    let margin = NEAR * bounds.size().length();
    let boxes: Vec<Bounds> = maps.iter().map(|map| bounds.transformed(map).grown(margin)).collect();
    // a sweep along the axis in which the copies are spread most
    let spread = boxes.iter().fold(Bounds::EMPTY, |a, b| a.union(b)).size().to_array();
    let axis = (0..3).max_by(|&a, &b| spread[a].total_cmp(&spread[b])).unwrap_or(0);
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| boxes[a].lo[axis].total_cmp(&boxes[b].lo[axis]));
    let (mut class_of, mut active) = (vec![0; boxes.len()], Vec::<usize>::new());
    for k in order {
        active.retain(|&other| boxes[other].hi[axis] >= boxes[k].lo[axis]);
        let touching = active.iter().filter(|&&other| !boxes[other].intersection(&boxes[k]).is_empty());
        let taken: HashSet<usize> = touching.map(|&other| class_of[other]).collect();
        class_of[k] = (0..).find(|class| !taken.contains(class)).unwrap_or(0);
        active.push(k);
    }
    let count = class_of.iter().max().map_or(1, |last| last + 1);
    (0..count).map(|class| (0..boxes.len()).filter(|&k| class_of[k] == class).collect()).collect()
}
