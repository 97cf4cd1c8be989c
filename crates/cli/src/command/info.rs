//! `rayweave info`: the contents of a model.

use crate::arguments::{ModelArguments, OnlyArguments};
use crate::command::tree;
use crate::failure::Failure;
use crate::lens_data::{LensData, prescription_json, prescription_text};
use crate::lens_input;
use crate::terminal;
use clap::Args;
use rayweave::features::extent;
use rayweave::formats::{Format, MeshFile};
use rayweave::mesh::{Diagnosis, Mesh};
use rayweave::model::simplify::{FormulaSize, PassReport, Preparation, Removal};
use rayweave::model::{Leaf, LeafKind};
use rayweave::scene::{Diagnostics, Scene, Unit};
use rayweave::{AnyEvaluator, Bounds, Compiled, Program};
use serde_json::{Value, json};
use std::collections::HashSet;

/// Print the contents of a model: regions, media, the tree of solids, bounds, statistics; of a mesh file also its triangles
///
/// A mesh file (STL, OBJ, PLY, OFF, 3MF, glTF) need not be closed. The table of its meshes contains the numbers of triangles, shells and
/// open edges, the area, and the exact volume, if the mesh is closed and its surface does not intersect itself.
///
/// Of a sequential Zemax lens file (.zmx), the surfaces, fields and first-order data are printed.
#[derive(Args)]
pub struct Info {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    only: OnlyArguments,

    /// Print JSON, with a list of all leaves
    #[arg(long)]
    json: bool,

    /// Explain how the model is compiled: the effect of each pass on its tree, and the parts that are pruned, with reasons
    #[arg(long)]
    explain: bool,

    /// Maximum depth of the printed tree
    #[arg(long, value_name = "N", default_value_t = 12, value_parser = crate::arguments::any_count::<usize>)]
    depth: usize,

    /// Maximum number of lines of the tree and of the list of pruned parts
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = crate::arguments::any_count::<usize>)]
    lines: usize,
}

impl Info {
    pub fn run(&self) -> Result<(), Failure> {
        if self.model.is_lens() {
            return self.lens();
        }
        let meshes = self.meshes()?;
        let scene = match (self.model.import_scene(), &meshes) {
            // an open mesh is no model, but its triangles can be described
            (Err(failure), Some(meshes)) if meshes.is_any_open() => {
                terminal::warn(&meshes.warnings);
                terminal::print(&match self.json {
                    true => format!("{:#}\n", self.mesh_file_json(meshes)),
                    false => {
                        format!(
                            "{}: lengths in {}\n\n{}",
                            self.model.name(),
                            terminal::unit_name(meshes.unit.symbol()),
                            meshes.text()
                        )
                    }
                })?;
                return match self.explain {
                    true => Err(failure),
                    false => Ok(()),
                };
            }
            (scene, _) => scene?,
        };
        let scene = self.only.of(scene)?;
        let compiled = Compiled::new(&scene)?;
        let preparations = match self.explain {
            true => Preparation::of_regions(&scene.model_regions()).map_err(rayweave::Error::from)?,
            false => Vec::new(),
        };
        let printed = terminal::print(&match self.json {
            true => {
                let mut json = self.as_json(&scene, &compiled);
                if let Some(meshes) = &meshes {
                    json["meshes"] = meshes.json();
                }
                if self.explain {
                    json["preparation"] = preparations.iter().map(preparation_json).collect();
                }
                format!("{json:#}\n")
            }
            false => {
                let texts = preparations.iter().map(|p| format!("\n{}", p.text(self.lines)));
                let meshes = meshes.map(|meshes| format!("\n{}", meshes.text())).unwrap_or_default();
                self.as_text(&scene, &compiled) + &meshes + &texts.collect::<String>()
            }
        });
        // the system frees the memory of a large model faster than its destructors do
        std::mem::forget(scene);
        printed
    }

