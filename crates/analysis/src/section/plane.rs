//! Section planes, alone or in stacks.

use super::Cut;
use crate::AnalysisError;
use rayweave_error::Message;
use rayweave_math::{PERTURBATION_DIRECTION, UNIT_ROUNDOFF, Vec3};
use std::fmt;
use std::str::FromStr;

/// A section plane; `offset` is the start of a stack of parallel planes.
///
/// Orientation of the picture: z is up for upright planes; x is to the right in `y = 0` and in `z = 0`, y to
/// the right in `x = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SectionPlane {
    form: Form,
    offset: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// Perpendicular to an axis; the offset is the coordinate.
    Axis(usize),
    /// Through a point; the offset is measured from it along the unit normal.
    Oblique { point: Vec3, normal: Vec3 },
}

/// The maximum number of planes per stack.
const MAX_PLANES: usize = 100_000;

impl SectionPlane {
    /// The plane perpendicular to axis 0, 1 or 2 at a coordinate.
    ///
    /// # Errors
    ///
    /// [`AnalysisError::Value`] for an invalid axis, or a coordinate that is not finite.
    pub fn across(axis: usize, coordinate: f64) -> Result<SectionPlane, AnalysisError> {
        match axis < 3 && coordinate.is_finite() {
            true => Ok(SectionPlane { form: Form::Axis(axis), offset: coordinate }),
            false => Err(AnalysisError::Value(Message::new(
                format!("a plane at {coordinate} along axis {axis} is invalid"),
                "the axis must be 0 to 2 and the coordinate finite",
            ))),
        }
    }

    /// The plane through a point, perpendicular to a normal of any length.
    ///
    /// # Errors
    ///
    /// [`AnalysisError::Value`] for a normal of length 0, or numbers that are not finite.
    pub fn new(point: Vec3, normal: Vec3) -> Result<SectionPlane, AnalysisError> {
        let unit = normal.normalize_or_zero();
        match point.is_finite() && unit.is_finite() && unit != Vec3::ZERO {
            true => Ok(SectionPlane { form: Form::Oblique { point, normal: unit }, offset: 0.0 }),
            false => Err(AnalysisError::Value(Message::new(
                format!("no plane through {point} has the normal {normal}"),
                "both must be finite, and the normal must not be zero",
            ))),
        }
    }

    /// The numbers that define the plane, for [`from_numbers`](Self::from_numbers).
    pub fn to_numbers(&self) -> Vec<f64> {
        match self.form {
            Form::Axis(axis) => vec![axis as f64, self.offset],
            Form::Oblique { point, normal } => {
                [&point.to_array()[..], &normal.to_array(), &[self.offset]].concat()
            }
        }
    }

    /// The plane with these numbers of [`to_numbers`](Self::to_numbers), bit for bit; `None` for others.
    pub fn from_numbers(numbers: &[f64]) -> Option<SectionPlane> {
        let plane = match *numbers {
            [axis, offset] => {
                let axis = [0, 1, 2].into_iter().find(|own| *own as f64 == axis)?;
                SectionPlane { form: Form::Axis(axis), offset }
            }
            [x, y, z, a, b, c, offset] => {
                let (point, normal) = (Vec3::new(x, y, z), Vec3::new(a, b, c));
                let is_unit = (normal.length() - 1.0).abs() < 1e-9;
                SectionPlane { form: Form::Oblique { point, normal }, offset: is_unit.then_some(offset)? }
            }
            _ => return None,
        };
        numbers.iter().all(|number| number.is_finite()).then_some(plane)
    }

    /// The parallel plane at another offset: the coordinate along an axis, or the distance from the point
    /// along the normal.
    ///
    /// # Errors
    ///
    /// [`AnalysisError::Value`] if it is not finite.
    pub fn at(&self, offset: f64) -> Result<SectionPlane, AnalysisError> {
        match offset.is_finite() {
            true => Ok(SectionPlane { offset, ..*self }),
            false => {
                let problem = format!("the offset of a plane is {offset}");
                Err(AnalysisError::Value(Message::new(problem, "it must be finite")))
            }
        }
    }

