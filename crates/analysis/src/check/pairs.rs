//! Checks for overlaps of regions, and for daughters outside their mothers.

use super::parts::{Part, overlapping_pairs, parts};
use super::probe::{FEW, Probe, VOLUME_RAYS, leaves_of, rays_of};
use super::share::{Outcome, Thickest};
use super::subject::Subject;
use super::{Finding, FindingKind};
use crate::AnalysisError;
use crate::distance::contained;
use rayweave_math::Bounds;
use rayweave_model::{Evaluator, Program, Solid};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

/// The intersection of two regions.
struct Common {
    deepest: Thickest,
    /// Pairs of parts.
    count: usize,
    /// The intersections of pairs of parts.
    parts: Vec<CommonPart>,
}

/// The intersection of two parts, with its box and the number of its search.
struct CommonPart {
    solid: Solid,
    bounds: Bounds,
    search: u64,
}

impl Common {
    /// Searches the deepest place with all rays; before, a few rays have shown that there is one.
    fn deepen<E: Evaluator>(&mut self, probe: &mut Probe<'_, E>) -> Result<(), AnalysisError> {
        let mut deepest: Option<Thickest> = None;
        for CommonPart { solid, bounds, search } in &self.parts {
            let met = probe.with_numbers_of(*search, |probe| probe.is_there(solid, bounds, FEW))?;
            let is_deeper = |met: &Thickest| deepest.is_none_or(|best| met.thickness > best.thickness);
            deepest = met.filter(is_deeper).or(deepest);
        }
        self.deepest = deepest.unwrap_or(self.deepest);
        Ok(())
    }
}

/// The maximum number of pairs of parts of two regions whose volumes are added; further pairs are only counted.
const MAX_SOLIDS: usize = 1024;

/// Intersecting pairs of regions.
pub struct Intersecting {
    /// Overlaps of two regions neither of which is inside the other, and of copies of one.
    pub overlaps: Vec<Finding>,
    /// Pairs of different regions, the smaller number first: those that overlap, and those one of which is inside the other.
    pub pairs: HashSet<(usize, usize)>,
}

/// The pairs of regions that intersect.
pub fn intersecting<E: Evaluator>(
    subject: &Subject<'_>,
    probe: &mut Probe<'_, E>,
) -> Result<Intersecting, AnalysisError> {
    let parts = parts(subject.regions, &subject.boxes)?;
    let mut found = Intersecting { overlaps: Vec::new(), pairs: HashSet::new() };
    for ((a, b), mut common) in common(subject, &parts, probe)? {
        let leaves = [a, b].map(|region| leaves_of(&subject.regions[region].solid));
        let leaves = leaves[0].saturating_add(leaves[1]);
        if a != b && !probe.in_findings.affords(2 * rays_of(2 * FEW), leaves) {
            probe.scope.left_out += 1;
            continue;
        }
        if a == b || !is_nested(subject, a, b, probe)? {
            common.deepen(probe)?;
            found.overlaps.push(overlap(subject, a, b, &common, probe)?);
        }
        if a != b {
            found.pairs.insert((a, b));
        }
    }
    Ok(found)
}

/// Runs the independent searches of [`intersecting`] only.
pub fn search<E: Evaluator>(subject: &Subject<'_>, probe: &mut Probe<'_, E>) -> Result<(), AnalysisError> {
    let parts = parts(subject.regions, &subject.boxes)?;
    common(subject, &parts, probe).map(|_| ())
}

/// Pairs of intersecting regions, part by part. Copies of the same volume are included if there is a hierarchy: in
/// other models, solids of one union may overlap intentionally.
fn common<E: Evaluator>(
    subject: &Subject<'_>,
    parts: &[Part],
    probe: &mut Probe<'_, E>,
) -> Result<BTreeMap<(usize, usize), Common>, AnalysisError> {
    let wanted = |a: &Part, b: &Part| match a.region == b.region {
        true => subject.hierarchy.is_some() && a.copy.is_some() && a.copy != b.copy,
        false => !subject.are_kin(a.region, b.region),
    };
    let mut met = overlapping_pairs(parts, probe.scope.distance, wanted, probe.settings.most_pairs);
    let mut sizes: HashMap<usize, u64> = HashMap::new();
    met.pairs.retain(|&(k, j, _)| {
        let leaves = [k, j].map(|part| *sizes.entry(part).or_insert_with(|| leaves_of(&parts[part].solid)));
        probe.in_pairs.affords(rays_of(FEW), leaves[0].saturating_add(leaves[1]))
    });
    count(subject, parts, &met, probe);
    probe.plan(met.pairs.len() as u64 * rays_of(FEW));
    let mut found: BTreeMap<(usize, usize), Common> = BTreeMap::new();
    for (k, j, bounds) in met.pairs {
        let (first, second) = (&parts[k], &parts[j]);
        let both = &first.solid & &second.solid;
        probe.begin(rays_of(FEW));
        let search = probe.next_search;
        let met = probe.independent(|probe| Ok(probe.is_anywhere(&both, &bounds, FEW)?.into()))?;
        let Outcome::Found(deepest) = met else { continue };
        let pair = (first.region.min(second.region), first.region.max(second.region));
        let common = found.entry(pair).or_insert(Common { deepest, count: 0, parts: Vec::new() });
        common.count += 1;
        if deepest.thickness > common.deepest.thickness {
            common.deepest = deepest;
        }
        if common.parts.len() < MAX_SOLIDS {
            common.parts.push(CommonPart { solid: both, bounds, search });
        }
    }
    Ok(found)
}