    /// Prints the prescription of a lens file.
    fn lens(&self) -> Result<(), Failure> {
        if self.explain {
            let problem = "--explain: a lens file is a list of surfaces, not a tree of solids.";
            return Err(Failure::Usage(format!("{problem} Leave the option out.")));
        }
        if self.only.is_one() {
            let problem = "--solid: a lens file is a list of surfaces, without named solids.";
            return Err(Failure::Usage(format!("{problem} Leave the option out.")));
        }
        let lens = self.model.lens()?;
        let (unit, fields) = (lens_input::unit(&lens), lens_input::field_texts(&lens));
        let data = LensData::new(&lens, &fields, unit);
        let data = data.map_err(|error| lens_input::wrong(&self.model.model, &error))?;
        // a lens without solids has a prescription, too
        let sizes = lens.assembly().map(|layout| layout.semi_diameters);
        let sizes = sizes.unwrap_or_else(|error| {
            terminal::caution(&format!("{}: {error}", self.model.name()));
            Vec::new()
        });
        let lines: Vec<f64> = lens.lines.iter().map(|line| line.wavelength_nm).collect();
        if self.json {
            let json = json!({
                "model": self.model.name(),
                "name": lens.name,
                "unit": unit,
                "surfaces": prescription_json(&lens, &sizes),
                "fields": lens.fields,
                "wavelengths_nm": lines,
                "first_order": data.json(),
            });
            return terminal::print(&format!("{json:#}\n"));
        }
        let name = if lens.name.is_empty() { String::new() } else { format!(" {},", lens.name) };
        let mut text = format!("{}:{name} lengths in {}\n\n", self.model.name(), terminal::unit_name(unit));
        text += &prescription_text(&lens, &sizes, unit);
        let lines: Vec<String> = lines.into_iter().map(terminal::short).collect();
        text += &format!("\nfields       {}\nwavelengths  {} nm\n\n", fields.join(", "), lines.join(", "));
        terminal::print(&(text + &data.text()))
    }

    /// The meshes of a mesh file; `None` for models of other formats and for standard input.
    fn meshes(&self) -> Result<Option<Meshes>, Failure> {
        let format = self.model.format.as_deref().and_then(Format::from_name);
        let path = &self.model.model;
        match format.or_else(|| Format::from_path(path)) {
            // a pipe can be read only once
            Some(Format::Mesh(kind)) if path.is_file() => {
                let file =
                    MeshFile::load(path, kind, &self.model.options()).map_err(rayweave::Error::from)?;
                Ok(Some(Meshes::new(file)))
            }
            _ => Ok(None),
        }
    }

    fn mesh_file_json(&self, meshes: &Meshes) -> Value {
        json!({ "model": self.model.name(), "unit": meshes.unit.symbol(), "meshes": meshes.json() })
    }

    fn as_text(&self, scene: &Scene, compiled: &Compiled) -> String {
        let name = self.model.name();
        let mut text =
            format!("{name}: {}, lengths in {}\n\n", counts(scene), terminal::unit_name(scene.unit.symbol()));
        if !scene.regions.is_empty() {
            text += &regions(scene, compiled);
            text += "\n";
        }
        text += &tree::draw(&roots(scene), self.depth, self.lines);
        text += "\n";
        let mut facts = Vec::new();
        if !scene.parameters.is_empty() {
            let all = scene.parameters.iter();
            let all = all.map(|(name, value)| format!("{name} = {}", terminal::short(*value)));
            facts.push(("parameters", all.collect::<Vec<_>>().join(", ")));
        }
        let media: Vec<String> = scene.media.iter().map(medium).collect();
        facts.push(("media", media.join(", ")));
        let bounds = compiled.program.bounds();
        match tighter(compiled) {
            Some(extent) => {
                facts.push(("extent", format!("{}, found by rays", bounds_text(&extent))));
                facts.push((
                    "bounds",
                    format!("{}, a larger box that contains the model", bounds_text(&bounds)),
                ));
            }
            None => facts.push(("bounds", bounds_text(&bounds))),
        }
        facts.extend(statistics(&compiled.program).map(|(name, n)| (name, n.to_string())));
        let width = facts.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
        for (name, fact) in facts {
            text += &format!("{name:<width$}  {fact}\n");
        }
        text
    }

    fn as_json(&self, scene: &Scene, compiled: &Compiled) -> Value {
        let program = &compiled.program;
        let region = |region: &rayweave::scene::SceneRegion| {
            json!({
                "name": region.name,
                "medium": compiled.media.get(region.medium as usize),
                "solid": region.solid.to_string(),
            })
        };
        let medium = |medium: &rayweave::scene::Medium| json!({ "name": medium.name, "index": medium.index });
        json!({
            "model": self.model.name(),
            "unit": scene.unit.symbol(),
            "parameters": scene.parameters.iter().map(|(name, value)| (name.clone(), json!(value))).collect::<serde_json::Map<_, _>>(),
            "solids": scene.solids.iter().map(|(name, solid)| (name.clone(), json!(solid.to_string()))).collect::<serde_json::Map<_, _>>(),
            "regions": scene.regions.iter().map(region).collect::<Vec<_>>(),
            "media": scene.media.iter().map(medium).collect::<Vec<_>>(),
            "bounds": bounds_json(&program.bounds()),
            "extent": bounds_json(&tighter(compiled).unwrap_or_else(|| program.bounds())),
            "statistics": statistics(program).map(|(name, n)| (name.to_owned(), json!(n))).into_iter().collect::<serde_json::Map<_, _>>(),
            "leaves": program.leaves().map(|leaf| leaf_json(program, leaf)).collect::<Vec<_>>(),
        })
    }
}

