//! Matching of regions into pairs.

use super::{DiffSettings, Match};
use crate::AnalysisError;
use crate::subject::clipped;
use rayweave_error::Message;
use rayweave_model::{Program, Region, RegionId, Solid};
use rayweave_scene::Scene;

/// The regions of the program of a pair that belong to one model only; 1 is common to both.
pub const A_ONLY: RegionId = RegionId(2);
pub const B_ONLY: RegionId = RegionId(3);

/// Matched solids of both models; `None` where a model has no counterpart.
#[derive(Clone, Debug)]
pub struct Pair {
    pub name: String,
    pub sides: [Option<Solid>; 2],
}

/// The pairs of two models, in the order of the first, and the matching used.
pub fn pairs(a: &Scene, b: &Scene, settings: &DiffSettings) -> Result<(Match, Vec<Pair>), AnalysisError> {
    let by = match settings.by {
        Match::Auto if a.regions.len() == 1 || b.regions.len() == 1 => Match::Whole,
        Match::Auto => Match::Region,
        by => by,
    };
    for (scene, which) in [(a, "first"), (b, "second")] {
        if scene.regions.is_empty() {
            let problem = format!("the {which} model has no regions");
            return Err(AnalysisError::Solid(Message::new(problem, "there is nothing to compare")));
        }
    }
    let first = parts(a, by, regions(a, 1.0, settings)?)?;
    let second = parts(b, by, regions(b, b.unit.metres() / a.unit.metres(), settings)?)?;
    Ok((by, matched(first, second)))
}

/// The regions of a scene, scaled to a different unit and clipped to the box.
fn regions(scene: &Scene, factor: f64, settings: &DiffSettings) -> Result<Vec<Region>, AnalysisError> {
    let scaled = |region: Region| match factor == 1.0 {
        true => region,
        false => Region { solid: region.solid.scale([factor; 3]), ..region },
    };
    clipped(scene.model_regions().into_iter().map(scaled).collect(), settings.measure.within)
}

/// Solids by name.
fn parts(scene: &Scene, by: Match, regions: Vec<Region>) -> Result<Vec<(String, Solid)>, AnalysisError> {
    if by == Match::Whole {
        let all = Solid::union(regions.into_iter().map(|region| region.solid));
        return Ok(vec![("model".to_owned(), all)]);
    }
    let media = scene.medium_names();
    let name = |region: &Region| match by {
        Match::Medium => media.get(region.medium as usize).map_or(String::new(), |name| (*name).to_owned()),
        _ => region.name.clone(),
    };
    let names: Vec<String> = regions.iter().map(name).collect();
    let mut found: Vec<(String, Vec<Solid>)> = Vec::new();
    let mut known = std::collections::HashMap::new();
    for (name, solid) in names.into_iter().zip(shares(&regions)?) {
        let at = *known.entry(name.clone()).or_insert(found.len());
        if at == found.len() {
            found.push((name, Vec::new()));
        }
        found[at].1.push(solid);
    }
    Ok(found.into_iter().map(|(name, solids)| (name, Solid::union(solids))).collect())
}

/// Each region minus the later ones; only those with overlapping boxes are subtracted.
pub fn shares(regions: &[Region]) -> Result<Vec<Solid>, AnalysisError> {
    let boxes = Program::compile_regions(regions)?.region_bounds();
    let share = |(k, region): (usize, &Region)| {
        let later = (k + 1..regions.len()).filter(|&j| !boxes[j].intersection(&boxes[k]).is_empty());
        let taken: Vec<Solid> = later.map(|j| regions[j].solid.clone()).collect();
        match taken.is_empty() {
            true => region.solid.clone(),
            false => &region.solid - &Solid::union(taken),
        }
    };
    Ok(regions.iter().enumerate().map(share).collect())
}

fn matched(first: Vec<(String, Solid)>, second: Vec<(String, Solid)>) -> Vec<Pair> {
    let mut others: Vec<(String, Option<Solid>)> =
        second.into_iter().map(|(name, solid)| (name, Some(solid))).collect();
    let places: std::collections::HashMap<String, usize> =
        others.iter().enumerate().map(|(k, (name, _))| (name.clone(), k)).collect();
    let mut pairs: Vec<Pair> = Vec::new();
    for (name, solid) in first {
        let other = places.get(&name).and_then(|&k| others[k].1.take());
        pairs.push(Pair { name, sides: [Some(solid), other] });
    }
    let rest = others.into_iter().filter_map(|(name, solid)| solid.map(|solid| (name, solid)));
    pairs.extend(rest.map(|(name, solid)| Pair { name, sides: [None, Some(solid)] }));
    pairs
}

impl Pair {
    /// Three regions: the intersection, the rest of the first solid, the rest of the second solid.
    pub fn regions(&self) -> Vec<Region> {
        let [a, b] = self.sides.clone().map(|side| side.unwrap_or_else(Solid::empty));
        let region =
            |(k, name, solid): (u32, &str, Solid)| Region { name: name.to_owned(), solid, medium: k };
        let both = (1, "both", &a & &b);
        [both, (2, "A only", &a - &b), (3, "B only", &b - &a)].map(region).into()
    }

    /// The pair as a compiled program.
    pub fn program(&self) -> Result<Program, AnalysisError> {
        Ok(Program::compile_regions(&self.regions())?)
    }

    /// True if both solids are equal expressions of equal shapes.
    pub fn is_written_alike(&self) -> bool {
        let [a, b] = &self.sides;
        a == b
    }
}
