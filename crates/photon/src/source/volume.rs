//! Points in a volume and on its boundary, by rejection.

use crate::detector::Detector;
use crate::error::PhotonError;
use crate::lines::random_line;
use crate::philox::{Purpose, Stream};
use crate::photon::{EventKey, Photon};
use rayweave_error::Message;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, Query, RayAnswer, RayBatch, RegionId};
use std::collections::BTreeSet;

/// The inside of a volume, without its daughters, or the boundary of it; all copies of the volume together.
#[derive(Clone, Debug)]
pub struct SourceVolume {
    regions: BTreeSet<u32>,
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
    /// The inside of a volume with a name.
    ///
    /// # Errors
    ///
    /// [`PhotonError::Setting`] for an unknown name, an unbounded volume, and one that fills less than about 1e-5 of its box.
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
        if !regions.iter().any(|region| volume.regions.contains(&region.0)) {
            return Err(too_thin(name, "points"));
        }
        Ok(volume)
    }

    /// The boundary of a volume with a name, towards its mother and its daughters. Photons start 1 nm inside.
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
        let mut sink = |answer: RayAnswer<'_>| most = most.max(volume.ends(&answer).count());
        evaluator.crossings(rays.rays(), &Query::default(), &mut evaluator.scratch(), &mut sink);
        if most == 0 {
            return Err(too_thin(name, "lines"));
        }
        Ok(SourceVolume { crossings: Some(2 * most), ..volume })
    }

    fn named(detector: &Detector, name: &str) -> Result<SourceVolume, PhotonError> {
        let numbers = detector.region_names.iter().zip(0..).skip(1);
        let regions: BTreeSet<u32> = numbers.filter(|(own, _)| *own == name).map(|(_, k)| k).collect();
        if regions.is_empty() {
            let names = detector.region_names.iter().skip(1).map(String::as_str);
            return Err(PhotonError::Setting(Message::unknown("volume", name, names)));
        }
        let boxes = detector.program.region_bounds();
        let bounds = regions.iter().map(|&k| boxes[k as usize - 1]).fold(Bounds::EMPTY, |a, b| a.union(&b));
        if !bounds.is_finite() {
            let problem = format!("the volume `{name}` is unbounded");
            return Err(PhotonError::setting(problem, "photons are emitted with equal density"));
        }
        Ok(SourceVolume { regions, bounds, crossings: None })
    }

    /// A point of the box.
    fn point(&self, stream: &mut Stream) -> Vec3 {
        let [x, y, z] = [(); 3].map(|()| stream.uniform());
        self.bounds.lo + self.bounds.size() * Vec3::new(x, y, z)
    }

    /// The times at which a line enters or leaves the volume, just inside.
    fn ends<'a>(&'a self, answer: &RayAnswer<'a>) -> impl Iterator<Item = f64> + 'a {
        answer.crossings.iter().filter_map(|crossing| {
            let [before, after] =
                [crossing.before, crossing.after].map(|region| self.regions.contains(&region.0));
            (before != after).then_some(if after { crossing.t + DEPTH } else { crossing.t - DEPTH })
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
        let is_inside = |region: &RegionId| self.regions.contains(&region.0);
        points.into_iter().zip(&regions).map(|(point, region)| is_inside(region).then_some(point)).collect()
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
            let end = self.ends(&answer).nth(chosen[answer.ray]);
            found[answer.ray] = end.map(|t| lines.get(answer.ray).at(t));
        };
        evaluator.crossings(lines, &Query::default(), scratch, &mut sink);
        found
    }
}

fn too_thin(name: &str, trials: &str) -> PhotonError {
    let problem = format!("the volume `{name}` cannot be a source");
    let reason = format!("it is so small a part of its box that random {trials} miss it");
    PhotonError::setting(problem, reason)
}