/// Records the number of pairs of each kind.
fn count<E: Evaluator>(
    subject: &Subject<'_>,
    parts: &[Part],
    met: &super::parts::OverlappingPairs,
    probe: &mut Probe<'_, E>,
) {
    let mut sizes = vec![0u64; subject.regions.len()];
    parts.iter().for_each(|part| sizes[part.region] += 1);
    let (all, own) = (parts.len() as u64, sizes.iter().map(|n| n * n).sum::<u64>());
    probe.scope.parts = all;
    probe.scope.apart = ((all * all - own) / 2).saturating_sub(met.count as u64);
    probe.scope.pairs = met.pairs.len() as u64;
    probe.scope.left_out = (met.count - met.pairs.len()) as u64;
}

/// True if, as far as rays show, the later region lies inside the earlier one, or the earlier one inside the later
/// one, which is reported as hidden.
fn is_nested<E: Evaluator>(
    subject: &Subject<'_>,
    a: usize,
    b: usize,
    probe: &mut Probe<'_, E>,
) -> Result<bool, AnalysisError> {
    for (inner, outer) in [(b, a), (a, b)] {
        let rest = &subject.regions[inner].solid - &subject.regions[outer].solid;
        if probe.is_there(&rest, &subject.boxes[inner], 2 * FEW)?.is_none() {
            return Ok(true);
        }
    }
    Ok(false)
}

fn overlap<E: Evaluator>(
    subject: &Subject<'_>,
    a: usize,
    b: usize,
    common: &Common,
    probe: &mut Probe<'_, E>,
) -> Result<Finding, AnalysisError> {
    let (first, second) = (subject.name(a), subject.name(b));
    let text = match (a == b, common.count) {
        (true, 1) => format!("two copies of {first} overlap"),
        (true, n) => format!("{n} pairs of copies of {first} overlap"),
        (false, 1) => {
            format!("{first} and {second} overlap; {second}, the later one, has priority")
        }
        (false, n) => {
            format!("{first} and {second} overlap in {n} places; {second}, the later one, has priority")
        }
    };
    let solids = || common.parts.iter().map(|part| &part.solid);
    let leaves = solids().map(leaves_of).fold(0, u64::saturating_add);
    let is_complete = common.parts.len() == common.count;
    let volume = match is_complete && probe.in_findings.affords(VOLUME_RAYS, leaves) {
        true => probe.volume(&Solid::union(solids().cloned()))?,
        false => None,
    };
    let names = if a == b { vec![first] } else { vec![first, second] };
    let finding = Finding::new(FindingKind::Overlap, &names, text);
    Ok(Finding { volume, ..finding }.seen(common.deepest.thickness, common.deepest.chord))
}

/// Daughters that extend beyond all their mothers.
pub fn outside<E: Evaluator>(
    subject: &Subject<'_>,
    probe: &mut Probe<'_, E>,
) -> Result<Vec<Finding>, AnalysisError> {
    let boxes = part_boxes(subject)?;
    let mut findings = Vec::new();
    for (daughter, boxes) in boxes.iter().enumerate() {
        if let Some((finding, rest)) = beyond_mothers(subject, daughter, boxes, probe)? {
            let volume = match probe.in_findings.affords(VOLUME_RAYS, leaves_of(&rest)) {
                true => probe.volume(&rest)?,
                false => None,
            };
            findings.push(Finding { volume, ..finding });
        }
    }
    Ok(findings)
}

