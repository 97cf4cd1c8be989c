//! The model as a Python class: regions of media, read from a file or built from solids.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use numpy::PyArray2;
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyDict, PyIterator, PyList, PyString, PyTuple, PyType};
use rayweave::formats::{self, Format, Options, WriteOptions};
use rayweave::model::simplify::Preparation;
use rayweave::scene::{Diagnostics, Document, Scene, SceneRegion, Unit, parse_with};
use rayweave::{Compiled, Message};

use crate::build::scene_of_parts;
use crate::camera::camera_of;
use crate::drawing::{Subject, notebook_png, render_method};
use crate::engine::{Engine, QueryOptions, computed, time_argument};
use crate::error::{bad_type, bad_value, no_attribute, require_file, shown};
use crate::explain::{PyExplanation, explain};
use crate::interrupt::abandonable;
use crate::save::{format_of, save_scene};
use crate::solid::{PySolid, bounds_array};
use crate::to_mesh::{to_mesh, to_meshes};
use crate::{along, crossings, distance, hits, nearest, occurrences, pickle, points};

/// A model: an ordered list of regions, each a solid made of a medium. It never changes.
///
/// Later regions have priority where solids overlap; everywhere else is the medium of the world, number 0. The queries are those of
/// `Solid`; a point is inside where the medium is not that of the world.
///
/// `load` and `loads` read models; `Model(regions, media)` builds one. Regions are a list of solids and `Region` objects, or a dict
/// of them by name. Media are a list of `Medium` objects, or a dict from names to an index, to a dict of numbers, or to a `Medium`.
/// With `media`, the medium of each region must be in it.
///
/// >>> import rayweave as rw
/// >>> ball = rw.sphere(10)
/// >>> model = rw.Model(
/// ...     regions=[rw.Region("ball", ball, medium="glass", colour="steelblue")],
/// ...     media={"glass": 1.5},
/// ... )
/// >>> model.nearest([0, 0, -20], [0, 0, 1]).t
/// array([10.])
#[pyclass(frozen, module = "rayweave", name = "Model")]
pub struct PyModel {
    /// The document of the file, if it has more contents than the scene.
    stated: Option<Document>,
    scene: Arc<Scene>,
    /// True if the values of some parameters differ from the document.
    overridden: bool,
    /// Compiled at the first query.
    compiled: OnceLock<(Compiled, Engine)>,
    /// Compiled at the first query by region.
    by_region: OnceLock<Engine>,
    solids: PyOnceLock<Py<PyDict>>,
}

impl PyModel {
    fn new(read: Result<(Option<Document>, Scene), Diagnostics>, overridden: bool) -> PyResult<Self> {
        let (stated, scene) = read.map_err(bad_value)?;
        let scene = Arc::new(scene);
        Ok(PyModel {
            stated,
            scene,
            overridden,
            compiled: OnceLock::new(),
            by_region: OnceLock::new(),
            solids: PyOnceLock::new(),
        })
    }

    /// The evaluated scene.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The document of the file, if it has more contents than the scene.
    pub fn stated(&self) -> Option<&Document> {
        self.stated.as_ref()
    }

    /// The compiled model.
    pub fn compiled(&self, py: Python<'_>) -> PyResult<&(Compiled, Engine)> {
        computed(&self.compiled, || {
            let scene = self.scene.clone();
            abandonable(py, move || {
                let compiled = Compiled::new(&scene).map_err(bad_value)?;
                let engine = Engine::of_model(&compiled)?;
                Ok((compiled, engine))
            })?
        })
    }

    /// Evaluator of queries.
    pub fn engine(&self, py: Python<'_>) -> PyResult<&Engine> {
        Ok(&self.compiled(py)?.1)
    }

    /// Evaluator of queries `by` "medium" or "region".
    fn engine_by(&self, py: Python<'_>, by: &str) -> PyResult<&Engine> {
        match by {
            "medium" => self.engine(py),
            "region" => computed(&self.by_region, || {
                let scene = self.scene.clone();
                abandonable(py, move || Engine::by_region(&scene))?
            }),
            _ => Err(bad_value(format!("by is '{by}': it must be 'medium' or 'region'."))),
        }
    }

