//! Optical surfaces: read and kept unchanged for optical simulation.

use super::attributes::{Failure, Numbers};
use super::expression::Matrix;
use super::materials::{Property, property};
use super::problem::Place;
use super::xml::Element;

/// Optical surfaces of a model, their attachments, and the matrices of their properties.
#[derive(Debug, Default)]
pub(super) struct Surfaces {
    pub optical: Vec<Optical>,
    pub links: Vec<Link>,
    pub matrices: Vec<(String, Matrix)>,
}

/// `<opticalsurface>`.
#[derive(Clone, Debug)]
pub(super) struct Optical {
    pub name: String,
    /// Model, finish and type, as in the file.
    pub words: Vec<(&'static str, String)>,
    pub value: Option<f64>,
    pub properties: Vec<(String, Property)>,
    /// Positions of the properties, by name; the empty name has the position of the element.
    pub places: Vec<(String, Place)>,
}

/// A `<skinsurface>` around a volume, or a `<bordersurface>` between two placements.
#[derive(Clone, Debug)]
pub(super) struct Link {
    pub name: String,
    pub surface: String,
    pub is_skin: bool,
    /// The volume, or the two placements.
    pub of: Vec<(String, Place)>,
    pub place: Place,
}

impl Link {
    /// The element that states it.
    pub fn tag(&self) -> &'static str {
        if self.is_skin { "skinsurface" } else { "bordersurface" }
    }
}

impl Surfaces {
    /// Adds an `<opticalsurface>`; problems are reported inside.
    pub fn add_optical(&mut self, numbers: &mut Numbers, element: &Element) {
        let _ = optical(numbers, element).map(|optical| self.optical.push(optical));
    }

    /// Adds a `<skinsurface>` or `<bordersurface>`; problems are reported inside.
    pub fn add_link(&mut self, numbers: &mut Numbers, element: &Element) {
        let _ = link(numbers, element).map(|link| self.links.push(link));
    }
}

fn optical(numbers: &mut Numbers, element: &Element) -> Result<Optical, Failure> {
    let (mut properties, mut places) = (Vec::new(), vec![(String::new(), element.place)]);
    for child in element.children.iter().filter(|child| child.name == "property") {
        let property = property(numbers, child)?;
        places.push((property.0.clone(), child.place));
        properties.push(property);
    }
    let words = ["model", "finish", "type"].map(|word| (word, element.text(word).to_owned()));
    let value = element.attribute("value").map(|value| numbers.value(value)).transpose()?;
    Ok(Optical { name: numbers.name(element)?, words: words.to_vec(), value, properties, places })
}

fn link(numbers: &mut Numbers, element: &Element) -> Result<Link, Failure> {
    let (surface, _) = numbers.reference(element, "surfaceproperty")?;
    let mut of = Vec::new();
    for child in
        element.children.iter().filter(|child| matches!(child.name.as_str(), "volumeref" | "physvolref"))
    {
        of.push(numbers.reference(child, "ref")?);
    }
    let is_skin = element.name == "skinsurface";
    Ok(Link { name: element.text("name").to_owned(), surface, is_skin, of, place: element.place })
}
