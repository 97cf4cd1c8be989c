//! Values of parameters: text, lookup in a prescription, change of a prescription.

use super::{DesignError, DesignParameter, Quantity};
use crate::prescription::{Behind, Prescription, PrescriptionError, Surface};
use rayweave_optics::Medium;
use rayweave_optics::glass::GlassError;
use std::str::FromStr;

impl FromStr for DesignParameter {
    type Err = DesignError;

    fn from_str(text: &str) -> Result<DesignParameter, DesignError> {
        let parsed = || {
            let (name, numbers) = text.trim().rsplit_once(' ')?;
            let quantity = Quantity::named(name.trim())?;
            let (first, last) = numbers.split_once('-').unwrap_or((numbers, numbers));
            let (first, last) = (first.parse().ok()?, last.parse().ok()?);
            let is_one = first == last || quantity.is_pose();
            (is_one && first <= last).then_some(DesignParameter { quantity, first, last })
        };
        parsed().ok_or_else(|| DesignError::NoParameter(text.to_owned()))
    }
}

impl DesignParameter {
    fn absent(self, why: &'static str) -> DesignError {
        DesignError::Absent { parameter: self, why }
    }

    fn surface(self, lens: &Prescription) -> Result<&Surface, DesignError> {
        let no_surface = || self.absent("the prescription has no such surface; surfaces are counted from 1");
        lens.surfaces.get(self.last.wrapping_sub(1)).ok_or_else(no_surface)?;
        lens.surfaces.get(self.first.wrapping_sub(1)).ok_or_else(no_surface)
    }

    /// The value in a prescription: 0 for decentres and tilts, the index at the primary wavelength for an
    /// index.
    ///
    /// # Errors
    /// [`DesignError::Absent`] for surfaces that do not exist, radii of planes, indices of mirrors.
    pub fn value(self, lens: &Prescription) -> Result<f64, DesignError> {
        let surface = self.surface(lens)?;
        match self.quantity {
            Quantity::Radius if surface.radius.is_infinite() => {
                Err(self.absent("the surface is a plane; vary its curvature"))
            }
            Quantity::Radius => Ok(surface.radius),
            Quantity::Curvature => Ok(1.0 / surface.radius),
            Quantity::Thickness => Ok(surface.thickness),
            Quantity::Conic => Ok(surface.conic),
            Quantity::Term(power) => term(&mut surface.clone(), power)
                .map(|c| *c)
                .ok_or_else(|| self.absent("an asphere has the powers 1 to 16 of r")),
            Quantity::Index => Ok(self.medium(surface)?.index(lens.primary_nm()).re),
            _ => Ok(0.0),
        }
    }

    fn medium(self, surface: &Surface) -> Result<Medium, DesignError> {
        let unknown = |problem: GlassError| {
            DesignError::Prescription(PrescriptionError::Glass { surface: self.first, problem })
        };
        let medium = surface.behind.medium().map_err(unknown)?;
        medium.ok_or_else(|| self.absent("the medium behind a mirror is the one in front of it"))
    }

    /// Adds `change` to the value in a prescription; decentres and tilts leave it unchanged.
    pub(super) fn add(self, lens: &mut Prescription, change: f64) -> Result<(), DesignError> {
        self.value(lens)?;
        let surface = &mut lens.surfaces[self.first - 1];
        match self.quantity {
            Quantity::Radius => surface.radius += change,
            Quantity::Curvature => surface.radius = 1.0 / (1.0 / surface.radius + change),
            Quantity::Thickness => surface.thickness += change,
            Quantity::Conic => surface.conic += change,
            Quantity::Term(power) => {
                if let Some(coefficient) = term(surface, power) {
                    *coefficient += change;
                }
            }
            Quantity::Index => {
                let medium = self.medium(surface)?;
                surface.behind = match surface.behind {
                    Behind::Index(index) => Behind::Index(index + change),
                    _ if change == 0.0 => return Ok(()),
                    _ => Behind::Medium(medium.shifted(change)),
                };
            }
            _ => {}
        }
        Ok(())
    }
}

/// The coefficient of a power of r.
fn term(surface: &mut Surface, power: u8) -> Option<&mut f64> {
    let place = usize::from(power.checked_sub(1)?) / 2;
    if power.is_multiple_of(2) { surface.even.get_mut(place) } else { surface.odd.get_mut(place) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_survive_the_round_trip() {
        for text in
            ["radius 2", "curvature 1", "decentre y 3-4", "tilt x 5", "index 12", "r^4 1", "r^16 3", "r^1 2"]
        {
            assert_eq!(text.parse::<DesignParameter>().unwrap().to_string(), text);
        }
        for text in [
            "",
            "radius",
            "radius x",
            "radius 1-2",
            "tilt 3",
            "tilt x 4-3",
            "girth 2",
            "radius -1",
            "r^0 1",
            "r^17 1",
            "r^ 1",
        ] {
            assert!(text.parse::<DesignParameter>().is_err(), "{text}");
        }
    }
}
