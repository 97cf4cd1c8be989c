//! `<structure>`: logical volumes and their placements (physical volumes), as a graph.

use super::attributes::{Failure, Numbers};
use super::context::Context;
use super::define::{Role, inverse_rotation};
use super::graph::{Auxiliary, Daughter, Graph, Volume};
use super::materials;
use super::problem::Place;
use super::problem::Problem;
use super::schema;
use super::solids::{Library, Shape, with_dimensions};
use super::xml::{self, Element};
use crate::LossKind;
use rayweave_math::{Affine, Vec3};
use rayweave_scene::Source;
use std::collections::BTreeMap;
use std::sync::Arc;

mod copies;
mod pending;
mod row;

use pending::{Copies, Pending};

/// Maximum deviation of a scale factor from 1 or -1 that is attributed to rounding.
const UNIT_SCALE: f64 = 1e-9;

/// Maximal nesting depth of included files.
const DEEPEST_FILE: usize = 20;

/// The sections of a file.
const SECTIONS: [&str; 6] = ["define", "materials", "solids", "structure", "setup", "userinfo"];

/// Reads a file or text into the graph. Returns the requested volume, by default the world.
pub(super) fn read_file(
    context: &mut Context,
    source: Arc<Source>,
    wanted: Option<&str>,
    graph: &mut Graph,
) -> Option<usize> {
    let root = match xml::read(&mut context.files, source) {
        Ok(root) => root,
        Err(problem) => {
            context.error(problem);
            return None;
        }
    };
    if root.name != "gdml" {
        if !root.children.iter().any(|child| SECTIONS.contains(&child.name.as_str())) {
            let message =
                format!("the file is not GDML: its outermost element is `{}`, not `gdml`.", root.name);
            context.error(Problem::new(message, root.place));
            return None;
        }
        let message = format!(
            "the outermost element is `{}`, not `gdml`: the file is read as an extension of GDML, as in Geant4.",
            root.name
        );
        context.warn(Problem::new(message, root.place));
    }
    schema::check(context, &root);
    let mut reader = StructureReader {
        numbers: Numbers::new(context),
        graph,
        library: Library::default(),
        names: BTreeMap::new(),
        pending: Vec::new(),
        worlds: Vec::new(),
    };
    reader.file(&root);
    let matrices = reader.numbers.names.matrices().map(|(name, matrix)| (name.clone(), matrix.clone()));
    reader.graph.surfaces.matrices.extend(matrices);
    reader.graph.origins.append(&mut reader.library.origins);
    reader.resolve();
    reader.top(&root, wanted)
}

/// Reader of one file.
struct StructureReader<'c, 'g> {
    numbers: Numbers<'c>,
    graph: &'g mut Graph,
    library: Library,
    /// Volumes of this file by name.
    names: BTreeMap<String, usize>,
    /// References to volumes, resolved at the end.
    pending: Vec<Pending>,
    /// Worlds of the setups: name of the setup, name of the volume, position.
    worlds: Vec<(String, String, Place)>,
}

impl StructureReader<'_, '_> {
    fn file(&mut self, root: &Element) {
        for section in &root.children {
            match section.name.as_str() {
                "define" => self.numbers.define(section),
                "materials" => materials::read(&mut self.numbers, &mut self.graph.materials, section),
                "solids" => self.solids(section),
                "structure" => self.structure(section),
                "setup" => self.setup(section),
                "userinfo" => self.graph.auxiliary.extend(auxiliaries(section)),
                "extension" => {
                    let message = "the section `extension` is ignored: only the program that wrote it defines its meaning.";
                    self.numbers.context.lose(
                        LossKind::Dropped,
                        "extension",
                        Problem::new(message, section.place),
                    );
                }
                other => {
                    let problem = Problem::new(format!("unknown section `{other}`."), section.place);
                    let problem = problem.did_you_mean(other, SECTIONS);
                    self.numbers.context.lose(LossKind::Dropped, other, problem);
                }
            }
        }
    }

    fn solids(&mut self, section: &Element) {
        let StructureReader { numbers, graph, library, .. } = self;
        numbers.each(section, &mut |numbers, element| match element.name.as_str() {
            "opticalsurface" => graph.surfaces.add_optical(numbers, element),
            // some programs write definitions between solids
            "define" => numbers.define(element),
            _ => library.add(numbers, element),
        });
    }

