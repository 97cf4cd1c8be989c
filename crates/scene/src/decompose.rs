//! Conversion of solids and scenes built by a program to documents, which can be written as model
//! files.

use crate::colour::Colour;
use crate::datum::Datum;
use crate::document::*;
use crate::expression::{Expression, ExpressionItem, Operator, is_reserved};
use crate::number::Number;
use crate::scene::{Camera, Light, Medium, Projection, RenderSettings, Scene, SceneRegion};
use crate::source::{Span, Spanned};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Node, Solid};
use rayweave_shape::primitive::{Primitive, Value};
use std::collections::{HashMap, HashSet};

impl Document {
    /// A document that contains a solid under a name. Reading it back gives `solid.named(name)`, or
    /// the solid itself if it already has a name (which may differ). Shared parts become separate
    /// solids; parts without a name get names that begin with `_`.
    pub fn from_solid(name: &str, solid: &Solid) -> Document {
        Document::from_solids([(name, solid)])
    }

    /// Like [`Document::from_solid`] for several solids with distinct names.
    pub fn from_solids<'a>(solids: impl IntoIterator<Item = (&'a str, &'a Solid)>) -> Document {
        let roots: Vec<(&str, &Solid)> = solids.into_iter().collect();
        Document {
            unit: Some(Spanned::default()),
            solids: DocumentBuilder::new(&roots).entries(&roots),
            ..Document::default()
        }
    }

    /// A document that describes the scene, with numbers in place of parameters and expressions.
    pub fn from_scene(scene: &Scene) -> Document {
        let mut roots: Vec<(String, &Solid)> =
            scene.solids.iter().map(|(name, solid)| (name.clone(), solid)).collect();
        let mut regions = Vec::new();
        for region in &scene.regions {
            let solid = name_of_region(&mut roots, region);
            let medium = scene.media.get(region.medium as usize).map(|medium| medium.name.clone().into());
            regions.push(RegionEntry {
                solid: solid.into(),
                medium,
                colour: Some(region.colour.into()),
                name: Some(region.name.clone().into()),
            });
        }
        let media = scene.media.iter().enumerate();
        let media =
            media.filter(|(id, medium)| *id > 0 || is_stated(medium)).map(|(_, medium)| medium_entry(medium));
        let borrowed = roots.iter().map(|(name, solid)| (name.as_str(), *solid));
        Document {
            unit: Some(scene.unit.into()),
            regions,
            media: media.collect(),
            camera: scene.camera.as_ref().map(|camera| camera_entry(camera).into()),
            lights: scene.lights.iter().map(light_entry).collect(),
            render: render_entry(&scene.render),
            ..Document::from_solids(borrowed)
        }
    }
}

/// The name of a region's solid; a solid that is not in the scene is added.
fn name_of_region<'a>(roots: &mut Vec<(String, &'a Solid)>, region: &'a SceneRegion) -> String {
    if let Some((name, _)) = roots.iter().find(|(_, solid)| solid.is_same(&region.solid)) {
        return name.clone();
    }
    let taken: HashSet<&str> = roots.iter().map(|(name, _)| name.as_str()).collect();
    let name = free_name(&region.name, |name| taken.contains(name));
    roots.push((name.clone(), &region.solid));
    name
}

