//! Elements of solids without a corresponding Rayweave shape, kept in the table `[gdml]` so that the writer can reproduce
//! them.

use super::attributes::Numbers;
use super::xml::Element;
use rayweave_model::{Node, Solid};
use rayweave_scene::{Datum, Spanned, Table};
use rayweave_shape::primitive::Primitive;

/// Elements that usually become a single Rayweave shape, from which the writer can recreate them.
const WITH_TWIN: [&str; 8] = ["box", "orb", "tube", "cone", "torus", "ellipsoid", "eltube", "paraboloid"];

/// Elements that refer to definitions, which are not kept.
const WITH_REFERENCES: [&str; 2] = ["tet", "tessellated"];

/// Attributes that are not numbers.
const WORDS: [&str; 3] = ["lunit", "aunit", "unit"];

/// The row of an element without references to other solids, if its solid has no native twin: `name`, `kind` (name of the
/// element), attributes with the values of their expressions, and `children`.
pub(super) fn row(numbers: &mut Numbers, element: &Element, name: &str, solid: &Solid) -> Option<Table> {
    let tag = element.name.as_str();
    if WITH_REFERENCES.contains(&tag) || (WITH_TWIN.contains(&tag) && is_native_twin(solid)) {
        return None;
    }
    let mut row: Table = vec![entry("name", Datum::Text(name.to_owned()))];
    row.extend(contents(numbers, element)?);
    let mut children = Some(Vec::new());
    numbers.each(element, &mut |numbers, child| {
        let inner = contents(numbers, child).map(|inner| Spanned::from(Datum::Table(inner)));
        children = children.take().zip(inner).map(|(mut all, inner)| {
            all.push(inner);
            all
        });
    });
    match children? {
        children if children.is_empty() => {}
        children => row.push(entry("children", Datum::List(children))),
    }
    Some(row)
}

fn entry(key: &str, value: Datum) -> (Spanned<String>, Spanned<Datum>) {
    (key.into(), value.into())
}

/// True for a single shape, possibly transformed, of a kind that GDML also has.
fn is_native_twin(solid: &Solid) -> bool {
    let inner = solid.node().single_map().map_or(solid, |(_, inner)| inner);
    matches!(
        inner.node(),
        Node::Primitive(
            Primitive::CentredBox(_)
                | Primitive::Sphere(_)
                | Primitive::Cylinder(_)
                | Primitive::Tube(_)
                | Primitive::Cone(_)
                | Primitive::Torus(_)
                | Primitive::Ellipsoid(_)
                | Primitive::Paraboloid(_)
        )
    )
}

/// Kind and attributes of an element, without its name.
fn contents(numbers: &Numbers, element: &Element) -> Option<Table> {
    let mut row = vec![entry("kind", Datum::Text(element.name.to_string()))];
    for attribute in element.attributes.iter().filter(|attribute| attribute.name != "name") {
        let value = match WORDS.contains(&attribute.name.as_str()) {
            true => Datum::Text(attribute.value.clone()),
            false => Datum::Number(numbers.names.evaluate(&attribute.value).ok()?),
        };
        row.push(entry(&attribute.name, value));
    }
    Some(row)
}
