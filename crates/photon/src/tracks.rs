//! Tracks of photons as segments of light, for drawings.

use crate::flight::End;
use crate::history::{Histories, Process, StepRow};
use rayweave_math::Vec3;
use rayweave_optics::{Event, Segment, Segments};

impl Histories {
    /// The recorded steps as segments: one for each step of a length, in the order of the rows. The photon of each track has the
    /// number `id`; a segment of light that leaves the world has no end, and the others have the event of their process.
    #[must_use]
    pub fn to_segments(&self) -> Segments {
        let mut segments = Segments::default();
        for (id, track) in (0..).zip(self.steps.chunk_by(|a, b| a.track == b.track)) {
            let (mut parent, mut path) = (-1, 0.0);
            for (pair, generation) in track.windows(2).zip(0..) {
                let [from, to] = [&pair[0], &pair[1]];
                let escapes = to.process == Process::End(End::Escaped);
                path += (to.position - from.position).length();
                let row = segments.len() as i64;
                segments.push(Segment {
                    id,
                    parent,
                    generation,
                    source: 0,
                    wavelength_nm: from.wavelength_nm,
                    intensity: 1.0,
                    index: 1.0,
                    start: from.position,
                    end: if escapes { Vec3::NAN } else { to.position },
                    direction: from.direction,
                    path,
                    element: -1,
                    surface: -1,
                    event: event(to.process),
                });
                parent = row;
            }
        }
        segments
    }

    /// The rows of detected photons.
    pub fn detections(&self) -> impl Iterator<Item = &StepRow> {
        self.steps.iter().filter(|row| row.process == Process::End(End::Detected))
    }
}

fn event(process: Process) -> Event {
    match process {
        Process::End(End::Escaped) => Event::Escaped,
        Process::End(_) => Event::Absorbed,
        Process::TotalInternalReflection => Event::TotallyReflected,
        Process::FresnelReflection | Process::SpikeReflection => Event::Reflected,
        Process::FresnelRefraction | Process::Transmission | Process::SameMaterial => Event::Transmitted,
        _ => Event::Scattered,
    }
}
