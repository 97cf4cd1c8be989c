//! Attributes and children of the elements of GDML; all others are reported, with a spelling suggestion.
//!
//! *Source*: the schema of GDML 3.1.6 and the reader of Geant4 11.4.1, which accepts a few more. Geant4 ignores unknown
//! attributes without a message, so a misspelt optional attribute silently has its default value.

use super::context::Context;
use super::problem::{Place, Problem};
use super::xml::Element;
use std::collections::BTreeMap;

/// An element: its name, its attributes, and its children unless their reader reports unknown ones.
type Row = (&'static str, &'static str, Option<&'static str>);

/// Children of placements and of the operands of booleans.
const PLACE: &str = "position positionref rotation rotationref";

/// The elements in `<solids>`.
const SOLIDS: &[Row] = &[
    ("box", "name x y z lunit aunit", Some("")),
    ("tube", "name rmin rmax z startphi deltaphi lunit aunit", Some("")),
    ("cutTube", "name rmin rmax z startphi deltaphi lowX lowY lowZ highX highY highZ lunit aunit", Some("")),
    ("cone", "name rmin1 rmax1 rmin2 rmax2 z startphi deltaphi lunit aunit", Some("")),
    ("polycone", "name startphi deltaphi lunit aunit", Some("zplane loop")),
    ("genericPolycone", "name startphi deltaphi lunit aunit", Some("rzpoint loop")),
    ("polyhedra", "name numsides startphi deltaphi lunit aunit", Some("zplane loop")),
    ("genericPolyhedra", "name numsides startphi deltaphi lunit aunit", Some("rzpoint loop")),
    ("trd", "name x1 x2 y1 y2 z lunit aunit", Some("")),
    ("trap", "name z theta phi y1 x1 x2 alpha1 y2 x3 x4 alpha2 lunit aunit", Some("")),
    ("para", "name x y z alpha theta phi lunit aunit", Some("")),
    ("sphere", "name rmin rmax startphi deltaphi starttheta deltatheta lunit aunit", Some("")),
    ("orb", "name r lunit aunit", Some("")),
    ("torus", "name rmin rmax rtor startphi deltaphi lunit aunit", Some("")),
    ("ellipsoid", "name ax by cz zcut1 zcut2 lunit aunit", Some("")),
    ("eltube", "name dx dy dz lunit aunit", Some("")),
    ("elcone", "name dx dy zmax zcut lunit aunit", Some("")),
    ("paraboloid", "name rlo rhi dz lunit aunit", Some("")),
    ("hype", "name rmin rmax inst outst z lunit aunit", Some("")),
    ("xtru", "name lunit aunit", Some("twoDimVertex section loop")),
    ("tet", "name vertex1 vertex2 vertex3 vertex4 lunit aunit", Some("")),
    ("arb8", "name v1x v1y v2x v2y v3x v3y v4x v4y v5x v5y v6x v6y v7x v7y v8x v8y dz lunit aunit", Some("")),
    ("twistedbox", "name PhiTwist x y z lunit aunit", Some("")),
    ("twistedtrd", "name PhiTwist x1 x2 y1 y2 z lunit aunit", Some("")),
    ("twistedtrap", "name PhiTwist z Theta Phi y1 x1 x2 y2 x3 x4 Alph lunit aunit", Some("")),
    (
        "twistedtubs",
        "name twistedangle endinnerrad endouterrad midinnerrad midouterrad zlen nseg totphi phi lunit aunit",
        Some(""),
    ),
    ("tessellated", "name lunit aunit", Some("triangular quadrangular loop")),
    ("scaledSolid", "name lunit aunit", Some("solidref scale scaleref")),
    ("reflectedSolid", "name solid sx sy sz rx ry rz dx dy dz lunit aunit", Some("")),
    ("union", "name lunit aunit", Some(BOOLEAN)),
    ("subtraction", "name lunit aunit", Some(BOOLEAN)),
    ("intersection", "name lunit aunit", Some(BOOLEAN)),
    ("multiUnion", "name lunit aunit", Some("multiUnionNode loop")),
    ("opticalsurface", "name model finish type value", Some("property")),
];

const OTHERS: &[Row] = &[
    // sections and definitions
    ("gdml", "version", None),
    ("define", "", None),
    ("materials", "", None),
    ("solids", "", None),
    ("structure", "", None),
    ("userinfo", "", Some("auxiliary")),
    ("setup", "name version", Some("world")),
    ("world", "ref", Some("")),
    ("loop", "for from to step", None),
    ("constant", "name value", Some("")),
    ("variable", "name value", Some("")),
    ("quantity", "name value unit type", Some("")),
    ("expression", "name value", Some("")),
    ("matrix", "name coldim values value", Some("")),
    ("position", "name x y z unit type", Some("")),
    ("rotation", "name x y z unit aunit type", Some("")),
    ("scale", "name x y z", Some("")),
    ("positionref", "ref", Some("")),
    ("rotationref", "ref", Some("")),
    ("scaleref", "ref", Some("")),
    // materials
    ("isotope", "name Z N formula", Some("atom D Dref")),
    ("element", "name Z N formula", Some("atom fraction D Dref")),
    (
        "material",
        "name Z N formula state",
        Some("D Dref T Tref P Pref MEE MEEref RL RLref AL ALref atom fraction composite property"),
    ),
    ("D", "value unit type name", Some("")),
    ("T", "value unit type name", Some("")),
    ("P", "value unit type name", Some("")),
    ("MEE", "value unit type name", Some("")),
    ("atom", "value unit type name", Some("")),
    ("fraction", "n ref", Some("")),
    ("composite", "n ref", Some("")),
    ("property", "name ref value", Some("")),
    // parts of solids
    ("zplane", "z rmin rmax", Some("")),
    ("rzpoint", "r z", Some("")),
    ("twoDimVertex", "x y", Some("")),
    ("section", "zOrder zPosition xOffset yOffset scalingFactor", Some("")),
    ("triangular", "vertex1 vertex2 vertex3 type lunit", Some("")),
    ("quadrangular", "vertex1 vertex2 vertex3 vertex4 type lunit", Some("")),
    ("first", "ref", Some("")),
    ("second", "ref", Some("")),
    ("firstposition", "name x y z unit type", Some("")),
    ("firstrotation", "name x y z unit type", Some("")),
    ("firstpositionref", "ref", Some("")),
    ("firstrotationref", "ref", Some("")),
    ("multiUnionNode", "name", Some("solid position positionref rotation rotationref")),
    ("solid", "ref", Some("")),
    // structure
    ("volume", "name", None),
    ("assembly", "name", None),
    ("solidref", "ref", Some("")),
    ("materialref", "ref", Some("")),
    ("volumeref", "ref", Some("")),
    ("physvolref", "ref", Some("")),
    (
        "physvol",
        "name copynumber",
        Some("volumeref file position positionref rotation rotationref scale scaleref"),
    ),
    ("file", "name volname", Some("")),
    ("replicavol", "name number axis width offset unit copynumber", Some("volumeref replicate_along_axis")),
    ("replicate_along_axis", "", Some("direction width offset")),
    ("direction", "x y z rho phi", Some("")),
    ("width", "value unit", Some("")),
    ("offset", "value unit", Some("")),
    ("divisionvol", "name axis number width offset unit", Some("volumeref")),
    ("paramvol", "name ncopies", Some("volumeref parameterised_position_size parameters loop")),
    ("parameterised_position_size", "", Some("parameters loop")),
    ("skinsurface", "name surfaceproperty", Some("volumeref")),
    ("bordersurface", "name surfaceproperty", Some("physvolref")),
    ("auxiliary", "auxtype auxvalue auxunit", Some("auxiliary")),
];

const BOOLEAN: &str = "first second position positionref rotation rotationref firstposition firstpositionref firstrotation \
                       firstrotationref";

/// The names of the elements in `<solids>`.
pub(super) fn solids() -> impl Iterator<Item = &'static str> {
    SOLIDS.iter().map(|row| row.0)
}