/// The name itself, or the first of name2, name3, ... that is not taken.
fn free_name(name: &str, is_taken: impl Fn(&str) -> bool) -> String {
    let numbered = (2..).map(|k| format!("{name}{k}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names.find(|name| !is_taken(name) && !is_reserved(name)).unwrap_or_default()
}

fn is_stated(medium: &Medium) -> bool {
    medium.index.is_some() || medium.colour.is_some() || !medium.numbers.is_empty()
}

fn medium_entry(medium: &Medium) -> MediumEntry {
    let others =
        medium.numbers.iter().map(|(name, value)| (name.clone().into(), Datum::Number(*value).into()));
    MediumEntry {
        name: medium.name.clone().into(),
        index: medium.index.map(Spanned::from),
        colour: medium.colour.map(Spanned::from),
        others: others.collect(),
    }
}

fn camera_entry(camera: &Camera) -> CameraEntry {
    let projection = match camera.projection {
        Projection::Perspective { fov } => ProjectionEntry::Perspective(Some(fov.into())),
        Projection::Orthographic { height } => ProjectionEntry::Orthographic(height.into()),
    };
    CameraEntry {
        projection,
        position: vector(camera.position),
        target: Some(vector(camera.target)),
        up: Some(vector(camera.up)),
        size: camera.size.map(|(width, height)| [width, height].map(|n| f64::from(n).into())),
    }
}

fn light_entry(light: &Light) -> LightEntry {
    let kind = match light.kind {
        LightKind::Direction(direction) => LightKind::Direction(vector(direction)),
        LightKind::Position(position) => LightKind::Position(vector(position)),
    };
    LightEntry { kind, intensity: Some(light.intensity.into()), colour: Some(light.colour.into()) }
}

fn render_entry(render: &RenderSettings) -> Option<RenderEntry> {
    let stated = *render != RenderSettings::default();
    stated.then(|| RenderEntry {
        background: render.background.map(Spanned::<Colour>::from),
        shading: render.shading.map(Spanned::from),
        edges: render.edges.map(Spanned::from),
        shadows: render.shadows.map(Spanned::from),
        samples: render.samples.map(|samples| f64::from(samples).into()),
    })
}

fn vector(v: Vec3) -> Vector {
    v.to_array().map(Spanned::<Number>::from)
}

/// Splits a graph of solids into entries with names.
struct DocumentBuilder<'s> {
    /// Number of references to each node.
    references: HashMap<usize, usize>,
    names: HashMap<usize, String>,
    taken: HashSet<String>,
    /// Solids with a name whose entries are not written yet.
    waiting: Vec<&'s Solid>,
    counter: usize,
}

/// The identity of a node, by which shared parts are detected.
fn address(solid: &Solid) -> usize {
    std::ptr::from_ref(solid.node()).addr()
}

impl<'s> DocumentBuilder<'s> {
    fn new(roots: &[(&str, &'s Solid)]) -> DocumentBuilder<'s> {
        let mut builder = DocumentBuilder {
            references: HashMap::new(),
            names: HashMap::new(),
            taken: roots.iter().map(|(name, _)| (*name).to_owned()).collect(),
            waiting: Vec::new(),
            counter: 0,
        };
        for (name, solid) in roots {
            builder.names.entry(address(solid)).or_insert_with(|| (*name).to_owned());
            builder.count(solid);
        }
        builder
    }

    fn count(&mut self, root: &'s Solid) {
        let mut waiting = vec![root];
        while let Some(solid) = waiting.pop() {
            let references = self.references.entry(address(solid)).or_insert(0);
            *references += 1;
            if *references == 1 {
                waiting.extend(solid.node().operand_refs());
            }
        }
    }

    /// All entries: unnamed or shared parts, then the roots. Entries may refer to later ones.
    fn entries(mut self, roots: &[(&str, &'s Solid)]) -> Vec<SolidEntry> {
        let named: Vec<SolidEntry> = roots.iter().map(|(name, solid)| self.root(name, solid)).collect();
        let mut parts = Vec::new();
        while let Some(solid) = self.waiting.pop() {
            let name = self.names[&address(solid)].clone();
            parts.push(self.entry(name, solid));
        }
        parts.reverse();
        parts.extend(named);
        parts
    }

    fn root(&mut self, name: &str, solid: &'s Solid) -> SolidEntry {
        // a second name for a solid that already has an entry
        if self.names[&address(solid)] != name {
            return SolidEntry {
                name: name.into(),
                label: None,
                body: Body::Expression(self.reference(solid).into()),
                transform: Vec::new(),
            };
        }
        self.entry(name.to_owned(), solid)
    }

    fn entry(&mut self, name: String, solid: &'s Solid) -> SolidEntry {
        let (label, content) = match solid.node() {
            Node::Named(label, inner) => (Some(label), inner),
            _ => (None, solid),
        };
        let label = label.filter(|label| ***label != *name || name.starts_with('_'));
        let (transform, inner) = self.peel(solid, content);
        let body = if address(inner) != address(solid) && self.stands_alone(inner) {
            Body::Expression(self.reference(inner).into())
        } else {
            self.body(inner)
        };
        SolidEntry { name: name.into(), label: label.map(|label| label.to_string().into()), body, transform }
    }

    /// The transforms around a solid, in the order in which they are applied, and the solid inside
    /// them.
    fn peel(&self, own: &'s Solid, content: &'s Solid) -> (Vec<Spanned<Step>>, &'s Solid) {
        let (mut steps, mut inner) = (Vec::new(), content);
        while address(inner) == address(own) || !self.stands_alone(inner) {
            let Node::Transformed(map, next) = inner.node() else {
                break;
            };
            steps.push(step(&map.get()).into());
            inner = next;
        }
        steps.reverse();
        (steps, inner)
    }

    /// True if the node needs its own entry wherever it occurs.
    fn stands_alone(&self, solid: &Solid) -> bool {
        match solid.node() {
            Node::Named(..) => true,
            _ if self.names.contains_key(&address(solid)) => true,
            Node::Empty | Node::Universe => false,
            _ => self.references[&address(solid)] > 1,
        }
    }

    /// The expression that refers to an entry.
    fn reference(&mut self, solid: &'s Solid) -> String {
        let mut expression = Expression::default();
        expression.push(ExpressionItem::Name(self.name(solid)), Span::default());
        expression.to_string()
    }

    /// The name of an entry; a new name is queued for writing.
    fn name(&mut self, solid: &'s Solid) -> String {
        if let Some(name) = self.names.get(&address(solid)) {
            return name.clone();
        }
        let name = match solid.node() {
            Node::Named(name, _) if self.is_free(name) => name.to_string(),
            _ => self.next_name(),
        };
        self.taken.insert(name.clone());
        self.names.insert(address(solid), name.clone());
        self.waiting.push(solid);
        name
    }

    fn is_free(&self, name: &str) -> bool {
        !name.is_empty() && !name.starts_with('_') && !is_reserved(name) && !self.taken.contains(name)
    }

    fn next_name(&mut self) -> String {
        loop {
            self.counter += 1;
            let name = format!("_{}", self.counter);
            if !self.taken.contains(&name) {
                return name;
            }
        }
    }

    fn body(&mut self, solid: &'s Solid) -> Body {
        match solid.node() {
            Node::Primitive(primitive) => shape(primitive),
            Node::Placed(inner, copies) => Body::Place(Box::new(Place {
                solid: self.name(inner).into(),
                layout: layout(copies),
                name: copies.name().map(|name| name.to_owned().into()),
                numbers: copies.numbers().map(|numbers| {
                    let numbers = numbers.iter().map(|&number| Spanned::<Number>::from(number as f64));
                    numbers.collect::<Vec<_>>().into()
                }),
            })),
            _ => Body::Expression(self.expression(solid).to_string().into()),
        }
    }

    /// The boolean expression from a node down to other entries, in postfix order.
    fn expression(&mut self, root: &'s Solid) -> Expression {
        let mut expression = Expression::default();
        let mut waiting = vec![(root, false)];
        while let Some((solid, operands_done)) = waiting.pop() {
            let is_root = address(solid) == address(root);
            let operation = operation(solid.node()).filter(|_| is_root || !self.stands_alone(solid));
            let term = match (solid.node(), operation) {
                (Node::Empty, _) => ExpressionItem::Empty,
                (Node::Universe, _) => ExpressionItem::Universe,
                (_, None) => ExpressionItem::Name(self.name(solid)),
                (_, Some(term)) if operands_done => term,
                (node, Some(_)) => {
                    waiting.push((solid, true));
                    waiting.extend(node.operand_refs().rev().map(|operand| (operand, false)));
                    continue;
                }
            };
            expression.push(term, Span::default());
        }
        expression
    }
}

/// The operation of a boolean node.
fn operation(node: &Node) -> Option<ExpressionItem> {
    Some(match node {
        Node::Union(all) => ExpressionItem::Operation(Operator::Union, all.len()),
        Node::Intersection(all) => ExpressionItem::Operation(Operator::Intersection, all.len()),
        Node::SymmetricDifference(all) => ExpressionItem::Operation(Operator::SymmetricDifference, all.len()),
        Node::Difference(..) => ExpressionItem::Operation(Operator::Difference, 2),
        Node::Complement(_) => ExpressionItem::Operation(Operator::Complement, 1),
        Node::Empty
        | Node::Universe
        | Node::Primitive(_)
        | Node::Transformed(..)
        | Node::Named(..)
        | Node::Placed(..) => return None,
    })
}

fn shape(primitive: &Primitive) -> Body {
    let list = |numbers: Vec<f64>| {
        let numbers = numbers.into_iter().map(|number| Datum::Number(number).into());
        Datum::List(numbers.collect())
    };
    let datum = |value| match value {
        Value::Number(number) => Datum::Number(number),
        Value::Vector(numbers) => list(numbers),
        Value::Rows(rows) => Datum::List(rows.into_iter().map(|row| list(row).into()).collect()),
    };
    let arguments = primitive.arguments().into_iter();
    let arguments = arguments.map(|(name, value)| (name.into(), datum(value).into()));
    Body::Shape(primitive.name().into(), arguments.collect())
}

/// The simplest step with exactly the same matrix.
fn step(map: &Affine) -> Step {
    let diagonal = Vec3::new(map.linear.x_axis.x, map.linear.y_axis.y, map.linear.z_axis.z);
    if *map == Affine::translate(map.translation) {
        Step::Translate(vector(map.translation))
    } else if *map == Affine::scale(diagonal) {
        Step::ScaleAxes(vector(diagonal))
    } else {
        Step::Matrix(Box::new(matrix(map)))
    }
}

fn matrix(map: &Affine) -> Matrix {
    map.to_rows().map(|row| row.map(Spanned::<Number>::from))
}

fn layout(maps: &[Affine]) -> Layout {
    match maps.iter().all(|map| *map == Affine::translate(map.translation)) {
        true => Layout::At(maps.iter().map(|map| vector(map.translation)).collect()),
        false => Layout::Matrices(maps.iter().map(matrix).collect()),
    }
}
