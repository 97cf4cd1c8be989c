//! Rounds of rays until all regions reach the precision.

use super::MeasureError;
use super::cells::{Cells, Sums};
use super::estimate::{Estimate, Measured, Measurement, quantile, report, volume_weights};
use super::plan::{self, Limits, Plan, Traced};
use super::tally::Tally;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::{Evaluator, Program, RayBatch, RayLoad, Region, RegionId};
use std::collections::BTreeMap;
use std::num::NonZeroUsize;
use std::ops::Range;

/// The largest coordinate: its fifth power, which occurs in an inertia tensor, is finite.
const MAX_REACH: f64 = 1e30;

/// Cells per task.
const CELLS_PER_TASK: u64 = 1024;

/// Cells along an edge of the cross-section in the first round: the usual number, and that of models of which each ray reaches very many
/// shapes.
pub(super) const FIRST_ACROSS: u64 = 48;
const LEAST_FIRST_ACROSS: u64 = 6;

/// The first round takes at most this part of the shapes that all rays may reach.
const FIRST_PART: u64 = 4;

/// The most boxes of regions times leaves that are compared to find how many shapes the rays through each box reach.
const MOST_COMPARED: usize = 1 << 24;

/// The number of regions above which rays are shared: see [`measure`].
pub(super) const MAX_ALONE: usize = 32;

/// The options of a measurement.
#[derive(Clone, Debug)]
pub struct MeasureSettings {
    /// The requested half width of each region's volume, relative to the volume: greater than 0, at most 1.
    pub precision: f64,
    /// The level of confidence of all intervals: from 0.5, below 1.
    pub confidence: f64,
    /// The maximum number of rays, excluding the first round, which serves all regions: per region, and of all rays together in a
    /// model of more than 32 regions.
    pub most_rays: u64,
    /// The maximum number of shapes that all rays together reach, by the boxes of the shapes, with those of the first round: where many
    /// shapes overlap, it limits the number of rays further. A ray reaches at least one. Each region of a model of up to 32 regions may
    /// use an equal part of what the regions before it have left. `None` for no such limit.
    pub most_reached: Option<u64>,
    /// Restricts the measurement to this box; the faces of the box do not count as boundary.
    pub within: Option<Bounds>,
    /// The seed of the random numbers: equal seeds give equal results.
    pub seed: u64,
    /// The number of threads; by default that of [`thread_count`]. Results do not depend on it.
    pub threads: Option<NonZeroUsize>,
    /// Cancels the run.
    pub cancel: Cancel,
}

/// A precision of 1e-3 at 99 %, with at most 2^24 rays per region, and 2^23 shapes that all rays reach.
impl Default for MeasureSettings {
    fn default() -> Self {
        MeasureSettings {
            precision: 1e-3,
            confidence: 0.99,
            most_rays: 1 << 24,
            most_reached: Some(1 << 23),
            within: None,
            seed: 0,
            threads: None,
            cancel: Cancel::new(),
        }
    }
}

impl MeasureSettings {
    /// The settings with another maximum number of rays, which holds regardless of the shapes that they reach; without one, the
    /// settings as they are.
    pub fn with_most_rays(self, most_rays: Option<u64>) -> MeasureSettings {
        match most_rays {
            Some(most_rays) => MeasureSettings { most_rays, most_reached: None, ..self },
            None => self,
        }
    }
}

