//! Standard scales (ISO 5455) and methods of projection (ISO 5456-2).

use crate::svg::Svg;
use rayweave_render::View;
use rayweave_scene::Unit;
use std::fmt;
use std::str::FromStr;

/// The arrangement of the views of a drawing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ProjectionMethod {
    /// Each view lies on the side from which it is taken: the view from above is above that from the front, as in North America.
    #[default]
    ThirdAngle,
    /// Each view lies on the opposite side: the view from above is below that from the front, as in Europe.
    FirstAngle,
}

impl ProjectionMethod {
    /// The methods with their names in options.
    pub const ALL: [(ProjectionMethod, &'static str); 2] =
        [(ProjectionMethod::ThirdAngle, "third"), (ProjectionMethod::FirstAngle, "first")];

    /// The views with their columns and rows.
    pub(super) fn views(self) -> [(View, usize, usize); 3] {
        match self {
            ProjectionMethod::ThirdAngle => [(View::Top, 0, 0), (View::Front, 0, 1), (View::Right, 1, 1)],
            ProjectionMethod::FirstAngle => [(View::Front, 0, 0), (View::Left, 1, 0), (View::Top, 0, 1)],
        }
    }
}

impl fmt::Display for ProjectionMethod {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ProjectionMethod::ThirdAngle => "third-angle projection",
            ProjectionMethod::FirstAngle => "first-angle projection",
        })
    }
}

impl FromStr for ProjectionMethod {
    type Err = ();

    fn from_str(name: &str) -> Result<ProjectionMethod, ()> {
        ProjectionMethod::ALL.into_iter().find(|(_, own)| *own == name).map(|(own, _)| own).ok_or(())
    }
}

/// Units of the drawing per metre: 96 per inch.
const PER_METRE: f64 = 96.0 / 0.0254;

/// The scale of a drawing, and the positions of its views.
#[derive(Clone, Copy, Debug)]
pub struct Scale {
    /// Units of the drawing per unit of the model.
    pub pixels: f64,
    factor: f64,
    exponent: i32,
    /// The left edges of the columns and the upper edges of the rows.
    pub columns: [f64; 2],
    pub rows: [f64; 2],
}

impl Scale {
    /// The largest standard scale of at most this number of units of the drawing per unit of the model.
    pub fn below(most: f64, unit: Unit) -> Option<Scale> {
        let real = unit.metres() * PER_METRE;
        let exponents = (-12..=12).rev();
        let standard = exponents.flat_map(|exponent| [5.0, 2.0, 1.0].map(|factor| (factor, exponent)));
        let pixels = |(factor, exponent): (f64, i32)| real * factor * libm::pow(10.0, f64::from(exponent));
        let (factor, exponent) = standard.into_iter().find(|&scale| pixels(scale) <= most)?;
        let places = [0.0; 2];
        Some(Scale { pixels: pixels((factor, exponent)), factor, exponent, columns: places, rows: places })
    }

    /// The scale with positions of the columns and rows.
    pub fn at(self, columns: [f64; 2], rows: [f64; 2]) -> Scale {
        Scale { columns, rows, ..self }
    }

    /// The scale as on drawings: `1:2`, `5:1`.
    pub fn text(&self) -> String {
        let power = |exponent: i32| libm::pow(10.0, f64::from(exponent)).round();
        match self.exponent {
            exponent @ 0.. => format!("{}:1", self.factor * power(exponent)),
            exponent => format!("1:{}", (power(-exponent) / self.factor).round()),
        }
    }
}

/// Draws the symbol of a method of projection: a truncated cone from the side and from its narrow end.
pub fn symbol(svg: &mut Svg, [x, y]: [f64; 2], projection: ProjectionMethod) {
    // in third-angle projection the view of the narrow end, on the left, lies on the left
    let (cone, rings) = match projection {
        ProjectionMethod::ThirdAngle => (x + 12.0, x - 8.0),
        ProjectionMethod::FirstAngle => (x - 10.0, x + 12.0),
    };
    let sides = format!(
        "M{:.2} {:.2}L{:.2} {:.2}V{:.2}L{:.2} {:.2}Z",
        cone - 8.0,
        y - 4.0,
        cone + 8.0,
        y - 8.0,
        y + 8.0,
        cone - 8.0,
        y + 4.0
    );
    svg.path("leader", sides, "");
    for radius in [4.0, 8.0] {
        svg.circle("leader", [rings, y], radius, "");
    }
    let axes = format!(
        "M{:.2} {y:.2}H{:.2}M{:.2} {y:.2}H{:.2}M{rings:.2} {:.2}V{:.2}",
        cone - 10.0,
        cone + 10.0,
        rings - 10.0,
        rings + 10.0,
        y - 10.0,
        y + 10.0
    );
    svg.path("centre", axes, "");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_are_standard() {
        for (most, text, pixels) in [
            (3.8, "1:1", 3.779_527),
            (1.9, "1:2", 1.889_763),
            (1.5, "1:5", 0.755_905),
            (40.0, "10:1", 37.795_27),
        ] {
            let scale = Scale::below(most, Unit::Millimetre).unwrap();
            assert_eq!(scale.text(), text);
            assert!((scale.pixels / pixels - 1.0).abs() < 1e-6, "{scale:?}");
        }
        assert_eq!(Scale::below(3.0, Unit::Metre).unwrap().text(), "1:2000");
    }
}
