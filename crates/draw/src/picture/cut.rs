//! Cut-away views: models without a half, a quarter or an octant.

use super::AXES;
use crate::DrawError;
use rayweave_error::Message;
use rayweave_math::{Bounds, Vec3};
use rayweave_model::{Program, Solid};
use rayweave_scene::Scene;
use rayweave_shape::primitive::{HalfSpace, Primitive};
use std::str::FromStr;

/// A part of space that is removed from a model to show its interior: an intersection of half-spaces.
///
/// Parses conditions separated by commas. Each consists of `x`, `y` or `z`, `<` or `>`, and a coordinate of the model or a
/// percentage of its bounding box from the lower end: `x>0` removes half of space, `x>50%,y<50%` a quarter of the model.
///
/// ```
/// use rayweave_draw::picture::CutAway;
/// use rayweave_math::Vec3;
/// use rayweave_model::{Evaluator, Query};
/// use rayweave_scene::Compiled;
/// use rayweave_shape::Ray;
/// use rayweave_trace::AnyEvaluator;
///
/// let (_, ball) = rayweave_scene::parse("rayweave = 1\n[solid.ball]\nsphere = { radius = 2 }")?;
/// let cut: CutAway = "x > 75%, y < 0".parse()?;
/// let cut = Compiled::new(&cut.apply(&ball)?)?;
/// let along_x = Ray::new(Vec3::new(-5.0, -0.5, 0.0), Vec3::X);
/// let answer = AnyEvaluator::new(None, cut.program)?.one(along_x, &Query::default())?;
/// // three quarters of the way from -2 to 2
/// assert_eq!(answer.of(0)[1].t, 6.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct CutAway(Vec<Condition>);

/// A half-space perpendicular to an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Condition {
    axis: usize,
    is_above: bool,
    coordinate: Coordinate,
}

/// The coordinate of a plane perpendicular to an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Coordinate {
    Length(f64),
    /// A fraction of the bounding box of the model, 0 to 1.
    Part(f64),
}

impl CutAway {
    /// The scene without that part, which is subtracted from every region.
    ///
    /// # Errors
    ///
    /// [`DrawError::Option`] for a percentage of a model that is empty, or unbounded along the axis; [`DrawError::Compile`].
    pub fn apply(&self, scene: &Scene) -> Result<Scene, DrawError> {
        let has_parts = self.0.iter().any(|condition| matches!(condition.coordinate, Coordinate::Part(_)));
        // only percentages need the bounding box, which requires a compilation
        let bounds = match has_parts {
            true => Program::compile_regions(&scene.model_regions())?.bounds(),
            false => Bounds::EMPTY,
        };
        let half_spaces = self.0.iter().map(|condition| condition.half_space(&bounds));
        let corner = Solid::intersection(half_spaces.collect::<Result<Vec<_>, _>>()?);
        let mut scene = scene.clone();
        for region in &mut scene.regions {
            region.solid = &region.solid - &corner;
        }
        Ok(scene)
    }

    /// True if the removed part has no volume in common with a box, such as the bounding box of the model.
    ///
    /// # Errors
    ///
    /// [`DrawError::Option`] for a percentage of a box that is empty, or unbounded along the axis.
    pub fn misses(&self, bounds: &Bounds) -> Result<bool, DrawError> {
        let mut rest = *bounds;
        for condition in &self.0 {
            let coordinate = condition.coordinate(bounds)?;
            let end = if condition.is_above { &mut rest.lo } else { &mut rest.hi };
            let axis = condition.axis;
            end[axis] =
                if condition.is_above { end[axis].max(coordinate) } else { end[axis].min(coordinate) };
        }
        Ok((0..3).any(|axis| rest.lo[axis] >= rest.hi[axis]))
    }

    /// True if a view in this direction, a unit vector, looks onto a cut face: the removed part is in front of it.
    pub fn is_seen_along(&self, forward: Vec3) -> bool {
        // views at a slant, such as the one from the upper right, see faces across all three axes
        self.0.iter().any(|cut| forward[cut.axis] * if cut.is_above { -1.0 } else { 1.0 } > 0.5)
    }
}

