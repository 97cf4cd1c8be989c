//! Technical drawings: three views with visible edges, centre lines and dimensions, and a view at a slant, to a standard scale.
//!
//! The views are those of ISO 5456-2, in first-angle or third-angle projection. Lines are of the types of ISO 128-2: wide for visible
//! edges, dashed for hidden ones, chain lines for the axes of cylinders and for circles of holes. Each view has the overall
//! sizes, the distances between flat faces at steps, the diameters of the cylinders that it shows as circles (`4× ⌀6.6 through`,
//! `8× ⌀9 × 12 deep on ⌀95`, `R5`), and the sizes of slots and polygonal holes: `slot 5.5 × 7.5 through`,
//! `hexagon 10 across flats × 5 deep`, `20 × 8 through`, `20 × 8 × 5 deep, R3` with round corners; and those of fillets and chamfers, `R4`
//! and `1.5 × 45°`.

mod circle;
mod label;
mod panel;
mod scale;

pub use scale::ProjectionMethod;
pub(crate) use scale::Scale;

use crate::all_edges::{Edges, all_edges};
use crate::edges::EdgeView;
use crate::svg::{Anchor, Svg};
use crate::{DrawError, dimension};
use circle::{Circle, Group, groups};
use panel::Panel;
use rayweave_analysis::features::{
    AxialFeatures, CornerFace, CornerPlace, CylindricalFace, PolygonalFace, axial_features, corner_faces,
    cylindrical_faces, extent,
};
use rayweave_analysis::section::{Cut, SectionRun};
use rayweave_error::Message;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::Evaluator;
use rayweave_render::{RenderError, Run, Size, View};
use rayweave_scene::Unit;
use rayweave_shape::surface::{MeshForm, Surface};
use scale::symbol;
use std::any::Any;

/// The options of a technical drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TechnicalOptions {
    /// Width and height in units of 1/96 inch; A4, landscape, by default.
    pub size: Option<Size>,
    /// The arrangement of the views.
    pub projection: ProjectionMethod,
}

/// A technical drawing.
#[derive(Clone, Debug)]
pub struct TechnicalDrawing {
    /// The drawing as SVG.
    pub svg: String,
    /// Parts of the model that the drawing leaves out, in sentences.
    pub notes: Vec<String>,
}

/// A4, landscape, in units of 1/96 inch.
const PAPER: [f64; 2] = [1123.0, 794.0];
const MARGIN: f64 = 28.0;
/// The space to the left of views and below them for dimensions.
const SPACE: f64 = dimension::SPACE;
/// The space above a view for its name.
const NAME: f64 = 22.0;
/// The height of the line at the lower edge.
const TITLE: f64 = 34.0;
/// The space between a view and the texts beside it.
const GAP: f64 = 26.0;

