//! Mothers and daughters of regions.

use rayweave_scene::{Datum, Document, Scene, Table};
use std::collections::HashMap;

/// The placement of regions in other regions, as a GDML file defines it for volumes (mother and daughter
/// volumes).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hierarchy {
    /// The mothers of each region.
    mothers: Vec<Vec<usize>>,
}

impl Hierarchy {
    /// Creates a hierarchy from the mothers of each region, as region numbers from 0.
    pub fn new(mothers: Vec<Vec<usize>>) -> Hierarchy {
        Hierarchy { mothers }
    }

    /// The hierarchy of the table `[gdml]` of a document, for the regions of its scene; `None` if there is no
    /// such table.
    pub fn of(document: &Document, scene: &Scene) -> Option<Hierarchy> {
        let Datum::Table(table) = &document.foreign("gdml")?.value.value else { return None };
        let rows: Vec<&Table> = list(table, "volume").filter_map(as_table).collect();
        let numbers: HashMap<&str, usize> =
            scene.regions.iter().enumerate().map(|(k, region)| (region.name.as_str(), k)).collect();
        let by_name: HashMap<&str, usize> =
            rows.iter().enumerate().filter_map(|(k, row)| Some((text(row, "name")?, k))).collect();
        let region_of = |row: &Table| text(row, "region").and_then(|name| numbers.get(name).copied());
        let mut mothers = vec![Vec::new(); scene.regions.len()];
        for row in &rows {
            let Some(mother) = region_of(row) else { continue };
            // an assembly has no region: its daughters belong to the volume around it
            let (mut waiting, mut met) = (daughters(row), vec![false; rows.len()]);
            while let Some(name) = waiting.pop() {
                let Some(&k) = by_name.get(name).filter(|&&k| !std::mem::replace(&mut met[k], true)) else {
                    continue;
                };
                match region_of(rows[k]) {
                    Some(daughter) => mothers[daughter].push(mother),
                    None => waiting.extend(daughters(rows[k])),
                }
            }
        }
        Some(Hierarchy { mothers })
    }

    /// The regions in which a region is placed.
    pub fn mothers(&self, region: usize) -> &[usize] {
        self.mothers.get(region).map_or(&[], Vec::as_slice)
    }

    /// True if the first region is placed in the second one, directly or through others.
    pub fn is_within(&self, region: usize, other: usize) -> bool {
        let mut waiting = self.mothers(region).to_vec();
        let mut met = vec![false; self.mothers.len()];
        while let Some(mother) = waiting.pop() {
            if mother == other {
                return true;
            }
            if met.get(mother) == Some(&false) {
                met[mother] = true;
                waiting.extend(self.mothers(mother));
            }
        }
        false
    }
}

fn value<'t>(table: &'t Table, key: &str) -> Option<&'t Datum> {
    table.iter().find(|(own, _)| own.value == key).map(|(_, value)| &value.value)
}

fn text<'t>(table: &'t Table, key: &str) -> Option<&'t str> {
    match value(table, key)? {
        Datum::Text(text) => Some(text),
        _ => None,
    }
}

fn list<'t>(table: &'t Table, key: &str) -> impl Iterator<Item = &'t Datum> {
    let items = match value(table, key) {
        Some(Datum::List(items)) => items.as_slice(),
        _ => &[],
    };
    items.iter().map(|item| &item.value)
}

fn as_table(datum: &Datum) -> Option<&Table> {
    match datum {
        Datum::Table(table) => Some(table),
        _ => None,
    }
}

fn daughters(row: &Table) -> Vec<&str> {
    list(row, "daughters").filter_map(as_table).filter_map(|daughter| text(daughter, "volume")).collect()
}
