//! Light through a medium with a gradient, from one event to the next.

use crate::generation::{Generation, Met, Traveller};
use crate::gradient::LocalField;
use crate::gradient::collocation::{Step, Stepped};
use crate::interface::Stokes;
use crate::medium::Medium;
use crate::segments::{Event, Segment};
use crate::system::{Substance, System};
use crate::trace::{Worker, against};
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Crossing, Evaluator, RegionId, Start, StartLists, dress};
use rayweave_shape::Ray;
use rayweave_shape::surface::delta_of;
use rayweave_space::{CurveTrace, trace_curve_from};

/// Light that has not come out of a medium after so many steps is not followed any more.
const MOST_STEPS: usize = 10_000;

/// How often a step is shortened whose polynomial is not found to be a curve that can be asked.
const MOST_TRIES: usize = 8;

/// The solids, and the sheets by their numbers, on which light is, with its side of each.
#[derive(Default)]
struct Sides {
    solids: Vec<Start>,
    sheets: Vec<(usize, Vec<Start>)>,
}

/// A step and what is met on it.
struct Stretch {
    step: Step,
    /// The face that ends it, if one does.
    face: Option<Crossing>,
    /// Crossings of sheets, in order.
    sheets: Vec<(usize, Crossing)>,
    /// How long the next step should be.
    next: f64,
}

impl Substance {
    /// The medium, if light is bent in it.
    pub(crate) fn graded(&self) -> Option<&Medium> {
        match self {
            Substance::Transparent(medium) if medium.gradient().is_some() => Some(medium),
            _ => None,
        }
    }
}

impl<E: Evaluator> Worker<'_, E> {
    /// True if a ray sets out in a medium with a gradient.
    pub(crate) fn is_bent(&self, met: &Met, i: usize) -> bool {
        self.tracer.system.substance(RegionId(met.before[i])).graded().is_some()
    }

    /// Takes a ray through a medium with a gradient to the end of what happens in it.
    pub(crate) fn bend(&mut self, now: &Generation, met: &Met, i: usize) {
        let (system, region) = (self.tracer.system, RegionId(met.before[i]));
        let mut light = now.get(i);
        let wavelength_nm = light.packet.wavelength_nm;
        let Some(medium) = system.substance(region).graded() else { return };
        let Some(gradient) = medium.gradient() else { return };
        let field = LocalField { gradient, index: medium.index(wavelength_nm).re, wavelength_nm };
        let mut sides = Sides::of(now, i);
        let mut velocity = field.index_at(light.ray.origin) * light.ray.direction;
        let mut wanted = first_duration(&field, &light.ray, system.around());
        for steps in 0..MOST_STEPS {
            let longest = longest(light.ray.origin, system.around()) / velocity.length();
            if has_left(&light.ray, system.around()) {
                self.forget_piece(steps);
                return self.escape(&light, region, 0.0);
            }
            let duration = wanted.min(longest);
            let Some(stretch) = self.stretch(&field, (light.ray.origin, velocity), duration, &mut sides)
            else {
                break;
            };
            self.forget_piece(steps);
            if !self.go_along(&field, region, &mut light, &stretch) {
                return;
            }
            velocity = stretch.step.velocity_at(stretch.step.duration());
            wanted = stretch.next;
        }
        self.balance.dropped += light.packet.power;
    }

    /// The row before is the end of its light no more.
    fn forget_piece(&mut self, steps: usize) {
        if steps > 0 {
            self.forget_way();
        }
    }

    /// A step and what is met on it; `None` where the gradient gives no way to go on.
    fn stretch(
        &mut self,
        field: &LocalField<'_>,
        (from, velocity): (Vec3, Vec3),
        mut duration: f64,
        sides: &mut Sides,
    ) -> Option<Stretch> {
        for _ in 0..MOST_TRIES {
            let Stepped { step, next } = Step::take(field, from, velocity, duration)?;
            let end = step.duration();
            let program = &self.tracer.system.program;
            if let Ok(found) = trace_curve_from(program, &step, 0.0, end, &mut sides.solids) {
                let sheets = self.sheets_on(&step, &mut sides.sheets);
                return Some(Stretch { face: first(&found), step, sheets, next });
            }
            duration = 0.25 * end;
        }
        None
    }

    /// The sheets that a step crosses.
    fn sheets_on(&self, step: &Step, sides: &mut Vec<(usize, Vec<Start>)>) -> Vec<(usize, Crossing)> {
        let mut found = Vec::new();
        let around = step.bounds();
        let old = std::mem::take(sides);
        for (sheet, plate) in self.tracer.system.plates.iter().enumerate() {
            let room = 1e3 * delta_of(step.size());
            if plate.bounds.grown(room).intersection(&around).is_empty() {
                continue;
            }
            let known = old.iter().find(|(known, _)| *known == sheet);
            let mut sides_of = known.map_or(Vec::new(), |(_, sides)| sides.clone());
            // a step that the solids could be asked about is a curve for every program
            let trace = trace_curve_from(&plate.program, step, 0.0, step.duration(), &mut sides_of);
            let crossings = trace.map_or(Vec::new(), |trace| trace.crossings);
            let through = crossings.into_iter().filter(|c| c.before.0 != 0 && c.after.0 != 0);
            found.extend(through.map(|crossing| (sheet, crossing)));
            sides.push((sheet, sides_of));
        }
        found.sort_by(|a, b| a.1.t.total_cmp(&b.1.t));
        found
    }

    /// Takes light along a step; false if that was its end, or it goes on otherwise.
    fn go_along(
        &mut self,
        field: &LocalField<'_>,
        region: RegionId,
        light: &mut Traveller,
        stretch: &Stretch,
    ) -> bool {
        let step = &stretch.step;
        let end = stretch.face.map_or(step.duration(), |crossing| crossing.t);
        // what lies in a face of a solid comes first
        let slack = match stretch.face {
            Some(_) => delta_of(step.size()) / step.velocity_at(end).length(),
            None => 0.0,
        };
        let mut from = 0.0;
        for (sheet, crossing) in stretch.sheets.iter().filter(|(_, met)| met.t <= end + slack) {
            let t = crossing.t.min(end);
            let row = self.carry(field, region, light, step, (from, t));
            let crossing = Crossing { t: 0.0, ..*crossing };
            if !self.meet_sheet(light, row, *sheet, &crossing, 0.0) {
                return false;
            }
            self.forget_way();
            from = t;
        }
        let row = self.carry(field, region, light, step, (from, end));
        let Some(crossing) = stretch.face else {
            light.packet.parent = self.record_piece(row);
            return true;
        };
        let crossing = Crossing { t: 0.0, ..crossing };
        let normal = dress::normal(&self.tracer.system.program, &light.ray, &crossing);
        self.meet_face(light, row, &crossing, against(normal, light.ray.direction));
        false
    }

    /// A piece of a curve that ends in the middle of the medium.
    fn record_piece(&mut self, row: Segment) -> i64 {
        self.rows.single.push(Segment { event: Event::Curved, ..row });
        self.parent_of_next()
    }

    /// Brings light from one time of a step to a later one, where it is left with the tangent as its ray; the row for that
    /// piece lacks what is met at its end.
    fn carry(
        &mut self,
        field: &LocalField<'_>,
        region: RegionId,
        light: &mut Traveller,
        step: &Step,
        (from, to): (f64, f64),
    ) -> Segment {
        let optics = self.optics(region, light.packet.wavelength_nm);
        let (mut length, mut path) = (0.0, 0.0);
        for (t, weight) in step.quadrature(from, to) {
            let squared = field.at(step.at(t)).squared;
            length += weight * squared.sqrt();
            path += weight * squared;
        }
        let intensity = light.packet.power;
        light.packet.path += path;
        self.dim(light, optics, length);
        light.stokes = light.stokes.map(|stokes| transported(stokes, step, (from, to)));
        let start = if from == 0.0 { light.ray.origin } else { step.at(from) };
        light.ray = Ray::new(step.at(to), step.velocity_at(to).normalize());
        let index = field.index_at(light.ray.origin);
        let row = light.segment((0.0, 0.0), intensity, index);
        Segment { start, ..row }
    }
}