/// The roots of the tree: the distinct solids of the regions.
fn roots(scene: &Scene) -> Vec<rayweave::Solid> {
    let mut seen = HashSet::new();
    let solids = scene.regions.iter().map(|region| &region.solid);
    solids.filter(|solid| seen.insert(solid.address())).cloned().collect()
}

fn counts(scene: &Scene) -> String {
    let count = |n: usize, one: &str, many: &str| match n {
        1 => format!("1 {one}"),
        n => format!("{n} {many}"),
    };
    let regions = count(scene.regions.len(), "region", "regions");
    let solids = count(scene.solids.len(), "solid", "solids");
    // the list includes the medium of the world
    let media = count(scene.media.len() - 1, "medium", "media");
    format!("{regions}, {solids}, {media}")
}

fn regions(scene: &Scene, compiled: &Compiled) -> String {
    let row = |(k, region): (usize, &rayweave::scene::SceneRegion)| {
        let medium = compiled.media.get(region.medium as usize);
        vec![(k + 1).to_string(), region.name.clone(), medium.cloned().unwrap_or_default()]
    };
    let rows: Vec<Vec<String>> = scene.regions.iter().enumerate().map(row).collect();
    terminal::table(&["#", "region", "medium"], &rows, &[true, false, false])
}

fn medium(medium: &rayweave::scene::Medium) -> String {
    match medium.index {
        Some(index) => format!("{} (index {})", medium.name, terminal::short(index)),
        None => medium.name.clone(),
    }
}

