//! Mesh files as models: each closed object becomes a region.
//!
//! [`rayweave_mesh_io`] documents the file formats. If every object of a file is closed, each becomes a region, and later
//! regions have priority over earlier ones where they overlap. Otherwise all triangles together form one region. An open
//! mesh is an error, a suspicious one a warning, both with position and count; [`Options::repair`] repairs meshes as far as
//! is safe and reports the changes.
//!
//! **Units** come from the file if it has one (3MF; glTF, which uses metres), else from [`Options::unit`], else
//! millimetres. glTF has its y axis up: points (x, y, z) become (x, -z, y), so that z is up.

use crate::{Format, Imported, LossKind, Options, Report};
use rayweave_math::Vec3;
use rayweave_mesh::{Diagnosis, Mesh, MeshError, PairBudget, Polyhedron, Repair};
use rayweave_mesh_io::{self as mesh_io, FileError, LoadedMesh, MeshFormat, ReadOptions};
use rayweave_model::{Solid, memory};
use rayweave_scene::{Colour, Diagnostic, Diagnostics, Medium, Scene, SceneRegion, Source, Unit, read_bytes};
use rayweave_shape::primitive::{self, Primitive};
use rayweave_table::AllowedFiles;
use std::collections::{HashMap, HashSet};
use std::io;
use std::path::Path;
use std::sync::Arc;

/// The meshes of a file, closed or not.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct MeshFile {
    /// The unit of length: that of the file, else of [`Options::unit`], else millimetres.
    pub unit: Unit,
    /// The named meshes: one for each object if all objects are closed, else one of all triangles. z is up.
    pub meshes: Vec<(String, Mesh)>,
    /// Unusual properties of the file, and repairs.
    pub warnings: Diagnostics,
}

impl MeshFile {
    /// Reads a mesh file without requiring that its meshes are closed. [`Options::repair`] repairs each as far as is safe.
    ///
    /// # Errors
    ///
    /// [`Diagnostics`]: the file cannot be read, has no triangles, or states a unit although [`Options::unit`] is given.
    pub fn load(
        path: impl AsRef<Path>,
        format: MeshFormat,
        options: &Options,
    ) -> Result<MeshFile, Diagnostics> {
        let path = path.as_ref();
        let source = Arc::new(Source::new(Some(path.to_owned()), String::new()));
        let limits = limits();
        let mut import = Import::new(&source, format, options);
        let (unit, mut meshes) = import.meshes(read(path, format, options, &limits), &limits)?;
        if meshes.iter().all(|(_, mesh)| mesh.triangles().is_empty()) {
            let empty = Diagnostic::error("the mesh is empty").why("the file has no triangles");
            return Err(Diagnostics::from(empty.in_file(&source)));
        }
        if options.repair {
            for (name, mesh) in &mut meshes {
                let (mended, done) =
                    mesh.auto_repaired().unwrap_or_else(|| (mesh.clone(), Repair::default()));
                *mesh = mended;
                import.report_repairs(&format!("the mesh of `{name}`"), &done);
            }
        }
        let warnings = import.report.warnings().iter().chain(&import.warnings).cloned().collect();
        Ok(MeshFile { unit, meshes, warnings: Diagnostics::new(warnings) })
    }
}

/// Reads a mesh file.
pub(crate) fn load(path: &Path, format: MeshFormat, options: &Options) -> Result<Imported, Diagnostics> {
    let source = Arc::new(Source::new(Some(path.to_owned()), String::new()));
    let limits = limits();
    Import::new(&source, format, options).scene(read(path, format, options, &limits), &limits)
}

fn read(
    path: &Path,
    format: MeshFormat,
    options: &Options,
    limits: &ReadOptions,
) -> Result<LoadedMesh, FileError> {
    if path.metadata().is_ok_and(|kind| !kind.is_file() && !kind.is_dir()) {
        // pipes and devices have neither a length nor a folder
        let bytes = read_bytes(path).map_err(|reason| FileError::Io(io::Error::other(reason)));
        bytes.and_then(|bytes| mesh_io::read_bytes(&bytes, format, limits))
    } else {
        let files = AllowedFiles::of_model(Some(path), &options.allow);
        mesh_io::read_allowed(path, Some(format), limits, &files)
    }
}

