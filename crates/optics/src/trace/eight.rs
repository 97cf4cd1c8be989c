//! Eight rays of a generation to which the same simple thing happens.

use super::Worker;
use super::flight::polished;
use crate::generation::{Generation, Met};
use crate::indices::Optics;
use crate::segments::{EightRows, Event};
use crate::settings::Keep;
use rayweave_model::{Evaluator, RegionId};
use rayweave_shape::lanes::LANES;

impl<E: Evaluator> Worker<'_, E> {
    /// [`Worker::transmit`] for eight rays that all meet the same face; `None`, with nothing done, if that is not what
    /// happens.
    pub(super) fn transmit_eight(&mut self, now: &Generation, met: &Met, at: usize) -> Option<()> {
        let system = self.tracer.system;
        let (abreast, step) = (system.abreast.as_ref()?, met.common(at)?);
        let (element, surface) = polished(system, &step)?;
        let (indices, here) = self.indices_of_eight(now, at, [step.before, step.after])?;
        let packets = &now.packets;
        let (intensity, t) = (packets.power[at..].first_chunk()?, met.t[at..].first_chunk()?);
        let spent = Spent::new(&here, intensity, t);
        let is_last =
            packets.generation[at..at + LANES].iter().any(|k| k + 1 >= self.settings.generation_limit);
        if is_last || !spent.is_followed(self.settings.threshold) {
            return None;
        }
        let (face, [x, y, z]) = (system.faces[step.face], &met.normal);
        let (rays, crossings) = ((now.rays.rays(), at), (&met.t[..], [&x[..], y, z]));
        let gone = abreast.refract(rays, crossings, &packets.path, face.surface, &indices)?;
        self.balance.absorbed_in_media += spent.lost;
        let (row, keeps) = (self.parent_of_next() + 1, self.settings.keep == Keep::All);
        if keeps {
            let rays = now.rays.rays();
            self.rows.single.extend(&EightRows {
                id: eight(&packets.id, at)?,
                parent: eight(&packets.parent, at)?,
                generation: eight(&packets.generation, at)?,
                source: packets.source[at..].first_chunk()?,
                wavelength_nm: packets.wavelength_nm[at..].first_chunk()?,
                intensity,
                index: indices[0],
                start: eights(rays.origins, at)?,
                end: gone.end,
                direction: eights(rays.directions, at)?,
                path: gone.path,
                element,
                surface,
                event: Event::Transmitted,
            });
        }
        self.next.follow(packets, at, &spent.left, &gone, face, keeps.then_some(row));
        Some(())
    }

    /// The indices on the two sides of a face for each of eight rays, and what they see of the medium that they come through;
    /// `None` if the indices are equal.
    fn indices_of_eight(
        &mut self,
        now: &Generation,
        at: usize,
        [before, after]: [RegionId; 2],
    ) -> Option<([[f64; LANES]; 2], [Optics; LANES])> {
        let system = self.tracer.system;
        let is_uniform = |region| system.substance(region).is_uniform();
        if !is_uniform(before) || !is_uniform(after) {
            return None;
        }
        let [before, after] = [before, after].map(|region| system.program.medium_of(region));
        let wavelengths = now.packets.wavelength_nm.get(at..at + LANES)?;
        let (mut found, mut indices) = ([Optics::default(); LANES], [[0.0; LANES]; 2]);
        let mut last: Option<(f64, Optics, f64)> = None;
        for (lane, &wavelength) in wavelengths.iter().enumerate() {
            let (_, here, behind) = match last {
                Some(known @ (same, ..)) if same == wavelength => known,
                _ => {
                    let here = self.indices.of(system, before, wavelength);
                    let behind = self.indices.of(system, after, wavelength).index.re;
                    if here.index.re == behind {
                        return None;
                    }
                    (wavelength, here, behind)
                }
            };
            last = Some((wavelength, here, behind));
            (found[lane], indices[0][lane], indices[1][lane]) = (here, here.index.re, behind);
        }
        Some((indices, found))
    }
}

/// What lengths of media take of the power of eight rays.
pub(super) struct Spent {
    /// In all.
    pub lost: f64,
    pub left: [f64; LANES],
}

impl Spent {
    pub fn new(media: &[Optics; LANES], power: &[f64; LANES], length: &[f64; LANES]) -> Spent {
        let mut spent = Spent { lost: 0.0, left: *power };
        for (lane, left) in spent.left.iter_mut().enumerate() {
            let lost = media[lane].lost(*left, length[lane]);
            (spent.lost, *left) = (spent.lost + lost, *left - lost);
        }
        spent
    }

    /// Whether all rays are followed on.
    pub fn is_followed(&self, threshold: f64) -> bool {
        self.left.iter().all(|&power| power >= threshold && power > 0.0)
    }
}

/// Entries `at..at + 8` of a column.
fn eight<T: Copy>(column: &[T], at: usize) -> Option<[T; LANES]> {
    column.get(at..)?.first_chunk().copied()
}

fn eights([x, y, z]: [&[f64]; 3], at: usize) -> Option<[[f64; LANES]; 3]> {
    Some([eight(x, at)?, eight(y, at)?, eight(z, at)?])
}
