//! Eight rays of a generation to which the same simple thing happens.

use super::Worker;
use super::flight::polished;
use crate::generation::{Generation, Met};
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
        let indices = self.indices_of_eight(now, at, [step.before, step.after])?;
        let packets = &now.packets;
        let (limit, threshold) = (self.settings.generation_limit, self.settings.threshold);
        for i in at..at + LANES {
            let (generation, power) = (packets.generation[i], packets.power[i]);
            if generation + 1 >= limit || power < threshold || power <= 0.0 {
                return None;
            }
        }
        let (face, [x, y, z]) = (system.faces[step.face], &met.normal);
        let (rays, crossings) = ((now.rays.rays(), at), (&met.t[..], [&x[..], y, z]));
        let gone = abreast.refract(rays, crossings, &packets.path, face.surface, &indices)?;
        let (row, keeps) = (self.parent_of_next() + 1, self.settings.keep == Keep::All);
        if keeps {
            let rays = now.rays.rays();
            self.rows.single.extend(&EightRows {
                id: eight(&packets.id, at)?,
                parent: eight(&packets.parent, at)?,
                generation: eight(&packets.generation, at)?,
                source: packets.source[at..].first_chunk()?,
                wavelength_nm: packets.wavelength_nm[at..].first_chunk()?,
                intensity: packets.power[at..].first_chunk()?,
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
        self.next.follow(packets, at, &gone, face, keeps.then_some(row));
        Some(())
    }

    /// The indices on the two sides of a face for each of eight rays; `None` if they are equal, or anything is absorbed.
    fn indices_of_eight(
        &mut self,
        now: &Generation,
        at: usize,
        [before, after]: [RegionId; 2],
    ) -> Option<[[f64; LANES]; 2]> {
        let system = self.tracer.system;
        let is_clear = |region| system.substance(region).is_uniform();
        if !is_clear(before) || !is_clear(after) {
            return None;
        }
        let [before, after] = [before, after].map(|region| system.program.medium_of(region));
        let wavelengths = now.packets.wavelength_nm.get(at..at + LANES)?;
        let mut indices = [[0.0; LANES]; 2];
        let mut last: Option<(f64, f64, f64)> = None;
        for (lane, &wavelength) in wavelengths.iter().enumerate() {
            let (_, here, behind) = match last {
                Some(known @ (same, ..)) if same == wavelength => known,
                _ => {
                    let (here, behind) = (
                        self.indices.of(system, before, wavelength),
                        self.indices.of(system, after, wavelength),
                    );
                    if here.absorption != 0.0 || here.index.re == behind.index.re {
                        return None;
                    }
                    (wavelength, here.index.re, behind.index.re)
                }
            };
            last = Some((wavelength, here, behind));
            (indices[0][lane], indices[1][lane]) = (here, behind);
        }
        Some(indices)
    }
}

/// Entries `at..at + 8` of a column.
fn eight<T: Copy>(column: &[T], at: usize) -> Option<[T; LANES]> {
    column.get(at..)?.first_chunk().copied()
}

fn eights([x, y, z]: [&[f64]; 3], at: usize) -> Option<[[f64; LANES]; 3]> {
    Some([eight(x, at)?, eight(y, at)?, eight(z, at)?])
}