    fn setup(&mut self, section: &Element) {
        let Some(world) = section.child("world") else {
            return;
        };
        if let Ok((volume, place)) = self.numbers.reference(world, "ref") {
            self.worlds.push((section.text("name").to_owned(), volume, place));
        }
    }

    fn structure(&mut self, section: &Element) {
        // the closure needs all of the reader except its numbers, which run the loops
        let StructureReader { numbers, graph, library, names, pending, .. } = self;
        numbers.each(section, &mut |numbers, element| {
            let mut builder = Builder { numbers, graph, library, names, pending };
            match element.name.as_str() {
                "volume" | "assembly" => {
                    // problems are reported inside
                    let _ = builder.volume(element);
                }
                "skinsurface" | "bordersurface" => builder.graph.surfaces.add_link(builder.numbers, element),
                other => {
                    let message = format!("`{other}` is not an element of `structure`.");
                    let known = ["volume", "assembly", "skinsurface", "bordersurface", "loop"];
                    let problem = Problem::new(message, element.place).did_you_mean(other, known);
                    builder.numbers.context.lose(LossKind::Dropped, other, problem);
                }
            }
        });
    }

    /// Resolves all references to volumes.
    fn resolve(&mut self) {
        for pending in std::mem::take(&mut self.pending) {
            let Some(&volume) = self.names.get(&pending.name) else {
                let problem = Problem::new(
                    format!("unknown volume `{}`: no volume or assembly has this name.", pending.name),
                    pending.place,
                );
                self.numbers
                    .error(problem.did_you_mean(&pending.name, self.names.keys().map(String::as_str)));
                continue;
            };
            self.graph.volumes[pending.mother].daughters[pending.daughter].volume = volume;
            copies::spread(self.numbers.context, self.graph, &pending, volume);
        }
    }

    /// The top volume.
    fn top(&mut self, root: &Element, wanted: Option<&str>) -> Option<usize> {
        let default = self.worlds.iter().find(|(setup, ..)| setup == "Default").or(self.worlds.first());
        let (name, place) = match (wanted, default) {
            (Some(wanted), _) => (wanted.to_owned(), root.place),
            (None, Some((_, volume, place))) => (volume.clone(), *place),
            (None, None) => return self.only_unplaced_volume(root),
        };
        let found = self.names.get(&name).copied();
        if found.is_none() {
            let problem =
                Problem::new(format!("unknown volume `{name}`: no volume or assembly has this name."), place);
            self.numbers.error(problem.did_you_mean(&name, self.names.keys().map(String::as_str)));
        }
        found
    }

    /// The only volume without a placement, which is the world of a file that does not specify one.
    fn only_unplaced_volume(&mut self, root: &Element) -> Option<usize> {
        let mut placed = vec![false; self.graph.volumes.len()];
        for daughter in self.graph.volumes.iter().flat_map(|volume| &volume.daughters) {
            placed[daughter.volume] = true;
        }
        let free: Vec<usize> = self.names.values().copied().filter(|volume| !placed[*volume]).collect();
        let what = "the file has no world: `<setup name=\"Default\" version=\"1.0\"><world ref=\"..\"/></setup>` is missing.";
        match free.as_slice() {
            [only] => {
                let message = format!(
                    "{what} The world is taken to be `{}`, the only volume without a placement",
                    self.graph.volumes[*only].name
                );
                self.numbers.context.warn(Problem::new(message, root.place));
                Some(*only)
            }
            _ => {
                self.numbers.error(Problem::new(what, root.place));
                None
            }
        }
    }
}

/// Adds volumes to the graph.
struct Builder<'a, 'c> {
    numbers: &'a mut Numbers<'c>,
    graph: &'a mut Graph,
    library: &'a Library,
    names: &'a mut BTreeMap<String, usize>,
    pending: &'a mut Vec<Pending>,
}