impl Condition {
    /// The half-space in which the condition holds.
    fn half_space(&self, bounds: &Bounds) -> Result<Solid, DrawError> {
        let coordinate = self.coordinate(bounds)?;
        let axis = Vec3::AXES[self.axis];
        // a half-space lies behind its plane, opposite to the normal
        let (normal, offset) = if self.is_above { (-axis, -coordinate) } else { (axis, coordinate) };
        Ok(Primitive::from(HalfSpace::new(normal, offset)?).into())
    }

    fn coordinate(&self, bounds: &Bounds) -> Result<f64, DrawError> {
        let part = match self.coordinate {
            Coordinate::Length(length) => return Ok(length),
            Coordinate::Part(part) => part,
        };
        let (lo, hi) = (bounds.lo[self.axis], bounds.hi[self.axis]);
        if !bounds.is_empty() && lo.is_finite() && hi.is_finite() {
            return Ok(lo + part * (hi - lo));
        }
        let axis = AXES[self.axis];
        let reason = if bounds.is_empty() { "is empty" } else { "is unbounded along this axis" };
        let problem = format!("a cut at {} % of {axis} is not possible", 100.0 * part);
        Err(DrawError::Option(
            Message::new(problem, format!("the model {reason}")).suggest("Give a coordinate instead"),
        ))
    }
}

impl FromStr for CutAway {
    type Err = DrawError;

    fn from_str(text: &str) -> Result<CutAway, DrawError> {
        text.split(',').map(condition).collect::<Result<_, _>>().map(CutAway)
    }
}

fn condition(text: &str) -> Result<Condition, DrawError> {
    let text = text.trim();
    let problem = |reason: &str| {
        let form = "Write a cut such as x>0 or x>50%,y<50%";
        DrawError::Option(Message::new(format!("`{text}` is not a cut"), reason).suggest(form))
    };
    let sign = text.find(['<', '>']).ok_or_else(|| problem("it has neither < nor >"))?;
    let (name, coordinate) = (text[..sign].trim(), text[sign + 1..].trim());
    let axis = AXES.iter().position(|axis| *axis == name);
    let axis = axis.ok_or_else(|| problem("it does not begin with x, y or z"))?;
    let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    let coordinate = match coordinate.strip_suffix('%') {
        Some(percent) => number(percent).map(|percent| Coordinate::Part(percent / 100.0)),
        None => number(coordinate).map(Coordinate::Length),
    };
    let coordinate = coordinate.ok_or_else(|| problem("it does not end with a finite number"))?;
    Ok(Condition { axis, is_above: text.as_bytes()[sign] == b'>', coordinate })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_error::{Classified, ErrorKind};
    use rayweave_render::View;

    #[test]
    fn conditions_are_read() {
        let expected = [
            Condition { axis: 0, is_above: true, coordinate: Coordinate::Part(0.5) },
            Condition { axis: 2, is_above: false, coordinate: Coordinate::Length(-1e-3) },
        ];
        assert_eq!("x>50%, z < -1e-3".parse::<CutAway>().unwrap(), CutAway(expected.to_vec()));
    }

    #[test]
    fn cut_faces_are_seen_from_the_removed_side() {
        let cut: CutAway = "x>50%, y<0".parse().unwrap();
        let seen = [View::Front, View::Back, View::Left, View::Right, View::Top, View::Iso]
            .map(|view| cut.is_seen_along(view.forward_and_up().0));
        assert_eq!(seen, [true, false, false, true, false, true]);
    }

    #[test]
    fn cuts_beside_a_box_miss_it() {
        let bounds = Bounds { lo: Vec3::new(-1.0, -2.0, 0.0), hi: Vec3::new(1.0, 2.0, 10.0) };
        let misses = |text: &str| text.parse::<CutAway>().unwrap().misses(&bounds).unwrap();
        for text in ["z>10", "z>9,y<-2", "x<-1", "x>0,x<-0.5", "z<0%"] {
            assert!(misses(text), "{text}");
        }
        for text in ["z>9.5", "z>9,y<-1.5", "x<0", "x>-0.5,x<0.5", "z<1%", "z<200"] {
            assert!(!misses(text), "{text}");
        }
    }

    #[test]
    fn malformed_conditions_are_rejected() {
        for text in ["", "x", "w>0", "x>", "x>nan", "x>1e999", "x>5%%", "x>1,", "x=1", "x<>1"] {
            let error = text.parse::<CutAway>().unwrap_err();
            assert_eq!(error.kind(), ErrorKind::Value, "{text}");
            assert!(error.to_string().contains("such as x>0"), "{error}");
        }
    }
}
