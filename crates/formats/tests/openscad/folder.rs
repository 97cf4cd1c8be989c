//! Temporary folders with dumps and the files that they refer to.

use rayweave_formats::{Imported, Options, load};
use rayweave_math::Bounds;
use rayweave_model::Program;
use std::path::PathBuf;

/// A temporary folder, removed when dropped.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Folder {
        let folder = std::env::temp_dir().join(format!("rayweave-openscad-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        Folder(folder)
    }

    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.0.join(name), text).expect("a file");
    }

    /// Reads a dump in the folder.
    pub fn read(&self, text: &str) -> Imported {
        self.read_with(text, &Options::default())
    }

    pub fn read_with(&self, text: &str, options: &Options) -> Imported {
        self.write("part.csg", text);
        load(self.0.join("part.csg"), None, &[], options)
            .unwrap_or_else(|problems| panic!("{text}\n{problems}"))
    }

    /// Bounding box of a dump.
    pub fn bounds(&self, text: &str) -> Bounds {
        let scene = self.read(text).scene;
        Program::compile_regions(&scene.model_regions()).expect("the solids compile").bounds()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}
