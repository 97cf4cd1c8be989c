//! Refraction of eight neighbouring rays of a generation in SIMD lanes, after the evaluator has
//! computed their hits.

use super::attenuation::Attenuation;
use super::polished_face;
use crate::segments::{BundleRows, Event};
use crate::settings::Keep;
use crate::trace::{Generation, Hits, OpticalConstants, Propagator};
use rayweave_model::RegionId;
use rayweave_shape::lanes::LANES;

impl Propagator<'_> {
    /// Refracts rays `at..at + 8` of a generation if all of them cross the same polished face
    /// between uniform media; otherwise returns `None` and changes nothing.
    pub(crate) fn transmit_bundle(&mut self, now: &Generation, hits: &Hits, at: usize) -> Option<()> {
        let system = self.system;
        let (refractor, crossing) = (system.refractor.as_ref()?, hits.common_crossing(at)?);
        let (element, surface) = polished_face(system, &crossing)?;
        let (indices, media) = self.indices_of_bundle(now, at, [crossing.before, crossing.after])?;
        let payloads = &now.payloads;
        let (intensity, t) = (payloads.power[at..].first_chunk()?, hits.solids.t[at..].first_chunk()?);
        let attenuation = Attenuation::new(&media, intensity, t);
        let is_last =
            payloads.generation[at..at + LANES].iter().any(|k| k + 1 >= self.settings.generation_limit);
        if is_last || !attenuation.exceeds(self.settings.threshold) {
            return None;
        }
        let (face, [x, y, z]) = (system.faces[crossing.face], &hits.solids.normal);
        let (rays, crossings) = ((now.rays.rays(), at), (&hits.solids.t[..], [&x[..], y, z]));
        let transmitted = refractor.refract(rays, crossings, &payloads.path, face.surface, &indices)?;
        self.balance.absorbed_in_media += attenuation.absorbed;
        let (row, keeps) = (self.next_parent() + 1, self.settings.keep == Keep::All);
        if keeps {
            let rays = now.rays.rays();
            self.rows.single.extend_bundle(&BundleRows {
                id: eight(&payloads.id, at)?,
                parent: eight(&payloads.parent, at)?,
                generation: eight(&payloads.generation, at)?,
                source: payloads.source[at..].first_chunk()?,
                wavelength_nm: payloads.wavelength_nm[at..].first_chunk()?,
                intensity,
                index: indices[0],
                start: eight_vectors(rays.origins, at)?,
                end: transmitted.end,
                direction: eight_vectors(rays.directions, at)?,
                path: transmitted.path,
                element,
                surface,
                event: Event::Transmitted,
            });
        }
        let parent = keeps.then_some(row);
        self.next.append_transmitted(payloads, at, &attenuation.power, &transmitted, face, parent);
        Some(())
    }

    /// The refractive indices before and behind a face for each of eight rays, and the optical
    /// constants of the medium before it; `None` if the indices are equal.
    fn indices_of_bundle(
        &mut self,
        now: &Generation,
        at: usize,
        [before, after]: [RegionId; 2],
    ) -> Option<([[f64; LANES]; 2], [OpticalConstants; LANES])> {
        let system = self.system;
        let is_uniform = |region| system.substance(region).is_uniform();
        if !is_uniform(before) || !is_uniform(after) {
            return None;
        }
        let [before, after] = [before, after].map(|region| system.program.medium_of(region));
        let wavelengths = now.payloads.wavelength_nm.get(at..at + LANES)?;
        let (mut media, mut indices) = ([OpticalConstants::default(); LANES], [[0.0; LANES]; 2]);
        let mut last: Option<(f64, OpticalConstants, f64)> = None;
        for (lane, &wavelength) in wavelengths.iter().enumerate() {
            let (_, here, behind) = match last {
                Some(known @ (same, ..)) if same == wavelength => known,
                _ => {
                    let here = self.indices.get(system, before, wavelength);
                    let behind = self.indices.get(system, after, wavelength).index.re;
                    if here.index.re == behind {
                        return None;
                    }
                    (wavelength, here, behind)
                }
            };
            last = Some((wavelength, here, behind));
            (media[lane], indices[0][lane], indices[1][lane]) = (here, here.index.re, behind);
        }
        Some((indices, media))
    }
}

/// Entries `at..at + 8` of a column.
fn eight<T: Copy>(column: &[T], at: usize) -> Option<[T; LANES]> {
    column.get(at..)?.first_chunk().copied()
}

/// Entries `at..at + 8` of three columns.
fn eight_vectors([x, y, z]: [&[f64]; 3], at: usize) -> Option<[[f64; LANES]; 3]> {
    Some([eight(x, at)?, eight(y, at)?, eight(z, at)?])
}
