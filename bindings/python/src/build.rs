//! Scenes of models that are built in Python.

use pyo3::prelude::*;
use rayweave::scene::{Colour, Medium, Scene, SceneRegion, Unit};

use crate::error::bad_value;
use crate::solid::PySolid;

/// Name, solid, number of the medium, colour or "" of a region.
type RegionParts<'py> = (String, PyRef<'py, PySolid>, u32, String);

/// Name, index, colour or "", other numbers of a medium.
type MediumParts = (String, Option<f64>, String, Vec<(String, f64)>);

/// The scene of regions and media in any form that `rayweave.Model` accepts.
pub fn scene_of_parts(
    regions: &Bound<'_, PyAny>,
    media: Option<&Bound<'_, PyAny>>,
    unit: Unit,
) -> PyResult<Scene> {
    let parts = regions.py().import("rayweave._model")?.getattr("parts")?.call1((regions, media))?;
    let (regions, media): (Vec<RegionParts<'_>>, Vec<MediumParts>) = parts.extract()?;
    let media = media.into_iter().map(medium).collect::<PyResult<Vec<_>>>()?;
    let region = |(number, parts): (usize, RegionParts<'_>)| region(number, parts, &media);
    let regions = regions.into_iter().enumerate().map(region).collect::<PyResult<Vec<_>>>()?;
    Ok(Scene::from_regions(unit, regions, media))
}

fn medium((name, index, text, numbers): MediumParts) -> PyResult<Medium> {
    let colour = colour(&text, || format!("the colour of the medium '{name}'"))?;
    Ok(Medium { name, index, colour, numbers })
}

/// A region; without a colour it has the one of its medium or the next one of the palette.
fn region(
    number: usize,
    (name, solid, medium, text): RegionParts<'_>,
    media: &[Medium],
) -> PyResult<SceneRegion> {
    let own = colour(&text, || format!("the colour of the region '{name}'"))?;
    let usual = media.get(medium as usize).and_then(|medium| medium.colour);
    let colour = own.or(usual).unwrap_or_else(|| Colour::numbered(number));
    // as in a model file, the name becomes part of the names of faces
    let solid = match solid.name() {
        Some(_) => solid.solid().clone(),
        None => solid.solid().named(&name),
    };
    Ok(SceneRegion { name, solid, medium, colour })
}

/// A colour from its text; `None` if that is empty.
fn colour(text: &str, what: impl FnOnce() -> String) -> PyResult<Option<Colour>> {
    if text.is_empty() {
        return Ok(None);
    }
    let wrong = || {
        let kinds = "a name such as 'red', or '#rgb', '#rrggbb' or '#rrggbbaa'";
        bad_value(format!("{} is '{text}': a colour is {kinds}.", what()))
    };
    Colour::parse(text).map(Some).ok_or_else(wrong)
}
