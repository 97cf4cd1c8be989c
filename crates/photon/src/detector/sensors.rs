//! Sensitive volumes: the auxiliary tag `SensDet`.

use super::gdml::region_numbers;
use rayweave_scene::{Datum, Scene};

/// The tag of sensitive volumes in GDML files.
const SENSITIVE: &str = "SensDet";

/// The name of the sensor of each region, if it is sensitive; region 0 is the world.
pub(super) fn names(table: &Datum, scene: &Scene) -> Vec<Option<String>> {
    let numbers = region_numbers(scene);
    let mut sensors = vec![None; scene.regions.len() + 1];
    for row in table.list("volume") {
        let regions = numbers.get(row.text("region"));
        let is_sensitive = |tag: &&Datum| tag.text("type") == SENSITIVE;
        let name = row
            .list("auxiliary")
            .filter(is_sensitive)
            .find_map(|tag| tag.get("value")?.as_text().map(str::to_owned));
        if let (Some(regions), Some(name)) = (regions, name) {
            regions.iter().for_each(|&region| sensors[region as usize] = Some(name.clone()));
        }
    }
    sensors
}
