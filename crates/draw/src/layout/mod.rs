//! Layouts of optical systems: a true section of the solids by a plane, with rays near that plane.
//!
//! ```
//! use rayweave_draw::layout::{OpticalLayout, LayoutOptions};
//! use rayweave_optics::file::optics_of;
//! use rayweave_trace::Packets;
//!
//! let (document, scene) = rayweave_scene::parse(r#"
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
//! let options = LayoutOptions::default();
//! let layout = OpticalLayout::new(&system, &optics.sources, &optics.settings, &options, Packets::new)?;
//! assert!(layout.to_svg("a ball lens", scene.unit.symbol()).starts_with("<svg "));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod plane;
mod rays;
mod svg;

pub use plane::LayoutPlane;

use crate::DrawError;
use rays::TrialRays;
use rayweave_analysis::section::{Cut, Section, SectionError, SectionWindow, section};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Evaluator, Program, RegionId};
use rayweave_optics::{Emitter, Segments, System, TraceSettings, Tracer};
use std::sync::Arc;

/// The meaning of the colours of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RayColour {
    /// The visible colour of the wavelength; grey outside the visible range.
    #[default]
    Wavelength,
    /// A colour for each source.
    Source,
}

/// Options of a layout.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayoutOptions {
    /// The plane of the section; by default the one nearest to the light.
    pub plane: Option<LayoutPlane>,
    /// The approximate number of rays of all sources together: those nearest to the plane, evenly spread.
    pub rays: usize,
    /// The colours of the rays.
    pub colour: RayColour,
}

impl Default for LayoutOptions {
    fn default() -> LayoutOptions {
        LayoutOptions { plane: None, rays: 27, colour: RayColour::Wavelength }
    }
}

/// A section of an optical system with light.
#[derive(Clone, Debug)]
pub struct OpticalLayout {
    plane: LayoutPlane,
    cut: Cut,
    /// The corners of the drawing in the plane.
    lo: [f64; 2],
    hi: [f64; 2],
    parts: Vec<Part>,
    sheets: Vec<Vec<[f64; 2]>>,
    segments: Segments,
    /// True for light of [`OpticalLayout::of_light`]: thin lines, which get thinner as their number grows.
    is_dense: bool,
    /// Points that are marked, and the meaning of the marks.
    marks: Option<(String, Vec<[f64; 2]>)>,
    colour: RayColour,
    sources: usize,
    /// The names of the sources, if they have any.
    source_names: Vec<String>,
    /// The element behind which no light is drawn.
    last: Option<usize>,
    /// The edges of a stop, as lines.
    stop: Vec<[[f64; 2]; 2]>,
}

/// A region in the section.
#[derive(Clone, Debug)]
struct Part {
    name: String,
    /// The medium of the region, `None` if it is opaque.
    medium: Option<String>,
    is_sensor: bool,
    contours: Vec<Vec<[f64; 2]>>,
}

/// Light with less than this fraction of its initial power is not drawn.
const FAINTEST: f64 = 1e-4;

impl OpticalLayout {
    /// Cuts a system and traces some of its light. Rays are chosen from all parts of every source. `make` constructs
    /// evaluators.
    ///
    /// # Errors
    /// [`DrawError::Optics`] for light that cannot be traced, [`DrawError::Section`] for an invalid plane or a system without extent.
    pub fn new<E: Evaluator>(
        system: &System,
        light: &impl Emitter,
        settings: &TraceSettings,
        options: &LayoutOptions,
        make: impl Fn(Arc<Program>) -> E,
    ) -> Result<OpticalLayout, DrawError> {
        OpticalLayout::new_in_order(system, &[], light, settings, options, make)
    }

