//! Lenses, mirrors, prisms and sheets as solids.

use numpy::PyArray2;
use pyo3::prelude::*;
use rayweave::optics::component::{self, Aperture, Asphere, Blank, ComponentError, Cpc, Sheet};
use rayweave::{Affine, Solid};

use crate::error::bad_value;
use crate::optics::outline::Outline;
use crate::solid::PySolid;
use crate::vectors::{matrix, matrix_rows};

/// The solids of a component, usually one: the kinds and the order of `numbers` are those of the match below; `terms` are the
/// even and odd coefficients of each aspheric face, `outline` is the aperture, `off_axis` the offset of a mirror.
#[pyfunction]
#[pyo3(signature = (kind, numbers, outline=None, off_axis=(0.0, 0.0), terms=Vec::new()))]
pub fn optical_component(
    kind: &str,
    numbers: Vec<f64>,
    outline: Option<Outline>,
    off_axis: (f64, f64),
    terms: Vec<(Vec<f64>, Vec<f64>)>,
) -> PyResult<Vec<PySolid>> {
    let aperture = outline.as_ref().map_or_else(|| Ok(Aperture::circle(f64::NAN)), Outline::aperture)?;
    let blank = |thickness: f64| Blank::new(aperture, thickness).off_axis(off_axis.0, off_axis.1);
    // face number k with its terms
    let face = |k: usize, radius: f64, conic: f64| asphere(terms.get(k), radius, conic);
    let one = |solid: Result<Solid, ComponentError>| solid.map(|solid| vec![solid]);
    let solids = match (kind, numbers.as_slice()) {
        ("lens", &[r1, r2, t]) => one(component::lens(r1, r2, t, aperture)),
        ("biconvex", &[r1, r2, t]) => one(component::biconvex(r1, r2, t, aperture)),
        ("biconcave", &[r1, r2, t]) => one(component::biconcave(r1, r2, t, aperture)),
        ("plano_convex", &[r, t]) => one(component::plano_convex(r, t, aperture)),
        ("plano_concave", &[r, t]) => one(component::plano_concave(r, t, aperture)),
        ("conic_lens", &[r1, k1, r2, k2, t]) => one(component::conic_lens(r1, k1, r2, k2, t, aperture)),
        ("aspheric_lens", &[r1, k1, r2, k2, t]) => {
            one(component::aspheric_lens(&face(0, r1, k1)?, &face(1, r2, k2)?, t, aperture))
        }
        ("aspheric_mirror", &[r, k, t]) => one(component::aspheric_mirror(&face(0, r, k)?, &blank(t))),
        ("cylindrical_lens", &[r1, r2, t, w, h]) => one(component::cylindrical_lens(r1, r2, t, w, h)),
        ("window", &[t]) => one(component::window(t, aperture)),
        ("ball_lens", &[d]) => one(component::ball_lens(d)),
        ("half_ball_lens", &[d]) => one(component::half_ball_lens(d)),
        ("rod", &[d, length]) => one(component::rod(d, length)),
        ("axicon", &[angle, t, d]) => one(component::axicon(angle, t, d)),
        ("plane_mirror", &[t]) => one(component::plane_mirror(&blank(t))),
        ("spherical_mirror", &[r, t]) => one(component::spherical_mirror(r, &blank(t))),
        ("conic_mirror", &[r, k, t]) => one(component::conic_mirror(r, k, &blank(t))),
        ("parabolic_mirror", &[f, t]) => one(component::parabolic_mirror(f, &blank(t))),
        ("elliptic_mirror", &[near, far, t]) => one(component::elliptic_mirror(near, far, &blank(t))),
        ("hyperbolic_mirror", &[behind, in_front, t]) => {
            one(component::hyperbolic_mirror(behind, in_front, &blank(t)))
        }
        ("toric_lens", &[x1, y1, x2, y2, t]) => one(component::toric_lens([x1, y1], [x2, y2], t, aperture)),
        ("fresnel_lens", &[r, k, pitch, t, d]) => one(component::fresnel_lens(r, k, pitch, t, d)),
        ("lenslet_array", &[r, t, pitch, columns, rows]) => {
            one(component::lenslet_array(r, t, pitch, columns as u32, rows as u32))
        }
        ("equilateral_prism", &[side, width]) => one(component::equilateral_prism(side, width)),
        ("dispersing_prism", &[apex, side, width]) => one(component::dispersing_prism(apex, side, width)),
        ("right_angle_prism", &[leg, width]) => one(component::right_angle_prism(leg, width)),
        ("penta_prism", &[side, width]) => one(component::penta_prism(side, width)),
        ("dove_prism", &[height, length, width]) => one(component::dove_prism(height, length, width)),
        ("amici_prism", &[diameter]) => one(component::amici_prism(diameter)),
        ("corner_cube", &[depth]) => one(component::corner_cube(depth)),
        ("wedge_prism", &[angle, t]) => one(component::wedge_prism(angle, t, aperture)),
        ("beam_splitter_cube", &[side]) => component::beam_splitter_cube(side).map(Vec::from),
        ("light_pipe", &[length]) => one(component::light_pipe(length, aperture)),
        ("concentrator", &[radius, angle, tolerance]) => {
            one(Cpc::new(radius, angle, tolerance).and_then(|cpc| cpc.solid()))
        }
        ("cemented", numbers) if numbers.len() % 2 == 1 => {
            // r1, t1, r2, t2, ..., rn
            let (radii, thicknesses) = (numbers.iter().step_by(2), numbers.iter().skip(1).step_by(2));
            let radii: Vec<f64> = radii.copied().collect();
            component::cemented(&radii, &thicknesses.copied().collect::<Vec<_>>(), aperture)
        }
        _ => {
            return Err(bad_value(format!(
                "the component \"{kind}\" takes another number of parameters than {}: the kinds and their parameters are in the documentation.",
                numbers.len()
            )));
        }
    };
    Ok(solids.map_err(bad_value)?.into_iter().map(PySolid::from_solid).collect())
}

