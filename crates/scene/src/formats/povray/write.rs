//! Conversion of a scene to the text of POV-Ray.

use super::shape::{self, NOTHING, vector, with};
use crate::colour::Colour;
use crate::document::{LightKind, Shading};
use crate::number::written;
use crate::scene::{Camera, Light, Projection, Scene};
use rayweave_math::{Affine, Vec3};
use rayweave_model::{Node, Solid};
use rayweave_shape::primitive::{Facet, Primitive};
use rayweave_shape::surface::Surface;
use std::fmt;

/// A scene in POV-Ray's language.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PovRay {
    /// The file.
    pub text: String,
    /// What differs in the POV-Ray picture, one sentence each.
    pub losses: Vec<String>,
}

/// Error of a scene that POV-Ray cannot represent.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum PovRayError {
    /// A map has no inverse.
    Singular {
        /// The region with the map.
        region: String,
    },
    /// POV-Ray has no object for a face of a shape.
    NoForm {
        /// The region with the shape.
        region: String,
        /// The name of the shape.
        shape: &'static str,
    },
    /// The text would be too long.
    TooLarge {
        /// The region that is too large.
        region: String,
    },
}

impl fmt::Display for PovRayError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PovRayError::Singular { region } => {
                write!(
                    f,
                    "region `{region}` holds a shape that is flattened: its transform is singular. Is a scale factor 0?"
                )
            }
            PovRayError::NoForm { region, shape } => write!(
                f,
                "region `{region}` holds a shape `{shape}`: POV-Ray has no object for its curved face. Can it be left out?"
            ),
            PovRayError::TooLarge { region } => write!(
                f,
                "region `{region}` has more than {MAX_PARTS} parts as it is written for POV-Ray: every copy of a solid is written out."
            ),
        }
    }
}

impl std::error::Error for PovRayError {}

/// The maximum number of shapes and operators of one region.
const MAX_PARTS: usize = 1_000_000;

/// Ambient and diffuse reflection of a matt surface, the latter times the cosine of the angle to
/// the light: the values of the headlight shading of this project.
const AMBIENT: f64 = 0.18;
const DIFFUSE: f64 = 0.82;

/// Distance of directional lights, in units of the largest coordinate of the camera or 1.
const FAR: f64 = 1e3;

/// The scene for POV-Ray.
pub(crate) fn write(scene: &Scene) -> Result<PovRay, PovRayError> {
    let mut text = String::from(HEADER);
    let mut losses = Vec::new();
    let camera = scene.camera.as_ref();
    match camera {
        Some(camera) => text += &camera_text(camera),
        None => {
            losses.push("camera: the scene has none, so POV-Ray looks along z from the origin.".to_owned())
        }
    }
    if let Some(colour) = scene.render.background {
        text += &format!("background {{ {} }}\n", rgb(colour, 1.0));
    }
    let shadows = scene.render.shadows.unwrap_or(false);
    let eye = camera.map_or(Vec3::ZERO, |camera| camera.position);
    for light in &scene.lights {
        text += &light_text(light, eye, shadows);
    }
    if scene.lights.is_empty() {
        let lamp = Light { kind: LightKind::Position(eye), intensity: 1.0, colour: Colour::WHITE };
        text += &light_text(&lamp, eye, false);
    }
    for (k, region) in scene.regions.iter().enumerate() {
        text += &format!("\n// {}\n", region.name.replace(['\n', '\r'], " "));
        text += &texture(k, region.colour);
        Writer { region: &region.name, texture: &format!("texture {{ Region{k} }}"), count: 0 }
            .objects(&region.solid, &mut text)?;
    }
    losses.extend(known_losses(scene));
    Ok(PovRay { text, losses })
}

const HEADER: &str = "#version 3.7;\nglobal_settings { assumed_gamma 1 ambient_light rgb 1 }\n";

fn known_losses(scene: &Scene) -> impl Iterator<Item = String> {
    let gooch = scene.render.shading != Some(Shading::Headlight);
    let edges = scene.render.edges != Some(false);
    let clear = scene.regions.iter().any(|region| region.colour.alpha < 255);
    let all = [
        (gooch, "cool to warm shading: surfaces are matt."),
        (edges, "edges: they are not drawn."),
        (clear, "translucent colours: they filter light in a different way."),
        (scene.regions.len() > 1, "priority where regions overlap: the first surface on a ray is seen."),
    ];
    all.into_iter().filter(|(lost, _)| *lost).map(|(_, what)| what.to_owned())
}

