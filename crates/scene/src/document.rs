//! Contents of a model file with source spans, before any evaluation.

use crate::colour::Colour;
use crate::datum::{Datum, Table, key, to_toml};
use crate::number::Number;
use crate::source::{Source, Spanned};
use crate::unit::Unit;
use rayweave_table::AllowedFiles;
use std::path::PathBuf;
use std::sync::Arc;

/// The syntax tree of a model file: names, numbers and texts with their source spans, unevaluated.
/// Every importer creates one.
///
/// Equality ignores spans, the source and the allowed files.
#[derive(Clone, Debug, Default)]
pub struct Document {
    /// The text that the spans refer to.
    pub source: Arc<Source>,
    /// Additional files and folders that the document may read; it may always read those in the folder of its source and below.
    pub allowed: Vec<PathBuf>,
    /// The comment at the head of the file, without the `#`.
    pub heading: Vec<String>,
    /// The unit of all lengths.
    pub unit: Option<Spanned<Unit>>,
    /// Named numbers, in the order of the file.
    pub parameters: Vec<Parameter>,
    /// Named solids, in the order of the file.
    pub solids: Vec<SolidEntry>,
    /// Regions; where they overlap, the later one has priority.
    pub regions: Vec<RegionEntry>,
    /// Media, in the order of the file.
    pub media: Vec<MediumEntry>,
    /// The camera of pictures.
    pub camera: Option<Spanned<CameraEntry>>,
    /// Lights.
    pub lights: Vec<LightEntry>,
    /// Options of pictures.
    pub render: Option<RenderEntry>,
    /// Tables of other programs.
    pub foreign: Vec<Foreign>,
}

impl PartialEq for Document {
    fn eq(&self, other: &Document) -> bool {
        self.heading == other.heading
            && self.unit == other.unit
            && self.parameters == other.parameters
            && self.solids == other.solids
            && self.regions == other.regions
            && self.media == other.media
            && self.camera == other.camera
            && self.lights == other.lights
            && self.render == other.render
            && self.foreign == other.foreign
    }
}

impl Document {
    /// The files that the document may read.
    pub fn files(&self) -> AllowedFiles {
        AllowedFiles::of_model(self.source.path().map(PathBuf::as_path), &self.allowed)
    }

    /// A solid by its name.
    pub fn solid(&self, name: &str) -> Option<&SolidEntry> {
        self.solids.iter().find(|solid| solid.name.value == name)
    }

    /// A table of another program, by its name.
    pub fn foreign(&self, name: &str) -> Option<&Foreign> {
        self.foreign.iter().find(|table| table.name.value == name)
    }
}

/// A named number.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: Spanned<String>,
    /// Its value, which may depend on other parameters, earlier or later ones.
    pub value: Spanned<Number>,
}

/// Three numbers.
pub type Vector = [Spanned<Number>; 3];

/// Four rows of four numbers.
pub type Matrix = [[Spanned<Number>; 4]; 4];

/// A named solid.
#[derive(Clone, Debug, PartialEq)]
pub struct SolidEntry {
    /// The name by which other solids refer to it.
    pub name: Spanned<String>,
    /// The name used for this solid within its face names, if it differs from `name`; an empty text omits it.
    pub label: Option<Spanned<String>>,
    /// Definition.
    pub body: Body,
    /// The transforms that are applied to it, in order.
    pub transform: Vec<Spanned<Step>>,
}

/// Definition of a solid.
#[derive(Clone, Debug, PartialEq)]
pub enum Body {
    /// A shape: its keyword and its arguments.
    Shape(Spanned<String>, Table),
    /// A boolean expression over solids.
    Expression(Spanned<String>),
    /// Another solid, placed many times.
    Place(Box<Place>),
}

/// An affine transform.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Move by a vector.
    Translate(Vector),
    /// Turn about the x axis, in degrees.
    RotateX(Spanned<Number>),
    /// Turn about the y axis, in degrees.
    RotateY(Spanned<Number>),
    /// Turn about the z axis, in degrees.
    RotateZ(Spanned<Number>),
    /// Turn about an axis through the origin, in degrees.
    Rotate(Vector, Spanned<Number>),
    /// Scale about the origin.
    Scale(Spanned<Number>),
    /// Scale about the origin by one factor per axis.
    ScaleAxes(Vector),
    /// Mirror in the plane through the origin with this normal.
    Mirror(Vector),
    /// Any affine map, as a matrix that acts on columns.
    Matrix(Box<Matrix>),
}

/// A solid placed many times.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The name of the solid.
    pub solid: Spanned<String>,
    /// Positions of the copies.
    pub layout: Layout,
    /// The name of the copies in occurrence paths; that of the solid by default.
    pub name: Option<Spanned<String>>,
    /// The copy numbers, allowed only together with `name`; counted from 0 by default.
    pub numbers: Option<Spanned<Vec<Spanned<Number>>>>,
}