/// Measures all regions of a model.
///
/// A first round of rays samples the whole model. Each region then gets rounds through its own box, each of a size that follows from
/// the round before it, until one that is expected to reach the precision does ([`Measured::is_reached`]), or until `most_rays` is
/// reached. The results are those of the last round alone: rays that decide on the number of further rays would make the results biased
/// and the intervals too short. Regions for which the first round is large enough share a second one of the same size.
///
/// In a model of more than 32 regions the rounds serve many regions at once. As long as the boxes of the regions below the
/// precision overlap so much that a random ray through the box around them crosses one on average, a round samples that
/// box for all of them; otherwise each of them gets a round of equal size through its own box. So the time does not grow
/// with the number of regions, and `most_rays` limits the number of all rays.
///
/// Rays along an axis are fewer where each reaches many more shapes than along another axis, such as along a row of fins: in inverse
/// proportion to the square root of the numbers of shapes, as in stratified sampling with different costs (Cochran, chapter 5).
///
/// A region that no ray crosses gets one additional round. It may still be non-empty: its interval covers the
/// volume that this number of rays can miss.
///
/// Touching regions with the same medium have no boundary between them and count as one of the two;
/// [`one_medium_each`] separates them.
///
/// `progress` receives the number of rays so far, on the calling thread.
///
/// # Errors
///
/// [`MeasureError`] for an unbounded region, settings out of range, a cancelled run.
pub fn measure<E: Evaluator>(
    evaluator: &E,
    settings: &MeasureSettings,
    progress: &mut dyn FnMut(u64),
) -> Result<Measurement, MeasureError> {
    measure_with_progress(evaluator, settings, &mut |now| progress(now.rays))
}

/// The progress of a measurement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureProgress {
    /// The number of rays so far.
    pub rays: u64,
    /// The largest half-width of the volume of a region, relative to the volume; infinite before the first round.
    pub precision: f64,
}

impl MeasureProgress {
    /// The part of the rays that have been traced when the precision is reached, for a goal: half-widths decrease as the power -3/4 of
    /// their number.
    pub fn part_done(&self, goal: f64) -> f64 {
        libm::pow(goal / self.precision, 4.0 / 3.0).min(1.0)
    }
}

/// Like [`measure`]; `progress` receives the precision reached as well.
///
/// # Errors
///
/// The errors of [`measure`].
pub fn measure_with_progress<E: Evaluator>(
    evaluator: &E,
    settings: &MeasureSettings,
    progress: &mut dyn FnMut(MeasureProgress),
) -> Result<Measurement, MeasureError> {
    let quantile = checked(settings)?;
    let program = evaluator.program();
    let count = program.regions().len();
    let reached = vec![f64::INFINITY; count];
    let (boxes, whole) = boxes_of(program, settings)?;
    let load = program.ray_load();
    let in_whole = load.along_axes(&whole);
    let axes = Axes::of(&in_whole);
    let left = settings.most_reached.unwrap_or(u64::MAX);
    let first = axes.across_of(axes.affordable(&in_whole, left / FIRST_PART));
    let first = first.clamp(LEAST_FIRST_ACROSS, FIRST_ACROSS);
    let (traced, streams) = (0, 0);
    let mut run =
        Run { evaluator, settings, axes, load, left, first, progress, quantile, traced, streams, reached };
    let mut results = vec![Latest::default(); count];
    if !whole.is_empty() {
        check_bounds(program, &whole)?;
        run.round(&whole, &in_whole, first, |_| true, &mut results)?;
    }
    let most_rays = run.affordable(&in_whole).min(settings.most_rays);
    let together = match count > MAX_ALONE {
        true => Some(run.refine_together(&boxes, whole, &mut results)?),
        false => None,
    };
    let spent = if together.is_none() { run.repeat_first(&whole, &in_whole, &mut results)? } else { 0 };
    let mut regions = Vec::with_capacity(count);
    for (region, info) in program.regions().iter().enumerate() {
        let own = match &together {
            Some(rays) => rays[region],
            None => {
                let spent = if results[region].is_final { spent } else { 0 };
                run.refine(region, &boxes[region], (count - region) as u64, spent, &mut results)?
            }
        };
        let latest = &results[region];
        let found = Measured {
            name: info.name.clone(),
            rays: latest.rays,
            is_reached: run.is_reached(latest),
            ..report(&latest.tally, latest.origin, quantile)
        };
        regions.push(match found.longest {
            None => uncrossed(found, &boxes[region], own, settings.confidence),
            Some(_) => found,
        });
    }
    Ok(Measurement { regions, rays: run.traced, most_rays })
}

