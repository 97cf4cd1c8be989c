//! Propagation of light along curves in a gradient-index medium, from one event to the next.

use crate::gradient::LocalField;
use crate::gradient::collocation::{Step, Stepped};
use crate::interface::Stokes;
use crate::medium::Medium;
use crate::segments::{Event, Segment};
use crate::system::Substance;
use crate::trace::{Generation, Hits, Propagator, RayState, oriented_against};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Crossing, RegionId, Start, StartLists, attributes};
use rayweave_shape::Ray;
use rayweave_shape::surface::delta_of;
use rayweave_space::{CurveTrace, trace_curve_from};

/// The number of steps after which light that has not left a medium is dropped.
const MAX_STEPS: usize = 10_000;

/// The maximum number of times that a step is shortened if its polynomial violates its bounds as a
/// curve.
const MAX_TRIES: usize = 8;

/// The start lists of a step: the surfaces of solids, and of sheets by their numbers, with the side of each.
#[derive(Default)]
struct StepStarts {
    solids: Vec<Start>,
    sheets: Vec<(usize, Vec<Start>)>,
}

/// A step and its hits.
struct TracedStep {
    step: Step,
    /// The hit with a face that ends it, if there is one.
    face: Option<Crossing>,
    /// Crossings of sheets, in order.
    sheets: Vec<(usize, Crossing)>,
    /// The suggested duration of the next step.
    next: f64,
}

impl Substance {
    /// The medium, if it has a gradient index.
    pub(crate) fn graded(&self) -> Option<&Medium> {
        match self {
            Substance::Transparent(medium) if medium.gradient().is_some() => Some(medium),
            _ => None,
        }
    }
}

impl Propagator<'_> {
    /// True if a ray starts in a medium with a gradient.
    pub(crate) fn is_graded(&self, hits: &Hits, i: usize) -> bool {
        self.system.substance(RegionId(hits.solids.before[i])).graded().is_some()
    }

    /// Propagates a ray through a medium with a gradient to its next event.
    pub(crate) fn propagate_graded(&mut self, now: &Generation, hits: &Hits, i: usize) {
        let (system, region) = (self.system, RegionId(hits.solids.before[i]));
        let mut light = now.get(i);
        let wavelength_nm = light.payload.wavelength_nm;
        let Some(medium) = system.substance(region).graded() else { return };
        let Some(gradient) = medium.gradient() else { return };
        let field = LocalField { gradient, index: medium.index(wavelength_nm).re, wavelength_nm };
        let mut starts = StepStarts::of_ray(now, i);
        let mut velocity = field.index_at(light.ray.origin) * light.ray.direction;
        let mut wanted = first_duration(&field, &light.ray, &system.bounds);
        for steps in 0..MAX_STEPS {
            let longest = longest(light.ray.origin, &system.bounds) / velocity.length();
            if has_left(&light.ray, &system.bounds) {
                self.drop_piece_before_next(steps);
                return self.escape(&light, region, 0.0);
            }
            let duration = wanted.min(longest);
            let Some(traced) = self.trace_step(&field, (light.ray.origin, velocity), duration, &mut starts)
            else {
                break;
            };
            self.drop_piece_before_next(steps);
            if !self.propagate_step(&field, region, &mut light, &traced) {
                return;
            }
            velocity = traced.step.velocity_at(traced.step.duration());
            wanted = traced.next;
        }
        self.balance.dropped += light.payload.power;
    }

    /// Removes the row of the previous piece if only ends are kept.
    fn drop_piece_before_next(&mut self, steps: usize) {
        if steps > 0 {
            self.drop_row_before_next();
        }
    }

    /// Takes a step and finds its hits; `None` where the gradient has no solution.
    fn trace_step(
        &mut self,
        field: &LocalField<'_>,
        (from, velocity): (Vec3, Vec3),
        mut duration: f64,
        starts: &mut StepStarts,
    ) -> Option<TracedStep> {
        for _ in 0..MAX_TRIES {
            let Stepped { step, next } = Step::take(field, from, velocity, duration)?;
            let end = step.duration();
            let program = &self.system.program;
            if let Ok(found) = trace_curve_from(program, &step, 0.0, end, &mut starts.solids) {
                let sheets = self.sheets_on(&step, &mut starts.sheets);
                return Some(TracedStep { face: first(&found), step, sheets, next });
            }
            duration = 0.25 * end;
        }
        None
    }

    /// The crossings of sheets by a step.
    fn sheets_on(&self, step: &Step, starts: &mut Vec<(usize, Vec<Start>)>) -> Vec<(usize, Crossing)> {
        let mut found = Vec::new();
        let bounds = step.bounds();
        let old = std::mem::take(starts);
        for (sheet, compiled) in self.system.sheets.iter().enumerate() {
            let margin = 1e3 * delta_of(step.size());
            if compiled.bounds.grown(margin).intersection(&bounds).is_empty() {
                continue;
            }
            let known = old.iter().find(|(known, _)| *known == sheet);
            let mut own = known.map_or(Vec::new(), |(_, starts)| starts.clone());
            // a step that is a valid curve for the solids is one for every program
            let trace = trace_curve_from(&compiled.program, step, 0.0, step.duration(), &mut own);
            let crossings = trace.map_or(Vec::new(), |trace| trace.crossings);
            let through = crossings.into_iter().filter(|c| c.before.0 != 0 && c.after.0 != 0);
            found.extend(through.map(|crossing| (sheet, crossing)));
            starts.push((sheet, own));
        }
        found.sort_by(|a, b| a.1.t.total_cmp(&b.1.t));
        found
    }

    /// Propagates light along a step; false if the light ends or leaves the curve there.
    fn propagate_step(
        &mut self,
        field: &LocalField<'_>,
        region: RegionId,
        light: &mut RayState,
        traced: &TracedStep,
    ) -> bool {
        let step = &traced.step;
        let end = traced.face.map_or(step.duration(), |crossing| crossing.t);
        // a sheet within the tolerance of a face is crossed before the face
        let slack = match traced.face {
            Some(_) => delta_of(step.size()) / step.velocity_at(end).length(),
            None => 0.0,
        };
        let mut from = 0.0;
        for (sheet, crossing) in traced.sheets.iter().filter(|(_, met)| met.t <= end + slack) {
            let t = crossing.t.min(end);
            let row = self.travel_curve(field, region, light, step, (from, t));
            let crossing = Crossing { t: 0.0, ..*crossing };
            if !self.hit_sheet(light, row, *sheet, (&crossing, 0.0), &[]) {
                return false;
            }
            self.drop_row_before_next();
            from = t;
        }
        let row = self.travel_curve(field, region, light, step, (from, end));
        let Some(crossing) = traced.face else {
            light.payload.parent = self.record_piece(row);
            return true;
        };
        let crossing = Crossing { t: 0.0, ..crossing };
        let normal = attributes::normal(&self.system.program, &light.ray, &crossing);
        self.hit_face(light, row, (&crossing, oriented_against(normal, light.ray.direction)), &[]);
        false
    }

    /// Appends the row of a piece of a curve that ends within the medium, and returns the parent of the next.
    fn record_piece(&mut self, row: Segment) -> i64 {
        self.rows.single.push(Segment { event: Event::Curved, ..row });
        self.next_parent()
    }

    /// Moves light from one time of a step to a later one, with the tangent there as its ray, and
    /// returns the row, without element, surface and event.
    fn travel_curve(
        &mut self,
        field: &LocalField<'_>,
        region: RegionId,
        light: &mut RayState,
        step: &Step,
        (from, to): (f64, f64),
    ) -> Segment {
        let medium = self.optical_constants(region, light.payload.wavelength_nm);
        let (mut length, mut path) = (0.0, 0.0);
        for (t, weight) in step.quadrature(from, to) {
            let squared = field.at(step.at(t)).squared;
            length += weight * squared.sqrt();
            path += weight * squared;
        }
        let intensity = light.payload.power;
        light.payload.path += path;
        self.attenuate(light, medium, length);
        light.stokes = light.stokes.map(|stokes| parallel_transported(stokes, step, (from, to)));
        let start = if from == 0.0 { light.ray.origin } else { step.at(from) };
        light.ray = Ray::new(step.at(to), step.velocity_at(to).normalize());
        let index = field.index_at(light.ray.origin);
        let row = light.segment((0.0, 0.0), intensity, index);
        Segment { start, ..row }
    }
}