    /// The document of the current state of the model.
    /// The message about a name that no region has.
    fn no_region(&self, name: &str) -> Message {
        let message =
            Message::unknown("region", name, self.scene.regions.iter().map(|region| region.name.as_str()));
        let medium = self.scene.media.iter().position(|medium| medium.name == name);
        let of_medium = |region: &&SceneRegion| Some(region.medium as usize) == medium;
        match self.scene.regions.iter().find(of_medium) {
            Some(region) => {
                message.suggest(format!("`{name}` is the medium of the region `{}`.", region.name))
            }
            None => message,
        }
    }

    /// For each region whether its name is the given one, or among the given ones.
    fn selected(&self, names: &Bound<'_, PyAny>) -> PyResult<Vec<bool>> {
        let names: Vec<String> = match names.cast::<PyString>() {
            Ok(name) => vec![name.to_str()?.to_owned()],
            Err(_) => names.extract().map_err(|_| {
                bad_type(format!(
                    "regions is {}: it must be the name of a region or a list of names.",
                    shown(names)
                ))
            })?,
        };
        let is_known = |name: &str| self.scene.regions.iter().any(|region| region.name == name);
        match names.iter().find(|name| !is_known(name)) {
            Some(name) => Err(bad_value(self.no_region(name))),
            None => Ok(self.scene.regions.iter().map(|region| names.contains(&region.name)).collect()),
        }
    }

    fn current_document(&self) -> Document {
        self.current_statement().cloned().unwrap_or_else(|| Document::from_scene(&self.scene))
    }

    /// The document of the file, if the model still has the same state.
    fn current_statement(&self) -> Option<&Document> {
        self.stated.as_ref().filter(|_| !self.overridden)
    }
}

/// Reads a model file: a native one (.toml), one of another program (OpenSCAD's .csg, Geant4's .gdml), or a mesh (.stl, .obj, .ply,
/// .off, .3mf, .gltf, .glb). The ending selects the format, unless `format` names it: "native", "openscad", "gdml", or the
/// ending of a mesh. `parameters` overrides parameters of a native file, or constants, variables and quantities of a GDML file, by
/// numbers or arithmetic text. With `facets`, round shapes become the facets that their own program uses; by default they are exactly
/// round. The model's `warnings` list parts that were approximated, dropped or rejected. `fonts` are font files and folders, searched before the system's fonts. With
/// `repair`, meshes that are not solids are repaired as far as that is safe, and `warnings` list the changes. `unit` is the unit
/// of files without one (STL, OBJ, PLY, OFF, OpenSCAD); default "mm". The model may read files in its folder and below, and the
/// files and folders in `allow`. With `strict`, warnings are errors.
///
/// >>> import rayweave as rw
/// >>> _ = rw.Model({"die": rw.box(2)}).save("die.toml")
/// >>> [region.name for region in rw.load("die.toml")]
/// ['die']
#[pyfunction]
#[pyo3(name = "load", signature = (
    path, parameters: "dict[str, float | str] | None" = None, *, format = None, facets = false,
    fonts = Vec::new(), repair = false, unit = None, allow = Vec::new(), strict = false
))]
#[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
pub fn load_model(
    py: Python<'_>,
    path: PathBuf,
    parameters: Option<&Bound<'_, PyDict>>,
    format: Option<&str>,
    facets: bool,
    fonts: Vec<PathBuf>,
    repair: bool,
    unit: Option<&str>,
    allow: Vec<PathBuf>,
    strict: bool,
) -> PyResult<PyModel> {
    require_file(&path)?;
    let overrides = overrides(parameters)?;
    let format = format.map(format_of).transpose()?;
    let unit = unit.map(unit_of).transpose()?;
    let options = Options { facets, fonts, repair, unit, allow, strict, scene_only: false };
    // the document of a GDML file has the values of its definitions, not their expressions
    let is_gdml = format.or_else(|| Format::from_path(&path)) == Some(Format::Gdml);
    let is_overridden = !overrides.is_empty() && !is_gdml;
    let read = abandonable(py, move || formats::load(&path, format, &overrides, &options))?;
    PyModel::new(read.map(|imported| (imported.stated, imported.scene)), is_overridden)
}

