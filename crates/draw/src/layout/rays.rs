//! The choice of the rays that are drawn.

use rayweave_analysis::section::Cut;
use rayweave_math::Vec3;
use rayweave_model::Evaluator;
use rayweave_optics::{Beam, Branches, Emitter, Light, OpticsError, Segments, TraceSettings, Tracer};

/// The maximum number of trial rays, for all sources together.
const MAX_TRIALS: usize = 4096;

/// Rays from all parts of the sources, with their segments where nothing splits them.
pub struct TrialRays {
    rays: Beam,
    pub segments: Segments,
    /// The number of sources.
    pub sources: usize,
    /// False for rays that are not to be drawn.
    is_wanted: Vec<bool>,
}

impl TrialRays {
    pub fn new<E: Evaluator>(
        tracer: &Tracer<'_, E>,
        light: &impl Emitter,
        settings: &TraceSettings,
    ) -> Result<TrialRays, OpticsError> {
        let mut rays = Beam::default();
        let count = light.count();
        let parts = count.min(MAX_TRIALS);
        for part in 0..parts {
            let [from, to] = [part, part + 1].map(|k| (k as u128 * count as u128 / parts as u128) as usize);
            // at random intervals: evenly spaced rays would lie on a few arms of a spiral
            let ray = from + split_mix(part as u64) as usize % (to - from).max(1);
            light.emit(ray..ray + 1, &mut rays);
        }
        let settings = TraceSettings { branches: Branches::Ideal, ..settings.clone() };
        let segments = tracer.trace(&rays, &settings)?.segments;
        let sources = rays.sources().iter().max().map_or(0, |&last| last as usize + 1);
        let is_wanted = vec![true; rays.len()];
        Ok(TrialRays { rays, segments, sources, is_wanted })
    }

    /// Leaves out the rays that do not reach the last of these elements in their order, unless none does.
    pub fn in_order(mut self, sequence: &[usize]) -> TrialRays {
        let Some(&last) = sequence.last() else { return self };
        let mut arrives = vec![false; self.rays.len()];
        for (row, segment) in self.segments.iter().enumerate() {
            if segment.element == last as i32 && self.segments.followed(row, sequence) {
                arrives[segment.id as usize] = true;
            }
        }
        if arrives.contains(&true) {
            self.is_wanted = arrives;
        }
        self
    }

    /// About `count` rays near a plane, evenly spread, the same number from each source.
    pub fn nearest_to(&self, cut: &Cut, count: usize) -> Beam {
        let keys = self.keys(cut);
        let each = count.div_ceil(self.sources.max(1));
        let mut chosen: Vec<usize> = Vec::new();
        for source in 0..self.sources as u32 {
            let mut own: Vec<&Key> = keys
                .iter()
                .filter(|key| self.rays.sources()[key.ray] == source && self.is_wanted[key.ray])
                .collect();
            chosen.extend(spread(&mut own, each));
        }
        chosen.sort_unstable();
        let lights = chosen.into_iter().map(|ray| self.rays.get(ray));
        lights.filter(|light: &Light| light.power > 0.0).collect()
    }

    fn keys(&self, cut: &Cut) -> Vec<Key> {
        let mut keys: Vec<Key> = (0..self.rays.len()).map(|ray| Key { ray, off: 0.0, along: 0.0 }).collect();
        let origin = cut.point([0.0; 2]);
        let off = |point: Vec3| if point.is_finite() { cut.normal().dot(point - origin).abs() } else { 0.0 };
        for segment in self.segments.iter() {
            let key = &mut keys[segment.id as usize];
            key.off = key.off.max(off(segment.start)).max(off(segment.end));
            if segment.parent < 0 {
                let ends = [
                    segment.start,
                    if segment.end.is_finite() { segment.end } else { segment.start + segment.direction },
                ];
                key.along = ends.map(|end| cut.place(end)[1]).iter().sum();
            }
        }
        keys
    }
}

/// The position of a ray relative to a plane.
struct Key {
    ray: usize,
    /// The largest distance from the plane.
    off: f64,
    /// The height of the ray in the drawing, for sorting.
    along: f64,
}