const STYLE: &str = "\
.edge { fill: none; stroke: currentColor; stroke-width: 1.3; stroke-linejoin: round; stroke-linecap: round }
.hidden { fill: none; stroke: currentColor; stroke-width: 0.7; stroke-dasharray: 6 3 }
.centre { fill: none; stroke: #3d6ea8; stroke-width: 0.7; stroke-dasharray: 12 3 2 3 }
.leader { fill: none; stroke: currentColor; stroke-width: 0.6 }
@media (prefers-color-scheme: dark) { .centre { stroke: #8fb8e8 } }
";

/// Draws a bounded model.
///
/// ```
/// use rayweave_draw::technical::{TechnicalOptions, technical_drawing};
/// use rayweave_render::Run;
/// use rayweave_scene::{Compiled, Unit};
/// use rayweave_trace::AnyEvaluator;
///
/// let (_, scene) = rayweave_scene::parse(
///     "rayweave = 1\n[solid.plate]\nbox = { size = [60, 40, 8] }\n[solid.hole]\ncylinder = { radius = 3 }\n\
///      [solid.part]\nexpr = \"plate - hole\"\n[[region]]\nsolid = \"part\"",
/// )?;
/// let evaluator = AnyEvaluator::new(None, Compiled::new(&scene)?.program)?;
/// let drawing =
///     technical_drawing(&evaluator, "plate", Unit::Millimetre, &TechnicalOptions::default(), &mut Run::default())?;
/// assert!(drawing.svg.contains(">\u{2300}6 through</text>") && drawing.svg.contains(">60</text>"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
///
/// [`DrawError::Option`] for an empty or unbounded model, or a sheet that is too small; or the run was cancelled.
pub fn technical_drawing<E: Evaluator>(
    evaluator: &E,
    title: &str,
    unit: Unit,
    options: &TechnicalOptions,
    run: &mut Run<'_>,
) -> Result<TechnicalDrawing, DrawError> {
    let Some(extent) = extent(evaluator) else {
        let message = Message::new("the model is empty or unbounded", "a drawing shows all of a model");
        return Err(DrawError::Option(message.suggest("Intersect it with a box.")));
    };
    let found = cylindrical_faces(evaluator);
    let section_run = SectionRun { threads: run.threads, cancel: run.cancel.clone() };
    let cancelled = |_| DrawError::Render(RenderError::Cancelled);
    let axial = axial_features(evaluator, &found.faces, &section_run).map_err(cancelled)?;
    let corners = corner_faces(evaluator);
    let paper = options.size.map_or(PAPER, |size| [size.width() as f64, size.height() as f64]);
    let views = options.projection.views();
    let sheet =
        Sheet { bounds: extent.bounds, faces: &found.faces, corners: &corners, axial: &axial, paper, unit };
    let groups = views.map(|(view, ..)| sheet.groups(view));
    let scale = sheet.scale(&views, &groups)?;
    let mut drawing = Drawing { sheet: &sheet, scale: &scale, svg: Svg::default() };
    for ((view, column, row), groups) in views.into_iter().zip(&groups) {
        let panel = sheet.panel(view, [column, row], &scale);
        drawing.view(evaluator, &panel, groups, run)?;
    }
    drawing.slanted(evaluator, options.projection, run)?;
    let has_mesh = evaluator.program().surfaces().iter().any(|entry| is_mesh(&entry.surface));
    drawing.footer(title, options.projection);
    if has_mesh {
        let at = [MARGIN, paper[1] - MARGIN - TITLE + 2.0];
        drawing.svg.text("name", at, Anchor::Start, MESH_NOTE, MESH_NOTE);
    }
    let description = format!("Technical drawing in {}, scale {}.", options.projection, scale.text());
    let svg = drawing.svg.finish(paper, title, &description, &[STYLE, dimension::STYLE].concat());
    let mut notes = Vec::new();
    if found.left_out > 0 {
        notes.push(format!("{} of the cylinders have no diameters: the model has too many.", found.left_out));
    }
    if has_mesh {
        notes.push(format!("{MESH_NOTE}."));
    }
    notes.extend(oblique_notes(&sheet));
    notes.extend(axial_notes(&axial));
    if !extent.is_exact {
        notes.push(
            "the overall sizes were found by rays, which may miss a part thinner than 1/64 of the model. If it has a thin part at its \
             outside, compare them with its bounds (rayweave info, Model.bounds), which contain all of it."
                .to_owned(),
        );
    }
    Ok(TechnicalDrawing { svg, notes })
}

/// The note on models with meshes.
const MESH_NOTE: &str =
    "round faces of a mesh have no diameters; its edges are those between triangles at 12 degrees or more";

fn is_mesh(surface: &Surface) -> bool {
    let Surface::Object(object) = surface else { return false };
    (&*object.form as &dyn Any).is::<MeshForm>()
}

/// A note on holes and shafts that no view shows as circles.
fn oblique_notes(sheet: &Sheet<'_>) -> Option<String> {
    let number = |length: f64| crate::axis::format_number(length, sheet.resolution());
    let is_oblique =
        |face: &&CylindricalFace| face.share > 0.5 && face.axis().abs().max_element() <= 1.0 - 1e-9;
    let mut texts: Vec<String> = Vec::new();
    for face in sheet.faces.iter().filter(is_oblique) {
        let place = (0.5 * (face.ends[0] + face.ends[1])).to_array().map(number).join(", ");
        let through = if face.is_through { " through" } else { "" };
        texts.push(format!("\u{2300}{}{through} at ({place})", number(2.0 * face.radius)));
    }
    let more = match texts.len().saturating_sub(MAX_NOTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    texts.truncate(MAX_NOTED);
    let list = texts.join(", ");
    (!texts.is_empty())
        .then(|| format!("not shown: the diameters of cylinders at an angle to the views, {list}{more}."))
}

/// The greatest number of cylinders in a note.
const MAX_NOTED: usize = 5;

/// Notes on polygons and steps without dimensions.
fn axial_notes(axial: &AxialFeatures) -> Vec<String> {
    let mut notes = Vec::new();
    for axis in 0..3 {
        let (name, steps) = (["x", "y", "z"][axis], axial.steps[axis].len());
        if axial.left_out.contains(&axis) {
            notes.push(format!(
                "no polygonal holes along {name} have sizes: the model has too many levels along {name}."
            ));
        }
        if steps > MAX_STEPS {
            notes.push(format!(
                "the {steps} steps along {name} have no dimensions: the drawing has room for {MAX_STEPS}."
            ));
        }
    }
    notes
}

/// The greatest number of steps along an axis that have dimensions.
const MAX_STEPS: usize = 5;

/// The subject of a drawing.
struct Sheet<'a> {
    bounds: Bounds,
    faces: &'a [CylindricalFace],
    corners: &'a [CornerFace],
    axial: &'a AxialFeatures,
    paper: [f64; 2],
    unit: Unit,
}

impl Sheet<'_> {
    /// The diameters that a view shows.
    fn groups(&self, view: View) -> Vec<Group> {
        let (plane, size) = (plane(view, self.bounds.centre()), self.bounds.size().max_element());
        let towards = plane.normal();
        let is_circle = |face: &&CylindricalFace| face.axis().dot(towards).abs() > 1.0 - 1e-9;
        let circles = self.faces.iter().filter(is_circle).map(|face| Circle::new(face, &plane));
        let is_along = |face: &&PolygonalFace| face.along.normalize_or_zero().dot(towards).abs() > 1.0 - 1e-9;
        let polygons = self.axial.polygons.iter().filter(is_along);
        let polygons = polygons.map(|face| Circle::of_polygon(face, &plane, 1e-7 * size));
        let corners = self.corners.iter().filter(|face| is_seen_in(face, view));
        let corners = corners.map(|face| Circle::of_corner(face, &plane));
        groups(circles.chain(polygons).chain(corners).collect(), size, self.resolution())
    }

    /// The positions of a chain of dimensions along an axis: the ends of the model, and the steps and the axes of radial holes between
    /// them; empty without these.
    fn levels(&self, axis: usize) -> Vec<f64> {
        let steps = &self.axial.steps[axis];
        let [lo, hi] = [self.bounds.lo[axis], self.bounds.hi[axis]];
        let mut between = steps.clone();
        for level in self.radial_holes(axis) {
            let is_near = |other: &f64| (other - level).abs() < self.resolution();
            if lo < level && level < hi && !between.iter().any(is_near) {
                between.push(level);
            }
        }
        if between.len() > MAX_STEPS {
            between.clone_from(steps);
        }
        between.sort_by(f64::total_cmp);
        match (1..=MAX_STEPS).contains(&between.len()) {
            true => [&[lo], &between[..], &[hi]].concat(),
            false => Vec::new(),
        }
    }

    /// The positions along an axis of holes whose axes meet that of a shaft or a bore along it at right angles.
    fn radial_holes(&self, axis: usize) -> Vec<f64> {
        let tolerance = 1e-7 * self.bounds.size().max_element();
        let is_along = |face: &&CylindricalFace| face.axis()[axis].abs() > 1.0 - 1e-9 && face.share > 0.5;
        let is_across =
            |face: &&CylindricalFace| face.is_hole && face.share > 0.5 && face.axis()[axis].abs() < 1e-9;
        let is_radial = |hole: &&CylindricalFace| {
            let meets = |shaft: &CylindricalFace| {
                let apart = hole.ends[0] - shaft.ends[0];
                let normal = hole.axis().cross(shaft.axis());
                shaft.radius > hole.radius && normal.dot(apart).abs() < tolerance
            };
            self.faces.iter().filter(is_along).any(meets)
        };
        self.faces.iter().filter(is_across).filter(is_radial).map(|hole| hole.ends[0][axis]).collect()
    }

    /// The space that chains of dimensions take to the left of views, and below the view from the front.
    fn chains(&self) -> [f64; 2] {
        let row = |axes: &[usize]| match axes.iter().all(|&axis| self.levels(axis).is_empty()) {
            true => 0.0,
            false => dimension::ROW,
        };
        [row(&[1, 2]), row(&[0])]
    }

    /// The resolution of the dimensions: a thousandth of a millimetre, and finer in tiny models.
    fn resolution(&self) -> f64 {
        (1e-6 / self.unit.metres()).min(1e-3 * self.bounds.size().max_element())
    }

    /// The widths of both columns and the heights of both rows in units of the model.
    fn sizes(&self, views: &[(View, usize, usize); 3]) -> [[f64; 2]; 2] {
        let (mut widths, mut heights) = ([0.0f64; 2], [0.0f64; 2]);
        for &(view, column, row) in views {
            let [lo, hi] = window(&plane(view, self.bounds.centre()), &self.bounds);
            widths[column] = widths[column].max(hi[0] - lo[0]);
            heights[row] = heights[row].max(hi[1] - lo[1]);
        }
        [widths, heights]
    }

    fn scale(&self, views: &[(View, usize, usize); 3], groups: &[Vec<Group>; 3]) -> Result<Scale, DrawError> {
        let [widths, heights] = self.sizes(views);
        let mut texts = [0.0f64; 2];
        for ((_, column, _), groups) in views.iter().zip(groups) {
            let widest = groups.iter().map(|group| label::width(&group.text)).fold(0.0, f64::max);
            texts[*column] = texts[*column].max(if widest > 0.0 { widest + GAP + 8.0 } else { GAP });
        }
        let ([width, height], chains) = (self.paper, self.chains());
        let room = [
            width - 2.0 * MARGIN - SPACE - chains[0] - texts[0] - texts[1],
            height - 2.0 * MARGIN - 2.0 * NAME - SPACE - chains[1] - TITLE - GAP,
        ];
        let most = (room[0] / (widths[0] + widths[1])).min(room[1] / (heights[0] + heights[1]));
        let scale = Scale::below(most, self.unit).filter(|_| room.iter().all(|room| *room > 0.0));
        let Some(pixels) = scale else {
            let problem = format!("a sheet of {width} x {height} is too small");
            let message = Message::new(problem, "the dimensions leave no room for the views");
            return Err(DrawError::Option(message.suggest("Give a larger size.")));
        };
        let spare = [0, 1].map(|k| {
            let own = [widths, heights][k];
            (room[k] - pixels.pixels * (own[0] + own[1])).max(0.0)
        });
        // the rest is divided among the space around the views
        let x0 = MARGIN + SPACE + chains[0] + 0.2 * spare[0];
        let x1 = x0 + pixels.pixels * widths[0] + texts[0] + 0.4 * spare[0];
        let y0 = MARGIN + NAME + 0.3 * spare[1];
        let y1 = y0 + pixels.pixels * heights[0] + NAME + GAP + 0.3 * spare[1];
        Ok(pixels.at([x0, x1], [y0, y1]))
    }

    fn panel(&self, view: View, [column, row]: [usize; 2], scale: &Scale) -> Panel {
        let plane = plane(view, self.bounds.centre());
        let [lo, hi] = window(&plane, &self.bounds);
        let size = [0, 1].map(|k| scale.pixels * (hi[k] - lo[k]));
        Panel::new(view, plane, [lo, hi], [scale.columns[column], scale.rows[row], size[0], size[1]])
    }
}

/// True if a view shows the size of a fillet or chamfer: the first of those from the front, from above and from a side that shows its
/// profile.
fn is_seen_in(face: &CornerFace, view: View) -> bool {
    let is_profile = |view: View| {
        let (forward, _) = view.forward_and_up();
        match face.place {
            CornerPlace::Ring { axis, .. } => forward.dot(axis).abs() < 1e-9,
            CornerPlace::Edge { along, .. } => forward.dot(along).abs() > 1.0 - 1e-9,
        }
    };
    let is_earlier = |other: View| other != view && is_profile(other);
    is_profile(view)
        && match view {
            View::Front => true,
            View::Top => !is_earlier(View::Front),
            _ => !is_earlier(View::Front) && !is_earlier(View::Top),
        }
}

/// The plane of a view through a point.
fn plane(view: View, point: Vec3) -> Cut {
    let (forward, up) = view.forward_and_up();
    let across = forward.cross(up);
    // the upward direction of the view at a slant is not perpendicular to the line of sight
    Cut::new(point, across, across.cross(forward))
        .unwrap_or_else(|_| unreachable!("the axes of views are perpendicular"))
}

/// The corners of a box in a plane.
fn window(plane: &Cut, bounds: &Bounds) -> [[f64; 2]; 2] {
    let [u, v] = [0, 1].map(|k| plane.range(bounds, k));
    [[u[0], v[0]], [u[1], v[1]]]
}

/// A view with a margin, off the symmetry of the model: no ray runs along an edge that is parallel to the view.
fn edge_view(plane: &Cut, [lo, hi]: [[f64; 2]; 2], step: f64) -> EdgeView {
    let window = [lo.map(|x| x - 2.317 * step), hi.map(|x| x + 2.683 * step)];
    EdgeView { plane: *plane, is_behind: false, window, step }
}

/// A drawing in progress.
struct Drawing<'a> {
    sheet: &'a Sheet<'a>,
    scale: &'a Scale,
    svg: Svg,
}

impl Drawing<'_> {
    fn view<E: Evaluator>(
        &mut self,
        evaluator: &E,
        panel: &Panel,
        groups: &[Group],
        run: &mut Run<'_>,
    ) -> Result<(), DrawError> {
        let [left, top, right, _] = panel.sides();
        let name = panel.view.name();
        self.svg.text("name", [left, top - 8.0], Anchor::Start, name, name);
        let view = edge_view(&panel.plane, panel.window, 1.0 / self.scale.pixels);
        let cancelled = |_| DrawError::Render(RenderError::Cancelled);
        let Edges { visible, hidden } =
            all_edges(evaluator, &view, run.threads, &run.cancel).map_err(cancelled)?;
        for line in hidden {
            self.svg.path("hidden", panel.path(&line), "");
        }
        for line in visible {
            self.svg.path("edge", panel.path(&line), "");
        }
        panel.centre_lines(&mut self.svg, (self.sheet.faces, &self.sheet.axial.polygons), groups);
        label::draw(&mut self.svg, panel, groups, right + GAP);
        self.dimensions(panel);
        Ok(())
    }

    /// The sizes of a view, and the distances of its steps.
    fn dimensions(&mut self, panel: &Panel) {
        let sides = panel.sides();
        let resolution = self.sheet.resolution();
        let value = |length: f64| crate::axis::format_number(length, resolution);
        let [width, height] = [0, 1].map(|k| value(panel.window[1][k] - panel.window[0][k]));
        // each size once: width and height in front, the depth in the view from above
        let (width, height) = match panel.view {
            View::Front => (Some(width), Some(height)),
            View::Top => (None, Some(height)),
            _ => (None, None),
        };
        // the coordinate of the plane along each chain
        let chains = match panel.view {
            View::Front => vec![(0, 0), (2, 1)],
            View::Top => vec![(1, 1)],
            _ => Vec::new(),
        };
        let mut farther = [0.0; 2];
        for (axis, coordinate) in chains {
            let levels = self.sheet.levels(axis);
            if levels.is_empty() {
                continue;
            }
            let mut texts: Vec<String> = levels.windows(2).map(|pair| value(pair[1] - pair[0])).collect();
            let place = |level: &f64| {
                let mut at = [0.0; 2];
                at[coordinate] =
                    panel.plane.axes()[coordinate][axis] * (level - self.sheet.bounds.centre()[axis]);
                panel.position(at)[coordinate]
            };
            let mut positions: Vec<f64> = levels.iter().map(place).collect();
            if positions[0] > positions[1] {
                positions.reverse();
                texts.reverse();
            }
            dimension::chain(&mut self.svg, sides, coordinate == 1, &positions, &texts);
            farther[1 - coordinate] = dimension::ROW;
        }
        dimension::draw_sides(&mut self.svg, sides, (width.as_deref(), height.as_deref()), farther);
    }

    /// The view at a slant, in the free corner.
    fn slanted<E: Evaluator>(
        &mut self,
        evaluator: &E,
        projection: ProjectionMethod,
        run: &mut Run<'_>,
    ) -> Result<(), DrawError> {
        let plane = plane(View::Iso, self.sheet.bounds.centre());
        let outer = window(&plane, &self.sheet.bounds);
        let [width, height] = self.sheet.paper;
        let (x, right) = (self.scale.columns[1], width - MARGIN);
        let (top, bottom) = match projection {
            ProjectionMethod::ThirdAngle => (MARGIN + NAME, self.scale.rows[1] - NAME - 8.0),
            ProjectionMethod::FirstAngle => (self.scale.rows[1], height - MARGIN - TITLE),
        };
        if right - x < 40.0 || bottom - top < 40.0 {
            return Ok(());
        }
        let lengths = [0, 1].map(|k| outer[1][k] - outer[0][k]);
        let step = (lengths[0] / (right - x)).max(lengths[1] / (bottom - top));
        let view = edge_view(&plane, outer, step);
        let lines = all_edges(evaluator, &view, run.threads, &run.cancel)
            .map_err(|_| DrawError::Render(RenderError::Cancelled))?
            .visible;
        let (mut lo, mut hi) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in lines.iter().flatten() {
            for k in 0..2 {
                (lo[k], hi[k]) = (lo[k].min(point[k]), hi[k].max(point[k]));
            }
        }
        if lo[0] < hi[0] && lo[1] < hi[1] {
            let panel = Panel::new(View::Iso, plane, [lo, hi], [x, top, right - x, bottom - top]);
            for line in &lines {
                self.svg.path("edge", panel.path(line), "");
            }
        }
        Ok(())
    }

    /// The title, the scale, the unit and the symbol of the projection.
    fn footer(&mut self, title: &str, projection: ProjectionMethod) {
        let [width, height] = self.sheet.paper;
        let y = height - MARGIN;
        let frame = format!("M{MARGIN} {:.2}H{:.2}", y - TITLE + 10.0, width - MARGIN);
        self.svg.path("dimension", frame, "");
        self.svg.text("title", [MARGIN, y], Anchor::Start, title, title);
        let facts = format!(
            "scale {}  \u{b7}  lengths in {}  \u{b7}  {projection}",
            self.scale.text(),
            if self.sheet.unit == Unit::Inch { "inches" } else { self.sheet.unit.symbol() }
        );
        self.svg.text("name", [width - MARGIN - 58.0, y], Anchor::End, &facts, &facts);
        symbol(&mut self.svg, [width - MARGIN - 24.0, y - 5.0], projection);
    }
}

#[cfg(test)]
mod tests;