fn rows() -> impl Iterator<Item = &'static Row> {
    OTHERS.iter().chain(SOLIDS)
}

/// Ending of the elements with the dimensions of parameterised volumes.
const DIMENSIONS: &str = "_dimensions";

/// Warns about unknown attributes and children in a file, once for each pair of names, with the first position.
pub(super) fn check(context: &mut Context, root: &Element) {
    let table: BTreeMap<&str, &Row> = rows().map(|row| (row.0, row)).collect();
    let mut found = Found::default();
    let mut open = vec![root];
    while let Some(element) = open.pop() {
        let row = table.get(element.name.as_str());
        if let Some((_, attributes, children)) = row {
            found.attributes(element, attributes);
            found.children(element, *children);
        } else if element.name == "parameters" {
            found.attributes(element, "number");
            found.parameters(element);
        }
        // elements of extensions may have other attributes
        if row.is_some() || element.name == "parameters" || std::ptr::eq(element, root) {
            open.extend(element.children.iter().rev());
        }
    }
    for (mut problem, count) in found.list {
        if count > 1 {
            problem.message += &format!(" It occurs {count} times.");
        }
        context.warn(problem);
    }
}

/// Warnings in file order, each with the number of its occurrences.
#[derive(Default)]
struct Found {
    list: Vec<(Problem, usize)>,
    /// Index of the warning about a name in an element.
    known: BTreeMap<(String, String), usize>,
}