/// Words of other programs for methods, with what to write.
const WORDS: [(&str, &str); 16] = [
    ("bbox", "model.bounds"),
    ("bounding_box", "model.bounds"),
    ("export", "model.save(path)"),
    ("first_hit", "model.nearest(origins, directions)"),
    ("intersect", "model.crossings(origins, directions)"),
    ("intersections", "model.crossings(origins, directions)"),
    ("intersects", "model.crossings(origins, directions)"),
    ("materials", "model.media"),
    ("plot", "model.render().show()"),
    ("ray_cast", "model.nearest(origins, directions)"),
    ("region_at", "model.regions_at(points)"),
    ("show", "model.render().show()"),
    ("signed_distance", "model.distance(points)"),
    ("trace", "model.crossings(origins, directions)"),
    ("volume", "rw.measure(model)"),
    ("write", "model.save(path)"),
];

/// A unit of length by its symbol.
pub fn unit_of(symbol: &str) -> PyResult<Unit> {
    Unit::parse(symbol).ok_or_else(|| {
        let known = Unit::ALL.map(|(_, symbol, _)| symbol).join(", ");
        let lower = symbol.to_lowercase();
        let exact = UNIT_WORDS.iter().find(|(word, _)| *word == lower);
        let near = Message::unknown("unit", &lower, UNIT_WORDS.map(|(word, _)| word));
        let near = exact.or_else(|| {
            // the suggestion ends with the word in backquotes
            let said = near.suggestion()?;
            UNIT_WORDS.iter().find(|(word, _)| said.contains(&format!("`{word}`")))
        });
        let hint = near.map_or(String::new(), |(_, own)| format!(" Did you mean '{own}'?"));
        bad_value(format!("unknown unit '{symbol}': it can be {known}.{hint}"))
    })
}

/// Words for units, with the symbols that are meant.
const UNIT_WORDS: [(&str, &str); 18] = [
    ("nanometre", "nm"),
    ("nanometer", "nm"),
    ("micrometre", "um"),
    ("micrometer", "um"),
    ("micron", "um"),
    ("millimetre", "mm"),
    ("millimeter", "mm"),
    ("centimetre", "cm"),
    ("centimeter", "cm"),
    ("metre", "m"),
    ("meter", "m"),
    ("kilometre", "km"),
    ("kilometer", "km"),
    ("inch", "in"),
    ("inches", "in"),
    ("foot", "ft"),
    ("feet", "ft"),
    ("microns", "um"),
];

/// Reads a model from the text of a model file. Names of files are relative to the current folder; the model may read files there
/// and below, and the files and folders in `allow`. With `strict`, warnings are errors.
///
/// >>> import rayweave as rw
/// >>> model = rw.loads("""
/// ... rayweave = 1
/// ... [solid.die]
/// ... box = { size = 2 }
/// ... [[region]]
/// ... solid = "die"
/// ... """)
/// >>> model["die"].solid
/// box(size=[2, 2, 2]).named('die')
#[pyfunction]
#[pyo3(signature = (
    text, parameters: "dict[str, float | str] | None" = None, *, allow = Vec::new(), strict = false
))]
pub fn loads(
    py: Python<'_>,
    text: &str,
    parameters: Option<&Bound<'_, PyDict>>,
    allow: Vec<PathBuf>,
    strict: bool,
) -> PyResult<PyModel> {
    let overrides = overrides(parameters)?;
    let options = Options { allow, strict, ..Options::default() };
    let (text, is_overridden) = (text.to_owned(), !overrides.is_empty());
    let read = abandonable(py, move || formats::parse(&text, Format::Native, &overrides, &options))?;
    PyModel::new(read.map(|imported| (imported.stated, imported.scene)), is_overridden)
}

/// Converts overrides of parameters for the readers of model files.
pub fn overrides(parameters: Option<&Bound<'_, PyDict>>) -> PyResult<Vec<(String, String)>> {
    let text = |name: &str, value: &Bound<'_, PyAny>| match value.cast::<PyString>() {
        Ok(text) => Ok(text.to_str()?.to_owned()),
        Err(_) => match value.extract::<f64>() {
            Ok(number) if number.is_finite() => Ok(format!("{number:?}")),
            Ok(number) => Err(bad_value(format!("parameters['{name}'] is {number}: it must be finite."))),
            Err(_) => Err(bad_type(format!(
                "parameters['{name}'] is {}: it must be a number or an arithmetic expression.",
                shown(value)
            ))),
        },
    };
    let pair = |(name, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
        let name: String = name.extract()?;
        let value = text(&name, &value)?;
        Ok((name, value))
    };
    parameters.into_iter().flatten().map(pair).collect()
}

