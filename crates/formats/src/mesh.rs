//! Files of meshes as models: each closed object is a region.
//!
//! What is read, and how, is told in [`rayweave_mesh::files`]. A file whose objects are each closed gives a region for each, later
//! ones before earlier ones where they overlap; else all its triangles together are one. A mesh that is not closed is an error,
//! one that may not be what was meant a warning, both with where and how often; [`Options::repair`] mends what can be mended
//! safely, and tells what was done.
//!
//! **Units** are the file's where it has one (3MF, and glTF, which is in metres), else [`Options::unit`], else millimetres.
//! glTF has y up: its points (x, y, z) become (x, -z, y), so that what is up there is up here.

use crate::{Format, Imported, LossKind, Options, Report};
use rayweave_math::Vec3;
use rayweave_mesh::files::{self, FileError, Loaded, MeshFormat, ReadOptions};
use rayweave_mesh::{Diagnosis, Mesh, MeshError, Polyhedron, Repair};
use rayweave_model::Solid;
use rayweave_scene::{
    Colour, Diagnostic, Diagnostics, Medium, RenderSettings, Scene, SceneRegion, Source, Unit, memory,
};
use rayweave_shape::primitive::{self, Primitive};
use std::path::Path;
use std::sync::Arc;

/// Reads a file.
pub(crate) fn load(path: &Path, format: MeshFormat, options: &Options) -> Result<Imported, Diagnostics> {
    let source = Arc::new(Source::new(Some(path.to_owned()), String::new()));
    let limits = limits();
    let loaded = files::read(path, Some(format), &limits);
    Import::new(&source, format, options).scene(loaded, &limits)
}

/// Reads a text.
pub(crate) fn parse(
    source: &Arc<Source>,
    format: MeshFormat,
    options: &Options,
) -> Result<Imported, Diagnostics> {
    let limits = limits();
    let loaded = files::read_bytes(source.text().as_bytes(), format, &limits);
    Import::new(source, format, options).scene(loaded, &limits)
}

/// As many triangles as fit into memory.
fn limits() -> ReadOptions {
    memory::available().map_or_else(ReadOptions::default, ReadOptions::within)
}

/// What is collected while a file is read.
struct Import<'a> {
    source: &'a Arc<Source>,
    format: MeshFormat,
    options: &'a Options,
    report: Report,
    warnings: Vec<Diagnostic>,
    problems: Vec<Diagnostic>,
}

