//! Infill layer by layer, on all cores.

use super::component::components;
use super::layers::MAX_REACH;
use super::region::Piece;
use super::{Fillable, InfillError, Layers, Raster};
use rayweave_math::Bounds;
use rayweave_model::drive::{Cancel, Stopped, drive, thread_count};
use rayweave_model::memory::Growth;
use std::num::NonZeroUsize;
use std::ops::Range;

/// The maximum number of scan lines per run.
const MAX_LINES: u64 = 10_000_000;

/// Scan lines per task.
const LINES_PER_TASK: i64 = 512;

/// The options of an infill.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Filling {
    /// The scan lines of layer 0.
    pub raster: Raster,
    /// The rotation of each layer relative to the previous one, about the origin, in degrees.
    pub turn: f64,
    /// True if scan lines with an odd number are run backwards.
    pub alternate: bool,
}

/// The options of a run.
#[derive(Clone, Debug, Default)]
pub struct InfillRun {
    /// The number of threads; by default that of [`thread_count`].
    pub threads: Option<NonZeroUsize>,
    /// Cancels the run.
    pub cancel: Cancel,
}

/// One trace: the path of the tool on one scan line, from its entry into the region to its exit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InfillTrace {
    /// The number of the scan line on the grid of its layer.
    pub scanline: i64,
    /// The number of its component within the layer.
    pub component: u32,
    /// The start point.
    pub from: [f64; 2],
    /// The end point.
    pub to: [f64; 2],
}

impl InfillTrace {
    /// The length.
    pub fn length(&self) -> f64 {
        let [x, y] = [0, 1].map(|k| self.to[k] - self.from[k]);
        (x * x + y * y).sqrt()
    }
}

/// All traces of a layer, in the order in which they are run.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerTraces {
    /// The number of the layer, from 0.
    pub layer: usize,
    /// The height.
    pub z: f64,
    /// The traces.
    pub traces: Vec<InfillTrace>,
    /// The number of components.
    pub components: u32,
}

/// A summary of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Summary {
    /// The number of layers.
    pub layers: usize,
    /// The numbers of the layers without any trace.
    pub empty: Vec<usize>,
    /// The number of traces.
    pub traces: u64,
    /// The total length of all traces.
    pub length: f64,
}

/// A range of scan lines of a layer.
struct Task {
    layer: usize,
    lines: Range<i64>,
    is_last: bool,
}

/// Fills the layers of a solid or a region and passes them to `take` in order.
///
/// Results have the same bits for any number of threads. At most 10 million scan lines and 1 million layers are
/// filled in one run.
///
/// # Errors
///
/// [`InfillError`] for settings out of range, an empty or unbounded region, too many scan lines, a
/// layer whose traces do not fit into memory, or a cancelled run; or the error of `take`, which ends the run.
pub fn infill<F: Fillable, X: From<InfillError>>(
    fillable: &F,
    filling: &Filling,
    layers: &Layers,
    run: &InfillRun,
    mut take: impl FnMut(LayerTraces) -> Result<(), X>,
) -> Result<Summary, X> {
    let heights = plan(fillable, filling, layers, &run.cancel)?;
    let rasters = rasters(filling, heights.len())?;
    let tasks = tasks(&fillable.bounds(), &heights, &rasters)?;
    let mut summary = Summary { layers: heights.len(), ..Summary::default() };
    let (mut pieces, mut growth): (Vec<Piece>, Growth) = Default::default();
    let merge = |(task, found): (Task, Vec<Piece>)| {
        pieces.extend(found);
        // the memory for the pieces and for the traces made from them
        let bytes = pieces.len() * (size_of::<Piece>() + size_of::<InfillTrace>());
        growth.check(bytes as u64).map_err(InfillError::from)?;
        if !task.is_last {
            return Ok(());
        }
        let raster = &rasters[task.layer];
        let done = finish(&pieces, raster, filling.alternate, task.layer, heights[task.layer]);
        pieces.clear();
        summary.add(&done);
        take(done)
    };
    drive(
        thread_count(run.threads),
        &run.cancel,
        tasks.into_iter(),
        || fillable.scratch(),
        |scratch, task| {
            let found = match task.lines.is_empty() {
                true => Vec::new(),
                false => {
                    fillable.pieces(&rasters[task.layer], heights[task.layer], task.lines.clone(), scratch)
                }
            };
            (task, found)
        },
        merge,
    )
    .map_err(|stopped| match stopped {
        Stopped::Cancelled => InfillError::Cancelled.into(),
        Stopped::Failed(error) => error,
    })?;
    Ok(summary)
}