/// The lowest and the highest of the rays nearest to the plane, and rays evenly spaced between them.
fn spread(keys: &mut Vec<&Key>, count: usize) -> Vec<usize> {
    if keys.is_empty() {
        return Vec::new();
    }
    keys.sort_by(|a, b| a.off.total_cmp(&b.off));
    let last = keys[(6 * count).min(keys.len()) - 1].off;
    // all rays as near as the last one are kept, so that a flat fan stays complete
    keys.retain(|key| key.off <= last * (1.0 + 1e-9));
    keys.sort_by(|a, b| a.along.total_cmp(&b.along));
    let count = count.min(keys.len());
    let index = |k: usize| k * (keys.len() - 1) / (count - 1).max(1);
    (0..count).map(|k| keys[index(k)].ray).collect()
}

/// A pseudorandom number (SplitMix64: G. L. Steele, D. Lea and C. H. Flood, OOPSLA 2014).
fn split_mix(k: u64) -> u64 {
    let z = k.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z ^ (z >> 31)) >> 1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chosen(keys: &[Key], count: usize) -> Vec<usize> {
        spread(&mut keys.iter().collect(), count)
    }

    /// Of a line of light wider than a ball lens, the rays that miss the lens are left out, unless all do.
    #[test]
    fn rays_that_miss_a_lens_are_left_out() {
        let text = r#"
            rayweave = 1
            [solid.ball]
            sphere = { radius = 10 }
            [optics.medium]
            ball = 1.5
            [[optics.source]]
            line = { length = 60, rays = 61 }
            transform = [{ translate = [0, 0, -30] }]
        "#;
        let (document, scene) = rayweave_scene::parse(text).unwrap();
        let optics = rayweave_optics::file::optics_of(&document, &scene).unwrap();
        let system = optics.assembly.compile().unwrap();
        let tracer = Tracer::new(&system, rayweave_trace::Packets::new);
        let cut = crate::layout::plane::nearest_to_light(
            &TrialRays::new(&tracer, &optics.sources, &optics.settings).unwrap().segments,
        );
        let cut = cut.cut().unwrap();
        let heights = |sequence: &[usize]| -> Vec<f64> {
            let trial = TrialRays::new(&tracer, &optics.sources, &optics.settings).unwrap();
            let beam = trial.in_order(sequence).nearest_to(&cut, 1000);
            let height = |k| {
                let origin = beam.get(k).ray.origin;
                libm::hypot(origin.x, origin.y)
            };
            (0..beam.len()).map(height).collect()
        };
        // into the ball and out of it
        let inside = heights(&[0, 0]);
        assert!(inside.len() == 19 && inside.iter().all(|height| *height < 10.0), "{inside:?}");
        assert_eq!((heights(&[]).len(), heights(&[0, 0, 0]).len()), (61, 61));
    }

    /// A flat fan gives its ends and its middle; a disc gives only points near the plane.
    #[test]
    fn rays_near_the_plane_evenly() {
        let fan: Vec<Key> = (0..101).map(|ray| Key { ray, off: 0.0, along: ray as f64 }).collect();
        assert_eq!(chosen(&fan, 3), [0, 50, 100]);
        assert_eq!(chosen(&fan, 1), [0]);
        assert_eq!(chosen(&fan[..2], 9), [0, 1]);
        assert!(chosen(&[], 3).is_empty());
        let disc = |ray: usize| {
            let (r, angle) = ((ray as f64 / 2000.0).sqrt(), 2.4 * ray as f64);
            Key { ray, off: (r * angle.cos()).abs(), along: r * angle.sin() }
        };
        let disc: Vec<Key> = (0..2000).map(disc).collect();
        let some = chosen(&disc, 11);
        assert!(some.iter().all(|&ray| disc[ray].off < 0.1));
        let along: Vec<f64> = some.iter().map(|&ray| disc[ray].along).collect();
        assert!(along.windows(2).all(|pair| pair[0] < pair[1] && pair[1] - pair[0] < 0.4), "{along:?}");
        assert!(along[0] < -0.8 && along[10] > 0.8);
    }
}