#[pymethods]
impl PyModel {
    #[new]
    #[pyo3(signature = (
        regions: "Regions", media: "Media | None" = None, *, unit = "mm", camera: "Camera | None" = None
    ), text_signature = "(regions, media=None, *, unit='mm', camera=None)")]
    fn build(
        regions: &Bound<'_, PyAny>,
        media: Option<&Bound<'_, PyAny>>,
        unit: &str,
        camera: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let mut scene = scene_of_parts(regions, media, unit_of(unit)?)?;
        scene.camera = camera.map(camera_of).transpose()?;
        PyModel::new(Ok((None, scene)), false)
    }

    /// The solids by their names, in the order of the file.
    #[getter]
    #[cfg_attr(false, stub("() -> dict[str, Solid]"))]
    fn solids<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let make = || -> PyResult<Py<PyDict>> {
            let solids = PyDict::new(py);
            for (name, solid) in &self.scene.solids {
                solids.set_item(name, PySolid::from_solid(solid.clone()))?;
            }
            Ok(solids.unbind())
        };
        // a copy, so that the model cannot be changed
        self.solids.get_or_try_init(py, make)?.bind(py).copy()
    }

    /// The regions in order; where they overlap, the later one has priority. Region k of this list
    /// has the number k + 1.
    #[getter]
    #[cfg_attr(false, stub("() -> tuple[Region, ...]"))]
    fn regions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
        let class = CLASS.import(py, "rayweave._model", "Region")?;
        let regions: PyResult<Vec<_>> = (self.scene.regions.iter())
            .map(|region| {
                let solid = PySolid::from_solid(region.solid.clone());
                let medium = self.scene.media.get(region.medium as usize).map(|medium| &medium.name);
                class.call1((&region.name, solid, medium, region.colour.to_string()))
            })
            .collect();
        PyTuple::new(py, regions?)
    }

    /// The media by their numbers; number 0 is that of the world.
    #[getter]
    #[cfg_attr(false, stub("() -> tuple[Medium, ...]"))]
    fn media<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        static CLASS: PyOnceLock<Py<PyType>> = PyOnceLock::new();
        let class = CLASS.import(py, "rayweave._model", "Medium")?;
        let media: PyResult<Vec<_>> = (self.scene.media.iter())
            .map(|medium| {
                let numbers = PyDict::new(py);
                medium.numbers.iter().try_for_each(|(name, value)| numbers.set_item(name, value))?;
                let colour = medium.colour.map(|colour| colour.to_string());
                class.call1((&medium.name, medium.index, colour, numbers))
            })
            .collect();
        PyTuple::new(py, media?)
    }

    /// The parameters with their values, in the order of the file.
    #[getter]
    #[cfg_attr(false, stub("() -> dict[str, float]"))]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let parameters = PyDict::new(py);
        for (name, value) in &self.scene.parameters {
            parameters.set_item(name, value)?;
        }
        Ok(parameters)
    }

    /// The unit of all lengths: "nm", "um", "mm", "cm", "m", "km", "in" or "ft".
    #[getter]
    fn unit(&self) -> &'static str {
        self.scene.unit.symbol()
    }

    /// Warnings about the file, as text.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.scene.warnings.iter().map(|warning| Diagnostics::from(warning.clone()).render(false)).collect()
    }

    /// Times at which rays enter and leave the medium of the world: see `Solid.hits`.
    #[pyo3(signature = (
        origins: "ArrayLike", directions: "ArrayLike", t_min = f64::NEG_INFINITY, t_max = f64::INFINITY, *,
        return_surfaces = false, out = None, evaluator = None, threads: "int | None" = None,
        device: "Literal['cpu', 'gpu', 'auto']" = "cpu"
    ), text_signature = "($self, origins, directions, t_min=-1e999, t_max=1e999, *, return_surfaces=False, out=None, evaluator=None, threads=None, device='cpu')")]
    #[cfg_attr(
        false,
        stub(
            "(return_surfaces: Literal[False] = False, out: NDArray[np.float64] | None = None) -> NDArray[np.float64]"
        )
    )]
    #[cfg_attr(
        false,
        stub(
            "(return_surfaces: Literal[True],
          out: NDArray[np.float64] | tuple[NDArray[np.float64], NDArray[np.int32]] | None = None)
          -> tuple[NDArray[np.float64], NDArray[np.int32]]"
        )
    )]
    #[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn hits<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = time_argument)] t_min: f64,
        #[pyo3(from_py_with = time_argument)] t_max: f64,
        return_surfaces: bool,
        out: Option<&Bound<'py, PyAny>>,
        evaluator: Option<&str>,
        threads: Option<&Bound<'py, PyAny>>,
        device: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = QueryOptions::new(t_min, t_max, evaluator, threads, device)?;
        hits::hits(self.engine(origins.py())?, [origins, directions], &options, return_surfaces, out)
    }

    /// All changes of the medium, sorted by ray, then t: see `ModelCrossings`. With `by="region"`, also changes of region within one
    /// medium.
    #[pyo3(signature = (
        origins: "ArrayLike", directions: "ArrayLike", t_min = f64::NEG_INFINITY, t_max = f64::INFINITY, *,
        by: "Literal['medium', 'region']" = "medium", evaluator = None, threads: "int | None" = None,
        device: "Literal['cpu', 'gpu', 'auto']" = "cpu"
    ) -> "ModelCrossings", text_signature = "($self, origins, directions, t_min=-1e999, t_max=1e999, *, by='medium', evaluator=None, threads=None, device='cpu')")]
    #[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn crossings<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = time_argument)] t_min: f64,
        #[pyo3(from_py_with = time_argument)] t_max: f64,
        by: &str,
        evaluator: Option<&str>,
        threads: Option<&Bound<'py, PyAny>>,
        device: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (engine, options) =
            (self.engine_by(origins.py(), by)?, QueryOptions::new(t_min, t_max, evaluator, threads, device)?);
        crossings::crossings(engine, [origins, directions], &options)
    }

    /// All changes of the medium along one curve, or along each in a list of curves, strictly between two times: see
    /// `ModelCrossings`, where `ray` is the number of the curve and `t` its own time. The times are finite numbers, or
    /// (N,) arrays with one for each curve. Curves are described in `rayweave.space`: `Helix` and others, or any object
    /// with `position(t)`, `velocity(t)` and `acceleration_bound(t0, t1)`. With `by="region"`, also changes of region within one medium.
    #[pyo3(signature = (
        curves: "Trajectory | Iterable[Trajectory]", t_min: "float | ArrayLike", t_max: "float | ArrayLike",
        *, by: "Literal['medium', 'region']" = "medium", threads: "int | None" = None
    ) -> "ModelCrossings")]
    fn crossings_along<'py>(
        &self,
        curves: &Bound<'py, PyAny>,
        t_min: &Bound<'py, PyAny>,
        t_max: &Bound<'py, PyAny>,
        by: &str,
        threads: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        along::crossings_along(self.engine_by(curves.py(), by)?, curves, [t_min, t_max], threads)
    }

    /// The first change of the medium of each ray after t_min: see `ModelCrossings`. With `by="region"`, also a change of region
    /// within one medium.
    #[pyo3(signature = (
        origins: "ArrayLike", directions: "ArrayLike", t_min = 0.0, t_max = f64::INFINITY, *,
        by: "Literal['medium', 'region']" = "medium", evaluator = None, threads: "int | None" = None,
        device: "Literal['cpu', 'gpu', 'auto']" = "cpu"
    ) -> "ModelCrossings", text_signature = "($self, origins, directions, t_min=0.0, t_max=1e999, *, by='medium', evaluator=None, threads=None, device='cpu')")]
    #[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn nearest<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = time_argument)] t_min: f64,
        #[pyo3(from_py_with = time_argument)] t_max: f64,
        by: &str,
        evaluator: Option<&str>,
        threads: Option<&Bound<'py, PyAny>>,
        device: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = QueryOptions::new(t_min, t_max, evaluator, threads, device)?;
        nearest::nearest(self.engine_by(origins.py(), by)?, [origins, directions], &options)
    }

    /// The pieces of each ray in one medium, from t_min to t_max: see `Partition`. With `by="region"`, the pieces in one region.
    #[pyo3(signature = (
        origins: "ArrayLike", directions: "ArrayLike", t_min = f64::NEG_INFINITY, t_max = f64::INFINITY, *,
        by: "Literal['medium', 'region']" = "medium", evaluator = None, threads: "int | None" = None,
        device: "Literal['cpu', 'gpu', 'auto']" = "cpu"
    ) -> "Partition", text_signature = "($self, origins, directions, t_min=-1e999, t_max=1e999, *, by='medium', evaluator=None, threads=None, device='cpu')")]
    #[expect(clippy::too_many_arguments, reason = "they are keyword arguments in Python")]
    fn partition<'py>(
        &self,
        origins: &Bound<'py, PyAny>,
        directions: &Bound<'py, PyAny>,
        #[pyo3(from_py_with = time_argument)] t_min: f64,
        #[pyo3(from_py_with = time_argument)] t_max: f64,
        by: &str,
        evaluator: Option<&str>,
        threads: Option<&Bound<'py, PyAny>>,
        device: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (engine, options) =
            (self.engine_by(origins.py(), by)?, QueryOptions::new(t_min, t_max, evaluator, threads, device)?);
        crossings::partition(engine, [origins, directions], &options, by)
    }

    /// Whether points (N, 3) or (3,) are in a medium other than that of the world: bool (N,), or (...) for a grid (..., 3).
    #[pyo3(signature = (
        points: "ArrayLike", *, evaluator = None, threads: "int | None" = None, device: "Literal['cpu', 'gpu', 'auto']" = "cpu"
    ) -> "NDArray[np.bool_]")]
    fn contains<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        evaluator: Option<&str>,
        threads: Option<&Bound<'py, PyAny>>,
        device: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = QueryOptions::of_points(evaluator, threads, device)?;
        points::contains(self.engine(points.py())?, points, &options)
    }

    /// The region of each point (N, 3) or (3,): int32 (N,), or (...) for a grid (..., 3). Region k + 1 is `regions[k]`, 0 is the
    /// world.
    #[pyo3(signature = (
        points: "ArrayLike", *, evaluator = None, threads: "int | None" = None, device: "Literal['cpu', 'gpu', 'auto']" = "cpu"
    ) -> "NDArray[np.int32]")]
    fn regions_at<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        evaluator: Option<&str>,
        threads: Option<&Bound<'py, PyAny>>,
        device: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let options = QueryOptions::of_points(evaluator, threads, device)?;
        points::regions_at(self.engine(points.py())?, points, &options)
    }

    /// Paths of names and copy numbers, such as "tower[3]/brick[12]/hole", of `occurrences` as in
    /// `Crossings.occurrence`: a list of (M,) texts, "" for -1. With `placed`, each path ends at the innermost placed
    /// solid: "tower[3]/brick[12]". Copies have the numbers of the file, or are counted from 0 in the order of `place`;
    /// of equal names in one place, the second one ends in "#2".
    #[pyo3(signature = (
        occurrences: "NDArray[np.integer[Any]] | Sequence[int]", *, placed = false
    ) -> "list[str]")]
    fn occurrence_paths<'py>(
        &self,
        occurrences: &Bound<'py, PyAny>,
        placed: bool,
    ) -> PyResult<Bound<'py, PyList>> {
        occurrences::paths(&self.engine(occurrences.py())?.program, occurrences, placed)
    }

    /// Explains the crossings of one ray: every decision of the single-hit evaluator, with its reason. Print the result to read
    /// it as text, or use its `questions`: see `Explanation`. `origin` and `direction` are three numbers each.
    #[pyo3(signature = (
        origin: "ArrayLike", direction: "ArrayLike", t_min = f64::NEG_INFINITY, t_max = f64::INFINITY
    ), text_signature = "($self, origin, direction, t_min=-1e999, t_max=1e999)")]
    fn explain(
        slf: &Bound<'_, Self>,
        origin: &Bound<'_, PyAny>,
        direction: &Bound<'_, PyAny>,
        #[pyo3(from_py_with = time_argument)] t_min: f64,
        #[pyo3(from_py_with = time_argument)] t_max: f64,
    ) -> PyResult<PyExplanation> {
        explain(&slf.get().engine(origin.py())?.program, slf.as_any(), [origin, direction], [t_min, t_max])
    }

    /// Explains the compilation of the model: the effect of each pass on its tree, and the pruned parts, with reasons: the text
    /// of `rayweave info --explain`, with at most `lines` parts for each solid.
    #[pyo3(signature = (*, lines = 200))]
    fn preparation(&self, py: Python<'_>, lines: usize) -> PyResult<String> {
        let regions = self.scene.model_regions();
        let preparations = abandonable(py, move || Preparation::of_regions(&regions))?.map_err(bad_value)?;
        Ok(preparations.iter().map(|p| p.text(lines)).collect::<Vec<_>>().join("\n"))
    }

    /// Signed distances of points from the surface between the medium of the world and all others: see `Solid.distance`.
    /// `regions` is the name of a region, or several names: the distances are then those from the space that belongs to these
    /// regions, including their borders with other regions.
    ///
    /// >>> import rayweave as rw
    /// >>> model = rw.Model({"shell": rw.sphere(2), "core": rw.sphere(1)})
    /// >>> model.distance([0, 0, 1.25], regions="core").distance
    /// array([0.25])
    #[pyo3(signature = (
        points: "ArrayLike", *, regions: "str | Sequence[str] | None" = None, precision = 1e-9, threads: "int | None" = None,
        progress: "Progress" = None
    ) -> "Distances")]
    fn distance<'py>(
        &self,
        points: &Bound<'py, PyAny>,
        regions: Option<&Bound<'py, PyAny>>,
        precision: f64,
        threads: Option<&Bound<'py, PyAny>>,
        progress: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let py = points.py();
        match regions.map(|names| self.selected(names)).transpose()? {
            None => distance::distance(self.engine(py)?, points, None, precision, (threads, progress)),
            Some(selected) => {
                let engine = self.engine_by(py, "region")?;
                distance::distance(engine, points, Some(&selected), precision, (threads, progress))
            }
        }
    }

    /// The solid of the space that belongs to a region, given by its name or its position in the list of regions: that of the
    /// region minus those of all later regions, which have priority.
    ///
    /// >>> import rayweave as rw
    /// >>> model = rw.Model({"post": rw.box([1, 1, 4]), "plate": rw.box([4, 4, 1])})
    /// >>> model["post"].solid.volume, model.solid_of("post").volume
    /// (4.0, 3.0)
    #[pyo3(signature = (region: "str | int") -> "Solid")]
    fn solid_of<'py>(&self, py: Python<'py>, region: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let regions = self.regions(py)?;
        let number = match region.cast::<PyString>() {
            Ok(name) => {
                let name = name.to_str()?;
                let of_name = |own: &SceneRegion| own.name == name;
                let found = self.scene.regions.iter().position(of_name);
                found.ok_or_else(|| PyKeyError::new_err(self.no_region(name).to_string()))?
            }
            // the error about an index out of range is that of the tuple
            Err(_) => regions.as_any().get_item(region).and_then(|_| {
                let index = region.extract::<isize>()?;
                let count = self.scene.regions.len();
                Ok(if index < 0 { count.wrapping_add_signed(index) } else { index as usize })
            })?,
        };
        let own = regions.get_item(number)?.getattr("solid")?;
        let later = regions.get_slice(number + 1, regions.len());
        later.iter().try_fold(own, |solid, region| solid.sub(region.getattr("solid")?))
    }

    /// A box around all regions: float64 (2, 3), the smallest and the largest coordinates.
    #[getter]
    #[cfg_attr(false, stub("() -> NDArray[np.float64]"))]
    fn bounds<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        Ok(bounds_array(py, &self.engine(py)?.program.bounds()))
    }

    /// Writes the model to a file, complete or not at all, in the format of its ending (native without one) or the one
    /// that `format` names, as in `load`. Curved faces that the format does not support become triangles within `tolerance`, in
    /// the unit of the model; default 1/5000 of its diagonal. With `text`, STL and PLY are written as text. Returns sentences
    /// about parts that were approximated, dropped or written in another form. A mesh that is not sound (edges without two
    /// triangles, or triangles that intersect each other) is rejected, unless `allow_unsound` is true.
    #[pyo3(signature = (path, *, format = None, tolerance = None, text = false, allow_unsound = false))]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        format: Option<&str>,
        tolerance: Option<f64>,
        text: bool,
        allow_unsound: bool,
    ) -> PyResult<Vec<String>> {
        let options = WriteOptions { tolerance, text, allow_unsound };
        save_scene(py, &self.scene, self.current_statement(), &path, format, options)
    }

    /// The surfaces of all regions as triangles: see `rayweave.Mesh`. A face between two regions has triangles of both, so that
    /// `Mesh.describe` reports overlapping pairs and edges with more than two triangles; the mesh of each region has none.
    /// `tolerance` is the maximum distance from curved faces; default 1/5000 of the diagonal of the model. With `by="region"` the
    /// result is a dict with a mesh for each region, by its name.
    ///
    /// >>> import rayweave as rw
    /// >>> model = rw.Model({"post": rw.box([1, 1, 4]), "plate": rw.box([4, 4, 1])})
    /// >>> {name: mesh.volume for name, mesh in model.to_mesh(by="region").items()}
    /// {'post': 3.0, 'plate': 16.0}
    #[pyo3(signature = (tolerance = None, *, by: "Literal['region'] | None" = None))]
    #[cfg_attr(false, stub("(by: None = None) -> Mesh"))]
    #[cfg_attr(false, stub("(by: Literal['region']) -> dict[str, Mesh]"))]
    fn to_mesh<'py>(
        slf: &Bound<'py, Self>,
        tolerance: Option<f64>,
        by: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        match by {
            None => to_mesh(slf.as_any(), tolerance),
            Some("region") => to_meshes(slf.as_any(), tolerance),
            Some(by) => Err(bad_value(format!("by is '{by}': it must be 'region' or None."))),
        }
    }

    /// The number of regions.
    fn __len__(&self) -> usize {
        self.scene.regions.len()
    }

    /// The regions in order.
    #[cfg_attr(false, stub("() -> Iterator[Region]"))]
    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        self.regions(py)?.try_iter()
    }

    /// Attributes that do not exist, with what other programs call them.
    fn __getattr__(&self, name: &str) -> PyResult<Self> {
        Err(no_attribute("Model", name, &WORDS))
    }

    /// A region by its name, or by its position in the list of regions.
    #[cfg_attr(false, stub("(key: str | int) -> Region"))]
    fn __getitem__<'py>(&self, py: Python<'py>, key: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let Ok(name) = key.cast::<PyString>() else { return self.regions(py)?.as_any().get_item(key) };
        let name = name.to_str()?;
        match self.scene.regions.iter().position(|region| region.name == name) {
            Some(number) => self.regions(py)?.get_item(number),
            None => Err(PyKeyError::new_err(self.no_region(name).to_string())),
        }
    }

    /// The model file as text.
    fn to_toml(&self) -> String {
        self.current_document().to_toml()
    }

    /// Equal if regions, media, unit and pictures are equal, regardless of parameters and of names that solids have apart from
    /// regions: a writer gives names to the parts of expressions.
    fn __eq__(&self, other: PyRef<'_, Self>) -> bool {
        let meaning = |scene: &Scene| Scene { parameters: Vec::new(), solids: Vec::new(), ..scene.clone() };
        meaning(&self.scene) == meaning(&other.scene)
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        for region in &self.scene.regions {
            (&region.name, region.medium, pickle::hash(&region.solid)).hash(&mut hasher);
        }
        hasher.finish()
    }

    /// A picture of the model as an array: see `rayweave.render`, whose options these are.
    #[pyo3(signature = (**options: "Any") -> "NDArray[Any]")]
    fn render<'py>(
        slf: &Bound<'py, Self>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        render_method(slf.as_any(), options)
    }

    /// The picture that a notebook shows.
    fn _repr_png_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyBytes>> {
        let (py, model) = (slf.py(), slf.get());
        notebook_png(py, &Subject::of_model(model.scene(), model.compiled(py)?)?)
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    #[pyo3(signature = (_memo: "dict[int, Any]"))]
    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyDict>) -> Py<Self> {
        slf
    }

    fn __repr__(&self) -> String {
        let Scene { regions, media, unit, .. } = &*self.scene;
        let medium = |number: u32| media.get(number as usize).map_or("", |medium| medium.name.as_str());
        let named =
            regions.iter().take(8).map(|region| format!("{} ({})", region.name, medium(region.medium)));
        let more = if regions.len() > 8 { ", ..." } else { "" };
        let names = named.collect::<Vec<_>>().join(", ");
        let plural = if regions.len() == 1 { "" } else { "s" };
        format!("<Model in {unit}, {} region{plural}: {names}{more}>", regions.len())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let text = py.detach(|| {
            // the document itself if it is sufficient: it keeps the parameters, but not the
            // contents of external files
            let kept = self.current_document().to_toml();
            let is_enough = parse_with(&kept, &[]).is_ok_and(|(_, scene)| scene == *self.scene);
            if is_enough { kept } else { Document::from_scene(&self.scene).to_toml() }
        });
        Ok((py.import("rayweave._core")?.getattr("loads")?, (text,)))
    }
}