/// Counts of the compiled program, by name.
fn statistics(program: &Program) -> [(&'static str, usize); 7] {
    let gates = program.prototypes().iter();
    let placements = program.prototypes().first().map_or(1, |p| p.placements);
    [
        ("leaves", program.leaves().len()),
        ("faces", program.facets().len()),
        ("surfaces", program.surfaces().len()),
        ("shared surfaces", shared_surfaces(program)),
        ("gates", gates.map(|group| group.network.gate_count()).sum()),
        ("prototypes", program.prototypes().len() - 1),
        ("placements", placements as usize - 1),
    ]
}

/// The number of surfaces that are shared by several faces.
fn shared_surfaces(program: &Program) -> usize {
    let mut faces = vec![0u32; program.surfaces().len()];
    for facet in program.facets() {
        faces[facet.surface().index()] += 1;
    }
    faces.iter().filter(|&&count| count > 1).count()
}

/// The largest number of leaves of a model whose extent is searched.
const MAX_LEAVES: usize = 100_000;

/// The extent of a model, if its bounding box is larger: boxes of intersections and differences are.
fn tighter(compiled: &Compiled) -> Option<Bounds> {
    let program = &compiled.program;
    let placements = program.prototypes().first().map_or(1, |group| group.placements);
    let is_small = program.leaves().len() < MAX_LEAVES && placements < MAX_LEAVES as u32;
    let evaluator = is_small.then(|| AnyEvaluator::new(None, program.clone()).ok()).flatten()?;
    extent(&evaluator).filter(|extent| !extent.is_exact).map(|extent| extent.bounds)
}

fn bounds_text(bounds: &Bounds) -> String {
    match bounds.is_empty() {
        true => "nothing".to_owned(),
        false => {
            let corner = |p: rayweave::Vec3| terminal::short_point(p.to_array());
            format!("{} to {}", corner(bounds.lo), corner(bounds.hi))
        }
    }
}

/// The corners; `null` stands for infinity, which JSON lacks.
fn bounds_json(bounds: &Bounds) -> Value {
    match bounds.is_empty() {
        true => Value::Null,
        false => json!([bounds.lo.to_array(), bounds.hi.to_array()]),
    }
}

fn preparation_json(preparation: &Preparation) -> Value {
    let size = |size: &FormulaSize| {
        json!({
            "leaves": size.leaves,
            "operators": size.operators,
            "complements": size.complements,
            "height": size.height,
        })
    };
    let pass = |report: &PassReport| {
        json!({
            "pass": report.pass.name(),
            "promise": report.pass.contract(),
            "before": size(&report.before),
            "after": size(&report.after),
        })
    };
    let removal = |removal: &Removal| {
        let by = if removal.inside { "universe" } else { "empty" };
        json!({ "part": removal.part, "why": removal.why, "replaced_by": by })
    };
    json!({
        "prototype": preparation.group.0,
        "whose": preparation.whose,
        "written": preparation.written,
        "kept": preparation.kept,
        "passes": preparation.passes.iter().map(pass).collect::<Vec<_>>(),
        "balanced": size(&preparation.balanced),
        "removed": preparation.removals.iter().map(removal).collect::<Vec<_>>(),
        "unasked_leaves": preparation.unused,
        "bounds_of_leaves": bounds_json(&preparation.loose),
        "bounds": bounds_json(&preparation.tight),
    })
}

fn leaf_json(program: &Program, leaf: Leaf<'_>) -> Value {
    let kind = match leaf.kind() {
        LeafKind::Shape { .. } => leaf.shape_name().unwrap_or_default().to_owned(),
        LeafKind::Instance { prototype, .. } => format!("instance of prototype {}", prototype.0),
    };
    let face = |(k, facet): (usize, &rayweave::model::LeafFacet)| json!({ "name": leaf.face_name(k), "surface": facet.surface().0 });
    let faces: Vec<Value> = leaf.facets().iter().enumerate().map(face).collect();
    json!({
        "name": leaf.name(),
        "kind": kind,
        "faces": faces,
        "bounds": bounds_json(&program.leaf_bounds(leaf.id())),
    })
}

/// The numbers of separate pieces and of closed cavities of a closed mesh: a shell within a shell is a cavity, one within a cavity a
/// piece.
fn nesting(diagnosis: &Diagnosis) -> Option<[usize; 2]> {
    let cavities = diagnosis.components.iter().filter(|shell| shell.depth % 2 == 1).count();
    diagnosis.is_closed().then(|| [diagnosis.components.len() - cavities, cavities])
}

/// The number of shells; of several, also what they are.
fn shells(diagnosis: &Diagnosis) -> String {
    let count = |number: usize, one: &str, many: &str| match number {
        1 => format!("1 {one}"),
        number => format!("{number} {many}"),
    };
    match (diagnosis.components.len(), nesting(diagnosis)) {
        (number @ 2.., Some([pieces, 0])) => format!("{number}: {}", count(pieces, "piece", "pieces")),
        (number @ 2.., Some([pieces, cavities])) => {
            format!(
                "{number}: {}, {}",
                count(pieces, "piece", "pieces"),
                count(cavities, "cavity", "cavities")
            )
        }
        (number, _) => number.to_string(),
    }
}

/// The meshes of a file, with their defects.
struct Meshes {
    unit: Unit,
    meshes: Vec<(String, Mesh, Diagnosis)>,
    warnings: Diagnostics,
}

impl Meshes {
    fn new(file: MeshFile) -> Meshes {
        let diagnosed = file.meshes.into_iter().map(|(name, mesh)| {
            let diagnosis = mesh.diagnose();
            (name, mesh, diagnosis)
        });
        Meshes { unit: file.unit, meshes: diagnosed.collect(), warnings: file.warnings }
    }

    fn is_any_open(&self) -> bool {
        self.meshes.iter().any(|(.., diagnosis)| !diagnosis.is_closed() || diagnosis.is_flat)
    }

    fn text(&self) -> String {
        let header = ["mesh", "triangles", "vertices", "shells", "closed", "area", "volume", "bounds"];
        let is_number = [false, true, true, true, false, true, true, false];
        let rows = self.meshes.iter().map(|(name, mesh, diagnosis)| {
            let closed = match diagnosis.open_edges {
                0 => "yes".to_owned(),
                1 => "no: 1 open edge".to_owned(),
                edges => format!("no: {edges} open edges"),
            };
            vec![
                name.clone(),
                diagnosis.triangles.to_string(),
                diagnosis.vertices.to_string(),
                shells(diagnosis),
                closed,
                terminal::short(mesh.area()),
                diagnosis.volume().map_or_else(|| "unknown".to_owned(), terminal::short),
                bounds_text(&mesh.bounds()),
            ]
        });
        let mut text = terminal::table(&header, &rows.collect::<Vec<_>>(), &is_number);
        // the reader of models reports defects of closed meshes
        let open = self.meshes.iter().filter(|(.., diagnosis)| !diagnosis.is_closed() || diagnosis.is_flat);
        for (name, _, diagnosis) in open {
            text += &format!("{name} is not a solid: {diagnosis}\n");
        }
        text
    }

    fn json(&self) -> Value {
        let mesh = |(name, mesh, diagnosis): &(String, Mesh, Diagnosis)| {
            json!({
                "name": name,
                "triangles": diagnosis.triangles,
                "vertices": diagnosis.vertices,
                "shells": diagnosis.components.len(),
                "pieces": nesting(diagnosis).map(|[pieces, _]| pieces),
                "cavities": nesting(diagnosis).map(|[_, cavities]| cavities),
                "is_closed": diagnosis.is_closed(),
                "is_sound": diagnosis.is_sound(),
                "open_edges": diagnosis.open_edges,
                "area": mesh.area(),
                "volume": diagnosis.volume(),
                "bounds": bounds_json(&mesh.bounds()),
            })
        };
        self.meshes.iter().map(mesh).collect()
    }
}
