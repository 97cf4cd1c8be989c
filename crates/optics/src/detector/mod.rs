//! Detectors: light that arrives at the sheets of a system, as spot diagrams and irradiance, in bounded memory.

mod irradiance;
mod spot;

pub use irradiance::{IrradianceBins, IrradianceMap};
pub use spot::{SpotDiagram, SpotPoint};

use crate::paths::is_reflected;
use crate::segments::Event;
use crate::{Segments, System};
use rayweave_math::{Affine, Vec3};

/// The sheets of a system as detectors of light.
///
/// ```
/// use rayweave_optics::component::{Aperture, Sheet};
/// use rayweave_optics::detector::Detectors;
/// use rayweave_optics::{Action, Assembly, Beam, Element, Light, TraceSettings, Tracer};
/// use rayweave_trace::Packets;
///
/// let screen = Element::sheet("screen", Sheet::plane(Aperture::circle(20.0))?, Action::Absorb);
/// let system = Assembly::new().add(screen).compile()?;
/// let beam: Beam = (0..5).map(|k| Light::new([0.0, f64::from(k), -9.0], [0.0, 0.0, 1.0], 550.0)).collect();
/// let mut detectors = Detectors::new(&system, false);
/// detectors.add(&Tracer::new(&system, Packets::new).trace(&beam, &TraceSettings::default())?.segments);
/// let screen = &detectors.list()[0];
/// assert_eq!((screen.name.as_str(), screen.spots.count(), screen.spots.centroid()), ("screen", 5, [0.0, 2.0]));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Detectors {
    list: Vec<Detector>,
    /// The number of the detector of each element, `None` for solids.
    of_element: Vec<Option<usize>>,
    bins_irradiance: bool,
    /// The elements that light by source meets in this order; empty for all light.
    sequence: Vec<usize>,
    /// The only wavelength that counts.
    wavelength_nm: Option<f64>,
}

/// A sheet and the light that arrives at it. Points are in coordinates of the sheet: lengths along its x and y axes from its
/// centre.
#[derive(Clone, Debug)]
pub struct Detector {
    /// The number of the sheet among the elements of the system.
    pub element: usize,
    /// The name of the sheet.
    pub name: String,
    /// The points at which light arrives.
    pub spots: SpotDiagram,
    /// The points at which the light of each source arrives; empty unless requested by [`Detectors::by_source`].
    pub by_source: Vec<SpotDiagram>,
    /// The power that arrives; empty if irradiance is not binned.
    pub irradiance: IrradianceBins,
    /// The number and the power of rays that were partially reflected by solids, leave the system and cross the plane of the
    /// sheet beside it: ghosts that a wider sheet would catch.
    pub ghosts_beside: (u64, f64),
    middle: Vec3,
    /// Unit vectors.
    axes: [Vec3; 2],
}

impl Detectors {
    /// A detector without light for each sheet of a system. Irradiance takes some megabytes for each of them.
    pub fn new(system: &System, bins_irradiance: bool) -> Detectors {
        let mut detectors = Detectors {
            list: Vec::new(),
            of_element: Vec::new(),
            bins_irradiance,
            sequence: Vec::new(),
            wavelength_nm: None,
        };
        for (number, name) in system.element_names().iter().enumerate() {
            let frame = system.sheet_frame(name);
            detectors.of_element.push(frame.map(|_| detectors.list.len()));
            detectors.list.extend(frame.map(|frame| Detector::new(number, name, frame)));
        }
        detectors
    }

    /// Adds a spot diagram for each of the first `count` sources, for example the fields of a lens.
    #[must_use]
    pub fn by_source(mut self, count: usize) -> Detectors {
        for detector in &mut self.list {
            detector.by_source = vec![SpotDiagram::default(); count];
        }
        self
    }

    /// Restricts the diagrams by source to the light that meets elements in this order: at a sheet of the sequence, that
    /// which has met all elements before it, and them only; at other sheets, all light. Elements that transmit a ray
    /// undeviated do not count.
    #[must_use]
    pub fn in_sequence(mut self, sequence: &[usize]) -> Detectors {
        self.sequence = sequence.to_vec();
        self
    }