impl Builder<'_, '_> {
    fn volume(&mut self, element: &Element) -> Result<(), Failure> {
        let name = self.numbers.name(element)?;
        if self.names.contains_key(&name) {
            let message = format!("a second volume `{name}`: the first one is used.");
            self.numbers.context.lose(LossKind::Dropped, &element.name, Problem::new(message, element.place));
            return Ok(());
        }
        let shape = self.shape(element).ok().flatten();
        let material = self.material(element);
        let index = self.graph.volumes.len();
        self.graph.volumes.push(Volume {
            name: name.clone(),
            shape,
            material,
            daughters: Vec::new(),
            content: index,
            auxiliary: auxiliaries(element),
            place: element.place,
        });
        self.names.insert(name, index);
        let Builder { numbers, graph, library, names, pending } = self;
        numbers.each(element, &mut |numbers, child| {
            let mut builder = Builder { numbers, graph, library, names, pending };
            // problems are reported inside
            let _ = builder.content(index, child);
        });
        Ok(())
    }

    fn shape(&mut self, element: &Element) -> Result<Option<Shape>, Failure> {
        match element.child("solidref") {
            Some(solid) => {
                let found = self.library.of(self.numbers, solid)?;
                if found.is_none() {
                    let message = format!(
                        "the volume `{}` is missing, because its solid is refused; its daughters remain.",
                        element.text("name")
                    );
                    self.numbers.context.warn(Problem::new(message, element.place));
                }
                Ok(found)
            }
            None if element.name == "assembly" => Ok(None),
            None => {
                let message =
                    format!("the volume `{}` has no `solidref`: it is required.", element.text("name"));
                Err(self.numbers.error(Problem::new(message, element.place)))
            }
        }
    }

    fn material(&mut self, element: &Element) -> Option<usize> {
        let reference = element.child("materialref")?;
        let (name, place) = self.numbers.reference(reference, "ref").ok()?;
        self.graph.materials.find(self.numbers, &name, place)
    }

    fn content(&mut self, mother: usize, element: &Element) -> Result<(), Failure> {
        match element.name.as_str() {
            "physvol" => self.placement(mother, element),
            "replicavol" => self.replicas(mother, element),
            "divisionvol" => self.divisions(mother, element),
            "paramvol" => self.parameterised(mother, element),
            "materialref" | "solidref" | "auxiliary" => Ok(()),
            // Geant4 treats them as an unknown extension
            "opticalsurface" | "skinsurface" | "bordersurface" => {
                let (tag, section) = (element.name.as_str(), section_of_surface(&element.name));
                let message = format!(
                    "`{tag}` has no effect in a volume: Geant4 ignores it there. Move it to `{section}`."
                );
                self.numbers.context.lose(LossKind::Dropped, tag, Problem::new(message, element.place));
                Ok(())
            }
            other => {
                let problem =
                    Problem::new(format!("`{other}` is not an element of a volume."), element.place);
                let known = [
                    "physvol",
                    "replicavol",
                    "divisionvol",
                    "paramvol",
                    "materialref",
                    "solidref",
                    "auxiliary",
                    "loop",
                ];
                self.numbers.context.lose(LossKind::Dropped, other, problem.did_you_mean(other, known));
                Ok(())
            }
        }
    }

    fn placement(&mut self, mother: usize, element: &Element) -> Result<(), Failure> {
        let map = self.map(element)?;
        let name = element.attribute("name").map_or(Ok(String::new()), |_| self.numbers.name(element))?;
        // Geant4 evaluates it as a C++ `int`, and refuses fractions
        let copy = element.attribute("copynumber");
        let copy = copy.map(|copy| {
            self.numbers.whole_value("copynumber", copy, i64::from(i32::MIN), i64::from(i32::MAX))
        });
        let copy = copy.transpose()?;
        let daughter = Daughter { name, volume: mother, maps: vec![map], copy, place: element.place };
        if let Some(file) = element.child("file") {
            let Some(volume) = self.included(file)? else {
                return Ok(());
            };
            self.graph.volumes[mother].daughters.push(Daughter { volume, ..daughter });
            return Ok(());
        }
        self.refer(mother, element, daughter, Copies::Placed)
    }

