//! `rayweave section`: cross-sections of a model by a plane or a stack of planes.

use crate::arguments::{GlobalArguments, ModelArguments, SubjectArguments, WithinArguments, point};
use crate::failure::Failure;
use crate::terminal::{self, Unit};
use crate::{drawing, interrupt};
use clap::Args;
use rayweave::draw::{EdgeView, visible_edges};
use rayweave::features::{CylindricalFace, cylindrical_faces};
use rayweave::scene::Scene;
use rayweave::section::{
    By, CrossSection, SectionPlane, SectionRun, SectionSettings, SectionStyle, cross_sections,
    section_drawing, section_dxf, section_view,
};
use rayweave::{AnyEvaluator, Compiled, Vec3};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Cut a model by a plane, or a stack of planes: areas, contours, pictures, DXF
///
/// Contours follow the surfaces within a tolerance. The table lists the area of each medium. An .svg, .pdf, .png or .jpg file is a picture,
/// coloured by medium or, with --hatch or --by-region, by region, with a legend. A .dxf file has closed polylines with arcs, and circles, on a layer for each medium, at the height of the plane.
/// Pictures of a stack show at most 100 planes; a .dxf file contains all planes.
#[derive(Args)]
pub struct Section {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    subject: SubjectArguments,

    #[command(flatten)]
    within: WithinArguments,

    /// Plane: xy, xz, yz, the axis perpendicular to it (z is xy), or a position along an axis, such as z=0.5, or z=50% of the model's bounding box from its lower end
    #[arg(long, value_name = "PLANE", default_value = "xy", value_parser = plane_argument, conflicts_with_all = ["point", "normal"])]
    plane: PlaneArgument,

    /// A point of the plane; needs --normal
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true, requires = "normal")]
    point: Option<[f64; 3]>,

    /// The normal of the plane, of any length; without --point the plane goes through the origin
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    normal: Option<[f64; 3]>,

    /// First position of a stack along the axis of the plane, or along its normal from the point
    #[arg(long, value_name = "AT", allow_hyphen_values = true, requires = "to")]
    from: Option<f64>,

    /// Last position of a stack
    #[arg(long, value_name = "AT", allow_hyphen_values = true, requires = "from")]
    to: Option<f64>,

    /// Distance between the planes of a stack
    #[arg(long, value_name = "LENGTH", requires = "from", conflicts_with = "count")]
    step: Option<f64>,

    /// Number of planes of a stack [default: 10]
    #[arg(long, value_name = "N", requires = "from", value_parser = crate::arguments::count::<u32, 2, { u32::MAX as u64 }>)]
    count: Option<u32>,

    /// Output file: .svg, .pdf, .png, .jpg, .dxf. May be repeated
    #[arg(short, long, value_name = "OUT")]
    out: Vec<PathBuf>,

    /// Maximum distance of contours from the surfaces [default: 1/10000 of the larger side of the model in the plane]
    #[arg(long, value_name = "LENGTH")]
    tolerance: Option<f64>,

    /// Scan the plane with at least this many columns; parts thinner than the column spacing may be missed
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = crate::arguments::count::<u32, 2, 65536>)]
    columns: u32,

    /// Hatch the cut faces in pictures (ISO 128-50), each region in another direction or at another distance, and draw the visible edges behind the plane. Implies --by-region, and --beyond for a single plane without --within
    #[arg(long)]
    hatch: bool,

    /// Leave this region without hatching, such as a shaft or a bolt that is cut lengthwise. May be repeated
    #[arg(long, value_name = "NAME", requires = "hatch")]
    no_hatch: Vec<String>,

    /// Add the overall width and height, rounded by the tolerance, and the diameters and centre lines of holes that the plane cuts along their axes, to the picture of a single plane (ISO 129-1)
    #[arg(long, conflicts_with = "from")]
    dimensions: bool,

    /// Draw the visible edges behind the plane of a single section, too; --hatch does so
    #[arg(long, overrides_with = "no_beyond", conflicts_with_all = ["from", "within"])]
    beyond: bool,

    /// Draw only the cut itself
    #[arg(long)]
    no_beyond: bool,

    /// Do not merge regions with the same medium; merged regions have the name of the medium and the colour of the first of them
    #[arg(long)]
    by_region: bool,

    /// Print JSON, with all contours
    #[arg(long)]
    json: bool,
}