/// Positions of the copies of a solid.
#[derive(Clone, Debug, PartialEq)]
pub enum Layout {
    /// In rows, columns and layers.
    Grid(Box<Grid>),
    /// Copy k is moved along x by `radius`, then turned about the z axis by `start + 360 k / count` degrees.
    Ring {
        /// Number of copies.
        count: Spanned<Number>,
        /// The distance from the axis.
        radius: Spanned<Number>,
        /// The angle of the first copy; 0 by default.
        start: Option<Spanned<Number>>,
    },
    /// Copies moved by vectors.
    At(Vec<Vector>),
    /// Copies placed by matrices.
    Matrices(Vec<Matrix>),
    /// Vectors or matrices from an NPY file in the folder of the model file: float64, (N, 3) or (N, 4, 4).
    File(Spanned<String>),
}

/// Copies in rows, columns and layers: copy (i, j, k) is moved by `origin + (i, j, k) * step`.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Numbers of copies along x, y and z.
    pub count: Vector,
    /// The distances between neighbouring copies along x, y and z.
    pub step: Vector,
    /// Position of the first copy; the origin by default.
    pub origin: Option<Vector>,
}

/// A solid made of a medium.
#[derive(Clone, Debug, PartialEq)]
pub struct RegionEntry {
    /// The name of the solid.
    pub solid: Spanned<String>,
    /// The name of the medium; by default, the region has its own medium.
    pub medium: Option<Spanned<String>>,
    /// Its colour in pictures.
    pub colour: Option<Spanned<Colour>>,
    /// Name of the region; by default that of its solid.
    pub name: Option<Spanned<String>>,
}

/// A medium.
#[derive(Clone, Debug, PartialEq)]
pub struct MediumEntry {
    /// Its name; `world` is the medium around everything.
    pub name: Spanned<String>,
    /// Its refractive index.
    pub index: Option<Spanned<Number>>,
    /// The colour of regions made of it.
    pub colour: Option<Spanned<Colour>>,
    /// Other keys.
    pub others: Table,
}

/// The camera of pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraEntry {
    /// Projection.
    pub projection: ProjectionEntry,
    /// Position of the camera.
    pub position: Vector,
    /// The point in the middle of the picture; the origin by default.
    pub target: Option<Vector>,
    /// The direction that is up in the picture; +z by default.
    pub up: Option<Vector>,
    /// Width and height of the picture in pixels.
    pub size: Option<[Spanned<Number>; 2]>,
}

/// Projection of space onto the picture.
#[derive(Clone, Debug, PartialEq)]
pub enum ProjectionEntry {
    /// Perspective projection: the vertical field of view in degrees, 35 by default.
    Perspective(Option<Spanned<Number>>),
    /// Orthographic projection: the height of the picture in the unit of the model.
    Orthographic(Spanned<Number>),
}

/// A light.
#[derive(Clone, Debug, PartialEq)]
pub struct LightEntry {
    /// Position or direction.
    pub kind: LightKind<Vector>,
    /// Intensity; 1 by default.
    pub intensity: Option<Spanned<Number>>,
    /// Its colour; white by default.
    pub colour: Option<Spanned<Colour>>,
}

/// Position or direction of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind<V> {
    /// Parallel light that travels along this vector.
    Direction(V),
    /// Light from this point, not attenuated by distance.
    Position(V),
}

/// Options of pictures; the renderer has defaults for missing ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderEntry {
    /// The colour of the background.
    pub background: Option<Spanned<Colour>>,
    /// Shading style.
    pub shading: Option<Spanned<Shading>>,
    /// Whether edges are drawn.
    pub edges: Option<Spanned<bool>>,
    /// Whether there are shadows.
    pub shadows: Option<Spanned<bool>>,
    /// Samples per pixel along x and along y.
    pub samples: Option<Spanned<Number>>,
}

/// Shading style of surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shading {
    /// From cool to warm colours (Gooch et al., SIGGRAPH 1998).
    Gooch,
    /// Light from the camera.
    Headlight,
}

impl Shading {
    /// All of them, with their names.
    pub const ALL: [(Shading, &'static str); 2] =
        [(Shading::Gooch, "gooch"), (Shading::Headlight, "headlight")];

    /// The name in files.
    pub fn name(self) -> &'static str {
        Shading::ALL[self as usize].1
    }
}

/// A table of another program, kept verbatim.
#[derive(Clone, Debug)]
pub struct Foreign {
    /// Its name.
    pub name: Spanned<String>,
    /// Contents with their spans.
    pub value: Spanned<Datum>,
    /// The source text of the table: its sections, each up to the header of the next table.
    pub text: String,
}

impl Foreign {
    /// Creates a table that is not from a file, with one line for each of its keys.
    pub fn new(name: &str, table: Table) -> Foreign {
        let mut text = format!("[{}]\n", key(name));
        for (name, value) in &table {
            text += &format!("{} = {}\n", key(&name.value), to_toml(&value.value));
        }
        Foreign { name: name.into(), value: Datum::Table(table).into(), text }
    }
}

impl PartialEq for Foreign {
    fn eq(&self, other: &Foreign) -> bool {
        self.name == other.name && self.value == other.value
    }
}