    /// The parallel planes from one offset to another: `from`, `from + step`, and so on.
    ///
    /// # Errors
    ///
    /// [`AnalysisError::Value`] for a step that is not positive, ends that are not finite or in the wrong
    /// order, and more than 100,000 planes.
    pub fn stack(&self, from: f64, to: f64, step: f64) -> Result<Vec<SectionPlane>, AnalysisError> {
        let steps = ((to - from) / step + 1e-9).floor();
        let problem = match () {
            () if !(from.is_finite() && to.is_finite() && from <= to) => {
                Some("its ends must be finite, the lower one first")
            }
            () if step <= 0.0 || step.is_nan() => Some("the step must be greater than 0"),
            () if steps >= MAX_PLANES as f64 || steps.is_nan() => Some("there are more than 100000 planes"),
            () => None,
        };
        match problem {
            Some(reason) => {
                let problem = format!("a stack from {from} to {to} in steps of {step:?} is invalid");
                Err(AnalysisError::Value(Message::new(problem, reason)))
            }
            None => (0..=steps as u32).map(|k| self.at(step_of_stack(from, k, step))).collect(),
        }
    }

    /// The coordinate along an axis, or the distance from the point along the normal.
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// A point of the plane.
    pub fn point(&self) -> Vec3 {
        match self.form {
            Form::Axis(axis) => Vec3::AXES[axis] * self.offset,
            Form::Oblique { point, normal } => point + normal * self.offset,
        }
    }

    /// The unit normal, the direction of offsets.
    pub fn normal(&self) -> Vec3 {
        match self.form {
            Form::Axis(axis) => Vec3::AXES[axis],
            Form::Oblique { normal, .. } => normal,
        }
    }

    /// The plane with its coordinate axes, to the right and up.
    ///
    /// # Errors
    ///
    /// [`AnalysisError::Value`] if the position overflows.
    pub fn cut(&self) -> Result<Cut, AnalysisError> {
        let [across, up] = match self.form {
            Form::Axis(0) => [Vec3::Y, Vec3::Z],
            Form::Axis(1) => [Vec3::X, Vec3::Z],
            Form::Axis(_) => [Vec3::X, Vec3::Y],
            Form::Oblique { normal, .. } => {
                // z up, unless the plane is nearly horizontal
                let upright = if normal.z.abs() < 0.999 { Vec3::Z } else { Vec3::Y };
                let across = upright.cross(normal);
                [across, normal.cross(across)]
            }
        };
        Ok(Cut::new(self.point(), across, up)?)
    }

    /// The side of the plane whose material a section shows where the plane lies in a face, in words: `+z side`. It is the side into
    /// which the fixed direction of symbolic perturbation points, as for all rays in a face.
    pub fn side_in_face(&self) -> String {
        let is_along = PERTURBATION_DIRECTION.dot(self.normal()) >= 0.0;
        match (self.form, is_along) {
            (Form::Axis(axis), _) => format!("+{} side", ["x", "y", "z"][axis]),
            (Form::Oblique { .. }, true) => "side of its normal".to_owned(),
            (Form::Oblique { .. }, false) => "side opposite to its normal".to_owned(),
        }
    }

    /// The names of the axes, to the right and up.
    pub fn axis_names(&self) -> [&'static str; 2] {
        match self.form {
            Form::Axis(0) => ["y", "z"],
            Form::Axis(1) => ["x", "z"],
            Form::Axis(_) => ["x", "y"],
            Form::Oblique { .. } => ["u", "v"],
        }
    }
}

impl SectionPlane {
    /// Like [`fmt::Display`], with digits of a coordinate along an axis down to a millionth of it or of the size of the section,
    /// whichever is larger: for pictures.
    pub fn short(&self, size: f64) -> String {
        match self.form {
            Form::Axis(axis) => {
                let resolution = 1e-6 * self.offset.abs().max(size).max(1e-300);
                let place = rayweave_math::format_to_resolution(self.offset, resolution);
                format!("{} = {place}", ["x", "y", "z"][axis])
            }
            Form::Oblique { .. } => self.to_string(),
        }
    }

    /// Like [`fmt::Display`], with few digits for a coordinate along an axis: for adjacent labels.
    pub fn label(&self) -> String {
        match self.form {
            Form::Axis(axis) => {
                let place =
                    rayweave_math::format_to_resolution(self.offset, 1e-3 * self.offset.abs().max(1e-300));
                format!("{} = {}", ["x", "y", "z"][axis], place)
            }
            Form::Oblique { .. } => self.to_string(),
        }
    }
}

