//! Measurement by a fixed number of rays, whose cells are divided into ranges that run anywhere.
//!
//! One set of rays serves all regions, as in the first round of [`measure`](super::measure). Contributions of cells are rounded
//! towards zero to multiples of a unit and summed as integers, so that the sums do not depend on how the cells are divided. The
//! unit is 2^-61 of the greatest possible contribution, far below its rounding of 2^-53. For products of moments it is 2^-92, so
//! that the variance of a region as thin as a rounding error of the model is not lost; 2^35 cells fit.

use super::MeasureError;
use super::cells::Cells;
use super::chord::MeasuredChord;
use super::estimate::{Measured, Measurement, quantile, report, volume_weights};
use super::moments::{MOMENTS, Moments};
use super::run::{MeasureSettings, boxes_of, check_bounds, surely_inside, uncrossed};
use super::tally::{ENTRIES, RayContribution, Tally};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::drive::{Stopped, drive, thread_count};
use rayweave_model::{Evaluator, RayBatch, RegionId};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::ops::Range;

/// Cells per task.
const CELLS_PER_TASK: u64 = 1024;

/// The number of random streams before those of these rays: a measurement that refines regions has streams from 1.
const STREAMS: u64 = 1 << 32;

/// Sums per region: moments, area, variance of the area, covariances.
const SUMS: usize = MOMENTS + 2 + ENTRIES;

/// The first line of the text of a share.
const HEADER: &str = "rayweave measure share 2, cells across";

/// The number of cells, of two rays each, of a measurement with about `rays` rays: three cross-sections of equal numbers of cells.
pub fn cell_count(rays: u64) -> u64 {
    3 * across(rays) * across(rays)
}

fn across(rays: u64) -> u64 {
    (rays / 6).isqrt().max(1)
}

/// The sums over a range of cells, by axis and region.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureShare {
    across: u64,
    sums: BTreeMap<(usize, RegionId), Sums>,
}

/// The sums over cells of area 1 for a region along an axis.
#[derive(Clone, Debug, PartialEq)]
struct Sums {
    sums: [i128; SUMS],
    longest: MeasuredChord,
}

/// The unit of moments, areas and squares of areas (which are large at grazing rays): two to this power, relative to the greatest possible contribution.
const LINEAR: i32 = -61;

/// The unit of products of two moments.
const PRODUCT: i32 = -92;

/// The units of the sums: powers of two, so that scaling is exact.
struct Scale {
    /// Lengths are at most two to this power.
    exponent: i32,
}

/// The power of the length in each moment.
fn degree(moment: usize) -> i32 {
    match moment {
        0 => 1,
        1..=3 => 2,
        _ => 3,
    }
}

/// Two to a power from -1022 to 1023.
fn two_to(power: i32) -> f64 {
    f64::from_bits(((power + 1023) as u64) << 52)
}

impl Scale {
    fn new(whole: &Bounds) -> Scale {
        // sixth powers of lengths of 1e30 and their inverses are finite
        let exponent = ((whole.size().max_element().to_bits() >> 52) & 0x7ff) as i32 - 1022;
        Scale { exponent: exponent.clamp(-110, 110) }
    }

    /// The unit of quantities with this power of the length.
    fn unit(&self, degree: i32, unit: i32) -> f64 {
        two_to(self.exponent * degree + unit)
    }

    /// The quantity as a multiple of its unit.
    fn whole(&self, value: f64, degree: i32, unit: i32) -> i128 {
        (value * two_to(-unit - self.exponent * degree)) as i128
    }
}

impl Sums {
    fn new() -> Sums {
        Sums { sums: [0; SUMS], longest: MeasuredChord::default() }
    }