/// Reads a mesh from text.
pub(crate) fn parse(
    source: &Arc<Source>,
    format: MeshFormat,
    options: &Options,
) -> Result<Imported, Diagnostics> {
    let limits = limits();
    let loaded = mesh_io::read_bytes(source.text().as_bytes(), format, &limits);
    Import::new(source, format, options).scene(loaded, &limits)
}

/// Read limits: as many triangles as fit into memory.
fn limits() -> ReadOptions {
    memory::available().map_or_else(ReadOptions::default, ReadOptions::for_memory)
}

/// State while a file is imported.
struct Import<'a> {
    source: &'a Arc<Source>,
    format: MeshFormat,
    options: &'a Options,
    report: Report,
    /// Shared by all objects of the file.
    pairs: PairBudget,
    warnings: Vec<Diagnostic>,
    problems: Vec<Diagnostic>,
}

impl<'a> Import<'a> {
    fn new(source: &'a Arc<Source>, format: MeshFormat, options: &'a Options) -> Import<'a> {
        let (report, pairs) = (Report::default(), PairBudget::default());
        Import { source, format, options, report, pairs, warnings: Vec::new(), problems: Vec::new() }
    }

    fn scene(
        mut self,
        loaded: Result<LoadedMesh, FileError>,
        limits: &ReadOptions,
    ) -> Result<Imported, Diagnostics> {
        let (unit, objects) = self.meshes(loaded, limits)?;
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

    /// The unit and the named meshes of a file.
    fn meshes(
        &mut self,
        loaded: Result<LoadedMesh, FileError>,
        limits: &ReadOptions,
    ) -> Result<(Unit, Vec<(String, Mesh)>), Diagnostics> {
        let loaded = loaded.map_err(|error| Diagnostics::from(self.unreadable(&error, limits)))?;
        let unit = self.unit(&loaded)?;
        for warning in &loaded.warnings {
            self.warnings.push(Diagnostic::warning(warning.clone()).in_file(self.source));
        }
        Ok((unit, self.objects(loaded)))
    }

    fn unreadable(&self, error: &FileError, limits: &ReadOptions) -> Diagnostic {
        let mut why = match error {
            FileError::Io(error) => rayweave_scene::reason(error),
            error => error.to_string(),
        };
        let is_short = limits.max_elements < ReadOptions::default().max_elements;
        if let (FileError::Mesh { error: MeshError::TooMany { .. }, .. }, true) = (error, is_short) {
            why += &format!(
                " A triangle takes up to {} bytes while it is read, and there is not enough memory for more.",
                ReadOptions::BYTES_PER_TRIANGLE
            );
        }
        let hint = self.source.path().and_then(|path| rayweave_scene::nearby_files(path));
        Diagnostic::error("the mesh cannot be read").why(why).suggest(hint).in_file(self.source)
    }

    /// The unit of the file, or the requested one.
    fn unit(&self, loaded: &LoadedMesh) -> Result<Unit, Diagnostics> {
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

    /// The named meshes: one per object, or a single one.
    fn objects(&mut self, mut loaded: LoadedMesh) -> Vec<(String, Mesh)> {
        if matches!(self.format, MeshFormat::Gltf | MeshFormat::Glb) {
            // no coordinate grows, so the mapped mesh is always accepted
            loaded.mesh = loaded.mesh.mapped(|p| Vec3::new(p.x, -p.z, p.y)).unwrap_or(loaded.mesh);
        }
        if loaded.objects.len() > 1 {
            let parts: Vec<(String, Mesh)> = loaded
                .objects
                .iter()
                .map(|object| (object.name.clone(), loaded.object_mesh(object)))
                .collect();
            let open = parts.iter().filter(|(_, mesh)| !mesh.is_closed()).count();
            if open == 0 || (self.options.repair && !loaded.mesh.is_closed()) {
                return parts;
            }
            let (all, why) = (parts.len(), "all triangles together are taken as one solid");
            let warning = Diagnostic::warning(format!("{open} of {all} objects are not closed on their own"));
            self.warnings.push(warning.why(why).in_file(self.source));
        }
        let name = self.source.path().and_then(|path| path.file_stem()).map(|stem| stem.to_string_lossy());
        vec![(name.unwrap_or_default().into_owned(), loaded.mesh)]
    }

    /// The solid inside a mesh; problems of the mesh are reported.
    fn solid(&mut self, name: Option<&str>, mut mesh: Mesh) -> Option<Polyhedron> {
        let what = name.map_or("the mesh".to_owned(), |name| format!("the mesh of `{name}`"));
        if self.options.repair {
            let (mended, done) = mesh.auto_repaired().unwrap_or((mesh, Repair::default()));
            mesh = mended;
            self.report_repairs(&what, &done);
        }
        let diagnosis = mesh.diagnose_within(&mut self.pairs);
        match Polyhedron::closed(&mesh, &diagnosis) {
            Ok(solid) => {
                self.warn(&what, &diagnosis);
                Some(solid)
            }
            Err(error) => {
                let problem = Diagnostic::error(format!("{what} is not a solid"));
                let (reason, advice) = error.parts();
                let advice = match !self.options.repair && error != MeshError::Flat {
                    true => "try `--repair` (`repair=True` in Python)".to_owned(),
                    false => advice,
                };
                let problem = problem.why(format!("{reason} ({diagnosis})")).suggest(Some(advice));
                self.problems.push(problem.in_file(self.source));
                None
            }
        }
    }

    fn warn(&mut self, what: &str, diagnosis: &Diagnosis) {
        if !diagnosis.is_sound() {
            let warning = Diagnostic::warning(format!("{what} may not be as intended: {diagnosis}"));
            let why =
                "a point is inside if a line to it from infinity crosses the mesh an odd number of times";
            self.warnings.push(warning.why(why).in_file(self.source));
        }
    }

    fn report_repairs(&mut self, what: &str, done: &Repair) {
        for (repair, kind) in done.summary() {
            let warning = Diagnostic::warning(format!("{what} was repaired: {repair}"));
            self.report.add(LossKind::Approximated, kind, warning.in_file(self.source));
        }
    }
}

/// A scene with one region per solid.
fn scene(solids: Vec<(String, Polyhedron)>, unit: Unit) -> Scene {
    let mut media = vec![Medium { name: "world".to_owned(), ..Medium::default() }];
    let mut regions: Vec<SceneRegion> = Vec::new();
    let mut names = Names::default();
    for (number, (name, polyhedron)) in solids.into_iter().enumerate() {
        let name = names.free(&name);
        media.push(Medium { name: name.clone(), ..Medium::default() });
        let solid = Solid::from(Primitive::from(primitive::Mesh::from(polyhedron))).named(&name);
        let colour = Colour::numbered(number);
        regions.push(SceneRegion { name, solid, medium: number as u32 + 1, colour });
    }
    Scene::from_regions(unit, regions, media)
}

/// The names of regions in use.
#[derive(Default)]
struct Names {
    taken: HashSet<String>,
    /// The next number to try for each name that occurred repeatedly: thousands of objects may have the same name.
    next: HashMap<String, u64>,
}

impl Names {
    /// The name, or `part` if it is empty, with a number if it is taken.
    fn free(&mut self, name: &str) -> String {
        let name = if name.is_empty() || name == "world" { "part" } else { name };
        let mut free = name.to_owned();
        while !self.taken.insert(free.clone()) {
            let next = self.next.entry(name.to_owned()).or_insert(2);
            free = format!("{name}{next}");
            *next += 1;
        }
        free
    }
}
