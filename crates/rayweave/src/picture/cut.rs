//! Cut-away views: models without one of their corners.

use crate::Error;
use crate::shapes::half_space;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Program, Solid};
use rayweave_scene::Scene;
use std::str::FromStr;

/// The part of space that is taken away from a model so that its inside shows: where all of some conditions hold.
///
/// As text, conditions are separated by commas. Each is `x`, `y` or `z`, `<` or `>`, and a length of the model or a part of
/// its box in percent, counted from the lower end: `x>0` takes away one half of space, `x>50%,y<50%` a quarter of the model.
///
/// ```
/// use rayweave::picture::Cut;
/// use rayweave::{AnyEvaluator, Compiled, Evaluator, Query, Ray, Vec3, scene};
///
/// let (_, ball) = scene::parse("rayweave = 1\n[solid.ball]\nsphere = { radius = 2 }")?;
/// let cut: Cut = "x > 75%, y < 0".parse()?;
/// let cut = Compiled::new(&cut.apply(&ball)?)?;
/// let along_x = Ray::new(Vec3::new(-5.0, -0.5, 0.0), Vec3::X);
/// let answer = AnyEvaluator::new(None, cut.program)?.one(along_x, &Query::default())?;
/// // three quarters of the way from -2 to 2
/// assert_eq!(answer.of(0)[1].t, 6.0);
/// # Ok::<(), rayweave::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Cut(Vec<Condition>);

/// What holds on one side of a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Condition {
    axis: usize,
    is_above: bool,
    place: Place,
}

/// Where a plane cuts an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Place {
    Length(f64),
    /// A part of the box of the model, 0 to 1.
    Part(f64),
}

pub(super) const AXES: [&str; 3] = ["x", "y", "z"];

impl Cut {
    /// The scene without that part: every solid loses it, so that the regions keep their places among one another.
    ///
    /// # Errors
    ///
    /// [`crate::ErrorKind::Value`] for a percentage along an axis along which the model has no end or is empty,
    /// [`crate::ErrorKind::Compile`].
    pub fn apply(&self, scene: &Scene) -> Result<Scene, Error> {
        let has_parts = self.0.iter().any(|condition| matches!(condition.place, Place::Part(_)));
        // lengths need no box, which takes a compilation
        let bounds = match has_parts {
            true => Program::compile_regions(&scene.model_regions())?.bounds(),
            false => Bounds::EMPTY,
        };
        let sides = self.0.iter().map(|condition| condition.side(&bounds));
        let corner = Solid::intersection(sides.collect::<Result<Vec<_>, _>>()?);
        let mut scene = scene.clone();
        for region in &mut scene.regions {
            region.solid = &region.solid - &corner;
        }
        Ok(scene)
    }
}

impl Condition {
    /// The half of space where it holds.
    fn side(&self, bounds: &Bounds) -> Result<Solid, Error> {
        let place = self.place(bounds)?;
        let along = Vec3::AXES[self.axis];
        match self.is_above {
            // a half space is what lies behind its normal
            true => half_space(-along, -place),
            false => half_space(along, place),
        }
    }

    fn place(&self, bounds: &Bounds) -> Result<f64, Error> {
        let part = match self.place {
            Place::Length(length) => return Ok(length),
            Place::Part(part) => part,
        };
        let (lo, hi) = (bounds.lo[self.axis], bounds.hi[self.axis]);
        if !bounds.is_empty() && lo.is_finite() && hi.is_finite() {
            return Ok(lo + part * (hi - lo));
        }
        let axis = AXES[self.axis];
        let why = if bounds.is_empty() { "is empty" } else { "has no end along it" };
        Err(Error::wish(format!("a cut at {} % of {axis} (the model {why}) give a length?", 100.0 * part)))
    }
}

impl FromStr for Cut {
    type Err = Error;

    fn from_str(text: &str) -> Result<Cut, Error> {
        text.split(',').map(condition).collect::<Result<_, _>>().map(Cut)
    }
}

fn condition(text: &str) -> Result<Condition, Error> {
    let text = text.trim();
    let problem = |why: &str| Error::wish(format!("the cut `{text}` {why}, as in x>0 or x>50%,y<50%"));
    let sign = text.find(['<', '>']).ok_or_else(|| problem("has neither < nor >"))?;
    let (name, place) = (text[..sign].trim(), text[sign + 1..].trim());
    let axis = AXES.iter().position(|axis| *axis == name);
    let axis = axis.ok_or_else(|| problem("does not begin with x, y or z"))?;
    let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    let place = match place.strip_suffix('%') {
        Some(percent) => number(percent).map(|percent| Place::Part(percent / 100.0)),
        None => number(place).map(Place::Length),
    };
    let place = place.ok_or_else(|| problem("does not end with a finite number"))?;
    Ok(Condition { axis, is_above: text.as_bytes()[sign] == b'>', place })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ErrorKind;

    #[test]
    fn conditions_are_read() {
        let expected = [
            Condition { axis: 0, is_above: true, place: Place::Part(0.5) },
            Condition { axis: 2, is_above: false, place: Place::Length(-1e-3) },
        ];
        assert_eq!("x>50%, z < -1e-3".parse::<Cut>().unwrap(), Cut(expected.to_vec()));
    }

    #[test]
    fn what_is_no_condition_is_told() {
        for text in ["", "x", "w>0", "x>", "x>nan", "x>1e999", "x>5%%", "x>1,", "x=1", "x<>1"] {
            let error = text.parse::<Cut>().unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Value, "{text}");
            assert!(error.to_string().contains("as in x>0"), "{error}");
        }
    }
}
