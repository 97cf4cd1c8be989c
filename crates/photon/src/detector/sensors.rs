//! Sensitive volumes: the auxiliary tag `SensDet`.

use rayweave_scene::{Datum, Scene};
use std::collections::HashMap;

/// The tag of sensitive volumes in GDML files.
const SENSITIVE: &str = "SensDet";

/// The name of the sensor of each region, if it is sensitive; region 0 is the world.
pub(super) fn names(table: &Datum, scene: &Scene) -> Vec<Option<String>> {
    let numbers: HashMap<&str, usize> =
        scene.regions.iter().zip(1..).map(|(region, number)| (region.name.as_str(), number)).collect();
    let mut sensors = vec![None; scene.regions.len() + 1];
    for row in table.get("volume").into_iter().flat_map(Datum::items) {
        let region = row.get("region").and_then(Datum::as_text).and_then(|name| numbers.get(name));
        let tags = row.get("auxiliary").into_iter().flat_map(Datum::items);
        let is_sensitive = |tag: &&Datum| tag.get("type").and_then(Datum::as_text) == Some(SENSITIVE);
        let name = tags.filter(is_sensitive).find_map(|tag| tag.get("value")?.as_text().map(str::to_owned));
        if let (Some(&region), Some(name)) = (region, name) {
            sensors[region] = Some(name);
        }
    }
    sensors
}