/// The offset of plane `number` of a stack. An offset that differs from 0 by no more than rounding is 0: a stack from -0.3 in steps
/// of 0.1 would otherwise have a plane at 5e-17.
fn step_of_stack(from: f64, number: u32, step: f64) -> f64 {
    let offset = from + f64::from(number) * step;
    // the errors of both ends of the step, of their product and of the sum: at most u |from| each
    match offset.abs() <= 4.0 * UNIT_ROUNDOFF * from.abs() {
        true => 0.0,
        false => offset,
    }
}

impl fmt::Display for SectionPlane {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // the digits of the steps of a stack, without rounding noise
        let number = |x: f64, part: f64| rayweave_math::format_to_resolution(x, part * x.abs().max(1e-300));
        let point = |p: Vec3| p.to_array().map(|x| number(x, 1e-4)).join(", ");
        match self.form {
            Form::Axis(axis) => write!(f, "{} = {}", ["x", "y", "z"][axis], number(self.offset, 1e-12)),
            Form::Oblique { normal, .. } => {
                write!(f, "through ({}), normal ({})", point(self.point()), point(normal))
            }
        }
    }
}

/// Parses `yz`, `xz`, `xy`, or a coordinate along an axis such as `z=2.5`.
impl FromStr for SectionPlane {
    type Err = AnalysisError;

    fn from_str(text: &str) -> Result<SectionPlane, AnalysisError> {
        let problem = || {
            let reason =
                "a plane is yz, xz, xy, the axis perpendicular to it, or a finite coordinate such as z=2.5";
            AnalysisError::Value(Message::new(format!("the plane `{text}` is invalid"), reason))
        };
        let (axis, place) = axis_and_place(text).ok_or_else(problem)?;
        SectionPlane::across(axis, place)
    }
}

