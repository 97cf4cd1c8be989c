//! Drawings of optical systems: a true section of the solids by a plane, and the rays that run near it.
//!
//! ```
//! use rayweave::layout::{Layout, Wishes};
//! use rayweave::optics::file::optics_of;
//! use rayweave::scene;
//!
//! let (document, scene) = scene::parse(r#"
//!     rayweave = 1
//!     [solid.ball]
//!     sphere = { radius = 10 }
//!     [optics.medium]
//!     ball = 1.5
//!     [[optics.source]]
//!     line = { length = 12, rays = 7 }
//!     transform = [{ translate = [0, 0, -30] }]
//! "#)?;
//! let optics = optics_of(&document, &scene)?;
//! let system = optics.assembly.compile()?;
//! let layout = Layout::new(&system, &optics.sources, &optics.settings, &Wishes::default())?;
//! assert!(layout.to_svg("a ball lens", scene.unit.symbol()).starts_with("<svg "));
//! # Ok::<(), rayweave::Error>(())
//! ```

mod draw;
mod rays;
mod view;

pub use view::ViewPlane;

use crate::{Error, Packets};
use rayweave_analysis::section::{Cut, Look, Section, section};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Program, RegionId};
use rayweave_optics::{Emitter, Segments, Settings, System};
use std::sync::Arc;

/// By what rays are coloured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RayColour {
    /// As eyes see their wavelength; what is not visible is grey.
    #[default]
    Wavelength,
    /// A colour for each source.
    Source,
}

/// How a system is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wishes {
    /// The plane of the section; that which holds most of the light if not given.
    pub plane: Option<ViewPlane>,
    /// About how many rays of all sources together are drawn: those nearest to the plane, evenly spread.
    pub rays: usize,
    /// Their colours.
    pub colour: RayColour,
}

impl Default for Wishes {
    fn default() -> Wishes {
        Wishes { plane: None, rays: 27, colour: RayColour::Wavelength }
    }
}

/// A system cut open, and light in it.
#[derive(Clone, Debug)]
pub struct Layout {
    plane: ViewPlane,
    cut: Cut,
    /// The corners of the picture in the plane.
    lo: [f64; 2],
    hi: [f64; 2],
    parts: Vec<Part>,
    sheets: Vec<Vec<[f64; 2]>>,
    segments: Segments,
    colour: RayColour,
    sources: usize,
}

/// A region in the section.
#[derive(Clone, Debug)]
struct Part {
    name: String,
    /// `None` where no light goes.
    medium: Option<String>,
    contours: Vec<Vec<[f64; 2]>>,
}

/// Below this part of its power at the source light is not drawn.
const FAINTEST: f64 = 1e-4;

impl Layout {
    /// Cuts a system and traces some of its light. The rays are chosen among those that come from all parts of every
    /// source.
    ///
    /// # Errors
    /// [`crate::ErrorKind::Optics`] for light that cannot be traced, [`crate::ErrorKind::Cancelled`],
    /// [`crate::ErrorKind::Value`] for a plane or a system without size.
    pub fn new(
        system: &System,
        light: &impl Emitter,
        settings: &Settings,
        wishes: &Wishes,
    ) -> Result<Layout, Error> {
        let tried = rays::Tried::new(system, light, settings)?;
        let plane = wishes.plane.unwrap_or_else(|| view::best(&tried.segments));
        let cut = plane.cut()?;
        let chosen = tried.near(&cut, wishes.rays.max(1));
        let faintest = FAINTEST * chosen.powers().iter().fold(0.0, |most: f64, &power| most.max(power));
        let settings = Settings { threshold: settings.threshold.max(faintest), ..settings.clone() };
        let segments = rays::traced(system, &chosen, &settings)?;
        let (lo, hi) = window(system, &cut, &segments);
        let mut layout = Layout {
            plane,
            cut,
            lo,
            hi,
            parts: Vec::new(),
            sheets: Vec::new(),
            segments,
            colour: wishes.colour,
            sources: tried.sources,
        };
        layout.cut_solids(system)?;
        layout.cut_sheets(system)?;
        Ok(layout)
    }

    /// The drawing; lengths are in a unit.
    pub fn to_svg(&self, title: &str, unit: &str) -> String {
        draw::drawing(self, title, unit)
    }

    /// The plane of the section.
    pub fn plane(&self) -> ViewPlane {
        self.plane
    }

    fn cut_solids(&mut self, system: &System) -> Result<(), Error> {
        let program = system.program();
        let found = self.section(program, self.lo, self.hi)?;
        for (number, region) in (1..).zip(program.regions()) {
            let number = RegionId(number);
            let medium = system.medium_of(number).map(|medium| medium.name().to_owned());
            let contours = found.contours(number);
            self.parts.push(Part { name: region.name.clone(), medium, contours });
        }
        Ok(())
    }

