//! Height ranges of extrusions.

use super::arguments::{Arguments, Refusal};

/// Height range of an extrusion, and the scale of x and y at its top.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub bottom: f64,
    pub top: f64,
    pub scale: [f64; 2],
}

impl Way {
    /// The extrusion range of a `linear_extrude`; `None` if its height is not positive.
    pub fn of(arguments: &Arguments) -> Result<Option<Way>, Refusal> {
        let height = arguments.number("height", 100.0)?;
        if height <= 0.0 {
            return Ok(None);
        }
        let bottom = if arguments.boolean("center", false)? { -0.5 * height } else { 0.0 };
        let scale: [f64; 2] = arguments.point("scale", 1.0)?;
        Ok(Some(Way { bottom, top: bottom + height, scale: scale.map(|factor| factor.max(0.0)) }))
    }

    pub fn is_straight(&self) -> bool {
        self.scale == [1.0; 2]
    }

    /// True if x and y have the same scale.
    pub fn is_even(&self) -> bool {
        self.scale[0] == self.scale[1]
    }

    /// Scale factors of x and y at height z, as `(slope, constant)`.
    pub fn factors(&self) -> [[f64; 2]; 2] {
        self.scale.map(|factor| {
            let slope = (factor - 1.0) / (self.top - self.bottom);
            [slope, 1.0 - slope * self.bottom]
        })
    }
}