/// Parses the number of an axis and the coordinate along it: `yz`, `xz`, `xy`, `z=2.5`, or the axis alone for coordinate 0.
pub fn axis_and_place(text: &str) -> Option<(usize, f64)> {
    let text: String = text.to_ascii_lowercase().split_whitespace().collect();
    let (axis, place) = match text.as_str() {
        "yz" | "zy" => ("x", "0"),
        "xz" | "zx" => ("y", "0"),
        "xy" | "yx" => ("z", "0"),
        axis @ ("x" | "y" | "z") => (axis, "0"),
        other => other.split_once('=')?,
    };
    let place = place.parse().ok().filter(|place: &f64| place.is_finite())?;
    ["x", "y", "z"].iter().position(|own| *own == axis).map(|axis| (axis, place))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayweave_error::{Classified, ErrorKind};

    #[test]
    fn planes_by_name() {
        for (text, name) in
            [("yz", "x = 0"), ("ZX", "y = 0"), (" z = -2.5 ", "z = -2.5"), ("x=1e3", "x = 1000")]
        {
            assert_eq!(text.parse::<SectionPlane>().unwrap().to_string(), name);
        }
        for (axis, plane) in [("x", "yz"), ("Y", "xz"), ("z", "xy")] {
            assert_eq!(axis.parse::<SectionPlane>().unwrap(), plane.parse().unwrap());
        }
        for text in ["", "w=1", "w", "z=", "z=nan", "z=inf", "1"] {
            assert!(text.parse::<SectionPlane>().unwrap_err().to_string().contains("as z=2.5"), "{text}");
        }
        assert_eq!(SectionPlane::across(1, 6.0 - 4.0 * 1.2).unwrap().to_string(), "y = 1.2");
        let short = |offset: f64, size: f64| SectionPlane::across(2, offset).unwrap().short(size);
        assert_eq!(short(2.204_715_791_100_2, 1.0), "z = 2.2047158");
        assert_eq!(short(-0.000_000_114_400_11, 100.0), "z = 0");
        assert_eq!(short(-0.000_000_114_400_11, 1e-6), "z = -0.0000001144001");
        assert_eq!(short(0.25, 100.0), "z = 0.25");
        let slanted = SectionPlane::new(Vec3::ONE, Vec3::new(0.0, 0.0, -4.0)).unwrap();
        assert_eq!(slanted.at(3.0).unwrap().to_string(), "through (1, 1, -2), normal (0, 0, -1)");
        for (point, normal) in
            [(Vec3::NAN, Vec3::X), (Vec3::ZERO, Vec3::ZERO), (Vec3::ZERO, Vec3::X * f64::INFINITY)]
        {
            assert!(SectionPlane::new(point, normal).unwrap_err().kind() == ErrorKind::Value);
        }
        for plane in [slanted.at(0.1).unwrap(), "y=0.3".parse().unwrap()] {
            assert_eq!(SectionPlane::from_numbers(&plane.to_numbers()), Some(plane));
        }
        for numbers in [&[3.0, 0.0][..], &[0.0, f64::NAN], &[1.0], &[0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0]] {
            assert_eq!(SectionPlane::from_numbers(numbers), None);
        }
        assert!(SectionPlane::across(3, 0.0).is_err() && slanted.at(f64::NAN).is_err());
    }

    /// First axis, second axis and the normal towards the viewer are right-handed, so no picture is mirrored.
    #[test]
    fn coordinates_are_those_of_drawings() {
        let axes = |plane: SectionPlane| {
            let cut = plane.cut().unwrap();
            let origin = cut.point([0.0, 0.0]);
            [cut.point([1.0, 0.0]) - origin, cut.point([0.0, 1.0]) - origin]
        };
        let near = |a: [Vec3; 2], b: [Vec3; 2]| (0..2).all(|k| (a[k] - b[k]).length() < 1e-12);
        assert!(near(axes("x=1".parse().unwrap()), [Vec3::Y, Vec3::Z]));
        assert!(near(axes("y=1".parse().unwrap()), [Vec3::X, Vec3::Z]));
        assert!(near(axes("z=1".parse().unwrap()), [Vec3::X, Vec3::Y]));
        let oblique = |normal| axes(SectionPlane::new(Vec3::ONE, normal).unwrap());
        assert!(near(oblique(Vec3::X), [Vec3::Y, Vec3::Z]));
        assert!(near(oblique(Vec3::NEG_Y), [Vec3::X, Vec3::Z]));
        assert!(near(oblique(Vec3::Z), [Vec3::X, Vec3::Y]));
        let [across, up] = oblique(Vec3::new(1.0, 2.0, 3.0));
        assert!(across.z.abs() < 1e-12 && up.z > 0.0);
        assert!((across.cross(up) - Vec3::new(1.0, 2.0, 3.0).normalize()).length() < 1e-12);
    }

    #[test]
    fn stacks() {
        let plane: SectionPlane = "z=7".parse().unwrap();
        let offsets = |from, to, step| -> Vec<f64> {
            plane.stack(from, to, step).unwrap().iter().map(SectionPlane::offset).collect()
        };
        assert_eq!(offsets(0.0, 1.0, 0.25), [0.0, 0.25, 0.5, 0.75, 1.0]);
        // ten steps of 0.1 reach 1 despite the rounding of their sum
        assert_eq!(offsets(0.0, 1.0, 0.1).len(), 11);
        assert_eq!(offsets(2.0, 2.0, 5.0), [2.0]);
        // -0.3 + 3 * 0.1 is not 0, although the planes of the decimal numbers are
        assert_eq!(offsets(-0.3, 0.3, 0.1)[3], 0.0);
        assert_eq!(offsets(-0.7, 0.7, 0.1)[7], 0.0);
        assert_eq!(offsets(-1e-20, 1e-20, 1e-20), [-1e-20, 0.0, 1e-20]);
        let bad =
            [(1.0, 0.0, 0.1), (0.0, 1.0, 0.0), (0.0, 1.0, -1.0), (0.0, 1.0, 1e-9), (f64::NAN, 1.0, 1.0)];
        let more = [(0.0, f64::INFINITY, 1.0), (0.0, 1.0, f64::NAN)];
        for (from, to, step) in bad.into_iter().chain(more) {
            assert!(
                plane.stack(from, to, step).unwrap_err().kind() == ErrorKind::Value,
                "{from} {to} {step}"
            );
        }
    }
}