    /// Adds a cell of area 1, sampled by two rays: the quantities of [`Tally::cell`].
    fn cell(&mut self, scale: &Scale, a: &RayContribution, b: &RayContribution) {
        let mut half = [0.0; MOMENTS];
        for k in 0..MOMENTS {
            self.sums[k] += scale.whole(0.5 * (a.moments[k] + b.moments[k]), degree(k), LINEAR);
            half[k] = 0.5 * (a.moments[k] - b.moments[k]);
        }
        self.sums[MOMENTS] += scale.whole(0.5 * (a.area + b.area), 0, LINEAR);
        let difference = 0.5 * (a.area - b.area);
        self.sums[MOMENTS + 1] += scale.whole(difference * difference, 0, LINEAR);
        let mut entry = MOMENTS + 2;
        for i in 0..MOMENTS {
            for j in i..MOMENTS {
                self.sums[entry] += scale.whole(half[i] * half[j], degree(i) + degree(j), PRODUCT);
                entry += 1;
            }
        }
        self.longest = self.longest.or_longer(a.longest).or_longer(b.longest);
    }

    /// Adds the sums over later cells.
    fn append(&mut self, later: &Sums) {
        self.sums.iter_mut().zip(&later.sums).for_each(|(own, other)| *own += other);
        self.longest = self.longest.or_longer(later.longest);
    }

    fn tally(&self, scale: &Scale) -> Tally {
        let value = |sum: usize, degree: i32, unit: i32| self.sums[sum] as f64 * scale.unit(degree, unit);
        let moments: Moments = std::array::from_fn(|k| value(k, degree(k), LINEAR));
        let area = [value(MOMENTS, 0, LINEAR), value(MOMENTS + 1, 0, LINEAR)];
        let mut degrees = (0..MOMENTS).flat_map(|i| (i..MOMENTS).map(move |j| degree(i) + degree(j)));
        let covariance =
            std::array::from_fn(|k| value(MOMENTS + 2 + k, degrees.next().unwrap_or_default(), PRODUCT));
        Tally::of_sums(moments, area, covariance, self.longest)
    }
}

impl MeasureShare {
    /// Measures all regions with about `rays` rays, of which only the cells of a range are traced. `settings.precision` and
    /// the limits of `settings` have no effect. `progress` receives the number of rays so far.
    ///
    /// # Errors
    ///
    /// [`MeasureError`] for an unbounded region, settings out of range, a cancelled run.
    pub fn trace<E: Evaluator>(
        evaluator: &E,
        settings: &MeasureSettings,
        rays: u64,
        cells: Range<u64>,
        progress: &mut dyn FnMut(u64),
    ) -> Result<MeasureShare, MeasureError> {
        let (_, whole) = boxes_of(evaluator.program(), settings)?;
        let across = across(rays);
        let mut share = MeasureShare { across, sums: BTreeMap::new() };
        if whole.is_empty() {
            return Ok(share);
        }
        check_bounds(evaluator.program(), &whole)?;
        let scale = Scale::new(&whole);
        let each = across * across;
        let cut = |axis: u64| cells.start.max(axis * each)..cells.end.min((axis + 1) * each);
        let pieces = |axis: u64| {
            let Range { start, end } = cut(axis);
            let count = end.saturating_sub(start).div_ceil(CELLS_PER_TASK);
            (0..count).map(move |k| {
                let first = start + k * CELLS_PER_TASK;
                (axis as usize, first - axis * each..end.min(first + CELLS_PER_TASK) - axis * each)
            })
        };
        // a list of them would not fit into memory for the largest numbers of rays
        let tasks = (0..3).flat_map(pieces);
        let work = |(scratch, batch): &mut (E::Scratch, RayBatch), (axis, range): (usize, Range<u64>)| {
            let mut found = BTreeMap::new();
            let cells = share_cells(&whole, axis, across, settings);
            cells.rays(range, batch);
            cells.each(evaluator, batch, scratch, |region, [a, b]| {
                found.entry((axis, region)).or_insert_with(Sums::new).cell(&scale, &a, &b);
            });
            (batch.len() as u64, found)
        };
        let mut traced = 0;
        let merge = |(rays, found): (u64, BTreeMap<(usize, RegionId), Sums>)| {
            traced += rays;
            progress(traced);
            share.append_sums(&found);
            Ok::<(), MeasureError>(())
        };
        let scratch = || (evaluator.scratch(), RayBatch::default());
        let threads = thread_count(settings.threads);
        drive(threads, &settings.cancel, tasks, scratch, work, merge).map_err(|stopped| match stopped {
            Stopped::Cancelled => MeasureError::Cancelled,
            Stopped::Failed(error) => error,
        })?;
        Ok(share)
    }

