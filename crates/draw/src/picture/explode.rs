//! Exploded views: regions moved apart along an axis.

use super::AXES;
use crate::DrawError;
use rayweave_error::Message;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Program, Solid};
use rayweave_scene::Scene;
use std::str::FromStr;

/// An exploded view: regions are moved along an axis, in the order of the centres of their bounding boxes, until a gap separates
/// each one from the regions in its way. Regions that are next to each other stay so.
///
/// Parses the axis, optionally with the gap as a fraction of the longest side of the model: `z`, `x:0.3`. The default gap is
/// [`Explosion::GAP`].
///
/// ```
/// use rayweave_draw::picture::Explosion;
/// use rayweave_scene::Compiled;
///
/// // a ball of radius 1 in a shell of radius 2
/// let (_, nest) = rayweave_scene::parse(
///     "rayweave = 1\n[solid.shell]\nsphere = { radius = 2 }\n[solid.core]\nsphere = { radius = 1 }\n\
///      [[region]]\nsolid = \"shell\"\n[[region]]\nsolid = \"core\"",
/// )?;
/// let apart: Explosion = "z:0.25".parse()?;
/// let bounds = Compiled::new(&apart.apply(&nest)?)?.program.bounds();
/// // 4 of the shell, a gap of 1, 2 of the core
/// assert!((bounds.size().z - 7.0).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Explosion {
    axis: usize,
    gap: f64,
}

/// A region with its bounding box.
struct Part {
    number: usize,
    bounds: Bounds,
}

impl Explosion {
    /// The default gap, as a fraction of the longest side of the model.
    pub const GAP: f64 = 0.1;

    /// The maximum number of regions. The time is quadratic in their number.
    pub const MAX_REGIONS: usize = 20_000;

    /// The exploded scene. Later regions are first subtracted from earlier ones, so that nothing appears twice. The camera of the
    /// scene is dropped, because its target has moved.
    ///
    /// # Errors
    ///
    /// [`DrawError::Option`] for an unbounded region or too many regions, [`DrawError::Compile`].
    pub fn apply(&self, scene: &Scene) -> Result<Scene, DrawError> {
        let regions = scene.regions.len();
        if regions > Explosion::MAX_REGIONS {
            let most = Explosion::MAX_REGIONS;
            let problem = format!("an exploded view of {regions} regions");
            return Err(DrawError::Option(Message::new(problem, format!("the maximum is {most} regions"))));
        }
        let program = Program::compile_regions(&scene.model_regions())?;
        let boxes = program.region_bounds();
        self.check(scene, &boxes)?;
        let gap = self.gap * program.bounds().size().max_element().max(0.0);
        let shifts = self.shifts(&boxes, gap);
        let mut apart = scene.clone();
        for (number, region) in apart.regions.iter_mut().enumerate() {
            let later = number + 1..regions;
            let overlapping = later.filter(|&other| !boxes[number].intersection(&boxes[other]).is_empty());
            let taken: Vec<Solid> = overlapping.map(|other| scene.regions[other].solid.clone()).collect();
            let left =
                if taken.is_empty() { region.solid.clone() } else { &region.solid - Solid::union(taken) };
            region.solid = left.translate(Vec3::AXES[self.axis] * shifts[number]);
        }
        apart.camera = None;
        Ok(apart)
    }

    fn check(&self, scene: &Scene, boxes: &[Bounds]) -> Result<(), DrawError> {
        let unbounded = boxes.iter().position(|own| !own.is_empty() && !own.is_finite());
        match unbounded {
            None => Ok(()),
            Some(number) => {
                let name = &scene.regions[number].name;
                let problem = format!("region `{name}` cannot be exploded");
                let message = Message::new(problem, "it is unbounded");
                Err(DrawError::Option(message.suggest("Intersect it with a box")))
            }
        }
    }

