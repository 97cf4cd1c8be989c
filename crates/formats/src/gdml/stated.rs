//! The volume tree in the table `[gdml]` of a document, read back for the writer.

use super::graph::{Daughter, Graph, Volume};
use super::hierarchy::{Ancestry, order};
use super::problem::Place;
use super::solids::{Shape, Sizes};
use rayweave_math::{Affine, Mat3, Vec3};
use rayweave_model::{Node, Solid};
use rayweave_scene::{Datum, Scene, Table, lookup};
use std::collections::HashMap;

/// A volume of the tree.
pub(crate) struct VolumeRecord {
    pub name: String,
    /// Index of its region; `None` for assemblies and for the added world.
    pub region: Option<usize>,
    /// Solid in the frame of the volume.
    pub solid: Option<Solid>,
    pub daughters: Vec<Placed>,
}

/// Placements of a volume in its mother.
pub(crate) struct Placed {
    pub name: String,
    pub volume: usize,
    pub copy: Option<i64>,
    pub maps: Vec<Affine>,
}

/// The volumes of a table, mothers first. `None` if the regions of the scene are not those of the table, i.e. if one of
/// them was edited.
pub(crate) fn tree(table: &Table, scene: &Scene) -> Option<Vec<VolumeRecord>> {
    let rows = rows(table, "volume");
    let numbers: HashMap<&str, usize> = rows.iter().zip(0..).map(|(row, k)| (text(row, "name"), k)).collect();
    let regions: HashMap<&str, usize> =
        scene.regions.iter().zip(0..).map(|(region, k)| (region.name.as_str(), k)).collect();
    if numbers.len() != rows.len() || rows.is_empty() {
        return None;
    }
    let records = rows
        .iter()
        .map(|row| volume(row, scene, &regions, &numbers))
        .collect::<Option<Vec<VolumeRecord>>>()?;
    let is_same = records.iter().filter(|record| record.region.is_some()).count() == scene.regions.len()
        && comes_of(&records, &graph(&records), scene);
    is_same.then_some(records)
}

fn volume(
    row: &Table,
    scene: &Scene,
    regions: &HashMap<&str, usize>,
    numbers: &HashMap<&str, usize>,
) -> Option<VolumeRecord> {
    let region = match text(row, "region") {
        "" => None,
        name => Some(*regions.get(name)?),
    };
    let placed = |row: &&Table| {
        let maps = list(row, "maps").iter().map(|map| affine(&map.value)).collect::<Option<Vec<Affine>>>()?;
        let (name, volume) = (text(row, "name").to_owned(), *numbers.get(text(row, "volume"))?);
        let copy = number(row, "copy");
        let is_whole = copy.is_none_or(|copy| f64::from(copy as i32) == copy);
        is_whole.then(|| Placed { name, volume, copy: copy.map(|copy| copy as i64), maps })
    };
    Some(VolumeRecord {
        name: text(row, "name").to_owned(),
        region,
        solid: region.map(|region| own(&scene.regions[region].solid)),
        daughters: self::rows(row, "daughters").iter().map(placed).collect::<Option<_>>()?,
    })
}

/// The solid of a volume, given a region that is the union of its copies; importers give the solid a name.
fn own(copies: &Solid) -> Solid {
    let mut solid = copies.clone();
    loop {
        solid = match solid.node() {
            Node::Transformed(_, inner) | Node::Placed(inner, _) => inner.clone(),
            Node::Union(parts) if !parts.is_empty() => parts[0].clone(),
            _ => return solid,
        };
    }
}

/// The volume graph of the table, as an importer builds it.
fn graph(records: &[VolumeRecord]) -> Graph {
    let daughter = |placed: &Placed| Daughter {
        name: String::new(),
        volume: placed.volume,
        maps: placed.maps.clone(),
        copy: placed.copy,
        place: Place::default(),
    };
    let volume = |(record, content): (&VolumeRecord, usize)| Volume {
        name: record.name.clone(),
        shape: record.solid.clone().map(|solid| Shape { solid, tag: String::new(), sizes: Sizes::default() }),
        material: None,
        daughters: record.daughters.iter().map(daughter).collect(),
        content,
        auxiliary: Vec::new(),
        place: Place::default(),
    };
    Graph::of(records.iter().zip(0..).map(volume).collect())
}

fn comes_of(records: &[VolumeRecord], graph: &Graph, scene: &Scene) -> bool {
    let Ok(order) = order(graph, 0) else { return false };
    if order.len() != records.len() {
        return false;
    }
    let ancestry = Ancestry::new(graph, &order);
    let is_same = |(record, volume): (&VolumeRecord, usize)| match record.region {
        Some(region) => {
            ancestry.in_world(graph, volume).is_some_and(|(solid, _)| solid == scene.regions[region].solid)
        }
        None => true,
    };
    records.iter().zip(0..).all(is_same)
}

/// A string of a table, or "".
pub(crate) fn text<'t>(table: &'t Table, key: &str) -> &'t str {
    lookup(table, key).and_then(Datum::as_text).unwrap_or_default()
}

/// A number of a table.
pub(crate) fn number(table: &Table, key: &str) -> Option<f64> {
    lookup(table, key).and_then(Datum::as_number)
}

/// A list in a table, or an empty one.
pub(crate) fn list<'t>(table: &'t Table, key: &str) -> &'t [rayweave_scene::Spanned<Datum>] {
    match lookup(table, key) {
        Some(Datum::List(list)) => list,
        _ => &[],
    }
}

/// The tables of a list in a table.
pub(crate) fn rows<'t>(table: &'t Table, key: &str) -> Vec<&'t Table> {
    let row = |value: &'t rayweave_scene::Spanned<Datum>| match &value.value {
        Datum::Table(row) => Some(row),
        _ => None,
    };
    list(table, key).iter().filter_map(row).collect()
}

/// A translation vector, or the first three rows of a matrix, as a map.
fn affine(map: &Datum) -> Option<Affine> {
    let Datum::List(values) = map else { return None };
    let value = |value: &rayweave_scene::Spanned<Datum>| match value.value {
        Datum::Number(number) => Some(number),
        _ => None,
    };
    let values = values.iter().map(value).collect::<Option<Vec<f64>>>()?;
    let column = |k: usize| Vec3::new(values[k], values[4 + k], values[8 + k]);
    match values.len() {
        3 => Some(Affine::translate(Vec3::new(values[0], values[1], values[2]))),
        12 => {
            Some(Affine { linear: Mat3::from_cols(column(0), column(1), column(2)), translation: column(3) })
        }
        _ => None,
    }
}