impl Found {
    fn add(&mut self, element: &str, name: &str, place: Place, problem: impl FnOnce(Place) -> Problem) {
        let next = self.list.len();
        let index = *self.known.entry((element.to_owned(), name.to_owned())).or_insert(next);
        match self.list.get_mut(index) {
            Some((_, count)) => *count += 1,
            None => self.list.push((problem(place), 1)),
        }
    }

    fn attributes(&mut self, element: &Element, known: &str) {
        // attributes in other namespaces, such as xsi:noNamespaceSchemaLocation, are not attributes of GDML
        let own = element.attributes.iter().filter(|attribute| !attribute.name.contains(':'));
        for attribute in own.filter(|attribute| attribute.name != "xmlns") {
            let name = attribute.name.as_str();
            if known.split(' ').any(|other| other == name) {
                continue;
            }
            self.add(&element.name, &format!("@{name}"), attribute.place, |place| {
                let message = format!("`{}` has no attribute `{name}`: it is ignored.", element.name);
                // an attribute that is present cannot be the intended one
                let missing = known.split(' ').filter(|other| element.attribute(other).is_none());
                Problem::new(message, place).did_you_mean(name, missing)
            });
        }
    }

    fn children(&mut self, element: &Element, known: Option<&str>) {
        for child in known.iter().flat_map(|_| &element.children) {
            let known = known.unwrap_or_default();
            if !known.split(' ').any(|other| child.name == other) {
                self.unknown_child(element, child, known);
            }
        }
    }

    fn parameters(&mut self, element: &Element) {
        for child in element.children.iter().filter(|child| !child.name.ends_with(DIMENSIONS)) {
            if !PLACE.split(' ').any(|other| child.name == other) {
                self.unknown_child(element, child, PLACE);
            }
        }
    }

    fn unknown_child(&mut self, element: &Element, child: &Element, known: &str) {
        let name = child.name.as_str();
        self.add(&element.name, name, child.place, |place| {
            let message = format!("`{}` has no element `{name}`: it is ignored.", element.name);
            Problem::new(message, place).did_you_mean(name, known.split(' '))
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_element_has_one_row_and_every_child_has_one() {
        let names: Vec<&str> = rows().map(|row| row.0).collect();
        for (k, (name, _, children)) in rows().enumerate() {
            assert!(!names[..k].contains(name), "{name}");
            for child in children.unwrap_or_default().split(' ').filter(|child| !child.is_empty()) {
                let is_quantity = child.ends_with("ref") || ["RL", "AL", "parameters"].contains(&child);
                assert!(names.contains(&child) || is_quantity, "{child}");
            }
        }
    }
}