    /// Reads the `<volumeref>` of a daughter, to be resolved later.
    fn refer(
        &mut self,
        mother: usize,
        element: &Element,
        daughter: Daughter,
        copies: Copies,
    ) -> Result<(), Failure> {
        let Some(reference) = element.child("volumeref") else {
            let message = format!("the `{}` has no `volumeref`: it is required.", element.name);
            return Err(self.numbers.error(Problem::new(message, element.place)));
        };
        let (name, place) = self.numbers.reference(reference, "ref")?;
        let daughters = &mut self.graph.volumes[mother].daughters;
        daughters.push(daughter);
        self.pending.push(Pending { mother, daughter: daughters.len() - 1, name, place, copies });
        Ok(())
    }

    /// Map of a placement. GDML gives the rotation of the mother's frame relative to the daughter, so the inverse
    /// rotates the daughter. A scale is applied first. As in Geant4, only its signs count: `G4ReflectionFactory` decomposes
    /// the map, ignores the magnitudes of a scale without reflection, and rejects those of a scale with one.
    fn map(&mut self, element: &Element) -> Result<Affine, Failure> {
        let placement = self.numbers.placement(element, "");
        let scale = self.numbers.child_vector(element, "scale", Role::Scale)?.unwrap_or(Vec3::ONE);
        let (position, angles) = placement?;
        if scale.to_array().contains(&0.0) {
            return Err(self
                .numbers
                .error(Problem::new("a scale factor is 0: the volume would be flat.", element.place)));
        }
        let signs = Vec3::from_array(scale.to_array().map(f64::signum));
        if (scale - signs).abs().max_element() > UNIT_SCALE {
            let child = element.children.iter().find(|child| matches!(&*child.name, "scale" | "scaleref"));
            let [x, y, z] = signs.to_array();
            let geant4 = if x * y * z > 0.0 { "as in Geant4" } else { "and Geant4 refuses the file" };
            let message = format!(
                "the placement has the scale ({}, {}, {}): only the signs are used, {geant4}. Use a `scaledSolid` to scale a solid.",
                scale.x, scale.y, scale.z
            );
            let place = child.map_or(element.place, |child| child.place);
            self.numbers.context.warn(Problem::new(message, place));
        }
        Ok(Affine::scale(signs).then(&inverse_rotation(angles)).then(&Affine::translate(position)))
    }

    /// The volume of an included file; `None` if that has problems, which are reported.
    fn included(&mut self, file: &Element) -> Result<Option<usize>, Failure> {
        let attribute = self.numbers.need(file, "name")?;
        let path = self.numbers.context.files.beside(attribute.place.file, &attribute.value);
        let wanted = file.attribute("volname").map(|volume| volume.value.as_str());
        let key = (path.clone(), wanted.unwrap_or_default().to_owned());
        if let Some(known) = self.graph.included.get(&key) {
            return Ok(*known);
        }
        let context = &mut *self.numbers.context;
        let depth = context.open.len();
        let refusal = match (context.open.contains(&path), depth > DEEPEST_FILE) {
            (true, _) => Some(format!("the file {} includes itself: through {depth} files.", path.display())),
            (false, true) => Some(format!(
                "the file {} is included too deeply: at most {DEEPEST_FILE} files may include each other in a row.",
                path.display()
            )),
            (false, false) => None,
        };
        if let Some(message) = refusal {
            return Err(self.numbers.error(Problem::new(message, attribute.place)));
        }
        let source = super::source::included(&context.files.allowed, &path);
        let source = source.and_then(|source| match source.text().contains("<gdml") {
            true => Ok(source),
            false => Err("it is not GDML, because it has no element `gdml`".to_owned()),
        });
        let source = source.map_err(|reason| {
            let message = format!("the file {} cannot be read: {reason}.", path.display());
            self.numbers.error(Problem::new(message, attribute.place))
        })?;
        let context = &mut *self.numbers.context;
        context.open.push(path);
        let volume = read_file(context, Arc::new(source), wanted, self.graph);
        context.open.pop();
        self.graph.included.insert(key, volume);
        Ok(volume)
    }

