//! Rays through the cells of a cross-section, two each, from random streams, and their integrals.

use super::chord::MeasuredChord;
use super::moments::along;
use super::tally::{RayContribution, Tally};
use rand::rngs::ChaCha8Rng;
use rand::{Rng, SeedableRng};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, Program, Query, RayAnswer, RayBatch, RegionId, Window, attributes};
use rayweave_shape::Ray;
use std::collections::BTreeMap;

/// Random stream of measurements, distinct from other streams of the same seed.
const STREAM: u64 = u64::from_be_bytes(*b"measure\0");

/// Rays parallel to one axis through a box, in `across` x `across` cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cells {
    pub bounds: Bounds,
    pub axis: usize,
    pub across: u64,
    pub seed: u64,
    /// The number of the random stream, unique among runs with one seed.
    pub stream: u64,
    /// Restricts the integrals to this box.
    pub within: Option<Bounds>,
}

/// The sums over a range of cells of area 1, by region.
pub(super) type Sums = BTreeMap<RegionId, Tally>;

impl Cells {
    /// The number of cells.
    pub fn count(&self) -> u64 {
        self.across * self.across
    }

    /// The area of a cell.
    pub fn area(&self) -> f64 {
        let size = self.bounds.size();
        size[(self.axis + 1) % 3] / self.across as f64 * (size[(self.axis + 2) % 3] / self.across as f64)
    }

    /// The rays of a range of cells, two per cell.
    pub fn rays(&self, cells: std::ops::Range<u64>, batch: &mut RayBatch) {
        batch.clear();
        let mut generator = ChaCha8Rng::seed_from_u64(self.seed);
        generator.set_stream(STREAM ^ self.stream);
        // four 64-bit numbers, of two words each, per cell
        generator.set_word_pos(u128::from(cells.start) * 8);
        for cell in cells {
            for _ in 0..2 {
                let places = [(cell % self.across) as f64, (cell / self.across) as f64];
                let places = places.map(|place| (place + uniform(generator.next_u64())) / self.across as f64);
                batch.push(self.ray(places));
            }
        }
    }

    /// The ray at a position in the cross-section, given as fractions of its edges.
    fn ray(&self, places: [f64; 2]) -> Ray {
        let (mut origin, size) = (self.bounds.lo, self.bounds.size());
        for (k, place) in places.into_iter().enumerate() {
            origin[(self.axis + 1 + k) % 3] += size[(self.axis + 1 + k) % 3] * place;
        }
        Ray::new(origin, Vec3::AXES[self.axis])
    }

    /// The interval of the rays inside `within`.
    fn window(&self) -> Window {
        let within = self.within.map(|within| {
            let [lo, hi] = [within.lo, within.hi].map(|corner| corner[self.axis] - self.bounds.lo[self.axis]);
            Window::new(lo, hi)
        });
        // a box thinner than the spacing of f64 values at its position has no volume
        within.and_then(Result::ok).unwrap_or_default()
    }

    /// Traces the rays of a range of cells; returns also the number of crossings.
    pub(super) fn trace<E: Evaluator>(
        &self,
        evaluator: &E,
        rays: &RayBatch,
        scratch: &mut E::Scratch,
    ) -> (Sums, u64) {
        let mut sums = Sums::new();
        let add = |region, [a, b]: [RayContribution; 2]| sums.entry(region).or_default().cell(&a, &b);
        let crossings = self.each(evaluator, rays, scratch, add);
        (sums, crossings)
    }

    /// Traces the rays of a range of cells; `take` receives the contributions of the two rays of each cell to each region that they
    /// cross, cell by cell. Returns the number of crossings.
    pub(super) fn each<E: Evaluator>(
        &self,
        evaluator: &E,
        rays: &RayBatch,
        scratch: &mut E::Scratch,
        take: impl FnMut(RegionId, [RayContribution; 2]),
    ) -> u64 {
        let window = self.window();
        let mut taken = Taken::new(self, evaluator.program(), window, take);
        let (rays, mut crossings) = (rays.rays(), 0);
        let mut sink = |answer: RayAnswer<'_>| {
            crossings += answer.crossings.len() as u64;
            taken.ray(&rays.get(answer.ray), &answer);
        };
        evaluator.crossings(rays, &Query { window, ..Query::default() }, scratch, &mut sink);
        crossings
    }
}

/// The upper 53 bits as a fraction in [0, 1).
fn uniform(bits: u64) -> f64 {
    (bits >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
}

/// Accumulates the answers of two rays per cell.
struct Taken<'a, F> {
    cells: &'a Cells,
    program: &'a Program,
    centre: Vec3,
    window: Window,
    /// The results of the rays of the current cell so far, in the order of the crossings.
    here: Vec<(RegionId, [RayContribution; 2])>,
    /// The index of each region in `here`; meaningless for a region that is not in it.
    place: Vec<usize>,
    take: F,
}

impl<'a, F: FnMut(RegionId, [RayContribution; 2])> Taken<'a, F> {
    fn new(cells: &'a Cells, program: &'a Program, window: Window, take: F) -> Self {
        let centre = cells.bounds.centre();
        let place = vec![0; program.regions().len() + 1];
        Taken { cells, program, centre, window, here: Vec::new(), place, take }
    }

    fn ray(&mut self, ray: &Ray, answer: &RayAnswer<'_>) {
        let which = answer.ray % 2;
        let (mut region, mut from) = (answer.start, self.window.t_min());
        for crossing in answer.crossings {
            self.piece(ray, which, region, [from, crossing.t]);
            let weight = attributes::normal(self.program, ray, crossing)[self.cells.axis].abs();
            for region in [crossing.before, crossing.after] {
                if region != RegionId(0) {
                    self.found(region, which).area += weight;
                }
            }
            (region, from) = (crossing.after, crossing.t);
        }
        self.piece(ray, which, region, [from, self.window.t_max()]);
        if which == 1 {
            for (region, both) in self.here.drain(..) {
                (self.take)(region, both);
            }
        }
    }

    fn piece(&mut self, ray: &Ray, which: usize, region: RegionId, [from, to]: [f64; 2]) {
        if region == RegionId(0) {
            return;
        }
        let (axis, at) = (self.cells.axis, ray.origin - self.centre);
        let moments = along(axis, at, at[axis] + from, at[axis] + to);
        let chord = MeasuredChord { from: ray.at(from), to: ray.at(to) };
        let found = self.found(region, which);
        found.longest = found.longest.or_longer(chord);
        super::moments::add(&mut found.moments, &moments, 1.0);
    }

    fn found(&mut self, region: RegionId, which: usize) -> &mut RayContribution {
        let place = &mut self.place[region.index()];
        if self.here.get(*place).is_none_or(|(own, _)| *own != region) {
            *place = self.here.len();
            self.here.push((region, Default::default()));
        }
        &mut self.here[*place].1[which]
    }
}