/// A plane of the command line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum PlaneArgument {
    Plane(SectionPlane),
    /// The axis, and the fraction of the bounding box of the model along it.
    Part(usize, f64),
}

const AXES: [&str; 3] = ["x", "y", "z"];

impl PlaneArgument {
    /// The plane in a model with these bounds, which only a percentage needs.
    fn in_bounds(
        self,
        bounds: impl FnOnce() -> Result<rayweave::Bounds, Failure>,
    ) -> Result<SectionPlane, Failure> {
        let (axis, part) = match self {
            PlaneArgument::Plane(plane) => return Ok(plane),
            PlaneArgument::Part(axis, part) => (axis, part),
        };
        let (bounds, name) = (bounds()?, AXES[axis]);
        let [lo, hi] = [bounds.lo[axis], bounds.hi[axis]];
        if !(lo.is_finite() && hi.is_finite()) || bounds.is_empty() {
            let problem =
                format!("--plane {name}={}%: the model is empty, or unbounded along {name}", 100.0 * part);
            return Err(Failure::Usage(format!("{problem}. Give a coordinate, such as {name}=0.")));
        }
        Ok(format!("{name}={}", lo + part * (hi - lo)).parse()?)
    }
}

/// The contents of a drawing of sections.
#[derive(Clone, Copy)]
struct Drawn<'a> {
    sections: &'a [CrossSection],
    /// The visible edges behind the plane, as polylines in its coordinates.
    edges: &'a [Vec<[f64; 2]>],
    /// The cylindrical faces of the model, if dimensions are drawn.
    cylinders: &'a [CylindricalFace],
}

/// Parses a plane, or a percentage such as `y=50%`.
fn plane_argument(text: &str) -> Result<PlaneArgument, String> {
    let Some(rest) = text.trim().strip_suffix('%') else { return plane(text).map(PlaneArgument::Plane) };
    let part = rest.split_once('=').and_then(|(axis, percent)| {
        let axis = AXES.iter().position(|own| axis.trim().eq_ignore_ascii_case(own))?;
        let percent = percent.trim().parse::<f64>().ok().filter(|percent| (0.0..=100.0).contains(percent))?;
        Some(PlaneArgument::Part(axis, percent / 100.0))
    });
    part.ok_or_else(|| {
        format!("the plane `{text}` is invalid: a percentage is 0% to 100% of the model, such as y=50%")
    })
}

/// Parses a plane.
pub fn plane(text: &str) -> Result<SectionPlane, String> {
    text.parse::<SectionPlane>().map_err(|error| error.to_string())
}

/// Prints a note if planes lie in faces of the model.
fn note_faces(found: &[CrossSection]) {
    let mut in_faces = found.iter().filter(|section| section.in_face).map(|section| section.plane);
    let Some(first) = in_faces.next() else { return };
    let planes = match in_faces.count() {
        0 => format!("the plane {first} lies in a face"),
        others => format!("the plane {first} and {others} more lie in faces"),
    };
    terminal::note(&format!(
        "note: {planes} of the model: the section shows the material on its {}. A plane slightly beside it leaves no choice.",
        first.side_in_face()
    ));
}

impl Section {
    pub fn run(&self, global: &GlobalArguments) -> Result<(), Failure> {
        self.out.iter().try_for_each(|path| check(path))?;
        let scene = self.model.load()?;
        let planes = self.planes(&scene)?;
        self.check_unhatched(&scene)?;
        let by = if self.is_by_region() { By::Region } else { By::Medium };
        let run = SectionRun { threads: global.threads, cancel: interrupt::token() };
        let (tolerance, columns, within) = (self.tolerance, self.columns, self.within.bounds());
        let settings = SectionSettings { by, tolerance, columns, within, run };
        let bar = terminal::progress_bar(Some(planes.len() as u64), Unit::Percent, global.quiet);
        let mut progress = |done: usize| bar.set_position(done as u64);
        let solid = self.subject.solid.as_deref();
        let make = AnyEvaluator::maker(self.subject.evaluator.as_deref());
        let found = cross_sections(&scene, solid, make, &planes, &settings, &mut progress);
        bar.finish_and_clear();
        let found = found?;
        note_faces(&found);
        self.reject_missed_planes(&scene, &found)?;
        let edges = self.edges_beyond(&scene, &found, global)?;
        let cylinders = match self.dimensions {
            true => {
                let compiled = Compiled::named(&scene, self.subject.solid.as_deref())?;
                let evaluator = AnyEvaluator::new(self.subject.evaluator.as_deref(), compiled.program)?;
                cylindrical_faces(&evaluator).faces
            }
            false => Vec::new(),
        };
        let drawn = Drawn { sections: &found, edges: &edges, cylinders: &cylinders };
        let save = |path: &PathBuf| self.save(path, drawn, scene.unit.symbol());
        self.out.iter().try_for_each(save)?;
        let is_taken = self.out.iter().any(|path| path == Path::new("-"));
        match () {
            () if is_taken => Ok(()),
            () if self.json => terminal::print(&format!("{:#}\n", self.as_json(&scene, &found))),
            () => {
                terminal::print(&self.as_text(&scene, &found))?;
                self.out.iter().try_for_each(|path| terminal::wrote(path, global.quiet))
            }
        }
    }