/// The number of shapes that a ray may reach before its axis gets fewer rays: below it, other costs of a ray matter too.
const MANY_REACHED: f64 = 64.0;

/// The shares of the axes in the rays of a round.
#[derive(Clone, Copy, Debug)]
struct Axes {
    /// The number of cells along an edge of the cross-section, relative to the axis with the most.
    across: [f64; 3],
}

impl Axes {
    /// For rays along the axes that reach these numbers of shapes.
    fn of(load: &[f64; 3]) -> Axes {
        let costs = load.map(|load| load.max(MANY_REACHED));
        let least = costs.into_iter().fold(f64::INFINITY, f64::min);
        // the number of rays is the square
        Axes { across: costs.map(|cost| (least / cost).sqrt().sqrt()) }
    }

    /// The number of cells along an edge of the cross-section along an axis, of a round with at most `across`.
    fn across(&self, axis: usize, across: u64) -> u64 {
        ((self.across[axis] * across as f64) as u64).max(1)
    }

    /// The smallest number of cells along an edge in a round with at most `across`.
    fn least(&self, across: u64) -> u64 {
        (0..3).map(|axis| self.across(axis, across)).min().unwrap_or(across)
    }

    /// The number of rays of a round, two for each cell.
    fn rays(&self, across: u64) -> u64 {
        (0..3).map(|axis| 2 * self.across(axis, across).pow(2)).sum()
    }

    /// The largest number of cells along an edge for which a round has at most so many rays; 0 if there is none.
    fn across_of(&self, rays: u64) -> u64 {
        let squares: f64 = self.across.iter().map(|across| across * across).sum();
        let across = ((rays as f64 / (2.0 * squares)) as u64).isqrt();
        if self.rays(across) <= rays { across } else { across.saturating_sub(1) }
    }

    /// The number of rays that reach so many shapes, if rays along the axes reach these numbers each, and at least one.
    fn affordable(&self, load: &[f64; 3], shapes: u64) -> u64 {
        match shapes {
            u64::MAX => u64::MAX,
            _ => (shapes as f64 / self.mean(&load.map(|load| load.max(1.0)))) as u64,
        }
    }

    /// The number of shapes that the rays of a round reach, if rays along the axes reach these numbers each, and at least one.
    fn reached(&self, load: &[f64; 3], across: u64) -> u64 {
        let along = |axis: usize| 2.0 * (self.across(axis, across).pow(2) as f64) * load[axis].max(1.0);
        (0..3).map(along).sum::<f64>() as u64
    }

    /// The mean of values for the axes over all rays.
    fn mean(&self, values: &[f64; 3]) -> f64 {
        let squares = self.across.map(|across| across * across);
        let sum: f64 = squares.iter().zip(values).map(|(square, value)| square * value).sum();
        sum / squares.iter().sum::<f64>()
    }
}

/// The bounds for a region that no ray through its box crosses.
///
/// If the projection of the region along an axis is a fraction f of the cross-section, n rays along that axis
/// all miss it with a probability of at most (1 - f)^n, also for stratified rays: so f is below -ln(1 -
/// confidence) / n. The volume is at most that fraction of the box; the area, if no ray crosses the boundary
/// more than twice, at most that fraction of the area of the box.
pub(super) fn uncrossed(found: Measured, bounds: &Bounds, rays: u64, confidence: f64) -> Measured {
    if bounds.is_empty() {
        return found;
    }
    // without rays the fraction is 1
    let part = (-libm::log1p(-confidence) / (rays as f64 / 3.0)).min(1.0);
    let size = bounds.size();
    let within = |all: f64| Estimate { value: 0.0, half_width: part * all };
    let area = 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
    let volume = within(size.x * size.y * size.z);
    Measured { is_reached: volume.half_width == 0.0, volume, area: within(area), ..found }
}

/// Gives each region its own medium, number k for the k-th, from 1, so that a compiled model keeps the
/// regions apart.
pub fn one_medium_each(regions: &[Region]) -> Vec<Region> {
    let own = |(k, region): (usize, &Region)| Region { medium: k as u32 + 1, ..region.clone() };
    regions.iter().enumerate().map(own).collect()
}