    /// Like [`OpticalLayout::new`], only with rays that reach the last of the elements `sequence` in this order, such as those of a lens
    /// file; others, which miss a lens for example, are stray light. If no ray does, all are drawn.
    ///
    /// # Errors
    /// Those of [`OpticalLayout::new`].
    pub fn new_in_order<E: Evaluator>(
        system: &System,
        sequence: &[usize],
        light: &impl Emitter,
        settings: &TraceSettings,
        options: &LayoutOptions,
        make: impl Fn(Arc<Program>) -> E,
    ) -> Result<OpticalLayout, DrawError> {
        let tracer = Tracer::new(system, &make);
        let trial = TrialRays::new(&tracer, light, settings)?.in_order(sequence);
        let plane = options.plane.unwrap_or_else(|| plane::nearest_to_light(&trial.segments));
        let cut = plane.cut()?;
        let chosen = trial.nearest_to(&cut, options.rays.max(1));
        let faintest = FAINTEST * chosen.powers().iter().fold(0.0, |most: f64, &power| most.max(power));
        let settings = TraceSettings { threshold: settings.threshold.max(faintest), ..settings.clone() };
        let segments = tracer.trace(&chosen, &settings)?.segments;
        let (lo, hi) = window(system, &cut, &segments);
        let mut layout = OpticalLayout {
            plane,
            cut,
            lo,
            hi,
            parts: Vec::new(),
            sheets: Vec::new(),
            segments,
            is_dense: false,
            marks: None,
            colour: options.colour,
            sources: trial.sources,
            source_names: Vec::new(),
            last: None,
            stop: Vec::new(),
        };
        let medium = |region| system.medium_of(region).map(|medium| medium.name().to_owned());
        layout.cut_solids(&make(system.program().clone()), medium)?;
        layout.cut_sheets(system, &make)?;
        Ok(layout)
    }

    /// Cuts a model of regions and draws all traced light, projected onto the plane. `medium` is the name of the medium of a
    /// region, `None` for opaque ones. The window contains the ends of all segments, and the regions there that it has room for,
    /// without regions around all light that no light is in, such as the world; escaping light is drawn up to its edge.
    ///
    /// # Errors
    /// [`DrawError::Section`] for an invalid plane or a model without extent.
    pub fn of_light<E: Evaluator>(
        evaluator: &E,
        medium: impl Fn(RegionId) -> Option<String>,
        segments: Segments,
        plane: Option<LayoutPlane>,
    ) -> Result<OpticalLayout, DrawError> {
        let plane = plane.unwrap_or_else(|| plane::nearest_to_light(&segments));
        let cut = plane.cut()?;
        let of_light = light_range(&cut, &segments);
        let of_light = of_light.map(|range| range.unwrap_or([1.0, -1.0]));
        let mut boxes = evaluator.program().region_bounds();
        drop_dark_surroundings(evaluator, &segments, &mut boxes);
        let (lo, hi) = with_margins(with_regions(&cut, of_light, &boxes));
        let mut layout = OpticalLayout {
            plane,
            cut,
            lo,
            hi,
            parts: Vec::new(),
            sheets: Vec::new(),
            segments,
            is_dense: true,
            marks: None,
            colour: RayColour::Wavelength,
            sources: 1,
            source_names: Vec::new(),
            last: None,
            stop: Vec::new(),
        };
        layout.cut_solids(evaluator, medium)?;
        Ok(layout)
    }

    /// Marks points, such as those of detection; `name` is their meaning in the legend.
    #[must_use]
    pub fn with_marks(mut self, name: &str, points: impl IntoIterator<Item = Vec3>) -> OpticalLayout {
        let points = points.into_iter().map(|point| self.cut.place(point)).collect();
        self.marks = Some((name.to_owned(), points));
        self
    }

    /// Names the sources in the legend, such as the fields of a lens.
    #[must_use]
    pub fn with_source_names(mut self, names: impl IntoIterator<Item = String>) -> OpticalLayout {
        self.source_names = names.into_iter().collect();
        self
    }

    /// Draws no light behind this element, such as the image of a lens.
    #[must_use]
    pub fn ending_at(mut self, element: usize) -> OpticalLayout {
        self.last = Some(element);
        self
    }

    /// Draws the edges of a stop as lines, each from the end at the opening to the other one, with the label "stop".
    #[must_use]
    pub fn with_stop(mut self, edges: impl IntoIterator<Item = [Vec3; 2]>) -> OpticalLayout {
        self.stop = edges.into_iter().map(|edge| edge.map(|point| self.cut.place(point))).collect();
        let margin = 0.05 * (self.hi[0] - self.lo[0]).max(self.hi[1] - self.lo[1]);
        for [x, y] in self.stop.iter().flatten() {
            for (k, place) in [x, y].into_iter().enumerate() {
                self.lo[k] = self.lo[k].min(place - margin);
                self.hi[k] = self.hi[k].max(place + margin);
            }
        }
        self
    }