    /// Rejects names of --no-hatch that no region has.
    fn check_unhatched(&self, scene: &Scene) -> Result<(), Failure> {
        let names: Vec<&str> = scene.regions.iter().map(|region| region.name.as_str()).collect();
        match self.no_hatch.iter().find(|name| !names.contains(&name.as_str())) {
            Some(name) => Err(Failure::Usage(format!(
                "--no-hatch {name} is no region of {}: its regions are {}.",
                self.model.name(),
                names.join(", ")
            ))),
            None => Ok(()),
        }
    }

    /// True if regions with the same medium are separate parts: in a hatched drawing, the edges between them must show.
    fn is_by_region(&self) -> bool {
        self.by_region || self.hatch
    }

    /// The visible edges behind the plane of a single section, if a picture shows them.
    fn edges_beyond(
        &self,
        scene: &Scene,
        found: &[CrossSection],
        global: &GlobalArguments,
    ) -> Result<Vec<Vec<[f64; 2]>>, Failure> {
        let is_wanted = (self.beyond || self.hatch && self.within.bounds().is_none()) && !self.no_beyond;
        let is_drawn = self.out.iter().any(|path| !is_dxf(path));
        let [section] = found else { return Ok(Vec::new()) };
        if !(is_wanted && is_drawn) {
            return Ok(Vec::new());
        }
        let compiled = Compiled::named(scene, self.subject.solid.as_deref())?;
        let evaluator = AnyEvaluator::new(self.subject.evaluator.as_deref(), compiled.program)?;
        let size = (section.hi[0] - section.lo[0]).max(section.hi[1] - section.lo[1]);
        // about a pixel of the drawing, off the symmetry of the model
        let step = size / 900.0;
        let window = [section.lo.map(|x| x - 2.317 * step), section.hi.map(|x| x + 2.683 * step)];
        let view = EdgeView { plane: section.plane.cut()?, is_behind: true, window, step };
        Ok(visible_edges(&evaluator, &view, global.threads, &interrupt::token())?)
    }

    fn planes(&self, scene: &Scene) -> Result<Vec<SectionPlane>, Failure> {
        let bounds = || Ok(Compiled::named(scene, self.subject.solid.as_deref())?.program.bounds());
        let plane = match self.normal {
            Some(normal) => {
                SectionPlane::new(Vec3::from(self.point.unwrap_or_default()), Vec3::from(normal))?
            }
            None => self.plane.in_bounds(bounds)?,
        };
        let (Some(from), Some(to)) = (self.from, self.to) else { return Ok(vec![plane]) };
        if self.normal.is_none() && plane.offset() != 0.0 {
            let problem = format!("--plane {plane}: --from and --to set the positions of a stack");
            let remedy = "Give only the name of the plane, such as yz.";
            return Err(Failure::Usage(format!("{problem}. {remedy}")));
        }
        let evenly = (to - from) / f64::from(self.count.unwrap_or(10) - 1);
        // a stack of height 0 is one plane
        let step = self.step.unwrap_or(if to == from { 1.0 } else { evenly });
        Ok(plane.stack(from, to, step)?)
    }

