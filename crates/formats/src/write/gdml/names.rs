//! Names in a file.

use crate::write::model::Model;
use std::collections::HashSet;

/// Unique names in the file: letters, digits and underscores.
pub struct Names {
    pub media: Vec<String>,
    pub regions: Vec<String>,
    pub world: String,
}

impl Names {
    pub fn new(model: &Model) -> Names {
        let mut taken = HashSet::new();
        let mut free = |name: &str| {
            let name = plain(name);
            let numbered = (2..).map(|k| format!("{name}_{k}"));
            let mut all = std::iter::once(name.clone()).chain(numbered);
            let name = all.find(|name| !taken.contains(name)).unwrap_or_default();
            taken.insert(name.clone());
            name
        };
        let media = model.scene.media.iter().map(|medium| free(&format!("m_{}", medium.name))).collect();
        let regions = model.scene.regions.iter().map(|region| free(&region.name)).collect();
        Names { media, regions, world: free("World") }
    }
}

/// A name that is valid in XML and in Geant4, which truncates names at `0x`.
fn plain(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    let plain = plain.replace("0x", "0_x");
    if plain.starts_with(|c: char| c.is_ascii_alphabetic()) { plain } else { format!("r_{plain}") }
}
