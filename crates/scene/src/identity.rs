//! Identity of a scene: a hash of everything that results depend on.

use crate::datum::to_toml;
use crate::document::Document;
use crate::scene::Scene;
use rayweave_table::ContentHash;
use std::fmt::Write;

impl Scene {
    /// A hash of the contents: unit, parameters, solids with their meshes, regions, media, camera, lights, pictures. Equal scenes have
    /// equal hashes, on every machine, whatever files they come from. Takes time linear in the size of the scene.
    ///
    /// The tables of other programs belong to the document: see [`Document::tables_hash`].
    ///
    /// ```
    /// let scene = |radius: &str| {
    ///     let text = format!("rayweave = 1\n[solid.ball]\nsphere = {{ radius = {radius} }}\n[[region]]\nsolid = 'ball'\n");
    ///     rayweave_scene::parse(&text).map(|(_, scene)| scene.content_hash())
    /// };
    /// assert_eq!(scene("2")?, scene("2.0")?);
    /// assert_ne!(scene("2")?, scene("2.1")?);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn content_hash(&self) -> String {
        let mut hash = ContentHash::new();
        hash.bytes(Document::from_scene(self).to_toml().as_bytes());
        // `from_scene` evaluates the parameters, but tables of other programs use them
        write_debug(&mut hash, &self.parameters);
        hash.finish()
    }
}

impl Document {
    /// A hash of the tables of other programs, such as `[optics]`, without their comments and layout.
    pub fn tables_hash(&self) -> String {
        let mut hash = ContentHash::new();
        for table in &self.foreign {
            write_debug(&mut hash, &(&table.name.value, to_toml(&table.value.value)));
        }
        hash.finish()
    }
}

fn write_debug(hash: &mut ContentHash, value: &impl std::fmt::Debug) {
    // writing to a hash cannot fail
    let _ = write!(hash, "{value:?}");
}
