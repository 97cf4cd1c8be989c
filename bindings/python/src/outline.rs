//! Solids from outlines of straight edges and circular arcs.

use pyo3::prelude::*;
use rayweave::polygon::{Corner, Outline, OutlineError, Rim, Vertex};

use crate::error::bad_value;
use crate::solid::PySolid;

/// The vertices of each contour, `[x, y, bulge]`, and a fillet and a chamfer for the corners between straight edges; 0 for none.
type Contours = (Vec<Vec<[f64; 3]>>, [f64; 2]);

/// A prism over an outline, lo < z < hi. `rims` has the fillet and the chamfer of the lower and of the upper rim; 0 for none.
#[pyfunction]
pub fn extrude_outline(
    py: Python<'_>,
    contours: Contours,
    lo: f64,
    hi: f64,
    rims: [[f64; 2]; 2],
) -> PyResult<PySolid> {
    let rims = rims.map(|sizes| form(sizes, Rim::Fillet, Rim::Chamfer));
    solid(py, contours, |outline| outline.extrude(lo, hi, rims))
}

/// A solid of revolution: an outline in the half-plane x >= 0, revolved about its axis x = 0 from `start` by `angle` degrees.
#[pyfunction]
pub fn revolve_outline(py: Python<'_>, contours: Contours, start: f64, angle: f64) -> PyResult<PySolid> {
    solid(py, contours, |outline| outline.revolve(start, angle))
}

fn solid(
    py: Python<'_>,
    (contours, corner): Contours,
    sweep: impl Fn(&Outline) -> Result<rayweave::Solid, OutlineError> + Sync,
) -> PyResult<PySolid> {
    let corner = form(corner, Corner::Fillet, Corner::Chamfer);
    let contours: Vec<Vec<Vertex>> = contours.iter().map(|contour| vertices(contour, corner)).collect();
    py.detach(|| sweep(&Outline::new(&contours)?)).map(PySolid::from_solid).map_err(bad_value)
}

/// The form of a corner or rim with a fillet and a chamfer of these sizes, 0 for none; sharp without either.
fn form<T: Default>(sizes: [f64; 2], fillet: fn(f64) -> T, chamfer: fn(f64) -> T) -> T {
    match sizes {
        [0.0, 0.0] => T::default(),
        [0.0, size] => chamfer(size),
        [size, _] => fillet(size),
    }
}

/// The vertices of a contour; corners between two straight edges have the given form.
fn vertices(contour: &[[f64; 3]], corner: Corner) -> Vec<Vertex> {
    let before = contour.iter().cycle().skip(contour.len().saturating_sub(1));
    let pairs = before.zip(contour);
    let form = |arc: bool| if arc { Corner::Sharp } else { corner };
    pairs
        .map(|([.., before], &[x, y, bulge])| Vertex {
            at: [x, y],
            bulge,
            corner: form(bulge != 0.0 || *before != 0.0),
        })
        .collect()
}