    /// The lines in which sheets meet the plane; each is looked at in a window of its own size.
    fn cut_sheets(&mut self, system: &System) -> Result<(), Error> {
        for name in system.element_names() {
            let Some(program) = system.sheet_program(name) else { continue };
            let ranges = [0, 1].map(|k| self.cut.range(&program.bounds(), k));
            let lo = [0, 1].map(|k| ranges[k][0].max(self.lo[k]));
            let hi = [0, 1].map(|k| ranges[k][1].min(self.hi[k]));
            let room = 1e-3 * (hi[0] - lo[0]).max(hi[1] - lo[1]);
            if lo[0] < hi[0] && lo[1] < hi[1] {
                let found = self.section(program, lo.map(|x| x - room), hi.map(|x| x + room))?;
                self.sheets.extend(found.between(RegionId(1), RegionId(2)));
            }
        }
        Ok(())
    }

    fn section(&self, program: &Arc<Program>, lo: [f64; 2], hi: [f64; 2]) -> Result<Section, Error> {
        let whole = (self.hi[0] - self.lo[0]).max(self.hi[1] - self.lo[1]);
        let look = Look { tolerance: 2e-5 * whole, ..Look::new(lo, hi) };
        section(&Packets::new(program.clone()), &self.cut, &look).map_err(Error::from)
    }
}

/// The corners of a picture that shows all elements, and light on its way to and from them.
fn window(system: &System, cut: &Cut, segments: &Segments) -> ([f64; 2], [f64; 2]) {
    let mut ranges = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    let mut grow = |range: [f64; 2], k: usize, within: [f64; 2]| {
        let [lo, hi] = range.map(|end: f64| end.clamp(within[0], within[1]));
        if range[0].is_finite() && range[1].is_finite() {
            ranges[k] = [ranges[k][0].min(lo), ranges[k][1].max(hi)];
        }
    };
    let all = [f64::NEG_INFINITY, f64::INFINITY];
    for bounds in boxes(system) {
        (0..2).for_each(|k| grow(cut.range(&bounds, k), k, all));
    }
    let of_light = light_range(cut, segments);
    // light may come from far away, of which as much is shown as there are elements
    let reach = [0, 1].map(|k| {
        let [lo, hi] = ranges[k];
        let size = ranges.iter().map(|[lo, hi]| hi - lo).fold(0.0, f64::max);
        if lo <= hi && size > 0.0 { [lo - 0.6 * size, hi + 0.6 * size] } else { all }
    });
    for k in 0..2 {
        if let Some([lo, hi]) = of_light[k] {
            ranges[k] = [ranges[k][0].min(lo.max(reach[k][0])), ranges[k][1].max(hi.min(reach[k][1]))];
        }
    }
    with_margins(ranges)
}

/// The boxes of the regions and the sheets.
fn boxes(system: &System) -> Vec<Bounds> {
    let program = system.program();
    let model = &program.prototypes()[0];
    let leaves = model.leaves.clone().map(|leaf| program.leaf_bounds(rayweave_model::LeafId(leaf)));
    let whole = program.bounds();
    let solids: Vec<Bounds> = match whole.is_finite() {
        true => vec![whole],
        // the parts that are finite of one that is not
        false => leaves.filter(Bounds::is_finite).collect(),
    };
    let sheets = system.element_names().iter().filter_map(|name| system.sheet_program(name));
    solids.into_iter().chain(sheets.map(|program| program.bounds())).filter(|b| !b.is_empty()).collect()
}

/// The range of each coordinate over the ends of all pieces of rays.
fn light_range(cut: &Cut, segments: &Segments) -> [Option<[f64; 2]>; 2] {
    let mut ranges = [None; 2];
    for segment in segments.iter() {
        for point in [segment.start, segment.end].into_iter().filter(|point: &Vec3| point.is_finite()) {
            for (range, x) in ranges.iter_mut().zip(cut.place(point)) {
                let [lo, hi] = range.unwrap_or([x; 2]);
                *range = Some([x.min(lo), x.max(hi)]);
            }
        }
    }
    ranges
}

/// Ranges with something around them, neither of them empty, nor a hair's breadth beside the other.
fn with_margins(ranges: [[f64; 2]; 2]) -> ([f64; 2], [f64; 2]) {
    let ranges = ranges.map(|[lo, hi]| if lo <= hi { [lo, hi] } else { [-1.0, 1.0] });
    let size = ranges.iter().map(|[lo, hi]| hi - lo).fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 2.0 };
    let least = [0.2 * size, 0.12 * size];
    let ranges = [0, 1].map(|k| {
        let [lo, hi] = ranges[k];
        let missing = (0.5 * (least[k] - (hi - lo))).max(0.0);
        [lo - missing - 0.05 * size, hi + missing + 0.05 * size]
    });
    (ranges.map(|range| range[0]), ranges.map(|range| range[1]))
}