impl<'a> Import<'a> {
    fn new(source: &'a Arc<Source>, format: MeshFormat, options: &'a Options) -> Import<'a> {
        let report = Report::default();
        Import { source, format, options, report, warnings: Vec::new(), problems: Vec::new() }
    }

    fn scene(
        mut self,
        loaded: Result<Loaded, FileError>,
        limits: &ReadOptions,
    ) -> Result<Imported, Diagnostics> {
        let loaded = loaded.map_err(|error| Diagnostics::from(self.unreadable(&error, limits)))?;
        let unit = self.unit(&loaded)?;
        for warning in &loaded.warnings {
            self.warnings.push(Diagnostic::warning(warning.clone()).in_file(self.source));
        }
        let objects = self.objects(loaded);
        let is_one = objects.len() == 1;
        let made = objects.into_iter().map(|(name, mesh)| {
            let solid = self.solid(if is_one { None } else { Some(&name) }, mesh)?;
            Some((name, solid))
        });
        let solids: Vec<(String, Polyhedron)> = made.collect::<Vec<_>>().into_iter().flatten().collect();
        if !self.problems.is_empty() {
            return Err(Diagnostics::new(self.problems));
        }
        let mut imported = Imported::from_scene(scene(solids, unit), self.report);
        let warnings = imported.scene.warnings.iter().chain(&self.warnings).cloned();
        imported.scene.warnings = Diagnostics::new(warnings.collect());
        Ok(imported)
    }

    fn unreadable(&self, error: &FileError, limits: &ReadOptions) -> Diagnostic {
        let mut why = match error {
            FileError::Io(error) => rayweave_scene::reason(error),
            error => error.to_string(),
        };
        let is_short = limits.most < ReadOptions::default().most;
        if let (FileError::Mesh { error: MeshError::TooMany { .. }, .. }, true) = (error, is_short) {
            why += &format!(
                "; a triangle takes up to {} bytes while it is read, and there is no more memory",
                ReadOptions::BYTES_A_TRIANGLE
            );
        }
        Diagnostic::error("the mesh cannot be read").why(why).in_file(self.source)
    }

    /// The unit of the file, or the one that was asked for.
    fn unit(&self, loaded: &Loaded) -> Result<Unit, Diagnostics> {
        let own = loaded.unit.as_deref().map(|name| match name {
            "inch" => Unit::Inch,
            "foot" => Unit::Foot,
            name => Unit::parse(name).unwrap_or_default(),
        });
        if own.is_some() {
            crate::report::refuse_unit(self.source, Format::Mesh(self.format), self.options)?;
        }
        Ok(own.or(self.options.unit).unwrap_or_default())
    }

    /// The meshes with their names: one for each object, or one in all.
    fn objects(&mut self, mut loaded: Loaded) -> Vec<(String, Mesh)> {
        if matches!(self.format, MeshFormat::Gltf | MeshFormat::Glb) {
            // no coordinate becomes larger, so that none is refused
            loaded.mesh = loaded.mesh.mapped(|p| Vec3::new(p.x, -p.z, p.y)).unwrap_or(loaded.mesh);
        }
        if loaded.parts.len() > 1 {
            let parts: Vec<(String, Mesh)> =
                loaded.parts.iter().map(|part| (part.name.clone(), loaded.part(part))).collect();
            let open = parts.iter().filter(|(_, mesh)| !mesh.is_closed()).count();
            if open == 0 || (self.options.repair && !loaded.mesh.is_closed()) {
                return parts;
            }
            let (all, why) = (parts.len(), "all triangles together are taken as one solid");
            let warning =
                Diagnostic::warning(format!("{open} of {all} objects are not closed by themselves"));
            self.warnings.push(warning.why(why).in_file(self.source));
        }
        let name = self.source.path().and_then(|path| path.file_stem()).map(|stem| stem.to_string_lossy());
        vec![(name.unwrap_or_default().into_owned(), loaded.mesh)]
    }

    /// The solid within a mesh; what is wrong with it is told.
    fn solid(&mut self, name: Option<&str>, mut mesh: Mesh) -> Option<Polyhedron> {
        let what = name.map_or("the mesh".to_owned(), |name| format!("the mesh of `{name}`"));
        if self.options.repair {
            let (mended, done) = mesh.mended().unwrap_or((mesh, Repair::default()));
            mesh = mended;
            self.tell_repairs(&what, &done);
        }
        let diagnosis = mesh.diagnose();
        match Polyhedron::closed(&mesh, &diagnosis) {
            Ok(solid) => {
                self.doubt(&what, &diagnosis);
                Some(solid)
            }
            Err(error) => {
                let problem = Diagnostic::error(format!("{what} is no solid: {error}")).why(diagnosis);
                let advice = "does `--repair` help (`repair=True` in Python)?".to_owned();
                let advice = (!self.options.repair && error != MeshError::Flat).then_some(advice);
                self.problems.push(problem.suggest(advice).in_file(self.source));
                None
            }
        }
    }

    fn doubt(&mut self, what: &str, diagnosis: &Diagnosis) {
        if !diagnosis.is_sound() {
            let doubt = Diagnostic::warning(format!("{what} may not be what was meant: {diagnosis}"));
            let why = "inside is where a line from infinity has crossed it an odd number of times";
            self.warnings.push(doubt.why(why).in_file(self.source));
        }
    }

    fn tell_repairs(&mut self, what: &str, done: &Repair) {
        for (count, repair) in done.told() {
            let told = Diagnostic::warning(format!("{what} was repaired: {count} {repair}"));
            self.report.add(LossKind::Approximated, repair, told.in_file(self.source));
        }
    }
}

/// A region for each solid.
fn scene(solids: Vec<(String, Polyhedron)>, unit: Unit) -> Scene {
    let mut media = vec![Medium { name: "world".to_owned(), ..Medium::default() }];
    let mut regions: Vec<SceneRegion> = Vec::new();
    for (number, (name, polyhedron)) in solids.into_iter().enumerate() {
        let name = free_name(&name, &regions);
        media.push(Medium { name: name.clone(), ..Medium::default() });
        let solid = Solid::from(Primitive::from(primitive::Mesh::from(polyhedron))).named(&name);
        let colour = Colour::numbered(number);
        regions.push(SceneRegion { name, solid, medium: number as u32 + 1, colour });
    }
    Scene {
        unit,
        parameters: Vec::new(),
        solids: regions.iter().map(|region| (region.name.clone(), region.solid.clone())).collect(),
        regions,
        media,
        camera: None,
        lights: Vec::new(),
        render: RenderSettings::default(),
        warnings: Diagnostics::default(),
    }
}

/// The name, or `part`, with a number if it is taken.
fn free_name(name: &str, regions: &[SceneRegion]) -> String {
    let name = if name.is_empty() || name == "world" { "part" } else { name };
    let numbered = (2..).map(|k| format!("{name}{k}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    let is_free = |name: &String| regions.iter().all(|region| region.name != *name);
    names.find(is_free).unwrap_or_default()
}