fn camera_text(camera: &Camera) -> String {
    let forward = (camera.target - camera.position).normalize();
    let right = forward.cross(camera.up).normalize();
    let up = right.cross(forward);
    let (kind, height) = match camera.projection {
        Projection::Perspective { fov } => ("perspective", 2.0 * libm::tan(0.5 * fov.to_radians())),
        Projection::Orthographic { height } => ("orthographic", height),
    };
    let aspect = camera.size.map_or_else(
        || "image_width / image_height".to_owned(),
        |(width, height)| written(f64::from(width) / f64::from(height)),
    );
    format!(
        "camera {{\n  {kind}\n  location {}\n  direction {}\n  right {} * {aspect}\n  up {}\n}}\n",
        vector(camera.position),
        vector(forward),
        vector(height * right),
        vector(height * up)
    )
}

fn light_text(light: &Light, eye: Vec3, shadows: bool) -> String {
    let colour = rgb(light.colour, light.intensity);
    let shadowless = if shadows { "" } else { " shadowless" };
    match light.kind {
        LightKind::Position(at) => format!("light_source {{ {}, {colour}{shadowless} }}\n", vector(at)),
        LightKind::Direction(along) => {
            let far = FAR * eye.abs().max_element().max(1.0);
            let from = vector(-far * along.normalize());
            format!("light_source {{ {from}, {colour} parallel point_at <0, 0, 0>{shadowless} }}\n")
        }
    }
}

fn texture(k: usize, colour: Colour) -> String {
    let transmit = match colour.alpha {
        255 => String::new(),
        alpha => format!(" transmit {}", written(1.0 - f64::from(alpha) / 255.0)),
    };
    let finish = format!("finish {{ ambient {AMBIENT} diffuse {DIFFUSE} }}");
    format!("#declare Region{k} = texture {{ pigment {{ {}{transmit} }} {finish} }};\n", rgb(colour, 1.0))
}

/// A colour as linear light (the transfer function of IEC 61966-2-1:1999).
fn rgb(colour: Colour, intensity: f64) -> String {
    let light = |level: u8| {
        let level = f64::from(level) / 255.0;
        let light = if level <= 0.04045 { level / 12.92 } else { libm::pow((level + 0.055) / 1.055, 2.4) };
        intensity * light
    };
    let amounts = Vec3::new(light(colour.red), light(colour.green), light(colour.blue));
    format!("rgb {}", vector(amounts))
}

/// Work that remains: text or a node.
enum Task<'a> {
    Text(&'static str),
    Solid(&'a Solid, Affine),
}

/// Writes the solid of a region.
struct Writer<'a> {
    region: &'a str,
    texture: &'a str,
    count: usize,
}

