//! `rayweave info`: the contents of a model.

use crate::arguments::ModelArguments;
use crate::command::tree;
use crate::failure::Failure;
use crate::terminal;
use clap::Args;
use rayweave::model::simplify::{FormulaSize, PassReport, Preparation, Removal};
use rayweave::model::{Leaf, LeafKind};
use rayweave::scene::Scene;
use rayweave::{Bounds, Compiled, Program};
use serde_json::{Value, json};
use std::collections::HashSet;

/// Print the contents of a model: regions, media, the tree of solids, bounds, statistics
#[derive(Args)]
pub struct Info {
    #[command(flatten)]
    model: ModelArguments,

    /// Print JSON, with a list of all leaves
    #[arg(long)]
    json: bool,

    /// Explain how the model is compiled: the effect of each pass on its tree, and the parts that are pruned, with reasons
    #[arg(long)]
    explain: bool,

    /// Maximum depth of the printed tree
    #[arg(long, value_name = "N", default_value_t = 12)]
    depth: usize,

    /// Maximum number of lines of the tree and of the list of pruned parts
    #[arg(long, value_name = "N", default_value_t = 200)]
    lines: usize,
}

impl Info {
    pub fn run(&self) -> Result<(), Failure> {
        let scene = self.model.import_scene()?;
        let compiled = Compiled::new(&scene)?;
        let preparations = match self.explain {
            true => Preparation::of_regions(&scene.model_regions()).map_err(rayweave::Error::from)?,
            false => Vec::new(),
        };
        terminal::print(&match self.json {
            true => {
                let mut json = self.as_json(&scene, &compiled);
                if self.explain {
                    json["preparation"] = preparations.iter().map(preparation_json).collect();
                }
                format!("{json:#}\n")
            }
            false => {
                let texts = preparations.iter().map(|p| format!("\n{}", p.text(self.lines)));
                self.as_text(&scene, &compiled) + &texts.collect::<String>()
            }
        })
    }

    fn as_text(&self, scene: &Scene, compiled: &Compiled) -> String {
        let name = self.model.name();
        let mut text = format!("{name}: {}, lengths in {}\n\n", counts(scene), scene.unit);
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
        facts.push(("bounds", bounds_text(&compiled.program.bounds())));
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