    /// The shift of each region along the axis.
    fn shifts(&self, boxes: &[Bounds], gap: f64) -> Vec<f64> {
        let solid = boxes.iter().enumerate().filter(|(_, own)| !own.is_empty());
        let mut waiting: Vec<Part> = solid.map(|(number, &bounds)| Part { number, bounds }).collect();
        let middle = |part: &Part| part.bounds.centre()[self.axis];
        // a stable sort: of two regions with the same centre, the earlier one comes first, since the later one may be carved into it
        waiting.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
        let mut shifts = vec![0.0; boxes.len()];
        let mut placed: Vec<Part> = Vec::new();
        for mut part in waiting {
            let before = placed.iter().filter(|other| self.is_in_the_way(&part.bounds, &other.bounds));
            let ends = before.map(|other| other.bounds.hi[self.axis] + gap - part.bounds.lo[self.axis]);
            let shift = ends.fold(0.0, f64::max);
            part.bounds.lo[self.axis] += shift;
            part.bounds.hi[self.axis] += shift;
            shifts[part.number] = shift;
            placed.push(part);
        }
        shifts
    }

    /// True if the projections of two boxes along the axis overlap; contact does not count.
    fn is_in_the_way(&self, a: &Bounds, b: &Bounds) -> bool {
        let across = (0..3).filter(|&axis| axis != self.axis);
        across.into_iter().all(|axis| a.lo[axis] < b.hi[axis] && b.lo[axis] < a.hi[axis])
    }
}

impl FromStr for Explosion {
    type Err = DrawError;

    fn from_str(text: &str) -> Result<Explosion, DrawError> {
        let (name, gap) = text.split_once(':').unwrap_or((text, ""));
        let axis = AXES.iter().position(|axis| *axis == name.trim());
        let gap = if gap.is_empty() { Ok(Explosion::GAP) } else { gap.trim().parse() };
        match (axis, gap) {
            (Some(axis), Ok(gap)) if (0.0..=1e3).contains(&gap) => Ok(Explosion { axis, gap }),
            _ => {
                let reason = "it is x, y or z, with a gap from 0 to 1000 as a fraction of the longest side of the model";
                let problem = format!("`{text}` is not a direction of an exploded view");
                Err(DrawError::Option(Message::new(problem, format!("{reason}, such as z:0.2"))))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_read() {
        assert_eq!("z".parse::<Explosion>().unwrap(), Explosion { axis: 2, gap: 0.1 });
        assert_eq!("x : 0.5".parse::<Explosion>().unwrap(), Explosion { axis: 0, gap: 0.5 });
        for text in ["", "w", "z:", "z:-1", "z:nan", "z:inf", "z:1e4"] {
            let error = text.parse::<Explosion>();
            match text {
                "z:" => assert!(error.is_ok()),
                _ => assert!(error.unwrap_err().to_string().contains("such as z:0.2"), "{text}"),
            }
        }
    }

    /// Four screws above a plate rise together; a washer around one of them follows.
    #[test]
    fn adjacent_regions_stay_adjacent() {
        let part = |x: f64, lo: f64, hi: f64, half: f64| {
            Bounds::new(Vec3::new(x - half, -half, lo), Vec3::new(x + half, half, hi))
        };
        let boxes = [part(0.0, 0.0, 1.0, 10.0), part(-5.0, 0.5, 3.0, 1.0), part(5.0, 0.5, 3.0, 1.0)];
        let explosion = Explosion { axis: 2, gap: 0.0 };
        assert_eq!(explosion.shifts(&boxes, 2.0), [0.0, 2.5, 2.5]);
    }

    /// Boxes that are already apart stay where they are.
    #[test]
    fn separated_regions_stay() {
        let slab = |lo: f64| Bounds::new(Vec3::new(-1.0, -1.0, lo), Vec3::new(1.0, 1.0, lo + 1.0));
        let explosion = Explosion { axis: 2, gap: 0.0 };
        assert_eq!(explosion.shifts(&[slab(5.0), slab(0.0), Bounds::EMPTY], 1.0), [0.0; 3]);
    }
}