impl Sides {
    /// Those of a ray of a generation.
    fn of(now: &Generation, i: usize) -> Sides {
        let solids = now.lists().map_or(Vec::new(), |lists: StartLists<'_>| lists.of(i).to_vec());
        let on = now.on_sheets.iter().filter(|on| on.ray == i);
        Sides { solids, sheets: on.map(|on| (on.sheet, vec![on.start])).collect() }
    }
}

fn first(found: &CurveTrace) -> Option<Crossing> {
    found.crossings.first().copied()
}

/// The axis of polarisation, carried along a curve without turning about it (Rytov's law: Born & Wolf, section 3.1.3, for
/// the transport of the field vectors), by the double reflection of Wang, Jüttler, Zheng & Liu (ACM Trans. Graph. 27, 2, 2008).
fn transported(stokes: Stokes, step: &Step, (from, to): (f64, f64)) -> Stokes {
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

/// How far a step may go: once through all that there is.
fn longest(from: Vec3, around: &Bounds) -> f64 {
    let all = around.size().length();
    if all.is_finite() && !around.is_empty() { all } else { 10.0 * (1.0 + from.length()) }
}

/// Half a radian of the fastest oscillation about the start, by how the force changes nearby.
fn first_duration(field: &LocalField<'_>, ray: &Ray, around: &Bounds) -> f64 {
    let (from, length) = (ray.origin, longest(ray.origin, around));
    let near = 1e-3 * length;
    let (u, v) = ray.direction.any_orthonormal_pair();
    let here = field.at(from).force;
    let change = |along: Vec3| (field.at(from + near * along).force - here).length() / near;
    let square = [ray.direction, u, v].into_iter().map(change).fold(0.0, f64::max);
    // where the force does not change this is infinite, or NaN where there is none
    (0.5 / square.sqrt()).min(length / field.index_at(from))
}

/// True if light is outside of the box of all that there is and goes away from it.
fn has_left(ray: &Ray, around: &Bounds) -> bool {
    if around.is_empty() {
        return true;
    }
    let aside = ray.origin - ray.origin.clamp(around.lo, around.hi);
    aside.dot(ray.direction) > 0.0
}

impl System {
    /// The box around all solids and sheets.
    pub(crate) fn around(&self) -> &Bounds {
        &self.around
    }
}
