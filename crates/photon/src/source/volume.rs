//! Points in a volume and on its boundary, by rejection.

use super::copies::{SelectedCopies, Selection, select};
use crate::detector::Detector;
use crate::error::PhotonError;
use crate::lines::random_line;
use crate::philox::{Purpose, Stream};
use crate::photon::{EventKey, Photon};
use rayweave_error::Message;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, Query, RayAnswer, RayBatch, RegionId};
use rayweave_shape::Ray;
use std::collections::BTreeSet;

/// The inside of a volume, without its daughters, or the boundary of it; all copies of the volume together, or some of them.
///
/// A name selects all copies of a volume. A path, as [`Hits::paths`](crate::Hits::paths) has it, selects those whose own path ends with
/// it: `Crystal[3]`, or `Module[1]/Crystal` for all crystals of one module.
#[derive(Clone, Debug)]
pub struct SourceVolume {
    regions: BTreeSet<u32>,
    /// Some of the copies; `None` for all of them.
    copies: Option<SelectedCopies>,
    bounds: Bounds,
    /// For the boundary: a crossing index below this number is drawn for each line.
    crossings: Option<usize>,
}

/// The number of random points of which at least one must lie in the volume.
const TRIALS: u64 = 1 << 17;

/// The number of lines whose largest number of crossings is measured.
const LINES: u64 = 1 << 14;

/// The depth inside the volume at which photons of a boundary start, in mm along the line that found the boundary.
const DEPTH: f64 = 1e-6;

impl SourceVolume {
    /// The inside of a volume with a name, or of its copies with a path.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for an unknown name or path, an unbounded volume, and one that fills less than about 1e-5 of its box.
    pub fn inside<E: Evaluator>(
        detector: &Detector,
        evaluator: &E,
        name: &str,
    ) -> Result<SourceVolume, PhotonError> {
        let volume = SourceVolume::named(detector, name)?;
        let mut scratch = evaluator.scratch();
        let key = EventKey { seed: 0, event: 0 };
        let mut points = [Vec::new(), Vec::new(), Vec::new()];
        for number in 0..TRIALS {
            let point = volume.point(&mut Stream::new(key.seed, number, 0, Purpose::Position));
            points.iter_mut().zip(point.to_array()).for_each(|(column, value)| column.push(value));
        }
        let mut regions = vec![RegionId(0); points[0].len()];
        evaluator.regions_at(points.each_ref().map(Vec::as_slice), &mut scratch, &mut regions);
        let numbers = (0..regions.len()).filter(|&k| volume.regions.contains(&regions[k].0));
        let mut found = numbers.map(|k| Vec3::from_array([0, 1, 2].map(|axis| points[axis][k])));
        if !found.any(|point| volume.is_in_copies(point)) {
            return Err(too_thin(name, "points"));
        }
        Ok(volume)
    }

    /// The boundary of a volume with a name, or of its copies with a path, towards its mother and its daughters. Photons start 1 nm
    /// inside. Where copies of a volume touch, the face between them counts only if it has an optical surface and one of the copies alone
    /// is selected.
    ///
    /// Points are chosen on random lines through the ball around the volume, which cross each part of a boundary in proportion
    /// to its area (Cauchy-Crofton). A crossing index below a fixed number is drawn for each line, and a line without that
    /// crossing is drawn again; the number is twice the largest one of 16,384 lines, and any further crossings of a line are left out.
    ///
    /// # Errors
    ///
    /// As [`SourceVolume::inside`].
    pub fn boundary<E: Evaluator>(
        detector: &Detector,
        evaluator: &E,
        name: &str,
    ) -> Result<SourceVolume, PhotonError> {
        let volume = SourceVolume::named(detector, name)?;
        let mut rays = RayBatch::default();
        for number in 0..LINES {
            rays.push(random_line(&volume.bounds, &mut Stream::new(0, number, 0, Purpose::Position)));
        }
        let mut most = 0;
        let lines = rays.rays();
        let mut sink =
            |answer: RayAnswer<'_>| most = most.max(volume.ends(&answer, &lines.get(answer.ray)).count());
        evaluator.crossings(lines, &Query::default(), &mut evaluator.scratch(), &mut sink);
        if most == 0 {
            return Err(too_thin(name, "lines"));
        }
        Ok(SourceVolume { crossings: Some(2 * most), ..volume })
    }

    fn named(detector: &Detector, text: &str) -> Result<SourceVolume, PhotonError> {
        let numbers = detector.region_names.iter().zip(0..).skip(1);
        let named: BTreeSet<u32> = numbers.filter(|(own, _)| *own == text).map(|(_, k)| k).collect();
        let (regions, copies) = match named.is_empty() {
            false => (named, None),
            true => match select(detector, text) {
                Selection::Volume(regions, copies) => (regions, copies),
                Selection::Unknown(paths) => return Err(unknown(detector, text, &paths)),
            },
        };
        let boxes = detector.program.region_bounds();
        let own = regions.iter().map(|&k| boxes[k as usize - 1]).fold(Bounds::EMPTY, |a, b| a.union(&b));
        let bounds = copies.as_ref().map_or(own, |copies| copies.bounds().intersection(&own));
        if !bounds.is_finite() {
            let problem = format!("the volume `{text}` is unbounded");
            return Err(PhotonError::setting(problem, "photons are emitted with equal density"));
        }
        Ok(SourceVolume { regions, copies, bounds, crossings: None })
    }