/// A face by its radius, its conic constant, and its even and odd terms.
fn asphere(given: Option<&(Vec<f64>, Vec<f64>)>, radius: f64, conic: f64) -> PyResult<Asphere> {
    let plain = Asphere::conic(radius, conic);
    let Some((even, odd)) = given else { return Ok(plain) };
    Ok(Asphere { even: terms("even", even)?, odd: terms("odd", odd)?, ..plain })
}

/// Eight coefficients; missing ones are 0.
pub fn terms(name: &str, given: &[f64]) -> PyResult<[f64; 8]> {
    let mut terms = [0.0; 8];
    let places = terms.get_mut(..given.len());
    let too_many = || bad_value(format!("{name} has {} coefficients: at most 8 are possible.", given.len()));
    places.ok_or_else(too_many)?.copy_from_slice(given);
    Ok(terms)
}

/// The focal length of a thick lens in air (see `rayweave.optics.lensmaker`).
#[pyfunction]
#[pyo3(signature = (r1, r2, n, thickness))]
pub fn lensmaker(r1: f64, r2: f64, n: f64, thickness: f64) -> PyResult<f64> {
    component::lensmaker(r1, r2, n, thickness).map_err(bad_value)
}

/// A sheet: a surface trimmed by a solid, with its frame.
///
/// >>> import rayweave.optics as ro
/// >>> type(ro.detector(25.0).body).__name__
/// 'Sheet'
#[pyclass(frozen, module = "rayweave.optics", name = "Sheet")]
pub struct PySheet(pub Sheet);

#[pymethods]
impl PySheet {
    /// `curvature` is that of the surface at its vertex, 1 over its radius. With an opening, the sheet is a stop.
    #[new]
    #[pyo3(signature = (outline, opening=None, curvature=0.0, conic=0.0))]
    fn new(outline: Outline, opening: Option<Outline>, curvature: f64, conic: f64) -> PyResult<Self> {
        let aperture = outline.aperture()?;
        let sheet = match (opening, curvature == 0.0) {
            (Some(opening), true) => Sheet::stop(aperture, opening.aperture()?),
            (None, true) => Sheet::plane(aperture),
            (None, false) => Sheet::conic(1.0 / curvature, conic, aperture),
            (Some(_), false) => {
                return Err(bad_value(
                    "a curved sheet cannot have an opening: only plane sheets can be stops.",
                ));
            }
        };
        sheet.map(PySheet).map_err(bad_value)
    }

    /// A sheet: the part of the boundary of a solid that lies within another one.
    #[staticmethod]
    #[pyo3(signature = (surface, trim))]
    fn from_solids(surface: PyRef<'_, PySolid>, trim: PyRef<'_, PySolid>) -> Self {
        let (surface, trim) = (surface.solid().clone(), trim.solid().clone());
        PySheet(Sheet { surface, trim, frame: Affine::IDENTITY })
    }

    /// The sheet moved by an affine map, a 4 x 4 matrix.
    #[pyo3(signature = (world_from_local: "ArrayLike"))]
    fn apply(&self, world_from_local: &Bound<'_, PyAny>) -> PyResult<Self> {
        let map = matrix(world_from_local, "matrix")?;
        self.0.apply(&map).map(PySheet).map_err(bad_value)
    }

    /// Its frame, a 4 x 4 matrix from the coordinates in which it was created to those of the world.
    fn frame<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        matrix_rows(py, &self.0.frame)
    }

    /// The solid whose boundary is the surface, and the solid that trims it.
    fn solids(&self) -> (PySolid, PySolid) {
        (PySolid::from_solid(self.0.surface.clone()), PySolid::from_solid(self.0.trim.clone()))
    }
}