    fn replicas(&mut self, mother: usize, element: &Element) -> Result<(), Failure> {
        let count = self.numbers.whole(element, "number", 1, copies::MAX_COPIES)?;
        let row = match (element.child("replicate_along_axis"), element.attribute("axis")) {
            (Some(along), _) => self.row_along(along)?,
            // syntax of older files
            (None, Some(_)) => self.row_of(element)?,
            (None, None) => {
                return Err(self.numbers.error(Problem::new(
                    "`replicavol` has no `replicate_along_axis`: it is required.",
                    element.place,
                )));
            }
        };
        let row = row::Row { count: count as usize, ..row };
        self.refer(mother, element, empty(mother, element), Copies::Replicas(row))
    }

    /// `<replicate_along_axis>`: direction, width and offset as child elements.
    fn row_along(&mut self, along: &Element) -> Result<row::Row, Failure> {
        let Some(axis) = along.child("direction").and_then(row::direction) else {
            return Err(self.numbers.error(Problem::new(
                "the direction is missing: one of x, y, z, rho, phi must be 1.",
                along.place,
            )));
        };
        let mut quantity = |name: &str| match along.child(name) {
            Some(child) => copies::quantity(self.numbers, child, axis, "value"),
            None => Ok(0.0),
        };
        let (width, offset) = (quantity("width")?, quantity("offset")?);
        Ok(row::Row { axis, count: 0, width, offset })
    }

    /// Axis, width and offset as attributes.
    fn row_of(&mut self, element: &Element) -> Result<row::Row, Failure> {
        let attribute = self.numbers.need(element, "axis")?;
        let Some(axis) = row::axis(&attribute.value) else {
            let problem = Problem::new(format!("`{}` is not an axis", attribute.value), attribute.place);
            return Err(self
                .numbers
                .error(problem.did_you_mean(&attribute.value, row::AXES.map(|row| row.0))));
        };
        let width = copies::quantity(self.numbers, element, axis, "width");
        let offset = copies::quantity(self.numbers, element, axis, "offset");
        Ok(row::Row { axis, count: 0, width: width?, offset: offset? })
    }

    fn divisions(&mut self, mother: usize, element: &Element) -> Result<(), Failure> {
        let row = self.row_of(element)?;
        let count = match element.attribute("number") {
            Some(_) => self.numbers.whole(element, "number", 0, copies::MAX_COPIES)?,
            None => 0,
        };
        let row = row::Row { count: count as usize, ..row };
        self.refer(mother, element, empty(mother, element), Copies::Divisions(row))
    }

    fn parameterised(&mut self, mother: usize, element: &Element) -> Result<(), Failure> {
        let (mut maps, mut shapes, mut failed) = (Vec::new(), Vec::new(), false);
        let list = element.child("parameterised_position_size").unwrap_or(element);
        let Builder { numbers, graph, library, names, pending } = self;
        numbers.each(list, &mut |numbers, child| {
            if child.name != "parameters" {
                return;
            }
            let mut builder = Builder { numbers, graph, library, names, pending };
            match builder.map(child) {
                Ok(map) => maps.push(map),
                Err(_) => failed = true,
            }
            let dimensions = child.children.iter().find(|child| child.name.ends_with("_dimensions"));
            shapes.push(dimensions.and_then(|dimensions| with_dimensions(builder.numbers, dimensions)));
        });
        match failed {
            true => Err(Failure::Reported),
            false => self.refer(
                mother,
                element,
                Daughter { maps, ..empty(mother, element) },
                Copies::Shapes(shapes),
            ),
        }
    }
}

/// The section of optical surfaces and of their attachments.
fn section_of_surface(tag: &str) -> &'static str {
    if tag == "opticalsurface" { "solids" } else { "structure" }
}

/// A daughter without copies yet.
fn empty(mother: usize, element: &Element) -> Daughter {
    let name = element.text("name").to_owned();
    Daughter { name, volume: mother, maps: Vec::new(), copy: None, place: element.place }
}

/// Auxiliary tags among the children.
fn auxiliaries(element: &Element) -> Vec<Auxiliary> {
    let tags = element.children.iter().filter(|child| child.name == "auxiliary");
    tags.map(|tag| Auxiliary {
        kind: tag.text("auxtype").to_owned(),
        value: tag.text("auxvalue").to_owned(),
        unit: tag.text("auxunit").to_owned(),
        children: auxiliaries(tag),
    })
    .collect()
}