impl StepStarts {
    /// The start lists of a ray of a generation.
    fn of_ray(now: &Generation, i: usize) -> StepStarts {
        let solids = now.start_lists().map_or(Vec::new(), |lists: StartLists<'_>| lists.of(i).to_vec());
        let on = now.sheet_starts.iter().filter(|on| on.ray == i);
        StepStarts { solids, sheets: on.map(|on| (on.sheet, vec![on.start])).collect() }
    }
}

fn first(found: &CurveTrace) -> Option<Crossing> {
    found.crossings.first().copied()
}

/// The Stokes parameters after parallel transport of their axis along a curve (Rytov's law: Born &
/// Wolf, section 3.1.3, for the transport of the field vectors), by the double reflection method of
/// Wang, Jüttler, Zheng & Liu (ACM Trans. Graph. 27, 2, 2008).
fn parallel_transported(stokes: Stokes, step: &Step, (from, to): (f64, f64)) -> Stokes {
    const PARTS: usize = 16;
    let time = |k: usize| from + (to - from) * (k as f64 / PARTS as f64);
    let place = |t: f64| (step.at(t), step.velocity_at(t).normalize());
    let mirrored = |v: Vec3, across: Vec3| {
        let square = across.length_squared();
        if square > 0.0 { v - (2.0 * across.dot(v) / square) * across } else { v }
    };
    let (mut here, mut axis) = (place(from), stokes.axis);
    for k in 1..=PARTS {
        let next = place(time(k));
        let chord = next.0 - here.0;
        let tangent = mirrored(here.1, chord);
        axis = mirrored(mirrored(axis, chord), next.1 - tangent);
        here = next;
    }
    Stokes { axis, ..stokes }
}

/// The greatest length of a step: once through the bounding box of the system.
fn longest(from: Vec3, bounds: &Bounds) -> f64 {
    let all = bounds.size().length();
    if all.is_finite() && !bounds.is_empty() { all } else { 10.0 * (1.0 + from.length()) }
}

/// The duration of the first step: half a radian of the fastest oscillation about the start, from
/// the change of the force nearby.
fn first_duration(field: &LocalField<'_>, ray: &Ray, bounds: &Bounds) -> f64 {
    let (from, length) = (ray.origin, longest(ray.origin, bounds));
    let near = 1e-3 * length;
    let (u, v) = ray.direction.any_orthonormal_pair();
    let here = field.at(from).force;
    let change = |along: Vec3| (field.at(from + near * along).force - here).length() / near;
    let square = [ray.direction, u, v].into_iter().map(change).fold(0.0, f64::max);
    // infinite if the force does not change, NaN if there is none
    (0.5 / square.sqrt()).min(length / field.index_at(from))
}

/// True if light is outside the bounding box of the system and moves away from it.
fn has_left(ray: &Ray, bounds: &Bounds) -> bool {
    if bounds.is_empty() {
        return true;
    }
    let outward = ray.origin - ray.origin.clamp(bounds.lo, bounds.hi);
    outward.dot(ray.direction) > 0.0
}