    /// Draws the regions with these names as sensors, in a colour of their own.
    #[must_use]
    pub fn with_sensors<'n>(mut self, names: impl IntoIterator<Item = &'n str>) -> OpticalLayout {
        for name in names {
            let own = self.parts.iter_mut().filter(|part| part.name == name);
            own.for_each(|part| part.is_sensor = true);
        }
        self
    }

    /// The layout as SVG. `unit` is the unit of length.
    pub fn to_svg(&self, title: &str, unit: &str) -> String {
        svg::drawing(self, title, unit)
    }

    /// The plane of the section.
    pub fn plane(&self) -> LayoutPlane {
        self.plane
    }

    fn cut_solids<E: Evaluator>(
        &mut self,
        evaluator: &E,
        medium: impl Fn(RegionId) -> Option<String>,
    ) -> Result<(), DrawError> {
        let found = self.section(evaluator, self.lo, self.hi)?;
        for (number, region) in (1..).zip(evaluator.program().regions()) {
            let number = RegionId(number);
            let contours = found.contours(number);
            let (name, medium) = (region.name.clone(), medium(number));
            self.parts.push(Part { name, medium, is_sensor: false, contours });
        }
        Ok(())
    }

    /// Cuts the sheets, each in a window of the size of the sheet.
    fn cut_sheets<E: Evaluator>(
        &mut self,
        system: &System,
        make: impl Fn(Arc<Program>) -> E,
    ) -> Result<(), DrawError> {
        for name in system.element_names() {
            let Some(program) = system.sheet_program(name) else { continue };
            let ranges = [0, 1].map(|k| self.cut.range(&program.bounds(), k));
            let lo = [0, 1].map(|k| ranges[k][0].max(self.lo[k]));
            let hi = [0, 1].map(|k| ranges[k][1].min(self.hi[k]));
            let margin = 1e-3 * (hi[0] - lo[0]).max(hi[1] - lo[1]);
            if lo[0] < hi[0] && lo[1] < hi[1] {
                let sheet = make(program.clone());
                let found = self.section(&sheet, lo.map(|x| x - margin), hi.map(|x| x + margin))?;
                self.sheets.extend(found.between(RegionId(1), RegionId(2)));
            }
        }
        Ok(())
    }

    fn section(
        &self,
        evaluator: &impl Evaluator,
        lo: [f64; 2],
        hi: [f64; 2],
    ) -> Result<Section, SectionError> {
        let whole = (self.hi[0] - self.lo[0]).max(self.hi[1] - self.lo[1]);
        let window = SectionWindow { tolerance: 2e-5 * whole, ..SectionWindow::new(lo, hi) };
        section(evaluator, &self.cut, &window)
    }
}

/// The corners of a drawing that shows all elements, and light before and behind them.
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
    // distant light is shown only near the elements, up to 0.6 times their size
    let most = [0, 1].map(|k| {
        let [lo, hi] = ranges[k];
        let size = ranges.iter().map(|[lo, hi]| hi - lo).fold(0.0, f64::max);
        if lo <= hi && size > 0.0 { [lo - 0.6 * size, hi + 0.6 * size] } else { all }
    });
    for k in 0..2 {
        if let Some([lo, hi]) = of_light[k] {
            ranges[k] = [ranges[k][0].min(lo.max(most[k][0])), ranges[k][1].max(hi.min(most[k][1]))];
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
        // for an unbounded model, only the bounded parts
        false => leaves.filter(Bounds::is_finite).collect(),
    };
    let sheets = system.element_names().iter().filter_map(|name| system.sheet_program(name));
    solids.into_iter().chain(sheets.map(|program| program.bounds())).filter(|b| !b.is_empty()).collect()
}

/// The range of each coordinate over the ends of all segments.
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

/// The largest number of segments whose regions are found for the window of a drawing.
const MOST_LOCATED: usize = 1 << 16;