    /// True if a point of the volume lies in the selected copies.
    fn is_in_copies(&self, point: Vec3) -> bool {
        self.copies.as_ref().is_none_or(|copies| copies.contain(&self.regions, point))
    }

    /// A point of the box.
    fn point(&self, stream: &mut Stream) -> Vec3 {
        let [x, y, z] = [(); 3].map(|()| stream.uniform());
        self.bounds.lo + self.bounds.size() * Vec3::new(x, y, z)
    }

    /// The times at which a line enters or leaves the volume, just inside.
    fn ends<'a>(&'a self, answer: &RayAnswer<'a>, line: &Ray) -> impl Iterator<Item = f64> + 'a {
        let line = *line;
        answer.crossings.iter().filter_map(move |crossing| {
            let times = [crossing.t - DEPTH, crossing.t + DEPTH];
            let is_inside =
                |region: RegionId, t: f64| self.regions.contains(&region.0) && self.is_in_copies(line.at(t));
            let [before, after] = [is_inside(crossing.before, times[0]), is_inside(crossing.after, times[1])];
            (before != after).then_some(times[usize::from(after)])
        })
    }

    /// Places photons with consecutive numbers. Each attempt of a photon has random numbers of its own, so that the place
    /// does not depend on the other photons.
    pub(super) fn place<E: Evaluator>(
        &self,
        evaluator: &E,
        scratch: &mut E::Scratch,
        key: EventKey,
        first: u64,
        photons: &mut [Photon],
    ) {
        let mut waiting: Vec<usize> = (0..photons.len()).collect();
        let mut attempt = 0;
        while !waiting.is_empty() {
            // several attempts at once where few photons are left
            let width = (4096 / waiting.len()).clamp(1, 256) as u32;
            let streams = waiting.iter().flat_map(|&i| {
                let number = key.number(first + i as u64);
                (0..width).map(move |k| Stream::new(key.seed, number, attempt + k, Purpose::Position))
            });
            let found = match self.crossings {
                None => self.find_points(evaluator, scratch, streams),
                Some(most) => self.find_ends(evaluator, scratch, streams, most),
            };
            let mut places = found.chunks_exact(width as usize);
            waiting.retain(|&i| {
                let place = places.next().and_then(|attempts| attempts.iter().flatten().next());
                if let Some(place) = place {
                    photons[i].position = *place;
                }
                place.is_none()
            });
            attempt += width;
        }
    }

    /// For each stream a point of the box, if it is in the volume.
    fn find_points<E: Evaluator>(
        &self,
        evaluator: &E,
        scratch: &mut E::Scratch,
        streams: impl Iterator<Item = Stream>,
    ) -> Vec<Option<Vec3>> {
        let points: Vec<Vec3> = streams.map(|mut stream| self.point(&mut stream)).collect();
        let columns = [0, 1, 2].map(|axis| points.iter().map(|point| point[axis]).collect::<Vec<f64>>());
        let mut regions = vec![RegionId(0); points.len()];
        evaluator.regions_at(columns.each_ref().map(Vec::as_slice), scratch, &mut regions);
        let is_inside =
            |point: Vec3, region: RegionId| self.regions.contains(&region.0) && self.is_in_copies(point);
        points
            .into_iter()
            .zip(regions)
            .map(|(point, region)| is_inside(point, region).then_some(point))
            .collect()
    }

    /// For each stream one of `most` crossings of a line, if the line has it.
    fn find_ends<E: Evaluator>(
        &self,
        evaluator: &E,
        scratch: &mut E::Scratch,
        streams: impl Iterator<Item = Stream>,
        most: usize,
    ) -> Vec<Option<Vec3>> {
        let mut rays = RayBatch::default();
        let mut chosen = Vec::new();
        for mut stream in streams {
            rays.push(random_line(&self.bounds, &mut stream));
            chosen.push((stream.uniform() * most as f64) as usize);
        }
        let mut found = vec![None; chosen.len()];
        let lines = rays.rays();
        let mut sink = |answer: RayAnswer<'_>| {
            let line = lines.get(answer.ray);
            let end = self.ends(&answer, &line).nth(chosen[answer.ray]);
            found[answer.ray] = end.map(|t| line.at(t));
        };
        evaluator.crossings(lines, &Query::default(), scratch, &mut sink);
        found
    }
}

/// The error of an unknown name or path. `paths` are those of the volume that is meant.
fn unknown(detector: &Detector, text: &str, paths: &[String]) -> PhotonError {
    if !paths.is_empty() {
        let paths = paths.iter().map(String::as_str);
        return PhotonError::Setting(Message::unknown("copy of a volume", text, paths));
    }
    let names: BTreeSet<&str> = detector.region_names.iter().skip(1).map(String::as_str).collect();
    let message = Message::unknown("volume", text, names);
    let has_copies = detector.program.prototypes().len() > 1;
    PhotonError::Setting(match message.suggestion().map(str::to_owned) {
        _ if !has_copies => message,
        Some(meant) => message.suggest(format!("{meant} {OF_COPIES}")),
        None => message.suggest(OF_COPIES),
    })
}

/// The advice about copies.
const OF_COPIES: &str = "A path as in tables of hits, such as Module[1]/Crystal[3], selects copies.";

fn too_thin(name: &str, trials: &str) -> PhotonError {
    let problem = format!("the volume `{name}` cannot be a source");
    let reason = format!("it is so small a part of its box that random {trials} miss it");
    PhotonError::setting(problem, reason)
}