/// Replaces a box of zero width, which has no cross-section, with the empty box.
fn empty_if_flat(own: Bounds) -> Bounds {
    if own.size().min_element() > 0.0 { own } else { Bounds::EMPTY }
}

/// The sum of the cross-sections of a box along the three axes.
fn sides(own: &Bounds) -> f64 {
    let size = own.size();
    size.x * size.y + size.y * size.z + size.z * size.x
}

/// A lower bound of the number of rays of a round through `common` that pass the box of a region: two for each cell inside its
/// cross-section, and three times the rays along the axis that has the fewest.
pub(super) fn surely_inside(own: &Bounds, common: &Bounds, across: u64) -> u64 {
    let [size, all] = [own.size(), common.size()];
    // an edge of the box cuts at most two cells, of which one may only be touched
    let along = |k: usize| ((size[k] / all[k] * across as f64) as u64).saturating_sub(1);
    let cells = (0..3).map(|axis| along((axis + 1) % 3) * along((axis + 2) % 3));
    6 * cells.min().unwrap_or(0)
}

fn checked(settings: &MeasureSettings) -> Result<f64, MeasureError> {
    if !(settings.precision > 0.0 && settings.precision <= 1.0) {
        return Err(MeasureError::Precision(settings.precision));
    }
    if !(0.5..1.0).contains(&settings.confidence) {
        return Err(MeasureError::Confidence(settings.confidence));
    }
    match &settings.within {
        Some(own) if !(own.is_finite() && own.size().min_element() > 0.0) => {
            Err(MeasureError::BadBox { lo: own.lo.to_array(), hi: own.hi.to_array() })
        }
        _ => Ok(quantile(settings.confidence)),
    }
}

/// The last round of a region, and what its rounds tell about the next.
#[derive(Clone, Debug, Default)]
struct Latest {
    /// The sums about `origin`.
    tally: Tally,
    origin: Vec3,
    plan: Plan,
    /// True if the round is large enough by earlier rounds; only such a round is reported, if the limits permit it.
    is_final: bool,
    /// The number of rays of all rounds.
    rays: u64,
}

impl Latest {
    /// The number of rays through the box of the region since the last round that crossed it, after one of so many rays.
    fn passed(&self, before: u64, rays: u64) -> u64 {
        if self.plan.is_met() { 0 } else { before + rays }
    }
}

struct Run<'a, E> {
    evaluator: &'a E,
    settings: &'a MeasureSettings,
    axes: Axes,
    load: RayLoad,
    /// The number of shapes that further rays may reach; `u64::MAX` without a limit.
    left: u64,
    /// The number of cells along an edge in the first round.
    first: u64,
    progress: &'a mut dyn FnMut(MeasureProgress),
    quantile: f64,
    traced: u64,
    streams: u64,
    /// The relative half-width of the volume of each region.
    reached: Vec<f64>,
}

/// The boxes of the regions within the box of the settings, and the box around them.
pub(super) fn boxes_of(
    program: &Program,
    settings: &MeasureSettings,
) -> Result<(Vec<Bounds>, Bounds), MeasureError> {
    checked(settings)?;
    let clipped = |own: Bounds| settings.within.map_or(own, |within| own.intersection(&within));
    let boxes: Vec<Bounds> =
        program.region_bounds().into_iter().map(|own| empty_if_flat(clipped(own))).collect();
    let whole = boxes.iter().fold(Bounds::EMPTY, |all, own| all.union(own));
    Ok((boxes, whole))
}

