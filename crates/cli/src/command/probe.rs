//! `rayweave probe`: crossings and media along one ray.

use crate::arguments::{ModelArguments, SubjectArguments, point};
use crate::drawing;
use crate::failure::Failure;
use crate::terminal::{self, short, short_point};
use clap::Args;
use rayweave::draw::ray_timeline;
use rayweave::model::{Collected, Face, attributes};
use rayweave::shape::RayError;
use rayweave::{AnyEvaluator, Compiled, Crossing, Evaluator, Query, Ray, Vec3, Weave, Window};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Show the crossings and media along one ray
///
/// The ray is the whole line through two points, in both directions; t is 0 at the first point and 1 at the second.
#[derive(Args)]
pub struct Probe {
    #[command(flatten)]
    model: ModelArguments,

    #[command(flatten)]
    subject: SubjectArguments,

    /// The point where t = 0
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    from: [f64; 3],

    /// The point where t = 1
    #[arg(long, value_name = "X,Y,Z", value_parser = point, allow_hyphen_values = true)]
    to: [f64; 3],

    /// Show only the part between the two points
    #[arg(long)]
    segment: bool,

    /// Explain the answer, decision by decision, in at most this many lines ("all" for no limit)
    #[arg(
        long, value_name = "LINES", conflicts_with = "json", value_parser = lines,
        num_args = 0..=1, require_equals = true, default_missing_value = "1000"
    )]
    explain: Option<usize>,

    /// Print JSON, with all digits
    #[arg(long)]
    json: bool,

    /// Draw the intervals of all leaves and of the result as SVG
    #[arg(long, value_name = "OUT.svg")]
    timeline: Option<PathBuf>,
}

impl Probe {
    pub fn run(&self) -> Result<(), Failure> {
        let ray = self.ray()?;
        self.timeline.as_deref().map_or(Ok(()), drawing::check_svg)?;
        let scene = self.model.load()?;
        let compiled = Compiled::named(&scene, self.subject.solid.as_deref())?;
        let evaluator = AnyEvaluator::new(self.subject.evaluator.as_deref(), compiled.program.clone())?;
        let window = match self.segment {
            true => Window::new(0.0, 1.0)?,
            false => Window::ALL,
        };
        let query = Query { window, ..Query::default() };
        let found = Found {
            unit: scene.unit.symbol(),
            compiled: &compiled,
            ray,
            answer: evaluator.one(ray, &query)?,
        };
        if let Some(path) = &self.timeline {
            let solid = self.subject.solid.as_deref();
            let mut drawing = ray_timeline(&scene, solid, &compiled, ray, Weave::new)?;
            drawing.title(&self.heading());
            if self.segment {
                drawing.window(0.0, 1.0).map_err(rayweave::Error::from)?;
            }
            terminal::save(path, drawing.to_svg().as_bytes())?;
        }
        terminal::print(&match (self.json, self.explain) {
            (true, _) => format!("{:#}\n", self.as_json(&found)),
            (false, None) => self.as_text(&found),
            (false, Some(lines)) => {
                let explanation = rayweave::explain(&compiled.program, ray, window)?;
                format!("{}\n{}", self.as_text(&found), explanation.text(lines))
            }
        })
    }

    fn ray(&self) -> Result<Ray, Failure> {
        let (from, to) = (Vec3::from(self.from), Vec3::from(self.to));
        let ray = Ray::new(from, to - from);
        let problem = match ray.check() {
            Ok(()) => return Ok(ray),
            _ if !ray.direction.is_finite() => "are too far apart: their distance overflows.".to_owned(),
            Err(RayError::NoDirection) => "are the same point: a ray needs two different points.".to_owned(),
            Err(error) => format!("define a ray that cannot be traced: {error}"),
        };
        Err(Failure::Usage(format!("--from and --to {problem}")))
    }

    fn heading(&self) -> String {
        let what = match (&self.subject.solid, self.segment) {
            (None, false) => "line".to_owned(),
            (None, true) => "segment".to_owned(),
            (Some(name), false) => format!("{name} on the line"),
            (Some(name), true) => format!("{name} on the segment"),
        };
        let (from, to) = (short_point(self.from), short_point(self.to));
        format!("{}: {what} from {from} to {to}", self.model.name())
    }