/// Removes the boxes of the regions around all light that hold none of it, such as an empty world.
fn drop_dark_surroundings<E: Evaluator>(evaluator: &E, segments: &Segments, boxes: &mut [Bounds]) {
    let is_within = |point: &Vec3| point.is_finite();
    let ends = || segments.iter().flat_map(|own| [own.start, own.end]).filter(is_within);
    let mut light = Bounds::EMPTY;
    ends().for_each(|point| light = light.union(&Bounds::new(point, point)));
    if light.is_empty() || segments.len() > MOST_LOCATED {
        return;
    }
    // escaping light has no end, and passes through whatever is around it
    let middle = |start: Vec3, end: Vec3, direction: Vec3| match end.is_finite() {
        true => 0.5 * (start + end),
        false => start + 1e-6 * (light.hi - light.lo).length() * direction,
    };
    let middles: Vec<Vec3> = segments.iter().map(|own| middle(own.start, own.end, own.direction)).collect();
    let points = [0, 1, 2].map(|k| middles.iter().map(|point| point.to_array()[k]).collect::<Vec<f64>>());
    let mut regions = vec![RegionId(0); middles.len()];
    evaluator.regions_at([&points[0], &points[1], &points[2]], &mut evaluator.scratch(), &mut regions);
    for (number, own) in (1..).zip(boxes) {
        let is_around = own.lo.cmple(light.lo).all() && own.hi.cmpge(light.hi).all();
        if is_around && !regions.contains(&RegionId(number)) {
            *own = Bounds::EMPTY;
        }
    }
}

/// The ranges of light with those of the regions that it is in, unless they extend beyond it by more than 0.6 times its size.
fn with_regions(cut: &Cut, light: [[f64; 2]; 2], boxes: &[Bounds]) -> [[f64; 2]; 2] {
    let size = light.iter().map(|[lo, hi]| hi - lo).fold(0.0, f64::max);
    let mut ranges = light;
    for bounds in boxes.iter().filter(|own| own.is_finite() && !own.is_empty()) {
        let own = [0, 1].map(|k| cut.range(bounds, k));
        let fits = |k: usize| {
            let ([lo, hi], [first, last]) = (light[k], own[k]);
            first <= hi && last >= lo && first >= lo - 0.6 * size && last <= hi + 0.6 * size
        };
        if (0..2).all(fits) {
            for (range, [first, last]) in ranges.iter_mut().zip(own) {
                *range = [range[0].min(first), range[1].max(last)];
            }
        }
    }
    ranges
}

/// Ranges with margins, none of them empty or much narrower than the other.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Light of 10 by 10: a tank around it that is 4 wider is shown whole, a world and a distant part are not.
    #[test]
    fn regions_around_light_are_shown_whole() {
        let cut = "yz".parse::<LayoutPlane>().unwrap().cut().unwrap();
        let cube = |lo: f64, hi: f64| Bounds::new(Vec3::new(lo, lo, lo), Vec3::new(hi, hi, hi));
        let light = [[0.0, 10.0]; 2];
        let boxes = [cube(-100.0, 100.0), cube(-4.0, 10.0), cube(2.0, 15.5), cube(50.0, 60.0)];
        assert_eq!(with_regions(&cut, light, &boxes), [[-4.0, 15.5]; 2]);
        assert_eq!(with_regions(&cut, light, &boxes[..1]), light);
    }

    /// A tank in a world of 24: without light, the world has no place in the drawing.
    #[test]
    fn dark_surroundings_are_not_shown() {
        let text = r#"
            rayweave = 1
            [solid.hall]
            box = { size = 24 }
            [solid.tank]
            box = { size = 20 }
            [[region]]
            solid = "hall"
            [[region]]
            solid = "tank"
        "#;
        let (_, scene) = rayweave_scene::parse(text).unwrap();
        let program = Arc::new(Program::compile_regions(&scene.model_regions()).unwrap());
        let evaluator = rayweave_trace::Packets::new(program);
        let light = |ends: &[[f64; 3]]| {
            let mut segments = Segments::default();
            for pair in ends.windows(2) {
                let [start, end] = [Vec3::from(pair[0]), Vec3::from(pair[1])];
                segments.push(plane::tests::ray(start.to_array(), end.to_array()));
            }
            let layout =
                OpticalLayout::of_light(&evaluator, |_| None, segments, Some("yz".parse().unwrap())).unwrap();
            [layout.lo, layout.hi]
        };
        let inside = light(&[[0.0, -10.0, -10.0], [0.0, 10.0, 10.0]]);
        assert_eq!(inside, [[-11.0; 2], [11.0; 2]]);
        // light that leaves the tank
        let outside = light(&[[0.0, -10.0, -10.0], [0.0, 10.0, 10.0], [0.0, 12.0, 12.0]]);
        assert!(outside[0][0] < -12.0, "{outside:?}");
    }
}