    /// Restricts all results to light of this wavelength in nanometres, exactly.
    #[must_use]
    pub fn of_wavelength(mut self, wavelength_nm: f64) -> Detectors {
        self.wavelength_nm = Some(wavelength_nm);
        self
    }

    /// Adds the light of all segments that end at a sheet; a table has all segments of its rays.
    pub fn add(&mut self, segments: &Segments) {
        self.add_ghosts(segments);
        let [x, y, z] = &segments.end;
        for (row, &element) in segments.element.iter().enumerate() {
            let element = usize::try_from(element).ok().and_then(|number| self.of_element.get(number));
            let Some(sheet) = element.copied().flatten() else { continue };
            if self.wavelength_nm.is_some_and(|wanted| wanted != segments.wavelength_nm[row]) {
                continue;
            }
            let (detector, power) = (&mut self.list[sheet], segments.intensity[row]);
            let point = detector.coordinates(Vec3::new(x[row], y[row], z[row]));
            detector.spots.add(point, segments.wavelength_nm[row], power);
            let place = self.sequence.iter().position(|&own| own == detector.element);
            let is_counted = place.is_none_or(|place| segments.followed(row, &self.sequence[..=place]));
            let of_source = detector.by_source.get_mut(segments.source[row] as usize);
            if let Some(spots) = of_source.filter(|_| is_counted) {
                spots.add(point, segments.wavelength_nm[row], power);
            }
            if self.bins_irradiance {
                detector.irradiance.add(point, power);
            }
        }
    }

    /// Counts escaping ghosts that pass beside the sheets.
    fn add_ghosts(&mut self, segments: &Segments) {
        if !segments.event.contains(&(Event::Split as u8)) {
            return;
        }
        let vector = |of: &[Vec<f64>; 3], row: usize| Vec3::new(of[0][row], of[1][row], of[2][row]);
        for row in (0..segments.len()).filter(|&row| segments.event[row] == Event::Escaped as u8) {
            if self.wavelength_nm.is_some_and(|wanted| wanted != segments.wavelength_nm[row])
                || !is_ghost(segments, row)
            {
                continue;
            }
            // light that a sheet transmits starts on it
            let from = parent(segments, row).map_or(-1, |parent| segments.element[parent]);
            let (start, direction) = (vector(&segments.start, row), vector(&segments.direction, row));
            for detector in self.list.iter_mut().filter(|own| own.element as i32 != from) {
                let normal = detector.axes[0].cross(detector.axes[1]);
                if normal.dot(detector.middle - start) / normal.dot(direction) > 0.0 {
                    detector.ghosts_beside.0 += 1;
                    detector.ghosts_beside.1 += segments.intensity[row];
                }
            }
        }
    }

    /// The detectors in the order of their elements.
    pub fn list(&self) -> &[Detector] {
        &self.list
    }
}

fn parent(segments: &Segments, row: usize) -> Option<usize> {
    usize::try_from(segments.parent[row]).ok().filter(|&parent| parent < row)
}

/// True if a ray was reflected where light splits, at least once.
fn is_ghost(segments: &Segments, row: usize) -> bool {
    let mut at = row;
    while let Some(before) = parent(segments, at) {
        if segments.event[before] == Event::Split as u8 && is_reflected(segments, before, at) {
            return true;
        }
        at = before;
    }
    false
}

impl Detector {
    fn new(element: usize, name: &str, frame: &Affine) -> Detector {
        let axis = |axis: Vec3| (frame.linear * axis).normalize_or_zero();
        Detector {
            element,
            name: name.to_owned(),
            spots: SpotDiagram::default(),
            by_source: Vec::new(),
            irradiance: IrradianceBins::default(),
            ghosts_beside: (0, 0.0),
            middle: frame.translation,
            axes: [axis(Vec3::X), axis(Vec3::Y)],
        }
    }

    fn coordinates(&self, point: Vec3) -> [f64; 2] {
        self.axes.map(|axis| axis.dot(point - self.middle))
    }
}