/// Like [`outside`], without volumes, and only for parts whose boxes extend beyond those of the mothers' parts.
pub fn protruding<E: Evaluator>(
    subject: &Subject<'_>,
    probe: &mut Probe<'_, E>,
) -> Result<Vec<Finding>, AnalysisError> {
    let Some(hierarchy) = subject.hierarchy else { return Ok(Vec::new()) };
    let boxes = part_boxes(subject)?;
    let distance = probe.scope.distance;
    let mut findings = Vec::new();
    for (daughter, own) in boxes.iter().enumerate() {
        let mothers = hierarchy.mothers(daughter);
        let around: Vec<Bounds> = match own.len() * mothers.iter().map(|&m| boxes[m].len()).sum::<usize>() {
            0..=MOST_COMPARISONS => mothers.iter().flat_map(|&m| boxes[m].iter().copied()).collect(),
            _ => mothers.iter().map(|&m| subject.boxes[m]).collect(),
        };
        let around: Vec<Bounds> = around.iter().map(|mother| mother.grown(distance)).collect();
        let is_beyond = |own: &&Bounds| !around.iter().any(|mother| mother.union(own) == *mother);
        let beyond: Vec<Bounds> = own.iter().filter(is_beyond).copied().collect();
        if !beyond.is_empty() {
            findings.extend(beyond_mothers(subject, daughter, &beyond, probe)?.map(|(finding, _)| finding));
        }
    }
    Ok(findings)
}

/// The largest number of comparisons of boxes of a daughter's parts with boxes of its mothers' parts; above it, the boxes of the
/// mothers as a whole are compared.
const MOST_COMPARISONS: usize = 1 << 22;

/// Solids with fewer leaves need no estimate of those that a ray reaches.
const FEW_LEAVES: usize = 16;

/// The boxes of the parts of each region.
fn part_boxes(subject: &Subject<'_>) -> Result<Vec<Vec<Bounds>>, AnalysisError> {
    let mut boxes = vec![Vec::new(); subject.regions.len()];
    if subject.hierarchy.is_some() {
        for part in parts(subject.regions, &subject.boxes)? {
            boxes[part.region].push(part.bounds);
        }
    }
    Ok(boxes)
}

/// The finding about a daughter whose parts in some boxes extend beyond its mothers, without a volume, and the solid outside.
fn beyond_mothers<E: Evaluator>(
    subject: &Subject<'_>,
    daughter: usize,
    boxes: &[Bounds],
    probe: &mut Probe<'_, E>,
) -> Result<Option<(Finding, Solid)>, AnalysisError> {
    let mothers = subject.hierarchy.map_or(&[][..], |hierarchy| hierarchy.mothers(daughter));
    if mothers.is_empty() {
        return Ok(None);
    }
    let around = Solid::union(mothers.iter().map(|&mother| subject.regions[mother].solid.clone()));
    // what extends beyond the mothers by no more than the distance is not reported
    let known = contained(&Program::compile(&around)?, boxes, 0.5 * probe.scope.distance);
    let boxes: Vec<Bounds> =
        boxes.iter().zip(known.inside).filter(|(_, is_inside)| !is_inside).map(|(own, _)| *own).collect();
    if boxes.is_empty() {
        return Ok(None);
    }
    let rest = &subject.regions[daughter].solid - &around;
    let Some(met) = farthest(&rest, &boxes, probe)? else { return Ok(None) };
    let names: Vec<&str> = mothers.iter().map(|&mother| subject.name(mother)).collect();
    let name = subject.name(daughter);
    let text = format!("{name} extends beyond its mother, {}", names.join(" or "));
    let finding = Finding::new(FindingKind::Outside, &[&[name][..], &names].concat(), text);
    Ok(Some((finding.seen(met.thickness, met.chord), rest)))
}

/// The thickest place outside the mothers, among the remainders of the parts in their boxes.
fn farthest<E: Evaluator>(
    rest: &Solid,
    boxes: &[Bounds],
    probe: &mut Probe<'_, E>,
) -> Result<Option<Thickest>, AnalysisError> {
    let across = if boxes.len() == 1 { 2 * FEW } else { FEW };
    let most = probe.settings.most_pairs.min(boxes.len());
    probe.scope.left_out += (boxes.len() - most) as u64;
    let program = Arc::new(Program::compile(rest)?);
    if program.bounds().is_empty() {
        return Ok(None);
    }
    let load = program.ray_load();
    let evaluator = (probe.make)(program)?;
    let mut best: Option<Thickest> = None;
    for bounds in &boxes[..most] {
        // where many parts overlap, each ray in the box of one passes all of them
        let leaves = if load.len() < FEW_LEAVES { load.len() as f64 } else { load.through(bounds) };
        if !probe.in_outside.affords(rays_of(across), leaves.ceil() as u64) {
            probe.scope.left_out += 1;
            continue;
        }
        let met = probe.thickest_of_evaluator(&evaluator, bounds, across)?;
        let met = met.filter(|met| met.thickness > probe.scope.distance);
        if met.is_some_and(|met| best.is_none_or(|best| met.thickness > best.thickness)) {
            best = met;
        }
    }
    Ok(best)
}