impl Writer<'_> {
    /// Writes a solid as separate objects, one for each operand of its outermost unions: POV-Ray has a
    /// bounding hierarchy of the objects of a scene, but tests the parts of a union one by one.
    fn objects(&mut self, solid: &Solid, text: &mut String) -> Result<(), PovRayError> {
        let mut waiting = vec![(solid, Affine::IDENTITY)];
        while let Some((solid, place)) = waiting.pop() {
            self.counted()?;
            match solid.node() {
                Node::Union(all) => waiting.extend(all.iter().rev().map(|one| (one, place))),
                Node::Named(_, inner) => waiting.push((inner, place)),
                Node::Transformed(map, inner) => waiting.push((inner, map.get().then(&place))),
                Node::Placed(inner, maps) => {
                    self.limit(maps.len())?;
                    waiting.extend(maps.iter().rev().map(|map| (inner, map.then(&place))));
                }
                Node::Empty => {}
                _ => {
                    let object = self.object(solid, place)?;
                    *text += &with(object, self.texture);
                    text.push('\n');
                }
            }
        }
        Ok(())
    }

    /// Returns a solid as one object.
    fn object(&mut self, solid: &Solid, place: Affine) -> Result<String, PovRayError> {
        let mut text = String::new();
        let mut tasks = vec![Task::Solid(solid, place)];
        while let Some(task) = tasks.pop() {
            match task {
                Task::Text(piece) => text += piece,
                Task::Solid(solid, place) => self.expand(solid, place, &mut text, &mut tasks)?,
            }
        }
        Ok(text)
    }

    /// The error for a primitive that POV-Ray has no object for.
    fn no_object(&self, primitive: &Primitive) -> PovRayError {
        let region = self.region.to_owned();
        let is_object = |facet: &Facet| matches!(facet.surface, Surface::Object(_));
        match primitive.lower().facets.iter().any(is_object) {
            true => PovRayError::NoForm { region, shape: primitive.name() },
            false => PovRayError::Singular { region },
        }
    }

    /// Writes the beginning of a node and pushes the rest as tasks, last part first.
    fn expand<'s>(
        &mut self,
        solid: &'s Solid,
        place: Affine,
        text: &mut String,
        tasks: &mut Vec<Task<'s>>,
    ) -> Result<(), PovRayError> {
        self.counted()?;
        match solid.node() {
            Node::Empty => *text += NOTHING,
            Node::Universe => *text += &with(NOTHING.to_owned(), "inverse"),
            Node::Primitive(primitive) => match shape::object(primitive, &place) {
                Some(object) => *text += &object,
                None => return Err(self.no_object(primitive)),
            },
            Node::Complement(inner) => {
                *text += "object { ";
                tasks.extend([Task::Text(" inverse }"), Task::Solid(inner, place)]);
            }
            Node::Named(_, inner) => tasks.push(Task::Solid(inner, place)),
            Node::Transformed(map, inner) => tasks.push(Task::Solid(inner, map.get().then(&place))),
            Node::Placed(inner, maps) => {
                self.limit(maps.len())?;
                let copies: Vec<_> = maps.iter().map(|map| (inner, map.then(&place))).collect();
                group("union", copies, text, tasks);
            }
            Node::Union(all) => group("union", all.iter().map(|one| (one, place)).collect(), text, tasks),
            Node::Intersection(all) if all.is_empty() => *text += &with(NOTHING.to_owned(), "inverse"),
            Node::Intersection(all) => {
                group("intersection", all.iter().map(|one| (one, place)).collect(), text, tasks);
            }
            Node::Difference(a, b) => group("difference", vec![(a, place), (b, place)], text, tasks),
            Node::SymmetricDifference(all) => self.symmetric_difference(all, place, text, tasks)?,
        }
        Ok(())
    }

    /// Writes `a ^ b ^ ...` as the union of all intersections in which an odd number of operands is not inverted.
    fn symmetric_difference<'s>(
        &mut self,
        all: &'s [Solid],
        place: Affine,
        text: &mut String,
        tasks: &mut Vec<Task<'s>>,
    ) -> Result<(), PovRayError> {
        // every combination with an odd number of operands that contain the point
        let combinations = 1usize.checked_shl(all.len() as u32).unwrap_or(usize::MAX);
        self.limit(combinations.saturating_mul(all.len().max(1)))?;
        let odd: Vec<usize> = (0..combinations).filter(|inside| inside.count_ones() % 2 == 1).collect();
        if odd.is_empty() {
            *text += NOTHING;
            return Ok(());
        }
        let is_many = odd.len() > 1;
        if is_many {
            *text += "union { ";
            tasks.push(Task::Text(" }"));
        }
        for inside in odd {
            tasks.push(Task::Text(" }"));
            for (k, operand) in all.iter().enumerate() {
                let is_in = inside >> k & 1 == 1;
                tasks.push(Task::Text(if is_in { " } " } else { " inverse } " }));
                tasks.push(Task::Solid(operand, place));
                tasks.push(Task::Text("object { "));
            }
            tasks.push(Task::Text(" intersection { "));
        }
        Ok(())
    }

    fn counted(&mut self) -> Result<(), PovRayError> {
        self.limit(1)
    }

    fn limit(&mut self, more: usize) -> Result<(), PovRayError> {
        self.count = self.count.saturating_add(more);
        match self.count > MAX_PARTS {
            true => Err(PovRayError::TooLarge { region: self.region.to_owned() }),
            false => Ok(()),
        }
    }
}

/// Writes an operator over several solids; a single solid is written without it, none as the empty solid.
fn group<'s>(
    keyword: &'static str,
    operands: Vec<(&'s Solid, Affine)>,
    text: &mut String,
    tasks: &mut Vec<Task<'s>>,
) {
    match &operands[..] {
        [] => *text += NOTHING,
        [(only, place)] => tasks.push(Task::Solid(only, *place)),
        _ => {
            *text += keyword;
            *text += " { ";
            tasks.push(Task::Text("}"));
            for (solid, place) in operands.into_iter().rev() {
                tasks.push(Task::Text(" "));
                tasks.push(Task::Solid(solid, place));
            }
        }
    }
}
