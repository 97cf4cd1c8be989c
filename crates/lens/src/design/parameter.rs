//! Parameters of prescriptions, and their names.

use std::fmt;

/// A quantity of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Quantity {
    /// The radius of curvature; undefined for planes.
    Radius,
    /// The curvature, 1 / radius; unlike the radius it is continuous through a plane.
    Curvature,
    /// The distance to the next surface.
    Thickness,
    /// The conic constant.
    Conic,
    /// The coefficient of a power of the distance from the axis, 1 to 16.
    Term(u8),
    /// The index of refraction behind the surface, changed at all wavelengths by the same amount.
    Index,
    /// The decentre along x.
    DecentreX,
    /// The decentre along y.
    DecentreY,
    /// The tilt in degrees about the x axis through the vertex, right-handed.
    TiltX,
    /// The tilt in degrees about the y axis through the vertex, right-handed.
    TiltY,
}

impl Quantity {
    /// All quantities and their names, without the terms.
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

    /// The quantity with this name; `r^4` names a term.
    pub(super) fn named(name: &str) -> Option<Quantity> {
        let power = || name.strip_prefix("r^")?.parse().ok().filter(|power| POWERS.contains(power));
        let known = Quantity::NAMES.into_iter().find(|(known, _)| *known == name);
        known.map(|(_, quantity)| quantity).or_else(|| power().map(Quantity::Term))
    }

    /// True for decentres and tilts, which move surfaces as rigid bodies.
    pub(super) fn is_pose(self) -> bool {
        matches!(self, Quantity::DecentreX | Quantity::DecentreY | Quantity::TiltX | Quantity::TiltY)
    }
}

/// The powers of an asphere.
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

/// A number of a prescription: a quantity and its surfaces, counted from 1.
///
/// Decentres and tilts move surfaces `first` to `last` as one body, about the vertex of the first; all other
/// quantities belong to one surface. The text form is the name of the quantity and the surfaces: `radius 2`,
/// `r^4 1`, `decentre y 3-4`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct DesignParameter {
    /// The quantity.
    pub quantity: Quantity,
    /// The surface, or the first of those moved together.
    pub first: usize,
    /// The last of the surfaces moved together; `first` for all other quantities.
    pub last: usize,
}

impl fmt::Display for DesignParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.quantity, self.first)?;
        if self.last == self.first { Ok(()) } else { write!(f, "-{}", self.last) }
    }
}

impl DesignParameter {
    /// A quantity of one surface.
    pub fn of(quantity: Quantity, surface: usize) -> DesignParameter {
        DesignParameter { quantity, first: surface, last: surface }
    }
}
