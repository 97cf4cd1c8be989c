//! Names of parameters of prescriptions.

use std::fmt;

/// What of a surface is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// The radius of curvature; planes have none.
    Radius,
    /// The curvature, 1 over the radius: a search can pass through a plane with it.
    Curvature,
    /// The distance to the next surface.
    Thickness,
    /// The conic constant.
    Conic,
    /// The coefficient of a power of the distance from the axis, 1 to 16.
    Term(u8),
    /// The index of refraction behind it, at all wavelengths by the same amount.
    Index,
    /// A place off the axis along x.
    DecentreX,
    /// A place off the axis along y.
    DecentreY,
    /// A turn about the axis through the vertex along x, in degrees, right-handed.
    TiltX,
    /// A turn about the axis through the vertex along y, in degrees, right-handed.
    TiltY,
}

impl Quantity {
    /// All of them with their names, but for the terms.
    const NAMES: [(&str, Quantity); 9] = [
        ("radius", Quantity::Radius),
        ("curvature", Quantity::Curvature),
        ("thickness", Quantity::Thickness),
        ("conic", Quantity::Conic),
        ("index", Quantity::Index),
        ("decentre x", Quantity::DecentreX),
        ("decentre y", Quantity::DecentreY),
        ("tilt x", Quantity::TiltX),
        ("tilt y", Quantity::TiltY),
    ];

    /// A quantity by its name; `r^4` is that of a term.
    pub(super) fn named(name: &str) -> Option<Quantity> {
        let power = || name.strip_prefix("r^")?.parse().ok().filter(|power| POWERS.contains(power));
        let known = Quantity::NAMES.into_iter().find(|(known, _)| *known == name);
        known.map(|(_, quantity)| quantity).or_else(|| power().map(Quantity::Term))
    }

    /// True if it moves surfaces as they are.
    pub(super) fn is_pose(self) -> bool {
        matches!(self, Quantity::DecentreX | Quantity::DecentreY | Quantity::TiltX | Quantity::TiltY)
    }
}

/// The powers that an asphere has.
const POWERS: std::ops::RangeInclusive<u8> = 1..=16;

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Quantity::Term(power) => write!(f, "r^{power}"),
            _ => {
                let name =
                    Quantity::NAMES.iter().find(|(_, known)| known == self).map_or("", |(name, _)| name);
                f.write_str(name)
            }
        }
    }
}

/// A number of a prescription: a quantity and the surfaces that it is of, counted from 1.
///
/// Surfaces `first` to `last` are moved as one body, about the vertex of the first; all other quantities are those of one
/// surface. Its text is the name of the quantity with the numbers: `radius 2`, `r^4 1`, `decentre y 3-4`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Parameter {
    /// What is meant.
    pub quantity: Quantity,
    /// The surface.
    pub first: usize,
    /// The last of the surfaces that are moved together; `first` for all that move none.
    pub last: usize,
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.quantity, self.first)?;
        if self.last == self.first { Ok(()) } else { write!(f, "-{}", self.last) }
    }
}

impl Parameter {
    /// A quantity of one surface.
    pub fn of(quantity: Quantity, surface: usize) -> Parameter {
        Parameter { quantity, first: surface, last: surface }
    }
}