    /// Rejects planes that miss the model.
    fn reject_missed_planes(&self, scene: &Scene, found: &[CrossSection]) -> Result<(), Failure> {
        if found.iter().any(|section| !section.parts.is_empty()) {
            return Ok(());
        }
        let compiled = rayweave::Compiled::named(scene, self.subject.solid.as_deref())?;
        let (bounds, what) = (
            compiled.program.bounds(),
            match found {
                [only] => format!("the plane {}", only.plane),
                all => format!("none of the {} planes", all.len()),
            },
        );
        let verb = if found.len() == 1 { "does not intersect" } else { "intersects" };
        let reach = match bounds.is_empty() {
            true => "it is empty".to_owned(),
            false => {
                let corner = |p: Vec3| terminal::short_point(p.to_array());
                format!("it reaches from {} to {}", corner(bounds.lo), corner(bounds.hi))
            }
        };
        Err(Failure::Input(format!("{}: {what} {verb} the model: {reach}.", self.model.name())))
    }

    fn save(&self, path: &Path, drawn: Drawn<'_>, unit: &str) -> Result<(), Failure> {
        let Drawn { sections: found, edges, cylinders } = drawn;
        match is_dxf(path) {
            true => terminal::save(path, section_dxf(found, unit).as_bytes()),
            false => {
                let style = SectionStyle {
                    hatch: self.hatch,
                    unhatched: &self.no_hatch,
                    dimensions: self.dimensions,
                    cylinders,
                };
                let name = self.model.name();
                let svg = match found {
                    [only] => section_view(only, edges, &name, unit, style),
                    all => section_drawing(all, &name, unit, style),
                };
                drawing::save(path, &svg, &name)
            }
        }
    }

    fn as_text(&self, scene: &Scene, found: &[CrossSection]) -> String {
        let (model, unit) = (self.model.name(), scene.unit.symbol());
        let tolerance = found.iter().map(|section| section.tolerance).fold(0.0, f64::max);
        let tolerance = terminal::short(tolerance);
        let mut text = format!(
            "{model}: contours within {tolerance} {unit} of the truth, lengths in {}\n\n",
            terminal::unit_name(unit)
        );
        let rows = found.iter().flat_map(|section| {
            section.parts.iter().map(|part| {
                // as many digits as are accurate at this tolerance
                let digits = |value: f64, error: f64| rayweave::draw::axis::format_number(value, error);
                let area = digits(part.area, section.tolerance * part.perimeter);
                let perimeter = digits(part.perimeter, 1e-3 * part.perimeter);
                vec![
                    section.plane.to_string(),
                    part.name.clone(),
                    area,
                    perimeter,
                    part.contours.len().to_string(),
                ]
            })
        });
        let what = if self.is_by_region() { "region" } else { "medium" };
        let header = ["plane", what, "area", "perimeter", "contours"];
        text += &terminal::table(&header, &rows.collect::<Vec<_>>(), &[false, false, true, true, true]);
        let mut media: Vec<u32> = scene.regions.iter().map(|region| region.medium).collect();
        media.sort_unstable();
        media.dedup();
        if media.len() < scene.regions.len() && !self.is_by_region() && self.subject.solid.is_none() {
            text += "\nregions with the same medium are merged; --by-region keeps them apart\n";
        }
        text
    }

    fn as_json(&self, scene: &Scene, found: &[CrossSection]) -> Value {
        json!({
            "model": self.model.name(),
            "unit": scene.unit.symbol(),
            "sections": found.iter().map(section_json).collect::<Vec<_>>(),
        })
    }
}

fn section_json(section: &CrossSection) -> Value {
    let parts = section.parts.iter().map(|part| {
        json!({
            "name": part.name,
            "area": part.area,
            "area_error": section.tolerance * part.perimeter,
            "perimeter": part.perimeter,
            "contours": part.contours,
        })
    });
    json!({
        "plane": section.plane.to_string(),
        "offset": section.plane.offset(),
        "axes": section.plane.axis_names(),
        "tolerance": section.tolerance,
        "in_face": section.in_face,
        "parts": parts.collect::<Vec<_>>(),
    })
}

fn is_dxf(path: &Path) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case("dxf"))
}

/// Checks the extension of an output file before any work is done.
fn check(path: &Path) -> Result<(), Failure> {
    let problem = || {
        let path = path.display();
        Failure::Usage(format!(
            "{path}: unknown format: sections are written as .svg, .pdf, .png, .jpg or .dxf."
        ))
    };
    (is_dxf(path) || drawing::is_drawing(path)).then_some(()).ok_or_else(problem)
}