    fn as_text(&self, found: &Found<'_>) -> String {
        let (length, unit) = (short(found.ray.direction.length()), found.unit);
        let start = found.compiled.medium_name(found.answer.starts[0]);
        let mut text = self.heading() + "\n";
        text += &format!("t = 1 is {length} {unit}; the ray starts in {start}\n\n");
        match found.answer.crossings.is_empty() {
            true => text += "no crossings\n",
            false => text += &found.table(),
        }
        text
    }

    fn as_json(&self, found: &Found<'_>) -> Value {
        let window = match self.segment {
            true => json!([0.0, 1.0]),
            false => json!([null, null]),
        };
        let start = found.answer.starts[0];
        json!({
            "model": self.model.name(),
            "unit": found.unit,
            "solid": self.subject.solid,
            "origin": found.ray.origin.to_array(),
            "direction": found.ray.direction.to_array(),
            "window": window,
            "start": {
                "region": found.compiled.region_name(start),
                "medium": found.compiled.medium_name(start),
            },
            "crossings": found.crossings().enumerate().map(|(k, c)| found.row_json(k, c)).collect::<Vec<_>>(),
        })
    }
}

/// Parses a number of lines, at least 1, or "all".
fn lines(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(0) | Err(_) if text != "all" => {
            Err("a number of lines is a whole number of at least 1, or all".to_owned())
        }
        Ok(number) => Ok(number),
        Err(_) => Ok(usize::MAX),
    }
}

/// Crossings of a ray.
struct Found<'a> {
    unit: &'static str,
    compiled: &'a Compiled,
    ray: Ray,
    answer: Collected,
}

impl Found<'_> {
    fn crossings(&self) -> impl Iterator<Item = &Crossing> {
        self.answer.of(0).iter()
    }

    fn face(&self, face: Face) -> String {
        let program = &self.compiled.program;
        program.leaf(face.leaf).face_name(face.facet as usize)
    }

    /// The faces of the regions that the ray leaves and enters, except for the world.
    fn sides(&self, crossing: &Crossing) -> [Option<String>; 2] {
        let of = |region, face| self.compiled.region_name(region).map(|_| self.face(face));
        [of(crossing.before, crossing.left), of(crossing.after, crossing.entered)]
    }

    fn table(&self) -> String {
        let header = ["#", "t", "point", "normal", "surface", "region", "medium"];
        let rows: Vec<Vec<String>> =
            self.crossings().enumerate().map(|(k, crossing)| self.row(k, crossing)).collect();
        let is_number = [true, true, false, false, false, false, false];
        terminal::table(&header, &rows, &is_number)
    }

    fn row(&self, number: usize, crossing: &Crossing) -> Vec<String> {
        let normal = attributes::normal(&self.compiled.program, &self.ray, crossing);
        let surface = match self.sides(crossing) {
            [Some(left), Some(entered)] if left != entered => format!("{left} | {entered}"),
            _ => self.face(crossing.face).to_owned(),
        };
        let name = |region| self.compiled.region_name(region);
        let region = match (name(crossing.before), name(crossing.after)) {
            (None, Some(after)) => format!("enters {after}"),
            (Some(before), None) => format!("leaves {before}"),
            (before, after) => format!("{} > {}", before.unwrap_or(""), after.unwrap_or("")),
        };
        let medium = |region| self.compiled.medium_name(region);
        vec![
            number.to_string(),
            short(crossing.t),
            short_point(attributes::point(&self.ray, crossing).to_array()),
            short_point(normal.to_array()),
            surface,
            region,
            format!("{} > {}", medium(crossing.before), medium(crossing.after)),
        ]
    }

    fn row_json(&self, number: usize, crossing: &Crossing) -> Value {
        let [left, entered] = self.sides(crossing);
        let name = |region| self.compiled.region_name(region);
        let medium = |region| self.compiled.medium_name(region);
        json!({
            "crossing": number,
            "t": crossing.t,
            "point": attributes::point(&self.ray, crossing).to_array(),
            "normal": attributes::normal(&self.compiled.program, &self.ray, crossing).to_array(),
            "enters": crossing.enters(),
            "surface": self.face(crossing.face),
            "surface_left": left,
            "surface_entered": entered,
            "solid": name(if crossing.enters() { crossing.after } else { crossing.before }),
            "region_before": name(crossing.before),
            "region_after": name(crossing.after),
            "medium_before": medium(crossing.before),
            "medium_after": medium(crossing.after),
        })
    }
}