/// Checks that rays can cover the box.
pub(super) fn check_bounds(program: &Program, bounds: &Bounds) -> Result<(), MeasureError> {
    let name = || match program.regions() {
        [only] => only.name.clone(),
        _ => "the model".to_owned(),
    };
    let unbounded: Vec<&str> = (0..3)
        .filter(|&k| bounds.lo[k].is_infinite() || bounds.hi[k].is_infinite())
        .map(|k| ["x", "y", "z"][k])
        .collect();
    if !unbounded.is_empty() {
        // "x", "x and y" or "x, y and z"
        let commas = unbounded.len().saturating_sub(2);
        let axes = unbounded.join(" and ").replacen(" and ", ", ", commas);
        return Err(MeasureError::Unbounded { name: name(), axes });
    }
    let reach = bounds.lo.abs().max(bounds.hi.abs()).max_element();
    match reach > MAX_REACH {
        true => Err(MeasureError::TooFar { name: name(), reach, most: MAX_REACH }),
        false => Ok(()),
    }
}

impl<E: Evaluator> Run<'_, E> {
    fn is_reached(&self, latest: &Latest) -> bool {
        let (tally, weights) = (&latest.tally, volume_weights());
        self.quantile * tally.deviation(&weights) <= self.settings.precision * tally.value(&weights)
    }

    /// The number of rays that may follow, by the shapes that they reach, where rays along the axes reach these numbers each.
    fn affordable(&self, load: &[f64; 3]) -> u64 {
        self.axes.affordable(load, self.left)
    }

    /// Repeats the first round for the regions for which it predicts that so many rays suffice: one round for all of them. Returns
    /// the number of its rays, or 0 if there are none.
    fn repeat_first(
        &mut self,
        whole: &Bounds,
        load: &[f64; 3],
        results: &mut [Latest],
    ) -> Result<u64, MeasureError> {
        let (rays, unit) = (self.axes.rays(self.first), self.unit(whole));
        let aim = self.aim();
        let is_enough = |latest: &Latest| latest.plan.is_enough(unit, aim, self.first as f64);
        let easy: Vec<bool> = results.iter().map(is_enough).collect();
        if !easy.contains(&true) || rays > self.affordable(load).min(self.settings.most_rays) {
            return Ok(0);
        }
        self.round(whole, load, self.first, |region| easy[region], results)?;
        results.iter_mut().zip(easy).for_each(|(latest, is_easy)| latest.is_final = is_easy);
        Ok(rays)
    }

    /// Runs rounds for one region in its own box, the first of `count` regions left, which has spent some rays; returns three times the
    /// number of rays along the axis with the fewest, of the rounds since the last one that crossed it.
    fn refine(
        &mut self,
        region: usize,
        bounds: &Bounds,
        count: u64,
        mut spent: u64,
        results: &mut [Latest],
    ) -> Result<u64, MeasureError> {
        let mut passed = 0;
        let (load, unit) = (self.load.along_axes(bounds), self.unit(bounds));
        let kept = if self.left == u64::MAX { 0 } else { self.left - self.left / count };
        while !bounds.is_empty() && !self.is_finished(&results[region], passed) {
            let affordable = self.axes.affordable(&load, self.left.saturating_sub(kept));
            let most = self.axes.across_of(affordable.min(self.settings.most_rays - spent));
            let limits = Limits { least: self.first, most };
            let Some(next) = results[region].plan.next(unit, self.aim(), limits) else {
                break;
            };
            spent += self.axes.rays(next.across);
            self.round(bounds, &load, next.across, |own| own == region, results)?;
            let latest = &mut results[region];
            latest.is_final = next.is_final;
            passed = latest.passed(passed, 6 * self.axes.least(next.across).pow(2));
        }
        Ok(passed)
    }

    /// Runs rounds for all regions together; returns, for each region, the number of rays that certainly pass its box, of the rounds
    /// since the last one that crossed it.
    fn refine_together(
        &mut self,
        boxes: &[Bounds],
        whole: Bounds,
        results: &mut [Latest],
    ) -> Result<Vec<u64>, MeasureError> {
        let (mut passed, mut left) = (vec![0; boxes.len()], self.settings.most_rays);
        let (mut common, mut is_closed) = (whole, vec![false; boxes.len()]);
        let in_whole = self.load.along_axes(&whole);
        let loads: Option<Vec<[f64; 3]>> = (boxes.len().saturating_mul(self.load.len()) <= MOST_COMPARED)
            .then(|| boxes.iter().map(|own| self.load.along_axes(own)).collect());
        loop {
            let is_open = |&region: &usize| {
                !boxes[region].is_empty()
                    && !is_closed[region]
                    && !self.is_finished(&results[region], passed[region])
            };
            let listed: Vec<usize> = (0..boxes.len()).filter(is_open).collect();
            if listed.is_empty() {
                return Ok(passed);
            }
            let around = listed.iter().fold(Bounds::EMPTY, |all, &region| all.union(&boxes[region]));
            if sides(&around) < 0.5 * sides(&common) {
                common = around;
            }
            let crossed: f64 = listed.iter().map(|&region| sides(&boxes[region])).sum();
            if crossed >= sides(&common) {
                let load = self.load.along_axes(&common);
                let most = self.axes.across_of(self.affordable(&load).min(left));
                let Some(across) = self.shared_round(&common, &load, &listed, most, results)? else {
                    return Ok(passed);
                };
                left -= self.axes.rays(across);
                listed.iter().for_each(|&region| {
                    let rays = surely_inside(&boxes[region], &common, self.axes.least(across));
                    passed[region] = results[region].passed(passed[region], rays);
                });
                continue;
            }
            let load_of = |region: usize| loads.as_ref().map_or(in_whole, |loads| loads[region]);
            let reached = |&region: &usize| self.axes.mean(&load_of(region).map(|load| load.max(1.0)));
            let reached: f64 = listed.iter().map(reached).sum();
            let affordable = if self.left == u64::MAX { f64::MAX } else { self.left as f64 / reached };
            let most = self.axes.across_of((affordable as u64).min(left / listed.len() as u64));
            for &region in &listed {
                let limits = Limits { least: self.first / 2, most };
                let (unit, plan) = (self.unit(&boxes[region]), &results[region].plan);
                let Some(next) = plan.next(unit, self.aim(), limits) else {
                    is_closed[region] = true;
                    continue;
                };
                left -= self.axes.rays(next.across);
                self.round(&boxes[region], &load_of(region), next.across, |own| own == region, results)?;
                let latest = &mut results[region];
                latest.is_final = next.is_final;
                passed[region] = latest.passed(passed[region], 6 * self.axes.least(next.across).pow(2));
            }
        }
    }

    /// Runs a round through a box for some regions together; returns the number of cells along an edge, or `None` if the limit does not
    /// permit a round as large as the last.
    fn shared_round(
        &mut self,
        common: &Bounds,
        load: &[f64; 3],
        listed: &[usize],
        most: u64,
        results: &mut [Latest],
    ) -> Result<Option<u64>, MeasureError> {
        let (unit, aim) = (self.unit(common), self.aim());
        let plans: Vec<Plan> = listed.iter().map(|&region| results[region].plan).collect();
        let limits = Limits { least: self.first, most };
        let Some(next) = plan::next_together(&plans, unit, aim, limits) else {
            return Ok(None);
        };
        let mut is_listed = vec![false; results.len()];
        listed.iter().for_each(|&region| is_listed[region] = true);
        self.round(common, load, next.across, |region| is_listed[region], results)?;
        for (&region, before) in listed.iter().zip(&plans) {
            results[region].is_final = next.is_final || before.is_enough(unit, aim, next.across as f64);
        }
        Ok(Some(next.across))
    }

    /// The relative half width for which rounds are planned.
    fn aim(&self) -> f64 {
        plan::aim(self.settings.precision, self.quantile)
    }

    /// The density of a round of one cell along an edge of a box.
    fn unit(&self, bounds: &Bounds) -> f64 {
        let size = bounds.size();
        let along =
            |axis: usize| self.axes.across[axis].powi(2) / (size[(axis + 1) % 3] * size[(axis + 2) % 3]);
        (0..3).map(along).sum()
    }

    /// True if no more rays are needed. A region that no ray crossed gets one more round.
    fn is_finished(&self, latest: &Latest, passed: u64) -> bool {
        match latest.plan.is_met() {
            true => latest.is_final && self.is_reached(latest),
            false => passed > 0,
        }
    }

    /// Traces rays along all three axes through a box, for some of the regions; `load` is the number of shapes that each reaches, and
    /// `across` the largest number of cells along an edge.
    fn round(
        &mut self,
        bounds: &Bounds,
        load: &[f64; 3],
        across: u64,
        is_wanted: impl Fn(usize) -> bool,
        results: &mut [Latest],
    ) -> Result<(), MeasureError> {
        let mut tallies: BTreeMap<usize, Tally> = BTreeMap::new();
        let (mut density, mut crossings) = (0.0, 0);
        for axis in 0..3 {
            self.streams += 1;
            let cells = Cells {
                bounds: *bounds,
                axis,
                across: self.axes.across(axis, across),
                seed: self.settings.seed,
                stream: self.streams,
                within: self.settings.within,
            };
            density += 1.0 / cells.area();
            let area = cells.area();
            let (sums, crossed) = self.cells(&cells)?;
            crossings += crossed;
            for (region, tally) in sums {
                let region = region.index() - 1;
                if is_wanted(region) {
                    // the mean of three estimates of the volume, and the sum of three shares of the boundary
                    tallies.entry(region).or_default().add(&tally, area / 3.0, area);
                }
            }
        }
        if self.left != u64::MAX {
            // most shapes are crossed twice; rays in the box of a region may reach more than the load, that of the whole model
            self.left = self.left.saturating_sub(self.axes.reached(load, across).max(crossings / 2));
        }
        let rays = self.axes.rays(across);
        let all = results.iter_mut().enumerate();
        for (region, latest) in all.filter(|(region, _)| is_wanted(*region)) {
            latest.tally = tallies.remove(&region).unwrap_or_default();
            latest.origin = bounds.centre();
            latest.rays += rays;
            let weights = volume_weights();
            let volume = latest.tally.value(&weights);
            let half_width = match volume > 0.0 {
                true => self.quantile * latest.tally.deviation(&weights) / volume,
                false => f64::INFINITY,
            };
            latest.plan.add(Traced { density, half_width });
            // a region that no ray has crossed has no precision
            self.reached[region] = if volume > 0.0 { half_width } else { 0.0 };
        }
        Ok(())
    }

    /// The sums over all cells along one axis, for cells of area 1, and the number of crossings.
    fn cells(&mut self, cells: &Cells) -> Result<(Sums, u64), MeasureError> {
        let (count, mut sums, mut crossings) = (cells.count(), Sums::new(), 0);
        let (evaluator, traced, progress) = (self.evaluator, &mut self.traced, &mut self.progress);
        let precision = self.reached.iter().copied().fold(0.0, f64::max);
        let tasks = (0..count.div_ceil(CELLS_PER_TASK))
            .map(|task| task * CELLS_PER_TASK..count.min((task + 1) * CELLS_PER_TASK));
        let work = |(scratch, batch): &mut (E::Scratch, RayBatch), range: Range<u64>| {
            cells.rays(range, batch);
            (batch.len() as u64, cells.trace(evaluator, batch, scratch))
        };
        let merge = |(rays, (found, crossed)): (u64, (Sums, u64))| {
            *traced += rays;
            crossings += crossed;
            progress(MeasureProgress { rays: *traced, precision });
            for (region, tally) in found {
                sums.entry(region).or_default().add(&tally, 1.0, 1.0);
            }
            Ok::<(), MeasureError>(())
        };
        let scratch = || (evaluator.scratch(), RayBatch::default());
        let threads = thread_count(self.settings.threads);
        drive(threads, &self.settings.cancel, tasks, scratch, work, merge).map_err(
            |stopped| match stopped {
                Stopped::Cancelled => MeasureError::Cancelled,
                Stopped::Failed(error) => error,
            },
        )?;
        sums.retain(|region, _| *region != RegionId(0));
        Ok((sums, crossings))
    }
}