/// Checks that the region can be filled, and returns the heights of the layers.
fn plan(
    fillable: &impl Fillable,
    filling: &Filling,
    layers: &Layers,
    cancel: &Cancel,
) -> Result<Vec<f64>, InfillError> {
    let (name, bounds) = (fillable.name(), fillable.bounds());
    if bounds.is_empty() {
        return Err(InfillError::Empty { name });
    }
    let unbounded: Vec<&str> = (0..2)
        .filter(|&k| bounds.lo[k].is_infinite() || bounds.hi[k].is_infinite())
        .map(|k| ["x", "y"][k])
        .collect();
    if !unbounded.is_empty() {
        return Err(InfillError::Unbounded { name, axes: unbounded.join(" and ") });
    }
    let reach = bounds.lo.truncate().abs().max(bounds.hi.truncate().abs()).max_element();
    if reach > MAX_REACH {
        return Err(InfillError::TooFar { name, reach, most: MAX_REACH });
    }
    let &Layers::Every(height) = layers else { return layers.heights(&name, &bounds) };
    // of the bounds, for their errors
    layers.heights(&name, &bounds)?;
    let extent = fillable.extent();
    let mut heights = layers.heights(&name, &extent)?;
    if extent == bounds {
        return Ok(heights);
    }
    let mut missed =
        Missed { fillable, raster: &filling.raster, bounds: &bounds, scratch: fillable.scratch() };
    let at = |k: i64| extent.lo.z + (k as f64 + 0.5) * height;
    let beyond = |from: i64, step: i64| {
        (0..).map(move |k| at(from + step * k)).take_while(|z| (bounds.lo.z..=bounds.hi.z).contains(z))
    };
    let below = missed.layers(beyond(-1, -1).collect(), cancel)?;
    let above = missed.layers(beyond(heights.len() as i64, 1).collect(), cancel)?;
    heights.splice(0..0, below.into_iter().rev());
    heights.extend(above);
    Ok(heights)
}

/// Search for parts of a region beyond its extent, such as needles, which no ray has found.
struct Missed<'a, F: Fillable> {
    fillable: &'a F,
    raster: &'a Raster,
    bounds: &'a Bounds,
    scratch: F::Scratch,
}

impl<F: Fillable> Missed<'_, F> {
    /// The layers up to the last one with traces.
    fn layers(&mut self, mut heights: Vec<f64>, cancel: &Cancel) -> Result<Vec<f64>, InfillError> {
        while let Some(&z) = heights.last() {
            if cancel.is_cancelled() {
                return Err(InfillError::Cancelled);
            }
            if self.has_traces(z)? {
                break;
            }
            heights.pop();
        }
        Ok(heights)
    }

    fn has_traces(&mut self, z: f64) -> Result<bool, InfillError> {
        let corners = [self.bounds.lo, self.bounds.hi].map(|corner| [corner.x, corner.y]);
        let lines = self.raster.scanlines(corners, MAX_LINES)?;
        let mut starts = lines.clone().step_by(LINES_PER_TASK as usize);
        Ok(starts.any(|start| {
            let part = start..lines.end.min(start + LINES_PER_TASK);
            !self.fillable.pieces(self.raster, z, part, &mut self.scratch).is_empty()
        }))
    }
}

/// The grid of scan lines of each layer.
fn rasters(filling: &Filling, layers: usize) -> Result<Vec<Raster>, InfillError> {
    let turned = (0..layers).map(|j| filling.raster.turned(j as f64 * filling.turn));
    // an infinite angle has no direction
    turned.collect::<Result<_, _>>().map_err(|_| InfillError::Turn(filling.turn))
}

/// The scan lines of all layers, divided into tasks; a layer outside the bounds, or between scan lines, has
/// one task without lines.
fn tasks(bounds: &Bounds, heights: &[f64], rasters: &[Raster]) -> Result<Vec<Task>, InfillError> {
    let corners = [bounds.lo, bounds.hi].map(|corner| [corner.x, corner.y]);
    let (mut tasks, mut left) = (Vec::new(), MAX_LINES);
    for (layer, (z, raster)) in heights.iter().zip(rasters).enumerate() {
        let lines = match (bounds.lo.z..=bounds.hi.z).contains(z) {
            true => raster.scanlines(corners, MAX_LINES)?,
            false => 0..0,
        };
        if lines.is_empty() {
            tasks.push(Task { layer, lines, is_last: true });
            continue;
        }
        let count = (lines.end - lines.start) as u64;
        left = left.checked_sub(count).ok_or(InfillError::TooManyLines {
            spacing: raster.spacing(),
            lines: count as f64 * heights.len() as f64,
            most: MAX_LINES,
        })?;
        let starts = lines.clone().step_by(LINES_PER_TASK as usize);
        tasks.extend(starts.map(|start| {
            let end = lines.end.min(start + LINES_PER_TASK);
            Task { layer, lines: start..end, is_last: end == lines.end }
        }));
    }
    Ok(tasks)
}

/// Builds the traces of a layer from its pieces.
fn finish(pieces: &[Piece], raster: &Raster, alternate: bool, layer: usize, z: f64) -> LayerTraces {
    let roots = components(pieces);
    let direction = raster.direction();
    let mut number = vec![u32::MAX; pieces.len()];
    let mut count = 0;
    let mut traces = Vec::with_capacity(pieces.len());
    let mut first = 0;
    for line in pieces.chunk_by(|a, b| a.0 == b.0) {
        let scanline = line[0].0;
        let origin = raster.origin(scanline);
        let at = |t: f64| [0, 1].map(|k| origin[k] + t * direction[k]);
        let is_backwards = alternate && scanline % 2 != 0;
        for k in 0..line.len() {
            let k = if is_backwards { line.len() - 1 - k } else { k };
            let own = &mut number[roots[first + k] as usize];
            if *own == u32::MAX {
                *own = count;
                count += 1;
            }
            let ends = line[k].1.map(at);
            let [from, to] = if is_backwards { [ends[1], ends[0]] } else { ends };
            traces.push(InfillTrace { scanline, component: *own, from, to });
        }
        first += line.len();
    }
    LayerTraces { layer, z, traces, components: count }
}

impl Summary {
    fn add(&mut self, layer: &LayerTraces) {
        if layer.traces.is_empty() {
            self.empty.push(layer.layer);
        }
        self.traces += layer.traces.len() as u64;
        self.length += layer.traces.iter().map(InfillTrace::length).sum::<f64>();
    }
}