    fn append_sums(&mut self, later: &BTreeMap<(usize, RegionId), Sums>) {
        for (key, sums) in later {
            self.sums.entry(*key).or_insert_with(Sums::new).append(sums);
        }
    }

    /// Adds the sums over the next range of cells of the same measurement.
    pub fn append(&mut self, later: &MeasureShare) {
        self.append_sums(&later.sums);
    }

    /// The results from the sums over all cells.
    ///
    /// # Errors
    ///
    /// [`MeasureError`] for settings out of range.
    pub fn report<E: Evaluator>(
        &self,
        evaluator: &E,
        settings: &MeasureSettings,
    ) -> Result<Measurement, MeasureError> {
        let program = evaluator.program();
        let (boxes, whole) = boxes_of(program, settings)?;
        let (quantile, rays) = (quantile(settings.confidence), 6 * self.across * self.across);
        let scale = (!whole.is_empty()).then(|| Scale::new(&whole));
        let region = |(number, info): (usize, &rayweave_model::RegionInfo)| {
            let mut mean = Tally::default();
            for axis in 0..3 {
                let sums = self.sums.get(&(axis, RegionId(number as u32 + 1)));
                if let (Some(sums), Some(scale)) = (sums, &scale) {
                    let area = share_cells(&whole, axis, self.across, settings).area();
                    mean.add(&sums.tally(scale), area / 3.0, area);
                }
            }
            let weights = volume_weights();
            let is_reached = quantile * mean.deviation(&weights) <= settings.precision * mean.value(&weights);
            let origin = if whole.is_empty() { Vec3::ZERO } else { whole.centre() };
            let found =
                Measured { name: info.name.clone(), rays, is_reached, ..report(&mean, origin, quantile) };
            match found.longest {
                None => {
                    let passed = surely_inside(&boxes[number], &whole, self.across);
                    uncrossed(found, &boxes[number], passed, settings.confidence)
                }
                Some(_) => found,
            }
        };
        let regions = program.regions().iter().enumerate().map(region).collect();
        Ok(Measurement { regions, rays, most_rays: rays })
    }

    /// The share as text: a header, and a line for each axis and region with the ends of the longest chord and the sums, which are
    /// integers.
    pub fn to_text(&self) -> String {
        let mut text = format!("{HEADER} {}\n", self.across);
        for ((axis, region), Sums { sums, longest }) in &self.sums {
            // writing to a text cannot fail
            let _ = write!(text, "{axis} {}", region.0);
            for x in longest.from.to_array().into_iter().chain(longest.to.to_array()) {
                let _ = write!(text, " {x:?}");
            }
            for sum in sums {
                let _ = write!(text, " {sum}");
            }
            text.push('\n');
        }
        text
    }

    /// Reads the text of [`to_text`](Self::to_text); `None` if it is damaged.
    pub fn from_text(text: &str) -> Option<MeasureShare> {
        let mut lines = text.lines();
        let across = lines.next()?.strip_prefix(HEADER)?.trim().parse().ok()?;
        let mut share = MeasureShare { across, sums: BTreeMap::new() };
        for line in lines {
            let mut words = line.split(' ');
            let key = (words.next()?.parse().ok()?, RegionId(words.next()?.parse().ok()?));
            let mut number = || words.next()?.parse::<f64>().ok();
            let mut point = || Some(Vec3::new(number()?, number()?, number()?));
            let longest = MeasuredChord { from: point()?, to: point()? };
            let sums: Vec<i128> = words.map(|word| word.parse().ok()).collect::<Option<_>>()?;
            share.sums.insert(key, Sums { sums: sums.try_into().ok()?, longest });
        }
        Some(share)
    }

    /// The number of cells along each edge of a cross-section.
    pub fn across(&self) -> u64 {
        self.across
    }
}

/// The cells along an axis.
fn share_cells(whole: &Bounds, axis: usize, across: u64, settings: &MeasureSettings) -> Cells {
    let stream = STREAMS + axis as u64;
    Cells { bounds: *whole, axis, across, seed: settings.seed, stream, within: settings.within }
}
